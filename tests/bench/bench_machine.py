"""Positions and two derivatives of known chains by the maker's route, 3,600 angles; best of several.

    python tests/bench/bench_machine.py

first: with the machine parted into steps and followed anew (a spec's first look); again: as every later call. The judge's
route and the forces are told beside it.
"""

from __future__ import annotations

import math
import sys
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parent.parent / "machine"))

from chains import CHAINS  # noqa: E402

from camgen.machine import solve  # noqa: E402
from camgen.machine.closing import close  # noqa: E402
from camgen.machine.constraints import Constraints  # noqa: E402
from camgen.machine.loops import Chain, chain_of  # noqa: E402
from camgen.machine.newton import Block  # noqa: E402
from camgen.machine.state import Dyad  # noqa: E402

COUNT = 3_600
WANTED = {"four-bar": 0.3, "Jansen": 0.5, "Stephenson III": 30.0, "double butterfly": 30.0}


def best(job: Callable[[], object], rounds: int) -> float:
    """Milliseconds of the fastest of several calls."""
    job()
    spent = []
    for _ in range(rounds):
        start = time.perf_counter()
        job()
        spent.append(time.perf_counter() - start)
    return min(spent) * 1e3


def main() -> None:
    """Print the table."""
    theta = np.arange(COUNT) * (math.tau / COUNT)
    print(
        f"{COUNT:,} angles, two derivatives; ms{'':24} {'again':>8} {'first':>8} {'wanted':>7} {'judge':>8} {'forces':>8}"
    )
    for name, make in CHAINS.items():
        machine = make()
        chain = chain_of(machine)
        first = best(lambda machine=machine: Chain(machine).state(theta, 2), 3)
        again = best(lambda chain=chain: chain.state(theta, 2), 50)
        system, run = Constraints(machine), solve(machine, theta)
        guess = run._poses[0]
        judge = best(lambda system=system, guess=guess: close(system, theta, guess), 1)
        forces = best(lambda machine=machine: solve(machine, theta).forces(), 1)
        blocks = [step for step in chain.steps if isinstance(step, Dyad | Block)]
        kinds = " ".join(
            step.kind if isinstance(step, Dyad) else f"Newton:{step.size}" for step in blocks
        )
        wanted = f"{WANTED[name]:g}" if name in WANTED else ""
        print(
            f"{name:30} {kinds:24.24} {again:8.3f} {first:8.1f} {wanted:>7} {judge:8.0f} {forces:8.0f}"
        )


if __name__ == "__main__":
    main()
