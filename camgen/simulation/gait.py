"""A machine that walks, stepped in time by MuJoCo; lengths mm, angles rad, time s.

axes     of the world: x forwards, z up; the frame's: those of the machine
lean     angle of the frame's upright axis to the vertical
share    of the load on the floor that a foot bears
error    of a foot in the frame's axes against the machine closed at the same crank angle: beyond LOOSE a leg has left its
         branch, and the run says nothing
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from camgen.errors import FileError
from camgen.extras import install_line
from camgen.files import mjcf
from camgen.machine.model import MM, Machine
from camgen.machine.run import solve
from camgen.numerics import Floats, Points, from_zero

LOOSE = 0.1  # mm
_SAMPLE = 4e-3  # s
_SETTLING = (
    0.3  # s, before the motor is switched on; and within which a drive of a given speed comes to it
)
_STILL = 1.0  # s, in which a crank that turns less than _CREEP stands
_CREEP = 0.02  # rad
_FALLEN = math.radians(45)  # lean
_SLOWEST = (
    0.2  # of the wanted speed: after the time that the turns take at it nobody waits for more
)


@dataclass(frozen=True, eq=False)
class Gait:
    """One run at one friction; rows of n moments since the motor was switched on, and of the machine's feet."""

    friction: float
    time: Floats  # (n,)
    crank: Floats  # (n,) rad, from the start, forwards positive
    place: Floats  # (n, 3) of the frame's origin
    axes: Floats  # (n, 3, 3), columns: the frame's axes
    load: Floats  # (n, feet) N
    sliding: Floats  # (n, feet) mm/s, speed of a foot on the floor where it touches it
    torque: Floats  # (n,) N m, of the drive
    clearance: Floats  # (n,) mm, of the frame's own parts over the floor
    error: Floats  # (n,) mm
    up: Floats  # (3,) the frame's direction that is up at the start
    wanted: int  # turns
    copy: int = 0  # number of the printed copy, 0: exact

    @property
    def name(self) -> str:
        """What it is a run of."""
        copy = f", copy {self.copy}" if self.copy else ""
        return f"friction {self.friction:g}{copy}"

    @property
    def void(self) -> bool:
        """Whether a leg has left its branch."""
        return bool(np.max(self.error) > LOOSE)

    @property
    def falls(self) -> bool:
        """Whether the frame comes to the floor, or leans by 45 deg."""
        return bool(np.min(self.clearance) <= 0 or np.max(self.lean) >= _FALLEN)

    @property
    def turns(self) -> float:
        """Turns of the crank."""
        return float(self.crank[-1] / math.tau)

    @property
    def stalls(self) -> bool:
        """Whether the crank comes to stand, or takes too long, though the machine does not fall."""
        return not self.falls and self.turns < self.wanted

    @property
    def lean(self) -> Floats:
        """rad, (n,)."""
        return np.arccos(np.clip(self.axes[:, 2] @ self.up, -1, 1))

    @property
    def _ahead(self) -> Floats:
        """The direction of the frame that is forwards at the start: across up and the machine's z."""
        return np.asarray(np.cross(self.up, [0.0, 0.0, 1.0]))

    @property
    def tilt(self) -> Floats:
        """rad, (n,), in the plane of motion, positive where the front rises."""
        return np.arcsin(np.clip(self.axes[:, 2] @ self._ahead, -1, 1))

    @property
    def roll(self) -> Floats:
        """rad, (n,), to the side."""
        return np.arcsin(np.clip(self.axes[:, 2, 2], -1, 1))

    @property
    def heading(self) -> Floats:
        """rad, (n,), in which the frame faces, seen from above, continuous."""
        ahead = np.asarray(self.axes[:, :2] @ self._ahead)
        return np.asarray(np.unwrap(np.arctan2(ahead[:, 1], ahead[:, 0])))

    @property
    def _whole(self) -> Floats:
        """Moments at which whole turns end, the first one's on: before it the machine gets going."""
        counts = np.arange(1, math.floor(self.turns + 1e-9) + 1)
        crank = np.maximum.accumulate(self.crank)
        return np.asarray(np.interp(counts * math.tau, crank, self.time))

    @property
    def judged_turns(self) -> int:
        """Whole turns after the first."""
        return max(len(self._whole) - 1, 0)

    def _between(self, values: Floats) -> Floats:
        """Values at the ends of whole turns."""
        return np.asarray(np.interp(self._whole, self.time, values))

    @property
    def way(self) -> Floats:
        """mm, of each whole turn after the first, in the direction in which it faces."""
        heading = self._between(self.heading)
        middle = (heading[1:] + heading[:-1]) / 2
        x, y = (np.diff(self._between(self.place[:, k])) for k in (0, 1))
        return np.asarray(x * np.cos(middle) + y * np.sin(middle))

    @property
    def way_per_turn(self) -> float:
        """mm, the mean; 0 where it does not come so far."""
        return float(np.mean(self.way)) if self.judged_turns else 0.0

    @property
    def seconds_per_turn(self) -> float:
        """The mean of the same turns; nan without any."""
        return float(np.mean(np.diff(self._whole))) if self.judged_turns else math.nan

    @property
    def turning_per_turn(self) -> float:
        """rad, by which it faces another way after each turn; nan without any."""
        return (
            float(np.mean(np.diff(self._between(self.heading)))) if self.judged_turns else math.nan
        )

    @property
    def slip_per_turn(self) -> float:
        """mm of a turn, that feet slide on the floor, each by its share of the load; nan without any turn."""
        if not self.judged_turns:
            return math.nan
        total = self.load.sum(axis=1)
        share = self.load / np.where(total > 0, total, 1.0)[:, None]
        speed = np.sum(share * self.sliding, axis=1)
        path = from_zero(speed[1:] * np.diff(self.time))
        return float(np.mean(np.diff(self._between(path))))

    @property
    def in_the_air(self) -> float:
        """Share of the time without a foot on the floor."""
        return float(np.mean(self.load.sum(axis=1) == 0))


