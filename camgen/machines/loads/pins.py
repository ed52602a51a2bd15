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
_DIAMETER = {"pin": "pin_diameter", "shaft": "shaft_diameter", "crank-pin": "pin_diameter"}
_STEEL_BY = {  # keys that make them of steel, and their value there
    "pin": {"pin": "dowel", "pins": "steel"},
    "shaft": {"shaft_made": "steel"},
    "crank-pin": {"shaft_made": "steel"},
}


@dataclass(frozen=True)
class PinLoad:
    """A pin under its greatest force."""

    name: str
    journal: Journal
    force: float  # N
    limits: MaterialLimits  # of its spec
    inertia_alone: bool  # nothing else loads it

    @property
    def bending(self) -> float:
        """Stress of bending, MPa."""
        return float(strength.pin_bending(self.force, self.journal.lever, self.journal.diameter))

    @property
    def shear(self) -> float:
        """Shear stress, MPa."""
        return float(strength.pin_shear(self.force, self.journal.diameter))

    @property
    def stress(self) -> float:
        """What it bears least of, MPa: bending, or the bending that is as bad as its shear."""
        return max(self.bending, self.shear / strength.SHEAR)

    @property
    def overstated(self) -> bool:
        """Whether it holds by the spec's word alone, for it is printed and its plastic does not bear this."""
        limit = self.limits.pin_stress
        shaft = self.journal.shaft
        return (
            limit is not None
            and materials.of(shaft).printed
            and materials.of(shaft).bears < self.stress <= limit
        )

    def _thickness(self, limit: float) -> float:
        """Diameter, mm, at which the same force on the same lever gives a stress of `limit`, MPa."""
        bent = self.bending > self.shear / strength.SHEAR
        return self.journal.diameter * math.pow(self.stress / limit, 1 / 3 if bent else 1 / 2)

    def finding(self) -> Finding:
        """PIN_STRESS."""
        row = materials.of(self.journal.shaft)
        stress = self.stress
        limit = self.limits.pin_stress or row.bears
        how = "shears it"
        if self.bending > self.shear / strength.SHEAR:
            how = f"bends it on an arm of {self.journal.lever:.3g} mm"
        by = f"{row.name} bears {row.bears:g} MPa"
        if self.limits.pin_stress:
            by = "limits.pin_stress_mpa"
        remark = f"{self.force:.4g} N {how}; {by}"
        if stress > limit:
            remark += f". To mend it, {stronger(self.limits, self.journal, self._thickness(limit))}"
        if self.inertia_alone and stress:
            times = math.sqrt(limit / stress)
            most = f"up to {times:.3g}" if times < 1000 else "at more than 1000"
            remark += f". Inertia is the only load, so the pin holds {most} times this speed"
        return at_most("PIN_STRESS", stress, limit, "MPa", Where(f"pin {self.name}"), remark)


def overstated(pins: Sequence[PinLoad]) -> tuple[str, ...]:
    """Sentences on printed pins that hold by the spec's limit alone, one for each limit."""
    groups: dict[tuple[str, float], dict[str, float]] = {}
    for pin in pins:
        if not pin.overstated:
            continue
        part = pin.journal.part
        what = f"{part} (pin {pin.name})" if part not in ("", pin.name) else pin.name
        groups.setdefault((pin.journal.shaft, pin.limits.pin_stress or 0.0), {})[what] = pin.stress
    sentences = []
    for (plastic, limit), stresses in groups.items():
        stressed = ", ".join(f"{what} {stress:.3g} MPa" for what, stress in stresses.items())
        own = f"{plastic} bears {materials.of(plastic).bears:g} MPa"
        sentences.append(
            f"with limits.pin_stress_mpa = {limit:g} printed parts hold, but {own}: {stressed}; "
            f"make {'it' if len(stresses) == 1 else 'each'} of steel, because the parts list still says printed"
        )
    return tuple(sentences)


def stronger(limits: MaterialLimits, pin: Journal, thickness: float) -> str:
    """What makes a pin or a shaft bear its load, by the keys that its table of sizes has; thickness: that does, mm."""
    keys = limits.keys
    diameter = _DIAMETER.get(pin.role, "")
    thick = f"{math.ceil(10 * thickness) / 10:g}"
    wide = f" (parts.{diameter})" if diameter in keys else ""
    if not materials.of(pin.shaft).printed:
        return f"make the pin {thick} mm thick{wide} or shorter"
    steel = f" and say so (limits.pin_stress_mpa = {_STEEL})"
    for key, value in _STEEL_BY.get(pin.role, {}).items():
        if key in keys:
            steel = f' (parts.{key} = "{value}")'
            break
    return f"make the pin {thick} mm thick{wide} or shorter, or of steel{steel}"
