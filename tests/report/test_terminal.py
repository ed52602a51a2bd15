"""What a terminal shows: verdicts at every width, and nothing that steers it."""

from __future__ import annotations

import json
import math
import re
import sys
from dataclasses import replace
from pathlib import Path

import pytest
from test_cli import run as run  # noqa: F401  a fixture

from camgen.findings import Finding, NotJudged, Where, at_least, at_most
from camgen.report.report import Report
from camgen.report.summary import summary
from camgen.report.terminal import number, print_report
from camgen.report.words import sentence
from camgen.study import Figure, Figures, Step, Table

FINDINGS = (
    at_most(
        "MOTION_ERROR",
        1.234e-5,
        1.8e-3,
        "deg",
        Where(
            file="long-name-of-a-machine-cam.dxf",
            kind="dxf",
            theta=math.radians(123.456),
        ),
        "as wanted",
    ),
    at_least(
        "TRANSMISSION_ANGLE",
        88.21,
        45,
        "deg",
        Where(theta=math.pi / 2, angle="crank angle", digits=0),
        "wide",
    ),
    at_least(
        "MIN_WALL",
        -12.345,
        0.8,
        "mm",
        Where(file="long-name-of-a-machine-cam.stl", kind="stl"),
        "thin",
    ),
)


def shown(findings: tuple[Finding, ...], capsys: pytest.CaptureFixture[str], **how: bool) -> str:
    print_report(Report("long-name-of-a-machine", "disc-cam", findings), **how)
    return capsys.readouterr().out


def test_the_verdict_stands_first_then_what_fails_then_figures(
    capsys: pytest.CaptureFixture[str],
) -> None:
    """In words; the table of all findings comes with --verbose alone."""
    report = Report(
        "demo",
        "linkage",
        FINDINGS,
        Figures(
            [
                Figure("{of} stroke", 68.0, "mm", "foot"),
                Figure("{of} stroke along", -5.0, "deg", "foot"),
                Figure("drive torque", 0.25, "N m"),
                Figure("drive power", 9.0, "W"),
            ]
        ),
        not_judged=[NotJudged(code, "no STL is there", "STL") for code in ("VOLUME", "BED_FIT")],
        warnings=["mind the gap"],
    )
    print_report(report)
    assert capsys.readouterr().out.splitlines() == [
        "demo: 1 of 3 findings FAILS; 2 not judged; 1 warning",
        "MIN_WALL (long-name-of-a-machine-cam.stl) fails: -12.35 mm; needed: at least 0.8 mm. Thin.",
        "what it means and what helps: camgen explain MIN_WALL",
        "not judged: VOLUME, BED_FIT: no STL is there",
        "warning: mind the gap",
        "  Foot stroke               68  mm   along -5 deg",
        "  Transmission angle     88.21  deg  at least 45 (TRANSMISSION_ANGLE)",
        "  Torque needed           0.25  N m",
        "  Motion error        1.234e-5  deg  at most 0.0018 (MOTION_ERROR)",
    ]
    idle = Figure("drive torque", 2.9e-8, "N m")  # nothing presses on the cam
    print_report(replace(report, numbers=report.numbers | [idle]))
    assert "Torque needed" not in capsys.readouterr().out
    print_report(report, verbose=True)
    every = capsys.readouterr().out
    assert [code in every for code in ("margin", "TRANSMISSION_ANGLE (crank angle 90 deg) holds")]


def stroke(of: str, value: float, along: float) -> list[Figure]:
    return [
        Figure("{of} stroke", value, "mm", of),
        Figure("{of} stroke along", along, "deg", of),
    ]


def test_outputs_that_move_equally_far_are_one_figure(capsys: pytest.CaptureFixture[str]) -> None:
    """Both wings to all digits that are shown; beyond them a third output that moves otherwise, and several more."""
    wings = [*stroke("left_tip", 52.19, 88.2), *stroke("right_tip", 52.189999, -88.2)]
    print_report(Report("bird", "linkage", (), Figures([*wings, *stroke("beak", 52.18, 0.0)])))
    assert capsys.readouterr().out.splitlines()[1:] == [
        "  Left tip and right tip stroke  52.19  mm  along 88.2 and -88.2 deg",
        "  Beak stroke                    52.18  mm  along 0 deg",
    ]
    feet = [each for of in ("a", "b", "c") for each in stroke(of, 9.0, 8.44)]
    print_report(Report("feet", "linkage", (), Figures(feet)))
    assert capsys.readouterr().out.splitlines()[1:] == [
        "  A stroke and 2 more  9  mm  along 8.4 deg"
    ]


