"""Four-bars whose coupler comes to wanted poses: exact for three to five, least squares for more or within a tolerance.

    3 poses    both centres are free: a grid of them, the best pairs moved by chance
    4 poses    all pairs of dyads on the curve
    5 poses    all pairs of the four dyads at most
    more       from pairs of dyads for four of the poses, that hardly change their length at the others

A four-bar is exact or least squares here; whether it can be used is for `fourbars` to judge.
"""

from __future__ import annotations

import itertools

import numpy as np

from camgen.design.descent import least_squares
from camgen.design.dyads import (
    Dyads,
    Poses,
    five_pose_dyads,
    four_pose_dyads,
    three_pose_dyads,
)
from camgen.design.fourbars import FourBars, Room, closed, joined
from camgen.numerics import Floats, Indices, Points

_GRID = 16  # centres along each side of the box
_TURNS = 720  # of a bar, for which dyads of four poses are found
_FEWER = 180  # of them, where they are to begin a search
_SUBSETS = 20  # of four poses, from which searches begin
_STEADY = 60  # dyads that change their length least, of which pairs are made
_STARTS = 48
_ROUNDS = 60
_SHAKES = 5
_SHAKEN = 30  # pairs of centres, each so often:
_COPIES = 40
_MOST = 200_000  # pairs that are judged at once


def exact_four_bars(poses: Poses, room: Room, rng: np.random.Generator) -> FourBars:
    """Four-bars for three, four or five poses, those with a link or pivot out of bounds left out where they are many."""
    if len(poses.places) == 5:
        return _pairs(poses, five_pose_dyads(poses))
    if len(poses.places) == 4:
        return _pairs(poses, _within(four_pose_dyads(poses, _TURNS), room))
    x = np.linspace(room.low.real, room.high.real, _GRID)
    y = np.linspace(room.low.imag, room.high.imag, _GRID)
    step = max(x[1] - x[0], y[1] - y[0])
    centres = (x[:, None] + 1j * y).ravel()
    made = _pairs(poses, _within(three_pose_dyads(poses, centres), room))
    for shake in range(_SHAKES):
        judged = room.judged(made)
        worth = -judged.transmission[judged.free] / np.sqrt(made.bars[judged.free])
        best = judged.free[np.argsort(worth, kind="stable")[:_SHAKEN]]
        moved = step * 0.5**shake * rng.normal(size=(4, _COPIES * len(best)))
        o = np.tile(made.o[best], _COPIES) + moved[0] + 1j * moved[1]
        c = np.tile(made.c[best], _COPIES) + moved[2] + 1j * moved[3]
        both = [three_pose_dyads(poses, each) for each in (o, c)]
        made = joined(made, _four_bars(poses, *both))
    return made


def near_four_bars(
    poses: Poses,
    room: Room,
    allowance: tuple[float, float],
    rng: np.random.Generator,
    effort: int = 1,
) -> tuple[FourBars, Floats]:
    """Four-bars of least squares for five poses or more, and how far each is off at worst, (2, m).

    allowance: mm and rad that count as much as each other.  Errors: mm, and rad counted from the first pose.
    """
    starts = _starts(poses, room, rng, effort)
    if not starts.o.size:
        return starts, np.zeros((2, 0))
    numbers = _packed(poses, starts)
    sides = np.sign(np.sum(starts.side, axis=0))
    sides[sides == 0] = 1.0
    all_round = starts.turns & (room.turns is not False)

    def residuals(x: Floats, which: Indices) -> Floats:
        bars, (place, angle) = _made(poses, x, sides[which])
        lack = room.lack(bars, all_round[which], allowance[0])
        rows = [place.real / allowance[0], place.imag / allowance[0], angle / allowance[1], *lack]
        return np.concatenate(rows).T

    x, _ = least_squares(residuals, numbers, _ROUNDS)
    bars, (place, angle) = _made(poses, x, sides)
    worst = np.max(np.abs(place), axis=0)
    turned = np.max(np.abs(angle - angle[0]), axis=0)
    sound = np.isfinite(worst) & np.isfinite(turned)
    return bars.those(sound), np.stack([worst[sound], turned[sound]])


def _pairs(poses: Poses, dyads: Dyads) -> FourBars:
    """Four-bars of all pairs of different dyads, either as the crank."""
    first, second = np.nonzero(~np.eye(len(dyads), dtype=bool))
    if len(first) > _MOST:
        every = np.linspace(0, len(first) - 1, _MOST).astype(int)
        first = first[every]
        second = second[every]
    return _four_bars(poses, dyads.those(first), dyads.those(second))


