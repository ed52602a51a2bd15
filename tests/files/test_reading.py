"""Reading files: those of other writers, and damage of every kind."""

from __future__ import annotations

import struct
import tracemalloc
import zipfile
from pathlib import Path

import ezdxf
import numpy as np
import pytest
import trimesh
from test_mesh import HOLE, OUTLINE, prism
from test_rings import SQUARE, straight

from camgen.errors import FileError
from camgen.files import threemf
from camgen.files.dxf import read_dxf
from camgen.files.stl import read_stl
from camgen.files.threemf import read_3mf
from camgen.geometry.mesh import Mesh, mesh_faults, slice_mesh
from camgen.geometry.rings import shape_of

# ---- DXF ----


def write_dxf(path: Path, *, units: int | None = 4, damage: str = "") -> Path:
    """A 10 mm square with one round side, a hole, and a centre mark to pass over; damaged as named."""
    doc = ezdxf.new()
    if units is not None:
        doc.units = units
    space = doc.modelspace()
    rows = [(0, 0, 0), (10, 0, 0.5), (10, 10, 0), (0, 10, 0)]
    if damage == "nan":
        rows[2] = (10, float("nan"), 0)
    if damage == "zero_length":
        rows.insert(1, (0, 0, 0))
    attributes: dict[str, object] = {"layer": "CUT"}
    if damage == "plane":
        attributes["extrusion"] = (0, 0, -1)
    space.add_lwpolyline(rows, format="xyb", close=damage != "open", dxfattribs=attributes)
    space.add_circle((5, 5), 2, dxfattribs={"layer": "CUT"})
    if damage == "duplicate":
        space.add_lwpolyline(
            [(7, 5, -1), (3, 5, -1)], format="xyb", close=True, dxfattribs={"layer": "CUT"}
        )
    if damage == "entity":
        space.add_line((0, 0), (10, 0), dxfattribs={"layer": "CUT"})
    space.add_line((0, 0), (10, 0), dxfattribs={"layer": "CENTER"})
    if damage == "mark":
        space.add_line((0, 0), (10, 0, 1), dxfattribs={"layer": "CENTER"})
    if damage == "lettering":
        space.add_text("name", dxfattribs={"layer": "TEXT"})
    doc.saveas(path)
    return path


def test_dxf_as_written(tmp_path: Path) -> None:
    drawing = read_dxf(write_dxf(tmp_path / "part.dxf"))
    assert drawing.units == 4 and drawing.faults == () and len(drawing.cut) == 2
    assert drawing.marks.tolist() == [[0, 10]]
    shape = shape_of(drawing.cut)
    # A bulge of 1/2 over 10 mm: r = 6.25, sweep 4 atan(1/2).
    sweep = 4 * np.arctan(0.5)
    cap = 6.25**2 / 2 * (sweep - np.sin(sweep))
    assert shape.area == pytest.approx(100 + cap - 4 * np.pi, rel=1e-14)
    assert shape.outer.box == pytest.approx((0, 0, 12.5, 10))
    assert shape.outer.length == pytest.approx(30 + 6.25 * sweep, rel=1e-14)


def test_dxf_units_are_what_the_header_says(tmp_path: Path) -> None:
    assert read_dxf(write_dxf(tmp_path / "inch.dxf", units=1)).units == 1
    path = write_dxf(tmp_path / "none.dxf")
    text = path.read_text()
    head, tail = text.split("$INSUNITS\n", 1)
    path.write_text(head.rsplit("  9\n", 1)[0] + tail.split("\n", 2)[2])
    assert read_dxf(path).units is None


@pytest.mark.parametrize(
    "damage", ["open", "nan", "zero_length", "plane", "duplicate", "entity", "lettering", "mark"]
)
def test_dxf_damage_is_named(tmp_path: Path, damage: str) -> None:
    (fault,) = read_dxf(write_dxf(tmp_path / "part.dxf", damage=damage)).faults
    assert fault.kind == {"nan": "number", "lettering": "entity", "mark": "plane"}.get(
        damage, damage
    )
    if damage == "open":
        assert fault.size == 10


