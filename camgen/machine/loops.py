"""The maker's route: a machine's positions and derivatives by vector loops, block by block, dyads in closed form.

    route     how a body's origin is reached from one placed earlier: the vectors that lead there
    step      one block solved: a relation of one unknown, a dyad, or a larger block by Newton
    chain     a machine parted into steps, once; it keeps what was followed from the drawn position
    state     all unknowns at some angles, made step by step

Unknown angles are kept as unit vectors with rates; the angle itself, continuous from the drawn position, is made where it
is asked for. Where a step does not close it is nan, and so is all that hangs on it.
"""

from __future__ import annotations

import math
import weakref
from typing import Any

import numpy as np

from camgen.errors import DesignError
from camgen.machine import dyads, newton
from camgen.machine.jets import Jet, Spin, minus, plus, product, stacked, times, turned, unit_turn
from camgen.machine.model import GROUND, Along, Angle, Clutch, Machine, Output, Path, Pin, Place, Turning
from camgen.machine.newton import Block, Known, Vectors, relation_jet
from camgen.machine.order import NO_LEVER, Groups, Key, Relation, components, group_bodies, places, relations
from camgen.numerics import Floats, Points
from camgen.records import dataclass

# Angles a turn at which an angle is followed, so that it is continuous at any others.
FOLLOWED = 720


@dataclass(frozen=True)
class Direct:
    """A relation that gives one unknown."""

    unknown: Key
    relation: Relation


@dataclass(frozen=True)
class Dyad:
    """A block of one loop and two unknowns in closed form; branch: the sign at the start."""

    kind: str  # "angles", "slider", "inverted", "lengths"
    block: Block
    branch: int


Step = Direct | Dyad | Block


