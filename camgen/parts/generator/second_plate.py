"""What the second plate holds, and where it lies."""

from __future__ import annotations

from camgen.parts.generator.connections import GROUND
from camgen.parts.generator.layout import Layout

SLEEVE = 1.5  # diameters of a shaft, how far a sleeve reaches on it at most


def in_first(layout: Layout, point: str) -> bool:
    """Whether the plate under level 1 holds what stands on the ground at a point, or a stub of it."""
    return layout.split_level(point) != 0 or point in layout.shafts


def far_hole(layout: Layout, point: str) -> float:
    """Diameter of the second plate's hole at a point, mm: shafts turn in it, pins are pressed in."""
    fits = layout.fits
    fit = fits.running_clearance if point in layout.shafts else fits.press_clearance
    return layout.turning(point) + fit


def channels_in(layout: Layout, second: bool) -> dict[str, tuple[complex, complex]]:
    """Both ends of a pin's way in each slot of the second plate, or of the plate under level 1, by the pin's point."""
    return {
        point: ends
        for point, ends in layout.slots_of(GROUND).items()
        if layout.in_second(point) == second
    }


def ceiling_height(layout: Layout) -> float:
    """Height of the underside of the second plate, a play over the highest thing, mm."""
    assert layout.second is not None, "asked for with two plates alone"
    play = layout.fits.slide_clearance
    most = max(layout.level.values())
    step = max(layout.least_thickness, layout.sizes.head, layout.sizes.thickness) + play
    return round(layout.top(most) + play + max(0, layout.second.highest - most) * step, 9)


def sleeve_ends(layout: Layout) -> tuple[float, float]:
    """Where a sleeve on the shaft that drives begins, over the second plate, and where that shaft ends in it, mm."""
    low = ceiling_height(layout) + layout.sizes.base_thickness + layout.fits.slide_clearance
    return low, low + SLEEVE * layout.sizes.shaft_diameter
