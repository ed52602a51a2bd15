"""Curves of one output over the turn, as wanted and as each kind of file gives it: for the report and motion.csv."""

from __future__ import annotations

from typing import Any

import numpy as np

from camgen.geometry.outlines import Floats
from camgen.judge.motion import Proof, unit_of
from camgen.machine.model import Output
from camgen.machine.study import Plot

_SPEED, _ERROR, _BAND = "Speed", "Motion error", "Worst case of the joints' play"


class Curves:
    """Columns and plots of an output at theta, (n,) rad; a path's are x and y. alone: it is the machine's only output."""

    def __init__(self, output: Output, theta: Floats, alone: bool) -> None:
        self.output, self.theta, self.alone = output, theta, alone
        self.unit, self.scale = unit_of(output)
        self.columns: dict[str, Floats] = {}
        self._plots: dict[str, list[tuple[str, Floats, Floats]]] = {}
        self._wanted: Any = None

    def want(self, value: Any, slope: Any) -> None:
        """The wanted motion and its slope, (n,)."""
        self._wanted = value
        self._put(self.output.name.capitalize(), "wanted", value, "wanted", "")
        self._put(_SPEED, "wanted", slope, "wanted", "rad")

    def add(self, kind: str, proof: Proof) -> None:
        """What a kind of file gives."""
        name, source = self.output.name, f"from {kind.upper()}"
        if self._wanted is None:
            self.want(*proof.wanted(name, self.theta))
        moved = proof.moved(name, self.theta)
        self._put(name.capitalize(), source, moved.value, "recovered", kind)
        self._put(_SPEED, source, moved.slope)
        self._put(_ERROR, source, moved.value - self._wanted)
        self._put(_BAND, f"+- {source}", moved.play, "band", kind)

    def _put(self, title: str, label: str, values: Any, what: str = "", of: str = "") -> None:
        """Add a curve to a plot, and as a column where it says what it is and of what kind of file, or "rad" of a slope."""
        parts = {"x": values.real, "y": values.imag} if np.iscomplexobj(values) else {"": values}
        for axis, part in parts.items():
            shown = self.scale * part
            self._plots.setdefault(title, []).append((f"{axis} {label}".strip(), np.degrees(self.theta), shown))
            if what:
                self.columns[self._column(axis, what, of)] = shown

    def _column(self, axis: str, what: str, of: str) -> str:
        if self.alone:
            words = [axis, what, self.unit, of] if of == "rad" else [axis, what, of, self.unit]
        else:
            words = [self.output.name.replace(" ", "_"), axis, "" if what in ("wanted", "recovered") else what, self.unit, of]
        return "_".join(word for word in words if word)

    def plots(self) -> list[Plot]:
        """One plot a quantity: the output itself, its speed, error and play."""
        of = "" if self.alone else f" of {self.output.name}"
        titles = [title for title in (self.output.name.capitalize(), _SPEED, _ERROR, _BAND) if title in self._plots]
        return [
            Plot(
                title + (of if title in (_SPEED, _ERROR, _BAND) else ""), "crank angle, deg",
                f"{self.unit}/rad" if title == _SPEED else self.unit, self._plots[title],
            )
            for title in titles
        ]  # fmt: skip
