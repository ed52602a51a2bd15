"""The proof: a machine closed on what was measured, at any angle, and what each joint's play and shift do to its outputs.

Newton's method closes all measured joints at once, from where the joints as meant put the bodies; the same Jacobian tells
how far a displacement in each joint moves each output. It knows nothing of loops and dyads, and not what made a curve.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from camgen.judge.cams import judged_angles
from camgen.judge.edges import Engagement
from camgen.judge.joints import Closable, PlateLaw, RollingLaw
from camgen.machine.closing import LoopClosure, close
from camgen.machine.constraints import Constraints
from camgen.machine.model import Cam, Law, Machine
from camgen.numerics import Floats, spread

_KNOWN = 721  # angles at which the machine as meant is closed, from which all others start: half a degree of a turn apart
_SECANTS = 8  # steps towards an output's extreme
_CELLS = 4_000_000  # of what is worked out at a time, 32 MB
_PER_POSE = 40  # cells at each angle for each number of the poses


@dataclass(frozen=True)
class Response:
    """One output at n angles, in its own unit, nan where the machine does not close."""

    value: Any  # (n,), complex for a path
    slope: Any  # to theta, (n,)
    reach: Mapping[
        str, Floats
    ]  # by joint, how far a displacement of 1 mm in it can move the output, (n,)
    play: Floats  # the same by all joints' clearances, either way, worst case, first order, (n,)


Laws = tuple[
    tuple[str, Law], ...
]  # of cams by name, in place of those of the machine: what undercut outlines give


class _NominalMotion:
    """The machine with its joints where they are meant, from which all others start."""

    def __init__(self, machine: Machine, low: float, high: float) -> None:
        self.system = Constraints(machine)
        self._known = close(self.system, np.linspace(low, high, _KNOWN))
        self._systems: dict[Laws, Constraints] = {(): self.system}
        self._seen: dict[tuple[bytes, Laws], Mapping[str, tuple[Any, Any]]] = {}

    def near(self, theta: Floats) -> Floats:
        """Poses from those at the nearest known angle, (n, 3 bodies)."""
        grid = self._known
        k = np.rint(np.interp(theta, grid.theta, np.arange(len(grid.theta)))).astype(int)
        h = (theta - grid.theta[k])[:, None]
        return np.asarray(grid.q[k] + h * (grid.first[k] + 0.5 * h * grid.second[k]))

    def when(self, body: str, angles: Floats) -> Floats:
        """Where between the first and the last angle a body that turns one way alone stands at angles, (n,) rad of any turn."""
        course = np.asarray(self.system.angle(body, self._known.q) + np.zeros(_KNOWN))
        sense = np.sign(course[-1] - course[0])
        if not np.all(sense * np.diff(course) > 0):
            return np.empty(0)
        low = min(course[0], course[-1])
        high = max(course[0], course[-1])
        turns = np.arange(math.floor(low / math.tau), math.floor(high / math.tau) + 1)
        candidates = np.ravel(angles[:, None] % math.tau + math.tau * turns)
        candidates = candidates[(low <= candidates) & (candidates <= high)]
        return np.asarray(np.interp(sense * candidates, sense * course, self._known.theta))

    def outcome(self, output: str, theta: Floats, laws: Laws = ()) -> tuple[Any, Any]:
        """An output and its slope, (n,); they are kept for the other outputs, and the other kinds of files."""
        key = (theta.tobytes(), laws)
        if key in self._seen:
            return self._seen[key][output]
        if laws not in self._systems:
            self._systems[laws] = Constraints(with_laws(self.system.machine, laws))
        system = self._systems[laws]
        closed = [close(system, part, self.near(part), 1) for part in _parts(system, theta)]
        self._seen[key] = {
            each.name: _all_angles(system, each.name, closed) for each in system.machine.outputs
        }
        return self._seen[key][output]


# A machine is the same object for all kinds of its files.
_meant = lru_cache(maxsize=1)(_NominalMotion)


class Proof:
    """A machine on its measured joints, ready at any angle; laws: what its exact outlines give, where that is not meant."""

    def __init__(
        self, nominal: Machine, measured: Closable, theta: Floats, laws: Laws = ()
    ) -> None:
        self.machine = measured.machine
        self.fits = measured.fits
        self._laws = laws
        self.plays = {joint.name: joint.clearance for joint in self.machine.joints}
        self._radii = {name: each.b.radius for name, each in measured.meshings.items()}
        self.plays |= {
            name: fit.play / self._radii.get(name, 1.0) for name, fit in self.fits.items()
        }
        for name, (drive, *others) in measured.outlines.items():
            if others:
                self.plays[name] = min(
                    float(np.max(drive.play(other, judged_angles()))) for other in others
                )
        self._meant = _meant(nominal, float(theta.min()), float(theta.max()))
        self._system = Constraints(measured.machine)
        self._seen: dict[bytes, Mapping[str, Response]] = {}
        self._closed: tuple[bytes, Sequence[LoopClosure]] = (b"", ())
        self._strokes: dict[bytes, Mapping[str, float]] = {}

    def nominal(self, output: str, theta: Floats) -> tuple[Any, Any]:
        """The output and its slope by the joints as they are meant, (n,)."""
        return self._meant.outcome(output, theta)

    def reachable(self, output: str, theta: Floats) -> tuple[Any, Any]:
        """The same less what the spec itself undercuts."""
        return self._meant.outcome(output, theta, self._laws)

    @cached_property
    def corners(self) -> Floats:
        """Angles beside those at which a follower goes from one element of its outline to the next, (n,) rad."""
        cams = [(joint, joint.law) for joint in self.machine.joints if isinstance(joint, Cam)]
        angles = [
            self._meant.when(joint.cam, law.contact.changes + joint.phase)
            for joint, law in cams
            if isinstance(law, RollingLaw)
        ]
        return np.concatenate([np.empty(0), *angles])

    def moved(self, output: str, theta: Floats) -> Response:
        """The output by the joints as they are, (n,)."""
        key = theta.tobytes()
        if key not in self._seen:
            parts = [self._at(part) for part in _parts(self._system, theta)]
            if len(self._seen) > 3:
                del self._seen[
                    next(reversed(self._seen))
                ]  # the judged angles, which came first, stay
            self._seen[key] = {
                each.name: _joined([part[each.name] for part in parts])
                for each in self.machine.outputs
            }
        return self._seen[key][output]

    def outcome(self, output: str, theta: Floats) -> tuple[Any, Any]:
        """Its value and slope alone, (n,)."""
        if theta.tobytes() in self._seen:
            moved = self._seen[theta.tobytes()][output]
            return moved.value, moved.slope
        return _all_angles(self._system, output, self._closed_at(theta))

    def strokes(self, theta: Floats) -> Mapping[str, float]:
        """Difference of each output's extremes, from the judged angles on, (n,)."""
        key = theta.tobytes()
        if key not in self._strokes:
            values = {
                each.name: self.moved(each.name, theta).value for each in self.machine.outputs
            }
            self._strokes[key] = strokes(theta, values, self.outcome)
        return self._strokes[key]

    def _closed_at(self, theta: Floats) -> Sequence[LoopClosure]:
        """The machine closed, part after part; at the angles that were asked for last, as one output after the other does."""
        key = theta.tobytes()
        if self._closed[0] != key:
            parts = _parts(self._system, theta)
            closed = [close(self._system, part, self._meant.near(part), 1) for part in parts]
            self._closed = (key, closed)
        return self._closed[1]

    def _at(self, theta: Floats) -> Mapping[str, Response]:
        """All outputs by the joints as they are, (n,)."""
        closed = close(self._system, theta, self._meant.near(theta), 1)
        poses = np.where(np.isnan(closed.q), 0.0, closed.q)
        levers: dict[str, Any] = dict(self._radii)
        plays: dict[str, Any] = dict(self.plays)
        for joint in self.machine.joints:
            if isinstance(joint, Cam) and isinstance(joint.law, RollingLaw | PlateLaw | Engagement):
                angle = self._system.argument(joint, closed.q)
                angle = np.broadcast_to(angle, theta.shape)
                levers[joint.name] = joint.law.lever(angle)
                if isinstance(joint.law, Engagement):
                    plays[joint.name] = joint.law.play(angle)
        responses = {}
        shares_of_outputs = self._system.shares(
            [output.name for output in self.machine.outputs], poses, theta
        )
        for output, shares in zip(self.machine.outputs, shares_of_outputs, strict=True):
            value, slope, lost = _outcome(self._system, output.name, closed)
            reach = {}
            play = np.zeros(len(theta))
            for joint in self.machine.joints:
                share = np.where(lost, np.nan, shares[joint.name])
                play = play + share * np.maximum(plays[joint.name], 0.0) / 2
                if joint.name in levers or joint.name in self.fits:
                    reach[joint.name] = share / levers.get(joint.name, 1.0)
            responses[output.name] = Response(value, slope, reach, play)
        return responses


