"""Tables for machine tools: held against other formulas, against the outlines that are cut, and seen to be refused."""

import csv
import math

import ezdxf
import numpy as np
import pytest
from judged import judged, wrong

from camgen.errors import DesignError, FileError
from camgen.geometry.arcs import bulges
from camgen.geometry.outlines import Arc, Contour, Line, circle, rectangle
from camgen.geometry.rings import Ring
from camgen.judge.sheets import judge_path, judge_points
from camgen.parts.fits import offset
from camgen.pipeline import machining
from camgen.pipeline.build import build
from camgen.pipeline.jobs import read_mechanism

DXF = frozenset({"dxf"})
SETTINGS = ("output.profile_step_deg=0.5", "output.cutter_radius=3")


def rows(path):
    return list(csv.DictReader(path.read_text(encoding="utf-8").splitlines()))


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    from conftest import ROOT

    return build(ROOT / "specs" / "disc-cam.toml", tmp_path_factory.mktemp("made"), DXF, SETTINGS)


def test_a_profile_against_other_formulas(made):
    """Curvature by differences along the contacts; the pressure angle by tan = s' / (prime radius + s), no offset [Norton]."""
    assert made.ok
    table = rows(made.folder / "disc-cam-cam-profile.csv")
    assert len(table) == 720
    x, y, normal, kappa, pressure = (np.array([float(row[key]) for row in table]) for key in
                                     ("x_mm", "y_mm", "normal_deg", "curvature_per_mm", "pressure_angle_deg"))  # fmt: skip
    z, turn = x + 1j * y, np.radians(normal)
    way = np.roll(z, -1) - np.roll(z, 1)
    assert np.abs(np.cos(np.angle(way) - turn)).max() < 2e-3  # the normal stands on the way
    bend = np.abs((np.roll(turn, -1) - np.roll(turn, 1) + math.pi) % math.tau - math.pi) / np.abs(way)
    assert np.quantile(np.abs(bend - np.abs(kappa)) / np.abs(kappa).max(), 0.95) < 0.02  # jumps where segments meet aside
    cam = read_mechanism(made.folder / "spec.toml").cams[0]
    theta = np.radians(np.arange(0, 360, 0.5))
    prime = abs(complex(cam.pitch(np.zeros(1))[0]))
    tangent = np.abs(cam.program(theta, 1)) / (prime + cam.program(theta))
    assert np.degrees(np.arctan(tangent)) == pytest.approx(pressure, abs=1e-6)
    radius = np.array([float(row["radius_mm"]) for row in table])
    assert np.abs(z) == pytest.approx(radius, abs=1e-8)


def test_files_are_the_same_again_and_judged_again(made, tmp_path, root):
    again = build(root / "specs" / "disc-cam.toml", tmp_path, DXF, SETTINGS)
    names = [path.name for path in made.folder.iterdir() if "-profile" in path.name or "-path" in path.name]
    assert len(names) == 3 and all((made.folder / n).read_bytes() == (again.folder / n).read_bytes() for n in names)
    assert judged(again.folder, "dxf").ok and {"CUTTER"} <= {finding.code for finding in again.findings}
    table = again.folder / "disc-cam-cam-profile.csv"
    text = table.read_text()
    table.write_text(text.replace("25,90,0,25,", "25,90,0,25.01,", 1))
    assert [f.where for f in wrong(again.folder, "dxf")] == [table.name]
    table.write_text(text.replace("x_mm", "x"))
    with pytest.raises(FileError, match="not a table of a profile"):
        judged(again.folder, "dxf")
    table.write_text(text)
    path = again.folder / "disc-cam-cam-path.dxf"
    drawing = ezdxf.readfile(path)
    contour = next(iter(drawing.modelspace().query("LWPOLYLINE")))
    contour.set_points([(1.001 * x, 1.001 * y, *rest) for x, y, *rest in contour.get_points()])
    drawing.saveas(path)
    assert {f.code for f in wrong(again.folder, "dxf")} == {"CUTTER", "ROUND_TRIP"}


def test_the_path_is_lines_and_arcs_that_are_exact(made):
    """Every arc of the path is the cutter's radius wider than the cam's own: its centres are the cam's."""
    table = rows(made.folder / "disc-cam-cam-path.csv")
    contour = max(ezdxf.readfile(made.folder / "disc-cam-cam.dxf").modelspace().query("LWPOLYLINE"), key=len)
    points = np.array([complex(x, y) for x, y, *_ in contour.get_points()])
    starts = np.array([complex(float(row["x0_mm"]), float(row["y0_mm"])) for row in table])
    apart = np.abs(starts[:, None] - points[None]).min(axis=1)
    assert apart == pytest.approx(np.full(len(table), 3.0), abs=1e-8)


def drawn(path, contour):
    """The contour in a DXF, and as rows of a table."""
    from camgen.files.dxf import write_dxf
    from camgen.geometry.outlines import Region

    write_dxf(path, Region(contour), (), 1e-3)
    points, bulge = bulges(contour)
    return list(zip(points.tolist(), np.roll(points, -1).tolist(), bulge.tolist(), strict=True))


