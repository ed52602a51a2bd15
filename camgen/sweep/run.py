"""Many variants of one spec, each judged, as rows of one table; what is done survives a kill.

journal   a file beside the table, with the rows that are done
chunk     numbers of some variants, growing, the task of one worker: pure, so that it may run twice
engine    runs chunks: here, in processes of this machine, or on a Dask cluster; rows are written here alone
"""

from __future__ import annotations

import hashlib
import math
import re
import time
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import FIRST_COMPLETED, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from itertools import islice
from pathlib import Path
from typing import Any

import numpy as np

from camgen._version import __version__
from camgen.errors import (
    COMMAND_LINE,
    CamgenError,
    DesignError,
    Fault,
    FileError,
    SpecError,
    counted,
    dotted,
    wrapped,
)
from camgen.extras import install_line
from camgen.findings import Finding
from camgen.machines.mechanism import Mechanism
from camgen.machines.sources import Source, Template, changed, prepare, read_tables
from camgen.machines.spec_files import with_tables
from camgen.progress import Progress, silent
from camgen.report.sweep_page import SweepPage, shown_step, write_page
from camgen.spec import unknown
from camgen.study import Figure, Figures
from camgen.sweep.journal import Journal
from camgen.sweep.shown import WIDE, row_lines
from camgen.sweep.tables import Row, writer_of
from camgen.sweep.variants import Variants
from camgen.workers import end_with_parent

MOST = 10_000_000  # variants of a sweep; its memory is 8 bytes a variant, and a row of a few hundred in the journal
_CHUNK = 0.5  # s of work in a chunk, so that handing it out costs little
_LARGEST = 2_000  # variants in a chunk
_CROWDS = (8, 64, 512)  # variants that are tried together, to see what each takes
_TRIES = 3  # of a chunk whose worker dies

# LIMITS: no file was made
HOLDS = "holds"
LIMITS = "limits hold"
FAILS = "fails"
REFUSED = "refused"
WRONG = "wrong"
_WORDS = {  # of one variant, and of several
    HOLDS: ("holds", "hold"),
    LIMITS: ("holds its limits (no file made)", "hold their limits (no file made)"),
    FAILS: ("fails", "fail"),
    REFUSED: ("is refused, cannot be made", "are refused, cannot be made"),
    WRONG: ("is wrong, no valid spec", "are wrong, no valid specs"),
}
_REASONS = 5  # that are told, the most frequent
_SHOWN = 20  # rows that are told


Chunk = Sequence[int]


@dataclass(frozen=True)
class Task:
    """What every worker needs."""

    data: Mapping[str, Any]  # tables of the spec
    source: str
    folder: Path
    variants: Variants
    settings: tuple[str, ...] = ()  # as of `--set`, for all variants
    keep: tuple[str, ...] = ()  # names of the figures of a row; empty: all
    build: tuple[
        str, ...
    ] = ()  # kinds of files of each variant; none: closed-form limits and figures
    out: Path = Path()  # above the folders of those files

    @property
    def digest(self) -> str:
        """What the rows follow from, as a short text."""
        data = with_tables(
            dict(self.data), self.folder
        )  # what is in the files of laws, not their names alone
        inputs = [__version__, data, self.variants, self.settings, self.keep, self.build]
        return hashlib.sha256(repr(inputs).encode()).hexdigest()[:16]


def rows_of(task: Task, numbers: Chunk) -> list[Row]:
    """A row of each variant: its keys, verdict, codes that fail, reason of refusal, and figures (None where one is no number)."""
    values = [task.variants.values(number) for number in numbers]
    template = Template(dict(task.data), task.source, task.folder, task.settings)
    mechanisms = template.variants(map(task.variants.set_to, values))
    if not task.build:
        prepare(mechanisms)
    return [_row(task, *each) for each in zip(numbers, values, mechanisms, strict=True)]


