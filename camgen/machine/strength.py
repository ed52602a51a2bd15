"""What a contact, a pin and a bearing bear: closed formulas, vectorised; mm, N, MPa, s.

line contact    half width b = sqrt(4 F R / (pi L E*)), greatest pressure p = 2 F / (pi b L), with
                1/R = 1/R1 + 1/R2 and 1/E* = (1 - nu1^2)/E1 + (1 - nu2^2)/E2
                [Hertz; Norton, Machine Design, eqs. 7.14, 7.15; Roark's Formulas for Stress and Strain, table 14.1, case 2]
pin             bent as a beam that is held at one end, 32 F l / (pi d^3); sheared by 4/3 of F / area [beam theory]
plain bearing   pressure F / (d l) on the projected area; sliding speed at its rim; heat: friction times both
rolling bearing life (C / P)^p million turns, P the mean of that power of the load over the turning; p = 3 of balls, 10/3 of
                rollers [ISO 281]
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from camgen.numerics import Floats

YIELDS = 1.79  # pressure of a line contact over the yield stress where it first flows [Johnson, Contact Mechanics; von Mises]
SHEAR = 1 / math.sqrt(3)  # of what a material bears in tension, in shear [von Mises]


@dataclass(frozen=True)
class Elastic:
    """A material as a contact sees it: Young's modulus, MPa, and Poisson's ratio."""

    modulus: float
    poisson: float

    @property
    def compliance(self) -> float:
        """(1 - nu^2) / E, 1/MPa."""
        return (1 - self.poisson**2) / self.modulus


def line_contact(
    force: Any, length: float, curvature: Any, a: Elastic, b: Elastic
) -> tuple[Any, Any]:
    """Greatest pressure, MPa, and half width, mm, of two cylinders pressed together; (n,) or scalars.

    force: N; length: of the line, mm; curvature: of both together, 1/R1 + 1/R2, 1/mm, below 0 inside a hollow that fits
    (none is then left: 0). A force below 0 presses nothing.
    """
    push = np.maximum(force, 0.0)
    bend = np.maximum(curvature, 0.0)
    give = a.compliance + b.compliance
    pressure = np.sqrt(push * bend / (math.pi * length * give))
    with np.errstate(all="ignore"):
        width = np.where(
            bend > 0,
            np.sqrt(4 * push * give / (math.pi * length * np.where(bend > 0, bend, 1.0))),
            np.inf,
        )
    return pressure, width


def pin_bending(force: Any, lever: float, diameter: float) -> Any:
    """Stress at the root of a round pin that is held at one end, MPa; lever: to where it is loaded, mm."""
    return 32 * np.abs(force) * lever / (math.pi * diameter**3)


def pin_shear(force: Any, diameter: float) -> Any:
    """Greatest shear stress in a round section, MPa: 4/3 of its mean."""
    return 16 * np.abs(force) / (3 * math.pi * diameter**2)


def shaft_twist(torque: Any, diameter: float) -> Any:
    """Shear stress of a round shaft under a torque in N mm, MPa."""
    return 16 * np.abs(torque) / (math.pi * diameter**3)


def flat_pressure(torque: Any, diameter: float, depth: float, length: float) -> Any:
    """Greatest pressure of a shaft's flat on its hub, MPa, under a torque in N mm: at the edge of the half that bears.

    depth: of the flat; length: of the hub, mm. Pressure is taken to grow evenly from the middle of the flat, as of a stiff shaft
    in an elastic hub, and what the round side bears has no lever: 3 T / (length half^2), half the flat's width [statics].
    """
    half = math.sqrt(depth * (diameter - depth))
    return 3 * np.abs(torque) / (length * half**2)


@dataclass(frozen=True)
class Sliding:
    """A plain bearing over its motion, (n,) each: pressure, MPa, sliding speed, m/s, and friction's heat, W."""

    pressure: Floats
    speed: Floats
    heat: Floats

    @property
    def pv(self) -> float:
        """Mean of pressure times speed, MPa m/s: what it has to bear as heat."""
        return float(np.mean(self.pressure * self.speed))

    @property
    def power(self) -> float:
        """Mean heat, W."""
        return float(np.mean(self.heat))


def sliding(force: Any, turning: Any, diameter: float, length: float, friction: float) -> Sliding:
    """A round plain bearing: force N, relative angular speed rad/s, (n,) each; mm."""
    load = np.abs(force)
    speed = np.abs(turning) * diameter / 2 * 1e-3
    return Sliding(
        np.asarray(load / (diameter * length)),
        np.asarray(speed),
        np.asarray(friction * load * speed),
    )


BALLS = 3.0  # exponent of a bearing's life [ISO 281; skf.com, basic rating life]


def mean_load(force: Any, turning: Any, exponent: float = BALLS) -> float:
    """Equivalent load of a bearing whose load and speed change: mean of that power over the turning, N."""
    share = np.abs(turning)
    return (
        float((np.sum(np.abs(force) ** exponent * share) / np.sum(share)) ** (1 / exponent))
        if np.any(share)
        else 0.0
    )


def bearing_life(rating: float, load: float, exponent: float = BALLS) -> float:
    """Turns that nine of ten bearings reach: (C / P)^exponent million; rating C and load P in the same unit."""
    return 1e6 * (rating / load) ** exponent if load else math.inf
