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
from camgen.geometry.registration import Laid, dense, deviation, lay_on_known
from camgen.geometry.rings import Floats, Points, Ring
from camgen.machine.features import CamOutline
from camgen.machines.sources import read_mechanism

# mm: of the exact outline
_CHORDS = 1e-4
_STEP = 0.01
_ALIKE = 0.02  # of the cam's size: a measured outline that is farther off, rms, is another part
_TURNED_OVER = 0.5  # a mirror image counts where it lies so much better


@dataclass(frozen=True)
class Compared:
    """A measured outline in the frame of a spec's part, the part's exact one, a sentence, figures; how far it lies outside, by
    the angle about the shaft: (n,) deg and mm.
    """

    ring: Ring
    wanted: Ring
    remark: str
    numbers: dict[str, float] = field(default_factory=dict)
    angle: Floats = field(default_factory=lambda: np.zeros(0))
    outside: Floats = field(default_factory=lambda: np.zeros(0))


def compare(
    ring: Ring, spec: Path, bore: float | None, off: float, scanner_unknown: bool
) -> Compared:
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
    best, found = math.inf, None
    for part in parts:
        known = facet_contour(part.region.outer.counter_clockwise(), _CHORDS)
        for over in (False, True):
            laid = _laid(edge, known, over, scanner_unknown)
            if laid[3].off < (_TURNED_OVER if over else 1) * best:
                best, found = laid[3].off, (part, known, over, laid)
    assert found is not None
    part, known, over, (z, m, scale, how) = found
    size = float(np.max(np.abs(known)))
    if not best <= _ALIKE * size:
        remedy = (
            "name the spec of this part, and the unit and the dots per inch that it was measured in"
        )
        what = f"rms distance of the outline from {part.name}, the cam nearest to it"
        raise DesignError(what, best, _ALIKE * size, "mm", str(spec), remedy)
    axis = _image(0j, edge, known, over, m, scale, how)
    numbers = {"fit_turn_deg": math.degrees(math.remainder(how.turn, math.tau))}
    said = [
        f"laid on {part.name} of {spec.name}"
        + (", turned over: its other face was measured" if over else "")
    ]
    if bore is not None:
        z = z - axis
        numbers["bore_off_centre_mm"] = abs(axis)
        said.append(
            f"the bore, which stays the axis, is {abs(axis):.4f} mm off the outline's own centre"
        )
    if scanner_unknown:
        long, across, shear = 100 * (scale - 1), 200 * m.real, 200 * m.imag
        numbers |= {
            "scale_percent": long,
            "scanner_across_percent": across,
            "scanner_shear_percent": shear,
        }
        said.append(
            f"the scanner's scale {long:+.3f} %, x beside y {across:+.3f} % and shear {shear:+.3f} % are found "
            "from the whole outline, which hides what the print itself shrank"
        )
    outside = deviation(z, dense(known, _STEP))
    numbers |= {
        "deviation_max_mm": float(outside.max()),
        "deviation_min_mm": float(outside.min()),
        "deviation_rms_mm": float(np.sqrt(np.mean(outside**2))),
    }
    if math.isfinite(off):
        keys = [
            f"profile_compensation = {mechanism.print.profile_compensation + float(np.mean(outside)):.3f}"
        ]
        if bore is not None and part.bore is not None:
            numbers["bore_deviation_mm"] = bore - part.bore
            keys.append(
                f"hole_compensation = {mechanism.print.hole_compensation + (part.bore - bore) / 2:.3f}"
            )
        said.append(
            f"in [print] this would mend the mean of it, within {off:.3f} mm: {', '.join(keys)}"
        )
    else:
        said.append(
            "no compensation of [print] is told: the scanner's own scale is not known, which --across would tell"
        )
    order = np.argsort(np.angle(z) % (2 * np.pi))
    angle = np.degrees(np.angle(z) % (2 * np.pi))[order]
    measured, wanted = (Ring(each, np.zeros(len(each))) for each in (z, known))
    return Compared(
        measured.counter_clockwise(), wanted, "; ".join(said), numbers, angle, outside[order]
    )


def _laid(
    edge: Points, known: Points, over: bool, device: bool
) -> tuple[Points, complex, float, Laid]:
    """The measured outline, turned over if asked, laid on the known one in the known one's frame."""
    own, middle = _seen(edge, edge, over), _middle(known)
    z, m, scale, how = lay_on_known(own, dense(known - middle, _STEP), device)
    return z + middle, m, scale, how


def _seen(place: Points, edge: Points, over: bool) -> Points:
    """Places from the middle of a measured outline, turned over if asked."""
    z = place - _middle(edge)
    return np.asarray(-np.conj(z)[::-1] if over else z)


def _image(
    place: complex, edge: Points, known: Points, over: bool, m: complex, scale: float, how: Laid
) -> complex:
    """Where a place in the measured outline's frame lies in the known one's."""
    w = complex(_seen(np.array([place]), edge, over)[0])
    straight = (w - m * w.conjugate()) / (1 - abs(m) ** 2)
    return complex(np.exp(1j * how.turn) / scale * straight + how.shift + _middle(known))


def _middle(edge: Points) -> complex:
    return Ring(edge, np.zeros(len(edge))).centroid
