"""What the report says of gears and planetary sets: ratios, and planets that are not evenly spread."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator

from camgen.machine.model import GROUND
from camgen.parts.generator.gears import PlanetWish
from camgen.parts.generator.layout import Layout
from camgen.parts.wheels.planets import Member, seats, turns
from camgen.study import Figure

_EVEN = 1e-9  # rad, by which planets that are evenly spread may differ


def figures(layout: Layout) -> list[Figure]:
    """Contact ratio of each pair, of planets once; how often a set's sun turns for one turn of what it drives."""
    pairs = {(each.a.part, each.b.part): each for each in reversed(layout.gear_pairs)}
    found = [
        Figure("contact ratio {of}", each.mesh.contact_ratio, "", each.joint.name)
        for each in reversed(pairs.values())
    ]
    for wish in layout.planets:
        fixed, driven = _members(wish)
        found.append(Figure("ratio {of}", turns(wish.teeth, fixed, driven)["sun"], "", wish.level))
    return found


def _members(wish: PlanetWish) -> tuple[Member, Member]:
    """What is fixed, and what turns beside the sun."""
    return ("ring", "carrier") if wish.ring == GROUND else ("carrier", "ring")


def notes(layout: Layout) -> Iterator[str]:
    """Of each set how it turns, and where its planets are unless they are evenly spread."""
    for wish in layout.planets:
        fixed, driven = _members(wish)
        ratio = turns(wish.teeth, fixed, driven)["sun"]
        sun, planet, ring = wish.teeth
        way = "the same way" if ratio > 0 else "the other way"
        yield (
            f"Planetary set {wish.level}: sun {sun}, planets {planet}, ring {ring} teeth; the {fixed} is fixed, and the sun turns "
            f"{abs(ratio):.6g} times for one turn of the {driven}, {way}."
        )
        angles = seats(wish.teeth, len(wish.planets))
        steps = [b - a for a, b in itertools.pairwise([*angles, angles[0] + math.tau])]
        if max(steps) - min(steps) > _EVEN:
            places = ", ".join(f"{math.degrees(angle):.2f}" for angle in angles)
            yield f"Planets of {wish.level} are at {places} deg: the teeth do not let them be evenly spread."
