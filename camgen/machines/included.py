"""Another spec's machine on the same shaft: what `[[include]]` adds to a machine."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, partial
from pathlib import Path, PurePosixPath
from typing import TYPE_CHECKING, Any

import numpy as np

from camgen import reading
from camgen import spec as specs
from camgen.errors import DesignError, Fault, SpecError
from camgen.findings import Finding, at_most
from camgen.geometry.outlines import Arc
from camgen.machine.features import Mount
from camgen.machine.joining import Module, Ride, ride
from camgen.machine.model import GROUND, Machine, Pose
from camgen.machine.run import solve
from camgen.machines import MECHANISMS, load
from camgen.machines.mechanism import Mechanism
from camgen.machines.merged import Merging, merging
from camgen.motion.tables import with_tables
from camgen.numerics import Floats, Points
from camgen.parts.assembly import Assembly, renamed
from camgen.parts.catalogue import Bought
from camgen.parts.generator.joined import Merged, Sleeve, Stand
from camgen.parts.generator.layout import SLEEVE, Layout
from camgen.parts.part import Part
from camgen.study import Later, Sketch, Study
from camgen.tolerances import SAME_POINT

if TYPE_CHECKING:
    from camgen.machines.linkage.tables import Include
    from camgen.parts.generator.sizes import Parts

_WHOLE = ("print", "material", "accuracy")  # tables that the whole machine has once
_ANGLES = 1440  # at which bodies that ride are compared with their own motion
_BEHIND = "from behind"  # so end the names of screws that hold a frame where it stands by itself
_DRIVES = ("drive", "motor")  # what is bought once


@dataclass(frozen=True)
class Included:
    """A mechanism as a module of another one."""

    module: Module
    mechanism: Mechanism
    host: Machine
    source: str | None = None
    tolerance: float = 0.0
    mounted: bool = False
    sleeve: Sleeve | None = None
    merged: tuple[Merging, Merged] | None = None

    def tables(self) -> Mapping[str, Any]:
        """Its own [[include]], with everything filled in."""
        m, data = self.module, self.mechanism.model_dump(by_alias=True, exclude_none=True)
        where = {"at": (m.at.real, m.at.imag), "phase_deg": math.degrees(m.phase), "z": m.z}
        source = {} if self.source is None else {"source": self.source}
        ride = (
            {"ride": {each.body: each.link for each in m.rides}, "ride_tolerance": self.tolerance}
            if m.rides
            else {}
        )
        where |= {"mounted": True} if self.mounted else {}
        return {"name": m.prefix, **where, **ride, **source, "spec": data}

    # ---- as a module ------------------------------------------------------------------------------------------------

    @cached_property
    def assembly(self) -> Assembly:
        """What is made of it, as it stands in the whole."""
        own = self.mechanism.assembly
        if self.merged is None:
            return replace(renamed(own, self.module), bought=self._bought())
        merging = self.merged[0]
        made = renamed(merging.left(own), self.module)
        features = [merging.feature(each, self.module) for each in made.features]
        return replace(made, features=features, bought=self._bought())

    def _bought(self) -> Sequence[Bought]:
        """What is bought for it; what turns the shaft is bought once."""
        name = self.module.prefix
        turned = Bought(
            f"coupling or toothed belt 1 : 1, {name}",
            "",
            "turns its shaft with the machine's; not made",
            1,
        )
        bought = self.mechanism.assembly.bought
        left = [
            each for each in bought if not (self.mounted and each.name.endswith(_BEHIND))
        ]  # posts hold it
        own = [
            replace(each, name=f"{each.name}, {name}") for each in left if each.name not in _DRIVES
        ]
        return [*([turned] if self._shafts and not (self.sleeve or self.merged) else []), *own]

    @property
    def stand(self) -> Stand:
        """Its frame on the second plate."""
        places = tuple(z + self.module.at for z, _ in _fixings(self.mechanism))
        return Stand(
            self.module.part("")[:-1],
            places,
            self.module.z,
            self.sleeve,
            self.merged[1] if self.merged else None,
        )

    @property
    def _shafts(self) -> bool:
        """Whether it has a shaft of its own to be turned."""
        return "shaft" in self.mechanism.assembly.by_name

    # ---- answers ----------------------------------------------------------------------------------------------------

    def limits(self) -> Sequence[Finding]:
        """Its design checks, and how well the links that carry bodies of it follow its own motion."""
        own = [
            replace(each, where=f"{self.module.prefix}: {each.where}")
            for each in self.mechanism.limits()
        ]
        return [*own, *(self._followed(ride) for ride in self.module.rides)]

    def _followed(self, ride: Ride) -> Finding:
        """PROGRAM_ERROR: how far a body that rides is from where its own machine has it."""
        theta, m = np.linspace(0, math.tau, _ANGLES, endpoint=False), self.module
        link, own = (
            solve(self.host, theta, 0).pose(ride.link),
            self.mechanism.solve(theta + m.phase, 0).pose(ride.body),
        )
        off = np.abs(link.place + ride.at * np.exp(1j * link.angle) - own.place - m.at)
        worst = int(np.argmax(off))
        where = f"{m.prefix}: {ride.body} on {ride.link}, crank angle {math.degrees(theta[worst]):.2f} deg"
        said = "from where its own machine has it; what follows from it, such as clearances, is judged where it really goes"
        return at_most("PROGRAM_ERROR", float(off[worst]), self.tolerance, "mm", where, said)

    def study(self) -> Study:
        """Its figures, curves and tables, which are those of its own spec; angles in them are its own."""
        found, prefix = self.mechanism.study(), self.module.prefix
        return Study(
            {self.module.name(name): value for name, value in found.numbers.items()},
            Later(lambda: [replace(plot, title=f"{prefix}: {plot.title}") for plot in found.plots]),
            Later(
                lambda: [replace(table, title=f"{prefix}: {table.title}") for table in found.tables]
            ),
            Later(lambda: [self.sketch(sketch) for sketch in found.sketches]),
            [*self._told(), *self._fastened(), *(f"{prefix}: {note}" for note in found.notes)],
        )

    def sketch(self, sketch: Sketch) -> Sketch:
        """One of its own where it stands."""
        shift, (name, body) = (
            self.module.at if sketch.body == GROUND else 0j,
            (sketch.name, sketch.body),
        )
        strokes, circles = (
            [z + shift for z in sketch.strokes],
            [(z + shift, r) for z, r in sketch.circles],
        )
        z = None if sketch.z is None else sketch.z + self.module.z
        course = None if sketch.course is None else partial(_ahead, sketch.course, self.module)
        return Sketch(self.module.part(name), strokes, circles, self.module.body(body), course, z)

    def _fastened(self) -> list[str]:
        """What a builder joins: a body that rides has no hole or post of its own for it."""
        name, at = self.module.prefix, self.module.at
        plate = f"{name} stands by itself, {self.module.z:g} mm up, its origin at ({at.real:g}, {at.imag:g}): nothing is made "
        plate += "that joins its plate and shaft to the rest. Screw both frames on one board, this one so much higher."
        if self.mounted:
            plate = f"{name} stands on the second plate: posts screwed on from below, studs in their tops that hold its frame; "
            if self.merged:
                plate = f"{name} has no frame and no shaft of its own: the second plate holds what its frame would, and the "
                plate += "machine's shaft turns it."
                return [
                    plate,
                    *(
                        f"{name}: {ride.body} rides on {ride.link}; fasten it there."
                        for ride in self.module.rides
                    ),
                ]
            plate += (
                "a sleeve joins both shafts."
                if self.sleeve
                else "its shaft is turned by a belt or coupling."
            )
        rides = [
            f"{name}: {ride.body} rides on {ride.link}; fasten it there."
            for ride in self.module.rides
        ]
        return [*([plate] if self._shafts else []), *rides]

    def _told(self) -> list[str]:
        """Where it was read, if not beside the spec."""
        outside = self.source is not None and ".." in PurePosixPath(self.source).parts
        return (
            [f"{self.module.prefix} was read from {self.source}, outside the spec's folder."]
            if outside
            else []
        )


def heights(parts: Sequence[Part], mounts: Sequence[Mount]) -> list[tuple[float, float]]:
    """From where to where each copy reaches in the assembly, mm."""
    thick = {part.name: part.thickness for part in parts}
    return [(mount.z, mount.z + thick[mount.part]) for mount in mounts]


def distinct(
    found: Sequence[Included], parts: Sequence[Part], machine: Callable[[], Machine]
) -> None:
    """Raise SpecError where a name of an included machine is one of another machine, of its parts or in the model.

    parts: of the machine that includes them.
    """

    def refused(name: str, said: str) -> SpecError:
        own = [
            k
            for k, each in enumerate(found)
            if name.startswith((each.module.name(""), each.module.part("")))
        ]
        return SpecError([Fault(f"include.{own[-1] if own else 0}.name", said, right)])

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
    except ValueError as told:
        raise refused(str(told).rpartition(": ")[2], str(told)) from None


@dataclass(frozen=True)
class Line:
    """The upper end of the host's shaft: its axis on the ground, None where it does not reach the second plate, where it ends in
    a sleeve, mm, how its link is turned at theta = 0, rad, the sizes of the host's parts, the shaft's name, and the height of
    the plate's underside, mm."""

    axis: complex | None
    end: float
    angle: float
    sizes: Parts
    shaft: str
    ceiling: float


