"""Prints vertices and arcs of the uniform-swing cam against the theory, and what they cost.

Run: python tests/bench/bench_outline.py
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path

import numpy as np

sys.path[:0] = [str(Path(__file__).parents[1] / "geometry"), str(Path(__file__).parents[2])]

from test_facets import blunt_pieces, knife_cam, largest_distance  # noqa: E402

from camgen.geometry.arcs import _fit_smooth, theoretical_arcs  # noqa: E402
from camgen.geometry.facets import facet, theoretical_vertices  # noqa: E402
from camgen.geometry.outlines import Contour, Line, Smooth, end_point, start_point  # noqa: E402


def milliseconds(work: Callable[[], object], repeats: int = 5) -> float:
    """Median of the runs."""
    times = []
    for _ in range(repeats):
        start = time.perf_counter()
        work()
        times.append(time.perf_counter() - start)
    return 1e3 * float(np.median(times))


def each(
    work: Callable[[Smooth, float], object], pieces: tuple[Smooth, ...], tolerance: float
) -> None:
    """The work on every piece."""
    for piece in pieces:
        work(piece, tolerance)


def uniform(piece: Smooth, tolerance: float) -> int:
    """Least number of equal angles on this piece within the tolerance, by bisection."""
    lo, hi = 0, 1
    while largest_distance(piece, np.linspace(piece.t0, piece.t1, hi + 1), 9) > tolerance:
        lo, hi = hi, 2 * hi
    while hi - lo > 1:
        middle = (lo + hi) // 2
        inside = (
            largest_distance(piece, np.linspace(piece.t0, piece.t1, middle + 1), 9) <= tolerance
        )
        lo, hi = (lo, middle) if inside else (middle, hi)
    return hi


def main() -> None:
    """One table a cam; smooth pieces only, as in the published figures."""
    for name, pieces in (("knife edge", knife_cam().pieces), ("tip 3", blunt_pieces())):
        print(f"\n{name}: L = 60, H = 30, swing 30 deg, {len(pieces)} smooth pieces")
        print(
            "tolerance | vertices: theory reached ratio  equal angles       ms | arcs: theory reached ratio      ms"
        )
        for tolerance in 10.0 ** -np.arange(1, 8):
            least = sum(theoretical_vertices(_alone(p), tolerance) for p in pieces)
            fewest = sum(
                theoretical_arcs(_alone(p), tolerance) - 1 for p in pieces
            )  # less the line
            facets = sum(facet(p, tolerance).size - 1 for p in pieces)
            arcs = sum(len(_fit_smooth(p, tolerance)) for p in pieces)
            plain = sum(uniform(p, tolerance) for p in pieces) if tolerance > 5e-7 else 0
            cost = milliseconds(partial(each, facet, pieces, tolerance))
            cost_arcs = milliseconds(partial(each, _fit_smooth, pieces, tolerance))
            print(
                f"{tolerance:9.0e} | {least:16.1f} {facets:7d} {facets / least:.4f} {plain or '-':>12} {cost:8.1f} "
                f"| {fewest:12.1f} {arcs:7d} {arcs / fewest:.3f} {cost_arcs:7.1f}"
            )


def _alone(piece: Smooth) -> Contour:
    """The piece, closed by a straight line."""
    return Contour((piece, Line(end_point(piece), start_point(piece))))


if __name__ == "__main__":
    main()
