"""What of a linkage's outputs is one number: an angle, a place along a slide, one axis of a path."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from camgen.geometry.outlines import Floats
from camgen.machine.model import Angle, Machine, Path
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


def signals_of(machine: Machine) -> tuple[Signal, ...]:
    """What the outputs of a machine give, as single numbers."""
    signals = []
    for output in machine.outputs:
        if isinstance(output.of, Path):
            signals += [
                Signal(f"{output.name}_x", "mm", output.name),
                Signal(f"{output.name}_y", "mm", output.name, 1j),
            ]
        else:
            unit = "deg" if isinstance(output.of, Angle) else "mm"
            signals.append(Signal(output.name, unit, output.name))
    return tuple(signals)
