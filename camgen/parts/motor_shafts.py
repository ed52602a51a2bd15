"""How long the shaft of a motor may be: what passes over its end would meet a longer one."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from camgen.geometry.distances import inside
from camgen.geometry.facets import facet_contour
from camgen.geometry.outlines import Points
from camgen.machine.features import PartPose, heights
from camgen.parts.assembly import Assembly
from camgen.parts.motors import SHAFTS
from camgen.parts.part import Part
from camgen.tolerances import SAME_POINT

_SAMPLES = 181  # of a turn: a link of the toy that walks goes some 3 mm from one to the next
_CHORD = 0.1  # mm, of outlines
_LONGEST = max(length for _, length in SHAFTS.values())  # mm, of any motor
_AROUND = np.array([0.0, *np.exp(1j * math.tau * np.arange(8) / 8)])  # of a shaft's end


def with_shaft_limit(assembly: Assembly, play: float) -> Assembly:
    """The assembly, its motor's shaft limited by what passes over its end at a play, mm; as it is where no motor in use reaches it."""
    motor = assembly.motor
    if motor.reach is None:
        return assembly
    poses = assembly.poses(np.linspace(0, math.tau, _SAMPLES))
    shafts = [at for thing in assembly.stand_ins if thing.drives for at, *_ in thing.discs]
    over = [
        (low, part.name)
        for part in assembly.parts
        for pose in poses[part.name]
        for at in shafts
        for low in _undersides(part, pose, at, motor.shaft / 2, motor.reach)
    ]
    low, name = min(over, default=(math.inf, ""))
    most = round(max(motor.reach, low - play), 6)
    usual = SHAFTS.get(motor.frame, (0.0, _LONGEST))[1]
    if most > usual - SAME_POINT:
        return assembly
    longer = "what is longer" if most <= motor.reach else f"what is longer than {most:.4g}"
    cut = f"file off {longer}, for {name} passes over its end"
    bought = [
        replace(each, details=cut) if each.role == "drive" else each for each in assembly.bought
    ]
    return replace(assembly, motor=replace(motor, most=most, under=name), bought=bought)


def _undersides(
    part: Part, pose: PartPose, at: complex, radius: float, above: float
) -> Iterator[float]:
    """Undersides of a copy's layers, mm, not below a height, that lie at some time over the end of a shaft at a place."""
    if pose.upright or pose.standing:
        return
    end = np.asarray(at + radius * _AROUND, complex)
    for layer in part.layers:
        low, _ = heights(pose, part.thickness, layer.z0, layer.z1)
        if low < above - SAME_POINT:
            continue
        points = _seen(pose, end)
        covered = inside(points, facet_contour(layer.region.outer, _CHORD))
        for hole in layer.region.holes:
            covered &= ~inside(points, facet_contour(hole, _CHORD))
        if covered.any():
            yield low


def _seen(pose: PartPose, points: Points) -> Points:
    """Places of the ground, (k,) complex mm, in the part's frame, (n k,); none where the machine does not close."""
    own = (points[:, None] - pose.place) * np.exp(-1j * pose.angle)
    own = np.asarray(own[np.isfinite(own)], complex)
    return -own.conjugate() if pose.flipped else own
