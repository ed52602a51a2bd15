"""What a printer's errors do to a cylinder cam: which walls, centres and rollers move its follower, by how much.

In the frame u, t, k of `geometry.drum_walls` where the roller stands: n is the roller's normal into a wall, w the way of its axis for
a unit of s. A wall that is off by d, bumps by b into the track, a roller that is off by e and thicker by h: it stays in touch where

    ds = ((d - e) . n - b - h cos(delta)) / (w . n)

All half way along the roller: one that stands beside the drum's axis meets steep walls at its ends, a little sooner.
Between two walls the follower counts as in the middle of both; the wall above less the one below is its play. The depth of a roller,
and the drum's radius, move a cone alone: n of a cylinder has no part along u.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from camgen.geometry.drum_walls import DrumWall
from camgen.machine.print_errors import Mode, Sensitivity, Sizes
from camgen.machines.cylinder_cam.track import Track
from camgen.numerics import Floats

SIDES = {-1: "wall below", 1: "wall above"}
RING = "ring"  # of a drum in two pieces


@dataclass(frozen=True, eq=False)
class _Touch:
    """One wall and the roller on it at the cam's angles: what moves them, (n,) mm for each mm, and for a unit of s."""

    side: int
    normal: Floats  # (3, n): along u, t and k
    way: Floats  # of the roller's axis along the normal for a unit of s
    angle: Floats  # polar, of the place that is touched, on the drum, rad
    cosine: float  # of the cone's half angle

    def moved(self, shift: Floats) -> Floats:
        """s by a shift of the wall, (3, n) or (3, 1)."""
        return np.asarray(np.sum(shift * self.normal, axis=0) / self.way)


@dataclass(frozen=True, eq=False)
class DrumErrors:
    """All errors of a cylinder cam's print; theta: (n,) rad; exact: whether its roller is a bought one."""

    track: Track
    theta: Floats
    sizes: Sizes
    exact: bool
    key: float | None = None  # of a drum in two pieces: half the length of its key's flat, mm

    @cached_property
    def touches(self) -> list[_Touch]:
        """Of each wall, the roller half way along it."""
        phi = -self.theta
        beside = self.track.path.beside(phi, 0)
        depth = np.full(len(phi), self.track.roller.middle)
        slope = self.track.roller.slope
        cosine = 1 / float(np.hypot(1, slope))
        tip = self._way
        found = []
        for side in (wall.side for wall in self.track.drum.walls):
            psi = DrumWall(self.track.path, self.track.roller, side).contact(phi, depth)
            normal = cosine * np.stack([np.full(len(phi), -slope), np.sin(psi), np.cos(psi)])
            way = normal[1] * tip.real + normal[2] * tip.imag
            across = beside + self.track.roller.at(depth) * np.sin(psi)
            angle = phi + np.arctan2(across, depth)
            found.append(_Touch(side, normal, way, angle, cosine))
        return found

    @property
    def _gamma(self) -> Floats:
        """Angle of an arm, (n,) rad."""
        return np.asarray(self.track.start + self.track.program(self.theta, 0))

    @property
    def _way(self) -> Floats:
        """Of the roller's axis for a unit of s, along t and, imaginary, along k, (n,)."""
        if not self.track.swings:
            return np.full(len(self.theta), 1j)
        arm = self.track.geometry.follower.arm or 0.0
        return np.asarray(arm * (np.sin(self._gamma) + 1j * np.cos(self._gamma)))

    def _walls(self) -> Iterator[tuple[Mode, list[Floats]]]:
        """Each wall's offset and waves: what s does where the roller is on one of them and on the other."""
        waves = self.sizes.waves
        share = 1 / np.sqrt(len(waves))
        still = np.zeros(len(self.theta))
        for touch in self.touches:
            shapes = [("offset", self.sizes.offset, np.ones(len(self.theta)))]
            shapes += [
                ("form", self.sizes.form, share * wave(k * touch.angle))
                for k in waves
                for wave in (np.cos, np.sin)
            ]
            for kind, size, bump in shapes:
                moved = [-bump / other.way if other is touch else still for other in self.touches]
                yield Mode(SIDES[touch.side], kind, size), moved

    def _shifts(self) -> Iterator[tuple[Mode, Floats]]:
        """What shifts drum against roller: by how much along u, t and k, (3, n) or (3, 1)."""
        place = self.sizes.place
        turn = np.exp(1j * self.theta)
        for axis in (1, 1j):
            off = axis * turn
            yield Mode("drum", "bore", place, axis), np.stack([off.real, off.imag, 0 * off.real])
        outward, onward, upward = np.eye(3)[:, :, None]
        yield Mode("drum", "radius", self.sizes.offset), outward
        yield Mode("roller", "depth", place), -outward
        name = "pivot, ground" if self.track.swings else "guide, roller"
        yield Mode(name, "centre", place, 1), -onward
        yield Mode(name, "centre", place, 1j), -upward
        if self.track.swings:
            along = np.stack([0 * self._gamma, -np.cos(self._gamma), np.sin(self._gamma)])
            across = np.stack([0 * self._gamma, np.sin(self._gamma), np.cos(self._gamma)])
            yield Mode("arm, roller", "centre", place, 1), -along
            yield Mode("arm, roller", "centre", place, 1j), -across

    def _all(self) -> Iterator[tuple[Mode, list[Floats]]]:
        """All modes, with s of each wall."""
        yield from self._walls()
        for mode, shift in self._shifts():
            yield mode, [touch.moved(shift) for touch in self.touches]
        if self.key is not None:
            still = np.zeros(len(self.theta))
            up = np.array([[0.0], [0.0], [1.0]])
            along = np.array([[0.0], [self.track.roller.middle / self.key], [0.0]])
            for kind, shift in (("seat", up), ("key", along)):
                yield (
                    Mode(RING, kind, self.sizes.offset),
                    [touch.moved(shift) if touch.side > 0 else still for touch in self.touches],
                )
        if not self.exact:
            thicker = [-touch.cosine / touch.way for touch in self.touches]
            yield Mode("roller", "tip", self.sizes.offset), thicker

    def sensitivity(self) -> tuple[list[Mode], Sensitivity]:
        """The modes, and what they do to the follower's s, mm or rad for each mm."""
        modes, moved = zip(*self._all(), strict=True)
        found = np.array(moved)  # (modes, walls, n)
        held = {}
        if len(self.touches) > 1:
            signs = np.array([touch.side for touch in self.touches])
            play = np.einsum("mwn,w->mn", found, signs)
            air = sum(1 / np.abs(touch.way) for touch in self.touches)
            held = {self.track.rolled.joint: (play, np.asarray(air))}
        return list(modes), Sensitivity(found.mean(axis=1), {}, held)
