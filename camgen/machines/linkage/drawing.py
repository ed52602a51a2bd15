"""From the tables of a spec to the model: links with exact lengths, joints where they share points, closed as drawn.

    drawn position   theta = 0; the driven link's angle, a cam follower's place and a cam's angle there are as drawn
    pin              a point that two links share; of more links each is pinned to the first, the ground before all
    cam              its program begins at theta = 0, where the follower stands on the base circle
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from camgen.errors import DesignError, Fault, SpecError
from camgen.machine import freedom
from camgen.machine import model as m
from camgen.machines.linkage import tables as t
from camgen.machines.linkage.links import CLOSED, shape, too_long
from camgen.motion.program import Program
from camgen.motion.segments import SegmentTable, program
from camgen.spec import unknown

MOST_LINKS = 60  # they close together: the time grows with the cube of their number, 40 take a third of a minute
GROUND = m.GROUND


SECOND = "_2"  # of names: the other cam of a conjugate pair, and where its roller is


def level_of(joint: str) -> str:
    """Name in [layers] of what touches in a joint."""
    return joint.replace(" ", "_")


@dataclass(frozen=True)
class Scaled:
    """A cam's program as the law of a joint: sign (+1 or -1) times the displacement."""

    program: Program
    sign: int

    def __call__(self, theta: m.Floats, order: int = 0) -> m.Floats:
        """Its order-th derivative at the cam's angle theta, (n,)."""
        return np.asarray(self.sign * self.program(np.mod(theta, math.tau), order))


@dataclass(frozen=True)
class Programmed:
    """A program as the law of a drive: start + s(theta), and on by whole turns where a period ends turned on."""

    program: Program
    start: float

    @property
    def reach(self) -> tuple[float, float] | None:
        """Least and greatest angle from the start, rad; None where it turns on and on."""
        ends = [segment.start for segment in self.program.segments]
        return None if abs(self.program.segments[-1].end) > 1e-9 else (min(ends), max(ends))

    def __call__(self, theta: m.Floats, order: int = 0) -> m.Floats:
        """Its order-th derivative at theta, (n,)."""
        value = np.asarray(self.program(theta, order))
        if order:
            return value
        turned = self.program.segments[-1].end
        return self.start + value + turned * np.floor(np.asarray(theta, float) / math.tau)


