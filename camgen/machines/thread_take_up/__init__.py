"""The two-crank thread take-up."""
