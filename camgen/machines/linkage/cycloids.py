"""[[cycloid]] with two discs: the second one's eccentric and link, as a point and a link like any other."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

from camgen.errors import Fault, Key
from camgen.machine.model import GROUND
from camgen.machines.linkage import tables as t
from camgen.tolerances import SAME_POINT

Points = Mapping[str, tuple[float, float]]
Links = Mapping[str, Sequence[str]]


def drawn_arm(
    points: Points, lengths: Mapping[str, float], centre: str, point: str
) -> tuple[complex, complex]:
    """A centre, and the way from there to a point: as long as a length between both says, where one is given; mm."""
    origin = complex(*points[centre])
    arm = complex(*points[point]) - origin
    given = (lengths.get(f"{a}-{b}") for a, b in ((centre, point), (point, centre)))
    length = next((each for each in given if each is not None), abs(arm))
    return origin, arm * (length / abs(arm))


def expanded(
    rows: Sequence[t.Cycloid], points: Points, links: Links, lengths: Mapping[str, float]
) -> tuple[dict[str, tuple[float, float]], dict[str, tuple[str, ...]]]:
    """Points and links with those of second discs, opposite the first ones; a row with a fault is left out.

    Where a length is given from the shaft to the first eccentric, both are drawn there.
    """
    all_points = dict(points)
    all_links = {name: tuple(held) for name, held in links.items()}
    for row in rows:
        twin = row.twin
        shaft = next((p for p in links.get(row.crank, ()) if p in links.get(GROUND, ())), None)
        if twin is None or shaft is None or not {shaft, row.at} <= points.keys():
            continue
        if abs(complex(*points[row.at]) - complex(*points[shaft])) < SAME_POINT:
            continue
        origin, arm = drawn_arm(points, lengths, shaft, row.at)
        all_points[row.at] = ((origin + arm).real, (origin + arm).imag)
        opposite = origin - arm
        all_points.setdefault(twin.at, (opposite.real, opposite.imag))
        all_links[row.crank] = (*all_links[row.crank], twin.at)
        all_links.setdefault(twin.disc, (twin.at,))
    return all_points, all_links


def faults(
    path: Key, row: t.Cycloid, rows: Sequence[t.Cycloid], points: Points, links: Links
) -> Iterable[Fault]:
    """What is wrong with its second disc, or beside another one's; points, links: those that are given."""
    if any(other is not row and other.crank == row.crank for other in rows):
        right = "a crank of its own; a second disc in the same pins is discs = 2 of one [[cycloid]]"
        yield Fault((*path, "crank"), repr(row.crank), right)
    if row.twin is None:
        return
    for kind, name, held in (("points", row.twin.at, points), ("links", row.twin.disc, links)):
        if name in held:
            right = (
                f"another name: the second disc of {'.'.join(map(str, path))} already has this one"
            )
            yield Fault((kind, name), "", right)
