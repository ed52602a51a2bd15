"""From a mechanism to its files: drawings, solids, the assembly, plates ready to print, and the parts list."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import nullcontext, suppress
from itertools import repeat
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING

import numpy as np

from camgen.errors import DesignError
from camgen.files.formats import EXACT, FORMATS, Job, write_part
from camgen.files.rows import write_rows
from camgen.machine.features import PartPose
from camgen.machines.mechanism import Mechanism
from camgen.numerics import Floats
from camgen.parts import materials
from camgen.parts.assembly import cut_of_sheet, printed_parts
from camgen.parts.catalogue import TURNED, Bought
from camgen.parts.fits import Compensation, compensated
from camgen.parts.part import Part
from camgen.parts.reaming import KEYED_GLUE, MEDIUM, glue
from camgen.parts.step_words import TWO_PART
from camgen.pipeline.case import Case
from camgen.pipeline.scope import machined
from camgen.pipeline.shopping import bought_things, stock, supplies, tools
from camgen.pipeline.summary import draw_part
from camgen.progress import Progress
from camgen.study import Table
from camgen.workers import Workers

if TYPE_CHECKING:
    from camgen.files.plates import Side
    from camgen.files.threemf import PartCopy
    from camgen.geometry.mesh import Mesh

PLATE_GAP = 3.0  # mm between bodies on a plate: room for a brim of two lines each


Made = tuple[
    dict[str, "Mesh"], dict[str, "Mesh"]
]  # solids of parts as designed and as sent to the printer, where any are


def make_parts(case: Case, only: frozenset[str], workers: Workers, progress: Progress) -> Made:
    """Write the parts' own files of these kinds, of FORMATS, into the case's folder, beside the spec that is there."""
    names = list(case.parts)
    meshes: dict[str, Mesh] = {}
    printable: dict[str, Mesh] = {}
    pairs = workers.map(_make_part, repeat(case, len(names)), names, repeat(only, len(names)))
    for k, name in enumerate(names):
        progress(f"making {name}", 0.4 * k / len(names))
        pair = next(pairs)
        if pair is not None:
            meshes[name], printable[name] = pair
    return meshes, printable


def put_together(case: Case, only: frozenset[str], solids: Made, progress: Progress) -> None:
    """Write what the parts make together: their list, tables, the assembly, and the plates."""
    mechanism = case.mechanism
    (meshes, printable) = solids
    parts = printed_parts(mechanism.assembly)
    sides = lying_sides(mechanism, written(case) if "3mf" in only else {})
    write_parts_list(case.file("parts", "csv"), mechanism, sides)
    if "dxf" in only and mechanism.laser is not None:
        from camgen.pipeline.laser import make_sheets

        make_sheets(case)
    if "dxf" in only:
        draw_machine(case, case.folder)
    if "dxf" in only and machined(mechanism):
        from camgen.pipeline.machining import make_tables

        make_tables(case)
    if "servo" in only:
        from camgen.pipeline.servo import make_servo_tables

        make_servo_tables(case)
    if "mjcf" in only:
        from camgen.pipeline.multibody import make_mjcf

        make_mjcf(case, case.folder)
    if "step" in only:
        write_exact_assembly(case)
    if "3mf" not in only:
        return
    from camgen.files.threemf import write_3mf

    progress("putting the assembly together", 0.4)
    write_3mf(
        case.folder / f"{mechanism.name}-assembly.3mf",
        meshes,
        assembly_copies(mechanism),
        case.key,
    )
    if not parts:
        return
    from camgen.files.plates import laid_out, write_plates

    progress("laying out the plates", 0.42)
    layout = laid_out(
        parts, printable, mechanism.print.bed, PLATE_GAP, sides, mechanism.print.bed_margin
    )
    write_plates(case.folder, mechanism.name, layout, printable, case.key)


def draw_machine(case: Case, folder: Path) -> None:
    """Write the sheets of the machine as a whole: its timing diagram where it has several cams, that of a shaft which is no part, its
    arrangement of several parts."""
    from camgen.files.arrangement_sheet import write_arrangement
    from camgen.files.shaft_sheet import write_shaft
    from camgen.files.timing import write_timing
    from camgen.pipeline.arrangement import arrangement_of
    from camgen.pipeline.drawings import machine_facts, shaft_facts, timing_of

    mechanism = case.mechanism
    name = mechanism.name
    motions = timing_of(mechanism)
    if len(motions) > 1:
        write_timing(folder, name, motions, machine_facts(mechanism, "timing", "-00"))
    for thing in mechanism.assembly.bought:
        if thing.shaft is not None:
            write_shaft(folder, name, thing.shaft, shaft_facts(mechanism, thing.shaft))
    carried = any(thing.shaft is not None for thing in mechanism.assembly.bought)
    if (carried or len(mechanism.assembly.parts) > 1) and mechanism.assembly.mounts:
        arrangement = arrangement_of(mechanism, parts_table(mechanism))
        write_arrangement(folder, name, arrangement, machine_facts(mechanism, "assembly"))


def written(case: Case) -> dict[str, Mesh]:
    """The solid of each part's 3MF, as it is sent to the printer."""
    from camgen.files.threemf import read_3mf

    return {
        name: item.mesh
        for name in case.parts
        for item in read_3mf(case.file(name, "3mf")).items[:1]
    }


