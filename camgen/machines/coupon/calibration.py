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

_SHRINKAGE_KNOWN = 1e-3  # share, to which a shrinkage has to be known: 0.1 mm in 100
_SCATTER_FROM = 3  # degrees of freedom from which the scatter counts as the printer's own
_SURE = 0.975  # quantile: so many of 100 lie below it, 95 between it and its reverse


@dataclass(frozen=True)
class Feature:
    """A size of the coupon."""

    name: str
    nominal: float  # mm
    holes: float  # how often walls of holes come into it, c_h
    outlines: float  # how often outlines do, c_p


@dataclass(frozen=True)
class Printed:
    """Keys of [print] that the coupon was printed with."""

    hole: float = 0.0  # mm
    profile: float = 0.0  # mm
    shrinkage: float = 0.0  # share
    foot: float = 0.0  # mm

    def sent(self, feature: Feature) -> float:
        """A size in the file that was printed, mm."""
        moved = feature.holes * self.hole + feature.outlines * self.profile
        return (feature.nominal - moved) / (1 - self.shrinkage)


@dataclass(frozen=True)
class Fit:
    """Least squares."""

    values: Floats  # (p,)
    covariance: Floats  # of the values, (p, p)
    residuals: Floats  # of the rows, (n,)
    scatter: float  # standard deviation of one row
    freedom: int  # degrees of freedom

    def uncertainty(self, row: Floats) -> float:
        """Half of the interval that holds 95 % of what the values give by a row, (p,)."""
        return coverage(self.freedom) * math.sqrt(max(float(row @ self.covariance @ row), 0.0))


def coverage(freedom: int) -> float:
    """Student's factor of 95 %; that of the normal distribution where no scatter is known."""
    from scipy.special import stdtrit

    return float(stdtrit(freedom, _SURE)) if freedom > 0 else 1.959964


def least_squares(rows: Floats, sizes: Floats, least: float = 0.0) -> Fit:
    """Values x with rows x = sizes, rows (n, p) of rank p; least: the smallest standard deviation that is believed, mm."""
    values = np.asarray(np.linalg.lstsq(rows, sizes, rcond=None)[0], float)
    residuals = sizes - rows @ values
    freedom = len(sizes) - rows.shape[1]
    scatter = math.sqrt(float(residuals @ residuals) / freedom) if freedom else 0.0
    believed = max(scatter, least)
    spread = np.asarray(believed**2 * np.linalg.inv(rows.T @ rows), float)
    return Fit(values, spread, residuals, scatter, freedom if believed == scatter else 0)


@dataclass(frozen=True)
class Value:
    """A key of [print] as the sizes give it."""

    key: str
    measured: float
    uncertainty: float  # half of its interval of 95 %
    unit: str
    basis: str  # what it is from
    below_0: str = ""  # what to do where the sizes give less than 0; "" where the key can hold that

    @property
    def value(self) -> float:
        """What the key can hold of it."""
        return max(0.0, self.measured) if self.below_0 else self.measured

    @property
    def source(self) -> str:
        """What it is from, and that it was cut off at 0."""
        if self.value == self.measured:
            return self.basis
        return f"{self.basis}; print.{self.key} cannot be below 0: {self.below_0}"

    @property
    def line(self) -> str:
        """As a spec holds it."""
        value = f"{self.value:.3f}"
        uncertainty = f"{self.uncertainty:.3f}"
        unit = self.unit
        if unit == "1":
            value = f"{self.value:.5f}"
            uncertainty = f"{self.uncertainty:.1g}"
            unit = "share"
        full = "" if self.value == self.measured else f"would be {self.measured:.3f} "
        setting = f"{self.key} = {value}".ljust(36)
        return f"{setting}# {unit}, {full}+- {uncertainty} (95 %): {self.source}"


@dataclass(frozen=True)
class Calibration:
    """What the sizes of a coupon give."""

    values: Sequence[Value] = ()  # of [print]
    rows: Sequence[tuple[str, float, float, float]] = ()  # feature, its size, by the fit, rest; mm


