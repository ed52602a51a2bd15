"""Disc cams: followers, profile, limits, the smallest that keeps to them, and the machine of cam and follower with its loads."""
