"""All that a machine bears, from its one model: masses, forces, drive, contacts, bearings, pins."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np

from camgen.findings import Finding, NotJudged
from camgen.machine.forces import Forces
from camgen.machine.model import Machine
from camgen.machine.run import Run, solve
from camgen.machines import pairs
from camgen.machines.loads import bearing, counterweights, drive, follower
from camgen.machines.loads.applied import jumps
from camgen.machines.loads.bearing import LoadCheck
from camgen.machines.loads.pins import overstated
from camgen.machines.loads.rubbing import locking_friction, with_friction
from camgen.machines.loads.running import running
from camgen.machines.loads.tables import Drives
from camgen.machines.loads.weights import Masses
from camgen.numerics import Floats, peak
from camgen.parts import materials
from camgen.parts.assembly import Assembly
from camgen.parts.springs import WIRES
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
    masses = mechanism.weighed(model)
    motor = getattr(mechanism, "motor", None)
    motor = motor if isinstance(motor, Drives) else None
    reach = drive.reach(motor, assembly.motor)
    speed = masses.machine.speed
    if not (math.isfinite(speed) and speed):
        study = Study(tables=[_mass_table(masses)])
        left_out = (*assembly.unjudged, *reach.not_judged, *_speedless(motor, assembly))
        return Assessment(reach.findings, study, left_out)
    at_work = _AtWork(mechanism, masses, motor)
    checks = [reach, *at_work.checks()]
    return Assessment(
        [finding for check in checks for finding in check.findings],
        at_work.study(checks),
        [*assembly.unjudged, *(each for check in checks for each in check.not_judged)],
        [
            *overstated([pin for check in checks for pin in check.pins]),
            *(warning for check in checks for warning in check.warnings),
        ],
    )


def _speedless(motor: Drives | None, assembly: Assembly) -> list[NotJudged]:
    """What stays open of a machine of which nothing says how fast it turns."""
    asked = drive.motor_of(motor, assembly.motor.crank) is not None
    codes = (*(("DRIVE_TORQUE",) if asked else ()), "PV", "PIN_STRESS")
    why = "the spec does not say how fast the machine turns"
    return [NotJudged(code, why, "motor.speed_rpm") for code in codes]


@dataclass(frozen=True)
class _AtWork:
    """A machine with masses that turns at its speed, and what its joints, contacts, drive and springs bear."""

    mechanism: Mechanism
    masses: Masses
    motor: Drives | None

    @property
    def assembly(self) -> Assembly:
        return self.mechanism.assembly

    @property
    def machine(self) -> Machine:
        return self.masses.machine

    @cached_property
    def theta(self) -> Floats:
        """rad, over one cycle."""
        count = _MANY if len(self.machine.bodies) <= _BODIES else _FEW
        return np.linspace(*self.assembly.cycle.range, count)

    @cached_property
    def run(self) -> Run:
        """With friction in its joints."""
        own = self.mechanism.material.name
        rough = with_friction(self.machine, self.assembly.journals, self.mechanism.load, own)
        return solve(rough, self.theta)

    @cached_property
    def forces(self) -> Forces:
        return self.run.forces()

    @cached_property
    def remarks(self) -> tuple[list[str], list[NotJudged]]:
        """Of pairs that pass each other: notes, and what is not judged."""
        stiffness = self.assembly.follower.arm_stiffness
        return pairs.remarks(self.forces, self.machine, self.assembly.outlines, stiffness)

    def checks(self) -> list[LoadCheck]:
        """All that is judged of it, in the order in which a person reads it."""
        run = self.run
        load = self.mechanism.load
        limits_of = self.assembly.limits_of
        on_edges = bearing.edge_forces(run, self.forces, self.assembly)
        on_pins = self._on_pins(on_edges)
        posts = self.assembly.posts
        bearings = [
            bearing.plain_bearings(run, on_pins, self.assembly.journals, limits_of, load),
            bearing.bent_posts(on_pins, posts, limits_of, not self.machine.loads),
            bearing.contacts(run, self.forces, self.assembly, load),
            bearing.gears(run, self.forces, self.assembly),
            bearing.edges(run, on_edges, self.assembly),
        ]
        return [
            LoadCheck(not_judged=[*self.remarks[1], *self._unwound()]),
            *bearings,
            LoadCheck(not_judged=self._lifeless(bearings)),
            *self._driven(),
            follower.elastic(run, load, limits_of),
            follower.motion_limits(run, limits_of),
            follower.springs(
                self.assembly.springs,
                self.machine.speed,
                materials.of(self.mechanism.material.name).metal,
            ),
        ]

    def study(self, checks: Sequence[LoadCheck]) -> Study:
        """Figures, plots, tables and notes of it and its checks."""
        figures = [Figure("shaking force", peak(self.forces.shaking), "N")]
        for name, reaction in self.forces.reactions.items():
            figures.append(Figure("reaction {joint}", peak(reaction), "N", joint=name))
        figures += follower.balance(self.run, self.forces)
        stiffness = self.assembly.follower.arm_stiffness
        if stiffness:
            figures.append(Figure("follower arm stiffness", stiffness, "N m/rad"))
        figures += [figure for check in checks for figure in check.figures]
        study = Study(
            Figures(each for each in figures if math.isfinite(each.value)),
            [plot for check in checks for plot in check.plots],
            [_mass_table(self.masses), *(table for check in checks for table in check.tables)],
            notes=[
                *self.remarks[0],
                *(note for check in checks for note in check.notes),
                *jumps(self.machine),
            ],
        )
        if self.assembly.balances:
            counterweight = getattr(self.mechanism, "counterweight", None)
            balanced = counterweights.study(self.assembly, counterweight, self.machine)
            study = together([study, balanced])
        return study

    def _on_pins(self, on_edges: Mapping[str, Loads]) -> Forces:
        """What pins and slides bear at most: friction may spare a pin, and may be less than its table says."""
        smooth = solve(self.machine, self.theta).forces()
        return replace(
            self.forces,
            reactions=_worse(smooth.reactions, self.forces.reactions),
            normals=_worse(smooth.normals, self.forces.normals),
            pressing={**self.forces.pressing, **on_edges},
        )

    def _driven(self) -> list[LoadCheck]:
        """Torque of the drive, how evenly the machine runs, and whether a hub holds on its shaft."""
        seat = self.assembly.motor
        cycle = self.assembly.cycle
        own = self.mechanism.material
        journals = self.assembly.journals

        def locking() -> str:
            return locking_friction(
                self.machine, journals, self.mechanism.load, own.name, self.theta
            )

        torque = drive.torque(self.run, self.forces, self.motor, cycle.label, seat.crank, locking)
        asked = self.assembly.material_limits.drive
        needed = Figures(torque.figures).get("drive_torque_n_m", 0.0)
        return [
            torque,
            running(self.run, self.motor, asked, cycle.name, seat.crank),
            drive.hub_slip(seat.hub, needed, own.name),
            drive.flats_of_shafts(seat.flats, self.run, self.forces, own.name),
        ]

    def _lifeless(self, bearings: Sequence[LoadCheck]) -> list[NotJudged]:
        """A bearing's life that is asked of a machine in which no ball bearing is loaded."""
        told = {finding.code for check in bearings for finding in check.findings}
        told |= {each.code for check in bearings for each in check.not_judged}
        joints = self.machine.joints
        lives = (self.assembly.limits_of(joint.name).bearing_life for joint in joints)
        if "BEARING_LIFE" in told or all(life is None for life in lives):
            return []
        if any(finding.code == "BEARING_LIFE" for finding in self.mechanism.limits()):
            return []
        why = "no ball bearing of the machine is loaded"
        return [NotJudged("BEARING_LIFE", why, "a ball bearing")]

    def _unwound(self) -> list[NotJudged]:
        """The return spring that a cam wishes for and that no wire can be."""
        wish = self.assembly.follower.wish
        if wish is None or self.assembly.springs:
            return []
        rate, least, _ = wish
        why = f"no wire up to {WIRES[-1]:g} mm can be wound to pull {least:.4g} N and {rate:.4g} N/mm more without yielding"
        needs = "another spring.preload or spring.rate, or a spring of another kind"
        return [NotJudged("SPRING_STRESS", why, needs)]


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
