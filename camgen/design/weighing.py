"""Which designs are weighed as machines: front after front, those that keep the wish first.

hit    a design that is as near to what is wanted as is borne: its parts are made
miss   any other one: its parts are made only where no hit can be built, to say which one could
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any, Protocol

import numpy as np

from camgen.design import paths
from camgen.design.found import Found
from camgen.design.paths import ChainDesign
from camgen.design.prototype import tally
from camgen.numerics import Floats

_AT_ONCE = 6  # designs of a front that are weighed together
_USEFUL = 4  # of use: then no more are weighed
_ELSEWHERE = 0.02  # of all losses' range: designs that are nearer to one another count as one
_MOST = 32  # weighed at most

# of a path
_STEP = 0.02  # least difference of bars of two designs of a front, as a share
_BEHIND = 0.8  # of the error and bars of a design that could be built: the front reaches to those at most so much worse
_LOOKED_AT = 60  # designs at most, and the rest of a front
_ENOUGH = 8  # designs of use: beyond them only nearer ones are weighed
_MISSES = 12  # that are weighed where no hit can be built


class Runner(Protocol):
    """`map`, or that of several cores."""

    def __call__(self, task: Callable[[Any], Found], each: Sequence[Any], /) -> Iterable[Found]:
        """What the task makes of each, in their order."""


def with_prototype(design: Found) -> Found:
    """The same, weighed as a machine: a task of its own."""
    _ = design.prototype
    return design


def weighed(
    losses: Floats, of: Callable[[int], Found], run: Runner, say: Callable[[str], None]
) -> list[Found]:
    """Designs weighed as machines, front after front, until some are of use.

    losses: (designs, 2), of which less is better; of: makes the design of a number.
    """
    remaining = np.arange(len(losses))
    looked: list[Found] = []
    useful = 0
    while remaining.size and len(looked) < _MOST and useful < _USEFUL:
        layer = _front(losses[remaining])
        spread = np.unique(np.linspace(0, len(layer) - 1, min(len(layer), _AT_ONCE)).astype(int))
        chosen = remaining[layer[spread]]
        looked += run(with_prototype, [of(int(k)) for k in chosen])
        useful = sum(each.prototype.of_use for each in looked)
        say(tally([each.prototype for each in looked]))
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


@dataclass(frozen=True)
class PathFront:
    """How designs of a search for a path are made machines, and weighed."""

    of: Callable[[ChainDesign], Found]
    run: Runner
    say: Callable[[str], None]

    def of_all(self, designs: Sequence[ChainDesign]) -> list[Found]:
        """The front of all that are weighed, that of those that can be made and that of those that are of use."""
        remaining = paths.apart(paths.near(designs, paths.front(designs), _BEHIND))
        hits: dict[ChainDesign, Found] = {}
        misses: dict[ChainDesign, Found] = {}
        while len(hits) + len(misses) < _LOOKED_AT:
            layer = paths.front(_worth(remaining, _useful(hits)), _STEP)
            if not layer:
                break
            for design, each in zip(
                layer, self.run(partial(_if_near, self.of), layer), strict=True
            ):
                (misses if each.miss else hits)[design] = each
            self.say(tally([each.prototype for each in hits.values()], len(misses)))
            seen = set(layer)
            remaining = [each for each in remaining if each not in seen]
        if not _useful(hits):
            nearest = sorted(misses, key=lambda design: misses[design].share)[:_MISSES]
            looked = self.run(with_prototype, [misses[design] for design in nearest])
            hits |= dict(zip(nearest, looked, strict=True))
        return _fronts(hits)


def _if_near(of: Callable[[ChainDesign], Found], design: ChainDesign) -> Found:
    """A design as a machine, weighed if it keeps the wish: a task of its own."""
    made = of(design)
    return made if made.miss else with_prototype(made)


def _useful(weighed: dict[ChainDesign, Found]) -> list[ChainDesign]:
    return [design for design, each in weighed.items() if each.prototype.of_use]


def _worth(designs: Sequence[ChainDesign], useful: Sequence[ChainDesign]) -> Sequence[ChainDesign]:
    """Those that no design of use beats in both error and bars; with enough of these, nearer ones alone."""
    if len(useful) >= _ENOUGH:
        least = min(each.error for each in useful)
        return [each for each in designs if each.error < least]
    return [
        each
        for each in designs
        if not any(one.error <= each.error and one.bars <= each.bars for one in useful)
    ]


def _fronts(weighed: dict[ChainDesign, Found]) -> list[Found]:
    buildable = [design for design, each in weighed.items() if not each.prototype.obstacle]
    chosen = {
        *paths.front(weighed, _STEP),
        *paths.front(buildable, _STEP),
        *paths.front(_useful(weighed), _STEP),
    }
    return [each for design, each in weighed.items() if design in chosen]
