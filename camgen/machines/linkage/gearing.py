"""What the report says of gears, planetary sets, cycloidal drives and wheels that are not round: ratios, pitch curves, planets."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator

import numpy as np

from camgen.machine.model import GROUND
from camgen.numerics import magnitude
from camgen.parts.generator.gears import PlanetWish
from camgen.parts.generator.layout import Layout
from camgen.parts.generator.mutilated import MutilatedDrive
from camgen.parts.generator.noncircular import NoncircularDrive
from camgen.parts.wheels.planets import Member, seats, turns
from camgen.study import Figure, Plot

_TURN = np.linspace(0, math.tau, 721)
_EVEN = 1e-9  # rad, by which planets that are evenly spread may differ


def figures(layout: Layout) -> list[Figure]:
    """Contact ratio of each pair, of planets once; turns of a set's fast member, or a disc's eccentric, for one of the slow; of mutilated gears by how much the wheel's speed jumps; of wheels that are
    not round their module, how fast the driven one is at most and at least, and how far a flank's normal leans at most."""
    pairs = {(each.a.part, each.b.part): each for each in reversed(layout.gear_pairs)}
    found = [
        Figure("contact ratio {of}", each.mesh.contact_ratio, "", each.joint.name)
        for each in reversed(pairs.values())
    ]
    for wish in layout.planets:
        found.append(Figure("ratio {of}", _ratio(wish), "", wish.level))
    for drive in layout.drives_of(NoncircularDrive):
        centrodes = drive.pair.centrodes
        speed = centrodes.law(_TURN, 1)
        leans = math.degrees(drive.pair.pressure + magnitude(centrodes.lean(_TURN)))
        of = drive.joint.name
        found += [
            Figure("module {of}", drive.pair.module, "mm", of),
            Figure("peak speed ratio {of}", float(speed.max()), "", of),
            Figure("least speed ratio {of}", float(speed.min()), "", of),
            Figure("greatest pressure angle {of}", leans, "deg", of),
        ]
    for mutilated in layout.drives_of(MutilatedDrive):
        begin, end = mutilated.law.pair.jumps
        of = mutilated.joint.name
        found += [
            Figure("speed step as it starts {of}", begin, "", of),
            Figure("speed step as it stops {of}", end, "", of),
        ]
    for asked in (drive.wish for drive in layout.cycloid_drives if not drive.wish.opposite):
        disc = asked.disc
        least, most = map(math.degrees, disc.play)
        found += [
            Figure("ratio {of}", 1 / disc.ratio, "", asked.joint),
            Figure("least play {of}", least, "deg", asked.joint),
            Figure("greatest play {of}", most, "deg", asked.joint),
            Figure("ripple {of}", math.degrees(disc.ripple), "deg", asked.joint),
        ]
    return found


def plots(layout: Layout) -> list[Plot]:
    """Pitch curves of wheels that are not round, as they touch on the line of both axes at theta = 0."""
    return [
        Plot(
            f"Pitch curves of {drive.joint.name}: one rolls on the other",
            "x, mm",
            "y, mm",
            [(link, curve.real, curve.imag) for link, curve in drive.curves(_TURN)],
            equal=True,
        )
        for drive in layout.drives_of(NoncircularDrive)
    ]


def _members(wish: PlanetWish) -> tuple[Member, Member, Member]:
    """What is fixed, what turns fast, and what turns slowly."""
    if wish.sun == GROUND:
        return "sun", "ring", "carrier"
    return ("ring", "sun", "carrier") if wish.ring == GROUND else ("carrier", "sun", "ring")


def _ratio(wish: PlanetWish) -> float:
    """Turns of what turns fast for one of what turns slowly."""
    fixed, fast, slow = _members(wish)
    return turns(wish.teeth, fixed, slow)[fast]


def notes(layout: Layout) -> Iterator[str]:
    """Of each set how it turns, and where its planets are unless they are evenly spread; of each cycloidal drive the same."""
    for drive in layout.cycloid_drives:
        asked = drive.wish
        disc = asked.disc
        if asked.opposite is not None:
            yield (
                f"{asked.link} runs in the same pins on an eccentric opposite to that of {asked.opposite.link}: their pulls on the "
                "shaft cancel. camgen judges each as if it carried the load alone."
            )
            continue
        least, most = map(math.degrees, disc.play)
        yield (
            f"Cycloidal drive {asked.joint}: {disc.pins} pins, {disc.lobes} lobes; {asked.crank} turns {disc.lobes} times for one "
            f"turn of {asked.output or asked.link}, the other way. The disc has a play of {least:.4g} to {most:.4g} deg."
        )
    for mutilated in layout.drives_of(MutilatedDrive):
        law = mutilated.law
        pair = law.pair
        links = mutilated.links
        sense = "counter-clockwise" if law.way > 0 else "clockwise"
        yield (
            f"Mutilated gears {mutilated.joint.name}: turn {links[0]} {sense} only. In each turn it turns {links[1]} by "
            f"{math.degrees(pair.pitch):.6g} deg while it turns by {math.degrees(2 * pair.half):.4g} deg itself, and holds {links[1]} for the rest. "
            f"As {links[1]} starts, its speed jumps to {pair.jumps[0]:.3g} times that of {links[0]}: turn slowly, or keep its mass small."
        )
    for wish in layout.planets:
        fixed, fast, slow = _members(wish)
        ratio = _ratio(wish)
        sun, planet, ring = wish.teeth
        way = "the same way" if ratio > 0 else "the other way"
        yield (
            f"Planetary set {wish.level}: sun {sun}, planets {planet}, ring {ring} teeth; the {fixed} is fixed, and the {fast} turns "
            f"{abs(ratio):.6g} times for one turn of the {slow}, {way}."
        )
        angles = seats(wish.teeth, len(wish.planets))
        steps = [b - a for a, b in itertools.pairwise([*angles, angles[0] + math.tau])]
        if max(steps) - min(steps) > _EVEN:
            places = ", ".join(f"{math.degrees(angle):.2f}" for angle in angles)
            yield f"Planets of {wish.level} are at {places} deg: the teeth do not allow even spacing."
