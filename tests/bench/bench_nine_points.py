"""Nine points by homotopy: all four-bars of the three cases of tests/reference/points.toml beside those of another program.

Run from the checkout: python tests/bench/bench_nine_points.py. Some ten seconds of a processor for each case.
"""

from __future__ import annotations

import math
import time
import tomllib
from pathlib import Path
from typing import Any

import numpy as np

from camgen.design.fourbars import FourBars
from camgen.design.nine_points import nine_point_four_bars

CASES = Path(__file__).parents[1] / "reference" / "points.toml"


def points(case: dict[str, Any]) -> np.ndarray[Any, Any]:
    """Of the case, or of its hidden four-bar."""
    if "points" in case:
        return np.array([complex(*place) for place in case["points"]])
    coupler = np.exp(1j * math.acos((70**2 + 50**2 - 60**2) / (2 * 70 * 50)))
    a = np.array([[30 + 0j]])
    ends = (np.array([0j]), np.array([80 + 0j]))
    hidden = FourBars(*ends, a, a + 70 * coupler, a + (25 + 30j) * coupler)
    return hidden.driven(np.radians(case["crank_deg"])).p[:, 0]


def main() -> None:
    for case in tomllib.loads(CASES.read_text())["nine"]:
        begun = time.process_time()
        bars = nine_point_four_bars(points(case))
        spent = time.process_time() - begun
        defects = bars.defects()
        turning = bars.turns
        branch = turning & ~defects["branch"]
        order = branch & ~defects["order"]
        counts = [len(bars.o) // 6, *(int(np.sum(flags)) for flags in (turning, branch, order))]
        wanted = [case[key] for key in ("classes", "turning", "branch", "order")]
        print(
            f"{case['name']}: real classes, turning drives, on one branch, in order {counts}, wanted {wanted}; "
            f"processor {spent:.0f} s",
            flush=True,
        )


if __name__ == "__main__":
    main()
