"""Parts: stacks of extruded regions, and the shapes that machine parts are made of."""

from __future__ import annotations

import cmath
import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from camgen.geometry.crossing import Edge, spread, volume
from camgen.geometry.drums import Drum
from camgen.geometry.outlines import (
    Arc,
    Contour,
    Line,
    Piece,
    Points,
    Region,
    circle,
    kidney,
    polygon,
)
from camgen.geometry.trimming import part_between
from camgen.numerics import magnitude
from camgen.tolerances import SAME_POINT


@dataclass(frozen=True)
class Layer:
    """A region extruded from height z0 to z1, mm."""

    region: Region
    z0: float
    z1: float

    @property
    def volume(self) -> float:
        """Exact volume, mm^3."""
        return self.region.area * (self.z1 - self.z0)


Role = Literal[
    "",
    "pin",
    "crank-pin",
    "shaft",
    "spacer",
    "sleeve",
    "cap",
    "nut",
    "cover",
    "keeper",
    "lock",
    "counterweight",
    "thread-post",
    "motor-bar",
    "battery-frame",
]


ROD = "h9"  # fit of a rod as it is sold


class SizeNote(str):
    """A note that says of what stock a part is cut, such as "rod 6 h9", how long, mm, how at the bench, "" as any other, and its fit."""

    stock: str
    length: float
    how: str
    fit: str

    def __new__(
        cls, text: str, stock: str = "", length: float = 0.0, how: str = "", fit: str = ROD
    ) -> SizeNote:
        """The text, with what the parts list and the steps say of it."""
        note = super().__new__(cls, text)
        note.stock = stock
        note.length = length
        note.how = how
        note.fit = fit
        return note


@dataclass(frozen=True)
class Tap:
    """A thread through a part along +y, square to its axis, which its files do not have; mm."""

    thread: str
    height: float  # of its own axis, z
    inner: float  # from the part's axis to where it begins, and to where it ends
    outer: float


class SquareNote(str):
    """A note that says which holes are square to a part's lower face, in words, and within which zone, mm; its sheet has a symbol."""

    holes: str
    zone: float

    def __new__(cls, holes: str, zone: float) -> SquareNote:
        """holes: in words, such as "holes O and C"."""
        said = f"{holes} square to the lower face within Ø{zone:g} over the thickness"
        note = super().__new__(cls, said)
        note.holes = holes
        note.zone = zone
        return note


GREASED = "grease its bore first"  # of metal that turns on a pin


class HoldingNote(str):
    """A note that says how a part is held, or which way it lies; the steps of assembly have it too."""


class GluedNote(HoldingNote):
    """One that says that a part is glued by its lower face on what it stands."""


