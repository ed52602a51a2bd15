"""Flat sections of a body as its file has them, as areas in the plane; and plates of bodies that lie ready to print.

slab      a body's flat section between two heights
disc      an area that is round but for its facets
"""

from __future__ import annotations

import functools
import itertools
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from camgen.files.threemf import read_3mf
from camgen.findings import Finding, at_least, at_most, in_file
from camgen.geometry.mesh import Mesh, slice_mesh
from camgen.geometry.rings import Floats, Points, Ring, fit_circle
from camgen.numerics import coordinates, magnitude
from camgen.tolerances import FLOAT32_ROUNDING

if TYPE_CHECKING:
    import shapely

ROUND = 0.002  # mm, how far an outline may lie from a circle and count as one
FACETS = 0.001  # mm, chord tolerance of arcs
PLANE = np.array([1, 1j])  # coordinates to complex numbers
_SAME_AREA = 1e-9  # share by which areas may differ for rounding


@dataclass(frozen=True)
class Slab:
    """Flat section between the heights z0 and z1 of a body's own frame, mm; inside is what an odd number of rings encloses."""

    z0: float
    z1: float
    rings: tuple[Ring, ...]


def slabs_of(mesh: Mesh) -> tuple[Slab, ...]:
    """A mesh as slabs between its distinct heights; a slanted wall counts with its whole shadow.

    ValueError where a section does not close, or crosses itself.
    """
    import shapely

    size = magnitude(mesh.vertices)
    heights = np.unique(mesh.vertices[:, 2])
    heights = heights[np.append(np.diff(heights) > 8 * FLOAT32_ROUNDING * size, True)]
    corners = mesh.vertices[mesh.faces]
    low = corners[:, :, 2].min(axis=1)
    high = corners[:, :, 2].max(axis=1)
    ab, ac = (corners[:, k, :2] - corners[:, 0, :2] for k in (1, 2))
    longest = (np.abs(ab) + np.abs(ac)).max(axis=1)
    flat = (
        np.abs(ab[:, 0] * ac[:, 1] - ab[:, 1] * ac[:, 0]) <= 8 * FLOAT32_ROUNDING * size * longest
    )
    slabs = []
    for z0, z1 in itertools.pairwise(heights.tolist()):
        rings = slice_mesh(mesh, (z0 + z1) / 2)
        slanted = corners[~flat & (low < z1) & (high > z0) & (high > low)]
        if len(slanted):
            shadows = _shadows(slanted, z0, z1)
            rings = _rings(shapely.union_all([area_of(rings), *shadows[shapely.area(shadows) > 0]]))
        if rings:
            slabs.append(Slab(z0, z1, tuple(rings)))
    return tuple(slabs)


def _shadows(corners: Floats, z0: float, z1: float) -> Any:
    """Projections of triangles' parts between two heights, (n,) areas; corners: (n, 3, 3)."""
    import shapely

    points = [corners]
    masks = [(z0 <= corners[:, :, 2]) & (corners[:, :, 2] <= z1)]
    for i, j in itertools.combinations(range(3), 2):
        a = corners[:, i]
        b = corners[:, j]
        rise = b[:, 2] - a[:, 2]
        for z in (z0, z1):
            points.append(
                (a + ((z - a[:, 2]) / np.where(rise == 0, 1, rise))[:, None] * (b - a))[:, None]
            )
            masks.append(((a[:, 2] - z) * (b[:, 2] - z) < 0)[:, None])
    mask = np.concatenate(masks, axis=1)
    return shapely.convex_hull(
        shapely.multipoints(
            np.concatenate(points, axis=1)[mask][:, :2], indices=np.nonzero(mask)[0]
        )
    )


def area_of(rings: Sequence[Ring]) -> Any:
    """What an odd number of rings encloses, as a shapely area; ValueError where one crosses itself so that none can say."""
    import shapely

    faces = [shapely.Polygon(coordinates(z)) for z in (ring.facetted(FACETS) for ring in rings)]
    try:
        return functools.reduce(shapely.symmetric_difference, faces)
    except shapely.errors.GEOSException as error:
        raise ValueError(f"a section crosses itself: {error}") from None


def _rings(area: Any) -> list[Ring]:
    import shapely

    loops = [part for face in shapely.get_parts(area) for part in (face.exterior, *face.interiors)]
    points = [shapely.get_coordinates(loop)[:-1] @ PLANE for loop in loops]
    return [Ring.straight(z) for z in points]


def disc_about(area: Any) -> tuple[complex, float] | None:
    """Centre and radius of the disc about an area, where the area is that disc but for its facets."""
    import shapely

    if (
        area.is_empty
        or shapely.get_num_geometries(area) != 1
        or shapely.get_num_interior_rings(shapely.get_geometry(area, 0))
    ):
        return None
    z = shapely.get_coordinates(area)[:-1] @ PLANE
    centre, _, _ = fit_circle(z)
    radius = magnitude(z - centre)
    inside = float(shapely.boundary(area).distance(shapely.Point(centre.real, centre.imag)))
    return (complex(centre), radius) if radius - inside <= ROUND else None


