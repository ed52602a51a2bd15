"""Linear dimensions of a drawing, on paper: lines, arrows and the number with its fit. Coordinates: mm of paper."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

from camgen.files.dimensions import number
from camgen.files.limits import decimals, general
from camgen.files.sheet import Sheet, Size, Text

Box = tuple[complex, complex]  # lower left and upper right corner of a text along x
_AIR = 0.7  # mm, between a text and the end of a line that is broken there
_FITTED = 3  # decimals of a number with a fit
REFERENCE = "("  # before a size that follows from others, and that no one has to keep [ISO 129-1]


@dataclass(frozen=True)
class Measure:
    """What a linear dimension says.

    fit: behind the number; factor: mm of the part for one at the scale of the views, below 1 in a detail; digits: after the point, by default
    those that a size with a fit, or else its general tolerance, asks for.
    """

    value: float  # mm
    sign: str = ""  # before the number
    fit: str = ""
    factor: float = 1.0
    digits: int | None = None
    letters: float = 3.5  # their height, mm of paper

    @property
    def behind(self) -> str:
        """What stands behind the number: its fit, or the end of the parentheses of a reference size."""
        return ")" if self.sign.startswith(REFERENCE) else f" {self.fit}" if self.fit else ""


@dataclass(frozen=True)
class Room:
    """What is free of the paper beside a dimension."""

    left: float = 0.0  # its edge
    # of dimensions nearer to the part, at which lines from the ends of one along x are broken
    texts: Sequence[Box] = ()


_ALL = Room()


def dimension(
    sheet: Sheet,
    ends: tuple[complex, complex],
    away: complex,
    measure: Measure,
    tolerance: str,
    room: Room = _ALL,
) -> Box:
    """Linear dimension between two ends, its line moved by `away`; arrows outside where it is short. Returns where its text is.

    tolerance: the sheet's general one, which says how many decimals a number without a fit has; room: what is free of the paper.
    """
    drawn = Sheet(0.0, 0.0, "")
    out = away / abs(away)
    for end in ends:
        for a, b in _broken(end + out, end + away + 2 * out, room.texts):
            drawn.line(a, b, layer="DIM")
    start = ends[0] + away
    end = ends[1] + away
    length = abs(end - start)
    along = (end - start) / length
    reading = 1 if abs(along.real) > 0.5 else 1j
    outside = length < 12
    if outside:
        start = start - 6 * along
        end = end + 6 * along
    drawn.line(start, end, layer="DIM")
    drawn.arrow(start + 6 * along if outside else start, along if outside else -along)
    drawn.arrow(end - 6 * along if outside else end, -along if outside else along)
    digits = measure.digits
    if digits is None:
        digits = _FITTED if measure.fit else decimals(general(measure.value, tolerance))
    text = f"{measure.sign}{number(measure.value, digits)}{measure.behind}"
    label = Text(0j, text, measure.letters, "centre", reading, "DIM")
    middle = (start + end) / 2
    if (
        length < label.width + 7
    ):  # beside the arrows: to the left where there is room, or to the right, or above
        across = abs(along.real) > 0.5 and (start - (label.width + 2) * along).real > room.left
        tail, out = (start, -along) if across else (end, along)
        middle = tail + out * (label.width / 2 + 1)
        drawn.line(tail, tail + out * (label.width + 2), layer="DIM")
    foot = middle + 0.9j * reading
    drawn.things.append(replace(label, at=foot))
    sheet.things.append(
        Size(
            *ends,
            ends[1] + away,
            measure.value,
            measure.sign,
            tuple(drawn.primitives),
            digits,
            measure.behind,
            measure.factor,
        )
    )
    half = label.width / 2 * reading
    return foot - half, foot + half + 1j * measure.letters * reading


def _broken(
    start: complex, end: complex, texts: Sequence[Box]
) -> Iterator[tuple[complex, complex]]:
    """The pieces of an upright line, from its start on, that are in none of the texts."""
    down = -1 if end.imag < start.imag else 1
    for low, high in sorted(texts, key=lambda box: down * box[0].imag):
        inside = low.real - _AIR < start.real < high.real + _AIR
        first, last = sorted((low.imag - _AIR, high.imag + _AIR), key=lambda y: down * y)
        if inside and down * start.imag < down * first and down * last < down * end.imag:
            yield start, complex(start.real, first)
            start = complex(start.real, last)
    yield start, end
