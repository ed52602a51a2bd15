"""All that a machine bears, from its one model: masses, forces, drive, contacts, bearings, pins."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np

from camgen.findings import Finding, NotJudged
from camgen.machine.model import Machine
from camgen.machine.run import solve
from camgen.machines import pairs
from camgen.machines.loads import bearing, counterweights, drive, follower
from camgen.machines.loads.applied import jumps
from camgen.machines.loads.bearing import LoadCheck
from camgen.machines.loads.pins import overstated
from camgen.machines.loads.rubbing import locking_friction, with_friction
from camgen.machines.loads.running import running
from camgen.machines.loads.tables import Drives
from camgen.machines.loads.weights import Masses, with_masses
from camgen.numerics import peak
from camgen.study import Figure, Figures, Study, Table, together

if TYPE_CHECKING:
    from camgen.machines.mechanism import Mechanism

Loads = TypeVar("Loads", bound=Any)
# angles of a machine with more, or at most so many bodies
_FEW = 361
_MANY = 1441
_BODIES = 9


@dataclass(frozen=True)
class Assessment:
    """Findings, figures, what could not be judged, and what a person should know first."""

    findings: Sequence[Finding] = ()
    study: Study = field(default_factory=Study)
    not_judged: Sequence[NotJudged] = ()
    warnings: Sequence[str] = ()


def assess(mechanism: Mechanism, model: Machine | None = None) -> Assessment:
    """The machine at its speed, loaded by the masses of its solids, its springs, gravity where it is asked for.

    model: of a copy that is made a little otherwise, of the same parts.
    """
    model = mechanism.model if model is None else model
    if not model.drives:
        return Assessment()
    assembly = mechanism.assembly
    load = mechanism.load
    masses = with_masses(model, assembly.solids, load)
    machine = masses.machine
    motor = getattr(mechanism, "motor", None)
    motor = motor if isinstance(motor, Drives) else None
    reach = drive.reach(motor, assembly.motor)
    if not (math.isfinite(machine.speed) and machine.speed):
        why = "nothing says how fast the machine turns"
        asked = drive.motor_of(motor, assembly.motor.crank) is not None
        codes = (*(("DRIVE_TORQUE",) if asked else ()), "PV", "PIN_STRESS")
        speedless = [NotJudged(code, why, "motor.speed_rpm") for code in codes]
        study = Study(tables=[_mass_table(masses)])
        left_out = (*assembly.unjudged, *reach.not_judged, *speedless)
        return Assessment(reach.findings, study, left_out)
    theta = np.linspace(*assembly.cycle.range, _MANY if len(machine.bodies) <= _BODIES else _FEW)
    journals = assembly.journals
    run = solve(with_friction(machine, journals, load, mechanism.material.name), theta)
    forces = run.forces()
    # friction may spare a pin, and may be less than its table says
    smooth = solve(machine, theta).forces()
    on_edges = bearing.edge_forces(run, forces, assembly)
    on_pins = replace(
        forces,
        reactions=_worse(smooth.reactions, forces.reactions),
        normals=_worse(smooth.normals, forces.normals),
        pressing={**forces.pressing, **on_edges},
    )
    pins = bearing.plain_bearings(run, on_pins, journals, assembly.limits_of, load)
    posts = bearing.bent_posts(on_pins, assembly.posts, assembly.limits_of, not machine.loads)
    cams = bearing.contacts(run, forces, assembly, load)
    gears = bearing.gears(run, forces, assembly)
    edges = bearing.edges(run, on_edges, assembly)
    lives = {each.code for check in (pins, cams) for each in check.findings}
    lives |= {each.code for check in (pins, cams) for each in check.not_judged}
    asked = any(assembly.limits_of(joint.name).bearing_life is not None for joint in machine.joints)
    if asked and "BEARING_LIFE" not in lives:
        why = "no ball bearing of the machine is loaded"
        cams.not_judged.append(NotJudged("BEARING_LIFE", why, "a ball bearing"))
    torque = drive.torque(
        run,
        forces,
        motor,
        assembly.cycle.label,
        assembly.motor.crank,
        lambda: locking_friction(machine, journals, load, mechanism.material.name, theta),
    )
    runs = running(
        run, motor, assembly.material_limits.drive, assembly.cycle.name, assembly.motor.crank
    )
    hub = drive.hub_slip(
        assembly.motor.hub,
        Figures(torque.figures).get("drive_torque_n_m", 0.0),
        mechanism.material.name,
    )
    elastic = follower.elastic(run, load, assembly.limits_of)
    rates = follower.motion_limits(run, assembly.limits_of)
    springs = follower.springs(assembly.springs, machine.speed)
    facts = assembly.follower
    notes, not_judged = pairs.remarks(forces, machine, assembly.outlines, facts.arm_stiffness)
    if facts.wish is not None and not assembly.springs:
        from camgen.parts.springs import WIRES

        rate, least, _ = facts.wish
        why = f"no wire up to {WIRES[-1]:g} mm can be wound to pull {least:.4g} N and {rate:.4g} N/mm more without yielding"
        needs = "another spring.preload or spring.rate, or a spring of another kind"
        not_judged.append(NotJudged("SPRING_STRESS", why, needs))
    tips = LoadCheck(not_judged=not_judged)
    checks = (
        reach,
        tips,
        pins,
        posts,
        cams,
        gears,
        edges,
        torque,
        runs,
        hub,
        elastic,
        rates,
        springs,
    )
    figures = [Figure("shaking force", peak(forces.shaking), "N")]
    for name, reaction in forces.reactions.items():
        figures.append(Figure("reaction {joint}", peak(reaction), "N", joint=name))
    figures += follower.balance(run, forces)
    if facts.arm_stiffness:
        figures.append(Figure("follower arm stiffness", facts.arm_stiffness, "N m/rad"))
    for check in checks:
        figures += check.figures
    study = Study(
        Figures(each for each in figures if math.isfinite(each.value)),
        [*torque.plots, *runs.plots, *cams.plots, *elastic.plots],
        [_mass_table(masses), *pins.tables, *elastic.tables],
        notes=[*notes, *gears.notes, *runs.notes, *jumps(machine)],
    )
    if assembly.balances:
        counterweight = getattr(mechanism, "counterweight", None)
        study = together([study, counterweights.study(assembly, counterweight, machine)])
    return Assessment(
        [finding for check in checks for finding in check.findings],
        study,
        [*assembly.unjudged, *(each for check in checks for each in check.not_judged)],
        overstated([*pins.pins, *posts.pins]),
    )


def _worse(smooth: Mapping[str, Loads], rough: Mapping[str, Loads]) -> dict[str, Loads]:
    """Of loads without and with friction, (n,) each by joint, the greater at each angle."""
    return {
        name: np.where(np.abs(smooth[name]) > np.abs(load), smooth[name], load)
        for name, load in rough.items()
    }


def _mass_table(masses: Masses) -> Table:
    """Mass, centre and inertia of each body, and where they come from."""
    rows = []
    for body in masses.machine.moving:
        centre = (round(x, 6) + 0.0 for x in (body.centre.real, body.centre.imag))
        place = ", ".join(f"{x:.4g}" for x in centre)
        rows.append((body.name, 1e3 * body.mass, place, body.inertia, masses.sources[body.name]))
    heads = ("body", "mass, g", "centre in its frame, mm", "inertia about it, kg m^2", "from")
    return Table("Masses", heads, rows)
