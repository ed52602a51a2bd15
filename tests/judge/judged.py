"""What the judge has against the files of a build, for tests that damage one: its spec is read once, what no damage touches is
judged once."""

from __future__ import annotations

import hashlib
import math
import shutil
import tomllib
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace
from functools import cache, lru_cache, partial
from pathlib import Path
from typing import Any

import ezdxf
import numpy as np
import pytest
from kept import Kept

import camgen
from camgen.files.formats import FORMATS
from camgen.findings import Finding
from camgen.geometry.rings import Points
from camgen.machines.mechanism import Mechanism
from camgen.machines.sources import read_mechanism
from camgen.pipeline.build import check
from camgen.pipeline.case import Case
from camgen.pipeline.judging import Reading, judge
from camgen.pipeline.judging import _stages as stages_of
from camgen.pipeline.reading import Read, budget_of, judge_motion, judge_part, moved_by
from camgen.pipeline.scope import Outcome, Stage
from camgen.pipeline.summary import draw_part
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


def drawn(spec: Mapping[str, Any], to: Path, kinds: Sequence[str] = ("dxf",)) -> Path:
    """The folder of a sound build, drawings alone unless other kinds are said."""
    report = camgen.build(spec, to, kinds)
    assert report.ok, [str(finding) for finding in report.findings if not finding.ok]
    return to / str(spec["name"])


def moved_copy(folder: Path, to: Path, file: str, change: Callable[[Points], Points]) -> Path:
    """A copy of a build with other points of the longest outline in one file."""
    copy = Path(shutil.copytree(folder, to / folder.name))
    move_outline(copy / file, change)
    return copy


def motion_findings(folder: Path, count: int, kind: str = "dxf") -> list[Finding]:
    """What the judge says of the motion that the folder's files of a kind give, at so many angles."""
    case = Case(read_mechanism(folder / "spec.toml"), folder)
    parts = {name: judge_part(case, name, [kind], dimensioned=False)[1] for name in case.parts}
    result = judge_motion(case.mechanism, kind, parts, np.linspace(0, math.tau, count))
    assert result is not None
    return list(result[0].findings)


def by_code(folder: Path) -> dict[str, Finding]:
    """The same at 721 angles of the drawings, by code; of several of one code the last."""
    return {each.code: each for each in motion_findings(folder, 721)}


def damaged(
    folder: Path, to: Path, file: str, change: Callable[[Points], Points]
) -> dict[str, Finding]:
    """The same of a copy with other points of the outline in one file."""
    return by_code(moved_copy(folder, to, file, change))


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


_KEPT = Kept(400)
# What no stage of the judge reads: it is made anew and compared.
_COMPARED = {"report.html", "report.json", "motion.csv", "manifest.json"}


def forget() -> None:
    """Judge anew: for a test that changes the judge itself."""
    _KEPT.forget()


def _spec(case: Case) -> str:
    return (case.folder / "spec.toml").read_text(encoding="utf-8")


def _bytes(paths: Iterable[Path]) -> str:
    """A hash of files, by their names, and of all files in folders."""
    held = hashlib.sha256()
    for path in paths:
        for each in sorted(path.rglob("*")) if path.is_dir() else [path]:
            data = each.read_bytes() if each.is_file() else b"none"
            held.update(f"{each.name} {len(data)} ".encode() + data)
    return held.hexdigest()


def _part(case: Case, name: str, kinds: tuple[str, ...]) -> tuple[Outcome, Read]:
    """What `judge_part` says: of files that no damage has touched it is asked once."""
    files = [case.file(name, kind) for kind in kinds]
    files += [case.file(f"{name}-drawing", "dxf")] if "dxf" in kinds else []
    key = ("part", _spec(case), name, kinds, _bytes(files))
    outcome: tuple[Outcome, Read] = _KEPT.once(key, lambda: judge_part(case, name, kinds))
    return outcome


def _parts(case: Case, kinds: Sequence[str], workers: Workers) -> Reading:
    """What `read_parts` says, likewise."""
    formats = tuple(kind for kind in kinds if kind in FORMATS)
    return (_part(case, name, formats) for name in case.parts)


def _stages(mechanism: Mechanism, kinds: Sequence[str]) -> list[Stage]:
    """The stages, each of which is done once on files that are the same."""
    return [
        stage if stage.work is None else replace(stage, work=partial(_stage, stage))
        for stage in stages_of(mechanism, kinds)
    ]


def _stage(stage: Stage, case: Case, kinds: Sequence[str]) -> Any:
    """What a stage says; it may look at files of the kinds that it takes, and at all that are of no part."""
    others = FORMATS.keys() - set(stage.takes) if stage.takes else set()
    files = [
        path
        for path in sorted(case.folder.iterdir())
        if path.name not in _COMPARED and path.suffix[1:] not in others
    ]
    work = stage.work
    assert work is not None
    key = ("stage", work, _spec(case), *kinds, _bytes(files))
    return _KEPT.once(key, lambda: work(case, kinds))


def _moved(mechanism: Mechanism, kinds: Sequence[str], parts: Mapping[str, Read]) -> Any:
    """What `moved_by` says: the same of the same contours."""
    key = ("motion", id(mechanism), *kinds, *map(id, parts.values()))
    held = (mechanism, *parts.values())
    return _KEPT.once(key, lambda: moved_by(mechanism, kinds, parts), held)


def _budget(case: Case, parts: Mapping[str, Read], sources: Sequence[Mapping[str, float]]) -> Any:
    """What `budget_of` says, likewise."""
    key = ("budget", id(case.mechanism), *map(id, parts.values()), *map(id, sources))
    held = (case.mechanism, *parts.values(), *sources)
    return _KEPT.once(key, lambda: budget_of(case, parts, sources), held)


def _drawn(case: Case, name: str, folder: Path) -> None:
    """Draw a part as `draw_part` does, or copy what was drawn of the same spec."""
    before = set(folder.iterdir())

    def draw() -> dict[str, bytes]:
        draw_part(case, name, folder)
        return {path.name: path.read_bytes() for path in set(folder.iterdir()) - before}

    for file, data in _KEPT.once(("drawing", _spec(case), name), draw).items():
        (folder / file).write_bytes(data)


def judged(folder: Path, *kinds: str) -> Report:
    """The report on files of some kinds, "dxf", "stl" or "3mf", as `camgen check` judges them; of none named on all of them.

    Of some kinds without PARTS_LIST: the list in the folder is that of all, such as on which side each solid lies.
    """
    with pytest.MonkeyPatch.context() as patch:
        for name, kept in (("_stages", _stages), ("moved_by", _moved), ("budget_of", _budget)):
            patch.setattr(f"camgen.pipeline.judging.{name}", kept)
        if not kinds:
            patch.setattr(
                "camgen.pipeline.build.read_mechanism", lambda path: mechanism_of(path.parent)
            )
            patch.setattr("camgen.pipeline.build.read_parts", _parts)
            patch.setattr("camgen.pipeline.rebuild.draw_part", _drawn)
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
