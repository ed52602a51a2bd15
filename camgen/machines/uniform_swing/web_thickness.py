"""Canvas that a swinging jet lays: its thickness over the width, from the time that the jet spends at each place.

    strip    one of many equal parts of the width; the jet itself is taken to be narrower than a strip
    round    collector concentric with the pivot: the place is proportional to the follower's angle s
    flat     collector square to the jet in mid position (s = 0): the place is proportional to tan s

Places run from -1 to 1 over the width that the jet reaches, thickness is relative to the median strip.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from camgen.machine.cams.profile import DiscCam, SwingingArm
from camgen.motion.laws import TURN, Floats
from camgen.motion.program import uniform_swing

STRIPS = 400  # of the width, so that the least share that can be told is a quarter of a percent
BAND = (
    0.1  # thickness may differ by this share [Sentyakov et al., Vestnik TGTU 2018, 24(4), p. 698]
)


@dataclass(frozen=True)
class Canvas:
    """Thickness of equal strips, (n,), relative to their median, at the places -1..1, (n,), of their middles."""

    place: Floats
    thickness: Floats

    @property
    def share(self) -> float:
        """Share of the width on which the thickness is within BAND of the median."""
        return float(np.mean(np.abs(self.thickness - 1) <= BAND))

    def spread(self, width: float = 1.0) -> float:
        """Greatest less least thickness over this share of the width about its middle."""
        inside = self.thickness[np.abs(self.place) <= width]
        return float(np.max(inside) - np.min(inside))


def time_below(levels: Floats, theta: Floats, s: Floats) -> Floats:
    """Share of the turn during which s lies below each level, (m,); exact for s linear between its samples.

    theta, s: (n,) over one whole turn, theta increasing, both ends included. A stretch at rest counts from its level on.
    """
    low = np.minimum(s[:-1], s[1:])
    high = np.maximum(s[:-1], s[1:])
    spans = np.diff(theta)
    moving = high - low > 1e-9 * (
        np.max(high) - np.min(low)
    )  # less counts as rest: its slope would drown the others
    # The share is piecewise linear in the level: its slope grows by span / rise at `low` and falls again at `high`.
    slopes = spans[moving] / (high - low)[moving]
    places = np.concatenate((low[moving], high[moving]))
    order = np.argsort(places, kind="stable")
    places = places[order]
    steps = np.concatenate((slopes, -slopes))[order]
    grown = np.concatenate(([0.0], np.cumsum(np.cumsum(steps)[:-1] * np.diff(places))))
    rests = np.sort(low[~moving])
    weight = np.concatenate(([0.0], np.cumsum(spans[~moving][np.argsort(low[~moving])])))
    total = np.interp(levels, places, grown) if len(places) else np.zeros(len(levels))
    return np.asarray(
        (total + weight[np.searchsorted(rests, levels, side="right")]) / (theta[-1] - theta[0])
    )


def canvas(theta: Floats, s: Floats, flat: bool = False, strips: int = STRIPS) -> Canvas:
    """Canvas laid by a motion: s, (n,) rad at cam angles theta, (n,) rad, over one whole turn, both ends included.

    A flat collector needs |s| below pi/2: ValueError otherwise.
    """
    low = float(np.min(s))
    high = float(np.max(s))
    if flat and max(-low, high) >= math.pi / 2:
        raise ValueError("the jet does not reach a flat collector at a right angle and beyond")
    edges = (
        np.arctan(np.linspace(math.tan(low), math.tan(high), strips + 1))
        if flat
        else np.linspace(low, high, strips + 1)
    )
    edges[0] = -np.inf
    edges[-1] = np.inf
    time = np.diff(time_below(edges, theta, s))
    middle = np.mean(
        np.sort(time)[[(strips - 1) // 2, strips // 2]]
    )  # the median; numpy's would load masked arrays for it
    return Canvas((2 * np.arange(strips) + 1) / strips - 1, time / middle)


class BlendChoice(NamedTuple):
    """What the blend of a uniform swing's reversals costs and saves.

    undercut: swing that is lost, rad; acceleration: greatest |d2s/dtheta2|, 1/rad, inf without blend; share_round,
    share_flat: of the width within BAND.
    """

    undercut: float
    acceleration: float
    share_round: float
    share_flat: float


def blend_choice(swing: float, arm: SwingingArm, blend: float, strips: int = STRIPS) -> BlendChoice:
    """Undercut, peak acceleration and canvas of a reversal blend; raises DesignError as DiscCam does.

    swing: rad peak to peak; blend: rad, 0..pi. All from the closed forms of program and profile.
    """
    theta = np.linspace(0, 2 * math.pi, 14401)
    cam = DiscCam(uniform_swing(swing, blend), arm)
    whole = blend > 0 and cam.least_radius >= 0  # the profile need not be made to know that
    lost = 0.0 if whole else max((u.shortfall for u in cam.undercuts), default=0.0)
    s = cam.program(theta) if whole else cam.reachable(theta)
    speed = abs(float(cam.program(np.array([math.pi / 2]), 1)[0]))
    peak = TURN.c_a * speed / blend if blend else math.inf
    return BlendChoice(
        lost, peak, *(canvas(theta, s, flat, strips).share for flat in (False, True))
    )
