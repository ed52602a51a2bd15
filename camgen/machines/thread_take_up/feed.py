"""The two-crank four-bar thread take-up as an engine: eye path, feed diagram, near stop, forces.

    O, C     fixed pivots, C at `frame` from O in the direction `tilt`; O is the origin of the machine's axes
    A, B     crank pin at `crank` from O; joint of the coupler A-B and of the output crank B-C
    D        the eye, on the coupler: `eye_distance` from B, at `eye_angle` from B-A towards the pivots' side
    M, N     the guides; feed L = |M - D| + |D - N|, supply = the greatest feed less the feed

The crank's angle theta and the tilt are counted from the machine's x axis, so theta - tilt is the angle to O-C.
[Semin, Korneenko, Kirillov, Mikheeva: Two-crank four-bar thread take-up of a sewing machine; its eqs. 1 to 3 corrected]
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from camgen.machine.forces import Forces
from camgen.machine.jets import thread_length
from camgen.machine.landmarks import (
    TURN,
    Curve,
    extremes,
    moving_centrode,
    near_stops,
    smallest_loop,
    zeros,
)
from camgen.machine.model import (
    GROUND,
    Body,
    Drive,
    Floats,
    Function,
    Machine,
    Output,
    Path,
    Pin,
    Place,
    Points,
    Pose,
)
from camgen.machine.run import Run, solve
from camgen.numerics import magnitude


@dataclass(frozen=True)
class FeedDiagram:
    """Extremes of the feed over a turn: `turns` are all angles where it turns back (rad) and `lengths` there, mm.

    let_down: angle from the greatest feed on to the least, rad; ratio: of that angle to the rest of the turn; sense: -1
    where the crank turns clockwise, so passes the angles backwards.
    """

    turns: Floats
    lengths: Floats
    sense: int = 1

    @property
    def longest(self) -> tuple[float, float]:
        """Greatest feed, mm, and its angle, rad."""
        k = int(np.argmax(self.lengths))
        return float(self.lengths[k]), float(self.turns[k])

    @property
    def shortest(self) -> tuple[float, float]:
        """Least feed, mm, and its angle, rad."""
        k = int(np.argmin(self.lengths))
        return float(self.lengths[k]), float(self.turns[k])

    @property
    def range(self) -> float:
        """Greatest less least feed, mm."""
        return self.longest[0] - self.shortest[0]

    @property
    def let_down(self) -> float:
        """Angle over which the thread is let down, rad."""
        return self.sense * (self.shortest[1] - self.longest[1]) % TURN

    @property
    def ratio(self) -> float:
        """Angle of letting down over angle of pulling up; nan for a feed that does not change."""
        return self.let_down / (TURN - self.let_down) if self.let_down else math.nan


@dataclass(frozen=True)
class NearStop:
    """Where the eye lingers: the double point of the smallest loop, or the slowest point where there is none.

    enters, leaves: angles at which the loop begins and ends, rad, enters <= leaves (equal without a loop); width,
    height: the loop's extent, mm; crossings: how often the path crosses itself.
    """

    centre: complex
    enters: float
    leaves: float
    width: float
    height: float
    crossings: int


@dataclass(frozen=True)
class TakeUp:
    """Lengths mm, angles rad, guides complex mm in the machine's axes; branch +1 has B to the left of the way A to C.

    sense: of the crank's turning, -1 clockwise.
    """

    crank: float
    coupler: float
    output: float
    frame: float
    eye_distance: float
    eye_angle: float
    branch: int
    guides: tuple[complex, complex]
    tilt: float = 0.0
    sense: int = 1

    def interchanged(self) -> TakeUp:
        """The take-up with coupler and output crank interchanged, the eye's arm kept."""
        return replace(self, coupler=self.output, output=self.coupler)

    @property
    def eye(self) -> complex:
        """The eye in the coupler's axes (origin A, x towards B), complex mm: on the pivots' side of A-B."""
        return self.coupler - self.eye_distance * cmath.exp(1j * self.branch * self.eye_angle)

    @property
    def pivot(self) -> complex:
        """C, complex mm in the machine's axes."""
        return self.frame * cmath.exp(1j * self.tilt)

    @cached_property
    def links(self) -> Mapping[str, Body]:
        """Crank O-A, coupler A-B with the eye D, output crank C-B, without masses; each with its x axis along the first two."""
        return {
            "crank": Body("crank", {"O": 0j, "A": complex(self.crank)}),
            "coupler": Body("coupler", {"A": 0j, "B": complex(self.coupler), "D": self.eye}),
            "output": Body("output", {"C": 0j, "B": complex(self.output)}),
        }

    @cached_property
    def machine(self) -> Machine:
        """Links and pins; outputs "feed", mm, and "eye", its path."""
        return self.loaded(self.links, 1.0)

    def loaded(self, links: Mapping[str, Body], speed: float) -> Machine:
        """The same with masses; speed of the crank, rad/s. Each pin's reaction is the force on the later link."""
        ground = Body(GROUND, {"O": 0j, "C": self.pivot, "M": self.guides[0], "N": self.guides[1]})
        crank, coupler, output = (links[name] for name in ("crank", "coupler", "output"))
        pins = (
            ("O", crank, ground),
            ("A", coupler, crank),
            ("B", output, coupler),
            ("C", output, ground),
        )
        a = complex(self.crank)
        c = self.pivot
        way = c - a
        far = abs(way)  # where it does not close at theta = 0, A-B lies on the line of A and C
        foot = (self.coupler**2 - self.output**2 + far**2) / (2 * far) if far else self.coupler
        off = math.sqrt(max(self.coupler**2 - foot**2, 0.0))
        b = a + (way / far if far else 1.0) * complex(foot, self.branch * off)
        return Machine(
            (ground, crank, coupler, output),
            tuple(Pin(name, on.at(name), by.at(name)) for name, on, by in pins),
            (Drive("motor", "crank"),),
            {
                "crank": Pose(0j, 0.0),
                "coupler": Pose(a, cmath.phase(b - a)),
                "output": Pose(c, cmath.phase(b - c)),
            },
            outputs=(
                Output(
                    "feed",
                    Function((ground.at("M"), coupler.at("D"), ground.at("N")), thread_length),
                ),
                Output("eye", Path(Place("coupler", self.eye))),
            ),
            speed=speed,
        )

    def run(self, theta: Floats, order: int = 0) -> Run:
        """The machine at theta, (n,) rad."""
        return solve(self.machine, theta, order)

    def path(self, theta: Floats, order: int = 0) -> Points:
        """The eye's place, or its derivative to theta, shaped like theta, complex mm."""
        return np.asarray(self.run(theta, order).derivatives("eye")[order], complex).reshape(
            np.shape(theta)
        )

    # ---- feed --------------------------------------------------------------------------------------------------------

    def feed(self, theta: Floats, order: int = 0) -> Floats:
        """Thread between the guides M-D-N, mm, or its derivative to theta, (n,); nan where not assembled.

        Derivatives are nan where the eye meets a guide: the feed has a kink there.
        """
        return np.asarray(self.run(theta, order).derivatives("feed")[order], float).reshape(
            np.shape(theta)
        )

    @cached_property
    def diagram(self) -> FeedDiagram:
        """Extremes of the feed."""
        return FeedDiagram(*extremes(self.feed), self.sense)

    def supply(self, theta: Floats) -> Floats:
        """Thread let down since the feed was greatest, (n,) mm."""
        return self.diagram.longest[0] - self.feed(theta)

    # ---- eye path ----------------------------------------------------------------------------------------------------

    @cached_property
    def near_stop(self) -> NearStop:
        """The near stop of the eye."""
        path = self.path
        found = smallest_loop(path)
        if found is None:
            slow = self.slowest()
            return NearStop(complex(path(np.array([slow]), 0)[0]), slow, slow, 0.0, 0.0, 0)
        enters, leaves, place, count = found
        loop = path(np.linspace(enters, leaves, 2001), 0)
        return NearStop(
            place, enters, leaves, float(np.ptp(loop.real)), float(np.ptp(loop.imag)), count
        )

    def slowest(self) -> float:
        """Angle at which the eye moves slowest, rad."""
        path = self.path

        def speed_slope(theta: Floats, order: int) -> Floats:
            if order:
                return np.full(theta.shape, math.nan)  # bisection does
            return np.asarray((np.conj(path(theta, 1)) * path(theta, 2)).real)

        turns = np.append(zeros(speed_slope), 0.0)  # a path of even speed has no least
        speed = np.nan_to_num(np.abs(path(turns, 1)), nan=math.inf)
        return float(turns[int(np.argmin(speed))])

    def lingers(self, radius: float) -> float:
        """Crank angle, rad, from the eye's first entry to its last exit of a circle round the near stop; 2 pi if it stays."""
        stop = self.near_stop
        middle = (stop.enters + stop.leaves) / 2
        path = self.path
        shift = middle - math.pi  # so that the stop lies in mid turn

        def shifted(theta: Floats, order: int) -> Points:
            return path(theta + shift, order)

        curve: Curve = shifted
        spans = near_stops(curve, stop.centre, radius)
        if not len(spans):  # always within, or for less than the search resolves
            whole = path(np.linspace(0, TURN, 720, endpoint=False), 0)
            return TURN if magnitude(whole - stop.centre) <= radius else 0.0
        half = (stop.leaves - stop.enters) / 2
        held = spans[
            (spans[:, 0] <= math.pi + half + 1e-9) & (spans[:, 1] >= math.pi - half - 1e-9)
        ]
        return float(held[:, 1].max() - held[:, 0].min()) if len(held) else 0.0

    def cusps(self) -> list[tuple[float, float]]:
        """Eye distances at which the path has a cusp, the eye's angle kept: (distance mm, crank angle rad), sorted."""
        arm = (self.coupler - self.eye) / self.eye_distance  # unit, from the eye towards B

        def places(theta: Floats) -> Points:
            run = self.run(theta, 2)
            return moving_centrode(run.point("crank", "A"), run.point("coupler", "B"))

        def aside(theta: Floats, order: int) -> Floats:
            rows = places(theta) * self.coupler
            rows[0] -= self.coupler
            return np.asarray((np.conj(arm) * rows[order]).imag)

        angles = zeros(aside)
        out = -(np.conj(arm) * (places(angles)[0] - 1) * self.coupler).real
        return sorted((float(r), float(t)) for r, t in zip(out, angles, strict=True) if r > 0)

    # ---- turning and forces ------------------------------------------------------------------------------------------

    def rates(self, theta: Floats, order: int = 0) -> tuple[Floats, Floats]:
        """Angular speeds of coupler and output crank over the crank's, (n,) each; order 1: their derivatives."""
        run = self.run(theta, order + 1)
        return run.angle("coupler")[order + 1], run.angle("output")[order + 1]

    def rate_extremes(self, output: bool) -> tuple[tuple[float, float], tuple[float, float]]:
        """Least and greatest of the coupler's or the output crank's rate, each with its angle, rad."""

        def slope(theta: Floats, order: int) -> Floats:
            if order == 0:
                return self.rates(theta, 1)[output]
            step = 1e-5  # rad: as good a slope as Newton's method needs
            ahead, behind = np.split(
                self.rates(np.append(theta + step, theta - step), 1)[output], 2
            )
            return (ahead - behind) / (2 * step)

        at = np.append(zeros(slope), 0.0)
        value = self.rates(at)[output]
        low = int(np.nanargmin(value))
        high = int(np.nanargmax(value))
        return (float(value[low]), float(at[low])), (float(value[high]), float(at[high]))

    def forces(self, theta: Floats, bodies: Mapping[str, Body], speed: float) -> Forces:
        """Reactions at O, A, B, C and torque at crank angles theta, (n,), for a crank that turns at `speed` rad/s.

        bodies: the links with their masses.
        """
        return solve(self.loaded(bodies, speed), theta).forces()

    def wear(self, theta: Floats, forces: Forces, speed: float) -> dict[str, float]:
        """Wear measure of A, B and C: mean over equally spaced angles of |reaction| |relative angular speed|, N rad/s.

        Times the pin's radius and the coefficient of friction it is the friction power; the wear rate is taken as
        proportional to it (load times sliding way).
        """
        coupler, output = self.rates(theta)
        relative = {"A": 1 - coupler, "B": coupler - output, "C": output}
        return {
            name: abs(speed) * float(np.nanmean(np.abs(forces.reactions[name]) * np.abs(w)))
            for name, w in relative.items()
        }
