"""How processor time grows with the size of the work, and what large machines cost against their goals.

    python tests/bench/bench_growth.py [growth] [large [COMMIT]] [--results]

growth: four-bars of other lengths beside each other on one shaft, each with its own 8 parts; facets of one cam; angles of one
machine; variants of one sweep. The exponent is that of a power law through the row and the one before it.
large: whole commands of large machines, and of one cam against the imports that others wrote; beside those of another commit,
against which goals stand that are shares. --results puts the tables asked for into RESULTS.md. Processor time of whole processes
on one core, the least of several. Some minutes.
"""

from __future__ import annotations

import math
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

import numpy as np
from bench_build import CAMS, TOP, process
from results import PAGE, put

sys.path[:0] = [str(TOP)]

from camgen.files.stl import read_stl  # noqa: E402
from camgen.machines.sources import read_mechanism  # noqa: E402
from camgen.sweep.run import rows_of, task_of  # noqa: E402
from camgen.sweep.variants import variants  # noqa: E402

SPECS = TOP / "specs"
ROWS = (1, 2, 4, 7)  # four-bars of 8 parts
APART = 200  # mm
COUPLER = '"A-B" = 60'
TOLERANCES = (1e-2, 1e-3, 1e-4, 1e-5)
ANGLES = (3_600, 36_000, 360_000)
VARIANTS = (100, 1_000, 10_000)
VARY = "geometry.base_radius=16:40 geometry.follower.offset=-4:4"
IMPORTS = "import click, numpy, pydantic, ezdxf, shapely"
RUNS = 3

Sizes = Iterator[tuple[int, float, str]]  # of a row: its size, seconds, and what else is said


