"""What a design is worth as a machine: whether its parts can be made and pass each other, and its play."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from camgen.errors import CamgenError
from camgen.findings import Finding
from camgen.machine.model import unit_of
from camgen.reading import Data

if TYPE_CHECKING:
    from camgen.machines.mechanism import Mechanism

_ANGLES = 361  # at which the play is looked at


@dataclass(frozen=True)
class Prototype:
    """A design as a machine."""

    data: Data  # tables of its spec, whose first output is what was wanted
    miss: str  # what of the wish it does not keep; empty where it keeps it

    @cached_property
    def _mechanism(self) -> Mechanism | CamgenError:
        from camgen.machines import MECHANISMS, load
        from camgen.spec import choose, validate

        try:
            mechanism = validate(load(choose(self.data, MECHANISMS)), self.data)
            _ = mechanism.assembly
        except CamgenError as error:
            return error
        return mechanism

    @property
    def obstacle(self) -> str:
        """Why its parts cannot be made, or do not pass each other; empty where they do."""
        return (
            str(self._mechanism).partition("\n")[0]
            if isinstance(self._mechanism, CamgenError)
            else ""
        )

    @cached_property
    def failures(self) -> Sequence[Finding]:
        """Limits that it does not keep, if its parts can be made."""
        return (
            []
            if isinstance(self._mechanism, CamgenError)
            else [each for each in self._mechanism.forecast() if not each.ok]
        )

    @property
    def refusal(self) -> str:
        """Why it cannot be built as it stands: its parts, or the limits that it does not keep; empty where it can."""
        return self.obstacle or "; ".join(
            beyond(each.code, each.measured, each.limit, each.unit) for each in self.failures
        )

    @cached_property
    def lash(self) -> float:
        """Free play of the output, mm or deg, by that of all joints at the worst angle, as LASH judges it; nan without parts."""
        if isinstance(self._mechanism, CamgenError):
            return math.nan
        output = self._mechanism.model.outputs[0]
        play = self._mechanism.solve(
            np.linspace(*self._mechanism.assembly.cycle.range, _ANGLES), 1
        ).play(output.name)
        return 2 * unit_of(output)[1] * float(np.max(play.total))

    @property
    def of_use(self) -> bool:
        """Whether it can be built and is what was wanted."""
        return not self.refusal and not self.miss

    @property
    def row(self) -> Mapping[str, Any]:
        """Its columns in the table of a front."""
        lash = float(f"{self.lash:.4g}") if math.isfinite(self.lash) else None
        return {
            "lash": lash,
            "verdict": "holds" if self.of_use else "refused",
            "reason": self.refusal or self.miss,
        }


def miss(code: str, error: float, limit: float, unit: str) -> str:
    """What to say of an error that is more than is borne; empty of one that is not."""
    return beyond(code, error, limit, unit) if error > limit else ""


def beyond(code: str, measured: float, limit: float, unit: str) -> str:
    """What to say of a limit that is not kept."""
    return f"{code} {measured:.4g}, the limit is {limit:.4g} {unit}"


def rounded_up(value: float) -> float:
    """To two digits, upwards."""
    if not value > 0:
        return 0.0
    unit = 10.0 ** (math.floor(math.log10(value)) - 1)
    return float(f"{math.ceil(value / unit) * unit:.3g}")
