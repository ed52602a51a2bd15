"""Geneva drives of a linkage: the slotted wheel and the disc that locks it on one level, with the roller on the crank's pin."""

from __future__ import annotations

import cmath
from dataclasses import dataclass

import numpy as np

from camgen.geometry.outlines import Contour
from camgen.machine import model as m
from camgen.parts.generator.wheels import Roller, Wheel, level_of, pivot
from camgen.parts.wheels.geneva import Geneva


@dataclass(frozen=True)
class GenevaDrive:
    """A Geneva drive of a machine."""

    joint: m.Cam
    geneva: Geneva
    point: str  # of the crank, where its roller is
    remedy = (
        "put the shafts further apart, or use a smaller pin_radius"  # where a wheel has no room
    )

    @property
    def level(self) -> str:
        """Of all its parts."""
        return level_of(self.joint.name)

    @property
    def thing(self) -> str:
        """What it is in messages."""
        return f"geneva {self.joint.name}"

    def part_on(self, link: str) -> str:
        """Name of the part on the shaft of one of its links: the slotted wheel, or the disc that locks it."""
        return f"{'lock' if link == self.joint.cam else 'geneva'}-{self.level}"

    @property
    def wheels(self) -> tuple[Wheel, Wheel]:
        """Disc and slotted wheel on their shafts."""
        lock = self.geneva.lock
        wheel = self.geneva.rim
        return (
            Wheel(self.level, self.joint.cam, lock, f"lock of {self.joint.cam}"),
            Wheel(self.level, self.joint.follower, wheel, f"Geneva wheel of {self.joint.follower}"),
        )

    @property
    def roller(self) -> Roller:
        """On the crank's pin."""
        about = f"Geneva drive {self.joint.name}"
        joint = self.joint
        lock = self.wheels[0]
        return Roller(self.level, joint.name, joint.cam, self.point, self.geneva.pin, lock, about)

    def edges(self, machine: m.Machine) -> tuple[Contour, Contour]:
        """Of disc and wheel about their axes, as drawn at theta = 0."""
        joint = self.joint
        axes = [pivot(machine, link)[1] for link in (joint.cam, joint.follower)]
        line = (axes[1] - axes[0]) / abs(axes[1] - axes[0])
        angle = float(machine.start_of(joint.cam).angle) - joint.phase
        slot = -line * cmath.exp(1j * float(joint.law(np.array(angle), 0)))
        return (
            self.geneva.lock_disc().moved(line * cmath.exp(1j * angle)),
            self.geneva.wheel().moved(slot),
        )
