"""What a tolerance buys and what it costs: a mechanism made, read back and judged at a row of chord tolerances.

measured parts   those on which the machine's joints are measured, and those that pass by each other
outline          the contour that the follower touches, or the outer one of a part of one layer; for parts that are two
                 outlines crossed, which no drawing and no section shows whole, the flat templates stand in
least            vertices: integral of sqrt(|kappa| / (8 tolerance)) ds, and one a straight line;
                 arcs: integral of (|kappa'| / (40.5 tolerance))^(1/3) ds, and one a line or arc that was one before
"""

from __future__ import annotations

import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from camgen.errors import DesignError
from camgen.files.dxf import write_dxf
from camgen.files.formats import FORMATS, USUAL
from camgen.files.stl import write_stl
from camgen.files.threemf import PartCopy, write_3mf
from camgen.findings import ROUTINE, Finding, Where
from camgen.geometry.arcs import fit_arcs, theoretical_arcs
from camgen.geometry.crossing import crossed_at
from camgen.geometry.deviation import outline_error
from camgen.geometry.facets import facet_contour, theoretical_vertices
from camgen.geometry.mesh import Mesh
from camgen.geometry.outlines import Contour, Floats, Line, Points, Region
from camgen.geometry.rings import Ring, Shape
from camgen.judge.cams import judged_angles
from camgen.judge.measured import Sections, measure_bore, of_layer
from camgen.machine.features import CamOutline, Passing, parts_of
from camgen.machine.model import unit_of
from camgen.machines.mechanism import Mechanism
from camgen.machines.sources import read_mechanism
from camgen.parts.fits import compensated
from camgen.parts.part import Part
from camgen.parts.solids import solid
from camgen.pipeline.case import Case
from camgen.pipeline.judging import pass_by
from camgen.pipeline.making import compensation
from camgen.pipeline.reading import Read, judge_motion, judge_part
from camgen.progress import Progress, silent

TOLERANCES = (1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7)
KINDS = USUAL
JUDGED = ("dxf", "stl")  # a 3MF holds the numbers of the STL
STAGES = ("design", "arcs", "solids", "write", "judge dxf", "judge stl")
_paid: list[str] = []
_EXACT = 1e-6  # mm, chords of the sections that stand for the exact ones


@dataclass(frozen=True)
class Row:
    """What one tolerance gives, by kind of file ("dxf", "stl"); figures that do not exist are left out."""

    tolerance: float  # mm
    vertices: int
    least_vertices: float
    arcs: int
    least_arcs: float
    # largest distance of the exact outline from the file's, mm
    outline: Mapping[str, float] = field(default_factory=dict)
    # largest error of the motion, or of the distances of bodies that pass each other
    motion: Mapping[str, float] = field(default_factory=dict)
    ripple: Mapping[str, float] = field(default_factory=dict)  # share of the greatest speed
    size: Mapping[str, int] = field(default_factory=dict)  # bytes
    seconds: Mapping[str, float] = field(default_factory=dict)  # of one core, by stage
    faults: Sequence[str] = ()  # what the judge refused


@dataclass(frozen=True)
class Bench:
    """The rows of one mechanism."""

    name: str
    motion: str  # what the rows' motion is
    unit: str  # of that
    parts: Sequence[str]  # names of those that are measured
    rows: Sequence[Row]


def measure(
    spec: Path, tolerances: Sequence[float] = TOLERANCES, progress: Progress = silent
) -> Bench:
    """Make and judge the measured parts of a spec at each tolerance, mm, in a folder that vanishes.

    Raises SpecError, DesignError or FileError; what a tolerance makes impossible stands in the faults of its row.
    """
    mechanism = read_mechanism(spec)
    parts, _ = _subjects(mechanism)
    moves = bool(mechanism.assembly.features)
    apart = bool(mechanism.assembly.passing)
    rows = []
    if not _paid:  # for imports: the first row of a process
        with TemporaryDirectory() as folder:
            _row(spec, max(tolerances), Path(folder))
        _paid.append(mechanism.name)
    for k, tolerance in enumerate(tolerances):
        progress(f"{mechanism.name} at {tolerance:g} mm", k / len(tolerances))
        with TemporaryDirectory() as folder:
            rows.append(_row(spec, tolerance, Path(folder)))
    unit = unit_of(mechanism.model.outputs[0])[0] if moves else "mm"
    return Bench(
        mechanism.name, "distance" if apart and not moves else "motion", unit, list(parts), rows
    )


