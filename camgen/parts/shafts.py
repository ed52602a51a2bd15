"""Shafts of cams and drums that are made alone: how long they are, their bearings, and the rings that hold a keyed bore along them.

Bearings 6000 to 6010: bearingsblog.blogspot.com/2024/10/understanding-6000-bearing-dimensions.html. Retaining rings, DIN 471:
scribd.com/document/416335815, External Retaining Rings; up to 19 the same at capitalbolts.in/din-471, which has the tolerances of
grooves. Gaps, the end for a coupling, and what shims fill: camgen's own rules. A key h9 is light in keyways N9 of the shaft and JS9
of the bore, tight in P9 of both: berger-tools.co.uk, Standard_Parts_Catalogue, page 2078.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

from camgen.parts.catalogue import TURNED, Bearing, Bought, narrowest
from camgen.parts.keyways import key_length, keyway, shaft_keyway

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
_SHIMMED = 0.3  # mm, that shims fill between rings and bore, at least
_MOST_SHIMMED = 0.7  # mm, where grooves and bore have the whole of their tolerances, h11 of the bore's length with it
_WIDER = 0.2  # mm, by which grooves may lie farther apart
_SNAPPED = "one in each groove of the shaft; put shims (DIN 988) beside the bore until it slides at most 0.05 mm"
_KEYED = "its key in the keyway of the bore"
_FAST = "fast in it"
_BEARINGS = (
    "one on either side, in a frame of yours: it holds one of them on both its rings, so that the shaft cannot slide, and leaves the "
    "other one free in its seat"
)


@dataclass(frozen=True)
class Seat:
    """Where bores sit on a shaft, one after the other; mm."""

    bore: float  # diameter
    lengths: Sequence[float]  # of the bores
    key_width: float = 0.0  # of the key in each of them; 0: none
    key_fit: str = "N9"  # of the shaft's keyways
    ringed: bool = False  # whether retaining rings hold it along the shaft


def shaft_and_bearings(seat: Seat) -> list[Bought]:
    """A shaft with all that its maker has to know, rings on it, and the bearings in which it turns, if there are some of its size;
    in the order in which they are put on."""
    bore = seat.bore
    length = sum(seat.lengths)
    bearing = narrowest(bore) or _LARGER.get(bore)
    how = f"through the bore, {_KEYED if seat.key_width else _FAST}"
    shaft = Bought("shaft", "", "", 1, "shaft", how=how, process=TURNED)
    rings = retaining_rings(bore) if seat.ringed else []
    place = f"{length:.4g} in the bore"
    if bearing is None:
        size = f"{bore:g} h6, C45, {place}, and as long as its bearings need"
        cuts = _cuts(seat, 0.0, "from where the bore begins")
        return [replace(shaft, size=size, details="; ".join(cuts)), *rings]
    gap = _GAP * bore
    coupling = _COUPLING * bore
    whole = length + 2 * (gap + bearing.width) + coupling
    whole = _STEP * math.ceil(whole / _STEP - 1e-9)
    place += f", on either side {gap:g} free and a bearing of {bearing.width:g}, at least {coupling:g} for the coupling"
    cuts = _cuts(seat, gap + bearing.width, "from the end without the coupling")
    shaft = replace(shaft, size=f"{bore:g} h6 x {whole:g}, C45", details="; ".join([place, *cuts]))
    turns = Bought(
        "bearing of the shaft",
        bearing.standard,
        f"{bearing.name}, {bearing.size}",
        2,
        how=_BEARINGS,
    )
    return [shaft, *rings, replace(turns, key="parts.bore")]


def _cuts(seat: Seat, start: float, origin: str) -> Iterator[str]:
    """Keyways and grooves of a shaft whose first bore begins there, mm from an origin."""
    for length in seat.lengths if seat.key_width else ():
        long = key_length(seat.bore, length)
        first = start + (length - long) / 2
        depth = shaft_keyway(seat.bore) if keyway(seat.bore) else None
        deep = f", {depth[0]:g} +{depth[1]:g}/0 deep" if depth else ""
        yield (
            f"keyway {seat.key_width:g} {seat.key_fit} x {long:.4g}{deep}, round at both ends, "
            f"between {first:.4g} and {first + long:.4g} {origin}"
        )
        start += length
    if seat.ringed and seat.bore in _RINGS:
        thick, groove, wide = _RINGS[seat.bore]
        fit = "h10" if seat.bore <= _FINER else "h11"
        apart = sum(seat.lengths) + 2 * thick + _SHIMMED
        yield (
            f"two grooves for rings, Ø{groove:g} {fit}, {wide:g} H13 wide, {apart:.4g} +{_WIDER:g}/0 over their outer walls, "
            "the bore in the middle"
        )


def retaining_rings(bore: float) -> list[Bought]:
    """Rings on the shaft at both ends of a bore, mm; none of a diameter that the table has not."""
    if bore not in _RINGS:
        return []
    size = f"{bore:g} x {_RINGS[bore][0]:g}"
    ring = Bought("retaining ring", "DIN 471", size, 2, how=_SNAPPED)
    shims = f"with shims DIN 988 for a shaft of {bore:g}, together {_SHIMMED:g} to {_MOST_SHIMMED:g} thick"
    return [replace(ring, details=shims)]
