"""The version of this package, alone: whoever needs no more imports no more."""

__version__ = "0.1.0"
