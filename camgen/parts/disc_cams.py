"""The bodies of disc cams: one cam, a pair, or the three plates of a groove cam; the bore that all of them share."""

from __future__ import annotations

import cmath
import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import Field, model_validator

from camgen.errors import DesignError, Fault
from camgen.geometry.distances import point_to_ring, thinnest_wall
from camgen.geometry.facets import facet_contour
from camgen.geometry.outlines import Contour, Points, Region, circle
from camgen.numerics import magnitude
from camgen.parts.catalogue import CORE_HOLES, SCREWS, Screw
from camgen.parts.keyways import RANGE, keyway
from camgen.parts.part import Layer, Part, Tap, d_bore, keyed_bore
from camgen.parts.set_screws import KeyScrew, SetScrewHub
from camgen.spec import Length, Record, quantity
from camgen.vocabulary import OldWords

Thickness = Annotated[float, quantity("mm", ge=0.1, le=1000)]
Bore = Annotated[Length, Field(description="diameter of the shaft's hole")]
BoreShape = Annotated[
    Literal["plain", "keyway", "d-flat"],
    Field(description='"plain", "keyway" (key_width, key_depth) or "d-flat" (flat_depth), on +y'),
]
KeyWidth = Annotated[
    Length, Field(description="width of the keyway; default: as in DIN 6885 for the bore")
]
KeyDepth = Annotated[
    Length,
    Field(
        description="height of the keyway's floor above the bore's circle; default: as in DIN 6885 for the bore"
    ),
]
FlatDepth = Annotated[Length, Field(description="depth of the flat below the bore's circle")]

LAYOUT = (
    0.01  # mm, facets on which holes are placed; every wall is judged again on the written files
)


# How else the shaft's hole is said: by the motor's shaft; and before, beside how a linkage's shaft is.
OLD_BORES: OldWords = {
    ("motor", "shaft_diameter"): ("parts", "bore"),
    **{
        ("parts", "shaft", shape): ("parts", "bore_shape", shape)
        for shape in ("plain", "keyway", "d-flat")
    },
}


# Places of a groove's pins about its axis, deg: its walls go on the back at one angle only, the outer one not turned over either.
_INNER_PINS = (0.0, 165.0)
_OUTER_PINS = (45.0, 135.0, 225.0, 305.0)
# In metal two dowels place each wall, and screws from below hold it: half way between, and where a turned ring misses them.
_OUTER_DOWELS = (45.0, 215.0)
_INNER_SCREWS = (82.5, 262.5)
_OUTER_SCREWS = (0.0, 85.0, 175.0, 265.0)


class ShaftBore(Record):
    """A cam's bore, and what keeps it from turning on its shaft."""

    bore: Bore = 8.0
    bore_shape: BoreShape = "plain"
    key_width: KeyWidth = 2.0
    key_depth: KeyDepth = 1.0
    flat_depth: FlatDepth = 0.5

    @model_validator(mode="before")
    @classmethod
    def _usual_keyway(cls, data: Any) -> Any:
        """The keyway that is usual in the bore, where there is one and nothing else is said."""
        if not isinstance(data, dict):
            return data
        shape = data.get("bore_shape", cls.model_fields["bore_shape"].default)
        bore = data.get("bore", cls.model_fields["bore"].default)
        usual = keyway(bore) if shape == "keyway" and isinstance(bore, int | float) else None
        return data if usual is None else {"key_width": usual[0], "key_depth": usual[1], **data}

    def misfits(self) -> list[Fault]:
        """Keys or flats that are no match for the bore."""
        limit = f"less than the bore, {self.bore:g} mm"
        faults = []
        if self.bore_shape == "d-flat" and self.flat_depth >= self.bore:
            faults.append(Fault(("parts", "flat_depth"), f"{self.flat_depth:g}", limit))
        if self.bore_shape == "keyway" and not {"key_width", "key_depth"} <= self.model_fields_set:
            other = (
                "for another one set parts.key_width and parts.key_depth, the depth t2 in the hub"
            )
            faults.append(Fault(("parts", "bore"), f"{self.bore:g} mm", f"{RANGE}; {other}"))
        elif self.bore_shape == "keyway" and self.key_width >= self.bore:
            faults.append(Fault(("parts", "key_width"), f"{self.key_width:g}", limit))
        return faults

    @property
    def reach(self) -> float:
        """How far the shaft hole reaches from the axis, mm."""
        keyed = self.bore_shape == "keyway"
        return (
            math.hypot(self.key_width / 2, self.bore / 2 + self.key_depth)
            if keyed
            else self.bore / 2
        )

    def hole(self) -> Contour:
        """The shaft hole; keyway or flat on Oy."""
        if self.bore_shape == "keyway":
            return keyed_bore(self.bore, self.key_width, self.key_depth)
        return (
            d_bore(self.bore, self.flat_depth)
            if self.bore_shape == "d-flat"
            else circle(0j, self.bore / 2)
        )

    def notes(self) -> tuple[str, ...]:
        """What the drawing says of the hole beside the numbers."""
        if self.bore_shape == "d-flat":
            return (f"hole A: bore {self.bore:g}, flat on +Y {self.flat_depth:g} below its top",)
        return ()


