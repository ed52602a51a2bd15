"""The command line: exit codes to the letter, JSON alone on stdout, no traceback for a user's mistake."""

from __future__ import annotations

import gc
import io
import json
import os
import pty
import re
import select
import signal
import subprocess
import sys
import time
import tomllib
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from camgen import __version__, starters
from camgen.cli import main
from camgen.errors import DesignError, FileError
from camgen.findings import Where, at_most
from camgen.machines import MECHANISMS
from camgen.motion.laws import LAWS
from camgen.pipeline import build as pipeline
from camgen.report.report import Report

Run = Callable[..., tuple[int, str, str]]


@pytest.fixture
def run(capsys: pytest.CaptureFixture[str]) -> Run:
    """Runs the command line in this process: exit code, stdout, stderr."""

    def call(*arguments: object) -> tuple[int, str, str]:
        capsys.readouterr()
        with pytest.raises(SystemExit) as done:
            main([str(argument) for argument in arguments])
        out, err = capsys.readouterr()
        assert "Traceback" not in out + err
        assert isinstance(done.value.code, int)
        return done.value.code, out, err

    return call


def report(ok: bool = True, name: str = "cam") -> Report:
    limit = 2.0 if ok else 0.5
    return Report(
        name,
        "stub",
        (
            at_most(
                "MOTION_ERROR",
                1.0,
                limit,
                "deg",
                Where(file="cam.dxf", kind="dxf"),
                "the cam is off",
            ),
        ),
    )


@pytest.fixture
def results(monkeypatch: pytest.MonkeyPatch) -> dict[str, Any]:
    """A stub pipeline: what a spec of this file name gives, a Report or an exception."""
    outcome: dict[str, Any] = {}

    def give(path: Path, **_: object) -> Report:
        result = outcome[path.name]
        if isinstance(result, BaseException):
            raise result
        assert isinstance(result, Report)
        return result

    monkeypatch.setattr(pipeline, "build", give)
    monkeypatch.setattr(pipeline, "check", give)
    monkeypatch.setattr("camgen.workers.all_cores", lambda: 1)  # no other process knows the stub
    return outcome


NO_SUCH = DesignError("geometry.swing_deg", 60, 53.1, "deg", "the inner end", "use a smaller swing")


@pytest.mark.parametrize(
    "error, said",
    [
        (
            NO_SUCH,
            "geometry.swing_deg is 60 deg at the inner end, limit: at most 53.1 deg; use a smaller swing",
        ),
        (
            DesignError("pivots", 0, 1, "", "link a", "add one"),
            "there are no pivots (link a); add one",
        ),
        (
            DesignError("carriers that move", 2, 0, "", "", "fix them"),
            "carriers that move: 2, and none is allowed; fix them",
        ),
        (
            DesignError("gap", 0.0, 1, "mm", "joint A"),
            "gap is 0 mm at joint A, limit: at least 1 mm",
        ),
    ],
)
def test_what_cannot_exist_is_told_in_a_sentence(error: DesignError, said: str) -> None:
    assert str(error) == said


# ---- exit codes ------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("command", ["build", "check"])
@pytest.mark.parametrize(
    "result, code",
    [
        (report(), 0),
        (report(False), 1),
        (NO_SUCH, 3),
        (FileError("x.dxf", "lost"), 4),
        (OSError(28, "No space"), 4),
    ],
)
def test_exit_code_of_each_outcome(
    run: Run, results: dict[str, Any], command: str, result: object, code: int
) -> None:
    results["a.toml"] = result
    assert run(command, "a.toml")[0] == code


def test_worst_code_wins_and_each_is_reported(run: Run, results: dict[str, Any]) -> None:
    results |= {
        "a": report(name="first"),
        "b": NO_SUCH,
        "c": report(False, "third"),
        "d": report(name="fourth"),
    }
    code, out, err = run("build", "a", "b", "c", "d")
    assert code == 3
    assert [name for name in ("first", "third", "fourth") if name in out] == [
        "first",
        "third",
        "fourth",
    ]
    assert (
        "geometry.swing_deg is 60 deg at the inner end, limit: at most 53.1 deg; use a smaller swing"
        in err
    )


