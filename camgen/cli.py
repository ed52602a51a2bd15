"""The command line: arguments, printing, exit codes; no geometry.

Only click is imported here; each command imports what it needs, so `camgen --help` is quick.
"""

from __future__ import annotations

import gc
import io
import os
import re
import signal
import sys
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, NoReturn

import click

from camgen import __version__
from camgen.errors import CamgenError, DesignError, Fault, FileError, SpecError, explained, printable
from camgen.files.formats import FORMATS, USUAL

if TYPE_CHECKING:
    from camgen.machines.mechanism import Mechanism
    from camgen.report.report import Report

KINDS, ANY_KIND = (*USUAL, "report"), (*FORMATS, "report")
INTERNAL, INTERRUPTED, PIPE_CLOSED, TERMINATED = 70, 130, 141, 143

_EXIT_CODES = """\b
Exit codes:
  0  every finding holds
  1  a finding fails (files are written, the table says which)
  2  the spec or the command is wrong (all faults listed, nothing written)
  3  well formed, but no such mechanism exists (nothing written)
  4  a file could not be written or read
Of several the worst, that is the largest, is returned. 130 is Ctrl-C, 70 a fault of camgen itself."""

_jobs = click.option("-j", "--jobs", type=click.IntRange(0), default=1, help="Cores to use, 0: all of them.  [default: 1]")
_as_json = click.option("--json", "as_json", is_flag=True, help="Print JSON: one object, or a list for several.")


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
def build(
    specs: Sequence[Path], out: Path, only: frozenset[str], settings: Sequence[str], jobs: int, as_json: bool
) -> None:  # fmt: skip
    """Make the parts of each SPEC, read the files back and check them; writes OUT/<name>/."""
    from camgen.pipeline import build as pipeline

    if len(specs) > 1:
        _refuse_one_name_twice(specs, settings)
    _each(specs, partial(pipeline.build, out=out, only=only, overrides=settings), as_json, jobs)


@cli.command(epilog=_EXIT_CODES)
@click.argument("folders", metavar="FOLDER...", nargs=-1, required=True, type=click.Path(path_type=Path))
@_jobs
@_as_json
def check(folders: Sequence[Path], jobs: int, as_json: bool) -> None:
    """Judge the files of earlier builds again, from the files alone and the spec.toml beside them."""
    from camgen.pipeline import build as pipeline

    _each(folders, pipeline.check, as_json, jobs)


@cli.command()
@click.argument("mechanism")
@click.argument("file", required=False, type=click.Path(path_type=Path))
@click.option("--from", "source", metavar="CHAIN", type=click.Path(path_type=Path), help="PMKS lines, or pylinkage's JSON.")
def new(mechanism: str, file: Path | None, source: Path | None) -> None:
    """Write a commented starter spec of a MECHANISM to FILE, or print it; it builds as it is.

    With --from a linkage is read from a file of another program: PMKS lines, J[R, P[x, y], L[ground, crank]], or the JSON of
    pylinkage's mechanism_to_dict.
    """
    _known(mechanism)
    if source is None:
        text = (_starters() / f"{mechanism}.toml").read_text(encoding="utf-8")
    elif mechanism != "linkage":
        alone = "nothing here: only a linkage is read from another program"
        raise SpecError([Fault("--from", str(source), alone)], "command line")
    else:
        from camgen.machines.linkage.bridges import read_chain, spec_text

        text = spec_text(read_chain(source), _spec_name(file or source), source.name)
    _hand_over(text, file)
    if file is None:
        click.echo(f"printed only; to save it: camgen new {mechanism} my-{mechanism}.toml", err=True)


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
    _hand_over(dump(found()), file)


