"""What turns the machine: DRIVE_TORQUE, SHAFT_REACH, SPEED_FLUCTUATION and the flywheel for a wanted one."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping

import numpy as np

from camgen.findings import Finding, NotJudged, Where, at_least, at_most
from camgen.machine import flywheel
from camgen.machine.forces import Forces
from camgen.machine.model import GROUND, MM, Pin, Turning
from camgen.machine.run import Run
from camgen.machines.loads.bearing import Borne
from camgen.machines.loads.tables import Drives
from camgen.numerics import Floats
from camgen.parts import materials
from camgen.parts.motors import SHAFTS, STEPPERS, Motor
from camgen.parts.set_screws import HOLDS, TURNED, SetScrewHub
from camgen.study import Plot

_LEAST_SAID = 1e-4  # N m; of what is less no motor's maker speaks
_NOTHING = 1e-12  # N m
_ROUNDING = 1e-9  # of what the forces in the pins could do at the longest lever: a torque below that is rounding, and 0
_SHOWN = (0.02, 0.1)  # swings of the speed for which the flywheel is told


def motor_of(drives: Drives | None) -> Motor | None:
    """What the motor can give; None where the spec says nothing of it."""
    if drives is None:
        return None
    if drives.model is not None:
        return Motor(
            STEPPERS[drives.model].holding,
            said=f"{drives.model} holds so much and gives less as it turns",
        )
    if drives.torque_n_m is not None:
        return Motor(drives.torque_n_m, said="motor.torque_n_m")
    if drives.stall_torque_n_m is not None and drives.no_load_rpm is not None:
        return Motor(
            drives.stall_torque_n_m,
            drives.no_load_rpm * math.tau / 60,
            "from motor.stall_torque_n_m to no_load_rpm",
        )
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
    return at_least("SHAFT_REACH", length, needed, "mm", Where("motor"), message, 1e-9)


def driven(
    run: Run, forces: Forces, drives: Drives | None, freed: Callable[[], str] = str
) -> tuple[Borne, list[NotJudged]]:
    """SELF_LOCKING, torque, power and evenness of the machine's drives, which are one shaft: seen from the first of them.

    freed: of a machine that locks says by which friction, and which it would bear.
    """
    borne = Borne()
    speed = run.machine.speed
    theta = run.theta
    drive = run.machine.drives[0]
    torque = _on_shaft(run, forces.smooth)
    asked = _on_shaft(run, forces.drives)
    if np.max(np.abs(asked)) <= max(_NOTHING, _ROUNDING * _could(run, forces)):
        torque = np.zeros_like(torque)
        asked = np.zeros_like(asked)
    rate = np.abs(drive.law(theta, 1)) * abs(speed)
    if np.any(forces.locks):
        locked = float(np.mean(forces.locks)) * math.degrees(float(np.ptp(theta)))
        turn = math.degrees(float(np.ptp(theta)))
        said = (
            f"{freed()}. Friction grows with what it holds back: no torque turns it on there, or one that "
            "loads them tenfold; use a lower load.friction, a ball bearing, a steeper transmission angle"
        )
        at = float(theta[int(np.argmax(forces.locks))])
        borne.findings.append(
            at_most(
                "SELF_LOCKING",
                min(locked, turn),
                0.0,
                "deg",
                Where("drive", theta=at, angle="from", digits=1),
                said,
            )
        )
    worst = int(np.argmax(np.abs(asked)))
    energy = flywheel.energy_swing(theta, asked * np.sign(speed))
    inertia = _turning(run, drive.body) + (0.0 if drives is None else drives.flywheel_kg_m2)
    swing = min(1.0, flywheel.fluctuation_of(energy, inertia, speed)) if energy else 0.0
    borne.numbers |= {
        "drive_torque_n_m": float(np.max(np.abs(asked))),
        "drive_torque_mean_n_m": flywheel.mean_torque(theta, asked),
        "drive_power_w": flywheel.mean_torque(theta, asked * drive.law(theta, 1) * speed),
        "energy_swing_j": energy,
        "turning_inertia_kg_m2": inertia,
        **{
            f"flywheel_for_{100 * share:g}_percent_kg_m2": max(
                0.0, flywheel.inertia_for(energy, share, speed) - inertia
            )
            for share in _SHOWN
        },
    }
    if isinstance(drive.law, Turning) and abs(float(np.ptp(theta)) - math.tau) < 1e-9 and energy:
        size, place, left = flywheel.spring_on_shaft(drive.law(theta, 0), asked)
        told = {
            "balance_spring_n_m": size,
            "balance_spring_at_deg": math.degrees(place),
            "drive_torque_balanced_n_m": left,
        }
        peak = float(np.max(np.abs(asked)))
        borne.numbers |= told if left < peak and size > _ROUNDING * peak else {}
    curves: list[tuple[str, Floats, Floats]] = [("with friction", np.degrees(theta), asked)]
    curves += [("without", np.degrees(theta), torque)]
    title = "Torque that the motor gives, with friction in the joints and without"
    borne.plots.append(Plot(title, "angle of the drive, deg", "N m", curves))
    if drives is not None and (drives.flywheel_kg_m2 or drives.fluctuation):
        borne.numbers["speed_fluctuation"] = swing
    if drives is not None and drives.fluctuation is not None:
        more = max(0.0, flywheel.inertia_for(energy, drives.fluctuation, speed) - inertia)
        said = f"by {energy:.4g} J on {inertia:.4g} kg m^2 that turn; a flywheel of {more:.4g} kg m^2 more keeps to it"
        borne.findings.append(
            at_most("SPEED_FLUCTUATION", swing, drives.fluctuation, "share", Where("drive"), said)
        )
    motor = motor_of(drives)
    peak = float(np.abs(asked[worst]))
    if motor is None and peak < _NOTHING:
        why = "nothing is known of what the drive moves: there is no part, mass or load"
        return borne, [NotJudged("DRIVE_TORQUE", why, "a load, or parts with mass")]
    if motor is None:
        torque_said = f"{peak:.3g}" if peak >= _LEAST_SAID else f"less than {_LEAST_SAID:g}"
        why = f"{torque_said} N m are needed at {abs(speed) * 60 / math.tau:.6g} rpm, and nothing says what the motor gives"
        return borne, [NotJudged("DRIVE_TORQUE", why, "motor.torque_n_m or motor.model")]
    fast = float(rate[worst])
    said = f"needed at {fast * 60 / math.tau:.6g} rpm with the friction of all joints; {motor.said}"
    where = Where("drive", theta=float(theta[worst]), angle="", digits=1)
    borne.findings.append(
        at_most("DRIVE_TORQUE", peak, max(0.0, motor.torque(fast)), "N m", where, said)
    )
    return borne, []


def _could(run: Run, forces: Forces) -> float:
    """Peak forces in all pins at the longest lever to one, N m: what they would ask of the drive if none met another."""
    pins = [joint for joint in run.machine.joints if isinstance(joint, Pin)]
    lever = max(
        (abs(place.at) for pin in pins for place in (pin.a, pin.b) if place.body != GROUND),
        default=0.0,
    )
    return (
        lever
        * MM
        * sum(float(np.nanmax(np.abs(force), initial=0.0)) for force in forces.reactions.values())
    )


def gripped(hub: SetScrewHub | None, torque: float, plastic: str) -> Borne:
    """HUB_SLIP of a hub on a round shaft: what its set screw holds against the drive's peak torque, N m; where the shaft has a
    flat that turns the hub, by how much it is held along the shaft alone."""
    borne = Borne()
    if hub is None:
        return borne
    bears = materials.of(plastic).bears
    force = hub.force(bears)
    seat = TURNED * force * hub.screw.nominal * MM
    holds = HOLDS * force * hub.bore / 2 * MM
    borne.numbers |= {
        "set_screw_tightened_n_m": seat,
        "set_screw_holds_along_shaft_n": HOLDS * force,
    }
    if not hub.flat:
        borne.numbers["set_screw_holds_n_m"] = holds
        said = (
            f"{hub.thread} tightened with {seat:.3g} N m, {force:.4g} N, as hard as its nut's wall of {plastic} bears "
            f"({bears:g} MPa); a shaft with a flat, or a thicker screw, holds more"
        )
        borne.findings.append(
            at_most(
                "HUB_SLIP",
                torque,
                holds,
                "N m",
                Where(f"set screw, shaft of {hub.bore:g} mm"),
                said,
            )
        )
    return borne


def _on_shaft(run: Run, drives: Mapping[str, Floats]) -> Floats:
    """Torque of all drives on the first one, (n,) N m, by the power that each gives; 0 where it is not known."""
    first, *others = run.machine.drives
    total = drives[first.name]
    rate = first.law(run.theta, 1)
    for each in others:
        power = drives[each.name] * each.law(run.theta, 1) * (MM if each.slide else 1.0)
        total = total + np.where(rate != 0, power / np.where(rate != 0, rate, 1.0), 0.0)
    return np.where(np.isfinite(total), total, 0.0)


def _turning(run: Run, body: str) -> float:
    """Inertia of the driven body about where it turns, its frame's origin, kg m^2."""
    own = run.machine.body(body)
    return own.inertia + own.mass * abs(own.centre * MM) ** 2
