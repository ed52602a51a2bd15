"""The counterweight of an eccentric drive: on the motor's shaft, over the keeper washer, against disc, rod and slider."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from typing import TYPE_CHECKING

from camgen.geometry.outlines import circle
from camgen.machine.features import Balance, Mount
from camgen.machines.loads.counterweights import Counterweight, balance_of, first_moment
from camgen.machines.loads.weights import weighed
from camgen.parts.part import Part

if TYPE_CHECKING:
    from camgen.machines.eccentric_drive.mechanism import EccentricDrive


class DiscWeight:
    """A sector pressed on the shaft; sizes mm, moments complex g mm in the disc's axes."""

    def __init__(self, drive: EccentricDrive, spec: Counterweight) -> None:
        self.drive, self.spec = drive, spec

    @cached_property
    def whole(self) -> complex:
        """Moment of all that turns with the disc."""
        return self.spec.whole(weighed(self.drive, self.drive.own_parts, self.drive.own_mounts).machine, "disc", "O")

    @cached_property
    def _made(self) -> tuple[Part, list[tuple[Part, complex]], float]:
        drive, wall = self.drive, self.drive.allowed.min_wall
        own = first_moment("disc", 0j, drive.own_parts, drive.own_mounts, drive.density)
        hub = drive.bore / 2 + max(drive.making.strap_wall, wall)
        note = "press and glue on the motor's shaft above the keeper washer, across from the disc's thick side as drawn"
        return self.spec.fitted(
            self.whole - self.spec.other, own, hub, circle(0j, drive.bore / 2), drive.making.rod_thickness, drive.density,
            drive.print, wall, note,
        )  # fmt: skip

    @property
    def parts(self) -> Sequence[Part]:
        """The sector, and its pins."""
        return (self._made[0], *(pin for pin, _ in self._made[1][:1]))

    @property
    def mounts(self) -> Sequence[Mount]:
        """On the disc's body, up to the end of the shaft."""
        part, pins, _ = self._made
        z = self.drive.shaft_length - part.thickness
        return (Mount(part.name, "disc", z=z), *(Mount(pin.name, "disc", at, z=z) for pin, at in pins))

    @property
    def balance(self) -> Balance:
        """What the written solids are held to."""
        drive = self.drive
        return balance_of("disc", "O", 0j, self.whole - self.spec.other, drive.parts(), drive.mounts(), drive.density)
