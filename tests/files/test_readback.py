"""Reading files back: closed forms of circles and prisms, files by other writers, and damage of every kind."""

from __future__ import annotations

import struct
from pathlib import Path

import ezdxf
import numpy as np
import pytest
import trimesh
from hypothesis import given
from hypothesis import strategies as st

from camgen.errors import FileError
from camgen.files import readback
from camgen.files.readback import Mesh, mesh_faults, read_dxf, read_stl, slice_mesh
from camgen.geometry.rings import Ring, bore_circle, fit_circle, hole_circles, shape_of

SQUARE = np.array([0, 10, 10 + 10j, 10j], complex)


def straight(points: np.ndarray) -> Ring:
    return Ring(np.asarray(points, complex), np.zeros(len(points)))


def regular(count: int, radius: float = 10.0, centre: complex = 0j) -> np.ndarray:
    return centre + radius * np.exp(2j * np.pi * (np.arange(count) + 0.3) / count)


# ---- rings ----


@given(st.floats(0.01, 1e3), st.complex_numbers(max_magnitude=1e3), st.lists(st.floats(0.05, 6), min_size=2, max_size=40))
def test_a_circle_in_any_arcs(radius: float, centre: complex, steps: list[float]) -> None:
    """Area, length, box and facets of a circle cut into arcs of any sizes below a full turn, either way round."""
    sweep = np.array(steps) / sum(steps) * 2 * np.pi
    start = np.cumsum(sweep) - sweep
    ring = Ring(centre + radius * np.exp(1j * start), np.tan(sweep / 4))
    for one, sign in ((ring, 1), (ring.reversed(), -1), (ring.moved(1j, 3, mirror=True), 1)):
        assert one.area == pytest.approx(sign * np.pi * radius**2, rel=1e-9)
        assert one.length == pytest.approx(2 * np.pi * radius, rel=1e-9)
    size = radius + abs(centre)
    expected = [centre.real - radius, centre.imag - radius, centre.real + radius, centre.imag + radius]
    np.testing.assert_allclose(ring.box, expected, atol=1e-9 * size)
    for tolerance in (0.1 * radius, 1e-3 * radius):
        z = ring.facetted(tolerance)
        middles = np.abs((z + np.roll(z, -1)) / 2 - centre)
        assert np.max(np.abs(np.abs(z - centre) - radius)) < 1e-9 * size
        assert radius - middles.min() < tolerance * (1 + 1e-6) + 1e-9 * size
    assert ring.encloses(centre + 0.9 * radius) and not ring.encloses(centre + 1.2 * radius)


def test_nearly_straight_arcs_keep_their_area() -> None:
    """Bulges from 1e-12 to 0.05: the area between arc and chord, against its series 2 b c^2 / 6 (1 + b^2 / 5)."""
    for bulge in (1e-12, 1e-6, 1e-3, 0.0099, 0.0101, 0.05):
        lens = Ring(np.array([0, 1 + 0j]), np.array([bulge, bulge]))
        assert lens.area == pytest.approx(2 * (bulge / 3 + bulge**3 / 15 - bulge**5 / 105), rel=1e-9)


def test_flip_keeps_the_sense_and_moves_the_points() -> None:
    ring = Ring(SQUARE, np.array([0.2, 0, -0.3, 0]))
    flipped = ring.moved(-1, 0, mirror=True)
    assert flipped.area == pytest.approx(ring.area, rel=1e-14) and ring.area > 0
    np.testing.assert_array_equal(flipped.points, -np.conj(SQUARE)[::-1])
    expected = np.sort(-np.conj(ring.samples()))
    np.testing.assert_allclose(np.sort(flipped.samples()), expected, atol=1e-14)


def test_shape_sorts_outside_from_holes() -> None:
    hole, far = straight(2 + 2j + SQUARE / 10), straight(SQUARE + 50)
    shape = shape_of([hole, straight(SQUARE[::-1])])
    assert shape.outer.area == 100 and shape.area == 99 and shape.holes == (hole,)
    assert shape.moved(1j, 2, mirror=True).area == pytest.approx(99)
    with pytest.raises(ValueError, match="1 contour"):
        shape_of([straight(SQUARE), straight(far.points / 2 + 50)])
    with pytest.raises(ValueError, match="no closed contour"):
        shape_of([])


# ---- circles ----


@given(st.floats(0.5, 500), st.complex_numbers(max_magnitude=1e3), st.floats(0.8, 6.28), st.integers(4, 50))
def test_circle_through_points_of_an_arc(radius: float, centre: complex, span: float, count: int) -> None:
    z = centre + radius * np.exp(1j * np.linspace(0.1, 0.1 + span, count))
    found, r, deviation = fit_circle(z)
    size = radius + abs(centre)
    assert abs(found - centre) < 1e-11 * size and abs(r - radius) < 1e-11 * size and deviation < 1e-12 * size


