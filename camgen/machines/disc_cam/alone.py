"""Cams alone: the plates of a disc cam, without a machine round them."""

from __future__ import annotations

import cmath
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

from camgen.geometry.arcs import as_circle
from camgen.geometry.facets import facet_contour
from camgen.geometry.outlines import Region
from camgen.machine.cams.followers import Follower
from camgen.machine.cams.limits import CamLimits
from camgen.machine.cams.machine import (
    SHOE,
    cam_outline,
)
from camgen.machine.cams.profile import DiscCam
from camgen.machine.cams.shoes import SlidingShoe, SwingingShoe
from camgen.machine.cams.sizing import written
from camgen.machine.features import CamOutline, Mount
from camgen.machines.disc_cam.tables import (
    DiscCamGeometry,
    DiscCamParts,
)
from camgen.numerics import magnitude
from camgen.parts import materials
from camgen.parts.catalogue import (
    CORE_HOLES,
    DOWEL_STANDARD,
    HARD_DOWEL_STANDARD,
    Bought,
    Screw,
    dowel,
)
from camgen.parts.disc_cams import LAYOUT, disc_parts, roller_note, turning_note
from camgen.parts.part import Layer, Part
from camgen.tolerances import SAME_POINT


@dataclass(frozen=True)
class CamsAlone:
    """The cam; both cams of a conjugate pair; or the plates of a groove; a shoe with an outline of a person's own."""

    geometry: DiscCamGeometry
    sizes: DiscCamParts
    cams: Sequence[DiscCam[Follower]]
    limits: CamLimits
    min_wall: float  # mm
    clearance: float  # of what slides, mm
    material: str
    sense: int  # -1 where they turn clockwise

    @cached_property
    def plates(self) -> Sequence[Part]:
        """The cam; both cams of a conjugate pair; or inner cam, outer ring and back plate of a groove."""
        outlines = [cam.outline for cam in self.cams]
        clearance = self.clearance
        wall = self.cams[0].groove(clearance) if self.geometry.closure == "groove" else None
        roller = 2 * (self.geometry.follower.radius or 0.0)
        groove = (roller + clearance, roller)
        sizes = self.sizes
        if wall is not None:  # the rim's diameter as a workshop writes it
            reach = magnitude(facet_contour(wall, LAYOUT))
            rim = written(2 * (reach + sizes.rim)) / 2 - reach
            sizes = sizes.model_copy(update={"rim": rim})
        made = disc_parts(sizes, outlines, wall, groove, self.min_wall, self.screw)
        rolls = roller_note(roller) if wall is None else ()
        return tuple(
            replace(part, notes=(turning_note(self.sense), *rolls, *part.notes)) for part in made
        )

    @property
    def screw(self) -> Screw | None:
        """Of the plates of a groove in metal."""
        return self.sizes.plate_screw if materials.of(self.material).metal else None

    def screws(self) -> Sequence[Bought]:
        """Screws from below the back into the walls of a groove in metal."""
        screw = self.screw
        if self.geometry.closure != "groove" or screw is None:
            return ()
        core = CORE_HOLES[screw.thread]
        at = tuple((part.name, _beside(part, core)) for part in self.plates[:-1])
        length = screw.length(self.sizes.back, self.sizes.thickness)
        size = f"{screw.thread} x {length:g}"
        count = sum(each for _, each in at)
        return (Bought("screw of the plates", "ISO 4762", size, count, at=at),)

    def dowels(self) -> Sequence[Bought]:
        """Pins that join the plates of a groove, one through each pair of holes; of rod where none is sold in that size."""
        if self.geometry.closure != "groove":
            return ()
        p = self.sizes
        walls = self.plates[:-1]
        through = p.back + p.thickness
        length = dowel(p.pin_diameter, through)
        fit = "m6" if length else "rod"
        size = f"{p.pin_diameter:g} {fit} x {length or through:g}"
        at = tuple((part.name, _beside(part, p.pin_diameter)) for part in walls)
        count = sum(each for _, each in at)
        hard = materials.of(self.material).metal
        standard = HARD_DOWEL_STANDARD if hard else DOWEL_STANDARD
        return (Bought("dowel pin", standard if length else "", size, count, at=at),)

    @cached_property
    def shoe(self) -> Sequence[Part]:
        """The follower with an outline of a person's own."""
        if self.geometry.follower.shape != "outline":
            return ()
        outer, *holes = self.geometry.follower.drawing
        region = Region(
            outer.counter_clockwise(), tuple(each.counter_clockwise() for each in holes)
        )
        layer = Layer(region, 0.0, self.sizes.thickness)
        source = self.geometry.follower.drawn_in
        notes = (f"as drawn in {source}",) if source else ()
        least = self.min_wall
        return (Part(SHOE, "Follower", (layer,), notes=notes, centres=(0j,), min_wall=least),)

    @cached_property
    def outlines(self) -> Sequence[CamOutline]:
        """The outline of the cam; of both cams of a pair, and both walls of a groove."""
        names = [part.name for part in self.plates]
        found = [self._outline(name, cam) for name, cam in zip(names, self.cams, strict=False)]
        if self.geometry.closure == "groove":
            found.append(self._outline("outer", self.cams[0], self.clearance))
        return found

    def _outline(self, part: str, cam: DiscCam[Follower], free: float | None = None) -> CamOutline:
        bore = self.sizes.bore if free is None else None
        return cam_outline(cam, part, self.limits, bore, self.geometry.follower.face_width, free)

    def mounts(self) -> Sequence[Mount]:
        """All plates on the cam's body, one above the other."""
        p = self.sizes
        heights = {
            "inner": p.back,
            "outer": p.back,
            "cam-2": p.thickness + p.hub_height + self.clearance,
        }
        plates = [Mount(part.name, "cam", z=heights.get(part.name, 0.0)) for part in self.plates]
        match self.cams[0].follower:
            case SlidingShoe(start=start, turn=turn):
                return [*plates, Mount(SHOE, "follower", start, cmath.phase(turn))]
            case SwingingShoe(turn=turn):
                return [*plates, Mount(SHOE, "follower", 0j, cmath.phase(turn))]
        return plates


def _beside(part: Part, diameter: float) -> int:
    """How many round holes of a diameter, mm, a part has beside its axis."""
    circles = filter(None, map(as_circle, part.region.holes))
    return sum(abs(z) > SAME_POINT and abs(2 * r - diameter) < SAME_POINT for z, r in circles)
