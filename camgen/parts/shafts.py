"""Shafts of cams and drums that are made alone: how long they are, their bearings, and the rings that hold a keyed bore along them.

Bearings 6000 to 6010: bearingsblog.blogspot.com/2024/10/understanding-6000-bearing-dimensions.html. Retaining rings, DIN 471:
scribd.com/document/416335815, External Retaining Rings; up to 19 the same at capitalbolts.in/din-471, which has the tolerances of
grooves. Gaps and the end for a coupling: camgen's own rules.
"""

from __future__ import annotations

import math
from dataclasses import replace

from camgen.parts.catalogue import Bearing, Bought, narrowest

_LARGER = {
    each.bore: each
    for each in (
        Bearing("6000", 10, 26, 8),
        Bearing("6001", 12, 28, 8),
        Bearing("6002", 15, 32, 9),
        Bearing("6003", 17, 35, 10),
        Bearing("6004", 20, 42, 12),
        Bearing("6005", 25, 47, 12),
        Bearing("6006", 30, 55, 13),
        Bearing("6007", 35, 62, 14),
        Bearing("6008", 40, 68, 15),
        Bearing("6009", 45, 75, 16),
        Bearing("6010", 50, 80, 16),
    )
}
# Diameter of the shaft -> thickness of the ring, diameter and width of its groove, mm.
_RINGS = {
    6.0: (0.7, 5.7, 0.8),
    7.0: (0.8, 6.7, 0.9),
    8.0: (0.8, 7.6, 0.9),
    9.0: (1.0, 8.6, 1.1),
    10.0: (1.0, 9.6, 1.1),
    11.0: (1.0, 10.5, 1.1),
    12.0: (1.0, 11.5, 1.1),
    13.0: (1.0, 12.4, 1.1),
    14.0: (1.0, 13.4, 1.1),
    15.0: (1.0, 14.3, 1.1),
    16.0: (1.0, 15.2, 1.1),
    17.0: (1.0, 16.2, 1.1),
    18.0: (1.2, 17.0, 1.3),
    19.0: (1.2, 18.0, 1.3),
    20.0: (1.2, 19.0, 1.3),
    21.0: (1.2, 20.0, 1.3),
    22.0: (1.2, 21.0, 1.3),
    45.0: (1.75, 42.5, 1.85),
    50.0: (2.0, 47.0, 2.15),
}
_FINER = 10.0  # mm, shaft up to which a groove is h10, then h11
_GAP = 0.5  # of the shaft: from the bore to a bearing
_COUPLING = 1.5  # of it: end for a coupling
_STEP = 5.0  # mm, of lengths of shafts


def shaft_and_bearings(bore: float, length: float) -> list[Bought]:
    """A shaft for bores of a diameter that are so long together, mm, and the bearings in which it turns, if there are some of its
    size."""
    bearing = narrowest(bore) or _LARGER.get(bore)
    shaft = Bought("shaft", "", "", 1, how="through the bore, fast in it")
    if bearing is None:
        size = f"{bore:g} h6, C45, {length:.4g} in the bore, and as long as its bearings need"
        return [replace(shaft, size=size)]
    gap = _GAP * bore
    coupling = _COUPLING * bore
    whole = length + 2 * (gap + bearing.width) + coupling
    whole = _STEP * math.ceil(whole / _STEP - 1e-9)
    size = (
        f"{bore:g} h6 x {whole:g}, C45: {length:.4g} in the bore, on either side {gap:g} free and a bearing of {bearing.width:g}, "
        f"at least {coupling:g} for the coupling"
    )
    ends = "on both sides of it, in a frame of yours"
    turns = Bought(
        "bearing of the shaft", bearing.standard, f"{bearing.name}, {bearing.size}", 2, how=ends
    )
    return [replace(shaft, size=size), replace(turns, key="parts.bore")]


def retaining_rings(bore: float) -> list[Bought]:
    """Rings on the shaft at both ends of a bore, mm; none of a diameter that the table has not."""
    if bore not in _RINGS:
        return []
    thick, groove, wide = _RINGS[bore]
    fit = "h10" if bore <= _FINER else "h11"
    size = f"{bore:g} x {thick:g}, in grooves Ø{groove:g} {fit} of the shaft, {wide:g} H13 wide"
    return [
        Bought("retaining ring", "DIN 471", size, 2, how="on the shaft, at both ends of the bore")
    ]
