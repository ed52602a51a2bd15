"""A measured outline against the cam that a spec describes: place and turn by least squares, deviation, and the motion of both.

The cam is that of the spec's machine on whose exact outline the measured one lies best. What turns about a bore that was
measured keeps it as its axis; points without one take the place that fits best.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from camgen.errors import DesignError, Fault, SpecError
from camgen.geometry.facets import facet_contour
from camgen.geometry.registration import Registration, dense, deviation, lay_on_known
from camgen.geometry.rings import Floats, Points, Ring
from camgen.machine.features import CamOutline
from camgen.machines.mechanism import Mechanism
from camgen.machines.sources import read_mechanism
from camgen.numerics import magnitude
from camgen.spec import Print
from camgen.study import Figure, Figures, figures_in

# mm: of the exact outline
_CHORDS = 1e-4
_STEP = 0.01
_ALIKE = 0.02  # of the cam's size: a measured outline that is farther off, rms, is another part
_TURNED_OVER = 0.5  # a mirror image counts where it lies so much better


@dataclass(frozen=True)
class Comparison:
    """A measured outline in the frame of a spec's part, the part's exact one, a sentence, figures; how far it lies outside, by
    the angle about the shaft: (n,) deg and mm.
    """

    ring: Ring
    wanted: Ring
    remark: str
    numbers: Figures = field(default_factory=Figures)
    angle: Floats = field(default_factory=lambda: np.zeros(0))
    outside: Floats = field(default_factory=lambda: np.zeros(0))


def compare(
    ring: Ring, spec: Path, bore: float | None, off: float, scanner_unknown: bool
) -> Comparison:
    """Lay a measured outline on the cams of a spec; SpecError where it has none, DesignError where it is like none of them.

    bore: measured diameter of the hole that is the ring's origin, mm, None where the origin means nothing. off: what the
    wall may be off by the measuring, mm, nan where it is not known; scanner_unknown: the scale and skew of the scanner are to
    be found from the known outline, too.
    """
    mechanism = read_mechanism(spec)
    best = _best_fit(ring, mechanism, spec, scanner_unknown)
    size = magnitude(best.cam.outline)
    if not best.laid.off <= _ALIKE * size:
        remedy = (
            "name the spec of this part, and the unit and the dots per inch that it was measured in"
        )
        what = f"rms distance of the outline from {best.cam.name}, the cam nearest to it"
        raise DesignError(what, best.laid.off, _ALIKE * size, "mm", str(spec), remedy)
    turned = ", turned over: its other face was measured" if best.over else ""
    told = [
        best.turn(),
        _Told([], f"laid on {best.cam.name} of {spec.name}{turned}"),
        *([] if bore is None else [best.eccentricity()]),
        *([best.scanner()] if scanner_unknown else []),
    ]
    z = best.edge if bore is None else best.edge - best.image(0j)
    outside = deviation(z, dense(best.cam.outline, _STEP))
    told.append(_deviations(outside))
    wide = None if bore is None or best.cam.bore is None else bore - best.cam.bore
    told.append(_compensation(mechanism.print, wide, float(np.mean(outside)), off))
    angle = np.degrees(np.angle(z) % (2 * np.pi))
    order = np.argsort(angle)
    measured, nominal = (Ring.straight(each) for each in (z, best.cam.outline))
    return Comparison(
        measured.counter_clockwise(),
        nominal,
        "; ".join(each.sentence for each in told if each.sentence),
        Figures(figure for each in told for figure in each.figures),
        angle[order],
        outside[order],
    )


@dataclass(frozen=True)
class _Told:
    """Figures of a comparison, and what a person should know of them."""

    figures: Sequence[Figure]
    sentence: str = ""


def _deviations(outside: Floats) -> _Told:
    """How far points of the wall lie out of the known outline, (n,) mm."""
    return _Told(
        figures_in(
            "mm",
            deviation_max=float(outside.max()),
            deviation_min=float(outside.min()),
            deviation_rms=float(np.sqrt(np.mean(outside**2))),
        )
    )


def _compensation(printing: Print, wide: float | None, mean: float, off: float) -> _Told:
    """The keys of [print] that would correct the mean deviation of the wall and a bore that is `wide` too wide, mm.

    off: mm, by which the measuring may be off.
    """
    if not math.isfinite(off):
        return _Told(
            [],
            "no compensation for [print]: the scanner's own scale is not known; give --across, the width by a caliper",
        )
    figures = []
    keys = [f"profile_compensation = {printing.profile_compensation + mean:.3f}"]
    if wide is not None:
        figures.append(Figure("bore deviation", wide, "mm"))
        keys.append(f"hole_compensation = {printing.hole_compensation - wide / 2:.3f}")
    correct = f"these keys of [print] correct the mean error, within {off:.3f} mm"
    return _Told(figures, f"{correct}: {', '.join(keys)}")


def _best_fit(ring: Ring, mechanism: Mechanism, spec: Path, scanner_unknown: bool) -> _Registration:
    """The cam of a machine, and the side of it, on which a measured outline lies best; SpecError where there is no cam."""
    cams = {
        feature.part for feature in mechanism.assembly.features if isinstance(feature, CamOutline)
    }
    parts = [part for part in mechanism.assembly.parts if part.name in cams]
    if not parts:
        right = "the spec of a machine with a cam"
        raise SpecError([Fault((), mechanism.mechanism, right, source="--against")], str(spec))
    edge = ring.counter_clockwise().facetted(_CHORDS)
    fits = []
    for part in parts:
        outline = facet_contour(part.region.outer.counter_clockwise(), _CHORDS)
        cam = _Cam(part.name, part.bore, outline)
        fits += [_Registration.of(edge, cam, over, scanner_unknown) for over in (False, True)]
    best = fits[0]
    for fit in fits[1:]:
        if fit.laid.off < (_TURNED_OVER if fit.over else 1) * best.laid.off:
            best = fit
    return best


@dataclass(frozen=True)
class _Cam:
    """A cam of a spec, in its own frame."""

    name: str
    bore: float | None  # mm
    outline: Points  # mm, counter-clockwise


@dataclass(frozen=True)
class _Registration:
    """A measured outline laid on a known one, in the known one's frame, mm."""

    cam: _Cam
    edge: Points  # the measured one as it is laid, (n,)
    middle: complex  # of the measured one in its own frame
    over: bool  # whether it was turned over
    skew: complex  # of the scanner: as w of the part it sees w + skew conj(w)
    scale: float  # of the scanner
    laid: Registration

    @classmethod
    def of(cls, edge: Points, cam: _Cam, over: bool, scanner_unknown: bool) -> _Registration:
        """The best fit; scanner_unknown: with its scale and skew."""
        middle = _middle(edge)
        outline = _reflected(edge - middle) if over else edge - middle
        target = dense(cam.outline - _middle(cam.outline), _STEP)
        z, skew, scale, registration = lay_on_known(outline, target, scanner_unknown)
        laid = z + _middle(cam.outline)
        return cls(cam, laid, middle, over, skew, scale, registration)

    def turn(self) -> _Told:
        """How far it was turned to lie on the known one, deg."""
        turn = math.degrees(math.remainder(self.laid.turn, math.tau))
        return _Told([Figure("fit turn", turn, "deg")])

    def eccentricity(self) -> _Told:
        """How far the bore, its own frame's origin, lies from where the known one has it, mm."""
        off = abs(self.image(0j))
        sentence = f"the bore, which stays the axis, is {off:.4f} mm off the outline's own centre"
        return _Told([Figure("bore off centre", off, "mm")], sentence)

    def scanner(self) -> _Told:
        """What is found of the scanner, %: its scale, how much longer its x is than its y, its shear."""
        long = 100 * (self.scale - 1)
        across = 200 * self.skew.real
        shear = 200 * self.skew.imag
        return _Told(
            figures_in("%", scale=long, scanner_across=across, scanner_shear=shear),
            f"the scanner's scale {long:+.3f} %, x beside y {across:+.3f} % and shear {shear:+.3f} % are "
            "fitted to the whole outline, which hides shrinkage of the print itself",
        )

    def image(self, place: complex) -> complex:
        """Where a place in the measured outline's own frame lies in the known one's."""
        w = place - self.middle
        w = -w.conjugate() if self.over else w
        straight = (w - self.skew * w.conjugate()) / (1 - abs(self.skew) ** 2)
        z = np.exp(1j * self.laid.turn) / self.scale * straight
        return complex(z + self.laid.shift + _middle(self.cam.outline))


def _reflected(z: Points) -> Points:
    """An outline turned over about Oy, in the same sense."""
    return np.asarray(-np.conj(z)[::-1])


def _middle(edge: Points) -> complex:
    return Ring.straight(edge).centroid
