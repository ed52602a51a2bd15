"""Another machine on a layout's second plate. Where both shafts are in line they are joined, in one of two ways:

sleeve   it has its frame and its shaft; a sleeve joins both shafts
merged   it has neither: the plate takes the holes of its frame and what stands on that, at one height with the frame's upper
         side; the host's shaft goes on through the machine, and bores with a flat are turned to the flat that it has
"""

from __future__ import annotations

import cmath
import math
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from camgen.errors import DesignError
from camgen.geometry.outlines import Arc, Contour, Line, Region
from camgen.machine.features import Eye, Faces, Feature, Mount, PartPose, mapped
from camgen.machine.joining import Module
from camgen.machine.model import GROUND
from camgen.parts.assembly import Assembly, Shaft, renamed
from camgen.parts.generator.connections import MergedFrame, Sleeve
from camgen.parts.generator.layout import Layout
from camgen.parts.generator.plates import SECOND
from camgen.parts.generator.second_plate import SLEEVE, ceiling_height, sleeve_ends
from camgen.parts.generator.sizes import Parts
from camgen.parts.part import Layer, Part
from camgen.tolerances import SAME_POINT


@dataclass(frozen=True)
class UpperEnd:
    """The upper end of the host's shaft, and the second plate; mm, rad."""

    axis: complex | None  # on the ground; None where the shaft does not reach the second plate
    end: float  # where it ends in a sleeve
    angle: float  # of its link at theta = 0
    sizes: Parts  # of the host's parts
    shaft: str  # its part
    ceiling: float  # height of the plate's underside

    @property
    def top(self) -> float:
        """Height of the plate's upper side, mm."""
        return self.ceiling + self.sizes.base_thickness


@dataclass(frozen=True)
class Merging:
    """What becomes of an included machine's parts, by its own names."""

    turn: float  # of bores with a flat, rad
    shaft: str  # the host's
    shift: complex  # of its ground in the host's, mm


@dataclass(frozen=True)
class InLine:
    """How a machine is joined to the host's shaft: by a sleeve, or merged."""

    z: float  # mm, how far it is raised
    sleeve: Sleeve | None = None
    merging: Merging | None = None
    merged: MergedFrame | None = None  # what the plate takes


def upper_end(layout: Layout) -> UpperEnd | None:
    """Of the shaft that drives a layout, where it has a second plate."""
    if layout.second is None:
        return None
    point = layout.shaft_of(layout.driven)
    axis = layout.at(GROUND, point) if layout.in_second(point) else None
    shaft = "shaft" if layout.split_level(point) is None else f"shaft-{layout.upper_web}"
    angle = float(layout.machine.start_of(layout.driven).angle)
    return UpperEnd(
        axis, sleeve_ends(layout)[1], angle, layout.sizes, shaft, ceiling_height(layout)
    )


def in_line(made: Assembly, module: Module, host: UpperEnd, gap: float) -> InLine | None:
    """What joins a machine to the host's shaft, where both are in line; None where they are not. gap: between bodies, mm.

    They are merged where both shafts are alike and the frame is flat below the plate and shaft that both have.
    DesignError where no sleeve has room.
    """
    if made.shaft is None or host.axis is None:
        return None
    (pose,) = made.poses(np.array([module.phase]))[made.shaft.part]
    if abs(complex(pose.place[0]) + module.at - host.axis) > SAME_POINT:
        return None
    own = made.shaft
    sizes = host.sizes
    turn = float(pose.angle[0]) - host.angle
    if (own.diameter, own.flat) == (sizes.shaft_diameter, sizes.shaft_flat):
        found = _merged(made, own, pose, module.at, host)
        if found is not None:
            floor, merged = found
            merging = Merging(math.remainder(-turn, math.tau), host.shaft, module.at)
            return InLine(host.top - floor, merging=merging, merged=merged)
    room = min(mount.z for mount in made.mounts if mount.part != own.part) - pose.z - gap
    up = min(SLEEVE * own.diameter, room)
    if up < own.diameter / 2:
        remedy = "let it stand out further under its frame: a longer parts.shaft_length there"
        quantity = "room for a sleeve on the shaft"
        raise DesignError(quantity, up, own.diameter / 2, "mm", module.prefix, remedy)
    return InLine(host.end - pose.z, Sleeve(own.diameter, own.flat, turn, up))


