"""A machine of a paper as a template: its tables become those of a linkage, and its own physics stands beside.

tables     of a spec, with the words of `mechanism = "linkage"`: points, links, drive, joints, sizes
fitting    parts of its own beside those that follow from the joints
additions  what else is said of the linkage: programs of cams that no table says, loads, advice in the spec's own words
findings   its own checks as designed
figures    its own numbers, curves and tables

All else, such as parts, levels, pins, forces, limits of joints, is that of any linkage.
"""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import cached_property
from typing import TYPE_CHECKING, Any, Self

from camgen.findings import Finding
from camgen.machine.features import Demand
from camgen.machine.model import Machine
from camgen.machines.mechanism import Mechanism, Remarks
from camgen.parts.assembly import Assembly
from camgen.spec import validate
from camgen.study import Study, together

if TYPE_CHECKING:
    from camgen.machines.linkage.mechanism import Linkage
    from camgen.machines.linkage.spec import Additions
    from camgen.parts.generator.connections import Fitting
    from camgen.parts.generator.layout import Layout


class Template(Mechanism):
    """Base of machines whose spec says a linkage in other words."""

    @abstractmethod
    def tables(self) -> Mapping[str, Any]:
        """Tables of the linkage that it is; DesignError where there is none."""

    @abstractmethod
    def findings(self) -> Sequence[Finding]:
        """Checks of its own."""

    @abstractmethod
    def figures(self) -> Study:
        """Numbers, curves and tables of its own."""

    @abstractmethod
    def demands(self) -> tuple[Demand, ...]:
        """What is asked of its outputs."""

    def refuse(self) -> None:
        """Raise DesignError where its parts cannot be made, before any is."""

    def fitting(self, layout: Layout) -> Fitting:
        """Parts of its own on a linkage that is laid out."""
        from camgen.parts.generator.connections import Fitting

        return Fitting()

    def additions(self) -> Additions:
        """What is said of the linkage beside its tables."""
        from camgen.machines.linkage.spec import Additions

        return Additions(self.fitting)

    @cached_property
    def linkage(self) -> Linkage:
        """The linkage that it is."""
        from camgen.machines.linkage.mechanism import Linkage  # a cam alone needs none of it

        shared = {
            "print": self.print,
            "material": self.material,
            "accuracy": self.accuracy,
            "files": self.files,
        }
        more = {} if self.laser is None else {"laser": self.laser.model_dump()}
        load = {} if self.load is None else {"load": self.load}
        base = {"mechanism": "linkage", "name": self.name, **shared, **more, **load}
        linkage = validate(Linkage, {**base, **self.tables()})
        vars(linkage)["additions"] = self.additions()
        for name in ("diagram", "drawn"):  # validated without them
            vars(linkage).pop(name, None)
        return linkage

    def _unloaded(self) -> Machine:
        return self.linkage._unloaded()

    @cached_property
    def assembly(self) -> Assembly:
        """That of the linkage, with what is asked here."""
        self.refuse()
        return replace(
            self.linkage.assembly, demands=self.demands(), material_limits=self._material_limits
        )

    def _found(self) -> Mapping[str, object]:
        """The moment of a counterweight, and what every mechanism fills in."""
        weighed = getattr(self, "counterweight", None) is not None
        weight = self.linkage._found() if weighed else {}
        own = {key: value for key, value in weight.items() if key.startswith("counterweight.")}
        return {**super()._found(), **own}

    def resolved(self) -> Self:
        """The spec with everything filled in that camgen works out, on the same linkage."""
        found = super().resolved()
        if "linkage" in vars(self) and self.linkage.counterweight is None:
            vars(found)["linkage"] = self.linkage
        return found

    def remarks(self) -> Remarks:
        """As of a linkage."""
        return self.linkage.remarks()

    def limits(self) -> Sequence[Finding]:
        """Those of a linkage, and its own."""
        return [*self.linkage.limits(), *self.findings()]

    def study(self) -> Study:
        """Its own figures, and those of a linkage."""
        return together([self.figures(), self.linkage.study()])
