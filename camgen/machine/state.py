"""All unknowns of a machine at some angles, made step by step, and what follows from them: places, angles, outputs.

    step      one block solved: a relation of one unknown, a dyad, or a larger block by Newton

Unknown angles are kept as spins; the angle itself, continuous from the drawn position, is made where it is asked for. Where
a step does not close it is nan, and so is all that hangs on it.
"""

from __future__ import annotations

import cmath
import math
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Protocol

import numpy as np

from camgen.machine import dyads
from camgen.machine.jets import (
    Jet,
    Spin,
    combined,
    fill,
    product,
    through,
    times,
    turned,
    unit_turn,
)
from camgen.machine.model import GROUND, Along, Angle, Output, Path, Place, Turning
from camgen.machine.newton import Block, BlockInputs, Trace, Vectors
from camgen.machine.order import Groups, Key, Relation
from camgen.numerics import Floats, Points

# Angles a turn at which an angle is followed, so that it is continuous at any others.
FOLLOWED = 720


@dataclass(frozen=True)
class Direct:
    """A relation that gives one unknown."""

    unknown: Key
    relation: Relation


@dataclass(frozen=True)
class Dyad:
    """A block of one loop and two unknowns in closed form."""

    kind: str  # "angles", "slider", "inverted", "lengths"
    block: Block
    branch: int  # the sign at the start
    sine: float = 0.0  # of its transmission angle as drawn, without a sign


Step = Direct | Dyad | Block


class ChainData(Protocol):
    """What a state asks of its chain: who turns with whom, the ways to all bodies, a lever of each group, the driven, and what
    was followed from the drawn position."""

    groups: Groups
    route: dict[str, Vectors]
    levers: dict[str, float]
    driven: set[str]

    def course(self, group: str, low: float, high: float) -> tuple[Floats, Floats]:
        """A group's angle at angles theta over the range."""

    def trace(self, block: Block, low: float, high: float) -> Trace:
        """Of a larger block over the range."""


