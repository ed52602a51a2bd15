"""Motion from outlines that other programs made: closed forms of a disc, every way to draw it, and files that are wrong."""

from __future__ import annotations

import csv
import json
import math
import re
import subprocess
import sys
import time
import tracemalloc
import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import ezdxf
import numpy as np
import pytest
import shapely
import trimesh
from hypothesis import given, settings
from hypothesis import strategies as st

from camgen.cli import main
from camgen.errors import DesignError, FileError, SpecError
from camgen.judge.follower_table import read_follower
from camgen.measuring.motion import recover
from camgen.measuring.outlines import Hints, read_outline
from camgen.numerics import low_passed
from camgen.pipeline import build as pipeline

# disc, off centre, roller
A = 20.0
E = 5.0
R = 6.0
LEVER = "oscillating,pivot=60/0,arm=55,radius=6,leaves=+1"
Draw = Callable[[Any], None]


def drawing(path: Path, draw: Draw, units: int | None = 4, version: str = "R2010") -> Path:
    document = ezdxf.new(version)
    if units is not None:
        document.units = units
    draw(document.modelspace())
    document.saveas(path)
    return path


def disc(path: Path, units: int = 4, scale: float = 1.0) -> Path:
    return drawing(path, lambda space: space.add_circle((E * scale, 0), A * scale), units)


def run(capsys: pytest.CaptureFixture[str], *arguments: object) -> tuple[int, dict[str, Any], str]:
    with pytest.raises(SystemExit) as done:
        main(["motion", *map(str, arguments), "--json"])
    out, err = capsys.readouterr()
    assert "Traceback" not in out + err
    return int(done.value.code or 0), json.loads(out), err


def codes(report: dict[str, Any]) -> dict[str, bool]:
    return {finding["code"]: finding["ok"] for finding in report["findings"]}


# ---- closed forms ----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("offset", [0.0, 3.0, -4.0])
def test_translating_roller_on_a_disc_is_a_slider_crank(tmp_path: Path, offset: float) -> None:
    ring = read_outline(disc(tmp_path / "disc.dxf")).ring
    assert ring is not None
    found = recover(
        ring, read_follower(f"translating,radius=6,offset={offset},at=0,direction_deg=0")
    )
    # with the way out along Ox the right is -Oy: roller centre (s, -offset) at a + r from the disc's centre
    x, y, offset = E * np.cos(found.theta), E * np.sin(found.theta), -offset
    assert found.s == pytest.approx(x + np.sqrt((A + R) ** 2 - (offset - y) ** 2), abs=1e-9)
    slope = (offset - y) * x / np.sqrt((A + R) ** 2 - (offset - y) ** 2) - y
    assert found.speed == pytest.approx(slope, abs=1e-4)


def test_flat_face_on_a_disc_is_harmonic(tmp_path: Path) -> None:
    ring = read_outline(disc(tmp_path / "disc.dxf")).ring
    assert ring is not None
    found = recover(ring, read_follower("translating,shape=flat,at=0"))
    assert found.s == pytest.approx(A + E * np.sin(found.theta), abs=1e-9)
    assert found.speed == pytest.approx(E * np.cos(found.theta), abs=1e-4)
    assert found.acceleration == pytest.approx(-E * np.sin(found.theta), abs=1e-4)
    assert np.max(np.abs(found.pressure_angle)) < 1e-9


@pytest.mark.parametrize("leaves", [1, -1])
@pytest.mark.parametrize("ahead", [0.0, 4.0, -3.0])
def test_swinging_face_on_a_disc(tmp_path: Path, leaves: int, ahead: float) -> None:
    """The disc's far side stands on the face: Re(conj(n) (c - P)) + A = ahead, n = exp(i s)."""
    ring = read_outline(disc(tmp_path / "disc.dxf")).ring
    assert ring is not None
    at = -leaves * 100
    found = recover(
        ring, read_follower(f"oscillating,shape=flat,pivot=80/0,face_offset={ahead},at_deg={at}")
    )
    spoke = E * np.exp(1j * found.theta) - 80
    wanted = np.angle(spoke) + leaves * np.arccos((ahead - A) / np.abs(spoke)) - np.radians(at)
    assert found.s == pytest.approx((wanted + math.pi) % math.tau - math.pi, abs=1e-9)
    foot = np.sqrt(np.abs(spoke) ** 2 - (ahead - A) ** 2)
    assert found.lever == pytest.approx(foot.min(), abs=1e-3)
    free = recover(
        ring,
        read_follower(f"oscillating,shape=flat,pivot=80/0,face_offset={ahead},leaves={leaves}"),
    )
    assert np.ptp(free.s) == pytest.approx(np.ptp(found.s), abs=1e-9)


def four_bar(theta: Any, leaves: int) -> Any:
    """Direction of an arm of 55 at (60, 0) whose end is A + R from the disc's centre."""
    spoke = E * np.exp(1j * theta) - 60
    d = np.abs(spoke)
    opening = np.arccos((d**2 + 55**2 - (A + R) ** 2) / (2 * d * 55))
    return np.unwrap(np.angle(spoke) + leaves * opening)


@pytest.mark.parametrize("leaves", [1, -1])
def test_swinging_roller_on_a_disc_is_a_four_bar(tmp_path: Path, leaves: int) -> None:
    ring = read_outline(disc(tmp_path / "disc.dxf")).ring
    assert ring is not None
    found = recover(ring, read_follower(LEVER.replace("+1", str(leaves))))
    wanted = four_bar(found.theta, leaves)
    assert found.s == pytest.approx(
        wanted - (wanted.min() if leaves > 0 else wanted.max()), abs=1e-9
    )


