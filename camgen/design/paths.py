"""Linkages that trace a wanted path: random drawings of every chain, evolved, polished, and the best shaken and polished on.

    sow       random drawings of a chain, the best of them a population
    evolve    differential evolution with its own factors learnt (JADE, Zhang and Sanderson 2009)
    polish    Gauss-Newton on the exact distances (`polish.py`), each design with a weight of its bars for its place on the front
    shake     designs on the front or near it, moved a little by chance, are polished again (basin hopping, Wales and Doye 1997)
    front     the designs that no other one beats in both error and length of bars

A task is one chain with one seed and draws on nothing else, so the front is the same for any number of cores.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np

from camgen.design.chains import Chain, chains
from camgen.design.polish import Goal, normalise, pack, polish, unpack
from camgen.numerics import Floats, Indices, Points

# drawings of a chain
_SOWN = 3000
_POPULATION = 48
_GENERATIONS = 40
_GLANCED = 64  # angles of a turn while evolving
_BEST = 0.1  # share of the population that the others are drawn towards
_POLISHED = 12  # evolved designs of a chain, each by so many weights:
_COPIES = 3
_WEIGHTS = (0.1, 10.0)  # least and greatest, of the bars' share in the value against the error's
_SHAKEN = 10  # copies of a design
_SHARES = (0.003, 0.1)  # of the drawing's size: least and greatest that points are moved by
# few chains are sown so often that there are so many tasks, each so often at most
_TASKS = 60
_TIMES = 6
_ROUNDS = 6  # of shaking in a unit of effort
_NEAR = (
    0.98  # a design is shaken too that would be on the front with such shares of its error and bars
)
_APART = 0.01  # least difference of the bars of designs that are shaken, as a share
_ELSEWHERE = (
    0.04  # of the drawing's size: how far a point of two designs lies apart that are not the same
)
_MEASURED = 2000  # angles of a turn at the end


@dataclass(frozen=True)
class ChainDesign:
    """A design: its chain, its drawing in the place of the wanted path, error and length of all bars in the path's unit."""

    chain: Chain
    points: tuple[complex, ...]
    error: float
    bars: float


@dataclass(frozen=True)
class Task:
    """One chain from one seed, and the designs that are to be shaken; none: it is sown."""

    chain: Chain
    seed: tuple[int, ...]
    known: tuple[ChainDesign, ...] = ()


Say = Callable[[str], None]
Runner = Callable[
    [Callable[[Task], "list[ChainDesign]"], Sequence[Task]], Iterable["list[ChainDesign]"]
]


def kinds(most_pairs: int, grounds: int) -> list[Chain]:
    """Chains of two pairs and more: four-bars first."""
    return [chain for pairs in range(2, most_pairs + 1) for chain in chains(pairs, grounds)]


