"""Machines that are found instead of drawn: a linkage for a path, and values of keys for limits that must hold."""
