"""The arrangement of a machine for its drawing: its parts where they stand at the first angle of its drive, and the line of its section.

The section goes through the axis of the drive, or the first that stands, along the line that meets the most axes, those that stand first.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from functools import reduce
from typing import Any, NamedTuple

import numpy as np

from camgen.files.arrangement import Arrangement, Axis, Copy
from camgen.files.dimensions import number
from camgen.files.exploded_view import Coming, Prism
from camgen.files.views import area
from camgen.geometry.arcs import as_circle
from camgen.geometry.mesh import Mesh, in_standing_plane, placing, slice_mesh
from camgen.machine.features import PartPose, heights
from camgen.machine.model import GROUND, Pin, centres_of
from camgen.machines.mechanism import Mechanism
from camgen.numerics import coordinates
from camgen.parts.assembly import Assembly
from camgen.parts.catalogue import (
    CAM_FOLLOWERS,
    FOLLOWER_NUT,
    FOLLOWER_WASHER,
    GREASE,
    SCREWS,
    TURNED,
    WASHERS,
    Bought,
    Screw,
)
from camgen.parts.keyways import ROUND_ENDED
from camgen.parts.part import Part
from camgen.parts.reaming import KEYED_GLUE
from camgen.parts.shafts import OF_SHAFT
from camgen.parts.step_words import TWO_PART
from camgen.pipeline.assembly_list import items_of
from camgen.pipeline.bought_shapes import Thing, bought_shapes, is_drawn_short, washers_on
from camgen.pipeline.comings import after_what_is_nearer, coming_of, comings_of, is_from_behind
from camgen.pipeline.shopping import bought_things, steps_of_assembly
from camgen.pipeline.shown import coarse
from camgen.study import Table

_FINE = 0.01  # mm, chord tolerance of outlines
_ON_LINE = 1e-3  # mm, by which an axis may miss the line of the section
_BEHIND = "ISO 4762"  # of screws from behind, as the parts list has it
_BOARD = 10.0  # mm, how thick the board is taken that a screw from behind goes through
_ROUND = 48  # sides of a rod that lies
_GRID = 1e-6  # mm, on which faces meet that lie on each other
_UNDER = 1e-4  # mm, by which a level is cut below
_HEIGHTS = 2  # at which copies of a part lie, that the list has
_LETTERS = "ABCDEFGHJKLMNPQRSTUVWXYZ"  # of sections, without those that look like figures
_AROUND = 721  # angles of a turn
_USED = (
    "glue",
    KEYED_GLUE,
    TWO_PART,
    GREASE,
    "threadlocker",
)  # items that have no place of their own
_RODS = (
    "pin",
    "crank-pin",
    "shaft",
)  # roles of parts with flats or grooves that it does not hatch either
_WHOLE = ("bought", TURNED)  # how parts are made that a section does not hatch

_MIRRORED = "The far side is the mirror image of this one about z = {}: of what both have, the list has the heights on this side."
_ALIKE = 0.01  # mm, by which heights of images may differ


class Reach(NamedTuple):
    """From where to where a copy reaches, mm, and on which side that is built by itself."""

    low: float
    high: float
    side: str


class Cut(NamedTuple):
    """Where a machine is cut: a point, and unit directions of the line that leaves it to the right, and of that which comes to it from the
    left, the same where it is straight."""

    origin: complex
    right: complex
    left: complex

    @property
    def halves(self) -> Iterator[tuple[complex, float, float]]:
        """Directions, and from where to where along them the line runs from its point, mm."""
        if self.left == self.right:
            yield self.right, -math.inf, math.inf
        else:
            yield self.right, 0.0, math.inf
            yield self.left, -math.inf, 0.0


Shape = tuple[
    list[tuple[Any, float]], Any, tuple[float, float]
]  # faces, cut and span of a copy, as its record says


def arrangement_of(mechanism: Mechanism, listed: Table) -> Arrangement:
    """A machine of several parts as its arrangement drawing shows it; listed: its parts list, how, part, what and count first."""
    assembly = mechanism.assembly
    things = bought_things(mechanism)
    drawn = bought_shapes(mechanism, things)
    axes, moving = _axes(assembly)
    if any(thing.shaft is not None for thing in things):  # through keys and rollers beside it
        moving += [_middle(shape) for shapes in drawn.values() for shape in shapes]
    line = _line([axis.at for axis in axes], moving)
    steps = steps_of_assembly(mechanism)
    comings = comings_of(steps)
    copies = _copies(mechanism, line, comings)
    if all(copy.cut.is_empty for copy in copies):  # axes apart from all that is made
        outlines = [face for copy in copies for face, _ in copy.faces]
        inside = max(outlines, key=lambda face: float(face.area)).representative_point()
        line = Cut(complex(inside.x, inside.y), 1 + 0j, 1 + 0j)
        copies = _copies(mechanism, line, comings)
    made = tuple(copies)
    items = []
    bought = list[tuple[int, bool, Bought, Thing, Coming]]()
    for item, thing in items_of(mechanism, listed):
        short = thing is not None and is_drawn_short(assembly, thing)
        for shape in drawn.get(thing, []) if thing else []:
            assert thing is not None, "it is drawn"
            coming = coming_of(thing, shape, made, steps)
            bought.append((item.number, short, thing, shape, coming))
        used = item.what in _USED
        why = "drawn short" if short else "in the steps" if used else "not drawn"
        items.append(replace(item, heights=[why]))
    comes = after_what_is_nearer([(shape, coming) for *_, shape, coming in bought])
    for (item_number, short, thing, shape, _), coming in zip(bought, comes, strict=True):
        copies += _of_thing(item_number, shape, line, short, thing, coming)
    reaches = _reaches(copies)
    plane = _mirror(reaches)
    items = [
        replace(item, heights=_heights(reaches[item.number], plane))
        if item.number in reaches
        else item
        for item in items
    ]
    bearings = [each for thing, found in drawn.items() for each in found if thing.name == OF_SHAFT]
    middles = sorted((each[0][1] + each[0][2]) / 2 for each in bearings)
    notes = _notes(mechanism, axes)
    if plane is not None:
        notes.insert(2, _MIRRORED.format(number(plane, 3)))
    notes += [*_housings(things), *_followers(mechanism, things)]
    balls = [ball for each in bearings for ball in _balls(each, line)]
    cut = line.origin, line.right
    bend = line.left if line.left != line.right else None
    return Arrangement(copies, items, cut, axes, notes, middles, balls, _letter(assembly), bend)


def _letter(assembly: Assembly) -> str:
    """Of the section: the first that no hole of a part has."""
    used = {name[:1] for part in assembly.parts for name, _ in part.points}
    return next((letter for letter in _LETTERS if letter not in used), _LETTERS[0])


def _balls(bearing: Thing, line: Cut) -> Iterator[tuple[complex, float]]:
    """Balls of a bearing that a section cuts which bends or begins at its axis, between its rings: along it and z, and their radius."""
    (inner, low, high), (outer, *_) = bearing
    middle = complex(inner.centroid.x, inner.centroid.y) - line.origin
    if abs(middle) > _ON_LINE:
        return
    x0, _, x1, _ = inner.bounds
    y0, _, y1, _ = outer.interiors[0].bounds
    radius = (y1 - y0 - (x1 - x0)) / 4
    for side in (-1, 1):
        yield complex(side * ((x1 - x0) / 2 + radius), (low + high) / 2), radius


def _housings(things: Sequence[Bought]) -> list[str]:
    """What the frame of a shaft that is no part has to have, since it is the builder's own."""
    shafts = [thing.shaft for thing in things if thing.shaft is not None]
    return [f"Frame: {words}." for each in shafts for words in each.housings]


