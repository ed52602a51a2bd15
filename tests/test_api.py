"""`import camgen` is enough: what Python gets is what the command line writes; errors are data; nothing is printed."""

from __future__ import annotations

import copy
import cProfile
import html
import inspect
import json
import math
import pickle
import re
import subprocess
import sys
import tomllib
import types
import webbrowser
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import camgen
from camgen.cli import main
from camgen.findings import Finding, NotJudged, Where
from camgen.report.report import Report
from camgen.study import Figure, Figures

SPECS = Path(__file__).resolve().parent.parent / "specs"
DISC = SPECS / "disc-cam.toml"


def tables() -> dict[str, Any]:
    return tomllib.loads(DISC.read_text(encoding="utf-8"))


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> tuple[Report, Path]:
    """The disc cam's drawing, and its folder."""
    out = tmp_path_factory.mktemp("api")
    return camgen.build(DISC, out, only="dxf"), out / "disc-cam"


@pytest.mark.long
def test_path_dict_and_mechanism_are_one_spec(made: tuple[Report, Path], tmp_path: Path) -> None:
    report, folder = made
    assert camgen.load(DISC) == camgen.load(str(DISC)) == camgen.load(tables())
    for k, spec in enumerate((tables(), camgen.load(DISC))):
        assert camgen.build(spec, tmp_path / str(k), only=["dxf"]).as_dict() == report.as_dict()
        assert (tmp_path / str(k) / "disc-cam" / "spec.toml").read_bytes() == (
            folder / "spec.toml"
        ).read_bytes()


