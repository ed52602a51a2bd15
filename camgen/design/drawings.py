"""A machine that draws a line: two cams on one shaft rock two arms, and two rods from these meet at the pen.

        Q pen         S shaft of both cams; O1, O2 pivots of the arms; T1, T2 rollers, each on a lever of its arm that stands square to
       / \\            the way to the shaft where the arm is in the middle of its swing.
      A   B           Where the pen is in the middle, rods and arms stand square to each other, 45 deg to the frame: each cam moves the
       \\ /            pen along its own rod, so both have the same to do. The pen is on the right rod, beyond the joint P of both.
      O1 O2
        S

Of several lines a third cam on the shaft lifts the pen between them: it rocks a lever below the shaft, which pulls a thread. That is led
on by a sleeve, such as a thin Bowden cable's, to a holder in which a spring presses the pen down; so links and cams stay in their planes.

        S         O3 pivot of the lever; T3 its roller, on the left of the shaft; E the thread's post on the lever, G that on the ground,
       T3         over E: the lever turns counter-clockwise to lift the pen, E goes down, and the thread between both grows.
     G  |
     E--O3

With slides in place of arms: `crossed_slides`. Sizes are the least at which the cams keep to their pressure angle and radius, the plates of grooves clear the pivots, and the spec's
own limits hold: the cams are tried from small to large, with longer and longer arms.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from camgen.design.crossed_slides import CrossedSlides, crossed_slides
from camgen.design.pen_cams import (
    CAMS,
    CLEAR,
    SLACK,
    THREAD,
    WALLS,
    Lift,
    closed_rows,
    groove,
    lever,
    likely,
    rounded,
)
from camgen.design.request import Request
from camgen.design.wanted import DrawingWish
from camgen.errors import CamgenError, DesignError, SpecError
from camgen.findings import Finding
from camgen.machines.sources import changed, read_mechanism
from camgen.motion.pen import peak_acceleration, pen_motion, strokes_motion
from camgen.numerics import Floats, Points, magnitude
from camgen.reading import Data
from camgen.spec import dump

_HALF = 26.0  # mm, of the distance of the arms' pivots: room for hubs and pins between them
_NIB = 14.0  # mm, of the pen beyond the joint of both rods
_LEAST_ARM = 40.0  # mm
_ARMS = 1.06  # step of the arms' lengths
_LONGEST_ARM = 170.0  # mm
_HUBS = 16.0  # mm, of both ends of a link beyond its points, and the bed's margin
_STEEP = math.radians(
    42
)  # of the pressure angle in the first estimate; the spec's own limit is judged after it
_ROWS = (90, 180, 360, 720)
_OF_ROWS = 0.02  # of the tolerance, that rows of a table may take
_GAIN = 2.0  # way of the pen for that of an arm's end, at most
_POST = 5.0  # mm, diameter of its posts, which stand over all levels
_TRIES = 12
_OF_DRAWING = 0.9  # of its tolerance, that the pen's motion takes; files and facets leave the rest
_NORTH_WEST = np.exp(0.75j * math.pi)


@dataclass(frozen=True)
class Plotter:
    """Sizes of a machine, mm: arms O-A and O-B, rods to P and to the pen, levers O-T, middle distance of rollers from the shaft.

    line: places of the pen at even angles, in the middle of which is 0.
    """

    line: Points
    arm: float
    lever: float
    cam: float
    radius: float  # of the rollers

    @property
    def rod(self) -> float:
        """Of both, from the arm to P."""
        return self.arm + _HALF * math.sqrt(2)

    @property
    def longest(self) -> float:
        """Across the longest part, mm: the right rod with its hubs, or a groove's outer plate."""
        swing = max(float(np.ptp(each)) for each in self.swings) / 2
        plate = 2 * (self.cam + self.lever * swing + WALLS)
        return max(self.rod + _NIB + _HUBS, plate)

    @property
    def pivots(self) -> tuple[complex, complex]:
        """Of the left and the right arm, seen from the shaft."""
        high = math.sqrt(self.cam**2 + self.lever**2 - _HALF**2)
        return complex(-_HALF, high), complex(_HALF, high)

    @property
    def middle(self) -> complex:
        """Where the middle of the drawing is, seen from the shaft."""
        joint = self.pivots[0].imag + (self.arm + self.rod) / math.sqrt(2)
        return complex(1j * joint + _NIB * _NORTH_WEST)

    def places(self, pen: Points) -> dict[str, Points]:
        """Points A, B, P for places of the pen, each (m,)."""
        left, right = self.pivots
        b = _joint(right, pen, self.arm, self.rod + _NIB, -1)
        p = b + (pen - b) * (self.rod / (self.rod + _NIB))
        return {"A": _joint(left, p, self.arm, self.rod, 1), "B": b, "P": p, "Q": pen}

    def arms(self, pen: Points) -> tuple[Floats, Floats]:
        """Angles of both arms, (m,) rad."""
        places = self.places(pen)
        left, right = self.pivots
        return np.unwrap(np.angle(places["A"] - left)), np.unwrap(np.angle(places["B"] - right))

    @cached_property
    def swings(self) -> tuple[Floats, Floats]:
        """Angles of both arms at the line's places, from the middle of their swings, (n,) rad."""
        found = self.arms(self.line + self.middle)
        return tuple(each - (each.max() + each.min()) / 2 for each in found)

    def rollers(self, k: int, swing: Floats) -> Points:
        """Places of the left (0) or the right roller (1)."""
        pivot = self.pivots[k]
        side = (-1, 1)[k]
        square = np.angle(-pivot) + side * math.acos(self.lever / abs(pivot))
        return np.asarray(pivot + self.lever * np.exp(1j * (square + swing)))

    @property
    def likely(self) -> bool:
        """Whether the estimates of its cams hold."""
        return all(
            np.isfinite(swing).all() and likely(self.lever * swing, self.cam, self.radius, _STEEP)
            for swing in self.swings
        )

    def tables(self, rows: int) -> tuple[Data, float]:
        """Points, links, cams of the spec, and how far the rows of the cams' tables leave the line, mm."""
        cams = []
        off = 0.0
        left, right = self.pivots
        start = self.places(self.line[:1] + self.middle)
        places = {name: complex(z[0]) for name, z in start.items()}
        places |= {"S": 0j, "O1": left, "O2": right}
        for k, swing in enumerate(self.swings):
            name = ("left", "right")[k]
            at = f"T{k + 1}"
            outwards = np.sign(np.diff(np.abs(self.rollers(k, np.array([-1e-3, 1e-3]))))[0])
            segments, away = closed_rows(outwards * np.degrees(swing), rows)
            off += _GAIN * self.arm * math.radians(away)
            places[at] = complex(self.rollers(k, swing[:1])[0])
            cams.append(groove(f"{name}_arm", at, self.radius, segments, name))
        links = {
            "ground": ["S", "O1", "O2"],
            "disc": ["S"],
            "left_arm": ["O1", "A", "T1"],
            "right_arm": ["O2", "B", "T2"],
            "left_rod": ["A", "P"],
            "right_rod": ["B", "P", "Q"],
        }
        return {"points": places, "links": links, "cam": cams}, off

    @property
    def far(self) -> float:
        """Of a lever's pivot from the shaft, mm, that clears the grooves."""
        return abs(self.pivots[0])

    @property
    def size(self) -> float:
        """By which machines are tried, mm."""
        return self.cam + self.middle.imag

    @property
    def said(self) -> str:
        """Its sizes, in words."""
        return f"arms of {self.arm:.4g} mm, rods of {self.rod:.4g} mm, cams of {self.cam:.4g} mm in the middle"


