"""Four-bars that a few positions ask for, as designs: which are free of defects, and what a spec says of one."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from camgen.design.dwells import Rest, six_bars
from camgen.design.dyads import Poses
from camgen.design.found import CRANK, Found, Judged, place
from camgen.design.fourbars import FourBars, Motion, Room, Verdict, joined, verdict_of
from camgen.design.nine_points import COUNT, nine_point_four_bars
from camgen.design.offers import NO_ERROR, Aim, Offer
from camgen.design.poses import exact_four_bars, near_four_bars
from camgen.design.projected import Passing, exact_five, near
from camgen.design.request import Request
from camgen.design.sliders import judged as judged_sliders
from camgen.design.sliders import slider_cranks
from camgen.design.wanted import (
    DwellWish,
    FourBarWish,
    LinkWish,
    PointWish,
    PoseWish,
    SlideWish,
    kind_of,
)
from camgen.design.weighing import Designs
from camgen.errors import DesignError, counted
from camgen.machine.targets import Dwell, Function, Stroke, Through
from camgen.numerics import Floats, Indices
from camgen.reading import Data
from camgen.report.sketches import Sketch
from camgen.workers import Workers

COUPLER = "coupler"
SLIDER = "slider"
ARM = "arm"  # that rests
_OF_SWING = 20  # of a swing, by which it may be off
_OUT = 1e-3  # mm, by which a length may leave its bounds
_EXACT = 5  # points with angles that twelve four-bars at most pass
_NEAREST = 8  # designs that are weighed where none is near enough
_SEEN = 240  # places of a path in a sketch, and of the coupler's angle on its way
_DIGITS = 6  # of an angle, deg
_SPEED = 60.0  # rpm, unless the spec says one


def offer(request: Request) -> Offer:
    """Linkages for the positions that a spec wants; SpecError, DesignError."""
    wish: LinkWish
    sizes, wish = request.for_linkage(request.wish, of_drive=("range_deg", "segment"))
    rooms = wish.rooms(sizes.pin_diameter + 2 * sizes.wall)
    designs = _first(wish, rooms, request.with_lash(wish.lash_key, wish.lash), request.say)
    with Workers(request.jobs) as workers:
        looked = designs.weighed(workers.map, request.say)
    best_in = "shorter bars" if wish.trades_size else "a smaller error"
    aim = (wish.lash, wish.useful_play, wish.unit, not wish.trades_size, "transmits best")
    return Offer(
        looked,
        Aim(*aim, wish.further, wish.tighter),
        f"Linkages for {wish.title} of {request.data.get('name')}",
        f"each has {best_in} than any design with a greater transmission angle, or was tried next. Design 1 is 01.toml, and so on. Those that "
        "can be built come first.",
        wish.figures,
        f"found by camgen design for {wish.title}; [[output]]: what was wanted, and how far this machine may be off",
    )


def _first(
    wish: LinkWish, rooms: Sequence[Room], tables: Data, say: Callable[[str], None]
) -> Designs:
    """What a wish asks for, in the first room that has some; the DesignError of the last where none has."""
    *tried, last = rooms
    for room in tried:
        try:
            return designs_for(wish, room, tables)
        except DesignError:
            say(
                f"no {wish.linkage} that can be used has links of at most {room.longest:.4g} mm: "
                "wider bounds are tried"
            )
    return designs_for(wish, last, tables)


def designs_for(wish: LinkWish, room: Room, tables: Data) -> Designs:
    """What a wish asks for."""
    rng = np.random.default_rng(wish.seed)
    if isinstance(wish, PoseWish):
        return pose_designs(wish, room, tables, rng)
    if isinstance(wish, PointWish):
        return point_designs(wish, room, tables, rng)
    if isinstance(wish, SlideWish):
        return slide_designs(wish, room, tables)
    assert isinstance(wish, DwellWish)
    return dwell_designs(wish, room, tables, rng)


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
    off = {"off_mm": errors[0], "off_deg": np.degrees(errors[1])}
    return _four_bar_designs(wish, room, tables, bars, share, off)


def point_designs(wish: PointWish, room: Room, tables: Data, rng: np.random.Generator) -> Designs:
    """Four-bars that pass the points; DesignError where none is free of defects."""
    passing = Passing(wish.places, wish.crank)
    bars = near(passing, room, wish.allowance, rng, wish.effort)
    if wish.timed and len(wish.places) == _EXACT:
        bars = joined(exact_five(passing), bars)
    if not wish.timed and len(wish.places) == COUNT:
        bars = joined(nine_point_four_bars(wish.places), bars)
    off = np.max(np.abs(bars.p - passing.points[:, None]), axis=0)
    return _four_bar_designs(wish, room, tables, bars, off / wish.allowance, {"off_mm": off})


def _four_bar_designs(
    wish: FourBarWish,
    room: Room,
    tables: Data,
    bars: FourBars,
    share: Floats,
    off: Mapping[str, Floats],
) -> Designs:
    """Four-bars as designs; share: error as a share of what is borne; off: figures of the error, (n,) each."""
    verdict = room.judged(bars)
    sifted = _Sifted.of(wish, verdict, bars.bars, share)

    def of(number: int) -> Found:
        motion = Motion(bars.those(np.array([number])), bool(verdict.all_round[number]))
        errors = {key: float(each[number]) for key, each in off.items()}
        judged = [_judged_places(wish, motion, errors["off_mm"])]
        if isinstance(wish, PoseWish):
            judged.append(_judged_angles(wish, motion, errors["off_deg"]))
        figures = {**sifted.figures(number, motion.ends), **errors}
        return _found(motion, judged, figures, wish, tables)

    return sifted.designs(of)


def slide_designs(wish: SlideWish, room: Room, tables: Data) -> Designs:
    """Slider-cranks for the pairs; DesignError where none is free of defects."""
    turned, way = wish.pairs
    bars = slider_cranks(turned, way, room, wish.allowance)
    verdict = judged_sliders(bars, room)
    off = np.max(np.abs(bars.way - way[:, None]), axis=0)
    sifted = _Sifted.of(wish, verdict, bars.bars, off / wish.allowance)

    def of(number: int) -> Found:
        one = bars.those(np.array([number]))
        ends = one.ends(bool(verdict.all_round[number]))
        figures = {**sifted.figures(number, ends), "off_mm": float(off[number])}
        limits = (float(off[number]), wish.allowance, "mm", "tolerance", wish.default)
        pairs = [list(each) for each in zip(_degrees(turned), way.tolist(), strict=True)]
        output = {"name": "slide", "link": SLIDER}
        judged = Judged(output, "function", {"at": pairs}, Function.code, *limits)
        pin = one.pin(np.zeros(1))[0, 0]
        e = float(one.offset[0])
        every = np.asarray(one.slider(np.linspace(*ends, _SEEN))[:, 0] + 1j * e, complex)
        b = complex(one.slider(np.zeros(1))[0, 0], e)
        rails = (complex(every.real.min(), e), complex(every.real.max(), e))
        places = {"O": 0j, "A": pin, "B": b, "R": rails[0], "S": rails[1]}
        links = {"ground": ["O", "R", "S"], CRANK: ["O", "A"], "rod": ["A", "B"], SLIDER: ["B"]}
        sketch = Sketch(
            places, [["O", "A"], ["A", "B"]], "ORS", every, np.asarray(b + way, complex), False
        )
        slides = [{"link": SLIDER, "along": ["R", "S"]}]
        drive = _drive(ends, 1, tables)
        return Found(
            places, links, drive, [judged], figures, sifted.loss(number), sketch, tables, slides
        )

    return sifted.designs(of)


def dwell_designs(wish: DwellWish, room: Room, tables: Data, rng: np.random.Generator) -> Designs:
    """Six-bars whose output rests; DesignError where none is free of defects."""
    frame = wish.frame
    swing = wish.dwell.swing_deg
    rest = Rest(*np.radians([wish.dwell.span_deg, swing, wish.allowance]))
    unit = replace(room, shortest=room.shortest / frame, longest=room.longest / frame)
    bars = six_bars(rest, unit, rng, wish.effort)
    out = np.asarray((room.excess(frame * bars.gaps()) > _OUT).any(axis=0))
    turns = np.ones(len(bars.x), bool)
    least = bars.transmission()
    verdict = verdict_of({"bounds": out}, turns, lambda all_round: least, room)
    moves = np.degrees(bars.rest(rest.span))
    swings = np.degrees(bars.swing())
    astray = np.abs(swings - swing)
    share = np.maximum(moves / wish.allowance, astray / (swing / _OF_SWING))
    sifted = _Sifted.of(wish, verdict, frame * bars.bars(), share)

    def of(number: int) -> Found:
        one = bars.those(np.array([number]))
        figures = {
            **sifted.figures(number, (0.0, math.tau)),
            "rest_deg": float(moves[number]),
            "swing_deg": float(swings[number]),
        }
        output = {"name": "dwell", "link": ARM}
        span = {"span_deg": wish.dwell.span_deg}
        off = (float(moves[number]), wish.allowance, "deg", "tolerance", wish.default)
        far = (float(astray[number]), swing / _OF_SWING, "deg", "dwell.swing_deg")
        judged = [
            Judged(output, "dwell", span, Dwell.code, *off, "band"),
            Judged(output, "stroke", {"value": swing}, Stroke.code, *far),
        ]
        joints = [frame * complex(z[0, 0]) for z in one.at(np.zeros(1))]
        pivots = [0j, complex(frame), frame * complex(one.pivot[0])]
        places = dict(zip("OCEABPD", pivots + joints, strict=True))
        moving = {CRANK: ["O", "A"], COUPLER: ["A", "B", "P"], "rocker": ["C", "B"]}
        moving |= {"rod": ["P", "D"], ARM: ["E", "D"]}
        turn = frame * one.at(np.linspace(0, math.tau, _SEEN))[2][:, 0]
        arc = frame * one.at(np.linspace(0, rest.span, _SEEN))[2][:, 0]
        sketch = Sketch(places, list(moving.values()), "OCE", turn, arc)
        links = {"ground": ["O", "C", "E"], **moving}
        drive = _drive((0.0, math.tau), 1, tables)
        return Found(places, links, drive, judged, figures, sifted.loss(number), sketch, tables)

    return sifted.designs(of)


@dataclass(frozen=True)
class _Sifted:
    """Linkages of which those without a defect that are near enough are weighed."""

    bars: Floats  # lengths of all bars, (m,) mm
    transmission: Floats  # (m,) rad
    numbers: Indices  # of those that are weighed
    losses: Floats  # (designs, 2) of these

    @classmethod
    def of(cls, wish: LinkWish, verdict: Verdict, bars: Floats, share: Floats) -> _Sifted:
        """share: error as a share of what is borne; DesignError where all have defects.

        With a tolerance, or where all are exact, bars and transmission angle count, else error and transmission angle.
        """
        refuse_none(verdict, wish)
        free = verdict.free
        numbers = free[share[free] <= 1]
        if not numbers.size:
            numbers = free[np.argsort(share[free], kind="stable")[:_NEAREST]]
        first = bars if wish.trades_size else np.maximum(share, NO_ERROR)
        losses = np.stack([first[numbers], -verdict.transmission[numbers]], axis=1)
        return cls(bars, verdict.transmission, numbers, losses)

    def designs(self, of: Callable[[int], Found]) -> Designs:
        """Those that are weighed; of: the design of a linkage's number."""
        return Designs(self.losses, lambda k: of(int(self.numbers[k])))

    def loss(self, number: int) -> float:
        """Of one design: less, the better it transmits."""
        return -float(self.transmission[number])

    def figures(self, number: int, ends: tuple[float, float]) -> Mapping[str, float]:
        """Of the front's table; ends: of the crank's range, rad."""
        return {
            "bars_mm": float(self.bars[number]),
            "transmission_deg": math.degrees(self.transmission[number]),
            "crank_range_deg": math.degrees(ends[1] - ends[0]),
        }


