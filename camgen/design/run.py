"""`camgen design`: the spec that fulfils what a spec wants, its own text and comments kept where that can be."""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from camgen import spec as specs
from camgen.design.chains import chains
from camgen.design.keys import Search
from camgen.design.linkages import Candidate
from camgen.design.paths import Found
from camgen.design.wanted import KeyWish, PathWish, wish, without
from camgen.errors import UNKNOWN, DesignError, Fault, FileError, SpecError, file_errors
from camgen.pipeline.edits import edited, with_tables
from camgen.pipeline.jobs import Source, Workers, changed, read_mechanism, read_tables
from camgen.settings import override

if TYPE_CHECKING:
    from camgen.design.polish import Goal
    from camgen.machines.linkage.sizes import Parts

Told = Callable[[str], None]

_FOUND = ("points", "links", "lengths", "output", "slide", "slot", "gear", "cam", "layers")  # tables that a search makes
_WORST, _MOST = 0.2, 10.0  # of the wanted path's longest chord: error, and length of all bars, that a front reaches to


@dataclass(frozen=True)
class Front:
    """Designs that no other one beats: a spec's text for each, and the rows of a table."""

    name: str
    texts: Sequence[str]
    rows: Sequence[Mapping[str, Any]]

    def write(self, folder: Path) -> None:
        """01.toml, 02.toml, ..., front.csv and front.html; FileError where the folder exists."""
        from camgen.report.sweep_page import write_page

        with file_errors():
            try:
                folder.mkdir(parents=True)
            except FileExistsError:
                raise FileError(folder, "exists already and is left as it is; choose another folder") from None
            for number, text in enumerate(self.texts, 1):
                (folder / f"{number:02d}.toml").write_text(text, encoding="utf-8", newline="\n")
            stream = io.StringIO()
            table = csv.DictWriter(stream, list(self.rows[0]), lineterminator="\n")
            table.writeheader()
            table.writerows(self.rows)
            (folder / "front.csv").write_text(stream.getvalue(), encoding="utf-8", newline="\n")
        summary = (f"{len(self.rows)} designs: each is nearer to the path than all with less bar, or has less bar than all "
                   "nearer. Design 1 is 01.toml, and so on; what is refused cannot be built as it stands.")  # fmt: skip
        write_page(folder / "front.html", f"Linkages for the path of {self.name}", summary, list(self.rows[0]),
                   ["worst_distance_mm"], self.rows, len(self.rows), ["bars_mm"])  # fmt: skip


def design(
    spec: Source, settings: Sequence[str] = (), jobs: int = 1, told: Told = lambda text: None,
    keep: Callable[[Front], None] | None = None,
) -> str:  # fmt: skip
    """Text of the spec that was found. keep: is handed the front of a search for a path, also where none of it will do.

    SpecError with every fault of the wish; DesignError, with the nearest that was reached, where nothing fulfils it.
    """
    data, source, folder = read_tables(spec)
    for setting in settings:
        data = override(data, setting)
    text = Path(spec).read_text(encoding="utf-8-sig") if isinstance(spec, str | Path) else None
    asked = wish(data, source)
    if isinstance(asked, PathWish):
        return _for_path(asked, data, source, folder, text if not settings else None, jobs, told, keep)
    if keep is not None:
        raise SpecError([Fault("--front", "", "a search for a path: it alone has a front")], "command line")
    if isinstance(asked, KeyWish):
        rest = without(data)
        changed(rest, source, folder)  # faults of the spec itself come first
        if wrong := [fault for key, ends in asked.vary.items() for fault in _beyond(rest, source, folder, key, ends)]:
            raise SpecError(wrong, source)
        found = Search(rest, source, folder, asked, told).found()
        if text is not None and not settings:
            return with_tables(edited(text, found), {}, ["wanted"])
        for setting in found:
            rest = override(rest, setting)
        return specs.dump(changed(rest, source, folder))
    mechanism = read_mechanism(spec, settings)
    own = getattr(mechanism, "designed", None)
    if own is None:
        right = 'a table with path = "..." (a linkage for it), or vary = { key = [least, most] } and least = "figure"'
        raise SpecError([Fault("wanted", "", f"missing: {right}; camgen guide design")], source)
    return specs.dump(own())


