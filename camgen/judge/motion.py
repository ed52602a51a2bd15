"""The judge of machines: closed on what was measured, moved, and compared with what is wanted, output by output.

It knows nothing of loops and dyads, and not what made a curve. Newton's method closes all measured joints at once, from
where the joints as meant put the bodies; the same Jacobian tells how far a displacement in each joint moves each output.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property, lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from camgen import tolerances
from camgen.findings import Finding, NotJudged, at_most
from camgen.judge.joints import Between, Closable, Fit, Rolled, assembled
from camgen.judge.measured import Sections, read
from camgen.machine.closure import Closed, System
from camgen.machine.features import Asked, Feature, Mount
from camgen.machine.model import Angle, Cam, Machine, Output
from camgen.machine.study import Table

Floats = NDArray[np.float64]

_RANGE = 0.5  # of an output's range: with more play a mechanism is none
_ROUNDING = 1e-10  # mm or rad, of an output that no joint moves, such as the driven link's angle
_KNOWN = 721  # angles at which the machine as meant is closed, from which all others start: half a degree of a turn apart
_CELLS = 4_000_000  # of the matrices of all angles at a time, 32 MB
# Cam angles at which a follower between two outlines is looked at, rad.
_ROUND: Floats = np.asarray((np.arange(3600) + 0.381966) * (2 * math.pi / 3600), float)
COLUMNS = ("joint", "play, mm", "meant, mm", "centres off, mm")


def unit_of(output: Output) -> tuple[str, float]:
    """What people read an output in, and how many of it one unit of it is."""
    return ("deg", math.degrees(1)) if isinstance(output.of, Angle) else ("mm", 1.0)


@dataclass(frozen=True)
class Moved:
    """One output at n angles, in its own unit: value (complex for a path) and slope to theta, (n,), nan where the machine does
    not close; reach: by joint, how far a displacement of 1 mm in it can move the output, (n,); play: the same by what all
    joints' clearances give either way, worst case, first order."""

    value: Any
    slope: Any
    reach: Mapping[str, Floats]
    play: Floats


class _Meant:
    """The machine with its joints where they are meant, from which all others start."""

    def __init__(self, machine: Machine, low: float, high: float) -> None:
        self.system = System(machine)
        self._known = self.system.close(np.linspace(low, high, _KNOWN))
        self._seen: dict[tuple[str, bytes], tuple[Any, Any]] = {}

    def near(self, theta: Floats) -> Floats:
        """Poses from those at the nearest known angle, (n, 3 bodies)."""
        known = self._known
        k = np.rint(np.interp(theta, known.theta, np.arange(len(known.theta)))).astype(int)
        h = (theta - known.theta[k])[:, None]
        return np.asarray(known.q[k] + h * (known.first[k] + 0.5 * h * known.second[k]))

    def outcome(self, output: str, theta: Floats) -> tuple[Any, Any]:
        """An output and its slope, (n,); those at many angles are kept for the other kinds of files."""
        key = (output, theta.tobytes())
        if key in self._seen:
            return self._seen[key]
        parts = [_outcome(self.system, output, self.system.close(part, self.near(part))) for part in _parts(self.system, theta)]
        found = np.concatenate([part[0] for part in parts]), np.concatenate([part[1] for part in parts])
        if len(theta) > _KNOWN:
            self._seen[key] = found
        return found


# A machine is the same object for all kinds of its files.
_meant = lru_cache(maxsize=1)(_Meant)


