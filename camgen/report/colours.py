"""Colours of the report: as many as there are parts, each in a light and a dark dress.

A part's hue is the last one's turned by the golden angle, its lightness goes through three steps: of a hundred parts no two
look alike, and neighbours in the list differ most. In OKLCH, where equal steps look equal [B. Ottosson 2020].
"""

from __future__ import annotations

import math

_GOLDEN = math.pi * (3 - math.sqrt(5))
_FIRST = math.radians(250)  # blue
_LIGHT = (0.53, 0.43, 0.62)
_DARK = (0.74, 0.66, 0.83)


def part_colour(k: int, dark: bool = False) -> str:
    """Colour of the k-th part as #rrggbb, for a dark page where asked."""
    hue = _FIRST + k * _GOLDEN
    lightness = (_DARK if dark else _LIGHT)[k % 3]
    chroma = 0.13
    while (rgb := _rgb(lightness, chroma, hue)) is None:
        chroma -= 0.005
    return "#" + "".join(f"{round(255 * value):02x}" for value in rgb)


def _rgb(lightness: float, chroma: float, hue: float) -> tuple[float, float, float] | None:
    """sRGB, 0..1 each, of a colour in OKLCH; None where no screen shows it."""
    a = chroma * math.cos(hue)
    b = chroma * math.sin(hue)
    long, medium, short = (
        (lightness + x * a + y * b) ** 3
        for x, y in (
            (0.3963377774, 0.2158037573),
            (-0.1055613458, -0.0638541728),
            (-0.0894841775, -1.2914855480),
        )
    )
    linear = (
        4.0767416621 * long - 3.3077115913 * medium + 0.2309699292 * short,
        -1.2684380046 * long + 2.6097574011 * medium - 0.3413193965 * short,
        -0.0041960863 * long - 0.7034186147 * medium + 1.7076147010 * short,
    )
    if not all(0 <= value <= 1 for value in linear):
        return None
    red, green, blue = (
        12.92 * v if v <= 0.0031308 else 1.055 * v ** (1 / 2.4) - 0.055 for v in linear
    )
    return red, green, blue