def test_dxf_that_cannot_be_read(tmp_path: Path) -> None:
    path = write_dxf(tmp_path / "part.dxf")
    data = path.read_bytes()
    for share in (0.1, 0.5, 0.9, 0.999):
        path.write_bytes(data[: int(len(data) * share)])
        with pytest.raises(FileError, match="cut short"):
            read_dxf(path)
    for junk in (
        b"",
        b"solid\n",
        bytes(range(256)) * 4 + b"EOF",
        b"hello EOF",
        b"  0\nSECTION\n  x\nEOF\n  0\nEOF",
    ):
        path.write_bytes(junk)
        with pytest.raises(FileError, match="not a"):
            read_dxf(path)
    for nothing in (tmp_path / "none.dxf", tmp_path):
        with pytest.raises(FileError):
            read_dxf(nothing)


# ---- STL ----


def write_stl(path: Path, mesh: Mesh) -> Path:
    row = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
    rows = np.zeros(len(mesh.faces), row)
    rows["corners"] = mesh.vertices[mesh.faces]
    path.write_bytes(b" " * 80 + struct.pack("<I", len(rows)) + rows.tobytes())
    return path


def test_stl_read_and_sliced(tmp_path: Path) -> None:
    """Vertices are found by their bits; the slice gives back exactly the float32 outline, whatever the height."""
    mesh = read_stl(write_stl(tmp_path / "part.stl", prism(OUTLINE, holes=(HOLE,))))
    assert mesh.vertices.shape == (680, 3)
    faults = mesh_faults(mesh)
    shape = straight(OUTLINE).area - straight(HOLE).area
    assert faults.count == 0 and faults.bodies == 1
    assert faults.volume == pytest.approx(6 * shape, rel=1e-6)
    for z in (0.1, 3.0, np.pi):
        outer, hole = sorted(slice_mesh(mesh, z), key=lambda ring: -ring.area)
        for ring, source in ((outer, OUTLINE), (hole, HOLE)):
            single = source.real.astype(np.float32).astype(float) + 1j * source.imag.astype(
                np.float32
            )
            assert np.array_equal(np.sort(ring.points), np.sort(single))
        assert outer.area > 0 > hole.area
    assert slice_mesh(mesh, 7.0) == []


