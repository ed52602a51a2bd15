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
from camgen.machine.run import solve
from camgen.machines import MECHANISMS, load
from camgen.machines.mechanism import Mechanism
from camgen.motion.tables import with_tables
from camgen.numerics import Floats, Points
from camgen.parts.assembly import Assembly, renamed
from camgen.parts.catalogue import Bought
from camgen.parts.generator.joined import Stand
from camgen.parts.generator.mounted import InLine, UpperEnd, in_line, merged
from camgen.parts.part import Part
from camgen.study import Later, Sketch, Study
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
class Included:
    """A machine as it stands in another one."""

    table: Include  # its [[include]]
    module: Module
    mechanism: Mechanism  # of its own spec
    assembly: Assembly  # as it stands in the whole
    stand: Stand | None = None  # of its frame, on the second plate; None where it stands by itself


# ---- what they are ---------------------------------------------------------------------------------------------------


def stacked(
    includes: Sequence[Include],
    host: Host,
    chain: Machine,
    top: float,
    gap: float,
    end: UpperEnd | None,
) -> tuple[Included, ...]:
    """The included machines, each so far above the highest part before it as the gap says unless its z is given; mm.

    chain: the host's own model; top: height of its highest part; end: of its shaft, where it has a second plate.
    """
    found: list[Included] = []
    for k, each in enumerate(includes):
        mechanism = _made(each, host)
        own = mechanism.assembly
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
        module = replace(
            module, rides=_rides(("include", k, "ride"), each, module, mechanism, chain)
        )
        found.append(_included(each, module, mechanism, joint))
    return tuple(found)


def _included(
    table: Include, module: Module, mechanism: Mechanism, joint: InLine | None
) -> Included:
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
        return Included(table, module, mechanism, renamed(own, module), stand)
    return Included(table, module, mechanism, merged(own, module, joint.merging), stand)


def _bought(own: Assembly, mounted: bool, turned: bool) -> Sequence[Bought]:
    """What is bought for it; what turns the shaft is bought once. turned: whether the machine's shaft turns it."""
    coupling = Bought(
        "coupling or toothed belt 1 : 1", "", "turns its shaft with the machine's; not made", 1
    )
    left = [
        each
        for each in own.bought
        if each.role != "drive" and not (mounted and each.role == "mount")  # posts hold it
    ]
    return left if own.shaft is None or turned else [coupling, *left]


def _made(each: Include, host: Host) -> Mechanism:
    """The mechanism of an included spec, with everything filled in; DesignError names the include."""
    try:
        found = _mechanism(each, host).resolved()
        _ = found.assembly.parts
    except DesignError as e:
        said = f"{_name(each)}{f' ({each.source})' if each.source else ''}: {e.sentence}"
        raise DesignError(
            f"{_name(each)}: {e.quantity}", e.value, e.limit, e.unit, e.where, e.remedy, said
        ) from None
    return found


def _mechanism(each: Include, host: Host) -> Mechanism:
    """The mechanism of an included spec, printed as the host is and at the host's speed; SpecError with its faults."""
    assert not isinstance(each.spec, str), "faults() tells it"
    data = {**each.spec, **{key: host.tables[key] for key in _WHOLE}}
    for table in ("drive",) if "drive" in data else ("motor",):
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


def kept(
    includes: Sequence[Include], host: Callable[[], Host]
) -> tuple[tuple[complex, float], ...]:
    """Discs about the holes in the frames of machines that are mounted, on the host's ground, mm."""
    found: list[tuple[complex, float]] = []
    for each in (each for each in includes if each.mounted):
        made = _mechanism(each, host()).assembly
        holes = () if made.frame is None else made.by_name[made.frame.part].layers[0].region.holes
        arcs = (piece for hole in holes for piece in hole.pieces if isinstance(piece, Arc))
        found += [(arc.centre + complex(*each.at), 2 * arc.radius) for arc in arcs]
    return tuple(found)


