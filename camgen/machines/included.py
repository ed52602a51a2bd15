"""Another spec's machine on the same shaft: what `[[include]]` adds to a machine."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path, PurePosixPath
from typing import TYPE_CHECKING, Any

import numpy as np

from camgen import reading
from camgen import spec as specs
from camgen.errors import DesignError, Fault, Key, SpecError
from camgen.findings import Finding, Where, at_most
from camgen.geometry.outlines import Arc
from camgen.machine.features import Mount
from camgen.machine.joining import Module, Ride, ride
from camgen.machine.model import GROUND, Gravity, Machine, NamedTwice, Pose
from camgen.machine.run import Run, solve
from camgen.machines import MECHANISMS, load
from camgen.machines.mechanism import Mechanism
from camgen.machines.spec_files import with_tables
from camgen.numerics import Floats, Points
from camgen.parts.assembly import Assembly, renamed
from camgen.parts.catalogue import Bought
from camgen.parts.generator.connections import Stand
from camgen.parts.generator.mounted import InLine, UpperEnd, in_line, merged
from camgen.parts.part import Part
from camgen.study import Figures, Later, Sketch, Study
from camgen.tolerances import SAME_POINT

if TYPE_CHECKING:
    from camgen.machines.linkage.tables import Include

_WHOLE = ("print", "material", "accuracy")  # tables that the whole machine has once
_ANGLES = 1440  # at which bodies that ride are compared with their own motion


@dataclass(frozen=True)
class Host:
    """What included machines take of the one that includes them."""

    tables: Mapping[str, Any]  # of its spec
    speed_rpm: float


@dataclass(frozen=True)
class IncludedMachine:
    """A machine as it stands in another one."""

    table: Include  # its [[include]]
    module: Module
    mechanism: Mechanism  # of its own spec
    assembly: Assembly  # as it stands in the whole
    stand: Stand | None  # of its frame, on the second plate; None where it stands by itself


# ---- what they are ---------------------------------------------------------------------------------------------------


def stack(
    includes: Sequence[Include],
    host: Host,
    chain: Machine,
    top: float,
    gap: float,
    end: UpperEnd | None,
) -> tuple[IncludedMachine, ...]:
    """The included machines, each so far above the highest part before it as the gap says unless its z is given; mm.

    chain: the host's own model; top: height of its highest part; end: of its shaft, where it has a second plate.
    """
    modules: list[IncludedMachine] = []
    for k, each in enumerate(includes):
        mechanism = _resolved(each, host)
        own = mechanism.assembly
        if own.tracks or own.edges or own.rows:
            right = "a machine that moves in a plane: the follower of a drum goes along its shaft"
            if own.rows:
                right = "a drum without [[row]]: the comb for its pins stands by its own shaft"
            if own.edges:
                right = "a machine that is turned by a shaft: a plate slides"
            raise SpecError([Fault(("include", k, "spec"), mechanism.mechanism, right)])
        levels = heights(own.parts, own.mounts)
        low = min(low for low, _ in levels)
        z = top + gap - low if each.z is None else each.z
        module = Module(_name(each), complex(*each.at), math.radians(each.phase_deg), z)
        joint = None
        if each.mounted and end is not None:
            _refuse_unfixed(("include", k, "mounted"), own, end.sizes.mount_diameter)
            joint = in_line(own, module, end, gap)
            module = module if joint is None else replace(module, z=joint.z)
            _refuse_height(("include", k, "z"), each.z, joint, module.z, end.top + gap - low)
        top = max(top, module.z + max(high for _, high in levels))
        rides = _rides(("include", k, "ride"), each, module, mechanism, chain)
        modules.append(_included(each, replace(module, rides=rides), mechanism, joint))
    return tuple(modules)


def _included(
    table: Include, module: Module, mechanism: Mechanism, joint: InLine | None
) -> IncludedMachine:
    """A machine in its place; joint: what joins it to the host's shaft."""
    own = mechanism.assembly
    stand = None
    if table.mounted:
        places = () if own.frame is None else own.frame.fixings
        stand = Stand(
            module.part("")[:-1],
            tuple(z + module.at for z, _ in places),
            module.z,
            None if joint is None else joint.sleeve,
            None if joint is None else joint.merged,
        )
    own = replace(own, bought=_bought(own, table.mounted, joint is not None))
    if joint is None or joint.merging is None:
        own = renamed(own, module)
    else:
        own = merged(own, module, joint.merging)
    return IncludedMachine(table, module, mechanism, own, stand)


def _bought(own: Assembly, mounted: bool, turned: bool) -> Sequence[Bought]:
    """What is bought for it; what turns the shaft is bought once. turned: whether the machine's shaft turns it."""
    left_out = {"drive", "mount"} if mounted else {"drive"}  # posts hold it
    bought = [each for each in own.bought if each.role not in left_out]
    if own.shaft is None or turned:
        return bought
    size = "turns its shaft with the machine's; not made"
    joins = "between its shaft and the machine's"
    return [Bought("coupling or toothed belt 1 : 1", "", size, 1, how=joins), *bought]


