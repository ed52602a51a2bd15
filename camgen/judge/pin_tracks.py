"""Pins along lobes, and in holes: the gap of each pin all the way, where driver and follower are as they are wanted.

A pair that drives is held by a few pins at a time, and the next one takes over where one is off. So the motion does not show what
this does: a lobe that is too thin, a pin that is too small or off its circle.

    pin     its convex hull counts, as far as it reaches to where the other edge is nearest
    gap     of the pin from that edge, mm; below 0 where it is in it
    number  from 1, counter-clockwise: of pins from the first one, of lobes from the hollow that is on that pin at the start
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from camgen.findings import Finding, Where, at_most
from camgen.geometry.rings import Floats, Points, Ring
from camgen.judge.edges import Engagement, Gap
from camgen.judge.pair_features import Features, features
from camgen.machine.features import PinTracks
from camgen.study import Figure

_STEP = math.radians(1.0)  # of what carries or turns, from sample to sample
_BLOCK = 16  # samples that are looked up together
_SAME_NORMAL = 1e-9  # rad


@dataclass(frozen=True)
class Nearest:
    """Of points the nearest place on outlines, each (n,): distance, mm, below 0 within the material, and the outward normal there."""

    distance: Floats
    normal: Points


@dataclass(frozen=True)
class TrackGap:
    """Where a pin is farthest from the gap that is meant: gap there, mm, the angle of the joint, rad, and both numbers."""

    gap: float
    wanted: float
    theta: float
    pin: int
    lobe: int  # 0 of holes
    least: float  # gap of all pins
    most: float

    @property
    def off(self) -> float:
        """By how much, mm."""
        return abs(self.gap - self.wanted)


@dataclass(frozen=True, eq=False)
class TrackedPins(Engagement):
    """Pins and what they go along, as the files have both."""

    @cached_property
    def theta(self) -> Floats:
        """Angles of the joint over its period, (n,) rad."""
        feature = self.feature
        fastest = max(1.0, *map(abs, feature.rates))
        count = math.ceil(feature.period * fastest / _STEP)
        return np.linspace(0.0, feature.period, count, endpoint=False)

    @cached_property
    def worst(self) -> TrackGap:
        """The pin farthest from its gap."""
        pins, edges = self._pins_and_edges
        hulls = [features([pin.counter_clockwise()]) for pin in pins]
        all_gaps = np.array([self._gaps(k, pin, edges, hulls[k]) for k, pin in enumerate(pins)])
        wanted = np.array([self._wanted(pin) for pin in pins])
        pin, k = np.unravel_index(int(np.argmax(np.abs(all_gaps - wanted))), wanted.shape)
        theta = float(self.theta[k])
        return TrackGap(
            float(all_gaps[pin, k]),
            float(wanted[pin, k]),
            theta,
            int(pin) + 1,
            self._lobe(pins[int(pin)], theta),
            float(all_gaps.min()),
            float(all_gaps.max()),
        )

    @property
    def _pins_and_edges(self) -> tuple[tuple[Ring, ...], tuple[Ring, ...]]:
        """The pins, and what they go along."""
        return (self.a, self.b) if self.tracks.pins == "a" else (self.b, self.a)

    @property
    def tracks(self) -> PinTracks:
        """As they are meant."""
        assert self.feature.tracks is not None
        return self.feature.tracks

    def figures(self, kind: str) -> list[Figure]:
        """Those of any engagement, and by how much the follower turns unevenly where it is held on the worse side, peak to peak."""
        samples = self.motion.samples
        even = self.wanted(samples.theta, 0)
        sides = [side - even for side in (samples.low, samples.high)]
        known = [side[np.isfinite(side)] for side in sides]
        ripple = max((math.degrees(np.ptp(side)) for side in known if len(side)), default=0.0)
        own = Figure("ripple {of}", ripple, "deg", self.feature.joint, kind=kind)
        return [*super().figures(kind), own]

    @cached_property
    def worst_gap(self) -> Gap:
        """That of the pin farthest from its gap, for both sides together."""
        driver = self.feature.a[0].part
        driven = self.feature.b[0].part
        return Gap(2 * self.worst.gap, 2 * self.worst.wanted, driver, driven)

    def _seen(self, theta: Floats, points: Points) -> Points:
        """Points of the pins' body, (n,), as the other one sees them, mm."""
        place, angle = self.pair.pose(theta, 0)
        turn = np.exp(1j * self.wanted(theta, 0))
        own = np.exp(1j * angle)
        if self.tracks.pins == "a":
            return np.asarray((place + own * points) / turn)
        return np.asarray((turn * points - place) / own)

    def _turned(self, theta: Floats) -> Points:
        """By which the pins' body has turned against the other one, unit complex, (n,)."""
        none = np.zeros(theta.shape, complex)
        return self._seen(theta, none + 1) - self._seen(theta, none)

    def _gaps(self, k: int, pin: Ring, edges: tuple[Ring, ...], hull: Features) -> Floats:
        """Of a pin over all angles, (n,) mm."""
        own = edges if self.tracks.lobes else edges[k : k + 1]
        centre = pin.centroid
        points = self._seen(self.theta, np.full(self.theta.shape, centre))
        near = nearest(points, features(own))
        towards = -near.normal / self._turned(self.theta)
        return near.distance - _reach(hull, centre, towards)

    def _wanted(self, pin: Ring) -> Floats:
        """Its gap as it is meant, (n,) mm."""
        _, angle = self.pair.pose(self.theta, 0)
        turns = angle if self.tracks.pins == "a" else self.wanted(self.theta, 0)
        carried = self.feature.rates[1] * self.theta
        line = np.angle(self.line) if self.line else 0.0
        return self.tracks.gap(np.angle(pin.centroid) + turns - carried - line)

    def _lobe(self, pin: Ring, theta: float) -> int:
        """Number of the lobe at which a pin is, 0 where there are none."""
        if not self.tracks.lobes:
            return 0
        first = self._seen(np.zeros(1), np.array([self._pins_and_edges[0][0].centroid]))[0]
        here = self._seen(np.array([theta]), np.array([pin.centroid]))[0]
        share = float(np.angle(here / first)) / math.tau % 1.0
        return int(share * self.tracks.lobes) % self.tracks.lobes + 1


