"""What is known of four-bars and slider-cranks without solving them: class, transmission angle, travel, who cannot turn."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NoReturn

import numpy as np
from numpy.typing import ArrayLike

from camgen.errors import DesignError
from camgen.machine.jets import unit_turn
from camgen.numerics import Floats
from camgen.tolerances import SAME_POINT


def slider_travel(theta: ArrayLike, crank: float, rod: float, offset: float = 0.0) -> Floats:
    """Way of a slider from its place at theta = 0 towards the crank's pivot, mm; nan where the rod does not reach.

    Guide parallel to the x axis at y = offset. Free of cancellation for a crank however short: no difference of rods is
    taken. In line it is the travel from the outermost point.
    """
    angle = np.atleast_1d(np.asarray(theta, float))
    half = unit_turn(angle / 2).imag
    y = crank * unit_turn(angle).imag
    with np.errstate(invalid="ignore"):
        roots = np.sqrt((rod - offset) * (rod + offset)) + np.sqrt(
            (rod - y + offset) * (rod + y - offset)
        )
        way: Floats = 2 * crank * half**2 + y * (y - 2 * offset) / roots
    return way.reshape(np.shape(theta))


@dataclass(frozen=True)
class FourBar:
    """A four-bar's class by Grashof.

    Some link turns fully where the margin is over 0; at 0 all fold into one line and the branch is lost (change point).
    """

    kind: str
    margin: float  # mm, the two middle lengths less the shortest and the longest
    full_turn: bool  # whether the crank passes every angle
    slack: float  # mm, to spare at the tighter of its two critical places; below 0 the gap
    open_deg: tuple[
        tuple[float, float], ...
    ]  # crank angles, 0 to 180 and mirrored, where it is open


def four_bar(frame: float, crank: float, coupler: float, output: float) -> FourBar:
    """Which four-bar these lengths make, mm; kinds are named by the crank, then the output.   [Grashof 1883]"""
    lengths = sorted((frame, crank, coupler, output))
    margin = lengths[1] + lengths[2] - lengths[0] - lengths[3]
    # The distance of the coupler's and the output's far ends runs from |frame - crank| to frame + crank.
    near = abs(frame - crank)
    far = frame + crank
    least = abs(coupler - output)
    most = coupler + output
    slack = min(most - far, near - least)
    spans = []
    if slack < 0:
        turn = [
            0.0
            if side <= near
            else 180.0
            if side >= far
            else math.degrees(_corner(frame, crank, side))
            for side in (least, most)
        ]
        spans = [span for span in ((0.0, turn[0]), (turn[1], 180.0)) if span[1] > span[0]]
    if sum(lengths[:3]) < lengths[3]:
        kind = "none"
    elif abs(margin) <= SAME_POINT:
        kind = "change-point"
    elif margin < 0:
        kind = "triple-rocker"
    else:
        kinds = {
            frame: "double-crank",
            crank: "crank-rocker",
            output: "rocker-crank",
            coupler: "double-rocker",
        }
        kind = kinds[lengths[0]]
    return FourBar(kind, margin, slack >= 0, slack, tuple(spans))


def transmission_extremes(
    frame: float, crank: float, coupler: float, output: float
) -> tuple[float, float]:
    """Angle between coupler and output at theta = 0 and pi, its extremes over a full turn, rad; nan where open."""
    return _corner(coupler, output, abs(frame - crank)), _corner(coupler, output, frame + crank)


def refuse_gap(joint: str, gap: float, worst: float, edges: Sequence[float]) -> NoReturn:
    """Raise DesignError: by how much a joint fails to close, mm, at which crank angle worst, deg, and where it begins to."""
    turns = sorted({round(edge % 360, 9) for edge in edges})
    span = (
        f"closes or opens at {', '.join(f'{edge:.6g}' for edge in turns)} deg"
        if turns
        else "never closes"
    )
    where = f"crank angle {worst % 360:.6g} deg ({span})"
    raise DesignError(
        f"gap at joint {joint}", gap, 0.0, "mm", where, "change the lengths of its links"
    )


def _corner(a: float, b: float, c: float) -> float:
    """Angle between sides a and b of the triangle whose third side is c, rad; nan where there is none."""
    stretch = (a + b - c) * (a + b + c)
    fold = (c - a + b) * (c + a - b)
    return (
        2 * math.atan2(math.sqrt(fold), math.sqrt(stretch))
        if stretch >= 0 and fold >= 0
        else math.nan
    )
