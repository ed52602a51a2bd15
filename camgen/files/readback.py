"""Files back to shapes: what the judge sees of a part, read without knowing how it was made.

A DXF becomes rings by layer, an STL or 3MF meshes (vertices, unique by bits in an STL; triangles), a slice a list of rings.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from camgen.errors import FileError
from camgen.files.unpacking import extras, refuse_bomb
from camgen.geometry.rings import Floats, Ints, Points, Ring
from camgen.numerics import product
from camgen.tolerances import NORMAL_ROUNDING, SAME_POINT

CUT_LAYER, MARK_LAYER = "CUT", "CENTER"
# What an entity says of its place and shape; all else (visibility, width, colour, line type) is to be as nobody set it.
_SHAPE = {"handle", "owner", "layer", "count", "flags", "center", "radius", "start", "end", "elevation", "extrusion"}
_NO_UNIT = 0x801E  # lib3mf's warning of a unit that there is not; it takes millimetres then


# ---- DXF ---------------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class DrawingFault:
    """What is wrong with one entity of the CUT layer.

    kind: "open" (size = the gap, mm), "duplicate", "entity" (not a closed polyline or circle, or not in the modelspace),
    "number" (not finite), "zero_length" (size = how many segments), "plane" (mirrored or raised off z = 0), "look"
    (invisible, with a width, in a colour of its own...), "layer" (off, frozen, locked or not plotted).
    """

    kind: str
    size: float
    message: str


@dataclass(frozen=True)
class DxfDrawing:
    """A drawing as read: units ($INSUNITS, None when absent; 4 = mm), rings to cut, strokes of centre marks, faults.

    cut: in the file's order; marks: (n, 2) complex, mm, the ends of each LINE on the layer of centre marks.
    """

    units: int | None
    cut: tuple[Ring, ...]
    marks: Points
    faults: tuple[DrawingFault, ...]


def _ring_of(entity: Any) -> tuple[Ring | None, list[DrawingFault]]:
    """Ring of a DXF entity (None when it does not bound anything) and what is wrong with the entity."""
    kind = entity.dxftype()
    name = f"{kind} #{entity.dxf.handle}"
    faults = []
    if kind == "CIRCLE":
        centre, radius = complex(*entity.dxf.center.vec2), float(entity.dxf.radius)
        if not 0 < radius < 1e9:
            return None, [DrawingFault("number", 1, f"{name} has the radius {radius:g}")]
        points, bulges = centre + radius * np.array([1 + 0j, -1]), np.ones(2)
        raised = entity.dxf.center.z
    elif kind == "LWPOLYLINE":
        rows = np.array(entity.get_points("xybse"), float).reshape(-1, 5)
        points, bulges, raised = rows[:, 0] + 1j * rows[:, 1], rows[:, 2], entity.dxf.elevation
        if rows[:, 3:].any():
            faults.append(DrawingFault("look", 1, f"{name} has a width"))
    else:
        return None, [DrawingFault("entity", 1, f"{name} is not a closed polyline or a circle")]
    if not (np.isfinite(points).all() and np.isfinite(bulges).all()):
        return None, [DrawingFault("number", 1, f"{name} has a coordinate that is not finite")]
    if raised != 0 or tuple(entity.dxf.extrusion) != (0, 0, 1):
        faults.append(DrawingFault("plane", 1, f"{name} is mirrored or raised off the plane z = 0"))
    if kind == "LWPOLYLINE" and not entity.closed:
        gap = float(abs(points[-1] - points[0])) if len(points) else 0.0
        return None, [*faults, DrawingFault("open", gap, f"{name} is open, with a gap of {gap:.6g} mm")]
    kept = np.abs(np.roll(points, -1) - points) > SAME_POINT
    if not kept.all():
        dropped = int(np.count_nonzero(~kept))
        faults.append(DrawingFault("zero_length", dropped, f"{name} has {dropped} segment(s) of no length"))
    ring = Ring(points[kept], bulges[kept])
    if len(ring.points) < 2 or (len(ring.points) == 2 and not ring.bulges.any()):
        return None, [*faults, DrawingFault("entity", 1, f"{name} bounds no area")]
    return ring, faults


def _same(a: Ring, b: Ring) -> bool:
    """Whether two rings bound the same area, wherever they begin and whichever way they run."""
    first, second = (np.array([*ring.box, abs(ring.area), ring.length]) for ring in (a, b))
    return bool(np.allclose(first, second, rtol=1e-9, atol=1e-6))


def read_dxf(path: str | Path) -> DxfDrawing:
    """Read a DXF file; FileError when it cannot be read, is no DXF or is cut short.

    Closed LWPOLYLINE (with bulges) and CIRCLE (as two half-circles from its rightmost point) on CUT become rings, LINEs on
    CENTER marks. Whatever else there is, or looks otherwise than drawn plainly, is a fault: somebody's laser will cut it,
    or leave it out.
    """
    from ezdxf.filemanagement import readfile
    from ezdxf.lldxf.const import DXFError

    try:
        text = Path(path).read_bytes()
        if not text.rstrip().endswith(b"EOF"):
            raise FileError(path, "not a DXF file, or cut short: it does not end in EOF")
        drawing = readfile(str(path))
    except OSError as error:
        raise FileError(path, error.strerror or str(error)) from None
    except (DXFError, UnicodeDecodeError, ValueError, TypeError, IndexError) as error:
        raise FileError(path, f"not a valid DXF file: {error}") from None
    rings: list[Ring] = []
    marks: list[tuple[complex, complex]] = []
    faults = [*_hidden_layers(drawing), *_elsewhere(drawing)]
    for entity in drawing.modelspace():
        layer, kind = str(entity.dxf.layer).upper() if entity.dxf.is_supported("layer") else "?", entity.dxftype()
        if (layer, kind) == (MARK_LAYER, "LINE"):
            start, end = entity.dxf.start, entity.dxf.end
            marks.append((complex(*start.vec2), complex(*end.vec2)))
            if start.z or end.z:
                faults.append(DrawingFault("plane", 1, f"LINE #{entity.dxf.handle} is raised off the plane z = 0"))
        elif layer != CUT_LAYER:
            faults.append(DrawingFault("entity", 1, f"{kind} #{entity.dxf.handle} on layer {layer} is no part of a cut"))
            continue
        else:
            ring, wrong = _ring_of(entity)
            faults += wrong
            if ring is not None:
                if any(_same(ring, other) for other in rings):
                    faults.append(DrawingFault("duplicate", 1, f"#{entity.dxf.handle} repeats an earlier contour"))
                rings.append(ring)
        faults += _looks(entity)
    units, ends = drawing.header.get("$INSUNITS"), np.array(marks, complex).reshape(-1, 2)
    return DxfDrawing(units, tuple(rings), ends, tuple(faults))


def _looks(entity: Any) -> Iterator[DrawingFault]:
    """What is set of an entity that could hide it, thicken it or send it to another tool."""
    for key, value in entity.dxfattribs().items():
        if key not in _SHAPE and value != entity.dxf.dxf_default_value(key):
            yield DrawingFault("look", 1, f"{entity.dxftype()} #{entity.dxf.handle} has {key} {value}")


def _hidden_layers(drawing: Any) -> Iterator[DrawingFault]:
    """Layers of what is cut or marked that some program would not show, plot or send to the machine."""
    for layer in drawing.layers:
        states = {
            "off": layer.is_off(), "frozen": layer.is_frozen(), "locked": layer.is_locked(), "not plotted": not layer.dxf.plot,
            "transparent": layer.transparency > 0, "dashed": layer.dxf.linetype.upper() != "CONTINUOUS",
        }  # fmt: skip
        if (said := ", ".join(name for name in states if states[name])) and layer.dxf.name.upper() in (CUT_LAYER, MARK_LAYER):
            yield DrawingFault("layer", 1, f"layer {layer.dxf.name} is {said}")


def _elsewhere(drawing: Any) -> Iterator[DrawingFault]:
    """What is drawn outside the modelspace: on paper, or in blocks."""
    for block in drawing.blocks:
        if len(block) and not block.is_modelspace:
            yield DrawingFault("entity", len(block), f"{block.name} holds {len(block)} entities, and the modelspace alone is cut")


# ---- meshes ------------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Mesh:
    """Triangle mesh: vertices (n, 3) mm, faces (m, 3) their indices, counter-clockwise seen from outside.

    normals: (m, 3) as the file stores them, None where it was not asked for them or a mesh has none.
    """

    vertices: Floats
    faces: Ints
    normals: Floats | None = None

    def moved(self, transform: Floats) -> Mesh:
        """Image under a (3, 4) transform: rotation and shift, applied to column vectors."""
        return Mesh(product(self.vertices, transform[:, :3].T) + transform[:, 3], self.faces)


@dataclass(frozen=True)
class Item:
    """One thing to build: the name of its object, the mesh, and the (3, 4) transform that places it."""

    name: str
    mesh: Mesh
    transform: Floats

    @property
    def placed(self) -> Mesh:
        """The mesh in its place."""
        return self.mesh.moved(self.transform)


@dataclass(frozen=True)
class Package:
    """A 3MF file: its unit, what is built, and what is wrong with it as a package.

    items: meshes as placed; components of an assembly are resolved to the meshes they are made of.
    warnings: lib3mf's own, objects of one name, of another type than model or that nothing builds, vertices that no
    triangle uses (left out of the meshes).
    """

    unit: str
    warnings: tuple[str, ...]
    items: tuple[Item, ...]

    @property
    def meshes(self) -> dict[str, Mesh]:
        """The meshes that are built, by the names of their objects."""
        return {item.name: item.mesh for item in self.items}


def _indexed(corners: Floats) -> Mesh:
    """Mesh of (m, 3, 3) corners, vertices unique by exact bits.

    A hash table by scatter and gather: all corners write their number to the slot of their hash, the one that stays
    stands for all corners equal to it, and whoever lost the slot to another point tries again with another hash.
    """
    flat = np.ascontiguousarray(corners.reshape(-1, 3)) + 0.0  # -0 becomes 0
    bits = flat.view(np.uint64)
    stand_in = np.empty(len(flat), np.int64)
    slots = 1 << max(len(flat).bit_length(), 4)
    slot_of = np.empty(slots, np.int64)
    left = np.arange(len(flat))
    seed = np.array([0x9E3779B97F4A7C15, 0xC2B2AE3D27D4EB4F, 0x165667B19E3779F9], np.uint64)
    while len(left):
        mine = bits[left]
        mixed = mine[:, 0] * seed[0] ^ mine[:, 1] * seed[1] ^ mine[:, 2] * seed[2]
        slot = ((mixed ^ mixed >> np.uint64(29)) * seed[0] >> np.uint64(20)) % np.uint64(slots)
        slot_of[slot] = left
        winner = slot_of[slot]
        same = (bits[winner] == mine).all(axis=1)
        stand_in[left[same]] = winner[same]
        left = left[~same]
        seed = seed * seed[1] | np.uint64(1)
    first = np.zeros(len(flat), bool)
    first[stand_in] = True
    number = np.cumsum(first) - 1
    return Mesh(flat[first], number[stand_in].reshape(-1, 3))


def read_stl(path: str | Path, normals: bool = False) -> Mesh:
    """Read an STL file, binary or text; FileError with the reason when it is cut short, too long or not finite.

    normals: keep the stored ones, which many programs leave at zero; FileError then where the file is text.
    """
    try:
        data = Path(path).read_bytes()
    except OSError as error:
        raise FileError(path, error.strerror or str(error)) from None
    count = int.from_bytes(data[80:84], "little")
    if len(data) >= 84 and len(data) == 84 + 50 * count:
        row = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
        rows = np.frombuffer(data, row, offset=84)
        corners, stored = rows["corners"].astype(float), rows["normal"].astype(float) if normals else None
    elif data.lstrip().startswith(b"solid") and b"facet" in data[:1000]:
        if normals:
            raise FileError(path, "is an STL in text; a binary one was expected")
        if not re.search(rb"endsolid[^\n]*\s*$", data):
            raise FileError(path, "STL text cut short: it does not end in endsolid")
        words = re.findall(rb"vertex\s+(\S+)\s+(\S+)\s+(\S+)", data)
        try:
            corners, stored = np.array(words, float).reshape(-1, 3, 3), None
        except ValueError as error:
            raise FileError(path, f"STL text with a wrong vertex: {error}") from None
    elif len(data) < 84:
        raise FileError(path, f"not an STL file: {len(data)} bytes, the header alone has 84")
    else:
        change = "cut short" if len(data) < 84 + 50 * count else "too long"
        raise FileError(path, f"{change}: {len(data)} bytes, but a header of {count} triangles asks for {84 + 50 * count}")
    if not np.isfinite(corners).all():
        raise FileError(path, "a vertex is not finite")
    mesh = _indexed(corners)
    return Mesh(mesh.vertices, mesh.faces, stored)


def _array(records: list[Any], kind: type, columns: int) -> NDArray[Any]:
    """lib3mf's list of C structures as an array; they share one block of memory, of which the first tells."""
    return np.frombuffer(records[0]._b_base_, kind).reshape(-1, columns) if records else np.empty((0, columns), kind)


