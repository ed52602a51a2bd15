"""A built folder against the G-code of its plates: what the printer really lays down, judged as the folder's files are.

Each part on a plate is found by its outline and put back into its own frame, layer by layer. The first layer is told by itself,
for it spreads on the bed; what the others fill together, their envelope, is what a wide follower and a pin feel. Parts that are
not on the plates count as their files have them.
"""

from __future__ import annotations

import filecmp
import math
from collections import Counter
from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import combinations
from pathlib import Path

import numpy as np

from camgen.errors import FileError, counted
from camgen.files.folder import manifest_files
from camgen.files.formats import SOLID, read_solid
from camgen.files.gcode import read_gcode, read_settings, with_width
from camgen.files.threemf import Item, read_3mf
from camgen.findings import Finding, NotJudged, Where, at_most, in_file
from camgen.geometry.rings import Floats, Shape
from camgen.judge.measured import Sections, measure
from camgen.judge.motion import MOTION_ERROR
from camgen.judge.sliced import (
    Copy,
    Layer,
    PrintModel,
    bodies,
    copy_of,
    envelope,
    interchangeable,
    outwards,
    shapes_of,
)
from camgen.judge.sliced_copies import judge_sliced_copies
from camgen.machine.features import CamOutline, Eye, eyes, parts_of
from camgen.machines.sources import read_mechanism
from camgen.parts.assembly import printed_parts
from camgen.parts.fits import Compensation
from camgen.parts.part import Part
from camgen.pipeline.case import Case
from camgen.pipeline.expectation import facetted
from camgen.pipeline.making import compensation
from camgen.pipeline.reading import Read, judge_motion, judge_part
from camgen.pipeline.summary import plates_of
from camgen.progress import Progress, silent
from camgen.report.report import Report
from camgen.study import Figure, Figures, Table

_OVER = np.diag([-1.0, 1.0, -1.0])  # a part that lies turned over, as plates lay it
_FLAT = 1e-6  # sine of the angle by which a part that lies flat may lean
_ANGLES = 721  # at which the motion of one layer is judged
# Kinds of figures: of the first layer, and over all layers.
_FIRST = "first layer"
_LAYERS = ("worst layer", "mean layer", "spread layer")
_HIGH = 1e-3  # mm, by which a print may be higher or lower than its part
_UNSEEN = 0.002  # mm, a resolution that costs nothing; PrusaSlicer writes 0 as 0.001
_FOOT = 0.05  # mm, by which a first layer may be off a foot that the part itself makes smaller
# What settings of a slicer cost: measured with PrusaSlicer 2.5 on the cam of the uniform-swing starter, away from its corners.
_LINES = "lines of varying width put that cam's follower 9.9 um off with a resolution of 0, 19.7 with 0.0125 mm; classic ones 1.1"
_POINTS = "points are left out within it; 0 leaves none out, which brought that cam from 19.7 um off to 9.9"
_COSTS = {
    "perimeter_generator": _LINES,
    "wall_generator": _LINES,
    "gcode_resolution": _POINTS,
    "resolution": _POINTS,
    "elefant_foot_compensation": "draws the first layer in by as much; with print.elephant_foot as well it is drawn in twice",
    "xy_size_compensation": "moves every outline by as much; with print.profile_compensation it counts twice",
    "xy_contour_compensation": "moves outlines by as much; with print.profile_compensation it counts twice",
    "xy_hole_compensation": "moves holes by as much; with print.hole_compensation it counts twice",
}


@dataclass
class _Print:
    """What the G-code holds of one part: of each slab of it the section of its envelope, and those of its layers by height; and
    rows for people."""

    sections: list[tuple[Shape, ...]] = field(default_factory=list)
    slabs: list[list[tuple[float, tuple[Shape, ...]]]] = field(default_factory=list)
    first: tuple[Shape, ...] = ()
    findings: list[Finding] = field(default_factory=list)
    rows: list[tuple[object, ...]] = field(default_factory=list)

    def cam_layers(self, cam: CamOutline) -> list[tuple[float, tuple[Shape, ...]]]:
        """Those of the slab that holds the outline on which a follower runs; a hub beside it has none."""

        def size(shapes: Sequence[Shape]) -> float:
            rings = [
                ring for shape in shapes for ring in (shape.holes if cam.inside else [shape.outer])
            ]
            return max((abs(ring.area) for ring in rings), default=0.0)

        return self.slabs[int(np.argmax([size(shapes) for shapes in self.sections]))]


