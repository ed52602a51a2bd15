"""`camgen motion`: a follower rolled on any outline or drum, one outline that drives another, or a servo drive by its cam table."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from camgen.commands.options import (
    EXIT_CODES,
    json_option,
    out_option,
    quiet_option,
    verbose_option,
)
from camgen.commands.running import each
from camgen.errors import FileError

if TYPE_CHECKING:
    from camgen.commands.running import Work
    from camgen.measuring.drives import Drive
    from camgen.measuring.outlines import Hints


def _ratio(context: click.Context, option: click.Parameter, value: str | None) -> float | None:
    """A number, or a fraction of two."""
    from camgen.settings import quotient

    ratio = None if value is None else quotient(value)
    if ratio is None or isinstance(ratio, float):
        return ratio
    raise click.BadParameter(f"{value!r} is no ratio such as -12/30 or -0.4")


def _place(context: click.Context, option: click.Parameter, value: str | None) -> complex | None:
    """X/Y, mm."""
    if value is None:
        return None
    try:
        x, y = map(float, value.split("/"))
    except ValueError:
        raise click.BadParameter(f"{value!r} is no place such as 42/0") from None
    return complex(x, y)


# options that go with --drives alone
_OF_DRIVES = (
    "distance",
    "slides",
    "ratio",
    "tolerance",
    "spring",
    "inside",
    "start",
    "centre",
    "driven_centre",
)
# and those that go with --follower alone
_OF_FOLLOWER = ("second_follower", "second", "against")
# of what reads an outline, which a roller in a drum does not
_OF_OUTLINES = ("height", "layer", "line_width", "dpi", "others", "across", "probe")


@click.command(epilog=EXIT_CODES)
@click.argument("file", type=click.Path(path_type=Path))
@click.option(
    "--follower",
    metavar="TABLE",
    help="The follower: a TOML file, or KEY=VALUE,... as above.",
)
@click.option(
    "--roller",
    metavar="TABLE",
    help="In place of a follower: the roller in the track of a drum, whose mesh is FILE.",
)
@click.option(
    "--drives",
    metavar="DRIVEN",
    type=click.Path(path_type=Path),
    help="In place of a follower: the outline that FILE drives.",
)
@click.option("--distance", type=float, metavar="A", help="The driven pivot is at (A, 0), mm.")
@click.option(
    "--slides",
    type=float,
    metavar="DEG",
    help="In place of --distance: the driven outline slides in that direction.",
)
@click.option(
    "--ratio",
    callback=_ratio,
    metavar="R",
    help="Turns of the driven outline for one turn of the driver, such as -12/30 or -0.4; below 0 it turns the other way. For a slide: mm per radian.",
)
@click.option(
    "--tolerance",
    type=float,
    metavar="DEG",
    help="Limit of the transmission error, peak to peak, deg (mm on a slide).",
)
@click.option(
    "--spring",
    type=click.Choice(["low", "high"]),
    help="Where a spring holds the driven outline: at the low or the high end of its play.",
)
@click.option(
    "--driven-inside",
    "inside",
    is_flag=True,
    help="The driver runs inside the driven contour, as in an inner gear.",
)
@click.option(
    "--start-deg",
    "start",
    type=float,
    default=0.0,
    help="Angle near which the driven outline begins, deg (mm on a slide).  [default: 0, as drawn]",
)
@click.option(
    "--centre",
    callback=_place,
    metavar="X/Y",
    help="Place of the driver's pivot in FILE, mm.  [default: 0/0]",
)
@click.option(
    "--driven-centre",
    callback=_place,
    metavar="X/Y",
    help="Place of the driven pivot in DRIVEN, mm.  [default: 0/0]",
)
@click.option(
    "--second-follower",
    metavar="TABLE",
    help="A second tip on the same follower, for the play of the pair.",
)
@click.option(
    "--second",
    type=click.Path(path_type=Path),
    help="Outline under the second tip.  [default: FILE]",
)
@click.option(
    "--height", type=float, help="Height of a mesh's section, mm.  [default: half way up]"
)
@click.option("--layer", help="Layer of a DXF that holds the outline.  [default: all]")
@click.option(
    "--line-width",
    type=float,
    help="Width of the printed lines, mm, if the G-code does not say it (CuraEngine).",
)
@click.option("--dpi", type=float, help="Dots per inch of a scan.  [default: as its file says]")
@click.option(
    "--second-scan",
    "others",
    multiple=True,
    type=click.Path(path_type=Path),
    help="A second scan of the part, turned by 90 deg.",
)
@click.option(
    "--across",
    type=click.FloatRange(0.1),
    help="Greatest width of the scanned part, measured with a caliper, mm.",
)
@click.option(
    "--probe",
    type=click.FloatRange(0, 1000),
    default=0.0,
    help="Radius of the probe's ball, mm, if points are its centres.",
)
@click.option(
    "--against",
    type=click.Path(path_type=Path),
    help="SPEC of the cam: camgen fits the outline to it and compares the motion.",
)
@click.option(
    "--harmonics",
    type=click.IntRange(1, 1800),
    default=36,
    help="Harmonics of a turn that the low-pass filter of speed and acceleration keeps.  [default: 36]",
)
@out_option
@json_option
@quiet_option
@verbose_option
def motion(
    file: Path, out: Path, as_json: bool, quiet: bool, verbose: bool, **options: Any
) -> None:
    """Roll a follower on the outline in FILE (DXF, mesh, G-code, scan or points of any maker), or let it drive another outline.

    The largest closed contour is the outline; the cam turns counter-clockwise about the shaft. TABLE is a TOML file with
    a table [follower], or its keys on one line:

    \b
      --follower oscillating,pivot=60/0,arm=67.082,at_deg=-153.435,radius=3
      --follower translating,radius=6,offset=0       --follower translating,shape=flat
    \b
      shape          roller (a round tip as well), knife or flat  [roller]
      radius         of the roller or round tip, mm
      contour=N      closed contour of FILE on which it rides: 1 the largest, 2 the next...
      inside=true    it touches that contour from within, as the outer wall of a groove
      centre=X/Y     place of the shaft in FILE  [0/0]
      flipped=true   the outline is turned over about Oy first; turned_deg=A: then turned by A
    \b
    oscillating:
      pivot=X/Y      pivot of the arm, seen from the shaft, mm
      arm            length from pivot to tip centre, mm
      at_deg         direction of the arm (pivot to tip; flat: of the face's normal, away from the
                     shaft) from which its angle is counted
      leaves=+1|-1   instead of at_deg: sense that takes it away from the shaft, +1 is ccw;
                     the angle then counts from the innermost position
      face_offset    flat, instead of arm: how far the face lies ahead of the pivot, mm  [0]
    \b
    translating:
      direction_deg  direction in which the follower moves out, ccw from Ox  [90]
      offset         how far the tip's line is from the shaft, positive to the right of that direction  [0]
      at             distance from shaft to tip centre or face at which the travel is 0;
                     without it the travel counts from the innermost position

    A mesh is one part: STL, 3MF, OBJ, PLY, OFF or GLB. OBJ, PLY, OFF and STL name no unit: camgen takes them as mm with z up. A GLB
    is in metres with y up.

    A scan (PNG, JPEG, TIFF; with the extra "scan") shows one part on a plain background; its bore is the shaft. Points are
    a CSV with columns x,y in order or angle,radius, mm and degrees.

    Writes OUT/<file>-motion/ with report.html, report.json and motion.csv: displacement, speed,
    acceleration, pressure angle.

    \b
      camgen motion pinion.dxf --drives wheel.dxf --distance 42 --ratio -12/30 --tolerance 0.01
    lets one outline drive another. Each turns about its file's origin, or about --centre. motion.csv has both ends of the
    play of the driven outline, every quarter degree of the driver. Writes OUT/<file>-drives-<driven>/.

    \b
      camgen motion drum.stl --roller radius=5,length=8,inner=22
    rolls a roller round the track of a cylinder cam, on the mesh itself. TABLE is a TOML file with a table [roller], or its keys:

    \b
      radius         radius half way along the roller, mm;   length: its length
      inner          distance of the roller's inner end from the drum's axis, mm
      cone_deg       half angle of a conical roller, positive where it grows outwards  [0]
      track          groove, end (on the wall below it, by a spring) or rib (two rollers)  [groove]
      distance       between the axes of the two rollers on a rib, mm
      axis=x|y|z     the drum's axis in FILE  [z];   centre=X/Y: where it passes (x: Y/Z, y: Z/X)  [0/0]
      at_deg         where the roller stands, ccw from the first axis of centre  [0]
      offset         how far a sliding roller is beside the radial line, mm, positive ccw  [0]
      arm, pivot=Y/Z instead: length of an arm, its pivot beside the radial line and along the axis
      height         roughly where the roller's axis is, if there are several tracks
      tolerance      tolerance of the mesh's facets, mm, which GROOVE_FIT allows for  [0.001]

    \b
      camgen motion disc-cam-contact-codesys.st --against disc-cam.toml
    reads a cam table of a servo drive: a file of `camgen build --only servo` (CODESYS, TwinCAT, S7), or a CSV
    of master (deg) and slave.
    """

    _refuse_mixed(options, file)

    def work() -> Work:
        from camgen.measuring import drives, drum, servo
        from camgen.measuring import motion as outline_motion

        if options["roller"] is not None:
            table = options["roller"]
            turns = options["harmonics"]
            return lambda path, progress, jobs: drum.run(path, table, turns, out, progress)
        if options["follower"] is None and options["drives"] is None:
            return lambda path, progress, jobs: servo.run(path, options["against"], out, progress)
        hints = _hints(options)
        if options["drives"] is not None:
            wanted = drives.Request(options["drives"], _drive(options), options["tolerance"], hints)
            return lambda path, progress, jobs: drives.run(path, wanted, out, progress)
        request = outline_motion.Request(
            options["follower"],
            options["second_follower"],
            options["second"],
            hints,
            options["harmonics"],
            options["against"],
        )
        return lambda path, progress, jobs: outline_motion.run(path, request, out, progress)

    each([file], work, as_json=as_json, quiet=quiet, verbose=verbose)


def _refuse_mixed(options: dict[str, Any], file: Path) -> None:
    """UsageError where two of --follower, --roller and --drives are given, none for an outline, or options of another one."""
    readers = [name for name in ("follower", "roller", "drives") if options[name] is not None]
    if len(readers) > 1:
        raise click.UsageError("give --follower, --roller or --drives")
    others: Sequence[str]
    if not readers:
        from camgen.measuring.outlines import ENDINGS

        if file.suffix.lower() == ".toml":
            raise FileError(file, "is a spec, no outline: give the DXF, STL or CSV of a part")
        if file.suffix.lower() in {*ENDINGS} - {".csv"}:  # a CSV may be a cam table
            said = f"give --follower, --roller or --drives: {file.name} is an outline; such as --follower translating,radius=5"
            raise click.UsageError(said)
        others = (*_OF_DRIVES, "second_follower", "second")
        reader = "a cam table: give --follower for an outline"
    else:
        reader = f"--{readers[0]}"
        others = {
            "follower": _OF_DRIVES,
            "roller": (*_OF_DRIVES, *_OF_FOLLOWER, *_OF_OUTLINES),
            "drives": _OF_FOLLOWER,
        }[readers[0]]
    given = [name for name in others if options[name]]
    if given:
        words = {"inside": "driven-inside", "others": "second-scan", "start": "start-deg"}
        option = words.get(given[0], given[0].replace("_", "-"))
        raise click.UsageError(f"--{option} does not go with {reader}")


def _hints(options: dict[str, Any]) -> Hints:
    from camgen.measuring.outlines import Hints
    from camgen.measuring.scan import Scanning

    scanning = Scanning(options["dpi"], tuple(options["others"]), options["across"])
    return Hints(
        options["height"],
        options["layer"],
        options["line_width"],
        scanning,
        options["probe"],
    )


def _drive(options: dict[str, Any]) -> Drive:
    from camgen.measuring.drives import Drive

    slides = options["slides"]
    start = options["start"]
    return Drive(
        options["distance"],
        None if slides is None else math.radians(slides),
        options["ratio"],
        options["spring"],
        options["inside"],
        math.radians(start) if slides is None else start,
        options["centre"] or 0j,
        options["driven_centre"] or 0j,
    )
