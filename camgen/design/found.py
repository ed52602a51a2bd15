"""A linkage that a search found: as drawn, what is judged of it by value, and the spec that it makes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

from camgen.design.prototype import Prototype, miss, prototype, rounded_up
from camgen.reading import Data
from camgen.report.sketches import Sketch

CRANK = "crank"
_DIGITS = 6  # of a coordinate, mm
_SPARE = 1e-3  # mm or deg, by which a tolerance is more than an error


@dataclass(frozen=True)
class Judged:
    """What is judged of one output by value."""

    output: Data  # its name, and its point or link
    target: str  # key of the target in the output's table
    values: Data  # of the target, less its tolerance
    code: str  # of the finding
    error: float  # mm or deg, of the design
    allowance: float  # mm or deg, that is borne
    unit: str
    key: str = "tolerance"  # of [wanted] that sets the allowance
    default: str = ""  # what the allowance is where the wish does not say it
    limit: str = "tolerance"  # key of the target that holds it

    @property
    def least_tolerance(self) -> float:
        """A tolerance that the design keeps: its own error and a fiftieth."""
        return rounded_up(1.02 * self.error + _SPARE)

    @property
    def tolerance(self) -> float:
        """Of the spec that is written: the one that is wanted, or what the design keeps and no more than is borne."""
        return min(self.least_tolerance, self.allowance) if self.default else self.allowance

    @property
    def miss(self) -> str:
        """What of the wish is not kept; empty where it is."""
        return miss(self.code, self.error, self.allowance, self.unit)

    def table(self, tolerance: float) -> Data:
        """Of [[output]]."""
        return {**self.output, self.target: {**self.values, self.limit: tolerance}}


@dataclass(frozen=True)
class Found:
    """A linkage and the wish, as a machine of some spec's other tables."""

    places: Mapping[str, complex]  # of its points, as drawn, mm
    links: Mapping[str, Sequence[str]]
    drive: Data
    judged: Sequence[Judged]
    figures: Mapping[str, float]  # columns of a front's table
    loss: float  # less is better, of designs that are as near as each other
    sketch: Sketch
    tables: Data  # of the spec, less what is found
    slides: Sequence[Data] = field(default=())

    @property
    def miss(self) -> str:
        """What of the wish it does not keep; empty where it keeps all."""
        return "; ".join(each.miss for each in self.judged if each.miss)

    @property
    def farthest(self) -> Judged:
        """What is judged and is off by the greatest share of what is borne."""
        return max(self.judged, key=lambda each: each.error / each.allowance)

    @property
    def share(self) -> float:
        """Its greatest error as a share of what is borne."""
        return self.farthest.error / self.farthest.allowance

    def data(self) -> Data:
        """Tables of the spec."""
        return self._tables([each.table(each.tolerance) for each in self.judged])

    def _tables(self, judged: Sequence[Data]) -> Data:
        output: dict[str, Data] = {}
        for table in judged:
            output[table["name"]] = {**output.get(table["name"], {}), **table}
        drive = {**self.tables.get("drive", {}), **self.drive}
        points = {name: place(z) for name, z in self.places.items()}
        links = {name: list(points) for name, points in self.links.items()}
        own = {"points": points, "links": links, "drive": drive}
        own |= {"slide": list(self.slides)} if self.slides else {}
        own |= {"output": list(output.values())}
        return {**{key: value for key, value in self.tables.items() if key not in own}, **own}

    @cached_property
    def prototype(self) -> Prototype:
        """Whether it can be made, and its play."""
        output = [each.table(each.least_tolerance) for each in self.judged]
        return prototype(self._tables(output), self.miss)

    def row(self, number: int) -> dict[str, Any]:
        """What a table of the front shows."""
        figures = {name: _rounded(value) for name, value in self.figures.items()}
        return {"design": number, **figures, **self.prototype.row}


def place(z: complex) -> list[float]:
    """A point as a spec has it, mm."""
    return [round(float(z.real), _DIGITS) + 0.0, round(float(z.imag), _DIGITS) + 0.0]


def _rounded(value: float) -> float:
    return value if isinstance(value, int) else float(f"{round(value, 9):.5g}")
