"""Shafts that are made: of cams and drums how long they are, their bearings, and the rings that hold a keyed bore along them; and rods
with keyways.

Bearings 6000 to 6010: bearingsblog.blogspot.com/2024/10/understanding-6000-bearing-dimensions.html. Retaining rings, DIN 471:
scribd.com/document/416335815, External Retaining Rings; up to 19 the same at capitalbolts.in/din-471, which has the tolerances of
grooves. From 24 to 42, and the tolerances there: fixawell.com/retaining-ring-din-983.htm, whose rings have other lugs in the same
grooves; its nine rows from 16 to 50 that the first source has too are equal. Gaps, the end for a coupling, and what shims fill: camgen's own rules. Fits under a ball bearing whose inner ring turns about a light load, as cams are:
engineersedge.com, 15319 (ANSI/ABMA 7). A key h9 is light in keyways N9 of the shaft and JS9
of the bore, tight in P9 of both: berger-tools.co.uk, Standard_Parts_Catalogue, page 2078.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace

from camgen.geometry.arcs import as_circle
from camgen.parts.catalogue import TURNED, Bearing, Bought, narrowest
from camgen.parts.keyways import key_length, keyed, keyway, shaft_keyway
from camgen.parts.part import Part
from camgen.parts.turned_shafts import RingGrooves, ShaftBearings, ShaftKeyway, TurnedShaft
from camgen.tolerances import SAME_POINT

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
    24.0: (1.2, 22.9, 1.3),
    25.0: (1.2, 23.9, 1.3),
    26.0: (1.2, 24.9, 1.3),
    28.0: (1.5, 26.6, 1.6),
    30.0: (1.5, 28.6, 1.6),
    32.0: (1.5, 30.3, 1.6),
    35.0: (1.5, 33.0, 1.6),
    38.0: (1.75, 36.0, 1.85),
    40.0: (1.75, 37.5, 1.85),
    42.0: (1.75, 39.5, 1.85),
    45.0: (1.75, 42.5, 1.85),
    50.0: (2.0, 47.0, 2.15),
}
_FIT = "h6"  # fit of the shaft, so that bore, rings and coupling go on
_SEATS = {18.0: "h6", 40.0: "j6", 50.0: "k6"}  # fits under bearings, up to a shaft of so many mm
_GROOVE_FITS = {10.0: "h10", 22.0: "h11", 50.0: "h12"}  # of a groove, up to a shaft of so many mm
_GAP = 0.5  # of the shaft: from the bore to a bearing
_COUPLING = 1.5  # of it: end for a coupling
_STEP = 5.0  # mm, of lengths of shafts
# mm, that shims fill between rings and bore, at least, and where grooves, rings and bore have the whole of their tolerances, h11 of the
# bore's length with it
_SHIMMED = (0.3, 0.9)
_WIDER = 0.2  # mm, by which grooves may lie farther apart
_SNAPPED = "one on either side of the bore"
_SHIMMED_BORE = "; put {} in until it slides at most 0.05 mm"
OF_SHAFT = "bearing of the shaft"  # name of its row
_BEFORE = 5.0  # from the shaft's end to its first bearing, where a ring holds that
_BEARING_SLACK = 0.1  # that the rings leave a bearing, at least
_SLACKER = 0.1  # by which their grooves may lie farther apart
_OF_SLACK = (0.1, 0.5)  # that shims fill there: the bearing may be 0.12 narrower, each ring 0.06
_OF_BORE = "retaining ring"
OF_BEARING = "retaining ring of a bearing"
_INNER_FIRST = (
    "on the shaft, two of them now: one on either side of the bore, in the groove next to it. The bearings come against these, "
    "and the other two outside the bearings"
)
_OUTER_LAST = "; then close each with the second retaining ring, and put {} between this and the bearing until at most 0.05 mm is left"
_COLLARS = (
    "; a collar or a shoulder of yours on either side of each keeps it in its place on the shaft"
)
_KEYED = "its key in the keyway of the bore, its end for the coupling below, as in the arrangement drawing"
_FAST = "fast in it"
_SEALED = "sealed on both sides and greased (2RS)"
_PRESSED = "pressed on the shaft by their inner rings, "
_BEARINGS = (
    "one on either side, in a frame of yours: it holds the one at the end without the coupling on both sides of its outer ring, so that "
    "the shaft cannot slide, and leaves the other one free in its seat"
)


@dataclass(frozen=True)
class Seat:
    """Where bores sit on a shaft, one after the other; mm."""

    bore: float  # diameter
    lengths: Sequence[float]  # of the bores
    key_width: float = 0.0  # of the key in each of them; 0: none
    key_fit: str = "N9"  # of the shaft's keyways
    ringed: bool = False  # whether retaining rings hold it along the shaft
    marked: bool = False  # whether its end away from the coupling has UP


def shaft_and_bearings(seat: Seat) -> list[Bought]:
    """A shaft, with all that its maker has to know where it has no sheet, rings and shims on it, and the bearings in which it turns, if
    there are some of its size; in the order in which they are put on."""
    bore = seat.bore
    how = f"through the bore, {_KEYED if seat.key_width else _FAST}{', UP above' * seat.marked}"
    shaft = Bought("shaft", "", "", 1, "shaft", how=how, process=TURNED)
    rings = retaining_rings(bore) if seat.ringed else []
    if rings:
        fill = _shims("the bore", bore, _SHIMMED, 1)
        rings = [replace(rings[0], how=_SNAPPED + _SHIMMED_BORE.format(fill.text)), fill]
    made = turned_shaft(seat)
    if made is None or made.bearings is None:
        size = f"{bore:g} {_FIT}, C45, {sum(seat.lengths):.4g} in the bore, and as long as its bearings need"
        cuts = _cuts(_keyways(seat, 0.0), _bore_grooves(seat, 0.0))
        return [replace(shaft, size=size, details="; ".join(cuts)), *rings]
    start = made.bores[0][0]
    below = made.length - start - sum(seat.lengths)
    begins = f"; the bore begins {start:.4g} mm from its other end. Lay what it goes through on blocks at least {math.ceil(below):g} mm high first"
    shaft = replace(
        shaft,
        size=f"{bore:g} {_FIT} x {made.length:g}, C45",
        details="see its drawing",
        shaft=made,
        how=how + begins,
    )
    bearing = _bearing(bore)
    assert bearing is not None
    held = [
        replace(each, name=OF_BEARING, count=4, how=_INNER_FIRST) for each in retaining_rings(bore)
    ]
    beside = _shims("a bearing", bore, _OF_SLACK, 2)
    held += [beside] if held else []
    turns = Bought(
        OF_SHAFT,
        bearing.standard,
        f"{bearing.name}, {bearing.size}",
        2,
        how=(_PRESSED if made.bearings.fit != _FIT else "")
        + _BEARINGS
        + (_OUTER_LAST.format(beside.text) if held else _COLLARS),
    )
    return [shaft, *rings, *held, replace(turns, key="parts.bore", details=_SEALED)]


def of_yours(shaft: TurnedShaft, drive: str) -> Iterator[Bought]:
    """What turns a shaft and what it turns in: the builder's own; drive: what that is, in words."""
    yield Bought("drive", "", drive, 1, "own")
    long = shaft.length - shaft.coupled
    size = f"for {shaft.diameter:g} {shaft.fit} over {long:.4g} mm without a key, and for the shaft of your drive"
    yield Bought("clamping coupling", "", size, 1, "own")
    if shaft.housings:
        yield Bought("frame", "", "; ".join(shaft.housings), 1, "own")


