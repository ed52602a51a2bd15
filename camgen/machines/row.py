"""A published number beside ours."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Row:
    """One constant: what it is, as published (a text: its last decimal says how exact it is), as computed here.

    refuted: why the published value is wrong; undecided: why nobody can tell. Without either the two are to agree.
    """

    what: str
    published: str
    ours: float
    refuted: str = ""
    undecided: str = ""

    @property
    def agrees(self) -> bool:
        """Whether ours rounds to the published value, by half a unit of its last decimal and a hair."""
        if self.published == "-":
            return False
        mantissa, _, exponent = self.published.partition("e")
        unit = 10.0 ** (int(exponent or 0) - len(mantissa.partition(".")[2]))
        return bool(abs(self.ours - float(self.published)) <= 0.5001 * unit)

    @property
    def ok(self) -> bool:
        """Whether it is as it is said to be: a value that is refuted may not agree."""
        return bool(self.undecided) or self.agrees != bool(self.refuted)

    @property
    def verdict(self) -> str:
        """In a few words."""
        if not self.ok:
            return "OFF"
        return f"refuted: {self.refuted}" if self.refuted else f"not decidable: {self.undecided}" if self.undecided else "agrees"
