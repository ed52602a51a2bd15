"""What an elastic follower does on each cam, and what a counterweight on the driven shaft takes off the ground."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from camgen.findings import NotJudged, Where, at_least, at_most
from camgen.machine.balancing import crank_weight
from camgen.machine.cams.machine import lift_off
from camgen.machine.constraints import Constraints
from camgen.machine.forces import Forces
from camgen.machine.friction import smooth
from camgen.machine.model import MM, Cam, Law, Machine, Turning
from camgen.machine.run import Run, solve
from camgen.machines.loads.bearing import LoadCheck
from camgen.machines.loads.lift_off import slow
from camgen.machines.loads.tables import Weight
from camgen.motion.laws import LAWS
from camgen.motion.program import Program
from camgen.numerics import Floats, peak
from camgen.parts.springs import CompressionSpring
from camgen.study import Figure, Plot, Table

if TYPE_CHECKING:
    from camgen.machine.cams.dynamics import Elastic
    from camgen.parts.journals import MaterialLimits
    from camgen.parts.springs import WorkingSpring

# times the cam's turns, that a spring's own frequency is to be; 15 to 20 is usual advice
_SURGE = 15.0
_AT_JOINT = 1e-9  # rad, to either side of a dwell's ends
_STEP = 1e-3  # of the stroke, by which a follower is displaced to see what holds it
_ROUNDING = 1e-9  # of the contact's force, that is none
_EVEN = 1e-9  # of a cam's turning, by which its rate may change
_RATES = ("FOLLOWER_VELOCITY", "FOLLOWER_ACCELERATION", "FOLLOWER_JERK")


def elastic(run: Run, load: Weight | None, limits_of: Callable[[str], MaterialLimits]) -> LoadCheck:
    """LIFT_OFF, FOLLOWER_FREQUENCY, vibration and the speed without contact of each cam whose follower's stiffness is given."""
    check = LoadCheck()
    cams = [joint for joint in run.machine.joints if isinstance(joint, Cam)]
    unknown = LoadCheck()
    if any(limits_of(cam.name).motion.frequency_ratio for cam in cams):
        why = (
            "a follower's own frequency is known for a machine with one cam, by stiffness and mass"
        )
        unknown.not_judged.append(
            NotJudged("FOLLOWER_FREQUENCY", why, "load.stiffness and a mass of the follower")
        )
    if load is None or load.stiffness is None or len(cams) != 1:
        return unknown
    from camgen.machine.cams.dynamics import Elastic, Excitation
    from camgen.motion.polydyne import Polydyne

    cam = cams[0]
    theta = run.theta[:-1]
    speed = run.machine.speed
    mass = effective_inertia(run, cam)
    rate, drag = restraint(run, cam)
    if not mass or load.stiffness + rate <= 0:
        return unknown
    unit, scale = ("mm", 1.0) if cam.slide else ("deg", math.degrees(1))
    heavy = mass * MM if cam.slide else mass  # with s in mm and k in N/mm
    model = Elastic(heavy, load.stiffness, load.damping_ratio, rate, drag)
    turned = run.argument(cam)[:, :-1]
    program = program_of(cam)
    angle = turned[0]
    # where it jumps, the mean of both sides: so a sum over even angles is its integral
    bend = (cam.law(angle - _AT_JOINT, 2) + cam.law(angle + _AT_JOINT, 2)) / 2
    excited = Excitation(cam.law(angle, 0), bend * turned[1] ** 2 + cam.law(angle, 1) * turned[2])
    response = model.response(excited, speed)
    least = limits_of(cam.name).motion.frequency_ratio
    if least is not None:
        ratio = model.frequency / (abs(speed) * peak(turned[1]))
        message = (
            "times the turns of its cam: a stiffer or lighter follower, or a lower speed raises it"
        )
        where = Where(joint=cam.name)
        check.findings.append(at_least("FOLLOWER_FREQUENCY", ratio, least, "", where, message))
    rigid = peak(excited.acceleration) * speed**2
    factor = peak(response.acceleration) / rigid if rigid else 1.0
    check.figures += [
        Figure("follower frequency {of}", model.frequency / math.tau, "Hz", cam.name),
        Figure("vibration {of}", scale * peak(response.vibration), unit, cam.name),
        Figure("acceleration factor {of}", factor, "", cam.name),
    ]
    if program is not None:
        resting = response.vibration[in_dwells(program, angle)]
        figure = Figure("vibration in dwells {of}", scale * peak(resting), unit, cam.name)
        check.figures.append(figure)
    if rate:
        bent = scale * abs((1 - model.share) * peak(excited.displacement))
        check.figures.append(Figure("vibration bent by spring {of}", bent, unit, cam.name))
    if isinstance(program, Polydyne):
        wanted = getattr(cam.law, "sign", 1) * program.wanted(angle)
        off = excited.displacement + response.behind - wanted
        check.figures.append(Figure("off wanted {of}", scale * peak(off), unit, cam.name))
    degrees = np.degrees(theta)
    vibration = [
        ("vibration", degrees, scale * response.vibration),
        ("y - s", degrees, scale * response.behind),
    ]
    acceleration = [
        ("elastic", degrees, scale * response.acceleration),
        ("by the cam", degrees, scale * excited.acceleration * speed**2),
    ]
    label = "cam angle, deg"
    check.plots += [
        Plot(f"Vibration of the follower, {cam.name}", label, unit, vibration),
        Plot(f"Acceleration of the follower, {cam.name}", label, f"{unit}/s^2", acceleration),
    ]
    if cam.closure == "force":
        still = solve(slow(smooth(run.machine)), theta).forces().contacts[cam.name] * cam.leaves
        push = still + cam.leaves * model.push(excited, speed)
        rpm = model.loses_contact(excited, speed, still, cam.leaves) * 60 / math.tau
        remark = f"the follower is elastic, with a natural frequency of {model.frequency / math.tau:.4g} Hz"
        if math.isfinite(rpm):
            remark += f". It loses contact from {rpm:.6g} rpm"
            check.figures.append(Figure("lift off speed {of}", rpm, "rpm", cam.name))
        push_unit = "N" if cam.slide else "N m"
        check.findings.append(
            lift_off(theta, push, push_unit, Where(joint=cam.name), remark, remark)
        )
    check.tables += _laws(program, model, abs(speed))
    return check


