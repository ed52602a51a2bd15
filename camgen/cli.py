"""The command line: arguments, printing, exit codes; no geometry.

Only click is imported here; each command imports what it needs, so `camgen --help` is quick.
"""

from __future__ import annotations

import gc
import io
import os
import signal
import sys
from collections.abc import Callable, Collection, Iterable, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, NoReturn

import click

from camgen import __version__, guide
from camgen.errors import CamgenError, Fault, FileError, SpecError, explained, printable
from camgen.files.formats import FORMATS, USUAL
from camgen.running import complain, each, hand_over, known, refuse_one_name_twice, show, spec_name

if TYPE_CHECKING:
    from camgen.running import Work

KINDS, ANY_KIND = (*USUAL, "report"), (*FORMATS, "report")
_COMPLETE = "_CAMGEN_COMPLETE"  # set by the shell that asks for completions: bash_source, zsh_complete, ...
INTERNAL, INTERRUPTED, PIPE_CLOSED, TERMINATED = 70, 130, 141, 143

_CODES = """\b
Exit codes:
  0  {0}
  1  {1}
  2  the spec or the command is wrong (all faults listed, nothing written)
  3  well formed, but no such mechanism exists (nothing written)
  4  a file could not be written or read
{2}130 is Ctrl-C, 70 a fault of camgen itself."""
_EXIT_CODES = _CODES.format(
    "every finding holds", "a finding fails (files are written, the table says which)",
    "Of several the worst, that is the largest, is returned. ",
)  # fmt: skip
_SWEEP_CODES = _CODES.format("some variant holds", "none holds (the table is written, and says why)", "")

_jobs = click.option("-j", "--jobs", type=click.IntRange(0), default=1, help="Cores to use, 0: all of them.  [default: 1]")
_quiet = click.option("-q", "--quiet", is_flag=True, help="Print only what fails, and notes on files gone or changed.")
_verbose = click.option("-v", "--verbose", is_flag=True, help="Print every finding in words, and every file.")
_as_json = click.option("--json", "as_json", is_flag=True, help="Print JSON: one object, or a list for several.")


def _completed(names: Callable[[], Iterable[str]]) -> Callable[..., list[str]]:
    """For a shell that completes an argument: those of the names that begin as what is typed."""
    return lambda context, parameter, begun: [name for name in names() if name.lower().startswith(begun.lower())]


def _mechanisms() -> Collection[str]:
    """Names of mechanisms."""
    from camgen.machines import MECHANISMS

    return MECHANISMS


def _specs() -> Collection[str]:
    """Names of starters and examples."""
    from camgen import starters

    return [*_mechanisms(), *starters.examples()]


def _kinds(context: click.Context, parameter: click.Parameter, value: str | None) -> frozenset[str]:
    """The kinds of files that --only names."""
    if value is None:
        return frozenset(KINDS)
    kinds = frozenset(kind.strip() for kind in value.split(","))
    wrong = sorted(kinds - set(ANY_KIND))
    if wrong:
        raise click.BadParameter(f"{', '.join(map(repr, wrong))}: a list of {', '.join(ANY_KIND)} was expected.")
    return kinds


