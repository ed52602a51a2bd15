"""Letters and texts engraved in parts: shallow pockets in the face that a drawing shows, clear of holes and edges.

Glyphs are those of DejaVu Sans Bold, which comes with matplotlib: the same on every system. UP has plain ones of its own.
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from functools import cache
from itertools import combinations
from pathlib import Path
from typing import Any

import numpy as np

from camgen.errors import DesignError
from camgen.geometry.facets import facet_contour
from camgen.geometry.outlines import Contour, Points, Region, polygon
from camgen.machine.features import Feature
from camgen.numerics import coordinates
from camgen.parts.part import HoldingNote, Layer, Part
from camgen.parts.standing import discs
from camgen.parts.turning_over import fit_turned_over
from camgen.tolerances import SAME_POINT

DEPTH = 0.4  # mm, of letters: two usual layers of a print
_EDGE = 0.8  # mm, from letters to holes and edges
_COARSE = 0.02  # mm, by which facets lie off the outlines between which letters are placed
_FINE = 0.01  # mm, by which a glyph's chords may lie off its curves
_LETTERS = (5.0, 4.0, 3.0)  # mm, heights that are tried for the name of a hole
_TEXTS = (10.0, 8.0, 6.0, 5.0, 4.0, 3.0)  # and for a text
_EM = 100.0  # size at which glyphs are drawn before they are scaled
_CAPITAL = 0.729  # of it, height of a capital letter
_TURNS = 24  # directions from a hole in which its letter is tried
_AWAY = (0.0, 1.0, 2.0, 4.0, 6.0)  # mm, further from its hole than it must be

UP = "UP"  # on the upper side of what fits turned over as well
_LETTER_U = ((0, 73), (0, 0), (60, 0), (60, 73), (42, 73), (42, 18), (18, 18), (18, 73))
_LETTER_P = ((80, 0), (98, 0), (98, 25), (140, 25), (140, 73), (80, 73))
_EYE_OF_P = ((98, 41), (122, 41), (122, 57), (98, 57))


def engraved(part: Part, letters: bool, text: str = "", key: str = "") -> Part:
    """The part with a text of a person, and the letters of its holes by the names of its points.

    key: of the text. DesignError where it has no room; letters that have none are named in a note. A part that is thinner than
    three times the depth has no letters.
    """
    face = part.drawn
    thick = face.z1 - face.z0
    if text and thick < 3 * DEPTH:
        remedy = f"{key} needs a thicker part"
        raise DesignError(f"thickness of {part.name}", thick, 3 * DEPTH, "mm", remedy=remedy)
    if not (letters or text) or thick < 3 * DEPTH or part.side_profile is not None:
        return part
    free = _Face(_free(part))
    if text and not free.take(_along(part, text)):
        remedy = f"shorten {key}, or make the part wider"
        quantity = f"texts without room on {part.name}, {_TEXTS[-1]:g} mm high"
        raise DesignError(quantity, 1, 0, "", remedy=remedy)
    named = _named_holes(part) if letters else []
    left = [name for name, at, radius in named if not free.take(_beside(name, at, radius))]
    layers = tuple(
        Layer(region, face.z1 - DEPTH, face.z1) for each in free.taken for region in _regions(each)
    )
    notes = [f"no room to engrave {', '.join(left)}"] if left else []
    lettered = frozenset(name for name, *_ in named if name not in left)
    return replace(
        part,
        engraved=(*part.engraved, *layers),
        notes=(*part.notes, *notes),
        lettered=lettered or part.lettered,
    )


def with_upper_side(part: Part, mark: bool) -> Part:
    """The part, which fits turned over as well, with UP engraved on its upper side if it has room, else with a note that orders a mark
    there, which its drawing shows.

    mark: whether it may be engraved.
    """
    face = part.drawn
    if mark and face.z1 - face.z0 >= 3 * DEPTH:
        free = _Face(_free(part))
        centre, radius = next(
            (disc for hole in part.region.holes for disc in discs(hole)), (0j, 0.0)
        )
        if free.take(_beside(UP, centre, radius)):
            layers = [Layer(region, face.z1 - DEPTH, face.z1) for region in _regions(free.taken[0])]
            note = HoldingNote("UP on its upper side")
            return replace(part, engraved=(*part.engraved, *layers), notes=(*part.notes, note))
    note = HoldingNote(
        "mark it UP where its drawing has that; turned over it fits too, and moves wrongly"
    )
    return replace(part, notes=(*part.notes, note), to_mark=True)


def with_upper_sides(parts: Sequence[Part], features: Sequence[Feature]) -> list[Part]:
    """Parts of which those that fit turned over as well, and move wrongly then, say which side is up."""
    reversible = set(fit_turned_over(parts, features))
    return [with_upper_side(part, False) if part.name in reversible else part for part in parts]


@dataclass
class _Face:
    """What of a face is free (shapely), and the inscriptions that are taken."""

    free: Any
    taken: list[_Inscription] = field(default_factory=list)

    def take(self, tries: Iterable[_Inscription]) -> bool:
        """Whether one of several inscriptions has room; the first is taken."""
        first = next((each for each in tries if self.free.contains(each.box)), None)
        if first is None:
            return False
        self.taken.append(first)
        self.free = self.free.difference(first.box.buffer(_EDGE))
        return True


@dataclass(frozen=True)
class _Inscription:
    """A text on a face: its middle, mm, the height of its capitals, mm, and the direction in which it is read."""

    text: str
    middle: complex
    height: float
    direction: complex = 1 + 0j

    @property
    def box(self) -> Any:
        """What it takes, as a polygon of shapely."""
        import shapely

        _, (low, high) = _glyphs(self.text)
        scale = self.height / (_CAPITAL * _EM)
        half = (high - low) / 2 * scale
        corners = np.array([-half.real - 1j * half.imag, half.real - 1j * half.imag])
        ring = self.middle + self.direction * np.concatenate([corners, -corners])
        return shapely.Polygon(coordinates(ring))

    def placed(self, points: Points) -> Points:
        """Points of its glyphs where it stands, to a ten-thousandth of a millimetre."""
        _, (low, high) = _glyphs(self.text)
        scale = self.height / (_CAPITAL * _EM)
        z = self.middle + self.direction * scale * (points - (low + high) / 2)
        return np.round(z, 4) + 0.0


def _regions(inscription: _Inscription) -> list[Region]:
    """Its glyphs' regions, outer contours and the islands in them."""
    shapes, _ = _glyphs(inscription.text)
    scale = inscription.height / (_CAPITAL * _EM)
    regions = []
    for shape in shapes:
        rough = shape.simplify(_FINE / scale)
        rings = [np.asarray(ring.coords)[:-1] for ring in (rough.exterior, *rough.interiors)]
        outer, *holes = (
            polygon(inscription.placed(ring[:, 0] + 1j * ring[:, 1]).tolist()) for ring in rings
        )
        regions.append(
            Region(outer.counter_clockwise(), tuple(hole.counter_clockwise() for hole in holes))
        )
    return regions


