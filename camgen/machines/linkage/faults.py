"""What is wrong between the tables of a linkage that are right one by one."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterator, Sequence

from camgen.errors import Fault, counted
from camgen.machine import model as m
from camgen.machines import included as inc
from camgen.machines.linkage import (
    cycloids,
    freewheels,
    motors,
    pens,
    planets,
    ratchets,
    sheets,
)
from camgen.machines.linkage import springs as coils
from camgen.machines.linkage import tables as t
from camgen.machines.linkage.drawing_faults import drawing_faults, shape_faults
from camgen.machines.linkage.spec import LinkageSpec
from camgen.machines.linkage.weights import under_faults, weight_faults
from camgen.machines.loads.fitted_motor import model_faults
from camgen.parts.counterweights import NAME
from camgen.parts.generator import webs
from camgen.parts.sides import PREFIX as FAR
from camgen.spec import unknown

_LEAST_GAP = 2.0  # mm, between the second plates of two sides, that a spacer fills


def faults(spec: LinkageSpec) -> Sequence[Fault]:
    """What is wrong between keys that are right one by one."""
    return [
        *_table_faults(spec),
        *_layer_faults(spec),
        *_making_faults(spec),
        *_thread_faults(spec),
        *_side_faults(spec),
        *_drive_faults(spec),
    ]


def _table_faults(spec: LinkageSpec) -> Iterator[Fault]:
    """Of bodies, joints, gears, springs and outputs, before anything is made of them."""
    for k, row in enumerate(spec.planets):
        yield from planets.faults(("planets", k), row, spec.points, spec.links)
    yield from drawing_faults(spec.diagram)
    if not spec.wanted:
        right = "missing: [[output]] with a name and a point or link: its path or angle is judged"
        yield Fault(("output",), "", right)
    yield from ratchets.faults(spec.diagram, spec.springs)
    links = spec.diagram.links
    joints = spec.diagram.names_of_joints()
    yield from coils.faults(spec.springs, links, _turning(spec), [*links, *joints])
    on_shafts = spec.freewheels, spec.links, spec.gears, spec.drive, spec.making
    yield from freewheels.faults(*on_shafts)


def _turning(spec: LinkageSpec) -> list[str]:
    """What may turn all round: drives, cams, gears and what else has teeth or slots."""
    return [
        *(each.link for each in spec.drives),
        *(cam.cam for cam in spec.cams),
        *(name for row in (*spec.diagram.pairs, *spec.ratchets) for name in (row.a, row.b)),
        *(name for row in spec.cycloids for name in (row.crank, row.output) if name),
    ]


def _layer_faults(spec: LinkageSpec) -> Iterator[Fault]:
    """Names in [layers] of nothing that lies on a level, and where a counterweight may lie."""
    links = spec.diagram.links
    lying = [link for link in links if link != m.GROUND]
    lying += webs.further(links, spec.drive.link, [slot.pin for slot in spec.slots], spec.making)
    lying += [*spec.diagram.levels_of_joints(), *coils.names(spec.springs)]
    lying += [title for title, *_ in spec.diagram.returns.values()]
    if spec.counterweight is not None:
        yield from weight_faults(spec.counterweight, spec.drive, spec.masses, lying)
        if spec.layers.get(NAME) == 0:
            yield from under_faults(spec.counterweight, spec.making)
        lying.append(NAME)
    for name, level in spec.layers.items():
        if name not in lying:
            yield unknown(("layers", name), name, lying)
        if not level and name != NAME:
            right = "1 or more: 0, under the plate, is for a counterweight"
            yield Fault(("layers", name), "0", right)


def _making_faults(spec: LinkageSpec) -> Iterator[Fault]:
    """Of [parts] and [laser]: shapes, sheets, shafts, pins and eccentrics of this machine."""
    making = spec.making
    yield from making.faults(spec.diagram.links, spec.print.nozzle, spec.allowed.min_wall)
    grooves = sum(cam.closure == "groove" for cam in spec.cams)
    yield from sheets.faults(making, spec.laser, len(spec.slides), grooves)
    drive = spec.drive.link
    if making.shaft == "interrupted" and {drive, m.GROUND} <= spec.links.keys():
        yield from webs.faults(spec.links, spec.points, drive, [slot.pin for slot in spec.slots])
    hung = {point for _, *both in spec.diagram.returns.values() for point in both}
    for key, named, points in (
        ("pins", making.pins, {*spec.diagram.points, *hung}),
        ("discs", making.discs or (), spec.points),
    ):
        for name in named:
            if name not in points:
                yield unknown(("parts", key, name), name, points)
    yield from _eccentric_faults(spec)
    if making.shaft_key:
        for name, beside in (("[[include]]", spec.includes), ("[[freewheel]]", spec.freewheels)):
            if beside:
                right = f"false beside {name}, whose shaft has a flat"
                yield Fault(("parts", "shaft_key"), "true", right)


def _thread_faults(spec: LinkageSpec) -> Iterator[Fault]:
    """Of the posts that a thread runs round."""
    threaded = [point for each in spec.wanted for point in each.thread or ()]
    posts = spec.making.thread_post_sizes
    if threaded and spec.making.thread_posts is None:
        yield from posts.faults(spec.print.nozzle, spec.making.head)
    for name in posts.diameters:
        if name not in threaded:
            path = ("parts", "thread_posts", "diameters", name)
            yield Fault(path, "", "a point of a thread")


def _drive_faults(spec: LinkageSpec) -> Iterator[Fault]:
    """Of motors, their programs and pens, of a walk, and of what is included."""
    if spec.walk is not None:
        yield from spec.walk.faults(spec.wanted)
    of_one_motor = {
        "include": bool(spec.includes),
        "freewheel": bool(spec.freewheels),
        "planets": bool(spec.planets),
        "cycloid": bool(spec.cycloids),
        "counterweight": spec.counterweight is not None,
        "motor": spec.motor is not None and isinstance(spec.drive, t.SlidingDrive),
    }
    yield from motors.faults(spec.diagram, spec.making, of_one_motor)
    yield from model_faults(spec.motor, spec.making)
    if spec.pen is None:
        yield from motors.program_faults(spec.diagram.drives)
    else:
        yield from pens.faults(spec.pen, spec.diagram)
    if not spec.includes:
        return
    if spec.drive.segments:
        right = "no segments beside [[include]]: an included machine turns evenly with the shaft"
        found = counted(len(spec.drive.segments), "segment")
        yield Fault(("drive", "segment"), found, right)
    yield from inc.faults(spec.includes, spec.host)


def _eccentric_faults(spec: LinkageSpec) -> Iterator[Fault]:
    """Eccentrics of cycloidal drives without a size, and second discs."""
    for k, row in enumerate(spec.cycloids):
        own = ("cycloid", k), row, spec.cycloids, spec.points, spec.links
        yield from cycloids.faults(*own)
        shaft = spec.diagram.pivot(row.crank) if row.crank in spec.links else None
        if row.at in (spec.making.discs or ()) or not {shaft, row.at} <= spec.points.keys():
            continue
        off = abs(spec.diagram.at(row.at) - spec.diagram.at(shaft or ""))
        bore = spec.making.shaft_diameter + spec.print.press_clearance
        least = math.ceil(2 * (off + spec.allowed.min_wall) + bore)
        right = f"missing: the diameter of the eccentric round the shaft, {least} mm or more"
        yield Fault(("parts", "discs", row.at), "", right)


def _side_faults(spec: LinkageSpec) -> Iterator[Fault]:
    """Why there cannot be two sides, and soles without a foot."""
    making = spec.making
    feet = {each.point for each in spec.wanted}
    for name, shape in making.shapes.items():
        if shape.sole_diameter is not None and feet.isdisjoint(spec.links.get(name, ())):
            right = f"no value here: no point of {name} is an [[output]], so it has no foot"
            yield Fault(("parts", name, "sole_diameter"), f"{shape.sole_diameter:g}", right)
    if making.sides == 1:
        if making.battery is not None:
            right = "no table here, or parts.sides = 2: the battery lies under the far side's plate"
            yield Fault(("parts", "battery"), "", right)
        if making.side_gap:
            right = "no value here, or parts.sides = 2: it is the gap between two sides"
            yield Fault(("parts", "side_gap"), f"{making.side_gap:g}", right)
        return
    if 0 < making.side_gap < _LEAST_GAP:
        right = f"0, or at least {_LEAST_GAP:g} mm, for a spacer"
        yield Fault(("parts", "side_gap"), f"{making.side_gap:g}", right)
    key = ("parts", "sides")
    if making.plates == 1:
        yield Fault(
            key, "2", "1, or parts.plates = 2 beside it: both second plates lie back to back"
        )
    for name, beside in (
        ("[[include]]", spec.includes),
        ("[[spring]]", spec.springs),
        ("[counterweight]", spec.counterweight),
    ):
        if beside:
            yield Fault(key, "2", f"1 beside {name}, which only a machine of one side has")
    outputs = {each.name for each in spec.wanted}
    for table, names in (("links", {*spec.links}), ("output", outputs)):
        for name in sorted(name for name in names if f"{FAR}_{name}" in names):
            right = f"another name: the {name} of the far side has this one"
            yield Fault((table, f"{FAR}_{name}"), "", right)


def faults_beside(
    spec: LinkageSpec, before: LinkageSpec, changed: Collection[str]
) -> Sequence[Fault]:
    """Of other lengths alone: whether links can have them."""
    same_keys = spec.lengths.keys() == before.lengths.keys()
    if changed != {"lengths"} or not same_keys or spec.includes:
        return faults(spec)
    others = (key for key, length in spec.lengths.items() if length != before.lengths[key])
    ends = [{*(t.pair(key) or ())} for key in others]
    links = {
        name: points
        for name, points in spec.links.items()
        if any(both.issubset(points) for both in ends)
    }
    return list(shape_faults(spec.diagram, links))