def _for_path(
    asked: PathWish, data: specs.Data, source: str, folder: Path, text: str | None, jobs: int, told: Told,
    keep: Callable[[Front], None] | None,
) -> str:  # fmt: skip
    from camgen.design import paths
    from camgen.design.polish import Goal
    from camgen.design.target import Target

    rest = without(data)
    right = "nothing here: it is found, with [points], [links] and [[output]]"
    faults = [Fault(key, "a table", right) for key in _FOUND if key in rest]
    if data.get("mechanism") != "linkage":
        faults.append(Fault("mechanism", str(data.get("mechanism")), '"linkage", for a path'))
    if faults:
        raise SpecError(faults, source)
    made = _checked(rest, source)
    points = asked.points(folder)
    target = Target(points)
    shortest = asked.shortest or made.pin_diameter + 2 * made.wall  # of a hub
    sine = math.sin(math.radians(max(asked.transmission_deg, 0.1)))
    goal = Goal(target, _WORST * target.chord, _MOST * target.chord, shortest, sine)
    kinds = [chain for chain in paths.kinds(asked.bars // 2, 2) if len(chain.bodies) <= asked.bars]
    told(f"searched: {len(kinds)} chain" + ("s; this takes minutes" if len(kinds) > 1 else ""))
    with Workers(jobs) as workers:
        found = paths.search(goal, kinds, asked.effort, asked.seed, workers.map, told)
    if not found:
        raise DesignError("designs whose chain closes", 0, 1, "", "wanted", "more effort, more bars, or less transmission_deg")
    front = [Candidate(each, points, rest) for each in found]
    rows = []
    for number, each in enumerate(front, 1):
        told(f"parts of design {number} of {len(front)}")
        rows.append(each.row(number))
    if keep is not None:
        keep(Front(str(data.get("name")), [_text(each, asked, text, None) for each in front], rows))
    chosen = _chosen(front, goal, asked.tolerance)
    row = rows[front.index(chosen)]
    told(f"design {row['design']} of {len(front)}: at most {chosen.worst:.4g} mm from the path, {row['mean_distance_mm']:.3g} mm "
         f"in the mean, bars of {chosen.found.bars:.4g} mm")  # fmt: skip
    return _text(chosen, asked, text, asked.tolerance)


def _checked(tables: specs.Data, source: str) -> Parts:
    """Sizes of the parts; SpecError with the faults of everything that is not found, before a search: seen with a four-bar."""
    from camgen.machines.linkage.mechanism import Linkage

    drawn = (0j, 20 + 0j, 70 + 0j, 45 + 40j, 20 + 60j)
    any_one = Candidate(Found(chains(2, 1)[0], drawn, 0.0, 0.0), np.array(drawn), tables)
    return specs.validate(Linkage, any_one.data(1.0), source).making


def _beyond(tables: specs.Data, source: str, folder: Path, key: str, ends: tuple[float, float]) -> list[Fault]:
    """What is wrong with a key that varies, at both ends by itself: no such key, or a value that it cannot have."""
    for value in ends:
        try:
            changed(tables, source, folder, [f"{key}={value!r}"])
        except SpecError as error:
            own = [fault for fault in error.faults if fault.path.removeprefix("--set ") in (key, f"{key}={value!r}") or not value]
            own = own or [fault for fault in error.faults if fault.expected.startswith(UNKNOWN) or fault.path == "--set"]
            if own:
                return [Fault(f"wanted.vary.{key}", f"{value:g}", fault.expected, fault.nearest) for fault in own]
    return []


def _chosen(front: Sequence[Candidate], goal: Goal, tolerance: float | None) -> Candidate:
    """Of the buildable ones the one of least bar within the tolerance, or without one the best trade-off; DesignError."""
    can = [each for each in front if not each.refused]
    if not can:
        raise DesignError(
            "buildable designs", 0, 1, "", f"front of {len(front)}", "more effort, more bars, or thinner pins and walls",
            f"none of {len(front)} designs can be built; the first: {front[0].refused}",
        )  # fmt: skip
    if tolerance is None:
        return max(can, key=lambda each: (1 - each.found.error / goal.worst) * (1 - each.found.bars / goal.most))
    near = [each for each in can if each.worst <= tolerance]
    if not near:
        best = min(can, key=lambda each: each.worst)
        remedy = "more effort or bars, or a wider tolerance"
        raise DesignError("wanted.tolerance", best.worst, tolerance, "mm", "the nearest buildable design", remedy)
    return min(near, key=lambda each: each.found.bars)


def _text(each: Candidate, asked: PathWish, text: str | None, tolerance: float | None) -> str:
    from camgen.machines import MECHANISMS, load

    data = each.data(tolerance)
    if text is None:
        return specs.dump(specs.validate(load(specs.choose(data, MECHANISMS)), data))
    path = asked.path if isinstance(asked.path, str) else f"{len(asked.path)} points"
    said = f"found by camgen design for the path {path}; output.points: places of that path, and how far this machine passes them"
    return with_tables(text, {key: data[key] for key in ("points", "links", "drive", "output")}, ["wanted"], said)
