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
from dataclasses import dataclass

from camgen.geometry.outlines import Contour
from camgen.machine import model as m
from camgen.machine.features import Faces, SlideFaces
from camgen.parts.generator.covers import Cover
from camgen.parts.part import hull, root, with_bar
from camgen.tolerances import SAME_POINT

STEMS = ("along", "ahead", "behind", "both")
COVERED = (
    "ahead",
    "behind",
    "both",
    "along",
)  # in which order, where a cover is to hold them: along it none can
_GRIP = 4.0  # half widths of the bar: how long rails are that it does not stay between
_AIR = 1.0  # mm, between the ends of such rails and what moves before them

Discs = list[tuple[complex, float]]


@dataclass(frozen=True)
class Guide:
    """A slide as bodies.

    joint: with the places of both sides on the bar's middle line; half: the bar's half width, mm; stems: both ends of the
    middle line of each bar, in the runner's axes; rails: the same of each rail, in the guide's, those of a pair one after the
    other; wing: hubs beside the bar; covered: whether covers lie on them.
    """

    joint: m.Slide
    half: float
    stems: list[tuple[complex, complex]]
    rails: list[tuple[complex, complex]]
    wing: Discs
    covered: bool = False

    @property
    def pairs(self) -> list[list[tuple[complex, complex]]]:
        """Rails on both sides of the bar."""
        return [self.rails[k : k + 2] for k in range(0, len(self.rails), 2)]

    @property
    def bands(self) -> list[Discs]:
        """Discs round which the runner's bands are drawn."""
        return [[(z, self.half) for z in ends] for ends in self.stems] + (
            [self.wing] if self.wing else []
        )

    @property
    def outline(self) -> Contour:
        """The runner's edge."""
        if not self.wing:
            return hull(self.bands[0])
        edge = hull(self.wing)
        for a, b in self.stems:
            edge = with_bar(edge, a, (b - a) / abs(b - a), self.half, abs(b - a))
        return edge

    def faces(self, rails: str, runner: str, clearance: float) -> SlideFaces:
        """Rails, which no drawing of their plate shows, and runner, by their parts' names."""
        joint, (a, b) = self.joint, self.stems[0]
        middle = sum(z for ends in self.rails[:2] for z in ends) / 4
        own = Faces(runner, (a + b) / 2, joint.angle - joint.turn, 2 * self.half)
        return SlideFaces(
            joint.name, Faces(rails, middle, joint.angle, 2 * self.half + clearance, False), own
        )


@dataclass(frozen=True)
class Runner:
    """What slides, in its own axes; mm."""

    hubs: Sequence[tuple[complex, float]]  # place and radius; a knife's disc has none
    slotted: bool  # it has a slot
    least: float  # half width that a bar has at least


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
    turned = cmath.exp(1j * (joint.angle - joint.turn))
    discs = [((z - joint.runner.at) / turned, radius) for z, radius in runner.hubs]
    discs = discs or [(0j, runner.least)]
    across = [z.imag for z, _ in discs]
    uneven = max(across) - min(across) > SAME_POINT
    wing = runner.slotted or uneven or any(radius == 0 for _, radius in runner.hubs)
    aside = (min(across) + max(across)) / 2
    half = max([runner.least, *(radius for _, radius in discs)])
    if wing:
        below = max(radius - z.imag for z, radius in discs) + aside
        above = max(radius + z.imag for z, radius in discs) - aside
        half = min(runner.least, 0.8 * min(below, above))
        stem = "both" if stem == "along" else stem
    stems, spans = _stems(discs, half, _roots(discs, half, aside, wing), way, rails, stem)
    if not wing and stem == "both":
        stems = [(stems[1][1], stems[0][1])]
    middle = 1j * aside
    held = m.Slide(
        joint.name,
        m.Place(joint.guide.body, joint.guide.at + middle * cmath.exp(1j * joint.angle)),
        m.Place(joint.runner.body, joint.runner.at + middle * turned),
        joint.angle,
        joint.turn,
        joint.clearance,
    )
    return Guide(
        held,
        half,
        [(held.runner.at + a * turned, held.runner.at + b * turned) for a, b in stems],
        _beside(held, spans, half + (rails.clearance + rails.width) / 2),
        list(runner.hubs) if wing else [],
        rails.cover is not None and stem != "along",
    )


def _roots(discs: Discs, half: float, aside: float, wing: bool) -> dict[int, float]:
    """Where the stems ahead (1) and behind (-1) begin, by places of the runner's line, mm."""
    begin, end = min(z.real for z, _ in discs), max(z.real for z, _ in discs)
    if not wing:
        return {1: begin, -1: end}
    # on the wing's middle; of one that lies slantwise where a stem's first side comes out
    edge, midway = hull(discs), (begin + end) / 2
    return {
        side: midway + side * min(0.0, root(edge, complex(midway, aside), side, half))
        for side in (1, -1)
    }


Ends = list[tuple[float, float]]


def _stems(
    discs: Discs, half: float, roots: dict[int, float], way: Way, rails: Rails, stem: str
) -> tuple[Ends, Ends]:
    """Both ends of each stem on the runner's line, and of its rails on the guide's, mm."""
    begin, end = min(z.real for z, _ in discs), max(z.real for z, _ in discs)
    low, high = way.stroke
    grip = _GRIP * half if rails.length is None else rails.length - rails.width
    grip = max(grip, rails.cover.least(rails.width) if rails.cover else rails.width)
    rim = max(half, *(radius for _, radius in discs)) + _AIR
    if stem == "along":
        return [(begin - half, end + half)], [(low + begin - half, high + end + half)]
    stems, spans = Ends(), Ends()
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
    along, at = cmath.exp(1j * joint.angle), joint.guide.at
    return [
        (at + (a + side * 1j * off) * along, at + (b + side * 1j * off) * along)
        for a, b in spans
        for side in (-1, 1)
    ]
