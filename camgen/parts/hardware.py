"""Machine parts as stacks of extruded outlines: plates with named holes, base, frame, collet, axle, spacer.

    rounded   outline drawn tight round discs: a positive radius is a corner of the material, a negative one a fillet
    plate     an outline with named holes whose walls are checked, so that a fault names what meets what
    fit       diametral: a hole is its shaft's diameter plus the fit

Every shape says in its docstring where its origin is; z runs from 0 up. DesignError where a wall falls under the limit.
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np

from camgen.errors import DesignError
from camgen.geometry.distances import point_to_ring, thinnest_wall
from camgen.geometry.facets import facet_contour
from camgen.geometry.outlines import Arc, Contour, Line, Points, Region, circle, kidney, polygon
from camgen.parts.catalogue import MotorFace, Screw
from camgen.parts.part import Layer, Part, hull
from camgen.tolerances import SAME_POINT

_FACETS = 0.01  # mm, on which walls are measured; they are judged again on the written files
_HEAD_ROOM = 0.5  # mm, diametral room of a screw's head in its pocket
_HEAD_DEPTH = 0.2  # mm, by which a screw's head or a nut lies below the surface
_TAPER = 1 / 20  # slope of a collet's side: 2.9 deg, self-locking from a friction of 0.05
_TAPER_STEP = 0.05  # mm, radius of one step of a taper: less than a printer resolves


def rounded(discs: Sequence[tuple[complex, float]]) -> Contour:
    """Outline drawn tight round discs (centre, radius) in their order, counter-clockwise.

    A disc of positive radius lies inside (a round corner), of negative radius outside (a fillet), of 0 is a sharp corner.
    ValueError where two neighbours leave no straight piece between them.
    """
    normals = []
    for (a, ra), (b, rb) in zip(discs, [*discs[1:], discs[0]], strict=True):
        if abs(b - a) <= abs(ra - rb):
            raise ValueError(f"no tangent from the disc about {a:g} to the disc about {b:g}")
        normals.append(cmath.phase(b - a) - math.acos((ra - rb) / abs(b - a)))
    pieces: list[Arc | Line] = []
    for k, (centre, radius) in enumerate(discs):
        following, next_radius = discs[(k + 1) % len(discs)]
        turn = (normals[k] - normals[k - 1] + math.pi) % math.tau - math.pi
        if radius and abs(turn) > 1e-12:
            side = 0.0 if radius > 0 else math.pi
            pieces.append(Arc(centre, abs(radius), normals[k - 1] + side, turn))
        normal = cmath.exp(1j * normals[k])
        pieces.append(Line(centre + radius * normal, following + next_radius * normal))
    return Contour(tuple(pieces))


def plate(name: str, outer: Contour, holes: Mapping[str, Contour], min_wall: float) -> Region:
    """The region inside `outer` less the named holes; DesignError names the two that leave a wall under min_wall, mm."""
    rings = {hole: facet_contour(c, min(_FACETS, 0.01 * math.sqrt(abs(c.area)))) for hole, c in holes.items()}
    rim = facet_contour(outer, _FACETS)
    _check_simple(name, rim)
    if thinnest_wall(rim, list(rings.values())) < min_wall:
        walls = {("edge", hole): thinnest_wall(rim, [ring]) for hole, ring in rings.items()}
        for a, b in combinations(rings, 2):
            walls[a, b] = min(thinnest_wall(rim, [rings[a], rings[b]]), math.inf)
        (a, b), wall = min(walls.items(), key=lambda item: item[1])
        raise DesignError(
            f"wall of the {name}", wall, min_wall, "mm", f"between {a} and {b}",
            "they meet or lie outside" if wall <= 0 else "make room between them or lower the wall that is asked for",
        )  # fmt: skip
    return Region(outer, tuple(holes.values()))


def _check_simple(name: str, rim: Points) -> None:
    """Raise DesignError where an edge crosses itself."""
    import shapely

    reason = shapely.is_valid_reason(shapely.Polygon(np.column_stack([rim.real, rim.imag])))
    if reason != "Valid Geometry":
        place = reason.replace("[", " at (").replace("]", ") mm")
        raise DesignError(f"crossings in the edge of the {name}", 1, 0, "", place, "its sizes do not go together")


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
        y = max(self.motor.half, flanges) + self.mount.head / 2 + _HEAD_ROOM
        return tuple(complex(x, side * y) for x in (0.0, self.pivot) for side in (1, -1))

    @property
    def sunk(self) -> list[tuple[complex, Screw]]:
        """Screws whose heads lie in pockets: place and kind."""
        found = [(z, self.motor.screw) for z in self.motor.screws]
        return found + [(z, self.mount) for z in self.mounts if self.mount]

    @property
    def slot(self) -> Contour:
        """The arc slot in which the second axle travels."""
        half = self.swing / 2 + self.end_room / self.slide_at
        return kidney(complex(self.pivot), self.slide_at, (self.axle + self.slide) / 2, -half, 2 * half)

    @property
    def pocket_depth(self) -> float:
        """Depth of the pockets that let the screws' heads lie below the surface, mm."""
        return max(screw.height for _, screw in self.sunk) + _HEAD_DEPTH

    def part(self, min_wall: float) -> Part:
        """The plate, motor below; its origin is the motor's shaft. Two layers: the upper one has the pockets."""
        motor, wall = self.motor, self.wall
        floor = self.thickness - self.pocket_depth
        if floor < min_wall:
            raise DesignError(
                "thickness of the base", self.thickness, self.pocket_depth + min_wall, "mm",
                "under the heads of the screws", "use a thicker base or smaller screws",
            )  # fmt: skip
        room = self.pivot - self.axle_flange / 2 - motor.half
        if room < 0:
            raise DesignError(
                "room for the axle's flange", room, 0, "mm", "under the base, beside the motor",
                f"use a smaller base.motor or frame.axle_flange, or geometry.pivot_distance = {self.pivot - room:g} or more",
            )  # fmt: skip
        radius, slot = (self.axle + self.slide) / 2, self.slot
        half = self.swing / 2 + self.end_room / self.slide_at
        if half >= math.pi - (2 * radius + wall) / self.slide_at:
            raise DesignError(
                "arc slot", math.degrees(2 * half), 360, "deg", "base", "its ends meet: use a smaller swing or a larger slide_at"
            )
        sunk = {
            f"screw {k}": (z, screw.clearance / 2, (screw.head + _HEAD_ROOM) / 2) for k, (z, screw) in enumerate(self.sunk, 1)
        }
        # discs along the slot, so close that the chords between them take no more than 0.1 mm of its wall
        count = max(1, math.ceil(half / math.acos(max(-1.0, 1 - 0.1 / (self.slide_at + radius + wall)))))
        along = self.pivot + self.slide_at * np.exp(1j * np.linspace(-half, half, 2 * count + 1))
        discs = [(complex(z), radius + wall + 0.1) for z in along]
        discs += [(z, head + wall) for z, _, head in sunk.values()]
        discs += [(0j, (motor.boss + self.slide) / 2 + wall), (complex(self.pivot), radius + wall)]
        outer = hull(discs)
        fixed = {"boss": circle(0j, (motor.boss + self.slide) / 2), "axle": circle(complex(self.pivot), radius), "slot": slot}
        screws = {name: circle(z, through) for name, (z, through, _) in sunk.items()}
        pockets = {name: circle(z, head) for name, (z, _, head) in sunk.items()}
        opening = self._window(facet_contour(outer, _FACETS), (motor.screw.head + _HEAD_ROOM) / 2, radius)
        if opening:
            fixed["window"] = opening
        return Part(
            "base", "Base plate",
            (
                Layer(plate("base", outer, fixed | screws, min_wall), 0.0, floor),
                Layer(plate("base", outer, fixed | pockets, min_wall), floor, self.thickness),
            ),
            centres=(0j, complex(self.pivot), *(z for z, _ in self.sunk)),
            notes=(f"pockets {self.pocket_depth:g} deep for the screws' heads, this side up",),
            bore=motor.boss + self.slide, min_wall=min_wall,
        )  # fmt: skip


    def _window(self, rim: Points, head: float, axle: float) -> Contour | None:
        """A rounded opening between motor and pivot, two walls from the edge and one from everything else; None: no room."""
        motor, corner = self.motor, self.wall
        begin = max([motor.boss / 2, *(z.real + head for z in motor.screws)]) + self.wall + corner
        end = self.pivot - axle - self.wall - corner
        if not self.window or end - begin < corner:
            return None
        upper = rim[rim.imag > 0]
        upper = upper[np.argsort(upper.real)]
        heights = np.interp([begin - corner, begin, begin + corner, end - corner, end, end + corner], upper.real, upper.imag)
        left, right = (float(np.min(heights[part])) - 2 * self.wall - corner for part in (slice(3), slice(3, 6)))
        if min(left, right) <= 0:
            return None
        places = (complex(begin, left), complex(begin, -left), complex(end, -right), complex(end, right))
        return rounded([(z, corner) for z in places])


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
                "room for the axle's hub", -self.inside.real, hub, "mm", "frame, beside the pivot",
                "the cam comes too near the pivot: use a smaller frame.axle or frame.wall, or a smaller geometry.arm_offset",
            )  # fmt: skip
        half, fillet = self.arm / 2, min(self.arm / 2, (post - self.tip.real - root) / 4)
        if fillet <= 0:
            raise DesignError(
                "room between tip and post", post - self.tip.real, root, "mm", "frame", "use a larger pivot_distance or a "
                "smaller tip, axle or wall",
            )  # fmt: skip
        notch = min(fillet, (self.tip.imag - shelf) / 2)
        tail = complex(self.slide_at, self.spacing / 2)
        return rounded(
            [
                (self.tip, self.tip_radius),
                (complex(self.tip.real + max(half - self.tip_radius, 0.0) * self.straight, shelf - half), half),
                (complex(post + half, shelf - half), half),
                (tail.conjugate(), corner),
                (tail, corner),
                (0j, hub),
                (complex(post - fillet, shelf + fillet), -fillet),
                (complex(self.tip.real + root + notch, shelf + notch), -notch),
            ]
        )

    def part(self, min_wall: float, count: int = 2) -> Part:
        """The plate; its origin is the pivot. Turned over about its x axis it fits the other one hole by hole."""
        holes = {"axle": circle(0j, self.axle / 2), "sliding axle": circle(complex(self.slide_at), self.axle / 2)}
        tail = complex(self.slide_at, self.spacing / 2)
        holes |= {f"nozzle screw {k + 1}": circle(z, self.screw / 2) for k, z in enumerate((tail, tail.conjugate()))}
        holes |= {f"pin {k + 1}": circle(z, self.pin / 2) for k, z in enumerate(self.pins)}
        if self.seat:
            holes["seat"] = circle(self.tip, self.seat / 2)
        try:
            outer = self.outline
        except ValueError as error:
            raise DesignError("arm of the frame", self.arm, 0, "mm", str(error), "use a wider arm or a smaller wall") from None
        layers, cut = [Layer(plate("frame", outer, holes, min_wall), 0.0, self.thickness)], 0
        flats, height = self.nut
        if flats:
            depth = height / count + _HEAD_DEPTH / 2
            if self.thickness - depth < min_wall:
                raise DesignError(
                    "thickness of the frame", self.thickness, depth + min_wall, "mm", "at the pockets of the nozzle's nuts",
                    "use a thicker frame (parts.thickness) or a smaller nozzle.screw",
                )  # fmt: skip
            pockets = {f"nozzle screw {k + 1}": _hexagon(z, flats) for k, z in enumerate((tail, tail.conjugate()))}
            pocketed = plate("frame", outer, holes | pockets, min_wall)
            split = self.thickness - depth if count == 2 else depth
            lower, upper = (layers[0].region, pocketed) if count == 2 else (pocketed, layers[0].region)
            layers, cut = [Layer(lower, 0.0, split), Layer(upper, split, self.thickness)], 0 if count == 2 else 1
        centres = (0j, complex(self.slide_at), tail, tail.conjugate(), *self.pins, *((self.tip,) if self.seat else ()))
        both = ("two alike: turn one over about the line of both axles (y to -y)",) if count == 2 else ()
        if flats:
            both = (*both, f"pockets {flats:g} across flats for the nozzle's nuts, {depth:g} deep")
        return Part(
            "frame", "Frame plate", tuple(layers), count, (), centres, both, self.axle, min_wall, cut
        )  # fmt: skip


