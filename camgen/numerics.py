"""Linear algebra, quadrature, roots and extremes of one unknown in plain array arithmetic: the same bits on every processor.

numpy's own (`@`, `np.linalg`) calls a BLAS library that picks its order of adding by the processor, so the last digits of
what is written would differ from machine to machine. Systems here are small, and many at once.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

Floats = NDArray[np.float64]
Points = NDArray[np.complex128]
Indices = NDArray[np.intp]
_Result = TypeVar("_Result")

_GOLDEN = (math.sqrt(5) - 1) / 2
_STEPS = 60  # of bisection and of the golden section: 2^-60 and 3e-13 of a bracket
_RESOLVED = 4e-16  # of a place: the distance to the next float
STEEPNESS = 4  # power of a low-pass: steeper ones ring at every corner of a motion
ASKED = 8  # arrays of angles at which one law is asked again and again while a machine is closed
_DEPENDENT = (
    1e-13  # of a column's length, below which what is left beside the other columns is rounding
)


def coordinates(z: Points) -> Floats:
    """Places as rows of x and y, (n, 2); z: (n,) complex."""
    return np.column_stack([z.real, z.imag])


def from_zero(steps: Floats) -> Floats:
    """What steps come to before, between and after them: (n + 1,) of (n,), the first 0."""
    return np.concatenate([[0.0], np.cumsum(steps)])


def peak(values: ArrayLike) -> float:
    """Largest magnitude of real or complex values, those that are nan left out; 0 of none."""
    return float(np.nanmax(np.abs(values), initial=0.0))


def magnitude(values: ArrayLike) -> float:
    """Largest magnitude of real or complex values; nan where one is nan, ValueError of none."""
    return float(np.max(np.abs(values)))


def spread(z: Points) -> float:
    """The longer side of the box round places, (n,) complex, along x and y."""
    return float(max(np.ptp(z.real), np.ptp(z.imag)))


def latest(function: Callable[[Floats], _Result], count: int = 1) -> Callable[[ArrayLike], _Result]:
    """A function that keeps its last results, for callers that ask for the same values several times in a row.

    Values count as the same if their shape and all of them are equal. Each thread gets the result for its own values.
    """
    kept: tuple[tuple[Floats, _Result], ...] = ()

    def of(values: ArrayLike) -> _Result:
        nonlocal kept
        asked = np.asarray(values, float)
        for known, result in kept:
            if np.array_equal(known, asked):
                return result
        result = function(asked)
        kept = ((asked.copy(), result), *kept[: count - 1])
        return result

    return of


def product(a: Floats, b: Floats) -> Floats:
    """The matrix product a b, (n, k) times (k, m) -> (n, m)."""
    total = a[:, :1] * b[:1]
    for k in range(1, a.shape[1]):
        total = total + a[:, k : k + 1] * b[k : k + 1]
    return np.asarray(total)


def solve(matrices: Floats, right: Floats) -> Floats:
    """Solutions of n systems (n, k, k) x = right, (n, k), or (n, k, m) for m of them; nan for a singular one.

    Gauss, partial pivoting. What is zero in all systems is left out: joints tie few bodies to each other, and machines on
    one shaft none.
    """
    n, size = right.shape[:2]
    several = right.reshape(n, size, math.prod(right.shape[2:]))
    if n == 1:
        return _solve_one(matrices[0], several[0]).reshape(right.shape)
    table = np.zeros((size, size + several.shape[2], n))  # row, column, system
    filled = np.ones(table.shape[:2], bool)
    filled[:, :size] = (matrices != 0).any(axis=0)
    at = np.nonzero(filled[:, :size])
    table[at], table[:, size:] = (
        matrices[:, at[0], at[1]].T,
        np.moveaxis(several, 0, -1),
    )  # most of a long chain's table is empty
    filled[:, size:] = (table[:, size:] != 0).any(axis=2)
    found = np.full((size, several.shape[2], n), math.nan)
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        for k in range(size):
            rows = k + np.flatnonzero(filled[k:, k])
            if not rows.size:
                return np.moveaxis(found, -1, 0).reshape(right.shape)
            if rows[0] != k:
                table[[k, rows[0]]] = table[[rows[0], k]]
                filled[[k, rows[0]]] = filled[[rows[0], k]]
                rows[0] = k
            if rows.size > 1:
                columns = k + np.flatnonzero(filled[rows, k:].any(axis=0))
                part = table[rows[:, None], columns]
                sizes = np.abs(part[:, 0])
                largest = sizes[0]
                pivot = np.zeros(n, np.intp)
                for r in range(1, len(sizes)):
                    pivot = np.where(sizes[r] > largest, r, pivot)
                    largest = np.maximum(largest, sizes[r])
                for r in range(1, len(sizes)):
                    swapped = np.flatnonzero(pivot == r)
                    if (
                        len(swapped) == n
                    ):  # most often all of them: they are one machine at many angles
                        part[[0, r]] = part[[r, 0]]
                    elif len(swapped):
                        part[r][:, swapped], part[0][:, swapped] = (
                            part[0][:, swapped],
                            part[r][:, swapped],
                        )
                factors = part[1:, 0] / part[0, 0]
                part[1:, 1:] -= factors[:, None] * part[0, 1:]
                table[rows[:, None], columns] = part
                filled[rows[:, None], columns] = True
        for k in range(size - 1, -1, -1):
            known = np.zeros(found.shape[1:])
            for j in k + 1 + np.flatnonzero(filled[k, k + 1 : size]):
                known += table[k, j] * found[j]
            found[k] = (table[k, size:] - known) / table[k, k]
    found[:, :, ~np.isfinite(found).all(axis=(0, 1))] = math.nan
    return np.ascontiguousarray(np.moveaxis(found, -1, 0)).reshape(right.shape)


def _solve_one(matrix: Floats, right: Floats) -> Floats:
    """The solution of one system (k, k) x = right, (k, m), likewise."""
    size = len(matrix)
    table = np.concatenate([matrix, right], axis=1)
    found = np.full(right.shape, math.nan)
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        for k in range(size):
            best = k + int(np.argmax(np.abs(table[k:, k])))
            if best != k:
                table[[k, best]] = table[[best, k]]
            rows = k + 1 + np.flatnonzero(table[k + 1 :, k])
            if rows.size:
                table[rows, k:] -= (table[rows, k] / table[k, k])[:, None] * table[k, k:]
        for k in range(size - 1, -1, -1):
            found[k] = table[k, size:] / table[k, k]
            table[:k, size:] -= table[:k, k : k + 1] * found[k]
    return found if np.isfinite(found).all() else np.full(right.shape, math.nan)


def distinct(*several: ArrayLike) -> NDArray[Any]:
    """The numbers of several arrays, growing, each once, (n,); np.unique would load masked arrays, which nothing here is."""
    x = np.sort(np.concatenate(several))
    new = np.ones(len(x), bool)
    new[1:] = x[1:] != x[:-1]
    return x[new]


def among(values: NDArray[Any], known: NDArray[Any]) -> NDArray[np.bool_]:
    """Which values are among the known ones, which grow, each of them once or more, (n,)."""
    return np.asarray(known[np.minimum(np.searchsorted(known, values), len(known) - 1)] == values)


def least_squares(table: Floats, right: Floats) -> Floats:
    """The x (k,) for which table (n, k) x comes nearest to right (n,); 0 for a column that depends on those before it.

    Modified Gram-Schmidt on the table with the right side beside it. [Bjoerck, Numerical Methods for Least Squares, 2.4]
    """
    columns = [*np.array(table, float).T, np.array(right, float)]
    size = len(columns) - 1
    triangle = np.zeros((size, size))
    shares = np.zeros(size)
    for k in range(size):
        square = float(np.sum(columns[k] ** 2))
        if math.sqrt(square) <= _DEPENDENT * math.sqrt(float(np.sum(table[:, k] ** 2))):
            continue
        triangle[k, k] = 1.0
        for j in range(k + 1, size + 1):
            share = float(np.sum(columns[k] * columns[j])) / square
            columns[j] = columns[j] - share * columns[k]
            if j < size:
                triangle[k, j] = share
            else:
                shares[k] = share
    solution = np.zeros(size)
    for k in range(size - 1, -1, -1):
        if triangle[k, k]:
            solution[k] = shares[k] - sum(
                float(triangle[k, j] * solution[j]) for j in range(k + 1, size)
            )
    return solution


def gauss_legendre(n: int) -> tuple[Floats, Floats]:
    """Nodes and weights (n,) of Gauss and Legendre on -1..1, growing; Newton on the polynomial from its known estimates."""
    x = np.array([-math.cos(math.pi * (k + 0.75) / (n + 0.5)) for k in range(n)])
    for _ in range(100):
        before = np.ones(n)
        here = x
        for k in range(2, n + 1):
            before, here = here, ((2 * k - 1) * x * here - (k - 1) * before) / k
        slope = n * (before - x * here) / (1 - x * x)
        step = here / slope
        x = x - step
        if np.max(np.abs(step)) < 1e-15:
            break
    x = (x - x[::-1]) / 2
    weights = 2 / ((1 - x * x) * slope * slope)
    return x, (weights + weights[::-1]) / 2


# ---- one unknown -----------------------------------------------------------------------------------------------------


def roots(
    f: Callable[[Floats, Indices], tuple[Floats, Floats]],
    low: Floats,
    high: Floats,
    share: float = 0.0,
) -> Floats:
    """Where functions change sign, each between its low and high, (n,); Newton's method kept inside the bracket by bisection.

    f(t, i): values and slopes of the functions number i, (m,), at t, (m,); a slope of 0 or nan means unknown.
    share: of the bracket, at which a step is small enough; 0 asks for all that the numbers hold.
    """
    low = np.array(low, float)
    high = np.array(high, float)
    t = (low + high) / 2
    last = np.maximum(share * (high - low), _RESOLVED * np.maximum(np.abs(low), np.abs(high)))
    i = np.arange(t.size)
    if not i.size:
        return t
    above = f(high, i)[0]
    rising = np.where(above == 0, f(low, i)[0] < 0, above > 0) if np.any(above == 0) else above > 0
    for _ in range(_STEPS):
        value, slope = f(t[i], i)
        beyond = (value > 0) == rising[i]
        high[i[beyond]] = t[i[beyond]]
        low[i[~beyond]] = t[i[~beyond]]
        with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
            new = t[i] - value / slope
        new = np.where((low[i] <= new) & (new <= high[i]), new, (low[i] + high[i]) / 2)
        step = np.abs(new - t[i])
        t[i] = new
        i = i[step > last[i]]
        if not i.size:
            break
    return t


def sign_changes(
    f: Callable[[Floats], Floats], grid: Floats, slope: Callable[[Floats], Floats] | None = None
) -> Floats:
    """Places between those of a growing grid, (n,), at which f changes sign, (k,); one between two of them, none beside nan.

    f, slope: values and derivatives, (m,), at (m,) places; without a slope by bisection.
    """
    value = f(grid)
    found = np.flatnonzero(
        np.isfinite(value[:-1] + value[1:]) & (np.signbit(value[:-1]) != np.signbit(value[1:]))
    )

    def both(t: Floats, _: Indices) -> tuple[Floats, Floats]:
        return f(t), np.zeros(t.size) if slope is None else slope(t)

    return roots(both, grid[found], grid[found + 1])


def halved(fits: Callable[[float], bool], low: float, high: float, steps: int = _STEPS) -> float:
    """The least that fits, between what does not and what does, by bisection."""
    for _ in range(steps):
        middle = (low + high) / 2
        low, high = (low, middle) if fits(middle) else (middle, high)
    return high


def crests(f: Callable[[Floats], Floats], low: Floats, high: Floats, steps: int = _STEPS) -> Floats:
    """Where functions are greatest, each between its low and high, (n,), with one crest there; golden section.

    f(t): the n values at the n places t.
    """
    for _ in range(steps if low.size else 0):
        left = high - _GOLDEN * (high - low)
        right = low + _GOLDEN * (high - low)
        rising = f(left) < f(right)
        low = np.where(rising, left, low)
        high = np.where(rising, high, right)
    return np.asarray((low + high) / 2)


def greatest(
    f: Callable[[Any], Floats],
    a: float,
    b: float,
    also: Sequence[float] | Floats = (),
    count: int = 1025,
) -> tuple[float, float]:
    """Place and value of the greatest f(x) on a..b: even samples, then zoomed in on the best until no more is gained.

    also: further places to try, where f has a corner.
    """
    x = distinct(np.linspace(a, b, count), also)
    best = -math.inf
    for _ in range(40):
        y = f(x)
        k = int(np.nanargmax(y))
        if np.isinf(y[k]):  # of which no more is gained
            break
        low = x[max(k - 1, 0)]
        high = x[min(k + 1, len(x) - 1)]
        # round a smooth crest f is flat to rounding long before the interval is
        gain = 0.0 if y[k] == best else y[k] - best  # of values that are all infinite too
        flat = high - low <= 1e-7 * max(1.0, abs(b)) and gain <= 1e-15 * abs(best)
        if flat or high - low <= 1e-14 * max(1.0, abs(b)):
            break
        best = y[k]
        place = x[k]
        x = np.linspace(low, high, 17)
        x[np.argmin(np.abs(x - place))] = (
            place  # not beside it: a neighbour that is the same place would halve the bracket
        )
    return float(x[k]), float(y[k])


def low_passed(values: Floats, order: int, harmonics: int) -> Floats:
    """Derivative of a periodic function over one turn, (n,) even samples, per rad, with few of the harmonics above the given.

    Harmonic n counts by 1 / (1 + (n / harmonics)^4), in phase. nan throughout where a value is nan.
    """
    spectrum = np.fft.rfft(values)
    n = np.arange(len(spectrum))
    weight = 1 / (1 + (n / harmonics) ** STEEPNESS)
    return np.asarray(np.fft.irfft(spectrum * (1j * n) ** order * weight, len(values)))