def test_table_shows_measured_limit_margin_and_verdict(run: Run, results: dict[str, Any]) -> None:
    results |= {"good": report(), "bad": report(False)}
    (line,) = (line for line in run("build", "good")[1].splitlines() if "MOTION_ERROR" in line)
    assert line.split() == "Motion error 1 deg at most 2 (MOTION_ERROR)".split()
    out = run("build", "good", "-v")[1]
    line = next(line for line in out.splitlines() if line.startswith(" MOTION_ERROR"))
    assert line.split() == ["MOTION_ERROR", "1", "<=", "2", "1", "deg", "cam.dxf", "ok"]
    out = run("build", "bad", "-v")[1]
    line = next(line for line in out.splitlines() if line.startswith(" MOTION_ERROR"))
    assert line.split() == ["MOTION_ERROR", "1", "<=", "0.5", "-0.5", "deg", "cam.dxf", "FAIL"]
    assert "MOTION_ERROR (cam.dxf) fails: 1 deg; allowed: at most 0.5 deg. The cam is off." in out
    assert "camgen explain MOTION_ERROR" in out


def test_quiet_tells_what_fails_and_verbose_tells_all(run: Run, results: dict[str, Any]) -> None:
    results |= {"good": report(), "bad": report(False)}
    assert run("build", "good", "--quiet") == (0, "", "")
    code, out, _ = run("build", "bad", "-q")
    assert (
        (code, len(out.splitlines())) == (1, 3) and "The cam is off" in out and "margin" not in out
    )
    results |= {
        ok: replace(report(ok == "good"), remarks=["files are gone"], warnings=["read me"])
        for ok in ("good", "bad")
    }
    assert run("build", "good", "-q") == (0, f"note: {report().name}: files are gone\n", "")
    assert (
        "note: files are gone\n" in (out := run("build", "bad", "-q")[1]) and "read me" not in out
    )
    assert (
        "cam is off" not in run("build", "good")[1]
        and "The cam is off" in run("build", "good", "-v")[1]
    )


MORE = "cam-disc.step", "cam-assembly.glb", "cam-sheet-1.svg", "cam-sheet-2.svg"


def test_the_last_lines_say_where_the_files_are_and_what_to_open(
    run: Run, results: dict[str, Any], tmp_path: Path
) -> None:
    for name in ("report.html", "cam-plate.3mf", "cam-disc.dxf", "cam-disc.stl", *MORE):
        (tmp_path / name).write_text("")
    results["a"] = replace(report(), folder=tmp_path)
    *_, where, see, make, cut = run("build", "a")[1].splitlines()
    assert where == f"files are in {tmp_path}: 1 DXF, 1 STL, 1 3MF, 1 STEP, 1 GLB, 2 SVG"
    assert cut == f"cut {tmp_path / 'cam-sheet-1.svg'} and 1 more"
    assert str(tmp_path / "report.html") in see and str(tmp_path / "cam-plate.3mf") in make
    assert str(tmp_path / "cam-disc.dxf") in run("build", "a", "-v")[1]
    results["a"] = replace(report(False), folder=tmp_path)
    *_, where, see, wait = run("build", "a")[1].splitlines()
    assert str(tmp_path / "report.html") in see and wait.startswith("make no parts yet")


@pytest.mark.parametrize("shell", ["bash", "zsh", "fish"])
def test_shell_completes(shell: str) -> None:
    def complete(instruction: str, **words: str) -> str:
        environment = os.environ | {"_CAMGEN_COMPLETE": f"{shell}_{instruction}"} | words
        return subprocess.run(
            CAMGEN, env=environment, capture_output=True, text=True, check=True
        ).stdout

    assert f"_CAMGEN_COMPLETE={shell}_complete" in complete("source")
    typed = {"bash": "camgen new di", "zsh": "camgen new di", "fish": "camgen new"}[shell]
    word = {"bash": "2", "zsh": "2", "fish": "di"}[shell]
    assert "disc-cam" in complete("complete", COMP_WORDS=typed, COMP_CWORD=word)
    typed = {
        "bash": "camgen explain UNDER",
        "zsh": "camgen explain UNDER",
        "fish": "camgen explain",
    }[shell]
    word = {"bash": "2", "zsh": "2", "fish": "UNDER"}[shell]
    assert "UNDERCUT" in complete("complete", COMP_WORDS=typed, COMP_CWORD=word)


def test_internal_error_is_one_line_and_code_70(run: Run, results: dict[str, Any]) -> None:
    results["a"] = RuntimeError("a fault of ours")
    code, out, err = run("build", "a")
    assert (code, out) == (70, "")
    assert re.fullmatch(
        r"internal error: RuntimeError: a fault of ours \(test_cli.py:\d+\); please report.*\n", err
    )


def test_interrupt_is_130(run: Run, results: dict[str, Any]) -> None:
    results["a"] = KeyboardInterrupt()
    assert run("build", "a")[0] == 130


IMPATIENT = """
import sys
from importlib import import_module
class Impatient:
    def find_spec(self, name, *_):
        if name == "click":
            raise KeyboardInterrupt
sys.meta_path.insert(0, Impatient())
module, name = sys.argv[1].split(":")
sys.exit(getattr(import_module(module), name)())
"""


