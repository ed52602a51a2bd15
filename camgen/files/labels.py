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
from typing import Any

import numpy as np

from camgen.files.dimensions import Hole
from camgen.files.sheet import Fill, Sheet, Stroke, Text, arrowhead
from camgen.geometry.outlines import Contour, Line, Piece, Points

HEIGHT = 2.5
_AIR = 0.5  # round a text
_HIGH = 1.2  # from an edge to a label beside it
_NEAR = (0.0, 1.2, 2.5)  # further than that, without a leader
_FAR = tuple(np.arange(5.0, 60.0, 2.0))  # with one: so much that its arrow has room
_TURNS = np.radians([45, 135, 315, 225, 65, 115, 295, 245, 25, 155, 335, 205, 90, 270, 0, 180])
_ASIDE = (0.0, 0.3, -0.3, 0.6, -0.6, 0.9, -0.9)  # rad
_HARD = ("CUT", "VIEW", "DIM", "TEXT")  # layers of lines on which no text lies


def along(contours: Sequence[Contour]) -> Points:
    """Points along contours, close enough to place a label."""
    return _points([piece for contour in contours for piece in contour.pieces])


def _points(pieces: Iterable[Piece]) -> Points:
    return np.concatenate(
        [np.atleast_1d(piece.at(np.linspace(piece.t0, piece.t1, 33))) for piece in pieces]
    )


def box(text: Text, air: float = 0.0) -> Any:
    """What a line of text takes on paper at most, with so much air round it, as a polygon of shapely."""
    import shapely

    u = text.direction
    left = text.at - {"left": 0.0, "centre": 0.5, "right": 1.0}[text.align] * text.room * u
    low, high = (
        left - air * (u + 1j * u),
        left + (text.room + air) * u + (text.height + air) * 1j * u,
    )
    wide = text.room + 2 * air
    corners = np.array([low, low + wide * u, high, high - wide * u])
    return shapely.Polygon(np.column_stack([corners.real, corners.imag]))


def _line(points: Points) -> Any:
    import shapely

    return shapely.LineString(np.column_stack([points.real, points.imag]))


@dataclass
class Taken:
    """What lies on a sheet."""

    texts: list[Any] = field(default_factory=list)  # boxes of texts and arrowheads
    lines: list[Any] = field(default_factory=list)  # on which no text lies
    axes: list[Any] = field(default_factory=list)  # on which one lies if it must

    @classmethod
    def of(cls, sheet: Sheet) -> Taken:
        """All that is drawn so far."""
        found = cls()
        for thing in sheet.primitives:
            found.add(thing)
        return found

    def add(self, thing: Stroke | Fill | Text) -> None:
        """One more thing."""
        import shapely

        if isinstance(thing, Text):
            self.texts.append(box(thing))
        elif isinstance(thing, Fill):
            self.texts.append(shapely.Polygon([(z.real, z.imag) for z in thing.corners]))
        else:
            points = _points(thing.pieces)
            line = _line(np.append(points, points[:1]) if thing.closed else points)
            (self.lines if thing.layer in _HARD else self.axes).append(line)

    def free(self, shapes: Any) -> Any:
        """Which of some shapes lie on no text and no arrowhead, (n,)."""
        return _clear(self.texts, shapes)

    def unlined(self, shapes: Any) -> Any:
        """Which of them no line crosses, (n,)."""
        return _clear(self.lines, shapes)

    def crossed(self, shapes: Any) -> Any:
        """How many lines each of them crosses, (n,)."""
        return _touching(self.lines, shapes)

    def off_axes(self, shapes: Any) -> Any:
        """Which of them no centre line or hidden edge crosses, (n,)."""
        return _clear(self.axes, shapes)


def _touching(others: Sequence[Any], shapes: Sequence[Any]) -> Any:
    """How many of the others each shape touches, (n,)."""
    import shapely

    pairs = (
        shapely.STRtree(others).query(np.asarray(shapes), predicate="intersects")
        if others
        else np.zeros((2, 0), int)
    )
    return np.bincount(pairs[0], minlength=len(shapes))


def _clear(others: Sequence[Any], shapes: Any) -> Any:
    """Which of some shapes touch none of the others, (n,)."""
    return _touching(others, shapes) == 0


def led(
    sheet: Sheet, tip: complex, direction: complex, clear: Callable[[complex], float], text: str
) -> list[Stroke | Fill | Text]:
    """Arrow onto a point from a direction with the text along it, turned aside until that lies on free paper.

    clear: by its direction, how far from the point on there may be text.
    """
    taken, tries = Taken.of(sheet), list[tuple[Text, complex]]()
    for turn in _ASIDE:
        way = direction * cmath.rect(1, turn)
        reading, away = way if way.real > -1e-9 else -way, clear(way)
        label = Text(0j, text, HEIGHT, "centre", reading, "DIM")
        middle = tip + (away + label.room / 2 + 4) * way + 0.8j * reading
        tries.append((replace(label, at=middle), tip + (away + label.room + 4) * way))
    label, start = tries[int(np.argmax(taken.free([box(label, _AIR) for label, _ in tries])))]
    return Placed(label, start, tip).things


