"""Wheels of a linkage that are not round: both on one level, each on its link's shaft."""

from __future__ import annotations

import math
from dataclasses import dataclass

from camgen.geometry.outlines import Contour
from camgen.machine import model as m
from camgen.numerics import Floats, Points
from camgen.parts.generator.wheels import EdgeDrive, Wheel
from camgen.parts.wheels.noncircular import NoncircularPair


@dataclass(frozen=True)
class NoncircularDrive(EdgeDrive):
    """A pair of a machine, drawn as t = 0."""

    wish: NoncircularPair
    kind = "noncircular"
    remedy = "put the shafts further apart, or use more teeth"

    @property
    def pair(self) -> NoncircularPair:
        """Both wheels."""
        return self.wish

    @property
    def wheels(self) -> tuple[Wheel, Wheel]:
        """On their shafts."""
        high = self.pair.rack.addendum * self.pair.module
        links = {self.joint.cam: "driver", self.joint.follower: "driven"}
        first, second = (
            Wheel(self.level, link, self.pair.reach(wheel)[1] + high, f"wheel of {link}")  # type: ignore[arg-type]
            for link, wheel in links.items()
        )
        return first, second

    def edges(self, machine: m.Machine) -> tuple[Contour, Contour]:
        """Of both wheels about their axes, as drawn at theta = 0."""
        line = self.line(machine)
        return self.pair.driver.moved(line), self.pair.driven.moved(line)

    def curves(self, t: Floats) -> list[tuple[str, Points]]:
        """Centrodes of both links over the driver's angle, (n,) rad, complex mm from the driver's axis, along the line of both."""
        centrodes = self.pair.centrodes
        joint = self.joint
        whole = t / self.pair.centrodes.law.mean  # a turn of the driven wheel
        driven = centrodes.distance + centrodes.driven(whole)
        return [(joint.cam, centrodes.driver(t)), (joint.follower, driven)]

    def table(self, link: str) -> tuple[str, ...]:
        """Data of a wheel as a workshop reads them beside its drawing."""
        pair = self.pair
        driver = link == self.joint.cam
        teeth = (pair.teeth, pair.driven_teeth)
        own, mate = teeth if driver else teeth[::-1]
        least, most = pair.reach("driver" if driver else "driven")
        return (
            f"{own} teeth, module {pair.module:.6g}, pressure angle {math.degrees(pair.pressure):g} deg",
            f"pitch curve {pair.centrodes.length * own / pair.teeth:.3f} long, from R {least:.3f} to R {most:.3f}",
            f"mate {mate} teeth at {pair.centrodes.distance:.3f}, backlash {pair.backlash:g}",
        )