def test_rounding_is_shown_as_0_but_where_it_fails(capsys: pytest.CaptureFixture[str]) -> None:
    found = (
        at_most("PIN_GAP", 2.665e-15, 0.1, "mm", Where(), ""),
        at_most("LASH", 1e-12, 0, "mm", Where(), ""),
    )
    text = shown(found, capsys, verbose=True)
    assert (
        "2.665" not in text
        and re.search(r"PIN_GAP +0 +<= +0.1 ", text)
        and re.search(r"LASH +1e-12 +<= +0 ", text)
        and "LASH fails: below 1e-9 mm; allowed: at most 0 mm" in text
    )


def test_an_error_that_is_only_rounding_is_no_bare_0(capsys: pytest.CaptureFixture[str]) -> None:
    text = shown((at_most("MOTION_ERROR", 3e-16, 0.01, "mm", Where("dxf"), ""),), capsys)
    assert re.search(r"Motion error +below 1e-9 +mm +at most 0.01 ", text)


@pytest.mark.parametrize(
    ("written", "read"),
    [
        ("they miss by 1.421e-14 mm", "they miss by 0 mm"),
        ("-2.2e-16, 5e-10 and 12e-100", "0, 0 and 0"),
        ("1e-9 mm, 2.5e-05 N", "1e-9 mm, 2.5e-05 N"),
        ("part-1e-12.stl, x1e-12, 1e-12x", "part-1e-12.stl, x1e-12, 1e-12x"),
    ],
)
def test_a_sentence_has_no_number_that_is_only_rounding(written: str, read: str) -> None:
    assert sentence(written) == read


def test_a_limit_that_is_itself_too_little_is_told_as_such(
    capsys: pytest.CaptureFixture[str],
) -> None:
    text = shown(
        (
            Finding(
                "LIFT_OFF",
                False,
                0.0,
                0.0,
                "N",
                Where(),
                "nothing presses",
                floor=True,
                strict=True,
            ),
        ),
        capsys,
        verbose=True,
    )
    assert re.search(r"LIFT_OFF +0 +> +0 ", text) and "0 N; needed: more than 0 N" in text


