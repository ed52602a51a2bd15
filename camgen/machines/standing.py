"""Cam mechanisms whose cams are made alone, or with parts.make = "machine" all that it takes to turn them on a bench."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import cached_property
from typing import TYPE_CHECKING, Any

from pydantic import Field, model_validator

from camgen.errors import Fault
from camgen.machine.features import CamOutline, Demand, Mount
from camgen.machine.model import Machine
from camgen.machines.linkage import sheets
from camgen.machines.mechanism import Mechanism, Remarks
from camgen.parts import materials
from camgen.parts.assembly import Assembly, FollowerFacts, MotorSeat
from camgen.parts.disc_cams import CamParts
from camgen.parts.generator.sizes import Parts
from camgen.parts.journals import MaterialLimits
from camgen.parts.part import Part
from camgen.parts.set_screws import SetScrewHub
from camgen.parts.springs import to_wind, wished
from camgen.parts.stiffness import bending_stiffness

if TYPE_CHECKING:
    from camgen.machines.bench import Bench


class Sizes(Parts):
    """Sizes of the parts of a machine, as [parts] of a linkage has them."""


class CamTables(Mechanism):
    """Base of mechanisms whose spec makes the cams alone, by [parts], or a whole machine, by [bodies]."""

    bodies: Sizes | None = Field(
        default=None,
        description='make = "machine": sizes of its parts, as [parts] of a linkage (specs/linkage.toml)',
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
                    ("parts", "shaft"),
                    self.bodies.shaft,
                    '"through": no link turns on a point of the cam',
                )
            )
        if self.bodies.discs:
            right = "nothing here: no link of this machine turns on an eccentric"
            faults.append(Fault(("parts", "discs"), "", right))
        if self.bodies.thread_posts:
            right = "nothing here: no thread is an output of this machine"
            faults.append(Fault(("parts", "thread_posts"), "", right))
        found = [replace(fault, path=("bodies", *fault.path[1:])) for fault in faults]
        return [
            *found,
            *sheets.faults(self.bodies, self.laser, "bodies", int(slides), int(grooves)),
        ]

    def remarks(self) -> Remarks:
        """Keys of [parts] that are set, not as the starter sets them, and that those of [bodies] replace."""
        making = getattr(self, "making", None)
        if making is None or not self.standing:
            return Remarks()
        fields = {
            key: (getattr(making, key), field)
            for key, field in type(making).model_fields.items()
            if key != "make"
        }
        unused = [
            f"parts.{key}"
            for key, (value, field) in fields.items()
            if value not in (field.default, *(field.examples or ()))
        ]
        return Remarks(unused=unused)

    @property
    def _material_limits(self) -> MaterialLimits:
        """With the keys of [bodies] of a machine."""
        found = super()._material_limits
        if not self.standing:
            return found
        return replace(found, table="bodies", keys=frozenset(type(self.sizes).model_fields))

    def _found(self) -> Mapping[str, object]:
        """Sizes of a machine's bodies, and what every mechanism fills in."""
        return {
            **super()._found(),
            **({"bodies": self.sizes.model_dump()} if self.standing else {}),
        }


class StandingCams(CamTables):
    """Base of those that say their cams alone, with the underscored methods, and what they stand on."""

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
    def _asked(self) -> Sequence[Demand]:
        """What is asked of the outputs."""

    @property
    def _spring_wish(self) -> tuple[float, float, float] | None:
        """Rate, N/mm, least pull, N, and travel, mm, of a spring that the spec asks for beside cams alone."""
        return None

    @abstractmethod
    def _stood(self) -> Bench:
        """What they stand on."""

    @cached_property
    def _plates(self) -> Sequence[Part]:
        """The parts, made once."""
        return self._cams()

    @cached_property
    def bench(self) -> Bench:
        """The same, made once."""
        return self._stood()

    # ---- either -----------------------------------------------------------------------------------------------------

    def _unloaded(self) -> Machine:
        """The model of the cams alone, or of what is made."""
        return self.bench.machine if self.standing else self._alone()

    @cached_property
    def assembly(self) -> Assembly:
        """The cams, or the whole machine."""
        return self._machine() if self.standing else self._bare()

    def _bare(self) -> Assembly:
        """The cams alone."""
        made = self._assembly(self._plates, self._beside(), self._outlines())
        spring = wished(self._spring_wish)
        hub = self._hub
        return replace(
            made,
            springs=spring,
            bought=[*([] if hub is None else hub.bought(self._hub_radius)), *to_wind(spring)],
            motor=MotorSeat(hub=hub),
            follower=FollowerFacts(wish=self._spring_wish),
            demands=self._asked(),
        )

    def _machine(self) -> Assembly:
        """What stands on a bench."""
        bench, sizes = self.bench, self.sizes
        made = self._assembly(bench.parts, bench.mounts, bench.features())
        motor = MotorSeat(hub=bench.bodies.collar)
        if sizes.face is not None:
            motor = MotorSeat(sizes.motor, bench.bodies.shaft_reach, bench.bodies.collar)
        return replace(
            made,
            stand_ins=bench.stand_ins(),
            coils=bench.coils,
            bought=bench.bought(),
            springs=bench.springs,
            posts=bench.posts(self.material.name),
            motor=motor,
            shaft=bench.bodies.shaft,
            follower=FollowerFacts(self._arm_stiffness),
            board=bench.bodies.stands,
            demands=self._asked(),
        )

    @property
    def _arm_stiffness(self) -> float | None:
        """Of the follower that swings; None of one that slides."""
        points = self.bench.bodies.layout.points_of("follower")
        if not {"pivot", "tip"} <= points.keys():
            return None
        arm = next(part for part in self.bench.parts if part.name == "follower")
        held, pushed = points["pivot"], points["tip"]
        modulus = materials.of(self.material.name).elastic.modulus
        return bending_stiffness(arm, held, pushed, modulus) * abs(pushed - held) ** 2 * 1e-3

    @property
    def _hub(self) -> SetScrewHub | None:
        """Of a cam alone its own."""
        making, allowed = getattr(self, "making", None), getattr(self, "allowed", None)
        return (
            making.hub(allowed.min_wall)
            if isinstance(making, CamParts) and allowed is not None
            else None
        )

    @property
    def _hub_radius(self) -> float:
        """Of a cam alone, mm."""
        making = getattr(self, "making", None)
        return making.hub_diameter / 2 if isinstance(making, CamParts) else 0.0
