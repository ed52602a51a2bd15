"""Linear cams read back: the follower run along the plate's edge, from each of its files alone, against the motion asked for."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from camgen.errors import FileError
from camgen.files.formats import FORMATS, read_drawing, read_exact, read_solid
from camgen.findings import Finding, Where, at_least, at_most, in_file
from camgen.geometry.mesh import slice_mesh
from camgen.geometry.rings import Ring, shape_of
from camgen.judge.edge_runs import Tip, pressure_angle, run
from camgen.machine.model import unit_of
from camgen.machines.linear_cam.mechanism import LinearCamDrive
from camgen.numerics import Floats, magnitude, peak
from camgen.pipeline.case import Case
from camgen.pipeline.scope import Outcome
from camgen.study import Plot

_STEP = 0.125  # mm, of the way between rows of motion.csv, or less
_FEWEST = 8  # steps between them
_MOST = 5760
_WINDOW = 1.0  # mm, over which the speed is a mean: facets make raw ones rough; less of a shorter way, a step of a longer one
_CHORD = 0.01  # of the tolerance, by which chords lie off arcs as they are run over
_ROUNDING = 4.0  # steps of a file's numbers, by which it may put an edge off


@dataclass(frozen=True, eq=False)
class _Wanted:
    """What a follower is to do: the way x, (n,) mm, s and its derivative to x along it, mm or rad."""

    x: Floats
    s: Floats
    slope: Floats
    unit: str
    scale: float  # of mm or rad
    ripple: float
    steepest: float  # deg


def _wanted(mechanism: LinearCamDrive) -> _Wanted:
    low, high = mechanism.assembly.cycle.range
    way = math.degrees(high - low)
    rows = min(_MOST, max(_FEWEST, math.ceil(way / _STEP))) + 1
    theta = np.linspace(low, high, rows)
    unit, scale = unit_of(mechanism.model.outputs[0])
    steepest = next(each.limit for each in mechanism.limits() if each.code == "PRESSURE_ANGLE")
    slope = mechanism.motion(theta, 1) * math.radians(1)
    ripple = mechanism.allowed.speed_ripple
    return _Wanted(np.degrees(theta), mechanism.motion(theta), slope, unit, scale, ripple, steepest)


def judge_plate_edge(case: Case, kinds: Sequence[str]) -> Outcome:
    """The follower as each kind of file moves it."""
    mechanism = case.mechanism
    assert isinstance(mechanism, LinearCamDrive)
    (edge,) = mechanism.assembly.edges
    wanted = _wanted(mechanism)
    output = mechanism.model.outputs[0].name
    tip = Tip(edge.radius, edge.rest, edge.pivot)
    name = f"{output}_{wanted.unit}"
    columns = {"theta_mm": wanted.x, name: wanted.scale * wanted.s}
    findings: list[Finding] = []
    errors: list[tuple[str, Floats, Floats]] = []
    for kind in kinds:
        path = case.file(edge.part, kind)
        where = replace(in_file(path), output=output)
        try:
            ring = _outline(path, edge.part, mechanism.making.thickness / 2)
            ran = run(ring, tip, wanted.x, _CHORD * mechanism.accuracy.chord_tolerance)
        except (FileError, ValueError, OverflowError) as fault:
            findings.append(at_least("CONTACT", 0.0, 100, "percent", where, str(fault)))
            continue
        rounding = _ROUNDING * FORMATS[kind].rounding * magnitude(ring.points)
        findings += _findings(
            ran, tip, wanted, where, mechanism.accuracy.chord_tolerance + rounding
        )
        columns[f"{name}_{kind}"] = wanted.scale * ran
        errors.append((kind.upper(), wanted.x, wanted.scale * (ran - wanted.s)))
    label = "travel of the plate, mm"
    title = "Error of the follower, run along the files' edges"
    plots = [Plot(title, label, wanted.unit, errors)] if errors else []
    return Outcome(findings, plots=plots, columns=columns)


def _outline(path: Path, part: str, level: float) -> Ring:
    """The plate's outline in a file, of a solid at a level, mm; ValueError where there is none."""
    form = FORMATS[path.suffix[1:]]
    if form.holds == "drawing":
        rings: Sequence[Ring] = read_drawing(path, part).cut
    elif form.solid:
        rings = slice_mesh(read_solid(path, part)[0], level)
    else:
        rings = read_exact(path, part)[0].section(level)
    return shape_of(rings).outer


def _findings(
    ran: Floats, tip: Tip, wanted: _Wanted, where: Where, tolerance: float
) -> Iterator[Finding]:
    """CONTACT, MOTION_ERROR, SPEED_RIPPLE and PRESSURE_ANGLE of one file; ran: s, (n,) mm or rad."""
    x = wanted.x
    lost = np.isnan(ran)
    share = 100 * float(np.mean(~lost))
    yield at_least("CONTACT", share, 100, "percent", where, "of the travel the tip meets the edge")
    if lost.any():
        there = _at(where, x, int(np.flatnonzero(lost)[0]))
        yield at_most("MOTION_ERROR", math.nan, 0, wanted.unit, there, "nothing stops the tip")
        return
    error = ran - wanted.s
    step = float(x[1] - x[0])
    span = min(max(1, round(_WINDOW / step)), len(x) - 1)
    run_over = x[span:] - x[:-span]
    mean = f"mean of {span * step:.3g} mm"
    pressure = pressure_angle(
        tip, (ran[span:] + ran[:-span]) / 2, (ran[span:] - ran[:-span]) / run_over
    )
    lever = (1.0 if tip.pivot is None else abs(tip.rest)) * math.cos(float(np.max(pressure)))
    k = int(np.argmax(np.abs(error)))
    places = f"{len(x)} places of the travel"
    scale = wanted.scale
    limit = scale * tolerance / lever
    yield at_most("MOTION_ERROR", scale * peak(error), limit, wanted.unit, _at(where, x, k), places)
    fastest = peak(wanted.slope)
    ripple = peak((error[span:] - error[:-span]) / run_over) / fastest if fastest else 0.0
    message = f"of the follower's greatest speed, {mean} of the travel"
    yield at_most("SPEED_RIPPLE", ripple, wanted.ripple, "share", where, message)
    k = int(np.argmax(pressure))
    steep = math.degrees(float(pressure[k]))
    message = f"between the edge in the file and the follower's way, {mean}"
    middle = _at(where, (x[span:] + x[:-span]) / 2, k)
    yield at_most("PRESSURE_ANGLE", steep, wanted.steepest, "deg", middle, message)


def _at(where: Where, x: Floats, k: int) -> Where:
    """At a place of the way."""
    return replace(where, theta=math.radians(float(x[k])))
