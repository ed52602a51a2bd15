"""The title block of a drawing: what it says beside the part's shape, its cells, and the symbol of first-angle projection."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from camgen._version import __version__
from camgen.files.dimensions import Hole, number
from camgen.files.sheet import Sheet, Text
from camgen.parts.part import Part
from camgen.tolerances import SAME_POINT

SIZE = (170.0, 36.0)  # mm [width of ISO 7200]
_ROW = 12.0


@dataclass(frozen=True)
class Fit:
    """How a round hole of a part fits what goes through."""

    at: complex  # its centre, mm
    diameter: float  # mm
    words: str  # such as "slide on Ø6"


@dataclass(frozen=True)
class Facts:
    """What a drawing says of a part besides its shape; "" or None is left out."""

    mechanism: str = ""
    material: str = ""
    mass_g: float | None = None  # of one part, g
    tolerance: str = ""  # general tolerance
    number: str = ""  # of the drawing, its file's name unless given
    date: str = ""
    fits: Sequence[Fit] = ()
    profile_step_deg: float | None = None  # between the rows of a cam's table
    position: float = 0.0  # of holes: the diameter in which their axes lie, mm

    def shape(self, hole: Hole) -> str:
        """What a hole is, with its fit where one is known."""
        for fit in self.fits:
            if (
                abs(fit.at - hole.place) < SAME_POINT
                and abs(fit.diameter - 2 * hole.radius) < SAME_POINT
            ):
                return f"{hole.shape} {fit.words}"
        return hole.shape


def grams(mass: float) -> str:
    """A mass to three digits, g."""
    return f"{float(f'{mass:.3g}'):g} g"


def title_block(
    sheet: Sheet, corner: complex, part: Part, facts: Facts, scale: float, size: str
) -> None:
    """Draw the block, its lower right corner there; scale: mm of paper for a mm of the part; size: of the paper."""
    mass = "" if facts.mass_g is None else grams(facts.mass_g)
    middle = [
        ("Mechanism", facts.mechanism, 0.0),
        ("Material", facts.material, 36.0),
        ("Mass", mass, 24.0),
        ("General tolerance", facts.tolerance, 36.0),
        ("Date", facts.date, 30.0),
    ]
    middle = [cell for cell in middle if cell[1]]
    middle = [
        (key, value, width or SIZE[0] - sum(cell[2] for cell in middle))
        for key, value, width in middle
    ]
    rows = [
        [
            ("Quantity", str(part.count), 22.0),
            ("Scale", f"{number(scale)}:1" if scale >= 1 else f"1:{number(1 / scale)}", 22.0),
            ("Sheet", size, 18.0),
            ("Units", "mm", 18.0),
            ("Projection", "", 45.0),
            ("Made by", f"camgen {__version__}", 45.0),
        ],
        middle,
        [("Part", part.title, 85.0), ("Drawing number", facts.number, 85.0)],
    ]
    for k, row in enumerate(rows):
        left = corner - SIZE[0] + 1j * _ROW * k
        for key, value, width in row:
            _cell(sheet, left, width, _ROW)
            sheet.text(left + 1.5 + 8.6j, key, 1.8)
            if key == "Projection":
                _first_angle(sheet, left + 12 + 4.3j)
                sheet.text(left + 24 + 3.2j, "first angle", 2.5, room=width - 25)
            else:
                sheet.text(left + 1.5 + 2.6j, value, 3.5, room=width - 3)
            left += width


def _cell(sheet: Sheet, corner: complex, width: float, height: float) -> None:
    """A frame of so much, mm, its lower left corner there."""
    top = 1j * height
    sheet.line(
        corner, corner + width, corner + width + top, corner + top, layer="TEXT", closed=True
    )


def position_frame(sheet: Sheet, corner: complex, diameter: float, datum: str) -> None:
    """Frame of a tolerance of position, from its lower left corner, and what it is of; datum: "" is none. [ISO 1101]"""
    high = 6.0
    middle = corner + 4 + 3j
    cells = ["", f"Ø{number(diameter)}", *([datum] if datum else [])]
    sheet.arc(middle, 1.4, 0.0, math.tau, "TEXT")
    for way in (1, 1j):
        sheet.line(middle - 2.2 * way, middle + 2.2 * way, layer="TEXT")
    for k, cell in enumerate(cells):
        width = max(8.0, Text(0j, cell, 2.5).room + 3)
        _cell(sheet, corner, width, high)
        sheet.text(corner + width / 2 + 1.8j, cell if k else "", 2.5, "centre")
        corner += width
    sheet.text(corner + 2 + 1.8j, "round holes; X and Y are exact", room=58)


def _first_angle(sheet: Sheet, middle: complex) -> None:
    """A cone's frustum from the side, small end left, and to its right as seen from there. [ISO 5456-2]"""
    # radii, mm
    large = 2.8
    small = 1.4
    side = middle - 5.5
    front = middle + 4.5
    sheet.line(
        side - 2.8 - 1j * small,
        side + 2.8 - 1j * large,
        side + 2.8 + 1j * large,
        side - 2.8 + 1j * small,
        layer="TEXT",
        closed=True,
    )
    for radius in (large, small):
        sheet.arc(front, radius, 0.0, math.tau, "TEXT")
    sheet.line(side - 4, side + 4, layer="CENTER")
    sheet.line(front - 4, front + 4, layer="CENTER")
    sheet.line(front - 3.6j, front + 3.6j, layer="CENTER")
