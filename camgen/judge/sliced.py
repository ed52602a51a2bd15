"""G-code of a plate, judged: each part on it found, and what is laid of it, layer by layer, in the part's own frame.

    body      walls that lie over each other: one part, of one piece or of several
    known     a solid as it was sent to the printer, on the side on which it lies
    copy      a body that is known: where it lies, and its layers

A body is known by its height, its area and its outlines half way up, laid on each other as rigid bodies are.
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from camgen.errors import counted
from camgen.findings import Finding, Where, at_most
from camgen.geometry.mesh import Mesh, components, slice_mesh
from camgen.geometry.registration import Registration, dense, deviation, lay
from camgen.geometry.rings import Floats, Points, Ring, Shape
from camgen.judge.round_trip import pieces_of
from camgen.numerics import coordinates

if TYPE_CHECKING:
    from camgen.files.gcode import Wall

_GAP = 1.5  # of its own height, by which a layer may lie over the one below it
_ON_BED = 1.0  # mm, higher than any first layer
_COARSE = 0.1  # mm, to which walls are taken where only their place counts
_AT_ONCE = 500  # walls of which it is looked at once which others they meet
_MOST_MET = 30_000_000  # pairs of walls that meet; ten bodies of 300 layers with five walls each have 20 million
# mm, between points of edges that are laid on each other, and of those that they are measured from
_STEP = 0.2
_FINE = 0.02
_THIN = 5  # of these points one is looked at where a turn is only to be thought of
# points that are laid on others: to find the turn, and to measure it
_FEW = 150
_MANY = 3000
_STARTS = 24  # turns from which outlines are laid on each other where the plate's own do not serve
_ALIKE = 0.15  # mm rms: a body that lies so near to a solid is its print
_NO_OTHER = 0.6  # mm rms: what is farther off is another part
_AREA = 0.1  # share by which the area of a layer may differ
_FLAT = 1e-6  # sine of the angle by which a part that lies flat may lean
_CHORDS = 1e-4  # mm, of outlines that are joined
_SAME = 1e-3  # mm, by which heights may differ that are the same
_HEIGHTS = (0.1, 0.3, 0.5, 0.7, 0.9)  # of a solid's, at which it is compared with another
_SAME_VOLUME = 1e-4  # share by which volumes of the same solid may differ
_SAME_EDGE = 0.05  # mm, by which edges of the same solid may differ, for facets begin elsewhere
_SLIVER = 1e-4  # mm^2, what facets leave of a hole


@dataclass(frozen=True)
class PrintModel:
    """A part's solid in its own frame as it was sent, the rotation (3, 3) that lays it on the bed, and the turns about the
    vertical, rad, in which its copies lie on the folder's own plates."""

    part: str
    solid: Mesh
    turn: Floats
    turns: tuple[float, ...] = ()

    @property
    def over(self) -> bool | None:
        """Whether it lies turned over; None where it lies on a side."""
        up = float(self.turn[2, 2])
        return None if abs(abs(up) - 1) > _FLAT else up < 0

    @property
    def lying(self) -> Mesh:
        """The solid as it lies on the bed, at z = 0."""
        vertices = self.solid.vertices @ self.turn.T
        vertices[:, 2] -= vertices[:, 2].min()
        return Mesh(vertices, self.solid.faces)


@dataclass(frozen=True)
class Layer:
    """What is laid between two heights over the bed, or over the raft."""

    low: float  # mm
    top: float  # mm
    walls: tuple[Wall, ...]
    holes: tuple[bool, ...]  # whether each wall is that of a hole

    @property
    def middle(self) -> float:
        """The height at which slicers cut a solid for it, mm over the bed."""
        return (self.low + self.top) / 2

    def edges(self, further: tuple[float, float] = (0.0, 0.0)) -> list[Ring]:
        """Edges of what is laid; further: how much outwards of an outline and inwards of a hole, mm."""
        pairs = zip(self.walls, self.holes, strict=True)
        return [
            edge for wall, hole in pairs if (edge := wall.edge(hole, further[hole])) is not None
        ]


