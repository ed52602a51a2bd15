"""Wheels of gears as a linkage has them: pairs on the ground, planetary sets, rings on their links.

planet    turns on a pin of the carrier; all planets of a set are one part
ring      a plate of its own on dowels: under its link, which lies over what runs in it, or on the ground's plate
sun       of a set whose sun stands still a plate of its own on dowels, on the ground's plate round the shaft
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Literal

from camgen.errors import DesignError
from camgen.machine import model as m
from camgen.machine.features import Teeth
from camgen.parts.gears import GearWish, pair
from camgen.parts.generator.wheels import Wheel, level_of, pivot
from camgen.parts.wheels import involute
from camgen.parts.wheels.mesh import Mesh
from camgen.parts.wheels.planets import PlanetSet, seats

DOWELS = 3  # of a ring on its link, or a sun on the ground


@dataclass(frozen=True)
class GearWheel:
    """A gear's wheel, or its ring with inner teeth."""

    level: str
    link: str
    part: str  # name of its part
    mesh: Mesh  # with its mate
    gear: involute.Wheel | involute.Ring  # this one
    spokes: int
    tooth: float  # rad, direction of a tooth in its part's frame
    turned: float = 0.0  # rad, of that frame on the ground as drawn
    beside: str = ""  # a link that turns about its axis, of a wheel on the ground

    def teeth(self, mesh: Mesh) -> Teeth:
        """On what it is measured, with one of its mates."""
        gear = self.gear
        share = gear.teeth / abs(mesh.a.teeth + mesh.side * mesh.b.teeth)
        radius = mesh.distance * share
        inside = isinstance(gear, involute.Ring)
        half = gear.half_angle(radius)
        thickness = 2 * radius * (gear.pitch / 2 - half if inside else half)
        return Teeth(self.part, gear.teeth, radius, thickness, self.tooth, gear.bends, inside)

    @property
    def wheel(self) -> Wheel:
        """Its disc."""
        return Wheel(self.level, self.link, self.gear.tip, f"wheel of {self.link}")


@dataclass(frozen=True)
class GearPair:
    """Both wheels of a gear. joint: of the machine, or a relation that holds because of its joints, `implied`."""

    joint: m.Gear
    mesh: Mesh
    a: GearWheel
    b: GearWheel
    implied: bool = False


@dataclass(frozen=True)
class PlanetWish:
    """What is asked of a planetary set: links by what they are, the ground for the one that is fixed."""

    level: str
    sun: str
    planets: tuple[tuple[str, str], ...]  # links, and the points of their pins
    carrier: str
    ring: str
    teeth: tuple[int, int, int]  # of sun, planet, ring
    joints: tuple[str, ...]  # each planet's with the sun, the first one's with the ring

    @property
    def turning(self) -> list[str]:
        """Links that turn about its axis, in the order in which they lie over each other."""
        return [link for link in (self.sun, self.carrier, self.ring) if link != m.GROUND]


@dataclass(frozen=True)
class DowelledWheel:
    """A wheel that dowels hold: a ring of inner teeth on its link, in the rim round its root; a sun on the ground, between bore and root."""

    wheel: GearWheel
    edge: float  # mm, radius of the ring's rim, of the sun's bore
    between: str = ""  # link that turns between a ring and its link

    @property
    def part(self) -> str:
        """Name of its part."""
        return self.wheel.part

    @property
    def lies(self) -> Literal["under", "over", "below"]:
        """Whether it lies under its link, over it, or somewhere below it."""
        if self.between:
            return "below"
        return "over" if self.wheel.link == m.GROUND else "under"

    @property
    def gear(self) -> involute.Wheel | involute.Ring:
        """Its teeth."""
        return self.wheel.gear

    @property
    def within(self) -> float:
        """Least radius of what it takes, mm."""
        return self.gear.tip if isinstance(self.gear, involute.Ring) else 0.0

    @property
    def outside(self) -> float:
        """Greatest radius, mm."""
        return self.edge if isinstance(self.gear, involute.Ring) else self.gear.tip

    @property
    def dowels(self) -> list[complex]:
        """Places of its dowels as drawn, from its axis, mm; the first behind a tooth."""
        radius = (self.gear.root + self.edge) / 2
        turns = (self.wheel.tooth + math.tau * k / DOWELS for k in range(DOWELS))
        return [cmath.rect(radius, turn) for turn in turns]


