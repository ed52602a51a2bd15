"""What the followers of a machine's cams do by the angle of their cams: for timing diagrams and for drives in their place."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Protocol

import numpy as np

from camgen.findings import Finding, Where, at_most
from camgen.geometry.outlines import Floats
from camgen.machine.model import Cam, Drive, Turning
from camgen.machine.programs import DriveLaw, TableLaw
from camgen.machines.mechanism import Mechanism
from camgen.motion.laws import last_digit
from camgen.numerics import distinct, peak

CODE = "SERVO_TABLE"
NARROWEST = 0.02  # deg, between two rows with velocity: nearer ones do not help, since something jumps between them
_LIMIT = 1e-5  # of the stroke, by which a drive's curve may leave the motion
_SAME_ANGLE = 1e-7  # deg
_PLACES = np.linspace(0, 360, 14_401)
_BESIDE = 1e-7  # deg, from an angle at which a velocity may jump


class DriveTable(Protocol):
    """Rows of a drive's cam table, (n,) each: master, deg, growing; slave; velocity per deg, None where it has none."""

    @property
    def master(self) -> Floats:
        """Angles, deg."""
        ...

    @property
    def slave(self) -> Floats:
        """Places of the follower, mm or deg."""
        ...

    @property
    def velocity(self) -> Floats | None:
        """Per deg of the master."""
        ...

    def curve(self) -> Callable[[Floats, int], Floats]:
        """What the drive makes of it: (master, deg, and order) -> the slave or a derivative per deg."""
        ...


@dataclass(frozen=True)
class FollowerMotion:
    """What a cam's follower does by the angle of its cam, deg from 0 to 360 in the sense of turning.

    unit: "mm" or "deg"; law: (deg, order) -> the follower or its derivative per deg; breaks: deg, where a derivative may jump.
    """

    name: str
    unit: str
    law: Callable[[Floats, int], Floats]
    breaks: Floats

    @cached_property
    def stroke(self) -> float:
        """Way of the follower."""
        return float(np.ptp(self.law(_PLACES, 0)))

    @cached_property
    def corner(self) -> float:
        """The largest jump of its velocity, per deg."""
        before, after = (self.law(self.breaks + side, 1) for side in (-_BESIDE, _BESIDE))
        return peak(after - before) if self.breaks.size else 0.0

    def off(self, curve: Callable[[Floats, int], Floats], order: int = 0) -> float:
        """The most by which another curve leaves it, or a derivative of it, over the turn."""
        return peak(curve(_PLACES, order) - self.law(_PLACES, order))


def table_finding(table: DriveTable, motion: FollowerMotion, path: Path) -> Finding:
    """SERVO_TABLE of a file: how far the drive's curve through its rows leaves the follower, percent of the stroke.

    A corner of the motion between two rows and half of the rows' last digit are allowed besides.
    """
    where = Where(file=path.name, kind=path.suffix[1:], output=motion.name)
    stroke = motion.stroke or 1.0
    first = float(table.master[0])
    last = float(table.master[-1])
    digit = last_digit(list(zip(table.master.tolist(), table.slave.tolist(), strict=True)))
    gap = float(np.diff(table.master).max()) if table.velocity is None else NARROWEST
    limit = _LIMIT + (motion.corner * gap / 4 + digit / 2) / stroke
    if abs(first) + abs(last - 360) > _SAME_ANGLE:
        message = f"from {first:g} to {last:g} deg, not from 0 to 360"
        return at_most(CODE, math.nan, 100 * limit, "percent", where, message)
    off = motion.off(table.curve())
    message = f"off the motion by at most {off:.2g} {motion.unit} of {stroke:.4g} {motion.unit}, of {len(table.master)} rows"
    return at_most(CODE, 100 * off / stroke, 100 * limit, "percent", where, message)


def follower_motions(mechanism: Mechanism) -> Iterator[FollowerMotion]:
    """Those of all cams of a machine that turn; what turns on evenly by its edges, as a cycloidal disc does, has no timing."""
    sense = mechanism.assembly.cycle.sense
    for joint in mechanism.model.joints:
        if isinstance(joint, Cam) and joint.over is None and not isinstance(joint.law, Turning):
            yield _motion(joint, sense)


def table_motions(mechanism: Mechanism) -> Iterator[FollowerMotion]:
    """What a servo drive can make by a table: the followers of all cams, and what motors turn."""
    yield from follower_motions(mechanism)
    yield from motor_motions(mechanism)


def motor_motions(mechanism: Mechanism) -> Iterator[FollowerMotion]:
    """What motors turn by programs or along a line, from their angles at theta = 0."""
    for drive in mechanism.model.drives:
        if _programmed(drive):
            yield _turned(drive)


def motors_together(mechanism: Mechanism) -> Iterator[FollowerMotion]:
    """What all motors of a linkage turn, also those that turn evenly beside one that does not; none where all do."""
    drives = mechanism.model.drives
    if any(map(_programmed, drives)):
        yield from (_turned(each) for each in drives if each.motor or _programmed(each))


def _programmed(drive: Drive) -> bool:
    return isinstance(drive.law, DriveLaw | TableLaw) and drive.slide is None


def _turned(drive: Drive) -> FollowerMotion:
    start = float(drive.law(np.zeros(1), 0)[0])

    def law(x: Floats, order: int) -> Floats:
        x = np.asarray(x, float)
        value = drive.law(np.radians(x.ravel()), order).reshape(x.shape)
        return np.asarray(np.degrees(value - start * (order == 0)) * math.radians(1.0) ** order)

    breaks = drive.law.program.breaks if isinstance(drive.law, DriveLaw) else np.zeros(0)
    return FollowerMotion(drive.name, "deg", law, distinct(np.degrees(breaks) % 360))


def _motion(joint: Cam, sense: int) -> FollowerMotion:
    swings = joint.slide is None
    scale = math.degrees(1.0) if swings else 1.0
    rate = sense * math.radians(1.0)

    def law(x: Floats, order: int) -> Floats:
        x = np.asarray(x, float)
        value = joint.law(rate * x.ravel() - joint.phase, order).reshape(x.shape)
        return np.asarray(scale * rate**order * value)

    breaks = np.asarray(getattr(joint.law, "breaks", ()), float)
    turned = np.degrees(sense * (breaks + joint.phase)) % 360
    return FollowerMotion(joint.name, "deg" if swings else "mm", law, distinct(turned))
