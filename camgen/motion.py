"""Laws of motion: one frozen record a law, with its claims beside its formula.

A law maps the position u = 0..1 in a segment to the displacement of a rise of 1, with derivatives to u.
C_v, C_a and C_j are the largest |first|, |second| and |third| derivative inside the segment (VDI 2143).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Law:
    """A normalised law of motion.

    formula(u, order): (n,) u in 0..1 to the derivative of order 0..3, (n,).
    smoothness: highest derivative that is continuous where the law joins what it is made to join
    (a dwell; for a turn, the uniform motion on both sides).
    """

    name: str
    formula: Callable[[Floats, int], Floats]
    smoothness: int
    c_v: float
    c_a: float
    c_j: float
    source: str

    def __call__(self, u: Any, order: int = 0) -> Floats:
        """Displacement (order 0) or its derivative to u, (n,)."""
        return self.formula(np.asarray(u, float), order)


def polynomial(*coefficients: float) -> Callable[[Floats, int], Floats]:
    """Formula of a polynomial law, coefficients from u^0 upwards; Horner's scheme."""
    orders = [coefficients]
    for _ in range(3):
        orders.append(tuple(k * c for k, c in enumerate(orders[-1]))[1:] or (0.0,))

    def formula(u: Floats, order: int) -> Floats:
        *rest, value = orders[order]
        result = np.full(u.shape, float(value))
        for c in reversed(rest):
            result = result * u + c
        return result

    return formula


UNIFORM = Law("uniform", polynomial(0, 1), 0, 1.0, 0.0, 0.0, "VDI 2143-1: gerade Linie")

POLYNOMIAL_345 = Law(
    "3-4-5",
    polynomial(0, 0, 0, 10, -15, 6),
    2,
    15 / 8,
    10 / 3**0.5,
    60.0,
    "VDI 2143-1: Polynom 5. Grades",
)

LAWS = {law.name: law for law in (UNIFORM, POLYNOMIAL_345)}

# Speed goes from +1 to -1 by the 3-4-5 law, so displacement is u - 2 * integral of 3-4-5: it starts and ends at 0.
# Acceleration and jerk vanish at both ends, so it joins uniform motion up to the third derivative.
TURN = Law(
    "turn",
    polynomial(0, 1, 0, 0, -5, 6, -2),
    3,
    1.0,
    15 / 4,
    20 / 3**0.5,
    "integral of 1 - 2 * (3-4-5)",
)
TURN_PEAK = 11 / 32  # displacement of TURN at u = 1/2