def _four_bars(poses: Poses, crank: Dyads, rocker: Dyads) -> FourBars:
    sound = np.isfinite(crank.points) & np.isfinite(rocker.points)
    crank = crank.those(sound)
    rocker = rocker.those(sound)
    p = np.repeat(poses.places[:, None], len(crank), axis=1)
    a = poses.carried(crank.points)
    return FourBars(crank.centres, rocker.centres, a, poses.carried(rocker.points), p)


def _within(dyads: Dyads, room: Room) -> Dyads:
    """Those whose centre and length are within bounds."""
    with np.errstate(invalid="ignore"):
        fit = (room.outside(dyads.centres) == 0) & (room.excess(dyads.lengths) == 0)
    return dyads.those(fit)


def _starts(poses: Poses, room: Room, rng: np.random.Generator, effort: int) -> FourBars:
    """Four-bars to begin with, of the dyads that change their length least over all poses."""
    count = len(poses.places)
    subsets = list(itertools.combinations(range(count), 4))
    many = _SUBSETS * effort
    if len(subsets) > many:
        chosen = rng.choice(len(subsets), many, replace=False)
        subsets = [subsets[k] for k in sorted(chosen.tolist())]
    points = []
    centres = []
    for subset in subsets:
        dyads = four_pose_dyads(poses.chosen(list(subset)), _FEWER)
        turn = np.exp(1j * (poses.angles[0] - poses.angles[subset[0]]))
        points.append(poses.places[0] + turn * (dyads.points - poses.places[subset[0]]))
        centres.append(dyads.centres)
    dyads = _within(Dyads(np.concatenate(points), np.concatenate(centres)), room)
    lengths = np.abs(poses.carried(dyads.points) - dyads.centres)
    steady = np.argsort(np.ptp(lengths, axis=0), kind="stable")
    kept: list[int] = []
    step = 0.05 * room.longest
    for k in steady.tolist():
        away = np.abs(dyads.points[kept] - dyads.points[k])
        away += np.abs(dyads.centres[kept] - dyads.centres[k])
        if not (away < step).any():
            kept.append(k)
        if len(kept) == _STEADY:
            break
    made = _pairs(poses, dyads.those(np.array(kept, int)))
    rank = np.add.outer(np.arange(len(kept)), np.arange(len(kept)))
    rank = rank[~np.eye(len(kept), dtype=bool)]
    flags = made.defects()
    order = np.lexsort([rank, np.sum([flags["branch"], flags["order"]], axis=0)])
    return made.those(order[: _STARTS * effort])


def _packed(poses: Poses, bars: FourBars) -> Floats:
    """Unknowns of each four-bar, (m, 10 + n): pivots, joints on the body as at the first pose, both lengths, crank angles."""
    turns = np.exp(1j * (poses.angles - poses.angles[0]))[:, None]
    size = poses.size
    joints = [(each - bars.p) / turns / size for each in (bars.a, bars.b)]
    middle = [np.mean(each, axis=0) for each in joints]
    pivots = [(each - poses.places[0]) / size for each in (bars.o, bars.c)]
    ways = (np.abs(bars.a - bars.o) / size, np.abs(bars.b - bars.c) / size)
    lengths = [np.log(np.mean(each, axis=0)) for each in ways]
    complex_ones = [part for z in (*pivots, *middle) for part in (z.real, z.imag)]
    angles = np.angle(bars.a - bars.o)
    return np.stack([*complex_ones, *lengths, *angles], axis=1)


def _made(poses: Poses, x: Floats, sides: Floats) -> tuple[FourBars, tuple[Points, Floats]]:
    """Four-bars of unknowns, and how far they are off: places (n, m) mm and angles (n, m) rad. See `_packed`."""
    size = poses.size
    o, c, a0, b0 = (x[:, k] + 1j * x[:, k + 1] for k in (0, 2, 4, 6))
    crank, rocker = np.exp(np.clip(x[:, 8:10], -20, 20)).T
    a = o + crank * np.exp(1j * x[:, 10:].T)
    coupler = np.abs(b0 - a0)
    b = closed(a, c, coupler, rocker, sides)
    turn = (b - a) / (b0 - a0)
    turn = turn / np.maximum(np.abs(turn), 1e-300)
    p = a - turn * a0
    place = poses.places[0] + size * p
    body = np.exp(1j * (poses.angles - poses.angles[0]))[:, None]
    pivots = [poses.places[0] + size * each for each in (o, c)]
    joints = [poses.places[0] + size * each for each in (a, b)]
    bars = FourBars(pivots[0], pivots[1], joints[0], joints[1], place)
    off = (place - poses.places[:, None], np.angle(turn / body))
    return bars, off