def read_3mf(path: str | Path, strict: bool = True) -> Package:
    """Read a 3MF file with lib3mf, in strict mode unless it is another program's.

    FileError when it is refused, in a unit that there is not, or places far too much.
    """
    try:
        return _package(str(path), Path(path).read_bytes(), strict)
    except OSError as error:
        raise FileError(path, error.strerror or str(error)) from None


@lru_cache(maxsize=16)  # several checks look at each file of a folder
def _package(path: str, data: bytes, strict: bool) -> Package:
    import lib3mf

    if not data.startswith(b"PK"):
        raise FileError(path, "not a 3MF file: it is no zip archive")
    refuse_bomb(path)
    try:
        model = lib3mf.get_wrapper().CreateModel()
        reader = model.QueryReader("3mf")
        reader.SetStrictModeActive(strict)
        reader.ReadFromFile(path)
    except lib3mf.ELib3MFException as error:
        raise FileError(path, f"not a valid 3MF file: {error}") from None
    told = [reader.GetWarning(i) for i in range(reader.GetWarningCount())]
    if any(code == _NO_UNIT for code, _ in told):
        raise FileError(path, "names a unit that there is not in a 3MF file; millimeter was expected")
    warnings = [*(text for _, text in told), *(extras(path) if strict else ())]
    meshes: dict[int, tuple[str, Mesh]] = {}  # by the number of the resource, which alone is unique
    inside: dict[int, list[tuple[int, Floats]]] = {}  # what an object is made of, and where
    for thing in _each(model.GetMeshObjects(), "GetCurrentMeshObject"):
        name = thing.GetName()
        mesh, idle = _without_spare(
            _array(thing.GetVertices(), np.float32, 3).astype(float),
            _array(thing.GetTriangleIndices(), np.uint32, 3).astype(np.int64),
        )
        meshes[thing.GetUniqueResourceID()] = name, mesh
        warnings += [f"object '{name}' has {idle} vertices that no triangle uses"] if idle else []
    for thing in _each(model.GetComponentsObjects(), "GetCurrentComponentsObject"):
        parts = [thing.GetComponent(i) for i in range(thing.GetComponentCount())]
        inside[thing.GetUniqueResourceID()] = [
            (part.GetObjectResource().GetUniqueResourceID(), _matrix(part.GetTransform())) for part in parts
        ]
    kinds = {thing.GetUniqueResourceID(): thing for thing in _each(model.GetObjects(), "GetCurrentObject")}
    warnings += [
        f"object '{thing.GetName()}' is of type {thing.GetType().name.lower()}, not model"
        for thing in kinds.values() if thing.GetType() != lib3mf.ObjectType.Model
    ]  # fmt: skip
    names = Counter(name for name, _ in meshes.values())
    warnings += [f"{count} objects have the name '{name}'" for name, count in names.items() if count > 1]
    items: list[Item] = []
    waiting = [
        (item.GetObjectResource().GetUniqueResourceID(), _matrix(item.GetObjectTransform()))
        for item in _each(model.GetBuildItems(), "GetCurrent")
    ][::-1]
    built = set()
    while waiting:
        number, outer = waiting.pop()
        built.add(number)
        if number in meshes:
            items.append(Item(*meshes[number], outer[:3]))
        else:
            waiting += [(part, product(outer, inner)) for part, inner in reversed(inside[number])]
    warnings += [f"nothing builds object '{thing.GetName()}'" for number, thing in kinds.items() if number not in built]
    return Package(model.GetUnit().name, tuple(warnings), tuple(items))


