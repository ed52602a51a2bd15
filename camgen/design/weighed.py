"""What a design is worth as a machine: whether its parts can be made and pass each other, and its play."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from camgen.errors import CamgenError
from camgen.machine.model import unit_of
from camgen.reading import Data

if TYPE_CHECKING:
    from camgen.machines.mechanism import Mechanism

_ANGLES = 361  # at which the play is looked at


@dataclass(frozen=True)
class Weighed:
    """The tables of a design, whose first output is what was wanted."""

    data: Data

    @cached_property
    def _made(self) -> Mechanism | CamgenError:
        from camgen.machines import MECHANISMS, load
        from camgen.spec import choose, validate

        try:
            mechanism = validate(load(choose(self.data, MECHANISMS)), self.data)
            mechanism.parts()
        except CamgenError as error:
            return error
        return mechanism

    @cached_property
    def refused(self) -> str:
        """Why its parts cannot be made, do not pass each other, or do not keep a limit; empty where they do."""
        if isinstance(self._made, CamgenError):
            return str(self._made).partition("\n")[0]
        failing = [finding for finding in self._made.forecast() if not finding.ok]
        return "; ".join(f"{each.code} {each.measured:.4g}, the limit is {each.limit:.4g} {each.unit}" for each in failing)

    @cached_property
    def lash(self) -> float:
        """Free play of the output, mm or deg, by that of all joints at the worst angle, as LASH judges it; nan without parts."""
        if isinstance(self._made, CamgenError):
            return math.nan
        output = self._made.model.outputs[0]
        play = self._made.solve(np.linspace(*self._made.range, _ANGLES), 1).play(output.name)
        return 2 * unit_of(output)[1] * float(np.max(play.total))

    @property
    def row(self) -> Mapping[str, Any]:
        """Its columns in the table of a front."""
        lash = float(f"{self.lash:.4g}") if math.isfinite(self.lash) else None
        return {"lash": lash, "verdict": "holds" if not self.refused else "refused", "reason": self.refused}


def rounded_up(value: float) -> float:
    """To two digits, upwards."""
    if not value > 0:
        return 0.0
    unit = 10.0 ** (math.floor(math.log10(value)) - 1)
    return float(f"{math.ceil(value / unit) * unit:.3g}")