def hollow(radius):
    """A block whose top has a hollow of this radius."""
    return Contour((
        Line(-20 - 20j, 20 - 20j), Line(20 - 20j, 20 + 0j), Line(20 + 0j, complex(radius, 0)),
        Arc(0j, radius, 0.0, -math.pi), Line(complex(-radius, 0), -20 + 0j), Line(-20 + 0j, -20 - 20j),
    ))  # fmt: skip


def test_a_cutter_too_large_for_a_fillet_is_told(tmp_path):
    for radius, fits in ((4.0, True), (2.0, False)):
        outline = hollow(radius)
        table = drawn(tmp_path / "p.dxf", offset(outline, 3.0))
        findings = judge_path(tmp_path / "p.dxf", table, Ring(*bulges(outline)), 3.0, 0.002)
        assert [finding.ok for finding in findings] == [True, fits]
    assert findings[1].measured > 1 and "x 0.0" in findings[1].message.replace("-0.0", "0.0")  # the deepest place


def test_both_walls_of_a_groove(tmp_path):
    """The outer wall stands 0.2 mm off a roller of 5 mm on a base circle of 25; a cutter of 3 mm runs 3 mm within it."""
    from conftest import ROOT

    groove = ("geometry.closure='groove'", "parts.hub_height=0", *SETTINGS)
    report = build(ROOT / "specs" / "disc-cam.toml", tmp_path, DXF, groove)
    assert report.ok
    place = [float(rows(report.folder / f"disc-cam-{part}-profile.csv")[0]["radius_mm"]) for part in ("inner", "outer")]
    assert place == pytest.approx([25, 35.2])
    ends = [rows(report.folder / f"disc-cam-{part}-path.csv")[0] for part in ("inner", "outer")]
    radii = [math.hypot(float(row["x0_mm"]), float(row["y0_mm"])) for row in ends]
    assert radii == pytest.approx([28, 32.2])
    hollow = Ring(*bulges(circle(0j, 10)))
    for radius, fits in ((7.0, True), (7.1, False)):
        table = drawn(tmp_path / "p.dxf", circle(0j, radius))
        assert judge_path(tmp_path / "p.dxf", table, hollow, 3.0, 0.002, within=True)[1].ok is fits


def test_a_path_that_is_not_the_one_in_its_table_is_told(tmp_path):
    outline = rectangle(-10 - 10j, 10 + 10j)
    table = drawn(tmp_path / "p.dxf", offset(outline, 3.0))
    assert all(finding.ok for finding in judge_path(tmp_path / "p.dxf", table, Ring(*bulges(outline)), 3.0, 0.002))
    bent = [(a, b, 0.5 * bulge) for a, b, bulge in table]
    assert not judge_path(tmp_path / "p.dxf", bent, Ring(*bulges(outline)), 3.0, 0.002)[0].ok
    assert not judge_path(tmp_path / "p.dxf", table[1:], Ring(*bulges(outline)), 3.0, 0.002)[0].ok


def test_points_off_the_outline_are_told(tmp_path):
    ring = Ring(*bulges(circle(0j, 20)))
    points = 20 * np.exp(1j * np.arange(60))
    assert judge_points(tmp_path / "t.csv", points, ring, 0.002).ok
    points[7] *= 1.001
    assert judge_points(tmp_path / "t.csv", points, ring, 0.002).measured == pytest.approx(0.02, abs=2e-4)
    assert not judge_points(tmp_path / "t.csv", points[:0], ring, 0.002).ok


def test_an_undercut_has_no_normal_and_a_cutter_without_a_path_is_refused(tmp_path, root, monkeypatch):
    report = build(root / "specs" / "uniform-swing.toml", tmp_path, DXF, ("parts.make='cams'", *SETTINGS))
    table = rows(report.folder / "uniform-swing-cam-profile.csv")
    rides = [row for row in table if not row["normal_deg"]]
    assert report.ok and 0 < len(rides) < 10
    assert len({(row["x_mm"], row["y_mm"]) for row in rides}) == 1  # one corner

    def closes(contour, distance, name):
        """What a hollow with a mouth narrower than the cutter does."""
        neck = Contour((Arc(0j, 10, 0.2, math.tau - 0.4), Line(10 * np.exp(-0.2j), 8 * np.exp(-0.2j)),
                        Arc(0j, 8, -0.2, 0.4 - math.tau), Line(8 * np.exp(0.2j), 10 * np.exp(0.2j))))  # fmt: skip
        return offset(neck, distance, name)

    monkeypatch.setattr(machining, "offset", closes)
    with pytest.raises(DesignError, match="output.cutter_radius = 3 mm finds no path: use a smaller one"):
        build(root / "specs" / "disc-cam.toml", tmp_path, DXF, SETTINGS)
    assert not (tmp_path / "disc-cam").exists()
