"""`camgen build`, `camgen check`: files made and judged, files judged again."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

import click

from camgen.commands.options import ANY_KIND, EXIT_CODES, jobs_option, json_option, kinds_of, quiet_option, verbose_option
from camgen.commands.running import each, refuse_one_name_twice

if TYPE_CHECKING:
    from camgen.commands.running import Work


@click.command(epilog=EXIT_CODES)
@click.argument("specs", metavar="SPEC...", nargs=-1, required=True, type=click.Path(path_type=Path))
@click.option("-o", "--out", default="out", type=click.Path(path_type=Path), help="Output folder.  [default: out]")
@click.option("--only", metavar="KINDS", callback=kinds_of, help=f"Make only these, of {','.join(ANY_KIND)}.")
@click.option("--set", "settings", metavar="KEY=VALUE", multiple=True, help="Such as segment.1.lift=8; KEY= removes it.")
@jobs_option
@json_option
@quiet_option
@verbose_option
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


@click.command(epilog=EXIT_CODES)
@click.argument("folders", metavar="FOLDER...", nargs=-1, required=True, type=click.Path(path_type=Path))
@jobs_option
@json_option
@quiet_option
@verbose_option
def check(folders: Sequence[Path], jobs: int, **shown: bool) -> None:
    """Judge the files of earlier builds again, from the files alone and the spec.toml beside them."""

    def work() -> Work:
        from camgen.pipeline import build as pipeline

        return pipeline.check

    each(folders, work, jobs, **shown)
