"""Time against accuracy, beyond the cams' files: how a machine is closed, how many copies are drawn, how long a path is sought.

    python tests/bench/bench_accuracy.py [closing] [copies] [paths] [--results]

--results puts the tables asked for into RESULTS.md and the curves beside it (accuracy-copies.svg, accuracy-paths.svg). Times
are of the processor, one core, so that a busy machine disturbs them least. Some minutes, most of them for the paths.
"""

from __future__ import annotations

import math
import statistics
import sys
import time
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]
sys.path[:0] = [str(HERE.parent / "machine"), str(ROOT)]

import chains  # noqa: E402  of the tests
from front_area import area  # noqa: E402
from results import PAGE, put  # noqa: E402

from camgen.design.paths import front, kinds, search  # noqa: E402
from camgen.design.polish import Goal  # noqa: E402
from camgen.design.target import Target  # noqa: E402
from camgen.machine.closing import close  # noqa: E402
from camgen.machine.constraints import Constraints  # noqa: E402
from camgen.machine.model import Machine  # noqa: E402
from camgen.machine.run import solve  # noqa: E402
from camgen.machines.sources import read_mechanism  # noqa: E402
from camgen.plotting import figure_of, image  # noqa: E402
from camgen.study import Plot  # noqa: E402
from camgen.tolerance.spread import copies_of, spread_of  # noqa: E402

ANGLES = 3_600
ROUNDS = 5
SEEDS = 8
SAMPLES = (100, 1_000, 10_000, 100_000)
CHAINS = ("jansen", "klann", "watt_two", "peaucellier", "stephenson_three", "double_butterfly")
LONG = (9.0, 3.0, 8.0, 7.0)  # four-bar: frame, crank, coupler, rocker
BUDGETS = ((2, 0), (3, 0), (4, 0), (4, 1))  # pairs of bars at most, effort


def cpu(work: Callable[[], Any], rounds: int = ROUNDS) -> float:
    """Median of some calls, s of the processor; the first one, which may make tables, is not counted."""
    work()
    spent = []
    for _ in range(rounds):
        begun = time.process_time()
        work()
        spent.append(time.process_time() - begun)
    return statistics.median(spent)


