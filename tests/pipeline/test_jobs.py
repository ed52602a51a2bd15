"""Work shared out to several cores: the same results, the same bytes, the same errors; and nothing that nobody asked for."""

from __future__ import annotations

import json
import os
import pickle
import re
import signal
import subprocess
import sys
import zipfile
from collections.abc import Callable
from contextlib import suppress
from dataclasses import replace
from importlib import import_module
from pathlib import Path

import numpy as np
import pytest

from camgen.errors import CamgenError, DesignError, Fault, FileError, SpecError
from camgen.files.formats import FORMATS
from camgen.machines.mechanism import Mechanism
from camgen.machines.sources import Template, changed, read_mechanism, read_tables
from camgen.pipeline import build as pipeline
from camgen.pipeline.build import build, check
from camgen.pipeline.case import Case, cores
from camgen.workers import Workers

SPECS = Path(__file__).resolve().parents[2] / "specs"
FLAT = SPECS.parent / "tests" / "flat.py"
CAMS = ["parts.make='cams'", "parts.bore=8"]
ERRORS = [
    SpecError([Fault(("geometry", "rod"), "-1", "more than 0", None)], "a.toml"),
    DesignError("swing", 60.0, 53.1, "deg", where="the inner end", remedy="use less"),
    FileError("x.dxf", "lost"),
]


def identify(number: int) -> tuple[int, int]:
    return number, os.getpid()


def fail(number: int) -> None:
    raise ERRORS[number]


def test_several_cores_give_results_in_order_from_other_processes() -> None:
    with Workers(2) as workers:
        several = list(workers.map(identify, range(8)))
    with Workers(1) as workers:
        alone = list(workers.map(identify, range(8)))
    assert [number for number, _ in several] == [number for number, _ in alone] == list(range(8))
    assert os.getpid() not in {pid for _, pid in several} and {pid for _, pid in alone} == {
        os.getpid()
    }


@pytest.mark.parametrize("number", range(len(ERRORS)))
def test_an_error_arrives_with_all_its_facts(number: int) -> None:
    with pytest.raises(type(ERRORS[number])) as raised, Workers(2) as workers:
        workers.start(fail, number)()
    assert isinstance(raised.value, CamgenError)
    told = {name: value for name, value in vars(raised.value).items() if not name.startswith("__")}
    assert str(raised.value) == str(ERRORS[number]) and told == vars(ERRORS[number])


def test_a_case_is_reopened_from_its_folder(tmp_path: Path) -> None:
    (tmp_path / "spec.toml").write_bytes((SPECS / "uniform-swing.toml").read_bytes())
    case = Case(read_mechanism(tmp_path / "spec.toml"), tmp_path)
    again = pickle.loads(pickle.dumps(case))
    assert again.folder == tmp_path and list(again.parts) == list(case.parts)
    assert again.file("cam", "dxf") == tmp_path / "uniform-swing-cam.dxf"


@pytest.mark.long
def test_several_cores_say_the_same(tmp_path: Path) -> None:
    """A build and a check of its files; whether a build on one core says it too: `SHARED_OUT`, whose reports are compared."""
    told: list[float] = []
    report = build(
        SPECS / "eccentric-drive.toml",
        tmp_path,
        frozenset(pipeline.KINDS),
        progress=lambda _, done=None: told.append(done),
        jobs=2,
    )
    checked = check(tmp_path / "eccentric-drive", jobs=2)
    *same, anew = checked.findings
    assert report.ok and report.as_dict() == replace(checked, findings=same).as_dict()
    assert (anew.code, anew.ok) == ("REBUILD", True)
    assert told == sorted(told) and told[0] == 0 and told[-1] < 1, "the bar never runs back"


