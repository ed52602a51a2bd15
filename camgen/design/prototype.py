"""What a design is worth as a machine: whether its parts can be made and pass each other, and its play."""

from __future__ import annotations

import json
import math
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from camgen.errors import CamgenError, counted
from camgen.findings import Finding
from camgen.machine.model import unit_of
from camgen.reading import Data

if TYPE_CHECKING:
    from camgen.machines.mechanism import Mechanism

_ANGLES = 361  # at which the play is looked at


@dataclass(frozen=True)
class Prototype:
    """What is known of a design as a machine."""

    miss: str  # what of the wish it does not keep; empty where it keeps it
    obstacle: str  # why its parts cannot be made, or do not pass each other; empty where they do
    failures: Sequence[Finding]  # limits that it does not keep, if its parts can be made
    lash: float  # free play of the output, mm or deg, as LASH judges it; nan without parts
    sizes: Mapping[str, Any]  # keys of [parts] that it has beside those of the spec

    @property
    def refusal(self) -> str:
        """Why it cannot be built as it stands: its parts, or the limits that it does not keep; empty where it can."""
        return self.obstacle or "; ".join(
            beyond(each.code, each.measured, each.limit, each.unit) for each in self.failures
        )

    @property
    def of_use(self) -> bool:
        """Whether it can be built and is what was wanted."""
        return not self.refusal and not self.miss

    @property
    def verdict(self) -> str:
        """One word: "holds", "fails" where it can be built but keeps not all that is wanted, "refused" where it cannot be built."""
        if self.obstacle:
            return "refused"
        return "holds" if self.of_use else "fails"

    @property
    def frame(self) -> str:
        """The keys of [parts] that it has beside those of the spec, as a person types them; empty without any."""
        return ", ".join(f"parts.{key} = {json.dumps(value)}" for key, value in self.sizes.items())

    @property
    def row(self) -> Mapping[str, Any]:
        """Its columns in the table of a front."""
        lash = float(f"{self.lash:.4g}") if math.isfinite(self.lash) else None
        return {
            "lash": lash,
            "verdict": self.verdict,
            "parts": self.frame,
            "reason": self.refusal or self.miss,
        }


def prototype(data: Data, miss: str) -> Prototype:
    """Of the tables of a linkage's spec, whose first output is what was wanted."""
    from camgen.machines.linkage.mechanism import Linkage
    from camgen.spec import validate

    try:
        machine, change = validate(Linkage, data).on_a_frame()
        failures = [each for each in machine.forecast() if not each.ok]
    except CamgenError as error:
        return Prototype(miss, str(error).partition("\n")[0], (), math.nan, {})
    return Prototype(miss, "", failures, _lash(machine), change.sizes)


def _lash(machine: Mechanism) -> float:
    """Free play of the first output by that of all joints at the worst angle, mm or deg."""
    output = machine.model.outputs[0]
    theta = np.linspace(*machine.assembly.cycle.range, _ANGLES)
    play = machine.solve(theta, 1).play(output.name)
    return 2 * unit_of(output)[1] * float(np.max(play.total))


def tally(judged: Sequence[Prototype], far: int = 0) -> str:
    """How many designs are of use, and why the others are not; far: others, too far from the wish for their parts to be made."""
    useful = sum(each.of_use for each in judged)
    text = f"{counted(len(judged) + far, 'design')} judged, {useful} of use"
    unmade = sum(bool(each.obstacle) for each in judged)
    far += sum(bool(each.miss) and not each.refusal for each in judged)
    codes = Counter(
        code for each in judged for code in dict.fromkeys(finding.code for finding in each.failures)
    )
    reasons = {"too far from what is wanted": far, "with parts that cannot be made": unmade}
    reasons |= {f"beyond {code}": count for code, count in codes.most_common()}
    others = [f"{count} {reason}" for reason, count in reasons.items() if count]
    return f"{text}; {', '.join(others)}" if others else text


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
