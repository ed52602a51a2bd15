"""The chain: spec -> mechanism -> parts -> files -> read back -> findings -> report; and judging an earlier build again."""

from __future__ import annotations

import hashlib
import math
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from camgen import spec as specs
from camgen.arcfit import bulges, fit_arcs
from camgen.budget import error_budget
from camgen.clearance import judge_clearance
from camgen.closure import Sections, Verdict, eyes_of, judge_linkage
from camgen.crossing import cut as cut_at
from camgen.drawing import write_drawing
from camgen.errors import FileError
from camgen.export import Placed, placing, write_3mf, write_dxf, write_stl
from camgen.findings import Finding, at_most
from camgen.fits import Compensation, compensated
from camgen.folder import Staged, manifest_files, write_manifest
from camgen.interference import judge_plate
from camgen.mechanism import Apart, Mechanism, Plot, Rolling, Table, Traced
from camgen.mechanisms import MECHANISMS, load
from camgen.moving import Animation, Body
from camgen.outlines import Floats, Region
from camgen.packing import bed_fit, laid_out, parts_list, write_plates
from camgen.parts import Part
from camgen.readback import Ring, Shape, read_3mf
from camgen.report import Report, write_csv, write_html, write_json
from camgen.sampling import facet_contour
from camgen.segments import with_tables
from camgen.solids import solid
from camgen.sweep import COLUMNS, sweep
from camgen.tolerances import SPEED_WINDOW_DEG
from camgen.undoing import printed
from camgen.verify import (
    Expected,
    Section,
    Undo,
    judge_dxf,
    judge_mesh,
    judge_motion,
    judge_tip,
    judged_angles,
    mounted,
)

KINDS = ("dxf", "stl", "3mf", "report")
_PACKAGES = ("numpy", "pydantic", "ezdxf", "trimesh", "manifold3d", "lib3mf", "mapbox-earcut", "matplotlib")
_SIDE_FILES = ("spec.toml", "motion.csv", "report.json", "manifest.json")
_DRAWN = 0.01  # mm, arc tolerance of the report's moving picture
_FRAMES = 120  # of the moving picture
PLATE_GAP = 3.0  # mm between bodies on a plate: room for a brim of two lines each
_ROWS = 1441  # rows of motion.csv: every quarter degree, both ends

Progress = Callable[[str], None]


def build(
    spec_path: Path, out: Path, only: frozenset[str], overrides: Sequence[str] = (), progress: Progress = lambda _: None
) -> Report:
    """Make, read back and judge one mechanism; its folder out/<name>/ appears, whole, only when all is done.

    only: the kinds of files to make, of KINDS.  Raises SpecError, DesignError or FileError; failed findings do not raise.
    """
    progress("reading the spec")
    mechanism = read_mechanism(spec_path, overrides)
    with Staged(out / mechanism.name) as folder:
        (folder / "spec.toml").write_text(specs.dump(mechanism), encoding="utf-8")
        _write_files(mechanism, folder, only, progress)
        report, columns = judge(mechanism, folder, [kind for kind in KINDS if kind in only and kind != "report"], progress)
        if columns:
            write_csv(folder / "motion.csv", columns)
        if "report" in only:
            progress("writing the report")
            from camgen.figures import plot_svg

            moving = replace(report, animation=animation(mechanism))
            write_html(folder / "report.html", moving, [plot_svg(plot) for plot in report.plots])
        write_json(folder / "report.json", report)
        write_manifest(folder, _PACKAGES)
    return report


def check(folder: Path, progress: Progress = lambda _: None) -> Report:
    """Judge the files of an earlier build again, from the files and the spec.toml beside them; writes nothing."""
    mechanism = read_mechanism(folder / "spec.toml")
    listed = manifest_files(folder)
    lost = next((name for name in listed if not (folder / name).is_file()), None)
    if lost is not None:
        raise FileError(folder / lost, "is listed in manifest.json and not there")
    bases = [f"{mechanism.name}-{part.name}" for part in mechanism.parts()]
    kinds = [kind for kind in KINDS if any(f"{base}.{kind}" in listed or (folder / f"{base}.{kind}").exists() for base in bases)]
    return judge(mechanism, folder, kinds, progress)[0]


