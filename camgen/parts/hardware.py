"""Machine parts as stacks of extruded outlines: plates with named holes, links, pins, shafts, collets, washers.

    rounded   outline drawn tight round discs: a positive radius is a corner of the material, a negative one a fillet
    plate     an outline with named holes whose walls are checked, so that a fault names what meets what
    fit       diametral: a hole is its shaft's diameter plus the fit

Every shape says in its docstring where its origin is; z runs from 0 up. DesignError where a wall falls under the limit.
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np

from camgen.errors import DesignError
from camgen.geometry.distances import inside, point_to_ring, thinnest_wall
from camgen.geometry.facets import facet_contour
from camgen.geometry.outlines import Arc, Contour, Line, Points, Region, circle
from camgen.numerics import coordinates
from camgen.parts.part import Layer, Part
from camgen.tolerances import SAME_POINT

FACETS = 0.01  # mm, on which walls are measured; they are judged again on the written files
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
    rings = {
        hole: facet_contour(c, min(FACETS, 0.01 * math.sqrt(abs(c.area))))
        for hole, c in holes.items()
    }
    rim = facet_contour(outer, FACETS)
    _check_simple(name, rim)
    if thinnest_wall(rim, list(rings.values())) < min_wall:
        walls = {("edge", hole): thinnest_wall(rim, [ring]) for hole, ring in rings.items()}
        for a, b in combinations(rings, 2):
            walls[a, b] = min(thinnest_wall(rim, [rings[a], rings[b]]), math.inf)
        (a, b), wall = min(walls.items(), key=lambda item: item[1])
        raise DesignError(
            f"wall of the {name}",
            wall,
            min_wall,
            "mm",
            (a, b),
            "they meet or lie outside"
            if wall <= 0
            else "make room between them or lower the wall that is asked for",
        )
    return Region(outer, tuple(holes.values()))


def refuse_thin(link: str, outline: Contour, holes: Mapping[str, Contour], min_wall: float) -> None:
    """DesignError for the hole of a joint that leaves less than min_wall, mm, to a link's own outline, or lies outside of it."""
    rim = facet_contour(outline, FACETS)
    for name, hole in holes.items():
        ring = facet_contour(hole, FACETS)
        off = point_to_ring(ring, rim)
        wall = float(np.min(np.where(inside(ring, rim), off, -off)))
        if wall < min_wall:
            remedy = f"draw the edge {min_wall - wall:.3g} mm farther out there"
            if not inside(ring, rim).any():
                remedy = (
                    f"the hole lies outside the outline: see parts.{link}.outline_at, the drawing's scale, and whether y "
                    "points up in it"
                )
            where = f"link {link}"
            quantity = f"wall between {name} and parts.{link}.outline"
            raise DesignError(quantity, wall, min_wall, "mm", where, remedy)


def _check_simple(name: str, rim: Points) -> None:
    """Raise DesignError where an edge crosses itself."""
    import shapely

    reason = shapely.is_valid_reason(shapely.Polygon(coordinates(rim)))
    if reason != "Valid Geometry":
        place = reason.replace("[", " at (").replace("]", ") mm")
        message = f"the edge of the {name} crosses itself: {place}"
        raise DesignError(
            f"crossings in the edge of the {name}",
            1,
            0,
            "",
            place,
            "its sizes do not go together",
        ).saying(message)