def _row(task: Task, number: int, values: Sequence[str], mechanism: Mechanism | CamgenError) -> Row:
    row: Row = {"variant": number}
    for each, value in zip(task.variants.axes, values, strict=True):
        row[each.key] = _plain(value)
    try:
        if isinstance(mechanism, CamgenError):
            raise mechanism
        if task.build:
            from camgen.pipeline.build import build

            report = build(mechanism, task.out / f"{number:08d}", frozenset(task.build))
            findings = report.findings
            numbers = report.numbers
        else:
            findings, numbers = _foreseen(mechanism)
    except SpecError as error:
        return row | {"verdict": WRONG, "fails": "", "reason": "; ".join(map(str, error.faults))}
    except DesignError as error:
        return row | {"verdict": REFUSED, "fails": "", "reason": str(error)}
    failing = list(dict.fromkeys(finding.code for finding in findings if not finding.ok))
    row |= {
        "verdict": FAILS if failing else HOLDS if task.build else LIMITS,
        "fails": " ".join(failing),
        "reason": "",
    }
    return row | {name: _figure(numbers.get(name, math.nan)) for name in task.keep or numbers}


def _foreseen(mechanism: Mechanism) -> tuple[Sequence[Finding], Figures]:
    """What is known without files: findings and figures, with the least transmission angle and the play of each output."""
    findings = mechanism.forecast()
    numbers = mechanism.study().numbers
    angles = [each for each in findings if each.code == "TRANSMISSION_ANGLE"]
    if angles:
        least = min(angles, key=lambda each: each.measured)
        numbers |= [Figure("transmission angle", least.measured, least.unit)]
    numbers |= [
        Figure("play {of}", each.measured, each.unit, each.where.output or each.where.thing)
        for each in findings
        if each.code == "LASH"
    ]
    return findings, numbers


def _plain(value: str) -> Any:
    """A value of `--set` as a number where it is one."""
    try:
        return float(value) if math.isfinite(float(value)) else value
    except ValueError:
        return value.strip("\"'")


def _figure(value: float) -> float | None:
    return float(f"{value:z.12g}") if math.isfinite(value) else None


def _judge_chunk(task: Task, numbers: Chunk) -> list[Row]:
    """What a worker does."""
    return rows_of(task, numbers)


# ---- engines ---------------------------------------------------------------------------------------------------------

Engine = Callable[[Task, Iterator[Chunk]], Iterator[list[Row]]]


def here(task: Task, chunks: Iterator[Chunk]) -> Iterator[list[Row]]:
    """One chunk after the other."""
    for chunk in chunks:
        yield _judge_chunk(task, chunk)


@dataclass
class Processes:
    """Chunks shared out to processes of this machine; those of a worker that dies are run again, so none is lost."""

    jobs: int
    _tries: Counter[int] = field(default_factory=Counter)

    def __call__(self, task: Task, chunks: Iterator[Chunk]) -> Iterator[list[Row]]:
        """Rows as they are ready; FileError where a chunk's worker dies again and again."""
        waiting: list[Chunk] = []  # for a pool that takes them: one that is broken takes none
        while True:
            pending: dict[Any, Chunk] = {}
            with ProcessPoolExecutor(self.jobs, initializer=end_with_parent) as pool:
                try:
                    while True:
                        while len(pending) < 2 * self.jobs:
                            waiting = waiting or [*islice(chunks, 1)]
                            if not waiting:
                                break
                            future = pool.submit(_judge_chunk, task, waiting[-1])
                            pending[future] = waiting.pop()
                        if not pending:
                            return
                        for future in wait(pending, return_when=FIRST_COMPLETED).done:
                            rows = future.result()
                            del pending[future]
                            yield rows
                except BrokenProcessPool:
                    waiting += pending.values()
                except BaseException:
                    pool.shutdown(cancel_futures=True)
                    raise
            for chunk in pending.values():
                self._tries[chunk[0]] += 1
                if self._tries[chunk[0]] >= _TRIES:
                    message = f"a worker died {_TRIES} times at variants {chunk[0]} to {chunk[-1]}"
                    raise FileError(task.source, f"{message}; fewer --jobs need less memory")


