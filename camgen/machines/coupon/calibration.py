"""What a printer does, from sizes that were measured on a coupon: least squares, each value with its uncertainty.

A wall that is sent S mm from another is printed as

    m = k S + c_h h + c_p p        k = 1 - shrinkage; h: how far the walls of holes come in; p: how far outlines come out

with c_h = -2 of a hole's diameter, c_p = +2 of a pin's; between the far walls of two holes c_h = -2, between their near ones +2.
That is linear in k, h and p. Deviations of sizes from the fit tell the scatter of the printer and of the caliper together; the
values' uncertainty follows from it by the normal equations.   [JCGM 100:2008 (GUM), H.3; Student's t: its table G.2]
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from camgen.numerics import Floats

_SHRINKAGE_KNOWN = 1e-3  # share, to which a shrinkage has to be known to be told: 0.1 mm in 100
_SCATTER_FROM = 3  # degrees of freedom from which the scatter is told as the printer's own
_SURE = 0.975  # quantile: so many of 100 lie below it, 95 between it and its reverse


@dataclass(frozen=True)
class Feature:
    """A size of the coupon: nominal, mm, and how the walls of holes and outlines come into it."""

    name: str
    nominal: float
    holes: float
    outlines: float


@dataclass(frozen=True)
class Printed:
    """What the coupon was printed with: the keys of [print], mm, share."""

    hole: float = 0.0
    profile: float = 0.0
    shrinkage: float = 0.0
    foot: float = 0.0

    def sent(self, feature: Feature) -> float:
        """A size in the file that was printed, mm."""
        moved = feature.holes * self.hole + feature.outlines * self.profile
        return (feature.nominal - moved) / (1 - self.shrinkage)


@dataclass(frozen=True)
class Fit:
    """Least squares: values (p,), their covariance (p, p), what is left of each row (n,), the standard deviation of one row and
    its degrees of freedom."""

    values: Floats
    covariance: Floats
    left: Floats
    scatter: float
    freedom: int

    def wide(self, row: Floats) -> float:
        """Half of the interval that holds 95 % of what the values give by a row, (p,)."""
        return coverage(self.freedom) * math.sqrt(max(float(row @ self.covariance @ row), 0.0))


def coverage(freedom: int) -> float:
    """Student's factor of 95 %; that of the normal distribution where no scatter is known."""
    from scipy.special import stdtrit

    return float(stdtrit(freedom, _SURE)) if freedom > 0 else 1.959964


def least_squares(rows: Floats, sizes: Floats, least: float = 0.0) -> Fit:
    """Values x with rows x = sizes, rows (n, p) of rank p; least: the smallest standard deviation that is believed, mm."""
    values = np.asarray(np.linalg.lstsq(rows, sizes, rcond=None)[0], float)
    left = sizes - rows @ values
    freedom = len(sizes) - rows.shape[1]
    scatter = math.sqrt(float(left @ left) / freedom) if freedom else 0.0
    believed = max(scatter, least)
    spread = np.asarray(believed**2 * np.linalg.inv(rows.T @ rows), float)
    return Fit(values, spread, left, scatter, freedom if believed == scatter else 0)


@dataclass(frozen=True)
class Value:
    """A key of [print]: what the sizes give for it, half of its interval of 95 %, unit, and what it is from; below_0: what to do
    where they give less than 0 and the key cannot hold that, "" where it can."""

    key: str
    measured: float
    wide: float
    unit: str
    said: str
    below_0: str = ""

    @property
    def value(self) -> float:
        """What the key can hold of it."""
        return max(0.0, self.measured) if self.below_0 else self.measured

    @property
    def source(self) -> str:
        """What it is from, and that it was cut off at 0."""
        if self.value == self.measured:
            return self.said
        return f"{self.said}; print.{self.key} cannot be below 0: {self.below_0}"

    @property
    def line(self) -> str:
        """As a spec holds it."""
        told = f"{self.value:.5f}" if self.unit == "1" else f"{self.value:.3f}"
        wide = f"{self.wide:.1g}" if self.unit == "1" else f"{self.wide:.3f}"
        known = "" if self.value == self.measured else f"would be {self.measured:.3f} "
        unit = "share" if self.unit == "1" else self.unit
        return (
            f"{self.key} = {told}".ljust(36) + f"# {unit}, {known}+- {wide} (95 %): {self.source}"
        )


