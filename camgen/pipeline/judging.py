"""Judging a folder: which check looks at which file, and all that they found as one report.

Each stage is a function of the case that returns an Outcome; stages that look at files alone may run in other processes.
A stage's modules are loaded where a mechanism needs the stage.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import repeat
from pathlib import Path

import numpy as np

from camgen.errors import counted
from camgen.files.formats import DRAWN, EXACT, FORMATS, SOLID
from camgen.files.views import area
from camgen.findings import Finding, NotJudged, Where, at_most, in_file
from camgen.geometry.facets import facet_contour
from camgen.geometry.outlines import Floats
from camgen.judge.copies import judge_copies, judge_exact_copies
from camgen.judge.round_trip import judge_solid
from camgen.machine.model import GROUND
from camgen.machines.free_play import beyond_targets
from camgen.machines.mechanism import Mechanism
from camgen.parts import materials, motors
from camgen.parts.assembly import (
    Assembly,
    Cycle,
    bodies_in_motion,
    heads_in_motion,
    printed_parts,
)
from camgen.parts.part import Part
from camgen.pipeline.case import Case
from camgen.pipeline.drawings import timing_of
from camgen.pipeline.expectation import nominal_part
from camgen.pipeline.making import (
    PLATE_GAP,
    assembly_copies,
    compensation,
    lying_sides,
    parts_table,
    written,
)
from camgen.pipeline.reading import Read, budget_of, judge_motion, judge_part, judge_rows, moved_by
from camgen.pipeline.scope import ANY, READ, Outcome, Stage, machined, not_judged, of_parts, unheard
from camgen.pipeline.servo import servo_files
from camgen.pipeline.shopping import choices, steps_of_assembly
from camgen.pipeline.summary import plates_of
from camgen.progress import Progress
from camgen.report.report import Report
from camgen.study import Figure, Figures, Plot, Study, Table, figures_in, united
from camgen.workers import Workers

_SIDE_FILES = ("spec.toml", "motion.csv", "report.json", "manifest.json")
_CLOCKWISE = (
    "The input shaft turns clockwise. Angles still count counter-clockwise, so time runs from right to left in the "
    "curves over them; speeds and torques are positive counter-clockwise."
)
_CHOSEN = "What camgen chose for you, and the key that sets it"
_STRIP = 1.5  # height of a strip of a timing chart, in strokes
_DRAWN = 0.01  # mm, chord tolerance of an outline that is only to be packed
_WALLS = 4  # of a print that is not solid
_INSIDE = 0.5  # share of a region within these walls, from which on infill saves much


Reading = Iterator[tuple[Outcome, Read]]  # of each part, in their order


def read_parts(case: Case, kinds: Sequence[str], workers: Workers) -> Reading:
    """Begin to read back the parts' own files."""
    names = list(case.parts)
    files = [kind for kind in kinds if kind in FORMATS]
    return workers.map(judge_part, repeat(case, len(names)), names, repeat(files, len(names)))


