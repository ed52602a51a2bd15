"""What the judge has against the files of a build, for tests that damage one: its spec is read once, other files need not be."""

from __future__ import annotations

import hashlib
import tomllib
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from functools import cache, lru_cache
from pathlib import Path

import ezdxf
import numpy as np
import pytest

from camgen.files.formats import FORMATS
from camgen.findings import Finding
from camgen.geometry.rings import Points
from camgen.machines.mechanism import Mechanism
from camgen.machines.sources import read_mechanism
from camgen.pipeline.build import check
from camgen.pipeline.case import Case
from camgen.pipeline.judging import Reading, judge
from camgen.pipeline.reading import Read, judge_part
from camgen.pipeline.scope import Outcome
from camgen.progress import silent
from camgen.report.report import Report
from camgen.workers import Workers


def move_outline(path: Path, change: Callable[[Points], Points]) -> None:
    """Give the longest outline of a DXF other points; its arcs keep their bulges."""
    drawing = ezdxf.readfile(path)
    line = max(drawing.modelspace().query("LWPOLYLINE"), key=len)
    rows = np.array(line.get_points("xyseb"))
    points = change(rows[:, 0] + 1j * rows[:, 1])
    rows[:, :2] = np.column_stack([points.real, points.imag])
    line.set_points(rows.tolist(), "xyseb")
    drawing.saveas(path)


def mechanism_of(folder: Path) -> Mechanism:
    """The mechanism of a build's folder, the same object for all with the same spec."""
    return _read((folder / "spec.toml").read_text(encoding="utf-8"))


@lru_cache(maxsize=4)
def _read(text: str) -> Mechanism:
    found = read_mechanism(tomllib.loads(text))
    found.__dict__ |= {
        "study": cache(found.study),
        "limits": cache(found.limits),
    }  # no file changes them
    return found


@dataclass(frozen=True)
class _Part:
    """A part and its files, the same where their bytes are."""

    spec: str
    name: str
    kinds: tuple[str, ...]
    bytes: str
    case: Case = field(compare=False)


@lru_cache(maxsize=99)
def _judged(part: _Part) -> tuple[Outcome, Read]:
    return judge_part(part.case, part.name, part.kinds)


def _part(case: Case, name: str, kinds: tuple[str, ...]) -> tuple[Outcome, Read]:
    """What `judge_part` says: of files that no damage has touched it is asked once."""
    held = hashlib.sha256()
    files = [case.file(name, kind) for kind in kinds]
    files += [case.file(f"{name}-drawing", "dxf")] if "dxf" in kinds else []
    for path in files:
        held.update(path.read_bytes() if path.exists() else b"none")
    return _judged(
        _Part(
            (case.folder / "spec.toml").read_text(encoding="utf-8"),
            name,
            kinds,
            held.hexdigest(),
            case,
        )
    )


def _parts(case: Case, kinds: Sequence[str], workers: Workers) -> Reading:
    """What `read_parts` says, likewise."""
    formats = tuple(kind for kind in kinds if kind in FORMATS)
    return (_part(case, name, formats) for name in case.parts)


def judged(folder: Path, *kinds: str) -> Report:
    """The report on files of some kinds, "dxf", "stl" or "3mf", as `camgen check` judges them; of none named on all of them.

    Of some kinds without PARTS_LIST: the list in the folder is that of all, such as on which side each solid lies.
    """
    if not kinds:
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr(
                "camgen.pipeline.build.read_mechanism", lambda path: mechanism_of(path.parent)
            )
            patch.setattr("camgen.pipeline.build.read_parts", _parts)
            return check(folder)
    with Workers() as workers:
        case = Case(mechanism_of(folder), folder)
        report = judge(case, kinds, _parts(case, kinds, workers), workers, silent)[0]
    return replace(
        report, findings=[finding for finding in report.findings if finding.code != "PARTS_LIST"]
    )


def wrong(folder: Path, *kinds: str) -> list[Finding]:
    """The findings that fail."""
    return [finding for finding in judged(folder, *kinds).findings if not finding.ok]
