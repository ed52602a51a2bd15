"""`camgen watch`, `camgen explore`: pages on this machine while a spec is written."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from camgen.commands.options import EXIT_CODES
from camgen.errors import printable

_browser = click.option("--open", "browser", is_flag=True, help="Open the page in a browser.")
_port = click.option(
    "--port",
    type=click.IntRange(0, 65535),
    default=0,
    help="Of this machine.  [default: a free one]",
)


@click.command(epilog=EXIT_CODES)
@click.argument("spec", type=click.Path(path_type=Path))
@click.option(
    "-o",
    "--out",
    default="out",
    type=click.Path(path_type=Path),
    help="Output folder.  [default: out]",
)
@_port
@_browser
def watch(spec: Path, **served: Any) -> None:
    """Build SPEC each time it is saved, and show its report on a page that this machine alone can open."""
    from camgen.live import run

    run.watch(spec, say=_say, **served)


@click.command(epilog=EXIT_CODES)
@click.argument("spec", type=click.Path(path_type=Path))
@click.option(
    "-o",
    "--out",
    default="out",
    type=click.Path(path_type=Path),
    help="Of full builds.  [default: out]",
)
@_port
@_browser
def explore(spec: Path, **served: Any) -> None:
    """Show SPEC with sliders for its numbers, on a page that this machine alone can open; saved when you ask for it."""
    from camgen.live import run

    run.explore(spec, say=_say, **served)


def _say(text: str) -> None:
    click.echo(printable(text))