def refuse_none(verdict: Verdict, wish: LinkWish) -> None:
    """DesignError where no design is free of defects: how many are stopped by which, and the keys that would let them through."""
    if verdict.free.size:
        return
    count = sum(verdict.defects.values())
    stopped = [
        words.format(counted(verdict.defects[key], wish.linkage))
        for key, words in _STOPPED
        if verdict.defects.get(key)
    ]
    remedies = [remedy for key, remedy in _REMEDIES if verdict.defects.get(key)]
    if verdict.defects.get("bounds"):
        remedies.insert(0, f"a greater {wish.bound}")
    if wish.exact and wish.count > 3:
        remedies.insert(
            0, f"wanted.tolerance with five {wish.things} or more, or fewer {wish.things}"
        )
    message = f"none of {counted(count, wish.linkage)} for {wish.title} is free of defects"
    raise DesignError(
        f"{wish.linkage}s without a defect",
        0,
        1,
        "",
        f"wanted.{kind_of(wish)}",
        ", ".join(remedies) or f"other {wish.things}",
    ).saying(
        ": ".join([message, ", ".join(stopped)])
        if stopped
        else f"there is no {wish.linkage} for {wish.title}"
    )


_STOPPED = (
    ("bounds", "{} with a link or pivot out of bounds"),
    ("circuit", "{} that you would have to take apart in between (circuit)"),
    ("branch", "{} with a dead point in between (branch)"),
    ("order", "{} that reach them in another order"),
    ("turn", "{} whose crank does not turn all the way round"),
    ("transmission", "{} with too small a transmission angle"),
)
_REMEDIES = (
    ("turn", "wanted.turns = false"),
    ("transmission", "a smaller wanted.transmission_deg"),
)


