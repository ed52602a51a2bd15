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

Sizes are the least at which the cams keep to their pressure angle and radius, the plates of grooves clear the pivots, and the spec's
own limits hold: the cams are tried from small to large, with longer and longer arms.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from camgen.design.request import Request
from camgen.design.wanted import DrawingWish
from camgen.errors import CamgenError, DesignError, SpecError
from camgen.findings import Finding
from camgen.machines.sources import changed, read_mechanism
from camgen.motion.laws import modified_sine
from camgen.motion.pen import Lifting, peak_acceleration, pen_motion, strokes_motion
from camgen.numerics import Floats, Points, halved, peak
from camgen.reading import Data
from camgen.spec import dump

_HALF = 26.0  # mm, of the distance of the arms' pivots: room for hubs and pins between them
_NIB = 14.0  # mm, of the pen beyond the joint of both rods
_LEAST_ARM = 40.0  # mm
_ARMS = 1.06  # step of the arms' lengths
_LONGEST_ARM = 170.0  # mm
_CAMS = tuple(22 * 1.08**k for k in range(19))  # mm, middle distance of a roller from the shaft
_CORE = 14.0  # mm, of a cam within its groove: shaft, pins and walls
_WALLS = 20.0  # mm, of a groove's outer plate and a pivot's hub beyond the roller's centre
_HUBS = 16.0  # mm, of both ends of a link beyond its points, and the bed's margin
_STEEP = math.radians(
    42
)  # of the pressure angle in the first estimate; the spec's own limit is judged after it
_ROWS = (90, 180, 360, 720)
_OF_ROWS = 0.02  # of the tolerance, that rows of a table may take
_GAIN = 2.0  # way of the pen for that of an arm's end, at most
_RISE = 24.0  # deg, in which the pen is lifted, at most
_RISES = 150.0  # deg, that all rises may take
_MARGIN = (
    1.0  # deg, that the pen rests longer at either end of a line than it is lifted or let down
)
_LIFT = 2.5  # mm, way of the lift's roller
_PULL = 3.0  # mm, of the thread
_SLACK = 0.5  # mm, of that before the pen moves
_CLEAR = 1.5  # mm, of that when it is clear
_POST = 5.0  # mm, diameter of its posts, which stand over all levels
_THREAD = 25.0  # mm, between its posts while the pen is down
_DIGITS = 6  # of rows, deg, and of points, mm
_TRIES = 12
_OF_DRAWING = 0.9  # of its tolerance, that the pen's motion takes; files and facets leave the rest
_NORTH_WEST = np.exp(0.75j * math.pi)


@dataclass(frozen=True)
class Plotter:
    """Sizes of a machine, mm: arms O-A and O-B, rods to P and to the pen, levers O-T, middle distance of rollers from the shaft.

    line: places of the pen at even angles, in the middle of which is 0; lift: how the pen is lifted, None of one line.
    """

    line: Points
    arm: float
    lever: float
    cam: float
    radius: float  # of the rollers
    lift: Lift | None = None

    @property
    def rod(self) -> float:
        """Of both, from the arm to P."""
        return self.arm + _HALF * math.sqrt(2)

    @property
    def longest(self) -> float:
        """Across the longest part, mm: the right rod with its hubs, or a groove's outer plate."""
        swing = max(float(np.ptp(each)) for each in self.swings) / 2
        plate = 2 * (self.cam + self.lever * swing + _WALLS)
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
        """Whether the estimates of the pressure angle and of both walls' radii hold."""
        for swing in self.swings:
            if not np.isfinite(swing).all():
                return False
            way, rate, bend = (self.lever * _derivative(swing, order) for order in range(3))
            distance = self.cam + way
            if distance.min() <= self.radius + _CORE or peak(rate / distance) > math.tan(_STEEP):
                return False
            square = distance**2 + rate**2
            curvature = (square + rate**2 - distance * bend) / square**1.5
            if peak(curvature) * (self.radius + 1.0) > 1:
                return False
        return True

    @property
    def lever_places(self) -> dict[str, complex]:
        """Points of the lever that lifts the pen, as it is down, and the thread's post on the ground."""
        far = abs(self.pivots[0])
        pivot = -1j * far
        square = 1j * np.exp(1j * math.asin(self.cam / far))
        end = pivot - _PULL / _LIFT * self.lever
        return {
            "O3": pivot,
            "T3": complex(pivot + self.lever * square),
            "E": end,
            "G": end + 1j * _THREAD,
        }

    def tables(self, rows: int) -> tuple[Data, float]:
        """Points, links, drive, cams of the spec, and how far the rows of the cams' tables leave the line, mm."""
        from scipy.interpolate import make_interp_spline

        pen = self.line + self.middle
        theta = np.linspace(0, 360, len(pen) + 1)
        at = np.linspace(0, 360, rows + 1)
        cams = []
        off = 0.0
        places = self.places(pen[:1])
        for k, swing in enumerate(self.swings):
            outwards = np.sign(np.diff(np.abs(self.rollers(k, np.array([-1e-3, 1e-3]))))[0])
            turned = outwards * np.degrees(np.append(swing, swing[0]) - swing[0])
            shown = np.round(_even(turned[:-1], rows), _DIGITS)
            shown -= shown[0]
            shown = np.round(np.append(shown, shown[0]), _DIGITS)
            spline = make_interp_spline(at, shown, k=5, bc_type="periodic")
            off += _GAIN * self.arm * math.radians(peak(spline(theta) - turned))
            law = {
                "name": "table",
                "points": [list(row) for row in zip(at.tolist(), shown.tolist(), strict=True)],
            }
            name = ("left", "right")[k]
            places[f"T{k + 1}"] = self.rollers(k, swing[:1])
            cams.append(
                {
                    "name": f"{name}_cam",
                    "cam": "disc",
                    "follower": f"{name}_arm",
                    "at": f"T{k + 1}",
                    "radius": self.radius,
                    "closure": "groove",
                    "segment": [{"law": law}],
                }
            )
        links: dict[str, list[str]] = {}
        lifts = [] if self.lift is None else [self.lift]
        for lift in lifts:
            places |= {name: np.array([z]) for name, z in self.lever_places.items()}
            cams.append(
                {
                    "name": "lift_cam",
                    "cam": "disc",
                    "follower": "lifter",
                    "at": "T3",
                    "radius": self.radius,
                    "closure": "groove",
                    "segment": lift.segments(math.degrees(_LIFT / self.lever)),
                }
            )
            links["lifter"] = ["O3", "T3", "E"]
        left, right = self.pivots
        places |= {"S": np.zeros(1, complex), "O1": np.array([left]), "O2": np.array([right])}
        points = {
            name: [round(float(z[0].real), _DIGITS) + 0.0, round(float(z[0].imag), _DIGITS) + 0.0]
            for name, z in sorted(places.items())
        }
        links = {
            "ground": ["S", "O1", "O2", *(["O3", "G"] if lifts else [])],
            "disc": ["S"],
            "left_arm": ["O1", "A", "T1"],
            "right_arm": ["O2", "B", "T2"],
            "left_rod": ["A", "P"],
            "right_rod": ["B", "P", "Q"],
            **links,
        }
        return {"points": points, "links": links, "cam": cams}, off