def stacked(
    includes: Sequence[Include],
    host: Mapping[str, Any],
    rpm: float,
    chain: Machine,
    top: float,
    gap: float,
    line: Line | None = None,
) -> tuple[Included, ...]:
    """The included machines, each so far above the highest part before it as the gap says unless its z is given; mm.

    host: the tables of the spec that includes them; chain: its own model; line: its shaft, where it has a second plate.
    """
    found: list[Included] = []
    for k, each in enumerate(includes):
        try:
            mechanism = _mechanism(each, host, rpm).resolved()
            levels = heights(mechanism.assembly.parts, mechanism.assembly.mounts)
        except DesignError as e:
            said = f"{_name(each)}{f' ({each.source})' if each.source else ''}: {str(e).removesuffix(f'; {e.remedy}')}"
            raise DesignError(
                f"{_name(each)}: {e.quantity}", e.value, e.limit, e.unit, e.where, e.remedy, said
            ) from None
        low, high = min(low for low, _ in levels), max(high for _, high in levels)
        z = top + gap - low if each.z is None else each.z
        sleeve = merged = None
        if each.mounted and line is not None:
            _refuse_unfixed(f"include.{k}.mounted", mechanism, line.sizes.mount_diameter)
            z, sleeve, merged = _in_line(each, mechanism, line, gap) or (z, None, None)
            least = line.ceiling + line.sizes.base_thickness + gap - low
            if each.z is not None and (
                abs(each.z - z) > SAME_POINT or not (sleeve or merged or z >= least)
            ):
                right = (
                    f"{z:.6g}, or nothing: both shafts are one"
                    if sleeve or merged
                    else f"at least {least:.6g}, or nothing"
                )
                raise SpecError(
                    [
                        Fault(
                            f"include.{k}.z",
                            f"{each.z:g}",
                            f"{right}: its frame stands on the second plate",
                        )
                    ]
                )
        top = max(top, z + high)
        module = Module(_name(each), complex(*each.at), math.radians(each.phase_deg), z)
        module = replace(module, rides=_rides(f"include.{k}.ride", each, module, mechanism, chain))
        found.append(
            Included(
                module,
                mechanism,
                chain,
                each.source,
                each.ride_tolerance,
                each.mounted,
                sleeve,
                merged,
            )
        )
    return tuple(found)