def test_interrupt_while_the_command_line_is_imported_is_130_too() -> None:
    project = tomllib.loads((Path(__file__).parents[1] / "pyproject.toml").read_text())["project"]
    entry = project["scripts"]["camgen"]
    done = subprocess.run(
        [sys.executable, "-c", IMPATIENT, entry], capture_output=True, text=True, check=False
    )
    said = "interrupted\n"
    assert (done.returncode, done.stdout, done.stderr) == (130, "", said)


@pytest.mark.parametrize(
    "arguments",
    [
        ("build",),
        ("check",),
        ("new",),
        ("schema",),
        ("bild",),
        ("build", "a", "--only", "iges"),
        ("build", "--nope"),
        ("build", "a", "--only", ""),
        ("new", "uniform-swin"),
        ("schema", "uniform-swin"),
        ("build", "a", "--set"),
    ],
)
def test_wrong_command_is_2(run: Run, arguments: tuple[str, ...]) -> None:
    code, out, err = run(*arguments)
    assert (code, out) == (2, "")
    assert err


def test_nearest_mechanism_is_named(run: Run) -> None:
    assert "did you mean 'uniform-swing'?" in run("new", "uniform-swin")[2]
    code, _, err = run("new", "out.toml", "bird-drum")
    assert code == 2 and "first the mechanism, then the file: camgen new bird-drum out.toml" in err


def test_a_folder_that_is_missing_is_told(run: Run, tmp_path: Path) -> None:
    code, _, err = run("new", "disc-cam", str(tmp_path / "none" / "x.toml"))
    assert code == 4 and f"there is no folder {tmp_path / 'none'}" in err


def test_a_word_of_a_heading_leads_to_its_page(run: Run) -> None:
    """The table of materials stands in that on sheet and metal."""
    assert "lists; laser, " in run("guide", "materials")[2]


def test_a_machine_that_cannot_be_tells_where_its_keys_are_written(
    run: Run, tmp_path: Path
) -> None:
    """A key of the file by its line, one that is left out by its default, one of --set not at all."""
    spec = tmp_path / "s.toml"
    text = starters.text("disc-cam").replace("base_radius = 25", "base_radius = 6")
    spec.write_text(text, "utf-8")
    rows = text.splitlines()
    radius, hub = (
        next(k for k, row in enumerate(rows, 1) if row.startswith(f"{key} = "))
        for key in ("base_radius", "hub_diameter")
    )
    build = ("build", spec, "-o", tmp_path / "out", "--only", "dxf")
    *_, first, second = run(*build)[2].splitlines()
    assert first == f"  parts.hub_diameter: line {hub}"
    assert second == f"  geometry.base_radius: line {radius}"
    *_, last = run(*build, "--set", "geometry.base_radius=5")[2].splitlines()
    assert last == f"  parts.hub_diameter: line {hub}"
    spec.write_text("\n".join(row for row in rows if not row.startswith("hub_diameter")), "utf-8")
    *_, first, _ = run(*build)[2].splitlines()
    assert first == "  parts.hub_diameter: not in s.toml; 16 is its default"
    said = run(*build, "--set", "geometry.base_radius=0.025")[2]
    assert "note: geometry.base_radius = 0.025 is read in mm; 0.025 m are 25 mm" in said


# ---- JSON ------------------------------------------------------------------------------------------------------------


def test_json_of_one_and_of_several(run: Run, results: dict[str, Any]) -> None:
    results |= {"a": report(), "b": NO_SUCH, "c": report(False)}
    code, out, _ = run("build", "a", "--json")
    assert (code, json.loads(out)) == (0, report().as_dict())
    code, out, err = run("build", "a", "b", "c", "--json")
    first, second, third = json.loads(out)
    assert (code, first["ok"], second["ok"], third["ok"]) == (3, True, False, False)
    facts = {
        name: getattr(NO_SUCH, name)
        for name in ("quantity", "value", "limit", "unit", "where", "remedy")
    }
    assert (second["source"], second["exit_code"], second["faults"]) == ("b", 3, [facts])
    assert second["error"] == str(NO_SUCH) and str(NO_SUCH) in err


def test_json_of_a_wrong_spec_lists_its_faults(run: Run, tmp_path: Path, starter: Path) -> None:
    code, out, _ = run(
        "build",
        starter,
        "--set",
        "geometry.swing_deg=180",
        "--set",
        "x=1",
        "--json",
        "-o",
        tmp_path,
    )
    found = json.loads(out)
    assert (code, found["exit_code"]) == (2, 2)
    assert [fault["path"] for fault in found["faults"]] == ["geometry.swing_deg", "x"]
    assert set(found["faults"][0]) == {"path", "value", "expected", "nearest", "line"}


