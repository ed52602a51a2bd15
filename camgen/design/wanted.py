"""The table [wanted] of `camgen design`, where a linkage is found for a path, or values of keys for a machine's limits."""

from __future__ import annotations

import itertools
import math
import re
from abc import abstractmethod
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Annotated, Any, ClassVar, Literal, Union

import numpy as np
from pydantic import Field, TypeAdapter, create_model

from camgen.design.fourbars import Room
from camgen.errors import Fault, SpecError
from camgen.machines.spec_files import rows_of, strokes_of
from camgen.motion.pen import Corners, closed_line, strokes_in_order
from camgen.numerics import Floats, Points, from_zero, magnitude, spread
from camgen.reading import Data, references
from camgen.spec import Checked, Length, Record, validate
from camgen.tolerances import SAME_POINT

_MOST_POINTS = 20_000
_DENSE = 500  # points of a path that is joined by lines
_OF_USE = 20  # of the size of what is wanted: a design that is off by more is of no use, unless a tolerance says so
_OF_REST = 50  # of its swing: what an output may move while it rests, unless a tolerance says so
_ROUND = 1.5  # of its size: how far round what is wanted pivots may stand
_LONG = 3.0  # of its size: the longest link
_WIDER = (2.0, 4.0)  # times these two, where nothing that is exact is within them
_SMALLEST = 0.1  # mm: places that are nearer to each other are one place
_SAME_ANGLE = 1e-6  # deg: crank angles that are nearer are one
_LEAST_ANGLE = 0.1  # deg, that a body's angle may be off at least
_MOST_STROKES = 12  # of a drawing
_SHORTEST_STROKE = 1.0  # mm
_TWICE = 3.0  # times the sides of its box: a line through points in order is shorter

Coordinate = Annotated[float, Field(ge=-1e5, le=1e5)]
Bounds = tuple[Annotated[float, Field(ge=-1e9, le=1e9)], Annotated[float, Field(ge=-1e9, le=1e9)]]


Choices = Annotated[tuple[str, ...], Field(min_length=2, max_length=20)]
Turn = Annotated[float, Field(ge=-720, le=720)]


class Wish(Record):
    """A table [wanted]."""

    def faults(self) -> list[Fault]:
        """What does not go together."""
        return []


class PathWish(Wish):
    """A path that a point of a linkage is to trace; everything but [points], [links] and [[output]] is the spec's own."""

    path: str | tuple[tuple[Coordinate, Coordinate], ...] = Field(
        description="mm, [x, y] of its points, or a CSV file"
    )
    joined: bool = Field(
        True,
        description="true: lines join the points in their order; false: the points are a dense cloud in any order",
    )
    tolerance: Length | None = Field(
        None,
        description="mm, how far path and points may be apart; default: a twentieth of the size",
    )
    lash: Length | None = Field(
        None,
        description="mm, greatest free play of the point by all joints; default: a twentieth of the size, or the least that a design has",
    )
    bars: Literal[4, 6, 8] = Field(6, description="greatest number of links, with the ground")
    shortest: Length | None = Field(
        None, description="mm, least distance of two pins of a link; default: what the hubs need"
    )
    transmission_deg: Annotated[float, Field(ge=0, le=60)] = Field(
        20.0, description="deg, least transmission angle between two links at a pin"
    )
    effort: Annotated[int, Field(ge=0, le=50)] = Field(
        1, description="how long camgen improves the best designs"
    )
    seed: Annotated[int, Field(ge=0, le=10**6)] = Field(
        0, description="another number begins the search from other drawings"
    )

    def allowance(self, size: float) -> float:
        """How far path and points may be apart, mm; size: the longest chord of the path, mm."""
        return self.tolerance or float(f"{size / _OF_USE:.4g}")

    def useful_play(self, size: float) -> float:
        """Play with which the path is still of use, mm; size: as of `allowance`."""
        return self.lash or float(f"{size / _OF_USE:.4g}")

    @property
    def further(self) -> str:
        """What gives the search more room."""
        return "more wanted.effort or wanted.bars, a smaller wanted.transmission_deg or wanted.shortest"

    def line(self, folder: Path) -> Points:
        """Its corners in their order, or its places where no lines join them; SpecError or FileError where they are no path."""
        corners = (
            rows_of(_named("path", self.path, folder)) if isinstance(self.path, str) else self.path
        )
        z = np.array([complex(*place) for place in corners], complex)
        z = z[np.abs(np.diff(z, prepend=np.nan)) != 0] if self.joined else np.unique(z)
        box = spread(z) if z.size else 0.0
        if z.size < 3 or box < 1e-3:
            raise SpecError(
                [
                    Fault(
                        ("wanted", "path"),
                        f"{z.size} different points",
                        "at least 3 different points, mm",
                    )
                ]
            )
        steps = np.abs(np.diff(z)) if self.joined else np.zeros(1)
        if steps.sum() > _TWICE * 2 * (np.ptp(z.real) + np.ptp(z.imag)):
            right = "points in the order of the path, or wanted.joined = false for a cloud of them"
            message = f"a line of {steps.sum():.6g} mm through all points in a box of {box:.6g}"
            raise SpecError([Fault(("wanted", "path"), message, right)])
        return np.asarray(z)

    def points(self, line: Points) -> Points:
        """Points on it, dense, for the search."""
        if not self.joined:
            return line
        at = from_zero(np.abs(np.diff(line)))
        along = np.linspace(0.0, at[-1], max(_DENSE, 2 * line.size))
        return np.asarray(np.interp(along, at, line.real) + 1j * np.interp(along, at, line.imag))