@dataclass(frozen=True)
class Part:
    """One distinct part: `layers` of material, `engraved` layers taken away, and how many are needed.

    Frame: the part's own datum at the origin, z from 0 up. Layers of one height are separate pieces with the same z0 and z1.
    """

    name: str
    title: str  # for people
    layers: tuple[Layer, ...]
    count: int = 1
    engraved: tuple[Layer, ...] = ()
    centres: tuple[complex, ...] = ()  # points that get a centre mark, mm
    notes: tuple[str, ...] = ()  # for people
    bore: float | None = None  # diameter of the hole on whose centre the part turns, if it has one
    min_wall: float = 0.0  # thinnest that its designer accepts, mm
    drawn_layer: int = 0  # the one that a laser cuts and the drawing shows, which has the joints
    # region of the plane (x, z), as x + iz, that is extruded along y: only what lies in it too is material
    side_profile: Region | None = None
    # of a part with a side profile, those that are rounded, none meeting another's arc
    edges: tuple[Edge, ...] = ()
    process: str = "printed"  # how, for the parts list
    points: tuple[tuple[str, complex], ...] = ()  # of the spec, mm, which a drawing calls by name
    role: Role = ""  # what it is in a machine, where a machine has many of its kind
    drum: Drum | None = None  # what its track leaves of the layers, which are its blank
    # whether it fits turned over too, moves wrongly then, and no engraving says which side is up: whoever makes it marks that
    to_mark: bool = False
    lettered: frozenset[str] = (
        frozenset()
    )  # names of points whose letter is engraved beside its hole
    tap: Tap | None = None
    stacked: bool = (
        False  # whether each of its layers has an outline of its own, none of which is the part's
    )

    @property
    def heading(self) -> str:
        """What sheets and lists call it: by its name where the title has no other words."""
        words = self.name.replace("-", " ").replace("_", " ")
        return self.name if self.title.lower() == words.lower() else self.title

    @property
    def listed(self) -> str:
        """Its name, and its title where that has other words."""
        return self.name if self.heading == self.name else f"{self.name}: {self.title}"

    @property
    def thickness(self) -> float:
        """Height of the part, mm."""
        return max(layer.z1 for layer in self.layers)

    @property
    def drawn(self) -> Layer:
        """The layer that a laser cuts and the drawing shows."""
        return self.layers[self.drawn_layer]

    @property
    def region(self) -> Region:
        """The region that a laser cuts."""
        return self.drawn.region

    @property
    def volume(self) -> float:
        """Exact volume, mm^3, of layers that do not overlap less the engraving."""
        if self.side_profile is not None:
            whole = sum(
                volume(layer.region, self.side_profile, layer.z0, layer.z1) for layer in self.layers
            )
            return whole - sum(edge.volume for edge in self.edges)
        if self.drum is not None:
            bored = sum(
                abs(hole.area) * (layer.z1 - layer.z0)
                for layer in self.layers
                for hole in layer.region.holes
            )
            key = self.key
            beyond = 0.0 if key is None else abs(key.region.outer.area) * (key.z1 - key.z0)
            return self.drum.moments.volume + beyond - bored
        return sum(layer.volume for layer in self.layers) - sum(
            layer.volume for layer in self.engraved
        )

    @property
    def engraving(self) -> tuple[Contour, ...]:
        """The contours that a laser engraves."""
        return tuple(
            each for layer in self.engraved for each in (layer.region.outer, *layer.region.holes)
        )

    @property
    def walls(self) -> float:
        """Area of the upright walls, mm^2, or more: facets within a tolerance cost at most so much volume per mm of it."""
        area = sum(layer.region.length * (layer.z1 - layer.z0) for layer in self.layers)
        if self.side_profile is not None:
            low, high = zip(*(spread(layer.region) for layer in self.layers), strict=True)
            area += self.side_profile.length * (max(high) - min(low))
        if self.drum is not None:
            area += self.drum.moments.walls
        return area

    @property
    def key(self) -> Layer | None:
        """What stands on the upper end of a drum, for another part to sit on."""
        top = self.layers[-1]
        return top if self.drum is not None and top.z0 >= self.drum.length else None

    @property
    def prismatic(self) -> bool:
        """Whether each layer has its outline at all its heights."""
        return self.side_profile is None and self.drum is None

    @property
    def outlined(self) -> bool:
        """Whether the region of its drawn layer can be cut: of a drum it is the blank's, of a stack one of several."""
        return self.drum is None and not self.stacked


def d_bore(diameter: float, flat_depth: float) -> Contour:
    """Bore for a shaft with a flat: a circle about the origin whose top is cut off flat_depth below it, mm; 0: a circle."""
    radius = diameter / 2
    if not flat_depth:
        return circle(0j, radius)
    height = radius - flat_depth
    lean = math.asin(height / radius)
    round_part = Arc(0j, radius, math.pi - lean, math.pi + 2 * lean)
    half = radius * math.cos(lean)
    return Contour((round_part, Line(complex(half, height), complex(-half, height))))


def keyed_bore(diameter: float, key_width: float, key_depth: float) -> Contour:
    """Bore with a keyway at its top: key_depth is the keyway's floor above the circle's top, mm (the hub's t2); of a shaft < 0."""
    radius = diameter / 2
    half = key_width / 2
    lean = math.acos(half / radius)
    foot = radius * math.sin(lean)
    top = radius + key_depth
    return Contour(
        (
            Arc(0j, radius, math.pi - lean, math.pi + 2 * lean),
            Line(complex(half, foot), complex(half, top)),
            Line(complex(half, top), complex(-half, top)),
            Line(complex(-half, top), complex(-half, foot)),
        )
    )