def table(heads: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """Markdown."""
    return "".join(f"| {' | '.join(row)} |\n" for row in (heads, ["---"] * len(heads), *rows))


# ---- closing ---------------------------------------------------------------------------------------------------------


def exact(theta: Any) -> Any:
    """The joint B of the four-bar in long double, complex mm."""
    frame, crank, coupler, rocker = map(np.longdouble, LONG)
    a = crank * np.exp(1j * theta.astype(np.longdouble))
    way = frame - a
    along = ((coupler - rocker) * (coupler + rocker) / np.abs(way) ** 2 + 1) / 2
    return a + way * (along + 1j * np.sqrt(coupler**2 / np.abs(way) ** 2 - along**2))


def posed(machine: Machine, theta: Any, order: int) -> Any:
    """Poses of all bodies by the maker's route."""
    return solve(machine, theta, order).poses()


def places(machine: Machine, theta: Any) -> tuple[Any, Any]:
    """Places of all bodies' origins, complex mm, by the maker's route and by the judge's."""
    system = Constraints(machine)
    mine, judge = posed(machine, theta, 0), close(system, theta, order=1).q
    return tuple(q[:, 0::3] + 1j * q[:, 1::3] for q in (mine, judge))  # type: ignore[return-value]


def closing(told: Callable[[str], None]) -> str:
    """Dyads, blocks by Newton, and the judge's Newton on all joints, at 3,600 angles."""
    theta = np.linspace(0, math.tau, ANGLES, endpoint=False)
    heads = [
        "chain",
        "the maker's route",
        "positions",
        "with two derivatives",
        "the judge's route",
        "both differ by",
        "error",
    ]
    rows = []
    for name in ("four_bar", *CHAINS):
        machine = chains.four_bar(*LONG) if name == "four_bar" else getattr(chains, name)()
        if name == "peaucellier":
            theta = np.linspace(-0.5, 0.5, ANGLES)
        system, route = Constraints(machine), "Newton, blocks" if name in CHAINS[-2:] else "dyads"
        alone, both = (cpu(partial(posed, machine, theta, order)) for order in (0, 2))
        judged = cpu(partial(close, system, theta), 3)
        mine, judge = places(machine, theta)
        error = ""
        if name == "four_bar":
            made = solve(machine, theta, 0)["B"]
            error = f"{float(np.max(np.abs(made - exact(theta)))):.0e} mm"
        differ = f"{np.nanmax(np.abs(mine - judge)):.0e} mm"
        rows.append(
            [
                name.replace("_", " "),
                route,
                f"{1e3 * alone:.2g} ms",
                f"{1e3 * both:.2g} ms",
                f"{1e3 * judged:.2g} ms",
                differ,
                error,
            ]
        )
        told(" | ".join(rows[-1]))
        theta = np.linspace(0, math.tau, ANGLES, endpoint=False)
    return table(heads, rows)


# ---- copies ----------------------------------------------------------------------------------------------------------


def copies(told: Callable[[str], None]) -> str:
    """By how much the error that 95 of 100 copies keep varies from seed to seed, over the number of copies."""
    heads = [
        "machine",
        "copies",
        "time",
        "error that 95 % keep",
        "varies by (one standard deviation)",
    ]
    rows, series = [], []
    for name, settings in (
        ("uniform-swing", ["parts.make='cams'"]),
        ("disc-cam", []),
        ("linkage", []),
    ):
        spread = spread_of(read_mechanism(ROOT / "specs" / f"{name}.toml", settings))
        output, varies = spread.outputs[0].name, []
        for samples in SAMPLES:
            begun = time.process_time()
            kept = [
                float(np.quantile(copies_of(spread, samples, seed).errors[output], 0.95))
                for seed in range(SEEDS)
            ]
            took = (time.process_time() - begun) / SEEDS
            varies.append(statistics.stdev(kept) / statistics.mean(kept))
            worth = f"{statistics.mean(kept):.4g}"
            rows.append(
                [name, f"{samples:,}", f"{1e3 * took:.2g} ms", worth, f"{100 * varies[-1]:.2g} %"]
            )
            told(" | ".join(rows[-1]))
        series.append((name.partition("-")[0], np.array(SAMPLES, float), 100 * np.array(varies)))
    steady = ("1 / root n", np.array(SAMPLES, float), 20 / np.sqrt(SAMPLES))
    plot = Plot("Scatter of the error that 95 % of copies keep", "copies", "%", [*series, steady])
    (HERE / "accuracy-copies.svg").write_bytes(image(figure_of([plot], log=True), "svg"))
    return table(heads, rows)


# ---- paths -----------------------------------------------------------------------------------------------------------


def paths(told: Callable[[str], None]) -> str:
    """Score of the front and least chamfer over the search's budget, on the second target, the hardest of the three."""
    points = np.loadtxt(HERE.parent / "reference" / "path_target_1.csv", delimiter=",") @ [1, 1j]
    goal = Goal(Target(points), 0.1, 10.0 / 2)
    rows, spent, missed = [], [], []
    for pairs, effort in BUDGETS:
        begun = time.process_time()
        found = front(
            search(
                goal, [kind for kind in kinds(pairs, 2) if len(kind.bodies) <= 2 * pairs], effort
            )
        )
        spent.append(time.process_time() - begun)
        score = area(found, goal)
        missed.append(1 - score)
        rows.append(
            [
                f"up to {2 * pairs}",
                str(effort),
                f"{spent[-1]:.3g} s",
                f"{score:.4f}",
                f"{found[0].error:.5f}" if found else "none",
            ]
        )
        told(" | ".join(rows[-1]))
    plot = Plot(
        "What the front leaves, over the search's time",
        "processor time, s",
        "1 - score",
        [("target 1", np.array(spent), np.array(missed))],
    )
    (HERE / "accuracy-paths.svg").write_bytes(image(figure_of([plot], log=True), "svg"))
    return table(["links", "effort", "processor time", "score", "least chamfer"], rows)


WORKS = {"closing": closing, "copies": copies, "paths": paths}

if __name__ == "__main__":
    asked = [name for name in WORKS if name in sys.argv] or list(WORKS)
    for name in asked:
        print(name)
        made = WORKS[name](print)
        if "--results" in sys.argv:
            PAGE.write_text(put(PAGE.read_text(encoding="utf-8"), name, made), encoding="utf-8")
