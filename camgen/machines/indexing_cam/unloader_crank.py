"""The unloader as it is made: a crank that is geared to the driven link, and an extension spring from its pin to a post.

                    post
                     |        cord over a guide, spring behind it: as drawn by the source, and by [unloader]
                     | spring straight from pin to post: made; its free length is guide - crank - stretch
      link ==( )==  pin
            gears   crank     it turns 2 (180 - lead) deg while the link turns once

Pin and post are as far apart as pin and guide, so both pull alike at each angle.
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property

import numpy as np

from camgen.errors import DesignError
from camgen.geometry.convex import hull_corners
from camgen.machine.cams.profile import DiscCam, SwingingArm
from camgen.machines.indexing_cam.drawing import Drawing
from camgen.machines.indexing_cam.unloader import LINK, CrankSpring
from camgen.numerics import magnitude
from camgen.parts.generator.sizes import Parts
from camgen.parts.springs import EYE, extension_spring

CRANK = "unloader"
_TEETH = 60  # of a wheel: the most of one part of the ratio
_DIRECTIONS = np.exp(1j * np.linspace(0, math.tau, 72, endpoint=False))
_POSITIONS = np.linspace(0, 1, 25)  # of the stroke, at which the spring's line is looked at
_TOOTH = 2.0  # mm, that a wheel's teeth are higher than its pitch circle, at most
_ROUND = np.linspace(0, math.tau, 181)
_BESIDE = 3.0  # mm, between what moves and posts or shafts

Disc = tuple[complex, float]


@dataclass(frozen=True)
class UnloaderCrank:
    """Where crank and post are, mm on the ground: beside the cams about the origin and their follower, which swings so far, rad.

    link: axle of the driven link, table: radius that its parts take; wheel: pitch radius of the follower's wheel.
    """

    spring: CrankSpring
    link: complex
    table: float
    wheel: float
    cams: Sequence[DiscCam[SwingingArm]]
    swing: float
    sizes: Parts

    @cached_property
    def ratio(self) -> float:
        """Angle of the crank over that of the link, below 0; DesignError where no wheels of so few teeth have it."""
        ratio = self.spring.turn / abs(self.spring.stroke)
        share = Fraction(ratio).limit_denominator(_TEETH)
        if abs(share - ratio) > 1e-9 * ratio or max(share.numerator, share.denominator) > _TEETH:
            near = min(
                (Fraction(n, d) for d in range(1, 13) for n in range(1, 40)),
                key=lambda each: abs(float(each) - ratio),
            )
            lead = math.degrees(math.pi - float(near) * abs(self.spring.stroke) / 2)
            keys = "2 (180 - unloader.lead_deg) / geometry.index_deg"
            key = f"unloader.lead_deg = {lead:.9g}"
            if self.spring.on:
                keys = "360 / geometry.index_deg"
                key = f"geometry.index_deg = {360 / float(near):.9g}"
            raise DesignError(
                "turns of the unloader's crank to one of the driven link",
                ratio,
                float(near),
                "",
                keys,
                f"take a ratio of whole teeth: {key} gives {near}",
            )
        return -ratio

    @property
    def _pivot(self) -> complex:
        return self.cams[0].follower.pivot

    @property
    def _busy(self) -> list[Disc]:
        """What else moves, as discs on the ground: the cams, the follower with its rollers."""
        wide = self.sizes.wall + self.sizes.pin_diameter
        found = [
            (0j, max(magnitude(cam.profile(_ROUND)) for cam in self.cams)),
            (self._pivot, wide),
        ]
        for follower in (cam.follower for cam in self.cams):
            for arm in follower.arm * np.exp(1j * np.linspace(0, self.swing, 9)):
                found += [
                    (self._pivot + arm, max(follower.tip_radius, wide)),
                    (self._pivot + arm / 2, wide),
                ]
        return found

    @cached_property
    def _places(self) -> tuple[complex, complex]:
        """Axle of the crank and post: such that nothing is in their way, and the plate is small."""
        pin = self.sizes.pin_diameter / 2 + self.sizes.head + self.sizes.wall
        reach = self.spring.crank + pin
        found = list[tuple[complex, complex]]()
        far = self.table + reach + _BESIDE
        share = abs(self.ratio) / (1 + abs(self.ratio))
        wheels = [
            (self.link, max(self.table, share * far + _TOOTH)),
            (self._pivot, self.wheel + _TOOTH),
        ]
        places, radii = (np.array([disc[k] for disc in self._busy]) for k in (0, 1))
        for way in _DIRECTIONS:
            axle = complex(self.link + far * way)
            if (
                np.any(np.abs(axle - places) < radii + reach + _BESIDE)
                or abs(axle - self._pivot) < wheels[1][1] + pin + _BESIDE
            ):
                continue
            posts = axle + self.spring.guide * _DIRECTIONS
            free = np.all(np.abs(posts[:, None] - places) > radii + pin + _BESIDE, axis=1)
            for middle, radius in wheels:
                free &= np.abs(posts - middle) > radius + pin + _BESIDE
            found += [(axle, complex(post)) for post in posts[free]]
        found.sort(
            key=lambda pair: tuple(
                np.round([_around([0j, self.link, *pair]), pair[0].imag, pair[1].real], 6)
            )
        )
        over = None  # the first whose spring must lie over something
        for pair in found:
            blocked = self._blocked(*pair, places, radii, pin)
            if blocked == 0:
                return pair
            over = over or (pair if blocked == 1 else None)
        if over is None:
            raise DesignError(
                "places of the unloader's crank and post",
                0,
                1,
                "",
                "[unloader]",
                "use a smaller unloader.crank or a longer unloader.guide, or make the cams alone: parts.make = 'cams'",
            )
        return over

    def _blocked(
        self, axle: complex, post: complex, places: np.ndarray, radii: np.ndarray, pin: float
    ) -> int:
        """0 where the spring passes beside everything, 1 where it must lie over or under something, 2 where over a shaft."""
        pins = axle + self._pin(axle, post) * np.exp(1j * self._turned(_POSITIONS))
        if (
            np.min(_to_lines(np.array([0j, self._pivot, self.link]), pins, post))
            < 2 * pin + _BESIDE
        ):
            return 2
        return int(np.any(_to_lines(places, pins, post) < radii + pin))

    def _pin(self, axle: complex, post: complex) -> complex:
        """The pin from the axle at the dead centre."""
        return self.spring.crank * (axle - post) / abs(axle - post)

    def _turned(self, a: np.ndarray) -> np.ndarray:
        """Of the crank past its dead centre over the stroke, rad."""
        return np.asarray(self.spring.begin + self.spring.turn * a)

    @property
    def axle(self) -> complex:
        """Of the crank, on the ground, mm."""
        return self._places[0]

    @property
    def post(self) -> complex:
        """Of the spring, on the ground, mm."""
        return self._places[1]

    # ---- as links ---------------------------------------------------------------------------------------------------

    def draw(self, drawing: Drawing) -> None:
        """Add the crank, its wheels and its spring to a linkage; DesignError where no wire makes the spring."""
        s = self.spring
        points = drawing.points
        points["crank"] = self.axle
        points["anchor"] = self.post
        points["hook"] = self.axle + self._pin(self.axle, self.post) * cmath.exp(1j * s.begin)
        drawing.links["ground"] += ["crank", "anchor"]
        drawing.links[CRANK] = ["crank", "hook"]
        wheels = {"name": "unloader_gears", "a": LINK, "b": CRANK, "ratio": self.ratio}
        drawing.gears.append(wheels)
        self._refuse_wire()
        spring = {"name": "unloader_spring", "between": ("hook", "anchor"), "rate": s.stiffness}
        drawing.others["spring"] = [{**spring, "free": s.guide - s.crank - s.stretch}]

    def _refuse_wire(self) -> None:
        s = self.spring
        pin = self.sizes.pin_diameter
        free = s.guide - s.crank - s.stretch + pin
        shortest = s.guide - s.crank + pin
        longest = s.farthest + pin
        way = shortest, longest
        if extension_spring(s.stiffness, free, way, EYE * pin, self.sizes.hook) is None:
            raise DesignError(
                "springs of round wire for the unloader",
                0,
                1,
                "",
                f"{s.stiffness:.4g} N/mm, free length {free:.4g} mm, length from {shortest:.4g} to {longest:.4g} mm",
                "use another unloader.stiffness_n_mm, a longer unloader.guide or shorter unloader.crank, or parts.make = 'cams'",
            )


def _around(points: Sequence[complex]) -> float:
    """Length of a band round points, mm."""
    corners = [points[k] for k in hull_corners(points)]
    return sum(abs(b - a) for a, b in zip(corners, [*corners[1:], corners[0]], strict=True))


def _to_lines(places: np.ndarray, starts: np.ndarray, end: complex) -> np.ndarray:
    """Least distance of each place from straight lines to one end, (n,) mm."""
    way = end - starts
    off = places[:, None] - starts
    share = np.clip((way.conj() * off).real / np.abs(way) ** 2, 0, 1)
    return np.asarray(np.abs(off - share * way).min(axis=1))
