"""Tables for machine tools: held against other formulas, against the outlines that are cut, and seen to be refused."""

import csv
import io
import math
import shutil
from dataclasses import replace

import ezdxf
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from judged import judged, wrong

from camgen.errors import DesignError, FileError
from camgen.geometry.arcs import bulges
from camgen.geometry.outlines import Arc, Contour, Line, circle, rectangle
from camgen.geometry.rings import Ring
from camgen.judge.machine_tables import Step, judge_path
from camgen.machines.sources import read_mechanism
from camgen.parts.fits import offset
from camgen.pipeline import machining
from camgen.pipeline.build import build
from camgen.pipeline.case import Case

DXF = frozenset({"dxf"})
SETTINGS = ("output.profile_step_deg=0.5", "output.cutter_radius=3")


def rows(path):
    return list(csv.DictReader(path.read_text(encoding="utf-8").splitlines()))


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    from conftest import ROOT

    return build(ROOT / "specs" / "disc-cam.toml", tmp_path_factory.mktemp("made"), DXF, SETTINGS)


@pytest.mark.long
def test_a_profile_against_other_formulas(made):
    """Curvature by differences along the contacts; the pressure angle by tan = s' / (prime radius + s), no offset [Norton]."""
    assert made.ok
    table = rows(made.folder / "disc-cam-cam-profile.csv")
    assert len(table) == 720
    x, y, normal, kappa, pressure = (
        np.array([float(row[key]) for row in table])
        for key in ("x_mm", "y_mm", "normal_deg", "curvature_per_mm", "pressure_angle_deg")
    )
    z, turn = x + 1j * y, np.radians(normal)
    way = np.roll(z, -1) - np.roll(z, 1)
    assert np.abs(np.cos(np.angle(way) - turn)).max() < 2e-3  # the normal stands on the way
    bend = np.abs((np.roll(turn, -1) - np.roll(turn, 1) + math.pi) % math.tau - math.pi) / np.abs(
        way
    )
    assert (
        np.quantile(np.abs(bend - np.abs(kappa)) / np.abs(kappa).max(), 0.95) < 0.02
    )  # jumps where segments meet aside
    cam = read_mechanism(made.folder / "spec.toml").cams[0]
    theta = np.radians(np.arange(0, 360, 0.5))
    prime = abs(complex(cam.pitch(np.zeros(1))[0]))
    tangent = np.abs(cam.program(theta, 1)) / (prime + cam.program(theta))
    assert np.degrees(np.arctan(tangent)) == pytest.approx(pressure, abs=1e-6)
    radius = np.array([float(row["radius_mm"]) for row in table])
    assert np.abs(z) == pytest.approx(radius, abs=1e-8)


@pytest.mark.long
def test_files_are_the_same_again_and_judged_again(made, tmp_path, root):
    again = build(root / "specs" / "disc-cam.toml", tmp_path, DXF, SETTINGS)
    names = [
        path.name
        for path in made.folder.iterdir()
        if "-profile" in path.name or "-path" in path.name
    ]
    assert len(names) == 3 and all(
        (made.folder / n).read_bytes() == (again.folder / n).read_bytes() for n in names
    )
    assert judged(again.folder, "dxf").ok and {"CUTTER"} <= {
        finding.code for finding in again.findings
    }
    table = again.folder / "disc-cam-cam-profile.csv"
    text = table.read_text()
    table.write_text(text.replace("25,90,0,25,", "25,90,0,25.01,", 1))
    assert {str(f.where).split(",")[0] for f in wrong(again.folder, "dxf")} == {table.name}
    table.write_text(text.replace("x_mm", "x"))
    with pytest.raises(FileError, match="its columns must be theta_deg, radius_mm"):
        judged(again.folder, "dxf")
    table.write_text(text)
    path = again.folder / "disc-cam-cam-path.dxf"
    drawing = ezdxf.readfile(path)
    contour = next(iter(drawing.modelspace().query("LWPOLYLINE")))
    contour.set_points([(1.001 * x, 1.001 * y, *rest) for x, y, *rest in contour.get_points()])
    drawing.saveas(path)
    assert {f.code for f in wrong(again.folder, "dxf")} == {"CUTTER", "ROUND_TRIP"}


