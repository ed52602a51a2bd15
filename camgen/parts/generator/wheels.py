"""What sits on the shafts of a linkage: cam discs with their rollers, gear wheels.

wheel    a disc that is fixed on its link's shaft, at the pivot on the ground; wheels that touch lie on one level
roller   turns on a pin of the follower, on the level of its cam
second   of a conjugate pair: another cam and a roller at a further point of the follower, which pushes it back
"""

from __future__ import annotations

import cmath
import math
from abc import ABC, abstractmethod
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from itertools import groupby, pairwise
from typing import Any, ClassVar, Literal

import numpy as np

from camgen.errors import DesignError
from camgen.findings import Finding
from camgen.geometry.outlines import Contour, Line, Piece, end_point, start_point
from camgen.machine import model as m
from camgen.machine.cams.followers import (
    FlatFace,
    Follower,
    SlidingFace,
    SlidingTip,
    SwingingArm,
    SwingingFace,
)
from camgen.machine.cams.limits import (
    Advice,
    CamLimits,
    ExactCam,
    cam_findings,
    edge_findings,
    program_findings,
    unit_of,
)
from camgen.machine.cams.linear import (
    LinearCam,
    PlateArm,
    PlateSlide,
    PlateTouch,
    over_way,
    seen_from_left,
)
from camgen.machine.cams.machine import CamTouch
from camgen.machine.cams.profile import DiscCam
from camgen.machine.programs import CamLaw, CarriedLaw
from camgen.numerics import Points, peak
from camgen.parts.generator.sizes import Parts
from camgen.tolerances import SAME_POINT

SECOND = "_2"  # of names: the other cam of a conjugate pair, and where its roller is
_ROUND = np.linspace(0, math.tau, 721)
NOSE = 3.0  # radii of a knife's disc, from there to its edge
_FLATTER = "a longer span or a smaller lift"
_SMOOTHER = "a law that ends smoother joins them"
_PLACES = 721  # along a plate's edge, between which its lowest one is looked for
_INSIDE = 1e-9  # of theta, from the ends of a plate's way
_BESIDE = 0.5  # mm, of a face beside where it is touched


def level_of(joint: str) -> str:
    """Name in [layers] of what touches in a joint."""
    return joint.replace(" ", "_")


@dataclass(frozen=True)
class Ridden:
    """What of a follower touches a cam, as in [[cam]], and what of that is accepted."""

    shape: str  # "roller", "knife" or "flat"
    radius: float | None  # of a roller, mm
    closure: str  # "force", "groove" or "conjugate"
    at: str = "tip"  # point of the follower: a roller's centre, an edge, a place on a face
    tip_clearance: float = 0.0  # of a pair, mm at each tip
    face_width: float | None = None  # of a flat face, mm; None: as wide as it is touched
    limits: CamLimits = CamLimits()
    face_offset: float = 0.0  # of a flat face that swings, mm ahead of its pivot
    advice: Advice | None = None  # in the words of the spec; None: those of a linkage


@dataclass(frozen=True)
class Wheel:
    """A disc on a link's shaft."""

    level: str  # its name there
    link: str
    radius: float  # mm, the greatest
    about: str  # what it is, for messages
    high: float | None = None  # mm, its thickness; None: that of the link's wheels


@dataclass(frozen=True)
class Roller:
    """A ring that turns on a pin of a link, on the level of a wheel that it touches."""

    level: str
    joint: str  # in which it presses on a wheel
    link: str  # that carries it
    point: str  # of that link
    radius: float  # mm
    wheel: Wheel
    about: str  # what it touches, for messages
    hung: bool = False  # whether it hangs under its link
    own: str = ""  # its name where that is not its level's
    down: bool = False  # whether it reaches down to its link where its level lies higher

    @property
    def part(self) -> str:
        """Name of its part."""
        return f"roller-{self.own or self.level}"


