"""Processor time and memory of whole commands that have a limit, side by side with another commit where one is named.

    python tests/bench/bench_build.py [COMMIT]
"""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
from pathlib import Path

TOP = Path(__file__).resolve().parent.parent.parent
RUNS = 5
CAMS, BUILD = ["--set", "parts.make='cams'"], ["build", "specs/uniform-swing.toml"]


def process(top: Path, arguments: list[str]) -> tuple[float, float]:
    """Processor time (s) and peak memory (MB) of a whole process of the checkout at `top`."""
    command = [sys.executable, "-m", "camgen", *arguments]
    quiet = subprocess.DEVNULL
    child = subprocess.Popen(command, stdout=quiet, stderr=quiet, cwd=top, env=os.environ | {"PYTHONPATH": str(top)})
    _, _, usage = os.wait4(child.pid, 0)
    return usage.ru_utime + usage.ru_stime, usage.ru_maxrss / 1024


COMMANDS = (  # what, arguments, most seconds
    ("`camgen --help`", ["--help"], 0.1),
    ("the cam alone (`--set parts.make='cams'`), `--only dxf`", [*BUILD, *CAMS, "--only", "dxf"], 0.6),
    ("the cam alone, everything", [*BUILD, *CAMS], 2.5),
    ("the whole machine, everything", BUILD, 5.5),
)


def whole_processes(tops: list[Path], out: Path) -> list[list[str]]:
    """Rows of a table: command, limit, then seconds and memory of each checkout.

    The least time, for a machine may be busy, and the greatest memory of each command; the checkouts take turns."""
    rows = []
    for name, arguments, limit in COMMANDS:
        written = [*arguments, "-o", str(out)] if arguments[0] == "build" else arguments
        runs = [[process(top, written) for top in tops] for _ in range(RUNS)]
        told = [f"{min(s for s, _ in own):.2f} s, {max(mb for _, mb in own):.0f} MB" for own in zip(*runs, strict=True)]
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
                subprocess.run(["git", "worktree", "remove", "--force", str(old)], cwd=TOP, check=True)