def _fixings(mechanism: Mechanism) -> Sequence[tuple[complex, float]]:
    """Holes in its frame for screws from behind: place and diameter, mm."""
    frame = mechanism.assembly.frame
    return () if frame is None else frame.fixings


def _refuse_unfixed(key: str, mechanism: Mechanism, core: float) -> None:
    """Raise SpecError where no screws of posts fit into a frame."""
    wide = {diameter for _, diameter in _fixings(mechanism)}
    if not wide:
        raise SpecError(
            [
                Fault(
                    key,
                    "true",
                    "nothing here: this machine has no frame with holes for screws from behind",
                )
            ]
        )
    if wide != {core}:
        right = (
            f"screw holes of its frame as wide as parts.mount_diameter of this machine, {core:g} mm"
        )
        raise SpecError([Fault(key, f"{max(wide):g} mm", right)])


Joined = tuple[float, Sleeve | None, tuple[Merging, Merged] | None]


def _in_line(each: Include, mechanism: Mechanism, line: Line, gap: float) -> Joined | None:
    """How far a machine is raised whose shaft is in line with the host's, mm, and what joins them, where both are alike and its
    frame is flat below the plate and shaft that both have; None where they are not in line."""
    made = mechanism.assembly
    shaft = next(iter(made.poses(np.array([math.radians(each.phase_deg)])).get("shaft", ())), None)
    making = getattr(mechanism, "making", None)
    if shaft is None or making is None or line.axis is None:
        return None
    if abs(complex(shaft.place[0]) + complex(*each.at) - line.axis) > SAME_POINT:
        return None
    phase, sizes = math.radians(each.phase_deg), line.sizes
    if (making.shaft_diameter, making.shaft_flat) == (sizes.shaft_diameter, sizes.shaft_flat):
        found = merging(
            made, complex(*each.at), phase, line.angle, line.shaft, sizes.base_thickness, sizes.wall
        )
        if found is not None:
            return line.ceiling + sizes.base_thickness - found[2], None, found[:2]
    room = min(mount.z for mount in made.mounts if mount.part != "shaft") - shaft.z - gap
    up = min(SLEEVE * making.shaft_diameter, room)
    if up < making.shaft_diameter / 2:
        raise DesignError(
            "room for a sleeve on the shaft",
            up,
            making.shaft_diameter / 2,
            "mm",
            _name(each),
            "let it stand out further under its frame: a longer parts.shaft_length there",
        )
    turn = float(shaft.angle[0]) - line.angle
    return line.end - shaft.z, Sleeve(making.shaft_diameter, making.shaft_flat, turn, up), None


