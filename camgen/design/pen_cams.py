"""The cams of a machine that draws: grooves on one shaft whose followers move a pen, and one that lifts it.

A follower's motion is given at even angles of a turn; estimates of the pressure angle and of both walls' radii say which cams are
worth a look, the spec's own limits are judged after them.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from camgen.motion.laws import modified_sine
from camgen.motion.pen import Lifting
from camgen.numerics import Floats, halved, peak
from camgen.reading import Data

CAMS = tuple(22 * 1.08**k for k in range(19))  # mm, middle distance of a roller from the shaft
WALLS = 20.0  # mm, of a groove's outer plate and a pivot's hub beyond the roller's centre
DIGITS = 6  # of rows, deg or mm, and of points, mm
SLACK = 0.5  # mm, that the thread is pulled before the pen moves
CLEAR = 1.5  # mm, that it is pulled when the pen is clear
THREAD = 25.0  # mm, between its posts while the pen is down
_CORE = 14.0  # mm, of a cam within its groove: shaft, pins and walls
_RISE = 24.0  # deg, in which the pen is lifted, at most
_RISES = 150.0  # deg, that all rises may take
_MARGIN = 1.0  # deg, that the pen rests longer at either end of a line than lifting needs
_LIFT = 2.5  # mm, way of the lift's roller
_PULL = 3.0  # mm, of the thread


def likely(way: Floats, cam: float, radius: float, steep: float) -> bool:
    """Whether a groove holds by estimate; way: of its roller at even angles of a turn, mm; steep: greatest pressure angle, rad."""
    distance = cam + way
    rate = _derivative(way, 1)
    bend = _derivative(way, 2)
    if distance.min() <= radius + _CORE or peak(rate / distance) > math.tan(steep):
        return False
    square = distance**2 + rate**2
    curvature = (square + rate**2 - distance * bend) / square**1.5
    return peak(curvature) * (radius + 1.0) <= 1


def groove(follower: str, at: str, radius: float, segments: list[Data], name: str) -> Data:
    """Table of a cam on the shaft."""
    return {
        "name": f"{name}_cam",
        "cam": "disc",
        "follower": follower,
        "at": at,
        "radius": radius,
        "closure": "groove",
        "segment": segments,
    }


def closed_rows(values: Floats, rows: int) -> tuple[list[Data], float]:
    """The one segment of a follower's motion as a table, counted from theta = 0, and how far that leaves the motion.

    values: at even angles of a turn, mm or deg, outwards.
    """
    from scipy.interpolate import make_interp_spline

    at = np.linspace(0, 360, rows + 1)
    shown = np.round(_even(values - values[0], rows), DIGITS)
    shown -= shown[0]
    shown = np.round(np.append(shown, shown[0]), DIGITS)
    spline = make_interp_spline(at, shown, k=5, bc_type="periodic")
    theta = np.linspace(0, 360, len(values), endpoint=False)
    off = peak(spline(theta) - (values - values[0]))
    points = [list(row) for row in zip(at.tolist(), shown.tolist(), strict=True)]
    return [{"law": {"name": "table", "points": points}}], off


def lever(lift: Lift, cam: float, far: float, radius: float) -> tuple[dict[str, complex], Data]:
    """Points of the lever that lifts the pen, as it is down, with the thread's post on the ground; and its cam.

    far: distance of its pivot from the shaft, mm.
    """
    pivot = -1j * far
    arm = math.sqrt(far**2 - cam**2)
    square = 1j * np.exp(1j * math.asin(cam / far))
    end = pivot - _PULL / _LIFT * arm
    places = {
        "O3": pivot,
        "T3": complex(pivot + arm * square),
        "E": end,
        "G": end + 1j * THREAD,
    }
    segments = lift.segments(math.degrees(_LIFT / arm))
    return places, groove("lifter", "T3", radius, segments, "lift")


def rounded(place: complex) -> list[float]:
    """x and y of a point, mm."""
    return [round(place.real, DIGITS) + 0.0, round(place.imag, DIGITS) + 0.0]


@dataclass(frozen=True)
class Lift:
    """How a cam lifts the pen: at theta = 0 it is down."""

    rise: float  # deg, in which the pen goes up or comes down
    ends: Floats  # deg, the middle of the rests at which each line begins and ends, (n, 2), the first one before theta = 0

    @classmethod
    def timing(cls, lines: int) -> tuple[float, Lifting]:
        """The rise for so many lines, deg, and what lifting takes of a turn."""
        rise = min(_RISE, _RISES / lines)
        slack = _risen(SLACK)
        clear = _risen(CLEAR)
        rest = (clear - slack) * rise + _MARGIN
        up = 2 * (1 - clear) * rise
        return rise, Lifting(rest / 360, up / 360, 2 * slack * rise / 360)

    def segments(self, lift_deg: float) -> list[Data]:
        """Of the lift's cam over a turn; lift_deg: of its lever."""
        slack = _risen(SLACK)
        clear = _risen(CLEAR)
        early = (clear - slack) / 2 * self.rise
        rises = self.ends[:, 1] - early - slack * self.rise
        falls = np.append(self.ends[1:, 0], self.ends[0, 0] + 360) - early - (1 - clear) * self.rise
        segments: list[Data] = []
        at = 0.0
        for rise, fall in zip(rises.tolist(), falls.tolist(), strict=True):
            for kind, begin in (("rise", rise), ("return", fall)):
                rest = round(begin - at, DIGITS)
                span = round(self.rise, DIGITS)
                segments += [
                    {"kind": "dwell", "span_deg": rest},
                    {
                        "kind": kind,
                        "span_deg": span,
                        "lift_deg": round(lift_deg, DIGITS),
                        "law": {"name": "modified-sine"},
                    },
                ]
                at += rest + span
        return [*segments, {"kind": "dwell", "span_deg": round(360 - at, DIGITS)}]


def _risen(pull: float) -> float:
    """Share of a rise at which the thread is pulled so far, mm."""
    law = modified_sine()
    return halved(lambda u: float(law(np.array([u]))[0]) > pull / _PULL, 0.0, 1.0)


def _derivative(values: Floats, order: int) -> Floats:
    """Of values at even angles of a turn, (n,)."""
    k = np.fft.rfftfreq(len(values), 1 / len(values))
    return np.asarray(np.fft.irfft((1j * k) ** order * np.fft.rfft(values), len(values)))


def _even(values: Floats, count: int) -> Floats:
    """Fewer of the values at even angles of a turn, between them by their harmonics, (count,)."""
    spectrum = np.fft.rfft(values)
    k = np.arange(len(spectrum))
    theta = np.linspace(0, math.tau, count, endpoint=False)
    kept = k[: min(len(k), 2000)]
    terms = spectrum[kept] * np.where(kept > 0, 2.0, 1.0) / len(values)
    return np.asarray((np.exp(1j * np.outer(theta, kept)) @ terms).real)
