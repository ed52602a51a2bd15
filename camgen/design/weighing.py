"""Which designs are weighed as machines: of front after front a few, those that keep the wish first.

hit    a design that is as near to what is wanted as is borne: its parts are made
miss   any other one: its parts are made only where no hit is of use, to say which one could be built
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np

from camgen.design.found import Found
from camgen.design.prototype import tally
from camgen.numerics import Floats, Indices

_AT_ONCE = 6  # hits of a front that are weighed together
_ELSEWHERE = 0.01  # of the range of a front's hits: designs that are nearer to one another in both losses count as one
_MOST = 40  # hits, and
_FAR = 120  # misses, with which no further front is looked at
_ENOUGH = 8  # designs of use: beyond them only those of a less first loss are weighed
_MISSES = 12  # that are weighed where no hit is of use


class Runner(Protocol):
    """`map`, or that of several cores."""

    def __call__(self, task: Callable[[Any], Found], each: Sequence[Any], /) -> Iterable[Found]:
        """What the task makes of each, in their order."""


@dataclass(frozen=True)
class Designs:
    """What a search found before it is weighed: losses (designs, 2), of which less is better, and the design of a number."""

    losses: Floats
    of: Callable[[int], Found]

    def weighed(self, run: Runner, say: Callable[[str], None]) -> list[Found]:
        """Those that were weighed: none of use beats another one that is."""
        remaining = np.arange(len(self.losses))
        drawn: dict[int, Found] = {}
        weighed: dict[int, Found] = {}
        misses: dict[int, Found] = {}
        while remaining.size and len(weighed) < _MOST and len(misses) < _FAR:
            layer = remaining[front(self.losses[remaining])]
            drawn |= {k: self.of(k) for k in layer.tolist() if k not in drawn}
            hits = np.array([k for k in layer.tolist() if not drawn[k].miss], int)
            misses |= {k: drawn[k] for k in layer.tolist() if drawn[k].miss}
            spread = np.linspace(0, len(hits) - 1, min(len(hits), _AT_ONCE)).astype(int)
            chosen = hits[spread].tolist()
            weighed |= zip(chosen, run(with_prototype, [drawn[k] for k in chosen]), strict=True)
            say(tally([each.prototype for each in weighed.values()], len(misses)))
            useful = [k for k, each in weighed.items() if each.prototype.of_use]
            rest = np.setdiff1d(remaining, [*weighed, *misses])
            remaining = self._worth(self._elsewhere(rest, hits[spread], hits), useful)
        if not any(each.prototype.of_use for each in weighed.values()):
            nearest = sorted(misses, key=lambda k: misses[k].share)[:_MISSES]
            made = run(with_prototype, [misses[k] for k in nearest])
            weighed |= zip(nearest, made, strict=True)
        return list(weighed.values())

    def _elsewhere(self, numbers: Indices, chosen: Indices, hits: Indices) -> Indices:
        """Those that differ from all that were chosen of a front's hits."""
        if not chosen.size:
            return numbers
        apart = np.abs(self.losses[numbers][:, None] - self.losses[chosen])
        far = np.any(apart > _ELSEWHERE * np.ptp(self.losses[hits], axis=0), axis=2)
        return np.asarray(numbers[np.all(far, axis=1)])

    def _worth(self, numbers: Indices, useful: Sequence[int]) -> Indices:
        """Those that no design of use beats in both losses; with enough of these, those of a less first loss alone."""
        own, theirs = self.losses[numbers], self.losses[useful]
        if len(useful) >= _ENOUGH:
            return np.asarray(numbers[own[:, 0] < np.min(theirs[:, 0])])
        beaten = np.any(np.all(theirs <= own[:, None], axis=2), axis=1)
        return np.asarray(numbers[~beaten])


def with_prototype(design: Found) -> Found:
    """The same, weighed as a machine: a task of its own."""
    _ = design.prototype
    return design


def front(losses: Floats) -> Indices:
    """Numbers of those that no other one beats in both losses, (designs, 2), by the first."""
    order = np.lexsort((losses[:, 1], losses[:, 0]))
    second = losses[order, 1]
    before = np.concatenate([[np.inf], np.minimum.accumulate(second)[:-1]])
    return np.asarray(order[second < before])