def read_mechanism(path: Path, overrides: Sequence[str] = ()) -> Mechanism:
    """The mechanism that a spec file describes; SpecError with all faults, FileError where it cannot be read."""
    data = specs.read(path)
    for override in overrides:
        data = specs.override(data, override)
    data = with_tables(data, path.parent)
    return specs.validate(load(specs.choose(data, MECHANISMS, str(path))), data, str(path))


# ---- making ----------------------------------------------------------------------------------------------------------


def _write_files(mechanism: Mechanism, folder: Path, only: frozenset[str], progress: Progress) -> None:
    parts, fit = mechanism.parts(), compensation(mechanism)
    tolerance, assembly = mechanism.accuracy.chord_tolerance, mechanism.assembly()
    if assembly is not None:
        write_parts_list(folder / f"{mechanism.name}-parts.csv", mechanism)
    for part in parts:
        base = f"{mechanism.name}-{part.name}"
        if "dxf" in only:
            progress(f"drawing {part.name}")
            write_dxf(folder / f"{base}.dxf", part.region, part.centres, tolerance, mechanism.output.curves)
            write_drawing(folder, mechanism.name, part, tolerance, {"Mechanism": mechanism.mechanism})
    if not only & {"stl", "3mf"}:
        return
    progress("making solids")
    meshes = {part.name: solid(part, tolerance) for part in parts}
    sent = {part.name: solid(compensated(part, fit), tolerance) for part in parts} if fit else meshes
    key = hashlib.sha256(specs.dump(mechanism).encode()).hexdigest()
    for part in parts:
        base = f"{mechanism.name}-{part.name}"
        if "stl" in only:
            write_stl(folder / f"{base}.stl", sent[part.name], base)
        if "3mf" in only:
            write_3mf(folder / f"{base}.3mf", {part.name: sent[part.name]}, [Placed(part.name, part.name)], key)
    if "3mf" in only:
        write_3mf(folder / f"{mechanism.name}-assembly.3mf", meshes, _assembly(mechanism), key)
    if "3mf" in only and assembly is not None:
        progress("laying out the plates")
        layout = laid_out(parts, sent, mechanism.print.bed, PLATE_GAP)
        write_plates(folder, mechanism.name, layout, sent, key)


def compensation(mechanism: Mechanism) -> Compensation | None:
    """What the spec says of the printer; None where files are sent as drawn."""
    p = mechanism.print
    fit = Compensation(p.hole_compensation, p.profile_compensation, p.shrinkage, p.elephant_foot, p.first_layer)
    return fit if fit.hole or fit.profile or fit.shrinkage or fit.foot else None


def parts_table(mechanism: Mechanism) -> Table:
    """The list of parts: what is printed, with material, mass and time of all copies, and what is bought."""
    material = mechanism.material
    rows: list[tuple[object, ...]] = [
        ("printed", row.part, row.title, row.count, row.material_mm3, row.mass_g, row.print_min)
        for row in parts_list(mechanism.parts(), material.name, mechanism.print.nozzle, material.density)
    ]
    for thing in mechanism.bought():
        size = ", ".join(text for text in (thing.size, thing.standard) if text)
        rows.append(("bought", thing.name, size, thing.count, "", "", ""))
    columns = ("how", "part", "what", "count", "material, mm^3", f"mass in {material.name}, g", "print time, min")
    return Table("Parts list", columns, rows)


def write_parts_list(path: Path, mechanism: Mechanism) -> None:
    """Write the list of parts as CSV."""
    import csv

    table = parts_table(mechanism)
    with open(path, "w", encoding="utf-8", newline="") as file:
        rows = csv.writer(file, lineterminator="\n")
        rows.writerow(table.columns)
        rows.writerows([f"{cell:.6g}" if isinstance(cell, float) else cell for cell in row] for row in table.rows)


