"""The linkage that an indexing cam is, while its tables are written."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

Tables = dict[str, Any]


@dataclass(frozen=True)
class Drawing:
    """Points and links, to which a chain before the cam and an unloader add their own."""

    points: dict[str, complex]  # places on the ground at theta = 0, mm
    links: dict[str, list[str]]  # their points
    gears: list[Tables]
    others: Tables  # by their names

    def tables(self) -> Tables:
        """As a linkage's spec has them."""
        places = {name: (z.real, z.imag) for name, z in self.points.items()}
        return {"points": places, "links": self.links, "gear": self.gears, **self.others}