def _followers(mechanism: Mechanism, things: Sequence[Bought]) -> list[str]:
    """Where cam followers that are bought go, since what carries them is the builder's own."""
    follower = CAM_FOLLOWERS.get((mechanism.load and mechanism.load.cam_follower) or "")
    if follower is None or not any(thing.shaft is not None for thing in things):
        return []
    assembly = mechanism.assembly
    theta = assembly.cycle.theta(np.linspace(0.0, 2 * np.pi, _AROUND))
    courses = assembly.courses(theta)
    notes = []
    for tip in (each for each in assembly.stand_ins if each.rolls):
        body = courses[tip.body]
        for at, *_ in tip.discs:
            off = abs(body.place + np.exp(1j * body.angle) * at)
            span = _between(float(np.min(off)), float(np.max(off)))
            notes.append(f"Axis of the cam follower: {span} from that of the shaft.")
    for track in assembly.tracks:
        drum = assembly.by_name[track.part].drum
        if drum is not None:
            z = next(each.z for each in assembly.mounts if each.part == track.part)
            ends = z + drum.path.height(theta, 0)
            span = _between(float(np.min(ends)), float(np.max(ends)))
            _, length, inner, _ = track.roller
            washers = washers_on(things) * WASHERS[follower.stud]
            outer = number(inner + length + follower.beyond + washers, 2)
            notes.append(
                f"Axis of the cam follower: square to the shaft, at z {span}; ring from {number(inner, 2)}, your part from {outer} off the shaft."
            )
    return notes