def check_gcode(
    folder: Path,
    plates: Sequence[Path],
    line_width: float | None = None,
    progress: Progress = silent,
) -> Report:
    """Judge the G-code of a folder's plates, one or more; writes nothing.

    line_width: mm, where the files do not say it. FileError where a file cannot be read, or the folder holds no solid.
    """
    case = Case(read_mechanism(folder / "spec.toml"), folder)
    manifest_files(folder)  # a folder of camgen's
    mechanism = case.mechanism
    fit = compensation(case.mechanism) or Compensation()
    _each_once(plates)
    packages = {path.name: read_3mf(path).items for path in plates_of(case)}
    models = _print_models(case, packages.values())
    same = interchangeable(models)
    expected = Counter({part.name: part.count for part in printed_parts(mechanism.assembly)})
    prints: dict[str, _Print] = {}
    findings: list[Finding] = []
    on_side: set[str] = set()
    settings: dict[str, str] = {}
    count = Counter[str]()
    for path in plates:
        progress(f"reading {path.name}")
        try:
            found = bodies(with_width(read_gcode(path), path, line_width))
        except OverflowError as error:
            raise FileError(path, f"has {error}: slice fewer parts at a time") from None
        settings |= read_settings(path)
        progress(f"finding the parts in {path.name}")
        copies = [copy_of(body, models) for body in found]
        strange = copies.count(None)
        remark = f"of {counted(len(copies), 'body', 'bodies')} are like no part of {mechanism.name} by height, area and outline"
        findings.append(at_most("COPIES", strange, 0, "copies", in_file(path), remark))
        for copy in (copy for copy in copies if copy is not None):
            copy = _as_wanted(copy, same, expected - count, models)
            name = copy.known.part
            findings += copy.complete(in_file(path))
            count[name] += 1
            if copy.known.over is None:
                on_side.add(name)
                continue
            _add(prints.setdefault(name, _Print()), copy, case.parts[name], fit, in_file(path))
    for each in prints.values():
        findings += each.findings
    plate_copies = {
        name: Counter(item.name for item in items) for name, items in packages.items()
    } or {"all parts": expected}
    where = Where(file=", ".join(path.name for path in plates), kind="gcode")
    by_print = {part: " or ".join(group) for part, group in same.items()}
    complete, absent = judge_sliced_copies(
        _renamed(count, by_print),
        _renamed(expected, by_print),
        {path: _renamed(content, by_print) for path, content in plate_copies.items()},
        where,
    )
    findings.append(complete)
    progress("recovering the motion from the layers")
    motion, figures, not_judged = _motion_of_print(case, prints, on_side, where)
    columns = (
        "part",
        "layers",
        "height, mm",
        "meant, mm",
        "first: outline, mm",
        "first: holes, mm",
        "outline, mm",
        "holes, mm",
        "spread, mm",
        "worst, mm",
        "at height, mm",
    )
    tables = [
        Table(
            "As laid by the printer, out of the material meant",
            columns,
            [row for each in prints.values() for row in each.rows],
        ),
        _eye_table(case, prints),
        _settings_table(settings),
    ]
    return Report(
        mechanism.name,
        mechanism.mechanism,
        [*findings, *motion],
        Figures(figures),
        tables=[table for table in tables if table.rows],
        not_judged=tuple(dict.fromkeys([*absent, *not_judged])),
        remarks=_remarks(prints, figures, settings),
    )