def judge(
    case: Case, kinds: Sequence[str], reading: Reading, workers: Workers, progress: Progress
) -> tuple[Report, dict[str, Floats]]:
    """Judge the files of a case: the report, and the columns of motion.csv.

    kinds: of files that are there, of "dxf", "stl", "3mf" and "report"; the last asks for what only a reader wants.
    reading: the parts' own files, as `read_parts` began to.
    """
    mechanism = case.mechanism
    files = [kind for kind in kinds if kind in FORMATS]
    todo = _stages(mechanism, kinds)
    started = [
        (stage.what, workers.start(stage.work, case, files))
        for stage in todo
        if stage.work is not None and stage.runs(files)
    ]
    limits = mechanism.limits()
    study = case.study
    parts: list[Outcome] = []
    sections: dict[str, Read] = {}
    for k, name in enumerate(case.parts):
        progress(f"reading back {name}", 0.45 + 0.2 * k / len(case.parts))
        outcome, sections[name] = next(reading)
        parts.append(outcome)
    progress("recovering the motion from the files", 0.65)
    motion, columns, recovered = moved_by(mechanism, files, sections)
    rows = judge_rows(case, files, sections)
    budget = (
        budget_of(case, sections, [study.numbers, motion.numbers]) if "report" in kinds else None
    )
    stages = []
    for k, (what, outcome_of) in enumerate(started):
        progress(
            f"checking {what}" if what else "checking the design", 0.7 + 0.15 * k / len(started)
        )
        stages.append(outcome_of())
    if not columns:
        columns = dict(study.columns)
        for outcome in stages:
            columns |= outcome.columns
    outcomes = [motion, rows, *parts, *stages]
    sources: list[Outcome | Study] = [study, *outcomes, recovered]
    # of two parts with one figure the first drives
    numbers = united(each.numbers for each in sources)
    findings = _by_way(
        mechanism.assembly.cycle,
        [*limits, *(finding for outcome in outcomes for finding in outcome.findings)],
    )
    report = Report(
        mechanism.name,
        mechanism.mechanism,
        findings,
        numbers,
        [_part_record(case, part, files) for part in case.parts.values()],
        [plot for outcome in outcomes for plot in outcome.plots] + [*study.plots, *recovered.plots],
        [*study.tables, *recovered.tables]
        + [table for outcome in outcomes for table in outcome.tables],
        [
            *([_CLOCKWISE] if mechanism.assembly.cycle.sense < 0 else []),
            *study.notes,
            *recovered.notes,
            *(note for each in outcomes for note in each.notes),
        ],
        None,
        budget,
        (*_SIDE_FILES, *_machine_files(case)),
        (
            *not_judged(todo, files, findings),
            *(left for each in outcomes for left in each.not_judged),
            *_merged(parts),
        ),
        (
            *unheard(mechanism, files),
            *(warning for each in outcomes for warning in each.warnings),
            *beyond_targets(findings, mechanism.assembly.demands),
        ),
    )
    return report, columns


def _by_way(cycle: Cycle, findings: Sequence[Finding]) -> tuple[Finding, ...]:
    """The findings with their places in mm, where a way is what drives."""
    if cycle.unit == "deg":
        return (*findings,)
    return tuple(
        each
        if each.where.theta is None
        else replace(each, where=replace(each.where, unit=cycle.unit, angle=cycle.name))
        for each in findings
    )


def _merged(outcomes: Sequence[Outcome]) -> list[NotJudged]:
    """What could not be judged of parts, what needs the same as one."""
    reasons: dict[tuple[str, str], list[str]] = {}
    for each in (each for outcome in outcomes for each in outcome.not_judged):
        reasons.setdefault((each.code, each.needs), []).append(each.why)
    return [NotJudged(code, "; ".join(whys), needs) for (code, needs), whys in reasons.items()]


def _part_record(case: Case, part: Part, kinds: Sequence[str]) -> dict[str, object]:
    return {
        "name": part.name,
        "title": part.title,
        "count": part.count,
        "material_mm3": part.volume,
        "thickness_mm": part.thickness,
        "area_mm2": part.region.area,
        "sparse_infill": sparse_infill(case.mechanism, part),
        "files": [
            file.name
            for kind in kinds
            if (file := case.file(part.name, kind)).exists()
            or (kind not in EXACT and (part.outlined or kind not in DRAWN))
        ],
    }


def sparse_infill(mechanism: Mechanism, part: Part) -> bool:
    """Whether four walls and little infill do for a part: a wide one that stands still. What moves is judged as solid."""
    bodies = {mount.body for mount in mechanism.assembly.mounts if mount.part == part.name}
    if part.process != "printed" or bodies != {GROUND}:
        return False
    inside = area(part.region, _DRAWN).buffer(-_WALLS * mechanism.print.nozzle).area
    return bool(inside > _INSIDE * part.region.area)


# ---- the whole, from its files alone ---------------------------------------------------------------------------------


