"""Followers whose face is an outline of a person's own, of lines and arcs: a shoe on an arm or on a slide.

    pole    instant centre of the follower against its cam, about which it turns for a moment as the cam sees it
    seen    in the shoe's own frame, in which its outline is drawn

The normal of the contact runs through the pole, and out of the shoe towards it. Of a convex outline with the pole outside of it
one point alone has such a normal: the one nearest to the pole. So the edge that touches is the nearest one, and there an arc
makes the cam that a round tip about its centre makes, a corner that of a knife edge, a line that of a flat face, each by the
closed forms of `followers`.

Where the relative turning of follower and cam changes its sense, at ds/dtheta = 1 of one that swings, the pole goes to infinity.
"""

from __future__ import annotations

import cmath
import math
from abc import abstractmethod
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, Self

import numpy as np

from camgen.errors import DesignError
from camgen.geometry.outlines import Arc, Contour, Line, start_point
from camgen.machine.cams.followers import (
    FlatFace,
    Follower,
    Motion,
    OnSlide,
    RoundTip,
    SlidingFace,
    SlidingTip,
    SwingingArm,
    SwingingFace,
)
from camgen.numerics import Floats, Indices, Points, greatest

Edge = Arc | Line
_UP = 1j  # of a shoe on a slide: the way off its cam, in its own frame
_JOINT = 1e-11  # rad or mm, by which edges reach over their ends, so that rounding leaves no gap between them
_OUTSIDE = 1e-9  # mm, by which rounding may put a point on an outline into it
_TOUCHES = 1e-7  # mm, from an outline of what is found to touch it
_CONVEX = 1e-6  # mm, by which an outline may stand out over a tangent
_NOTCH = 0.01  # rad, of a turn inwards that the digits of a drawing may make
_PASSES = 1000


def convex_edges(contour: Contour) -> tuple[Edge, ...]:
    """Edges of an outline in their order, and where it turns outwards between two of them an arc of radius 0, its corner.

    Where two of them turn inwards by next to nothing, since a drawing has so many digits and no more, a common tangent bridges both.
    """
    pieces: list[Edge] = []
    for piece in contour.counter_clockwise().pieces:
        assert isinstance(piece, Arc | Line)
        pieces.append(piece)
    for _ in range(_PASSES):
        notch = next((k for k in range(len(pieces)) if -_NOTCH < _turn(pieces, k) < -_JOINT), None)
        if notch is None:
            break
        pieces = pieces[notch:] + pieces[:notch]  # the notch before the first one
        pieces = [*_bridge(pieces[-1], pieces[0]), *pieces[1:-1]]
    edges: list[Edge] = []
    for k, piece in enumerate(pieces):
        turn = _turn(pieces, k)
        if turn > _JOINT:
            leaving = _heading(pieces[k - 1], pieces[k - 1].t1)
            edges.append(Arc(start_point(piece), 0.0, cmath.phase(-1j * leaving), turn))
        edges.append(piece)
    return tuple(edges)


def _turn(pieces: Sequence[Edge], k: int) -> float:
    """By how much the outline turns outwards before a piece, rad."""
    before = pieces[k - 1]
    return cmath.phase(_heading(pieces[k], pieces[k].t0) / _heading(before, before.t1))


def _bridge(before: Edge, after: Edge) -> list[Edge]:
    """Two edges, of which a line counts by its far end alone, with their common tangent between them."""
    c, r = (before.centre, before.radius) if isinstance(before, Arc) else (before.a, 0.0)
    d, s = (after.centre, after.radius) if isinstance(after, Arc) else (after.b, 0.0)
    normal = (d - c) / abs(d - c) * cmath.rect(1, -math.acos((r - s) / abs(d - c)))
    bridged: list[Edge] = [Line(c + r * normal, d + s * normal)]
    if isinstance(before, Arc):
        less = math.remainder(cmath.phase(normal) - before.t1, math.tau)
        bridged.insert(0, replace(before, sweep=before.sweep + less))
    if isinstance(after, Arc):
        later = math.remainder(cmath.phase(normal) - after.start, math.tau)
        bridged.append(replace(after, start=after.start + later, sweep=after.sweep - later))
    return bridged