# ---- every way to draw it ----------------------------------------------------------------------------------------------


def by_arcs(space: Any) -> None:
    for a, b in ((0, 100), (200, 360), (100, 200)):
        space.add_arc((E, 0), A, a, b)


def by_half_polyline(space: Any) -> None:
    space.add_lwpolyline([(E + A, 0, 1), (E - A, 0, 0)], format="xyb")
    space.add_arc((E, 0), A, 180, 0)


def by_mirrored(space: Any) -> None:
    space.add_lwpolyline(
        [(-E - A, 0, -1), (A - E, 0, -1)],
        format="xyb",
        close=True,
        dxfattribs={"extrusion": (0, 0, -1)},
    )


def by_old_polyline(space: Any) -> None:
    space.add_polyline2d([(E + A, 0, 1), (E - A, 0, 1)], format="xyb", close=True)


def by_block(space: Any) -> None:
    space.doc.blocks.new("disc").add_circle((0, 0), A / 2)
    space.add_blockref("disc", (E, 0), dxfattribs={"xscale": 2, "yscale": 2})


def by_ellipse(space: Any) -> None:
    space.add_ellipse((E, 0), (A, 0), 1.0)


def by_spline(space: Any) -> None:
    angles = np.linspace(0, math.tau, 401)
    space.add_spline([(E + A * math.cos(t), A * math.sin(t), 0) for t in angles])


def by_periodic_spline(space: Any) -> None:
    """A closed spline as CAD programs write it: knots not clamped, its first control points repeated at its end.

    A uniform cubic B-spline has its own radius at control points of radius r: r (2 + cos(2 pi / n)) / 3 at its knots.
    """
    n = 200
    radius = A * 3 / (2 + math.cos(math.tau / n))
    points = [
        (E + radius * math.cos(t), radius * math.sin(t), 0) for t in np.arange(n) * math.tau / n
    ]
    space.add_spline(degree=3).set_closed(points)


def by_space_polyline(space: Any) -> None:
    z = E + A * np.exp(1j * np.linspace(0, math.tau, 2001))[:-1]
    space.add_polyline3d([(p.real, p.imag, 0) for p in z], close=True)


def by_lines(space: Any) -> None:
    z = E + A * np.exp(1j * np.linspace(0, math.tau, 2001))
    for k in np.random.default_rng(3).permutation(2000):
        a, b = (z[k], z[k + 1]) if k % 3 else (z[k + 1], z[k])
        space.add_line((a.real, a.imag + 1e-6 * (k % 7)), (b.real, b.imag))


def with_clutter(space: Any) -> None:
    by_arcs(space)
    space.add_circle((0, 0), 4)
    space.add_line((-50, 0), (50, 0))
    space.add_line((0, -50), (0, 50))
    space.add_text("a cam").set_placement((0, 60))
    space.add_arc((2, 2), 3, 10, 50)


@pytest.mark.parametrize(
    "draw, within",
    [
        (by_arcs, 1e-9),
        (by_half_polyline, 1e-9),
        (by_mirrored, 1e-9),
        (by_old_polyline, 1e-9),
        (by_block, 1e-9),
        (by_ellipse, 3e-6),
        (by_spline, 1e-5),
        (by_lines, 3e-6),
        (by_periodic_spline, 5e-6),
        (by_space_polyline, 3e-6),
        (with_clutter, 1e-9),
    ],
)
def test_however_it_is_drawn_the_motion_is_the_same(
    tmp_path: Path, draw: Draw, within: float
) -> None:
    outline = read_outline(drawing(tmp_path / "disc.dxf", draw))
    assert outline.ring is not None and all(finding.ok for finding in outline.findings)
    found = recover(outline.ring, read_follower(LEVER))
    wanted = four_bar(found.theta, 1)
    assert found.s == pytest.approx(wanted - wanted.min(), abs=within)


def package(path: Path, mesh: Any, unit: str) -> None:
    """A 3MF written by hand."""
    vertices = "".join(
        f'<vertex x="{x:.9g}" y="{y:.9g}" z="{z:.9g}"/>' for x, y, z in mesh.vertices
    )
    faces = "".join(f'<triangle v1="{a}" v2="{b}" v3="{c}"/>' for a, b, c in mesh.faces)
    schema = "http://schemas.microsoft.com/3dmanufacturing"
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr(
            "[Content_Types].xml",
            '<Types xmlns="http://schemas.openxmlformats.org/package/2006/content-types"><Default Extension="rels" '
            'ContentType="application/vnd.openxmlformats-package.relationships+xml"/><Default Extension="model" '
            'ContentType="application/vnd.ms-package.3dmanufacturing-3dmodel+xml"/></Types>',
        )
        archive.writestr(
            "_rels/.rels",
            '<Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships"><Relationship Id="r" '
            f'Target="/3D/3dmodel.model" Type="{schema}/2013/01/3dmodel"/></Relationships>',
        )
        archive.writestr(
            "3D/3dmodel.model",
            f'<?xml version="1.0"?><model unit="{unit}" xmlns="{schema}/core/2015/02"><resources><object id="1" type="model">'
            f"<mesh><vertices>{vertices}</vertices><triangles>{faces}</triangles></mesh></object></resources>"
            '<build><item objectid="1"/></build></model>',
        )


