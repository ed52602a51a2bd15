"""Gears as their files have them: both outlines through the contact engine, over every tooth of either wheel."""

from __future__ import annotations

import cmath
import math
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from camgen.findings import Finding, Where, at_most
from camgen.geometry.rings import Floats, Ring
from camgen.judge.pairs import Body, OutlinePair, PairMotion, pivots_apart
from camgen.machine.features import Mount

_A_TOOTH = 16  # angles of the driver


@dataclass(frozen=True)
class MeshedWheel:
    """A wheel as its file has it: outline in the part's frame, mm, on its body, which turns about `pivot` in its own frame."""

    part: str
    ring: Ring
    teeth: int
    mount: Mount
    pivot: complex  # mm

    @property
    def about_pivot(self) -> Ring:
        """The outline as the body has it, from the pivot, mm."""
        sense = -1 if self.mount.flipped else 1
        turn = sense * cmath.exp(1j * self.mount.angle)
        return self.ring.moved(turn, self.mount.at - self.pivot, mirror=self.mount.flipped)

    def degrees(self, z: complex) -> float:
        """Direction in the part's own frame of a point that is seen from the pivot in the body's, deg from 0 to 360."""
        turned = (z + self.pivot - self.mount.at) * cmath.exp(-1j * self.mount.angle)
        own = -turned.conjugate() if self.mount.flipped else turned
        return math.degrees(cmath.phase(own)) % 360


@dataclass(frozen=True)
class Meshing:
    """Two wheels of a Gear, seen from what carries both axes: angle of b = ratio * angle of a + start, rad.

    line: from a's axis to b's, mm; base: radius of b's base circle, mm.
    """

    joint: str
    a: MeshedWheel
    b: MeshedWheel
    line: complex
    ratio: float
    start: float
    base: float

    @property
    def angles(self) -> Floats:
        """Of a, (n,) rad: all teeth of the wheel that has more."""
        most = max(self.a.teeth, self.b.teeth)
        return np.linspace(0.0, math.tau * most / self.a.teeth, _A_TOOTH * most + 1)

    def motion(self) -> PairMotion:
        """Where b is free."""
        driver = Body([self.a.about_pivot])
        driven = Body([self.b.about_pivot])
        return OutlinePair(driver, driven, pivots_apart(self.line)).follow(self.angles, self.start)


def judge_mesh(meshing: Meshing, off: float, where: Where) -> Finding:
    """GEAR_MESH: by how much the flanks are off turning evenly, peak to peak along the line of action, mm.

    off: mm, how far an outline may lie from the one that is meant, on either side; where: the files of both wheels.
    """
    motion = meshing.motion()
    samples = motion.samples
    limit = 4 * off  # a flank of either wheel lies in or out by so much
    jammed = ~samples.free | ~(samples.play > 0)
    if jammed.any():
        theta = float(samples.theta[int(np.argmax(jammed))])
        remark = "the teeth are in each other's way"
        return at_most("GEAR_MESH", math.inf, limit, "mm", _at(meshing, theta, where), remark)
    even = meshing.ratio * samples.theta
    flanks = {"low": samples.low - even, "high": samples.high - even}
    side: Literal["low", "high"] = (
        "low" if np.ptp(flanks["low"]) > np.ptp(flanks["high"]) else "high"
    )
    course = flanks[side]
    k = int(np.argmax(np.abs(course - np.median(course))))
    point = complex(motion.touch(samples, side).point[k])
    theta = float(samples.theta[k])
    phi = float((samples.low if side == "low" else samples.high)[k])
    on_a = meshing.a.degrees((point + meshing.line) * cmath.exp(-1j * theta))
    on_b = meshing.b.degrees(point * cmath.exp(-1j * phi))
    remark = (
        f"both flanks over all teeth, along the line of action, peak to peak; most at {on_a:.1f} deg of {meshing.a.part}, "
        f"{on_b:.1f} deg of {meshing.b.part}; play {meshing.base * samples.play.min():.4f} to "
        f"{meshing.base * samples.play.max():.4f} mm"
    )
    measured = meshing.base * float(np.ptp(course))
    return at_most("GEAR_MESH", measured, limit, "mm", _at(meshing, theta, where), remark)


def _at(meshing: Meshing, theta: float, where: Where) -> Where:
    return replace(where, joint=meshing.joint, theta=theta, angle=f"{meshing.a.part} at")
