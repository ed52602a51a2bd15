"""Synthesis of a Fourier law from the characteristic of a spring unloader, which is geared to the driven link.

    kappa            share of the turn's time, 0..1; a, b, c displacement, speed, acceleration of the link over kappa
    characteristic   the spring's torque G over the position a, in any unit, positive where it speeds the link up; given
                     for the run-up 0 <= a <= 1/2. On the run-down the spring takes back what it gave: G(1 - a) = -G(a)
    effort           P = f G(a(kappa)), the spring's torque in units of c; f is the factor that the spring's size sets
    peak             C = max |c|, to which inertia torque and load of the link are proportional
    rest             Y = max |c - P|: what the spring leaves for the cam to do, in units of c

The objective is Q = C^2 + q Y^2 with the weight q, over the law's coefficients and the factor, for laws that close
(start and end at rest): q = 0 asks for the lowest acceleration, whatever the spring; a large q for a law that moves
the link as the spring would do alone.

[Analysis and recommendations for choosing cam mechanisms for pad-printing machines combined with unloading devices (in
Ukrainian): Q = A^2 + q Y^2 with a first symbol that the scan spoils, and P = Y G. It says that the objective limits
the peak of acceleration at the price of some mismatch of acceleration and balancing effort. The card of law MR-13
prints Y = 4.640648, there the factor f of P; its scheme, and with it G, is not in the scan. Y as the mismatch is our
definition: it makes the sentence true; `Synthesis.factor` is the card's Y.]
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from camgen.errors import DesignError, Fault, SpecError
from camgen.motion.laws import Floats, Law, fourier, harmonics, largest

Characteristic = Callable[[Floats], Floats]

# Positions of the run-up at which the objective counts; the peaks between them are higher by 3e-4 at most.
_POSITIONS = 121
# A slope of G is taken over this share of the stroke: short against what a spring's torque changes over.
_SLOPE = 1e-6


@dataclass(frozen=True)
class Synthesis:
    """The best law for a weight q: coefficients, and on the continuum peak C, rest Y and objective Q; factor f of P = f G."""

    law: Law
    sines: tuple[float, ...]
    cosines: tuple[float, ...]
    weight: float
    peak: float
    rest: float
    factor: float

    @property
    def objective(self) -> float:
        """Q = C^2 + q Y^2."""
        return self.peak**2 + self.weight * self.rest**2


def characteristic(points: Sequence[tuple[float, float]]) -> Characteristic:
    """G through (position, torque) points by monotone cubics, positions growing from 0 to 1/2.

    SpecError, with all that is wrong, where they do not.
    """
    from scipy.interpolate import PchipInterpolator

    table = np.array(points, float).reshape(-1, 2)
    faults = []
    if len(table) < 3 or table[0, 0] != 0 or table[-1, 0] != 0.5:
        faults.append(
            Fault(
                ("points",),
                f"{len(table)} of them",
                "3 or more, from position 0 to 0.5, the middle of the stroke",
            )
        )
    for k in np.flatnonzero(~(np.diff(table[:, 0]) > 0)) + 1:
        faults.append(
            Fault(
                ("points", int(k)),
                f"{table[k, 0]:g}",
                f"a position greater than the one before, {table[k - 1, 0]:g}",
            )
        )
    if faults:
        raise SpecError(faults)
    curve = PchipInterpolator(*table.T)

    def torque(a: Floats) -> Floats:
        return np.asarray(curve(np.clip(a, 0.0, 0.5)))

    return torque


def synthesise(
    torque: Characteristic,
    weight: float,
    sines: int = 5,
    cosines: int = 1,
    start: Synthesis | None = None,
) -> Synthesis:
    """The Fourier law with so many sines and cosines that minimises Q = C^2 + q Y^2 for the spring's torque G(a).

    start: a solution near by, such as that of the last weight; otherwise the search begins with the cycloidal law.
    SpecError where weight is negative or the law has fewer than two terms; DesignError where the spring does not pull
    or the search does not settle.
    """
    from scipy.optimize import minimize

    faults = (
        [Fault(("weight",), f"{weight:g}", "a number >= 0")] if not 0 <= weight < math.inf else []
    )
    if sines < 1 or cosines < 0 or sines + cosines < 2:
        faults.append(
            Fault(
                ("sines",),
                f"{sines} and {cosines} cosines",
                "at least one sine, and two terms in all",
            )
        )
    if faults:
        raise SpecError(faults)
    kappa = np.linspace(0, 0.5, _POSITIONS)
    w, z = harmonics(sines, cosines)
    # a = kappa + moves x, c = pulls x, linear in the coefficients x.
    x_w = np.multiply.outer(kappa, w)
    x_z = np.multiply.outer(kappa, z)
    moves = np.hstack((-np.sin(x_w) / w**2, (1 - 2 * kappa[:, None] - np.cos(x_z)) / z**2))
    pulls = np.hstack((np.sin(x_w), np.cos(x_z)))
    closes = np.concatenate((1 / w, 2 / z**2))
    n = sines + cosines
    size = float(np.max(np.abs(torque(kappa))))
    if not 0 < size < math.inf:
        raise DesignError(
            "spring torque", size, 0.0, "", "the run-up", "give a spring that pulls over the stroke"
        )

    def effort(x: Floats) -> tuple[Floats, Floats]:
        """G / size at the positions, and its slope over a."""
        a = np.clip(kappa + moves @ x[:n], 0.0, 0.5)
        near = np.maximum(a - _SLOPE, 0)
        far = np.minimum(a + _SLOPE, 0.5)
        return torque(a) / size, (torque(far) - torque(near)) / size / (far - near)

    # Variables: coefficients, factor * size, C, Y; all margins are to be 0 or more.
    def margins(x: Floats) -> Floats:
        c = pulls @ x[:n]
        balance = pulls @ x[:n] - x[n] * effort(x)[0]
        return np.concatenate((x[n + 1] - c, x[n + 1] + c, x[n + 2] - balance, x[n + 2] + balance))

    def margin_slopes(x: Floats) -> Floats:
        g, slope = effort(x)
        balance = np.hstack((pulls - x[n] * slope[:, None] * moves, -g[:, None]))
        zero = np.zeros((_POSITIONS, 1))
        one = np.ones((_POSITIONS, 1))
        return np.block(
            [[sign * pulls, zero, one, zero] for sign in (-1, 1)]
            + [[sign * balance, zero, one] for sign in (-1, 1)]
        )

    # Q is scaled by a weight of its own, so that a search with a large q is as well conditioned as one with a small.
    scale = 1 / (36 * (1 + weight))
    if start is None:
        x = np.zeros(n + 3)
        x[0] = 2 * math.pi
        x[n] = x[n + 1] = x[n + 2] = 2 * math.pi
    else:
        x = np.array([*start.sines, *start.cosines, start.factor * size, start.peak, start.rest])
    optimum: Any = minimize(
        lambda x: scale * (x[n + 1] ** 2 + weight * x[n + 2] ** 2),
        x,
        jac=lambda x: np.concatenate(
            (np.zeros(n + 1), 2 * scale * np.array([x[n + 1], weight * x[n + 2]]))
        ),
        constraints=(
            {"type": "ineq", "fun": margins, "jac": margin_slopes},
            {
                "type": "eq",
                "fun": lambda x: closes @ x[:n] - 1,
                "jac": lambda x: np.concatenate((closes, np.zeros(3))),
            },
        ),
        method="SLSQP",
        options={"ftol": 1e-12, "maxiter": 300},
    )
    x = optimum.x
    if not optimum.success or not np.all(np.isfinite(x)):
        message = (
            f"no law was found for the weight {weight:g} in {optimum.nit} steps: {optimum.message}"
        )
        raise DesignError(
            "steps of the search",
            optimum.nit,
            300,
            "",
            f"weight {weight:g}",
            "use another weight",
        ).saying(message)
    best = [
        float(c) for c in x[:n] / (closes @ x[:n])
    ]  # the search closes to its tolerance, this to rounding
    return judged(torque, best[:sines], best[sines:], weight, float(x[n]) / size)


def judged(
    torque: Characteristic,
    sines: Sequence[float],
    cosines: Sequence[float],
    weight: float,
    factor: float | None = None,
) -> Synthesis:
    """Peak and rest of a given Fourier law on the continuum; without a factor, with the one that leaves the least rest."""
    law = fourier(sines, cosines, source="synthesis from a spring's characteristic")

    def rest(f: float) -> float:
        return largest(lambda u: law(u / 2, 2) - f * torque(law(u / 2)))

    if factor is None:
        from scipy.optimize import minimize_scalar

        kappa = np.linspace(0, 0.5, _POSITIONS)
        c = law(kappa, 2)
        g = torque(law(kappa))
        about = float(c @ g / (g @ g))
        factor = float(minimize_scalar(rest, bracket=(0.9 * about, 1.1 * about), tol=1e-12).x)
    return Synthesis(law, tuple(sines), tuple(cosines), weight, law.c_a, rest(factor), factor)


def trade_off(
    torque: Characteristic, weights: Sequence[float], sines: int = 5, cosines: int = 1
) -> list[Synthesis]:
    """The best law for each weight, in the order given: peak against rest, each search starting from the one before."""
    laws: list[Synthesis] = []
    for weight in weights:
        laws.append(synthesise(torque, weight, sines, cosines, laws[-1] if laws else None))
    return laws
