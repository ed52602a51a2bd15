"""Keyways of hubs and the parallel keys in them, after DIN 6885 sheet 1.

Up to a bore of 44: berger-tools.co.uk, Standard_Parts_Catalogue, page 2078 (widths, t2 and its tolerance, t1) and
engineeringhardware.com, DIN 6885 Parallel Keys (heights of keys, their lengths up to a bore of 58); beyond: Siemens, Flender gear
units, MD 31.1, 2016, page 7/3, which has no tolerance of t2; lengths there: blog.csdn.net/weixin_39519072/article/details/111860237,
table of plain parallel keys, whose other rows are the same.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

from camgen.geometry.outlines import Arc, Contour, Line, end_point, start_point
from camgen.parts.catalogue import Bought
from camgen.parts.part import Part

# Width and height of the key, depth t2 of the hub's keyway, what t2 may be deeper, 0 where the source has none, depth t1 of the
# shaft's, and the shortest and the longest key; by the bores up to which they are, mm.
_KEYWAYS = (
    (8.0, 2.0, 2.0, 1.0, 0.1, 1.2, 6.0, 20.0),
    (10.0, 3.0, 3.0, 1.4, 0.1, 1.8, 6.0, 36.0),
    (12.0, 4.0, 4.0, 1.8, 0.1, 2.5, 8.0, 45.0),
    (17.0, 5.0, 5.0, 2.3, 0.1, 3.0, 10.0, 56.0),
    (22.0, 6.0, 6.0, 2.8, 0.1, 3.5, 14.0, 70.0),
    (30.0, 8.0, 7.0, 3.3, 0.2, 4.0, 18.0, 90.0),
    (38.0, 10.0, 8.0, 3.3, 0.2, 5.0, 22.0, 110.0),
    (44.0, 12.0, 8.0, 3.3, 0.2, 5.0, 28.0, 140.0),
    (50.0, 14.0, 9.0, 3.8, 0.0, 5.5, 36.0, 160.0),
    (58.0, 16.0, 10.0, 4.3, 0.0, 6.0, 45.0, 180.0),
    (65.0, 18.0, 11.0, 4.4, 0.0, 7.0, 50.0, 200.0),
    (75.0, 20.0, 12.0, 4.9, 0.0, 7.5, 56.0, 220.0),
    (85.0, 22.0, 14.0, 5.4, 0.0, 9.0, 63.0, 250.0),
    (95.0, 25.0, 14.0, 5.4, 0.0, 9.0, 70.0, 280.0),
    (110.0, 28.0, 16.0, 6.4, 0.0, 10.0, 80.0, 320.0),
    (130.0, 32.0, 18.0, 7.4, 0.0, 11.0, 90.0, 360.0),
    (150.0, 36.0, 20.0, 8.4, 0.0, 12.0, 100.0, 400.0),
    (170.0, 40.0, 22.0, 9.4, 0.0, 13.0, 100.0, 400.0),
    (200.0, 45.0, 25.0, 10.4, 0.0, 15.0, 110.0, 450.0),
    (230.0, 50.0, 28.0, 11.4, 0.0, 17.0, 125.0, 500.0),
)
# Lengths of keys, mm, up to 28, 63, 140 and beyond.
_LENGTHS = (
    *(6, 8, 10, 12, 14, 16, 18, 20, 22, 25, 28),
    *(32, 36, 40, 45, 50, 56, 63),
    *(70, 80, 90, 100, 110, 125, 140),
    *(160, 180, 200, 220, 250, 280, 320, 360, 400, 450, 500),
)
_LEAST_KEYED = 6.0  # mm
_DEEPER_FROM = 22.0  # mm, a thicker shaft's keyway may be 0.2 deeper in place of 0.1
KEY = "parallel key"  # in lists
ROUND_ENDED = "DIN 6885 form A"
RANGE = f"a bore of {_LEAST_KEYED:g} to {_KEYWAYS[-1][0]:g} mm, for which camgen has the keyway of DIN 6885"


def keyway(bore: float) -> tuple[float, float, float] | None:
    """Width and depth t2 of a hub's keyway, and by what it may be deeper, mm; None of a bore that has none in the table."""
    row = _row(bore)
    return None if row is None else (row[1], row[3], row[4])


