"""Rows of pins round a core: where each pin stands so that it lets its tooth go in time, and the outline that all of a row make.

A tooth points at the axis; its tip, r from it, rests on the circle r and is bent aside along the line square to the radius. A
pin's side takes it along at r, the tip slides out to the pin's end, R from the axis, along that end, and off its far corner. By then
the pin's middle is acos(r / R) + asin(w / 2R) past the tooth, w its width. It met the tooth asin(w / 2r) before its middle did.
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from camgen.geometry.outlines import Arc, Contour, Line, Piece
from camgen.numerics import Floats


@dataclass(frozen=True)
class Pins:
    """The pins and the teeth of a drum, mm about its axis."""

    core: float  # radius out of which they stand
    end: float  # distance of their ends
    width: float
    tip: float  # distance of a tooth's tip
    at: float  # where the teeth stand, rad
    sense: int  # of turning, -1 clockwise

    @property
    def past(self) -> float:
        """How far a pin's middle is past the tooth when it lets it go, rad."""
        return math.acos(self.tip / self.end) + math.asin(self.width / 2 / self.end)

    @property
    def hold(self) -> float:
        """By how much the drum turns while a pin touches its tooth, rad."""
        return self.past + math.asin(self.width / 2 / self.tip)

    @property
    def bend(self) -> float:
        """How far a tooth's tip is bent aside, mm."""
        return math.sqrt(self.end**2 - self.tip**2)

    @property
    def spread(self) -> float:
        """Angle that a pin takes of the core, rad."""
        return 2 * math.asin(self.width / 2 / self.core)

    @property
    def shift(self) -> float:
        """How much sooner or later a pin lets go whose corner is a mm off its place, along the turn and outwards, rad."""
        return (1 + self.tip / self.bend) / self.end

    def direction(self, release: float) -> float:
        """Where a pin stands on the drum that lets go when this has turned so far, both rad."""
        return self.at + self.sense * (self.past - release)

    def bend_at(self, releases: Sequence[float], turned: Floats, order: int) -> Floats:
        """How far a row bends its tooth aside when the drum has turned so far, (n,) rad: mm, or its derivative."""
        half = self.width / 2
        bend = np.zeros(np.shape(turned))
        for release in releases:
            past = np.remainder(turned - release + self.past + math.pi, math.tau) - math.pi
            side = (self.tip * np.sin(past) + half) / np.cos(past)
            pushed = side if order == 0 else (self.tip + half * np.sin(past)) / np.cos(past) ** 2
            slid = self.bend if order == 0 else 0.0
            touched = (past > self.past - self.hold) & (past <= self.past)
            bend = np.where(touched, np.where(side < self.bend, pushed, slid), bend)
        return bend

    def outline(self, releases: Sequence[float]) -> Contour:
        """Core and pins of a row, counter-clockwise."""
        foot = math.asin(self.width / 2 / self.core)
        head = math.asin(self.width / 2 / self.end)
        places = sorted(self.direction(each) % math.tau for each in releases)
        pieces: list[Piece] = []
        for beta, following in pairwise([*places, places[0] + math.tau]):
            corners = [
                cmath.rect(radius, beta + angle)
                for radius, angle in (
                    (self.core, -foot),
                    (self.end, -head),
                    (self.end, head),
                    (self.core, foot),
                )
            ]
            pieces += [
                Line(corners[0], corners[1]),
                Arc(0j, self.end, beta - head, 2 * head),
                Line(corners[2], corners[3]),
                Arc(0j, self.core, beta + foot, following - beta - 2 * foot),
            ]
        return Contour(tuple(pieces))
