"""Where the names of holes and of round things that stand on a part go in its drawing: on paper that is free.

    box       what a line of text takes on paper
    taken     boxes of other texts, arrowheads, and lines that no text may lie on
    near      beside its own hole, and nearer to it than to any other; further away a label has a leader

Each label is tried in its hole, then round it, ring after ring, until its box is free. Centre lines are crossed only where there
is no other place. Lengths are mm of paper.
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np

from camgen.files.dimensions import Hole
from camgen.files.sheet import Fill, Sheet, Stroke, Text, arrowhead
from camgen.geometry.outlines import Contour, Line, Piece, Points
from camgen.numerics import coordinates

HEIGHT = 2.5
_GRID = 41  # places across a face for a mark
_AIR = 0.5  # round a text
_HIGH = 1.2  # from an edge to a label beside it
_NEAR = (0.0, 1.2, 2.5)  # further than that, without a leader
# of half the width of a hole that is not round, from its middle
_SHARES = (0.0, 0.25, -0.25, 0.5, -0.5)
_SHORT = 0.98  # of the way from a label to its hole, on which no line lies
_FAR = tuple(np.arange(5.0, 60.0, 2.0))  # with one: so much that its arrow has room
_TURNS = np.radians([45, 135, 315, 225, 65, 115, 295, 245, 25, 155, 335, 205, 90, 270, 0, 180])
_ASIDE = (0.0, 0.3, -0.3, 0.6, -0.6, 0.9, -0.9)  # rad
_HARD = ("CUT", "WALL", "VIEW", "DIM", "TEXT")  # layers of lines on which no text lies


def along(contours: Sequence[Contour]) -> Points:
    """Points along contours, close enough to place a label."""
    return _points([piece for contour in contours for piece in contour.pieces])


def _points(pieces: Iterable[Piece]) -> Points:
    return np.concatenate(
        [np.atleast_1d(piece.at(np.linspace(piece.t0, piece.t1, 33))) for piece in pieces]
    )


def box(text: Text, air: float = 0.0) -> Any:
    """What a line of text takes on paper at most, with so much air round it, as a polygon of shapely."""
    return _boxes(text, np.array([text.at]), air)[0]


def _boxes(text: Text, places: Points, air: float) -> Any:
    """The same of a text at several places, (n,)."""
    import shapely

    u = text.direction
    room = text.room
    left = places - {"left": 0.0, "centre": 0.5, "right": 1.0}[text.align] * room * u
    low = left - air * (u + 1j * u)
    high = left + (room + air) * u + (text.height + air) * 1j * u
    wide = room + 2 * air
    corners = np.stack([low, low + wide * u, high, high - wide * u], axis=-1)
    return shapely.polygons(np.stack([corners.real, corners.imag], axis=-1))


def upper_mark(sheet: Sheet, face: Any, middle: complex) -> Text | None:
    """UP on a face, a polygon of shapely on paper, where that is free: as near to a point as can be; None without such a place."""
    import shapely

    x0, y0, x1, y1 = face.bounds
    across, up = np.meshgrid(np.linspace(x0, x1, _GRID), np.linspace(y0, y1, _GRID))
    places = (across + 1j * up).ravel()
    places = places[np.argsort(np.round(np.abs(places - middle), 6), kind="stable")]
    mark = Text(0j, "UP", 1.4 * HEIGHT, "centre")
    boxes = _boxes(mark, places, 2 * _AIR)
    obstacles = Obstacles()
    obstacles.add(sheet.primitives)
    good = shapely.contains(face, boxes) & obstacles.free(boxes) & obstacles.unlined(boxes)
    return replace(mark, at=complex(places[int(np.argmax(good))])) if good.any() else None


def _line(points: Points) -> Any:
    import shapely

    return shapely.LineString(coordinates(points))


@dataclass
class Obstacles:
    """What lies on a sheet."""

    # lower left and upper right corner of where labels may go
    area: tuple[complex, complex] = (complex(-math.inf, -math.inf), complex(math.inf, math.inf))
    texts: list[Any] = field(default_factory=list)  # boxes of texts and arrowheads
    lines: list[Any] = field(default_factory=list)  # on which no text lies
    axes: list[Any] = field(default_factory=list)  # on which one lies if it must
    # of each list, which only grows: how many it had, and the tree of those
    _trees: dict[int, tuple[int, Any]] = field(default_factory=dict, repr=False)

    def add(self, things: Iterable[Stroke | Fill | Text]) -> None:
        """More things that are drawn."""
        import shapely

        for thing in things:
            if isinstance(thing, Text):
                self.texts.append(box(thing))
            elif isinstance(thing, Fill):
                self.texts.append(shapely.Polygon([(z.real, z.imag) for z in thing.corners]))
            else:
                points = _points(thing.pieces)
                line = _line(np.append(points, points[:1]) if thing.closed else points)
                (self.lines if thing.layer in _HARD else self.axes).append(line)

    def within(self, boxes: Any) -> Any:
        """Which of some boxes lie in the area, (n,)."""
        import shapely

        low, high = self.area
        left, bottom, right, top = shapely.bounds(boxes).T
        across = (left > low.real) & (right < high.real)
        return across & (bottom > low.imag) & (top < high.imag)

    def free(self, shapes: Any) -> Any:
        """Which of some shapes lie on no text and no arrowhead, (n,)."""
        return self._touching(self.texts, shapes) == 0

    def unlined(self, shapes: Any) -> Any:
        """Which of them no line crosses, (n,)."""
        return self._touching(self.lines, shapes) == 0

    def crossed(self, shapes: Any) -> Any:
        """How many lines each of them crosses, (n,)."""
        return self._touching(self.lines, shapes)

    def off_axes(self, shapes: Any) -> Any:
        """Which of them no centre line or hidden edge crosses, (n,)."""
        return self._touching(self.axes, shapes) == 0

    def _touching(self, others: list[Any], shapes: Any) -> Any:
        """How many of the others, one of the lists, each shape touches, (n,)."""
        import shapely

        if not others:
            return np.zeros(len(shapes), int)
        count, tree = self._trees.get(id(others), (0, None))
        if count != len(others):
            tree = shapely.STRtree(others)
            self._trees[id(others)] = len(others), tree
        pairs = tree.query(np.asarray(shapes), predicate="intersects")
        return np.bincount(pairs[0], minlength=len(shapes))


def leader(
    sheet: Sheet, tip: complex, direction: complex, clear: Callable[[complex], float], text: str
) -> list[Stroke | Fill | Text]:
    """Arrow onto a point from a direction with the text along it, turned aside until that lies on free paper.

    clear: by its direction, how far from the point on there may be text.
    """
    obstacles = Obstacles()
    obstacles.add(sheet.primitives)
    tries = list[tuple[Text, complex]]()
    for turn in _ASIDE:
        way = direction * cmath.rect(1, turn)
        reading = way if way.real > -1e-9 else -way
        away = clear(way)
        label = Text(0j, text, HEIGHT, "centre", reading, "DIM")
        middle = tip + (away + label.room / 2 + 4) * way + 0.8j * reading
        tries.append((replace(label, at=middle), tip + (away + label.room + 4) * way))
    boxes = np.array([box(label, _AIR) for label, _ in tries])
    met = 100 * ~obstacles.free(boxes) + obstacles.crossed(boxes)
    label, start = tries[int(np.argmin(met))]
    return Callout(label, start, tip).things


@dataclass(frozen=True)
class Label:
    """A label, and the outline of what it names."""

    label: str
    hole: Hole  # on paper
    rim: Points  # along its outline

    @cached_property
    def half(self) -> float:
        """Half of the label's width on paper, mm."""
        return Text(0j, self.label, HEIGHT).room / 2

    def reach(self, way: complex) -> float:
        """How far it goes from its middle in a direction."""
        return float(np.max(((self.rim - self.hole.middle) * way.conjugate()).real))