@dataclass(frozen=True)
class Tip:
    """A cam that a follower's tip runs on. A knife or a face is a part of the follower's own band, so it has its level."""

    level: str
    joint: m.Cam
    cam: DiscCam[Any]
    point: str  # of the follower
    leaves: Literal[1, -1]  # the sense of the follower that takes it off
    name: str  # of its parts
    ridden: Ridden
    rim: float  # how much further a groove's plates reach than its follower's way, mm
    second: bool  # of a conjugate pair

    @property
    def radius(self) -> float:
        """Of its roller, mm; 0 without one."""
        return self.ridden.radius or 0.0

    @property
    def closure(self) -> str:
        """As in [[cam]]."""
        return self.ridden.closure

    @property
    def shape(self) -> str:
        """As in [[cam]]."""
        return self.ridden.shape

    @property
    def grooved(self) -> bool:
        """Whether it runs in a groove, between an inner and an outer plate on a back plate."""
        return self.closure == "groove"

    @property
    def hung(self) -> bool:
        """Whether its roller hangs under the follower: the second one of a pair, whose pin passes beside no cam."""
        return self.second

    @property
    def rolls(self) -> bool:
        """Whether it has a roller."""
        return self.shape == "roller"

    @property
    def roller(self) -> Roller:
        """Where it rolls."""
        about = self.wheel.about
        link = self.joint.follower
        name = self.joint.name
        return Roller(self.level, name, link, self.point, self.radius, self.wheel, about, self.hung)

    def face(self) -> tuple[float, float]:
        """Ends of a face, mm to the left of its normal from its point, or from the hinge."""
        low, high = self.cam.face_contact
        width = self.ridden.face_width
        if width is None:
            return low - _BESIDE, high + _BESIDE
        middle = 0.0 if self.joint.slide is not None else (low + high) / 2
        return middle - width / 2, middle + width / 2

    def away(self, start: float) -> complex:
        """Unit direction off the cam at its point, in the follower's axes; start: angle of these as drawn, rad."""
        follower = self.cam.follower
        if self.joint.slide is not None:
            found = self.leaves * follower.along
        else:
            found = follower.facing if self.shape == "flat" else complex(follower.trace(0.0))
        return complex(found / abs(found) * cmath.exp(-1j * start))

    def nose(self, start: float, size: float) -> list[tuple[complex, float]]:
        """Discs whose hull is a knife or face that slides, or that carry a knife that swings, about its point.

        start: angle of the follower's axes as drawn, rad; size: radius of the discs, mm.
        """
        away = self.away(start)
        if self.shape == "flat":
            return [((1j * place + size) * away, size) for place in self.face()]
        return [*([(0j, 0.0)] if self.joint.slide is not None else []), (NOSE * size * away, size)]

    @property
    def turn(self) -> complex:
        """Of the cam as drawn at theta = 0 to the axes of its link, unit complex."""
        return cmath.exp(-1j * self.joint.phase)

    @cached_property
    def wheel(self) -> Wheel:
        """Its disc, or what a groove's plates cover."""
        reach = peak(self.cam.profile(_ROUND))
        if self.grooved:
            reach += 2 * self.radius + self.rim
        return Wheel(self.level, self.joint.cam, reach, f"cam {self.joint.name}")