Corner = tuple[Coordinate, Coordinate]
OneLine = Annotated[tuple[Corner, ...], Field(min_length=2)]


class DrawingWish(Wish):
    """Lines that a pen is to draw over one turn of two cams; [points], [links], [[cam]] and [[output]] are found."""

    drawing: str | tuple[Corner, ...] | tuple[OneLine, ...] = Field(
        description="an SVG or DXF, a CSV of points, or [x, y] of the corners of one line in order, mm, or a list of such lines; of "
        "several a third cam lifts the pen between them, one open line is drawn there and back",
        json_schema_extra={
            "form": "a file, or the corners of one line, [[x, y], [x, y], ...], two at least, or a list of such lines",
            "whole": True,
        },
    )
    tolerance: Annotated[float, Field(ge=0.01, le=5)] = Field(
        0.1, description="mm, how far the pen may be off the line, either way"
    )
    corners: Corners = Field(
        "round",
        description="whether the pen rounds sharp corners within the tolerance, or stops in them",
    )
    width: Annotated[float, Field(ge=3, le=300)] | None = Field(
        None, description="mm, width of the drawing; default: as drawn"
    )
    follower: Literal["arm", "slides"] = Field(
        "arm",
        description='what the cams move: "arm" for two arms with rods to the pen; "slides" for two slides and one across, with larger cams '
        "and less play",
    )
    roller_radius: Annotated[float, Field(ge=1, le=20)] = Field(
        5.0, description="mm, radius of the rollers in the grooves"
    )
    lash: Length | None = Field(None, description="mm, greatest free play of the pen by all joints")

    def strokes(self, folder: Path) -> list[Points]:
        """Lines in the order in which they are drawn, (n,) complex mm, of a closed one the first place again at its end; one that is
        drawn over and over without the first again. SpecError or FileError where they are no such lines."""
        if isinstance(self.drawing, str):
            found = strokes_of(_named("drawing", self.drawing, folder))
        else:
            nested = bool(self.drawing) and isinstance(self.drawing[0][0], tuple)
            rows: Any = self.drawing if nested else [self.drawing]
            found = [np.array([complex(*place) for place in row], complex) for row in rows]
        if len(found) > 1:
            found = strokes_in_order(self._scaled(found))
        if len(found) > 1:
            return found
        line = closed_line(found[0], self.width)
        if line is None:
            right = "a line of at least 3 different points, 1 mm across or more"
            raise SpecError([Fault(("wanted", "drawing"), f"{found[0].size} points", right)])
        return [line]

    def _scaled(self, lines: Sequence[Points]) -> list[Points]:
        """Several lines as wide together as wanted; SpecError where one is too short, or there are too many."""
        faults = []
        if len(lines) > _MOST_STROKES:
            right = f"at most {_MOST_STROKES}: between them the cams have to lift the pen"
            faults.append(Fault(("wanted", "drawing"), f"{len(lines)} lines", right))
        places = np.concatenate(lines)
        across = float(np.ptp(places.real))
        scale = 1.0 if self.width is None or not across else self.width / across
        scaled = [scale * z[np.abs(np.diff(z, prepend=np.nan)) != 0] for z in lines]
        for k, z in enumerate(scaled, 1):
            length = float(np.abs(np.diff(z)).sum())
            if length < _SHORTEST_STROKE:
                x = z[0].real
                y = z[0].imag
                found = f"line {k}, {length:.3g} mm from ({x:.4g}, {y:.4g})"
                right = f"lines of {_SHORTEST_STROKE:g} mm or more"
                faults.append(Fault(("wanted", "drawing"), found, right))
        if faults:
            raise SpecError(faults)
        return scaled