@dataclass(frozen=True)
class Callout:
    """A label's text, and its leader from a start to a tip; without one no tip."""

    text: Text
    start: complex = 0j
    tip: complex | None = None

    @property
    def things(self) -> list[Stroke | Fill | Text]:
        """What is drawn of it."""
        things: list[Stroke | Fill | Text] = [self.text]
        if self.tip is not None:
            things.append(Stroke((Line(self.start, self.tip),), "DIM"))
            things.append(
                arrowhead(self.tip, (self.tip - self.start) / abs(self.tip - self.start), "DIM")
            )
        return things


def callouts(
    labels: Sequence[Label], sheet: Sheet, area: tuple[complex, complex]
) -> Iterator[Callout]:
    """Each label on paper that is free on the sheet and of those before it; area: corners of where they may go, lower left and
    upper right."""
    obstacles = Obstacles(area)
    obstacles.add(sheet.primitives)
    for each in labels:
        others = [other for other in labels if other.hole.middle != each.hole.middle]
        label = _place(each, others, obstacles)
        obstacles.add(label.things)
        yield label


def _place(subject: Label, others: Sequence[Label], obstacles: Obstacles) -> Callout:
    for crossing in (False, True):
        for distance in (None, *_NEAR, *_FAR):
            label = _best(subject, others, obstacles, distance, crossing)
            if label is not None:
                return label
    return Callout(_text(subject, subject.hole.middle))


