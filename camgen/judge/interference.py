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
of path of half length l is at least g - l all over it, and one seen at the grid's angle next to the middle, which costs
no pose, at least as much less what that is off. Stretches are halved until that suffices: whatever is dropped is proven,
however thin the bodies are. Poses half a step from those of the grid that contradict the path are refused.
A guest that only slides on a straight line needs no more of them once all that it sweeps leaves the least gap so far, less what
is to spare.
Bodies that may touch are first shrunk by half of the allowed overlap each: while the shrunk ones stay apart no circle
larger than the allowed overlap fits into the overlap of the true ones, so the same bound serves.
"""

from __future__ import annotations

import functools
import itertools
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from camgen.errors import counted
from camgen.findings import Finding, Where, at_least, at_most
from camgen.geometry.rings import Floats, Ints, Points
from camgen.judge.relative_motion import AT_REST, ROUNDING, STRAIGHT, Motion
from camgen.judge.slabs import PLANE, Body, Section, covered, sections_of, shadow_of, shrunk
from camgen.numerics import magnitude

RESOLUTION = 0.005  # mm, to which the smallest gap of a pair is found where it matters
_SHARE = 0.25  # ... and the share of what it has to spare to which it is found elsewhere
_TOUCHING = 0.9  # the same for pairs that touch: what counts is only that they do not overlap by more than they may
_SAME_HEIGHT = 1e-4  # mm: less than this in common in height is lying on each other
_BATCH = 1_000_000  # coordinates that are moved at once
_DEPTHS = 180  # angles at which the depth of an overlap is looked up
GRID = 3600  # steps over the turn in which courses are read
_OFF = 0.125  # of half a stretch, that the grid's nearest angle may be off its middle
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
    """What a pair of bodies comes to: smallest gap seen (mm, at theta), the gap proven for all turns that are swept, evaluations.

    allowed: overlap that the pair may have because it touches by intent, mm; None where it must stay apart. at_rest: neither
    moves as the other sees it. standing: looked at as they stand at theta = 0 alone.
    """

    a: str
    b: str
    gap: float
    proven: float
    theta: float
    allowed: float | None
    evaluations: int
    at_rest: bool = False
    standing: bool = False


@dataclass(frozen=True, eq=False)
class _Looks:
    """Where a pair is looked at: poses of the guest, and by how much path they are off the places asked for."""

    theta: Floats
    turns: Points
    shifts: Points
    off: float  # mm, at most


@dataclass(frozen=True, eq=False)
class _Approach:
    """One section of each of two bodies, or a piece of one: decisions at many places of their path."""

    motion: Motion
    home: Any  # shrunk by half of the allowed overlap, like the guest
    guest: Any  # of a disc the centre
    pad: float  # radius of a disc, mm
    allowed: float  # overlap, mm
    facets: float  # how far facets may lie off, mm
    cuts: int = 0  # how often the guest was cut up

    @cached_property
    def coordinates(self) -> Points:
        """Corners of the guest, (n,)."""
        import shapely

        return np.asarray(shapely.get_coordinates(self.guest) @ PLANE)

    @cached_property
    def centre(self) -> complex:
        """The guest's point that moves least."""
        return complex(self.coordinates[0]) if self.single else self.motion.calmest

    @cached_property
    def reach(self) -> float:
        """Greatest distance of a corner from it, mm."""
        return float(np.max(np.abs(self.coordinates - self.centre), initial=0.0))

    @cached_property
    def path(self) -> Floats:
        """How far any point has moved at each angle of the grid, at most, (n,) mm; ValueError where it goes further between."""
        path = self.motion.path(self.centre, self.reach)
        if self.motion.keeps_to_paths(self.centre):
            return path
        way = np.diff(path)
        steps = self.motion.steps_halfway(self.centre) + self.reach * self.motion.turns_halfway
        for k, side in ((slice(-1), steps[0]), (slice(1, None), steps[1])):
            worst = int(np.argmax(side - way * (1 + ROUNDING)))
            if side[worst] > way[worst] * (1 + ROUNDING) + 1e-7:
                angle = self.motion.theta[k][worst]
                words = f"one sees the other move by {side[worst]:.6g} mm half a step from {angle:.6g} rad"
                raise ValueError(
                    f"{words}, faster than its course read in {GRID} steps tells, {way[worst]:.6g} mm"
                )
        return path

    @property
    def single(self) -> bool:
        """Whether the guest is a point."""
        return len(self.coordinates) == 1

    @property
    def empty(self) -> bool:
        """Whether one of both is thinner than the overlap that it may have."""
        return bool(self.home.is_empty or self.guest.is_empty or self.pad < 0)

    def looks(self, places: Floats, half: float) -> _Looks:
        """Where to look for stretches of half a length about increasing places of the path: on the grid if that is near enough."""
        after = np.clip(np.searchsorted(self.path, places), 1, len(self.path) - 1)
        before = after - 1
        nodes = np.where(places - self.path[before] < self.path[after] - places, before, after)
        off = magnitude(self.path[nodes] - places)
        motion = self.motion
        if off <= max(_OFF * half, AT_REST):
            return _Looks(motion.theta[nodes], motion.turns[nodes], motion.shifts[nodes], off)
        theta = np.interp(places, self.path, motion.theta)
        return _Looks(theta, *motion.at(theta), 0.0)

    def placed(self, theta: Floats) -> Any:
        """The guest at each angle in the home's frame, (n,) geometries."""
        return _moved(self.guest, self.coordinates, *self.motion.at(theta))

    def within(self, placed: Any, some: Ints, distance: float) -> Ints:
        """Which of some placed guests, by their number, come so near to the home."""
        import shapely

        if not (math.isfinite(distance) and len(some)):  # the first time there is no gap yet
            return some
        if distance <= 0:
            return some[:0]
        return np.asarray(some[shapely.dwithin(self.home, placed[some], distance)])

    def gap(self, placed: Any) -> float:
        """Gap of the home and one placed guest, mm."""
        import shapely

        distance = float(shapely.distance(self.home, placed)) - self.pad
        return max(distance, 0.0) - self.allowed - self.facets

    def slides_clear(self, gap: float) -> bool:
        """Whether the guest only slides, and all that it sweeps on its straight way leaves such a gap to the home."""
        import shapely

        ends = self.motion.straight
        distance = gap + self.allowed + self.facets + self.pad + STRAIGHT
        if ends is None or not 0 < distance < math.inf:
            return False
        turn = self.motion.turns[0]
        rings = shapely.get_parts(shapely.boundary(self.guest))
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
        way = shapely.polygons(np.stack([corners.real, corners.imag], axis=2))
        start = _moved(self.guest, self.coordinates, np.array([turn]), np.array(ends[:1]))
        shapely.prepare(self.home)
        return not np.any(shapely.dwithin(self.home, np.append(way, start), distance))

    def round(self) -> _Approach | None:
        """The same with the disc about the guest's calmest point in its place; None where it is one."""
        import shapely

        if self.single:
            return None
        middle = shapely.Point(self.centre.real, self.centre.imag)
        return replace(self, guest=middle, pad=self.reach, cuts=0)

    @property
    def divisible(self) -> bool:
        """Whether it is worth cutting the guest up."""
        return len(self.coordinates) > (_CORNERS if self.cuts else 1)

    def divided(self) -> list[_Approach]:
        """The same with the guest cut up: first into rings about its calmest point, each moving less inside, then in halves."""
        import shapely

        if self.cuts == 0:
            middle = shapely.Point(self.centre.real, self.centre.imag)
            radii = [self.reach / 2**k for k in range(_RINGS)]
            discs = [
                middle.buffer(1.01 * radius, quad_segs=32) for radius in radii
            ]  # its facets lie 0.1 percent inside
            holes = [middle.buffer(0.99 * radius, quad_segs=32) for radius in radii[1:]]
            rings = [disc.difference(hole) for disc, hole in zip(discs, holes, strict=False)]
            cutters = [discs[-1], *rings[::-1]]  # the calmest first
        else:
            x0, y0, x1, y1 = self.guest.bounds
            x = (x0 + x1) / 2
            y = (y0 + y1) / 2
            wide = x1 - x0 > y1 - y0
            cutters = [
                shapely.box(x0, y0, *((x, y1) if wide else (x1, y))),
                shapely.box(*((x, y0) if wide else (x0, y)), x1, y1),
            ]
        parts = [self.guest.intersection(cutter) for cutter in cutters]
        return [
            replace(self, guest=part, cuts=self.cuts + 1) for part in parts if not part.is_empty
        ]


