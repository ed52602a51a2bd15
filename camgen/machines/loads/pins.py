"""PIN_STRESS: what bends a pin, what it bears, and by which keys of the spec it bears more."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from camgen.findings import Finding, Where, at_most
from camgen.machine import strength
from camgen.parts import materials
from camgen.parts.journals import Journal, MaterialLimits

STILL = 1e-9  # N, below which nothing presses
_STEEL = 350  # MPa
_STEEL_BY = {  # keys that make them of steel, and their value there
    "pin": {"pin": "dowel", "pins": "steel"},
    "shaft": {"shaft_made": "steel"},
    "crank-pin": {"shaft_made": "steel"},
}


@dataclass(frozen=True)
class Bent:
    """A pin under its greatest force, by what it bears least of: bending, or shear as bending as bad."""

    name: str
    journal: Journal
    force: float  # N
    bending: float  # MPa
    shear: float  # MPa
    limits: MaterialLimits  # of its spec
    fast: bool  # inertia alone loads it

    @property
    def given(self) -> float | None:
        """The limit of the spec, MPa."""
        return self.limits.pin_stress

    @property
    def stress(self) -> float:
        """The worse, MPa."""
        return max(self.bending, self.shear / strength.SHEAR)

    @property
    def how(self) -> str:
        """How it comes about."""
        bent = f"bent on an arm of {self.journal.lever:.4g} mm"
        return max((self.bending, bent), (self.shear / strength.SHEAR, "sheared"))[1]

    @property
    def overstated(self) -> bool:
        """Whether it holds by the spec's word alone, for it is printed and its plastic does not bear this."""
        own = (
            self.journal.shaft != materials.STEEL.name
            and self.stress > materials.of(self.journal.shaft).bears
        )
        return own and self.given is not None and self.stress <= self.given

    def finding(self) -> Finding:
        """PIN_STRESS."""
        row = materials.of(self.journal.shaft)
        limit = self.given or row.bears
        by = "limits.pin_stress_mpa" if self.given else f"{row.name} bears {row.bears:g} MPa"
        remark = f"by {self.force:.4g} N, {self.how}; {by}"
        remark += "" if self.stress <= limit else f"; {stronger(self.limits, self.journal)}"
        holds = math.sqrt(limit / self.stress) if self.stress else math.inf
        remark += (
            f", by inertia alone: {holds:.3g} times the speed holds"
            if self.fast and math.isfinite(holds)
            else ""
        )
        return at_most("PIN_STRESS", self.stress, limit, "MPa", Where(f"pin {self.name}"), remark)


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


def stronger(limits: MaterialLimits, pin: Journal) -> str:
    """What makes a pin or a shaft bear more, by the keys that its table of sizes has."""
    table = limits.table
    keys = limits.keys
    kind = next((kind for kind in ("shaft", "crank-pin", "pin") if kind in pin.part), "")
    diameter = f"{kind.removeprefix('crank-')}_diameter"
    wide = f" ({table}.{diameter})" if diameter in keys else ""
    if pin.shaft == materials.STEEL.name:
        return f"make it thicker{wide} or shorter"
    key, value = next(
        ((key, value) for key, value in _STEEL_BY.get(kind, {}).items() if key in keys), ("", "")
    )
    say = (
        f'or of steel ({table}.{key} = "{value}")'
        if key
        else f"or of steel and say so (limits.pin_stress_mpa = {_STEEL})"
    )
    return f"make it thicker{wide} or shorter, {say}"