def _resolved(each: Include, host: Host) -> Mechanism:
    """The mechanism of an included spec, with everything filled in; DesignError names the include."""
    try:
        mechanism = _mechanism(each, host).resolved()
        _ = mechanism.assembly.parts
    except DesignError as e:
        name = _name(each)
        said = f"{name}{f' ({each.source})' if each.source else ''}: {e.sentence}"
        quantity = f"{name}: {e.quantity}"
        raise DesignError(
            quantity,
            e.value,
            e.limit,
            e.unit,
            e.where,
            e.remedy,
        ).saying(said) from None
    return mechanism


def _mechanism(each: Include, host: Host) -> Mechanism:
    """The mechanism of an included spec, printed as the host is and at the host's speed; SpecError with its faults."""
    assert not isinstance(each.spec, str), "a fault of the spec"
    data = {**each.spec, **{key: host.tables[key] for key in _WHOLE}}
    if isinstance(data.get("parts"), Mapping):  # the host has the stand
        data["parts"] = {key: value for key, value in data["parts"].items() if key != "stand"}
    table = "drive" if "drive" in data else "motor"
    if isinstance(data.get(table), Mapping) and "slide" in data[table]:
        right = "a machine that is turned by a shaft: this one's drive slides"
        raise SpecError([Fault(("drive", "slide"), repr(data[table]["slide"]), right)])
    if isinstance(data.get(table), Mapping):
        data[table] = {**data[table], "speed_rpm": host.speed_rpm}
    return specs.validate(load(specs.choose(data, MECHANISMS)), data)


def _name(each: Include) -> str:
    """What is put before its names: as given, or its spec's name."""
    name = each.spec.get("name", "module") if isinstance(each.spec, Mapping) else "module"
    return each.name or str(name).replace("-", "_")


def heights(parts: Sequence[Part], mounts: Sequence[Mount]) -> list[tuple[float, float]]:
    """From where to where each copy reaches in the assembly, mm."""
    thick = {part.name: part.thickness for part in parts}
    return [(mount.z, mount.z + thick[mount.part]) for mount in mounts]


def clearings(
    includes: Sequence[Include], host: Callable[[], Host]
) -> tuple[tuple[complex, float], ...]:
    """Discs about the holes in the frames of machines that are mounted, on the host's ground, mm."""
    discs: list[tuple[complex, float]] = []
    for each in includes:
        own = _mechanism(each, host()).assembly if each.mounted else None
        if own is None or own.frame is None:
            continue
        holes = own.by_name[own.frame.part].layers[0].region.holes
        arcs = (piece for hole in holes for piece in hole.pieces if isinstance(piece, Arc))
        discs += [(arc.centre + complex(*each.at), 2 * arc.radius) for arc in arcs]
    return tuple(discs)


def _refuse_unfixed(key: Key, own: Assembly, core: float) -> None:
    """Raise SpecError where no screws of posts fit into a frame."""
    wide = set() if own.frame is None else {diameter for _, diameter in own.frame.fixings}
    if not wide:
        right = "false: this machine has no frame with holes for screws from behind"
        raise SpecError([Fault(key, "true", right)])
    if wide != {core}:
        right = (
            f"screw holes of its frame as wide as parts.mount_diameter of this machine, {core:g} mm"
        )
        raise SpecError([Fault(key, f"{max(wide):g} mm", right)])


def _refuse_height(
    key: Key, given: float | None, joint: InLine | None, z: float, least: float
) -> None:
    """Raise SpecError where a machine is given a height, mm, at which its frame cannot stand on the second plate.

    z: where it stands; least: where a frame may that nothing joins to the shaft.
    """
    if given is None or (abs(given - z) <= SAME_POINT and (joint or z >= least)):
        return
    right = (
        f"{z:.6g}, or nothing: both shafts are one"
        if joint
        else f"at least {least:.6g}, or nothing"
    )
    raise SpecError([Fault(key, f"{given:g}", f"{right}: its frame stands on the second plate")])


