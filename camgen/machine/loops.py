"""The maker's route: a machine's positions and derivatives by vector loops, block by block, dyads in closed form.

    route     how a body's origin is reached from one placed earlier: the vectors that lead there
    chain     a machine parted into steps, once; it keeps what was followed from the drawn position

What is known at some angles, step by step, is a `State`.
"""

from __future__ import annotations

import math
import weakref

import numpy as np

from camgen.errors import DesignError
from camgen.machine import newton
from camgen.machine.model import GROUND, Clutch, Machine, Pin
from camgen.machine.newton import Block, Vectors
from camgen.machine.order import (
    NO_LEVER,
    Groups,
    Key,
    Relation,
    components,
    group_bodies,
    places,
    relations,
)
from camgen.machine.state import FOLLOWED, Direct, Dyad, State, Step
from camgen.numerics import Floats


class Chain:
    """A machine parted into steps. Raises DesignError where equations and unknowns do not match."""

    def __init__(self, machine: Machine) -> None:
        self.driven = {drive.name for drive in machine.drives}  # whose laws are of theta
        self.driven |= {joint.name for joint in machine.joints if isinstance(joint, Clutch)}
        self.groups: Groups = group_bodies(machine)
        self.route: dict[str, Vectors] = {GROUND: Vectors()}
        self.steps: list[Step] = []
        self.maker: dict[Key, int] = {}  # the step that gives an unknown
        self._courses: dict[str, tuple[Floats, Floats]] = {}
        self.looked: State | None = None  # what `stepwise` looks at
        self._place_blocks(machine)
        self.levers: dict[
            str, float
        ] = {}  # of each group one on which something hangs, where it is real
        for vectors in self.route.values():
            for group, lever in vectors.levers.items():
                if not lever.imag:
                    self.levers.setdefault(group, lever.real)

    # ---- parting into steps, once ----

    def _place_blocks(self, machine: Machine) -> None:
        known = relations(machine, self.groups)
        order = components(machine, self.groups, known)
        if order.loose or order.over:
            names = list(order.over) or list(dict.fromkeys(name for _, name in order.loose))
            short = (
                "is held by more conditions than it needs" if order.over else "is held by nothing"
            )
            raise DesignError(
                "conditions less unknowns",
                len(order.over) - len(order.loose),
                0,
                "",
                ", ".join(names),
                short,
            )
        by_name = {relation.name: relation for relation in known}
        for part in order.components:
            names = [name for axis, name in part.equations if axis == "x"]
            within = [by_name[name] for axis, name in part.equations if axis == "s"]
            bodies = [name for axis, name in part.unknowns if axis == "x"]
            loops = []
            if names:
                loops = [self._fold(loop) for loop in self._loops(machine, names, bodies)]
            self.route |= {
                body: self._fold(self.route[body]) for body in bodies if body in self.route
            }
            unknowns = [key for key in part.unknowns if key[0] in ("angle", "length")]
            if 2 * len(loops) + len(within) != len(unknowns):
                raise DesignError(
                    "conditions less unknowns",
                    2 * len(loops) + len(within) - len(unknowns),
                    0,
                    "",
                    ", ".join(part.joints()),
                    "give these joints places that do not coincide",
                )
            if unknowns:
                for key in unknowns:
                    self.maker[key] = len(self.steps)
                self.steps.append(self._step(machine, unknowns, loops, within, part.joints()))

    def _loops(self, machine: Machine, names: list[str], bodies: list[str]) -> list[Vectors]:
        """Place the block's bodies along its joints; each joint that is left over closes a loop."""
        before = set(self.route)
        fresh = set(bodies) - set(self.route)
        remaining = [machine.joint(name) for name in names]
        progress = True
        while progress:
            progress = False
            for joint in list(remaining):
                both = places(joint)
                assert both is not None
                a, b = both
                placed, next_place = (a, b) if a.body in self.route else (b, a)
                if (
                    placed.body not in self.route
                    or next_place.body in self.route
                    or next_place.body not in fresh
                ):
                    continue
                base = _from(placed.body) if placed.body in before else self.route[placed.body]
                # origin of the next body = place on the placed one - place on the next, and the length between
                levers = dict(base.levers)
                _add(levers, self.groups.of[placed.body], self.groups.turned(placed))
                _add(levers, self.groups.of[next_place.body], -self.groups.turned(next_place))
                ways = base.ways
                if not isinstance(joint, Pin):
                    group, way = self._along(machine, joint.name)
                    ways = (*ways, (joint.name, group, way if placed is a else -way))
                self.route[next_place.body] = Vectors(base.roots, levers, ways)
                remaining.remove(joint)
                progress = True
        loops = []
        for joint in remaining:
            both = places(joint)
            assert both is not None
            if any(place.body not in self.route for place in both):
                if bodies:
                    raise DesignError(
                        "bodies without a place",
                        len(bodies),
                        0,
                        "",
                        ", ".join(bodies),
                        "join them to the ground",
                    )
                continue
            roots: list[tuple[int, str]] = []
            levers = dict[str, complex]()
            along = list[tuple[str, str, complex]]()
            for sign, place in zip(
                (-1, 1) if not isinstance(joint, Pin) else (1, -1), both, strict=True
            ):
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
            loops.append(
                Vectors(tuple(roots), {g: z for g, z in levers.items() if z}, tuple(along))
            )
        return loops

    def _fold(self, vectors: Vectors) -> Vectors:
        """The same with all that stands still in one."""
        still = vectors.still + vectors.levers.get(GROUND, 0j)
        roots = []
        for sign, body in vectors.roots:
            route = self.route[body]
            if route == Vectors(still=route.still):
                still += sign * route.still
            else:
                roots.append((sign, body))
        return Vectors(
            tuple(roots),
            {g: z for g, z in vectors.levers.items() if g != GROUND},
            vectors.ways,
            still,
        )

    def _along(self, machine: Machine, name: str) -> tuple[str, complex]:
        """Group with which a slide's line turns, and the line's unit vector in its axes."""
        slide = machine.slide(name)
        angle = slide.angle + self.groups.excess[slide.guide.body]
        return self.groups.of[slide.guide.body], complex(math.cos(angle), math.sin(angle))

    def _step(
        self,
        machine: Machine,
        unknowns: list[Key],
        loops: list[Vectors],
        within: list[Relation],
        joints: tuple[str, ...],
    ) -> Step:
        if (
            not loops
            and len(unknowns) == 1
            and unknowns[0] in within[0].shares
            and unknowns[0] != within[0].argument
        ):
            return Direct(unknowns[0], within[0])
        angles = tuple(name for kind, name in unknowns if kind == "angle")
        lengths = tuple(name for kind, name in unknowns if kind == "length")
        start = np.array(
            [_start_angle(machine, self.groups, g) for g in angles]
            + [_start_length(machine, s) for s in lengths]
        )
        block = Block(angles, lengths, tuple(loops), tuple(within), joints, start)
        if len(loops) != 1 or within:
            return block
        (loop,) = loops
        ways = {slide: (group, way) for slide, group, way in loop.ways}
        if len(ways) < len(loop.ways) or any(
            g in angles and s not in lengths for s, (g, _) in ways.items()
        ):
            return block
        levers = [loop.levers.get(g, 0j) for g in angles]
        if len(angles) == 2 and all(levers):
            z1, z2 = (lever * np.exp(1j * x) for lever, x in zip(levers, start, strict=True))
            side = float((np.conj(z1 + z2) * z1).imag)
            return _dyad("angles", block, side, abs(z1 * z2))
        if len(angles) == 1 and lengths[0] in ways:
            group, way = ways[lengths[0]]
            if group == angles[0]:
                foot = complex(levers[0] * np.conj(way)) + start[1]
                return _dyad("inverted", block, foot.real, abs(foot))
            if levers[0]:
                facing = way * np.exp(1j * _start_angle(machine, self.groups, group))
                ahead = (np.conj(facing) * levers[0] * np.exp(1j * start[0])).real
                return _dyad("slider", block, float(ahead), abs(levers[0]))
        if len(lengths) == 2 and set(lengths) == set(ways):
            return _dyad("lengths", block, 1.0, 1.0)
        return block

    # ---- solving ----

    def state(self, theta: Floats, order: int, upto: int | None = None) -> State:
        """All unknowns, or those of the first steps alone."""
        state = State(self, theta, order)
        with np.errstate(all="ignore"):
            for step in self.steps[:upto]:
                if isinstance(step, Direct):
                    state.take(step)
                elif isinstance(step, Dyad):
                    state.close(step)
                else:
                    state.converge(step)
        return state

    def trace(self, block: Block, low: float, high: float) -> newton.Trace:
        """What was followed of a larger block, over the range at least."""
        low = min(low, 0.0)
        high = max(high, math.tau)
        if block.trace is None or not block.trace.covers(low, high):
            upto = self.steps.index(block)
            if block.trace is not None:
                low = min(low, math.floor(block.trace.theta[0]))
                high = max(high, math.ceil(block.trace.theta[-1]))
            block.trace = block.follow(
                lambda theta: self.state(theta, 2, upto).known(block), low, high
            )
        return block.trace

    def course(self, group: str, low: float, high: float) -> tuple[Floats, Floats]:
        """A group's angle, continuous from the drawn position: angles theta and values, rad, over the range at least."""
        low = min(low, 0.0)
        high = max(high, math.tau)
        course = self._courses.get(group)
        if course is None or course[0][0] > low or course[0][-1] < high:
            below, above = (math.ceil(abs(end) / math.tau * FOLLOWED - 1e-9) for end in (low, high))
            theta = np.asarray(np.arange(-below, above + 1) * (math.tau / FOLLOWED), float)
            step = self.maker["angle", group]
            state = self.state(theta, 0, step + 1)
            angle = state.direction(group)
            sound = np.isfinite(angle)
            values = np.unwrap(angle[sound])
            if values.size:
                origin = int(np.argmin(np.abs(theta[sound])))
                maker = self.steps[step]
                assert not isinstance(maker, Direct)
                start = maker.start if isinstance(maker, Block) else maker.block.start
                names = maker.angles if isinstance(maker, Block) else maker.block.angles
                values += math.tau * round((start[names.index(group)] - values[origin]) / math.tau)
            course = self._courses[group] = (theta[sound], values)
        return course


