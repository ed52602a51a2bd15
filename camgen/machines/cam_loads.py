"""[load] and [spring] of a disc cam: what is wrong with them, and the forces that follow as figures and curves."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from camgen.errors import Fault
from camgen.findings import Finding, NotJudged, Where, at_most
from camgen.machine.cams.bounce import Bounce
from camgen.machine.cams.machine import FollowerLoad, Loaded
from camgen.machine.model import Machine
from camgen.machine.run import solve
from camgen.machines.loads.lift_off import spring_reserve, unsprung, with_hops
from camgen.numerics import peak
from camgen.parts import materials
from camgen.parts.springs import WIRES, wound
from camgen.study import Figure, Figures, Plot, Study

if TYPE_CHECKING:
    from camgen.machines.disc_cam.tables import LoadTable, SpringTable
    from camgen.motion.program import Program

_JUMPS = "its speed jumps, and no spring can hold it there: use a law that ends smoothly"


def load_faults(
    load: LoadTable | None,
    spring: SpringTable | None,
    slides: bool,
    pushed: bool,
    made: bool,
    sprung: str = 'closure "force"',
) -> list[Fault]:
    """What is wrong; slides: a translating follower; pushed: only a spring keeps it on its cam, as `sprung` says; made: it is a
    part."""
    found = []
    if spring is not None and not pushed:
        found.append(Fault(("spring",), "", f"no table here: only {sprung} has a spring"))
    if load is None:
        key = "mass_kg" if slides else "inertia_kg_m2"
        return (
            [*found, Fault(("load", key), "", "missing: what the spring of [spring] moves")]
            if spring is not None
            else found
        )
    needed, other = ("mass_kg", "inertia_kg_m2") if slides else ("inertia_kg_m2", "mass_kg")
    if getattr(load, other):
        kind = "a translating" if slides else "an oscillating"
        found.append(
            Fault(
                ("load", other),
                f"{getattr(load, other):g}",
                f"no value here: {kind} follower has {needed}",
            )
        )
    if load.gravity_deg is not None:
        what = (
            unweighed(load.gravity_deg, bool(load.inertia_kg_m2), made)
            if not slides
            else (
                None
                if load.mass_kg or made
                else Fault(
                    ("load", "mass_kg"),
                    "0",
                    "above 0: load.gravity_deg needs the mass that it pulls on",
                )
            )
        )
        found += [] if what is None else [what]
    return found


def polydyne_faults(
    load: LoadTable, spring: SpringTable | None, wanted: Program, sprung: bool
) -> list[Fault]:
    """What a correction for the follower's elasticity lacks; sprung: a machine with a return spring is made."""
    from camgen.motion.polydyne import NEEDED, rough

    found = []
    if load.stiffness is None:
        found.append(
            Fault(
                ("load", "stiffness"), "", "missing: load.polydyne needs the follower's stiffness"
            )
        )
    if sprung and not (spring and spring.rate):
        right = "above 0: load.polydyne needs the rate of the spring before camgen can make the cam"
        found.append(Fault(("spring", "rate"), "0", right))
    if not load.mass_kg and not load.inertia_kg_m2:
        found.append(
            Fault(
                ("load", "mass_kg"),
                "0",
                "above 0 (for an arm inertia_kg_m2): load.polydyne needs what moves behind the stiffness",
            )
        )
    return [
        *found,
        *(
            Fault(("segment", k, "law"), repr(wanted.segments[k].law.name), NEEDED)
            for k in rough(wanted.segments)
        ),
    ]


def unweighed(deg: float, inertia: bool, made: bool) -> Fault | None:
    """Why gravity does not count on an arm: it pulls on a mass at its centre, which an inertia about the pivot does not say.

    inertia: whether one is given; made: whether the arm is a part, whose solid has mass and centre.
    """
    if made and not inertia:
        return None
    why = (
        "weight needs the follower's mass and its centre, and inertia_kg_m2 gives neither"
        if inertia
        else (
            'camgen knows the follower\'s weight only if it makes the follower (parts.make = "printed")'
        )
    )
    return Fault(
        ("load", "gravity_deg"),
        f"{deg:g}",
        f"no value here: {why}; without this key the cam lies flat",
    )


def corrected(
    wanted: Program, load: LoadTable | None, spring: SpringTable | None, speed: float
) -> Program:
    """What a cam is made for: the wanted motion, with load.polydyne corrected for the follower's elasticity.

    speed: of the cam, rad/s.
    """
    if load is None or not load.polydyne:
        return wanted
    from camgen.motion.polydyne import polydyne

    return polydyne(wanted, load.lag(speed, spring.rate if spring else 0.0))


def load_of(load: LoadTable | None, spring: SpringTable | None) -> FollowerLoad | None:
    """Both tables as the model takes them; None without [load]."""
    if load is None:
        return None
    rate, preload = (spring.rate, spring.preload) if spring else (0.0, 0.0)
    return FollowerLoad(
        load.mass_kg + load.inertia_kg_m2, load.damping, rate, preload, load.resistance
    )


