"""Any outline drives any outline: where the driven body can be, exact for arcs and lines, proven between the samples.

    driver      the body that moves as it is told; its pose is seen from the driven body's pivot, or from its slide's origin
    driven      the body with one freedom phi: it turns about its origin, or slides along a line; rad or mm
    free        phi at which the two do not overlap
    low, high   ends of the free interval that is followed from the start; nan where nothing bounds it on that side
    play        high less low
    path        a phi that is free at each pose; linear between its nodes, and free all the way there
    jump        a bound that leaves its obstacle and goes to the next one: an impact where a spring holds the body on it
    locked      nothing is free

At a pose, `low` and `high` are the roots next to the path among all touches of all pairs of features (`pair_events`); which pairs
can touch is `pair_search`'s. The path is laid ahead as a parabola through what lies behind, and proven backwards: the driver is
grown by as much as its features come nearer to the driven body until the next pose. What then is free stays free until there,
so no tooth is skipped, however thin. Where the proof fails the next path is shorter, then the step is halved, down to a
sixteenth; steps beyond are told as not proven.

    pair = OutlinePair(driver, driven, pivots_apart(60.0))
    motion = pair.follow(theta, start=0.0)       the free interval at growing theta
    motion.bounds(other)                         at any theta between
    motion.touch(theta, "low")                   contact point, normal, d phi / d theta, pressure angle
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import product
from typing import Any, Literal

import numpy as np

from camgen.geometry.rings import Floats, Ints, Points, Ring
from camgen.judge.pair_events import Events, Freedom, Turn, touches
from camgen.judge.pair_features import EVERYWHERE, Features, Heights, features
from camgen.judge.pair_search import Bodies, Poses, greatest_way, nearing, partners
from camgen.numerics import coordinates, least_squares

# place, mm, complex, and angle, rad, of the driver over theta, or their derivatives, each (n,)
Pose = Callable[[Floats, int], tuple[Points, Floats]]
Rest = Literal["low", "high", "play"]
Window = tuple[Floats | float, Floats | float]  # below and above

_BLOCK = 16
_BATCH = 64  # blocks at once
_LONGEST = 1024  # poses of a path that is laid ahead
_FINEST = 4  # halvings of a step
_WINDOW = 2.0  # of the play, in which bounds are looked for
_STAND_OFF = (
    0.05  # rad, or share of the driver's reach on a slide, of a path from a single obstacle
)
_FACETS = 1e-4  # mm, of outlines whose overlap is measured as an area
_NO_OVERLAP = 4e-4  # mm, mean width of an overlap that facets may feign


def pivots_apart(distance: complex, rates: tuple[float, float] = (1.0, 0.0)) -> Pose:
    """A driver that turns about its origin; the driven body's pivot lies at `distance` from it at theta = 0, mm.

    rates: of the driver and of what carries both pivots, rad for one of theta.
    """
    spin, carried = rates

    def pose(theta: Floats, order: int) -> tuple[Points, Floats]:
        place = -complex(distance) * (1j * carried) ** order * np.exp(1j * carried * theta)
        if order == 0:
            return place, spin * theta
        return place, np.full(theta.shape, spin * (order == 1))

    return pose


@dataclass(frozen=True)
class _Area:
    """What an outer outline encloses, or what holes leave open, in facets, and the heights between which it is so."""

    polygon: Any  # of shapely
    hole: bool
    low: float
    high: float

    def moved(self, turn: complex, place: complex) -> _Area:
        """The same turned about the origin, then shifted."""
        import shapely

        def there(points: Floats) -> Floats:
            z = place + turn * (points[:, 0] + 1j * points[:, 1])
            return coordinates(z)

        return replace(self, polygon=shapely.transform(self.polygon, there))


@dataclass(frozen=True)
class Body:
    """Outlines of one body: rings with material on the left, mm, and the heights between which each is there."""

    rings: Sequence[Ring]
    heights: Sequence[Heights] = ()

    @cached_property
    def features(self) -> Features:
        """What can be touched first."""
        return features(self.rings, self.heights)

    @cached_property
    def areas(self) -> list[_Area]:
        """Each outer outline, and all holes of one height together: between them is material."""
        import shapely

        solid = []
        holes: dict[Heights, list[Any]] = {}
        for k, ring in enumerate(self.rings):
            z = ring.facetted(_FACETS)
            area = shapely.make_valid(shapely.Polygon(coordinates(z)))
            span = self.heights[k] if self.heights else EVERYWHERE
            if ring.area > 0:
                solid.append(_Area(area, False, *span))
            else:
                holes.setdefault(span, []).append(area)
        opened = (_Area(shapely.union_all(each), True, *span) for span, each in holes.items())
        areas = [*solid, *opened]
        shapely.prepare([area.polygon for area in areas])
        return areas

    @cached_property
    def corners(self) -> int:
        """How many its areas have."""
        import shapely

        return sum(int(shapely.get_num_coordinates(area.polygon)) for area in self.areas)


@dataclass(frozen=True)
class Bounds:
    """Where the driven body is free, each (n,).

    low, high: rad or mm, nan where open, or locked. free: whether anything is. proven: that the path is free from the sample before.
    low_pair, high_pair: (n, 2) features that touch there, driver's and driven body's, -1 where none do.
    """

    theta: Floats
    low: Floats
    high: Floats
    free: np.ndarray
    proven: np.ndarray
    low_pair: Ints
    high_pair: Ints

    @property
    def play(self) -> Floats:
        """High less low, nan where a side is open or nothing is free."""
        return self.high - self.low


@dataclass(frozen=True)
class Touch:
    """The contact at a bound, each (n,), nan where there is none: point, mm from the driven body's pivot; the driven body's
    outward normal; d phi / d theta; pressure angle between the push and the way of the driven body's point, rad."""

    point: Points
    normal: Points
    slope: Floats
    pressure_angle: Floats
    lever: Floats  # way of the driven body along the normal per unit of phi, mm


