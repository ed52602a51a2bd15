"""Measure accuracy and whole commands, and write them into RESULTS.md: `python tests/bench/results.py`, some minutes."""

from __future__ import annotations

import tempfile
from pathlib import Path

from bench_build import TOP, whole_processes

from camgen.sweep import benchmark_report

PAGE = Path(__file__).with_name("RESULTS.md")


def put(text: str, mark: str, block: str) -> str:
    """The page with another block between the marks."""
    begin, end = f"<!-- {mark} -->\n", f"<!-- /{mark} -->"
    return text.partition(begin)[0] + begin + block + end + text.partition(end)[2]


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as folder:
        starters = [TOP / "specs" / f"{name}.toml" for name in benchmark_report.STARTERS]
        benches = benchmark_report.run(starters, Path(folder))
        measured = [
            [what, goal, *told.split(", ")[:2]]
            for what, goal, told in whole_processes([TOP], Path(folder) / "out")
        ]
        rows = [["command", "goal", "processor time", "on all cores"], ["---"] * 4, *measured]
    page = put(
        PAGE.read_text(encoding="utf-8"),
        "bench",
        "\n".join(map(benchmark_report.to_markdown, benches)),
    )
    PAGE.write_text(
        put(page, "commands", "".join(f"| {' | '.join(row)} |\n" for row in rows)), encoding="utf-8"
    )
