"""The model of a drawing: its bodies with exact lengths, joints where they share points, closed as drawn."""

from __future__ import annotations

import cmath
import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from itertools import combinations
from typing import Any, Literal

import numpy as np

from camgen.errors import DesignError
from camgen.machine import freedom
from camgen.machine import model as m
from camgen.machine.cams.followers import Follower
from camgen.machine.cams.linear import WAY
from camgen.machine.cams.profile import DiscCam
from camgen.machine.cams.sizing import least_base_radius, written
from camgen.machine.freewheels import Ratchet
from camgen.machine.jets import thread_length
from camgen.machine.programs import CamLaw, CarriedLaw
from camgen.machine.run import solve
from camgen.machine.stepwise import closed_by_dyads
from camgen.machines.linkage import planets
from camgen.machines.linkage import tables as t
from camgen.machines.linkage.drawing import Drawing
from camgen.machines.linkage.links import shape
from camgen.parts.generator.cycloids import CycloidWish
from camgen.parts.generator.wheels import follower_of, pivot
from camgen.parts.wheels.geneva import GenevaLaw
from camgen.tolerances import SAME_POINT

GROUND = m.GROUND
_LEAST_SHIFT = 1.0  # mm or deg, of a follower from where it is drawn, that is told


@dataclass(frozen=True)
class DrawnMachine:
    """The machine that a drawing says, once `drawing_faults` finds nothing wrong in it."""

    drawing: Drawing

    def closed(self) -> m.Machine:
        """The model, closed at theta = 0; DesignError where it does not close, is loose or locked."""
        drawn = self.rough
        closed = closed_by_dyads(drawn)
        if closed is not None:
            return closed
        try:
            machine = freedom.close_drawing(drawn)
            freedom.refuse_unsound(machine)
        except DesignError as error:
            if alike := self._at_one_place():
                raise error.mended(f"draw {alike} at two places: they are at one") from None
            raise
        return machine

    def _at_one_place(self) -> str:
        """Two points of a moving link that are drawn at one place; "" where none are."""
        for name, points in self.drawing.links.items():
            for a, b in combinations(points, 2):
                place, other = self.drawing.drawn([a, b])
                if name != GROUND and abs(place - other) < SAME_POINT:
                    return f"{a} and {b} of {name}"
        return ""

    def released(self, machine: m.Machine) -> m.Machine:
        """The machine with its freewheels; what they turn on is held still by drives of their names until then."""
        clutches = tuple(self._clutch(freewheel, machine) for freewheel in self.drawing.freewheels)
        if not clutches:
            return machine
        joints = (*machine.joints, *clutches)
        return replace(machine, joints=joints, drives=machine.drives[: -len(clutches)])

    def _clutch(self, freewheel: t.Freewheel, held: m.Machine) -> m.Clutch:
        """The joint of wheel and link; held: the machine, its freewheels' links held."""
        wheel = m.Output("wheel", m.Angle(freewheel.wheel), "rad")
        seen = replace(held, outputs=(wheel,))

        def turned(theta: m.Floats, order: int) -> m.Floats:
            return np.asarray(solve(seen, theta, order).derivatives("wheel")[order], float)

        law = Ratchet(
            turned,
            math.radians(freewheel.lost_deg),
            1 if freewheel.turns == "counter-clockwise" else -1,
            -1 if held.speed < 0 else 1,
            held.start[freewheel.link].angle,
        )
        name = freewheel.joint
        return m.Clutch(name, freewheel.wheel, freewheel.link, law, law.apart)

    @cached_property
    def open(self) -> m.Machine:
        """The model as drawn, open where lengths are others than drawn."""
        drawing = self.drawing
        gears = [*drawing.gears, *(gear for row in drawing.planets for gear in planets.gears(row))]
        cams = {cam.joint: self._cam(cam) for cam in drawing.cams}
        joints: list[m.Joint] = [
            *self._pins(),
            *self._slides,
            *self._slots(),
            *map(self._gear, gears),
            *cams.values(),
            *map(self._geneva, drawing.genevas),
            *map(self._noncircular, drawing.noncirculars),
            *map(self._mutilated, drawing.mutilated),
            *map(self._ratchet, drawing.ratchets),
            *(joint for wish in drawing.cycloid_wishes for joint in _cycloid(wish, self.start)),
        ]
        drives = map(self._drive, drawing.names_of_drives(), drawing.drives)
        held = [
            m.Drive(each.joint, each.link, m.Turning(0.0, self.start[each.link].angle))
            for each in drawing.freewheels
        ]
        loads = [_load(cam, cams[cam.joint]) for cam in drawing.cams]
        return m.Machine(
            tuple(self.bodies.values()),
            tuple(joints),
            (*drives, *held),
            self.start,
            tuple(load for load in loads if load is not None),
            tuple(map(self._output, drawing.outputs)),
            drawing.drive.speed_rpm * math.tau / 60,
        )

    # ---- cams on their base circles ------------------------------------------------------------------------------------

    def _follower(self, cam: t.Cam) -> tuple[m.Cam, Follower]:
        """A cam's joint, and its follower as drawn, about the cam's axis."""
        name = cam.joint
        joint = self.open.cam(name)
        sign: Literal[1, -1] = 1 if joint.leaves > 0 else -1
        return joint, follower_of(self.open, joint, self.drawing.ridden[name], cam.at, sign)

    def disc(self, cam: t.Cam) -> DiscCam[Any]:
        """A cam about its axis, as it lies at theta = 0; DesignError where it cannot be made."""
        joint, follower = self._follower(cam)
        assert isinstance(joint.law, CamLaw)
        base = self.bases.get(cam.joint)
        on_base = follower if base is None else follower.on_base(base)
        return DiscCam(joint.law.signed, on_base, cam.tip_clearance)

    @cached_property
    def bases(self) -> dict[str, float]:
        """Base radius of each cam that says it, by its joint, mm; DesignError where none keeps to the limits."""
        radii = {}
        for cam in self.drawing.cams:
            if cam.base_radius is None:
                continue
            name = cam.joint
            base = cam.base_radius
            if base == "least":
                joint, follower = self._follower(cam)
                assert isinstance(joint.law, CamLaw)
                made = DiscCam(joint.law.signed, follower, cam.tip_clearance)
                room = self.drawing.rooms.get(cam.closure, 0.0)
                base = written(*least_base_radius(made, self.drawing.ridden[name].limits, room))
            radii[name] = base
        return radii

    @cached_property
    def shifts(self) -> dict[str, float]:
        """How far each base radius moves its cam's follower from where it is drawn, by the cam's joint, mm or rad,
        counter-clockwise; DesignError where the follower cannot stand there."""
        shifts = {}
        for cam in self.drawing.cams:
            name = cam.joint
            if name not in self.bases:
                continue
            _, follower = self._follower(cam)
            try:
                shifts[name] = follower.on_base(self.bases[name]).ahead_of(follower)
            except ValueError as error:
                remedy = "use another base_radius, or draw the follower elsewhere"
                raise DesignError(
                    "base_radius",
                    self.bases[name],
                    0,
                    "mm",
                    f"cam {name}",
                    remedy,
                ).saying(f"cam {name}: {error}") from None
        return shifts

    @property
    def rough(self) -> m.Machine:
        """The model not yet closed, each follower that says its base radius on that; DesignError where it cannot stand there."""
        machine = self.open
        for name, shift in self.shifts.items():
            joint = self.open.cam(name)
            machine = _moved(machine, joint, shift)
        return machine

    def shifted(self) -> list[str]:
        """What to know of each follower that a base radius moves from where it is drawn, by 1 deg or 1 mm and more."""
        sentences = []
        for k, (name, cam) in enumerate(self.drawing.named_cams.items()):
            shift = self.shifts.get(name, 0.0)
            slides = self.drawing.slide_of(cam.follower) is not None
            size = abs(shift) if slides else math.degrees(abs(shift))
            if size < _LEAST_SHIFT:
                continue
            way = "" if slides else " clockwise" if shift < 0 else " counter-clockwise"
            amount = f"{size:.3g} {'mm' if slides else 'deg'}"
            verb = "moves" if slides else "turns"
            sentences.append(
                f"{cam.follower} stands {amount}{way} from where it is drawn: cam.{k}.base_radius = {self.bases[name]:.4g} "
                f"{verb} it; it stands as drawn without base_radius"
            )
        return sentences

    # ---- bodies and joints ---------------------------------------------------------------------------------------------

    @property
    def bodies(self) -> dict[str, m.Body]:
        """By their names."""
        return self._placed[0]

    @property
    def start(self) -> dict[str, m.Pose]:
        """Where they are drawn."""
        return self._placed[1]

    @cached_property
    def _placed(self) -> tuple[dict[str, m.Body], dict[str, m.Pose]]:
        bodies = {}
        start = {}
        masses = dict(self.drawing.masses)
        for name, points in self.drawing.links.items():
            drawn = tuple(self.drawing.at(point) for point in points)
            lengths = tuple(self.drawing.lengths_of(points).items())
            exact, pose = _laid(drawn, lengths, name == GROUND)
            if name != GROUND:
                start[name] = pose
            mass = masses.get(name)
            places = dict(zip(points, exact, strict=True))
            if mass is None:
                bodies[name] = m.Body(name, places)
            else:
                centre = complex(*mass.centre) if mass.centre else complex(np.mean(exact))
                bodies[name] = m.Body(name, places, mass.mass_g / 1e3, centre, mass.inertia_kg_m2)
        return bodies, start

    def _drive(self, name: str, drive: t.OneDrive) -> m.Drive:
        if isinstance(drive, t.SlidingDrive):
            slide, place = self._sliding(drive.link)
            return m.Drive(name, drive.link, m.Turning(WAY, place), slide.name)
        law = m.Turning(self.drawing.rate_of(drive) or 1.0, self.start[drive.link].angle)
        several = len(self.drawing.drives) > 1
        return m.Drive(name, drive.link, law, motor=drive.link if several else None)

    def _sliding(self, link: str) -> tuple[m.Slide, float]:
        """The joint of a link that slides on the ground, and its drawn place along that, mm."""
        slide = next(each for each in self._slides if each.runner.body == link)
        way = cmath.exp(1j * slide.angle)
        return slide, ((self.drawing.at(self.drawing.links[link][0]) - slide.guide.at) / way).real

    def _pins(self) -> list[m.Pin]:
        pins = []
        bodies = self.bodies
        for point in self.drawing.points:
            links = [name for name, points in self.drawing.links.items() if point in points]
            links.sort(key=lambda name: name != GROUND)
            for other in links[1:]:
                name = point if len(links) == 2 else f"{point} of {other}"
                pins.append(
                    m.Pin(
                        name, bodies[links[0]].at(point), bodies[other].at(point), self.drawing.play
                    )
                )
        return pins

    def _line(self, link: str, along: t.Two) -> tuple[complex, float]:
        """A point of a line of a link in its axes, mm, and its direction there, rad."""
        a, b = (complex(self.bodies[link].points[point]) for point in along)
        return a, cmath.phase(b - a)

    @cached_property
    def _slides(self) -> list[m.Slide]:
        slides = []
        bodies = self.bodies
        start = self.start
        for slide in self.drawing.slides:
            base = m.Pose(0j, 0.0) if slide.on == GROUND else start[slide.on]
            through, angle = self._line(slide.on, slide.along)
            runner = self.drawing.links[slide.link][0]
            place = (self.drawing.at(runner) - base.place) * cmath.exp(-1j * base.angle)
            away = (place - through) * cmath.exp(-1j * angle)
            aside = through + 1j * away.imag * cmath.exp(1j * angle)
            slides.append(
                m.Slide(
                    slide.joint,
                    m.Place(slide.on, aside),
                    bodies[slide.link].at(runner),
                    angle,
                    start[slide.link].angle - base.angle,
                    self.drawing.play,
                )
            )
        return slides

    def _slots(self) -> list[m.Slot]:
        slots = []
        bodies = self.bodies
        for slot in self.drawing.slots:
            through, angle = self._line(slot.link, slot.along)
            carrier = self.drawing.carrier(slot)
            assert carrier is not None, "drawing_faults has looked"
            slots.append(
                m.Slot(
                    slot.joint,
                    m.Place(slot.link, through),
                    bodies[carrier].at(slot.pin),
                    angle,
                    self.drawing.play,
                )
            )
        return slots

    def _gear(self, gear: t.Gear) -> m.Gear:
        carriers = [
            name
            for name, points in self.drawing.links.items()
            if name not in (gear.a, gear.b)
            and set(points) & set(self.drawing.links[gear.a])
            and set(points) & set(self.drawing.links[gear.b])
        ]
        carrier = GROUND if GROUND in carriers or not carriers else carriers[0]
        angle = {GROUND: 0.0} | {name: pose.angle for name, pose in self.start.items()}
        base = angle[carrier]
        phase = (angle[gear.b] - base) - gear.ratio * (angle[gear.a] - base)
        return m.Gear(gear.joint, gear.a, gear.b, gear.ratio, phase, carrier)

    def _cam(self, cam: t.Cam) -> m.Cam:
        slide = self.drawing.slide_of(cam.follower)
        carrier, phase = self._carrier(cam)
        spoke = self._spoke(cam, carrier)
        if slide is not None:
            joint, rest = self._sliding(cam.follower)
            way = cmath.exp(1j * joint.angle)
        else:
            hinge = self.drawing.pivot(cam.follower)
            assert hinge is not None, "drawing_faults has looked"
            way = 1j * (self.drawing.at(cam.at) - self.drawing.at(hinge))
            rest = self.start[cam.follower].angle
        outward = (spoke.conjugate() * way).real
        if abs(outward) <= 1e-6 * abs(spoke) * abs(way):
            line = f"across the line from {self.drawing.pivot(cam.cam)} to {cam.at}"
            way_of = f"along the travel of {cam.cam}" if carrier else line
            remedy = f"the follower moves {way_of}: draw {cam.at} elsewhere"
            raise DesignError("pressure angle as drawn", 90, 90, "deg", f"cam {cam.joint}", remedy)
        sign = 1 if outward > 0 else -1
        form: Literal["form", "force"] = "force" if cam.closure == "force" else "form"
        return m.Cam(
            cam.joint,
            cam.cam,
            cam.follower,
            (CarriedLaw if carrier else CamLaw)(self.drawing.program_of(cam), sign),
            None if slide is None else slide.joint,
            phase,
            rest,
            form,
            sign,
            over=carrier.name if carrier else None,
        )

    def _carrier(self, cam: t.Cam) -> tuple[m.Slide | None, float]:
        """The slide of a plate, None of a disc; and the cam's place along it, mm, or its angle, rad, as drawn."""
        if not self.drawing.carries_plate(cam):
            return None, self.start[cam.cam].angle
        return self._sliding(cam.cam)

    def _spoke(self, cam: t.Cam, carrier: m.Slide | None) -> complex:
        """What points from a cam to what touches it: from a disc's shaft, or square to a plate's way."""
        if carrier is None:
            pivot = self.drawing.pivot(cam.cam)
            assert pivot is not None, "drawing_faults has looked"
            return self.drawing.at(cam.at) - self.drawing.at(pivot)
        way = cmath.exp(1j * carrier.angle)
        aside = (self.drawing.at(cam.at) - carrier.guide.at) / way
        return 1j * math.copysign(1, aside.imag) * way

    def _geneva(self, table: t.Geneva) -> m.Cam:
        """The joint; its angle is 0 in the middle of a drive: the pin is on the line of both axes, towards that of the wheel, but
        away from that of an inner one."""
        law = GenevaLaw(self.drawing.edge_wishes[table.joint].geneva)
        ground = self.bodies[GROUND].points
        axes = [complex(ground[self.drawing.pivot(link) or ""]) for link in (table.a, table.b)]
        crank = self.bodies[table.a].points
        spoke = complex(crank[table.pin]) - complex(crank[self.drawing.pivot(table.a) or ""])
        phase = cmath.phase(law.geneva.sense * (axes[0] - axes[1]) / spoke)
        angle = self.start[table.a].angle - phase
        rest = self.start[table.b].angle - float(law(np.array(angle)))
        name = table.joint
        return m.Cam(name, table.a, table.b, law, phase=phase, rest=rest)

    def _noncircular(self, table: t.Noncircular) -> m.Cam:
        law = self.drawing.edge_wishes[table.joint].centrodes.law.reversed
        return self._from_rest(table, law)

    def _mutilated(self, table: t.Mutilated) -> m.Cam:
        """The joint; as drawn it is in the middle of a rest."""
        return self._from_rest(table, self.drawing.edge_wishes[table.joint])

    def _from_rest(self, table: t.Pair, law: m.Law) -> m.Cam:
        """A joint whose angle is 0 as drawn."""
        phase, rest = (self.start[link].angle for link in (table.a, table.b))
        return m.Cam(table.joint, table.a, table.b, law, phase=phase, rest=rest)

    def _ratchet(self, table: t.Ratchet) -> m.Cam:
        """The joint; its angle is 0 in the seat of a tooth, and as drawn the pawl is halfway from drop to drop."""
        law = self.drawing.edge_wishes[table.joint].law
        pawl = law.pawl
        angle = law.way * (pawl.dropping - pawl.wheel.pitch / 2)
        phase = self.start[table.a].angle - angle
        rest = self.start[table.b].angle - float(law(np.array(angle)))
        links = table.joint, table.a, table.b, law
        return m.Cam(*links, phase=phase, rest=rest, closure="force", leaves=-law.way)

    def _place(self, point: str) -> m.Place:
        """A point on the first link that has it."""
        carrier = next(name for name, points in self.drawing.links.items() if point in points)
        return self.bodies[carrier].at(point)

    def _output(self, output: t.Wanted) -> m.Output:
        if output.point is not None:
            return m.Output(output.name, m.Path(self._place(output.point)))
        if output.thread is not None:
            places = tuple(map(self._place, output.thread))
            return m.Output(output.name, m.Function(places, thread_length))
        assert output.link is not None
        slide = self.drawing.slide_of(output.link)
        if slide is not None:
            return m.Output(output.name, m.Along(slide.joint))
        return m.Output(output.name, m.Angle(output.link), "rad")