def search(
    goal: Goal,
    kinds: Sequence[Chain],
    effort: int = 1,
    seed: int = 0,
    run: Runner = map,
    say: Say = lambda text: None,
) -> list[ChainDesign]:
    """Designs for a path, those on the front from the least error to the least length of bars and others; run: `map`, or that
    of several cores.

    effort: how long the designs near the front are shaken. The same call gives the same designs.
    """
    solve = partial(solve_task, goal)
    by_chain: dict[Chain, list[ChainDesign]] = {chain: [] for chain in kinds}

    def take(tasks: Sequence[Task]) -> None:
        for task, designs in zip(tasks, run(solve, tasks), strict=True):
            by_chain[task.chain] += designs

    def found() -> list[ChainDesign]:
        return [each for designs in by_chain.values() for each in designs]

    times = min(_TIMES, -(-_TASKS // len(kinds)))
    take([Task(chain, (seed, k, time)) for time in range(times) for k, chain in enumerate(kinds)])
    for again in range(effort * _ROUNDS):
        best = front(found())
        say(f"{len(best)} designs on the front; round {again + 1} of {effort * _ROUNDS} about them")
        close = [tuple(near(front(by_chain[chain], _APART), best, _NEAR)) for chain in kinds]
        take(
            [
                Task(chain, (seed, k, times + again), close[k])
                for k, chain in enumerate(kinds)
                if close[k]
            ]
        )
    return found()


def near(
    designs: Iterable[ChainDesign], best: Sequence[ChainDesign], share: float
) -> Iterable[ChainDesign]:
    """Those that no design of a front beats in both error and bars by more than to such a share of them."""
    return (
        each
        for each in designs
        if not any(one.error < share * each.error and one.bars < share * each.bars for one in best)
    )


def apart(designs: Iterable[ChainDesign]) -> list[ChainDesign]:
    """Those whose points lie elsewhere than those of all nearer ones, by rising error."""
    distinct: list[ChainDesign] = []
    points: list[Points] = []
    for each in sorted(designs, key=lambda each: (each.error, each.bars)):
        z = np.array(each.points)
        size = _ELSEWHERE * (np.ptp(z.real) + np.ptp(z.imag))
        if not any(
            one.chain == each.chain and np.abs(other - z).max() < size
            for one, other in zip(distinct, points, strict=True)
        ):
            distinct.append(each)
            points.append(z)
    return distinct


def front(designs: Iterable[ChainDesign], step: float = 0.0) -> list[ChainDesign]:
    """Those that no other one beats in both error and bars, by rising error; each with less bars by a share of them."""
    best: list[ChainDesign] = []
    for design in sorted(designs, key=lambda each: (each.error, each.bars)):
        if not best or design.bars < (1 - step) * best[-1].bars:
            best.append(design)
    return best


def solve_task(goal: Goal, task: Task) -> list[ChainDesign]:
    """The front of one task."""
    rng = np.random.default_rng(task.seed)
    chain = task.chain
    if task.known:
        numbers = np.tile(
            normalise(pack(np.array([each.points for each in task.known]))), (_SHAKEN, 1)
        )
        error, bars = np.tile([[each.error, each.bars] for each in task.known], (_SHAKEN, 1)).T
        numbers += _chance(rng, _SHARES, len(numbers))[:, None] * rng.normal(size=numbers.shape)
    else:
        numbers, error, bars = _evolve(goal, chain, rng)
        best = _best(error, bars)
        best = np.tile(
            best[np.unique(np.linspace(0, len(best) - 1, min(len(best), _POLISHED)).astype(int))],
            _COPIES,
        )
        numbers = numbers[best]
        error = error[best]
        bars = bars[best]
    if not numbers.size:
        return []
    weight = _chance(rng, _WEIGHTS, len(numbers)) * (error / goal.worst) / (bars / goal.most)
    better, error, bars = polish(chain, numbers, weight, goal)
    points = unpack(better)
    return front(each for k in _best(error, bars) if (each := _measured(goal, chain, points[k])))


def _chance(rng: np.random.Generator, ends: tuple[float, float], count: int) -> Floats:
    """Numbers between two, each size as likely as another, (count,)."""
    return np.exp(rng.uniform(math.log(ends[0]), math.log(ends[1]), count))


def _measured(goal: Goal, chain: Chain, points: Points) -> ChainDesign | None:
    """A design at full resolution, laid on the target; None where it opens between the angles of the search, or is too thin."""
    path, least = chain.trace(points[None], _MEASURED)
    error, factor, shift = goal.target.measured(path[:, 0])
    lengths = chain.lengths(points[None]) * abs(factor)
    if not goal.allows(lengths, least)[0]:
        return None
    return ChainDesign(
        chain, tuple((points * factor + shift).tolist()), error, float(np.sum(lengths))
    )


def _best(error: Floats, bars: Floats) -> Indices:
    """Numbers of the designs on the front, by rising error."""
    order = np.lexsort((bars, error))
    order = order[np.isfinite(error[order])]
    return np.asarray(
        order[bars[order] < np.concatenate([[np.inf], np.minimum.accumulate(bars[order])[:-1]])]
    )


def _glance(goal: Goal, chain: Chain, numbers: Floats) -> tuple[Floats, Floats, Floats]:
    """Value, error and bars of designs by a fast look; one that cannot be made costs more the more it opens."""
    points = unpack(numbers)
    paths, least = chain.trace(points, _GLANCED)
    error = np.full(len(points), np.inf)
    bars = np.full(len(points), np.inf)
    sound = np.flatnonzero(least >= goal.sine)
    if sound.size:
        placed, factor, _ = goal.target.on_target(paths[:, sound])
        lengths = chain.lengths(points[sound]) * np.abs(factor)[:, None]
        bars[sound] = np.sum(lengths, axis=1)
        use = goal.allows(lengths, least[sound]) & (bars[sound] < goal.most)
        error[sound[use]] = goal.target.glance(placed[:, use])
    value = goal.value(error, bars, 1.0)
    return np.where(np.isfinite(value), value, 50.0 - np.clip(least, -40.0, 1.0)), error, bars


def _evolve(goal: Goal, chain: Chain, rng: np.random.Generator) -> tuple[Floats, Floats, Floats]:
    """Designs met on the way that were better than what they replaced, and the last population: numbers, error, bars."""
    size = _POPULATION
    sown = rng.normal(size=(_SOWN, chain.size)) + 1j * rng.normal(size=(_SOWN, chain.size))
    x = normalise(pack(sown))
    value, error, bars = _glance(goal, chain, x)
    best = np.argsort(value, kind="stable")[:size]
    x = x[best]
    value = value[best]
    better_ones = [(x, error[best], bars[best])]
    archive = x[:0]
    factor = 0.5
    crossing = 0.5
    numbers = np.arange(size)
    for _ in range(_GENERATIONS):
        rates = np.clip(rng.normal(crossing, 0.1, size), 0.0, 1.0)
        factors = np.clip(factor + 0.1 * rng.standard_cauchy(size), 0.05, 1.0)
        leaders = np.argsort(value, kind="stable")[: math.ceil(_BEST * size)]
        pool = np.concatenate([x, archive])
        leader = x[rng.choice(leaders, size)]
        one = x[rng.integers(size, size=size)]
        other = pool[rng.integers(len(pool), size=size)]
        inherits = rng.random(x.shape) < rates[:, None]
        inherits[numbers, rng.integers(x.shape[1], size=size)] = True
        trial = np.where(inherits, x + factors[:, None] * (leader - x + one - other), x)
        then, error, bars = _glance(goal, chain, trial)
        better = then < value
        if better.any():
            archive = np.concatenate([archive, x[better]])[-size:]
            better_ones.append((trial[better], error[better], bars[better]))
            x = normalise(np.where(better[:, None], trial, x))
            value = np.where(better, then, value)
            factor = 0.9 * factor + 0.1 * float(
                np.sum(factors[better] ** 2) / np.sum(factors[better])
            )
            crossing = 0.9 * crossing + 0.1 * float(np.mean(rates[better]))
    numbers_, error, bars = (np.concatenate(parts) for parts in zip(*better_ones, strict=True))
    return numbers_, error, bars
