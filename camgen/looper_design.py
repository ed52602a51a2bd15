"""Search for the chain stitch whose smallest clearance is largest; all figures are closed form for laws in step.

The clearances that count: the four of a needle's tip to a spreader's front P6, which is parallel to its way, and how far
each nose is past the other needle's flank when that comes down to it. To enlarge the one the front moves back or the
ratio falls, to enlarge the other the ratio rises; stroke and nose cost room.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from camgen.errors import DesignError
from camgen.stitch import Pair, Stitch

Floats = NDArray[np.float64]

_DIGITS = 4  # of the figures that go into the spec
_SPARE = 1e-3  # mm and deg, kept from bounds so that rounding breaks none
_ALIKE = 0.015  # by which the tangents of the loops' angles may differ, half a degree
_STARTS = 8
_SEED = 20160601


def clearances(g: Stitch) -> list[float]:
    """The six distances of a stitch with laws in step, mm: N1/P1, N2/P1, N2/P2, N1/P2 to P6, nose 1 and nose 2."""
    far, (own1, own2), (in1, in2), (s1, s2) = max(g.reach), g.reach, g.entry, g.rise
    past = ((in1 - s1) * g.ratio - g.spacing, (in2 - s2) * g.ratio - g.spacing)
    l1 = far * g.ratio + g.setback
    square = math.hypot(1.0, g.ratio)
    points = ((own1 * g.ratio, 0), (past[0], 1), (own2 * g.ratio, 1), (past[1], 0))
    fronts = [min(l1 - way, l1 - way + g.ratio * g.point[k] - g.needle / 2) / square for way, k in points]
    return [*fronts, *(gap - g.needle / 2 for gap in past)]


def best_clearance(start: Stitch, bounds: Mapping[str, Pair], stroke: float, nose: float, pitch: float) -> Stitch:
    """The stitch within the bounds whose smallest clearance is largest, its figures rounded.

    bounds: least and greatest nose_over_eye, loop_rise, protrusion, plate_to_spreader; stroke, nose: greatest L_X and A, pitch:
    least H, mm, which is the room for the shank.
    Both loops lean alike: e = z / r. Raises DesignError where every design leaves a needle no room.
    """
    from scipy.optimize import minimize

    a, s, p, e = (bounds[name] for name in ("nose_over_eye", "loop_rise", "protrusion", "plate_to_spreader"))
    ratios = start.spacing / e[1], start.spacing / e[0]
    room = [a, a, s, s, p, ratios, (0.0, nose)]
    low, high = np.array([pair[0] for pair in room]), np.array([pair[1] for pair in room])

    def stitch(x: Floats) -> Stitch:
        return replace(
            start, over_eye=(float(x[0]), float(x[1])), rise=(float(x[2]), float(x[3])), protrusion=float(x[4]),
            ratio=float(x[5]), setback=float(x[6]), plate=start.spacing / float(x[5]),
        )  # fmt: skip

    def rest(g: Stitch) -> list[float]:
        """What must not be negative besides."""
        n = g.needle_stroke(g.in_fabric(g.plate))
        depths = (g.height + g.plate, g.height + g.pitch + g.plate)
        tangents = [(g.spacing + g.height * g.ratio + c * g.ratio) / y for c, y in zip((0.0, g.between), depths, strict=True)]
        return [
            stroke - g.ratio * n, nose - (max(g.reach) + g.height) * g.ratio - g.setback, g.height - 2 * _SPARE, g.pitch - pitch,
            max(g.reach) * g.ratio + g.setback - g.needle - _SPARE, _ALIKE - abs(tangents[0] - tangents[1]),
        ]  # fmt: skip

    def constraints(x: Floats) -> Floats:
        g = stitch(x)
        return np.array([*(c - x[7] for c in clearances(g)), *(v - _SPARE for v in rest(g))])

    first = np.array([*start.over_eye, *start.rise, start.protrusion, start.ratio, start.setback])
    starts = [np.clip(first, low, high), *np.random.default_rng(_SEED).uniform(low, high, (_STARTS, len(low)))]
    best: Stitch | None = None
    for x in starts:
        x8 = np.append(x, min(clearances(stitch(x))))
        found = minimize(
            lambda y: -y[7], x8, method="SLSQP", bounds=[*zip(low, high, strict=True), (None, None)],
            constraints=[{"type": "ineq", "fun": constraints}], options={"maxiter": 300, "ftol": 1e-12},
        )  # fmt: skip
        g = stitch(np.clip(np.round(found.x[:7], _DIGITS), low, high))
        g = replace(g, plate=min(max(round(g.plate, _DIGITS), e[0]), e[1]))
        if min(rest(g)) < 0:
            continue
        if best is None or min(clearances(g)) > min(clearances(best)) + 1e-9:
            best = g
    least = min(clearances(best)) if best is not None else math.nan
    if best is None or not least > 0:
        raise DesignError(
            "smallest clearance", least, 0.0, "mm", "the best design found within the bounds",
            "widen [wanted], above all spreader_stroke and nose_length, or take needles with longer points",
        )  # fmt: skip
    return best