def _assembly(mechanism: Mechanism) -> list[Placed]:
    """Every copy of every part where it is at theta = 0."""
    poses = mechanism.poses(np.zeros(1))
    return [
        Placed(
            part.name,
            f"{part.name}-{k + 1}",
            placing(float(pose.angle[0]), complex(pose.position[0]), pose.z, part.thickness, pose.flipped),
        )
        for part in mechanism.parts()
        for k, pose in enumerate(poses[part.name])
    ]


# ---- judging ---------------------------------------------------------------------------------------------------------


def expected(
    part: Part, tolerance: float, eyes: Sequence[complex] = (), fit: Compensation | None = None, mesh: bool = True
) -> Expected:
    """What the files of a part should hold, as plain numbers for the judge; eyes: centres of its joints.

    With a fit meshes hold the compensated part: its volume counts, and sections above the chamfer are judged as they print.
    """
    spans = list(dict.fromkeys((layer.z0, layer.z1) for layer in part.layers))
    bottom, changed = min(z0 for z0, _ in spans), fit is not None and mesh
    foot = bottom + (fit.foot if fit is not None and changed else 0.0)
    sections = [_section(part, span, foot if span[0] == bottom else span[0]) for span in spans]
    cut = spans.index((part.layers[part.cut].z0, part.layers[part.cut].z1))
    if part.crossed is not None:  # what a cut shows changes with its height; the drawing has the whole region
        drawn = replace(sections[cut], heights=())
        sections = [_crossed(layer.region, part.crossed, z)
                    for layer, section in zip(part.layers, sections, strict=True) for z in section.heights]
        sections, cut = [*sections, drawn], len(sections)
    facets = part.walls * tolerance
    undo, volume = None, part.volume
    if fit is not None and mesh:
        undo, volume = Undo(fit.hole, fit.profile, fit.shrinkage), compensated(part, fit).volume
    return Expected(
        part.name, tuple(sections), cut, volume, facets, part.bore, tuple(eyes), part.min_wall, tolerance, undo
    )


def _section(part: Part, span: tuple[float, float], low: float) -> Section:
    """The layers of one height as a section, seen above `low` and below the engraving."""
    z0, z1 = low, span[1]
    free = min((layer.z0 for layer in part.engraved if z0 < layer.z0 < z1), default=z1)
    regions = [layer.region for layer in part.layers if (layer.z0, layer.z1) == span]
    return Section(
        tuple(z0 + (free - z0) * share for share in (0.137, 0.5, 0.871)),
        len(regions),
        tuple((hole.centroid, hole.area) for region in regions for hole in region.holes),
        sum(region.area for region in regions),
        sum(region.length for region in regions),
    )


def _crossed(region: Region, crossed: Region, z: float) -> Section:
    areas, holes = cut_at(region, crossed, z)
    return Section((z,), len(areas), tuple((hole.centroid, hole.area) for hole in holes), sum(areas), region.length)


