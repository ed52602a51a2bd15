"""Ready to print: all copies of all parts laid on as few beds as it takes.

    side        a direction of the part that is turned down: the one that carries most and overhangs least
    contact     area that lies on the bed
    overhang    area, seen from below, of what leans outwards by more than 45 deg and does not lie on the bed: it needs supports
    footprint   the smallest rectangle, turned as it likes, about a part seen from above
    plate       one bed full of copies, written as one 3MF file

Rectangles are packed by rectpack (maximal rectangles, best short side first; Jylanki 2010) in whole micrometres, so the
same parts give the same plates.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import lru_cache
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING

import numpy as np

from camgen.findings import Finding, Where, at_most
from camgen.geometry.mesh import Mesh
from camgen.geometry.outlines import Floats, Points
from camgen.numerics import coordinates
from camgen.parts.part import Part

if TYPE_CHECKING:
    from camgen.files.threemf import PartCopy

_STEEP = np.cos(np.radians(45)) + 1e-6  # a chamfer of 45 deg prints
_FLAT = 1e-3  # mm, by which a face that lies on the bed may be off it
_CLEARLY = (
    0.01  # of the contact, by which another side has to be better than the part's own underside
)
_TRIED = 12  # flat sides beyond the six along the axes
_AT_ONCE = 20_000  # points of a hull that are turned at once
_UNIT = 0.001  # mm in which rectangles are packed
_SPARE = 0.001  # mm, by which a gap is made wider than asked for: a file's numbers are rounded


# ---- the side to lie on ------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Side:
    """A side to lie on."""

    name: str = "as drawn"
    contact: float = 0.0  # mm^2
    overhang: float = 0.0  # mm^2
    height: float = 0.0  # of the part as it lies, mm
    turn: Floats = field(default_factory=lambda: np.eye(3), compare=False)  # (3, 3), brings it down

    @property
    def worth(self) -> float:
        """Contact less overhang, mm^2."""
        return self.contact - self.overhang


def side(mesh: Mesh, down: Floats) -> Side:
    """The part lying with the direction `down`, a unit vector (3,) of its frame, towards the bed."""
    areas = mesh.across / 2
    shadows = areas @ down  # from below, mm^2; above 0 where a face looks down
    depth = mesh.vertices @ down
    lying = np.all(depth[mesh.faces] > np.max(depth) - _FLAT, axis=1) & (shadows > 0)
    leaning = ~lying & (shadows > _STEEP * np.linalg.norm(areas, axis=1))
    return Side(
        _name(down),
        float(shadows[lying].sum()),
        float(shadows[leaning].sum()),
        float(np.ptp(depth)),
        _turn(down),
    )


@lru_cache(maxsize=128)  # who lists parts, lays them out and judges plates asks for the same solids
def lying_side(mesh: Mesh) -> Side:
    """The side whose contact exceeds its overhang by most; the part's own underside unless another one is clearly better."""
    underside = side(mesh, np.array([0.0, 0.0, -1.0]))
    areas = mesh.across / 2
    areas = areas[np.any(areas != 0, axis=1)]
    sizes = np.linalg.norm(areas, axis=1)
    steps = (
        np.rint(areas / sizes[:, None] * 1000).astype(np.int64) + 1000
    )  # 0 to 2000, each normal one number of three digits
    _, first, index = np.unique(
        steps @ np.array([2001**2, 2001, 1]), return_index=True, return_inverse=True
    )
    normals = (steps[first] - 1000) / 1000
    whole = np.bincount(index, sizes)
    largest = np.argsort(-whole, kind="stable")[:_TRIED]
    flat = normals[
        largest[whole[largest] > underside.worth]
    ]  # of a smaller one no more than its area can lie on the bed
    downs = [*np.eye(3), *-np.eye(3)[:2], *(n / np.linalg.norm(n) for n in flat)]
    best = max((side(mesh, down) for down in downs), key=lambda each: round(each.worth, 3))
    return (
        best
        if best.worth > underside.worth + _CLEARLY * max(underside.contact, best.contact)
        else underside
    )


def _name(down: Floats) -> str:
    """What people call it."""
    axis = int(np.argmax(np.abs(down)))
    if abs(down[axis]) < 1 - 1e-9:
        return f"on the side towards ({down[0]:.3g}, {down[1]:.3g}, {down[2]:.3g})"
    if axis == 2:
        return "as drawn" if down[2] < 0 else "turned over"
    return f"on its side towards {'-' if down[axis] < 0 else '+'}{'xy'[axis]}"


