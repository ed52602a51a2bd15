"""A machine as its arrangement drawing shows it: what of its copies is seen from the front, and what a section cuts.

The front is seen along z, what lies behind other parts left out. The section is cut square to the front along a line and seen so
that heights z go upwards. Nothing here knows a mechanism or a sheet.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

from camgen.files.assembly_list import Item
from camgen.files.exploded_view import Coming, Prism, filled
from camgen.geometry.mesh import Mesh

_HEIGHT_DIGITS = 4  # in which faces that have one height agree
_FACE = 0.5  # mm, from which on a level face has its height beside the section
_PLAY = 0.35  # mm, up to which faces that lie over each other have one height
_DEEP = 20.0  # mm, that others may be broad before a face as it is seen from beside the section
_SEEN = 3.0  # mm^2 of paper, from which on a part is pointed at in a view
_DEEPER = 8.0  # mm of paper, by which a part may lie deeper in the front and be pointed at there
_SLIVER = 0.01  # mm^2, up to which a piece counts as hidden
MITE = 1e-4  # mm: what is left of an edge that is hidden


@dataclass(frozen=True)
class Copy:
    """A copy of a part where it stands, mm of the machine.

    faces: polygons as seen along z, each with the height of its upper side; cut: polygon of what the section meets, along the line and z.
    """

    number: int
    faces: Sequence[tuple[Any, float]]
    cut: Any
    hatched: bool
    span: tuple[float, float] = (0.0, 0.0)  # from its lowest point to its highest
    bought: bool = False  # what is no part, and lies in the holes of parts
    short: bool = False  # whether nothing says how long it is, such as a motor's body
    prisms: Sequence[Prism] = ()  # which it consists of, nearly
    solid: Mesh | None = None  # where prisms do not show it well
    coming: Coming = Coming()


@dataclass(frozen=True)
class Axis:
    """An axis that stands: where, mm, and its name in the spec."""

    at: complex
    name: str


class Level(NamedTuple):
    """A level face that the section cuts: its height, and where on the line it ends, mm."""

    height: float
    end: float


@dataclass(frozen=True)
class Arrangement:
    """A machine as its sheet shows it."""

    copies: Sequence[Copy]
    items: Sequence[Item]
    line: tuple[
        complex, complex
    ]  # of the section: a point, and its unit direction, from which the cut's places count
    axes: Sequence[Axis]
    notes: Sequence[str]
    bearings: Sequence[
        float
    ] = ()  # heights of the middles of a shaft's bearings, from the lowest up
    balls: Sequence[tuple[complex, float]] = ()  # of bearings in the section: middle, and radius
    letter: str = "A"  # of the section
    # unit direction in which the section's line comes to its point, where it bends there; what is left of it is turned into its plane
    bend: complex | None = None

    def place(self, at: complex) -> float | None:
        """Where on the section's line a point lies, mm; None where it is beside it."""
        origin, along = self.line
        for way, sign in ((along, 1), (self.bend or along, -1)):
            local = (at - origin) / way
            if abs(local.imag) < MITE and local.real * sign > -MITE:
                return local.real
        return None

    @cached_property
    def seen(self) -> list[tuple[int, Any, Any]]:
        """Number, visible polygon and visible edges of each face, from the highest down."""
        import shapely

        faces = [(top, copy.number, face) for copy in self.copies for face, top in copy.faces]
        above = shapely.Polygon()
        seen = []
        levels = sorted({top for top, _, _ in faces}, reverse=True)
        for level in levels:
            here = [(number, face) for top, number, face in faces if top == level]
            for number, face in here:
                edges = face.boundary.difference(above.buffer(MITE))
                seen.append((number, face.difference(above), edges))
            above = shapely.union_all([above, *(face for _, face in here)])
        return seen

    @cached_property
    def box(self) -> tuple[complex, complex]:
        """Corners of the front, mm."""
        import shapely

        x0, y0, x1, y1 = shapely.total_bounds([face for _, face, _ in self.seen])
        return complex(x0, y0), complex(x1, y1)

    @cached_property
    def deep(self) -> tuple[complex, complex]:
        """Corners of the section, along the line and z, mm."""
        import shapely

        s0, z0, s1, z1 = shapely.total_bounds([copy.cut for copy in self.copies])
        return complex(s0, z0), complex(s1, z1)

    def levels(self, most: int) -> list[Level]:
        """So many level faces of parts that the section cuts, from the highest down: the highest, the lowest and the broadest; of faces
        with no more than play between them the broadest, and none that lies deep in others as it is seen from the right."""
        import shapely

        edges = [
            np.column_stack([z[:-1], z[1:]])
            for copy in self.copies
            if not copy.bought
            for ring in shapely.get_rings(shapely.get_parts(copy.cut))
            for z in [shapely.get_coordinates(ring)]
        ]
        a, low, b, high = np.concatenate([np.zeros((0, 4)), *edges]).T
        level = (abs(high - low) < MITE) & (abs(b - a) > _FACE)
        heights = np.round(low, _HEIGHT_DIGITS)
        whole = shapely.union_all([copy.cut for copy in self.copies])
        far = self.deep[1].real
        groups: list[list[tuple[float, Level]]] = []
        for z in np.unique(heights[level])[::-1].tolist():
            own = level & (heights == z)
            end = float(np.maximum(a, b)[own].max())
            sight = shapely.LineString([(end, z), (far + 1, z)])
            if sight.intersection(whole.buffer(-MITE)).length > _DEEP:
                continue
            if not groups or groups[-1][0][1].height - z > _PLAY:
                groups.append([])
            groups[-1].append((float(abs(b - a)[own].sum()), Level(z, end)))
        broadest = [max(group, key=lambda face: face[0]) for group in groups]
        inner = sorted(broadest[1:-1], key=lambda face: -face[0])[: max(most - 2, 0)]
        kept = [*broadest[:1], *inner, *broadest[1:][-1:]]
        return sorted((face for _, face in kept), reverse=True)

    def shown(self, front: float, section: float) -> tuple[dict[int, Any], dict[int, Any]]:
        """Of each number what of its part is pointed at in the front, and of others in the section, as far as these show them: where
        both do, in the one in which it lies less deep inside by some mm of paper. front, section: their scales."""
        ahead, cut = self._pieces
        seen = {number for number, (area, _) in ahead.items() if area >= _SEEN / front**2}
        edges = [filled(faces).boundary for faces in self.outlines]
        for number in seen & cut.keys():
            deep = front * edges[0].distance(ahead[number][1])
            if deep > section * edges[1].distance(cut[number][1]) + _DEEPER:
                seen.remove(number)
        below = cut.keys() - seen
        rest = ahead.keys() - seen - below
        shown = {number: ahead[number][1] for number in seen | rest} | self.hidden
        return dict(sorted(shown.items())), {number: cut[number][1] for number in sorted(below)}

    @property
    def outlines(self) -> tuple[list[Any], list[Any]]:
        """What makes up the front, and the section."""
        return (
            [face for copy in self.copies for face, _ in copy.faces],
            [copy.cut for copy in self.copies],
        )

    @cached_property
    def _pieces(self) -> tuple[dict[int, tuple[float, Any]], dict[int, tuple[float, Any]]]:
        """Of each number the area of its largest piece and all pieces in the front, and in the section without what lies in holes."""
        import shapely

        things = [copy.cut for copy in self.copies if copy.bought]
        filled = shapely.union_all([shapely.Polygon(), *things])
        cuts = (
            (copy.number, copy.cut if copy.bought else copy.cut.difference(filled))
            for copy in self.copies
        )
        return _pieces((number, face) for number, face, _ in self.seen), _pieces(cuts)

    @cached_property
    def hidden(self) -> dict[int, Any]:
        """Of each number that neither view shows the highest face, which is drawn dashed."""
        front, cut = self._pieces
        shown = front.keys() | cut.keys()
        faces = [(top, copy.number, face) for copy in self.copies for face, top in copy.faces]
        highest = sorted(faces, key=lambda each: each[0])
        return {number: face for _, number, face in highest if number not in shown}


def _pieces(faces: Iterable[tuple[int, Any]]) -> dict[int, tuple[float, Any]]:
    """Of each number the area of its largest piece, and all of them, without what rounding leaves along an edge."""
    import shapely

    pieces: dict[int, list[Any]] = {}
    for number, face in faces:
        own = [each for each in shapely.get_parts(face) if each.area > _SLIVER]
        if own:
            pieces.setdefault(number, []).extend(own)
    return {
        number: (max(each.area for each in own), shapely.union_all(own))
        for number, own in pieces.items()
    }