@dataclass(frozen=True)
class Lift:
    """How a cam lifts the pen: at theta = 0 it is down."""

    rise: float  # deg, in which the pen goes up or comes down
    ends: Floats  # deg, the middle of the rests at which each line begins and ends, (n, 2), the first one before theta = 0

    @classmethod
    def timing(cls, lines: int) -> tuple[float, Lifting]:
        """The rise for so many lines, deg, and what lifting takes of a turn."""
        rise = min(_RISE, _RISES / lines)
        slack = _risen(_SLACK)
        clear = _risen(_CLEAR)
        rest = (clear - slack) * rise + _MARGIN
        up = 2 * (1 - clear) * rise
        return rise, Lifting(rest / 360, up / 360, 2 * slack * rise / 360)

    def segments(self, lift_deg: float) -> list[Data]:
        """Of the lift's cam over a turn; lift_deg: of its lever."""
        slack = _risen(_SLACK)
        clear = _risen(_CLEAR)
        early = (clear - slack) / 2 * self.rise
        rises = self.ends[:, 1] - early - slack * self.rise
        falls = np.append(self.ends[1:, 0], self.ends[0, 0] + 360) - early - (1 - clear) * self.rise
        segments: list[Data] = []
        at = 0.0
        for rise, fall in zip(rises.tolist(), falls.tolist(), strict=True):
            for kind, begin in (("rise", rise), ("return", fall)):
                rest = round(begin - at, _DIGITS)
                span = round(self.rise, _DIGITS)
                segments += [
                    {"kind": "dwell", "span_deg": rest},
                    {
                        "kind": kind,
                        "span_deg": span,
                        "lift_deg": round(lift_deg, _DIGITS),
                        "law": {"name": "modified-sine"},
                    },
                ]
                at += rest + span
        return [*segments, {"kind": "dwell", "span_deg": round(360 - at, _DIGITS)}]


def _risen(pull: float) -> float:
    """Share of a rise at which the thread is pulled so far, mm."""
    law = modified_sine()
    return halved(lambda u: float(law(np.array([u]))[0]) > pull / _PULL, 0.0, 1.0)


def _joint(start: complex, end: Points, first: float, second: float, side: int) -> Points:
    """Middle joints of two links from a pivot to places, on the left (1) or the right (-1) of the way; nan out of reach."""
    way = end - start
    reach = np.abs(way)
    with np.errstate(invalid="ignore"):
        bend = np.arccos((first**2 + reach**2 - second**2) / (2 * first * reach))
    return np.asarray(start + first * np.exp(1j * (np.angle(way) + side * bend)))


def _derivative(values: Floats, order: int) -> Floats:
    """Of values at even angles of a turn, (n,)."""
    k = np.fft.rfftfreq(len(values), 1 / len(values))
    return np.asarray(np.fft.irfft((1j * k) ** order * np.fft.rfft(values), len(values)))


