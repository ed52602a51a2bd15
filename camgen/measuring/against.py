"""A measured outline against the cam that a spec describes: place and turn by least squares, deviation, and the motion of both.

The cam is that of the spec's machine on whose exact outline the measured one lies best. What turns about a bore that was
measured keeps it as its axis; points without one take the place that fits best.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from camgen.errors import DesignError, Fault, SpecError
from camgen.geometry.facets import facet_contour
from camgen.geometry.registration import Registration, dense, deviation, lay_on_known
from camgen.geometry.rings import Floats, Points, Ring
from camgen.machine.features import CamOutline
from camgen.machines.sources import read_mechanism
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
    cams = {
        feature.part for feature in mechanism.assembly.features if isinstance(feature, CamOutline)
    }
    parts = [part for part in mechanism.assembly.parts if part.name in cams]
    if not parts:
        raise SpecError(
            [
                Fault(
                    (), mechanism.mechanism, "the spec of a machine with a cam", source="--against"
                )
            ],
            str(spec),
        )
    edge = ring.counter_clockwise().facetted(_CHORDS)
    best = None
    for candidate in parts:
        nominal = facet_contour(candidate.region.outer.counter_clockwise(), _CHORDS)
        for over in (False, True):
            fit = _Registration.of(edge, nominal, over, scanner_unknown)
            factor = _TURNED_OVER if over else 1
            if best is None or fit.laid.off < factor * best.laid.off:
                part = candidate
                best = fit
    assert best is not None
    nominal = best.known
    size = float(np.max(np.abs(nominal)))
    if not best.laid.off <= _ALIKE * size:
        remedy = (
            "name the spec of this part, and the unit and the dots per inch that it was measured in"
        )
        what = f"rms distance of the outline from {part.name}, the cam nearest to it"
        raise DesignError(what, best.laid.off, _ALIKE * size, "mm", str(spec), remedy)
    z = best.edge
    axis = best.image(0j)
    turn = math.degrees(math.remainder(best.laid.turn, math.tau))
    figures = [Figure("fit turn", turn, "deg")]
    sentences = [
        f"laid on {part.name} of {spec.name}"
        + (", turned over: its other face was measured" if best.over else "")
    ]
    if bore is not None:
        z = z - axis
        figures.append(Figure("bore off centre", abs(axis), "mm"))
        sentences.append(
            f"the bore, which stays the axis, is {abs(axis):.4f} mm off the outline's own centre"
        )
    if scanner_unknown:
        long = 100 * (best.scale - 1)
        across = 200 * best.skew.real
        shear = 200 * best.skew.imag
        figures += figures_in("%", scale=long, scanner_across=across, scanner_shear=shear)
        sentences.append(
            f"the scanner's scale {long:+.3f} %, x beside y {across:+.3f} % and shear {shear:+.3f} % are "
            "fitted to the whole outline, which hides shrinkage of the print itself"
        )
    outside = deviation(z, dense(nominal, _STEP))
    figures += figures_in(
        "mm",
        deviation_max=float(outside.max()),
        deviation_min=float(outside.min()),
        deviation_rms=float(np.sqrt(np.mean(outside**2))),
    )
    if math.isfinite(off):
        keys = [
            f"profile_compensation = {mechanism.print.profile_compensation + float(np.mean(outside)):.3f}"
        ]
        if bore is not None and part.bore is not None:
            figures.append(Figure("bore deviation", bore - part.bore, "mm"))
            keys.append(
                f"hole_compensation = {mechanism.print.hole_compensation + (part.bore - bore) / 2:.3f}"
            )
        sentences.append(
            f"these keys of [print] correct the mean error, within {off:.3f} mm: {', '.join(keys)}"
        )
    else:
        sentences.append(
            "no compensation for [print]: the scanner's own scale is not known; give --across, the width by a caliper"
        )
    order = np.argsort(np.angle(z) % (2 * np.pi))
    angle = np.degrees(np.angle(z) % (2 * np.pi))[order]
    measured, nominal_ring = (Ring(each, np.zeros(len(each))) for each in (z, nominal))
    return Comparison(
        measured.counter_clockwise(),
        nominal_ring,
        "; ".join(sentences),
        Figures(figures),
        angle,
        outside[order],
    )


@dataclass(frozen=True)
class _Registration:
    """A measured outline laid on a known one, in the known one's frame, mm."""

    edge: Points  # the measured one as it is laid, (n,)
    known: Points
    middle: complex  # of the measured one in its own frame
    over: bool  # whether it was turned over
    skew: complex  # of the scanner: as w of the part it sees w + skew conj(w)
    scale: float  # of the scanner
    laid: Registration

    @classmethod
    def of(cls, edge: Points, known: Points, over: bool, scanner_unknown: bool) -> _Registration:
        """The best fit; scanner_unknown: with its scale and skew."""
        middle = _middle(edge)
        outline = _reflected(edge - middle) if over else edge - middle
        target = dense(known - _middle(known), _STEP)
        z, skew, scale, registration = lay_on_known(outline, target, scanner_unknown)
        return cls(z + _middle(known), known, middle, over, skew, scale, registration)

    def image(self, place: complex) -> complex:
        """Where a place in the measured outline's own frame lies in the known one's."""
        w = place - self.middle
        w = -w.conjugate() if self.over else w
        straight = (w - self.skew * w.conjugate()) / (1 - abs(self.skew) ** 2)
        z = np.exp(1j * self.laid.turn) / self.scale * straight
        return complex(z + self.laid.shift + _middle(self.known))


def _reflected(z: Points) -> Points:
    """An outline turned over about Oy, in the same sense."""
    return np.asarray(-np.conj(z)[::-1])


def _middle(edge: Points) -> complex:
    return Ring(edge, np.zeros(len(edge))).centroid