# Motion of a body: (n,) rad -> angle (n,) rad and position (n,) complex mm; ground = position + exp(i angle) z.
Course = Callable[[Floats], tuple[Floats, Points]]


def still(theta: Floats) -> tuple[Floats, Points]:
    """The course of what stands still."""
    return np.zeros(theta.shape), np.zeros(theta.shape, complex)


@dataclass(frozen=True)
class Body:
    """A stack of slabs on a course: course's frame = at + body; z: height of the slabs' zero in the assembly, mm."""

    name: str
    slabs: tuple[Slab, ...]
    course: Course = still
    z: float = 0.0
    at: complex = 0j


# ---- sections as mounted ---------------------------------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class Section:
    """A slab as mounted: heights in the assembly and shapely area in the course's frame.

    disc: centre and radius where the area is one; facets: how far the area may be from the arcs that it stands for, mm.
    """

    z0: float
    z1: float
    area: shapely.Geometry
    disc: tuple[complex, float] | None
    facets: float


def sections_of(body: Body) -> list[Section]:
    """The slabs of a body as mounted."""
    sections = []
    for slab in body.slabs:
        rings = [ring.moved(1, body.at) for ring in slab.rings]
        area = area_of(rings)
        facets = FACETS if any(ring.bulges.any() for ring in rings) else 0.0
        sections.append(Section(body.z + slab.z0, body.z + slab.z1, area, disc_about(area), facets))
    return sections


@functools.lru_cache(maxsize=8)  # a section meets many others, one after the other
def shrunk(section: Section, by: float) -> Any:
    """The area less all that is nearer than this to its edge, mm."""
    return section.area.buffer(-by) if by else section.area


def covered(section: Section, other: Section) -> bool:
    """Whether all of a section lies in another one."""
    import shapely

    return section is other or (
        section.facets <= other.facets and bool(shapely.covers(other.area, section.area))
    )


@functools.lru_cache(maxsize=128)  # a stack passes by several others
def shadow_of(sections: tuple[Section, ...]) -> Section:
    """All that sections cover, as one."""
    import shapely

    area = shapely.union_all([section.area for section in sections])
    facets = max(section.facets for section in sections)
    return Section(0.0, 0.0, area, disc_about(area), facets)


def plan_of(mesh: Mesh) -> Any:
    """What a solid covers as seen from above, a geometry: all its triangles that face upwards."""
    import shapely

    corners = mesh.vertices[mesh.faces[mesh.across[:, 2] > 0]]
    up = shapely.polygons(corners[:, :, :2])
    try:  # side by side, as those of a plain stack are: a fifteenth of the time
        plan = shapely.coverage_union_all(up)
    except shapely.errors.GEOSException:
        return shapely.union_all(up)
    beside = abs(plan.area - float(np.sum(shapely.area(up)))) <= _SAME_AREA * plan.area
    return plan if beside and plan.is_valid else shapely.union_all(up)


# ---- a plate ready to print ------------------------------------------------------------------------------------------


def judge_plate(
    path: Path, bed: tuple[float, float], gap: float, margin: float = 0.0
) -> list[Finding]:
    """A plate file as read back: every body stands on z = 0, inside the bed (its corner at the origin) less its margin, mm, and
    `gap` from the others.

    Bodies count with their whole shadow.
    """
    import shapely

    package = read_3mf(path)
    where = in_file(path)
    meshes = [item.placed for item in package.items]
    rounding = 8 * FLOAT32_ROUNDING * max(bed)
    lift = max((abs(float(mesh.vertices[:, 2].min())) for mesh in meshes), default=math.nan)
    places = [mesh.vertices[:, :2] for mesh in meshes]
    overhang = (
        max(
            (float(max(-xy.min(), (xy - np.array(bed)).max(), -margin)) for xy in places),
            default=math.nan,
        )
        + margin
    )
    bodies = "1 body extends" if len(meshes) == 1 else f"{len(meshes)} bodies extend"
    remark = f"how far {bodies} beyond the bed of {bed[0]:g} x {bed[1]:g} mm"
    remark += f", {margin:g} mm of its rim left free" if margin else ""
    findings = [
        at_most("BED_FIT", overhang, rounding, "mm", where, remark),
        at_most(
            "BED_FIT", lift, rounding, "mm", where, "how far a body is off the bed's plane z = 0"
        ),
    ]
    if len(meshes) > 1:
        shadows = [plan_of(mesh) for mesh in meshes]
        near = shapely.STRtree(shadows).query_nearest(
            shadows, exclusive=True, all_matches=False, return_distance=True
        )[1]
        remark = "smallest gap between bodies on the plate"
        findings.append(at_least("BED_FIT", float(near.min()), gap - rounding, "mm", where, remark))
    return findings