@click.group(epilog=_EXIT_CODES, context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(__version__, prog_name="camgen")
def cli() -> None:
    """Cam and linkage CAD geometry from a text spec, with the motion proved from the written files."""


@cli.command(epilog=_EXIT_CODES)
@click.argument("specs", metavar="SPEC...", nargs=-1, required=True, type=click.Path(path_type=Path))
@click.option("-o", "--out", default="out", type=click.Path(path_type=Path), help="Output folder.  [default: out]")
@click.option("--only", metavar="KINDS", callback=_kinds, help=f"Make only these, of {','.join(ANY_KIND)}.")
@click.option("--set", "settings", metavar="KEY=VALUE", multiple=True, help="Such as segment.1.lift=8; KEY= removes it.")
@_jobs
@_as_json
@_quiet
@_verbose
def build(
    specs: Sequence[Path], out: Path, only: frozenset[str], settings: Sequence[str], jobs: int, **shown: bool
) -> None:  # fmt: skip
    """Make the parts of each SPEC, read the files back and check them; writes OUT/<name>/."""

    def work() -> Work:
        from camgen.pipeline import build as pipeline

        if len(specs) > 1:
            refuse_one_name_twice(specs, settings)
        return partial(pipeline.build, out=out, only=only, overrides=settings)

    each(specs, work, jobs, **shown)


@cli.command(epilog=_EXIT_CODES)
@click.argument("folders", metavar="FOLDER...", nargs=-1, required=True, type=click.Path(path_type=Path))
@_jobs
@_as_json
@_quiet
@_verbose
def check(folders: Sequence[Path], jobs: int, **shown: bool) -> None:
    """Judge the files of earlier builds again, from the files alone and the spec.toml beside them."""

    def work() -> Work:
        from camgen.pipeline import build as pipeline

        return pipeline.check

    each(folders, work, jobs, **shown)


@cli.command()
@click.argument("mechanism", shell_complete=_completed(_specs))
@click.argument("file", required=False, type=click.Path(path_type=Path))
@click.option("--from", "source", metavar="CHAIN", type=click.Path(path_type=Path), help="PMKS lines, or pylinkage's JSON.")
def new(mechanism: str, file: Path | None, source: Path | None) -> None:
    """Write a commented starter spec of a MECHANISM, or an example, to FILE, or print it; it builds as it is.

    camgen list names them all.

    With --from a linkage is read from a file of another program: PMKS lines, J[R, P[x, y], L[ground, crank]], or the JSON of
    pylinkage's mechanism_to_dict.
    """
    from camgen import starters
    from camgen.machines import load

    kind = starters.kind(known("MECHANISM", mechanism, _specs(), "camgen list"))
    if source is None:
        text = starters.text(mechanism)
    elif mechanism != "linkage":
        alone = "nothing here: only a linkage is read from another program"
        raise SpecError([Fault("--from", str(source), alone)], "command line")
    else:
        from camgen.machines.linkage.bridges import read_chain, spec_text

        text = spec_text(read_chain(source), spec_name(file or source), source.name)
    text = f"#:schema ./{starters.schema_name(kind)}\n{text}"
    hand_over(lambda: text, file)
    if file is None:
        click.echo(f"printed only; to save it: camgen new {mechanism} my-{mechanism}.toml", err=True)
        return
    click.echo(printable(f"wrote {file}, which builds as it is"), err=True)
    if starters.write_schema(load(kind), kind, file.parent):
        named = file.parent / starters.schema_name(kind)
        click.echo(printable(f"wrote {named}, by which an editor (Even Better TOML, taplo) explains the keys"), err=True)
    click.echo(printable(f"next: change it, then camgen build {file}"), err=True)


@cli.command(epilog=_EXIT_CODES)
@click.argument("spec", type=click.Path(path_type=Path))
@click.argument("file", required=False, type=click.Path(path_type=Path))
@click.option("--set", "settings", metavar="KEY=VALUE", multiple=True, help="Change a value: wanted.feed_range=80.")
def design(spec: Path, file: Path | None, settings: Sequence[str]) -> None:
    """Search for what SPEC's table [wanted] ([synthesis] of an indexing cam) asks; write that spec to FILE, or print it."""
    from camgen.pipeline import build as pipeline
    from camgen.spec import dump

    mechanism = pipeline.read_mechanism(spec, settings)
    found = getattr(mechanism, "designed", None)
    if found is None:
        expected = "a mechanism with a search of its own, such as thread-take-up"
        raise SpecError([Fault("mechanism", mechanism.mechanism, expected)], str(spec))
    hand_over(lambda: dump(found()), file)


@cli.command(epilog=_SWEEP_CODES)
@click.argument("spec", type=click.Path(path_type=Path))
@click.option("--vary", metavar="KEY=VALUES", multiple=True, required=True, help="KEY=A:B:N, N values from A to B; or KEY=a,b,c.")
@click.option("--grid", is_flag=True, help="Every value of each key with every one of the others: so it is anyway.")
@click.option("--zip", "zipped", is_flag=True, help="First values together, second values together, and so on.")
@click.option("--latin", type=click.IntRange(1, 10_000_000), metavar="N", help="N variants spread evenly (a Latin hypercube).")
@click.option("--seed", type=click.IntRange(0), default=0, help="Of --latin.  [default: 0]")
@click.option("--keep", metavar="FIGURE", multiple=True, help="Keep this figure, such as stroke_mm.  [default: all]")
@click.option("--set", "settings", metavar="KEY=VALUE", multiple=True, help="The same for every variant.")
@click.option("--build", "build_kinds", is_flag=True, help="Make, read back and judge the files of each, not its limits alone.")
@click.option("--only", metavar="KINDS", callback=_kinds, help="With --build: only these kinds of files.")
@click.option("-j", "--jobs", type=click.IntRange(0), default=1, help="Cores to use, 0: all of them.  [default: 1]")
@click.option("--workers", default="local", metavar="WHERE", help="tcp://HOST:PORT of a Dask scheduler.  [default: local]")
@click.option("-o", "--out", type=click.Path(path_type=Path), help="Table, .csv or .parquet.  [default: out/<spec>-sweep.csv]")
def sweep(
    spec: Path, vary: Sequence[str], grid: bool, zipped: bool, latin: int | None, seed: int, keep: Sequence[str],
    settings: Sequence[str], build_kinds: bool, only: frozenset[str], jobs: int, workers: str, out: Path | None,
) -> None:  # fmt: skip
    """Judge many variants of SPEC: one row each, with its figures, its verdict and why it cannot be made.

    \b
      --vary geometry.base_radius=12:32:41 --vary segment.1.law=cycloidal,modified-sine

    Writes the table, and beside it a page with plots. Killed on the way, the same command goes on where it was.
    """
    from camgen.pipeline import sweep as sweeps
    from camgen.pipeline.variants import variants
    from camgen.report.terminal import Bar

    table = out or Path("out") / f"{spec.stem}-sweep.csv"
    folder = table.with_suffix("").with_name(f"{table.stem}-files")
    kinds = sorted(only) if build_kinds else ()
    task = sweeps.prepared(spec, variants(vary, zipped, latin or 0, seed, grid), settings, keep, kinds, folder.absolute())
    jobs = jobs or os.cpu_count() or 1
    local = sweeps.Processes(jobs) if jobs > 1 else sweeps.here
    with Bar() as progress:
        swept = sweeps.sweep(task, table, local if workers == "local" else sweeps.Cluster(workers), jobs, progress)
    for line in swept.lines(table):
        click.echo(printable(line))
    raise click.exceptions.Exit(0 if swept.verdicts.get(sweeps.HOLDS) else 1)


@cli.command(epilog=_EXIT_CODES)
@click.argument("file", type=click.Path(path_type=Path))
@click.option("--follower", required=True, metavar="TABLE", help="The follower: a TOML file, or KEY=VALUE,... as above.")
@click.option("--second-follower", metavar="TABLE", help="A second tip on the same follower, for the lash of the pair.")
@click.option("--second", type=click.Path(path_type=Path), help="Outline under the second tip.  [default: FILE]")
@click.option("--height", type=float, help="Height of a mesh's section, mm.  [default: half way up]")
@click.option("--layer", help="Layer of a DXF that holds the outline.  [default: all]")
@click.option("--line-width", type=float, help="Of G-code that does not say it (CuraEngine), mm.")
@click.option("--dpi", type=float, help="Dots per inch of a scan.  [default: as its file says]")
@click.option("--second-scan", "others", multiple=True, type=click.Path(path_type=Path), help="The part again, turned by 90 deg.")
@click.option("--across", type=click.FloatRange(0.1), help="Greatest width of a scanned part by a caliper, mm.")
@click.option("--against", type=click.Path(path_type=Path), help="SPEC of the cam: lay the outline on it, compare the motion.")
@click.option("--harmonics", type=click.IntRange(1, 1800), default=36, help="Low-pass of speed, acceleration.  [default: 36]")
@click.option("-o", "--out", default="out", type=click.Path(path_type=Path), help="Output folder.  [default: out]")
@_as_json
@_quiet
@_verbose
def motion(
    file: Path, follower: str, second_follower: str | None, second: Path | None, height: float | None, layer: str | None,
    line_width: float | None, dpi: float | None, others: Sequence[Path], across: float | None, against: Path | None,
    harmonics: int, out: Path, **shown: bool,
) -> None:  # fmt: skip
    """Roll a follower on the outline in FILE (DXF, STL, 3MF of any maker, G-code, a scan, points) and report its motion.

    The largest closed contour is the outline; the cam turns counter-clockwise about the shaft. TABLE is a TOML file with
    a table [follower], or its keys on one line:

    \b
      --follower oscillating,pivot=60/0,arm=67.082,at_deg=-153.435,radius=3
      --follower translating,radius=6,offset=0       --follower translating,shape=flat
    \b
      shape          roller (a round tip as well), knife or flat  [roller]
      radius         of the roller or round tip, mm
      contour=N      on which closed contour of FILE it rides: 1 the largest, 2 the next...
      inside=true    it touches that contour from within, as the outer wall of a groove
      centre=X/Y     place of the shaft in FILE  [0/0]
      flipped=true   the outline is turned over about Oy first; turned_deg=A: then turned by A
    \b
    oscillating:
      pivot=X/Y      axle of the arm, seen from the shaft, mm
      arm            length from axle to tip centre, mm
      at_deg         direction of the arm (axle to tip; flat: of the face's normal, away from the
                     shaft) from which its angle is counted
      leaves=+1|-1   instead of at_deg: sense that takes it away from the shaft, +1 is ccw;
                     the angle then counts from the innermost position
      face_offset    flat, instead of arm: how far the face lies ahead of the pivot, mm  [0]
    \b
    translating:
      direction_deg  way out of the follower, ccw from Ox  [90]
      offset         of the tip's line from the shaft, positive to the right of the way out  [0]
      at             distance of tip centre or face from the shaft from which its way is counted;
                     otherwise it counts from the innermost position

    A scan (PNG, JPEG, TIFF; pip install 'camgen[scan]') shows one part on an even ground; its bore is the shaft. Points are
    a CSV with columns x,y in order or angle,radius, mm and degrees.

    Writes OUT/<file>-motion/ with report.html, report.json and motion.csv: displacement, speed,
    acceleration, pressure angle.
    """

    def work() -> Work:
        from camgen.files.scan import Scanning
        from camgen.pipeline import outline_motion

        scanning = Scanning(dpi, tuple(others), across)
        asked = (follower, second_follower, second, height, layer, harmonics, line_width, scanning, against)
        request = outline_motion.Request(*asked)
        return lambda path, progress, jobs: outline_motion.run(path, request, out, progress)

    each([file], work, **shown)


@cli.command(epilog=_EXIT_CODES)
@click.argument("specs", metavar="[SPEC]...", nargs=-1, type=click.Path(path_type=Path))
@click.option("-o", "--out", default="out", type=click.Path(path_type=Path), help="Output folder.  [default: out]")
def bench(specs: Sequence[Path], out: Path) -> None:
    """Measure what tolerances from 1e-1 to 1e-7 mm buy and cost, for each SPEC, or for three starter specs.

    Makes the parts that set the motion, reads them back and prints vertices, arcs, errors, sizes and seconds by stage.
    Writes OUT/bench_tolerance/ with bench.csv, bench.md and plots. A finding that fails is a file that is not sound, or a
    motion that is further off than its tolerance allows.
    """
    from camgen import starters
    from camgen.pipeline import benchmark_report
    from camgen.report.terminal import Bar

    refuse_one_name_twice(specs, ())
    own = [starters.folder() / f"{name}.toml" for name in benchmark_report.STARTERS]
    with Bar() as progress:
        benches = benchmark_report.run(specs or own, out, progress)
    click.echo("\n\n".join(map(benchmark_report.to_text, benches)))
    raise click.exceptions.Exit(1 if any(row.faults for bench in benches for row in bench.rows) else 0)


@cli.command(epilog=_EXIT_CODES)
@click.argument("spec", type=click.Path(path_type=Path))
@click.option("--set", "settings", metavar="KEY=VALUE", multiple=True, help="Such as print.size_error=0.05.")
@click.option("--samples", type=int, default=100_000, help="Printed copies.  [default: 100000]")
@click.option("--seed", type=int, default=1, help="The same seed gives the same copies.  [default: 1]")
@click.option("--worst", type=int, default=10, help="How many of the worst are really rolled and closed.  [default: 10]")
@click.option("--html", type=click.Path(path_type=Path), help="Write tables and curves to this page, too.")
@_as_json
def tolerance(
    spec: Path, settings: Sequence[str], samples: int, seed: int, worst: int, html: Path | None, as_json: bool
) -> None:  # fmt: skip
    """What print errors do to the motion of SPEC: a budget by where they arise, and the yield of many copies."""
    from camgen.pipeline import tolerance_report
    from camgen.report.report import to_json, write_html
    from camgen.report.terminal import Bar

    with Bar() as progress:
        report = tolerance_report.tolerance(spec, settings, samples, seed, worst, progress)
    if html is not None:
        write_html(html, report)
    if as_json:
        click.echo(to_json(report), nl=False)
    else:
        click.echo(printable(tolerance_report.to_text(report), keep="\n"))


_browser = click.option("--open", "browser", is_flag=True, help="Open the page in a browser.")
_port = click.option("--port", type=click.IntRange(0, 65535), default=0, help="Of this machine.  [default: a free one]")


@cli.command(epilog=_EXIT_CODES)
@click.argument("spec", type=click.Path(path_type=Path))
@click.option("-o", "--out", default="out", type=click.Path(path_type=Path), help="Output folder.  [default: out]")
@_port
@_browser
def watch(spec: Path, **served: Any) -> None:
    """Build SPEC each time it is saved, and show its report on a page that this machine alone can open."""
    from camgen.live import run

    run.watch(spec, say=_say, **served)


@cli.command(epilog=_EXIT_CODES)
@click.argument("spec", type=click.Path(path_type=Path))
@click.option("-o", "--out", default="out", type=click.Path(path_type=Path), help="Of full builds.  [default: out]")
@_port
@_browser
def explore(spec: Path, **served: Any) -> None:
    """Show SPEC with sliders for its numbers, on a page that this machine alone can open; saved when you ask for it."""
    from camgen.live import run

    run.explore(spec, say=_say, **served)


def _say(text: str) -> None:
    click.echo(printable(text))


@cli.command("list")
def list_() -> None:
    """List the mechanisms and the laws of motion."""
    from camgen import starters
    from camgen.machines import MECHANISMS
    from camgen.motion.laws import LAWS
    from camgen.motion.segments import ABOUT, FAMILIES

    click.echo("Mechanisms")
    for name in MECHANISMS:
        click.echo(f"  {name:<20} {starters.summary(name)}")
    click.echo("\nExamples")
    for name in starters.examples():
        click.echo(f"  {name:<20} {starters.summary(name)}")
    click.echo(f"\n{'Laws of motion':<22}{'C_v':>8}{'C_a':>9}{'C_j':>9}  peaks of v, a, j inside a rise of 1 in unit time")
    for law in LAWS.values():
        click.echo(f"  {law.name:<20}{law.c_v:>8.4f}{law.c_a:>9.4f}{law.c_j:>9.3f}  {law.source}")
    click.echo('\nLaws with parameters, as law = { name = "...", KEY = ... }')
    for name, about in ABOUT.items():
        click.echo(f"  {name:<20} {', '.join(FAMILIES.get(name, ())) or 'no key'}: {about}")


@cli.command()
@click.argument("mechanism", shell_complete=_completed(_mechanisms))
def schema(mechanism: str) -> None:
    """Print the JSON Schema of a MECHANISM's spec, for editors."""
    from camgen import starters
    from camgen.machines import load

    click.echo(starters.schema_text(load(known("MECHANISM", mechanism, _mechanisms(), "camgen list")), mechanism), nl=False)


@cli.command()
@click.argument("codes", metavar="[CODE]...", nargs=-1, shell_complete=_completed(guide.entries))
def explain(codes: Sequence[str]) -> None:
    """Say what a finding means, its formula, where its limit comes from and what helps; without a CODE, list them."""
    entries = guide.entries()
    if codes:
        asked = [known("CODE", code.upper().replace("-", "_"), entries, "camgen explain") for code in codes]
        show("\n".join(entries[code] for code in asked))
        return
    for code, entry in entries.items():
        click.echo(f"{code:<20} {guide.in_short(entry)}")


@cli.command("guide")
@click.argument("topic", required=False, shell_complete=_completed(lambda: guide.TOPICS))
def guide_(topic: str | None) -> None:
    """Show a page of the guide; without a TOPIC, list them."""
    if topic is None:
        click.echo("".join(f"camgen guide {name:<28} {guide.title(name)}\n" for name in guide.TOPICS), nl=False)
    else:
        show(guide.page(known("TOPIC", topic, guide.TOPICS, "camgen guide")))


@cli.command()
def selftest() -> None:
    """Print published constants, and what the five papers print, beside ours; exit 1 if one is off."""
    from camgen.machines.selftest import rows, to_text

    found = list(rows())
    click.echo(to_text(found))
    raise click.exceptions.Exit(0 if all(row.ok for row in found) else 1)


def main(arguments: Sequence[str] | None = None) -> NoReturn:
    """Run the command line and exit; a user's mistake ends in a message and its exit code, never in a traceback."""
    for asked in (signal.SIGTERM, *([signal.SIGHUP] if hasattr(signal, "SIGHUP") else [])):
        if signal.getsignal(asked) is not signal.SIG_IGN:  # such as under nohup
            signal.signal(asked, lambda *_: sys.exit(TERMINATED))  # so that half-made folders are cleared away
    if isinstance(sys.stdout, io.TextIOWrapper):  # a file name may hold what stdout's encoding does not
        sys.stdout.reconfigure(errors="backslashreplace")
    try:
        code = _run(arguments)
        if sys.stdout is not None:
            sys.stdout.flush()
    except BrokenPipeError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), 1)  # nobody reads on: let the last flush go nowhere
        code = PIPE_CLOSED
    except OSError as error:
        complain(explained(error))
        os.dup2(os.open(os.devnull, os.O_WRONLY), 1)
        code = FileError.exit_code
    gc.freeze()  # the last collection, as Python ends, would go through all that was made: a tenth of the time
    sys.exit(code)


