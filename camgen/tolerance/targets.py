"""How many printed copies keep what is wanted of their outputs, and the small loops of their paths.

    target   each copy's course is the nominal one and the sum of its modes times the copy's errors; its target is measured on it
    loop     where a path crosses itself it makes a loop; whether the crossing is still there on the copy's path, without play and
             with each pin pushed to a place in its clearance that is as likely as any other

Courses are of first order, what is measured on them is not: so few hundred copies are looked at, the first of all.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache, partial

import numpy as np

from camgen.findings import Finding, Where
from camgen.machine.landmarks import smallest_loop
from camgen.machine.model import Output, Path, Pin, places_of, unit_of
from camgen.machine.run import solve
from camgen.machine.targets import Advance, Course, Target, target_findings
from camgen.numerics import Floats, Points
from camgen.tolerance.spread import Spread

MOST = 400  # copies that are looked at
_SIDE = 60  # pieces of a loop, and as many on either side of it


@dataclass(frozen=True)
class TargetYield:
    """Of a target of an output which copies keep it, (copies,); its code, limit and unit."""

    output: str
    code: str
    limit: float
    unit: str
    holds: Floats


def targets(spread: Spread, errors: Floats) -> list[TargetYield]:
    """All targets of the judged outputs; errors: of copies, (copies, modes) mm."""
    wanted = {each.output: each.targets for each in spread.mechanism.assembly.demands}
    outputs = [output for output in spread.outputs if wanted.get(output.name)]
    if not outputs:
        return []
    run = solve(spread.mechanism.model, spread.theta, 1)
    whole = abs(float(np.ptp(spread.theta)) - 2 * np.pi) < 1e-9
    by = spread.mechanism.assembly.cycle.unit

    @cache
    def courses(name: str) -> list[Course]:
        """Of an output, of each copy."""
        unit, scale = unit_of(spread.mechanism.model.output(name))
        value, slope = scale * run.derivatives(name)
        modes = scale * spread.found[name].modes
        bends = np.gradient(modes, spread.theta, axis=1)
        return [
            Course(spread.theta, value + each @ modes, slope + each @ bends, unit, whole, by)
            for each in errors
        ]

    def of_copy(k: int) -> Callable[[str], Course]:
        return lambda name: courses(name)[k]

    def findings(name: str, target: Target | Advance) -> list[Finding]:
        """Of a target, of each copy."""
        each = enumerate(courses(name))
        made = [target_findings([target], course, Where(), of_copy(k)) for k, course in each]
        return [finding for found in made for finding in found]

    yields = []
    for output in outputs:
        for target in wanted[output.name]:
            made = findings(output.name, target)
            holds = np.array([each.ok for each in made])
            yields.append(TargetYield(output.name, target.code, made[0].limit, made[0].unit, holds))
    return yields


@dataclass(frozen=True)
class Loop:
    """A loop of an output's path: where it begins and ends, rad, its extent, mm; shares of copies in which it is left, without
    play and with it."""

    output: str
    begins: float
    ends: float
    extent: float
    printed: float
    loose: float


def loops(spread: Spread, errors: Floats, seed: int) -> list[Loop]:
    """The smallest loop of each path that crosses itself; errors: of copies, (copies, modes) mm."""
    machine = spread.mechanism.model
    found = list[Loop]()
    if spread.mechanism.assembly.cycle.range != (0.0, 2 * np.pi):
        return found
    for output in (each for each in machine.outputs if isinstance(each.of, Path)):
        loop = smallest_loop(partial(_path, spread, output.name), 1440)
        if loop is None:
            continue
        begins = loop[0]
        span = loop[1] - loop[0]
        theta = np.linspace(begins - span, begins + 2 * span, 3 * _SIDE + 1)
        path, modes = _moved(spread, output, theta)
        inside = path[_SIDE : 2 * _SIDE + 1]
        extent = float(max(np.ptp(inside.real), np.ptp(inside.imag)))
        pushed = errors + _pin_play_errors(spread, len(errors), seed)
        left = [
            float(np.mean([_crosses(path + each @ modes) for each in made]))
            for made in (errors, pushed)
        ]
        found.append(Loop(output.name, begins, begins + span, extent, *left))
    return found


def _path(spread: Spread, name: str, theta: Floats, order: int) -> Points:
    """A path or its derivative."""
    return np.asarray(
        solve(spread.mechanism.model, theta, order).derivatives(name)[order], complex
    ).reshape(np.shape(theta))


def _moved(spread: Spread, output: Output, theta: Floats) -> tuple[Points, Points]:
    """A path at theta, (n,), and what each mode does to it, (modes, n)."""
    run = solve(spread.mechanism.model, theta, 0)
    return np.asarray(run[output.name], complex), np.asarray(
        spread.felt(run, [output.name])[output.name].modes, complex
    )


def _pin_play_errors(spread: Spread, copies: int, seed: int) -> Floats:
    """Each pin with play somewhere in it, as errors of a centre, (copies, modes) mm: of the side that no output goes with."""
    machine = spread.mechanism.model
    chance = np.random.default_rng(seed)
    pushed = np.zeros((copies, len(spread.modes)))
    seen = [place for output in spread.outputs for place in places_of(output.of)]
    centres: Mapping[str, Sequence[int]] = {}
    for k, mode in enumerate(spread.modes):
        if mode.kind == "centre":
            centres = {**centres, mode.where: [*centres.get(mode.where, ()), k]}
    for joint in machine.joints:
        if not isinstance(joint, Pin) or not joint.clearance:
            continue
        held = (
            centres.get(f"{joint.name}, {place.body}", ())
            for place in sorted((joint.a, joint.b), key=seen.__contains__)
        )
        both = next((found for found in held if len(found) == 2), None)
        reach = joint.clearance / 2 * np.sqrt(chance.random(copies))
        angle = 2 * np.pi * chance.random(copies)
        if both is not None:
            pushed[:, both[0]] = reach * np.cos(angle)
            pushed[:, both[1]] = reach * np.sin(angle)
    return pushed


def _crosses(path: Points) -> bool:
    """Whether a polyline crosses itself."""
    a = path[:-1]
    b = path[1:]
    side = np.imag(np.conj(b - a)[:, None] * (path[None, :] - a[:, None]))
    apart = side[:, :-1] * side[:, 1:] < 0  # ends of piece j on both sides of piece i
    return bool(np.any(np.triu(apart & apart.T, 2)))
