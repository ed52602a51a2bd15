"""What standards allow of a size: fits of holes, general tolerances; and to how many decimals a size is written.

ISO 286     standard tolerances IT and fundamental deviations of holes (of f, g and h those of F, G and H mirrored):
            deepri.com/technical/information/tech_iso_tolerances.html (H7, H8), zh-ss.net/?p=841 (IT6 to IT11), Ralul/TI-84, ISO-286.py (F, G, N, P), online.flippingbook.com/view/962121/282
            (JS9); shafts m6: nutbolt.org/Standards/Pin-Dowel.html, table 3 (up to 50), docs.steelcam.org/sumitomo/
            tehnicheskaya-informaciya-page28 (up to 80); shafts j6 and k6: insbearing.com/product9.htm, Shaft tolerances
ISO 2768-1  linear sizes: scribd.com/document/585640440, "According to DIN ISO 2768-1"
"""

from __future__ import annotations

import bisect
import math

_STEPS = (3.0, 6.0, 10.0, 18.0, 30.0, 50.0, 80.0, 120.0, 180.0)  # mm, up to and with
# Standard tolerances by grade, in thousandths, from step to step.
_IT = {
    6: (6, 8, 9, 11, 13, 16, 19, 22, 25),
    7: (10, 12, 15, 18, 21, 25, 30, 35, 40),
    8: (14, 18, 22, 27, 33, 39, 46, 54, 63),
    9: (25, 30, 36, 43, 52, 62, 74, 87, 100),
    10: (40, 48, 58, 70, 84, 100, 120, 140, 160),
    11: (60, 75, 90, 110, 130, 160, 190, 220, 250),
}
# What is nearest to the nominal size, in thousandths: the lower deviation of F, G and H, the upper one of N
# and P from IT9 on and of a shaft f, g or h; the lower one of a shaft j up to IT6, k or m.
_NEAREST = {
    "C": (60, 70, 80, 95, 110),
    "D": (20, 30, 40, 50, 65, 80, 100, 120, 145),
    "E": (14, 20, 25, 32, 40, 50, 60, 72, 85),
    "F": (6, 10, 13, 16, 20, 25, 30, 36, 43),
    "G": (2, 4, 5, 6, 7, 9, 10, 12, 14),
    "H": (0,) * 9,
    "f": (-6, -10, -13, -16, -20, -25, -30, -36, -43),
    "g": (-2, -4, -5, -6, -7, -9, -10, -12, -14),
    "h": (0,) * 9,
    "j": (-2, -2, -2, -3, -4, -5, -7),
    "k": (0, 1, 1, 1, 2, 2, 2),
    "m": (2, 4, 6, 7, 8, 9, 11),
    "N": (-4, 0, 0, 0, 0, 0, 0, 0, 0),
    "P": (-6, -12, -15, -18, -22, -26, -32, -37, -43),
}

_LENGTHS = (3.0, 6.0, 30.0, 120.0, 400.0, 1000.0, 2000.0, 4000.0)  # mm, up to and with
_GENERAL = {  # +- mm; inf: not said
    "f": (0.05, 0.05, 0.1, 0.15, 0.2, 0.3, 0.5, math.inf),
    "m": (0.1, 0.1, 0.2, 0.3, 0.5, 0.8, 1.2, 2.0),
    "c": (0.15, 0.2, 0.5, 0.8, 1.2, 2.0, 3.0, 4.0),
    "v": (math.inf, 0.5, 1.0, 1.5, 2.5, 4.0, 6.0, 8.0),
}
_SHARE = 0.25  # of a tolerance on a side, by which rounding may move a size
_FINEST = 3  # decimals


def deviations(size: float, fit: str) -> tuple[float, float] | None:
    """Lower and upper deviation of a hole of a fit such as "H7", or of a shaft "f7", "g6", "h7", "j6", "k6" or "m6", mm; None beyond 180 mm, of j, k
    and m beyond 80 mm."""
    letter = fit.rstrip("0123456789")
    grade = _IT[int(fit.removeprefix(letter))]
    k = bisect.bisect_left(_STEPS, size)
    if k == len(_STEPS):
        return None
    width = grade[k] / 1000
    if letter in ("JS", "js"):
        return -width / 2, width / 2
    if k >= len(_NEAREST[letter]):
        return None
    nearest = _NEAREST[letter][k] / 1000
    return (nearest - width, nearest) if letter in "NPfgh" else (nearest, nearest + width)


def signed(value: float) -> str:
    """A deviation as on a drawing: with its sign, but for 0, to a tenth of a thousandth."""
    return f"{value:+.4f}".rstrip("0").rstrip(".") if abs(value) > 1e-9 else "0"


def in_limits(fit: str, size: float) -> str:
    """A fit with its deviations, such as "H7 (+0.015/0)"."""
    limits = deviations(size, fit)
    if limits is None:
        return fit
    low, high = limits
    between = f"±{high:g}" if abs(low + high) < 1e-9 else f"{signed(high)}/{signed(low)}"
    return f"{fit} ({between})"


def general(size: float, tolerance: str) -> float:
    """What a size may differ by a general tolerance such as "ISO 2768-mK", +- mm; inf where the class says nothing."""
    k = bisect.bisect_left(_LENGTHS, size)
    row = _GENERAL[tolerance.partition("-")[2][0]] if "-" in tolerance else ()
    return row[k] if k < len(row) else math.inf


def decimals(allowed: float) -> int:
    """With how many decimals a size is written that may differ by so much either way: no rounding takes a quarter of it."""
    if not math.isfinite(allowed) or allowed <= 0:
        return _FINEST
    return next((n for n in range(_FINEST) if 0.5 * 10**-n <= _SHARE * allowed), _FINEST)
