"""Bodies of the chain stitch: both spreaders, dummies of needles and plate, gauges of the spreaders' outlines.

A spreader's own frame: u rearward from the nose's tip, y up from nose level, w across, 0 in the needles' plane. Its part has
x = u (the lower one, P1, x = -u), y, and z = w from its lowest place up. Two layers, the body with its slanting front P6
and the flank with the nose, are crossed with the outline from above; long edges over which thread runs are rounded.
[Outlines: Horobets, Manoilenko; nose, shank, gaps and radii are a reconstruction, since the scan has no figures]
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Annotated, Literal

import numpy as np
from pydantic import Field

from camgen.errors import DesignError
from camgen.geometry.crossing import Edge, rounded
from camgen.geometry.outlines import Contour, Region, circle, polygon, rectangle, start_point
from camgen.machines.chain_stitch_looper.ratio import Condition, linear
from camgen.machines.chain_stitch_looper.stitch import Design, Stitch
from camgen.machines.chain_stitch_looper.timing import Clock
from camgen.parts.part import Layer, Part
from camgen.spec import Length, Record, quantity

_GAUGE = 1.0  # mm, thickness of the gauges
_ROUND = 0.45  # of the nose's least growth, by which the radius of its edges grows: they never meet
LEAST_RADIUS = 0.05  # mm, that is drawn and made
_THIN = 0.01  # mm, the radius at which a rounding begins and ends
_RUN_OUT = 2.0  # radii, over which the rounding of an edge runs out
_BEYOND = 10.0  # mm that plate and needles are drawn beyond what they need


class SpreaderParts(Record):
    """Spreaders and plate as bodies."""

    nose_width: Length = Field(default=1.2, description="width of the nose at the thread's seat")
    side_gap: Annotated[float, quantity("mm", ge=0, le=10)] = Field(
        default=0.1, description="gap between needle and nose"
    )
    shed_deg: Annotated[float, quantity("deg", ge=0, lt=45)] = Field(
        default=3.0, description="widening of the blade to the shank"
    )
    lean: Literal["nose", "shank"] = Field(
        default="nose",
        description='the protrusion leans to the "nose" or to the "shank", where protrusion_deg is below '
        "90",
    )
    edge_radius: Annotated[float, quantity("mm", ge=0, le=10)] = Field(
        default=0.3,
        description="radius where thread runs: corners, and long edges of the nose, as seen along "
        "it; 0: sharp",
    )
    running_gap: Annotated[float, quantity("mm", ge=0, le=10)] = Field(
        default=0.0,
        description="gap between the spreaders, taken off the underside; 0: they slide on each other",
    )
    shank_length: Length = Field(default=12.0, description="length of the shank behind the blade")
    shank_width: Length = Field(default=6.0, description="width of the shank, which is clamped")
    clamp_hole: Length = Field(default=2.2, description="diameter of the hole in the shank")
    plate_thickness: Length = Field(default=2.0, description="thickness of the needle plate")


@dataclass(frozen=True)
class Bodies:
    """All bodies of a design."""

    design: Design
    making: SpreaderParts
    tau: float  # rad, lean of the protrusion's front
    blade: float  # mm, nose's tip to the shank
    min_wall: float  # mm

    # ---- outlines ----------------------------------------------------------------------------------------------------

    def side_outline(
        self, radius: float = 0.0, behind: float = 0.0, foot: float | None = None
    ) -> Contour:
        """Outline in (u, y), counter-clockwise: V0 nose, V1 seat, V2 to V5; V1, V2 and V5 rounded.

        behind: shank beyond the blade's end; foot: depth of the underside, l_H unless said. DesignError where arcs do not fit.
        """
        d = self.design
        g = self.design.given
        low = g.protrusion if foot is None else foot
        lean = low / math.tan(self.tau) * (1 if self.making.lean == "nose" else -1)
        end = self.blade + behind
        b = g.height
        points = [
            0j,
            complex(d.l3, 0),
            complex(d.l3 - lean, -low),
            complex(end, -low),
            complex(end, b),
            complex(d.nose, b),
        ]
        return _rounded(
            points, [0, radius, radius, 0, 0, radius], ("V0", "V1", "V2", "V3", "V4", "V5")
        )

    def section_outline(self, behind: float = 0.0, foot: float | None = None) -> Contour:
        """Outline in (u, y) of what stands in the needles' plane: B, C and the body behind them; sharp."""
        d = self.design
        end = self.blade + behind
        b = d.given.height
        low = d.given.protrusion if foot is None else foot
        front = [complex(d.l1, 0), complex(d.l1, -low)]
        return polygon([*front, complex(end, -low), complex(end, b), complex(d.nose, b)])

    def top_outline(self, radius: float = 0.0) -> Contour:
        """Outline in (u, w), counter-clockwise: T0 nose, then T5 to T1; T1 rounded."""
        t1, t2, t3, t4, t5 = self.plan
        names = ("T0", "T5", "T4", "T3", "T2", "T1")
        return _rounded([complex(0, t5.imag), t5, t4, t3, t2, t1], [0, 0, 0, 0, 0, radius], names)

    @property
    def plan(self) -> tuple[complex, complex, complex, complex, complex]:
        """T1 to T5."""
        d = self.design
        p = self.making
        end = self.blade
        gap = d.given.needle / 2 + p.side_gap
        outer = gap + p.nose_width
        inner = gap - d.opening
        widening = math.tan(math.radians(p.shed_deg))
        return (
            complex(d.l3, outer),
            complex(end, outer + (end - d.l3) * widening),
            complex(end, inner - (end - d.nose) * widening),
            complex(d.nose, inner),
            complex(d.nose, gap),
        )

    @property
    def _sizes(self) -> tuple[str, ...]:
        """What to measure, for the drawings."""
        d = self.design
        g = self.design.given
        p = self.making
        tau = math.degrees(self.tau)
        high = math.degrees(math.atan2(g.height, d.nose))
        wide = math.degrees(math.atan2(p.nose_width, d.l3))
        edges = "sharp"
        if p.edge_radius:
            edges = (
                f"R{p.edge_radius:g} across the stroke, from nothing at the tip, run out before V1"
            )
        return (
            f"from the nose's tip V0: seat V1 at l3 = {d.l3:.4f}, front B at l1 = {d.l1:.4f}, crest C at A = {d.nose:.4f}",
            f"l2 = {d.l2:.4f}, height b = {g.height:.4f}, protrusion l_H = {g.protrusion:g} less running gap {p.running_gap:g}",
            f"front P6 at alpha = {math.degrees(d.slope):.4f} deg, protrusion at tau = {tau:g} deg to the {p.lean}",
            f"nose {high:.4f} deg high, {wide:.4f} deg wide; {p.nose_width:g} wide at l3; opening f = {d.opening:.4f}",
            f"nose stands {g.needle / 2 + p.side_gap:.4f} beside the needles' plane; shed angle {p.shed_deg:g} deg",
            f"corners V1, V2, V5, T1 R{p.edge_radius:g}; long edges of the nose and far edge of P6 {edges}",
            "B and C stay sharp: needles pass them; break the other edges, polish where the thread runs",
        )

    def _edges(self, floor: float) -> tuple[Edge, ...]:
        """Long edges over which thread runs, rounded: the nose's four up to the seat, and the far edge of P6.

        Across the stroke all are arcs of edge_radius; the nose's grow from nothing at the tip and run out before the seat.
        """
        d = self.design
        p = self.making
        radius = p.edge_radius
        b = d.given.height
        _, _, t3, t4, t5 = self.plan
        if radius == 0:
            return ()
        back = seat_back(self.tau, p.lean)
        # growth of the nose's height and width
        steep = b / d.nose
        wide = p.nose_width / d.l3
        whole = 1 / (_ROUND * min(steep, wide))
        room = d.l3 / (whole + _RUN_OUT + back)
        if radius > room:
            seat = f"the nose, {p.nose_width:g} mm wide and {steep * d.l3:.4g} mm high at the thread's seat"
            remedy = "its four rounded edges need room beside each other: use a smaller one or a greater nose_width"
            raise DesignError("edge_radius", radius, room, "mm", seat, remedy)
        end = d.l3 - back * radius
        radii = [(whole * r, r) for r in (_THIN, radius)]
        radii += [(end - _RUN_OUT * r, r) for r in (radius, _THIN)]

        def edge(top: int, outer: int) -> Edge:
            """The edge where the nose's underside or top meets its inner or outer flank."""
            places = ((u, steep * u * top, t5.imag - floor + wide * u * outer, r) for u, r in radii)
            return Edge(tuple(places), 2 * top - 1, 2 * outer - 1)

        nose = [edge(top, outer) for top in (0, 1) for outer in (0, 1)]
        sink = (t4 - t3).imag / (t4 - t3).real
        run = min(_RUN_OUT * radius, d.l2 / 2, (t3 - t4).real / 2)
        short = run * _THIN / radius
        places = [
            (d.l1 + short, short / d.l2, _THIN),
            (d.l1 + run, run / d.l2, radius),
            (d.nose, 1.0, radius),
            (d.nose + run - short, 1.0, _THIN),
        ]
        front = [
            (u, b * share, t4.imag - floor + sink * max(u - d.nose, 0.0), r)
            for u, share, r in places
        ]
        return (*nose, Edge(tuple(front), 1, -1))

    # ---- parts -------------------------------------------------------------------------------------------------------

    @cached_property
    def parts(self) -> tuple[Part, ...]:
        """Both spreaders, needles and plate as dummies, gauges of the outlines and of the section."""
        radius = self.making.edge_radius
        upper = self.upper
        mirrored = (
            replace(layer, region=layer.region.moved(-1, mirror=True)) for layer in upper.layers
        )
        assert upper.side_profile is not None
        lower = replace(
            upper,
            name="lower-spreader",
            title="Lower spreader (P1), mirror image",
            layers=tuple(mirrored),
            centres=tuple(-z.conjugate() for z in upper.centres),
            side_profile=upper.side_profile.moved(-1, mirror=True),
            edges=tuple(edge.mirrored for edge in upper.edges),
        )
        notes = (*self._sizes, "to check a spreader by; not to be built in")

        def gauge(name: str, title: str, outline: Contour) -> Part:
            layer = Layer(Region(outline), 0.0, _GAUGE)
            return Part(name, f"Gauge, no part of the machine: {title}", (layer,), notes=notes)

        side = self.side_outline(radius)
        top = self.top_outline(radius)
        return (
            lower,
            upper,
            *self._needles,
            self.plate,
            gauge("side-outline", "side outline", side),
            gauge("top-outline", "outline from above, at the height of C", top),
            gauge("needle-section", "section in the needles' plane", self.section_outline()),
        )

    @cached_property
    def upper(self) -> Part:
        """The upper spreader: body and flank one above the other in z, crossed with the outline from above and the shank."""
        d = self.design
        g = d.given
        p = self.making
        t1, t2, t3, t4, t5 = self.plan
        if not d.nose < self.blade:
            remedy = "use a longer blade or a smaller velocity_ratio"
            raise DesignError("blade_length", self.blade, d.nose, "mm", "the nose alone", remedy)
        foot = g.protrusion - p.running_gap
        floor = t3.imag
        end = self.blade + p.shank_length
        hole_at = complex(self.blade + p.shank_length / 2, (g.height - foot) / 2)
        room = min(g.height + foot, p.shank_length)
        if not room > p.clamp_hole:
            where = "the shank's height and length"
            remedy = "use a smaller hole: the shank may be no higher than the blade, for the other spreader passes it"
            raise DesignError("clamp_hole", p.clamp_hole, room, "mm", where, remedy)
        hole = circle(hole_at, p.clamp_hole / 2)
        body = Region(self.section_outline(p.shank_length, foot), (hole,))
        flank = Region(self.side_outline(p.edge_radius, p.shank_length, foot), (hole,))
        ceiling = max(t2.imag, floor + p.shank_width)
        # P6 and the nose's tip bound the material in front; the outline from above runs on before them and leaves room.
        lead = -min(1.0, d.opening * d.l3 / (2 * p.nose_width))
        side = complex(lead, t5.imag + lead * p.nose_width / d.l3)
        points = [complex(lead, t4.imag), t4, t3, complex(end, t3.imag), complex(end, ceiling)]
        points += [complex(t2.real, ceiling)] if ceiling > t2.imag else []
        points += [t2, t1, side]
        radii = [p.edge_radius if z == t1 else 0.0 for z in points]
        plan = _rounded(points, radii, ["T1" if z == t1 else "shank" for z in points])
        middle = t5.imag - floor
        return Part(
            "upper-spreader",
            "Upper spreader (P2)",
            (Layer(body, 0.0, middle), Layer(flank, middle, ceiling - floor)),
            1,
            (),
            (hole_at,),
            (f"needles' plane at z = {-floor:.4f}", *self._sizes),
            None,
            self.min_wall,
            1,
            Region(plan.moved(shift=-1j * floor)),
            self._edges(floor),
        )

    @cached_property
    def clock(self) -> Clock:
        """Needles and the section that they can strike, over the turn at any lag."""
        p = self.making
        foot = self.design.given.protrusion - p.running_gap
        section = self.section_outline(p.shank_length, foot)
        outlines = (section, *(needle.region.outer for needle in self._needles))
        body, one, two = (
            np.array([start_point(piece) for piece in outline.pieces]) for outline in outlines
        )
        return Clock(self.design, body, (one, two))

    @cached_property
    def _needles(self) -> tuple[Part, Part]:
        """Needles, upright in the drawing's plane: round above, the point a wedge whose section here is the cone's."""
        g = self.design.given
        r = g.needle / 2
        top = max(g.depths) + g.thickness + _BEYOND

        def needle(k: int) -> Part:
            h = g.point[k]
            outline = polygon(
                [0j, complex(r, h), complex(r, top), complex(-r, top), complex(-r, h)]
            )
            profile = Region(circle(complex(0, r), r))
            notes = (
                "stands in for the bought needle; cone and wedge have the same section in this plane",
            )
            layers = (Layer(Region(outline), 0.0, 2 * r),)
            title = f"Needle {k + 1} of your machine, not to be made"
            return Part(
                f"needle-{k + 1}", title, layers, notes=notes, side_profile=profile, process="dummy"
            )

        return needle(0), needle(1)

    @cached_property
    def plate(self) -> Part:
        """Dummy of the needle plate, its top at y = 0."""
        g = self.design.given
        p = self.making
        z = g.spacing
        half = max(self.upper.thickness, 6.0)
        r = g.needle / 2 + min(0.4, (z - g.needle) / 4)
        left = -_BEYOND
        right = z + _BEYOND
        t = p.plate_thickness
        outline = rectangle(complex(left, -t), complex(right))
        top = rectangle(complex(left), complex(right, 2 * half))
        holes = tuple(circle(complex(x, half), r) for x in (0.0, z))
        return Part(
            "needle-plate",
            "Needle plate of your machine, not to be made",
            (Layer(Region(outline), 0.0, 2 * half),),
            notes=("stands in for the machine's own plate",),
            side_profile=Region(top, holes),
            process="dummy",
        )


