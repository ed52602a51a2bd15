"""Pairs of spur gears: whole teeth for a distance and a ratio, with the shifts, relief and spokes that are asked for.

    backlash    along the reference circles, mm: each tooth of a pair is thinner by half of it

The module follows from the distance of the axes and the shifts, so any shifts go with any distance.
[Norton, Design of Machinery, ch. 9]
"""

from __future__ import annotations

import cmath
import math
from dataclasses import dataclass
from fractions import Fraction
from typing import NoReturn

from camgen.errors import DesignError
from camgen.geometry.outlines import Arc, Contour, Line, Piece
from camgen.parts.wheels.involute import BasicRack, Wheel
from camgen.parts.wheels.mesh import Mesh, Sizes

_LARGE = 2.0  # mm, module that is not passed where more teeth serve as well
_MOST = 400  # teeth of a wheel
_WHOLE = 1e-9  # of a ratio, that counts as one of whole numbers
_SMOOTH = 1.2  # contact ratio of a pair whose teeth are found
_LEAST = 1.05  # of one whose teeth are given
_DECIMALS = 3  # of a shift that is found: what a workshop sets


@dataclass(frozen=True)
class GearWish:
    """What is asked of a pair's wheels."""

    teeth: int | None = None  # of a; None: found
    shifts: tuple[float, float] | None = (0.0, 0.0)  # modules; None: both flanks slide alike
    relief: float = 0.0  # of the tips, mm
    spokes: int = 0  # of each wheel that has room for them


@dataclass(frozen=True)
class _Pair:
    """A pair to be found: whole parts of its ratio, and where a person reads of it."""

    distance: float
    backlash: float
    least: float  # module, mm
    parts: Fraction  # of the ratio: teeth of a over those of b
    wish: GearWish
    where: str

    def mesh(self, times: int) -> Mesh:
        """With so many times the least teeth; DesignError where there is no such pair."""
        teeth = times * self.parts.numerator, times * self.parts.denominator
        shifts = self.wish.shifts
        if shifts is None:
            found = Sizes(BasicRack(1.0), *teeth).balanced()[0]
            shifts = round(found, _DECIMALS), -round(found, _DECIMALS)
        module = self.distance / Sizes(BasicRack(1.0), *teeth).distance(*shifts)
        if module < self.least:
            remedy = "put the axes further apart, or take a ratio of smaller whole numbers"
            raise self.refused("module", module, self.least, "mm", remedy)
        mesh = Sizes(BasicRack(module), *teeth, backlash=self.backlash).mesh(*shifts)
        return mesh.relieved(self.wish.relief) if self.wish.relief else mesh

    def refused(
        self, quantity: str, value: float, limit: float, unit: str, remedy: str
    ) -> DesignError:
        """The error that names the pair."""
        return DesignError(quantity, value, limit, unit, self.where, remedy)

    def given(self, times: int) -> Mesh:
        """The pair of the teeth that are given; DesignError, by what to change, where they do not mesh."""
        mesh = self._named(times)
        if mesh.contact_ratio < _LEAST:
            other = 'shift = "balanced"' if self.wish.shifts else "a ratio of nearly equal wheels"
            raise self.refused(
                "contact ratio", mesh.contact_ratio, _LEAST, "", f"use more teeth, or {other}"
            )
        return mesh

    def found(self) -> Mesh:
        """The pair of fewest teeth that runs smoothly, with a module that is not larger than it need be."""
        parts = self.parts.numerator + self.parts.denominator
        times = math.ceil(2 * self.distance / _LARGE / parts) or 1
        while not self._smooth(times):
            times += 1
        return self._named(times)

    def _smooth(self, times: int) -> bool:
        """Whether the pair is one to take; or so small that it tells why there is none."""
        try:
            mesh = self.mesh(times)
        except DesignError:
            parts = self.parts.numerator + self.parts.denominator
            return times * parts > 2 * self.distance / max(self.least, self.distance / _MOST)
        whole = self.wish.shifts != (0.0, 0.0) or not mesh.begins_low
        return mesh.contact_ratio >= _SMOOTH and whole

    def _named(self, times: int) -> Mesh:
        """The pair; DesignError, with where a person reads of it, where there is none."""
        try:
            return self.mesh(times)
        except DesignError as error:
            if error.where == self.where:
                raise
            where = f"{self.where}, {error.where}" if error.where else self.where
            facts = error.quantity, error.value, error.limit, error.unit, where, error.remedy
            raise DesignError(*facts) from None


