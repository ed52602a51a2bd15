"""Slider-cranks whose slider is at wanted places at crank angles: exact for three pairs, least squares for more.

    x = a cos phi + side sqrt(b^2 - (a sin phi - e)^2)        crank a, rod b; the slide is parallel to x at y = e
    x^2 = K1 x cos phi + K2 sin phi + K3,    K1 = 2 a,  K2 = 2 a e,  K3 = b^2 - a^2 - e^2

The K are linear for a given first angle of the crank and first place of the slider: both are tried on a grid, since pairs are
counted from the first.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from camgen.design.descent import least_squares
from camgen.design.fourbars import Flags, Room, Verdict, verdict_of
from camgen.numerics import Floats, Indices, Points, solve

_ANGLES = 180  # first ones of the crank
_PLACES = 161  # first ones of the slider
_KEPT = 60  # slider-cranks that are polished
_ROUNDS = 60
_ROUNDING = 1e-6  # mm, by which a length may leave its bounds
_STIFF = 10.0  # times as much as an error of the same size counts what is out of bounds


@dataclass(frozen=True)
class SliderCranks:
    """m slider-cranks, lengths in mm; the crank's shaft is the origin, the slide parallel to x."""

    first: Floats  # (m,) rad, of the crank at the first pair
    crank: Floats  # (m,)
    rod: Floats
    offset: Floats  # of the slide
    side: Floats  # 1 or -1: whether the slider is ahead of the crank's pin or behind it
    turned: Floats  # (n,) rad, of the crank at each pair from the first

    def those(self, which: Indices | Flags) -> SliderCranks:
        """Some of them, by numbers or by flags."""
        return SliderCranks(
            self.first[which],
            self.crank[which],
            self.rod[which],
            self.offset[which],
            self.side[which],
            self.turned,
        )

    def pin(self, turned: Floats) -> Points:
        """The crank's pin at turns from the first pair, (k,) rad: (k, m) complex mm."""
        return np.asarray(self.crank * np.exp(1j * (self.first + turned[:, None])))

    def slider(self, turned: Floats) -> Floats:
        """Place of the slider along x there, (k, m) mm; where the rod does not reach, as near as it comes."""
        pin = self.pin(turned)
        along = np.sqrt(np.maximum(self.rod**2 - (pin.imag - self.offset) ** 2, 0.0))
        return np.asarray(pin.real + self.side * along)

    @property
    def bars(self) -> Floats:
        """Crank, rod and offset together, (m,) mm."""
        return np.asarray(self.crank + self.rod + np.abs(self.offset))

    @property
    def turns(self) -> Flags:
        """Whether the crank turns all round."""
        return np.asarray(self.crank + np.abs(self.offset) < self.rod)

    def transmission(self, all_round: bool) -> Floats:
        """Least angle between the rod and the normal of the slide, (m,) rad: over a turn or over the pairs' range.

        -1 where the rod does not reach.  The pin is farthest from the slide at an end, or straight above or below the shaft.
        """
        low = self.first + np.min(self.turned)
        high = self.first + np.max(self.turned)
        sines = np.stack([np.sin(low), np.sin(high)])
        passed = [
            np.ceil((low - each) / math.tau) * math.tau + each <= high
            for each in (math.pi / 2, -math.pi / 2)
        ]
        most = np.where(passed[0] | all_round, 1.0, sines.max(axis=0))
        least = np.where(passed[1] | all_round, -1.0, sines.min(axis=0))
        away = np.abs(self.crank * np.stack([most, least]) - self.offset)
        share = np.max(away, axis=0) / self.rod
        return np.where(share <= 1, np.arccos(np.minimum(share, 1)), -1.0)

    def ends(self, all_round: bool) -> tuple[float, float]:
        """Least and greatest turn of the crank, rad, over a turn or over the pairs."""
        if all_round:
            return 0.0, math.tau
        return float(np.min(self.turned)), float(np.max(self.turned))

    @cached_property
    def way(self) -> Floats:
        """Place of the slider at the pairs, counted from the first, (n, m) mm."""
        at = self.slider(self.turned)
        return np.asarray(at - at[0])