@pytest.mark.long
def test_the_path_is_lines_and_arcs_that_are_exact(made):
    """Every arc of the path is the cutter's radius wider than the cam's own: its centres are the cam's."""
    table = rows(made.folder / "disc-cam-cam-path.csv")
    contour = max(
        ezdxf.readfile(made.folder / "disc-cam-cam.dxf").modelspace().query("LWPOLYLINE"), key=len
    )
    points = np.array([complex(x, y) for x, y, *_ in contour.get_points()])
    starts = np.array([complex(float(row["x0_mm"]), float(row["y0_mm"])) for row in table])
    apart = np.abs(starts[:, None] - points[None]).min(axis=1)
    assert apart == pytest.approx(np.full(len(table), 3.0), abs=1e-8)


def drawn(path, contour):
    """The contour in a DXF, and as steps of a table."""
    from camgen.files.dxf import write_dxf
    from camgen.geometry.outlines import Region

    write_dxf(path, Region(contour), (), 1e-3)
    return steps(*bulges(contour))


def steps(points, bulge):
    """Edges as steps of a table, their centres by the sagitta's formula."""
    found = []
    for a, b, t in zip(points.tolist(), np.roll(points, -1).tolist(), bulge.tolist(), strict=True):
        if t:
            centre = (a + b) / 2 + 0.25j * (b - a) * (1 / t - t)
            found.append(
                Step(
                    "arc ccw" if t > 0 else "arc cw",
                    a,
                    b,
                    centre,
                    abs(a - centre),
                    4 * math.atan(t),
                )
            )
        else:
            found.append(Step("line", a, b, complex(math.nan, math.nan), math.nan, math.nan))
    return found


def hollow(radius):
    """A block whose top has a hollow of this radius."""
    return Contour(
        (
            Line(-20 - 20j, 20 - 20j),
            Line(20 - 20j, 20 + 0j),
            Line(20 + 0j, complex(radius, 0)),
            Arc(0j, radius, 0.0, -math.pi),
            Line(complex(-radius, 0), -20 + 0j),
            Line(-20 + 0j, -20 - 20j),
        )
    )


def test_a_cutter_too_large_for_a_fillet_is_told(tmp_path):
    for radius, fits in ((4.0, True), (2.0, False)):
        outline = hollow(radius)
        table = drawn(tmp_path / "p.dxf", offset(outline, 3.0))
        findings = judge_path(tmp_path / "p.dxf", table, Ring(*bulges(outline)), 3.0, 0.002)
        assert [finding.code for finding in findings if not finding.ok] == (
            [] if fits else ["CUTTER"]
        )
    said = findings[-1].message.replace("-0.0", "0.0")
    assert findings[-1].measured > 1 and "at x 0.000, y -2.000 mm" in said  # the deepest place


@pytest.mark.long
def test_both_walls_of_a_groove(tmp_path):
    """The outer wall stands 0.2 mm off a roller of 5 mm on a base circle of 25; a cutter of 3 mm runs 3 mm within it."""
    from conftest import ROOT

    groove = ("geometry.closure='groove'", "parts.hub_height=0", *SETTINGS)
    report = build(ROOT / "specs" / "disc-cam.toml", tmp_path, DXF, groove)
    assert report.ok
    place = [
        float(rows(report.folder / f"disc-cam-{part}-profile.csv")[0]["radius_mm"])
        for part in ("inner", "outer")
    ]
    assert place == pytest.approx([25, 35.2])
    ends = [rows(report.folder / f"disc-cam-{part}-path.csv")[0] for part in ("inner", "outer")]
    radii = [math.hypot(float(row["x0_mm"]), float(row["y0_mm"])) for row in ends]
    assert radii == pytest.approx([28, 32.2])
    hollow = Ring(*bulges(circle(0j, 10)))
    for radius, fits in ((7.0, True), (7.1, False)):
        table = drawn(tmp_path / "p.dxf", circle(0j, radius))
        assert judge_path(tmp_path / "p.dxf", table, hollow, 3.0, 0.002, within=True)[-1].ok is fits


