"""[[planets]]: a sun, planets on a carrier and a ring, as the points, links and gears that they stand for.

member    sun, carrier or ring; the one that is fixed is the ground
seat      angle of a planet about the axis from that of the first one
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Iterable, Mapping, Sequence
from typing import cast

from camgen.errors import Fault, Key
from camgen.machine.model import GROUND
from camgen.machines.linkage import tables as t
from camgen.machines.linkage.cycloids import drawn_arm
from camgen.parts.gears import MOST_TEETH
from camgen.parts.generator.gears import PlanetWish
from camgen.parts.wheels.planets import Member, seats
from camgen.parts.wheels.planets import turns as wheel_turns
from camgen.spec import unknown
from camgen.tolerances import SAME_POINT

Points = Mapping[str, tuple[float, float]]
Links = Mapping[str, Sequence[str]]


def members(row: t.Planets) -> dict[str, str]:
    """The link that each member is."""
    named = {"sun": row.sun, "carrier": row.carrier, "ring": row.ring}
    return {key: GROUND if key == row.fixed else link or "" for key, link in named.items()}


def axis(row: t.Planets, links: Links) -> str | None:
    """The point of the ground about which all members turn; None without any."""
    shared = [set(links.get(link, ())) for link in members(row).values()]
    shared.append(set(links.get(GROUND, ())))
    return next((point for point in links.get(GROUND, ()) if all(point in s for s in shared)), None)


def expanded(
    rows: Sequence[t.Planets], points: Points, links: Links, lengths: Mapping[str, float]
) -> tuple[dict[str, tuple[float, float]], dict[str, tuple[str, ...]]]:
    """Points and links with those of all planets; a row with a fault is left out.

    Where a length is given from the axis to the first planet, that is drawn there.
    """
    all_points = dict(points)
    all_links = {name: tuple(held) for name, held in links.items()}
    for row in rows:
        centre = axis(row, links)
        unsound = any(faults(("planets",), row, points, links))
        if unsound or centre is None or not {centre, row.at} <= points.keys():
            continue
        origin, arm = drawn_arm(points, lengths, centre, row.at)
        for pin, seat in zip(row.pins, seats(row.all_teeth, row.count), strict=True):
            place = origin + arm * cmath.exp(1j * seat)
            all_points[pin] = (place.real, place.imag)
        carrier = members(row)["carrier"]
        all_links[carrier] = (*all_links[carrier], *row.pins[1:])
        all_links |= {link: (pin,) for link, pin in zip(row.links, row.pins, strict=True)}
    return all_points, all_links


def gears(row: t.Planets) -> list[t.Gear]:
    """Each planet's with the sun, and the first one's with the ring: those of the others say nothing new."""
    sun, planet, ring = row.all_teeth
    on = members(row)
    first = row.links[0]
    return [
        *(t.Gear(a=on["sun"], b=link, ratio=-sun / planet) for link in row.links),
        t.Gear(a=first, b=on["ring"], ratio=planet / ring),
    ]


def wish(row: t.Planets) -> PlanetWish:
    """What is asked of its parts."""
    on = members(row)
    return PlanetWish(
        row.joint,
        on["sun"],
        tuple(zip(row.links, row.pins, strict=True)),
        on["carrier"],
        on["ring"],
        row.all_teeth,
        tuple(gear.joint for gear in gears(row)),
    )


def turn_on(row: t.Planets, turns: dict[str, float]) -> None:
    """Enter the turns of all members for one of the driven link, where that of one is known."""
    on = members(row)
    known = next((key for key, link in on.items() if key != row.fixed and link in turns), None)
    if known is None:
        return
    for key, rate in wheel_turns(row.all_teeth, row.fixed, cast("Member", known)).items():
        if key in on and key != row.fixed:
            turns.setdefault(on[key], rate * turns[on[known]])


def faults(path: Key, row: t.Planets, points: Points, links: Links) -> Iterable[Fault]:
    """What is wrong with a row."""
    yield from _member_faults(path, row, links)
    on = members(row)
    if on["carrier"] in links and row.at not in links[on["carrier"]]:
        right = f"a point of {on['carrier']}: the first planet's pin"
        yield Fault((*path, "at"), repr(row.at), right)
    centre = axis(row, links)
    moving = [link for link in on.values() if link != GROUND]
    if centre is None and all(link in links for link in on.values()):
        right = f"a point of the ground that {' and '.join(moving)} share: they turn about it"
        yield Fault(path, ", ".join(moving), right)
    places = [complex(*points[name]) for name in (centre, row.at) if name in points and name]
    if len(places) > 1 and abs(places[0] - places[1]) < SAME_POINT:
        yield Fault((*path, "at"), repr(row.at), f"a point beside {centre}")
    for name in row.pins[1:]:
        if name in points:
            yield Fault(("points", name), "", "another name: a planet's pin already has this one")
    for name in row.links:
        if name in links:
            yield Fault(("links", name), "", "another name: a planet already has this one")
    yield from _seat_faults(path, row)


def _member_faults(path: Key, row: t.Planets, links: Links) -> Iterable[Fault]:
    """Of the links that sun, carrier and ring are."""
    given = {"sun": row.sun, "carrier": row.carrier, "ring": row.ring}
    for key, link in given.items():
        if key == row.fixed:
            if link is not None:
                yield Fault((*path, key), repr(link), f'nothing: fixed = "{key}" is the ground')
        elif link is None:
            yield Fault((*path, key), "", "missing: the link that it is")
        elif link not in links or link == GROUND:
            yield unknown((*path, key), link, [each for each in links if each != GROUND])
    moving = [link for link in given.values() if link is not None]
    if len(set(moving)) < len(moving):
        yield Fault(path, ", ".join(moving), "links that differ")


def _seat_faults(path: Key, row: t.Planets) -> Iterable[Fault]:
    """Planets that cannot be evenly spread."""
    sun, planet, ring = row.all_teeth
    whole = sun + ring
    if row.spacing == "nearest" or whole % row.count == 0:
        return
    apart = (sun + planet) / (
        planet + 2
    )  # neighbours' distance to that at which their tips meet, of two planets
    fit = [k for k in range(1, 13) if k == 1 or apart * math.sin(math.pi / k) > 1]
    counts = [str(k) for k in fit if whole % k == 0]
    period = row.count if row.count % 2 else row.count // 2
    fitting = sun + -(sun + planet) % period
    fitting -= period * (fitting > MOST_TEETH)
    right = (
        f"{' or '.join(counts)} with {sun} and {planet} teeth, because the count must divide the {whole} teeth of sun and ring; "
        f'or a sun of {fitting} teeth; or spacing = "nearest"'
    )
    yield Fault((*path, "count"), str(row.count), right)
