"""One-way clutches: a shaft that turns on by the forward strokes of a wheel that goes to and fro.

lost      what the wheel turns forwards before its clutch locks, rad
engaged   from there to the end of a stroke the shaft turns with the wheel; else a clutch on the ground holds it
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from camgen.errors import DesignError
from camgen.machine.model import Floats, Law
from camgen.numerics import crests, halved

_SAMPLES = 1440  # of a turn, among which strokes are looked for
_FLAT = 1e-12  # of the wheel's swing, below which it stands


@dataclass(frozen=True)
class Stroke:
    """The wheel going forwards: begin and end as times, rad of theta; its angles there, rad forwards; before: what strokes of the
    turn before this one have turned on."""

    begin: float
    end: float
    low: float
    high: float
    before: float


@dataclass(frozen=True)
class Ratchet:
    """Angle of what turns on, over theta: the law of a `Clutch`.

    wheel: its angle, rad, as (theta, order), the same after each turn of theta; lost: rad; forwards: sense of the wheel's angle
    in which its clutch locks; sense: in which theta runs; start: angle at theta = 0, rad.
    """

    wheel: Law
    lost: float
    forwards: int = 1
    sense: int = 1
    start: float = 0.0

    def _ahead(self, time: Floats) -> Floats:
        """The wheel's angle forwards at times, (n,) rad."""
        return self.forwards * np.asarray(self.wheel(self.sense * time, 0), float)

    @cached_property
    def strokes(self) -> tuple[Stroke, ...]:
        """Those of a turn that turn it on; DesignError where there are none."""
        step = math.tau / _SAMPLES
        ahead = self._ahead(np.linspace(0, math.tau, _SAMPLES + 1))
        flat = _FLAT * float(np.ptp(ahead))
        rising = np.diff(ahead) > flat
        rest = int(np.argmin(rising))
        strokes = list[Stroke]()
        done = 0.0
        if not rising.any() or rising[rest] or abs(ahead[-1] - ahead[0]) > max(flat, 1e-9):
            said = "its wheel swings to and fro, and comes back after a turn"
            raise DesignError("swing", float(np.ptp(ahead)), 0, "rad", "freewheel", said)
        order = np.roll(rising, -rest)
        edges = np.flatnonzero(np.diff(np.concatenate([[0], order.astype(int), [0]])))
        first, last = step * (edges.reshape(-1, 2).T + rest)
        valleys = crests(lambda time: -self._ahead(time), first - step, first + step)
        peaks = crests(self._ahead, last - step, last + step)
        for valley, peak in zip(valleys, peaks, strict=True):
            low, high = self._ahead(np.array([valley, peak])).tolist()
            begin = self._crossing(low + flat, valley, valley + 2 * step)
            end = self._crossing(high - flat, peak - 2 * step, peak)
            gain = high - low - self.lost
            if gain > 0:
                strokes.append(Stroke(begin, end, low, high, done))
                done += gain
        if not strokes:
            said = "let the wheel swing further, or lose less"
            most = math.degrees(float(np.ptp(ahead)))
            raise DesignError(
                "lost motion", math.degrees(self.lost), most, "deg", "freewheel", said
            )
        return tuple(strokes)

    def _crossing(self, level: float, low: float, high: float) -> float:
        """The time at which the wheel passes an angle on its way forwards, rad."""
        return halved(lambda time: float(self._ahead(np.array([time]))[0]) >= level, low, high)

    @property
    def advance(self) -> float:
        """What it turns on by in a turn of theta, rad."""
        last = self.strokes[-1]
        return last.before + last.high - last.low - self.lost

    def _turned(self, theta: Floats) -> tuple[Floats, Floats]:
        """What it has turned on, rad; less that the angle of the wheel forwards while it is engaged, else nan; (n,) each."""
        time = self.sense * np.asarray(theta, float)
        first = self.strokes[0].begin
        turns = np.floor((time - first) / math.tau)
        time = time - math.tau * turns
        ahead = self._ahead(time)
        total = np.zeros(time.shape)
        apart = np.full(time.shape, math.nan)
        for stroke in self.strokes:
            gain = stroke.high - stroke.low - self.lost
            way = ahead - stroke.low - self.lost
            within = (time >= stroke.begin) & (time <= stroke.end)
            total += np.where(within, np.clip(way, 0.0, gain), np.where(time > stroke.end, gain, 0))
            offset = self.advance * turns + stroke.before - stroke.low - self.lost
            apart = np.where(within & (way >= 0), offset, apart)
        return self.advance * turns + total, apart

    @cached_property
    def _zero(self) -> float:
        return float(self._turned(np.zeros(1))[0][0])

    def __call__(self, theta: Floats, order: int = 0) -> Floats:
        """Angle of what turns on, or its derivative to theta, (n,) rad."""
        total, apart = self._turned(theta)
        if order == 0:
            return np.asarray(self.start + self.forwards * (total - self._zero))
        return np.where(np.isfinite(apart), self.wheel(np.asarray(theta, float), order), 0.0)

    def apart(self, theta: Floats) -> Floats:
        """Its angle less the wheel's while they turn together, nan while it is held, (n,) rad."""
        offset = self._turned(theta)[1] - self._zero
        return np.asarray(self.start + self.forwards * offset)
