"""What turns the machine: DRIVE_TORQUE, SHAFT_REACH, SPEED_FLUCTUATION and the flywheel for a wanted one."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping

import numpy as np

from camgen.findings import NotJudged, Where, at_least, at_most
from camgen.machine import flywheel
from camgen.machine.forces import Forces
from camgen.machine.model import GROUND, MM, Pin, Turning
from camgen.machine.run import Run
from camgen.machines.loads.bearing import LoadCheck
from camgen.machines.loads.tables import Drives
from camgen.numerics import Floats, peak
from camgen.parts import materials
from camgen.parts.assembly import MotorSeat
from camgen.parts.motors import RPM, SHAFTS, Motor, of_model
from camgen.parts.set_screws import HOLDS, TURNED, SetScrewHub
from camgen.study import Figure, Plot

_NOTHING = 1e-12  # N m
_ROUNDING = 1e-9  # of what the forces in the pins could do at the longest lever: a torque below that is rounding, and 0
_SHOWN = (0.02, 0.1)  # swings of the speed whose flywheels are figures


def motor_of(drives: Drives | None, crank: float = 0.0) -> Motor | None:
    """What the motor can give; None where the spec says nothing of it.

    crank: mm, of the machine's own hand crank, which names a hand by itself; 0: it has none.
    """
    known = Drives() if drives is None else drives
    if known.torque_n_m is not None:
        return Motor(known.torque_n_m, said="motor.torque_n_m")
    if known.stall_torque_n_m is not None and known.no_load_rpm is not None:
        said = "from motor.stall_torque_n_m to no_load_rpm"
        return Motor(known.stall_torque_n_m, known.no_load_rpm * RPM, said)
    return of_model(known.model, crank)


def reach(drives: Drives | None, seat: MotorSeat) -> LoadCheck:
    """SHAFT_REACH: the motor's shaft over its face against what the parts need."""
    if seat.reach is None:
        return LoadCheck()
    length = None if drives is None else drives.shaft_length
    said = "motor.shaft_length"
    if length is None and seat.frame in SHAFTS:
        length = SHAFTS[seat.frame][1]
        said = f"the usual shaft of a {seat.frame.upper().replace('-', ' ')} frame: measure yours"
    if length is None:
        why = f"the shaft has to reach {seat.reach:.4g} mm over the motor's face, and nothing says how far it does"
        return LoadCheck(not_judged=[NotJudged("SHAFT_REACH", why, said)])
    remark = f"over the motor's face; {said}; thinner parts need less"
    return LoadCheck(
        [
            at_least(
                "SHAFT_REACH",
                length,
                seat.reach,
                "mm",
                Where("motor"),
                remark,
            ).within(1e-9)
        ]
    )


