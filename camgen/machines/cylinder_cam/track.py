"""The track of a cylinder cam as it is made: the drum, where the roller stands, and what the designer must know of both.

The roller's axis is in line with the drum's; its length lies between the floor and the outside. The walls are those of a roller
that is larger by half the clearance, so that the true one has play between them.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from camgen.errors import DesignError
from camgen.geometry.drum_walls import (
    DrumRoller,
    DrumWall,
    RollerPath,
    remembered,
    slide_path,
    swing_path,
)
from camgen.geometry.drums import Drum
from camgen.machine.cams.sizing import largest, written
from camgen.machine.features import DrumTrack
from camgen.machines.cylinder_cam.tables import DrumGeometry
from camgen.motion.program import Program
from camgen.numerics import Floats, Points, halved

_SAMPLES = 2881  # of the turn, and both sides of each break of the program
_BESIDE = 1e-9  # rad
_GROWTH = 1.25  # from one try of a radius to the next
_BEYOND = 1.001  # of the offset, that the floor under the track stands from the axis
_BISECTIONS = 50


@dataclass(frozen=True)
class Track:
    """A cylinder cam with every size; lengths mm, the follower's place in mm, or rad of an arm."""

    geometry: DrumGeometry  # radius, length and the follower's places filled in, or not needed
    program: Program
    clearance: float  # of the roller between both walls
    bore_reach: float  # how far the shaft's hole reaches from the axis
    wall: float  # least, round the bore and at the ends
    radius: float  # of the drum, outside
    key_height: float = 0.0  # of a drum in two pieces, over the wall at its upper end
    followed: RollerPath | None = None  # of the roller's axis, where it is known from another drum

    @property
    def swings(self) -> bool:
        """Whether the follower is an arm."""
        return self.geometry.follower.swings

    @property
    def inner(self) -> float:
        """Distance of the roller's inner end from the drum's axis."""
        roller = self.geometry.roller
        return self.radius - roller.end_clearance - roller.length

    @property
    def floor(self) -> float:
        """Radius of the drum beneath the track."""
        return self.inner - self.geometry.roller.end_clearance

    @property
    def slope(self) -> float:
        """Of the roller's cone."""
        return math.tan(math.radians(self.geometry.roller.cone_deg))

    @property
    def roller(self) -> DrumRoller:
        """As it is."""
        table = self.geometry.roller
        return DrumRoller(table.radius, self.inner + table.length / 2, self.slope)

    @cached_property
    def theta(self) -> Floats:
        """Cam angles that are looked at."""
        even = np.linspace(0, math.tau, _SAMPLES)
        breaks = self.program.breaks
        beside = np.concatenate([breaks - _BESIDE, breaks + _BESIDE])
        return np.union1d(even, beside[(beside > 0) & (beside < math.tau)])

    # ---- where the follower stands ----------------------------------------------------------------------------------

    @property
    def start(self) -> float:
        """Angle of the arm at displacement 0, rad; 0 of a slide."""
        if not self.swings:
            return 0.0
        given = self.geometry.follower.start_deg
        low, high = self.program.extremes
        return -(low + high) / 2 if given is None else math.radians(given)

    @property
    def pivot(self) -> float:
        """How far the axle of an arm lies beside the drum's axis: unless given so that the roller stays nearest to it."""
        follower = self.geometry.follower
        if follower.pivot is not None:
            return follower.pivot
        low, high = (self.start + s for s in self.program.extremes)
        nearest = 1.0 if low <= 0 <= high else max(math.cos(low), math.cos(high))
        return round((follower.arm or 0.0) * (nearest + min(math.cos(low), math.cos(high))) / 2, 1)

    def _path(self, height: float) -> RollerPath:
        """Of the roller, the follower's height as given."""
        follower = self.geometry.follower
        if not self.swings:
            return slide_path(self.program, height, follower.offset)
        start = self.start
        program = self.program

        def angle(theta: Floats, order: int) -> Floats:
            return program(theta, order) + (start if order == 0 else 0.0)

        return swing_path(angle, follower.arm or 0.0, self.pivot, height)

    @cached_property
    def _reach(self) -> tuple[float, float]:
        """Lowest and highest place of both walls, the follower's height 0."""
        height = self._path(0.0).height(-self.theta, 0)
        table = self.geometry.roller
        half = (self.geometry.distance or 0.0) / 2
        around = table.radius + abs(self.slope) * table.length / 2 + self.clearance / 2
        beyond = half - around if self.geometry.track == "rib" else around
        above = 0.0 if self.geometry.track == "end" else beyond
        return float(np.min(height)) - beyond, float(np.max(height)) + above

    @property
    def _lowest(self) -> float:
        """Height of the follower with the least wall under its track."""
        return written(self.wall - self._reach[0])

    @property
    def length(self) -> float:
        """Of the drum."""
        given = self.geometry.length
        if given is not None:
            return given
        low, high = self._reach
        lowest = self._lowest if self.geometry.follower.height is None else self.wall - low
        return written(lowest + high + self.wall + self.key_height)

    @property
    def height(self) -> float:
        """Of the roller at displacement 0, or of the arm's axle, over the drum's lower end."""
        given = self.geometry.follower.height
        if given is not None:
            return given
        low, high = self._reach
        if self.geometry.length is None:
            return self._lowest
        return (self.length - self.key_height - high - low) / 2

    @cached_property
    def path(self) -> RollerPath:
        """Of the roller's axis; that of any drum."""
        return self.followed or self._path(self.height)

    @property
    def spoke(self) -> Points:
        """From an arm's pivot to its roller, (n,) mm: along the turn, and upward as the imaginary part."""
        return self.path.place(-self.theta, 0) - complex(self.pivot, self.height)

    # ---- the drum ---------------------------------------------------------------------------------------------------

    @cached_property
    def drum(self) -> Drum:
        """As it is made."""
        closed = self.geometry.track != "end"
        roller = replace(self.roller, radius=self.roller.radius + closed * self.clearance / 2)
        return Drum(
            self.radius,
            self.floor,
            self.length,
            self.geometry.track,
            self.path,
            roller,
            self.geometry.distance or 0.0,
            tuple(self.program.breaks.tolist()),
        )

    @property
    def rolled(self) -> DrumTrack:
        """What the judge is told of it."""
        follower = self.geometry.follower
        arm = (follower.arm or 0.0, self.pivot, self.height) if self.swings else None
        table = self.geometry.roller
        return DrumTrack(
            "drum",
            "contact",
            self.geometry.track,
            (table.radius, table.length, self.inner, table.cone_deg),
            self.start if self.swings else self.height,
            0.0 if self.geometry.track == "end" else self.clearance,
            distance=self.geometry.distance,
            offset=follower.offset,
            arm=arm,
        )

    # ---- what limits it ---------------------------------------------------------------------------------------------

    def pressure_angle(self, theta: Floats) -> Floats:
        """At the roller's inner end, (n,) rad, signed: between the contact's normal and the follower's way."""
        wall = DrumWall(self.path, self.roller, 1)
        contact = wall.contact(-theta, np.full(len(theta), self.inner))
        lean = self.start + self.program(theta, 0) if self.swings else 0.0
        return np.asarray(contact - lean)

    @cached_property
    def steepest(self) -> float:
        """Largest pressure angle, deg."""
        return math.degrees(float(np.max(np.abs(self.pressure_angle(self.theta)))))

    @cached_property
    def walls(self) -> tuple[Floats, Floats]:
        """Of both walls at the roller's inner end, (k, n): area of the wall for that of the surface of the roller's axis, and its
        curvature square to the contact line, 1/mm, above 0 where it is convex."""
        depth = np.full(len(self.theta), self.inner)
        areas = []
        bends = []
        for wall in self.drum.walls:
            area = wall.area_ratio(-self.theta, depth)
            psi = wall.contact(-self.theta, depth)
            radius = wall.roller.at(depth)
            reach = depth + wall.path.beside(-self.theta, 1)
            speed = np.hypot(reach, wall.path.height(-self.theta, 1))
            relative = (1 + (radius * np.sin(psi) / speed) ** 2) / (radius * area)
            areas.append(area)
            bends.append(relative - 1 / radius)
        return np.array(areas), np.array(bends)

    @property
    def regular(self) -> bool:
        """Whether no wall is undercut, from the outside down to the floor, which lies deeper than the roller."""
        try:
            self.drum.edge_heights  # noqa: B018
        except DesignError:
            return False
        return self.smooth

    @property
    def smooth(self) -> bool:
        """Whether no wall is undercut where the roller has its inner end, and on the floor."""
        try:
            self.drum.refuse_undercut()
        except DesignError:
            return False
        return float(np.min(self.walls[0])) > 0

    def lever(self, theta: Floats) -> Floats:
        """Way of the roller along the contact's normal for each unit of the follower's, (n,) mm."""
        arm = (self.geometry.follower.arm or 0.0) if self.swings else 1.0
        return np.asarray(arm / math.hypot(1, self.slope) * np.cos(self.pressure_angle(theta)))