def arrowhead(centre: complex, size: float, direction: complex) -> Contour:
    """Triangle of circumscribed radius `size` pointing along `direction` (unit complex)."""
    return polygon([centre + size * direction * cmath.exp(2j * math.pi * k / 3) for k in range(3)])


def windows(
    rim: Points,
    hub: float,
    count: int,
    wall: float,
    obstacles: Sequence[tuple[complex, float]] = (),
) -> list[Contour]:
    """Up to `count` lightening windows (arc slots about the origin) that keep `wall` to everything around them.

    rim: (n,) complex polygon of the part's edge; hub: radius about the origin to keep clear (wall not yet added);
    obstacles: (centre, radius) discs to keep clear, such as pin holes. Each window is the set of points within a
    half width of an arc, so its wall is the distance of the obstacles from that arc less the half width: exact.
    A window that would be narrower than the wall is left out.
    """
    slots: list[Contour] = []
    if count == 0:
        return slots
    first = _direction(complex(rim[np.argmax(np.abs(rim))]))
    sector = math.pi / count
    radii = np.linspace(hub + wall, magnitude(rim), 48)[:, None, None]
    spreads = np.linspace(0, sector, 24)[None, :, None]
    # an edge of the rim comes nearer than its ends by at most this, since both are at least a wall away
    slack = magnitude(np.diff(rim, append=rim[:1])) ** 2 / (8 * wall)

    # distance of a window's end from the line half way to its neighbour, or to its own other end
    beside = np.minimum(sector - spreads, math.pi / 2)
    rib = (radii * np.sin(beside))[:, :, 0]

    def clearance(points: Points, direction: float) -> np.ndarray:
        local = points * cmath.exp(-1j * direction)
        along = np.clip(np.angle(local), -spreads, spreads)
        return np.asarray(np.abs(local - radii * np.exp(1j * along)))

    for k in range(count):
        direction = first + 2 * sector * k
        half = np.min(clearance(rim, direction), axis=2) - wall - slack
        half = np.minimum(half, (radii - hub - wall)[:, :, 0])
        half = np.minimum(half, rib - wall / 2)
        for centre, radius in obstacles:
            half = np.minimum(
                half, clearance(np.array([centre]), direction)[:, :, 0] - radius - wall
            )
        outside = radii[:, 0, 0] > np.min(
            np.where(
                np.abs(np.angle(rim * cmath.exp(-1j * direction))) < sector, np.abs(rim), np.inf
            )
        )
        half[outside] = -1
        area = np.where(
            half > wall / 2, 4 * half * (radii * spreads)[:, :, 0] + math.pi * half**2, -1
        )
        i, j = np.unravel_index(int(np.argmax(area)), area.shape)
        if area[i, j] < 0:
            continue
        radius = float(radii[i, 0, 0])
        spread = float(spreads[0, j, 0])
        width = float(half[i, j])
        if spread == 0:
            slots.append(circle(cmath.rect(radius, direction), width))
        else:
            slots.append(kidney(0j, radius, width, direction - spread, 2 * spread))
    return slots


def _direction(z: complex) -> float:
    """Phase of z, rad; cmath.phase raises OverflowError where the imaginary part is next to nothing, such as 5e-324."""
    return math.atan2(z.imag, z.real)