def _heading(piece: Edge, t: float) -> complex:
    way = complex(piece.at(t, 1))
    return way * (-1 if piece.t1 < piece.t0 else 1)


def _depth(arc: Arc) -> float:
    """Of the hollow that an arc is, mm."""
    return arc.radius * (1 - math.cos(min(abs(arc.sweep) / 2, math.pi)))


def _hollow(depth: float, where: str, edge: Edge) -> DesignError:
    """Of an outline that is hollow by a depth, mm, on an edge or beside it."""
    middle = complex(edge.at((edge.t0 + edge.t1) / 2))
    return DesignError(
        "geometry.follower.outline",
        depth,
        0.0,
        "mm",
        f"{where}, on its edge at ({middle.real:.3f}, {middle.imag:.3f}) mm",
        "the outline is hollow where the cam would touch it: the rest of it cuts so deep into the cam; "
        "make it convex there",
    )


@dataclass(frozen=True)
class _Arcs:
    """Convex arcs and corners of an outline, (k,) each."""

    centre: Points
    radius: Floats
    start: Floats
    sweep: Floats

    def away(self, points: Points) -> Floats:
        """Distance of points, (..., 1), where a normal of the arc runs through them, below 0 within; inf elsewhere."""
        spoke = points - self.centre
        turned = np.mod(np.angle(spoke) - self.start, math.tau)
        reached = (turned <= self.sweep + _JOINT) | (turned >= math.tau - _JOINT)
        return np.where(reached, np.abs(spoke) - self.radius, np.inf)


@dataclass(frozen=True)
class _Lines:
    """Straight edges of an outline, material on their left, (k,) each."""

    a: Points
    b: Points

    def away(self, points: Points) -> Floats:
        """As `_Arcs.away`."""
        length = np.abs(self.b - self.a)
        place = (points - self.a) * np.conj((self.b - self.a) / length)
        reached = (place.real >= -_JOINT) & (place.real <= length + _JOINT)
        return np.where(reached, -place.imag, np.inf)


