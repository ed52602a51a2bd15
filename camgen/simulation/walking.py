"""`camgen simulate`: whether a machine walks, falls, slips or stalls on a floor, as a range over the floor's friction."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from itertools import islice
from pathlib import Path

import numpy as np

from camgen.errors import Fault, SpecError, counted
from camgen.files import mjcf
from camgen.files.folder import StagingFolder, write_manifest
from camgen.findings import Finding, NotJudged, Where, at_least, at_most
from camgen.machine.model import Machine
from camgen.machine.run import solve
from camgen.machines.mechanism import Mechanism
from camgen.machines.sources import Source, read_mechanism
from camgen.numerics import Floats
from camgen.pipeline.multibody import Standing, simulated, standing_of
from camgen.progress import Progress, silent
from camgen.report.page import write_html
from camgen.report.report import Report, write_csv, write_json
from camgen.simulation.gait import LOOSE, Gait, engine, gait
from camgen.simulation.picture import film
from camgen.study import Figure, Figures, Plot, Table
from camgen.tolerance.printed import loose, misplaced
from camgen.tolerance.spread import sizes_of

TURNS = 5  # of the crank, the first of which only gets it going
_STRIDE = 0.1  # share of the longest stroke of a foot by which a turn has to bring it on
_CODES = ("FALLS", "STALLS", "WALKS", "SLIPS")
_NOTES = (
    "Simulated by MuJoCo: rigid bodies with the masses of the solids and of walk.payload_g, hard feet on an even floor. Pins "
    "have the friction of load.friction; bending is left out. Legs go through each other and through the frame: the sweep of a build judges that.",
    "The first turn gets the machine going and does not count. A range is that over walk.friction. The friction of a "
    "floor is never known well: expect the distance to be right within 15 %.",
)


_COPIES = (
    "In a copy each pin is off by the errors of the print and by half of its clearance, in one direction for the whole run; if it "
    "does not close so, other directions are tried. It walks at the middle friction; a run to be discarded does not count."
)
_MOST = 100  # copies
_DRAWN = 10  # for each that is wanted, where some do not close
_GIVES = 20  # ways in which the pins of a copy lie, of which one has to close
_LOOKED_AT = 361  # angles of a turn


@dataclass(frozen=True)
class Prints:
    """How many printed copies walk as well; the same seed gives the same copies."""

    copies: int = 0
    seed: int = 1

    def faults(self) -> list[Fault]:
        """Counts that are none, by the option that sets them."""
        faults = []
        if not 0 <= self.copies <= _MOST:
            faults.append(Fault((), str(self.copies), f"from 0 to {_MOST}", source="--copies"))
        if self.seed < 0:
            faults.append(Fault((), str(self.seed), "0 or more", source="--seed"))
        return faults


def simulate(
    spec: Source,
    out: Path,
    overrides: Sequence[str] = (),
    prints: Prints | None = None,
    progress: Progress = silent,
    jobs: int | None = 1,
) -> Report:
    """Runs of a machine with a table [walk]; out/<name>-walk/ has its page, curves and a film, and appears when all is done.

    Raises SpecError where it has no such table, DesignError, FileError where MuJoCo is not there. jobs changes nothing.
    """
    prints = prints or Prints()
    if faults := prints.faults():
        raise SpecError(faults, "command line")
    mechanism = read_mechanism(spec, overrides).resolved()
    standing = standing_of(mechanism)
    if standing is None:
        raise SpecError(
            [Fault(("walk",), "none", "a linkage with a table [walk] that names its feet")]
        )
    engine()
    progress("making the solids", 0.1)
    model = simulated(mechanism, standing)
    gaits = []
    for k, friction in enumerate(standing.frictions):
        progress(f"walking at a friction of {friction:g}", 0.2 + 0.4 * k / len(standing.frictions))
        gaits.append(walk(mechanism, model, friction))
    middle = gaits[len(gaits) // 2]
    copies = _copies(mechanism, prints)
    for k, copy in enumerate(copies.closing):
        progress(f"walking, copy {k + 1}", 0.6 + 0.3 * k / len(copies.closing))
        made = simulated(mechanism, standing, copy)
        run = walk(mechanism, made, middle.friction, TURNS, copy)
        gaits.append(replace(run, copy=k + 1))
    report = judged(mechanism, model, gaits, stride_of(mechanism, standing))
    report = replace(
        report,
        numbers=Figures([*report.numbers.records, *copies.figures]),
        notes=(*report.notes, copies.note),
    )
    progress("drawing the walk", 0.9)
    report = replace(report, film=film(mechanism, model, middle))
    folder = StagingFolder(out / f"{mechanism.name}-walk")
    with folder as new:
        (new / f"{mechanism.name}-walk.gif").write_bytes(report.film)
        write_csv(new / "walk.csv", _columns(middle))
        write_html(new / "report.html", report)
        write_json(new / "report.json", report)
        write_manifest(new, ("mujoco-core", "numpy", "pillow"))
    return replace(report, folder=folder.target, remarks=_said(gaits))


@dataclass(frozen=True)
class _Copies:
    """Printed copies that close all round, and how many were drawn for them."""

    closing: Sequence[Machine] = ()
    drawn: int = 0

    @property
    def figures(self) -> list[Figure]:
        """The share that closes."""
        if not self.drawn:
            return []
        return [Figure("copies that close", 100 * len(self.closing) / self.drawn, "%")]

    @property
    def note(self) -> str:
        """What a person should know of them."""
        if not self.drawn:
            return "Play and errors of the print are left out: --copies has them."
        lost = self.drawn - len(self.closing)
        jammed = (
            "all close"
            if not lost
            else (
                f"{lost} do not close all round, however their pins were laid: a leg comes to its fold and jams; a smaller "
                "print.place_error or a greater least transmission angle helps"
            )
        )
        return f"{_COPIES} Of {counted(self.drawn, 'copy', 'copies')} {jammed}."


def _copies(mechanism: Mechanism, prints: Prints) -> _Copies:
    """So many that close, as far as there are some."""
    if not prints.copies:
        return _Copies()
    sizes = sizes_of(mechanism)
    chance = np.random.default_rng(prints.seed)
    closing: list[Machine] = []
    drawn = 0
    while len(closing) < prints.copies and drawn < _DRAWN * prints.copies:
        printed = misplaced(mechanism.assembly.exact, sizes, chance)
        laid = (loose(printed, chance) for _ in range(_GIVES))
        closing += islice(filter(_closes, laid), 1)
        drawn += 1
    return _Copies(closing, drawn)


def _closes(machine: Machine) -> bool:
    """Whether it goes all round."""
    run = solve(machine, np.linspace(0, math.tau, _LOOKED_AT), 0)
    return all(np.all(np.isfinite(run[output.name])) for output in machine.outputs)


def walk(
    mechanism: Mechanism,
    model: mjcf.Model,
    friction: float,
    turns: int = TURNS,
    copy: Machine | None = None,
) -> Gait:
    """A run from standstill; copy: what the model was made of, where that is not the exact machine."""
    assembly = mechanism.assembly
    start = float(assembly.cycle.theta(np.zeros(1))[0])
    return gait(replace(model, friction=friction), copy or assembly.exact, start, turns)


def stride_of(mechanism: Mechanism, standing: Standing) -> float:
    """Longest stroke of a foot along the floor, mm."""
    machine: Machine = mechanism.assembly.exact
    ahead = 1j * standing.down
    run = solve(machine, np.linspace(0, math.tau, 361), 0)
    return max(float(np.ptp(np.real(run[foot] * ahead.conjugate()))) for foot in standing.feet)


def _said(gaits: Sequence[Gait]) -> list[str]:
    """What a person wants to know first; nothing of runs that do not come so far."""
    walking = [each for each in gaits if each.judged_turns and not each.void]
    if not walking:
        return []
    said = []
    for kind, runs in _kinds(walking):
        ways = _range([each.way_per_turn for each in runs])
        speeds = _range([each.way_per_turn / each.seconds_per_turn for each in runs])
        frictions = _range([each.friction for each in runs])
        whose = f"{kind}: " if kind else ""
        said.append(f"{whose}{ways} mm a turn, {speeds} mm/s, at a friction of {frictions}")
    return said


def _kinds(gaits: Sequence[Gait]) -> list[tuple[str, list[Gait]]]:
    """The exact machine's runs, and those of its copies, as far as there are some."""
    kinds = (
        ("", [each for each in gaits if not each.copy]),
        ("copies", [each for each in gaits if each.copy]),
    )
    return [(kind, runs) for kind, runs in kinds if runs]