class Proof:
    """A machine on its measured joints, ready at any angle."""

    def __init__(self, nominal: Machine, measured: Closable, theta: Floats) -> None:
        self.machine, self.fits = measured.machine, measured.fits
        self.plays = {joint.name: joint.clearance for joint in self.machine.joints}
        self._radii = measured.radii
        self.plays |= {name: fit.play / self._radii.get(name, 1.0) for name, fit in self.fits.items()}
        self.plays |= {name: min(float(np.max(b.play(_ROUND))) for b in held) for name, held in measured.between.items()}
        self._meant, self._system = _meant(nominal, float(theta.min()), float(theta.max())), System(measured.machine)
        self._seen: dict[bytes, Mapping[str, Moved]] = {}

    def wanted(self, output: str, theta: Floats) -> tuple[Any, Any]:
        """The output and its slope by the joints as they are meant, (n,)."""
        return self._meant.outcome(output, theta)

    def moved(self, output: str, theta: Floats) -> Moved:
        """The output by the joints as they are, (n,)."""
        key = theta.tobytes()
        if key not in self._seen:
            parts = [self._at(part) for part in _parts(self._system, theta)]
            if len(self._seen) > 3:
                del self._seen[next(reversed(self._seen))]  # the judged angles, which came first, stay
            self._seen[key] = {each.name: _joined([part[each.name] for part in parts]) for each in self.machine.outputs}
        return self._seen[key][output]

    def _at(self, theta: Floats) -> Mapping[str, Moved]:
        """All outputs by the joints as they are, (n,)."""
        closed = self._system.close(theta, self._meant.near(theta))
        poses = np.where(np.isnan(closed.q), 0.0, closed.q)
        levers: dict[str, Any] = dict(self._radii)
        levers |= {
            joint.name: joint.law.lever(np.broadcast_to(self._system.angle(joint.cam, closed.q) - joint.phase, theta.shape))
            for joint in self.machine.joints
            if isinstance(joint, Cam) and isinstance(joint.law, Rolled)
        }
        found = {}
        for output in self.machine.outputs:
            value, slope, lost = _outcome(self._system, output.name, closed)
            shares = self._system.shares(output.name, poses, theta)
            reach, play = {}, np.zeros(len(theta))
            for joint in self.machine.joints:
                share = np.where(lost, np.nan, shares[joint.name])
                play = play + share * max(self.plays[joint.name], 0.0) / 2
                if joint.name in levers or joint.name in self.fits:
                    reach[joint.name] = share / levers.get(joint.name, 1.0)
            found[output.name] = Moved(value, slope, reach, play)
        return found