def _between(low: float, high: float) -> str:
    """From where to where, in words."""
    return f"{number(low, 2)} to {number(high, 2)}"


def _of_thing(
    number: int,
    shape: Thing,
    line: Cut,
    short: bool,
    thing: Bought,
    coming: Coming,
) -> Iterator[Copy]:
    """What is bought, its rings apart where these are hatched, such as those of a bearing."""
    rings = not thing.thread
    hatched = [piece for piece in shape if rings and piece[0].interiors]
    rest = [piece for piece in shape if not (rings and piece[0].interiors)]
    prisms = shape  # once
    solid = None
    if coming.aside:
        ring = thing.name in (FOLLOWER_WASHER, FOLLOWER_NUT)
        solid = _lying_ring(shape) if ring else _rods(shape)
    elif thing.standard == ROUND_ENDED:
        solid = _key(shape)
    elif is_from_behind(thing, shape):
        solid = _headed(shape, SCREWS[thing.thread].headed(_BEHIND))
    for pieces, hatching in ((hatched, True), (rest, False)):
        if pieces:
            faces, cut, span = _of_prisms(pieces, line)
            yield Copy(number, faces, cut, hatching, span, True, short, prisms, solid, coming)
            prisms = ()


def _key(shape: Thing) -> Mesh:
    """A key whose ends are round, drawn as a rectangle whose first edge is square to the shaft's axis. [DIN 6885 form A]"""
    import manifold3d

    ((face, low, high),) = shape
    corners = np.array(face.exterior.coords) @ np.array([1, 1j])
    deep = corners[1] - corners[0]
    wide = abs(corners[2] - corners[1])
    ends = max((high - low - wide) / 2, 0.0)
    disc = manifold3d.CrossSection.circle(wide / 2, _ROUND)
    slot = manifold3d.CrossSection.batch_hull([disc.translate((0.0, y)) for y in (-ends, ends)])
    upright = slot.extrude(abs(deep)).rotate((90.0, 0.0, 90.0))  # along x, upright in y and z
    turned = upright.rotate((0.0, 0.0, float(np.angle(deep, deg=True))))
    start = complex(face.centroid.x, face.centroid.y) - deep / 2
    return _mesh(turned.translate((start.real, start.imag, (low + high) / 2)))


def _headed(shape: Thing, screw: Screw) -> Mesh:
    """A screw from behind with its head, under a board of yours that is not drawn."""
    import manifold3d

    ((face, low, high),) = shape
    seat = low - _BOARD
    shank, head = (
        manifold3d.Manifold.cylinder(long, radius, radius, _ROUND).translate((0.0, 0.0, z))
        for long, radius, z in (
            (high - seat, screw.nominal / 2, seat),
            (screw.height, screw.head / 2, seat - screw.height),
        )
    )
    return _mesh((shank + head).translate((face.centroid.x, face.centroid.y, 0.0)))


def _rods(shape: Thing) -> Mesh:
    """Rods that lie, each drawn as a rectangle whose first edge is along its axis."""
    import manifold3d

    rods = [_rod(face, (low + high) / 2, (high - low) / 2) for face, low, high in shape]
    return _mesh(manifold3d.Manifold.batch_boolean(rods, manifold3d.OpType.Add))


def _lying_ring(shape: Thing) -> Mesh:
    """A ring whose axis lies, drawn as such a rectangle over its hole and one under it."""
    (face, above, top), (_, bottom, below) = shape
    middle = (bottom + top) / 2
    return _mesh(_rod(face, middle, (top - bottom) / 2) - _rod(face, middle, (above - below) / 2))


def _rod(face: Any, height: float, radius: float) -> Any:
    """A rod of manifold3d along the first edge of a rectangle, at so much height."""
    import manifold3d

    z = np.array(face.exterior.coords)[:2] @ np.array([1, 1j])
    begin, end = z + (complex(face.centroid.x, face.centroid.y) - z.mean())
    rod = manifold3d.Manifold.cylinder(abs(end - begin), radius, radius, _ROUND)
    turned = rod.rotate((0.0, 90.0, float(np.angle(end - begin, deg=True))))
    return turned.translate((begin.real, begin.imag, height))


