"""The spring that returns a cam's follower: from a pin of the follower to a post beyond the cam.

hook   the spring's end on the follower: the roller's own pin, or a pin of its own
post   the other end on the ground, in line with the pull, beyond the cam

Places are complex mm on the ground at s = 0, about the cam's axis.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Any, NoReturn

import numpy as np

from camgen.errors import DesignError
from camgen.machine.cams.followers import (
    SlidingFace,
    SlidingTip,
    SwingingArm,
)
from camgen.machine.cams.limits import swings
from camgen.machine.cams.profile import DiscCam
from camgen.numerics import Floats, magnitude
from camgen.parts.generator.sizes import Parts
from camgen.parts.springs import EYE, ExtensionSpring, extension_spring, pulling

SAMPLES = np.linspace(0, math.tau, 1440, endpoint=False)  # cam angles at which forces are looked at
_LEAST = 1.0  # N, that a spring pulls with at least: guides rub
_OVER = 1.5  # of what keeps contact
_STRETCHED = (0.4, 0.3, 0.5, 0.2, 0.6, 0.1)  # of a spring's length, where it is shortest
_AIR = 1.0  # mm, between cam and post
_BACK = 3.0  # radii of a hub, from an edge or face to the pin of the spring


@dataclass(frozen=True, eq=False)
class ReturnSpring:
    """Where it hangs, and which one it is."""

    cam: DiscCam[Any]
    rolls: bool  # whether the follower has a roller
    sizes: Parts
    play: float  # mm, of what moves past each other
    rate: float = 0.0  # wanted on the follower, N/mm or N m/rad; 0: found
    preload: float = 0.0  # wanted where the follower is lowest, N or N m; 0: found
    place: complex | None = None  # wanted of its post; None: found
    lasting: bool = False  # whether it is to work for ever

    @cached_property
    def hooked(self) -> complex:
        """Its end from the follower's pivot, or from the axis where it slides; DesignError where there is no room for a pin."""
        follower = self.cam.follower
        back = _BACK * (self.sizes.pin_diameter / 2 + self.sizes.wall)
        match follower:
            case SlidingTip(start, along) | SlidingFace(start, along):
                return complex(start if self.rolls else start + follower.leaves * along * back)
            case SwingingArm(pivot, arm):
                away = pivot + arm
                return complex(arm if self.rolls else arm + away / abs(away) * back)
        raise DesignError(
            "pins of a spring on the arm of a face",
            1,
            0,
            "",
            "the follower",
            'give it a roller, or make the cams alone (parts.make = "cams")',
        )

    @property
    def hook(self) -> complex:
        """Its end on the follower."""
        return self.hooked + (self.cam.follower.pivot if swings(self.cam) else 0j)

    def _moved(self, s: Any) -> tuple[Any, Any]:
        """The hook at displacements s, and its derivative to s, (n,) complex each."""
        follower = self.cam.follower
        if swings(self.cam):
            arm = self.hooked * np.exp(1j * s)
            return follower.pivot + arm, 1j * arm
        return self.hooked + s * follower.along, np.full(np.shape(s), follower.along)

    @cached_property
    def _s(self) -> Floats:
        return self.cam.program(SAMPLES)

    @cached_property
    def post(self) -> complex:
        """Its end on the ground."""
        return self.found_post if self.place is None else self.place

    @cached_property
    def found_post(self) -> complex:
        """In line with the pull at half of the way, beyond the cam."""
        at, slope = self._moved(np.ptp(self._s) / 2 + np.min(self._s))
        way = complex(-self.cam.follower.leaves * slope / abs(slope))
        rim = magnitude(self.cam.profile(SAMPLES))
        clear = rim + self.sizes.pin_diameter / 2 + self.sizes.head + self.play + _AIR
        beside = (at * way.conjugate()).imag
        length = math.sqrt(max(0.0, clear**2 - beside**2)) - (at * way.conjugate()).real
        return complex(at + max(length, clear) * way)

    @property
    def askew(self) -> tuple[float, float]:
        """Greatest angle between its pull and the follower's way back over the turn, and the cam angle there, both rad."""
        at, slope = self._moved(self._s)
        angle = np.abs(np.angle((self.post - at) / (-self.cam.follower.leaves * slope)))
        k = int(np.argmax(angle))
        return float(angle[k]), float(SAMPLES[k])

    @cached_property
    def lengths(self) -> Floats:
        """Distance between the middles of its pins over the turn, mm, (n,)."""
        return np.asarray(np.abs(self._moved(self._s)[0] - self.post))

    @property
    def way(self) -> tuple[float, float]:
        """Its shortest and longest, inside its eyes, mm."""
        pin = self.sizes.pin_diameter
        return float(self.lengths.min()) + pin, float(self.lengths.max()) + pin

    @cached_property
    def lever(self) -> Floats:
        """What a newton of it is to the follower over the turn, N or N m, (n,)."""
        at, slope = self._moved(self._s)
        unit = 1e-3 if swings(self.cam) else 1.0
        return np.asarray(np.abs(((at - self.post).conj() * slope).real / self.lengths) * unit)

    @property
    def _ends(self) -> tuple[float, float]:
        """The lever where it is shortest and longest."""
        lever = self.lever
        return float(lever[np.argmin(self.lengths)]), float(lever[np.argmax(self.lengths)])

    def least_pull(self, effort: Floats) -> float:
        """What it must pull with, N, with something over; effort: of the cam in the sense of the lift, without it, (n,)."""
        missing = float(np.nanmax(np.where(np.isfinite(effort), -effort, 0.0) / self.lever))
        return max(_LEAST, _OVER * missing)

    @property
    def given(self) -> bool:
        """Whether what it pulls with at its shortest is given, so that no force needs to be known."""
        return bool(self.rate or self.preload)

    def spring(self, least: float) -> ExtensionSpring:
        """The one that is wanted, or that pulls with `least` N at its shortest; DesignError where there is none such."""
        eye = EYE * self.sizes.pin_diameter
        hook = self.sizes.hook
        shortest, longest = self.way
        first, last = self._ends
        if not self.rate:
            low = self.preload / first or least
            found = pulling(low, self.way, eye, _STRETCHED, hook, self.lasting)
            return found or self._none_such(f"{low:.4g} N at its shortest")
        low = self.preload / first
        high = (self.preload + self.rate * float(np.ptp(self._s))) / last
        rate = (high - low) / (longest - shortest)
        free = shortest - low / rate if rate > 0 else 0.0
        found = (
            extension_spring(rate, free, self.way, eye, hook, self.lasting) if free > 0 else None
        )
        return found or self._none_such(f"{rate:.4g} N/mm, free length {free:.4g} mm")

    def of_a_shop(self, least: float) -> str:
        """Which other springs do as well, and what the table of the spring is with one."""
        shortest, longest = self.way
        first, last = self._ends
        pull = f"R ({shortest:.5g} - L)"
        keys = f"preload = {pull}, rate = R"
        if swings(self.cam):
            stroke = float(np.ptp(self._s))
            keys = f"preload = {first:.5g} {pull}, rate = ({last:.5g} R ({longest:.5g} - L) - preload) / {stroke:.5g}"
        return (
            f"or from a shop, R N/mm and L mm free inside its eyes: {pull} at least {least:.4g} N, and it may be stretched to "
            f"{longest:.4g}; put it into [spring] beside a [load], in a linkage into [cam.spring], and build again: {keys}"
        )

    def borne(self, spring: ExtensionSpring) -> tuple[float, float]:
        """What it presses the follower with where that is lowest, N or N m, and by how much more for 1 of s, from end to end."""
        first, last = self._ends
        shortest, longest = self.way
        low = first * float(spring.force(shortest))
        high = last * float(spring.force(longest))
        return low, (high - low) / float(np.ptp(self._s))

    def closing(self, spring: ExtensionSpring) -> float:
        """What it presses the follower on its cam with at least, N or N m."""
        return float(np.min(spring.force(self.lengths + self.sizes.pin_diameter) * self.lever))

    def _none_such(self, asked: str) -> NoReturn:
        shortest, longest = self.way
        raise DesignError(
            "return springs of round wire",
            0,
            1,
            "",
            f"{asked}, length from {shortest:.4g} to {longest:.4g} mm",
            "ask for another spring ([spring], load.closing_n_m), less load or speed, or another closure",
        )
