"""Room on the cam of a swing machine: where its pins lie, what a washer between two cams leaves, and what makes more room.

near, far   least and greatest distance of the cam's edge from its shaft, mm
pins        two, each the mirror image of the other in Oy: a cam turned over about Oy lies on the same ones
washer      the band drawn tight round the shaft's hole and the pins'; it keeps inside both cams
hub         the frame's plate round the follower's axle, which the cam passes
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from camgen.errors import DesignError, Key
from camgen.geometry.distances import inside, point_to_ring, thinnest_wall
from camgen.geometry.facets import facet_contour
from camgen.geometry.outlines import Floats, Points
from camgen.parts.catalogue import DOWELS
from camgen.parts.disc_cams import LAYOUT
from camgen.parts.part import hull

if TYPE_CHECKING:
    from camgen.machines.uniform_swing.mechanism import UniformSwing

LEAST_AXLE = (
    3.0  # mm, diameter down to which an axle of less room is made: a thinner one breaks in print
)
_LEAST_SIZES = {
    "parts.bore": 4.0,
    "geometry.tip_radius": 2.0,
}  # mm, that are still proposed: NEMA 8's shaft; less wears
_TURNS = np.radians(
    [0, *(side * turn for turn in range(10, 90, 10) for side in (1, -1))]
)  # of the pins off Ox
# distances from the shaft that are tried, beyond the one that keeps the wall, and within it
_OUTWARDS = 40
_INWARDS = 10


def washer_wall(
    rim: Points, hole: float, pins: Sequence[complex], pin: float, keep: float
) -> float:
    """Widest wall of a washer round its holes that stays `keep` inside the rim, mm; below 0 where the holes themselves do not.

    rim: (n,) complex; hole: radius of the shaft's hole; pin: diameter of the pins'. Pins are each other's mirror images in Oy,
    so that the washer is as far from the turned cam's rim.
    """
    band = facet_contour(hull([(0j, hole), *((z, pin / 2) for z in pins)]), LAYOUT)
    return thinnest_wall(rim, [band]) - LAYOUT - keep


def place_pins(
    rim: Points,
    reach: float,
    pin: float,
    wall: float,
    least: float,
    sleeve: float,
    washer: tuple[float, float] | None,
) -> tuple[complex, float]:
    """Place of one pin (x > 0) and the wall that both keep: the first with the whole wall, or the one with the widest.

    They are tried on Ox first, then ever nearer to Oy; nearest to the shaft first. rim: (n,) complex; reach: of the shaft's
    hole; pin: diameter; wall, least: that is wanted and that must be; sleeve: radius about the shaft that pins leave free;
    washer: radius of its hole, and how far it stays inside the rim; None: no washer. A wall below `least`: there is no room.
    """
    first, lowest = (max(reach + w, sleeve) + pin / 2 for w in (wall, least))
    outwards = np.linspace(first, max(first, float(np.max(np.abs(rim)))), _OUTWARDS)
    radii = np.concatenate([outwards, np.linspace(first, lowest, _INWARDS)])
    places = (np.exp(1j * _TURNS)[:, None] * radii).ravel()

    def depth(z: Points) -> Floats:
        return np.asarray(np.where(inside(z, rim), 1.0, -1.0) * point_to_ring(z, rim))

    walls = np.minimum(depth(places), depth(-np.conj(places))) - pin / 2
    beside = np.abs(places) - pin / 2 - reach + 1e-9
    walls = np.minimum.reduce(
        [walls, beside, 2 * places.real - 2 * pin]
    )  # one pin's diameter and a wall between the two
    walls = np.minimum(walls, wall)
    best = int(np.argmax(walls))
    if washer is None or walls[best] < least:
        return complex(places[best]), float(walls[best])
    found = complex(places[best]), -math.inf
    for k in np.flatnonzero(walls >= least):
        z = complex(places[k])
        if walls[k] > found[1]:
            kept = min(
                float(walls[k]), washer_wall(rim, washer[0], (z, -z.conjugate()), pin, washer[1])
            )
            found = max(found, (z, kept), key=lambda each: each[1])
        if found[1] >= wall:
            break
    return found


# ---- what makes more room --------------------------------------------------------------------------------------------


def near_far(pivot: Any, offset: Any, swing: Any, tip: float) -> tuple[Floats, Floats]:
    """Least and greatest distance of the cam's edge from its shaft, mm: the law of cosines in shaft, pivot and tip.

    pivot, offset: mm; swing: peak to peak, rad; tip: its radius, mm; arrays of one shape, or numbers.
    """
    arm, lean = np.hypot(pivot, offset), np.arctan2(offset, pivot)
    inner, outer = (
        np.sqrt(
            np.maximum(pivot**2 + arm**2 - 2 * pivot * arm * np.cos(lean + side * swing / 2), 0.0)
        )
        for side in (-1, 1)
    )
    return np.where(lean > swing / 2, inner, 0.0) - tip, outer - tip


class Room:
    """Room that the geometry leaves to a machine; lengths mm, swing rad, peak to peak.

    reach: of the shaft's hole from the axis; plain: a collet clamps the shaft; pair: two cams, a washer between them.
    """

    def __init__(self, spec: UniformSwing) -> None:
        g, p = spec.geometry, spec.making
        self.pivot, self.offset, self.swing, self.tip = (
            g.pivot_distance,
            g.arm_offset,
            math.radians(g.swing_deg),
            g.tip_radius,
        )
        self.bore, self.reach, self.plain, self.pair = (
            p.bore,
            p.reach,
            p.shaft == "plain",
            g.closure == "conjugate",
        )
        self.slide, self.press, self.min_wall = (
            spec.print.slide_clearance,
            spec.print.press_clearance,
            spec.allowed.min_wall,
        )
        self.motor, self.frame, self.collet = spec.base.face.half, spec.frame, spec.collet

    @property
    def washer(self) -> tuple[float, float] | None:
        """Radius of the hole of the washer between two cams, and how far it has to stay inside them, mm; None for one cam.

        Where tips are pins in bosses of the frames, it has to pass the bosses.
        """
        seat = self.frame.seat(self.tip)
        beyond = self.frame.boss(seat, self.press, self.min_wall) - self.tip if seat else 0.0
        return ((self.bore + self.slide) / 2, self.slide + beyond) if self.pair else None

    @property
    def least_near(self) -> float:
        """Least distance of the cam's edge from its shaft that leaves walls to cam and washer, mm."""
        return max(self.reach, sum(self.washer or (0.0,))) + self.min_wall + 2 * LAYOUT

    def check(self) -> None:
        """Raise DesignError where the cam comes too near to its shaft, or to the pivot."""
        near, far = (
            float(each) for each in near_far(self.pivot, self.offset, self.swing, self.tip)
        )
        if far >= self.pivot:
            raise DesignError(
                "reach of the cam",
                far,
                self.pivot,
                "mm",
                "the follower's pivot, which it would sweep over",
                self.remedy(),
            )
        short = self.least_near - near
        if short > 0:
            smaller = {"parts.bore": self.bore - 2 * short}
            if self.frame.tip == "plate":
                smaller["geometry.tip_radius"] = self.tip - short
            said = [
                f"{key} = {math.floor(10 * size) / 10:g}"
                for key, size in smaller.items()
                if size >= _LEAST_SIZES[key]
            ]
            raise DesignError(
                "distance of the cam's edge from its shaft",
                near,
                self.least_near,
                "mm",
                f"its nearest side, for parts.bore = {self.bore:g} with walls",
                ", or ".join([self.remedy(), *said]),
            )

    def pins(self, rim: Points, pin: float, wall: float) -> tuple[complex, float]:
        """Place of one pin hole of the diameter `pin`, the other being its mirror image in Oy, and the wall that they keep, mm.

        The collet's wall gives way before the pins'. DesignError where they have no room.
        """
        least = self.min_wall + 2 * LAYOUT
        sleeves = self._sleeve(self.collet.wall), self._sleeve(min(self.collet.wall, least))
        tries = [
            place_pins(rim, self.reach, pin, wall, least, sleeve, self.washer) for sleeve in sleeves
        ]
        place, kept = next((found for found in tries if found[1] >= least), tries[-1])
        if not kept >= least:
            raise DesignError(
                "wall of the cam's pins",
                kept,
                least,
                "mm",
                f"the best place for parts.pin_diameter = {pin:g}",
                f"use a smaller one, or more cam: {self.remedy(2 * (least - kept))}",
            )
        return place, kept

    def _sleeve(self, wall: float) -> float:
        """Radius of the collet's sleeve where it is thickest, mm; 0 without a collet."""
        c = self.collet
        if not self.plain:
            return 0.0
        from camgen.parts.hardware import Collet

        return Collet(self.bore, self.slide, wall, c.length, c.flange, 0.0).radius

    def remedy(self, more: float = 0.0) -> str:
        """What of the geometry to change, key and value, for a cam that leaves room about shaft and pivot.

        One key is changed, the others stay. more: mm that the cam needs beyond its walls.
        """
        axle = min(self.frame.axle, LEAST_AXLE) + max(self.press, self.slide)
        hub = self.frame.gap + axle / 2 + self.min_wall + 5 * LAYOUT
        motor = self.motor + self.frame.axle_flange / 2

        def fits(pivot: Any, offset: Any, swing: Any) -> Any:
            near, far = near_far(pivot, offset, swing, self.tip)
            # the frame swings by half the swing to either side
            return (
                (near >= self.least_near + more)
                & (pivot * np.cos(swing / 2) - far >= hub)
                & (pivot >= motor)
            )

        step = 10.0 ** (math.floor(math.log10(self.pivot)) - 1) / 2
        lengths, degrees = step * np.arange(1, 400), np.arange(0.5, 180.0, 0.5)
        said = []
        for key, values, fine, now in (
            ("arm_offset", lengths, fits(self.pivot, lengths, self.swing), self.offset),
            ("pivot_distance", lengths, fits(lengths, self.offset, self.swing), self.pivot),
            (
                "swing_deg",
                degrees,
                fits(self.pivot, self.offset, np.radians(degrees)),
                math.degrees(self.swing),
            ),
        ):
            if fine.any():
                nearest = values[fine][np.argmin(np.abs(values[fine] - now))]
                said.append(f"geometry.{key} = {nearest:g}")
        return (
            f"there is room with {', or '.join(said)}"
            if said
            else "use other lengths, or a smaller geometry.swing_deg"
        )


