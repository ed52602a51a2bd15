"""Rigid links from a drawing: what is dimensioned is exact, the rest keeps its drawn distances.

A link's axes have their origin at its first point and x towards its second; of a link with one point they are the ground's.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from functools import lru_cache
from itertools import combinations

import numpy as np

from camgen.numerics import Floats, Points, peak

STEPS = 200  # of the search for a shape; three or four suffice unless the points lie on one line
CLOSED = 1e-13  # of its size: lengths that are met
FLAT = 1e-3  # height of a triangle by its size, below which it is sought as any other shape is


def shape(drawn: Points, lengths: Mapping[tuple[int, int], float]) -> tuple[Points, float]:
    """The points of a link with the given lengths between pairs of them, and by how much they miss at worst, mm.

    drawn: (n,) complex mm. Distances without a length stay as drawn, or as near as may be where there are more of them
    than a rigid body has freedoms (least squares). The first point stays, and so does the direction to the second.
    """
    points, missed = _shape(tuple(drawn.tolist()), tuple(lengths.items()))
    return np.array(points, complex), missed


@lru_cache(maxsize=256)  # of variants most links are the same
def _shape(
    drawn: tuple[complex, ...], lengths: tuple[tuple[tuple[int, int], float], ...]
) -> tuple[tuple[complex, ...], float]:
    """The same of what can be kept."""
    triangle = _triangle(drawn, dict(lengths)) if lengths else None
    if triangle is not None:
        return triangle, 0.0
    found, missed = _nearest(np.array(drawn, complex), dict(lengths))
    return tuple(found.tolist()), missed


def _triangle(
    drawn: Sequence[complex], lengths: Mapping[tuple[int, int], float]
) -> tuple[complex, ...] | None:
    """Two or three points by their distances; None of more, and of those that lie on one line or cannot be."""
    if len(drawn) not in (2, 3) or drawn[0] == drawn[1]:
        return None
    if all(
        abs(abs(drawn[b] - drawn[a]) - length) <= CLOSED * length
        for (a, b), length in lengths.items()
    ):
        return tuple(drawn)  # as they are
    along = (drawn[1] - drawn[0]) / abs(drawn[1] - drawn[0])
    base = lengths.get((0, 1), abs(drawn[1] - drawn[0]))
    ends = drawn[0], drawn[0] + along * base
    if len(drawn) == 2:
        return ends
    near = lengths.get((0, 2), abs(drawn[2] - drawn[0]))
    far = lengths.get((1, 2), abs(drawn[2] - drawn[1]))
    across = ((drawn[2] - drawn[0]) * along.conjugate()).imag
    x = ((near - far) * (near + far) + base**2) / (2 * base)
    square = (near - x) * (near + x)
    if not square > (FLAT * max(base, near, far)) ** 2 or abs(across) <= FLAT * near:
        return None
    return *ends, drawn[0] + along * complex(x, math.copysign(math.sqrt(square), across))


def _nearest(drawn: Points, lengths: Mapping[tuple[int, int], float]) -> tuple[Points, float]:
    """The points by Newton's method; see `shape`."""
    pairs = list(combinations(range(len(drawn)), 2))
    fixed = [k for k, each in enumerate(pairs) if each in lengths]
    free = [k for k, each in enumerate(pairs) if each not in lengths]
    wanted = np.array([lengths.get(each, abs(drawn[each[1]] - drawn[each[0]])) for each in pairs])
    z = drawn.astype(complex)
    size = float(wanted.max(initial=1e-300))
    best = z
    missed = np.inf
    for _ in range(STEPS if fixed else 0):
        off, slope = _distances(z, pairs)
        off = off - wanted
        worst = peak(off[fixed])
        if worst < missed:
            best = z
            missed = worst
        step = -np.linalg.pinv(slope[fixed], rcond=1e-9) @ off[fixed]
        if free:  # along what leaves the given lengths alone
            _, values, ways = np.linalg.svd(slope[fixed])
            rank = int(np.count_nonzero(values > 1e-9 * values.max(initial=1e-300)))
            way = ways[rank:].T
            rest = off[free] + slope[free] @ step
            step = step - way @ (np.linalg.pinv(slope[free] @ way, rcond=1e-9) @ rest)
        longest = peak(step)
        if worst <= CLOSED * size and longest <= 1e-9 * size:
            break
        z = z + (step[0::2] + 1j * step[1::2]) * min(1.0, 0.5 * size / max(longest, 1e-300))
    if not fixed:
        missed = 0.0
    if len(drawn) > 1 and best[1] != best[0]:
        turn = (drawn[1] - drawn[0]) / (best[1] - best[0])
        best = drawn[0] + (best - best[0]) * turn / abs(turn)
    return best, missed


def _distances(z: Points, pairs: Sequence[tuple[int, int]]) -> tuple[Floats, Floats]:
    """Distances of pairs of points, (m,), and their slopes to all coordinates x0, y0, x1, ..., (m, 2 n)."""
    off = np.zeros(len(pairs))
    slope = np.zeros((len(pairs), 2 * len(z)))
    for k, (a, b) in enumerate(pairs):
        way = z[b] - z[a]
        off[k] = abs(way)
        unit = way / off[k] if off[k] else 1.0 + 0j
        slope[k, 2 * a : 2 * a + 2] = -unit.real, -unit.imag
        slope[k, 2 * b : 2 * b + 2] = unit.real, unit.imag
    return off, slope


def too_long(
    points: Sequence[str], drawn: Points, lengths: Mapping[tuple[int, int], float]
) -> tuple[tuple[int, int], str, str] | None:
    """The worst of three points whose longest side is longer than the others together: that side, and in words what it is and
    what it should be; None where all can be."""
    worst = 0.0
    found = None
    for three in combinations(range(len(points)), 3):
        sides = {
            pair: lengths.get(pair, abs(drawn[pair[1]] - drawn[pair[0]]))
            for pair in combinations(three, 2)
        }
        long = max(sides, key=lambda pair: sides[pair])
        over = 2 * sides[long] - sum(sides.values())
        if over > worst:
            names = {pair: "-".join(points[k] for k in pair) for pair in sides}
            short = " and ".join(
                f"{names[pair]} ({'' if pair in lengths else 'drawn '}{side:.6g})"
                for pair, side in sides.items()
                if pair != long
            )
            right = f"less than {short} together: it is {over:.4g} mm too long; change a length or redraw a point"
            worst = over
            found = (long, f"{names[long]} = {sides[long]:.6g}", right)
    return found