@dataclass(frozen=True)
class Drawing:
    """The tables that say a machine; `machine()` is the model, `faults()` what is wrong between them."""

    points: Mapping[str, tuple[float, float]]
    links: Mapping[str, Sequence[str]]
    lengths: Mapping[str, float]
    drive: t.Drive
    slides: Sequence[t.Slide] = ()
    slots: Sequence[t.Slot] = ()
    gears: Sequence[t.Gear] = ()
    cams: Sequence[t.Cam] = ()
    outputs: Sequence[t.Wanted] = ()
    masses: Mapping[str, t.Masses] = ()  # type: ignore[assignment]

    # ---- what is wrong --------------------------------------------------------------------------------------------

    def faults(self) -> list[Fault]:
        """Names that are not there, points on no link, lengths between points of no link, links that nothing holds."""
        if not self.points:
            return [Fault("points", "an empty table", "the points of the drawing, such as O = [0, 0]")]
        found = [*self._link_faults(), *self._length_faults(), *self._joint_faults(), *self._output_faults()]
        return found or self._shape_faults()

    def _link_faults(self) -> Iterable[Fault]:
        if GROUND not in self.links:
            near = next((name for name in self.links if name.lower() in ("ground", "frame", "base", "fixed")), None)
            yield Fault("links.ground", "", "missing: the link that stands still, by its points", near)
        if len(self.links) > MOST_LINKS:
            right = f"at most {MOST_LINKS}, more would take many minutes: part the machine, and join it by [[include]]"
            yield Fault("links", f"{len(self.links)} links", right)
        seen: dict[str, str] = {}
        for name in self.links:
            if seen.setdefault(name.lower(), name) != name:
                right = f"another name: {seen[name.lower()]} differs in its capitals alone, and so would their files"
                yield Fault(f"links.{name}", "", right)
        for name, points in self.links.items():
            for k, point in enumerate(points):
                if point not in self.points:
                    yield _unknown(f"links.{name}.{k}", point, self.points)
                if point in points[:k]:
                    yield Fault(f"links.{name}.{k}", repr(point), "each point of a link once")
        used = {point for points in self.links.values() for point in points}
        for point in self.points:
            if point not in used:
                yield Fault(f"points.{point}", "", "is on no link: name it in [links], or take it away")
        held = {each.link for each in self.slides}
        for name, points in self.links.items():
            shared = any(point in others for point in points for other, others in self.links.items() if other != name)
            pinned = any(slot.pin in points for slot in self.slots) or any(slot.link == name for slot in self.slots)
            if name != GROUND and not shared and not pinned and name not in held:
                yield Fault(f"links.{name}", "", "nothing holds it: let it share a point with another link, or slide")

    def _length_faults(self) -> Iterable[Fault]:
        seen: dict[frozenset[str], str] = {}
        for key in self.lengths:
            names = t.pair(key)
            if names is None:
                yield Fault(f"lengths.{key}", "", 'two points of one link, such as "A-B"')
                continue
            wrong = [point for point in names if point not in self.points]
            for point in wrong:
                yield _unknown(f"lengths.{key}", point, self.points)
            if wrong:
                continue
            if names[0] == names[1]:
                yield Fault(f"lengths.{key}", "", "two different points")
            elif not any(set(names) <= set(points) for points in self.links.values()):
                yield Fault(f"lengths.{key}", "", f"two points of one link: no link carries both {names[0]} and {names[1]}")
            elif frozenset(names) in seen:
                yield Fault(f"lengths.{key}", "", f"given twice: also as {seen[frozenset(names)]}")
            seen[frozenset(names)] = key

    def _joint_faults(self) -> Iterable[Fault]:
        links = self.links
        named: dict[str, str] = {}

        def link(path: str, name: str, ground: bool = True) -> bool:
            if name not in links:
                faults.append(_unknown(path, name, links))
            elif name == GROUND and not ground:
                faults.append(Fault(path, repr(name), "a link that moves"))
            else:
                return True
            return False

        def on(path: str, name: str, points: Sequence[str]) -> None:
            for k, point in enumerate(points):
                if point not in links[name]:
                    faults.append(Fault(f"{path}.{k}", repr(point), f"a point of link {name}: {', '.join(links[name])}"))
            if len(points) == 2 and points[0] == points[1]:
                faults.append(Fault(path, repr(points[0]), "two different points"))
            elif all(point in self.points for point in points) and self._at(points[0]) == self._at(points[-1]) and points[1:]:
                faults.append(Fault(path, f"{points[0]}, {points[1]}", "two points that lie apart: its length is 0"))

        faults: list[Fault] = []
        if link("drive.link", self.drive.link, False) and self._pivot(self.drive.link) is None:
            faults.append(Fault("drive.link", repr(self.drive.link), "a link that shares a point with the ground"))
        if self.drive.range_deg is not None and not self.drive.range_deg[0] < self.drive.range_deg[1]:
            faults.append(Fault("drive.range_deg", str(list(self.drive.range_deg)), "the least before the greatest"))
        faults += self.drive.faults()
        for k, slide in enumerate(self.slides):
            both = [link(f"slide.{k}.link", slide.link, False), link(f"slide.{k}.on", slide.on)]
            if all(both) and slide.link == slide.on:
                faults.append(Fault(f"slide.{k}.on", repr(slide.on), "another link"))
            if both[1]:
                on(f"slide.{k}.along", slide.on, slide.along)
        for k, slot in enumerate(self.slots):
            if link(f"slot.{k}.link", slot.link):
                on(f"slot.{k}.along", slot.link, slot.along)
                if slot.pin not in self.points:
                    faults.append(_unknown(f"slot.{k}.pin", slot.pin, self.points))
                elif self._carrier(slot) is None:
                    faults.append(Fault(f"slot.{k}.pin", repr(slot.pin), f"a point of a link other than {slot.link}"))
                elif slot.pin in links[slot.link]:
                    faults.append(Fault(f"slot.{k}.pin", repr(slot.pin), f"no point of {slot.link} itself, which would pin it"))
        for k, gear in enumerate(self.gears):
            if link(f"gear.{k}.a", gear.a, False) & link(f"gear.{k}.b", gear.b, False):
                if gear.a == gear.b:
                    faults.append(Fault(f"gear.{k}.b", repr(gear.b), "another link"))
                faults += [Fault(f"gear.{k}.{end}", repr(name), f"a link that turns: {name} slides and cannot")
                           for end, name in (("a", gear.a), ("b", gear.b)) if self._slide_of(name)]  # fmt: skip
            if gear.ratio == 0:
                faults.append(Fault(f"gear.{k}.ratio", "0", "a ratio other than 0"))
        for k, cam in enumerate(self.cams):
            faults += self._cam_faults(f"cam.{k}", cam, link)
        for name in self.levels_of_joints():
            if name in links:
                faults.append(Fault(f"links.{name}", "", "another name: a cam or gear has it, and its level"))
        for path, name in self._joints():
            if name in named:
                faults.append(Fault(f"{path}.name", repr(name), f"a name of its own: {named[name]} has it"))
            named[name] = path
        return faults

    def _cam_faults(self, path: str, cam: t.Cam, link: Any) -> list[Fault]:
        faults = []
        if link(f"{path}.cam", cam.cam, False) and self._pivot(cam.cam) is None:
            faults.append(Fault(f"{path}.cam", repr(cam.cam), "a link that shares a point with the ground: it turns there"))
        if not link(f"{path}.follower", cam.follower, False):
            return faults
        if cam.follower == cam.cam:
            return [*faults, Fault(f"{path}.follower", repr(cam.follower), "another link: a cam does not move itself")]
        slide = self._slide_of(cam.follower)
        if self._pivot(cam.follower) is None and (slide is None or slide.on != GROUND):
            faults.append(Fault(f"{path}.follower", repr(cam.follower), "a link that is pinned to the ground or slides on it"))
        if cam.at not in self.links[cam.follower]:
            faults.append(Fault(f"{path}.at", repr(cam.at), f"a point of {cam.follower}: {', '.join(self.links[cam.follower])}"))
        if (cam.shape == "roller") != (cam.radius is not None):
            fits = "the roller's radius" if cam.shape == "roller" else f"nothing here: a {cam.shape} has none"
            faults.append(Fault(f"{path}.radius", "", fits))
        wrong, right = (("lift_deg", "to_deg"), ("lift", "to")) if slide else (("lift", "to"), ("lift_deg", "to_deg"))
        way = "slides" if slide else "swings"
        for k, segment in enumerate(cam.segment):
            for one, other in zip(wrong, right, strict=True):
                if getattr(segment, one) is not None:
                    faults.append(Fault(f"{path}.segment.{k}.{one}", "", f"{other}: {cam.follower} {way}"))
        if not faults:
            try:
                self.program_of(cam, path)
            except SpecError as error:
                faults += error.faults
        return faults

    def _output_faults(self) -> Iterable[Fault]:
        for k, output in enumerate(self.outputs):
            if (output.point is None) == (output.link is None):
                yield Fault(f"output.{k}", output.name, "either a point or a link")
            elif output.point is not None and output.point not in self.points:
                yield _unknown(f"output.{k}.point", output.point, self.points)
            elif output.link is not None and output.link not in self.links:
                yield _unknown(f"output.{k}.link", output.link, self.links)
            elif output.link == GROUND:
                yield Fault(f"output.{k}.link", repr(GROUND), "a link that moves")
            if output.name in [other.name for other in self.outputs[:k]]:
                yield Fault(f"output.{k}.name", repr(output.name), "a name of its own")
            yield from self._target_faults(f"output.{k}", output)
        for name in self.masses:
            if name not in self.links or name == GROUND:
                yield _unknown(f"masses.{name}", name, [link for link in self.links if link != GROUND])

    def _target_faults(self, path: str, output: t.Wanted) -> Iterable[Fault]:
        of_a_link = [key for key in ("points", "straightness") if output.link is not None and getattr(output, key)]
        of_a_point = [key for key in ("dwell", "time_ratio") if output.point is not None and getattr(output, key)]
        yield from (Fault(f"{path}.{key}", "", "nothing here: it is asked of a point's path, not of a link") for key in of_a_link)
        yield from (Fault(f"{path}.{key}", "", "nothing here: it is asked of a link, not of a path") for key in of_a_point)
        if output.points is not None:
            yield from output.points.faults(f"{path}.points")
        if output.straightness is not None:
            yield from output.straightness.faults(f"{path}.straightness")
        if self.drive.range_deg is None:
            return
        if output.time_ratio is not None:
            yield Fault(f"{path}.time_ratio", "", "nothing here: it is asked of a drive that turns all round, without range_deg")
        low, high = self.drive.range_deg
        asked = {"points.theta_deg": output.points and output.points.theta_deg,
                 "straightness.range_deg": output.straightness and output.straightness.range_deg}  # fmt: skip
        for key, angles in asked.items():
            if angles and not low <= min(angles) <= max(angles) <= high:
                yield Fault(f"{path}.{key}", str(list(angles)), f"angles within drive.range_deg, {low:g} to {high:g}")

    def _shape_faults(self) -> list[Fault]:
        """Links whose lengths contradict each other."""
        faults = []
        for name, points in self.links.items():
            lengths = self._lengths_of(points)
            drawn = self._drawn(points)
            missed = shape(drawn, lengths)[1]
            if missed > 1e3 * CLOSED * max(lengths.values(), default=1.0) and (told := too_long(points, drawn, lengths)):
                faults.append(Fault(f"links.{name}", *told))
            elif missed > 1e3 * CLOSED * max(lengths.values(), default=1.0):
                said = ", ".join(f"{points[a]}-{points[b]} = {length:g}" for (a, b), length in lengths.items())
                right = f"lengths that can meet: they miss by {missed:.3g} mm (a side of a triangle is at most the sum of "
                right += "the others; where no length is given the drawn distance counts)"
                faults.append(Fault(f"links.{name}", said, right))
        return faults

    # ---- names ----------------------------------------------------------------------------------------------------

    @staticmethod
    def slide_name(slide: t.Slide) -> str:
        """Name of its joint."""
        return slide.name or f"{slide.link} slide"

    @staticmethod
    def slot_name(slot: t.Slot) -> str:
        """Name of its joint."""
        return slot.name or f"{slot.pin} in {slot.link}"

    @staticmethod
    def gear_name(gear: t.Gear) -> str:
        """Name of its joint."""
        return gear.name or f"{gear.a} to {gear.b}"

    @staticmethod
    def cam_name(cam: t.Cam) -> str:
        """Name of its joint."""
        return cam.name or f"{cam.cam} on {cam.follower}"

    def _joints(self) -> Iterable[tuple[str, str]]:
        """Path and name of each joint that has a table."""
        for kind, names in (("slide", map(self.slide_name, self.slides)), ("slot", map(self.slot_name, self.slots)),
                            ("gear", map(self.gear_name, self.gears)), ("cam", map(self.cam_name, self.cams))):  # fmt: skip
            yield from ((f"{kind}.{k}", name) for k, name in enumerate(names))

    def names_of_joints(self) -> list[str]:
        """Of pins, of all joints that have a table, and of their levels."""
        return [*self.points, *(name for _, name in self._joints()), *self.levels_of_joints(), "drive"]

    def levels_of_joints(self) -> list[str]:
        """Names in [layers] of what has a level of its own beside the links: cams, the second one of a pair, gears."""
        found = [level_of(self.gear_name(gear)) for gear in self.gears]
        for cam in (cam for cam in self.cams if cam.shape == "roller"):
            key = level_of(self.cam_name(cam))
            found += [key, key + SECOND] if cam.closure == "conjugate" else [key]
        return found

    # ---- looking up -----------------------------------------------------------------------------------------------

    def _at(self, point: str) -> complex:
        return complex(*self.points[point])

    def _drawn(self, points: Sequence[str]) -> m.Points:
        return np.array([self._at(point) for point in points])

    def _lengths_of(self, points: Sequence[str]) -> dict[tuple[int, int], float]:
        found = {}
        for key, length in self.lengths.items():
            names = t.pair(key)
            if names and set(names) <= set(points):
                a, b = sorted(points.index(name) for name in names)
                found[a, b] = length
        return found

    def _pivot(self, link: str) -> str | None:
        """The point at which a link is pinned to the ground."""
        return next((point for point in self.links[link] if point in self.links.get(GROUND, ())), None)

    def _slide_of(self, link: str) -> t.Slide | None:
        return next((slide for slide in self.slides if slide.link == link), None)

    def _carrier(self, slot: t.Slot) -> str | None:
        """The link whose pin runs in the slot."""
        return next((name for name, points in self.links.items() if name != slot.link and slot.pin in points), None)

    def program_of(self, cam: t.Cam, path: str = "cam") -> Program:
        """The cam's program, s in mm or rad, 0 at its beginning; SpecError with every fault."""
        swings = self._slide_of(cam.follower) is None
        rows = tuple(
            SegmentTable(kind=row.kind, span_deg=row.span_deg, law=row.law, lift=row.lift_deg if swings else row.lift,
                         to=row.to_deg if swings else row.to)
            for row in cam.segment
        )  # fmt: skip
        unit, suffix = (math.radians(1), "_deg") if swings else (1.0, "")
        return program(rows, unit, f"{path}.segment", suffix=suffix)

    # ---- the model ------------------------------------------------------------------------------------------------

    def machine(self) -> m.Machine:
        """The model, closed at theta = 0; DesignError where it does not close, is loose or locked."""
        bodies, start = self._bodies()
        joints = [*self._pins(bodies), *self._slides(bodies, start), *self._slots(bodies)]
        joints += [self._gear(gear, start) for gear in self.gears]
        joints += [self._cam(cam, bodies, start, joints) for cam in self.cams]
        drive = m.Drive("drive", self.drive.link, m.Turning(1.0, start[self.drive.link].angle))
        outputs = tuple(self._output(each, bodies) for each in self.outputs)
        speed = self.drive.speed_rpm * math.tau / 60
        machine = m.Machine(tuple(bodies.values()), tuple(joints), (drive,), start, (), outputs, speed)
        machine = freedom.drawn(machine)
        freedom.refuse_unsound(machine)
        return machine

    def _bodies(self) -> tuple[dict[str, m.Body], dict[str, m.Pose]]:
        bodies, start = {}, {}
        for name, points in self.links.items():
            drawn = self._drawn(points)
            exact = shape(drawn, self._lengths_of(points))[0]
            pose = m.Pose(0j, 0.0)
            if name != GROUND:
                angle = cmath.phase(exact[1] - exact[0]) if len(exact) > 1 else 0.0
                pose = m.Pose(complex(exact[0]), angle)
                exact = (exact - exact[0]) * cmath.exp(-1j * angle)
                if len(exact) > 1:
                    exact[1] = abs(exact[1])
                start[name] = pose
            mass = dict(self.masses).get(name)
            places = {point: complex(z) for point, z in zip(points, exact, strict=True)}
            if mass is None:
                bodies[name] = m.Body(name, places)
            else:
                centre = complex(*mass.centre) if mass.centre else complex(np.mean(exact))
                bodies[name] = m.Body(name, places, mass.mass_g / 1e3, centre, mass.inertia_kg_m2)
        return bodies, start

    def _pins(self, bodies: Mapping[str, m.Body]) -> list[m.Joint]:
        found: list[m.Joint] = []
        for point in self.points:
            links = [name for name, points in self.links.items() if point in points]
            links.sort(key=lambda name: name != GROUND)
            for other in links[1:]:
                name = point if len(links) == 2 else f"{point} of {other}"
                found.append(m.Pin(name, bodies[links[0]].at(point), bodies[other].at(point)))
        return found

    def _line(self, body: m.Body, along: t.Two) -> tuple[complex, float]:
        a, b = (complex(body.points[point]) for point in along)
        return a, cmath.phase(b - a)

    def _slides(self, bodies: Mapping[str, m.Body], start: Mapping[str, m.Pose]) -> list[m.Joint]:
        found: list[m.Joint] = []
        for slide in self.slides:
            base = m.Pose(0j, 0.0) if slide.on == GROUND else start[slide.on]
            through, angle = self._line(bodies[slide.on], slide.along)
            runner = self.links[slide.link][0]
            place = (self._at(runner) - base.place) * cmath.exp(-1j * base.angle)
            away = (place - through) * cmath.exp(-1j * angle)
            aside = through + 1j * away.imag * cmath.exp(1j * angle)
            found.append(m.Slide(self.slide_name(slide), m.Place(slide.on, aside), bodies[slide.link].at(runner), angle,
                                 start[slide.link].angle - base.angle))  # fmt: skip
        return found

    def _slots(self, bodies: Mapping[str, m.Body]) -> list[m.Joint]:
        found: list[m.Joint] = []
        for slot in self.slots:
            through, angle = self._line(bodies[slot.link], slot.along)
            carrier = self._carrier(slot)
            assert carrier is not None, "faults() has looked"
            found.append(m.Slot(self.slot_name(slot), m.Place(slot.link, through), bodies[carrier].at(slot.pin), angle))
        return found

    def _gear(self, gear: t.Gear, start: Mapping[str, m.Pose]) -> m.Gear:
        carriers = [name for name, points in self.links.items() if name not in (gear.a, gear.b)
                    and set(points) & set(self.links[gear.a]) and set(points) & set(self.links[gear.b])]  # fmt: skip
        carrier = GROUND if GROUND in carriers or not carriers else carriers[0]
        base = 0.0 if carrier == GROUND else start[carrier].angle
        phase = (start[gear.b].angle - base) - gear.ratio * (start[gear.a].angle - base)
        return m.Gear(self.gear_name(gear), gear.a, gear.b, gear.ratio, phase, carrier)

    def _cam(self, cam: t.Cam, bodies: Mapping[str, m.Body], start: Mapping[str, m.Pose], joints: Sequence[m.Joint]) -> m.Cam:
        slide = self._slide_of(cam.follower)
        pivot = self._pivot(cam.cam)
        assert pivot is not None, "faults() has looked"
        spoke = self._at(cam.at) - self._at(pivot)
        if slide is not None:
            joint = next(each for each in joints if each.name == self.slide_name(slide))
            assert isinstance(joint, m.Slide)
            way = cmath.exp(1j * joint.angle)
            rest = ((self._at(self.links[cam.follower][0]) - joint.guide.at) * way.conjugate()).real
        else:
            hinge = self._pivot(cam.follower)
            assert hinge is not None, "faults() has looked"
            way = 1j * (self._at(cam.at) - self._at(hinge))
            rest = start[cam.follower].angle
        outward = (spoke.conjugate() * way).real
        if abs(outward) <= 1e-6 * abs(spoke) * abs(way):
            remedy = f"the follower moves across the line from {pivot} to {cam.at}: draw {cam.at} elsewhere"
            raise DesignError("pressure angle as drawn", 90, 90, "deg", f"cam {self.cam_name(cam)}", remedy)
        sign = 1 if outward > 0 else -1
        form = "force" if cam.closure == "force" else "form"
        return m.Cam(self.cam_name(cam), cam.cam, cam.follower, Scaled(self.program_of(cam), sign),
                     None if slide is None else self.slide_name(slide), start[cam.cam].angle, rest, form, sign)  # type: ignore[arg-type]  # fmt: skip

    def _output(self, output: t.Wanted, bodies: Mapping[str, m.Body]) -> m.Output:
        if output.point is not None:
            carrier = next(name for name, points in self.links.items() if output.point in points)
            return m.Output(output.name, m.Path(bodies[carrier].at(output.point)))
        assert output.link is not None
        slide = self._slide_of(output.link)
        if slide is not None:
            return m.Output(output.name, m.Along(self.slide_name(slide)))
        return m.Output(output.name, m.Angle(output.link), "rad")


def _unknown(path: str, name: str, known: Iterable[str]) -> Fault:
    return unknown(path, name, known)
