"""Measuring: eyes, faces and outlines as the sections of files show them."""

from __future__ import annotations

import cmath
import math
from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import pairwise

import numpy as np

from camgen.findings import Where
from camgen.geometry.rings import Circle, Ring, Shape, bore_circle, fit_circle, hole_circles
from camgen.machine.features import (
    CamOutline,
    Edge,
    EdgePair,
    Eye,
    Faces,
    Feature,
    Flat,
    GearTeeth,
    OwnTip,
    SharedFlat,
    SlideFaces,
    SlotFaces,
    Teeth,
    eyes,
)
from camgen.numerics import coordinates, magnitude

Sections = Sequence[Sequence[Shape]]  # of a part: shapes at each height

_PARALLEL = 0.01  # rad, leaning more is another face
_SAME_FACE = 0.02  # of the width: faces at two heights that are further apart are two faces
_FLAT = 0.35  # of the diameter: a longer straight piece of a hole is a flat
_KEYWAY = 0.08  # of the diameter: points of a bore or a shaft that are further off are a keyway's
_STRAIGHT = (
    0.002  # of the diameter: no piece of a circle as straight as this is longer than 0.09 of it
)
_SAME_HOLE = 0.25  # of the diameter: a ring that is nearer than this in place and size is the eye
_HEAD = 1.0  # mm, a ring that is larger by more is a pin's head, not its shank
_SHANK = 0.5  # mm, what is wider than the thinnest ring by more is a head as well
_SAME_HEIGHTS = 1e-9  # mm
_FINE = 1e-5  # mm, to which arcs are taken as facets where heights differ
_ON_TIP = (
    0.02  # of the diameter: points of an outline so near to its nominal circle are on a rounded end
)


@dataclass(frozen=True)
class Files:
    """The files of one kind that show a machine."""

    kind: str  # of READABLE
    where: Where  # as findings say it; a star stands for the parts
    sections: Mapping[str, Sections]  # by part


@dataclass(frozen=True)
class MeasuredEye:
    """An eye as found in a file, mm."""

    centre: complex
    diameter: float  # free, or a shaft's over its vertices
    spread: float = 0.0  # how far the centres at several heights lie apart


def of_layer(sections: Sections, layer: tuple[int, int] | None) -> Sections:
    """The sections of one of a part's layers, given by its number from the bottom and how many there are; of None all, and of fewer
    sections than layers, which are those of that layer alone."""
    number, layers = layer or (0, 1)
    if len(sections) < layers:
        return sections
    cuts = len(sections) // layers
    return sections[cuts * number : cuts * (number + 1)]


def measure(eye: Eye, sections: Sections) -> MeasuredEye | None:
    """The eye in the sections of its part, at all heights at which it is there; None where no ring comes near it."""
    circles_of_eye: list[tuple[Circle, float]] = []
    least = min(_SAME_HOLE * eye.diameter, max(_HEAD, 0.02 * eye.diameter))
    known: dict[int, list[tuple[Circle, float]]] = {}  # of a shape, which may be at several heights
    for shape in (shape for shapes in sections for shape in shapes):
        if id(shape) not in known:
            rings: Sequence[Ring] = [shape.outer] if eye.shaft else shape.holes
            near = [
                _with_whole_flats(ring, eye.diameter)
                for ring in rings
                if abs(ring.centroid - eye.at) <= _SAME_HOLE * eye.diameter
            ]
            found = [_round_part(ring, eye) for ring in near]
            known[id(shape)] = [
                each for each in found if abs(each[0].diameter - eye.diameter) <= least
            ]
        circles_of_eye += known[id(shape)]
    if not circles_of_eye:
        return None
    centres = np.array([c.centre for c, _ in circles_of_eye])
    sizes = [c.diameter if eye.shaft else free for c, free in circles_of_eye]
    spread = magnitude(centres - centres[0])
    size = max(each for each in sizes if each <= min(sizes) + _SHANK) if eye.shaft else min(sizes)
    return MeasuredEye(complex(centres.mean()), size, spread)