class FunctionWish(Wish):
    """Angles of a four-bar's crank and rocker that go together; [points], [links] and [[output]] are found."""

    function: tuple[tuple[Turn, Turn], ...] = Field(
        min_length=3,
        max_length=200,
        description="deg, [crank, rocker]: both angles counter-clockwise, counted from anywhere",
    )
    tolerance: Annotated[float, Field(gt=0, le=180)] | None = Field(
        None,
        description="deg, how far the rocker may be off; default: the nearest design, within a twentieth of its swing",
    )
    frame: Length = Field(60.0, description="mm, between the pivots of crank and rocker")
    shortest: Length | None = Field(
        None, description="mm, least length of a link; default: a fifth of frame"
    )
    longest: Length | None = Field(
        None, description="mm, greatest length of a link; default: twice frame"
    )
    lash: Annotated[float, Field(gt=0, le=180)] | None = Field(
        None, description="deg, greatest free play by all joints"
    )
    transmission_deg: Annotated[float, Field(ge=0, le=80)] = Field(
        30.0, description="deg, least transmission angle between coupler and rocker"
    )

    @property
    def shares(self) -> tuple[float, float]:
        """Least and greatest length of a link, as shares of the frame."""
        return (self.shortest or self.frame / 5) / self.frame, (
            self.longest or 2 * self.frame
        ) / self.frame

    @property
    def further(self) -> str:
        """What gives the search more room."""
        return "a greater wanted.frame or wanted.longest, a smaller wanted.shortest or wanted.transmission_deg"

    @property
    def allowance(self) -> float:
        """How far the rocker may be off, deg."""
        return self.tolerance or self._swing / _OF_USE

    @property
    def useful_play(self) -> float:
        """Play with which the rocker is still of use, deg."""
        return self.lash or self._swing / _OF_USE

    @property
    def _swing(self) -> float:
        rocker = [b for _, b in self.function]
        return max(rocker) - min(rocker)

    @property
    def turns(self) -> Sequence[tuple[float, float]]:
        """The pairs, both counted from the first one, deg."""
        x, y = self.function[0]
        return [(a - x, b - y) for a, b in self.function]

    def faults(self) -> list[Fault]:
        """What does not go together."""
        faults = []
        crank = sorted(a for a, _ in self.function)
        near = [a for a, b in itertools.pairwise(crank) if b - a < 1e-6]
        faults += [
            Fault(
                ("wanted", "function"),
                f"crank angle {a:g} twice",
                "another crank angle in each pair",
            )
            for a in near[:3]
        ]
        if crank[-1] - crank[0] > 360:
            faults.append(
                Fault(
                    ("wanted", "function"),
                    f"a range of {crank[-1] - crank[0]:g} deg",
                    "crank angles within one turn",
                )
            )
        if len({b for _, b in self.function}) == 1:
            faults.append(Fault(("wanted", "function"), "the rocker rests", "a rocker that turns"))
        sides = (
            ("shortest", self.shortest, self.shares[0] > 1),
            ("longest", self.longest, self.shares[1] < 1),
        )
        for key, value, wrong in sides:
            if wrong:
                faults.append(
                    Fault(
                        ("wanted", key),
                        f"{value:g}",
                        f"wanted.frame, {self.frame:g}, lies between both",
                    )
                )
        return faults


