"""What the report shows of a linkage: numbers, curves, paths, and the class of a four-bar."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, partial
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from camgen.errors import DesignError, listed
from camgen.findings import Finding, Where, at_least
from camgen.geometry.outlines import Floats, Points
from camgen.machine import model as m
from camgen.machine.centrodes import centrodes
from camgen.machine.closed_form import four_bar
from camgen.machine.features import Demand
from camgen.machine.grashof import four_bar_lengths
from camgen.machine.landmarks import double_points
from camgen.machine.reach import Fold, folds, transmission
from camgen.machine.run import Run, solve
from camgen.machine.targets import (
    NO_STROKES,
    Course,
    Lines,
    Through,
    Trace,
    extent,
    one_line,
    target_findings,
    time_ratio,
)
from camgen.machines.free_play import accepted
from camgen.machines.linkage import gearing
from camgen.machines.linkage.signals import Signal, signals_of
from camgen.machines.linkage.springs import MountedSpring
from camgen.machines.linkage.tables import LinkageLimits, Slot, Wanted
from camgen.machines.loads.lift_off import by_force
from camgen.numerics import peak
from camgen.parts.assembly import Cycle
from camgen.parts.generator.layout import Layout
from camgen.parts.generator.threads import thread_heights
from camgen.parts.generator.troughs import open_rails
from camgen.parts.wheels.geneva import GenevaLaw
from camgen.study import ROWS, Figure, Figures, Later, Plot, Sketch, Study, Table
from camgen.tolerances import SAME_POINT

_SPRINGS = (
    "spring",
    "rate, N/mm",
    "free, mm",
    "shortest, mm",
    "longest, mm",
    "least, N",
    "greatest, N",
)
_OUTPUTS = (
    "output",
    "unit",
    "least",
    "greatest",
    "stroke",
    "peak speed, /s",
    "peak acceleration, /s^2",
)
_EXTREMES = ("output", "unit", "extreme", "at theta, {}", "what it is")
_PATHS = (
    "path",
    "length, mm",
    "least radius, mm",
    "at, {}",
    "inflections at, {}",
    "cusps at, {}",
    "crosses itself at, {}",
)
_MOST_SERIES = 8  # curves of one plot
_MARKED = 60  # rows from one marked place of a path to the next: every 15 deg of a whole turn
_RETURNS = 1e-6  # of its stroke, by which an output that goes to and fro may miss its beginning after a turn
# of a point's greatest speed: where a stop is looked for, and what is one
_SLOW = 0.05
_STILL = 1e-6


@dataclass(frozen=True)
class LinkageMotion:
    """A linkage and how it moves, without what is included."""

    chain: m.Machine  # closed as drawn
    cycle: Cycle
    driven: Sequence[str]  # links that drives turn
    wanted: Sequence[Wanted]
    even: bool  # no program moves the drive
    springs: bool  # some pull on it

    def run(self, theta: ArrayLike, order: int = 2) -> Run:
        """It at theta, (n,) rad, with derivatives up to the order."""
        return solve(self.chain, theta, order)

    @cached_property
    def signals(self) -> tuple[Signal, ...]:
        """What the outputs give, as single numbers."""
        return signals_of(self.chain)

    @cached_property
    def courses(self) -> Sequence[Course]:
        """Course of each output."""
        theta = np.linspace(*self.cycle.range, ROWS)
        run = self.run(theta, 1)
        courses = []
        for wanted in self.wanted:
            turns = isinstance(self.chain.output(wanted.name).of, m.Angle)
            unit, scale = ("deg", math.degrees(1)) if turns else ("mm", 1.0)
            value, slope = scale * run.derivatives(wanted.name)
            whole = not self.cycle.to_and_fro
            courses.append(Course(theta, value, slope, unit, whole, self.cycle.unit))
        return courses

    def course_of(self, output: str) -> Course:
        """That of the output with this name."""
        pairs = zip(self.wanted, self.courses, strict=True)
        return next(course for wanted, course in pairs if wanted.name == output)


@dataclass(frozen=True)
class Build:
    """What is made of a linkage, as its figures need it."""

    layout: Layout
    machine: m.Machine  # of all, with masses and loads
    sprung: Sequence[MountedSpring]
    slots: Sequence[Slot]


def study(linkage: LinkageMotion, made: Build | None, angle: Callable[[], str]) -> Study:
    """Numbers, plots and tables of a linkage over its turn or range; made: None of one of which no bodies are made.

    angle: label of theta.
    """
    theta = np.linspace(*linkage.cycle.range, ROWS)
    run = linkage.run(theta)
    speed = linkage.chain.speed
    figures: list[Figure] = []
    rows = []
    for signal in linkage.signals:
        value, first, second = signal.scale * signal.rows(run)
        low, high = _extremes(linkage, signal, theta, value)
        peak_speed = peak(first) * abs(speed)
        peak_acceleration = peak(second) * speed**2
        name = signal.name
        unit = signal.unit
        stroke = "{of} stroke"
        if name != signal.of:
            stroke = "{of} x stroke" if signal.turned == 1 else "{of} y stroke"
        if name != signal.of and signal.turned == 1:  # the first of a path's two
            figures += _extent(run, signal.of)
        figures += [
            Figure("{of}, least", low, unit, name),
            Figure("{of}, greatest", high, unit, name),
            Figure(stroke, high - low, unit, signal.of),
            Figure("{of} peak speed", peak_speed, f"{unit}/s", name),
            Figure("{of} peak acceleration", peak_acceleration, f"{unit}/s²", name),
        ]
        rows.append((name, unit, low, high, high - low, peak_speed, peak_acceleration))
    paths_of = _path_table(linkage, theta, run)
    for name, length, radius, *_ in paths_of:
        figures.append(Figure("{of} length", length, "mm", name))
        figures.append(Figure("{of} least radius", radius, "mm", name))
    for joint in linkage.chain.joints:
        if isinstance(joint, m.Cam) and isinstance(joint.law, GenevaLaw):
            figures.append(Figure("peak speed ratio {of}", joint.law.geneva.speed, of=joint.name))
    places, ratios = _extreme_places(linkage)
    figures += ratios
    tables = [Table("Outputs", _OUTPUTS, rows)]
    by = linkage.cycle.unit
    tables += [Table("Extreme positions", _of_theta(_EXTREMES, by), places)] if places else []
    tables += [Table("Paths", _of_theta(_PATHS, by), paths_of)] if paths_of else []
    notes = []
    lengths = four_bar_lengths(linkage.chain, linkage.driven[0])
    if lengths is not None:
        bar = four_bar(*lengths.values())
        figures.append(Figure("grashof margin", bar.margin, "mm"))
        notes.append(
            f"A four-bar; by Grashof's rule a {bar.kind}: the two middle lengths together exceed the shortest and the longest by "
            f"{bar.margin:.6g} mm."
        )
    figures += [] if made is None else gearing.figures(made.layout)
    forces = Study() if made is None else _forces(linkage, made, theta, angle)
    return Study(
        Figures(figures) | forces.numbers,
        Later(
            lambda: [
                *_plots(linkage, theta, run, angle),
                *([] if made is None else gearing.plots(made.layout)),
                *forces.plots,
            ]
        ),
        [*tables, *forces.tables],
        Later(lambda: [*paths(linkage), *threads(linkage, made)]),
        [*notes, *_notes(linkage, made)],
    )


def _of_theta(heads: Sequence[str], unit: str) -> tuple[str, ...]:
    """Heads of a table with the unit of theta."""
    return tuple(head.format(unit) for head in heads)


def _notes(linkage: LinkageMotion, made: Build | None) -> list[str]:
    """What a person should know of its springs, rails, slots and links."""
    notes = []
    for cam in by_force(linkage.chain):
        figure = f"hold_{cam.name.replace(' ', '_')} is the least force that it needs"
        least = f"no spring is made for it; {figure}"
        if linkage.springs:
            least = f"{figure} beyond the springs of the spec"
        notes.append(f"{cam.name} is held by force: {least}.")
    if linkage.springs:
        notes.append(
            "You buy the springs. Each has a level of its own, which stays free along the line between its pins over the whole motion."
        )
    if made is not None:
        notes += open_rails(made.layout)
        notes += _longer_slots(made)
        notes += _bows(made.layout)
        notes += gearing.notes(made.layout)
    if linkage.cycle.to_and_fro:
        notes.append(
            "The drive goes to and fro over its range; all speeds are for a constant speed of the drive."
        )
    return notes


def _plots(linkage: LinkageMotion, theta: Floats, run: Run, angle: Callable[[], str]) -> list[Plot]:
    """Paths, centrodes and transmission angles."""
    plots = []
    step = math.degrees(theta[_MARKED] - theta[0])
    each = f"every {step:.4g} {linkage.cycle.unit}"
    for output in linkage.chain.outputs:
        if isinstance(output.of, m.Path):
            path = np.asarray(run[output.name], complex)
            marks = path[::_MARKED]  # of equal time where the drive turns evenly
            pieces = _drawn(linkage, output.name, run)
            drawn = path if len(pieces) == 1 else one_line(pieces)
            series = [("path", drawn.real, drawn.imag), (each, marks.real, marks.imag)]
            series += _wanted_places(linkage, output.name)
            dots = (each, "wanted")
            plots.append(
                Plot(_path_of(output.name, "P"), "x, mm", "y, mm", series, equal=True, dots=dots)
            )
    plots += _centrodes(linkage, run)
    bends = transmission(linkage.chain, theta)
    if bends:
        series = [(", ".join(joints), np.degrees(theta), angle) for joints, angle in bends.items()]
        plots.append(Plot("Transmission angle", angle(), "deg", series[:_MOST_SERIES]))
    return plots


def _bows(layout: Layout) -> list[str]:
    """What to say of links that are bent."""
    bows = {link: shape.bow for link, shape in layout.sizes.shapes.items() if shape.bow}
    return [
        f"Link {link} is bent by {abs(bow):g} mm, to the {'left' if bow > 0 else 'right'} as seen from its first point, so that it passes "
        f"what is in its way (parts.{link}.bow)."
        for link, bow in bows.items()
    ]


def _path_of(name: str, first: str = "p") -> str:
    """What the path of an output is called, which may be called a path itself; first: its first letter."""
    return f"{first}ath" if name == "path" else f"{first}ath of {name}"


def _wanted_places(linkage: LinkageMotion, name: str) -> list[tuple[str, Floats, Floats]]:
    """Of a path the places that it shall pass, or the line that it shall draw, how far off it may be, and by how much it is."""
    pairs = zip(linkage.wanted, linkage.courses, strict=True)
    wanted, course = next((wanted, course) for wanted, course in pairs if wanted.name == name)
    curves: list[tuple[str, Points]] = []
    points = wanted.points
    if points is not None:
        places = np.array(points.places)
        met = points.passes(course)
        passed = course.at(np.array([theta for theta, _ in met])) if met else places
        curves += [
            ("wanted", places),
            (f"within {points.tolerance:g} mm", one_line(_within(points))),
            ("missed by", one_line([*np.column_stack([places, passed])])),
        ]
    path = wanted.path
    if path is not None:
        apart = path.distance(course)
        curves += [
            ("wanted path" if path.joined else "wanted", np.array(path.places)),
            (f"within {path.tolerance:g} mm of it", one_line(_within(path))),
            ("farthest apart", np.array([apart.place, apart.foot])),
        ]
    lines = wanted.lines
    if lines is not None:
        far = lines.distance(course, linkage.course_of(lines.lift))
        curves += [
            ("wanted lines", one_line(lines.lines)),
            (f"within {lines.tolerance:g} mm of them", one_line(_within(lines))),
        ]
        curves += [] if far is None else [("farthest apart", np.array([far.place, far.foot]))]
    return [(label, z.real, z.imag) for label, z in curves]


def _drawn(linkage: LinkageMotion, name: str, run: Run) -> list[Points]:
    """Pieces of an output's path, (n,) complex mm: all of it, but for those on which another output lifts the pen."""
    path = np.asarray(run[name], complex)
    lines = next(each.lines for each in linkage.wanted if each.name == name)
    if lines is None:
        return [path]
    scale = m.unit_of(linkage.chain.output(lines.lift))[1]
    return lines.drawn(path, scale * np.asarray(run[lines.lift], float))


