"""Small sums of jets: a quantity with its derivatives to theta, written so that what vanishes costs nothing.

A jet here is a list [value, first, second] of (n,) arrays or scalars, as long as the order asks; the integer 0 stands
for a derivative that vanishes. Arrays of stacked jets, (order + 1, n), are made only for those outside. An unknown angle is
kept as a spin: its unit vector, then the first and second derivative of the angle itself.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from camgen.numerics import Floats, Points

Jet = list[Any]
Spin = list[Any]

# Memory fresh from the system costs as much as the sums in it. The C library of Linux keeps what is freed, for blocks up to
# the largest that was freed so far: this one, never touched, is 8 MB.
np.empty(1 << 20)


def unit_turn(angle: Floats) -> Points:
    """exp(i angle), (n,): by the half-angle, whose tangent costs a fraction of sine and cosine."""
    turn = np.empty(angle.shape, complex)
    t = 0.5 * angle
    np.tan(t, out=t)
    h = t * t
    h += 1.0
    np.divide(2.0, h, out=h)
    np.subtract(h, 1.0, out=turn.real)
    np.multiply(t, h, out=turn.imag)
    return turn


def vanishes(x: Any) -> bool:
    """Whether this is the integer 0 that stands for nothing."""
    return type(x) is int and x == 0


def plus(a: Any, b: Any) -> Any:
    """a + b."""
    return b if vanishes(a) else a if vanishes(b) else a + b


def minus(a: Any, b: Any) -> Any:
    """a - b."""
    return a if vanishes(b) else -b if vanishes(a) else a - b


def times(a: Any, b: Any) -> Any:
    """a * b."""
    return 0 if vanishes(a) or vanishes(b) else a * b


def product(u: Jet, v: Jet) -> Jet:
    """The jet of u v."""
    rows: Jet = [times(u[0], v[0])]
    if len(u) > 1:
        rows.append(plus(times(u[1], v[0]), times(u[0], v[1])))
    if len(u) > 2:
        rows.append(plus(plus(times(u[2], v[0]), times(u[0], v[2])), times(2, times(u[1], v[1]))))
    return rows


def stacked(jet: Jet, n: int, kind: type) -> Any:
    """The jet as one array, (order + 1, n)."""
    rows: NDArray[Any] = np.empty((len(jet), n), kind)
    for row, value in zip(rows, jet, strict=True):
        row[:] = value
    return rows


def cross(a: Any, b: Any) -> Any:
    """The cross product of plane vectors, (n,): positive where b lies to the left of a."""
    return a.real * b.imag - a.imag * b.real


def turned(e: Any, w: Any, a: Any, order: int) -> Jet:
    """The jet of exp(i phi) from its value and the rates of phi."""
    rows: Jet = [e]
    if order > 0:
        rows.append(times(1j, times(w, e)))
    if order > 1:
        if isinstance(w, np.ndarray) or isinstance(a, np.ndarray):
            both = np.empty(np.broadcast(w, a).shape, complex)
            both.real = -w * w
            both.imag = a
            rows.append(both * e)
        else:
            rows.append((1j * a - w * w) * e)
    return rows


def thread_length(*places: Points) -> Floats:
    """Length of the thread from place to place, with derivatives: jets (order + 1, n) in and out, mm.

    The value of a Function. nan derivatives where two places meet.
    """
    total = np.zeros(places[0].shape)
    with np.errstate(all="ignore"):
        for a, b in zip(places, places[1:], strict=False):
            d = b - a
            length = np.abs(d[0])
            total[0] += length
            along = np.conj(d / length)
            if len(d) > 1:
                total[1] += (along[0] * d[1]).real
            if len(d) > 2:
                total[2] += (along[0] * d[2]).real + (along[0] * d[1]).imag ** 2 / length
    return total
