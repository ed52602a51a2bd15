"""3MF: named solids and their copies in one package, written and read with lib3mf.

    part      a file in the package, by its name
    object    what a part defines, by part and number; number BUILD stands for what the part has built
    item      one thing to build: an object where a transform places it

Packages are counted before they are unpacked: components within components multiply, and so do packed bytes.
"""

from __future__ import annotations

import colorsys
import hashlib
import io
import re
import uuid
import zipfile
import zlib
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from ctypes import c_uint64, string_at
from dataclasses import dataclass, field
from functools import cache, lru_cache
from graphlib import CycleError, TopologicalSorter
from pathlib import Path
from typing import Any
from xml.parsers import expat

import numpy as np
from numpy.typing import NDArray

from camgen._version import __version__
from camgen.bounds import read_bytes
from camgen.errors import FileError
from camgen.files.formats import FORMATS, Job
from camgen.geometry.mesh import MOST_TRIANGLES, Mesh
from camgen.geometry.rings import Floats, Ints
from camgen.numerics import product

# Digits after the point in 3MF. lib3mf works them out in float32: with 9 the fewest numbers, one in 25, come back an
# ulp off; with more or fewer it is up to one in five.
_DECIMALS = 9
_NO_UNIT = 0x801E  # lib3mf's warning of a unit that there is not; it takes millimetres then
MOST_COPIES = 10_000  # of objects in one assembly, those on the way to the meshes counted
MOST_BYTES = 300_000_000  # unpacked
# bytes; how often a larger part may be as long as it is packed: meshes are 10 times
_SMALL = 1_000_000
_PACKED = 100
BUILD = -1
_NONE = -2
_BULK = re.compile(rb"(?:<(?:vertex|triangle) [^<>]*/>\s*)+")  # what most of a package consists of
_OURS = {
    "[content_types].xml",
    "_rels/.rels",
    "3d/3dmodel.model",
}  # parts of a package as camgen writes it

Object = tuple[str, int]


# ---- writing ---------------------------------------------------------------------------------------------------------


def write_part(path: Path, job: Job) -> None:
    """Write the part's solid under its name."""
    assert job.solid is not None, "a file of a solid is asked for"
    write_3mf(path, {job.name: job.solid}, [PartCopy(job.name, job.name)], job.key)


@dataclass(frozen=True, eq=False)
class PartCopy:
    """One copy in a 3MF: its object's name, its own name, a rotation with shift (3, 4) for column vectors."""

    object: str
    name: str
    transform: Floats = field(default_factory=lambda: np.eye(3, 4))


def write_3mf(path: Path, objects: Mapping[str, Mesh], items: Sequence[PartCopy], key: str) -> None:
    """Write a 3MF of named meshes and their copies; `key` (the spec's hash) makes every UUID, so same key, same bytes.

    A copy in place under its object's own name is a build item of the mesh; any other is a named components object
    that places the mesh. Meshes that no copy places are left out: PrusaSlicer opens no file that has one. The file's own name
    is its title; every part has one colour, the same in all files, by its name.
    """
    import lib3mf

    def identifier(*what: object) -> str:
        return str(uuid.uuid5(uuid.NAMESPACE_URL, ":".join(map(str, ("camgen", key, *what)))))

    model = _library().CreateModel()
    model.SetUnit(lib3mf.ModelUnit.MilliMeter)
    model.SetBuildUUID(identifier("build"))
    metadata = model.GetMetaDataGroup()
    metadata.AddMetaData("", "Title", path.stem, "xs:string", True)
    metadata.AddMetaData("", "Application", f"camgen {__version__}", "xs:string", True)
    colours = model.AddBaseMaterialGroup()
    identity = _transform(np.eye(3, 4))
    meshes: dict[str, Any] = {}
    names = {item.object for item in items}
    for name, mesh in objects.items():
        if name not in names:
            continue
        vertices = np.ascontiguousarray(mesh.vertices, np.float32)
        faces = np.ascontiguousarray(mesh.faces, np.uint32)
        object_ = meshes[name] = model.AddMeshObject()
        object_.SetName(name)
        object_.SetUUID(identifier("mesh", name))
        # `SetGeometry` copies number by number.
        wrapper = object_._wrapper
        code = wrapper.lib.lib3mf_meshobject_setgeometry(
            object_._handle,
            c_uint64(len(vertices)),
            (lib3mf.Position * len(vertices)).from_buffer(vertices),
            c_uint64(len(faces)),
            (lib3mf.Triangle * len(faces)).from_buffer(faces),
        )
        wrapper.checkError(object_, code)
        object_.SetObjectLevelProperty(
            colours.GetUniqueResourceID(),
            colours.AddMaterial(name, lib3mf.Color(*_colour(name), 255)),
        )
    for item in items:
        object_ = meshes[item.object]
        if item.name != item.object or not np.array_equal(item.transform, np.eye(3, 4)):
            object_ = model.AddComponentsObject()
            object_.SetName(item.name)
            object_.SetUUID(identifier("copy", item.name))
            object_.AddComponent(meshes[item.object], _transform(item.transform)).SetUUID(
                identifier("component", item.name)
            )
        build = model.AddBuildItem(object_, identity)
        build.SetUUID(identifier("item", item.name))
        build.SetPartNumber(item.name)
    writer = model.QueryWriter("3mf")
    writer.SetDecimalPrecision(_DECIMALS)
    stream = io.BytesIO()  # `WriteToBuffer` would write all of it twice, once for its length
    write = lib3mf.WriteCallback(lambda data, size, _: stream.write(string_at(data, size)))
    writer.WriteToCallback(write, lib3mf.SeekCallback(lambda place, _: stream.seek(place)), None)
    path.write_bytes(stream.getvalue())


