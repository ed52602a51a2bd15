"""Search for the chain stitch whose smallest clearance is largest; all figures are closed form for laws in step.

The clearances that count: the four of a needle's tip to a spreader's front P6, which is parallel to its way, and how far
each nose is past the other needle's flank when that comes down to it. To enlarge the one the front moves back or the
ratio falls, to enlarge the other the ratio rises; stroke and nose cost room.

All of them are smooth where the needle with the longer reach, or the longer in the fabric, stays the same one: a gradient
method climbs from many places spread over the ranges, and the highest summit counts.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from camgen.errors import DesignError
from camgen.machines.chain_stitch_looper.ratio import fronts
from camgen.machines.chain_stitch_looper.stitch import Pair, Stitch
from camgen.numerics import Floats

_DIGITS = 4  # of the figures that go into the spec
_SPARE = 2e-3  # mm and deg, kept from bounds so that rounding breaks none
_STARTS = 40
_SEED = 20160601
_STEP = 1e-7  # of a difference quotient, mm


@dataclass(frozen=True)
class Room:
    """What the search has to keep."""

    stroke: float  # mm, greatest L_X: wanted.spreader_stroke
    nose: float  # mm, greatest A: wanted.nose_length
    pitch: float  # mm, least H: the shank's height
    clearance: float = 0.0  # mm, least: limits.clearance
    loop_angle: float = 1.0  # deg, greatest difference of the loops' angles at the pierce


def clearances(g: Stitch) -> list[float]:
    """The six distances of a stitch with laws in step, mm: N1/P1, N2/P1, N2/P2, N1/P2 to P6, nose 1 and nose 2."""
    square = math.hypot(1.0, g.ratio)
    ways = [min(c0 + c1 * g.ratio for c0, c1 in lines) / square for lines in fronts(g).values()]
    return [*ways, *(way * g.ratio - g.spacing - g.needle / 2 for way in g.approach)]


def limits_of(g: Stitch, room: Room) -> dict[str, tuple[float, float]]:
    """What else counts: (value, limit), mm or deg, by key; no value above its limit, what has a least value is negative."""
    angle = math.atan2(g.spacing + g.height * g.ratio, g.height + g.plate)
    other = math.atan2(g.spacing + (g.height + g.between) * g.ratio, g.height + g.pitch + g.plate)
    needed = max(g.in_fabric(g.plate)) / g.free_share
    return {
        "wanted.spreader_stroke": (
            g.ratio * (needed if g.stroke is None else g.stroke),
            room.stroke,
        ),
        "wanted.nose_length": ((max(g.reach) + g.height) * g.ratio + g.setback, room.nose),
        "limits.loop_angle_deg": (math.degrees(abs(angle - other)), room.loop_angle),
        "timing.needle_stroke": (needed, needed if g.stroke is None else g.stroke),
        "room for the shank, H": (-g.pitch, -room.pitch),
        "height b": (-g.height, -_SPARE),
        "seat l3": (g.needle - max(g.reach) * g.ratio - g.setback, -_SPARE),
    }


def _spares(g: Stitch, room: Room) -> Floats:
    """How much is left of each limit, mm and deg; without one of needle_stroke where that is free."""
    limits = limits_of(g, room)
    if g.stroke is None:
        del limits["timing.needle_stroke"]
    return np.array([limit - value for value, limit in limits.values()])


def best_clearance(start: Stitch, bounds: Mapping[str, Pair], room: Room) -> Stitch:
    """The stitch within the bounds whose smallest clearance is largest, its figures rounded.

    bounds: least and greatest nose_over_eye, loop_rise, protrusion, plate_to_spreader. Raises DesignError where no design
    keeps all limits, with the limit that is missed by least, and where the best one leaves a needle too little room.
    """
    from scipy.optimize import minimize
    from scipy.stats.qmc import LatinHypercube

    keys = ("nose_over_eye", "loop_rise", "protrusion", "plate_to_spreader")
    a, s, p, e = (bounds[key] for key in keys)
    # strokes are longer than the way in the fabric
    widest = room.stroke / max(start.in_fabric(e[0]))
    ratios = (0.0, max(widest, 2 * start.spacing / e[0]))
    low, high = np.array([a, a, s, s, p, e, (0.0, room.nose), ratios]).T

    def stitch(x: Floats) -> Stitch:
        v = [float(value) for value in x[:8]]
        return replace(
            start,
            over_eye=(v[0], v[1]),
            rise=(v[2], v[3]),
            protrusion=v[4],
            plate=v[5],
            setback=v[6],
            ratio=max(v[7], 1e-6),
        )

    def lacks(g: Stitch) -> float:
        """What a stitch misses its limits by, mm or deg."""
        return max(0.0, -float(np.min(_spares(g, room))))

    def constraints(x: Floats) -> Floats:
        """Clearances above the unknown one, x[8]; the rest of each limit above the unknown lack, x[9]."""
        g = stitch(x)
        return np.concatenate([np.array(clearances(g)) - x[8], _spares(g, room) - _SPARE + x[9]])

    def slopes(x: Floats) -> Floats:
        here = constraints(x)
        return np.array([(constraints(x + step) - here) / _STEP for step in _STEP * np.eye(10)]).T

    first = np.array(
        [*start.over_eye, *start.rise, start.protrusion, start.plate, start.setback, start.ratio]
    )
    spread = low + (high - low) * LatinHypercube(8, rng=np.random.default_rng(_SEED)).random(
        _STARTS
    )
    designs: list[tuple[float, float, Stitch]] = []
    for x in [np.clip(first, low, high), *spread]:
        here = stitch(x)
        # the lack weighs more than any clearance: limits come first
        best = minimize(
            lambda y: 100 * y[9] - y[8],
            [*x, min(clearances(here)), lacks(here)],
            jac=lambda y: np.array([0.0] * 8 + [-1, 100]),
            method="SLSQP",
            bounds=[*zip(low, high, strict=True), (None, None), (0, None)],
            constraints=[{"type": "ineq", "fun": constraints, "jac": slopes}],
            options={"maxiter": 200, "ftol": 1e-9},
        )
        if not np.all(np.isfinite(best.x)):
            continue
        g = stitch(np.clip(np.round(best.x[:8], _DIGITS), low, high))
        designs.append((lacks(g), min(clearances(g)), g))
    lack, least, chosen = min(designs, key=lambda each: (each[0], -each[1]))
    if lack > 0:
        name, (value, limit) = max(
            limits_of(chosen, room).items(), key=lambda each: each[1][0] - each[1][1]
        )
        unit = "deg" if name.endswith("deg") else "mm"
        where = "the design within [wanted] that comes nearest"
        raise DesignError(
            name, abs(value), abs(limit), unit, where, "widen the ranges in [wanted], or this limit"
        )
    if not least > room.clearance:
        raise DesignError(
            "smallest clearance",
            least,
            room.clearance,
            "mm",
            "the best design within [wanted]",
            "widen [wanted], above all spreader_stroke and nose_length, take longer points, or lower limits.clearance",
        )
    return chosen
