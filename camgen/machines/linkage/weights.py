"""The counterweight of a linkage's driven link: pressed on its shaft, on a level of its own or under the plate.

What it is to weigh follows from all other parts, and these from its level: the machine is laid out without it first, then with
room for it, until its radius stays.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator
from dataclasses import replace

from camgen.errors import Fault
from camgen.machine.model import Machine
from camgen.machine.run import Run
from camgen.machines.linkage.tables import OneDrive
from camgen.machines.loads.counterweights import Counterweight, ShaftSeat, first_moment
from camgen.parts.counterweights import NAME
from camgen.parts.generator.bodies import Bodies
from camgen.parts.generator.joints import pivot_of
from camgen.parts.generator.layout import Layout
from camgen.parts.generator.sizes import Parts
from camgen.parts.generator.stacking import with_levels
from camgen.parts.generator.wheels import Wheel

# of layouts; mm, change of the radius that is none
_PASSES = 6
_SAME = 1e-9
_ROOM = 0.5  # mm, about it where levels are looked for: what hangs on a level may change it by less


def weight_faults(
    spec: Counterweight, drive: OneDrive, masses: Collection[str], levels: Collection[str]
) -> list[Fault]:
    """What does not go with the other tables; masses: links whose mass is given; levels: names of all else that has one."""
    faults = spec.faults()
    if drive.link in masses:
        right = "no table here beside [counterweight], which camgen sizes for the solids that turn with this link"
        faults.append(Fault(("masses", drive.link), "", right))
    if NAME in levels:
        faults.append(Fault(("links", NAME), "", "another name: that of the counterweight's level"))
    if spec.given is None and (drive.range_deg is not None or drive.segments):
        right = "moment_g_mm and at_deg too: this drive does not turn evenly, so none is the best"
        faults.append(Fault(("counterweight",), "", right))
    return faults


def under_faults(spec: Counterweight, sizes: Parts) -> Iterator[Fault]:
    """What does not go with a counterweight under the plate."""
    least = (spec.thickness or sizes.thickness) + 2
    if sizes.face is not None:
        yield Fault(("layers", NAME), "0", "1 or more: the motor is under the plate")
    elif sizes.shaft_length < least:
        right = f"at least {least:g} mm: the counterweight under the plate, and its play"
        yield Fault(("parts", "shaft_length"), f"{sizes.shaft_length:g}", right)


def counterbalanced(
    spec: Counterweight,
    layout: Layout,
    run: Run,
    density: float,
    weighed: Callable[[Bodies], Machine],
) -> tuple[Bodies, complex]:
    """The bodies with the counterweight, and the moment of all that turns with the driven link, complex g mm in its axes.

    run: samples over the whole motion; density: of what is printed, kg/m^3; weighed: the machine of some bodies with all masses.
    """
    link = layout.driven
    under = layout.given.get(NAME) == 0
    bodies = Bodies(with_levels(layout, run), under=0.0 if under else None)
    radius = 0.0
    for _ in range(_PASSES):
        pivot = pivot_of(bodies.layout, link)
        given = spec.given
        whole = spec.best(weighed(bodies), link, pivot) if given is None else given
        at = bodies.layout.at(link, bodies.layout.shaft_of(link))
        own = first_moment(link, at, bodies.solids(density))
        seat = ShaftSeat(
            bodies.collar_radius,
            bodies.bore,
            layout.sizes.thickness,
            layout.min_wall,
            layout.fits,
            f"{layout.on_shaft} on the shaft of {link}",
        )
        part, pins, reach = spec.fitted(whole - spec.other, own, seat, density)
        if under:  # no level depends on it
            return Bodies(bodies.layout, (part, pins), reach), whole
        placed = bodies.layout.weights
        if placed and abs(reach - radius) <= _SAME:
            break
        radius = reach
        levels = bodies.layout.given if placed else layout.given
        wheel = Wheel(NAME, link, radius + _ROOM, NAME, part.thickness)
        bodies = Bodies(with_levels(replace(layout, weights=(wheel,), given=levels), run))
    return Bodies(bodies.layout, (part, pins)), whole
