"""The judge of machines: closed on what was measured, moved, and compared with what is wanted, output by output.

It knows nothing of loops and dyads, and not what made a curve. Newton's method closes all measured joints at once, from
where the joints as meant put the bodies; the same Jacobian tells how far a displacement in each joint moves each output.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from camgen import tolerances
from camgen.files.formats import READABLE
from camgen.findings import Finding, NotJudged, at_most
from camgen.judge.cams import judge_cams, judged_angles, named
from camgen.judge.joints import Closable, Fit, Outline, Rolled, assembled
from camgen.judge.measured import Sections, read
from camgen.machine.constraints import Closed, Constraints
from camgen.machine.features import Asked, CamOutline, Feature, Mount, judged_outputs, parts_of
from camgen.machine.model import Cam, Law, Machine, Output, bodies_of, unit_of
from camgen.study import Table

Floats = NDArray[np.float64]

_RANGE = 0.5  # of an output's range: with more play a mechanism is none
_ROUNDING = 1e-10  # mm or rad, of an output that no joint moves, such as the driven link's angle
_KNOWN = 721  # angles at which the machine as meant is closed, from which all others start: half a degree of a turn apart
_CELLS = 4_000_000  # of the matrices of all angles at a time, 32 MB
COLUMNS = ("joint", "play, mm", "meant, mm", "centres off, mm")


@dataclass(frozen=True)
class Moved:
    """One output at n angles, in its own unit: value (complex for a path) and slope to theta, (n,), nan where the machine does
    not close; reach: by joint, how far a displacement of 1 mm in it can move the output, (n,); play: the same by what all
    joints' clearances give either way, worst case, first order."""

    value: Any
    slope: Any
    reach: Mapping[str, Floats]
    play: Floats


Laws = tuple[tuple[str, Law], ...]  # of cams by name, in place of those of the machine: what undercut outlines give


class _Meant:
    """The machine with its joints where they are meant, from which all others start."""

    def __init__(self, machine: Machine, low: float, high: float) -> None:
        self.system = Constraints(machine)
        self._known = self.system.close(np.linspace(low, high, _KNOWN))
        self._systems: dict[Laws, Constraints] = {(): self.system}
        self._seen: dict[tuple[str, bytes, Laws], tuple[Any, Any]] = {}

    def near(self, theta: Floats) -> Floats:
        """Poses from those at the nearest known angle, (n, 3 bodies)."""
        known = self._known
        k = np.rint(np.interp(theta, known.theta, np.arange(len(known.theta)))).astype(int)
        h = (theta - known.theta[k])[:, None]
        return np.asarray(known.q[k] + h * (known.first[k] + 0.5 * h * known.second[k]))

    def when(self, body: str, angles: Floats) -> Floats:
        """Where between the first and the last angle a body that turns one way alone stands at angles, (n,) rad of any turn."""
        at = np.asarray(self.system.angle(body, self._known.q) + np.zeros(_KNOWN))
        sense = np.sign(at[-1] - at[0])
        if not np.all(sense * np.diff(at) > 0):
            return np.empty(0)
        low, high = min(at[0], at[-1]), max(at[0], at[-1])
        turns = np.arange(math.floor(low / math.tau) - 1, math.ceil(high / math.tau) + 1)
        every = np.ravel(angles[:, None] + math.tau * turns)
        every = every[(low <= every) & (every <= high)]
        return np.asarray(np.interp(sense * every, sense * at, self._known.theta))

    def outcome(self, output: str, theta: Floats, laws: Laws = ()) -> tuple[Any, Any]:
        """An output and its slope, (n,); those at many angles are kept for the other kinds of files."""
        key = (output, theta.tobytes(), laws)
        if key in self._seen:
            return self._seen[key]
        if laws not in self._systems:
            self._systems[laws] = Constraints(_with(self.system.machine, laws))
        system = self._systems[laws]
        parts = [_outcome(system, output, system.close(part, self.near(part), 1)) for part in _parts(system, theta)]
        found = np.concatenate([part[0] for part in parts]), np.concatenate([part[1] for part in parts])
        if len(theta) > _KNOWN:
            self._seen[key] = found
        return found


