"""A linkage that a search found for a few positions: as drawn, what is judged of it, and which ones are weighed as machines."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, Protocol

import numpy as np

from camgen.design.front import with_prototype
from camgen.design.prototype import Prototype, miss, prototype, rounded_up
from camgen.numerics import Floats
from camgen.reading import Data
from camgen.report.sketches import Sketch

CRANK = "crank"
NO_ERROR = 0.02  # of what is borne: less does not count
_DIGITS = 6  # of a coordinate, mm
_SPARE = 1e-3  # mm or deg, by which a tolerance is more than an error
_AT_ONCE = 6  # designs that are weighed together
_ENOUGH = 4  # of use: then no more are weighed
_ELSEWHERE = 0.02  # of all losses' range: designs that are nearer to one another count as one
_MOST = 32  # weighed at most


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
    key: str  # of [wanted] that sets the allowance
    given: bool = False  # whether the wish says it
    limit: str = "tolerance"  # key of the target that holds it

    @property
    def least_tolerance(self) -> float:
        """A tolerance that the design keeps: its own error and a fiftieth."""
        return rounded_up(1.02 * self.error + _SPARE)

    @property
    def tolerance(self) -> float:
        """Of the spec that is written: the one that is wanted, or what the design keeps and no more than is borne."""
        return self.allowance if self.given else min(self.least_tolerance, self.allowance)

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
        figures = {name: float(f"{round(value, 9):.5g}") for name, value in self.figures.items()}
        return {"design": number, **figures, **self.prototype.row}


def place(z: complex) -> list[float]:
    """A point as a spec has it, mm."""
    return [round(float(z.real), _DIGITS) + 0.0, round(float(z.imag), _DIGITS) + 0.0]


class Runner(Protocol):
    """`map`, or that of several cores."""

    def __call__(self, task: Callable[[Found], Found], each: Sequence[Found], /) -> Iterable[Found]:
        """What the task makes of each, in their order."""


def weighed(
    losses: Floats, of: Callable[[int], Found], run: Runner, say: Callable[[str], None]
) -> list[Found]:
    """Designs weighed as machines, front after front, until some are of use.

    losses: (designs, 2), of which less is better; of: makes the design of a number.
    """
    remaining = np.arange(len(losses))
    looked: list[Found] = []
    useful = 0
    while remaining.size and len(looked) < _MOST and useful < _ENOUGH:
        layer = _front(losses[remaining])
        spread = np.unique(np.linspace(0, len(layer) - 1, min(len(layer), _AT_ONCE)).astype(int))
        chosen = remaining[layer[spread]]
        looked += run(with_prototype, [of(int(k)) for k in chosen])
        useful = sum(each.prototype.of_use for each in looked)
        say(f"{len(looked)} designs judged, {useful} of them can be built and keep the limits")
        near = np.min(
            np.max(np.abs(losses[remaining][:, None] - losses[chosen]) / _scale(losses), axis=2),
            axis=1,
        )
        remaining = remaining[near > _ELSEWHERE]
    return looked


def _scale(losses: Floats) -> Floats:
    return np.asarray(np.maximum(np.ptp(losses, axis=0), 1e-300))


def _front(losses: Floats) -> np.ndarray:
    """Numbers of those that no other one beats in both, by the first."""
    order = np.lexsort((losses[:, 1], losses[:, 0]))
    second = losses[order, 1]
    before = np.concatenate([[np.inf], np.minimum.accumulate(second)[:-1]])
    return np.asarray(order[second < before])
