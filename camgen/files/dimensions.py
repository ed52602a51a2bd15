"""What a drawing says of contours in words: holes and their names, corners and roundings, radii; rows of its table."""

from __future__ import annotations

import cmath
import itertools
import math
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from camgen.geometry.arcs import as_circle, fit_arcs
from camgen.geometry.outlines import Arc, Contour, Line, Piece, end_point, extent, start_point
from camgen.parts.keyways import keyed
from camgen.parts.part import Part
from camgen.tolerances import SAME_POINT

STACK = 8  # layers that are told one by one
_EDGES = 16  # rows that an outline may take in the table
_BOSSES = 2  # whose diameters a view has
_STATIONS = 7  # points of a curve that are told
_ALIKE = 1e-9  # mm, by which distances that are one may differ


@dataclass(frozen=True)
class Hole:
    """A row of the table: its place (complex mm) and what it is; a label fits at `middle`, or beside a round hole.

    half: of one that is neither round nor a slot, half the sides of its box.
    """

    place: complex
    shape: str
    middle: complex
    radius: float = 0.0
    half: complex = 0j


@dataclass(frozen=True)
class Places:
    """How a table writes places: zero is where X and Y are 0, mm; digits: after the point."""

    zero: complex = 0j
    digits: int = 3

    def xy(self, place: complex) -> tuple[str, str]:
        """X and Y of a place, mm."""
        at = place - self.zero
        return number(at.real, self.digits), number(at.imag, self.digits)


_FROM_ORIGIN = Places()


def holes_of(
    contours: Sequence[Contour], points: Sequence[tuple[str, complex]] = ()
) -> list[tuple[str, Hole]]:
    """Holes with their labels: the names of the points at which they are, mm, and numbers where there is none. Without points
    equal shapes share a letter, numbered where there are several."""
    holes = [hole_of(contour) for contour in contours]
    if points:
        names = [
            next((name for name, place in points if abs(hole.place - place) < SAME_POINT), "")
            for hole in holes
        ]
        numbers = itertools.count(1)  # no name is one
        return [(name or str(next(numbers)), hole) for name, hole in zip(names, holes, strict=True)]
    shapes = list(dict.fromkeys(hole.shape for hole in holes))
    rows: list[tuple[str, Hole]] = []
    for letter, shape in zip(_letters(), shapes, strict=False):
        same = [hole for hole in holes if hole.shape == shape]
        rows += [
            (f"{letter}{i}" if len(same) > 1 else letter, hole) for i, hole in enumerate(same, 1)
        ]
    return rows


def standing_of(part: Part, labels: Collection[str]) -> dict[int, tuple[str, Hole]]:
    """Round layers that stand at points of the part whose names no hole has: by layer their name and what they are."""
    bosses: dict[int, tuple[str, Hole]] = {}
    for k, layer in enumerate(part.layers):
        disc = as_circle(layer.region.outer)
        names = [
            name
            for name, place in part.points
            if disc and name not in labels and abs(place - disc[0]) < SAME_POINT
        ]
        if disc and names and k != part.drawn_layer:
            bosses[k] = names[0], Hole(disc[0], f"Ø{number(2 * disc[1])}", *disc)
    return bosses


def bosses(part: Part) -> list[float]:
    """Radii, mm, of round layers about a cam's axis, which a view has; nothing of another part, or where they are many."""
    if not free(part.region.outer):
        return []
    discs = [as_circle(layer.region.outer) for layer in part.layers]
    radii = dict.fromkeys(disc[1] for disc in discs if disc and abs(disc[0]) < SAME_POINT)
    return list(radii) if len(radii) <= _BOSSES else []


def headed(part: Part) -> float | None:
    """Radius of the shank of a solid pin with a head at z = 0, mm, both of which a view along the axis shows; None of another part."""
    discs = [as_circle(layer.region.outer) for layer in part.layers]
    solid = not any(layer.region.holes for layer in part.layers)
    if len(discs) != 2 or not solid or part.layers[0].z0 > SAME_POINT:
        return None
    head, shank = discs
    if not head or not shank or abs(head[0]) + abs(shank[0]) > SAME_POINT or shank[1] > head[1]:
        return None
    return shank[1]