@cli.command(epilog=_EXIT_CODES)
@click.argument("file", type=click.Path(path_type=Path))
@click.option("--follower", required=True, metavar="TABLE", help="The follower: a TOML file, or KEY=VALUE,... as above.")
@click.option("--second-follower", metavar="TABLE", help="A second tip on the same follower, for the lash of the pair.")
@click.option("--second", type=click.Path(path_type=Path), help="Outline under the second tip.  [default: FILE]")
@click.option("--height", type=float, help="Height of a mesh's section, mm.  [default: half way up]")
@click.option("--layer", help="Layer of a DXF that holds the outline.  [default: all]")
@click.option("--line-width", type=float, help="Of G-code that does not say it (CuraEngine), mm.")
@click.option("--harmonics", type=click.IntRange(1, 1800), default=36, help="Low-pass of speed, acceleration.  [default: 36]")
@click.option("-o", "--out", default="out", type=click.Path(path_type=Path), help="Output folder.  [default: out]")
@_as_json
def motion(
    file: Path, follower: str, second_follower: str | None, second: Path | None, height: float | None, layer: str | None,
    line_width: float | None, harmonics: int, out: Path, as_json: bool,
) -> None:  # fmt: skip
    """Roll a follower on the outline in FILE (DXF, STL, 3MF of any maker, G-code of a sliced part) and report its motion.

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

    Writes OUT/<file>-motion/ with report.html, report.json and motion.csv: displacement, speed,
    acceleration, pressure angle.
    """
    from camgen.pipeline import outline_motion

    request = outline_motion.Request(follower, second_follower, second, height, layer, harmonics, line_width)
    _each([file], lambda path, progress, jobs: outline_motion.run(path, request, out, progress), as_json)


@cli.command(epilog=_EXIT_CODES)
@click.argument("specs", metavar="[SPEC]...", nargs=-1, type=click.Path(path_type=Path))
@click.option("-o", "--out", default="out", type=click.Path(path_type=Path), help="Output folder.  [default: out]")
def bench(specs: Sequence[Path], out: Path) -> None:
    """Measure what tolerances from 1e-1 to 1e-7 mm buy and cost, for each SPEC, or for three starter specs.

    Makes the parts that set the motion, reads them back and prints vertices, arcs, errors, sizes and seconds by stage.
    Writes OUT/bench_tolerance/ with bench.csv, bench.md and plots. A finding that fails is a file that is not sound, or a
    motion that is further off than its tolerance allows.
    """
    from camgen.pipeline import benchmark_report
    from camgen.report.terminal import Bar

    _refuse_one_name_twice(specs, ())
    starters = [_starters() / f"{name}.toml" for name in benchmark_report.STARTERS]
    with Bar() as progress:
        benches = benchmark_report.run(specs or starters, out, progress)
    click.echo("\n\n".join(map(benchmark_report.to_text, benches)))
    raise click.exceptions.Exit(1 if any(row.faults for bench in benches for row in bench.rows) else 0)


@cli.command("list")
def list_() -> None:
    """List the mechanisms and the laws of motion."""
    from camgen.machines import MECHANISMS
    from camgen.motion.laws import LAWS
    from camgen.motion.segments import ABOUT, FAMILIES

    click.echo("Mechanisms")
    for name in MECHANISMS:
        summary = (_starters() / f"{name}.toml").read_text(encoding="utf-8").partition("\n")[0].lstrip("# ")
        click.echo(f"  {name:<20} {summary}")
    click.echo(f"\n{'Laws of motion':<22}{'C_v':>8}{'C_a':>9}{'C_j':>9}  peaks of v, a, j inside a rise of 1 in unit time")
    for law in LAWS.values():
        click.echo(f"  {law.name:<20}{law.c_v:>8.4f}{law.c_a:>9.4f}{law.c_j:>9.3f}  {law.source}")
    click.echo('\nLaws with parameters, as law = { name = "...", KEY = ... }')
    for name, about in ABOUT.items():
        click.echo(f"  {name:<20} {', '.join(FAMILIES.get(name, ())) or 'no key'}: {about}")


@cli.command()
@click.argument("mechanism")
def schema(mechanism: str) -> None:
    """Print the JSON Schema of a MECHANISM's spec, for editors."""
    import json

    from camgen import spec

    click.echo(json.dumps(spec.schema(_known(mechanism), mechanism), indent=2, ensure_ascii=False))


@cli.command()
def selftest() -> None:
    """Print published constants beside those computed here; exit 1 if one is off."""
    from camgen.machines.selftest import rows

    click.echo(f"{'constant':<44}{'published':>18}{'here':>20}")
    found = list(rows())
    for row in found:
        click.echo(f"{row.what:<44}{row.published:>18}{row.ours:>20.10g}{'' if row.ok else '  OFF'}")
    off = sum(not row.ok for row in found)
    click.echo(f"{off} of {len(found)} constants are OFF" if off else f"{len(found)} constants agree")
    raise click.exceptions.Exit(1 if off else 0)


# ---- what the commands share -----------------------------------------------------------------------------------------


