"""Springs of round wire, cold coiled: extension springs, EN 13906-2, and compression springs, EN 13906-1; patented drawn wire
EN 10270-1 SM, than which SH and DH are stronger.

surge    the lowest at which its coils swing by themselves, sqrt(rate / mass) / 2: half a wave along the coils, both ends held
rate     G d^4 / (8 D^3 n)
stress   k 8 F D / (pi d^3), k = (w + 0.5) / (w - 0.75) by Bergstraesser, w = D / d; at most 0.45 of the wire's tensile
         strength, 1980 - 740 log10(d) N/mm^2: the least of SM within 0.5 % from 0.3 to 10 mm [mollificiomodenese.it, Carbon
         steel wire EN 10270-1, class SM: 1980 at 1 mm, 1760 at 2, 1530 at 4, 1310 at 8]
legs     where its closed coils and hooks are shorter than its free length, straight wire from the coils to either eye
fatigue  the amplitude of the stress at a mean keeps below Goodman's line for endless life, and the peak below what the wire bears
         at rest: of unpeened coils 241 N/mm^2 at a mean of 379 (Zimmerli's data), torsional strength 0.67 of the tensile one; of
         round eyes, bent, 0.45 of the tensile strength as peak from 0, at rest 0.75, with K = (4 w^2 - w - 1) / (4 w (w - 1))
         [amesweb.info, Stress analysis of extension spring for fatigue loading, and Maximum allowable stresses for coil
         extension springs, after Shigley, Mechanical Engineering Design; machinecalcs.com, Spring fatigue life calculator]
solid    of a compression spring with closed, ground ends: (n + 2) d; it is never pressed so far by 15 % of its greatest stretch
         [Shigley, Mechanical Engineering Design, eq. 10-17, table 10-1]
eyes     whole German ones, 0.8 to 1.1 of the inside diameter high: a round one [blog.federnshop.com/en/eyelet-shapes-extension-springs]
forces   of extension springs to DIN 2097, grade 2 [blog.federnshop.com/en/tension-spring-tolerances], of compression springs to
         EN 15800, grade 2
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from typing import Any, ClassVar

from camgen.parts.catalogue import Bought
from camgen.parts.materials import STEEL

# Wires of the series R10, mm: of springs in a machine, and of all.
_SLIM_WIRES = (0.2, 0.25, 0.32, 0.4, 0.5, 0.63, 0.8, 1.0, 1.25, 1.6, 2.0)
WIRES = (*_SLIM_WIRES, 2.5, 3.2, 4.0, 5.0, 6.3, 8.0)
EYE = 1.1  # of a spring, to the pin that it hooks on
_SHEAR = 81500.0  # N/mm^2
_SHARE = 0.45  # of the tensile strength
_TORSION = 0.67  # of the tensile strength: that in torsion
_ZIMMERLI = (241.0, 379.0)  # N/mm^2, amplitude and mean that unpeened coils bear for ever
_BENT = 0.75  # of the tensile strength: what a bent eye bears at rest
_BENDING = 0.45  # of the tensile strength: peak from 0 that it bears ten million times
_LEAST_COILS = 3.0
_INDEX = (4.0, 20.0)  # of D / d
_WIDER = (1.0, 1.25, 1.6, 2.0, 2.5)  # than its eyes need
_LONGER = 1.5  # than the shortest that does as well
_RESERVE = 0.15  # of a compression spring's greatest stretch, that it is off its solid length


_BESIDE = "between your frame and your follower"
_ROUND_STEM = (
    "round your follower's stem of {:g} mm, between its guide and its head, pressed together"
)
_WIRE = "EN 10270-1 SM"
_PLAY = 1.0  # mm, of a spring round a stem
_WIDER_COILS = (1.0, 1.25, 1.5, 2.0, 3.0)  # than its stem needs


@dataclass(frozen=True)
class Swing:
    """Stress that swings at one place of a spring's wire, N/mm^2.

    endurance: amplitude that it bears for ever about 0; ultimate: mean at which it bears none; most: its peak at rest.
    """

    place: str
    low: float
    high: float
    endurance: float
    ultimate: float
    most: float

    @property
    def amplitude(self) -> float:
        """Half of what it swings by."""
        return (self.high - self.low) / 2

    @property
    def mean(self) -> float:
        """Middle of it."""
        return (self.high + self.low) / 2

    @property
    def limit(self) -> float:
        """Amplitude that it bears for ever about its mean; 0 where it bears none."""
        goodman = self.endurance * (1 - self.mean / self.ultimate)
        return max(0.0, min(goodman, self.most - self.mean))

    @property
    def use(self) -> float:
        """Its amplitude as a share of that limit."""
        return self.amplitude / self.limit if self.limit else math.inf


@dataclass(frozen=True)
class HelicalSpring:
    """Wire, outside diameter and free length, mm; coils that give way; rate N/mm; no initial tension.

    stretches: 1 where its force grows with its length, -1 where it grows as it is pressed together.
    """

    stretches: ClassVar[int]

    wire: float
    outside: float
    coils: float
    free: float
    rate: float

    @property
    def mean(self) -> float:
        """Diameter of the wire's middle line, mm."""
        return self.outside - self.wire

    def force(self, length: Any) -> Any:
        """N at lengths, mm."""
        return self.stretches * self.rate * (length - self.free)

    def stress(self, length: float) -> float:
        """Of the wire, N/mm^2."""
        index = self.mean / self.wire
        return float(
            (index + 0.5)
            / (index - 0.75)
            * 8
            * self.force(length)
            * self.mean
            / (math.pi * self.wire**3)
        )

    @property
    def strength(self) -> float:
        """Stress that the wire bears, N/mm^2."""
        return _SHARE * self.tensile

    @property
    def tensile(self) -> float:
        """Least tensile strength of the wire, N/mm^2."""
        return 1980 - 740 * math.log10(self.wire)

    def swings(self, low: float, high: float) -> list[Swing]:
        """What swings in it between two lengths of little and much force, mm, at each place that may break."""
        torsion = _TORSION * self.tensile
        amplitude, mean = _ZIMMERLI
        endurance = amplitude / (1 - mean / torsion)
        stresses = self.stress(low), self.stress(high)
        return [Swing("coils", *stresses, endurance, torsion, self.strength)]

    def fatigue(self, shortest: float, longest: float) -> Swing:
        """What breaks first in it as it works between two lengths, mm."""
        low, high = sorted((shortest, longest), key=self.force)
        return max(self.swings(low, high), key=lambda each: each.use)

    def lasts(self, shortest: float, longest: float) -> bool:
        """Whether it works between two lengths, mm, for ever."""
        return self.fatigue(shortest, longest).use <= 1

    @property
    def surge(self) -> float:
        """Frequency of its own coils, Hz."""
        mass = math.pi**2 * self.wire**2 * self.mean * self.coils / 4 * STEEL.density * 1e-6  # kg
        return math.sqrt(1e3 * self.rate / mass) / 2


