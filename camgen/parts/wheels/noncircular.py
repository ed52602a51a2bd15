"""Wheels that are not round: centrodes that roll on each other by a law, with teeth as a rack that rolls on them cuts.

    law         the driven wheel's angle over the driver's, rad, both above 0 as they turn, against each other: mean * t + waves
    t           the driver's angle, parameter of both centrodes
    centrode    the curve of a wheel on which the other's rolls; both are as long between two angles
    side        of a centrode on which its wheel's material lies as t grows: 1 left, -1 right
    crossing    length along the centrode at which a flank of the rack crosses its pitch line
    arm         from where the rack's pitch line touches the centrode to where the rack touches the wheel

With p = phi' the centrodes' radii are C p / (1 + p) and C / (1 + p). Square to the rack where it touches the wheel runs the
line to the point on which its pitch line rolls, so each point of an edge and its tangent follow from one t in closed form.
At t = 0 the driver's direction Ox is on the line of both axes, a tooth in its middle; so is the driven wheel's -Ox, a gap there.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from typing import Any, Literal

import numpy as np

from camgen.errors import DesignError
from camgen.geometry.arcs import fit_family
from camgen.geometry.outlines import Contour, Piece
from camgen.numerics import Floats, Points
from camgen.parts.wheels.involute import BasicRack
from camgen.tolerances import SAME_POINT

LEAST_WAVE = 1e-15  # of the mean: smaller waves are rounding
MOST_WAVES = 1024
TOLERANCE = 1e-4  # mm, of the arcs of an edge: a tenth of what files keep to unless a spec says so
_LOOKS = 4096  # places of a turn at which extremes are looked for
_MOST_TURNS = 400
_NEWTON = 30  # steps at most


@dataclass(frozen=True)
class WaveLaw:
    """mean * t + sum of cosines[k - 1] (cos kt - 1) + sines[k - 1] sin kt: 0 at t = 0, and on by as much each turn."""

    mean: float
    cosines: tuple[float, ...] = ()
    sines: tuple[float, ...] = ()

    def __call__(self, t: Any, order: int = 0) -> Floats:
        """Value or derivative of any order at t, rad; waves by Horner's rule."""
        t = np.asarray(t, float)
        unit = np.exp(1j * t)
        total = np.zeros(t.shape, complex)
        for k in reversed(range(1, 1 + self.waves)):
            wave = complex(_wave(self.cosines, k), -_wave(self.sines, k)) * (1j * k) ** order
            total = (total + wave) * unit
        value = total.real
        if order == 0:
            return np.asarray(value + self.mean * t - sum(self.cosines))
        return np.asarray(value + self.mean if order == 1 else value)

    @property
    def reversed(self) -> WaveLaw:
        """The law that turns the other way."""
        back = (tuple(-wave for wave in waves) for waves in (self.cosines, self.sines))
        return WaveLaw(-self.mean, *back)

    @property
    def waves(self) -> int:
        """Number of the last wave."""
        return max(len(self.cosines), len(self.sines))

    @property
    def repeats(self) -> int:
        """How often its slope repeats in a turn; 0 where it is constant."""
        return math.gcd(
            *(k for k in range(1, 1 + self.waves) if _wave(self.cosines, k) or _wave(self.sines, k))
        )

    @classmethod
    def of_slope(cls, slope: Callable[[Floats], Floats]) -> WaveLaw:
        """The law of a smooth slope(t) of period 2 pi, by its waves as far as they count, MOST_WAVES at most."""
        count = 4 * MOST_WAVES
        values = np.fft.rfft(slope(np.arange(count) * math.tau / count))[: MOST_WAVES + 1] / count
        mean = float(values[0].real)
        counts = np.flatnonzero(np.abs(values) > LEAST_WAVE * abs(mean))
        last = int(counts[-1])
        parts = 2 * values[1 : last + 1] / np.arange(1, last + 1)
        return cls(mean, tuple(parts.imag.tolist()), tuple(parts.real.tolist()))


def _wave(waves: Sequence[float], k: int) -> float:
    """The k-th, from 1; 0 beyond."""
    return waves[k - 1] if k <= len(waves) else 0.0


def ellipses(eccentricity: float) -> WaveLaw:
    """Two equal ellipses, each turning about a focus, the driver at its farthest from its axis at t = 0.

    tan(phi / 2) = (1 + e) / (1 - e) tan(t / 2); so phi = t + 2 sum of e^k / k sin kt.
    """
    e = eccentricity
    count = max(1, math.ceil(math.log(LEAST_WAVE) / math.log(e))) if e > 0 else 0
    return WaveLaw(1.0, (), tuple(2 * e**k / k for k in range(1, count + 1)))