# Every kind of file: solids and exact ones, drawings, pages, sheets to cut, tables for machine tools.
LARGE = "dial-table"  # of 29 parts, which are made alone; the rest of the gallery is made, read back and judged
WALKER = "walker"  # of 48 parts on two sides: tests/parts/test_sides.py makes a smaller machine of two sides
HEART = "heart"  # of 33 parts, with the grooves and stands of others: tests/machines/test_gallery.py makes its drawings
AUTOMATON = (
    "gallery/automaton",
    ("output.step=true", "output.cutter_radius=3", "output.profile_step_deg=5"),
)
BEAK = ("gallery/beak", ("files.step=true",))
SHEET = ("gallery/four-bar", ("laser.thickness=3", "parts.make='laser'"))
ALONE = ("uniform-swing", tuple(CAMS))
MADE = [
    AUTOMATON,
    BEAK,
    ("gallery/bird-drum", ("files.step=true",)),
    ("gallery/cycloidal-reducer", ()),
    ("gallery/drum-feeder", ()),
    ("gallery/elliptic-trammel", ("files.step=true",)),
    ("gallery/elliptic-wheels", ("files.step=true",)),
    ("gallery/end-cam", ()),
    ("gallery/end-cam", ("files.step=true", "parts.make='drum'")),
    ("gallery/five-bar", ("files.step=true",)),
    ("gallery/flapping-bird", ()),
    ("gallery/four-bar", ("files.step=true",)),
    SHEET,
    ("gallery/geneva-table", ("files.step=true",)),
    ("gallery/groove", ("output.step=true",)),
    ("gallery/pencil-cam", ("files.step=true",)),
    ("gallery/plate-gripper", ()),
    ("gallery/ratchet", ("files.step=true",)),
    ("gallery/scotch-yoke", ("files.step=true",)),
    ("gallery/stepping-gears", ()),
    ("gallery/valve", ("output.step=true",)),
    ALONE,
]


def test_all_of_the_gallery_is_made() -> None:
    assert {path.stem for path in (SPECS / "gallery").glob("*.toml")} <= {LARGE, WALKER, HEART} | {
        Path(name).name for name, _ in MADE
    }


@pytest.mark.long(by="name")
@pytest.mark.parametrize("name, changes", MADE)
def test_all_of_a_spec_is_judged(
    built: Callable[..., Path], name: str, changes: tuple[str, ...]
) -> None:
    folder = built(name, *changes)
    report = json.loads((folder / "report.json").read_text(encoding="utf-8"))
    assert report["ok"] and folder.name == Path(name).name
    assert not report["not_judged"]


# Of each way to make parts one machine, each with one number of cores: cams with exact files and tables, stands and bends,
# sheet, cams alone.
SHARED_OUT = [(*AUTOMATON, 2), (*BEAK, 4), (*SHEET, 4), (*ALONE, 2)]


@pytest.mark.long(by="name")
@pytest.mark.parametrize("name, changes, jobs", SHARED_OUT)
def test_same_bytes_with_several_cores(
    built: Callable[..., Path], tmp_path: Path, name: str, changes: tuple[str, ...], jobs: int
) -> None:
    """From processes that made nothing before, and from this one, which made much: what is kept of one part is not another's."""
    command = [
        sys.executable,
        FLAT,
        "build",
        SPECS / f"{name}.toml",
        "-o",
        tmp_path,
        "--jobs",
        str(jobs),
    ]
    subprocess.run(
        [*command, *(word for change in changes for word in ("--set", change))],
        check=True,
        capture_output=True,
    )
    alone = built(name, *changes)
    one, other = (
        {path.name: path.read_bytes() for path in each.iterdir()}
        for each in (alone, tmp_path / alone.name)
    )
    assert [file for file in sorted(one | other) if one.get(file) != other.get(file)] == []


PARTS = """
import sys
from pathlib import Path
from camgen.files.formats import FORMATS
from camgen.machines.sources import read_mechanism
from camgen.pipeline.case import Case
from camgen.progress import silent
from camgen.workers import Workers
from camgen.pipeline.making import make_parts
from camgen.spec import dump
mechanism, folder = read_mechanism(sys.argv[1]).resolved(), Path(sys.argv[2])
(folder / "spec.toml").write_text(dump(mechanism), encoding="utf-8")
with Workers(int(sys.argv[3])) as workers:
    make_parts(Case(mechanism, folder), frozenset(FORMATS), workers, silent)
"""