def table(heads: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """Markdown."""
    return "".join(f"| {' | '.join(row)} |\n" for row in (heads, ["---"] * len(heads), *rows))


def least(
    arguments: Sequence[str], folder: Path, runs: int = RUNS, top: Path = TOP
) -> tuple[float, float]:
    """Processor time of a command of camgen, s, the least of some runs, and its greatest memory, MB."""
    process(top, ["--help"], folder / "compiled")
    told = [process(top, [*arguments], folder / "compiled") for _ in range(runs)]
    return min(seconds for seconds, _, _ in told), max(memory for _, _, memory in told)


def building(spec: Path, folder: Path, *options: str) -> list[str]:
    """The command that builds a spec on one core."""
    return ["build", str(spec), "-o", str(folder / "out"), "--jobs", "1", *options]


# ---- growth ----------------------------------------------------------------------------------------------------------


def row_of_four_bars(count: int, folder: Path) -> Path:
    """A spec: the four-bar of `specs/linkage.toml`, and others whose couplers are longer by a millimetre each, beside it."""
    text = (SPECS / "linkage.toml").read_text(encoding="utf-8")
    assert text.count(COUPLER) == 1
    included = ""
    for k in range(1, count):
        module = folder / f"four-bar-{k}.toml"
        module.write_text(text.replace(COUPLER, f'"A-B" = {60 + k}'), encoding="utf-8")
        included += f'\n[[include]]\nspec = "{module.name}"\nname = "m{k}"\nat = [{APART * k}, 0]\n'
    spec = folder / f"row-{count}.toml"
    spec.write_text(text + included, encoding="utf-8")
    return spec


def parts(folder: Path) -> Sizes:
    """Whole builds of rows of four-bars, all kinds of files; size: distinct parts."""
    for count in ROWS:
        spec = row_of_four_bars(count, folder)
        seconds, memory = least(building(spec, folder), folder)
        size = len(read_mechanism(spec).assembly.parts)
        yield size, seconds, f"{seconds / size:.3f} s a part, {memory:.0f} MB"


def facets(folder: Path) -> Sizes:
    """The cam alone as STL; size: its triangles."""
    for tolerance in TOLERANCES:
        finer = ["--set", f"accuracy.chord_tolerance={tolerance:g}"]
        command = building(SPECS / "uniform-swing.toml", folder, *CAMS, *finer, "--only", "stl")
        seconds, memory = least(command, folder)
        (file,) = (folder / "out").rglob("*-cam.stl")
        yield len(read_stl(file).faces), seconds, f"at {tolerance:g} mm, {memory:.0f} MB"


def angles(_: Path) -> Sizes:
    """Positions and two derivatives of a four-bar's outputs; size: angles."""
    machine = read_mechanism(SPECS / "linkage.toml")
    for count in ANGLES:
        theta = np.linspace(0, math.tau, count, endpoint=False)
        spent = []
        for _ in range(RUNS + 1):
            begin = time.process_time()
            run = machine.solve(theta)
            for output in machine.model.outputs:
                run.derivatives(output.name)
            spent.append(time.process_time() - begin)
        yield count, min(spent[1:]), f"{1e9 * min(spent[1:]) / count:.0f} ns an angle"


def swept(folder: Path) -> Sizes:
    """A sweep of a disc cam, each variant judged; size: variants."""
    for count in VARIANTS:
        several = variants(VARY.split(), latin=count)
        task = task_of(SPECS / "disc-cam.toml", several, (), (), (), folder)
        rows_of(task, range(2))
        spent = []
        for _ in range(RUNS):
            begin = time.process_time()
            rows_of(task, range(count))
            spent.append(time.process_time() - begin)
        yield count, min(spent), f"{count / min(spent):.0f} a second"


GROWING: tuple[tuple[str, Callable[[Path], Sizes]], ...] = (
    ("distinct parts, whole build", parts),
    ("facets of a cam, `--only stl`", facets),
    ("angles of a four-bar, two derivatives", angles),
    ("variants of a disc cam in a sweep", swept),
)


def growth(folder: Path) -> str:
    """The table of growth."""
    rows = []
    for what, sizes in GROWING:
        before: tuple[int, float] | None = None
        for size, seconds, remark in sizes(folder):
            exponent = ""
            if before is not None:
                exponent = f"{math.log(seconds / before[1]) / math.log(size / before[0]):.2f}"
            before = size, seconds
            rows.append([what, f"{size:,}", f"{seconds:.3g} s", exponent, remark])
            print(" | ".join(rows[-1]), flush=True)
    return table(["what grows", "size", "processor time", "exponent", "that is"], rows)


# ---- large machines --------------------------------------------------------------------------------------------------


def imports() -> float:
    """Processor time of the imports that others wrote, s, the least of some runs."""
    spent = []
    for _ in range(2 * RUNS):
        child = subprocess.Popen([sys.executable, "-c", IMPORTS])
        _, _, usage = os.wait4(child.pid, 0)
        spent.append(usage.ru_utime + usage.ru_stime)
    return min(spent)


def large(folder: Path, tops: Sequence[Path]) -> str:
    """The table of large machines and of one cam against their goals; tops: this checkout, and that of the commit before."""
    rows = []

    def add(what: str, goal: str, told: Sequence[str], met: bool) -> None:
        rows.append([what, goal, *told, "yes" if met else "**no**"])
        print(" | ".join(rows[-1]), flush=True)

    for what, spec, share in (
        ("stitch head, 46 parts", "stitch-head", 3),
        ("four-leg walker, 62 copies of parts", "four-leg-walker", 2),
    ):
        both = [least(building(SPECS / f"{spec}.toml", folder), folder, 1, top) for top in tops]
        (seconds, memory), (before, _) = both[0], both[-1]
        told = [f"{s:.1f} s, {mb:.0f} MB" for s, mb in both]
        goal = f"1/{share} of the time before"
        add(what, goal, told, seconds <= before / share)
        if spec == "stitch-head":
            add("its memory", "300 MB", [f"{mb:.0f} MB" for _, mb in both], memory <= 300)
    swing = building(SPECS / "uniform-swing.toml", folder)
    times = [least(swing, folder, RUNS, top)[0] for top in tops]
    add("whole swing machine", "3.5 s", [f"{s:.2f} s" for s in times], times[0] <= 3.5)
    others = imports()
    for what, options, most in (
        ("a cam alone, `--only dxf`", ["--only", "dxf"], 2.0),
        ("a cam alone, everything", [], 4.0),
    ):
        command = building(SPECS / "uniform-swing.toml", folder, *CAMS, *options)
        times = [least(command, folder, RUNS, top)[0] for top in tops]
        told = [f"{s / others:.2f} times ({s:.2f} s)" for s in times]
        goal = f"{most} times the imports, {others:.2f} s"
        add(what, goal, told, times[0] / others <= most)
    heads = ["what", "goal", "processor time", "before", "met"]
    return table(heads if len(tops) > 1 else [head for head in heads if head != "before"], rows)


def main(asked: Sequence[str]) -> None:
    """Print the tables asked for."""
    names = ("growth", "large")
    wanted = [name for name in names if name in asked] or names
    commits = [each for each in asked if each not in (*names, "--results")]
    page = PAGE.read_text(encoding="utf-8")
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        if "growth" in wanted:
            page = put(page, "growth", growth(folder))
        if "large" in wanted:
            with checkouts(folder, commits) as tops:
                page = put(page, "large", large(folder, tops))
    if "--results" in asked:
        PAGE.write_text(page, encoding="utf-8")


@contextmanager
def checkouts(folder: Path, commits: Sequence[str]) -> Iterator[list[Path]]:
    """This checkout, and those of commits as long as they are wanted."""
    tops = [TOP, *(folder / commit for commit in commits)]
    try:
        for top in tops[1:]:
            add = ["git", "worktree", "add", "--detach", str(top), top.name]
            subprocess.run(add, cwd=TOP, check=True, capture_output=True)
        yield tops
    finally:
        for top in tops[1:]:
            remove = ["git", "worktree", "remove", "--force", str(top)]
            subprocess.run(remove, cwd=TOP, check=False, capture_output=True)


if __name__ == "__main__":
    main(sys.argv[1:])
