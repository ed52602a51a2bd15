"""What slides: a straight bar between two rails, on the ground's plate or on a link that moves.

    along     the bar is no longer than its holes need; the rails go beside it all its way
    ahead     the bar is a stem that sticks out ahead of the holes, into rails beyond their way; `behind`: the other way
    both      stems at both ends
    wing      holes beside one line, or a slot: a plate from which the stems stick out

The rails stand on what guides, one level or more under the runner. Where they are beyond the way of its holes a cover on
them holds it down.
"""

from __future__ import annotations

import cmath
from collections.abc import Sequence
from dataclasses import dataclass, replace

from camgen.geometry.convex import hull_corners
from camgen.geometry.facets import facet_contour
from camgen.geometry.outlines import Contour
from camgen.machine import model as m
from camgen.machine.features import Faces, SlideFaces
from camgen.parts.generator.covers import Cover
from camgen.parts.part import hull, root, with_bar
from camgen.tolerances import SAME_POINT

STEMS = ("along", "ahead", "behind", "both")
# in which order, where a cover is to hold them: along it none can
COVERED = ("ahead", "behind", "both", "along")
_COARSE = 0.1  # mm, by which the corners of a plate's hull may lie off its edge
_GRIP = 4.0  # half widths of the bar: how long rails are that it does not stay between
_AIR = 1.0  # mm, between the ends of such rails and what moves before them

Discs = list[tuple[complex, float]]


@dataclass(frozen=True)
class Guide:
    """A slide as bodies."""

    joint: m.Slide  # places of both sides on the bar's middle line
    half: float  # mm, half width of the bar
    stems: list[tuple[complex, complex]]  # ends of each bar's middle line, in the runner's axes
    rails: list[tuple[complex, complex]]  # of each rail, in the guide's; pairs one after the other
    wing: Discs  # hubs beside the bar
    covered: bool  # whether covers lie on the rails
    plate: Contour | None = None  # in place of the wing's edge

    @property
    def pairs(self) -> list[list[tuple[complex, complex]]]:
        """Rails on both sides of the bar."""
        return [self.rails[k : k + 2] for k in range(0, len(self.rails), 2)]

    @property
    def bands(self) -> list[Discs]:
        """Discs round which the runner's bands are drawn."""
        bars = [[(z, self.half) for z in ends] for ends in self.stems]
        return [*bars, self.wing] if self.wing else bars

    @property
    def outline(self) -> Contour:
        """The runner's edge."""
        if not self.wing:
            return hull(self.bands[0])
        edge = self.plate or hull(self.wing)
        for a, b in self.stems:
            edge = with_bar(edge, a, (b - a) / abs(b - a), self.half, abs(b - a))
        return edge

    def faces(self, rails: str, runner: str, clearance: float) -> SlideFaces:
        """Rails, which no drawing of their plate shows, and runner, by their parts' names."""
        joint = self.joint
        a, b = self.stems[0]
        middle = sum(z for ends in self.rails[:2] for z in ends) / 4
        own = Faces(runner, (a + b) / 2, joint.angle - joint.turn, 2 * self.half)
        walls = Faces(rails, middle, joint.angle, 2 * self.half + clearance, False)
        return SlideFaces(joint.name, walls, own)


@dataclass(frozen=True)
class Runner:
    """What slides, in its own axes; mm."""

    hubs: Sequence[tuple[complex, float]]  # place and radius; a knife's disc has none
    slotted: bool  # it has a slot
    least: float  # half width that a bar has at least
    plate: Contour | None = None  # its edge, where that is no band round its hubs

    @property
    def discs(self) -> Sequence[tuple[complex, float]]:
        """Hubs, and places of the plate's edge."""
        if self.plate is None:
            return self.hubs
        edge = facet_contour(self.plate, _COARSE)
        return [*self.hubs, *((complex(z), 0.0) for z in edge[hull_corners(edge.tolist())])]


@dataclass(frozen=True)
class Way:
    """Places on the line of a slide, mm."""

    stroke: tuple[float, float]  # least and greatest of the runner
    clear: tuple[float, float]  # between which no rails may stand


