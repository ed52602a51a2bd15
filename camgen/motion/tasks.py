"""Motion tasks of VDI 2143: laws between ends that rest, move at constant velocity, reverse or move anyhow.

    letter   speed v   acceleration a   joins
    R        0         0                a dwell
    G        not 0     0                uniform motion
    U        0         not 0            the way back
    B        not 0     not 0            anything

A task is two letters, of the beginning and the end. A family of laws is one record: the trigonometric ones are a shape for each
letter (see `halves`), the polynomials a degree. Values are normal ones: of a segment of length 1, over its lift.
[VDI 2143, by the profile lists of two makers of drives that implement it]
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from functools import lru_cache, partial

import numpy as np

from camgen.errors import Fault, SpecError
from camgen.motion.halves import (
    INCLINED_SINE,
    MODIFIED_SINE,
    PARABOLA,
    QUARTER_COSINE,
    TRAPEZOID,
    Halves,
    Shape,
    inflection_for,
    reversal_trapezoid,
    sine_line,
)
from camgen.motion.laws import (
    LAWS,
    Law,
    coefficients_from,
    halves_law,
    measured,
    polynomial,
)
from camgen.numerics import Floats
from camgen.tolerances import LAW_CLOSES

LETTERS = "RGUB"
TASKS = tuple(start + end for start in LETTERS for end in LETTERS)
_SYMMETRIC = 1e-9  # of a law, that its halves may differ by
_PLACES = np.linspace(0.0, 1.0, 2001)  # where a law's speed is looked at
_AS_SMOOTH = 2  # order that a law continues where it joins without a jump of acceleration


@dataclass(frozen=True)
class End:
    """What a segment joins at one end, in normal values."""

    letter: str = "R"
    v: float = 0.0
    a: float | None = 0.0  # None: the law decides
    j: float = 0.0


REST = End()


@dataclass(frozen=True)
class Form:
    """What a spec says of a law besides its ends."""

    inflection: float | None = None  # lambda; None: by an acceleration that is given, else 1/2
    line: float | None = None  # share of the span at constant velocity
    ramp: float | None = None  # share of a trapezoid's half in which it falls to a reversal
    deceleration: float | None = None  # C_a*


PLAIN = Form()


@dataclass(frozen=True)
class Trigonometric:
    """A family of two halves and a line."""

    name: str
    shapes: Mapping[str, Shape] = field(hash=False)  # by the letter of an end
    source: str = ""
    about: str = ""
    keys: tuple[str, ...] = ("lambda", "constant_velocity")
    reversals: tuple[int, ...] = (0, 1, 2)  # how many of its ends may reverse

    def serves(self, start: str, end: str) -> bool:
        """Whether it has a law for this task."""
        known = start in self.shapes and end in self.shapes
        return known and (start, end).count("U") in self.reversals

    def halves(self, start: End, end: End, form: Form) -> Halves:
        """Its formula between these ends; lambda by the acceleration that is given. SpecError where there is none."""
        shapes = [self._shape(side.letter, form) for side in (start, end)]
        line = form.line or 0.0
        plain = Halves(shapes[0], shapes[1], form.inflection or 0.5, line, start.v, end.v)
        if form.inflection is not None:
            return plain
        if form.deceleration is not None:
            return self._shifted(plain, inflection_for(plain, form.deceleration), "c_a_star")
        turns = [side for side in (start, end) if side.letter == "U" and side.a is not None]
        if len(turns) < (start.letter, end.letter).count("U") or not turns:
            return plain  # what is open is as at lambda 1/2
        if len(turns) == 2:
            return self._between_reversals(plain, start.a or 0.0, end.a or 0.0, form)
        if end in turns:
            return self._shifted(plain, inflection_for(plain, -(end.a or 0.0)), "end_acceleration")
        back = replace(plain, first=plain.second, second=plain.first, v0=plain.v1, v1=plain.v0)
        return self._shifted(plain, 1 - inflection_for(back, start.a or 0.0), "end_acceleration")

    def law(self, start: End, end: End, form: Form, lift: float = 1.0) -> Law:
        """The law between these ends; SpecError where there is none."""
        if not lift:
            raise SpecError([_level(self.name)])
        halves = self.halves(start, end, form)
        accelerations = [side[0] for side in halves.ends]
        sides = [
            (float(k), side.v, *([accelerations[k]] if side.letter == "U" else []))
            for k, side in enumerate((start, end))
        ]
        name = _titled(self.name, start, end, halves.inflection)
        return halves_law(name, halves, self.source, (sides[0], sides[1]))

    def _shape(self, letter: str, form: Form) -> Shape:
        if letter == "U" and form.ramp is not None:
            return reversal_trapezoid(form.ramp)
        return self.shapes[letter]

    def _between_reversals(self, plain: Halves, a0: float, a1: float, form: Form) -> Halves:
        """Accelerations at both ends are more than lambda can follow: the line's share does, where it is free."""
        if self.name != "sine-line" or form.line is not None:
            return plain
        inflection, line = sine_line(a0, a1)
        if math.isnan(line):
            limit = "normal accelerations a0 > 0 and a1 < 0 with a0 |a1| / (a0 + |a1|) >= pi^2 / 4"
            raise SpecError([Fault(("end_acceleration",), f"{a0:.6g} and {a1:.6g}", limit)])
        return replace(plain, inflection=inflection, line=line)

    @staticmethod
    def _shifted(plain: Halves, inflection: float, key: str) -> Halves:
        if math.isnan(inflection):
            limit = "one that a lambda between 0 and 1 gives this law"
            raise SpecError([Fault((key,), "", limit)])
        return replace(plain, inflection=inflection)