def _parts(system: System, theta: Floats) -> Sequence[Floats]:
    """So few angles at a time that their matrices stay small."""
    return np.array_split(theta, -(-len(theta) * max(1, system.width**2) // _CELLS))


def _joined(parts: Sequence[Moved]) -> Moved:
    """The same at all angles."""
    reach = {name: np.concatenate([part.reach[name] for part in parts]) for name in parts[0].reach}
    value, slope, play = (np.concatenate([getattr(part, key) for part in parts]) for key in ("value", "slope", "play"))
    return Moved(value, slope, reach, play)


def _outcome(system: System, output: str, closed: Closed) -> tuple[Any, Any, NDArray[np.bool_]]:
    """An output, its slope to theta, and where it is lost, (n,)."""
    value, gradient = system.output(output, closed.q, closed.theta)
    slopes = np.einsum("nkc,nc->nk", gradient, closed.first)
    slope = slopes[:, 0] + 1j * slopes[:, 1] if slopes.shape[1] > 1 else slopes[:, 0]
    lost = np.asarray(np.isnan(closed.q).any(axis=1))
    return np.where(lost, np.nan, value), np.where(lost, np.nan, slope), lost


@dataclass(frozen=True)
class Verdict:
    """Findings, numbers and a table of what each joint does to the outputs, from one kind of file.

    proof: the machine closed on its files, None where it cannot be; not_judged: what counts as meant, since no file has it.
    """

    findings: tuple[Finding, ...]
    numbers: Mapping[str, float] = field(default_factory=dict)
    table: Table | None = None
    proof: Proof | None = None
    not_judged: tuple[NotJudged, ...] = ()


def judge_machine(
    kind: str,
    where: str,
    files: Mapping[str, Sections],
    machine: Machine,
    features: Sequence[Feature],
    mounts: Sequence[Mount],
    theta: Floats,
    chord_tolerance: float,
    slack: float = 0.0,
    asked: Sequence[Asked] = (),
) -> Verdict:
    """Fits, and every output of the machine closed on the measured features, against the wanted ones.

    kind: "dxf", "stl" or "3mf"; where: said in findings; files: sections (shapes at each height) of each part's file of this
    kind, by part; theta: judged values of the machine's own variable, (n,) rad; chord_tolerance: mm, of outlines and facets;
    slack: mm, what the way back from a print compensation may cost a fit; asked: more than the motion, by output.

    PIN_GAP: the joint that fits worst. MOTION_ERROR, STROKE_ERROR, LASH: the output that comes worst off against its own
    limit; that of motion and stroke is what one joint's centre off by the chord tolerance, or all outlines, can do.
    """
    found = read(features, files, kind == "dxf")
    if found.lost:
        return Verdict((at_most("PIN_GAP", math.nan, 0, "mm", where, "; ".join(found.lost)),))
    try:
        measured = assembled(machine, features, mounts, found)
        proof = Proof(machine, measured, theta)
    except ValueError as fault:
        return Verdict((at_most("MOTION_ERROR", math.nan, 0, "mm", where, str(fault)),))
    rounding = 0.0 if kind == "dxf" else tolerances.FLOAT32_ROUNDING * _size(files)
    findings = [_fit(measured.fits, 2 * chord_tolerance + 4 * rounding + slack, where)] if measured.fits else []
    held = [(name, each) for name, pairs in measured.between.items() for each in pairs]
    findings += [_overlap(name, each, machine, chord_tolerance + 2 * rounding, where) for name, each in held]
    wishes = {each.output: each for each in asked}
    judged = [
        _Judged(output, wishes.get(output.name, Asked(output.name)), proof, theta, chord_tolerance, rounding)
        for output in machine.outputs
    ]
    alone = len(judged) == 1
    numbers: dict[str, float] = {}
    for each in judged:
        numbers |= each.numbers(kind, "" if alone else f"{each.output.name.replace(' ', '_')}_")
    findings.append(max(judged, key=lambda each: each.error / each.limit).motion(where, alone))
    nominal = tuple(
        NotJudged("PIN_GAP", f"{joint.name} counts as meant: no file shows it", "files that show it")
        for joint in machine.joints
        if joint.name not in {getattr(feature, "joint", None) for feature in features}
    )
    if any(math.isinf(each.error) for each in judged):
        return Verdict(tuple(findings), numbers, not_judged=nominal)
    findings.append(max(judged, key=lambda each: 2 * each.band / each.lash[0] if each.lash[0] else math.inf).play(where, alone))
    strokes = [each for each in judged if each.asked.stroke]
    if strokes:
        findings.append(max(strokes, key=lambda each: abs(each.made - each.meant) / each.limit).stroke(where, alone))
    return Verdict(tuple(findings), numbers, _table(kind, judged, proof), proof, nominal)


class _Judged:
    """One output against the wanted one."""

    def __init__(
        self, output: Output, asked: Asked, proof: Proof, theta: Floats, chord_tolerance: float, rounding: float
    ) -> None:
        self.output, self.asked, self.proof, self.theta = output, asked, proof, theta
        self.unit, self.scale = unit_of(output)
        self.moved = proof.moved(output.name, theta)
        self.reach = {name: float(np.nanmax(reach, initial=0.0)) for name, reach in self.moved.reach.items()}
        outlines = sum(self.reach[j.name] for j in proof.machine.joints if isinstance(j, Cam) and j.name in self.reach)
        one = max([*self.reach.values(), outlines], default=0.0)
        limit = chord_tolerance * one * (1 + tolerances.BOUND_SPARE) + 2 * rounding * sum(self.reach.values())
        self.limit = max(limit, _ROUNDING)
        self.off = np.abs(self.moved.value - self.wanted(theta)[0])
        self.off[np.isnan(self.off)] = np.inf
        self.worst = int(np.argmax(self.off))
        self.error = float(self.off[self.worst])

    def wanted(self, theta: Floats) -> tuple[Any, Any]:
        """The wanted value and slope, (n,)."""
        motion = self.asked.motion
        return self.proof.wanted(self.output.name, theta) if motion is None else (motion(theta, 0), motion(theta, 1))

    def recovered(self, theta: Floats) -> tuple[Any, Any]:
        """The same as the files give it."""
        moved = self.proof.moved(self.output.name, theta)
        return moved.value, moved.slope

    @cached_property
    def band(self) -> float:
        """Largest play either way."""
        return float(np.max(self.moved.play))

    @cached_property
    def made(self) -> float:
        """Difference of the extremes as the files give it."""
        return _stroke(self.theta, self.moved.value, self.recovered)

    @cached_property
    def meant(self) -> float:
        """The same as it is wanted."""
        return _stroke(self.theta, self.wanted(self.theta)[0], self.wanted)

    @property
    def lash(self) -> tuple[float, str]:
        """The play that is borne, and why no more."""
        half = self.made * _RANGE
        if self.asked.lash < half:
            return self.asked.lash, "limits.lash"
        return half, "half of the stroke: with more it is no mechanism"

    def numbers(self, kind: str, name: str) -> dict[str, float]:
        """Figures of the report."""
        unit, scale = self.unit, self.scale
        found = {f"motion_error_{name}{kind}_{unit}": scale * self.error}
        if math.isfinite(self.error):
            found[f"clearance_band_{name}{kind}_{unit}"] = scale * self.band
            found[f"stroke_recovered_{name}{kind}_{unit}"] = scale * self.made
        return found

    def _finding(self, code: str, measured: float, limit: float, where: str, remark: str) -> Finding:
        return at_most(code, self.scale * measured, self.scale * limit, self.unit, where, remark)

    def _where(self, where: str, alone: bool) -> str:
        return where if alone else f"{where}, {self.output.name}"

    def motion(self, where: str, alone: bool) -> Finding:
        """MOTION_ERROR."""
        lost = int(np.count_nonzero(np.isinf(self.off)))
        remark = f"{self.output.name}: closed on the measured joints at {len(self.theta)} crank angles"
        if lost:
            remark += f"; it does not close at {lost} of them"
        place = f"{self._where(where, alone)}, crank angle {math.degrees(self.theta[self.worst]):.3f} deg"
        return self._finding("MOTION_ERROR", self.error, self.limit, place, remark)

    def play(self, where: str, alone: bool) -> Finding:
        """LASH."""
        limit, cause = self.lash
        remark = f"free play of the output, by that of all joints at the worst angle; the limit is {cause}"
        return self._finding("LASH", 2 * self.band, limit, self._where(where, alone), remark)

    def stroke(self, where: str, alone: bool) -> Finding:
        """STROKE_ERROR."""
        made, meant = self.scale * self.made, self.scale * self.meant
        remark = f"{made:.6f} {self.unit} recovered, {meant:.6f} {self.unit} wanted"
        return self._finding("STROKE_ERROR", abs(self.made - self.meant), self.limit, self._where(where, alone), remark)


def _table(kind: str, judged: Sequence[_Judged], proof: Proof) -> Table:
    """Of each measured joint: its fit, and what its play and its centres' shift do to each output at the worst angle."""
    columns = [*COLUMNS]
    for each in judged:
        columns += [f"{each.output.name} by its play, {each.unit}", f"{each.output.name} by the shift, {each.unit}"]
    rows: list[list[object]] = []
    for name, fit in proof.fits.items():
        row: list[object] = [name, fit.play, fit.meant, max(fit.shifts)]
        for each in judged:
            share = each.scale * each.reach[name]
            row += [share * max(fit.play, 0.0) / 2, share * sum(fit.shifts)]
        rows.append(row)
    return Table(f"Joints as measured, {kind.upper()}", columns, rows)


def _size(files: Mapping[str, Sections]) -> float:
    return max(float(np.abs(shape.outer.points).max()) for sections in files.values() for shapes in sections for shape in shapes)


def _fit(fits: Mapping[str, Fit], limit: float, where: str) -> Finding:
    """The joint that fits worst: play against the spec's, each hole's own size, its centres at several heights.

    Each hole by itself, for one that is too tight is not mended by another one that is too wide.
    """
    worst = max(fits, key=lambda name: fits[name].misfit)
    fit = fits[worst]
    return at_most(
        "PIN_GAP", fit.misfit, limit, "mm", f"{where}, {worst}",
        f"play {fit.play:.4f} mm, {fit.meant:.4f} mm wanted; worst of {len(fits)} joints, by each "
        "hole's diameter and by the centres at several heights",
    )  # fmt: skip


def _overlap(name: str, between: Between, machine: Machine, outline: float, where: str) -> Finding:
    """INTERFERENCE of a follower that two outlines hold; the limit is what outlines within the tolerance may overlap."""
    joint, play = machine.joint(name), between.play(_ROUND)
    unit, scale = ("deg", math.degrees(1)) if isinstance(joint, Cam) and joint.slide is None else ("mm", 1.0)
    worst = int(np.argmin(np.where(np.isnan(play), -np.inf, play)))
    there = _ROUND[worst : worst + 1]
    limit = sum(outline * (1 + tolerances.BOUND_SPARE) / float(law.lever(there)[0]) for law in (between.drive, between.other))
    return at_most(
        "INTERFERENCE", scale * max(0.0, -float(play[worst])), scale * limit, unit,
        f"{where}, {name}, cam angle {math.degrees(_ROUND[worst]):.3f} deg",
        "largest overlap of the follower with both outlines; the limit is the outline tolerance at both",
    )  # fmt: skip


def _stroke(theta: Floats, output: Any, both: Callable[[Floats], tuple[Any, Any]]) -> float:
    """Difference of the output's extremes: from the judged angles, then by the secant of the slope. Of a path the larger
    side of its box, from the judged angles alone."""
    if np.iscomplexobj(output):
        return float(max(np.ptp(output.real), np.ptp(output.imag)))
    ends = []
    for sign in (1, -1):
        k = int(np.argmax(sign * output))
        a, b = theta[k - 1] if k else theta[0] - (theta[1] - theta[0]), theta[(k + 1) % len(theta)]
        b = b if b > theta[k] else 2 * theta[k] - a
        t = np.array([a, b])
        value, slope = both(t)
        best = max(float(np.max(sign * value)), float(sign * output[k]))
        for _ in range(8):
            if slope[1] == slope[0]:
                break
            new = t[1] - slope[1] * (t[1] - t[0]) / (slope[1] - slope[0])
            if not a <= new <= b:  # on facets, or at the last digits
                break
            v, s = both(np.array([new]))
            best = max(best, float(sign * v[0]))
            t, slope = np.array([t[1], new]), np.array([slope[1], s[0]])
        ends.append(sign * best)
    return ends[0] - ends[1]

