"""[[spring]] and [cam.spring]: extension springs between points of two links, as loads, on a level of their own, and bought.

A spring's eyes sit on the pins of its points, so lengths between the points are those between the middles of its pins. A spring
that is coiled close only pulls: one that would be shorter than its free length somewhere on the way is refused.
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from camgen.errors import DesignError, Fault
from camgen.machine import model as m
from camgen.machine.run import Run
from camgen.machines.linkage import tables as t
from camgen.machines.linkage.drawing import RETURN, Drawing
from camgen.machines.return_spring import ReturnSpring
from camgen.parts.catalogue import Bought
from camgen.parts.generator.connections import StretchedSpring
from camgen.parts.generator.sizes import Parts
from camgen.parts.generator.wheels import pivot, tips
from camgen.parts.springs import EYE, ExtensionSpring, WorkingSpring, extension_spring
from camgen.spec import unknown


@dataclass(frozen=True)
class MountedSpring:
    """A spring in its machine."""

    name: str
    figure: str  # how the names of its figures begin
    ends: tuple[tuple[str, str], tuple[str, str]]  # body and point of each
    pull: m.Spring  # as a load
    spring: ExtensionSpring
    shortest: float  # mm, between its points
    longest: float  # mm
    note: str = ""  # of its line in the parts list
    key: str = ""  # that says where its end on the ground is; "" of one between points of the spec

    @property
    def stretched(self) -> StretchedSpring:
        """What it takes up."""
        return StretchedSpring(*self.ends, self.spring.outside, self.spring.wire, self.key)

    def forces(self) -> tuple[float, float]:
        """Its least and greatest pull, N."""
        least, most = (
            self.pull.rate * (length - self.pull.free) for length in (self.shortest, self.longest)
        )
        return least, most

    def way(self, pin: float) -> tuple[float, float]:
        """Its shortest and longest inside its eyes, mm; pin: diameter, mm."""
        return self.shortest + pin, self.longest + pin

    def mounted(self, pin: float, on_cam: bool) -> WorkingSpring:
        """Where it works; pin: diameter, mm; on_cam: whether it keeps a follower on its cam."""
        name = "spring" if self.name == RETURN else self.figure
        return WorkingSpring(self.spring, *self.way(pin), on_cam=on_cam, name=name)

    def bought(self, pin: float) -> Bought:
        """Its line in the parts list; pin: diameter, mm."""
        found = self.mounted(pin, False).bought
        name = found.name if self.name == RETURN else f"{found.name}, {self.name}"
        return replace(found, name=name, size=found.size + self.note)


@dataclass(frozen=True)
class Returning:
    """The return spring of a cam's follower, before it is found."""

    name: str
    cam: m.Cam
    spring: ReturnSpring
    post: str  # name of its point on the ground
    hook: str  # name of its point on the follower
    at: complex  # mm, the cam's axis on the ground
    key: str  # that says where its post is

    def on(self, machine: m.Machine) -> m.Machine:
        """The machine with its points."""
        pose = machine.start_of(self.cam.follower)
        hook = (self.at + self.spring.hook - pose.place) * cmath.exp(-1j * pose.angle)
        points = {
            m.GROUND: {self.post: self.at + self.spring.post},
            self.cam.follower: {} if self.spring.rolls else {self.hook: hook},
        }
        bodies = (
            replace(body, points={**body.points, **points.get(body.name, {})})
            for body in machine.bodies
        )
        return replace(machine, bodies=tuple(bodies))

    def sprung(self, machine: m.Machine, least: float) -> MountedSpring:
        """The spring that is wanted, or that pulls with `least` N at its shortest, in the machine with its points."""
        spring = self.spring.spring(least)
        pin = self.spring.sizes.pin_diameter
        a = machine.body(m.GROUND).at(self.post)
        b = machine.body(self.cam.follower).at(self.hook)
        pull = m.Spring(self.name, a, b, spring.rate, spring.free - pin)
        shortest, longest = (length - pin for length in self.spring.way)
        note = "" if self.spring.given else f"; {self.spring.of_a_shop(least)}"
        ends = ((m.GROUND, self.post), (self.cam.follower, self.hook))
        return MountedSpring(
            self.name, self.name, ends, pull, spring, shortest, longest, note, self.key
        )


def returning(
    machine: m.Machine, drawing: Drawing, sizes: Parts, play: float, lasting: bool
) -> list[Returning]:
    """The return spring of each cam that has one, in the machine of a drawing; play: of what moves past each other, mm; lasting:
    whether springs are to work for ever."""
    springs = []
    numbers = {name: k for k, name in enumerate(drawing.named_cams)}
    first = {tip.joint.name: tip for tip in reversed(tips(machine, drawing.ridden, sizes, play))}
    for name, (title, post, hook) in drawing.returns.items():
        tip = first[name]
        wish = drawing.named_cams[name].spring or t.ReturnSpring()
        axis = pivot(machine, tip.joint.cam)[1]
        place = None if wish.post is None else complex(*wish.post) - axis
        spring = ReturnSpring(
            tip.cam, tip.rolls, sizes, play, wish.rate, wish.preload, place, lasting
        )
        key = f"cam.{numbers[name]}.spring.post"
        if place is not None:
            _refuse_askew(spring, axis, key)
        springs.append(Returning(title, tip.joint, spring, post, hook, axis, key))
    return springs


