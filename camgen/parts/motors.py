"""Motors by their model: what torque they give at a speed, and how far their shafts reach. Each row has its source.

A stepper's model tells its holding torque, which no stepper gives while it turns; a motor with brushes its torque at stall
and its speed without load, between which its torque falls in a straight line;
an industrial servo its rated torque. A hand turns, too.
"""

from __future__ import annotations

import math
from dataclasses import dataclass


@dataclass(frozen=True)
class Stepper:
    """A row: its frame and holding torque, N m."""

    model: str
    frame: str
    holding: float


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
        # geared 1:64 in the motor; pulls in and holds more than 34.3 mN m [its maker's table, as in many libraries for it]
        Stepper("28BYJ-48", "28byj-48", 0.0343),
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
    """A motor with brushes and its gears: torque at stall, N m, and speed without load, rpm, at this voltage."""

    model: str
    volts: float
    stall: float
    no_load_rpm: float
    source: str


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
        Geared("SG90", 4.8, 1.8 * _KGF_CM, 10 / 0.12, "musefsales.com, servo motor SG90"),
        Geared("MG90S", 4.8, 1.8 * _KGF_CM, 10 / 0.1, "MG90S-Datasheet.pdf of TrDA-hab/Projects"),
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

    def torque(self, speed: float) -> float:
        """What it gives at a speed, rad/s, N m; 0 or less where it does not turn so fast."""
        if abs(speed) > self.fastest:
            return 0.0
        return self.stall * (1 - abs(speed) / self.no_load)


RPM = math.tau / 60  # rad/s


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
        return Motor(row.stall, row.no_load_rpm * RPM, said)
    if model in STEPPERS:
        said = f"{model} holds so much and gives less as it turns"
        return Motor(STEPPERS[model].holding, said=said)
    if model in SERVOS:
        servo = SERVOS[model]
        said = f"rated torque of {model}, up to {servo.fastest_rpm:g} rpm"
        return Motor(servo.rated, said=said, fastest=servo.fastest_rpm * RPM)
    return None


def without_seat(model: str | None, diameter: float) -> tuple[str, ...]:
    """A sentence on a motor of the catalogue that a machine turns without, as its parts have no place for it; none on a hand, or
    an industrial servo, which a coupling joins.

    diameter: of the shaft that is made in its place, mm.
    """
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