class KeyWish(Wish):
    """Values of keys by which all limits of a machine hold, and a figure is least or greatest."""

    vary: Annotated[dict[str, Bounds | Choices], Field(min_length=1, max_length=8)] = Field(
        description="keys that may change, each with its least and greatest value, or with words to choose from, such as laws"
    )
    least: str | None = Field(
        None, description="the figure, or the key of vary, to make as small as possible"
    )
    most: str | None = Field(
        None, description="the figure, or the key of vary, to make as great as possible"
    )
    figures: dict[str, Bounds] = Field(
        {}, description="figures that must lie between a least and a greatest value"
    )
    tolerance: Length | None = Field(
        None,
        description="mm or deg, how far outputs may be off: the tolerance of every target of [[output]]",
    )
    lash: Length | None = Field(
        None, description="mm or deg, greatest free play: limits.lash, or limits.lash_deg"
    )
    transmission_deg: Annotated[float, Field(ge=0, le=60)] | None = Field(
        None, description="deg, least transmission angle: limits.transmission_angle_deg"
    )
    effort: Annotated[int, Field(ge=1, le=50)] = Field(
        1,
        description="how long camgen searches: it tries about ninety designs for each key, times this number",
    )
    seed: Annotated[int, Field(ge=0, le=10**6)] = Field(
        0, description="another number begins the search from other values"
    )

    def faults(self) -> list[Fault]:
        """What does not go together."""
        faults = []
        for key, ends in self.vary.items():
            if isinstance(ends[0], str) and len(set(ends)) < len(ends):
                faults.append(
                    Fault(("wanted", "vary", key), ", ".join(map(str, ends)), "each word once")
                )
            elif not isinstance(ends[0], str) and not ends[0] < ends[1]:
                ends_text = f"[{ends[0]:g}, {ends[1]:g}]"
                faults.append(
                    Fault(
                        ("wanted", "vary", key),
                        ends_text,
                        "the least value first, then the greatest",
                    )
                )
        faults += [
            Fault(("wanted", "vary", key), key, "a key of the spec, such as geometry.base_radius")
            for key in self.vary
            if not re.fullmatch(r"[\w.\-]+", key)
        ]
        if (self.least is None) == (self.most is None):
            faults.append(
                Fault(
                    ("wanted", "least"),
                    "",
                    "one of wanted.least and wanted.most: what the search is for",
                )
            )
        faults += [
            Fault(
                ("wanted", "figures", name),
                f"[{low:g}, {high:g}]",
                "the least value first, then the greatest",
            )
            for name, (low, high) in self.figures.items()
            if not low <= high
        ]
        return faults