@dataclass(frozen=True)
class Centrodes:
    """Of a law at a distance of the axes, mm."""

    law: WaveLaw
    distance: float

    def __post_init__(self) -> None:
        if not self.distance > SAME_POINT:
            remedy = "draw their axes apart"
            raise DesignError("distance of the axes", self.distance, SAME_POINT, "mm", "", remedy)
        t = np.linspace(0, math.tau, _LOOKS)
        slope = self.law(t, 1)
        k = int(np.argmin(slope))
        if not slope[k] > 0:
            least = float(slope[k])
            where = f"driver at {math.degrees(float(t[k])):.1f} deg"
            said = f"the driven wheel turns back ({where}: {least:.3g} times as fast as the driver), and no teeth do that"
            remedy = "make the waves smaller"
            raise DesignError("speed ratio", least, 0, "", where, remedy).saying(said)

    def _reach(self, t: Any, order: int) -> Floats:
        """Of the driver's centrode from its axis, or a derivative, order 0..2, mm."""
        p = self.law(t, 1)
        q = 1 + p
        if order == 0:
            return np.asarray(self.distance * p / q)
        bend = self.law(t, 2)
        if order == 1:
            return np.asarray(self.distance * bend / q**2)
        return np.asarray(self.distance * (self.law(t, 3) / q**2 - 2 * bend**2 / q**3))

    def driver(self, t: Any, order: int = 0) -> Points:
        """The driver's centrode, or a derivative, order 0..2, complex mm about its axis; it runs clockwise."""
        reach = [self._reach(t, k) for k in range(order + 1)]
        angle = [-np.asarray(t, float), np.array(-1.0), np.array(0.0)]
        return _polar(reach, angle, order)

    def driven(self, t: Any, order: int = 0) -> Points:
        """The driven wheel's likewise; it runs counter-clockwise."""
        reach = [self._reach(t, 0) - self.distance, *(self._reach(t, k) for k in (1, 2)[:order])]
        angle = [self.law(t, k) for k in range(order + 1)]
        return _polar(reach, angle, order)

    @cached_property
    def along(self) -> WaveLaw:
        """Length of either centrode from t = 0, mm."""
        return WaveLaw.of_slope(lambda t: np.abs(self.driver(t, 1)))

    @property
    def length(self) -> float:
        """Of the driver's, mm."""
        return math.tau * self.along.mean

    def at_length(self, s: Floats) -> Floats:
        """The t at which the centrodes are so long, (n,), by Newton's method."""
        t = s / self.along.mean
        for _ in range(_NEWTON):
            step = (self.along(t) - s) / self.along(t, 1)
            t = t - step
            if np.max(np.abs(step), initial=0.0) < 1e-14:
                break
        return np.asarray(t)

    def curvature(self, wheel: Literal["driver", "driven"], t: Any) -> Floats:
        """Of a wheel's centrode, 1/mm; below 0 it is hollow."""
        curve, side = (self.driver, -1) if wheel == "driver" else (self.driven, 1)
        d1 = curve(t, 1)
        return np.asarray(side * (d1.conj() * curve(t, 2)).imag / np.abs(d1) ** 3)

    def lean(self, t: Any) -> Floats:
        """Angle by which the common normal of the centrodes leans from the line of both axes, rad."""
        return np.asarray(np.arctan2(self._reach(t, 1), self._reach(t, 0)))


def _polar(r: Sequence[Floats], a: Sequence[Floats], order: int) -> Points:
    """Derivative of r exp(ia), order 0..2, from those of r and a."""
    unit = np.exp(1j * a[0])
    if order == 0:
        return np.asarray(r[0] * unit)
    w = 1j * a[1]
    if order == 1:
        return np.asarray((r[1] + w * r[0]) * unit)
    return np.asarray((r[2] + 2 * w * r[1] + (1j * a[2] + w**2) * r[0]) * unit)