def _stages(mechanism: Mechanism, kinds: Sequence[str]) -> list[Stage]:
    """The stages that this mechanism asks for, in the order of the report, then those that are done as parts are read."""
    stages = []
    if mechanism.assembly.passing:
        stages.append(
            Stage(("CLEARANCE",), "clearances of passing parts over a turn", ANY, pass_by)
        )
    if sum(part.count for part in mechanism.assembly.parts) + len(mechanism.assembly.stand_ins) > 1:
        stages.append(
            Stage(
                ("INTERFERENCE",),
                "clearances of all bodies over a turn",
                ("3mf",),
                sweep_assembly,
            )
        )
    stages += _of_drums(mechanism.assembly)
    stages += _of_plates(mechanism.assembly)
    if mechanism.assembly.balances:
        stages.append(
            Stage(
                ("BALANCE",), "the balanced crank, weighed in the assembly", ("3mf",), weigh_crank
            )
        )
    stages += _on_the_table(mechanism.assembly)
    if mechanism.assembly.strands:
        codes = ("THREAD_HELD", "THREAD_CLEAR")
        stages.append(
            Stage(codes, "threads between their posts in the assembly", ("3mf",), judge_threads)
        )
    stages.append(Stage((), "copies of parts in the assembly", ("3mf",), judge_assembly))
    if mechanism.laser is not None:
        stages.append(Stage((), "sheets for the laser", DRAWN, judge_laser))
    if machined(mechanism):
        stages.append(Stage((), "tables for machine tools", DRAWN, judge_machining))
    if "servo" in kinds:
        stages.append(Stage(("SERVO_TABLE",), "cam tables for servo drives", (), judge_servo))
    if any(kind in EXACT for kind in kinds):
        stages.append(
            Stage((), "copies of exact solids in the assembly", EXACT, judge_exact_assembly)
        )
    printed = materials.of(mechanism.material.name).printed
    if printed:
        stages.append(
            Stage(
                ("BED_FIT",),
                "room on the printer's bed",
                SOLID,
                judge_plates if "3mf" in kinds else fit_bed,
            )
        )
    if "report" in kinds and any(kind in SOLID for kind in kinds):
        stages.append(
            Stage((), "the machine in motion, as viewers show it", SOLID, judge_animation)
        )
    return [
        *stages,
        Stage((), work=list_parts),
        Stage((), work=chart_cams),
        Stage((), work=bear_loads),
        *([Stage((), work=print_errors)] if printed else []),
        *of_parts(mechanism),
    ]


def _of_drums(made: Assembly) -> Iterator[Stage]:
    """The stage of rollers in the tracks of drums."""
    if made.tracks:
        codes = ["MOTION_ERROR", "SPEED_RIPPLE", "CONTACT", "INTERFERENCE"]
        if any(track.track != "end" for track in made.tracks):
            codes += ["LASH", "GROOVE_FIT"]
        yield Stage(
            tuple(codes),
            "the roller, rolled in the track of its drum",
            (*SOLID, *EXACT),
            roll_in_drums,
        )


def _of_plates(made: Assembly) -> Iterator[Stage]:
    """The stage of tips on the edges of plates that slide."""
    if made.edges:
        codes = ("MOTION_ERROR", "SPEED_RIPPLE", "PRESSURE_ANGLE", "CONTACT")
        yield Stage(codes, "the follower, run along the plate's edge", READ, run_over_plates)


def _on_the_table(made: Assembly) -> Iterator[Stage]:
    """The stages of what stands or walks by itself."""
    if made.support is not None:
        words = "the machine on its stand, weighed in the assembly"
        yield Stage(("TIPPING",), words, ("3mf",), tip)
    if made.feet is not None and made.feet.parts:
        words = "the machine on its feet, in the assembly"
        yield Stage(("FLOOR_CLEARANCE",), words, ("3mf",), walk)


