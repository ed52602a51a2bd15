"""What a drum's wall does to the roller that rides on it, and through it to the follower's guide or axle and to the shaft.

At the roller's middle, in the frame u, t, k of `geometry.drum_walls`: the wall presses along its normal, whose line meets the
roller's axis at r* = r + R tan(delta). For the effort that the follower needs along its way (N, of an arm N m) the force on the
roller is N (sin(delta) u - cos(delta) m), N = effort / (way of the roller along the normal for a unit of the follower's).

Guide and axle bear at a distance `guide` from the drum's axis; what loads the follower is taken to act there.
The wall passes the roller at omega v, v = cos(psi) (r + Y') - sin(psi) Z', and the roller has one spin: of a cylinder both agree
at its middle alone.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from camgen.geometry.drum_walls import DrumWall
from camgen.machines.cylinder_cam.track import Track
from camgen.numerics import Floats, peak
from camgen.parts import materials
from camgen.study import Figure

_MM = 1e-3  # m
_RPM = 60 / math.tau
_NONE = 1e-9  # share of the greatest effort, below which nothing presses


@dataclass(frozen=True)
class Roller:
    """A roller that turns as its middle does; omega: rad/s of the drum."""

    track: Track
    omega: float

    def pace(self, side: int, r: float) -> Floats:
        """Way of a wall past the roller at the depth r for each rad of the drum, (n,) mm, over the track's angles."""
        track = self.track
        phi = -track.theta
        path = track.path
        psi = DrumWall(path, track.roller, side).contact(phi, np.full(len(phi), r))
        along = np.cos(psi) * (r + path.beside(phi, 1)) - np.sin(psi) * path.height(phi, 1)
        return np.asarray(side * along)

    def slip(self, side: int, r: float) -> Floats:
        """By how much a wall is faster than the roller's surface at the depth r, as a share of its speed, (n,)."""
        roller = self.track.roller
        growth = float(roller.at(np.array(r))) / roller.radius
        return self.pace(side, r) / (self.pace(side, roller.middle) * growth) - 1

    @property
    def inertia(self) -> float:
        """Of a solid one of steel about its axis, kg m^2; a cone as a cylinder of its middle."""
        radius = self.track.roller.radius
        mass = (
            materials.STEEL.density * 1e-6 * math.pi * radius**2 * self.track.geometry.roller.length
        )
        return mass * (radius * _MM) ** 2 / 2

    def figures(self) -> Iterator[Figure]:
        """Its greatest spin, and its slip at its ends."""
        track = self.track
        roller = track.roller
        ends = (track.inner, track.inner + track.geometry.roller.length)
        sides = [wall.side for wall in track.drum.walls]
        spins = [self.pace(side, roller.middle) / roller.radius for side in sides]
        spin = abs(self.omega) * peak(np.array(spins))
        slip = max(peak(self.slip(side, end)) for side in sides for end in ends)
        yield Figure("roller spin", spin * _RPM, "rpm")
        yield Figure("roller slip", 100 * slip, "%")

    def reversals(self, effort: Floats) -> Floats:
        """Spins with which it meets the other wall of a groove, rad/s, one for each time that the effort turns round."""
        pressed = np.flatnonzero(np.abs(effort) > _NONE * peak(effort))
        if not len(pressed):
            return np.zeros(0)
        sense = np.sign(effort[pressed])
        turned = pressed[sense != np.roll(sense, 1)]
        roller = self.track.roller
        return np.asarray(abs(self.omega) * self.pace(1, roller.middle)[turned] / roller.radius)

    def reversal_figures(self, spins: Floats) -> Iterator[Figure]:
        """How often a groove turns its roller round, how fast it slips then, and what friction burns; spins: as of `reversals`."""
        yield Figure("roller reversals", float(len(spins)), "")
        if len(spins):
            fastest = float(np.max(spins))
            yield Figure("roller reversal slip", 2 * fastest * self.track.roller.radius, "mm/s")
            yield Figure("roller reversal work", 2 * self.inertia * fastest**2, "J")


@dataclass(frozen=True, eq=False)
class Pressed:
    """Force of the wall on the roller over the track's angles, (n,) N: outward, along the turn and upward."""

    track: Track
    outward: Floats
    onward: Floats
    upward: Floats

    @property
    def reach(self) -> Floats:
        """How far from the drum's axis its line meets the roller's, mm."""
        roller = self.track.roller
        return np.asarray(roller.middle + roller.radius * roller.slope)

    @property
    def torque(self) -> Floats:
        """By which the shaft turns the drum against it, (n,) N m."""
        beside = self.track.path.beside(-self.track.theta, 0)
        return np.asarray(_MM * (self.reach * self.onward - beside * self.outward))

    def figures(self, guide: float) -> Iterator[Figure]:
        """Peaks of what the shaft and the guide or the axle bear; guide: its distance from the drum's axis, mm."""
        beside = self.track.path.beside(-self.track.theta, 0)
        sideways = peak(np.hypot(self.outward, self.onward))
        upright = peak(self.upward)
        lever = _MM * np.abs(guide - self.reach)
        yield from _bearing(
            "shaft", sideways, upright, peak(_MM * self.upward * np.hypot(self.reach, beside))
        )
        if self.track.swings:
            across = self.onward + 1j * self.upward
            tilting = _MM * ((self.reach - guide) * across - self.outward * self.track.spoke)
            yield from _bearing("pivot", peak(across), peak(self.outward), peak(tilting))
            return
        yield _reaction("guide", sideways)
        yield Figure("tilting moment {joint}", peak(self.upward * lever), "N m", joint="guide")
        yield Figure("twisting moment {joint}", peak(self.onward * lever), "N m", joint="guide")


def _reaction(joint: str, force: float) -> Figure:
    return Figure("reaction {joint} without friction", force, "N", joint=joint)


def _bearing(joint: str, across: float, along: float, tilting: float) -> Iterator[Figure]:
    """Of a joint that turns: force across its axis and along it, N, and the moment that tilts it, N m."""
    yield _reaction(joint, across)
    yield Figure("thrust {joint}", along, "N", joint=joint)
    yield Figure("tilting moment {joint}", tilting, "N m", joint=joint)


def pressed(track: Track, effort: Floats) -> Pressed:
    """The force of the wall that bears an effort, (n,) N, of an arm N mm: above 0 the wall below, else the one above."""
    phi = -track.theta
    depth = np.full(len(phi), track.roller.middle)
    below, above = (
        DrumWall(track.path, track.roller, side).contact(phi, depth) for side in (-1, 1)
    )
    psi = np.where(effort >= 0, below, above)
    cosine = 1 / math.hypot(1, track.slope)
    lean = track.start + track.program(track.theta, 0) if track.swings else 0.0
    arm = (track.geometry.follower.arm or 0.0) if track.swings else 1.0
    force = np.abs(effort) / (arm * cosine * np.abs(np.cos(psi - lean)))
    return Pressed(
        track,
        force * track.slope * cosine,
        -force * cosine * np.sin(psi),
        -force * cosine * np.cos(psi),
    )
