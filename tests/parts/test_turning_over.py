"""Which parts fit upside down and move their machine wrongly there, and how they are marked."""

from __future__ import annotations

import cmath
import math
import tomllib
from pathlib import Path

import numpy as np
import pytest
import shapely
import trimesh

import camgen
from camgen import starters
from camgen.files.drawing import _Layout
from camgen.files.dxf import read_dxf
from camgen.files.sheet import Text
from camgen.files.views import area
from camgen.geometry.outlines import Contour, Region, circle, polygon
from camgen.machine.features import CamOutline, Eye, Mount, PinEyes
from camgen.machines.sources import read_mechanism
from camgen.parts.assembly import order_of_assembly
from camgen.parts.engraving import DEPTH, with_upper_side
from camgen.parts.part import Layer, Part, d_bore
from camgen.parts.turning_over import fit_turned_over
from camgen.pipeline.drawings import facts_of

CAM = CamOutline("contact", "cam", "shaft", None, Eye(None, 40j, 10.0))
KITE = (30 + 0j, 18j, -15 + 0j, -18j)  # its own image in Ox, and in no other line
HOOK = (30 + 0j, 10 + 14j, -15 + 6j, -10 - 12j, 9 - 12j)  # no line's image


def cam(corners: tuple[complex, ...], *holes: Contour, thickness: float = 4.0) -> Part:
    return Part("cam", "Cam", (Layer(Region(polygon(list(corners)), holes), 0.0, thickness),))


def flat(direction: float) -> Contour:
    """A bore with a flat that faces this way, deg; d_bore has it on +y."""
    return d_bore(6.0, 0.8).moved(cmath.exp(1j * math.radians(direction - 90)))


def is_found(part: Part) -> bool:
    return list(fit_turned_over([part], [CAM])) == ["cam"]


def test_a_flat_on_the_line_of_symmetry_is_safe_and_any_other_is_not() -> None:
    for direction in (0, 180):
        assert not is_found(cam(KITE, flat(direction)))
    for direction in (30, 90, 179):
        assert is_found(cam(KITE, flat(direction)))
    for direction in range(0, 360, 15):
        assert is_found(cam(HOOK, flat(direction)))


def test_about_a_round_bore_only_what_has_no_line_of_symmetry_is_found() -> None:
    for turn in (0.0, 17.3, 101.0):
        turned = tuple(z * cmath.exp(1j * math.radians(turn)) for z in KITE)
        assert not is_found(cam(turned, circle(0j, 3)))
    assert is_found(cam(HOOK, circle(0j, 3)))


def test_holes_that_lie_alike_let_a_part_turn_over_and_others_do_not() -> None:
    dowels = circle(-8 + 0j, 2), circle(8 + 0j, 2)
    assert is_found(cam(HOOK, *dowels))
    assert is_found(cam(KITE, *dowels)), "about the line between both the kite is another one"
    assert not is_found(cam(HOOK, circle(-8 + 0j, 2), circle(8 + 0j, 2), circle(1 + 5j, 2)))
    other_sizes = circle(-8 + 0j, 2), circle(8 + 0j, 1.5)
    assert not is_found(cam(KITE, *other_sizes)), "about the line through both it is the same"
    assert is_found(cam(HOOK, *other_sizes))


def test_what_has_a_hub_lies_one_way_alone_and_a_part_without_a_working_edge_counts_not() -> None:
    part = cam(HOOK, circle(0j, 3))
    hub = Layer(Region(circle(0j, 6), (circle(0j, 3),)), 4.0, 8.0)
    assert not is_found(Part("cam", "Cam", (*part.layers, hub)))
    assert list(fit_turned_over([part], [])) == []


@pytest.mark.parametrize(("direction", "wrong"), [(90, True), (60, True), (0, False), (180, False)])
def test_a_crank_keyed_beside_a_cam_lies_one_way_unless_its_pin_is_on_the_line_of_its_flat(
    direction: float, wrong: bool
) -> None:
    link = Region(circle(15 + 0j, 30), (flat(direction), circle(30 + 0j, 2.5)))
    crank = Part("crank", "Crank", (Layer(link, 0.0, 4.0),))
    disc = cam(KITE, flat(0))
    pin = PinEyes("P", Eye("crank", 30 + 0j, 5.0), Eye("rod", 0j, 5.1))
    body = [Mount("crank", "driver"), Mount("cam", "driver")]
    found = list(fit_turned_over([crank, disc], [CAM, pin], body))
    assert found == (["crank"] if wrong else [])
    apart = [Mount("crank", "driver"), Mount("cam", "other")]
    assert list(fit_turned_over([crank, disc], [CAM, pin], apart)) == [], "alone it is half a turn"


def test_the_crank_of_a_geneva_drive_says_which_side_is_up() -> None:
    """On a dowel crank and disc turn over together, and the disc is its own image in the line of both."""
    spec = starters.folder() / "gallery/geneva-table.toml"
    for settings, told in (((), {"crank", "lock-crank_to_table"}), (("geneva.0.gap=3",), set())):
        made = read_mechanism(spec, settings).resolved().assembly.parts
        assert {part.name for part in made if any("UP" in note for note in part.notes)} == told