def judge(
    mechanism: Mechanism, folder: Path, kinds: Sequence[str], progress: Progress = lambda _: None
) -> tuple[Report, Mapping[str, Floats]]:
    """Judge the files of these kinds in a folder: the report, and the columns of motion.csv."""
    findings, study = list(mechanism.limits()), mechanism.study()
    numbers, plots, budget = dict(study.numbers), list(study.plots), None
    columns: dict[str, Floats] = {}
    designed = len(findings)
    tolerance = mechanism.accuracy.chord_tolerance
    contacts = mechanism.contacts()
    sections: dict[str, dict[str, Sections]] = {kind: {} for kind in kinds}
    shapes: dict[str, dict[str, Shape]] = {kind: {} for kind in kinds}
    fit, tables, notes = compensation(mechanism), list(study.tables), list(study.notes)
    for part in mechanism.parts():
        drives = [contact for contact in contacts if isinstance(contact, Rolling) and contact.part == part.name]
        eyes = eyes_of(part.name, contacts)
        meant = {mesh: expected(part, tolerance, eyes, fit, mesh) for mesh in ((False, True) if fit else (False,))}
        read: dict[str, Shape] = {}
        for kind in kinds:
            path = folder / f"{mechanism.name}-{part.name}.{kind}"
            progress(f"reading back {path.name}")
            judged = (judge_dxf if kind == "dxf" else judge_mesh)(path, meant[fit is not None and kind != "dxf"])
            findings += judged.findings
            if judged.shape is None:
                continue
            read[kind] = shapes[kind][part.name] = judged.shape
            sections[kind][part.name] = judged.sections
            if drives:
                progress(f"rolling on {path.name}")
                found, figures = judge_motion(
                    kind, path.name, judged.shape, drives, mechanism.motion, mechanism.reachable, tolerance
                )
                findings += found
                numbers |= figures
        if drives and read and not columns and not drives[0].inside:
            progress(f"error budget of {part.name}")
            columns = _motion(mechanism, drives[0], read)
            plots = [*_motion_plots(columns, drives[0].unit[0]), *plots]
            budget = error_budget(
                part.region.outer, _facets(part, tolerance, fit), drives[0], mechanism.reachable, tolerance, read,
                (numbers.get("undercut_mm", 0.0), numbers.get(f"undercut_{drives[0].unit[0]}", 0.0)),
            )
            unit, scale = drives[0].unit
            more = mechanism.recovered(
                np.radians(columns["theta_deg"]), {kind: columns[f"recovered_{kind}_{unit}"] / scale for kind in read}
            )
            numbers |= more.numbers
            plots, tables, notes = [*plots, *more.plots], [*tables, *more.tables], [*notes, *more.notes]
    for kind in kinds:
        for tip in (c for c in contacts if isinstance(c, Rolling) and not c.flipped):
            if tip.tip_part in shapes[kind] and tip.part in shapes[kind]:
                where = f"{mechanism.name}-{tip.tip_part}.{kind}"
                frame, cam = shapes[kind][tip.tip_part], shapes[kind][tip.part]
                found, figures = judge_tip(kind, where, frame, cam, tip, mechanism.reachable, tolerance)
                findings += found
                numbers |= figures
    assembly = mechanism.assembly()
    if assembly is not None:
        tables.append(parts_table(mechanism))
        rows = [row for row in tables[-1].rows if row[0] == "printed"]
        numbers["mass_g"] = sum(float(str(row[5])) for row in rows)
        numbers["print_time_h"] = sum(float(str(row[6])) for row in rows) / 60
    if assembly is not None and "3mf" in kinds:
        progress("moving the assembly through a turn")
        found, nearest = sweep(folder / f"{mechanism.name}-assembly.3mf", assembly)
        findings += found
        tables.append(Table("Bodies that pass each other, the nearest first", COLUMNS, nearest))
        progress("reading back the plates")
        findings += _judge_plates(mechanism, folder)
    elif {"stl", "3mf"} & set(kinds):
        for part in mechanism.parts():
            rim = np.concatenate([facet_contour(layer.region.outer, _DRAWN) for layer in part.layers])
            flat = np.column_stack([rim.real, rim.imag, np.zeros(len(rim))])
            findings.append(bed_fit(part.name, part.count, flat, mechanism.print.bed)[1])
    pairs = [contact for contact in contacts if isinstance(contact, Apart)]
    for kind in [kind for kind in kinds if pairs and kind != "dxf"]:
        progress(f"passing by each other on the {kind.upper()} files")
        cleared = judge_clearance(kind, folder, mechanism.name, pairs, mechanism.poses, tolerance)
        findings = [*findings[:designed], *cleared.findings, *findings[designed:]]
        numbers |= cleared.numbers
        plots = [Plot(f"Distance, from {kind.upper()}", "shaft angle, deg", "mm, below 0 overlap", cleared.curves), *plots]
    traced = next((contact for contact in contacts if isinstance(contact, Traced)), None)
    if traced is not None:
        progress("closing the linkage on the files")
        verdicts = {
            kind: judge_linkage(
                kind, f"{mechanism.name}-*.{kind}", read_parts, contacts, mechanism.poses, mechanism.motion,
                judged_angles(), tolerance,
            )
            for kind, read_parts in sections.items() if len(read_parts) == len(mechanism.parts())
        }  # fmt: skip
        findings = [*findings[:designed], *(f for v in verdicts.values() for f in v.findings), *findings[designed:]]
        for verdict in verdicts.values():
            numbers |= verdict.numbers
        columns, traces = _linkage_motion(traced.name, mechanism, verdicts)
        plots = [*traces, *plots]
    report = Report(
        mechanism.name, mechanism.mechanism, tuple(findings), numbers,
        [_part_record(mechanism, part, kinds) for part in mechanism.parts()],
        plots, tables, notes, None, budget, (*_SIDE_FILES, *_machine_files(mechanism, folder)),
    )  # fmt: skip
    return report, columns