def pass_by(case: Case, kinds: Sequence[str]) -> Outcome:
    """Least distances of parts that pass by each other, from each kind of mesh."""
    from camgen.judge.clearance import judge_clearance

    mechanism = case.mechanism
    pairs = mechanism.assembly.passing
    findings: list[Finding] = []
    figures: list[Figure] = []
    columns: dict[str, Floats] = {}
    plots = []
    for kind in (kind for kind in kinds if kind not in EXACT):
        clearances = judge_clearance(
            kind,
            case.file,
            pairs,
            mechanism.assembly.poses,
            mechanism.accuracy.chord_tolerance,
        )
        findings += clearances.findings
        figures += clearances.figures
        plots.append(
            Plot(
                f"Distance, from {kind.upper()}",
                "shaft angle, deg",
                "mm, below 0 overlap",
                clearances.curves,
            )
        )
        columns |= {
            f"distance_{name.lower().replace('/', '_')}_mm_{kind}": distance
            for name, _, distance in clearances.curves
        }
    return Outcome(findings, Figures(figures), plots, columns=columns)


def judge_assembly(case: Case, kinds: Sequence[str]) -> Outcome:
    """ROUND_TRIP of the assembly: every copy of every part as designed, where it belongs at theta = 0."""
    from camgen.files.threemf import read_3mf

    mechanism = case.mechanism
    path = case.file("assembly", "3mf")
    originals = written(case)
    findings = []
    if (
        compensation(mechanism) is not None
    ):  # single parts are files for the printer, the assembly shows them as designed
        originals = {
            name: mesh for name, mesh in read_3mf(path).meshes.items() if name in case.parts
        }
        for name, mesh in originals.items():
            shape = nominal_part(
                case.parts[name], mechanism.accuracy.chord_tolerance, mechanism.assembly.features
            )
            verdict = judge_solid(
                mesh, shape, replace(in_file(path), part=name), FORMATS["3mf"].rounding
            )
            findings += [finding for finding in verdict.findings if not finding.ok]
    places = [(copy.object, copy.transform) for copy in assembly_copies(mechanism)]
    return Outcome([*findings, judge_copies(path, originals, places)])


def judge_exact_assembly(case: Case, kinds: Sequence[str]) -> Outcome:
    """ROUND_TRIP of the assembly of exact solids: every copy of every part that has one, where it belongs at theta = 0."""
    files = {name: file for name in case.parts if (file := case.file(name, "step")).exists()}
    places = [
        (copy.object, copy.transform)
        for copy in assembly_copies(case.mechanism)
        if copy.object in files
    ]
    return Outcome(
        [judge_exact_copies(case.file("assembly", "step"), files, places)] if places else []
    )


def judge_laser(case: Case, kinds: Sequence[str]) -> Outcome:
    """Sheets for the laser: parts as cut, and the machine closed on them; what is not cut of a sheet counts as drawn."""
    from camgen.judge.cams import judged_angles
    from camgen.pipeline.laser import judge_sheets

    findings, sections, tables, figures = judge_sheets(case)
    mechanism = case.mechanism
    parts = {name: {"dxf": sections[name]} if name in sections else {} for name in case.parts}
    low, high = mechanism.assembly.cycle.range
    theta = low + judged_angles() * ((high - low) / math.tau)
    motion = (
        judge_motion(
            mechanism, "dxf", parts, theta, Where(file=f"{mechanism.name}-sheets, *", kind="dxf")
        )
        if figures
        else None
    )
    every = [*findings, *(motion[0].findings if motion else ())]
    return Outcome(every, Figures(figures), tables=tables)


def judge_machining(case: Case, kinds: Sequence[str]) -> Outcome:
    """Tables for machine tools, against the outlines in the parts' drawings."""
    from camgen.pipeline.machining import judge_tables

    return Outcome(judge_tables(case))


def judge_servo(case: Case, kinds: Sequence[str]) -> Outcome:
    """Cam tables for servo drives, against the motion of the followers."""
    from camgen.pipeline.servo import judge_servo_tables

    return judge_servo_tables(case)


