"""What turns the machine: DRIVE_TORQUE, SHAFT_REACH, SELF_LOCKING and HUB_SLIP."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from camgen.findings import Finding, NotJudged, Where, at_least, at_most
from camgen.machine import flywheel
from camgen.machine.forces import Forces
from camgen.machine.model import GROUND, MM, Drive, Pin, Turning
from camgen.machine.run import Run
from camgen.machine.strength import flat_pressure
from camgen.machines.loads.bearing import LoadCheck
from camgen.machines.loads.tables import Drives
from camgen.numerics import Floats, peak
from camgen.parts import materials
from camgen.parts.assembly import FlatSeat, MotorSeat
from camgen.parts.motors import RPM, SHAFTS, Motor, of_model
from camgen.parts.set_screws import HOLDS, TURNED, SetScrewHub
from camgen.study import Figure, Plot

_NOTHING = 1e-12  # N m
_ROUNDING = 1e-9  # of what the forces in the pins could do at the longest lever: a torque below that is rounding, and 0


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
        why = f"the motor's shaft must reach {seat.reach:.4g} mm beyond the motor's face, and motor.shaft_length is not given"
        return LoadCheck(not_judged=[NotJudged("SHAFT_REACH", why, said)])
    remark = f"beyond the motor's face; {said}; thinner parts need less"
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


@dataclass(frozen=True)
class _Motor:
    """A motor and what it gives over theta, (n,), with friction in the joints and without: torque, N m, or on a slide force, N."""

    name: str  # "" of the only one
    drive: Drive
    run: Run
    needed: Floats
    smooth: Floats

    @property
    def power(self) -> float:
        """Mean of what it gives, W."""
        rate = self.drive.law(self.run.theta, 1) * (MM if self.drive.slide else 1.0)
        return flywheel.mean_torque(self.run.theta, self.needed * rate * self.run.machine.speed)

    @property
    def kind(self) -> tuple[str, str]:
        """What it gives, and its unit."""
        return ("force", "N") if self.drive.slide else ("torque", "N m")

    def figure(self, quantity: str, value: float, unit: str) -> Figure:
        """A figure of it, of several with its name."""
        return Figure(f"{quantity} {{of}}" if self.name else quantity, value, unit, self.name)

    @property
    def figures(self) -> list[Figure]:
        """Of its torque or force, and power; none of a slide on which no load, mass or friction is known to act."""
        if self.drive.slide and not np.any(self.needed):
            return []
        kind, unit = self.kind
        mean = flywheel.mean_torque(self.run.theta, self.needed)
        return [
            self.figure(f"drive {kind}", peak(self.needed), unit),
            self.figure(f"drive {kind} mean", mean, unit),
            self.figure("drive power", self.power, "W"),
        ]

    def plot(self, axis: str) -> Plot:
        """What it gives over theta; axis: its label."""
        degrees = np.degrees(self.run.theta)
        curves = [("with friction", degrees, self.needed), ("without", degrees, self.smooth)]
        kind, unit = self.kind
        title = f"{kind.capitalize()} needed" + (f": {self.name}" if self.name else "")
        return Plot(title, axis, unit, curves)

    def findings(self, motor: Motor | None) -> Iterator[Finding]:
        """DRIVE_TORQUE, where it turns, something loads it, and it is known what the motor can give."""
        if motor is None or self.drive.slide or peak(self.needed) < _NOTHING:
            return
        theta = self.run.theta
        worst = int(np.argmax(np.abs(self.needed)))
        rate = float(abs(self.drive.law(theta, 1)[worst] * self.run.machine.speed))
        rpm = f"{rate * 60 / math.tau:.6g} rpm"
        given = max(0.0, motor.torque(rate))
        friction = (
            "with the friction of all joints"
            if np.any(self.needed != self.smooth)
            else "without friction"
        )
        remark = f"needed at {rpm} {friction}; {motor.said}"
        if not given:
            remark = f"{rpm} is faster than what drives it can turn: lower the speed_rpm, or take a faster motor; {motor.said}"
        most = peak(self.needed)
        where = Where(
            self.drive.name if self.name else "drive", theta=float(theta[worst]), angle="", digits=1
        )
        yield at_most("DRIVE_TORQUE", most, given, "N m", where, remark)

    def warnings(self, motor: Motor | None) -> Iterator[str]:
        """What the motor does not do of what is asked of it."""
        if motor is None or self.drive.slide:
            return
        theta = self.run.theta
        speed = peak(self.drive.law(theta, 1)) * abs(self.run.machine.speed)
        yield from motor.warnings(speed, float(np.ptp(self.drive.law(theta, 0))))


def torque(
    run: Run,
    forces: Forces,
    drives: Drives | None,
    axis: str = "crank angle, deg",
    crank: float = 0.0,
    locking: Callable[[], str] = str,
) -> LoadCheck:
    """SELF_LOCKING, torque and power of the machine's drives; those of one motor are one shaft, seen from the first.

    DRIVE_TORQUE is judged where the spec names what turns it; else the torque that is needed is a figure alone. What evens the
    torque is of a machine with one motor.
    axis: label of theta; crank: mm, of the machine's own hand crank, 0: none; locking: of a machine that locks says by
    which friction, and which it would bear.
    """
    check = LoadCheck()
    theta = run.theta
    turn = float(np.ptp(theta))
    if np.any(forces.locks):
        locked = float(np.mean(forces.locks)) * math.degrees(turn)
        remark = (
            f"{locking()}. There no torque moves it, or only one that loads the joints ten times as hard. Use a lower "
            "load.friction, a ball bearing or a greater transmission angle"
        )
        first = float(theta[int(np.argmax(forces.locks))])
        where = Where("drive", theta=first, angle="from", digits=1)
        check.findings.append(
            at_most("SELF_LOCKING", min(locked, math.degrees(turn)), 0.0, "deg", where, remark)
        )
    motors = _motors(run, forces)
    turning = [peak(each.needed) for each in motors if not each.drive.slide]
    if len(motors) > 1 and turning:
        check.figures.append(Figure("drive torque", max(turning), "N m"))
    for each in motors:
        check.figures.extend(each.figures)
        if len(motors) == 1 and not each.drive.slide:
            _even(each, check)
        check.plots.append(each.plot(axis))
        motor = motor_of(drives, crank)
        check.findings.extend(each.findings(motor))
        check.warnings.extend(each.warnings(motor))
    return check


def _motors(run: Run, forces: Forces) -> list[_Motor]:
    """Each motor of a machine, what it gives seen from its first drive."""
    groups: dict[str, list[Drive]] = {}
    for drive in run.machine.drives:
        groups.setdefault(drive.motor or "", []).append(drive)
    motors = []
    for name, drives in groups.items():
        needed = _on_shaft(run, drives, forces.drives)
        smooth = _on_shaft(run, drives, forces.smooth)
        if peak(needed) <= max(_NOTHING, _ROUNDING * _torque_of_pins(run, forces)):
            needed = np.zeros_like(needed)
            smooth = needed
        motors.append(_Motor(name, drives[0], run, needed, smooth))
    return motors


def _even(motor: _Motor, check: LoadCheck) -> None:
    """Add how evenly the one motor's torque is: swing of energy, and a spring that balances it."""
    run = motor.run
    speed = run.machine.speed
    theta = run.theta
    turn = float(np.ptp(theta))
    drive = motor.drive
    needed = motor.needed
    most = peak(needed)
    energy = flywheel.energy_swing(theta, needed * np.sign(speed))
    check.figures.append(Figure("energy swing", energy, "J"))
    if isinstance(drive.law, Turning) and abs(turn - math.tau) < 1e-9 and energy:
        size, place, left = flywheel.spring_on_shaft(drive.law(theta, 0), needed)
        if left < most and size > _ROUNDING * most:
            check.figures += [
                Figure("balance spring", size, "N m"),
                Figure("balance spring at", math.degrees(place), "deg"),
                Figure("drive torque balanced", left, "N m"),
            ]


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
            f"{hub.thread} tightened with {tightened:.3g} N m presses with {force:.4g} N, which is all that the {plastic} behind its nut bears "
            f"({bears:g} MPa); a shaft with a flat, or a thicker screw, holds more"
        )
        where = Where(f"set screw, shaft of {hub.bore:g} mm")
        check.findings.append(at_most("HUB_SLIP", torque, holds, "N m", where, remark))
    return check