@dataclass(frozen=True)
class Cluster:
    """Chunks shared out by a Dask scheduler, tcp://host:port; what a lost worker had is run again by another."""

    address: str
    patience: float = 10.0  # s, for the scheduler to answer

    def __post_init__(self) -> None:
        if not re.fullmatch(r"\w+://.+:\d+", self.address):
            fault = Fault(
                (),
                repr(self.address),
                "local, or tcp://HOST:PORT of a Dask scheduler",
                source="--workers",
            )
            raise SpecError([fault], COMMAND_LINE)

    def __call__(self, task: Task, chunks: Iterator[Chunk]) -> Iterator[list[Row]]:
        """Rows as they are ready; FileError where there is no scheduler, or it is lost."""
        try:
            import distributed
        except ImportError:
            raise FileError(self.address, f"needs Dask: {install_line('cluster')}") from None
        cluster: Any = distributed  # without types
        try:
            with cluster.Client(self.address, timeout=self.patience) as client:
                handle = client.scatter(task, broadcast=True)

                def submit(chunk: Chunk) -> Any:
                    return client.submit(
                        _judge_chunk,
                        handle,
                        chunk,
                        key=f"camgen-{task.digest}-{chunk[0]}-{chunk[-1]}",
                    )

                most = 4 * max(sum(client.nthreads().values()), 1)
                running = cluster.as_completed([submit(chunk) for chunk in islice(chunks, most)])
                for future in running:
                    yield future.result()
                    for chunk in islice(chunks, 1):
                        running.add(submit(chunk))
        except CamgenError:
            raise
        except Exception as error:
            why = str(error).partition("\n")[0] or type(error).__name__
            message = f"the scheduler cannot be reached or is lost, what is done is kept: {why}"
            raise FileError(self.address, message) from None


# ---- the whole -------------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class SweepResult:
    """What a sweep came to."""

    count: int  # of variants
    verdicts: Mapping[str, int]  # how many have each
    reasons: Sequence[tuple[str, int]]  # the most frequent, and how often
    further: int  # how many other reasons there are
    seconds: float
    before: int  # rows that the journal had
    columns: Sequence[str]
    strange: int = 0  # lines of the journal that were not as this sweep wrote them
    first: Sequence[Row] = ()  # rows of the first variants
    keys: Sequence[str] = ()  # that were varied
    keep: Sequence[str] = ()  # figures that were chosen

    @property
    def summary(self) -> str:
        """The verdicts in a sentence: the same for the same sweep."""
        parts = [
            f"{count} {one if count == 1 else several}"
            for name, (one, several) in _WORDS.items()
            if (count := self.verdicts.get(name))
        ]
        return f"{self.count} variant{'s' if self.count > 1 else ''}: {', '.join(parts)}."

    def lines(
        self, table: Path, width: int = WIDE, unit: Callable[[str], str] = lambda key: ""
    ) -> list[str]:
        """What a person is told at the end: the rows, of many the first ones and the reasons; width: in letters, unit: of a key."""
        more = f"  and {self.further} more reason{'s' if self.further > 1 else ''}, in the table"
        again = f", {self.before} of them done before" if self.before else ""
        done = f"{self.count} row{'s' if self.count > 1 else ''}{again}"
        place = (
            f"{done}, {self.seconds:.1f} s: {table} and {table.with_suffix('.html').name} beside it"
        )
        anew = f"{counted(self.strange, 'line')} of the journal not as this sweep wrote them: those variants are judged again"
        reasons = [
            line
            for reason, n in self.reasons
            for line in wrapped(f"  {n} x {reason}", width).splitlines()
        ]
        reasons += [more] if self.further else []
        others = self.count - len(self.first)
        rows = [row | {"reason": ""} for row in self.first] if others else self.first
        return [
            self.summary,
            *(reasons if others else []),
            *row_lines(rows, self.keys, self.keep, width, unit, others),
            *([anew] if self.strange else []),
            place,
        ]


