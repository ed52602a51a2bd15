"""Disc cams by their limits: a quick survey of a design, and the smallest one that keeps to them.

survey  profile, curvature and pressure angle on a grid, extremes by parabolas: for searching among many designs
size    what is sought: the distance of the follower from the axis at s = 0, along its way in (mm); for a tip in line with
        the axis the prime radius, for a face the base radius
make    size -> cam
[Norton, Cam Design and Manufacturing Handbook, ch. 7]
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any

import numpy as np

from camgen.errors import DesignError
from camgen.machine.cams.followers import (
    FlatFace,
    Follower,
    RoundTip,
    SlidingTip,
    SwingingArm,
    SwingingFace,
)
from camgen.machine.cams.limits import CamLimits
from camgen.machine.cams.profile import DiscCam
from camgen.machine.cams.shoes import Shoe, SwingingShoe
from camgen.numerics import Floats

_CUSP = (
    0.01  # mm, radius of curvature under a flat face, nearer than which to 0 a profile has a cusp
)
_GROWTH = 1.25  # from one try to the next, until a size is large enough
_STEPS = 60
_SETTLED = 1e-13  # of the size
_LARGEST = 500.0  # mm, a radius that is looked for, and in strokes, whichever is more
_STROKES = 10.0
_STEP = math.radians(1.5)  # of a survey
_WRITTEN = (1.0, 0.5, 0.2, 0.1, 0.05, 0.02, 0.01)  # mm, steps of sizes as a workshop writes them
_COARSEST = 0.025  # of the size, such a step
_EXACT = 1e-9  # of a step, by which a size that is one already may be more
_INSIDE = 1e-9  # of a segment, from its ends to the first and last place that is surveyed


@dataclass(frozen=True)
class Survey:
    """What a quick look at a design shows, the profile untrimmed."""

    pressure: float  # largest pressure angle, rad
    least_radius: float  # of the convex profile, mm; below 0: undercut, inf: none
    clear: float  # least distance of the follower from the shaft's axis, mm


def survey(cam: DiscCam[Follower]) -> Survey:
    """A design's pressure angle and least radius, to some 1e-3 of a degree and of the radius, without its outline."""
    grids = []
    rows = []
    for segment, begin in zip(cam.program.segments, cam.program.joints, strict=False):
        # of a table's many knots none matters: its acceleration is continuous
        breaks = segment.law.breaks if segment.scale and len(segment.law.breaks) < _STEPS else ()
        for a, b in pairwise((0.0, *breaks, 1.0)):
            count = max(8, math.ceil((b - a) * segment.span / _STEP)) if segment.scale else 2
            at = segment.span * np.linspace(a + _INSIDE, b - _INSIDE, count)
            grids.append(begin + at)
            rows.append(
                [segment.at(at, k) if segment.scale or not k else np.zeros(count) for k in range(3)]
            )
    theta = np.concatenate(grids)
    orders = [np.concatenate(parts) for parts in zip(*rows, strict=True)]

    def motion(_: Any, order: int) -> Floats:
        return orders[order]

    follower = cam.cutter
    profile = follower.envelope(theta, motion, 0)
    normal = follower.normal(theta, motion)
    turn = np.exp(1j * theta)
    steep = follower.pressure_angle(orders[0], profile * turn, normal * turn)
    tip = follower.tip_radius if isinstance(follower, RoundTip) else None
    radius = follower.radius(theta, motion)
    # the curvature of a pitch curve, not the radius, is smooth where a hollow begins
    smooth = radius if tip is None else 1 / (radius + tip)
    bend = (
        -_peak(-smooth, grids)
        if tip is None
        else 1 / peak - tip
        if (peak := _peak(smooth, grids)) > 0
        else math.inf
    )
    clear = float(np.min(follower.clear(theta, motion)))
    return Survey(_peak(steep, grids), bend, clear)


def _peak(y: Floats, grids: list[Floats]) -> float:
    """Largest value of y, given on one even grid after the other: of the parabola through the best three points."""
    k = int(np.argmax(y))
    begin = 0
    for grid in grids:
        if k < begin + len(grid):
            break
        begin += len(grid)
    if not begin < k < begin + len(grid) - 1:
        return float(y[k])
    before, middle, after = (float(value) for value in y[k - 1 : k + 2])
    bow = before - 2 * middle + after
    return middle - (after - before) ** 2 / (8 * bow) if bow < 0 else middle


def spare(cam: DiscCam[Follower], pressure: float, least_radius: float) -> float:
    """How much better than the limits a cam is at its worst, rad or a share; below 0: it breaks one.

    pressure: rad; least_radius: mm, of the profile where it is convex, below 0 where an undercut is accepted. The follower
    must stay off the shaft's axis.
    """
    steep = cam.greatest(cam.pressure_angle_untrimmed)[1]
    if not cam.greatest(lambda theta: -cam.cutter.clear(theta, cam.program))[1] < 0:
        return -1.0
    return min(pressure - steep, (cam.least_radius - least_radius) / (abs(least_radius) or 1.0))


