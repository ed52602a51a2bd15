"""Whole-process times and memory of the commands that have a limit. Run: python tests/bench/bench_build.py"""

from __future__ import annotations

import os
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

SPEC = Path(__file__).parent.parent.parent / "specs" / "uniform-swing.toml"
RUNS = 7


def process(arguments: list[str]) -> tuple[float, float]:
    """Wall time (s) and peak memory (MB) of a whole process."""
    begin = time.perf_counter()
    child = subprocess.Popen([sys.executable, "-m", "camgen", *arguments], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    _, _, usage = os.wait4(child.pid, 0)
    return time.perf_counter() - begin, usage.ru_maxrss / 1024


def whole_processes(out: Path) -> None:
    """Median wall time and greatest memory of the commands that have a limit."""
    print(f"command | wall, s (median of {RUNS}) | limit, s | peak, MB")
    cams = ["--set", "parts.make='cams'"]
    build = ["build", str(SPEC), "-o", str(out)]
    for name, arguments, limit in (
        ("camgen --help", ["--help"], 0.15),
        ("camgen build --only dxf, the cam alone", [*build, *cams, "--only", "dxf"], 0.6),
        ("camgen build, the cam alone", [*build, *cams], 2.5),
        ("camgen build, the whole machine", build, 12.0),
    ):
        runs = [process(arguments) for _ in range(RUNS)]
        print(f"{name} | {statistics.median(w for w, _ in runs):.2f} | {limit} | {max(m for _, m in runs):.0f}")


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as folder:
        whole_processes(Path(folder))