def _mesh(body: Any) -> Mesh:
    """A body of manifold3d as a mesh."""
    whole = body.to_mesh64()
    return Mesh(np.array(whole.vert_properties)[:, :3], np.array(whole.tri_verts, int))


def _reaches(copies: Sequence[Copy]) -> dict[int, list[Reach]]:
    """Of each number from where to where its copies reach, but of what is drawn short."""
    reaches: dict[int, list[Reach]] = {}
    for copy in copies:
        if copy.bought and copy.prisms and not copy.short:  # the whole of a thing
            low = min(low for _, low, _ in copy.prisms)
            high = max(high for *_, high in copy.prisms)
            reaches.setdefault(copy.number, []).append(Reach(low, high, copy.coming.apart))
        elif not copy.bought:
            reaches.setdefault(copy.number, []).append(Reach(*copy.span, copy.coming.apart))
    for copy in copies:  # what is not drawn apart
        if copy.bought and not copy.short and copy.number not in reaches:
            reaches[copy.number] = [Reach(*copy.span, copy.coming.apart)]
    return reaches


def _mirror(reaches: Mapping[int, Sequence[Reach]]) -> float | None:
    """Height of the plane about which copies on one side are mirror images of those on the other; None where there is none."""
    planes = list[float]()
    for own in reaches.values():
        near = [each for each in own if not each.side]
        far = [each for each in own if each.side]
        if far and len(near) == len(far):
            ends = sum(each.low + each.high for each in own)
            planes.append(ends / (2 * len(own)))
    if not planes or max(planes) - min(planes) > _ALIKE:
        return None
    return planes[0]


def _heights(reaches: Sequence[Reach], plane: float | None) -> list[str]:
    """From where to where copies of an item reach, in words, of those that are mirrored on the far side on the near one; of many how many
    there are and between which they all lie."""
    near = sorted({(each.low, each.high) for each in reaches if not each.side})
    far = sorted((each.low, each.high) for each in reaches if each.side)
    ends = sorted({*near, *far})
    if plane is not None and near and far:
        images = sorted({(2 * plane - high, 2 * plane - low) for low, high in far})
        if len(images) == len(near) and np.allclose(images, near, rtol=0.0, atol=_ALIKE):
            ends = near
    words = [*dict.fromkeys(f"{number(low, 2)} to {number(high, 2)}" for low, high in ends)]
    if len(words) <= _HEIGHTS:
        return words
    highest = max(high for _, high in ends)
    return [f"{len(words)} heights from", f"{number(ends[0][0], 2)} to {number(highest, 2)}"]


def _middle(thing: Thing) -> complex:
    """Of the first face of what is bought."""
    middle = thing[0][0].centroid
    return complex(middle.x, middle.y)


def _axes(assembly: Assembly) -> tuple[list[Axis], list[complex]]:
    """Axes that stand, the drive's first, and those that move, where they are at theta = 0, mm; without those of standing planes."""
    courses = assembly.courses(np.zeros(1))
    driven = {drive.body for drive in assembly.machine.drives}
    standing: dict[complex, Axis] = {}
    ground = {mount.part: mount for mount in assembly.mounts if mount.body == GROUND}
    holes = [
        (mount.at + np.exp(1j * mount.angle) * z, hole)
        for name, mount in ground.items()
        if not (mount.flipped or mount.upright)
        for hole, z in assembly.by_name[name].points
    ]
    moving = list[complex]()
    for joint in sorted(
        (each for each in assembly.machine.joints if isinstance(each, Pin)),
        key=lambda joint: not {joint.a.body, joint.b.body} & driven,
    ):
        place, other = centres_of(joint)
        if {place.body, other.body} & assembly.planes.keys():
            continue
        if GROUND not in (place.body, other.body):
            body = courses[place.body]
            at = complex(np.ravel(body.place)[0]) + place.at * np.exp(1j * np.ravel(body.angle)[0])
            moving.append(complex(at))
            continue
        at = place.at if place.body == GROUND else other.at
        name = next((hole for z, hole in holes if abs(z - at) < _ON_LINE), joint.name)
        standing.setdefault(complex(round(at.real, 6), round(at.imag, 6)), Axis(at, name))
    return list(standing.values()), moving


