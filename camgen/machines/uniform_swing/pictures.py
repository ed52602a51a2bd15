"""Figures 2 to 5 of the source, drawn from a spec: the model at both ends of the swing, its vectors, how the cam is rolled.

    O, A      centre of the cam, pivot of the follower: OA = L
    A, B, C   the follower: AB = H, BC = L, square at B; C touches the cam
    figure 2  cam and follower at the beginning and half a turn on        [a, b]
    figure 3  AC at alpha_1 and alpha_2 from AO, OC at beta_1 and beta_2 from Oy
    figure 4  the first half turn with the cam held: OA turns clockwise by phi, ABC with it, and forth about A by alpha - alpha_1
    figure 5  the second half turn, in which ABC turns back by alpha_2 - alpha

[Sentyakov et al., Vestnik TGTU 2018, 24(4), 698-706]
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from camgen.geometry.facets import facet_contour
from camgen.geometry.outlines import Floats, Points
from camgen.machine.cams.profile import DiscCam
from camgen.study import Plot

_ROUND = np.linspace(0, math.tau, 721)
_STEPS = 4  # positions of a half turn that are drawn after the first
_CHORD = 0.02  # mm, of an outline that is only looked at
_X = "x, mm"
_Y = "y, mm"

Named = tuple[str, complex]


@dataclass(frozen=True)
class Model:
    """The source's triangle: pivot L, width H, mm; swing 2 Delta, rad; cam: whose program swings it."""

    pivot: float
    width: float
    swing: float
    cam: DiscCam

    @property
    def alpha_1(self) -> float:
        """Angle of AC from AO at the beginning, rad."""
        return math.atan2(self.width, self.pivot) - self.swing / 2

    def alpha(self, phi: Floats) -> Floats:
        """The same at cam angles, (n,) rad."""
        return np.asarray(self.alpha_1 + self.swing / 2 + self.cam.program(phi))

    def tip(self, alpha: Floats | float) -> Points:
        """C on the ground."""
        return np.asarray(
            self.pivot - math.hypot(self.pivot, self.width) * np.exp(1j * np.asarray(alpha)),
            complex,
        )

    def corner(self, alpha: Floats | float) -> Points:
        """B on the ground: in mid position straight under A."""
        turned = np.exp(1j * (np.asarray(alpha) - self.alpha_1 - self.swing / 2))
        return np.asarray(self.pivot - 1j * self.width * turned, complex)

    def way(self, begin: float = 0.0, end: float = math.tau) -> Points:
        """Path of C as the cam sees it: the profile of a sharp tip."""
        phi = begin + _ROUND / math.tau * (end - begin)
        return np.asarray(self.tip(self.alpha(phi)) * np.exp(-1j * phi))

    def profile(self) -> Points:
        """The cam's outline at phi = 0."""
        rim = facet_contour(self.cam.outline, _CHORD)
        return np.append(rim, rim[0])


def pictures(model: Model) -> list[Plot]:
    """The figures, in the source's order."""
    return [
        _model(model, 0.0, "a"),
        _model(model, math.pi, "b"),
        _vectors(model),
        _rolled(model, False),
        _rolled(model, True),
    ]


def _line(name: str, places: Sequence[complex] | Points) -> tuple[str, Floats, Floats]:
    z = np.asarray(places, complex)
    return name, z.real, z.imag


def _plot(
    title: str, series: Sequence[tuple[str, Floats, Floats]], points: Sequence[Named]
) -> Plot:
    named = [(name, complex(z).real, complex(z).imag) for name, z in points]
    return Plot(title, _X, _Y, series, equal=True, points=named)


def _model(model: Model, phi: float, which: str) -> Plot:
    """Figure 2: the cam turned by phi, rad, and the follower on it."""
    alpha = model.alpha(np.array([phi]))[0]
    b = complex(model.corner(alpha))
    c = complex(model.tip(alpha))
    cam = model.profile() * cmath.exp(1j * phi)
    series = [_line("cam", cam), _line("follower ABC", [model.pivot, b, c])]
    words = "at the beginning" if which == "a" else "half a turn on"
    named = [("O", 0j), ("A", complex(model.pivot)), ("B", b), ("C", c)]
    return _plot(f"Source, figure 2, {which}: cam and follower {words}", series, named)


def _vectors(model: Model) -> Plot:
    """Figure 3."""
    ends = model.alpha_1, model.alpha_1 + model.swing
    tips = [complex(model.tip(alpha)) for alpha in ends]
    pivot = complex(model.pivot)
    radius = 0.35 * model.pivot
    arcs: list[Points] = []
    named: list[Named] = [
        ("O", 0),
        ("A", pivot),
        *((f"C{k}", tip) for k, tip in enumerate(tips, 1)),
    ]
    for k, (alpha, tip) in enumerate(zip(ends, tips, strict=True), 1):
        size = (1 - 0.25 * (k - 1)) * radius
        arc = pivot - size * np.exp(1j * np.linspace(0, alpha, 61))
        lean = cmath.phase(tip * 1j)  # of OC from Oy, downwards
        near = -1j * 0.35 * (1 + k) * abs(tips[0]) * np.exp(1j * np.linspace(0, lean, 61))
        arcs += [np.append(each, complex(math.nan, math.nan)) for each in (arc, near)]
        named += [(f"α{k}", complex(arc[40])), (f"β{k}", complex(near[30]))]
    series = [
        _line("OA = L", [0, pivot]),
        _line("AC = R", [tips[0], pivot, tips[1]]),
        _line("OC, r₁ and r₂", [tips[0], 0, tips[1]]),
        _line("way of C", model.tip(np.linspace(*ends, 121))),
        _line("angles", np.concatenate(arcs)),
    ]
    return _plot("Source, figure 3: vectors at both ends of the swing", series, named)


def _rolled(model: Model, back: bool) -> Plot:
    """Figures 4 and 5: the follower rolled round the cam, which is held."""
    begin = math.pi if back else 0.0
    phi = begin + np.linspace(0, math.pi, _STEPS + 1)
    alpha = model.alpha(phi)
    turn = np.exp(-1j * phi)
    a = model.pivot * turn
    b = model.corner(alpha) * turn
    c = model.tip(alpha) * turn
    follower = np.concatenate(
        [[x, y, z, complex(math.nan, math.nan)] for x, y, z in zip(a, b, c, strict=True)]
    )
    series = [
        _line("profile", model.way()),
        _line("of this half turn", model.way(begin, begin + math.pi)),
        _line("ABC", follower),
        _line("way of A", model.pivot * np.exp(-1j * (begin + _ROUND / 2))),
    ]
    marks = range(_STEPS + 1)
    named = [
        ("O", 0j),
        *((f"A{k}", a[k]) for k in marks),
        ("B0", b[0]),
        *((f"C{k}", c[k]) for k in marks),
    ]
    number, half = (5, "second") if back else (4, "first")
    return _plot(
        f"Source, figure {number}: ABC rolled round the held cam, {half} half turn", series, named
    )
