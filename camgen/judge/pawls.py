"""Ratchets as their files have them: where the pawl lies on the wheel, where it falls, where the wheel locks, and whether it holds.

The pawl is held where it is wanted, at wheel angles all round, and its distance from the wheel is measured: 0 where both edges are
right, at a drop as anywhere else. Then the pair is followed: one drop to a tooth, and behind each the way back to the lock.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from camgen.findings import Finding, Where, at_least, at_most
from camgen.geometry.rings import Floats, Ring
from camgen.judge.locking import Lock, locks
from camgen.judge.pairs import Body, Jump, OutlinePair, PairMotion, pivots_apart
from camgen.machine.features import PawlPair
from camgen.machine.model import Law
from camgen.numerics import coordinates
from camgen.study import Figure

_STEPS = 1440  # of a turn, at which the distance is measured
_FOLLOWED = 720  # of a turn, from which the pair is followed
_FACETS = 1e-4  # mm
_BEFORE = 1e-6  # rad, before a drop
_ON_FACE = (
    1e-3  # of a pitch, by which a place on a face may lie before its tip: a file's rounding is less
)


@dataclass(frozen=True, eq=False)
class PawlMotion:
    """A wheel and its pawl at the joint's angle 0, about their axes, mm; line: from the wheel's axis to the pawl's, mm.

    wanted: the pawl's angle less its rest over the joint's; drawn: the joint's angle in the wheel's drawing, rad.
    """

    feature: PawlPair
    wheel: Ring
    pawl: Ring
    line: complex
    wanted: Law
    drawn: float

    @cached_property
    def motion(self) -> PairMotion:
        """The pawl over a turn of the wheel, which passes it counter-clockwise: where it passes clockwise, both mirrored."""
        mirrored = self.feature.passes < 0
        line = self.line.conjugate() if mirrored else self.line
        wheel, other = (
            Body([each.moved(mirror=True) if mirrored else each])
            for each in (self.wheel, self.pawl)
        )
        pair = OutlinePair(wheel, other, pivots_apart(line), rest="high")
        begin = self.feature.passes * self.drawn
        start = self.feature.passes * float(self.wanted(np.array([self.drawn]), 0)[0])
        return pair.follow(begin + np.linspace(0.0, math.tau, _FOLLOWED + 1), start)

    @cached_property
    def drops(self) -> list[Jump]:
        """All of a turn."""
        return self.motion.jumps("high")

    @cached_property
    def locks(self) -> list[Lock]:
        """Behind each drop."""
        return list(locks(self.motion, self.drops, "high"))

    @cached_property
    def off(self) -> Floats:
        """Distance of the wheel from the pawl where that is wanted, below 0 an overlap, at `_STEPS` angles, (n,) mm.

        The pawl is smaller by half of its end all round, so that an overlap is a distance too.
        """
        import shapely

        shapely.prepare(self._wheel)
        return np.asarray(shapely.distance(self._wheel, self._placed) - self._shrunk)

    @property
    def _shrunk(self) -> float:
        return self.feature.end / 2

    @cached_property
    def _theta(self) -> Floats:
        """Of the joint, as the wheel turns on."""
        turned = np.linspace(0.0, math.tau, _STEPS, endpoint=False)
        return self.drawn + self.feature.passes * turned

    @cached_property
    def _wheel(self) -> Any:
        return _polygon(self.wheel)

    @cached_property
    def _placed(self) -> Any:
        """The smaller pawl where it is wanted, in the wheel's frame, at each angle."""
        import shapely

        core = _polygon(self.pawl).buffer(-self._shrunk, quad_segs=64)
        corners = shapely.get_coordinates(core) @ np.array([1, 1j])
        turned = np.exp(1j * self.wanted(self._theta, 0))[:, None]
        z = (self.line + turned * corners) * np.exp(-1j * self._theta)[:, None]
        z = z.ravel()
        copies = np.repeat(np.array([core]), len(self._theta))
        return shapely.set_coordinates(copies, coordinates(z))

    def tooth(self, place: complex) -> int:
        """Number of the tooth that has a place of the wheel: one from its tip to the next root.

        place: complex mm, at the joint's angle 0.
        """
        return self._number(math.floor(self._pitches(place) + _ON_FACE))

    def _pitches(self, place: complex) -> float:
        """How many teeth a place is ahead of the first tip, the way that the wheel passes."""
        away = math.atan2(place.imag, place.real) + self.drawn - self.feature.first
        return self.feature.passes * away * self.feature.teeth / math.tau

    def _number(self, ahead: int) -> int:
        """Of a tooth that is so many ahead of the first: the pawl comes to those behind one after the other."""
        return -ahead % self.feature.teeth + 1

    def tooth_at(self, k: int) -> int:
        """The tooth that is nearest to the pawl at one of the angles."""
        import shapely

        near = shapely.get_coordinates(shapely.shortest_line(self._wheel, self._placed[k]))
        return self.tooth(complex(*near[0]))

    def tooth_of(self, drop: Jump) -> int:
        """The tooth off whose tip the pawl falls."""
        before = self.motion.bounds(np.array([drop.theta - _BEFORE]))
        tip = complex(self.motion.touch(before, "high").point[0])
        mirrored = self.feature.passes < 0
        tip = (self.line.conjugate() if mirrored else self.line) + tip
        tip *= complex(np.exp(-1j * drop.theta))
        return self._number(round(self._pitches(tip.conjugate() if mirrored else tip)))

    def figures(self, kind: str) -> list[Figure]:
        """Least and greatest drop and lost angle, and the angle by which the worst tooth draws."""
        of = self.feature.joint
        drops = [abs(math.degrees(each.after - each.before)) for each in self.drops]
        lost = [math.degrees(each.lost) for each in self.locks]
        draws = [math.degrees(each.draw) for each in self.locks]
        found = []
        for quantity, values in (("drop {of}", drops), ("lost angle {of}", lost)):
            for end, pick in (("least", min), ("greatest", max)):
                if values and all(map(math.isfinite, values)):
                    found.append(Figure(f"{end} {quantity}", pick(values), "deg", of, kind=kind))
        if draws and all(map(math.isfinite, draws)):
            found.append(Figure("least draw {of}", min(draws), "deg", of, kind=kind))
        return found


