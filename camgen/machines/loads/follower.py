"""What an elastic follower does on each cam, and what a counterweight on the driven shaft takes off the ground."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from camgen.findings import Where, at_least, at_most
from camgen.machine.balancing import crank_weight
from camgen.machine.cams.machine import lift_off
from camgen.machine.constraints import Constraints, solved
from camgen.machine.forces import Forces
from camgen.machine.friction import smooth
from camgen.machine.model import MM, Cam, Law, Machine, Turning
from camgen.machine.run import Run, solve
from camgen.machines.loads.bearing import Borne
from camgen.machines.loads.tables import Weight
from camgen.motion.laws import LAWS
from camgen.motion.program import Program
from camgen.numerics import Floats
from camgen.study import Plot, Table

if TYPE_CHECKING:
    from camgen.machine.cams.dynamics import Elastic
    from camgen.parts.springs import Mounted

_SURGE = (
    15.0  # times the cam's turns, that a spring's own frequency is to be; 15 to 20 is usual advice
)
_AT_JOINT = 1e-9  # rad, to either side of a dwell's ends
_SLOW = 1e-6  # of the speed, at which inertia does nothing
_STEP = 1e-3  # of the stroke, by which a follower is displaced to see what holds it
_ROUNDING = 1e-9  # of the contact's force, that is none


def elastic(run: Run, load: Weight | None) -> Borne:
    """LIFT_OFF, vibration and the speed without contact of each cam whose follower's stiffness is given."""
    borne = Borne()
    cams = [joint for joint in run.machine.joints if isinstance(joint, Cam)]
    if load is None or load.stiffness is None or len(cams) != 1:
        return borne
    from camgen.machine.cams.dynamics import Elastic, Excitation
    from camgen.motion.polydyne import Polydyne

    (cam,) = cams
    theta = run.theta[:-1]
    speed = run.machine.speed
    mass = effective_inertia(run, cam)
    rate, drag = held_by(run, cam)
    if not mass or load.stiffness + rate <= 0:
        return borne
    unit, scale = ("mm", 1.0) if cam.slide else ("deg", math.degrees(1))
    heavy = mass * MM if cam.slide else mass  # with s in mm and k in N/mm
    model = Elastic(heavy, load.stiffness, load.damping_ratio, rate, drag)
    turned = run.angle(cam.cam)[:, :-1]
    program = program_of(cam)
    angle = turned[0] - cam.phase
    # where it jumps, the mean of both sides: so a sum over even angles is its integral
    bend = (cam.law(angle - _AT_JOINT, 2) + cam.law(angle + _AT_JOINT, 2)) / 2
    excited = Excitation(cam.law(angle, 0), bend * turned[1] ** 2 + cam.law(angle, 1) * turned[2])
    found = model.response(excited, speed)
    key = cam.name.replace(" ", "_")
    peak = float(np.max(np.abs(excited.acceleration))) * speed**2
    borne.numbers |= {
        f"follower_frequency_{key}_hz": model.frequency / math.tau,
        f"vibration_{key}_{unit}": scale * float(np.max(np.abs(found.vibration))),
        f"acceleration_factor_{key}": float(np.max(np.abs(found.acceleration))) / peak
        if peak
        else 1.0,
    }
    if program is not None:
        resting = np.abs(found.vibration[dwelling(program, angle)])
        borne.numbers[f"vibration_in_dwells_{key}_{unit}"] = scale * float(
            np.max(resting, initial=0.0)
        )
    if rate:
        bent = (1 - model.share) * float(np.max(np.abs(excited.displacement)))
        borne.numbers[f"vibration_bent_by_spring_{key}_{unit}"] = scale * abs(bent)
    if isinstance(program, Polydyne):
        wanted = getattr(cam.law, "sign", 1) * program.wanted(angle)
        off = excited.displacement + found.behind - wanted
        borne.numbers[f"off_wanted_{key}_{unit}"] = scale * float(np.max(np.abs(off)))
    degrees = np.degrees(theta)
    borne.plots.append(
        Plot(
            f"Vibration of the follower, {cam.name}",
            "cam angle, deg",
            unit,
            [
                ("vibration", degrees, scale * found.vibration),
                ("y - s", degrees, scale * found.behind),
            ],
        )
    )
    by_cam = scale * excited.acceleration * speed**2
    borne.plots.append(
        Plot(
            f"Acceleration of the follower, {cam.name}",
            "cam angle, deg",
            f"{unit}/s^2",
            [("elastic", degrees, scale * found.acceleration), ("by the cam", degrees, by_cam)],
        )
    )
    if cam.closure == "force":
        still = solve(_slow(run), theta).forces().contacts[cam.name] * cam.leaves
        push = still + cam.leaves * model.push(excited, speed)
        fast = model.loses_contact(excited, speed, still, cam.leaves) * 60 / math.tau
        said = f"with an elastic follower of {model.frequency / math.tau:.4g} Hz"
        said += f"; contact is lost from {fast:.6g} rpm" if math.isfinite(fast) else ""
        borne.findings.append(
            lift_off(theta, push, "N" if cam.slide else "N m", Where(joint=cam.name), said, said)
        )
        if math.isfinite(fast):
            borne.numbers[f"lift_off_speed_{key}_rpm"] = fast
    borne.tables += _laws(program, model, abs(speed))
    return borne