def test_circle_fit_reports_a_point_that_is_off() -> None:
    z = regular(40)
    z[3] *= 1.001
    assert 0.009 < fit_circle(z)[2] < 0.01
    assert np.isnan(fit_circle(z[:2])[1])


def test_holes_of_a_shape() -> None:
    """A DXF circle is exact; a facetted hole with its vertices on the circle lets a smaller pin through."""
    drilled = Ring(4 + 4j + 1.5 * np.array([1, -1 + 0j]), np.ones(2))
    facetted = straight(regular(12, 1.0, 7 + 7j)[::-1])
    exact, flat = hole_circles(shape_of([straight(SQUARE), drilled, facetted]))
    assert exact.centre == pytest.approx(4 + 4j, abs=1e-14) and exact.diameter == pytest.approx(3, abs=1e-14)
    assert exact.deviation < 1e-14 and exact.clear_diameter == pytest.approx(3, abs=1e-14)
    assert flat.diameter == pytest.approx(2, abs=1e-14)
    assert flat.clear_diameter == pytest.approx(2 * np.cos(np.pi / 12), abs=1e-14)


@pytest.mark.parametrize("facets", [0, 48, 200])
@pytest.mark.parametrize("kind", ["keyway", "flat", "plain"])
def test_bores(kind: str, facets: int) -> None:
    """An 8 mm bore with keyway, flat or neither, off the origin by (0.3, -0.2): found to 1e-9 mm, DXF and facets."""
    start = {"keyway": np.arcsin(1.5 / 4), "flat": np.arccos(3.4 / 4), "plain": 0.0}[kind]
    sweep = 2 * np.pi - 2 * start
    corner = {"keyway": [5.5 - 1.5j, 5.5 + 1.5j], "flat": [], "plain": []}[kind]
    if facets:
        arc = 4 * np.exp(1j * (start + sweep * np.arange(facets + (kind != "plain")) / facets))
        ring = straight(np.concatenate([arc, corner]) + 0.3 - 0.2j)
    else:
        arc = 4 * np.exp(1j * (start + sweep * np.array([0, 0.5, 1])[: 2 if kind == "plain" else 3]))
        bulges = [np.tan(sweep / 8)] * 2 + [0.0] * (len(arc) - 2 + len(corner))
        ring = Ring(np.concatenate([arc, corner]) + 0.3 - 0.2j, np.array(bulges))
    for one in (ring, ring.reversed()):
        found = bore_circle(one, 8.0)
        assert found.centre == pytest.approx(0.3 - 0.2j, abs=1e-9)
        assert found.diameter == pytest.approx(8, abs=1e-9)
        assert found.deviation < 1e-9


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
        space.add_lwpolyline([(7, 5, -1), (3, 5, -1)], format="xyb", close=True, dxfattribs={"layer": "CUT"})
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


@pytest.mark.parametrize("damage", ["open", "nan", "zero_length", "plane", "duplicate", "entity", "lettering", "mark"])
def test_dxf_damage_is_named(tmp_path: Path, damage: str) -> None:
    (fault,) = read_dxf(write_dxf(tmp_path / "part.dxf", damage=damage)).faults
    assert fault.kind == {"nan": "number", "lettering": "entity", "mark": "plane"}.get(damage, damage)
    if damage == "open":
        assert fault.size == 10


def test_dxf_that_cannot_be_read(tmp_path: Path) -> None:
    path = write_dxf(tmp_path / "part.dxf")
    data = path.read_bytes()
    for share in (0.1, 0.5, 0.9, 0.999):
        path.write_bytes(data[: int(len(data) * share)])
        with pytest.raises(FileError, match="cut short"):
            read_dxf(path)
    for junk in (b"", b"solid\n", bytes(range(256)) * 4 + b"EOF", b"hello EOF", b"  0\nSECTION\n  x\nEOF\n  0\nEOF"):
        path.write_bytes(junk)
        with pytest.raises(FileError, match="not a"):
            read_dxf(path)
    for nothing in (tmp_path / "none.dxf", tmp_path):
        with pytest.raises(FileError):
            read_dxf(nothing)


# ---- meshes ----


def prism(outline: np.ndarray, height: float = 6.0, holes: tuple[np.ndarray, ...] = ()) -> Mesh:
    """Prism by trimesh's own extrusion (another route than the project's), float32 as an STL holds it."""
    from shapely import Polygon

    rings = [np.column_stack([z.real, z.imag]) for z in (outline, *holes)]
    solid = trimesh.creation.extrude_polygon(Polygon(rings[0], rings[1:]), height)
    return Mesh(solid.vertices.astype(np.float32).astype(float), np.asarray(solid.faces))