class Chain:
    """A machine parted into steps. Raises DesignError where equations and unknowns do not match."""

    def __init__(self, machine: Machine) -> None:
        self.driven = {drive.name for drive in machine.drives}  # whose laws are of theta
        self.driven |= {joint.name for joint in machine.joints if isinstance(joint, Clutch)}
        self.groups: Groups = group_bodies(machine)
        self.route: dict[str, Vectors] = {GROUND: _from(GROUND)}
        self.steps: list[Step] = []
        self.maker: dict[Key, int] = {}  # the step that gives an unknown
        self._followed: dict[str, tuple[Floats, Floats]] = {}
        self._place_blocks(machine)

    # ---- parting into steps, once ----

    def _place_blocks(self, machine: Machine) -> None:
        ordered = components(machine, self.groups)
        if ordered.loose or ordered.over:
            names = list(ordered.over) or list(dict.fromkeys(name for _, name in ordered.loose))
            short = "is held by more conditions than it needs" if ordered.over else "is held by nothing"
            raise DesignError(
                "conditions less unknowns", len(ordered.over) - len(ordered.loose), 0, "", ", ".join(names), short
            )
        by_name = {relation.name: relation for relation in relations(machine, self.groups)}
        for part in ordered.components:
            names = [name for axis, name in part.equations if axis == "x"]
            within = [by_name[name] for axis, name in part.equations if axis == "s"]
            loops = self._loops(machine, names, [name for axis, name in part.unknowns if axis == "x"])
            unknowns = [key for key in part.unknowns if key[0] in ("angle", "length")]
            if 2 * len(loops) + len(within) != len(unknowns):
                raise DesignError("conditions less unknowns", 2 * len(loops) + len(within) - len(unknowns), 0, "",
                                  ", ".join(part.joints()), "give these joints places that do not coincide")  # fmt: skip
            if unknowns:
                for key in unknowns:
                    self.maker[key] = len(self.steps)
                self.steps.append(self._step(machine, unknowns, loops, within, part.joints()))

    def _loops(self, machine: Machine, names: list[str], bodies: list[str]) -> list[Vectors]:
        """Place the block's bodies along its joints; each joint that is left over closes a loop."""
        before, fresh = set(self.route), set(bodies) - set(self.route)
        left = [machine.joint(name) for name in names]
        moved = True
        while moved:
            moved = False
            for joint in list(left):
                both = places(joint)
                assert both is not None
                a, b = both
                here, there = (a, b) if a.body in self.route else (b, a)
                if here.body not in self.route or there.body in self.route or there.body not in fresh:
                    continue
                base = _from(here.body) if here.body in before else self.route[here.body]
                # origin of there = place on here - place on there, and the length between them
                levers = dict(base.levers)
                _add(levers, self.groups.of[here.body], self.groups.turned(here))
                _add(levers, self.groups.of[there.body], -self.groups.turned(there))
                ways = base.ways
                if not isinstance(joint, Pin):
                    group, way = self._along(machine, joint.name)
                    ways = (*ways, (joint.name, group, way if here is a else -way))
                self.route[there.body] = Vectors(base.roots, levers, ways)
                left.remove(joint)
                moved = True
        loops = []
        for joint in left:
            both = places(joint)
            assert both is not None
            if any(place.body not in self.route for place in both):
                if bodies:
                    raise DesignError("bodies without a place", len(bodies), 0, "", ", ".join(bodies), "join them to the ground")
                continue
            roots: list[tuple[int, str]] = []
            levers, along = dict[str, complex](), list[tuple[str, str, complex]]()
            for sign, place in zip((-1, 1) if not isinstance(joint, Pin) else (1, -1), both, strict=True):
                base = _from(place.body) if place.body in before else self.route[place.body]
                roots.append((sign, base.roots[0][1]))
                for group, lever in base.levers.items():
                    _add(levers, group, sign * lever)
                _add(levers, self.groups.of[place.body], sign * self.groups.turned(place))
                along += [(slide, group, sign * way) for slide, group, way in base.ways]
            if not isinstance(joint, Pin):
                group, way = self._along(machine, joint.name)
                along.append((joint.name, group, -way))
            if roots[0][1] == roots[1][1]:
                roots = []
            loops.append(Vectors(tuple(roots), {g: z for g, z in levers.items() if z}, tuple(along)))
        return loops

    def _along(self, machine: Machine, name: str) -> tuple[str, complex]:
        """Group with which a slide's line turns, and the line's unit vector in its axes."""
        slide = machine.slide(name)
        angle = slide.angle + self.groups.excess[slide.guide.body]
        return self.groups.of[slide.guide.body], complex(math.cos(angle), math.sin(angle))

    def _step(
        self, machine: Machine, unknowns: list[Key], loops: list[Vectors], within: list[Relation], joints: tuple[str, ...]
    ) -> Step:
        if not loops and len(unknowns) == 1 and unknowns[0] in within[0].shares and unknowns[0] != within[0].argument:
            return Direct(unknowns[0], within[0])
        angles = tuple(name for kind, name in unknowns if kind == "angle")
        lengths = tuple(name for kind, name in unknowns if kind == "length")
        start = np.array([_start_angle(machine, self.groups, g) for g in angles] + [_start_length(machine, s) for s in lengths])
        block = Block(angles, lengths, tuple(loops), tuple(within), joints, start)
        if len(loops) != 1 or within:
            return block
        (loop,) = loops
        own = {slide: (group, way) for slide, group, way in loop.ways}
        if len(own) < len(loop.ways) or any(g in angles and s not in lengths for s, (g, _) in own.items()):
            return block
        levers = [loop.levers.get(g, 0j) for g in angles]
        if len(angles) == 2 and all(levers):
            z1, z2 = (lever * np.exp(1j * x) for lever, x in zip(levers, start, strict=True))
            return Dyad("angles", block, 1 if (np.conj(z1 + z2) * z1).imag >= 0 else -1)
        if len(angles) == 1 and lengths[0] in own:
            group, way = own[lengths[0]]
            if group == angles[0]:
                foot = levers[0] * np.conj(way)
                return Dyad("inverted", block, 1 if foot.real + start[1] >= 0 else -1)
            if levers[0]:
                facing = way * np.exp(1j * _start_angle(machine, self.groups, group))
                return Dyad("slider", block, 1 if (np.conj(facing) * levers[0] * np.exp(1j * start[0])).real >= 0 else -1)
        if len(lengths) == 2 and set(lengths) == set(own):
            return Dyad("lengths", block, 1)
        return block

    # ---- solving ----

    def state(self, theta: Floats, order: int, upto: int | None = None) -> State:
        """All unknowns, or those of the first steps alone."""
        made = State(self, theta, order)
        with np.errstate(all="ignore"):
            for step in self.steps[:upto]:
                if isinstance(step, Direct):
                    made.take(step)
                elif isinstance(step, Dyad):
                    made.close(step)
                else:
                    made.converge(step)
        return made

    def trace(self, block: Block, low: float, high: float) -> newton.Trace:
        """What was followed of a larger block, over the range at least."""
        low, high = min(low, 0.0), max(high, math.tau)
        if block.trace is None or not block.trace.covers(low, high):
            upto = self.steps.index(block)
            if block.trace is not None:
                low, high = min(low, math.floor(block.trace.theta[0])), max(high, math.ceil(block.trace.theta[-1]))
            block.trace = block.follow(lambda theta: self.state(theta, 2, upto).known(block), low, high)
        return block.trace

    def followed(self, group: str, low: float, high: float) -> tuple[Floats, Floats]:
        """A group's angle, continuous from the drawn position: angles theta and values, rad, over the range at least."""
        low, high = min(low, 0.0), max(high, math.tau)
        kept = self._followed.get(group)
        if kept is None or kept[0][0] > low or kept[0][-1] < high:
            below, above = (math.ceil(abs(end) / math.tau * FOLLOWED - 1e-9) for end in (low, high))
            theta = np.asarray(np.arange(-below, above + 1) * (math.tau / FOLLOWED), float)
            step = self.maker["angle", group]
            state = self.state(theta, 0, step + 1)
            angle = np.angle(state.angles[group][0])
            sound = np.isfinite(angle)
            values = np.unwrap(angle[sound])
            if values.size:
                origin = int(np.argmin(np.abs(theta[sound])))
                made = self.steps[step]
                assert not isinstance(made, Direct)
                drawn = made.start if isinstance(made, Block) else made.block.start
                names = made.angles if isinstance(made, Block) else made.block.angles
                values += math.tau * round((drawn[names.index(group)] - values[origin]) / math.tau)
            kept = self._followed[group] = (theta[sound], values)
        return kept


