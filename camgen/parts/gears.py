"""Pairs of spur gears, outside or in a ring: whole teeth for a distance and a ratio, with the shifts, relief and spokes asked for.

    backlash    along the reference circles, mm: each tooth of a pair is thinner by half of it

The module follows from the distance of the axes and the shifts, so any shifts go with any distance.
[Norton, Design of Machinery, ch. 9]
"""

from __future__ import annotations

import cmath
import math
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import NoReturn

import numpy as np

from camgen.errors import DesignError
from camgen.geometry.outlines import Arc, Contour, Line, Piece
from camgen.numerics import halved
from camgen.parts.wheels.involute import BasicRack, Ring, Wheel
from camgen.parts.wheels.mesh import Mesh, Sizes

_LARGE = 2.0  # mm, module that is not passed where more teeth serve as well
MOST_TEETH = 400  # teeth of a wheel
_WHOLE = 1e-9  # of a ratio, that counts as one of whole numbers
_SMOOTH = 1.2  # contact ratio of a pair whose teeth are found
_LEAST = 1.05  # of one whose teeth are given
_DECIMALS = 3  # of a shift that is found: what a workshop sets
_GRAZE = (
    1e-3  # mm, overlap of a tip and a root that counts as touching: what a file's arcs may be off
)
_LARGEST = 2.0  # shift, modules, up to which one is looked for that mends


@dataclass(frozen=True)
class GearWish:
    """What is asked of a pair's wheels."""

    teeth: int | None = None  # of a; None: found
    shifts: tuple[float, float] | None = (0.0, 0.0)  # modules; None: both flanks slide alike
    relief: float = 0.0  # of the tips, mm
    spokes: int = 0  # of each wheel that has room for them
    inner: bool = False  # whether b is a ring with inner teeth


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
        unit = Sizes(BasicRack(1.0), *teeth, self.side)
        shifts = self.wish.shifts
        if shifts is None:
            found = round(unit.balanced()[0], _DECIMALS)
            shifts = found, -self.side * found
        module = self.distance / unit.distance(*shifts)
        if module < self.least:
            remedy = "put the axes further apart, or take a ratio of smaller whole numbers"
            raise self.refused("module", module, self.least, "mm", remedy)
        mesh = replace(unit, rack=BasicRack(module), backlash=self.backlash).mesh(*shifts)
        return mesh.relieved(self.wish.relief) if self.wish.relief else mesh

    @property
    def side(self) -> int:
        """1: outside, -1: in a ring."""
        return -1 if self.wish.inner else 1

    def refused(
        self, quantity: str, value: float, limit: float, unit: str, remedy: str
    ) -> DesignError:
        """The error that names the pair."""
        return DesignError(quantity, value, limit, unit, self.where, remedy)

    def checked(self, mesh: Mesh) -> Mesh:
        """The pair itself; DesignError, by what to change, where a tip of either runs into the roots or the tips of the other."""
        if mesh.side < 0:
            try:
                mesh.check()
            except DesignError as error:
                raise self._at_pair(error) from None
            return mesh
        overlap = max(mesh.fillet_overlaps)
        if overlap <= _GRAZE:
            return mesh
        shifts = {"shift_a": mesh.a.shift, "shift_b": mesh.b.shift}
        least = {key: self._least_shift(mesh, key) for key in shifts}
        ways = [f"at least {key} = {value:g}" for key, value in least.items() if value is not None]
        key = min(shifts, key=shifts.__getitem__)
        own = least[key]
        where = f"{self.where}: tips would cut {overlap:.2g} mm into the mate's roots"
        remedy = f"use {', or '.join([*ways, 'more teeth'])}"
        limit = 0.0 if own is None else own
        raise DesignError(key, shifts[key], limit, "modules", where, remedy)

    def _least_shift(self, mesh: Mesh, key: str) -> float | None:
        """The least shift of one wheel, rounded up, with which no tip runs into roots, that of the other left; None without any."""
        own = {"shift_a": mesh.a.shift, "shift_b": mesh.b.shift}[key]

        def clear(more: float) -> bool:
            shifts = {"shift_a": mesh.a.shift, "shift_b": mesh.b.shift, key: own + more}
            sizes = Sizes(mesh.a.rack, mesh.a.teeth, mesh.b.teeth, 1, self.backlash)
            try:
                return bool(max(sizes.mesh(**shifts).fillet_overlaps) <= _GRAZE)
            except DesignError:
                return False

        steps = np.arange(own, _LARGEST, 0.05)
        first = next((k for k, shift in enumerate(steps) if clear(float(shift) - own)), None)
        if not first:
            return None
        low = float(steps[first - 1]) - own
        wider = halved(lambda more: clear(low + more), 0.0, 0.05)
        return math.ceil((own + low + wider) * 100) / 100

    def given(self, times: int) -> Mesh:
        """The pair of the teeth that are given; DesignError, by what to change, where they do not mesh."""
        mesh = self._named(times)
        if mesh.contact_ratio < _LEAST:
            other = 'shift = "balanced"' if self.wish.shifts else "a ratio of nearly equal wheels"
            raise self.refused(
                "contact ratio", mesh.contact_ratio, _LEAST, "", f"use more teeth, or {other}"
            )
        return self.checked(mesh)

    def found(self) -> Mesh:
        """The pair of fewest teeth that runs smoothly, with a module that is not larger than it need be."""
        times = math.ceil(2 * self.distance / _LARGE / self._per_module) or 1
        while not self._smooth(times):
            times += 1
        return self.checked(self._named(times))

    @property
    def _per_module(self) -> int:
        """Twice the distance in modules of the least teeth of the ratio."""
        return self.parts.denominator + self.side * self.parts.numerator

    def _smooth(self, times: int) -> bool:
        """Whether the pair is one to take; or so small that it tells why there is none."""
        try:
            mesh = self.mesh(times)
            if mesh.side < 0:
                mesh.check(_SMOOTH)
        except DesignError:
            small = 2 * self.distance / max(self.least, self.distance / MOST_TEETH)
            return times * self._per_module > small
        whole = mesh.side < 0 or self.wish.shifts != (0.0, 0.0) or not mesh.begins_low
        return mesh.contact_ratio >= _SMOOTH and whole

    def _named(self, times: int) -> Mesh:
        """The pair; DesignError, with where a person reads of it, where there is none."""
        try:
            return self.mesh(times)
        except DesignError as error:
            raise self._at_pair(error) from None

    def _at_pair(self, error: DesignError) -> DesignError:
        """The same error, with where a person reads of the pair."""
        if error.where == self.where:
            return error
        where = f"{self.where}, {error.where}" if error.where else self.where
        facts = error.quantity, error.value, error.limit, error.unit, where, error.remedy
        return DesignError(*facts)


