"""Formats: what is written to a folder and read back from it."""
