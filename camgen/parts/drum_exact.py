"""A drum as an exact solid: planes and cylinders, and walls as cubic splines within FIT.

From below upwards its outline is circles and the edges of its walls. Neighbours are joined by a wall or by a cylinder. All are
cut at the same angles of the roller: where the law of motion breaks, and so that no piece spans more than a third of a turn.

    curve   a circle, or the edge of a wall at the floor or at the outside, as one edge for each piece
    seam    what joins two curves where a piece begins
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np

from camgen.errors import DesignError
from camgen.geometry.arcs import bulges, fit_arcs
from camgen.geometry.brep import Brep, Edge, Face, Loop, Step
from camgen.geometry.drum_walls import DrumWall
from camgen.geometry.drums import Drum
from camgen.geometry.outlines import Contour
from camgen.geometry.splines import Patch, Spline, patch, through
from camgen.numerics import Floats

FIT = 1e-6  # mm, by which a spline may be off its wall
# points of a patch, along and across
_SIZES = ((24, 6), (48, 8), (72, 10), (96, 12), (120, 14), (160, 16), (240, 20))
_WIDEST = math.tau / 3  # rad, of a piece
_LEAST = 1e-6  # rad, of one
_SEAM = 12  # points of one on a cylinder
_ROUNDS = 40
_CLOSE = 1e-13  # of a radius
_STEP = 1e-6  # of it, over which slopes are taken


@dataclass(frozen=True)
class _Curve:
    """Edges round the turn, counter-clockwise, and the corner at which each begins; radius of the cylinder on which it lies."""

    radius: float
    corners: Sequence[int]
    edges: Sequence[int]


@dataclass(frozen=True)
class _Wall:
    """Its patches from the floor to the outside, both its edges, and the seams from one to the other."""

    patches: Sequence[Patch]
    floor: _Curve
    outside: _Curve
    seams: Sequence[int]


@dataclass
class _Body:
    """Corners, edges and faces as they come."""

    corners: list[Floats] = field(default_factory=list)
    edges: list[Edge] = field(default_factory=list)
    faces: list[Face] = field(default_factory=list)

    def corner(self, place: Sequence[float] | Floats) -> int:
        """A new corner's number."""
        self.corners.append(np.array(place, float) + 0.0)
        return len(self.corners) - 1

    def edge(self, edge: Edge) -> int:
        """A new edge's number."""
        self.edges.append(edge)
        return len(self.edges) - 1

    def curve(self, radius: float, splines: Sequence[Spline]) -> _Curve:
        """A wall's edge."""
        corners = [self.corner(spline.poles[0]) for spline in splines]
        ends = np.roll(corners, -1).tolist()
        edges = [
            self.edge(Edge(a, b, spline=spline))
            for a, b, spline in zip(corners, ends, splines, strict=True)
        ]
        return _Curve(radius, corners, edges)

    def circle(self, over: _Curve, height: float) -> _Curve:
        """A circle with its corners over or under those of a curve."""
        corners = [self.corner([*self.corners[k][:2], height]) for k in over.corners]
        ends = np.roll(corners, -1).tolist()
        edges = [self.edge(Edge(a, b, 0j, over.radius)) for a, b in zip(corners, ends, strict=True)]
        return _Curve(over.radius, corners, edges)

    def wall(self, drum: Drum, wall: DrumWall, cuts: Floats) -> _Wall:
        """A wall's patches and their edges."""
        patches = [_fitted(drum, wall, a, b) for a, b in pairwise(cuts)]
        sides = [each.sides for each in patches]
        floor = self.curve(drum.floor, [each[0] for each in sides])
        outside = self.curve(drum.outside, [each[2] for each in sides])
        seams = [
            self.edge(Edge(a, b, spline=each[3]))
            for a, b, each in zip(floor.corners, outside.corners, sides, strict=True)
        ]
        return _Wall(patches, floor, outside, seams)

    def join(
        self,
        lower: _Curve,
        upper: _Curve,
        seams: Sequence[Step],
        patches: Sequence[Patch],
        looks: int = 1,
    ) -> None:
        """The faces between two curves; without patches they lie on their cylinder, from which they look outwards or, looks -1, to
        its axis."""
        count = len(lower.edges)
        for k in range(count):
            edge, forward = seams[k]
            loop = (
                (lower.edges[k], True),
                seams[(k + 1) % count],
                (upper.edges[k], False),
                (edge, not forward),
            )
            round_face = Face(0, (loop,), looks * lower.radius)
            face = Face(0, (loop,), patch=patches[k]) if patches else round_face
            self.faces.append(face)

    def between(self, wall: _Wall, outwards: bool) -> None:
        """A wall's faces; outwards: whether it looks down, so that its floor's edge comes first from below."""
        seams = [(edge, outwards) for edge in wall.seams]
        if outwards:
            self.join(wall.floor, wall.outside, seams, wall.patches)
            return
        patches = [each.turned for each in wall.patches]
        self.join(wall.outside, wall.floor, seams, patches)

    def cylinder(self, lower: _Curve, upper: _Curve, looks: int = 1) -> None:
        """What joins two curves of one radius, the material within it, or looks -1: outside."""
        seams = [
            (self.edge(self._upwards(a, b, lower.radius)), True)
            for a, b in zip(lower.corners, upper.corners, strict=True)
        ]
        self.join(lower, upper, seams, (), looks)

    def _upwards(self, a: int, b: int, radius: float) -> Edge:
        """From a corner to one above or below it on a cylinder: straight, or turning evenly."""
        low = self.corners[a]
        high = self.corners[b]
        if np.array_equal(low[:2], high[:2]):
            return Edge(a, b)
        first, last = (math.atan2(place[1], place[0]) for place in (low, high))
        share = np.linspace(0, 1, _SEAM)
        turn = first + share * math.remainder(last - first, math.tau)
        points = np.column_stack(
            [radius * np.cos(turn), radius * np.sin(turn), low[2] + share * (high[2] - low[2])]
        )
        points[[0, -1]] = low, high
        return Edge(a, b, spline=through(share, points))

    def ends(
        self,
        lower: _Curve,
        upper: _Curve,
        holes: Sequence[Contour],
        key: tuple[Contour, float] | None,
        tolerance: float,
    ) -> None:
        """Both level faces, and the holes from one to the other; key: outline of what stands on the upper one, through which the
        holes go on, and its height."""
        down = [tuple((edge, False) for edge in reversed(lower.edges))]
        up = [tuple((edge, True) for edge in upper.edges)]
        low, high = (float(self.corners[curve.corners[0]][2]) for curve in (lower, upper))
        if key is not None:
            outline, top = key
            under, over = self._upright(outline, (high, top), tolerance, clockwise=False)
            up.append(_turned(under))
            self.faces.append(Face(1, tuple(up)))
            up = [over]
            high = top
        for hole in holes:
            under, over = self._upright(hole, (low, high), tolerance)
            up.append(over)
            down.append(_turned(under))
        self.faces += [Face(-1, tuple(down)), Face(1, tuple(up))]

    def _upright(
        self,
        contour: Contour,
        heights: tuple[float, float],
        tolerance: float,
        clockwise: bool = True,
    ) -> tuple[Loop, Loop]:
        """Walls along a contour between two heights, round a hole clockwise; the loops below and above them, as they run."""
        rings = [self._ring(contour, height, tolerance, clockwise) for height in heights]
        (lows, under), (highs, over) = rings
        seams = [self.edge(Edge(a, b)) for a, b in zip(lows, highs, strict=True)]
        for k, (edge, forward) in enumerate(under):
            above, onward = over[k]
            after = seams[(k + 1) % len(seams)]
            loop = ((edge, forward), (after, True), (above, not onward), (seams[k], False))
            self.faces.append(Face(0, (loop,)))
        return tuple(under), tuple(over)

    def _ring(
        self, contour: Contour, height: float, tolerance: float, clockwise: bool
    ) -> tuple[list[int], list[Step]]:
        """Corners and steps of a contour at a height."""
        z, bulge = bulges(fit_arcs(contour.counter_clockwise(), tolerance))
        if clockwise:
            z = z[::-1]
            bulge = -np.roll(bulge[::-1], -1)
        corners = [self.corner([each.real, each.imag, height]) for each in z.tolist()]
        steps = []
        for k, (a, b) in enumerate(zip(corners, np.roll(corners, -1).tolist(), strict=True)):
            if not bulge[k]:
                steps.append((self.edge(Edge(a, b)), True))
                continue
            chord = z[(k + 1) % len(z)] - z[k]
            t = bulge[k]
            centre = complex(z[k] + chord / 2 + 0.5j * chord * (1 - t * t) / (2 * t))
            radius = abs(z[k] - centre)
            forward = bool(t > 0)
            first, last = (a, b) if forward else (b, a)
            steps.append((self.edge(Edge(first, last, centre, float(radius))), forward))
        return corners, steps


