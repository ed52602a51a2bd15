"""What a drawing says of contours in words: holes and their names, corners and roundings, radii; rows of its table."""

from __future__ import annotations

import cmath
import itertools
import math
from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass

from camgen.geometry.arcs import as_circle, fit_arcs
from camgen.geometry.outlines import Arc, Contour, Line, Piece, end_point, extent, start_point
from camgen.parts.part import Part
from camgen.tolerances import SAME_POINT

STACK = 8  # layers that are told one by one
_EDGES = 16  # rows that an outline may take in the table


@dataclass(frozen=True)
class Hole:
    """A row of the table: its place (complex mm) and what it is; a label fits at `middle`, or beside a round hole."""

    place: complex
    shape: str
    middle: complex
    radius: float = 0.0


def holes_of(contours: Sequence[Contour], points: Sequence[tuple[str, complex]] = ()) -> list[tuple[str, Hole]]:
    """Holes with their labels: the names of the points at which they are, mm, and numbers where there is none. Without points
    equal shapes share a letter, numbered where there are several."""
    holes = [hole_of(contour) for contour in contours]
    if points:
        names = [next((name for name, place in points if abs(hole.place - place) < SAME_POINT), "") for hole in holes]
        numbers = itertools.count(1)  # no name is one
        return [(name or str(next(numbers)), hole) for name, hole in zip(names, holes, strict=True)]
    shapes = list(dict.fromkeys(hole.shape for hole in holes))
    named: list[tuple[str, Hole]] = []
    for letter, shape in zip(_letters(), shapes, strict=False):
        same = [hole for hole in holes if hole.shape == shape]
        named += [(f"{letter}{i}" if len(same) > 1 else letter, hole) for i, hole in enumerate(same, 1)]
    return named


def _letters() -> itertools.chain[str]:
    alphabet = "ABCDEFGHJKLMNPQRSTUVWXYZ"  # no I, no O
    return itertools.chain(alphabet, (a + b for a in alphabet for b in alphabet))


def hole_of(contour: Contour) -> Hole:
    """What a hole is: a circle, an arc slot, a circle with a keyway or flat, or else the size of its box."""
    round_one = as_circle(contour)
    if round_one:
        centre, radius = round_one
        return Hole(centre, f"Ø{number(2 * radius)}", centre, radius)
    arcs = [piece for piece in contour.pieces if isinstance(piece, Arc)]
    if len(arcs) == len(contour.pieces) == 4 and abs(arcs[0].centre - arcs[2].centre) < 1e-9:
        outer, inner = sorted((arcs[0], arcs[2]), key=lambda arc: -arc.radius)
        radius, width = (outer.radius + inner.radius) / 2, outer.radius - inner.radius
        low, high = sorted((math.degrees(outer.t0), math.degrees(outer.t1)))
        turn = 360 * math.floor(low / 360)
        turn += 360 * (high - turn > 360)  # across Ox: from below it to above
        shape = f"slot {number(width)} on R{number(radius)}, {low - turn:.1f}° {'to' if low < turn else '-'} {high - turn:.1f}°"
        return Hole(outer.centre, shape, outer.centre + cmath.rect(radius, math.radians(low + high) / 2))
    lower, upper = extent([fit_arcs(contour, 0.01)])
    box = f"{number(upper.real - lower.real)} × {number(upper.imag - lower.imag)}"
    widest = max(arcs, key=lambda arc: abs(arc.sweep), default=None)
    if widest and abs(widest.sweep) > math.pi:
        shape = f"Ø{number(2 * widest.radius)}, {box} overall"
        return Hole(widest.centre, shape, widest.centre, widest.radius)
    return Hole((lower + upper) / 2, box, (lower + upper) / 2)


def number(value: float) -> str:
    """A length as on a drawing: at most three digits after the point, no idle zeros."""
    return f"{round(value, 3) + 0.0:.3f}".rstrip("0").rstrip(".")


def nearest_and_farthest(contour: Contour) -> tuple[complex, complex]:
    """Points of a contour of lines and arcs at the least and the greatest distance from the origin."""
    points: list[complex] = []
    for piece in contour.pieces:
        points += [start_point(piece), end_point(piece)]
        if isinstance(piece, Arc) and piece.centre != 0:
            towards = cmath.phase(piece.centre)
            for angle in (towards, towards + math.pi):
                along = (angle - piece.start) * math.copysign(1, piece.sweep) % (2 * math.pi)
                if along <= abs(piece.sweep):
                    points.append(piece.centre + cmath.rect(piece.radius, angle))
        elif not isinstance(piece, Arc):
            a, d = start_point(piece), end_point(piece) - start_point(piece)
            share = -(a * d.conjugate()).real / abs(d) ** 2
            points += [a + share * d] if 0 < share < 1 else []
    return min(points, key=abs), max(points, key=abs)


def free(contour: Contour) -> bool:
    """Whether a contour is no chain of lines and arcs, as a cam's."""
    return any(not isinstance(piece, Line | Arc) for piece in contour.pieces)