def sweep(
    task: Task,
    table: Path,
    engine: Engine = here,
    jobs: int = 1,
    progress: Progress = silent,
    unit: Callable[[str], str] = lambda key: "",
) -> SweepResult:
    """Judge all variants that the journal does not have yet, then write the table and take the journal away.

    table: ends in .csv or .parquet. unit: of a key, for the page.
    SpecError for a key that no spec has, too many variants (with the time they would take), or where no variant is a valid
    spec: then nothing is written.
    """
    write = writer_of(table)
    journal = table.with_name(table.name + ".journal")
    with judged(task, journal, engine, jobs, progress) as (result, rows):
        if result.verdicts.keys() == {WRONG}:
            source = f"{task.source}: all {result.count} variants are wrong, the first"
            raise SpecError(_as_varied(task, _faults_of_first(task)), source)
        write(table, result.columns, rows())
        keys = [axis.key for axis in task.variants.axes]
        page = SweepPage(
            f"Sweep of {Path(task.source).stem}",
            result.summary,
            result.columns,
            keys,
            _wish_columns(task.data, result.columns),
            units={key: unit(key) for key in keys},
        )
        count = result.count
        result = replace(result, first=list(islice(rows(), _SHOWN)), keys=keys, keep=task.keep)
        write_page(table.with_suffix(".html"), page, rows(shown_step(count)), count)
    return result


Rows = Callable[..., Iterator[Row]]


@contextmanager
def judged(
    task: Task,
    path: Path,
    engine: Engine = here,
    jobs: int = 1,
    progress: Progress = silent,
) -> Iterator[tuple[SweepResult, Rows]]:
    """What all variants came to, and their rows, all or every so many; the journal, a file, goes away unless that fails."""
    count = task.variants.count
    began = time.perf_counter()
    first, each = _pace(task)
    if count > MOST:
        words = task.variants.words
        cores = "one core" if jobs < 2 else f"{jobs} cores"
        took = f"at {1e3 * each:.2g} ms each they would take {_span(count * each / max(jobs, 1))} on {cores}"
        most = f"at most {MOST:,}, for {took}; fewer values, or {words.fewer}"
        raise SpecError([words.refused("", f"{count:,} variants", most)], COMMAND_LINE)
    journal = Journal(path, task.digest, count)
    try:
        before = journal.done
        journal.add(first)
        size = int(
            min(max(_CHUNK / max(each, 1e-6), 1), _LARGEST, max(count / (4 * max(jobs, 1)), 1))
        )
        done = journal.done
        start = time.perf_counter()
        for rows in engine(task, _missing(journal.places, size)):
            journal.add(rows)
            done += len(rows)
            rest = (time.perf_counter() - start) * (count - done) / max(done - before, 1)
            progress(f"{done} of {count} variants, {_span(rest)} to go", done / count)
        verdicts = Counter[str]()
        reasons = Counter[str]()
        columns = dict[str, None]()
        for row in journal.rows():
            verdicts[row["verdict"]] += 1
            reasons[row["fails"] or row["reason"].partition("\n")[0]] += 1
            columns |= dict.fromkeys(row)
        del reasons[""]
        result = SweepResult(
            count,
            dict(verdicts),
            reasons.most_common(_REASONS),
            max(len(reasons) - _REASONS, 0),
            time.perf_counter() - began,
            before,
            list(columns),
            journal.strange,
        )
        yield result, journal.rows
    except SpecError:  # of a sweep that is refused nothing stays
        journal.close()
        journal.path.unlink()
        raise
    finally:
        journal.close()
    journal.path.unlink()