def _refuse_unfixed(key: Key, own: Assembly, core: float) -> None:
    """Raise SpecError where no screws of posts fit into a frame."""
    wide = set() if own.frame is None else {diameter for _, diameter in own.frame.fixings}
    if not wide:
        right = "nothing here: this machine has no frame with holes for screws from behind"
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
    if given is None or (abs(given - z) <= SAME_POINT and (joint is not None or z >= least)):
        return
    right = f"at least {least:.6g}, or nothing"
    if joint is not None:
        right = f"{z:.6g}, or nothing: both shafts are one"
    raise SpecError([Fault(key, f"{given:g}", f"{right}: its frame stands on the second plate")])


def _rides(
    key: Key, each: Include, module: Module, mechanism: Mechanism, chain: Machine
) -> tuple[Ride, ...]:
    """Bodies that links of the host carry, as they stand to each other at theta = 0; SpecError, by the key, where they cannot."""
    bodies, links = ([body.name for body in machine.moving] for machine in (mechanism.model, chain))
    wrong = [specs.unknown((*key, body), body, bodies) for body in each.ride if body not in bodies]
    wrong += [
        specs.unknown((*key, body), link, links)
        for body, link in each.ride.items()
        if link not in links
    ]
    if wrong:
        raise SpecError(wrong)
    run = mechanism.solve([module.phase], 0)
    host = solve(chain, [0.0], 0)
    found = []
    for body, link in each.ride.items():
        own = run.pose(body)
        carrier = host.pose(link)
        there = Pose(complex(own.place[0]) + module.at, float(own.angle[0]))
        found.append(
            ride(body, link, there, Pose(complex(carrier.place[0]), float(carrier.angle[0])))
        )
    misfits = replace(module, rides=tuple(found)).misfits(mechanism.model)
    if misfits:
        raise SpecError(
            [Fault(key, misfits[0], "bodies that only pins join to others that move by themselves")]
        )
    return tuple(found)


def distinct(
    found: Sequence[Included], parts: Sequence[Part], machine: Callable[[], Machine]
) -> None:
    """Raise SpecError where a name of an included machine is one of another machine, of its parts or in the model.

    parts: of the machine that includes them.
    """

    def refused(name: str, said: str) -> SpecError:
        own = [k for k, each in enumerate(found) if name in _names(each.assembly)]
        return SpecError([Fault(("include", own[-1] if own else 0, "name"), said, right)])

    right = (
        "a name of its own in front of each included machine's names: give the include another one"
    )
    count = Counter(
        part.name.lower()
        for part in (*parts, *(part for each in found for part in each.assembly.parts))
    )
    twice = [name for name, number in count.items() if number > 1]
    if twice:
        raise refused(twice[0], f"part {twice[0]} twice")
    try:
        machine()
    except NamedTwice as error:
        raise refused(error.names[0], str(error)) from None


def _names(made: Assembly) -> set[str]:
    """Of its parts, in small letters, and of all in its model."""
    model = made.machine
    loads = [load for load in model.loads if not isinstance(load, Gravity)]
    held = (*model.bodies, *model.joints, *model.drives, *loads, *model.outputs)
    return {part.name.lower() for part in made.parts} | {each.name for each in held}


# ---- what they answer in the whole -----------------------------------------------------------------------------------


def filled(each: Included) -> Mapping[str, Any]:
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


def limits(each: Included, chain: Machine) -> Sequence[Finding]:
    """Its design checks, and how well the links of the host's chain that carry bodies of it follow its own motion."""
    own = [
        replace(finding, where=replace(finding.where, module=each.module.prefix))
        for finding in each.mechanism.limits()
    ]
    return [*own, *(_followed(each, ride, chain) for ride in each.module.rides)]


def _followed(each: Included, ride: Ride, chain: Machine) -> Finding:
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
    said = "from where its own machine has it; what follows from it, such as clearances, is judged where it really goes"
    return at_most("PROGRAM_ERROR", float(off[worst]), each.table.ride_tolerance, "mm", where, said)


def study(each: Included) -> Study:
    """Its figures, curves and tables, which are those of its own spec; angles in them are its own."""
    found = each.mechanism.study()
    module = each.module
    prefix = module.prefix
    return Study(
        {module.name(name): value for name, value in found.numbers.items()},
        Later(lambda: [replace(plot, title=f"{prefix}: {plot.title}") for plot in found.plots]),
        Later(lambda: [replace(table, title=f"{prefix}: {table.title}") for table in found.tables]),
        Later(lambda: [_sketch(sketch, module) for sketch in found.sketches]),
        [*_origin(each), *_fastened(each), *(f"{prefix}: {note}" for note in found.notes)],
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
    )


