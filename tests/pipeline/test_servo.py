"""Cam tables for servo drives: the makers' own example is read, rows make the motion, and what is spoilt is seen."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import camgen
from camgen.cli import main
from camgen.errors import FileError, SpecError
from camgen.files.servo import DIALECTS, CamTable, plain_text, read_cam_table
from camgen.machines.follower_motions import follower_motions
from camgen.measuring import servo as measuring
from camgen.pipeline.servo import _masters

# as the documentation of CODESYS SoftMotion shows one
DOCUMENTED = """VAR_GLOBAL
Cam_A: ARRAY[0..3] OF SMC_CAMXYVA := [
        (dX := 0, dY := 0, dV := 0, dA := 0),
        (dX := 120, dY := 120, dV := 1, dA := 0),
        (dX := 240, dY := 240, dV := 1, dA := 0),
        (dX := 360, dY := 360, dV := 0, dA := 0)];
Cam: MC_CAM_REF := (nElements := 4, byType := 3, xStart := 0, xEnd := 360, nTappets := 0, strCAMName := 'Cam', pce := ADR(Cam_A), xPartofLM := TRUE);
END_VAR
"""


@pytest.fixture(scope="module")
def built(tmp_path_factory: pytest.TempPathFactory) -> Any:
    from conftest import ROOT

    spec = ROOT / "specs" / "disc-cam.toml"
    return camgen.build(spec, tmp_path_factory.mktemp("servo"), only="servo")


def written(tmp_path: Path, text: str, name: str = "table.st") -> Path:
    path = tmp_path / name
    path.write_text(text, encoding="utf-8")
    return path


def test_the_documented_example(tmp_path: Path) -> None:
    """A rise from rest to a velocity of 1, the 3-4-5 law's quintic 10 u^3 - 15 u^4 + 6 u^5 less the end's velocity, then a line."""
    table = read_cam_table(written(tmp_path, DOCUMENTED))
    curve = table.curve()
    assert table.closed and len(table.master) == 4
    np.testing.assert_allclose(curve(np.array([180.0, 200.0]), 0), [180, 200])
    # 3-4-5 between 0 and 120 with v1 = 1: c3 = 10 - 4, c4 = -15 + 7, c5 = 6 - 3
    np.testing.assert_allclose(curve(np.array([60.0]), 0), 120 * (6 / 8 - 8 / 16 + 3 / 32))
    np.testing.assert_allclose(curve(table.master, 1), [0, 1, 1, 0], atol=1e-12)


def test_a_build_makes_the_motion(built: Any) -> None:
    """Held against the modified sine's own values: half the lift at half the rise, its peak at C_v = 1.75960339."""
    assert built.ok
    findings = [each for each in built.findings if each.code == "SERVO_TABLE"]
    assert len(findings) == 4
    for path in sorted(built.folder.glob("*-contact-*")):
        curve = read_cam_table(path).curve()
        assert float(curve(np.array(50.0), 0)) == pytest.approx(6, abs=1e-5)
        assert float(curve(np.array(50.0), 1)) == pytest.approx(1.75960339 * 12 / 100, rel=1e-4)
        assert float(curve(np.array(130.0), 0)) == pytest.approx(12, abs=1e-5)


def test_files_keep_to_their_limits(built: Any) -> None:
    points = read_cam_table(built.folder / "disc-cam-contact-s7.st")
    assert len(points.master) <= 1000 and points.velocity is None
    text = (built.folder / "disc-cam-contact-codesys.st").read_text()
    rows = text.count("(dX")
    assert f"ARRAY[0..{rows - 1}]" in text and f"nElements := {rows}," in text


@pytest.mark.parametrize(
    "name, old, new, codes",
    [
        ("codesys.st", "dY := 12.0,", "dY := 12.001,", {"SERVO_TABLE", "MANIFEST"}),
        (
            "twincat.st",
            "SlaveVelocity := 0.1587",
            "SlaveVelocity := 0.1687",
            {"SERVO_TABLE", "MANIFEST"},
        ),
        ("s7.st", "y := 12.0)", "y := 12.001)", {"SERVO_TABLE", "MANIFEST"}),
        ("servo.csv", "\n30.0,2.13", "\n30.0,2.14", {"SERVO_TABLE", "MANIFEST"}),
        ("servo.csv", "\n360.0,", "\n359.0,", {"SERVO_TABLE", "MANIFEST"}),
        ("codesys.st", "byType := 3", "byType := 2", {"MANIFEST"}),
        ("codesys.st", "xEnd := 360", "xEnd := 350", {"MANIFEST"}),
    ],
)
def test_a_spoilt_table_fails(
    built: Any, tmp_path: Path, name: str, old: str, new: str, codes: set[str]
) -> None:
    """Rows by what a drive makes of them, what stands round them by what a build would write."""
    import shutil

    folder = tmp_path / "disc-cam"
    shutil.copytree(built.folder, folder)
    path = folder / f"disc-cam-contact-{name}"
    text = path.read_text()
    assert old in text
    path.write_text(text.replace(old, new, 1))
    failing = {each.code for each in camgen.check(folder).findings if not each.ok}
    assert failing == codes


def test_copies_of_one_angle_are_one_row() -> None:
    """Ends of neighbouring segments, counted from either side of the turn, differ by their last digit."""
    copies = np.array([np.nextafter(240, 0), 240.0, 359.99999999999994])
    masters = _masters(np.arange(0, 390, 30.0), copies)
    np.testing.assert_allclose(masters, np.arange(0, 390, 30), rtol=1e-15)
    assert masters[0] == 0 and masters[-1] == 360


