"""All that a machine bears, from its one model: masses, forces, drive, contacts, bearings, pins."""

from __future__ import annotations

import math
import re
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
from camgen.machines.loads.pins import overstated
from camgen.machines.loads.rubbing import freed, rough
from camgen.machines.loads.tables import Drives
from camgen.machines.loads.weights import Weighed, weighed
from camgen.study import Study, Table, together

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
    found = weighed(model, assembly.solids, mechanism.load)
    machine = found.machine
    given = getattr(mechanism, "motor", None)
    motor = given if isinstance(given, Drives) else None
    held: list[Finding] = []
    left: list[NotJudged] = [*assembly.unjudged]
    seat = assembly.motor
    facts = assembly.follower
    if seat.reach is not None:
        told = drive.reach(motor, seat.frame, seat.reach)
        (held if isinstance(told, Finding) else left).append(told)  # type: ignore[arg-type]
    if not (math.isfinite(machine.speed) and machine.speed):
        why = "nothing says how fast the machine turns"
        lost = [
            NotJudged(code, why, "motor.speed_rpm") for code in ("DRIVE_TORQUE", "PV", "PIN_STRESS")
        ]
        return Assessment(held, Study(tables=[_masses(found)]), (*left, *lost))
    theta = np.linspace(*assembly.cycle.range, _MANY if len(machine.bodies) <= _BODIES else _FEW)
    journals = assembly.journals
    run = solve(rough(machine, journals, mechanism.load), theta)
    forces = run.forces()
    # friction may spare a pin, and may be less than its table says
    smooth = solve(machine, theta).forces()
    borne_by_pins = replace(
        forces,
        reactions=_worse(smooth.reactions, forces.reactions),
        normals=_worse(smooth.normals, forces.normals),
    )
    plain = bearing.plain_bearings(run, borne_by_pins, journals, assembly.limits_of, mechanism.load)
    touched = bearing.contacts(run, forces, assembly)
    turned, more = drive.driven(
        run, forces, motor, lambda: freed(machine, journals, mechanism.load, theta)
    )
    shaken = np.abs(forces.shaking)
    numbers = {"shaking_force_n": float(np.nanmax(shaken, initial=0.0))}
    numbers |= {
        f"reaction_{re.sub('[^a-z0-9]+', '_', name.lower())}_n": float(
            np.nanmax(np.abs(load), initial=0.0)
        )
        for name, load in forces.reactions.items()
    }
    numbers |= follower.balance(run, forces)
    swung = follower.elastic(run, mechanism.load)
    if facts.arm_stiffness:
        numbers["follower_arm_stiffness_n_m_per_rad"] = facts.arm_stiffness
    grip = drive.gripped(
        seat.hub, turned.numbers.get("drive_torque_n_m", 0.0), mechanism.material.name
    )
    posts = bearing.bent_posts(borne_by_pins, assembly.posts, assembly.limits_of, not machine.loads)
    paired = pairs.told(forces, machine, assembly.outlines, facts.arm_stiffness)
    left += paired.left
    if facts.wish is not None and not assembly.springs:
        from camgen.parts.springs import WIRES

        rate, least, _ = facts.wish
        why = f"no wire up to {WIRES[-1]:g} mm can be wound to pull {least:.4g} N and {rate:.4g} N/mm more without yielding"
        left.append(
            NotJudged(
                "SPRING_STRESS",
                why,
                "another spring.preload or spring.rate, or a spring of another kind",
            )
        )
    for borne in (
        plain,
        posts,
        touched,
        turned,
        grip,
        swung,
        follower.sprung(assembly.springs, machine.speed),
    ):
        held += borne.findings
        left += borne.left
        numbers |= borne.numbers
    asked = any(assembly.limits_of(joint.name).bearing_life is not None for joint in machine.joints)
    if asked and "BEARING_LIFE" not in {each.code for each in held} | {each.code for each in left}:
        left.append(
            NotJudged("BEARING_LIFE", "no ball bearing of the machine is loaded", "a ball bearing")
        )
    kept = {name: value for name, value in numbers.items() if math.isfinite(value)}
    plots = [*turned.plots, *touched.plots, *swung.plots]
    tables = [_masses(found), *plain.tables, *swung.tables]
    study = Study(kept, plots, tables, notes=[*paired.notes, *jumps(machine)])
    if assembly.balances:
        study = together(
            [
                study,
                counterweights.study(assembly, getattr(mechanism, "counterweight", None), machine),
            ]
        )
    return Assessment(held, study, (*left, *more), overstated([*plain.bent, *posts.bent]))


def _worse(smooth: Mapping[str, Loads], rough: Mapping[str, Loads]) -> dict[str, Loads]:
    """Of loads without and with friction, (n,) each by joint, the greater at each angle."""
    return {
        name: np.where(np.abs(smooth[name]) > np.abs(load), smooth[name], load)
        for name, load in rough.items()
    }


def _masses(found: Weighed) -> Table:
    """Mass, centre and inertia of each body, and where they come from."""
    rows = [
        (
            body.name,
            1e3 * body.mass,
            ", ".join(f"{round(x, 6) + 0.0:.4g}" for x in (body.centre.real, body.centre.imag)),
            body.inertia,
            found.sources[body.name],
        )
        for body in found.machine.moving
    ]
    return Table(
        "Masses",
        ("body", "mass, g", "centre in its frame, mm", "inertia about it, kg m^2", "from"),
        rows,
    )
