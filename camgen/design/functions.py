"""A four-bar whose rocker turns as a function of its crank, by pairs of angles.

    |d + c exp(i psi) - a exp(i phi)| = b:      K1 cos psi - K2 cos phi + K3 = cos(phi - psi)
    K1 = d / a     K2 = d / c     K3 = (a^2 - b^2 + c^2 + d^2) / (2 a c)

a crank, b coupler, c rocker, d frame O-C; phi, psi: angles of crank and rocker from the way O to C. Where the first pair
stands, phi0 and psi0, is free; given both, the K are linear: closed form for three pairs, least squares for more. The search
takes them from a grid, and polishes the best ones by the rocker's own errors.   [Freudenstein 1955]
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from camgen.design.wanted import FunctionWish
from camgen.design.weighed import Weighed, rounded_up
from camgen.errors import DesignError
from camgen.numerics import Floats, solve
from camgen.report.sketches import Drawn
from camgen.spec import Data

ROCKER, CRANK = "rocker", "crank"
_GRID = 90  # places of each of phi0 and psi0
_BEST = 24  # that are polished
_BETWEEN = 181  # crank angles over the range at which a chain must close and its transmission angle counts
_SLACK = 0.5  # deg, to which a design of the grid may fall short of the transmission angle before it is polished
_DIGITS = 6  # of a coordinate, mm


@dataclass(frozen=True)
class Generator:
    """A four-bar on a frame of length 1: phi0, psi0, rad; crank, coupler, rocker; worst error, rad, least transmission, rad."""

    phi0: float
    psi0: float
    lengths: tuple[float, float, float]
    error: float
    transmission: float
    wish: FunctionWish
    tables: Data

    @cached_property
    def points(self) -> Mapping[str, list[float]]:
        """Points by name, mm, as drawn: at the first pair."""
        crank, _, rocker = self.lengths
        psi = self._rocker(np.zeros(1))[0]  # psi0 itself is where the equation has it, not where the lengths do
        places = {"O": 0j, "C": 1 + 0j, "A": crank * np.exp(1j * self.phi0), "B": 1 + rocker * np.exp(1j * psi)}
        size = self.wish.frame
        return {name: [round(size * float(z.real), _DIGITS) + 0.0, round(size * float(z.imag), _DIGITS) + 0.0]
                for name, z in places.items()}  # fmt: skip

    def _rocker(self, turns: Floats) -> Floats:
        """Its angle after turns of the crank, (m,) rad."""
        return np.asarray(_closed(np.array([self.phi0, self.psi0, *self.lengths])[:, None], turns)[0][:, 0])

    def data(self, tolerance: float | None = None) -> Data:
        """Tables of the spec; tolerance: of FUNCTION_ERROR, deg, its own error and a fiftieth unless given."""
        pairs = self.wish.turns
        borne = tolerance or max(rounded_up(1.02 * math.degrees(self.error)), 0.01)
        links = {"ground": ["O", "C"], CRANK: ["O", "A"], "coupler": ["A", "B"], ROCKER: ["C", "B"]}
        drive = {"link": CRANK, "range_deg": [min(x for x, _ in pairs), max(x for x, _ in pairs)], **self.tables.get("drive", {})}
        output = [{"name": "function", "link": ROCKER, "function": {"at": [list(pair) for pair in pairs], "tolerance": borne}}]
        found = {"points": self.points, "links": links, "drive": drive, "output": output}
        return {**{key: value for key, value in self.tables.items() if key not in found}, **found}

    @cached_property
    def weighed(self) -> Weighed:
        """Whether it can be made, and its play."""
        return Weighed(self.data())

    @cached_property
    def drawn(self) -> Drawn:
        """What a sketch shows: the first position, and the way of the rocker's end."""
        turns = np.array([x for x, _ in self.wish.turns])
        psi = self._rocker(np.radians(np.linspace(turns.min(), turns.max(), 60)))
        way = self.wish.frame * (1 + self.lengths[2] * np.exp(1j * psi))
        points = {name: complex(*place) for name, place in self.points.items()}
        return Drawn(points, [("O", "A"), ("A", "B"), ("C", "B")], ["O", "C"], way, way[:0])

    def row(self, number: int) -> dict[str, Any]:
        """What a table of the front shows."""
        crank, coupler, rocker = (self.wish.frame * length for length in self.lengths)
        return {
            "design": number, "worst_error_deg": float(f"{math.degrees(self.error):.4g}"),
            "transmission_deg": round(math.degrees(self.transmission), 3), "crank_mm": round(crank, 4),
            "coupler_mm": round(coupler, 4), "rocker_mm": round(rocker, 4), **self.weighed.row,
        }  # fmt: skip


