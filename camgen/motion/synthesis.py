"""Search for a design that fulfils wishes: least squares from several starts, the nearest to the first start wins.

variable   one number of the design: its start, its bounds, and the step that counts as one unit of change
wish       a named figure of the design: the value wanted, and by how much it may be missed
shortfall  by how much a design breaks a condition that it must keep, in units of what may be neglected; 0: kept
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from camgen.errors import DesignError
from camgen.numerics import Floats

# Weight of a unit of change against a wish missed by its whole tolerance: it only decides between designs that fulfil all.
_NEAR = 1e-4
_STARTS = 5
_EVALUATIONS = 25
_SEED = 20130904


@dataclass(frozen=True)
class Variable:
    """One number of the design."""

    start: float
    low: float
    high: float
    unit: float


@dataclass(frozen=True)
class Wish:
    """A wish for a figure."""

    name: str  # of the figure
    wanted: float
    tolerance: float  # > 0
    unit: str
    at_least: bool = False  # whether more is as good

    def miss(self, value: float) -> float:
        """By how much a value misses the wish, signed, in tolerances."""
        miss = (value - self.wanted) / self.tolerance
        return min(miss, 0.0) if self.at_least else miss


def search(
    measure: Callable[[Floats], tuple[Mapping[str, float], Sequence[float]]],
    variables: Sequence[Variable],
    wishes: Sequence[Wish],
) -> Floats:
    """Values of the variables, (k,), whose figures fulfil all wishes within their tolerances.

    measure(values) -> (figures by name, shortfalls); nan figures where no such design exists. The same call always gives
    the same answer: starts are seeded. Raises DesignError, with the nearest value that was reached, where none fulfils
    the wishes: no proof that there is none, but all starts ended there.
    """
    from scipy.optimize import least_squares

    first = np.array([v.start for v in variables])
    low = np.array([v.low for v in variables])
    high = np.array([v.high for v in variables])
    unit = np.array([v.unit for v in variables])

    def residuals(values: Floats) -> Floats:
        figures, shortfalls = measure(values)
        misfits = [wish.miss(figures[wish.name]) for wish in wishes]
        # A design that does not exist is as bad as one that misses everything by far.
        all_ = np.array([*misfits, *shortfalls, *(_NEAR * (values - first) / unit)])
        return np.asarray(np.nan_to_num(all_, nan=1e6))

    def misses(values: Floats) -> float:
        figures, shortfalls = measure(values)
        worst = [abs(wish.miss(figures[wish.name])) for wish in wishes] + [
            abs(s) for s in shortfalls
        ]
        return float(np.nan_to_num(max(worst), nan=np.inf))

    around = np.maximum(low, first - 4 * unit), np.minimum(high, first + 4 * unit)
    starts = np.random.default_rng(_SEED).uniform(*around, (_STARTS, len(first)))
    best = first
    least = np.inf
    for start in (first, *starts):
        fit = least_squares(
            residuals,
            start,
            bounds=(low, high),
            x_scale=unit,
            diff_step=1e-6,
            max_nfev=_EVALUATIONS,
        )
        current: Floats = fit.x
        misfits = misses(current)
        if misfits < least:
            best = current
            least = misfits
        if least <= 0.5:
            return np.asarray(best)
    figures, shortfalls = measure(best)
    worst = max(
        wishes, key=lambda wish: abs(np.nan_to_num(wish.miss(figures[wish.name]), nan=np.inf))
    )
    others = ", ".join(
        f"{wish.name} {figures[wish.name]:.6g}" for wish in wishes if wish is not worst
    )
    note = (
        ""
        if not any(abs(s) > 1 for s in shortfalls)
        else "; parts would not stay clear of each other"
    )
    raise DesignError(
        f"{worst.name} wanted",
        worst.wanted,
        figures[worst.name],
        worst.unit,
        "the nearest design found" + (f" ({others})" if others else "") + note,
        "the limit is what was reached; relax this wish, or start from other lengths",
    )