def _within(wanted: Through | Trace | Lines) -> list[Points]:
    """Outlines of all that is no farther from what is wanted than the path may be, (n,) complex mm each."""
    import shapely

    if isinstance(wanted, Lines):
        goal = [shapely.linestrings(z.real, z.imag) for z in wanted.lines]
    else:
        z = np.array(wanted.places)
        joined = isinstance(wanted, Trace) and wanted.joined
        goal = shapely.linestrings(z.real, z.imag) if joined else shapely.points(z.real, z.imag)
    near = shapely.union_all(shapely.buffer(goal, wanted.tolerance, quad_segs=6))
    return [
        shapely.get_coordinates(ring) @ np.array([1, 1j])
        for ring in shapely.get_parts(shapely.boundary(near))
    ]


def _longer_slots(made: Build) -> list[str]:
    """What to say of slots whose pin passes their drawn ends."""
    notes = []
    layout = made.layout
    for slot in (slot for slot in made.slots if slot.pin in layout.slots):
        low, high = layout.strokes[layout.slots[slot.pin].name]
        a, b = (layout.at(slot.link, point) for point in slot.along)
        for end, over in zip(slot.along, (-low, high - abs(b - a)), strict=True):
            if over > SAME_POINT:
                notes.append(
                    f"Slot of {slot.link}: pin {slot.pin} passes its drawn end {end} by {over:.4g} mm; camgen made the slot longer."
                )
    return notes


