"""Least squares of many designs at once: Levenberg-Marquardt steps, each design with its own damping."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from camgen.numerics import Floats, Indices, solve

_STEP = 1e-6  # of a difference quotient; unknowns are of size 1
_FIRST = 1e-3  # damping
_MOST = 1e8  # beyond it nothing is won
_WON = 1e-10  # share of the sum of squares: a step that wins less is a design's last one

Residuals = Callable[[Floats, Indices], Floats]


def least_squares(residuals: Residuals, numbers: Floats, rounds: int) -> tuple[Floats, Floats]:
    """Better numbers from given ones, (designs, unknowns), and their sums of squares, (designs,).

    residuals: of numbers (m, unknowns) and which design each of them belongs to, (m,) -> (m, rows).  A sum that is nan or inf
    is never taken.  Each answer is the best that its design came to within the rounds.
    """
    x = numbers.copy()
    count = x.shape[1]
    unit = np.eye(count)
    which = np.arange(len(x))
    value = residuals(x, which)
    cost = _sums(value)
    damping = np.full(len(x), _FIRST)
    which = which[np.isfinite(cost)]
    for _ in range(rounds):
        if not which.size:
            break
        here = x[which]
        at = value[which]
        stepped = (here[:, None, :] + _STEP * unit).reshape(-1, count)
        beside = residuals(stepped, np.repeat(which, count)).reshape(len(which), count, -1)
        slope = (beside - at[:, None]) / _STEP
        bend = np.einsum("mir,mjr->mij", slope, slope)
        down = np.einsum("mir,mr->mi", slope, at)
        own = np.einsum("mii->mi", bend)
        added = damping[which, None] * own + 1e-14 * own.max(axis=1, keepdims=True)
        trial = here - solve(bend + unit * added[:, None, :], down)
        then = residuals(trial, which)
        new = _sums(then)
        better = new < cost[which]
        won = cost[which] - new > _WON * cost[which]
        damping[which] *= np.where(better, 0.2, 4.0)
        taken = which[better]
        x[taken] = trial[better]
        value[taken] = then[better]
        cost[taken] = new[better]
        which = which[won | (~better & (damping[which] < _MOST))]
    return x, cost


def _sums(value: Floats) -> Floats:
    total = np.sum(value**2, axis=1)
    return np.where(np.isfinite(total), total, np.inf)
