"""Files read back: each part by itself, and the motion that all of a kind give."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import cache
from itertools import zip_longest
from typing import TYPE_CHECKING

import numpy as np

from camgen.errors import DesignError
from camgen.files.formats import EXACT, FORMATS, READABLE
from camgen.findings import Finding, NotJudged, Where, at_most, in_file
from camgen.geometry.arcs import bulges, fit_arcs
from camgen.geometry.facets import facet_contour
from camgen.geometry.outlines import Floats
from camgen.geometry.rings import Ring, Shape
from camgen.judge.as_printed import printed
from camgen.judge.round_trip import (
    NominalPart,
    PartVerdict,
    PrintChange,
    judge_dimensioned,
    judge_drawing,
    judge_exact,
    judge_mesh,
)
from camgen.machine.features import CamOutline, Edge, Feature, judged_outputs, parts_of
from camgen.machines.mechanism import Mechanism
from camgen.parts.fits import Compensation, compensated
from camgen.parts.fixing import is_as_sold
from camgen.parts.part import Part
from camgen.pipeline.case import Case
from camgen.pipeline.expectation import nominal_part
from camgen.pipeline.making import compensation
from camgen.pipeline.scope import Outcome
from camgen.study import ROWS, Figures, Study, Table

if TYPE_CHECKING:
    from camgen.judge.measured import Sections
    from camgen.judge.motion import Verdict


Read = dict[
    str, "Sections"
]  # what was read from one part's files, by kind: the pieces at each height


# ---- a part by itself ------------------------------------------------------------------------------------------------


def judge_part(
    case: Case, name: str, kinds: Sequence[str], dimensioned: bool = True
) -> tuple[Outcome, Read]:
    """Read one part's files; dimensioned: its drawing with dimensions too, which stands beside its DXF but where it is bought."""
    mechanism = case.mechanism
    part = case.parts[name]
    features = mechanism.assembly.features
    tolerance = mechanism.accuracy.chord_tolerance
    fit = compensation(mechanism)
    findings: list[Finding] = []
    sections: Read = {}
    not_judged: list[NotJudged] = []

    @cache  # files of several kinds should hold the same
    def nominal(sent: Compensation | None) -> NominalPart:
        return nominal_part(part, tolerance, features, sent, mechanism.files)

    for kind in kinds:
        path = case.file(name, kind)
        blank = FORMATS[kind].holds == "drawing" and not part.outlined
        if kind in EXACT and not path.exists():
            why = _without(part, tolerance)
            not_judged += why
            if not why:
                findings.append(
                    at_most(
                        "ROUND_TRIP",
                        math.nan,
                        0,
                        "mm",
                        in_file(path),
                        "it is not there, and the part can have one",
                    )
                )
            continue
        shape = nominal(fit if FORMATS[kind].solid else None)
        verdict = PartVerdict(()) if blank else _JUDGES[FORMATS[kind].holds](path, shape)
        findings += verdict.findings
        if kind == "dxf" and dimensioned and not is_as_sold(part):
            findings.append(judge_dimensioned(case.file(f"{name}-drawing", kind), shape))
        if verdict.sections:
            sections[kind] = verdict.sections
    return Outcome(findings, not_judged=not_judged), sections


_JUDGES = {"drawing": judge_drawing, "mesh": judge_mesh, "exact": judge_exact}


def _without(part: Part, tolerance: float) -> list[NotJudged]:
    """Why a part has no exact solid."""
    from camgen.parts.exact import exact

    try:
        exact(part, tolerance)
    except DesignError as error:
        return [NotJudged("ROUND_TRIP", f"no STEP of {part.name}: {error}", "STL or 3MF")]
    return []


# ---- the motion ------------------------------------------------------------------------------------------------------


def files_of(mechanism: Mechanism, kind: str) -> Where:
    """All files of a kind."""
    return Where(file=f"{mechanism.name}-*.{kind}", kind=kind)


def judge_motion(
    mechanism: Mechanism,
    kind: str,
    parts: Mapping[str, Read],
    theta: Floats,
    where: Where | None = None,
    spare: float = 0.0,
) -> tuple[Verdict, Sequence[Feature]] | None:
    """The machine closed on what was measured in files of a kind, at theta, (n,) rad, and on which features; None where a part
    is not there. Of cams those count whose parts are there; where: said in findings; spare: mm, by which outlines may be off
    besides accuracy.chord_tolerance.
    """
    from camgen.judge.joints import Nominal
    from camgen.judge.measured import Files
    from camgen.judge.motion import judge_machine

    files = {name: part[kind] for name, part in parts.items() if kind in part}
    lost = parts.keys() - files.keys()
    features = [
        each
        for each in mechanism.assembly.features
        if not (isinstance(each, CamOutline) and each.part in lost)
    ]
    if not features or parts_of(features) & lost:
        return None
    slack = _slack(mechanism, kind)
    assembly = mechanism.assembly
    verdict = judge_machine(
        Nominal(mechanism.model, features, assembly.mounts, assembly.demands),
        Files(kind, where or files_of(mechanism, kind), files),
        theta,
        mechanism.accuracy.chord_tolerance + spare,
        slack,
    )
    return verdict, features


def _slack(mechanism: Mechanism, kind: str) -> float:
    """What the way back from a print compensation may cost a fit in files of a kind, mm."""
    fit = compensation(mechanism) if READABLE[kind].solid else None
    return 0.0 if fit is None else PrintChange(fit.hole, fit.profile, fit.shrinkage).slack


