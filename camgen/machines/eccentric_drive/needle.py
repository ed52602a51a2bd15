"""The needle and what holds and guides it: the slider's head with its clamp, the tube beyond, what the plate has for them.

The wire lies in a groove along the slider, under the guide's cover; the clamp presses on it at the head, which is always outside
the guide. The plate has a window under the head's way, for the nuts of its clamp. Its point is at `wire_length` from the groove's
inner end; unless that is given it is flush with the tube's mouth at the innermost place.
[Sviridov, Vladimirov, Chusovitin, figure 4, item 3; the point is to reach 2 to 3 mm out]
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise

import numpy as np

from camgen.findings import Finding, Where, at_least, at_most
from camgen.geometry.outlines import Arc, Contour, Line, Region, circle, rectangle
from camgen.machine.features import Mount, StandIn
from camgen.machine.model import GROUND
from camgen.machines.eccentric_drive.tables import Band, EccentricSizes
from camgen.parts.catalogue import SCREWS, Bought, Screw, fastener, nut
from camgen.parts.generator.connections import Fitting
from camgen.parts.generator.layout import Layout
from camgen.parts.hardware import plate
from camgen.parts.part import HoldingNote, Layer, Part
from camgen.study import Figure, Sketch

TUBE = "needle-tube"
SLIDER = "slider"
CLAMP = "clamp"
_FACETS = 0.02  # mm, by which a wall may seem thinner where it is measured on facets
_AIR = 1.0  # mm, between what moves past each other end to end
_GUIDED = 2.0  # diameters of the wire in the tube, at least: the 2 to 1 rule of sliding guides
_GRIP = 0.25  # of the wire's diameter, by which it stands out of its groove at the clamp


def rim(sizes: EccentricSizes, min_wall: float) -> float:
    """Radius of the material round a screw's hole, mm."""
    return SCREWS[sizes.screw].clearance / 2 + max(sizes.wall, min_wall + _FACETS)


