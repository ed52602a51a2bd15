"""What stands on the ground at a point: one pin or shaft, from one plate to the other, or a stub on either plate."""

from __future__ import annotations

from dataclasses import dataclass, replace

from camgen.parts.generator.layout import Layout
from camgen.parts.generator.second_plate import ceiling_height


@dataclass(frozen=True)
class Stub:
    """A pin or shaft, or a piece of one."""

    grips: list[tuple[float, float]]  # mm, sides of what sits on it, plates included, from below
    far: bool = False  # whether the second plate holds it
    hangs: bool = False  # whether that alone holds it

    @property
    def through(self) -> bool:
        """Whether both plates hold it."""
        return self.far and not self.hangs


def stubs(layout: Layout, point: str) -> list[Stub]:
    """Stubs of a point, from below."""
    levels = layout.on(point)
    held = [(low, top) for _, low, top in levels]
    if layout.second is None or not layout.between_plates(point):
        return [_inside(layout, point, Stub(held))]
    end = (ceiling_height(layout), ceiling_height(layout) + layout.sizes.base_thickness)
    at = layout.split_level(point)
    if at is None:
        return [Stub([*held, end], far=True)]
    low = [each for each, (level, *_) in zip(held, levels, strict=True) if level <= at]
    high = held[len(low) :]
    pieces = [Stub(low)] if len(low) > 1 else []  # more than the plate
    pieces += [Stub([*high, end], far=True, hangs=True)] if high else []
    return [_inside(layout, point, stub) for stub in pieces]


def _inside(layout: Layout, point: str, stub: Stub) -> Stub:
    """A pin that runs in a slot of a plate ends a play inside it, so that it rubs on nothing behind; any other stub is itself."""
    if point not in layout.channels:
        return stub
    play = layout.fits.slide_clearance
    low, *between, high = stub.grips
    if stub.hangs:
        high = high[0], high[1] - play
    else:
        low = low[0] + play, low[1]
    return replace(stub, grips=[low, *between, high])


def in_upper(layout: Layout, point: str, link: str) -> bool:
    """Whether the pin of a point of the ground, where a link turns on it, is held by the second plate more than by the other."""
    if layout.second is None or not layout.between_plates(point) or point in layout.shafts:
        return False
    level = layout.level[link]
    cut = layout.split_level(point)
    if cut is not None:
        return level > cut
    return 2 * layout.floor(level) > ceiling_height(layout) + layout.sizes.base_thickness
