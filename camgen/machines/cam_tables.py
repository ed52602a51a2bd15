"""Tables of mechanisms whose cams are made alone, or with parts.make = "printed" or "laser" all that it takes to turn them."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Collection
from dataclasses import replace
from typing import Any, ClassVar, Literal

from pydantic import Field, model_validator

from camgen.errors import Fault
from camgen.machines.linkage import sheets
from camgen.machines.loads.fitted_motor import model_faults, without_hand
from camgen.machines.mechanism import Remarks
from camgen.machines.metal import bore_notes, motor_notes
from camgen.machines.template import Template
from camgen.parts.disc_cams import OLD_BORES, ShaftHole
from camgen.parts.generator.sizes import Parts
from camgen.reading import Data
from camgen.vocabulary import OldWords, Wording, wording


class CamSizes(ShaftHole, Parts):
    """Sizes of cams that are made alone, and of a machine's bodies, as any linkage has them."""

    make: Literal["cams", "printed", "laser"] = Field(  # type: ignore[assignment]
        default="cams",
        description='"cams": the cams alone; "printed": the whole machine, printed;\n"laser": the whole machine, cut in layers from the '
        "sheet of [laser], with pins and shaft of steel",
    )

    @model_validator(mode="before")
    @classmethod
    def _of_machine(cls, data: Any) -> Any:
        """A machine's sizes are those of a linkage, where nothing else is said."""
        if not isinstance(data, dict) or data.get("make", "cams") == "cams":
            return data
        usual = {key: field.default for key, field in Parts.model_fields.items() if key != "make"}
        own = {key: value for key, value in usual.items() if cls.model_fields[key].default != value}
        return {**own, **data}

    def of_linkage(self) -> dict[str, Any]:
        """[parts] of the linkage that the machine is."""
        keys = {*Parts.model_fields, *self.shapes}
        return self.model_dump(by_alias=True, exclude_none=True, include=keys)


class CamTables(Template):
    """Base of mechanisms whose spec makes the cams alone, or a whole machine."""

    old_words: ClassVar[OldWords] = {
        **Template.old_words,
        **OLD_BORES,
        ("parts", "make", "machine"): ("parts", "make", "printed"),
        ("bodies",): ("parts",),
    }
    hardened = True
    doubled: ClassVar[Collection[str]]  # keys that [parts] of cams alone and [bodies] both had

    @classmethod
    def wording(cls, data: Data) -> Wording:
        """The tables in the words of today: of keys that two tables had, only that of what is made counts."""
        parts = data.get("parts", {})
        bodies = data.get("bodies", {})
        unread: list[str] = []
        make = parts.get("make", "cams") if isinstance(parts, dict) else "cams"
        shaft = ("parts", "bore" if make == "cams" else "shaft_diameter")
        if isinstance(parts, dict) and isinstance(bodies, dict):
            if make == "machine":
                unread = [f"parts.{key}" for key in cls.doubled if key in parts]
                left = {key: value for key, value in parts.items() if key not in cls.doubled}
                data = {**data, "parts": left}
            elif make == "cams" and bodies:
                unused = {"make", *cls.doubled}
                left = {key: value for key, value in bodies.items() if key not in unused}
                data = {**data, "bodies": left}
        found = wording(data, {**cls.old_words, ("motor", "shaft_diameter"): shaft})
        notes = [
            f'{key} is not read with parts.make = "machine": write "printed"' for key in unread
        ]
        found = replace(found, notes=(*found.notes, *notes))
        return found if make == "cams" else without_hand(found)

    @property
    @abstractmethod
    def sizes(self) -> CamSizes:
        """[parts], with what is found of it."""

    @property
    def standing(self) -> bool:
        """Whether the whole machine is made."""
        return self.sizes.make != "cams"

    @classmethod
    def filled(cls, data: Any) -> Any:
        """The tables with what one of them decides in another."""
        return super().filled(sheets.filled(data))

    def size_faults(self, *links: str) -> list[Fault]:
        """What is wrong with [parts], of a machine with these links."""
        sizes = self.sizes
        if self.standing:
            faults = sizes.faults(("ground", *links), self.print.nozzle)
            faults += sheets.faults(sizes, self.laser)
            faults += model_faults(getattr(self, "motor", None), sizes)
        else:
            faults = sizes.misfits()
            if sizes.stand != "none":
                right = '"none", or parts.make = "printed" or "laser": cams alone have no plate'
                faults.append(Fault(("parts", "stand"), repr(sizes.stand), right))
        if sizes.shaft != "through":
            right = '"through": no link turns on a point of the cam'
            faults.append(Fault(("parts", "shaft"), repr(sizes.shaft), right))
        if sizes.discs:
            right = "no value here: no link of this machine turns on an eccentric"
            faults.append(Fault(("parts", "discs"), "", right))
        for name in sizes.thread_post_sizes.diameters:
            right = "a point of a thread, and this machine has none"
            faults.append(Fault(("parts", "thread_posts", "diameters", name), "", right))
        return faults

    def remarks(self) -> Remarks:
        """Of cams alone what does not hold on their shaft; else keys of [parts] that are set, not as the starter sets them, and
        that are those of cams alone."""
        if not self.standing:
            model = getattr(getattr(self, "motor", None), "model", None)
            notes = motor_notes(self.sizes.bore, model)
            return Remarks(warnings=[*bore_notes(self.sizes, self.material.name), *notes])
        unused = [
            f"parts.{key}"
            for key, field in type(self.sizes).model_fields.items()
            if key not in Parts.model_fields
            and getattr(self.sizes, key) not in (field.default, *(field.examples or ()))
        ]
        return Remarks(unused=unused)