def flatted(contour: Contour) -> tuple[complex, float, list[Line]] | None:
    """Centre and radius, mm, of a round outline with flats, and the flats; None of any other."""
    arcs = [piece for piece in contour.pieces if isinstance(piece, Arc)]
    flats = [piece for piece in contour.pieces if isinstance(piece, Line)]
    if not (arcs and flats) or len(arcs) + len(flats) < len(contour.pieces) or keyed(contour):
        return None
    centre = arcs[0].centre
    radius = arcs[0].radius
    alike = all(
        abs(arc.centre - centre) + abs(arc.radius - radius) < SAME_POINT and arc.sweep > 0
        for arc in arcs
    )
    return (centre, radius, flats) if alike else None


def rod_of(contour: Contour) -> tuple[complex, float] | None:
    """Centre and radius, mm, of an outline that is round all over, but for a keyway or flats; None of any other."""
    flats = flatted(contour)
    key = keyed(contour)
    if flats or key:
        return flats[:2] if flats else (key.centre, key.radius) if key else None
    return as_circle(contour)


@dataclass(frozen=True)
class SlottedWheel:
    """A wheel about the origin with equal slots that are open at its rim and end round, and hollows between them; mm."""

    slots: tuple[complex, ...]  # middles of their round ends
    width: float
    rim: float  # radius
    hollows: tuple[Arc, ...]


def slotted_wheel(contour: Contour) -> SlottedWheel | None:
    """What such a wheel's edge consists of; None of any other contour."""
    pieces = contour.pieces
    around = zip([*pieces[-1:], *pieces[:-1]], pieces, [*pieces[1:], *pieces[:1]], strict=True)
    ends = [
        arc
        for before, arc, after in around
        if isinstance(arc, Arc) and isinstance(before, Line) and isinstance(after, Line)
        if abs(abs(arc.sweep) - math.pi) < _ALIKE
    ]
    arcs = [arc for arc in _arcs(contour) if arc not in ends]
    rims = {round(arc.radius, 6): arc.radius for arc in arcs if abs(arc.centre) < SAME_POINT}
    hollows = tuple(arc for arc in arcs if abs(arc.centre) >= SAME_POINT)
    alike = {(round(arc.radius, 6), round(abs(arc.centre), 6)) for arc in ends}
    if len(ends) < 3 or len(alike) != 1 or len(rims) != 1 or free(contour):
        return None
    if len({(round(arc.radius, 6), round(abs(arc.centre), 6)) for arc in hollows}) != 1:
        return None
    (rim,) = rims.values()
    return SlottedWheel(tuple(arc.centre for arc in ends), 2 * ends[0].radius, rim, hollows)


def lock_of(contour: Contour) -> tuple[Arc, list[complex]] | None:
    """Of a disc that locks a Geneva wheel its arc about the origin, and points of what relieves it, in order from the arc's end on,
    mm; None of any other contour."""
    reach = _reach(contour) - SAME_POINT
    arcs = [arc for arc in _arcs(contour) if abs(arc.centre) < SAME_POINT and arc.radius >= reach]
    if len(arcs) != 1 or not free(contour):  # a gear has many
        return None
    (widest,) = arcs
    k = contour.pieces.index(widest)
    points = list[complex]()
    for piece in (*contour.pieces[k + 1 :], *contour.pieces[:k]):
        count = 2 if isinstance(piece, Line) else _STATIONS
        along = np.linspace(piece.t0, piece.t1, count)
        points += np.atleast_1d(piece.at(along))[bool(points) :].tolist()
    return widest, points


def _reach(contour: Contour) -> float:
    """Greatest distance from the origin, mm."""
    return max(
        float(np.max(np.abs(piece.at(np.linspace(piece.t0, piece.t1, 33)))))
        for piece in contour.pieces
    )