def _turned(loop: Loop) -> Loop:
    """A loop, run the other way."""
    return tuple((edge, not forward) for edge, forward in reversed(loop))


def drum_solid(
    drum: Drum,
    holes: Sequence[Contour],
    tolerance: float,
    key: tuple[Contour, float] | None = None,
) -> Brep:
    """The drum with holes along its axis, their outlines as arcs within tolerance, mm; key: outline of what stands on its upper
    end, and its height.

    DesignError as of `Drum.span`, and where no spline of a reasonable size is within FIT of its walls.
    """
    drum.span  # noqa: B018  refuses what is no drum
    body = _Body()
    cuts = _cuts(drum.breaks)
    walls = [body.wall(drum, wall, cuts) for wall in drum.walls]
    first = walls[0].floor if drum.track == "rib" else walls[0].outside
    last = walls[-1].outside if drum.track == "groove" else walls[-1].floor
    bottom = body.circle(first, 0.0)
    top = body.circle(last, drum.length if drum.pocket is None else drum.pocket)
    body.cylinder(bottom, first)
    for wall, each in zip(walls, drum.walls, strict=True):
        body.between(wall, outwards=each.side > 0)
    if drum.track == "groove":
        body.cylinder(walls[0].floor, walls[1].floor)
    if drum.track == "rib":
        body.cylinder(walls[0].outside, walls[1].outside)
    body.cylinder(last, top, 1 if drum.pocket is None else -1)
    body.ends(bottom, top, holes, key, tolerance)
    return Brep(np.array(body.corners), body.edges, body.faces)


