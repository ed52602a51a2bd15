"""Copies of parts where they stand, as far as they are round: holes, outlines that are a circle with or without flats, slots."""

from __future__ import annotations

import cmath
import math
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np

from camgen.geometry.distances import inside
from camgen.geometry.facets import facet_contour
from camgen.geometry.outlines import Arc, Contour, Points, Region
from camgen.machine.features import Mount, PartPose, heights
from camgen.parts.keyways import keyed
from camgen.parts.part import Layer, Part
from camgen.tolerances import SAME_POINT

AROUND = np.exp(1j * math.tau * np.arange(12) / 12)
_CHORD = 0.1  # mm, of outlines that something bears
Seat = Literal["", "flat", "key"]

_ONE_AXIS = 1e-3  # mm, far below any play
_LOOSE = 1.0  # mm, by which a hole may be wider than what it goes on
_HALF_TURN = 1e-6  # rad, by which the ends of a slot may miss half a circle
_LONG = 3.0  # diameters, from which on a round thing has ends from which one measures


@dataclass(frozen=True)
class Round:
    """A hole or a round outline in the assembly: axis, heights, diameter, mm; of the part's point there its name."""

    at: complex
    low: float
    high: float
    diameter: float
    name: str
    flat: Seat = ""  # what it has where it is no whole circle

    def in_line(self, other: Round) -> bool:
        """Whether both have one axis."""
        return abs(self.at - other.at) < _ONE_AXIS

    def is_one_with(self, other: Round) -> bool:
        """Whether both are one hole, in layers one above the other."""
        touching = max(self.low, other.low) - min(self.high, other.high) < SAME_POINT
        return self.in_line(other) and touching and abs(self.diameter - other.diameter) < SAME_POINT

    def holds(self, outline: Round) -> bool:
        """Whether a round outline goes through this hole."""
        return (
            self.in_line(outline)
            and _common(self, outline)
            and abs(self.diameter - outline.diameter) < _LOOSE
        )

    def goes_round(self, outline: Round) -> bool:
        """Whether this hole is about a round outline, however loose, as a lip under a ball bearing about a sleeve."""
        return self.in_line(outline) and _common(self, outline) and self.diameter > outline.diameter


@dataclass(frozen=True)
class Slot:
    """A slot in the assembly: both ends of its middle line, heights, width, mm."""

    a: complex
    b: complex
    low: float
    high: float
    diameter: float

    def in_line(self, other: Round) -> bool:
        """Whether the other one's axis is on the middle line."""
        off = (other.at - self.a) * (self.b - self.a).conjugate() / abs(self.b - self.a)
        return (
            -_ONE_AXIS < off.real < abs(self.b - self.a) + _ONE_AXIS and abs(off.imag) < _ONE_AXIS
        )

    def holds(self, outline: Round) -> bool:
        """Whether a round outline stands in this slot."""
        fits = abs(self.diameter - outline.diameter) < _LOOSE
        return self.in_line(outline) and _common(self, outline) and fits


def _common(hole: Round | Slot, outline: Round) -> bool:
    """Whether both have heights in common."""
    return min(hole.high, outline.high) - max(hole.low, outline.low) > SAME_POINT


def standing_copies(
    parts: Sequence[Part],
    mounts: Sequence[Mount],
    poses: Mapping[str, Sequence[PartPose]],
    before: Mapping[str, int] | None = None,
) -> list[StandingCopy]:
    """Every copy of every part, in the order of the mounts; poses: of each part's copies, at one angle.

    before: how many copies of each part are numbered already.
    """
    number = Counter[str]()
    first = before or {}
    by_name = {part.name: part for part in parts}
    copies = []
    for mount in mounts:
        pose = poses[mount.part][number[mount.part]]
        number[mount.part] += 1
        name = f"{mount.part}-{first.get(mount.part, 0) + number[mount.part]}"
        part = by_name[mount.part]
        if not pose.upright:
            copies.append(_standing_copy(name, part, mount, pose))
        elif (level := _in_standing_plane(part, pose)) is not None:
            copies.append(_standing_copy(name, part, mount, level))
        else:
            copies.append(StandingCopy(name, part, mount, pose, (), (), ()))
    return copies


def _in_standing_plane(part: Part, pose: PartPose) -> PartPose | None:
    """The pose of a part that is stood up with its top along x, in the plane that stands; None of any other one."""
    if abs(cmath.exp(1j * float(pose.angle[0])) - 1j) > SAME_POINT:
        return None
    x, y = complex(pose.place[0]).real, complex(pose.place[0]).imag
    place = np.array([complex(-y, pose.z)])
    return PartPose(place, np.zeros(1), True, -x - part.thickness, standing=True)


def standing(
    part: Part, pose: PartPose, layer: Layer, at: complex, radius: float, flat: Seat = ""
) -> Round:
    """A circle of a part's layer, its centre and radius in the part's frame, mm, where a copy stands."""
    centre = -at.conjugate() if pose.flipped else at
    place = complex(pose.place[0]) + cmath.exp(1j * float(pose.angle[0])) * centre
    name = next((name for name, point in part.points if abs(point - at) < SAME_POINT), "")
    return Round(place, *heights(pose, part.thickness, layer.z0, layer.z1), 2 * radius, name, flat)


