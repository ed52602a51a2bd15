"""Work on several cores.

A task is a plain function of plain arguments. With one core it runs when its result is asked for, with more it runs in
another process; the results are the same, in the same order.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Iterator
from functools import partial
from numbers import Integral
from types import TracebackType
from typing import TYPE_CHECKING, TypeVar

from camgen.errors import Fault, FileError, SpecError

if TYPE_CHECKING:
    from concurrent.futures import Future, ProcessPoolExecutor

T = TypeVar("T")


def all_cores() -> int:
    """How many this process may use."""
    allowed = getattr(os, "sched_getaffinity", None)
    return len(allowed(0)) if allowed else os.cpu_count() or 1


def core_count(jobs: int) -> int:
    """So many cores, 0: all; SpecError where that is no such number."""
    if not isinstance(jobs, Integral) or jobs < 0:
        fault = Fault(("jobs",), repr(jobs), "a whole number of cores, 0: all of them")
        raise SpecError([fault])
    return jobs or all_cores()


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