def test_a_path_that_is_not_the_one_in_its_table_is_told(tmp_path):
    outline = rectangle(-10 - 10j, 10 + 10j)
    table = drawn(tmp_path / "p.dxf", offset(outline, 3.0))
    assert all(
        finding.ok
        for finding in judge_path(tmp_path / "p.dxf", table, Ring(*bulges(outline)), 3.0, 0.002)
    )
    assert [
        f.code
        for f in judge_path(tmp_path / "p.dxf", table[1:], Ring(*bulges(outline)), 3.0, 0.002)
        if not f.ok
    ]
    for off, ok in ((1.8e-4, True), (2.2e-4, False)):
        aside = [
            replace(step, start=step.start + off, end=step.end + off, centre=step.centre + off)
            for step in table
        ]
        found = [
            f
            for f in judge_path(tmp_path / "p.dxf", aside, Ring(*bulges(outline)), 3.0, 0.002)
            if not f.ok
        ]
        assert [(f.code, str(f.where)) for f in found] == ([] if ok else [("ROUND_TRIP", "p.csv")])
    odd = [replace(table[0], kind="arc cw"), *table[1:]]
    (kind, _) = [
        f
        for f in judge_path(tmp_path / "p.dxf", odd, Ring(*bulges(outline)), 3.0, 0.002)
        if not f.ok
    ]
    assert str(kind.where) == "p.csv, piece" and "not row 1" in kind.message
    gap = [replace(table[0], end=table[0].end + 1e-3), *table[1:]]
    found = [
        f
        for f in judge_path(tmp_path / "p.dxf", gap, Ring(*bulges(outline)), 3.0, 0.002)
        if "x0_mm" in str(f.where)
    ]
    assert [f.ok for f in found] == [False] and found[0].measured == pytest.approx(1e-3, rel=1e-6)
    none = complex(math.nan, math.nan)  # a closed way round, but a shorter one
    cut = [Step("line", table[-1].start, table[0].end, none, math.nan, math.nan), *table[1:-1]]
    assert [
        str(f.where)
        for f in judge_path(tmp_path / "p.dxf", cut, Ring(*bulges(outline)), 3.0, 0.002)
        if not f.ok
    ] == ["p.csv"]


@pytest.mark.long
def test_an_undercut_has_no_normal_and_a_cutter_without_a_path_is_refused(
    tmp_path, root, monkeypatch
):
    report = build(
        root / "specs" / "uniform-swing.toml", tmp_path, DXF, ("parts.make='cams'", *SETTINGS)
    )
    table = rows(report.folder / "uniform-swing-cam-profile.csv")
    rides = [row for row in table if not row["normal_deg"]]
    assert report.ok and 0 < len(rides) < 10
    assert len({(row["x_mm"], row["y_mm"]) for row in rides}) == 1  # one corner

    def closes(contour, distance, name):
        """What a hollow with a mouth narrower than the cutter does."""
        neck = Contour(
            (
                Arc(0j, 10, 0.2, math.tau - 0.4),
                Line(10 * np.exp(-0.2j), 8 * np.exp(-0.2j)),
                Arc(0j, 8, -0.2, 0.4 - math.tau),
                Line(8 * np.exp(0.2j), 10 * np.exp(0.2j)),
            )
        )
        return offset(neck, distance, name)

    monkeypatch.setattr(machining, "offset", closes)
    with pytest.raises(
        DesignError, match="files.cutter_radius = 3 mm finds no path: use a smaller one"
    ):
        build(root / "specs" / "disc-cam.toml", tmp_path, DXF, SETTINGS)
    assert not (tmp_path / "disc-cam").exists()


# ---- each column, damaged --------------------------------------------------------------------------------------------

ARM = (
    "geometry.follower={motion='oscillating', shape='roller', radius=8, pivot_distance=60, arm=55}"
)
ARM_FACE = "geometry.follower={motion='oscillating', shape='flat', pivot_distance=80}"
FACE = "geometry.follower={motion='translating', shape='flat', face_width=60}"
MACHINES = {
    "roller": ("disc-cam",),
    "arm": ("disc-cam", ARM),
    "knife": ("disc-cam", "geometry.follower={motion='translating', shape='knife'}"),
    "face": ("disc-cam", FACE, "limits.least_radius=0"),
    "face on an arm": (
        "disc-cam",
        ARM_FACE,
        "limits.least_radius=0",
        "geometry.base_radius=30",
        "segment.0.lift=5",
    ),
    "groove": ("disc-cam", "geometry.closure='groove'", "parts.hub_height=0"),
    "pair": ("disc-cam", "geometry.closure='conjugate'", "geometry.tip_clearance=0.1"),
    "undercut": ("uniform-swing", "parts.make='cams'"),
}
# Where a column is judged; a damage of a whole column, larger than rounding and less than a shop would see.
COLUMNS = {
    "theta_deg": (1.0, "theta_deg"),
    "radius_mm": (1e-3, "radius_mm and angle_deg"),
    "angle_deg": (1e-3, "radius_mm and angle_deg"),
    "x_mm": (1e-3, "radius_mm and angle_deg"),
    "y_mm": (1e-3, "radius_mm and angle_deg"),
    "normal_deg": (1.0, "normal_deg"),
    "curvature_per_mm": (0.02, "curvature_per_mm"),
    "pressure_angle_deg": (1e-3, "pressure_angle_deg"),
}