def _line(standing: Sequence[complex], moving: Sequence[complex]) -> Cut:
    """The line through the first axis that stands which meets the most others; it is straight where that meets as many as with a bend at
    that axis, of at most a right angle, and as level as can be. The x axis where none stands."""
    if not standing:
        return Cut(0j, 1 + 0j, 1 + 0j)
    origin = standing[0]
    others = [z - origin for z in (*standing, *moving) if abs(z - origin) > _ON_LINE]
    ways = {1 + 0j: 0, -1 + 0j: 0}  # and how many axes lie that way
    for z in others:
        way = z / abs(z)
        found = next((each for each in ways if abs(each - way) < _ON_LINE), way)
        ways[found] = ways.get(found, 0) + 1
        ways.setdefault(-found, 0)

    def rank(pair: tuple[complex, complex]) -> tuple[int, bool, float]:
        """Of a way out to the right, and one out to the left."""
        right, left = pair
        return ways[right] + ways[left], right == -left, abs((right - left).real)

    pairs = [
        (right, left)
        for right in ways
        for left in ways
        if (right * left.conjugate()).real < _ON_LINE and right.real > left.real - _ON_LINE
    ]
    right, left = max(pairs, key=rank)
    return Cut(origin, right, -left)


def _copies(mechanism: Mechanism, line: Cut, comings: Mapping[str, Coming]) -> list[Copy]:
    """All copies where they stand, cut along a line."""
    assembly = mechanism.assembly
    poses = assembly.poses(np.zeros(1))
    tolerance = mechanism.accuracy.chord_tolerance
    return [
        replace(
            _copy(k, part, pose, line, tolerance),
            coming=comings.get(f"{part.name}-{count}", Coming()),
        )
        for k, part in enumerate(assembly.parts, 1)
        for count, pose in enumerate(poses[part.name], 1)
    ]


def _copy(item: int, part: Part, pose: PartPose, line: Cut, tolerance: float) -> Copy:
    """A copy as it is seen and cut."""
    flat = part.prismatic and not (pose.upright or pose.standing)
    prisms = _layers(part, pose) if flat else ()
    solid = None if flat else _placed_solid(part, pose, tolerance)
    faces, cut, span = _of_prisms(prisms, line) if solid is None else _of_solid(solid, line)
    prisms = prisms or _terraces(faces, span[0])
    hollow = any(each.region.holes for each in part.layers)  # such as a bush
    rod = all(as_circle(each.region.outer) for each in part.layers)
    rod |= part.role in _RODS or part.process in _WHOLE
    return Copy(item, faces, cut, hollow or not rod, span, prisms=prisms, solid=solid)


def _placed_solid(part: Part, pose: PartPose, tolerance: float) -> Mesh:
    """A part's solid where a copy stands."""
    at = complex(pose.place[0])
    placed = placing(float(pose.angle[0]), at, pose.z, part.thickness, pose.flipped, pose.upright)
    return coarse(part, tolerance).moved(in_standing_plane(placed) if pose.standing else placed)


def _terraces(faces: Sequence[tuple[Any, float]], low: float) -> list[Prism]:
    """A solid as prisms on each other: from its faces, the highest first, and the height at which it begins."""
    import shapely

    floors = [*(top for _, top in faces[1:]), low]
    return [
        (piece, floor, top)
        for (face, top), floor in zip(faces, floors, strict=True)
        for piece in shapely.get_parts(face)
        if top - floor > 2 * _UNDER
    ]


def _layers(part: Part, pose: PartPose) -> list[Prism]:
    """A part by its layers where a copy stands."""
    import shapely

    place = complex(pose.place[0])
    turn = np.exp(1j * float(pose.angle[0]))

    def put(points: Any) -> Any:
        """Points of the part where the copy stands."""
        z = points @ np.array([1, 1j])
        return coordinates(place + turn * (-z.conjugate() if pose.flipped else z))

    return [
        (
            shapely.transform(area(layer.region, _FINE), put),
            *heights(pose, part.thickness, layer.z0, layer.z1),
        )
        for layer in part.layers
    ]


def _of_prisms(prisms: Sequence[Prism], line: Cut) -> Shape:
    """Upright prisms."""
    import shapely

    boxes = []
    for way, begin, end in line.halves:

        def beside(points: Any, way: complex = way) -> Any:
            """Points of the machine along the line and to its left."""
            return coordinates((points @ np.array([1, 1j]) - line.origin) / way)

        for shape, low, high in prisms:
            local = shapely.transform(shape, beside)
            x0, _, x1, _ = local.bounds
            ends = max(x0 - 1, begin), min(x1 + 1, end)
            if ends[0] >= ends[1]:
                continue
            chord = local.intersection(shapely.LineString([(x, 0) for x in ends]))
            boxes += [
                shapely.box(piece.bounds[0], low, piece.bounds[2], high)
                for piece in shapely.get_parts(chord)
                if piece.length
            ]
    faces = [(shape, high) for shape, _, high in prisms]
    span = min(low for _, low, _ in prisms), max(high for _, _, high in prisms)
    whole = shapely.union_all([shapely.Polygon(), *boxes], grid_size=_GRID)
    return faces, whole, span