def torque(
    run: Run,
    forces: Forces,
    drives: Drives | None,
    angle: str = "crank angle",
    crank: float = 0.0,
    locking: Callable[[], str] = str,
) -> LoadCheck:
    """SELF_LOCKING, torque, power and evenness of the machine's drives, which are one shaft: seen from the first of them.

    DRIVE_TORQUE is judged where the spec names what turns it; else the torque that is needed is a figure alone.
    angle: what theta is called; crank: mm, of the machine's own hand crank, 0: none; locking: of a machine that locks says by
    which friction, and which it would bear.
    """
    check = LoadCheck()
    speed = run.machine.speed
    theta = run.theta
    turn = float(np.ptp(theta))
    drive = run.machine.drives[0]
    needed = _on_shaft(run, forces.drives)
    smooth = _on_shaft(run, forces.smooth)
    if peak(needed) <= max(_NOTHING, _ROUNDING * _torque_of_pins(run, forces)):
        needed = np.zeros_like(needed)
        smooth = needed
    if np.any(forces.locks):
        locked = float(np.mean(forces.locks)) * math.degrees(turn)
        remark = (
            f"{locking()}. No torque moves it there, or only one that loads the joints tenfold; use a lower "
            "load.friction, a ball bearing or a greater transmission angle"
        )
        first = float(theta[int(np.argmax(forces.locks))])
        where = Where("drive", theta=first, angle="from", digits=1)
        check.findings.append(
            at_most("SELF_LOCKING", min(locked, math.degrees(turn)), 0.0, "deg", where, remark)
        )
    most = peak(needed)
    energy = flywheel.energy_swing(theta, needed * np.sign(speed))
    flywheel_given = 0.0 if drives is None else drives.flywheel_kg_m2
    inertia = _inertia(run, drive.body) + flywheel_given

    def flywheel_for(share: float) -> float:
        """Inertia, kg m^2, of a flywheel for a swing of the speed."""
        return max(0.0, flywheel.inertia_for(energy, share, speed) - inertia)

    power = flywheel.mean_torque(theta, needed * drive.law(theta, 1) * speed)
    check.figures += [
        Figure("drive torque", most, "N m"),
        Figure("drive torque mean", flywheel.mean_torque(theta, needed), "N m"),
        Figure("drive power", power, "W"),
        Figure("energy swing", energy, "J"),
        Figure("turning inertia", inertia, "kg m²"),
    ]
    for share in _SHOWN:
        quantity = f"flywheel for {100 * share:g} percent"
        check.figures.append(Figure(quantity, flywheel_for(share), "kg m²"))
    if isinstance(drive.law, Turning) and abs(turn - math.tau) < 1e-9 and energy:
        size, place, left = flywheel.spring_on_shaft(drive.law(theta, 0), needed)
        if left < most and size > _ROUNDING * most:
            check.figures += [
                Figure("balance spring", size, "N m"),
                Figure("balance spring at", math.degrees(place), "deg"),
                Figure("drive torque balanced", left, "N m"),
            ]
    degrees = np.degrees(theta)
    curves = [("with friction", degrees, needed), ("without", degrees, smooth)]
    title = "Torque that the motor gives, with friction in the joints and without"
    check.plots.append(Plot(title, f"{angle}, deg", "N m", curves))
    fluctuation = None if drives is None else drives.fluctuation
    swing = min(1.0, flywheel.fluctuation_of(energy, inertia, speed)) if energy else 0.0
    if flywheel_given or fluctuation:
        check.figures.append(Figure("speed fluctuation", swing))
    if fluctuation is not None:
        remark = (
            f"by {energy:.4g} J on {inertia:.4g} kg m^2 that turn; "
            f"a flywheel of {flywheel_for(fluctuation):.4g} kg m^2 more keeps to it"
        )
        check.findings.append(
            at_most("SPEED_FLUCTUATION", swing, fluctuation, "share", Where("drive"), remark)
        )
    motor = motor_of(drives, crank)
    if motor is not None:
        worst = int(np.argmax(np.abs(needed)))
        rate = float(abs(drive.law(theta, 1)[worst] * speed))
        remark = f"needed at {rate * 60 / math.tau:.6g} rpm with the friction of all joints; {motor.said}"
        if most < _NOTHING:
            remark += "; no load, mass or friction is known: give them in [load]"
        where = Where("drive", theta=float(theta[worst]), angle="", digits=1)
        check.findings.append(
            at_most("DRIVE_TORQUE", most, max(0.0, motor.torque(rate)), "N m", where, remark)
        )
    return check


def _torque_of_pins(run: Run, forces: Forces) -> float:
    """Peak forces in all pins at the longest lever to one, N m: what they would ask of the drive if none met another."""
    pins = [joint for joint in run.machine.joints if isinstance(joint, Pin)]
    places = [place for pin in pins for place in (pin.a, pin.b) if place.body != GROUND]
    lever = max((abs(place.at) for place in places), default=0.0)
    return lever * MM * sum(peak(force) for force in forces.reactions.values())


def hub_slip(hub: SetScrewHub | None, torque: float, plastic: str) -> LoadCheck:
    """HUB_SLIP of a hub on a round shaft: what its set screw holds against the drive's peak torque, N m.

    Where the shaft has a flat that turns the hub, by how much it is held along the shaft alone.
    """
    check = LoadCheck()
    if hub is None:
        return check
    bears = materials.of(plastic).bears
    force = hub.force(bears)
    tightened = TURNED * force * hub.screw.nominal * MM
    check.figures += [
        Figure("set screw tightened", tightened, "N m"),
        Figure("set screw holds along shaft", HOLDS * force, "N"),
    ]
    if not hub.flat:
        holds = HOLDS * force * hub.bore / 2 * MM
        check.figures.append(Figure("set screw holds", holds, "N m"))
        remark = (
            f"{hub.thread} tightened with {tightened:.3g} N m, {force:.4g} N, as hard as its nut's wall of {plastic} bears "
            f"({bears:g} MPa); a shaft with a flat, or a thicker screw, holds more"
        )
        where = Where(f"set screw, shaft of {hub.bore:g} mm")
        check.findings.append(at_most("HUB_SLIP", torque, holds, "N m", where, remark))
    return check


def _on_shaft(run: Run, drives: Mapping[str, Floats]) -> Floats:
    """Torque of all drives on the first one, (n,) N m, by the power that each gives; 0 where it is not known."""
    first, *others = run.machine.drives
    total = drives[first.name]
    rate = first.law(run.theta, 1)
    for each in others:
        power = drives[each.name] * each.law(run.theta, 1) * (MM if each.slide else 1.0)
        total = total + np.where(rate != 0, power / np.where(rate != 0, rate, 1.0), 0.0)
    return np.where(np.isfinite(total), total, 0.0)


def _inertia(run: Run, body: str) -> float:
    """Inertia of the driven body about where it turns, its frame's origin, kg m^2."""
    own = run.machine.body(body)
    return own.inertia + own.mass * abs(own.centre * MM) ** 2