def _from(body: str) -> Vectors:
    """A body's own origin."""
    return Vectors(((1, body),), {}, ())


def _add(levers: dict[str, complex], group: str, lever: complex) -> None:
    if abs(lever) > NO_LEVER:
        levers[group] = levers.get(group, 0j) + lever


def _dyad(kind: str, block: Block, side: float, size: float) -> Dyad:
    """A dyad on the side of its fold on which it is drawn."""
    return Dyad(kind, block, 1 if side >= 0 else -1, abs(side) / max(size, 1e-300))


def _start_angle(machine: Machine, groups: Groups, group: str) -> float:
    """A group's angle as drawn: its first body's."""
    return 0.0 if group == GROUND else float(machine.start_of(group).angle) - groups.excess[group]


def _start_length(machine: Machine, name: str) -> float:
    """Place along a slide or slot as drawn, mm."""
    slide = machine.slide(name)
    base, runner = (machine.start_of(place.body) for place in (slide.guide, slide.runner))
    way = (
        runner.place
        + np.exp(1j * runner.angle) * slide.runner.at
        - base.place
        - np.exp(1j * base.angle) * slide.guide.at
    )
    return float((way * np.exp(-1j * (base.angle + slide.angle))).real)


_chains: weakref.WeakKeyDictionary[Machine, Chain] = weakref.WeakKeyDictionary()


def chain_of(machine: Machine) -> Chain:
    """The machine's chain, parted once and kept as long as the machine."""
    if machine not in _chains:
        _chains[machine] = Chain(machine)
    return _chains[machine]


def keep_chain(machine: Machine, like: Machine) -> None:
    """Let a machine have the chain of another one, from which it differs in nothing that decides a position."""
    _chains[machine] = chain_of(like)