def targets(linkage: LinkageMotion) -> list[Finding]:
    """What is wanted of outputs by value, on the model as designed; DesignError of what no such output can have."""
    pairs = list(zip(linkage.wanted, linkage.courses, strict=True))
    for wanted, course in pairs:
        if wanted.time_ratio is not None and not course.strokes:
            remedy = "ask time_ratio of an output that goes to and fro, or leave it out"
            said = f"output {wanted.name} {NO_STROKES}"
            raise DesignError(
                "strokes",
                0,
                2,
                "",
                wanted.name,
                remedy,
            ).saying(said)
    findings: list[Finding] = []
    for wanted, course in pairs:
        where = Where(f"{wanted.name} as designed", output=wanted.name)
        findings += target_findings(wanted.targets, course, where, linkage.course_of)
    return findings


def demands(linkage: LinkageMotion, allowed: LinkageLimits) -> tuple[Demand, ...]:
    """What is asked of each output: its targets, and the play that is accepted."""
    made = []
    lifts = {each.lines.lift for each in linkage.wanted if each.lines is not None}
    for wanted, course in zip(linkage.wanted, linkage.courses, strict=True):
        lash, of = accepted(course, allowed.lash, allowed.lash_deg)
        if wanted.name in lifts:  # the pen's spring takes its play to one side
            lash = math.inf
        made.append(Demand(wanted.name, lash=lash, lash_of=of, targets=wanted.targets))
    return tuple(made)