def sweep_assembly(case: Case, kinds: Sequence[str]) -> Outcome:
    """INTERFERENCE of all parts and what else is in the way, moved through a turn."""
    from camgen.judge.assembly import COLUMNS, sweep
    from camgen.judge.sweep_in_space import sweep_in_space

    assembly = case.mechanism.assembly
    in_pieces = any(track.ring is not None for track in assembly.tracks)  # and lean in each other
    judge = sweep_in_space if assembly.planes or in_pieces else sweep
    findings, nearest = judge(case.file("assembly", "3mf"), heads_in_motion(assembly))
    columns = (*COLUMNS[:-1], f"{COLUMNS[-1]}, {assembly.cycle.unit}")
    table = Table("Bodies that pass each other, the nearest first", columns, nearest)
    return Outcome(findings, tables=[table] if nearest else [])


def roll_in_drums(case: Case, kinds: Sequence[str]) -> Outcome:
    """The follower of each drum, its roller rolled in the solids."""
    from camgen.pipeline.drums import judge_drum

    return judge_drum(case, kinds)


def run_over_plates(case: Case, kinds: Sequence[str]) -> Outcome:
    """The follower of each plate that slides, on the edge in its files."""
    from camgen.pipeline.plate_edges import judge_plate_edge

    return judge_plate_edge(case, kinds)


def weigh_crank(case: Case, kinds: Sequence[str]) -> Outcome:
    """BALANCE of the crank that carries a counterweight."""
    from camgen.judge.balance import judge_balance

    assembly = case.file("assembly", "3mf")
    machine = bodies_in_motion(case.mechanism.assembly)
    return Outcome(
        [judge_balance(assembly, machine, balance) for balance in case.mechanism.assembly.balances]
    )


def tip(case: Case, kinds: Sequence[str]) -> Outcome:
    """TIPPING of a machine that has a stand."""
    from camgen.judge.tipping import Standing, judge_tipping

    made = case.mechanism.assembly
    assert made.support is not None, "the stage of a machine with a stand"
    densities = {part.name: 1e-6 * made.solids.density_of(part) for part in made.parts}
    densities |= {part.name: 0.0 for part in made.parts if part.process in ("bought", "dummy")}
    driven = any(each.role == "drive" for each in made.bought)
    unweighed = f"{'its motor and ' if driven else ''}what is bought"
    stands = Standing(made.support.down, densities, unweighed)
    return Outcome([judge_tipping(case.file("assembly", "3mf"), bodies_in_motion(made), stands)])


def walk(case: Case, kinds: Sequence[str]) -> Outcome:
    """FLOOR_CLEARANCE of a machine that has feet."""
    from camgen.judge.floor import judge_floor

    made = case.mechanism.assembly
    assert made.feet is not None, "the stage of a machine with feet"
    machine = bodies_in_motion(made)
    path = case.file("assembly", "3mf")
    return Outcome([judge_floor(path, machine, made.feet.down, made.feet.parts)])


def judge_threads(case: Case, kinds: Sequence[str]) -> Outcome:
    """Threads in the grooves of their posts, and what they pass over the turn."""
    from camgen.judge.strands import judge_strands

    return Outcome(
        judge_strands(
            case.file("assembly", "3mf"),
            bodies_in_motion(case.mechanism.assembly),
            case.mechanism.assembly.strands,
        )
    )


