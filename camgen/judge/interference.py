"""Swept interference: how near the bodies of a machine come to each other over the turn, with a bound between samples.

    slab      a body's flat section between two heights
    course    where a body is over theta: its turn and its place
    gap       distance of two sections in the plane, mm; negative: diameter of the largest circle that fits in their overlap

The bound. One body, the home, counts as still; z is a point of the other one, the guest: it is at s + e z, s and the unit
complex e read from both courses on a fine grid of angles. About any centre c of the guest, from one angle to another

    |moved| <= |change of s + e c| + |change of e| |z - c|

The sum of these over the grid, each with twice what a second difference says of the way between, is the path: no point of
the guest moves further than the path grows. c is the point that moves least, which in a pin joint is its centre, and the
guest is cut into rings about it: what is near in a joint moves little, what moves far is not near. Of a disc only the
centre counts. A distance of sets is 1-Lipschitz in the places of their points, so a gap g seen in the middle of a stretch
of path of half length l is at least g - l all over it. Stretches are halved until that suffices: whatever is dropped is
proven, however thin the bodies are. Poses that contradict the path are refused.
A guest that only slides on a straight line needs no stretches where all that it sweeps is farther than the least gap so far.
Bodies that may touch are first shrunk by half of the allowed overlap each: while the shrunk ones stay apart no circle
larger than the allowed overlap fits into the overlap of the true ones, so the same bound serves.
"""

from __future__ import annotations

import functools
import itertools
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from camgen.errors import counted
from camgen.findings import Finding, Where, at_least, at_most
from camgen.geometry.rings import Floats, Ints, Points
from camgen.judge.relative_motion import AT_REST, STRAIGHT, Motion
from camgen.judge.slabs import PLANE, Body, Section, covered, sections_of, shadow_of, shrunk

RESOLUTION = 0.005  # mm, to which the smallest gap of a pair is found where it matters
_SHARE = 0.25  # ... and the share of what it has to spare to which it is found elsewhere
_TOUCHING = 0.9  # the same for pairs that touch: what counts is only that they do not overlap by more than they may
_SAME_HEIGHT = 1e-4  # mm: less than this in common in height is lying on each other
_BATCH = 1_000_000  # coordinates that are moved at once
_DEPTHS = 180  # angles at which the depth of an overlap is looked up
_GRID = 3600  # steps over the turn in which courses are read
_START = 16  # stretches of a path to begin with
_MANY = 32  # stretches in question at once, at which it is worth cutting the guest up
_RINGS = 6  # into which a guest is cut, each half as wide as the one outside it
_CORNERS = 128  # of a piece of the guest that is not cut any more
_LAYERS = 4  # pairs of sections, beyond which their shadows are compared first, by at most
_LONG = 1000  # stretches at once

Pair = frozenset[str]
Facing = tuple[Section, Section]  # of two bodies, at heights in common


@dataclass(frozen=True)
class Clearance:
    """What a pair of bodies comes to: smallest gap seen (mm, at theta), the gap proven for the whole turn, evaluations.

    allowed: overlap that the pair may have because it touches by intent, mm; None where it must stay apart. at_rest: neither
    moves as the other sees it.
    """

    a: str
    b: str
    gap: float
    proven: float
    theta: float
    allowed: float | None
    evaluations: int
    at_rest: bool = False


