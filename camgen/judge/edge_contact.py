"""A follower of any outline on a cam: what `contact` says of round tips and flat faces, by the general pair of outlines."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from camgen.geometry.rings import Floats, Ring
from camgen.judge.contact import Touch
from camgen.judge.pair_events import Slide, Turn
from camgen.judge.pairs import Body, OutlinePair, PairMotion, Rest, pivots_apart
from camgen.machine.model import Law
from camgen.numerics import ASKED, latest

_STEP = math.radians(0.5)  # of the cam, from sample to sample of the follower's way
_TURN = 2 * math.pi


@dataclass(frozen=True, eq=False)
class EdgeContact:
    """A shoe held on a cam by a spring.

    cam: about its shaft; shoe: at s = 0, about its own pivot, or about the shaft where it slides; apart: from the shaft to that
    pivot, complex mm; leaves: the sense of s that takes it off; wanted: the law that is meant, from which it is followed.
    """

    cam: Ring
    shoe: Ring
    apart: complex
    freedom: Turn | Slide
    leaves: int
    wanted: Law

    form = None  # no closed form

    @cached_property
    def pair(self) -> OutlinePair:
        """Both bodies."""
        cam = Body([self.cam])
        shoe = Body([self.shoe])
        return OutlinePair(cam, shoe, pivots_apart(self.apart), self.freedom, rest=self._side)

    @property
    def _side(self) -> Rest:
        """The bound on which it rests."""
        return "low" if self.leaves > 0 else "high"

    @cached_property
    def motion(self) -> PairMotion:
        """Where it is free of the cam over a turn."""
        theta = np.linspace(0.0, _TURN, math.ceil(_TURN / _STEP) + 1)
        return self.pair.follow(theta, float(self.wanted(np.zeros(1), 0)[0]))

    @property
    def changes(self) -> Floats:
        """None are looked for: the judged angles lie close enough to all facets."""
        return np.empty(0)

    def angle(self, theta: ArrayLike) -> Floats:
        """As `RollingContact.angle`."""
        return self.touch(theta).angle

    def touch(self, theta: ArrayLike) -> Touch:
        """As `RollingContact.touch`; element: of the cam, -1 where it is off."""
        return self._at(theta)[0]

    def slope(self, theta: Floats) -> Floats:
        """Derivative of s to the cam's angle, (n,)."""
        return self._at(theta)[1]

    @cached_property
    def _at(self) -> Callable[[ArrayLike], tuple[Touch, Floats]]:
        """Touch and slope, which are asked for at the same angles."""
        return latest(self._followed, ASKED)

    def _followed(self, theta: Floats) -> tuple[Touch, Floats]:
        turned, back = np.unique(np.mod(theta.ravel(), _TURN), return_inverse=True)
        bounds = self.motion.bounds(turned)
        low = self.leaves > 0
        touch = self.motion.touch(bounds, "low" if low else "high")
        value = bounds.low if low else bounds.high
        element = (bounds.low_pair if low else bounds.high_pair)[:, 0]
        shape = theta.shape
        touched = Touch(
            value[back].reshape(shape),
            touch.pressure_angle[back].reshape(shape),
            element[back].reshape(shape),
            np.full(shape, np.nan),
        )
        return touched, np.asarray(touch.slope[back].reshape(shape))