def slider_cranks(turned: Floats, way: Floats, room: Room, allowance: float) -> SliderCranks:
    """Slider-cranks for pairs counted from the first: turns (n,) rad and ways (n,) mm."""
    longest = room.longest
    first, at = np.meshgrid(
        math.tau * np.arange(_ANGLES) / _ANGLES, np.linspace(-2 * longest, 2 * longest, _PLACES)
    )
    made = _by_grid(first.ravel(), at.ravel(), turned, way)
    if len(turned) <= 3:
        return made
    off = np.max(np.abs(made.way - way[:, None]), axis=0)
    off += np.max(_lack(made, room), axis=0)
    best = made.those(np.argsort(off, kind="stable")[:_KEPT])
    scale = longest

    def built(x: Floats, which: Indices) -> SliderCranks:
        first, crank, rod, offset = x[:, :4].T
        crank = scale * np.exp(np.clip(crank, -12, 3))
        rod = scale * np.exp(np.clip(rod, -12, 3))
        return SliderCranks(first, crank, rod, scale * offset, best.side[which], turned)

    def residuals(x: Floats, which: Indices) -> Floats:
        bars = built(x, which)
        off = bars.slider(turned) - scale * x[:, 4] - way[:, None]
        rows = [off / allowance, _STIFF * _lack(bars, room) / allowance]
        return np.concatenate(rows).T

    lengths = [np.log(each / scale) for each in (best.crank, best.rod)]
    start = [best.first, *lengths, best.offset / scale, best.slider(turned)[0] / scale]
    x, _ = least_squares(residuals, np.stack(start, axis=1), _ROUNDS)
    return built(x, np.arange(len(x)))


def judged(bars: SliderCranks, room: Room) -> Verdict:
    """Which have no defect, how they are driven, and what stops the others."""
    out = np.asarray((_lack(bars, room)[:3] > _ROUNDING).any(axis=0))
    return verdict_of({"bounds": out}, bars.turns, bars.transmission, room)


def _by_grid(first: Floats, at: Floats, turned: Floats, way: Floats) -> SliderCranks:
    """Those of first angles and places, (k,) each, that have real lengths and stay on one side."""
    phi = first[:, None] + turned
    x = at[:, None] + way
    table = np.stack([x * np.cos(phi), np.sin(phi), np.ones(phi.shape)], axis=-1)
    right = x**2
    if len(turned) > 3:  # normal equations of three unknowns
        right = np.einsum("kni,kn->ki", table, right)
        table = np.einsum("kni,knj->kij", table, table)
    k1, k2, k3 = solve(table, right).T
    with np.errstate(all="ignore"):
        crank = k1 / 2
        offset = k2 / k1
        rod = np.sqrt(k3 + crank**2 + offset**2)
        beside = x - crank[:, None] * np.cos(phi)
        side = np.sign(beside[:, 0])
        sound = (crank > 0) & np.isfinite(rod) & (rod > 0) & np.isfinite(offset)
        if len(turned) <= 3:
            sound &= (np.sign(beside) == side[:, None]).all(axis=1)
    side = np.where(side == 0, 1.0, side)
    return SliderCranks(first, crank, rod, offset, side, turned).those(sound)


def _lack(bars: SliderCranks, room: Room) -> Floats:
    """How much lengths are out of bounds, and the rod too steep at the pairs, (3 + n, m) mm."""
    offset = np.maximum(np.abs(bars.offset) - room.longest, 0.0)
    away = np.abs(bars.pin(bars.turned).imag - bars.offset)
    steep = np.maximum(away - bars.rod * math.cos(room.transmission), 0.0)
    lengths = room.excess(np.stack([bars.crank, bars.rod]))
    return np.concatenate([lengths, offset[None], steep])