class ShaftHole(ShaftBore):
    """The same through a plate."""

    thickness: Thickness = Field(
        default=6.0,
        description="thickness of the cam without its hub; in a machine also of links and followers, 4 by default;\na metal disc cam is at "
        "least 0.6 times the bore thick, and as thick as its bought roller is wide (camgen's own rule)",
    )


class CamParts(ShaftHole):
    """The cam as a body; pins, rim and back belong to a groove."""

    hub_diameter: Length = Field(
        default=16.0,
        description="diameter of the hub on top of the cam; default in metal: 1.8 times the bore (camgen's own rule)",
    )
    hub_height: Annotated[float, quantity("mm", ge=0, le=1000, examples=[6.0])] = Field(
        default=0.0,
        description="height of the hub on top of the cam; 0: none, as for a groove;\ndefault for a metal cam with a keyway: the bore is as "
        "long as it is wide, and the hub as high as 2.4 diameters of its set screw (camgen's own rule)",
    )
    set_screw: Literal["none", "M2", "M2.5", "M3", "M4", "M5"] = Field(
        default="none",
        description='"none"; or "M2" to "M5": a set screw with its nut in the hub, on the flat if there is one;\nin a metal hub with a '
        "keyway: in a thread over the key, so that the cam cannot slide along the shaft;\nin a machine: in a collar on the "
        "motor's shaft",
    )
    pin_diameter: Length = Field(
        default=3.0,
        description="diameter of the pins that join the plates of a groove; in a machine of all pins, 5 by default;\nin metal: dowels, at "
        "least half as thick as the groove's walls (camgen's own rule)",
    )
    rim: Length = Field(
        default=8.0,
        description="least width of the rim round a groove; camgen rounds up the rim's diameter; in metal at least 2.5 pin diameters "
        "(camgen's own rule)",
    )
    back: Thickness = Field(
        default=3.0,
        description="thickness of a groove's back plate; default in metal: half the thickness of its walls (camgen's own rule)",
    )

    @property
    def plate_screw(self) -> Screw | None:
        """What holds the walls of a groove in metal on its back: at most as thick as its dowels."""
        thin = (each for each in SCREWS.values() if each.nominal <= self.pin_diameter)
        return max(thin, key=lambda each: each.nominal, default=None)

    def hub(self, min_wall: float) -> SetScrewHub | None:
        """The hub with its set screw and nut; None where it has none."""
        if self.set_screw == "none" or self.bore_shape == "keyway":
            return None
        flat = self.flat_depth if self.bore_shape == "d-flat" else 0.0
        return SetScrewHub(self.set_screw, self.bore, flat, min_wall, min_wall)

    @property
    def key_screw(self) -> KeyScrew | None:
        """The set screw on its key; None where it has none."""
        if self.set_screw == "none" or self.bore_shape != "keyway":
            return None
        return KeyScrew(self.set_screw, self.hub_diameter / 2 - self.bore / 2 - self.key_depth)

    @property
    def tap(self) -> Tap | None:
        """The thread of the set screw on the key, in the middle of the hub."""
        screw = self.key_screw
        if screw is None:
            return None
        height = self.thickness + self.hub_height / 2
        return Tap(screw.thread, height, self.bore / 2 + self.key_depth, self.hub_diameter / 2)

    def misfits(self) -> list[Fault]:
        """Keys that are no match for the bore, a hub that its set screw does not fit."""
        faults = super().misfits()
        hub = self.hub(0.8)
        screw = self.key_screw
        if screw is not None and self.hub_height < screw.least_height:
            expected = f"at least {screw.least_height:g} mm: the set screw sits in the hub"
            faults.append(Fault(("parts", "hub_height"), f"{self.hub_height:g}", expected))
        elif screw is not None and screw.wall < screw.least_wall:
            least = self.hub_diameter + 2 * (screw.least_wall - screw.wall)
            expected = f"at least {least:.4g} mm: the thread of the set screw over the key takes {screw.least_wall:g}"
            faults.append(Fault(("parts", "hub_diameter"), f"{self.hub_diameter:g}", expected))
        elif hub is not None and self.hub_height < hub.height:
            expected = f"at least {hub.height:.4g} mm: the nut of the set screw sits in the hub"
            faults.append(Fault(("parts", "hub_height"), f"{self.hub_height:g}", expected))
        return faults