@dataclass(frozen=True)
class _Making:
    """What all wheels have in common: backlash, and the least module that can be made, mm."""

    machine: m.Machine
    backlash: float
    least: float

    def pair(self, name: str, wish: GearWish) -> GearPair:
        """Both wheels of a gear, a's tooth in b's gap on the line of their axes: beyond a's axis where b is a ring."""
        joint = self.joint(name)
        where = name if name.startswith("gear") else f"gear {name}"
        if joint.carrier != m.GROUND:
            remedy = "let both links of this [[gear]] turn on the ground, or make them a set of [[planets]]"
            said = f"the axes of {where} lie on link {joint.carrier}, which moves, and no wheels are made on such"
            raise DesignError("carriers that move", 1, 0, "", where, remedy).saying(said)
        way = pivot(self.machine, joint.b)[1] - pivot(self.machine, joint.a)[1]
        mesh = pair(abs(way), joint.ratio, self.backlash, self.least, wish, where)
        inner = mesh.side < 0
        line = cmath.phase(way) + math.pi * inner
        opposite = line + math.pi * (not inner) + math.pi / mesh.b.teeth
        level = level_of(name)
        part = f"gear-{level}"
        a = GearWheel(level, joint.a, f"{part}-{joint.a}", mesh, mesh.a, wish.spokes, line)
        b = GearWheel(level, joint.b, f"{part}-{joint.b}", mesh, mesh.b, wish.spokes, opposite)
        return GearPair(joint, mesh, a, b)

    def joint(self, name: str) -> m.Gear:
        """A gear of the machine."""
        joint = self.machine.joint(name)
        assert isinstance(joint, m.Gear)
        return joint

    def planets(self, wish: PlanetWish) -> list[GearPair]:
        """Those of a set: a tooth of the sun points to the first planet, and all others follow."""
        beside = wish.turning[0]
        centre = pivot(self.machine, beside)[1]
        arm = self._first_pin(wish) - centre
        sun, planet, ring = wish.teeth
        where = f"planets {wish.level}"
        outer = pair(abs(arm), -sun / planet, self.backlash, self.least, GearWish(sun), where)
        asked = GearWish(planet, inner=True)
        inner = pair(abs(arm), planet / ring, self.backlash, self.least, asked, where)
        self._refuse_near(wish, outer, inner, where)
        way = cmath.phase(arm)
        level = level_of(wish.level)
        on_sun = GearWheel(
            level, wish.sun, f"gear-{level}-sun", outer, outer.a, 0, way, beside=beside
        )
        near = math.pi * (
            1 + 1 / planet
        )  # of a planet's tooth from the line, a tooth of the sun on that
        turned = math.remainder(near, math.tau / planet) * planet / ring
        tooth = way + turned + math.pi / ring
        named_ring = level, wish.ring, f"gear-{level}-ring"
        on_ring = GearWheel(*named_ring, inner, inner.b, 0, tooth, beside=beside)
        *with_sun, with_ring = map(self.joint, wish.joints)
        pairs = []
        for k, seat in enumerate(seats(wish.teeth, len(wish.planets))):
            link = wish.planets[k][0]
            turn = math.remainder(way + seat + near + seat * sun / planet, math.tau)
            wheel = GearWheel(level, link, f"gear-{level}", outer, outer.b, 0, 0.0, turn)
            pairs.append(GearPair(with_sun[k], outer, on_sun, wheel))
            to_ring = replace(with_ring, name=f"{link} to {wish.ring}", a=link)
            pairs.append(GearPair(to_ring, inner, wheel, on_ring, k > 0))
        return pairs

    def _first_pin(self, wish: PlanetWish) -> complex:
        """Where the first planet turns, as drawn on the ground, mm."""
        point = complex(self.machine.body(wish.carrier).points[wish.planets[0][1]])
        if wish.carrier == m.GROUND:
            return point
        pose = self.machine.start_of(wish.carrier)
        return complex(pose.place + cmath.exp(1j * pose.angle) * point)

    def _refuse_near(self, wish: PlanetWish, outer: Mesh, inner: Mesh, where: str) -> None:
        """DesignError, with how many there may be, where planets meet."""
        count = len(wish.planets)
        try:
            PlanetSet(outer, inner, count, self.backlash)
        except DesignError as error:
            room = 2 * outer.b.tip + self.backlash
            whole = wish.teeth[0] + wish.teeth[2]
            most = math.floor(math.pi / math.asin(min(1.0, room / 2 / outer.distance)))
            even = max((k for k in range(1, most + 1) if whole % k == 0), default=1)
            remedy = f"use planets.count = {even}, or a larger sun: planets.teeth"
            facts = error.quantity, error.value, error.limit, error.unit, where, remedy
            raise DesignError(*facts) from None


def gear_pairs(
    machine: m.Machine,
    gears: Mapping[str, GearWish],
    sets: Sequence[PlanetWish],
    backlash: float,
    least: float,
) -> list[GearPair]:
    """All pairs of wheels, those of planetary sets too.

    gears: what is asked of each; backlash, and the least module that can be made, mm.
    """
    making = _Making(machine, backlash, least)
    pairs = [making.pair(name, wish) for name, wish in gears.items()]
    return [*pairs, *(each for wish in sets for each in making.planets(wish))]