def _colour(name: str) -> tuple[int, int, int]:
    """Red, green and blue of a part, 0..255: light ones, whose hue its name says."""
    hue = int.from_bytes(hashlib.sha256(name.encode()).digest()[:4], "big") / 2**32
    red, green, blue = (round(255 * share) for share in colorsys.hsv_to_rgb(hue, 0.5, 0.9))
    return red, green, blue


def _transform(matrix: Floats) -> Any:
    """lib3mf's transform (4, 3), which serves row vectors."""
    import lib3mf

    result = lib3mf.Transform()
    for i, row in enumerate(np.asarray(matrix).T.tolist()):
        result.Fields[i][:] = row
    return result


# ---- reading ---------------------------------------------------------------------------------------------------------


def read_part(path: Path, name: str) -> tuple[Mesh, list[str]]:
    """The first solid that the package builds, and what is wrong where it is to hold the part of this name alone."""
    package = read_3mf(path)
    names = [item.name for item in package.items]
    strange = (
        []
        if names == [name]
        else [f"holds {', '.join(names[:5]) or 'nothing'} instead of {name} alone"]
    )
    return package.items[0].placed if names else Mesh(
        np.empty((0, 3)), np.empty((0, 3), int)
    ), package.remarks + strange


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
    warnings: lib3mf's own, objects of one name, of another type than model or that nothing builds, copies under another part's
    name, vertices that no triangle uses (left out of the meshes).
    """

    unit: str
    warnings: tuple[str, ...]
    items: tuple[Item, ...]

    @property
    def remarks(self) -> list[str]:
        """All that is wrong with it as a package, its unit too."""
        return [
            *self.warnings,
            *([] if self.unit.lower() == "millimeter" else [f"unit is {self.unit}"]),
        ]

    @property
    def meshes(self) -> dict[str, Mesh]:
        """The meshes that are built, by the names of their objects."""
        return {item.name: item.mesh for item in self.items}


def _array(records: list[Any], kind: type, columns: int) -> NDArray[Any]:
    """lib3mf's list of C structures as an array; they share one block of memory, of which the first tells."""
    return (
        np.frombuffer(records[0]._b_base_, kind).reshape(-1, columns)
        if records
        else np.empty((0, columns), kind)
    )


@cache  # to look up its functions takes longer than a small file
def _library() -> Any:
    """lib3mf, loaded."""
    import lib3mf

    return lib3mf.get_wrapper()