def _turn(down: Floats) -> Floats:
    """The rotation (3, 3) for column vectors that brings `down` to -z; what looks up is turned over about y first."""
    if down[2] > 0:
        over = np.diag([-1.0, 1.0, -1.0])
        return np.asarray(_turn(over @ down) @ over) + 0.0
    across = np.cross(down, [0.0, 0.0, -1.0])
    cross = np.array(
        [[0, -across[2], across[1]], [across[2], 0, -across[0]], [-across[1], across[0], 0]]
    )
    return np.asarray(np.eye(3) + cross + cross @ cross / (1 - down[2])) + 0.0


# ---- plates ------------------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Footprint:
    """Smallest rectangle about a part: turned by angle (rad) the part fills width x height mm about `centre` (turned frame)."""

    angle: float
    width: float
    height: float
    centre: complex


@dataclass(frozen=True)
class Spot:
    """Place of one copy: laid on a side by turn (3, 3), turned by angle (rad), moved to position (complex mm, bed's corner at 0)
    and height z."""

    part: str
    copy: int
    angle: float
    position: complex
    z: float
    turn: Floats = field(default_factory=lambda: np.eye(3), compare=False)


@dataclass(frozen=True)
class Layout:
    """Plates with their spots, and one BED_FIT finding per part, which fails for one that is larger than the bed."""

    plates: tuple[tuple[Spot, ...], ...]
    findings: tuple[Finding, ...]


def footprint(points: Points, bed: tuple[float, float]) -> Footprint:
    """Smallest rectangle about the points, (n,) complex mm; where that one does not fit the bed, one that does if there is any.

    The smallest one shares a side with the convex hull; others are tried in steps of one degree.
    """
    import shapely

    cloud = shapely.multipoints(coordinates(points))
    hull = shapely.get_coordinates(shapely.convex_hull(cloud)) @ np.array([1, 1j])
    sides = np.diff(hull)
    rectangles = _framed(
        hull, -np.angle(sides[np.abs(sides) > 0]) if np.any(sides) else np.zeros(1)
    )
    best = min(rectangles, key=lambda f: (round(f.width * f.height, 6), round(f.angle, 9)))
    if _fits(best, bed):
        return best
    rectangles += _framed(hull, np.radians(np.arange(180)))
    fitting = [f for f in rectangles if _fits(f, bed)]
    return min(fitting, key=lambda f: f.width * f.height) if fitting else best


def _framed(hull: Points, angles: Floats) -> list[Footprint]:
    """Rectangles about a hull, (n,) complex mm, turned by each angle, (m,) rad."""
    rectangles = []
    for part in np.array_split(angles, math.ceil(len(angles) * len(hull) / _AT_ONCE)):
        z = np.exp(1j * part)[:, None] * hull
        low = z.real.min(axis=1) + 1j * z.imag.min(axis=1)
        high = z.real.max(axis=1) + 1j * z.imag.max(axis=1)
        for angle, a, b in zip(part.tolist(), low.tolist(), high.tolist(), strict=True):
            rectangles.append(Footprint(angle, (b - a).real, (b - a).imag, (a + b) / 2))
    return rectangles


def _fits(f: Footprint, bed: tuple[float, float]) -> bool:
    return min(f.width, f.height) <= min(bed) and max(f.width, f.height) <= max(bed)


def bed_fit(
    name: str, count: int, vertices: Floats, bed: tuple[float, float], height: float = math.inf
) -> tuple[Footprint, Finding]:
    """Footprint of a part's vertices, (n, 3) mm, and BED_FIT: how far it stands out over the bed, or its height, at its best."""
    f = footprint(vertices[:, 0] + 1j * vertices[:, 1], bed)
    tall = float(np.ptp(vertices[:, 2]))
    beyond = max(
        min(f.width, f.height) - min(bed), max(f.width, f.height) - max(bed), tall - height, 0.0
    )
    copies = "" if count == 1 else f", each of {count} copies,"
    size = f"{f.width:.1f} x {f.height:.1f} mm, {tall:.1f} mm high"
    tallest = f", print.bed_height {height:g} mm" if math.isfinite(height) else ""
    keys = "print.bed has" if math.isfinite(height) else "the bed has"
    remark = f"the part{copies} takes {size}; {keys} room for {bed[0]:g} x {bed[1]:g} mm{tallest}"
    return f, at_most("BED_FIT", beyond, 0.0, "mm", Where(part=name), remark)


def within(bed: tuple[float, float], margin: float | None) -> tuple[float, float]:
    """Width and depth of a bed, mm, less a margin all round; never below 0."""
    return max(bed[0] - 2 * (margin or 0.0), 0.0), max(bed[1] - 2 * (margin or 0.0), 0.0)


