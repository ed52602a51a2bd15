"""How far a machine's drive can turn, and where on its way it stands near a fold.

determinant    of a block's equations with all sizes taken out: of a dyad the sine of its transmission angle
dead point     the chain ends: beyond it a block does not close, and at it the determinant is 0
change point   the determinant touches or passes 0 and the chain goes on: two branches meet, and play decides which is
               taken; closed forms keep their branch there, Newton's method goes straight on
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from camgen.errors import DesignError, listed
from camgen.machine.grashof import crank_limits
from camgen.machine.loops import Chain, chain_of
from camgen.machine.model import GROUND, Gear, Machine, bodies_of
from camgen.machine.newton import Block
from camgen.machine.state import Direct, Step
from camgen.numerics import Floats, roots

# Angles a turn that are looked at first.
LOOKED = 720
INSIDE = 1e-12  # rad, by which a range ends before its dead point, where rounding decides whether the chain closes
# Rounds in which a least place between samples is found, and how much closer each looks: to 1e-11 rad.
ROUNDS = 8
CLOSER = 12
# Determinant below which a position counts as a fold: 0.06 deg of transmission angle.
FOLD = 1e-3
# Determinant at all samples above which none of them is beside a gap: it is 0 at both ends of one, and a dyad that passes
# through 6 deg of transmission angle between two samples would turn a hundred times as fast as its drive.
FAR = 0.1


@dataclass(frozen=True)
class Fold:
    """The nearest a block comes to a fold."""

    joints: tuple[str, ...]  # of the block
    theta: float  # rad
    determinant: float  # the least, 0 at a change or dead point
    passed: bool = False  # whether its sign changes there

    @property
    def change_point(self) -> bool:
        """Whether it is one, to the rounding of practice."""
        return self.passed or self.determinant < FOLD


@dataclass(frozen=True)
class Reach:
    """Range of theta about 0, rad, over which a machine closes: full where it closes all round; who ends it below and
    above (joints of the block that opens), none where nothing does."""

    low: float
    high: float
    full: bool
    ends: tuple[tuple[str, ...], tuple[str, ...]] = ((), ())


def reach(machine: Machine) -> Reach:
    """The range over which the machine closes from its drawn position; dead points to 1e-9 rad or better."""
    chain = chain_of(machine)
    high, above = _end(chain, 1)
    if not above:
        return Reach(0.0, math.tau, True)
    low, below = _end(chain, -1)
    return Reach(low, high, False, (below, above))


def refuse_partial(machine: Machine, least: float = 0.0) -> None:
    """Raise DesignError where the machine cannot turn fully: the range that it can have with a transmission angle of at least
    so many degrees, and the joints that end it."""
    span = reach(machine)
    if span.full:
        return
    low = math.degrees(span.low)
    high = math.degrees(span.high)
    names = listed("joint", list(dict.fromkeys(name for joints in span.ends for name in joints)))
    crank = machine.drives[0].body
    within = _without_folds(machine, span)
    cure = f"change the lengths of {_links(machine, span)}"
    if within is not None:
        begin, end, short = _steep(machine, within, least)
        cure = (
            f"let it go to and fro, drive.range_deg = [{begin:.10g}, {end:.10g}]{short}, or {cure}"
        )
    closes = f"from {_shown(low)} to {_shown(high)} deg"
    raise DesignError(
        "range of the drive",
        high - low,
        360,
        "deg",
        f"{names}: it closes {closes}",
        cure + crank_limits(machine, span.ends, crank),
    ).saying(
        f"the drive cannot turn fully: the chain closes only {closes} of its angle, and opens at {names} beyond that"
    )


def _shown(angle: float) -> str:
    """An angle, deg, to a hundredth."""
    return f"{round(angle, 2) + 0.0:g}"


def _links(machine: Machine, span: Reach) -> str:
    """The links that the joints at which a chain opens hold together."""
    joints = (machine.joint(name) for joints in span.ends for name in joints)
    bodies = dict.fromkeys(body for joint in joints for body in bodies_of(joint))
    return ", ".join(body for body in bodies if body != GROUND) or "its links"


def _without_folds(machine: Machine, span: Reach) -> tuple[float, float] | None:
    """The range about the drawn position, rad, a degree within what closes and off every change point; None of a machine that
    is drawn at one."""
    spare = min(math.radians(1.0), (span.high - span.low) / 10)
    low = span.low + spare
    high = span.high - spare
    while low < 0 < high:
        places = [fold.theta for fold in folds(machine, low, high) if fold.change_point]
        if not places:
            return low, high
        low = max([low, *(place + spare for place in places if place <= 0)])
        high = min([high, *(place - spare for place in places if place > 0)])
    return None


def _steep(machine: Machine, within: tuple[float, float], least: float) -> tuple[float, float, str]:
    """The part of a range about the drawn position, deg, with the least transmission angle, deg, as `folds` judges it, rounded
    inwards; of a machine that has it not even as drawn the whole, and a word on that."""
    low, high = map(math.degrees, within)
    spare = min(1.0, (high - low) / 10)
    # steps a degree, to which it is rounded
    per = round(10 ** max(1, math.ceil(-math.log10(spare))))
    theta = np.radians(np.linspace(low, high, LOOKED + 1))
    poor = np.min(list(transmission(machine, theta).values()), axis=0, initial=90.0) < least
    weak = np.degrees(theta[poor]).tolist()
    begin = math.ceil(per * low)
    end = math.floor(per * high)
    whole = begin / per, end / per
    if not weak:
        return *whole, ""
    while weak and begin < end and begin <= 0 <= end:
        begin = max([begin, *(math.ceil(per * place) + 1 for place in weak if place <= 0)])
        end = min([end, *(math.floor(per * place) - 1 for place in weak if place >= 0)])
        folds_of_part = folds(machine, math.radians(begin / per), math.radians(end / per))
        angles = (
            (each.theta, math.asin(min(1.0, abs(each.determinant)))) for each in folds_of_part
        )
        weak = [math.degrees(place) for place, angle in angles if math.degrees(angle) < least]
    if begin < end and begin <= 0 <= end:
        return begin / per, end / per, f" (with a transmission angle of {least:g} deg)"
    return *whole, f" (the transmission angle is below {least:g} deg as drawn)"


@lru_cache(maxsize=4)  # a machine is the same object for its limits
def folds(machine: Machine, low: float = 0.0, high: float = math.tau) -> tuple[Fold, ...]:
    """For each block but those of gears alone the place of the range, rad, where it comes nearest to a fold, and each place where its sign changes."""
    chain = chain_of(machine)
    theta = np.linspace(low, high, LOOKED + 1)
    all_folds = []
    for number, step in enumerate(chain.steps):
        if isinstance(step, Direct):
            continue
        block = step if isinstance(step, Block) else step.block
        if all(isinstance(machine.joint(name), Gear) for name in block.joints):
            continue  # wheels that turn in proportion do not fold

        def sine(angles: Floats, number: int = number) -> Floats:
            return determinant(chain, number, angles)

        values = sine(theta)
        if not np.isfinite(values).any():
            continue
        least = min(_minima(lambda t, f=sine: np.abs(f(t)), theta), key=lambda pair: pair[1])  # type: ignore[misc]
        signs = np.sign(values[np.isfinite(values)])
        places = theta[np.isfinite(values)][1:][signs[1:] * signs[:-1] < 0]
        all_folds.append(Fold(block.joints, least[0], max(least[1], 0.0), bool(places.size)))
        all_folds += [
            Fold(block.joints, float(place), 0.0, True)
            for place in places
            if abs(place - least[0]) > 0.02
        ]
    return tuple(all_folds)


def refuse_folds(machine: Machine, low: float = 0.0, high: float = math.tau) -> None:
    """Raise DesignError at a change point: the joints and the angle."""
    slides = machine.drives[0].slide is not None
    key, unit = ("drive.range", "mm") if slides else ("drive.range_deg", "deg")
    for fold in folds(machine, low, high):
        if fold.change_point:
            place = f"{math.degrees(fold.theta):.6g} {unit}"
            raise DesignError(
                "sine of the transmission angle",
                fold.determinant,
                FOLD,
                "",
                f"{listed('joint', fold.joints)}, {place} (change point)",
                f"change a length, or keep {key} away from this place",
            ).saying(
                f"change point at {place}: the links at {listed('joint', fold.joints)} lie in line "
                f"there, and the chain can go on in either of two ways (sine of the transmission angle {max(fold.determinant, 0):.1g}, limit {FOLD:g})"
            )


def transmission(machine: Machine, theta: Floats) -> dict[tuple[str, ...], Floats]:
    """Transmission angle of each loop that is closed together, by its joints: 0 (a fold) to 90 deg at theta, (n,) rad; of a loop
    that is no dyad the same measure of its equations. nan where it does not close."""
    chain = chain_of(machine)
    angles = {}
    for number, step in enumerate(chain.steps):
        if not isinstance(step, Direct):
            joints = (step if isinstance(step, Block) else step.block).joints
            angles[joints] = np.degrees(
                np.arcsin(np.minimum(np.abs(determinant(chain, number, theta)), 1.0))
            )
    return angles


def determinant(chain: Chain, number: int, theta: Floats) -> Floats:
    """Of a step's equations at theta, (n,); nan where it does not close."""
    step = chain.steps[number]
    if isinstance(step, Direct):
        return np.ones(theta.size)
    block = step if isinstance(step, Block) else step.block
    state = chain.state(theta, 0, number + 1)
    with np.errstate(all="ignore"):
        known = chain.state(theta, 0, number).known(block)
        rows = [state.direction(name) for name in block.angles] + [
            state.lengths[name][0] for name in block.lengths
        ]
        if isinstance(step, Block) and block.relations:  # laws of angles want them continuous
            rows[: len(block.angles)] = [state.angle(name)[0] for name in block.angles]
        return block.determinant(np.array(rows), known)