def _refuse_askew(spring: ReturnSpring, axis: complex, key: str) -> None:
    """DesignError where a spring would pull its follower off the cam; axis: the cam's, mm."""
    angle, theta = spring.askew
    if angle < math.pi / 2:
        return
    near = axis + spring.found_post
    raise DesignError(
        "angle between the return spring's pull and the follower's way back",
        math.degrees(angle),
        90,
        "deg",
        f"cam angle {math.degrees(theta):.0f} deg",
        f"there it pulls the follower off its cam: put {key} beyond the cam, such as near ({near.real:.4g}, {near.imag:.4g})",
    )


def mounted(
    sprung: Sequence[MountedSpring], cams: Sequence[m.Cam], pin: float
) -> dict[str, WorkingSpring]:
    """Where they work, by their names in findings; cams: that only a force keeps closed; pin: diameter, mm."""
    followers = {cam.follower for cam in cams}
    return {
        each.figure.replace("_", " "): each.mounted(
            pin, any(body in followers for body, _ in each.ends)
        )
        for each in sprung
    }


def names(springs: Sequence[t.Spring]) -> list[str]:
    """Of each spring its own name, or one by its number."""
    return [
        each.name or ("spring" if len(springs) == 1 else f"spring_{k}")
        for k, each in enumerate(springs, 1)
    ]


def faults(
    springs: Sequence[t.Spring],
    links: Mapping[str, Sequence[str]],
    turning: Collection[str],
    taken: Collection[str],
) -> list[Fault]:
    """What is wrong with them. turning: links on shafts; taken: names of links, joints and levels."""
    faults = []
    own_names = names(springs)
    points = {point for ends in links.values() for point in ends}
    on_shafts = {point for link in turning for point in links.get(link, ())}
    shafts = on_shafts.intersection(links.get(m.GROUND, ()))
    for k, (each, name) in enumerate(zip(springs, own_names, strict=True)):
        path = ("spring", k)
        if name in (*taken, *own_names[:k]):
            right = "a name of its own, which no link, joint or other spring has"
            faults.append(Fault((*path, "name"), repr(name), right))
        if (each.free is None) == (each.preload is None):
            faults.append(Fault(path, "", "either free or preload"))
        between = (*path, "between")
        lost = [(n, point) for n, point in enumerate(each.between) if point not in points]
        faults += [unknown((*between, n), point, points) for n, point in lost]
        right = "a point that is no shaft: its eye would sit on what turns there"
        turns = [(n, point) for n, point in enumerate(each.between) if point in shafts]
        faults += [Fault((*between, n), repr(point), right) for n, point in turns]
        both = next((link for link, ends in links.items() if set(each.between) <= set(ends)), None)
        if both is not None and not lost and not turns:
            right = f"points of two links: {both} carries both"
            faults.append(Fault(between, ", ".join(each.between), right))
    return faults


def sprung(
    springs: Sequence[t.Spring], run: Run, sizes: Parts, lasting: bool
) -> list[MountedSpring]:
    """The springs in their machine; run: samples over the whole motion; lasting: as above. DesignError where none can be made."""
    return [
        _mounted(each, name, run, sizes, lasting)
        for each, name in zip(springs, names(springs), strict=True)
    ]


def _mounted(spec: t.Spring, name: str, run: Run, sizes: Parts, lasting: bool) -> MountedSpring:
    pin = sizes.pin_diameter
    ends = tuple((_carrier(run.machine, point), point) for point in spec.between)
    places = [run.point(*end)[0] for end in ends]
    length = np.abs(places[1] - places[0])
    shortest = float(length.min())
    longest = float(length.max())
    free = shortest - (spec.preload or 0.0) / spec.rate if spec.free is None else spec.free
    where = f"spring {name}, {math.degrees(float(run.theta[int(np.argmin(length))])):.2f} deg"
    if not free > 0:
        remedy = "ask for a smaller preload or a greater rate"
        raise DesignError("free length", free, 0, "mm", where, remedy)
    if shortest < free - 1e-9:
        said = f"{where}: its points come as near as {shortest:.6g} mm, its free length is {free:.6g} mm, and it only pulls"
        remedy = "ask for a shorter one, or for a preload"
        raise DesignError(
            "length",
            shortest,
            free,
            "mm",
            where,
            remedy,
        ).saying(said)
    way = shortest + pin, longest + pin
    spring = extension_spring(spec.rate, free + pin, way, EYE * pin, sizes.hook, lasting)
    if spring is None:
        where = f"spring {name}"
        said = f"{where}: no spring of round wire has {spec.rate:.4g} N/mm, {free:.4g} mm free between pins of {pin:g} mm and bears "
        remedy = "ask for another rate or free length, draw its points further apart, or take thinner pins"
        raise DesignError(
            "length",
            longest,
            free,
            "mm",
            where,
            remedy,
        ).saying(f"{said}{longest:.4g} mm")
    a, b = (m.Place(body, complex(run.machine.body(body).points[point])) for body, point in ends)
    figure = f"spring_{spec.name}" if spec.name else name
    pull = m.Spring(name, a, b, spec.rate, free)
    return MountedSpring(name, figure, (ends[0], ends[1]), pull, spring, shortest, longest)


def _carrier(machine: m.Machine, point: str) -> str:
    """The link whose point it is, of several the ground or the first: its pin takes the pull."""
    carriers = [body.name for body in machine.bodies if point in body.points]
    return m.GROUND if m.GROUND in carriers else carriers[0]