# A machine is the same object for all kinds of its files.
_meant = lru_cache(maxsize=1)(_Meant)


class Proof:
    """A machine on its measured joints, ready at any angle; laws: what its exact outlines give, where that is not meant."""

    def __init__(self, nominal: Machine, measured: Closable, theta: Floats, laws: Laws = ()) -> None:
        self.machine, self.fits, self._laws = measured.machine, measured.fits, laws
        self.plays = {joint.name: joint.clearance for joint in self.machine.joints}
        self._radii = measured.radii
        self.plays |= {name: fit.play / self._radii.get(name, 1.0) for name, fit in self.fits.items()}
        for name, (drive, *others) in measured.outlines.items():
            if others:
                self.plays[name] = min(float(np.max(drive.play(other, judged_angles()))) for other in others)
        self._meant, self._system = _meant(nominal, float(theta.min()), float(theta.max())), Constraints(measured.machine)
        self._seen: dict[bytes, Mapping[str, Moved]] = {}

    def wanted(self, output: str, theta: Floats) -> tuple[Any, Any]:
        """The output and its slope by the joints as they are meant, (n,)."""
        return self._meant.outcome(output, theta)

    def reachable(self, output: str, theta: Floats) -> tuple[Any, Any]:
        """The same less what the spec itself undercuts."""
        return self._meant.outcome(output, theta, self._laws)

    @cached_property
    def corners(self) -> Floats:
        """Angles beside those at which a follower goes from one element of its outline to the next, (n,) rad."""
        cams = [(joint, joint.law) for joint in self.machine.joints if isinstance(joint, Cam)]
        found = [self._meant.when(joint.cam, law.contact.changes + joint.phase) for joint, law in cams if isinstance(law, Rolled)]
        return np.concatenate([np.empty(0), *found])

    def moved(self, output: str, theta: Floats) -> Moved:
        """The output by the joints as they are, (n,)."""
        key = theta.tobytes()
        if key not in self._seen:
            parts = [self._at(part) for part in _parts(self._system, theta)]
            if len(self._seen) > 3:
                del self._seen[next(reversed(self._seen))]  # the judged angles, which came first, stay
            self._seen[key] = {each.name: _joined([part[each.name] for part in parts]) for each in self.machine.outputs}
        return self._seen[key][output]

    def outcome(self, output: str, theta: Floats) -> tuple[Any, Any]:
        """Its value and slope alone, (n,)."""
        if theta.tobytes() in self._seen:
            moved = self._seen[theta.tobytes()][output]
            return moved.value, moved.slope
        return _outcome(self._system, output, self._system.close(theta, self._meant.near(theta), 1))[:2]

    def _at(self, theta: Floats) -> Mapping[str, Moved]:
        """All outputs by the joints as they are, (n,)."""
        closed = self._system.close(theta, self._meant.near(theta), 1)
        poses = np.where(np.isnan(closed.q), 0.0, closed.q)
        levers: dict[str, Any] = dict(self._radii)
        levers |= {
            joint.name: joint.law.lever(np.broadcast_to(self._system.angle(joint.cam, closed.q) - joint.phase, theta.shape))
            for joint in self.machine.joints
            if isinstance(joint, Cam) and isinstance(joint.law, Rolled)
        }
        found = {}
        every = self._system.shares([output.name for output in self.machine.outputs], poses, theta)
        for output, shares in zip(self.machine.outputs, every, strict=True):
            value, slope, lost = _outcome(self._system, output.name, closed)
            reach, play = {}, np.zeros(len(theta))
            for joint in self.machine.joints:
                share = np.where(lost, np.nan, shares[joint.name])
                play = play + share * max(self.plays[joint.name], 0.0) / 2
                if joint.name in levers or joint.name in self.fits:
                    reach[joint.name] = share / levers.get(joint.name, 1.0)
            found[output.name] = Moved(value, slope, reach, play)
        return found


def _with(machine: Machine, laws: Laws) -> Machine:
    """The machine with other laws of its cams."""
    new = dict(laws)
    joints = (replace(joint, law=new.get(joint.name, joint.law)) if isinstance(joint, Cam) else joint for joint in machine.joints)
    return replace(machine, joints=tuple(joints))