def _pace(task: Task) -> tuple[list[Row], float]:
    """The first rows, and what each one takes, s of the processor: where several at once are quicker, in such a crowd."""
    rows = list[Row]()
    each = math.inf
    for many in (1, *(() if task.build else _CROWDS)):
        began = time.process_time()  # whatever else this machine does
        count = min(many, task.variants.count)
        rows = rows_of(
            task, [k * task.variants.count // count for k in range(count)]
        )  # from all of the sweep
        took = (time.process_time() - began) / len(rows)
        if many == 1:
            _refuse_unknown(task, rows[0])
        quicker = took < 0.7 * each
        each = min(each, took)
        if not quicker:
            break
    return rows, each


def _refuse_unknown(task: Task, first: Row) -> None:
    """SpecError for keys that no spec has, and for figures that the first variant has not."""
    if first["verdict"] == WRONG:
        faults = [f for f in _faults_of_first(task) if f.unknown or f.source == "--set"]
        if faults:
            raise SpecError(_as_varied(task, faults), task.source)
    elif first["verdict"] != REFUSED:
        machine = _first(task)
        figures = machine.study().numbers if task.build else _foreseen(machine)[1]
        faults = [
            replace(unknown((), name, figures), source="--keep")
            for name in task.keep
            if name not in figures
        ]
        if faults:
            raise SpecError(faults, COMMAND_LINE)


def _first(task: Task) -> Mechanism:
    """The first variant; SpecError where it is no valid spec."""
    settings = [*task.settings, *task.variants.settings(0)]
    return changed(dict(task.data), task.source, task.folder, settings)


def _faults_of_first(task: Task) -> Sequence[Fault]:
    """What is wrong in the first variant."""
    try:
        _first(task)
    except SpecError as error:
        return error.faults
    return ()


def _as_varied(task: Task, faults: Sequence[Fault]) -> list[Fault]:
    """Faults of --set, those of keys that are varied by the name of their option."""
    varied = {each.key for each in task.variants.axes}
    source = task.variants.words.key.format(key="").strip()
    return [
        replace(f, source=source) if f.source == "--set" and dotted(f.path) in varied else f
        for f in faults
    ]


def _wish_columns(data: Mapping[str, Any], columns: Sequence[str]) -> list[str]:
    """Figures of a wish: a key of [wanted], or a table of an [[output]] such as stroke, by its name and the output's."""
    wish = data.get("wanted")
    outputs = data.get("output")
    keys = [(key,) for key in wish] if isinstance(wish, Mapping) else []
    tables = (
        [each for each in outputs if isinstance(each, Mapping)] if isinstance(outputs, list) else []
    )
    patterns = [
        *keys,
        *(
            (str(t.get("name", "")), key)
            for t in tables
            for key, value in t.items()
            if isinstance(value, Mapping)
        ),
    ]
    return [
        column
        for column in columns
        if any(all(word in column for word in words) for words in patterns)
    ]


def _missing(places: np.ndarray, size: int) -> Iterator[Chunk]:
    """Chunks of the variants that have no row yet."""
    missing = np.flatnonzero(places < 0)
    for low in range(0, len(missing), size):
        yield missing[low : low + size].tolist()


def _span(seconds: float) -> str:
    day = 86400
    units = (
        ("s", 1, 120),
        ("min", 60, 7200),
        ("h", 3600, 3 * day),
        ("days", day, 730 * day),
        ("years", 365 * day, math.inf),
    )
    unit, size = next((unit, size) for unit, size, most in units if seconds < most)
    return f"{seconds / size:,.0f} {unit}"


def task_of(
    spec: Source,
    variants: Variants,
    settings: Sequence[str],
    keep: Sequence[str],
    build: Sequence[str],
    out: Path,
) -> Task:
    """The task of a spec."""
    data, source, folder = read_tables(spec)
    return Task(
        data, source, folder.absolute(), variants, tuple(settings), tuple(keep), tuple(build), out
    )
