"""`camgen new`, `camgen schema`: a spec to begin with, and what its keys are."""

from __future__ import annotations

from pathlib import Path

import click

from camgen.commands.options import completed, mechanisms, specs_known
from camgen.commands.running import hand_over, known, spec_name
from camgen.errors import Fault, SpecError, printable

_LONG = 100  # lines of a starter with all its comments


@click.command()
@click.argument("mechanism", required=False, shell_complete=completed(specs_known))
@click.argument("file", required=False, type=click.Path(path_type=Path))
@click.option(
    "--short",
    is_flag=True,
    help="Write the fewest lines, 17 for a disc cam: no comments, and no keys that have their defaults.",
)
@click.option(
    "--metal",
    is_flag=True,
    help="Write a machine of steel: a bore with a keyway, a bought roller, steel pins.",
)
@click.option(
    "--from",
    "source",
    metavar="CHAIN",
    type=click.Path(path_type=Path),
    help="Read a linkage from PMKS lines, or from pylinkage's JSON.",
)
def new(
    mechanism: str | None, file: Path | None, short: bool, metal: bool, source: Path | None
) -> None:
    """Write a starter spec of a MECHANISM, or an example, to FILE, or print it. It has comments and builds as it is.

    Most of a long one are comments and keys that have their defaults: --short leaves these away.

    Its name, that of the output folder, is FILE's: my-cam.toml gives out/my-cam.

    Without a MECHANISM it lists all mechanisms and asks.

    With --from it reads a linkage ("linkage" or "machine") from a file of another program: PMKS lines,
    J[R, P[x, y], L[ground, crank]], or the JSON of pylinkage's mechanism_to_dict.
    """
    from camgen import starters
    from camgen.machines import load

    if mechanism is None:
        mechanism, file = _asked()
    mechanism = "linkage" if mechanism == "machine" and source is not None else mechanism
    if mechanism not in specs_known() and file is not None and str(file) in specs_known():
        right = f"first the mechanism, then the file: camgen new {file} {mechanism}"
        raise SpecError([Fault(("MECHANISM",), repr(mechanism), right)], "command line")
    if str(file) == "-":  # as other programs print
        file = None
    kind = starters.kind(known("MECHANISM", mechanism, specs_known(), "camgen list"))
    if source is None:
        if metal and mechanism not in starters.METAL:
            right = f"one that has a form in steel: {', '.join(starters.METAL)}"
            raise SpecError([Fault(("MECHANISM",), repr(mechanism), right)], "command line")
        text = starters.in_metal(mechanism) if metal else starters.text(mechanism)
        text = starters.short(text) if short else text
        if file is not None:
            text = starters.named(text, spec_name(file, mechanism))
    elif short or metal:
        alone = "no such option here: camgen reads a file of another program as it is"
        raise SpecError(
            [Fault((), "", alone, source="--short" if short else "--metal")], "command line"
        )
    elif mechanism != "linkage":
        alone = "no such option here: camgen reads only a linkage from another program"
        raise SpecError([Fault((), str(source), alone, source="--from")], "command line")
    else:
        from camgen.machines.linkage.bridges import read_chain, spec_text

        text = spec_text(read_chain(source), spec_name(file or source, "linkage"), source.name)
    text = f"#:schema ./{starters.schema_name(kind)}\n{text}"
    hand_over(text, file)
    if file is None:
        click.echo(
            f"printed only; to save it: camgen new {mechanism} my-{mechanism}.toml", err=True
        )
        return
    state = "which builds as it is" if source is None else "as it was drawn; a build judges it"
    click.echo(printable(f"wrote {file}, {state}"), err=True)
    if starters.write_schema(load(kind), kind, file.parent):
        named = file.parent / starters.schema_name(kind)
        click.echo(
            printable(
                f"wrote {named}: with it an editor (Even Better TOML, taplo) explains the keys"
            ),
            err=True,
        )
    lines = text.count("\n")
    shorter = ""
    if not short and source is None and lines > _LONG:
        few = starters.short(text).count("\n")
        shorter = f" (with --short it has {few} lines in place of {lines})"
    click.echo(printable(f"next: change it{shorter}, then camgen build {file}"), err=True)


def _asked() -> tuple[str, Path]:
    """Name of a starter or an example out of the list, and a file for it, as a person types them; SpecError where nobody does."""
    from camgen import starters

    for name in specs_known():
        click.echo(f"  {name:<20} {starters.summary(name)}", err=True)
    try:
        name = str(click.prompt("which one", err=True))
        known("MECHANISM", name, specs_known(), "camgen list")
        file = Path(click.prompt("file", f"my-{name}.toml", err=True))
    except (
        click.Abort,
        OSError,
        RuntimeError,
    ):  # no input: its end, none that is readable, a closed one
        click.echo(err=True)
        missing = "missing: camgen new MECHANISM FILE"
        raise SpecError([Fault(("MECHANISM",), "", missing)], "command line") from None
    return name, file


@click.command()
@click.argument("mechanism", shell_complete=completed(mechanisms))
def schema(mechanism: str) -> None:
    """Print the JSON Schema of a MECHANISM's spec, for editors."""
    from camgen import starters
    from camgen.machines import load

    click.echo(
        starters.schema_text(
            load(known("MECHANISM", mechanism, mechanisms(), "camgen list")), mechanism
        ),
        nl=False,
    )
