"""Dyads in closed form: one vector loop with two unknowns, all angles at once.

    two angles             known + c1 e1 = c2 e2                   RRR
    an angle, a length     known + c e + u d = 0                   slider: d is known
                           known + (c + u d) e = 0                 inverted slider, slot: d turns with e
    two lengths            known + u1 d1 + u2 d2 = 0               linear

e = exp(i phi); c complex mm in the axes that turn; d a unit vector. All jets are lists as in `jets`. The branch is the
sign at the start. Where a dyad does not close it is nan. Where it only just closes (stretched or folded), the position
exists and the derivatives do not: they are nan.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from camgen.machine.jets import Jet, Spin, cross, plus, times, vanishes
from camgen.numerics import Floats

# A dyad that misses by less than this share of its size squared is taken as just closing: rounding of theta does as much.
JUST_CLOSES = 1e-14


def signed_root(square: Floats, slack: float, branch: int) -> tuple[Floats, Floats]:
    """The square's root with the branch's sign, 0 where it misses by the slack, nan beyond; the same to divide by."""
    if square.min(initial=np.inf) > 0:
        root = np.sqrt(square)
        root = root if branch > 0 else np.negative(root, out=root)
        return root, root
    root = branch * np.sqrt(np.where((square < 0) & (square >= -slack), 0.0, square))
    return root, np.where(root == 0, np.nan, root)


def two_angles(known: Jet, r1: float, r2: float, branch: int) -> tuple[Spin, Spin]:
    """Spins of both legs, of these lengths: known + z1 = z2; branch +1 has z1 to the left of the way to the second's foot."""
    order = len(known) - 1
    near = (r1 - r2) ** 2
    far = (r1 + r2) ** 2
    q = np.square(known[0].real)
    q += np.square(known[0].imag)
    # Heron's formula in factors, which lose nothing to cancellation: the root is four times the triangle's area.
    square = far - q
    square *= q - near
    root, divisor = signed_root(square, (far * JUST_CLOSES) * far, 1)
    half = (-0.5 * branch) / q
    z1 = np.empty(q.shape, complex)
    np.multiply(root, half, out=z1.imag)
    half *= branch * (r1**2 - r2**2)
    np.subtract(half, 0.5, out=z1.real)
    z1 *= known[0]
    z2 = z1 + known[0]
    first = [z1]
    second = [z2]
    if order > 0:
        # z1 x z2 is half the signed root; inner products with z2 and z1 part the two rates.
        swing = np.divide(-2.0 * branch, divisor, out=half)
        left = np.conj(z1)
        right = np.conj(z2)
        w1 = inner(right, known[1]) * swing
        w2 = inner(left, known[1]) * swing
        first.append(w1)
        second.append(w2)
    if order > 1:
        q -= r1**2 + r2**2
        q *= -0.5  # z1 . z2
        s1 = np.square(w1)
        s2 = np.square(w2)
        for spin, other, share1, share2 in ((first, right, q, r2**2), (second, left, r1**2, q)):
            a = s2 * share2
            a -= s1 * share1
            a += inner(other, known[2])
            a *= swing
            spin.append(a)
    return first, second


def inner(conjugate: Any, b: Any) -> Any:
    """The inner product of plane vectors, (n,), the first one given as its conjugate."""
    return 0.0 * conjugate.real if vanishes(b) else (conjugate * b).real


def slider(known: Jet, c: complex, d: Jet, branch: int) -> tuple[Spin, Jet]:
    """The spin of c e and the length along the known way d; branch +1 has c e ahead along d."""
    r = abs(c)
    x = known[0] * np.conj(d[0])
    y = x.imag
    root, divisor = signed_root((r - y) * (r + y), JUST_CLOSES * r**2, branch)
    z = np.empty(y.shape, complex)
    z.real = root
    np.negative(y, out=z.imag)
    z *= d[0]
    root = root + x.real
    spin = [z]
    length = [np.negative(root, out=root)]
    if len(known) > 1:
        u = length[0]
        w, v = _rates(plus(known[1], times(u, d[1])), z, d[0], divisor)
        spin.append(w)
        length.append(v)
    if len(known) > 2:
        f = plus(known[2], -w * w * z)
        f = plus(plus(f, times(u, d[2])), times(2 * v, d[1]))
        a, b = _rates(f, z, d[0], divisor)
        spin.append(a)
        length.append(b)
    return spin, length


def inverted(known: Jet, c: complex, d: complex, branch: int) -> tuple[Spin, Jet]:
    """The spin of e and the length along d, which turns with e; branch +1 has the end ahead of c's foot."""
    foot = c * d.conjugate()
    p = foot.real
    q = foot.imag
    far = np.abs(known[0])
    root, divisor = signed_root((far - q) * (far + q), JUST_CLOSES * q**2, branch)
    z = known[0] * -1.0
    e = z / (d * (root + 1j * q))
    along = d * e
    spin = [e]
    length = [root - p]
    if len(known) > 1:
        w, v = _rates(known[1], z, along, divisor)
        spin.append(w)
        length.append(v)
    if len(known) > 2:
        f = plus(known[2], -w * w * z) + 2j * v * w * along
        a, b = _rates(f, z, along, divisor)
        spin.append(a)
        length.append(b)
    return spin, length


def _rates(f: Any, z: Any, d: Any, divisor: Any) -> tuple[Any, Any]:
    """w, u' of i w z + u' d = -f, (n,) each, by Cramer; divisor is the cross product of the columns d and i z."""
    if vanishes(f):
        return 0.0 * divisor, 0.0 * divisor
    return cross(f, d) / divisor, dot(z, f) / -divisor


def two_lengths(known: Jet, d1: Jet, d2: Jet) -> tuple[Jet, Jet]:
    """Both lengths with their derivatives; nan where the ways are parallel."""
    area = cross(d1[0] + 0j, d2[0] + 0j) * np.ones(np.shape(known[0]))
    area[np.abs(area) < JUST_CLOSES] = np.nan
    u1: Jet = []
    u2: Jet = []
    for k, row in enumerate(known):
        f = row
        if k == 1:
            f = plus(f, plus(times(u1[0], d1[1]), times(u2[0], d2[1])))
        if k == 2:
            for u, d in ((u1, d1), (u2, d2)):
                f = plus(f, plus(times(u[0], d[2]), times(2 * u[1], d[1])))
        f = f + np.zeros(area.shape, complex)
        u1.append(-cross(f, d2[0]) / area)
        u2.append(cross(f, d1[0]) / area)
    return u1, u2


def dot(a: Any, b: Any) -> Any:
    """The inner product of plane vectors, (n,)."""
    return 0.0 * a.real if vanishes(b) else a.real * b.real + a.imag * b.imag
