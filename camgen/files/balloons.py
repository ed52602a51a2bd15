"""Numbers of parts in circles round a view, each with a line to its part that ends in a dot. [ISO 6433]

Sites on free paper round the view are dealt out so that no two parts would have shorter lines with their sites exchanged: then no line
crosses another. A line that would go through another balloon or along letters is asked again elsewhere. Lengths are mm of paper.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from camgen.files.labels import Obstacles
from camgen.files.sheet import Sheet
from camgen.numerics import Floats, coordinates

RADIUS = 4.0
BESIDE = 7.0  # from a view to the middles of the nearest balloons
_APART = 9.0  # from one balloon to the next
_AIR = 1.0  # round a balloon
_ROWS = 3  # of sites beyond a view, each between those of the row before
_INSIDE = (2.0, 1.0, 0.5)  # how far in a part its dot is, the first for which it is broad enough
_FINE = 0.05  # by which the edge of where it may be is straightened
_DETOUR = 25.0  # what a line is counted longer for what it runs into
_AGAIN = 5.0  # and what it is each time that it clashes with another one
_LESS = 1e-6  # by which an exchange of sites is shorter
_TRIES = 200  # to deal sites out


def balloons(
    sheet: Sheet, parts: Mapping[int, Any], view: Any, area: tuple[complex, complex]
) -> None:
    """Draw the number of each part of a view; parts: what is seen of each, polygons; view: all of it; area: corners of the paper that
    is free for them. Where sites are fewer than parts, the farthest parts have none.
    """
    import shapely

    obstacles = Obstacles(area)
    obstacles.add(sheet.primitives)
    sites = _sites(view, obstacles)
    if not (parts and sites.size):
        return
    points = shapely.points(coordinates(sites))
    faces = np.array([_inner(part) for part in parts.values()])
    lines = shapely.shortest_line(points[None, :], faces[:, None])
    bad = ~obstacles.free(lines.ravel()).reshape(lines.shape)
    numbers = list(parts)
    for row, column in _dealt(lines, points, shapely.length(lines) + _DETOUR * bad):
        start = complex(sites[column])
        end = complex(*shapely.get_coordinates(lines[row, column])[1])
        way = (end - start) / abs(end - start)
        sheet.arc(start, RADIUS, 0.0, 2 * np.pi, "TEXT")
        sheet.text(start - 1.25j, str(numbers[row]), 2.5, "centre")
        sheet.line(start + RADIUS * way, end, layer="DIM")
        sheet.arc(end, 0.5, 0.0, 2 * np.pi, "DIM")


def _dealt(lines: Any, middles: Any, costs: Floats) -> list[tuple[int, int]]:
    """Which part has which site; lines: from each site to each part, and what they cost, (parts, sites)."""
    rows = np.argsort(costs.min(axis=1), kind="stable")[: costs.shape[1]]
    costs = costs[rows]
    columns = np.zeros(len(rows), int)
    taken = np.zeros(costs.shape[1])
    for k, cost in enumerate(costs):
        columns[k] = np.argmin(cost + taken)
        taken[columns[k]] = math.inf
    best = math.inf
    for _ in range(_TRIES):
        _exchange(costs, columns)
        clashes = _clashes(lines[rows, columns], middles[columns])
        if clashes.sum() < best:
            best = clashes.sum()
            dealt = sorted(zip(rows.tolist(), columns.tolist(), strict=True))
        if not best:
            break
        costs[clashes, columns[clashes]] += _AGAIN
    return dealt


def _exchange(costs: Floats, columns: Any) -> None:
    """Have parts exchange their sites, or take free ones, while that is cheaper; columns: the site of each part, changed in place."""
    rows = np.arange(len(columns))
    while True:
        own = costs[rows, columns]
        free = costs.copy()
        free[:, columns] = math.inf
        moves = own[:, None] - free
        others = costs[:, columns]
        swaps = own[:, None] + own - others - others.T
        k, site = np.unravel_index(np.argmax(moves), moves.shape)
        a, b = np.unravel_index(np.argmax(swaps), swaps.shape)
        if max(moves[k, site], swaps[a, b]) < _LESS:
            return
        if moves[k, site] >= swaps[a, b]:
            columns[k] = site
        else:
            columns[[a, b]] = columns[[b, a]]


def _sites(view: Any, obstacles: Obstacles) -> Any:
    """Middles of balloons that may stand round a view, in rows and columns, (n,) complex."""
    import shapely

    x0, y0, x1, y1 = view.bounds
    across, up = _places(x0, x1), _places(y0, y1)
    rows = [(across[:, None] + 1j * up).ravel()]
    for k in range(1, _ROWS):
        out = _APART * k
        x, y = (np.append(each, each[-1] + _APART) - (k % 2) * _APART / 2 for each in (across, up))
        rows += [x + 1j * (up[0] - out), x + 1j * (up[-1] + out)]
        rows += [across[0] - out + 1j * y, across[-1] + out + 1j * y]
    sites = np.concatenate(rows)
    discs = shapely.buffer(shapely.points(coordinates(sites)), RADIUS + _AIR)
    free = obstacles.within(discs) & obstacles.free(discs) & obstacles.unlined(discs)
    free &= obstacles.off_axes(discs) & ~shapely.intersects(discs, view)
    return sites[free]


def _places(low: float, high: float) -> Floats:
    """Of rows of sites beside a view."""
    count = max(int((high - low + 2 * BESIDE) / _APART), 1)
    return np.linspace(low - BESIDE, high + BESIDE, count + 1)


def _inner(part: Any) -> Any:
    """Where in a part its dot may be: not at its edge where it is broad enough."""
    import shapely

    for deep in _INSIDE:
        inner = shapely.buffer(part, -deep)
        if not inner.is_empty:
            return shapely.simplify(inner, _FINE)
    return part.representative_point()


def _clashes(lines: Any, middles: Any) -> Any:
    """Which lines cross another one or run through the balloon of another one, (n,)."""
    import shapely

    count = len(lines)
    others = ~np.eye(count, dtype=bool)
    through = shapely.distance(lines[:, None], middles[None, :]) < RADIUS + _AIR / 4
    crossed = shapely.intersects(lines[:, None], lines[None, :])
    longer = shapely.length(lines)[:, None] >= shapely.length(lines)[None, :]
    return ((through | (crossed & longer)) & others).any(axis=1)
