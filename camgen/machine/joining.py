"""Several machines on one shaft as one machine: names with a prefix, the whole shifted on the ground and in phase."""

from __future__ import annotations

import cmath
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any, TypeVar

import numpy as np

from camgen.machine.features import (
    Demand,
    Edge,
    Eye,
    Faces,
    Flat,
    Mount,
    OwnTip,
    Ring,
    Teeth,
    mapped,
)
from camgen.machine.model import (
    GROUND,
    Along,
    Angle,
    Body,
    Cam,
    Clutch,
    Effort,
    Function,
    Gear,
    Gravity,
    Joint,
    Law,
    Load,
    Machine,
    Path,
    Pin,
    Place,
    Pose,
    bodies_of,
)
from camgen.machine.run import solve
from camgen.machine.targets import Lines
from camgen.numerics import Floats

T = TypeVar("T")

# that stand in others
_RECORDS = Angle | Along | Path | Cam | Edge | Eye | Faces | Flat | Gear | OwnTip | Ring | Teeth


@dataclass(frozen=True)
class Ahead:
    """A law that is so far ahead, rad: law(theta + phase)."""

    law: Law
    phase: float

    def __call__(self, theta: Floats, order: int = 0) -> Floats:
        """The order-th derivative at theta, (n,)."""
        return self.law(np.asarray(theta, float) + self.phase, order)


@dataclass(frozen=True)
class _Shifted:
    """A function of places on the ground, of those places less a shift, complex mm."""

    value: Any
    at: complex

    def __call__(self, *jets: Any) -> Floats:
        """Value with its derivatives."""
        value: Floats = self.value(
            *(np.concatenate([np.asarray(jet[:1]) - self.at, jet[1:]]) for jet in jets)
        )
        return value


@dataclass(frozen=True)
class Ride:
    """A body that is carried by a link of the host in place of its own joints: link = at + exp(i angle) * body."""

    body: str
    link: str
    at: complex  # mm
    angle: float  # rad


