"""The table of a cam's track on its sheet: radii of an outline, points that a follower touches, heights of a drum's roller or of a
plate's edge."""

from __future__ import annotations

import cmath
import math
from collections.abc import Sequence
from dataclasses import dataclass

from camgen.files.title_block import Facts
from camgen.geometry.drums import Drum


@dataclass(frozen=True)
class TrackTable:
    """Its rows, which stand in as many columns beside each other as there is room for."""

    title: str
    heads: tuple[str, ...]
    widths: tuple[float, ...]  # mm of paper
    rows: Sequence[tuple[str, ...]]

    def beside(self, room: float) -> int:
        """How many rows stand beside each other in so many mm of paper."""
        return round(room / sum(self.widths))

    def count(self, room: float) -> int:
        """How many lines it has there, without title and head."""
        return -(-len(self.rows) // self.beside(room))

    def lines(self, room: float) -> list[list[str]]:
        """These lines."""
        count = self.count(room)
        return [[cell for row in self.rows[k::count] for cell in row] for k in range(count)]


def track_table(
    facts: Facts, polar: Sequence[tuple[float, float]], drum: Drum | None
) -> TrackTable | None:
    """The table of a part; None where there is nothing to tell. polar: angle, deg, and radius of its outline, mm."""
    if facts.levels:
        exact = "Theoretically exact edge" if facts.profile else "Edge"
        rows: list[tuple[str, ...]] = [(f"{z.real:g}", f"{z.imag:.3f}") for z in facts.levels]
        return TrackTable(f"{exact}: Y over X", ("X", "Y"), (15.0, 19.0), rows)
    if facts.heights:
        exact = "Exact axis" if facts.profile else "Axis"
        of = "both rollers' middle" if drum and drum.track == "rib" else "the roller"
        title = f"{exact} of {of}: angle from X, ccw, and height"
        rows = [(f"{a:g}°", f"{at:.2f}°", f"{z:.3f}") for a, at, z in facts.heights]
        return TrackTable(title, ("Drum", "At", "Z"), (14.0, 18.5, 18.5), rows)
    if polar and facts.track:
        exact = "Theoretically exact track" if facts.profile else "Track by cam angle"
        title = f"{exact}: where the follower touches, from X, ccw"
        rows = [
            (f"{angle:g}°", f"{math.degrees(cmath.phase(z)) % 360:.2f}°", f"{abs(z):.3f}")
            for angle, z in facts.track
        ]
        return TrackTable(title, ("Cam", "At", "Radius"), (14.0, 18.5, 18.5), rows)
    if polar:
        exact = "Theoretically exact radii" if facts.profile else "Radii of the profile"
        title = f"{exact} about the origin, by the angle from X, ccw"
        rows = [(f"{angle:g}°", f"{radius:.3f}") for angle, radius in polar]
        return TrackTable(title, ("Angle", "Radius"), (15.0, 19.0), rows)
    return None