def _of_solid(solid: Mesh, line: Cut) -> Shape:
    """A solid: its faces are the outlines from above of what reaches as high as each of its level faces, then of all of it."""
    import shapely

    body = solid.manifold
    levels = _levels(solid)
    faces = [
        (body.trim_by_plane((0.0, 0.0, 1.0), level - _UNDER).project(), level) for level in levels
    ]
    lowest = levels[-1] - _UNDER if levels else float(np.max(solid.vertices[:, 2]))
    faces.append((body.project(), lowest))
    seen = [(shapely.simplify(_even(face.to_polygons()), _FINE), top) for face, top in faces]
    low, high = float(solid.vertices[:, 2].min()), float(solid.vertices[:, 2].max())
    cuts = []
    for way, begin, end in line.halves:
        local = (solid.vertices[:, :2] @ np.array([1, 1j]) - line.origin) / way
        turned = np.column_stack([local.real, solid.vertices[:, 2], -local.imag])
        rings = [ring.points for ring in slice_mesh(Mesh(turned, solid.faces), 0.0)]
        own = _even([coordinates(z) for z in rings])
        x0 = max(float(local.real.min()) - 1, begin)
        x1 = min(float(local.real.max()) + 1, end)
        if x0 < x1:
            cuts.append(own.intersection(shapely.box(x0, low - 1, x1, high + 1)))
    cut = shapely.union_all([shapely.Polygon(), *cuts], grid_size=_GRID)
    return seen, cut, (low, high)


def _levels(solid: Mesh) -> list[float]:
    """Heights of a solid's level upper faces, mm, from the highest down, each clearly below the one before."""
    corners = solid.vertices[solid.faces]
    a, b = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    doubled = a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]  # of the area from above
    level = (np.ptp(corners[:, :, 2], axis=1) < _UNDER) & (doubled > 0)
    tops = list[float]()
    for top in np.unique(np.round(corners[level, 0, 2], 6))[::-1].tolist():
        if not tops or tops[-1] - top > 2 * _UNDER:
            tops.append(top)
    return tops


def _even(rings: Sequence[Any]) -> Any:
    """The area inside an odd number of rings, each (n, 2) mm."""
    import shapely

    areas = (shapely.make_valid(shapely.Polygon(ring)) for ring in rings if len(ring) > 2)
    return reduce(shapely.symmetric_difference, areas, shapely.Polygon())


def _datum(assembly: Assembly) -> str:
    """Whose lower face is at z = 0, in words; "" where no part of the ground lies there."""
    lying = (
        mount.part
        for mount in assembly.mounts
        if mount.body == GROUND and mount.z == 0 and not mount.upright
    )
    return next((f", the lower face of {part}" for part in lying), "")


def _notes(mechanism: Mechanism, axes: Sequence[Axis]) -> list[str]:
    """What the sheet says of the machine as it is shown."""
    assembly = mechanism.assembly
    cycle = assembly.cycle
    start = math.degrees(float(cycle.theta(np.zeros(1))[0]))
    alone = any(thing.shaft is not None for thing in assembly.bought)  # cams, which no crank turns
    turns = "clockwise" if cycle.sense < 0 else "counter-clockwise"
    way = "to and fro" if cycle.to_and_fro else turns
    angle = "cam angle" if alone else cycle.name
    shown = f"Shown at {angle} {start:.4g} {cycle.unit}, driven {way}."
    heights_from = (
        f"Heights upwards from z = 0{_datum(mechanism.assembly)}; of all parts in the list."
    )
    notes = [shown, heights_from]
    if not mechanism.drawing.number:
        notes.append(f"Files of drawings begin with {mechanism.name}-.")
    places = [
        f"{axis.name} ({number(axis.at.real - axes[0].at.real)}, {number(axis.at.imag - axes[0].at.imag)})"
        for axis in axes[1:]
    ]
    fixed = [f"Fixed axes, X and Y from {axes[0].name}: {', '.join(places)}."] if places else []
    return notes + fixed
