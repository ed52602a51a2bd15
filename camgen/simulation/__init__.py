"""Machines on a floor, stepped in time by MuJoCo."""