def test_stl_as_text(tmp_path: Path) -> None:
    path = tmp_path / "part.stl"
    cube = trimesh.creation.box((1, 2, 3))
    text = trimesh.exchange.stl.export_stl_ascii(cube)
    path.write_text(text)
    assert mesh_faults(read_stl(path)).volume == pytest.approx(6)
    path.write_text(text[: len(text) // 2])
    with pytest.raises(FileError, match="cut short"):
        read_stl(path)
    path.write_text(text.replace("0.5", "x", 1))
    with pytest.raises(FileError, match="wrong vertex"):
        read_stl(path)


def test_stl_that_cannot_be_read(tmp_path: Path) -> None:
    path = write_stl(tmp_path / "part.stl", prism(SQUARE))
    data = path.read_bytes()
    nan = data[:96] + struct.pack("<f", float("nan")) + data[100:]
    for damaged, words in (
        (data[:-1], "cut short"),
        (data[:300], "cut short"),
        (data + b"\0", "too long"),
        (data[:50], "50 bytes"),
        (b"", "0 bytes"),
        (nan, "not finite"),
    ):
        path.write_bytes(damaged)
        with pytest.raises(FileError, match=words):
            read_stl(path)
    with pytest.raises(FileError):
        read_stl(tmp_path / "none.stl")


# ---- 3MF ----


def write_3mf(path: Path, mesh: Mesh, unit: str = "MilliMeter") -> Path:
    """One mesh 'cam', built once as it is and twice in an assembly, turned by 90 deg about Oz and raised."""
    import lib3mf

    model = lib3mf.get_wrapper().CreateModel()
    model.SetUnit(lib3mf.ModelUnit[unit])
    thing = model.AddMeshObject()
    thing.SetName("cam")
    thing.SetGeometry(
        [lib3mf.Position((lib3mf.Position._fields_[0][1])(*v)) for v in mesh.vertices.tolist()],
        [lib3mf.Triangle((lib3mf.Triangle._fields_[0][1])(*f)) for f in mesh.faces.tolist()],
    )
    identity, turned = (
        lib3mf.get_wrapper().GetIdentityTransform(),
        lib3mf.get_wrapper().GetIdentityTransform(),
    )
    for row, values in enumerate([(0, 1, 0), (-1, 0, 0), (0, 0, 1), (5, 0, 6)]):
        for column, value in enumerate(values):
            turned.Fields[row][column] = value
    pair = model.AddComponentsObject()
    pair.AddComponent(thing, identity)
    pair.AddComponent(thing, turned)
    model.AddBuildItem(thing, identity)
    model.AddBuildItem(pair, turned)
    model.QueryWriter("3mf").WriteToFile(str(path))
    return path


def test_3mf_read_with_its_assembly(tmp_path: Path) -> None:
    mesh = prism(OUTLINE, holes=(HOLE,))
    package = read_3mf(write_3mf(tmp_path / "part.3mf", mesh))
    assert package.unit == "MilliMeter" and package.warnings == ()
    assert list(package.meshes) == ["cam"] and [item.name for item in package.items] == ["cam"] * 3
    found = package.meshes["cam"]
    np.testing.assert_allclose(found.vertices, mesh.vertices, atol=1e-5)
    assert np.array_equal(found.faces, mesh.faces)
    # Turned twice, the point (1, 2, 0): (-2 + 5, 1, 6), then (-1 + 5, 3, 12).
    corner = Mesh(np.array([[1.0, 2, 0]]), np.empty((0, 3), np.int64))
    placed = [corner.moved(item.transform).vertices[0].tolist() for item in package.items]
    assert placed == [[1, 2, 0], [3, 1, 6], [4, 3, 12]]


def test_copies_under_each_other_s_names_are_told(tmp_path: Path) -> None:
    """Part numbers exchanged, or what two items build: each mesh is still in its place, but a slicer shows it as another part."""
    path, mesh = tmp_path / "pair.3mf", prism(SQUARE)
    copies = [threemf.PartCopy("cam", "cam-1"), threemf.PartCopy("pin-1", "pin-1 1")]
    threemf.write_3mf(path, {"cam": mesh, "pin-1": mesh}, copies, "key")
    assert read_3mf(path).remarks == []
    with zipfile.ZipFile(path) as package:
        parts = {name: package.read(name) for name in package.namelist()}
    for one, other in (
        (b'partnumber="cam-1"', b'partnumber="pin-1 1"'),
        (b'<item objectid="4"', b'<item objectid="5"'),
    ):
        model = parts["3D/3dmodel.model"]
        assert one in model and other in model
        model = model.replace(one, b"@@").replace(other, one).replace(b"@@", other)
        with zipfile.ZipFile(path, "w") as package:
            for name, data in (parts | {"3D/3dmodel.model": model}).items():
                package.writestr(name, data)
        assert sorted(read_3mf(path).remarks) == [
            "'cam-1' is made of 'pin-1'",
            "'pin-1 1' is made of 'cam'",
        ]


def test_what_unpacks_to_far_more_than_it_is_is_not_unpacked(tmp_path: Path) -> None:
    path = write_3mf(tmp_path / "part.3mf", prism(SQUARE))
    with zipfile.ZipFile(path, "a", zipfile.ZIP_DEFLATED) as package:
        package.writestr("3D/more.model", bytes(20_000_000))
    tracemalloc.start()
    with pytest.raises(FileError, match="3D/more.model unpacks to 20 MB from 0.0[0-9]+ MB"):
        read_3mf(path)
    assert tracemalloc.get_traced_memory()[1] < 5e6
    tracemalloc.stop()


def test_3mf_unit_and_damage(tmp_path: Path) -> None:
    path = write_3mf(tmp_path / "part.3mf", prism(SQUARE), "Inch")
    assert read_3mf(path).unit == "Inch"
    data = path.read_bytes()
    for damaged in (data[: len(data) // 2], b"", b"PK nothing", b"solid"):
        path.write_bytes(damaged)
        with pytest.raises(FileError, match="not a"):
            read_3mf(path)
    with pytest.raises(FileError):
        read_3mf(tmp_path / "none.3mf")