# ---- verdicts --------------------------------------------------------------------------------------------------------


def judged(mechanism: Mechanism, model: mjcf.Model, gaits: Sequence[Gait], stride: float) -> Report:
    """What the runs say, each verdict by the worst of them; stride: see `stride_of`."""
    exact = [each for each in gaits if not each.copy]
    error = [float(np.max(each.error)) for each in exact]
    said = "feet are where the machine closes at the same crank angle"
    branch = _worst(at_most, "BRANCH", exact, error, (LOOSE, "mm"), said)
    if branch.ok:
        findings, not_judged = _verdicts([each for each in gaits if not each.void], stride)
    else:
        said = "a leg has left its branch: discard the run, it says nothing about the machine"
        branch = replace(branch, message=said)
        findings = []
        not_judged = [NotJudged(code, said, "BRANCH to hold") for code in _CODES]
    where = "in its plane, held upright" if model.freedom == "plane" else "in space"
    return Report(
        mechanism.name,
        mechanism.mechanism,
        [branch, *findings],
        Figures(_figures([each for each in gaits if not each.void])) if branch.ok else Figures(),
        plots=_plots(gaits),
        tables=[_table(gaits)],
        notes=(
            f"It walks {where}; {1e3 * model.mass:.0f} g in all, its feet {model.width:.0f} mm wide over all.",
            *_NOTES,
        ),
        not_judged=not_judged,
        files=(f"{mechanism.name}-walk.gif", "walk.csv"),
    )