def _parts(system: Constraints, theta: Floats) -> Sequence[Floats]:
    """So few angles at a time that their matrices stay small."""
    return np.array_split(theta, -(-len(theta) * max(1, system.width**2) // _CELLS))


def _joined(parts: Sequence[Moved]) -> Moved:
    """The same at all angles."""
    reach = {name: np.concatenate([part.reach[name] for part in parts]) for name in parts[0].reach}
    value, slope, play = (np.concatenate([getattr(part, key) for part in parts]) for key in ("value", "slope", "play"))
    return Moved(value, slope, reach, play)


def _outcome(system: Constraints, output: str, closed: Closed) -> tuple[Any, Any, NDArray[np.bool_]]:
    """An output, its slope to theta, and where it is lost, (n,)."""
    value, gradient = system.output(output, closed.q)
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

    kind: of READABLE; where: said in findings; files: sections (shapes at each height) of each part's file of this
    kind, by part; theta: judged values of the machine's own variable, (n,) rad; chord_tolerance: mm, of outlines and facets;
    slack: mm, what the way back from a print compensation may cost a fit; asked: more than the motion, by output.

    PIN_GAP: the joint that fits worst. MOTION_ERROR, STROKE_ERROR, LASH: the output that comes worst off against its own
    limit; that of motion and stroke is what one joint's centre off by the chord tolerance, or all outlines, can do. In a
    finding's `where` a star stands for the parts: the names of one or two take its place.
    """
    form = READABLE[kind]
    found = read(features, files, form.holds == "drawing")
    every = named(where, parts_of(features))
    if found.lost:
        return Verdict((at_most("PIN_GAP", math.nan, 0, "mm", every, "; ".join(found.lost)),))
    rounding = form.rounding * _size([files[part] for part in parts_of(features)]) if form.rounding else 0.0
    try:
        measured = assembled(machine, features, mounts, found)
        closing = _Closing(kind, where, machine, measured, theta, chord_tolerance, rounding, asked)
        first = {name: outlines[0] for name, outlines in measured.outlines.items()}
        proof = closing.proof(first)
    except ValueError as fault:
        return Verdict((at_most("MOTION_ERROR", math.nan, 0, "mm", every, str(fault)),))
    findings = [_fit(measured.fits, 2 * chord_tolerance + 4 * rounding + slack, every)] if measured.fits else []
    judged = closing.judged(proof)
    alone = len(judged) == 1
    numbers: dict[str, float] = {}
    for each in judged:
        numbers |= each.numbers(kind, "" if alone else f"{each.output.name.replace(' ', '_')}_")
    further = {outline.feature for outlines in measured.outlines.values() for outline in outlines[1:]}
    where = named(where, parts_of(feature for feature in features if feature not in further))
    findings.append(max(judged, key=lambda each: each.error / each.limit).motion(where, alone))
    off = chord_tolerance + 2 * rounding
    on_cams = judge_cams(kind, closing.where, machine, measured.outlines, off, findings[-1].ok, closing.motion)
    findings += on_cams.findings
    numbers |= on_cams.numbers
    nominal = _nominal(machine, features, mounts)
    if any(math.isinf(each.error) for each in judged):
        return Verdict(tuple(findings), numbers, not_judged=nominal)
    if proof.fits or (on_cams.sound and further):
        worst = max(judged, key=lambda each: 2 * each.band / each.lash[0] if each.lash[0] else math.inf)
        findings.append(worst.play(every, alone))
    strokes = [each for each in judged if each.asked.stroke]
    if strokes:
        findings.append(max(strokes, key=lambda each: abs(each.made - each.meant) / each.limit).stroke(where, alone))
    return Verdict(tuple(findings), numbers, _table(kind, judged, proof), proof, nominal)


def _nominal(machine: Machine, features: Sequence[Feature], mounts: Sequence[Mount]) -> tuple[NotJudged, ...]:
    """Joints of parts that are made which no file shows."""
    made, told = {mount.body for mount in mounts}, {getattr(feature, "joint", "") for feature in features}
    for feature in features:
        if isinstance(feature, CamOutline):
            told |= {feature.turns} if feature.bore else set()
            told |= {feature.swings or ""} if feature.own else set()
    return tuple(
        NotJudged("PIN_GAP", f"{joint.name} counts as meant: no file shows it", "files that show it")
        for joint in machine.joints
        if joint.name not in told and made & set(bodies_of(joint))
    )


@dataclass(frozen=True)
class _Closing:
    """A machine with its measured joints, to be closed on one outline of each cam or another; rounding: of coordinates, mm."""

    kind: str
    where: str
    machine: Machine
    measured: Closable
    theta: Floats
    chord_tolerance: float
    rounding: float
    asked: Sequence[Asked]

    @property
    def outputs(self) -> Sequence[Output]:
        """Those that are judged, as they are measured."""
        return judged_outputs(self.measured.machine.outputs, self.asked)

    def proof(self, driven: Mapping[str, Outline], own: bool = False) -> Proof:
        """The machine driven by these outlines, by cam; own: with the tips that parts have."""
        laws = tuple((name, outline.own if own and outline.own else outline.law) for name, outline in driven.items())
        given = tuple((name, outline.feature.meant.given) for name, outline in driven.items())
        machine = replace(_with(self.measured.machine, laws), outputs=tuple(self.outputs))
        made = replace(self.measured, machine=machine)
        return Proof(self.machine, made, self.theta, tuple((name, law) for name, law in given if law is not None))

    def judged(self, proof: Proof) -> list[_Judged]:
        """Its outputs against what is asked of them."""
        wishes = {each.output: each for each in self.asked}
        return [
            _Judged(output, wishes.get(output.name, Asked(output.name)), proof, self.theta, self.chord_tolerance, self.rounding)
            for output in self.outputs
        ]

    def motion(self, driven: Mapping[str, Outline], own: bool, where: str) -> Finding:
        """MOTION_ERROR of the machine driven by other outlines than the first, or tips."""
        judged = self.judged(self.proof(driven, own))
        return max(judged, key=lambda each: each.error / each.limit).motion(where, len(judged) == 1)


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
        self.every = np.concatenate([theta, proof.corners])
        off = [np.abs(self.recovered(part)[0] - self.wanted(part)[0]) for part in (theta, proof.corners) if len(part)]
        self.off = np.concatenate(off)
        self.off[np.isnan(self.off)] = np.inf
        self.worst = int(np.argmax(self.off))
        self.error = float(self.off[self.worst])

    def wanted(self, theta: Floats) -> tuple[Any, Any]:
        """The wanted value and slope, (n,)."""
        motion = self.asked.motion
        return self.proof.reachable(self.output.name, theta) if motion is None else (motion(theta, 0), motion(theta, 1))

    def recovered(self, theta: Floats) -> tuple[Any, Any]:
        """The same as the files give it."""
        return self.proof.outcome(self.output.name, theta)

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
            found[f"{'swing' if unit == 'deg' else 'stroke'}_recovered_{name}{kind}_{unit}"] = scale * self.made
        return found

    def _finding(self, code: str, measured: float, limit: float, where: str, remark: str) -> Finding:
        return at_most(code, self.scale * measured, self.scale * limit, self.unit, where, remark)

    def _where(self, where: str, alone: bool) -> str:
        return where if alone else f"{where}, {self.output.name}"

    def motion(self, where: str, alone: bool) -> Finding:
        """MOTION_ERROR."""
        lost, turn = int(np.count_nonzero(np.isinf(self.off))), "cam" if len(self.proof.corners) else "crank"
        remark = f"{self.output.name}: closed on the measured joints at {len(self.theta)} {turn} angles"
        if len(self.proof.corners):
            remark += ", and at each corner of the outlines"
        if lost:
            remark += f"; it does not close at {lost} of them"
        place = f"{self._where(where, alone)}, {turn} angle {math.degrees(self.every[self.worst]):.3f} deg"
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


def _size(files: Sequence[Sections]) -> float:
    return max(float(np.abs(shape.outer.points).max()) for sections in files for shapes in sections for shape in shapes)


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

