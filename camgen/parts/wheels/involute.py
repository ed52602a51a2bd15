"""Involute teeth as a rack cutter makes them: outer wheels, rings with inner teeth.

    rack        straight-sided cutter, the standard's basic rack: addendum, clearance and tip rounding in modules
    reference   circle of radius module * teeth / 2, on which the cutter's pitch line rolls
    shift       how far the cutter stands back from there, in modules; above 0: a thicker foot
    thinner     by how much a tooth is thinner than the cutter would leave it, mm along the reference circle
    form        radius at which the flank ends and the root's trochoid begins
    roll        of a point of an involute: its tangent to the base circle over that circle's radius, rad

A tooth of a wheel and a space of a ring lie on Ox. The trochoid follows from the law of gearing: the cutter's rounding, of
centre C, touches the wheel where the line from the pitch point I through C leaves it.
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property, partial
from typing import Any

import numpy as np

from camgen.errors import DesignError
from camgen.geometry.outlines import (
    Arc,
    Contour,
    Line,
    Piece,
    Points,
    Smooth,
    end_point,
)
from camgen.numerics import Floats, halved, sign_changes

LEAST_TIP = 0.2  # of the module: a thinner tip breaks off, or is not printed at all
LEAST_ROLL = 1e-3  # rad, at which a flank begins at the earliest: on the base circle its curvature has no bound
_HAIR = 1e-9  # mm, of a piece that is none
_PLACES = 400  # of the trochoid, among which its crossing with an undercut flank is looked for


def involute(angle: float) -> float:
    """tan(angle) - angle, rad."""
    return math.tan(angle) - angle


@dataclass(frozen=True)
class BasicRack:
    """The cutter, which all wheels that mesh have in common; the standard's by default (ISO 53, profile A)."""

    module: float  # mm
    pressure: float = math.radians(20)  # angle of its flanks, rad
    addendum: float = 1.0  # modules
    clearance: float = 0.25  # modules
    fillet: float = 0.38  # radius of its tips' rounding, modules

    @property
    def depth(self) -> float:
        """Of the centre of a tip's rounding under the cutter's pitch line, mm."""
        return self.module * (self.addendum + self.clearance - self.fillet)

    def least_shift(self, teeth: int) -> float:
        """Shift from which on a wheel has no undercut."""
        sine = math.sin(self.pressure)
        low = self.addendum + self.clearance - self.fillet * (1 - sine)
        return low - teeth * sine**2 / 2


@dataclass(frozen=True)
class Relief:
    """Flanks that draw back towards the tip: by `amount`, mm along the line of action, there, and by the square on the way."""

    amount: float
    begin: float  # radius, mm


@dataclass(frozen=True)
class Teeth:
    """What involute teeth have in common."""

    teeth: int
    rack: BasicRack
    shift: float = 0.0  # of a ring above 0: outwards
    thinner: float = 0.0  # mm

    @property
    def module(self) -> float:
        """mm of diameter a tooth."""
        return self.rack.module

    @property
    def reference(self) -> float:
        """Radius of the reference circle, mm."""
        return self.module * self.teeth / 2

    @property
    def base(self) -> float:
        """Radius of the base circle, mm."""
        return self.reference * math.cos(self.rack.pressure)

    @property
    def pitch(self) -> float:
        """Angle from tooth to tooth, rad."""
        return math.tau / self.teeth

    def tangent(self, radius: float) -> float:
        """Length from a flank's point along its normal to the base circle, mm; 0 within."""
        return math.sqrt(max(0.0, radius**2 - self.base**2))

    def _half(self, radius: float, wider: float) -> float:
        """Half of the angle between both flanks that lie about Ox, rad, at a radius; wider: there, mm at the reference."""
        rack = self.rack
        angle = math.acos(min(1.0, self.base / radius))
        middle = math.pi / 2 + 2 * self.shift * math.tan(rack.pressure)
        return (
            middle / self.teeth
            + wider / (2 * self.reference)
            + involute(rack.pressure)
            - involute(angle)
        )