def _verdicts(gaits: Sequence[Gait], stride: float) -> tuple[list[Finding], list[NotJudged]]:
    """FALLS, STALLS, WALKS and SLIPS."""
    low = [float(np.min(each.clearance)) for each in gaits]
    falls = _worst(at_least, "FALLS", gaits, low, (0.0, "mm"), "the frame's height over the floor")
    stopped = [each for each in gaits if each.stalls]
    said = "the crank goes round"
    if stopped:
        angle = math.degrees(stopped[0].crank[-1]) % 360
        said = f"the crank stands {angle:.0f} deg from where it began"
    turns = [each.turns if each.stalls else float(each.wanted) for each in gaits]
    stalls = _worst(at_least, "STALLS", gaits, turns, (gaits[0].wanted, "turns"), said)
    ways = [abs(each.way_per_turn) for each in gaits]
    said = f"way of a turn: {_range(ways)} mm"
    walks = _worst(at_least, "WALKS", gaits, ways, (_STRIDE * stride, "mm"), said)
    walking = [each for each in gaits if each.judged_turns and each.way_per_turn]
    if not walking:
        why = "it does not come to a whole turn after the first"
        return [falls, stalls, walks], [NotJudged("SLIPS", why, "a machine that walks")]
    shares = [each.slip_per_turn / abs(each.way_per_turn) for each in walking]
    said = f"feet slide {_range([each.slip_per_turn for each in walking])} mm a turn"
    slips = _worst(at_most, "SLIPS", walking, shares, (1.0, "1"), said)
    return [falls, stalls, walks, slips], []


def _worst(
    holds: Callable[..., Finding],
    code: str,
    gaits: Sequence[Gait],
    measured: Sequence[float],
    limit: tuple[float, str],
    message: str,
) -> Finding:
    """The finding on the worst of the runs."""
    worst = max(measured) if holds is at_most else min(measured)
    return holds(code, worst, *limit, Where(gaits[measured.index(worst)].name), message)


def _range(values: Sequence[float]) -> str:
    """Least and greatest, three digits."""
    low, high = (f"{value:.3g}" for value in (min(values), max(values)))
    return low if low == high else f"{low} to {high}"


# ---- figures, curves -------------------------------------------------------------------------------------------------