def _subjects(mechanism: Mechanism) -> tuple[dict[str, Part], dict[str, Contour]]:
    """The measured parts, and the outlines by part."""
    contacts = mechanism.assembly.passing
    parts = {part.name: part for part in mechanism.assembly.parts}
    cam_parts = {cam.part for cam in _cams(mechanism)}
    passing = {name for contact in contacts for name in (contact.a, contact.b)}
    touching = parts_of(mechanism.assembly.features) | passing
    even = {
        name for name, part in parts.items() if part.side_profile is None and len(part.layers) == 1
    }
    flat = cam_parts | touching & even or even
    cams = {cam.part: cam for cam in _cams(mechanism)}
    inside = {cam.part for cam in _cams(mechanism) if cam.inside}
    outlines = {}
    for name in (name for name in parts if name in flat):
        region = mechanism.assembly.touched(cams[name]) if name in cams else parts[name].region
        contour = (
            max(region.holes, key=lambda hole: abs(hole.area)) if name in inside else region.outer
        )
        outlines[name] = contour.counter_clockwise()
    return {name: part for name, part in parts.items() if name in touching | flat}, outlines


def _cams(mechanism: Mechanism) -> list[CamOutline]:
    return [feature for feature in mechanism.assembly.features if isinstance(feature, CamOutline)]


def _row(spec: Path, tolerance: float, folder: Path) -> Row:
    seconds: dict[str, float] = {}

    @contextmanager
    def stage(name: str) -> Iterator[None]:
        begin = time.process_time()
        yield
        seconds[name] = time.process_time() - begin

    with stage("design"):
        case = Case(read_mechanism(spec, [f"accuracy.chord_tolerance={tolerance!r}"]), folder)
        parts, outlines = _subjects(case.mechanism)
    fit = compensation(case.mechanism)
    meshes = dict[str, Mesh]()
    faults = list[str]()
    with stage("arcs"):
        for contour in outlines.values():
            fit_arcs(contour, tolerance)
    with stage("solids"):
        for name, part in parts.items():
            try:
                meshes[name] = solid(compensated(part, fit) if fit else part, tolerance)
            except DesignError as impossible:
                faults.append(f"no solid of {name}: {impossible}")
    with stage("write"):
        for name, part in parts.items():
            write_dxf(
                case.file(name, "dxf"), part.region, (), tolerance, case.mechanism.files.curves
            )
        for name, mesh in meshes.items():
            write_stl(case.file(name, "stl"), mesh, name)
            write_3mf(case.file(name, "3mf"), {name: mesh}, [PartCopy(name, name)], name)
    counts: dict[str, int] = {}
    outline: dict[str, float] = {}
    motion: dict[str, float] = {}
    ripple: dict[str, float] = {}
    cams = {cam.part: cam for cam in _cams(case.mechanism)}
    for kind in JUDGED:
        originals = meshes if FORMATS[kind].solid else parts
        with stage(f"judge {kind}"):
            judgements = {
                name: judge_part(case, name, [kind], dimensioned=False) for name in originals
            }
        shapes_of = {name: shapes for name, (_, shapes) in judgements.items()}
        findings = [finding for outcome, _ in judgements.values() for finding in outcome.findings]
        findings += _together(case, kind, shapes_of)
        faults += [
            f"{bad.code} ({bad.where}): {bad.measured:.3g} {bad.unit}, limit {bad.limit:.3g}; {bad.message}"
            for bad in findings
            if not bad.ok and bad.code in ROUTINE | {"MOTION_ERROR"}
        ]
        errors = [
            finding.measured
            for finding in findings
            if finding.code in ("MOTION_ERROR", "DISTANCE_ERROR")
        ]
        ripples = [finding.measured for finding in findings if finding.code == "SPEED_RIPPLE"]
        motion |= {kind: max(errors)} if errors else {}
        ripple |= {kind: max(ripples)} if ripples else {}
        rings = {
            name: _ring(shapes_of[name][kind], cams.get(name))
            for name in outlines
            if kind in shapes_of.get(name, {})
        }
        if rings and rings.keys() == outlines.keys():
            counts[kind] = sum(len(ring.points) for ring in rings.values())
            outline[kind] = max(outline_error(outlines[name], ring) for name, ring in rings.items())
    lines = sum(
        isinstance(piece, Line) for contour in outlines.values() for piece in contour.pieces
    )
    return Row(
        tolerance,
        counts.get("stl", 0),
        lines + sum(theoretical_vertices(contour, tolerance) for contour in outlines.values()),
        counts.get("dxf", 0),
        sum(theoretical_arcs(contour, tolerance) for contour in outlines.values()),
        outline,
        motion,
        ripple,
        {kind: sum(path.stat().st_size for path in folder.glob(f"*.{kind}")) for kind in KINDS},
        seconds,
        faults,
    )


