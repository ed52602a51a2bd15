"""Many variants of a disc cam: what costs most of each is found for the cams of all of them as arrays."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

from camgen.machine.cams.many import ProfileFigures, figures_of
from camgen.machine.cams.profile import DiscCam

Sure = Callable[[DiscCam[Any], ProfileFigures], bool]


def fill(variants: Sequence[tuple[Sequence[DiscCam[Any]], Sure]]) -> list[bool]:
    """Fill pressure angles, curvature and sizes into the cams of each variant; whether they are, of each.

    Sure tells whether no rounding can turn a verdict on what is known of a cam: others are left to look for themselves.
    """
    known = iter(figures_of([cam for cams, _ in variants for cam in cams]))
    filled = []
    for cams, sure in variants:
        figures = [
            each if each is not None and sure(cam, each) else None
            for cam, each in zip(cams, [next(known) for _ in cams], strict=True)
        ]
        filled.append(None not in figures)
        for cam, each in zip(cams, figures, strict=True):
            if each is not None and filled[-1]:
                vars(cam).update(
                    undercuts=(),
                    least_radius=each.least_radius,
                    length=each.length,
                    area=each.area,
                    nearest=each.nearest,
                    steepest=each.steepest,
                    face_contact=(each.face_from, each.face_to),
                )
    return filled
