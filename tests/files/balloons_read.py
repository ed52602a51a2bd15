"""What tests of arrangement drawings read of a sheet."""

from __future__ import annotations

from collections.abc import Iterator

from camgen.files.sheet import Sheet, Stroke, Text
from camgen.geometry.outlines import Arc

_RADIUS = 4.0  # of a balloon, mm of paper


def balloons_on(sheet: Sheet) -> Iterator[tuple[int, complex, complex]]:
    """Number, middle and dot of each balloon: a circle, its text, its line, its dot, one after the other."""
    things = list(sheet.primitives)
    for k, each in enumerate(things):
        piece = each.pieces[0] if isinstance(each, Stroke) else None
        if isinstance(piece, Arc) and piece.radius == _RADIUS:
            text, dot = things[k + 1], things[k + 3]
            assert isinstance(text, Text) and isinstance(dot, Stroke)
            assert isinstance(dot.pieces[0], Arc)
            yield int(text.text), piece.centre, dot.pieces[0].centre