@pytest.mark.long
def test_json_is_the_text_of_report_json(run: Run, tmp_path: Path, starter: Path) -> None:
    code, out, err = run("build", starter, "--only", "dxf", "--json", "-o", tmp_path)
    assert (code, err) == (0, "")
    assert out == (tmp_path / "uniform-swing" / "report.json").read_text(encoding="utf-8")


# ---- build and check, for real ---------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("words", "said"),
    [
        ("build disc-cam", "camgen new disc-cam my-disc-cam.toml writes one"),
        ("build specs/walker.toml", "no such file; camgen new walker walker.toml writes one"),
        ("build disc-cam.toml", "no such file; camgen new disc-cam disc-cam.toml writes one"),
        ("build a.toml --only dxf stl", "write kinds without a space, as in --only dxf,stl"),
        ("build a.toml -only dxf", "two hyphens, --only"),
        ("build aa.toml", "did you mean a.toml?"),
        ("build a.toml --set geometry.base_radius:30", "such as geometry.base_radius=30"),
        ("build a.toml --set geometry.base_radius", "such as geometry.base_radius=24"),
        ("build a.toml --set nonsense", "such as geometry.swing_deg=24"),
        ("build a.toml --set segment[0].lift=8", "a row behind a dot: segment.0"),
        ("build a.toml --set segment.lift=8", "segment.0.lift is that of the first"),
        ("a.toml", "camgen build a.toml"),
        ("check a.toml", "camgen build a.toml makes one"),
        ("check out/nothing", "there is no such folder: camgen build SPEC makes one"),
        ("watch aa.toml", "did you mean a.toml?"),
        ("guide walker", "own-linkage"),
        ("guide zzz", "expected one that 'camgen guide' lists\n"),
        ("sweep disc-cam --vary a=1,2", "camgen new disc-cam my-disc-cam.toml writes one"),
        ("sweep a.toml --vary geometry.base_radius=20-30", "20:30:N, N values from 20 to 30"),
        ("sweep a.toml --vary geometry.base_radius=2.5..30", "2.5:30:N, N values"),
        ("motion a.dxf", "such as --follower translating,radius=5"),
    ],
)
def test_a_command_typed_in_haste_is_told_as_it_should_be(
    run: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, words: str, said: str
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("a.toml").write_text(starters.text("disc-cam"), "utf-8")
    code, out, err = run(*words.split())
    assert code in (2, 4) and out == "" and said in err
    assert [path.name for path in tmp_path.iterdir()] == ["a.toml"]  # nothing is made


def test_check_names_the_folder_that_is_meant(run: Run, tmp_path: Path) -> None:
    folder = tmp_path / "out" / "disc-cam"
    spec = starters.folder() / "disc-cam.toml"
    assert run("build", spec, "--only", "dxf", "-o", folder.parent)[0] == 0
    for wrong in (folder.parent, folder / "report.json"):
        code, _, err = run("check", wrong)
        assert code == 4 and f"did you mean {folder}?" in err
    code, _, err = run("check", spec.parent)
    assert code == 4 and "did you mean" not in err


@pytest.mark.parametrize(
    "text, code, words",
    [
        ("", 2, "empty"),
        ("name = ", 2, "line 1, column"),
        ('name = "a"', 2, "mechanism"),
        ('mechanism = "uniform-swin"\nname = "a"', 2, "did you mean 'uniform-swing'?"),
        ('mechanism = ["uniform-swing"]\nname = "a"', 2, "mechanism: ['uniform-swing']"),
        ('mechanism = "uniform-swing"\nname = "../a"', 2, "name: '../a'"),
        ('mechanism = "uniform-swing"\nname = "a"', 2, "geometry - missing"),
    ],
)
def test_wrong_spec_writes_nothing(
    run: Run, tmp_path: Path, text: str, code: int, words: str
) -> None:
    (tmp_path / "s.toml").write_text(text)
    found, out, err = run("build", tmp_path / "s.toml", "-o", tmp_path / "out")
    assert (found, out) == (code, "")
    assert words in err
    assert [path.name for path in tmp_path.iterdir()] == ["s.toml"]


@pytest.mark.parametrize(
    "setting, code",
    [
        ("geometry.swing_deg=180", 2),
        ("geometry.swing_deg=0", 2),
        ("geometry.swing_deg=170", 3),
        ("geometry.tip_radius=40", 3),
        ("parts.bore=80", 3),
        ("parts.wall=0.1", 2),
        ("geometry.pivot_distance=nan", 2),
    ],
)
def test_impossible_cam_writes_nothing_and_spares_the_earlier_one(
    run: Run, tmp_path: Path, starter: Path, setting: str, code: int
) -> None:
    earlier = tmp_path / "uniform-swing"
    earlier.mkdir()
    found, out, err = run("build", starter, "-o", tmp_path, "--set", setting, "--only", "dxf")
    assert (found, out) == (code, "")
    assert (
        err.startswith("error: ")
        and setting.partition("=")[0].rpartition(".")[2].partition("_")[0] in err
    )
    assert list(tmp_path.rglob("*")) == [earlier]


def test_faults_of_settings_and_of_the_spec_are_told_at_once(
    run: Run, tmp_path: Path, starter: Path
) -> None:
    settings = ("geometry.pivot=60", "base.galp=", "zzz=", "parts.bore=none")
    typed = [word for setting in settings for word in ("--set", setting)]
    code, out, err = run("build", starter, "-o", tmp_path, *typed)
    assert (code, out) == (2, "") and "4 faults" in err
    for key in ("geometry.pivot:", "--set base.galp", "--set zzz", "parts.bore: 'none'"):
        assert err.count(key) == 1


def test_what_cannot_be_read_or_written_is_4(run: Run, tmp_path: Path, starter: Path) -> None:
    (tmp_path / "file").write_text("mine")
    (tmp_path / "out" / "uniform-swing").mkdir(parents=True)
    (tmp_path / "out" / "uniform-swing" / "letter.txt").write_text("mine")
    for arguments in (
        ("build", tmp_path),
        ("build", tmp_path / "none.toml"),
        ("build", starter, "-o", tmp_path / "file"),
        ("build", starter, "-o", tmp_path / "out"),
        ("check", tmp_path),
        ("check", tmp_path / "none"),
        ("check", tmp_path / "file"),
        ("new", "uniform-swing", tmp_path / "file"),
        ("new", "uniform-swing", tmp_path / "none" / "a.toml"),
        ("new", "uniform-swing", tmp_path),
    ):
        code, out, err = run(*arguments)
        assert (code, out) == (4, ""), arguments
        assert err.startswith("error: ") and str(tmp_path) in err
    assert (tmp_path / "file").read_text() == "mine"
    assert (tmp_path / "out" / "uniform-swing" / "letter.txt").read_text() == "mine"


@pytest.mark.long
def test_set_reaches_the_resolved_spec_and_check_agrees(
    run: Run, tmp_path: Path, starter: Path
) -> None:
    settings = ("--set", "geometry.swing_deg=24", "--set", "name=other")
    code, out, _ = run("build", starter, "-o", tmp_path, "--only", "dxf", "--json", *settings)
    assert code == 0
    resolved = tomllib.loads((tmp_path / "other" / "spec.toml").read_text())
    assert resolved["geometry"]["swing_deg"] == 24.0
    code, again, _ = run("check", tmp_path / "other", "--json")
    assert code == 0
    for wrong in (tmp_path / "other" / "spec.toml", tmp_path):
        code, _, err = run("check", wrong)
        assert code == 4 and f"{wrong}: is not the folder of a build, as out/<name> is" in err
    *same, anew = json.loads(again)["findings"]
    assert same == json.loads(out)["findings"] and (anew["code"], anew["ok"]) == ("REBUILD", True)


# ---- new, list, schema, version --------------------------------------------------------------------------------------


@pytest.mark.long
def test_edited_spec_of_a_result_is_kept_and_told(run: Run, tmp_path: Path, root: Path) -> None:
    build = ("build", str(root / "specs" / "disc-cam.toml"), "--only", "dxf", "-o", str(tmp_path))
    assert "kept" not in run(*build)[1]
    spec = tmp_path / "disc-cam" / "spec.toml"
    written = (tmp_path / "disc-cam" / "report.json").read_bytes()
    spec.write_text(spec.read_text() + "# mine\n")
    code, out, _ = run(*build)
    assert (
        code == 0
        and f"{spec} was changed after its build" in out
        and "kept the changed one as spec.toml.edited" in out
    )
    assert (tmp_path / "disc-cam" / "spec.toml.edited").read_text().endswith("# mine\n")
    assert (tmp_path / "disc-cam" / "report.json").read_bytes() == written
    assert run("check", str(tmp_path / "disc-cam"))[0] == 0


@pytest.mark.parametrize("mechanism", MECHANISMS)
def test_new_prints_and_writes_the_starter(
    run: Run, tmp_path: Path, root: Path, mechanism: str
) -> None:
    text = f"#:schema ./{mechanism}.schema.json\n" + (
        root / "specs" / f"{mechanism}.toml"
    ).read_text(encoding="utf-8")
    assert run("new", mechanism, "-") == run("new", mechanism)
    assert run("new", mechanism) == (
        0,
        text,
        f"printed only; to save it: camgen new {mechanism} my-{mechanism}.toml\n",
    )
    file, schema = tmp_path / "mine.toml", tmp_path / f"{mechanism}.schema.json"
    code, out, err = run("new", mechanism, file)
    assert (
        (code, out) == (0, "")
        and f"wrote {file}" in err
        and str(schema) in err
        and f"camgen build {file}" in err
    )
    assert file.read_text(encoding="utf-8") == starters.named(text, "mine")
    assert tomllib.loads(file.read_text(encoding="utf-8")) == tomllib.loads(text) | {"name": "mine"}
    assert schema.read_text(encoding="utf-8") == run("schema", mechanism)[1]
    schema.write_text("mine")
    assert (
        str(schema) not in run("new", mechanism, tmp_path / "another.toml")[2]
        and schema.read_text() == "mine"
    )
    file.write_text("changed")
    code, _, err = run("new", mechanism, file)
    assert code == 4 and "exists already" in err
    assert file.read_text() == "changed"


def test_new_alone_lists_and_asks(
    run: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    file = tmp_path / "mine.toml"
    monkeypatch.setattr("sys.stdin", io.StringIO(f"valve\n{file}\n"))
    code, out, err = run("new")
    assert (code, out) == (0, "") and "disc-cam " in err and "file [my-valve.toml]" in err
    assert file.read_text(encoding="utf-8").endswith(starters.named(starters.text("valve"), "mine"))
    monkeypatch.setattr("sys.stdin", io.StringIO("valv\n"))
    code, _, err = run("new")
    assert code == 2 and "did you mean 'valve'?" in err


@pytest.mark.parametrize(
    ("file", "name"),
    [("My Cam_2.toml", "my-cam-2"), ("Nocken-Größe.toml", "nocken-gr-e"), ("con.toml", "disc-cam")],
)
def test_new_names_the_machine_by_its_file(run: Run, tmp_path: Path, file: str, name: str) -> None:
    assert run("new", "--short", "disc-cam", tmp_path / file)[0] == 0
    assert tomllib.loads((tmp_path / file).read_text(encoding="utf-8"))["name"] == name


@pytest.mark.long
def test_a_result_of_another_spec_of_the_same_name_is_told(run: Run, tmp_path: Path) -> None:
    """Whose result is replaced: that of another file is told, an earlier one of the same file is not."""
    a, b, out = tmp_path / "a.toml", tmp_path / "b.toml", tmp_path / "out"
    text = starters.text("disc-cam")
    a.write_text(text, "utf-8")
    b.write_text(text.replace("lift = 12", "lift = 11"), "utf-8")
    build = ("build", "--only", "dxf", "-o", out)
    assert "the name" not in run(*build, a)[1]
    said = run(*build, b)[1]
    assert f"which was the result of {a}: both specs have the name 'disc-cam'" in said
    assert "the name" not in run(*build, b)[1]
    b.write_text(text.replace("lift = 12", "lift = 10"), "utf-8")
    assert "the name" not in run(*build, b)[1]
    b.write_text(text.replace("lift = 12", "lift = 12.5"), "utf-8")
    assert "the name" not in run(*build, b)[1]


def test_new_short_writes_few_lines(run: Run, tmp_path: Path) -> None:
    code, out, _ = run("new", "--short", "disc-cam")
    assert (
        code == 0
        and out == f"#:schema ./disc-cam.schema.json\n{starters.short(starters.text('disc-cam'))}"
    )
    chain = tmp_path / "chain.txt"
    code, _, err = run("new", "--short", "linkage", "--from", chain)
    assert code == 2 and "--short" in err


def test_new_says_how_to_get_a_shorter_one(run: Run, tmp_path: Path) -> None:
    for name, *options in (["long", "disc-cam"], ["short", "disc-cam", "--short"]):
        file = tmp_path / f"{name}.toml"
        _, _, err = run("new", *options, file)
        lines = len(file.read_text("utf-8").splitlines())
        assert ("--short" in err and f"in place of {lines})" in err) is (lines > 100)
    _, _, err = run("new", "flapping-bird", tmp_path / "bird.toml")
    assert "--short" not in err


def test_new_metal_writes_a_starter_of_steel(run: Run) -> None:
    code, out, _ = run("new", "--metal", "--short", "disc-cam")
    assert code == 0 and 'name = "C45"' in out and 'cam_follower = "KR16"' in out
    code, _, err = run("new", "--metal", "drum")
    assert code == 2 and "a form in steel: disc-cam, cylinder-cam" in err


def test_list_names_every_mechanism_and_law(run: Run) -> None:
    code, out, _ = run("list")
    words = out.split()
    assert code == 0 and set(MECHANISMS) | set(LAWS) <= set(words)


def test_schema_is_json_schema(run: Run) -> None:
    code, out, _ = run("schema", "uniform-swing")
    found = json.loads(out)
    assert code == 0
    assert {"mechanism", "name", "geometry"} <= set(found["required"])
    assert found["$defs"]["SwingGeometry"]["additionalProperties"] is False


def test_who_calls_it_from_python_keeps_the_collector_of_garbage(run: Run) -> None:
    before = gc.isenabled(), gc.get_freeze_count(), gc.get_threshold()
    assert run("--version")[0] == 0
    after = gc.isenabled(), gc.get_freeze_count(), gc.get_threshold()
    assert after == before and gc.isenabled()


def test_a_process_collects_its_garbage_while_it_runs() -> None:
    """Entities of drawings point at each other: of a million such objects most are freed again."""
    code = """
import gc, sys
from camgen import cli
sys.argv = ["camgen", "--version"]
try:
    cli.main()
except SystemExit:
    gc.unfreeze()
made = freed = 0
class Entity:
    def __del__(self):
        global freed
        freed += 1
while made < 1_000_000:
    one, other = Entity(), Entity()
    one.other, other.other = other, one
    made += 2
print(freed / made)
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert float(done.stdout.split()[-1]) > 0.7


def test_version_and_help(run: Run) -> None:
    assert run("--version")[:2] == (0, f"camgen, version {__version__}\n")
    for command in ((), ("build",), ("check",), ("new",), ("list",), ("schema",)):
        code, out, _ = run(*command, "--help")
        assert code == 0 and "Usage: camgen" in out
    assert "4  a file could not be written or read" in run("build", "-h")[1]


# ---- as a process ----------------------------------------------------------------------------------------------------

CAMGEN = [sys.executable, "-m", "camgen"]


def test_reader_that_closes_the_pipe() -> None:
    process = subprocess.Popen(
        [*CAMGEN, "schema", "uniform-swing"], stdout=subprocess.PIPE, stderr=subprocess.PIPE
    )
    assert process.stdout is not None and process.stderr is not None
    process.stdout.close()
    assert process.stderr.read() == b""
    process.stderr.close()
    assert process.wait() == 141


@pytest.mark.long
def test_stdout_that_is_full_or_closed() -> None:
    with open("/dev/full", "w", encoding="utf-8") as full:
        done = subprocess.run(
            [*CAMGEN, "schema", "uniform-swing"], stdout=full, stderr=subprocess.PIPE, text=True
        )
    assert done.returncode == 4
    assert "No space left" in done.stderr and "Traceback" not in done.stderr
    done = subprocess.run(
        ["sh", "-c", f"{sys.executable} -m camgen list >&-"], stderr=subprocess.PIPE, text=True
    )
    assert "Traceback" not in done.stderr


def test_file_name_that_is_no_text(tmp_path: Path) -> None:
    name = os.fsencode(tmp_path) + b"/\xff.toml"
    done = subprocess.run([*CAMGEN, "build", name, "--json"], capture_output=True)
    assert done.returncode == 4
    assert b"Traceback" not in done.stderr and json.loads(done.stdout)["exit_code"] == 4


SLOW = """
import sys, time
from pathlib import Path
from camgen.pipeline import build as pipeline
from camgen.cli import main
from camgen.files.folder import StagingFolder
def build(spec, out, only, overrides, progress, jobs):
    with StagingFolder(out / "cam") as folder:
        (folder / "half.dxf").write_text("half")
        progress("turning the handle")
        print("ready", flush=True)
        time.sleep(float(sys.argv[2]))
    raise OSError("that was all")
pipeline.build = build
main(["build", "a.toml", "-o", sys.argv[1], *sys.argv[3:]])
"""


@pytest.mark.long
@pytest.mark.parametrize("sent, code", [(signal.SIGINT, 130), (signal.SIGTERM, 143)])
def test_interrupted_build_leaves_the_earlier_result(
    tmp_path: Path, sent: signal.Signals, code: int
) -> None:
    (tmp_path / "cam").mkdir()
    process = subprocess.Popen(
        [sys.executable, "-c", SLOW, str(tmp_path), "60"],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        preexec_fn=lambda: signal.signal(
            sent, signal.SIG_DFL
        ),  # the shell of this run may ignore it
    )
    assert process.stdout is not None
    assert process.stdout.readline() == "ready\n"
    assert len(list(tmp_path.iterdir())) == 2
    process.send_signal(sent)
    _, err = process.communicate()
    assert process.returncode == code
    assert "Traceback" not in err
    if sent is signal.SIGINT:
        assert err == "interrupted: what was under way is not written\n"
    assert [path.name for path in tmp_path.iterdir()] == ["cam"] and not list(
        (tmp_path / "cam").iterdir()
    )


@pytest.mark.long
def test_a_signal_that_the_shell_ignores_ends_nothing(tmp_path: Path) -> None:
    process = subprocess.Popen(
        [sys.executable, "-c", SLOW, str(tmp_path), "0.5"],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        preexec_fn=lambda: signal.signal(signal.SIGHUP, signal.SIG_IGN),  # as nohup does
    )
    assert process.stdout is not None and process.stdout.readline() == "ready\n"
    process.send_signal(signal.SIGHUP)
    assert "that was all" in process.communicate()[1] and process.returncode == FileError.exit_code


@pytest.mark.long
@pytest.mark.parametrize("more, shown", [((), True), (("--quiet",), False)])
def test_step_is_named_from_the_start_on_a_terminal(
    tmp_path: Path, more: tuple[str, ...], shown: bool
) -> None:
    terminal, side = pty.openpty()
    environment = os.environ | {"TERM": "xterm"}
    process = subprocess.Popen(
        [sys.executable, "-c", SLOW, str(tmp_path), "0", *more],
        stdout=subprocess.PIPE,
        stderr=side,
        env=environment,
    )
    os.close(side)
    seen, until = b"", time.monotonic() + 20
    while time.monotonic() < until and select.select([terminal], [], [], 20)[0]:
        try:
            seen += os.read(terminal, 4096)
        except OSError:  # the other side was closed
            break
    os.close(terminal)
    out, _ = process.communicate()
    assert out == b"ready\n"
    assert (b"turning the handle" in seen) is shown and b"that was all" in seen


@pytest.mark.long
@pytest.mark.parametrize(
    "words, code",
    [
        (["list"], 0),
        (["explain", "PRESSURE_ANGLE"], 0),
        (["explain", "\u00fc"], 2),
        (["build", "--only", "dxf", "{spec}", "-o", "{folder}"], 0),
        (["build", "N\u00fc.toml"], 4),
    ],
)
def test_a_console_of_ascii_alone(tmp_path: Path, words: list[str], code: int) -> None:
    spec = starters.folder() / "disc-cam.toml"
    said = [word.format(spec=spec, folder=tmp_path / "\u03b8") for word in words]
    done = subprocess.run(
        [sys.executable, "-m", "camgen", *said],
        env={**os.environ, "PYTHONIOENCODING": "ascii:strict"},
        capture_output=True,
        timeout=120,
    )
    assert done.returncode == code and b"Traceback" not in done.stderr, done.stderr
    assert done.stderr if code else done.stdout


@pytest.mark.long
def test_a_console_without_utf_8_and_a_path_with_spaces(tmp_path: Path) -> None:
    folder = tmp_path / "my cams \u03b8"
    folder.mkdir()
    spec = folder / "Nocken \u00fc.toml"
    spec.write_bytes((starters.folder() / "disc-cam.toml").read_bytes())
    words = [sys.executable, "-m", "camgen", "build", "--only", "dxf", str(spec), "-o", str(folder)]
    done = subprocess.run(
        words, env={**os.environ, "PYTHONIOENCODING": "cp1252"}, capture_output=True, timeout=120
    )
    assert done.returncode == 0 and not done.stderr, done.stderr
    assert rb"\u03b8" in done.stdout and (folder / "disc-cam" / "manifest.json").exists()


def test_a_spec_given_as_an_outline_is_said_to_be_none(run: Run, root: Path) -> None:
    code, _, err = run("motion", root / "specs" / "disc-cam.toml")
    assert code == FileError.exit_code and "is a spec, no outline: give the DXF, STL or CSV" in err


def test_a_design_tells_the_figures_that_it_reached(run: Run, root: Path, tmp_path: Path) -> None:
    """A feed of 80 is wanted, within 1 %: it is told, and not the spec's name alone."""
    spec = root / "specs" / "thread-take-up.toml"
    code, _, err = run("design", spec, tmp_path / "found.toml", "--set", "wanted.feed_range=80")
    told = re.search(r"Feed stroke +([\d.]+) +mm", err)
    assert code == 0 and told and float(told[1]) == pytest.approx(80, rel=0.01)
