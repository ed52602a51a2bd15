"""What turns the machine: DRIVE_TORQUE, SHAFT_REACH, SPEED_FLUCTUATION and the flywheel for a wanted one."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from camgen.findings import Finding, NotJudged, at_least, at_most
from camgen.machine import flywheel
from camgen.machine.forces import Forces
from camgen.machine.model import MM
from camgen.machine.run import Run
from camgen.machines.loads.bearing import Borne
from camgen.machines.loads.tables import Drives
from camgen.numerics import Floats
from camgen.parts.motors import SHAFTS, STEPPERS, Motor
from camgen.study import Plot

_NOTHING = 1e-12  # N m
_SHOWN = (0.02, 0.1)  # swings of the speed for which the flywheel is told


def motor_of(drives: Drives | None) -> Motor | None:
    """What the motor can give; None where the spec says nothing of it."""
    if drives is None:
        return None
    if drives.model is not None:
        return Motor(STEPPERS[drives.model].holding, said=f"{drives.model} holds so much and gives less as it turns")
    if drives.torque_n_m is not None:
        return Motor(drives.torque_n_m, said="motor.torque_n_m")
    if drives.stall_torque_n_m is not None and drives.no_load_rpm is not None:
        return Motor(drives.stall_torque_n_m, drives.no_load_rpm * math.tau / 60, "from motor.stall_torque_n_m to no_load_rpm")
    return None


def reach(drives: Drives | None, frame: str, needed: float) -> Finding | NotJudged:
    """SHAFT_REACH: the motor's shaft over its face against what the parts need, mm; frame: its size, "" where it has none."""
    given = None if drives is None else drives.shaft_length
    usual = SHAFTS.get(frame)
    if given is None and usual is None:
        why = f"the shaft has to reach {needed:.4g} mm over the motor's face, and nothing says how far it does"
        return NotJudged("SHAFT_REACH", why, "motor.shaft_length")
    length = given if given is not None else usual[1] if usual else math.nan
    usually = f"the usual shaft of a {frame.upper().replace('-', ' ')} frame: measure yours"
    said = "motor.shaft_length" if given is not None else usually
    message = f"over the motor's face; {said}; thinner parts need less"
    return at_least("SHAFT_REACH", length, needed, "mm", "motor", message, 1e-9)


def driven(run: Run, forces: Forces, friction: Any, drives: Drives | None) -> tuple[Borne, list[NotJudged]]:
    """Torque, power and evenness of the machine's one drive; friction: heat of all joints, (n,) W."""
    borne, speed, theta = Borne(), run.machine.speed, run.theta
    drive = run.machine.drives[0]
    torque = np.where(np.isfinite(forces.drives[drive.name]), forces.drives[drive.name], 0.0)
    rate = np.abs(drive.law(theta, 1)) * abs(speed)
    with np.errstate(all="ignore"):
        rubs = np.where(rate > 1e-3 * abs(speed), friction / rate, 0.0) + np.zeros(len(theta))
    sense = np.sign(speed * drive.law(theta, 1))
    asked = torque + sense * rubs
    worst = int(np.argmax(np.abs(asked)))
    energy = flywheel.energy_swing(theta, asked * np.sign(speed))
    inertia = _turning(run, drive.body) + (0.0 if drives is None else drives.flywheel_kg_m2)
    swing = min(1.0, flywheel.fluctuation_of(energy, inertia, speed)) if energy else 0.0
    borne.numbers |= {
        "drive_torque_n_m": float(np.max(np.abs(asked))), "drive_torque_mean_n_m": flywheel.mean_torque(theta, asked),
        "drive_power_w": flywheel.mean_torque(theta, asked * drive.law(theta, 1) * speed), "energy_swing_j": energy,
        "turning_inertia_kg_m2": inertia,
        **{f"flywheel_for_{100 * share:g}_percent_kg_m2": max(0.0, flywheel.inertia_for(energy, share, speed) - inertia)
           for share in _SHOWN},
    }  # fmt: skip
    curves: list[tuple[str, Floats, Floats]] = [("with friction", np.degrees(theta), asked)]
    curves += [("without", np.degrees(theta), torque)]
    title = "Torque that the motor gives, with friction in the joints and without"
    borne.plots.append(Plot(title, "angle of the drive, deg", "N m", curves))
    if drives is not None and (drives.flywheel_kg_m2 or drives.fluctuation):
        borne.numbers["speed_fluctuation"] = swing
    if drives is not None and drives.fluctuation is not None:
        more = max(0.0, flywheel.inertia_for(energy, drives.fluctuation, speed) - inertia)
        said = f"by {energy:.4g} J on {inertia:.4g} kg m^2 that turn; a flywheel of {more:.4g} kg m^2 more keeps to it"
        borne.findings.append(at_most("SPEED_FLUCTUATION", swing, drives.fluctuation, "share", "drive", said))
    motor, peak = motor_of(drives), float(np.abs(asked[worst]))
    if motor is None and peak < _NOTHING:
        why = "nothing is known of what the drive moves: there is no part, mass or load"
        return borne, [NotJudged("DRIVE_TORQUE", why, "a load, or parts with mass")]
    if motor is None:
        why = f"{peak:.3g} N m are needed at {abs(speed) * 60 / math.tau:.4g} rpm, and nothing says what the motor gives"
        return borne, [NotJudged("DRIVE_TORQUE", why, "motor.torque_n_m or motor.model")]
    fast = float(rate[worst])
    said = f"needed at {fast * 60 / math.tau:.4g} rpm with the friction of all joints; {motor.said}"
    where = f"drive, {math.degrees(float(theta[worst])):.1f} deg"
    borne.findings.append(at_most("DRIVE_TORQUE", peak, max(0.0, motor.torque(fast)), "N m", where, said))
    return borne, []


def _turning(run: Run, body: str) -> float:
    """Inertia of the driven body about where it turns, its frame's origin, kg m^2."""
    own = run.machine.body(body)
    return own.inertia + own.mass * abs(own.centre * MM) ** 2