def _facets(part: Part, tolerance: float, fit: Compensation | None) -> Ring:
    """The facets of a part's outline, as they print."""
    if fit is None:
        points = facet_contour(part.region.outer, tolerance)
        return Ring(points, np.zeros(len(points)))
    points = facet_contour(compensated(part, fit).region.outer, tolerance)
    return printed(Shape(Ring(points, np.zeros(len(points))), ()), fit.hole, fit.profile, fit.shrinkage).outer


def _plates(mechanism: Mechanism, folder: Path) -> list[Path]:
    """The plate files of a build, in their order."""
    found = list(folder.glob(f"{mechanism.name}-plate*.3mf"))
    return sorted(found, key=lambda path: (len(path.name), path.name))


def _machine_files(mechanism: Mechanism, folder: Path) -> list[str]:
    """Further files of a whole machine to which the page links."""
    fixed = [folder / f"{mechanism.name}-{what}" for what in ("assembly.3mf", "parts.csv")]
    return [path.name for path in (*fixed, *_plates(mechanism, folder)) if path.exists()] if mechanism.assembly() else []


def _judge_plates(mechanism: Mechanism, folder: Path) -> list[Finding]:
    """BED_FIT: every part fits the bed, every copy is on a plate, and the plates are as a printer needs them."""
    bed, plates = mechanism.print.bed, _plates(mechanism, folder)
    laid = Counter(item.name for path in plates for item in read_3mf(path).items)
    fits = []
    for part in mechanism.parts():
        (mesh,) = read_3mf(folder / f"{mechanism.name}-{part.name}.3mf").meshes.values()
        fits.append(bed_fit(part.name, part.count, mesh.vertices, bed)[1])
    short = (Counter({part.name: part.count for part in mechanism.parts()}) - laid).total()
    said = f"{laid.total()} copies laid out, {short} missing"
    missing = at_most("BED_FIT", short, 0, "copies", f"{len(plates)} plate(s)", said)
    return [*(f for f in fits if not f.ok), missing, *(f for path in plates for f in judge_plate(path, bed, PLATE_GAP))]


def _motion(mechanism: Mechanism, drive: Rolling, read: Mapping[str, Shape]) -> dict[str, Floats]:
    """Columns of motion.csv over one turn: wanted, reachable and recovered motion, deg or mm, and wanted speed."""
    theta = np.linspace(0, 2 * math.pi, _ROWS)
    unit, scale = drive.unit
    columns = {
        "theta_deg": np.degrees(theta),
        f"wanted_{unit}": scale * mechanism.motion(theta),
        "wanted_speed": mechanism.motion(theta, 1),
        f"reachable_{unit}": scale * mechanism.reachable(theta),
    }
    for kind, shape in read.items():
        try:
            columns[f"recovered_{kind}_{unit}"] = scale * mounted(shape, drive).angle(theta)
        except ValueError:  # told by MOTION_ERROR
            columns[f"recovered_{kind}_{unit}"] = np.full(theta.shape, np.nan)
    return columns