def pair(
    distance: float, ratio: float, backlash: float, least: float, wish: GearWish, where: str
) -> Mesh:
    """Two wheels that mesh: angle of b = ratio * angle of a, below 0 outside, above 0 in a ring; distance of their axes, mm.

    least: module that can be made, mm. DesignError, with `where`, if there is no such pair.
    """
    if ratio > 0 and not wish.inner:
        remedy = "inner = true makes b a ring with its teeth inside; or put a link with a wheel between, and two gears, each with a ratio below 0"
        message = f"gear.ratio {ratio:g} at {where}: wheels side by side turn against each other"
        raise DesignError("ratio of wheels", ratio, 0, "", where, remedy).saying(message)
    fraction = Fraction(abs(ratio)).limit_denominator(MOST_TEETH)
    if abs(fraction - abs(ratio)) > _WHOLE * abs(ratio) or not fraction:
        _not_whole(ratio, fraction, where)
    asked = _Pair(distance, backlash, least, fraction, wish, where)
    if not distance > 0:
        remedy = "pin both links to the ground at different points"
        raise asked.refused("distance of the axes", distance, 0, "mm", remedy)
    if wish.inner and fraction >= 1:
        remedy = "make a the pinion and b the ring: a ratio below 1"
        raise asked.refused("ratio of a pinion in a ring", ratio, 1, "", remedy)
    if wish.teeth is None:
        return asked.found()
    if wish.teeth % fraction.numerator:
        remedy = f"take a multiple of {fraction.numerator}, so that the other wheel has whole ones"
        raise asked.refused("teeth", wish.teeth, fraction.numerator, "", remedy)
    return asked.given(wish.teeth // fraction.numerator)


def _not_whole(ratio: float, fraction: Fraction, where: str) -> NoReturn:
    """DesignError that names the nearest ratio of whole teeth."""
    if abs(ratio) >= 1:
        fraction = 1 / Fraction(1 / abs(ratio)).limit_denominator(MOST_TEETH)
    fraction = fraction or Fraction(1, MOST_TEETH)
    nearest = math.copysign(float(fraction), ratio)
    sign = "-" if ratio < 0 else ""
    remedy = f"take one of whole teeth, such as {sign}{fraction.numerator}/{fraction.denominator} = {nearest:.12g}"
    message = f"ratio {ratio:.12g} at {where} is none of wheels of at most {MOST_TEETH} teeth"
    raise DesignError("ratio", ratio, nearest, "", where, remedy).saying(message)


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


def table(mesh: Mesh, wheel: Wheel | Ring) -> tuple[str, ...]:
    """Data of a wheel as a workshop reads them beside its drawing."""
    mate = mesh.b if wheel is mesh.a else mesh.a
    kind = "teeth inside" if isinstance(wheel, Ring) else "teeth"
    rows = [
        f"{wheel.teeth} {kind}, module {wheel.module:.6g}, pressure angle 20 deg",
        f"shift x {wheel.shift:+.3f}, tip circle {2 * wheel.tip:.3f}, root circle {2 * wheel.root:.3f}",
    ]
    if isinstance(wheel, Wheel):
        count, span = wheel.span
        rows.append(f"span over {count} teeth {span:.3f}")
    rows.append(
        f"mate {mate.teeth} teeth at {mesh.distance:.3f}, working pressure angle {math.degrees(mesh.working_angle):.3f} deg, "
        f"contact ratio {mesh.contact_ratio:.2f}"
    )
    if isinstance(wheel, Wheel) and wheel.relief:
        rows.append(
            f"tips relieved by {wheel.relief.amount:g} from a circle of {2 * wheel.relief.begin:.3f}"
        )
    return tuple(rows)
