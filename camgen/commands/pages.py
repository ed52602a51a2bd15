"""`camgen watch`, `camgen explore`: pages on this machine while a spec is written."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from camgen.commands.options import EXIT_CODES, out_option
from camgen.errors import printable

_browser = click.option("--open", "browser", is_flag=True, help="Open the page in a browser.")
_port = click.option(
    "--port",
    type=click.IntRange(0, 65535),
    default=0,
    help="Port of this machine.  [default: a free one]",
)


@click.command(epilog=EXIT_CODES)
@click.argument("spec", type=click.Path(path_type=Path))
@out_option
@_port
@_browser
def watch(spec: Path, **served: Any) -> None:
    """Build SPEC each time it is saved, and show its report on a page that only this machine can open."""
    from camgen.live import run

    run.watch(spec, say=_say, **served)


@click.command(epilog=EXIT_CODES)
@click.argument("spec", type=click.Path(path_type=Path), required=False)
@click.option(
    "-o",
    "--out",
    default="out",
    type=click.Path(path_type=Path),
    help="Output folder of full builds.  [default: out]",
)
@_port
@_browser
def explore(spec: Path | None, **served: Any) -> None:
    """Draw a linkage with the mouse, or try any SPEC with sliders, on a page that only this machine can open.

    Without SPEC you begin with an empty sheet or a linkage of the gallery. It saves only when you click Save.
    """
    from camgen import starters
    from camgen.live import run
    from camgen.live.gallery import Gallery

    texts = {each: starters.text(each) for each in ("linkage", *starters.examples())}
    run.explore(spec, say=_say, gallery=Gallery(texts, starters.pictures()), **served)


def _say(text: str) -> None:
    click.echo(printable(text))
