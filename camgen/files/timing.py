"""The timing diagram of the cams on a shaft: what each follower does over one turn, one strip below the other, on one sheet."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from camgen.files.sheet import Sheet, write_dxf_sheet, write_pdf
from camgen.files.title_block import Facts, title_block
from camgen.geometry.outlines import Floats
from camgen.parts.part import Part

_PAPER = (297.0, 210.0)  # A4, mm
_FILING = 20.0
_MARGIN = 10.0
_NAMES = 40.0  # room for names and ends of strokes, left of the strips
_HEAD = 12.0  # above the strips, for the angles
_STRIP = 32.0  # height of a strip, at most
_CURVE = 0.62  # of a strip: height of its curve
_STEP = 30  # deg, between lines
_APART = 9.0  # mm, of angles that are written below a curve
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
    corners = (_FILING + 1j * _MARGIN, right + 1j * _MARGIN, right + 1j * top, _FILING + 1j * top)
    sheet.line(*corners, layer="TEXT", closed=True)
    left = _FILING + _NAMES
    across = right - 6 - left
    foot = _MARGIN + facts.height + 4
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
    least = float(np.min(motion.stroke))
    most = float(np.max(motion.stroke))
    foot = corner + 1j * (high * (1 - _CURVE) / 2 + 1)
    share = (motion.stroke - least) / ((most - least) or 1.0)
    x = foot.real + across * motion.angle / 360
    points = x + 1j * (foot.imag + _CURVE * high * share)
    sheet.line(*points.tolist(), layer="CUT")
    name = complex(corner.real - _NAMES + 3, corner.imag)
    sheet.text(name + 1j * (high / 2 + 1), motion.name, 3.5, room=_NAMES - 5)
    size = f"{least:z.4g} to {most:z.4g} {motion.unit}"
    sheet.text(name + 1j * (high / 2 - 5), size, 2.5, room=_NAMES - 5)
    last = -_APART
    for degrees in motion.ends:
        along = across * degrees / 360
        at = corner + along
        sheet.line(at, at + 1.5j, layer="TEXT")
        if along - last >= _APART:
            sheet.text(at + 0.8 + 1.2j, f"{degrees:.4g}°", 2.0)
            last = along
