"""`camgen motion`: a follower rolled on any outline."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from camgen.commands.options import EXIT_CODES, json_option, quiet_option, verbose_option
from camgen.commands.running import each

if TYPE_CHECKING:
    from camgen.commands.running import Work


@click.command(epilog=EXIT_CODES)
@click.argument("file", type=click.Path(path_type=Path))
@click.option(
    "--follower",
    required=True,
    metavar="TABLE",
    help="The follower: a TOML file, or KEY=VALUE,... as above.",
)
@click.option(
    "--second-follower",
    metavar="TABLE",
    help="A second tip on the same follower, for the lash of the pair.",
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
    help="Width of lines, mm, for G-code that does not name it (CuraEngine).",
)
@click.option("--dpi", type=float, help="Dots per inch of a scan.  [default: as its file says]")
@click.option(
    "--second-scan",
    "others",
    multiple=True,
    type=click.Path(path_type=Path),
    help="The part again, turned by 90 deg.",
)
@click.option(
    "--across",
    type=click.FloatRange(0.1),
    help="Greatest width of a scanned part by a caliper, mm.",
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
    help="SPEC of the cam: lay the outline on it, compare the motion.",
)
@click.option(
    "--harmonics",
    type=click.IntRange(1, 1800),
    default=36,
    help="Low-pass of speed, acceleration.  [default: 36]",
)
@click.option(
    "-o",
    "--out",
    default="out",
    type=click.Path(path_type=Path),
    help="Output folder.  [default: out]",
)
@json_option
@quiet_option
@verbose_option
def motion(
    file: Path, out: Path, as_json: bool, quiet: bool, verbose: bool, **options: Any
) -> None:
    """Roll a follower on the outline in FILE (DXF, mesh, G-code, scan or points of any maker) and report its motion.

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

    A mesh is one part: STL, 3MF, OBJ, PLY, OFF or GLB. OBJ, PLY, OFF and STL name no unit and are taken as mm with z up; a GLB
    is in metres with y up.

    A scan (PNG, JPEG, TIFF; with the extra "scan") shows one part on an even ground; its bore is the shaft. Points are
    a CSV with columns x,y in order or angle,radius, mm and degrees.

    Writes OUT/<file>-motion/ with report.html, report.json and motion.csv: displacement, speed,
    acceleration, pressure angle.
    """

    def work() -> Work:
        from camgen.measuring import motion as outline_motion
        from camgen.measuring.outlines import Hints
        from camgen.measuring.scan import Scanning

        scanning = Scanning(options["dpi"], tuple(options["others"]), options["across"])
        hints = Hints(
            options["height"],
            options["layer"],
            options["line_width"],
            scanning,
            options["probe"],
        )
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
