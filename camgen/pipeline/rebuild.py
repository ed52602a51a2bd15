"""A folder against what its spec.toml and its parts' files give again: the same spec gives the same bytes.

    judged   files that stages of the judge read and judge by what they hold: those of the parts, assemblies, plates, sheets
    anew     all others, but for spec.toml and the manifest: drawings, lists, tables, texts, the machine in motion, reports

Bytes follow from the spec, the versions of camgen and its packages, and the system: the last digits of sines and exponentials
differ from processor to processor, and packed bytes from one zlib to the next. Of a folder that others built, what is not the
same but for such digits is named, not failed.
"""

from __future__ import annotations

import platform
import re
import zlib
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from itertools import repeat, zip_longest
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

from camgen._version import __version__
from camgen.files.folder import MANIFEST, SPEC, versions
from camgen.files.formats import ANY_KIND, FORMATS, RENDERED
from camgen.files.shelves import located
from camgen.findings import NotJudged, at_most, in_file
from camgen.geometry.outlines import Floats
from camgen.pipeline.case import Case
from camgen.pipeline.making import draw_machine, lying_sides, write_parts_list, written
from camgen.pipeline.scope import Outcome, machined
from camgen.pipeline.servo import make_servo_tables, servo_files
from camgen.pipeline.summary import (
    Summary,
    draw_part,
    rendered_file,
    scene_of,
    write_report,
    write_texts,
)
from camgen.report.report import Report
from camgen.workers import Workers