def engine() -> Any:
    """MuJoCo; FileError that says what to install where it is not there."""
    try:
        import mujoco
    except ImportError:
        raise FileError("a simulation", f"needs mujoco-core: {install_line('simulate')}") from None
    return mujoco


def gait(model: mjcf.Model, machine: Machine, start: float, wanted: int) -> Gait:
    """A run from standstill over so many turns; shorter where the machine falls or stalls.

    machine: closed by camgen; start: its theta at the model's zero, rad.
    """
    run = _Run(engine(), model.bare, model)
    for _ in range(round(_SETTLING / _SAMPLE)):
        run.step(0.0)
    rows = [run.row()]
    begun = run.data.time
    longest = wanted * math.tau / abs(model.motor.speed) / _SLOWEST
    still = round(_STILL / _SAMPLE)
    while run.data.time - begun < longest:
        ramp = 1.0 if model.motor.stall is not None else (run.data.time - begun) / _SETTLING
        run.step(min(1.0, ramp) * model.motor.control)
        rows.append(run.row())
        turned = abs(rows[-1].crank - rows[0].crank)
        stands = len(rows) > still and abs(rows[-1].crank - rows[-still].crank) < _CREEP
        if rows[-1].low <= 0 or stands or turned > wanted * math.tau + _CREEP:
            break
    return _gathered(rows, model, machine, start, wanted)


@dataclass(frozen=True, eq=False)
class _Row:
    """One moment."""

    time: float
    crank: float  # rad, of the drive's joint
    place: Floats
    axes: Floats
    feet: Floats  # (feet, 3) mm, in the world
    load: Floats
    sliding: Floats
    torque: float
    low: float


class _Run:
    """A simulation that goes on, and what is seen of it."""

    def __init__(self, mujoco: Any, bare: mjcf.Model, model: mjcf.Model) -> None:
        self.mujoco = mujoco
        self.simulation = _compiled(mujoco, bare)
        self.data = mujoco.MjData(self.simulation)
        self.rubbing = _Rubbing(mujoco, self.simulation, bare.rubs)
        self.steps = max(1, round(_SAMPLE / bare.step))
        self.motor = model.motor
        names = [foot.name for link in model.links for foot in link.feet]
        self.number = {self.simulation.geom(name).id: k for k, name in enumerate(names)}
        self.frame = self.simulation.body(model.frame.name).id
        self.corners = _corners(model)

    def step(self, control: float) -> None:
        """Go on by a sample."""
        self.data.ctrl[0] = control
        self.mujoco.mj_step(self.simulation, self.data, self.steps)
        self.rubbing.follow(self.data)
        self.mujoco.mj_kinematics(self.simulation, self.data)

    def row(self) -> _Row:
        """What is seen now."""
        data = self.data
        load = np.zeros(len(self.number))
        sliding = np.zeros(len(self.number))
        force = np.zeros(6)
        moving = np.zeros(6)
        for k, contact in enumerate(data.contact):
            geom = next((each for each in contact.geom if each in self.number), None)
            if geom is None:
                continue
            foot = self.number[geom]
            self.mujoco.mj_contactForce(self.simulation, data, k, force)
            body = self.simulation.geom_bodyid[geom]
            kind = self.mujoco.mjtObj.mjOBJ_XBODY
            self.mujoco.mj_objectVelocity(self.simulation, data, kind, body, moving, 0)
            speed = moving[3:] + np.cross(moving[:3], contact.pos - data.xpos[body])
            load[foot] += force[0]
            sliding[foot] = max(sliding[foot], float(np.hypot(*speed[:2])) / MM)
        axes = data.xmat[self.frame].reshape(3, 3).copy()
        place = data.xpos[self.frame] / MM
        feet = data.geom_xpos[list(self.number)] / MM
        low = float(np.min(self.corners @ axes[2]) + place[2])
        joint = data.joint(self.motor.joint)
        return _Row(
            data.time,
            float(joint.qpos[0]),
            place,
            axes,
            feet,
            load,
            sliding,
            float(data.actuator_force[0]),
            low,
        )