@dataclass(frozen=True)
class Copy:
    """A body that is the print of a part: bed = exp(i turn) * lying + place; off: rms mm of its outline half way up."""

    known: PrintModel
    laid: Registration
    layers: tuple[Layer, ...]

    def inside(self, ring: Ring, shrinkage: float = 0.0) -> Ring:
        """A ring of the bed in the part's own frame; shrinkage: share by which it still shrinks about the part's origin."""
        turn = cmath.exp(-1j * self.laid.turn)
        lying = ring.moved(turn, -turn * self.laid.shift)
        return lying.moved(-1 if self.known.over else 1, mirror=bool(self.known.over)).moved(
            1 - shrinkage
        )

    def height(self, layer: Layer) -> float:
        """The middle of a layer in the part's own frame, mm."""
        z = self.known.solid.vertices[:, 2]
        return float(z.max() - layer.middle if self.known.over else z.min() + layer.middle)

    def complete(self, where: Where) -> list[Finding]:
        """Whether its layers lie on each other without a gap, and reach up to the top of the solid."""
        part = self.known.part
        tops = [0.0, *(layer.top for layer in self.layers)]
        gaps = [(layer.low - top, top) for top, layer in zip(tops, self.layers, strict=False)]
        gap, under = max(gaps)
        count = sum(size > _SAME for size, _ in gaps)
        words = (
            f"layers are missing in {counted(count, 'place')}, the most over z = {under:z.3f} mm"
        )
        remark = words if count else "no layer is missing"
        lying = self.known.solid.vertices @ self.known.turn[2]
        off = tops[-1] - float(np.ptp(lying))
        last = self.layers[-1]
        half = (last.top - last.low) / 2 + _SAME
        high = f"its last layer ends at {tops[-1]:z.3f} mm, its top lies at {np.ptp(lying):z.3f}; half a layer may be off"
        return [
            at_most(
                "ROUND_TRIP",
                max(gap, 0.0) if count else 0.0,
                _SAME,
                "mm",
                replace(where, thing=f"{part}, gap between layers", part=part),
                remark,
            ),
            at_most(
                "ROUND_TRIP",
                abs(off),
                half,
                "mm",
                replace(where, thing=f"{part}, height", part=part),
                high,
            ),
        ]


def bodies(walls: Sequence[Wall]) -> list[tuple[Layer, ...]]:
    """The bodies that walls make, each with its layers from below; OverflowError where far too many walls lie over each other."""
    import shapely

    flat = [
        shapely.Polygon(coordinates(z)) for z in (wall.ring.facetted(_COARSE) for wall in walls)
    ]
    tree = shapely.STRtree(flat)
    areas = shapely.area(flat)
    every = label = np.arange(len(flat))
    meetings = 0
    for first in range(
        0, len(flat), _AT_ONCE
    ):  # all pairs at once are as many as their number's square
        a, b = tree.query(flat[first : first + _AT_ONCE], predicate="intersects")
        meetings += len(a)
        if meetings > _MOST_MET:
            raise OverflowError(f"walls that lie over each other more than {_MOST_MET:,} times")
        label = components(len(flat), np.append(a + first, every), np.append(b, label))
    bodies_found = []
    for number in np.unique(label):
        members = np.flatnonzero(label == number).tolist()
        layers = []
        tops = sorted({round(walls[k].z, 4) for k in members})
        bed = (
            0.0 if tops[0] < _ON_BED or len(tops) < 2 else 2 * tops[0] - tops[1]
        )  # a raft under it is none of its own
        usual = float(np.median(np.diff(tops))) if len(tops) > 1 else math.inf
        for low, top in pairwise([bed, *tops]):
            level = [k for k in members if round(walls[k].z, 4) == top]
            height = min(walls[k].height for k in level)
            if math.isinf(height) and low > bed:  # a first layer may be higher than the others
                height = usual
            if top - low > _GAP * height:
                low = top - height
            outlines = [flat[k] for k in level]
            outer, inner = shapely.STRtree(outlines).query(outlines, predicate="contains")
            inner = inner[areas[level][outer] > areas[level][inner]]
            within = np.bincount(inner, minlength=len(level)) % 2 == 1
            layers.append(
                Layer(low - bed, top - bed, tuple(walls[k] for k in level), tuple(within.tolist()))
            )
        bodies_found.append(tuple(layers))
    return bodies_found