def program_of(cam: Cam) -> Program | None:
    """The follower's program, where its law is one."""
    law = getattr(cam.law, "program", cam.law)
    return law if isinstance(law, Program) else None


def dwelling(program: Program, angle: Floats) -> Any:
    """Mask of the cam angles at which the program dwells, both ends included, (n,)."""
    turned = np.mod(angle - program.begin, math.tau)
    inside = np.zeros(turned.shape, bool)
    for segment, begin in zip(program.segments, program.joints - program.begin, strict=False):
        if not segment.scale:
            inside |= (turned >= begin - _AT_JOINT) & (turned <= begin + segment.span + _AT_JOINT)
    return inside


@dataclass(frozen=True)
class Displaced:
    """A law of which one derivative is larger by a constant."""

    law: Law
    order: int
    by: float

    def __call__(self, theta: Floats, order: int = 0) -> Floats:
        """Its order-th derivative, (n,)."""
        value = self.law(theta, order)
        return value + self.by if order == self.order else value


def held_by(run: Run, cam: Cam) -> tuple[float, float]:
    """What holds back all that moves with a cam's s, mean over the motion: force for 1 of s (N/mm, or N m/rad), and for 1 of
    its speed (N s/mm, or N m s/rad), by what the cam exerts where s, or its speed, is a little larger and smaller."""
    theta = run.theta
    machine = smooth(run.machine)
    speed = run.machine.speed
    size = _STEP * float(np.ptp(cam.law(run.angle(cam.cam)[0] - cam.phase, 0)))

    def exerted(order: int, by: float, machine: Machine) -> Floats:
        moved = replace(cam, law=Displaced(cam.law, order, by), friction=0.0)
        joints = tuple(moved if each.name == cam.name else each for each in machine.joints)
        return solve(replace(machine, joints=joints), theta).forces().contacts[cam.name]

    def slope(order: int, by: float, machine: Machine) -> float:
        return float(np.nanmean(exerted(order, by, machine) - exerted(order, -by, machine))) / (
            2 * by
        )

    if not size:
        return 0.0, 0.0
    found = slope(0, size, replace(machine, speed=_SLOW * speed)), slope(1, size, machine) / speed
    scale = float(np.nanmax(np.abs(run.forces().contacts[cam.name])))
    least = _ROUNDING * scale / size, _ROUNDING * scale / (size * abs(speed))
    rate, drag = (
        value if abs(value) > each else 0.0 for value, each in zip(found, least, strict=True)
    )
    return rate, drag


def _slow(run: Run) -> Machine:
    """The same so slow that inertia does nothing, and without friction in its joints."""
    return replace(smooth(run.machine), speed=_SLOW * run.machine.speed)