def with_laws(machine: Machine, laws: Laws) -> Machine:
    """The machine with other laws of its cams."""
    new = dict(laws)
    joints = (
        replace(joint, law=new.get(joint.name, joint.law)) if isinstance(joint, Cam) else joint
        for joint in machine.joints
    )
    return replace(machine, joints=tuple(joints))


def strokes(
    theta: Floats,
    outputs: Mapping[str, Any],
    both: Callable[[str, Floats], tuple[Any, Any]],
) -> dict[str, float]:
    """Difference of each output's extremes: from its values at theta, (n,) each, then by the secant of its slope. Of a path
    the larger side of its box, from these values alone.

    both: value and slope of an output at angles, (m,). All outputs go on together, so that the machine is closed for all of
    them at once, not for each.
    """
    paths = {name: value for name, value in outputs.items() if np.iscomplexobj(value)}
    found = {name: spread(z) for name, z in paths.items()}
    names = [name for name in outputs if name not in paths]
    if not names:
        return found
    senses = np.tile([1.0, -1.0], len(names))  # of each extreme: the largest, then the least
    sought = [name for name in names for _ in (0, 1)]
    values = np.array([outputs[name] for name in sought])
    k = np.argmax(senses[:, None] * values, axis=1)
    before = np.where(k > 0, theta[k - 1], theta[0] - (theta[1] - theta[0]))
    after = theta[(k + 1) % len(theta)]
    after = np.where(after > theta[k], after, 2 * theta[k] - before)

    def at(angles: Floats) -> tuple[Floats, Floats]:
        """Of each extreme the value, by its sense, and the slope."""
        told = {name: both(name, angles) for name in names}
        value, slope = (
            np.array([told[name][part][row] for row, name in enumerate(sought)]) for part in (0, 1)
        )
        return senses * value, slope

    old = before
    new = after
    old_value, old_slope = at(old)
    new_value, new_slope = at(new)
    best = np.maximum(np.maximum(old_value, new_value), senses * values[np.arange(len(k)), k])
    going = np.ones(len(k), bool)
    for _ in range(_SECANTS):
        with np.errstate(all="ignore"):
            angles = new - new_slope * (new - old) / (new_slope - old_slope)
            # Elsewhere it is on facets, or at the last digits.
            going &= (new_slope != old_slope) & (before <= angles) & (angles <= after)
        if not going.any():
            break
        angles = np.where(going, angles, new)
        value, slope = at(angles)
        best = np.where(going, np.fmax(best, value), best)
        old = new
        old_slope = new_slope
        new = angles
        new_slope = slope
    ends = senses * best
    return found | dict(zip(names, (ends[::2] - ends[1::2]).tolist(), strict=True))