def upper_end(layout: Layout) -> Line | None:
    """Of the shaft that drives a linkage, where it has a second plate."""
    if layout.second is None:
        return None
    point = layout.shaft_of(layout.driven)
    axis = layout.at(GROUND, point) if layout.in_second(point) else None
    shaft = "shaft" if layout.cut(point) is None else f"shaft-{layout.upper_web}"
    angle = float(layout.machine.start_of(layout.driven).angle)
    return Line(axis, layout.line[1], angle, layout.sizes, shaft, layout.ceiling)


def kept(
    includes: Sequence[Include], host: Callable[[], Mapping[str, Any]], rpm: float
) -> tuple[tuple[complex, float], ...]:
    """Discs about the holes in the frames of machines that are mounted, on the host's ground, mm; host: gives its tables."""
    found: list[tuple[complex, float]] = []
    for each in (each for each in includes if each.mounted):
        mechanism = _mechanism(each, host(), rpm)
        made = mechanism.assembly
        holes = () if made.frame is None else made.by_name[made.frame.part].layers[0].region.holes
        arcs = (piece for hole in holes for piece in hole.pieces if isinstance(piece, Arc))
        found += [(arc.centre + complex(*each.at), 2 * arc.radius) for arc in arcs]
    return tuple(found)


def _rides(
    key: str, each: Include, module: Module, mechanism: Mechanism, chain: Machine
) -> tuple[Ride, ...]:
    """Bodies that links of the host carry, as they stand to each other at theta = 0; SpecError, by the key, where they cannot."""
    bodies, links = ([body.name for body in machine.moving] for machine in (mechanism.model, chain))
    wrong = [
        specs.unknown(f"{key}.{body}", body, bodies) for body in each.ride if body not in bodies
    ]
    wrong += [
        specs.unknown(f"{key}.{body}", link, links)
        for body, link in each.ride.items()
        if link not in links
    ]
    if wrong:
        raise SpecError(wrong)
    run, host, found = mechanism.solve([module.phase], 0), solve(chain, [0.0], 0), []
    for body, link in each.ride.items():
        own, carrier = run.pose(body), host.pose(link)
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


def _ahead(course: Callable[[Floats], Points], module: Module, theta: Floats) -> Points:
    """The course of what changes its shape, at the host's theta and where the module stands."""
    return course(theta + module.phase) + module.at


def faults(includes: Sequence[Include], host: Mapping[str, Any], rpm: float) -> Sequence[Fault]:
    """What is wrong with included specs, by the key of each."""
    found, names = [], [_name(each) for each in includes]
    for k, each in enumerate(includes):
        path = f"include.{k}"
        if each.mounted and host["parts"]["plates"] < 2:
            right = "nothing here, or parts.plates = 2 beside it: it stands on the second plate"
            found.append(Fault(f"{path}.mounted", "true", right))
        if names[k] in names[:k]:
            found.append(Fault(f"{path}.name", names[k], "a name of its own for each"))
        if isinstance(each.spec, str):
            found.append(
                Fault(
                    f"{path}.spec",
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
                    f"{path}.spec",
                    f"{each.source or names[k]}, which has [[include]]",
                    right + "it in this spec",
                )
            )
            continue
        try:
            _mechanism(each, host, rpm)
        except SpecError as error:
            file = f" (in {each.source})" if each.source else ""
            found += [
                replace(fault, path=f"{path}.spec.{fault.path}", expected=fault.expected + file)
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


def _mechanism(each: Include, host: Mapping[str, Any], rpm: float) -> Mechanism:
    """The mechanism of an included spec, printed as the host is and at the host's speed; SpecError with its faults."""
    assert not isinstance(each.spec, str), "faults() tells it"
    data = {**each.spec, **{key: host[key] for key in _WHOLE}}
    for table in ("drive",) if "drive" in data else ("motor",):
        if isinstance(data.get(table), Mapping):
            data[table] = {**data[table], "speed_rpm": rpm}
    return specs.validate(load(specs.choose(data, MECHANISMS)), data)


def _name(each: Include) -> str:
    """What is put before its names: as given, or its spec's name."""
    name = each.spec.get("name", "module") if isinstance(each.spec, Mapping) else "module"
    return each.name or str(name).replace("-", "_")
