"""The search for paths on the three targets of tests/reference: the area of its front, and the time that it takes.

Run from the checkout: python tests/bench/bench_paths.py [EFFORT]. About a minute of two cores for each target. Score as in the
MIT 2.156 challenge of 2023: the share below (chamfer 0.1, material 10) that the front dominates, each bar counted twice.
"""

from __future__ import annotations

import os
import sys
import time
from pathlib import Path

import numpy as np
from front_area import area

from camgen.design.paths import front, kinds, search
from camgen.design.polish import Goal
from camgen.design.target import Target
from camgen.workers import Workers

TARGETS = Path(__file__).parents[1] / "reference"
# mean of the three wanted here; what a team of students reached
GOAL = 0.85
STUDENTS = (0.73, 0.55, 0.80)


def main(effort: int) -> None:
    scores = []
    for number, theirs in enumerate(STUDENTS):
        points = np.loadtxt(TARGETS / f"path_target_{number}.csv", delimiter=",") @ [1, 1j]
        goal = Goal(Target(points), 0.1, 10.0 / 2)
        begun, spent = time.perf_counter(), sum(os.times()[:4])
        with Workers(2) as workers:
            found = front(search(goal, kinds(4, 2), effort, 0, workers.map))
        scores.append(area(found, goal))
        print(
            f"target {number}, effort {effort}: score {scores[-1]:.4f} (students {theirs}), {len(found)} designs, least chamfer "
            f"{found[0].error:.5f}, {time.perf_counter() - begun:.0f} s, processor {sum(os.times()[:4]) - spent:.0f} s",
            flush=True,
        )
    print(f"mean score {np.mean(scores):.4f} (goal {GOAL})")


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 1)