def _polygon(ring: Ring) -> Any:
    import shapely

    z = ring.facetted(_FACETS)
    return shapely.Polygon(coordinates(z))


def judge_pawl(pawl: PawlMotion, off: float, where: Where) -> Iterator[Finding]:
    """MOTION_ERROR, CONTACT and HOLDS of a ratchet; off: how far each outline may lie off, mm; where: the files of both."""
    where = replace(where, joint=pawl.feature.joint)
    yield _error(pawl, 2 * off, where)
    yield _falls(pawl, where)
    if pawl.drops:
        yield _holds(pawl, where)


def _parts(pawl: PawlMotion) -> str:
    (wheel,) = pawl.feature.a
    (other,) = pawl.feature.b
    return f"{other.part} and {wheel.part}"


def _error(pawl: PawlMotion, limit: float, where: Where) -> Finding:
    """MOTION_ERROR: how far both edges are off each other where the pawl is wanted."""
    k = int(np.argmax(np.abs(pawl.off)))
    apart = float(pawl.off[k])
    remark = f"distance of {_parts(pawl)} where the pawl is wanted, at {_STEPS} wheel angles"
    if abs(apart) > limit:
        how = "apart" if apart > 0 else "overlap"
        remark += f"; there they {'are ' if apart > 0 else ''}{how} at tooth {pawl.tooth_at(k)}"
        wrong = np.unique([pawl.tooth_at(int(n)) for n in np.flatnonzero(np.abs(pawl.off) > limit)])
        if len(wrong) == pawl.feature.teeth:
            remark += ", and at all others: the pawl is off, or its pivot"
    theta = 2 * math.pi * k / _STEPS
    place = replace(where, theta=theta, angle="wheel on by")
    return at_most("MOTION_ERROR", abs(apart), limit, "mm", place, remark)


def _falls(pawl: PawlMotion, where: Where) -> Finding:
    """CONTACT: how many teeth the pawl falls behind, in percent."""
    teeth = pawl.feature.teeth
    found = [pawl.tooth_of(each) for each in pawl.drops]
    missing = sorted({*range(1, teeth + 1)} - {*found})
    share = 100 * (teeth - len(missing)) / teeth
    drops = [abs(math.degrees(each.after - each.before)) for each in pawl.drops]
    remark = f"of {teeth} teeth it falls behind {teeth - len(missing)}"
    if drops:
        remark += f", by {min(drops):.3f} to {max(drops):.3f} deg"
    if missing:
        remark += f"; not behind tooth {', '.join(map(str, missing))}"
    return at_least("CONTACT", share, 100, "percent", where, remark)


def _holds(pawl: PawlMotion, where: Where) -> Finding:
    """PAWL_HOLDS: up to which coefficient of friction every tooth, turned back, locks and draws the pawl in."""
    pitch = math.tau / pawl.feature.teeth
    # half a tooth later than meant it is another one that holds
    latest = pawl.feature.lost + pitch / 2
    draws = [each.draw if each.lost < latest else math.nan for each in pawl.locks]
    worst = int(np.argmin(np.nan_to_num(draws, nan=-math.inf)))
    holds = math.tan(draws[worst])
    lost = [math.degrees(each.lost) for each in pawl.locks]
    tooth = pawl.tooth_of(pawl.drops[worst])
    if math.isnan(holds):
        remark = f"tooth {tooth} does not hold the pawl when the wheel is turned back"
    else:
        remark = (
            f"least at tooth {tooth}, which draws the pawl in by {math.degrees(draws[worst]):.2f} deg; "
            f"turned back behind a drop the wheel locks after {min(lost):.3f} to {max(lost):.3f} deg, "
            f"just before the next after up to {math.degrees(pitch) + max(lost):.3f} deg"
        )
    return at_least("PAWL_HOLDS", holds, pawl.feature.friction, "", where, remark)