def seat_back(tau: float, lean: str) -> float:
    """Radii that the arc in the seat takes off the nose: the tangent of half its turn. tau: lean of the front, rad."""
    return math.tan((tau if lean == "nose" else math.pi - tau) / 2)


def room_on_nose(s: Stitch, p: SpreaderParts, back: float) -> list[Condition]:
    """What a velocity ratio must keep for the nose's rounded edges, as `Bodies` makes them."""
    seat = s.setback - s.needle
    ends = p.edge_radius * (_RUN_OUT + back)
    far = max(s.reach)
    rest = 1 - p.edge_radius / (_ROUND * p.nose_width)
    steep = p.edge_radius / (_ROUND * s.height)
    on_height = (seat - steep * s.setback - ends, far - steep * (far + s.height))
    return [
        linear("room for edge_radius beside nose_width", seat * rest - ends, far * rest),
        linear("room for edge_radius on the nose's height", *on_height),
    ]


def _rounded(points: Sequence[complex], radii: Sequence[float], names: Sequence[str]) -> Contour:
    """The polygon with rounded corners; DesignError, with the largest radius that fits, where arcs meet."""
    try:
        return rounded(points, radii)
    except ValueError as error:
        corner, share = error.args
        end = names[(corner + 1) % len(points)]
        where = f"the side from {names[corner]} to {end} of the outline"
        remedy = "arcs need room beside each other: use a smaller one, a longer blade, or more protrusion beyond the running_gap"
        radius = max(radii)
        raise DesignError("edge_radius", radius, radius * share, "mm", where, remedy) from None
