"""A machine on another one's second plate and shaft: its own frame, shaft and collar are left out.

plate    takes the holes of the frame, and what stands on it; both have their upper sides at one height
shaft    goes on through that machine; bores with a flat are turned to the flat that it has
"""

from __future__ import annotations

import cmath
import math
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from camgen.geometry.outlines import Arc, Contour, Line, Region
from camgen.machine.features import Eye, Faces, Feature, Mount, mapped
from camgen.machine.joining import Module
from camgen.parts.assembly import Assembly
from camgen.parts.generator.joined import Merged
from camgen.parts.generator.plates import SECOND
from camgen.parts.part import Layer, Part
from camgen.tolerances import SAME_POINT

_SHAFT = "shaft"
_COLLAR = "collar"


@dataclass(frozen=True)
class Merging:
    """What becomes of an included machine's parts, by its own names. frame: what the plate takes the place of; turn: by which
    flats of bores turn, rad; shaft: name of the host's; shift: of its ground in the host's, mm."""

    frame: str
    turn: float
    shaft: str
    shift: complex

    def left(self, assembly: Assembly) -> Assembly:
        """What is left of the machine, with turned bores."""
        gone = (self.frame, _SHAFT, _COLLAR)
        driven = next(mount.body for mount in assembly.mounts if mount.part == _SHAFT)
        on = {mount.part: mount for mount in assembly.mounts if mount.body == driven}
        parts = [part for part in assembly.parts if part.name not in gone]
        bored = [self._turned(part, on[part.name]) if part.name in on else part for part in parts]
        return replace(
            assembly,
            parts=bored,
            mounts=[mount for mount in assembly.mounts if mount.part not in gone],
        )

    def _turned(self, part: Part, mount: Mount) -> Part:
        """A part with its flat bore turned, where it has one: its holes about its own origin are those on the shaft."""
        turn = cmath.exp(1j * self.turn * (-1 if mount.flipped else 1))

        def bored(region: Region) -> Region:
            return Region(
                region.outer,
                tuple(hole.moved(turn) if _keyed(hole) else hole for hole in region.holes),
            )

        return replace(
            part, layers=tuple(replace(layer, region=bored(layer.region)) for layer in part.layers)
        )

    def feature(self, feature: Feature, module: Module) -> Feature:
        """One of the whole, on the host's plate and shaft; module: the machine in the whole."""
        plate, shaft = module.part(self.frame), module.part(_SHAFT)

        def moved(_: str, value: Any) -> Any:
            if isinstance(value, Eye | Faces) and value.part == plate:
                return replace(value, part=SECOND, at=value.at + self.shift)
            return (
                replace(value, part=self.shaft)
                if isinstance(value, Eye) and value.part == shaft
                else value
            )

        return mapped(feature, moved)


def _keyed(hole: Contour) -> bool:
    """Whether a hole is a circle about the origin with a flat."""
    arcs = [piece for piece in hole.pieces if isinstance(piece, Arc)]
    flats = [piece for piece in hole.pieces if isinstance(piece, Line)]
    return len(arcs) == len(flats) == 1 and abs(arcs[0].centre) < SAME_POINT


def merging(
    made: Assembly,
    shift: complex,
    phase: float,
    angle: float,
    name: str,
    thickness: float,
    wall: float,
) -> tuple[Merging, Merged, float] | None:
    """How a machine with its shaft in line comes on the host's plate, what the plate takes, and how far its frame's underside is
    under the plate's upper side, mm; None where it cannot.

    shift: of its ground; phase, angle: of its shaft ahead, of the host's link, rad; name: of the host's shaft; thickness: of
    its plate, wall: round its holes, mm. Nothing may lie under the frame but shaft and collar, and it must be no thicker than
    the plate.
    """
    if made.frame is None or made.stand_ins:
        return None
    frame = next(each for each in made.mounts if each.part == made.frame.part)
    if frame != Mount(frame.part, frame.body):
        return None
    others = [mount for mount in made.mounts if mount.part not in (frame.part, _SHAFT, _COLLAR)]
    plate, shaft = made.by_name[frame.part], made.poses(np.array([phase]))[_SHAFT][0]
    floor = plate.layers[plate.cut].z1
    if min(mount.z for mount in others) < 0 or floor > thickness or plate.cut:
        return None
    axis, fixed = complex(shaft.place[0]), [z for z, _ in made.frame.fixings]
    outer = [
        (piece.centre, piece.radius)
        for piece in plate.layers[0].region.outer.pieces
        if isinstance(piece, Arc)
    ]
    hole_at = [(hole, _middle(hole)) for hole in plate.layers[0].region.holes]
    holes = tuple(
        hole.moved(1, shift)
        for hole, z in hole_at
        if min(abs(z - other) for other in (axis, *fixed)) > 1e-3
    )
    above = tuple(
        Layer(each.region.moved(1, shift), each.z0 - floor, each.z1 - floor)
        for each in plate.layers[1:]
    )
    turn = angle - float(shaft.angle[0])
    top = shaft.z + made.by_name[_SHAFT].thickness - floor
    edges = [
        (z + shift, radius) for z, radius in outer if min(abs(z - other) for other in fixed) > 1e-3
    ]
    arcs = [piece for hole in holes for piece in hole.pieces if isinstance(piece, Arc)]
    discs = (*edges, *((arc.centre, arc.radius + wall) for arc in arcs))
    return (
        Merging(frame.part, math.remainder(turn, math.tau), name, shift),
        Merged(discs, holes, above, top),
        floor,
    )


def _middle(hole: Contour) -> complex:
    """Centre of a hole's first arc; of a slot its middle."""
    arcs = [piece.centre for piece in hole.pieces if isinstance(piece, Arc)]
    return sum(arcs) / len(arcs) if arcs else complex(hole.pieces[0].at(0.5))
