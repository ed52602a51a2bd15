"""Values of a spec's keys by which every limit holds and a figure is least or greatest, on any machine.

    cost = figure + a great deal for each limit that fails, by how much    (a machine that cannot be made costs most)

Differential evolution over the box of the keys, then a simplex from the best; seeded, so the same call ends the same.
[Storn and Price 1997; Nelder and Mead 1965, both scipy's]
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from camgen.design.wanted import KeyWish
from camgen.errors import DesignError, Fault, SpecError
from camgen.findings import Finding
from camgen.numerics import Floats
from camgen.pipeline.jobs import changed
from camgen.spec import unknown

_EACH = 60  # designs for each key and unit of effort
_CROWD = 6  # of them at once for each key
_BROKEN, _REFUSED = 1e6, 1e12  # costs, in sizes of the figure
_DIGITS = 6  # of a value that is found


@dataclass
class Search:
    """A machine's tables, with the keys that vary; settings: of the best so far, broken: what it does not keep."""

    data: Mapping[str, Any]
    source: str
    folder: Path
    wish: KeyWish
    told: Callable[[str], None]
    reason: str = ""
    best: float = math.inf
    settings: Sequence[str] = ()
    broken: Sequence[str] = ()
    tried: int = 0

    def found(self) -> Sequence[str]:
        """Settings, KEY=VALUE, of the best design; DesignError where no limit-keeping one was met."""
        from scipy.optimize import differential_evolution, minimize

        keys, bounds = list(self.wish.vary), list(self.wish.vary.values())
        budget = _EACH * len(keys) * self.wish.effort
        widths = np.array([high - low for low, high in bounds])
        end = differential_evolution(
            self.cost, bounds, popsize=_CROWD, maxiter=max(1, budget // (_CROWD * len(keys)) - 1), seed=self.wish.seed,
            polish=False, tol=1e-4,
        )  # fmt: skip
        simplex = np.vstack([end.x, end.x + 0.02 * np.diag(widths)])
        simplex = np.where(simplex > [high for _, high in bounds], 2 * end.x - simplex, simplex)
        ends = {"initial_simplex": simplex, "maxfev": budget // 2, "xatol": 1e-4, "fatol": 1e-6}
        minimize(self.cost, end.x, method="Nelder-Mead", bounds=bounds, options=ends)
        if self.broken or not self.settings:
            said = "; ".join(self.broken) or self.reason
            raise DesignError(
                "designs that keep every limit", 0, 1, "", f"{self.tried} tried", "widen wanted.vary, or relax a limit",
                f"none of {self.tried} designs keeps every limit; the nearest one: {said}",
            )  # fmt: skip
        return self.settings

    def cost(self, values: Floats) -> float:
        """Of one design; the best is kept."""
        self.tried += 1
        settings = [f"{key}={float(f'{value:.{_DIGITS}g}')!r}" for key, value in zip(self.wish.vary, values, strict=True)]
        try:
            mechanism = changed(dict(self.data), self.source, self.folder, settings)
            findings, figures = mechanism.limits(), mechanism.figures()
        except (DesignError, SpecError) as error:
            self.reason = self.reason or " ".join(str(error).split())
            return _REFUSED
        name, sign = (self.wish.least, 1) if self.wish.least is not None else (str(self.wish.most), -1)
        figures = {**figures, **{key: float(value) for key, value in zip(self.wish.vary, values, strict=True)}}
        self._known(figures, name)
        failing = [finding for finding in findings if not finding.ok]
        short = sum(_short(finding) for finding in failing)
        broken = [f"{each.code} {each.measured:.4g} against {each.limit:.4g} {each.unit}" for each in failing]
        for wanted, (low, high) in self.wish.figures.items():
            value = figures[wanted]
            if not low <= value <= high:
                off = max(low - value, value - high) / max(abs(low), abs(high), 1e-9)
                short += math.inf if math.isnan(off) else 0.01 + off
                broken.append(f"{wanted} {value:.4g} outside {low:g} to {high:g}")
        figure = sign * figures[name]
        cost = figure if not short else _BROKEN * (1 + min(short, 1e3)) if math.isfinite(short) else _REFUSED
        cost = _REFUSED if math.isnan(cost) else cost
        if cost < self.best:
            self.best, self.settings, self.broken = cost, settings, broken
            if not short:
                self.told(f"{name} {figures[name]:.6g} after {self.tried} designs")
        return cost

    def _known(self, figures: Mapping[str, float], name: str) -> None:
        keys = {"wanted.least" if self.wish.least is not None else "wanted.most": name}
        keys |= {f"wanted.figures.{each}": each for each in self.wish.figures}
        faults: list[Fault] = [unknown(path, each, figures) for path, each in keys.items() if each not in figures]
        if faults:
            raise SpecError(faults, self.source)


def _short(finding: Finding) -> float:
    """By how much a finding fails, as a share of its limit."""
    off = abs(finding.measured - finding.limit) / max(abs(finding.limit), 1e-6)
    return 1.0 if math.isnan(off) else 0.01 + off
