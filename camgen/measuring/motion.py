"""From a cam's outline, made by any tool, to the motion of its follower: roll the tip on it and report what comes out.

s      the follower's displacement, rad on an arm and mm on a slide, counted as its table says
v, a   derivatives of s to the cam angle, low-passed: facets and file decimals make raw ones rough
lash   free play of a follower with two tips, on one outline or on two that turn together
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from camgen.errors import DesignError, Fault, FileError, SpecError
from camgen.files.folder import name_of
from camgen.findings import Finding, Where, at_least, at_most, in_file
from camgen.geometry.rings import Floats, Ring
from camgen.judge.contact import contact
from camgen.judge.follower_table import FollowerTable, pair_faults, read_follower
from camgen.machine.features import PartPose
from camgen.measuring.folder import OUTLINE_PACKAGES, write_folder
from camgen.measuring.outlines import Hints, Outline, read_outline
from camgen.measuring.scan import PICTURES, WALL_OFF, Scanning
from camgen.numerics import STEEPNESS, low_passed, magnitude
from camgen.report.animation import Animation, Body
from camgen.report.report import Report
from camgen.study import Figure, Figures, Plot, Table, figures_in

if TYPE_CHECKING:
    from camgen.measuring.against import Comparison

MOST_HARMONICS = 1800
HARMONICS = 36  # of a turn, the last of which the low-pass halves: details of 10 deg of cam angle and more stay
_SAMPLES = 7200  # over the turn
_EACH = 5  # of which every fifth is a row of motion.csv: a quarter degree
_OVERLAP = 2e-3  # mm at two tips together that facets and decimals of a file may feign
_ROUGH = 0.5  # deg, by which facets or noise may raise the largest pressure angle before it is told
_FRAMES = 120  # of the moving picture
_WAYS = {"deg": "swing", "mm": "stroke"}  # what the whole way is called, by its unit

# ---- the motion ------------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Recovered:
    """A follower's motion over one turn, each (n,): cam angle, displacement, low-passed derivatives to it, pressure angle
    (of the outline as it is: noise of measured points is in it).

    Displacement (rad or mm) and pressure angle (rad) are nan where the tip does not rest on the outline; the derivatives
    then are nan throughout. start: displacement from which s is counted; lever: the least way, mm per unit of s, by which
    the follower moves off the contact's tangent.
    """

    theta: Floats
    s: Floats
    speed: Floats
    acceleration: Floats
    pressure_angle: Floats
    start: float
    lever: float


def recover(ring: Ring, follower: FollowerTable, harmonics: int = HARMONICS) -> Recovered:
    """Roll the tip on an outline over one turn, its end left out.

    DesignError where the follower does not fit the outline: the shaft outside, the pivot inside, or nowhere in reach.
    """
    ring = follower.mounted(ring)
    near, far = (float(bound(np.abs(ring.samples()))) for bound in (np.min, np.max))
    if not ring.encloses(0j):
        remedy = "give the shaft's place in the file as centre=X/Y, or take another contour=2"
        raise DesignError(
            "distance of the shaft (0, 0) from the outline", near, 0.0, "mm", "its outside", remedy
        )
    if follower.motion == "oscillating" and not follower.inside and abs(follower.axle) < near:
        remedy = "the outline runs round the follower's pivot: move the pivot out"
        raise DesignError(
            "distance of the pivot from the shaft",
            abs(follower.axle),
            near,
            "mm",
            "the whole turn",
            remedy,
        )
    theta: Floats = np.linspace(0, math.tau, _SAMPLES, endpoint=False)
    touch = contact(ring, follower.form).touch(theta)
    if np.isnan(touch.angle).all():
        remedy = f"it never touches the outline, {near:.6g} to {far:.6g} mm from the shaft: check pivot, arm, leaves or offset"
        slides = follower.motion == "translating"
        distance = (
            abs(follower.offset or 0.0)
            if slides
            else abs(abs(follower.axle) - (follower.arm or 0.0))
        )
        limit = far + (follower.radius or 0.0)
        raise DesignError(
            "the follower's least distance from the shaft",
            distance,
            limit,
            "mm",
            "the whole turn",
            remedy,
        )
    s = touch.angle
    start = 0.0 if follower.anchored else float((np.nanmin if follower.sense > 0 else np.nanmax)(s))
    speed, acceleration = (low_passed(s, order, harmonics) for order in (1, 2))
    if follower.motion == "oscillating" and follower.shape == "flat":
        lever = float(np.nanmin(np.abs(touch.place)))
    else:
        lever = (follower.arm or 1.0) * math.cos(float(np.nanmax(np.abs(touch.pressure_angle))))
    return Recovered(theta, s - start, speed, acceleration, touch.pressure_angle, start, lever)


def roll(
    path: Path,
    table: str | PathLike[str] | Mapping[str, Any],
    height: float | None,
    layer: str | None,
    harmonics: int,
) -> Recovered:
    """Motion of a follower on the outline in a file, as `recover`; FileError where the file holds none that is closed."""
    follower = read_follower(table, "follower")
    if not 1 <= harmonics <= MOST_HARMONICS:
        raise SpecError([Fault(("harmonics",), f"{harmonics}", f"1 to {MOST_HARMONICS}")])
    outline = read_outline(path, Hints(height, layer), follower.contour)
    if outline.ring is None:
        raise FileError(
            path, "; ".join(f"{f.code}: {f.message}" for f in outline.findings if not f.ok)
        )
    return recover(outline.ring, follower, harmonics)


# ---- the report ------------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Request:
    """What a person wants of `camgen motion`."""

    follower: str
    second_follower: str | None = None
    second: Path | None = None  # outline of the second tip; None: the first one's
    hints: Hints = Hints()
    harmonics: int = HARMONICS
    against: Path | None = None  # spec of the cam that the outline was measured on


@dataclass(frozen=True)
class _Rolling:
    """A follower on one outline."""

    path: Path  # of the outline
    ring: Ring
    follower: FollowerTable
    motion: Recovered
    harmonics: int
    play: Floats | None = None  # of a second tip, (n,) rad or mm


def run(
    path: Path, request: Request, out: Path, progress: Callable[[str], None] = lambda _: None
) -> Report:
    """Read an outline, roll the follower on it, write OUT/<file>-motion/ with report.html, report.json and motion.csv.

    Raises SpecError, FileError or DesignError; where the outline is open or crosses itself, a finding says so.
    """
    followers = _followers(path, request)
    follower, other = followers
    # what is rolled on: file and contour, one or two
    places = {(path, follower.contour): None}
    if other is not None:
        places[request.second or path, other.contour] = None
    outlines = {}
    for file, contour in places:
        progress(f"reading {file.name}")
        outlines[file, contour] = read_outline(file, request.hints, contour)
    findings = [finding for outline in outlines.values() for finding in outline.findings]
    name = name_of(path)
    report = Report(f"{name}-motion", "motion of an outline", list(dict.fromkeys(findings)))
    columns: Mapping[str, Floats] = {}
    if all(outline.ring is not None for outline in outlines.values()):
        report, columns = _rolled(report, outlines, request, followers, progress)
    report = replace(report, remarks=list(_summary(report, follower)))
    return write_folder(report, columns, out, OUTLINE_PACKAGES, progress)


def _followers(path: Path, request: Request) -> tuple[FollowerTable, FollowerTable | None]:
    """The follower and the second tip; SpecError where they, or other options, do not go with each other or with the file."""
    follower = read_follower(request.follower)
    other = None
    if request.second_follower:
        other = read_follower(request.second_follower, "--second-follower")
    faults = pair_faults(follower, other) if other is not None else ()
    if faults:
        raise SpecError(faults, "command line")

    def fault(value: object, expected: str, option: str) -> Sequence[Fault]:
        return [Fault((), str(value), expected, source=option)]

    if request.second is not None and other is None:
        expected = "--second-follower, the tip that rides on it"
        raise SpecError(fault(request.second, expected, "--second"), "command line")
    if request.against is not None and (
        other is not None or follower.inside or follower.contour not in (None, 1)
    ):
        expected = "one follower, on the outside of a cam"
        raise SpecError(fault(request.against, expected, "--against"), "command line")
    kind = path.suffix.lower()
    if request.hints.scanning != Scanning() and kind not in PICTURES:
        expected = f"a scan, {', '.join(PICTURES)}"
        options = "--dpi, --second-scan, --across"
        raise SpecError(fault(path.name, expected, options), "command line")
    if request.hints.probe and kind != ".csv":
        raise SpecError(fault(path.name, "measured points, .csv", "--probe"), "command line")
    return follower, other


def _rolled(
    report: Report,
    outlines: Mapping[tuple[Path, int | None], Outline],
    request: Request,
    followers: tuple[FollowerTable, FollowerTable | None],
    progress: Callable[[str], None],
) -> tuple[Report, Mapping[str, Floats]]:
    """The report with the motion on the outlines, one for each follower or one for both, and the columns of motion.csv."""
    follower, other = followers
    (path, _), first = next(iter(outlines.items()))
    *_, last = outlines.values()
    ring = first.ring
    numbers = first.numbers
    compared = None
    if request.against is not None:
        progress("fitting the outline to the cam of the spec")
        compared = _compared(first, path, request)
        ring = compared.ring
        if "scale_percent" in compared.numbers:  # found from the outline: it is off no more
            numbers = Figures(each for each in numbers.records if each.key != "scanner_off_mm")
    progress("rolling")
    assert ring is not None and last.ring is not None
    motion = recover(ring, follower, request.harmonics)
    play = None
    if other is not None:
        limit = recover(last.ring, other, request.harmonics).s
        if follower.motion == "translating" and follower.inside == other.inside:
            limit = -limit  # the second tip's way out is the first one's way in
        play = (-1 if follower.inside else 1) * follower.sense * (limit - motion.s)
    rolling = _Rolling(path, ring, follower, motion, request.harmonics, play)
    remarks = [f"{file.name}: {outline.remark}" for (file, _), outline in outlines.items()]
    report, columns = _report(rolling, report, remarks)
    report = replace(report, numbers=report.numbers | _measured(numbers, motion, follower))
    if compared is not None:
        report, columns = _with_comparison(report, columns, compared, rolling)
    return report, columns


def _summary(report: Report, follower: FollowerTable) -> Iterator[str]:
    """What a person asked for, in a few lines: the rest is in the report."""
    numbers = report.numbers
    unit = follower.unit[0]
    way = numbers.get(f"{_WAYS[unit]}_{unit}")
    if way is not None:
        sentence = f"the follower moves {way:.4g} {unit}"
        level = numbers.get(f"edge_level_in_motion_{unit}")
        yield sentence + (
            f"; the level at which the edge is taken may shift it by {level:.2g} {unit}"
            if level is not None
            else ""
        )
    raw, smooth = (
        numbers.get(key, math.nan)
        for key in ("pressure_angle_deg", "pressure_angle_low_passed_deg")
    )
    if raw - smooth > _ROUGH:
        yield f"the outline is rough: its pressure angle is {raw:.4g} deg at most, {smooth:.4g} deg low-passed as the speed"
    if f"motion_error_max_{unit}" in numbers:
        error, rms = (numbers[f"motion_error_{what}_{unit}"] for what in ("max", "rms"))
        least = numbers["deviation_min_mm"]
        most = numbers["deviation_max_mm"]
        yield (
            f"against the spec's cam it is {error:.3g} {unit} off at most, {rms:.2g} rms; the outline lies {least:+.3f} to "
            f"{most:+.3f} mm outside; {report.notes[0]}"
        )


def _report(
    rolling: _Rolling, empty: Report, remarks: Sequence[str]
) -> tuple[Report, Mapping[str, Floats]]:
    """The report on a recovered motion, and the columns of motion.csv: every quarter degree, both ends of the turn included."""
    follower = rolling.follower
    motion = rolling.motion
    play = rolling.play
    lost = np.isnan(motion.s)
    where = in_file(rolling.path)
    if lost.any():
        where = replace(where, theta=float(motion.theta[np.flatnonzero(lost)[0]]))
    contact_share = 100 * float(np.mean(~lost))
    findings = [
        *empty.findings,
        at_least(
            "CONTACT",
            contact_share,
            100,
            "percent",
            where,
            "of the turn the tip rests on the outline"
            + ("; no speed or acceleration is given" if lost.any() else ""),
        ),
    ]
    name, scale = follower.unit
    key = "swing_deg" if name == "deg" else "lift_mm"
    columns = {
        "theta_deg": np.degrees(motion.theta),
        key: motion.s * scale,
        f"speed_{name}_rad": motion.speed * scale,
        f"acceleration_{name}_rad2": motion.acceleration * scale,
        "pressure_angle_deg": np.degrees(motion.pressure_angle),
    }
    figures = _extremes(rolling)
    if play is not None:
        columns[f"lash_{name}"] = play * scale
        findings.append(_overlap(in_file(rolling.path), play, motion, follower))
        ends = {"lash_max": np.nanmax(play), "lash_min": np.nanmin(play)}
        figures += figures_in(name, **{key: float(end) * scale for key, end in ends.items()})
    turn = {key: _rows(value) for key, value in columns.items()}
    turn["theta_deg"][-1] = 360.0
    harmonics = rolling.harmonics
    passed = f"low-passed at {harmonics} harmonics"
    label = "cam angle, deg"
    theta = turn["theta_deg"]
    shown = [
        ("Follower", name, key),
        (f"Speed, {passed}", f"{name} per rad", f"speed_{name}_rad"),
        (f"Acceleration, {passed}", f"{name} per rad²", f"acceleration_{name}_rad2"),
        (
            "Pressure angle, positive ccw of the follower's outward motion",
            "deg",
            "pressure_angle_deg",
        ),
        ("Lash of the pair", name, f"lash_{name}"),
    ]
    plots = [
        Plot(title, label, unit, [(title, theta, turn[key])], places=title == "Follower")
        for title, unit, key in shown
        if key in turn
    ]
    notes = [
        *remarks,
        f"Speed and acceleration are derivatives to the cam angle, {passed} of a turn: harmonic n counts by "
        f"1 / (1 + (n / {harmonics})^{STEEPNESS}). The displacement itself is not filtered.",
        "Nor is the pressure angle: facets, or noise of measured points, tilt it; pressure_angle_low_passed_deg is without them.",
        "The cam turns counter-clockwise about the shaft. " + _counted(follower, motion),
    ]
    filled = Report(
        empty.name,
        empty.mechanism,
        findings,
        Figures(figures),
        (),
        plots,
        (_table(motion, follower),),
        notes,
        _animation(rolling),
        None,
        ("motion.csv", "report.json", "manifest.json"),
    )
    return filled, turn


def _rows(values: Floats) -> Floats:
    """A column of motion.csv from values over the turn."""
    return np.append(values[::_EACH], values[0])


def _counted(follower: FollowerTable, motion: Recovered) -> str:
    """From where s is counted, in words."""
    if follower.motion == "oscillating":
        what = "face's normal" if follower.shape == "flat" else "arm"
        way = f"The angle of the {what} is counter-clockwise positive, "
        from_ = math.degrees(np.angle(follower.reference) + motion.start)
    else:
        way = "The follower's displacement is positive outwards, "
        from_ = (follower.at or 0.0) + motion.start
    kind = "" if follower.anchored else "its innermost position, "
    return (
        way
        + f"from {kind}{from_:.6g} "
        + ("deg" if follower.motion == "oscillating" else "mm from the shaft")
        + "."
    )


def _extremes(rolling: _Rolling) -> list[Figure]:
    """Figures of the motion and the outline; what is low-passed is nan where contact is lost."""
    motion = rolling.motion
    ring = rolling.ring
    follower = rolling.follower
    edge = np.abs(follower.mounted(ring).samples())
    name, scale = follower.unit
    smooth_angle = low_passed(motion.pressure_angle, 0, rolling.harmonics)
    speed, acceleration, smooth = (
        magnitude(each) for each in (motion.speed, motion.acceleration, smooth_angle)
    )
    way = float(np.nanmax(motion.s) - np.nanmin(motion.s))
    steepest = float(np.nanmax(np.abs(motion.pressure_angle)))
    return [
        Figure(_WAYS[name], way * scale, name),
        Figure("peak speed", speed * scale, f"{name}/rad"),
        Figure("peak acceleration", acceleration * scale, f"{name}/rad²"),
        Figure("pressure angle", math.degrees(steepest), "deg"),
        Figure("pressure angle low passed", math.degrees(smooth), "deg"),
        Figure("radius min", float(edge.min()), "mm"),
        Figure("radius max", float(edge.max()), "mm"),
        Figure("outline length", ring.length, "mm"),
        Figure("outline area", abs(ring.area), "mm²"),
    ]


def _table(motion: Recovered, follower: FollowerTable) -> Table:
    rows = []
    name, scale = follower.unit
    for what, unit, values, each in (
        ("follower", name, motion.s, scale),
        ("speed", f"{name} per rad", motion.speed, scale),
        ("acceleration", f"{name} per rad²", motion.acceleration, scale),
        ("pressure angle", "deg", motion.pressure_angle, math.degrees(1)),
    ):
        if np.isnan(values).all():
            continue
        low = int(np.nanargmin(values))
        high = int(np.nanargmax(values))
        at = (math.degrees(motion.theta[low]), math.degrees(motion.theta[high]))
        rows.append([what, unit, values[low] * each, at[0], values[high] * each, at[1]])
    return Table("Extremes", ("quantity", "unit", "least", "at, deg", "greatest", "at, deg"), rows)


def _measured(figures: Figures, motion: Recovered, follower: FollowerTable) -> Figures:
    """Figures of what measured the outline, and what each way in which the wall may be off does to the motion."""
    name, scale = follower.unit
    return figures | [
        replace(each, quantity="{of} in motion", value=each.value / motion.lever * scale, unit=name)
        for each in figures.records
        if each.quantity == WALL_OFF
    ]


def _compared(outline: Outline, path: Path, request: Request) -> Comparison:
    """The outline of the first file on the cam of the spec that it is held against."""
    from camgen.measuring.against import compare

    assert outline.ring is not None and request.against is not None
    figures = outline.numbers
    scanning = request.hints.scanning
    alone = path.suffix.lower() in PICTURES and not scanning.others and scanning.across is None
    off = (
        math.nan
        if "scanner_off_mm" in figures
        else sum(each.value for each in figures.records if each.quantity == WALL_OFF)
    )
    return compare(outline.ring, request.against, figures.get("bore_mm"), off, alone)


def _with_comparison(
    report: Report,
    columns: Mapping[str, Floats],
    compared: Comparison,
    rolling: _Rolling,
) -> tuple[Report, Mapping[str, Floats]]:
    """The report with what the spec's own cam does to the same follower, and where the outline stands off it."""
    name, scale = rolling.follower.unit
    nominal = recover(compared.wanted, rolling.follower, rolling.harmonics).s
    miss = (rolling.motion.s - nominal) * scale
    errors = figures_in(
        name,
        motion_error_max=float(np.nanmax(np.abs(miss))),
        motion_error_rms=float(np.sqrt(np.nanmean(miss**2))),
    )
    numbers = report.numbers | compared.numbers | errors
    ends = {f"wanted_{name}": nominal * scale, f"error_{name}": miss}
    columns = {**columns, **{key: _rows(value) for key, value in ends.items()}}
    plots = [
        *report.plots,
        Plot(
            "Motion less that of the spec's cam",
            "cam angle, deg",
            name,
            [("error", columns["theta_deg"], columns[f"error_{name}"])],
        ),
        Plot(
            "Outline outside the spec's",
            "angle about the shaft, deg",
            "mm",
            [("deviation", compared.angle, compared.outside)],
        ),
    ]
    return replace(
        report, numbers=numbers, plots=plots, notes=(compared.remark, *report.notes)
    ), columns


