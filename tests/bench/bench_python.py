"""A four-bar evaluated again and again from Python: other lengths, a machine, the path of a point at 72 angles.

Run from the checkout: python tests/bench/bench_python.py [COUNT]
"""

from __future__ import annotations

import math
import statistics
import sys
import time
from pathlib import Path

import numpy as np

import camgen

SPEC = Path(__file__).parent.parent.parent / "specs" / "linkage.toml"
ANGLES = 72
MANY = 100_000
GOAL = 60.0  # s for so many
SPREAD = {"lengths.O-A": (18, 22), "lengths.A-B": (57, 63), "lengths.C-B": (47, 53)}


def main(count: int = 5_000) -> None:
    base = camgen.load(SPEC)
    theta = np.linspace(0, math.tau, ANGLES, endpoint=False)
    rng = np.random.default_rng(0)
    lengths = {key: rng.uniform(*ends, count) for key, ends in SPREAD.items()}
    base.replace({"lengths.A-B": 61}).solve(theta, 0)["pen"]
    width = 0.0
    times = []
    for k in range(count):
        begun = time.perf_counter()
        machine = base.replace({key: values[k] for key, values in lengths.items()})
        width = max(width, float(np.ptp(machine.solve(theta, 0)["pen"].real)))
        times.append(time.perf_counter() - begun)
    each = statistics.median(times)  # the mean is also that of whoever else uses the machine
    print(
        f"{count:,} four-bars, {len(SPREAD)} lengths anew, a path at {ANGLES} angles: {1e3 * each:.2f} ms each"
    )
    print(
        f"  {MANY:,} in {MANY * each:.0f} s (goal {GOAL:g}); the widest path is {width:.6g} mm wide"
    )
    begun = time.process_time()
    refused = 20
    for k in range(refused):
        try:
            base.replace({"lengths.O-A": 45 + k / 100}).solve(theta, 0)
        except camgen.DesignError as error:
            said = error.sentence
    print(f"  one that is refused: {1e3 * (time.process_time() - begun) / refused:.3f} ms ({said})")


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))