def _as_wanted(
    copy: Copy,
    same: Mapping[str, Sequence[str]],
    wanted: Counter[str],
    models: Sequence[PrintModel],
) -> Copy:
    """A copy as one of the part that is wanted most of those whose prints are the same."""
    own = copy.known.part
    part = max(same[own], key=lambda name: (wanted[name], name == own))
    if part == own:
        return copy
    return copy_of(copy.layers, [each for each in models if each.part == part]) or copy


def _renamed(parts: Counter[str], names: Mapping[str, str]) -> Counter[str]:
    """How many there are by other names."""
    renamed = Counter[str]()
    for part, count in parts.items():
        renamed[names.get(part, part)] += count
    return renamed


def _each_once(plates: Sequence[Path]) -> None:
    """FileError where two plates are the same file, byte by byte, or one cannot be read."""
    for path, other in combinations(plates, 2):
        try:
            same = filecmp.cmp(path, other, shallow=False)
        except OSError as error:
            raise FileError(
                Path(error.filename), f"cannot be read: {error.strerror or error}"
            ) from None
        if same:
            raise FileError(
                other, f"is {path} again, byte by byte: give the G-code of each plate once"
            )


def _print_models(case: Case, packages: Iterable[Sequence[Item]]) -> list[PrintModel]:
    """The printed parts of a folder as they were sent, on the sides on which its plates, with these items, lay them."""
    sides_of: dict[str, list[tuple[Floats, float]]] = {}
    for items in packages:
        for item in items:
            sides_of.setdefault(item.name, []).append(_tilt(item.transform[:, :3]))
    models = []
    for part in printed_parts(case.mechanism.assembly):
        file = next(
            (path for kind in reversed(SOLID) if (path := case.file(part.name, kind)).exists()),
            None,
        )
        if file is None:
            continue
        solid = read_solid(file, part.name)[0]
        sides = sides_of.get(part.name, [(np.eye(3), 0.0)])
        for turn in [np.eye(3), *([] if np.allclose(sides[0][0], np.eye(3)) else [sides[0][0]])]:
            models.append(
                PrintModel(
                    part.name,
                    solid,
                    turn,
                    tuple(angle for each, angle in sides if np.allclose(each, turn)),
                )
            )
    if not models:
        raise FileError(
            case.folder,
            "holds no STL or 3MF of a printed part to compare the plate with: build them",
        )
    return models


def _tilt(turn: Floats) -> tuple[Floats, float]:
    """A rotation (3, 3) as what lays a part on a side, and what then turns it about the vertical, rad."""
    if abs(abs(turn[2, 2]) - 1) > _FLAT:
        return turn, 0.0
    over = turn[2, 2] < 0
    spun = turn @ _OVER if over else turn
    return _OVER if over else np.eye(3), math.atan2(spun[1, 0], spun[0, 0])


@dataclass(frozen=True)
class _LaidLayer:
    """A layer's contours against the section of the part that was meant."""

    height: float  # mm, of the part
    outside: Floats  # mm, how far each point of its outlines lies out of the material
    inside: Floats  # of its holes
    fault: str  # "" where it has as many contours as were meant

    @classmethod
    def of(
        cls, copy: Copy, layer: Layer, section: Sequence[Shape], meant: Sequence[Shape]
    ) -> _LaidLayer:
        count, wanted = (sum(1 + len(each.holes) for each in shapes) for shapes in (section, meant))
        over = f"{layer.middle:.2f} mm over the bed"
        fault = "" if count == wanted else f"{count} contours instead of {wanted} at {over}"
        return cls(copy.height(layer), *outwards(section, meant), fault)

    @property
    def row(self) -> tuple[float, float, float]:
        """Height, and how far outlines and holes lie out of the material, mean, mm."""
        holes = float(self.inside.mean()) if len(self.inside) else 0.0
        return self.height, float(self.outside.mean()), holes

    @property
    def off(self) -> float:
        """mm, of the point that is the farthest off; inf where contours are missing or too many."""
        if self.fault:
            return math.inf
        return max(float(np.abs(each).max(initial=0.0)) for each in (self.outside, self.inside))