def _round_part(ring: Ring, eye: Eye) -> tuple[Circle, float]:
    """The circle of a ring near an eye, and its free diameter, mm: a keyway, whose corners lie far off it, is left out."""
    off = np.abs(np.abs(ring.samples() - eye.at) - eye.diameter / 2) / eye.diameter
    if np.max(off) > _KEYWAY and np.count_nonzero(off < _SAME_FACE) > 4:
        circle = bore_circle(ring.moved(shift=-eye.at), eye.diameter)
        return replace(circle, centre=circle.centre + eye.at), circle.clear_diameter
    (circle,) = hole_circles(Shape(ring, (ring,)))
    return circle, _free(circle, ring)


def _with_whole_flats(ring: Ring, diameter: float) -> Ring:
    """The ring with each flat as one edge: a slicer lays it in several, and the vertices between them lie on no circle."""
    import shapely

    if len(ring.points) < 4:  # no flat in pieces
        return ring
    start = int(np.argmax(np.abs(ring.points - ring.centroid)))  # a corner, or on the round part
    z = np.roll(ring.points, -start)
    straight = np.roll(ring.bulges == 0, -start)
    line = shapely.LinearRing(coordinates(z))
    ends = shapely.get_coordinates(line.simplify(_STRAIGHT * diameter))
    corners = np.flatnonzero(np.isin(z, ends @ np.array([1, 1j])))
    whole = np.ones(len(z), bool)
    for first, last in pairwise([*corners.tolist(), len(z)]):
        length = abs(z[last % len(z)] - z[first])
        if length > _FLAT * diameter and straight[first:last].all():
            whole[first + 1 : last] = False
    return Ring(z[whole], np.roll(ring.bulges, -start)[whole])


def _free(circle: Circle, ring: Ring) -> float:
    """The free diameter of a hole's round part, mm: a flat, longer than any facet, is left out."""
    straight = ring.bulges == 0
    flat = straight & (np.abs(ring.ends - ring.points) > _FLAT * circle.diameter)
    if not flat.any():
        return circle.clear_diameter
    facets = np.abs((ring.points + ring.ends)[straight & ~flat] / 2 - circle.centre)
    return min(circle.diameter, 2 * float(facets.min(initial=np.inf)))


def measure_end(eye: Eye, sections: Sections) -> MeasuredEye | None:
    """A rounded end of an outline, such as a follower's own tip: the circle through what lies near the nominal one."""
    circles = []
    for ring in (shape.outer for shapes in sections for shape in shapes):
        points = ring.samples()
        near = points[np.abs(np.abs(points - eye.at) - eye.diameter / 2) <= _ON_TIP * eye.diameter]
        if len(near) > 4:
            circles.append(fit_circle(near)[:2])
    if not circles:
        return None
    centres = np.array([centre for centre, _ in circles])
    return MeasuredEye(
        complex(centres.mean()),
        2 * max(r for _, r in circles),
        magnitude(centres - centres[0]),
    )


def measure_bore(eye: Eye, sections: Sections) -> MeasuredEye:
    """A bore by its round part, so that no keyway counts, at the lowest height; the meant one where none is there."""
    holes = [hole for shapes in sections[:1] for shape in shapes[:1] for hole in shape.holes]
    if not holes:
        return MeasuredEye(eye.at, eye.diameter)
    nearest = min(holes, key=lambda ring: float(np.min(np.abs(ring.points - eye.at))))
    circle = bore_circle(nearest.moved(shift=-eye.at), eye.diameter)
    return MeasuredEye(eye.at + circle.centre, circle.diameter)