@dataclass(frozen=True)
class PlateTip:
    """A plate that slides, and the roller that runs on its edge. The plate is its link, so it has that one's level."""

    joint: m.Cam
    cam: LinearCam  # on the ground at theta = 0
    pose: m.Pose  # of the plate's link there
    point: str  # of the follower
    ridden: Ridden

    @property
    def level(self) -> str:
        """Its link's."""
        return self.joint.cam

    @property
    def way(self) -> tuple[float, float]:
        """From where to where its program runs, mm from its drawn place."""
        assert isinstance(self.joint.law, CarriedLaw)
        ways = self.joint.law.program.joints
        return float(ways[0]), float(ways[-1])

    def touched(self, travel: complex) -> m.Cam:
        """The joint with what touches it; travel: of its link, unit vector of the ground."""
        sense = 1 if (self.cam.follower.travel * travel.conjugate()).real > 0 else -1
        turn = cmath.exp(-1j * self.pose.angle)
        touch = PlateTouch(self.cam, sense, turn, -self.pose.place * turn)
        return replace(self.joint, touches=(touch,), leaves=self.cam.follower.leaves)

    @property
    def roller(self) -> Roller:
        """Where it rolls."""
        about = f"plate {self.joint.name}"
        wheel = Wheel(self.level, self.joint.cam, 0.0, about)
        name = level_of(self.joint.name)
        radius = self.ridden.radius or 0.0
        return Roller(
            self.level,
            self.joint.name,
            self.joint.follower,
            self.point,
            radius,
            wheel,
            about,
            own=name,
        )

    @property
    def onward(self) -> complex:
        """Unit vector of the ground along which its edge runs, what rolls on it to the left."""
        return -self.cam.follower.travel

    def places(self, onward: complex) -> Points:
        """Places of its edge in a frame of the ground whose real axis is onward, (n,) mm."""
        low, high = self.cam.range
        theta = np.linspace(low, high, _PLACES)
        return np.asarray(self.cam.follower.envelope(theta, self.cam.program, 0) / onward)

    def top(self, ends: float) -> tuple[Piece, ...]:
        """Its edge against onward, on the ground, so much straight on at both ends, mm."""
        cam = self.cam
        low, high = cam.range
        first, last = (
            complex(cam.follower.normal(np.array([t]), cam.program)[0])
            for t in (low + _INSIDE, high - _INSIDE)
        )
        left = start_point(cam.edge[0])
        right = end_point(cam.edge[-1])
        return (
            Line(right - 1j * last * ends, right),
            *(piece.reversed() for piece in reversed(cam.edge)),
            Line(left, left + 1j * first * ends),
        )


def plate_outline(
    tips: Sequence[PlateTip], held: Sequence[tuple[complex, float]], ends: float, deep: float
) -> Contour:
    """The edge of a plate in its link's axes, counter-clockwise: one track and a straight bottom, or a track on either side.

    ends: how far tracks go straight on, mm; deep: of a straight bottom below the track's lowest place, mm; held: discs in the
    link's axes that lie above it. DesignError where two tracks come nearer to each other than half of deep.
    """
    over = tips[0]
    onward = over.onward
    turn = cmath.exp(-1j * over.pose.angle)
    top = over.top(ends)
    right = start_point(top[0]) / onward
    left = end_point(top[-1]) / onward
    under: tuple[Piece, ...] = ()
    if len(tips) == 1:
        heights = [*over.places(onward).imag, right.imag, left.imag]
        discs = (((z / turn + over.pose.place) / onward).imag - radius for z, radius in held)
        bottom = min(min(heights) - deep - (max(heights) - min(heights)), *discs, math.inf)
        under = _lines(
            [left, complex(left.real, bottom), complex(right.real, bottom), right], onward
        )
    else:
        _check_web(tips, deep / 2)
        track = tips[1].top(ends)
        first = start_point(track[0]) / onward
        last = end_point(track[-1]) / onward
        begin = min(left.real, first.real)
        end = max(right.real, last.real)
        before = [left, complex(begin, left.imag), complex(begin, first.imag), first]
        after = [last, complex(end, last.imag), complex(end, right.imag), right]
        under = (*_lines(before, onward), *track, *_lines(after, onward))
    return Contour((*under, *top)).moved(turn, -over.pose.place * turn)


def _lines(corners: Sequence[complex], onward: complex) -> tuple[Piece, ...]:
    """Between corners in a frame of the ground whose real axis is onward."""
    apart = ((a, b) for a, b in pairwise(corners) if abs(b - a) > SAME_POINT)
    return tuple(Line(a * onward, b * onward) for a, b in apart)


def _check_web(tips: Sequence[PlateTip], least: float) -> None:
    """DesignError where less is left between two tracks than least, mm, wherever both lie along the plate."""
    onward = tips[0].onward
    upper, lower = (tip.places(onward) for tip in tips)
    web = float(np.min(upper.imag)) - float(np.max(lower.imag))
    if web < least:
        where = f"link {tips[0].level}, between {tips[0].joint.name} and {tips[1].joint.name}"
        remedy = "draw both followers further from each other, or make less lift"
        raise DesignError("thickness of the plate", web, least, "mm", where, remedy)


