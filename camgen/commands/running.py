"""What the commands share: the work on each path, what is printed of it, and the exit code."""

from __future__ import annotations

import re
import sys
from collections.abc import Callable, Collection, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, NoReturn

import click

from camgen.errors import (
    CamgenError,
    DesignError,
    Fault,
    FileError,
    SpecError,
    by_beginning,
    explained,
    for_terminal,
    printable,
)

if TYPE_CHECKING:
    from camgen.report.report import Report

    Work = Callable[..., Report]


def known(
    what: str, name: str, names: Collection[str], lister: str, holders: Sequence[str] = ()
) -> str:
    """The name; SpecError with the nearest one where there is none like it; lister: the command that lists them; holders: those
    in which the name is found."""
    from camgen.spec import unknown

    if name not in names:
        found = (
            f"; {', '.join(holders)} say{'s' * (len(holders) == 1)} more of it" if holders else ""
        )
        right = f"one that '{lister}' lists{found}"
        fault = unknown((what,), name, names)
        nearest = fault.nearest or by_beginning(name, [*names])
        raise SpecError([replace(fault, expected=right, nearest=nearest)], "command line")
    return name


def spec_name(file: Path, other: str) -> str:
    """A name for a spec, after a file's; the other one where that gives none, or a device's of Windows."""
    from camgen.spec import DEVICES

    name = "-".join(re.findall(r"[a-z0-9]+", file.stem.lower()))[:60].strip("-")
    return other if re.fullmatch(DEVICES, name or "nul") else name


_HEADING = re.compile(r"^(#+) (.+)$", re.MULTILINE)


def _underlined(heading: re.Match[str]) -> str:
    """A heading as plain text has it, which Markdown reads as one too."""
    line = "=" if heading[1] == "#" else "-"
    return f"{heading[2]}\n{line * len(heading[2])}"


def show(markdown: str) -> None:
    """Print a page: laid out on a terminal, else as it is written, its headings underlined."""
    if not sys.stdout.isatty():
        parts = markdown.split("```")  # every second one is code, in which # begins a comment
        parts[::2] = [_HEADING.sub(_underlined, part) for part in parts[::2]]
        click.echo("```".join(parts), nl=False)
        return
    from rich.console import Console
    from rich.markdown import Markdown

    console = Console()
    console.print(Markdown(markdown, code_theme="ansi_dark"), width=min(console.width, 100))


def hand_over(text: str, file: Path | None) -> None:
    """Print the text, or write it to a new file."""
    if file is None:
        click.echo(printable(text, keep="\n"), nl=False)
        return
    try:
        with open(file, "x", encoding="utf-8", newline="") as stream:
            stream.write(text)
    except FileExistsError:
        raise _taken(file) from None


def refuse_taken(file: Path | None) -> None:
    """FileError where the file that is to be written exists, or its folder does not: asked before a search."""
    if file is not None and file.exists():
        raise _taken(file)
    if file is not None and not file.parent.is_dir():
        raise FileError(file, f"there is no folder {file.parent}; make it, or choose another place")


def _taken(file: Path) -> FileError:
    return FileError(file, "exists already, and camgen did not touch it; choose another name")


def refuse_words(specs: Sequence[Path]) -> None:
    """SpecError where a word stands for a spec's file that means something else: a starter, or a kind of files.

    FileError where a file that does not exist has a starter's name, and none of that name is near.
    """
    from camgen.bounds import meant_file
    from camgen.commands.options import ANY_KIND, specs_known

    for spec in specs:
        if spec.exists():
            continue
        name = str(spec)
        if name in ANY_KIND:
            right = f"a spec's file; write kinds without a space, as in --only dxf,{name}"
        elif name in specs_known():
            right = f"a spec's file: camgen new {name} my-{name}.toml writes one"
        elif spec.suffix == ".toml" and spec.stem in specs_known():
            if Path(meant_file(spec)).stem == spec.stem:
                continue
            said = f"there is no such file; camgen new {spec.stem} {spec.name} writes one"
            raise FileError(spec, f"cannot be read: {said}")
        else:
            continue
        raise SpecError([Fault(("SPEC",), repr(name), right)], "command line")


def refuse_one_name_twice(specs: Sequence[Path], settings: Sequence[str]) -> None:
    """SpecError where two specs would write the same folder; specs that cannot be read are told when their turn comes."""
    from camgen.pipeline import build as pipeline

    first: dict[str, Path] = {}
    for spec in specs:
        try:
            name = pipeline.read_mechanism(spec, settings).name
        except CamgenError:
            continue
        if name in first:
            raise SpecError(
                [Fault(("name",), repr(name), f"another name: {first[name]} writes that folder")],
                str(spec),
            )
        first[name] = spec


def each(
    paths: Sequence[Path],
    prepare: Callable[[], Work],
    jobs: int | None = 1,
    as_json: bool = False,
    quiet: bool = False,
    verbose: bool = False,
) -> NoReturn:
    """Do the work on each path, print what came out in their order, and end with the worst exit code.

    prepare: imports what the work needs, and gives it. Several paths are shared out to the cores; for a single one the work
    shares out its own steps. jobs: cores to use, 0: all, None: as many as are worth it.
    """
    from camgen.report.terminal import Bar, print_report

    worst = 0
    records = []
    with Bar(not quiet):
        from camgen.workers import Workers, all_cores

        work = prepare()
    cores = all_cores() if jobs == 0 or (jobs is None and len(paths) > 1) else jobs
    shared = len(paths) > 1 and cores != 1
    with Workers(min(cores or 1, len(paths)) if shared else 1) as workers:
        started = [workers.start(work, path) for path in paths] if shared else []
        for k, path in enumerate(paths):
            try:
                with Bar(not quiet) as progress:
                    if shared:
                        progress(f"{path}, {k + 1} of {len(paths)}", k / len(paths))
                        report = started[k]()
                    else:
                        report = work(path, progress=progress, jobs=cores)
            except (CamgenError, OSError) as error:
                failure = explained(error)
                if (
                    isinstance(failure, SpecError) and failure.source == "spec"
                ):  # found where nobody knew the file
                    failure = SpecError(failure.faults, str(path))
                worst = max(worst, failure.exit_code)
                complain(failure, path)
                records.append(_failure_record(path, failure))
                continue
            worst = max(worst, 0 if report.ok else 1)
            records.append(report.as_dict())
            if not as_json:
                print_report(report, quiet, verbose)
    if as_json:
        import json

        text = json.dumps(
            records[0] if len(records) == 1 else records, indent=2, ensure_ascii=False
        )
        click.echo(
            "".join(c if c.isprintable() or c == "\n" else json.dumps(c)[1:-1] for c in text)
        )
    raise click.exceptions.Exit(worst)


def complain(error: CamgenError, source: Path | None = None) -> None:
    """Print a user's error on stderr, with the spec's name where the error does not say it by itself."""
    named = f"{source}: " if source is not None and isinstance(error, DesignError) else ""
    click.echo(for_terminal(printable(f"error: {named}{error}", keep="\n"), sys.stderr), err=True)


def _failure_record(path: Path, error: CamgenError) -> dict[str, Any]:
    """What --json prints in place of a report that could not be made."""
    faults = [fault.facts for fault in error.faults] if isinstance(error, SpecError) else []
    if isinstance(error, DesignError):
        faults = [error.facts]
    return {
        "source": str(path),
        "ok": False,
        "exit_code": error.exit_code,
        "error": str(error),
        "faults": faults,
    }
