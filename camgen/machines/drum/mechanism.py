"""A drum of an automaton or a music box: disc cams at several heights, each with its own follower, and rows of pins, as one part.

     |  |   |          The drum turns counter-clockwise about O and z, seen from above; files show it at cam angle 0. Followers
    _|__|_  |          stand to its tracks as those of a disc cam: one that slides along Oy, one that swings has its pivot at
   |______|=|=  teeth  (pivot_distance, 0). Teeth point at the axis. A track is a disc cam by itself: its tables, its outline and
   |__|__|             its judge are those.

What stands beside the drum (followers, springs, comb, shaft and bearings) is the person's own.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from functools import cached_property, partial
from itertools import pairwise
from typing import Annotated, Any, ClassVar

import numpy as np
from pydantic import Field

from camgen.errors import DesignError, Fault, SpecError
from camgen.findings import Finding, NotJudged, Where, at_least
from camgen.geometry.outlines import Region, circle
from camgen.machine.features import CamOutline, Eye, Mount, PinRow
from camgen.machine.joining import Module, Ride
from camgen.machine.model import GROUND, Body, Drive, Joint, Machine, Output, Pin, Place, Pose
from camgen.machines.disc_cam.mechanism import DiscCamDrive
from camgen.machines.drum.rows import Pins
from camgen.machines.drum.tables import (
    DrumBody,
    DrumBore,
    DrumMotor,
    PinTable,
    RowTable,
    ToothTable,
    TrackLimits,
    TrackTable,
)
from camgen.machines.included import placed
from camgen.machines.loads.tables import thin_walls
from camgen.machines.mechanism import Mechanism
from camgen.machines.metal import seat_of
from camgen.numerics import Floats
from camgen.parts import materials
from camgen.parts.assembly import Assembly
from camgen.parts.catalogue import Bought
from camgen.parts.disc_cams import turning_note
from camgen.parts.part import Layer, Part
from camgen.parts.shafts import shaft_and_bearings
from camgen.spec import validate
from camgen.study import Figure, Figures, Later, Study, Table, together
from camgen.vocabulary import OldWords

_DRUM = "drum"
_OFF = 0.05  # mm along the turn, by which a print may put a pin off: its time is told
_NO_TABLE = "no value here: a drum has no outline to cut; make a disc-cam with the track's segments"
_RIGID = "no value here: the followers of a drum count as rigid, and no force presses them on it"
_OVER = 2.0  # chord tolerances, by which a pin reaches over its tooth: facets of its end take one
_FARTHER = (
    "pins that stand farther apart, a shorter tooth.return_ms or a lower motor.speed_rpm widen it"
)


class CamDrum(Mechanism):
    """Spec and answers of a drum; the outputs are the displacements of its tracks' followers, mm or rad."""

    old_words: ClassVar[OldWords] = {
        **Mechanism.old_words,
        ("motor", "shaft_diameter"): ("parts", "bore"),
    }
    no_use = (
        ("files", "profile_step_deg", _NO_TABLE),
        ("files", "cutter_radius", _NO_TABLE),
        ("load", "stiffness", _RIGID),
        ("load", "damping_ratio", _RIGID),
        ("load", "restitution", _RIGID),
        ("load", "spring_error", _RIGID),
        ("load", "cam_follower", _RIGID),
    )

    geometry: DrumBody
    track: Annotated[tuple[TrackTable, ...], Field(min_length=1, max_length=40)] = Field(
        description="disc cams on the drum"
    )
    tooth: ToothTable | None = Field(default=None, description="the teeth that the pins bend")
    pin: PinTable | None = Field(default=None, description="the pins of all rows")
    row: Annotated[tuple[RowTable, ...], Field(max_length=200)] = Field(
        default=(), description="rows of pins on the drum"
    )
    motor: DrumMotor = DrumMotor.model_construct()
    making: Annotated[DrumBore, Field(alias="parts")] = DrumBore.model_construct()
    allowed: Annotated[TrackLimits, Field(alias="limits")] = TrackLimits.model_construct()

    # ---- what is wrong with it --------------------------------------------------------------------------------------

    def faults(self) -> Sequence[Fault]:
        """What is wrong between keys that are right one by one."""
        found = [*self.making.misfits(), *self._place_faults(), *self._pin_faults()]
        found += self.unused_faults()
        found += thin_walls(self.allowed.min_wall, self.print.nozzle)
        for k, track in enumerate(self.track):
            try:
                self._disc(track)
            except SpecError as error:
                found += [replace(each, path=_on_track(k, each.path)) for each in error.faults]
        return found

    def _place_faults(self) -> Iterator[Fault]:
        """Names that are given twice, tracks and rows that lie in each other's way."""
        names = set[str]()
        for _, _, name, path in self._levels:
            if name.lower() in names:
                yield Fault((*path, "name"), repr(name), "a name of its own for each")
            names.add(name.lower())
        wall = self.allowed.min_wall
        for (_, top, below, _), (low, _, name, path) in pairwise(self._levels):
            if low < top + wall and low != top:
                right = f"{top:g}, where {below} ends, or at least {top + wall:g}: limits.min_wall above"
                yield Fault((*path, "height"), f"{low:g} of {name}", right)
        top = self._levels[-1][1]
        if self.geometry.length is not None and self.geometry.length < top:
            right = f"at least {top:g}, where {self._levels[-1][2]} ends"
            yield Fault(("geometry", "length"), f"{self.geometry.length:g}", right)

    @property
    def _levels(self) -> list[tuple[float, float, str, tuple[str | int, ...]]]:
        """Tracks and rows from the bottom: lower and upper face, name, path of the table."""
        pin = 0.0 if self.pin is None else self.pin.thickness
        tracks = [
            (t.height, t.height + t.thickness, t.name, ("track", k))
            for k, t in enumerate(self.track)
        ]
        rows = [(r.height, r.height + pin, r.name, ("row", k)) for k, r in enumerate(self.row)]
        return sorted([*tracks, *rows])

    def _pin_faults(self) -> Iterator[Fault]:
        """Pins and teeth that are missing or do not reach each other, angles that do not grow."""
        for key in ("tooth", "pin"):
            if self.row and getattr(self, key) is None:
                yield Fault((key,), "", "missing: the pins of [[row]] need it")
            if not self.row and getattr(self, key) is not None:
                yield Fault((key,), "", "no table here without a [[row]] of pins")
        if self.pin is None or self.tooth is None:
            return
        core = self.geometry.core_radius
        if self.pin.radius <= core:
            right = f"more than the core, {core:g} mm"
            yield Fault(("pin", "radius"), f"{self.pin.radius:g}", right)
        elif not core < self.tooth.radius < self.pin.radius:
            right = (
                f"between the core, {core:g} mm, and the ends of the pins, {self.pin.radius:g} mm"
            )
            yield Fault(("tooth", "radius"), f"{self.tooth.radius:g}", right)
        elif self.pin.radius - self.tooth.radius < _OVER * self.accuracy.chord_tolerance:
            least = self.tooth.radius + _OVER * self.accuracy.chord_tolerance
            right = f"at least {least:g}: {_OVER:g} accuracy.chord_tolerance beyond the tooth's tip"
            yield Fault(("pin", "radius"), f"{self.pin.radius:g}", right)
        elif self.pin.width >= core:
            yield Fault(("pin", "width"), f"{self.pin.width:g}", f"less than the core, {core:g} mm")
        else:
            least = math.degrees(self._pins.spread)
            for k, row in enumerate(self.row):
                for i, (before, after) in enumerate(_round(row.release_deg)):
                    if after - before <= least:
                        i = (i + 1) % len(row.release_deg)
                        right = f"more than {before + least:.4g}: its own width behind the pin before it"
                        yield Fault(("row", k, "release_deg", i), f"{after:g}", right)

    # ---- the tracks -------------------------------------------------------------------------------------------------

    def _disc(self, track: TrackTable) -> DiscCamDrive:
        """A track as a disc cam by itself, which may be as small as the core."""
        geometry: dict[str, Any] = {"follower": track.follower.model_dump(exclude_none=True)}
        if track.base_radius is not None:
            geometry["base_radius"] = track.base_radius
        limits = self.allowed.model_dump(exclude_none=True)
        tables = {
            "mechanism": "disc-cam",
            "name": self.name,
            "geometry": geometry,
            "segment": track.segment,
            "motor": {"speed_rpm": self.motor.speed_rpm},
            "parts": {
                **self.making.model_dump(),
                "thickness": track.thickness,
                "hub_diameter": 2 * max(self.geometry.core_radius, self.making.reach + 1),
                "hub_height": 1.0,
            },
            "limits": limits,
            "print": self.print,
            "accuracy": self.accuracy,
            "material": self.material,
        }
        return validate(DiscCamDrive, tables)

    @cached_property
    def discs(self) -> Mapping[str, DiscCamDrive]:
        """The tracks as disc cams, by name."""
        return {track.name: self._disc(track) for track in self.track}

    def motion(self, theta: Floats, order: int = 0) -> Floats:
        """Wanted displacement of the first track's follower (mm or rad) or its derivative to theta, (n,)."""
        return self.discs[self.track[0].name].motion(theta, order)

    @staticmethod
    def _module(name: str) -> Module:
        """How a track's machine stands in that of the drum, which turns in place of its cam."""
        return Module(name, rides=(Ride("cam", _DRUM, 0j, 0.0),))

    def _unloaded(self) -> Machine:
        """The drum, and each follower by its track's name, as "wing_follower" with the output "wing_lift" or "wing_swing"."""
        bodies = [Body(GROUND), Body(_DRUM)]
        joints: list[Joint] = [Pin("shaft", Place(_DRUM), Place(GROUND))]
        start = {_DRUM: Pose(0j, 0.0)}
        outputs: list[Output] = []
        for name, disc in self.discs.items():
            module = self._module(name)
            own = disc.model
            follower = own.body("follower")
            bodies.append(replace(follower, name=module.name("follower")))
            joints += [module.renamed(each) for each in own.joints if each.name != "shaft"]
            start[module.name("follower")] = own.start["follower"]
            outputs += [module.renamed(each) for each in own.outputs]
        drives = (Drive("motor", _DRUM),)
        return Machine(tuple(bodies), tuple(joints), drives, start, (), tuple(outputs), self._speed)

    # ---- the part ---------------------------------------------------------------------------------------------------

    @cached_property
    def _pins(self) -> Pins:
        """Of all rows."""
        assert self.pin is not None and self.tooth is not None, "a drum with rows"
        return Pins(
            self.geometry.core_radius,
            self.pin.radius,
            self.pin.width,
            self.tooth.radius,
            math.radians(self.tooth.at_deg),
            self._sense,
        )

    @property
    def length(self) -> float:
        """Of the drum, mm."""
        return self._levels[-1][1] if self.geometry.length is None else self.geometry.length

    @cached_property
    def _layers(self) -> Mapping[str, tuple[int, Layer]]:
        """Tracks, rows and the core between them, from the bottom: number and layer by name; DesignError where the core hides a
        track."""
        core = circle(0j, self.geometry.core_radius)
        hole = self.making.hole()
        outlines = {
            row.name: self._pins.outline(np.radians(row.release_deg).tolist()) for row in self.row
        }
        for name, disc in self.discs.items():
            cam = disc.cam
            if cam.nearest <= self.geometry.core_radius:
                remedy = "the core stands out of the track: a smaller geometry.core_radius, or a larger base_radius"
                raise DesignError(
                    "geometry.core_radius",
                    self.geometry.core_radius,
                    cam.nearest,
                    "mm",
                    f"track {name}",
                    remedy,
                )
            outlines[name] = cam.outline
        levels = []
        top = 0.0
        for low, high, name, _ in self._levels:
            levels += [("", top, low)] if low > top else []
            levels.append((name, low, high))
            top = high
        levels += [("", top, self.length)] if self.length > top else []
        return {
            name or f"core {k}": (k, Layer(Region(outlines.get(name, core), (hole,)), low, high))
            for k, (name, low, high) in enumerate(levels)
        }

    @cached_property
    def assembly(self) -> Assembly:
        """The drum."""
        layers = [layer for _, layer in self._layers.values()]
        tracks = [self._layers[name][0] for name in self.discs]
        widest = max(tracks, key=lambda k: layers[k].region.area)
        part = Part(
            _DRUM,
            "Drum",
            tuple(layers),
            centres=(0j,),
            notes=(turning_note(self._sense), *self._places(), *self.making.notes()),
            bore=self.making.bore,
            min_wall=self.allowed.min_wall,
            drawn_layer=widest,
            stacked=True,
        )
        made = self._assembly([part], [Mount(_DRUM, _DRUM)], self._outlines())
        return replace(made, rows=self._rows(), bought=self._bought(), texts=self._texts())

    def _places(self) -> Iterator[str]:
        """What the drawing says of tracks and rows."""
        for low, high, name, path in self._levels:
            yield f"{path[0]} {name}: z {low:g} to {high:g}"

    def _number(self, name: str) -> tuple[int, int]:
        """Of a track's or a row's layer, and of how many."""
        return self._layers[name][0], len(self._layers)

    def _outlines(self) -> list[CamOutline]:
        """What is measured of each track."""
        found = []
        for name, disc in self.discs.items():
            (own,) = (each for each in disc.assembly.features if isinstance(each, CamOutline))
            bore = None if own.bore is None else replace(own.bore, part=_DRUM)
            named = self._module(name).renamed(own)
            found.append(
                replace(
                    named,
                    part=_DRUM,
                    turns="shaft",
                    bore=bore,
                    layer=self._number(name),
                    track=name,
                )
            )
        return found

    def _rows(self) -> list[PinRow]:
        """What is measured of each row."""
        rate = abs(self._speed)
        return [
            PinRow(
                row.name,
                _DRUM,
                self._number(row.name),
                self._pins.tip * complex(np.exp(1j * self._pins.at)),
                self._sense,
                tuple(np.radians(row.release_deg).tolist()),
                partial(self._pins.bend_at, np.radians(row.release_deg).tolist()),
                Eye(_DRUM, 0j, self.making.bore),
                self._pins.shift,
                rate,
                self._back,
            )
            for row in self.row
        ]

    @property
    def _back(self) -> float:
        """By how much the drum turns until a tooth is at rest again, rad."""
        return 0.0 if self.tooth is None else abs(self._speed) * self.tooth.return_ms * 1e-3

    def _bought(self) -> list[Bought]:
        """What turns; followers and comb are the person's own."""
        seat = seat_of(self.making, self.material.name, [self.length], self.drawing.key_fit)
        return shaft_and_bearings(seat)

    # ---- checks and figures -----------------------------------------------------------------------------------------

    def limits(self) -> Sequence[Finding]:
        """Those of each track as a disc cam, MIN_WALL of the core, and PIN_SPACING of the rows."""
        self._layers  # noqa: B018  refuses a core that hides a track
        least = self.allowed.min_wall
        wall = self.geometry.core_radius - self.making.reach
        remedy = "a larger geometry.core_radius or a smaller bore makes it thicker"
        return [
            *(
                replace(each, where=replace(each.where, module=name))
                for name, disc in self.discs.items()
                for each in disc.limits()
            ),
            at_least("MIN_WALL", wall, least, "mm", Where("between bore and core"), remedy),
            *self._spacings(),
        ]

    def _unjudged(self) -> Sequence[NotJudged]:
        """Of a material that is not printed, whose strength wants to be judged."""
        if materials.of(self.material.name).printed:
            return ()
        why = "the spec does not say which force presses the followers on the drum"
        needs = "a disc-cam of the track's segments, with [load] and [spring]"
        return [NotJudged(code, why, needs) for code in ("LIFT_OFF", "HERTZ")]

    def _spacings(self) -> Iterator[Finding]:
        """PIN_SPACING of each row as designed."""
        for row in self.row:
            gaps = [after - before for before, after in _round(row.release_deg)]
            k, apart = min(enumerate(gaps), key=lambda each: each[1])
            free = apart - math.degrees(self._pins.hold)
            where = Where(f"row {row.name}, after pin {k + 1}")
            yield at_least("PIN_SPACING", free, math.degrees(self._back), "deg", where, _FARTHER)

    def _found(self) -> Mapping[str, object]:
        """Base radii of the tracks, and the length."""
        bases = {
            f"track.{k}.base_radius": self.discs[track.name].base_radius
            for k, track in enumerate(self.track)
        }
        return {**super()._found(), **bases, "geometry.length": self.length}

    def study(self) -> Study:
        """Figures and curves of each track, the chart of the pins."""
        tracks = [placed(disc, self._module(name)) for name, disc in self.discs.items()]
        return together(
            [Study(self._figures(), (), Later(self._charts), (), self._notes()), *tracks]
        )

    def _figures(self) -> Figures:
        figures = [Figure("length", self.length, "mm")]
        if self.row:
            pins = self._pins
            figures += [
                Figure("pin count", sum(len(row.release_deg) for row in self.row), ""),
                Figure("bend of a tooth", pins.bend, "mm"),
                Figure("pin hold", math.degrees(pins.hold), "deg"),
                Figure("release shift", _OFF / pins.end / abs(self._speed), "s"),
            ]
        return Figures(figures)

    def _chart(self) -> Iterator[tuple[str, int, float, float, float, float]]:
        """Row, number, height of its middle, release, place on the drum, time of each pin: mm, deg, deg, s."""
        thickness = 0.0 if self.pin is None else self.pin.thickness
        for row in self.row:
            for k, angle in enumerate(row.release_deg):
                place = math.degrees(self._pins.direction(math.radians(angle))) % 360
                seconds = math.radians(angle) / abs(self._speed)
                yield row.name, k + 1, row.height + thickness / 2, angle, place, seconds

    _COLUMNS = ("row", "pin", "height, mm", "lets go, deg", "stands at, deg", "lets go, s")

    def _charts(self) -> list[Table]:
        return [Table("Pins", self._COLUMNS, list(self._chart()))] if self.row else []

    def _texts(self) -> dict[str, str]:
        """The chart of the pins as a file."""
        if not self.row:
            return {}
        lines = ["row,pin,height_mm,release_deg,place_deg,release_s"]
        for name, pin, *numbers in self._chart():
            lines.append(",".join([name, str(pin), *(f"{each:.6f}" for each in numbers)]))
        return {"pins.csv": "\n".join(lines) + "\n"}

    def _notes(self) -> list[str]:
        notes = [
            "camgen makes the drum only. You make its shaft, the followers and what presses them on their tracks: no force is judged."
        ]
        if self.row:
            notes.append(
                "A pin bends its tooth aside and lets it go at its far corner. How a tooth swings after that, rubs or sounds is not "
                "judged; it counts as stiff along the radius, its tip as a sharp edge."
            )
        return notes


def _round(angles: Sequence[float]) -> list[tuple[float, float]]:
    """Each angle of a turn with the next one, the last with the first of the next turn, deg."""
    return list(pairwise([*angles, angles[0] + 360]))


def _on_track(k: int, path: tuple[str | int, ...]) -> tuple[str | int, ...]:
    """Where a key of a disc cam stands in the table of a track."""
    if path[:1] == ("geometry",):
        path = path[1:]
    return ("track", k, *path) if path[:1] not in (("parts",), ("limits",), ("print",)) else path