def smallest(
    make: Callable[[float], DiscCam[Follower]],
    pressure: float,
    least_radius: float,
    low: float,
    high: float,
) -> float:
    """The smallest size between low and high that keeps to both limits, exact to rounding; DesignError where none does.

    Sizes are tried growing until one keeps to the limits, then the last step is narrowed.
    """

    def at(size: float) -> float:
        return spare(make(size), pressure, least_radius)

    size = low
    value = at(low)
    before = short = math.nan
    while not value >= 0:
        if size >= high:
            best = math.degrees(make(high).greatest(make(high).pressure_angle_untrimmed)[1])
            raise DesignError(
                "pressure angle",
                best,
                math.degrees(pressure),
                "deg",
                f"the largest cam that is looked for, {high:.4g} mm",
                "no base_radius keeps to limits.pressure_angle_deg and limits.least_radius: allow more, spread the motion over more "
                "of the turn, or change the follower",
            )
        before = size
        short = value
        size = min(size * _GROWTH, high)
        value = at(size)
    # regula falsi; the weight of an end that stays twice is halved [the Illinois method]
    last = 0
    for _ in range(_STEPS):
        if not short < 0 or size - before <= _SETTLED * size or value == 0:
            break
        margin = at(middle := size - value * (size - before) / (value - short))
        if margin >= 0:
            size = middle
            value = margin
            short = short / 2 if last > 0 else short
            last = 1
        else:
            before = middle
            short = margin
            value = value / 2 if last < 0 else value
            last = -1
    return size


def written(least: float, fits: Callable[[float], bool] = lambda _: True) -> float:
    """A size as a workshop writes it, not below the least one and not much above: in the coarsest step, of 0.01 to 1 mm and
    at most 2.5 % of it, in which the next or the one after fits; the least itself where none does. All mm."""
    for step in _WRITTEN:
        if step > _COARSEST * least:
            continue
        count = math.ceil(least / step - _EXACT)
        for size in (round(count * step, 2), round((count + 1) * step, 2)):
            if fits(size):
                return size
    return least


def largest(stroke: float) -> float:
    """Up to which radius a cam is looked for that moves its follower by a stroke, both mm; a larger one is the user's to give."""
    return max(_LARGEST, _STROKES * stroke)


def least_base_radius(
    cam: DiscCam[Any], limits: CamLimits, room: float
) -> tuple[float, Callable[[float], bool]]:
    """Base radius of the smallest cam that keeps to the limits, mm, and whether another one does, as `written` asks; DesignError
    where none does.

    cam: of any size: its follower's way, shape and program; room: radius of a circle that the cam must hold, mm.
    """
    follower = cam.follower
    radius = 0.0
    beside = 0.0
    if isinstance(follower, RoundTip):
        radius = follower.tip_radius
    if isinstance(follower, SlidingTip):
        beside = (follower.start * follower.along.conjugate()).imag
    stroke = float(np.ptp(cam.program.extremes))
    match follower:
        case SwingingFace(pivot, _, ahead):
            low = radius + 1e-3 * abs(pivot)
            high = 0.999 * abs(pivot) + ahead
        case SwingingArm(pivot, arm):
            far = abs(pivot)
            arm = abs(arm)
            low = max(1.001 * abs(far - arm), radius + 1e-3 * far)
            high = 0.999 * (far + arm)
        case SwingingShoe():  # as near to the axis, and as far from it, as its outline comes
            away = follower.distance(follower.seen(np.linspace(0, math.tau, 1441), 0j))
            low = max(1.001 * float(np.min(away)), 1e-3 * abs(follower.pivot))
            high = 0.999 * float(np.max(away))
        case _:
            low = radius + 1e-3 * stroke
            high = largest(stroke + radius)

    def base(size: float) -> float:
        return math.hypot(size, beside) - radius

    def on(radius: float) -> DiscCam[Any]:
        return replace(cam, follower=follower.on_base(radius))

    # of an arm and a pivot's distance one is a thousandth of the other, or less
    if low > high:
        raise DesignError(
            "radius of the pitch circle",
            low,
            high,
            "mm",
            "the follower's rest",
            "arm and pivot_distance leave no base_radius to choose: set them nearer to each other",
        )
    low = min(max(low, math.sqrt(max(0.0, (room + radius) ** 2 - beside**2))), high)
    steepest = math.radians(limits.steepest(cam))
    least = limits.least_radius
    if isinstance(follower, FlatFace | Shoe) and abs(least) < _CUSP:
        least = _CUSP
    found = base(smallest(lambda size: on(base(size)), steepest, least, low, high))
    most = base(high)
    return found, lambda radius: radius <= most and spare(on(radius), steepest, least) >= 0
