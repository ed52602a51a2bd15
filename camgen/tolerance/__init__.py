"""Printed copies: what a printer's errors do to a machine, and how many copies hold what is asked."""
