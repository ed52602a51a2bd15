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
from camgen.numerics import magnitude

Characteristic = Callable[[Floats], Floats]

# Positions of the run-up at which the objective counts; the peaks between them are higher by 3e-4 at most.
_POSITIONS = 121
# A slope of G is taken over this share of the stroke: short against what a spring's torque changes over.
_SLOPE = 1e-6
_STEPS = 300  # of a search, at most


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
    program = _Program(torque, weight, sines, cosines)
    x = program.solved(program.first if start is None else program.variables(start))
    n = program.terms
    # the search closes to its tolerance, this to rounding
    best = [float(c) for c in x[:n] / (program.closes @ x[:n])]
    return judged(torque, best[:sines], best[sines:], weight, float(x[n]) / program.size)


class _Program:
    """The search for the coefficients as a nonlinear program.

    x: its variables, coefficients, factor * size, C, Y. With the coefficients alone a = kappa + moves x, c = pulls x, and the
    law closes where closes x = 1. size: greatest torque of the run-up.
    """

    def __init__(self, torque: Characteristic, weight: float, sines: int, cosines: int) -> None:
        """DesignError where the spring does not pull."""
        self.torque = torque
        self.weight = weight
        self.terms = sines + cosines
        self.kappa = np.linspace(0, 0.5, _POSITIONS)
        w, z = harmonics(sines, cosines)
        x_w = np.multiply.outer(self.kappa, w)
        x_z = np.multiply.outer(self.kappa, z)
        fall = 1 - 2 * self.kappa[:, None]
        self.moves = np.hstack((-np.sin(x_w) / w**2, (fall - np.cos(x_z)) / z**2))
        self.pulls = np.hstack((np.sin(x_w), np.cos(x_z)))
        self.closes = np.concatenate((1 / w, 2 / z**2))
        self.size = magnitude(torque(self.kappa))
        if not 0 < self.size < math.inf:
            remedy = "give a spring that pulls over the stroke"
            raise DesignError("spring torque", self.size, 0.0, "", "the run-up", remedy)

    @property
    def first(self) -> Floats:
        """The cycloidal law."""
        x = np.zeros(self.terms + 3)
        x[0] = 2 * math.pi
        x[self.terms :] = 2 * math.pi
        return x

    def variables(self, law: Synthesis) -> Floats:
        """Those of a law that was found."""
        return np.array([*law.sines, *law.cosines, law.factor * self.size, law.peak, law.rest])

    def effort(self, x: Floats) -> tuple[Floats, Floats]:
        """G / size at the positions, and its slope over a."""
        a = np.clip(self.kappa + self.moves @ x[: self.terms], 0.0, 0.5)
        near = np.maximum(a - _SLOPE, 0)
        far = np.minimum(a + _SLOPE, 0.5)
        rise = self.torque(far) - self.torque(near)
        return self.torque(a) / self.size, rise / self.size / (far - near)

    def margins(self, x: Floats) -> Floats:
        """Of C and Y over what they bound, to either side: to be 0 or more."""
        n = self.terms
        c = self.pulls @ x[:n]
        balance = c - x[n] * self.effort(x)[0]
        return np.concatenate((x[n + 1] - c, x[n + 1] + c, x[n + 2] - balance, x[n + 2] + balance))

    def margin_slopes(self, x: Floats) -> Floats:
        """Their derivatives to the variables."""
        g, slope = self.effort(x)
        balance = np.hstack((self.pulls - x[self.terms] * slope[:, None] * self.moves, -g[:, None]))
        zero = np.zeros((_POSITIONS, 1))
        one = np.ones((_POSITIONS, 1))
        return np.block(
            [[sign * self.pulls, zero, one, zero] for sign in (-1, 1)]
            + [[sign * balance, zero, one] for sign in (-1, 1)]
        )

    def solved(self, start: Floats) -> Floats:
        """The variables at the least Q, from a start; DesignError where the search does not settle."""
        from scipy.optimize import minimize

        n = self.terms
        # Q is scaled by a weight of its own, so that a search with a large q is as well conditioned as one with a small.
        scale = 1 / (36 * (1 + self.weight))
        optimum: Any = minimize(
            lambda x: scale * (x[n + 1] ** 2 + self.weight * x[n + 2] ** 2),
            start,
            jac=lambda x: np.concatenate(
                (np.zeros(n + 1), 2 * scale * np.array([x[n + 1], self.weight * x[n + 2]]))
            ),
            constraints=(
                {"type": "ineq", "fun": self.margins, "jac": self.margin_slopes},
                {
                    "type": "eq",
                    "fun": lambda x: self.closes @ x[:n] - 1,
                    "jac": lambda x: np.concatenate((self.closes, np.zeros(3))),
                },
            ),
            method="SLSQP",
            options={"ftol": 1e-12, "maxiter": _STEPS},
        )
        if optimum.success and np.all(np.isfinite(optimum.x)):
            return np.asarray(optimum.x)
        where = f"weight {self.weight:g}"
        error = DesignError(
            "steps of the search", optimum.nit, _STEPS, "", where, "use another weight"
        )
        raise error.saying(
            f"no law was found for the {where} in {optimum.nit} steps: {optimum.message}"
        )


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