def hull(discs: Sequence[tuple[complex, float]]) -> Contour:
    """The band drawn tight round discs (centre, radius): a bar with two hubs, a bell crank; counter-clockwise.

    Arcs of the discs and the outer tangents between them; a disc inside another, or inside the band, leaves no trace,
    one of radius 0 a sharp corner.
    """
    # Of discs that reach a tangent alike, the one farthest along it is next, then the largest: the rest touch on the way.
    right = max(centre.real + radius for centre, radius in discs)
    tied = [
        k
        for k, (centre, radius) in enumerate(discs)
        if centre.real + radius >= right - 1e-12 * abs(right)
    ]
    start = here = max(tied, key=lambda k: (round(discs[k][0].imag, 9), discs[k][1]))
    angle = 0.0
    pieces: list[Line | Arc] = []
    while True:
        centre, radius = discs[here]
        leaving = [  # the angle at which another disc begins to reach as far
            (
                (_direction(other - centre) - math.acos((radius - r) / abs(other - centre)) - angle)
                % math.tau,
                k,
            )
            for k, (other, r) in enumerate(discs)
            if abs(radius - r) + SAME_POINT < abs(other - centre)
        ]
        first = min((sweep for sweep, _ in leaving), default=math.tau)
        sweep = min(first, math.tau - angle)
        if sweep > 1e-12 and radius:
            pieces.append(Arc(centre, radius, angle, sweep))
        angle += sweep
        round_once = angle >= math.tau - 1e-12
        if round_once and here == start:
            return Contour(tuple(pieces))
        normal = cmath.exp(1j * angle)
        tied = [start] if round_once else [k for sweep, k in leaving if sweep <= first + 1e-9]
        along = {k: round(((discs[k][0] - centre) / (1j * normal)).real, 9) for k in tied}
        here = max(tied, key=lambda k: (along[k], discs[k][1]))
        other, r = discs[here]
        pieces.append(Line(centre + radius * normal, other + r * normal))
        if round_once:
            return Contour(tuple(pieces))


def with_bar(
    edge: Contour,
    origin: complex,
    direction: complex,
    half: float,
    length: float,
    pointed: bool = False,
) -> Contour:
    """An edge of lines and arcs with a bar that sticks out of it: from the point `origin` inside so far along a unit vector, mm.

    half: half its width; its end is round and reaches so much further, or pointed and does not.
    ValueError where the edge is not as wide as the bar, or reaches further.
    """
    pieces = edge.counter_clockwise().pieces
    cuts = _sides(pieces, origin, direction, half)
    if max(cuts)[0] >= length:
        raise ValueError(f"the edge reaches further than a bar of {length:g} mm")
    (low, first, t), (high, last, s) = cuts
    rest = [
        pieces[(last + k) % len(pieces)]
        for k in range(1, (first - last) % len(pieces) or len(pieces))
    ]
    rest_of_edge = [
        part_between(pieces[last], s, pieces[last].t1),
        *rest,
        part_between(pieces[first], pieces[first].t0, t),
    ]
    if (
        first == last and (t - s) * (pieces[last].t1 - pieces[last].t0) > 0
    ):  # round from one side to the other
        rest_of_edge = [part_between(pieces[last], s, t)]
    straight = length - 2 * half * pointed
    tip, corner, end = (
        origin + z * direction for z in (length, straight - 1j * half, straight + 1j * half)
    )
    nose = (
        (Line(corner, tip), Line(tip, end))
        if pointed
        else (Arc(tip, half, _direction(direction) - math.pi / 2, math.pi),)
    )
    bar = (
        Line(origin + (low - 1j * half) * direction, corner),
        *nose,
        Line(end, origin + (high + 1j * half) * direction),
    )
    return Contour(
        (
            *(
                piece
                for piece in rest_of_edge
                if abs(piece.at(piece.t1) - piece.at(piece.t0)) > SAME_POINT
            ),
            *bar,
        )
    )


def root(edge: Contour, origin: complex, direction: complex, half: float) -> float:
    """How far along from the point `origin` a bar of so much half width comes out of the edge at the side where it is out first, mm:
    before 0 where a band lies slantwise. ValueError where the edge is not as wide as the bar."""
    return min(_sides(edge.counter_clockwise().pieces, origin, direction, half))[0]


def _sides(
    pieces: Sequence[Piece], origin: complex, direction: complex, half: float
) -> list[tuple[float, int, float]]:
    """Where the right and the left side of a bar come out of an edge: how far along, mm, which piece, and its parameter."""
    cuts = []
    for side in (-1, 1):
        crossings = [
            (u, k, t)
            for k, piece in enumerate(pieces)
            for u, t in _crossings(piece, origin, direction, side * half)
        ]
        if not crossings:
            raise ValueError(f"no edge as wide as a bar of {2 * half:g} mm")
        cuts.append(max(crossings))
    return cuts


