"""What the report shows moving: the picture in the plane, and the machine in three dimensions."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from camgen.errors import DesignError
from camgen.geometry.arcs import bulges, fit_arcs
from camgen.geometry.facets import reach
from camgen.geometry.outlines import Contour, extent, rectangle
from camgen.machine.features import PartPose, heights
from camgen.machine.model import Cam, Output, Path, Pose, unit_of
from camgen.machine.run import solve
from camgen.machines.mechanism import Mechanism
from camgen.numerics import Floats, Points
from camgen.parts.assembly import Assembly
from camgen.parts.coils import spring_sketches
from camgen.parts.shafts import OF_BEARING, OF_SHAFT
from camgen.pipeline.bought_shapes import Thing, bought_shapes
from camgen.pipeline.shopping import bought_things, steps_of_assembly
from camgen.report.animation import Animation, Body
from camgen.report.colours import part_colour
from camgen.study import HoleLabel, Plate, Prism, Scene, Sketch, Step, Table

if TYPE_CHECKING:
    from camgen.files.gltf import Shape, Track
    from camgen.geometry.mesh import Mesh
    from camgen.judge.scene import Flight
    from camgen.parts.part import Part

_DRAWN = 0.01  # mm, arc tolerance of the moving picture
_FRAMES = 120  # of the moving picture
_SEEN = 0.02  # mm, chord tolerance of solids that are only looked at
_OF_SIZE = 1e-6  # the same of their size: no picture shows more
_FRAMES_3D = 360  # fewer leave 0.07 mm at a sharp reversal


def _turn(mechanism: Mechanism, frames: int) -> Floats:
    """Angles of so many frames a turn, rad, as time goes on."""
    cycle = mechanism.assembly.cycle
    if cycle.turns > 1:
        whole = cycle.turns * math.tau
        return np.asarray(cycle.sense * np.linspace(0, whole, cycle.turns * frames, endpoint=False))
    theta = np.linspace(0, math.tau, frames, endpoint=False)
    return np.mod(-theta, math.tau) if cycle.sense < 0 else theta


def animation(mechanism: Mechanism, sketches: Sequence[Sketch] | None = None) -> Animation:
    """One turn of the exact mechanism, as the report shows it moving; sketches: those of its study, where that is known."""
    theta = _turn(mechanism, _FRAMES)
    assembly = mechanism.assembly
    poses = assembly.poses(theta)
    courses = assembly.courses(theta)
    bodies = []
    for part in assembly.parts:
        region = part.region
        contours: Sequence[Contour] = region.outer, *region.holes
        if any(pose.upright for pose in poses[part.name]):
            contours = [_edge_on(part)]
        rings = [bulges(fit_arcs(contour, _DRAWN)) for contour in contours]
        stands = any(pose.standing for pose in poses[part.name])
        bodies.append(Body(part.name, poses[part.name], rings, upright=stands))
    shapes = mechanism.study().sketches if sketches is None else sketches
    for s in (*shapes, *spring_sketches(assembly.coils, assembly.courses)):
        body = courses[s.body]
        course = None if s.course is None else s.course(theta)
        place = body.place + (s.upright.origin if s.upright else 0j)
        pose = [PartPose(place, body.angle)]
        drawn = Body(s.name, pose, (), s.strokes, s.circles, course, _heights(assembly, s))
        bodies.append(replace(drawn, upright=s.upright is not None, swell=s.swell))
    moving = _with_output(mechanism, theta, bodies)
    cycle = assembly.cycle
    if not cycle.to_and_fro:
        return moving
    least, greatest = (math.degrees(end) for end in cycle.range)
    return replace(moving, stroke=(least, greatest), drive_name=cycle.name, drive_unit=cycle.unit)


def _with_output(mechanism: Mechanism, theta: Floats, bodies: Sequence[Body]) -> Animation:
    """Its bodies in motion, and what the output does."""
    assembly = mechanism.assembly
    if not mechanism.model.outputs:
        return Animation(theta, bodies, mechanism.motion(theta), "output", "mm")
    output = mechanism.model.outputs[0]
    unit, scale = unit_of(output)
    if not assembly.features:
        shown = scale * mechanism.motion(assembly.cycle.theta(theta))
        return Animation(theta, bodies, shown, output.name, unit)
    name = f"{output.name} x" if isinstance(output.of, Path) else output.name
    return Animation(
        theta,
        bodies,
        scale * _reachable(mechanism, output, theta),
        name,
        unit,
        assembly.cycle.turns,
    )


def _edge_on(part: Part) -> Contour:
    """What is seen from above of a part that stands upright, in its own x and, downwards, its thickness."""
    low, high = extent([layer.region.outer for layer in part.layers])
    return rectangle(complex(low.real, -part.thickness), complex(high.real))


def _heights(assembly: Assembly, sketch: Sketch) -> tuple[float, float] | None:
    """From where to where a sketch reaches, mm: a line among the parts of a body in the middle of the largest of them; a body
    without parts, such as the follower of cams alone, along all that are there, or the layer that it runs on. In a plane that stands, along its normal."""
    if sketch.upright is not None:
        return -sketch.upright.outer, -sketch.upright.inner
    if sketch.z is not None:
        return sketch.z, sketch.z
    for outline in assembly.outlines.values():
        joint = assembly.machine.joint(outline.joint)
        runs = isinstance(joint, Cam) and joint.follower == sketch.body
        if outline.layer is not None and runs:
            part = assembly.by_name[outline.part]
            at = part.layers[outline.layer[0]]
            mount = next(each for each in assembly.mounts if each.part == part.name)
            return heights(mount, part.thickness, at.z0, at.z1)
    parts = {part.name: part for part in assembly.parts}
    lying = [mount for mount in assembly.mounts if not mount.upright]
    plates = [(mount, parts[mount.part], parts[mount.part].drawn) for mount in lying]
    reach = [heights(mount, part.thickness, at.z0, at.z1) for mount, part, at in plates]
    level = sketch.level or sketch.body
    own = [
        (at.region.area, sum(high) / 2)
        for (mount, _, at), high in zip(plates, reach, strict=True)
        if mount.body == level
    ]
    if own:
        middle = max(own)[1]
        return middle, middle
    return (min(low for low, _ in reach), max(high for _, high in reach)) if reach else None


def _reachable(mechanism: Mechanism, output: Output, theta: Floats) -> Floats:
    """What exact parts give of the wanted motion: less what the spec itself implies (undercut), (n,)."""
    assembly = mechanism.assembly
    wanted = mechanism.motion(theta)
    if assembly.exact is assembly.machine:
        return wanted
    at = assembly.cycle.theta(theta)
    nominal, exact = (
        np.real(solve(each, at, 0)[output.name]) for each in (assembly.machine, assembly.exact)
    )
    return np.asarray(wanted - (nominal - exact))


def scene(mechanism: Mechanism, plates: Sequence[Plate]) -> Scene:
    """The machine in three dimensions, from coarse solids of its exact parts; plates: what was laid out."""
    from camgen.files.gltf import glb

    assembly = mechanism.assembly
    shapes, tracks = solids(mechanism, _FRAMES_3D)
    order = [copy for track in tracks for copy, _, _ in track.copies]
    table = steps_of_assembly(mechanism)
    made = glb(mechanism.name, shapes, tracks, assembly.cycle.turns, assembly.down)
    return Scene(
        made,
        order,
        plates,
        _with_what_is_bought(mechanism, table),
        table.title if assembly.work else Scene.work,
        [hole_labels(part) for part in assembly.parts],
    )


def _with_what_is_bought(mechanism: Mechanism, table: Table) -> Sequence[Step]:
    """Steps of cams that are made alone with their shaft, key, rings, bearings and rollers in the pictures; of other machines as they
    are. Outer rings come with the bearings that they close."""
    things = bought_things(mechanism)
    if all(thing.shaft is None for thing in things):
        return table.steps
    shapes = bought_shapes(mechanism, things)
    rings, bearings = (
        next((thing for thing in shapes if thing.name == name), None)
        for name in (OF_BEARING, OF_SHAFT)
    )
    if rings and bearings:
        middle = _middle(shapes[bearings])
        inner_first = sorted(shapes[rings], key=lambda ring: abs(ring[0][1] - middle))
        shapes[rings] = inner_first[:2]
        shapes[bearings] = [*shapes[bearings], *inner_first[2:]]
    found = {(thing.name, thing.size): each for thing, each in shapes.items()}
    return [
        replace(step, shapes=[*_prisms(found.get((str(row[1]), str(row[2])), []))])
        for step, row in zip(table.steps, table.rows, strict=True)
    ]


def _middle(things: Sequence[Thing]) -> float:
    """Half way from the lowest to the highest end of things, mm."""
    ends = [end for thing in things for _, *span in thing for end in span]
    return (min(ends) + max(ends)) / 2 if ends else 0.0


def _prisms(things: Sequence[Thing]) -> Iterator[Prism]:
    """Outsides of things, as pictures of steps show them."""
    from shapely.geometry.polygon import orient

    for thing in things:
        for face, low, high in thing:
            corners = np.array(orient(face).exterior.coords)[:-1] @ np.array([1, 1j])
            yield corners.tolist(), low, high


def solids(mechanism: Mechanism, frames: int) -> tuple[list[Shape], list[Track]]:
    """Coarse solids of the parts, and where their copies are at so many frames a turn."""
    from camgen.files.gltf import Shape, Track
    from camgen.geometry.mesh import placing

    parts = mechanism.assembly.parts
    courses = mechanism.assembly.courses(_turn(mechanism, frames))
    planes = mechanism.assembly.planes
    number = {part.name: k for k, part in enumerate(parts)}
    shapes = [
        Shape(part.name, coarse(part, mechanism.accuracy.chord_tolerance), part_colour(k))
        for k, part in enumerate(parts)
    ]
    copies: Counter[str] = Counter()
    bodies: dict[str, list[tuple[str, int, Floats]]] = {}
    for mount in mechanism.assembly.mounts:
        copies[mount.part] += 1
        k = number[mount.part]
        at = complex(mount.at)
        thick = parts[k].thickness
        stands = placing(mount.angle, at, mount.z, thick, mount.flipped, mount.upright)
        bodies.setdefault(mount.body, []).append((f"{mount.part}-{copies[mount.part]}", k, stands))
    tracks = [
        Track(
            name,
            *_over(courses[name], frames * mechanism.assembly.cycle.turns, planes.get(name, 0j)),
            copies_of_body,
            name in planes,
        )
        for name, copies_of_body in bodies.items()
    ]
    return shapes, tracks


def rendered(mechanism: Mechanism, kind: str) -> bytes:
    """The machine drawn without a graphics card: "picture" as PNG, "animation" one turn as GIF."""
    from camgen.report import render

    draw = render.picture if kind == "picture" else render.film
    return draw(*solids(mechanism, _FRAMES), animation(mechanism), mechanism.assembly.down)


def hole_labels(part: Part) -> list[HoleLabel]:
    """The holes of a part as its drawing names them."""
    from camgen.files.dimensions import holes_of

    layer = part.drawn
    middle = (layer.z0 + layer.z1) / 2
    names = {name for name, _ in part.points}
    return [
        HoleLabel(label, hole.shape, (hole.middle.real, hole.middle.imag, middle), label in names)
        for label, hole in holes_of(layer.region.holes, part.points)
    ]


def flights(mechanism: Mechanism) -> dict[str, Flight]:
    """Where each copy of each part is over the animation, by its name."""
    from camgen.judge.scene import Flight

    theta = _turn(mechanism, _FRAMES_3D)
    poses = mechanism.assembly.poses(np.append(theta, theta[0]))
    flights_of = {}
    for part in mechanism.assembly.parts:
        low, high = extent([layer.region.outer for layer in part.layers])
        reach = (
            max(abs(complex(x, y)) for x in (low.real, high.real) for y in (low.imag, high.imag))
            + part.thickness
        )
        for k, pose in enumerate(poses[part.name]):
            frames = len(theta) + 1
            angle = np.broadcast_to(pose.angle, frames)
            place = np.broadcast_to(np.asarray(pose.place, complex), frames)
            flights_of[f"{part.name}-{k + 1}"] = Flight(
                part.name,
                angle,
                place,
                pose.z,
                pose.flipped,
                part.thickness,
                reach,
                pose.upright,
                pose.standing,
            )
    return flights_of


def _over(pose: Pose, frames: int, origin: complex) -> tuple[Floats, Points]:
    """Angle and place of a body at every frame; origin: of its plane."""
    return np.broadcast_to(pose.angle, frames), np.broadcast_to(
        np.asarray(pose.place + origin, complex), frames
    )


def coarse(part: Part, tolerance: float) -> Mesh:
    """The part's solid with fewer facets; where coarse outlines would touch, with those of its files."""
    from camgen.parts.solids import solid

    try:
        return solid(part, max(_SEEN, tolerance, _OF_SIZE * reach(part.region.outer)))
    except DesignError:
        return solid(part, tolerance)
