"""Four-bars that a few positions ask for, as designs: which are free of defects, and what a spec says of one."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from camgen.design.dyads import Poses
from camgen.design.found import CRANK, Found, Judged, place
from camgen.design.fourbars import FourBars, Motion, Room, Verdict
from camgen.design.poses import exact_four_bars, near_four_bars
from camgen.design.wanted import LinkWish, PoseWish
from camgen.errors import DesignError, counted
from camgen.machine.targets import Function, Through
from camgen.numerics import Floats
from camgen.reading import Data
from camgen.report.sketches import Sketch

COUPLER = "coupler"
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
    assert isinstance(wish, PoseWish)
    return pose_designs(wish, room, tables)


def pose_designs(wish: PoseWish, room: Room, tables: Data) -> Designs:
    """Four-bars whose coupler comes to the poses; DesignError where none is free of defects."""
    poses = Poses(wish.places, wish.angles)
    rng = np.random.default_rng(wish.seed)
    allowance = (wish.allowance, math.radians(wish.allowance_deg))
    if wish.exact:
        bars = exact_four_bars(poses, room, rng)
        errors = np.zeros((2, len(bars.o)))
    else:
        bars, errors = near_four_bars(poses, room, allowance, rng, wish.effort)
    verdict = room.judged(bars)
    refuse_none(verdict, wish, "poses")
    share = np.max(errors / np.array(allowance)[:, None], axis=0)
    numbers, losses = _losses(wish, bars, verdict, share)

    def of(k: int) -> Found:
        number = int(numbers[k])
        one = bars.those(np.array([number]))
        motion = Motion(one, bool(verdict.all_round[number]))
        figures = {
            "bars_mm": float(one.bars[0]),
            "transmission_deg": math.degrees(verdict.transmission[number]),
            "off_mm": float(errors[0, number]),
            "off_deg": math.degrees(errors[1, number]),
            "crank_range_deg": math.degrees(motion.ends[1] - motion.ends[0]),
        }
        judged = _judged_poses(wish, motion, figures)
        return _found(motion, judged, figures, wish, tables)

    return Designs(losses, of)


def refuse_none(verdict: Verdict, wish: LinkWish, wanted: str) -> None:
    """DesignError where no design is free of defects: how many are stopped by which, and the keys that would let them through."""
    if verdict.free.size:
        return
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


def _losses(
    wish: LinkWish, bars: FourBars, verdict: Verdict, share: Floats
) -> tuple[np.ndarray, Floats]:
    """Numbers of the designs that are weighed, and what is less of better ones.

    share: error as a share of what is borne.  With a tolerance, or where all are exact, bars and transmission angle count,
    else error and transmission angle.
    """
    free = verdict.free
    near = free[share[free] <= 1]
    if not near.size:
        near = free[np.argsort(share[free], kind="stable")[:_NEAREST]]
    first = bars.bars if wish.trades_size else share
    return near, np.stack([first[near], -verdict.transmission[near]], axis=1)


def _judged_poses(wish: PoseWish, motion: Motion, figures: Mapping[str, float]) -> list[Judged]:
    """Place and angle of the body, each at the crank's angle."""
    theta = [round(math.degrees(angle), _DIGITS) for angle in motion.theta]
    wanted = wish.angles - wish.angles[0]
    turned = motion.coupler
    whole = math.tau * np.round((turned - wanted) / math.tau)
    angles = np.degrees(wanted + whole - whole[0])
    places = {"at": [place(z) for z in wish.places], "theta_deg": theta}
    pairs = {"at": [[t, round(float(a), _DIGITS)] for t, a in zip(theta, angles, strict=True)]}
    given = wish.tolerance is not None
    return [
        Judged(
            {"name": "place", "point": "P"},
            "points",
            places,
            Through.code,
            figures["off_mm"],
            wish.allowance,
            "mm",
            "tolerance",
            given,
        ),
        Judged(
            {"name": "angle", "link": COUPLER},
            "function",
            pairs,
            Function.code,
            figures["off_deg"],
            wish.allowance_deg,
            "deg",
            "tolerance_deg",
            wish.tolerance_deg is not None,
        ),
    ]


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
    return {"link": CRANK, "range_deg": [round(math.degrees(end), _DIGITS) for end in motion.ends]}
