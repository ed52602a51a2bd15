"""The eccentric drive of a needle machine."""