def _moved(area: Any, coordinates: Points, turns: Points, shifts: Points) -> Any:
    import shapely

    z = turns[:, None] * coordinates + shifts[:, None]
    places = np.stack([z.real, z.imag], axis=2)
    if len(coordinates) == 1:
        return shapely.points(places[:, 0])
    if area.geom_type == "Polygon" and not area.interiors:
        return shapely.polygons(places)  # in half of the time
    return shapely.set_coordinates(np.repeat(np.array([area]), len(turns)), places.reshape(-1, 2))


# ---- the search ------------------------------------------------------------------------------------------------------


@dataclass
class _Best:
    """Smallest gap so far, of shrunk bodies less the allowed overlap, the angle, and how many places were looked at."""

    gap: float = math.inf
    theta: float = 0.0
    evaluations: int = 0


@dataclass(frozen=True)
class _Accuracy:
    """To what the least gap is found: finely near what is needed, roughly where there is room."""

    needed: float  # mm
    resolution: float  # mm
    share: float  # of the room

    def spare(self, gap: float) -> float:
        """What the least gap may be below the least that was seen, mm."""
        return max(self.resolution, self.share * (gap - self.needed))


def _search(approach: _Approach, best: _Best, accuracy: _Accuracy, most: float) -> bool:
    """Lower `best` to the least gap of an approach; what is not looked at cannot be less than best less what is to spare.

    False where more than `most` stretches are in question at once: then nothing is said.
    """
    import shapely

    shapely.prepare(approach.home)
    span = float(approach.path[-1])
    half = span / 2 / _START
    middle: Floats = np.linspace(half, span - half, _START)
    if span < AT_REST:
        middle = np.array([span / 2])
        half = span / 2
    chunk = max(_BATCH // len(approach.coordinates), 1)
    while len(middle):
        if len(middle) > most:
            return False
        least = best.gap
        rivals = []
        for low in range(0, len(middle), chunk):
            rivals.append(_lowered(approach, best, accuracy, middle[low : low + chunk], half))
            if best.gap <= -approach.allowed:
                return True
        if span < AT_REST or (
            best.gap < least and approach.slides_clear(best.gap - accuracy.spare(best.gap))
        ):
            break
        middle = np.concatenate(rivals)
        half = half / 2
        middle = np.sort(np.concatenate([middle - half, middle + half]))
    return True


def _lowered(
    approach: _Approach, best: _Best, accuracy: _Accuracy, places: Floats, half: float
) -> Floats:
    """Lower `best` by stretches of half a length about some places of the path; those that may hold a lower gap still."""

    def reach(half: float) -> float:
        """How near the guest as it is placed must come for a gap to be lower than `best` by what is to spare."""
        spare = accuracy.spare(best.gap)
        return best.gap - spare + approach.allowed + approach.facets + approach.pad + half

    looks = approach.looks(places, half)
    theta = looks.theta
    half += looks.off
    guests = _moved(approach.guest, approach.coordinates, looks.turns, looks.shifts)
    best.evaluations += len(theta)
    first = best.gap
    # What is not even near now cannot lower `best` either, for it only falls.
    near = approach.within(
        guests, np.arange(len(theta)), max(reach(half), reach(accuracy.spare(best.gap) / 2))
    )
    rivals = near
    k = len(theta) // 2
    while True:  # each round measures one, and keeps those that are nearer still
        gap = approach.gap(guests[k])
        if gap < best.gap:
            best.gap = gap
            best.theta = float(theta[k])
        if best.gap <= -approach.allowed:
            return places[:0]
        rivals = approach.within(guests, rivals[rivals != k], reach(accuracy.spare(best.gap) / 2))
        if not len(rivals):
            break
        k = int(rivals[len(rivals) // 2])
    if best.gap < first or half < accuracy.spare(best.gap) / 2:
        near = approach.within(guests, near, reach(half))
    return places[near]


def _settle(approach: _Approach, best: _Best, accuracy: _Accuracy) -> None:
    """Lower `best` to the least gap of an approach, by way of a simpler guest or pieces of it where that is less work."""
    if approach.empty or best.gap <= -approach.allowed:
        return
    if approach.slides_clear(best.gap - accuracy.spare(best.gap)):
        return
    if _search(approach, best, accuracy, _MANY if approach.divisible else math.inf):
        return
    if not _search_about(approach, best, accuracy):
        for part in approach.divided():
            _settle(part, best, accuracy)


def _search_about(approach: _Approach, best: _Best, accuracy: _Accuracy) -> bool:
    """The same with the disc round the guest in its place; False, and nothing is said, where that is not as near as it is."""
    import shapely

    disc = approach.round()
    outer = _Best()
    if disc is None or not _search(disc, outer, accuracy, _MANY) or outer.gap <= accuracy.needed:
        return False
    guest = approach.placed(np.array([outer.theta]))[0]
    true = float(shapely.distance(approach.home, guest)) - approach.allowed
    best.evaluations += outer.evaluations
    if true - approach.facets > outer.gap + accuracy.resolution:
        return False
    if outer.gap < best.gap:
        best.gap = outer.gap
        best.theta = outer.theta
    return True


def sweep_clearances(
    bodies: Sequence[Body],
    contacts: Mapping[Pair, float],
    needed: float = 0.0,
    turn: tuple[float, float] = (0.0, math.tau),
    resolution: float = RESOLUTION,
    mounted: float | None = None,
) -> list[Clearance]:
    """Clearance of every pair of bodies with heights in common, over the whole turn, or several.

    What is meant to touch is looked at over the first turn: how it touches, its joint is judged by.

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
    sections = [sections_of(body) for body in bodies]
    whole = np.linspace(*turn, GRID + 1)
    first = np.linspace(turn[0], min(turn[1], turn[0] + math.tau), GRID + 1)
    motion_of = functools.cache(
        lambda home, guest, touching: Motion(home, guest, first if touching else whole)
    )  # bodies on one course move as one
    within = functools.cache(covered)
    clearances = []
    for (a, first_sections), (b, second_sections) in itertools.combinations(
        zip(bodies, sections, strict=True), 2
    ):
        level = [
            (first, second)
            for first, second in itertools.product(first_sections, second_sections)
            if min(first.z1, second.z1) - max(first.z0, second.z0) > _SAME_HEIGHT
        ]
        if level:
            level = _widest(level, within) if len(level) <= _LAYERS else level
            pair = frozenset((a.name, b.name))
            touching = pair in contacts
            motions = (
                motion_of(a.course, b.course, touching),
                motion_of(b.course, a.course, touching),
            )
            allowed = contacts.get(pair, mounted if motions[0].at_rest else None)
            try:
                best, proven = _least(motions, level, allowed, needed, resolution)
            except ValueError as fault:
                raise ValueError(f"{a.name} and {b.name}: {fault}") from None
            clearances.append(
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
    return clearances


def _least(
    motions: tuple[Motion, Motion],
    level: Sequence[tuple[Section, Section]],
    allowed: float | None,
    needed: float,
    resolution: float,
) -> tuple[_Best, float]:
    """Smallest gap of a pair's sections, and the one that is proven."""
    best = _Best()
    floor = -(allowed or 0.0)
    accuracy = (
        _Accuracy(needed, resolution, _SHARE)
        if allowed is None
        else _Accuracy(-allowed, min(resolution, allowed / 4), _TOUCHING)
    )
    stack = [list(level)]
    while stack:
        pairs = stack.pop()
        if len(pairs) <= _LAYERS:
            for first, second in pairs:
                _settle(_facing(motions, first, second, -floor), best, accuracy)
            continue
        first, second = (
            shadow_of(tuple(dict.fromkeys(sections))) for sections in zip(*pairs, strict=True)
        )
        whole = _Best()
        approach = _facing(motions, first, second, -floor)
        clear = _search(approach, whole, accuracy, _LONG) and whole.gap > max(accuracy.needed, 0.0)
        best.evaluations += whole.evaluations
        if not clear:
            stack += [pairs[len(pairs) // 2 :], pairs[: len(pairs) // 2]]
        elif whole.gap < best.gap:
            best.gap = whole.gap
            best.theta = whole.theta
    if best.gap > floor:
        if math.isinf(best.gap):
            return _Best(floor), floor
        return best, best.gap - accuracy.spare(best.gap)
    count = 1 if motions[0].at_rest else _DEPTHS
    theta = np.sort(
        np.append(
            np.linspace(motions[0].theta[0], motions[0].theta[-1], count, endpoint=False),
            best.theta,
        )
    )
    depth, best.theta = _deepest(
        [(motions[0], first.area, second.area, theta) for first, second in level], best.theta
    )
    best.gap = -depth
    best.evaluations += len(theta)
    return best, best.gap - resolution


def _widest(level: Sequence[Facing], within: Callable[[Section, Section], bool]) -> list[Facing]:
    """Pairs less those of sections that lie within another pair's, and so are no nearer: those of a cam's mark."""
    pairs = list(level)
    for first, second in level:
        if any(
            within(first, a) and within(second, b) for a, b in pairs if (a, b) != (first, second)
        ):
            pairs.remove((first, second))
    return pairs


def _facing(
    motions: tuple[Motion, Motion], first: Section, second: Section, allowed: float
) -> _Approach:
    """Two sections for the search; the guest is the one that is looked at with less work."""

    def approach(motion: Motion, home: Section, guest: Section) -> _Approach:
        import shapely

        body = shrunk(home, allowed / 2)
        facets = home.facets + guest.facets
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

    approaches = approach(motions[0], first, second), approach(motions[1], second, first)
    return min(approaches, key=lambda each: len(each.coordinates) * (1 + each.path[-1]))


def _deepest(
    overlaps: Sequence[tuple[Motion, Any, Any, Floats]], theta: float
) -> tuple[float, float]:
    """Diameter of the largest circle in the overlaps of a home and a guest at the angles given, mm, and its angle.

    A circle fits where both, shrunk by its radius, still meet.
    """
    import shapely

    def deeper(depth: float) -> list[tuple[Motion, Any, Any, Floats]]:
        meeting = []
        for motion, home, guest, angles in overlaps:
            a = home.buffer(-depth / 2)
            b = guest.buffer(-depth / 2)
            if not (a.is_empty or b.is_empty):
                shapely.prepare(a)
                meet = angles[
                    shapely.intersects(
                        a, _moved(b, shapely.get_coordinates(b) @ PLANE, *motion.at(angles))
                    )
                ]
                if len(meet):
                    meeting.append((motion, home, guest, meet))
        return meeting

    low = 0.0
    high = RESOLUTION
    while overlaps_left := deeper(high):
        overlaps = overlaps_left
        low = high
        high = 2 * high
        theta = float(overlaps[0][3][0])
    while high - low > RESOLUTION / 10:
        middle = (low + high) / 2
        if overlaps_left := deeper(middle):
            overlaps = overlaps_left
            low = middle
            theta = float(overlaps[0][3][0])
        else:
            high = middle
    return low, theta


def interference(
    clearances: Sequence[Clearance], needed: float, angle: str = "cam angle", turns: int = 1
) -> list[Finding]:
    """INTERFERENCE: each pair that comes too near or is not proven to stay clear, else the tightest of either kind.

    Of bodies that must stay apart the gap, at least the needed one, mm; of bodies that touch by design the overlap, at most
    what facets and fits may show. angle: what theta is called; turns: of it, that were swept.
    """
    swept = "the whole turn" if turns == 1 else f"all {turns} turns"
    proven = f"proven for {swept}, not only the samples"
    findings = []
    apart = [(c.proven - needed, c) for c in clearances if c.allowed is None]
    touching = [(c.proven + c.allowed, c) for c in clearances if c.allowed is not None]
    for c in _worst(apart):
        words = (
            f"smallest gap seen {c.gap:z.4f} mm"
            if c.gap > 0
            else f"they overlap by {abs(c.gap):z.4f} mm or more"
        )
        remark = f"nearest of {counted(len(apart), 'pair')} that must stay apart; {words}; {proven}"
        findings.append(
            at_least("INTERFERENCE", c.proven, needed, "mm", _place(c, "gap", angle), remark)
        )
    for c in _worst(touching):
        words = f"overlap seen {max(0.0, -c.gap):z.4f} mm"
        pairs = f"deepest of {counted(len(touching), 'pair')} that touch by design"
        remark = f"{pairs}; {words}; {'as they stand at theta = 0' if c.standing else proven}"
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
