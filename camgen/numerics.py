"""Linear algebra and quadrature in plain array arithmetic, which gives the same bits on every processor.

numpy's own (`@`, `np.linalg`) calls a BLAS library that picks its order of adding by the processor, so the last digits of
what is written would differ from machine to machine. Systems here are small, and many at once.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

_DEPENDENT = 1e-13  # of a column's length, below which what is left beside the other columns is rounding


def product(a: Floats, b: Floats) -> Floats:
    """The matrix product a b, (n, k) times (k, m) -> (n, m)."""
    total = a[:, :1] * b[:1]
    for k in range(1, a.shape[1]):
        total = total + a[:, k : k + 1] * b[k : k + 1]
    return np.asarray(total)


def solve(matrices: Floats, right: Floats) -> Floats:
    """Solutions of n systems (n, k, k) x = right, (n, k), or (n, k, m) for m of them; nan for a singular one.

    Gauss, partial pivoting.
    What is zero in all systems is left out: joints tie few bodies to each other, and machines
    on one shaft none.
    """
    n, size = right.shape[:2]
    several = right.reshape(n, size, -1)
    table = np.empty((size, size + several.shape[2], n))  # row, column, system
    table[:, :size], table[:, size:] = np.moveaxis(matrices, 0, -1), np.moveaxis(several, 0, -1)
    filled = (table != 0).any(axis=2)
    found = np.full((size, several.shape[2], n), math.nan)
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        for k in range(size):
            rows = k + np.flatnonzero(filled[k:, k])
            if not rows.size:
                return np.moveaxis(found, -1, 0).reshape(right.shape)
            if rows[0] != k:
                table[[k, rows[0]]], filled[[k, rows[0]]] = table[[rows[0], k]], filled[[rows[0], k]]
                rows[0] = k
            if rows.size > 1:
                columns = k + np.flatnonzero(filled[rows, k:].any(axis=0))
                part = table[rows[:, None], columns]
                pivot = np.argmax(np.abs(part[:, 0]), axis=0)
                swapped = np.flatnonzero(pivot)
                best = part[pivot[swapped], :, swapped]
                part[pivot[swapped], :, swapped] = part[0, :, swapped]
                part[0, :, swapped] = best
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


def least_squares(table: Floats, right: Floats) -> Floats:
    """The x (k,) for which table (n, k) x comes nearest to right (n,); 0 for a column that depends on those before it.

    Modified Gram-Schmidt on the table with the right side beside it. [Bjoerck, Numerical Methods for Least Squares, 2.4]
    """
    columns = [*np.array(table, float).T, np.array(right, float)]
    size = len(columns) - 1
    triangle, shares = np.zeros((size, size)), np.zeros(size)
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
    found = np.zeros(size)
    for k in range(size - 1, -1, -1):
        if triangle[k, k]:
            found[k] = shares[k] - sum(float(triangle[k, j] * found[j]) for j in range(k + 1, size))
    return found


def gauss_legendre(n: int) -> tuple[Floats, Floats]:
    """Nodes and weights (n,) of Gauss and Legendre on -1..1, growing; Newton on the polynomial from its known estimates."""
    x = np.array([-math.cos(math.pi * (k + 0.75) / (n + 0.5)) for k in range(n)])
    for _ in range(100):
        before, here = np.ones(n), x
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