def _parts(system: Constraints, theta: Floats) -> Sequence[Floats]:
    """So few angles at a time that their matrices stay small."""
    return np.array_split(theta, -(-len(theta) * _PER_POSE * max(1, system.width) // _CELLS))


def _joined(parts: Sequence[Response]) -> Response:
    """The same at all angles."""
    reach = {name: np.concatenate([part.reach[name] for part in parts]) for name in parts[0].reach}
    value, slope, play = (
        np.concatenate([getattr(part, key) for part in parts]) for key in ("value", "slope", "play")
    )
    return Response(value, slope, reach, play)


def _all_angles(system: Constraints, output: str, closed: Sequence[LoopClosure]) -> tuple[Any, Any]:
    """An output and its slope to theta, at the angles of all parts."""
    parts = [_outcome(system, output, part) for part in closed]
    return np.concatenate([part[0] for part in parts]), np.concatenate([part[1] for part in parts])


def _outcome(
    system: Constraints, output: str, closed: LoopClosure
) -> tuple[Any, Any, NDArray[np.bool_]]:
    """An output, its slope to theta, and where it is lost, (n,)."""
    value, gradient = system.output(output, closed.q)
    slopes = np.einsum("nkc,nc->nk", gradient, closed.first)
    slope = slopes[:, 0] + 1j * slopes[:, 1] if slopes.shape[1] > 1 else slopes[:, 0]
    lost = np.asarray(np.isnan(closed.q).any(axis=1))
    return np.where(lost, np.nan, value), np.where(lost, np.nan, slope), lost
