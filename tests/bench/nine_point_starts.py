"""Make the solutions that searches for nine points begin from: `python tests/bench/nine_point_starts.py FILE`, a minute or two.

One complex four-bar with points of its own is drawn at random. Its solution goes round random triangles of points and comes back as
another one (monodromy), until all 1,442 are known. Then all go to points of even sizes, rounded to single precision, where they
are kept in single precision: Newton's steps make them exact again. camgen's own file was made with other random numbers.
"""

from __future__ import annotations

import sys
from typing import Any

import numpy as np

from camgen.design.nine_points import doubles, followed, newton

COUNT = 1442
LEAST = (
    1e-9  # of its size: with a smaller unknown a solution is a sham: the coupler point is a joint
)
LOOPS = 60
Array = np.ndarray[Any, Any]


def even(rng: np.random.Generator, *shape: int) -> Array:
    return np.asarray(rng.normal(size=(*shape, 2)) @ np.array([1, 1j]) * np.sqrt(0.5))


def first(rng: np.random.Generator) -> tuple[Array, Array]:
    """d and conj(d), (2, 8), and a solution, (1, 8): both dyads' equations are solved for d and conj(d), for eight turns."""
    z = even(rng, 8)
    places = []
    while len(places) < 8:
        turn = np.exp(1j * even(rng))
        d, e = even(rng, 2)
        for _ in range(60):
            value, slope = [], []
            for x, u, a, v in (z[:4], z[4:]):
                g, h = turn - 1, 1 / turn - 1
                value.append((v - e) * x * g + (a - d) * u * h + (v - u) * d + (a - x) * e - d * e)
                slope.append([v - u - e - u * h, a - x - d - x * g])
            step = np.linalg.solve(np.array(slope), np.array(value))
            d, e = np.array([d, e]) - step
        if np.max(np.abs(step)) < 1e-12 and abs(d) + abs(e) > 1e-3:
            places.append((d, e))
    return np.array(places).T, z[None]


def main(file: str, seed: int = 1) -> None:
    rng = np.random.default_rng(seed)
    at, known = first(rng)
    for loop in range(1, LOOPS + 1):
        corners = [at, even(rng, 2, 8), even(rng, 2, 8), at]
        z = known
        for begin, end in zip(corners, corners[1:], strict=False):
            z, arrived = followed(z, begin, end)
            z = z[arrived]
        z = z[np.min(np.abs(z), axis=1) > LEAST * np.max(np.abs(z), axis=1)]
        known = np.concatenate([known, newton(z, at)])
        known = known[~doubles(known)]
        print(f"loop {loop}: {len(known)} solutions", flush=True)
        if len(known) >= COUNT:
            break
    while True:
        end = even(rng, 2, 8).astype(np.complex64)
        z, arrived = followed(known, at, end.astype(complex), 3e-4)
        if arrived.all() and not doubles(z).any():
            np.save(file, np.concatenate([end, z.astype(np.complex64)]))
            return


if __name__ == "__main__":
    main(sys.argv[1])
