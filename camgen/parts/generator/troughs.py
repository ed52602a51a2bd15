"""Rails as they stand on a plate or link, on saddles where their runner lies high, and the covers that are screwed on them."""

from __future__ import annotations

import cmath
from collections.abc import Iterator
from itertools import pairwise

from camgen.machine.features import Mount
from camgen.parts.generator.covers import drilled, saddle
from camgen.parts.generator.layout import Layout
from camgen.parts.part import Layer, Part


def rails(layout: Layout, link: str, floor: float) -> list[Layer]:
    """Rails and saddles on a link or the ground's plate, from a height of it, mm; in steps, as some are higher than others."""
    width = layout.sizes.rail_width
    base = layout.floor(layout.level[link])
    layers: list[Layer] = []
    for runner, guide in layout.guides.items():
        if guide.joint.guide.body != link:
            continue
        level = layout.level[runner]
        cover = layout.cover if guide.covered else None
        low = floor
        top = layout.top(level) - base
        if cover is not None:
            low = max(floor, layout.top(level - 1) - base)
            top = layout.floor(level + 1) - base
        for pair in guide.pairs:
            screws, core = ([], 0.0) if cover is None else (cover.places(pair, width), cover.core)
            if low > floor:
                layers.append(Layer(saddle(pair, width), floor, low))
            layers += [Layer(drilled(rail, width, screws, core), low, top) for rail in pair]
    heights = sorted({round(z, 9) for layer in layers for z in (layer.z0, layer.z1)})
    return [
        Layer(layer.region, low, high)
        for low, high in pairwise(heights)
        for layer in layers
        if layer.z0 < (low + high) / 2 < layer.z1
    ]


def covers(layout: Layout) -> Iterator[tuple[Part, Mount]]:
    """What is screwed on the rails."""
    for runner, guide in layout.guides.items():
        if layout.cover is None or not guide.covered:
            continue
        for pair in guide.pairs:
            places = layout.cover.places(pair, layout.sizes.rail_width)
            joint = guide.joint
            part = layout.cover.part(places, cmath.exp(1j * joint.angle), layout.min_wall)
            middle = sum(places) / len(places)
            z = layout.floor(layout.level[runner] + 1)
            yield part, Mount("cover", joint.guide.body, middle, joint.angle, z=z)


def open_rails(layout: Layout) -> list[str]:
    """What to say of links whose rails are open above."""
    return [
        f"{link} slides between rails that are open above: only the parts on its pins hold it down."
        for link, guide in layout.guides.items()
        if not guide.covered
    ]