def laid_out(
    parts: Sequence[Part],
    meshes: Mapping[str, Mesh],
    bed: tuple[float, float],
    gap: float,
    sides: Mapping[str, Side] = MappingProxyType({}),
    margin: float | None = None,
) -> Layout:
    """All copies of the parts on as many beds as it takes, `gap` mm apart, each bed's contents in its middle.

    meshes, sides: by part name, in the part's frame, and on which side it lies, as drawn unless said. A part that fits no bed is
    left out, and its finding says by how much. The bed's rim is kept free as wide as the margin, mm; without one as wide as the
    gap, for a brim, unless a part needs it.
    """
    import rectpack

    whole = bed
    gap = gap + _SPARE
    if margin is not None:
        bed = within(bed, margin)
    prints: dict[str, Footprint] = {}
    findings = []
    copies = []
    turns = {part.name: sides.get(part.name, Side()).turn for part in parts}
    lying = {part.name: meshes[part.name].vertices @ turns[part.name].T for part in parts}
    for part in parts:
        f, finding = bed_fit(part.name, part.count, lying[part.name], bed)
        prints[part.name] = f
        findings.append(finding)
        copies += [(part.name, k + 1) for k in range(part.count)] if finding.ok else []

    inner = (bed[0] - 2 * gap, bed[1] - 2 * gap)
    if margin is None and min(inner) > 0 and all(_fits(prints[name], inner) for name, _ in copies):
        bed = inner
    packer = rectpack.newPacker(rotation=True)  # the largest area first
    packer.add_bin(*(math.floor((side + gap) / _UNIT) for side in bed), count=float("inf"))
    sizes = [_cell(prints[name], bed, gap) for name, _ in copies]
    for k, (width, height) in enumerate(sizes):
        packer.add_rect(width, height, rid=k)
    packer.pack()
    cells: dict[int, list[tuple[int, complex, complex]]] = {}
    for plate, x, y, width, height, k in packer.rect_list():
        cells.setdefault(plate, []).append((k, complex(x, y), complex(width, height)))
    plates = []
    for plate in sorted(cells):
        far = [low + size for _, low, size in cells[plate]]
        middle = (
            complex(*whole)
            - complex(max(z.real for z in far), max(z.imag for z in far)) * _UNIT
            + gap * (1 + 1j)
        ) / 2
        spots = []
        for k, low, size in sorted(cells[plate], key=lambda cell: cell[0]):
            name, copy = copies[k]
            across = size != complex(*sizes[k])
            centre = middle + (low + size / 2) * _UNIT - gap * (1 + 1j) / 2
            middle_of_part = prints[name].centre * (1j if across else 1)
            angle = prints[name].angle + (math.pi / 2 if across else 0.0)
            spots.append(
                Spot(
                    name,
                    copy,
                    angle,
                    centre - middle_of_part,
                    -float(lying[name][:, 2].min()),
                    turns[name],
                )
            )
        plates.append(tuple(spots))
    return Layout(tuple(plates), tuple(findings))


def _cell(f: Footprint, bed: tuple[float, float], gap: float) -> tuple[int, int]:
    """Width and height with the gap in units, rounded up unless that is what makes it too large for the bed."""
    low, high = sorted(bed)
    room = (low, high) if f.width < f.height else (high, low)
    width, height = (
        min(math.ceil((side + gap) / _UNIT), math.floor((limit + gap) / _UNIT))
        for side, limit in zip((f.width, f.height), room, strict=True)
    )
    return width, height


def write_plates(
    folder: Path, name: str, layout: Layout, meshes: Mapping[str, Mesh], key: str
) -> list[Path]:
    """Write `<name>-plate.3mf`, `<name>-plate-2.3mf` and so on; key as for `write_3mf`. Returns the paths."""
    from camgen.files.threemf import write_3mf

    paths = []
    for k, spots in enumerate(layout.plates, 1):
        path = folder / (f"{name}-plate.3mf" if k == 1 else f"{name}-plate-{k}.3mf")
        objects = {
            part: mesh for part, mesh in meshes.items() if any(spot.part == part for spot in spots)
        }
        write_3mf(path, objects, placed(spots), f"{key}:plate-{k}")
        paths.append(path)
    return paths


def placed(spots: Sequence[Spot]) -> list[PartCopy]:
    """The copies of a plate."""
    from camgen.files.threemf import PartCopy
    from camgen.geometry.mesh import placing

    copies = []
    for spot in spots:
        place = placing(spot.angle, spot.position, spot.z, 0.0)
        transform = np.column_stack([place[:, :3] @ spot.turn, place[:, 3]]) + 0.0
        copies.append(PartCopy(spot.part, f"{spot.part} {spot.copy}", transform))
    return copies
