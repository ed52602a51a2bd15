"""An interrupted shaft: webs on levels of their own, joined by the crank pins, so that rods sweep over the axis between them.

throw    a point of the driven link on which other links turn; throws follow each other in the order of the link's points
web      the first from the shaft to the first throw, then each from throw to throw; with a second plate the last one leads
         back to the axis, where a shaft of its own turns in that plate
pin      round where rods turn on it, with a flat at both ends: pressed into the webs, it keeps them at their angles
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import pairwise

from camgen.errors import Fault
from camgen.geometry.outlines import Contour, Region, circle
from camgen.machine import model as m
from camgen.parts.catalogue import TURNED
from camgen.parts.generator.sizes import Parts
from camgen.parts.part import Layer, Part, SizeNote, d_bore
from camgen.tolerances import SAME_POINT


def web_name(link: str, k: int) -> str:
    """Name of the k-th web, 0 the first."""
    return link if k == 0 else f"{link}_web{k + 1}"


def throws(links: Mapping[str, Sequence[str]], link: str, pins: Sequence[str]) -> list[str]:
    """Points of a link on which others turn, in its order; pins: those that run in a slot."""
    others = {point for name, points in links.items() if name != link for point in points}.union(
        pins
    )
    return [point for point in links[link] if point in others and point not in links[m.GROUND]]


def webs(
    link: str, shaft: str, throw_points: Sequence[str], back: bool
) -> dict[str, tuple[str, ...]]:
    """Points of each web by its name, from below; back: whether the last leads back to the axis. Nothing without a throw."""
    chain = [shaft, *throw_points, *([shaft] if back else [])] if throw_points else []
    return {web_name(link, k): both for k, both in enumerate(pairwise(chain))}


def further(
    links: Mapping[str, Sequence[str]], link: str, pins: Sequence[str], sizes: Parts
) -> list[str]:
    """Names of the webs after the first, of a shaft that is interrupted; nothing of one that goes through."""
    if sizes.shaft == "through" or link not in links or m.GROUND not in links:
        return []
    return [web_name(link, k) for k in range(1, len(throws(links, link, pins)) + sizes.plates - 1)]


def with_webs(
    bodies: Sequence[m.Body], link: str, webs: Mapping[str, tuple[str, ...]]
) -> list[m.Body]:
    """The bodies with the webs in place of the link; points that no web joins are on the first."""
    joined = {point for points in webs.values() for point in points}
    parts: list[m.Body] = []
    for body in bodies:
        if body.name != link or not webs:
            parts.append(body)
            continue
        free = body.points.keys() - joined
        for name, points in webs.items():
            own = {point: z for point, z in body.points.items() if point in free.union(points)}
            parts.append(replace(body, name=name, points=own))
            free = set()
    return parts


def faults(
    links: Mapping[str, Sequence[str]],
    points: Mapping[str, tuple[float, float]],
    link: str,
    pins: Sequence[str],
) -> list[Fault]:
    """Why a link's shaft cannot be interrupted."""
    throw_points = throws(links, link, pins)
    key = ("parts", "shaft")
    if not throw_points:
        right = f'"through": no other link turns on a point of {link}, which drives'
        return [Fault(key, "interrupted", right)]
    right = f"another name: a web of the interrupted shaft of {link} already has this one"
    names = [web_name(link, k) for k in range(1, len(throw_points) + 1)]
    faults = [Fault(("links", name), "", right) for name in names if name in links]
    for a, b in pairwise(throw_points):
        if a in points and b in points and points[a] == points[b]:
            right = f"throws that follow each other apart: {a} and {b} lie at one place"
            faults.append(Fault(key, "interrupted", right))
    return faults


def _filed_alike(flat: float, reach: float) -> str:
    """How a vice sets both flats of a crank pin in one plane, and what an error does at the far end of the next web; mm."""
    aside = reach * math.radians(1)
    return (
        f"Clamp each crank pin along the vice, {flat:.2g} mm of it over the jaws, and file either end across, down to the jaws. Keep off "
        "the middle: rods turn there. So both flats are filed in one clamping, and lie in one plane: 1 deg between them would put the "
        f"next web {aside:.1f} mm aside at its other end"
    )


def keyed_pin(
    diameter: float,
    lengths: tuple[float, float, float],
    flat: float,
    head: tuple[float, float],
    made: str,
    reach: float = 0.0,
) -> Part:
    """A crank pin from its lower end up, mm: a flat as long as its web, round between them, a flat.

    lengths: of its lower end, between both, of its upper one; where that is 0 a head (radius, height) lies over what turns on it.
    reach: of the web on its upper end, to its other axis.
    """
    keyed: Contour = d_bore(diameter, flat)
    low, between, high = lengths
    radius, height = head
    top = low + between
    long = f"{low:.3g} long at either end"
    if abs(low - high) > SAME_POINT:
        long = f"{low:.3g} long at its lower end and {high:.3g} at its upper one"
    stock = f"rod {diameter:g} h9"
    sized = SizeNote(
        f"{stock} x {top + high:g}, a flat {flat:.3g} deep and {long}, both on the same side",
        stock,
        top + high,
        _filed_alike(flat, reach),
    )
    if not high:
        sized = SizeNote(
            f"rod {diameter:g} h9 x {top:g} under a head {2 * radius:g} x {height:g}, "
            f"a flat {flat:.3g} deep and {low:.3g} long at its lower end"
        )
    end = Layer(Region(keyed), top, top + high)
    if not high:
        end = Layer(Region(circle(0j, radius)), top, top + height)
    round_ = Layer(Region(circle(0j, diameter / 2)), low, top)
    return Part(
        "crank-pin",
        "Crank pin",
        (Layer(Region(keyed), 0.0, low), round_, end),
        centres=(0j,),
        notes=(
            *((sized,) if made == TURNED else ()),
            "its flats turn the webs: glued in",
        ),
        drawn_layer=1,
        process=made,
        role="crank-pin",
    )
