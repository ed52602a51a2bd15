"""What the velocity ratio of the chain stitch must keep, laws in step and a loop that may slide along the nose: closed forms.

[Horobets, Manoilenko; symbols as in `stitch`]
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise

from camgen.machines.chain_stitch_looper.stitch import HAIR, VANISHING, Design, Pair, Stitch


@dataclass(frozen=True)
class Condition:
    """What the velocity ratio r must keep: `spare` of it must not be negative, and changes sign at `roots` alone."""

    name: str
    spare: Callable[[float], float]
    roots: tuple[float, ...]


def ratio_conditions(
    design: Design, blade: float, clearance: float = 0.0, loop_angle: float = math.pi
) -> list[Condition]:
    """What the velocity ratio must keep, for laws in step and a loop that may slide along the nose; all in closed form.

    blade: length of the spreaders' blade, mm; clearance: of needles and P6, mm; loop_angle: greatest difference of the
    loops' angles at the pierce, rad.
    """
    g = design.given
    far = max(g.reach)
    conditions = [
        linear("nose 1 past needle 2 when that comes down to it", -g.spacing, g.approach[0]),
        linear("nose 2 past needle 1 when that comes down to it", -g.spacing, g.approach[1]),
        linear("a thread's seat behind the nose, l3 > 0", g.setback - g.needle, far),
        linear(
            "blade as long as the stroke beyond the capture",
            blade,
            min(g.rise) - design.needle_stroke,
        ),
        linear("blade longer than the nose", blade - g.setback, -far - g.height),
    ]
    for pair, lines in fronts(g).items():
        for name, (c0, c1) in zip(("tip", "shoulder"), lines, strict=True):
            conditions.append(_apart(f"{pair}: the needle's {name} before P6", c0, c1, clearance))
    # gamma'1 - gamma'2 is the angle between (x1, y1) and (x2, y2), x = z + (b + L_C/r) r
    y2, y1 = g.levels
    b1 = g.height
    b2 = g.height + g.between

    def alike(r: float) -> float:
        return loop_angle - abs(
            math.atan2(g.spacing + b1 * r, y1) - math.atan2(g.spacing + b2 * r, y2)
        )

    slope = math.tan(min(loop_angle, math.pi / 2 - VANISHING))
    z = g.spacing
    ends = [
        root
        for sign in (1, -1)
        for root in _roots(
            sign * slope * b1 * b2,
            sign * slope * z * (b1 + b2) - (b1 * y2 - b2 * y1),
            sign * slope * (z * z + y1 * y2) - z * (y2 - y1),
        )
    ]
    return [
        *conditions,
        Condition("both loops lean alike within loop_angle_deg", alike, tuple(ends)),
    ]


def fronts(g: Stitch) -> dict[str, tuple[Pair, Pair]]:
    """How far a needle's tip and its shoulder stay before P6 along the stroke, laws in step: c0 + c1 r each; by "N1/P2"."""
    far = max(g.reach)
    ways = {
        "N1/P1": (g.reach[0], 0.0, 0),
        "N2/P1": (g.approach[0], g.spacing, 1),
        "N2/P2": (g.reach[1], 0.0, 1),
        "N1/P2": (g.approach[1], g.spacing, 0),
    }
    # the point widens by d/2 over its height h while the needle retreats by r h
    return {
        pair: (
            (g.setback + lead, far - way),
            (g.setback + lead - g.needle / 2, far - way + g.point[k]),
        )
        for pair, (way, lead, k) in ways.items()
    }


def linear(name: str, c0: float, c1: float) -> Condition:
    """Condition that c0 + c1 r is not negative."""
    return Condition(name, lambda r: c0 + c1 * r, (-c0 / c1,) if c1 else ())


def _apart(name: str, c0: float, c1: float, least: float) -> Condition:
    """A way c0 + c1 r along the stroke that leaves at least so much across P6, whose slope is 1 : r."""
    roots = (
        _roots(c1 * c1 - least * least, 2 * c0 * c1, c0 * c0 - least * least)
        if least
        else linear(name, c0, c1).roots
    )
    return Condition(name, lambda r: c0 + c1 * r - least * math.hypot(1.0, r), roots)


def _roots(a: float, b: float, c: float) -> tuple[float, ...]:
    """Real roots of a r^2 + b r + c, the one without cancellation first."""
    if a == 0:
        return (-c / b,) if b else ()
    square = b * b - 4 * a * c
    if square < 0:
        return ()
    q = -(b + math.copysign(math.sqrt(square), b)) / 2
    return (q / a, c / q) if q else (0.0,)


def ratio_range(
    conditions: Sequence[Condition], ratio: float
) -> tuple[tuple[float, str], tuple[float, str]] | None:
    """Least and greatest r round `ratio` that keep all conditions, or nearest to it, each with what stops it there.

    inf where nothing stops it; None where no r keeps all conditions.
    """
    marks = sorted({(root, c.name) for c in conditions for root in c.roots if root > 0})
    ends = [(0.0, "r > 0"), *marks, (math.inf, "nothing")]
    kept: list[list[tuple[float, str]]] = []
    for low, high in pairwise(ends):
        middle = (low[0] + high[0]) / 2 if math.isfinite(high[0]) else 2 * low[0] + 1
        if (
            high[0] - low[0] <= VANISHING * middle
            or min(c.spare(middle) for c in conditions) < -HAIR
        ):
            continue
        if kept and low[0] - kept[-1][1][0] <= VANISHING * middle:  # touched, not crossed
            kept[-1][1] = high
        else:
            kept.append([low, high])
    if not kept:
        return None
    low, high = min(kept, key=lambda ends: max(ends[0][0] - ratio, ratio - ends[1][0]))
    return low, high
