"""A million four-bar designs at 64 angles, and variants of a sweep a second.

Run from the checkout: python tests/bench/bench_many.py
"""

from __future__ import annotations

import math
import statistics
import time
from pathlib import Path

import numpy as np

from camgen.machine.four_bars import four_bars
from camgen.sweep.run import rows_of, task_of
from camgen.sweep.variants import variants

COUNT = 1_000_000
ANGLES = 64
GOAL = 2.0
SPECS = Path(__file__).parent.parent.parent / "specs"
CROWD = 4_000
VARY = (
    ("disc-cam", "geometry.base_radius=16:40 geometry.follower.offset=-4:4"),
    ("disc-cam", "geometry.base_radius=16:40 geometry.follower.radius=2:7 segment.0.lift=5:20"),
    ("uniform-swing", "geometry.swing_deg=20:30"),
    ("eccentric-drive", "geometry.rod=40:60"),
    ("linkage", "lengths.A-B=70:80"),
    ("thread-take-up", "geometry.coupler=17:21"),
)


def main() -> None:
    lengths = np.random.default_rng(0).uniform(10, 60, (4, COUNT))
    theta = np.linspace(0, math.tau, ANGLES, endpoint=False)
    times = []
    for _ in range(3):
        begun, closed = time.process_time(), 0
        for block in four_bars(*lengths, theta):
            least, _most = block.transmission
            closed += int(
                np.count_nonzero(np.isfinite(block.output_range) & (least > math.radians(40)))
            )
        times.append(time.process_time() - begun)
    took = statistics.median(times)
    what = f"{COUNT:,} four-bars x {ANGLES} angles, positions, transmission angles, output range"
    print(f"{what}: {took:.2f} s of one core (goal {GOAL:g} s)")
    print(f"  of them close over the turn and keep 40 deg: {closed:,}")
    for name, vary in VARY:
        task = task_of(
            SPECS / f"{name}.toml", variants(vary.split(), latin=CROWD), (), (), (), Path()
        )
        count = CROWD if name == "disc-cam" else 10
        rows_of(task, range(2))
        begun = time.process_time()
        rows_of(task, range(count))
        took = time.process_time() - begun
        print(f"sweep of {name}, {vary}: {count / took:.0f} variants a second on one core")


if __name__ == "__main__":
    main()
