"""Sweeps: which variants there are, each judged as by itself, the same table whoever works, and nothing lost by a kill."""

from __future__ import annotations

import csv
import hashlib
import json
import os
import re
import signal
import subprocess
import sys
import time
import tomllib
from collections.abc import Callable
from concurrent.futures import Future
from concurrent.futures.process import BrokenProcessPool
from dataclasses import replace
from importlib.resources import files
from itertools import product
from pathlib import Path
from typing import Any, Self

import pytest
from click.testing import CliRunner
from hypothesis import given
from hypothesis import strategies as st

import camgen
from camgen.cli import cli, main
from camgen.errors import FileError, SpecError
from camgen.machines.sources import read_mechanism
from camgen.pipeline.build import build
from camgen.settings import override
from camgen.starters import unit_at
from camgen.sweep import run as sweeps
from camgen.sweep.journal import Journal
from camgen.sweep.run import Cluster, Processes, Task, here, sweep, task_of
from camgen.sweep.shown import row_lines
from camgen.sweep.variants import variants

SPEC = Path(__file__).resolve().parents[2] / "specs" / "disc-cam.toml"
VARY = ["geometry.base_radius=9:33:7", "segment.0.law=cycloidal,modified-sine"]


def task(*vary: str, **further: object) -> Task:
    return task_of(
        SPEC, variants(vary or VARY), (), ("pressure_angle_deg", "stroke_mm"), (), Path()
    )


