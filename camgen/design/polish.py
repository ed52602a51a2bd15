"""Designs of a chain made better until nothing more is won: damped Gauss-Newton steps, many designs at once.

    value = error / worst error + weight * bars / most bars      both shares of what a search asks for, `Goal`

The error is a mean of distances d, not of their squares: each distance counts with the weight 1/d of the step before
(iteratively reweighted least squares, Weiszfeld 1937), so that the step's gradient is the true one. A step is kept only
where the value falls. The design's place, turn and size do not count: a design is drawn with its crank along x, of mean
point distance 1.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from camgen.design.chains import Chain
from camgen.design.target import Flags, Near, Target
from camgen.numerics import Floats, Indices, Points

_STEPS = 128  # angles of a turn
_ROUNDS = 14
_SHARE = 1e-5  # of the drawing's size: step of a difference quotient
_SMALL = 1e-3  # of the chord: distances below it count by their squares
_THIN = 1e-3  # of the chord: bars below it


@dataclass(frozen=True)
class Goal:
    """What a search asks for; lengths in units of the target's points."""

    target: Target
    worst: float  # error beyond which a design is of no use
    most: float  # length of all bars, likewise
    shortest: float = 0.0  # bar that can be made
    sine: float = 1e-3  # least, of the angle between two bars of a pair

    def value(self, error: Floats, bars: Floats, weight: Floats | float) -> Floats:
        """Less is better; (designs,)."""
        return np.asarray(error / self.worst + weight * bars / self.most)

    def allows(self, lengths: Floats, least: Floats) -> Flags:
        """Which designs can be made, by the lengths of their bars (designs, bars) and their least sines (designs,)."""
        return np.asarray((least >= self.sine) & (np.min(lengths, axis=1) >= self.shortest))


def pack(points: Points) -> Floats:
    """A design's numbers, (designs, 2 points - 2): x and y of all points but O."""
    from_first = points[:, 1:] - points[:, :1]
    return np.concatenate([from_first.real, from_first.imag], axis=1)


def unpack(numbers: Floats) -> Points:
    """The drawing of a design's numbers, O at 0."""
    x, y = np.split(numbers, 2, axis=1)
    return np.concatenate([np.zeros((len(numbers), 1), complex), x + 1j * y], axis=1)


def normalise(numbers: Floats) -> Floats:
    """The same designs with the crank along x and the points at a mean distance of 1 from O."""
    points = unpack(numbers)
    size = np.mean(np.abs(points[:, 1:]), axis=1)[:, None]
    along = points[:, 1:2] / np.maximum(np.abs(points[:, 1:2]), 1e-300)
    return pack(points / (size * along))


@dataclass(frozen=True)
class _State:
    """Designs as they lie on the target: paths (steps, designs) and the points that count for it, (4, designs); lengths
    (designs, bars), what is near, and what it costs."""

    on_target: Points
    anchors: Indices
    lengths: Floats
    near: Near
    value: Floats

    def mixed(self, other: _State, take: Flags) -> _State:
        """The other's designs where they are taken."""
        lengths = np.where(take[:, None], other.lengths, self.lengths)
        pairs = (
            (self.on_target, other.on_target),
            (self.anchors, other.anchors),
            (self.value, other.value),
        )
        paths, anchors, value = (np.where(take, b, a) for a, b in pairs)
        return _State(paths, anchors, lengths, self.near.mixed(other.near, take), value)


def polish(
    chain: Chain, numbers: Floats, weight: Floats, goal: Goal
) -> tuple[Floats, Floats, Floats]:
    """Better designs from given ones, (designs, numbers), each by its own weight: numbers, error, length of all bars."""
    x = normalise(numbers)
    state = _state(chain, x, weight, goal)
    damping = np.full(len(x), 1e-2)
    unit = np.eye(x.shape[1])
    for _ in range(_ROUNDS):
        slope, bend = _expansion(chain, x, weight, goal, state)
        damped = (
            bend
            + 1e-6 * unit
            + damping[:, None, None] * unit * np.einsum("ndd->nd", bend)[:, None, :]
        )
        trial = x - np.linalg.solve(damped, slope[:, :, None])[:, :, 0]
        then = _state(chain, trial, weight, goal)
        better = then.value < state.value
        damping = np.where(better, np.maximum(damping / 4, 1e-5), damping * 5)
        x = np.where(better[:, None], trial, x)
        state = state.mixed(then, better)
    return x, state.near.error, np.sum(state.lengths, axis=1)


def _state(chain: Chain, numbers: Floats, weight: Floats, goal: Goal) -> _State:
    points = unpack(numbers)
    paths, least = chain.trace(points, _STEPS)
    placed, factor, anchors = goal.target.on_target(paths)
    lengths = chain.lengths(points) * np.abs(factor)[:, None]
    near = goal.target.near(placed)
    near = replace(near, error=np.where(goal.allows(lengths, least), near.error, np.inf))
    return _State(
        placed, anchors, lengths, near, goal.value(near.error, np.sum(lengths, axis=1), weight)
    )


def _expansion(
    chain: Chain, numbers: Floats, weight: Floats, goal: Goal, state: _State
) -> tuple[Floats, Floats]:
    """Slope (designs, numbers) and approximate second derivative of the value."""
    designs, count = numbers.shape
    variants = np.repeat(numbers[:, None], count, axis=1)
    variants[:, np.arange(count), np.arange(count)] += _SHARE
    points = unpack(variants.reshape(-1, count))
    placed, factor = goal.target.by_anchors(
        chain.trace(points, _STEPS)[0], np.repeat(state.anchors, count, axis=1)
    )
    shift = (
        (placed.reshape(_STEPS, designs, count) - state.on_target[:, :, None]) / _SHARE
    ).transpose(1, 0, 2)
    lengths = (chain.lengths(points) * np.abs(factor)[:, None]).reshape(designs, count, -1)
    longer = (lengths - state.lengths[:, None]) / _SHARE

    small = _SMALL * goal.target.chord
    paths = state.on_target.T
    near = state.near
    slope = np.einsum("ndb->nd", longer) * (weight / goal.most)[:, None]
    # a length as the square of its root: the step's second derivative stays positive
    pull = (
        (weight / goal.most)[:, None] * 0.5 / np.maximum(state.lengths, _THIN * goal.target.chord)
    )
    bend = np.einsum("ndb,nb,neb->nde", longer, pull, longer)
    back = np.take_along_axis(paths, near.nearest, axis=1)
    moves = np.take_along_axis(shift, near.nearest[:, :, None], axis=1)
    for gap, move in ((paths - near.goal, shift), (back - near.wanted, moves)):
        distance = np.maximum(np.abs(gap), 1e-12)
        slopes = (np.conj(gap / distance)[:, :, None] * move).real  # slope of each distance
        share = 1 / (goal.worst * gap.shape[1])
        heavy = (slopes * (share / np.maximum(distance, small))[:, :, None]).transpose(0, 2, 1)
        slope += (heavy @ distance[:, :, None])[:, :, 0]
        bend += heavy @ slopes
    return slope, bend