@pytest.mark.long
def test_report_is_what_the_command_line_writes(
    made: tuple[Report, Path], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    report, folder = made
    assert capsys.readouterr() == ("", "")
    with pytest.raises(SystemExit):
        main(["build", str(DISC), "-o", str(tmp_path), "--only", "dxf", "--json"])
    assert (
        json.loads(capsys.readouterr().out)
        == report.as_dict()
        == json.loads((folder / "report.json").read_text())
    )
    *same, anew = camgen.check(folder).as_dict()["findings"]
    assert same == report.as_dict()["findings"] and (anew["code"], anew["ok"]) == ("REBUILD", True)


@pytest.mark.parametrize(
    "follower", ["translating,radius=5", {"motion": "translating", "radius": 5.0}, "table.toml"]
)
def test_motion_is_that_of_the_program(
    made: tuple[Report, Path], follower: object, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "table.toml").write_text('motion = "translating"\nradius = 5.0')
    found = camgen.motion(made[1] / "disc-cam-cam.dxf", follower)  # type: ignore[arg-type]
    assert (
        found.theta.shape
        == found.s.shape
        == found.speed.shape
        == found.pressure_angle.shape
        == (7200,)
    )
    assert (
        np.abs(found.s - camgen.load(DISC).motion(found.theta)).max() < 1.2e-3
    )  # mm; chord tolerance over cos 18.8 deg
    assert math.degrees(np.abs(found.pressure_angle).max()) == pytest.approx(18.8059, abs=0.05)


WRONG = [
    (lambda out: camgen.load("nowhere.toml"), camgen.FileError, "nowhere.toml"),
    (lambda out: camgen.load({}), camgen.SpecError, "mechanism"),
    (
        lambda out: camgen.load({"mechanism": "disc-can", "name": "a"}),
        camgen.SpecError,
        "did you mean 'disc-cam'",
    ),
    (
        lambda out: camgen.load(tables() | {"gemetry": {}}),
        camgen.SpecError,
        "did you mean 'geometry'",
    ),
    (lambda out: camgen.load(tables() | {3: 4}), camgen.SpecError, "3"),
    (lambda out: camgen.load(tables() | {"name": np.arange(3)}), camgen.SpecError, "name"),
    (
        lambda out: camgen.load(tables() | {"motor": {"speed_rpm": math.nan}}),
        camgen.SpecError,
        "motor.speed_rpm",
    ),
    (lambda out: camgen.build(DISC, out, only="dfx"), camgen.SpecError, "did you mean 'dxf'"),
    (lambda out: camgen.build(DISC, out, only=[]), camgen.SpecError, "only: none"),
    (lambda out: camgen.build(DISC, out, only=""), camgen.SpecError, "only"),
    (lambda out: camgen.build(DISC, out, only="dxf", jobs=-3), camgen.SpecError, "jobs: -3"),
    (lambda out: camgen.build(DISC, out, only="dxf", jobs="2"), camgen.SpecError, "jobs: '2'"),  # type: ignore[arg-type]
    (lambda out: camgen.build(DISC, out / "file" / "x", only="dxf"), camgen.FileError, "file"),
    (lambda out: camgen.check(out / "none"), camgen.FileError, "no such folder"),
    (
        lambda out: camgen.motion(out / "none.dxf", "translating,radius=5"),
        camgen.FileError,
        "none.dxf",
    ),
    (
        lambda out: camgen.motion(out / "none.dxf", {"motion": "translating"}),
        camgen.SpecError,
        "radius",
    ),
    (
        lambda out: camgen.motion(out / "none.dxf", "translating,radius=5", harmonics=0),
        camgen.SpecError,
        "harmonics",
    ),
]


@pytest.mark.parametrize(("call", "kind", "said"), WRONG)
def test_what_is_wrong_is_a_camgen_error(
    call: Any, kind: type[camgen.CamgenError], said: str, tmp_path: Path
) -> None:
    (tmp_path / "file").touch()
    with pytest.raises(kind, match=said):
        call(tmp_path)
    assert issubclass(kind, camgen.CamgenError)
    assert [path.name for path in tmp_path.iterdir()] == ["file"], "nothing is written"


def test_a_spec_that_holds_itself_is_a_fault() -> None:
    spec = tables()
    spec["geometry"]["base_radius"] = spec
    with pytest.raises(camgen.SpecError, match="nested"):
        camgen.load(spec)


def test_an_open_outline_says_so(tmp_path: Path) -> None:
    import ezdxf

    drawing = ezdxf.new(units=4)
    drawing.modelspace().add_lwpolyline([(0, 0), (30, 0), (30, 30)])
    drawing.saveas(tmp_path / "open.dxf")
    with pytest.raises(camgen.FileError, match="DXF_CLOSED|CLOSED"):
        camgen.motion(tmp_path / "open.dxf", "translating,radius=5")


def test_import_is_light_and_the_wing_of_motion_leaves_the_function_be() -> None:
    code = (
        "import sys, camgen\n"
        "assert not {'numpy', 'pydantic', 'click', 'tomllib'} & set(sys.modules), 'heavy'\n"
        "import camgen.motion.laws as laws\nfrom camgen.motion import segments\n"
        "assert callable(camgen.motion) and camgen.motion.__doc__.startswith('Motion of a follower')\n"
        "import camgen.sweep.variants as variants, camgen.design.wanted as wanted\n"
        "from camgen.tolerance import report\n"
        "assert all(map(callable, (camgen.sweep, camgen.design, camgen.tolerance, camgen.explain)))\n"
        "assert all(getattr(camgen, name).__doc__ for name in camgen.__all__)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert (Path(camgen.__file__).parent / "py.typed").is_file()


SPEC_NAMES = sorted(
    path.stem for path in SPECS.glob("*.toml") if path.stem != "four-leg-walker"
)  # two legs do
UNITS = {
    *("", "mm", "mm²", "deg", "mm/s", "deg/s", "rad/s", "mm/s²", "deg/s²", "mm/rad", "mm/rad²"),
    *("1/s", "s", "N", "N s", "N m", "N m s", "N/mm", "N m/rad", "N rad/s", "J", "W", "MPa"),
    *("kg m²", "g", "g mm", "%", "rpm"),
}


@pytest.mark.long
@pytest.mark.parametrize("name", SPEC_NAMES)
def test_figures_have_plain_keys_and_known_units(name: str) -> None:
    numbers = camgen.load(SPECS / f"{name}.toml").study().numbers
    assert [key for key in numbers if not re.fullmatch("[a-z][a-z0-9]*(_[a-z0-9]+)+", key)] == []
    assert {each.unit for each in numbers.records} - UNITS == set()


@pytest.mark.parametrize("name", SPEC_NAMES)
def test_a_machine_is_solved_at_any_angles(name: str) -> None:
    run = camgen.load(SPECS / f"{name}.toml").solve(theta := np.linspace(0.3, 5, 7))  # type: ignore[attr-defined]
    outputs = list(run.velocity)
    assert outputs or name == "coupon"  # in which nothing moves
    assert all(
        np.shape(run[output]) == theta.shape == np.shape(run.acceleration[output])
        for output in outputs
    )


def test_errors_travel_between_processes() -> None:
    error = pickle.loads(pickle.dumps(camgen.FileError("a.toml", "is empty")))
    assert (error.path, error.reason, error.exit_code) == ("a.toml", "is empty", 4)


def test_a_notebook_shows_the_verdict_then_what_fails_escaped() -> None:
    held = Finding("HOLDS", True, 1.0, 2.0, "mm", Where("a.dxf"), "well <b>")
    fails = Finding("FAILS_HERE", False, 3.0, 2.0, "mm", Where("b & c.dxf"), "<script>")
    error = Figure("motion error {of}", 0.001, "mm", kind="dxf")
    numbers = Figures([Figure("stroke", 12.0, "mm"), error])
    report = Report(
        "<name>",
        "disc-cam",
        [held, fails],
        numbers,
        not_judged=[NotJudged("LASH", "no STL", "STL")],
    )
    page = report._repr_html_()
    assert (
        "&lt;name&gt;: 1 of 2 findings fails; NOT JUDGED: LASH (needs STL)" in page
        and "<script>" not in page
    )
    assert (
        0
        < page.index("1 of 2")
        < page.index("FAILS_HERE")
        < page.index("HOLDS</code>")
        < page.index("<dt>Stroke</dt>")
    )
    assert "b &amp; c.dxf" in page and "otion error" not in page
    assert "The one finding holds" in Report("a", "b", [held])._repr_html_()


# ---- another machine, many machines --------------------------------------------------------------------------------

LINKAGE = SPECS / "linkage.toml"


def test_replace_gives_what_load_gives() -> None:
    cam = camgen.load(DISC)
    spec = tables()
    spec["geometry"]["base_radius"] = 30
    spec["segment"][0]["law"] = "cycloidal"
    other = cam.replace({"geometry.base_radius": np.float64(30), "segment.0.law": "cycloidal"})
    assert other == camgen.load(spec) and other != cam == camgen.load(DISC)
    assert other.replace({"geometry.base_radius": 25, "segment.0.law": "modified-sine"}) == cam
    limits = cam.replace({"limits": None})
    assert (
        limits.allowed == camgen.load({k: v for k, v in tables().items() if k != "limits"}).allowed
    )


@pytest.mark.parametrize(
    ("key", "value", "said"),
    [
        (
            "geometry.base_raduis",
            30,
            "geometry.base_raduis: unknown key; did you mean 'base_radius'",
        ),
        ("geometry.base_radius", -1, "geometry.base_radius: -1"),
        ("geometry.base_radius", "wide", "geometry.base_radius: 'wide'"),
        ("geometry.base_radius", math.nan, "geometry.base_radius"),
        ("geometry.base_radius", object(), "geometry.base_radius"),
        ("segment.9.lift", 3, "there is no 9"),
        ("mechanism", "linkage", "'disc-cam', as it is"),
        ("a..b", 1, "a..b"),
        ("spring", None, "nothing to remove"),
    ],
)
def test_replace_refuses_by_the_key(key: str, value: object, said: str) -> None:
    with pytest.raises(camgen.SpecError, match=re.escape(said)):
        camgen.load(DISC).replace({key: value})


def test_a_record_stays_as_it_is() -> None:
    cam = camgen.load(DISC)
    for holder, name in ((cam, "name"), (cam.geometry, "base_radius")):
        with pytest.raises(camgen.SpecError, match=f"{name} - .*machine.replace"):
            setattr(holder, name, "x")


def evaluated(base: Any, k: int) -> Any:
    """The pen's path of the k-th four-bar."""
    lengths = {
        "lengths.O-A": 18 + 0.2 * k,
        "lengths.A-B": 57 + 0.3 * k,
        "lengths.C-B": 53 - 0.3 * k,
    }
    return base.replace(lengths).solve(np.linspace(0, math.tau, 72, endpoint=False), 0)["pen"]


def test_other_lengths_give_what_the_general_way_gives(monkeypatch: pytest.MonkeyPatch) -> None:
    from camgen.machines.linkage import construction, drawn_machine

    quick = [evaluated(camgen.load(LINKAGE), k) for k in range(20)]
    monkeypatch.setattr(drawn_machine, "closed_by_dyads", lambda machine: None)
    monkeypatch.setattr(construction, "stays_clear", lambda *_: False)
    spec = tomllib.loads(LINKAGE.read_text(encoding="utf-8"))
    for k, pen in enumerate(quick):
        spec["lengths"] |= {"O-A": 18 + 0.2 * k, "A-B": 57 + 0.3 * k, "C-B": 53 - 0.3 * k}
        assert np.abs(evaluated(camgen.load(spec), k) - pen).max() < 1e-12 * 100


def test_a_four_bar_is_evaluated_by_few_calls() -> None:
    """Some 0.4 ms, `tests/bench/bench_python.py`; the calls of functions do not depend on who else uses the machine."""
    base = camgen.load(LINKAGE)
    evaluated(base, 0)
    profile = cProfile.Profile()
    profile.runcall(lambda: [evaluated(base, k) for k in range(10)])
    calls = sum(row.callcount for row in profile.getstats())
    assert calls / 10 < 1_600


def test_a_refused_design_says_so_as_of_a_spec() -> None:
    machine = camgen.load(LINKAGE).replace({"lengths.O-A": 45})
    with pytest.raises(camgen.DesignError, match="the drive cannot turn fully"):
        machine.solve([0.0])


@pytest.mark.long
def test_a_run_as_columns_and_as_a_frame() -> None:
    run = camgen.load(LINKAGE).solve(np.radians([0, 90, 180]))
    assert list(run.outputs) == ["pen", "swing"]
    assert run.outputs["pen"].tolist() == run["pen"].tolist()
    frame = run.to_dataframe(order=1)
    assert list(frame) == [
        *("theta_deg", "pen_x_mm", "pen_y_mm", "swing_deg"),
        *("pen_x_mm_per_s", "pen_y_mm_per_s", "swing_deg_per_s"),
    ]
    assert list(frame["theta_deg"]) == pytest.approx([0, 90, 180])
    assert frame["pen_y_mm"].tolist() == run["pen"].imag.tolist()
    assert np.radians(frame["swing_deg_per_s"]).tolist() == pytest.approx(run.velocity["swing"])
    assert repr(run).splitlines()[0] == "Run at 3 angles, 0 to 180 deg"
    assert repr(camgen.load(LINKAGE).solve([])) == "Run at 0 angles"


def test_what_belongs_to_a_run_prints_what_it_is() -> None:
    run = camgen.load(LINKAGE).solve(np.radians([0, 90]))
    least, most = sorted(run["swing"])
    assert repr(run.outputs).splitlines()[1] == f"swing: {least:.6g} to {most:.6g} rad"
    slow, fast = sorted(run.velocity["pen"].real)
    assert repr(run.velocity).startswith(f"pen: x {slow:.6g} to {fast:.6g}, y ")
    assert repr(run.acceleration).endswith(" rad/s^2")
    assert repr(camgen.load(LINKAGE).solve([]).outputs) == "pen: no angles\nswing: no angles"


def test_without_pandas_it_says_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "pandas", None)
    with pytest.raises(camgen.CamgenError, match=r"needs pandas: .*pip install .+\[table\]"):
        camgen.load(LINKAGE).solve([0.0]).to_dataframe()


def test_what_a_notebook_prints_is_short() -> None:
    cam = camgen.load(DISC)
    assert repr(cam) == "<disc-cam 'disc-cam': print() says what it is>"
    assert tomllib.loads(cam.toml())["geometry"]["base_radius"] == 25
    assert str(cam).splitlines() == [
        "disc-cam 'disc-cam'",
        "  links: cam, follower",
        "  joints: 1 pin, 1 slide, 1 cam",
        "  driven: cam, 60 rpm",
        "  outputs: lift (mm)",
        "  toml() is its spec, solve(theta) its motion, assembly.parts its parts",
    ]
    assert len(str(camgen.load(LINKAGE)).splitlines()) == 6
    (_, why, _) = str(camgen.load(LINKAGE).replace({"lengths.C-B": 1})).splitlines()
    assert why.startswith("  cannot exist: ")
    report = Report(
        "cam", "disc-cam", [Finding("FAILS", False, 3.0, 2.0, "mm", Where("b.dxf"), "off")]
    )
    assert repr(report) == "cam (disc-cam): 1 of 1 findings fails\n  FAILS: off"
    assert camgen.explain("pressure-angle")._repr_markdown_().startswith("## PRESSURE_ANGLE\n")
    assert camgen.explain().count("\n- `") > 50


def test_a_sweep_is_the_commands_table(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    laws = ["cycloidal", "modified-sine"]
    swept = camgen.sweep(
        camgen.load(DISC), {"geometry.base_radius": (14, 22), "segment.0.law": laws}
    )
    assert capsys.readouterr() == ("", "")
    file = tmp_path / "table.csv"
    vary = [
        "--vary",
        "geometry.base_radius=14,22",
        "--vary",
        "segment.0.law=cycloidal,modified-sine",
    ]
    with pytest.raises(SystemExit):
        main(["sweep", str(DISC), *vary, "-o", str(file)])
    swept.write(tmp_path / "mine.csv")
    assert (tmp_path / "mine.csv").read_bytes() == file.read_bytes()
    assert swept["geometry.base_radius"].tolist() == [14, 14, 22, 22] and len(swept) == 4
    assert swept.machine(3) == camgen.load(DISC).replace(
        {"geometry.base_radius": 22, "segment.0.law": "modified-sine"}
    )
    assert swept.to_dataframe().shape == (4, len(swept.columns) - 1)
    assert swept._repr_html_().count("<tr>") == 5


@pytest.mark.parametrize(
    ("key", "said"),
    [
        ("lengths.A-Q", "there is no point Q; the points are O, C, A, B, P"),
        ("lengths.O-B", "no link has both O and B"),
        ("lengths.AB", 'two points of one link, such as "A-B"'),
        ("geometry.base_radius", "unknown key"),
    ],
)
def test_a_sweep_refuses_a_key_that_the_spec_cannot_have(key: str, said: str) -> None:
    """Whatever its value is; a value that is wrong is a row."""
    with pytest.raises(camgen.SpecError, match=said):
        camgen.sweep(LINKAGE, {key: [10, 20]})


@pytest.mark.long
def test_a_sweep_of_a_linkage_has_its_transmission_angle_and_play(tmp_path: Path) -> None:
    ground, crank, rocker = 70.0, 20.0, 50.0
    couplers = [55.0, 60.0]
    swept = camgen.sweep(LINKAGE, {"lengths.A-B": couplers})
    for coupler, angle in zip(couplers, swept["transmission_angle_deg"], strict=True):
        bends = []  # law of cosines, where the crank lies in line with the ground
        for base in (ground - crank, ground + crank):
            cosine = (coupler**2 + rocker**2 - base**2) / (2 * coupler * rocker)
            bend = math.degrees(math.acos(cosine))
            bends.append(min(bend, 180 - bend))
        assert angle == pytest.approx(min(bends), abs=1e-3)  # the least of samples
    report = camgen.build(LINKAGE, tmp_path, only="dxf")  # by its pins as they lie in the files
    for key, unit in (("play_pen", "mm"), ("play_swing", "deg")):
        drawn = report.numbers[f"{key}_dxf_{unit}"]
        assert swept[f"{key}_{unit}"][1] == pytest.approx(drawn, rel=0.005)


def test_a_plot_of_a_sweep_names_the_values_of_its_other_key() -> None:
    laws = ["cycloidal", "modified-sine"]
    size, angle = "geometry.base_radius", "pressure_angle_deg"
    swept = camgen.sweep(DISC, {size: (9, 22), "segment.0.law": laws})
    (axes,) = swept.plot(size, angle).axes
    drawn = {
        str(line.get_label()): [float(y) for y in np.asarray(line.get_ydata())]
        for line in axes.get_lines()
    }
    wanted: dict[str, list[float]] = {}
    for row in swept:
        beyond = "" if row["verdict"] == "limits hold" else ", does not hold"
        wanted.setdefault(f"law = {row['segment.0.law']}{beyond}", []).append(row[angle])
    assert drawn == wanted and len(drawn) == 4
    lines = {str(line.get_label()): line for line in axes.get_lines()}
    for law in laws:
        held, not_held = lines[f"law = {law}"], lines[f"law = {law}, does not hold"]
        assert held.get_color() == not_held.get_color()
        assert held.get_markerfacecolor() == held.get_color()
        assert not_held.get_markerfacecolor() == "none"
    assert len({line.get_color() for line in axes.get_lines()}) == 2
    assert [text.get_text() for text in axes.get_legend().get_texts()] == list(drawn)
    assert axes.get_title(loc="left") == "Sweep of disc-cam"
    many = camgen.sweep(DISC, {size: "9:40", "segment.0.lift": "10:12"}, how=30)
    (axes,) = many.plot(size, angle).axes
    assert {line.get_label() for line in axes.get_lines()} <= {"holds", "does not hold"}


def test_the_front_of_a_sweep_is_what_nothing_beats() -> None:
    swept = camgen.sweep(DISC, {"geometry.base_radius": "3:40"}, how=12)
    size, angle = "geometry.base_radius", "pressure_angle_deg"
    held = [row for row in swept if row["verdict"] == "limits hold"]
    best = [
        row["variant"]
        for row in held
        if not any(
            other[size] <= row[size] and other[angle] <= row[angle] and other is not row
            for other in held
        )
    ]
    assert [row["variant"] for row in swept.front(least=[size, angle])] == best
    assert 0 < len(held) < len(swept) and len(swept.holding) == len(held)
    assert swept.plot(size, angle).axes[0].get_ylabel() == angle


@pytest.mark.parametrize(
    ("call", "said"),
    [
        (
            lambda: camgen.sweep(DISC, {"geometry.base_raduis": [1, 2]}),
            "did you mean 'base_radius'",
        ),
        (lambda: camgen.sweep(DISC, {}), "at least one"),
        (lambda: camgen.sweep(DISC, {"geometry.base_radius": []}), "no value"),
        (lambda: camgen.sweep(DISC, {"geometry.base_radius": [20]}, how="gird"), "how: 'gird'"),  # type: ignore[arg-type]
        (lambda: camgen.sweep(DISC, {"geometry.base_radius": [20]}, jobs=-1), "jobs: -1"),
        (
            lambda: camgen.sweep(DISC, {"geometry.base_radius": [20]})["stroke"],
            "did you mean 'stroke_mm'",
        ),
        (lambda: camgen.sweep(DISC, {"geometry.base_radius": [20]}).machine(1), "0 to 0"),
        (lambda: camgen.sweep(DISC, {"geometry.base_radius": 20}), "20 - expected a list"),
        (lambda: camgen.sweep(DISC, {"geometry.base_radius": [20]}, how=1.5), "how: 1.5"),
        (lambda: camgen.explain("PRESURE_ANGLE"), "did you mean 'PRESSURE_ANGLE'"),
        (lambda: camgen.design(DISC), "wanted"),
        (lambda: camgen.tolerance(DISC, samples=0), "samples"),
    ],
)
def test_what_is_asked_wrongly_of_many_is_a_spec_error(call: Any, said: str) -> None:
    with pytest.raises(camgen.SpecError, match=re.escape(said)):
        call()


ANY_SPEC = "expected a path, a dict or a machine"


@pytest.mark.parametrize(
    ("call", "said"),
    [
        (lambda: camgen.load(None), [f"spec: None - {ANY_SPEC}"]),
        (lambda: camgen.load(True), [f"spec: true - {ANY_SPEC}"]),
        (lambda: camgen.build(b"cam.toml", out=3), [f"spec: b'cam.toml' - {ANY_SPEC}", "out: 3"]),
        (
            lambda: camgen.build("out", camgen.load(DISC)),  # type: ignore[arg-type]
            [
                "out: <disc-cam 'disc-cam': print() says what it is> - expected a path: camgen.build(spec, out)"
            ],
        ),
        (lambda: camgen.build(DISC, only=5), ["only: 5 - expected text, a list or None"]),
        (lambda: camgen.build(DISC, jobs="2"), ["jobs: '2' - expected a whole number"]),
        (lambda: camgen.check(3.5), ["folder: 3.5 - expected a path"]),
        (lambda: camgen.check("out", gcode="a.gcode"), ["gcode: 'a.gcode' - expected a list"]),
        (lambda: camgen.check("out", line_width="0.4"), ["line_width: '0.4' - expected a number"]),
        (
            lambda: camgen.motion(None, 4),
            ["file: None - expected a path", "follower: 4 - expected a path or a dict"],
        ),
        (lambda: camgen.sweep(5, {}), [f"spec: 5 - {ANY_SPEC}"]),
        (lambda: camgen.sweep(DISC, ["motor.speed_rpm"]), ["vary: ", "expected a dict"]),
        (
            lambda: camgen.explain(str(DISC), "LASH"),
            ["law of 'camgen list', and the spec behind it"],
        ),
        (lambda: camgen.design(DISC, say="loud"), ["say: 'loud' - expected a function"]),
        (lambda: camgen.tolerance([]), [f"spec: [] - {ANY_SPEC}"]),
        (lambda: camgen.tolerance(DISC, seed=1.5), ["seed: 1.5 - expected a whole number"]),
        (lambda: camgen.explain(5), ["code: 5 - expected text, a finding or None"]),
    ],
)
def test_an_argument_of_a_wrong_type_is_a_spec_error(call: Any, said: list[str]) -> None:
    with pytest.raises(camgen.SpecError) as caught:
        call()
    assert str(caught.value).startswith("camgen.") and all(
        each in str(caught.value) for each in said
    )


@pytest.mark.parametrize("spec", ["linkage.toml", "disc-cam.toml"])
def test_methods_of_a_machine_refuse_in_words(spec: str) -> None:
    machine: Any = camgen.load(SPECS / spec)
    numbers = "expected a number or a list of numbers"
    calls = {
        "changes: None - expected a dict": lambda: machine.replace(None),
        "changes: 'x' - expected a dict": lambda: machine.replace("x"),
        f"theta: 'x' - {numbers}": lambda: machine.solve("x"),
        f"theta: None - {numbers}": lambda: machine.solve(None),
        "theta: [[1, 2], [3]] - expected angles in rad": lambda: machine.solve([[1, 2], [3]]),
        "theta: nan - expected finite angles in rad": lambda: machine.solve([0.0, math.nan]),
        "order: 7 - expected 0, 1 or 2": lambda: machine.solve(0.0, 7),
        "order: 'x' - expected a whole number": lambda: machine.solve(0.0, "x"),
        "theta: 'x' - expected a number": lambda: machine.scene("x"),
        "theta: inf - expected finite angles": lambda: machine.scene(math.inf),
    }
    for said, call in calls.items():
        with pytest.raises(camgen.SpecError, match=re.escape(said)) as caught:
            call()
        assert str(caught.value).startswith("machine.")
    assert machine.solve(np.float32(1)).theta.shape == (1,)
    assert machine.solve([0, 1], np.int64(1)).theta.shape == (2,)


def test_arguments_of_numpy_are_numbers_and_missing_ones_are_pythons() -> None:
    swept = camgen.sweep(DISC, {"geometry.base_radius": np.array([25.0])}, jobs=np.int64(1))  # type: ignore[arg-type]
    assert len(swept) == 1
    with pytest.raises(TypeError, match="missing 1 required positional argument: 'spec'"):
        camgen.load()  # type: ignore[call-arg]


def test_every_function_of_the_package_holds_its_arguments_against_their_types() -> None:
    for name in camgen.__all__:
        function = getattr(camgen, name)
        if isinstance(function, types.FunctionType):
            first, *_ = inspect.signature(function).parameters
            with pytest.raises(camgen.SpecError, match=f"{first}: 1.5 - expected"):
                function(1.5, *([{}] if name in ("drives", "motion", "rolls", "sweep") else []))


def test_design_gives_the_machine_whose_text_the_command_prints(
    capsys: pytest.CaptureFixture[str],
) -> None:
    spec = tables() | {
        "wanted": {"vary": {"geometry.base_radius": [3, 30]}, "least": "base_radius_mm"}
    }
    said: list[str] = []
    found = camgen.design(spec, say=said.append)
    assert found.machine == camgen.load(tomllib.loads(found.text)) and found.front is None
    assert found.notes == said and repr(found).startswith("Found <disc-cam 'disc-cam'")
    assert 3 < found.machine.geometry.base_radius < 25
    assert capsys.readouterr() == ("", "")


# ---- show ----------------------------------------------------------------------------------------------------------


class Shell:
    """What a notebook's kernel gives."""

    kernel = object()

    def __init__(self) -> None:
        self.published: list[dict[str, str]] = []
        self.display_pub = self

    def publish(self, data: dict[str, str]) -> None:
        self.published.append(data)


def test_the_report_shows_its_page_in_a_notebook_and_else_in_a_browser(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    report = Report("a", "disc-cam", (), folder=tmp_path)
    with pytest.raises(camgen.FileError, match="there is no page"):
        report.show()
    page = tmp_path / "report.html"
    page.write_text('<p class="x">moves & turns</p>', encoding="utf-8")
    opened: list[str] = []
    monkeypatch.setattr(webbrowser, "open", lambda uri: opened.append(uri) or True)
    report.show()
    assert opened == [page.as_uri()]
    shell = Shell()
    monkeypatch.setitem(sys.modules, "IPython", types.SimpleNamespace(get_ipython=lambda: shell))
    report.show()
    ((published,),) = ([each["text/html"] for each in shell.published],)
    source = re.search('srcdoc="([^"]*)"', published)
    assert source is not None and html.unescape(source[1]) == page.read_text() and len(opened) == 1
    monkeypatch.delitem(sys.modules, "IPython")
    monkeypatch.setattr(webbrowser, "open", lambda uri: False)
    with pytest.raises(camgen.FileError, match="no browser"):
        report.show()


def test_tables_of_a_record_stay_as_they_are() -> None:
    """Lengths that were written into were told to be set, and changed nothing; pickled, copied and dumped they are the same."""
    machine = camgen.load(LINKAGE)
    right = 'machine.replace({"lengths.A-B": 13}) gives a changed copy'
    with pytest.raises(camgen.SpecError, match=re.escape(right)):
        machine.lengths["A-B"] = 13
    pins: Any = machine.making.pins
    with pytest.raises(camgen.SpecError, match=re.escape('"parts.pins.A": 4')):
        pins["A"] = 4
    writes: list[Any] = [
        lambda table: table.update({"A-B": 13}),
        lambda table: table.pop("A-B"),
        lambda table: table.popitem(),
        lambda table: table.setdefault("O-B", 13),
        lambda table: table.clear(),
        lambda table: table.__delitem__("A-B"),
        lambda table: table.__ior__({"A-B": 13}),
    ]
    before = dict(machine.lengths)
    for other in (
        machine,
        pickle.loads(pickle.dumps(machine)),
        copy.deepcopy(machine),
        machine.resolved(),
        machine.replace({"lengths.O-A": 18}).replace({"lengths.O-A": before["O-A"]}),
    ):
        for write in writes:
            with pytest.raises(camgen.SpecError, match="a record cannot be changed"):
                write(other.lengths)
        assert other.lengths == before
    assert type(machine.model_dump()["lengths"]) is dict
    own = machine.lengths | {"A-B": 13.0}  # a dict of the caller's own
    assert own["A-B"] == 13 and machine.lengths["A-B"] != 13


def test_faults_of_a_call_are_not_those_of_the_command_line() -> None:
    with pytest.raises(camgen.SpecError, match="^camgen.explain: 1 fault") as caught:
        camgen.explain("NOPE")
    assert "command line" not in str(caught.value)
    with pytest.raises(camgen.SpecError, match="^camgen.sweep: 1 fault"):
        camgen.sweep(DISC, {"geometry.base_radius": "20:40"})


@pytest.mark.parametrize(
    ("vary", "how", "said"),
    [
        ({"geometry.base_radius": "20:40"}, "grid", 'vary geometry.base_radius: .* "A:B:N", N'),
        ({"geometry.base_radius": 5}, "grid", r"vary geometry.base_radius: 5 .* \[a, b, c\]"),
        ({"geometry.base_radius": "1:9:10000", "parts.bore": "1:9:10000"}, "grid", "or how=N"),
        ({"geometry.base_radius": [20, 30], "parts.bore": [5]}, "zip", 'how="zip": values'),
        ({"segment.9.lift": [1, 2]}, "grid", "vary segment.9.lift - segment has"),
    ],
)
def test_faults_of_a_sweep_are_told_in_arguments(vary: object, how: str, said: str) -> None:
    with pytest.raises(camgen.SpecError, match=said) as caught:
        camgen.sweep(DISC, vary, how)  # type: ignore[arg-type]
    assert "--" not in str(caught.value) and "KEY=" not in str(caught.value)