@dataclass(frozen=True)
class PolynomialFamily:
    """A family of polynomials between any ends, by their derivatives up to an order there."""

    name: str
    order: int  # highest derivative that is given at both ends
    inflected: bool = False  # whether its acceleration is 0 at lambda
    about: str = ""
    keys: tuple[str, ...] = ("lambda",)

    def serves(self, start: str, end: str) -> bool:
        """Whether it has a law for this task."""
        return self.order >= _AS_SMOOTH or not {start, end} & {"U", "B"}

    @property
    def source(self) -> str:
        """In the words of the guideline."""
        degree = 2 * self.order + 1 + self.inflected
        return f"VDI 2143: Polynom {degree}. Grades"

    def law(self, start: End, end: End, form: Form, lift: float = 1.0) -> Law:
        """The law between these ends, from 0 to lift; SpecError where there is none."""
        wanted = [(side.v, side.a or 0.0, side.j)[: self.order] for side in (start, end)]
        still = not any(any(values) for values in wanted)
        if form.inflection is not None and not self.inflected and not still:
            limit = "no value here: a polynomial between moving ends has no free inflection"
            raise SpecError([Fault(("lambda",), f"{form.inflection:g}", limit)])
        if self.name in LAWS and lift and still:
            law = LAWS[self.name]
            return law if form.inflection is None else shifted(law, form.inflection)
        sides = [(lift * k, *values) for k, values in enumerate(wanted)]
        conditions = [
            (float(k), order, value)
            for k, side in enumerate(sides)
            for order, value in enumerate(side)
        ]
        if self.inflected:
            conditions.append((0.5 if form.inflection is None else form.inflection, 2, 0.0))
        formula = polynomial(*map(float, coefficients_from(conditions)))
        name = _titled(self.name, start, end, form.inflection or 0.5)
        return measured(name, formula, self.source, ends=(sides[0], sides[1]))


Family = Trigonometric | PolynomialFamily

_MOVING = {"R": MODIFIED_SINE, "G": MODIFIED_SINE}
FAMILIES: Mapping[str, Family] = {
    family.name: family
    for family in (
        Trigonometric(
            "parabolic",
            {"R": PARABOLA, "G": PARABOLA},
            "VDI 2143: quadratische Parabel",
            "parabola between R or G, whose acceleration jumps",
        ),
        Trigonometric(
            "simple-harmonic",
            {"U": QUARTER_COSINE},
            "VDI 2143: einfache Sinuslinie",
            "simple sine from reversal to reversal (UU)",
        ),
        Trigonometric(
            "cycloidal",
            {"R": INCLINED_SINE, "G": INCLINED_SINE},
            "VDI 2143: geneigte Sinuslinie",
            "inclined sine between R or G",
        ),
        Trigonometric(
            "modified-trapezoid",
            {"R": TRAPEZOID, "G": TRAPEZOID, "U": reversal_trapezoid()},
            "VDI 2143: modifiziertes Beschleunigungstrapez",
            "acceleration trapezoid between R, G or U; ramp: share of the half at U in which it falls, 0.5",
            ("lambda", "constant_velocity", "ramp"),
        ),
        Trigonometric(
            "modified-sine",
            _MOVING,
            "VDI 2143: modifizierte Sinuslinie",
            "between R or G; a share of the span at constant velocity; c_a_star: greatest deceleration, for lambda",
            ("lambda", "constant_velocity", "c_a_star"),
        ),
        Trigonometric(
            "harmonic-combination",
            {**_MOVING, "U": QUARTER_COSINE},
            "VDI 2143: harmonische Kombination",
            "from R or G to a reversal U, and back; lambda by the acceleration there",
            reversals=(1,),
        ),
        Trigonometric(
            "sine-line",
            {"U": QUARTER_COSINE},
            "VDI 2143: Sinus-Gerade-Kombination",
            "from reversal to reversal (UU), a share of the span at constant velocity between",
            reversals=(2,),
        ),
        PolynomialFamily("cubic", 1, about="between R or G, whose acceleration jumps"),
        PolynomialFamily("3-4-5", 2, about="polynomial 5 between any ends; lambda from R to R"),
        PolynomialFamily("4-5-6-7", 3, about="polynomial 7 between any ends; lambda from R to R"),
        PolynomialFamily("polynomial-6", 2, True, "with its inflection at lambda, 0.4 to 0.6"),
        PolynomialFamily("polynomial-8", 3, True, "with its inflection at lambda, 0.4 to 0.6"),
    )
}