def _joint(start: complex, end: Points, first: float, second: float, side: int) -> Points:
    """Middle joints of two links from a pivot to places, on the left (1) or the right (-1) of the way; nan out of reach."""
    way = end - start
    reach = np.abs(way)
    with np.errstate(invalid="ignore"):
        bend = np.arccos((first**2 + reach**2 - second**2) / (2 * first * reach))
    return np.asarray(start + first * np.exp(1j * (np.angle(way) + side * bend)))


def plotters(line: Points, radius: float) -> list[Plotter]:
    """Those whose estimates hold, the smallest first; line: as of `Plotter`."""
    reach = magnitude(line)
    found_likely = []
    arm = max(_LEAST_ARM, 2 * reach)
    while arm <= max(_LONGEST_ARM, 2.1 * reach):
        for cam in CAMS:
            found = _with_lever(line, arm, cam, radius)
            if found is not None and found.likely:
                found_likely.append(found)
        arm *= _ARMS
    return sorted(found_likely, key=lambda each: each.size)


def _with_lever(line: Points, arm: float, cam: float, radius: float) -> Plotter | None:
    """The one with the shortest levers at which its grooves' outer plates clear the pivots; None where there is none."""
    lever = 30.0
    for _ in range(30):
        found = Plotter(line, arm, lever, cam, radius)
        half = max(float(np.ptp(swing)) for swing in found.swings) / 2
        least = cam + lever * half + WALLS
        needed = math.sqrt(max(least**2 - cam**2, 30.0**2))
        if not math.isfinite(needed) or needed > 4 * arm:
            return None
        if abs(needed - lever) < 0.01:
            return found
        lever = needed
    return None