def pair(
    distance: float, ratio: float, backlash: float, least: float, wish: GearWish, where: str
) -> Mesh:
    """Two wheels that mesh outside: angle of b = ratio * angle of a, ratio below 0; distance of their axes, mm.

    least: module that can be made, mm. DesignError, with `where`, if there is no such pair.
    """
    if ratio > 0:
        remedy = "put a link with a wheel between, and two gears, each with a ratio below 0"
        message = f"gear.ratio {ratio:g} at {where}: wheels side by side turn against each other, and no inner teeth are made"
        raise DesignError("ratio of wheels", ratio, 0, "", where, remedy).saying(message)
    fraction = Fraction(abs(ratio)).limit_denominator(_MOST)
    if abs(fraction - abs(ratio)) > _WHOLE * abs(ratio) or not fraction:
        _not_whole(ratio, fraction, where)
    asked = _Pair(distance, backlash, least, fraction, wish, where)
    if not distance > 0:
        remedy = "pin both links to the ground at different points"
        raise asked.refused("distance of the axes", distance, 0, "mm", remedy)
    if wish.teeth is None:
        return asked.found()
    if wish.teeth % fraction.numerator:
        remedy = f"take a multiple of {fraction.numerator}, so that the other wheel has whole ones"
        raise asked.refused("teeth", wish.teeth, fraction.numerator, "", remedy)
    return asked.given(wish.teeth // fraction.numerator)


def _not_whole(ratio: float, fraction: Fraction, where: str) -> NoReturn:
    """DesignError that names the nearest ratio of whole teeth."""
    if abs(ratio) >= 1:
        fraction = 1 / Fraction(1 / abs(ratio)).limit_denominator(_MOST)
    fraction = fraction or Fraction(1, _MOST)
    remedy = f"take one of whole teeth, such as -{fraction.numerator}/{fraction.denominator} = {-float(fraction):.12g}"
    message = f"ratio {ratio:.12g} at {where} is none of wheels of at most {_MOST} teeth"
    raise DesignError("ratio", ratio, -float(fraction), "", where, remedy).saying(message)


def windows(wheel: Wheel, spokes: int, hub: float, wall: float) -> list[Contour]:
    """What straight spokes leave open between hub and rim, with rounded corners; none where there is no room.

    hub: diameter of what stays round the bore; wall: width of each spoke and of the rim under the teeth, mm.
    """
    if not spokes:
        return []
    half = math.pi / spokes
    round_off = wall / 4
    aside = wall / 2 + round_off  # of a corner's centre from the middle of its spoke
    outer = wheel.root - wall
    far = outer - round_off
    near = max(hub / 2 + round_off, aside / math.sin(half))
    if far - near < wall:
        return []
    low = min(half, math.asin(aside / near))
    high = math.asin(aside / far)
    side: list[Piece] = [
        Arc(cmath.rect(near, low), round_off, low + math.pi, math.pi / 2 - low),
        Line(cmath.rect(near, low) - 1j * round_off, cmath.rect(far, high) - 1j * round_off),
        Arc(cmath.rect(far, high), round_off, -math.pi / 2, math.pi / 2 + high),
    ]
    other = [
        piece.moved(cmath.rect(1, 2 * half), mirror=True).reversed() for piece in reversed(side)
    ]
    rim = Arc(0j, outer, high, 2 * (half - high))
    inner = [Arc(0j, hub / 2, 2 * half - low, -2 * (half - low))] if low < half else []
    window = Contour((*side, rim, *other, *inner))
    return [window.moved(cmath.rect(1, 2 * half * k)) for k in range(spokes)]


def table(mesh: Mesh, wheel: Wheel) -> tuple[str, ...]:
    """Data of a wheel as a workshop reads them beside its drawing."""
    count, span = wheel.span
    mate = mesh.b if wheel is mesh.a else mesh.a
    rows = [
        f"{wheel.teeth} teeth, module {wheel.module:.6g}, pressure angle 20 deg",
        f"shift x {wheel.shift:+.3f}, tip circle {2 * wheel.tip:.3f}, root circle {2 * wheel.root:.3f}",
        f"span over {count} teeth {span:.3f}",
        f"mate {mate.teeth} teeth at {mesh.distance:.3f}, working pressure angle {math.degrees(mesh.working_angle):.3f} deg, "
        f"contact ratio {mesh.contact_ratio:.2f}",
    ]
    if wheel.relief:
        rows.append(
            f"tips relieved by {wheel.relief.amount:g} from a circle of {2 * wheel.relief.begin:.3f}"
        )
    return tuple(rows)
