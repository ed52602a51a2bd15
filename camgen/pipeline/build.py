"""The chain: spec -> mechanism -> parts -> files -> read back -> findings -> report; and judging an earlier build again."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from difflib import get_close_matches
from os import PathLike
from pathlib import Path

from camgen import spec as specs
from camgen.errors import Fault, FileError, SpecError
from camgen.files.folder import (
    MANIFEST,
    SPEC,
    StagingFolder,
    changed_files,
    read_manifest,
    write_manifest,
)
from camgen.files.formats import ANY_KIND, FORMATS
from camgen.files.formats import KINDS as KINDS
from camgen.files.shelves import put_away
from camgen.findings import at_most, in_file
from camgen.machines.mechanism import Mechanism
from camgen.machines.sources import Source, placing
from camgen.machines.sources import read_mechanism as read_mechanism
from camgen.parts import materials
from camgen.pipeline.case import Case, cores
from camgen.pipeline.judging import judge, read_parts
from camgen.pipeline.making import make_parts, put_together
from camgen.pipeline.namesakes import namesake
from camgen.pipeline.rebuild import Rebuild, judged_files, kinds_of, packages_of, system
from camgen.pipeline.summary import Summary, report_files, scene_of, write_report, write_texts
from camgen.progress import Progress, silent
from camgen.report.report import Report
from camgen.workers import Workers

# s, to make and judge a kind of file, and by the cube of links; measured up to 58
_OF_A_KIND = 3.0
_OF_THREE = 1.3e-4
_LONG = 20.0  # s, that are told before a build


def build(
    spec: Source,
    out: Path,
    only: frozenset[str],
    overrides: Sequence[str] = (),
    progress: Progress = silent,
    jobs: int | None = 1,
) -> Report:
    """Make, read back and judge one mechanism; its folder out/<name>/ appears, whole, only when all is done.

    spec: a path, tables or a mechanism; only: the kinds of files to make, of ANY_KIND; where they are
    all of KINDS, those that the spec asks for as well; jobs: cores to use, None: as many as are worth it,
    which changes nothing in the files.
    Raises SpecError, DesignError or FileError; failed findings do not raise.
    """
    unknown = sorted(map(str, only - set(ANY_KIND)))
    if unknown:
        raise SpecError([specs.unknown(("only",), kind, ANY_KIND) for kind in unknown])
    if not only:
        raise SpecError([Fault(("only",), "none", f"at least one of {', '.join(ANY_KIND)}")])
    progress("reading the spec", 0.0)
    mechanism = read_mechanism(spec, overrides)
    with placing(spec, overrides, mechanism):
        return _built(mechanism, spec, out, only, progress, jobs)


def _built(
    mechanism: Mechanism,
    spec: Source,
    out: Path,
    only: frozenset[str],
    progress: Progress,
    jobs: int | None,
) -> Report:
    """What `build` does with the mechanism that a spec describes."""
    if said := long_run(mechanism.remarks().links, len(only & FORMATS.keys())):
        progress(f"note: {said}")
    hints = mechanism.hints
    other = (
        namesake(Path(spec), mechanism, out / mechanism.name)
        if isinstance(spec, str | PathLike)
        else ""
    )
    mechanism = mechanism.resolved()
    if only >= frozenset(KINDS) and has_exact_solids(mechanism):
        only |= {"step"}
    staged = StagingFolder(out / mechanism.name)
    number_of_cores = cores(jobs, mechanism, only)
    with staged as folder, Workers(number_of_cores) as workers:
        (folder / SPEC).write_text(specs.dump(mechanism), encoding="utf-8", newline="\n")
        case = Case(mechanism, folder)
        kinds = [kind for kind in ANY_KIND if kind in only]
        meshes = make_parts(case, only, workers, progress)
        reading = read_parts(case, kinds, workers)
        put_together(case, only, meshes, progress)
        del meshes
        scene = scene_of(case, kinds)
        if scene is not None:
            case.file("assembly", "glb").write_bytes(scene.glb)
        write_texts(case, folder)
        report, columns = judge(case, kinds, reading, workers, progress)
        progress("writing the report", 0.85)
        summary = Summary(kinds, report, columns, scene)
        put_away(folder, [MANIFEST, *report_files(summary)])
        write_report(summary, case, folder)
        write_manifest(folder, packages_of(kinds), {"kinds": kinds, "system": system()})
    said = f"{staged.target / 'spec.toml'} was changed after its build; this build wrote it again and kept the changed one as"
    remarks = [*hints, *mechanism.remarks().printed, *(f"{said} {name}" for name in staged.kept)]
    if staged.gone and only < frozenset(KINDS):
        gone = ", ".join(sorted({name.rpartition(".")[2].upper() for name in staged.gone}))
        count = f"{len(staged.gone)} file{'' if len(staged.gone) == 1 else 's'} ({gone})"
        remarks.append(
            f"this build removed {count} that the earlier {staged.target} had: build without --only to make all kinds"
        )
    if other:
        remarks.append(
            f"this build replaced {staged.target}, which was {other}: both specs have the name "
            f"{mechanism.name!r}, so change name in one of them"
        )
    return replace(report, remarks=remarks, folder=staged.target)


def check(folder: Path, progress: Progress = silent, jobs: int | None = 1) -> Report:
    """Judge the files of an earlier build again, from the files and the spec.toml beside them, and hold all others against those
    that are made anew; writes nothing."""
    if not folder.exists():
        raise FileError(
            folder, f"there is no such folder: camgen build SPEC makes one{_meant(folder)}"
        )
    if not (folder / SPEC).is_file():
        raise FileError(
            folder,
            f"is not the folder of a build, as out/<name> is: it has no {SPEC}{_meant(folder)}",
        )
    case = Case(read_mechanism(folder / SPEC), folder)
    manifest = read_manifest(folder)
    names = list(manifest["files"])
    _refuse_lost(folder, [name for name in names if not (folder / name).is_file()])
    kinds = kinds_of(case, manifest)
    with Workers(cores(jobs, case.mechanism, kinds)) as workers:
        report, columns = judge(case, kinds, read_parts(case, kinds, workers), workers, progress)
        differ = changed_files(folder)
        judged = judged_files(case, names)
        judged_changes = [name for name in differ if name in judged]
        other_changes = [name for name in differ if name not in judged]
        progress("comparing the other files with a rebuild", 0.85)
        rebuilt = Rebuild(case, kinds, manifest, report, columns, bool(judged_changes)).outcome(
            other_changes, workers
        )
    findings = [*report.findings, *rebuilt.findings]
    if other_changes:
        said = f"changed since the build: {', '.join(other_changes)}"
        findings.append(
            at_most("MANIFEST", len(other_changes), 0, "files", in_file(Path(MANIFEST)), said)
        )
    remarks = (
        [f"changed since the build, and judged as they are now: {', '.join(judged_changes)}"]
        if judged_changes
        else []
    )
    return replace(
        report,
        findings=findings,
        not_judged=[*report.not_judged, *rebuilt.not_judged],
        remarks=[*remarks, *rebuilt.notes],
    )


def _meant(path: Path) -> str:
    """What a person may mean by a path that is no folder of a build."""
    if path.suffix == ".toml" and path.is_file():
        return f"; camgen build {path} makes one"
    if path.is_file():
        found = [each for each in list(path.parents)[:2] if (each / MANIFEST).is_file()]
    elif path.exists():
        found = sorted(each.parent for each in path.glob(f"*/{MANIFEST}"))
    else:
        builds = {each.parent.name: each.parent for each in path.parent.glob(f"*/{MANIFEST}")}
        found = [builds[name] for name in get_close_matches(path.name, sorted(builds), 1)]
    return f"; did you mean {found[0]}?" if found else ""


def long_run(links: int, kinds: int) -> str:
    """How long so many links take that are closed together, with so many kinds of files; nothing where that is short."""
    seconds = kinds * (_OF_A_KIND + _OF_THREE * links**3)
    return (
        f"{links} links: making and judging them takes about {seconds:.0f} s"
        if links and seconds > _LONG
        else ""
    )


def _refuse_lost(folder: Path, lost: Sequence[str]) -> None:
    """FileError that names all files which the manifest lists and that are not there, and what to do."""
    if not lost:
        return
    names = [
        f"{name} ({'no plain file' if (folder / name).exists() else 'not there'})" for name in lost
    ]
    files = (
        "a file that manifest.json lists is"
        if len(lost) == 1
        else (f"{len(lost)} files that manifest.json lists are")
    )
    raise FileError(
        folder,
        f"{files} missing: {', '.join(names)}; put back what was moved or deleted, or build the folder again: "
        f"camgen build {folder / SPEC} --out {folder.parent}",
    )


def has_exact_solids(mechanism: Mechanism) -> bool:
    """Whether a whole build makes STEP as well: where the spec says so, or leaves it open and names a metal."""
    asked = mechanism.files.step
    return materials.of(mechanism.material.name).metal if asked is None else asked
