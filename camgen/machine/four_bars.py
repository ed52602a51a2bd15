"""Many four-bars at once: what a search or a map asks of a million designs, in blocks that stay in the processor's cache.

    O crank A coupler B output C, frame O-C along x; branch +1 has B to the left of the way from A to C

A block is a list of designs with consecutive numbers; arrays are (angles, designs), so that each step is one stroke over a
row. Lengths mm, angles rad. Nothing of a block is kept but what it was asked for: a million designs at 64 angles are 64
million positions, a gigabyte.   [the dyad of `dyads.two_angles`, without derivatives]
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from camgen.numerics import Floats, Points

BLOCK = 1024  # designs whose 64 positions are a megabyte


@dataclass(frozen=True)
class Block:
    """Some four-bars at all angles; nan where the chain does not close."""

    first: int  # number of the first design
    frame: Floats  # lengths, (designs,) mm
    coupler: Floats
    output: Floats
    a: Points  # ends of crank and output crank, (angles, designs) complex mm
    b: Points
    span: Floats  # from A to C, squared, (angles, designs) mm^2

    @property
    def closes(self) -> Floats:
        """Share of the angles at which each closes, (designs,)."""
        return np.asarray(np.mean(np.isfinite(self.b.real), axis=0))

    @property
    def transmission(self) -> tuple[Floats, Floats]:
        """Least and greatest angle between coupler and output crank over the angles, rad, (designs,); it grows with the span."""
        with np.errstate(invalid="ignore"):
            sides = self.coupler**2 + self.output**2
            product = 2 * self.coupler * self.output
            ends = (
                np.fmin.reduce(self.span, axis=0),
                np.fmax.reduce(self.span, axis=0),
            )  # of those that are not nan
            least, most = (np.arccos(np.clip((sides - end) / product, -1.0, 1.0)) for end in ends)
        return least, most

    @property
    def output_range(self) -> Floats:
        """How far the output crank turns between its extremes over the angles, rad, (designs,); nan where it opens on the way.

        A full turn of the output counts as one: the angle is followed from each angle to the next.
        """
        arm = self.b - self.frame.astype(complex)
        from_mean = arm * np.conj(
            np.sum(arm, axis=0)
        )  # from the mean direction: within a quarter turn most rockers stay
        with np.errstate(invalid="ignore", divide="ignore"):
            slope = np.divide(from_mean.imag, from_mean.real)
            swing = np.arctan(np.max(slope, axis=0)) - np.arctan(np.min(slope, axis=0))
            wide = np.flatnonzero(np.min(from_mean.real, axis=0) <= 0)
        if wide.size:
            arm = arm[:, wide]
            steps = arm[1:] * np.conj(arm[:-1])
            angle = np.cumsum(np.arctan2(steps.imag, steps.real), axis=0)
            swing[wide] = np.maximum(np.max(angle, axis=0), 0.0) - np.minimum(
                np.min(angle, axis=0), 0.0
            )
        return np.asarray(swing)

    def coupler_point(self, along: ArrayLike, offset: ArrayLike) -> Points:
        """Path of a point of each coupler, complex mm, (angles, designs): so far from A towards B and to the left of that way."""
        unit = (self.b - self.a) / self.coupler
        return np.asarray(self.a + unit * (np.asarray(along) + 1j * np.asarray(offset)))


def four_bars(
    frame: ArrayLike,
    crank: ArrayLike,
    coupler: ArrayLike,
    output: ArrayLike,
    theta: ArrayLike,
    branch: ArrayLike = 1,
) -> Iterator[Block]:
    """Positions of many four-bars, BLOCK at a time.

    frame, crank, coupler, output: lengths > 0, mm, (n,) or numbers; theta: crank angles, (m,) rad; branch: +1 or -1, (n,).
    """
    rows = np.broadcast_arrays(
        *(
            np.atleast_1d(np.asarray(each, float))
            for each in (frame, crank, coupler, output, branch)
        )
    )
    turn = np.exp(1j * np.asarray(theta, float))[:, None]
    for first in range(0, rows[0].size, BLOCK):
        f, r, c, o, side = (each[first : first + BLOCK] for each in rows)
        a = turn * r.astype(complex)
        way = f.astype(complex) - a
        span = way.real**2
        span += way.imag**2
        square = (
            c + o
        ) ** 2 - span  # Heron's formula in factors, which lose nothing to cancellation
        square *= span - (c - o) ** 2
        with np.errstate(invalid="ignore", divide="ignore"):
            root = np.sqrt(square, out=square)
            half = 0.5 / span
            root *= half
            b = np.empty(way.shape, complex)
            np.multiply(root, side, out=b.imag)
            half *= c**2 - o**2
            np.add(half, 0.5, out=b.real)
            root *= 0.0  # nan where it is open
            span += root
            b *= way
        b += a
        yield Block(first, f, c, o, a, b, span)