_COLUMNS = (
    "friction",
    "copy",
    "way, mm a turn",
    "speed, mm/s",
    "crank, rpm",
    "slip, mm a turn",
    "turns aside, deg a turn",
    "tilt, deg",
    "roll, deg",
    "in the air, %",
    "torque, N m",
    "branch error, mm",
    "ends",
)


def _table(gaits: Sequence[Gait]) -> Table:
    """A row for each friction."""
    rows = [
        (
            each.friction,
            each.copy or "exact",
            each.way_per_turn,
            each.way_per_turn / each.seconds_per_turn,
            60 / each.seconds_per_turn,
            each.slip_per_turn,
            math.degrees(each.turning_per_turn),
            _ends(each.tilt),
            _ends(each.roll),
            100 * each.in_the_air,
            float(np.mean(each.torque)),
            float(np.max(each.error)),
            _end(each),
        )
        for each in gaits
    ]
    return Table("Runs", _COLUMNS, rows, digits=3)


def _ends(angle: Floats) -> str:
    """Least and greatest angle, deg."""
    return f"{math.degrees(np.min(angle)):.1f} to {math.degrees(np.max(angle)):.1f}"


def _end(each: Gait) -> str:
    """How a run ends."""
    if each.void:
        return "void"
    return "falls" if each.falls else "stalls" if each.stalls else "walks"


def _figures(gaits: Sequence[Gait]) -> list[Figure]:
    """Ranges over the friction, and over the copies."""
    return [
        replace(each, quantity=f"{kind} {each.quantity}" if kind else each.quantity)
        for kind, runs in _kinds(gaits)
        for each in _ranges(runs)
    ]


def _ranges(gaits: Sequence[Gait]) -> list[Figure]:
    """Of runs that walk so far."""
    walking = [each for each in gaits if each.judged_turns]
    ranges = {
        "way per turn": ([each.way_per_turn for each in walking], "mm"),
        "walking speed": ([each.way_per_turn / each.seconds_per_turn for each in walking], "mm/s"),
        "slip per turn": ([each.slip_per_turn for each in walking], "mm"),
        "walking tilt": ([math.degrees(np.max(np.abs(each.tilt))) for each in gaits], "deg"),
        "walking roll": ([math.degrees(np.max(np.abs(each.roll))) for each in gaits], "deg"),
    }
    return [
        Figure(f"{name} {end}", value, unit)
        for name, (values, unit) in ranges.items()
        if values
        for end, value in (("least", min(values)), ("greatest", max(values)))
    ]


def _plots(gaits: Sequence[Gait]) -> list[Plot]:
    """Way, height, tilt and roll over time, the way from above, the torque."""
    start = [each.place[0] for each in gaits]

    def over_time(title: str, unit: str, curve: Callable[[int], Floats]) -> Plot:
        curves = [(each.name, each.time, curve(k)) for k, each in enumerate(gaits)]
        return Plot(title, "time, s", unit, curves)

    above = [
        (each.name, each.place[:, 0] - from_[0], each.place[:, 1] - from_[1])
        for each, from_ in zip(gaits, start, strict=True)
    ]
    return [
        over_time("Way of the frame", "mm", lambda k: gaits[k].place[:, 0] - start[k][0]),
        over_time("Height of the frame", "mm", lambda k: gaits[k].place[:, 2]),
        Plot("Way from above", "x, mm", "y, mm", above, equal=True),
        over_time("Tilt", "deg", lambda k: np.degrees(gaits[k].tilt)),
        over_time("Roll", "deg", lambda k: np.degrees(gaits[k].roll)),
        over_time("Torque of the drive", "N m", lambda k: gaits[k].torque),
    ]


def _columns(each: Gait) -> dict[str, Floats]:
    """A run as walk.csv has it."""
    return {
        "time_s": each.time,
        "crank_deg": np.degrees(each.crank),
        "x_mm": each.place[:, 0] - each.place[0, 0],
        "y_mm": each.place[:, 1] - each.place[0, 1],
        "height_mm": each.place[:, 2],
        "tilt_deg": np.degrees(each.tilt),
        "roll_deg": np.degrees(each.roll),
        "torque_n_m": each.torque,
    }