def _judged_places(wish: FourBarWish, motion: Motion, off: float) -> Judged:
    """Where P is, each at the crank's angle."""
    theta = _degrees(motion.theta)
    values = {"at": [place(z) for z in wish.places], "theta_deg": theta}
    limits = (off, wish.allowance, "mm", "tolerance", wish.default)
    return Judged({"name": "place", "point": "P"}, "points", values, Through.code, *limits)


def _judged_angles(wish: PoseWish, motion: Motion, off: float) -> Judged:
    """How the body stands, each at the crank's angle."""
    wanted = wish.angles - wish.angles[0]
    whole = math.tau * np.round((motion.coupler - wanted) / math.tau)
    angles = _degrees(wanted + whole - whole[0])
    pairs = {"at": [list(pair) for pair in zip(_degrees(motion.theta), angles, strict=True)]}
    limits = (off, wish.allowance_deg, "deg", "tolerance_deg", wish.default_deg)
    return Judged({"name": "angle", "link": COUPLER}, "function", pairs, Function.code, *limits)


def _degrees(angles: Floats) -> list[float]:
    return [round(math.degrees(angle), _DIGITS) + 0.0 for angle in angles]


def _found(
    motion: Motion,
    judged: Sequence[Judged],
    figures: Mapping[str, float],
    wish: FourBarWish,
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
    drive = _drive(motion.ends, motion.sense, tables)
    loss = -figures["transmission_deg"]
    return Found(places, links, drive, judged, figures, loss, sketch, tables)


def _drive(ends: tuple[float, float], sense: int, tables: Data) -> Data:
    """The table [drive]: of a crank that turns its sense, of another one its range; ends: of that, rad."""
    if ends[1] - ends[0] >= math.tau:
        speed = abs(tables.get("drive", {}).get("speed_rpm", _SPEED))
        return {"link": CRANK, "speed_rpm": sense * speed}
    return {"link": CRANK, "range_deg": _degrees(np.array(ends))}
