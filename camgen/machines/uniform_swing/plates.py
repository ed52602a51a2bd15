"""Plates of the machine round a uniform-swing cam: the base that carries the motor, and the frames that swing.

Every shape says in its docstring where its origin is; z runs from 0 up. DesignError where a wall falls under the limit.
"""

from __future__ import annotations

import cmath
import math
from dataclasses import dataclass

import numpy as np

from camgen.errors import DesignError
from camgen.geometry.distances import inside, point_to_ring
from camgen.geometry.facets import facet_contour
from camgen.geometry.outlines import Contour, Points, Region, circle, kidney, polygon
from camgen.parts.catalogue import HEAD_ROOM, MotorFace, Screw
from camgen.parts.hardware import FACETS, plate, rounded
from camgen.parts.part import Layer, Part, hull

_HEAD_DEPTH = 0.2  # mm, by which a screw's head or a nut lies below the surface


# ---- base ------------------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Base:
    """What a base plate carries: a motor under the origin, an axle at `pivot` (x > 0), an arc slot about the pivot, mm, rad.

    axle, axle_flange: diameter of both axles and of their flanges under the plate; slide_at: radius of the slot about the
    pivot, on its far side; swing: peak to peak; end_room: way left at both ends of the slot; slide: fit; wall: around
    every hole; window: save material between motor and pivot, where there is room; mount: four screws that hold the base on
    its stand, beside motor, axles and their flanges.
    """

    motor: MotorFace
    pivot: float
    axle: float
    axle_flange: float
    slide_at: float
    swing: float
    thickness: float
    wall: float
    slide: float
    end_room: float = 1.0
    window: bool = True
    mount: Screw | None = None

    @property
    def mounts(self) -> tuple[complex, ...]:
        """Places of the screws that hold the base, beside the motor and the pivot."""
        if self.mount is None:
            return ()
        flanges = self.slide_at * math.sin(min(self.swing / 2, math.pi / 2)) + self.axle_flange / 2
        y = max(self.motor.half, flanges) + self.mount.head / 2 + HEAD_ROOM
        return tuple(complex(x, side * y) for x in (0.0, self.pivot) for side in (1, -1))

    @property
    def sunk(self) -> list[tuple[complex, Screw]]:
        """Screws whose heads lie in pockets: place and kind."""
        found = [(z, self.motor.screw) for z in self.motor.screws]
        return found + [(z, self.mount) for z in self.mounts if self.mount]

    @property
    def slot(self) -> Contour:
        """The arc slot in which the second axle travels."""
        half = self._half_slot
        return kidney(complex(self.pivot), self.slide_at, self._axle_hole, -half, 2 * half)

    @property
    def pocket_depth(self) -> float:
        """Depth of the pockets that let the screws' heads lie below the surface, mm."""
        return max(screw.height for _, screw in self.sunk) + _HEAD_DEPTH

    def part(self, min_wall: float) -> Part:
        """The plate, motor below; its origin is the motor's shaft. Two layers: the upper one has the pockets."""
        motor = self.motor
        pivot = complex(self.pivot)
        floor = self.thickness - self.pocket_depth
        self._refuse(min_wall)
        outer = self._outline()
        boss = motor.boss + self.slide
        fixed = {
            "boss": circle(0j, boss / 2),
            "axle": circle(pivot, self._axle_hole),
            "slot": self.slot,
        }
        opening = self._window(facet_contour(outer, FACETS))
        if opening:
            fixed["window"] = opening
        screws = {f"screw {k}": each for k, each in enumerate(self.sunk, 1)}
        through = {name: circle(z, screw.clearance / 2) for name, (z, screw) in screws.items()}
        pockets = {name: circle(z, _pocket(screw)) for name, (z, screw) in screws.items()}
        return Part(
            "base",
            "Base plate",
            (
                Layer(plate("base", outer, fixed | through, min_wall), 0.0, floor),
                Layer(plate("base", outer, fixed | pockets, min_wall), floor, self.thickness),
            ),
            centres=(0j, pivot, *(z for z, _ in self.sunk)),
            notes=(f"pockets {self.pocket_depth:g} deep for the screws' heads, this side up",),
            bore=boss,
            min_wall=min_wall,
        )

    @property
    def _axle_hole(self) -> float:
        """Radius of an axle's hole, and half the width of the slot."""
        return (self.axle + self.slide) / 2

    @property
    def _half_slot(self) -> float:
        """Half the angle of the slot's middle line about the pivot."""
        return self.swing / 2 + self.end_room / self.slide_at

    def _refuse(self, min_wall: float) -> None:
        """Raise DesignError where the plate is too thin, or motor or slot have no room."""
        least = self.pocket_depth + min_wall
        if self.thickness < least:
            raise DesignError(
                "thickness of the base",
                self.thickness,
                least,
                "mm",
                "the heads of the screws",
                "use a thicker base or smaller screws",
            )
        room = self.pivot - self.axle_flange / 2 - self.motor.half
        if room < 0:
            raise DesignError(
                "room for the axle's flange",
                room,
                0,
                "mm",
                "the underside of the base, beside the motor",
                f"use a smaller base.motor or frame.axle_flange, or geometry.pivot_distance = {self.pivot - room:g} or more",
            )
        if self._half_slot >= math.pi - (2 * self._axle_hole + self.wall) / self.slide_at:
            raise DesignError(
                "arc slot",
                math.degrees(2 * self._half_slot),
                360,
                "deg",
                "base",
                "its ends meet: use a smaller swing or a larger slide_at",
            )

    def _outline(self) -> Contour:
        """The edge, a wall round all that the plate has."""
        radius = self._axle_hole
        wall = self.wall
        half = self._half_slot
        # discs along the slot, so close that the chords between them take no more than 0.1 mm of its wall
        chord = math.acos(max(-1.0, 1 - 0.1 / (self.slide_at + radius + wall)))
        count = max(1, math.ceil(half / chord))
        along = self.pivot + self.slide_at * np.exp(1j * np.linspace(-half, half, 2 * count + 1))
        return hull(
            [
                *((complex(z), radius + wall + 0.1) for z in along),
                *((z, _pocket(screw) + wall) for z, screw in self.sunk),
                (0j, (self.motor.boss + self.slide) / 2 + wall),
                (complex(self.pivot), radius + wall),
            ]
        )

    def _window(self, rim: Points) -> Contour | None:
        """A rounded opening between motor and pivot, two walls from the edge and one from everything else; None: no room."""
        motor = self.motor
        corner = self.wall
        head = _pocket(motor.screw)
        begin = max([motor.boss / 2, *(z.real + head for z in motor.screws)]) + self.wall + corner
        end = self.pivot - self._axle_hole - self.wall - corner
        if not self.window or end - begin < corner:
            return None
        upper = rim[rim.imag > 0]
        upper = upper[np.argsort(upper.real)]
        corners = []
        for x in (begin, end):
            heights = np.interp([x - corner, x, x + corner], upper.real, upper.imag)
            corners.append(complex(x, float(np.min(heights)) - 2 * self.wall - corner))
        left, right = corners
        if min(left.imag, right.imag) <= 0:
            return None
        return rounded([(z, corner) for z in (left, left.conjugate(), right.conjugate(), right)])


