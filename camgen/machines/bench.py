"""A cam machine that stands on a bench: cam, follower and what holds them, as the parts of a linkage.

tip    where the follower touches, as a point of it: a roller's centre, an edge, a place on a face
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from camgen.errors import DesignError
from camgen.machine.cams.followers import (
    SlidingFace,
    SlidingTip,
    SwingingArm,
    SwingingFace,
)
from camgen.machine.cams.machine import FollowerLoad
from camgen.machine.cams.profile import DiscCam
from camgen.machine.features import Feature, Mount, StandIn
from camgen.machine.model import GROUND, Cam, Gravity, Machine, Place, Spring
from camgen.machine.programs import Scaled
from camgen.machine.run import Run, solve
from camgen.machines.return_spring import SAMPLES, ReturnSpring
from camgen.machines.template import in_bodies
from camgen.parts.catalogue import Bought, turning_text
from camgen.parts.coils import Coil
from camgen.parts.generator.bodies import Bodies
from camgen.parts.generator.coils import coils_of
from camgen.parts.generator.joined import StretchedSpring
from camgen.parts.generator.layout import Layout
from camgen.parts.generator.posts import posts
from camgen.parts.generator.sizes import Parts
from camgen.parts.generator.stacking import lacking, laid
from camgen.parts.generator.troughs import open_rails
from camgen.parts.generator.wheels import Ridden
from camgen.parts.journals import Post
from camgen.parts.part import Part
from camgen.parts.springs import ExtensionSpring, Mounted
from camgen.spec import Print


def _made(layout: Layout, run: Run) -> Bodies:
    """The bodies of a layout, with their parts; DesignError with the keys of a bench, whose sizes are in [bodies]."""
    with in_bodies():
        found = Bodies(laid(layout, run))
        _ = found.parts  # here, not when they are asked for: their errors too get these keys
        return found


@dataclass(frozen=True, eq=False)
class Bench:
    """The machine of `cams.machine` as one that is made.

    drawn: without a spring; tip: its follower's; density: kg/m^3; heavy: bodies whose masses are given; load: with the spring
    that is wanted, its rate and preload 0 where one is to be found; gravity: what weight pulls with, or nothing.
    """

    drawn: Machine
    cam: DiscCam[Any]
    tip: Ridden
    sizes: Parts
    fits: Print
    min_wall: float
    density: float
    load: FollowerLoad = FollowerLoad()
    heavy: Sequence[str] = ()
    gravity: Sequence[Gravity] = ()

    @cached_property
    def machine(self) -> Machine:
        """The machine with fits, masses of its solids and its spring."""
        machine = self._weighed(self.bodies)
        return (
            machine
            if self.spring is None
            else replace(machine, loads=(*machine.loads, self._pull(self.spring)))
        )

    def _weighed(self, bodies: Bodies) -> Machine:
        """With masses of its solids and their weight, without the spring."""
        machine = bodies.weighed(self.density, self.heavy)
        return replace(machine, loads=(*machine.loads, *self.gravity))

    @property
    def notes(self) -> list[str]:
        """What is to be said of its rails."""
        return open_rails(self.bodies.layout)

    @cached_property
    def bodies(self) -> Bodies:
        """What is made."""
        if self.spring is None:
            return self._bare
        layout = self._layout(self._named(True))
        spring = StretchedSpring(
            (GROUND, "post"),
            ("follower", self.returning.hook_name),
            self.spring.outside,
            self.spring.wire,
        )
        return _made(replace(layout, springs={"spring": spring}), self._run)

    def bought(self) -> list[Bought]:
        """Drive, screws, spring."""
        found = self.bodies.bought(turning_text(self.drawn.speed * 60 / math.tau))
        if self.spring is not None:
            told = self.spring.bought(*self.way)
            found.append(
                told
                if self.returning.given
                else replace(told, size=f"{told.size}; {self.returning.of_a_shop(self._least)}")
            )
        return found

    @cached_property
    def parts(self) -> Sequence[Part]:
        """Of the machine."""
        return self.bodies.parts

    @property
    def mounts(self) -> Sequence[Mount]:
        """All copies of them on their bodies."""
        return self.bodies.mounts

    def features(self) -> Sequence[Feature]:
        """Of all joints."""
        return self.bodies.features()

    def stand_ins(self) -> Sequence[StandIn]:
        """The motor."""
        return self.bodies.stand_ins()

    # ---- springs ----------------------------------------------------------------------------------------------------

    @property
    def coils(self) -> list[Coil]:
        """Its springs on their pins."""
        titles = {"spring": "Return spring"}
        return coils_of(self.bodies.layout, self.parts, self.mounts, titles, self.ways)

    @property
    def springs(self) -> dict[str, Mounted]:
        """The return spring, by its name in findings."""
        return {} if self.spring is None else {"return spring": Mounted(self.spring, *self.way)}

    def posts(self, plastic: str) -> list[Post]:
        """The pins of its spring and its roller."""
        pulls = {} if self.spring is None else {"spring": self.spring.force(self.way[1])}
        return list(posts(self.bodies, pulls, plastic))

    @property
    def ways(self) -> dict[str, tuple[float, float]]:
        """Shortest and longest of its spring, inside its eyes, mm."""
        return {} if self.spring is None else {"spring": self.way}

    # ---- layout -----------------------------------------------------------------------------------------------------

    @cached_property
    def _bare(self) -> Bodies:
        """What is made, without a spring."""
        layout = self._layout(self._named(False))
        fault = lacking(layout)
        if fault is not None:
            raise fault
        return _made(layout, self._run)

    def _layout(self, machine: Machine) -> Layout:
        touched = {"contact": self.tip}
        return Layout(machine, "cam", self.sizes, self.fits, self.min_wall, {}, {}, touched)

    @cached_property
    def _run(self) -> Run:
        return solve(self._named(False), SAMPLES, 1)

    def _named(self, sprung: bool) -> Machine:
        """The machine with points where its joints are, those of the spring too."""
        places = self._places(sprung)
        bodies = tuple(
            replace(body, points={**body.points, **places.get(body.name, {})})
            for body in self.drawn.bodies
        )
        joints = tuple(
            replace(joint, law=Scaled(self.cam.program, 1)) if isinstance(joint, Cam) else joint
            for joint in self.drawn.joints
        )
        return replace(self.drawn, bodies=bodies, joints=joints)

    def _places(self, sprung: bool) -> dict[str, dict[str, complex]]:
        found: dict[str, dict[str, complex]] = {
            GROUND: {"shaft": 0j},
            "cam": {"shaft": 0j},
            "follower": {},
        }
        tip, follower = self._touching, self.cam.follower
        if isinstance(follower, SwingingArm | SwingingFace):
            found[GROUND]["pivot"], found["follower"]["pivot"] = follower.pivot, 0j
        found["follower"]["tip"] = tip
        if sprung:
            found[GROUND]["post"] = self.returning.post
            found["follower"][self.returning.hook_name] = self.returning.hooked
        return found

    @cached_property
    def _touching(self) -> complex:
        """The tip in the follower's frame."""
        match self.cam.follower:
            case SwingingArm(_, arm):
                return arm
            case SlidingTip(start) | SlidingFace(start):
                return start
            case SwingingFace(_, facing, ahead) as follower:
                if ahead:
                    raise DesignError(
                        "geometry.follower.face_offset",
                        ahead,
                        0,
                        "mm",
                        "the arm of a face",
                        'its line goes through its pivot: use 0, or make the cams alone (parts.make = "cams")',
                    )
                theta = np.linspace(0, math.tau, 721)
                place = follower.place(
                    self.cam.program(theta), self.cam.profile(theta) * np.exp(1j * theta)
                )
                return complex(facing * 1j * float(np.ptp(place) / 2 + np.min(place)))
        raise TypeError(f"no machine for {type(self.cam.follower).__name__}")

    # ---- spring -----------------------------------------------------------------------------------------------------

    @cached_property
    def returning(self) -> ReturnSpring:
        """Where the return spring hangs."""
        load, play = self.load, self.fits.slide_clearance
        rolls = self.tip.shape == "roller"
        return ReturnSpring(self.cam, rolls, self.sizes, play, load.rate, load.preload)

    @property
    def way(self) -> tuple[float, float]:
        """Its shortest and longest, inside its eyes, mm."""
        return self.returning.way

    @cached_property
    def spring(self) -> ExtensionSpring | None:
        """The return spring; None where the closure needs none. DesignError where there is none such."""
        if self.tip.closure != "force":
            return None
        return self.returning.spring(0.0 if self.returning.given else self._least)

    @property
    def closing(self) -> float:
        """What the spring presses the follower on its cam with at least, N or N m; 0 without one."""
        return 0.0 if self.spring is None else self.returning.closing(self.spring)

    @cached_property
    def _least(self) -> float:
        """Force, N, of a spring that keeps contact, with something over."""
        effort = solve(self._weighed(self._bare), SAMPLES).forces().contacts["contact"]
        return self.returning.least_pull(self.cam.follower.leaves * effort)

    def _pull(self, spring: ExtensionSpring) -> Spring:
        """It between the middles of its pins."""
        ends = Place(GROUND, self.returning.post), Place("follower", self.returning.hooked)
        return Spring("return spring", *ends, spring.rate, spring.free - self.sizes.pin_diameter)