class _Approach:
    """One section of each of two bodies, or a piece of one: decisions at many places of their path.

    home, guest: what is compared, shrunk by half of the allowed overlap each; of a disc the centre, `pad` its radius.
    """

    def __init__(
        self,
        motion: Motion,
        home: Any,
        guest: Any,
        pad: float,
        allowed: float,
        facets: float,
        cut: int = 0,
    ) -> None:
        import shapely

        self.cut = cut  # how often the guest was cut up
        self.motion, self.home, self.guest, self.pad, self.allowed, self.facets = (
            motion,
            home,
            guest,
            pad,
            allowed,
            facets,
        )
        self.coordinates = shapely.get_coordinates(guest) @ PLANE
        self.centre = complex(self.coordinates[0]) if len(self.coordinates) == 1 else motion.calmest
        self.reach = float(np.max(np.abs(self.coordinates - self.centre), initial=0.0))
        self.path = motion.path(self.centre, self.reach)

    @property
    def empty(self) -> bool:
        """Whether one of both is thinner than the overlap that it may have."""
        return bool(self.home.is_empty or self.guest.is_empty or self.pad < 0)

    def theta(self, path: Floats) -> Floats:
        """Angles at increasing places of the path."""
        return np.interp(path, self.path, self.motion.theta)

    def placed(self, theta: Floats) -> Any:
        """The guest at each angle in the home's frame, (n,) geometries; ValueError where it went further than its path."""
        turns, shifts = self.motion.at(theta)
        if len(theta) > 1:
            way = np.diff(np.interp(theta, self.motion.theta, self.path))
            moved = np.abs(np.diff(shifts + turns * self.centre)) + self.reach * np.abs(
                np.diff(turns)
            )
            if not np.all(moved <= way * (1 + 1e-6) + 1e-7):
                k = int(np.argmax(moved - way))
                said = f"one sees the other move by {moved[k]:.6g} mm from {theta[k]:.6g} to {theta[k + 1]:.6g} rad"
                raise ValueError(
                    f"{said}, faster than its course read in {_GRID} steps tells, {way[k]:.6g} mm"
                )
        return _moved(self.guest, self.coordinates, turns, shifts)

    def slides_clear(self, distance: float) -> bool:
        """Whether the guest only slides, and all that it sweeps on its straight way stays so far from the home."""
        import shapely

        ends = self.motion.straight
        if ends is None or not 0 < distance < math.inf:
            return False
        turn, rings = self.motion.turns[0], shapely.get_parts(shapely.boundary(self.guest))
        chains = [shapely.get_coordinates(ring) @ PLANE for ring in rings] or [
            self.coordinates[[0, 0]]
        ]
        starts, stops = (
            turn * np.concatenate([chain[side] for chain in chains])
            for side in (slice(-1), slice(1, None))
        )
        corners = np.stack(
            [starts + ends[0], stops + ends[0], stops + ends[1], starts + ends[1]], axis=1
        )
        swept = shapely.polygons(np.stack([corners.real, corners.imag], axis=2))
        placed = _moved(self.guest, self.coordinates, np.array([turn]), np.array(ends[:1]))
        shapely.prepare(self.home)
        return not np.any(shapely.dwithin(self.home, np.append(swept, placed), distance))

    def round(self) -> _Approach | None:
        """The same with the disc about the guest's calmest point in its place; None where it is one."""
        import shapely

        if len(self.coordinates) == 1:
            return None
        middle = shapely.Point(self.centre.real, self.centre.imag)
        return _Approach(self.motion, self.home, middle, self.reach, self.allowed, self.facets)

    @property
    def divisible(self) -> bool:
        """Whether it is worth cutting the guest up."""
        return len(self.coordinates) > (_CORNERS if self.cut else 1)

    def divided(self) -> list[_Approach]:
        """The same with the guest cut up: first into rings about its calmest point, each moving less inside, then in halves."""
        import shapely

        if self.cut == 0:
            middle, radii = (
                shapely.Point(self.centre.real, self.centre.imag),
                [self.reach / 2**k for k in range(_RINGS)],
            )
            discs = [
                middle.buffer(1.01 * radius, quad_segs=32) for radius in radii
            ]  # its facets lie 0.1 percent inside
            holes = [middle.buffer(0.99 * radius, quad_segs=32) for radius in radii[1:]]
            rings = [disc.difference(hole) for disc, hole in zip(discs, holes, strict=False)]
            cutters = [discs[-1], *rings[::-1]]  # the calmest first
        else:
            x0, y0, x1, y1 = self.guest.bounds
            x, y = (x0 + x1) / 2, (y0 + y1) / 2
            wide = x1 - x0 > y1 - y0
            cutters = [
                shapely.box(x0, y0, *((x, y1) if wide else (x1, y))),
                shapely.box(*((x, y0) if wide else (x0, y)), x1, y1),
            ]
        parts = [self.guest.intersection(cutter) for cutter in cutters]
        return [
            _Approach(
                self.motion, self.home, part, self.pad, self.allowed, self.facets, self.cut + 1
            )
            for part in parts
            if not part.is_empty
        ]


def _moved(area: Any, coordinates: Points, turns: Points, shifts: Points) -> Any:
    import shapely

    z = (turns[:, None] * coordinates + shifts[:, None]).ravel()
    if len(coordinates) == 1:
        return shapely.points(z.real, z.imag)
    return shapely.set_coordinates(
        np.repeat(np.array([area]), len(turns)), np.column_stack([z.real, z.imag])
    )


