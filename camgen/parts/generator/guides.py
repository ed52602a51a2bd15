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
from camgen.parts.generator.sizes import Parts
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


def guide(
    joint: m.Slide,
    stroke: tuple[float, float],
    hubs: Sequence[tuple[complex, float]],
    slotted: bool,
    least: float,
    clearance: float,
    sizes: Parts,
    stem: str,
    clear: tuple[float, float],
    cover: Cover | None = None,
) -> Guide:
    """The bodies of a slide whose runner has these hubs, place in its axes and radius.

    stroke: least and greatest place along it, mm; least: half width that a bar has at least; stem: one of STEMS;
    clear: between which places of the guide's line no rails may stand, mm.
    """
    own, along, (low, high) = (
        cmath.exp(1j * (joint.angle - joint.turn)),
        cmath.exp(1j * joint.angle),
        stroke,
    )
    discs = [((z - joint.runner.at) / own, radius) for z, radius in hubs] or [(0j, least)]
    across = [z.imag for z, _ in discs]
    wing = (
        slotted or max(across) - min(across) > SAME_POINT or any(radius == 0 for _, radius in hubs)
    )
    aside = (min(across) + max(across)) / 2
    half = max([least, *(radius for _, radius in discs)])
    begin, end = min(z.real for z, _ in discs), max(z.real for z, _ in discs)
    if wing:
        below = max(radius - z.imag for z, radius in discs) + aside
        above = max(radius + z.imag for z, radius in discs) - aside
        half = min(least, 0.8 * min(below, above))
        stem = "both" if stem == "along" else stem
    asked = sizes.shape(joint.runner.body).rails
    grip = _GRIP * half if asked is None else asked - sizes.rail_width
    grip = max(grip, cover.least(sizes.rail_width) if cover else sizes.rail_width)
    rim = max(half, *(radius for _, radius in discs)) + _AIR
    roots = {1: begin, -1: end}  # where the stems ahead and behind begin
    if wing:  # on the wing's middle; of one that lies slantwise where a stem's first side comes out
        edge, midway = hull(discs), (begin + end) / 2
        roots = {
            way: midway + way * min(0.0, root(edge, complex(midway, aside), way, half))
            for way in (1, -1)
        }
    stems, spans = [], []
    if stem == "along":
        stems, spans = [(begin - half, end + half)], [(low + begin - half, high + end + half)]
    if stem in ("ahead", "both"):
        start = max(high + end + rim, clear[1] + _AIR) + sizes.rail_width / 2
        stems.append((roots[1], start + grip - low))
        spans.append((start, start + grip))
    if stem in ("behind", "both"):
        start = min(low + begin - rim, clear[0] - _AIR) - sizes.rail_width / 2
        stems.append((roots[-1], start - grip - high))
        spans.append((start - grip, start))
    if not wing and stem == "both":
        stems = [(stems[1][1], stems[0][1])]
    off = half + (clearance + sizes.rail_width) / 2
    middle = 1j * aside
    held = m.Slide(
        joint.name,
        m.Place(joint.guide.body, joint.guide.at + middle * along),
        m.Place(joint.runner.body, joint.runner.at + middle * own),
        joint.angle,
        joint.turn,
        joint.clearance,
    )
    return Guide(
        held,
        half,
        [(held.runner.at + a * own, held.runner.at + b * own) for a, b in stems],
        [
            (
                held.guide.at + (a + side * 1j * off) * along,
                held.guide.at + (b + side * 1j * off) * along,
            )
            for a, b in spans
            for side in (-1, 1)
        ],
        list(hubs) if wing else [],
        cover is not None and stem != "along",
    )
