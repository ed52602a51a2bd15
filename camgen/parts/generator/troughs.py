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
    width, base, found = layout.sizes.rail_width, layout.floor(layout.level[link]), list[Layer]()
    for runner, guide in layout.guides.items():
        if guide.joint.guide.body != link:
            continue
        level, cover = layout.level[runner], layout.cover if guide.covered else None
        low, top = floor, layout.top(level) - base
        if cover is not None:
            low, top = max(floor, layout.top(level - 1) - base), layout.floor(level + 1) - base
        for pair in guide.pairs:
            screws, core = ([], 0.0) if cover is None else (cover.places(pair, width), cover.core)
            found += [Layer(saddle(pair, width), floor, low)] if low > floor else []
            found += [Layer(drilled(rail, width, screws, core), low, top) for rail in pair]
    heights = sorted({round(z, 9) for layer in found for z in (layer.z0, layer.z1)})
    return [
        Layer(layer.region, low, high)
        for low, high in pairwise(heights)
        for layer in found
        if layer.z0 < (low + high) / 2 < layer.z1
    ]


def covers(layout: Layout) -> Iterator[tuple[Part, Mount]]:
    """What is screwed on the rails."""
    for runner, guide in layout.guides.items():
        if layout.cover is None or not guide.covered:
            continue
        for pair in guide.pairs:
            places, joint = layout.cover.places(pair, layout.sizes.rail_width), guide.joint
            part = layout.cover.part(places, cmath.exp(1j * joint.angle), layout.min_wall)
            yield (
                part,
                Mount(
                    "cover",
                    joint.guide.body,
                    sum(places) / len(places),
                    joint.angle,
                    z=layout.floor(layout.level[runner] + 1),
                ),
            )


def open_rails(layout: Layout) -> list[str]:
    """What to say of links whose rails are open above."""
    return [
        f"{link} slides between rails that are open above: what lies on its pins alone holds it down."
        for link, guide in layout.guides.items()
        if not guide.covered
    ]
