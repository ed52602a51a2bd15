"""The least that numpy takes for a four-bar: A and B in as few calls as they need, all in memory used before.

What a chain of any kind costs beyond it is the price of being one.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np


def four_bar(
    frame: float, crank: float, coupler: float, output: float, n: int, order: int
) -> Callable[[Any], tuple[Any, Any]]:
    """A function of n crank angles that gives A and B with derivatives, order 0 or 2, (order + 1, n), valid until the next
    call; B to the right of the way from A to C."""
    t, h, q, s, swing, w1, w2, s1 = (np.empty(n) for _ in range(8))
    a, b, leg = (np.empty((order + 1, n), complex) for _ in range(3))
    way, u, part, rates = (
        np.empty(n, complex),
        np.empty(n, complex),
        np.empty(n, complex),
        np.zeros((order, n), complex),
    )

    def work(theta: Any) -> tuple[Any, Any]:
        np.multiply(theta, 0.5, out=t)
        np.tan(t, out=t)
        np.multiply(t, t, out=h)
        np.add(h, 1.0, out=h)
        np.divide(2 * crank, h, out=h)
        np.subtract(h, crank, out=a[0].real)
        np.multiply(t, h, out=a[0].imag)
        np.subtract(frame, a[0], out=way)
        np.square(way.real, out=q)
        np.square(way.imag, out=s)
        np.add(q, s, out=q)
        np.subtract((coupler + output) ** 2, q, out=s)
        np.subtract(q, (coupler - output) ** 2, out=h)
        np.multiply(s, h, out=s)
        np.sqrt(s, out=s)
        np.divide(0.5, q, out=h)
        np.multiply(s, h, out=u.imag)
        np.multiply(h, coupler**2 - output**2, out=h)
        np.add(h, 0.5, out=u.real)
        np.negative(u.imag, out=u.imag)
        np.multiply(u, way, out=leg[0])
        if order:
            turn()
        np.add(a, leg, out=b)
        return a, b

    def turn() -> None:
        np.multiply(a[0], 1j, out=a[1])
        np.multiply(a[0], -1.0, out=a[2])
        np.divide(2.0, s, out=swing)
        np.subtract(leg[0], way, out=way)
        np.conj(way, out=way)
        np.conj(leg[0], out=u)
        for other, w in ((way, w1), (u, w2)):
            np.multiply(other, a[1], out=part)
            np.multiply(part.real, swing, out=w)
        np.square(w1, out=s1)
        np.square(w2, out=s)
        np.negative(s1, out=rates[1].real)
        np.subtract(coupler**2 + output**2, q, out=q)
        np.multiply(q, 0.5, out=q)
        np.multiply(s1, q, out=s1)
        np.multiply(s, output**2, out=s)
        np.subtract(s, s1, out=s)
        np.multiply(way, a[2], out=part)
        np.add(part.real, s, out=s)
        np.multiply(s, swing, out=rates[1].imag)
        rates[0].imag[:] = w1
        np.multiply(rates, leg[0], out=leg[1:])

    return work