@dataclass(frozen=True)
class Shoe(Follower):
    """A shoe with its outline's edges in its own frame, counter-clockwise, as `convex_edges` gives them; hollow arcs never touch."""

    edges: tuple[Edge, ...]

    @abstractmethod
    def pole(self, theta: Any, motion: Motion) -> Points:
        """Instant centre, seen, (n,) complex."""

    @abstractmethod
    def seen(self, s: Any, point: Any) -> Points:
        """A point of the ground, seen, (n,) complex."""

    @abstractmethod
    def part(self, edge: Edge) -> RoundTip | FlatFace:
        """The follower that an edge is by itself."""

    @abstractmethod
    def moved(self, s: float) -> Self:
        """The same where it is at s."""

    @abstractmethod
    def standing(self, part: RoundTip | FlatFace, radius: float) -> float:
        """Displacement at which a part of it touches a circle about the axis, from its leaving side; ValueError where it does not."""

    @cached_property
    def convex(self) -> tuple[Edge, ...]:
        """Edges that can touch: arcs and corners, then lines."""
        arcs = [each for each in self.edges if isinstance(each, Arc) and each.sweep > 0]
        return (*arcs, *(each for each in self.edges if isinstance(each, Line)))

    @cached_property
    def parts(self) -> Sequence[RoundTip | FlatFace]:
        """What each of them is as a follower."""
        return [self.part(edge) for edge in self.convex]

    @cached_property
    def _arcs(self) -> _Arcs:
        arcs = [each for each in self.convex if isinstance(each, Arc)]
        rows = [(each.radius, each.start, each.sweep) for each in arcs]
        centres = np.array([each.centre for each in arcs], complex)
        return _Arcs(centres, *np.array(rows, float).reshape(-1, 3).T)

    @cached_property
    def _lines(self) -> _Lines:
        lines = [each for each in self.convex if isinstance(each, Line)]
        return _Lines(*np.array([(each.a, each.b) for each in lines], complex).reshape(-1, 2).T)

    @cached_property
    def _ends(self) -> Points:
        return np.array([start_point(each) for each in self.edges], complex)

    def _away(self, points: Any) -> Floats:
        """Distances of points from all convex edges, (..., edges)."""
        each = np.asarray(points, complex)[..., None]
        return np.concatenate([self._arcs.away(each), self._lines.away(each)], axis=-1)

    def touched(self, pole: Any) -> Indices:
        """Which convex edge is nearest to a pole outside, (n,)."""
        away = self._away(pole)
        return np.asarray(np.argmin(np.where(away < -_OUTSIDE, np.inf, away), axis=-1))

    def distance(self, points: Any) -> Floats:
        """Distance of points, seen, from the outline, (n,) mm, below 0 within it."""
        away = self._away(points)
        outside = np.min(np.where(away < -_OUTSIDE, np.inf, away), axis=-1)
        within = -np.min(np.abs(away), axis=-1)
        return np.asarray(np.where(np.isinf(outside), within, outside))

    def chosen(
        self, theta: Any, motion: Motion, figure: Callable[[RoundTip | FlatFace], Any]
    ) -> Any:
        """A figure of the part that touches, (n,)."""
        which = self.touched(self.pole(theta, motion))
        found: Any = np.nan
        with np.errstate(all="ignore"):  # of parts that do not touch
            for k in np.unique(which):
                found = np.where(which == k, figure(self.parts[k]), found)
        return found

    def envelope(self, theta: Any, motion: Motion, order: int) -> Points:
        """That of the part that touches."""
        return np.asarray(
            self.chosen(theta, motion, lambda part: part.envelope(theta, motion, order))
        )

    def grown(self, by: float) -> Self:
        """Its outline offset."""
        grown: list[Edge] = []
        for each in self.convex:
            if isinstance(each, Arc):
                grown.append(replace(each, radius=each.radius + by))
            else:
                out = -1j * by * (each.b - each.a) / abs(each.b - each.a)
                grown.append(Line(each.a + out, each.b + out))
        return replace(self, edges=tuple(grown))

    def room(self, theta: Any, motion: Motion) -> Floats:
        """That of the part that touches."""
        return np.asarray(self.chosen(theta, motion, lambda part: part.room(theta, motion)))

    def radius(self, theta: Any, motion: Motion) -> Floats:
        """That of the part that touches."""
        return np.asarray(self.chosen(theta, motion, lambda part: part.radius(theta, motion)))

    def own_radius(self, theta: Any, motion: Motion) -> Floats:
        """Radius of the outline where it touches, mm, (n,): 0 of a corner, inf of a line."""
        radii = np.array(
            [each.radius if isinstance(each, Arc) else math.inf for each in self.convex]
        )
        return np.asarray(radii[self.touched(self.pole(theta, motion))])

    def clear(self, theta: Any, motion: Motion) -> Floats:
        """Distance of the axis from the outline."""
        return self.distance(self.seen(motion(theta, 0), 0j))

    def normal(self, theta: Any, motion: Motion) -> Points:
        """That of the part that touches."""
        return np.asarray(self.chosen(theta, motion, lambda part: part.normal(theta, motion)))

    def normal_on(self, s: Any, point: Any) -> Points:
        """That of the part on which the point lies."""
        which = self.touched(self.seen(s, point))
        found: Any = np.nan
        for k in np.unique(which):
            found = np.where(which == k, self._normal_of(self.parts[k], s, point), found)
        return np.asarray(found)

    @staticmethod
    def _normal_of(part: RoundTip | FlatFace, s: Any, point: Any) -> Points:
        with np.errstate(invalid="ignore"):  # a point on another part
            return part.normal_on(s, point)

    def resting_on(self, point: Any) -> Floats:
        """Displacement at which the shoe, coming in, first touches a point of the ground, (n,); nan out of reach."""
        first: Any = -np.inf
        with np.errstate(all="ignore"):  # of parts that never touch it
            for part in self.parts:
                s = part.resting_on(point)
                near = np.abs(self.distance(self.seen(s, point))) < _TOUCHES
                first = np.maximum(first, np.where(near, s, -np.inf))
        return np.where(np.isinf(first), np.nan, first)

    def on_base(self, radius: float) -> Self:
        """Where it first touches the circle as it comes in; DesignError where only a hollow edge can."""
        found = []
        for part in self.parts:
            try:
                s = self.standing(part, radius)
            except (ValueError, ZeroDivisionError):
                continue
            if abs(float(self.distance(self.seen(s, 0j))) - radius) < _TOUCHES and self._leaves(s):
                found.append(s)
        if found:
            return self.moved(max(found))
        arcs = [each for each in self.edges if isinstance(each, Arc)]
        # a smaller circle lies in a hollow, a larger one on its ends
        hollows = [each for each in arcs if each.sweep < 0 and each.radius >= radius]
        if not hollows:
            raise ValueError("the outline touches no such circle")
        deepest = max(hollows, key=_depth)
        raise _hollow(_depth(deepest), f"a base circle of {radius:g} mm", deepest)

    def _leaves(self, s: float) -> bool:
        """Whether the edge nearest to the axis moves away from it as the follower leaves."""
        normal = self.normal_on(s, np.zeros(1, complex))
        velocity = self.velocity(s, np.zeros(1, complex))
        return bool(self.leaves * np.real(np.conj(normal) * velocity)[0] > 0)

    # ---- what no cam can be made for --------------------------------------------------------------------------------

    def check(self, motion: Motion, marks: Sequence[float]) -> None:
        """DesignError where the outline is hollow at its contact, or no point of it can be the contact; marks: angles between which
        the motion is smooth, rad."""
        low = marks[0]
        high = marks[-1]

        def inside(theta: Any) -> Floats:
            return -self.distance(self.pole(theta, motion))

        def over(theta: Any) -> Floats:
            return self.standing_over(self.pole(theta, motion))

        place, depth = greatest(inside, low, high, marks)
        if depth > _OUTSIDE:
            raise DesignError(
                "geometry.follower.outline",
                depth,
                0.0,
                "mm",
                f"cam angle {math.degrees(place):.3f} deg",
                "there the outline reaches over the point about which it turns against its cam, so that no edge can touch: "
                "use a larger base_radius or a smaller outline",
            )
        place, hollow = greatest(over, low, high, marks)
        if hollow > _CONVEX:
            pole = self.pole(np.asarray(place), motion)
            edge = self.convex[int(self.touched(pole))]
            raise _hollow(hollow, f"cam angle {math.degrees(place):.3f} deg", edge)

    def standing_over(self, pole: Any) -> Floats:
        """By how much the outline stands out over the tangent at the point nearest to a pole, seen, (n,) mm; 0 where it is convex."""
        which = self.touched(pole)
        poles = np.asarray(pole, complex)
        normals = np.empty(poles.shape, complex)
        supports = np.empty(poles.shape)
        for k in np.unique(which):
            here = which == k
            edge = self.convex[k]
            if isinstance(edge, Arc):
                spoke = poles[here] - edge.centre
                normals[here] = spoke / np.abs(spoke)
                supports[here] = np.real(np.conj(normals[here]) * edge.centre) + edge.radius
            else:
                normals[here] = -1j * (edge.b - edge.a) / abs(edge.b - edge.a)
                supports[here] = np.real(np.conj(normals[here]) * edge.a)
        across = np.conj(normals)[..., None]
        arcs = self._arcs
        turned = np.mod(-np.angle(across) - arcs.start, math.tau)
        tops = np.real(across * arcs.centre) + arcs.radius
        highest = np.max(np.where(turned <= arcs.sweep, tops, -np.inf), axis=-1, initial=-np.inf)
        ends = np.max(np.real(across * self._ends), axis=-1)
        return np.asarray(np.maximum(highest, ends) - supports)


