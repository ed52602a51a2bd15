"""Lines and arcs that follow one another, end on end within CHAIN_GAP, joined to closed rings."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from camgen.geometry.rings import Floats, Points, Ring
from camgen.numerics import coordinates, spread
from camgen.tolerances import CHAIN_GAP, SAME_POINT


@dataclass(frozen=True)
class Chain:
    """Edges from points[i] to points[i + 1]."""

    points: Points  # (n + 1,) complex mm
    bulges: Floats  # (n,) tan(sweep / 4)
    closed: bool = False  # whether the last point is the first again

    def reversed(self) -> Chain:
        """The same edges, run the other way."""
        return Chain(self.points[::-1], -self.bulges[::-1], self.closed)

    @property
    def size(self) -> float:
        """Across its box, mm, arcs by the middle of each."""
        a = self.points[:-1]
        b = self.points[1:]
        z = np.concatenate([self.points, (a + b) / 2 - 0.5j * self.bulges * (b - a)])
        return spread(z)

    @property
    def straight(self) -> bool:
        """Whether it is one straight edge."""
        return len(self.bulges) == 1 and not self.bulges.any()


def joined(chains: Sequence[Chain]) -> tuple[list[Ring], list[Chain]]:
    """Rings of chains that close, alone or end on end, and what stays open.

    Ends within CHAIN_GAP are one. Where more than two meet, the contour branches and stays open.
    """
    from scipy.spatial import cKDTree

    rings = [ring for chain in chains if chain.closed and (ring := _ring([chain])) is not None]
    pieces = [chain for chain in chains if not chain.closed and chain.size > SAME_POINT]
    if not pieces:
        return rings, []
    ends = np.array([z for chain in pieces for z in (chain.points[0], chain.points[-1])])
    places = coordinates(ends)
    apart, near = cKDTree(places).query(places, 3, distance_upper_bound=np.nextafter(CHAIN_GAP, 1))
    meets_one = np.isfinite(apart).sum(axis=1) == 2  # each end and one other
    number = np.arange(len(ends))
    other = np.where(meets_one, np.where(near[:, 0] == number, near[:, 1], near[:, 0]), 0)
    partner = np.where(meets_one & meets_one[other], other, -1).tolist()
    visited = [False] * len(pieces)
    loose = []
    # runs that begin at a free end first; what is left goes round
    for start in [k for k in range(len(ends)) if partner[k] < 0] + list(range(0, len(ends), 2)):
        if visited[start // 2]:
            continue
        members = []
        end = start
        while end >= 0 and not visited[end // 2]:
            visited[end // 2] = True
            members.append(pieces[end // 2] if end % 2 == 0 else pieces[end // 2].reversed())
            end = partner[end ^ 1]
        ring = _ring(members) if end >= 0 else None
        if ring is not None:
            rings.append(ring)
        else:
            loose.append(
                Chain(
                    np.concatenate([*(c.points[:-1] for c in members), members[-1].points[-1:]]),
                    np.concatenate([c.bulges for c in members]),
                )
            )
    return rings, loose


def _ring(chains: Sequence[Chain]) -> Ring | None:
    """Ring of chains end on end, less edges of no length; None where it bounds nothing."""
    points = np.concatenate([chain.points[:-1] for chain in chains])
    bulges = np.concatenate([chain.bulges for chain in chains])
    long = np.abs(np.roll(points, -1) - points) > SAME_POINT
    points = points[long]
    bulges = bulges[long]
    if len(points) < 2 or (len(points) == 2 and not bulges.any()):
        return None
    return Ring(points, bulges)


def nearest_gap(loose: Sequence[Chain]) -> str:
    """A sentence on the nearest free ends of open contours; "" where there is none."""
    if not loose:
        return ""
    ends = np.array([z for chain in loose for z in (chain.points[0], chain.points[-1])])
    from scipy.spatial import cKDTree

    rows = coordinates(ends)
    apart, near = cKDTree(rows).query(rows, 2)
    a = int(np.argmin(apart[:, 1]))
    b = int(near[a, 0] if near[a, 0] != a else near[a, 1])
    gap = float(abs(ends[a] - ends[b]))
    places = " and ".join(f"({z.real:.4f}, {z.imag:.4f})" for z in (ends[a], ends[b]))
    if gap <= CHAIN_GAP:
        return f"the contour branches or is drawn twice: more than two ends meet at {places}"
    return f"the contour is open: the nearest free ends, {places}, are {gap:.4g} mm apart"