class LinkWish(Wish):
    """What is common to linkages that a few positions ask for; [points], [links] and [[output]] are found."""

    linkage: ClassVar[str] = "four-bar"  # what is found
    things: ClassVar[str]  # what is wanted, several of them
    unit: ClassVar[str] = "mm"  # of tolerance and lash
    lash_key: ClassVar[str] = "lash"  # of [limits]
    bound: ClassVar[str] = "wanted.longest"  # keys that bound links and pivots

    tolerance: Length | None = Field(
        None, description="mm, how far the linkage may be off; default: a twentieth of the size"
    )
    lash: Length | None = Field(None, description="mm, greatest free play by all joints")
    shortest: Length | None = Field(
        None, description="mm, least distance of two pins of a link; default: what the hubs need"
    )
    longest: Length | None = Field(
        None, description="mm, greatest distance; default: three times the size of what is wanted"
    )
    transmission_deg: Annotated[float, Field(ge=0, le=80)] = Field(
        30.0,
        description="deg, least transmission angle between two links at a joint, or between a rod and a slide's normal",
    )
    turns: bool | None = Field(
        None,
        description="true: the crank turns all round; false: it goes to and fro; default: it turns if it can",
    )
    effort: Annotated[int, Field(ge=1, le=50)] = Field(
        1, description="number of drawings from which a search begins"
    )
    seed: Annotated[int, Field(ge=0, le=10**6)] = Field(
        0, description="another number begins the search from other drawings"
    )

    @property
    @abstractmethod
    def size(self) -> float:
        """Of what is wanted, by which bounds are set, mm."""

    @property
    @abstractmethod
    def count(self) -> int:
        """How many positions are wanted."""

    @property
    def title(self) -> str:
        """What is wanted, in words."""
        return f"{self.count} {self.things}"

    @property
    def box(self) -> tuple[complex, complex]:
        """Least and greatest corner of where pivots may stand, mm."""
        everywhere = complex(math.inf, math.inf)
        return -everywhere, everywhere

    @property
    def exact(self) -> bool:
        """Whether only what meets the wish exactly is looked for, not what comes near."""
        return False

    @property
    def trades_size(self) -> bool:
        """Whether size and transmission angle decide among designs: all are near enough; if not, the error does."""
        return self.exact or self.tolerance is not None

    @property
    def figures(self) -> Mapping[str, str]:
        """Columns of the front, how a person reads them; the first two are drawn, one over the other."""
        return {
            "bars_mm": "bars of {:.4g} mm",
            "transmission_deg": "transmission angle {:.4g} deg and more",
            "crank_range_deg": "crank over {:.4g} deg",
            **({} if self.exact else self.errors),
            "lash": f"play of {{:.3g}} {self.unit}",
        }

    @property
    def default(self) -> str:
        """What the allowance is where no tolerance is given."""
        return "" if self.tolerance else "a twentieth of its size"

    @property
    def errors(self) -> Mapping[str, str]:
        """Those of how far it is off."""
        return {"off_mm": "at most {:.3g} mm off"}

    @property
    def allowance(self) -> float:
        """How far the linkage may be off."""
        return self.tolerance or float(f"{self.size / _OF_USE:.4g}")

    @property
    def useful_play(self) -> float:
        """Play with which the linkage is still of use."""
        return self.lash or float(f"{self.size / _OF_USE:.4g}")

    @property
    def tighter(self) -> str:
        """What makes the play less."""
        return "set a smaller print.slide_clearance"

    @property
    def further(self) -> str:
        """What gives the search more room."""
        return "a greater wanted.longest or wanted.effort, a smaller wanted.transmission_deg"

    def room(self, hub: float) -> Room:
        """Where it may be, and how large; hub: least distance of two pins that can be made, mm."""
        longest = self.longest or _LONG * self.size
        least = math.radians(self.transmission_deg)
        return Room(*self.box, self.shortest or hub, longest, least, self.turns)

    def rooms(self, hub: float) -> Sequence[Room]:
        """That room, then wider ones for where nothing is found in it."""
        return [self.room(hub)]

    def faults(self) -> list[Fault]:
        """What does not go together."""
        faults = []
        if self.longest is not None and self.shortest is not None:
            if self.longest <= self.shortest:
                right = f"more than wanted.shortest, {self.shortest:g}"
                faults.append(Fault(("wanted", "longest"), f"{self.longest:g}", right))
        if self.size < _SMALLEST:
            right = f"places that are {_SMALLEST:g} mm apart or more"
            found = f"places within {self.size:.3g} mm"
            faults.append(Fault(("wanted", kind_of(self)), found, right))
        return faults