def _pocket(screw: Screw) -> float:
    """Radius of the pocket of a screw's head, mm."""
    return (screw.head + HEAD_ROOM) / 2


# ---- frame -----------------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Frame:
    """One of two like plates of a swinging follower, the other turned over about the line of centres; mm.

    tip: trace point seen from the pivot (imaginary part < 0), complex; tip_radius: of the round tip, or of the boss round
    a seat; seat: hole at the tip for a pressed pin or a bearing's screw, 0: the plate itself is the tip.
    inside: what turns beside the plate never comes right of its real part nor below its imaginary part, room included.
    axle: hole of both axles; slide_at: second axle on the line of centres, beyond the pivot; screw: clearance hole of the
    nozzle's two screws, `spacing` apart at slide_at; pin: hole of two pins between the axles, 0: none. Holes have their fits.
    nut: across the flats of the pockets of the nozzle's nuts, 0: none, and the nuts' height. Of a pair each plate takes half a
    nut on its upper side, so that it is caught between both; a single plate takes it whole from below.
    hub: radius of the plate round the pivot's axle, 0: its hole and the wall.
    straight: the tip's finger is as wide as the tip on its far side, where it else widens to the end of the arm.
    """

    tip: complex
    tip_radius: float
    inside: complex
    arm: float
    axle: float
    slide_at: float
    screw: float
    spacing: float
    pin: float
    thickness: float
    wall: float
    seat: float = 0.0
    nut: tuple[float, float] = (0.0, 0.0)
    hub: float = 0.0
    straight: bool = False

    @property
    def pins(self) -> tuple[complex, ...]:
        """Places of the two pins, between the axles on their line, where turning over leaves them."""
        return (complex(self.slide_at / 3), complex(self.slide_at * 2 / 3)) if self.pin else ()

    @property
    def outline(self) -> Contour:
        """The plate's edge: tip on a short finger, bar past the cam, post with gusset to the tail, hub."""
        hub = self.hub or self.axle / 2 + self.wall
        corner = self.screw / 2 + self.wall
        root = max(self.tip_radius, self.wall / 2)
        shelf = min(self.inside.imag, self.tip.imag - max(self.tip_radius, self.wall))
        post = -hub  # left edge
        if post < self.inside.real:
            raise DesignError(
                "room for the axle's hub",
                -self.inside.real,
                hub,
                "mm",
                "frame, beside the pivot",
                "the cam comes too near the pivot: use a smaller frame.axle or frame.wall, or a smaller geometry.arm_offset",
            )
        half = self.arm / 2
        fillet = min(self.arm / 2, (post - self.tip.real - root) / 4)
        if fillet <= 0:
            raise DesignError(
                "room between tip and post",
                post - self.tip.real,
                root,
                "mm",
                "frame",
                "use a larger pivot_distance or a smaller tip, axle or wall",
            )
        notch = min(fillet, (self.tip.imag - shelf) / 2)
        tail = complex(self.slide_at, self.spacing / 2)
        return rounded(
            [
                (self.tip, self.tip_radius),
                (
                    complex(
                        self.tip.real + max(half - self.tip_radius, 0.0) * self.straight,
                        shelf - half,
                    ),
                    half,
                ),
                (complex(post + half, shelf - half), half),
                (tail.conjugate(), corner),
                (tail, corner),
                (0j, hub),
                (complex(post - fillet, shelf + fillet), -fillet),
                (complex(self.tip.real + root + notch, shelf + notch), -notch),
            ]
        )

    @property
    def screws(self) -> tuple[complex, complex]:
        """Places of the nozzle's screws."""
        tail = complex(self.slide_at, self.spacing / 2)
        return tail, tail.conjugate()

    def part(self, min_wall: float, count: int = 2) -> Part:
        """The plate; its origin is the pivot. Turned over about its x axis it fits the other one hole by hole."""
        both = "two alike: turn one over about the line of both axles (y to -y)"
        notes = [both] if count == 2 else []
        flats, height = self.nut
        depth = height / count + _HEAD_DEPTH / 2
        layers = self._layers(min_wall, count, depth if flats else 0.0)
        if flats:
            notes.append(f"pockets {flats:g} across flats for the nozzle's nuts, {depth:g} deep")
        tip = (self.tip,) if self.seat else ()
        return Part(
            "frame",
            "Frame plate",
            layers,
            count,
            (),
            (0j, complex(self.slide_at), *self.screws, *self.pins, *tip),
            tuple(notes),
            self.axle,
            min_wall,
            1 if flats and count == 1 else 0,
        )

    def _layers(self, min_wall: float, count: int, depth: float) -> tuple[Layer, ...]:
        """The plate from below; depth: of the nuts' pockets, above of two plates, below of one; 0: none."""
        thick = self.thickness
        outer = self._edge
        holes = self._holes()
        plain = plate("frame", outer, holes, min_wall)
        if not depth:
            return (Layer(plain, 0.0, thick),)
        if thick - depth < min_wall:
            raise DesignError(
                "thickness of the frame",
                thick,
                depth + min_wall,
                "mm",
                "the pockets of the nozzle's nuts",
                "use a thicker frame (parts.thickness) or a smaller nozzle.screw",
            )
        nuts = {f"nozzle screw {k}": _hexagon(z, self.nut[0]) for k, z in enumerate(self.screws, 1)}
        pocketed = plate("frame", outer, holes | nuts, min_wall)
        if count == 2:
            return Layer(plain, 0.0, thick - depth), Layer(pocketed, thick - depth, thick)
        return Layer(pocketed, 0.0, depth), Layer(plain, depth, thick)

    @property
    def _edge(self) -> Contour:
        """Its outline; DesignError where its sizes do not go together."""
        try:
            return self.outline
        except ValueError as error:
            remedy = "use a wider arm or a smaller wall"
            raise DesignError("arm of the frame", self.arm, 0, "mm", str(error), remedy) from None

    def _holes(self) -> dict[str, Contour]:
        """Of axles, screws, pins and the tip's pin, by name."""
        holes = {
            "axle": circle(0j, self.axle / 2),
            "sliding axle": circle(complex(self.slide_at), self.axle / 2),
        }
        holes |= {
            f"nozzle screw {k}": circle(z, self.screw / 2) for k, z in enumerate(self.screws, 1)
        }
        holes |= {f"pin {k}": circle(z, self.pin / 2) for k, z in enumerate(self.pins, 1)}
        return holes | ({"seat": circle(self.tip, self.seat / 2)} if self.seat else {})


def _hexagon(centre: complex, flats: float) -> Contour:
    """Pocket of a nut, two of its corners along x."""
    return polygon([centre + cmath.rect(flats / math.sqrt(3), math.tau * k / 6) for k in range(6)])


def swept_box(rims: Points) -> complex:
    """Greatest real and least imaginary part of what a body sweeps, as one complex number; rims: any shape, complex mm."""
    return complex(float(np.max(rims.real)), float(np.min(rims.imag)))


def overlap(region: Region, rims: Points, but: tuple[complex, float]) -> float:
    """How deep points, (n,) complex, lie inside a region's outline, mm, 0 where none does; `but`: a disc left out of it."""
    ring = facet_contour(region.outer, FACETS)
    deep = rims[inside(rims, ring) & (np.abs(rims - but[0]) > but[1])]
    return float(np.max(point_to_ring(deep, ring))) if len(deep) else 0.0
