"""The chain: spec -> mechanism -> parts -> files -> read back -> findings -> report; and judging an earlier build again."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from camgen import spec as specs
from camgen.errors import Fault, FileError, SpecError
from camgen.files.folder import MANIFEST, Staged, changed_files, manifest_files, write_manifest
from camgen.files.formats import FORMATS, SOLID, USUAL
from camgen.findings import at_most
from camgen.pipeline.jobs import Case, Progress, Source, Workers, cores, silent
from camgen.pipeline.jobs import read_mechanism as read_mechanism
from camgen.pipeline.judging import cut_files, judge, read_parts
from camgen.pipeline.making import make_parts, put_together
from camgen.report.report import Report, write_csv, write_html, write_json

KINDS, ANY_KIND = (*USUAL, "report"), (*FORMATS, "report")  # made where nobody says which; that can be asked for
_PACKAGES = ("numpy", "pydantic", "ezdxf", "manifold3d", "lib3mf", "mapbox-earcut", "reportlab")


def build(
    spec: Source, out: Path, only: frozenset[str], overrides: Sequence[str] = (), progress: Progress = silent,
    jobs: int | None = 1,
) -> Report:  # fmt: skip
    """Make, read back and judge one mechanism; its folder out/<name>/ appears, whole, only when all is done.

    spec: a path, tables or a mechanism; only: the kinds of files to make, of ANY_KIND; where they are
    all of KINDS, those that the spec asks for as well; jobs: cores to use, None: as many as are worth it,
    which changes nothing in the files.
    Raises SpecError, DesignError or FileError; failed findings do not raise.
    """
    wrong = sorted(map(str, only - set(ANY_KIND)))
    if wrong:
        raise SpecError([specs.unknown("only", kind, ANY_KIND) for kind in wrong])
    if not only:
        raise SpecError([Fault("only", "none", f"at least one of {', '.join(ANY_KIND)}")])
    progress("reading the spec", 0.0)
    mechanism = read_mechanism(spec, overrides)
    if said := mechanism.beforehand(len(only & FORMATS.keys())):
        progress(f"note: {said}")
    hints, mechanism = mechanism.hints, mechanism.resolved()
    if only >= frozenset(KINDS) and mechanism.output.step:
        only |= {"step"}
    staged, shared = Staged(out / mechanism.name), cores(jobs, mechanism, only)
    with staged as folder, Workers(shared) as workers:
        (folder / "spec.toml").write_text(specs.dump(mechanism), encoding="utf-8")
        case, kinds = Case(mechanism, folder), [kind for kind in ANY_KIND if kind in only]
        made = make_parts(case, only, workers, progress)
        reading = read_parts(case, kinds, workers)
        plates, seen = put_together(case, only, made, progress), None
        del made
        if "report" in only and only & set(SOLID):
            from camgen.pipeline.shown import scene

            seen = scene(mechanism, plates)
            case.file("assembly", "glb").write_bytes(seen.glb)
        report, columns = judge(case, kinds, reading, workers, progress, "was made (--only)")
        if columns:
            write_csv(folder / "motion.csv", columns)
        for name, text in mechanism.texts().items():
            (folder / f"{mechanism.name}-{name}").write_text(text, encoding="utf-8")
        if "report" in only:
            from camgen.pipeline.shown import animation

            progress("writing the report", 0.85)
            write_html(folder / "report.html", replace(report, animation=animation(mechanism), scene=seen))
        write_json(folder / "report.json", report)
        write_manifest(folder, _PACKAGES)
    said = f"{staged.target / 'spec.toml'} was changed since its build and is written again; the changed one is kept as"
    remarks = [*hints, *mechanism.remarks(), *(f"{said} {name}" for name in staged.kept)]
    if staged.gone and only < frozenset(KINDS):
        gone = ", ".join(sorted({name.rpartition(".")[2].upper() for name in staged.gone}))
        count = f"{len(staged.gone)} more file{'' if len(staged.gone) == 1 else 's'} ({gone})"
        remarks.append(f"the earlier {staged.target} had {count}, gone with it: a build without --only makes all")
    return replace(report, remarks=remarks, folder=staged.target)


def check(folder: Path, progress: Progress = silent, jobs: int | None = 1) -> Report:
    """Judge the files of an earlier build again, from the files and the spec.toml beside them; writes nothing."""
    case = Case(read_mechanism(folder / "spec.toml"), folder)
    listed = manifest_files(folder)
    lost = next((name for name in listed if not (folder / name).is_file()), None)
    if lost is not None:
        how = "no plain file" if (folder / lost).exists() else "not there"
        raise FileError(folder / lost, f"is listed in manifest.json and {how}")
    kinds = [kind for kind in ANY_KIND if any(path.name in listed or path.exists() for path in _files(case, kind))]
    with Workers(cores(jobs, case.mechanism, kinds)) as workers:
        report = judge(case, kinds, read_parts(case, kinds, workers), workers, progress, "is in the folder")[0]
    judged = {path.name for kind in FORMATS for path in _files(case, kind)} | {"spec.toml"}
    sheets = {path.name for path in cut_files(case)}
    judged |= {name for name in listed if name.endswith((".3mf", ".step")) or name in sheets}
    differ = changed_files(folder)
    as_they_are = [name for name in differ if name in judged]
    if as_they_are:
        report = replace(report, remarks=[f"changed since the build, and judged as they are now: {', '.join(as_they_are)}"])
    changed = [name for name in differ if name not in judged]
    if changed:
        said = f"changed since the build, and not judged by what they hold: {', '.join(changed)}"
        report = replace(report, findings=(*report.findings, at_most("MANIFEST", len(changed), 0, "files", MANIFEST, said)))
    return report


def _files(case: Case, kind: str) -> list[Path]:
    """The files of a kind that a build may have made."""
    return [case.folder / "report.html"] if kind == "report" else [case.file(name, kind) for name in case.parts]