def read_3mf(path: str | Path, strict: bool = True) -> Package:
    """Read a 3MF file with lib3mf, in strict mode unless it is another program's.

    FileError when it is refused, in a unit that there is not, or places far too much.
    """
    data = read_bytes(Path(path), FORMATS["3mf"].size)
    if not data.startswith(b"PK"):
        raise FileError(path, "not a 3MF file: it is no zip archive")
    return _package(str(path), hashlib.sha256(data).digest(), strict)


@lru_cache(maxsize=128)  # several checks look at each file of a folder
def _package(path: str, digest: bytes, strict: bool) -> Package:
    """What a file of these bytes says."""
    import lib3mf

    extras = _looked_through(path)
    try:
        model = _library().CreateModel()
        reader = model.QueryReader("3mf")
        reader.SetStrictModeActive(strict)
        reader.ReadFromFile(path)
    except lib3mf.ELib3MFException as error:
        raise FileError(path, f"not a valid 3MF file: {error}") from None
    messages = [reader.GetWarning(i) for i in range(reader.GetWarningCount())]
    if any(code == _NO_UNIT for code, _ in messages):
        raise FileError(path, "names a unit that 3MF does not have; millimeter was expected")
    warnings = [*(text for _, text in messages), *(extras if strict else ())]
    meshes: dict[int, tuple[str, Mesh]] = {}  # by the number of the resource, which alone is unique
    inside: dict[int, list[tuple[int, Floats]]] = {}  # what an object is made of, and where
    for resource in _each(model.GetMeshObjects(), "GetCurrentMeshObject"):
        name = resource.GetName()
        mesh, idle = _without_spare(
            _array(resource.GetVertices(), np.float32, 3).astype(float),
            _array(resource.GetTriangleIndices(), np.uint32, 3).astype(np.int64),
        )
        meshes[resource.GetUniqueResourceID()] = name, mesh
        warnings += [f"object '{name}' has {idle} vertices that no triangle uses"] if idle else []
    for resource in _each(model.GetComponentsObjects(), "GetCurrentComponentsObject"):
        parts = [resource.GetComponent(i) for i in range(resource.GetComponentCount())]
        inside[resource.GetUniqueResourceID()] = [
            (part.GetObjectResource().GetUniqueResourceID(), _matrix(part.GetTransform()))
            for part in parts
        ]
    kinds = {
        resource.GetUniqueResourceID(): resource
        for resource in _each(model.GetObjects(), "GetCurrentObject")
    }
    warnings += [
        f"object '{resource.GetName()}' is of type {resource.GetType().name.lower()}, not model"
        for resource in kinds.values()
        if resource.GetType() != lib3mf.ObjectType.Model
    ]
    names = Counter(name for name, _ in meshes.values())
    warnings += [
        f"{count} objects have the name '{name}'" for name, count in names.items() if count > 1
    ]
    items: list[Item] = []
    stack = [
        (
            item.GetObjectResource().GetUniqueResourceID(),
            _matrix(item.GetObjectTransform()),
            {item.GetPartNumber()},
        )
        for item in _each(model.GetBuildItems(), "GetCurrent")
    ][::-1]
    numbers = set()
    while stack:
        number, outer, labels = stack.pop()
        numbers.add(number)
        if number in meshes:
            name, mesh = meshes[number]
            items.append(Item(name, mesh, outer[:3]))
            ours = re.compile(
                rf"({re.escape(name)}([- ]\d+)?)?"
            )  # as the part is named, or with the number of its copy
            warnings += [
                f"'{label}' is made of '{name}'"
                for label in sorted(labels)
                if strict and not ours.fullmatch(label)
            ]
        else:
            within = labels | {kinds[number].GetName()}
            stack += [
                (part, product(outer, inner), within) for part, inner in reversed(inside[number])
            ]
    warnings += [
        f"nothing builds object '{resource.GetName()}'"
        for number, resource in kinds.items()
        if number not in numbers
    ]
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


# ---- before it is unpacked -------------------------------------------------------------------------------------------