def copy_of(layers: Sequence[Layer], known: Sequence[PrintModel]) -> Copy | None:
    """The part of which a body is the print; None where it is like none of them."""
    best: Copy | None = None
    middle = _telling(layers)
    edges = [dense(ring.points, _STEP) for ring in middle.edges()]
    if not edges:
        return None
    thick = max(layer.top - layer.low for layer in layers)
    area = _net(edges)
    centre = _centre(edges)
    for each in known:
        lying = each.lying
        if abs(float(lying.vertices[:, 2].max()) - layers[-1].top) > thick:
            continue
        cut = _section(lying, middle.middle)
        if not cut or abs(_net(cut) - area) > _AREA * area:
            continue
        placement = _laid(
            cut, edges, centre, each.turns, math.inf if best is None else best.laid.off
        )
        if placement.off < (math.inf if best is None else best.laid.off):
            best = Copy(each, placement, tuple(layers))
    return best if best is not None and best.laid.off <= _NO_OTHER else None


def interchangeable(known: Sequence[PrintModel]) -> dict[str, list[str]]:
    """For each part the parts whose prints are the same, itself among them, such as two rods of which one is the other turned over."""
    models: dict[str, list[PrintModel]] = {}
    for each in known:
        models.setdefault(each.part, []).append(each)
    groups: list[list[str]] = []
    for part, own in models.items():
        for group in groups:
            if any(_same_solid(one, other) for one in models[group[0]] for other in own):
                group.append(part)
                break
        else:
            groups.append([part])
    return {part: group for group in groups for part in group}


def _same_solid(one: PrintModel, other: PrintModel) -> bool:
    """Whether one lies on the bed as the other does, but for its place and a turn about the vertical."""
    from scipy.spatial import cKDTree

    if abs(one.solid.volume - other.solid.volume) > _SAME_VOLUME * abs(one.solid.volume):
        return False
    a, b = one.lying, other.lying
    high = float(a.vertices[:, 2].max())
    if abs(high - float(b.vertices[:, 2].max())) > _SAME:
        return False
    middles = _section(a, high / 2), _section(b, high / 2)
    if not all(middles):
        return False
    laid = _laid(*middles, _centre(middles[1]), (), math.inf)
    if laid.off > _SAME_EDGE:
        return False
    for share in _HEIGHTS:
        sections = [_section(each, share * high) for each in (a, b)]
        if not all(sections):
            return False
        points = [np.concatenate([dense(z, _FINE) for z in section]) for section in sections]
        first = _xy(cmath.exp(1j * laid.turn) * points[0] + laid.shift)
        second = _xy(points[1])
        for here, there in ((first, second), (second, first)):
            if cKDTree(there).query(here)[0].max() > _SAME_EDGE:
                return False
    return True


def _section(lying: Mesh, height: float) -> list[Points]:
    """The edges of a solid at a height over the bed."""
    return [dense(ring.points, _STEP) for ring in slice_mesh(lying, height)]


