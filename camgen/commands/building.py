"""`camgen build`, `camgen check`: files made and judged, files judged again."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

import click

from camgen.commands.options import (
    ANY_KIND,
    EXIT_CODES,
    jobs_option,
    json_option,
    kinds_of,
    out_option,
    quiet_option,
    set_option,
    verbose_option,
)
from camgen.commands.running import each, refuse_one_name_twice, refuse_words
from camgen.errors import Fault, SpecError

if TYPE_CHECKING:
    from camgen.commands.running import Work
    from camgen.progress import Progress
    from camgen.report.report import Report


@click.command(epilog=EXIT_CODES)
@click.argument(
    "specs", metavar="SPEC...", nargs=-1, required=True, type=click.Path(path_type=Path)
)
@out_option
@click.option(
    "--only",
    metavar="KINDS",
    callback=kinds_of,
    help=f"Make only these kinds of files, from {','.join(ANY_KIND)}. Drawings (PDF) come with dxf, a GLB with report and solids, the parts list with any. A new build removes all files of an earlier one. servo: cam tables for drives; mjcf: a folder for MuJoCo; plots: curves as SVG and PNG; animation: one turn as GIF; picture: PNG.",
)
@set_option("Change a key, such as segment.1.lift=8; KEY= removes it.")
@jobs_option
@json_option
@quiet_option
@verbose_option
def build(
    specs: Sequence[Path],
    out: Path,
    only: frozenset[str],
    settings: Sequence[str],
    jobs: int | None,
    **shown: bool,
) -> None:
    """Make the parts of each SPEC, read the files back and check them; writes OUT/<name>/."""

    refuse_words(specs)

    def work() -> Work:
        from camgen.pipeline import build as pipeline

        if len(specs) > 1:
            refuse_one_name_twice(specs, settings)
        return partial(pipeline.build, out=out, only=only, overrides=settings)

    each(specs, work, jobs, **shown)


@click.command(epilog=EXIT_CODES)
@click.argument(
    "folders", metavar="FOLDER...", nargs=-1, required=True, type=click.Path(path_type=Path)
)
@click.option(
    "--gcode",
    multiple=True,
    type=click.Path(path_type=Path),
    help="Judge this sliced plate in place of the folder's files.",
)
@click.option(
    "--line-width",
    type=click.FloatRange(0.01, 10),
    help="Width of the printed lines, mm, if the G-code does not say it (CuraEngine).",
)
@jobs_option
@json_option
@quiet_option
@verbose_option
def check(
    folders: Sequence[Path],
    gcode: Sequence[Path],
    line_width: float | None,
    jobs: int | None,
    **shown: bool,
) -> None:
    """Judge the files of earlier builds again, from the files alone and the spec.toml beside them.

    With --gcode, given once for each plate, judge the sliced plates instead (PrusaSlicer, OrcaSlicer, Bambu Studio, CuraEngine).
    """
    if gcode and len(folders) > 1:
        raise SpecError(
            [
                Fault(
                    (),
                    f"with {len(folders)} folders",
                    "one folder: that of the plates",
                    source="--gcode",
                )
            ],
            "command line",
        )

    def work() -> Work:
        if gcode:
            return partial(_sliced, plates=gcode, line_width=line_width)
        from camgen.pipeline import build as pipeline

        return pipeline.check

    each(folders, work, jobs, **shown)


def _sliced(
    folder: Path,
    plates: Sequence[Path],
    line_width: float | None,
    progress: Progress,
    jobs: int | None,
) -> Report:
    """A folder judged by the G-code of its plates; its own steps take one core."""
    from camgen.pipeline.sliced import check_gcode

    return check_gcode(folder, plates, line_width, progress)
