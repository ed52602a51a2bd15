"""The follower as one elastic degree of freedom: a mass m behind a stiffness k that the cam drives by s.

    m y'' + c y' + K y = k (s - y) + d (s' - y')        y = 0 where it stands still at s = 0

    k, d    of the follower from its cam to its mass; d = 2 z sqrt(k m), z: damping ratio
    K, c    of what holds the mass on the ground: the spring that presses it on the cam, and a drag in proportion to its speed

[Norton, Cam Design and Manufacturing Handbook, with the terms of the spring and the drag]  Standing still the mass follows by
k s / (k + K): the spring bends the follower. v = y - k s / (k + K) is the vibration that the law excites. Over a turn that
repeats itself every harmonic answers by itself:

    V (k + K - m w^2 + i w (c + d)) (k + K) = S (k m w^2 + i w (d K - c k))

After a rise into a dwell an undamped follower goes on swinging by k / (k + K) |integral of s'' exp(i w t) dt| / w.
Units go together: s in mm with k in N/mm, m in 1000 kg and c in N s/mm, or rad, N m/rad, kg m^2, N m s/rad.
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
_SLOWEST = 1e-6  # of it: a follower that nothing presses on is off at any speed
_FINE = 200  # speeds that are tried up to there


def residual(acceleration: Callable[[Floats], Floats], span: float, frequency: float) -> float:
    """Amplitude of an undamped follower without a spring after a rise that takes `span` s; frequency: rad/s; acceleration: of s
    at t, (n,), its unit per s^2. In the unit of s."""
    edges = np.linspace(0.0, span, _STEPS + 1)
    middle = (edges[1:] + edges[:-1]) / 2
    half = span / _STEPS / 2
    points = np.concatenate(
        [middle - half * math.sqrt(0.6), middle, middle + half * math.sqrt(0.6)]
    )  # Gauss, three points
    weights = half / 9 * np.repeat([5.0, 8.0, 5.0], _STEPS)
    return float(
        abs(np.sum(weights * acceleration(points) * np.exp(1j * frequency * points))) / frequency
    )


@dataclass(frozen=True)
class Excitation:
    """What the cam does over a turn that repeats itself, evenly without its end."""

    displacement: Floats  # s, (n,)
    acceleration: Floats  # s'' to theta, (n,) per rad^2


@dataclass(frozen=True)
class Response:
    """What the mass does over the same turn."""

    vibration: Floats  # v, (n,), in the unit of s
    behind: Floats  # y - s, (n,)
    velocity: Floats  # y', (n,) per s
    acceleration: Floats  # y'', (n,) per s^2


@dataclass(frozen=True)
class Elastic:
    """An elastic follower, in units that go together."""

    mass: float  # m, of what moves behind the stiffness
    stiffness: float  # k
    damping_ratio: float  # z, share of the critical damping
    spring: float = 0.0  # K
    drag: float = 0.0  # c

    @property
    def frequency(self) -> float:
        """Its own, undamped, the cam standing still, rad/s."""
        return math.sqrt((self.stiffness + self.spring) / self.mass)

    @property
    def share(self) -> float:
        """Of the cam's displacement, by which the mass follows where all stands still."""
        return self.stiffness / (self.stiffness + self.spring)

    def response(self, cam: Excitation, speed: float) -> Response:
        """The mass over a turn; speed: of the cam, rad/s."""
        m = self.mass
        k = self.stiffness
        spring = self.spring
        drag = self.drag
        damping = 2 * max(self.damping_ratio, _LEAST) * math.sqrt(k * m)
        count = len(cam.acceleration)
        drive = speed**2 * np.fft.rfft(cam.acceleration)  # of s'' to time
        w = speed * np.arange(
            len(drive)
        )  # below 0 where the cam turns clockwise: time then runs against theta
        slow = np.where(w != 0, w, 1.0)  # the mean of s'' is 0
        answer = -drive * (k * m + 1j * (damping * spring - drag * k) / slow)
        answer /= (k + spring) * (k + spring - m * w**2 + 1j * w * (damping + drag))
        answer[0] = 0.0
        vibration = np.fft.irfft(answer, count)
        velocity = np.fft.irfft(self.share * drive / (1j * slow) + 1j * w * answer, count)
        acceleration = np.fft.irfft(self.share * drive - w**2 * answer, count)
        return Response(
            vibration, vibration - (1 - self.share) * cam.displacement, velocity, acceleration
        )

    def push(self, cam: Excitation, speed: float) -> Floats:
        """By how much more the mass presses on the cam than one that is rigid and still, (n,), in the sense of s."""
        response = self.response(cam, speed)
        return np.asarray(
            self.mass * response.acceleration
            + self.drag * response.velocity
            + self.spring * response.behind
        )

    def loses_contact(self, cam: Excitation, speed: float, preload: Floats, leaves: int) -> float:
        """Least speed, rad/s, at which the mass is pulled off what presses it on, (n,) N or N m; inf up to 20 times the given
        speed, in its sense. leaves: +1 or -1, the sense of s that takes it off the cam."""
        before = 0.0
        for fraction in np.linspace(0.0, _FASTEST, _FINE + 1)[1:]:
            fast = float(fraction) * speed
            if self._loses(cam, fast, preload, leaves):
                low = before
                high = fast
                while abs(high - low) > max(1e-4 * abs(high), _SLOWEST * abs(speed)):
                    middle = (low + high) / 2
                    low, high = (
                        (low, middle)
                        if self._loses(cam, middle, preload, leaves)
                        else (middle, high)
                    )
                return abs(high)
            before = fast
        return math.inf

    def _loses(self, cam: Excitation, speed: float, preload: Floats, leaves: int) -> bool:
        return bool(np.any(preload + leaves * self.push(cam, speed) < 0))
