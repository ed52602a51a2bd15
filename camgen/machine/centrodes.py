"""Centrodes: where a body's instant centre runs, on the ground and on the body itself. One rolls on the other."""

from __future__ import annotations

import numpy as np

from camgen.machine.run import Run
from camgen.numerics import Points

FAR = 2.0  # of the size of the motion: where the centre is further off, the body all but translates


def centrodes(run: Run, body: str, size: float) -> tuple[Points, Points]:
    """The instant centre of a body on the ground, and in its own frame, complex mm, (n,) each.

    The place of no speed: z + i z' / w, of the body's origin z and its turning w, both to theta. nan where it is further off
    than FAR times the size, mm, or the body does not turn.
    """
    place, speed = run.point(body, 0j)[:2]
    angle, turning = run.angle(body)[:2]
    with np.errstate(all="ignore"):
        away = 1j * speed / turning
    away = np.where(np.abs(away) <= FAR * size, away, np.nan + 0j)  # nan compares as further off
    return place + away, np.asarray(away * np.exp(-1j * angle))
