"""`camgen simulate`: whether a machine walks, falls, slips or stalls on a floor, as a range over the floor's friction."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from camgen.errors import Fault, SpecError
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

TURNS = 5  # of the crank, the first of which only gets it going
_STRIDE = 0.1  # share of the longest stroke of a foot by which a turn has to bring it on
_CODES = ("FALLS", "STALLS", "WALKS", "SLIPS")
_NOTES = (
    "Simulated by MuJoCo: rigid bodies with the masses of the solids and of walk.payload_g, hard feet on an even floor. Play, bending "
    "and friction of joints are left out. Legs go through each other and through the frame: the sweep of a build judges that.",
    "The first turn gets the machine going and does not count. A range is that over walk.friction. Nobody knows the friction of a "
    "floor well: expect the way to be right within 15 %.",
)


def simulate(
    spec: Source,
    out: Path,
    overrides: Sequence[str] = (),
    progress: Progress = silent,
    jobs: int | None = 1,
) -> Report:
    """Runs of a machine with a table [walk]; out/<name>-walk/ has its page, curves and a film, and appears when all is done.

    Raises SpecError where it has no such table, DesignError, FileError where MuJoCo is not there. jobs changes nothing.
    """
    mechanism = read_mechanism(spec, overrides).resolved()
    standing = standing_of(mechanism)
    if standing is None:
        raise SpecError([Fault(("walk",), "none", "a linkage with a table [walk], its feet")])
    engine()
    progress("making the solids", 0.1)
    model = simulated(mechanism, standing)
    gaits = []
    for k, friction in enumerate(standing.frictions):
        progress(f"walking at a friction of {friction:g}", 0.2 + 0.6 * k / len(standing.frictions))
        gaits.append(walk(mechanism, model, friction))
    report = judged(mechanism, model, gaits, stride_of(mechanism, standing))
    progress("drawing the walk", 0.8)
    folder = StagingFolder(out / f"{mechanism.name}-walk")
    with folder as new:
        middle = gaits[len(gaits) // 2]
        (new / f"{mechanism.name}-walk.gif").write_bytes(film(mechanism, model, middle))
        write_csv(new / "walk.csv", _columns(middle))
        write_html(new / "report.html", report)
        write_json(new / "report.json", report)
        write_manifest(new, ("mujoco-core", "numpy", "pillow"))
    return replace(report, folder=folder.target, remarks=_said(gaits))


def walk(mechanism: Mechanism, model: mjcf.Model, friction: float, turns: int = TURNS) -> Gait:
    """A run from standstill."""
    assembly = mechanism.assembly
    start = float(assembly.cycle.theta(np.zeros(1))[0])
    return gait(replace(model, friction=friction), assembly.exact, start, turns)


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
    ways = _range([each.way_per_turn for each in walking])
    speeds = _range([each.way_per_turn / each.seconds_per_turn for each in walking])
    frictions = _range([each.friction for each in walking])
    return [f"{ways} mm a turn, {speeds} mm/s, at a friction of {frictions}"]


# ---- verdicts --------------------------------------------------------------------------------------------------------


def judged(mechanism: Mechanism, model: mjcf.Model, gaits: Sequence[Gait], stride: float) -> Report:
    """What the runs say, each verdict by the worst of them; stride: see `stride_of`."""
    error = [float(np.max(each.error)) for each in gaits]
    said = "feet are where the machine closes at the same crank angle"
    branch = _worst(at_most, "BRANCH", gaits, error, (LOOSE, "mm"), said)
    if branch.ok:
        findings, not_judged = _verdicts(gaits, stride)
    else:
        said = "a leg has left its branch: the run is void, it says nothing of the machine"
        branch = replace(branch, message=said)
        findings = []
        not_judged = [NotJudged(code, said, "BRANCH to hold") for code in _CODES]
    where = "in its plane, held upright" if model.freedom == "plane" else "in space"
    return Report(
        mechanism.name,
        mechanism.mechanism,
        [branch, *findings],
        Figures(_figures(gaits)) if branch.ok else Figures(),
        plots=_plots(gaits),
        tables=[_table(gaits)],
        notes=(f"It walks {where}; {1e3 * model.mass:.0f} g in all.", *_NOTES),
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
    friction = gaits[measured.index(worst)].friction
    return holds(code, worst, *limit, Where(f"friction {friction:g}"), message)


def _range(values: Sequence[float]) -> str:
    """Least and greatest, three digits."""
    low, high = (f"{value:.3g}" for value in (min(values), max(values)))
    return low if low == high else f"{low} to {high}"


# ---- figures, curves -------------------------------------------------------------------------------------------------

_COLUMNS = (
    "friction",
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
    """Ranges over the friction; of runs that walk so far."""
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
        curves = [(f"{each.friction:g}", each.time, curve(k)) for k, each in enumerate(gaits)]
        return Plot(title, "time, s", unit, curves)

    above = [
        (f"{each.friction:g}", each.place[:, 0] - from_[0], each.place[:, 1] - from_[1])
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