def _rides(
    key: Key, each: Include, module: Module, mechanism: Mechanism, chain: Machine
) -> tuple[Ride, ...]:
    """Bodies that links of the host carry, as they stand to each other at theta = 0; SpecError, by the key, where they cannot."""
    bodies, links = ([body.name for body in machine.moving] for machine in (mechanism.model, chain))
    lost = [specs.unknown((*key, body), body, bodies) for body in each.ride if body not in bodies]
    lost += [
        specs.unknown((*key, body), link, links)
        for body, link in each.ride.items()
        if link not in links
    ]
    if lost:
        raise SpecError(lost)
    run = mechanism.solve([module.phase], 0)
    host = solve(chain, [0.0], 0)

    def pose(run: Run, body: str, origin: complex) -> Pose:
        """Of a body at the first angle."""
        first = run.pose(body)
        return Pose(complex(first.place[0]) + origin, float(first.angle[0]))

    rides = tuple(
        ride(body, link, pose(run, body, module.at), pose(host, link, 0j))
        for body, link in each.ride.items()
    )
    misfits = replace(module, rides=rides).misfits(mechanism.model)
    if misfits:
        right = "bodies that only pins join to others that move by themselves"
        raise SpecError([Fault(key, misfits[0], right)])
    return rides


def distinct(
    modules: Sequence[IncludedMachine], parts: Sequence[Part], machine: Callable[[], Machine]
) -> None:
    """Raise SpecError where a name of an included machine is one of another machine, of its parts or in the model.

    parts: of the machine that includes them.
    """

    def refusal(name: str, said: str) -> SpecError:
        own = [k for k, each in enumerate(modules) if name in _names(each.assembly)]
        right = "a name of its own in front of each included machine's names: give the include another one"
        return SpecError([Fault(("include", own[-1] if own else 0, "name"), said, right)])

    every = [*parts, *(part for each in modules for part in each.assembly.parts)]
    for name, number in Counter(part.name.lower() for part in every).items():
        if number > 1:
            raise refusal(name, f"part {name} twice")
    try:
        machine()
    except NamedTwice as error:
        raise refusal(error.names[0], str(error)) from None


def _names(assembly: Assembly) -> set[str]:
    """Of its parts, in small letters, and of all in its model."""
    model = assembly.machine
    loads = [load for load in model.loads if not isinstance(load, Gravity)]
    every = (*model.bodies, *model.joints, *model.drives, *loads, *model.outputs)
    return {part.name.lower() for part in assembly.parts} | {each.name for each in every}


# ---- what they answer in the whole -----------------------------------------------------------------------------------


def resolved_table(each: IncludedMachine) -> Mapping[str, Any]:
    """Its own [[include]], with everything filled in."""
    module = each.module
    table = each.table
    return {
        "name": module.prefix,
        "at": (module.at.real, module.at.imag),
        "phase_deg": math.degrees(module.phase),
        "z": module.z,
        **({"mounted": True} if table.mounted else {}),
        **({"ride": table.ride, "ride_tolerance": table.ride_tolerance} if module.rides else {}),
        **({} if table.source is None else {"source": table.source}),
        "spec": each.mechanism.model_dump(by_alias=True, exclude_none=True),
    }


def limits(each: IncludedMachine, chain: Machine) -> Sequence[Finding]:
    """Its design checks, and how well the links of the host's chain that carry bodies of it follow its own motion."""
    own = [
        replace(finding, where=replace(finding.where, module=each.module.prefix))
        for finding in each.mechanism.limits()
    ]
    return [*own, *(_ride_error(each, ride, chain) for ride in each.module.rides)]


def _ride_error(each: IncludedMachine, ride: Ride, chain: Machine) -> Finding:
    """PROGRAM_ERROR: how far a body that rides is from where its own machine has it."""
    theta = np.linspace(0, math.tau, _ANGLES, endpoint=False)
    module = each.module
    link = solve(chain, theta, 0).pose(ride.link)
    own = each.mechanism.solve(theta + module.phase, 0).pose(ride.body)
    off = np.abs(link.place + ride.at * np.exp(1j * link.angle) - own.place - module.at)
    worst = int(np.argmax(off))
    where = Where(
        f"{ride.body} on {ride.link}",
        theta=float(theta[worst]),
        angle="crank angle",
        digits=2,
        module=module.prefix,
    )
    remark = "from its place in its own machine; clearances are judged where the body really goes"
    limit = each.table.ride_tolerance
    return at_most("PROGRAM_ERROR", float(off[worst]), limit, "mm", where, remark)


def study(each: IncludedMachine) -> Study:
    """Its figures, curves and tables, which are those of its own spec; angles in them are its own."""
    notes = [*_origin(each), *_fastening(each)]
    own = placed(each.mechanism, each.module)
    prefix = each.module.prefix
    return replace(own, notes=[*notes, *(f"{prefix}: {note}" for note in own.notes)])


def placed(mechanism: Mechanism, module: Module) -> Study:
    """What a machine that stands in another one shows of itself, under the module's name; its notes as they are."""
    own = mechanism.study()
    prefix = module.prefix
    return Study(
        Figures(replace(each, module=prefix) for each in own.numbers.records),
        Later(lambda: [replace(plot, title=f"{prefix}: {plot.title}") for plot in own.plots]),
        Later(lambda: [replace(table, title=f"{prefix}: {table.title}") for table in own.tables]),
        Later(lambda: [_sketch(sketch, module) for sketch in own.sketches]),
        own.notes,
    )