def lying_sides(mechanism: Mechanism, meshes: Mapping[str, Mesh]) -> dict[str, Side]:
    """On which side each printed part is laid whose solid, as sent to the printer, is known.

    A chamfer against the elephant's foot is made at the part's own underside, which it then lies on.
    """
    if not meshes:
        return {}
    from camgen.files.plates import lying_side, side

    drawn = mechanism.print.elephant_foot > 0
    printed = [part.name for part in printed_parts(mechanism.assembly) if part.name in meshes]
    down = np.array([0.0, 0.0, -1.0])
    return {
        name: side(meshes[name], down) if drawn else lying_side(meshes[name]) for name in printed
    }


def _make_part(case: Case, name: str, only: frozenset[str]) -> tuple[Mesh, Mesh] | None:
    """Write one part's files; its solid as designed and as sent to the printer, None where no file asks for one."""
    mechanism = case.mechanism
    part = case.parts[name]
    tolerance = mechanism.accuracy.chord_tolerance
    kinds = [kind for kind in FORMATS if kind in only]
    mesh = printable = None
    if any(FORMATS[kind].solid for kind in kinds):
        from camgen.parts.solids import solid

        fit = compensation(mechanism)
        mesh = solid(part, tolerance)
        printable = solid(compensated(part, fit), tolerance) if fit else mesh
    else:
        from camgen.parts.solids import refuse_too_fine

        refuse_too_fine(part, tolerance)
    files = mechanism.files
    centres = part.centres if files.center_marks else ()
    engraved = part.engraving if files.engrave else ()
    title = f"{mechanism.name}-{name}"
    job = Job(
        name,
        title,
        case.key,
        part.region,
        centres,
        tolerance,
        files.curves,
        printable,
        part,
        engraved,
    )
    for kind in kinds:
        if FORMATS[kind].holds == "drawing" and not part.outlined:
            continue
        with (
            suppress(DesignError) if kind in EXACT else nullcontext()
        ):  # a part that has none is told as files are judged
            write_part(case.file(name, kind), job)
    if "dxf" in only:
        draw_part(case, name, case.folder)
    return None if mesh is None or printable is None else (mesh, printable)


def write_exact_assembly(case: Case) -> None:
    """Write the exact solids of all parts that have one, every copy where it is at theta = 0; nothing where none has."""
    from camgen.files.step import write_step
    from camgen.parts.exact import exact

    mechanism = case.mechanism
    parts = [part for part in case.parts.values() if case.file(part.name, "step").exists()]
    bodies = {part.name: exact(part, mechanism.accuracy.chord_tolerance) for part in parts}
    copies = [copy for copy in assembly_copies(mechanism) if copy.object in bodies]
    if copies:
        titles = {part.name: part.title for part in parts}
        write_step(
            case.file("assembly", "step"), bodies, titles, f"{mechanism.name}-assembly", copies
        )


def compensation(mechanism: Mechanism) -> Compensation | None:
    """What the spec says of the printer; None where files are sent as drawn."""
    p = mechanism.print
    fit = Compensation(
        p.hole_compensation, p.profile_compensation, p.shrinkage, p.elephant_foot, p.first_layer
    )
    return fit if fit.hole or fit.profile or fit.shrinkage or fit.foot else None


def assembly_copies(mechanism: Mechanism) -> list[PartCopy]:
    """Every copy of every part where it is at theta = 0."""
    from camgen.files.threemf import PartCopy
    from camgen.geometry.mesh import in_standing_plane, placing

    def place(part: Part, pose: PartPose) -> Floats:
        angle = float(pose.angle[0])
        at = complex(pose.place[0])
        placed = placing(angle, at, pose.z, part.thickness, pose.flipped, pose.upright)
        return in_standing_plane(placed) if pose.standing else placed

    poses = mechanism.assembly.poses(np.zeros(1))
    return [
        PartCopy(part.name, f"{part.name}-{k + 1}", place(part, pose))
        for part in mechanism.assembly.parts
        for k, pose in enumerate(poses[part.name])
    ]