def _overlap(where: Where, play: Floats, motion: Recovered, follower: FollowerTable) -> Finding:
    """Whether the pair leaves room for both tips everywhere, but for what facets and decimals feign."""
    least = int(np.nanargmin(play))
    return at_most(
        "INTERFERENCE",
        max(0.0, -play[least]) * motion.lever,
        _OVERLAP,
        "mm",
        replace(where, theta=float(motion.theta[least])),
        f"largest overlap of both tips with the pair; the limit is {_OVERLAP:g} mm at the tips",
    )


def _animation(rolling: _Rolling) -> Animation:
    """The outline turning under the follower."""
    motion = rolling.motion
    follower = rolling.follower
    step = len(motion.theta) // _FRAMES
    theta = motion.theta[::step]
    s = motion.s[::step] + motion.start
    outline = follower.mounted(rolling.ring)
    at = follower.reference
    still = np.zeros(len(theta), complex)
    circles = [(at, follower.radius)] if follower.radius else []
    size = 0.6 * magnitude(outline.points)
    if follower.motion == "oscillating":
        pose = PartPose(still + follower.axle, s)
        strokes = [np.array([0, at])]
        if follower.shape == "flat":
            extent = -1j * follower.sense * np.array([0, abs(follower.axle) + 1.5 * size])
            strokes = [at * ((follower.face_offset or 0.0) + extent)]
    else:
        pose = PartPose(np.asarray(follower.direction * s, complex), np.zeros(len(theta)))
        strokes = [np.array([at, at + size * follower.direction])]
        if follower.shape == "flat":
            strokes.append(at + size * 1j * follower.direction * np.array([-1.5, 1.5]))
    bodies = [
        Body("cam", [PartPose(still, theta)], [(outline.points, outline.bulges)]),
        Body("follower", [pose], (), strokes, circles),
    ]
    name, scale = follower.unit
    return Animation(theta, bodies, motion.s[::step] * scale, "follower", name)