def _minima(value: Callable[[Floats], Floats], theta: Floats) -> list[tuple[float, float]]:
    """Places and values of the least of a positive function near each of its least samples; -1 where it is nan."""

    def safe(t: Floats) -> Floats:
        return np.nan_to_num(value(t), nan=-1.0)

    at = safe(theta)
    beyond = np.pad(at, 1, constant_values=np.inf)  # both ends are looked at like any other place
    inner = np.flatnonzero((at <= beyond[:-2]) & (at <= beyond[2:]))
    inner = inner[at[inner] >= 0]
    place = theta[inner]
    least = at[inner]
    reach = theta[1] - theta[0]
    for _ in range(
        ROUNDS if inner.size else 0
    ):  # all of a round at once: a call costs more than its angles
        grid = place[:, None] + reach * np.linspace(-1, 1, 2 * CLOSER + 1)
        grid = np.clip(grid, theta.min(), theta.max())
        values = safe(np.ravel(grid)).reshape(grid.shape)
        best = np.argmin(values, axis=1)[:, None]
        place = np.take_along_axis(grid, best, 1)[:, 0]
        least = np.take_along_axis(values, best, 1)[:, 0]
        reach = reach / CLOSER
    k = int(np.nanargmin(np.where(at >= 0, at, np.inf)))
    return [(float(theta[k]), float(at[k])), *zip(place.tolist(), least.tolist(), strict=True)]


