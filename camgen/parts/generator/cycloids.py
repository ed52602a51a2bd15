"""Cycloidal drives of a linkage: a disc on the eccentric of a crank, pins of the ground round it, output pins in its holes.

stud    a round pin that is pressed into a link and stands out of it, with no joint of its own
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from camgen.geometry.outlines import Contour, Floats, circle
from camgen.machine import model as m
from camgen.parts.generator.wheels import pivot
from camgen.parts.wheels.cycloid import CycloidDisc, OutputPins, OutputWish


@dataclass(frozen=True)
class CycloidWish:
    """What is asked of a drive: its links by what they are."""

    joint: str  # of crank and disc
    disc: CycloidDisc
    crank: str
    at: str  # point of the eccentric
    link: str  # that the disc is
    air: float  # of an output pin in its hole, mm
    output: str | None = None  # link with the output pins
    output_joint: str = ""  # of disc and output
    pins: OutputWish = OutputWish(6)
    opposite: CycloidWish | None = None  # the first disc, where this is one more in the same pins

    def output_law(self, start: Mapping[str, m.Pose]) -> m.Cam:
        """The joint of disc and output, which turns as the disc does; start: as drawn."""
        assert self.output is not None
        disc, rest = (start[link].angle for link in (self.link, self.output))
        links = self.output_joint, self.link, self.output
        return m.Cam(*links, m.Turning(), phase=disc, rest=rest)

    @property
    def first(self) -> CycloidWish:
        """The drive whose pins these are."""
        return self.opposite or self

    def output_gap(self, angle: Floats) -> Floats:
        """Of an output pin from its hole: the same air all the way, (n,) mm."""
        return np.full(np.shape(angle), self.air)


@dataclass(frozen=True)
class Stud:
    """A pin that is pressed into a link."""

    part: str
    title: str
    link: str  # that holds it
    at: complex  # in that link's axes, mm
    radius: float  # mm
    discs: tuple[str, ...]  # links beside which it stands


@dataclass(frozen=True)
class CycloidDrive:
    """A cycloidal drive of a machine."""

    wish: CycloidWish
    machine: m.Machine
    output: OutputPins | None
    above: str | None = None  # link of a second disc

    @property
    def axis(self) -> complex:
        """Of crank, pins and output, on the ground, mm."""
        return pivot(self.machine, self.wish.crank)[1]

    @property
    def spoke(self) -> complex:
        """Where the first disc's eccentric points as drawn, a unit complex: to the first pin of the ground."""
        points = self.machine.body(self.wish.crank).points
        arm = complex(points[self.wish.first.at]) - pivot(self.machine, self.wish.crank)[0]
        return arm / abs(arm) * cmath.exp(1j * self.machine.start_of(self.wish.crank).angle)

    def contours(self) -> list[Contour]:
        """The disc's edge and its holes for output pins, in its link's axes; a hollow on the eccentric's line as drawn.

        A second disc, half a turn of the crank further, has turned back by half a lobe.
        """
        link = self.wish.link
        turn = self._in(link)
        if self.wish.opposite is not None:
            turn *= cmath.exp(1j * math.pi * self.wish.disc.ratio)
        edge = self.wish.disc.outline().moved(turn, self._centre)
        return [edge, *(circle(z, self.output.hole) for z in self.hole_places if self.output)]

    @property
    def _centre(self) -> complex:
        """Of the disc, in its link's axes, mm."""
        return complex(self.machine.body(self.wish.link).points[self.wish.at])

    @property
    def hole_places(self) -> list[complex]:
        """Centres of the holes for output pins, in the disc's axes, mm; the first where a lobe is, beside the eccentric's line."""
        return [self._centre + z for z in self._round(self.wish.link)]

    @property
    def pins(self) -> list[Stud]:
        """Pins of the ground."""
        wish = self.wish.first
        about = f"ring-pin-{wish.link}", f"Pin round {wish.link}"
        places = (self.axis + self.spoke * z for z in wish.disc.pin_places())
        return [Stud(*about, m.GROUND, z, wish.disc.pin, self.discs) for z in places]

    @property
    def discs(self) -> tuple[str, ...]:
        """All that run in its pins, from below."""
        return (self.wish.link,) if self.above is None else (self.wish.link, self.above)

    @property
    def output_pins(self) -> list[Stud]:
        """Pins of the output."""
        wish = self.wish.first
        if self.output is None or wish.output is None:
            return []
        about = f"output-pin-{wish.link}", f"Pin of {wish.output} in {wish.link}"
        centre = pivot(self.machine, wish.output)[0]
        places = (centre + z for z in self._round(wish.output))
        return [Stud(*about, wish.output, z, self.output.pin, self.discs) for z in places]

    @property
    def studs(self) -> list[Stud]:
        """Pins of ground and output; those of a second disc are the first one's."""
        return [] if self.wish.opposite is not None else [*self.pins, *self.output_pins]

    def _round(self, link: str) -> list[complex]:
        """From the middle of all output pins to each, in a link's axes, mm."""
        if self.output is None:
            return []
        first = math.pi / self.wish.disc.lobes
        turns = (first + math.tau * k / self.output.count for k in range(self.output.count))
        return [self._in(link) * cmath.rect(self.output.circle, turn) for turn in turns]

    def _in(self, link: str) -> complex:
        """The eccentric's direction as drawn, in a link's axes."""
        return self.spoke * cmath.exp(-1j * self.machine.start_of(link).angle)