def zero_of(part: Part, holes: Sequence[tuple[str, Hole]]) -> tuple[complex, str]:
    """Where X and Y of the table are 0, mm, and what is there: the part's origin where that can be touched, else a hole."""
    if free(part.region.outer):
        return 0j, ""
    centred = [label for label, hole in holes if hole.radius and abs(hole.place) < SAME_POINT]
    if centred:
        return 0j, f"the centre of hole {centred[0]}"
    circle = round_of(part.region.outer)
    if circle and abs(circle[0]) < SAME_POINT:
        return 0j, "the centre of the rim"
    for label, hole in holes:
        if hole.radius:
            return hole.place, f"the centre of hole {label}"
    low, high = extent([fit_arcs(part.region.outer, 0.01)])
    return (
        (0j, "")
        if low.real <= 0 <= high.real and low.imag <= 0 <= high.imag
        else (low, "the lower left corner of the box")
    )


def _letters() -> itertools.chain[str]:
    alphabet = "ABCDEFGHJKLMNPQRSTUVWXYZ"  # no I, no O
    return itertools.chain(alphabet, (a + b for a in alphabet for b in alphabet))


def hole_of(contour: Contour) -> Hole:
    """What a hole is: a circle, an arc slot, a straight one, a circle with a keyway or flat, or else the size of its box."""
    circle = as_circle(contour)
    if circle:
        centre, radius = circle
        return Hole(centre, f"Ø{number(2 * radius)}", centre, radius)
    arcs = _arcs(contour)
    if _is_arc_slot(contour):
        outer, inner = sorted((arcs[0], arcs[2]), key=lambda arc: -arc.radius)
        radius = (outer.radius + inner.radius) / 2
        width = outer.radius - inner.radius
        low, high = sorted((math.degrees(outer.t0), math.degrees(outer.t1)))
        turn = 360 * math.floor(low / 360)
        turn += 360 * (high - turn > 360)  # across Ox: from below it to above
        shape = f"slot {number(width)} on R{number(radius)}, {low - turn:z.1f}° {'to' if low < turn else '-'} {high - turn:z.1f}°"
        return Hole(
            outer.centre, shape, outer.centre + cmath.rect(radius, math.radians(low + high) / 2)
        )
    lower, upper = extent([fit_arcs(contour, 0.01)])
    if ends := _round_ends(contour):
        (a, b), radius = ends
        lean = math.degrees(cmath.phase(b - a)) % 180
        at = "" if min(lean, 180 - lean) < 1e-6 else f", at {lean:.4g}°"
        shape = f"slot {number(abs(b - a) + 2 * radius)} × {number(2 * radius)}{at}"
        return Hole((a + b) / 2, shape, (a + b) / 2, 0.0, (upper - lower) / 2)
    if key := keyed(contour):
        over = number(2 * key.radius + key.depth)
        size = f"Ø{number(2 * key.radius)}, keyway {number(key.width)}, {over} overall"
        return Hole(key.centre, size, key.centre, key.radius)
    box = f"{number(upper.real - lower.real)} × {number(upper.imag - lower.imag)}"
    if flat := flat_of(contour):
        hole = round_of(contour)
        assert hole is not None
        return Hole(
            hole[0], f"Ø{number(2 * hole[1])}, {number(flat[1])} over its flat", hole[0], hole[1]
        )
    if around := round_of(contour):
        centre, radius = around
        return Hole(centre, f"Ø{number(2 * radius)}, {box} overall", centre, radius)
    box = f"profile by DXF ({box})" if free(contour) else box
    return Hole((lower + upper) / 2, box, (lower + upper) / 2, 0.0, (upper - lower) / 2)


def round_of(contour: Contour) -> tuple[complex, float] | None:
    """Centre and radius, mm, of a circle, or of one with a keyway or flat; None of any other hole."""
    circle = as_circle(contour)
    if circle or _is_arc_slot(contour) or _round_ends(contour):
        return circle
    widest = max(_arcs(contour), key=lambda arc: abs(arc.sweep), default=None)
    return (widest.centre, widest.radius) if widest and abs(widest.sweep) > math.pi else None