def _load(cam: t.Cam, joint: m.Cam) -> m.Resistance | None:
    """What [[cam]] says that the follower bears."""
    if not cam.damping and not cam.resistance:
        return None
    slide = joint.slide
    of = m.Angle(cam.follower) if slide is None else m.Along(slide)
    force = -joint.leaves * cam.resistance
    return m.Resistance(f"load of {joint.name}", of, force, damping=cam.damping)


def _cycloid(wish: CycloidWish, start: Mapping[str, m.Pose]) -> list[m.Cam]:
    """Its joints, at their angle 0 as drawn: crank and disc, disc and output, which turns as the disc does."""
    crank, disc = (start[link].angle for link in (wish.crank, wish.link))
    law = m.Turning(wish.disc.ratio)
    joints = [m.Cam(wish.joint, wish.crank, wish.link, law, phase=crank, rest=disc)]
    if wish.output is not None and wish.opposite is None:  # the first disc says how it turns
        joints.append(wish.output_law(start))
    return joints


@lru_cache(maxsize=256)  # of variants most links are the same
def _laid(
    drawn: tuple[complex, ...], lengths: tuple[tuple[tuple[int, int], float], ...], still: bool
) -> tuple[tuple[complex, ...], m.Pose]:
    """A link's points in its frame, and where that is drawn; those of what stands still are on the ground."""
    exact = shape(np.array(drawn), dict(lengths))[0]
    if still:
        return tuple(exact.tolist()), m.Pose(0j, 0.0)
    angle = cmath.phase(exact[1] - exact[0]) if len(exact) > 1 else 0.0
    pose = m.Pose(complex(exact[0]), angle)
    exact = (exact - exact[0]) * cmath.exp(-1j * angle)
    if len(exact) > 1:
        exact[1] = abs(exact[1])
    return tuple(exact.tolist()), pose


def _moved(machine: m.Machine, joint: m.Cam, ahead: float) -> m.Machine:
    """The machine with a cam's follower further along its way, mm or rad, as it stands at theta = 0."""
    pose = machine.start_of(joint.follower)
    if joint.slide is not None:
        slide = machine.slide(joint.slide)
        pose = replace(pose, place=pose.place + ahead * cmath.exp(1j * slide.angle))
    else:
        turn = cmath.exp(1j * ahead)
        hinge = pivot(machine, joint.follower)[1]
        pose = m.Pose(hinge + (pose.place - hinge) * turn, pose.angle + ahead)
    joints = tuple(
        replace(joint, rest=joint.rest + ahead) if each.name == joint.name else each
        for each in machine.joints
    )
    return replace(machine, joints=joints, start={**machine.start, joint.follower: pose})