def written(request: Request) -> str:
    """Text of the spec of a machine that draws the line that a spec wants; SpecError, DesignError."""

    def drawing() -> tuple[DrawingWish, list[Points]]:
        found: DrawingWish = request.wish()
        return found, found.strokes(request.folder)

    _, (wish, lines) = request.for_linkage(drawing)
    allowed = _OF_DRAWING * wish.tolerance
    lift = None
    if len(lines) == 1:
        pen = pen_motion(lines[0], allowed, wish.corners)
        lines = [np.append(lines[0], lines[0][0])]
    else:
        rise, lifting = Lift.timing(len(lines))
        motion = strokes_motion(lines, allowed, wish.corners, lifting)
        pen = motion.places
        lift = Lift(rise, np.degrees(motion.ends))
        request.say(f"{len(lines)} lines, a third cam lifts the pen within {rise:.3g} deg")
    request.say(f"peak acceleration of the pen: {peak_acceleration(pen):.4g} mm/rad^2")
    rest = request.with_lash("lash", wish.lash)
    kind = plotters if wish.follower == "arm" else crossed_slides
    data, found = machine_tables(kind, pen, lines, wish, rest, lift)
    request.say(found.said)
    if request.text is None:
        return dump(changed(data, request.source, request.folder))
    name = wish.drawing if isinstance(wish.drawing, str) else _typed(wish.drawing)
    key = "path: that line" if lift is None else "lines: those"
    note = f"found by camgen design for the drawing {name}; output.{key}, and how far the pen may be off"
    parts = data.get("parts", {})
    made = {key: each for key, each in parts.items() if each != rest.get("parts", {}).get(key)}
    keys = ["points", "links", "drive", *(key for key in ("slide", "slot") if key in data)]
    more = {"parts": made} if made else {}
    return request.with_found(data, [*keys, "cam", "output"], note, more)


def _typed(drawing: Sequence[Sequence[Any]]) -> str:
    """What was typed, in words."""
    nested = isinstance(drawing[0][0], tuple)
    return f"{len(drawing)} {'lines' if nested else 'points'}"


def machine_tables(
    kind: Callable[[Points, float], Sequence[Plotter] | Sequence[CrossedSlides]],
    line: Points,
    drawn: Sequence[Points],
    wish: DrawingWish,
    rest: Data,
    lift: Lift | None,
) -> tuple[Data, Plotter | CrossedSlides]:
    """Tables of the spec whose own limits hold as well, and its sizes; DesignError where none was found.

    kind: machines whose estimates hold, the smallest first; line: places of the pen at even angles; drawn: corners of each line that it
    is to draw; rest: the spec's other tables; lift: None of one line, which is drawn over and over.
    """
    centre = complex(
        (line.real.max() + line.real.min()) / 2, (line.imag.max() + line.imag.min()) / 2
    )
    moved = line - centre
    worst: Finding | CamgenError | None = None
    tries = 0
    lines = [each - centre for each in drawn]
    for found in kind(moved, wish.roller_radius):
        if tries == _TRIES:
            break
        tables = _tables(found, lines, wish.tolerance, rest, lift)
        try:
            machine = read_mechanism(tables)
            if found.longest > min(machine.print.bed):
                continue
            limits = machine.limits()
            machine.assembly  # noqa: B018
        except SpecError:
            raise
        except CamgenError as error:
            worst = error
            tries += 1
            continue
        tries += 1
        failing = [each for each in limits if not each.ok]
        if not failing:
            return tables, found
        worst = failing[0]
    size = 2 * magnitude(moved)
    said = "" if worst is None else f": {worst.code if isinstance(worst, Finding) else worst}"
    arms = ', wanted.follower = "arm"' if wish.follower == "slides" else ""
    remedy = f"a smaller drawing, fewer loops{arms} or a greater wanted.tolerance{said}"
    raise DesignError("size of the drawing", size, 0.0, "mm", "its cams", remedy).saying(
        f"no cams up to {CAMS[-1]:.3g} mm draw a line of {size:.4g} mm across"
    )


def _tables(
    found: Plotter | CrossedSlides,
    drawn: Sequence[Points],
    tolerance: float,
    rest: Data,
    lift: Lift | None,
) -> Data:
    """Tables of the whole spec, with as few rows as keep to their share of the tolerance."""
    for rows in _ROWS:
        made, off = found.tables(rows)
        if off <= _OF_ROWS * tolerance:
            break
    lines = [[rounded(complex(z)) for z in each + found.middle] for each in drawn]
    pen: dict[str, Any] = {"name": "pen", "point": "Q"}
    output = [pen, *made.pop("output", [])]
    parts = {**made.pop("parts", {}), **rest.get("parts", {})}
    if lift is None:
        pen["path"] = {"at": lines[0], "tolerance": tolerance}
    else:
        ends = {"down": THREAD + SLACK, "up": THREAD + CLEAR}
        pen["lines"] = {"at": lines, "lift": "lift", **ends, "tolerance": tolerance}
        output.append({"name": "lift", "thread": ["G", "E"]})
        places, cam = lever(lift, found.cam, found.far, found.radius)
        ground = [*made["links"]["ground"], "O3", "G"]
        made["points"] = {**made["points"], **places}
        made["links"] = {**made["links"], "ground": ground, "lifter": ["O3", "T3", "E"]}
        made["cam"] = [*made["cam"], cam]
        parts["thread_posts"] = {"diameter": _POST, **parts.get("thread_posts", {})}
    made["points"] = {name: rounded(z) for name, z in sorted(made["points"].items())}
    drive = {"link": "disc", **rest.get("drive", {})}
    sizes = {"parts": parts} if parts else {}
    return {**rest, **sizes, **made, "drive": drive, "output": output}