def _bearing(bore: float) -> Bearing | None:
    return narrowest(bore) or _LARGER.get(bore)


def turned_shaft(seat: Seat) -> TurnedShaft | None:
    """The shaft of bores as its sheet shows it; None where no bearing of its size is known."""
    bore = seat.bore
    bearing = _bearing(bore)
    if bearing is None:
        return None
    held = bore in _RINGS  # each bearing, by rings on either side
    first = _BEFORE if held else 0.0
    gap = _GAP * bore
    start = first + bearing.width + gap
    second = start + sum(seat.lengths) + gap
    thick, _, wide = _RINGS[bore] if held else (0.0, 0.0, 0.0)
    length = second + bearing.width + wide + _COUPLING * bore
    apart = bearing.width + 2 * thick + _BEARING_SLACK
    of_bearings = [
        _grooves(bore, OF_BEARING, begin - thick, apart, _SLACKER)
        for begin in (first, second)
        if held
    ]
    grooves = [*of_bearings[:1], *_bore_grooves(seat, start), *of_bearings[1:]]
    return TurnedShaft(
        bore,
        _FIT,
        _STEP * math.ceil(length / _STEP - 1e-9),
        tuple(_keyways(seat, start)),
        tuple(_bores(seat, start)),
        tuple(grooves),
        ShaftBearings(
            bearing.name,
            bearing.outside,
            bearing.width,
            (first, second),
            gap,
            next(fit for most, fit in _SEATS.items() if bore <= most),
        ),
    )


