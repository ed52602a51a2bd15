"""`camgen design`: the spec that fulfils a wish."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path

import click

from camgen.commands.options import EXIT_CODES, set_option
from camgen.commands.running import hand_over, refuse_taken
from camgen.errors import FileError, printable


@click.command(epilog=EXIT_CODES)
@click.argument("spec", type=click.Path(path_type=Path))
@click.argument("file", required=False, type=click.Path(path_type=Path))
@set_option("Change a value: wanted.feed_range=80.")
@click.option(
    "--front",
    type=click.Path(path_type=Path),
    help="Folder for a page and all designs that no other design beats in every respect.",
)
@click.option(
    "-j",
    "--jobs",
    type=click.IntRange(0),
    default=1,
    help="Number of cores to use; 0: all.  [default: 1]",
)
def design(
    spec: Path, file: Path | None, settings: Sequence[str], front: Path | None, jobs: int
) -> None:
    """Search for the machine that the table [wanted] of SPEC describes ([synthesis] for an indexing cam); write its spec to FILE,
    or print it.

    It finds a linkage for a path, poses, points, a function, positions of a slide or a dwell, cams that draw a line, or values of keys with
    which every limit holds: camgen guide design.
    """
    from camgen.design import run

    refuse_taken(file)
    if front is not None and front.exists():
        raise FileError(front, "exists already, and camgen did not touch it; choose another folder")
    keep = None if front is None else lambda found: found.write(front)
    cores = jobs or os.cpu_count() or 1
    hand_over(
        run.design(spec, settings, cores, lambda said: click.echo(printable(said), err=True), keep),
        file,
    )
    if front is not None:
        click.echo(printable(f"wrote {front}: each design, front.csv and front.html"), err=True)
    if file is not None:
        click.echo(printable(f"wrote {file}; next: camgen build {file}"), err=True)
