"""How a ratchet holds: where its driver locks when it is turned back after a drop, and whether the tooth draws the pawl in.

    drop   jump of the bound on which a spring holds the driven body
    lost   how far the driver turns back from there until nothing of the driven body's pocket is left, rad
    draw   angle at that contact, rad, by which the tooth's push, turned back, draws the driven body to its spring's side; below 0 it
           throws it out. While a coefficient of friction is less than tan(draw), it holds without the spring.

The pocket is followed back by its closed-form ends, step after step, each in touch with the one before, and its end halved down. Where
the push would throw the driven body out, it leaves the pocket and nothing locks.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from camgen.judge.pairs import Jump, PairMotion, Rest

_STEP = math.radians(0.25)  # of the driver, back
_HALVINGS = 20
_BESIDE = 1e-6  # rad, behind a drop
_TOUCH = 1e-9  # rad, by which pockets may miss each other
_SPARE = 1.5  # of the greatest way from drop to drop, in which a ratchet locks

Pocket = tuple[float, float]


@dataclass(frozen=True)
class Lock:
    """Of one drop: how far the driver turns back, and by how much it draws in, rad; nan where it does not lock."""

    lost: float
    draw: float


def locks(motion: PairMotion, drops: Sequence[Jump], side: Rest) -> Iterator[Lock]:
    """The lock behind each drop of the bound on that side, "low" or "high", of a body on a pivot."""
    if not drops:
        return
    places = [drop.theta for drop in drops]
    turn = float(np.ptp(motion.samples.theta))
    most = _SPARE * float(np.max(np.diff([*places, places[0] + turn])))
    for drop in drops:
        yield _lock(motion, drop, side, most)


def ways_back(drops: Sequence[Jump], found: Sequence[Lock]) -> list[float]:
    """How far the driver turns back just before the next drop, which is the most that is lost, rad: drops of one turn."""
    places = [drop.theta for drop in drops]
    ahead = [*places[1:], places[0] + math.tau]
    return [
        after - here + lock.lost for here, after, lock in zip(places, ahead, found, strict=True)
    ]


def _lock(motion: PairMotion, drop: Jump, side: Rest, most: float) -> Lock:
    theta = drop.theta + _BESIDE
    after = motion.bounds(np.array([theta]))
    pocket = float(after.low[0]), float(after.high[0])
    step = _STEP
    while math.isfinite(sum(pocket)) and drop.theta - theta < most:
        before = _next(motion, theta - step, pocket, side)
        if before is not None:
            theta -= step
            pocket = before
        elif step > _STEP / 2**_HALVINGS:
            step /= 2
        else:
            return Lock(drop.theta - theta, _draw(motion, theta, pocket, side))
    return Lock(math.nan, math.nan)


def _next(motion: PairMotion, theta: float, pocket: Pocket, side: Rest) -> Pocket | None:
    """What is free at an angle and in touch with a pocket beside it, nearest to the end on which the spring holds."""
    low, high = pocket
    for least, most in motion.pair.cells(theta, low if side == "low" else high, math.inf):
        if least <= high + _TOUCH and most >= low - _TOUCH:
            return least, most
    return None


def _draw(motion: PairMotion, theta: float, pocket: Pocket, side: Rest) -> float:
    """By the lever of the face that holds the driven body against its spring's side."""
    middle = np.array([sum(pocket) / 2])
    everywhere = (math.inf, math.inf)
    bounds = motion.pair.measured(np.array([theta]), middle, everywhere, False)[0]
    face = motion.touch(bounds, "high" if side == "low" else "low")
    away = float(abs(face.point[0]))
    inwards = 1 if bool(face.slope[0] > 0) == (side == "low") else -1
    # rounding may lift the sine above 1; what is not known stays nan
    return inwards * float(np.arcsin(np.minimum(1.0, face.lever[0] / away)))
