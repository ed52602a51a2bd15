"""PIN_STRESS: what bends a pin, what it bears, and by which keys of the spec it bears more."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from pydantic import BaseModel

from camgen.findings import Finding, at_most
from camgen.machine import strength
from camgen.machines.loads.tables import Bears
from camgen.parts import materials
from camgen.parts.journals import Journal

STILL = 1e-9  # N, below which nothing presses
_STEEL = 350  # MPa
_STEEL_BY = {  # keys that make them of steel, and their value there
    "pin": {"pin": "dowel", "pins": "steel"},
    "shaft": {"shaft_made": "steel"},
    "crank-pin": {"shaft_made": "steel"},
}

Stronger = Callable[[Journal], str]  # what makes a pin bear more


@dataclass(frozen=True)
class Bent:
    """A pin under its greatest force, N: the stress in it, MPa, and how it comes about; given: the limit of the spec, MPa.

    fast: inertia alone loads it.
    """

    name: str
    journal: Journal
    force: float
    stress: float
    how: str
    given: float | None
    fast: bool

    @property
    def overstated(self) -> bool:
        """Whether it holds by the spec's word alone, for it is printed and its plastic does not bear this."""
        own = (
            self.journal.shaft != materials.STEEL.name
            and self.stress > materials.of(self.journal.shaft).bears
        )
        return own and self.given is not None and self.stress <= self.given

    def finding(self, stronger: Stronger) -> Finding:
        """PIN_STRESS."""
        row = materials.of(self.journal.shaft)
        limit = self.given or row.bears
        by = "limits.pin_stress_mpa" if self.given else f"{row.name} bears {row.bears:g} MPa"
        remark = f"by {self.force:.4g} N, {self.how}; {by}"
        remark += "" if self.stress <= limit else f"; {stronger(self.journal)}"
        holds = math.sqrt(limit / self.stress) if self.stress else math.inf
        remark += (
            f", by inertia alone: {holds:.3g} times the speed holds"
            if self.fast and math.isfinite(holds)
            else ""
        )
        return at_most("PIN_STRESS", self.stress, limit, "MPa", f"pin {self.name}", remark)


def bent_by(
    name: str, journal: Journal, bent: float, sheared: float, force: float, bears: Bears, fast: bool
) -> list[Bent]:
    """A pin by what it bears least of: bending, or shear as bending as bad, MPa; none that nothing presses."""
    worse, how = max(
        (bent, f"bent on an arm of {journal.lever:.4g} mm"), (sheared / strength.SHEAR, "sheared")
    )
    return (
        [Bent(name, journal, force, worse, how, bears.pin_stress_mpa, fast)]
        if force > STILL
        else []
    )


def overstated(pins: Sequence[Bent]) -> tuple[str, ...]:
    """Sentences on printed pins that hold by the spec's limit alone, one for each limit."""
    groups: dict[tuple[str, float], dict[str, float]] = {}
    for pin in (pin for pin in pins if pin.overstated):
        part = pin.journal.part
        what = f"{part} (pin {pin.name})" if part not in ("", pin.name) else pin.name
        groups.setdefault((pin.journal.shaft, pin.given or 0.0), {})[what] = pin.stress
    found = []
    for (plastic, limit), stresses in groups.items():
        told = ", ".join(f"{what} {stress:.3g} MPa" for what, stress in stresses.items())
        own = f"{plastic} bears {materials.of(plastic).bears:g} MPa"
        found.append(
            f"limits.pin_stress_mpa = {limit:g} lets parts hold that are printed, and {own}: {told}; "
            f"make {'it' if len(stresses) == 1 else 'each'} of steel, for the parts list has it as printed"
        )
    return tuple(found)


def unsaid(pin: Journal) -> str:
    """Where no spec has keys of pins."""
    return stronger("", None, pin)


def stronger(table: str, sizes: BaseModel | None, pin: Journal) -> str:
    """What makes a pin or a shaft bear more, by the keys that its table of sizes has."""
    fields = {} if sizes is None else type(sizes).model_fields
    kind = next((kind for kind in ("shaft", "crank-pin", "pin") if kind in pin.part), "")
    diameter = f"{kind.removeprefix('crank-')}_diameter"
    wide = f" ({table}.{diameter})" if diameter in fields else ""
    if pin.shaft == materials.STEEL.name:
        return f"make it thicker{wide} or shorter"
    key, value = next(
        ((key, value) for key, value in _STEEL_BY.get(kind, {}).items() if key in fields), ("", "")
    )
    say = (
        f'or of steel ({table}.{key} = "{value}")'
        if key
        else f"or of steel and say so (limits.pin_stress_mpa = {_STEEL})"
    )
    return f"make it thicker{wide} or shorter, {say}"
