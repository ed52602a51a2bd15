"""What a linkage's outputs give, as single numbers over theta: columns of tables and curves."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from camgen.geometry.outlines import Floats
from camgen.machine import model as m
from camgen.machine.run import Run


@dataclass(frozen=True)
class Signal:
    """One number of an output: column's name without its unit, unit for people ("deg" or "mm").

    of: the output's name; turned: unit complex that the output is divided by before its real part is taken.
    """

    name: str
    unit: str
    of: str
    turned: complex = 1.0

    @property
    def scale(self) -> float:
        """How many of the unit one rad or mm is."""
        return math.degrees(1) if self.unit == "deg" else 1.0

    def rows(self, run: Run) -> Floats:
        """It with its derivatives to theta, (order + 1, n) rad or mm."""
        return np.asarray(np.real(run.derivatives(self.of) / self.turned))


def signals(machine: m.Machine) -> Iterator[Signal]:
    """Those of all outputs: of a path its two coordinates."""
    for output in machine.outputs:
        if isinstance(output.of, m.Path):
            yield Signal(f"{output.name}_x", "mm", output.name)
            yield Signal(f"{output.name}_y", "mm", output.name, 1j)
        else:
            yield Signal(output.name, "deg" if isinstance(output.of, m.Angle) else "mm", output.name)
