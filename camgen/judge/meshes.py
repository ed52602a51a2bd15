"""Gears as their files have them: both outlines through the contact engine, over every tooth of either wheel."""

from __future__ import annotations

import cmath
import math
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Literal

import numpy as np

from camgen.findings import Finding, Where, at_most
from camgen.geometry.rings import Floats, Ring
from camgen.judge.pairs import Body, OutlinePair, PairMotion, pivots_apart
from camgen.machine.features import Mount, Teeth
from camgen.numerics import coordinates, least_squares, magnitude

_A_TOOTH = 16  # angles of the driver
_FINE = 1e-5  # mm, to which arcs are taken as facets where areas are compared
_SAME = 1e-4  # mm, by which axes of pairs that are alike may differ: far less than what is judged
_ALIKE = 0.02  # of what an error takes off a tooth as high as the module: areas that differ by less are alike


@dataclass(frozen=True)
class MeshedWheel:
    """A wheel as its file has it: outline in the part's frame, mm, on its body, which turns about `pivot` in its own frame."""

    teeth: Teeth  # as meant
    ring: Ring
    mount: Mount
    pivot: complex  # mm

    @property
    def part(self) -> str:
        """Whose file it is."""
        return self.teeth.part

    @property
    def radius(self) -> float:
        """Of the pitch circle, mm."""
        return self.teeth.radius

    @property
    def about_pivot(self) -> Ring:
        """The outline as the body has it, from the pivot, mm."""
        sense = -1 if self.mount.flipped else 1
        turn = sense * cmath.exp(1j * self.mount.angle)
        return self.ring.moved(turn, self.mount.at - self.pivot, mirror=self.mount.flipped)

    @property
    def offset(self) -> complex:
        """From the pivot to the part's origin, in the part's directions, mm."""
        way = (self.mount.at - self.pivot) * cmath.exp(-1j * self.mount.angle)
        return -way.conjugate() if self.mount.flipped else way

    def degrees(self, z: complex) -> float:
        """Direction in the part's own frame of a point that is seen from the pivot in the body's, deg from 0 to 360."""
        turned = (z + self.pivot - self.mount.at) * cmath.exp(-1j * self.mount.angle)
        own = -turned.conjugate() if self.mount.flipped else turned
        return math.degrees(cmath.phase(own)) % 360


@dataclass(frozen=True)
class Meshing:
    """Two wheels of a Gear, seen from what carries both axes: angle of b = ratio * angle of a + start, rad.

    line: from a's axis to b's, mm; base: radius of b's base circle, mm.
    """

    joint: str
    a: MeshedWheel
    b: MeshedWheel
    line: complex
    ratio: float
    start: float
    base: float

    def alike(self, other: Meshing) -> bool:
        """Whether both are the same wheels at the same distance, each as far beside its axis: planets of one carrier."""
        pairs = ((self.a, other.a), (self.b, other.b))
        return abs(abs(self.line) - abs(other.line)) < _SAME and all(
            one.teeth == two.teeth and abs(one.offset - two.offset) < _SAME for one, two in pairs
        )

    @property
    def angles(self) -> Floats:
        """Of a, (n,) rad: all teeth of the wheel that has more."""
        count = self.a.teeth.count
        most = max(count, self.b.teeth.count)
        return np.linspace(0.0, math.tau * most / count, _A_TOOTH * most + 1)

    @cached_property
    def motion(self) -> PairMotion:
        """Where b is free."""
        driver = Body([self.a.about_pivot])
        driven = Body([self.b.about_pivot])
        return OutlinePair(driver, driven, pivots_apart(self.line)).follow(self.angles, self.start)

    @property
    def jammed(self) -> np.ndarray:
        """At which angles nothing is free, (n,) bool."""
        samples = self.motion.samples
        return ~samples.free | ~(samples.play > 0)

    @property
    def lead(self) -> float:
        """By how much the middle of what is free is ahead of the start, in the mean, rad; 0 of teeth that jam."""
        if self.jammed.any():
            return 0.0
        samples = self.motion.samples
        even = self.start + self.ratio * samples.theta
        return float(np.mean((samples.low + samples.high) / 2 - even))

    @property
    def play(self) -> float:
        """Mean of what is free, rad of b; 0 of teeth that jam."""
        return 0.0 if self.jammed.any() else float(np.mean(self.motion.samples.play))


