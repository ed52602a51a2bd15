"""Tables of mechanisms whose cams are made alone, or with parts.make = "machine" all that it takes to turn them on a bench."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Mapping
from dataclasses import replace
from functools import cached_property
from typing import Any

from pydantic import Field, model_validator

from camgen.errors import Fault
from camgen.machines.linkage import sheets
from camgen.machines.mechanism import Mechanism, Remarks
from camgen.parts.generator.sizes import Parts
from camgen.parts.journals import MaterialLimits


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
        for name in self.bodies.thread_post_sizes.diameters:
            right = "a point of a thread, and this machine has none"
            faults.append(Fault(("parts", "thread_posts", "diameters", name), "", right))
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
