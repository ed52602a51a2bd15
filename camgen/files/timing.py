"""The timing diagram of the cams on a shaft: what each follower does over one turn, one strip below the other, on one sheet."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from camgen.files.sheet import Sheet, write_dxf_sheet, write_pdf
from camgen.files.title_block import BLOCK, Facts, title_block
from camgen.geometry.outlines import Floats
from camgen.parts.part import Part

_PAPER = (297.0, 210.0)  # A4, mm
_FILING = 20.0
_MARGIN = 10.0
_NAMES = 40.0  # room for names and ends of strokes, left of the strips
_NUMBERS = 10.0  # the same for the numbers of the levels
_HEAD = 12.0  # above the strips, for the angles
_STRIP = 32.0  # height of a strip, at most
_CURVE = 0.62  # of a strip: height of its curve
_STEP = 30  # deg, between lines
_APART = 9.0  # mm, of angles that are written below a curve
_NEAR = 0.15  # of a curve's height, of levels with numbers
_STILL = 1e-9  # of the greatest speed


@dataclass(frozen=True)
class Motion:
    """What a cam's follower does over a turn of its shaft: (n,) deg from 0 to 360, (n,) mm or deg, and its rate per deg."""

    name: str
    unit: str
    angle: Floats
    stroke: Floats
    rate: Floats

    @property
    def levels(self) -> list[float]:
        """Its least and greatest stroke, and between them, not too near, 0 and where it stands at 0 deg; rising."""
        levels = [float(np.min(self.stroke)), float(np.max(self.stroke))]
        for level in (0.0, float(self.stroke[0])):
            shares = self.share(np.array([level, *levels]))
            if 0 < shares[0] < 1 and np.min(np.abs(shares[1:] - shares[0])) > _NEAR:
                levels.append(level)
        return sorted(set(levels))

    def share(self, stroke: Floats | float) -> Floats:
        """A stroke from the least, 0, to the greatest, 1."""
        least = float(np.min(self.stroke))
        size = float(np.max(self.stroke)) - least
        return (np.asarray(stroke) - least) / (size or 1.0)

    @property
    def ends(self) -> list[float]:
        """Angles at which it begins or ends to move, deg."""
        moves = np.abs(self.rate) > _STILL * float(np.max(np.abs(self.rate), initial=0.0))
        places = np.flatnonzero(np.diff(moves.astype(int)))
        return [float(self.angle[k + 1 if moves[k] else k]) for k in places]


def write_timing(
    folder: Path, name: str, motions: Sequence[Motion], facts: Facts
) -> tuple[Path, Path]:
    """Write `<name>-timing-drawing.dxf` and `.pdf` into folder; returns their paths."""
    sheet = timing_sheet(name, motions, facts)
    dxf = folder / f"{name}-timing-drawing.dxf"
    pdf = folder / f"{name}-timing-drawing.pdf"
    write_dxf_sheet(dxf, sheet, 1.0, 0j)
    write_pdf(pdf, sheet)
    return dxf, pdf


def timing_sheet(name: str, motions: Sequence[Motion], facts: Facts) -> Sheet:
    """The sheet itself."""
    width, height = _PAPER
    sheet = Sheet(width, height, f"Timing diagram ({name})")
    right = width - _MARGIN
    top = height - _MARGIN
    sheet.frame(_FILING, _MARGIN)
    left = _FILING + _NAMES
    across = right - 6 - left
    foot = _MARGIN + BLOCK + 4
    strip = min(_STRIP, (top - _HEAD - foot) / len(motions))
    low = top - _HEAD - strip * len(motions)
    for degrees in range(0, 361, _STEP):
        x = left + across * degrees / 360
        sheet.line(complex(x, low), complex(x, top - _HEAD), layer="DIM")
        sheet.text(complex(x, top - _HEAD + 2), f"{degrees}°", 2.5, "centre")
    sheet.text(complex(_FILING + 3, top - _HEAD + 2), "Shaft turned by", 2.5)
    for k, motion in enumerate(motions):
        base = top - _HEAD - strip * (k + 1)
        sheet.line(complex(_FILING, base), complex(right, base), layer="TEXT")
        _strip(sheet, motion, complex(left, base), across, strip)
    block = Part("timing", "Timing diagram", ())
    title_block(sheet, complex(right, _MARGIN), block, facts, 0.0, "A4")
    return sheet


def _strip(sheet: Sheet, motion: Motion, corner: complex, across: float, high: float) -> None:
    """One curve over a strip whose lower left corner is there."""
    foot = corner + 1j * (high * (1 - _CURVE) / 2 + 1)
    rise = 1j * _CURVE * high
    for level in motion.levels:
        at = foot + rise * float(motion.share(level))
        if level != 0:
            sheet.line(at, at + across, layer="DIM")
        sheet.text(at - 1 - 0.9j, f"{level:z.4g}", 1.8, "right")
    zero = float(motion.share(0.0))
    if 0 <= zero <= 1:
        sheet.line(foot + rise * zero, foot + rise * zero + across, layer="CENTER")
    points = foot + across * motion.angle / 360 + rise * motion.share(motion.stroke)
    sheet.line(*points.tolist(), layer="CUT")
    name = complex(corner.real - _NAMES + 3, corner.imag)
    room = _NAMES - 3 - _NUMBERS
    sheet.text(name + 1j * (high / 2 + 1), motion.name, 3.5, room=room)
    at_start = f"{motion.unit}, at 0°: {round(float(motion.stroke[0]), 6):z.4g}"
    sheet.text(name + 1j * (high / 2 - 5), at_start, 2.5, room=room)
    last = -_APART
    for degrees in motion.ends:
        along = across * degrees / 360
        at = corner + along
        sheet.line(at, at + 1.5j, layer="TEXT")
        if along - last >= _APART:
            sheet.text(at + 0.8 + 1.2j, f"{degrees:.4g}°", 2.0)
            last = along