def _measure_own(own: OwnTip, sections: Sections) -> MeasuredEye | None:
    """A follower's own tip: a seat, a rounded end, or the nearest corner of a knife edge."""
    if own.tip.diameter:
        return measure_end(own.tip, sections) if own.tip.shaft else measure(own.tip, sections)
    corners = np.concatenate([shape.outer.points for shapes in sections for shape in shapes])
    return MeasuredEye(complex(corners[np.argmin(np.abs(corners - own.tip.at))]), 0.0)


@dataclass(frozen=True)
class MeasuredFaces:
    """Two parallel faces as found."""

    offset: float  # of their middle, to the left of the line they were sought at, mm
    lean: float  # from that line, rad
    width: float  # their distance, mm


def measure_faces(
    through: complex, angle: float, width: float, sections: Sections
) -> MeasuredFaces | None:
    """The two faces of a part, `width` apart, on either side of a line: the mean of all heights; None where one is missing."""
    sides = [_face(through, angle, side * width / 2, width, sections) for side in (-1, 1)]
    right, left = sides
    if right is None or left is None:
        return None
    return MeasuredFaces((left[0] + right[0]) / 2, (left[1] + right[1]) / 2, left[0] - right[0])


def _face(
    through: complex, angle: float, offset: float, width: float, sections: Sections
) -> tuple[float, float] | None:
    """The straight face of a part sought `aside` to the left of a line: where it crosses beside `through`, mm, and its lean."""
    along = cmath.exp(1j * angle)
    faces = []
    for shapes in sections:
        rings = [ring for shape in shapes for ring in (shape.outer, *shape.holes)]
        a, b = (
            np.concatenate([getattr(ring, end)[ring.bulges == 0] for ring in rings])
            for end in ("points", "ends")
        )
        long = np.abs(b - a) > width / 4
        start = (a[long] - through) / along
        way = (b[long] - a[long]) / along
        lean = np.arctan2(np.where(way.real < 0, -way.imag, way.imag), np.abs(way.real))
        away = start.imag - start.real * np.tan(lean)  # of the face, across from `through`
        off = np.where(np.abs(lean) < _PARALLEL, np.abs(away - offset), np.inf)
        nearest = int(np.argmin(off)) if len(off) else 0
        if len(off) and off[nearest] < _SAME_HOLE * width:
            faces.append((off[nearest], away[nearest], lean[nearest]))
    if not faces:
        return None
    away, lean = np.mean(
        [row[1:] for row in faces if row[0] <= min(faces)[0] + _SAME_FACE * width], axis=0
    )
    return float(away), float(lean)


@dataclass
class Readings:
    """All features of a machine as the files of one kind show them."""

    eyes: dict[Eye, MeasuredEye] = field(default_factory=dict)
    faces: dict[Faces, MeasuredFaces] = field(default_factory=dict)
    flats: dict[Flat, Flat] = field(default_factory=dict)
    rings: dict[CamOutline, Ring] = field(default_factory=dict)
    wheels: dict[Teeth, Ring] = field(default_factory=dict)
    edges: dict[Edge, Ring] = field(default_factory=dict)
    facing: dict[SharedFlat, tuple[float, float]] = field(default_factory=dict)
    lost: list[str] = field(default_factory=list)  # sentences on what they do not show


def read(features: Sequence[Feature], files: Mapping[str, Sections], drawing: bool) -> Readings:
    """Measure all features in the sections of the parts' files."""
    reader = _Reader(defaultdict(list, files), drawing)  # a part that could not be read has none
    tips = {feature.tip for feature in features if isinstance(feature, CamOutline)}
    for eye in dict.fromkeys(eye for feature in features for eye in eyes(feature)):
        reader.eye(eye, eye in tips)
    for feature in features:
        match feature:
            case SlideFaces(joint=joint, rails=rails, runner=runner):
                reader.faces(joint, (rails, runner))
            case SlotFaces(joint=joint, walls=walls):
                reader.faces(joint, (walls,))
            case CamOutline():
                reader.cam(feature)
            case GearTeeth(joint=joint, a=a, b=b):
                reader.teeth(joint, a)
                reader.teeth(joint, b)
            case EdgePair(joint=joint):
                reader.edges(joint, feature.edges)
            case SharedFlat():
                reader.flats(feature)
    return reader.readings


