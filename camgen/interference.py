"""Swept interference: how near the bodies of a machine come to each other over the turn, with a bound between samples.

    slab      a body's flat section between two heights, as recovered from its file
    course    how a group of bodies moves together: turn and shift over theta, and how fast at most
    gap       distance of two sections in the plane, mm; negative: diameter of the largest circle that fits in their overlap

The bound. A point of a body at distance r from its course's origin moves by at most (travel + turning r) mm a radian, so
two bodies approach by at most the sum L of that over both, taken at their farthest points; a distance of sets is
1-Lipschitz in the places of their points. Of a disc only its centre counts, also as seen by the other body. A gap g seen
at the middle of an interval of half width h is therefore at least g - L h all over it. Intervals are halved until that
suffices: whatever is dropped is proven, however thin the bodies are.
Bodies that may touch are first shrunk by half of the allowed overlap each: while the shrunk ones stay apart no circle
larger than the allowed overlap fits into the overlap of the true ones, so the same bound serves.
"""

from __future__ import annotations

import functools
import itertools
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from camgen.findings import Finding, at_least, at_most
from camgen.readback import Mesh, read_3mf, slice_mesh
from camgen.rings import Floats, Points, Ring, fit_circle
from camgen.tolerances import FLOAT32_ROUNDING

if TYPE_CHECKING:
    import shapely

RESOLUTION = 0.005  # mm, to which the smallest gap of a pair is found where it matters
_SHARE = 0.25  # ... and the share of what it has to spare to which it is found elsewhere
_TOUCHING = 0.9  # the same for pairs that touch: what counts is only that they do not overlap by more than they may
_ROUND = 0.002  # mm, how far an outline may lie from a circle and count as one
_FACETS = 0.001  # mm, chord tolerance of arcs; added to what a gap may be short
_SAME_HEIGHT = 1e-4  # mm: less than this in common in height is lying on each other
_BATCH = 1_000_000  # coordinates that are moved at once
_DEPTHS = 180  # angles at which the depth of an overlap is looked up
_START = 64  # intervals of the turn to begin with

Pair = frozenset[str]


@dataclass(frozen=True)
class Slab:
    """Flat section between the heights z0 and z1 of a body's own frame, mm; inside is what an odd number of rings encloses."""

    z0: float
    z1: float
    rings: tuple[Ring, ...]


@dataclass(frozen=True)
class Course:
    """Motion of a group of bodies: ground = position(theta) + exp(i angle(theta)) z.

    angle: (n,) rad -> (n,) rad; position: (n,) rad -> (n,) complex mm; both continuous. turning and travel: the greatest
    |d angle / d theta| and |d position / d theta| (mm/rad) over the turn, from closed forms where there are any; poses
    that contradict them are refused. The same course object moves its bodies as one.
    """

    angle: Callable[[Floats], Floats]
    position: Callable[[Floats], Points]
    turning: float
    travel: float


STILL = Course(lambda t: np.zeros(t.shape), lambda t: np.zeros(t.shape, complex), 0.0, 0.0)


@dataclass(frozen=True)
class Body:
    """A stack of slabs on a course: course's frame = at + exp(i turned) * body; flipped: first turned over about its Oy.

    z: height of the underside in the assembly, mm. Turned over, x becomes -x and a height z the thickness less z.
    """

    name: str
    slabs: tuple[Slab, ...]
    course: Course = STILL
    z: float = 0.0
    flipped: bool = False
    turned: float = 0.0
    at: complex = 0j


@dataclass(frozen=True)
class Clearance:
    """What a pair of bodies comes to: smallest gap seen (mm, at theta), the gap proven for the whole turn, evaluations.

    allowed: overlap that the pair may have because it touches by intent, mm; None where it must stay apart.
    """

    a: str
    b: str
    gap: float
    proven: float
    theta: float
    allowed: float | None
    evaluations: int


# ---- sections --------------------------------------------------------------------------------------------------------


