"""Small sums of jets: a quantity with its derivatives to theta, written so that what vanishes costs nothing.

A jet here is a list [value, first, second] of (n,) arrays or scalars, as long as the order asks; the integer 0 stands
for a derivative that vanishes. Arrays of stacked jets, (order + 1, n), are filled only for those outside. An unknown angle is
kept as a spin: a vector of constant length that turns with it, then the first and second derivative of the angle itself.
No complex array is negated: numpy takes four times as long for that as for a product.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from camgen.numerics import Floats, Points

Jet = list[Any]
Spin = list[Any]

# Memory fresh from the system costs as much as the sums in it. The C library of Linux keeps what is freed, for blocks up to
# the largest that was freed so far: this one, never touched, is 8 MB.
np.empty(1 << 20)


def unit_turn(angle: Floats, size: float = 1.0) -> Points:
    """size exp(i angle), (n,): by the half-angle, whose tangent costs a fraction of sine and cosine."""
    turn = np.empty(angle.shape, complex)
    t = 0.5 * angle
    np.tan(t, out=t)
    h = t * t
    h += 1.0
    np.divide(2.0 * size, h, out=h)
    np.subtract(h, size, out=turn.real)
    np.multiply(t, h, out=turn.imag)
    return turn


def vanishes(x: Any) -> bool:
    """Whether this is the integer 0 that stands for nothing."""
    return type(x) is int and x == 0


def plus(a: Any, b: Any) -> Any:
    """a + b."""
    return b if vanishes(a) else a if vanishes(b) else a + b


def times(a: Any, b: Any) -> Any:
    """a * b."""
    return 0 if vanishes(a) or vanishes(b) else a * b


def combined(terms: Sequence[tuple[Any, Jet]], order: int, still: Any = 0, into: Any = None) -> Jet:
    """The jet of a constant and a sum of jets by factors; its rows are those of `into`, (order + 1, n), where that is given."""
    rows: Jet = []
    for k in range(order + 1):
        total: Any = None
        place = out = (
            None if into is None else into[k]
        )  # out: memory of our own, none before the first sum
        for factor, jet in terms:
            row = jet[k]
            if not isinstance(row, np.ndarray):
                still = still + factor * row if row else still
            elif total is not None:
                add = np.subtract if factor == -1 else np.add
                total = out = add(total, row if factor in (1, -1) else row * factor, out=out)
            elif factor == 1:
                total = row
            else:
                total = out = np.multiply(row, factor, out=out)
        if total is None:
            total = still
        elif still:
            total = np.add(total, still, out=out)
        if place is not None and total is not place:
            place[...] = total
        rows.append(total)
        still = 0
    return rows


def through(law: Callable[[Floats, int], Floats], inner: Jet, shift: float, order: int) -> Jet:
    """The jet of law(inner + shift)."""
    outer = [law(np.asarray(inner[0] + shift), k) for k in range(order + 1)]
    rows: Jet = outer[:1]
    if order > 0:
        rows.append(times(outer[1], inner[1]))
    if order > 1:
        rows.append(plus(times(outer[2], times(inner[1], inner[1])), times(outer[1], inner[2])))
    return rows


def product(u: Jet, v: Jet) -> Jet:
    """The jet of u v."""
    rows: Jet = [times(u[0], v[0])]
    if len(u) > 1:
        rows.append(plus(times(u[1], v[0]), times(u[0], v[1])))
    if len(u) > 2:
        rows.append(plus(plus(times(u[2], v[0]), times(u[0], v[2])), times(2, times(u[1], v[1]))))
    return rows


def fill(into: Any, jet: Jet) -> None:
    """Put the jet's rows into an array, (order + 1, n)."""
    for row, value in zip(into, jet, strict=True):
        row[...] = value


def cross(a: Any, b: Any) -> Any:
    """The cross product of plane vectors, (n,): positive where b lies to the left of a."""
    return a.real * b.imag - a.imag * b.real


def turned(z: Any, w: Any, a: Any, order: int) -> Jet:
    """The jet of a turning vector from its value and the rates of its angle."""
    if order == 0:
        return [z]
    if not isinstance(w, np.ndarray) and not isinstance(a, np.ndarray):
        return [z, times(1j * w, z), times(1j * a - w * w, z)][: order + 1]
    rows: Jet = [z]
    for real, imag in ((0.0, w), (w * w, a))[:order]:
        row = np.empty(np.shape(z), complex)
        np.negative(real, out=row.real)
        row.imag = imag
        row *= z
        rows.append(row)
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
