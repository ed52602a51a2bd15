"""Seats of ball bearings in links that move: pressed in from above, down on a lip under the outer ring.

lip     a smaller hole under the seat, clear of the inner ring
seat    deeper than its bearing by a play: what lies on the link, beside the seat, touches neither ring
"""

from __future__ import annotations

from collections.abc import Mapping

from camgen.geometry.outlines import Contour, circle
from camgen.parts.catalogue import Bearing
from camgen.parts.generator.connections import GROUND
from camgen.parts.generator.layout import Layout
from camgen.parts.generator.link_outlines import link_outline
from camgen.parts.hardware import plate
from camgen.parts.part import Layer


def least_thickness(layout: Layout, bearing: Bearing) -> float:
    """Of a link with such a bearing: it, its play and its lip, mm."""
    return round(bearing.width + layout.fits.slide_clearance + lip(layout), 9)


def lip(layout: Layout) -> float:
    """Least height of a lip, mm."""
    return max(layout.min_wall, layout.fits.nozzle)


def _under(layout: Layout, bearing: Bearing) -> float:
    """Bore of a lip under a bearing, mm."""
    return bearing.machined_lip if layout.metal else bearing.lip


def seat_floor(layout: Layout, point: str, link: str) -> float:
    """Height of a bearing's lower side over that of its link, mm; 0 in the ground's plate, which its seat goes through."""
    bearing = layout.bearing_in(point, link)
    if bearing is None or link == GROUND or link in layout.freewheels:
        return 0.0
    return round(layout.thickness(link) - layout.fits.slide_clearance - bearing.width, 9)


def link_layers(
    layout: Layout, link: str, holes: Mapping[str, Contour]
) -> tuple[list[Layer], list[str]]:
    """Layers of a link with its holes, their seats and the lips under them, the seats' last; what its drawing says of them.

    All bearings of a link that moves are alike, for its pins are.
    """
    outline = link_outline(layout, link)
    thick = layout.thickness(link)
    points = layout.points_of(link)
    region = plate(f"link {link}", outline, holes, layout.min_wall)
    bearings = {point: layout.bearing_in(point, link) for point in points if point in layout.pivots}
    seats = {point: bearing for point, bearing in bearings.items() if bearing is not None}
    if not seats:
        return [Layer(region, 0.0, thick)], []
    lips = {
        f"hole {point}": circle(points[point], _under(layout, bearing) / 2)
        for point, bearing in seats.items()
    }
    floor = seat_floor(layout, next(iter(seats)), link)
    under = plate(f"link {link}", outline, {**holes, **lips}, layout.min_wall)
    names = ", ".join(f"{bearing.shielded} at {point}" for point, bearing in seats.items())
    notes = [f"pressed in from above, down on the lip: {names}"]
    if not layout.metal:  # else the sheet shows a seat with its sizes
        notes.append(f"seats {thick - floor:.4g} deep, lips under them {floor:.4g}")
    return [Layer(under, 0.0, floor), Layer(region, floor, thick)], notes