def judge_plates(case: Case, kinds: Sequence[str]) -> Outcome:
    """BED_FIT and COPIES: every part fits the bed, every copy is on a plate, and the plates are as a printer needs them."""
    from camgen.files.plates import bed_fit, within
    from camgen.files.threemf import read_3mf
    from camgen.judge.slabs import judge_plate

    mechanism = case.mechanism
    plates = plates_of(case)
    originals = written(case)
    bed = mechanism.print.bed
    margin = mechanism.print.bed_margin
    parts = printed_parts(mechanism.assembly)
    sides = lying_sides(mechanism, originals)
    copies = Counter(item.name for path in plates for item in read_3mf(path).items)
    clouds = [
        (part, originals[part.name].vertices @ sides[part.name].turn.T)
        for part in parts
        if part.name in originals
    ]
    room = within(bed, margin)
    height = mechanism.print.bed_height
    fits = [bed_fit(part.name, part.count, vertices, room, height)[1] for part, vertices in clouds]
    if not plates and not any(fit.ok for fit in fits):
        return Outcome(fits)
    large = {fit.where.part for fit in fits if not fit.ok}  # of which no copy is laid out
    wanted = Counter({part.name: part.count for part in parts if part.name not in large})
    short = (wanted - copies).total()
    are = "is" if copies.total() == 1 else "are"
    remark = f"{counted(copies.total(), 'copy', 'copies')} {are} on the plates, {short} missing"
    where = Where(counted(len(plates), "plate"))
    missing = at_most("COPIES", short, 0, "copies", where, remark)
    on_plates = [
        f
        for path in plates
        for f in (judge_copies(path, originals), *judge_plate(path, bed, PLATE_GAP, margin or 0.0))
    ]
    return Outcome([*(fit for fit in fits if not fit.ok), missing, *on_plates])


def fit_bed(case: Case, kinds: Sequence[str]) -> Outcome:
    """BED_FIT of single parts, as designed."""
    return Outcome(room_on_bed(case.mechanism))


def room_on_bed(mechanism: Mechanism) -> list[Finding]:
    """BED_FIT of each printed part, as designed; none where nothing is printed."""
    from camgen.files.plates import bed_fit, within

    if not materials.of(mechanism.material.name).printed:
        return []
    bed = mechanism.print
    room = within(bed.bed, bed.bed_margin)
    findings = []
    for part in printed_parts(mechanism.assembly):
        rims = [
            (facet_contour(layer.region.outer, _DRAWN), z)
            for layer in part.layers
            for z in (layer.z0, layer.z1)
        ]
        corners = np.concatenate(
            [np.column_stack([rim.real, rim.imag, np.full(len(rim), z)]) for rim, z in rims]
        )
        findings.append(bed_fit(part.name, part.count, corners, room, bed.bed_height)[1])
    return findings


def judge_animation(case: Case, kinds: Sequence[str]) -> Outcome:
    """The machine in motion, against where its parts are at the angles that the animation shows."""
    from camgen.files.gltf import SECONDS
    from camgen.judge.scene import judge_scene
    from camgen.pipeline.shown import flights

    path = case.file("assembly", "glb")
    made = case.mechanism.assembly
    seconds = made.cycle.turns * SECONDS
    return Outcome([judge_scene(path, flights(case.mechanism), seconds, made.down)])


def list_parts(case: Case, kinds: Sequence[str]) -> Outcome:
    """The parts list, as in its file, with mass and print time of all that is printed, what of it needs supports, faces
    between layers, and the steps of assembly."""
    from camgen.files.parts_list import layer_height
    from camgen.judge.parts_table import judge_list
    from camgen.pipeline.whole_layers import between, too_thin

    mechanism = case.mechanism
    sides = lying_sides(mechanism, written(case) if "3mf" in kinds else {})
    table = parts_table(mechanism, sides)
    rows = [row for row in table.rows if row[5] != ""]
    mass = sum(float(str(row[5])) for row in rows)
    if materials.of(mechanism.material.name).metal:  # shafts of another steel too
        one = table.columns.index("mass of one, g")
        made = [row for row in table.rows if row[one] != ""]
        mass = sum(float(str(row[one])) * int(str(row[3])) for row in made)
    figures = [Figure("mass", mass, "g")]
    if materials.of(mechanism.material.name).printed:
        minutes = sum(float(str(row[6])) for row in rows)
        figures.append(Figure("print time", minutes / 60, "h"))
        figures.append(Figure("print infill", mechanism.material.infill, ""))
        layer = layer_height(mechanism.print.nozzle, mechanism.print.layer)
        figures += figures_in("mm", print_layer=layer, print_nozzle=mechanism.print.nozzle)
        stand = mechanism.assembly.support
        if stand is not None:
            of_stand = sum(float(str(row[6])) for row in rows if row[1] in stand.parts)
            figures.append(Figure("print time stand", of_stand / 60, "h"))
    if sides:
        parts = printed_parts(mechanism.assembly)
        overhang = sum(part.count * sides[part.name].overhang for part in parts)
        figures.append(Figure("supports", overhang, "mm²"))
    layers, warnings = between(mechanism, sides)
    warnings = (
        *mechanism.remarks().warnings,
        *motor_without_seat(mechanism),
        *too_thin(mechanism),
        *warnings,
    )
    finding = judge_list(case.file("parts", "csv"), table)
    chosen = Table(_CHOSEN, ("key", "chosen"), choices(mechanism), digits=4)
    tables = [table, chosen, steps_of_assembly(mechanism)]
    return Outcome(
        [finding],
        Figures(figures),
        tables=[*tables, *([layers] if layers.rows else [])],
        warnings=warnings,
    )


