"""Ratchets of a linkage: wheel and pawl on one level, each on its link's shaft; a spring of the linkage draws the pawl in."""

from __future__ import annotations

import cmath
import math
from dataclasses import dataclass

from camgen.geometry.outlines import Contour
from camgen.machine import model as m
from camgen.parts.generator.wheels import EdgeDrive, Wheel
from camgen.parts.wheels.ratchet import Pawl, PawlLaw


@dataclass(frozen=True)
class RatchetWish:
    """What is asked of a ratchet."""

    law: PawlLaw
    friction: float  # at which a tooth is to hold the pawl without its spring


@dataclass(frozen=True)
class RatchetDrive(EdgeDrive):
    """A ratchet of a machine; the pawl's boss is a hub."""

    wish: RatchetWish
    kind = "ratchet"
    remedy = "use a greater radius, or a smaller depth"

    @property
    def pawl(self) -> Pawl:
        """Its pawl."""
        return self.wish.law.pawl

    def part_on(self, link: str) -> str:
        """Name of the part on the shaft of one of its links."""
        return f"{'ratchet' if link == self.joint.cam else 'pawl'}-{self.level}"

    @property
    def wheels(self) -> tuple[Wheel, Wheel]:
        """Wheel and pawl on their shafts."""
        cam = self.joint.cam
        follower = self.joint.follower
        reach = max(abs(self.pawl.arm) + self.pawl.end, self.hub)
        return (
            Wheel(self.level, cam, self.pawl.wheel.tip, f"ratchet wheel of {cam}"),
            Wheel(self.level, follower, reach, f"pawl of {follower}"),
        )

    def turned(self, machine: m.Machine) -> float:
        """The wheel as drawn at theta = 0, from the seat in the sense in which it passes, rad."""
        return self.wish.law.way * float(machine.start_of(self.joint.cam).angle - self.joint.phase)

    def _frame(self, machine: m.Machine) -> complex:
        """From the axes of a wheel that passes counter-clockwise to the ground's, unit complex."""
        there = self.pawl.pivot / abs(self.pawl.pivot)
        return self.line(machine) / (there if self.wish.law.way > 0 else there.conjugate())

    def first_tip(self, machine: m.Machine) -> float:
        """Where a tip points as drawn at theta = 0, rad."""
        return cmath.phase(self._frame(machine)) + self.wish.law.way * self.turned(machine)

    def edges(self, machine: m.Machine) -> tuple[Contour, Contour]:
        """Of wheel and pawl about their axes, as drawn at theta = 0."""
        turned = self.turned(machine)
        lift = float(self.pawl.lift(turned))
        found = (
            self.pawl.wheel.outline().moved(cmath.exp(1j * turned)),
            self.pawl.outline(self.hub).moved(cmath.exp(1j * lift)),
        )
        frame = self._frame(machine)
        mirrored = self.wish.law.way < 0
        return found[0].moved(frame, mirror=mirrored), found[1].moved(frame, mirror=mirrored)

    def arm(self, machine: m.Machine) -> complex:
        """From the pivot to the middle of the pawl's end, in the axes of its link, mm."""
        arm = self.pawl.arm * cmath.exp(1j * float(self.pawl.lift(self.turned(machine))))
        if self.wish.law.way < 0:
            arm = arm.conjugate()
        start = float(machine.start_of(self.joint.follower).angle)
        return arm * self._frame(machine) * cmath.exp(-1j * start)

    def table(self, link: str) -> tuple[str, ...]:
        """Data of a part as a workshop reads them beside its drawing."""
        pawl = self.pawl
        wheel = pawl.wheel
        if link == self.joint.cam:
            return (
                f"{wheel.teeth} teeth, tips on R {wheel.tip:.3f}, roots on R {wheel.root:.3f}",
                f"pivot of the pawl at {abs(pawl.pivot):.3f}",
            )
        return (
            f"arm {abs(pawl.arm):.3f} to the middle of its end of R {pawl.end:g}",
            f"a tooth draws it in by {math.degrees(pawl.draw):.1f} deg",
        )
