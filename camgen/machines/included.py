"""Another spec's machine on the same shaft: what `[[include]]` adds to a machine."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path, PurePosixPath, PureWindowsPath
from typing import TYPE_CHECKING, Any

from camgen import spec as specs
from camgen.errors import DesignError, Fault, SpecError
from camgen.findings import Finding
from camgen.machine.features import Apart, Asked, Feature, Mount, StandIn
from camgen.machine.joining import Module
from camgen.machine.model import GROUND, Machine
from camgen.machines import MECHANISMS, load
from camgen.machines.mechanism import Mechanism
from camgen.motion.segments import with_tables
from camgen.parts.catalogue import Bought
from camgen.parts.part import Part
from camgen.study import Sketch, Study

if TYPE_CHECKING:
    from camgen.machines.linkage.tables import Include

_WHOLE = ("print", "material", "accuracy")  # tables that the whole machine has once
_DRIVES = ("drive", "motor")  # what is bought once


@dataclass(frozen=True)
class Included:
    """A mechanism as a module of another one."""

    module: Module
    mechanism: Mechanism
    source: str | None = None

    def tables(self) -> Mapping[str, Any]:
        """Its own [[include]], with everything filled in."""
        m, data = self.module, self.mechanism.model_dump(by_alias=True, exclude_none=True)
        where = {"at": (m.at.real, m.at.imag), "phase_deg": math.degrees(m.phase), "z": m.z}
        source = {} if self.source is None else {"source": self.source}
        return {"name": m.prefix, **where, **source, "spec": data}

    # ---- the model --------------------------------------------------------------------------------------------------

    def machine(self) -> Machine:
        """Its model, by its own names."""
        return self.mechanism.model

    def features(self) -> Sequence[Feature]:
        """On what of its parts its joints are measured."""
        return self.module.features(self.mechanism.features())

    def mounts(self) -> Sequence[Mount]:
        """Its parts on its bodies."""
        return [self.module.mount(mount) for mount in self.mechanism.mounts()]

    def asked(self) -> Sequence[Asked]:
        """What is asked of its outputs."""
        return [self.module.asked(asked) for asked in self.mechanism.asked()]

    # ---- bodies -----------------------------------------------------------------------------------------------------

    def parts(self) -> Sequence[Part]:
        """Its parts."""
        return [replace(part, name=self.module.part(part.name)) for part in self.mechanism.parts()]

    def stand_ins(self) -> Sequence[StandIn]:
        """What is not made and in the way."""
        found = []
        for thing in self.mechanism.stand_ins():
            shift = self.module.at if thing.body == GROUND else 0j
            discs = tuple((at + shift, r, low + self.module.z, high + self.module.z) for at, r, low, high in thing.discs)
            found.append(replace(thing, name=self.module.part(thing.name), body=self.module.body(thing.body), discs=discs))
        return found

    def apart(self) -> Sequence[Apart]:
        """Parts that pass by each other."""
        m = self.module
        return [
            replace(
                each, name=each.name, a=m.part(each.a), b=m.part(each.b), planes=tuple(z + m.z for z in each.planes),
                drawn={m.part(name): (m.part(other), mirrored) for name, (other, mirrored) in each.drawn.items()},
            )
            for each in self.mechanism.contacts()
        ]  # fmt: skip

    def bought(self) -> Sequence[Bought]:
        """What is bought for it; what turns the shaft is bought once."""
        name = self.module.prefix
        return [replace(each, name=f"{each.name}, {name}") for each in self.mechanism.bought() if each.name not in _DRIVES]

    # ---- answers ----------------------------------------------------------------------------------------------------

    def limits(self) -> Sequence[Finding]:
        """Its design checks."""
        return [replace(each, where=f"{self.module.prefix}: {each.where}") for each in self.mechanism.limits()]

    def study(self) -> Study:
        """Its figures, curves and tables, which are those of its own spec; angles in them are its own."""
        found, prefix = self.mechanism.study(), self.module.prefix
        return Study(
            {self.module.name(name): value for name, value in found.numbers.items()},
            [replace(plot, title=f"{prefix}: {plot.title}") for plot in found.plots],
            [replace(table, title=f"{prefix}: {table.title}") for table in found.tables],
            [self._sketch(sketch) for sketch in found.sketches],
            [*self._told(), *(f"{prefix}: {note}" for note in found.notes)],
        )

    def _sketch(self, sketch: Sketch) -> Sketch:
        shift, (name, body) = self.module.at if sketch.body == GROUND else 0j, (sketch.name, sketch.body)
        strokes, circles = [z + shift for z in sketch.strokes], [(z + shift, r) for z, r in sketch.circles]
        return Sketch(self.module.part(name), strokes, circles, self.module.body(body))

    def _told(self) -> list[str]:
        """Where it was read, if not beside the spec."""
        outside = self.source is not None and ".." in PurePosixPath(self.source).parts
        return [f"{self.module.prefix} was read from {self.source}, outside the spec's folder."] if outside else []


def heights(parts: Sequence[Part], mounts: Sequence[Mount]) -> list[tuple[float, float]]:
    """From where to where each copy reaches in the assembly, mm."""
    thick = {part.name: part.thickness for part in parts}
    return [(mount.z, mount.z + thick[mount.part]) for mount in mounts]


def stacked(
    includes: Sequence[Include], host: Mapping[str, Any], rpm: float, top: float, gap: float
) -> tuple[Included, ...]:
    """The included machines, each so far above the highest part before it as the gap says unless its z is given; mm."""
    found: list[Included] = []
    for each in includes:
        try:
            mechanism = _mechanism(each, host, rpm).resolved()
            levels = heights(mechanism.parts(), mechanism.mounts())
        except DesignError as e:
            raise DesignError(f"{_name(each)}: {e.quantity}", e.value, e.limit, e.unit, e.where, e.remedy) from None
        low, high = min(low for low, _ in levels), max(high for _, high in levels)
        z = top + gap - low if each.z is None else each.z
        top = max(top, z + high)
        found.append(Included(Module(_name(each), complex(*each.at), math.radians(each.phase_deg), z), mechanism, each.source))
    return tuple(found)


def faults(includes: Sequence[Include], host: Mapping[str, Any], rpm: float) -> Sequence[Fault]:
    """What is wrong with included specs, by the key of each."""
    found, names = [], [_name(each) for each in includes]
    for k, each in enumerate(includes):
        path = f"include.{k}"
        if names[k] in names[:k]:
            found.append(Fault(f"{path}.name", names[k], "a name of its own for each"))
        if isinstance(each.spec, str):
            found.append(Fault(f"{path}.spec", each.spec, "its tables: only a spec in a file can name another file"))
            continue
        if "include" in each.spec:
            right = "a machine that includes none, so that none includes itself: name all side by side"
            found.append(Fault(f"{path}.spec", f"{each.source or names[k]}, which has [[include]]", right))
            continue
        try:
            _mechanism(each, host, rpm)
        except SpecError as error:
            found += [replace(fault, path=f"{path}.spec.{fault.path}") for fault in error.faults]
    return found


def opened(data: specs.Data, folder: Path) -> specs.Data:
    """Copy of a spec's tables in which the path of each included spec, seen from the folder, is replaced by its tables.

    SpecError where the path is not a relative one; FileError where it cannot be read.
    """
    includes = data.get("include")
    if not isinstance(includes, list):
        return data
    found = []
    for k, each in enumerate(includes):
        path = each.get("spec") if isinstance(each, dict) else None
        if isinstance(path, str):
            if PurePosixPath(path).is_absolute() or PureWindowsPath(path).drive or "\\" in path:
                right = 'a relative path with "/", so that the folder can be moved'
                raise SpecError([Fault(f"include.{k}.spec", path, right)])
            file = folder / path
            each = {**each, "spec": with_tables(specs.read(file), file.parent), "source": path}
        found.append(each)
    return {**data, "include": found}


def _mechanism(each: Include, host: Mapping[str, Any], rpm: float) -> Mechanism:
    """The mechanism of an included spec, printed as the host is and at the host's speed; SpecError with its faults."""
    assert not isinstance(each.spec, str), "faults() tells it"
    data = {**each.spec, **{key: host[key] for key in _WHOLE}}
    for table in ("motor", "drive"):
        if isinstance(data.get(table), Mapping):
            data[table] = {**data[table], "speed_rpm": rpm}
    return specs.validate(load(specs.choose(data, MECHANISMS)), data)


def _name(each: Include) -> str:
    """What is put before its names: as given, or its spec's name."""
    name = each.spec.get("name", "module") if isinstance(each.spec, Mapping) else "module"
    return each.name or str(name).replace("-", "_")