class ExtensionSpring(HelicalSpring):
    """Its lengths are between the insides of its eyes."""

    stretches = 1

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

    def bending(self, length: float) -> float:
        """Stress where an eye is bent, N/mm^2."""
        index = self.mean / self.wire
        curved = (4 * index**2 - index - 1) / (4 * index * (index - 1))
        section = math.pi * self.wire**2
        return float(self.force(length) * (16 * curved * index + 4) / section)

    def swings(self, low: float, high: float) -> list[Swing]:
        """Of its coils, and of its eyes."""
        peak = _BENDING / 2 * self.tensile
        endurance = peak / (1 - _BENDING / 2)
        bent = self.bending(low), self.bending(high)
        eyes = Swing("eyes", *bent, endurance, self.tensile, _BENT * self.tensile)
        return [*super().swings(low, high), eyes]

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
            f"and {self.force(longest):.4g} N at {longest:.4g}, {_WIRE}, no initial tension, whole German eyes, DIN 2097 grade 2"
        )
        return Bought("extension spring", "EN 13906-2", size, 1, "spring", key="spring.rate")


def _coils(wire: float, mean: float, rate: float) -> float:
    """Coils that give a spring of a wire and a mean diameter, mm, its rate, N/mm; 0 where it cannot be wound."""
    coils = _SHEAR * wire**4 / (8 * mean**3 * rate)
    windable = coils >= _LEAST_COILS and _INDEX[0] <= mean / wire <= _INDEX[1]
    return coils if windable else 0.0


