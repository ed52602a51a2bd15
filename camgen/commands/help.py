"""`camgen list`, `camgen explain`, `camgen guide`, `camgen selftest`: what camgen knows, and whether it still does."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import click

from camgen import guide
from camgen.commands.options import completed, set_option
from camgen.commands.running import known, show


@click.command("list")
def list_() -> None:
    """List the mechanisms and the laws of motion."""
    from camgen import starters
    from camgen.machines import MECHANISMS
    from camgen.motion.segments import ABOUT, FAMILIES, SHOWN

    click.echo("Mechanisms")
    for name in MECHANISMS:
        click.echo(f"  {name:<20} {starters.summary(name)}")
    click.echo("\nExamples")
    for name in starters.examples():
        click.echo(f"  {name:<20} {starters.summary(name)}")
    click.echo(
        f"\n{'Laws of motion':<24}{'C_v':>8}{'C_a':>9}{'C_a*':>9}{'C_j':>10}{'C_M':>9}  "
        "peaks of v, a, -a, j, |v a| in a rise of 1 in unit time"
    )
    for title, law in SHOWN:
        c_a, c_a_star = law.accelerations
        sizes = f"{law.c_v:>8.4f}{c_a:>9.4f}{c_a_star + 0.0:>9.4f}{law.c_j:>10.3f}{law.c_m:>9.4f}"
        click.echo(f"  {title:<22}{sizes}  {law.source}")
    click.echo('\nLaws with parameters, as law = { name = "...", KEY = ... }')
    for name, about in ABOUT.items():
        click.echo(f"  {name:<20} {', '.join(FAMILIES.get(name, ())) or 'no key'}: {about}")


def _explained() -> list[str]:
    return [*guide.entries(), *guide.laws()]


@click.command()
@click.argument("codes", metavar="[CODE]... [SPEC]", nargs=-1, shell_complete=completed(_explained))
@set_option("Change a key of SPEC first.")
def explain(codes: Sequence[str], settings: Sequence[str]) -> None:
    """Explain a finding (its meaning, formula, limit and what helps), or say what a law of motion is for. Without a CODE, list the
    findings.

    With a SPEC (a file that ends in .toml) explain it for this machine too: how near the value is to its limit, which key sets
    the limit, and how much each key changes the value. camgen tries each key: this takes seconds, for a walker two minutes.
    """
    files = [each for each in codes if each.endswith(".toml")]
    if len(files) > 1:
        raise click.UsageError(f"one SPEC at a time, not {' and '.join(files)}")
    spec = files[0] if files else None
    names = [each for each in codes if each != spec]
    if spec is not None and not names:
        raise click.UsageError("a CODE in front of the SPEC, such as PRESSURE_ANGLE")
    if settings and spec is None:
        raise click.UsageError("--set changes a key of a SPEC: name its file after the CODE")
    if names:
        from camgen.report.terminal import Bar

        with Bar(spec is not None) as progress:
            said = [guide.explanation(code, spec, settings, progress) for code in names]
        show("\n".join(said))
        return
    for code, entry in guide.entries().items():
        click.echo(f"{code:<20} {guide.in_short(entry)}")


@click.command("guide")
@click.argument("topic", required=False, shell_complete=completed(lambda: guide.TOPICS))
@click.option(
    "--html",
    metavar="[FOLDER]",
    is_flag=False,
    flag_value="out/guide",
    help="Write the guide as a website, with gallery and Python API.  [default folder: out/guide]",
)
@click.option(
    "--reports", is_flag=True, help="With --html: build the gallery too, and link its reports."
)
def guide_(topic: str | None, html: str | None, reports: bool) -> None:
    """Show a page of the guide; without a TOPIC, list them."""
    if (topic and html) or (reports and not html):
        raise click.UsageError("--html takes no TOPIC, and --reports goes with --html")
    if html:
        from camgen.guide.site import write

        click.echo(f"open {write(Path(html), reports)} in a browser")
    elif topic is None:
        click.echo(
            "".join(f"camgen guide {name:<28} {guide.title(name)}\n" for name in guide.TOPICS),
            nl=False,
        )
    else:
        show(
            guide.in_terminal(
                known("TOPIC", topic, guide.TOPICS, "camgen guide", guide.holding(topic))
            )
        )


@click.command()
def selftest() -> None:
    """Compare published constants, and the numbers of the five papers, with those of camgen; exit code 1 if one is off."""
    from camgen.machines.selftest import rows, to_text

    found = list(rows())
    click.echo(to_text(found))
    raise click.exceptions.Exit(0 if all(row.ok for row in found) else 1)