def motion_limits(run: Run, limits_of: Callable[[str], MaterialLimits]) -> LoadCheck:
    """FOLLOWER_VELOCITY, FOLLOWER_ACCELERATION and FOLLOWER_JERK of each cam of which the spec limits them."""
    check = LoadCheck()
    for cam in (joint for joint in run.machine.joints if isinstance(joint, Cam)):
        limits = limits_of(cam.name).motion
        if not any(limits.orders):
            continue
        unit, scale = ("mm", 1.0) if cam.slide else ("deg", math.degrees(1))
        peaks = _rates(run, cam)
        for k, (code, limit) in enumerate(zip(_RATES, limits.orders, strict=True)):
            if limit is None:
                continue
            if math.isnan(peaks[k]):
                why = f"the cam of {cam.name} turns unevenly, or its law is no program of segments"
                check.not_judged.append(NotJudged(code, why, "a cam that turns evenly"))
                continue
            jumps = "" if math.isfinite(peaks[k]) else "the one before it jumps; "
            message = f"{jumps}a longer span, less lift, another law or a lower speed lowers it"
            where = Where(joint=cam.name)
            per = ("s", "s^2", "s^3")[k]
            check.findings.append(
                at_most(code, scale * peaks[k], limit, f"{unit}/{per}", where, message)
            )
    return check


def _rates(run: Run, cam: Cam) -> list[float]:
    """Greatest size of the follower's derivatives of order 1 to 3 to time, nan of those that are not known."""
    turned = run.argument(cam)
    speed = abs(run.machine.speed)
    program = program_of(cam)
    even = peak(turned[2]) <= _EVEN and np.ptp(turned[1]) <= _EVEN
    if even and program is not None:
        rate = speed * peak(turned[1])
        return [program.peak(order) * rate**order for order in (1, 2, 3)]
    angle = turned[0]
    velocity = cam.law(angle, 1) * turned[1] * speed
    bend = cam.law(angle, 2) * turned[1] ** 2 + cam.law(angle, 1) * turned[2]
    return [peak(velocity), peak(bend) * speed**2, math.nan]


def program_of(cam: Cam) -> Program | None:
    """The follower's program, where its law is one."""
    law = getattr(cam.law, "program", cam.law)
    return law if isinstance(law, Program) else None


def in_dwells(program: Program, angle: Floats) -> Any:
    """Mask of the cam angles at which the program dwells, both ends included, (n,)."""
    since = np.mod(angle - program.begin, math.tau)
    inside = np.zeros(since.shape, bool)
    for segment, begin in zip(program.segments, program.joints - program.begin, strict=False):
        if not segment.scale:
            inside |= (since >= begin - _AT_JOINT) & (since <= begin + segment.span + _AT_JOINT)
    return inside


@dataclass(frozen=True)
class PerturbedLaw:
    """A law of which one derivative is larger by a constant."""

    law: Law
    order: int
    by: float

    def __call__(self, theta: Floats, order: int = 0) -> Floats:
        """Its order-th derivative, (n,)."""
        value = self.law(theta, order)
        return value + self.by if order == self.order else value


