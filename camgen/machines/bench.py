"""A cam machine that stands on a bench: cam, follower and what holds them, as the parts of a linkage.

tip    where the follower touches, as a point of it: a roller's centre, an edge, a place on a face
post   of the return spring on the plate, in line with the pull, beyond the cam
hook   the spring's other end: the roller's own pin, or a pin of the follower
"""

from __future__ import annotations

import cmath
import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any, NoReturn

import numpy as np

from camgen.errors import DesignError
from camgen.machine.cams.followers import (
    FlatFace,
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
from camgen.parts.catalogue import Bearing, Bought, turning_text
from camgen.parts.coils import Coil
from camgen.parts.generator.bodies import Bodies
from camgen.parts.generator.coils import coils_of
from camgen.parts.generator.joined import Stretched
from camgen.parts.generator.layout import Layout
from camgen.parts.generator.posts import posts
from camgen.parts.generator.sizes import Parts
from camgen.parts.generator.stacking import lacking, laid
from camgen.parts.generator.troughs import open_rails
from camgen.parts.generator.wheels import Ridden
from camgen.parts.journals import Post
from camgen.parts.part import Part
from camgen.parts.springs import EYE, ExtensionSpring, Mounted, extension_spring, pulling
from camgen.spec import Print

if TYPE_CHECKING:
    from camgen.machines.indexing_cam.standing_driver import StandingDriver

_SAMPLES = np.linspace(0, math.tau, 1440, endpoint=False)
_LEAST = 1.0  # N, that a spring pulls with at least: guides rub
_OVER = 1.5  # of what keeps contact
_STRETCHED = (0.4, 0.3, 0.5, 0.2, 0.6, 0.1)  # of a spring's length, where it is shortest
_AIR = 1.0  # mm, between cam and post
_BACK = 3.0  # radii of a hub, from an edge or face to the pin of the spring


@dataclass(frozen=True)
class Strung:
    """A further spring between a body's point and another's, body and point each; way: its shortest and longest inside its
    eyes, mm."""

    title: str
    a: tuple[str, str]
    b: tuple[str, str]
    wire: ExtensionSpring
    way: tuple[float, float]


def _made(layout: Layout, run: Run) -> Bodies:
    """The bodies of a layout, with their parts; DesignError with the keys of a bench, whose sizes are in [bodies]."""
    try:
        found = Bodies(laid(layout, run))
        _ = found.parts  # here, not when they are asked for: their errors too get these keys
        return found
    except DesignError as error:
        of, where, remedy, said = (
            re.sub(r"\bparts\.(?!make)", "bodies.", words)
            for words in (
                error.quantity,
                error.where,
                error.remedy,
                error.sentence,
            )
        )
        raise DesignError(of, error.value, error.limit, error.unit, where, remedy, said) from None


@dataclass(frozen=True, eq=False)
class Bench:
    """The machine of `cams.machine` as one that is made.

    drawn: without a spring; tip: its follower's; density: kg/m^3; heavy: bodies whose masses are given; load: with the spring
    that is wanted, its rate and preload 0 where one is to be found; gears: as a layout has them; more: points of what they
    drive, by body; strung: further springs, by name; gravity: what weight pulls with, or nothing; freewheels, marks: as a
    layout has them; driven: what drives the cam; beneath: what hangs under the plate and drives that.
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
    gears: Mapping[str, int | None] = field(default_factory=dict)
    more: Mapping[str, Mapping[str, complex]] = field(default_factory=dict)
    strung: Mapping[str, Strung] = field(default_factory=dict)
    gravity: Sequence[Gravity] = ()
    freewheels: Mapping[str, tuple[str, Bearing]] = field(default_factory=dict)
    marks: Mapping[str, complex] = field(default_factory=dict)
    driven: str = "cam"
    beneath: StandingDriver | None = None

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
        """With masses of its solids and their weight, and all springs but that which returns the follower."""
        machine = bodies.weighed(self.density, self.heavy)
        machine = machine if self.beneath is None else self.beneath.joined(machine)
        return replace(machine, loads=(*machine.loads, *self.pulls, *self.gravity))

    @property
    def pulls(self) -> list[Spring]:
        """The further springs, between the middles of their pins."""
        points, pin = (
            {body.name: body.points for body in self._named(False).bodies},
            self.sizes.pin_diameter,
        )

        def place(body: str, point: str) -> Place:
            return Place(body, complex(points[body][point]))

        return [
            Spring(each.title, place(*each.a), place(*each.b), each.wire.rate, each.wire.free - pin)
            for each in self.strung.values()
        ]

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
        spring = Stretched(
            (GROUND, "post"), ("follower", self._hook), self.spring.outside, self.spring.wire
        )
        return _made(replace(layout, springs={"spring": spring, **layout.springs}), self._run)

    def bought(self) -> list[Bought]:
        """Drive, screws, spring."""
        found = self.bodies.bought(turning_text(self.drawn.speed * 60 / math.tau))
        if self.beneath is not None:
            found = [*self.beneath.bought(), *(each for each in found if each.role != "drive")]
        if self.spring is not None:
            told = self.spring.bought(*self.way)
            given = (
                self.load.rate or self.load.preload or self.gears
            )  # what a gear drives has no [spring]
            found.append(told if given else replace(told, size=f"{told.size}; {self._of_a_shop()}"))
        return [*found, *(each.wire.bought(*each.way) for each in self.strung.values())]

    @cached_property
    def parts(self) -> Sequence[Part]:
        """Of the machine, and what hangs under it."""
        return [*self.bodies.parts, *([] if self.beneath is None else self.beneath.parts)]

    @property
    def mounts(self) -> Sequence[Mount]:
        """All copies of them on their bodies."""
        return [*self.bodies.mounts, *([] if self.beneath is None else self.beneath.mounts)]

    def features(self) -> Sequence[Feature]:
        """Of all joints."""
        return [*self.bodies.features(), *([] if self.beneath is None else self.beneath.features())]

    def stand_ins(self) -> Sequence[StandIn]:
        """The motor."""
        return self.bodies.stand_ins() if self.beneath is None else self.beneath.stand_ins()

    # ---- springs ----------------------------------------------------------------------------------------------------

    @property
    def coils(self) -> list[Coil]:
        """Its springs on their pins."""
        titles = {
            "spring": "Return spring",
            **{name: each.title for name, each in self.strung.items()},
        }
        return coils_of(self.bodies.layout, self.parts, self.mounts, titles, self.ways)

    @property
    def springs(self) -> dict[str, Mounted]:
        """The return spring, and what hangs on other bodies, by their names in findings."""
        own = {} if self.spring is None else {"return spring": Mounted(self.spring, *self.way)}
        return own | {
            each.title: Mounted(each.wire, *each.way, on_cam=False) for each in self.strung.values()
        }

    def posts(self, plastic: str) -> list[Post]:
        """The pins of its springs and its roller."""
        pulls = {name: each.wire.force(each.way[1]) for name, each in self.strung.items()}
        pulls |= {} if self.spring is None else {"spring": self.spring.force(self.way[1])}
        return list(posts(self.bodies, pulls, plastic))

    @property
    def ways(self) -> dict[str, tuple[float, float]]:
        """Shortest and longest of each spring, inside its eyes, mm."""
        own = {} if self.spring is None else {"spring": self.way}
        return own | {name: each.way for name, each in self.strung.items()}

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
        springs = {
            name: Stretched(each.a, each.b, each.wire.outside, each.wire.wire)
            for name, each in self.strung.items()
        }
        sizes, feet = self.sizes, list[tuple[complex, float]]()
        if self.beneath is not None:
            machine, sizes = self.beneath.above(machine), self.beneath.upper(sizes)
            feet = [(place, sizes.mount_diameter) for place in self.beneath.feet]
        return Layout(
            machine,
            self.driven,
            sizes,
            self.fits,
            self.min_wall,
            {},
            {},
            {"contact": self.tip},
            self.gears,
            springs=springs,
            freewheels=self.freewheels,
            marks=self.marks,
            feet=feet,
        )

    @cached_property
    def _run(self) -> Run:
        return solve(self._named(False), _SAMPLES, 1)

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
        found = {name: dict(points) for name, points in self.more.items()}
        found |= {
            GROUND: {"shaft": 0j, **found.get(GROUND, {})},
            "cam": {"shaft": 0j},
            "follower": {},
        }
        tip, follower = self._touching, self.cam.follower
        if isinstance(follower, SwingingArm | SwingingFace):
            found[GROUND]["pivot"], found["follower"]["pivot"] = follower.pivot, 0j
        found["follower"]["tip"] = tip
        if sprung:
            found[GROUND]["post"] = self.post
            found["follower"][self._hook] = self._hooked
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

    @property
    def _hook(self) -> str:
        return "tip" if self.tip.shape == "roller" else "hook"

    @cached_property
    def _hooked(self) -> complex:
        """The spring's end in the follower's frame."""
        follower, tip = self.cam.follower, self._touching
        if self.tip.shape == "roller":
            return tip
        back = _BACK * (self.sizes.pin_diameter / 2 + self.sizes.wall)
        if isinstance(follower, SlidingTip | SlidingFace):
            return complex(tip + follower.leaves * follower.along * back)
        if isinstance(follower, FlatFace):
            raise DesignError(
                "pins of a spring on the arm of a face",
                1,
                0,
                "",
                "the follower",
                'give it a roller, or make the cams alone (parts.make = "cams")',
            )
        away = follower.trace(0.0)
        return complex(tip + away / abs(away) * back)

    @cached_property
    def _middle(self) -> tuple[complex, complex]:
        """The hook on the ground at mid stroke, and the unit way of it onto the cam."""
        follower, s = self.cam.follower, self.cam.program(_SAMPLES)
        middle = float(np.ptp(s) / 2 + np.min(s))
        if isinstance(follower, SlidingTip | SlidingFace):
            return self._hooked + middle * follower.along, -follower.leaves * follower.along
        arm = self._hooked * cmath.exp(1j * middle)
        return follower.pivot + arm, -follower.leaves * 1j * arm / abs(arm)

    @cached_property
    def post(self) -> complex:
        """The spring's end on the plate: beyond the cam, in line with the pull."""
        at, way = self._middle
        rim = float(np.abs(self.cam.profile(_SAMPLES)).max())
        clear = (
            rim + self.sizes.pin_diameter / 2 + self.sizes.head + self.fits.slide_clearance + _AIR
        )
        beside = (at * way.conjugate()).imag
        length = math.sqrt(max(0.0, clear**2 - beside**2)) - (at * way.conjugate()).real
        return at + max(length, clear) * way

    @cached_property
    def _lengths(self) -> tuple[Any, Any]:
        """Distance of the spring's eyes over the turn, mm, and its derivative to s, mm or mm/rad, (n,) each."""
        follower, s = self.cam.follower, self.cam.program(_SAMPLES)
        if isinstance(follower, SlidingTip | SlidingFace):
            z, slope = (
                self._hooked + s * follower.along - self.post,
                np.full(s.shape, follower.along),
            )
        else:
            arm = self._hooked * np.exp(1j * s)
            z, slope = follower.pivot + arm - self.post, 1j * arm
        return np.abs(z), (z.conj() * slope).real / np.abs(z)

    @property
    def way(self) -> tuple[float, float]:
        """Its shortest and longest, inside its eyes, mm."""
        length, pin = self._lengths[0], self.sizes.pin_diameter
        return float(length.min()) + pin, float(length.max()) + pin

    @cached_property
    def spring(self) -> ExtensionSpring | None:
        """The return spring; None where the closure needs none. DesignError where there is none such."""
        if self.tip.closure != "force":
            return None
        eye, hook = EYE * self.sizes.pin_diameter, self.sizes.hook
        shortest, longest = self.way
        length, lever = self._lengths[0], self._lever
        first, last = lever[np.argmin(length)], lever[np.argmax(length)]
        if not self.load.rate:
            low = self.load.preload / first or self._least()
            return pulling(low, shortest, longest, eye, _STRETCHED, hook) or self._none_such(
                f"{low:.4g} N at its shortest"
            )
        stroke = float(np.ptp(self.cam.program(_SAMPLES)))
        low, high = self.load.preload / first, (self.load.preload + self.load.rate * stroke) / last
        rate = (high - low) / (longest - shortest)
        free = shortest - low / rate if rate > 0 else 0.0
        found = extension_spring(rate, free, longest, eye, hook) if free > 0 else None
        return found or self._none_such(f"{rate:.4g} N/mm, free length {free:.4g} mm")

    def _of_a_shop(self) -> str:
        """Which other springs do as well, and what [spring] is with one."""
        shortest, longest = self.way
        first, last = (
            self._lever[np.argmin(self._lengths[0])],
            self._lever[np.argmax(self._lengths[0])],
        )
        least, pull = self._least(), f"R ({shortest:.5g} - L)"
        keys = f"preload = {pull}, rate = R"
        if not isinstance(self.cam.follower, SlidingTip | SlidingFace):
            stroke = float(np.ptp(self.cam.program(_SAMPLES)))
            keys = f"preload = {first:.5g} {pull}, rate = ({last:.5g} R ({longest:.5g} - L) - preload) / {stroke:.5g}"
        return (
            f"or of a shop, R N/mm and L mm free inside its eyes: {pull} at least {least:.4g} N, and it may be stretched to "
            f"{longest:.4g}; put it into [spring], beside a [load], and build again: {keys}"
        )

    def _none_such(self, asked: str) -> NoReturn:
        shortest, longest = self.way
        raise DesignError(
            "return springs of round wire",
            0,
            1,
            "",
            f"{asked}, length from {shortest:.4g} to {longest:.4g} mm",
            "ask for another spring ([spring], load.closing_n_m), less load or speed, or another closure",
        )

    @property
    def _lever(self) -> Any:
        """What a spring's newton is to the follower over the turn, N or N m, (n,)."""
        unit = 1.0 if isinstance(self.cam.follower, SlidingTip | SlidingFace) else 1e-3
        return np.abs(self._lengths[1]) * unit

    @property
    def closing(self) -> float:
        """What the spring presses the follower on its cam with at least, N or N m; 0 without one."""
        pull = (
            0.0
            if self.spring is None
            else self.spring.force(self._lengths[0] + self.sizes.pin_diameter)
        )
        return float(np.min(pull * self._lever))

    def _least(self) -> float:
        """Force, N, of a spring that keeps contact, with something over."""
        leaves = self.cam.follower.leaves
        effort = leaves * solve(self._weighed(self._bare), _SAMPLES).forces().contacts["contact"]
        missing = float(np.nanmax(np.where(np.isfinite(effort), -effort, 0.0) / self._lever))
        return max(_LEAST, _OVER * missing)

    def _pull(self, spring: ExtensionSpring) -> Spring:
        """It between the middles of its pins."""
        ends = Place(GROUND, self.post), Place("follower", self._hooked)
        return Spring("return spring", *ends, spring.rate, spring.free - self.sizes.pin_diameter)