def _compiled(mujoco: Any, bare: mjcf.Model) -> Any:
    """The model with a tendon of each loop's pin that rubs, as long as it is turned."""
    spec = mujoco.MjSpec.from_string(mjcf.text(bare))
    for rub in bare.rubs:
        if rub.shares is not None:
            tendon = spec.add_tendon(name=_turn_of(rub))
            for joint, share in rub.shares.items():
                tendon.wrap_joint(joint, share)
    return spec.compile()


def _turn_of(rub: mjcf.Rub) -> str:
    """Name of a tendon."""
    return f"turn of {rub.name}"


class _Rubbing:
    """Friction of pins: a torque against their turning, of their friction circle and the reaction at the last sample."""

    def __init__(self, mujoco: Any, simulation: Any, rubs: Sequence[mjcf.Rub]) -> None:
        self.mujoco = mujoco
        self.simulation = simulation
        hinges = [rub for rub in rubs if rub.shares is None]
        loops = [rub for rub in rubs if rub.shares is not None]
        self.radii = MM * np.array([rub.radius for rub in hinges])
        self.joints = [simulation.joint(rub.name).id for rub in hinges]
        self.loop_radii = MM * np.array([rub.radius for rub in loops])
        self.tendons = [simulation.tendon(_turn_of(rub)).id for rub in loops]
        self.ties = [simulation.equality(rub.name).id for rub in loops]
        beside = [next(iter(rub.shares)) for rub in rubs if rub.shares is not None]
        self.beside = [simulation.joint(name).id for name in beside]  # hinges along the same axes

    def follow(self, data: Any) -> None:
        """Take the reactions as they are now."""
        self.mujoco.mj_rnePostConstraint(self.simulation, data)
        force = data.cfrc_int[self.simulation.jnt_bodyid[self.joints], 3:]
        torque = self.radii * _across(force, data.xaxis[self.joints])
        self.simulation.dof_frictionloss[self.simulation.jnt_dofadr[self.joints]] = torque
        rows = np.flatnonzero(data.efc_type == self.mujoco.mjtConstraint.mjCNSTR_EQUALITY)
        of = data.efc_id[rows]
        pulls = [data.efc_force[rows[of == tie]] for tie in self.ties]
        axes = data.xaxis[self.beside]
        torque = self.loop_radii * _across(np.reshape(pulls, (-1, 3)), axes)
        self.simulation.tendon_frictionloss[self.tendons] = torque


def _across(force: Floats, axis: Floats) -> Floats:
    """How much of forces is square to axes, unit vectors, (n,)."""
    across: Floats = np.linalg.norm(np.cross(force, axis), axis=1)
    return across


def _corners(model: mjcf.Model) -> Floats:
    """Corners of the hull of the frame's parts, (n, 3) mm in its axes."""
    from scipy.spatial import ConvexHull

    vertices = np.concatenate(
        [model.shapes[k].mesh.moved(transform).vertices for _, k, transform in model.frame.copies]
    )
    return np.asarray(vertices[ConvexHull(vertices).vertices])


def _gathered(
    rows: Sequence[_Row], model: mjcf.Model, machine: Machine, start: float, wanted: int
) -> Gait:
    """The moments as columns, and how far feet are from where the machine closes."""
    crank = np.array([row.crank for row in rows])
    rate = float(machine.drives[0].law(np.zeros(1), 1)[0])
    run = solve(machine, start + crank / rate, 0)
    names = [foot.name for link in model.links for foot in link.feet]
    place = np.array([row.place for row in rows])
    axes = np.array([row.axes for row in rows])
    feet = np.array([row.feet for row in rows]) - place[:, None]
    own = np.einsum("nfk,nkj->nfj", feet, axes)
    closed: Points = np.stack([run[name] for name in names], axis=1)
    apart = np.abs(own[:, :, 0] + 1j * own[:, :, 1] - closed)
    sense = math.copysign(1.0, model.motor.speed)
    return Gait(
        model.friction,
        np.array([row.time for row in rows]) - rows[0].time,
        sense * (crank - crank[0]),
        place,
        axes,
        np.array([row.load for row in rows]),
        np.array([row.sliding for row in rows]),
        sense * np.array([row.torque for row in rows]),
        np.array([row.low for row in rows]),
        np.max(np.where(np.isfinite(apart), apart, np.inf), axis=1),
        -np.array(model.down),
        wanted,
    )