def test_up_stands_beside_the_bore_upright_as_deep_as_letters() -> None:
    marked = with_upper_side(cam(tuple(2 * z for z in HOOK), flat(90)), True)
    assert [(layer.z0, layer.z1) for layer in marked.engraved] == [(4 - DEPTH, 4)] * 2
    u, p = (layer.region for layer in marked.engraved)
    assert len(u.holes) == 0 and len(p.holes) == 1
    assert max(z.real for z in corners(u)) < min(z.real for z in corners(p)), "read from the left"
    assert marked.notes == ("UP on its upper side",)


def corners(region: Region) -> list[complex]:
    from camgen.geometry.outlines import start_point

    return [complex(start_point(piece)) for piece in region.outer.pieces]


@pytest.mark.parametrize(
    "part, mark",
    [
        (cam(HOOK, circle(0j, 3), thickness=1.0), True),
        (cam(tuple(z / 3 for z in KITE), circle(0j, 3)), True),
        (cam(HOOK, circle(0j, 3)), False),
    ],
    ids=["thin", "small", "switched off"],
)
def test_without_room_or_leave_a_note_names_the_drawing(part: Part, mark: bool) -> None:
    plain = with_upper_side(part, mark)
    assert not plain.engraved
    assert plain.notes == (
        "mark it UP where its drawing has that; turned over it fits too, and moves wrongly",
    )


def built(folder: Path, **files: bool) -> tuple[camgen.Report, Path]:
    tables = tomllib.loads(starters.text("disc-cam"))
    tables["parts"] = {"make": "printed"}
    tables["files"] = files
    report = camgen.build(tables, folder, only=frozenset({"dxf", "stl", "report"}))
    return report, folder / "disc-cam"


@pytest.mark.long
def test_a_machines_cam_has_up_in_its_files_and_in_its_step(tmp_path: Path) -> None:
    report, folder = built(tmp_path / "marked", engrave=True)
    assert report.ok
    mesh = trimesh.load(next(folder.rglob("*-cam-contact.stl")))
    floor = mesh.triangles_center[:, 2].round(3) == 4 - DEPTH
    assert mesh.is_watertight and floor.any()
    assert (mesh.face_normals[floor][:, 2] > 0.99).all(), "the pockets open upwards"
    drawing = read_dxf(next(folder.rglob("*-cam-contact.dxf")), engraving=True)
    assert len(drawing.engraved) == 3, "U, P and its eye"
    step = (
        "Stand shaft on the bench, where blocks under ground are 15 mm high: it must not sink. Glue the disc cam (cam-contact) on "
        "shaft, flat on flat, with two-part glue, flush with the upper end of shaft. UP on its upper side."
    )
    assert step in next(folder.rglob("report.html")).read_text(encoding="utf-8")

    report, folder = built(tmp_path / "plain", up_marks=False, hole_letters=True)
    assert report.ok
    plain = trimesh.load(next(folder.rglob("*-cam-contact.stl")))
    assert set(np.unique(plain.vertices[:, 2].round(3))) == {0.0, 4.0}
    letters = trimesh.load(next(folder.rglob("*-ground.stl")))
    assert 5 - DEPTH in letters.vertices[:, 2].round(3), "hole_letters act in this machine too"
    assert "Mark it UP where its drawing has that" in next(folder.rglob("report.html")).read_text(
        encoding="utf-8"
    )


@pytest.mark.parametrize(
    ("name", "settings", "told"),
    [
        ("disc-cam", (), set()),  # its rise and return are alike
        ("gallery/valve", (), {"cam"}),
        ("indexing-cam", (), {"cam", "return-cam"}),
        ("gallery/groove", ("parts.bore_shape=",), {"inner"}),
        ("gallery/groove", (), set()),  # the flat and both pins fit one way up
    ],
)
def test_a_cam_alone_says_which_side_is_up_where_it_matters(
    name: str, settings: tuple[str, ...], told: set[str]
) -> None:
    machine = read_mechanism(starters.folder() / f"{name}.toml", settings)
    made = machine.assembly
    assert {p.name for p in made.parts if any("mark it UP" in n for n in p.notes)} == told
    said = {row[1] for row in order_of_assembly(made).rows if "ark it UP" in str(row[2])}
    assert said == told
    for part in made.parts:
        layout = _Layout(part, "d", 1e-3, facts_of(machine, part))
        marks = [
            each.at
            for each in layout.sheet.primitives
            if isinstance(each, Text) and each.text == "UP"
        ]
        assert len(marks) == (part.name in told)
        face = area(part.region, 1e-3)
        for at in marks:
            z = (at - layout.datum) / layout.scale
            assert face.contains(shapely.Point(z.real, z.imag)), "on the face, and in no hole"


def test_walls_of_a_groove_go_on_their_back_in_one_way() -> None:
    """The pins of the outer wall, turned or mirrored about the axis, meet the back's in one place only; those of the inner one
    turned."""
    parts = read_mechanism(starters.folder() / "gallery/groove.toml").assembly.by_name
    for name, mirrors in (("outer", (False, True)), ("inner", (False,))):
        pins = np.array(parts[name].centres[1:])
        ways = [
            turn
            for mirror in mirrors
            for turn in range(360)
            if max(
                np.min(abs(pin * np.exp(1j * np.radians(turn)) - pins))
                for pin in (pins.conjugate() if mirror else pins)
            )
            < 0.1
        ]
        assert ways == [0]