def _telling(layers: Sequence[Layer]) -> Layer:
    """The layer that tells best how a body lies: the middle one of those that are largest, such as a cam's disc, not its hub."""
    inner = layers[1:-1] or layers
    areas = np.array([_net([ring.points for ring in layer.edges()]) for layer in inner])
    large = np.flatnonzero(areas >= (1 - _AREA) * areas.max())
    return inner[int(large[len(large) // 2])]


def _laid(
    cut: Sequence[Points],
    edges_of_body: Sequence[Points],
    centre: complex,
    turns: Sequence[float],
    to_beat: float,
) -> Registration:
    """How the section of a solid lies on the edges of a body, seen from the frame of the solid and of the bed."""
    from scipy.spatial import cKDTree

    middle = _centre(cut)
    body_edges = [z - centre for z in edges_of_body]
    solid_edges = [z - middle for z in cut]
    body_points = np.concatenate(body_edges)
    solid_points = np.concatenate(solid_edges)
    trees = [
        cKDTree(_xy(np.concatenate([dense(z, _FINE) for z in edges])))
        for edges in (body_edges, solid_edges)
    ]

    def off(turn: float, shift: complex, thin: int = 1) -> float:
        spun = cmath.exp(1j * turn)
        to_body = trees[0].query(_xy(spun * solid_points[::thin] + shift))[0]
        to_solid = trees[1].query(_xy((body_points[::thin] - shift) / spun))[0]
        return float(np.sqrt(max(np.mean(to_body**2), np.mean(to_solid**2))))

    def from_start(start: float, most: int) -> Registration:
        some = [z[:: max(1, len(solid_points) // most)] for z in solid_edges]
        placement = lay(some, [body_edges], start=start)[1][0]
        return Registration(placement.turn, placement.shift, off(placement.turn, placement.shift))

    best = Registration(0.0, 0j, math.inf)
    even = np.linspace(0, math.tau, _STARTS, endpoint=False).tolist()
    for start in (*turns, *even):
        if best.off <= _ALIKE:
            break
        best = min(best, from_start(start, _FEW), key=lambda laid: laid.off)
    # What is nearly alike after part of a turn, such as a bar with two holes of other sizes, may lie so as well.
    likely = min(
        (best.turn + step for step in even[1:]), key=lambda turn: off(turn, best.shift, _THIN)
    )
    if best.off < _NO_OTHER and off(likely, best.shift, _THIN) < 2 * best.off:
        best = min(best, from_start(likely, _FEW), key=lambda laid: laid.off)
    if best.off < min(to_beat, _NO_OTHER):
        best = min(best, from_start(best.turn, _MANY), key=lambda laid: laid.off)
    return Registration(
        best.turn, best.shift + centre - cmath.exp(1j * best.turn) * middle, best.off
    )


def _xy(z: Points) -> Floats:
    return coordinates(z)


def _net(edges: Sequence[Points]) -> float:
    """Area of the largest outlines less their holes, mm^2."""
    shapes = pieces_of([Ring.straight(z) for z in edges])
    return sum(shape.area for shape in shapes)


def _centre(edges: Sequence[Points]) -> complex:
    """Centre of the largest outline, mm."""
    largest = max((Ring.straight(z) for z in edges), key=lambda ring: abs(ring.area))
    return largest.centroid


def shapes_of(
    copy: Copy, layer: Layer, hole: float = 0.0, profile: float = 0.0, shrinkage: float = 0.0
) -> tuple[Shape, ...]:
    """A layer's pieces in the part's frame, as they print: shrunk about its origin, holes smaller by `hole` and outlines larger
    by `profile`, mm. ValueError where nothing is left.
    """
    further = (profile / (1 - shrinkage), hole / (1 - shrinkage))
    return pieces_of([copy.inside(edge, shrinkage) for edge in layer.edges(further)])


def envelope(layers: Sequence[Sequence[Shape]]) -> tuple[Shape, ...]:
    """What several layers of one outline fill together: a wide follower, or a pin, feels no other one."""
    import shapely

    def polygon(shape: Shape) -> shapely.Polygon:
        rings = [ring.facetted(_CHORDS) for ring in (shape.outer, *shape.holes)]
        outer, *holes = (coordinates(z) for z in rings)
        return shapely.Polygon(outer, holes)

    whole = shapely.union_all([polygon(shape) for shapes in layers for shape in shapes])
    rings = [
        Ring.straight(z)
        for piece in shapely.get_parts(whole)
        for ring in (piece.exterior, *piece.interiors)
        if len(z := shapely.get_coordinates(ring)[:-1] @ np.array([1, 1j]))
        and abs(shapely.Polygon(ring).area) > _SLIVER
    ]
    return pieces_of(rings)


def outwards(shapes: Sequence[Shape], nominal_shapes: Sequence[Shape]) -> tuple[Floats, Floats]:
    """How far points on outlines and on the edges of holes lie out of the material that is meant, (n,) and (m,) mm."""
    distances = []
    for side, rings, nominal_rings in (
        (1, [s.outer for s in shapes], [s.outer for s in nominal_shapes]),
        (
            -1,
            [hole for s in shapes for hole in s.holes],
            [hole for s in nominal_shapes for hole in s.holes],
        ),
    ):
        off = [np.zeros(0)]
        for ring in rings:
            nominal = min(
                nominal_rings,
                key=lambda one: abs(one.centroid - ring.centroid) + abs(one.length - ring.length),
                default=None,
            )
            if nominal is not None:
                z = nominal.counter_clockwise().facetted(_CHORDS)
                off.append(
                    side * deviation(dense(ring.facetted(_CHORDS), _STEP), dense(z, _STEP / 4))
                )
        distances.append(np.concatenate(off))
    return distances[0], distances[1]