def layer_rows(
    part: Part, holes: Sequence[Hole], tolerance: float, told_as: Callable[[Hole], str]
) -> list[tuple[str, str, str, str]]:
    """Rows of the edges of every layer, and of holes that only it has; none for a plain circle or a tall stack.

    holes: those that are told already.
    """
    layers, known = part.layers, {(hole.place, hole.shape) for hole in holes}
    rows: list[tuple[str, str, str, str]] = []
    sloped = part.crossed is not None
    if len(layers) > STACK:
        for z0, z1 in dict.fromkeys((layer.z0, layer.z1) for layer in layers):
            outers = [fit_arcs(layer.region.outer, tolerance) for layer in layers if (layer.z0, layer.z1) == (z0, z1)]
            size = extent(outers)[1] - extent(outers)[0]
            overall = f"{number(size.real)} × {number(size.imag)} overall"
            rows.append(("", "", "", f"z {number(z0)} to {number(z1)}: {overall}"))
        return rows
    if len(layers) == 1 and as_circle(layers[0].region.outer):
        return []
    known_edges: dict[tuple[tuple[str, str, str], ...], str] = {}
    for layer in layers:
        edges, span = edge_rows(layer.region.outer, sloped), f"z {number(layer.z0)} to {number(layer.z1)}"
        same = known_edges.setdefault(tuple(edges), span)
        rows.append(("", "", "", f"Edges, {span}:" if same is span else f"Edges, {span}: as {same}"))
        rows += [("", *row) for row in edges if same is span]
        own = [hole_of(contour) for contour in layer.region.holes]
        rows += [("", number(h.place.real), number(h.place.imag), told_as(h)) for h in own if (h.place, h.shape) not in known]
    if part.crossed is not None:
        rows.append(("", "X", "Z", "Edges from above:"))
        rows += [("", *row) for contour in (part.crossed.outer, *part.crossed.holes) for row in edge_rows(contour, sloped)]
    return rows


def edge_rows(contour: Contour, sloped: bool = False) -> list[tuple[str, str, str]]:
    """X, Y and what is there, of an outline of lines and arcs: a rectangle, or else every rounding and every sharp corner.

    With these, and tangents between roundings, the outline can be drawn. sloped: tells the slope of each slanted edge too.
    """
    round_one = as_circle(contour)
    if round_one:
        return [(number(round_one[0].real), number(round_one[0].imag), f"Ø{number(2 * round_one[1])}, its edge")]
    if free(contour):
        return [("", "", "a curve: see the profile")]
    pieces = [piece for piece in contour.pieces if abs(start_point(piece) - end_point(piece)) > 1e-9]
    corners = [start_point(piece) for piece in pieces]
    lines = all(isinstance(piece, Line) for piece in pieces)
    if lines and len({round(z.real, 6) for z in corners}) == len({round(z.imag, 6) for z in corners}) == 2:
        low, high = extent([contour])
        size = f"{number(high.real - low.real)} × {number(high.imag - low.imag)}, its lower left corner"
        return [(number(low.real), number(low.imag), size)]
    rows, slopes = [], dict[int, str]()
    for before, piece in zip((pieces[-1], *pieces[:-1]), pieces, strict=True):
        place = start_point(piece)
        if abs(cmath.phase(_way(piece, piece.t0) / _way(before, before.t1))) > 1e-3:
            rows.append((number(place.real), number(place.imag), "corner"))
        if sloped and isinstance(piece, Line):
            slopes[len(rows) - 1] = _slope(piece)
        if isinstance(piece, Arc):
            kind = "" if piece.sweep > 0 else ", hollow"
            rows.append((number(piece.centre.real), number(piece.centre.imag), f"R{number(piece.radius)}{kind}"))
    for k, slope in slopes.items():
        rows[k] = (*rows[k][:2], rows[k][2] + slope)
    rows = _paired(dict.fromkeys(rows))
    return rows if len(rows) <= _EDGES else [("", "", f"{len(rows)} roundings and corners: see the profile")]


def _slope(line: Line) -> str:
    """Slope of an edge that follows, from the x axis; nothing of an upright or level one."""
    slope = math.degrees(cmath.phase(line.b - line.a)) % 180
    return "" if min(slope % 90, 90 - slope % 90) < 1e-6 else f", then at {slope if slope < 90 else slope - 180:.2f}°"


def _paired(rows: Collection[tuple[str, str, str]]) -> list[tuple[str, str, str]]:
    """Rows, two that lie on either side of the x axis as one with +-."""
    found: dict[tuple[str, str, str], None] = {}
    for x, y, what in rows:
        size = y.lstrip("-")
        both = size != "0" and (x, size, what) in rows and (x, f"-{size}", what) in rows
        found[x, f"±{size}" if both else y, what] = None
    return list(found)


def _way(piece: Piece, t: float) -> complex:
    return complex(piece.at(t, 1)) * (1 if piece.t1 > piece.t0 else -1)
