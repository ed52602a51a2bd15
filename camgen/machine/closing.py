"""The judge's route: the poses of all bodies at once by Newton's method on the conditions of all joints.

From guessed poses, or followed from the drawn ones in steps that are halved where they stray or change the branch.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from camgen.machine.constraints import Constraints
from camgen.machine.elimination import Row
from camgen.numerics import Floats, magnitude

# Steps of Newton's method; five are needed from a near guess.
STEPS = 20
# Largest misfit of a closed chain, by the size of its links and of the ground under them.
CLOSED = 1e-12
# Angles a turn that are closed one after another from the drawn position.
FOLLOWED = 36
# A step of theta below which the chain ends, rad.
LEAST_STEP = 1e-6
# A step of theta at which the determinant's sign may change: a larger one has jumped to another branch, rad.
PASSES = 1e-4
# A guess that is further from the solution than this is none, rad or share of the machine's size.
NEAR = 0.1


@dataclass(frozen=True)
class LoopClosure:
    """Poses and their derivatives to theta, (n, 3 bodies) each; nan where the machine does not close."""

    theta: Floats
    q: Floats
    first: Floats
    second: Floats


def close(
    system: Constraints, theta: Floats, guess: Floats | None = None, order: int = 2
) -> LoopClosure:
    """The machine closed at theta, (n,) rad, from guessed poses, (n, 3 bodies), or followed from the drawn ones.

    order: 2, or 1 to leave the second derivatives nan.
    """
    system.refuse_unequal()
    theta = np.asarray(theta, float)
    if guess is None:
        guess, signs = _follow(system, theta)
        q, slopes, open_ = _newton(system, guess, theta)
        open_ |= signs * system.order.determinant_sign(slopes, len(q)) < 0
    else:
        q, slopes, open_ = _newton(system, system.turned(guess, theta), theta)
    q[open_] = 0
    first, second = _derivatives(system, q, theta, slopes, order)
    for rows in (q, first, second):
        rows[open_] = np.nan
    return LoopClosure(theta, q, first, second)


def _derivatives(
    system: Constraints, q: Floats, theta: Floats, slopes: Sequence[Row], order: int = 2
) -> tuple[Floats, Floats]:
    """q', q'' to theta at closed poses with their slopes; of order 1 the latter is nan."""
    with np.errstate(all="ignore"):
        first = system.moved(slopes, -system.drift(theta))
        if order < 2:
            return first, np.full(first.shape, np.nan)
        curvatures = system.written(q, theta, first).bends(len(q))
        return first, system.moved(slopes, -curvatures)


def _newton(
    system: Constraints, guess: Floats, theta: Floats
) -> tuple[Floats, Sequence[Row], NDArray[np.bool_]]:
    """Closed poses, the slopes there, and which stay open."""
    q = guess.copy()
    open_ = ~np.isfinite(q).all(axis=1)
    q[open_] = system.start
    with np.errstate(all="ignore"):
        for _ in range(STEPS):
            rows = system.written(q, theta)
            step = system.moved(rows.slopes, rows.misfits(len(q)))
            open_ |= ~np.isfinite(step).all(axis=1)
            step[open_] = 0
            q -= step
            if np.abs(step / system.unit).max(initial=0) <= 1e-9:  # the error left is its square
                break
        rows = system.written(q, theta)
    misfits = rows.misfits(len(q))
    open_ |= ~(np.abs(misfits).max(axis=1, initial=0) <= CLOSED * system.size)
    return q, rows.slopes, open_


def _follow(system: Constraints, theta: Floats) -> tuple[Floats, Floats]:
    """Guesses for all theta from angles closed one after the other, nan beyond where the chain ends; the
    determinant's sign that is to be found there, 0 where it changes."""
    guess = np.full((theta.size, system.width), np.nan)
    signs = np.zeros(theta.size)
    origin, slopes, lost = _newton(system, system.start[None], np.zeros(1))
    if lost[0]:
        return guess, signs
    for sign in (1, -1):
        mine = np.flatnonzero(theta * sign >= 0 if sign > 0 else theta < 0)
        if not mine.size:
            continue
        far = magnitude(theta[mine])
        step = 2 * np.pi / FOLLOWED
        angle = 0.0
        q = origin
        sign_here = system.order.determinant_sign(slopes, 1)[0]
        crossing = False
        rows = [(0.0, q, *_derivatives(system, q, np.zeros(1), slopes))]
        while abs(angle) < far and step > LEAST_STEP:
            to = np.array([angle + sign * step])
            _, at, first, second = rows[-1]
            h = sign * step
            aim = at + h * (first + 0.5 * h * second)
            new, steep, lost = _newton(system, aim, to)
            crossed = system.order.determinant_sign(steep, 1)[0] != sign_here
            v, a = _derivatives(system, new, to, steep)
            back = new - h * (v - 0.5 * h * a) - at
            away = np.abs(np.concatenate([new - aim, back]) / system.unit).max()
            if lost[0] or not away < NEAR or (crossed and step > PASSES):
                step /= 2
                continue
            crossing |= bool(crossed)
            sign_here = -sign_here if crossed else sign_here
            angle = float(to[0])
            rows.append((angle, new, v, a))
            step = min(2 * step, 2 * np.pi / FOLLOWED)
        knots = np.array([abs(row[0]) for row in rows])
        q, first, second = (np.concatenate([row[k] for row in rows]) for k in (1, 2, 3))
        nearest = np.searchsorted((knots[1:] + knots[:-1]) / 2, np.abs(theta[mine]))
        h2 = (theta[mine] - sign * knots[nearest])[:, None]
        guess[mine] = q[nearest] + h2 * (first[nearest] + 0.5 * h2 * second[nearest])
        guess[mine[np.abs(theta[mine]) > knots[-1] + LEAST_STEP]] = np.nan
        signs[mine] = 0.0 if crossing else sign_here
    return guess, signs