@dataclass(frozen=True)
class SlidingShoe(OnSlide, Shoe):
    """Shoe on a slide: its origin is at start + along * s, along a unit vector of the ground, s in mm; that way is its own +y."""

    start: complex
    along: complex
    leaves: int = 1

    @property
    def turn(self) -> complex:
        """From its own axes to the ground's."""
        return self.along / _UP

    def pole(self, theta: Any, motion: Motion) -> Points:
        """Beside the axis, square to the slide, as far as the follower goes in a radian."""
        return self.seen(motion(theta, 0), -1j * self.along * motion(theta, 1))

    def seen(self, s: Any, point: Any) -> Points:
        """Its axes never turn."""
        return np.asarray((point - self.start - self.along * np.asarray(s)) / self.turn)

    def part(self, edge: Edge) -> RoundTip | FlatFace:
        """A tip or a face on the same slide."""
        if isinstance(edge, Arc):
            centre = self.start + self.turn * edge.centre
            return SlidingTip(centre, self.along, edge.radius, self.leaves)
        normal = 1j * self.turn * (edge.b - edge.a) / abs(edge.b - edge.a)
        middle = self.start + self.turn * (edge.a + edge.b) / 2
        lean = cmath.phase(normal / (self.leaves * self.along))
        return SlidingFace(middle, self.along, self.leaves, lean)

    def moved(self, s: float) -> Self:
        """Along its slide."""
        return replace(self, start=self.start + self.along * s)

    def standing(self, part: RoundTip | FlatFace, radius: float) -> float:
        """Along its slide."""
        return part.on_base(radius).ahead_of(part)  # type: ignore[arg-type]