def extension_spring(
    rate: float,
    free: float,
    way: tuple[float, float],
    eye: float,
    hook: float = 0.0,
    lasting: bool = False,
) -> ExtensionSpring | None:
    """The slimmest spring of a rate, N/mm, and free length whose wire bears its way, from its shortest to its longest, whose eyes
    are at least so wide inside and its hooks so long; mm; None where none can be.

    lasting: the slimmest that works so for ever; where none does, that which comes nearest to it.
    """
    strong = []
    for wider in _WIDER:
        for wire in _SLIM_WIRES:
            mean = wider * eye + wire
            coils = _coils(wire, mean, rate)
            spring = ExtensionSpring(wire, mean + wire, coils, free, rate)
            fits = coils and spring.least_free(hook) <= free
            if not fits or spring.stress(way[1]) > spring.strength:
                continue
            if not lasting or spring.lasts(*way):
                return spring
            strong.append(spring)
    return min(strong, key=lambda each: each.fatigue(*way).use, default=None)


def pulling(
    force: float,
    way: tuple[float, float],
    eye: float,
    shares: Iterable[float],
    hook: float = 0.0,
    lasting: bool = False,
) -> ExtensionSpring | None:
    """A spring that pulls with a force, N, at its shortest, where it is stretched by the first of these shares of its length
    for which there is one, lasting: for which one works for ever, if any does; way: its shortest and longest, mm."""
    shortest = way[0]
    found = []
    for stretch in shares:
        rate = force / (stretch * shortest)
        spring = extension_spring(rate, (1 - stretch) * shortest, way, eye, hook, lasting)
        if spring is not None and (not lasting or spring.lasts(*way)):
            return spring
        found += [] if spring is None else [spring]
    return found[0] if found else None


class CompressionSpring(HelicalSpring):
    """With closed and ground ends."""

    stretches = -1

    @property
    def inside(self) -> float:
        """Inside diameter, mm."""
        return self.outside - 2 * self.wire

    @property
    def solid(self) -> float:
        """Length at which its coils touch, mm."""
        return (self.coils + 2) * self.wire

    def bought(self, shortest: float, longest: float) -> Bought:
        """Its line in the parts list, with its forces at both ends of its way, mm."""
        size = (
            f"wire {self.wire:g}, inside diameter {self.inside:.3g}, {self.coils:.3g} coils and a closed, ground one at each end, "
            f"free length {self.free:.4g}, {self.rate:.4g} N/mm, {self.force(longest):.4g} N at {longest:.4g} "
            f"and {self.force(shortest):.4g} N at {shortest:.4g}, solid length {self.solid:.4g}, {_WIRE}, EN 15800 grade 2"
        )
        return Bought("compression spring", "EN 13906-1", size, 1, "spring", key="spring.rate")


def compression_spring(
    rate: float, force: float, travel: float, inside: float, outside: float
) -> WorkingSpring | None:
    """The slimmest spring of a rate, N/mm, that presses with a force, N, where it is longest, whose wire bears being pressed solid
    and that is hardly longer than others; inside, outside: its least and greatest diameters; mm. None where none can be."""
    widest = (outside - inside) / 2
    found: list[WorkingSpring] = []  # slim ones first
    for room in (0.0, 0.25, 0.5, 1.0):  # shares of the gap, by which it is wider than it needs be
        for wire in _SLIM_WIRES:
            mean = inside + wire + 2 * room * (widest - wire)
            if wire <= widest:
                found += _pressing(wire, mean, rate, force, travel)
    least = min((each.shortest for each in found), default=0.0)
    return next((each for each in found if each.shortest <= _LONGER * least), None)


@dataclass(frozen=True)
class WorkingSpring:
    """A spring where it works."""

    spring: ExtensionSpring | CompressionSpring
    shortest: float  # mm, of one with eyes inside them
    longest: float
    on_cam: bool = True  # whether it keeps a follower on its cam
    name: str = "spring"  # in its figures
    count: int = 1

    @property
    def lasts(self) -> bool:
        """Whether it works for ever."""
        return self.spring.lasts(self.shortest, self.longest)

    @property
    def tightest(self) -> float:
        """Length at which its wire bears most, mm."""
        return max(self.shortest, self.longest, key=self.spring.force)

    @property
    def bought(self) -> Bought:
        """Its line in the parts list."""
        return replace(self.spring.bought(self.shortest, self.longest), count=self.count)