def parts_table(mechanism: Mechanism, sides: Mapping[str, Side] = MappingProxyType({})) -> Table:
    """The parts list: what is printed, with material, mass and time of all copies, then what is cut, turned or bought, the steel
    from which parts are cut, what the builder adds, and the drills; each with its number on the arrangement drawing, the file of
    its drawing, its material, and the mass of one.

    sides: on which printed parts lie on the bed, where their solids are known. Of a material that is not printed nothing is said
    of printing, nor of the mass of all copies.
    """
    from camgen.files.parts_list import parts_list
    from camgen.pipeline.assembly_list import FOR_SHOP, for_shop, numbers_of

    material = mechanism.material.name
    density = mechanism.assembly.process.density * 1e-3
    infill = mechanism.material.infill
    parts = mechanism.assembly.parts
    printed = printed_parts(mechanism.assembly)
    same = _same(parts)
    rows: list[tuple[object, ...]] = [
        (
            "printed",
            row.part,
            row.title + same.get(row.part, ""),
            row.count,
            row.material_mm3,
            row.mass_g,
            row.print_min,
            *_lying(sides.get(row.part)),
        )
        for row in parts_list(
            printed, density / infill, infill, mechanism.print.nozzle, mechanism.print.layer, sides
        )
    ]
    blank: tuple[object, ...] = ("",) * 5
    for part in (
        part for part in parts if part not in printed
    ):  # what is bought has a size, what is turned a volume
        bought = part.process == "bought"
        has_size = part.process in ("bought", TURNED)
        what = ": ".join([part.title, *part.notes[: int(has_size)]])
        volume = 0.0 if bought else part.count * part.volume
        mass: object = ""
        how = "cut of sheet" if cut_of_sheet(mechanism.assembly, part) else part.process
        if how == "printed":
            how = f"made of {material}"
            mass = volume * density * 1e-3
        what += same.get(part.name, "")
        rows.append((how, part.name, what, part.count, volume or "", mass, *blank[1:]))
    own = [each for each in bought_things(mechanism) if each.role == "own"]
    things = [each for each in bought_things(mechanism) if each.role != "own"]
    if any("glued" in note for part in parts for note in part.notes) and "glue" not in {
        thing.name for thing in things
    }:
        what = f"{glue(materials.of(material).metal)}, for all glued joints"
        if any(thing.name == TWO_PART for thing in supplies(mechanism)):
            what = "superglue gel, for glued joints where no step asks for two-part glue"
        keyed = any("keyed and glued" in note for part in parts for note in part.notes)
        if keyed:
            what = f"{glue(metal=True)}, for glued joints without a key"
        things.append(Bought("glue", "", what, 1))
        things += [Bought(KEYED_GLUE, "", f"{MEDIUM}: a puller takes the parts off", 1)] * keyed
    if mechanism.assembly.board and mechanism.assembly.support is None:
        own.append(Bought("board", "", "or a frame; the last step says how to fix the plate", 1))
    groups = {
        "bought": [*things, *supplies(mechanism)],
        "stock": stock(mechanism),
        "your own": own,
        "tool": tools(mechanism),
    }
    for how, group in groups.items():
        for thing in group:
            made = how if thing.process == "bought" else thing.process
            of_shaft = thing.count * thing.shaft.volume if thing.shaft else ""
            rows.append((made, thing.name, thing.listing, thing.count, of_shaft, *blank))
    columns = (
        "how",
        "part",
        "what",
        "count",
        "material, mm^3",
        f"mass in {material}, g",
        "print time, min",
        "lies",
        "on the bed, mm^2",
        "overhang, mm^2",
    )
    # of what is not printed the mass of one alone, that of its drawing
    kept = len(columns) if materials.of(material).printed else columns.index("material, mm^3") + 1
    more = zip(numbers_of(mechanism, rows), for_shop(mechanism, rows), strict=True)
    cells = [(*row[:kept], number, *cells) for row, (number, cells) in zip(rows, more, strict=True)]
    return Table("Parts list", (*columns[:kept], "no", *FOR_SHOP), cells, digits=3, shopping=True)


def _same(parts: Sequence[Part]) -> Mapping[str, str]:
    """Of parts that are made like an earlier one under another name, what the list says."""
    first = dict[object, str]()
    said = dict[str, str]()
    for part in parts:
        shape = part.layers, part.engraved, part.side_profile, part.edges, part.drum, part.process
        name = first.setdefault(shape, part.name)
        if name != part.name and part.process != "bought":
            said[part.name] = f"; same as {name}"
    return said


def _lying(side: Side | None) -> tuple[object, ...]:
    """Side, contact and overhang of a part in the list, mm^2; blank where its solid is not known."""
    return (side.name, side.contact, side.overhang) if side else ("", "", "")


def write_parts_list(path: Path, mechanism: Mechanism, sides: Mapping[str, Side]) -> None:
    """Write the parts list as CSV, its estimates to three digits."""
    table = parts_table(mechanism, sides)
    rows = (
        [f"{float(f'{cell:.3g}'):zg}" if isinstance(cell, float) else cell for cell in row]
        for row in table.rows
    )
    write_rows(path, table.columns, rows)
