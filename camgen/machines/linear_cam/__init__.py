"""A linear cam: a plate that slides to and fro and moves a follower by its upper edge."""