@dataclass(frozen=True)
class NoncircularPair:
    """Both wheels with teeth, which divide both centrodes."""

    centrodes: Centrodes
    teeth: int  # of the driver
    backlash: float = 0.0  # mm along the centrodes; each tooth is thinner by half of it
    pressure: float = math.radians(20)

    def __post_init__(self) -> None:
        self._refuse_open()
        wheels: tuple[Literal["driver", "driven"], ...] = "driver", "driven"
        for wheel in wheels:
            self._refuse_sharp(wheel)

    def _refuse_open(self) -> None:
        """DesignError where the driven wheel's centrode does not close, or no whole number of teeth goes on it."""
        law = self.centrodes.law
        turns = law.repeats / law.mean
        if law.repeats and abs(turns - round(turns)) > 1e-9 * turns:
            said = (
                f"the driven wheel turns once in {1 / law.mean:.6g} turns of the driver, in which the ratio repeats "
                f"{turns:.6g} times: its centrode does not close"
            )
            remedy = "let it turn as often as the ratio repeats over a whole number"
            raise DesignError("repeats", turns, round(turns), "", "", remedy).saying(said)
        teeth = self.teeth / law.mean
        if abs(teeth - round(teeth)) > 1e-9 * teeth:
            least = self._whole_from(self.teeth)
            said = f"the driven wheel would have {teeth:.6g} teeth"
            remedy = f"use teeth = {least}" if least else "use another number of turns"
            raise DesignError(
                "teeth of the driven wheel", teeth, round(teeth), "", "", remedy
            ).saying(said)

    def _whole_from(self, teeth: int) -> int | None:
        """The least number of teeth from `teeth` on with which the driven wheel has a whole number."""
        mean = self.centrodes.law.mean
        fits = (z for z in range(teeth, teeth + 401) if abs(z / mean - round(z / mean)) < 1e-9 * z)
        return next(fits, None)

    def _refuse_sharp(self, wheel: Literal["driver", "driven"]) -> None:
        """DesignError where a wheel's centrode is hollow, or bends so sharply that the rack cuts into the flanks."""
        t = np.linspace(0, math.tau, _LOOKS)
        bend = self.centrodes.curvature(wheel, t)
        flattest = int(np.argmin(bend))
        if not bend[flattest] > 0:
            where = f"driver at {math.degrees(float(t[flattest])):.1f} deg"
            said = f"the centrode of the {wheel} is hollow ({where}), and no rack rolls in there, with any number of teeth"
            remedy = "make the waves smaller"
            raise DesignError("curvature", float(bend[flattest]), 0, "1/mm", where, remedy).saying(
                said
            )
        sharpest = int(np.argmax(bend))
        local = 2 / (self.module * float(bend[sharpest]))
        least = 2 * self.rack.least_shift(0) / math.sin(self.pressure) ** 2
        if not local >= least:
            most = self._whole_from(math.ceil(self.teeth * least / local))
            where = f"driver at {math.degrees(float(t[sharpest])):.1f} deg"
            said = (
                f"the {wheel} bends there like a wheel of {local:.1f} teeth, and the rack undercuts fewer than {least:.1f} "
                f"({where})"
            )
            remedy = f"use teeth = {most} or more, or smaller waves"
            raise DesignError("teeth", local, least, "", where, remedy).saying(said)

    @property
    def turns(self) -> int:
        """Of the driver, after which both stand as before."""
        return Fraction(self.centrodes.law.mean).limit_denominator(_MOST_TURNS).denominator

    @property
    def air(self) -> float:
        """Between two flanks on either side, square to them, mm."""
        return self.backlash / 2 * math.cos(self.pressure)

    @property
    def driven_teeth(self) -> int:
        """Of the driven wheel."""
        return round(self.teeth / self.centrodes.law.mean)

    @property
    def module(self) -> float:
        """mm of length along the centrodes over pi a tooth."""
        return self.centrodes.length / (math.pi * self.teeth)

    @cached_property
    def rack(self) -> BasicRack:
        """The cutter."""
        return BasicRack(self.module, self.pressure)

    def reach(self, wheel: Literal["driver", "driven"]) -> tuple[float, float]:
        """Least and greatest radius of a wheel's centrode, mm."""
        t = np.linspace(0, math.tau, _LOOKS)
        curve = self.centrodes.driver if wheel == "driver" else self.centrodes.driven
        radii = np.abs(curve(t))
        return float(radii.min()), float(radii.max())

    @cached_property
    def driver(self) -> Contour:
        """Edge of the driver, counter-clockwise about its axis, as arcs within TOLERANCE."""
        return _Cut(self, self.centrodes.driver, -1, self.teeth, 0.0).contour.counter_clockwise()

    @cached_property
    def driven(self) -> Contour:
        """Edge of the driven wheel likewise."""
        return _Cut(self, self.centrodes.driven, 1, self.driven_teeth, 0.5).contour