def pivot(machine: m.Machine, link: str) -> tuple[complex, complex]:
    """Where a link turns on the ground: in its axes and on the ground, mm."""
    for joint in machine.joints:
        if isinstance(joint, m.Pin) and {joint.a.body, joint.b.body} == {m.GROUND, link}:
            return (joint.a.at, joint.b.at) if joint.a.body == link else (joint.b.at, joint.a.at)
    remedy = "what carries a cam or gear turns on the ground"
    raise DesignError("pivots on the ground", 0, 1, "", f"link {link}", remedy)


def with_seconds(machine: m.Machine, cams: Mapping[str, Ridden]) -> m.Machine:
    """The machine with a further point on each follower of a conjugate pair, where its second roller sits."""
    bodies = {body.name: body for body in machine.bodies}
    for name, spec in cams.items():
        joint = machine.cam(name)
        if spec.closure == "conjugate" and spec.shape == "roller":
            place = _second(machine, joint, spec)
            body = bodies[joint.follower]
            bodies[body.name] = replace(body, points={**body.points, spec.at + SECOND: place})
    return replace(machine, bodies=tuple(bodies[body.name] for body in machine.bodies))


def _second(machine: m.Machine, joint: m.Cam, spec: Ridden) -> complex:
    """Place of the second roller on the follower: as near to the shaft when it is out as the first is when it is in."""
    law = joint.law
    body = machine.body(joint.follower)
    assert isinstance(law, CamLaw)
    top = law.highest
    first = follower_of(machine, joint, spec, spec.at, 1)
    if joint.slide is not None:
        slide = machine.slide(joint.slide)
        assert isinstance(slide, m.Slide) and isinstance(first, SlidingTip)
        way = law.sign * first.along
        shift = (2 * (first.start / way).real + top) * way
        return complex(body.points[spec.at]) - shift * cmath.exp(-1j * slide.turn)
    assert isinstance(first, SwingingArm)
    mirrored = (first.arm / first.pivot).conjugate() * first.pivot * cmath.exp(-1j * law.sign * top)
    return pivot(machine, joint.follower)[0] + mirrored * cmath.exp(-1j * joint.rest)


def follower_of(
    machine: m.Machine, joint: m.Cam, spec: Ridden, point: str, leaves: Literal[1, -1]
) -> Follower:
    """What touches the cam, about the cam's axis, as drawn."""
    at = complex(machine.body(joint.follower).points[point])
    centre = 0j if joint.over is not None else pivot(machine, joint.cam)[1]
    radius = spec.radius or 0.0
    if joint.slide is not None:
        slide = machine.slide(joint.slide)
        assert isinstance(slide, m.Slide)
        way = cmath.exp(1j * slide.angle)
        tip = cmath.exp(1j * slide.turn) * (at - slide.runner.at)
        start = slide.guide.at + way * joint.rest + tip - centre
        if spec.shape == "flat":
            return SlidingFace(start, way, leaves)
        return SlidingTip(start, way, radius, leaves)
    own, hinge = pivot(machine, joint.follower)
    arm = cmath.exp(1j * joint.rest) * (at - own)
    far = hinge - centre
    if spec.shape == "flat":
        ahead = spec.face_offset
        along = math.sqrt(max(0.0, abs(arm) ** 2 - ahead**2))
        ways = [arm / complex(ahead, side * along) for side in (-1, 1)]
        facing = max(ways, key=lambda way: (way.conjugate() * (far + arm)).real)
        return SwingingFace(far, facing / abs(facing), ahead)
    return SwingingArm(far, arm, radius, leaves)


@lru_cache(32)
def _worked_out(cam: DiscCam[Any]) -> DiscCam[Any]:
    """The first cam that was equal to this one, whose outline may be known: variants of a spec share most of their cams."""
    return cam


