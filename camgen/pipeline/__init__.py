"""Who calls whom: build, check, motion from an outline; on several cores."""
