"""Values of a spec's keys by which every limit holds and a figure is least or greatest, on any machine.

    cost = figure + a great deal for each limit that fails, by how much    (a machine that cannot be made costs most)

Differential evolution over the box of the keys, then a simplex from the best; seeded, so the same call ends the same.
[Storn and Price 1997; Nelder and Mead 1965, both scipy's]
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from camgen.design.request import Request
from camgen.design.wanted import KeyWish
from camgen.edits import edited, with_tables
from camgen.errors import CamgenError, DesignError, Fault, Key, SpecError, dotted
from camgen.findings import Finding
from camgen.machines.mechanism import Mechanism
from camgen.machines.sources import Template, changed, prepare
from camgen.numerics import Floats
from camgen.settings import override
from camgen.spec import dump, unknown

_EACH = 60  # designs for each key and unit of effort
_CROWD = 6  # of them at once for each key
# costs, in sizes of the figure
_BROKEN = 1e6
_REFUSED = 1e12
_DIGITS = 6  # of a value that is found


@dataclass
class Search:
    """A search for values of a machine's keys."""

    data: Mapping[str, Any]  # tables of its spec
    source: str
    folder: Path
    wish: KeyWish
    say: Callable[[str], None]  # takes a line for each better design
    best: float = math.inf  # least cost so far
    settings: Sequence[str] = ()  # of that design
    violations: Sequence[str] = ()  # limits and wishes that it does not keep
    count: int = 0  # designs so far
    reason: str = ""  # why the first one that is refused is

    def run(self) -> Sequence[str]:
        """Settings, KEY=VALUE, of the best design; DesignError where no limit-keeping one was met."""
        from scipy.optimize import differential_evolution, minimize

        words = np.array([isinstance(ends[0], str) for ends in self.wish.vary.values()])
        bounds = [
            (0.0, len(ends) - 1.0) if isinstance(ends[0], str) else (float(ends[0]), float(ends[1]))
            for ends in self.wish.vary.values()
        ]
        budget = _EACH * len(bounds) * self.wish.effort
        rounds = max(1, budget // (_CROWD * len(bounds)) - 1)
        end = differential_evolution(
            self.costs,
            bounds,
            vectorized=True,
            updating="deferred",
            popsize=_CROWD,
            maxiter=rounds,
            seed=self.wish.seed,
            polish=False,
            tol=1e-4,
            integrality=words if words.any() else None,
        )
        free = np.flatnonzero(~words)
        if free.size:  # words stay as they are

            def cost(values: Floats) -> float:
                every = end.x.copy()
                every[free] = values
                return float(self.costs(every[:, None])[0])

            begin = end.x[free]
            ranges = [bounds[k] for k in free]
            simplex = np.vstack(
                [begin, begin + 0.02 * np.diag([high - low for low, high in ranges])]
            )
            simplex = np.where(simplex > [high for _, high in ranges], 2 * begin - simplex, simplex)
            ends = {"initial_simplex": simplex, "maxfev": budget // 2, "xatol": 1e-4, "fatol": 1e-6}
            minimize(cost, begin, method="Nelder-Mead", bounds=ranges, options=ends)
        if self.violations or not self.settings:
            message = "; ".join(self.violations) or self.reason
            raise DesignError(
                "designs that keep every limit",
                0,
                1,
                "",
                f"{self.count} tried",
                "widen wanted.vary, or relax a limit",
            ).saying(f"none of {self.count} designs keeps every limit; the nearest one: {message}")
        return self.settings

    def costs(self, designs: Floats) -> Floats:
        """Of some designs, (keys, n) -> (n,); the best is kept."""
        settings = [self._settings(values) for values in designs.T]
        mechanisms = self._template.variants(settings)
        prepare(mechanisms)
        return np.array(
            [self._cost(*each) for each in zip(designs.T, settings, mechanisms, strict=True)]
        )

    @cached_property
    def _template(self) -> Template:
        return Template(dict(self.data), self.source, self.folder)

    def _settings(self, values: Floats) -> Sequence[str]:
        """Values of the keys as settings; a word by its number."""
        return [
            f"{key}={str(ends[round(value)]) if isinstance(ends[0], str) else repr(float(f'{value:.{_DIGITS}g}'))}"
            for (key, ends), value in zip(self.wish.vary.items(), values.tolist(), strict=True)
        ]

    def _cost(
        self, values: Floats, settings: Sequence[str], mechanism: Mechanism | CamgenError
    ) -> float:
        self.count += 1
        try:
            if isinstance(mechanism, CamgenError):
                raise mechanism
            findings = mechanism.forecast()
            numbers = mechanism.study().numbers
        except (DesignError, SpecError) as error:
            self.reason = self.reason or " ".join(str(error).split())
            return _REFUSED
        name, sign = (
            (self.wish.least, 1) if self.wish.least is not None else (str(self.wish.most), -1)
        )
        varied = {
            key: value
            for (key, ends), value in zip(self.wish.vary.items(), values.tolist(), strict=True)
            if not isinstance(ends[0], str)
        }
        figures = {**numbers, **varied}
        self._refuse_unknown(figures, name)
        failing = [finding for finding in findings if not finding.ok]
        short = sum(_short(finding) for finding in failing)
        violations = [
            f"{each.code} {each.measured:.4g} against {each.limit:.4g} {each.unit}"
            for each in failing
        ]
        for wish, (low, high) in self.wish.figures.items():
            value = figures[wish]
            if not low <= value <= high:
                off = max(low - value, value - high) / max(abs(low), abs(high), 1e-9)
                short += math.inf if math.isnan(off) else 0.01 + off
                violations.append(f"{wish} {value:.4g} outside {low:g} to {high:g}")
        figure = sign * figures[name]
        cost = (
            figure
            if not short
            else _BROKEN * (1 + min(short, 1e3))
            if math.isfinite(short)
            else _REFUSED
        )
        cost = _REFUSED if math.isnan(cost) else cost
        if cost < self.best:
            self.best = cost
            self.settings = settings
            self.violations = violations
            if not short:
                self.say(f"{name} {figures[name]:.6g} after {self.count} designs")
        return cost

    def _refuse_unknown(self, figures: Mapping[str, float], name: str) -> None:
        keys: dict[Key, str] = {
            ("wanted", "least" if self.wish.least is not None else "most"): name
        }
        keys |= {("wanted", "figures", each): each for each in self.wish.figures}
        faults: list[Fault] = [
            unknown(path, each, figures) for path, each in keys.items() if each not in figures
        ]
        if faults:
            raise SpecError(faults, self.source)


def _short(finding: Finding) -> float:
    """By how much a finding fails, as a share of its limit."""
    off = abs(finding.measured - finding.limit) / max(abs(finding.limit), 1e-6)
    return 1.0 if math.isnan(off) else 0.01 + off


def written(request: Request) -> str:
    """Text of the spec whose keys are set as a spec wants; SpecError, DesignError."""

    def keys() -> KeyWish:
        found: KeyWish = request.wish()
        wrong = [fault for key, ends in found.vary.items() for fault in _beyond(request, key, ends)]
        if wrong:
            raise SpecError(wrong, request.source)
        return found

    where = (request.source, request.folder)
    *_, goal = request.checked(lambda: changed(request.rest, *where), keys)
    limits = _limits(request, goal)
    limited = request.rest
    for setting in limits:
        limited = override(limited, setting)
    settings = [*limits, *Search(limited, *where, goal, request.say).run()]
    if request.text is not None:
        text = with_tables(edited(request.text, settings), {}, ["wanted"])
        return text.replace("\n", request.ends)
    rest = request.rest
    for setting in settings:
        rest = override(rest, setting)
    return dump(changed(rest, *where))


def _limits(request: Request, goal: KeyWish) -> list[str]:
    """What a wish bears, as settings of the spec's own limits, KEY=VALUE; SpecError where the spec has none of them."""
    outputs = request.rest.get("output", [])
    targets = [
        f"output.{k}.{name}.tolerance"
        for k, output in enumerate(outputs if isinstance(outputs, list) else [])
        for name, target in output.items()
        if isinstance(target, Mapping)
    ]
    play = [key for key in ("limits.lash", "limits.lash_deg") if _has(request, f"{key}=1")][:1]
    angle = "limits.transmission_angle_deg"
    bounds = (
        ("tolerance", goal.tolerance, targets, "target in [[output]]"),
        ("lash", goal.lash, play, "limits.lash"),
        (
            "transmission_deg",
            goal.transmission_deg,
            [angle] if _has(request, f"{angle}=1") else [],
            angle,
        ),
    )
    settings = []
    faults = []
    for key, value, places, lacks in bounds:
        if value is None:
            continue
        settings += [f"{place}={value!r}" for place in places]
        if not places:
            faults.append(Fault(("wanted", key), f"{value:g}", f"nothing: the spec has no {lacks}"))
    if faults:
        raise SpecError(faults, request.source)
    return settings


def _has(request: Request, setting: str) -> bool:
    """Whether a machine has a key."""
    try:
        changed(request.rest, request.source, request.folder, [setting])
    except SpecError as error:
        return not any(fault.unknown for fault in error.faults)
    return True


def _beyond(request: Request, key: str, ends: Sequence[float | str]) -> list[Fault]:
    """What is wrong with a key that varies, at both ends or each word by itself: no such key, or a value that it cannot have."""
    for value in ends:
        try:
            changed(request.rest, request.source, request.folder, [f"{key}={value!r}"])
        except SpecError as error:
            own_faults = [fault for fault in error.faults if dotted(fault.path) == key or not value]
            own_faults = own_faults or [
                fault
                for fault in error.faults
                if fault.unknown or fault.source == "--set" and not fault.path
            ]
            if own_faults:
                text = value if isinstance(value, str) else f"{value:g}"
                return [
                    Fault(("wanted", "vary", key), text, fault.expected, fault.nearest)
                    for fault in own_faults
                ]
    return []
