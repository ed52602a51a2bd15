"""Drums read back: the roller rolled in the track of each, from its files alone, against the motion that was asked for.

Of an exact solid, its splines as triangles within the tolerance.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from camgen.errors import DesignError
from camgen.files.formats import EXACT, FORMATS, SOLID, read_exact, read_solid
from camgen.findings import Finding, Where, at_most, in_file
from camgen.geometry.mesh import Mesh
from camgen.judge.drum_pieces import DrumPieces, pieces_findings, placed, together
from camgen.judge.rolled_drum import (
    SAMPLES,
    Rolled,
    RollerTable,
    roll,
    roller_table,
    track_findings,
)
from camgen.machine.features import DrumTrack
from camgen.machine.model import Cam, Output, unit_of
from camgen.machines.mechanism import Mechanism
from camgen.numerics import Floats, low_passed, magnitude, peak
from camgen.pipeline.case import Case
from camgen.pipeline.scope import Outcome
from camgen.study import Figure, Figures, Plot

HARMONICS = 60  # of a turn, at which speeds are low-passed: facets make raw ones rough
_EACH = 2  # of the judge's angles, one is a row of motion.csv: a quarter degree
_ROUNDING = 4.0  # steps of a file's numbers, by which it may put a wall off


@dataclass(frozen=True)
class _Follower:
    """A follower's motion as designed, and what of it is accepted."""

    output: Output
    law: Cam
    lash: float  # rad or mm
    ripple: float  # of the speed, as a share of the greatest


def _follower(mechanism: Mechanism, track: DrumTrack) -> _Follower:
    joint = mechanism.model.cam(track.joint)
    output = mechanism.model.outputs[0]
    lash = next(
        (each.lash for each in mechanism.assembly.demands if each.output == output.name), math.inf
    )
    return _Follower(output, joint, lash, track.ripple)


def judge_drum(case: Case, kinds: Sequence[str]) -> Outcome:
    """The follower of a machine's drum as each kind of solid moves it."""
    mechanism = case.mechanism
    (track,) = mechanism.assembly.tracks
    follower = _follower(mechanism, track)
    middle = track.rest + float(np.mean(follower.law.law(np.linspace(0, math.tau, SAMPLES), 0)))
    table = roller_table(track, mechanism.accuracy.chord_tolerance, middle)
    press = mechanism.print.press_clearance
    unit, scale = unit_of(follower.output)
    findings: list[Finding] = []
    figures: list[Figure] = []
    columns: dict[str, Floats] = {}
    errors: list[tuple[str, Floats, Floats]] = []
    plays: list[tuple[str, Floats, Floats]] = []
    for kind in (kind for kind in kinds if kind in (*SOLID, *EXACT)):
        path = case.file(track.part, kind)
        where = replace(in_file(path), output=follower.output.name)
        if kind in EXACT and not path.exists():  # told of the part
            continue
        try:
            mesh = _mesh(path, track.part, table.tolerance)
            if track.ring is not None:
                file = case.file(track.ring.part, kind)
                ring = placed(_mesh(file, track.ring.part, table.tolerance), track.ring.top)
            if track.ring is not None and kind in EXACT:  # of which this has the tracks alone
                mesh = together(mesh, ring)
            elif track.ring is not None:
                pieces = DrumPieces(mesh, ring, track.ring.key)
                findings += pieces_findings(
                    pieces, track.ring.corner, press, table.tolerance, where
                )
                figures += _key_figures(pieces, follower, kind)
                mesh = together(mesh, pieces.ring)
            rolled = roll(mesh, table, HARMONICS)
        except DesignError as fault:
            findings.append(at_most("MOTION_ERROR", math.nan, 0, unit, where, fault.sentence))
            continue
        wanted = follower.law.law(rolled.theta, 0)
        error = rolled.motion - track.rest - wanted
        rounding = _ROUNDING * FORMATS[kind].rounding * magnitude(mesh.vertices)
        findings += _findings(rolled, table, follower, error, where, rounding)
        findings += track_findings(rolled, table, where, track.clearance)
        degrees = np.degrees(rolled.theta)
        errors.append((kind.upper(), degrees, np.asarray(scale * error)))
        if rolled.track != "end" and np.isfinite(rolled.play).any():
            plays.append((kind.upper(), degrees, np.asarray(scale * rolled.play)))
            figures += [
                Figure("play least {of}", scale * float(np.nanmin(rolled.play)), unit, of=kind),
                Figure("play most {of}", scale * float(np.nanmax(rolled.play)), unit, of=kind),
            ]
        name = f"{follower.output.name}_{unit}"
        columns.setdefault("theta_deg", np.append(degrees[::_EACH], 360.0))
        columns.setdefault(name, _turn(scale * wanted))
        columns[f"{name}_{kind}"] = _turn(scale * (rolled.motion - track.rest))
    label = "cam angle, deg"
    plots = (
        [Plot("Error of the follower, rolled in the files", label, unit, errors)] if errors else []
    )
    plots += [Plot("Play between both walls", label, unit, plays)] if plays else []
    return Outcome(findings, Figures(figures), plots, columns=columns)


def _key_figures(pieces: DrumPieces, follower: _Follower, kind: str) -> list[Figure]:
    """What a ring's key leaves of its angle, and what that does to the follower: it goes half as far as one of its walls."""
    unit, scale = unit_of(follower.output)
    fastest = peak(follower.law.law(np.linspace(0, math.tau, SAMPLES), 1))
    play = pieces.play
    return [
        Figure("key play {of}", math.degrees(play), "deg", of=kind),
        Figure("follower by key play {of}", scale * fastest * play / 2, unit, of=kind),
    ]


def _mesh(path: Path, part: str, tolerance: float) -> Mesh:
    """The solid in a file, of an exact one its track alone."""
    if path.suffix[1:] in EXACT:
        return read_exact(path, part)[0].facets(tolerance)
    return read_solid(path, part)[0]


def _turn(values: Floats) -> Floats:
    """Rows of motion.csv: both ends of the turn."""
    return np.append(values[::_EACH], values[0])


def _findings(
    rolled: Rolled,
    table: RollerTable,
    follower: _Follower,
    error: Floats,
    where: Where,
    rounding: float,
) -> Iterator[Finding]:
    """MOTION_ERROR, SPEED_RIPPLE and LASH of one file."""
    unit, scale = unit_of(follower.output)
    lever = (table.arm or 1.0) * math.cos(peak(rolled.pressure_angle))
    limit = (table.tolerance + rolled.between + rounding) / lever
    worst = peak(error) if np.isfinite(error).all() else math.nan
    at = (
        replace(where, theta=float(rolled.theta[int(np.nanargmax(np.abs(error)))]))
        if np.isfinite(error).any()
        else where
    )
    angles = f"{len(rolled.theta)} angles; between two of them a wall may stand {rolled.between:.2g} mm nearer, which the limit allows"
    yield at_most("MOTION_ERROR", scale * worst, scale * limit, unit, at, angles)
    if math.isfinite(worst):
        fastest = peak(follower.law.law(rolled.theta, 1))
        ripple = peak(low_passed(error, 1, HARMONICS)) / fastest if fastest else 0.0
        message = (
            f"share of the follower's greatest speed, low-passed at {HARMONICS} harmonics of a turn"
        )
        yield at_most("SPEED_RIPPLE", ripple, follower.ripple, "share", where, message)
    if rolled.track != "end":
        play = rolled.play
        worst = float(np.max(play)) if np.isfinite(play).all() else math.nan
        message = "most play of the roller between both walls"
        yield at_most("LASH", scale * worst, scale * follower.lash, unit, where, message)