def restraint(run: Run, cam: Cam) -> tuple[float, float]:
    """Stiffness, N/mm or N m/rad, and damping, N s/mm or N m s/rad, that hold back all that moves with a cam's s.

    Means over the motion, by what the cam exerts where s, or its speed, is a little larger and smaller.
    """
    machine = smooth(run.machine)
    speed = machine.speed
    size = _STEP * float(np.ptp(cam.law(run.argument(cam)[0], 0)))

    def exerted(order: int, by: float, machine: Machine) -> Floats:
        moved = replace(cam, law=PerturbedLaw(cam.law, order, by), friction=0.0)
        joints = tuple(moved if each.name == cam.name else each for each in machine.joints)
        return solve(replace(machine, joints=joints), run.theta).forces().contacts[cam.name]

    def slope(order: int, by: float, machine: Machine) -> float:
        change = exerted(order, by, machine) - exerted(order, -by, machine)
        return float(np.nanmean(change)) / (2 * by)

    if not size:
        return 0.0, 0.0
    stiffness = slope(0, size, slow(machine))
    damping = slope(1, size, machine) / speed
    rounding = _ROUNDING * peak(run.forces().contacts[cam.name]) / size
    return (
        stiffness if abs(stiffness) > rounding else 0.0,
        damping if abs(damping) > rounding / abs(speed) else 0.0,
    )


def effective_inertia(run: Run, cam: Cam) -> float:
    """Of all that moves with a cam's s, the drives held: kg, or kg m^2 where it swings; mean over the motion."""
    system = Constraints(run.machine)
    q = run.poses()
    unit = np.zeros((len(q), system.height))
    unit[:, system.rows[cam.name].start] = 1.0
    moves = system.moved(system.written(q, run.theta).slopes, unit)
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
    rows = []
    for name, law in LAWS.items():
        left = residual(lambda t, law=law: law(t / time, 2) / time**2, time, model.frequency)  # type: ignore[misc]
        note = "this one" if name == getattr(rise.law, "name", "") else ""
        rows.append((name, 100 * model.share * left, note))
    rows.sort(key=lambda row: row[1])
    title = f"Laws compared after the first rise, undamped, {model.frequency * time / math.tau:.3g} periods long"
    return [Table(title, ("law", "vibration left, % of the lift", ""), rows)]


def springs(mounted: Mapping[str, WorkingSpring], speed: float, lasting: bool) -> LoadCheck:
    """SPRING_STRESS of each spring, SURGE of what holds a follower on its cam, and SPRING_FATIGUE of a machine that is to last for
    ever, which a printed one does not; by their names; speed: rad/s."""
    check = LoadCheck()
    names = set[str]()
    turns = abs(speed) / math.tau
    for name, each in mounted.items():
        spring = each.spring
        stress = spring.stress(each.tightest)
        low, high = sorted((spring.force(each.shortest), spring.force(each.longest)))
        pressed = isinstance(spring, CompressionSpring)
        surge = spring.surge
        coils = f"outside diameter {spring.outside:.4g}, {spring.coils:.3g} coils"
        size = f"wire {spring.wire:g}, {coils}, free length {spring.free:.4g} mm, {'pressed' if pressed else 'stretched'} to {each.tightest:.4g} mm"
        where = Where(name)
        check.findings.append(at_most("SPRING_STRESS", stress, spring.strength, "MPa", where, size))
        if lasting:
            swing = spring.fatigue(each.shortest, each.longest)
            said = (
                f"stress of its {swing.place} swings from {swing.low:.0f} to {swing.high:.0f} MPa; the limit is the amplitude "
                "that unpeened wire bears at this mean for ten million turns and more (Goodman)"
            )
            check.findings.append(
                at_most("SPRING_FATIGUE", swing.amplitude, swing.limit, "MPa", where, said)
            )
        if each.on_cam:
            remark = (
                f"the spring's coils vibrate {surge / turns:.4g} times in a turn of the shaft, which takes {1 / turns:.3g} s; from "
                f"{_SURGE:g} times a turn on, no strong harmonic of the cam excites them. Fewer coils of a thicker wire vibrate faster"
            )
            check.findings.append(at_least("SURGE", surge, _SURGE * turns, "Hz", where, remark))
        if each.name in names:
            continue
        names.add(each.name)
        check.figures += [
            Figure("{joint} rate", spring.rate, "N/mm", joint=each.name),
            Figure("{joint} stress", stress, "MPa", joint=each.name),
            Figure("{joint} surge", surge, "Hz", joint=each.name),
            Figure("{joint} force, least", low, "N", joint=each.name),
            Figure("{joint} force, greatest", high, "N", joint=each.name),
        ]
    return check


def balance(run: Run, forces: Forces) -> list[Figure]:
    """One counterweight on the driven body that least shakes the ground: mass times radius, where, and the force left."""
    drive = run.machine.drives[0]
    shaking = forces.shaking
    if (
        not isinstance(drive.law, Turning)
        or drive.slide
        or not np.all(np.isfinite(shaking))
        or not np.any(shaking)
        or abs(float(np.ptp(run.theta)) - math.tau) > 1e-9
    ):
        return []
    angle = drive.law(run.theta, 0)
    moment, left = crank_weight(shaking, angle, run.machine.speed * drive.law.rate)
    return [
        Figure("balance weight", 1e3 * abs(moment), "g mm"),
        Figure("balance weight at", math.degrees(float(np.angle(-moment))), "deg"),
        Figure("shaking force balanced", min(left, peak(shaking)), "N"),
    ]