def judge_mesh(meshing: Meshing, off: float, where: Where) -> Finding:
    """GEAR_MESH: by how much the flanks are off turning evenly, peak to peak along the line of action, mm.

    off: mm, how far an outline may lie from the one that is meant, on either side; where: the files of both wheels.
    """
    motion = meshing.motion
    samples = motion.samples
    limit = 4 * off  # a flank of either wheel lies in or out by so much
    if meshing.jammed.any():
        theta = float(samples.theta[int(np.argmax(meshing.jammed))])
        remark = f"the teeth are in each other's way{_named(meshing, 0.0)}"
        return at_most("GEAR_MESH", math.inf, limit, "mm", _at(meshing, theta, where), remark)
    even = meshing.ratio * samples.theta
    flanks = {"low": samples.low - even, "high": samples.high - even}
    side: Literal["low", "high"] = (
        "low" if np.ptp(flanks["low"]) > np.ptp(flanks["high"]) else "high"
    )
    course = flanks[side]
    k = int(np.argmax(np.abs(course - np.median(course))))
    point = complex(motion.touch(samples, side).point[k])
    theta = float(samples.theta[k])
    phi = float((samples.low if side == "low" else samples.high)[k])
    on_a = meshing.a.degrees((point + meshing.line) * cmath.exp(-1j * theta))
    on_b = meshing.b.degrees(point * cmath.exp(-1j * phi))
    remark = (
        f"both flanks over all teeth, along the line of action, peak to peak; most at {on_a:.1f} deg of {meshing.a.part}, "
        f"{on_b:.1f} deg of {meshing.b.part}; play {meshing.base * samples.play.min():.4f} to "
        f"{meshing.base * samples.play.max():.4f} mm"
    )
    measured = meshing.base * float(np.ptp(course))
    if measured > limit:
        remark += _named(meshing, measured)
    return at_most("GEAR_MESH", measured, limit, "mm", _at(meshing, theta, where), remark)


def _at(meshing: Meshing, theta: float, where: Where) -> Where:
    return replace(where, joint=meshing.joint, theta=theta, angle=f"{meshing.a.part} at")


@dataclass(frozen=True)
class OddTooth:
    """The tooth that differs most from the others of its wheel: direction of its middle in the part's frame, rad."""

    part: str
    direction: float
    off: float  # mm^2, area of one of its halves less what the others have there


def odd_tooth(meshing: Meshing, error: float) -> OddTooth | None:
    """The tooth that is least like those of its own wheel; None where all are alike but for a share of what an error, mm, shows."""
    worst = max((_oddest(wheel) for wheel in (meshing.a, meshing.b)), key=lambda each: each.off)
    module = 2 * meshing.b.radius / meshing.b.teeth.count
    return worst if worst.off > max(_ALIKE * error * module, _FINE) else None


def _named(meshing: Meshing, error: float) -> str:
    odd = odd_tooth(meshing, error)
    if odd is None:
        return "; the teeth of each wheel are alike"
    at = math.degrees(odd.direction) % 360
    return f"; the tooth that is unlike the others is at {at:.1f} deg of {odd.part}"


def _oddest(wheel: MeshedWheel) -> OddTooth:
    """By the areas of both halves of each tooth, from its middle to that of the gap."""
    import shapely

    teeth = wheel.teeth
    z = wheel.ring.facetted(_FINE)
    outline = shapely.make_valid(shapely.Polygon(coordinates(z)))
    half = math.pi / teeth.count
    edges = teeth.tooth + half * np.arange(2 * teeth.count + 1) - half
    rim = 2 * magnitude(z) * np.exp(1j * edges)
    corners = np.stack([np.zeros(2 * teeth.count), rim[:-1], rim[1:]], axis=1)
    wedges = shapely.polygons(np.stack([corners.real, corners.imag], axis=2))
    areas = shapely.area(shapely.intersection(outline, wedges))
    right = np.arange(2 * teeth.count) % 2 == 0
    z = np.exp(1j * (edges[:-1] + edges[1:]) / 2)
    wave = np.column_stack([np.ones(len(z)), z.real, z.imag])
    # teeth that are turned, or beside the axis, are not odd
    usual = np.hstack([wave * right[:, None], wave * ~right[:, None]])
    off = np.abs(areas - usual @ least_squares(usual, areas))
    k = int(np.argmax(off))
    direction = math.remainder(teeth.tooth + 2 * half * (k // 2), math.tau)
    return OddTooth(teeth.part, direction, float(off[k]))
