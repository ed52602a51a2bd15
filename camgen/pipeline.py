"""The chain: spec -> mechanism -> parts -> files -> read back -> findings -> report; and judging an earlier build again."""

from __future__ import annotations

import hashlib
import json
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from camgen import spec as specs
from camgen.arcfit import bulges, fit_arcs
from camgen.budget import error_budget
from camgen.closure import Sections, Verdict, eyes_of, judge_linkage
from camgen.drawing import write_drawing
from camgen.errors import FileError
from camgen.export import Placed, placing, write_3mf, write_dxf, write_stl
from camgen.folder import Staged, write_manifest
from camgen.mechanism import Mechanism, Plot, Rolling, Traced
from camgen.mechanisms import MECHANISMS, load
from camgen.moving import Animation, Body
from camgen.outlines import Floats
from camgen.parts import Part
from camgen.readback import Shape
from camgen.report import Report, write_csv, write_html, write_json
from camgen.solids import solid
from camgen.tolerances import SPEED_WINDOW_DEG
from camgen.verify import Expected, Section, judge_dxf, judge_mesh, judge_motion, judged_angles, mounted

KINDS = ("dxf", "stl", "3mf", "report")
_PACKAGES = ("numpy", "pydantic", "ezdxf", "trimesh", "manifold3d", "lib3mf", "mapbox-earcut", "matplotlib")
_SIDE_FILES = ("spec.toml", "motion.csv", "report.json", "manifest.json")
_DRAWN = 0.01  # mm, arc tolerance of the report's moving picture
_FRAMES = 120  # of the moving picture
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
    try:
        listed = json.loads((folder / "manifest.json").read_text(encoding="utf-8"))["files"]
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise FileError(folder / "manifest.json", f"cannot tell which files the build made: {error}") from None
    kinds = [kind for kind in KINDS if any(name.endswith(f".{kind}") for name in listed)]
    return judge(mechanism, folder, kinds, progress)[0]


def read_mechanism(path: Path, overrides: Sequence[str] = ()) -> Mechanism:
    """The mechanism that a spec file describes; SpecError with all faults, FileError where it cannot be read."""
    data = specs.read(path)
    for override in overrides:
        data = specs.override(data, override)
    return specs.validate(load(specs.choose(data, MECHANISMS, str(path))), data, str(path))


# ---- making ----------------------------------------------------------------------------------------------------------


def _write_files(mechanism: Mechanism, folder: Path, only: frozenset[str], progress: Progress) -> None:
    parts = mechanism.parts()
    tolerance = mechanism.accuracy.chord_tolerance
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
    key = hashlib.sha256(specs.dump(mechanism).encode()).hexdigest()
    for part in parts:
        base = f"{mechanism.name}-{part.name}"
        if "stl" in only:
            write_stl(folder / f"{base}.stl", meshes[part.name], base)
        if "3mf" in only:
            write_3mf(folder / f"{base}.3mf", {part.name: meshes[part.name]}, [Placed(part.name, part.name)], key)
    if "3mf" in only:
        write_3mf(folder / f"{mechanism.name}-assembly.3mf", meshes, _assembly(mechanism), key)


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


def expected(part: Part, tolerance: float, eyes: Sequence[complex] = ()) -> Expected:
    """What the files of a part should hold, as plain numbers for the judge; eyes: centres of its joints."""
    spans = list(dict.fromkeys((layer.z0, layer.z1) for layer in part.layers))
    sections = [_section(part, span) for span in spans]
    cut = spans.index((part.layers[part.cut].z0, part.layers[part.cut].z1))
    facets = sum(section.length * (z1 - z0) for section, (z0, z1) in zip(sections, spans, strict=True)) * tolerance
    return Expected(
        part.name, tuple(sections), cut, part.volume, facets, part.bore, tuple(eyes), part.min_wall, tolerance
    )


