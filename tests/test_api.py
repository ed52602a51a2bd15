"""`import camgen` is enough: what Python gets is what the command line writes; errors are data; nothing is printed."""

from __future__ import annotations

import json
import math
import pickle
import re
import subprocess
import sys
import tomllib
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


def test_path_dict_and_mechanism_are_one_spec(made: tuple[Report, Path], tmp_path: Path) -> None:
    report, folder = made
    assert camgen.load(DISC) == camgen.load(str(DISC)) == camgen.load(tables())
    for k, spec in enumerate((tables(), camgen.load(DISC))):
        assert camgen.build(spec, tmp_path / str(k), only=["dxf"]).as_dict() == report.as_dict()
        assert (tmp_path / str(k) / "disc-cam" / "spec.toml").read_bytes() == (
            folder / "spec.toml"
        ).read_bytes()


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
    (lambda out: camgen.check(out / "none"), camgen.FileError, "spec.toml"),
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
    *("kg m²", "g", "g mm", "%"),
}


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