def effective_inertia(run: Run, cam: Cam) -> float:
    """Of all that moves with a cam's s, the drives held: kg, or kg m^2 where it swings; mean over the motion."""
    system = Constraints(run.machine)
    q = run.poses()
    unit = np.zeros((len(q), system.height))
    unit[:, system.rows[cam.name].start] = 1.0
    moves = solved(system.evaluate(q, run.theta)[1], unit, system.holds)
    total: Floats = np.zeros(len(q))
    length = 1.0 if cam.slide else MM  # of s in mm the ratio has no unit, of rad it is mm
    for body in run.machine.moving:
        k = system.column[body.name]
        arm = body.centre * np.exp(1j * q[:, k + 2])
        way = moves[:, k] + 1j * moves[:, k + 1] + 1j * moves[:, k + 2] * arm
        turns = moves[:, k + 2] / (MM if cam.slide else 1.0)
        total = total + body.mass * np.abs(way * length) ** 2 + body.inertia * turns**2
    return float(np.mean(total))


def _laws(program: Program | None, model: Elastic, speed: float) -> list[Table]:
    """What each law of the list would leave of vibration after the first rise, as long and as high as the cam's."""
    rise = next((each for each in (program.segments if program else ()) if each.scale), None)
    if rise is None:
        return []
    from camgen.machine.cams.dynamics import residual

    time = rise.span / speed
    rows = list[tuple[object, ...]]()
    for name, law in LAWS.items():
        left = residual(lambda t, law=law: law(t / time, 2) / time**2, time, model.frequency)  # type: ignore[misc]
        rows.append(
            (
                name,
                100 * model.share * left,
                "this one" if name == getattr(rise.law, "name", "") else "",
            )
        )
    rows.sort(key=lambda row: float(str(row[1])))
    title = f"Laws compared after the first rise, undamped, {model.frequency * time / math.tau:.3g} periods long"
    return [Table(title, ("law", "vibration left, % of the lift", ""), rows)]


def sprung(springs: Mapping[str, Mounted], speed: float) -> Borne:
    """SPRING_STRESS of each spring, SURGE of what holds a follower on its cam; by their names; speed: rad/s."""
    borne = Borne()
    for where, mounted in springs.items():
        spring = mounted.spring
        turns = abs(speed) / math.tau
        stress = spring.stress(mounted.longest)
        surge = spring.surge
        coils = f"outside diameter {spring.outside:.4g}, {spring.coils:.3g} coils"
        size = f"wire {spring.wire:g}, {coils}, free length {spring.free:.4g} mm, stretched to {mounted.longest:.4g} mm"
        borne.findings.append(
            at_most("SPRING_STRESS", stress, spring.strength, "MPa", Where(where), size)
        )
        if mounted.on_cam:
            said = (
                f"its own coils swing {surge / turns:.4g} times a turn; from {_SURGE:g} on no strong harmonic reaches "
                "it; a thicker wire on fewer coils is faster"
            )
            borne.findings.append(
                at_least("SURGE", surge, _SURGE * turns, "Hz", Where(where), said)
            )
        key = "spring" if where == "return spring" else re.sub("[^a-z0-9]+", "_", where.lower())
        numbers = {
            f"{key}_rate_n_mm": spring.rate,
            f"{key}_stress_mpa": stress,
            f"{key}_surge_hz": surge,
            f"{key}_force_least_n": spring.force(mounted.shortest),
            f"{key}_force_greatest_n": spring.force(mounted.longest),
        }
        borne.numbers |= {
            name: value for name, value in numbers.items() if name not in borne.numbers
        }
    return borne


def balance(run: Run, forces: Forces) -> Mapping[str, float]:
    """One counterweight on the driven body that least shakes the ground: mass times radius, where, and the force left."""
    drive = run.machine.drives[0]
    shaken = forces.shaking
    if (
        not isinstance(drive.law, Turning)
        or drive.slide
        or not np.all(np.isfinite(shaken))
        or not np.any(np.abs(shaken) > 0)
    ):
        return {}
    if abs(float(np.ptp(run.theta)) - math.tau) > 1e-9:
        return {}
    turned = drive.law(run.theta, 0)
    moment, left = crank_weight(shaken, turned, run.machine.speed * drive.law.rate)
    best = float(np.max(np.abs(shaken)))
    return {
        "balance_weight_g_mm": 1e3 * abs(moment),
        "balance_weight_at_deg": math.degrees(float(np.angle(-moment))),
        "shaking_force_balanced_n": min(left, best),
    }
