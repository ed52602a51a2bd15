"""Who is told how far work has come."""

from __future__ import annotations

from typing import Protocol


class Progress(Protocol):
    """Is told what is being made, and which share (0..1) of the whole is done where that is known."""

    def __call__(self, text: str, done: float | None = None, /) -> None:
        """Tell it; a text that begins with "note: " is for people to keep."""


def silent(text: str, done: float | None = None) -> None:
    """Progress that nobody watches."""