@dataclass(frozen=True)
class SwingingShoe(Shoe):
    """Shoe on an arm: its origin is its pivot, and at s = 0 its axes are turned by `turn` (unit); s in rad."""

    pivot: complex
    turn: complex = 1 + 0j
    leaves: int = 1

    def pole(self, theta: Any, motion: Motion) -> Points:
        """On the line of both pivots, which it divides as their speeds do."""
        with np.errstate(divide="ignore", invalid="ignore"):  # where it turns as fast as the cam
            spoke = self.pivot / (np.asarray(motion(theta, 1)) - 1)
        return np.asarray(spoke * np.exp(-1j * np.asarray(motion(theta, 0))) / self.turn)

    def seen(self, s: Any, point: Any) -> Points:
        """About its pivot."""
        return np.asarray((point - self.pivot) * np.exp(-1j * np.asarray(s)) / self.turn)

    def part(self, edge: Edge) -> RoundTip | FlatFace:
        """A tip or a face on the same pivot."""
        if isinstance(edge, Arc):
            return SwingingArm(self.pivot, self.turn * edge.centre, edge.radius, self.leaves)
        normal = 1j * self.turn * (edge.b - edge.a) / abs(edge.b - edge.a)
        ahead = (normal.conjugate() * self.turn * edge.a).real
        return SwingingFace(self.pivot, normal, ahead)

    def moved(self, s: float) -> Self:
        """About its pivot."""
        return replace(self, turn=self.turn * cmath.rect(1, s))

    def standing(self, part: RoundTip | FlatFace, radius: float) -> float:
        """About its pivot."""
        if isinstance(part, SwingingArm):
            return part.on_base(radius).ahead_of(part)
        assert isinstance(part, SwingingFace)
        opening = math.acos((radius - part.ahead) / abs(self.pivot))
        facing = self.pivot / abs(self.pivot) * cmath.rect(1, -self.leaves * opening)
        return cmath.phase(facing / part.facing)

    def velocity(self, s: Any, point: Any) -> Points:
        """That of the shoe's own point there."""
        return np.asarray(1j * (point - self.pivot))

    def ahead_of(self, other: Self) -> float:
        """Angle between both."""
        return cmath.phase(self.turn / other.turn)

    def check(self, motion: Motion, marks: Sequence[float]) -> None:
        """Also where it swings as fast as its cam turns."""
        place, fastest = greatest(
            lambda theta: np.asarray(motion(theta, 1)), marks[0], marks[-1], marks
        )
        if fastest >= 1:
            raise DesignError(
                "speed of the follower",
                fastest,
                1.0,
                "deg/deg",
                f"cam angle {math.degrees(place):.3f} deg",
                "there it swings as fast as its cam turns, and an outline of your own cannot follow: use a longer span",
            )
        super().check(motion, marks)