def _motion_plots(columns: Mapping[str, Floats], unit: str) -> list[Plot]:
    """Motion, speed and error over the cam angle, wanted and recovered."""
    theta, label = columns["theta_deg"], "cam angle, deg"
    kinds = [name.split("_")[1] for name in columns if name.startswith("recovered_")]
    recovered = {kind: columns[f"recovered_{kind}_{unit}"] for kind in kinds}
    step = max(1, round(SPEED_WINDOW_DEG / 2 * (len(theta) - 1) / 360))

    def speed(s: Floats) -> Floats:
        turn = s[:-1]  # one period, averaged over the window as SPEED_RIPPLE does
        mean = (np.roll(turn, -step) - np.roll(turn, step)) / (2 * step * 360 / len(turn))
        return np.append(mean, mean[0])

    def from_files(change: Callable[[Floats], Floats]) -> list[tuple[str, Floats, Floats]]:
        return [(f"from {kind.upper()}", theta, change(s)) for kind, s in recovered.items()]

    wanted, reachable = columns[f"wanted_{unit}"], columns[f"reachable_{unit}"]
    return [
        Plot("Swing" if unit == "deg" else "Stroke", label, unit, [("wanted", theta, wanted), *from_files(lambda s: s)]),
        Plot(
            "Speed",
            label,
            f"{unit} per deg of cam angle, mean of {SPEED_WINDOW_DEG:g} deg",
            [("wanted", theta, speed(wanted)), *from_files(speed)],
        ),
        Plot("Motion error", label, unit, from_files(lambda s: s - reachable)),
    ]


def _linkage_motion(
    name: str, mechanism: Mechanism, verdicts: Mapping[str, Verdict]
) -> tuple[dict[str, Floats], list[Plot]]:
    """Columns of motion.csv over one turn, and plots of travel, speed, error and the band of the joints' play."""
    theta = np.linspace(0, 2 * math.pi, _ROWS)
    wanted, speed = mechanism.motion(theta), mechanism.motion(theta, 1)
    degrees, label = np.degrees(theta), "crank angle, deg"
    columns = {"theta_deg": degrees, "wanted_mm": wanted, "wanted_mm_rad": speed}
    travel, speeds = [("wanted", degrees, wanted)], [("wanted", degrees, speed)]
    errors, bands = [], []
    for kind, verdict in verdicts.items():
        if verdict.chain is None:
            continue
        closed, source = verdict.chain.close(theta), f"from {kind.upper()}"
        columns[f"recovered_{kind}_mm"], columns[f"band_{kind}_mm"] = closed.output, verdict.band(closed)
        travel.append((source, degrees, closed.output))
        speeds.append((source, degrees, closed.slope))
        errors.append((source, degrees, closed.output - wanted))
        bands.append((f"+- {source}", degrees, columns[f"band_{kind}_mm"]))
    plots = [Plot(name.capitalize(), label, "mm", travel), Plot("Speed", label, "mm/rad", speeds)]
    if errors:
        plots += [Plot("Motion error", label, "mm", errors), Plot("Worst case of the joints' play", label, "mm", bands)]
    return columns, plots


def _part_record(mechanism: Mechanism, part: Part, kinds: Sequence[str]) -> dict[str, object]:
    base = f"{mechanism.name}-{part.name}"
    return {
        "name": part.name,
        "title": part.title,
        "count": part.count,
        "material_mm3": part.volume,
        "thickness_mm": part.thickness,
        "area_mm2": part.region.area,
        "files": [f"{base}.{kind}" for kind in kinds],
    }


def animation(mechanism: Mechanism) -> Animation:
    """One turn of the exact mechanism, as the report shows it moving."""
    theta = np.linspace(0, 2 * math.pi, _FRAMES, endpoint=False)
    poses = mechanism.poses(theta)
    bodies = []
    for part in mechanism.parts():
        region = part.region
        rings = [bulges(fit_arcs(contour, _DRAWN)) for contour in (region.outer, *region.holes)]
        bodies.append(Body(part.name, poses[part.name], rings))
    bodies += [Body(s.name, poses[s.name], (), s.strokes, s.circles) for s in mechanism.study().sketches]
    traced = next((contact for contact in mechanism.contacts() if isinstance(contact, Traced)), None)
    if traced is not None:
        return Animation(theta, bodies, mechanism.motion(theta), traced.name, "mm")
    drive = next((contact for contact in mechanism.contacts() if isinstance(contact, Rolling)), None)
    if drive is None:
        return Animation(theta, bodies, mechanism.motion(theta), "output", "mm")
    unit, scale = drive.unit
    return Animation(theta, bodies, scale * mechanism.reachable(theta), "follower", unit)
