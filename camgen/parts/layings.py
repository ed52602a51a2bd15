"""Copies of parts in the order in which they come, those of one step together, and those of a sub-assembly."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from camgen.machine.features import PinEyes
from camgen.machine.model import GROUND
from camgen.parts.fixing import Fixing
from camgen.parts.mates import mates_between
from camgen.parts.standing import StandingCopy
from camgen.tolerances import SAME_POINT

_Key = tuple[float, int, int, str, int, bool, float]
# what comes last on a level, in this order; 0 of all else
_LOOSE, _STANDS, _ON_IT, _FROM_ABOVE = 1, 2, 3, 4


@dataclass(frozen=True)
class Laying:
    """Copies of one part that come in one step."""

    copies: Sequence[StandingCopy]
    z: float  # of their undersides, mm
    turned_over: bool
    cluster: Sequence[StandingCopy]  # the sub-assembly that they are of; empty where of none


def layings_of(
    copies: Sequence[StandingCopy], pairs: Sequence[object], fixing: Fixing
) -> list[Laying]:
    """All copies by steps, in their order; those of a sub-assembly one after the other."""
    eyes = [each for each in pairs if isinstance(each, PinEyes)]
    seats = {
        ring.part: {eye.part for each in eyes for eye in (each.a, each.b)}
        for each in eyes
        for ring in each.rings
    }
    place = {name: k for k, name in enumerate(dict.fromkeys(copy.part.name for copy in copies))}

    def height(copy: StandingCopy) -> float:
        mount = copy.mount
        holders = seats.get(copy.part.name, set())
        beside = [each.mount for each in copies if each.mount.body == mount.body]
        over = copy.part.thickness if mount.flipped else 0.0
        undersides = [each.z for each in beside if each.part in holders]
        return round(min([mount.z + over, *undersides]), 6) + 0.0

    levels = {copy.name: height(copy) for copy in copies}
    last = {copy.name: _last_under(copy, copies, levels) for copy in copies}
    levels |= {name: level for name, level in last.items() if level is not None}
    found: dict[_Key, list[StandingCopy]] = {}
    clusters: dict[_Key, list[StandingCopy]] = {}
    clustered = _clusters(copies, levels, fixing)
    rank = {name: _FROM_ABOVE for name, level in last.items() if level is not None}
    rank |= {
        copy.name: _LOOSE
        for cluster in clustered
        if _nothing_holds(cluster, copies, levels, fixing)
        for copy in cluster
    }
    for cluster in clustered:
        over = _first_on(cluster, copies, levels, fixing)
        if over is not None:
            levels |= {copy.name: levels[over.name] for copy in cluster}
            rank |= {copy.name: _STANDS for copy in cluster}
            rank[over.name] = _ON_IT
    for cluster in clustered:
        carrier = {copy.name for copy in cluster if _carries(copy, cluster, fixing)}
        cluster.sort(key=lambda copy: (copy.name not in carrier, place[copy.part.name]))
        alone = len(cluster) == 1
        names = list(dict.fromkeys(copy.part.name for copy in cluster))
        for copy in cluster:
            key = (
                levels[copy.name],
                rank.get(copy.name, 0),
                place[cluster[0].part.name],
                "" if alone else cluster[0].name,
                names.index(copy.part.name),
                copy.mount.flipped,
                round(copy.mount.z, 6) + 0.0,
            )
            found.setdefault(key, []).append(copy)
            clusters[key] = [] if alone else cluster
    return [
        Laying(found[key], found[key][0].mount.z, found[key][0].mount.flipped, clusters[key])
        for key in sorted(found)
    ]


def _last_under(
    pin: StandingCopy, copies: Sequence[StandingCopy], levels: Mapping[str, float]
) -> float | None:
    """The level, mm, of the last of what a pin from above, its head up, keeps in place: it comes next, so that nothing lies loose for
    longer; None of what keeps nothing."""
    if not pin.mount.flipped or pin.holes:
        return None
    through = [
        levels[copy.name]
        for copy in copies
        if copy.pose.standing == pin.pose.standing
        and any(hole.holds(each) for hole in copy.holes for each in pin.outlines)
    ]
    return max(through) if len(through) > 1 else None


def _first_on(
    cluster: Sequence[StandingCopy],
    copies: Sequence[StandingCopy],
    levels: Mapping[str, float],
    fixing: Fixing,
) -> StandingCopy | None:
    """The link that goes first on a pin which stands on its cap and which nothing holds as yet: the pin comes just before it, when all
    else of that level is on, for nothing may be moved while it stands. None of any other one."""
    pin = cluster[0]
    if pin.part.role != "pin" or pin.mount.flipped:
        return None
    meets = [
        (levels[copy.name], copy)
        for copy in copies
        if copy not in cluster and mates_between([copy], [pin], fixing)
    ]
    level, first = min(meets, key=lambda each: each[0], default=(0.0, None))
    free = first and all(mate.how == "free" for mate in mates_between([first], [pin], fixing))
    return first if free and level > levels[pin.name] + SAME_POINT else None


def _nothing_holds(
    cluster: Sequence[StandingCopy],
    copies: Sequence[StandingCopy],
    levels: Mapping[str, float],
    fixing: Fixing,
) -> bool:
    """Whether a link is laid down loose, with what is fixed on it: it comes when all else of its level has been tried."""
    links = [copy for copy in cluster if copy.part.points and copy.mount.body != GROUND]
    if not links or any(copy.part.name in fixing.driven for copy in links):
        return False
    level = levels[cluster[0].name] + SAME_POINT
    there = [copy for copy in copies if copy not in cluster and levels[copy.name] < level]
    return not mates_between(cluster, there, fixing)


def _clusters(
    copies: Sequence[StandingCopy], levels: Mapping[str, float], fixing: Fixing
) -> list[list[StandingCopy]]:
    """Copies of one body that begin at one height, as drawn, and are fixed on each other; all others each by itself."""
    clusters: list[list[StandingCopy]] = []
    for copy in copies:
        joined = [copy]
        rest = []
        for cluster in clusters:
            first = cluster[0]
            beside = (
                first.mount.body == copy.mount.body
                and levels[first.name] == levels[copy.name]
                and not (first.mount.flipped or copy.mount.flipped)
            )
            fixed = beside and any(
                mate.how != "free" for mate in mates_between([copy], cluster, fixing)
            )
            if fixed:
                joined = [*cluster, *joined]
            else:
                rest.append(cluster)
        clusters = [*rest, joined]
    return clusters


def _carries(copy: StandingCopy, cluster: Sequence[StandingCopy], fixing: Fixing) -> bool:
    """Whether all others of a sub-assembly, of which there are several, are fixed on one of it."""
    others = [each for each in cluster if each is not copy]
    return len(others) > 1 and all(
        any(mate.how != "free" for mate in mates_between([each], [copy], fixing)) for each in others
    )