def tips(
    machine: m.Machine, cams: Mapping[str, Ridden], sizes: Parts, clearance: float
) -> list[Tip]:
    """What runs on each cam; of a conjugate pair both. clearance: of a groove, mm."""
    made = []
    rim = groove_rim(sizes) + clearance
    for name, spec in cams.items():
        joint = machine.cam(name)
        assert isinstance(joint.law, CamLaw)
        if joint.over is not None:
            continue
        senses: tuple[Literal[1, -1], ...] = (1, -1) if joint.law.sign > 0 else (-1, 1)
        two = spec.closure == "conjugate" and spec.shape == "roller"
        for leaves, suffix in zip(senses, ("", SECOND)[: 1 + two], strict=False):
            key = level_of(name) + suffix
            point = spec.at + suffix
            follower = follower_of(machine, joint, spec, point, leaves)
            if isinstance(follower, FlatFace) and follower.leaves != leaves:
                remedy = "draw `at` on the cam's side of the hinge"
                where = f"cam {name}"
                raise DesignError("side of the face", follower.leaves, leaves, "", where, remedy)
            cam = _worked_out(DiscCam(joint.law.signed, follower, spec.tip_clearance))
            level = key if spec.shape == "roller" else joint.follower
            made.append(Tip(level, joint, cam, point, leaves, key, spec, rim, bool(suffix)))
    return made


def plate_of(machine: m.Machine, joint: m.Cam, spec: Ridden) -> LinearCam:
    """The edge of a plate as it lies at theta = 0, on the ground; DesignError where it cannot be made."""
    assert isinstance(joint.law, CarriedLaw) and joint.over is not None
    carrier = machine.slide(joint.over)
    sign: Literal[1, -1] = 1 if joint.leaves > 0 else -1
    follower = follower_of(machine, joint, spec, spec.at, sign)
    kind = PlateArm if joint.slide is None else PlateSlide
    seen = kind(**vars(follower), travel=cmath.exp(1j * carrier.angle))
    with naming(f"cam {joint.name}"):
        cam = seen_from_left(over_way(joint.law.signed, seen))
        cam.edge  # noqa: B018  refuses what is no edge
    return cam


def plates(machine: m.Machine, cams: Mapping[str, Ridden]) -> list[PlateTip]:
    """Cams that slide, and what runs on them; DesignError of a second one on the same side of its plate."""
    made: list[PlateTip] = []
    for name, spec in cams.items():
        joint = machine.cam(name)
        if joint.over is None:
            continue
        cam = plate_of(machine, joint, spec)
        plate = PlateTip(joint, cam, machine.start_of(joint.cam), spec.at, spec)
        same = [
            tip
            for tip in made
            if tip.joint.cam == joint.cam and (tip.onward / plate.onward).real > 0
        ]
        if same:
            where = f"link {joint.cam}, under {same[0].joint.name} and {name}"
            remedy = "a plate has a track on either side: draw one of the followers on the other side, or leave it out"
            raise DesignError("tracks on one side of a plate", 2, 1, "", where, remedy)
        made.append(plate)
    return made


def plate_limits(tips: Iterable[PlateTip]) -> list[Finding]:
    """What is judged of each plate's edge as designed."""
    findings = []
    for tip in tips:
        name = tip.joint.name
        assert isinstance(tip.joint.law, CarriedLaw)
        limits = tip.ridden.limits
        findings += edge_findings(tip.cam, limits, f"cam {name}", _FLATTER)
        law = over_way(tip.joint.law.program, tip.cam.follower).program
        findings += program_findings(
            law, unit_of(tip.cam), limits, _SMOOTHER, f"program of cam {name}"
        )
    return findings


def with_touches(joint: m.Cam, tips: Sequence[Tip], at: complex) -> m.Cam:
    """The joint with what touches it, unless it says so itself; at: its shaft on the cam's link, mm."""
    own = [tip for tip in tips if tip.joint.name == joint.name]
    if joint.touches or not own:
        return joint
    touches = [CamTouch(tip.cam, turn=tip.turn, at=at) for tip in own]
    touches += [CamTouch(tip.cam, outer=True, turn=tip.turn, at=at) for tip in own if tip.grooved]
    return replace(joint, touches=tuple(touches), leaves=own[0].leaves)