def _pressing(
    wire: float, mean: float, rate: float, force: float, travel: float
) -> Iterator[WorkingSpring]:
    """A compression spring of a wire and a mean diameter, mm, as `compression_spring` has them; nothing where it cannot be wound, or
    its wire does not bear being pressed solid."""
    coils = _coils(wire, mean, rate)
    stretch = force / rate + travel
    spring = CompressionSpring(wire, mean + wire, coils, 0.0, rate)
    shortest = spring.solid + _RESERVE * stretch
    spring = replace(spring, free=shortest + stretch)
    if coils and spring.stress(spring.solid) <= spring.strength:
        yield WorkingSpring(spring, shortest, shortest + travel)


def wound(rate: float, low: float, travel: float) -> WorkingSpring | None:
    """A spring to be wound that pulls with `low` N at its shortest and by `rate` N/mm more over its travel, mm; the shortest
    that lasts, else the shortest whose stress its wire bears; None where none can be. Without a rate it grows by a third over its travel."""
    stiff = rate or low / 3 / travel
    springs: list[WorkingSpring] = []
    for index in (6.0, 8.0, 10.0, 12.0):
        for wire in WIRES:
            mean = index * wire
            coils = _coils(wire, mean, stiff)
            spring = ExtensionSpring(wire, mean + wire, coils, 0.0, stiff)
            spring = ExtensionSpring(wire, mean + wire, coils, spring.least_free(), stiff)
            shortest = spring.free + low / stiff
            if coils and spring.stress(shortest + travel) <= spring.strength:
                springs.append(WorkingSpring(spring, shortest, shortest + travel))
    springs = [each for each in springs if each.lasts] or springs
    return min(springs, key=lambda each: each.shortest, default=None)


def round_stem(rate: float, low: float, travel: float, stem: float) -> WorkingSpring | None:
    """A compression spring to be wound round a stem of a diameter, mm, that presses with `low` N at its longest and by `rate` N/mm
    more over its travel, mm; the slimmest that lasts, of these the shortest; None where none does. Without a rate as `wound`."""
    stiff = rate or low / 3 / travel
    for wider in _WIDER_COILS:
        springs: list[WorkingSpring] = []
        for wire in WIRES:
            mean = wider * (stem + _PLAY) + wire
            springs += _pressing(wire, mean, stiff, low, travel)
        lasting = [each for each in springs if each.lasts]
        if lasting:
            return min(lasting, key=lambda each: each.longest)
    return None


def wished(wish: tuple[float, float, float] | None, stem: float = 0.0) -> dict[str, WorkingSpring]:
    """A return spring that is no part, by its name in findings; wish: rate, N/mm, least pull, N, travel, mm. None where none
    is asked for, or none can be.

    stem: diameter of that round which it presses, mm; 0, or where no such spring lasts: it pulls."""
    spring = None if wish is None or not stem else round_stem(*wish, stem)
    spring = spring or (None if wish is None else wound(*wish))
    return {} if spring is None else {"return spring, made to order": spring}


def to_wind(wish: tuple[float, float, float] | None, stem: float = 0.0) -> list[Bought]:
    """Lines in the parts list of the same; where none can be wound, what is asked of a spring that is yours to choose."""
    if wish is None:
        return []
    found = wished(wish, stem)
    if found:
        return [
            replace(each.bought, name=name, role="", how=_fitted(each, stem))
            for name, each in found.items()
        ]
    rate, low, travel = wish
    size = f"preload {low:.4g} N, rate {rate or low / 3 / travel:.4g} N/mm, stretched {travel:.4g} mm further: yours to choose"
    return [Bought("return spring", "", size, 1, how=_BESIDE)]


def _fitted(spring: WorkingSpring, stem: float) -> str:
    """Where a spring to be wound goes, and how long it is there; stem: that round which it presses, mm."""
    if spring.spring.stretches < 0:
        where = f"{_ROUND_STEM.format(stem)} to {spring.longest:.4g}"
    else:
        where = f"{_BESIDE}, stretched to {spring.shortest:.4g}"
    return f"{where} while the follower is lowest"