class FourBarWish(LinkWish):
    """A four-bar that some places in the plane ask for."""

    bound: ClassVar[str] = "wanted.longest or wanted.pivots"

    pivots: tuple[tuple[Coordinate, Coordinate], tuple[Coordinate, Coordinate]] | None = Field(
        None,
        description="mm, two corners of the box in which both pivots stand; default: one and a half times the size of what is wanted, "
        "round it",
    )

    @property
    @abstractmethod
    def places(self) -> Points:
        """Where something is wanted, complex mm."""

    @property
    def count(self) -> int:
        """How many places."""
        return len(self.places)

    @property
    def size(self) -> float:
        """Largest distance of two places, mm."""
        return magnitude(self.places[:, None] - self.places)

    @property
    def further(self) -> str:
        """What gives the search more room."""
        return f"a greater wanted.pivots, {super().further}"

    @property
    def box(self) -> tuple[complex, complex]:
        """Of the wish, or round the places."""
        z = self.places
        margin = _ROUND * self.size
        if self.pivots is not None:
            z = np.array([complex(*corner) for corner in self.pivots])
            margin = 0.0
        low = complex(z.real.min() - margin, z.imag.min() - margin)
        return low, complex(z.real.max() + margin, z.imag.max() + margin)

    def faults(self) -> list[Fault]:
        """What does not go together."""
        faults = super().faults()
        if self.pivots is not None and np.max(np.abs(np.subtract(*self.pivots))) < SAME_POINT:
            right = "two corners that are apart"
            faults.append(Fault(("wanted", "pivots"), str(list(self.pivots)), right))
        return faults


class PoseWish(FourBarWish):
    """Poses that a body of a four-bar is to come to in their order."""

    things: ClassVar[str] = "poses"

    poses: tuple[tuple[Coordinate, Coordinate, Turn], ...] = Field(
        min_length=3,
        max_length=60,
        description="[x, y, deg] of the body in their order: place, mm, and angle; up to five are met exactly",
    )
    tolerance_deg: Annotated[float, Field(gt=0, le=180)] | None = Field(
        None,
        description="deg, how far the body's angle may be off, counted from the first; default: a twentieth of its range",
    )

    @property
    def places(self) -> Points:
        """Of the body, complex mm."""
        return np.array([complex(x, y) for x, y, _ in self.poses])

    @property
    def angles(self) -> Floats:
        """Of the body, rad."""
        return np.radians([angle for _, _, angle in self.poses])

    @property
    def exact(self) -> bool:
        """Three and four always, five unless a tolerance lets them be off."""
        count = len(self.poses)
        return count < 5 or count == 5 and self.tolerance is None and self.tolerance_deg is None

    def rooms(self, hub: float) -> Sequence[Room]:
        """Those of exact four-bars are few, and quickly found: where none is of use, bounds that nobody gave are widened."""
        usual = self.room(hub)
        if not self.exact:
            return [usual]
        open_bounds = {"pivots": self.pivots is None, "longest": self.longest is None}
        return [usual, *(usual.wider(times, **open_bounds) for times in _WIDER)]

    @property
    def errors(self) -> Mapping[str, str]:
        """Of place and angle."""
        return {**super().errors, "off_deg": "at most {:.3g} deg off"}

    @property
    def allowance_deg(self) -> float:
        """How far the body's angle may be off, deg."""
        angles = [angle for _, _, angle in self.poses]
        return self.tolerance_deg or max((max(angles) - min(angles)) / _OF_USE, _LEAST_ANGLE)

    @property
    def default_deg(self) -> str:
        """What that is where no tolerance is given."""
        return "" if self.tolerance_deg else "a twentieth of the angles' range"

    def faults(self) -> list[Fault]:
        """What does not go together."""
        return super().faults() + [
            Fault(("wanted", "poses", k), str(list(b)), "another pose than the one before")
            for k, (a, b) in enumerate(itertools.pairwise(self.poses), 1)
            if a == b
        ]


PointRow = Annotated[tuple[Coordinate, ...], Field(min_length=2, max_length=3)]