def limits(tips: Iterable[Tip]) -> list[Finding]:
    """What is judged of each cam as designed; DesignError names the cam where there is none."""
    findings = []
    for name, group in groupby(tips, lambda tip: tip.joint.name):
        own = list(group)
        ridden = own[0].ridden
        cams = [exact(tip) for tip in own]
        findings += cam_findings(cams, ridden.limits, f"program of cam {name}", ridden.face_width)
    return findings


def exact(tip: Tip) -> ExactCam:
    """A cam as designed."""
    outline(tip)
    worst, _ = tip.cam.greatest(tip.cam.pressure_angle)
    further = "a follower drawn further from the shaft"
    flatter = f"largest at cam angle {math.degrees(worst):.2f} deg; {further}, or a longer span,"
    second = ", second of the pair" if tip.second else ""
    usual = Advice(flatter, f"{further}, or a smaller radius,")
    return ExactCam(f"cam {tip.joint.name}{second}", tip.cam, tip.ridden.advice or usual)


def outline(tip: Tip) -> Contour:
    """The cam's outline as drawn at theta = 0; DesignError names the cam where there is none."""
    with naming(f"cam {tip.joint.name}"):
        return tip.cam.outline


def groove_wall(tip: Tip, clearance: float) -> Contour | None:
    """The outer wall of a groove; None where the follower is held otherwise."""
    if not tip.grooved:
        return None
    with naming(f"cam {tip.joint.name}"):
        return tip.cam.groove(clearance)


def groove_rim(sizes: Parts) -> float:
    """Width of a groove's outer ring, mm: room for the pins that hold it on its back plate."""
    return sizes.pin_diameter + 2 * sizes.wall


@contextmanager
def naming(thing: str, remedy: str = "") -> Iterator[None]:
    """A DesignError inside is one of a named thing; remedy: another one."""
    try:
        yield
    except DesignError as error:
        where = thing + (f", {error.where}" if error.where else "")
        facts = error.quantity, error.value, error.limit, error.unit
        named = DesignError(*facts, where, remedy or error.remedy)
        own = error.sentence != DesignError(*facts, error.where, error.remedy).sentence
        raise (named.saying(f"{thing}: {error.sentence}") if own else named) from None


@dataclass(frozen=True)
class EdgeDrive(ABC):
    """Two parts of a machine, on their links' shafts and on one level, of which one drives the other by its edge."""

    joint: m.Cam
    wish: Any  # what is asked of both
    hub: float  # radius of a boss round a shaft, mm
    kind: ClassVar[str]  # its table in a spec
    remedy: ClassVar[str]  # where one of both has no room

    @property
    def links(self) -> tuple[str, str]:
        """What drives and what is driven."""
        return self.joint.cam, self.joint.follower

    def line(self, machine: m.Machine) -> complex:
        """From the axis of what drives to that of what is driven, on the ground as drawn, unit complex."""
        a, b = (pivot(machine, link)[1] for link in self.links)
        return (b - a) / abs(b - a)

    @property
    @abstractmethod
    def wheels(self) -> Sequence[Wheel]:
        """Both on their shafts; none of those that dowels hold."""

    @abstractmethod
    def edges(self, machine: m.Machine) -> tuple[Contour, Contour]:
        """Of both about their axes, as drawn at theta = 0."""

    @abstractmethod
    def table(self, link: str) -> tuple[str, ...]:
        """Data of one of both as a workshop reads them beside its drawing."""

    @property
    def level(self) -> str:
        """Of all its parts."""
        return level_of(self.joint.name)

    @property
    def thing(self) -> str:
        """What it is in messages."""
        return f"{self.kind} {self.joint.name}"

    def part_on(self, link: str) -> str:
        """Name of the part on the shaft of one of its links."""
        return f"wheel-{self.level}-{link}"
