"""Small pictures of linkages in one position: links, pins, the path that is traced and the one that was wanted."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from html import escape
from itertools import combinations

import numpy as np

from camgen.numerics import Points

_SIDE = 180.0  # of a picture, px
_EDGE = 12.0  # round it


@dataclass(frozen=True)
class Sketch:
    """points: places by name, complex mm; links: names of the points of each; still: points at rest; path, wanted: complex mm.

    joined: whether a line joins the places of the wanted path in their order.
    """

    points: Mapping[str, complex]
    links: Sequence[Sequence[str]]
    still: Collection[str]
    path: Points
    wanted: Points
    joined: bool = True


def picture(drawn: Sketch, said: str) -> str:
    """The sketch as SVG; its size follows what is drawn."""
    every = np.concatenate([list(drawn.points.values()), drawn.path, drawn.wanted])
    low = complex(every.real.min(), every.imag.min())
    high = complex(every.real.max(), every.imag.max())
    scale = (_SIDE - 2 * _EDGE) / max((high - low).real, (high - low).imag, 1e-9)
    height = (high - low).imag * scale + 2 * _EDGE

    def at(z: complex) -> tuple[float, float]:
        return round((z - low).real * scale + _EDGE, 1), round(
            height - _EDGE - (z - low).imag * scale, 1
        )

    def line(kind: str, places: Sequence[complex]) -> str:
        shown = " ".join(f"{x:g},{y:g}" for x, y in map(at, places))
        return f'<polyline class="{kind}" points="{shown}"/>' if len(places) > 1 else ""

    def dots(kind: str, places: Sequence[complex]) -> str:
        shown = "".join(f"M{x:g} {y:g}h0" for x, y in map(at, places))
        return f'<path class="{kind}" d="{shown}"/>' if places else ""

    wanted = (line if drawn.joined else dots)("wanted", drawn.wanted.tolist())
    parts = [wanted, line("path", drawn.path.tolist())]
    for link in drawn.links:
        parts += [
            line("link", [drawn.points[a], drawn.points[b]]) for a, b in combinations(link, 2)
        ]
    for name, place in drawn.points.items():
        x, y = at(place)
        parts.append(
            f'<circle class="{"still" if name in drawn.still else "pin"}" cx="{x:g}" cy="{y:g}" r="3"/>'
        )
    inside = "".join(parts)
    return f'<svg viewBox="0 0 {_SIDE:g} {height:.4g}" role="img" aria-label="{escape(said)}">{inside}</svg>'


@dataclass(frozen=True)
class Gallery:
    """Pictures under one title."""

    title: str
    pictures: Sequence[tuple[str, str]]  # SVG, and what is said of each

    def html(self) -> str:
        """As HTML; empty without pictures."""
        figures = "".join(
            f"<figure>{svg}<figcaption>{escape(said)}</figcaption></figure>"
            for svg, said in self.pictures
        )
        return (
            f'<h2>{escape(self.title)}</h2>\n<div class="gallery">{figures}</div>'
            if figures
            else ""
        )