def test_a_package_in_inches_is_told_and_converted(tmp_path: Path) -> None:
    package(tmp_path / "disc.3mf", trimesh.creation.cylinder(1.0, 0.25, sections=720), "inch")
    outline = read_outline(tmp_path / "disc.3mf")
    assert [f.code for f in outline.findings if not f.ok] == ["MESH_UNITS"]
    assert outline.ring is not None and max(outline.ring.box) == pytest.approx(25.4, rel=1e-4)


@pytest.mark.parametrize("kind", ["stl", "3mf"])
def test_a_mesh_of_another_tool(tmp_path: Path, kind: str) -> None:
    polygon = shapely.Point(E, 0).buffer(A, quad_segs=500).difference(shapely.Point(0, 0).buffer(4))
    path = tmp_path / f"disc.{kind}"
    mesh = trimesh.creation.extrude_polygon(polygon, 6.0)
    if kind == "stl":
        mesh.export(path)
    else:
        package(path, mesh, "millimeter")
    for height in (None, 1.0):
        outline = read_outline(path, Hints(height))
        assert outline.ring is not None and all(finding.ok for finding in outline.findings)
        found = recover(outline.ring, read_follower(LEVER))
        wanted = four_bar(found.theta, 1)
        assert found.s == pytest.approx(
            wanted - wanted.min(), abs=2e-6
        )  # sagitta 2.5e-5 mm on an arm of 55, twice
        assert found.speed == pytest.approx(np.gradient(wanted, found.theta), abs=1e-3)
    with pytest.raises(FileError, match="no section at 7 mm"):
        read_outline(path, Hints(7.0))


def test_the_shaft_is_where_the_user_says(tmp_path: Path) -> None:
    path = drawing(tmp_path / "far.dxf", lambda space: space.add_circle((105, 30), A))
    ring = read_outline(path).ring
    assert ring is not None
    found = recover(ring, read_follower(LEVER + ",centre=100/30"))
    wanted = four_bar(found.theta, 1)
    assert found.s == pytest.approx(wanted - wanted.min(), abs=1e-9)
    with pytest.raises(DesignError, match="centre=X/Y"):
        recover(ring, read_follower(LEVER))


def test_a_layer_can_be_named(tmp_path: Path) -> None:
    def draw(space: Any) -> None:
        space.add_circle((E, 0), A, dxfattribs={"layer": "Cam"})
        space.add_lwpolyline(
            [(-90, -90), (90, -90), (90, 90), (-90, 90)], close=True, dxfattribs={"layer": "FRAME"}
        )

    path = drawing(tmp_path / "sheet.dxf", draw)
    ring = read_outline(path, Hints(layer="cam")).ring
    assert ring is not None and ring.area == pytest.approx(math.pi * A**2)
    with pytest.raises(FileError, match="Cam, FRAME"):
        read_outline(path, Hints(layer="CUT"))


# ---- the low-pass --------------------------------------------------------------------------------------------------------


@settings(max_examples=30)
@given(st.integers(1, 20), st.floats(0, 6.28), st.integers(0, 2))
def test_low_pass_keeps_phase_and_weighs_as_it_says(n: int, phase: float, order: int) -> None:
    theta = np.arange(720) * (math.tau / 720)
    weight = 1 / (1 + (n / 36) ** 4)
    wanted = weight * n**order * np.cos(n * theta + phase + order * math.pi / 2)
    assert low_passed(np.cos(n * theta + phase), order, 36) == pytest.approx(
        wanted, abs=1e-9 * n**2
    )


def test_facets_do_not_spoil_speed_and_acceleration(tmp_path: Path) -> None:
    z = E + A * np.exp(1j * np.linspace(0, math.tau, 361)[:-1])
    ring = read_outline(
        drawing(
            tmp_path / "f.dxf",
            lambda s: s.add_lwpolyline([(p.real, p.imag) for p in z], close=True),
        )
    ).ring
    assert ring is not None
    found = recover(ring, read_follower("translating,radius=6"))
    assert np.max(np.abs(np.diff(np.gradient(found.s, found.theta)))) > 0.02  # raw, it jumps
    x, y = E * np.cos(found.theta), E * np.sin(found.theta)  # way out along Oy
    root = np.sqrt((A + R) ** 2 - x**2)
    assert found.speed == pytest.approx(x + x * y / root, abs=2e-3)


# ---- a pair ------------------------------------------------------------------------------------------------------------


