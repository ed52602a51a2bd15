"""Chains for a search: a crank, and points that each hang on two earlier ones by two bars; many designs of one chain at once.

    point 0      O, where the crank turns, at rest        point 1    A, the end of the crank
    point 2...   further points at rest                    then       one point for each pair: two bars hold it

The last point traces the path. A design is the chain drawn in one position, complex numbers in any unit, one a point;
the drawing says on which side of its two points a point lies (the branch), and it stays there.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from camgen.numerics import Floats, Points


@dataclass(frozen=True)
class Chain:
    """How bars join points."""

    grounds: int  # points at rest besides O
    pairs: tuple[
        tuple[int, int], ...
    ]  # of each further point, the two earlier ones that bars join it to

    @property
    def base(self) -> int:
        """Points that are no pair's: O, A and those at rest."""
        return 2 + self.grounds

    @property
    def size(self) -> int:
        """Points of a design."""
        return self.base + len(self.pairs)

    @cached_property
    def bodies(self) -> tuple[frozenset[int], ...]:
        """Rigid links by their points: ground, crank, then the others; a point held by two of one link is part of it."""
        bodies = [{0, *range(2, self.base)}, {0, 1}]
        for point, pair in enumerate(self.pairs, self.base):
            holder = next((body for body in bodies if set(pair) <= body), None)
            if holder is None:
                bodies += [{each, point} for each in pair]
            else:
                holder.add(point)
        return tuple(map(frozenset, bodies))

    def lengths(self, points: Points) -> Floats:
        """Lengths of the bars of each design, (designs, bars): the crank, then two for each pair."""
        ends = [
            (0, 1),
            *((each, point) for point, pair in enumerate(self.pairs, self.base) for each in pair),
        ]
        return np.stack([np.abs(points[:, b] - points[:, a]) for a, b in ends], axis=1)

    def trace(self, points: Points, steps: int) -> tuple[Points, Floats]:
        """Paths of the last point over a turn, (steps, designs), and the least sine of an angle between two bars, (designs,).

        The sine is below 0 where the chain opens; the path is then worth nothing. Where a pair is rigid, as in a
        triangle of one link, its angle does not count.
        """
        turn = np.exp(2j * math.pi * np.arange(steps) / steps)[:, None]
        places = [points[None, :, k] for k in range(self.base)]
        places[1] = places[0] + turn * (places[1] - places[0])
        least = np.full(len(points), np.inf)
        for point, (i, j) in enumerate(self.pairs, self.base):
            first, second = (np.abs(points[:, point] - points[:, k]) for k in (i, j))
            way = points[:, j] - points[:, i]
            side = np.sign((np.conj(way) * (points[:, point] - points[:, i])).imag)
            way = places[j] - places[i]
            span = way.real**2 + way.imag**2
            square = ((first + second) ** 2 - span) * (
                span - (first - second) ** 2
            )  # (2 first second sine)^2, by Heron
            if not any({i, j} <= body for body in self.bodies):
                lowest = np.min(square, axis=0)
                least = np.minimum(
                    least, np.sign(lowest) * np.sqrt(np.abs(lowest)) / (2 * first * second + 1e-300)
                )
            half = 0.5 / np.maximum(span, 1e-300)
            unit = np.empty(way.shape, complex)
            unit.real = 0.5 + half * (first**2 - second**2)
            unit.imag = half * side * np.sqrt(np.maximum(square, 0.0))
            places.append(places[i] + unit * way)
        return places[-1], least


def chains(pairs: int, grounds: int) -> list[Chain]:
    """All chains of so many pairs, of at most so many points at rest besides O, whose last point may trace more than an arc."""
    by_shape: dict[object, Chain] = {}
    for count in range(1, grounds + 1):
        for chain in _extensions(count, pairs):
            by_shape.setdefault(_shape(chain), chain)
    return list(by_shape.values())


def _extensions(grounds: int, pairs: int) -> Iterator[Chain]:
    base = 2 + grounds
    rest = {0, *range(2, base)}
    choices = (
        [pair for pair in itertools.combinations(range(base + k), 2) if not set(pair) <= rest]
        for k in range(pairs)
    )
    for choice in itertools.product(*choices):
        points = [point for pair in choice for point in pair]
        order = list(dict.fromkeys(point for point in points if 2 <= point < base))
        necessary = {*range(2, base + pairs - 1)}
        if necessary <= set(points) and order == sorted(order) and not rest & set(choice[-1]):
            yield Chain(grounds, choice)


def _shape(chain: Chain) -> object:
    """The same for chains that differ by the order of their pairs alone."""

    def word(point: int) -> str:
        if point < chain.base:
            return "OA"[point] if point < 2 else "G"
        return "(" + "".join(sorted(map(word, chain.pairs[point - chain.base]))) + ")"

    points = range(chain.base, chain.size)
    dyads = (
        tuple(sorted(word(p) for p in points if at in chain.pairs[p - chain.base]))
        for at in range(2, chain.base)
    )
    return (
        chain.grounds,
        word(chain.size - 1),
        tuple(sorted(map(word, points))),
        tuple(sorted(dyads)),
    )
