"""The tube that guides the needle's wire beyond the slider: a block with a square bore, on the body past the slider's head.

The body has a window under the head's way, for the nuts of its clamp. The wire lies in the slider's groove, its point at
`wire_length` from the groove's inner end; unless that is given the point is flush with the tube's mouth at the innermost place.
[Sviridov, Vladimirov, Chusovitin, figure 4, item 3; the point is to reach 2 to 3 mm out]
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from camgen.errors import Key
from camgen.findings import Finding, Where, at_least, at_most
from camgen.geometry.outlines import Contour, Region, circle, rectangle
from camgen.machine.features import Mount, StandIn
from camgen.machine.model import GROUND
from camgen.parts.catalogue import SCREWS, Bought, fastener
from camgen.parts.hardware import plate
from camgen.parts.part import Held, Layer, Part
from camgen.study import Sketch

if TYPE_CHECKING:
    from camgen.machines.eccentric_drive.mechanism import EccentricDrive
    from camgen.machines.eccentric_drive.tables import Parts

NAME = "needle-tube"
FACETS = 0.02  # mm, by which a wall may seem thinner where it is measured on facets
_AIR = 1.0  # mm, between the slider's head at its outermost place and the tube
_GUIDED = 2.0  # diameters of the wire in the tube, at least: the 2 to 1 rule of sliding guides


def tube_checks(
    sizes: Parts, slide: float, floor: float, least: float
) -> list[tuple[bool, Key, float, str]]:
    """What is wrong with its keys: (holds, path, value, what would be right).

    floor: greatest wire in the slider's groove; least: length that the screws of the tube need, mm.
    """
    if not sizes.tube_length:
        said = "nothing here without parts.tube_length: it is the tube that the wire's point stands out of"
        return (
            [(False, ("parts", "wire_length"), sizes.wire_length, said)]
            if sizes.wire_length is not None
            else []
        )
    thin = floor - slide / 2
    return [
        (
            sizes.tube_length >= least,
            ("parts", "tube_length"),
            sizes.tube_length,
            f"at least {least:.4g} mm, or 0: none",
        ),
        (
            sizes.wire_diameter <= thin,
            ("parts", "wire_diameter"),
            sizes.wire_diameter,
            f"at most {thin:g} mm, for the tube's floor",
        ),
    ]


class NeedleTube:
    """Sizes and places of the tube, mm; x from the shaft outwards."""

    def __init__(self, drive: EccentricDrive) -> None:
        self.drive, self.sizes = drive, drive.making
        neck, length, screw = drive.head
        self.begin = drive.outermost + neck + length + _AIR
        self.mouth = self.begin + self.sizes.tube_length
        self._bore = self.sizes.wire_diameter + drive.print.slide_clearance
        self.aside = max(
            screw.imag,
            self._bore / 2
            + drive.allowed.min_wall
            + FACETS
            + SCREWS[self.sizes.screw].clearance / 2,
        )
        self.rim = drive.rim
        self._half = max(self.sizes.slider_width / 2, self.aside + self.rim)

    @property
    def middle(self) -> complex:
        """Of the block, in the plane."""
        return complex((self.begin + self.mouth) / 2, self.drive.geometry.offset)

    @property
    def screws(self) -> tuple[complex, complex]:
        """Places of its two screws in the body."""
        return self.middle - 1j * self.aside, self.middle + 1j * self.aside

    @property
    def window(self) -> Contour:
        """Of the body, under the way of the slider's head."""
        start, offset = self.drive.rail[1], self.drive.geometry.offset
        half = max(self.sizes.slider_width / 2, self.drive.head[2].imag + self.rim) + _AIR
        return rectangle(
            complex(start + _AIR / 2, offset - half), complex(self.begin - _AIR / 2, offset + half)
        )

    @property
    def height(self) -> float:
        """Of the block: its lid is as thick as a wall."""
        return (
            self.sizes.slider_thickness
            + self.drive.print.slide_clearance / 2
            + self.sizes.strap_wall
        )

    def part(self) -> Part:
        """The block about its middle; the bore is as wide and high as the wire and a fit."""
        p, wall, slide = self.sizes, self.drive.allowed.min_wall, self.drive.print.slide_clearance
        hole, half = SCREWS[p.screw].clearance / 2, complex(p.tube_length / 2, self._half)
        holes = {
            f"screw {k}": circle(side * 1j * self.aside, hole) for k, side in enumerate((-1, 1), 1)
        }
        whole = plate(NAME, rectangle(-half, half), holes, wall)
        floor, lid = (
            p.slider_thickness - p.wire_diameter - slide / 2,
            p.slider_thickness + slide / 2,
        )
        side = complex(half.real, self._bore / 2)
        beside = (
            Region(rectangle(-half, side.conjugate()), (circle(-1j * self.aside, hole),)),
            Region(rectangle(-side.conjugate(), half), (circle(1j * self.aside, hole),)),
        )
        layers = (
            Layer(whole, 0.0, floor),
            *(Layer(each, floor, lid) for each in beside),
            Layer(whole, lid, self.height),
        )
        return Part(
            NAME,
            "Tube of the needle",
            layers,
            centres=(-1j * self.aside, 1j * self.aside),
            min_wall=wall,
            notes=(
                f"the needle's wire slides in its bore, {self._bore:g} square",
                Held("two screws hold it on the body"),
            ),
        )

    def mount(self) -> Mount:
        """On the body, past the slider's head."""
        return Mount(NAME, GROUND, self.middle, z=self.sizes.body_thickness)

    @property
    def wire(self) -> float:
        """Length of the wire that is straight, from the inner end of the slider's groove to its point."""
        given, drive = self.sizes.wire_length, self.drive
        innermost = drive.rail[0] + self.sizes.slider_width / 2
        return self.mouth - innermost - drive.hook if given is None else given

    @property
    def out(self) -> tuple[float, float]:
        """How far the point stands out of the tube at the slider's innermost and outermost places; below 0: within."""
        innermost = self.drive.rail[0] + self.sizes.slider_width / 2
        least = innermost + self.drive.hook + self.wire - self.mouth
        return least, least + self.drive.outermost - innermost

    def needle(self) -> StandIn:
        """The wire, which is bought, on the slider."""
        p, hook, half = self.sizes, self.drive.hook, self.sizes.wire_diameter / 2
        top = p.body_thickness + p.slider_thickness
        bar = (
            complex(hook + half),
            complex(hook + self.wire - half),
            half,
            top - p.wire_diameter,
            top,
        )
        return StandIn("needle", "slider", (), bars=(bar,))

    def sketch(self) -> Sketch:
        """The wire, as the moving picture shows it."""
        return Sketch(
            "needle",
            (np.array([self.drive.hook, self.drive.hook + self.wire], complex),),
            body="slider",
        )

    @property
    def numbers(self) -> dict[str, float]:
        """Length of the wire and how far it stands out."""
        least, most = self.out
        return {
            "needle_length_mm": self.wire,
            "needle_out_least_mm": least,
            "needle_out_greatest_mm": most,
        }

    def findings(self) -> list[Finding]:
        """NEEDLE_REACH, where the spec says how deep it is to go, and NEEDLE_GUIDED."""
        p, (least, most) = self.sizes, self.out
        held = min(p.tube_length, p.tube_length + least)
        said = f"wire in the tube, its point {least:.4g} mm past the mouth; a longer parts.tube_length or parts.wire_length"
        found = [
            at_least(
                "NEEDLE_GUIDED",
                round(held, 9),
                _GUIDED * p.wire_diameter,
                "mm",
                Where("innermost"),
                said,
            )
        ]
        if self.drive.allowed.stroke is not None:
            low, high = self.drive.allowed.stroke
            said = f"point past the tube's mouth, {least:.4g} mm at the innermost place; parts.wire_length sets it"
            found.append(
                at_least("NEEDLE_REACH", round(most, 9), low, "mm", Where("outermost"), said)
            )
            found.append(
                at_most("NEEDLE_REACH", round(most, 9), high, "mm", Where("outermost"), said)
            )
        return found

    def bought(self) -> Bought:
        """Its screws."""
        return fastener(
            "screw of the needle's tube",
            self.sizes.screw,
            self.sizes.body_thickness + self.height,
            2,
        )