def test_lash_of_a_yoke(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Two faces 2 a + 0.5 apart on a disc of radius a: 0.5 free everywhere; 0.1 too near: jammed."""
    path = disc(tmp_path / "disc.dxf")
    first = "translating,shape=flat,direction_deg=0,at=10"
    for at, ok in ((30.5, True), (29.9, False)):
        second = f"translating,shape=flat,direction_deg=180,at={at}"
        code, report, _ = run(
            capsys, path, "--follower", first, "--second-follower", second, "-o", tmp_path
        )
        assert code == (0 if ok else 1) and codes(report)["INTERFERENCE"] is ok
        overlap = next(f for f in report["findings"] if f["code"] == "INTERFERENCE")
        assert (overlap["measured"], overlap["unit"]) == (
            pytest.approx(0 if ok else 0.1, abs=1e-9),
            "mm",
        )
        for key in ("lash_min_mm", "lash_max_mm"):
            assert report["numbers"][key] == pytest.approx(at - 30, abs=1e-9)


def test_our_own_conjugate_cam(
    tmp_path: Path, starter: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """The uniform-swing cam is turned over under the second tip; its figures are those of the build."""
    report = pipeline.build(
        starter, tmp_path, frozenset({"dxf"}), ['parts.make="cams"', "geometry.swing_deg=24"]
    )
    arm, at = math.hypot(60, 30), math.degrees(math.atan2(30, 60)) - 180
    follower = f"oscillating,pivot=60/0,arm={arm!r},radius=3,at_deg={at!r}"
    second = follower.replace(repr(at), repr(-at)) + ",flipped=true"
    path = tmp_path / "uniform-swing" / "uniform-swing-cam.dxf"
    code, found, _ = run(
        capsys, path, "--follower", follower, "--second-follower", second, "-o", tmp_path
    )
    assert code == 0
    assert found["numbers"]["swing_deg"] == pytest.approx(
        report.numbers["swing_recovered_dxf_deg"], abs=0.01
    )
    assert found["numbers"]["lash_max_deg"] == pytest.approx(
        report.numbers["lash_dxf_deg"], abs=0.005
    )
    alone = read_outline(path).ring
    assert alone is not None
    s = recover(alone, read_follower(follower)).s
    with open(tmp_path / "uniform-swing" / "motion.csv", encoding="utf-8") as file:
        rows = [float(row["swing_deg_dxf"]) for row in csv.DictReader(file)]
    assert np.degrees(s[::5]) == pytest.approx(np.array(rows[:-1]), abs=1e-9)


def grooved(space: Any) -> None:
    """A plate with a bore and a groove 2 R + 0.3 wide between two circles about (E, 0)."""
    for centre, radius in ((0, 70), (E, A + 2 * R + 0.3), (E, A), (0, 4)):
        space.add_circle((centre, 0), radius)


def test_both_walls_of_a_groove_and_its_lash(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = drawing(tmp_path / "plate.dxf", grooved)
    inner = "translating,radius=6,direction_deg=0,at=0,contour=3"
    outer = inner.replace("contour=3", "contour=2,inside=true")
    theta = np.linspace(0, math.tau, 7200, endpoint=False)
    x, y = E * np.cos(theta), E * np.sin(theta)
    low, high = (x + np.sqrt((A + R + more) ** 2 - y**2) for more in (0.0, 0.3))
    for text, wanted in ((inner, low), (outer, high)):
        follower = read_follower(text)
        ring = read_outline(path, contour=follower.contour).ring
        assert ring is not None and recover(ring, follower).s == pytest.approx(wanted, abs=1e-9)
    for first, second in ((inner, outer), (outer, inner)):
        code, report, _ = run(
            capsys, path, "--follower", first, "--second-follower", second, "-o", tmp_path
        )
        assert code == 0 and codes(report)["INTERFERENCE"]
        assert report["numbers"]["lash_min_mm"] == pytest.approx(np.min(high - low), abs=1e-9)
        assert report["numbers"]["lash_max_mm"] == pytest.approx(np.max(high - low), abs=1e-9)
    code, report, _ = run(
        capsys,
        path,
        "--follower",
        inner,
        "--second-follower",
        outer.replace("6", "6.5"),
        "-o",
        tmp_path,
    )
    assert code == 1 and not codes(report)["INTERFERENCE"]
    with pytest.raises(FileError, match="holds 4 closed contour"):
        read_outline(path, contour=5)


@pytest.mark.long
def test_our_own_groove_on_an_arm(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Walls of a disc cam's two plates; lash as the build judged it."""
    spec = Path(__file__).resolve().parents[2] / "specs" / "disc-cam.toml"
    follower = (
        "geometry.follower={motion='oscillating',shape='roller',radius=5,pivot_distance=90,arm=70}"
    )
    settings = [
        'geometry.closure="groove"',
        "parts.hub_height=0",
        "limits.pressure_angle_deg=45",
        follower,
    ]
    built = pipeline.build(spec, tmp_path, frozenset({"dxf"}), settings)
    files = [tmp_path / "disc-cam" / f"disc-cam-{wall}.dxf" for wall in ("inner", "outer")]
    at = math.degrees(math.acos((90**2 + 70**2 - 30**2) / (2 * 90 * 70)))
    inner = f"oscillating,pivot=90/0,arm=70,radius=5,at_deg={180 + at!r}"
    arguments = (
        "--second",
        files[1],
        "--second-follower",
        inner + ",contour=2,inside=true",
        "-o",
        tmp_path,
    )
    code, report, _ = run(capsys, files[0], "--follower", inner, *arguments)
    assert code == 0
    assert report["numbers"]["swing_deg"] == pytest.approx(
        built.numbers["swing_recovered_dxf_deg"], abs=1e-3
    )
    assert report["numbers"]["lash_max_deg"] == pytest.approx(
        built.numbers["lash_dxf_deg"], abs=1e-3
    )


# ---- what is written -----------------------------------------------------------------------------------------------------


def test_files_and_their_columns(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = disc(tmp_path / "My Disc.dxf")
    code, report, _ = run(capsys, path, "--follower", LEVER, "-o", tmp_path / "out")
    folder = tmp_path / "out" / "my-disc-motion"
    assert code == 0 and {p.name for p in folder.iterdir()} == {
        "motion.csv",
        "report.html",
        "report.json",
        "manifest.json",
    }
    assert json.loads((folder / "report.json").read_text("utf-8")) == report
    page = (folder / "report.html").read_text("utf-8")
    assert page.count("<svg") >= 5 and "low-passed at 36 harmonics" in page
    with open(folder / "motion.csv", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert list(rows[0]) == [
        "theta_deg",
        "swing_deg",
        "speed_deg_rad",
        "acceleration_deg_rad2",
        "pressure_angle_deg",
    ]
    assert [float(row["theta_deg"]) for row in rows] == [k / 4 for k in range(1441)] and rows[0][
        "swing_deg"
    ] == rows[-1]["swing_deg"]
    before = {p.name: p.read_bytes() for p in folder.iterdir()}
    run(capsys, path, "--follower", LEVER, "-o", tmp_path / "out")
    assert before == {p.name: p.read_bytes() for p in folder.iterdir()}


def test_a_follower_from_a_file(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    table = tmp_path / "follower.toml"
    table.write_text(
        '[follower]\nmotion = "oscillating"\npivot = [60, 0]\narm = 55\nradius = 6\nleaves = 1\n'
    )
    assert read_follower(str(table)) == read_follower(LEVER)
    with pytest.raises(FileError):
        read_follower(str(tmp_path / "none.toml"))


# ---- wrong files ---------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "units, scale, name", [(1, 1 / 25.4, "inches"), (6, 1e-3, "metres"), (5, 0.1, "centimetres")]
)
def test_other_units_are_told_and_converted(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], units: int, scale: float, name: str
) -> None:
    path = disc(tmp_path / "disc.dxf", units, scale)
    code, report, _ = run(capsys, path, "--follower", LEVER, "-o", tmp_path)
    assert code == 1 and [c for c, ok in codes(report).items() if not ok] == ["DXF_UNITS"]
    assert any(name in f["message"] for f in report["findings"])
    wanted = four_bar(np.linspace(0, math.tau, 7201), 1)
    assert report["numbers"]["swing_deg"] == pytest.approx(math.degrees(np.ptp(wanted)), abs=1e-6)


def test_a_drawing_without_units_is_taken_as_millimetres(tmp_path: Path) -> None:
    drawing(tmp_path / "r12.dxf", by_arcs, None, "R12")
    rows = [
        "0",
        "SECTION",
        "2",
        "ENTITIES",
        "0",
        "CIRCLE",
        "8",
        "0",
        "10",
        "5.0",
        "20",
        "0.0",
        "30",
        "0.0",
        "40",
        "20.0",
    ]
    (tmp_path / "bare.dxf").write_text("\n".join([*rows, "0", "ENDSEC", "0", "EOF", ""]))
    for name in ("r12", "bare"):
        outline = read_outline(tmp_path / f"{name}.dxf")
        assert outline.findings[0].ok and "names no unit" in outline.findings[0].message
        assert outline.ring is not None and outline.ring.area == pytest.approx(math.pi * A**2)


@pytest.mark.parametrize("gap, is_open", [(0.004, False), (0.05, True), (3.0, True)])
def test_an_open_contour_is_told_with_its_gap(tmp_path: Path, gap: float, is_open: bool) -> None:
    def draw(space: Any) -> None:
        space.add_arc((E, 0), A, 0, 180)
        space.add_arc((E, 0), A, 180, 360 - math.degrees(gap / A))
        space.add_circle((0, 0), 4)

    outline = read_outline(drawing(tmp_path / "open.dxf", draw))
    closed = next(f for f in outline.findings if f.code == "DXF_CLOSED")
    assert closed.ok is not is_open and (outline.ring is None) is is_open
    if is_open:
        assert (closed.measured, closed.unit) == (1, "contours")
        assert "(25.0000, 0.0000)" in closed.message
        told = re.search(r", are (\S+) mm apart", closed.message)
        assert told and float(told[1]) == pytest.approx(gap, rel=0.01)


def test_an_open_contour_ends_in_exit_code_1(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = drawing(tmp_path / "open.dxf", lambda space: space.add_arc((E, 0), A, 0, 350))
    code, report, _ = run(capsys, path, "--follower", LEVER, "-o", tmp_path)
    assert code == 1 and codes(report)["DXF_CLOSED"] is False and report["numbers"] == {}


def test_a_contour_that_branches_is_told(tmp_path: Path) -> None:
    def draw(space: Any) -> None:
        by_arcs(space)
        space.add_arc((E, 0), A, 0, 100)

    outline = read_outline(drawing(tmp_path / "twice.dxf", draw))
    assert outline.ring is None and "drawn twice" in outline.findings[-1].message


def test_a_contour_that_crosses_itself_is_told(tmp_path: Path) -> None:
    outline = read_outline(
        drawing(
            tmp_path / "bow.dxf",
            lambda s: s.add_lwpolyline([(-9, -9), (9, 9), (9, -9), (-9, 9)], close=True),
        )
    )
    assert (
        outline.ring is None
        and not outline.findings[-1].ok
        and "[0 0]" in outline.findings[-1].message
    )


def test_a_torn_mesh_is_told(tmp_path: Path) -> None:
    mesh = trimesh.creation.cylinder(A, 6.0)
    mesh.update_faces(np.arange(len(mesh.faces)) != 40)
    mesh.export(tmp_path / "torn.stl")
    outline = read_outline(tmp_path / "torn.stl")
    assert not all(f.ok for f in outline.findings if f.code in ("WATERTIGHT", "CLOSED"))


@pytest.mark.parametrize(
    "name, content, said",
    [
        ("a.dxf", b"", "is empty"),
        ("a.dxf", b"  \r\n", "is empty"),
        ("a.dxf", b"solid x\nfacet normal 0 0 1\n", "looks like STL"),
        ("a.stl", b"PK\x03\x04", "looks like 3MF"),
        ("a.dxf", b"%PDF-1.4 EOF", "looks like PDF"),
        ("a.dxf", b"AC1027\x00", "looks like DWG"),
        ("a.3mf", b"  0\nSECTION\n  2\nHEADER\n", "looks like DXF"),
        ("a.dxf", b"  0\nSECTION\n  2\nENTITIES\n", "cut short"),
        ("a.dxf", b"hello EOF", "not a valid DXF"),
        ("a.stl", b"hello", "not an STL file"),
        ("a.stl", b"\x00" * 80 + b"\x05\x00\x00\x00" + b"\x00" * 60, "cut short"),
        ("a.3mf", b"hello", "zip"),
        ("a.svg", b"<svg/>", "ends in '.svg'"),
        ("a", b"x", "ends in ''"),
    ],
)
def test_files_that_are_wrong(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], name: str, content: bytes, said: str
) -> None:
    (tmp_path / name).write_bytes(content)
    code, report, err = run(capsys, tmp_path / name, "--follower", LEVER, "-o", tmp_path)
    assert code == 4 and said in err and report["exit_code"] == 4


@pytest.mark.parametrize("radius, said", [(1e6, "is the unit wrong"), (1e-3, "is the unit wrong")])
def test_outlines_that_are_huge_or_tiny(tmp_path: Path, radius: float, said: str) -> None:
    with pytest.raises(FileError, match=said):
        read_outline(drawing(tmp_path / "d.dxf", lambda space: space.add_circle((0, 0), radius)))


def test_a_drawing_of_nothing_and_of_text(tmp_path: Path) -> None:
    for draw in (
        lambda space: None,
        lambda space: space.add_text("cam"),
        lambda space: space.add_circle((3, 3), 0),
    ):
        with pytest.raises(FileError, match="holds no outline"):
            read_outline(drawing(tmp_path / "d.dxf", draw))
    for draw, said in (
        (lambda space: space.add_blockref("none", (0, 0)), "block definition"),
        (lambda space: space.add_circle((math.nan, 0), 3), "not finite"),
        (
            lambda space: space.add_lwpolyline([(1e300, 0), (0, 1e300), (3, 3)], close=True),
            "as good as infinite",
        ),
    ):
        with pytest.raises(FileError, match=said):
            read_outline(drawing(tmp_path / "d.dxf", draw))
    with pytest.raises(FileError, match="No such file"):
        read_outline(tmp_path / "none.dxf")


def nine_nested_blocks(space: Any) -> None:
    space.doc.blocks.new("b0").add_circle((0, 0), A)
    for k in range(1, 10):
        block = space.doc.blocks.new(f"b{k}")
        for _ in range(10):
            block.add_blockref(f"b{k - 1}", (0, 0))
    space.add_blockref("b9", (0, 0))


def great_grid(space: Any) -> None:
    space.doc.blocks.new("b").add_circle((0, 0), A)
    rows = {"row_count": 30_000, "row_spacing": 1, "column_count": 30_000, "column_spacing": 1}
    space.add_blockref("b", (0, 0), dxfattribs=rows)


def block_in_itself(space: Any) -> None:
    block = space.doc.blocks.new("b")
    for x in range(2):
        block.add_blockref("B", (x, 0))
    space.add_blockref("b", (0, 0))


def thin_ellipses(space: Any) -> None:
    for k in range(200):
        space.add_ellipse((0, 0), (1e6 + k, 0), 1e-6)


def endless_ellipse(space: Any) -> None:
    space.add_ellipse((0, 0), (1e11, 0), 1e-6)


def endless_spline(space: Any) -> None:
    space.add_open_spline([(1e11 * math.cos(k), 1e11 * math.sin(k)) for k in range(2000)])


def stiff_spline(space: Any) -> None:
    space.add_open_spline([(math.cos(k), math.sin(k)) for k in range(2000)]).dxf.degree = 1000


def spline_through_too_much(space: Any) -> None:
    space.add_spline([(math.cos(k), math.sin(k)) for k in range(20_000)])


def great_arcs(space: Any) -> None:
    space.add_lwpolyline(
        [(5e4 * (k % 2), k * 1e-3, 1) for k in range(2000)], format="xyb", close=True
    )


@pytest.mark.long
@pytest.mark.parametrize(
    "draw, said",
    [
        (nine_nested_blocks, "about 1e9 entities"),
        (great_grid, "900000000 entities"),
        (block_in_itself, "holds itself"),
        (thin_ellipses, "2000000 chords"),
        (endless_ellipse, "chords for ELLIPSE"),
        (endless_spline, "chords for SPLINE"),
        (stiff_spline, "degree of 1000"),
        (spline_through_too_much, "20000 points to fit"),
        (great_arcs, "chords within"),
    ],
)
def test_what_a_small_file_stands_for_is_counted_first(
    tmp_path: Path, draw: Draw, said: str
) -> None:
    path = drawing(tmp_path / "bomb.dxf", draw)
    tracemalloc.start()
    start = time.process_time()
    with pytest.raises(FileError, match=f"bomb.dxf.*{said}"):
        read_outline(path)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert time.process_time() - start < 30 and peak < 3e8


@pytest.mark.long
def test_loose_lines_and_holes_by_the_thousand_are_read(tmp_path: Path) -> None:
    """2,500 free lines took a table of all ends against all others, 2,000 holes were compared with one another."""

    def loose(space: Any) -> None:
        for k in range(2500):
            space.add_line((k, 0), (k + 0.4, 1))

    def holes(space: Any) -> None:
        space.add_circle((0, 0), 1000)
        for k in range(2000):
            space.add_circle((10 * (k % 50) - 250, 10 * (k // 50) - 200), 2)

    tracemalloc.start()
    outline = read_outline(drawing(tmp_path / "loose.dxf", loose))
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert outline.ring is None and peak < 3e8
    assert outline.findings[-1].measured == 2500
    # from (k + 0.4, 1) to (k + 1.4, 1), and along y = 0
    assert ", are 1 mm apart" in outline.findings[-1].message
    start = time.process_time()
    outline = read_outline(drawing(tmp_path / "holes.dxf", holes))
    assert (
        outline.ring is not None
        and all(f.ok for f in outline.findings)
        and time.process_time() - start < 30
    )


def test_a_package_of_many_copies_is_counted_first(tmp_path: Path) -> None:
    package(tmp_path / "disc.3mf", trimesh.creation.cylinder(A, 6.0), "millimeter")
    with zipfile.ZipFile(tmp_path / "disc.3mf") as archive:
        files = {name: archive.read(name).decode() for name in archive.namelist()}
    nested = "".join(
        f'<object id="{k}"><components>'
        + f'<component objectid="{k - 1}"/>' * 10
        + "</components></object>"
        for k in range(2, 12)
    )
    text = files["3D/3dmodel.model"].replace("</resources>", nested + "</resources>")
    files["3D/3dmodel.model"] = text.replace('objectid="1"/></build', 'objectid="11"/></build')
    with zipfile.ZipFile(tmp_path / "disc.3mf", "w") as archive:
        for name, content in files.items():
            archive.writestr(name, content)
    with pytest.raises(FileError, match=r"disc\.3mf: places about 1e10 copies"):
        read_outline(tmp_path / "disc.3mf")


@pytest.mark.parametrize("unit", ["parsec", "Millimeter"])
def test_a_unit_that_there_is_not_is_refused(tmp_path: Path, unit: str) -> None:
    package(tmp_path / "disc.3mf", trimesh.creation.cylinder(A, 6.0), unit)
    with pytest.raises(FileError, match="unit that 3MF does not have"):
        read_outline(tmp_path / "disc.3mf")


# ---- wrong followers ---------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "text, paths",
    [
        ("oscilating,pivot=1/0,arm=1,radius=1", ["leaves", "motion"]),
        ("oscillating", ["arm", "pivot", "radius"]),
        ("oscillating,pivot=60/0,arm=55,radius=6", ["leaves"]),
        (LEVER + ",at_deg=150", ["leaves"]),
        (LEVER + ",shape=flat", ["arm", "radius"]),
        ("oscillating,shape=flat", ["pivot"]),
        ("oscillating,shape=flat,pivot=60/0,inside=true", ["inside"]),
        (LEVER + ",face_offset=3", ["face_offset"]),
        (LEVER + ",contour=0", ["contour"]),
        (LEVER + ",inside=2", ["inside"]),
        (LEVER.replace("60/0", "0/0"), ["pivot"]),
        (LEVER + ",arm=3", ["--follower arm"]),
        (LEVER.replace("55", "-55"), ["arm"]),
        (LEVER.replace("60/0", "60"), ["pivot"]),
        (LEVER + ",tip=3", ["tip"]),
        (LEVER + ",offset=3", ["offset"]),
        (LEVER.replace("radius=6", "radius=nan"), ["radius"]),
        (LEVER + ",x", ["--follower"]),
        ("translating", ["radius"]),
        ("translating,shape=flat,radius=3", ["radius"]),
        ("translating,radius=3,arm=4", ["arm"]),
        ("translating,shape=knife,offset=inf", ["offset"]),
        ("translating,shape=flat,offset=2", ["offset"]),
        ("oscillating,pivot=60/0,arm=55,shape=knife,at_deg=180", ["at_deg"]),
        (LEVER + ",centre=a/b", ["centre.0", "centre.1"]),
        (LEVER + ",flipped=3", ["flipped"]),
        (LEVER.replace("+1", "2"), ["leaves"]),
        (LEVER + ",turned_deg=400", ["turned_deg"]),
    ],
)
def test_each_wrong_key_of_a_follower_is_named(text: str, paths: list[str]) -> None:
    with pytest.raises(SpecError) as wrong:
        read_follower(text)
    assert sorted(fault.key for fault in wrong.value.faults) == paths


@pytest.mark.parametrize(
    "second, path",
    [
        ("translating,radius=6,at=3", "motion"),
        (LEVER.replace("leaves=+1", "at_deg=155,pivo=1/1"), "pivo"),
        ("oscillating,pivot=61/0,arm=55,radius=6,at_deg=155", "pivot"),
        (LEVER, "at_deg"),
        ("oscillating,pivot=60/0,arm=55,radius=6,at_deg=-155", "leaves"),
        ("oscillating,pivot=60/0,arm=55,radius=6,at_deg=155,inside=true", "leaves"),
    ],
)
def test_a_pair_must_fit(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], second: str, path: str
) -> None:
    first = LEVER.replace("leaves=+1", "at_deg=-155")
    code, report, _ = run(
        capsys,
        disc(tmp_path / "d.dxf"),
        "--follower",
        first,
        "--second-follower",
        second,
        "-o",
        tmp_path,
    )
    assert code == 2 and any(path in fault["path"] for fault in report["faults"])
    assert {p.name for p in tmp_path.iterdir()} == {"d.dxf"}


def test_a_second_file_needs_a_second_follower(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = disc(tmp_path / "d.dxf")
    code, _, err = run(capsys, path, "--follower", LEVER, "--second", path, "-o", tmp_path)
    assert code == 2 and "command line: 1 fault" in err


def test_followers_that_miss_the_outline(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = disc(tmp_path / "d.dxf")
    code, _, err = run(capsys, path, "--follower", LEVER.replace("55", "10"), "-o", tmp_path)
    assert code == 3 and "check pivot, arm" in err
    code, _, err = run(
        capsys, path, "--follower", "translating,radius=3,offset=100", "-o", tmp_path
    )
    assert code == 3 and "least distance from the shaft is 100 mm" in err
    code, _, err = run(
        capsys,
        path,
        "--follower",
        "oscillating,pivot=10/0,arm=30,leaves=1,radius=1",
        "-o",
        tmp_path,
    )
    assert code == 3 and "move the pivot out" in err
    code, report, _ = run(
        capsys, path, "--follower", "translating,radius=1,offset=18", "-o", tmp_path
    )
    assert code == 1 and codes(report)["CONTACT"] is False
    held = next(f["measured"] for f in report["findings"] if f["code"] == "CONTACT")
    # the disc reaches the line while E sin(theta) > 18 - (A + 1): all but a share arccos(3/5)/pi of the turn
    assert 50 < held < 100


def test_help_is_light_and_says_how(tmp_path: Path) -> None:
    done = subprocess.run(
        [sys.executable, "-m", "camgen", "motion", "--help"], capture_output=True, text=True
    )
    assert (
        done.returncode == 0
        and "pivot=X/Y" in done.stdout
        and "translating,shape=flat" in done.stdout
    )


def framed(space: Any) -> None:
    space.add_lwpolyline(
        [(-100, -100), (100, -100), (100, 100), (-100, 100)],
        close=True,
        dxfattribs={"layer": "FRAME"},
    )
    space.add_circle((0, 0), 30, dxfattribs={"layer": "CUT"})
    space.add_circle((0, 0), 4, dxfattribs={"layer": "CUT"})


def test_a_frame_round_the_cam_is_told(tmp_path: Path) -> None:
    path = drawing(tmp_path / "framed.dxf", framed)
    told = {f.code: f.ok for f in read_outline(path).findings}
    assert told["CONTOUR"] is False
    for chosen in ({"contour": 2}, {"hints": Hints(layer="CUT")}):
        outline = read_outline(path, **chosen)  # type: ignore[arg-type]
        assert outline.ring is not None and outline.ring.area == pytest.approx(math.pi * 900)
        assert {f.code: f.ok for f in outline.findings}["CONTOUR"]


def test_what_is_switched_off_does_not_count(tmp_path: Path) -> None:
    path = drawing(tmp_path / "off.dxf", framed)
    doc = ezdxf.readfile(path)
    doc.layers.add("FRAME").off()
    doc.saveas(path)
    outline = read_outline(path)
    assert outline.ring is not None and outline.ring.area == pytest.approx(math.pi * 900)


def test_what_was_asked_for_is_told(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """The disc lifts a roller by twice its eccentricity; the terminal says so, and where the report is."""
    with pytest.raises(SystemExit):
        main(
            [
                "motion",
                str(disc(tmp_path / "disc.dxf")),
                "--follower",
                "translating,radius=6",
                "-o",
                str(tmp_path),
            ]
        )
    said = capsys.readouterr().out
    assert f"the follower moves {2 * E:g} mm" in said and "disc-motion/report.html" in said.replace(
        "\n", ""
    )


def test_noise_of_points_in_the_pressure_angle_is_told(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """sin of the largest is eccentricity over the pitch circle's radius; points 10 um off tilt the normal by degrees."""
    turn = np.exp(1j * np.linspace(0, math.tau, 720, endpoint=False))
    exact = math.degrees(math.asin(8 / 36))
    for noise in (0.0, 0.01):
        z = 8 + (30 + noise * np.random.default_rng(4).standard_normal(720)) * turn
        path = tmp_path / "points.csv"
        path.write_text(
            "x,y\n" + "\n".join(f"{p.real:.6f},{p.imag:.6f}" for p in z), encoding="utf-8"
        )
        _, report, _ = run(capsys, path, "--follower", "translating,radius=6", "-o", tmp_path)
        raw, smooth = (report["numbers"][f"pressure_angle_{key}deg"] for key in ("", "low_passed_"))
        assert smooth == pytest.approx(exact, abs=0.01 if noise == 0 else 0.2)
        assert (
            (raw - exact > 1)
            == bool(noise)
            == any("the outline is rough" in said for said in report["remarks"])
        )