@pytest.mark.long
def test_same_parts_with_several_cores(tmp_path: Path) -> None:
    made = []
    for jobs in (1, 4):
        folder = tmp_path / str(jobs)
        folder.mkdir()
        spec = SPECS / "gallery" / f"{LARGE}.toml"
        subprocess.run([sys.executable, "-c", PARTS, spec, folder, str(jobs)], check=True)
        made.append({path.name: path.read_bytes() for path in folder.iterdir()})
    alone, other = made
    assert len(alone) > 29 * len(FORMATS)
    assert [file for file in sorted(alone | other) if alone.get(file) != other.get(file)] == []


MINUS_ZERO = re.compile(rb"(?<![\w.+-])-0(?:\.0*)?(?:[eE][-+]?\d+)?(?![\w.])")


def numbers(path: Path) -> bytes:
    """A file's numbers as text, those of binary files too."""
    data = path.read_bytes()
    if path.suffix == ".3mf":
        with zipfile.ZipFile(path) as package:
            return b"".join(package.read(name) for name in package.namelist())
    if path.suffix == ".stl":
        return repr(
            np.frombuffer(data[84:], np.uint8)
            .reshape(-1, 50)[:, :48]
            .copy()
            .view("<f4")
            .ravel()
            .tolist()
        ).encode()
    if path.suffix == ".glb":
        length = int.from_bytes(data[12:16], "little")
        text, packed = data[20 : 20 + length], data[28 + length :]
        scene = json.loads(text)
        views = [
            scene["bufferViews"][each["bufferView"]]
            for each in scene["accessors"]
            if each["componentType"] == 5126
        ]
        floats = [
            np.frombuffer(packed, "<f4", view["byteLength"] // 4, view["byteOffset"]).tolist()
            for view in views
        ]
        return text + repr(floats).encode()
    return data


@pytest.mark.long(by="name")
@pytest.mark.parametrize("name, changes", MADE)
def test_no_file_has_minus_zero(
    built: Callable[..., Path], name: str, changes: tuple[str, ...]
) -> None:
    """Its sign says by which way a 0 was reached, which nobody wants to know."""
    files = list(built(name, *changes).iterdir())
    assert [path.name for path in files if MINUS_ZERO.search(numbers(path))] == []


@pytest.mark.parametrize("text", [b"-0", b"[1,-0.0]", b"x=-0.000", b"-0e+00", b" -0. "])
def test_minus_zero_is_noticed(text: bytes) -> None:
    assert MINUS_ZERO.search(text) and not MINUS_ZERO.search(
        text.replace(b"-", b"-1").replace(b"-10e+", b"-10.5e+")
    )


def end(number: int) -> None:
    os.kill(os.getpid(), number)


def test_a_process_that_is_ended_from_outside_is_told() -> None:
    with pytest.raises(FileError, match="--jobs 1 takes less"), Workers(2) as workers:
        workers.start(end, signal.SIGTERM)()


ORPHANS = """
import os, signal, time
from camgen.workers import Workers
with Workers(2) as workers:
    workers.start(os.getpid)()
    workers.start(time.sleep, 600)
    print("begun", flush=True)
    time.sleep(0.5)
    os.kill(os.getpid(), signal.SIGKILL)
"""


@pytest.mark.skipif(not hasattr(signal, "SIGKILL"), reason="no such signal here")
def test_workers_end_where_their_parent_is_killed() -> None:
    """Each of them holds the pipe's end that they were born with: it closes when the last has ended."""
    with subprocess.Popen(
        [sys.executable, "-c", ORPHANS], stdout=subprocess.PIPE, text=True, start_new_session=True
    ) as parent:
        try:
            assert parent.communicate(timeout=15)[0] == "begun\n"
        finally:
            with suppress(ProcessLookupError):
                os.killpg(parent.pid, signal.SIGKILL)
    assert parent.returncode == -signal.SIGKILL


@pytest.mark.parametrize(
    "changes, kinds, worth", [([], {"stl"}, True), ([], {"dxf"}, False), (CAMS, {"stl"}, False)]
)
def test_more_cores_are_used_where_they_are_worth_it(
    monkeypatch: pytest.MonkeyPatch, changes: list[str], kinds: set[str], worth: bool
) -> None:
    monkeypatch.setattr("camgen.pipeline.case.all_cores", lambda: 6)
    mechanism = read_mechanism(SPECS / "uniform-swing.toml", changes)
    assert cores(None, mechanism, kinds) == (4 if worth else 1)
    assert cores(3, mechanism, kinds) == 3


def test_a_fault_in_a_part_leaves_nothing_behind(tmp_path: Path) -> None:
    with pytest.raises(CamgenError):
        build(
            SPECS / "uniform-swing.toml",
            tmp_path,
            frozenset({"dxf"}),
            ["geometry.swing_deg=179"],
            jobs=2,
        )
    assert list(tmp_path.iterdir()) == []


# What runs only where an output asks for it: (function, kinds of files that ask for it).
STAGES = {
    "camgen.parts.solids.solid": "stl",
    "camgen.files.dxf.write_dxf": "dxf",
    "camgen.files.drawing.write_drawing": "dxf",
    "camgen.judge.budget.error_budget": "report",
    "camgen.report.page.to_html": "report",
    "camgen.pipeline.shown.animation": "report",
    "camgen.files.plates.laid_out": "3mf",
    "camgen.judge.assembly.sweep": "3mf",
}


@pytest.mark.long
@pytest.mark.parametrize("only", ["dxf", "stl", "3mf", "report"])
def test_no_stage_runs_that_no_output_asks_for(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, only: str
) -> None:
    ran: set[str] = set()

    def spied(target: str, function: Callable[..., object]) -> Callable[..., object]:
        def spy(*arguments: object) -> object:
            ran.add(target)
            return function(*arguments)

        return spy

    for target in STAGES:
        module, _, name = target.rpartition(".")
        spy = spied(target, getattr(import_module(module), name))
        monkeypatch.setattr(target, spy)
        for user in (
            "camgen.pipeline.making",
            "camgen.pipeline.judging",
            "camgen.pipeline.reading",
        ):
            if hasattr(import_module(user), name):
                monkeypatch.setattr(f"{user}.{name}", spy)
    whole = only == "3mf"  # all of a small machine
    build(
        SPECS / f"{'eccentric-drive' if whole else 'uniform-swing'}.toml",
        tmp_path,
        frozenset({only}),
        [] if whole else CAMS,
    )
    wanted = {target for target, kind in STAGES.items() if kind == only}
    if only == "3mf":
        wanted |= {"camgen.parts.solids.solid"}
    if only == "report":
        wanted -= {"camgen.judge.budget.error_budget"}  # no part was read, so nothing has an error
    assert ran == wanted


@pytest.mark.parametrize(
    "name", ["disc-cam", "linkage", "uniform-swing", "chain-stitch-looper", "gallery/dial-table"]
)
def test_a_variant_of_a_template_is_the_spec_with_its_keys_set(name: str) -> None:
    """What a variant leaves alone is not checked again; it is the same record, with the same keys given."""
    asked = read_tables(SPECS / f"{name}.toml")
    for settings in (
        ["name=other"],
        ["parts.thickness=7", "print.nozzle=0.5"],
        ["drawing.number=A1"],
        ["parts.thickness=-1"],
    ):
        try:
            alone: object = changed(*asked, ["accuracy.chord_tolerance=0.002", *settings])
        except SpecError as error:
            alone = error.faults
        (made,) = Template(*asked, ["accuracy.chord_tolerance=0.002"]).variants([settings])
        assert (made.faults if isinstance(made, SpecError) else made) == alone
        if isinstance(made, Mechanism) and isinstance(alone, Mechanism):
            assert made.model_dump(exclude_unset=True) == alone.model_dump(exclude_unset=True)


def test_what_a_sheet_decides_is_decided_for_each_variant() -> None:
    data = read_tables(SPECS / "linkage.toml")[0]
    data = data | {"parts": {**data["parts"], "make": "laser"}, "laser": {"thickness": 3.0}}
    (made,) = Template(data, "spec", Path()).variants([["laser.thickness=4"]])
    assert not isinstance(made, Exception) and made.making.thickness == 4.0  # type: ignore[attr-defined]