@dataclass(frozen=True)
class _Cut:
    """One wheel as its rack cuts it. All flanks of a kind at once: t (n,) or (n, m), a row of each tooth."""

    pair: NoncircularPair
    curve: Callable[[Any, int], Points]
    side: Literal[1, -1]
    teeth: int
    first: float  # where the middle of the first tooth lies, in pitches

    def _frame(self, t: Floats) -> tuple[Points, Points, Floats]:
        """Place of the centrode, unit tangent, and length from 0."""
        along = self.curve(t, 1)
        return self.curve(t, 0), along / np.abs(along), self.pair.centrodes.along(t)

    def flank(self, crossing: Floats, later: Literal[1, -1], t: Floats) -> tuple[Points, Points]:
        """Points of flanks and unit tangents as t grows; later: 1 for those on a tooth's later side.

        The arm is the part of the rest of the way that is square to the rack's flank. Derivative to the length:
        i lean (side sin + later bend (crossing - s) cos), whose sign stays where nothing is undercut.
        """
        place, along, s = self._frame(t)
        lean = np.exp(-1j * later * self.side * self.pair.pressure) * along
        arm = (crossing - s) * math.cos(self.pair.pressure)
        return np.asarray(place + arm * lean), np.asarray(1j * later * self.side * lean)

    def fillet(self, middle: Floats, t: Floats) -> tuple[Points, Points]:
        """Where the rounding of the rack's tip touches that stands at `middle`, and unit tangents as t falls."""
        rack = self.pair.rack
        place, along, s = self._frame(t)
        centre = middle - s + 1j * self.side * rack.depth
        out = centre / np.abs(centre) * along
        arm = np.abs(centre) + rack.fillet * rack.module
        return np.asarray(place + arm * out), np.asarray(-1j * self.side * out)

    def parallel(self, deep: float, t: Floats) -> tuple[Points, Points]:
        """The curve at a depth inside of the centrode, mm."""
        place, along, _ = self._frame(t)
        return np.asarray(place + 1j * self.side * deep * along), along

    @cached_property
    def contour(self) -> Contour:
        """The edge as t grows."""
        pair = self.pair
        rack = pair.rack
        pitch = math.pi * rack.module
        middle: Floats = ((self.first + np.arange(float(self.teeth))) * pitch)[:, None]
        half = pitch / 4 - pair.backlash / 4
        rounding = rack.fillet * rack.module
        sine = math.sin(rack.pressure)
        cosine = math.cos(rack.pressure)
        reach = (rack.depth + rounding * sine) / (sine * cosine)
        root = half + rack.depth * math.tan(rack.pressure) + rounding / cosine
        at = pair.centrodes.at_length
        rise: Floats = middle - half
        fall: Floats = middle + half
        up = self._tip(rise, -1)
        down = self._tip(fall, 1)
        low = at(middle - half - reach), at(middle + half + reach)
        ends = at(middle - root), at(middle + root), at(middle + pitch - root)
        families = [
            fit_family(lambda t: self.fillet(middle - root, t), ends[0], low[0], TOLERANCE),
            fit_family(lambda t: self.flank(rise, -1, t), low[0], up[0], TOLERANCE),
            fit_family(
                lambda t: self.parallel(-rack.addendum * rack.module, t), up[1], down[1], TOLERANCE
            ),
            fit_family(lambda t: self.flank(fall, 1, t), down[0], low[1], TOLERANCE),
            fit_family(lambda t: self.fillet(middle + root, t), low[1], ends[1], TOLERANCE),
            fit_family(
                lambda t: self.parallel(rack.depth + rounding, t), ends[1], ends[2], TOLERANCE
            ),
        ]
        pieces: list[Piece] = []
        for tooth in zip(*families, strict=True):
            pieces += [piece for family in tooth for piece in family]
        return Contour(tuple(pieces))

    def _tip(self, crossing: Floats, later: Literal[1, -1]) -> tuple[Floats, Floats]:
        """Where flanks meet the tips' curve: t of both, (n, 1) each, by Newton's method."""
        pair = self.pair
        rack = pair.rack
        high = rack.addendum * rack.module
        sine = math.sin(rack.pressure)
        cosine = math.cos(rack.pressure)
        t = pair.centrodes.at_length(crossing - later * high / (sine * cosine))
        u = pair.centrodes.at_length(crossing - later * high * sine / cosine)
        for _ in range(_NEWTON):
            point, tangent = self.flank(crossing, later, t)
            top, along = self.parallel(-high, u)
            speed, bend = self._bend(t)
            rate = speed * (sine + later * bend * (crossing - pair.centrodes.along(t)) * cosine)
            top_speed, top_bend = self._bend(u)
            top_rate = top_speed * (1 + high * top_bend)
            gap = point - top
            cross = (tangent.conj() * along).imag
            step = (gap.conj() * along).imag / cross / rate
            other = (gap.conj() * tangent).imag / cross / top_rate
            t = t - step
            u = u - other
            if np.max(np.abs(step) + np.abs(other)) < 1e-14:
                break
        return t, u

    def _bend(self, t: Floats) -> tuple[Floats, Floats]:
        """Speed of the centrode, mm/rad, and its curvature, 1/mm, above 0 where it is convex."""
        along = self.curve(t, 1)
        speed = np.abs(along)
        return speed, self.side * (along.conj() * self.curve(t, 2)).imag / speed**3