@dataclass(frozen=True)
class Wheel(Teeth):
    """An outer wheel. A tooth lies on Ox."""

    shortened: float = 0.0  # how far the tips stay under the standard's height, modules
    relief: Relief | None = None

    def __post_init__(self) -> None:
        rack = self.rack
        if self._cutter_half < 0:
            raise DesignError(
                "cutter's flat tip", 2 * self._cutter_half, 0, "mm", "", "round its corners less"
            )
        if self.tip_thickness < LEAST_TIP * rack.module:
            raise DesignError(
                "thickness of a tooth's tip",
                self.tip_thickness,
                LEAST_TIP * rack.module,
                "mm",
                f"a wheel of {self.teeth} teeth",
                "use more teeth, or a smaller shift",
            )

    @property
    def tip(self) -> float:
        """Radius of the tips, mm."""
        return self.reference + self.module * (self.rack.addendum + self.shift - self.shortened)

    @property
    def root(self) -> float:
        """Radius of the roots, mm."""
        rack = self.rack
        return self.reference - self.module * (rack.addendum + rack.clearance - self.shift)

    @property
    def tip_thickness(self) -> float:
        """Of a tooth along the tips' circle, mm; below 0 where the flanks meet under it."""
        return 2 * self.half_angle(self.tip) * self.tip

    @property
    def span(self) -> tuple[int, float]:
        """Teeth over which a caliper measures near half of their height, and the length that it shows, mm."""
        thick = 2 * self.half_angle(self.base) * self.base
        step = self.pitch * self.base
        wanted = 2 * self.tangent(self.reference + self.shift * self.module)
        count = max(1, round((wanted - thick) / step) + 1)
        return count, (count - 1) * step + thick

    @property
    def undercut(self) -> bool:
        """Whether the cutter's tip takes off a part of the involute."""
        return self.shift < self.rack.least_shift(self.teeth)

    def half_angle(self, radius: float) -> float:
        """Half of a tooth's angle at a radius, rad; below the base circle as there."""
        return self._half(radius, -self.thinner)

    def half_gap(self, radius: Floats) -> Floats:
        """Half of the angle of a gap between two roots, rad, from the root circle to the form circle; (n,) mm."""
        root = self._trochoid(np.linspace(self._join[0], math.pi / 2, _PLACES), 0)
        rising = slice(None, None, -1)
        return np.asarray(
            np.interp(radius, np.abs(root[rising]), self.pitch / 2 - np.angle(root[rising]))
        )

    @property
    def bends(self) -> float:
        """Stress at the root of a tooth that alone bears a force on its tip, MPa mm of width per N: a beam, worst section.

        The force along the line of action meets the tooth's middle at base / cos(lean); the section is where the root's trochoid
        makes 6 cos(lean) arm / width^2 greatest: Lewis's inscribed parabola.
        """
        lean = math.acos(self.base / self.tip) - self.half_angle(self.tip)
        root = self._trochoid(np.linspace(self._join[0], math.pi / 2, _PLACES), 0)
        arm = self.base / math.cos(lean) - root.real
        return float(np.max(6 * math.cos(lean) * arm / (2 * root.imag) ** 2))

    @property
    def _cutter_half(self) -> float:
        """Half of the flat of the cutter's tip, mm, which reaches to the centre of its rounding."""
        rack = self.rack
        round_off = rack.depth * math.tan(rack.pressure) + rack.fillet * rack.module / math.cos(
            rack.pressure
        )
        return math.pi * rack.module / 4 + self.thinner / 2 - round_off

    @cached_property
    def _join(self) -> tuple[float, float]:
        """Where trochoid and flank meet: angle of the trochoid, rad, and radius, mm."""
        rack = self.rack
        if self.undercut:
            places = np.linspace(rack.pressure, math.pi / 2, _PLACES)
            with np.errstate(invalid="ignore"):
                crossings = sign_changes(self._outside, places)
            if crossings.size:
                angle = float(crossings[-1])
                return angle, abs(complex(self._trochoid(angle, 0)))
        sine = math.sin(rack.pressure)
        deep = rack.depth - rack.module * (self.shift - rack.fillet * sine)
        # below 0 of a wheel that is hardly undercut: its trochoid begins as far beyond the base circle, beside the flank there
        way = abs(self.reference * sine - deep / sine)
        return rack.pressure, math.hypot(self.base, way)

    def _outside(self, angle: Floats) -> Floats:
        """Angle by which points of the trochoid lie beside the flank, in the space, rad; nan below the base circle."""
        z = self._trochoid(angle, 0)
        roll = np.sqrt((np.abs(z) / self.base) ** 2 - 1)
        return np.asarray(np.angle(z) - self.half_angle(self.base) + roll - np.arctan(roll))

    @property
    def form(self) -> float:
        """Radius at which the flanks end towards the root, mm."""
        return self._join[1]

    def _trochoid(self, angle: Any, order: int) -> Points:
        """The root beside the tooth on Ox, on its left; angle: of the line from the pitch point to the cutter's rounding against
        the pitch line, rad, pi / 2 at the root and the pressure angle at the flank.

        With s = fillet + h / sin(angle), h the depth of the rounding's centre, its derivative is square to that line:
        fillet + h s / (r sin^2) long.
        """
        rack = self.rack
        r = self.reference
        h = rack.depth - rack.module * self.shift
        fillet = rack.fillet * rack.module
        t = np.asarray(angle, float)
        sine = np.sin(t)
        cosine = np.cos(t)
        s = fillet + h / sine
        u = h * cosine / sine - self._cutter_half
        toward = np.exp(-1j * t)
        turn = np.exp(1j * (u / r + self.pitch / 2 - math.pi / 2))
        if order == 0:
            return np.asarray((1j * r + s * toward) * turn)
        length = fillet + h * s / (r * sine**2)
        if order == 1:
            return np.asarray(-1j * toward * turn * length)
        change = -h / r * (h * cosine / sine**4 + 2 * s * cosine / sine**3)
        spin = -1j * (1 + h / (r * sine**2))
        return np.asarray(-1j * toward * turn * (spin * length + change))

    def _flank(self, form: float) -> list[Piece]:
        """The left flank of the tooth on Ox, from the tip to the root."""
        start = self.half_angle(self.base)
        relief = self.relief
        if relief is None or relief.begin >= self.tip:
            return [_side(self, start, self.tip, form)]
        plain = _side(self, start, relief.begin, form)
        eased = partial(_eased, self.base, start, relief, self.tip)
        return [Smooth(eased, self.tangent(self.tip) / self.base, plain.t0), plain]

    @cached_property
    def left(self) -> list[Piece]:
        """The left side of the tooth on Ox, from the tip to the root circle."""
        angle, form = self._join
        root = Smooth(self._trochoid, angle, math.pi / 2)
        return [
            *self._flank(form),
            *_foot(root, complex(root.at(angle)), form, self),
            root,
        ]

    @property
    def right(self) -> list[Piece]:
        """Its right side, from the root circle to the tip."""
        return _other_side(self.left)

    @property
    def half_top(self) -> float:
        """Half of the angle of a tooth's tip, rad."""
        eased = self.relief.amount / self.base if self.relief else 0.0
        return self.half_angle(self.tip) - eased

    @property
    def half_foot(self) -> float:
        """Half of the angle of a tooth on the root circle, rad."""
        return cmath.phase(end_point(self.left[-1]))

    def outline(self) -> Contour:
        """The edge, counter-clockwise about the axis."""
        top = self.half_top
        foot = self.half_foot
        gap = Arc(0j, self.root, foot, self.pitch - 2 * foot)
        arc = Arc(0j, self.tip, -top, 2 * top)
        return _around(self.teeth, self.pitch, self.left, [arc], gap)


