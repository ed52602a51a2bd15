"""Options, arguments and exit codes that commands share."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable
from difflib import get_close_matches
from pathlib import Path
from typing import Any

import click

from camgen.files.formats import ANY_KIND as ANY_KIND
from camgen.files.formats import KINDS

_CODES = """\b
Exit codes:
  0  {0}
  1  {1}
  2  the spec or the command is wrong (all faults listed, nothing written)
  3  well formed, but no such mechanism exists (nothing written)
  4  a file could not be written or read
{2}130 is Ctrl-C, 70 an internal error of camgen."""
EXIT_CODES = _CODES.format(
    "every finding holds",
    "a finding fails (files are written)",
    "If several apply, camgen returns the largest. ",
)
SWEEP_CODES = _CODES.format(
    "some variant holds", "none holds (the table is written, and says why)", ""
)

out_option = click.option(
    "-o",
    "--out",
    default="out",
    type=click.Path(path_type=Path),
    help="Output folder.  [default: out]",
)
jobs_option = click.option(
    "-j",
    "--jobs",
    type=click.IntRange(0),
    help="Number of cores to use; 0: all.  [default: all, if that is quicker]",
)
quiet_option = click.option(
    "-q",
    "--quiet",
    is_flag=True,
    help="Print only findings that fail, and notes on files that are missing or changed.",
)
verbose_option = click.option(
    "-v",
    "--verbose",
    is_flag=True,
    help="Print all findings, as a table and in words, and every file.",
)
json_option = click.option(
    "--json", "as_json", is_flag=True, help="Print JSON: one object, or a list for several."
)


def set_option(such_as: str) -> Callable[[Any], Any]:
    """--set, with a sentence that shows what it sets."""
    return click.option("--set", "settings", metavar="KEY=VALUE", multiple=True, help=such_as)


def completed(names: Callable[[], Iterable[str]]) -> Callable[..., list[str]]:
    """For a shell that completes an argument: those of the names that begin as what is typed."""
    return lambda context, parameter, begun: [
        name for name in names() if name.lower().startswith(begun.lower())
    ]


def mechanisms() -> Collection[str]:
    """Names of mechanisms."""
    from camgen.machines import MECHANISMS

    return MECHANISMS


def specs_known() -> Collection[str]:
    """Names of starters and examples."""
    from camgen import starters

    return [*mechanisms(), *starters.examples()]


def kinds_of(
    context: click.Context, parameter: click.Parameter, value: str | None
) -> frozenset[str]:
    """The kinds of files that --only names."""
    if value is None:
        return frozenset(KINDS)
    kinds = frozenset(kind.strip() for kind in value.split(","))
    unknown = sorted(kinds - set(ANY_KIND))
    if unknown:
        drawn = (
            " Drawings, in PDF too, come with dxf."
            if {"pdf", "drawing", "drawings"} & kinds
            else ""
        )
        near = [each for kind in unknown for each in get_close_matches(kind.lower(), ANY_KIND, 1)]
        meant = f" Did you mean {', '.join(dict.fromkeys(near))}?" if near and not drawn else ""
        raise click.BadParameter(
            f"{', '.join(map(repr, unknown))}: a list of {', '.join(ANY_KIND)} was expected.{meant}{drawn}"
        )
    return kinds