def _crossings(
    piece: Piece, origin: complex, direction: complex, offset: float
) -> list[tuple[float, float]]:
    """Where a line or arc crosses a line beside `origin`: how far along that, mm, and the piece's parameter."""
    if isinstance(piece, Line):
        a = (piece.a - origin) / direction
        b = (piece.b - origin) / direction
        parameter = (offset - a.imag) / (b.imag - a.imag) if b.imag != a.imag else math.inf
        return [((a + parameter * (b - a)).real, parameter)] if 0 <= parameter <= 1 else []
    if not isinstance(piece, Arc):  # a track, of which no bar comes out
        return []
    centre = (piece.centre - origin) / direction
    rise = (offset - centre.imag) / piece.radius
    if abs(rise) > 1:
        return []
    crossings = []
    for angle in (math.asin(rise), math.pi - math.asin(rise)):
        angle_on = (
            (angle + _direction(direction) - piece.start) * math.copysign(1, piece.sweep) % math.tau
        )
        if angle_on <= abs(piece.sweep):
            crossings.append(
                (
                    centre.real + piece.radius * math.cos(angle),
                    piece.start + math.copysign(angle_on, piece.sweep),
                )
            )
    return crossings


def rod(name: str, title: str, diameter: float, length: float) -> Part:
    """A round pin, upright on its end; mm."""
    layer = Layer(Region(circle(0j, diameter / 2)), 0.0, length)
    return Part(name, title, (layer,), centres=(0j,))


def clearance(discs: Sequence[tuple[complex, float]], points: Points) -> np.ndarray:
    """Signed distance of points, (n,) complex, from the band `hull(discs)`, (n,) mm, negative inside.

    The greatest distance from the band's tangents: exact off its straight edges; round a hub 240 are tried, short by at
    most 1e-4 of the distance from its centre.
    """
    edges = [
        _direction(d) + side * math.acos((r - s) / abs(d))
        for z, r in discs
        for w, s in discs
        for side in (1, -1)
        if abs(d := w - z) > abs(r - s)
    ]
    normals = np.exp(1j * np.concatenate([np.arange(240) * (math.tau / 240), edges]))
    reach = np.max(
        [np.real(np.conj(normals) * centre) + radius for centre, radius in discs], axis=0
    )
    best = np.full(points.shape, -np.inf)
    for normal, far in zip(normals, reach, strict=True):
        np.maximum(best, points.real * normal.real + points.imag * normal.imag - far, out=best)
    return best


def drum_part(name: str, title: str, drum: Drum, hole: Contour) -> Part:
    """A drum with a hole along its axis, upright on its lower end; DesignError where its track cannot be made."""
    layers = tuple(
        Layer(Region(circle(0j, radius), (hole,)), low, high) for radius, low, high in drum.blank
    )
    widest = max(range(len(layers)), key=lambda k: drum.blank[k][0])
    return Part(name, title, layers, centres=(0j,), drawn_layer=widest, drum=drum)


def keyed_drum(name: str, title: str, drum: Drum, hole: Contour, key: Contour, top: float) -> Part:
    """A drum with a hole, on whose upper end stands a key up to a height; DesignError where its track cannot be made."""
    part = drum_part(name, title, drum, hole)
    stands = Layer(Region(key, (hole,)), drum.length, top)
    return replace(part, layers=(*part.layers, stands))


def drum_ring(name: str, title: str, drum: Drum, hole: Contour) -> Part:
    """A drum with a pocket, in whose floor is a hole; DesignError where its track cannot be made."""
    assert drum.pocket is not None, "a ring is open within its wall"
    edge = circle(0j, drum.outside)
    layers = (
        Layer(Region(edge, (hole,)), 0.0, drum.pocket),
        Layer(Region(edge, (circle(0j, drum.floor),)), drum.pocket, drum.length),
    )
    return Part(name, title, layers, centres=(0j,), drum=drum)
