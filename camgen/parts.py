"""Parts: stacks of extruded regions, and the shapes that machine parts are made of."""

from __future__ import annotations

import cmath
import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from camgen.outlines import Arc, Contour, Line, Points, Region, circle, kidney, polygon


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


@dataclass(frozen=True)
class Part:
    """One distinct part: `layers` of material, `engraved` layers taken away, and how many are needed.

    Frame: the part's own datum at the origin, z from 0 up. `centres` are the points that get a centre mark (complex, mm);
    `title` and `notes` are for people. bore: diameter of the hole on whose centre the part turns, None if it has none;
    min_wall: the thinnest wall that its designer accepts, mm.
    """

    name: str
    title: str
    layers: tuple[Layer, ...]
    count: int = 1
    engraved: tuple[Layer, ...] = ()
    centres: tuple[complex, ...] = ()
    notes: tuple[str, ...] = ()
    bore: float | None = None
    min_wall: float = 0.0

    @property
    def thickness(self) -> float:
        """Height of the part, mm."""
        return max(layer.z1 for layer in self.layers)

    @property
    def region(self) -> Region:
        """The region that a laser cuts: the lowest layer's."""
        return self.layers[0].region

    @property
    def volume(self) -> float:
        """Exact volume, mm^3, of layers that do not overlap less the engraving."""
        return sum(layer.volume for layer in self.layers) - sum(layer.volume for layer in self.engraved)


def d_bore(diameter: float, flat_depth: float) -> Contour:
    """Bore for a shaft with a flat: a circle about the origin whose top is cut off flat_depth below it, mm."""
    radius = diameter / 2
    height = radius - flat_depth
    lean = math.asin(height / radius)
    round_part = Arc(0j, radius, math.pi - lean, math.pi + 2 * lean)
    half = radius * math.cos(lean)
    return Contour((round_part, Line(complex(half, height), complex(-half, height))))


def keyed_bore(diameter: float, key_width: float, key_depth: float) -> Contour:
    """Bore with a keyway at its top: key_depth is the keyway's floor above the circle's top, mm (the hub's t2)."""
    radius, half = diameter / 2, key_width / 2
    lean = math.acos(half / radius)
    foot, top = radius * math.sin(lean), radius + key_depth
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


def windows(rim: Points, hub: float, count: int, wall: float, obstacles: Sequence[tuple[complex, float]] = ()) -> list[Contour]:
    """Up to `count` lightening windows (arc slots about the origin) that keep `wall` to everything around them.

    rim: (n,) complex polygon of the part's edge; hub: radius about the origin to keep clear (wall not yet added);
    obstacles: (centre, radius) discs to keep clear, such as pin holes. Each window is the set of points within a
    half width of an arc, so its wall is the distance of the obstacles from that arc less the half width: exact.
    A window that would be narrower than the wall is left out.
    """
    found: list[Contour] = []
    if count == 0:
        return found
    first = cmath.phase(complex(rim[np.argmax(np.abs(rim))]))
    sector = math.pi / count
    radii = np.linspace(hub + wall, float(np.max(np.abs(rim))), 48)[:, None, None]
    spreads = np.linspace(0, sector, 24)[None, :, None]
    # an edge of the rim comes nearer than its ends by at most this, since both are at least a wall away
    slack = float(np.max(np.abs(np.diff(rim, append=rim[:1])))) ** 2 / (8 * wall)

    def clearance(points: Points, direction: float) -> np.ndarray:
        local = points * cmath.exp(-1j * direction)
        along = np.clip(np.angle(local), -spreads, spreads)
        return np.asarray(np.abs(local - radii * np.exp(1j * along)))

    for k in range(count):
        direction = first + 2 * sector * k
        half = np.min(clearance(rim, direction), axis=2) - wall - slack
        half = np.minimum(half, (radii - hub - wall)[:, :, 0])
        if count > 1:  # ribs of one wall between neighbours
            half = np.minimum(half, (radii * np.sin(sector - spreads))[:, :, 0] - wall / 2)
        for centre, radius in obstacles:
            half = np.minimum(half, clearance(np.array([centre]), direction)[:, :, 0] - radius - wall)
        outside = radii[:, 0, 0] > np.min(
            np.where(np.abs(np.angle(rim * cmath.exp(-1j * direction))) < sector, np.abs(rim), np.inf)
        )
        half[outside] = -1
        area = np.where(half > wall / 2, 4 * half * (radii * spreads)[:, :, 0] + math.pi * half**2, -1)
        i, j = np.unravel_index(int(np.argmax(area)), area.shape)
        if area[i, j] < 0:
            continue
        radius, spread, width = float(radii[i, 0, 0]), float(spreads[0, j, 0]), float(half[i, j])
        if spread == 0:
            found.append(circle(cmath.rect(radius, direction), width))
        else:
            found.append(kidney(0j, radius, width, direction - spread, 2 * spread))
    return found