def _end(chain: Chain, sign: int) -> tuple[float, tuple[str, ...]]:
    """How far the chain closes in one sense, up to a turn, and the joints of the step that opens there."""
    theta = np.linspace(0.0, sign * math.tau, LOOKED + 1)
    nearest = sign * math.tau
    by = tuple[str, ...]()
    for number, step in enumerate(chain.steps):
        if isinstance(step, Direct):
            continue
        if isinstance(step, Block):
            trace = chain.trace(step, min(0.0, sign * math.tau), max(0.0, sign * math.tau))
            end = float(trace.theta[-1 if sign > 0 else 0])
            if trace.ends[1 if sign > 0 else 0] and abs(end) < abs(nearest):
                nearest = end
                by = step.joints
            continue
        closes = _closes(chain, number, step)
        open_at = np.flatnonzero(~closes(theta))
        if open_at.size:
            bad = float(theta[open_at[0]])
            good = float(theta[open_at[0] - 1]) if open_at[0] else 0.0
        elif np.nanmin(np.abs(determinant(chain, number, theta))) > FAR:
            continue
        else:  # a gap between two samples
            lows = _minima(lambda t, k=number: np.abs(determinant(chain, k, t)), theta)  # type: ignore[misc]
            gaps = [place for place, value in lows if value < 0]
            if not gaps:
                continue
            bad = min(gaps, key=abs)
            good = bad - sign * math.tau / LOOKED
        low = np.array([min(good, bad)])
        high = np.array([max(good, bad)])
        (edge,) = roots(
            lambda t, _, f=closes: (np.where(f(t), sign, -sign), np.zeros(1)),  # type: ignore[misc]
            low,
            high,
        ).tolist()
        edge -= sign * INSIDE
        if abs(edge) < abs(nearest):
            nearest = edge
            by = step.block.joints
    return nearest, by


def _closes(chain: Chain, number: int, step: Step) -> Callable[[Floats], NDArray[np.bool_]]:
    """Whether the first steps close at theta, (n,)."""
    assert not isinstance(step, Direct)
    block = step if isinstance(step, Block) else step.block

    def closes(theta: Floats) -> NDArray[np.bool_]:
        state = chain.state(theta, 0, number + 1)
        rows = [state.spins[name][0] for name in block.angles] + [
            state.lengths[name][0] for name in block.lengths
        ]
        finite: NDArray[np.bool_] = np.isfinite(np.array(rows)).all(axis=0)
        return finite

    return closes
