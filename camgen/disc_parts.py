"""The bodies of a disc cam: one cam, a pair, or the three plates of a groove cam."""

from __future__ import annotations

import cmath
import math
from collections.abc import Sequence
from typing import Annotated, Literal

import numpy as np
from pydantic import Field

from camgen.distances import point_to_ring, thinnest_wall
from camgen.errors import DesignError
from camgen.outlines import Contour, Region, circle
from camgen.parts import Layer, Part, d_bore, keyed_bore
from camgen.sampling import facet_contour
from camgen.spec import Length, Record

_LAYOUT = 0.01  # mm, facets on which holes are placed; every wall is judged again on the written files


class Parts(Record):
    """The cam as a body; pins, rim and back belong to a groove."""

    thickness: Length = 6.0
    bore: Length = 8.0
    shaft: Literal["plain", "keyway", "d-flat"] = "plain"
    key_width: Length = 2.0
    key_depth: Length = 1.0
    flat_depth: Length = 0.5
    hub_diameter: Length = 16.0
    hub_height: Annotated[float, Field(ge=0, le=1e6)] = 0.0
    pin_diameter: Length = 3.0
    rim: Length = 8.0
    back: Length = 3.0

    def hole(self) -> tuple[Contour, float]:
        """The shaft hole and how far it reaches from the axis, mm; keyway or flat on Oy."""
        if self.shaft == "keyway":
            reach = math.hypot(self.key_width / 2, self.bore / 2 + self.key_depth)
            return keyed_bore(self.bore, self.key_width, self.key_depth), reach
        if self.shaft == "d-flat":
            return d_bore(self.bore, self.flat_depth), self.bore / 2
        return circle(0j, self.bore / 2), self.bore / 2

    def notes(self) -> tuple[str, ...]:
        """What the drawing says beside the numbers."""
        notes = ["drawn at cam angle 0, turns counter-clockwise"]
        if self.shaft == "keyway":
            notes.append(
                f"hole A: bore {self.bore:g}, keyway on +Y {self.key_width:g} wide, its floor {self.key_depth:g} above the bore"
            )
        elif self.shaft == "d-flat":
            notes.append(f"hole A: bore {self.bore:g}, flat on +Y {self.flat_depth:g} below its top")
        return tuple(notes)


def disc_parts(made: Parts, outlines: Sequence[Contour], wall: Contour | None, min_wall: float) -> tuple[Part, ...]:
    """Parts of these cam outlines; with a groove's outer wall: inner cam, outer ring and back plate.

    DesignError where bore, hub or pins find no room.
    """
    if wall is not None:
        return _plates(made, outlines[0], wall, min_wall)
    names = [("cam", "Disc cam")] if len(outlines) == 1 else [("cam-1", "Disc cam, outward"), ("cam-2", "Disc cam, back")]
    return tuple(_cam(made, *name, outline, [], min_wall) for name, outline in zip(names, outlines, strict=True))


def _cam(made: Parts, name: str, title: str, outline: Contour, pins: list[Contour], min_wall: float) -> Part:
    bore, reach = made.hole()
    rim = facet_contour(outline, _LAYOUT)
    room = float(np.min(point_to_ring(np.zeros(1, complex), rim)))
    widest = max(reach, made.hub_diameter / 2 if made.hub_height else 0.0)
    if widest >= room:
        raise DesignError(
            "parts.hub_diameter" if widest > reach else "parts.bore", 2 * widest, 2 * room, "mm", "the cam's nearest side",
            "it leaves the cam: use a smaller one or a larger base_radius",
        )  # fmt: skip
    thinnest = thinnest_wall(rim, [facet_contour(hole, _LAYOUT) for hole in (bore, *pins)])
    if not thinnest > 0:
        raise DesignError(
            "wall", thinnest, min_wall, "mm", "between the cam's holes and its edge",
            "holes meet or leave the cam: use a smaller bore, key or pin_diameter, or a larger base_radius",
        )  # fmt: skip
    layers = [Layer(Region(outline, (bore, *pins)), 0.0, made.thickness)]
    if made.hub_height:
        hub = Region(circle(0j, made.hub_diameter / 2), (bore,))
        layers.append(Layer(hub, made.thickness, made.thickness + made.hub_height))
    centres = (0j, *(pin.centroid for pin in pins))
    return Part(name, title, tuple(layers), 1, (), centres, made.notes(), made.bore, min_wall)


def _plates(made: Parts, outline: Contour, wall: Contour, min_wall: float) -> tuple[Part, ...]:
    """Inner cam and outer ring, pinned to a back plate."""
    bore, reach = made.hole()
    radius = float(np.max(np.abs(facet_contour(wall, _LAYOUT)))) + made.rim
    beside = reach + min_wall + made.pin_diameter
    inner = [circle(complex(side * beside), made.pin_diameter / 2) for side in (1, -1)]
    corners = [cmath.rect(radius - made.rim / 2, math.radians(45 + 90 * k)) for k in range(4)]
    outer = [circle(corner, made.pin_diameter / 2) for corner in corners]

    def plate(name: str, title: str, holes: Sequence[Contour], height: float, bore: float | None) -> Part:
        layer = Layer(Region(circle(0j, radius), tuple(holes)), 0.0, height)
        pins = [pin.centroid for pin in (*inner, *outer) if pin in holes]
        return Part(name, title, (layer,), 1, (), (0j, *pins), made.notes(), bore, min_wall)

    return (
        _cam(made, "inner", "Groove cam, inner wall", outline, inner, min_wall),
        plate("outer", "Groove cam, outer wall", (wall, *outer), made.thickness, None),
        plate("back", "Groove cam, back plate", (bore, *inner, *outer), made.back, made.bore),
    )