def rows(table: Path) -> list[dict[str, str]]:
    with open(table, encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


# ---- which there are -------------------------------------------------------------------------------------------------


@given(st.lists(st.integers(2, 5), min_size=1, max_size=4))
def test_a_grid_has_every_combination_once_the_last_key_fastest(sizes: list[int]) -> None:
    found = variants([f"k{n}=0:{size - 1}:{size}" for n, size in enumerate(sizes)])
    every = [tuple(map(float, found.values(k))) for k in range(found.count)]
    assert every == list(product(*(map(float, range(size)) for size in sizes)))


@given(st.integers(1, 60), st.integers(0, 5))
def test_a_latin_hypercube_has_one_variant_in_each_share(count: int, seed: int) -> None:
    found = variants(["a=0:1", "b=-3:5:2"], latin=count, seed=seed)
    for column, (low, high) in enumerate(((0, 1), (-3, 5))):
        places = sorted(
            int((float(found.values(k)[column]) - low) / (high - low) * count) for k in range(count)
        )
        assert places == list(range(count))


def test_values_side_by_side_and_lists_with_brackets() -> None:
    found = variants(["a=1,2,3", 'b=[1, 2],{x = 1, y = "p,q"},z'], zipped=True)
    assert [found.settings(k) for k in range(found.count)] == [
        ["a=1", "b=[1, 2]"],
        ["a=2", 'b={x = 1, y = "p,q"}'],
        ["a=3", "b=z"],
    ]


def test_a_key_may_be_quoted() -> None:
    found = variants(['lengths."C-B"=40:46:3', "'a.b=c'=1,2"])
    assert [each.key for each in found.axes] == ["lengths.C-B", '"a.b=c"']
    assert override({}, found.settings(0)[0]) == {"lengths": {"C-B": 40.0}} and override(
        {}, found.settings(0)[1]
    ) == {"a.b=c": 1}


def test_ends_of_a_range_are_what_was_typed() -> None:
    found = variants(["a=-0.3:0.1:5"])
    assert [found.values(k)[0] for k in range(5)] == ["-0.3", "-0.2", "-0.1", "0", "0.1"]
    whole = variants(["a=4:8:3"])
    assert [whole.values(k)[0] for k in range(3)] == ["4", "6", "8"]


@pytest.mark.parametrize(
    "vary, further, said",
    [
        (["a"], {}, "KEY=A:B:N"),
        (["a="], {}, "KEY=A:B:N"),
        (["=1,2"], {}, "KEY=A:B:N"),
        (["a=5:2:3"], {}, "A less than B"),
        (["a=2:2:3"], {}, "A less than B"),
        (["a=1:2:1"], {}, "at least 2"),
        (["a=1:2"], {}, "without a number of values"),
        (["a=1,,2"], {}, "between every two commas"),
        (["a=1,1"], {}, "each value once"),
        ([], {}, "at least one"),
        (["a=1,2", "a=3,4"], {}, "given twice"),
        (["a.b=1,2", 'a."b"=3,4'], {}, "given twice"),
        (["a=1,2", "b=1,2,3"], {"zipped": True}, "the same number of values"),
        (["a=1:2"], {"zipped": True, "latin": 5}, "one of the three"),
        (["a=1:1e999:3"], {}, "finite"),
        (["a=nan:3:3"], {}, "finite"),
        (["a=1:b:3"], {}, "finite numbers"),
        (["a=:"], {}, "finite numbers"),
        (["a=1::3"], {}, "finite numbers"),
        (["a=1:2:3.5"], {}, "whole"),
        (["a=12..32"], {}, "such as 12:32:5"),
        (["a=12-32"], {}, "such as 12:32:5"),
        (["a=0.5 to 2"], {}, "such as 0.5:2:5"),
    ],
)
def test_what_is_no_sweep_is_told(vary: list[str], further: dict[str, object], said: str) -> None:
    with pytest.raises(SpecError, match=said):
        variants(vary, **further)  # type: ignore[arg-type]


# ---- each as by itself -----------------------------------------------------------------------------------------------


@pytest.mark.long
def test_each_row_is_what_the_variant_says_by_itself(tmp_path: Path) -> None:
    swept = sweep(task(), tmp_path / "t.csv")
    found = rows(tmp_path / "t.csv")
    assert len(found) == swept.count == 14 and sum(swept.verdicts.values()) == 14
    assert {row["verdict"] for row in found} == {"limits hold", "fails"}
    for row in found:
        own = read_mechanism(
            SPEC, [f"{key}={row[key]}" for key in ("geometry.base_radius", "segment.0.law")]
        )
        assert float(row["pressure_angle_deg"]) == pytest.approx(
            own.study().numbers["pressure_angle_deg"], rel=1e-11
        )
        assert row["fails"].split() == list(
            dict.fromkeys(f.code for f in own.forecast() if not f.ok)
        )
    assert [row["variant"] for row in found] == [str(k) for k in range(14)]
    assert not (tmp_path / "t.csv.journal").exists()


def test_what_cannot_be_made_is_a_row_with_its_reason(tmp_path: Path) -> None:
    sweep(task("geometry.base_radius=-5,20", "parts.bore=8,9"), tmp_path / "t.csv")
    verdicts = [(row["verdict"], row["reason"]) for row in rows(tmp_path / "t.csv")]
    assert [verdict for verdict, _ in verdicts] == ["wrong", "wrong", "limits hold", "limits hold"]
    assert "geometry.base_radius: -5" in verdicts[0][1]
    with pytest.raises(SpecError, match="all 2 variants are wrong, the first: 1 fault") as refused:
        sweep(task("geometry.base_radius=-5,-6"), tmp_path / "w.csv")
    assert "geometry.base_radius: -5 - expected a number >=" in str(refused.value)
    assert not list(tmp_path.glob("w.*")), "nothing is written"
    assert len(camgen.sweep(SPEC, {"geometry.base_radius": [-5, -6]})) == 2, (
        "in Python they are rows"
    )
    spec = SPEC.parent / "uniform-swing.toml"
    steep = task_of(spec, variants(["geometry.swing_deg=20,179"]), (), (), (), Path())
    sweep(steep, tmp_path / "u.csv")
    assert [row["verdict"] for row in rows(tmp_path / "u.csv")] == ["limits hold", "refused"]
    assert "swing" in rows(tmp_path / "u.csv")[1]["reason"]


@pytest.mark.parametrize(
    "key, values, verdicts",
    [
        ("parts.hub_diameter=50", "18,23,28", ["refused", "refused", "limits hold"]),
        (
            "parts.bore=38,parts.hub_height=0",
            "18,19.5,19.9,25",
            ["refused", "fails", "limits hold", "limits hold"],
        ),
    ],
)
def test_bore_and_hub_that_leave_no_wall_are_told_without_files(
    key: str, values: str, verdicts: list[str]
) -> None:
    asked = task_of(
        SPEC, variants([f"geometry.base_radius={values}"]), key.split(","), (), (), Path()
    )
    found = sweeps.rows_of(asked, range(len(verdicts)))
    assert [row["verdict"] for row in found] == verdicts
    assert all(row["fails"] == "MIN_WALL" for row in found if row["verdict"] == "fails")


@pytest.mark.long
def test_built_variants_are_those_of_build(tmp_path: Path) -> None:
    small = ("parts.thickness=4",)
    asked = task_of(
        SPEC, variants(["geometry.base_radius=20,24"]), small, (), ("dxf",), tmp_path / "files"
    )
    sweep(asked, tmp_path / "t.csv")
    for k, row in enumerate(rows(tmp_path / "t.csv")):
        size = f"geometry.base_radius={row['geometry.base_radius']}"
        alone = build(SPEC, tmp_path / "alone", frozenset({"dxf"}), [*small, size])
        assert float(row["motion_error_dxf_mm"]) == pytest.approx(
            alone.numbers["motion_error_dxf_mm"], rel=1e-11
        )
        drawn = [
            folder / "disc-cam" / "disc-cam-cam.dxf"
            for folder in (tmp_path / "files" / f"{k:08d}", tmp_path / "alone")
        ]
        assert drawn[0].read_bytes() == drawn[1].read_bytes()


def test_reasons_beyond_those_told_are_counted_and_the_page_begins_with_the_wish(
    tmp_path: Path,
) -> None:
    text = (SPEC.parent / "linkage.toml").read_text(encoding="utf-8")
    text = text.replace("# stroke = { value = 47.7", "stroke = { value = 47.7")
    (spec := tmp_path / "a.toml").write_text(text, encoding="utf-8")
    lengths = 'lengths."A-B"=1,2,3,4,5,6,60'
    swept = sweep(task_of(spec, variants([lengths]), (), (), (), Path()), tmp_path / "t.csv")
    assert (len(swept.reasons), swept.further) == (5, 1), swept.reasons
    page = (tmp_path / "t.html").read_text(encoding="utf-8")
    data = json.loads(page.partition('id="data">')[2].partition("</script>")[0])
    assert data["wished"] == ["swing_stroke_deg"] and "checked>" not in page


def test_page_and_parquet_hold_the_same(tmp_path: Path) -> None:
    from pyarrow import parquet as arrow

    sweep(task(), tmp_path / "t.csv")
    sweep(task(), tmp_path / "t.parquet")
    table = arrow.read_table(tmp_path / "t.parquet").to_pylist()
    assert [row["pressure_angle_deg"] for row in table] == [
        float(row["pressure_angle_deg"]) for row in rows(tmp_path / "t.csv")
    ]
    page = (tmp_path / "t.html").read_text(encoding="utf-8")
    data = json.loads(page.partition('id="data">')[2].partition("</script>")[0])
    assert (
        len(data["rows"]) == 14
        and data["keys"] == ["geometry.base_radius", "segment.0.law"]
        and "14 variants" in page
    )
    spec = tomllib.loads(SPEC.read_text(encoding="utf-8"))
    assert {key: unit_at(spec, key) for key in (*data["keys"], "segment.0.span_deg")} == {
        "geometry.base_radius": "mm",
        "segment.0.law": "",
        "segment.0.span_deg": "deg",
    }


# ---- the same, whoever works -----------------------------------------------------------------------------------------


def test_processes_write_the_same_bytes(tmp_path: Path) -> None:
    for name, engine, jobs in (("one", here, 1), ("two", Processes(2), 2)):
        sweep(task(), tmp_path / f"{name}.csv", engine, jobs)
    assert (tmp_path / "one.csv").read_bytes() == (tmp_path / "two.csv").read_bytes()


class _BreaksAtTheSecond:
    """A pool in this process that has broken when it is given its second chunk, but for the last of all pools."""

    left = 3

    def __init__(self, *_: object, **__: object) -> None:
        self.given = 0
        type(self).left -= 1

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        pass

    def submit(self, judge: Callable[..., Any], *arguments: Any) -> Future[Any]:
        self.given += 1
        if self.given == 2 and self.left > 0:
            raise BrokenProcessPool
        future: Future[Any] = Future()
        future.set_result(judge(*arguments))
        return future


def test_a_chunk_that_a_broken_pool_does_not_take_is_not_lost(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A pool may break before it is given the next chunk: that one is with no worker yet."""
    monkeypatch.setattr(sweeps, "_CROWDS", ())
    monkeypatch.setattr(_BreaksAtTheSecond, "left", 3)
    monkeypatch.setattr(sweeps, "ProcessPoolExecutor", _BreaksAtTheSecond)
    sweep(task(), tmp_path / "t.csv", Processes(2), 2)
    assert [int(row["variant"]) for row in rows(tmp_path / "t.csv")] == list(range(14))


def die_once(where: Task, numbers: range) -> list[sweeps.Row]:
    """The first worker that comes by dies of it."""
    try:
        os.close(os.open(where.out / "dead", os.O_CREAT | os.O_EXCL))
    except FileExistsError:
        return sweeps.rows_of(where, numbers)
    os.kill(os.getpid(), signal.SIGKILL)
    raise AssertionError


def die_always(where: Task, numbers: range) -> list[sweeps.Row]:
    os.kill(os.getpid(), signal.SIGKILL)
    raise AssertionError


@pytest.mark.long
@pytest.mark.skipif(not hasattr(signal, "SIGKILL"), reason="no such signal on this system")
def test_a_killed_worker_costs_nothing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sweeps, "_CROWDS", ())
    monkeypatch.setattr(sweeps, "_judge_chunk", die_once)
    asked = task_of(SPEC, variants(VARY), (), ("stroke_mm",), (), tmp_path)
    assert sweep(asked, tmp_path / "t.csv", Processes(2), 2).count == 14
    assert (tmp_path / "dead").exists() and [
        int(row["variant"]) for row in rows(tmp_path / "t.csv")
    ] == list(range(14))
    monkeypatch.setattr(sweeps, "_judge_chunk", die_always)
    with pytest.raises(FileError, match="a worker died 3 times at variants"):
        sweep(asked, tmp_path / "u.csv", Processes(2), 2)


@pytest.mark.long
def test_a_cluster_writes_the_same_and_bears_a_killed_worker(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    import distributed

    monkeypatch.setattr(sweeps, "_CROWDS", ())

    many = task("geometry.base_radius=8:32:40")
    sweep(many, tmp_path / "one.csv")
    with distributed.LocalCluster(
        n_workers=2, threads_per_worker=1, dashboard_address=None, local_directory=tmp_path / "dask"
    ) as cluster:
        killed: list[int] = []

        def watched(text: str, done: float | None = None) -> None:
            if not killed:  # a worker that has just begun on the rest
                killed.append(next(iter(cluster.workers.values())).pid)
                os.kill(killed[0], signal.SIGTERM)

        sweep(many, tmp_path / "two.csv", Cluster(cluster.scheduler_address), 2, watched)
    assert killed and (tmp_path / "one.csv").read_bytes() == (tmp_path / "two.csv").read_bytes()


def test_no_scheduler_is_told() -> None:
    began = time.monotonic()
    with pytest.raises(FileError, match="cannot be reached"):
        list(Cluster("tcp://127.0.0.1:9", patience=1.0)(task(), iter([range(1)])))
    assert time.monotonic() - began < 60


# ---- going on --------------------------------------------------------------------------------------------------------


def test_a_sweep_goes_on_where_it_was(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Stopped after some rows, the last of them cut off: no variant is judged twice but that one."""
    monkeypatch.setattr(sweeps, "_CROWDS", ())  # chunks of few
    table, seen = tmp_path / "t.csv", []

    def stopped(work: Task, chunks: object) -> object:
        for k, found in enumerate(here(work, chunks)):  # type: ignore[arg-type]
            if k == 2:
                raise KeyboardInterrupt
            yield found

    with pytest.raises(KeyboardInterrupt):
        sweep(task(), table, stopped)  # type: ignore[arg-type]
    journal = tmp_path / "t.csv.journal"
    kept = journal.read_bytes()
    assert not table.exists() and 2 <= kept.count(b"\n") < 15
    journal.write_bytes(kept[:-9])

    def counted(work: Task, chunks: object) -> object:
        for found in here(work, chunks):  # type: ignore[arg-type]
            seen.extend(row["variant"] for row in found)
            yield found

    swept = sweep(task(), table, counted)  # type: ignore[arg-type]
    assert swept.before == kept.count(b"\n") - 2 and len(seen) == 14 - swept.before
    sweep(task(), tmp_path / "whole.csv")
    assert table.read_bytes() == (tmp_path / "whole.csv").read_bytes()


def test_another_sweep_s_journal_is_left_alone(tmp_path: Path) -> None:
    (tmp_path / "t.csv.journal").write_text("shopping list\n", encoding="utf-8")
    with pytest.raises(FileError, match="another sweep"):
        sweep(task(), tmp_path / "t.csv")
    assert (tmp_path / "t.csv.journal").read_text(encoding="utf-8") == "shopping list\n"


def test_a_full_disk_keeps_what_is_done(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sweeps, "_CROWDS", ())
    add = Journal.add

    def full(self: Journal, found: object) -> None:
        if self.done >= 3:
            self._file.close()
            monkeypatch.setattr(self, "_file", open("/dev/full", "ab", buffering=0))  # noqa: SIM115
        add(self, found)  # type: ignore[arg-type]

    if not Path("/dev/full").exists():
        pytest.skip("no full disk at hand")
    monkeypatch.setattr(Journal, "add", full)
    with pytest.raises(FileError, match="No space left.*goes on from there"):
        sweep(task(), tmp_path / "t.csv")
    monkeypatch.undo()
    assert sweep(task(), tmp_path / "t.csv").before >= 3


# ---- the command -----------------------------------------------------------------------------------------------------


def test_command_writes_the_table_and_says_what_it_came_to(tmp_path: Path) -> None:
    table = tmp_path / "t.csv"
    asked = ["--vary", "geometry.base_radius=9,20", "--keep", "stroke_mm", "-o", str(table)]
    ran = CliRunner().invoke(cli, ["sweep", str(SPEC), *asked])
    assert ran.exit_code == 0, ran.output
    assert "2 variants: 1 holds its limits (no file made), 1 fails." in ran.output
    head, small, large, place = ran.output.splitlines()[1:]
    assert head.split() == ["base_radius,", "mm", "verdict", "stroke_mm", "why"]
    assert small.split() == ["9", "fails", "12", "PRESSURE_ANGLE"]
    assert large.split() == ["20", "limits", "hold", "12"] and str(table) in place
    assert small.index("fails") == head.index("verdict") == large.index("limits")


def test_rows_of_a_sweep_are_told_with_their_reasons_below(tmp_path: Path) -> None:
    """Equal reasons once, wrapped at words and never cut; of many variants the first 20, and how often each reason was."""
    arguments = ["sweep", str(SPEC), "-o", str(tmp_path / "t.csv"), "--vary"]
    few = CliRunner().invoke(cli, [*arguments, "geometry.base_radius=4,5,30"]).output
    rows = few.splitlines()
    assert [row.split()[-1] for row in rows[2:4]] == ["(1)", "(2)"]
    note = few[few.index("(1) parts.bore reaches") :].partition("(2)")[0]
    assert "only 4 mm from it" in " ".join(note.split()) and note.rstrip().endswith("larger")
    assert max(map(len, rows)) <= 120
    many = CliRunner().invoke(cli, [*arguments, "geometry.base_radius=4:30:27"]).output
    assert " x parts.hub_diameter reaches" in many and "... and 7 more\n" in many
    verdicts = ("refused", "fails", "limits")
    assert sum(row.split()[1:2] in [[each] for each in verdicts] for row in many.splitlines()) == 20


def test_what_a_sweep_tells_is_as_wide_as_asked() -> None:
    """Figures give way first, those that say least; what varies comes before what does not."""
    rows = [
        {"variant": k, "a.b": 1.0 + k, "verdict": "fails", "fails": "HERTZ", "reason": ""}
        | {"stroke_mm": 12.0, "pressure_angle_deg": 20.0 + k, "mass_g": 5.0 * k}
        for k in range(2)
    ]
    wide, *_ = row_lines(rows, ["a.b"], width=120)
    assert wide.split() == "b verdict pressure_angle_deg mass_g stroke_mm why".split()
    narrow, *others = row_lines(rows, ["a.b"], width=44)
    assert narrow.split() == "b verdict pressure_angle_deg why".split() and len(narrow) <= 44
    assert all(line.endswith("HERTZ") for line in others)
    assert row_lines(rows, ["a.b"], ["mass_g"], width=9)[0].split()[2] == "mass_g"


def test_command_fails_where_no_variant_holds(tmp_path: Path) -> None:
    asked = [
        "--vary",
        "geometry.base_radius=9,-5",
        "--keep",
        "stroke_mm",
        "-o",
        str(tmp_path / "t.csv"),
    ]
    ran = CliRunner().invoke(cli, ["sweep", str(SPEC), *asked])
    assert ran.exit_code == 1 and (tmp_path / "t.csv").exists(), ran.output
    assert "1 fails, 1 is wrong, no valid spec." in ran.output  # by the words of the table
    told = CliRunner().invoke(cli, ["sweep", "--help"]).output
    assert "some variant holds" in told and "none holds" in told and "every finding" not in told


@pytest.mark.parametrize(
    "arguments, code, said",
    [
        (["--vary", "geometry.base_raduis=1:2:3"], 2, "did you mean 'base_radius'"),
        (["--vary", "segment.9.lift=1,2"], 2, "there is no 9"),
        (
            ["--vary", "geometry.base_radius=20,30", "--keep", "strok_mm"],
            2,
            "did you mean 'stroke_mm'",
        ),
        (
            ["--vary", "geometry.base_radius=1:9:1000000", "--vary", "parts.bore=1:9:1000000"],
            2,
            "1,000,000,000,000 variants",
        ),
        (["--vary", "geometry.base_radius=20,30", "-o", "t.txt"], 2, ".csv or .parquet"),
        (["--vary", "geometry.base_radius=20,30", "--grid", "--zip"], 2, "one of the three"),
        (["--vary", "geometry.base_radius=20,30", "--workers", "here"], 2, "tcp://HOST:PORT"),
    ],
)
def test_bad_input_writes_nothing(
    arguments: list[str],
    code: int,
    said: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    with pytest.raises(SystemExit) as done:
        main(["sweep", str(SPEC), *arguments])
    assert done.value.code == code and said in capsys.readouterr().err
    assert list(tmp_path.iterdir()) == []


# ---- what an enemy does ----------------------------------------------------------------------------------------------


def begun(table: Path, work: Task, number: int) -> Path:
    """The journal of a sweep that was ended when it had one row."""
    path = table.with_name(f"{table.name}.journal")
    journal = Journal(path, work.digest, work.variants.count)
    journal.add(sweeps.rows_of(work, [number]))
    journal.close()
    return path


LINES = ["5", "[]", "null", '{"variant":"x"}', '{"variant":5000}', "[" * 100_000]
LINES.append('{"variant": 0, "verdict": [], "fails": "", "reason": ""}')
LINES += [
    f'{{"variant": {number}, "verdict": "holds", "fails": "", "reason": ""}}'
    for number in ("true", "1.0", "-1", "0e999")
]


@pytest.mark.long
@pytest.mark.parametrize("line", LINES, ids=range(len(LINES)))
@pytest.mark.parametrize("signed", [False, True])
def test_a_line_that_is_no_row_of_this_sweep_is_told_and_passed_over(
    line: str, signed: bool, tmp_path: Path
) -> None:
    """Bare, and behind the digest that it would have as a row."""
    two = task("geometry.base_radius=9,20")
    sweep(two, tmp_path / "whole.csv")
    path = begun(tmp_path / "t.csv", two, 1)
    digest = (
        hashlib.sha256(f"{two.digest} {line}".encode()).hexdigest()[:16] + " " if signed else ""
    )
    head, row = path.read_text(encoding="utf-8").splitlines()
    path.write_text(f"{head}\n{digest}{line}\n{row}\n", encoding="utf-8")
    swept = sweep(two, tmp_path / "t.csv")
    assert (swept.before, swept.strange) == (1, 1)
    assert "1 line of the journal not as this sweep wrote" in "".join(
        swept.lines(tmp_path / "t.csv")
    )
    assert (tmp_path / "t.csv").read_bytes() == (tmp_path / "whole.csv").read_bytes()


@pytest.mark.parametrize(
    "was, now",
    [('"limits hold"', '"fails"'), ('"variant": 1', '"variant": 0'), ("stroke_mm", "strike_mm")],
)
def test_a_row_that_was_edited_is_judged_again(was: str, now: str, tmp_path: Path) -> None:
    two = task("geometry.base_radius=9,20")
    sweep(two, tmp_path / "whole.csv")
    path = begun(tmp_path / "t.csv", two, 1)
    text = path.read_text(encoding="utf-8")
    assert text.count(was) == 1
    path.write_text(text.replace(was, now), encoding="utf-8")
    swept = sweep(two, tmp_path / "t.csv")
    assert (swept.before, swept.strange) == (0, 1)
    assert (tmp_path / "t.csv").read_bytes() == (tmp_path / "whole.csv").read_bytes()


def test_a_row_of_another_sweep_is_judged_again(tmp_path: Path) -> None:
    """The same variant of the same spec but for one key, its lines under this sweep's head."""
    two = task("geometry.base_radius=9,20")
    other = task_of(SPEC, two.variants, ("geometry.offset=2",), two.keep, (), Path())
    head, path = (
        begun(tmp_path / "t.csv", two, 1).read_bytes().splitlines()[0],
        begun(tmp_path / "u.csv", other, 1),
    )
    (tmp_path / "t.csv.journal").write_bytes(
        head + b"\n" + path.read_bytes().splitlines()[1] + b"\n"
    )
    assert sweep(two, tmp_path / "t.csv").strange == 1


def test_a_journal_that_is_changed_on_the_way_is_told(tmp_path: Path) -> None:
    two = task("geometry.base_radius=9,20")

    def meddled(work: Task, chunks: object) -> object:
        path = tmp_path / "t.csv.journal"
        path.write_bytes(path.read_bytes().replace(b'"limits hold"', b'"fails"     '))
        yield from here(work, chunks)  # type: ignore[arg-type]

    with pytest.raises(FileError, match="changed during this run"):
        sweep(two, tmp_path / "t.csv", meddled)  # type: ignore[arg-type]
    assert not (tmp_path / "t.csv").exists()


def test_the_page_runs_nothing_but_its_own_script() -> None:
    """The policy of the report, and nowhere text that becomes elements."""
    pages = [
        files("camgen.report").joinpath(name).read_text(encoding="utf-8")
        for name in ("page.html", "sweep.html")
    ]
    policies = [
        re.findall(r"<meta http-equiv=.Content-Security-Policy.[^>]*>", page) for page in pages
    ]
    assert (
        policies[0] == policies[1]
        and len(policies[0]) == 1
        and "default-src 'none'" in policies[0][0]
    )
    assert not re.search(r"innerHTML|outerHTML|insertAdjacent|document\.write|eval\(", pages[1])


@pytest.mark.long
def test_two_runs_do_not_write_one_table(tmp_path: Path) -> None:
    """Locks hold between processes."""
    code = "import sys; from camgen.cli import main; main(sys.argv[1:])"
    arguments = [
        "sweep",
        str(SPEC),
        "--vary",
        "geometry.base_radius=12:32:40000",
        "-o",
        str(tmp_path / "t.csv"),
    ]
    first = subprocess.Popen(
        [sys.executable, "-c", code, *arguments],
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )
    try:
        while not (tmp_path / "t.csv.journal").exists() and first.poll() is None:
            time.sleep(0.05)
        second = subprocess.run(
            [sys.executable, "-c", code, *arguments], capture_output=True, text=True
        )
    finally:
        first.kill()
        first.wait()
    assert second.returncode == 4 and "another run of camgen writes it" in second.stderr


def test_a_law_s_file_that_was_changed_is_another_sweep(tmp_path: Path) -> None:
    spec = tmp_path / "law.toml"
    table = 'law = { name = "table", file = "law.csv", rest = true }'
    spec.write_text(
        SPEC.read_text(encoding="utf-8").replace('law = "modified-sine"', table), encoding="utf-8"
    )
    digests = []
    for middle in (0.5, 0.45):
        (tmp_path / "law.csv").write_text(
            f"0,0\n0.25,0.15\n0.5,{middle}\n0.75,0.85\n1,1\n", encoding="utf-8"
        )
        digests.append(task_of(spec, variants(VARY[:1]), (), (), (), Path()).digest)
    assert digests[0] != digests[1]


GROOVE = "geometry.closure='groove'"
PAIR = "geometry.closure='conjugate'"
KEYED = "parts.shaft='keyway'"
ARM = "geometry.follower.motion='oscillating'"
WIDE = ("parts.hub_height=0", "limits.lash=3", "limits.pressure_angle_deg=60")


@pytest.mark.long
@pytest.mark.parametrize(
    "settings, vary, fails",
    [
        (
            [PAIR, ARM, "geometry.follower.pivot_distance=60", "geometry.follower.arm=55"],
            "geometry.tip_clearance=0.2,0.05",
            "LASH",
        ),
        ([GROOVE, *WIDE], "parts.rim=4,5", "MIN_WALL"),
        ([GROOVE, *WIDE], "geometry.base_radius=9,12", ""),
        (
            [KEYED, "parts.key_width=2", "parts.key_depth=1", "parts.bore=30", *WIDE],
            "geometry.base_radius=16.5,17",
            "MIN_WALL",
        ),
    ],
)
def test_what_a_sweep_says_of_play_and_walls_is_what_the_files_say(
    settings: list[str], vary: str, fails: str, tmp_path: Path
) -> None:
    """Its arithmetic against the judge of the written parts: the first variant fails, or cannot be made; the second one holds."""
    asked = task_of(SPEC, variants([vary]), settings, (), (), tmp_path)
    told = sweeps.rows_of(asked, range(2))
    (made,) = sweeps.rows_of(replace(asked, build=("dxf",)), range(1))
    assert [row["fails"] for row in told] == [made["fails"], ""] == [fails, ""]
    assert [row["verdict"] for row in told] == [made["verdict"], "limits hold"]
    assert made["verdict"] == ("fails" if fails else "refused")
    if fails == "LASH":  # facets on both sides add their own
        drive = read_mechanism(SPEC, [*settings, "geometry.tip_clearance=0.2"])
        lash = next(finding for finding in drive.forecast() if finding.code == fails)
        assert 0 < 2 * made["clearance_band_dxf_deg"] - lash.measured < 2e-3 * lash.measured


@pytest.mark.long
def test_free_play_of_pins_is_that_of_the_files(tmp_path: Path) -> None:
    drive = read_mechanism(SPEC.parent / "eccentric-drive.toml", ["limits.lash=0.3"])
    (told,) = (finding for finding in drive.forecast() if finding.code == "LASH")
    report = build(drive, tmp_path, frozenset({"dxf"}))
    (made,) = (finding for finding in report.findings if finding.code == "LASH")
    assert (
        not told.ok
        and not made.ok
        and told.measured == pytest.approx(made.measured, rel=1e-3)
        and told.limit == made.limit
    )
