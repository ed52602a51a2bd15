"""The judge of machines: closed on what was measured (`proof`), moved, and compared with what is wanted, output by output."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np

from camgen import tolerances
from camgen.files.formats import READABLE
from camgen.findings import Finding, NotJudged, Where, at_most
from camgen.judge.cams import judge_cams, named
from camgen.judge.edges import judge_edges
from camgen.judge.joints import Closable, Fit, Nominal, Outline, at_rest, measured_machine
from camgen.judge.measured import Files, Sections, read
from camgen.judge.meshes import judge_mesh
from camgen.judge.pawls import judge_pawl
from camgen.judge.pin_tracks import TrackedPins, judge_tracks
from camgen.judge.proof import Proof, strokes, with_laws
from camgen.machine.features import CamOutline, Demand, judged_outputs, parts_of
from camgen.machine.model import GROUND, Cam, Clutch, Output, bodies_of, unit_of
from camgen.numerics import Floats, magnitude
from camgen.study import Figure, Figures, Table

_STILL = 1e-9  # mm or rad, the stroke of an output that does not move
_RANGE = 0.5  # of an output's range: with more play a mechanism is none
_ROUNDING = 1e-10  # mm or rad, of an output that no joint moves, such as the driven link's angle
MOTION_ERROR = "motion error {of}"  # its figure
COLUMNS = ("joint", "play, mm", "wanted, mm", "centres off, mm")


@dataclass(frozen=True)
class Verdict:
    """Findings, numbers and a table of what each joint does to the outputs, from one kind of file.

    proof: the machine closed on its files, None where it cannot be; not_judged: what counts as meant, since no file has it.
    """

    findings: tuple[Finding, ...]
    numbers: Figures = field(default_factory=Figures)
    table: Table | None = None
    proof: Proof | None = None
    not_judged: tuple[NotJudged, ...] = ()


def judge_machine(
    nominal: Nominal,
    files: Files,
    theta: Floats,
    chord_tolerance: float,
    slack: float = 0.0,
) -> Verdict:
    """Fits, and every output of the machine closed on the measured features, against the wanted ones.

    theta: judged values of the machine's own variable, (n,) rad; chord_tolerance: mm, of outlines and facets; slack: mm, what
    the way back from a print compensation may cost a fit.

    PIN_GAP: the joint that fits worst. MOTION_ERROR, STROKE_ERROR, LASH: the output that comes worst off against its own
    limit; that of motion and stroke is what one joint's centre off by the chord tolerance, or all outlines, can do. In a
    finding's `where` a star stands for the parts: the names of one or two take its place.
    """
    form = READABLE[files.kind]
    features = nominal.features
    readings = read(features, files.sections, form.holds == "drawing")
    every = named(files.where, parts_of(features))
    if readings.lost:
        return Verdict((at_most("PIN_GAP", math.nan, 0, "mm", every, "; ".join(readings.lost)),))
    rounding = (
        form.rounding * _size([files.sections[part] for part in parts_of(features)])
        if form.rounding
        else 0.0
    )
    try:
        measured = measured_machine(nominal.machine, features, nominal.mounts, readings)
        closing = _Closing(nominal, measured, theta, chord_tolerance, rounding)
        first = {name: outlines[0] for name, outlines in measured.outlines.items()}
        proof = closing.proof(first)
    except ValueError as fault:
        return Verdict((at_most("MOTION_ERROR", math.nan, 0, "mm", every, str(fault)),))
    findings = (
        [_fit(measured.fits, 2 * chord_tolerance + 4 * rounding + slack, every)]
        if measured.fits
        else []
    )
    judged = closing.results(proof)
    alone = len(judged) == 1
    numbers = Figures()
    for each in judged:
        numbers |= each.figures(files.kind, "" if alone else each.output.name)
    others = {
        outline.feature for outlines in measured.outlines.values() for outline in outlines[1:]
    }
    where = named(files.where, parts_of(feature for feature in features if feature not in others))
    findings.append(_motion_error(judged, where))
    off = chord_tolerance + 2 * rounding
    on_cams = judge_cams(
        files, nominal.machine, measured.outlines, off, findings[-1].ok, closing.motion
    )
    findings += on_cams.findings
    numbers |= on_cams.figures
    for meshing in measured.meshings.values():
        pair = named(files.where, {meshing.a.part, meshing.b.part})
        findings.append(judge_mesh(meshing, off + slack, pair))
    for engagement in measured.engagements.values():
        edges = {each.part for each in engagement.feature.edges}
        edges_where = named(files.where, edges)
        findings.append(judge_edges(engagement, edges_where))
        if isinstance(engagement, TrackedPins):
            findings.append(judge_tracks(engagement, 2 * off + slack, edges_where))
        numbers |= engagement.figures(files.kind)
    for pawl in measured.pawls.values():
        both = {each.part for each in pawl.feature.edges}
        findings += judge_pawl(pawl, off + slack, named(files.where, both))
        numbers |= pawl.figures(files.kind)
    unseen = _nominal(nominal)
    if any(math.isinf(each.error) for each in judged):
        return Verdict(tuple(findings), numbers, not_judged=unseen)
    bounded = [each for each in judged if math.isfinite(each.lash[0])]
    if bounded and (proof.fits or (on_cams.sound and others)):
        worst = max(
            bounded, key=lambda each: 2 * each.band / each.lash[0] if each.lash[0] else math.inf
        )
        findings.append(worst.play(every, alone))
    strokes = [each for each in judged if each.demand.stroke]
    if strokes:
        findings.append(
            max(
                strokes,
                key=lambda each: abs(each.measured_stroke - each.nominal_stroke) / each.limit,
            ).stroke(where, alone)
        )
    return Verdict(tuple(findings), numbers, _table(files.kind, judged, proof), proof, unseen)


def _motion_error(judged: Sequence[_OutputResult], where: Where) -> Finding:
    """MOTION_ERROR of the output that comes worst off against its own limit."""
    worst = max(judged, key=lambda each: each.error / each.limit)
    return worst.motion(where, len(judged) == 1)


def _nominal(nominal: Nominal) -> tuple[NotJudged, ...]:
    """Joints of parts that are made and move which no file shows; not clutches, which are bought."""
    bodies = {mount.body for mount in nominal.mounts} - {GROUND}
    shown = {getattr(feature, "joint", "") for feature in nominal.features}
    for feature in nominal.features:
        if isinstance(feature, CamOutline):
            shown |= {feature.turns} if feature.bore else set()
            shown |= {feature.swings or ""} if feature.own else set()
    return tuple(
        NotJudged(
            "PIN_GAP", f"{joint.name} counts as meant: no file shows it", "files that show it"
        )
        for joint in nominal.machine.joints
        if joint.name not in shown
        and bodies & set(bodies_of(joint))
        and not isinstance(joint, Clutch)
    )


@dataclass(frozen=True)
class _Closing:
    """A machine with its measured joints, to be closed on one outline of each cam or another."""

    nominal: Nominal
    measured: Closable
    theta: Floats  # (n,) rad
    chord_tolerance: float  # mm
    rounding: float  # of coordinates, mm

    @property
    def outputs(self) -> Sequence[Output]:
        """Those that are judged, as they are measured."""
        return judged_outputs(self.measured.machine.outputs, self.nominal.demands)

    def proof(self, driven: Mapping[str, Outline], own: bool = False) -> Proof:
        """The machine driven by these outlines, by cam; own: with the tips that parts have."""
        laws = tuple(
            (name, outline.own if own and outline.own else outline.law)
            for name, outline in driven.items()
        )
        laws_given = tuple((name, outline.feature.nominal.law) for name, outline in driven.items())
        machine = replace(with_laws(self.measured.machine, laws), outputs=tuple(self.outputs))
        measured = replace(self.measured, machine=machine)
        meant = at_rest(self.nominal.machine, frozenset(self.measured.pawls))
        return Proof(
            meant,
            measured,
            self.theta,
            tuple((name, law) for name, law in laws_given if law is not None),
        )

    def results(self, proof: Proof) -> list[_OutputResult]:
        """Its outputs against what is asked of them."""
        wishes = {each.output: each for each in self.nominal.demands}
        return [
            _OutputResult(
                output,
                wishes.get(output.name, Demand(output.name)),
                proof,
                self.theta,
                self.chord_tolerance,
                self.rounding,
            )
            for output in self.outputs
        ]

    def motion(self, driven: Mapping[str, Outline], own: bool, where: Where) -> Finding:
        """MOTION_ERROR of the machine driven by other outlines than the first, or tips."""
        return _motion_error(self.results(self.proof(driven, own)), where)


class _OutputResult:
    """One output against the wanted one."""

    def __init__(
        self,
        output: Output,
        demand: Demand,
        proof: Proof,
        theta: Floats,
        chord_tolerance: float,
        rounding: float,
    ) -> None:
        self.output = output
        self.demand = demand
        self.proof = proof
        self.theta = theta
        self.unit, self.scale = unit_of(output)
        self.accurate = chord_tolerance + 2 * rounding  # mm
        self.moved = proof.moved(output.name, theta)
        self.reach = {
            name: float(np.nanmax(reach, initial=0.0)) for name, reach in self.moved.reach.items()
        }
        outlines = sum(
            self.reach[j.name]
            for j in proof.machine.joints
            if isinstance(j, Cam) and j.name in self.reach
        )
        largest = max([*self.reach.values(), outlines], default=0.0)
        limit = chord_tolerance * largest * (1 + tolerances.BOUND_SPARE) + 2 * rounding * sum(
            self.reach.values()
        )
        self.limit = max(limit, _ROUNDING)
        self.every = np.concatenate([theta, proof.corners])
        off = [
            np.abs(self.measured(part)[0] - self.nominal(part)[0])
            for part in (theta, proof.corners)
            if len(part)
        ]
        self.off = np.concatenate(off)
        self.off[np.isnan(self.off)] = np.inf
        self.worst = int(np.argmax(self.off))
        self.error = float(self.off[self.worst])

    def nominal(self, theta: Floats) -> tuple[Any, Any]:
        """The wanted value and slope, (n,)."""
        motion = self.demand.motion
        return (
            self.proof.reachable(self.output.name, theta)
            if motion is None
            else (motion(theta, 0), motion(theta, 1))
        )

    def measured(self, theta: Floats) -> tuple[Any, Any]:
        """The same as the files give it."""
        return self.proof.outcome(self.output.name, theta)

    @cached_property
    def band(self) -> float:
        """Largest play either way."""
        return float(np.max(self.moved.play))

    @cached_property
    def measured_stroke(self) -> float:
        """Difference of the extremes as the files give it."""
        return self.proof.strokes(self.theta)[self.output.name]

    @cached_property
    def nominal_stroke(self) -> float:
        """The same as it is wanted."""
        name = self.output.name
        wanted = {name: self.nominal(self.theta)[0]}
        return strokes(self.theta, wanted, lambda _, theta: self.nominal(theta))[name]

    @property
    def lash(self) -> tuple[float, str]:
        """The play that is borne, and why no more."""
        half = self.measured_stroke * _RANGE
        if self.demand.lash < half or self.nominal_stroke <= _STILL:
            return self.demand.lash, self.demand.lash_of
        return half, "half of the stroke: with more it is no mechanism"

    def figures(self, kind: str, name: str) -> list[Figure]:
        """Figures of the report; name: of the output, "" where it is the only one."""
        values = {MOTION_ERROR: self.error}
        if math.isfinite(self.error):
            moved = "swing" if self.unit == "deg" else "stroke"
            values |= {
                "clearance band {of}": self.band,
                "play {of}": 2 * self.band,
                f"{moved} recovered {{of}}": self.measured_stroke,
            }
        return [
            Figure(quantity, self.scale * value, self.unit, name, kind=kind)
            for quantity, value in values.items()
        ]

    def _finding(
        self, code: str, measured: float, limit: float, where: Where, remark: str
    ) -> Finding:
        return at_most(code, self.scale * measured, self.scale * limit, self.unit, where, remark)

    def _where(self, where: Where, alone: bool) -> Where:
        return where if alone else replace(where, output=self.output.name)

    def motion(self, where: Where, alone: bool) -> Finding:
        """MOTION_ERROR."""
        lost = int(np.count_nonzero(np.isinf(self.off)))
        turn = "cam" if len(self.proof.corners) else "crank"
        slides = self.proof.machine.drives[0].slide is not None
        places = "places of the drive" if slides else f"{turn} angles"
        remark = f"{self.output.name}: camgen closed the machine on the measured joints at {len(self.theta)} {places}"
        if len(self.proof.corners):
            remark += ", and at each corner of the outlines"
        if lost:
            remark += f"; it does not close at {lost} of them"
        if self.error > self.limit:
            remark += self._moved_most()
        theta = float(self.every[self.worst])
        place = replace(self._where(where, alone), theta=theta, angle=f"{turn} angle")
        return self._finding("MOTION_ERROR", self.error, self.limit, place, remark)

    def _moved_most(self) -> str:
        """Which part is furthest off at a joint, where it is more than files may be."""
        sides = [
            (off, part, name)
            for name, fit in self.proof.fits.items()
            for off, part in zip(fit.shifts, fit.parts, strict=True)
        ]
        off, part, name = max(sides, default=(0.0, "", ""))
        if off <= self.accurate:
            return ""
        return f"; {part or 'a side'} is furthest from its place, by {off:.3g} mm at joint {name}"

    def play(self, where: Where, alone: bool) -> Finding:
        """LASH."""
        limit, cause = self.lash
        remark = (
            "free play of the output from all joints, with their gaps as in the files, at the worst angle; "
            f"the limit is {cause}"
        )
        return self._finding("LASH", 2 * self.band, limit, self._where(where, alone), remark)

    def stroke(self, where: Where, alone: bool) -> Finding:
        """STROKE_ERROR."""
        measured = self.scale * self.measured_stroke
        nominal = self.scale * self.nominal_stroke
        remark = f"{measured:z.6f} {self.unit} recovered, {nominal:z.6f} {self.unit} wanted"
        return self._finding(
            "STROKE_ERROR",
            abs(self.measured_stroke - self.nominal_stroke),
            self.limit,
            self._where(where, alone),
            remark,
        )


def _table(kind: str, judged: Sequence[_OutputResult], proof: Proof) -> Table:
    """Of each measured joint: its fit, and what its play and its centres' shift do to each output at the worst angle."""
    columns = [*COLUMNS]
    for each in judged:
        columns += [
            f"error of {each.output.name} from its play, {each.unit}",
            f"error of {each.output.name} from the shift, {each.unit}",
        ]
    rows: list[list[object]] = []
    for name, fit in proof.fits.items():
        row: list[object] = [name, fit.play, fit.nominal, max(fit.shifts)]
        for each in judged:
            factor = each.scale * each.reach[name]
            row += [factor * max(fit.play, 0.0) / 2, factor * sum(fit.shifts)]
        rows.append(row)
    return Table(f"Joints as measured, {kind.upper()}", columns, rows)


def _size(files: Sequence[Sections]) -> float:
    return max(
        magnitude(shape.outer.points)
        for sections in files
        for shapes in sections
        for shape in shapes
    )


def _fit(fits: Mapping[str, Fit], limit: float, where: Where) -> Finding:
    """The joint that fits worst: play against the spec's, each hole's own size, its centres at several heights.

    Each hole by itself, for one that is too tight is not mended by another one that is too wide.
    """
    worst = max(fits, key=lambda name: fits[name].misfit)
    fit = fits[worst]
    parts = " and ".join(part for part in fit.parts if part)
    named_parts = f"; {parts}" if parts and fit.misfit > limit else ""
    return at_most(
        "PIN_GAP",
        fit.misfit,
        limit,
        "mm",
        replace(where, joint=worst),
        f"play {fit.play:z.4f} mm, {fit.nominal:z.4f} mm wanted; worst of {len(fits)} joints, from each "
        f"hole's diameter and its centres at several heights{named_parts}",
    )