def slabs_of(mesh: Mesh) -> tuple[Slab, ...]:
    """A mesh as slabs between its distinct heights; a slanted wall counts with its whole shadow.

    ValueError where a section does not close.
    """
    import shapely

    size = float(np.max(np.abs(mesh.vertices)))
    heights = np.unique(mesh.vertices[:, 2])
    heights = heights[np.append(np.diff(heights) > 8 * FLOAT32_ROUNDING * size, True)]
    corners = mesh.vertices[mesh.faces]
    low, high = corners[:, :, 2].min(axis=1), corners[:, :, 2].max(axis=1)
    ab, ac = (corners[:, k, :2] - corners[:, 0, :2] for k in (1, 2))
    longest = (np.abs(ab) + np.abs(ac)).max(axis=1)
    flat = np.abs(ab[:, 0] * ac[:, 1] - ab[:, 1] * ac[:, 0]) <= 8 * FLOAT32_ROUNDING * size * longest
    slabs = []
    for z0, z1 in itertools.pairwise(heights.tolist()):
        rings = slice_mesh(mesh, (z0 + z1) / 2)
        slanted = corners[~flat & (low < z1) & (high > z0) & (high > low)]
        if len(slanted):
            shadows = [shadow for c in slanted if (shadow := _shadow(c, z0, z1)).area > 0]
            rings = _rings(shapely.union_all([_area(rings), *shadows]))
        if rings:
            slabs.append(Slab(z0, z1, tuple(rings)))
    return tuple(slabs)


def _shadow(corners: Floats, z0: float, z1: float) -> Any:
    """Projection of a triangle's part between two heights."""
    import shapely

    points = [p[:2] for p in corners if z0 <= p[2] <= z1]
    for a, b in itertools.combinations(corners, 2):
        points += [(a + (z - a[2]) / (b[2] - a[2]) * (b - a))[:2] for z in (z0, z1) if (a[2] - z) * (b[2] - z) < 0]
    return shapely.MultiPoint(np.array(points)).convex_hull


def _area(rings: Sequence[Ring]) -> Any:
    """What an odd number of rings encloses, as a shapely area."""
    import shapely

    faces = [shapely.Polygon(np.column_stack([z.real, z.imag])) for z in (ring.facetted(_FACETS) for ring in rings)]
    return functools.reduce(shapely.symmetric_difference, faces)


def _rings(area: Any) -> list[Ring]:
    import shapely

    loops = [part for face in shapely.get_parts(area) for part in (face.exterior, *face.interiors)]
    points = [shapely.get_coordinates(loop)[:-1] @ np.array([1, 1j]) for loop in loops]
    return [Ring(z, np.zeros(len(z))) for z in points]


@dataclass(frozen=True)
class _Section:
    """A slab as mounted: heights in the assembly and shapely area in the course's frame.

    reach: of its points from the course's origin, for a disc (centre not None) of its centre; facets: how far the area may
    be from what it stands for (true arcs, the disc), mm.
    """

    z0: float
    z1: float
    area: shapely.Geometry
    reach: float
    centre: complex | None
    facets: float


def _sections(body: Body) -> list[_Section]:
    import shapely

    top, turn = max(slab.z1 for slab in body.slabs), complex(math.cos(body.turned), math.sin(body.turned))
    found = []
    for slab in body.slabs:
        z0, z1 = (top - slab.z1, top - slab.z0) if body.flipped else (slab.z0, slab.z1)
        rings = [ring.moved(-turn if body.flipped else turn, body.at, body.flipped) for ring in slab.rings]
        area = _area(rings)
        facets = _FACETS if any(ring.bulges.any() for ring in rings) else 0.0
        centre, flattened = _disc(area)
        if flattened <= _ROUND:
            reach, facets = abs(centre), facets + flattened
        else:
            reach = float(np.max(np.linalg.norm(shapely.get_coordinates(area), axis=1))) + facets
        found.append(_Section(body.z + z0, body.z + z1, area, reach, centre if flattened <= _ROUND else None, facets))
    return found


def _disc(area: Any) -> tuple[complex, float]:
    """Centre of the disc about an area, and how far the area's edges lie inside its rim at most, mm; inf with holes."""
    import shapely

    if shapely.get_num_geometries(area) != 1 or shapely.get_num_interior_rings(shapely.get_geometry(area, 0)):
        return 0j, math.inf
    z = shapely.get_coordinates(area)[:-1] @ np.array([1, 1j])
    centre, _, _ = fit_circle(z)
    inside = float(area.exterior.distance(shapely.Point(centre.real, centre.imag)))
    return centre, float(np.max(np.abs(z - centre))) - inside


# ---- motion ----------------------------------------------------------------------------------------------------------


