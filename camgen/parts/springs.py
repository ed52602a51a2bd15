"""Extension springs of round wire, cold coiled: EN 13906-2; patented drawn wire EN 10270-1 SH.

surge    the lowest at which its coils swing by themselves, sqrt(rate / mass) / 2: half a wave along the coils, both ends held
rate     G d^4 / (8 D^3 n)
stress   k 8 F D / (pi d^3), k = (w + 0.5) / (w - 0.75) by Bergstraesser, w = D / d; at most 0.45 of the wire's tensile
         strength
legs     where its closed coils and hooks are shorter than its free length, straight wire from the coils to either eye
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from typing import Any

from camgen.parts.catalogue import Bought
from camgen.parts.materials import STEEL

WIRES = (0.2, 0.25, 0.32, 0.4, 0.5, 0.63, 0.8, 1.0, 1.25, 1.6, 2.0)  # mm, of the series R10
EYE = 1.1  # of a spring, to the pin that it hooks on
_SHEAR = 81500.0  # N/mm^2
_SHARE = 0.45  # of the tensile strength
_LEAST_COILS = 3.0
_INDEX = (4.0, 20.0)  # of D / d
_WIDER = (1.0, 1.25, 1.6, 2.0, 2.5)  # than its eyes need


_BESIDE = "between your frame and your follower"


@dataclass(frozen=True)
class ExtensionSpring:
    """Wire, outside diameter and free length between the insides of its eyes, mm; coils; rate N/mm; no initial tension."""

    wire: float
    outside: float
    coils: float
    free: float
    rate: float

    def force(self, length: Any) -> Any:
        """N at lengths between the insides of its eyes, mm."""
        return self.rate * (length - self.free)

    def stress(self, length: float) -> float:
        """Of the wire, N/mm^2."""
        mean = self.outside - self.wire
        index = mean / self.wire
        return float(
            (index + 0.5)
            / (index - 0.75)
            * 8
            * self.force(length)
            * mean
            / (math.pi * self.wire**3)
        )

    @property
    def strength(self) -> float:
        """Stress that the wire bears, N/mm^2."""
        return _SHARE * (1980 - 740 * math.log10(self.wire))

    @property
    def surge(self) -> float:
        """Frequency of its own coils, Hz."""
        mean = self.outside - self.wire
        mass = math.pi**2 * self.wire**2 * mean * self.coils / 4 * STEEL.density * 1e-6  # kg
        return math.sqrt(1e3 * self.rate / mass) / 2

    def least_free(self, hook: float = 0.0) -> float:
        """Free length of its closed coils and two eyes, round or with hooks that are longer, mm."""
        return self.body + 2 * max(hook, self.outside - 2 * self.wire)

    @property
    def body(self) -> float:
        """Length of its closed coils, mm."""
        return (self.coils + 1) * self.wire

    @property
    def leg(self) -> float:
        """From its closed coils to the inside of either eye, mm; a round eye alone has its inside diameter."""
        return (self.free - self.body) / 2

    def bought(self, shortest: float, longest: float) -> Bought:
        """Its line in the parts list, with its forces at both ends of its way, mm."""
        legs = (
            ""
            if self.leg <= 1.01 * (self.outside - 2 * self.wire)
            else f" and a leg of {self.leg:.4g} at each end"
        )
        size = (
            f"wire {self.wire:g}, outside diameter {self.outside:.3g}, {self.coils:.3g} coils, free length {self.free:.4g} "
            f"inside the eyes: closed coils of {self.body:.4g}{legs}, "
            f"{self.rate:.4g} N/mm, {self.force(shortest):.4g} N at {shortest:.4g} "
            f"and {self.force(longest):.4g} N at {longest:.4g}"
        )
        return Bought("extension spring", "EN 13906-2", size, 1, "spring")


def extension_spring(
    rate: float, free: float, longest: float, eye: float, hook: float = 0.0
) -> ExtensionSpring | None:
    """The slimmest spring of a rate, N/mm, and free length whose eyes are at least so wide inside, its hooks so long; mm; None
    where none can be."""
    for wider in _WIDER:
        for wire in WIRES:
            mean = wider * eye + wire
            coils = _SHEAR * wire**4 / (8 * mean**3 * rate)
            spring = ExtensionSpring(wire, mean + wire, coils, free, rate)
            windable = (
                coils >= _LEAST_COILS
                and _INDEX[0] <= mean / wire <= _INDEX[1]
                and spring.least_free(hook) <= free
            )
            if windable and spring.stress(longest) <= spring.strength:
                return spring
    return None


def pulling(
    force: float,
    shortest: float,
    longest: float,
    eye: float,
    shares: Iterable[float],
    hook: float = 0.0,
) -> ExtensionSpring | None:
    """A spring that pulls with a force, N, at its shortest, where it is stretched by the first of these shares of its length
    for which there is one."""
    for stretch in shares:
        spring = extension_spring(
            force / (stretch * shortest), (1 - stretch) * shortest, longest, eye, hook
        )
        if spring is not None:
            return spring
    return None


@dataclass(frozen=True)
class WorkingSpring:
    """A spring where it works."""

    spring: ExtensionSpring
    shortest: float  # inside its eyes, mm
    longest: float
    made: bool = True  # whether it hangs in the machine; else it is only proposed
    on_cam: bool = True  # whether it keeps a follower on its cam
    name: str = "spring"  # in its figures

    @property
    def bought(self) -> Bought:
        """Its line in the parts list."""
        return self.spring.bought(self.shortest, self.longest)


def wound(rate: float, low: float, travel: float) -> WorkingSpring | None:
    """A spring to be wound that pulls with `low` N at its shortest and by `rate` N/mm more over its travel, mm; the shortest
    whose stress its wire bears; None where none can be. Without a rate it grows by a third over its travel."""
    stiff = rate or low / 3 / travel
    springs: list[WorkingSpring] = []
    for index in (6.0, 8.0, 10.0, 12.0):
        for wire in WIRES:
            mean = index * wire
            coils = _SHEAR * wire**4 / (8 * mean**3 * stiff)
            spring = ExtensionSpring(wire, mean + wire, coils, 0.0, stiff)
            spring = ExtensionSpring(wire, mean + wire, coils, spring.least_free(), stiff)
            shortest = spring.free + low / stiff
            if coils >= _LEAST_COILS and spring.stress(shortest + travel) <= spring.strength:
                springs.append(WorkingSpring(spring, shortest, shortest + travel, False))
    return min(springs, key=lambda each: each.shortest, default=None)


def wished(wish: tuple[float, float, float] | None) -> dict[str, WorkingSpring]:
    """A return spring that is no part, by its name in findings; wish: rate, N/mm, least pull, N, travel, mm. None where none
    is asked for, or none can be."""
    spring = None if wish is None else wound(*wish)
    return {} if spring is None else {"return spring, to be wound": spring}


def to_wind(springs: Mapping[str, WorkingSpring]) -> list[Bought]:
    """Lines in the parts list of those that are no part."""
    return [
        replace(spring.bought, name=name, role="", how=_BESIDE)
        for name, spring in springs.items()
        if not spring.made
    ]
