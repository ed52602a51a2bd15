"""[load] and [spring] of a disc cam: what is wrong with them, and the forces that follow as figures and curves."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from camgen.errors import Fault
from camgen.findings import Finding
from camgen.machine.cams.bounce import RESTITUTION, Bounce, Spring, hops, lift_off_speed, spring_of
from camgen.machine.cams.limits import swings
from camgen.machine.cams.machine import FollowerLoad, Loaded
from camgen.machine.model import MM
from camgen.numerics import Floats, peak
from camgen.study import Figure, Figures, Plot, Study

if TYPE_CHECKING:
    from camgen.machine.cams.followers import Follower
    from camgen.machine.cams.profile import DiscCam
    from camgen.machines.disc_cam.tables import LoadTable, SpringTable
    from camgen.motion.program import Program

_JUMPS = "its speed jumps, and no spring holds it then: use a law that ends smoothly"


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
        found.append(Fault(("spring",), "", f"nothing here: only {sprung} has a spring"))
    if load is None:
        return (
            [*found, Fault(("load",), "", "missing: the mass that [spring] has to move")]
            if spring is not None
            else found
        )
    needed, other = ("mass_kg", "inertia_kg_m2") if slides else ("inertia_kg_m2", "mass_kg")
    if getattr(load, other):
        kind = "translating" if slides else "oscillating"
        found.append(
            Fault(
                ("load", other),
                f"{getattr(load, other):g}",
                f"nothing here: a follower that is {kind} has {needed}",
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
                    ("load", "mass_kg"), "0", "above 0 with load.gravity_deg: the mass that weighs"
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
        found.append(Fault(("load", "stiffness"), "", "missing: load.polydyne corrects for it"))
    if sprung and not (spring and spring.rate):
        right = "above 0 with load.polydyne: it corrects for the spring of the machine, which is else found by the cam"
        found.append(Fault(("spring", "rate"), "0", right))
    if not load.mass_kg and not load.inertia_kg_m2:
        found.append(
            Fault(
                ("load", "mass_kg"),
                "0",
                "above 0 with load.polydyne (inertia_kg_m2 for an arm): the mass behind the stiffness",
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
        "the follower's inertia says nothing of its mass and its centre, on which weight pulls"
        if inertia
        else ('no follower is made whose weight is known (parts.make = "printed")')
    )
    return Fault(
        ("load", "gravity_deg"), f"{deg:g}", f"nothing here: {why}; left out, the cam lies flat"
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


def bounce(
    found: Loaded, load: FollowerLoad, cam: DiscCam[Follower], speed: float
) -> Bounce | None:
    """What a follower does that its spring does not hold; None where it is held, or where that cannot be said.

    speed: of the cam, rad/s, below 0 clockwise. Not said where the speed of the lift jumps, where the cam is undercut or the
    follower's mass pulls differently at each angle.
    """
    if found.kick or not np.nanmin(found.effort) < 0 or not np.all(np.isfinite(found.force)):
        return None
    leaves = cam.follower.leaves
    sense = math.copysign(1.0, speed)
    lowest = float(np.min(leaves * cam.program(found.theta)))

    def lift(angle: Floats, order: int) -> Floats:
        value = leaves * sense**order * cam.program(np.mod(sense * angle, math.tau), order)
        return np.asarray(value - lowest if order == 0 else value)

    unit = 1.0 if swings(cam) else MM
    given = Spring(unit * load.inertia, load.damping, load.rate, load.preload + load.resistance)
    theta = sense * found.theta
    spring = spring_of(lift, found.effort, theta, abs(speed), given)
    if spring is None:
        return None
    flights = hops(lift, spring, abs(speed))
    flown = [replace(hop, leaves=sense * hop.leaves, lands=sense * hop.lands) for hop in flights]
    return Bounce(lift_off_speed(lift, spring, theta), flown) if flown else None


def bounce_words(bounce: Bounce, slides: bool) -> str:
    """What a person reads of it beside LIFT_OFF."""
    hop = bounce.highest
    rpm = bounce.lift_off * 60 / math.tau
    lost = f"contact is lost from {rpm:.4g} rpm" if rpm else "nothing holds it at any speed"
    left = f"it leaves at {math.degrees(hop.leaves) % 360:.1f} deg"
    if not math.isfinite(hop.lands):
        return f"{lost}; {left} and does not come back"
    height = f"{hop.height:.3g} mm" if slides else f"{math.degrees(hop.height):.3g} deg"
    speed = f"{bounce.knock * MM:.3g} m/s" if slides else f"{bounce.knock:.3g} rad/s"
    lands = f"{math.degrees(hop.lands) % 360:.1f} deg"
    return f"{lost}; {left}, flies up to {height} off the cam, comes back at {lands} and hits it with up to {speed}"


def bounce_study(bounce: Bounce | None, slides: bool) -> Study:
    """Figures of a follower that leaves its cam."""
    if bounce is None:
        return Study()
    unit, scale = ("mm", 1.0) if slides else ("deg", math.degrees(1))
    figures = [
        Figure("lift off speed", bounce.lift_off * 60 / math.tau, "rpm"),
        Figure("hop", scale * bounce.highest.height, unit),
        Figure("knock", bounce.knock * (MM if slides else scale), "m/s" if slides else "deg/s"),
    ]
    note = (
        f"A follower that hits its cam is taken to spring back with {RESTITUTION:g} of the speed."
    )
    return Study(Figures(each for each in figures if math.isfinite(each.value)), notes=(note,))


def lift_off(
    found: Loaded,
    load: FollowerLoad,
    slides: bool,
    jumps: str = _JUMPS,
    lower: str = "less mass, speed or a longer span",
) -> Finding:
    """LIFT_OFF, with the spring that would keep the follower on; jumps: what is said where its speed does; lower: what lowers
    that spring."""
    preload, rate = found.spring_needed(load)
    units = _spring_units(slides)
    stiffer = f" or a spring.rate above {rate:.4g} {units[1]}" if math.isfinite(rate) else ""
    kept = f"a spring.preload above {preload:.4g} {units[0]}{stiffer} keeps it; {lower} lowers that"
    return found.keeps_contact(jumps if found.kick else kept)


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
            "The follower's speed jumps, which kicks it; the curves of force and torque leave the kick out."
        )
    if pushed:
        preload, rate = found.spring_needed(load)
        units = _spring_units(slides)
        figures += [
            Figure("least contact force", float(np.nanmin(found.force)), "N"),
            Figure("spring preload needed", preload, units[0]),
            Figure("spring rate needed", rate, units[1]),
        ]
    numbers = Figures(each for each in figures if math.isfinite(each.value))
    return Study(numbers, force_plots(found, "follower on cam"), (), (), _notes(weighs, notes))


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
    return (f"Forces: at an even speed of the cam, {said} friction, play and elasticity.", *more)


def _spring_units(slides: bool) -> tuple[str, str]:
    """Of a preload and a rate."""
    return ("N", "N/mm") if slides else ("N m", "N m/rad")
