"""Any planar machine from a spec: `mechanism = "linkage"`.

    [points]   roughly where things are at theta = 0          [lengths]  exact distances
    [links]    bodies by the points that they carry           [drive]    what turns: all round, or to and fro over range_deg
    signal     one number over theta that an output gives: an angle, a place, or a coordinate of a path

theta is the driven link's angle from its drawn position. Of a drive that goes to and fro the poses are asked for over a
whole period: a harmonic motion from the least angle of the range to the greatest and back.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Annotated, Self

import numpy as np
from numpy.typing import ArrayLike
from pydantic import Field

from camgen.errors import DesignError, Fault
from camgen.findings import Finding, at_least
from camgen.geometry.outlines import Floats
from camgen.machine import model as m
from camgen.machine.contacts import Pose
from camgen.machine.features import Asked, Feature, Mount
from camgen.machine.run import Run, solve
from camgen.machine.study import Study
from camgen.machine.turning import folds, refuse_folds, refuse_partial, turn
from camgen.machines.linkage import figures, wheels
from camgen.machines.linkage import tables as t
from camgen.machines.linkage.bodies import Bodies, placed
from camgen.machines.linkage.drawing import Drawing
from camgen.machines.linkage.layout import Layout
from camgen.machines.linkage.stacking import laid
from camgen.machines.mechanism import Mechanism
from camgen.parts.catalogue import DENSITY, Bought, turning_text
from camgen.parts.part import Part
from camgen.spec import Output, unknown

_SAMPLES = np.linspace(0, math.tau, 1440, endpoint=False)  # of a period, at which links are looked at for their levels


@dataclass(frozen=True)
class Signal:
    """One number of an output: column's name without its unit, unit for people ("deg" or "mm").

    of: the output's name; turned: unit complex that the output is divided by before its real part is taken.
    """

    name: str
    unit: str
    of: str
    turned: complex = 1.0

    @property
    def scale(self) -> float:
        """How many of the unit one rad or mm is."""
        return math.degrees(1) if self.unit == "deg" else 1.0

    def rows(self, run: Run) -> Floats:
        """It with its derivatives to theta, (order + 1, n) rad or mm."""
        return np.asarray(np.real(run.derivatives(self.of) / self.turned))


class Linkage(Mechanism):
    """Spec and answers of a linkage; angles rad, places mm."""


    points: t.Points
    links: t.Links
    lengths: t.Lengths = Field({}, description='mm, exact distances of two points of one link, "A-B"')
    drive: t.Drive
    slides: Annotated[tuple[t.Slide, ...], Field(alias="slide")] = ()
    slots: Annotated[tuple[t.Slot, ...], Field(alias="slot")] = ()
    gears: Annotated[tuple[t.Gear, ...], Field(alias="gear")] = ()
    cams: Annotated[tuple[t.Cam, ...], Field(alias="cam")] = ()
    wanted: Annotated[tuple[t.Wanted, ...], Field(alias="output", min_length=1, max_length=50)]
    output: Annotated[Output, Field(alias="files", description="how files are written; no unit")] = Output()
    masses: dict[t.Name, t.Masses] = {}
    making: Annotated[t.Parts, Field(alias="parts")] = t.Parts.model_validate({})
    layers: t.Layers = Field({}, description="level of a link, cam or gear, 1 is the lowest; what is left out is found")
    allowed: Annotated[t.Limits, Field(alias="limits")] = t.Limits.model_validate({})

    def faults(self) -> Sequence[Fault]:
        """What is wrong between keys that are right one by one."""
        moving = [link for link in self.links if link != m.GROUND]
        found = self._drawing.faults()
        lying = [*moving, *self._drawing.levels_of_joints()]
        found += [unknown(f"layers.{name}", name, lying) for name in self.layers if name not in lying]
        return [*found, *self.making.faults(self.links, self.print.nozzle)]

    # ---- motion -----------------------------------------------------------------------------------------------------

    @cached_property
    def _drawing(self) -> Drawing:
        return Drawing(
            self.points, self.links, self.lengths, self.drive, self.slides, self.slots, self.gears, self.cams, self.wanted,
            self.masses,
        )  # fmt: skip

    def machine(self) -> m.Machine:
        """The model with its parts' masses and the play of their fits; DesignError where no such parts can be made."""
        return self._fitted

    @cached_property
    def _fitted(self) -> m.Machine:
        density = 1e3 * (self.material.density or DENSITY[self.material.name])
        return self.bodies.weighed(density, self.masses)

    @cached_property
    def chain(self) -> m.Machine:
        """The model, closed as drawn; DesignError where it does not close, is loose or locked, or cannot move as asked.

        Each pin has the play of one that is pressed into one of its links.
        """
        play = self.print.slide_clearance + self.print.press_clearance
        chain = self._drawing.machine()
        kinds = m.Pin | m.Slot | m.Slide
        joints = tuple(replace(joint, clearance=play) if isinstance(joint, kinds) else joint for joint in chain.joints)
        chain = replace(chain, joints=joints)
        if self.drive.range_deg is None:
            refuse_partial(chain)
        else:
            self._refuse_range(chain)
        refuse_folds(chain, *self.range)
        return chain

    def _refuse_range(self, machine: m.Machine) -> None:
        """Raise DesignError where the range asked for is more than the chain has."""
        can = turn(machine)
        low, high = math.degrees(can.low), math.degrees(can.high)
        asked, said = self.drive.range_deg or (0.0, 0.0), f"it closes from {low:.6g} to {high:.6g} deg"
        for value, limit, beyond, joints in ((asked[0], low, asked[0] < low, can.ends[0]), (asked[1], high, asked[1] > high,
                                             can.ends[1])):  # fmt: skip
            if not can.full and beyond:
                where = f"joint {', '.join(joints)}: {said}"
                raise DesignError("drive.range_deg", value, limit, "deg", where, "ask for a range within it")

    @property
    def speed(self) -> float:
        """Speed of the driven link, rad/s; of one that goes to and fro its greatest, a period being a turn."""
        return self.drive.speed_rpm * math.tau / 60

    @property
    def range(self) -> tuple[float, float]:
        """Least and greatest theta, rad."""
        low, high = self.drive.range_deg or (0.0, 360.0)
        return math.radians(low), math.radians(high)

    def course(self, phase: Floats) -> Floats:
        """theta at a phase of the period, (n,) rad: the same where the drive turns."""
        if self.drive.range_deg is None:
            return phase
        low, high = self.range
        return np.asarray(low + (high - low) * (1 - np.cos(phase)) / 2)

    def solve(self, theta: ArrayLike, order: int = 2) -> Run:
        """The machine at theta, (n,) rad."""
        return solve(self.chain, theta, order)

    @cached_property
    def signals(self) -> tuple[Signal, ...]:
        """What the outputs give, as single numbers."""

        found = []
        for output in self.chain.outputs:
            if isinstance(output.of, m.Path):
                found += [Signal(f"{output.name}_x", "mm", output.name), Signal(f"{output.name}_y", "mm", output.name, 1j)]
            else:
                unit = "deg" if isinstance(output.of, m.Angle) else "mm"
                found.append(Signal(output.name, unit, output.name))
        return tuple(found)

    def motion(self, theta: Floats, order: int = 0) -> Floats:
        """The first signal over a period, rad or mm; its derivatives are to theta."""
        found: Floats = self.signals[0].rows(self.solve(self.course(np.asarray(theta, float)), order))[order]
        return found

    # ---- bodies -----------------------------------------------------------------------------------------------------

    @cached_property
    def bodies(self) -> Bodies:
        """What is made of it; levels that [layers] leaves open are found."""
        lacking = self.lacking()
        if lacking is not None:
            raise lacking
        return Bodies(laid(self._layout, self.solve(self.course(_SAMPLES), 0)))

    @property
    def _layout(self) -> Layout:
        cams = {Drawing.cam_name(cam): cam for cam in self.cams}
        gears = {Drawing.gear_name(gear): gear for gear in self.gears}
        return Layout(
            self.chain, self.drive.link, self.making, self.print, self.allowed.min_wall, self.layers, {}, cams, gears
        )  # fmt: skip

    def lacking(self) -> DesignError | None:
        """What to say of joints of which no bodies are made yet."""
        return self._layout.lacking()

    def found(self) -> Mapping[str, object]:
        """Levels, and what every mechanism fills in."""
        return {**super().found(), **{f"layers.{link}": level for link, level in self.bodies.layout.given.items()}}

    def resolved(self) -> Self:
        """The same with its levels, on the same chain."""
        found = super().resolved()
        found.__dict__["chain"] = self.chain  # cached: nothing that it depends on was filled in
        return found

    def parts(self) -> Sequence[Part]:
        """Ground plate, links, pins, spacers, shaft and collar; DesignError where there are other joints."""
        return self.bodies.parts

    def poses(self, theta: Floats) -> Mapping[str, Sequence[Pose]]:
        """Every copy on its body; theta is the phase of the period."""
        run, found = self.solve(self.course(np.asarray(theta, float)), 0), dict[str, list[Pose]]()
        still = m.Pose(np.zeros(run.theta.shape, complex), np.zeros(run.theta.shape))
        poses = {body.name: still if body.name == m.GROUND else run.pose(body.name) for body in run.machine.bodies}
        for mount in self.bodies.mounts:
            found.setdefault(mount.part, []).append(Pose(*placed(mount, poses[mount.body]), mount.flipped, mount.z))
        for sketch in figures.paths(self):
            found[sketch.name] = [Pose(still.angle, still.place)]
        return found

    def features(self) -> Sequence[Feature]:
        """Holes and pins of the joints."""
        return self._features

    @cached_property
    def _features(self) -> Sequence[Feature]:
        return self.bodies.features()

    def mounts(self) -> Sequence[Mount]:
        """Every copy of every part on its body."""
        return self.bodies.mounts

    def asked(self) -> Sequence[Asked]:
        """The play that is borne."""
        lash = {"mm": self.allowed.lash, "rad": math.radians(self.allowed.lash_deg)}
        return [Asked(output.name, lash=lash[output.unit]) for output in self.chain.outputs]

    def printed(self) -> Sequence[Part]:
        """All that are printed."""
        return [part for part in self.parts() if part.made == "printed"]

    def bought(self) -> Sequence[Bought]:
        """Drive and screws."""
        p = self.making
        screw = f"for a core hole of {p.mount_diameter:g}, at most {p.base_thickness:g} into the plate"
        drive = f"{turning_text(self.drive.speed_rpm)}, for a shaft of {p.shaft_diameter:g} with a flat {p.shaft_flat:g} deep"
        return (Bought("drive", "", drive, 1), Bought("screw of the plate, from behind", "", screw, 2))

    def limits(self) -> Sequence[Finding]:
        """How near each loop comes to a fold."""
        low, high = self.range
        found = []
        for fold in folds(self.chain, low, high):
            angle = math.degrees(math.asin(min(1.0, abs(fold.determinant))))
            found.append(at_least(
                "TRANSMISSION_ANGLE", angle, self.allowed.transmission_angle_deg, "deg",
                f"joints {', '.join(fold.joints)}, {math.degrees(fold.theta):.2f} deg",
                "least over the motion; at 0 the chain folds and may go on either way",
            ))  # fmt: skip
        return [*found, *wheels.limits(self._layout.tips, self.allowed.pressure_angle_deg)]

    def study(self) -> Study:
        """Extremes, strokes, speeds and accelerations of the outputs, curves and paths, the class of a four-bar."""
        return figures.study(self)

