"""From a wanted path to a machine: a bean and the three targets of tests/reference, 100 mm long, with six links at most.

Run from the checkout: python tests/bench/bench_designs.py. Some four minutes of a processor. The third target has a tip that no
six links reach within a twentieth of its length; its tolerance is 12 mm.
"""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from camgen.design.front import Front
from camgen.design.run import design
from camgen.design.weighing import Designs

TARGETS = Path(__file__).parents[1] / "reference"
LENGTH = 100.0  # mm, of each path's longest chord
PARTS = {"thickness": 3, "pin_diameter": 3, "wall": 1.6}


def wishes() -> Mapping[str, dict[str, Any]]:
    turn = np.linspace(0, 2 * np.pi, 49)
    bean = 50 * np.cos(turn) + 1j * (22 * np.sin(turn) - 24 * np.cos(turn) ** 2)
    found: dict[str, dict[str, Any]] = {"bean": {"path": _places(bean)}}
    for number in range(3):
        points = np.loadtxt(TARGETS / f"path_target_{number}.csv", delimiter=",") @ [1, 1j]
        chord = np.abs(points[:, None] - points[None]).max()
        found[f"target {number}"] = {"path": _places(LENGTH / chord * points), "joined": False}
    found["target 2"]["tolerance"] = 12
    return found


def _places(points: np.ndarray[Any, Any]) -> list[list[float]]:
    return [[round(z.real, 3), round(z.imag, 3)] for z in points.tolist()]


def spent() -> float:
    """Processor time of this process and its workers, s."""
    return sum(os.times()[:4])


def main() -> None:
    plain = Designs.weighed
    begun: list[float] = []

    def timed(self: Designs, *others: Any) -> Any:
        begun.append(spent())
        return plain(self, *others)

    Designs.weighed = timed  # type: ignore[method-assign]
    for name, wanted in wishes().items():
        fronts: list[Front] = []
        first = spent()
        data = {"mechanism": "linkage", "name": "found", "wanted": {**wanted, "bars": 6}}
        design({**data, "parts": PARTS}, keep=fronts.append)
        row = fronts[0].rows[0]
        holding = sum(each["verdict"] == "holds" for each in fronts[0].rows)
        print(
            f"{name}: {holding} of {len(fronts[0].rows)} designs hold; written: worst {row['worst_distance_mm']:.3g} mm, "
            f"play {row['lash']:.3g} mm, bars {row['bars_mm']:.4g} mm, {row['parts'] or 'one plate'}; "
            f"search {begun[-1] - first:.0f} s, weighing {spent() - begun[-1]:.1f} s of processor time",
            flush=True,
        )


if __name__ == "__main__":
    main()
