"""The two-crank chain as it is made: crank and arm hang under the plate, on a bracket of their own.

    plate     ground plate of the machine; the arm's shaft passes down through it, its wheel over it turns the cam's, 2 to 1
    arm       on the shaft's lower end; in its slot runs the pin of the crank, which lies under it
    crank     its shaft, or the motor's, passes down through the bracket: so neither shaft is in the way of crank or arm
    bracket   a plate on four posts, a screw through each up into the ground plate

Two wheels turn against each other, so the arm turns against the cam.
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from camgen.errors import DesignError
from camgen.machine.balancing import together
from camgen.machine.features import Eye, Faces, Feature, Mount, Ring, StandIn, mapped
from camgen.machine.model import GROUND, Body, Machine
from camgen.machine.run import Run, solve
from camgen.machines.indexing_cam.driver import ARM, CRANK
from camgen.parts.catalogue import SCREWS, Bought, turning_text
from camgen.parts.generator.bodies import Bodies
from camgen.parts.generator.layout import Layout
from camgen.parts.generator.sizes import Parts
from camgen.parts.generator.stacking import laid
from camgen.parts.hardware import spacer
from camgen.parts.part import Part
from camgen.spec import Print

_THETA = np.linspace(0, math.tau, 720, endpoint=False)
_AIR = 2.0  # mm, between what moves and the posts
_POSTS = 4
_THREAD = "M3"  # of the posts' screws
_POINTS = ("motor", "pin")  # of the crank
_ARM = "arm"  # of the arm: the point of its shaft


@dataclass(frozen=True, eq=False)
class StandingDriver:
    """Crank and arm of a machine, and what holds them; shafts: places of the machine's other shafts on the ground, mm."""

    whole: Machine
    sizes: Parts
    fits: Print
    min_wall: float
    density: float
    shafts: Sequence[complex]

    # ---- the machine over the plate, and the whole -------------------------------------------------------------------

    def above(self, machine: Machine) -> Machine:
        """The machine without crank and turning block: what stands on the plate, driven by the arm."""
        kept = tuple(
            joint
            for joint in machine.joints
            if joint.name not in ("crank's shaft", "turning block")
        )
        return replace(
            machine,
            bodies=tuple(b for b in machine.bodies if b.name != CRANK),
            joints=kept,
            drives=(),
        )

    @staticmethod
    def upper(sizes: Parts) -> Parts:
        """Sizes of what stands on the plate: what drives is under it."""
        pins = {point: kind for point, kind in sizes.pins.items() if point not in _POINTS}
        return sizes.model_copy(update={"motor": "none", "hand_crank": 0.0, "pins": pins})

    def joined(self, machine: Machine) -> Machine:
        """That machine, with masses and fits, and these bodies as they are made."""
        own = self.bodies.weighed(self.density, ())
        bodies = [
            together(body, own.body(ARM)) if body.name == ARM else body for body in machine.bodies
        ]
        bodies.append(own.body(CRANK))
        return replace(
            machine,
            bodies=tuple(bodies),
            joints=(*own.joints, *machine.joints),
            drives=self.whole.drives,
        )

    # ---- bodies -----------------------------------------------------------------------------------------------------

    @cached_property
    def _run(self) -> Run:
        return solve(self.whole, _THETA, 1)

    @cached_property
    def _pivots(self) -> tuple[complex, complex]:
        """Shafts of the crank and of the arm on the ground, mm."""
        crank, arm = self.whole.pin("crank's shaft"), self.whole.pin("arm's axle")
        return crank.b.at, arm.b.at

    @cached_property
    def bodies(self) -> Bodies:
        """Bracket, crank, arm, by heights over the bracket's underside."""
        block = self.whole.slide("turning block")
        crank, arm = Body(CRANK, {"motor": 0j, "pin": block.runner.at}), Body(ARM, {_ARM: 0j})
        bodies = (Body(GROUND, {"motor": self._pivots[0]}), crank, arm)
        joints = tuple(j for j in self.whole.joints if j.name in ("crank's shaft", "turning block"))
        machine = Machine(
            bodies,
            joints,
            (),
            {name: self.whole.start_of(name) for name in (CRANK, ARM)},
            speed=self.whole.speed,
        )
        pins = {point: kind for point, kind in self.sizes.pins.items() if point in _POINTS}
        layout = Layout(
            machine,
            CRANK,
            self.sizes.model_copy(update={"pins": pins, "plates": 1}),
            self.fits,
            self.min_wall,
            {},
            {},
            carried={_ARM: ARM},
            feet=tuple((place, SCREWS[_THREAD].clearance) for place in self.feet),
            hangs=True,
        )
        found = laid(layout, self._run)
        top = max(
            level + layout.beyond(point)[0] for point in ("pin",) for level, *_ in found.on(point)
        )
        high, room = (
            found.floor(top) + self.sizes.head - found.top(found.level[ARM]),
            self.sizes.shaft_length,
        )
        least = self.sizes.thickness + high + 2 * self.fits.slide_clearance + found.thickness(ARM)
        if room < least:
            raise DesignError(
                "bodies.shaft_length",
                room,
                least,
                "mm",
                "the arm's shaft under the plate",
                "make it longer: collar, the head of the crank's pin and the arm lie one under the other",
            )
        return Bodies(found)

    @property
    def _low(self) -> float:
        """Height of the bracket's underside over that of the plate, mm; the arm ends with its shaft."""
        layout = self.bodies.layout
        return -self.sizes.shaft_length - layout.floor(layout.level[ARM])

    @cached_property
    def feet(self) -> Sequence[complex]:
        """Places of the posts on the ground, mm: round the arm's way, as far as may be from the other shafts."""
        block, (_, arm) = self.whole.slide("turning block"), self._pivots
        s, pin = self.sizes, self.sizes.pin_diameter + self.fits.slide_clearance
        far = float(self._run.length(block.name)[0].max()) + pin / 2 + s.wall + 0.5
        reach = far + self._post / 2 + _AIR
        ways = [cmath.exp(1j * math.radians(turn)) for turn in range(0, 90, 5)]
        rounds = [[arm + reach * way * 1j**k for k in range(_POSTS)] for way in ways]
        found = max(rounds, key=lambda places: min(abs(a - b) for a in places for b in self.shafts))
        room = min(abs(a - b) for a in found for b in self.shafts)
        needed = self._post / 2 + s.shaft_diameter / 2 + s.head + s.wall + _AIR
        if room < needed:
            raise DesignError(
                "room for the posts of the driver",
                room,
                needed,
                "mm from a shaft",
                "[driver]",
                "use a smaller or larger driver.crank, or a longer geometry.follower.pivot_distance",
            )
        return found

    @property
    def _post(self) -> float:
        """Diameter of a post, mm."""
        return SCREWS[_THREAD].clearance + 4 * self.sizes.wall

    # ---- parts ------------------------------------------------------------------------------------------------------

    @cached_property
    def _made(self) -> tuple[list[Part], list[Mount]]:
        parts = [
            replace(part, name=self.name(part.name), title=self._title(part))
            for part in self.bodies.parts
        ]
        mounts = [
            replace(mount, part=self.name(mount.part), z=round(mount.z + self._low, 9))
            for mount in self.bodies.mounts
        ]
        low = self._low + self.sizes.base_thickness
        said = (f"{_THREAD} through it from below, into the ground plate",)
        post = spacer(
            "post",
            "Post of the driver",
            SCREWS[_THREAD].clearance,
            self._post,
            -low,
            self.min_wall,
        )
        posts = [Mount("post", GROUND, place, z=round(low, 9)) for place in self.feet]
        return [*parts, replace(post, count=_POSTS, notes=said)], [*mounts, *posts]

    @staticmethod
    def name(part: str) -> str:
        """Of a part, beside those over the plate."""
        return "bracket" if part == GROUND else f"driver-{part}"

    @staticmethod
    def _title(part: Part) -> str:
        return "Bracket of the driver" if part.name == GROUND else f"{part.title}, driver"

    @property
    def parts(self) -> Sequence[Part]:
        """All of them."""
        return self._made[0]

    @property
    def mounts(self) -> Sequence[Mount]:
        """All copies on their bodies."""
        return self._made[1]

    def features(self) -> Iterator[Feature]:
        """Of the crank's shaft and the turning block."""

        def named(_: str, value: Any) -> Any:
            known = isinstance(value, Eye | Faces | Ring) and value.part is not None
            return replace(value, part=self.name(value.part)) if known else value

        return (mapped(feature, named) for feature in self.bodies.features())

    def stand_ins(self) -> list[StandIn]:
        """The motor under the bracket."""
        return [
            replace(
                thing,
                discs=tuple(
                    (at, radius, z0 + self._low, z1 + self._low)
                    for at, radius, z0, z1 in thing.discs
                ),
            )
            for thing in self.bodies.stand_ins()
        ]

    def bought(self) -> list[Bought]:
        """Drive of the crank, screws of the posts."""
        drive = self.bodies.bought(
            turning_text(
                self.whole.drives[0].law(np.zeros(1), 1)[0] * self.whole.speed * 60 / math.tau
            )
        )
        screw, grip = SCREWS[_THREAD], -self._low
        size = f"{_THREAD} x {screw.length(grip, self.sizes.base_thickness):g}"
        return [
            *(each for each in drive if "plate" not in each.name),
            Bought("screw of a post", screw.standard, size, _POSTS),
        ]


def room(sizes: Parts, fits: Print, crank: float, offset: float) -> float:
    """What lies between the hole of the arm's shaft and its slot, mm."""
    slot = crank - offset - 0.5 - (sizes.pin_diameter + fits.slide_clearance) / 2
    return slot - (sizes.shaft_diameter + fits.press_clearance) / 2
