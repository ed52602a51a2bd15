"""A cylinder cam: a drum with a groove, a rib or an end that a roller follows along the drum's axis."""