def nearest(points: Points, edges: Features) -> Nearest:
    """Of points, (n,), in the order in which they are passed; from a concave corner nothing free is nearest."""
    distance = np.full(len(points), np.inf)
    normal = np.zeros(len(points), complex)
    for k in range(0, len(points), _BLOCK):
        some = points[k : k + _BLOCK]
        middle = some.mean()
        way = np.abs(edges.hub - middle)
        least = np.min(way + edges.reach) + 2 * np.max(np.abs(some - middle))
        close = edges.take(np.flatnonzero(way - edges.reach <= least))
        found, normals = _apart(some[:, None], close)
        best = np.argmin(np.abs(found), axis=1)
        row = np.arange(len(some))
        distance[k : k + _BLOCK] = found[row, best]
        normal[k : k + _BLOCK] = normals[row, best]
    return Nearest(distance, normal)


def _apart(points: Points, edges: Features) -> tuple[Floats, Points]:
    """Of points, (n, 1), from features, (m,): distance, mm, inf where another one is nearer, and normal, (n, m)."""
    way = points - edges.centre
    hollow = edges.radius < 0
    out = np.where(hollow, -way, way)
    unit = out / np.where(out == 0, 1, np.abs(out))
    along = np.real(np.conj(1j * edges.middle) * way)
    straight = edges.straight
    normal = np.where(straight, edges.middle, unit)
    distance = np.where(
        straight,
        np.real(np.conj(edges.middle) * way),
        np.where(hollow, -edges.radius - np.abs(way), np.abs(way) - edges.radius),
    )
    turned = np.abs(np.angle(unit * np.conj(edges.middle)))
    within = np.where(
        straight, (along >= 0) & (along <= edges.length), turned <= edges.half + _SAME_NORMAL
    )
    return np.where(within, distance, np.inf), normal


def _reach(hull: Features, centre: complex, towards: Points) -> Floats:
    """How far an outline reaches from a centre in directions, unit complex, (n,)."""
    round_ = hull.take(np.flatnonzero(~hull.straight & (hull.radius >= 0)))
    ahead = np.real(np.conj(towards)[:, None] * (round_.centre - centre)) + round_.radius
    turned = np.abs(np.angle(towards[:, None] * np.conj(round_.middle)))
    return np.asarray(np.max(np.where(turned <= round_.half + _SAME_NORMAL, ahead, 0.0), axis=1))


def judge_tracks(pins: TrackedPins, limit: float, where: Where) -> Finding:
    """PIN_TRACK: by how much the gap of a pin is off the one meant, all pins all the way, mm.

    limit: mm; where: the files of all edges.
    """
    worst = pins.worst
    at = f"pin {worst.pin} at lobe {worst.lobe}" if worst.lobe else f"pin {worst.pin} in its hole"
    spin, carried = pins.feature.rates
    theta = worst.theta * (carried or spin) % math.tau
    place = replace(where, joint=pins.feature.joint, theta=theta, angle="crank at")
    remark = (
        f"{at}: gap {worst.gap:.4f} mm, {worst.wanted:.4f} mm wanted; most off of all pins all the way, {worst.least:.4f} to "
        f"{worst.most:.4f} mm"
    )
    return at_most("PIN_TRACK", worst.off, limit, "mm", place, remark)
