"""Curves of one output over the turn, as wanted and as each kind of file gives it: for the report and motion.csv."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from camgen.geometry.outlines import Floats
from camgen.judge.proof import Proof
from camgen.machine.features import Demand
from camgen.machine.model import Output, Path, unit_of
from camgen.machine.targets import Lines, Trace, one_line
from camgen.machines.mechanism import Mechanism
from camgen.parts.assembly import Cycle
from camgen.report.words import rounded
from camgen.study import Plot
from camgen.tolerances import SPEED_WINDOW_DEG

_SPEED = "Speed"
_SLOPE = "Slope"  # what the speed of an output that is one number is called: it is for each unit of theta, not of time
_ERROR = "Motion error"
_BAND = "Free play, by the files' sizes"
_TURNS_ON = 1.0  # deg, from end to end; what swings comes back


class Curves:
    """Columns and plots of an output at theta, (n,) rad of a cycle; a path's are x and y. alone: it is the machine's only output.

    cams: theta is a whole turn of cams, both ends included; facets make raw speed ripple, so that it is averaged.
    """

    def __init__(
        self, output: Output, theta: Floats, cycle: Cycle, alone: bool, cams: bool = False
    ) -> None:
        self.output = output
        self.theta = theta
        self.cycle = cycle
        self.alone = alone
        self.cams = cams
        self.recovered: dict[str, Any] = {}
        self.unit, self.scale = unit_of(output)
        self.columns: dict[str, Floats] = {}
        self._plots: dict[str, list[tuple[str, Floats, Floats]]] = {}
        self._sources: dict[str, tuple[str, str]] = {}
        self._wanted: Any = None
        self._lawful = False  # whether the wanted motion is the machine's own
        self._sense = ""  # how an angle turns on

    def want(self, value: Any, slope: Any) -> None:
        """The wanted motion and its slope, (n,)."""
        self._wanted = value
        self._put(self.output.name.capitalize(), "", value, own=True)
        self._put(_SPEED, "", self._mean(value) if self.cams else slope)

    def add(self, kind: str, proof: Proof) -> None:
        """What a kind of file gives."""
        name = self.output.name
        reachable = self._wanted
        if reachable is None or self._lawful:
            self._lawful = True
            reachable = proof.reachable(name, self.theta)[0]
        if self._wanted is None:
            self.want(*proof.nominal(name, self.theta))
        moved = proof.moved(name, self.theta)
        self.recovered[kind] = moved.value
        self._put(name.capitalize(), kind, moved.value, own=True)
        self._put(_SPEED, kind, self._mean(moved.value) if self.cams else moved.slope)
        self._put(_ERROR, kind, moved.value - reachable)
        if np.any(moved.play):
            self._put(_BAND, kind, moved.play)

    def _mean(self, value: Any) -> Any:
        """Slope to theta, a mean over the window of SPEED_RIPPLE."""
        step = max(1, round(SPEED_WINDOW_DEG / 2 * (len(self.theta) - 1) / 360))
        turn = value[:-1]
        further = value[-1] - value[0]  # what turns on ends the turn further on than it began
        ahead = np.append(turn[step:], turn[:step] + further)
        behind = np.append(turn[-step:] - further, turn[:-step])
        mean = (ahead - behind) / (2 * step * math.tau / len(turn))
        return np.append(mean, mean[0])

    def _put(self, title: str, kind: str, values: Any, own: bool = False) -> None:
        """Add a curve to a plot; kind: of the file, "" as wanted; own: the output itself, which gets a column, too."""
        plain = {"±" if title == _BAND else "": values}
        parts = {"x": values.real, "y": values.imag} if np.iscomplexobj(values) else plain
        for axis, part in parts.items():
            shown = self.scale * part
            if title == _SPEED and self.cycle.unit != "deg":
                shown = shown * math.radians(1)
            if own and self.unit == "deg":
                self._sense = _turned(float(shown[-1] - shown[0]))
            label = f"{axis} {f'from {kind.upper()}' if kind else 'wanted'}".strip()
            self._sources[label] = (axis, kind.upper() or "wanted")
            self._plots.setdefault(title, []).append((label, np.degrees(self.theta), shown))
            if own:
                words = (self.output.name.replace(" ", "_"), axis, self.unit, kind)
                self.columns["_".join(word for word in words if word)] = shown

    def _title(self, quantity: str) -> str:
        """What a plot of it is called, with the name of the output where there are several."""
        path = isinstance(self.output.of, Path)
        words = _SLOPE if quantity == _SPEED and not path else quantity
        lower = words[:1].lower() + words[1:]
        return words if self.alone else f"{self.output.name.capitalize()}: {lower}"

    def plots(self) -> list[Plot]:
        """One plot a quantity: the output itself, its speed, error and play."""
        mean = f", mean of {SPEED_WINDOW_DEG:g} deg" if self.cams else ""
        per = "rad" if self.cycle.unit == "deg" else self.cycle.unit
        name = self.output.name.capitalize()
        titles = [title for title in (name, _SPEED, _ERROR, _BAND) if title in self._plots]
        units = (
            {_SPEED: f"{self.unit}/{per}{mean}", titles[0]: self.unit + self._sense}
            if titles
            else {}
        )
        return [
            Plot(
                title if title == name else self._title(title),
                self.cycle.label,
                units.get(title, self.unit),
                self._plots[title],
                sources=self._sources,
                places=title not in (_SPEED, _ERROR, _BAND),
            )
            for title in titles
        ]


def laid_over(
    demand: Demand, recovered: Mapping[str, Any], lifts: Mapping[str, Curves]
) -> Iterator[Plot]:
    """The line that an output is to draw, and over it what each kind of file gives, where the pen is not lifted.

    recovered: the paths by the kind, (n,) complex mm; lifts: curves of all outputs by their names.
    """
    name = demand.output.capitalize()
    for target in demand.targets if recovered else ():
        if isinstance(target, Lines):
            lift = lifts[target.lift]
            wanted = one_line(target.lines)
            paths = {
                kind: one_line(target.drawn(path, lift.scale * lift.recovered[kind]))
                for kind, path in recovered.items()
            }
        elif isinstance(target, Trace):
            wanted = np.array(target.places)
            paths = dict(recovered)
        else:
            continue
        series = [("wanted", wanted.real, wanted.imag)]
        series += [(f"from {kind.upper()}", path.real, path.imag) for kind, path in paths.items()]
        dots = () if isinstance(target, Lines) or target.joined else ("wanted",)
        title = f"{name} over the wanted line{'s' if isinstance(target, Lines) else ''}"
        yield Plot(title, "x, mm", "y, mm", series, equal=True, dots=dots)


def as_designed(mechanism: Mechanism) -> list[Plot]:
    """Each output that is one number, and its speed, of exact parts: before there are files."""
    outputs = [output for output in mechanism.model.outputs if not isinstance(output.of, Path)]
    theta = np.linspace(*mechanism.assembly.cycle.range, 1441)
    run = mechanism.solve(theta, 1)
    plots = []
    for output in outputs:
        curve = Curves(output, theta, mechanism.assembly.cycle, len(outputs) == 1)
        curve.want(*run.derivatives(output.name))
        plots += curve.plots()
    return plots


def _turned(far: float) -> str:
    """Behind the unit of an angle's curve how far and in which sense it turns on from end to end, deg; "" where it comes back."""
    if not abs(far) > _TURNS_ON:
        return ""
    return f", {rounded(far)} from end to end: {'clockwise' if far < 0 else 'counter-clockwise'}"