@dataclass(frozen=True)
class Calibrated:
    """Values of [print]; of each feature that was measured its size, its size by the fit and what is left, mm."""

    values: Sequence[Value]
    rows: Sequence[tuple[str, float, float, float]]


def calibrated(
    features: Sequence[Feature],
    sizes: Mapping[str, Sequence[float]],
    printed: Printed,
    caliper: float,
    ladder: tuple[Feature, Feature | None, Feature | None, float] | None = None,
    disc: tuple[str, str] = ("", ""),
) -> Calibrated:
    """What [print] has to be.

    sizes: measured, mm, by feature; caliper: standard deviation of one reading; ladder: the pin, the tightest hole in which it
    turns, the widest in which it holds, and the step of the holes; disc: features whose difference is the elephant's foot.
    """
    seen = [each for each in features if each.name in sizes]
    if not seen:
        return Calibrated((), ())
    means = np.array([float(np.mean(sizes[each.name])) for each in seen])
    table = np.array([[printed.sent(each), each.holes, each.outlines] for each in seen])
    known = [k for k in (1, 2) if np.any(table[:, k])]
    fit, free = _fitted(table, means, known, printed, caliper)
    theta = np.array([1 - printed.shrinkage, printed.hole, printed.profile])
    theta[free] = fit.values
    found: list[Value] = []

    named = {
        1: ("hole_compensation", "mm", "from the walls of holes"),
        2: ("profile_compensation", "mm", "from outlines"),
        0: ("shrinkage", "1", "from long sizes"),
    }
    for k, (key, unit, said) in named.items():
        if k in free:
            value = 1 - theta[0] if k == 0 else theta[k]
            found.append(
                Value(key, float(value), fit.wide(np.eye(len(free))[free.index(k)]), unit, said)
            )
    if all(name in sizes for name in disc):
        foot, middle = (float(np.mean(sizes[name])) for name in disc)
        value = printed.foot + (foot - middle) / 2
        wide = coverage(0) * caliper / math.sqrt(2)
        found.append(
            Value(
                "elephant_foot",
                value,
                wide,
                "mm",
                "the disc at its foot and above",
                "no chamfer is needed",
            )
        )
    if ladder is not None and set(known) == {1, 2}:
        pin, runs, holds, step = ladder
        fits = (
            (
                "slide_clearance",
                runs,
                "the tightest hole in which the pin turns",
                "pins turn more loosely than felt",
            ),
            (
                "press_clearance",
                holds,
                "the widest hole in which the pin holds",
                "glue what has to hold",
            ),
        )
        for key, hole, said, below_0 in fits:
            if hole is not None:
                row = np.array([printed.sent(hole) - printed.sent(pin), hole.holes, -pin.outlines])
                wide = math.hypot(fit.wide(row[free]), step / 2)
                found.append(Value(key, float(row @ theta), wide, "mm", said, below_0))
    if fit.freedom >= _SCATTER_FROM:
        wide = fit.scatter * coverage(fit.freedom) / math.sqrt(2 * fit.freedom)
        found.append(
            Value(
                "size_error", fit.scatter, wide, "mm", "scatter of the sizes, the caliper's in it"
            )
        )
    rows = zip(
        (each.name for each in seen),
        means.tolist(),
        (means - fit.left).tolist(),
        fit.left.tolist(),
        strict=True,
    )
    return Calibrated(found, list(rows))


def _fitted(
    table: Floats, means: Floats, known: list[int], printed: Printed, caliper: float
) -> tuple[Fit, list[int]]:
    """The fit, and which of k, h, p it gives: k only where the sizes tell it well enough, else it stays as printed."""
    free = [0, *known]
    if len(means) >= len(free) and np.linalg.matrix_rank(table[:, free]) == len(free):
        fit = least_squares(table[:, free], means, caliper)
        if fit.wide(np.eye(len(free))[0]) <= _SHRINKAGE_KNOWN:
            return fit, free
    return least_squares(
        table[:, known], means - table[:, 0] * (1 - printed.shrinkage), caliper
    ), known
