"""How late or early the spreaders of a chain stitch may run until a needle strikes one of them, or misses its loop.

    lag     shaft angle by which the spreaders come after the needles; a negative one is a lead
    as set  a finished machine whose spreaders run late: their way is shifted in time, their stroke stands where it was
    anew    a machine designed with that lag (`timing.lag_deg`): each nose is set to its needle at capture once more

What the needles can strike is the spreaders' section in the needles' plane; it and the needles are convex polygons. Their
gap over the turn is a 1-Lipschitz function of the shift between them, so a lag that is stepped by gap / speed never passes
the first strike (sphere tracing).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from camgen.geometry.outlines import Floats, Points
from camgen.machines.chain_stitch_looper.stitch import Design
from camgen.numerics import peak
from camgen.tolerances import BOUND_SPARE

_ANGLES = 240  # of the turn, to begin with
# into which a step where the least gap may be is cut, and how often: 4e-4 mm are left
_PARTS = 6
_ROUNDS = 4
FARTHEST = math.radians(30)  # lag that is looked at: no machine is so far off
_STEP = 1e-5  # rad, of the lag, where bodies are as good as in touch


@dataclass(frozen=True)
class Timing:
    """Lag and lead, rad, at which first a needle strikes and a loop is missed; inf beyond FARTHEST."""

    strike_lag: float
    strike_lead: float
    missed_lag: float
    missed_lead: float

    @property
    def least(self) -> float:
        """What the timing may be off either way, rad."""
        return min(self.strike_lag, self.strike_lead, self.missed_lag, self.missed_lead)


@dataclass(frozen=True)
class Clock:
    """Needles and spreaders over the turn at any lag.

    section: (n,) complex mm, convex and counter-clockwise, in a spreader's (u, y); needles: (m,) each, from the tip.
    """

    design: Design
    section: Points
    needles: tuple[Points, Points]
    _timings: dict[bool, Timing] = field(
        default_factory=dict, init=False, repr=False, compare=False
    )

    def noses(self, phi: Floats, lag: float, anew: bool) -> tuple[Floats, Floats]:
        """Way of each spreader's nose beyond its own needle, mm, (n,) each; lag: rad, besides the design's own."""
        d = self.design
        set_to = d.moved(np.array(d.capture) - lag) if anew else np.array(d.before)
        moved = d.moved(phi - lag)
        return moved - set_to[0], moved - set_to[1]

    @cached_property
    def _slabs(self) -> tuple[tuple[Points, Floats], tuple[Points, Floats]]:
        """For each needle at p the gap is the largest of Re(conj(normal) p) - limit: normals and limits, (k,)."""

        def slab(needle: Points) -> tuple[Points, Floats]:
            edges = np.concatenate(
                [np.roll(self.section, -1) - self.section, needle - np.roll(needle, -1)]
            )
            normals = -1j * edges / np.abs(edges)
            across = np.conj(normals)[:, None]
            high = np.max((across * self.section).real, axis=1)
            return normals, high - np.min((across * needle).real, axis=1)

        one, two = self.needles
        return slab(one), slab(two)

    def _gaps(self, phi: Floats, lag: float, anew: bool) -> Floats:
        """Least of the four gaps at each angle, (n,) mm: below 0 they overlap; apart, at most their distance."""
        g = self.design.given
        tips = self.design.tips(phi)
        noses = self.noses(phi, lag, anew)
        gaps: Floats = np.full(phi.shape, np.inf)
        for k, (nose, level) in enumerate(zip(noses, g.levels, strict=True)):
            for i, (tip, (normals, limits)) in enumerate(zip(tips, self._slabs, strict=True)):
                u = nose - (0.0 if i == k else g.spacing)
                y = tip + level
                # a row for each edge: the largest of a column is found on many angles at once
                apart = u * normals.real[:, None] + y * normals.imag[:, None] - limits[:, None]
                gaps = np.minimum(gaps, np.max(apart, axis=0))
        return gaps

    def gap(self, lag: float = 0.0, anew: bool = False) -> float:
        """The least gap over the turn, mm."""
        step = math.tau / _ANGLES
        phi: Floats = np.arange(_ANGLES, dtype=np.float64) * step
        gaps = self._gaps(phi, lag, anew)
        for _ in range(_ROUNDS):
            phi = phi[gaps - self._fastest * step / 2 <= np.min(gaps)]
            phi = (phi[:, None] + step * (np.arange(_PARTS + 1) / _PARTS - 0.5)).ravel()
            step /= _PARTS
            gaps = self._gaps(phi, lag, anew)
        return float(np.min(gaps))

    @cached_property
    def _speeds(self) -> tuple[float, float]:
        """Greatest speeds of needles and spreaders, mm/rad."""
        phi = np.linspace(0, math.tau, 48 * _ANGLES + 1)
        needles, spreaders = (peak(f(phi, 1)) for f in (self.design.risen, self.design.moved))
        return needles * (1 + BOUND_SPARE), spreaders * (1 + BOUND_SPARE)

    @property
    def _fastest(self) -> float:
        return math.hypot(*self._speeds)

    def margin(self, lag: float = 0.0, anew: bool = False) -> float:
        """How far the noses are past the other needle's axis when that comes down to them, mm, the smaller one.

        nan where a tip never comes down to a nose.
        """
        return float(np.min(self.design.margins_of(lambda phi: self.noses(phi, lag, anew))))

    def timing(self, anew: bool = False) -> Timing:
        """Lag and lead to the first strike and to the first loop that is missed."""
        if anew not in self._timings:
            speed = self._speeds[1] * (2 if anew else 1)
            strike, missed = (
                [_first(f, sign, speed, anew) for sign in (1, -1)] for f in (self.gap, self.margin)
            )
            self._timings[anew] = Timing(*strike, *missed)
        return self._timings[anew]


def _first(spare: Callable[[float, bool], float], sign: int, speed: float, anew: bool) -> float:
    """The last lag, rad, before `spare` (mm, changing by at most `speed` a rad) is used up; inf beyond FARTHEST."""
    lag = 0.0
    kept = 0.0
    while lag <= FARTHEST:
        left = spare(sign * lag, anew)
        if not left > 0:
            return kept
        kept = lag
        lag += max(left / speed, _STEP)
    return math.inf
