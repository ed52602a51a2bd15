"""The command line: all commands, how a run ends, and its exit code.

Only click is imported here; each command imports what it needs, so `camgen --help` is quick.
"""

from __future__ import annotations

import gc
import io
import os
import signal
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import NoReturn

import click

from camgen._version import __version__
from camgen.commands import COMMANDS
from camgen.commands.options import EXIT_CODES
from camgen.commands.running import complain
from camgen.errors import INTERRUPTED, CamgenError, FileError, explained, printable

_COMPLETE = (
    "_CAMGEN_COMPLETE"  # set by the shell that asks for completions: bash_source, zsh_complete, ...
)
# Neither numpy's threads are of use here, 20 ms to start them, nor what other packages would add to pydantic, 4 ms to look for.
_ENVIRONMENT = {"OPENBLAS_NUM_THREADS": "1", "PYDANTIC_DISABLE_PLUGINS": "__all__"}
_COLLECTED = 200_000  # objects made and not yet freed, after which garbage is collected
INTERNAL = 70
PIPE_CLOSED = 141
TERMINATED = 143


@click.group(epilog=EXIT_CODES, context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(__version__, prog_name="camgen")
def cli() -> None:
    """Make the parts of cams, linkages and gears from a text file, the spec, and check their motion in the files made."""


for _command in COMMANDS:
    cli.add_command(_command)


def _refuse_one_hyphen(arguments: Sequence[str]) -> None:
    """UsageError for a long option behind one hyphen, which would be read as a short one and its value."""
    known = {name for each in COMMANDS for option in each.params for name in option.opts}
    for word in arguments:
        if len(word) > 2 and word[0] == "-" != word[1] and f"-{word.partition('=')[0]}" in known:
            raise click.UsageError(f"{word}: two hyphens, -{word}")


def main(arguments: Sequence[str] | None = None) -> NoReturn:
    """Run the command line and exit; a user's mistake ends in a message and its exit code, never in a traceback.

    Without arguments it is the whole program, those of the command line its own: the collector of garbage rests.
    """
    for asked in (signal.SIGTERM, *([signal.SIGHUP] if hasattr(signal, "SIGHUP") else [])):
        if signal.getsignal(asked) is not signal.SIG_IGN:  # such as under nohup
            signal.signal(
                asked, lambda *_: sys.exit(TERMINATED)
            )  # so that half-made folders are cleared away
    if isinstance(
        sys.stdout, io.TextIOWrapper
    ):  # a file name may hold what stdout's encoding does not
        sys.stdout.reconfigure(errors="backslashreplace")
    for name, value in _ENVIRONMENT.items():
        os.environ.setdefault(name, value)
    try:
        code = _run(arguments)
        if sys.stdout is not None:
            sys.stdout.flush()
    except BrokenPipeError:
        os.dup2(
            os.open(os.devnull, os.O_WRONLY), 1
        )  # nobody reads on: let the last flush go nowhere
        code = PIPE_CLOSED
    except OSError as error:
        complain(explained(error))
        os.dup2(os.open(os.devnull, os.O_WRONLY), 1)
        code = FileError.exit_code
    if arguments is None:
        # The last collection, as Python ends, would go through all that was made: a tenth of the time.
        gc.freeze()
    sys.exit(code)


def _run(arguments: Sequence[str] | None) -> int:
    """Exit code of a run, errors printed."""
    if sys.stdout is None:  # closed by the shell: print into nothing
        sys.stdout = open(os.devnull, "w", encoding="utf-8")  # noqa: SIM115
    if _COMPLETE in os.environ:
        from click.shell_completion import shell_complete

        return shell_complete(cli, {}, "camgen", _COMPLETE, os.environ[_COMPLETE])
    if arguments is None:
        # Python's own 700 collects so often that it costs a tenth of the time, most of it at imports. Never is too
        # seldom: drawings of a machine of many parts, whose entities point at each other, would all stay in memory.
        gc.set_threshold(_COLLECTED, 5, 5)
    try:
        # Not cli.main, which turns a closed pipe into exit code 1: here that means a finding that fails.
        words = list(sys.argv[1:] if arguments is None else arguments)
        _refuse_one_hyphen(words)
        if words and words[0].endswith(".toml"):
            raise click.UsageError(f"a command comes first: camgen build {words[0]}")
        with cli.make_context("camgen", words) as context:
            cli.invoke(context)
    except click.exceptions.Exit as done:
        return done.exit_code
    except KeyboardInterrupt:
        click.echo("interrupted: what was under way is not written", err=True)
        return INTERRUPTED
    except click.ClickException as error:
        told = io.StringIO()
        error.show(told)
        click.echo(printable(told.getvalue(), keep="\n"), nl=False, err=True)
        return error.exit_code
    except CamgenError as error:
        complain(error)
        return error.exit_code
    except OSError:
        raise
    except Exception as error:
        place = error.__traceback__
        while place is not None and place.tb_next is not None:
            place = place.tb_next
        at = f"{Path(place.tb_frame.f_code.co_filename).name}:{place.tb_lineno}" if place else "?"
        said = f"internal error: {type(error).__name__}: {error} ({at}); please report it with the spec"
        click.echo(printable(said, keep="\n"), err=True)
        return INTERNAL
    return 0