def _foot(root: Smooth, begin: complex, form: float, wheel: Wheel) -> list[Piece]:
    """What closes the hair between flank and trochoid where the flank begins at the least roll only."""
    low = max(form, wheel.base * math.hypot(1, LEAST_ROLL))
    end = cmath.rect(low, wheel.half_angle(low))
    return [Line(end, begin)] if abs(end - begin) > _HAIR else []


def _side(teeth: Teeth, start: float, high: float, low: float) -> Smooth:
    """The left flank about Ox between two radii, mm, which leaves the base circle at the polar angle `start`."""
    begin, end = (max(LEAST_ROLL, teeth.tangent(each) / teeth.base) for each in (high, low))
    return Smooth(partial(_unrolled, teeth.base, start), begin, end)


def _unrolled(base: float, start: float, roll: Any, order: int) -> Points:
    """Involute that leaves its base circle at the polar angle `start` and turns to the right as it goes out; order 0..2."""
    t = np.asarray(roll, float)
    spoke = base * np.exp(1j * (start - t))
    return np.asarray((spoke * (1 + 1j * t), t * spoke, spoke * (1 - 1j * t))[order])


def _eased(base: float, start: float, relief: Relief, tip: float, roll: Any, order: int) -> Points:
    """The same, turned back by the relief: amount / base ((R - begin) / (tip - begin))^2."""
    t = np.asarray(roll, float)
    radius = base * np.hypot(1, t)
    slope = base * base * t / radius
    share = (radius - relief.begin) / (tip - relief.begin)
    rate = slope / (tip - relief.begin)
    most = relief.amount / base
    turn = np.exp(-1j * most * share**2)
    z = _unrolled(base, start, t, 0)
    if order == 0:
        return np.asarray(z * turn)
    spin = -2j * most * share * rate
    dz = _unrolled(base, start, t, 1)
    if order == 1:
        return np.asarray((dz + spin * z) * turn)
    bend = base**4 / radius**3 / (tip - relief.begin)
    change = -2j * most * (rate**2 + share * bend)
    ddz = _unrolled(base, start, t, 2)
    return np.asarray((ddz + 2 * spin * dz + (change + spin**2) * z) * turn)


def _other_side(left: Sequence[Piece]) -> list[Piece]:
    """The right side of what is alike about Ox, from the root outwards."""
    return [piece.moved(mirror=True).reversed() for piece in reversed(left)]