def _ring(sections: Sections, cam: CamOutline | None) -> Ring:
    """The ring of a recovered part that stands for its outline, a cam's about its bore."""
    shape = (sections if cam is None else of_layer(sections, cam.layer))[0][0]
    if cam is not None and cam.inside:
        return max(shape.holes, key=lambda hole: abs(hole.area)).counter_clockwise()
    away = 0j if cam is None or cam.bore is None else measure_bore(cam.bore, sections).centre
    return shape.outer.moved(shift=-away)


def _together(case: Case, kind: str, shapes_of: Mapping[str, Read]) -> list[Finding]:
    """What only all files of a kind together tell: the motion, and the error of distances."""
    mechanism = case.mechanism
    pairs = case.mechanism.assembly.passing
    if mechanism.assembly.features:
        judgement = judge_motion(mechanism, kind, shapes_of, judged_angles())
        return [] if judgement is None else list(judgement[0].findings)
    if any(
        {pair.a, pair.b} - shapes_of.keys() for pair in pairs
    ):  # a part of which no solid could be made
        return []
    distances = (
        list(pass_by(case, [kind]).numbers.values()) if pairs and FORMATS[kind].solid else []
    )
    if not pairs or len(distances) != len(pairs):
        return []
    return [
        Finding(
            "DISTANCE_ERROR",
            True,
            abs(distance - _distance(case, pair)),
            0.0,
            "mm",
            Where(pair.name, part=pair.a, other=pair.b),
            "",
        )
        for distance, pair in zip(distances, pairs, strict=True)
    ]


def _distance(case: Case, pair: Passing) -> float:
    """Least distance over the turn of two bodies that shift, from their exact sections, mm."""
    from camgen.judge.clearance import least_distance, meeting

    poses = case.mechanism.assembly.poses

    def way(theta: Floats) -> Points:
        return np.asarray(poses(theta)[pair.b][0].place - poses(theta)[pair.a][0].place)

    distances = []
    for plane in pair.planes:
        a, b = (
            _section(case.parts[name], plane - poses(np.zeros(1))[name][0].z)
            for name in (pair.a, pair.b)
        )
        distances.append(least_distance(meeting(a, b), way).distance)
    return min(distances)


def _section(part: Part, height: float) -> list[Points]:
    """Outer outlines of the part cut at a height, (n,) complex mm each, from chords within _EXACT and no file."""

    def fine(region: Region) -> Shape:
        points = facet_contour(region.outer.counter_clockwise(), _EXACT)
        return Shape(Ring.straight(points), ())

    shapes = [fine(layer.region) for layer in part.layers if layer.z0 <= height < layer.z1]
    if part.side_profile is not None:
        shapes = [
            piece
            for shape in shapes
            for piece in crossed_at(shape, fine(part.side_profile), height)
        ]
    return [shape.outer.points for shape in shapes]
