"""Room on the cam of a swing machine: where its pins lie, what a washer between two cams leaves, and what makes more room.

near, far   least and greatest distance of the cam's edge from its shaft, mm
pins        two, each the mirror image of the other in Oy: a cam turned over about Oy lies on the same ones
washer      the band drawn tight round the shaft's hole and the pins'; it keeps inside both cams
hub         the frame's plate round the follower's axle, which the cam passes
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from camgen.errors import DesignError, Fault
from camgen.geometry.distances import inside, point_to_ring, thinnest_wall
from camgen.geometry.facets import facet_contour
from camgen.geometry.outlines import Floats, Points
from camgen.machines.uniform_swing.tables import SwingSizes
from camgen.numerics import magnitude
from camgen.parts.catalogue import DOWELS
from camgen.parts.disc_cams import LAYOUT
from camgen.parts.hardware import Collet
from camgen.parts.part import hull

# mm, diameter down to which an axle of less room is made: a thinner one breaks in print
LEAST_AXLE = 3.0
# mm, that are still proposed: NEMA 8's shaft; less wears
_LEAST_SIZES = {"parts.bore": 4.0, "geometry.tip_radius": 2.0}
# of the pins off Ox
_TURNS = np.radians([0, *(side * turn for turn in range(10, 90, 10) for side in (1, -1))])
# distances from the shaft that are tried, beyond the one that keeps the wall, and within it
_OUTWARDS = 40
_INWARDS = 10


# ---- pins ------------------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Washer:
    """What lies between two cams, mm; pins are each other's mirror images in Oy, so that it is as far from either rim."""

    hole: float  # radius of the shaft's hole
    inset: float  # how far it stays inside the rim

    def wall(self, rim: Points, pins: tuple[complex, ...], pin: float) -> float:
        """Its widest wall round its holes, mm; below 0 where the holes themselves leave the rim.

        rim: (n,) complex; pin: diameter of the pins'.
        """
        band = hull([(0j, self.hole), *((z, pin / 2) for z in pins)])
        return thinnest_wall(rim, [facet_contour(band, LAYOUT)]) - LAYOUT - self.inset


@dataclass(frozen=True)
class Pins:
    """What two pins of a cam are to keep, mm."""

    diameter: float
    reach: float  # of the shaft's hole, from its axis
    wall: float  # that is wanted
    least: float  # that must be
    sleeve: float = 0.0  # radius about the shaft that they leave free
    washer: Washer | None = None

    def placed(self, rim: Points) -> tuple[complex, float]:
        """Place of the one at x > 0 and the wall that both keep: the first with the whole wall, or the one with the widest.

        They are tried on Ox first, then ever nearer to Oy; nearest to the shaft first. rim: (n,) complex. A wall below
        `least`: there is no room.
        """
        radius = self.diameter / 2
        first, lowest = (
            max(self.reach + wall, self.sleeve) + radius for wall in (self.wall, self.least)
        )
        outwards = np.linspace(first, max(first, magnitude(rim)), _OUTWARDS)
        radii = np.concatenate([outwards, np.linspace(first, lowest, _INWARDS)])
        places = (np.exp(1j * _TURNS)[:, None] * radii).ravel()

        def depth(z: Points) -> Floats:
            return np.asarray(np.where(inside(z, rim), 1.0, -1.0) * point_to_ring(z, rim))

        edge = np.minimum(depth(places), depth(-np.conj(places))) - radius
        bore = np.abs(places) - radius - self.reach + 1e-9
        other = 2 * places.real - 2 * self.diameter  # a pin's diameter and a wall between the two
        walls = np.minimum.reduce([edge, bore, other, np.full(len(places), self.wall)])
        best = int(np.argmax(walls))
        if self.washer is None or walls[best] < self.least:
            return complex(places[best]), float(walls[best])
        widest = complex(places[best]), -math.inf
        for k in np.flatnonzero(walls >= self.least):
            z = complex(places[k])
            wall = float(walls[k])
            if wall > widest[1]:
                kept = min(wall, self.washer.wall(rim, (z, -z.conjugate()), self.diameter))
                widest = max(widest, (z, kept), key=lambda each: each[1])
            if widest[1] >= self.wall:
                break
        return widest


# ---- what makes more room --------------------------------------------------------------------------------------------