# ---- the search ------------------------------------------------------------------------------------------------------


@dataclass
class _Best:
    """Smallest gap so far, of shrunk bodies less the allowed overlap, the angle, and how many places were looked at."""

    gap: float = math.inf
    theta: float = 0.0
    evaluations: int = 0


def _search(
    approach: _Approach, best: _Best, needed: float, resolution: float, most: float
) -> bool:
    """Lower `best` to the least gap of an approach; what is not looked at cannot be less than best less its resolution.

    False where more than `most` stretches are in question at once: then nothing is said.
    """
    import shapely

    shapely.prepare(approach.home)

    floor, ease = -approach.allowed, approach.facets + approach.pad
    share = _TOUCHING if approach.allowed else _SHARE

    def spare() -> float:
        return _spare(best.gap, needed, resolution, share)

    def reach(half: float) -> float:
        """How near the guest as it is placed must come for a gap to be lower than `best` by what is to spare."""
        return best.gap - spare() + approach.allowed + ease + half

    def within(placed: Any, some: Ints, distance: float) -> Ints:
        """Those that come as near as that."""
        if not (
            math.isfinite(distance) and len(some)
        ):  # the first time there is nothing to compare with
            return some
        return (
            some[shapely.dwithin(approach.home, placed[some], distance)]
            if distance > 0
            else some[:0]
        )

    span = float(approach.path[-1])
    half = span / 2 / _START
    middle: Floats = np.linspace(half, span - half, _START)
    if span < AT_REST:
        middle, half = np.array([span / 2]), span / 2
    while len(middle):
        if len(middle) > most:
            return False
        chunk = max(_BATCH // len(approach.coordinates), 1)
        kept = []
        for low in range(0, len(middle), chunk):
            places = middle[low : low + chunk]
            theta = approach.theta(places)
            placed = approach.placed(theta)
            best.evaluations += len(theta)
            # What is not even near now cannot lower `best` either, for it only falls.
            near = within(placed, np.arange(len(theta)), max(reach(half), reach(spare() / 2)))
            rivals, k, before = near, len(theta) // 2, best.gap
            while True:  # each round measures one, and keeps those that are nearer still
                apart = float(shapely.distance(approach.home, placed[k])) - approach.pad
                gap = max(apart, 0.0) - approach.allowed - approach.facets
                if gap < best.gap:
                    best.gap, best.theta = gap, float(theta[k])
                if best.gap <= floor:
                    return True
                rivals = within(placed, rivals[rivals != k], reach(spare() / 2))
                if not len(rivals):
                    break
                k = int(rivals[len(rivals) // 2])
            if best.gap < before or half < spare() / 2:
                near = within(placed, near, reach(half))
            kept.append(places[near])
        middle, half = np.concatenate(kept), half / 2
        middle = (
            np.sort(np.concatenate([middle - half, middle + half]))
            if span >= AT_REST
            else middle[:0]
        )
    return True


def _settle(approach: _Approach, best: _Best, needed: float, resolution: float) -> None:
    """Lower `best` to the least gap of an approach, by way of a simpler guest or pieces of it where that is less work."""
    if approach.empty or best.gap <= -approach.allowed:
        return
    if approach.slides_clear(
        best.gap + approach.allowed + approach.facets + approach.pad - STRAIGHT
    ):
        return
    if _search(approach, best, needed, resolution, _MANY if approach.divisible else math.inf):
        return
    if not _search_about(approach, best, needed, resolution):
        for part in approach.divided():
            _settle(part, best, needed, resolution)


def _search_about(approach: _Approach, best: _Best, needed: float, resolution: float) -> bool:
    """The same with the disc round the guest in its place; False, and nothing is said, where that is not as near as it is."""
    import shapely

    disc, found = approach.round(), _Best()
    if disc is None or not _search(disc, found, needed, resolution, _MANY) or found.gap <= needed:
        return False
    true = (
        float(shapely.distance(approach.home, approach.placed(np.array([found.theta]))[0]))
        - approach.allowed
    )
    best.evaluations += found.evaluations
    if true - approach.facets > found.gap + resolution:
        return False
    if found.gap < best.gap:
        best.gap, best.theta = found.gap, found.theta
    return True


def _spare(gap: float, needed: float, resolution: float, share: float) -> float:
    """To what the gap is found: finely near what is needed, roughly where there is room."""
    return max(resolution, share * (gap - needed))


def swept(
    bodies: Sequence[Body],
    contacts: Mapping[Pair, float],
    needed: float = 0.0,
    turn: tuple[float, float] = (0.0, math.tau),
    resolution: float = RESOLUTION,
    mounted: float | None = None,
) -> list[Clearance]:
    """Clearance of every pair of bodies with heights in common, over the whole turn.

    contacts: frozenset of two names -> overlap that the pair may have since it is meant to touch, mm > 0. mounted: the same
    for all pairs that do not move as they see each other; None where they must keep their distance like any. needed: gap
    that the others must keep, mm; smaller gaps are found to `resolution`, larger ones to a quarter of what they have to
    spare. ValueError for names that occur twice, contacts of unknown bodies, and poses that jump between grid angles.
    """
    names = [body.name for body in bodies]
    unknown = {name for pair in contacts for name in pair} - set(names)
    if len(set(names)) < len(names) or unknown or not all(value > 0 for value in contacts.values()):
        raise ValueError(
            f"names that occur twice, contacts of unknown bodies {sorted(unknown)} or without an allowed overlap"
        )
    sections, theta = [sections_of(body) for body in bodies], np.linspace(*turn, _GRID + 1)
    seen = functools.cache(
        lambda home, guest: Motion(home, guest, theta)
    )  # bodies on one course move as one
    within = functools.cache(covered)
    found = []
    for (a, own), (b, others) in itertools.combinations(zip(bodies, sections, strict=True), 2):
        level = [
            (first, second)
            for first, second in itertools.product(own, others)
            if min(first.z1, second.z1) - max(first.z0, second.z0) > _SAME_HEIGHT
        ]
        if level:
            level = _widest(level, within) if len(level) <= _LAYERS else level
            motions = seen(a.course, b.course), seen(b.course, a.course)
            allowed = contacts.get(
                frozenset((a.name, b.name)), mounted if motions[0].at_rest else None
            )
            try:
                best, proven = _least(motions, level, allowed, needed, resolution)
            except ValueError as fault:
                raise ValueError(f"{a.name} and {b.name}: {fault}") from None
            found.append(
                Clearance(
                    a.name,
                    b.name,
                    best.gap,
                    proven,
                    best.theta,
                    allowed,
                    best.evaluations,
                    motions[0].at_rest,
                )
            )
    return found


def _least(
    motions: tuple[Motion, Motion],
    level: Sequence[tuple[Section, Section]],
    allowed: float | None,
    needed: float,
    resolution: float,
) -> tuple[_Best, float]:
    """Smallest gap of a pair's sections, and the one that is proven."""
    best, target, floor = _Best(), needed if allowed is None else -allowed, -(allowed or 0.0)
    fine, share = (
        (resolution, _SHARE) if allowed is None else (min(resolution, allowed / 4), _TOUCHING)
    )
    waiting = [list(level)]
    while waiting:
        some = waiting.pop()
        if len(some) <= _LAYERS:
            for first, second in some:
                _settle(_facing(motions, first, second, -floor), best, target, fine)
            continue
        first, second = (shadow_of(sections) for sections in zip(*some, strict=True))
        whole = _Best()
        clear = _search(
            _facing(motions, first, second, -floor), whole, target, fine, _LONG
        ) and whole.gap > max(target, 0.0)
        best.evaluations += whole.evaluations
        if not clear:
            waiting += [some[len(some) // 2 :], some[: len(some) // 2]]
        elif whole.gap < best.gap:
            best.gap, best.theta = whole.gap, whole.theta
    if best.gap > floor:
        return (
            (best, best.gap - _spare(best.gap, target, fine, share))
            if math.isfinite(best.gap)
            else (_Best(floor), floor)
        )
    looked = 1 if motions[0].at_rest else _DEPTHS
    theta = np.sort(
        np.append(
            np.linspace(motions[0].theta[0], motions[0].theta[-1], looked, endpoint=False),
            best.theta,
        )
    )
    depth, best.theta = _deepest(
        [(motions[0], first.area, second.area, theta) for first, second in level], best.theta
    )
    best.gap, best.evaluations = -depth, best.evaluations + len(theta)
    return best, best.gap - resolution


def _widest(level: Sequence[Facing], within: Callable[[Section, Section], bool]) -> list[Facing]:
    """Pairs less those of sections that lie within another pair's, and so are no nearer: those of a cam's mark."""
    kept = list(level)
    for first, second in level:
        if any(
            within(first, a) and within(second, b) for a, b in kept if (a, b) != (first, second)
        ):
            kept.remove((first, second))
    return kept


def _facing(
    motions: tuple[Motion, Motion], first: Section, second: Section, allowed: float
) -> _Approach:
    """Two sections for the search; the guest is the one that is looked at with less work."""

    def seen(motion: Motion, home: Section, guest: Section) -> _Approach:
        import shapely

        body, facets = shrunk(home, allowed / 2), home.facets + guest.facets
        if guest.disc is None:
            return _Approach(motion, body, shrunk(guest, allowed / 2), 0.0, allowed, facets)
        centre, radius = guest.disc
        return _Approach(
            motion,
            body,
            shapely.Point(centre.real, centre.imag),
            radius - allowed / 2,
            allowed,
            facets,
        )

    both = seen(motions[0], first, second), seen(motions[1], second, first)
    return min(both, key=lambda each: len(each.coordinates) * (1 + each.path[-1]))


def _deepest(
    overlaps: Sequence[tuple[Motion, Any, Any, Floats]], theta: float
) -> tuple[float, float]:
    """Diameter of the largest circle in the overlaps of a home and a guest at the angles given, mm, and its angle.

    A circle fits where both, shrunk by its radius, still meet.
    """
    import shapely

    def deeper(depth: float) -> list[tuple[Motion, Any, Any, Floats]]:
        kept = []
        for motion, home, guest, angles in overlaps:
            a, b = home.buffer(-depth / 2), guest.buffer(-depth / 2)
            if not (a.is_empty or b.is_empty):
                shapely.prepare(a)
                meet = angles[
                    shapely.intersects(
                        a, _moved(b, shapely.get_coordinates(b) @ PLANE, *motion.at(angles))
                    )
                ]
                if len(meet):
                    kept.append((motion, home, guest, meet))
        return kept

    low, high = 0.0, RESOLUTION
    while still_meet := deeper(high):
        overlaps, low, high = still_meet, high, 2 * high
        theta = float(overlaps[0][3][0])
    while high - low > RESOLUTION / 10:
        middle = (low + high) / 2
        if still_meet := deeper(middle):
            overlaps, low = still_meet, middle
            theta = float(overlaps[0][3][0])
        else:
            high = middle
    return low, theta


_PROVEN = "proven for the whole turn, not only the samples"


def interference(
    clearances: Sequence[Clearance], needed: float, angle: str = "cam angle"
) -> list[Finding]:
    """INTERFERENCE: each pair that comes too near or is not proven to stay clear, else the tightest of either kind.

    Of bodies that must stay apart the gap, at least the needed one, mm; of bodies that touch by intent the overlap, at most
    what facets and fits may show. angle: what theta is called.
    """
    findings = []
    apart = [(c.proven - needed, c) for c in clearances if c.allowed is None]
    touching = [(c.proven + c.allowed, c) for c in clearances if c.allowed is not None]
    for c in _worst(apart):
        seen = (
            f"smallest gap seen {c.gap:.4f} mm"
            if c.gap > 0
            else f"they overlap by {abs(c.gap):.4f} mm or more"
        )
        remark = f"nearest of {counted(len(apart), 'pair')} that must stay apart; {seen}; {_PROVEN}"
        findings.append(
            at_least("INTERFERENCE", c.proven, needed, "mm", _place(c, "gap", angle), remark)
        )
    for c in _worst(touching):
        seen = f"overlap seen {max(0.0, -c.gap):.4f} mm"
        remark = (
            f"deepest of {counted(len(touching), 'pair')} that touch by intent; {seen}; {_PROVEN}"
        )
        where = _place(c, "overlap", angle)
        findings.append(
            at_most("INTERFERENCE", max(0.0, -c.proven), c.allowed or 0.0, "mm", where, remark)
        )
    return findings


def _worst(judged: Sequence[tuple[float, Clearance]]) -> list[Clearance]:
    """All that fail, else the one with the least margin."""
    ordered = sorted(judged, key=lambda item: item[0])
    return [c for margin, c in ordered if not margin >= 0] or [c for _, c in ordered[:1]]


def _place(c: Clearance, what: str, angle: str) -> Where:
    return Where(f"{c.a} and {c.b}: {what}", part=c.a, other=c.b, theta=c.theta, angle=angle)
