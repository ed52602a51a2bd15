"""The one interface: a mechanism is a frozen record whose fields are its spec and which answers some questions as data.

machine()              its bodies, joints, drive, loads and outputs
motion(theta, order)   the wanted output
parts()                what to make
mounts(), poses(theta) which part stands on which body, and so where it is
features()             on what of its parts the joints are measured
contacts()             which parts pass by each other
limits()               closed-form design checks, as findings
study()                named numbers, curves and tables for the report
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import cached_property, reduce
from operator import getitem
from typing import TYPE_CHECKING, ClassVar, Self

import numpy as np
from numpy.typing import ArrayLike

from camgen.errors import DesignError
from camgen.findings import Finding, NotJudged
from camgen.geometry.outlines import Floats
from camgen.machine.features import (
    Apart,
    Asked,
    Balance,
    CamOutline,
    Eye,
    Feature,
    Mount,
    Moved,
    PartPose,
    StandIn,
    Strand,
    heights,
)
from camgen.machine.joining import Module
from camgen.machine.model import GROUND, Cam, Machine, Pose
from camgen.machine.run import Lazy, Run, solve
from camgen.machines.assembly import Fixing, order
from camgen.machines.free_play import of_pins
from camgen.machines.loads.applied import applied
from camgen.machines.loads.journals import Journal, Post, journals
from camgen.machines.loads.pins import stronger
from camgen.machines.loads.rubbing import rough
from camgen.machines.loads.tables import Bears, Drives, Weight
from camgen.machines.loads.weights import weighed
from camgen.parts.catalogue import DENSITY, Bearing, Bought
from camgen.parts.part import Part
from camgen.parts.sheets import why_not
from camgen.spec import Spec, validate
from camgen.study import Sketch, Study, Table

if TYPE_CHECKING:
    from camgen.parts.set_screws import SetScrewHub
    from camgen.parts.springs import Mounted


class Mechanism(Spec, ABC):
    """Base of all mechanisms; theta is the input angle, rad, counter-clockwise."""

    load: Weight | None = None
    fixed: ClassVar[str] = (
        "pressed and glued"  # how parts go together that do not turn on each other
    )
    frame_part: ClassVar[str] = ""  # name of the flat part that stands still under all others

    @abstractmethod
    def machine(self) -> Machine:
        """The model that this is, as wanted and with exact parts; theta as above."""

    @cached_property
    def model(self) -> Machine:
        """The same with the loads that the spec applies, made once."""
        machine = self.machine()
        if self.load is None or not self.load.on:
            return machine
        return replace(machine, loads=(*machine.loads, *applied(self, machine)))

    def solve(self, theta: ArrayLike, order: int = 2) -> Run:
        """The machine at theta, (n,) rad, with derivatives up to the order: outputs, rates, poses, forces, play.

        Its forces are those of the report: see `loaded`.
        """
        return solve(self.model, theta, order, self.loaded)

    def loaded(self) -> Machine:
        """The model with all that it bears: loads, springs and gravity of the spec, masses of its solids, friction in its joints.

        DesignError where a linkage's solids cannot be made.
        """
        return rough(weighed(self).machine, self.journals(), self.load)

    @abstractmethod
    def motion(self, theta: Floats, order: int = 0) -> Floats:
        """Wanted output and its derivatives to theta, (n,); rad or mm."""

    def reachable(self, theta: Floats) -> Floats:
        """Output that exact parts give: the wanted one, less what the spec itself implies (undercut), (n,)."""
        return self.motion(theta)

    @abstractmethod
    def parts(self) -> Sequence[Part]:
        """Distinct parts, with counts."""

    def course(self, phase: Floats) -> Floats:
        """The model's theta at a phase of its period, (n,) rad: the same, unless its drive goes to and fro."""
        return phase

    @cached_property
    def _exact(self) -> Machine:
        """The model as exact parts move it: cams that the spec undercuts give what they can."""
        laws = {name: cam.meant.given for name, cam in self.outlines().items() if cam.meant.given}
        joints = [
            replace(j, law=laws[j.name]) if isinstance(j, Cam) and j.name in laws else j
            for j in self.model.joints
        ]
        return replace(self.model, joints=tuple(joints)) if laws else self.model

    def outlines(self) -> dict[str, CamOutline]:
        """The first outline of each cam, by the name of its joint."""
        return {
            each.joint: each for each in reversed(self.features()) if isinstance(each, CamOutline)
        }

    def courses(self, theta: Floats) -> Mapping[str, Pose]:
        """Pose of each body of the model at theta, (n,) rad, as exact parts move it; worked out when asked for."""
        run = solve(self._exact, self.course(np.asarray(theta, float)), 0)
        return Lazy((GROUND, *(body.name for body in run.machine.moving)), run.pose)

    def poses(self, theta: Floats) -> Mapping[str, Sequence[PartPose]]:
        """Poses of each part's copies, in the order of their mounts, by name; theta: (n,) rad."""
        return self._placed(self.courses(theta))

    def _placed(self, courses: Mapping[str, Pose]) -> dict[str, list[PartPose]]:
        found: dict[str, list[PartPose]] = {part.name: [] for part in self.parts()}
        for mount in self.mounts():
            body = courses[mount.body]
            place = body.place + np.exp(1j * body.angle) * mount.at
            found[mount.part].append(
                PartPose(place, body.angle + mount.turned, mount.flipped, mount.z)
            )
        return found

    def contacts(self) -> Sequence[Apart]:
        """Which parts pass by each other without a joint."""
        return ()

    def features(self) -> Sequence[Feature]:
        """On what of its parts the machine's joints are measured."""
        return ()

    def mounts(self) -> Sequence[Mount]:
        """Where every copy of every part stands on the machine's bodies."""
        return ()

    def asked(self) -> Sequence[Asked]:
        """What is asked of the machine's outputs."""
        return ()

    @abstractmethod
    def limits(self) -> Sequence[Finding]:
        """Closed-form design checks; raises DesignError where no such mechanism exists."""

    def unpressed(self) -> Sequence[NotJudged]:
        """Of cams that are closed by force those of which nothing says what presses them."""
        return ()

    def forecast(self) -> Sequence[Finding]:
        """The same, and what else is known of the files before they are made; DesignError where they cannot be."""
        return [*self.limits(), *of_pins(self)]

    def proven(self) -> Self:
        """Itself, whose limits all hold; DesignError with the first that fails."""
        failed = next((finding for finding in self.limits() if not finding.ok), None)
        if failed is not None:
            raise DesignError(
                failed.code,
                failed.measured,
                failed.limit,
                failed.unit,
                failed.where,
                failed.message,
            )
        return self

    @abstractmethod
    def study(self) -> Study:
        """Named numbers, curves and tables for the report."""

    def figures(self) -> Mapping[str, float]:
        """The study's named numbers alone."""
        return self.study().numbers

    @classmethod
    def prepare(cls, many: Sequence[Self]) -> None:
        """Find together, where that is quicker, what each of many variants needs for its limits and figures."""

    @property
    def speed(self) -> float:
        """Speed of the input shaft, rad/s, below 0 where it turns clockwise; nan where the spec gives none."""
        motor = getattr(self, "motor", None)
        return math.nan if motor is None else float(motor.speed_rpm) * math.tau / 60

    @property
    def density(self) -> float:
        """Of what is printed, kg/m^3, its filling as it is."""
        return 1e3 * (self.material.density or DENSITY[self.material.name]) * self.material.infill

    @property
    def drives(self) -> Drives | None:
        """What the motor can give, as the spec says it."""
        motor = getattr(self, "motor", None)
        return motor if isinstance(motor, Drives) else None

    @property
    def shaft_needed(self) -> float | None:
        """How far a motor's shaft has to reach over its face, mm; None where none is part of the machine."""
        return None

    @property
    def motor_frame(self) -> str:
        """The motor's frame, such as "nema-17"; "" where it has none."""
        return ""

    @property
    def hub(self) -> SetScrewHub | None:
        """The hub that a set screw holds on the shaft that drives."""
        return None

    @property
    def roller_bearing(self) -> Bearing | None:
        """The ball bearing that is a follower's tip."""
        return None

    @property
    def arm_stiffness(self) -> float | None:
        """Of a follower's arm from its pivot to its tip, by its outline, N m/rad."""
        return None

    @property
    def return_spring(self) -> Mounted | None:
        """The spring that holds a follower on its cam: one that is a part, or one to be wound that does what the spec asks."""
        if self.spring_asked is None:
            return None
        from camgen.parts.springs import wound

        return wound(*self.spring_asked)

    def mounted_springs(self) -> Mapping[str, Mounted]:
        """All its springs by their names in findings."""
        spring = self.return_spring
        if spring is None:
            return {}
        return {"return spring" if spring.made else "return spring, to be wound": spring}

    @property
    def spring_asked(self) -> tuple[float, float, float] | None:
        """Rate, N/mm, least pull, N, and travel, mm, of one that the spec asks for and that is no part."""
        return None

    @property
    def balance(self) -> Balance | None:
        """What the solids of a crank with a counterweight are held to; None of a machine without one."""
        return None

    def balances(self) -> Sequence[Balance]:
        """That, and those of included machines."""
        return () if self.balance is None else (self.balance,)

    def strands(self) -> Sequence[Strand]:
        """Threads that run from post to post."""
        return ()

    def journals(self) -> Mapping[str, Journal]:
        """The plain bearings of its pins, by joint."""
        return journals(
            self.model, self.features(), self.parts(), self.mounts(), self.material.name
        )

    def posts(self) -> Sequence[Post]:
        """Its pins that only a spring or a roller bends."""
        return ()

    def stronger(self, pin: Journal) -> str:
        """What makes a pin bear more, by the spec's keys."""
        return stronger("parts", getattr(self, "making", None), pin)

    def bears(self, joint: str) -> Bears:
        """What the spec says of a joint's materials."""
        allowed = getattr(self, "allowed", None)
        return allowed if isinstance(allowed, Bears) else Bears()

    @property
    def angle_name(self) -> str:
        """What theta is called in findings: a cam's angle where one turns, else the crank's."""
        cams = any(isinstance(feature, CamOutline) for feature in self.features())
        return "cam angle" if cams else "crank angle"

    @property
    def range(self) -> tuple[float, float]:
        """Least and greatest theta, rad: of a drive that goes to and fro less than a turn."""
        return 0.0, math.tau

    @property
    def shown_turns(self) -> int:
        """Turns of the drive after which all of it is where it was, as far as it is shown."""
        return 1

    @property
    def sense(self) -> int:
        """Sense in which theta runs: -1 where the input shaft turns clockwise."""
        return -1 if self.speed < 0 else 1

    def found(self) -> Mapping[str, object]:
        """What the spec leaves open and camgen found, by dotted keys; DesignError where there is nothing to be found."""
        return {"material.density": self.material.density or DENSITY[self.material.name]}

    def resolved(self) -> Self:
        """The same with everything filled in that was found: a spec that makes the same files."""
        data = self.model_dump(by_alias=True, exclude_none=True)
        for key, value in self.found().items():
            *tables, last = key.split(".")
            reduce(getitem, tables, data)[last] = value
        return validate(type(self), data)

    def fixings(self) -> Sequence[tuple[complex, float]]:
        """Core holes in the underside of its frame, at z = 0, by which it is screwed on: place on the ground and diameter, mm."""
        return ()

    def stand_ins(self) -> Sequence[StandIn]:
        """What is not made but in the way: unless a mechanism says more, each cam's round tip, as high as its part."""
        found = []
        for cam in self.features():
            if (
                isinstance(cam, CamOutline)
                and isinstance(cam.tip, Eye)
                and cam.tip.diameter
                and not (cam.own or cam.inside)
            ):
                found.append(self._tip(cam, cam.tip))
        return found

    def _tip(self, cam: CamOutline, tip: Eye) -> StandIn:
        """A tip, as high as the cam that it touches."""
        part, joint = (
            next(part for part in self.parts() if part.name == cam.part),
            self.model.joint(cam.joint),
        )
        mount = [mount for mount in self.mounts() if mount.part == cam.part][cam.copy]
        assert isinstance(joint, Cam), f"{cam.joint} is no cam"
        layer = part.layers[part.cut]
        disc = (tip.at, tip.diameter / 2, *heights(mount, part.thickness, layer.z0, layer.z1))
        return StandIn(f"tip on {cam.part}-{1 + cam.copy}", joint.follower, (disc,), rolls=True)

    def moved(self) -> Moved:
        """What the sweep needs."""
        pairs, tolerance = (*self.contacts(), *self.features()), self.accuracy.chord_tolerance
        return Moved(
            self.mounts(),
            self.courses,
            pairs,
            self.stand_ins(),
            self.running_gap,
            tolerance,
            self.angle_name,
        )

    @property
    def running_gap(self) -> float:
        """What bodies that move past each other keep, mm: of the play on a side what a coarse print leaves, less facets."""
        return max(0.0, 0.8 * self.print.slide_clearance / 2 - 2 * self.accuracy.chord_tolerance)

    def printed(self) -> Sequence[Part]:
        """Parts that are laid out on plates: not what is bought, or turned, or cut of a sheet."""
        return [
            part for part in self.parts() if part.made == "printed" and not self.cut_of_sheet(part)
        ]

    def cut_of_sheet(self, part: Part) -> bool:
        """Whether a part is cut of the laser's sheet."""
        return self.laser is not None and not why_not(part, self.laser.thickness)

    def steps(self) -> Table:
        """In which order it goes together, and where: unless a machine says more, by height."""
        press, slide = self.print.press_clearance, self.print.slide_clearance
        fixing = Fixing((press + slide) / 2 if press < slide else -math.inf, self.fixed)
        return self.sprung_steps(
            order(self.parts(), self.mounts(), self.poses(np.zeros(1)), self.features(), fixing)
        )

    def sprung_steps(self, table: Table, module: Module | None = None) -> Table:
        """Steps of assembly with those of its springs; module: how it stands in the machine whose steps they are."""
        return table

    def spring_sketches(self) -> Sequence[Sketch]:
        """Its springs as the report draws them in motion."""
        return ()

    def idle(self) -> Sequence[str]:
        """Keys that were set and say nothing of this machine, dotted."""
        return ()

    def beforehand(self, kinds: int) -> str:
        """What to say before a run that takes long, of so many kinds of files; nothing where it does not."""
        return ""

    def remarks(self) -> Sequence[str]:
        """What a build prints beside its findings."""
        return ()

    def texts(self) -> Mapping[str, str]:
        """Further text files of the folder, by what follows the spec's name in theirs."""
        return {}

    def recovered(self, theta: Floats, motion: Mapping[str, Floats]) -> Study:
        """What follows from the motion recovered from each kind of file, (n,) over a whole turn, both ends included."""
        return Study()

    def bought(self) -> Sequence[Bought]:
        """What is bought, by its standard; a spring that the spec asks for and no part of the machine holds is wound."""
        springs = self.mounted_springs().items()
        return tuple(
            replace(spring.bought, name=name) for name, spring in springs if not spring.made
        )