def write_stl(path: Path, mesh: Mesh) -> Path:
    row = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
    rows = np.zeros(len(mesh.faces), row)
    rows["corners"] = mesh.vertices[mesh.faces]
    path.write_bytes(b" " * 80 + struct.pack("<I", len(rows)) + rows.tobytes())
    return path


OUTLINE, HOLE = regular(300, 30.0) * (1 + 0.2 * np.cos(2 * np.angle(regular(300)))), regular(40, 4.0, 2 + 1j)


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
            single = source.real.astype(np.float32).astype(float) + 1j * source.imag.astype(np.float32)
            assert np.array_equal(np.sort(ring.points), np.sort(single))
        assert outer.area > 0 > hole.area
    assert slice_mesh(mesh, 7.0) == []


def test_slice_of_a_ball_at_vertices_and_between() -> None:
    """Rings of an icosphere at heights that hit its vertices and at others: closed, about the right area."""
    ball = trimesh.creation.icosphere(4, 10.0)
    mesh = Mesh(np.asarray(ball.vertices), np.asarray(ball.faces))
    for z in (0.0, 1.0, float(mesh.vertices[77, 2]), -9.0):
        (ring,) = slice_mesh(mesh, z)
        assert ring.area == pytest.approx(np.pi * (100 - z * z), rel=0.02)


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


def test_mesh_faults_are_counted_one_by_one() -> None:
    mesh = prism(OUTLINE, holes=(HOLE,))
    volume = mesh_faults(mesh).volume
    missing = mesh_faults(Mesh(mesh.vertices, mesh.faces[1:]))
    assert (missing.open_edges, missing.flipped_edges, missing.crowded_edges) == (3, 0, 0)
    flipped = mesh.faces.copy()
    flipped[5] = flipped[5, ::-1]
    assert mesh_faults(Mesh(mesh.vertices, flipped)).flipped_edges == 3
    double = mesh_faults(Mesh(mesh.vertices, np.vstack([mesh.faces, mesh.faces[:1]])))
    assert double.crowded_edges == 3
    inside_out = mesh_faults(Mesh(mesh.vertices, mesh.faces[:, ::-1]))
    assert inside_out.count == 0 and inside_out.volume == pytest.approx(-volume)
    flat = mesh.vertices.copy()
    flat[mesh.faces[0, 0]] = flat[mesh.faces[0, 1]]
    assert mesh_faults(Mesh(flat, mesh.faces)).degenerate > 0
    apart = Mesh(np.vstack([mesh.vertices, mesh.vertices + 100]), np.vstack([mesh.faces, mesh.faces + 680]))
    assert mesh_faults(apart).bodies == 2


def test_a_section_through_a_hole_in_the_wall_does_not_close() -> None:
    mesh = prism(OUTLINE)
    walls = np.flatnonzero(np.ptp(mesh.vertices[mesh.faces][:, :, 2], axis=1) > 0)
    with pytest.raises(ValueError, match="does not close"):
        slice_mesh(Mesh(mesh.vertices, np.delete(mesh.faces, walls[7], axis=0)), 3.0)
    flipped = mesh.faces.copy()
    flipped[walls[7]] = flipped[walls[7], ::-1]
    with pytest.raises(ValueError, match="does not close"):
        slice_mesh(Mesh(mesh.vertices, flipped), 3.0)


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
    identity, turned = lib3mf.get_wrapper().GetIdentityTransform(), lib3mf.get_wrapper().GetIdentityTransform()
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
    package = readback.read_3mf(write_3mf(tmp_path / "part.3mf", mesh))
    assert package.unit == "MilliMeter" and package.warnings == ()
    assert list(package.meshes) == ["cam"] and [item.name for item in package.items] == ["cam"] * 3
    found = package.meshes["cam"]
    np.testing.assert_allclose(found.vertices, mesh.vertices, atol=1e-5)
    assert np.array_equal(found.faces, mesh.faces)
    # Turned twice, the point (1, 2, 0): (-2 + 5, 1, 6), then (-1 + 5, 3, 12).
    corner = Mesh(np.array([[1.0, 2, 0]]), np.empty((0, 3), np.int64))
    placed = [corner.moved(item.transform).vertices[0].tolist() for item in package.items]
    assert placed == [[1, 2, 0], [3, 1, 6], [4, 3, 12]]


def test_3mf_unit_and_damage(tmp_path: Path) -> None:
    path = write_3mf(tmp_path / "part.3mf", prism(SQUARE), "Inch")
    assert readback.read_3mf(path).unit == "Inch"
    data = path.read_bytes()
    for damaged in (data[: len(data) // 2], b"", b"PK nothing", b"solid"):
        path.write_bytes(damaged)
        with pytest.raises(FileError, match="not a"):
            readback.read_3mf(path)
    with pytest.raises(FileError):
        readback.read_3mf(tmp_path / "none.3mf")