def _looked_through(path: str | Path) -> list[str]:
    """What a package holds beside meshes and what is built of them, see `_extras`.

    FileError where it places more than MOST_COPIES or unpacks to more than MOST_BYTES, or is none: lib3mf walks through all
    copies as it reads; a billion, in a file of a kilobyte, take it half a minute.
    """
    try:
        with zipfile.ZipFile(path) as package:
            parts = _unpacked(path, package)
        triangles = sum(text.count(b"triangle ") for text in parts.values())
        if triangles > MOST_TRIANGLES:
            raise FileError(
                path, f"has {triangles:,} triangles; at most {MOST_TRIANGLES:,} are read"
            )
        copies = _copies(parts)
    except CycleError as error:
        raise FileError(
            path, f"not a valid 3MF file: object {error.args[1][0][1]} is made of itself"
        ) from None
    except (
        zipfile.BadZipFile,
        zlib.error,
        RuntimeError,
        EOFError,
        expat.ExpatError,
        ValueError,
    ) as error:
        raise FileError(path, f"not a valid 3MF file: {error}") from None
    except KeyError as error:
        raise FileError(
            path, f"not a valid 3MF file: there is no object {error.args[0][1]} in it"
        ) from None
    if copies > MOST_COPIES:
        number = str(copies) if copies < 1e9 else f"about 1e{len(str(copies)) - 1}"
        raise FileError(
            path, f"places {number} copies of its objects; at most {MOST_COPIES} are read"
        )
    return _extras(parts)


def _unpacked(path: str | Path, package: zipfile.ZipFile) -> dict[str, bytes]:
    """The parts of a package by name; FileError where they are too large."""
    size = sum(part.file_size for part in package.infolist())
    if size > MOST_BYTES:
        raise FileError(
            path, f"unpacks to {size / 1e6:.0f} MB; at most {MOST_BYTES / 1e6:.0f} MB are read"
        )
    for part in package.infolist():
        if part.file_size > _SMALL and part.file_size > _PACKED * part.compress_size:
            sizes = f"{part.file_size / 1e6:.0f} MB from {part.compress_size / 1e6:.3g} MB"
            raise FileError(
                path,
                f"{part.filename} unpacks to {sizes}; at most {_PACKED} times as much is read",
            )
    return {name: package.read(name) for name in package.namelist()}


def _copies(parts: Mapping[str, bytes]) -> int:
    """How many copies the object that places the most stands for; CycleError where one is made of itself."""
    if not any(b"component" in text for text in parts.values()):  # lib3mf reads UTF-8 alone
        return 0
    inside: dict[Object, list[Object]] = {}
    for name, text in parts.items():
        try:
            _count(f"/{name}".lower(), _BULK.sub(b"", text), inside)
        except expat.ExpatError:
            if name.lower().endswith(".model"):
                raise
    copies: dict[Object, int] = {}
    for each in TopologicalSorter(inside).static_order():
        copies[each] = 1 + sum(copies[other] for other in inside[each])
    return max(copies.values(), default=0)


def _extras(parts: Mapping[str, bytes]) -> list[str]:
    """What a package holds beside meshes and what is built of them, and could be printed: sentences, none for a plain one.

    Beams, slices, volumes and the like stand in elements of extensions, modifiers of a slicer in parts of their own.
    """
    tags = sorted(
        {tag.decode() for text in parts.values() for tag in re.findall(rb"<(\w+:\w+)", text)}
    )
    names = [name for name in parts if name.lower() not in _OURS]
    remarks = [f"holds elements of extensions: {', '.join(tags[:5])}"] if tags else []
    return remarks + (
        [f"holds parts that are not camgen's: {', '.join(names[:5])}"] if names else []
    )


def _count(part: str, text: bytes, inside: dict[Object, list[Object]]) -> None:
    """Add to `inside` which objects each object of a part is made of."""
    holder: list[Object] = []

    def begin(tag: str, attributes: dict[str, str]) -> None:
        nonlocal holder
        kind = tag.rpartition(" ")[2]
        if kind == "object":
            holder = inside.setdefault((part, int(attributes.get("id", _NONE))), [])
        elif kind == "build":
            holder = inside.setdefault((part, BUILD), [])
        elif kind in ("component", "item"):
            other = next(
                (value.lower() for key, value in attributes.items() if key.endswith(" path")), part
            )
            holder.append((other, int(attributes.get("objectid", _NONE))))

    parser = expat.ParserCreate(namespace_separator=" ")
    parser.StartElementHandler = begin
    parser.Parse(text, True)