def _section(part: Part, span: tuple[float, float]) -> Section:
    """The layers of one height as a section, seen below the engraving."""
    z0, z1 = span
    free = min((layer.z0 for layer in part.engraved if z0 < layer.z0 < z1), default=z1)
    regions = [layer.region for layer in part.layers if (layer.z0, layer.z1) == span]
    return Section(
        tuple(z0 + (free - z0) * share for share in (0.137, 0.5, 0.871)),
        len(regions),
        tuple((hole.centroid, hole.area) for region in regions for hole in region.holes),
        sum(region.area for region in regions),
        sum(region.length for region in regions),
    )


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
    for part in mechanism.parts():
        drives = [contact for contact in contacts if isinstance(contact, Rolling) and contact.part == part.name]
        meant = expected(part, tolerance, eyes_of(part.name, contacts))
        read: dict[str, Shape] = {}
        for kind in kinds:
            path = folder / f"{mechanism.name}-{part.name}.{kind}"
            progress(f"reading back {path.name}")
            judged = (judge_dxf if kind == "dxf" else judge_mesh)(path, meant)
            findings += judged.findings
            if judged.shape is None:
                continue
            read[kind] = judged.shape
            sections[kind][part.name] = judged.sections
            if drives:
                progress(f"rolling on {path.name}")
                found, figures = judge_motion(
                    kind, path.name, judged.shape, drives, mechanism.motion, mechanism.reachable, tolerance
                )
                findings += found
                numbers |= figures
        if drives and read:
            progress(f"error budget of {part.name}")
            columns = _motion(mechanism, drives[0], read)
            plots = [*_motion_plots(columns), *plots]
            budget = error_budget(part.region.outer, drives[0], mechanism.reachable, tolerance, read)
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
        plots, study.tables, study.notes, None, budget, _SIDE_FILES,
    )  # fmt: skip
    return report, columns


def _motion(mechanism: Mechanism, drive: Rolling, read: Mapping[str, Shape]) -> dict[str, Floats]:
    """Columns of motion.csv over one turn: wanted, reachable and recovered follower angle, deg, and wanted speed."""
    theta = np.linspace(0, 2 * math.pi, _ROWS)
    columns = {
        "theta_deg": np.degrees(theta),
        "wanted_deg": np.degrees(mechanism.motion(theta)),
        "wanted_speed": mechanism.motion(theta, 1),
        "reachable_deg": np.degrees(mechanism.reachable(theta)),
    }
    for kind, shape in read.items():
        columns[f"recovered_{kind}_deg"] = np.degrees(mounted(shape, drive).angle(theta))
    return columns


def _motion_plots(columns: Mapping[str, Floats]) -> list[Plot]:
    """Swing, speed and error over the cam angle, wanted and recovered."""
    theta, label = columns["theta_deg"], "cam angle, deg"
    kinds = [name.split("_")[1] for name in columns if name.startswith("recovered_")]
    recovered = {kind: columns[f"recovered_{kind}_deg"] for kind in kinds}
    step = max(1, round(SPEED_WINDOW_DEG / 2 * (len(theta) - 1) / 360))

    def speed(s: Floats) -> Floats:
        turn = s[:-1]  # one period, averaged over the window as SPEED_RIPPLE does
        mean = (np.roll(turn, -step) - np.roll(turn, step)) / (2 * step * 360 / len(turn))
        return np.append(mean, mean[0])

    def from_files(change: Callable[[Floats], Floats]) -> list[tuple[str, Floats, Floats]]:
        return [(f"from {kind.upper()}", theta, change(s)) for kind, s in recovered.items()]

    wanted, reachable = columns["wanted_deg"], columns["reachable_deg"]
    return [
        Plot("Swing", label, "deg", [("wanted", theta, wanted), *from_files(lambda s: s)]),
        Plot(
            "Speed",
            label,
            f"deg per deg of cam angle, mean of {SPEED_WINDOW_DEG:g} deg",
            [("wanted", theta, speed(wanted)), *from_files(speed)],
        ),
        Plot("Motion error", label, "deg", from_files(lambda s: s - reachable)),
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
    return Animation(theta, bodies, np.degrees(mechanism.reachable(theta)), "follower", "deg")