def _known(name: str) -> type[Mechanism]:
    """The class of a mechanism; SpecError with the nearest name where there is none."""
    from camgen.machines import MECHANISMS, load
    from camgen.spec import unknown

    if name not in MECHANISMS:
        raise SpecError([unknown("MECHANISM", name, MECHANISMS)], "command line")
    return load(name)


def _spec_name(file: Path) -> str:
    """A name for a spec, after a file's."""
    return "-".join(re.findall(r"[a-z0-9]+", file.stem.lower()))[:60].strip("-") or "linkage"


def _hand_over(text: str, file: Path | None) -> None:
    """Print the text, or write it to a new file."""
    if file is None:
        click.echo(printable(text, keep="\n"), nl=False)
        return
    try:
        with open(file, "x", encoding="utf-8") as stream:
            stream.write(text)
    except FileExistsError:
        raise FileError(file, "exists already and is left as it is; choose another name") from None


def _refuse_one_name_twice(specs: Sequence[Path], settings: Sequence[str]) -> None:
    """SpecError where two specs would write the same folder; specs that cannot be read are told when their turn comes."""
    from camgen.pipeline import build as pipeline

    first: dict[str, Path] = {}
    for spec in specs:
        try:
            name = pipeline.read_mechanism(spec, settings).name
        except CamgenError:
            continue
        if name in first:
            raise SpecError([Fault("name", repr(name), f"another name, for {first[name]} writes that folder")], str(spec))
        first[name] = spec


def _starters() -> Path:
    """Folder of the starter specs: inside the installed package, or beside it in a checkout."""
    package = Path(__file__).parent
    return next(folder for folder in (package / "specs", package.parent / "specs") if folder.is_dir())


def _each(paths: Sequence[Path], work: Callable[..., Report], as_json: bool, jobs: int = 1) -> NoReturn:
    """Do the work on each path, print what came out in their order, and end with the worst exit code.

    Several paths are shared out to the cores; for a single one the work shares out its own steps.
    """
    from camgen.pipeline.jobs import Workers
    from camgen.report.terminal import Bar, print_report

    jobs = jobs or os.cpu_count() or 1
    shared = len(paths) > 1 and jobs > 1
    worst, records = 0, []
    with Workers(min(jobs, len(paths)) if shared else 1) as workers:
        started = [workers.start(work, path) for path in paths] if shared else []
        for k, path in enumerate(paths):
            try:
                with Bar() as progress:
                    if shared:
                        progress(f"{path}, {k + 1} of {len(paths)}", k / len(paths))
                        report = started[k]()
                    else:
                        report = work(path, progress=progress, jobs=jobs)
            except (CamgenError, OSError) as error:
                failure = explained(error)
                worst = max(worst, failure.exit_code)
                _complain(failure, path)
                records.append(_failure_record(path, failure))
                continue
            worst = max(worst, 0 if report.ok else 1)
            records.append(report.as_dict())
            if not as_json:
                print_report(report)
    if as_json:
        import json

        text = json.dumps(records[0] if len(records) == 1 else records, indent=2, ensure_ascii=False)
        click.echo("".join(c if c.isprintable() or c == "\n" else json.dumps(c)[1:-1] for c in text))
    raise click.exceptions.Exit(worst)


def _complain(error: CamgenError, source: Path | None = None) -> None:
    """Print a user's error on stderr, with the spec's name where the error does not say it by itself."""
    named = f"{source}: " if source is not None and isinstance(error, DesignError) else ""
    click.echo(printable(f"error: {named}{error}", keep="\n"), err=True)


def _failure_record(path: Path, error: CamgenError) -> dict[str, Any]:
    """What --json prints in place of a report that could not be made."""
    faults = [vars(fault) for fault in error.faults] if isinstance(error, SpecError) else []
    return {"source": str(path), "ok": False, "exit_code": error.exit_code, "error": str(error), "faults": faults}


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
        _complain(explained(error))
        os.dup2(os.open(os.devnull, os.O_WRONLY), 1)
        code = FileError.exit_code
    gc.freeze()  # the last collection, as Python ends, would go through all that was made: a tenth of the time
    sys.exit(code)


def _run(arguments: Sequence[str] | None) -> int:
    """Exit code of a run, errors printed."""
    if sys.stdout is None:  # closed by the shell: print into nothing
        sys.stdout = open(os.devnull, "w", encoding="utf-8")  # noqa: SIM115
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
        _complain(error)
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