def search(wish: FunctionWish, tables: Data) -> list[Generator]:
    """Four-bars for the function: a front from the least error to the greatest least transmission angle; DesignError."""
    from scipy.optimize import least_squares

    pairs = np.radians(np.array(wish.turns))
    places = math.tau * np.arange(_GRID) / _GRID
    phi0, psi0 = (each.ravel() for each in np.meshgrid(places, places))
    given = np.concatenate([np.stack([phi0, psi0]), _freudenstein(phi0, psi0, pairs)])
    error, transmission = _judged(given, pairs, wish)
    least = math.radians(wish.transmission_deg)
    fine = np.flatnonzero(np.isfinite(error) & (transmission > least - math.radians(_SLACK)))
    near, steep = fine[np.argsort(error[fine], kind="stable")], fine[np.argsort(-transmission[fine], kind="stable")]
    close = near[error[near] <= max(1e-9, 2 * float(error[near[0]]))] if near.size else near
    close = close[np.argsort(-transmission[close], kind="stable")]
    picked = dict.fromkeys([*near[:_BEST].tolist(), *close[:_BEST].tolist(), *steep[: _BEST // 4].tolist()])
    tried = [given[:, k] for k in picked]
    for begin in tried[:_BEST]:
        end = least_squares(lambda x: _residuals(x, pairs, least), _packed(begin), xtol=1e-12, ftol=1e-12, max_nfev=60)
        tried.append(_unpacked(end.x))
    numbers = np.array(tried).reshape(-1, 5).T
    error, transmission = _judged(numbers, pairs, wish)
    found: list[Generator] = []
    for k in sorted(np.flatnonzero(transmission >= least), key=lambda k: (round(float(error[k]), 9), -transmission[k])):
        if not found or transmission[k] > found[-1].transmission + math.radians(0.5):
            phi, psi, *lengths = (float(each) for each in numbers[:, k])
            found.append(Generator(phi, psi, (lengths[0], lengths[1], lengths[2]), float(error[k]), float(transmission[k]),
                                   wish, tables))  # fmt: skip
    if not found:
        best = math.degrees(float(np.max(transmission, initial=0.0, where=np.isfinite(transmission))))
        raise DesignError(
            "least transmission angle", best, wish.transmission_deg, "deg", "wanted.function",
            "a smaller wanted.transmission_deg, or a function that turns less or bends less",
        )  # fmt: skip
    return found


def _freudenstein(phi0: Floats, psi0: Floats, pairs: Floats) -> Floats:
    """Crank, coupler and rocker on a frame of 1 for places of the first pair, (n,) rad each: (3, n), nan where there are none."""
    phi, psi = phi0[:, None] + pairs[:, 0], psi0[:, None] + pairs[:, 1]
    table = np.stack([np.cos(psi), -np.cos(phi), np.ones(phi.shape)], axis=-1)
    right = np.cos(phi - psi)
    if len(pairs) > 3:  # normal equations: three unknowns, each of size 1
        table, right = np.sum(table[:, :, :, None] * table[:, :, None, :], axis=1), np.sum(table * right[..., None], axis=1)
    k1, k2, k3 = solve(table, right).T
    with np.errstate(all="ignore"):
        crank, rocker = 1 / k1, 1 / k2
        coupler = np.sqrt(crank**2 + rocker**2 + 1 - 2 * crank * rocker * k3)
        return np.where((crank > 0) & (rocker > 0), np.stack([crank, coupler, rocker]), math.nan)


def _closed(numbers: Floats, turns: Floats) -> tuple[Floats, Floats]:
    """Rocker's angle, and sine of its transmission angle with its sign, (m, n), of designs (5, n) after turns of the crank, (m,).

    The sign is that of the branch; the rocker stays on that of its first position.
    """
    phi0, psi0, crank, coupler, rocker = numbers
    back = crank * np.exp(1j * phi0) - 1  # from C to the crank's end
    side = np.sign(np.imag(np.conj(back) * np.exp(1j * psi0)))
    way = 1 - crank * np.exp(1j * (phi0 + turns[:, None]))  # from the crank's end to C
    span = np.abs(way)
    cosine = (span**2 + rocker**2 - coupler**2) / (2 * span * rocker)  # at C, between the way back and the rocker
    with np.errstate(invalid="ignore"):
        psi = np.angle(-way) + side * np.arccos(cosine)
        sine = np.sqrt(1 - np.minimum(1, ((rocker**2 + coupler**2 - span**2) / (2 * rocker * coupler)) ** 2))
    return psi, np.where(np.abs(cosine) <= 1, sine, -1.0)


def _judged(numbers: Floats, pairs: Floats, wish: FunctionWish) -> tuple[Floats, Floats]:
    """Worst error at the pairs and least transmission angle over the range, rad, (n,); inf and -1 where a design is none."""
    sides = np.array([*numbers[2:], np.ones(numbers.shape[1])])
    with np.errstate(invalid="ignore"):
        fit = np.isfinite(sides).all(axis=0) & (sides.min(axis=0) >= wish.shares[0]) & (sides.max(axis=0) <= wish.shares[1])
    found = np.flatnonzero(fit)
    error, transmission = np.full(fit.size, math.inf), np.full(fit.size, -1.0)
    psi, _ = _closed(numbers[:, found], pairs[:, 0])
    off = psi - psi[:1] - pairs[:, 1:]
    error[found] = np.nan_to_num(np.max(np.abs(np.mod(off + math.pi, math.tau) - math.pi), axis=0), nan=math.inf)
    _, sine = _closed(numbers[:, found], np.linspace(pairs[:, 0].min(), pairs[:, 0].max(), _BETWEEN))
    transmission[found] = np.where(np.min(sine, axis=0) < 0, -1.0, np.arcsin(np.clip(np.min(sine, axis=0), 0, 1)))
    return error, transmission


def _packed(numbers: Floats) -> Floats:
    return np.concatenate([numbers[:2], np.log(numbers[2:])])


def _unpacked(x: Floats) -> Floats:
    return np.concatenate([x[:2], np.exp(x[2:])])


def _residuals(x: Floats, pairs: Floats, least: float) -> Floats:
    """Errors of the rocker at the pairs, and what the transmission angle falls short by, rad."""
    numbers = _unpacked(x)[:, None]
    psi, _ = _closed(numbers, pairs[:, 0])
    off = (psi - psi[:1] - pairs[:, 1:])[1:, 0]
    _, sine = _closed(numbers, np.linspace(pairs[:, 0].min(), pairs[:, 0].max(), 37))
    short = np.maximum(0.0, least + math.radians(1.0) - np.arcsin(np.clip(np.min(sine), -1, 1)))
    start = x[1] - psi[0, 0]  # psi0 follows from the lengths: both name the same place
    rest = [np.mod(start + math.pi, math.tau) - math.pi, short]
    return np.asarray(np.nan_to_num(np.concatenate([np.mod(off + math.pi, math.tau) - math.pi, rest]), nan=3.0))