class _Reader:
    """Readings, feature by feature."""

    def __init__(self, files: Mapping[str, Sections], drawing: bool) -> None:
        self.files = files
        self.drawing = drawing
        self.readings = Readings()

    def _lost(self, sentence: str) -> None:
        self.readings.lost.append(sentence)

    def eye(self, eye: Eye, tip: bool) -> None:
        """A hole, or a shaft; tip: whether a follower may have it as its own rounded end."""
        if eye.part is None or not eye.diameter:
            self.readings.eyes[eye] = MeasuredEye(eye.at, eye.diameter)
            return
        sections = self.files[eye.part]
        circle = measure(eye, sections)
        if circle is None and eye.shaft and tip:
            circle = measure_end(eye, sections)
        if circle is None:
            self._lost(f"no eye of {eye.diameter:g} mm near {eye.at:.3f} in {eye.part}")
        else:
            self.readings.eyes[eye] = circle

    def faces(self, joint: str, pairs: Sequence[Faces]) -> None:
        """Faces of a slide or a slot; those that no drawing shows count as meant."""
        for pair in pairs:
            faces: MeasuredFaces | None = MeasuredFaces(0.0, 0.0, pair.width)
            if not self.drawing or pair.drawn:
                faces = measure_faces(pair.at, pair.angle, pair.width, self.files[pair.part])
            if faces is None:
                self._lost(f"{joint}: a face or its eye is lost")
                return
            self.readings.faces[pair] = faces

    def cam(self, feature: CamOutline) -> None:
        """A cam's outline with its bore, and what rides on it."""
        files = self.files
        tip = feature.tip
        ring = _outline(of_layer(files[feature.part], feature.layer), feature.inside)
        if ring is None:
            self._lost(f"{feature.joint}: the outline of {feature.part} is lost")
            return
        if isinstance(tip, Flat):
            face = _flat(tip, files)
            if face is None:
                self._lost(f"{feature.joint}: the face is lost")
                return
            self.readings.flats[tip] = face
        if isinstance(tip, Edge):
            self.edges(feature.joint, (tip,))
            if tip not in self.readings.edges:
                return
        self.readings.rings[feature] = ring
        measured = self.readings.eyes
        if feature.bore is not None:
            measured[feature.bore] = measure_bore(feature.bore, files[feature.part])
        own = feature.own
        if own is not None and own.part in files:
            measured[own.bore] = measure_bore(own.bore, files[own.part])
            end = _measure_own(own, files[own.part])
            if end is not None:
                measured[own.tip] = end

    def teeth(self, joint: str, nominal: Teeth) -> None:
        """One wheel of a pair."""
        outline = self._whole_outline(joint, nominal.part, nominal.inside)
        if outline is not None:
            self.readings.wheels[nominal] = outline

    def edges(self, joint: str, edges: Sequence[Edge]) -> None:
        """Outlines that touch others."""
        for edge in edges:
            outline = self._whole_outline(joint, edge.part, edge.hole is not None, edge.hole)
            if outline is not None:
                self.readings.edges[edge] = outline

    def _whole_outline(
        self, joint: str, part: str, inside: bool = False, near: complex | None = None
    ) -> Ring | None:
        outline = _whole(self.files[part], inside, near)
        if outline is None:
            self._lost(f"{joint}: the outline of {part} is lost")
        return outline

    def flats(self, feature: SharedFlat) -> None:
        """The flats of two holes on one pin."""
        angles = []
        for eye in (feature.a, feature.b):
            angle = _facing(eye, feature.facing, self.files[eye.part or ""])
            if angle is None:
                self._lost(f"no flat in {eye.part} near {eye.at:.3f}")
                return
            angles.append(angle)
        self.readings.facing[feature] = angles[0], angles[1]


