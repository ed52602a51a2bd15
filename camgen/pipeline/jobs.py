"""Work on several cores, and what it is told to: one mechanism in one folder.

A task is a plain function of plain arguments. With one core it runs when its result is asked for, with more it runs in
another process; the results are the same, in the same order.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import cached_property, lru_cache, partial, reduce
from os import PathLike
from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING, Any, Protocol, TypeVar

from camgen import reading
from camgen import spec as specs
from camgen.errors import CamgenError, DesignError, Fault, FileError, SpecError
from camgen.files.formats import FORMATS
from camgen.machines import MECHANISMS, load
from camgen.machines.mechanism import Mechanism
from camgen.motion.tables import with_tables
from camgen.parts.part import Part
from camgen.settings import override

if TYPE_CHECKING:
    from concurrent.futures import Future, ProcessPoolExecutor

T = TypeVar("T")
_FEW = 3  # parts that are made sooner than other processes have begun
_MOST = 4  # cores that one machine's parts and the sweep of them keep busy


class Progress(Protocol):
    """Is told what is being made, and which share (0..1) of the whole is done where that is known."""

    def __call__(self, text: str, done: float | None = None, /) -> None:
        """Tell it; a text that begins with "note: " is for people to keep."""


def silent(text: str, done: float | None = None) -> None:
    """Progress that nobody watches."""


Source = str | PathLike[str] | Mapping[str, Any] | Mechanism


def read_mechanism(spec: Source, overrides: Sequence[str] = ()) -> Mechanism:
    """The mechanism that a spec describes, a file or its tables; SpecError with all faults, FileError where it cannot be read.

    A mechanism is given back as it is.
    """
    if isinstance(spec, Mechanism):
        return spec
    return changed(*read_tables(spec), overrides)


def read_tables(spec: Source) -> tuple[reading.Data, str, Path]:
    """The tables of a spec with those of the specs that it includes, what it is called in errors, and its folder."""
    assert not isinstance(spec, Mechanism), "has no tables of its own"
    if isinstance(spec, Mapping):
        data, source, folder = reading.tables(spec), "spec", Path()
    else:
        data, source, folder = reading.read(Path(spec)), str(spec), Path(spec).parent
    if "include" in data:
        from camgen.machines.included import opened

        data = opened(data, folder)
    return data, source, folder


def files_of(spec: Path) -> list[Path]:
    """A spec's file, those that it names, and those that included specs name, whether they are there or not; of what is no spec
    itself alone."""
    named = _named_in(spec)
    included = [file for kind, file in named if kind == "spec"]  # which include none
    theirs = [file for other in included for kind, file in _named_in(other) if kind != "spec"]
    return [spec, *(file for _, file in named), *theirs]


def _named_in(spec: Path) -> list[tuple[str, Path]]:
    """What each file that a spec names holds, and where it is; nothing of what is no spec."""
    found = list[tuple[str, Path]]()
    with suppress(CamgenError):
        for each in reading.references(reading.read(spec)):
            with suppress(SpecError):
                found.append((each.kind, each.file(spec.parent)))
    return found


def changed(
    data: reading.Data,
    source: str,
    folder: Path,
    overrides: Sequence[str] = (),
    like: tuple[reading.Data, specs.Spec] | None = None,
) -> Mechanism:
    """The mechanism of some tables with some keys set anew; like: see `validate`."""
    for setting in overrides:
        data = override(data, setting)
    left = [each for each in reading.references(data) if each.kind != "spec" and each.outside]
    hints = tuple(
        f"{each.path} was read from {each.name}, outside the spec's folder" for each in left
    )
    data = with_tables(data, folder, source)
    made = specs.validate(load(specs.choose(data, MECHANISMS, source)), data, source, hints, like)
    if (
        made.load is not None and made.load.on
    ):  # that they are on what is there; a design that does not exist is told later
        with suppress(DesignError):
            made.model  # noqa: B018
    return made


@dataclass(frozen=True)
class Template:
    """Tables of a spec, its source and folder, and settings of all its variants: what a variant leaves alone is read once."""

    data: reading.Data
    source: str
    folder: Path
    settings: Sequence[str] = ()

    @cached_property
    def _tables(self) -> reading.Data:
        return reduce(override, self.settings, self.data)

    @cached_property
    def _like(self) -> tuple[reading.Data, specs.Spec] | None:
        try:
            return self._tables, changed(self._tables, self.source, self.folder)
        except CamgenError:
            return None

    def variants(self, several: Iterable[Sequence[str]]) -> list[Mechanism | CamgenError]:
        """The mechanism of each list of settings, or why there is none; those of one kind find together what they need."""
        made: list[Mechanism | CamgenError] = []
        for each in several:
            try:
                made.append(changed(self._tables, self.source, self.folder, each, self._like))
            except (DesignError, SpecError) as error:
                made.append(error)
        return made


def prepare(made: Iterable[object]) -> None:
    """Let mechanisms of one kind find together what each of them needs; what is no mechanism is passed over."""
    alike: dict[type[Mechanism], list[Mechanism]] = {}
    for each in made:
        if isinstance(each, Mechanism):
            alike.setdefault(type(each), []).append(each)
    for kind, several in alike.items():
        kind.prepare(several)


@dataclass(frozen=True)
class Case:
    """A mechanism and the folder of its files, `spec.toml` among them; another process reads it anew from there."""

    mechanism: Mechanism
    folder: Path

    @cached_property
    def parts(self) -> dict[str, Part]:
        """The mechanism's parts by name."""
        return {part.name: part for part in self.mechanism.assembly.parts}

    def file(self, part: str, ending: str) -> Path:
        """Path of a part's file."""
        return self.folder / f"{self.mechanism.name}-{part}.{ending}"

    def __reduce__(self) -> tuple[Callable[[Path], Case], tuple[Path]]:
        return _reopened, (self.folder,)