def flat_of(contour: Contour) -> tuple[complex, float] | None:
    """Of a round hole with one flat the unit way from its centre to that, and the distance over it from the far side, mm."""
    flats = [piece for piece in contour.pieces if isinstance(piece, Line)]
    around = round_of(contour)
    if len(flats) != 1 or not around or len(_arcs(contour)) + 1 != len(contour.pieces):
        return None
    centre, radius = around
    (flat,) = flats
    along = (flat.b - flat.a) / abs(flat.b - flat.a)
    foot = flat.a - centre - ((flat.a - centre) * along.conjugate()).real * along
    return foot / abs(foot), radius + abs(foot)


def _arcs(contour: Contour) -> list[Arc]:
    return [piece for piece in contour.pieces if isinstance(piece, Arc)]


def _is_arc_slot(contour: Contour) -> bool:
    arcs = _arcs(contour)
    return len(arcs) == len(contour.pieces) == 4 and abs(arcs[0].centre - arcs[2].centre) < 1e-9


def _round_ends(contour: Contour) -> tuple[tuple[complex, complex], float] | None:
    """Centres and radius, mm, of the two equal half circles that end a straight slot; None of any other hole."""
    sweeps: dict[tuple[float, float, float], float] = {}
    for piece in contour.pieces:
        if isinstance(piece, Arc):
            key = round(piece.centre.real, 6), round(piece.centre.imag, 6), round(piece.radius, 6)
            sweeps[key] = sweeps.get(key, 0.0) + piece.sweep
    if len(sweeps) != 2 or any(abs(abs(sweep) - math.pi) > 1e-6 for sweep in sweeps.values()):
        return None
    (x0, y0, r0), (x1, y1, r1) = sweeps
    straight = all(isinstance(piece, Line | Arc) for piece in contour.pieces) and r0 == r1
    return ((complex(x0, y0), complex(x1, y1)), r0) if straight else None


def number(value: float, decimals: int = 3) -> str:
    """A length as on a drawing: at most so many digits after the point, a half away from zero, no idle zeros."""
    text = f"{value + math.copysign(_ALIKE, value):z.{decimals}f}"
    return text.rstrip("0").rstrip(".") if "." in text else text


def nearest_and_farthest(contour: Contour) -> tuple[complex, complex]:
    """Points of a contour of lines and arcs at the least and the greatest distance from the origin; of a dwell its middle."""
    points: list[complex] = []
    for piece in contour.pieces:
        points += [start_point(piece), end_point(piece)]
        if isinstance(piece, Arc) and abs(piece.centre) < _ALIKE:
            points.insert(0, piece.centre + cmath.rect(piece.radius, piece.start + piece.sweep / 2))
        elif isinstance(piece, Arc):
            towards = cmath.phase(piece.centre)
            for angle in (towards, towards + math.pi):
                along = (angle - piece.start) * math.copysign(1, piece.sweep) % (2 * math.pi)
                if along <= abs(piece.sweep):
                    points.append(piece.centre + cmath.rect(piece.radius, angle))
        else:
            a = start_point(piece)
            d = end_point(piece) - start_point(piece)
            t = -(a * d.conjugate()).real / abs(d) ** 2
            points += [a + t * d] if 0 < t < 1 else []
    away = [round(abs(point) / _ALIKE) for point in points]  # no rounding picks a place
    return points[away.index(min(away))], points[away.index(max(away))]


def free(contour: Contour) -> bool:
    """Whether a contour is no chain of lines and arcs, as a cam's."""
    return any(not isinstance(piece, Line | Arc) for piece in contour.pieces)


def hollow_radius(contour: Contour, inside: bool = False) -> float:
    """Smallest radius of curvature where a contour of a part is hollow, mm: no larger wheel grinds it; inf where it is nowhere.

    inside: of a hole, whose material is round it. Curvature is that of the exact pieces, at the ends of 2000 steps of each.
    """
    sense = math.copysign(1, contour.area) * (1 if inside else -1)
    sharpest = 0.0
    for piece in contour.pieces:
        if isinstance(piece, Line):
            continue
        t = np.linspace(piece.t0, piece.t1, 2001)
        slope = piece.at(t, 1)
        turn = (slope.conj() * piece.at(t, 2)).imag * math.copysign(1, piece.t1 - piece.t0)
        sharpest = max(sharpest, float(np.max(sense * turn / np.abs(slope) ** 3)))
    return 1 / sharpest if sharpest > 0 else math.inf


