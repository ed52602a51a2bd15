"""What the judge has against the files of a build, for tests that damage one: its spec is read once, other files need not be."""

from __future__ import annotations

import tomllib
from functools import cache, lru_cache
from pathlib import Path

from camgen.findings import Finding
from camgen.machines.mechanism import Mechanism
from camgen.pipeline.build import check
from camgen.pipeline.jobs import Case, Workers, read_mechanism, silent
from camgen.pipeline.judging import judge, read_parts
from camgen.report.report import Report


def mechanism_of(folder: Path) -> Mechanism:
    """The mechanism of a build's folder, the same object for all with the same spec."""
    return _read((folder / "spec.toml").read_text(encoding="utf-8"))


@lru_cache(maxsize=4)
def _read(text: str) -> Mechanism:
    found = read_mechanism(tomllib.loads(text))
    found.__dict__ |= {"study": cache(found.study), "limits": cache(found.limits)}  # no file changes them
    return found


def judged(folder: Path, *kinds: str) -> Report:
    """The report on files of some kinds, "dxf", "stl" or "3mf", as `camgen check` judges them; of none named on all of them."""
    if not kinds:
        return check(folder)
    with Workers() as workers:
        case = Case(mechanism_of(folder), folder)
        return judge(case, kinds, read_parts(case, kinds, workers), workers, silent, "is in the folder")[0]


def wrong(folder: Path, *kinds: str) -> list[Finding]:
    """The findings that fail."""
    return [finding for finding in judged(folder, *kinds).findings if not finding.ok]
