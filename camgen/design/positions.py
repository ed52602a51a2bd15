"""Four-bars that a few positions ask for, as designs: which are free of defects, and what a spec says of one."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from camgen.design.dyads import Poses
from camgen.design.found import CRANK, NO_ERROR, Found, Judged, place
from camgen.design.fourbars import FourBars, Motion, Room, Verdict, joined
from camgen.design.poses import exact_four_bars, near_four_bars
from camgen.design.projected import Passing, exact_five, near
from camgen.design.wanted import LinkWish, PointWish, PoseWish, kind_of
from camgen.errors import DesignError, counted
from camgen.machine.targets import Function, Through
from camgen.numerics import Floats, Indices
from camgen.reading import Data
from camgen.report.sketches import Sketch

COUPLER = "coupler"
_EXACT = 5  # points with angles that twelve four-bars at most pass
_NEAREST = 8  # designs that are weighed where none is near enough
_SEEN = 240  # places of a path in a sketch, and of the coupler's angle on its way
_DIGITS = 6  # of an angle, deg
_SPEED = 60.0  # rpm, unless the spec says one


@dataclass(frozen=True)
class Designs:
    """What a search found before it is weighed: losses (designs, 2), of which less is better, and the design of a number."""

    losses: Floats
    of: Callable[[int], Found]


def designs_for(wish: LinkWish, room: Room, tables: Data) -> Designs:
    """What a wish asks for."""
    rng = np.random.default_rng(wish.seed)
    if isinstance(wish, PoseWish):
        return pose_designs(wish, room, tables, rng)
    assert isinstance(wish, PointWish)
    return point_designs(wish, room, tables, rng)


def pose_designs(wish: PoseWish, room: Room, tables: Data, rng: np.random.Generator) -> Designs:
    """Four-bars whose coupler comes to the poses; DesignError where none is free of defects."""
    poses = Poses(wish.places, wish.angles)
    allowance = (wish.allowance, math.radians(wish.allowance_deg))
    if wish.exact:
        bars = exact_four_bars(poses, room, rng)
        errors = np.zeros((2, len(bars.o)))
    else:
        bars, errors = near_four_bars(poses, room, allowance, rng, wish.effort)
    share = np.max(errors / np.array(allowance)[:, None], axis=0)
    sifted = _Sifted.of(wish, room, bars, share)

    def of(k: int) -> Found:
        number = int(sifted.numbers[k])
        motion = sifted.motion(number)
        off_mm = float(errors[0, number])
        off_deg = math.degrees(errors[1, number])
        figures = {**sifted.figures(number), "off_mm": off_mm, "off_deg": off_deg}
        judged = _judged_poses(wish, motion, off_mm, off_deg)
        return _found(motion, judged, figures, wish, tables)

    return Designs(sifted.losses, of)


def point_designs(wish: PointWish, room: Room, tables: Data, rng: np.random.Generator) -> Designs:
    """Four-bars that pass the points; DesignError where none is free of defects."""
    passing = Passing(wish.places, wish.crank)
    bars = near(passing, room, wish.allowance, rng, wish.effort)
    if wish.timed and len(wish.points) == _EXACT:
        bars = joined(exact_five(passing), bars)
    off = np.max(np.abs(bars.p - passing.points[:, None]), axis=0)
    sifted = _Sifted.of(wish, room, bars, off / wish.allowance)

    def of(k: int) -> Found:
        number = int(sifted.numbers[k])
        motion = sifted.motion(number)
        figures = {**sifted.figures(number), "off_mm": float(off[number])}
        judged = [_judged_places(wish, motion, float(off[number]))]
        return _found(motion, judged, figures, wish, tables)

    return Designs(sifted.losses, of)


@dataclass(frozen=True)
class _Sifted:
    """Four-bars of which those without a defect that are near enough are weighed."""

    bars: FourBars
    verdict: Verdict
    numbers: Indices  # of those that are weighed
    losses: Floats  # (designs, 2) of these

    @classmethod
    def of(cls, wish: LinkWish, room: Room, bars: FourBars, share: Floats) -> _Sifted:
        """share: error as a share of what is borne; DesignError where all have defects.

        With a tolerance, or where all are exact, bars and transmission angle count, else error and transmission angle.
        """
        verdict = room.judged(bars)
        refuse_none(verdict, wish)
        free = verdict.free
        numbers = free[share[free] <= 1]
        if not numbers.size:
            numbers = free[np.argsort(share[free], kind="stable")[:_NEAREST]]
        first = bars.bars if wish.trades_size else np.maximum(share, NO_ERROR)
        losses = np.stack([first[numbers], -verdict.transmission[numbers]], axis=1)
        return cls(bars, verdict, numbers, losses)

    def motion(self, number: int) -> Motion:
        """How that one is driven."""
        return Motion(self.bars.those(np.array([number])), bool(self.verdict.all_round[number]))

    def figures(self, number: int) -> Mapping[str, float]:
        """Of the front's table."""
        low, high = self.motion(number).ends
        return {
            "bars_mm": float(self.bars.bars[number]),
            "transmission_deg": math.degrees(self.verdict.transmission[number]),
            "crank_range_deg": math.degrees(high - low),
        }


