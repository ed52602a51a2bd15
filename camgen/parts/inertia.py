"""Moments of inertia and centres of parts, from their exact outlines."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from camgen.geometry.facets import facet_contour
from camgen.geometry.mesh import Mesh
from camgen.geometry.outlines import Contour
from camgen.machine.balancing import together
from camgen.machine.features import Mount
from camgen.machine.model import MM, Body
from camgen.numerics import Floats
from camgen.parts import materials
from camgen.parts.part import Part
from camgen.spec import Material

_SHOWN = ("dummy",)  # how parts are made that stand for others and weigh nothing here


def inertia_of(part: Part, density: float) -> float:
    """Moment of inertia of a part about its origin's upright axis, kg m^2; density in kg/m^3. Engraving counts.

    By polygons that follow the outlines within 0.01 mm, so right to about 1e-3.
    """
    whole = 0.0 if part.drum is None else part.drum.moments.polar
    whole += sum(height * _polar(contour) for height, contour in _contours(part))
    return density * MM**5 * whole


def centre_of(part: Part) -> complex:
    """Centre of a part's volume in the plane, complex mm in its frame; by the same polygons."""
    total = 0j if part.drum is None else part.drum.moments.first
    weight = 0.0 if part.drum is None else part.drum.moments.volume
    for height, contour in _contours(part):
        z = facet_contour(contour, 0.01)
        w = np.roll(z, -1)
        cross = np.imag(np.conj(z) * w)
        total += height * complex(np.sum(cross * (z + w))) / 6
        weight += height * float(np.sum(cross)) / 2
    return total / weight


@dataclass(frozen=True)
class Solids:
    """What is made of a machine, as its masses follow from it."""

    parts: Sequence[Part]
    mounts: Sequence[Mount]  # every copy of them on the machine's bodies
    density: float  # kg/m^3, of what is printed

    @cached_property
    def by_name(self) -> Mapping[str, Part]:
        """Its parts by their names."""
        return {part.name: part for part in self.parts}

    def density_of(self, part: Part) -> float:
        """Of one of its parts, kg/m^3."""
        return self.density if part.process == "printed" else 1e3 * materials.STEEL.density

    def weighs(self, part: Part) -> bool:
        """Whether a part is more than shown."""
        return part.process not in _SHOWN

    def body(self, body: Body) -> Body:
        """The body with mass, centre and inertia of all that is mounted on it."""
        masses = []
        for mount in self.mounts:
            part = self.by_name.get(mount.part)
            if mount.body != body.name or part is None or not self.weighs(part):
                continue
            heavy = self.density_of(part)
            mass = part.volume * heavy * MM**3
            centre = centre_of(part)
            inertia = inertia_of(part, heavy) - mass * abs(centre * MM) ** 2
            masses.append(Body(part.name, mass=mass, centre=mount.place(centre), inertia=inertia))
        return together(replace(body, mass=0.0, inertia=0.0), *masses)


@dataclass(frozen=True, eq=False)
class MassMoments:
    """A mass in space: kg, its centre (3,) mm, and its second moments about the centre, (3, 3) kg mm^2: the sum of m r r^T."""

    mass: float
    centre: Floats
    second: Floats

    @property
    def tensor(self) -> Floats:
        """Moments and products of inertia about the centre, (3, 3) kg mm^2."""
        return np.asarray(np.trace(self.second) * np.eye(3) - self.second)

    def fitted(self, body: Body) -> MassMoments:
        """With the mass, centre and inertia that a body has in the plane; across it as it is, by share of the mass.

        A body of which nothing is made is a flat ring.
        """
        inertia = body.inertia / MM**2
        centre = np.array([body.centre.real, body.centre.imag, self.centre[2]])
        polar = self.second[0, 0] + self.second[1, 1]
        if not (self.mass and polar):
            return MassMoments(body.mass, centre, np.diag([inertia / 2, inertia / 2, 0.0]))
        plane = np.sqrt(inertia / polar)
        scale = np.array([plane, plane, np.sqrt(body.mass / self.mass)])
        return MassMoments(body.mass, centre, self.second * np.outer(scale, scale))


def mass_moments(mesh: Mesh, density: float) -> MassMoments:
    """Those of a closed mesh, density in kg/m^3: the sum over the tetrahedra from its faces to a point within it."""
    middle = mesh.vertices.mean(axis=0)
    corners = mesh.vertices[mesh.faces] - middle
    volumes = np.sum(corners[:, 0] * mesh.across, axis=1) / 6
    total = corners.sum(axis=1)
    mass = density * MM**3 * float(np.sum(volumes))
    first = np.sum(volumes[:, None] * total, axis=0) / 4 / np.sum(volumes)
    outer = np.sum(corners[:, :, :, None] * corners[:, :, None, :], axis=1)
    outer += total[:, :, None] * total[:, None, :]
    second = density * MM**3 * np.sum(volumes[:, None, None] * outer, axis=0) / 20
    return MassMoments(mass, middle + first, second - mass * np.outer(first, first))


def masses_together(masses: Sequence[MassMoments]) -> MassMoments:
    """Several masses as one."""
    total = sum(each.mass for each in masses)
    if not total:
        return MassMoments(0.0, np.zeros(3), np.zeros((3, 3)))
    centre = sum((each.mass * each.centre for each in masses), np.zeros(3)) / total
    second = np.zeros((3, 3))
    for each in masses:
        off = each.centre - centre
        second = second + each.second + each.mass * np.outer(off, off)
    return MassMoments(total, centre, second)


def printed_density(material: Material) -> float:
    """Of what is made of it, kg/m^3, its filling as it is."""
    return 1e3 * (material.density or materials.of(material.name).density) * material.infill


def _contours(part: Part) -> Iterator[tuple[float, Contour]]:
    """Every contour, counter-clockwise, and how high it is extruded, mm, below 0 where that takes material away; of a drum its
    holes."""
    for sign, layers in ((1, part.layers), (-1, part.engraved)):
        for layer in layers:
            blank = part.drum is not None and layer is not part.key
            outer = [] if blank else [(1, layer.region.outer)]
            for side, contour in (*outer, *((-1, hole) for hole in layer.region.holes)):
                yield sign * side * (layer.z1 - layer.z0), contour.counter_clockwise()


def _polar(contour: Contour) -> float:
    """Second moment of the area inside a counter-clockwise contour about the origin, mm^4 (Green's theorem)."""
    z = facet_contour(contour, 0.01)
    w = np.roll(z, -1)
    dot = np.abs(z) ** 2 + np.abs(w) ** 2 + np.real(np.conj(z) * w)
    return float(np.sum(np.imag(np.conj(z) * w) * dot)) / 12