@pytest.fixture(scope="module", params=MACHINES)
def case(request, tmp_path_factory):
    """A build with tables, of one kind of follower."""
    from conftest import ROOT

    spec, *keys = MACHINES[request.param]
    report = build(
        ROOT / "specs" / f"{spec}.toml", tmp_path_factory.mktemp("made"), DXF, (*keys, *SETTINGS)
    )
    assert report.ok, [finding for finding in report.findings if not finding.ok]
    return Case(read_mechanism(report.folder / "spec.toml"), report.folder)


def failing(case, path, head, table):
    """Where findings fail, less the file's name, with other rows in a table; the file is as it was afterwards."""
    was = path.read_bytes()
    text = io.StringIO()
    csv.writer(text, lineterminator="\n").writerows([head, *table])
    path.write_text(text.getvalue(), encoding="utf-8")
    try:
        return {
            str(f.where).removeprefix(f"{path.name}, ").partition(", row")[0]
            for f in machining.judge_tables(case)
            if not f.ok
        }
    finally:
        path.write_bytes(was)


def cells(path):
    head, *table = csv.reader(path.read_text(encoding="utf-8").splitlines())
    return head, table


@pytest.mark.long
@pytest.mark.parametrize("column", COLUMNS)
def test_a_column_of_a_profile_that_is_off_is_told(case, column):
    more, where = COLUMNS[column]
    for path in case.folder.glob("*-profile.csv"):
        head, table = cells(path)
        k = head.index(column)
        for row in table:
            row[k] = str(float(row[k]) + more) if row[k] else row[k]
        assert any(each.startswith(where) for each in failing(case, path, head, table)), path.name


@pytest.mark.long
@settings(max_examples=6)
@given(data=st.data())
def test_one_cell_that_is_off_is_told(case, data):
    """Any cell of any row; a curvature by more than its outline's edges differ by."""
    path = data.draw(st.sampled_from(sorted(case.folder.glob("*-profile.csv"))))
    head, table = cells(path)
    column, row = data.draw(st.sampled_from(sorted(COLUMNS))), data.draw(st.sampled_from(table))
    k, more = head.index(column), data.draw(st.sampled_from([-1.0, 1.0]))
    if row[k]:
        row[k] = str(float(row[k]) + more)
        assert failing(case, path, head, table)
    if column in ("normal_deg", "curvature_per_mm"):
        row[k] = "" if row[k] else "0"
        assert failing(case, path, head, table)


@pytest.mark.long
@pytest.mark.parametrize(
    "change",
    [lambda t: t[1:], lambda t: [*t, t[0]], lambda t: t[::-1], lambda t: [t[1], t[0], *t[2:]]],
)
def test_rows_that_are_lost_doubled_or_in_another_order_are_told(case, change):
    for path in case.folder.glob("*-profile.csv"):
        head, table = cells(path)
        assert failing(case, path, head, change(table))


PIECES = {
    "x0_mm": "x0_mm",
    "y0_mm": "x0_mm",
    "x1_mm": "x0_mm",
    "y1_mm": "x0_mm",
    "centre_x_mm": "centre_x_mm",
    "centre_y_mm": "centre_x_mm",
    "radius_mm": "centre_x_mm",
    "sweep_deg": "centre_x_mm",
}


@pytest.mark.long
@settings(max_examples=10)
@given(data=st.data())
def test_one_cell_of_a_path_that_is_off_is_told(case, data):
    path = data.draw(st.sampled_from(sorted(case.folder.glob("*-path.csv"))))
    head, table = cells(path)
    column, row = data.draw(st.sampled_from(head)), data.draw(st.sampled_from(table))
    k, was = head.index(column), row[head.index(column)]
    if column == "piece":
        row[k] = data.draw(
            st.sampled_from(
                [each for each in ("line", "arc ccw", "arc cw", "arc", "") if each != was]
            )
        )
        assert "piece" in failing(case, path, head, table)
    elif was:
        row[k] = str(float(was) + data.draw(st.sampled_from([-1e-3, 1e-3, 1.0])))
        assert any(each.startswith(PIECES[column]) for each in failing(case, path, head, table))
        if k > 4:
            row[k] = ""
            assert "piece" in failing(case, path, head, table)