def turning_note(sense: int) -> str:
    """What the drawing of a cam says of its turning; sense: -1 clockwise."""
    return f"drawn at cam angle 0, turns {'ccw' if sense > 0 else 'cw'}"


def roller_note(diameter: float) -> tuple[str, ...]:
    """What the drawing of a cam says of the roller on its edge, mm across; nothing of a knife edge or a flat face."""
    return (f"for a roller of Ø{diameter:g}",) if diameter else ()


def holes_in(
    shaft_hole: ShaftHole,
    name: str,
    outline: Contour,
    more: Callable[[Points, float], Sequence[Contour]],
    hub: float = 0.0,
) -> tuple[Contour, ...]:
    """A cam's holes: its bore, and more(facets of its outline, reach of the bore).

    DesignError where bore, hub (its diameter, mm) or the others find no room.
    """
    bore = shaft_hole.hole()
    reach = shaft_hole.reach
    rim = facet_contour(outline, LAYOUT)
    refuse_wide(name, float(np.min(point_to_ring(np.zeros(1, complex), rim))), reach, hub)
    holes = (bore, *more(rim, reach))
    thinnest = thinnest_wall(rim, [facet_contour(hole, LAYOUT) for hole in holes])
    if not thinnest > 0:
        raise DesignError(
            "wall",
            thinnest,
            0.0,
            "mm",
            ("the holes", f"the edge of {name}"),
            "holes meet or leave the cam: use a smaller bore, key or pin_diameter, or a larger base_radius",
        )
    return holes


def pins_beside(sizes: CamParts, min_wall: float) -> float:
    """Distance from the axis of the pins that hold a groove's inner cam, mm."""
    return sizes.reach + min_wall + sizes.pin_diameter


def refuse_wide(name: str, room: float, reach: float, hub: float = 0.0) -> None:
    """DesignError where the bore, by its reach, or the hub, by its diameter, leaves a cam; room: to the cam's side, mm.

    The bore is told first: a smaller hub alone would not mend it.
    """
    key, widest = ("parts.bore", reach) if reach >= room else ("parts.hub_diameter", hub / 2)
    if widest < room:
        return
    side = f"the nearest side of {name}"
    remedy = f"set a smaller {key}, or make base_radius more than {widest - room:.2g} mm larger"
    error = DesignError(key, 2 * widest, 2 * room, "mm", side, remedy)
    reaches = f"{key} reaches {widest:.4g} mm from the axis"
    raise error.saying(f"{reaches}; the edge of {name} is only {room:.4g} mm from it")


