"""The one interface: a mechanism is a frozen record whose fields are its spec and which answers some questions as data.

model                  its bodies, joints, drive, loads and outputs
motion(theta, order)   the wanted output
assembly               what to make, where it stands, on what of it the joints are measured
limits()               closed-form design checks, as findings
study()                named numbers, curves and tables for the report
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import cached_property, reduce
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar, Self, TypeVar

import numpy as np
from numpy.typing import ArrayLike
from pydantic import Field

from camgen.arguments import checked
from camgen.errors import DesignError, Fault, SpecError
from camgen.findings import Finding, NotJudged
from camgen.geometry.outlines import Floats
from camgen.machine.features import CamOutline, Feature, Mount
from camgen.machine.model import GROUND, Machine, unit_of
from camgen.machine.run import Run, solve
from camgen.machines.free_play import ANGLES, of_pins, pins_alone
from camgen.machines.loads.applied import efforts
from camgen.machines.loads.rubbing import with_friction
from camgen.machines.loads.tables import LimitsTable, Weight
from camgen.machines.loads.weights import Masses, with_gravity, with_masses
from camgen.machines.metal import with_walls
from camgen.machines.spec_files import with_tables
from camgen.parts import materials
from camgen.parts.assembly import Assembly, Cycle, Process, tips
from camgen.parts.fixing import Fixing
from camgen.parts.inertia import printed_density
from camgen.parts.journals import MaterialLimits, journals
from camgen.parts.part import Part
from camgen.reading import Data
from camgen.schemas import shown
from camgen.settings import assigned
from camgen.spec import Spec, dump, validate
from camgen.study import Later, Study

if TYPE_CHECKING:
    from trimesh import Scene

    from camgen.geometry.mesh import Mesh


@dataclass(frozen=True)
class Remarks:
    """What is to be said of a machine beside its findings."""

    printed: Sequence[str] = ()  # lines, by a build
    unused: Sequence[str] = ()  # keys that were set and say nothing of this machine, dotted
    warnings: Sequence[str] = ()  # that a report begins with
    links: int = 0  # that are closed together on what each kind of file shows: many take long


class Mechanism(Spec, ABC):
    """Base of all mechanisms; theta is the input angle, rad, counter-clockwise."""

    # keys of every spec that this machine has no use for: table, key, what would be right
    no_use: ClassVar[Sequence[tuple[str, str, str]]] = ()

    # whether it is a cam or drum, which is hardened where its follower runs if its metal can be
    hardened: ClassVar[bool] = False

    load: Weight | None = Field(default=None, description="loads on the machine")

    @classmethod
    def filled(cls, data: Any) -> Any:
        """The tables with what one of them decides in another."""
        return with_walls(data, cls.hardened)

    def __repr__(self) -> str:
        """Its kind and name, and how to see more."""
        return f"<{self.mechanism} {self.name!r}: print() says what it is>"

    def __str__(self) -> str:
        """What it is, in about five lines: its links and joints, what drives it, and its outputs."""
        lines = [f"{self.mechanism} {self.name!r}"]
        try:
            lines += _said(self.model)
        except DesignError as error:
            lines.append(f"cannot exist: {error}")
        lines.append("toml() is its spec, solve(theta) its motion, assembly.parts its parts")
        return "\n  ".join(lines)

    def toml(self) -> str:
        """Its spec as TOML, with every default."""
        return dump(self)

    def _repr_html_(self) -> str:
        """For a notebook: its kind and name, and its spec folded away."""
        from html import escape

        head = f"<b>{escape(self.name)}</b> ({escape(self.mechanism)})"
        return f"<details><summary>{head}</summary><pre>{escape(self.toml())}</pre></details>"

    @checked
    def replace(self, changes: Mapping[str, object]) -> Self:
        """The machine with some keys of its spec set anew: `machine.replace({"geometry.base_radius": 30})`.

        A key is typed as for `--set`, of a list by its index: "segment.0.lift"; None removes it. Files are seen from here.
        Raises SpecError with every fault, by its key.
        """
        before = self.source_tables
        data = before
        for key, value in changes.items():
            data = assigned(data, key, value)
        if data.get("mechanism") != self.mechanism:
            fault = Fault(
                ("mechanism",), repr(data.get("mechanism")), f"{self.mechanism!r}, as it is"
            )
            raise SpecError([fault])
        if not all(isinstance(value, float | int) for value in changes.values()):
            data = with_tables(data, Path())
        return made(type(self), data, like=(before, self))

    def unused_faults(self) -> Iterator[Fault]:
        """Keys that are set and of no use to this machine."""
        fields = {each.alias or name: name for name, each in type(self).model_fields.items()}
        for table, key, right in self.no_use:
            record = getattr(self, fields[table])
            value = getattr(record, key, None)
            if value is not None and value != type(record).model_fields[key].default:
                yield Fault((table, key), shown(value), right)

    @abstractmethod
    def _unloaded(self) -> Machine:
        """The model that this is, as wanted and with exact parts; theta as above."""

    @cached_property
    def model(self) -> Machine:
        """Its bodies, joints, drive, outputs, and the loads that the spec applies; made once."""
        machine = self._unloaded()
        if self.load is None or not self.load.on:
            return machine
        return replace(machine, loads=(*machine.loads, *efforts(self.load.on, machine)))

    @cached_property
    def _whole(self) -> Machine:
        """The model with those of the machines that it includes."""
        return self.model

    @checked
    def solve(self, theta: ArrayLike, order: int = 2) -> Run:
        """The machine at theta, (n,) rad, with derivatives up to the order, 0..2: outputs, rates, poses, forces, play.

        Its forces are those of the report, for which its solids are made: see `_weighed_machine`.
        SpecError for angles that are no finite numbers.
        """
        if order not in (0, 1, 2):
            raise SpecError([Fault(("order",), str(order), "0, 1 or 2")], "machine.solve")
        return solve(self._whole, _finite(theta, "machine.solve"), order, self._weighed_machine)

    def weighed(self, model: Machine) -> Masses:
        """A model of it with the masses of its solids and with gravity where [load] has it, as its loads are judged."""
        return with_masses(model, self.assembly.solids, self.load)

    def _weighed_machine(self) -> Machine:
        """The model with all that it bears: loads, springs and gravity of the spec, masses of its solids, friction in its joints.

        DesignError where a linkage's solids cannot be made.
        """
        machine = self.weighed(self.model).machine
        return with_friction(machine, self.assembly.journals, self.load, self.material.name)

    @property
    def _pulled(self) -> Machine:
        """The model as it is, or where [load] has gravity with it and with the masses of the solids."""
        return with_gravity(self.model, self.load, lambda: self.assembly.solids)

    @abstractmethod
    def motion(self, theta: Floats, order: int = 0) -> Floats:
        """Wanted output and its derivatives to theta, (n,); rad or mm."""

    @cached_property
    @abstractmethod
    def assembly(self) -> Assembly:
        """What is made of it, as data; DesignError where it cannot be."""

    def _assembly(
        self, parts: Sequence[Part], mounts: Sequence[Mount], features: Sequence[Feature] = ()
    ) -> Assembly:
        """These parts as a machine: pins as bearings, tips that are not made in the way of others."""
        cams = any(isinstance(each, CamOutline) for each in features)
        turning = "cam angle" if cams else "crank angle"
        return Assembly(
            self.model,
            parts,
            self._process,
            Cycle(sense=self._sense, name=turning),
            mounts,
            features,
            stand_ins=tips(features, parts, mounts, self.model),
            journals=journals(self.model, features, parts, mounts, self.material.name),
            material_limits=self._material_limits,
            unjudged=Later(self._unjudged),
        )

    def _unjudged(self) -> Sequence[NotJudged]:
        """What cannot be judged of its cams: nothing presses them, or no limit is known."""
        return ()

    @property
    def _material_limits(self) -> MaterialLimits:
        """What the spec says of its materials, and the keys with the sizes of its pins."""
        allowed = getattr(self, "allowed", None)
        given = allowed if isinstance(allowed, LimitsTable) else LimitsTable()
        return given.of_parts(getattr(self, "making", None))

    @property
    def _process(self) -> Process:
        """The play on a side less what a coarse print leaves and facets take is what bodies keep that move past each other."""
        press = self.print.press_clearance
        slide = self.print.slide_clearance
        running = self.print.running_clearance
        tolerance = self.accuracy.chord_tolerance
        return Process(
            tolerance,
            max(0.0, 0.8 * slide / 2 - 2 * tolerance),
            Fixing(
                (press + running) / 2 if press < running else -math.inf,
                metal=materials.of(self.material.name).metal,
            ),
            self.material.name,
            printed_density(self.material),
            None if self.laser is None else self.laser.thickness,
        )

    @checked
    def scene(self, theta: float) -> Scene:
        """All bodies where they stand at theta, rad, the angle that `solve` takes: a scene of trimesh, mm, z up.

        Nodes are the bodies and on them the copies of parts, "rocker-1"; its geometry are the parts by name, each in its own
        frame, as designed, within the spec's chord tolerance. `scene.to_mesh()` is one mesh of all, `scene.show()` draws it.
        DesignError where the machine does not close at theta, or a part's solid cannot be made; SpecError for an angle that is
        no finite number.
        """
        from camgen.parts.posed_scene import posed_scene

        (angle,) = _finite(theta, "machine.scene")
        return posed_scene(self.assembly, self._solids, float(angle))

    @cached_property
    def _solids(self) -> Mapping[str, Mesh]:
        """Solids of its parts, each in its own frame, by name."""
        from camgen.parts.solids import solid

        tolerance = self.accuracy.chord_tolerance
        return {part.name: solid(part, tolerance) for part in self.assembly.parts}

    @abstractmethod
    def limits(self) -> Sequence[Finding]:
        """Closed-form design checks; raises DesignError where no such mechanism exists."""

    def limits_of(self, code: str) -> Sequence[Finding]:
        """Design checks of one code."""
        return [finding for finding in self.limits() if finding.code == code]

    def forecast(self) -> Sequence[Finding]:
        """Design checks, and what else is known of the files before they are made; DesignError where they cannot be."""
        return [*self.limits(), *self.free_play()]

    def free_play(self) -> Sequence[Finding]:
        """LASH by the clearance of its pins; of no other play."""
        if not pins_alone(self.model):
            return ()
        theta = np.linspace(*self.assembly.cycle.range, ANGLES)
        run = solve(self.model, theta, 1)  # with the gaps of the joints as they are made
        return of_pins(run, self.assembly.demands)

    @abstractmethod
    def study(self) -> Study:
        """Named numbers, curves and tables for the report."""

    @classmethod
    def prepare(cls, many: Sequence[Self]) -> None:
        """Find together, where that is quicker, what each of many variants needs for its limits and figures."""

    @property
    def _speed(self) -> float:
        """Speed of the input shaft, rad/s, below 0 where it turns clockwise; nan where the spec gives none."""
        motor = getattr(self, "motor", None)
        return math.nan if motor is None else float(motor.speed_rpm) * math.tau / 60

    @property
    def _sense(self) -> int:
        """Sense in which theta runs: -1 where the input shaft turns clockwise."""
        return -1 if self._speed < 0 else 1

    def _found(self) -> Mapping[str, object]:
        """What the spec leaves open and camgen works out, by dotted keys; DesignError where nothing fits."""
        return {
            "material.density": self.material.density or materials.of(self.material.name).density
        }

    def resolved(self) -> Self:
        """A spec that makes the same files, with everything filled in that camgen works out."""
        data = self.model_dump(by_alias=True, exclude_none=True)
        return validate(type(self), self._settled(data))

    def settled_tables(self) -> Data:
        """The spec's tables as they were read, with what camgen works out filled in; DesignError where nothing fits.

        What follows from other keys, such as a dwell that takes the rest of the turn, stays open.
        """
        return self._settled(self.source_tables)

    def _settled(self, tables: Data) -> Data:
        """Tables of this spec with what camgen works out."""
        return reduce(lambda data, item: assigned(data, *item), self._found().items(), tables)

    def remarks(self) -> Remarks:
        """What is to be said of it beside its findings."""
        return Remarks()

    def recovered(self, theta: Floats, motion: Mapping[str, Floats]) -> Study:
        """What follows from the motion recovered from each kind of file, (n,) over a whole turn, both ends included."""
        return Study()


def _said(machine: Machine) -> list[str]:
    """Links, joints, drives and outputs of a machine, a line each; nothing of what has none."""
    links = [body.name for body in machine.bodies if body.name != GROUND]
    joints = Counter(type(joint).__name__.lower() for joint in machine.joints)
    counts = [f"{count} {kind}{'s' * (count > 1)}" for kind, count in joints.items()]
    drives = [drive.body for drive in machine.drives]
    if len(drives) == 1 and machine.drives[0].slide is None:
        drives.append(f"{machine.speed * 60 / math.tau:.4g} rpm")
    outputs = [f"{output.name} ({unit_of(output)[0]})" for output in machine.outputs]
    rows = {"links": links, "joints": counts, "driven": drives, "outputs": outputs}
    return [f"{name}: {', '.join(words)}" for name, words in rows.items() if words]


M = TypeVar("M", bound=Mechanism)


def _finite(theta: ArrayLike, function: str) -> Floats:
    """Angles that a person gives, (n,) rad; SpecError where one is no finite number."""
    try:
        angles = np.ravel(np.asarray(theta, float))
    except (TypeError, ValueError):
        raise SpecError([Fault(("theta",), shown(theta), "angles in rad")], function) from None
    wrong = angles[~np.isfinite(angles)]
    if wrong.size:
        raise SpecError([Fault(("theta",), str(wrong[0]), "finite angles in rad")], function)
    return angles


def made(
    kind: type[M],
    data: Data,
    source: str = "spec",
    hints: tuple[str, ...] = (),
    like: tuple[Data, Spec] | None = None,
) -> M:
    """The mechanism of some tables, as `validate` makes it, with faults of its loads; it keeps the tables."""
    mechanism = validate(kind, data, source, hints, like)
    vars(mechanism)["source_tables"] = data
    if mechanism.load is not None and mechanism.load.on:
        # faults of loads on what is not there; a design that does not exist is refused later
        with suppress(DesignError):
            mechanism.model  # noqa: B018
    return mechanism


def refuse_failing(mechanism: Mechanism) -> None:
    """Raise DesignError with the first limit that fails."""
    failed = next((finding for finding in mechanism.limits() if not finding.ok), None)
    if failed is not None:
        raise DesignError(
            failed.code,
            failed.measured,
            failed.limit,
            failed.unit,
            str(failed.where),
            failed.message,
        )
