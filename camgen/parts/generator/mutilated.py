"""Mutilated gears of a linkage: both wheels on one level, each on its link's shaft."""

from __future__ import annotations

import math
from dataclasses import dataclass

from camgen.geometry.outlines import Contour
from camgen.machine import model as m
from camgen.parts.generator.wheels import EdgeDrive, Wheel
from camgen.parts.wheels.mutilated import MutilatedLaw


@dataclass(frozen=True)
class MutilatedDrive(EdgeDrive):
    """A pair of a machine, drawn in the middle of a rest."""

    wish: MutilatedLaw
    kind = "mutilated"
    remedy = "put the shafts further apart, or use more teeth"

    @property
    def law(self) -> MutilatedLaw:
        """Of both wheels."""
        return self.wish

    @property
    def wheels(self) -> tuple[Wheel, Wheel]:
        """On their shafts."""
        pair = self.law.pair
        tips = {self.joint.cam: pair.driver.tip, self.joint.follower: pair.wheel.tip}
        first, second = (
            Wheel(self.level, link, tip, f"wheel of {link}") for link, tip in tips.items()
        )
        return first, second

    def edges(self, machine: m.Machine) -> tuple[Contour, Contour]:
        """Of both wheels about their axes, as drawn at theta = 0; mirrored where the driver turns clockwise."""
        line = self.line(machine)
        pair = self.law.pair
        mirrored = self.law.way < 0
        driver, wheel = (
            edge.moved(mirror=mirrored).counter_clockwise().moved(line)
            for edge in (pair.driver_edge(), pair.wheel_edge())
        )
        return driver, wheel

    def table(self, link: str) -> tuple[str, ...]:
        """Data of a wheel as a workshop reads them beside its drawing."""
        pair = self.law.pair
        teeth = f"module {pair.module:.6g}, pressure angle {math.degrees(pair.pressure):g} deg"
        mate = f"mate at {pair.distance:.3f}, backlash {pair.backlash:g}"
        if link == self.joint.cam:
            return (
                f"{pair.pushing} teeth of {pair.teeth[0]}, {teeth}",
                f"tips R {pair.driver.tip:.3f}, of the first R {pair.first.tip:.3f}, of the last R {pair.last.tip:.3f}",
                f"rim R {pair.lock:.3f} over {math.degrees(math.tau - 2 * pair.half):.2f} deg; {mate}",
            )
        return (
            f"{pair.teeth[1]} teeth, {teeth}",
            f"{pair.stations} blocks of {pair.joined} teeth with hollows R {pair.hollow:.3f}",
            f"tips R {pair.wheel.tip:.3f}; {mate}",
        )
