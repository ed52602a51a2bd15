"""Where the names of holes and of round things that stand on a part go in its drawing, and which of them need a leader."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from camgen.files.dimensions import Hole
from camgen.files.sheet import Text
from camgen.geometry.outlines import Contour, Points

HEIGHT = 2.5  # mm of paper
_HIGH = 2.8  # from an edge to the middle of a label beside it, mm of paper
_SHORT, _LONG = 2.0, 4.5  # half the width of a label of a letter or two, and from which on it is a word, mm of paper

Label = tuple[str, Hole]


def along(contours: Sequence[Contour]) -> Points:
    """Points along contours, close enough to place a label."""
    pieces = [piece for contour in contours for piece in contour.pieces]
    return np.concatenate([piece.at(np.linspace(piece.t0, piece.t1, 33)) for piece in pieces])


def placed(
    named: Sequence[Label], rims: Mapping[Hole, Contour], obstacles: Points, zero: complex, scale: float
) -> Iterator[tuple[str, Hole, complex, bool]]:
    """Each label with the place of its middle, mm of the part, and whether it needs a leader to be told from its neighbours'.

    rims: outlines of the holes; obstacles: points (n,) of what is drawn; zero: where the long axes cross; scale: mm of paper
    for a mm of the part.
    """
    for k, (label, hole) in enumerate(named):
        half = Text(0j, label, HEIGHT).room / 2
        place = _place(hole, half, obstacles, zero, scale)
        yield label, hole, place, not _beside_its_own(k, place, named, rims)
        letters = np.linspace(-half, half, 9) if half > _LONG else np.linspace(-_SHORT, _SHORT, 5)
        obstacles = np.append(obstacles, place + letters / scale)


def _place(hole: Hole, half: float, obstacles: Points, zero: complex, scale: float) -> complex:
    """Middle of a label, half so wide (mm of paper): in the hole if that is wide, else beside it where there is most room."""
    shift = (half - _SHORT) / scale if half > _LONG else 0.0  # of a word, to have its near end where a letter has its middle
    if hole.radius == 0:
        if not hole.half or (scale * hole.half.real > half + 0.5 and scale * hole.half.imag > HEIGHT):
            return hole.middle
        up, out = hole.half.imag + _HIGH / scale, hole.half.real + 1 / scale + half / scale
        places = hole.middle + np.array([1j * up, -1j * up, out, -out])
    else:
        away = hole.radius / 2 if scale * hole.radius > 8 and not shift else hole.radius + _HIGH / scale
        ring = np.exp(1j * np.radians([45, 135, 315, 225, 65, 115, 295, 245]))
        places = hole.middle + np.concatenate([(away + more / scale) * ring for more in (0, 2.5, 5)])
        if shift:
            over, beside = 1j * (hole.radius + _HIGH / scale), places + shift * np.sign((places - hole.middle).real)
            places = np.concatenate([[hole.middle + over, hole.middle - over], beside])
    letters = places[:, None] + (np.linspace(-half, half, 9) / scale if shift else np.zeros(1))
    off_axes = np.min(np.minimum(np.abs((letters - zero).real), np.abs((letters - zero).imag)), axis=1)
    room = np.minimum(np.min(np.abs(letters[:, :, None] - obstacles), axis=(1, 2)), off_axes)
    room = np.minimum(room, (1.5 if shift else 2.2) / scale)  # enough is enough
    return complex(places[np.argmax(np.round(room, 3))])


def _beside_its_own(k: int, place: complex, named: Sequence[Label], rims: Mapping[Hole, Contour]) -> bool:
    """Whether a label at that place is nearer to the k-th hole than to any other one: to its middle and to its edge."""
    edges = [float(np.min(np.abs(along([rims[hole]]) - place))) for _, hole in named]
    middles = [abs(hole.middle - place) for _, hole in named]
    return all(min(away[:k] + away[k + 1 :], default=math.inf) > away[k] for away in (edges, middles))