def sampled_rate(function: Callable[[Floats], Any], samples: int = 3600) -> float:
    """Greatest slope of a smooth function over the turn, for a Course whose rates have no closed form.

    The steepest chord between samples, and half a step times the greatest second difference, which bounds what lies
    between them where the second derivative does not change by its own size within a step.
    """
    theta = np.linspace(0, math.tau, samples + 1)
    chords = np.diff(function(theta)) / (math.tau / samples)
    return float(np.max(np.abs(chords)) + np.max(np.abs(np.diff(chords))) / 2)


def _kept(course: Course, theta: Floats, name: str) -> tuple[Floats, Points]:
    """Pose of a course at increasing angles; ValueError where it moves faster than it says."""
    angle, position = course.angle(theta), course.position(theta)
    step = np.diff(theta)
    for moved, rate, what in ((np.diff(angle), course.turning, "turns"), (np.diff(position), course.travel, "travels")):
        excess = np.abs(moved) - rate * step * (1 + 1e-9) - 1e-9
        if not np.all(excess <= 0):
            k = int(np.argmax(excess))
            raise ValueError(f"{name} {what} by {abs(moved[k]):.6g} from {theta[k]:.6g} rad on, faster than {rate:.6g} a radian")
    return angle, position


class _Approach:
    """One section of each of two bodies: decisions and distances at many angles, the smaller one moved in the other's frame."""

    def __init__(
        self, a: Body, b: Body, first: _Section, second: _Section, allowed: float | None, turn: tuple[float, float]
    ) -> None:
        import shapely

        self.allowed, self.turn = allowed or 0.0, turn
        self.speed = _speed(a, b, first, second, turn)
        if shapely.get_num_coordinates(first.area) < shapely.get_num_coordinates(second.area):
            a, b, first, second = b, a, second, first
        self.fixed, self.mover = (a, b), (first.area, second.area)
        self.facets = first.facets + second.facets
        self.home, self.guest = (s.area.buffer(-self.allowed / 2) if allowed else s.area for s in (first, second))
        self.coordinates = shapely.get_coordinates(self.guest) @ np.array([1, 1j])
        shapely.prepare(self.home)

    def placed(self, theta: Floats, guest: Any = None) -> Any:
        """The guest at each angle in the home's frame, (n,) geometries."""
        import shapely

        a, b = self.fixed
        (alpha, p), (beta, q) = (_kept(body.course, theta, body.name) for body in (a, b))
        coordinates = self.coordinates if guest is None else shapely.get_coordinates(guest) @ np.array([1, 1j])
        turn, shift = np.exp(1j * (beta - alpha)), (q - p) * np.exp(-1j * alpha)
        z = (turn[:, None] * coordinates + shift[:, None]).ravel()
        copies = np.repeat(np.array([self.guest if guest is None else guest]), len(theta))
        return shapely.set_coordinates(copies, np.column_stack([z.real, z.imag]))

    def depth(self, theta: Floats) -> Floats:
        """Diameter of the largest circle in the overlap of the true sections at each angle, mm."""
        import shapely

        home, guest = self.mover
        shapely.prepare(home)
        placed = self.placed(theta, guest)
        depth = np.zeros(len(theta))
        for k in np.flatnonzero(shapely.intersects(home, placed)):
            common = shapely.intersection(home, placed[k])
            if common.area > 0:
                depth[k] = 2 * shapely.length(shapely.maximum_inscribed_circle(common, tolerance=RESOLUTION / 10))
        return depth


def _speed(a: Body, b: Body, first: _Section, second: _Section, turn: tuple[float, float]) -> float:
    """How fast two sections approach each other at most, mm a radian."""
    if a.course is b.course:
        return 0.0
    speeds = [body.course.travel + body.course.turning * section.reach for body, section in ((a, first), (b, second))]
    bounds = [sum(speeds)]
    start = np.array(turn[:1])
    for home, guest, disc, speed in ((a, b, second, speeds[1]), (b, a, first, speeds[0])):
        if disc.centre is not None:  # its centre, seen from the other course's turning frame
            beta, p, q = guest.course.angle(start), home.course.position(start), guest.course.position(start)
            drift = speed + home.course.travel
            apart = abs(complex((q + np.exp(1j * beta) * disc.centre - p)[0])) + drift * (turn[1] - turn[0])
            bounds.append(drift + home.course.turning * apart)
    return min(bounds)


