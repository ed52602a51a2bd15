"""What a search is asked for: the tables and the text of a spec with [wanted], and whom it tells how it goes."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

from camgen import reading
from camgen import spec as specs
from camgen.design.found import Found
from camgen.design.front import Front
from camgen.design.wanted import asked_for, wish, without
from camgen.edits import with_tables
from camgen.errors import Fault, SpecError, counted

if TYPE_CHECKING:
    from camgen.parts.generator.sizes import Parts

Say = Callable[[str], None]
Keep = Callable[[Front], None] | None

_MADE = (
    "points",
    "links",
    "lengths",
    "output",
    "slide",
    "slot",
    "gear",
    "cam",
    "layers",
)  # tables that a search makes
# points of a four-bar that stands for any linkage
_FOUR_BAR = {"O": [0, 0], "C": [70, 0], "A": [20, 0], "B": [45, 40], "P": [20, 60]}


@dataclass(frozen=True)
class Request:
    """What a search is to do."""

    data: reading.Data  # tables of the spec
    source: str
    folder: Path
    text: str | None  # of the spec, where it is to be kept
    ends: str  # of its lines
    jobs: int
    say: Say  # takes a line on how it goes
    keep: Keep  # takes the front

    @cached_property
    def rest(self) -> reading.Data:
        """The tables less [wanted]."""
        return without(self.data)

    def with_lash(self, key: str, lash: float | None) -> reading.Data:
        """The tables less [wanted], with the play that a wish bears as limits.KEY."""
        if lash is None:
            return self.rest
        return {**self.rest, "limits": {key: lash, **self.rest.get("limits", {})}}

    def wish(self) -> Any:
        """What is wanted, a record of its kind; SpecError with its faults."""
        return wish(self.data, self.source)

    def checked(self, *looks: Callable[[], object]) -> list[Any]:
        """What each look gives; SpecError with the faults of all of them."""
        results = list[Any]()
        faults = dict[Fault, None]()
        for look in looks:
            try:
                results.append(look())
            except SpecError as error:
                faults |= dict.fromkeys(error.faults)
        if faults:
            raise SpecError(list(faults), self.source)
        return results

    def for_linkage(
        self, *looks: Callable[[], object], of_drive: Sequence[str] = ()
    ) -> tuple[Parts, Any]:
        """Sizes of the parts and what the last look gives; SpecError with all faults that show before a search.

        of_drive: keys of [drive] that the search makes.
        """
        *_, sizes, found = self.checked(
            lambda: self._refuse_made_tables(of_drive), self._sizes, *looks
        )
        return sizes, found

    def spec_of(self, each: Found, note: str) -> str:
        """The spec of a design: the text that was given with what was found, or one of its own."""
        from camgen.machines import MECHANISMS, load

        data = each.data()
        sizes = each.prototype.sizes
        if sizes:
            data = {**data, "parts": {**data.get("parts", {}), **sizes}}
        if self.text is None:
            return specs.dump(specs.validate(load(specs.choose(data, MECHANISMS)), data))
        made: Mapping[str, Any] = {"parts": sizes} if sizes else {}
        keys = ["points", "links", "drive", *(["slide"] if "slide" in data else []), "output"]
        return self.with_found(data, keys, note, made)

    def with_found(
        self,
        data: reading.Data,
        keys: Sequence[str],
        note: str,
        more: Mapping[str, Any] | None = None,
    ) -> str:
        """The text that was given, with the tables that were found in place of [wanted], and the play that the wish bears."""
        assert self.text is not None
        limits = ["limits"] if "lash" in self.data["wanted"] else []
        tables = {key: data[key] for key in [*keys, *limits]} | dict(more or {})
        return with_tables(self.text, tables, ["wanted"], note).replace("\n", self.ends)

    def _refuse_made_tables(self, of_drive: Sequence[str]) -> None:
        """SpecError for tables that a search makes, keys of [drive] among them, and for another mechanism."""
        right = "no table here: camgen design finds it, with [points], [links] and [[output]]"
        faults = [Fault((key,), "a table", right) for key in _MADE if key in self.rest]
        drive = self.rest.get("drive")
        if isinstance(drive, dict):
            faults += [Fault(("drive", key), "given", right) for key in of_drive if key in drive]
        elif drive is not None:
            given = counted(len(drive), "drive") if isinstance(drive, list) else str(drive)
            one = "[drive], one table: what is found has one motor"
            faults.append(Fault(("drive",), given, one))
        if self.data.get("mechanism") != "linkage":
            name = str(self.data.get("mechanism"))
            right = f'"linkage", for a {asked_for(self.data)}'
            faults.append(Fault(("mechanism",), name, right))
        if faults:
            raise SpecError(faults, self.source)

    def _sizes(self) -> Parts:
        """Sizes of the parts; SpecError with the faults of everything that is not found, before a search: seen with a four-bar."""
        from camgen.machines.linkage.mechanism import Linkage

        tables = {key: value for key, value in self.rest.items() if key not in _MADE}
        drive = tables.get("drive")
        links = {"ground": "OC", "crank": "OA", "coupler": "ABP", "rocker": "CB"}
        four_bar = {
            "mechanism": "linkage",
            "points": _FOUR_BAR,
            "links": {name: list(points) for name, points in links.items()},
            "drive": {"link": "crank", **(drive if isinstance(drive, dict) else {})},
            "output": [{"name": "path", "point": "P"}],
        }
        return specs.validate(Linkage, {**tables, **four_bar}, self.source).making
