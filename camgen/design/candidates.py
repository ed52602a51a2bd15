"""Which of the designs for a path are weighed as machines: front after front, those that keep the wish first.

hit    a design whose path is as near to the wanted one as is borne: its parts are made
miss   any other one: its parts are made only where no hit can be built, to say which one could
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import Protocol

from camgen.design import paths
from camgen.design.front import with_prototype
from camgen.design.linkages import Candidate
from camgen.design.paths import ChainDesign

_STEP = 0.02  # least difference of bars of two designs of a front, as a share
_BEHIND = 0.8  # of the error and bars of a design that could be built: the front reaches to those at most so much worse
_LOOKED_AT = 60  # designs at most, and the rest of a front
_ENOUGH = 8  # designs of use: beyond them only nearer ones are weighed
_MISSES = 12  # that are weighed where no hit can be built


class Runner(Protocol):
    """`map`, or that of several cores."""

    def __call__(
        self, task: Callable[[Candidate], Candidate], each: Sequence[Candidate], /
    ) -> Iterable[Candidate]:
        """What the task makes of each, in their order."""


@dataclass(frozen=True)
class Candidates:
    """How designs become candidates, and how these are weighed."""

    of: Callable[[ChainDesign], Candidate]
    run: Runner
    say: Callable[[str], None]

    def front(self, designs: Sequence[ChainDesign]) -> list[Candidate]:
        """The front of all that are weighed, that of those that can be made and that of those that are of use."""
        remaining = paths.apart(paths.near(designs, paths.front(designs), _BEHIND))
        weighed: list[Candidate] = []
        misses: list[Candidate] = []
        while len(weighed) + len(misses) < _LOOKED_AT:
            layer = paths.front(_worth(remaining, _useful(weighed)), _STEP)
            if not layer:
                break
            looked = list(self.run(_weighed_if_near, [self.of(each) for each in layer]))
            weighed += [each for each in looked if not each.miss]
            misses += [each for each in looked if each.miss]
            self.say(
                f"{len(weighed) + len(misses)} designs judged, {len(_useful(weighed))} of them can be built and keep the limits"
            )
            seen = set(layer)
            remaining = [each for each in remaining if each not in seen]
        if not _useful(weighed):
            nearest = sorted(misses, key=lambda each: each.worst)[:_MISSES]
            weighed += self.run(with_prototype, nearest)
        return _fronts(weighed)


def _weighed_if_near(candidate: Candidate) -> Candidate:
    """The same, weighed as a machine if it keeps the wish: a task of its own."""
    return candidate if candidate.miss else with_prototype(candidate)


def _useful(weighed: Sequence[Candidate]) -> list[ChainDesign]:
    return [each.design for each in weighed if each.prototype.of_use]


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


def _fronts(weighed: Sequence[Candidate]) -> list[Candidate]:
    every = [each.design for each in weighed]
    buildable = [each.design for each in weighed if not each.prototype.obstacle]
    chosen = {
        *paths.front(every, _STEP),
        *paths.front(buildable, _STEP),
        *paths.front(_useful(weighed), _STEP),
    }
    return [each for each in weighed if each.design in chosen]
