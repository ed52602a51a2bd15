"""The uniform-swing cam drive."""
