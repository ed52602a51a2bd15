"""What the followers of a machine's cams do by the angle of their cams: for timing diagrams and for drives in their place."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from camgen.geometry.outlines import Floats
from camgen.machine.model import Cam
from camgen.machines.mechanism import Mechanism
from camgen.numerics import distinct, peak

_PLACES = np.linspace(0, 360, 14_401)
_BESIDE = 1e-7  # deg, from an angle at which a velocity may jump


@dataclass(frozen=True)
class FollowerMotion:
    """What a cam's follower does by the angle of its cam, deg from 0 to 360 in the sense of turning.

    unit: "mm" or "deg"; law: (deg, order) -> the follower or its derivative per deg; breaks: deg, where a derivative may jump.
    """

    name: str
    unit: str
    law: Callable[[Floats, int], Floats]
    breaks: Floats

    @cached_property
    def stroke(self) -> float:
        """Way of the follower."""
        return float(np.ptp(self.law(_PLACES, 0)))

    @cached_property
    def corner(self) -> float:
        """The largest jump of its velocity, per deg."""
        before, after = (self.law(self.breaks + side, 1) for side in (-_BESIDE, _BESIDE))
        return peak(after - before) if self.breaks.size else 0.0

    def off(self, curve: Callable[[Floats, int], Floats], order: int = 0) -> float:
        """The most by which another curve leaves it, or a derivative of it, over the turn."""
        return peak(curve(_PLACES, order) - self.law(_PLACES, order))


def follower_motions(mechanism: Mechanism) -> Iterator[FollowerMotion]:
    """Those of all cams of a machine."""
    sense = mechanism.assembly.cycle.sense
    for joint in mechanism.model.joints:
        if isinstance(joint, Cam):
            yield _motion(joint, sense)


def _motion(joint: Cam, sense: int) -> FollowerMotion:
    swings = joint.slide is None
    scale = math.degrees(1.0) if swings else 1.0
    rate = sense * math.radians(1.0)

    def law(x: Floats, order: int) -> Floats:
        x = np.asarray(x, float)
        value = joint.law(rate * x.ravel() - joint.phase, order).reshape(x.shape)
        return np.asarray(scale * rate**order * value)

    breaks = np.asarray(getattr(joint.law, "breaks", ()), float)
    turned = np.degrees(sense * (breaks + joint.phase)) % 360
    return FollowerMotion(joint.name, "deg" if swings else "mm", law, distinct(turned))