# ---- shaft and axles -------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Collet:
    """A slit sleeve on a flange and the ring that is pushed over it, both tapered 1 : 20, for a plain shaft; mm.

    The taper is a stack of steps of 0.05 mm, which a printer makes of any taper. The ring first touches with `travel`
    left to go; pushed home it closes the sleeve by travel / 10 in diameter, which must be more than the fit.
    """

    shaft: float  # diameter
    fit: float  # of the bore
    wall: float  # of the sleeve at its thin end, and of the ring
    length: float  # of the sleeve
    flange: float  # thickness
    flange_diameter: float
    pins: tuple[tuple[complex, float], ...] = ()  # places and hole diameters in the flange
    slits: int = 4
    slit: float = 1.0  # width

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
        return (
            (self.shaft + self.fit) / 2
            + self.wall
            + (self.steps - 1 - step) * _TAPER * self.length / self.steps
        )

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
        holes = {"bore": circle(0j, bore)} | {
            f"pin {k + 1}": circle(z, d / 2) for k, (z, d) in enumerate(self.pins)
        }
        for k, (z, d) in enumerate(self.pins):
            gap = abs(z) - d / 2 - self.radius
            if gap < -SAME_POINT:
                raise DesignError(
                    "gap beside the collet's sleeve",
                    gap,
                    0,
                    "mm",
                    f"pin {k + 1}",
                    "use a smaller collet.wall",
                )
        if self._radius(0) + self.wall > self.flange_diameter / 2:
            raise DesignError(
                "flange of the collet",
                self.flange_diameter,
                self.ring_diameter,
                "mm",
                "",
                "the ring needs a wider flange",
            )
        between = math.tau / self.slits - 2 * math.asin(min(1.0, self.slit / 2 / bore))
        if between * bore < min_wall:
            raise DesignError(
                "finger of the collet",
                between * bore,
                min_wall,
                "mm",
                ("one slit", "the next"),
                "use fewer or narrower slits",
            )
        if self.wall < min_wall:
            raise DesignError(
                "wall of the collet", self.wall, min_wall, "mm", "thin end", "use a thicker wall"
            )
        region = plate("collet's flange", circle(0j, self.flange_diameter / 2), holes, min_wall)
        layers = [Layer(region, 0.0, self.flange)]
        rise = self.length / self.steps
        for step in range(self.steps):
            z = self.flange + step * rise
            for k in range(self.slits):
                finger = _sector(
                    bore,
                    self._radius(step),
                    self.slit,
                    math.tau * k / self.slits,
                    math.tau * (k + 1) / self.slits,
                )
                layers.append(Layer(Region(finger), z, z + rise))
        return Part(
            "collet",
            "Collet",
            tuple(layers),
            centres=(0j, *(z for z, _ in self.pins)),
            notes=("pinned and glued on the upper cam",),
            bore=2 * bore,
            min_wall=min_wall,
        )

    def ring(self) -> Part:
        """The clamp ring, wide end down; the origin is its axis."""
        rise = self.length / self.steps
        first = round(self.travel * self.steps / self.length)
        if first >= self.steps:
            raise DesignError(
                "travel of the clamp ring",
                self.travel,
                self.length,
                "mm",
                "",
                "use a longer sleeve or a closer fit of the bore",
            )
        outer = circle(0j, self.ring_diameter / 2)
        layers = tuple(
            Layer(Region(outer, (circle(0j, self._radius(step)),)), k * rise, (k + 1) * rise)
            for k, step in enumerate(range(first, self.steps))
        )
        return Part(
            "clamp-ring",
            "Clamp ring",
            layers,
            centres=(0j,),
            bore=2 * self._radius(first),
            min_wall=self.wall,
            notes=("wide end first over the collet, pushed home",),
        )


def _sector(inner: float, outer: float, slit: float, start: float, end: float) -> Contour:
    """Finger between two slits of parallel walls whose middles lie at the angles start and end, rad."""
    lean = math.asin(slit / 2 / outer)
    low = math.asin(slit / 2 / inner)
    rim = Arc(0j, outer, start + lean, end - start - 2 * lean)
    bore = Arc(0j, inner, end - low, -(end - start - 2 * low))
    corners = [complex(piece.at(t)) for piece in (rim, bore) for t in (piece.t0, piece.t1)]
    return Contour((rim, Line(corners[1], corners[2]), bore, Line(corners[3], corners[0])))


def headed(
    name: str, title: str, diameter: float, length: float, head_diameter: float, head: float
) -> Part:
    """A round pin or axle, printed head down: so long above its head, which is so wide and high, mm."""
    if not head_diameter > diameter:
        raise DesignError(
            f"head of {name}",
            head_diameter,
            diameter,
            "mm",
            "",
            "it holds nothing: make it wider than the shank",
        )
    layers = (
        Layer(Region(circle(0j, head_diameter / 2)), 0.0, head),
        Layer(Region(circle(0j, diameter / 2)), head, head + length),
    )
    return Part(name, title, layers, centres=(0j,), drawn_layer=1)


def grooved(pin: Part, groove: float) -> Part:
    """A headed pin with a shoulder as wide and high as its head: between both a groove so high, mm."""
    head, shank = pin.layers
    bottom = head.z1 + groove
    top = bottom + head.z1
    layers = (
        head,
        Layer(shank.region, head.z1, bottom),
        Layer(head.region, bottom, top),
        Layer(shank.region, top, shank.z1),
    )
    return replace(pin, layers=layers, drawn_layer=3)


def spacer(
    name: str, title: str, bore: float, diameter: float, thickness: float, min_wall: float
) -> Part:
    """A washer; the origin is its axis."""
    region = plate(name, circle(0j, diameter / 2), {"bore": circle(0j, bore / 2)}, min_wall)
    return Part(
        name, title, (Layer(region, 0.0, thickness),), centres=(0j,), bore=bore, min_wall=min_wall
    )