@pytest.mark.parametrize("width", [200, 120, 80, 50, 30])
def test_table_keeps_verdict_code_measured_and_limit(
    width: int, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("COLUMNS", str(width))
    monkeypatch.setattr(sys.stdout, "isatty", lambda: True, raising=False)
    text = re.sub(r"\x1b\[[0-9;]*m", "", shown(FINDINGS, capsys, verbose=True))
    rows = [line for line in text.splitlines() if line.rstrip().endswith((" ok", " FAIL"))]
    assert rows[0].split()[0] == "MIN_WALL"  # what fails comes first
    for finding, row in zip((FINDINGS[2], *FINDINGS[:2]), rows, strict=True):
        told = {
            finding.code,
            number(finding.measured),
            number(finding.limit),
            "ok" if finding.ok else "FAIL",
        }
        told |= {finding.sign}
        assert told <= set(row.split()), row
        assert len(row) <= max(width, 50)
    table = text[: text.index("holds:")]
    assert ("crank angle" in table) is (width > 50)
    assert ("margin" in text) is (width > 80)
    assert "…" not in table  # nothing is cut: a place takes two lines


@pytest.mark.parametrize("width", [120, 60, 40])
def test_sentences_are_wrapped_at_the_width_of_a_terminal(
    width: int, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """At blanks: a word is never cut; a file or a pipe has them as they are."""
    long = (replace(FINDINGS[2], message="walls-and-bridges " * 20),)
    whole = shown(long, capsys)
    monkeypatch.setenv("COLUMNS", str(width))
    monkeypatch.setattr(sys.stdout, "isatty", lambda: True, raising=False)
    text = re.sub(r"\x1b\[[0-9;]*m", "", shown(long, capsys))
    assert text.split() == whole.split() and max(map(len, whole.splitlines())) > 300
    assert all(len(line) <= width or " " not in line.strip() for line in text.splitlines())


@pytest.mark.parametrize(
    ("plates", "said"),
    [((), ""), ((2,), ", and plate-2"), ((2, 3, 4, 5, 6, 7, 8, 9, 10), ", and plate-2 to -10")],
)
def test_every_plate_is_named(
    plates: tuple[int, ...],
    said: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    """Of the machine with the longest name in 80 columns; a part that is a plate is none of them."""
    monkeypatch.chdir(tmp_path)
    name = "chain-stitch-looper"
    folder = Path("out", name)
    folder.mkdir(parents=True)
    for each in ("plate", "needle-plate", "plate-drawing", *(f"plate-{each}" for each in plates)):
        (folder / f"{name}-{each}.3mf").touch()
    print_report(Report(name, name, FINDINGS[:2], folder=folder))
    line = capsys.readouterr().out.splitlines()[-1]
    assert line == f"print {folder}/{name}-plate.3mf{said}" and len(line) <= 80


STEERS = "\x1b[31m\x9b5m\u202e"  # red, blinking, and from right to left
ESCAPED = r"\x1b[31m\x9b5m\u202e"


def test_nothing_of_a_report_steers_the_terminal(capsys: pytest.CaptureFixture[str]) -> None:
    text = shown((at_most(STEERS, 1, 0, STEERS, Where(STEERS), STEERS),), capsys, verbose=True)
    assert not set(STEERS) - set("[31m5") & set(text) and text.count(ESCAPED) == 9


@pytest.mark.parametrize(
    "arguments", [("build", "x.toml"), ("build", "x.toml", "--json"), ("build", STEERS), (STEERS,)]
)
def test_nothing_of_a_spec_or_a_name_steers_the_terminal(
    run: object,
    arguments: tuple[str, ...],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,  # noqa: F811
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("x.toml").write_text(
        r'mechanism = "disc-cam"' + '\n"a' + "\\u001b[31m\\u009b5m\\u202e" + r'\nb" = "\u001b"',
        "utf-8",
    )
    code, out, err = run(*arguments)  # type: ignore[operator]
    assert code in (2, 4) and r"\x1b[31m" in err
    assert not set(STEERS) - set("[31m5") & set(out + err)
    if "--json" in arguments:
        assert any(fault["path"].endswith(STEERS + "\nb") for fault in json.loads(out)["faults"])
    elif "x.toml" in arguments:
        assert (
            len([line for line in err.splitlines() if ESCAPED in line]) == 1
        )  # a fault is one line


def test_too_long_a_list_is_told_its_limit(run: object, root: Path, tmp_path: Path) -> None:  # noqa: F811
    text = (root / "specs" / "disc-cam.toml").read_text("utf-8").partition("[[segment]]")[0]
    (tmp_path / "a.toml").write_text(
        text + '[[segment]]\nkind = "dwell"\nspan_deg = 3.6\n' * 101, "utf-8"
    )
    code, _, err = run("build", tmp_path / "a.toml")  # type: ignore[operator]
    assert code == 2 and "segment: a list of 101" in err and "at most 100" in err


@pytest.mark.parametrize(
    ("stand", "told"),
    [
        (None, " (all parts, estimated 4.9 h at 40% infill)"),
        (1.0, " (all parts, estimated 4.9 h in layers of 0.2 mm at 100% infill)"),
        (
            3.2,
            " (all parts, estimated 4.9 h in layers of 0.2 mm at 100% infill; the stand takes 3.2 h of it, and can be cut from sheet instead)",
        ),
    ],
)
def test_a_stand_that_takes_most_of_the_printing_is_told(
    stand: float | None, told: str, tmp_path: Path
) -> None:
    (tmp_path / "m-plate.3mf").touch()
    figures = [Figure("print time", 4.9, "h")]
    figures.append(Figure("print infill", 0.4 if stand is None else 1.0, ""))
    if stand is not None:
        figures.append(Figure("print time stand", stand, "h"))
        figures.append(Figure("print layer", 0.2, "mm"))
    report = Report("m", "linkage", [], Figures(figures), folder=tmp_path)
    (step,) = [each for each in summary(report).steps if each.verb == "print"]
    assert step.rest == told


def test_a_print_of_days_is_told_without_an_exponent(tmp_path: Path) -> None:
    (tmp_path / "m-plate.3mf").touch()
    report = Report(
        "m", "linkage", [], Figures([Figure("print time", 123.4, "h")]), folder=tmp_path
    )
    assert "estimated 120 h" in summary(report).steps[-1].rest


def headlines(*found: Finding, torque: float = 3.0) -> list[str]:
    """Names of the figures that stand first."""
    figures = Figures([Figure("stroke", 12.0, "mm"), Figure("drive torque", torque, "N m")])
    return [each.name for each in summary(Report("m", "disc-cam", found, figures)).figures]


def test_a_torque_of_no_load_and_a_play_of_zero_give_way_to_the_next_figure() -> None:
    """A gram on an arm of 10 mm is 9.8e-5 N m."""
    gap = at_least("INTERFERENCE", 103.1, 0, "mm", Where(), "")
    play = at_most("LASH", 0.0, 5.0, "deg", Where(), "")
    assert headlines(play, gap, torque=4.7e-6) == ["Stroke", "Least gap"]
    felt = replace(play, measured=0.2)
    assert headlines(felt, gap, torque=2e-4) == [
        "Stroke",
        "Free play",
        "Torque needed",
        "Least gap",
    ]


def test_a_cam_tells_its_size_after_its_pressure_angle() -> None:
    """Whether given or found: a large one is seen at once."""
    figures = Figures([Figure("stroke", 12.0, "mm"), Figure("base radius", 30.0, "mm")])
    angle = at_most("PRESSURE_ANGLE", 25.0, 30.0, "deg", Where(), "")
    first = summary(Report("m", "disc-cam", (angle,), figures)).figures
    assert [each.name for each in first] == ["Stroke", "Pressure angle", "Base radius"]
    assert first[-1].value == 30.0
    spring = at_most("SPRING_STRESS", 780.0, 891.0, "MPa", Where(), "")
    strained = summary(Report("m", "disc-cam", (angle, spring), figures)).figures
    told = [(each.name, each.value) for each in strained]
    assert told[2:] == [("Base radius", 30.0), ("Spring stress", 780.0)]


def test_what_is_strained_stands_before_torque_and_error() -> None:
    """Contact pressure of a steel cam, not a gap of 103 mm; of a printed one, which bears little, after them."""
    always = (
        at_least("INTERFERENCE", 103.1, 0, "mm", Where(), ""),
        at_most("MOTION_ERROR", 1e-3, 2e-3, "mm", Where("dxf"), ""),
        at_most("PIN_STRESS", 10.0, 100.0, "MPa", Where(), ""),
    )
    steel = at_most("HERTZ", 430.0, 559.0, "MPa", Where(), "")
    assert headlines(*always, steel) == [
        "Stroke",
        "Contact pressure",
        "Torque needed",
        "Motion error",
        "Least gap",
    ]
    calm = replace(steel, measured=20.0)
    assert headlines(*always, calm)[1:4] == ["Torque needed", "Motion error", "Contact pressure"]
    pin = replace(always[2], measured=99.0)
    assert headlines(*always[:2], pin, steel)[1] == "Pin stress"
    asked = at_most("STRAIGHTNESS", 0.4, 0.5, "mm", Where(), "")
    assert headlines(*always, asked)[1] == "Straightness"


@pytest.mark.parametrize(
    ("grams", "told"),
    [(9_999.0, (9_999.0, "g")), (10_000.0, (10.0, "kg")), (729_700, (729.7, "kg"))],
)
def test_a_heavy_machine_is_weighed_in_kg(grams: float, told: tuple[float, str]) -> None:
    report = Report("m", "linkage", [], Figures([Figure("mass", grams, "g")]))
    (mass,) = summary(report).figures
    assert (mass.value, mass.unit) == told


def test_one_changed_file_is_one_file(capsys: pytest.CaptureFixture[str]) -> None:
    changed = at_most("MANIFEST", 1, 0, "files", Where(file="manifest.json"), "changed: a.dxf")
    ripple = at_most("SPEED_RIPPLE", 0.02, 0.01, "share", Where(), "lower it")
    print_report(Report("demo", "disc-cam", [changed, ripple]))
    said = capsys.readouterr().out
    assert "MANIFEST (manifest.json) fails: 1 file; allowed: at most 0 files." in said
    assert "SPEED_RIPPLE fails: 2 %; allowed: at most 1 %." in said


def test_a_page_with_steps_is_said_to_show_how_to_put_it_together(tmp_path: Path) -> None:
    """A machine of one part has none; nor has a page without the solids that its steps show."""
    for each in ("report.html", "motion.csv", "demo-assembly.glb"):
        (tmp_path / each).touch()
    order = Table(
        "Assembly", ("step", "part"), [(1, "cam"), (2, "arm")], steps=[Step(()), Step(())]
    )
    report = Report("demo", "linkage", [], tables=[order], folder=tmp_path)
    (step,) = summary(report).steps
    assert step.rest.endswith("to see it move and how to put it together")
    (tmp_path / "demo-assembly.glb").unlink()
    (step,) = summary(report).steps
    assert step.rest.endswith("to see it move")