@cache
def _glyphs(text: str) -> tuple[Sequence[Any], tuple[complex, complex]]:
    """Polygons (shapely) of a text's glyphs at the size _EM, and the corners of the box round them."""
    import shapely

    if text == UP:
        return [shapely.Polygon(_LETTER_U), shapely.Polygon(_LETTER_P, [_EYE_OF_P])], (
            0j,
            140 + 73j,
        )
    import matplotlib
    from matplotlib.font_manager import FontProperties
    from matplotlib.textpath import TextPath

    font = Path(matplotlib.get_data_path()) / "fonts" / "ttf" / "DejaVuSans-Bold.ttf"
    path = TextPath((0, 0), text, size=_EM, prop=FontProperties(fname=str(font)))
    corners = map(np.asarray, path.to_polygons())
    rings = [shapely.Polygon(ring) for ring in corners if len(ring) > 3]
    whole = shapely.Polygon()
    for ring in sorted(rings, key=lambda each: -each.area):
        whole = whole.symmetric_difference(ring)  # a ring in another one is an island
    shapes = [each for each in getattr(whole, "geoms", [whole]) if each.area > 0]
    left, bottom, right, top = whole.bounds
    shapes.sort(key=lambda each: each.bounds)
    return shapes, (complex(left, bottom), complex(right, top))


def _free(part: Part) -> Any:
    """What of the face is free for letters: no hole, no edge, no other layer over it."""
    face = part.drawn
    free = _shape(part.region)
    for layer in part.layers:
        if layer.z1 > face.z1 + SAME_POINT:
            free = free.difference(_shape(Region(layer.region.outer)))
    for layer in part.engraved:
        free = free.difference(_shape(Region(layer.region.outer)))
    return free.buffer(-_EDGE)


def _shape(region: Region) -> Any:
    """A region as a polygon of shapely."""
    import shapely

    def corners(contour: Contour) -> Any:
        ring = facet_contour(contour, _COARSE)
        return coordinates(ring)

    return shapely.Polygon(corners(region.outer), [corners(hole) for hole in region.holes])


def _named_holes(part: Part) -> list[tuple[str, complex, float]]:
    """Round holes at points of the part: name, centre and radius."""
    return [
        (name, centre, radius)
        for hole in part.region.holes
        for centre, radius in discs(hole)
        for name, point in part.points
        if abs(point - centre) < SAME_POINT
    ]


def _beside(name: str, centre: complex, radius: float) -> Iterator[_Inscription]:
    """Where the name of a hole may stand: as large and as near to it as can be."""
    for height in _LETTERS:
        for more in _AWAY:
            for k in range(_TURNS):
                way = cmath.exp(2j * math.pi * k / _TURNS)
                yield _Inscription(
                    name, centre + (radius + _EDGE + height / 2 + more) * way, height
                )


def _along(part: Part, text: str) -> Iterator[_Inscription]:
    """Where a text may stand: along the line between two points of the part, or across its middle."""
    outline = facet_contour(part.region.outer, _COARSE)
    corners = (
        outline.real.min() + 1j * outline.imag.min(),
        outline.real.max() + 1j * outline.imag.max(),
    )
    pairs = sorted(
        combinations([z for _, z in part.points], 2), key=lambda two: -abs(two[1] - two[0])
    )
    lines = [
        *pairs,
        (
            corners[0].real + 1j * sum(corners).imag / 2,
            corners[1].real + 1j * sum(corners).imag / 2,
        ),
    ]
    for height in _TEXTS:
        for a, b in lines:
            if abs(b - a) < SAME_POINT:
                continue
            way = (b - a) / abs(b - a)
            way = way if (round(way.real, 9), way.imag) > (0, 0) else -way
            for across in (0.0, 0.25, -0.25, 0.5, -0.5, 1.0, -1.0, 2.0, -2.0):
                for share in (0.5, 0.4, 0.6, 0.3, 0.7):
                    middle = a + share * (b - a) + 1j * way * across * height
                    yield _Inscription(text, complex(middle), height, complex(way))