def motor_without_seat(mechanism: Mechanism) -> tuple[str, ...]:
    """A sentence on the motor of a machine whose parts have no place for it."""
    made = mechanism.assembly
    motor = getattr(mechanism, "motor", None)
    if motor is None or made.shaft is None:
        return ()
    model = getattr(motor, "model", None)
    return motors.without_seat(model, made.shaft.diameter, made.motor.crank)


def bear_loads(case: Case, kinds: Sequence[str]) -> Outcome:
    """What drive, contacts, bearings and pins bear at the machine's speed."""
    from camgen.machines.loads.assess import assess

    loads = assess(case.mechanism)
    study = loads.study
    return Outcome(
        loads.findings,
        study.numbers,
        study.plots,
        study.tables,
        not_judged=loads.not_judged,
        warnings=loads.warnings,
        notes=study.notes,
    )


def chart_cams(case: Case, kinds: Sequence[str]) -> Outcome:
    """The timing chart of several cams: what each follower does over a turn, one strip below the other."""
    motions = timing_of(case.mechanism)
    if len(motions) < 2:
        return Outcome()
    strips = []
    levels = []
    for k, motion in enumerate(motions):
        foot = _STRIP * (len(motions) - 1 - k)
        strips.append(
            (f"{motion.name}, {motion.unit}", motion.angle, foot + motion.share(motion.stroke))
        )
        levels += [(f"{level:.4g}", foot + float(motion.share(level))) for level in motion.levels]
    title = "Timing chart of the cams"
    return Outcome(plots=[Plot(title, "cam angle, deg", "each follower", strips, levels=levels)])


def print_errors(case: Case, kinds: Sequence[str]) -> Outcome:
    """What a usual print's errors do to the outputs, to first order."""
    from camgen.tolerance.spread import spread_of

    study = spread_of(case.mechanism).study()
    return Outcome(numbers=study.numbers, tables=study.tables)


def _machine_files(case: Case) -> list[str]:
    """Further files of the folder to which the page links."""
    single = [
        *(case.file("assembly", ending) for ending in ("3mf", "glb", "step")),
        case.file("parts", "csv"),
    ]
    texts = [
        case.folder / f"{case.mechanism.name}-{name}" for name in case.mechanism.assembly.texts
    ]
    tables = (f"{part}-tracks" for part in case.parts)
    names = dict.fromkeys(("assembly", *case.parts, *tables, "shaft", "timing"))
    drawings = [case.file(f"{name}-drawing", "pdf") for name in names]
    others = (*plates_of(case), *cut_files(case), *servo_files(case), *texts, *drawings)
    return [path.name for path in (*single, *others) if path.exists()]


def cut_files(case: Case) -> list[Path]:
    """Sheets for the laser and tables for machine tools that are there."""
    files: list[Path] = []
    if case.mechanism.laser is not None:
        from camgen.pipeline.laser import sheet_files

        files += sheet_files(case)
    if machined(case.mechanism):
        from camgen.pipeline.machining import table_files

        files += table_files(case)
    return files