# The guideline's names, and makers', of laws that have another one here.
SYNONYMS = {
    "straight-line": "uniform",
    "quadratic-parabola": "parabolic",
    "parabola": "parabolic",
    "simple-sine": "simple-harmonic",
    "inclined-sine": "cycloidal",
    "bestehorn": "cycloidal",
    "acceleration-trapezoid": "modified-trapezoid",
    "modified-acceleration-trapezoid": "modified-trapezoid",
    "sine-line-combination": "sine-line",
    "polynomial-3": "cubic",
    "polynomial-5": "3-4-5",
    "polynomial-7": "4-5-6-7",
}

# What a law may be chosen for, where none is named.
_QUANTITIES: Mapping[str, Callable[[Law], float]] = {
    "least-acceleration": lambda law: law.c_a,
    "least-jerk": lambda law: law.c_j,
    "least-torque": lambda law: law.c_m,
}
CHOICES = tuple(_QUANTITIES)


def shifted(law: Law, inflection: float) -> Law:
    """A law between dwells, symmetric both ways, with its inflection moved along the straight line to (lambda, lambda).

    f(z) = 2 lambda s(z / (2 lambda)) up to lambda, mirrored after it with 1 - lambda. C_v stays; the jerk jumps at lambda.
    SpecError where the law is not symmetric.
    """
    u = np.linspace(0.0, 0.5, 33)
    uneven = np.max(np.abs(law(u) + law(1 - u) - 1), initial=0.0)
    if not uneven <= _SYMMETRIC or law.ends != LAWS["3-4-5"].ends:
        limit = "no value here: the law is not symmetric between dwells"
        raise SpecError([Fault(("lambda",), f"{inflection:g}", limit)])
    if inflection == 0.5:
        return law
    early = 2 * inflection
    late = 2 - early
    breaks = [early * b for b in law.breaks if b < 0.5]
    breaks += [inflection] if float(law(0.5, 3)) or 0.5 in law.breaks else []
    breaks += [1 - late * (1 - b) for b in law.breaks if b > 0.5]
    return measured(
        f"{law.name}, lambda {inflection:g}",
        partial(_moved, law, inflection),
        law.source,
        tuple(breaks),
    )


def _moved(law: Law, inflection: float, u: Floats, order: int) -> Floats:
    u = np.asarray(u, float)
    early = u < inflection
    width = np.where(early, 2 * inflection, 2 - 2 * inflection)
    place = np.where(early, u, 1 - u) / width
    value = width ** (1.0 - order) * law(np.minimum(place, 0.5), order)
    if order == 0:
        return np.asarray(np.where(early, value, 1 - value))
    return np.asarray(np.where(early, value, -((-1) ** order) * value))


def _titled(name: str, start: End, end: End, inflection: float) -> str:
    """For people."""
    task = f"{start.letter}-{end.letter}"
    return (
        f"{name} {task}"
        if round(inflection, 12) == 0.5
        else f"{name} {task}, lambda {inflection:.4g}"
    )


def _level(name: str) -> Fault:
    right = "a polynomial: it alone can leave a displacement and come back to it"
    return Fault((), f"'{name}'", right)


@lru_cache(maxsize=1024)
def law_for(
    name: str, start: End = REST, end: End = REST, form: Form = PLAIN, lift: float = 1.0
) -> Law:
    """A family's law between these ends; lift 0: it comes back to where it began. SpecError where there is none."""
    family = FAMILIES[name]
    if not family.serves(start.letter, end.letter):
        task = start.letter + end.letter
        served = [pair for pair in TASKS if family.serves(*pair)]
        raise SpecError(
            [Fault(("task",), f"'{task}'", f"one that '{name}' has: {', '.join(served)}")]
        )
    return family.law(start, end, form, lift)


def least(choice: str, start: End, end: End, form: Form) -> str:
    """Name of the family whose law joins these ends without a jump of acceleration and has the least C_a, C_j or C_M.

    SpecError where there is none.
    """
    laws = _joining(start, end, form)
    if not laws:
        task = start.letter + end.letter
        right = "ends that a law joins here; left out, the task follows from the corners beside it"
        raise SpecError([Fault(("task",), f"'{task}'", right)])
    return min(laws, key=lambda name: _QUANTITIES[choice](laws[name]))


def _joining(start: End, end: End, form: Form) -> dict[str, Law]:
    found = {}
    for name, family in FAMILIES.items():
        unfit = isinstance(family, PolynomialFamily) and (
            None in (start.a, end.a) or family.inflected
        )
        if unfit or not family.serves(start.letter, end.letter):
            continue
        try:
            law = law_for(name, start, end, form)
        except SpecError:
            continue
        if law.smoothness >= _AS_SMOOTH and math.isfinite(law.c_j) and _fits(law, start, end):
            found[name] = law
    return found


def _fits(law: Law, start: End, end: End) -> bool:
    """Whether it has the accelerations that are given, and goes one way where its ends do."""
    for u, side in ((0.0, start), (1.0, end)):
        if side.a is not None and abs(float(law(u, 2)) - side.a) > LAW_CLOSES * law.c_a:
            return False
    if min(start.v, end.v) < 0:
        return True
    return float(np.min(law(_PLACES, 1))) >= -LAW_CLOSES * law.c_v