def _each(iterator: Any, current: str) -> Iterator[Any]:
    """What one of lib3mf's iterators runs through."""
    while iterator.MoveNext():
        yield getattr(iterator, current)()


def _without_spare(vertices: Floats, faces: Ints) -> tuple[Mesh, int]:
    """A mesh less the vertices that no triangle uses, and how many these were."""
    used = np.zeros(len(vertices), bool)
    used[faces] = True
    return Mesh(vertices[used], (np.cumsum(used) - 1)[faces]), int(np.count_nonzero(~used))


def _matrix(transform: Any) -> Floats:
    """(4, 4) matrix for column vectors of lib3mf's (4, 3) fields, which serve row vectors."""
    return np.vstack([np.array([list(row) for row in transform.Fields]).T, [0, 0, 0, 1]])


@dataclass(frozen=True)
class MeshFaults:
    """What keeps a mesh from bounding a solid, counted, and what it bounds.

    Edges of one triangle only (open), run twice the same way (flipped), of more than two triangles (crowded);
    triangles without area; stored normals that are not the triangle's own, which harm no solid; bodies (joined by edges);
    signed volume, mm^3, negative when inside out.
    """

    open_edges: int
    flipped_edges: int
    crowded_edges: int
    degenerate: int
    turned_normals: int
    bodies: int
    volume: float

    @property
    def count(self) -> int:
        """Number of faulty edges and triangles; 0 for a watertight mesh."""
        return self.open_edges + self.flipped_edges + self.crowded_edges + self.degenerate


