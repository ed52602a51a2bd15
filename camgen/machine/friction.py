"""Coulomb friction in the joints of a machine that runs: what rubs, and how the joints' loads feed back on themselves.

    Pin          the reaction passes the axis at the radius of its friction circle, r sin(phi), tan(phi) = mu: a torque of that
                 times the reaction, against the turning of one body in the other   [mech.poriyaan.in, friction circle]
    Slide, Slot  mu times the normal force, against the sliding of the runner; what a moment presses beside it is left out

Loads N of the joints make friction in proportion, and friction loads the joints: N = |R0 + sum N_k R_k|, R_k by unit friction of
joint k. It is followed from no friction to all of it by Newton's method; where it ends on the way, friction locks the machine.
Just before that loads grow without bound: where they are more than tenfold, little more friction locks; it counts as locked.
At rest there is none: forces are those of a motion that goes on.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from camgen.machine.constraints import Constraints
from camgen.machine.model import Machine, Pin, Slide, Slot
from camgen.numerics import Floats, Points, solve

_SHARES = {
    0.5: 2,
    0.75: 2,
    1.0: 20,
}  # of the friction, one after the other, and how many steps of Newton's method at each
_SAME = 1e-9  # of the largest load, by which it may be off
_MOST = 10.0  # times the largest load without friction: what is more is as good as locked
_REST = 1e-9  # of a joint's fastest, below which it stands still


def circle(radius: float, mu: float) -> float:
    """Radius of a journal's friction circle, mm, of one of a radius."""
    return radius * mu / math.hypot(1.0, mu)


def smooth(machine: Machine) -> Machine:
    """The same without friction in its joints."""
    joints = [
        replace(j, friction=0.0) if isinstance(j, Pin | Slide | Slot) and j.friction else j
        for j in machine.joints
    ]
    return replace(machine, joints=tuple(joints))


@dataclass(frozen=True)
class Rubbing:
    """A joint that rubs: how many of its conditions load it, the first of them, and what friction does on the bodies by a load of
    1 N, (n, 3 bodies) N and N mm."""

    row: int
    count: int
    acts: Floats


def rubbing(system: Constraints, q: Floats, rates: Floats) -> list[Rubbing]:
    """All that rubs at poses q and their speeds, (n, 3 bodies)."""
    rubbings = []
    for joint in system.machine.joints:
        if not isinstance(joint, Pin | Slide | Slot) or not joint.friction:
            continue
        acts = np.zeros(q.shape)
        row = system.rows[joint.name].start
        if isinstance(joint, Pin):
            bodies = [
                (system.column[place.body] + 2, sign)
                for place, sign in ((joint.a, 1.0), (joint.b, -1.0))
                if system.column[place.body] >= 0
            ]
            turning = sum((sign * rates[:, k] for k, sign in bodies), np.zeros(len(q)))
            for k, sign in bodies:
                acts[:, k] -= sign * joint.friction * _sense(turning)
        else:
            slopes = system.along(joint.name, q)[1]
            slides = sum((slope * rates[:, k] for k, slope in slopes.items()), np.zeros(len(q)))
            for k, slope in slopes.items():
                acts[:, k] -= joint.friction * _sense(slides) * slope
        rubbings.append(Rubbing(row, 2 if isinstance(joint, Pin) else 1, acts))
    return rubbings


def _sense(speed: Floats) -> Floats:
    return np.where(np.abs(speed) > _REST * np.max(np.abs(speed), initial=0.0), np.sign(speed), 0.0)


def loads(rubs: Sequence[Rubbing], base: Floats, units: Floats) -> tuple[Floats, NDArray[np.bool_]]:
    """Load of each joint that rubs, (n, m) N, and where friction locks, or is near it; base: multipliers without friction,
    (n, rows); units: by a unit load of each, (n, rows, m)."""
    free = _measured(rubs, base[:, :, None])[:, :, 0]
    per = _measured(rubs, units)
    load = np.abs(free)
    scale = np.max(load, axis=1, initial=0.0)
    near = _SAME * scale[:, None]
    sound = np.isfinite(base).all(axis=1)
    for share, steps in _SHARES.items():
        open_ = np.flatnonzero(sound)
        for _ in range(steps):
            step = _step(free[open_], share * per[open_], load[open_])
            load[open_] += step
            open_ = open_[~(np.abs(step) <= near[open_]).all(axis=1)]
            if not open_.size:
                break
    off = np.abs(np.abs(_reactions(free, per, load)) - load)
    valid = ((off <= 1e3 * near) & (load >= -near) & (load <= _MOST * scale[:, None])).all(axis=1)
    return np.maximum(load, 0.0), sound & ~valid


def _reactions(free: Points, per: Points, load: Floats) -> Points:
    """Of all joints with loads, (n, m)."""
    return np.asarray(free + np.einsum("nij,nj->ni", per, load))


def _step(free: Points, per: Points, load: Floats) -> Floats:
    """Of Newton's method, (n, m) N."""
    reaction = _reactions(free, per, load)
    size = np.abs(reaction)
    with np.errstate(all="ignore"):
        toward = np.where(size > 0, np.conj(reaction) / size, 0.0)
        return solve(np.eye(load.shape[1]) - np.real(toward[:, :, None] * per), size - load)


def _measured(rubs: Sequence[Rubbing], rows: Floats) -> Points:
    """The reaction that loads each joint, (n, m, k) complex, of multipliers, (n, rows, k)."""
    reactions = [
        rows[:, each.row] + (1j * rows[:, each.row + 1] if each.count == 2 else 0.0)
        for each in rubs
    ]
    return np.stack(reactions, axis=1).astype(complex)