def layer_rows(
    part: Part,
    holes: Sequence[Hole],
    tolerance: float,
    shape_of: Callable[[Hole], str],
    places: Places,
    names: Mapping[int, str],
) -> list[tuple[str, str, str, str]]:
    """Rows of the edges of every layer, and of holes that only it has; none for a plain circle or a tall stack.

    holes: those that are told already; shape_of: what a hole or a round layer is; places: how X and Y are written; names: of layers that have
    one.
    """
    layers = part.layers
    hole_keys = {(hole.place, hole.shape) for hole in holes}
    rows: list[tuple[str, str, str, str]] = []
    sloped = part.side_profile is not None
    if len(layers) > STACK:
        for z0, z1 in dict.fromkeys((layer.z0, layer.z1) for layer in layers):
            outers = [
                fit_arcs(layer.region.outer, tolerance)
                for layer in layers
                if (layer.z0, layer.z1) == (z0, z1)
            ]
            size = extent(outers)[1] - extent(outers)[0]
            overall = f"{number(size.real)} × {number(size.imag)} overall"
            rows.append(("", "", "", f"z {number(z0)} to {number(z1)}: {overall}"))
        return rows
    if headed(part) or (len(layers) == 1 and as_circle(layers[0].region.outer)):
        return []
    in_view = bosses(part)
    spans: dict[tuple[tuple[str, str, str], ...], str] = {}
    alike = len({layer.region.outer for layer in layers}) == 1  # whose holes alone differ
    for k, layer in enumerate(layers):
        outer = layer.region.outer
        height = span = f"z {number(layer.z0)} to {number(layer.z1)}"
        if alike:
            span = f"z {number(layers[0].z0)} to {number(layers[-1].z1)}"
        disc = None if sloped else as_circle(outer)
        # its diameter or all of its sizes are in the view, or the notes say which file has it
        shown = disc and abs(disc[0]) < SAME_POINT and disc[1] in in_view
        slotted = not disc and len(layers) == 1 and slotted_wheel(layer.region.outer)
        noted = free(outer) and part.outlined and layer is part.drawn
        if not (shown or slotted or noted or (alike and k)):
            edges = [] if disc or free(outer) else edge_rows(outer, sloped, _source(part), places)
            same = spans.setdefault(tuple(edges), span) if edges else span
            where = ("", "", "")
            if disc:
                where = names.get(k, ""), *places.xy(disc[0])
                round_ = shape_of(Hole(disc[0], f"Ø{number(2 * disc[1])}", *disc))
                said = f"{round_}, {span}"
            elif free(outer):
                said = f"Profile by {_source(part)}, {span}"
            else:
                said = f"Edges, {span}:" if same is span else f"Edges, {span}: as {same}"
            rows.append((*where, said))
            rows += [("", *row) for row in edges if same is span]
        own = [
            hole
            for hole in map(hole_of, layer.region.holes)
            if (hole.place, hole.shape) not in hole_keys
        ]
        deep = f", {height}" if alike and len(layers) > 1 else ""
        rows += [("", *places.xy(hole.place), shape_of(hole) + deep) for hole in own]
    if part.side_profile is not None:
        rows.append(("", "X", "Z", "Edges from above:"))
        above = (part.side_profile.outer, *part.side_profile.holes)
        along = replace(places, zero=complex(places.zero.real))
        rows += [
            ("", *row) for contour in above for row in edge_rows(contour, sloped, places=along)
        ]
    return rows


def _source(part: Part) -> str:
    """Kind of the file that has the outlines of all of its layers."""
    return "STL" if part.stacked else "DXF"


