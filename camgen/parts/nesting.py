"""Nesting: flat outlines on as few sheets as it takes, each turned as it lies best, always at the same places.

    cell    a square of the raster on which it is tried where an outline fits
    mask    the cells that an outline covers, with its share of the gap
    spot    where an outline has come to lie

The largest comes first; each goes as far to the left as it can, then as far down, turned by the angle at which it then ends
soonest. Two masks that share no cell are at least the gap apart: what is less than half a cell's diagonal away is covered too.
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from camgen.geometry.outlines import Points

Mask = NDArray[np.bool_]

ANGLES = 12  # tried, in equal steps of a turn
_CELLS = 600  # along the longer side of a sheet, at most
_FINEST = 1.0  # mm, side of a cell, at least
_DIAGONAL = 0.7072  # half of a cell's, in sides


@dataclass(frozen=True)
class Spot:
    """Where an outline lies: on which sheet, from 0; turned about its origin, rad; then moved there, mm."""

    sheet: int
    angle: float
    place: complex


@dataclass(frozen=True)
class _Footprint:
    """An outline at one angle: its mask, and where its own origin lies from the mask's corner, mm."""

    angle: float
    mask: Mask
    origin: complex


def nest(outlines: Sequence[Points], sheet: tuple[float, float], gap: float) -> list[Spot | None]:
    """A spot for each outline, polygons (n,) complex mm, in their order; None for one that fits on no sheet, however turned.

    sheet: width and height, mm; gap between neighbours, half of it to the edge, mm.
    """
    cell = max(_FINEST, max(sheet) / _CELLS)
    size = tuple(math.floor(side / cell) for side in sheet)
    spots: list[Spot | None] = [None] * len(outlines)
    choices: dict[bytes, list[_Footprint]] = {}
    sheets: list[Mask] = []
    order = sorted(range(len(outlines)), key=lambda k: (-_area(outlines[k]), k))
    for k in order:
        key = outlines[k].tobytes()
        if key not in choices:
            masks = [
                _footprint(outlines[k], cell, gap, math.tau * a / ANGLES) for a in range(ANGLES)
            ]
            choices[key] = [
                t for t in masks if all(m <= n for m, n in zip(t.mask.shape, size, strict=True))
            ]
        if not choices[key]:
            continue
        for number in range(len(sheets) + 1):
            if number == len(sheets):
                sheets.append(np.zeros(size, bool))
            spot = _first(sheets[number], choices[key])
            if spot is not None:
                (x, y), best = spot
                width, height = best.mask.shape
                sheets[number][x : x + width, y : y + height] |= best.mask
                spots[k] = Spot(number, best.angle, cell * complex(x, y) + best.origin)
                break
    return spots


def _area(ring: Points) -> float:
    return abs(float(np.imag(np.conj(ring) * np.roll(ring, -1)).sum())) / 2


def _footprint(outline: Points, cell: float, gap: float, angle: float) -> _Footprint:
    """The mask of an outline at an angle."""
    import shapely

    z = outline * cmath.rect(1, angle)
    reach = gap / 2 + _DIAGONAL * cell
    low = complex(z.real.min(), z.imag.min()) - reach * (1 + 1j)
    width, height = (
        math.ceil((side + 2 * reach) / cell) for side in (np.ptp(z.real), np.ptp(z.imag))
    )
    area = shapely.Polygon(np.column_stack([z.real - low.real, z.imag - low.imag])).buffer(reach)
    shapely.prepare(area)
    x, y = np.meshgrid(
        cell * (np.arange(width) + 0.5), cell * (np.arange(height) + 0.5), indexing="ij"
    )
    mask = np.asarray(shapely.contains_xy(area, x, y))
    columns = np.flatnonzero(mask.any(axis=1))
    rows = np.flatnonzero(mask.any(axis=0))
    corner = cell * complex(columns[0], rows[0])
    return _Footprint(
        angle, mask[columns[0] : columns[-1] + 1, rows[0] : rows[-1] + 1], -low - corner
    )


def _first(sheet: Mask, choices: Sequence[_Footprint]) -> tuple[tuple[int, int], _Footprint] | None:
    """The cell where one of the masks goes to end soonest, and which; None where none fits."""
    from scipy import fft

    reach = int(np.flatnonzero(sheet.any(axis=1))[-1]) + 1 if sheet.any() else 0
    width = min(len(sheet), reach + max(choice.mask.shape[0] for choice in choices))
    window = sheet[:width]
    shape = [fft.next_fast_len(side, real=True) for side in window.shape]
    spectrum = fft.rfft2(window, shape)
    best: tuple[tuple[float, ...], tuple[int, int], Any] | None = None
    for k, choice in enumerate(choices):
        m, n = choice.mask.shape
        if m > width:
            continue
        overlap = fft.irfft2(spectrum * np.conj(fft.rfft2(choice.mask, shape)), shape)[
            : width - m + 1, : window.shape[1] - n + 1
        ]
        free = overlap < 0.5
        place = int(np.argmax(free))
        x, y = divmod(place, free.shape[1])
        if free[x, y] and (best is None or (x + m, y + n, k) < best[0]):
            best = (x + m, y + n, k), (x, y), choice
    return None if best is None else (best[1], best[2])