def _text(label: Label, middle: complex) -> Text:
    return Text(middle - 0.5j * HEIGHT, label.label, HEIGHT, "centre", layer="DIM")


def _best(
    label: Label,
    others: Sequence[Label],
    obstacles: Obstacles,
    distance: float | None,
    crossing: bool,
) -> Callout | None:
    """The first free place at a distance from the hole's edge, None: in it; crossing: whether centre lines may be crossed."""
    import shapely

    hole = label.hole
    ways = np.exp(1j * _TURNS)
    if distance is None:
        places = _inside(label)
    else:
        away = np.array([label.reach(way) for way in ways]) + _HIGH + distance
        places = hole.middle + away * ways + (label.half * ways.real + 1j * HEIGHT / 2 * ways.imag)
    texts = [_text(label, complex(place)) for place in places]
    boxes = _boxes(texts[0], np.array([text.at for text in texts]), _AIR)
    free = obstacles.within(boxes) & obstacles.free(boxes) & obstacles.unlined(boxes)
    free &= True if crossing else obstacles.off_axes(boxes)
    if distance is None:
        edge = shapely.Polygon(np.column_stack([label.rim.real, label.rim.imag]))
        free &= shapely.contains(edge, boxes)
    elif distance in _NEAR:
        free[free] = [_beside_its_own(label, others, complex(place)) for place in places[free]]
        nearest = np.array([_tip(label, complex(place)) for place in places])
        stops = places + _SHORT * (nearest - places)
        free &= obstacles.unlined(
            [_line(np.array(ends)) for ends in zip(places, stops, strict=True)]
        )
    if distance is None or distance in _NEAR:
        return Callout(texts[int(np.argmax(free))]) if free.any() else None
    if not free.any():
        return None
    starts = [_edge(text, label.half, hole.middle) for text in texts]
    tips = [_tip(label, start) for start in starts]
    leaders = [_line(np.array(ends)) for ends in zip(starts, tips, strict=True)]
    free &= obstacles.free(shapely.buffer(leaders, _AIR))
    if not free.any():
        return None
    crossings = obstacles.crossed(leaders)
    k = int(np.argmin(np.where(free, crossings, np.max(crossings) + 1)))
    return Callout(texts[k], starts[k], tips[k])


def _inside(label: Label) -> Points:
    """Places in a hole, (n,): round the middle of a round one; of any other one its middle, and others within the box of its rim."""
    hole = label.hole
    if hole.radius:
        return np.asarray(hole.middle + hole.radius / 2 * np.exp(1j * _TURNS[:4]))
    half = complex(np.ptp(label.rim.real), np.ptp(label.rim.imag)) / 2
    across, up = np.meshgrid(_SHARES, _SHARES)
    return np.asarray(hole.middle + (across * half.real + 1j * up * half.imag).ravel())


def _edge(text: Text, half: float, towards: complex) -> complex:
    """Where a leader leaves a text's box."""
    middle = text.at + 0.5j * HEIGHT
    way = (towards - middle) / abs(towards - middle)
    wide = half + _AIR
    tall = HEIGHT / 2 + _AIR
    return middle + way * min(wide / max(abs(way.real), 1e-9), tall / max(abs(way.imag), 1e-9))


def _tip(label: Label, start: complex) -> complex:
    """Where a leader meets its hole: on a round one's edge, else on the nearest point of the outline."""
    hole = label.hole
    if hole.radius:
        return hole.middle - hole.radius * (hole.middle - start) / abs(hole.middle - start)
    return complex(label.rim[int(np.argmin(np.abs(label.rim - start)))])


def _beside_its_own(label: Label, others: Sequence[Label], place: complex) -> bool:
    """Whether a label at that place is nearer to its hole than to any other one: to its middle and to its edge."""
    edges = [float(np.min(np.abs(each.rim - place))) for each in (label, *others)]
    middles = [abs(each.hole.middle - place) for each in (label, *others)]
    return all(min(away[1:], default=math.inf) > away[0] for away in (edges, middles))