def mesh_faults(mesh: Mesh) -> MeshFaults:
    """Count the faults of a mesh."""
    a, b = mesh.faces.ravel(), np.roll(mesh.faces, -1, axis=1).ravel()
    key = np.minimum(a, b) * len(mesh.vertices) + np.maximum(a, b)
    order = np.argsort(key, kind="stable")
    starts = np.flatnonzero(np.diff(key[order], prepend=-1))
    uses = np.diff(starts, append=len(key))
    balance = np.add.reduceat(np.where(a < b, 1, -1)[order], starts) if len(key) else uses
    corners = mesh.vertices[mesh.faces]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    face = order // 3
    joined = np.flatnonzero(np.diff(key[order]) == 0)
    middle = mesh.vertices.mean(axis=0) if len(mesh.vertices) else np.zeros(3)
    return MeshFaults(
        open_edges=int(np.count_nonzero(uses == 1)),
        flipped_edges=int(np.count_nonzero((uses == 2) & (balance != 0))),
        crowded_edges=int(np.count_nonzero(uses > 2)),
        degenerate=int(np.count_nonzero(~normals.any(axis=1))),
        turned_normals=0 if mesh.normals is None else _turned(mesh.normals, normals),
        bodies=_components(len(mesh.faces), face[joined], face[joined + 1]),
        volume=float(np.einsum("ij,ij->", corners[:, 0] - middle, normals) / 6),
    )


