"""The follower as one elastic degree of freedom: a mass m behind a stiffness k that the cam drives by s.

    y'' + 2 z w y' + w^2 y = w^2 s + 2 z w s',   w^2 = k / m, z: damping ratio   [Norton, Cam Design and Manufacturing Handbook]

x = y - s is the vibration that the law excites: x'' + 2 z w x' + w^2 x = -s''. Over a turn that repeats itself every harmonic of
s'' answers by itself; after a rise into a dwell an undamped follower goes on swinging by |integral of s'' exp(i w t) dt| / w.
Units go together: s in mm with k in N/mm and m in 1000 kg, or rad, N m/rad, kg m^2.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from camgen.numerics import Floats

_LEAST = 1e-9  # damping ratio, so that resonance is large and not endless
_STEPS = 4096  # of a rise, over which its integral is taken
_FASTEST = 20.0  # times the speed, up to which the loss of contact is looked for
_FINE = 200  # speeds that are tried up to there


def residual(acceleration: Callable[[Floats], Floats], span: float, frequency: float) -> float:
    """Amplitude of an undamped follower after a rise that takes `span` s; frequency: rad/s; acceleration: of s at t, (n,), its
    unit per s^2. In the unit of s."""
    edges = np.linspace(0.0, span, _STEPS + 1)
    middle, half = (edges[1:] + edges[:-1]) / 2, span / _STEPS / 2
    points = np.concatenate([middle - half * math.sqrt(0.6), middle, middle + half * math.sqrt(0.6)])  # Gauss, three points
    weights = half / 9 * np.repeat([5.0, 8.0, 5.0], _STEPS)
    return float(abs(np.sum(weights * acceleration(points) * np.exp(1j * frequency * points))) / frequency)


@dataclass(frozen=True)
class Elastic:
    """frequency: w, rad/s; damping: ratio z."""

    frequency: float
    damping: float

    def vibration(self, acceleration: Floats, speed: float) -> tuple[Floats, Floats]:
        """x and y'' over a turn that repeats itself, (n,) each; acceleration: s'' to theta, (n,) evenly over the turn without its
        end, unit/rad^2; speed: rad/s."""
        drive = speed**2 * np.fft.rfft(acceleration)
        w = abs(speed) * np.arange(len(drive))
        answer = -drive / (self.frequency**2 - w**2 + 2j * max(self.damping, _LEAST) * self.frequency * w)
        x = np.fft.irfft(answer, len(acceleration))
        bend = np.fft.irfft(drive - w**2 * answer, len(acceleration))
        return np.asarray(x), np.asarray(bend)

    def loses_contact(self, acceleration: Floats, speed: float, mass: float, pressed: Floats) -> float:
        """Least speed, rad/s, at which mass times y'' pulls the follower off what presses it on, (n,) N or N m; inf up to 20
        times the given speed. Signs: s and what presses grow away from the cam and towards it."""
        before = 0.0
        for share in np.linspace(0.0, _FASTEST, _FINE + 1)[1:]:
            fast = float(share) * abs(speed)
            if self._lost(acceleration, fast, mass, pressed):
                low, high = before, fast
                while high - low > 1e-4 * high:
                    middle = (low + high) / 2
                    low, high = (low, middle) if self._lost(acceleration, middle, mass, pressed) else (middle, high)
                return high
            before = fast
        return math.inf

    def _lost(self, acceleration: Floats, speed: float, mass: float, pressed: Floats) -> bool:
        return bool(np.any(pressed + mass * self.vibration(acceleration, speed)[1] < 0))