@dataclass(frozen=True)
class StandingCopy:
    """A copy of a part where it stands."""

    name: str  # such as pin-2
    part: Part
    mount: Mount
    pose: PartPose  # at one angle
    holes: Sequence[Round]
    slots: Sequence[Slot]
    outlines: Sequence[Round]

    def at(self, z: complex) -> complex:
        """A point of the part, complex mm in its frame, where the copy stands."""
        own = -z.conjugate() if self.pose.flipped else z
        return complex(self.pose.place[0]) + cmath.exp(1j * float(self.pose.angle[0])) * own

    def in_space(self, at: complex, height: float) -> tuple[float, float, float]:
        """Where a place at a height is, mm: of what is in a plane that stands, on the ground."""
        if self.pose.standing:
            return -height, -at.real, at.imag
        return at.real, at.imag, height

    @property
    def slender(self) -> bool:
        """Whether it is a shaft, however thick, or a pin: its longest outline alone is long."""
        return self.part.role == "shaft" or any(
            each.high - each.low >= _LONG * each.diameter for each in self.outlines
        )


def _standing_copy(name: str, part: Part, mount: Mount, pose: PartPose) -> StandingCopy:
    """A copy's round things where it stands; of a hole through several layers the lowest and highest end."""
    outlines = [
        standing(part, pose, layer, *disc, seat_of(layer.region.outer))
        for layer in part.layers
        for disc in discs(layer.region.outer)
    ]
    holes: list[Round] = []
    bored = (
        (layer, (*disc, seat_of(hole)))
        for layer in part.layers
        for hole in layer.region.holes
        for disc in discs(hole)
    )
    for each in (standing(part, pose, layer, *disc) for layer, disc in bored):
        same = next((k for k, other in enumerate(holes) if each.is_one_with(other)), None)
        if same is None:
            holes.append(each)
        else:
            other = holes[same]
            holes[same] = replace(
                each, low=min(each.low, other.low), high=max(each.high, other.high)
            )
    slots = [
        _slot(part, pose, layer, *ends)
        for layer in part.layers
        for hole in layer.region.holes
        for ends in _stadium(hole)
    ]
    return StandingCopy(name, part, mount, pose, holes, slots, outlines)


def _slot(part: Part, pose: PartPose, layer: Layer, a: complex, b: complex, radius: float) -> Slot:
    """A slot of a part's layer where a copy stands."""
    one = standing(part, pose, layer, a, radius)
    other = standing(part, pose, layer, b, radius)
    return Slot(one.at, other.at, one.low, one.high, 2 * radius)


def _stadium(contour: Contour) -> Iterator[tuple[complex, complex, float]]:
    """Both ends of the middle line and the radius of an outline that is a slot."""
    sweeps: dict[tuple[complex, float], float] = {}
    for arc in (piece for piece in contour.pieces if isinstance(piece, Arc)):
        sweeps[arc.centre, arc.radius] = sweeps.get((arc.centre, arc.radius), 0.0) + abs(arc.sweep)
    (a, radius), *others = sweeps or {(0j, 0.0): 0.0}
    straight = len([piece for piece in contour.pieces if not isinstance(piece, Arc)])
    if (
        straight == 2
        and len(others) == 1
        and all(abs(sweep - math.pi) < _HALF_TURN for sweep in sweeps.values())
    ):
        yield a, others[0][0], radius


def seat_of(contour: Contour) -> Seat:
    """Whether a round contour has a flat or a keyway."""
    if keyed(contour):
        return "key"
    return "flat" if any(not isinstance(piece, Arc) for piece in contour.pieces) else ""


def discs(contour: Contour) -> Iterator[tuple[complex, float]]:
    """Centre and radius of a circle, with flats or a keyway or without."""
    widest = max(
        (piece for piece in contour.pieces if isinstance(piece, Arc)),
        key=lambda arc: abs(arc.sweep),
        default=None,
    )
    if widest and abs(widest.sweep) > math.pi:
        yield widest.centre, widest.radius


def placed(copy: StandingCopy, contour: Contour) -> Points:
    """A contour of a copy's part in the assembly, (n,) complex mm."""
    ring = facet_contour(contour, _CHORD)
    ring = -ring.conjugate() if copy.pose.flipped else ring
    turned = cmath.exp(1j * float(copy.pose.angle[0])) * ring
    return complex(copy.pose.place[0]) + turned


def covers(copy: StandingCopy, points: Points) -> bool:
    """Whether any of some points of the assembly, (n,) complex mm, lies on a copy, and in none of its holes."""
    if copy.pose.standing:
        return False

    def on(region: Region) -> Any:
        found = inside(points, placed(copy, region.outer))
        for hole in region.holes:
            found &= ~inside(points, placed(copy, hole))
        return found

    return any(bool(on(layer.region).any()) for layer in copy.part.layers)