def transmission_angles(linkage: LinkageMotion, least_deg: float) -> list[Finding]:
    """How near each loop comes to a fold, on the model as designed."""
    return [
        fold_margin(
            fold,
            least_deg,
            Where(
                listed("joint", fold.joints),
                joint=fold.joints[0] if len(fold.joints) == 1 else "",
            ),
            "least over the motion; at 0 the chain folds and may go on either way",
        )
        for fold in folds(linkage.chain, *linkage.cycle.range)
    ]


def fold_margin(fold: Fold, least_deg: float, where: Where, message: str) -> Finding:
    """TRANSMISSION_ANGLE of the place at which a loop comes nearest to a fold."""
    angle = math.degrees(math.asin(min(1.0, abs(fold.determinant))))
    place = replace(where, theta=fold.theta, angle="", digits=2)
    return at_least("TRANSMISSION_ANGLE", angle, least_deg, "deg", place, message)


def _forces(linkage: LinkageMotion, made: Build, theta: Floats, angle: Callable[[], str]) -> Study:
    """Torque of the drives and reactions of the joints at an even turn, by the masses of the parts."""
    forces = solve(made.machine, theta).forces()
    first, *others = made.machine.drives
    shown = [first, *(each for each in others if each.motor)]
    torques = {each.name: forces.drives[each.name] for each in shown}
    kind, measure = ("force", "N") if first.slide else ("torque", "N m")
    figures = [
        Figure(f"peak {kind}", max(map(peak, torques.values())), measure),
        Figure("peak kinetic energy", float(forces.energy.max()), "J"),
    ]
    rows = []
    for name, load in {**forces.reactions, **forces.normals}.items():
        greatest = peak(load)
        figures.append(Figure("reaction {joint}", greatest, "N", joint=name))
        rows.append((name, greatest, math.degrees(theta[int(np.abs(load).argmax())])))
    heads = _of_theta(("joint", "greatest, N", "at, {}"), linkage.cycle.unit)
    tables = [Table("Loads of the joints, without friction", heads, rows)]
    for cam in by_force(
        linkage.chain
    ):  # what a spring must give at least, along the follower's motion
        unit = "N m" if cam.slide is None else "N"
        push = (cam.leaves * forces.contacts[cam.name]).min()
        figures.append(Figure("hold {of}", max(0.0, -float(push)), unit, cam.name))
    of_springs = []
    for each in made.sprung:
        least, greatest = each.forces()
        figures.append(Figure("{of}, least", least, "N", each.figure))
        figures.append(Figure("{of}, greatest", greatest, "N", each.figure))
        pull = each.pull
        of_springs.append(
            (each.name, pull.rate, pull.free, each.shortest, each.longest, least, greatest)
        )
    if of_springs:
        tables.append(Table("Springs, between their points", _SPRINGS, of_springs))

    def plots() -> list[Plot]:
        names = torques if len(torques) > 1 else [kind]
        curves = [
            (name, np.degrees(theta), torque)
            for name, torque in zip(names, torques.values(), strict=True)
        ]
        what = "drives" if len(torques) > 1 else "drive"
        title = f"{kind.capitalize()} of the {what}, without friction"
        return [Plot(title, angle(), measure, curves)]

    return Study(Figures(figures), Later(plots), tables)