def moved_by(
    mechanism: Mechanism, kinds: Sequence[str], parts: Mapping[str, Read]
) -> tuple[Outcome, dict[str, Floats], Study]:
    """The motion over a turn as the files give it: findings, plots of each output, its speed, error and play, as columns of
    motion.csv; and what follows from the recovered motion."""
    from camgen.judge.cams import judged_angles
    from camgen.judge.targets import judge_targets
    from camgen.pipeline.curves import Curves, laid_over

    features = mechanism.assembly.features
    if not features:
        return Outcome(), {}, Study()
    cycle = mechanism.assembly.cycle
    low, high = cycle.range
    wishes = {each.output: each for each in mechanism.assembly.demands}
    theta = np.linspace(low, high, math.ceil((ROWS - 1) * (high - low) / math.tau - 1e-9) + 1)
    judged = low + judged_angles() * ((high - low) / math.tau)
    outputs = judged_outputs(mechanism.model.outputs, wishes.values())
    cams = any(isinstance(feature, CamOutline) for feature in features) and cycle.range == (
        0.0,
        math.tau,
    )
    curves = [Curves(output, theta, cycle, len(outputs) == 1, cams) for output in outputs]
    for curve in curves:
        motion = wishes[curve.output.name].motion if curve.output.name in wishes else None
        if motion is not None:
            curve.want(motion(theta, 0), motion(theta, 1))
    findings: list[Finding] = []
    numbers = Figures()
    tables = []
    nominal = []
    for kind in kinds:
        result = judge_motion(mechanism, kind, parts, judged)
        if result is None:
            continue
        verdict = result[0]
        findings += verdict.findings
        numbers |= verdict.numbers
        nominal += [each for each in verdict.not_judged if each not in nominal]
        if verdict.proof is not None and verdict.table is not None:
            tables += [verdict.table] if verdict.table.rows else []
            for curve in curves:
                curve.add(kind, verdict.proof)
            findings += judge_targets(
                mechanism.assembly.demands, verdict.proof, theta, files_of(mechanism, kind)
            )
    columns = (
        {f"theta_{cycle.unit}": np.degrees(theta)} if any(curve.columns for curve in curves) else {}
    )
    for curve in curves:
        columns |= curve.columns
    by_name = {curve.output.name: curve for curve in curves}
    plots = [
        plot
        for curve in curves
        if curve.output.name in wishes
        for plot in laid_over(wishes[curve.output.name], curve.recovered, by_name)
    ]
    # first what each output does, then how fast, and how well
    by_quantity = zip_longest(*(curve.plots() for curve in curves))
    plots += [plot for quantity in by_quantity for plot in quantity if plot is not None]
    recovered = mechanism.recovered(theta, curves[0].recovered)
    return Outcome(findings, numbers, plots, tables, not_judged=nominal), columns, recovered


def budget_of(
    case: Case, parts: Mapping[str, Read], sources: Sequence[Mapping[str, float]]
) -> Table | None:
    """What each stage from law to file adds to the error of the outline that drives; sources: the figures of today."""
    mechanism = case.mechanism
    drive = next(
        (feature for feature in mechanism.assembly.features if isinstance(feature, CamOutline)),
        None,
    )
    if drive is None or not parts[drive.part]:
        return None
    if isinstance(drive.tip, Edge):  # to follow one takes a second for each stage
        return None
    from camgen.judge.budget import Stages, error_budget
    from camgen.judge.joints import Nominal

    part = case.parts[drive.part]
    files = parts[drive.part]
    if drive.layer is not None:
        from camgen.judge.measured import of_layer

        files = {kind: of_layer(each, drive.layer) for kind, each in files.items()}
        part = replace(part, drawn_layer=drive.layer[0])
        drive = replace(drive, layer=None)
    tolerance = mechanism.accuracy.chord_tolerance
    fit = compensation(mechanism)
    numbers = {name: value for figures in reversed(sources) for name, value in figures.items()}
    outline = part.region.outer
    stages = Stages(
        outline, Ring(*bulges(fit_arcs(outline, tolerance))), _facets(part, tolerance, fit)
    )
    nominal = Nominal(mechanism.model, (drive,), mechanism.assembly.mounts)
    return error_budget(nominal, drive, stages, files, numbers)


def judge_rows(case: Case, kinds: Sequence[str], parts: Mapping[str, Read]) -> Outcome:
    """When each pin of a drum's rows lets its tooth go, as each kind of file has it."""
    mechanism = case.mechanism
    if not mechanism.assembly.rows:
        return Outcome()
    from camgen.judge.measured import measure_bore, of_layer
    from camgen.judge.pin_rows import judge_row

    findings: list[Finding] = []
    for kind in kinds:
        for row in mechanism.assembly.rows:
            sections = parts[row.part].get(kind)
            if sections is None:
                continue
            shift = -measure_bore(row.bore, sections).centre
            own = [
                [shape.moved(shift=shift) for shape in shapes]
                for shapes in of_layer(sections, row.layer)
            ]
            rounding = FORMATS[kind].rounding * max(abs(row.tip), case.parts[row.part].thickness)
            off = mechanism.accuracy.chord_tolerance + 4 * rounding + _slack(mechanism, kind)
            findings += judge_row(row, own, in_file(case.file(row.part, kind)), off)
    return Outcome(findings)


def _facets(part: Part, tolerance: float, fit: Compensation | None) -> Ring:
    """The facets of a part's outline, as they print."""
    if fit is None:
        points = facet_contour(part.region.outer, tolerance)
        return Ring.straight(points)
    points = facet_contour(compensated(part, fit).region.outer, tolerance)
    return printed(Shape(Ring.straight(points), ()), fit.hole, fit.profile, fit.shrinkage).outer
