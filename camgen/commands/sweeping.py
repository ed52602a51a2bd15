"""`camgen sweep`: many variants as one table."""

from __future__ import annotations

import os
import sys
from pathlib import Path
from shutil import get_terminal_size
from typing import Any

import click

from camgen.commands.options import SWEEP_CODES, kinds_of, set_option
from camgen.commands.running import refuse_words
from camgen.errors import printable


@click.command(epilog=SWEEP_CODES)
@click.argument("spec", type=click.Path(path_type=Path))
@click.option(
    "--vary",
    metavar="KEY=VALUES",
    multiple=True,
    required=True,
    help="KEY=A:B:N, N values from A to B; or KEY=a,b,c.",
)
@click.option(
    "--grid",
    is_flag=True,
    help="Every value of each key with every value of the others (the default).",
)
@click.option(
    "--zip",
    "zipped",
    is_flag=True,
    help="The first values together, the second values together, and so on.",
)
@click.option(
    "--latin",
    type=click.IntRange(1, 10_000_000),
    metavar="N",
    help="N variants spread evenly (a Latin hypercube).",
)
@click.option("--seed", type=click.IntRange(0), default=0, help="Seed of --latin.  [default: 0]")
@click.option(
    "--keep",
    metavar="FIGURE",
    multiple=True,
    help="Keep this figure, such as stroke_mm.  [default: all]",
)
@set_option("Change a key for every variant.")
@click.option(
    "--build",
    "build_kinds",
    is_flag=True,
    help="Make, read back and judge the files of each variant, not only its limits.",
)
@click.option(
    "--only", metavar="KINDS", callback=kinds_of, help="With --build: only these kinds of files."
)
@click.option(
    "-j",
    "--jobs",
    type=click.IntRange(0),
    default=1,
    help="Number of cores to use; 0: all.  [default: 1]",
)
@click.option(
    "--workers",
    default="local",
    metavar="WHERE",
    help="tcp://HOST:PORT of a Dask scheduler.  [default: local]",
)
@click.option(
    "-o",
    "--out",
    type=click.Path(path_type=Path),
    help="Table, .csv or .parquet.  [default: out/<spec>-sweep.csv]",
)
def sweep(
    spec: Path,
    jobs: int,
    workers: str,
    only: frozenset[str],
    out: Path | None,
    **options: Any,
) -> None:
    """Judge many variants of SPEC: one row each, with its figures, its verdict and why it cannot be made.

    \b
      --vary geometry.base_radius=12:32:41 --vary segment.1.law=cycloidal,modified-sine

    Writes the table, and beside it a page with plots. If you stop it, the same command continues where it was.
    """
    from camgen.report.terminal import Bar
    from camgen.starters import unit_at
    from camgen.sweep import run as sweeps
    from camgen.sweep.variants import variants

    refuse_words([spec])
    table = out or Path("out") / f"{spec.stem}-sweep.csv"
    folder = table.with_suffix("").with_name(f"{table.stem}-files")
    task = sweeps.task_of(
        spec,
        variants(
            options["vary"],
            options["zipped"],
            options["latin"] or 0,
            options["seed"],
            options["grid"],
        ),
        options["settings"],
        options["keep"],
        sorted(only) if options["build_kinds"] else (),
        folder.absolute(),
    )
    jobs = jobs or os.cpu_count() or 1
    local = sweeps.Processes(jobs) if jobs > 1 else sweeps.here

    def unit(key: str) -> str:
        return unit_at(task.data, key)

    with Bar() as progress:
        engine = local if workers == "local" else sweeps.Cluster(workers)
        swept = sweeps.sweep(task, table, engine, jobs, progress, unit)
    width = {"width": get_terminal_size().columns} if sys.stdout.isatty() else {}
    for line in swept.lines(table, unit=unit, **width):
        click.echo(printable(line))
    raise click.exceptions.Exit(0 if swept.verdicts.keys() & {sweeps.HOLDS, sweeps.LIMITS} else 1)