def _merged(
    made: Assembly, own: Shaft, pose: PartPose, shift: complex, host: UpperEnd
) -> tuple[float, MergedFrame] | None:
    """How high the upper side of a machine's frame is over its underside, mm, and what the host's plate takes.

    None where something lies under the frame but shaft and collar, or where it is thicker than the plate. own, pose: its shaft, and where that is; shift: of its ground in the host's, mm.
    """
    if made.frame is None or made.stand_ins:
        return None
    frame = next(each for each in made.mounts if each.part == made.frame.part)
    if frame != Mount(frame.part, frame.body):
        return None
    own_parts = (frame.part, own.part, own.collar)
    lowest = min(mount.z for mount in made.mounts if mount.part not in own_parts)
    plate = made.by_name[frame.part]
    floor = plate.drawn.z1
    if lowest < 0 or floor > host.sizes.base_thickness or plate.drawn_layer:
        return None
    screws = [z for z, _ in made.frame.fixings]
    left_out = (complex(pose.place[0]), *screws)
    holes = tuple(
        hole.moved(1, shift)
        for hole in plate.layers[0].region.holes
        if _distance(_middle(hole), left_out) > 1e-3
    )
    above = tuple(
        Layer(each.region.moved(1, shift), each.z0 - floor, each.z1 - floor)
        for each in plate.layers[1:]
    )
    edges = [
        (piece.centre + shift, piece.radius)
        for piece in plate.layers[0].region.outer.pieces
        if isinstance(piece, Arc) and _distance(piece.centre, screws) > 1e-3
    ]
    arcs = [piece for hole in holes for piece in hole.pieces if isinstance(piece, Arc)]
    discs = (*edges, *((arc.centre, arc.radius + host.sizes.wall) for arc in arcs))
    top = pose.z + made.by_name[own.part].thickness - floor
    return floor, MergedFrame(discs, holes, above, top)


def _distance(place: complex, others: tuple[complex, ...] | list[complex]) -> float:
    """To the nearest of the others, mm."""
    return min(abs(place - other) for other in others)


def _middle(hole: Contour) -> complex:
    """Centre of a hole's first arc; of a slot its middle."""
    arcs = [piece.centre for piece in hole.pieces if isinstance(piece, Arc)]
    return sum(arcs) / len(arcs) if arcs else complex(hole.pieces[0].at(0.5))


# ---- the machine that is merged --------------------------------------------------------------------------------------


def merged(made: Assembly, module: Module, merging: Merging) -> Assembly:
    """A machine as it stands in another one, on that one's second plate and shaft: without frame, shaft and collar."""
    assert made.shaft is not None and made.frame is not None, "as in_line() gives them"
    plate = made.frame.part
    shaft = made.shaft.part
    left_out = (plate, shaft, made.shaft.collar)
    driven = next(mount.body for mount in made.mounts if mount.part == shaft)
    on_shaft = {mount.part: mount for mount in made.mounts if mount.body == driven}
    parts = [
        _with_bore(part, on_shaft[part.name], merging.turn) if part.name in on_shaft else part
        for part in made.parts
        if part.name not in left_out
    ]
    mounts = [mount for mount in made.mounts if mount.part not in left_out]
    own = renamed(replace(made, parts=parts, mounts=mounts), module)

    def on_host(_: str, value: Any) -> Any:
        if isinstance(value, Eye | Faces) and value.part == module.part(plate):
            return replace(value, part=SECOND, at=value.at + merging.shift)
        if isinstance(value, Eye) and value.part == module.part(shaft):
            return replace(value, part=merging.shaft)
        return value

    features: list[Feature] = [mapped(each, on_host) for each in own.features]
    return replace(own, features=features)


def _with_bore(part: Part, mount: Mount, turn: float) -> Part:
    """A part with its flat bore turned, where it has one: its holes about its own origin are those on the shaft; rad."""
    way = cmath.exp(1j * turn * (-1 if mount.flipped else 1))

    def bored(region: Region) -> Region:
        holes = (hole.moved(way) if _keyed(hole) else hole for hole in region.holes)
        return Region(region.outer, tuple(holes))

    layers = (replace(layer, region=bored(layer.region)) for layer in part.layers)
    return replace(part, layers=tuple(layers))


def _keyed(hole: Contour) -> bool:
    """Whether a hole is a circle about the origin with a flat."""
    arcs = [piece for piece in hole.pieces if isinstance(piece, Arc)]
    flats = [piece for piece in hole.pieces if isinstance(piece, Line)]
    return len(arcs) == len(flats) == 1 and abs(arcs[0].centre) < SAME_POINT