def _even(values: Floats, count: int) -> Floats:
    """Fewer of the values at even angles of a turn, between them by their harmonics, (count,)."""
    spectrum = np.fft.rfft(values)
    k = np.arange(len(spectrum))
    theta = np.linspace(0, math.tau, count, endpoint=False)
    kept = k[: min(len(k), 2000)]
    terms = spectrum[kept] * np.where(kept > 0, 2.0, 1.0) / len(values)
    return np.asarray((np.exp(1j * np.outer(theta, kept)) @ terms).real)


def plotters(line: Points, radius: float) -> list[Plotter]:
    """Those whose estimates hold, the smallest first; line: as of `Plotter`."""
    reach = float(np.abs(line).max())
    likely = []
    arm = max(_LEAST_ARM, 2 * reach)
    while arm <= max(_LONGEST_ARM, 2.1 * reach):
        for cam in _CAMS:
            found = _with_lever(line, arm, cam, radius)
            if found is not None and found.likely:
                likely.append(found)
        arm *= _ARMS
    return sorted(likely, key=lambda each: each.cam + each.middle.imag)


def _with_lever(line: Points, arm: float, cam: float, radius: float) -> Plotter | None:
    """The one with the shortest levers at which its grooves' outer plates clear the pivots; None where there is none."""
    lever = 30.0
    for _ in range(30):
        found = Plotter(line, arm, lever, cam, radius)
        half = max(float(np.ptp(swing)) for swing in found.swings) / 2
        least = cam + lever * half + _WALLS
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
    data, found = plotter_tables(pen, lines, wish.tolerance, rest, wish.roller_radius, lift)
    request.say(
        f"arms of {found.arm:.4g} mm, rods of {found.rod:.4g} mm, cams of {found.cam:.4g} mm in the middle"
    )
    if request.text is None:
        return dump(changed(data, request.source, request.folder))
    name = wish.drawing if isinstance(wish.drawing, str) else _typed(wish.drawing)
    key = "path: that line" if lift is None else "lines: those"
    note = f"found by camgen design for the drawing {name}; output.{key}, and how far the pen may be off"
    made = {} if lift is None else {"parts": {"thread_posts": data["parts"]["thread_posts"]}}
    return request.with_found(data, ["points", "links", "drive", "cam", "output"], note, made)


def _typed(drawing: Sequence[Sequence[Any]]) -> str:
    """What was typed, in words."""
    nested = isinstance(drawing[0][0], tuple)
    return f"{len(drawing)} {'lines' if nested else 'points'}"


def plotter_tables(
    line: Points,
    drawn: Sequence[Points],
    tolerance: float,
    rest: Data,
    radius: float,
    lift: Lift | None = None,
) -> tuple[Data, Plotter]:
    """Tables of the spec whose own limits hold as well, and its sizes; DesignError where none was found.

    line: places of the pen at even angles; drawn: corners of each line that it is to draw; rest: the spec's other tables; lift: None
    of one line, which is drawn over and over.
    """
    centre = complex(
        (line.real.max() + line.real.min()) / 2, (line.imag.max() + line.imag.min()) / 2
    )
    moved = line - centre
    worst: Finding | CamgenError | None = None
    tries = 0
    lines = [each - centre for each in drawn]
    for each in plotters(moved, radius):
        found = replace(each, lift=lift)
        if tries == _TRIES:
            break
        tables = _tables(found, lines, tolerance, rest)
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
    size = 2 * float(np.abs(moved).max())
    said = "" if worst is None else f": {worst.code if isinstance(worst, Finding) else worst}"
    remedy = f"a smaller drawing, fewer loops or a greater wanted.tolerance{said}"
    raise DesignError("size of the drawing", size, 0.0, "mm", "its cams", remedy).saying(
        f"no cams up to {_CAMS[-1]:.3g} mm draw a line of {size:.4g} mm across"
    )


def _tables(found: Plotter, drawn: Sequence[Points], tolerance: float, rest: Data) -> Data:
    """Tables of the whole spec, with as few rows as keep to their share of the tolerance."""
    for rows in _ROWS:
        made, off = found.tables(rows)
        if off <= _OF_ROWS * tolerance:
            break
    lines = [
        [[round(float(z.real), _DIGITS), round(float(z.imag), _DIGITS)] for z in line]
        for line in (each + found.middle for each in drawn)
    ]
    pen: dict[str, Any] = {"name": "pen", "point": "Q"}
    output = [pen]
    if found.lift is None:
        pen["path"] = {"at": lines[0], "tolerance": tolerance}
    else:
        down = _THREAD + _SLACK
        up = _THREAD + _CLEAR
        pen["lines"] = {"at": lines, "lift": "lift", "down": down, "up": up, "tolerance": tolerance}
        output.append({"name": "lift", "thread": ["G", "E"]})
        sizes = rest.get("parts", {})
        posts = {"diameter": _POST, **sizes.get("thread_posts", {})}
        rest = {**rest, "parts": {**sizes, "thread_posts": posts}}
    drive = {"link": "disc", **rest.get("drive", {})}
    return {**rest, **made, "drive": drive, "output": output}