class State:
    """All unknowns at theta, (n,) rad, with derivatives up to the order."""

    def __init__(self, chain: Chain, theta: Floats, order: int) -> None:
        self.chain, self.theta, self.order = chain, theta, order
        self.angles: dict[str, Spin] = {GROUND: [1.0, 0, 0][: order + 1]}
        self.lengths: dict[str, Jet] = {}
        self._angle: dict[str, Any] = {GROUND: 0.0}
        self._turns: dict[str, Jet] = {GROUND: [1.0, 0, 0][: order + 1]}
        self._origins: dict[str, Jet] = {GROUND: [0, 0, 0][: order + 1]}
        self._near: dict[tuple[float, int], Any] = {}  # by where an angle was followed, the nearest place of each theta

    # ---- what is known ----

    def angle(self, group: str) -> Jet:
        """A group's angle with derivatives, continuous from the drawn position."""
        if group not in self._angle:
            e = self.angles[group][0]
            low, high = (float(np.min(self.theta)), float(np.max(self.theta))) if self.theta.size else (0.0, 0.0)
            theta, values = self.chain.followed(group, low, high)
            angle = np.arctan2(e.imag, e.real)
            turns = self._nearest(theta, values) - angle
            turns *= 1 / math.tau
            np.rint(turns, out=turns)
            turns *= math.tau
            self._angle[group] = turns + angle
        return [self._angle[group], *self.angles[group][1:]]

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

    def turn(self, group: str) -> Jet:
        """exp(i angle) of a group with its derivatives."""
        if group not in self._turns:
            e, w, a = [*self.angles[group], 0, 0][:3]
            self._turns[group] = turned(e, w, a, self.order)
        return self._turns[group]

    def origin(self, body: str) -> Jet:
        """A body's origin on the ground, complex mm, with derivatives."""
        if body not in self._origins:
            self._origins[body] = self.sum(self.chain.route[body], (), ())[0]
        return self._origins[body]

    def point(self, place: Place) -> Jet:
        """A place on the ground, complex mm, with derivatives."""
        lever = self.chain.groups.turned(place)
        turn = self.turn(self.chain.groups.of[place.body]) if lever else []
        rows = self.origin(place.body)
        return [plus(row, times(lever, t)) for row, t in zip(rows, turn, strict=True)] if lever else rows

    def sum(self, loop: Vectors, angles: tuple[str, ...], lengths: tuple[str, ...]) -> tuple[Jet, list[tuple[int, Jet]]]:
        """What is known of a loop, and the known ways of its unknown lengths; angles and lengths are the unknown ones."""
        total: Jet = [0, 0, 0][: self.order + 1]
        ways = []
        for sign, body in loop.roots:
            rows = self.origin(body)
            total = [plus(t, row) if sign > 0 else minus(t, row) for t, row in zip(total, rows, strict=True)]
        for group, lever in loop.levers.items():
            if group not in angles:
                total = [plus(t, times(lever, row)) for t, row in zip(total, self.turn(group), strict=True)]
        for slide, group, along in loop.ways:
            if group in angles:
                continue
            way = [times(along, row) for row in self.turn(group)]
            if slide in lengths:
                ways.append((lengths.index(slide), way))
            else:
                total = [plus(t, row) for t, row in zip(total, product(self.lengths[slide], way), strict=True)]
        return total, ways

    def value(self, key: Key) -> Jet:
        """An angle or length that is known, with derivatives."""
        return self.angle(key[1]) if key[0] == "angle" else self.lengths[key[1]]

    def relation(self, relation: Relation, unknown: tuple[Key, ...]) -> Jet:
        """What is known of a relation, with derivatives."""
        parts = [(share, self.value(key)) for key, share in relation.shares.items() if key not in unknown]
        argument: Jet | None = None
        if relation.argument is not None and relation.argument not in unknown:
            argument = self.value(relation.argument)
        elif relation.law is not None and relation.argument is None:
            drive = relation.name in self.chain.driven
            argument = [self.theta, 1.0, 0] if drive else [np.zeros(self.theta.shape), 0, 0]
        if isinstance(relation.law, Turning) and argument is not None:  # a steady rate costs no sums
            law = relation.law
            rows = relation_jet(Relation("", {}, relation.constant), parts, None, self.order)
            steady = [law.start + law.rate * (argument[0] + relation.shift), *(times(law.rate, row) for row in argument[1:])]
            return [minus(row, value) for row, value in zip(rows, steady, strict=False)]
        return relation_jet(relation, parts, argument, self.order)

    def known(self, block: Block) -> Known:
        """What a larger block needs."""
        sums = [self.sum(loop, block.angles, block.lengths) for loop in block.loops]
        ways = tuple((c, len(block.angles) + j, jet) for c, (_, along) in enumerate(sums) for j, jet in along)
        unknown = tuple(block.column)
        driven = {slide for loop in block.loops for slide, group, _ in loop.ways if group in block.angles}
        lengths = {slide: self.lengths[slide] for slide in driven if slide in self.lengths}
        about = tuple(self.relation(relation, unknown) for relation in block.relations)
        return Known(tuple(total for total, _ in sums), ways, lengths, about)

    # ---- steps ----

    def take(self, step: Direct) -> None:
        """The unknown of a relation."""
        kind, name = step.unknown
        jet = self.relation(step.relation, (step.unknown,))
        share = -step.relation.shares[step.unknown]
        rows = jet if share == 1 else [times(1 / share, row) for row in jet]
        if kind == "length":
            self.lengths[name] = rows
            return
        angle = rows[0] + np.zeros(self.theta.shape)
        self._angle[name] = angle
        self.angles[name] = [unit_turn(angle), *rows[1:]]

    def close(self, step: Dyad) -> None:
        """A dyad."""
        block = step.block
        (loop,) = block.loops
        total, ways = self.sum(loop, block.angles, block.lengths)
        if not isinstance(total[0], np.ndarray):
            total[0] = np.full(self.theta.shape, complex(total[0]))
        if step.kind == "angles":
            a, b = block.angles
            self.angles[a], self.angles[b] = dyads.two_angles(total, loop.levers[a], loop.levers[b], step.branch)
        elif step.kind == "lengths":
            along = dict(ways)
            a, b = block.lengths
            self.lengths[a], self.lengths[b] = dyads.two_lengths(total, along[0], along[1])
        else:
            (a,), (b,) = block.angles, block.lengths
            lever = loop.levers.get(a, 0j)
            if step.kind == "slider":
                self.angles[a], self.lengths[b] = dyads.slider(total, lever, ways[0][1], step.branch)
            else:
                (along_b,) = (way for slide, _, way in loop.ways if slide == b)
                self.angles[a], self.lengths[b] = dyads.inverted(total, lever, along_b, step.branch)

    def converge(self, block: Block) -> None:
        """A larger block."""
        if not self.theta.size:
            rows = [np.zeros((block.size, 0))] * (self.order + 1)
        else:
            trace = self.chain.trace(block, float(self.theta.min()), float(self.theta.max()))
            block.trace = trace
            rows = block.solve(self.theta, self.known(block), self.order)
        for name in block.angles:
            k = block.column["angle", name]
            self._angle[name] = rows[0][k]
            self.angles[name] = [unit_turn(rows[0][k]), *(row[k] for row in rows[1:])]
        for name in block.lengths:
            self.lengths[name] = [row[block.column["length", name]] for row in rows]

    # ---- for those outside ----

    def output(self, output: Output) -> Floats | Points:
        """An output with derivatives to theta, (order + 1, n): rad, mm or complex mm."""
        n, of, groups = self.theta.size, output.of, self.chain.groups
        if isinstance(of, Path):
            return np.asarray(stacked(self.point(of.of), n, complex))
        if isinstance(of, Angle):
            rows = stacked(self.angle(groups.of[of.body]), n, float) - stacked(self.angle(groups.of[of.on]), n, float)
            rows[0] += groups.excess[of.body] - groups.excess[of.on]
            return np.asarray(rows)
        if isinstance(of, Along):
            return np.asarray(stacked(self.lengths[of.slide], n, float))
        return np.asarray(of.value(*(stacked(self.point(place), n, complex) for place in of.of)))


def _from(body: str) -> Vectors:
    """A body's own origin."""
    return Vectors(((1, body),), {}, ())


def _add(levers: dict[str, complex], group: str, lever: complex) -> None:
    if abs(lever) > NO_LEVER:
        levers[group] = levers.get(group, 0j) + lever


def _start_angle(machine: Machine, groups: Groups, group: str) -> float:
    """A group's angle as drawn: its first body's."""
    return 0.0 if group == GROUND else float(machine.start_of(group).angle) - groups.excess[group]


def _start_length(machine: Machine, name: str) -> float:
    """Place along a slide or slot as drawn, mm."""
    slide = machine.slide(name)
    base, runner = (machine.start_of(place.body) for place in (slide.guide, slide.runner))
    way = runner.place + np.exp(1j * runner.angle) * slide.runner.at - base.place - np.exp(1j * base.angle) * slide.guide.at
    return float((way * np.exp(-1j * (base.angle + slide.angle))).real)


_chains: weakref.WeakKeyDictionary[Machine, Chain] = weakref.WeakKeyDictionary()


def chain_of(machine: Machine) -> Chain:
    """The machine's chain, parted once and kept as long as the machine."""
    if machine not in _chains:
        _chains[machine] = Chain(machine)
    return _chains[machine]

