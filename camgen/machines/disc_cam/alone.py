"""Cams alone: the plates of a disc cam, without a machine round them."""

from __future__ import annotations

import cmath
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

from camgen.geometry.outlines import Region
from camgen.machine.cams.followers import Follower
from camgen.machine.cams.limits import CamLimits
from camgen.machine.cams.machine import (
    SHOE,
    cam_outline,
)
from camgen.machine.cams.profile import DiscCam
from camgen.machine.cams.shoes import SlidingShoe, SwingingShoe
from camgen.machine.features import CamOutline, Mount
from camgen.machines.disc_cam.tables import (
    DiscCamGeometry,
    DiscCamParts,
)
from camgen.parts import materials
from camgen.parts.catalogue import DOWEL_STANDARD, HARD_DOWEL_STANDARD, Bought, dowel
from camgen.parts.disc_cams import disc_parts, roller_note, turning_note
from camgen.parts.part import Layer, Part


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
        made = disc_parts(self.sizes, outlines, wall, (roller + clearance, roller), self.min_wall)
        rolls = roller_note(roller) if wall is None else ()
        return tuple(
            replace(part, notes=(turning_note(self.sense), *rolls, *part.notes)) for part in made
        )

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
        at = tuple((part.name, len(part.centres) - 1) for part in walls)
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