def _add(printed: _Print, copy: Copy, part: Part, fit: Compensation, where: Where) -> None:
    """Put a copy's layers with what is known of its part, and judge their contours."""
    where = replace(where, part=part.name)
    laid = _laid(printed, copy, part, fit) if part.prismatic else []
    first = _first_layer(copy)
    if fit.foot:
        remark = (
            f"its edge lies {first[0]:+.3f} mm out of the solid as it was sent, which is drawn in for the elephant's "
            "foot already: is the slicer's own compensation on?"
        )
        printed.findings.append(at_most("FIRST_LAYER", abs(first[0]), _FOOT, "mm", where, remark))
    heights = copy.known.solid.vertices @ copy.known.turn[2]
    head = (part.name, len(copy.layers), copy.layers[-1].top, float(np.ptp(heights)), *first)
    if not laid:
        printed.rows.append((*head, "", "", "", "", ""))
        return
    table = np.array([layer.row for layer in laid])
    height, outline, holes = table.T
    worst = int(np.argmax(np.abs(outline)))
    means = float(outline.mean()), float(holes.mean()), float(outline.std())
    printed.rows.append((*head, *means, float(outline[worst]), float(height[worst])))
    bead = max(
        float(wall.widths.max())
        for layer in copy.layers[len(copy.layers) > 1 :]
        for wall in layer.walls
    )
    remark = next(
        (layer.fault for layer in laid if layer.fault),
        f"contours of {len(laid)} of {len(copy.layers)} layers; a bead {bead:g} mm wide rounds corners by less",
    )
    off = max(layer.off for layer in laid)
    printed.findings.append(at_most("ROUND_TRIP", off, bead / 2, "mm", where, remark))


def _laid(printed: _Print, copy: Copy, part: Part, fit: Compensation) -> list[_LaidLayer]:
    """The layers of a copy, but for its first one and its foot, of which the section is known; their shapes go with the print."""
    # from there on engravings are cut into it
    pocket = min((layer.z0 for layer in part.engraved), default=math.inf)
    low = part.layers[0].z0 + (fit.foot_of(part) if fit.foot else 0.0)
    laid = []
    for z0, z1 in dict.fromkeys((layer.z0, layer.z1) for layer in part.layers):
        meant = tuple(
            facetted(layer.region, 1e-3)
            for layer in part.layers
            if (layer.z0, layer.z1) == (z0, z1)
        )
        layers = [
            layer
            for layer in copy.layers[1:]
            if max(z0, low) < copy.height(layer) < min(z1, pocket)
        ]
        shapes = [shapes_of(copy, layer, fit.hole, fit.profile, fit.shrinkage) for layer in layers]
        if z0 <= copy.height(copy.layers[0]) < z1:
            printed.first = shapes_of(copy, copy.layers[0])
        pairs = [*zip(layers, shapes, strict=True)]
        laid += [_LaidLayer.of(copy, layer, section, meant) for layer, section in pairs]
        if shapes:
            printed.sections.append(envelope(shapes))
            printed.slabs.append([(copy.height(layer), section) for layer, section in pairs])
    return laid


def _first_layer(copy: Copy) -> tuple[float, float]:
    """How far the first layer's outlines and holes lie out of the solid as it was sent, mean, mm."""
    from camgen.geometry.mesh import slice_mesh
    from camgen.judge.round_trip import pieces_of

    layer = copy.layers[0]
    meant = pieces_of(slice_mesh(copy.known.solid, copy.height(layer)))
    outside, inside = outwards(shapes_of(copy, layer), meant)
    return float(outside.mean()), float(inside.mean()) if len(inside) else 0.0