class PointWish(FourBarWish):
    """Points that a point of a four-bar is to pass in their order, each at an angle of its crank where one is given."""

    things: ClassVar[str] = "points"

    points: tuple[PointRow, ...] = Field(
        min_length=3,
        max_length=60,
        description="[x, y] in their order, mm; or [x, y, deg] with the crank's angle there, counter-clockwise from anywhere",
    )

    @property
    def timed(self) -> bool:
        """Whether the crank's angles are given."""
        return len(self.points[0]) == 3

    @property
    def places(self) -> Points:
        """To be passed, complex mm; without angles a last one that is the first again is left out."""
        z = np.array([complex(*row[:2]) for row in self.points])
        back = not self.timed and len(z) > 3 and z[-1] == z[0]
        return np.asarray(z[:-1] if back else z)

    @property
    def crank(self) -> Floats | None:
        """Its angle at each point, rad; None where none are given."""
        return np.radians([row[2] for row in self.points]) if self.timed else None

    def faults(self) -> list[Fault]:
        """What does not go together."""
        faults = super().faults()
        if len({len(row) for row in self.points}) > 1:
            right = "an angle of the crank for each point, or for none"
            odd = next(k for k, row in enumerate(self.points) if len(row) != len(self.points[0]))
            faults.append(Fault(("wanted", "points", odd), str(list(self.points[odd])), right))
        elif self.crank is not None:
            steps = np.diff(self.crank)
            whole = abs(float(steps.sum()))
            if not ((steps > 0).all() or (steps < 0).all()) or whole >= math.tau:
                right = "crank angles that grow, or fall, from point to point within one turn"
                found = ", ".join(f"{row[2]:g}" for row in self.points[:8])
                faults.append(Fault(("wanted", "points"), found, right))
        return faults


class SlideWish(LinkWish):
    """Places of a slider-crank's slider at angles of its crank."""

    linkage: ClassVar[str] = "slider-crank"
    things: ClassVar[str] = "pairs"

    slide: tuple[tuple[Turn, Coordinate], ...] = Field(
        min_length=3,
        max_length=60,
        description="[crank, slider], deg counter-clockwise and mm, both counted from anywhere; three are met exactly",
    )
    transmission_deg: Annotated[float, Field(ge=0, le=80)] = Field(
        45.0, description="deg, least transmission angle between the rod and the slide's normal"
    )

    @property
    def count(self) -> int:
        """How many pairs."""
        return len(self.slide)

    @property
    def exact(self) -> bool:
        """Three pairs are, unless a tolerance lets them be off."""
        return len(self.slide) == 3 and self.tolerance is None

    @property
    def size(self) -> float:
        """How far the slider goes, mm."""
        places = [place for _, place in self.slide]
        return max(places) - min(places)

    @property
    def pairs(self) -> tuple[Floats, Floats]:
        """Turns of the crank, rad, and ways of the slider, mm, both from the first pair, (n,)."""
        crank, places = np.array(self.slide).T
        return np.radians(crank - crank[0]), places - places[0]

    def faults(self) -> list[Fault]:
        """What does not go together."""
        crank = sorted(angle for angle, _ in self.slide)
        faults = super().faults()
        if crank[-1] - crank[0] >= 360 or min(np.diff(crank)) < _SAME_ANGLE:
            right = "different crank angles within one turn"
            found = ", ".join(f"{angle:g}" for angle, _ in self.slide[:8])
            faults.append(Fault(("wanted", "slide"), found, right))
        return faults


class Rests(Record):
    """How long an output is to rest, and how far it is to go."""

    span_deg: Annotated[float, Field(ge=10, le=240)] = Field(
        description="deg, turn of the crank over which the output rests"
    )
    swing_deg: Annotated[float, Field(ge=2, le=150)] = Field(
        description="deg, how far the output goes to and fro"
    )