def _hexagon(centre: complex, flats: float) -> Contour:
    """Pocket of a nut, two of its corners along x."""
    return polygon([centre + cmath.rect(flats / math.sqrt(3), math.tau * k / 6) for k in range(6)])


def swept_box(rims: Points) -> complex:
    """Greatest real and least imaginary part of what a body sweeps, as one complex number; rims: any shape, complex mm."""
    return complex(float(np.max(rims.real)), float(np.min(rims.imag)))


def overlap(region: Region, rims: Points, but: tuple[complex, float]) -> float:
    """How deep points, (n,) complex, lie inside a region's outline, mm, 0 where none does; `but`: a disc left out of it."""
    import shapely

    ring = facet_contour(region.outer, _FACETS)
    inner = shapely.Polygon(np.column_stack([ring.real, ring.imag]))
    inside = rims[shapely.contains_xy(inner, rims.real, rims.imag) & (np.abs(rims - but[0]) > but[1])]
    return float(np.max(point_to_ring(inside, ring))) if len(inside) else 0.0


# ---- shaft and axles -------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Collet:
    """A slit sleeve on a flange and the ring that is pushed over it, both tapered 1 : 20, for a plain shaft; mm.

    shaft: diameter; fit: of the bore; wall: of the sleeve at its thin end and of the ring; length: of the sleeve;
    slits, slit: how many and how wide; flange: thickness; flange_diameter; pins: (place, hole diameter) in the flange.
    The taper is a stack of steps of 0.05 mm, which a printer makes of any taper. The ring first touches with `travel`
    left to go; pushed home it closes the sleeve by travel / 10 in diameter, which must be more than the fit.
    """

    shaft: float
    fit: float
    wall: float
    length: float
    flange: float
    flange_diameter: float
    pins: tuple[tuple[complex, float], ...] = ()
    slits: int = 4
    slit: float = 1.0

    @property
    def steps(self) -> int:
        """Steps of the taper."""
        return max(1, round(self.length * _TAPER / _TAPER_STEP))

    @property
    def travel(self) -> float:
        """Way of the ring from first touch to the flange, mm: whole steps, half as much again as closes the bore's fit."""
        rise = self.length / self.steps
        return rise * math.ceil(1.5 * self.fit / 2 / _TAPER / rise - 1e-9)

    def _radius(self, step: int) -> float:
        """Outer radius of the sleeve at a step from below."""
        return (self.shaft + self.fit) / 2 + self.wall + (self.steps - 1 - step) * _TAPER * self.length / self.steps

    @property
    def radius(self) -> float:
        """Outer radius of the sleeve where it is thickest, at the flange."""
        return self._radius(0)

    @property
    def ring_diameter(self) -> float:
        """Outside diameter of the ring."""
        return 2 * (self._radius(0) + self.wall)

    def sleeve(self, min_wall: float) -> Part:
        """Flange and slit sleeve; the origin is the shaft's axis."""
        bore = (self.shaft + self.fit) / 2
        holes = {"bore": circle(0j, bore)} | {f"pin {k + 1}": circle(z, d / 2) for k, (z, d) in enumerate(self.pins)}
        for k, (z, d) in enumerate(self.pins):
            gap = abs(z) - d / 2 - self.radius
            if gap < -SAME_POINT:
                raise DesignError("gap beside the collet's sleeve", gap, 0, "mm", f"pin {k + 1}", "use a smaller collet.wall")
        if self._radius(0) + self.wall > self.flange_diameter / 2:
            raise DesignError(
                "flange of the collet", self.flange_diameter, self.ring_diameter, "mm", "", "the ring needs a wider flange"
            )
        between = math.tau / self.slits - 2 * math.asin(min(1.0, self.slit / 2 / bore))
        if between * bore < min_wall:
            raise DesignError(
                "finger of the collet", between * bore, min_wall, "mm", "between two slits", "use fewer or narrower slits"
            )
        if self.wall < min_wall:
            raise DesignError("wall of the collet", self.wall, min_wall, "mm", "thin end", "use a thicker wall")
        region = plate("collet's flange", circle(0j, self.flange_diameter / 2), holes, min_wall)
        layers, rise = [Layer(region, 0.0, self.flange)], self.length / self.steps
        for step in range(self.steps):
            z = self.flange + step * rise
            for k in range(self.slits):
                finger = _sector(bore, self._radius(step), self.slit, math.tau * k / self.slits, math.tau * (k + 1) / self.slits)
                layers.append(Layer(Region(finger), z, z + rise))
        return Part(
            "collet", "Collet", tuple(layers), centres=(0j, *(z for z, _ in self.pins)),
            notes=("pinned and glued on the upper cam",), bore=2 * bore, min_wall=min_wall,
        )  # fmt: skip

    def ring(self) -> Part:
        """The clamp ring, wide end down; the origin is its axis."""
        rise, first = self.length / self.steps, round(self.travel * self.steps / self.length)
        if first >= self.steps:
            raise DesignError(
                "travel of the clamp ring", self.travel, self.length, "mm", "", "use a longer sleeve or a closer fit of the bore"
            )
        outer = circle(0j, self.ring_diameter / 2)
        layers = tuple(
            Layer(Region(outer, (circle(0j, self._radius(step)),)), k * rise, (k + 1) * rise)
            for k, step in enumerate(range(first, self.steps))
        )
        return Part(
            "clamp-ring", "Clamp ring", layers, centres=(0j,), bore=2 * self._radius(first),
            min_wall=self.wall, notes=("wide end first over the collet, pushed home",),
        )  # fmt: skip