@pytest.mark.long
@pytest.mark.parametrize("cell", ["nan", "inf", "1e999", "x", ""])
def test_a_cell_that_is_no_number_is_refused(case, cell):
    for path in (*case.folder.glob("*-profile.csv"), *case.folder.glob("*-path.csv")):
        head, table = cells(path)
        table[0][1] = cell
        with pytest.raises(FileError, match="not a table of a"):
            failing(case, path, head, table)


@pytest.mark.long
def test_a_path_in_inches_or_with_a_second_line_is_told(made, tmp_path):
    shutil.copytree(made.folder, tmp_path / "disc-cam")
    case = Case(read_mechanism(tmp_path / "disc-cam" / "spec.toml"), tmp_path / "disc-cam")
    path = case.file("cam-path", "dxf")
    for change in (
        lambda drawing: drawing.header.__setitem__("$INSUNITS", 1),
        lambda drawing: drawing.modelspace().add_line((0, 0), (5, 0), dxfattribs={"layer": "CUT"}),
        lambda drawing: drawing.layers.get("CUT").off(),
    ):
        was = path.read_bytes()
        drawing = ezdxf.readfile(path)
        change(drawing)
        drawing.saveas(path)
        assert {(f.code, str(f.where)) for f in machining.judge_tables(case) if not f.ok} == {
            ("DXF_CLOSED", path.name)
        }
        path.write_bytes(was)
    assert all(f.ok for f in machining.judge_tables(case))


@pytest.mark.long
@pytest.mark.parametrize(
    "more",
    [
        ("output.curves='lines'",),
        ("accuracy.chord_tolerance=0.02",),
        ("accuracy.chord_tolerance=0.0001",),
        ("output.profile_step_deg=7.5",),
        ("output.profile_step_deg=30",),
        ("output.profile_step_deg=0.1",),
    ],
)
def test_sound_tables_hold_at_any_step_and_tolerance(root, tmp_path, more):
    """No limit is so tight that what camgen writes fails it."""
    report = build(
        root / "specs" / "disc-cam.toml", tmp_path, DXF, (*SETTINGS, *more, "limits.speed_ripple=1")
    )
    told = [
        f for f in report.findings if "-profile.csv" in str(f.where) or "-path.csv" in str(f.where)
    ]
    assert len(told) == 11 and all(f.ok for f in told), told


CRANKED = """
mechanism = "linkage"
name = "cranked"
[points]
O = [5, 7]
X = {x}
C = [75, 20]
T = [40, 40]
[links]
ground = ["O", "C"]
disc = ["O", "X"]
rocker = ["C", "T"]
[drive]
link = "disc"
[[cam]]
cam = "disc"
follower = "rocker"
at = "T"
radius = 5
closure = "force"
segment = [
  {{ kind = "rise", span_deg = 120, lift_deg = 15, law = "cycloidal" }}, {{ kind = "dwell", span_deg = 60 }},
  {{ kind = "return", span_deg = 120, to_deg = 0, law = "cycloidal" }}, {{ kind = "dwell", span_deg = 60 }},
]
[[output]]
name = "swing"
link = "rocker"
[limits]
pressure_angle_deg = 70
[files]
profile_step_deg = 5
cutter_radius = 2
"""


@pytest.mark.long
def test_a_cam_on_a_crank_that_is_drawn_at_any_angle_has_the_same_table(tmp_path):
    """Its part's frame is the cam's own, wherever the crank's points are; the cam of one drawn upwards had none."""
    found = []
    for x in ("[15, 7]", "[5, 17]", "[-2, 14]"):
        (spec := tmp_path / "cranked.toml").write_text(CRANKED.format(x=x), encoding="utf-8")
        report = build(spec, tmp_path / x[1:-1].replace(", ", "_"), DXF)
        assert report.ok, [f for f in report.findings if not f.ok]
        (table,) = report.folder.glob("*-profile.csv")
        found.append(np.array([[float(cell) for cell in row.values()] for row in rows(table)]))
    for other in found[1:]:
        assert np.abs(other - found[0])[:, [0, 1, 3, 4, 6, 7]].max() < 2e-9