def _turned(stored: Floats, own: Floats) -> int:
    """How many of the stored unit normals are not those of their triangles, which have the directions `own`, (m, 3)."""
    size = np.linalg.norm(own, axis=1, keepdims=True)
    off = np.linalg.norm(stored - own / np.where(size == 0, 1, size), axis=1)
    return int(np.count_nonzero(~(off <= NORMAL_ROUNDING) & (size[:, 0] > 0)))


def _components(count: int, a: Ints, b: Ints) -> int:
    """Number of connected components of a graph with links a-b: every node takes its neighbours' least label."""
    label = np.arange(count)
    while (label[a] != label[b]).any():
        least = np.minimum(label[a], label[b])
        np.minimum.at(label, label[a], least)
        np.minimum.at(label, label[b], least)
        while (label[label] != label).any():
            label = label[label]
    return int(np.count_nonzero(label == np.arange(count)))


def slice_mesh(mesh: Mesh, z: float) -> list[Ring]:
    """Section of a mesh at height z: straight rings, material on their left (outside ccw, holes cw).

    A vertex at exactly z counts as above. A point on the line through its neighbours, within SAME_POINT, is left out:
    such points come from the diagonals of upright walls. ValueError when the section does not close.
    """
    above = mesh.vertices[:, 2] >= z
    side = above[mesh.faces]
    high = side.sum(axis=1)
    cut = np.flatnonzero((high == 1) | (high == 2))
    if not len(cut):
        return []
    top = high[cut] == 1
    lone = np.argmax(side[cut] == top[:, None], axis=1)  # the corner that is alone on its side
    faces, row = mesh.faces[cut], np.arange(len(cut))
    a, b, c = (faces[row, (lone + k) % 3] for k in range(3))
    tail, head = np.where(top, b, c), np.where(top, c, b)  # crossing runs from edge a-tail to edge a-head
    size = len(mesh.vertices)
    start = np.minimum(a, tail) * size + np.maximum(a, tail)
    end = np.minimum(a, head) * size + np.maximum(a, head)
    by_start, by_end = np.argsort(start), np.argsort(end)
    wrong = int(np.count_nonzero(start[by_start] != end[by_end]))
    if wrong or (np.diff(start[by_start]) == 0).any():
        raise ValueError(f"the section at z = {z:.6g} mm does not close")
    following = np.empty(len(cut), np.int64)
    following[by_end] = by_start
    low, up = mesh.vertices[start // size], mesh.vertices[start % size]
    share = (z - low[:, 2]) / (up[:, 2] - low[:, 2])
    x, y = (low[:, k] + share * (up[:, k] - low[:, k]) for k in (0, 1))
    points = x + 1j * y
    return [ring for loop in _loops(following) if (ring := _without_idle(points[loop])) is not None]


def _loops(following: Ints) -> list[Ints]:
    """The cycles of a permutation, each as its members in order."""
    step, loops = following.tolist(), []
    seen = bytearray(len(step))
    for first in range(len(step)):
        if seen[first]:
            continue
        loop, k = [], first
        while not seen[k]:
            seen[k] = 1
            loop.append(k)
            k = step[k]
        loops.append(np.array(loop))
    return loops


def _without_idle(z: Points) -> Ring | None:
    """Ring through z less repeated points and those on the line of their neighbours; None when nothing is left."""
    z = z[np.abs(z - np.roll(z, 1)) > SAME_POINT]
    before, after = z - np.roll(z, 1), np.roll(z, -1) - z
    # The far neighbour is to lie on the line of the short edge: so two near vertices that bend a little are not both idle.
    idle = np.abs(np.imag(np.conj(before) * after)) <= SAME_POINT * np.minimum(np.abs(before), np.abs(after))
    z = z[~(idle & (np.real(np.conj(before) * after) > 0))]
    return Ring(z, np.zeros(len(z))) if len(z) > 2 else None