def left_out(on_side: Collection[str], away: Collection[str]) -> list[NotJudged]:
    """Parts that lie on a side, and those without which the machine is closed."""
    reasons = [
        NotJudged(
            "ROUND_TRIP", f"{name} lies on a side: its holes are not round in layers", "its STL"
        )
        for name in on_side
    ]
    for names, why, needs in (
        (
            set(away) & set(on_side),
            "on a side, where layers do not show the outline,",
            "them upright",
        ),
        (set(away) - set(on_side), "not on the plate", "all plates"),
    ):
        if names:
            counts = (
                "counts as its file has it" if len(names) == 1 else "count as their files have them"
            )
            reasons.append(
                NotJudged("MOTION_ERROR", f"{', '.join(sorted(names))}: {why} and {counts}", needs)
            )
    return reasons


def _motion_of_print(
    case: Case, prints: Mapping[str, _Print], on_side: Collection[str], where: Where
) -> tuple[list[Finding], list[Figure], list[NotJudged]]:
    """Findings and figures of the machine closed on what is laid: the envelope, and layer by layer the cams."""
    from camgen.judge.cams import judged_angles

    mechanism = case.mechanism
    features = mechanism.assembly.features
    moving = parts_of(features)
    present = sorted(name for name in moving if name in prints and prints[name].sections)
    if not present:
        why = (
            "no part on the plate makes the motion"
            if features
            else "nothing moves by the parts' outlines"
        )
        nothing = (
            [NotJudged("MOTION_ERROR", why, "the plate with the parts that move")]
            if features
            else []
        )
        return [], [], [*left_out(sorted(on_side), ()), *nothing]
    not_judged = left_out(sorted(on_side), moving - set(present))
    kind = next(
        kind for kind in (*SOLID[::-1], "dxf") if case.file(next(iter(case.parts)), kind).exists()
    )
    parts_read: dict[str, Read] = {
        name: {"gcode": prints[name].sections} if name in present else _as_filed(case, name, kind)
        for name in case.parts
    }
    low, high = mechanism.assembly.cycle.range
    theta = low + judged_angles() * ((high - low) / math.tau)
    parts = replace(where, file=f"{where.file}, *")
    verdict = judge_motion(mechanism, "gcode", parts_read, theta, parts, mechanism.print.xy_step)
    if verdict is None:
        return [], [], not_judged
    figures = [*verdict[0].numbers.records]
    cams = {
        feature.part: feature
        for feature in features
        if isinstance(feature, CamOutline) and feature.part in present and feature.layer is None
    }
    if cams:
        figures += _by_layer(case, prints, parts_read, cams)
    return list(verdict[0].findings), figures, not_judged


def _as_filed(case: Case, name: str, kind: str) -> Read:
    """A part that is not on the plate, as its file has it."""
    sections = judge_part(case, name, [kind])[1]
    return {"gcode": sections[kind]} if kind in sections else {}


def _by_layer(
    case: Case,
    prints: Mapping[str, _Print],
    parts: Mapping[str, Read],
    cams: Mapping[str, CamOutline],
) -> list[Figure]:
    """The greatest motion error of the machine with each layer of its cams alone: first, worst, mean and spread."""
    mechanism = case.mechanism
    theta = np.linspace(*mechanism.assembly.cycle.range, _ANGLES)

    def error(sections: Mapping[str, Sections]) -> dict[str, Figure]:
        result = judge_motion(
            mechanism,
            "gcode",
            {**parts, **{name: {"gcode": each} for name, each in sections.items()}},
            theta,
        )
        every = result[0].numbers.records if result is not None else ()
        errors = (each for each in every if each.quantity == MOTION_ERROR)
        return {each.of: each for each in errors if math.isfinite(each.value)}

    slabs = {name: prints[name].cam_layers(cam) for name, cam in cams.items()}
    heights = sorted({round(z, 3) for each in slabs.values() for z, _ in each})
    layers = [
        error(
            {name: [min(each, key=lambda one: abs(one[0] - z))[1]] for name, each in slabs.items()}
        )
        for z in heights
    ]
    first = error({name: [prints[name].first] for name in cams if prints[name].first})
    figures = [replace(each, kind=_FIRST) for each in first.values()]
    for output, figure in layers[0].items() if layers else ():
        values = [layer[output].value for layer in layers if output in layer]
        for kind, value in zip(
            _LAYERS, (np.max(values), np.mean(values), np.std(values)), strict=True
        ):
            figures.append(replace(figure, value=float(value), kind=kind))
    return figures


