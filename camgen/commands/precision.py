"""`camgen bench`, `camgen tolerance`: what the accuracy of files costs, and what that of prints does."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import click

from camgen.commands.options import EXIT_CODES, json_option, out_option, set_option
from camgen.commands.running import refuse_one_name_twice
from camgen.errors import printable


@click.command(epilog=EXIT_CODES)
@click.argument("specs", metavar="[SPEC]...", nargs=-1, type=click.Path(path_type=Path))
@out_option
def bench(specs: Sequence[Path], out: Path) -> None:
    """Measure accuracy and cost of tolerances from 1e-1 to 1e-7 mm, for each SPEC, or for three starter specs.

    Makes the parts that set the motion, reads them back and prints vertices, arcs, errors, sizes and seconds by stage.
    Writes OUT/bench_tolerance/ with bench.csv, bench.md and plots. A finding fails if a file is not sound, or if
    its motion is off by more than the tolerance allows.
    """
    from camgen import starters
    from camgen.report.terminal import Bar
    from camgen.sweep import benchmark_report

    refuse_one_name_twice(specs, ())
    starter_specs = [starters.folder() / f"{name}.toml" for name in benchmark_report.STARTERS]
    with Bar() as progress:
        benches = benchmark_report.run(specs or starter_specs, out, progress)
    click.echo("\n\n".join(map(benchmark_report.to_text, benches)))
    raise click.exceptions.Exit(
        1 if any(row.faults for bench in benches for row in bench.rows) else 0
    )


@click.command(epilog=EXIT_CODES)
@click.argument("spec", type=click.Path(path_type=Path))
@set_option("Change a key, such as print.size_error=0.05.")
@click.option(
    "--samples", type=int, default=100_000, help="Number of printed copies.  [default: 100000]"
)
@click.option(
    "--seed", type=int, default=1, help="The same seed gives the same copies.  [default: 1]"
)
@click.option(
    "--worst",
    type=int,
    default=50,
    help="Number of the worst copies whose motion camgen follows in full.  [default: 50]",
)
@click.option(
    "--judged",
    type=int,
    default=50,
    help="Number of copies to judge by every finding.  [default: 50]",
)
@click.option(
    "--html", type=click.Path(path_type=Path), help="Also write tables and curves to this page."
)
@json_option
def tolerance(
    spec: Path, settings: Sequence[str], html: Path | None, as_json: bool, **counts: int
) -> None:
    """Show what print errors do to the motion of SPEC: a budget by source, and the yield of many copies."""
    from camgen.report.page import write_html
    from camgen.report.report import to_json
    from camgen.report.terminal import Bar
    from camgen.tolerance import report as tolerance_report

    with Bar() as progress:
        report = tolerance_report.tolerance(
            spec, settings, tolerance_report.PrintRun(**counts), progress
        )
    if html is not None:
        write_html(html, report)
    if as_json:
        click.echo(to_json(report), nl=False)
    else:
        click.echo(printable(tolerance_report.to_text(report), keep="\n"))