# ---- the search ------------------------------------------------------------------------------------------------------


@dataclass
class _Best:
    """Smallest gap so far, of shrunk bodies less the allowed overlap, the angle, and how many places were looked at."""

    gap: float = math.inf
    theta: float = 0.0
    where: _Approach | None = None
    evaluations: int = 0


def _search(approach: _Approach, best: _Best, needed: float, resolution: float) -> None:
    """Lower `best` to the least gap of an approach; what is not looked at cannot be less than best less its resolution."""
    import shapely

    floor, ease, turn = -approach.allowed, approach.facets, approach.turn
    share = _TOUCHING if approach.allowed else _SHARE
    span = turn[1] - turn[0]
    start = max(_START, math.ceil(approach.speed * span / (2 * _TOUCHING * approach.allowed)) if approach.allowed else 0)
    half = span / 2 / start
    middle: Floats = np.linspace(turn[0] + half, turn[1] - half, start)
    if approach.speed == 0:
        middle, half = middle[:1], 0.0
    while len(middle):
        chunk = max(_BATCH // len(approach.coordinates), 1)
        kept = []
        for low in range(0, len(middle), chunk):
            theta = middle[low : low + chunk]
            placed = approach.placed(theta)
            best.evaluations += len(theta)
            rivals = np.arange(len(theta))
            while len(rivals) and best.gap > floor:  # each round measures one, and keeps those that are nearer still
                k = int(rivals[len(rivals) // 2])
                gap = float(shapely.distance(approach.home, placed[k])) - approach.allowed - ease
                if gap < best.gap:
                    best.gap, best.theta, best.where = gap, float(theta[k]), approach
                nearer = best.gap - _spare(best.gap, needed, resolution, share) / 2 + approach.allowed + ease
                rivals = rivals[rivals != k]
                rivals = rivals[shapely.dwithin(approach.home, placed[rivals], nearer)] if nearer > 0 else rivals[:0]
            if best.gap <= floor:
                return
            reach = best.gap - _spare(best.gap, needed, resolution, share) + approach.allowed + ease + approach.speed * half
            kept.append(theta[shapely.dwithin(approach.home, placed, reach)] if reach > 0 else theta[:0])
        middle, half = np.concatenate(kept), half / 2
        middle = np.sort(np.concatenate([middle - half, middle + half])) if approach.speed else middle[:0]


def _spare(gap: float, needed: float, resolution: float, share: float) -> float:
    """To what the gap is found: finely near what is needed, roughly where there is room."""
    return max(resolution, share * (gap - needed))


def swept(
    bodies: Sequence[Body],
    contacts: Mapping[Pair, float],
    needed: float = 0.0,
    turn: tuple[float, float] = (0.0, math.tau),
    resolution: float = RESOLUTION,
) -> list[Clearance]:
    """Clearance of every pair of bodies with heights in common, over the whole turn.

    contacts: frozenset of two names -> overlap that the pair may have since it is meant to touch, mm > 0. needed: gap that
    the others must keep, mm; smaller gaps are found to `resolution`, larger ones to a quarter of what they have to spare.
    ValueError for names that occur twice, contacts of unknown bodies, and poses faster than their course says.
    """
    names = [body.name for body in bodies]
    unknown = {name for pair in contacts for name in pair} - set(names)
    if len(set(names)) < len(names) or unknown or not all(value > 0 for value in contacts.values()):
        raise ValueError(f"names that occur twice, contacts of unknown bodies {sorted(unknown)} or without an allowed overlap")
    sections = [_sections(body) for body in bodies]
    found = []
    for (a, own), (b, others) in itertools.combinations(zip(bodies, sections, strict=True), 2):
        allowed = contacts.get(frozenset((a.name, b.name)))
        approaches = [
            _Approach(a, b, first, second, allowed, turn)
            for first, second in itertools.product(own, others)
            if min(first.z1, second.z1) - max(first.z0, second.z0) > _SAME_HEIGHT
        ]
        if approaches:
            found.append(_clearance(a.name, b.name, approaches, allowed, needed, resolution))
    return found


def _clearance(
    a: str, b: str, approaches: Sequence[_Approach], allowed: float | None, needed: float, resolution: float
) -> Clearance:
    best, target = _Best(), needed if allowed is None else -allowed
    fine = resolution if allowed is None else min(resolution, allowed / 4)
    for approach in approaches:
        if not (approach.home.is_empty or approach.guest.is_empty):  # thinner than the overlap it may have
            _search(approach, best, target, fine)
    if best.where is None or best.gap > -(allowed or 0.0):
        spare = _spare(best.gap, target, fine, _SHARE if allowed is None else _TOUCHING)
        return Clearance(a, b, best.gap, best.gap - spare, best.theta, allowed, best.evaluations)
    looked = _DEPTHS if any(approach.speed for approach in approaches) else 0
    theta = np.sort(np.append(np.linspace(*approaches[0].turn, looked, endpoint=False), best.theta), axis=0)
    depth = np.max([approach.depth(theta) for approach in approaches], axis=0)
    worst = int(np.argmax(depth))
    if depth[worst] > 0:
        best.theta = float(theta[worst])
    gap = -float(depth[worst])
    return Clearance(a, b, gap, gap - resolution, best.theta, allowed, best.evaluations + len(theta))


def interference(clearances: Sequence[Clearance], needed: float) -> list[Finding]:
    """INTERFERENCE: each pair that comes too near or is not proven to stay clear, else the tightest of either kind."""
    findings = []
    apart = [(c.proven - needed, c) for c in clearances if c.allowed is None]
    touching = [(c.proven + c.allowed, c) for c in clearances if c.allowed is not None]
    for c in _worst(apart):
        seen = f"smallest gap seen {c.gap:.4f} mm" if c.gap > 0 else f"they overlap by {-c.gap:.4f} mm or more"
        remark = f"{len(apart)} pair(s) must stay apart; {seen}, the gap stated holds between the samples too"
        findings.append(at_least("INTERFERENCE", c.proven, needed, "mm", _place(c, "gap"), remark))
    for c in _worst(touching):
        seen = f"overlap seen {max(0.0, -c.gap):.4f} mm"
        remark = f"{len(touching)} pair(s) touch by intent; {seen}, what is stated bounds it between the samples too"
        findings.append(at_most("INTERFERENCE", max(0.0, -c.proven), c.allowed or 0.0, "mm", _place(c, "overlap"), remark))
    return findings


def _worst(judged: Sequence[tuple[float, Clearance]]) -> list[Clearance]:
    """All that fail, else the one with the least margin."""
    ordered = sorted(judged, key=lambda item: item[0])
    return [c for margin, c in ordered if not margin >= 0] or [c for _, c in ordered[:1]]


def _place(c: Clearance, what: str) -> str:
    return f"{c.a} and {c.b}: {what}, cam angle {math.degrees(c.theta):.3f} deg"


# ---- a plate ready to print ------------------------------------------------------------------------------------------


def judge_plate(path: Path, bed: tuple[float, float], gap: float) -> list[Finding]:
    """A plate file as read back: every body stands on z = 0, inside the bed (its corner at the origin), `gap` from the others.

    Bodies count with their whole shadow.
    """
    import shapely

    package, where = read_3mf(path), path.name
    meshes = [item.placed for item in package.items]
    rounding = 8 * FLOAT32_ROUNDING * max(bed)
    lift = max((abs(float(mesh.vertices[:, 2].min())) for mesh in meshes), default=math.nan)
    places = [mesh.vertices[:, :2] for mesh in meshes]
    beyond = max((float(max(-xy.min(), (xy - np.array(bed)).max(), 0.0)) for xy in places), default=math.nan)
    shadows = [shapely.union_all([_area(slab.rings) for slab in slabs_of(mesh)]) for mesh in meshes]
    nearest = math.inf
    if len(shadows) > 1:
        tree = shapely.STRtree(shadows)
        pairs = tree.query_nearest(shadows, exclusive=True, all_matches=False, return_distance=True)
        nearest = float(pairs[1].min())
    size = f"{bed[0]:g} x {bed[1]:g} mm"
    return [
        at_most("BED_FIT", beyond, rounding, "mm", where, f"how far {len(meshes)} bodies stand out over the bed of {size}"),
        at_most("BED_FIT", lift, rounding, "mm", where, "how far a body is off the bed's plane z = 0"),
        at_least("BED_FIT", nearest, gap - rounding, "mm", where, "smallest gap between bodies on the plate"),
    ]