def _eye_table(case: Case, prints: Mapping[str, _Print]) -> Table:
    """Bores, holes and pins as they are laid: first layer, smallest and largest of the others."""
    rows: list[tuple[object, ...]] = []
    shown_eyes = {
        eye: None
        for feature in case.mechanism.assembly.features
        for eye in eyes(feature)
        if eye.part in prints and eye.diameter
    }
    for eye in shown_eyes:
        printed = prints[str(eye.part)]
        sizes = [
            size
            for slab in printed.slabs
            for _, shapes in slab
            if (size := _diameter(eye, [shapes])) is not None
        ]
        if sizes:
            first = _diameter(eye, [printed.first]) if printed.first else None
            what = "pin" if eye.shaft else "hole"
            rows.append(
                (
                    eye.part,
                    what,
                    eye.at.real,
                    eye.at.imag,
                    eye.diameter,
                    first if first is not None else "",
                    min(sizes),
                    max(sizes),
                )
            )
    columns = (
        "part",
        "what",
        "x, mm",
        "y, mm",
        "meant, mm",
        "first layer, mm",
        "smallest, mm",
        "largest, mm",
    )
    return Table("Holes and pins as laid by the printer", columns, rows)


def _diameter(eye: Eye, sections: Sections) -> float | None:
    measured = measure(eye, sections)
    return None if measured is None else measured.diameter


def _settings_table(settings: Mapping[str, str]) -> Table:
    """What the slicer was set to, where it costs accuracy, and how much it cost elsewhere."""
    rows = [
        (key, settings[key], cost)
        for key, cost in _COSTS.items()
        if key in settings and _costs(key, settings[key])
    ]
    return Table(
        "Settings of the slicer that cost accuracy", ("setting", "value", "what it costs"), rows
    )


def _costs(key: str, value: str) -> bool:
    try:
        return abs(float(value.rstrip("%").split(",")[0])) > (
            _UNSEEN if "resolution" in key else 0.0
        )
    except ValueError:
        return value == "arachne"


def _remarks(
    prints: Mapping[str, _Print], figures: Sequence[Figure], settings: Mapping[str, str]
) -> list[str]:
    """What a person should read beside the findings."""
    remarks = [f"{key} = {value}: {said}" for key, value, said in _settings_table(settings).rows]
    rows = [
        [float(str(cell)) for cell in row[4:8]]
        for each in prints.values()
        for row in each.rows
        if row[6] != ""
    ]
    if rows:
        outside, holes = (max((row[k] for row in rows), key=abs) for k in (2, 3))
        lowest = ", ".join(f"{max((row[k] for row in rows), key=abs):+.3f} mm" for k in (0, 1))
        said = f"outlines lie {outside:+.3f} mm outside the design and walls {holes:+.3f} mm inside holes, on average"
        remarks.append(f"{said}; in the first layer, against the solid as sent, {lowest}")
    high = {
        str(row[0]): (float(str(row[2])), float(str(row[3])))
        for each in prints.values()
        for row in each.rows
    }
    off = [
        f"{part} {top:g} for {meant:g}"
        for part, (top, meant) in high.items()
        if abs(top - meant) > _HIGH
    ]
    if off:
        remarks.append(
            f"layers do not add up to the parts' heights, mm: {', '.join(off)}; set print.layer, and the build names the faces between layers before you slice"
        )
    values = {(each.kind, each.of): each.value for each in figures}
    for first in (each for each in figures if each.kind == _FIRST):
        worst, mean, spread = (values[kind, first.of] for kind in _LAYERS)
        said = f"of layers taken alone the worst moves {worst:.4f} {first.unit} off, the mean {mean:.4f}, spread {spread:.4f}"
        remarks.append(f"{said}; the first {first.value:.4f}")
    return remarks