_PACKAGES = (
    "ezdxf",
    "lib3mf",
    "manifold3d",
    "mapbox-earcut",
    "numpy",
    "pydantic",
    "rectpack",
    "reportlab",
    "scipy",
    "shapely",
    "tomli-w",
)
_OF_PLOTS = ("matplotlib", "pillow")
_OF_PICTURES = ("pillow",)
_OF_FILES = {"motion.csv", "report.html", "report.json"}  # follow from the parts' files as well
_OF_JUDGEMENT = {"report.html", "report.json"}  # say what fails
_TEXTS = {
    "csv",
    "dxf",
    "html",
    "json",
    "pmks",
    "st",
    "svg",
    "toml",
    "xml",
}  # endings of files in which a number may be written otherwise
_NUMBER = re.compile(r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?")
_DIGITS = 1e-9  # mm, or a share: by which numbers that are the same may differ
_SHOWN = 40  # characters of a place where two texts differ
_TOLD = 3  # files of which that place is told


def system() -> str:
    """What bytes depend on besides versions of packages: the system, its libraries, and the instructions that numpy takes."""
    libraries = [*platform.libc_ver(), "zlib", zlib.ZLIB_RUNTIME_VERSION]
    instructions = np.show_config(mode="dicts")["SIMD Extensions"]
    features = [*instructions.get("baseline", ()), *instructions.get("found", ())]
    return " ".join(filter(None, [platform.system(), platform.machine(), *libraries, *features]))


def packages_of(kinds: Collection[str]) -> tuple[str, ...]:
    """The packages that make files of these kinds."""
    pictures = _OF_PICTURES if RENDERED.keys() & kinds else ()
    return (*_PACKAGES, *(_OF_PLOTS if "plots" in kinds else pictures))


def kinds_of(case: Case, manifest: Mapping[str, Any]) -> list[str]:
    """The kinds of files that a folder was built with: as its manifest says, and of which any file is there."""
    entry = manifest.get("kinds", ())
    names = entry if isinstance(entry, list) else ()
    return [
        kind
        for kind in ANY_KIND
        if kind in names or any(path.exists() for path in _files(case, kind))
    ]


def _files(case: Case, kind: str) -> list[Path]:
    """Files that a build makes of a kind, where nothing else asks for them."""
    if kind == "report":
        return [case.folder / "report.html", case.file("assembly", "glb")]
    if kind == "servo":
        return servo_files(case)
    if kind == "mjcf":
        from camgen.pipeline.multibody import mjcf_files

        return mjcf_files(case.folder)
    if kind in RENDERED:
        return [rendered_file(case, case.folder, kind)]
    if kind == "plots":
        return case.files("plot-*")
    return [case.file(name, kind) for name in case.parts]


def judged_files(case: Case, names: Collection[str]) -> set[str]:
    """Those of the files, as the manifest names them, that are judged by what they hold."""
    from camgen.pipeline.laser import sheet_files

    paths = [path for kind in FORMATS for path in _files(case, kind)]
    parts = {case.place(path) for path in (*paths, *sheet_files(case))}
    return parts | {SPEC} | {name for name in names if name.endswith((".3mf", ".step"))}


@dataclass(frozen=True)
class Rebuild:
    """An earlier build, judged again, with what it is to be held against.

    report, columns: of the files as they are now; otherwise: whether a part's file was changed since the build, so that what the
    build said of the files is no longer so.
    """

    case: Case
    kinds: Sequence[str]
    manifest: Mapping[str, Any]
    report: Report
    columns: Mapping[str, Floats]
    otherwise: bool

    def outcome(self, changes: Collection[str], workers: Workers) -> Outcome:
        """REBUILD: files that are not as they are made anew, that are not there, or that no such build makes.

        changes: names of files whose change is a finding already.
        """
        files = self.manifest["files"]
        plots = {path.name for path in _files(self.case, "plots")}
        left_out = _OF_FILES | plots if self.otherwise else set()
        with TemporaryDirectory() as scratch:
            folder = Path(scratch)
            self._make(folder, workers)
            anew = {
                self.case.place(located(self.case.folder / path.relative_to(folder))): path
                for path in sorted(folder.rglob("*"))
                if path.is_file()
            }
            names = sorted(anew)
            compared = [name for name in names if name not in changes and name not in left_out]
            differences = {
                name: said
                for name in compared
                if (said := _difference(self.case.folder / name, anew[name]))
            }
        judged = {*names, *judged_files(self.case, files), MANIFEST, *left_out}
        differences |= {name: "is made by no such build" for name in files if name not in judged}
        notes = (
            ["of the parts' files as they were: " + ", ".join(sorted(left_out & set(names)))]
            if self.otherwise
            else []
        )
        stale = self._stale(differences, changes)
        if stale:
            differences = {name: why for name, why in differences.items() if name not in stale}
            compared = [name for name in compared if name not in stale]
            notes.append(
                f"these files have the findings of the build, not those that fail now: {', '.join(stale)}"
            )
        others = _others(self.manifest, packages_of(self.kinds))
        if differences and others:
            why = f"built with {others}: these files differ from those made here, and cannot be judged in full: {', '.join(differences)}"
            return Outcome(
                not_judged=[NotJudged("REBUILD", why, "what it was built with")], notes=notes
            )
        said = f"{len(compared)} files beside the parts are the same when made again from spec.toml and the parts' files"
        if differences:
            rows = [f"{name} {why}" for name, why in differences.items()]
            more = [", ".join(list(differences)[_TOLD:])] if len(differences) > _TOLD else []
            said = "different when made again from spec.toml and the parts' files: " + "; ".join(
                [*rows[:_TOLD], *more]
            )
        return Outcome(
            [at_most("REBUILD", len(differences), 0, "files", in_file(Path(SPEC)), said)],
            notes=notes,
        )

    def _stale(self, names: Collection[str], changes: Collection[str]) -> list[str]:
        """Reports that are there but other ones than those of today, where something else fails already: they follow from it."""
        if self.report.ok and not changes:
            return []
        return [
            name for name in names if name in _OF_JUDGEMENT and (self.case.folder / name).is_file()
        ]

    def _make(self, folder: Path, workers: Workers) -> None:
        """Make what is no file of a part, an assembly, a plate or a sheet into another folder."""
        case = self.case
        kinds = self.kinds
        copy = Case(self.case.mechanism, folder)
        drawings = list(case.parts) if "dxf" in kinds else []
        tasks = workers.map(
            draw_part, repeat(case, len(drawings)), drawings, repeat(folder, len(drawings))
        )
        scene = scene_of(case, kinds)
        if scene is not None:
            copy.file("assembly", "glb").write_bytes(scene.glb)
        sides = lying_sides(case.mechanism, written(case) if "3mf" in kinds else {})
        write_parts_list(copy.file("parts", "csv"), case.mechanism, sides)
        if "servo" in kinds:
            make_servo_tables(copy)
        if "mjcf" in kinds:
            from camgen.pipeline.multibody import make_mjcf

            make_mjcf(case, folder)
        if "dxf" in kinds:
            draw_machine(case, folder)
            if machined(case.mechanism):
                from camgen.pipeline.machining import make_tables

                make_tables(copy)
        write_texts(case, folder)
        write_report(Summary(kinds, self.report, self.columns, scene), case, folder)
        for _ in tasks:
            pass


def _others(manifest: Mapping[str, Any], packages: Collection[str]) -> str:
    """What a build was made with that is not here, in words; "" where bytes are to be the same."""
    present = {"camgen": __version__, **versions(packages)}
    packages_then = manifest.get("packages")
    then = {
        "camgen": manifest["camgen"],
        **(packages_then if isinstance(packages_then, dict) else {}),
    }
    differences = [
        f"{name} {then.get(name, 'unknown')}"
        for name in sorted({*present, *then})
        if present.get(name) != then.get(name)
    ]
    return ", ".join(
        [*differences, *(["another system"] if manifest.get("system") != system() else [])]
    )


# ---- one file --------------------------------------------------------------------------------------------------------


def _difference(path: Path, anew: Path) -> str:
    """In which way a file is another one than the same made anew; "" where it is the same but for the last digits of numbers."""
    if not path.is_file():
        return "is not there"
    expected = anew.read_bytes()
    if path.stat().st_size > 2 * len(expected) + 1000:
        return "is larger"
    data = path.read_bytes()
    if data == expected:
        return ""
    if path.suffix[1:] not in _TEXTS:
        return "has other bytes"
    try:
        text = data.decode("utf-8")
    except UnicodeDecodeError:
        return "is no text"
    for number, (line, other) in enumerate(
        zip_longest(text.split("\n"), expected.decode("utf-8").split("\n"), fillvalue=""), 1
    ):
        if not _same(line, other):
            return f"has in line {number} {_from(line, other)!r} instead of {_from(other, line)!r}"
    return ""


def _same(line: str, other: str) -> bool:
    """Whether two lines are the same but for the last digits of their numbers."""
    if line == other:
        return True
    if _NUMBER.sub("#", line) != _NUMBER.sub("#", other):
        return False
    pairs = zip(map(float, _NUMBER.findall(line)), map(float, _NUMBER.findall(other)), strict=True)
    return all(abs(a - b) <= _DIGITS * (1 + abs(b)) for a, b in pairs)


def _from(line: str, other: str) -> str:
    """A line from shortly before where it leaves the other one."""
    first = next(
        (k for k, (a, b) in enumerate(zip(line, other, strict=False)) if a != b),
        min(len(line), len(other)),
    )
    begin = max(first - _SHOWN // 2, 0)
    return line[begin : begin + _SHOWN]
