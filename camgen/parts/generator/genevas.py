"""Geneva drives of a linkage: the slotted wheel and the disc that locks it on one level, with the roller on the crank's pin.

An inner wheel is a ring round its crank, on dowels under its link; its lock is a crescent on dowels over the crank, whose
shaft ends below them. The disc of an outer wheel that has a gap over its crank stands on that, on their shaft, with a dowel.
"""

from __future__ import annotations

import cmath
import math
from dataclasses import dataclass
from typing import Literal

import numpy as np

from camgen.errors import DesignError
from camgen.geometry.outlines import Contour
from camgen.machine import model as m
from camgen.parts.generator.wheels import EdgeDrive, Roller, Wheel
from camgen.parts.part import HoldingNote
from camgen.parts.wheels.geneva import Geneva, InnerGeneva

_FACED = (
    "as it goes on, turn it until a hollow lies round the locking disc, or a slot round the roller"
)


@dataclass(frozen=True)
class DowelledEdge:
    """A ring or a lock that dowels hold on its link; mm, places as drawn, from the axis about which its link turns."""

    wheel: Wheel
    part: str
    edge: Contour  # of the ring's opening, of the lock
    within: float  # least radius of what the ring takes; 0 of a lock
    outside: float  # greatest radius
    dowels: tuple[complex, ...]
    lies: Literal["under", "over", "below"]  # its link, or somewhere below it
    between: str = ""


@dataclass(frozen=True)
class GenevaWish:
    """What is asked of a Geneva drive."""

    geneva: Geneva | InnerGeneva
    point: str  # of the crank, where its roller is
    gap: float | None = (
        None  # over the crank, mm, which a lock on a dowel fills; None: as between all levels
    )


@dataclass(frozen=True)
class GenevaDrive(EdgeDrive):
    """A Geneva drive of a machine."""

    wish: GenevaWish
    kind = "geneva"
    remedy = "put the shafts further apart, or use a smaller pin_radius"

    @property
    def geneva(self) -> Geneva | InnerGeneva:
        """Its wheel and disc."""
        return self.wish.geneva

    def part_on(self, link: str) -> str:
        """Name of the part on the shaft of one of its links: the slotted wheel, or the disc that locks it."""
        return f"{'lock' if link == self.joint.cam else 'geneva'}-{self.level}"

    @property
    def lock(self) -> Wheel:
        """What locks the wheel."""
        link = self.joint.cam
        return Wheel(self.level, link, self.geneva.lock, f"locking disc of {link}")

    @property
    def slotted(self) -> Wheel:
        """The slotted wheel."""
        link = self.joint.follower
        return Wheel(self.level, link, self.geneva.rim, f"Geneva wheel of {link}")

    @property
    def inner(self) -> bool:
        """Whether the wheel goes round its crank."""
        return isinstance(self.geneva, InnerGeneva)

    @property
    def wheels(self) -> tuple[Wheel, ...]:
        """Disc and slotted wheel on their shafts; none of those that dowels hold."""
        return () if self.inner else (self.lock, self.slotted)

    def dowelled(self, machine: m.Machine, rim: float) -> tuple[DowelledEdge, ...]:
        """Crescent and ring on their dowels; rim: of the ring beyond its slots, mm."""
        geneva = self.geneva
        if not isinstance(geneva, InnerGeneva):
            return ()
        lock, opening = self.edges(machine)
        pin, slot = self._directions(machine)
        on_ring = (
            slot * cmath.rect(geneva.reach + rim / 2, geneva.pitch / 2 + math.tau * k / 3)
            for k in range(3)
        )
        crescent = DowelledEdge(
            self.lock,
            self.part_on(self.joint.cam),
            lock,
            within=0.0,
            outside=geneva.lock,
            dowels=tuple(pin * z for z in geneva.seats),
            lies="over",
        )
        ring = DowelledEdge(
            self.slotted,
            self.part_on(self.joint.follower),
            opening,
            within=geneva.rim,
            outside=geneva.reach + rim,
            dowels=tuple(on_ring),
            lies="below",
        )
        return crescent, ring

    def pinned(self, machine: m.Machine, hub: float) -> DowelledEdge | None:
        """The lock of an outer wheel on its dowel, opposite the pin; hub: radius about the dowel, mm. None of one without a gap."""
        geneva = self.geneva
        if isinstance(geneva, InnerGeneva) or self.wish.gap is None:
            return None
        pin, _ = self._directions(machine)
        return DowelledEdge(
            self.lock,
            self.part_on(self.joint.cam),
            self.edges(machine)[0],
            within=0.0,
            outside=geneva.lock,
            dowels=((hub - geneva.lock) * pin,),
            lies="over",
        )

    def refuse_tipping(self, lean: float) -> None:
        """DesignError where crank and wheel tip by more than the gap between them; lean: of their shafts in the plate, rad."""
        tip = lean * self.geneva.distance  # of both together, where their rims pass each other
        gap = self.wish.gap or 0.0
        if gap < tip:
            said = f"crank and wheel tip by {tip:.3g} mm in the play of their shafts, more than the gap of {gap:g} mm between them"
            remedy = "use a greater geneva.gap or a thicker parts.base_thickness"
            where = f"geneva {self.joint.name}"
            error = DesignError("gap between crank and wheel", gap, tip, "mm", where, remedy)
            raise error.saying(said)

    @property
    def roller(self) -> Roller:
        """On the crank's pin."""
        about = f"Geneva drive {self.joint.name}"
        joint = self.joint
        lock = self.lock
        pin = self.geneva.pin
        down = not self.inner and self.wish.gap is not None
        return Roller(
            self.level, joint.name, joint.cam, self.wish.point, pin, lock, about, down=down
        )

    def edges(self, machine: m.Machine) -> tuple[Contour, Contour]:
        """Of disc and wheel about their axes, as drawn at theta = 0."""
        pin, slot = self._directions(machine)
        return self.geneva.lock_disc().moved(pin), self.geneva.wheel().moved(slot)

    def table(self, link: str) -> tuple[str, ...]:
        """Data of the slotted wheel or of its lock as a workshop reads them beside its drawing."""
        geneva = self.geneva
        roller = f"{2 * geneva.pin:g}, axes {geneva.distance:.6g} apart"
        if link == self.joint.cam:
            return (
                f"locks on R {geneva.lock:.6g} in hollows of R {geneva.hollow:.6g}",
                f"the pin is on R {geneva.crank:.6g}, its roller {roller}; the relief is towards it",
            )
        floor = f"{geneva.floor:.3g} or more beyond the roller"
        data = (f"for a roller of {roller}", f"the slots end {floor}")
        return data if self.inner else (*data, HoldingNote(_FACED))

    def _directions(self, machine: m.Machine) -> tuple[complex, complex]:
        """Where the pin is from the crank's axis, and the slot that it drives from the wheel's, unit complex, as drawn."""
        joint = self.joint
        line = -self.line(machine)  # from the wheel to the crank
        angle = float(machine.start_of(joint.cam).angle) - joint.phase
        slot = line * cmath.exp(1j * float(joint.law(np.array(angle), 0)))
        return self.geneva.sense * line * cmath.exp(1j * angle), slot