def refuse_none(verdict: Verdict, wish: LinkWish) -> None:
    """DesignError where no design is free of defects: how many are stopped by which, and the keys that would let them through."""
    if verdict.free.size:
        return
    wanted = kind_of(wish)
    count = sum(verdict.defects.values())
    stopped = [
        words.format(counted(verdict.defects[key], "four-bar"))
        for key, words in _STOPPED
        if verdict.defects.get(key)
    ]
    remedies = [remedy for key, remedy in _REMEDIES if verdict.defects.get(key)]
    if wish.exact and len(wish.places) > 3:
        remedies.insert(0, f"wanted.tolerance with five {wanted} or more, or fewer {wanted}")
    message = f"none of {counted(count, 'four-bar')} for these {wanted} is free of defects"
    raise DesignError(
        "four-bars without a defect",
        0,
        1,
        "",
        f"wanted.{wanted}",
        ", ".join(remedies) or f"other {wanted}",
    ).saying(
        ": ".join([message, ", ".join(stopped)]) if stopped else f"no four-bar has these {wanted}"
    )


_STOPPED = (
    ("bounds", "{} with a link or pivot out of bounds"),
    ("circuit", "{} to be taken apart in between (circuit)"),
    ("branch", "{} with a dead point in between (branch)"),
    ("order", "{} that come in another order"),
    ("turn", "{} whose crank does not turn all round"),
    ("transmission", "{} with too small a transmission angle"),
)
_REMEDIES = (
    ("bounds", "a greater wanted.longest or wanted.pivots"),
    ("turn", "wanted.turns = false"),
    ("transmission", "a smaller wanted.transmission_deg"),
)


def _judged_places(wish: LinkWish, motion: Motion, off: float) -> Judged:
    """Where P is, each at the crank's angle."""
    theta = _degrees(motion.theta)
    values = {"at": [place(z) for z in wish.places], "theta_deg": theta}
    given = wish.tolerance is not None
    limits = (off, wish.allowance, "mm", "tolerance", given)
    return Judged({"name": "place", "point": "P"}, "points", values, Through.code, *limits)


def _judged_poses(wish: PoseWish, motion: Motion, off_mm: float, off_deg: float) -> list[Judged]:
    """Place and angle of the body, each at the crank's angle."""
    wanted = wish.angles - wish.angles[0]
    whole = math.tau * np.round((motion.coupler - wanted) / math.tau)
    angles = _degrees(wanted + whole - whole[0])
    pairs = {"at": [list(pair) for pair in zip(_degrees(motion.theta), angles, strict=True)]}
    given = wish.tolerance_deg is not None
    limits = (off_deg, wish.allowance_deg, "deg", "tolerance_deg", given)
    angle = Judged({"name": "angle", "link": COUPLER}, "function", pairs, Function.code, *limits)
    return [_judged_places(wish, motion, off_mm), angle]


def _degrees(angles: Floats) -> list[float]:
    return [round(math.degrees(angle), _DIGITS) + 0.0 for angle in angles]


def _found(
    motion: Motion,
    judged: Sequence[Judged],
    figures: Mapping[str, float],
    wish: LinkWish,
    tables: Data,
) -> Found:
    """The design of one four-bar, drawn at the first position."""
    one = motion.bars
    places = {"O": one.o[0], "C": one.c[0], "A": one.a[0, 0], "B": one.b[0, 0], "P": one.p[0, 0]}
    links = {
        "ground": ["O", "C"],
        CRANK: ["O", "A"],
        COUPLER: ["A", "B", "P"],
        "rocker": ["C", "B"],
    }
    path = motion.path(_SEEN)
    sketch = Sketch(
        places, [links[key] for key in (CRANK, COUPLER, "rocker")], "OC", path, wish.places, False
    )
    return Found(places, links, _drive(motion, tables), judged, figures, sketch, tables)


def _drive(motion: Motion, tables: Data) -> Data:
    """The table [drive]: of a crank that turns its sense, of another one its range."""
    if motion.all_round:
        speed = abs(tables.get("drive", {}).get("speed_rpm", _SPEED))
        return {"link": CRANK, "speed_rpm": motion.sense * speed}
    return {"link": CRANK, "range_deg": _degrees(np.array(motion.ends))}