@dataclass(frozen=True)
class Rails:
    """How rails are made; mm."""

    width: float
    clearance: float  # of the bar between them
    length: float | None = None  # where the spec asks for one
    cover: Cover | None = None  # on them


def guide(joint: m.Slide, runner: Runner, way: Way, rails: Rails, stem: str) -> Guide:
    """The bodies of a slide; stem: one of STEMS."""
    direction = cmath.exp(1j * (joint.angle - joint.turn))
    discs = [((z - joint.runner.at) / direction, radius) for z, radius in runner.discs]
    discs = discs or [(0j, runner.least)]
    across = [z.imag for z, _ in discs]
    uneven = max(across) - min(across) > SAME_POINT
    wing = runner.slotted or uneven or any(radius == 0 for _, radius in runner.discs)
    offset = (min(across) + max(across)) / 2
    half = max([runner.least, *(radius for _, radius in discs)])
    if wing:
        below = max(radius - z.imag for z, radius in discs) + offset
        above = max(radius + z.imag for z, radius in discs) - offset
        half = min(runner.least, 0.8 * min(below, above))
        stem = "both" if stem == "along" else stem
    stems, spans = _stems(discs, half, _roots(discs, half, offset, wing), way, rails, stem)
    if not wing and stem == "both":
        stems = [(stems[1][1], stems[0][1])]
    middle = 1j * offset
    origin = joint.runner.at + middle * direction
    at = joint.guide.at + middle * cmath.exp(1j * joint.angle)
    joint = replace(
        joint, guide=replace(joint.guide, at=at), runner=replace(joint.runner, at=origin)
    )
    return Guide(
        joint,
        half,
        [(origin + a * direction, origin + b * direction) for a, b in stems],
        _beside(joint, spans, half + (rails.clearance + rails.width) / 2),
        list(runner.discs) if wing else [],
        rails.cover is not None and stem != "along",
        runner.plate,
    )


def _roots(discs: Discs, half: float, offset: float, wing: bool) -> dict[int, float]:
    """Where the stems ahead (1) and behind (-1) begin, by places of the runner's line, mm."""
    begin = min(z.real for z, _ in discs)
    end = max(z.real for z, _ in discs)
    if not wing:
        return {1: begin, -1: end}
    # on the wing's middle; of one that lies slantwise where a stem's first side comes out
    edge = hull(discs)
    midway = (begin + end) / 2
    return {
        side: midway + side * min(0.0, root(edge, complex(midway, offset), side, half))
        for side in (1, -1)
    }


Ends = list[tuple[float, float]]


def _stems(
    discs: Discs, half: float, roots: dict[int, float], way: Way, rails: Rails, stem: str
) -> tuple[Ends, Ends]:
    """Both ends of each stem on the runner's line, and of its rails on the guide's, mm."""
    begin = min(z.real for z, _ in discs)
    end = max(z.real for z, _ in discs)
    low, high = way.stroke
    grip = _GRIP * half if rails.length is None else rails.length - rails.width
    grip = max(grip, rails.cover.least(rails.width) if rails.cover else rails.width)
    rim = max(half, *(radius for _, radius in discs)) + _AIR
    if stem == "along":
        return [(begin - half, end + half)], [(low + begin - half, high + end + half)]
    stems = Ends()
    spans = Ends()
    if stem in ("ahead", "both"):
        start = max(high + end + rim, way.clear[1] + _AIR) + rails.width / 2
        stems.append((roots[1], start + grip - low))
        spans.append((start, start + grip))
    if stem in ("behind", "both"):
        start = min(low + begin - rim, way.clear[0] - _AIR) - rails.width / 2
        stems.append((roots[-1], start - grip - high))
        spans.append((start - grip, start))
    return stems, spans


def _beside(joint: m.Slide, spans: Ends, off: float) -> list[tuple[complex, complex]]:
    """Rails on both sides of a slide's line, so far off it, mm; in the guide's axes."""
    direction = cmath.exp(1j * joint.angle)
    at = joint.guide.at
    return [
        (at + (a + side * 1j * off) * direction, at + (b + side * 1j * off) * direction)
        for a, b in spans
        for side in (-1, 1)
    ]