@dataclass(frozen=True)
class Module:
    """How one machine stands in another: its names get the prefix and "_", its parts' names the prefix and "-".

    What joins bodies that ride to the ground or to its own shaft is left out.
    """

    prefix: str
    at: complex = 0j  # its origin on the ground, mm
    phase: float = 0.0  # how far it is ahead of the shaft, rad
    z: float = 0.0  # how far it is raised, mm
    rides: tuple[Ride, ...] = ()  # bodies of it that links of the host carry
    shared: frozenset[str] = frozenset()  # parts that the host has too, under the same names

    def name(self, name: str) -> str:
        """Of a joint, a drive or an output."""
        return f"{self.prefix}_{name}"

    def body(self, name: str) -> str:
        """Of a body: the ground is the same for all."""
        ride = self.ride(name)
        return ride.link if ride else name if name == GROUND else self.name(name)

    def ride(self, body: str) -> Ride | None:
        """What carries a body in place of its own joints."""
        return next((ride for ride in self.rides if ride.body == body), None)

    def part(self, name: str) -> str:
        """Of a part or a sketch."""
        if name in self.shared:
            return name
        return f"{self.prefix.replace('_', '-')}-{name}"

    def machine(self, machine: Machine) -> Machine:
        """The same machine as it is in the whole."""
        run = solve(machine, [self.phase], 0)
        moving = [body for body in machine.moving if self.ride(body.name) is None]
        poses = {body.name: run.pose(body.name) for body in moving}
        dropped = self.lost(machine)
        return Machine(
            tuple(replace(body, name=self.name(body.name)) for body in moving),
            tuple(
                self._ahead(self.renamed(joint))
                for joint in machine.joints
                if joint.name not in dropped
            ),
            tuple(
                replace(self.renamed(d), law=Ahead(d.law, self.phase))
                for d in machine.drives
                if d.name not in dropped
            ),
            {
                self.name(name): Pose(complex(pose.place[0]) + self.at, float(pose.angle[0]))
                for name, pose in poses.items()
            },
            tuple(self._loaded(load) for load in machine.loads),
            tuple(self.renamed(output) for output in machine.outputs if output.name not in dropped),
            machine.speed,
        )

    def _ahead(self, joint: Joint) -> Joint:
        """A joint; a clutch, which knows theta, so far ahead."""
        if not isinstance(joint, Clutch):
            return joint
        return replace(
            joint,
            law=Ahead(joint.law, self.phase),
            apart=lambda theta: joint.apart(theta + self.phase),
        )

    def _loaded(self, load: Load) -> Load:
        """A load; one over theta so far ahead."""
        if isinstance(load, Effort):
            return replace(self.renamed(load), law=Ahead(load.law, self.phase))
        return load if isinstance(load, Gravity) else self.renamed(load)

    def lost(self, machine: Machine) -> set[str]:
        """Joints, drives and outputs that it has no more, since their bodies ride on others."""
        riders = {ride.body for ride in self.rides}
        if not riders:
            return set()
        fixed = riders | {GROUND, *(drive.body for drive in machine.drives)}
        joints = {
            each.name
            for each in machine.joints
            if riders & (bodies := set(bodies_of(each))) and bodies <= fixed
        }
        drives = {
            drive.name for drive in machine.drives if drive.body in riders or drive.slide in joints
        }
        outputs = {
            each.name
            for each in machine.outputs
            if isinstance(each.of, Along)
            and each.of.slide in joints
            or isinstance(each.of, Angle)
            and each.of.body in riders
        }
        return joints | drives | outputs

    def misfits(self, machine: Machine) -> list[str]:
        """Joints between a body that rides and one that moves by itself which are no pins: such cannot be carried over."""
        riders = {ride.body for ride in self.rides}
        dropped = self.lost(machine)
        return [
            each.name
            for each in machine.joints
            if each.name not in dropped
            and riders & set(bodies_of(each))
            and not isinstance(each, Pin)
        ]

    def renamed(self, record: T) -> T:
        """A joint, load, output or feature with the names and places that it has in the whole."""
        return mapped(record, self._renamed)

    def _renamed(self, key: str, value: Any) -> Any:
        """A value of a record, under its key."""
        if isinstance(value, Place):
            return self.place(value)
        if isinstance(value, Function):
            places = tuple(self.place(place) for place in value.of)
            return Function(places, _Shifted(value.value, self.at) if self.at else value.value)
        if isinstance(value, str) and key in _NAMES:
            return _NAMES[key](self, value)
        return self.renamed(value) if isinstance(value, _RECORDS) else value

    def place(self, place: Place) -> Place:
        """A point of a body, in the whole."""
        ride = self.ride(place.body)
        if ride is not None:
            return Place(ride.link, ride.at + cmath.exp(1j * ride.angle) * place.at)
        return Place(
            self.body(place.body), place.at + self.at if place.body == GROUND else place.at
        )

    def mount(self, mount: Mount) -> Mount:
        """A part's place on its body."""
        on = self.place(Place(mount.body, mount.at))
        ride = self.ride(mount.body)
        angle = mount.angle + (ride.angle if ride else 0.0)
        return replace(
            mount,
            part=self.part(mount.part),
            body=on.body,
            at=on.at,
            angle=angle,
            z=mount.z + self.z,
        )

    def demand(self, demand: Demand) -> Demand:
        """What is asked of an output."""
        motion = None if demand.motion is None else Ahead(demand.motion, self.phase)
        targets = tuple(
            each.model_copy(update={"lift": self.name(each.lift)})
            if isinstance(each, Lines)
            else each
            for each in demand.targets
        )
        return replace(demand, output=self.name(demand.output), motion=motion, targets=targets)


# What a text is, by its key.
_NAMES: dict[str, Callable[[Module, str], str]] = {
    **dict.fromkeys(("a", "b", "cam", "follower", "body", "on", "by", "carrier"), Module.body),
    **dict.fromkeys(("name", "slide", "joint", "turns", "swings", "motor"), Module.name),
    **dict.fromkeys(("part", "roller"), Module.part),
}


def ride(body: str, link: str, pose: Pose, host: Pose) -> Ride:
    """A body that stays where it stands to a link at the poses of both."""
    back = cmath.exp(-1j * host.angle)
    return Ride(body, link, (pose.place - host.place) * back, pose.angle - host.angle)


def joined(host: Machine, modules: Mapping[Module, Machine]) -> Machine:
    """One machine of the host and all modules, at the host's speed; of several gravities the first counts."""
    if not modules:
        return host
    all_ = [host, *(module.machine(machine) for module, machine in modules.items())]
    loads = [load for each in all_ for load in each.loads]
    heavy = [load for load in loads if isinstance(load, Gravity)]
    ground = next((body for body in host.bodies if body.name == GROUND), Body(GROUND))
    return Machine(
        (ground, *(body for each in all_ for body in each.moving)),
        tuple(joint for each in all_ for joint in each.joints),
        tuple(drive for each in all_ for drive in each.drives),
        {name: pose for each in all_ for name, pose in each.start.items()},
        (*(load for load in loads if not isinstance(load, Gravity)), *heavy[:1]),
        tuple(output for each in all_ for output in each.outputs),
        host.speed,
    )