def _ahead(course: Callable[[Floats], Points], module: Module, theta: Floats) -> Points:
    """The course of what changes its shape, at the host's theta and where the module stands."""
    return course(theta + module.phase) + module.at


def _fastened(each: Included) -> list[str]:
    """What a builder joins: a body that rides has no hole or post of its own for it."""
    name = each.module.prefix
    module = each.module
    stand = each.stand
    shaft = each.mechanism.assembly.shaft
    said: list[str] = []
    if stand is not None and stand.merged is not None:
        said.append(
            f"{name} has no frame and no shaft of its own: the second plate holds what its frame would, and the machine's shaft "
            "turns it."
        )
    elif stand is not None and shaft is not None:
        turned = "its shaft is turned by a belt or coupling."
        if stand.sleeve is not None:
            turned = "a sleeve joins both shafts."
        said.append(
            f"{name} stands on the second plate: posts screwed on from below, studs in their tops that hold its frame; {turned}"
        )
    elif shaft is not None:
        said.append(
            f"{name} stands by itself, {module.z:g} mm up, its origin at ({module.at.real:g}, {module.at.imag:g}): nothing is "
            "made that joins its plate and shaft to the rest. Screw both frames on one board, this one so much higher."
        )
    rides = [f"{name}: {ride.body} rides on {ride.link}; fasten it there." for ride in module.rides]
    return [*said, *rides]


def _origin(each: Included) -> list[str]:
    """Where it was read, if not beside the spec."""
    source = each.table.source
    if source is None or ".." not in PurePosixPath(source).parts:
        return []
    return [f"{each.module.prefix} was read from {source}, outside the spec's folder."]


# ---- their specs -----------------------------------------------------------------------------------------------------


def faults(includes: Sequence[Include], host: Host) -> Sequence[Fault]:
    """What is wrong with included specs, by the key of each."""
    found = []
    names = [_name(each) for each in includes]
    for k, each in enumerate(includes):
        path = ("include", k)
        if each.mounted and host.tables["parts"]["plates"] < 2:
            right = "nothing here, or parts.plates = 2 beside it: it stands on the second plate"
            found.append(Fault((*path, "mounted"), "true", right))
        if names[k] in names[:k]:
            found.append(Fault((*path, "name"), names[k], "a name of its own for each"))
        if isinstance(each.spec, str):
            found.append(
                Fault(
                    (*path, "spec"),
                    each.spec,
                    "its tables: only a spec in a file can name another file",
                )
            )
            continue
        if each.spec.get("include"):
            own = each.spec["include"]
            specs_of = [
                str(one["spec"])
                for one in own
                if isinstance(one, Mapping) and isinstance(one.get("spec"), str)
            ]
            which = f" of {', '.join(specs_of)}" if specs_of else ""
            right = f"a spec without [[include]], so that none includes itself: take the [[include]]{which} out of it, and write "
            found.append(
                Fault(
                    (*path, "spec"),
                    f"{each.source or names[k]}, which has [[include]]",
                    right + "it in this spec",
                )
            )
            continue
        try:
            _mechanism(each, host)
        except SpecError as error:
            file = f" (in {each.source})" if each.source else ""
            found += [
                replace(fault, path=(*path, "spec", *fault.path), expected=fault.expected + file)
                for fault in error.faults
            ]
    return found


def opened(data: reading.Data, folder: Path) -> reading.Data:
    """Copy of a spec's tables in which the path of each included spec, seen from the folder, is replaced by its tables.

    SpecError where the path is not a relative one; FileError where it cannot be read.
    """
    read = dict[int, reading.Data]()
    for each in reading.references(data):
        if each.kind == "spec":
            file = each.file(folder)
            tables = with_tables(reading.read(file), file.parent, str(file))
            read[id(each.table)] = {**each.table, "spec": tables, "source": each.name}
    return (
        {**data, "include": [read.get(id(each), each) for each in data["include"]]}
        if read
        else data
    )