def _whole(sections: Sections, inside: bool, near: complex | None = None) -> Ring | None:
    """A part's outline, or its largest hole, or the one near to a place; material on its left; None without any.

    Of heights that differ all the material that any of them shows: what stands on a wheel is left out.
    """
    outlines: list[Ring] = []
    for shapes in sections:
        rings = [ring for shape in shapes for ring in (shape.holes if inside else (shape.outer,))]
        if rings:
            ring = _chosen(rings, near)
            if not any(_same(ring, other) for other in outlines):
                outlines.append(ring)
    if not outlines:
        return None
    whole = outlines[0] if len(outlines) == 1 else _together(outlines, inside)
    return whole.counter_clockwise().reversed() if inside else whole.counter_clockwise()


def _chosen(rings: Sequence[Ring], near: complex | None) -> Ring:
    """The largest, or the one whose middle is nearest to a place."""
    if near is None:
        return max(rings, key=lambda each: abs(each.area))
    return min(rings, key=lambda each: abs(each.centroid - near))


def _together(rings: Sequence[Ring], inside: bool) -> Ring:
    """The outer edge of all, or what all leave open inside, in facets."""
    import shapely

    edges = [ring.facetted(_FINE) for ring in rings]
    polygons = [shapely.make_valid(shapely.Polygon(coordinates(z))) for z in edges]
    joined = shapely.intersection_all(polygons) if inside else shapely.union_all(polygons)
    whole = max(shapely.get_parts(joined), key=lambda each: each.area)
    x, y = shapely.get_coordinates(whole.exterior)[:-1].T
    return Ring(x + 1j * y, np.zeros(len(x)))


def _same(one: Ring, other: Ring) -> bool:
    """Whether two heights of a prism show it: the same corners, to the last digits."""
    return one.points.shape == other.points.shape and bool(
        np.allclose(one.points, other.points, rtol=0, atol=_SAME_HEIGHTS)
        and np.allclose(one.bulges, other.bulges, rtol=0, atol=_SAME_HEIGHTS)
    )


def _facing(eye: Eye, facing: float, sections: Sections) -> float | None:
    """Where the flat of a hole faces, rad, the mean of all heights: its longest straight side; None where none is so long."""
    angles = []
    for hole in (hole for shapes in sections for shape in shapes for hole in shape.holes):
        if abs(hole.centroid - eye.at) > _SAME_HOLE * eye.diameter:
            continue
        ring = _with_whole_flats(hole, eye.diameter)
        way = np.where(ring.bulges == 0, ring.ends - ring.points, 0.0)
        side = way[int(np.argmax(np.abs(way)))]
        if abs(side) > _FLAT * eye.diameter:
            off = cmath.phase(complex(side) / 1j / cmath.exp(1j * facing))
            angles.append(math.remainder(off, math.pi))
    return facing + float(np.mean(angles)) if angles else None


def _outline(sections: Sections, inside: bool) -> Ring | None:
    """What a follower runs on: the largest outline of a part (of its heights), or hole, material on its left."""
    rings = [
        ring
        for shapes in sections
        for shape in shapes
        for ring in (shape.holes if inside else [shape.outer])
    ]
    if not rings:
        return None
    ring = max(rings, key=lambda ring: abs(ring.area)).counter_clockwise()
    return ring.reversed() if inside else ring


def _flat(flat: Flat, files: Mapping[str, Sections]) -> Flat | None:
    """A follower's face as it is."""
    if flat.part is None:
        return flat
    along = flat.facing + math.pi / 2
    face = _face(flat.at, along, 0.0, flat.width, files[flat.part])
    if face is None:
        return None
    return replace(
        flat, at=flat.at + 1j * cmath.exp(1j * along) * face[0], facing=flat.facing + face[1]
    )