def lift_off(
    found: Loaded,
    load: FollowerLoad,
    slides: bool,
    bounce: Bounce | None,
    least: float,
    remedies: tuple[str, str] = (_JUMPS, "less mass, a lower speed or a longer span"),
) -> Finding:
    """LIFT_OFF, with the spring that would keep the follower on; bounce: what it does where it is not kept; least: share of that
    spring's force that SPRING_RESERVE asks for; remedies: what is said where
    its speed jumps, and what lowers that spring."""
    jumps, lower = remedies
    preload, rate = found.spring_needed(load, least)
    units = _spring_units(slides)
    stiffer = f" or a spring.rate above {rate:.4g} {units[1]}" if math.isfinite(rate) else ""
    reserved = ", with SPRING_RESERVE" if least else ""
    kept = f"a spring.preload above {preload:.4g} {units[0]}{stiffer} keeps it on{reserved}. A weaker spring is enough with {lower}"
    if slides and math.isfinite(preload):
        travel = float(np.ptp(found.lift))
        if travel > 0 and preload > 0 and wound(load.rate, preload, travel) is None:
            kept = f"only a spring.preload above {preload:.4g} N keeps it on, and no wire of up to {WIRES[-1]:g} mm bears that. A weaker spring is enough with {lower}"
    if not load.preload and not load.rate:
        kept = f"no spring presses it on, because spring.preload and spring.rate are 0; {kept}"
    return with_hops(found.keeps_contact(jumps if found.kick else kept), bounce, slides)


def reserve(found: Loaded, machine: Machine, least: float) -> list[Finding]:
    """SPRING_RESERVE of what presses the follower of a machine's cam "contact" on it; found: what its loads do; least: share of
    the springs' force."""
    cam = machine.cam("contact")
    loose = solve(unsprung(machine), found.theta).forces().contacts[cam.name]
    spring = found.effort - cam.leaves * loose
    return spring_reserve(found.theta, found.effort, spring, least, found.where, bool(cam.slide))


def kept_on(
    found: Loaded, load: FollowerLoad | None, machine: Machine, bounce: Bounce | None, least: float
) -> list[Finding]:
    """LIFT_OFF and SPRING_RESERVE of a follower that only a spring keeps on the cam "contact" of a machine, as `lift_off` has them."""
    slides = bool(machine.cam("contact").slide)
    kept = lift_off(found, load or FollowerLoad(), slides, bounce, least)
    return [kept, *reserve(found, machine, least)]


def line_hertz(
    pressure: float, length: float, material: str, given: float | None, where: Where
) -> Finding | NotJudged:
    """HERTZ of a steel roller on a line of a length, mm, or why no limit of the material judges it.

    pressure: MPa. given: limits.hertz_mpa. where: its thing is what the roller is on.
    """
    own = materials.of(material)
    limit = given or own.hertz
    if limit is None:
        why = f"{pressure:.4g} MPa in the {where.thing}, and no limit is published for {material}"
        return NotJudged("HERTZ", why, "limits.hertz_mpa")
    by = "limits.hertz_mpa" if given else own.hertz_source
    said = f"steel roller on {own.name}, contact line of {length:.4g} mm; {by}; the pressure is higher at the ends of the line"
    return at_most("HERTZ", pressure, limit, "MPa", where, said)


def force_study(
    found: Loaded, load: FollowerLoad, slides: bool, pushed: bool, weighs: bool
) -> Study:
    """Figures and curves of contact force, torque, power and reactions."""
    forces = found.forces
    notes = []
    power = forces.power_in
    greatest = peak(found.force)
    reactions = [*forces.reactions.items(), *forces.normals.items()]
    figures = [
        Figure("peak contact force", greatest, "N"),
        Figure("peak torque", peak(found.torque), "N m"),
        Figure("peak power", float(np.nanmax(power)), "W"),
        *(
            Figure("reaction {joint} without friction", peak(reaction), "N", joint=name)
            for name, reaction in reactions
        ),
    ]
    # of a round tip the force passes the tip, where the mass is: what is left is rounding
    figures += [
        Figure("peak moment {joint}", peak(moment), "N m", joint=name)
        for name, moment in forces.moments.items()
        if peak(moment) > 1e-9 * greatest
    ]
    if found.kick:
        figures.append(Figure("kick", found.kick, "N s" if slides else "N m s"))
        notes.append(
            "The follower's speed jumps, which gives it a kick. The curves of force and torque leave the kick out."
        )
    if pushed:
        figures += pushed_figures(found, load, slides)
    numbers = Figures(each for each in figures if math.isfinite(each.value))
    return Study(numbers, force_plots(found, "follower on cam"), (), (), _notes(weighs, notes))


def pushed_figures(found: Loaded, load: FollowerLoad, slides: bool) -> list[Figure]:
    """Of a follower that only a spring keeps on its cam: the least force, and the spring that it needs."""
    preload, rate = found.spring_needed(load)
    units = _spring_units(slides)
    return [
        Figure("least contact force", float(np.nanmin(found.force)), "N"),
        Figure("spring preload needed", preload, units[0]),
        Figure("spring rate needed", rate, units[1]),
    ]


def force_plots(found: Loaded, who: str) -> list[Plot]:
    """Contact force and torque over the turn; a kick, which has none, leaves a gap."""
    degrees, force, torque = (
        np.degrees(found.theta),
        *(np.where(np.isinf(y), np.nan, y) for y in (found.force, found.torque)),
    )
    label = "cam angle, deg"
    of_motor = "Torque on the motor, without friction in the joints"
    driven = Plot(of_motor, label, "N m", [("drives the cam", degrees, torque)])
    return [Plot("Contact force", label, "N", [(who, degrees, force)]), driven]


def _notes(weighs: bool, more: Sequence[str]) -> tuple[str, ...]:
    said = "with gravity, without" if weighs else "without gravity,"
    return (f"Forces: at constant speed of the cam, {said} friction, play and elasticity.", *more)


def _spring_units(slides: bool) -> tuple[str, str]:
    """Of a preload and a rate."""
    return ("N", "N/mm") if slides else ("N m", "N m/rad")