@lru_cache(maxsize=1)
def _reopened(folder: Path) -> Case:
    return Case(read_mechanism(folder / "spec.toml"), folder)


def cores(jobs: int | None, mechanism: Mechanism, kinds: Collection[str]) -> int:
    """How many to use: as many as somebody says, 0: all, else one unless there are several solids, which two make in less time.

    SpecError where what is said is no such number.
    """
    if jobs is not None:
        if not isinstance(jobs, int) or jobs < 0:
            raise SpecError([Fault("jobs", repr(jobs), "a whole number of cores, 0: all of them")])
        return jobs or all_cores()
    several = len(mechanism.assembly.parts) > _FEW and any(
        kind in FORMATS and FORMATS[kind].solid for kind in kinds
    )
    return min(all_cores(), _MOST) if several else 1


def all_cores() -> int:
    """How many this process may use."""
    allowed = getattr(os, "sched_getaffinity", None)
    return len(allowed(0)) if allowed else os.cpu_count() or 1


class Workers:
    """`with Workers(jobs) as workers:` does tasks on as many cores; on an exception what has not begun is dropped."""

    def __init__(self, jobs: int = 1) -> None:
        self._pool: ProcessPoolExecutor | None = None
        if jobs > 1:
            from concurrent.futures import ProcessPoolExecutor

            self._pool = ProcessPoolExecutor(jobs, initializer=_left_to_the_parent)

    def start(self, task: Callable[..., T], *arguments: object) -> Callable[[], T]:
        """Begin a task; what is returned gives its result, or raises what it raised."""
        if self._pool is None:
            return partial(task, *arguments)
        future: Future[T] = self._pool.submit(task, *arguments)
        return future.result

    def map(self, task: Callable[..., T], *columns: Iterable[object]) -> Iterator[T]:
        """The task's results on each row of arguments, in their order."""
        started = [self.start(task, *row) for row in zip(*columns, strict=True)]
        return (result() for result in started)

    def __enter__(self) -> Workers:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        if self._pool is None:
            return
        from concurrent.futures import BrokenExecutor

        self._pool.shutdown(cancel_futures=error is not None)
        if isinstance(error, BrokenExecutor):
            said = "was ended from outside, as where memory runs out; --jobs 1 takes less"
            raise FileError("a process of this run", said) from None


def end_with_parent() -> None:
    """Let this process end as soon as the one that began it is gone, killed ones too: whatever it makes, nobody waits for."""
    from multiprocessing import parent_process
    from multiprocessing.connection import wait
    from threading import Thread

    if (parent := parent_process()) is not None:
        watched = parent.sentinel

        def watch() -> None:
            wait([watched])
            os._exit(1)

        Thread(target=watch, daemon=True).start()


def _left_to_the_parent() -> None:
    """Ctrl-C and a request to end reach the parent, which ends its workers; without it they end by themselves."""
    import signal

    end_with_parent()
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.signal(signal.SIGTERM, signal.SIG_DFL)
