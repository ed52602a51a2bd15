"""A walk as a GIF: the machine in its plane over a floor with marks; how it leans to the side is not shown."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from camgen.files import mjcf
from camgen.files.gltf import Shape, Track
from camgen.geometry.mesh import Mesh
from camgen.machine.features import PartPose
from camgen.machine.model import GROUND, Pose
from camgen.machines.mechanism import Mechanism
from camgen.numerics import Floats, Points
from camgen.pipeline.shown import solids
from camgen.report import render
from camgen.report.animation import Animation, Body
from camgen.simulation.gait import Gait

_TURNS = 2  # that are shown
_FRAMES = 36  # of a turn
_MARK = 50.0  # mm, length of a mark on the floor
_THICK = 3.0  # mm, of the floor
_BESIDE = 30.0  # mm, of floor beside the machine
_COLOURS = ("#e6e9e7", "#c3cac6")
_FACES = [[0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1]]
_FACES += [[2, 3, 7], [2, 7, 6], [0, 2, 6], [0, 6, 4], [1, 5, 7], [1, 7, 3]]


def film(mechanism: Mechanism, model: mjcf.Model, walk: Gait) -> bytes:
    """The first turns of a run, as time goes on."""
    assembly = mechanism.assembly
    turns = min(float(_TURNS), max(walk.turns, 0.1))
    end = np.interp(turns * math.tau, np.maximum.accumulate(walk.crank), walk.time)
    time = np.linspace(0.0, end, _TURNS * _FRAMES)

    def at(values: Floats) -> Floats:
        return np.interp(time, walk.time, values)

    ahead = 1j * complex(*model.down[:2])
    place: Points = ahead * (at(walk.place[:, 0]) + 1j * at(walk.place[:, 2]))
    tilt = at(walk.tilt)
    rate = float(assembly.exact.drives[0].law(np.zeros(1), 1)[0])
    crank = math.copysign(1.0, model.motor.speed) * at(walk.crank)
    courses = assembly.courses(crank / rate)
    shapes, tracks = solids(mechanism, 1)
    moved = [
        Track(track.name, *_carried(courses[track.name], place, tilt), track.copies)
        for track in tracks
    ]
    floor = _floor(moved, shapes, ahead)
    still = np.zeros(len(time))
    origin = np.zeros(len(time), complex)
    under = [
        Track(each.name, still, origin, [(each.name, len(shapes) + k, np.eye(3, 4))])
        for k, each in enumerate(floor)
    ]
    theta = np.linspace(0, math.tau, len(time), endpoint=False)
    moving = Animation(theta, [Body(GROUND, [PartPose(place, tilt)])], turns=_TURNS)
    return render.film([*shapes, *floor], [*moved, *under], moving, model.down)


def _carried(pose: Pose, place: Points, tilt: Floats) -> tuple[Floats, Points]:
    """Angle and place of a body on a frame that moves."""
    angle = np.asarray(tilt + pose.angle)
    return angle, np.asarray(place + np.exp(1j * tilt) * pose.place)


def _floor(tracks: Sequence[Track], shapes: Sequence[Shape], ahead: complex) -> list[Shape]:
    """Marks of two colours, one after the other, under all places of the machine."""
    along = np.concatenate([np.real(track.place / ahead) for track in tracks])
    copies = [
        shapes[k].mesh.moved(transform).vertices
        for track in tracks
        for _, k, transform in track.copies
    ]
    vertices = np.concatenate(copies)
    reach = _BESIDE + float(np.median([np.abs(each[:, :2]).max() for each in copies]))
    first = math.floor((along.min() - reach) / _MARK)
    last = math.ceil((along.max() + reach) / _MARK)
    low = float(vertices[:, 2].min()) - _BESIDE
    high = float(vertices[:, 2].max()) + _BESIDE
    meshes = []
    for colour in range(len(_COLOURS)):
        marks = [
            _block(_MARK * k, (low, high), ahead)
            for k in range(first, last)
            if k % len(_COLOURS) == colour
        ]
        faces = [np.array(_FACES) + 8 * k for k in range(len(marks))]
        meshes.append(Mesh(np.concatenate(marks), np.concatenate(faces)))
    return [
        Shape(f"floor-{k}", mesh, colour)
        for k, (mesh, colour) in enumerate(zip(meshes, _COLOURS, strict=True))
    ]


def _block(begin: float, across: tuple[float, float], ahead: complex) -> Floats:
    """Corners of a mark, (8, 3) mm."""
    corners = []
    for x in (begin, begin + _MARK):
        for y in (-_THICK, 0.0):
            at = ahead * complex(x, y)
            corners += [[at.real, at.imag, z] for z in across]
    return np.array(corners)
