"""Cam mechanisms whose cams are made alone, or with parts.make = "machine" all that it takes to turn them on a bench."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import cached_property
from typing import TYPE_CHECKING, Any

from pydantic import Field, model_validator

from camgen.errors import Fault
from camgen.machine.features import CamOutline, Feature, Mount, Moved, StandIn
from camgen.machine.joining import Module
from camgen.machine.model import Machine
from camgen.machines.linkage import sheets
from camgen.machines.linkage.sizes import Parts
from camgen.machines.linkage.spring_sketches import sketches
from camgen.machines.linkage.spring_steps import finished
from camgen.machines.loads.journals import Journal, Post
from camgen.machines.loads.pins import stronger
from camgen.machines.mechanism import Mechanism
from camgen.parts import materials
from camgen.parts.catalogue import Bought
from camgen.parts.disc_cams import Parts as DiscParts
from camgen.parts.part import Part
from camgen.parts.set_screws import SetScrewHub
from camgen.parts.springs import Mounted
from camgen.parts.stiffness import bending_stiffness
from camgen.study import Sketch, Table

if TYPE_CHECKING:
    from camgen.machines.bench import Bench


class Sizes(Parts):
    """Sizes of the parts of a machine, as [parts] of a linkage has them."""


class StandingCams(Mechanism):
    """Base of mechanisms that say their cams alone, with the underscored methods, and what they stand on."""

    bodies: Sizes | None = Field(
        None, description="sizes of the parts of a machine, as [parts] of a linkage"
    )

    @property
    @abstractmethod
    def standing(self) -> bool:
        """Whether the whole machine is made."""

    @cached_property
    def sizes(self) -> Sizes:
        """Of the machine's bodies."""
        return self.bodies or Sizes.model_validate({})

    @model_validator(mode="before")
    @classmethod
    def _of_sheet(cls, data: Any) -> Any:
        return sheets.filled(data, "bodies")

    def size_faults(self, *links: str, slides: bool = False, grooves: bool = False) -> list[Fault]:
        """What is wrong with [bodies] of a machine with these links; slides, grooves: whether it has such."""
        if self.bodies is None:
            return []
        faults = self.bodies.faults(("ground", *links), self.print.nozzle)
        if self.bodies.shaft != "through":
            faults.append(
                Fault(
                    "parts.shaft",
                    self.bodies.shaft,
                    '"through": no link turns on a point of the cam',
                )
            )
        found = [replace(fault, path=fault.path.replace("parts", "bodies", 1)) for fault in faults]
        return [
            *found,
            *sheets.faults(self.bodies, self.laser, "bodies", int(slides), int(grooves)),
        ]

    # ---- the cams alone ---------------------------------------------------------------------------------------------

    @abstractmethod
    def _alone(self) -> Machine:
        """The model."""

    @abstractmethod
    def _cams(self) -> Sequence[Part]:
        """The parts."""

    @abstractmethod
    def _outlines(self) -> Sequence[CamOutline]:
        """What of them is measured, in the order of the machine's."""

    @abstractmethod
    def _beside(self) -> Sequence[Mount]:
        """Where they are."""

    @abstractmethod
    def _stood(self) -> Bench:
        """What they stand on."""

    @cached_property
    def bench(self) -> Bench:
        """The same, made once."""
        return self._stood()

    def idle(self) -> Sequence[str]:
        """Keys of [parts] that are set, not as the starter sets them, and that those of [bodies] replace."""
        making = getattr(self, "making", None)
        if making is None or not self.standing:
            return ()
        fields = {
            key: (getattr(making, key), field)
            for key, field in type(making).model_fields.items()
            if key != "make"
        }
        return [
            f"parts.{key}"
            for key, (value, field) in fields.items()
            if value not in (field.default, *(field.examples or ()))
        ]

    # ---- either -----------------------------------------------------------------------------------------------------

    def machine(self) -> Machine:
        """The model of the cams alone, or of what is made."""
        return self.bench.machine if self.standing else self._alone()

    @cached_property
    def _parts(self) -> Sequence[Part]:
        return self.bench.parts if self.standing else self._cams()

    def parts(self) -> Sequence[Part]:
        """The cams, or the whole machine."""
        return self._parts

    @cached_property
    def _features(self) -> Sequence[Feature]:
        return self.bench.features() if self.standing else self._outlines()

    def features(self) -> Sequence[Feature]:
        """The outlines of the cams; of a machine all its joints."""
        return self._features

    def mounts(self) -> Sequence[Mount]:
        """All parts on their bodies."""
        return self.bench.mounts if self.standing else self._beside()

    def stand_ins(self) -> Sequence[StandIn]:
        """The follower's tips, where they are not made; a machine's motor."""
        return self.bench.stand_ins() if self.standing else super().stand_ins()

    def moved(self) -> Moved:
        """What the sweep needs, springs too."""
        moved = super().moved()
        if not self.standing:
            return moved
        return replace(
            moved,
            courses=self.bench.sweeping(moved.courses),
            stand_ins=[*moved.stand_ins, *self.bench.coils()],
        )

    def bought(self) -> Sequence[Bought]:
        """Drive, screws and spring of a machine."""
        if self.standing:
            return self.bench.bought()
        made, hub = getattr(self, "making", None), self.hub
        held = (
            hub.bought(made.hub_diameter / 2)
            if hub is not None and isinstance(made, DiscParts)
            else ()
        )
        return (*held, *super().bought())

    @property
    def arm_stiffness(self) -> float | None:
        """Of the follower that swings; None of one that slides."""
        points = self.bench.bodies.layout.points_of("follower") if self.standing else {}
        if not {"pivot", "tip"} <= points.keys():
            return None
        arm, held, pushed = (
            next(part for part in self.parts() if part.name == "follower"),
            points["pivot"],
            points["tip"],
        )
        modulus = materials.of(self.material.name).elastic.modulus
        return bending_stiffness(arm, held, pushed, modulus) * abs(pushed - held) ** 2 * 1e-3

    @property
    def hub(self) -> SetScrewHub | None:
        """Of a machine the collar on its motor's shaft, of a cam alone its own."""
        if self.standing:
            return self.bench.bodies.collar
        made, allowed = getattr(self, "making", None), getattr(self, "allowed", None)
        return (
            made.hub(allowed.min_wall)
            if isinstance(made, DiscParts) and allowed is not None
            else None
        )

    @property
    def shaft_needed(self) -> float | None:
        """Of the motor under the plate."""
        return (
            self.bench.bodies.shaft_reach
            if self.standing and self.sizes.face is not None
            else super().shaft_needed
        )

    @property
    def motor_frame(self) -> str:
        """Its frame."""
        return (
            self.sizes.motor
            if self.standing and self.sizes.face is not None
            else super().motor_frame
        )

    @property
    def return_spring(self) -> Mounted | None:
        """That of the bench; of cams alone one to be wound."""
        if not self.standing:
            return super().return_spring
        spring = self.bench.spring
        return None if spring is None else Mounted(spring, *self.bench.way)

    def mounted_springs(self) -> Mapping[str, Mounted]:
        """That one, and what hangs on other bodies of the bench."""
        if not self.standing:
            return super().mounted_springs()
        further = {
            each.title: Mounted(each.wire, *each.way, on_cam=False)
            for each in self.bench.strung.values()
        }
        return {**super().mounted_springs(), **further}

    def posts(self) -> Sequence[Post]:
        """Of a machine the pins of its springs and its roller."""
        if not self.standing:
            return ()
        from camgen.machines.linkage.posts import posts

        bench, pulls = (
            self.bench,
            {name: each.wire.force(each.way[1]) for name, each in self.bench.strung.items()},
        )
        pulls |= {} if bench.spring is None else {"spring": bench.spring.force(bench.way[1])}
        return tuple(posts(bench.bodies, pulls, self.material.name))

    def stronger(self, pin: Journal) -> str:
        """By keys of [bodies] of a machine."""
        return stronger("bodies", self.sizes, pin) if self.standing else super().stronger(pin)

    def sprung_steps(self, table: Table, module: Module | None = None) -> Table:
        """With the bench's springs."""
        if not self.standing:
            return table
        titles = {
            "spring": "Return spring",
            **{name: each.title for name, each in self.bench.strung.items()},
        }
        return finished(table, self.bench.bodies, self.mounts(), titles, module)

    def spring_sketches(self) -> Sequence[Sketch]:
        """Those of the bench."""
        return sketches(self.bench.bodies.layout, self.courses) if self.standing else ()

    def found(self) -> Mapping[str, object]:
        """Sizes of a machine's bodies, and what every mechanism fills in."""
        return {**super().found(), **({"bodies": self.sizes.model_dump()} if self.standing else {})}