def _sketch(sketch: Sketch, module: Module) -> Sketch:
    """One of its own where it stands."""
    shift = module.at if sketch.body == GROUND else 0j
    return Sketch(
        module.part(sketch.name),
        [z + shift for z in sketch.strokes],
        [(z + shift, r) for z, r in sketch.circles],
        module.body(sketch.body),
        None if sketch.course is None else partial(_ahead, sketch.course, module),
        None if sketch.z is None else sketch.z + module.z,
        module.body(sketch.level) if sketch.level else "",
    )


def _ahead(course: Callable[[Floats], Points], module: Module, theta: Floats) -> Points:
    """Course of a sketch that changes its shape, (n, k) complex mm on the host's ground; theta: the host's, (n,) rad."""
    return course(theta + module.phase) + module.at


def _fastening(each: IncludedMachine) -> list[str]:
    """What a builder joins: a body that rides has no hole or post of its own for it."""
    module = each.module
    name = module.prefix
    stand = each.stand
    shaft = each.mechanism.assembly.shaft
    notes = [f"{name}: {ride.body} rides on {ride.link}; fasten it there." for ride in module.rides]
    if stand is not None and stand.merged is not None:
        frame = (
            f"{name} has no frame and no shaft of its own: the second plate is its frame, and the machine's shaft "
            "turns it."
        )
    elif shaft is None:
        return notes
    elif stand is not None:
        by = "its shaft is turned by a belt or coupling."
        if stand.sleeve is not None:
            by = "a sleeve joins both shafts."
        frame = f"{name} stands on the second plate: posts screwed on from below, studs in their tops that hold its frame; {by}"
    else:
        frame = (
            f"{name} stands by itself, {module.z:g} mm up, its origin at ({module.at.real:g}, {module.at.imag:g}): no "
            "part joins its plate and shaft to the rest. Screw both frames on one board, this one higher by that much."
        )
    return [frame, *notes]


def _origin(each: IncludedMachine) -> list[str]:
    """Where it was read, if not beside the spec."""
    source = each.table.source
    if source is None or ".." not in PurePosixPath(source).parts:
        return []
    return [f"{each.module.prefix} was read from {source}, outside the spec's folder."]


# ---- their specs -----------------------------------------------------------------------------------------------------


def faults(includes: Sequence[Include], host: Host) -> Sequence[Fault]:
    """What is wrong with included specs, by the key of each."""
    faults = []
    names = [_name(each) for each in includes]
    for k, (each, name) in enumerate(zip(includes, names, strict=True)):
        path = ("include", k)
        if each.mounted and host.tables["parts"]["plates"] < 2:
            right = "false, or parts.plates = 2: the machine stands on the second plate"
            faults.append(Fault((*path, "mounted"), "true", right))
        if name in names[:k]:
            faults.append(Fault((*path, "name"), name, "a name of its own for each"))
        faults += _spec_faults((*path, "spec"), each, host)
    return faults


def _spec_faults(path: Key, each: Include, host: Host) -> list[Fault]:
    """What is wrong with one included spec."""
    if isinstance(each.spec, str):
        right = "its tables: only a spec in a file can name another file"
        return [Fault(path, each.spec, right)]
    drives = each.spec.get("drive")
    if isinstance(drives, Sequence):
        right = "[drive], one table: this machine's shaft turns what it includes"
        return [Fault((*path, "drive"), f"{len(drives)} drives", right)]
    if each.spec.get("include"):
        own = [one.get("spec") for one in each.spec["include"] if isinstance(one, Mapping)]
        files = ", ".join(name for name in own if isinstance(name, str))
        right = (
            f"a spec without [[include]], so that none includes itself: take the [[include]]{files and ' of '}{files} out of it, "
            "and write it in this spec"
        )
        return [Fault(path, f"{each.source or _name(each)}, which has [[include]]", right)]
    try:
        _mechanism(each, host)
    except SpecError as error:
        file = f" (in {each.source})" if each.source else ""
        return [
            replace(fault, path=(*path, *fault.path), expected=fault.expected + file)
            for fault in error.faults
        ]
    return []


def opened(data: reading.Data, folder: Path) -> reading.Data:
    """Copy of a spec's tables in which the path of each included spec, seen from the folder, is replaced by its tables.

    SpecError where the path is not a relative one; FileError where it cannot be read.
    """
    includes = dict[int, reading.Data]()
    for each in reading.references(data):
        if each.kind == "spec":
            file = each.file(folder)
            tables = with_tables(reading.read(file), file.parent, str(file))
            includes[id(each.table)] = {**each.table, "spec": tables, "source": each.name}
    if not includes:
        return data
    return {**data, "include": [includes.get(id(each), each) for each in data["include"]]}