def _cuts(breaks: Sequence[float]) -> Floats:
    """Angles of the roller at which all is cut, the first again a turn later, rad."""
    phi = np.unique(-np.array([0.0, *breaks]) % math.tau)
    phi = phi[np.append(True, np.diff(phi) > _LEAST)]
    ends = np.append(phi, phi[0] + math.tau)
    ends = ends[np.append(np.diff(ends) > _LEAST, True)]
    pieces = [
        np.linspace(a, b, max(math.ceil((b - a) / _WIDEST - _LEAST), 1) + 1)[:-1]
        for a, b in pairwise(ends)
    ]
    return np.append(np.concatenate(pieces), ends[-1])


def _fitted(drum: Drum, wall: DrumWall, first: float, last: float) -> Patch:
    """A wall between two angles of the roller, from the floor to the outside; of the sizes the smallest that fits."""
    for size in _SIZES:
        u, v = (np.linspace(0, 1, count) for count in size)
        v = (1 - np.cos(math.pi * v)) / 2
        found = patch(u, v, _points(drum, wall, first + (last - first) * u, v))
        beside = (u[1:] + u[:-1]) / 2
        between = (v[1:] + v[:-1]) / 2
        exact = _points(drum, wall, first + (last - first) * beside, between)
        off = float(np.max(np.linalg.norm(found(beside, between) - exact, axis=-1)))
        if off <= FIT:
            return found
    where = f"cam angle {math.degrees(-last) % 360:.4g} to {math.degrees(-first) % 360:.4g} deg"
    remedy = "its walls bend too much for splines: take its STL or 3MF"
    raise DesignError("a spline's distance from the wall", off, FIT, "mm", where, remedy)


def _points(drum: Drum, wall: DrumWall, phi: Floats, share: Floats) -> Floats:
    """Points (n, m, 3) of a wall at the roller's angles (n,), at shares (m,) of its depth there."""
    low, high = (_depth(wall, phi, rho) for rho in (drum.floor, drum.outside))
    depth = low[:, None] + (high - low)[:, None] * share
    found = wall.points(phi[:, None], depth)
    turn = np.exp(1j * found.beta)
    return np.stack([found.rho * turn.real, found.rho * turn.imag, found.z], axis=-1)


def _depth(wall: DrumWall, phi: Floats, rho: float) -> Floats:
    """Depth along the roller at which the wall's point has a distance from the axis, (n,) mm."""
    r = np.full(len(phi), rho)
    for _ in range(_ROUNDS):
        place = wall.points(phi, r).rho
        if np.max(np.abs(rho - place)) <= _CLOSE * rho:
            break
        slope = (wall.points(phi, r + _STEP * rho).rho - place) / (_STEP * rho)
        r = r + (rho - place) / slope
    return r
