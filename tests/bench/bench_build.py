"""Time and memory of whole commands that have a limit, side by side with another commit where one is named.

Processor time is that of all processes, on one core; wall time is that of the command as people give it, on all cores.
Modules are compiled beforehand, as they are where camgen was installed.

    python tests/bench/bench_build.py [COMMIT]
"""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

TOP = Path(__file__).resolve().parent.parent.parent
RUNS = 5
CAMS = ["--set", "parts.make='cams'"]
BUILD = ["build", "specs/uniform-swing.toml"]


def process(top: Path, arguments: list[str], compiled: Path) -> tuple[float, float, float]:
    """Processor time (s), wall time (s) and peak memory (MB) of a whole command of the checkout at `top`."""
    settings = os.environ | {"PYTHONPATH": str(top), "PYTHONPYCACHEPREFIX": str(compiled)}
    settings.pop("PYTHONDONTWRITEBYTECODE", None)
    command, quiet, begin = (
        [sys.executable, "-m", "camgen", *arguments],
        subprocess.DEVNULL,
        time.perf_counter(),
    )
    child = subprocess.Popen(command, stdout=quiet, stderr=quiet, cwd=top, env=settings)
    _, _, usage = os.wait4(child.pid, 0)
    return usage.ru_utime + usage.ru_stime, time.perf_counter() - begin, usage.ru_maxrss / 1024


COMMANDS = (  # what, arguments, most seconds
    ("`camgen --help`", ["--help"], 0.1),
    (
        "the cam alone (`--set parts.make='cams'`), `--only dxf`",
        [*BUILD, *CAMS, "--only", "dxf"],
        0.6,
    ),
    ("the cam alone, everything", [*BUILD, *CAMS], 2.5),
    ("the whole machine, everything", BUILD, 5.5),
    ("a four-bar, everything", ["build", "specs/linkage.toml"], 3.0),
)


def whole_processes(tops: list[Path], out: Path) -> list[list[str]]:
    """Rows of a table: command, limit, then processor time, wall time and memory of each checkout.

    The least time, for a machine may be busy, and the greatest memory of each command; the checkouts take turns.
    """
    rows = []
    for name, arguments, limit in COMMANDS:
        files = [*arguments, "-o", str(out)] if arguments[0] == "build" else arguments
        alone = [*files, "--jobs", "1"] if arguments[0] == "build" else files
        for top in tops:
            process(top, files, out)
        runs = [
            [(process(top, alone, out), process(top, files, out)[1]) for top in tops]
            for _ in range(RUNS)
        ]
        told = []
        for own in zip(*runs, strict=True):
            cpu, wall, memory = (
                min(s for (s, _, _), _ in own),
                min(s for _, s in own),
                max(mb for (_, _, mb), _ in own),
            )
            told.append(f"{cpu:.2f} s, {wall:.2f} s of wall, {memory:.0f} MB")
        rows.append([name, f"{limit} s", *told])
        print(" | ".join(rows[-1]), flush=True)
    return rows


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as folder:
        tops, old = [TOP], Path(folder) / "old"
        if len(sys.argv) > 1:
            add = ["git", "worktree", "add", "--detach", str(old), sys.argv[1]]
            subprocess.run(add, cwd=TOP, check=True, capture_output=True)
            tops.append(old)
        try:
            whole_processes(tops, Path(folder) / "out")
        finally:
            if len(tops) > 1:
                subprocess.run(
                    ["git", "worktree", "remove", "--force", str(old)], cwd=TOP, check=True
                )
