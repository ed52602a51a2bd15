"""The judge of rows of pins: when each pin meets its tooth and lets it go, from a section of a file alone.

With the tooth on the x axis and the part turning counter-clockwise, the tip is at rest at r and goes along the line x = r, y > 0. A
point p beyond the circle r, of the angle b, crosses that line when the part has turned by acos(r / |p|) - b. So a pin meets the tooth
where its outline goes into the circle, at -b, and lets it go when the last of its points crosses: at a corner, since along an edge
that time has no maximum between the ends.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from camgen.findings import Finding, Where, at_least, at_most
from camgen.geometry.rings import Ring
from camgen.judge.measured import Sections
from camgen.machine.features import PinRow
from camgen.numerics import Points

_FINE = 1e-5  # mm, to which arcs of an exact outline are taken as facets


@dataclass(frozen=True)
class FoundPin:
    """A pin as a section shows it: angles by which the part has turned, rad."""

    meets: float  # when it touches its tooth
    releases: float  # when it lets it go; later than that


def found_pins(ring: Ring, row: PinRow) -> list[FoundPin]:
    """All that stands beyond the teeth's tips on an outline, in the order of its releases from 0 up to a turn."""
    tip = abs(row.tip)
    points = ring.counter_clockwise().facetted(_FINE) * np.conj(row.tip) / tip
    if row.sense < 0:
        points = points.conj()[::-1]
    pins = []
    for run in _beyond(_with_feet(points), tip):
        angle = np.unwrap(np.angle(run))
        crossing = np.arccos(np.minimum(tip / np.abs(run), 1.0)) - angle
        last = float(np.max(crossing))
        turns = math.floor(last / math.tau) * math.tau
        pins.append(FoundPin(float(-angle[-1]) - turns, last - turns))
    return sorted(pins, key=lambda pin: pin.releases)


def _with_feet(points: Points) -> Points:
    """The polygon with a corner more on each edge that passes nearest to the origin between its ends."""
    way = np.roll(points, -1) - points
    share = -np.real(points * way.conj()) / np.abs(way) ** 2
    inside = (share > 0) & (share < 1)
    feet = np.where(inside, points + share * way, np.nan)
    both = np.stack([points, feet], axis=1).ravel()
    return np.asarray(both[~np.isnan(both)])


def _beyond(points: Points, radius: float) -> Iterator[Points]:
    """The stretches of a polygon beyond a circle about the origin, each up to where it comes back to the circle."""
    out = np.abs(points) > radius
    if out.all() or not out.any():
        return
    begins = np.flatnonzero(out & ~np.roll(out, 1))
    for k in begins.tolist():
        count = int(np.argmin(np.roll(out, -k)))
        run = np.roll(points, -k)[:count]
        after = points[(k + count) % len(points)]
        yield np.append(run, _crossing(after, run[-1], radius))


def _crossing(low: complex, high: complex, radius: float) -> complex:
    """Where the stretch from a point inside a circle to one outside crosses it."""
    way = high - low
    along = (low.conjugate() * way).real / abs(way) ** 2
    share = -along + math.sqrt(along**2 + (radius**2 - abs(low) ** 2) / abs(way) ** 2)
    return complex(low + share * way)


def judge_row(row: PinRow, sections: Sections, where: Where, off: float) -> list[Finding]:
    """RELEASE_ANGLE of the row's worst pin, and PIN_SPACING, at the worst of its heights.

    sections: of the row's layer, about the part's bore; off: mm, by which a pin's corner may be off its place.
    """
    found: dict[str, list[Finding]] = {}
    for shapes in sections:
        outer = max((shape.outer for shape in shapes), key=lambda ring: abs(ring.area))
        for finding in _judged(row, found_pins(outer, row), where, off):
            found.setdefault(finding.code, []).append(finding)
    return [max(each, key=_badness) for each in found.values()]


def _badness(finding: Finding) -> float:
    measured = -finding.measured if finding.floor else finding.measured
    return math.inf if math.isnan(measured) else measured


def _judged(row: PinRow, pins: Sequence[FoundPin], where: Where, off: float) -> Iterator[Finding]:
    """Both findings at one height; pins: as found."""
    wanted = np.array(row.releases)
    found = np.array([pin.releases for pin in pins])
    apart = np.remainder(found[:, None] - wanted + math.pi, math.tau) - math.pi
    nearest = np.argmin(np.abs(apart), axis=1) if len(found) else np.zeros(0, int)
    count = np.bincount(nearest, minlength=len(wanted))
    limit = math.degrees(off * row.shift)
    if (count != 1).any():
        yield at_most("RELEASE_ANGLE", math.nan, limit, "deg", where, _strange(row, count.tolist()))
        return
    errors = apart[np.arange(len(found)), nearest]
    k = int(np.argmax(np.abs(errors)))
    error = float(errors[k])
    angle = math.degrees(row.releases[nearest[k]] + error)
    side = "late" if error > 0 else "early"
    message = (
        f"row {row.name}, pin {nearest[k] + 1}: lets its tooth go at {angle:.3f} deg, "
        f"{_ms(row, abs(error)):.3g} ms {side}; the worst of {len(wanted)}"
    )
    yield at_most("RELEASE_ANGLE", math.degrees(abs(error)), limit, "deg", where, message)
    meets = np.array([pin.meets for pin in pins])
    free = np.append(meets[1:], meets[0] + math.tau) - found
    k = int(np.argmin(free))
    least = float(free[k])
    message = (
        f"row {row.name}, after pin {nearest[k] + 1}: the tooth is free for {_ms(row, least):.4g} ms; "
        f"it comes to rest in {_ms(row, row.back):.4g} ms"
    )
    gap = at_least(
        "PIN_SPACING", math.degrees(least), math.degrees(row.back), "deg", where, message
    )
    yield gap.within(2 * limit)


def _ms(row: PinRow, angle: float) -> float:
    """Time in which the part turns by an angle, ms."""
    return 1e3 * angle / row.rate


def _strange(row: PinRow, count: Sequence[int]) -> str:
    """Which pins are missing, and where there are more than one."""
    texts = []
    for k, pins in enumerate(count):
        pin = f"pin {k + 1}, at {math.degrees(row.releases[k]):g} deg,"
        if pins == 0:
            texts.append(f"{pin} is missing")
        elif pins > 1:
            texts.append(f"{pin} is not alone: {pins} let go near there")
    return f"row {row.name}: {'; '.join(texts)}"
