"""Least squares of many designs at once: Levenberg-Marquardt steps, each design with its own damping."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from camgen.numerics import Floats, solve

_STEP = 1e-6  # of a difference quotient; unknowns are of size 1
_FIRST = 1e-3  # damping
_LEAST = 1e-12
_MOST = 1e8  # beyond it nothing is won
_WON = 1e-10  # share of the sum of squares: a step that wins less for every design is the last one

Residuals = Callable[[Floats], Floats]


def least_squares(residuals: Residuals, numbers: Floats, rounds: int) -> tuple[Floats, Floats]:
    """Better numbers from given ones, (designs, unknowns), and their sums of squares, (designs,).

    residuals: of numbers (m, unknowns) -> (m, rows), where row k of the answer belongs to row k of the numbers alone.  A sum
    that is nan or inf is never taken.  Each answer is the best that its design came to within the rounds.
    """
    x = numbers
    count = x.shape[1]
    unit = np.eye(count)
    value = residuals(x)
    cost = _sums(value)
    damping = np.full(len(x), _FIRST)
    for _ in range(rounds):
        stepped = (x[:, None, :] + _STEP * unit).reshape(-1, count)
        slope = (residuals(stepped).reshape(len(x), count, -1) - value[:, None]) / _STEP
        bend = np.einsum("mir,mjr->mij", slope, slope)
        down = np.einsum("mir,mr->mi", slope, value)
        own = np.einsum("mii->mi", bend)
        added = damping[:, None] * own + 1e-14 * own.max(axis=1, keepdims=True)
        trial = x - solve(bend + unit * added[:, None, :], down)
        then = residuals(trial)
        new = _sums(then)
        better = new < cost
        won = np.where(better, cost - np.where(better, new, 0.0), 0.0)
        going = (won > _WON * cost) | (~better & (damping < _MOST) & np.isfinite(cost))
        x = np.where(better[:, None], trial, x)
        value = np.where(better[:, None], then, value)
        cost = np.where(better, new, cost)
        damping = np.where(better, np.maximum(damping / 5, _LEAST), np.minimum(damping * 4, _MOST))
        if not going.any():
            break
    return x, cost


def _sums(value: Floats) -> Floats:
    total = np.sum(value**2, axis=1)
    return np.where(np.isfinite(total), total, np.inf)