class DwellWish(LinkWish):
    """A six-bar whose output rests while the crank turns on."""

    linkage: ClassVar[str] = "six-bar"
    things: ClassVar[str] = "dwell"
    unit: ClassVar[str] = "deg"
    lash_key: ClassVar[str] = "lash_deg"

    dwell: Rests = Field(description="span_deg, how long it rests; swing_deg, how far it goes")
    tolerance: Annotated[float, Field(gt=0, le=30)] | None = Field(
        None,
        description="deg, band within which the output rests; default: the nearest design, within a fiftieth of its swing",
    )
    lash: Annotated[float, Field(gt=0, le=180)] | None = Field(
        None, description="deg, greatest free play by all joints"
    )
    frame: Length = Field(60.0, description="mm, between the pivots of crank and rocker")
    transmission_deg: Annotated[float, Field(ge=0, le=60)] = Field(
        20.0,
        description="deg, least transmission angle between coupler and rocker, and between rod and output",
    )

    @property
    def count(self) -> int:
        """One."""
        return 1

    @property
    def title(self) -> str:
        """What is wanted, in words."""
        return f"a dwell of {self.dwell.span_deg:g} deg"

    @property
    def size(self) -> float:
        """Of the frame, mm."""
        return self.frame

    @property
    def allowance(self) -> float:
        """Band within which the output rests, deg."""
        return self.tolerance or self.dwell.swing_deg / _OF_REST

    @property
    def default(self) -> str:
        """What that is where no tolerance is given."""
        return "" if self.tolerance else "a fiftieth of its swing"

    @property
    def useful_play(self) -> float:
        """Play with which the output is still of use, deg."""
        return self.lash or self.dwell.swing_deg / _OF_USE

    @property
    def errors(self) -> Mapping[str, str]:
        """Of rest and swing."""
        return {"rest_deg": "rests within {:.3g} deg", "swing_deg": "swings {:.4g} deg"}

    @property
    def further(self) -> str:
        """What gives the search more room."""
        return f"a smaller wanted.dwell.span_deg, {super().further}"

    @property
    def tighter(self) -> str:
        """What makes the play less."""
        return f"{super().tighter} or a greater wanted.frame"

    def faults(self) -> list[Fault]:
        """What does not go together."""
        faults = super().faults()
        if self.turns is False:
            right = "true, or no such key: the crank of a dwell turns all the way round"
            faults.append(Fault(("wanted", "turns"), "false", right))
        return faults


class _Asks(Checked):
    wanted: Wish

    def faults(self) -> Sequence[Fault]:
        """Of the wish."""
        return self.wanted.faults()


_KINDS: Mapping[str, type[Wish]] = {
    "path": PathWish,
    "function": FunctionWish,
    "poses": PoseWish,
    "points": PointWish,
    "slide": SlideWish,
    "dwell": DwellWish,
    "drawing": DrawingWish,
    "vary": KeyWish,
}


def kind_of(wish: Wish) -> str:
    """The key that says what is wanted."""
    return next(key for key, kind in _KINDS.items() if isinstance(wish, kind))


def asked_for(data: Mapping[str, Any]) -> str:
    """What a spec's wish is for: a key of [wanted], such as "path"; "" where it is the machine's own, or there is none."""
    table = data.get("wanted")
    return next((key for key in _KINDS if isinstance(table, dict) and key in table), "")


def wish(data: Mapping[str, Any], source: str) -> Wish | None:
    """The wish of a spec's tables; None where it is the machine's own, or there is none; SpecError with its faults."""
    kind = asked_for(data)
    if not kind:
        return None
    asks = create_model("Asks", __base__=_Asks, wanted=(_KINDS[kind], ...))
    record: Wish = validate(asks, {"wanted": data["wanted"]}, source).wanted
    return record


def wish_schema(mechanism: str) -> dict[str, Any]:
    """JSON Schema of the table [wanted] of `camgen design`, with definitions of its own: keys that vary, for any mechanism, and
    what ends in a linkage."""
    kinds = _KINDS if mechanism == "linkage" else {"vary": KeyWish}
    every: Any = Union[tuple(kinds.values())]  # noqa: UP007  made of a list
    found = TypeAdapter(every).json_schema(ref_template="#/$defs/{model}")
    rest = {key: value for key, value in found.items() if key != "$defs"}
    defs = found.get("$defs", {})
    if "anyOf" not in rest:  # of one kind it is the kind itself
        defs = {**defs, KeyWish.__name__: rest}
        rest = {"$ref": f"#/$defs/{KeyWish.__name__}"}
    return {**rest, "description": "what camgen design searches for", "$defs": defs}


def without(data: Data) -> Data:
    """The tables less [wanted]."""
    return {key: value for key, value in data.items() if key != "wanted"}


def _named(key: str, path: str, folder: Path) -> Path:
    """The file that a wish names by this key, seen from the folder of its spec."""
    (reference,) = references({"wanted": {key: path}})
    return reference.file(folder)