class State:
    """All unknowns at theta, (n,) rad, with derivatives up to the order.

    Made with numpy's warnings off, as all that is asked of it later is to be.
    """

    def __init__(self, chain: ChainData, theta: Floats, order: int) -> None:
        self.chain = chain
        self.theta = theta
        self.order = order
        self.spins: dict[str, Spin] = {GROUND: [1.0, 0, 0][: order + 1]}
        self.levers: dict[
            str, complex
        ] = {}  # the vector of each spin, in the axes that turn with it
        self.lengths: dict[str, Jet] = {}
        self._angle: dict[str, Any] = {GROUND: 0.0}
        self._arms: dict[tuple[str, complex], Jet] = {}
        self._origins: dict[str, Jet] = {}
        self._near: dict[
            tuple[float, int], Any
        ] = {}  # by where an angle was followed, the nearest place of each theta

    # ---- what is known ----

    def hold(
        self, group: str, spin: Spin, lever: complex = 1 + 0j, angle: Floats | None = None
    ) -> None:
        """Keep the spin of a lever of the group; its angle, where it is known before."""
        self.spins[group] = spin
        self.levers[group] = lever
        if angle is not None:
            self._angle[group] = angle

    def direction(self, group: str) -> Floats:
        """A group's angle but for whole turns."""
        z = self.spins[group][0]
        angle = np.arctan2(z.imag.copy(), z.real.copy())  # its loop is slow on a view
        phase = cmath.phase(self.levers[group])
        if phase:
            angle -= phase
        return np.asarray(angle)

    def angle(self, group: str) -> Jet:
        """A group's angle with derivatives, continuous from the drawn position."""
        if group not in self._angle:
            angle = self.direction(group)
            turns = self._nearest(*self.chain.course(group, *self._range))
            turns -= angle
            turns *= 1 / math.tau
            np.rint(turns, out=turns)
            turns *= math.tau
            turns += angle
            self._angle[group] = turns
        return [self._angle[group], *self.spins[group][1:]]

    @cached_property
    def _range(self) -> tuple[float, float]:
        """The least and the greatest theta."""
        return (float(self.theta.min()), float(self.theta.max())) if self.theta.size else (0.0, 0.0)

    def _nearest(self, theta: Floats, values: Floats) -> Floats:
        """The angle where it was followed nearest to each of our theta, (n,) rad: off by less than half a turn."""
        if theta.size < 2:
            return np.full(self.theta.shape, values[0] if values.size else 0.0)
        span = theta[-1] - theta[0]
        if span > (theta.size - 0.5) * (math.tau / FOLLOWED):  # some in between did not close
            return np.asarray(np.interp(self.theta, theta, values))
        key = (float(theta[0]), theta.size)
        if key not in self._near:
            near = np.rint((self.theta - theta[0]) * (FOLLOWED / math.tau)).astype(np.intp)
            self._near[key] = np.clip(near, 0, theta.size - 1)
        return np.asarray(values.take(self._near[key]))

    def arm(self, group: str, lever: complex) -> tuple[complex, Jet]:
        """A lever that turns with a group: a jet and its factor, most often 1 or -1."""
        if group == GROUND:
            return 1, [lever, 0, 0][: self.order + 1]
        for sign in (1, -1):
            if (group, sign * lever) in self._arms:
                return sign, self._arms[group, sign * lever]
        spin_lever = self.levers[group]
        if (group, spin_lever) not in self._arms:
            z, w, a = [*self.spins[group], 0, 0][:3]
            self._arms[group, spin_lever] = turned(z, w, a, self.order)
            return self.arm(group, lever)
        self._arms[group, lever] = [
            times(lever / spin_lever, row) for row in self._arms[group, spin_lever]
        ]
        return 1, self._arms[group, lever]

    def origin(self, body: str) -> Jet:
        """A body's origin on the ground, complex mm, with derivatives."""
        if body not in self._origins:
            route = self.chain.route[body]
            self._origins[body] = combined(self._terms(route), self.order, route.still)
        return self._origins[body]

    def point(self, place: Place, into: Points | None = None) -> Jet:
        """A place on the ground, complex mm, with derivatives; put into an array, (order + 1, n), where that is given."""
        groups = self.chain.groups
        terms: list[tuple[complex, Jet]] = [(1, self.origin(place.body))]
        if place.at:
            terms.append(self.arm(groups.of[place.body], groups.turned(place)))
        return combined(terms, self.order, 0, into)

    def _terms(
        self, vectors: Vectors, angles: tuple[str, ...] = (), lengths: tuple[str, ...] = ()
    ) -> list[tuple[Any, Jet]]:
        """What moves and is known of a sum of vectors; angles and lengths are the unknown ones."""
        terms: list[tuple[Any, Jet]] = [(sign, self.origin(body)) for sign, body in vectors.roots]
        terms += [
            self.arm(group, lever) for group, lever in vectors.levers.items() if group not in angles
        ]
        for slide, group, along in vectors.ways:
            if group not in angles and slide not in lengths:
                factor, way = self.arm(group, along)
                terms.append((factor, product(self.lengths[slide], way)))
        return terms

    def sum(
        self, loop: Vectors, angles: tuple[str, ...], lengths: tuple[str, ...]
    ) -> tuple[Jet, list[tuple[int, Jet]]]:
        """What is known of a loop, and the known ways of its unknown lengths; angles and lengths are the unknown ones."""
        ways = []
        for slide, group, along in loop.ways:
            if group not in angles and slide in lengths:
                factor, way = self.arm(group, along)
                ways.append((lengths.index(slide), [times(factor, row) for row in way]))
        return combined(self._terms(loop, angles, lengths), self.order, loop.still), ways

    def value(self, key: Key) -> Jet:
        """An angle or length that is known, with derivatives."""
        return self.angle(key[1]) if key[0] == "angle" else self.lengths[key[1]]

    def relation(self, relation: Relation, unknown: tuple[Key, ...], scale: float = 1.0) -> Jet:
        """What is known of a relation, with derivatives, scaled."""
        terms = [
            (scale * share, self.value(key))
            for key, share in relation.shares.items()
            if key not in unknown
        ]
        constant = relation.constant
        law = relation.law
        if law is not None and relation.argument not in unknown:
            argument: Jet = [np.zeros(self.theta.shape), 0, 0]
            if relation.argument is not None:
                argument = self.value(relation.argument)
            elif relation.name in self.chain.driven:
                argument = [self.theta, 1.0, 0]
            if isinstance(law, Turning):
                constant -= law.start + law.rate * relation.shift
                terms.append((-scale * law.rate, argument))
            else:
                terms.append((-scale, through(law, argument, relation.shift, self.order)))
        return combined(terms, self.order, scale * constant)

    def known(self, block: Block) -> BlockInputs:
        """What a larger block needs."""
        sums = [self.sum(loop, block.angles, block.lengths) for loop in block.loops]
        ways = tuple(
            (c, len(block.angles) + j, jet) for c, (_, along) in enumerate(sums) for j, jet in along
        )
        unknown = tuple(block.column)
        turning = {
            slide for loop in block.loops for slide, group, _ in loop.ways if group in block.angles
        }
        lengths = {slide: self.lengths[slide] for slide in turning if slide in self.lengths}
        about = tuple(self.relation(relation, unknown) for relation in block.relations)
        return BlockInputs(tuple(total for total, _ in sums), ways, lengths, about)

    # ---- steps ----

    def take(self, step: Direct) -> None:
        """The unknown of a relation."""
        kind, name = step.unknown
        rows = self.relation(
            step.relation, (step.unknown,), -1 / step.relation.shares[step.unknown]
        )
        if kind == "length":
            self.lengths[name] = rows
            return
        angle = (
            rows[0]
            if isinstance(rows[0], np.ndarray)
            else np.full(self.theta.shape, float(rows[0]))
        )
        lever = self.chain.levers.get(name, 1.0)
        self.hold(name, [unit_turn(angle, lever), *rows[1:]], lever, angle)

    def close(self, step: Dyad) -> None:
        """A dyad."""
        block = step.block
        (loop,) = block.loops
        total, ways = self.sum(loop, block.angles, block.lengths)
        if not isinstance(total[0], np.ndarray):
            total[0] = np.full(self.theta.shape, complex(total[0]))
        if step.kind == "angles":
            a, b = block.angles
            near = loop.levers[a]
            far = -loop.levers[b]
            first, second = dyads.two_angles(total, abs(near), abs(far), step.branch)
            self.hold(a, first, near)
            self.hold(b, second, far)
        elif step.kind == "lengths":
            along = dict(ways)
            a, b = block.lengths
            self.lengths[a], self.lengths[b] = dyads.two_lengths(total, along[0], along[1])
        else:
            (a,) = block.angles
            (b,) = block.lengths
            lever = loop.levers.get(a, 0j)
            if step.kind == "slider":
                spin, self.lengths[b] = dyads.slider(total, lever, ways[0][1], step.branch)
                self.hold(a, spin, lever)
            else:
                (along_b,) = (way for slide, _, way in loop.ways if slide == b)
                spin, self.lengths[b] = dyads.inverted(total, lever, along_b, step.branch)
                self.hold(a, spin)

    def converge(self, block: Block) -> None:
        """A larger block."""
        if not self.theta.size:
            rows = [np.zeros((block.size, 0))] * (self.order + 1)
        else:
            trace = self.chain.trace(block, *self._range)
            block.trace = trace
            rows = block.solve(self.theta, self.known(block), self.order)
        for name in block.angles:
            k = block.column["angle", name]
            self.hold(
                name, [unit_turn(rows[0][k]), *(row[k] for row in rows[1:])], angle=rows[0][k]
            )
        for name in block.lengths:
            self.lengths[name] = [row[block.column["length", name]] for row in rows]

    # ---- for those outside ----

    def output(self, output: Output, into: Any) -> None:
        """Put an output with derivatives to theta into an array, (order + 1, n): rad, mm or complex mm."""
        of = output.of
        groups = self.chain.groups
        if isinstance(of, Path):
            self.point(of.of, into)
        elif isinstance(of, Angle):
            terms = [(1, self.angle(groups.of[of.body])), (-1, self.angle(groups.of[of.on]))]
            combined(terms, self.order, groups.excess[of.body] - groups.excess[of.on], into)
        elif isinstance(of, Along):
            fill(into, self.lengths[of.slide])
        else:
            places = np.empty((len(of.of), *into.shape), complex)
            for place, row in zip(of.of, places, strict=True):
                self.point(place, row)
            into[...] = of.value(*places)