def test_no_cam_no_table(root: Path, tmp_path: Path) -> None:
    with pytest.raises(SpecError, match="has no cam that turns"):
        camgen.build(root / "specs" / "gallery" / "four-bar.toml", tmp_path, only="servo")
    assert not list(tmp_path.iterdir())


@given(
    st.lists(st.floats(-500, 500), min_size=3, max_size=20),
    st.sampled_from(sorted([*DIALECTS, "csv"])),
)
def test_what_is_written_is_read(values: list[float], dialect: str) -> None:
    import tempfile

    slave = np.round(values, 9) + 0.0
    master = np.linspace(0, 360, len(slave)).round(6)
    table = CamTable("mm", master, slave, slave / 7, slave / 49)
    text = plain_text(table) if dialect == "csv" else DIALECTS[dialect].text("1 x-y", table)
    with tempfile.TemporaryDirectory() as folder:
        found = read_cam_table(written(Path(folder), text, "t.csv" if dialect == "csv" else "t.st"))
    np.testing.assert_allclose(found.master, master, atol=1e-12)
    np.testing.assert_allclose(found.slave, slave, atol=1e-12)
    if dialect != "s7":
        assert found.velocity is not None and found.acceleration is not None
        np.testing.assert_allclose(found.velocity, slave / 7, atol=1e-12)
        np.testing.assert_allclose(found.acceleration, slave / 49, atol=1e-12)


def test_motion_of_a_table(root: Path, built: Any, tmp_path: Path) -> None:
    spec = root / "specs" / "disc-cam.toml"
    report = measuring.run(built.folder / "disc-cam-contact-twincat.st", spec, tmp_path)
    assert report.ok and report.numbers["motion_error_max_mm"] < 2e-5
    assert report.numbers["stroke_units"] == pytest.approx(12, abs=1e-4)
    plain = written(
        tmp_path, "deg;mm\n" + "".join(f"{k};{k % 90},5\n" for k in range(361)), "t.csv"
    )
    report = measuring.run(plain, None, tmp_path)
    assert report.numbers["stroke_units"] >= 89 and report.numbers["rows"] == 361
    assert (tmp_path / "t-motion" / "report.html").is_file()
    open_ended = written(tmp_path, "".join(f"{k},{k / 1e3}\n" for k in range(361)), "o.csv")
    (jump,) = measuring.run(open_ended, None, tmp_path).findings
    assert not jump.ok and jump.code == "MOTION_JUMP"


def test_a_table_is_held_against_its_spec(root: Path, built: Any, tmp_path: Path) -> None:
    """Every half degree to four decimals holds; one row 0.01 mm off, a coarse table and three quarters of a turn fail."""
    spec = root / "specs" / "disc-cam.toml"
    x = np.arange(0, 360.25, 0.5)
    (motion,) = follower_motions(camgen.load(spec))
    rows = np.round(motion.law(x, 0), 4)
    spoilt = rows.copy()
    spoilt[100] += 0.01
    cases = {
        "sound": (x, rows, True),
        "spoilt": (x, spoilt, False),
        "coarse": (x[::60], motion.law(x[::60], 0), False),
        "short": (x[:541], rows[:541], False),
    }
    for name, (master, slave, holds) in cases.items():
        text = "".join(f"{a:g},{b:.17g}\n" for a, b in zip(master, slave, strict=True))
        findings = measuring.run(written(tmp_path, text, f"{name}.csv"), spec, tmp_path).findings
        (table,) = (each for each in findings if each.code == "SERVO_TABLE")
        assert table.ok == holds, name
        if name == "spoilt":
            assert table.measured / 100 * motion.stroke == pytest.approx(0.01, rel=0.05)


@pytest.mark.parametrize(
    "text, says",
    [
        ("", "has 0 rows"),
        ("0,0\n120,1e308\n240,-1e308\n360,0\n", r"row 2 has 1e\+308; numbers up to 1e\+06"),
        ("0,0\n120,nan\n360,0\n", "row 2 has no 2 numbers"),
        (DOCUMENTED.replace("dY := 240", "dY := 1e999"), "row 3 has inf; numbers up to"),
        (DOCUMENTED.replace("dA := 0)]", "dA := -1e308)]"), r"row 4 has -1e\+308"),
        ("0,0\n1,1\n1,2\n", "row 3 has master 1, not greater than 1"),
        ("0,0\n1,x\n2,2\n", "row 2 has no 2 numbers"),
        (
            DOCUMENTED.replace(
                "dV := 1, dA := 0),\n        (dX := 240", "dA := 0),\n        (dX := 240"
            ),
            "point 2 has no number dV",
        ),
        ("A : ARRAY[0..1] OF SMC_CAMXYVA;", "has 0 rows"),
    ],
)
def test_no_table(tmp_path: Path, text: str, says: str) -> None:
    with pytest.raises(FileError, match=says):
        read_cam_table(written(tmp_path, text))


def test_options_of_others_are_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = str(written(tmp_path, DOCUMENTED))
    with pytest.raises(SystemExit) as ended:
        main(["motion", path, "--ratio", "2"])
    assert ended.value.code == 2
    assert "--ratio does not go with a cam table" in capsys.readouterr().err