@dataclass(frozen=True)
class Jump:
    """A bound that leaves its obstacle: at which theta, rad, and where it was and is, rad or mm."""

    theta: float
    before: float
    after: float


@dataclass(frozen=True)
class OutlinePair:
    """A driver and what it drives.

    pose: of the driver, seen from the driven body's pivot. overlap: mm, by which both may overlap: pairs without clearance; below 0
    by how much they must be apart.
    rest: the bound on which a spring holds the driven body; "play": none.
    """

    driver: Body
    driven: Body
    pose: Pose
    freedom: Freedom = field(default_factory=Turn)
    overlap: float = 0.0
    rest: Rest = "play"

    @cached_property
    def bodies(self) -> Bodies:
        """Features of both."""
        return Bodies(self.driver.features, self.driven.features, self.freedom)

    @cached_property
    def stand_off(self) -> float:
        """How far the path keeps off a single obstacle, rad or mm."""
        slides = not self.freedom.period < math.inf
        return _STAND_OFF * (self.bodies.a.far if slides else 1.0)

    def follow(self, theta: Floats, start: float = 0.0) -> PairMotion:
        """The free interval at growing theta, (n,), from the one nearest to `start` at the first of them at which any is free."""
        return _Following(self, theta, start).run()

    def centre(self, low: float, high: float) -> float:
        """A phi well inside the interval."""
        if math.isnan(low) and math.isnan(high):
            return math.nan
        if math.isnan(high):
            return low + self.stand_off
        if math.isnan(low):
            return high - self.stand_off
        half = (high - low) / 2
        if self.rest == "high" or (self.rest == "play" and half > self.stand_off):
            return high - min(half, self.stand_off)
        return low + min(half, self.stand_off)

    def poses(self, theta: Floats, guess: Floats, window: Window) -> Poses:
        """The driver at growing theta, (n,), and the guess, linear between."""
        place, angle = self.pose(theta, 0)
        velocity, spin = self.pose(theta, 1)
        bend, twist = self.pose(theta, 2)
        step = np.append(np.diff(theta), 0.0)
        slope = np.append(np.diff(guess), 0.0) / np.where(step > 0, step, 1.0)
        turning = np.abs(slope) * float(self.freedom.period < math.inf)
        reach = self.bodies.a.far
        bent = np.abs(bend) + np.abs(twist) * reach + (np.abs(spin) + turning) ** 2 * reach
        bent = bent + turning**2 * np.abs(place) + 2 * turning * np.abs(velocity)
        below, above = (np.broadcast_to(each, theta.shape) for each in window)
        return Poses(
            place, np.exp(1j * angle), velocity, spin, bent, guess, slope, step, below, above
        )

    def measured(
        self, theta: Floats, guess: Floats, window: Window, prove: bool = True
    ) -> tuple[Bounds, np.ndarray, np.ndarray]:
        """Bounds next to a guess that is free; whether the guess stays free until the next pose; and whether a bound is missed.

        window: how far below and above the guess bounds are looked for, what lies farther is missed; inf: everywhere.
        """
        poses = self.poses(theta, guess, window)
        count = len(theta)
        bounds = Bounds(
            theta,
            np.full(count, np.nan),
            np.full(count, np.nan),
            np.ones(count, bool),
            np.ones(count, bool),
            np.full((count, 2), -1),
            np.full((count, 2), -1),
        )
        ahead = np.ones(count, bool)
        missed = np.zeros(count, bool)
        wide = self.bodies.wide(poses)
        for chosen, batch in ((~wide, _BATCH), (wide, _BATCH // 16)):
            places = np.flatnonzero(chosen)
            for k in range(0, len(places), _BLOCK * batch):
                rows = places[k : k + _BLOCK * batch]
                self._batch(poses.take(rows), rows, bounds, ahead, missed, prove)
        return bounds, ahead, missed

    def _batch(
        self,
        poses: Poses,
        rows: Ints,
        bounds: Bounds,
        ahead: np.ndarray,
        missed: np.ndarray,
        prove: bool,
    ) -> None:
        """Write the bounds of some poses, and what is told of them, into these rows."""
        count = len(poses.guess)
        size = min(_BLOCK, count)
        poses = poses.padded(-count % size)
        growth = greatest_way(self.bodies, poses) if prove else 0.0
        growth = growth + abs(self.overlap)
        pairs = partners(self.bodies, poses, size, growth, -self.overlap)
        met, pose, events = touches(pairs, self.freedom)
        couples = np.vstack([np.column_stack([met.i, met.j]), np.full(2, -1)])
        for values, found, sense, window in (
            (bounds.low, bounds.low_pair, -1, poses.below),
            (bounds.high, bounds.high_pair, 1, poses.above),
        ):
            value, which = _next(events, pose, poses.guess, self.freedom, sense)
            lost = ~(sense * (value - poses.guess) <= window)
            which[lost] = -1
            values[rows] = np.where(lost, np.nan, value)[:count]
            found[rows] = couples[which[:count]]
            missed[rows] |= (lost & (window < math.inf))[:count]
        if prove:
            touched = nearing(pairs, poses, self.freedom, growth)
            ahead[rows[touched[touched < count]]] = False

    def touch(self, bounds: Bounds, side: Literal["low", "high"]) -> Touch:
        """Contact at one of the bounds."""
        pairs = bounds.low_pair if side == "low" else bounds.high_pair
        phi = bounds.low if side == "low" else bounds.high
        return _touch(self, bounds.theta, phi, pairs)

    def cells(self, theta: float, near: float, window: float) -> list[tuple[float, float]]:
        """Intervals of phi between touches that may be free, nearest first; an open side is infinite."""
        poses = self.poses(np.array([theta]), np.array([near]), (window, window))
        pairs = partners(self.bodies, poses, 1, abs(self.overlap), -self.overlap)
        _, _, events = touches(pairs, self.freedom)
        period = self.freedom.period
        phi = events.phi
        if period < math.inf:
            phi = (phi - near + period / 2) % period + near - period / 2
        order = np.lexsort((events.closing, phi))
        phi = phi[order]
        closing = events.closing[order]
        if not len(phi):
            return [(-math.inf, math.inf)]
        if period < math.inf:
            phi = np.concatenate([phi[-1:] - period, phi, phi[:1] + period])
            closing = np.concatenate([closing[-1:], closing, closing[:1]])
        else:
            phi = np.concatenate([[-math.inf], phi, [math.inf]])
            closing = np.concatenate([[False], closing, [True]])
        at = np.flatnonzero(~closing[:-1] & closing[1:] & (phi[1:] > phi[:-1]))
        found = [(float(phi[k]), float(phi[k + 1])) for k in at]
        return sorted(found, key=lambda cell: max(cell[0] - near, near - cell[1], 0.0))

    def overlaps(self, theta: float, phi: float) -> bool:
        """Whether both overlap at a pose, by the area of what they share, but for what facets feign."""
        (place,), (angle,) = self.pose(np.array([theta]), 0)
        back = np.conj(self.freedom.turned(np.array([phi]))[0])
        # the driver as the driven body sees it, or the other way round: what has fewer corners is moved
        turn = complex(np.exp(1j * angle) * back)
        place = complex((place - self.freedom.moved(np.array([phi]))[0]) * back)
        drivers = self.driver.areas
        driven = self.driven.areas
        if self.driver.corners <= self.driven.corners:
            drivers = [area.moved(turn, place) for area in drivers]
        else:
            driven = [area.moved(1 / turn, -place / turn) for area in driven]
        return any(
            _shared_width(a, b) > _NO_OVERLAP + self.overlap
            for a, b in product(drivers, driven)
            if a.low < b.high and b.low < a.high
        )

    def component(self, theta: float, near: float, window: float) -> tuple[float, float] | None:
        """The free interval nearest to a phi, None where there is none; nan where open."""
        for low, high in self.cells(theta, near, window)[:_MOST_CELLS]:
            open_low = math.nan if math.isinf(low) else low
            open_high = math.nan if math.isinf(high) else high
            middle = self.centre(open_low, open_high)
            if not self.overlaps(theta, near if math.isnan(middle) else middle):
                return open_low, open_high
        return None


_MOST_CELLS = 60  # that are tried for one start


def _shared_width(first: _Area, second: _Area) -> float:
    """Mean width of what two areas share, mm; 0 where they share nothing."""
    import shapely

    inner = first.polygon
    outer = second.polygon
    if first.hole:
        inner, outer = outer, inner
    # most share nothing, which a prepared polygon tells soon
    if first.hole or second.hole:
        if shapely.covers(outer, inner):
            return 0.0
        shared = shapely.difference(inner, outer)
    else:
        if shapely.is_prepared(outer):
            inner, outer = outer, inner
        if not shapely.intersects(inner, outer):
            return 0.0
        shared = shapely.intersection(inner, outer)
    return 2 * shared.area / shared.length if shared.area > 0 else 0.0


def _next(
    events: Events, pose: Ints, reference: Floats, freedom: Freedom, sense: int
) -> tuple[Floats, Ints]:
    """Of each pose the next touch from a reference, upwards the closing ones, downwards the others; and its meeting, -1 for none."""
    kept = np.flatnonzero(events.closing == (sense > 0))
    index = events.index[kept]
    at = pose[index]
    phi = events.phi[kept]
    base = reference[at]
    if freedom.period < math.inf:
        way = (sense * (phi - base)) % freedom.period
        phi = base + sense * way
    else:
        way = sense * phi
        inside = np.flatnonzero(sense * (phi - base) >= 0)
        at = at[inside]
        index = index[inside]
        phi = phi[inside]
        way = way[inside]
    order = np.lexsort((way, at))
    at = at[order]
    first = np.ones(len(at), bool)
    first[1:] = at[1:] != at[:-1]
    chosen = order[first]
    found = np.full(len(reference), np.nan)
    which = np.full(len(reference), -1)
    found[at[first]] = phi[chosen]
    which[at[first]] = index[chosen]
    return found, which


class _Following:
    """Work in progress: the path up to a cursor, and what is known there."""

    def __init__(self, pair: OutlinePair, theta: Floats, start: float) -> None:
        count = len(theta)
        self.pair = pair
        self.theta = theta
        self.start = start
        self.low = np.full(count, np.nan)
        self.high = np.full(count, np.nan)
        self.free = np.zeros(count, bool)
        self.proven = np.zeros(count, bool)
        self.low_pair = np.full((count, 2), -1)
        self.high_pair = np.full((count, 2), -1)
        self.nodes: list[Floats] = []  # theta of the path
        self.path: list[Floats] = []
        self.past = np.zeros((0, 2))  # theta and centre of what lies behind the cursor
        self.unproven = 0
        # cursor: sample, step of it in 2 ** halvings, interval
        self.sample = 0
        self.fraction = 0
        self.halvings = 0
        self.interval = (math.nan, math.nan)
        self.length = 1
        self.wide = False  # the path stands still, and bounds are looked for everywhere

    def run(self) -> PairMotion:
        """Follow to the end."""
        self._begin()
        while self.sample < len(self.theta) - 1:
            if not self._advanced():
                self._hesitate()
        bounds = Bounds(
            self.theta,
            self.low,
            self.high,
            self.free,
            self.proven,
            self.low_pair,
            self.high_pair,
        )
        nodes = np.concatenate(self.nodes) if self.nodes else np.zeros(0)
        path = np.concatenate(self.path) if self.path else np.zeros(0)
        return PairMotion(self.pair, bounds, nodes, path)

    def _begin(self) -> None:
        """The first sample at which something is free; none where a sparse look round finds nothing."""
        last = len(self.theta) - 1
        self.sample = -1
        if self._resumed(self.start):
            return
        looks = np.unique(np.linspace(0, last, _LOOKS).astype(int))
        if not any(
            self.pair.component(float(self.theta[k]), self.start, math.inf) is not None
            for k in looks[1:]
        ):
            self.sample = last
            return
        while self.sample < last and not self._resumed(self.start):
            pass

    def _resumed(self, near: float) -> bool:
        """Whether something is free at the next sample, looked for without a path that leads there; the cursor is there then."""
        self.sample += 1
        self.fraction = 0
        self.halvings = 0
        self.length = 1
        theta = float(self.theta[self.sample])
        cell = self.pair.component(theta, near, math.inf)
        if cell is None:
            self.nodes.append(np.array([theta]))
            self.path.append(np.array([math.nan]))
            return False
        self._stand(theta, cell)
        return True

    def _stand(self, theta: float, cell: tuple[float, float]) -> None:
        """Begin anew from a free interval."""
        centre = self.pair.centre(*cell)
        centre = self.start if math.isnan(centre) else centre
        window = (math.inf, math.inf)
        bounds, _, _ = self.pair.measured(np.array([theta]), np.array([centre]), window, False)
        self._keep(bounds, np.array([0]), np.array([self.sample]))
        self.proven[self.sample] = False
        self.past = self._tangent(bounds, theta, centre)
        self.nodes.append(np.array([theta]))
        self.path.append(np.array([centre]))
        self.interval = (float(bounds.low[0]), float(bounds.high[0]))

    def _tangent(self, bounds: Bounds, theta: float, centre: float) -> Floats:
        """Two points of a path whose slope is that of the bounds, the second one at the cursor."""
        slopes = [
            float(_touch(self.pair, bounds.theta, phi, pairs).slope[0])
            for phi, pairs in ((bounds.low, bounds.low_pair), (bounds.high, bounds.high_pair))
        ]
        finite = [slope for slope in slopes if math.isfinite(slope)]
        slope = sum(finite) / len(finite) if finite else 0.0
        return np.array([[theta - _BACK, centre - slope * _BACK], [theta, centre]])

    def _keep(self, bounds: Bounds, rows: Ints, samples: Ints) -> None:
        self.low[samples] = bounds.low[rows]
        self.high[samples] = bounds.high[rows]
        self.free[samples] = True
        self.proven[samples] = True
        self.low_pair[samples] = bounds.low_pair[rows]
        self.high_pair[samples] = bounds.high_pair[rows]

    def _advanced(self) -> bool:
        """Lay a path ahead, keep what of it is proven, and tell whether anything is."""
        parts = 2**self.halvings
        begin = self.sample * parts + self.fraction
        most = min(begin + self.length, (len(self.theta) - 1) * parts)
        place = np.arange(begin, most + 1)
        k = place // parts
        share = (place % parts) / parts
        theta = self.theta[k] + share * (
            self.theta[np.minimum(k + 1, len(self.theta) - 1)] - self.theta[k]
        )
        guess = self._ahead(theta)
        bounds, ahead, missed = self.pair.measured(theta, guess, self._window(float(guess[0])))
        stops = np.flatnonzero(~ahead[:-1] | missed[1:])
        kept = int(stops[0]) if len(stops) else len(theta) - 1
        if kept == 0:
            return False
        rows = np.arange(1, kept + 1)
        whole = rows[place[1 : kept + 1] % parts == 0]
        self._keep(bounds, whole, k[whole])
        self.nodes.append(theta[: kept + 1])
        self.path.append(guess[: kept + 1])
        centres = np.array(
            [
                self.pair.centre(low, high)
                for low, high in zip(
                    bounds.low[rows].tolist(), bounds.high[rows].tolist(), strict=True
                )
            ]
        )
        centres = np.where(np.isnan(centres), guess[rows], centres)
        behind = self.past[-1:] if self.wide else self.past
        self.past = np.vstack([behind, np.column_stack([theta[rows], centres])])[-_LONGEST:]
        self.interval = (float(bounds.low[kept]), float(bounds.high[kept]))
        self.sample = int(k[kept])
        self.fraction = int(place[kept] % parts)
        complete = kept == len(theta) - 1
        self.length = min(2 * self.length, _LONGEST) if complete else max(kept, 1)
        self.wide = False
        if complete and self.fraction == 0:
            self.halvings = max(self.halvings - 1, 0)
        return True

    def _ahead(self, theta: Floats) -> Floats:
        """The path through the cursor, (n,): a parabola through as many of the centres behind as it goes ahead, or standing still."""
        past = self.past[-1:] if self.wide else self.past[-max(self.length, 3) :]
        origin = theta[0]
        scale = max(float(origin - past[0, 0]), 1e-12)
        degree = min(len(past), 3)
        x = (past[:, 0] - origin) / scale
        table = np.column_stack([x**order for order in range(degree)])
        factors = least_squares(table, past[:, 1])
        y = (theta - origin) / scale
        guess = sum(factors[order] * y**order for order in range(degree))
        centre = self.pair.centre(*self.interval)
        guess = np.array(guess + np.zeros(len(theta)))
        guess[0] = guess[0] if math.isnan(centre) else centre
        return guess

    def _window(self, guess: float) -> tuple[float, float]:
        """How far from the path bounds are looked for."""
        low, high = self.interval
        if self.wide or math.isnan(low) or math.isnan(high):
            return math.inf, math.inf
        below = _WINDOW * (guess - low)
        above = _WINDOW * (high - guess)
        if self.freedom_period - below - above < 0:
            return math.inf, math.inf
        return below, above

    @property
    def freedom_period(self) -> float:
        """After which the driven body stands as before."""
        return self.pair.freedom.period

    def _hesitate(self) -> None:
        """After a path that is not proven: a shorter one, one that stands still in a wider window, both with a shorter step; then
        look anew."""
        if self.length > 1:
            self.length = max(self.length // 8, 1)
        elif not self.wide:
            self.wide = True
        elif self.halvings < (_FINEST if self.unproven < _PATIENCE else 0):
            self.halvings += 1
            self.fraction *= 2
            self.wide = False
        else:
            self.unproven += 1
            while not self._resumed(self._estimate()) and self.sample < len(self.theta) - 1:
                pass

    def _estimate(self) -> float:
        """Where the driven body may be at the next sample."""
        return float(self.past[-1, 1])


_LOOKS = 25  # samples at which anything free is looked for
_JUMP = 2e-4  # rad, or share of the driver's reach on a slide, of a bound within a step
_HALVINGS = 40
_SPARE = 0.1  # of the play, by which bounds between samples may lie beyond theirs before they are looked for farther
_LOST = 5.0  # times the slope beside it, from which one may be that of a lever that goes to 0
_BACK = 1e-3  # rad
_PATIENCE = 60  # steps that are not proven, after which none is halved any more


@dataclass(frozen=True)
class PairMotion:
    """The free interval over theta; nodes and path: theta, (m,), and a phi that is free there, nan where nothing is."""

    pair: OutlinePair
    samples: Bounds
    nodes: Floats
    path: Floats

    def bounds(self, theta: Floats) -> Bounds:
        """The free interval at growing angles between the first and the last sample, (n,)."""
        guess = np.interp(theta, self.nodes, self.path)
        lost = np.isnan(guess)
        if lost.all():
            nothing = np.full((len(theta), 2), -1)
            return Bounds(theta, guess, guess, ~lost, ~lost, nothing, nothing)
        known = np.where(lost, 0.0, guess)
        low = np.full(len(theta), np.nan)
        high = low.copy()
        low_pair = np.full((len(theta), 2), -1)
        high_pair = low_pair.copy()
        rows = np.flatnonzero(~lost)
        most = (self._most_play, self._most_play)
        for window in (self._near(theta, guess), most, (math.inf, math.inf)):
            below, above = (np.broadcast_to(each, theta.shape)[rows] for each in window)
            found, _, missed = self.pair.measured(theta[rows], known[rows], (below, above), False)
            low[rows] = found.low
            high[rows] = found.high
            low_pair[rows] = found.low_pair
            high_pair[rows] = found.high_pair
            rows = rows[missed]
            if not len(rows):
                break
        return Bounds(theta, low, high, ~lost, ~lost, low_pair, high_pair)

    def _near(self, theta: Floats, guess: Floats) -> Window:
        """How far from a guess bounds are expected: as far as those of the samples on both sides and a share of the play, each (n,)."""
        samples = self.samples
        after = np.clip(np.searchsorted(samples.theta, theta), 1, len(samples.theta) - 1)
        low = np.minimum(samples.low[after - 1], samples.low[after])
        high = np.maximum(samples.high[after - 1], samples.high[after])
        spare = _SPARE * (high - low)
        below = guess - low + spare
        above = high - guess + spare
        known = np.isfinite(spare)
        return (
            np.where(known, below, self._most_play),
            np.where(known, above, self._most_play),
        )

    @cached_property
    def _most_play(self) -> float:
        """Greatest of the samples; inf where a side is open."""
        play = self.samples.play[self.samples.free]
        return float(np.max(play, initial=0.0)) if np.isfinite(play).all() else math.inf

    def touch(self, bounds: Bounds, side: Literal["low", "high"]) -> Touch:
        """Contact at one of the bounds."""
        return self.pair.touch(bounds, side)

    def jumps(self, side: Literal["low", "high"]) -> list[Jump]:
        """Where a bound jumps, found to the last digits between the samples.

        A jump changes it by more than the slopes on both sides explain, and by more than ever two obstacles that meet. Just before a
        drop the lever of what holds the body may go to 0 and its slope beyond all bounds: then the other side's counts.
        """
        bounds = self.samples
        phi = bounds.low if side == "low" else bounds.high
        slope = self.touch(bounds, side).slope
        step = np.diff(bounds.theta)
        steep = np.maximum(np.abs(slope[1:]), np.abs(slope[:-1]))
        change = np.abs(np.diff(phi) - (slope[1:] + slope[:-1]) / 2 * step)
        calm = np.minimum(np.abs(slope[1:]), np.abs(slope[:-1]))
        least = _JUMP * (1.0 if self.pair.freedom.period < math.inf else self.pair.bodies.a.far)
        with np.errstate(invalid="ignore"):
            plain = change > least + 2 * steep * step
            lever_lost = steep > _LOST * np.maximum(calm, 1.0)
            lever_lost &= np.abs(np.diff(phi)) > least + 2 * calm * step
        found = self._halved(np.flatnonzero(plain | lever_lost), side)
        return [each for each in found if abs(each.after - each.before) > least]

    def _halved(self, steps: Ints, side: Literal["low", "high"]) -> list[Jump]:
        """The jumps between some samples and the next ones, by halving all of these steps together."""
        phi = getattr(self.samples, side)
        left, right = (self.samples.theta[k].copy() for k in (steps, steps + 1))
        before, after = (phi[k].copy() for k in (steps, steps + 1))
        for _ in range(_HALVINGS if len(steps) else 0):
            middle = (left + right) / 2
            here = getattr(self.bounds(middle), side)
            later = ~(np.abs(here - before) <= np.abs(here - after))
            right = np.where(later, middle, right)
            left = np.where(later, left, middle)
            after = np.where(later & np.isfinite(here), here, after)
            before = np.where(later, before, here)
        rows = zip(((left + right) / 2).tolist(), before.tolist(), after.tolist(), strict=True)
        return [Jump(*row) for row in rows]


def _touch(pair: OutlinePair, theta: Floats, phi: Floats, pairs: Ints) -> Touch:
    a = pair.bodies.a.take(pairs[:, 0])
    b = pair.bodies.b.take(pairs[:, 1])
    freedom = pair.freedom
    place, angle = pair.pose(theta, 0)
    velocity, spin = pair.pose(theta, 1)
    e = np.exp(1j * angle)
    turn = freedom.turned(phi)
    y = place + e * a.centre
    x = freedom.moved(phi) + turn * b.centre
    total = a.radius + b.radius - pair.overlap
    with np.errstate(divide="ignore", invalid="ignore"):
        normal = np.where(
            a.straight, -e * a.middle, np.where(b.straight, turn * b.middle, (y - x) / total)
        )
    point = np.where(b.straight, y - a.radius * normal, x + b.radius * normal)
    driver = velocity + 1j * spin * (point - place)
    driven = freedom.velocity(point)
    push = np.real(np.conj(normal) * driven)
    slope = np.real(np.conj(normal) * driver) / push
    # the driver pushes against the normal
    pressure = np.angle(-normal * np.conj(driven) * np.sign(-push))
    none = np.isnan(phi)
    return Touch(
        np.where(none, np.nan, point),
        np.where(none, np.nan, normal),
        np.where(none, np.nan, slope),
        np.where(none, np.nan, pressure),
        np.where(none, np.nan, np.abs(push)),
    )


def hollow(ring: Ring) -> Ring:
    """The outline with its material outside: of a hole."""
    return ring.counter_clockwise().reversed()
