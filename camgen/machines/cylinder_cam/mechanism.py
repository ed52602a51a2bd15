"""Any cylinder cam: a drum turns steadily, and a roller in its track moves a follower through segments of motion.

      |            z, the drum's axis, upwards; the drum turns counter-clockwise as seen from above. At cam angle 0 the follower
   ___|___         stands at +x of the drum's files. A translating one slides along z, its output is in mm; an oscillating one
  |___|___|--o     has its axle square to z, beside the drum at +y, its output is the arm's angle, growing upwards.
  |   |   |        At s = 0 the roller is where geometry.follower says.

track "groove": one roller between two walls; "rib": two rollers on one slide, astride; "end": the roller on the upper end, on which a
spring holds it. What stands beside the drum (slide or arm, roller, shaft and bearings) is the person's own, or with parts.make =
"printed" made as well: `bench`.
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from functools import cached_property
from typing import Annotated, Any, ClassVar

import numpy as np
from pydantic import Field

from camgen.errors import DesignError, Fault, SpecError
from camgen.findings import Finding, NotJudged, Where, at_least, at_most
from camgen.machine.cams.bounce import Bounce
from camgen.machine.cams.followers import SlidingTip, SwingingArm
from camgen.machine.cams.limits import ARM_PRESSURE, SLIDE_PRESSURE, program_findings
from camgen.machine.cams.machine import FollowerLoad, Loaded, contact_machine, kick_of, loaded_by
from camgen.machine.features import Demand, Mount
from camgen.machine.model import MM, Cam, Machine
from camgen.machine.strength import line_contact
from camgen.machines.cam_loads import (
    corrected,
    force_study,
    kept_on,
    line_hertz,
    load_faults,
    load_of,
    polydyne_faults,
)
from camgen.machines.cylinder_cam.bearings import Roller, pressed
from camgen.machines.cylinder_cam.bench import (
    PIN_SHARE,
    Bench,
    Fits,
    roller_pin,
    shaft_bearing,
)
from camgen.machines.cylinder_cam.bench_steps import BenchSteps
from camgen.machines.cylinder_cam.pieces import DRUM, Pieces, ring_mount
from camgen.machines.cylinder_cam.tables import DrumGeometry, DrumLimits, DrumParts
from camgen.machines.cylinder_cam.track import Track, smallest
from camgen.machines.disc_cam.curves import motion_plots, peak_figures, segments_table
from camgen.machines.disc_cam.faults import bought_faults
from camgen.machines.disc_cam.tables import DiscCamMotor, LoadTable, SpringTable
from camgen.machines.loads.bearing import BallLoad, LoadCheck, bearing_life
from camgen.machines.loads.lift_off import bounce_figures, bounce_of
from camgen.machines.loads.tables import thin_walls
from camgen.machines.loads.weights import gravity
from camgen.machines.mechanism import Mechanism, Remarks
from camgen.machines.metal import HEAD_CLEARANCE, bore_notes, of_drum, ring_notes, seat_of
from camgen.machines.pairs import still_faults
from camgen.motion.program import Program
from camgen.motion.segments import SegmentTable, WholeTurn, program
from camgen.numerics import Floats
from camgen.parts import materials
from camgen.parts.assembly import Assembly
from camgen.parts.catalogue import (
    BEARINGS,
    CAM_FOLLOWERS,
    DOWELS,
    Bought,
    CamFollower,
    ball_roller,
    no_ball_roller,
)
from camgen.parts.disc_cams import turning_note
from camgen.parts.part import Part, drum_part
from camgen.parts.shafts import shaft_and_bearings
from camgen.spec import validate
from camgen.study import Figure, Figures, Later, Plot, Sketch, Study, Upright
from camgen.vocabulary import OldWords

_FOLLOWER = "follower"
_LEAST_PRESS = 2.0  # N, of the springs of a machine: its carriage rubs
_OVER = 1.5  # of what keeps contact
_SMOOTHER = "a law that ends smoother, or 'matched', joins them"
_WEIGHTLESS = (
    "The drum's axis lies level, so the follower's weight needs no torque. If the drum stands upright, set "
    "load.gravity_deg = -90 to count the weight."
)
_ARM_S_WEIGHT = "The arm's weight is not judged: its inertia does not say where the weight acts."
_FLATTER = "a larger geometry.radius, a longer span or a smaller lift lowers it"


class CylinderCam(Mechanism):
    """Spec and answers of a cylinder cam; the output is the follower's displacement s, mm or rad."""

    old_words: ClassVar[OldWords] = {
        **Mechanism.old_words,
        ("motor", "shaft_diameter"): ("parts", "bore"),
    }
    hardened = True

    geometry: DrumGeometry
    segment: Annotated[tuple[SegmentTable, ...], Field(min_length=1, max_length=100), WholeTurn] = (
        Field(description="segments of the motion: one after another they make the turn")
    )
    motor: DiscCamMotor = DiscCamMotor.model_construct()
    load: LoadTable | None = Field(
        default=None,
        description="mass and loads of the follower, for forces, motor torque, and whether it stays on "
        "an end cam",
    )
    spring: SpringTable | None = Field(
        default=None,
        description='track "end": the spring that presses the follower on the cam; the report says how strong it must be; a printed '
        "machine with a slide has two springs on its rods, which share rate and preload, and one with an arm has a spring that "
        "pulls the arm; 0: as strong as needed",
    )
    making: Annotated[DrumParts, Field(alias="parts")] = DrumParts.model_construct()
    allowed: Annotated[DrumLimits, Field(alias="limits")] = DrumLimits.model_construct()

    # ---- what is wrong with it --------------------------------------------------------------------------------------

    @classmethod
    def filled(cls, data: Any) -> Any:
        """The tables with what one of them decides in another."""
        return super().filled(of_drum(data))

    def faults(self) -> Sequence[Fault]:
        """What is wrong between keys that are right one by one."""
        g = self.geometry
        found = [*self._follower_faults(), *self.making.misfits()]
        if (g.track == "rib") != (g.distance is not None):
            right = "missing" if g.track == "rib" else "no value here"
            value = "" if g.distance is None else f"{g.distance:g}"
            fault = Fault(
                ("geometry", "distance"),
                value,
                f"{right}: only a rib has two rollers, and this is the distance of their axes",
            )
            found.append(fault)
        slope = abs(math.tan(math.radians(g.roller.cone_deg)))
        if g.roller.radius <= slope * g.roller.length / 2:
            right = "an angle at which the roller does not end in a point"
            found.append(Fault(("geometry", "roller", "cone_deg"), f"{g.roller.cone_deg:g}", right))
        elif g.track == "groove" and g.roller.cone_deg < 0:
            right = "0 or more: a roller that is wider inside cannot be put into a groove"
            found.append(Fault(("geometry", "roller", "cone_deg"), f"{g.roller.cone_deg:g}", right))
        found += thin_walls(self.allowed.min_wall, self.print.nozzle)
        for key in ("hole_compensation", "profile_compensation", "shrinkage", "elephant_foot"):
            value = getattr(self.print, key)
            if value:
                right = "0: a drum's walls lean to the bed, so its files are as drawn; let the slicer compensate"
                found.append(Fault(("print", key), f"{value:g}", right))
        found += self._bought_faults()
        found += self._cutter_faults()
        found += self._pieces_faults() if self.making.pieces == 2 else []
        found += self._bench_faults() if self.making.make == "printed" else []
        try:
            self._given  # noqa: B018
        except SpecError as error:
            found += error.faults
        found += load_faults(
            self.load,
            self.spring,
            not self.geometry.follower.swings,
            g.track == "end",
            False,
            'track "end"',
        )
        if not found and self.load is not None and self.load.polydyne:
            found += polydyne_faults(self.load, self.spring, self._given, self._sprung)
        return [*found, *still_faults(("segment",), [table.kind for table in self.segment])]

    def _follower_faults(self) -> list[Fault]:
        """Keys of [geometry.follower] that are missing, or of the other kind."""
        f = self.geometry.follower
        key = ("geometry", "follower")
        found = []
        if self.geometry.follower.swings:
            if f.arm is None:
                right = "missing: an oscillating follower has an arm"
                found.append(Fault((*key, "arm"), "", right))
            if f.offset:
                right = "no value here: an oscillating follower has pivot in its place"
                found.append(Fault((*key, "offset"), f"{f.offset:g}", right))
            if self.geometry.track == "rib":
                right = '"translating": both rollers of a rib are on one slide'
                found.append(Fault((*key, "motion"), repr(f.motion), right))
            return found
        for name in ("arm", "pivot", "start_deg"):
            value = getattr(f, name)
            if value is not None:
                right = "no value here: only an oscillating follower has it"
                found.append(Fault((*key, name), f"{value:g}", right))
        return found

    def _bought_faults(self) -> Iterator[Fault]:
        """What no bought cam follower can be."""
        named = self._cam_follower
        if named is None:
            return
        roller = self.geometry.roller
        key = ("geometry", "roller")
        if self.making.make == "printed":
            right = 'missing: the machine has a roller of its own; or parts.make = "drum"'
            yield Fault(("load", "cam_follower"), repr(named.name), right)
            return
        yield from bought_faults(named.name, roller.radius, (*key, "radius"))
        if roller.cone_deg:
            right = f"0: {named.name} is a cylinder"
            yield Fault((*key, "cone_deg"), f"{roller.cone_deg:g}", right)
        if roller.length > named.width:
            right = f"at most {named.width:g}, the ring of {named.name}"
            yield Fault((*key, "length"), f"{roller.length:g}", right)

    @property
    def _cam_follower(self) -> CamFollower | None:
        """The bought roller that the load names."""
        name = None if self.load is None else self.load.cam_follower
        return None if name is None else CAM_FOLLOWERS[name]

    def _cutter_faults(self) -> list[Fault]:
        """What no cutter does, and no table tells."""
        roller = self.geometry.roller
        cutter = self.files.cutter_radius
        found = []
        if self.files.profile_step_deg is not None:
            right = "no value here: a drum has no outline"
            key = ("files", "profile_step_deg")
            found.append(Fault(key, f"{self.files.profile_step_deg:g}", right))
        if cutter is None:
            return found
        most = roller.radius + (self.geometry.track != "end") * self.print.slide_clearance / 2
        if roller.cone_deg:
            right = "no value here: a conical cutter of the roller's shape cuts this track, along the path of the roller's axis"
            found.append(Fault(("files", "cutter_radius"), f"{cutter:g}", right))
        elif cutter > most:
            right = f"at most {most:g} mm, of the roller and its clearance"
            found.append(Fault(("files", "cutter_radius"), f"{cutter:g}", right))
        return found

    def _pieces_faults(self) -> Iterator[Fault]:
        """What no drum in two pieces can be."""
        if self.geometry.track != "groove":
            right = (
                f'1: a track = "{self.geometry.track}" is printed in one piece without a ceiling'
            )
            yield Fault(("parts", "pieces"), "2", right)
        if self.files.cutter_radius is not None:
            right = "no value here: a drum in two pieces is printed, not cut"
            yield Fault(("files", "cutter_radius"), f"{self.files.cutter_radius:g}", right)
        play = self.print.slide_clearance / 2
        if self._tight:
            right = f"at least {play:g} mm, half of print.slide_clearance: the ring begins outside of the core by that"
            value = f"{self.geometry.roller.end_clearance:g}"
            yield Fault(("geometry", "roller", "end_clearance"), value, right)

    def _bench_faults(self) -> Iterator[Fault]:
        """What no machine can be made of."""
        roller = self.geometry.roller
        bore = self.making.bore
        if shaft_bearing(bore) is None:
            sizes = sorted({bearing.bore for bearing in BEARINGS.values()})
            right = f"{', '.join(f'{each:g}' for each in sizes)} mm: the bores of the shaft's ball bearings"
            yield Fault(("parts", "bore"), f"{bore:g}", right)
        if roller.cone_deg:
            right = "0: the roller of a printed machine is a cylinder"
            yield Fault(("geometry", "roller", "cone_deg"), f"{roller.cone_deg:g}", right)
        if not roller_pin(roller.radius, roller.length):
            least = min(DOWELS) / PIN_SHARE / 2
            right = f"at least {least:g} mm, for a roller on a pin"
            yield Fault(("geometry", "roller", "radius"), f"{roller.radius:g}", right)
        if not materials.of(self.material.name).printed:
            right = '"drum": a machine is made of a plastic that is printed'
            yield Fault(("parts", "make"), '"printed"', right)

    # ---- motion -----------------------------------------------------------------------------------------------------

    @cached_property
    def _given(self) -> Program:
        """The segments, one after the other."""
        return program(self.segment, 1 / self.geometry.follower.unit[1])

    @cached_property
    def program(self) -> Program:
        """The follower's motion over the turn, mm or rad; on a clockwise drum the segments lie the other way round."""
        made = corrected(self._given, self.load, self.spring, self._speed)
        return made if self._sense > 0 else made.backwards()

    def motion(self, theta: Floats, order: int = 0) -> Floats:
        """Wanted displacement s (mm or rad) or its derivative to theta, (n,)."""
        return self.program(theta, order)

    def _unloaded(self) -> Machine:
        """Drum and follower in the follower's plane, in which the drum is its angle alone; output "lift", mm, or "swing", rad."""
        pushed = self.geometry.track == "end"
        contact = Cam(
            "contact", "cam", _FOLLOWER, self.program, closure="force" if pushed else "form"
        )
        radius = self.geometry.roller.radius
        follower: SlidingTip | SwingingArm = SlidingTip(0j, 1j, radius)
        if self.geometry.follower.swings:
            arm = complex(self.geometry.follower.arm or 0.0)
            follower = SwingingArm(-arm, arm, radius, 1)
        return contact_machine(contact, follower, self._speed, self._load)

    # ---- the track --------------------------------------------------------------------------------------------------

    @property
    def _steepest(self) -> float:
        """Pressure angle that is accepted, deg."""
        usual = ARM_PRESSURE if self.geometry.follower.swings else SLIDE_PRESSURE
        return self.allowed.pressure_angle_deg or usual

    @cached_property
    def track(self) -> Track:
        """The track as it is made; DesignError where no drum has it."""
        p = self.making
        clearance = self.print.slide_clearance
        given = self.geometry.radius
        key = (
            p.wall if self._piece_count == 2 else 0.0
        )  # takes as much of the core as of its height
        reach = p.reach + key
        track = Track(self.geometry, self.program, clearance, reach, p.wall, given or 0.0, key)
        if given is None:
            track = replace(track, radius=smallest(track, self._steepest))
        elif track.floor <= reach:
            least = given + reach - track.floor
            remedy = "the bore reaches the track: a larger radius, a shorter roller or a smaller parts.bore"
            raise DesignError(
                "geometry.radius", given, least, "mm", "the floor of the track", remedy
            )
        offset = self.geometry.follower.offset
        if abs(offset) >= track.floor:
            remedy = "the roller passes beside the track's floor: a smaller offset or a larger geometry.radius"
            limit = math.copysign(track.floor, offset)
            raise DesignError(
                "geometry.follower.offset", offset, limit, "mm", "the floor of the track", remedy
            )
        if self.geometry.follower.swings:
            self._refuse_beside(track)
        middle = track.inner + self.geometry.roller.length / 2
        if math.hypot(middle, offset) >= track.radius:
            remedy = "the middle of the roller lies beside the drum: a smaller offset, a larger geometry.radius or a longer roller"
            limit = math.copysign(math.sqrt(track.radius**2 - middle**2), offset)
            raise DesignError(
                "geometry.follower.offset", offset, limit, "mm", "the drum's outside", remedy
            )
        track.drum.span  # noqa: B018  refuses what is no drum
        return track

    def _refuse_beside(self, track: Track) -> None:
        """DesignError where an arm swings its roller past the drum."""
        beside = track.path.beside(-track.theta, 0)
        k = int(np.argmax(np.abs(beside)))
        if abs(beside[k]) < track.floor:
            return
        follower = self.geometry.follower
        free = follower.model_copy(update={"pivot": None})
        nearest = replace(track, geometry=self.geometry.model_copy(update={"follower": free}))
        pivot = "" if follower.pivot is None else f"geometry.follower.pivot = {nearest.pivot:.4g}, "
        at = math.degrees(float(track.theta[k])) % 360
        error = DesignError(
            "distance of the roller's axis beside the drum's",
            float(abs(beside[k])),
            track.floor,
            "mm",
            f"cam angle {at:.4g} deg",
            f"{pivot}a longer arm, a smaller swing or a larger geometry.radius keeps it in the drum",
        )
        raise error.saying(
            f"the arm swings the roller's axis {abs(beside[k]):.4g} mm beside the drum's at cam angle {at:.4g} deg, and the track's "
            f"floor is {track.floor:.4g} mm from it"
        )

    def _found(self) -> Mapping[str, object]:
        """Sizes of the drum, and where the follower stands."""
        track = self.track
        found = {
            "geometry.radius": track.radius,
            "geometry.length": track.length,
            "geometry.follower.height": track.height,
            "limits.pressure_angle_deg": self._steepest,
            "parts.pieces": self._piece_count,
        }
        if self.geometry.follower.swings:
            found["geometry.follower.pivot"] = track.pivot
            found["geometry.follower.start_deg"] = math.degrees(track.start)
        if self._sprung and self.load is not None and self._pressing is not None:
            found["spring.rate"] = self._pressing.rate
            found["spring.preload"] = self._pressing.preload
        return {**super()._found(), **found}

    # ---- springs of the machine -------------------------------------------------------------------------------------

    def _pressing_notes(self) -> Iterator[str]:
        """What presses the follower of a printed machine on its cam, where that is an end cam."""
        if self.geometry.track != "end":
            return
        if self._pressing is not None and self._sprung:
            low, high = self.program.extremes
            most = self._pressing.preload + self._pressing.rate * (high - low)
            needed = ", whatever mass and speed need: with [load]"
            unknown = "" if self.load else f"{needed} they are as strong as that"
            if self.geometry.follower.swings:
                unknown = "" if self.load else f"{needed} it is as strong as that"
                yield (
                    f"An extension spring between the roller's pin and one in the bracket pulls the arm down, with {self._pressing.preload:.4g} "
                    f"N m where it is lowest and {most:.4g} N m where it is highest{unknown}."
                )
                return
            yield (
                f"Two compression springs round the front rods press the carriage down, with {self._pressing.preload:.4g} N where it is "
                f"lowest and {most:.4g} N where it is highest{unknown}. The rods guide them, so that they cannot buckle."
            )

    @property
    def _sprung(self) -> bool:
        """Whether springs are made that press a carriage, or an arm, on an end cam."""
        return self.geometry.track == "end" and self.making.make == "printed"

    @cached_property
    def _pressing(self) -> SpringTable | None:
        """What presses the follower on the cam: as the spec says, and in a machine what it leaves open."""
        if not self._sprung:
            return self.spring
        given = self.spring or SpringTable()
        lever = MM * (self.geometry.follower.arm or 0.0) if self.geometry.follower.swings else 1.0
        preload = given.preload or max(lever * _LEAST_PRESS, _OVER * self._missing(given.rate))
        low, high = self.program.extremes
        if self.geometry.follower.swings and not given.rate:
            hung = self._bench((), (preload, 0.0)).hung
            assert hung is not None, "a spring pulls the arm"
            return SpringTable(rate=hung[0].borne(hung[1])[1], preload=preload)
        return SpringTable(rate=given.rate or preload / (high - low), preload=preload)

    def _missing(self, rate: float) -> float:
        """Preload that a spring of a rate, N/mm, needs so that the follower stays on the cam, N; 0 where none does."""
        if self.load is None:
            return 0.0
        data = self.model_dump(by_alias=True, exclude_none=True)
        data["geometry"]["radius"] = self.track.radius
        data["parts"]["make"] = "drum"
        data["spring"] = {"rate": rate, "preload": 0.0}
        alone = validate(type(self), data)
        assert alone._loaded is not None, "[load] is given"
        needed = alone._loaded.spring_needed(load_of(alone.load, alone.spring) or FollowerLoad())[0]
        return needed if math.isfinite(needed) else 0.0

    @cached_property
    def assembly(self) -> Assembly:
        """The drum."""
        p = self.making
        track = self.track
        pieces = self.pieces
        rings: list[Part] = []
        if pieces is None:
            part = drum_part(DRUM, "Drum of a cylinder cam", track.drum, p.hole())
        else:
            part, ring = pieces.parts(p.hole())
            rings = [replace(ring, min_wall=self.allowed.min_wall)]
        roller = self.geometry.roller
        said = (
            f"roller {2 * roller.radius:g} x {roller.length:g}, its inner end at R{track.inner:.4g}"
        )
        notes = (
            turning_note(self._sense),
            *p.notes(),
            said,
            *ring_notes(p, self.material.name),
        )
        part = replace(part, notes=notes, bore=p.bore, min_wall=self.allowed.min_wall)
        mounts = [Mount(DRUM, "cam"), *(ring_mount(each, track.length) for each in rings)]
        made = self._assembly([part, *rings], mounts)
        if pieces is not None:
            made = replace(made, work=Later(lambda: [pieces.steps()]))
        if p.make == "printed":
            bench = self._bench([part, *rings], self._springs)
            made = self._assembly(bench.parts, bench.mounts)
            fixing = replace(made.process.fixing, rings=frozenset({"bearing"}))
            made = replace(
                made,
                process=replace(made.process, fixing=fixing),
                planes={_FOLLOWER: bench.plane},
                touching=bench.touching,
                work=Later(lambda: [BenchSteps(bench).table()]),
                bought=bench.screws(),
                springs={} if bench.spring is None else {bench.spring.name: bench.spring},
            )
        output = self.model.outputs[0].name
        demand = Demand(output, lash=self.allowed.lash / self.geometry.follower.unit[1])
        return replace(
            made,
            tracks=(
                replace(
                    track.rolled,
                    ripple=self.allowed.speed_ripple,
                    ring=None if pieces is None else pieces.ring,
                ),
            ),
            bought=[
                *made.bought,
                *self._bought(),
                *(each.bought for each in made.springs.values()),
            ],
            demands=(demand,),
        )

    @property
    def _piece_count(self) -> int:
        """Of the drum: as the spec says, else two where a printed groove's upper wall would stand on supports."""
        if self.making.pieces is not None:
            return self.making.pieces
        whole = self.files.cutter_radius is not None or not materials.of(self.material.name).printed
        return 1 if whole or self.geometry.track != "groove" or self._tight else 2

    @property
    def _tight(self) -> bool:
        """Whether the ring of a groove would begin outside of the roller's inner end."""
        return self.geometry.roller.end_clearance < self.print.slide_clearance / 2

    @cached_property
    def pieces(self) -> Pieces | None:
        """Drum and ring; None where the drum is in one piece."""
        if self._piece_count == 1:
            return None
        fits = self.print
        return Pieces(self.track, self.making.reach, fits.slide_clearance, fits.press_clearance)

    @property
    def _springs(self) -> tuple[float, float] | None:
        """What the machine's springs press with, as its bench takes it; None where it has none."""
        pressing = self._pressing if self._sprung else None
        return None if pressing is None else (pressing.preload, pressing.rate)

    def _bench(self, drum: Sequence[Part], pressing: tuple[float, float] | None) -> Bench:
        """The machine round the pieces of the drum; pressing: of its springs."""
        fits = Fits(self.print.press_clearance, self.print.slide_clearance)
        cranked = self.motor.model == "hand crank"
        return Bench(self.track, self.making, fits, drum, cranked, pressing)

    def _bought(self) -> list[Bought]:
        """What turns and what rolls; slide or arm are the person's own. Of a whole machine both are parts."""
        if self.making.make == "printed":
            return []
        roller = self.geometry.roller
        count = 2 if self.geometry.track == "rib" else 1
        size = f"{2 * roller.radius:g} x {roller.length:g}"
        ball = ball_roller(2 * roller.radius, roller.length)
        length = self.track.length
        seat = seat_of(self.making, self.material.name, [length], self.drawing.key_fit)
        carried = shaft_and_bearings(replace(seat, marked=seat.ringed))
        where = "on your follower, in the track"
        named = self._cam_follower
        if named is not None:
            clear = self.track.inner + named.width + named.beyond - self.track.radius
            return [*carried, *named.bought(count, clear, where)]
        if roller.cone_deg:
            rolls = Bought(
                "roller", "", f"{size}, a cone of {roller.cone_deg:g} deg half angle", count
            )
        elif ball is None:
            why = no_ball_roller(2 * roller.radius)
            rolls = Bought("roller", "", f"{size}, turned ({why})", count)
        else:
            rolls = Bought("roller", ball.standard, f"{ball.name}, {ball.size}", count)
        return [*carried, replace(rolls, how=where)]

    # ---- checks and figures -----------------------------------------------------------------------------------------

    def limits(self) -> Sequence[Finding]:
        """PRESSURE_ANGLE, UNDERCUT, CURVATURE, MIN_WALL of the drum, those of the program; with [load] HERTZ, LIFT_OFF of an end
        cam, and BEARING_LIFE of a bought roller."""
        track = self.track
        low, high = track.drum.span
        areas, bends = track.walls
        sharpest = float(np.max(bends))
        drum = Where("drum")
        area = f"the wall has at least {float(np.min(areas)):.3g} of the area that the roller's axis sweeps; at 0 it is undercut"
        ends = min(low, track.length - high)
        walls = [
            at_least(
                "MIN_WALL",
                track.floor - self.making.reach,
                self.allowed.min_wall,
                "mm",
                Where("between bore and track"),
                "a larger geometry.radius or a smaller bore makes it thicker",
            ),
            at_least(
                "MIN_WALL",
                ends,
                self.allowed.min_wall,
                "mm",
                Where("between track and end"),
                "a larger geometry.length or parts.wall makes it thicker",
            ),
        ]
        if self.pieces is not None:
            walls.append(
                at_least(
                    "MIN_WALL",
                    self.pieces.thinnest,
                    self.allowed.min_wall,
                    "mm",
                    Where("shoulder, key or its bore"),
                    "a larger parts.wall makes it thicker",
                )
            )
        air = []
        if self._loaded is not None and self.geometry.track == "end":
            least = self.allowed.reserve(self.material.name)
            air += kept_on(self._loaded, self._load, self._pulled, self._bounce, least)
        if isinstance(self._hertz, Finding):
            air.append(self._hertz)
        return [
            at_most(
                "PRESSURE_ANGLE",
                track.steepest,
                self._steepest,
                "deg",
                drum,
                f"at the roller's inner end; {_FLATTER}",
            ),
            at_most(
                "UNDERCUT",
                0.0,
                0.0,
                self.geometry.follower.unit[0],
                drum,
                f"the follower makes the whole motion: {area}",
            ),
            at_least(
                "CURVATURE",
                1 / sharpest if sharpest > 0 else math.inf,
                self.allowed.least_radius,
                "mm",
                drum,
                f"least radius of curvature of the convex walls; {_FLATTER.replace('lowers it', 'makes it larger')}",
            ),
            *program_findings(
                self.program, self.geometry.follower.unit, self.allowed.of_cams(0.0), _SMOOTHER
            ),
            *walls,
            *air,
            *self._lives.findings,
        ]

    @cached_property
    def _load(self) -> FollowerLoad | None:
        return load_of(self.load, self._pressing)

    @cached_property
    def _loaded(self) -> Loaded | None:
        """Forces over the turn; None without [load]."""
        if self._load is None:
            return None
        theta = self.track.theta
        swings = self.geometry.follower.swings
        lever = self.track.lever(theta) * (MM if swings else 1.0)
        found = loaded_by(self._pulled, theta, self.program(theta), lever)
        # the follower's plane has the drum as its angle alone: what shaft and guide bear is not in it
        borne = replace(found.forces, reactions={}, normals={}, moments={})
        kick = kick_of(self.program, self._load, self._speed, swings)
        return replace(found, kick=kick, forces=borne)

    @cached_property
    def _bounce(self) -> Bounce | None:
        """What the follower of an end cam does where no spring holds it."""
        if self._loaded is None or self.geometry.track != "end":
            return None
        return bounce_of(self._pulled, self._loaded, self.load)

    @cached_property
    def _pressure(self) -> Floats | None:
        """Greatest pressure of a steel roller on the wall that bears it, (n,) MPa over the track's angles, as if all of its length
        bore alike; at its inner end, where the wall bends most. None without [load], of a cone, and where nothing presses.
        """
        roller = self.geometry.roller
        if self._loaded is None or roller.cone_deg:
            return None
        force = np.where(np.isfinite(self._loaded.force), self._loaded.force, 0.0)
        if self.geometry.track == "end":
            force = np.maximum(force, 0.0)
        if not np.any(force):
            return None
        track = self.track
        bends = track.walls[1]
        sides = [wall.side for wall in track.drum.walls]
        lower = bends[sides.index(-1)]
        bend = lower if len(sides) == 1 else np.where(force >= 0, lower, bends[sides.index(1)])
        curvature = bend + 1 / track.drum.walls[0].roller.radius
        own = materials.of(self.material.name)
        steel = materials.STEEL.elastic
        return np.asarray(
            line_contact(np.abs(force), roller.length, curvature, own.elastic, steel)[0]
        )

    @property
    def _hertz(self) -> Finding | NotJudged | None:
        """Of the roller in its track; None where nothing presses as a line."""
        if self._pressure is None:
            return None
        k = int(np.argmax(self._pressure))
        where = Where("drum", theta=float(self.track.theta[k]), digits=1)
        given = self.allowed.hertz_mpa
        length = self.geometry.roller.length
        return line_hertz(float(self._pressure[k]), length, self.material.name, given, where)

    def _unjudged(self) -> Sequence[NotJudged]:
        """HERTZ of a material of which no limit is known."""
        return [self._hertz] if isinstance(self._hertz, NotJudged) else []

    @cached_property
    def _lives(self) -> LoadCheck:
        """How long bought rollers last, each on the wall that it bears on: of a rib one below and one above, else one on both."""
        check = LoadCheck()
        if self._cam_follower is None or self._loaded is None:
            return check
        borne = pressed(self.track, self._effort)
        force = np.sqrt(borne.outward**2 + borne.onward**2 + borne.upward**2)
        roller = self.track.roller
        sides = {"roller": (-1, np.ones_like(force))}
        if self.geometry.track == "rib":
            lifts = self._effort >= 0
            sides = {"lower roller": (1, ~lifts), "upper roller": (-1, lifts)}
        for name, (side, bears) in sides.items():
            turning = abs(self._speed) * self._roller.pace(side, roller.middle) / roller.radius
            load = BallLoad(name, self._cam_follower, force * bears, turning, "bearing")
            bearing_life(check, load, self.allowed.bearing_life_h)
        return check

    @property
    def _effort(self) -> Floats:
        """What the follower needs along its way over the track's angles, (n,) N, of an arm N mm."""
        assert self._loaded is not None
        return np.asarray((1e3 if self.geometry.follower.swings else 1.0) * self._loaded.effort)

    @property
    def _roller(self) -> Roller:
        return Roller(self.track, self._speed)

    @property
    def _forces(self) -> Study:
        if self._loaded is None:
            return Study()
        pushed = self.geometry.track == "end"
        load = self._load or FollowerLoad()
        slides = not self.geometry.follower.swings
        study = force_study(self._loaded, load, slides, pushed, bool(gravity(self.load)))
        effort = self._effort
        guide = self.geometry.follower.guide or self.track.radius
        borne = [*pressed(self.track, effort).figures(guide), *self._lives.figures]
        notes = [*study.notes]
        if not gravity(self.load):
            notes.append(_WEIGHTLESS if slides else _ARM_S_WEIGHT)
        if self.geometry.track == "groove":
            spins = self._roller.reversals(effort)
            borne += self._roller.reversal_figures(spins)
            if len(spins):
                notes.append(
                    f"The force reverses {len(spins)} times per turn: the roller then meets the other wall, which reverses its spin. "
                    "A rib or an end cam avoids that."
                )
        return replace(study, numbers=study.numbers | Figures(borne), notes=notes)

    def remarks(self) -> Remarks:
        """What does not hold a drum alone on its shaft."""
        if self.making.make == "printed":
            return Remarks()
        return Remarks(
            warnings=[*bore_notes(self.making, self.material.name), *self._rubbing_heads()]
        )

    def _rubbing_heads(self) -> Iterator[str]:
        """That the head of a bought roller touches the floor of its track."""
        named = self._cam_follower
        gap = self.geometry.roller.end_clearance
        if named is not None and self.geometry.track != "end" and gap < named.beyond:
            yield (
                f"The head of {named.name} stands up to {named.beyond:g} mm out of its ring and touches the floor of the track, which is "
                f"{gap:g} mm from the ring: set geometry.roller.end_clearance = {named.beyond + HEAD_CLEARANCE:g}."
            )

    def study(self) -> Study:
        """Sizes, motion and its derivatives, pressure angle, forces."""
        unit, scale = self.geometry.follower.unit
        track = self.track
        low, high = self.program.extremes
        figures = Figures(
            [
                Figure(
                    "swing" if self.geometry.follower.swings else "stroke",
                    scale * (high - low),
                    unit,
                ),
                Figure("drum radius", track.radius, "mm"),
                Figure("drum length", track.length, "mm"),
                Figure("roller inner end", track.inner, "mm"),
                Figure("pressure angle", track.steepest, "deg"),
                *self._roller.figures(),
                *peak_figures(self.program, (unit, scale), self._speed),
                *bounce_figures(self._bounce, not self.geometry.follower.swings),
            ]
        )
        forces = self._forces
        if self._pressure is not None:
            most = float(np.max(self._pressure))
            figures |= Figures([Figure("hertz pressure {of}", most, "MPa", "contact")])
        return Study(
            figures | forces.numbers,
            Later(lambda: [*self._plots(), *forces.plots]),
            Later(lambda: [segments_table(self.program, self.geometry.follower.unit)]),
            sketches=self._sketches(),
            notes=Later(lambda: [*self._notes(), *forces.notes]),
        )

    def _plots(self) -> list[Plot]:
        theta = self.track.theta
        steep = np.degrees(self.track.pressure_angle(theta))
        curve = ("at the roller's inner end", np.degrees(theta), steep)
        pressure = Plot("Pressure angle", "cam angle, deg", "deg", [curve])
        return [*motion_plots(self.program, self.geometry.follower.unit, self._speed), pressure]

    def _sketches(self) -> list[Sketch]:
        """The rollers, and the slide or arm that carries them beside the drum, at s = 0; of a machine its springs."""
        if self.making.make == "printed":
            return self._bench((), self._springs).sketches()
        track = self.track
        g = self.geometry
        f = g.follower
        outer = track.radius + g.roller.end_clearance
        if f.swings:
            arm = f.arm or 0.0
            origin = complex(arm - track.pivot, track.height)
            middle = cmath.rect(arm, track.start)
            lines = [np.array([0j, middle])]
            hubs = [0j, middle]
        else:
            origin = complex(-f.offset, track.height)
            middle = 0j
            lines = [np.array([-0.5j, 0.5j]) * track.length]
            hubs = []
        half = 0.5j * (g.distance or 0.0)
        places = [middle - half, middle + half] if half else [middle]
        inside = Upright(track.inner, track.inner + g.roller.length, origin)
        beside = Upright(outer, outer + g.roller.radius, origin)
        return [
            Sketch("roller", (), [(z, g.roller.radius) for z in places], _FOLLOWER, upright=inside),
            Sketch(
                "follower",
                lines,
                [(z, g.roller.radius) for z in hubs or places],
                _FOLLOWER,
                upright=beside,
            ),
        ]

    def _notes(self) -> list[str]:
        track = self.track
        where = f"at height {track.height:.4g} mm over the drum's lower end"
        place = f"the roller's axis is {where} at displacement 0"
        if self.geometry.track == "rib":
            place = f"the middle between both rollers is {where} at displacement 0"
        if self.geometry.follower.swings:
            place = f"the arm's pivot is {track.pivot:.4g} mm beside the drum's axis, {where}; at displacement 0 the arm stands at {math.degrees(track.start):.4g} deg"
        if self.making.make == "printed":
            said = [
                "theta is counter-clockwise as seen from above; at 0 the follower stands at +x."
            ]
            return [*said, *self._pressing_notes()]
        return [
            f"camgen makes the drum, and lists its shaft, bearings and roller. You make the follower, its guide and the frame, and bring a coupling and the motor: {place}, the roller's inner end {track.inner:.4g} mm from the drum's axis.",
            "theta is counter-clockwise as seen from above; at 0 the follower stands at +x of the drum's files.",
        ]
