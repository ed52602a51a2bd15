"""Dowels that hold wheels, rings and discs on links, and the pins of cycloidal drives."""

from __future__ import annotations

import cmath

from camgen.geometry.outlines import Contour, circle
from camgen.parts.generator.connections import GROUND
from camgen.parts.generator.cycloids import Stud
from camgen.parts.generator.gears import DowelledWheel
from camgen.parts.generator.genevas import DowelledEdge
from camgen.parts.generator.layout import Layout


def studs_of(layout: Layout, link: str) -> list[Stud]:
    """Pins of cycloidal drives that are pressed into a link."""
    studs = [stud for drive in layout.cycloid_drives for stud in drive.studs]
    return [stud for stud in studs if stud.link == link]


def stud_hole(layout: Layout, stud: Stud) -> float:
    """Diameter of the hole into which a pin of a cycloidal drive is pressed, mm."""
    return 2 * stud.radius + layout.fits.press_clearance


def stud_holes(layout: Layout, link: str) -> dict[str, Contour]:
    """Holes of a link for the pins of cycloidal drives."""
    return {
        f"{stud.part} {k}": circle(stud.at, stud_hole(layout, stud) / 2)
        for k, stud in enumerate(studs_of(layout, link), 1)
    }


def stud_span(layout: Layout, stud: Stud) -> tuple[float, float]:
    """Underside and upper side of a pin of a cycloidal drive, mm: through its link and over the whole thickness of its discs."""
    low = min(layout.floor(layout.level[disc]) for disc in stud.discs)
    high = max(map(layout.top_of, stud.discs))
    own = 0.0 if stud.link == GROUND else layout.floor(layout.level[stud.link])
    return min(low, own), max(high, round(own + layout.thickness(stud.link), 9))


def stud_hubs(layout: Layout, link: str) -> list[tuple[complex, float]]:
    """Hubs round the pins of cycloidal drives: place in the link's axes and radius."""
    return [(stud.at, stud_hole(layout, stud) / 2 + layout.rim) for stud in studs_of(layout, link)]


def dowel_hubs(layout: Layout, link: str) -> list[tuple[complex, float]]:
    """Hubs round the dowels on a link: place in its axes and radius."""
    radius = (layout.sizes.pin_diameter + layout.fits.press_clearance) / 2 + layout.rim
    every = (*layout.dowelled, *layout.pinned)
    held = (each for each in every if each.wheel.link == link)
    return [(z, radius) for each in held for z in dowel_places(layout, each)]


def dowel_places(layout: Layout, dowelled: DowelledWheel | DowelledEdge) -> list[complex]:
    """Places of the dowels of what they hold, in its link's axes, mm."""
    link = dowelled.wheel.link
    turn = cmath.exp(-1j * layout.machine.start_of(link).angle)
    at = layout.at(link, layout.axis_of_wheel(dowelled.wheel))
    return [at + turn * z for z in dowelled.dowels]


def dowel_holes(layout: Layout, link: str) -> dict[str, Contour]:
    """Holes of a link for the dowels of what they hold on it."""
    radius = (layout.sizes.pin_diameter + layout.fits.press_clearance) / 2
    seats = enumerate(dowel_hubs(layout, link), 1)
    return {f"dowel {k}": circle(z, radius) for k, (z, _) in seats}


def dowelled_span(layout: Layout, ring: DowelledWheel | DowelledEdge) -> tuple[float, float]:
    """Underside and thickness of what dowels hold, mm: up to its link, or down to it; of sheet a level's."""
    level = layout.level[ring.wheel.level]
    link = ring.wheel.link
    low = layout.floor(level)
    if layout.sizes.of_sheet:
        return low, layout.sizes.thickness
    if ring.lies == "over":
        low = layout.sizes.base_thickness if link == GROUND else layout.top_of(link)
        return low, round(layout.floor(level) + layout.sizes.thickness - low, 9)
    return low, round(layout.floor(layout.level[link]) - low, 9)


def dowel_span(layout: Layout, ring: DowelledWheel | DowelledEdge) -> tuple[float, float]:
    """Underside and upper side of its dowels, mm: through it and its link."""
    link = ring.wheel.link
    low, thick = dowelled_span(layout, ring)
    if ring.lies != "over":
        return low, layout.top_of(link)
    bottom = 0.0 if link == GROUND else layout.floor(layout.level[link])
    return bottom, low + thick


def disc_dowels(layout: Layout, point: str) -> list[tuple[complex, float]]:
    """Holes of the plate for the dowels of a disc of the ground, centre and radius, mm: across the way to its shaft."""
    at = layout.at(GROUND, point)
    shaft = layout.at(GROUND, layout.discs[point][1])
    radius = (layout.sizes.pin_diameter + layout.fits.press_clearance) / 2
    way = 1j * (at - shaft) / abs(at - shaft) * (layout.turning(point) / 2 - layout.rim - radius)
    return [(at + way, radius), (at - way, radius)]