def _around(
    count: int, pitch: float, left: Sequence[Piece], top: Sequence[Piece], gap: Arc
) -> Contour:
    """Teeth all round: left side of the one on Ox from top to gap, its top, and the gap on its left."""
    one: list[Piece] = [*_other_side(left), *top, *left, gap]
    turns = [cmath.rect(1, k * pitch) for k in range(count)]
    return Contour(tuple(piece.moved(turn) for turn in turns for piece in one))


@dataclass(frozen=True)
class Ring(Teeth):
    """A wheel with inner teeth; tip: radius of its tips, mm. A space lies on Ox, shaped as a tooth of the same shift.

    Its roots are rounded by an arc between flank and root circle, as large as the rack's where there is room.
    """

    tip: float = 0.0

    def __post_init__(self) -> None:
        if not self.base < self.tip < self.root:
            raise DesignError(
                "radius of a ring's tips", self.tip, self.base, "mm", "", "use more teeth"
            )
        thick = self.pitch - 2 * self.half_angle(self.tip)
        if thick * self.tip < LEAST_TIP * self.module:
            raise DesignError(
                "thickness of a tooth's tip",
                thick * self.tip,
                LEAST_TIP * self.module,
                "mm",
                f"a ring of {self.teeth} teeth",
                "use more teeth, or a larger shift",
            )

    @property
    def root(self) -> float:
        """Radius of the roots, mm."""
        rack = self.rack
        return self.reference + self.module * (rack.addendum + rack.clearance + self.shift)

    def half_angle(self, radius: float) -> float:
        """Half of a space's angle at a radius, rad."""
        return self._half(radius, self.thinner)

    @property
    def bends(self) -> float:
        """Stress at the root of a tooth that alone bears a force on its tip, MPa mm of width per N: as that of a wheel.

        The force's line leans away from the axis by half of the tooth more than it does on a wheel, and meets the tooth's
        middle inside of its tip.
        """
        half = self.pitch / 2
        lean = math.acos(self.base / self.tip) + half - self.half_angle(self.tip)
        flank = np.linspace(self.tip, self.form, _PLACES)
        gap = np.array([self.half_angle(radius) for radius in flank])
        begin, sweep = self._rounding
        round_off = self._round_centre + self.fillet * np.exp(
            1j * (begin + sweep * np.linspace(1, 0, _PLACES))
        )
        side = np.concatenate([flank * np.exp(1j * gap), round_off]) * cmath.exp(-1j * half)
        arm = side.real - self.base / math.cos(lean)
        return float(np.max(6 * math.cos(lean) * arm / (2 * side.imag) ** 2))

    @property
    def _round_centre(self) -> complex:
        """Centre of a root's rounding on the left of the space on Ox."""
        return cmath.rect(self.root - self.fillet, self._round_angle(self.fillet))

    @property
    def _rounding(self) -> tuple[float, float]:
        """Direction in which that begins at the root circle, and its sweep to the flank, rad."""
        centre = self._round_centre
        end = cmath.rect(self.form, self.half_angle(self.form))
        out = cmath.phase(centre)
        return out, cmath.phase((end - centre) * cmath.exp(-1j * out))

    @cached_property
    def fillet(self) -> float:
        """Radius of the rounding at the roots, mm."""
        whole = self.rack.fillet * self.module
        if self._round_angle(whole) >= 0:
            return whole
        return whole - halved(lambda less: self._round_angle(whole - less) >= 0, 0.0, whole)

    def _round_angle(self, radius: float) -> float:
        """Polar angle of the centre of a rounding of this radius, rad; below 0 it does not fit beside its mirror image."""
        return self.half_angle(self.base) - radius / self.base - self._involute_to(radius)

    def _involute_to(self, radius: float) -> float:
        """Involute angle of the centre of a rounding: it lies on an involute of the same base circle."""
        return involute(math.acos(min(1.0, self.base / (self.root - radius))))

    @property
    def form(self) -> float:
        """Radius at which the flanks end towards the root, mm."""
        way = self.tangent(self.root - self.fillet) + self.fillet
        return math.hypot(self.base, way)

    def outline(self) -> Contour:
        """The hole's edge, counter-clockwise about the axis."""
        out, sweep = self._rounding
        low = self.half_angle(self.tip)
        left: list[Piece] = [
            Arc(self._round_centre, self.fillet, out, sweep),
            _side(self, self.half_angle(self.base), self.form, self.tip),
        ]
        root = [Arc(0j, self.root, -out, 2 * out)] if out * self.root > _HAIR else []
        gap = Arc(0j, self.tip, low, self.pitch - 2 * low)
        return _around(self.teeth, self.pitch, left, root, gap)
