"""Motors by their model: what torque they give at a speed, and how far their shafts reach. Each row has its source.

A stepper's model tells its holding torque, which no stepper gives while it turns; a motor with brushes its torque at stall
and its speed without load, between which its torque falls in a straight line;
an industrial servo its rated torque. A hand turns, too.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass


@dataclass(frozen=True)
class Stepper:
    """A row: its frame and holding torque, N m, and the speed that its maker promises, rpm, where that is known."""

    model: str
    frame: str
    holding: float
    promised_rpm: float = math.inf


# Holding torques: Klipper's motor data base (klippy/extras/motor_database of its TMC autotune), as their makers give them.
STEPPERS = {
    row.model: row
    for row in (
        Stepper("42STH48-2004AC", "nema-17", 0.59),
        Stepper("42STH40-1004A", "nema-17", 0.49),
        Stepper("42STH20", "nema-17", 0.18),
        Stepper("35STH48", "nema-14", 0.40),
        Stepper("17HS19-2004S1", "nema-17", 0.59),
        Stepper("17HS24", "nema-17", 0.65),
        # geared 1:64 in the motor; pulls in and holds more than 34.3 mN m, and follows 1000 steps a second of 5.625/64 deg without
        # load [its maker's table, as in many libraries for it, which let it turn at 15 rpm at most]
        Stepper("28BYJ-48", "28byj-48", 0.0343, 1000 * 5.625 / 64 / 6),
    )
}


def models_of(frame: str) -> tuple[str, ...]:
    """Models of the catalogue with a frame, such as "nema-17"."""
    return tuple(row.model for row in STEPPERS.values() if row.frame == frame)


_CELL_VOLTS = 1.5
# Cells that holders take: length and diameter at most, mm, the largest first [IEC 60086-2, R6 and R03].
_CELLS = {"AA": (50.5, 14.5), "AAA": (44.5, 10.5)}


def cells(volts: float, length: float, width: float) -> str:
    """Which cells a holder of a size, mm, takes side by side for a voltage, such as "4 AAA"; "" where none fit."""
    count = round(volts / _CELL_VOLTS)
    if not count or abs(count * _CELL_VOLTS - volts) > 0.01:
        return ""
    short, long = sorted((length, width))
    fits = (
        name
        for name, (high, across) in _CELLS.items()
        if (high <= long and count * across <= short) or (high <= short and count * across <= long)
    )
    kind = next(fits, "")
    return f"{count} {kind}" if kind else ""


_KGF_CM = 0.0980665  # N m


@dataclass(frozen=True)
class Geared:
    """A motor with brushes and its gears: torque at stall, N m, and speed without load, rpm, at this voltage; of a servo how far it
    swings, deg."""

    model: str
    volts: float
    stall: float
    no_load_rpm: float
    source: str
    swing_deg: float = math.inf


# Of all models below: no drawing of their makers could be opened. Three public models of an SG90
# have its holes 27.5, 27.9 and 28.5 mm apart [nnarain/openscad-servos, kartchnb/openscad-servo-library, mariolukas/openexposer].
HOLES_UNKNOWN = "measure its mounting holes: no maker's drawing was found"
_POLOLU = "Pololu, Micro Metal Gearmotors, rev 2.0: low power, stall by extrapolation"
GEARED = {
    row.model: row
    for row in (
        Geared("TT-1:48", 6.0, 0.4 * _KGF_CM, 200.0, "zbotic.in, TT gear motor for robot car"),
        Geared("N20-100:1", 6.0, 0.74 * _KGF_CM, 130.0, _POLOLU),
        Geared("N20-298:1", 6.0, 2.0 * _KGF_CM, 45.0, _POLOLU),
        Geared("N20-1000:1", 6.0, 5.5 * _KGF_CM, 13.0, _POLOLU),
        # servos turn to and fro by half a turn; their speed is that of 60 deg in so many seconds
        Geared("SG90", 4.8, 1.8 * _KGF_CM, 10 / 0.12, "musefsales.com, servo motor SG90", 180.0),
        Geared(
            "MG90S", 4.8, 1.8 * _KGF_CM, 10 / 0.1, "MG90S-Datasheet.pdf of TrDA-hab/Projects", 180.0
        ),
    )
}


@dataclass(frozen=True)
class Servo:
    """An industrial servo: its rated torque, N m, three times as much for a moment, and its greatest speed, rpm."""

    model: str
    rated: float
    fastest_rpm: float


SERVOS = {
    row.model: row
    for row in (  # Yaskawa, Sigma II User's Manual, 8.1.4 and 3.1
        Servo("SGMSH-10A", 3.18, 5000.0),  # 1 kW
        Servo("SGMAH-01AJC", 5.34, 190.0),  # 100 W, geared 1:21
    )
}

HAND_CRANK = "hand crank"
# N, on the knob of a small crank that is turned fast [Ivergard, Hunt: Handbook of Control Room Design and Ergonomics, 5.3.4]
_HAND = 22.0
_HAND_RPM = 120.0  # two turns a second: an estimate
_KNOB = 25.0  # mm, from the shaft, where the machine has no crank of its own

# Usual shafts of motor frames: diameter and length over the face, mm.
SHAFTS = {
    "nema-8": (4.0, 6.0),
    "nema-14": (5.0, 21.0),
    "nema-17": (5.0, 24.0),
    "nema-23": (6.35, 24.0),
    "28byj-48": (5.0, 10.0),  # [studiopieters.nl/stepper-motor: shaft and bearing]
}


@dataclass(frozen=True)
class Motor:
    """How much torque a motor gives."""

    stall: float  # torque at standstill, N m
    no_load: float = math.inf  # speed without load, rad/s; inf where none is given
    said: str = ""  # what a message says of the torque
    fastest: float = math.inf  # rad/s, beyond which it gives none
    model: str = ""  # of the catalogue
    promised: float = math.inf  # rad/s, the greatest speed that its maker promises
    swing: float = math.inf  # rad, through which a servo turns

    def torque(self, speed: float) -> float:
        """What it gives at a speed, rad/s, N m; 0 or less where it does not turn so fast."""
        if abs(speed) > self.fastest:
            return 0.0
        return self.stall * (1 - abs(speed) / self.no_load)

    def warnings(self, speed: float, travel: float) -> Iterator[str]:
        """What it does not do of what a drive asks: its greatest speed, rad/s, and how far it turns, rad."""
        named = f'motor.model = "{self.model}"'
        if speed > self.promised + _ROUNDING:
            yield (
                f"{named} is to turn at {speed / RPM:.4g} rpm, and its maker promises {self.promised / RPM:.3g} rpm without load: "
                "it may stall. Lower the speed_rpm, or take a faster motor"
            )
        if travel > self.swing + _ROUNDING:
            yield (
                f"{named} is a servo, which swings through {math.degrees(self.swing):g} deg, and is to turn {math.degrees(travel):.4g} deg: "
                "let a linkage go to and fro by drive.range_deg, or take a gearmotor, or a continuous servo by "
                "motor.stall_torque_n_m and motor.no_load_rpm"
            )


RPM = math.tau / 60  # rad/s
_ROUNDING = 1e-9  # rad, or rad/s


def of_model(model: str | None, crank: float) -> Motor | None:
    """What a model of the catalogue gives, or a hand; None of none.

    crank: mm, from the shaft to the knob of the machine's own hand crank: a hand drives, whatever the model, for which such a
    machine has no seat; 0: it has none.
    """
    if crank or model == HAND_CRANK:
        knob = crank or _KNOB
        said = f"a hand gives {_HAND:g} N at a knob {knob:g} mm from the shaft, up to {_HAND_RPM:g} rpm"
        if model not in (None, HAND_CRANK):
            said += f"; the machine has a hand crank and no seat for {model}"
        return Motor(_HAND * knob / 1000, said=said, fastest=_HAND_RPM * RPM)
    if model in GEARED:
        row = GEARED[model]
        said = f"{model} at {row.volts:g} V, from {row.stall:.3g} N m at stall to {row.no_load_rpm:.3g} rpm without load"
        return Motor(
            row.stall, row.no_load_rpm * RPM, said, model=model, swing=math.radians(row.swing_deg)
        )
    if model in STEPPERS:
        said = f"{model} holds so much and gives less as it turns"
        stepper = STEPPERS[model]
        return Motor(stepper.holding, said=said, model=model, promised=stepper.promised_rpm * RPM)
    if model in SERVOS:
        servo = SERVOS[model]
        said = f"rated torque of {model}, up to {servo.fastest_rpm:g} rpm"
        return Motor(servo.rated, said=said, fastest=servo.fastest_rpm * RPM)
    return None


def without_seat(model: str | None, diameter: float, crank: float = 0.0) -> tuple[str, ...]:
    """A sentence on a motor of the catalogue that a machine turns without, as its parts have no place for it; none on a hand, or
    an industrial servo, which a coupling joins.

    diameter: of the shaft that is made in its place, mm; crank: mm, of the machine's own hand crank, 0: none.
    """
    if crank and model not in (None, HAND_CRANK):
        return (
            f'motor.model = "{model}" is not used: parts.hand_crank = {crank:g} has the machine turned by hand, and DRIVE_TORQUE is '
            'judged by that. Write motor.model = "hand crank", or parts.hand_crank = 0 and a seat for the motor',
        )
    if model in STEPPERS:
        frame = STEPPERS[model].frame
        remedy = f'Set parts.motor = "{frame}" for a seat, and a shaft of {SHAFTS[frame][0]:g} mm'
    elif model in GEARED:
        remedy = "Set parts.can, with the motor's sizes, for a seat"
    else:
        return ()
    return (
        f'The parts have no seat for motor.model = "{model}". {remedy}; or couple the motor to the machine\'s shaft of '
        f"{diameter:g} mm, below the plate",
    )
