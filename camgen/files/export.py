"""What goes to the machine: DXF to cut, STL and 3MF to print. Millimetres, and the same bytes for the same spec.

An OSError means that the file could not be written.
"""

from __future__ import annotations

import uuid
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Literal

import numpy as np

from camgen.files.dxf import add_contour, document, extent
from camgen.geometry.arcs import as_circle, fit_arcs
from camgen.geometry.distances import point_to_ring
from camgen.geometry.facets import facet_contour
from camgen.geometry.outlines import Contour, Floats, Points, Region, polygon
from camgen.numerics import product
from camgen.parts.solids import Mesh

# What a laser takes, and what it leaves: name -> (colour index, line weight in 1/100 mm).
_CUT, _MARKS = {"CUT": (7, 25)}, {"CENTER": (1, 13)}
# Half length of the strokes of a centre mark, mm; at most this share of the way to the nearest contour, so that a whole
# stroke is shorter than the hole's radius; a mark of less than the smallest half length is left out.
_MARK, _MARK_SHARE, _SMALLEST_MARK = 1.0, 0.4, 0.1
_NEAR = 1e-3  # mm, chord tolerance of the contours to which that way is measured
# Digits after the point in 3MF. lib3mf works them out in float32: with 9 the fewest numbers, one in 25, come back an
# ulp off; with more or fewer it is up to one in five.
_DECIMALS = 9


def write_dxf(
    path: Path,
    region: Region,
    centres: Sequence[complex],
    tolerance: float,
    curves: Literal["bulge", "lines"] = "bulge",
) -> None:
    """Write a region's contours on layer CUT, a mark at each centre on layer CENTER, and nothing else.

    Full circles are CIRCLEs; the others are arcs within tolerance ("bulge"), or chords for readers without bulges
    ("lines"), mm. Outer contour first, counter-clockwise like the holes.
    """

    def flat(contour: Contour) -> Contour:
        contour = contour.counter_clockwise()
        if curves == "lines" and not as_circle(contour):
            ring: Points = facet_contour(contour, tolerance)
            return polygon(ring.tolist())
        return fit_arcs(contour, tolerance)

    contours = [flat(contour) for contour in (region.outer, *region.holes)]
    marks = center_marks(region, centres)
    box = extent([*contours, *(polygon(stroke) for stroke in marks.tolist())])
    with document(path, _CUT | _MARKS if len(marks) else _CUT, box) as space:
        for contour in contours:
            add_contour(space, contour, "CUT")
        for a, b in marks.tolist():
            space.add_line((a.real, a.imag), (b.real, b.imag), dxfattribs={"layer": "CENTER"})


def center_marks(region: Region, centres: Sequence[complex]) -> Points:
    """Strokes of crosses at the centres, (n, 2) complex mm: they end in the open, never on a contour of the region."""
    if not centres:
        return np.empty((0, 2), complex)
    rings = [facet_contour(contour, _NEAR) for contour in (region.outer, *region.holes)]
    middles = np.array(centres, complex)
    near = np.min([point_to_ring(middles, ring) for ring in rings], axis=0)
    reach = np.minimum(_MARK, _MARK_SHARE * near)
    strokes = [(z - r * way, z + r * way) for z, r in zip(middles, reach, strict=True) if r >= _SMALLEST_MARK for way in (1, 1j)]
    return np.array(strokes, complex).reshape(-1, 2)


def write_stl(path: Path, mesh: Mesh, name: str) -> None:
    """Write a mesh as binary STL whose header names the part (ASCII, cut at 80 bytes)."""
    # Never "solid" at the beginning: readers would take the file for text.
    label = f"camgen {name}".encode("ascii", "replace")[:80]
    rows = np.zeros(len(mesh.faces), [("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
    rows["corners"] = corners = mesh.vertices[mesh.faces]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    rows["normal"] = normals / np.linalg.norm(normals, axis=1, keepdims=True) + 0.0
    path.write_bytes(label.ljust(80, b"\0") + np.array(len(rows), "<u4").tobytes() + rows.tobytes())


@dataclass(frozen=True, eq=False)
class Placed:
    """One copy in a 3MF: its object's name, its own name, a rotation with shift (3, 4) for column vectors."""

    object: str
    name: str
    transform: Floats = field(default_factory=lambda: np.eye(3, 4))


def placing(angle: float, position: complex, z: float, thickness: float, flipped: bool = False) -> Floats:
    """Transform (3, 4) of a part turned by angle (rad) about z and moved to position (complex mm) and height z, mm.

    flipped: first turned over about Oy, (x, y, z) -> (-x, y, thickness - z): a rotation, no mirror image.
    """
    turn = np.array([[np.cos(angle), -np.sin(angle), 0], [np.sin(angle), np.cos(angle), 0], [0, 0, 1]])
    over = np.diag([-1.0, 1.0, -1.0]) if flipped else np.eye(3)
    shift = [position.real, position.imag, z + (thickness if flipped else 0)]
    return np.column_stack([product(turn, over), shift]) + 0.0


def write_3mf(path: Path, objects: Mapping[str, Mesh], items: Sequence[Placed], key: str) -> None:
    """Write a 3MF of named meshes and their copies; `key` (the spec's hash) makes every UUID, so same key, same bytes.

    A copy in place under its object's own name is a build item of the mesh; any other is a named components object
    that places the mesh. Meshes that no copy places are left out: PrusaSlicer opens no file that has one.
    """
    import lib3mf

    def made(*what: object) -> str:
        return str(uuid.uuid5(uuid.NAMESPACE_URL, ":".join(map(str, ("camgen", key, *what)))))

    model = lib3mf.get_wrapper().CreateModel()
    model.SetUnit(lib3mf.ModelUnit.MilliMeter)
    model.SetBuildUUID(made("build"))
    identity = _transform(np.eye(3, 4))
    meshes: dict[str, Any] = {}
    placed = {item.object for item in items}
    for name, mesh in objects.items():
        if name not in placed:
            continue
        vertices, faces = np.ascontiguousarray(mesh.vertices, np.float32), np.ascontiguousarray(mesh.faces, np.uint32)
        thing = meshes[name] = model.AddMeshObject()
        thing.SetName(name)
        thing.SetUUID(made("mesh", name))
        thing.SetGeometry(
            (lib3mf.Position * len(vertices)).from_buffer(vertices), (lib3mf.Triangle * len(faces)).from_buffer(faces)
        )
    for item in items:
        thing = meshes[item.object]
        if item.name != item.object or not np.array_equal(item.transform, np.eye(3, 4)):
            thing = model.AddComponentsObject()
            thing.SetName(item.name)
            thing.SetUUID(made("copy", item.name))
            thing.AddComponent(meshes[item.object], _transform(item.transform)).SetUUID(made("component", item.name))
        build = model.AddBuildItem(thing, identity)
        build.SetUUID(made("item", item.name))
        build.SetPartNumber(item.name)
    writer = model.QueryWriter("3mf")
    writer.SetDecimalPrecision(_DECIMALS)
    path.write_bytes(bytes(writer.WriteToBuffer()))


def _transform(matrix: Floats) -> Any:
    """lib3mf's transform (4, 3), which serves row vectors."""
    import lib3mf

    result = lib3mf.Transform()
    for i, row in enumerate(np.asarray(matrix).T.tolist()):
        result.Fields[i][:] = row
    return result