def near_far(pivot: Any, offset: Any, swing: Any, tip: float) -> tuple[Floats, Floats]:
    """Least and greatest distance of the cam's edge from its shaft, mm: the law of cosines in shaft, pivot and tip.

    pivot, offset: mm; swing: peak to peak, rad; tip: its radius, mm; arrays of one shape, or numbers.
    """
    arm = np.hypot(pivot, offset)
    lean = np.arctan2(offset, pivot)
    inner, outer = (
        np.sqrt(
            np.maximum(pivot**2 + arm**2 - 2 * pivot * arm * np.cos(lean + side * swing / 2), 0.0)
        )
        for side in (-1, 1)
    )
    return np.where(lean > swing / 2, inner, 0.0) - tip, outer - tip


@dataclass(frozen=True)
class Room:
    """Room that the geometry leaves to a machine."""

    sizes: SwingSizes

    @property
    def swing(self) -> float:
        """Peak to peak, rad."""
        return math.radians(self.sizes.geometry.swing_deg)

    @property
    def washer(self) -> Washer | None:
        """Of a pair; where tips are pins in bosses of the frames, it has to pass the bosses."""
        s = self.sizes
        slide = s.fits.slide_clearance
        beyond = s.boss - s.geometry.tip_radius
        return Washer((s.making.bore + slide) / 2, slide + beyond) if s.pair else None

    @property
    def least_near(self) -> float:
        """Least distance of the cam's edge from its shaft that leaves walls to cam and washer, mm."""
        washer = self.washer
        held = washer.hole + washer.inset if washer else 0.0
        return max(self.sizes.making.reach, held) + self.sizes.min_wall + 2 * LAYOUT

    def check(self) -> None:
        """Raise DesignError where the cam comes too near to its shaft, or to the pivot."""
        g = self.sizes.geometry
        bore = self.sizes.making.bore
        near, far = map(float, near_far(g.pivot_distance, g.arm_offset, self.swing, g.tip_radius))
        if far >= g.pivot_distance:
            where = "the follower's pivot, which it would sweep over"
            raise DesignError("reach of the cam", far, g.pivot_distance, "mm", where, self.remedy())
        short = self.least_near - near
        if short > 0:
            smaller = {"parts.bore": bore - 2 * short}
            if self.sizes.frame.tip == "plate":
                smaller["geometry.tip_radius"] = g.tip_radius - short
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
                f"its nearest side, for parts.bore = {bore:g} with walls",
                ", or ".join([self.remedy(), *said]),
            )

    def pins(self, rim: Points) -> tuple[complex, float]:
        """Place of one pin hole, the other being its mirror image in Oy, and the wall that they keep, mm.

        The collet's wall gives way before the pins'. DesignError where they have no room.
        """
        p = self.sizes.making
        collet = self.sizes.collet
        least = self.sizes.min_wall + 2 * LAYOUT
        tries = []
        for wall in (collet.wall, min(collet.wall, least)):
            sleeve = self.collet(wall).radius if self.sizes.plain else 0.0
            pins = Pins(p.pin_diameter, p.reach, p.wall, least, sleeve, self.washer)
            tries.append(pins.placed(rim))
        place, kept = next((each for each in tries if each[1] >= least), tries[-1])
        if not kept >= least:
            raise DesignError(
                "wall of the cam's pins",
                kept,
                least,
                "mm",
                f"the best place for parts.pin_diameter = {p.pin_diameter:g}",
                f"use a smaller one, or more cam: {self.remedy(2 * (least - kept))}",
            )
        return place, kept

    def collet(self, wall: float) -> Collet:
        """The collet with a sleeve of this wall, mm, without flange and pins."""
        c = self.sizes.collet
        slide = self.sizes.fits.slide_clearance
        bore = self.sizes.making.bore
        return Collet(bore, slide, wall, c.length, c.flange, 0.0, (), c.slits, c.slit)

    def remedy(self, more: float = 0.0) -> str:
        """What of the geometry to change, key and value, for a cam that leaves room about shaft and pivot.

        One key is changed, the others stay. more: mm that the cam needs beyond its walls.
        """
        s = self.sizes
        g = s.geometry
        frame = s.frame
        fits = s.fits
        axle = min(frame.axle, LEAST_AXLE) + max(fits.press_clearance, fits.slide_clearance)
        hub = frame.gap + axle / 2 + s.min_wall + 5 * LAYOUT
        motor = s.base.face.half + frame.axle_flange / 2

        def has_room(pivot: Any, offset: Any, swing: Any) -> Any:
            near, far = near_far(pivot, offset, swing, g.tip_radius)
            # the frame swings by half the swing to either side
            return (
                (near >= self.least_near + more)
                & (pivot * np.cos(swing / 2) - far >= hub)
                & (pivot >= motor)
            )

        step = 10.0 ** (math.floor(math.log10(g.pivot_distance)) - 1) / 2
        lengths = step * np.arange(1, 400)
        degrees = np.arange(0.5, 180.0, 0.5)
        said = []
        for key, values, fine in (
            ("arm_offset", lengths, has_room(g.pivot_distance, lengths, self.swing)),
            ("pivot_distance", lengths, has_room(lengths, g.arm_offset, self.swing)),
            ("swing_deg", degrees, has_room(g.pivot_distance, g.arm_offset, np.radians(degrees))),
        ):
            if fine.any():
                nearest = values[fine][np.argmin(np.abs(values[fine] - getattr(g, key)))]
                said.append(f"geometry.{key} = {nearest:g}")
        if said:
            return f"there is room with {', or '.join(said)}"
        return "use other lengths, or a smaller geometry.swing_deg"


