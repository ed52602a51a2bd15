"""Signs of a drawing: frames of tolerances, datums, roughness; all with the place that they take. Coordinates: mm of paper."""

from __future__ import annotations

import math
from collections.abc import Sequence

from camgen.files.dimensions import number
from camgen.files.sheet import Fill, Sheet, Text

FRAME = 6.0  # height of a frame of a tolerance
_HEIGHT = 2.5  # of the text in it
_LEAST = 8.0  # width of a cell
_BOX = 5.0  # of a datum's letter


def cell(sheet: Sheet, corner: complex, width: float, height: float) -> None:
    """A frame of so much, its lower left corner there."""
    top = 1j * height
    sheet.line(
        corner, corner + width, corner + width + top, corner + top, layer="TEXT", closed=True
    )


def frame(sheet: Sheet, corner: complex, cells: Sequence[str]) -> complex:
    """Cells of a tolerance from their lower left corner on, the first left free for its sign; where they end."""
    for k, text in enumerate(("", *cells)):
        width = max(_LEAST, Text(0j, text, _HEIGHT).room + 3)
        cell(sheet, corner, width, FRAME)
        if k:
            sheet.text(corner + width / 2 + 1.8j, text, _HEIGHT, "centre")
        corner += width
    return corner


def width_of(cells: Sequence[str]) -> float:
    """How wide such a frame is."""
    return _LEAST + sum(max(_LEAST, Text(0j, text, _HEIGHT).room + 3) for text in cells)


def boxed(sheet: Sheet, at: complex, text: str) -> None:
    """A theoretically exact size in its box, from the lower left of the text on. [ISO 1101]"""
    cell(sheet, at - 1 - 0.7j, Text(0j, text, _HEIGHT).room + 2, _HEIGHT + 1.4)
    sheet.text(at, text, _HEIGHT)


def position(
    sheet: Sheet, corner: complex, width: float, datums: Sequence[str], flat: bool = False
) -> complex:
    """Tolerance of position: the diameter of its zone, of a middle plane (flat) its width, mm. [ISO 1101]"""
    middle = corner + _LEAST / 2 + 3j
    sheet.arc(middle, 1.4, 0.0, math.tau, "TEXT")
    for way in (1, 1j):
        sheet.line(middle - 2.2 * way, middle + 2.2 * way, layer="TEXT")
    return frame(sheet, corner, [f"{'' if flat else 'Ø'}{number(width)}", *datums])


def coaxiality(sheet: Sheet, corner: complex, width: float, datums: Sequence[str]) -> complex:
    """Tolerance of coaxiality: the diameter of its zone, mm. [ISO 1101: two concentric circles]"""
    for radius in (1.0, 2.2):
        sheet.arc(corner + _LEAST / 2 + 3j, radius, 0.0, math.tau, "TEXT")
    return frame(sheet, corner, [f"Ø{number(width)}", *datums])


def squareness(sheet: Sheet, corner: complex, width: float, datum: str) -> complex:
    """Tolerance of perpendicularity of an axis to a face: the diameter of its zone, mm. [ISO 1101: an upright line on a level one]"""
    foot = corner + complex(_LEAST / 2, 1.4)
    sheet.line(foot - 2.4, foot + 2.4, layer="TEXT")
    sheet.line(foot, foot + 3.4j, layer="TEXT")
    return frame(sheet, corner, [f"Ø{number(width)}", datum])


def line_profile(
    sheet: Sheet, corner: complex, width: float, datums: Sequence[str], combined: bool = False
) -> complex:
    """Tolerance of a line's profile: the width of its zone, mm. [ISO 1101: a half circle, open below]

    combined: whether zones of several lines keep their places to each other. [ISO 1101: CZ]
    """
    sheet.arc(corner + _LEAST / 2 + 1.8j, 2.2, 0.0, math.pi, "TEXT")
    return frame(sheet, corner, [f"{number(width)}{' CZ' if combined else ''}", *datums])


def symmetry(sheet: Sheet, corner: complex, width: float, datum: str) -> complex:
    """Tolerance of symmetry about a datum: the width of its zone, mm. [ISO 1101: three lines, the middle one longer]"""
    for high, half in ((1.8, 1.7), (3.0, 3.0), (4.2, 1.7)):
        middle = corner + complex(_LEAST / 2, high)
        sheet.line(middle - half, middle + half, layer="TEXT")
    return frame(sheet, corner, [number(width), datum])


def run_out(sheet: Sheet, corner: complex, width: float, datum: str) -> complex:
    """Tolerance of circular run-out about a datum, mm. [ISO 1101: an arrow upwards to the right]"""
    way = complex(1, 1) / math.sqrt(2)
    tip = corner + complex(_LEAST / 2, FRAME / 2) + 2.8 * way
    sheet.line(tip - 5.6 * way, tip, layer="TEXT")
    sheet.arrow(tip, way, "TEXT")
    return frame(sheet, corner, [number(width), datum])


def all_round(sheet: Sheet, at: complex) -> None:
    """The circle at the bend of a leader: what it says holds for the whole outline of the view. [ISO 1101]"""
    sheet.arc(at, 1.25, 0.0, math.tau, "TEXT")


def roughness(sheet: Sheet, foot: complex, text: str) -> float:
    """Sign of a surface from which material is taken, its point there, with "Ra 0.8" at its arm; how wide. [ISO 1302]"""
    left = foot + complex(-1.44, 2.5)
    right = foot + complex(2.89, 5.0)
    arm = Text(0j, text, _HEIGHT).room + 2
    sheet.line(left, foot, right, right + arm, layer="TEXT")
    sheet.line(left, foot + complex(1.44, 2.5), layer="TEXT")
    sheet.text(right + 0.8 - 3.2j, text, _HEIGHT)
    return 2.89 + arm


def datum(sheet: Sheet, at: complex, way: complex, letter: str) -> None:
    """A datum's triangle on a line, its stem along the unit `way`, and its letter in a box. [ISO 5459]"""
    across = 1.5 * 1j * way
    tip = at + 2.6 * way
    sheet.things.append(Fill((at - across, at + across, tip), "TEXT"))
    end = at + 5.0 * way
    sheet.line(tip, end, layer="TEXT")
    middle = end + _BOX / 2 * way
    cell(sheet, middle - _BOX / 2 * (1 + 1j), _BOX, _BOX)
    sheet.text(middle - 1.25j, letter, _HEIGHT, "centre")