def timing(run: Run, driven: str) -> Study:
    """All outputs of a machine over one turn of its shaft, each from its least to its greatest; driven: link that turns."""
    series: list[tuple[str, Floats, Floats]] = []
    for output in run.machine.outputs:
        values = np.asarray(run[output.name])
        curves = {output.name: np.real(values)}
        if np.iscomplexobj(values):
            curves = {f"{output.name}_x": values.real, f"{output.name}_y": values.imag}
        for name, value in curves.items():
            share = (value - value.min()) / (np.ptp(value) or 1.0)
            series.append((name, np.degrees(run.theta), share))
    title = "Timing of the whole machine"
    return Study(plots=[Plot(title, f"{driven}, deg", "share of its stroke", series)])


def _centrodes(linkage: LinkageMotion, run: Run) -> list[Plot]:
    """Of each link that draws a path and is pinned nowhere on the ground: where its instant centre runs."""
    pins = [{pin.a.body, pin.b.body} for pin in linkage.chain.joints if isinstance(pin, m.Pin)]
    pinned = set().union(*(pair for pair in pins if m.GROUND in pair))
    paths = [each.of for each in linkage.chain.outputs if isinstance(each.of, m.Path)]
    plots = []
    for body in dict.fromkeys(path.of.body for path in paths):
        if body in pinned:
            continue
        levers = [abs(z) for z in linkage.chain.body(body).points.values()]
        fixed, moving = centrodes(run, body, max(levers, default=0.0))
        if np.count_nonzero(np.isfinite(fixed)) > 1:
            series = [
                ("on the ground", fixed.real, fixed.imag),
                (f"on {body}, in its axes", moving.real, moving.imag),
            ]
            title = f"Centrodes of {body}: one rolls on the other"
            plots.append(Plot(title, "x, mm", "y, mm", series, equal=True))
    return plots