def edge_rows(
    contour: Contour, sloped: bool = False, source: str = "DXF", places: Places = _FROM_ORIGIN
) -> list[tuple[str, str, str]]:
    """X, Y and what is there, of an outline of lines and arcs: a rectangle, or else every rounding and every sharp corner.

    With these, and tangents between roundings, the outline can be drawn. sloped: tells the slope of each slanted edge too; source: kind of the
    file that has what is too much for a table; places: how X and Y are written.
    """
    circle = as_circle(contour)
    if circle:
        return [
            (
                *places.xy(circle[0]),
                f"Ø{number(2 * circle[1])}, its edge",
            )
        ]
    if shaft := flatted(contour):
        centre, radius, flats = shaft
        rows = [(*places.xy(centre), f"Ø{number(2 * radius)}, round")]
        for flat in flats:
            way = (
                (flat.b - flat.a) / abs(flat.b - flat.a) * -1j
            )  # outwards, for the outline runs counter-clockwise
            foot = centre + ((flat.a - centre) * way.conjugate()).real * way
            deep = f"flat, {number(radius - abs(foot - centre))} deep, at {math.degrees(cmath.phase(way)):z.4g}°"
            rows.append((*places.xy(foot), deep))
        return rows
    if free(contour):
        return [("", "", f"a curve by {source}")]
    pieces = [
        piece for piece in contour.pieces if abs(start_point(piece) - end_point(piece)) > _ALIKE
    ]
    corners = [start_point(piece) for piece in pieces]
    lines = all(isinstance(piece, Line) for piece in pieces)
    if (
        lines
        and len({round(z.real, 6) for z in corners})
        == len({round(z.imag, 6) for z in corners})
        == 2
    ):
        low, high = extent([contour])
        size = f"{number(high.real - low.real)} × {number(high.imag - low.imag)}, its lower left corner"
        return [(*places.xy(low), size)]
    rows = []
    slopes = dict[int, str]()
    for piece, (place, turn) in zip(pieces, turns(contour), strict=True):
        if abs(turn) > 1e-3:
            rows.append((*places.xy(place), "corner"))
        if sloped and isinstance(piece, Line):
            slopes[len(rows) - 1] = _slope(piece)
        if isinstance(piece, Arc):
            kind = "" if piece.sweep > 0 else ", hollow"
            rows.append(
                (
                    *places.xy(piece.centre),
                    f"R{number(piece.radius)}{kind}",
                )
            )
    for k, slope in slopes.items():
        rows[k] = (*rows[k][:2], rows[k][2] + slope)
    rows = _paired(dict.fromkeys(rows))
    return (
        rows
        if len(rows) <= _EDGES
        else [("", "", f"{len(rows)} roundings and corners: by {source}")]
    )


def _slope(line: Line) -> str:
    """Slope of an edge that follows, from the x axis; nothing of an upright or level one."""
    slope = math.degrees(cmath.phase(line.b - line.a)) % 180
    return (
        ""
        if min(slope % 90, 90 - slope % 90) < 1e-6
        else f", then at {slope if slope < 90 else slope - 180:.2f}°"
    )


def _paired(rows: Collection[tuple[str, str, str]]) -> list[tuple[str, str, str]]:
    """Rows, two that lie on either side of the x axis as one with +-."""
    pairs: dict[tuple[str, str, str], None] = {}
    for x, y, what in rows:
        size = y.lstrip("-")
        both = size != "0" and (x, size, what) in rows and (x, f"-{size}", what) in rows
        pairs[x, f"±{size}" if both else y, what] = None
    return list(pairs)


def turns(contour: Contour) -> list[tuple[complex, float]]:
    """Start of every piece of a contour that ends elsewhere, and by how much the contour turns there at once, rad."""
    pieces = [each for each in contour.pieces if abs(start_point(each) - end_point(each)) > _ALIKE]
    return [
        (start_point(piece), cmath.phase(_way(piece, piece.t0) / _way(before, before.t1)))
        for before, piece in zip([*pieces[-1:], *pieces[:-1]], pieces, strict=True)
    ]


def _way(piece: Piece, t: float) -> complex:
    return complex(piece.at(t, 1)) * (1 if piece.t1 > piece.t0 else -1)
