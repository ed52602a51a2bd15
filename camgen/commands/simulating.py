"""`camgen simulate`: machines on a floor, stepped in time."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

import click

from camgen.commands.options import (
    EXIT_CODES,
    json_option,
    out_option,
    quiet_option,
    set_option,
    verbose_option,
)
from camgen.commands.running import each, refuse_one_name_twice

if TYPE_CHECKING:
    from camgen.commands.running import Work


@click.command(epilog=EXIT_CODES)
@click.argument(
    "specs", metavar="SPEC...", nargs=-1, required=True, type=click.Path(path_type=Path)
)
@out_option
@set_option("Change a key, such as parts.side_phase_deg=0.")
@click.option(
    "--copies",
    type=int,
    default=0,
    help="Number of printed copies to simulate too, with the errors and play of a print.  [default: 0]",
)
@click.option(
    "--seed", type=int, default=1, help="The same seed gives the same copies.  [default: 1]"
)
@json_option
@quiet_option
@verbose_option
def simulate(
    specs: Sequence[Path],
    out: Path,
    settings: Sequence[str],
    copies: int,
    seed: int,
    **shown: bool,
) -> None:
    """Put each SPEC with a table [walk] on a floor: does it walk, fall, slip or stall, at each friction of walk.friction?

    Writes OUT/<name>-walk/ with a page, a film and a table of the curves. Needs the extra simulate: pip install ".[simulate]".
    """

    def work() -> Work:
        from camgen.simulation import walking

        if len(specs) > 1:
            refuse_one_name_twice(specs, settings)
        prints = walking.Prints(copies, seed)
        return partial(walking.simulate, out=out, overrides=settings, prints=prints)

    each(specs, work, 1, **shown)
