"""What drives a machine from under its plate: two links on a bracket of their own, one of whose shafts passes up through the plate.

plate     ground plate of the machine; the arm's shaft passes down through it, its wheel over it turns what is above
arm       on the shaft's lower end; in its slot runs the pin of the crank, which lies under it
crank     its shaft, or the motor's, passes down through the bracket: so neither shaft is in the way of crank or arm
bracket   a plate on four posts, a screw through each up into the ground plate
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
from camgen.machine.model import GROUND, Body, Joint, Machine, Pin, Slot, bodies_of
from camgen.machine.run import Run
from camgen.parts.assembly import Assembly, MotorSeat
from camgen.parts.catalogue import SCREWS, Bought, turning_text
from camgen.parts.generator.bodies import Bodies
from camgen.parts.generator.layout import Layout
from camgen.parts.generator.pins import levels_beyond
from camgen.parts.generator.sizes import Parts
from camgen.parts.generator.stacking import with_levels
from camgen.parts.hardware import spacer
from camgen.parts.journals import journals
from camgen.parts.part import Part
from camgen.spec import Print

_AIR = 2.0  # mm, between what moves and the posts
_POSTS = 4
_THREAD = "M3"  # of the posts' screws


@dataclass(frozen=True, eq=False)
class Beneath:
    """The link that drives and the arm that it turns, under the plate.

    whole: all links, not on levels; arm: its name; run: of the whole, over its motion.
    """

    whole: Layout
    arm: str
    run: Run

    # ---- the links over the plate, and all --------------------------------------------------------------------------

    @property
    def _crank(self) -> str:
        """The link that drives."""
        return self.whole.driven

    @cached_property
    def _joints(self) -> tuple[Joint, ...]:
        """Those of the crank."""
        return tuple(j for j in self.whole.drawn.joints if self._crank in bodies_of(j))

    @cached_property
    def _slot(self) -> Slot:
        """Of the arm, in which the crank's pin runs."""
        return next(joint for joint in self._joints if isinstance(joint, Slot))

    def _pin(self, link: str) -> tuple[str, complex]:
        """The point at which a link turns on the ground, and its place there, mm."""
        ground, own = (self.whole.drawn.body(name).points for name in (GROUND, link))
        return next((name, complex(z)) for name, z in ground.items() if name in own)

    @property
    def _shaft_of_arm(self) -> Body:
        """The arm with the point of its shaft alone."""
        arm = self.whole.drawn.body(self.arm)
        name, _ = self._pin(self.arm)
        return replace(arm, points={name: arm.points[name]})

    @property
    def above(self) -> Layout:
        """The links over the plate, driven by the arm, with holes for the posts' screws."""
        machine = self.whole.drawn
        own = {joint.name for joint in self._joints}
        arm = self._shaft_of_arm
        kept = tuple(
            arm if body.name == self.arm else body
            for body in machine.bodies
            if body.name != self._crank
        )
        joints = tuple(joint for joint in machine.joints if joint.name not in own)
        sizes = self.whole.sizes
        points = machine.body(self._crank).points
        pins = {point: kind for point, kind in sizes.pins.items() if point not in points}
        lower = {"motor": "none", "hand_crank": 0.0, "pins": pins}
        return replace(
            self.whole,
            drawn=replace(machine, bodies=kept, joints=joints, drives=()),
            driven=self.arm,
            sizes=sizes.model_copy(update=lower),
            feet=tuple((place, sizes.mount_diameter) for place in self.feet),
        )

    def joined(self, machine: Machine, density: float) -> Machine:
        """That machine, with masses and fits, and these bodies as they are made; density: kg/m^3."""
        own = self.bodies.with_masses(density, ())
        bodies = [
            together(body, own.body(body.name)) if body.name == self.arm else body
            for body in machine.bodies
        ]
        return replace(
            machine,
            bodies=(*bodies, own.body(self._crank)),
            joints=(*own.joints, *machine.joints),
            drives=self.whole.drawn.drives,
        )

    # ---- bodies -----------------------------------------------------------------------------------------------------

    @cached_property
    def bodies(self) -> Bodies:
        """Bracket, crank, arm, by heights over the bracket's underside."""
        machine = self.whole.drawn
        sizes = self.whole.sizes
        motor, shaft = self._pin(self._crank)
        ground = replace(machine.body(GROUND), points={motor: shaft})
        (held,) = self._shaft_of_arm.points
        names = (self._crank, self.arm)
        lower = replace(
            machine,
            bodies=(ground, machine.body(self._crank), self._shaft_of_arm),
            joints=self._joints,
            drives=(),
            start={name: machine.start_of(name) for name in names},
            loads=(),
            outputs=(),
        )
        points = machine.body(self._crank).points
        pins = {point: kind for point, kind in sizes.pins.items() if point in points}
        layout = Layout(
            lower,
            self._crank,
            sizes.model_copy(update={"pins": pins, "plates": 1}),
            self.whole.fits,
            self.whole.min_wall,
            {},
            {},
            guest_links={held: self.arm},
            feet=tuple((place, SCREWS[_THREAD].clearance) for place in self.feet),
            hangs=True,
        )
        found = with_levels(layout, self.run)
        (point,) = layout.slots
        top = max(level + levels_beyond(layout, point)[0] for level, *_ in found.on(point))
        high = found.floor(top) + sizes.head - found.top(found.level[self.arm])
        room = sizes.shaft_length
        play = self.whole.fits.slide_clearance
        least = sizes.thickness + high + 2 * play + found.thickness(self.arm)
        if room < least:
            raise DesignError(
                "parts.shaft_length",
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
        return -self.whole.sizes.shaft_length - layout.floor(layout.level[self.arm])

    @cached_property
    def feet(self) -> Sequence[complex]:
        """Places of the posts on the ground, mm: round the arm's way, as far as may be from the other shafts."""
        s = self.whole.sizes
        arm = self._pin(self.arm)[1]
        pin = s.pin_diameter + self.whole.fits.slide_clearance
        far = float(self.run.length(self._slot.name)[0].max()) + pin / 2 + s.wall + 0.5
        reach = far + self._post / 2 + _AIR
        ways = [cmath.exp(1j * math.radians(turn)) for turn in range(0, 90, 5)]
        rounds = [[arm + reach * way * 1j**k for k in range(_POSTS)] for way in ways]
        places = max(rounds, key=self._room)
        room = self._room(places)
        needed = self._post / 2 + s.shaft_diameter / 2 + s.head + s.wall + _AIR
        if room < needed:
            raise DesignError(
                "room for the posts of the bracket",
                room,
                needed,
                "mm from a shaft",
                f"links {self._crank} and {self.arm} under the plate",
                "use a smaller or larger crank, or shafts that are further apart",
            )
        return places

    def _room(self, places: Sequence[complex]) -> float:
        """Least distance of places from the shafts of the links over the plate, mm."""
        own = (self._crank, self.arm)
        shafts = [
            place.at
            for joint in self.whole.drawn.joints
            if isinstance(joint, Pin) and not {*own} & {joint.a.body, joint.b.body}
            for place in (joint.a, joint.b)
            if place.body == GROUND
        ]
        return min((abs(a - b) for a in places for b in shafts), default=math.inf)

    @property
    def _post(self) -> float:
        """Diameter of a post, mm."""
        return SCREWS[_THREAD].clearance + 4 * self.whole.sizes.wall

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
        low = self._low + self.whole.sizes.base_thickness
        said = (f"{_THREAD} through it from below, into the ground plate",)
        post = spacer(
            "post",
            "Post of the bracket",
            SCREWS[_THREAD].clearance,
            self._post,
            -low,
            self.whole.min_wall,
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

    def _features(self) -> Iterator[Feature]:
        """Of the crank's shaft and the slot."""

        def named(_: str, value: Any) -> Any:
            known = isinstance(value, Eye | Faces | Ring) and value.part is not None
            return replace(value, part=self.name(value.part)) if known else value

        return (mapped(feature, named) for feature in self.bodies.features())

    def _stand_ins(self) -> list[StandIn]:
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

    @property
    def _speed(self) -> float:
        """Of the crank, rad/s."""
        machine = self.whole.drawn
        return float(machine.drives[0].law(np.zeros(1), 1)[0]) * machine.speed

    def _bought(self) -> list[Bought]:
        """Drive of the crank, screws of the posts."""

        def named(each: Bought) -> tuple[tuple[str, int], ...]:
            return tuple((self.name(part), count) for part, count in each.at)

        drive = self.bodies.bought(turning_text(self._speed * 60 / math.tau))
        screw = SCREWS[_THREAD]
        grip = -self._low
        size = f"{_THREAD} x {screw.length(grip, self.whole.sizes.base_thickness):g}"
        return [
            *(replace(each, at=named(each)) for each in drive if each.role != "mount"),
            Bought("screw of a post", screw.standard, size, _POSTS, at=(("post", 1),)),
        ]

    def added(self, made: Assembly) -> Assembly:
        """The links over the plate as they are made, and these."""
        parts = [*made.parts, *self._made[0]]
        mounts = [*made.mounts, *self._made[1]]
        features = [*made.features, *self._features()]
        bodies = self.bodies
        face = self.whole.sizes.face
        motor = MotorSeat(crank=self.whole.sizes.hand_crank)
        if face is not None:
            motor = MotorSeat(self.whole.sizes.motor, bodies.shaft_reach, bodies.collar)
        return replace(
            made,
            parts=parts,
            mounts=mounts,
            features=features,
            stand_ins=self._stand_ins(),
            bought=[*self._bought(), *(each for each in made.bought if each.role != "drive")],
            journals=journals(made.machine, features, parts, mounts, made.process.material),
            motor=motor,
        )


def room(sizes: Parts, fits: Print, crank: float, offset: float) -> float:
    """What lies between the hole of the arm's shaft and its slot, mm."""
    slot = crank - offset - 0.5 - (sizes.pin_diameter + fits.slide_clearance) / 2
    return slot - (sizes.shaft_diameter + fits.press_clearance) / 2
