"""What bore, key, hub and a groove's pins leave of a disc cam, by arithmetic: its nearest side lies where its follower stands
lowest. Where that leaves open whether a keyway or a pin comes too near to a side further on, its holes are laid in its outline.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

from camgen.findings import Finding, Where, at_least
from camgen.geometry.distances import thinnest_wall
from camgen.geometry.facets import facet_contour
from camgen.machine.cams.profile import DiscCam
from camgen.parts.disc_cams import CamParts, pins_beside, refuse_wide
from camgen.parts.part import Part

_REMEDY = "a smaller bore or a larger base_radius makes it thicker"


@dataclass(frozen=True)
class CamWalls:
    """Cams with their holes, and the wall that these must leave."""

    cams: Sequence[DiscCam[Any]]  # one; both of a pair; the inner one of a groove
    sizes: CamParts
    grooved: bool
    least: float  # mm
    facets: float  # mm, what the files may take of a wall
    plates: Callable[[], Sequence[Part]]  # as they are made
    screw_hole: float = 0.0  # of a groove's plates in metal, mm across

    def findings(self) -> list[Finding]:
        """MIN_WALL of each cam; DesignError where bore, key, pin or hub leaves it."""
        sizes = self.sizes
        names = ["cam"] if len(self.cams) == 1 else ["cam-1", "cam-2"]
        widest = sizes.reach
        if self.grooved:
            names = ["inner"]
            widest = pins_beside(sizes, self.least) + sizes.pin_diameter / 2
        hub = sizes.hub_diameter if sizes.hub_height else 0.0
        walls = []
        for cam, name in zip(self.cams, names, strict=True):
            refuse_wide(name, cam.nearest, sizes.reach, hub)
            wall = cam.nearest - widest
            if wall < self.least and (self.grooved or sizes.bore_shape != "plain"):
                walls = [self._of_plate(part) for part in self.plates()]
                break
            walls.append(self._wall(wall, Where(f"holes and nearest side of {name}")))
        if self.grooved:
            rim = (sizes.rim - max(sizes.pin_diameter, self.screw_hole)) / 2
            remedy = "a wider parts.rim or a smaller parts.pin_diameter makes it thicker"
            walls.append(self._wall(rim, Where("pins and edge of outer"), remedy))
        return walls

    def _of_plate(self, part: Part) -> Finding:
        """The thinnest wall of a plate as it is made, facet by facet."""
        contours = (part.region.outer, *part.region.holes)
        outer, *holes = (facet_contour(each, self.facets / 2) for each in contours)
        where = Where(f"between the contours of {part.name}", part=part.name)
        return self._wall(thinnest_wall(outer, holes), where)

    def _wall(self, wall: float, where: Where, remedy: str = _REMEDY) -> Finding:
        return at_least("MIN_WALL", wall, self.least, "mm", where, remedy).within(self.facets)