def _sector(inner: float, outer: float, slit: float, start: float, end: float) -> Contour:
    """Finger between two slits of parallel walls whose middles lie at the angles start and end, rad."""
    lean, low = math.asin(slit / 2 / outer), math.asin(slit / 2 / inner)
    rim = Arc(0j, outer, start + lean, end - start - 2 * lean)
    bore = Arc(0j, inner, end - low, -(end - start - 2 * low))
    corners = [complex(piece.at(t)) for piece in (rim, bore) for t in (piece.t0, piece.t1)]
    return Contour((rim, Line(corners[1], corners[2]), bore, Line(corners[3], corners[0])))


def axle(diameter: float, length: float, flange_diameter: float, flange: float, count: int = 2) -> Part:
    """A round axle on a flange, flange down; length is that of the axle above the flange, mm."""
    if not flange_diameter > diameter:
        raise DesignError(
            "flange of the axle", flange_diameter, diameter, "mm", "", "the flange holds nothing: make it wider than the axle"
        )
    layers = (
        Layer(Region(circle(0j, flange_diameter / 2)), 0.0, flange),
        Layer(Region(circle(0j, diameter / 2)), flange, flange + length),
    )
    return Part("axle", "Axle with flange", layers, count, centres=(0j,), notes=("pressed and glued into the frames",), cut=1)


def spacer(
    name: str, title: str, bore: float, diameter: float, thickness: float, min_wall: float, count: int = 1,
    pins: Sequence[tuple[complex, float]] = (), outer: Contour | None = None,
) -> Part:  # fmt: skip
    """A washer, with further holes (place, diameter) where it sits on pins; the origin is its axis; outer: an edge not round."""
    holes = {"bore": circle(0j, bore / 2)} | {f"pin {k + 1}": circle(z, d / 2) for k, (z, d) in enumerate(pins)}
    region = plate(name, outer or circle(0j, diameter / 2), holes, min_wall)
    centres = (0j, *(z for z, _ in pins))
    return Part(name, title, (Layer(region, 0.0, thickness),), count, centres=centres, bore=bore, min_wall=min_wall)