# ---- what a spec may not say ----------------------------------------------------------------------------------------


def machine_checks(spec: UniformSwing) -> Sequence[tuple[bool, Key, float, str]]:
    """Checks between keys of the machine: (holds, path, value, what would be right)."""
    base, frame, tip_radius, pin = (
        spec.base,
        spec.frame,
        spec.geometry.tip_radius,
        spec.making.pin_diameter,
    )
    slide, press, min_wall, slit = (
        spec.print.slide_clearance,
        spec.print.press_clearance,
        spec.allowed.min_wall,
        spec.collet.slit,
    )
    joined = (
        spec.making.shaft == "plain" and spec.geometry.closure == "conjugate"
    )  # pins must join its cams
    cut, motor = spec.making, base.face
    same = (
        cut.shaft != "d-flat"
        or cut.bore != motor.shaft
        or not motor.flat
        or cut.flat_depth == motor.flat
    )
    rollers = (
        [d / 2 for d in DOWELS]
        if frame.tip == "pin"
        else [b.outside / 2 for b in (frame.bearing,) if b]
    )
    thin: dict[Key, float] = {
        ("parts", "pin_diameter"): pin or min_wall,
        ("frame", "arm"): frame.arm,
        ("frame", "axle"): frame.axle,
        ("frame", "flange_thickness"): frame.flange_thickness,
        ("collet", "flange"): spec.collet.flange,
    }
    return (
        *(
            (size >= min_wall, path, size, f"at least limits.min_wall, {min_wall:g} mm")
            for path, size in thin.items()
        ),
        (
            same,
            ("parts", "flat_depth"),
            cut.flat_depth,
            f'{motor.flat:g}, the flat of the shaft of base.motor = "{base.motor}", {motor.shaft - motor.flat:g} over its flat',
        ),
        (
            pin > 0 or not joined,
            ("parts", "pin_diameter"),
            pin,
            "more than 0: pins join the two cams on a plain shaft",
        ),
        (
            slit >= spec.print.nozzle,
            ("collet", "slit"),
            slit,
            f"at least the nozzle, {spec.print.nozzle:g} mm, or it closes in print",
        ),
        (
            frame.tip == "plate" or tip_radius in rollers,
            ("geometry", "tip_radius"),
            tip_radius,
            f'that of frame.tip = "{frame.tip}": {", ".join(f"{radius:g}" for radius in rollers)} mm',
        ),
        (
            slide > 0,
            ("print", "slide_clearance"),
            slide,
            "more than 0: the cams and frames of a machine turn past each other",
        ),
        (
            base.gap > slide,
            ("base", "gap"),
            base.gap,
            f"more than print.slide_clearance, {slide:g} mm",
        ),
        (
            press < pin or not pin,
            ("print", "press_clearance"),
            press,
            f"less than parts.pin_diameter, {pin:g} mm",
        ),
        (
            frame.axle_flange > frame.axle + slide,
            ("frame", "axle_flange"),
            frame.axle_flange,
            f"more than the axle and its clearance, {frame.axle + slide:g} mm",
        ),
        (
            base.motor != "flange" or base.screw_circle > base.boss,
            ("base", "screw_circle"),
            base.screw_circle,
            f"more than base.boss, {base.boss:g} mm",
        ),
    )