# ---- what a spec may not say ----------------------------------------------------------------------------------------


def faults(sizes: SwingSizes) -> list[Fault]:
    """What is wrong between keys that are right one by one."""
    p = sizes.making
    min_wall = sizes.min_wall
    nozzle = sizes.fits.nozzle
    blend = sizes.geometry.reversal_blend_deg
    printed = f"at least the nozzle, {nozzle:g} mm"
    checks = [
        (
            blend in (0, 180) or 0.01 <= blend <= 179.99,  # a stretch of less would be rounding
            "geometry",
            "reversal_blend_deg",
            "0 (sharp), 0.01 to 179.99, or 180",
        ),
        (p.wall >= nozzle, "parts", "wall", printed),
        (min_wall >= nozzle, "limits", "min_wall", printed),
        (
            p.mark_depth < p.thickness,
            "parts",
            "mark_depth",
            f"less than the thickness, {p.thickness:g} mm",
        ),
        *(_machine_checks(sizes) if p.make == "printed" else ()),
    ]
    return [
        Fault((table, key), f"{sizes.value(table, key):g}", right)
        for holds, table, key, right in checks
        if not holds
    ]


def _machine_checks(sizes: SwingSizes) -> Iterator[tuple[bool, str, str, str]]:
    """Checks between keys of the machine: whether it holds, table, key, what would be right."""
    p = sizes.making
    base = sizes.base
    frame = sizes.frame
    collet = sizes.collet
    slide = sizes.fits.slide_clearance
    nozzle = sizes.fits.nozzle
    pin = p.pin_diameter
    radius = sizes.geometry.tip_radius
    motor = base.face
    for table, key in (
        ("parts", "pin_diameter"),
        ("frame", "arm"),
        ("frame", "axle"),
        ("frame", "flange_thickness"),
        ("collet", "flange"),
    ):
        said = f"at least limits.min_wall, {sizes.min_wall:g} mm"
        thick = sizes.value(table, key)
        yield not thick or thick >= sizes.min_wall, table, key, said
    measured = p.bore_shape == "d-flat" and p.bore == motor.shaft and motor.flat
    said = f'{motor.flat:g}, the flat of the shaft of base.motor = "{base.motor}", {motor.shaft - motor.flat:g} over its flat'
    yield not measured or p.flat_depth == motor.flat, "parts", "flat_depth", said
    said = "more than 0: pins join the two cams on a plain shaft"
    yield pin > 0 or not (sizes.plain and sizes.pair), "parts", "pin_diameter", said
    said = f"at least the nozzle, {nozzle:g} mm, or it closes in print"
    yield collet.slit >= nozzle, "collet", "slit", said
    rollers = [frame.bearing.outside / 2] if frame.bearing else [d / 2 for d in DOWELS]
    said = f'that of frame.tip = "{frame.tip}": {", ".join(f"{each:g}" for each in rollers)} mm'
    yield frame.tip == "plate" or radius in rollers, "geometry", "tip_radius", said
    said = "more than 0: the cams and frames of a machine turn past each other"
    yield slide > 0, "print", "slide_clearance", said
    yield base.gap > slide, "base", "gap", f"more than print.slide_clearance, {slide:g} mm"
    said = f"less than parts.pin_diameter, {pin:g} mm"
    yield sizes.fits.press_clearance < pin or not pin, "print", "press_clearance", said
    said = f"more than the axle and its clearance, {frame.axle + slide:g} mm"
    yield frame.axle_flange > frame.axle + slide, "frame", "axle_flange", said
    said = f"more than base.boss, {base.boss:g} mm"
    yield base.motor != "flange" or base.screw_circle > base.boss, "base", "screw_circle", said