def flats_of_shafts(seats: Sequence[FlatSeat], run: Run, forces: Forces, plastic: str) -> LoadCheck:
    """How hard flats press the printed bores that pass the drive's torque on, and where that is more than a print bears, the shear of
    the glue round them; a warning where the glue does not bear it, or where it is not known what it bears.

    A crank pin is taken to pass on by its flats alone, or by its glue, all that its shaft does.
    """
    check = LoadCheck()
    needed = max(
        (peak(each.needed) for each in _motors(run, forces) if not each.drive.slide), default=0.0
    )
    own = materials.of(plastic)
    if not seats or not needed or not own.printed:
        return check
    glued = list[tuple[float, float, FlatSeat]]()
    for number, seat in enumerate(seats):
        drives = [each for each in run.machine.drives if each.name in seat.drives]
        torque = (peak(_on_shaft(run, drives, forces.drives)) if drives else needed) / MM
        pressure = float(flat_pressure(torque, seat.diameter, seat.depth, seat.length))
        if number:
            hole = f"{seat.hole} of {seat.part}"
            check.figures.append(Figure("flat pressure {joint}", pressure, "MPa", joint=hole))
        else:
            check.figures.append(Figure("flat pressure", pressure, "MPa"))
        if pressure > own.bears:
            shear = 2 * torque / (math.pi * seat.diameter**2 * seat.length)
            glued.append((shear, pressure, seat))
    if not glued:
        return check
    shear, pressure, seat = max(glued, key=lambda each: each[0])
    check.figures.append(Figure("glue shear", shear, "MPa"))
    if own.glued is None or shear > own.glued:
        bears = "it is not known what it bears on"
        if own.glued is not None:
            bears = f"it bears {own.glued:g} MPa on"
        check.warnings.append(
            f"The flat of {seat.diameter:g} mm in {seat.hole} of {seat.part} presses its bore with {pressure:.3g} MPa, and {plastic} bears "
            f"{own.bears:g} MPa. Two-part glue all round it takes a shear of {shear:.2g} MPa, and {bears} {plastic}: make the shaft or "
            f"{seat.part} thicker."
        )
    return check


def _on_shaft(run: Run, of: Sequence[Drive], drives: Mapping[str, Floats]) -> Floats:
    """Torque of the drives of one shaft on the first, (n,) N m, by the power that each gives; 0 where it is not known."""
    first, *others = of
    total = drives[first.name]
    rate = first.law(run.theta, 1)
    for each in others:
        power = drives[each.name] * each.law(run.theta, 1) * (MM if each.slide else 1.0)
        total = total + np.where(rate != 0, power / np.where(rate != 0, rate, 1.0), 0.0)
    return np.where(np.isfinite(total), total, 0.0)
