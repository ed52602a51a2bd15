"""The machine in time: SPEED_SWING, RUN_UP with the motor's line, stall, and the flywheels for a wanted swing."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from camgen.findings import NotJudged, Where, at_most
from camgen.machine.model import Resistance, Turning
from camgen.machine.run import Run, solve
from camgen.machine.run_up import (
    MOST_TURNS,
    NEAR,
    Course,
    MotorLine,
    ShaftLoad,
    mean_speed,
    swing_of,
)
from camgen.machines.loads.bearing import LoadCheck
from camgen.machines.loads.drive import motor_of
from camgen.machines.loads.tables import Drives
from camgen.numerics import Floats
from camgen.parts.journals import DriveLimits
from camgen.parts.motors import RPM
from camgen.study import Figure, Plot

_SHOWN = (0.02, 0.1)  # swings of the speed whose flywheels are figures
_SLOW = 1e-6  # of the speed, at which inertia and damping do nothing
_MOST = 360  # angles of a turn
_TURNED = 1e-9  # rad, by which a period may be off whole turns


def running(
    run: Run,
    drives: Drives | None,
    asked: DriveLimits,
    angle: str = "crank angle",
    crank: float = 0.0,
) -> LoadCheck:
    """How the speed of a machine that turns all round swings, and how it runs up where its motor has a line.

    run: with masses, loads and friction, over whole turns; angle: what theta is called; crank: mm, of its own hand crank, 0: none.
    """
    check = LoadCheck()
    machine = run.machine
    if not _turns(run):
        return _not_judged(
            asked, "it is not one motor that turns evenly all round", "a drive that does"
        )
    load = shaft_load(run)
    if not np.all(np.isfinite(load.still + load.inertial)):
        return _not_judged(
            asked, "friction locks the machine, or it does not close", "SELF_LOCKING"
        )
    if drives is not None:
        load = load.with_flywheel(drives.flywheel_kg_m2)
    if np.min(load.inertia) <= 0:
        return _not_judged(asked, "no mass of the machine is known", "masses")
    motor = motor_of(drives, crank)
    mean = abs(machine.speed)
    speeds: Floats | None = None
    if motor is None or math.isinf(motor.no_load):
        why = "the spec does not say how the motor's torque falls with its speed"
        needs = "motor.stall_torque_n_m with no_load_rpm, or a motor.model with brushes"
        if asked.run_up is not None:
            check.not_judged.append(NotJudged("RUN_UP", why, needs))
        speeds = load.even_torque(mean)
        by = "under a motor that gives the mean torque at all angles"
    else:
        line = MotorLine(motor.stall, motor.no_load)
        begin = float(run.theta[0 if machine.speed > 0 else -1])
        start = _Start(begin, math.copysign(1.0, machine.speed), angle)
        speeds = _run_up(load, line, asked, start, check)
        by = f"with the motor's line; {motor.said}"
        mean = mean if speeds is None else mean_speed(speeds)
    check.figures.append(Figure("turning inertia", float(np.mean(load.inertia)), "kg m²"))
    for share in _SHOWN:
        quantity = f"flywheel for {100 * share:g} percent"
        check.figures.append(Figure(quantity, load.flywheel_for(share, mean), "kg m²"))
    if speeds is None:
        return check
    swing = swing_of(speeds)
    lined = motor is not None and math.isfinite(motor.no_load)
    if lined or asked.speed_swing is not None or (drives is not None and drives.flywheel_kg_m2):
        check.figures.append(Figure("speed swing", swing))
    if asked.speed_swing is not None:
        more = load.flywheel_for(asked.speed_swing, mean)
        message = f"at {mean / RPM:.4g} rpm, {by}; a flywheel with {more:.4g} kg m^2 more keeps within the limit"
        check.findings.append(
            at_most("SPEED_SWING", swing, asked.speed_swing, "share", Where("drive"), message)
        )
    return check


def shaft_load(run: Run) -> ShaftLoad:
    """What a machine asks of its shaft, in the sense in which theta moves; nan where friction locks it or it does not close."""
    turns = float(np.ptp(run.theta)) / math.tau
    every = max(1, round((run.theta.size - 1) / (_MOST * turns)))
    run = run if every == 1 else solve(run.machine, run.theta[::every])
    speed = run.machine.speed
    sense = -1 if speed < 0 else 1
    forces = run.forces()

    def torque(share: float) -> Floats:
        """At a share of the speed, (n,) N m."""
        at = forces if share == 1 else run.forces_at(share * speed)
        return (at.power_in - at.power) / abs(share * speed)

    still = torque(_SLOW)
    damping = np.zeros_like(still)
    if any(isinstance(each, Resistance) and each.damping for each in run.machine.loads):
        damping = (4 * torque(0.5) - 3 * still - torque(1)) / abs(speed)  # a parabola through both
    inertial = ((torque(1) - still) / abs(speed) - damping) / abs(speed)
    rows = (2 * forces.energy / speed**2, still, damping, inertial)
    own = [np.ascontiguousarray(row[::sense][:-1]) for row in rows]
    return ShaftLoad(float(np.ptp(run.theta)), *own)


@dataclass(frozen=True)
class _Start:
    """Where the shaft stands at rest, rad of theta, in which sense it turns, 1 or -1, and what theta is called."""

    theta: float
    sense: float
    angle: str

    def after(self, turned: float) -> float:
        """Theta, within a turn, after the shaft has turned, rad."""
        return (self.theta + self.sense * turned) % math.tau


def _run_up(
    load: ShaftLoad, motor: MotorLine, asked: DriveLimits, start: _Start, check: LoadCheck
) -> Floats | None:
    """Add RUN_UP, its figures and its curve, and give the speed over the period once it has run up; None where it stalls."""
    needed = float(np.max(load.still))
    check.figures.append(Figure("starting torque", needed, "N m"))
    settled = load.settled(motor)
    course = load.run_up(motor, settled)
    time = float(course.time[-1])
    where = Where("drive")
    message = f"from rest to {100 * NEAR:g} % of the speed that it settles to at the same angle"
    if settled is None:
        stop = start.after(float(course.angle[-1]))
        where = Where("drive", theta=stop, angle=start.angle, digits=1)
        check.figures.append(Figure("stalls at", math.degrees(stop), "deg"))
        message = (
            f"it stalls; from rest at any angle it turns with {needed:.4g} N m at standstill, it has {motor.stall:.4g}; "
            "a start elsewhere, less load or less friction may do"
        )
        check.notes.append(
            f"The machine stalls at {start.angle} {math.degrees(stop):.1f} deg as it starts from rest; "
            f"a motor with {needed:.4g} N m at standstill starts it at any angle."
        )
        time = math.inf
    else:
        speed = mean_speed(settled) / RPM
        message += f", {speed:.4g} rpm in the mean"
        check.figures.append(Figure("settled speed", speed, "rpm"))
        if course.angle[-1] >= MOST_TURNS * load.period:
            message += f"; not within {MOST_TURNS} turns"
            time = math.inf
        else:
            check.figures.append(Figure("run up time", time, "s"))
    check.plots.append(_curve(course, settled))
    if asked.run_up is not None:
        check.findings.append(at_most("RUN_UP", time, asked.run_up, "s", where, message))
    return settled


def _curve(course: Course, settled: Floats | None) -> Plot:
    """The speed as it runs up, over time, and the limits between which it swings then."""
    curves = [("runs up", course.time, course.speed / RPM)]
    if settled is not None:
        ends = course.time[[0, -1]]
        for name, speed in (
            ("settled, greatest", np.max(settled)),
            ("settled, least", np.min(settled)),
        ):
            curves.append((name, ends, np.full(2, speed / RPM)))
    return Plot("Speed of the shaft from rest", "time, s", "rpm", curves)


def _turns(run: Run) -> bool:
    """Whether one shaft alone drives, turns as theta does, and the run is over whole turns."""
    drive = run.machine.drives[0]
    turned = float(np.ptp(run.theta))
    whole = math.tau * max(1, round(turned / math.tau))
    even = isinstance(drive.law, Turning) and abs(drive.law.rate) == 1 and not drive.slide
    alone = len({each.motor for each in run.machine.drives}) == 1
    return alone and even and abs(turned - whole) <= _TURNED


def _not_judged(asked: DriveLimits, why: str, needs: str) -> LoadCheck:
    """Of what is asked."""
    limits = (("RUN_UP", asked.run_up), ("SPEED_SWING", asked.speed_swing))
    return LoadCheck(
        not_judged=[NotJudged(code, why, needs) for code, limit in limits if limit is not None]
    )