def shaft_keyway(diameter: float) -> tuple[float, float]:
    """Depth t1 of the keyway in a shaft of a diameter in RANGE, and by what it may be deeper, mm."""
    row = _row(diameter)
    assert row is not None
    return row[5], 0.1 if diameter <= _DEEPER_FROM else 0.2


@dataclass(frozen=True)
class Keyed:
    """A round contour with a keyway: of a bore outwards, of a shaft inwards; mm."""

    centre: complex
    radius: float
    width: float
    depth: float  # from the circle's top to the keyway's floor, < 0 of a shaft's
    way: complex  # from the centre to the keyway, a unit


def keyed(contour: Contour) -> Keyed | None:
    """A circle with a keyway; None of any other contour."""
    arcs = [piece for piece in contour.pieces if isinstance(piece, Arc)]
    walls = [piece for piece in contour.pieces if isinstance(piece, Line)]
    if len(arcs) != 1 or len(walls) != 3 or len(contour.pieces) != 4:
        return None
    (arc,) = arcs
    if abs(arc.sweep) <= math.pi:
        return None
    # the floor is between two walls, which end on the arc
    after = contour.pieces[(contour.pieces.index(arc) + 2) % 4]
    ends = [end - arc.centre for end in (start_point(after), end_point(after))]
    middle = sum(ends) / 2
    way = middle / abs(middle)
    width = abs(ends[0] - ends[1])
    return Keyed(arc.centre, arc.radius, width, abs(middle) - arc.radius, way)


def parallel_keys(parts: Sequence[Part], through: bool) -> Iterator[Bought]:
    """The parallel keys in the keyways of parts' bores, those of one size together; through: one goes through all of them."""
    holders: dict[Bought, list[Part]] = {}
    with_keyways = [part for part in parts if any(map(keyed, part.region.holes))]
    whole = sum(part.thickness for part in with_keyways) if through else 0.0
    for part in with_keyways[:1] if through else with_keyways:
        for hole in part.region.holes:
            found = keyed(hole)
            if found is not None:
                long = whole or part.thickness
                key = parallel_key(2 * found.radius, found.width, found.depth, long, 0)
                holders.setdefault(key, []).append(part)
    for key, held in holders.items():
        at = tuple((part.name, 1) for part in held)
        yield replace(key, count=sum(part.count for part in held), at=at)


def parallel_key(bore: float, width: float, depth: float, length: float, count: int) -> Bought:
    """The keys for keyways of a width and a depth in hubs with this bore of a length, mm: the longest of the standard that are no
    longer than the bore, or the shortest one, to be shortened."""
    row = _row(bore)
    if row is None or abs(row[1] - width) > 1e-6 or abs(row[3] - depth) > 1e-6:
        most = f"at most {length:.4g} long, as its bore"
        size = f"{width:g} wide, for a keyway {depth:.4g} deep in the hub, {most}"
        return Bought(KEY, "", size, count)
    shortest = row[-2]
    long = key_length(bore, length)
    size = f"{width:g} x {row[2]:g} x {max(long, shortest):g}"
    cut = (
        ""
        if long >= shortest
        else f", shortened to {length:.4g}, as its bore: shorter ones are not sold"
    )
    return Bought(KEY, ROUND_ENDED, size + cut, count)


# By how much a key ends before a hub does at either end, by the length beyond which it does so, mm: camgen's own rule.
_BEFORE_RINGS = {30.0: 3.0, 20.0: 1.0}


def key_length(bore: float, length: float) -> float:
    """Of the longest key of the standard that is no longer than a hub with this bore, or as the hub where all are longer, or none
    is for the bore; mm. In a long hub the keyway of the shaft ends before the grooves of rings beside the hub."""
    row = _row(bore)
    length -= 2 * next((land for hub, land in _BEFORE_RINGS.items() if length > hub), 0.0)
    shortest, longest = (0.0, 0.0) if row is None else row[-2:]
    fitting = [each for each in _LENGTHS if shortest <= each <= min(longest, length + 1e-6)]
    return max(fitting, default=length)


def _row(bore: float) -> tuple[float, ...] | None:
    if bore < _LEAST_KEYED:
        return None
    return next((row for row in _KEYWAYS if bore <= row[0]), None)