def paths(linkage: LinkageMotion) -> tuple[Sketch, ...]:
    """Paths of points, on the ground, and the places that they shall pass, with the room that they have."""
    run = linkage.run(np.linspace(*linkage.cycle.range, ROWS // 2), 0)
    outputs = linkage.chain.outputs
    levels = {each.name: each.of.of.body for each in outputs if isinstance(each.of, m.Path)}
    sketches = [
        Sketch(_path_of(name), _drawn(linkage, name, run), level=level)
        for name, level in levels.items()
    ]
    for wanted in linkage.wanted:
        for goal in (wanted.points, wanted.path, wanted.lines):
            if goal is None:
                continue
            strokes = _within(goal)
            dots = []
            if isinstance(goal, Lines):
                strokes += goal.lines
            elif isinstance(goal, Trace) and goal.joined:
                strokes.append(np.array(goal.places))
            else:
                z = np.array(goal.places)
                radius = max(float(np.ptp(z.real) + np.ptp(z.imag)) / 250, SAME_POINT)
                dots = [(place, radius) for place in goal.places]
            level = levels.get(wanted.name, "")
            sketches.append(Sketch(f"{wanted.name}: wanted", strokes, dots, level=level))
    return tuple(sketches)


def threads(linkage: LinkageMotion, made: Build | None) -> list[Sketch]:
    """Threads that are outputs, in the middle of their grooves."""
    sketches = []
    for each in linkage.wanted:
        if each.thread:
            z = None if made is None else float(np.mean(thread_heights(made.layout)))
            sketches.append(Sketch(each.name, course=partial(_course, linkage, each.thread), z=z))
    return sketches


def _course(linkage: LinkageMotion, thread: Sequence[str], theta: Floats) -> Points:
    """A thread from point to point at theta, (n,) rad; (n, points) complex mm."""
    run = linkage.run(theta, 0)
    bodies = linkage.chain.bodies
    carriers = (next(body.name for body in bodies if point in body.points) for point in thread)
    places = [run.point(body, point)[0] for body, point in zip(carriers, thread, strict=True)]
    return np.stack(places, axis=-1)


def _extent(run: Run, path: str) -> list[Figure]:
    """Stroke of a path: its largest extent, mm, and the direction of that, deg from the x axis."""
    size, along = extent(np.asarray(run[path], complex))
    return [
        Figure("{of} stroke", size, "mm", path),
        Figure("{of} stroke along", math.degrees(along), "deg", path),
    ]


def _extreme_places(linkage: LinkageMotion) -> tuple[list[tuple[object, ...]], list[Figure]]:
    """Where angles and places turn back: there the output could not drive; the time ratio of each that goes to and fro."""
    rows: list[tuple[object, ...]] = []
    ratios: list[Figure] = []
    for wanted, course in zip(linkage.wanted, linkage.courses, strict=True):
        values = course.value
        if np.iscomplexobj(values) or abs(values[-1] - values[0]) > _RETURNS * np.ptp(values):
            continue
        dead = "turns back: a dead point for a force at the output"
        for sign in (-1, 1):
            theta, value = course.extreme(sign)
            inside = course.whole or course.theta[0] < theta < course.theta[-1]
            kind = dead if inside else "end of the range"
            rows.append((wanted.name, course.unit, value, math.degrees(theta), kind))
        if course.strokes:
            ratios.append(Figure("{of} time ratio", time_ratio(course)[0], of=wanted.name))
    return rows, ratios


def _path_table(
    linkage: LinkageMotion, theta: Floats, run: Run
) -> list[tuple[str, float, float, float, str, str, str]]:
    """Length of each path, its sharpest place, where it is straight for a moment, where it has cusps and crosses itself.

    A cusp is a place where the point stands still for a moment.
    """
    rows = []
    whole = not linkage.cycle.to_and_fro
    for output in (each for each in linkage.chain.outputs if isinstance(each.of, m.Path)):
        _, first, second = np.asarray(run.derivatives(output.name), complex)
        speed = np.abs(first)
        bend = (np.conj(first) * second).imag
        length = float(np.sum((speed[1:] + speed[:-1]) / 2 * np.diff(theta)))
        if not length > 0:
            continue
        with np.errstate(all="ignore"):
            radius = np.where(speed > 0, speed**3 / np.abs(bend), np.inf)
        sharp = int(np.argmin(radius))
        stops = _stops(linkage, output.name, theta, speed, whole)
        turns = np.signbit(bend[1:]) != np.signbit(bend[:-1])
        straight = [
            f"{math.degrees(theta[k]):.1f}"
            for k in np.flatnonzero(turns & (speed[1:] > _STILL * speed.max()))
            if all(abs(theta[k] - stop) > 0.02 for stop in stops)
        ]
        crossings = []
        if whole and not stops and linkage.even:
            pairs, _ = double_points(
                lambda t, order, name=output.name: _jet(linkage, name, t)[order],  # type: ignore[misc]
                720,
            )
            crossings = [
                " and ".join(f"{math.degrees(t) % 360:.1f}" for t in pair) for pair in pairs
            ]
        rows.append(
            (
                output.name,
                length,
                0.0 if stops else float(radius[sharp]),
                math.degrees(stops[0] if stops else theta[sharp]),
                ", ".join(straight),
                ", ".join(f"{math.degrees(t):.2f}" for t in stops),
                "; ".join(crossings),
            )
        )
    return rows


def _jet(linkage: LinkageMotion, name: str, theta: Floats) -> Any:
    return linkage.run(theta).derivatives(name)


def _stops(
    linkage: LinkageMotion, name: str, theta: Floats, speed: Floats, whole: bool
) -> list[float]:
    """Angles at which a path's point stands still for a moment, rad: the least speeds, by Newton's method from the samples."""
    near = np.flatnonzero(
        (speed <= np.roll(speed, 1)) & (speed <= np.roll(speed, -1)) & (speed < _SLOW * speed.max())
    )
    t = theta[near if whole else near[(near > 0) & (near < len(theta) - 1)]]
    if not linkage.even or not t.size:  # a program's rests are none
        return []
    for _ in range(20):
        _, first, second = _jet(linkage, name, t)
        t = t - np.clip(
            (np.conj(second) * first).real / np.maximum(np.abs(second) ** 2, 1e-300), -0.01, 0.01
        )
    still = np.abs(_jet(linkage, name, t)[1]) < _STILL * speed.max()
    return sorted({round(float(x % math.tau if whole else x), 9) for x in t[still]})


def _extremes(
    linkage: LinkageMotion, signal: Signal, theta: Floats, value: Floats
) -> tuple[float, float]:
    """Least and greatest of a signal, in its unit: the sample's, refined between its neighbours."""
    ends = [int(np.argmin(value)), int(np.argmax(value))]
    near = [np.linspace(theta[max(k - 1, 0)], theta[min(k + 1, len(theta) - 1)], 257) for k in ends]
    fine = signal.scale * signal.rows(linkage.run(np.concatenate(near), 0))[0]
    return float(fine.min()), float(fine.max())
