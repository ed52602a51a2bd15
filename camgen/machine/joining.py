"""Several machines on one shaft as one machine: names with a prefix, the whole shifted on the ground and in phase."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, fields, replace
from typing import Any, TypeVar

import numpy as np

from camgen.machine.features import Asked, Eye, Faces, Feature, Flat, Mount, OwnTip, Teeth
from camgen.machine.model import GROUND, Along, Angle, Body, Function, Gravity, Law, Machine, Path, Place, Pose
from camgen.machine.run import solve
from camgen.numerics import Floats

T = TypeVar("T")

_RECORDS = Angle | Along | Path | Eye | Faces | Flat | OwnTip | Teeth  # that stand in others
_BODIES = {"a", "b", "cam", "follower", "body", "on", "by", "carrier"}  # keys whose text is a body's name


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
        found: Floats = self.value(*(np.concatenate([np.asarray(jet[:1]) - self.at, jet[1:]]) for jet in jets))
        return found


@dataclass(frozen=True)
class Module:
    """How one machine stands in another: its names get the prefix and "_", its parts' names the prefix and "-".

    at: its origin on the ground, complex mm; phase: how far it is ahead of the shaft, rad; z: how far it is raised, mm.
    """

    prefix: str
    at: complex = 0j
    phase: float = 0.0
    z: float = 0.0

    def name(self, name: str) -> str:
        """Of a joint, a drive or an output."""
        return f"{self.prefix}_{name}"

    def body(self, name: str) -> str:
        """Of a body: the ground is the same for all."""
        return name if name == GROUND else self.name(name)

    def part(self, name: str) -> str:
        """Of a part or a sketch."""
        return f"{self.prefix.replace('_', '-')}-{name}"

    def machine(self, machine: Machine) -> Machine:
        """The same machine as it is in the whole."""
        run = solve(machine, [self.phase], 0)
        poses = {body.name: run.pose(body.name) for body in machine.moving}
        return Machine(
            tuple(replace(body, name=self.name(body.name)) for body in machine.moving),
            tuple(self.renamed(joint) for joint in machine.joints),
            tuple(replace(self.renamed(drive), law=Ahead(drive.law, self.phase)) for drive in machine.drives),
            {self.name(name): Pose(complex(pose.place[0]) + self.at, float(pose.angle[0])) for name, pose in poses.items()},
            tuple(load if isinstance(load, Gravity) else self.renamed(load) for load in machine.loads),
            tuple(self.renamed(output) for output in machine.outputs),
            machine.speed,
        )

    def renamed(self, record: T) -> T:
        """A joint, load, output or feature with the names and places that it has in the whole."""
        changed = {each.name: self._renamed(each.name, getattr(record, each.name)) for each in fields(record)}  # type: ignore[arg-type]
        return replace(record, **changed)  # type: ignore[type-var]

    def _renamed(self, key: str, value: Any) -> Any:
        """A value of a record, under its key."""
        if isinstance(value, Place):
            return self._place(value)
        if isinstance(value, Function):
            places = tuple(self._place(place) for place in value.of)
            return Function(places, _Shifted(value.value, self.at) if self.at else value.value)
        if isinstance(value, tuple):
            return tuple(self._renamed(key, each) for each in value)
        if isinstance(value, str) and key in _NAMES:
            return _NAMES[key](self, value)
        return self.renamed(value) if isinstance(value, _RECORDS) else value

    def _place(self, place: Place) -> Place:
        return Place(self.body(place.body), place.at + self.at if place.body == GROUND else place.at)

    def mount(self, mount: Mount) -> Mount:
        """A part's place on its body."""
        at = mount.at + self.at if mount.body == GROUND else mount.at
        return replace(mount, part=self.part(mount.part), body=self.body(mount.body), at=at, z=mount.z + self.z)

    def features(self, features: Sequence[Feature]) -> list[Feature]:
        """Features of its joints."""
        return [self.renamed(feature) for feature in features]

    def asked(self, asked: Asked) -> Asked:
        """What is asked of an output."""
        motion = None if asked.motion is None else Ahead(asked.motion, self.phase)
        return replace(asked, output=self.name(asked.output), motion=motion)


# What a text is, by its key.
_NAMES: dict[str, Callable[[Module, str], str]] = {
    **dict.fromkeys(_BODIES, Module.body),
    **dict.fromkeys(("name", "slide", "joint", "turns", "swings"), Module.name),
    **dict.fromkeys(("part", "roller"), Module.part),
}


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
