"""A spring unloader on an indexed link: torques at follower and cam shaft, with the spring and without it.

    position   a = 0..1, share of the link's stroke; a = 0 and a = 1 are the dwells
    spring     torque on the link over the position, positive forwards; the spring gives on the run-up what it takes back on
               the run-down, M(1 - a) = -M(a), so it serves the stroke forwards and the stroke back alike
    demand     torque that the cam must add at the follower's axle: positive where it pushes the link forwards

Torques in N m, inertias in kg m^2, angles in rad, all at their own shaft; gears without loss.
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from camgen.motion.laws import Floats, Law
from camgen.numerics import magnitude

LINK = "driven_link"
SpringTorque = Callable[[Floats], Floats]
_FITTED = 1001  # shares of the time of a run-up at which a spring is fitted to its law
_INVERSE = 20_001  # positions at which a law is tabulated to find its time from its displacement: 1e-9 of the turn


def antisymmetric(run_up: SpringTorque) -> SpringTorque:
    """A torque given for the run-up 0 <= a <= 1/2, continued by M(1 - a) = -M(a)."""

    def torque(a: Floats) -> Floats:
        a = np.clip(np.asarray(a, float), 0.0, 1.0)
        return np.asarray(
            np.where(a <= 0.5, run_up(np.minimum(a, 0.5)), -run_up(np.minimum(1 - a, 0.5)))
        )

    return torque


def law_torque(law: Law, unit: float) -> SpringTorque:
    """Torque of the spring that does by itself what the law asks: unit * c at the position, unit = J stroke / T^2.

    Taken from the law's first half; where the law is symmetric its second half follows.
    """
    kappa = (
        0.5 * np.linspace(0, 1, _INVERSE) ** 2
    )  # the displacement grows as kappa^2: dense where it is small
    position = law(kappa)
    pull = unit * law(kappa, 2)
    root = np.sqrt(np.maximum(position, 0.0))

    def run_up(a: Floats) -> Floats:
        return np.asarray(np.interp(np.sqrt(np.maximum(a, 0.0)), root, pull))

    return antisymmetric(run_up)


@dataclass(frozen=True)
class CrankSpring:
    """A spring on a cord that runs from a crank pin over a guide; the crank turns with the link, once less 2 lead a stroke.

    At a = 0 the crank stands `lead` (rad) past its dead centre, where the pin is farthest from the guide; at a = 1/2 pin and
    guide are nearest. on: the link turns on, so the crank turns once a stroke, from `lead` before that place. stiffness N/mm;
    crank: radius of the pin, guide: its distance from the crank's axis, both mm; stretch: of the spring where they are
    nearest, mm; stroke: of the link, rad.
    """

    stiffness: float
    crank: float
    guide: float
    stretch: float
    lead: float
    stroke: float
    on: bool = False

    @property
    def begin(self) -> float:
        """Of the crank past its dead centre as a stroke begins, rad."""
        return -self.lead if self.on else self.lead

    @property
    def turn(self) -> float:
        """Of the crank over the stroke, rad."""
        return math.tau if self.on else 2 * (math.pi - self.lead)

    @property
    def farthest(self) -> float:
        """Greatest distance of pin and guide, mm."""
        return abs(self.crank * cmath.exp(1j * (0.0 if self.on else self.lead)) + self.guide)

    @property
    def stretches(self) -> tuple[float, float]:
        """Of the spring over the stroke, mm: where pin and guide are nearest and farthest."""
        return self.stretch, self.stretch + self.farthest - (self.guide - self.crank)

    def __call__(self, a: Floats) -> Floats:
        """Torque on the link, N m, (n,)."""
        phi = self.begin + self.turn * np.asarray(a, float)
        cord = np.sqrt(self.crank**2 + self.guide**2 + 2 * self.crank * self.guide * np.cos(phi))
        pull = self.stiffness * (self.stretch + cord - (self.guide - self.crank))
        lever = self.crank * self.guide * np.sin(phi) / cord
        return np.asarray(pull * lever * 1e-3 * self.turn / self.stroke)


def fitting(spring: CrankSpring, law: Law, unit: float) -> CrankSpring:
    """The same with the stiffness of which the least is left of the law's torque unit * c at its worst."""
    from scipy.optimize import minimize_scalar

    kappa = np.linspace(0, 1.0 if spring.on else 0.5, _FITTED)
    pull = replace(spring, stiffness=1.0)(law(kappa))
    asked = unit * law(kappa, 2)
    size = float(np.abs(asked).max() / np.abs(pull).max())  # convex in the stiffness: one least
    found = minimize_scalar(
        lambda share: magnitude(asked - share * size * pull),
        bounds=(0.0, 4.0),
        method="bounded",
        options={"xatol": 1e-9},
    )
    return replace(spring, stiffness=float(found.x) * size)


@dataclass(frozen=True)
class OnLink:
    """The spring's torque by the link's angle, which runs from 0 to `stroke`, rad, of either sign."""

    spring: SpringTorque
    stroke: float

    def __call__(self, angle: Floats) -> Floats:
        """Torque on the link, N m, (n,)."""
        return np.asarray(math.copysign(1.0, self.stroke) * self.spring(angle / self.stroke))


@dataclass(frozen=True)
class Load:
    """What the follower drives: inertia of the link and of the follower, friction at the link, gear ratio link / follower."""

    inertia: float
    follower_inertia: float
    friction: float
    ratio: float


@dataclass(frozen=True)
class Torques:
    """Over the turn, each (n,), N m: inertia and spring torque at the link; demand at the follower's axle, and torque that
    the cam shaft must give, without the unloader (`bare`) and with it."""

    inertia: Floats
    spring: Floats
    follower_bare: Floats
    follower: Floats
    shaft_bare: Floats
    shaft: Floats


def torques(
    s: Sequence[Floats],
    swing: float,
    omega: float,
    load: Load,
    spring: SpringTorque | None,
    engaged: Any = True,
) -> Torques:
    """Torques for the follower's angle and its derivatives to theta of order 0, 1, 2, each (n,); omega: cam shaft, rad/s.

    engaged: (n,) whether the follower takes the link along.
    """
    angle, slope, bend = s
    moving = np.where(np.abs(slope) > 1e-12 * swing, slope, 0.0)
    inertia = np.where(engaged, load.inertia * load.ratio * bend * omega**2, 0.0)
    resisting = np.where(engaged, load.friction * np.sign(omega * moving), 0.0)
    pull = np.zeros(len(angle)) if spring is None else spring(angle / swing)
    own = load.follower_inertia * bend * omega**2
    bare = load.ratio * (inertia + resisting) + own
    helped = bare - load.ratio * np.where(engaged, pull, 0.0)
    return Torques(inertia, pull, bare, helped, bare * slope, helped * slope)


def peak(values: Any, where: Any) -> float:
    """Largest magnitude where the mask holds; 0 where it nowhere does."""
    chosen = np.abs(np.asarray(values))[where]
    return float(chosen.max()) if len(chosen) else 0.0