def _run(arguments: Sequence[str] | None) -> int:
    """Exit code of a run, errors printed."""
    if sys.stdout is None:  # closed by the shell: print into nothing
        sys.stdout = open(os.devnull, "w", encoding="utf-8")  # noqa: SIM115
    if _COMPLETE in os.environ:
        from click.shell_completion import shell_complete

        return shell_complete(cli, {}, "camgen", _COMPLETE, os.environ[_COMPLETE])
    gc.disable()  # a run is over before its garbage counts; collecting costs a tenth of the time, most of it at imports
    try:
        # Not cli.main, which turns a closed pipe into exit code 1: here that means a finding that fails.
        with cli.make_context("camgen", list(sys.argv[1:] if arguments is None else arguments)) as context:
            cli.invoke(context)
    except click.exceptions.Exit as done:
        return done.exit_code
    except KeyboardInterrupt:
        click.echo("interrupted; earlier results are as they were", err=True)
        return INTERRUPTED
    except click.ClickException as error:
        told = io.StringIO()
        error.show(told)
        click.echo(printable(told.getvalue(), keep="\n"), nl=False, err=True)
        return error.exit_code
    except CamgenError as error:
        complain(error)
        return error.exit_code
    except OSError:
        raise
    except Exception as error:
        place = error.__traceback__
        while place is not None and place.tb_next is not None:
            place = place.tb_next
        at = f"{Path(place.tb_frame.f_code.co_filename).name}:{place.tb_lineno}" if place else "?"
        said = f"internal error: {type(error).__name__}: {error} ({at}); please report it with the spec"
        click.echo(printable(said, keep="\n"), err=True)
        return INTERNAL
    return 0