def calibrate(
    features: Sequence[Feature],
    sizes: Mapping[str, Sequence[float]],
    printed: Printed,
    caliper: float,
    ladder: tuple[Feature, Feature | None, Feature | None, float] | None = None,
    disc: tuple[str, str] = ("", ""),
) -> Calibration:
    """What [print] has to be.

    sizes: measured, mm, by feature; caliper: standard deviation of one reading; ladder: the pin, the tightest hole in which it
    turns, the widest in which it holds, and the step of the holes; disc: features whose difference is the elephant's foot.
    """
    measured = [each for each in features if each.name in sizes]
    if not measured:
        return Calibration()
    means = np.array([float(np.mean(sizes[each.name])) for each in measured])
    table = np.array([[printed.sent(each), each.holes, each.outlines] for each in measured])
    known = [k for k in (1, 2) if np.any(table[:, k])]
    fit, free = _fit(table, means, known, printed, caliper)
    theta = np.array([1 - printed.shrinkage, printed.hole, printed.profile])
    theta[free] = fit.values
    values: list[Value] = []
    sources = {
        1: ("hole_compensation", "mm", "from the walls of holes"),
        2: ("profile_compensation", "mm", "from outlines"),
        0: ("shrinkage", "1", "from long sizes"),
    }
    for k, (key, unit, basis) in sources.items():
        if k in free:
            value = 1 - theta[0] if k == 0 else theta[k]
            uncertainty = fit.uncertainty(np.eye(len(free))[free.index(k)])
            values.append(Value(key, float(value), uncertainty, unit, basis))
    if all(name in sizes for name in disc):
        foot, middle = (float(np.mean(sizes[name])) for name in disc)
        value = printed.foot + (foot - middle) / 2
        uncertainty = coverage(0) * caliper / math.sqrt(2)
        basis = "from the disc at its foot and above it"
        values.append(
            Value("elephant_foot", value, uncertainty, "mm", basis, "no chamfer is needed")
        )
    if ladder is not None and set(known) == {1, 2}:
        pin, runs, holds, step = ladder
        loose = (
            "from the tightest hole in which the pin turns",
            "pins will be looser than the one that you tried",
        )
        tight = ("from the widest hole in which the pin holds", "glue the parts that must hold")
        fits = {"slide_clearance": (runs, loose), "press_clearance": (holds, tight)}
        for key, (hole, words) in fits.items():
            if hole is not None:
                row = np.array([printed.sent(hole) - printed.sent(pin), hole.holes, -pin.outlines])
                uncertainty = math.hypot(fit.uncertainty(row[free]), step / 2)
                values.append(Value(key, float(row @ theta), uncertainty, "mm", *words))
    if fit.freedom >= _SCATTER_FROM:
        uncertainty = fit.scatter * coverage(fit.freedom) / math.sqrt(2 * fit.freedom)
        basis = "from the scatter of the sizes, with that of the caliper"
        values.append(Value("size_error", fit.scatter, uncertainty, "mm", basis))
    columns = (means.tolist(), (means - fit.residuals).tolist(), fit.residuals.tolist())
    names = [each.name for each in measured]
    return Calibration(values, list(zip(names, *columns, strict=True)))


def _fit(
    table: Floats, means: Floats, known: list[int], printed: Printed, caliper: float
) -> tuple[Fit, list[int]]:
    """The fit, and which of k, h, p it gives: k only where the sizes tell it well enough, else it stays as printed."""
    free = [0, *known]
    if len(means) >= len(free) and np.linalg.matrix_rank(table[:, free]) == len(free):
        fit = least_squares(table[:, free], means, caliper)
        if fit.uncertainty(np.eye(len(free))[0]) <= _SHRINKAGE_KNOWN:
            return fit, free
    rest = means - table[:, 0] * (1 - printed.shrinkage)
    return least_squares(table[:, known], rest, caliper), known