@dataclass(frozen=True)
class Needle:
    """Sizes and places of the needle's parts on a drive that is laid out, mm; x from the shaft outwards."""

    sizes: EccentricSizes
    layout: Layout
    innermost: float  # place of the slider's pin
    outermost: float  # the same at the other end of its stroke
    offset: float  # of the guide

    # ---- places -----------------------------------------------------------------------------------------------------

    @property
    def _screw(self) -> Screw:
        return SCREWS[self.sizes.screw]

    @property
    def _rim(self) -> float:
        return rim(self.sizes, self.layout.min_wall)

    @property
    def _slide(self) -> float:
        return self.layout.fits.slide_clearance

    @cached_property
    def _floor(self) -> float:
        """Height of the slider's underside."""
        return self.layout.floor(self.layout.level[SLIDER])

    @cached_property
    def _top(self) -> float:
        """Height of the slider's upper side."""
        return self._floor + self.layout.thickness(SLIDER)

    @cached_property
    def guided(self) -> float:
        """Where the rails end."""
        rails = self.layout.guides[SLIDER].rails
        return max(z.real for ends in rails for z in ends) + self.sizes.rail_width / 2

    @cached_property
    def neck(self) -> float:
        """Where the slider's head begins, from its pin: outside the guide at the innermost place."""
        return self.guided + _AIR - self.innermost

    @cached_property
    def long(self) -> float:
        """Length of the head; the clamp is 0.2 shorter at both ends."""
        return 2 * max(self._screw.head / 2 + 1, self._rim + 0.2)

    @cached_property
    def aside(self) -> float:
        """Distance of the clamp's screws from the wire."""
        beside = self.sizes.wire_diameter / 2 + self.layout.min_wall + _FACETS
        return beside + self._screw.clearance / 2

    @cached_property
    def hook(self) -> float:
        """Where the groove begins, from the slider's pin: past the rod's end."""
        wide = max(self.layout.hub("P", "rod"), self.layout.head_radius("P"))
        return wide + 1 + self.sizes.wire_diameter

    @cached_property
    def begin(self) -> float:
        """Where the tube begins."""
        return self.outermost + self.neck + self.long + _AIR

    @property
    def mouth(self) -> float:
        """Where it ends."""
        return self.begin + self.sizes.tube_length

    @cached_property
    def wire(self) -> float:
        """Length of the wire that is straight, from the inner end of the slider's groove to its point."""
        given = self.sizes.wire_length
        return self.mouth - self.innermost - self.hook if given is None else given

    @property
    def out(self) -> tuple[float, float]:
        """How far the point stands out of the tube at the slider's innermost and outermost places; below 0: within."""
        least = self.innermost + self.hook + self.wire - self.mouth
        return least, least + self.outermost - self.innermost

    @property
    def _bore(self) -> float:
        return self.sizes.wire_diameter + self._slide

    @cached_property
    def _tube_screws(self) -> float:
        """Distance of the tube's screws from the wire."""
        beside = self._bore / 2 + self.layout.min_wall + _FACETS
        return max(self.aside, beside + self._screw.clearance / 2)

    # ---- parts ------------------------------------------------------------------------------------------------------

    def fitting(self) -> Fitting:
        """All of it; where no tube is wanted, the slider with its clamp."""
        s = self.sizes
        place = complex(self.neck + self.long / 2)
        placed = [(self._clamp(), Mount(CLAMP, SLIDER, place, z=self._top))]
        holes = dict[str, Contour]()
        tube = list[tuple[complex, float]]()
        clamp = fastener("screw of the wire clamp", s.screw, s.slider_thickness + s.thickness, 2)
        screws = [replace(clamp, at=((CLAMP, 2),))]
        straight = ""
        stand_ins: tuple[StandIn, ...] = ()
        if s.tube_length:
            middle = complex((self.begin + self.mouth) / 2, self.offset)
            lift = s.base_thickness
            placed.append((self._tube(self._floor - lift), Mount(TUBE, GROUND, middle, z=lift)))
            ends = (middle - 1j * self._tube_screws, middle + 1j * self._tube_screws)
            tube = [(z, self._screw.clearance) for z in ends]
            holes = {"window": self._window}
            held = fastener("screw of the needle's tube", s.screw, self._height, 2)
            screws.append(replace(held, at=((TUBE, 2),)))
            straight = f", straight over {self.wire:.4g}"
            stand_ins = (self._stand_in(),)
        mounting = f"{s.screw} x {s.base_thickness:g} and what carries it"
        wire = f"steel, diameter {s.wire_diameter:g}{straight}"
        usb = "USB, 5 V, 1 A or more: a charger or a power bank"
        bought = (
            *screws,
            replace(
                nut("nut", s.screw, 2 * len(screws)),
                at=tuple(pair for each in screws for pair in each.at),
            ),
            Bought(
                "screw for mounting",
                self._screw.standard,
                mounting,
                4,
                "mount",
                thread=self._screw.thread,
            ),
            Bought("needle's wire", "", wire, 1, at=((CLAMP, 1),)),
            Bought("supply", "", usb, 1, "supply", how="to the motor"),
            Bought("switch", "", "rocker switch, round, 20 mm", 1, how="in a wire of the motor"),
        )
        return Fitting(
            (*self._corners, *tube),
            holes,
            {SLIDER: self._slider()},
            tuple(placed),
            stand_ins,
            bought,
            "screws through the holes in the plate's corners hold it",
            self._kept,
        )

    @property
    def _kept(self) -> tuple[tuple[complex, float], ...]:
        """Discs on the ground about the head at both ends of its stroke, and about the tube."""
        places = [
            (end + self.neck + self.long / 2, self.long) for end in (self.innermost, self.outermost)
        ]
        tube = self.sizes.tube_length
        places += [((self.begin + self.mouth) / 2, tube)] if tube else []
        half = max(self._half, self._tube_screws + self._rim)
        return tuple((complex(x, self.offset), math.hypot(long / 2, half)) for x, long in places)

    @cached_property
    def _corners(self) -> tuple[tuple[complex, float], ...]:
        """Holes for mounting, in every corner of the plate, and their diameter."""
        layout = self.layout
        cover = self.layout.cover
        face = self._motor_reach
        corner = max(self._screw.head / 2 + 1, self._rim)
        guide = layout.guides[SLIDER]
        rails = max(abs(z.imag - self.offset) for ends in guide.rails for z in ends)
        beside = rails + (cover.radius if cover else self.sizes.rail_width / 2)
        beside = max(beside, self._half + _AIR + layout.min_wall) + corner
        top = max(self.offset + beside, face)
        bottom = min(self.offset - beside, -face)
        end = self.mouth if self.sizes.tube_length else self.guided
        right = end - corner
        left = -(layout.sizes.face.reach if layout.sizes.face else 0.0) - corner
        return tuple(
            (complex(x, y), self._screw.clearance) for x in (left, right) for y in (bottom, top)
        )

    @property
    def _motor_reach(self) -> float:
        """How far the motor's screws reach from the shaft."""
        face = self.layout.sizes.face
        return 0.0 if face is None else max(abs(z) for z in face.screws)

    @property
    def _half(self) -> float:
        """Half the width of the slider's head."""
        return max(self.sizes.slider_width / 2, self.aside + self._rim)

    @property
    def _window(self) -> Contour:
        """Of the plate, under the way of the slider's head."""
        half = self._half + _AIR
        ends = self.guided + _AIR / 2, self.begin - _AIR / 2
        return rectangle(complex(ends[0], self.offset - half), complex(ends[1], self.offset + half))

    def _slider(self) -> Part:
        """Bar on the guide: pin hole at the origin, along x a groove for the needle's wire, two screws for its clamp."""
        s = self.sizes
        layout = self.layout
        wall = self.layout.min_wall
        half = s.slider_width / 2
        groove = s.wire_diameter / 2
        neck = self.neck
        front = neck + self.long
        wide = self._half
        thick = layout.thickness(SLIDER)
        head = [complex(neck, -wide)] if wide > half else []
        head += [complex(front, -wide)]
        slot = [complex(front, -groove), complex(self.hook, -groove)]
        shank = [complex(neck, -groove), complex(self.hook, -groove)]

        def edge(*side: complex) -> Contour:
            """Through these corners below the wire and their like over it, round behind the pin."""
            below = [complex(0, -half), complex(neck, -half), *side]
            corners = [*below, *(z.conjugate() for z in reversed(below))]
            lines = [Line(a, b) for a, b in pairwise(corners)]
            return Contour((Arc(0j, half, math.pi / 2, math.pi), *lines))

        pin = {"pin": circle(0j, layout.hole("P", SLIDER) / 2)}
        places = (
            complex(neck + self.long / 2, -self.aside),
            complex(neck + self.long / 2, self.aside),
        )
        screws = {
            f"clamp screw {k}": circle(z, self._screw.clearance / 2)
            for k, z in enumerate(places, 1)
        }
        floor = thick - s.wire_diameter
        proud = thick - s.wire_diameter * _GRIP
        layers = (
            Layer(plate(SLIDER, edge(*head), pin | screws, wall), 0.0, floor),
            Layer(plate(SLIDER, edge(*head, *slot), pin | screws, wall), floor, proud),
            Layer(plate(SLIDER, edge(*shank), pin, wall), proud, thick),
        )
        return Part(
            SLIDER,
            "Needle holder",
            layers,
            centres=(0j, *places),
            min_wall=wall,
            bore=layout.hole("P", SLIDER),
            points=(("P", 0j),),
            notes=(
                f"level {layout.level[SLIDER]} of the machine, from the plate",
                "the needle's wire lies in the groove",
                "clamp, screws and nuts hold it at the head",
            ),
        )

    def _clamp(self) -> Part:
        """Plate over the wire at the slider's head; its origin is its middle."""
        half = complex(self.long / 2 - 0.2, self._half)
        places = (-1j * self.aside, 1j * self.aside)
        region = plate(CLAMP, rectangle(-half, half), self._bored(places), self.layout.min_wall)
        return Part(
            CLAMP,
            "Wire clamp",
            (Layer(region, 0.0, self.sizes.thickness),),
            centres=places,
            notes=(HoldingNote("screws and nuts hold it on the needle's wire"),),
            min_wall=self.layout.min_wall,
        )

    def _bored(self, places: tuple[complex, complex]) -> Mapping[str, Contour]:
        hole = self._screw.clearance / 2
        return {f"screw {k}": circle(z, hole) for k, z in enumerate(places, 1)}

    @property
    def _height(self) -> float:
        """Of the plate and the tube's block on it: its lid is as thick as a wall."""
        return self._top + self._slide / 2 + self.sizes.wall

    def _tube(self, lift: float) -> Part:
        """The block about its middle; the bore is as wide and high as the wire and a fit; lift: of the slider over the plate."""
        s = self.sizes
        wall = self.layout.min_wall
        thick = self.layout.thickness(SLIDER)
        places = (-1j * self._tube_screws, 1j * self._tube_screws)
        half = complex(s.tube_length / 2, max(s.slider_width / 2, self._tube_screws + self._rim))
        holes = self._bored(places)
        whole = plate(TUBE, rectangle(-half, half), holes, wall)
        low = lift + thick - s.wire_diameter - self._slide / 2
        high = lift + thick + self._slide / 2
        side = complex(half.real, self._bore / 2)
        beside = (
            Region(rectangle(-half, side.conjugate()), (holes["screw 1"],)),
            Region(rectangle(-side.conjugate(), half), (holes["screw 2"],)),
        )
        layers = (
            Layer(whole, 0.0, low),
            *(Layer(each, low, high) for each in beside),
            Layer(whole, high, self._height - s.base_thickness),
        )
        return Part(
            TUBE,
            "Tube of the needle",
            layers,
            centres=places,
            min_wall=wall,
            notes=(
                f"the needle's wire slides in its bore, {self._bore:g} square",
                HoldingNote("two screws hold it on the plate"),
            ),
        )

    def _stand_in(self) -> StandIn:
        """The wire, which is bought, on the slider."""
        half = self.sizes.wire_diameter / 2
        ends = complex(self.hook + half), complex(self.hook + self.wire - half)
        bar = (*ends, half, self._top - self.sizes.wire_diameter, self._top)
        return StandIn("needle", SLIDER, (), bars=(bar,))

    # ---- what is said of it -------------------------------------------------------------------------------------------

    def sketch(self) -> Sketch:
        """The wire, as the moving picture shows it."""
        ends = np.array([self.hook, self.hook + self.wire], complex)
        return Sketch("needle", (ends,), body=SLIDER)

    @property
    def figures(self) -> list[Figure]:
        """Length of the wire and how far it stands out."""
        least, most = self.out
        return [
            Figure("needle length", self.wire, "mm"),
            Figure("needle out, least", least, "mm"),
            Figure("needle out, greatest", most, "mm"),
        ]

    def findings(self, stroke: Band | None) -> list[Finding]:
        """NEEDLE_REACH, where the spec says how deep it is to go, and NEEDLE_GUIDED."""
        s = self.sizes
        least, most = self.out
        held = round(min(s.tube_length, s.tube_length + least), 9)
        longer = "a longer parts.tube_length or parts.wire_length"
        said = f"length of wire in the tube, whose point is {least:.4g} mm past the mouth; {longer} makes it more"
        wanted = _GUIDED * s.wire_diameter
        findings = [at_least("NEEDLE_GUIDED", held, wanted, "mm", Where("innermost"), said)]
        if stroke is None:
            return findings
        said = f"point past the tube's mouth, {least:.4g} mm at the innermost place; parts.wire_length sets it"
        reach = round(most, 9)
        findings.append(at_least("NEEDLE_REACH", reach, stroke[0], "mm", Where("outermost"), said))
        return [
            *findings,
            at_most("NEEDLE_REACH", reach, stroke[1], "mm", Where("outermost"), said),
        ]