def rod_with_keyways(
    part: Part, fit: str, key_fit: str, keys: Sequence[tuple[float, float]]
) -> TurnedShaft | None:
    """A part as the shaft that it is: round about its axis and with keyways over some of its layers; None of any other part.

    fit: of its diameter; key_fit: of its keyways; keys: from where to where they lie, mm from its lower end.
    """
    spans = list[tuple[float, float]]()
    found = keyed(part.region.outer)
    for layer in sorted(part.layers, key=lambda each: each.z0):
        key = keyed(layer.region.outer)
        disc = as_circle(layer.region.outer)
        radius = key.radius if key else disc[1] if disc else 0.0
        if layer.region.holes or found is None or abs(radius - found.radius) > SAME_POINT:
            return None
        if key and spans and abs(spans[-1][1] - layer.z0) < SAME_POINT:
            spans[-1] = spans[-1][0], layer.z1
        elif key:
            spans.append((layer.z0, layer.z1))
    if found is None or abs(found.way - 1j) > SAME_POINT:
        return None
    _, deeper = shaft_keyway(2 * found.radius)
    keyways = [
        ShaftKeyway(
            start,
            end - start,
            found.width,
            key_fit,
            -found.depth,
            deeper,
            tuple(each for each in sorted(keys) if start - SAME_POINT < each[0] < end),
        )
        for start, end in spans
    ]
    return TurnedShaft(2 * found.radius, fit, part.thickness, tuple(keyways))


def _bores(seat: Seat, start: float) -> Iterator[tuple[float, float]]:
    """Where each bore begins, and its length, the first at `start`."""
    for length in seat.lengths:
        yield start, length
        start += length


def _keyways(seat: Seat, start: float) -> Iterator[ShaftKeyway]:
    """A keyway half way along each bore."""
    deep, deeper = shaft_keyway(seat.bore) if keyway(seat.bore) else (0.0, 0.0)
    for begin, length in _bores(seat, start) if seat.key_width else ():
        long = key_length(seat.bore, length)
        first = begin + (length - long) / 2
        yield ShaftKeyway(first, long, seat.key_width, seat.key_fit, deep, deeper)


def _bore_grooves(seat: Seat, start: float) -> Iterator[RingGrooves]:
    """Grooves for rings on either side of all bores, where they have some."""
    if seat.ringed and seat.bore in _RINGS:
        length = sum(seat.lengths)
        apart = length + 2 * _RINGS[seat.bore][0] + _SHIMMED[0]
        begin = start + (length - apart) / 2
        yield _grooves(seat.bore, _OF_BORE, begin, apart, _WIDER)


def _grooves(bore: float, ring: str, start: float, apart: float, wider: float) -> RingGrooves:
    thick, diameter, wide = _RINGS[bore]
    fit = next(fit for most, fit in _GROOVE_FITS.items() if bore <= most)
    return RingGrooves(ring, start, apart, wider, diameter, fit, wide, thick)


def _cuts(keyways: Iterable[ShaftKeyway], grooves: Iterable[RingGrooves]) -> Iterator[str]:
    """Keyways and grooves in words, of a shaft without a sheet, from where the bore begins."""
    for each in keyways:
        deep = f", {each.depth:g} +{each.deeper:g}/0 deep" if each.depth else ""
        yield (
            f"keyway {each.width:g} {each.fit} x {each.length:.4g}{deep}, round at both ends, "
            f"between {each.start:.4g} and {each.end:.4g} from where the bore begins"
        )
    for pair in grooves:
        yield (
            f"two grooves for rings, Ø{pair.diameter:g} {pair.fit}, {pair.width:g} H13 wide, "
            f"{pair.apart:.4g} +{pair.wider:g}/0 over their outer walls, the bore in the middle"
        )


def retaining_rings(bore: float) -> list[Bought]:
    """Rings on the shaft at both ends of a bore, mm; none of a diameter that the table has not."""
    if bore not in _RINGS:
        return []
    size = f"{bore:g} x {_RINGS[bore][0]:g}"
    return [Bought(_OF_BORE, "DIN 471", size, 2, how=_SNAPPED)]


def _shims(where: str, shaft: float, fill: tuple[float, float], count: int) -> Bought:
    """Sets of shims; fill: how thick one is, mm, at least and at most."""
    size = "for a shaft of {:g}, together {:g} to {:g} thick".format(shaft, *fill)
    return Bought(f"set of shims beside {where}", "DIN 988", size, count, "aside")