def smallest(track: Track, steepest: float) -> float:
    """Least radius of the drum, as a workshop writes it, at which the pressure angle at the roller's inner end stays below a
    limit, deg, no wall is undercut, and its bore has its wall. DesignError where none has."""
    roller = track.geometry.roller
    inside = track.bore_reach + track.wall + 2 * roller.end_clearance + roller.length
    # the roller stays clear of the other side of the drum's axis, and of that axis' neighbourhood where walls have no slope
    least = max(inside, track.bore_reach + 2 * roller.end_clearance + roller.length + roller.radius)
    depth = track.radius - track.floor
    least = max(least, depth + _BEYOND * abs(track.geometry.follower.offset))  # and meets the drum

    followed = replace(track, followed=remembered(track.path))

    def of(radius: float) -> Track:
        return replace(followed, radius=radius)

    def smooth(radius: float) -> bool:
        return of(radius).steepest <= steepest and of(radius).smooth

    def fits(radius: float) -> bool:  # takes ten times as long
        return smooth(radius) and of(radius).regular

    low, high = track._reach
    most = max(largest(high - low), least)
    found = _least(smooth, least, most)
    if math.isfinite(found) and not fits(found):
        found = _least(fits, least, most)
    if not math.isfinite(found):
        where = f"the largest drum that is looked for, radius {most:.4g} mm"
        remedy = (
            "spread the motion over more of the turn, or allow a larger limits.pressure_angle_deg"
        )
        if track.swings:
            remedy = f"a smaller swing or a longer arm; or {remedy}"
        raise DesignError("pressure angle", of(most).steepest, steepest, "deg", where, remedy)
    return written(found, fits)


def _least(fits: Callable[[float], bool], least: float, most: float) -> float:
    """The least radius that fits, from the least to the greatest one; inf where none does."""
    low = high = least
    while not fits(high):
        if high >= most:
            return math.inf
        low = high
        high = min(high * _GROWTH, most)
    return high if high == least else halved(fits, low, high, _BISECTIONS)