@dataclass(frozen=True)
class Named:
    """A label, and the outline of what it names."""

    label: str
    hole: Hole  # on paper
    rim: Points  # along its outline

    def reach(self, way: complex) -> float:
        """How far it goes from its middle in a direction."""
        return float(np.max(((self.rim - self.hole.middle) * way.conjugate()).real))


@dataclass(frozen=True)
class Placed:
    """A label's text, and its leader from a start to a tip; without one no tip."""

    text: Text
    start: complex = 0j
    tip: complex | None = None

    @property
    def things(self) -> list[Stroke | Fill | Text]:
        """What is drawn of it."""
        found: list[Stroke | Fill | Text] = [self.text]
        if self.tip is not None:
            found.append(Stroke((Line(self.start, self.tip),), "DIM"))
            found.append(
                arrowhead(self.tip, (self.tip - self.start) / abs(self.tip - self.start), "DIM")
            )
        return found


def placed(named: Sequence[Named], sheet: Sheet, area: tuple[complex, complex]) -> Iterator[Placed]:
    """Each label on paper that is free on the sheet and of those before it; area: corners of where they may go, lower left and
    upper right."""
    taken = Taken.of(sheet)
    for k, each in enumerate(named):
        others = [
            other
            for i, other in enumerate(named)
            if i != k and other.hole.middle != each.hole.middle
        ]
        found = _place(each, others, taken, area)
        for thing in found.things:
            taken.add(thing)
        yield found


def _place(
    named: Named, others: Sequence[Named], taken: Taken, area: tuple[complex, complex]
) -> Placed:
    half = Text(0j, named.label, HEIGHT).room / 2
    for crossing in (False, True):
        for distance in ("in", *_NEAR, *_FAR):
            found = _best(named, others, taken, area, half, distance, crossing)
            if found is not None:
                return found
    return Placed(_text(named, named.hole.middle))


def _text(named: Named, middle: complex) -> Text:
    return Text(middle - 0.5j * HEIGHT, named.label, HEIGHT, "centre", layer="DIM")


def _best(
    named: Named,
    others: Sequence[Named],
    taken: Taken,
    area: tuple[complex, complex],
    half: float,
    distance: Any,
    crossing: bool,
) -> Placed | None:
    """The first free place at a distance from the hole's edge, or in it; crossing: whether centre lines may be crossed."""
    import shapely

    hole, inside = named.hole, distance == "in"
    ways = np.exp(1j * _TURNS)
    if inside:
        away = np.full(4, hole.radius / 2) if hole.radius else np.zeros(1)
        places = hole.middle + away * ways[: len(away)]
    else:
        away = np.array([named.reach(way) for way in ways]) + _HIGH + distance
        places = hole.middle + away * ways + (half * ways.real + 1j * HEIGHT / 2 * ways.imag)
    texts = [_text(named, complex(place)) for place in places]
    boxes = np.array([box(text, _AIR) for text in texts])
    low, high = area
    left, bottom, right, top = shapely.bounds(boxes).T
    good = (left > low.real) & (right < high.real) & (bottom > low.imag) & (top < high.imag)
    good &= taken.free(boxes) & taken.unlined(boxes)
    good &= True if crossing else taken.off_axes(boxes)
    if inside:
        edge = shapely.Polygon(np.column_stack([named.rim.real, named.rim.imag]))
        good &= shapely.contains(edge, boxes)
    elif distance in _NEAR:
        good &= [_beside_its_own(named, others, complex(place)) for place in places]
    if inside or distance in _NEAR:
        return Placed(texts[int(np.argmax(good))]) if good.any() else None
    starts = [_edge(text, half, hole.middle) for text in texts]
    tips = [_tip(named, start) for start in starts]
    leaders = [_line(np.array(ends)) for ends in zip(starts, tips, strict=True)]
    good &= taken.free([leader.buffer(_AIR) for leader in leaders])
    if not good.any():
        return None
    crossed = taken.crossed(leaders)
    k = int(np.argmin(np.where(good, crossed, np.max(crossed) + 1)))
    return Placed(texts[k], starts[k], tips[k])


def _edge(text: Text, half: float, towards: complex) -> complex:
    """Where a leader leaves a text's box."""
    middle = text.at + 0.5j * HEIGHT
    way = (towards - middle) / abs(towards - middle)
    wide, tall = half + _AIR, HEIGHT / 2 + _AIR
    return middle + way * min(wide / max(abs(way.real), 1e-9), tall / max(abs(way.imag), 1e-9))


def _tip(named: Named, start: complex) -> complex:
    """Where a leader meets its hole: on a round one's edge, else on the nearest point of the outline."""
    hole = named.hole
    if hole.radius:
        return hole.middle - hole.radius * (hole.middle - start) / abs(hole.middle - start)
    return complex(named.rim[int(np.argmin(np.abs(named.rim - start)))])


def _beside_its_own(named: Named, others: Sequence[Named], place: complex) -> bool:
    """Whether a label at that place is nearer to its hole than to any other one: to its middle and to its edge."""
    edges = [float(np.min(np.abs(each.rim - place))) for each in (named, *others)]
    middles = [abs(each.hole.middle - place) for each in (named, *others)]
    return all(min(away[1:], default=math.inf) > away[0] for away in (edges, middles))