def disc_parts(
    sizes: CamParts,
    outlines: Sequence[Contour],
    wall: Contour | None,
    groove: tuple[float, float],
    min_wall: float,
    screw: Screw | None = None,
) -> tuple[Part, ...]:
    """Parts of these cam outlines; with a groove's outer wall: inner cam, outer ring and back plate.

    groove: its width and its roller's diameter, mm; screw: of its plates, in metal. DesignError where bore, hub or pins find no
    room.
    """
    if wall is not None:
        return _plates(sizes, (outlines[0], wall), groove, min_wall, screw)
    names = (
        [("cam", "Disc cam")]
        if len(outlines) == 1
        else [("cam-1", "Disc cam, outward"), ("cam-2", "Disc cam, back")]
    )
    return tuple(
        _cam(sizes, *name, outline, [], min_wall)
        for name, outline in zip(names, outlines, strict=True)
    )


def _cam(
    sizes: CamParts, name: str, title: str, outline: Contour, pins: list[Contour], min_wall: float
) -> Part:
    hub = sizes.hub_diameter if sizes.hub_height else 0.0
    holes = holes_in(sizes, name, outline, lambda rim, reach: pins, hub)
    layers = [Layer(Region(outline, holes), 0.0, sizes.thickness)]
    if sizes.hub_height:
        clamp = sizes.hub(min_wall)
        plain = Layer(
            Region(circle(0j, hub / 2), holes[:1]),
            sizes.thickness,
            sizes.thickness + sizes.hub_height,
        )
        layers += (
            [plain] if clamp is None else clamp.layers(hub / 2, sizes.thickness, sizes.hub_height)
        )
    centres = (0j, *(pin.centroid for pin in pins))
    made = Part(name, title, tuple(layers), 1, (), centres, sizes.notes(), sizes.bore, min_wall)
    return replace(made, tap=sizes.tap)


def _ring(distance: float, angles: Sequence[float], diameter: float) -> list[Contour]:
    """Holes of a diameter at a distance from the axis, mm, and at angles, deg."""
    return [circle(cmath.rect(distance, math.radians(angle)), diameter / 2) for angle in angles]


def _plates(
    sizes: CamParts,
    walls: tuple[Contour, Contour],
    groove: tuple[float, float],
    min_wall: float,
    screw: Screw | None,
) -> tuple[Part, ...]:
    """Inner cam and outer ring, pinned to a back plate, in metal screwed as well."""
    outline, wall = walls
    bore = sizes.hole()
    beside = pins_beside(sizes, min_wall)
    radius = magnitude(facet_contour(wall, LAYOUT)) + sizes.rim
    middle = radius - sizes.rim / 2
    inner = _ring(beside, _INNER_PINS, sizes.pin_diameter)
    outer = _ring(middle, _OUTER_DOWELS if screw else _OUTER_PINS, sizes.pin_diameter)
    back = [*inner, *outer]
    drilled: tuple[str, ...] = ()
    if screw:
        core = CORE_HOLES[screw.thread]
        inner += _ring(beside, _INNER_SCREWS, core)
        outer += _ring(middle, _OUTER_SCREWS, core)
        back += _ring(beside, _INNER_SCREWS, screw.clearance)
        back += _ring(middle, _OUTER_SCREWS, screw.clearance)
        drilled = (f"holes of Ø{screw.clearance:g} for screws {screw.thread}, heads below",)
    notes = (
        *sizes.notes(),
        f"with the inner wall a groove {groove[0]:g} wide, for a roller of {groove[1]:g}",
    )

    def plate(
        name: str, title: str, middle: Contour, holes: Sequence[Contour], height: float
    ) -> Part:
        layer = Layer(Region(circle(0j, radius), (middle, *holes)), 0.0, height)
        centres = (0j, *(hole.centroid for hole in holes))
        bored = middle is bore
        part_notes = (*sizes.notes(), *drilled) if bored else notes
        hole = sizes.bore if bored else None
        return Part(name, title, (layer,), 1, (), centres, part_notes, hole, min_wall)

    return (
        _cam(sizes, "inner", "Inner wall of the groove cam", outline, inner, min_wall),
        plate("outer", "Outer wall of the groove cam", wall, outer, sizes.thickness),
        plate("back", "Back plate of the groove cam", bore, back, sizes.back),
    )
