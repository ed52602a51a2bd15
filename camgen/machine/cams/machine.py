"""A cam and its follower as a machine: bodies, joints, what loads the follower, and the spring that keeps it on the cam.

    lift     how far the follower is from its place nearest to the cam, in the sense that takes it off: rad or mm
    effort   what the cam must exert on the follower in the sense of the lift: N m or N; where it is negative nothing that
             the cam does keeps contact

The cam turns about the origin, the follower about its pivot or along its slide; its frame is where s = 0 has it, turned or
shifted by s.
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any, Literal

import numpy as np

from camgen.findings import Finding, Where
from camgen.machine.cams.followers import SlidingFace, SlidingTip, SwingingArm, SwingingFace
from camgen.machine.cams.limits import CamLimits, swings
from camgen.machine.cams.profile import DiscCam
from camgen.machine.cams.shoes import Shoe, SlidingShoe, SwingingShoe
from camgen.machine.features import CamOutline, Edge, Eye, Flat, NominalCam
from camgen.machine.forces import Forces
from camgen.machine.model import (
    GROUND,
    MM,
    Along,
    Angle,
    Body,
    Cam,
    Drive,
    Joint,
    Machine,
    Output,
    Pin,
    Place,
    Pose,
    Resistance,
    Slide,
)
from camgen.machine.run import solve
from camgen.motion.program import Program
from camgen.numerics import Floats, Points, distinct, magnitude

SHOE = "shoe"  # the part with a follower's own outline
ROUNDING = 1e-12  # share of the greatest effort below which a spring that is needed is none


@dataclass(frozen=True)
class CamTouch:
    """Where a cam is touched, on a body on which it stands turned and shifted: body = at + turn * cam.

    outer: on the outer wall of its groove, on the far side of the round tip; mirrored: by a second follower, mirrored in the
    line of centres, on the same cam turned over: the first at pi - theta. For that s(pi - theta) = -s(theta), as a uniform
    swing has it.
    """

    cam: DiscCam[Any]
    outer: bool = False
    mirrored: bool = False
    turn: complex = 1 + 0j
    at: complex = 0j

    def __call__(self, theta: Floats) -> tuple[Points, Points]:
        """Place, complex mm, and unit normal into the follower at cam angles theta, (n,) rad."""
        theta = math.pi - theta if self.mirrored else theta
        place = self.cam.profile(theta)
        normal = self.cam.follower.normal(theta, self.cam.program)
        if self.outer:
            place = place + 2 * self.cam.tip.tip_radius * normal
            normal = -normal
        if self.mirrored:
            place = -np.conj(place)
            normal = -np.conj(normal)
        return self.at + self.turn * place, self.turn * normal

    def radius(self, theta: Floats) -> Floats:
        """Radius of curvature there, mm, above 0 where it is convex, (n,): a groove's outer wall is a hollow then."""
        radius = self.cam.radius(math.pi - theta if self.mirrored else theta)
        return -(radius + 2 * self.cam.tip.tip_radius) if self.outer else radius

    def way(self, theta: Floats) -> Points:
        """Unit direction in which the follower moves as s grows, (n,) complex."""
        theta = math.pi - theta if self.mirrored else theta
        turned = np.exp(1j * theta)
        place = self.cam.profile(theta) * turned
        way = self.cam.follower.velocity(self.cam.program(theta), place) / turned
        way = -np.conj(way) if self.mirrored else way
        return np.asarray(self.turn * way / np.abs(way))

    def across(self, theta: Floats) -> Floats:
        """Radius of the follower where it touches, mm, (n,): 0 of an edge, inf of a flat face."""
        follower = self.cam.follower
        if isinstance(follower, Shoe):
            return follower.own_radius(theta, self.cam.program)
        return np.full(np.shape(theta), getattr(follower, "tip_radius", math.inf))


@dataclass(frozen=True)
class FollowerLoad:
    """What the follower is and bears, in N, mm, s on a slide and N m, rad, s on an arm.

    inertia: kg, or kg m^2 about the pivot; damping; rate: of a spring that presses it on the cam; preload: of that spring
    at lift 0; resistance: a constant one against the lift.
    """

    inertia: float = 0.0
    damping: float = 0.0
    rate: float = 0.0
    preload: float = 0.0
    resistance: float = 0.0


def cam_machine(
    cams: Sequence[DiscCam[Any]],
    speed: float,
    load: FollowerLoad | None = None,
    closure: Literal["form", "force"] = "form",
    touches: Sequence[Any] = (),
    friction: float = 0.0,
) -> Machine:
    """Cam ("cam"), follower ("follower") and ground; joints "shaft", "pivot" or "guide", and "contact".

    cams: the one that drives outwards, then a second one that drives back. speed: rad/s. touches: how the cams are touched,
    where it is not each by its own follower. The output is "lift" of a follower that slides, mm, "swing" of one on an arm, rad.
    """
    touch = tuple(touches) or tuple(CamTouch(each) for each in cams)
    contact = Cam(
        "contact",
        "cam",
        "follower",
        cams[0].program,
        closure=closure,
        leaves=cams[0].follower.leaves,
        touches=touch,
        friction=friction,
    )
    return contact_machine(contact, cams[0].follower, speed, load)


def contact_machine(
    contact: Cam, follower: Any, speed: float, load: FollowerLoad | None = None
) -> Machine:
    """The same of a contact between "cam" and "follower", whose law is a program; follower: how it is guided."""
    program: Any = contact.law
    load = load or FollowerLoad()
    start = float(program(np.zeros(1))[0])
    body: Body
    held: Joint
    of: Angle | Along
    slide: str | None = None
    match follower:
        case (
            SlidingTip(start=rest, along=along)
            | SlidingFace(start=rest, along=along)
            | SlidingShoe(start=rest, along=along)
        ):
            body = Body("follower", {"tip": rest}, load.inertia, rest)
            of = Along("guide")
            slide = "guide"
            held = Slide(
                "guide", Place(GROUND, rest), body.at("tip"), math.atan2(along.imag, along.real)
            )
            pose = Pose(along * start, 0.0)
            unit = "mm"
        case SwingingArm() | SwingingFace() | SwingingShoe():
            body = Body("follower", {"pivot": 0j}, inertia=load.inertia)
            of = Angle("follower")
            held = Pin("pivot", body.at("pivot"), Place(GROUND, follower.pivot))
            pose = Pose(follower.pivot, start)
            unit = "rad"
        case _:
            raise TypeError(f"no machine for {type(follower).__name__}")
    lowest = follower.leaves * float(np.min(follower.leaves * program(_turn(program))))
    wound = load.rate * lowest - follower.leaves * load.preload
    force = wound - follower.leaves * load.resistance
    loads = (
        (Resistance("load", of, force, load.rate, load.damping, wound=wound),)
        if load.damping or load.rate or force
        else ()
    )
    return Machine(
        (Body(GROUND), Body("cam"), body),
        (Pin("shaft", Place("cam"), Place(GROUND)), held, replace(contact, slide=slide)),
        (Drive("motor", "cam"),),
        {"cam": Pose(0j, 0.0), "follower": pose},
        loads,
        (Output("lift" if slide else "swing", of, unit),),
        speed,
    )


def nominal_cam(cam: DiscCam[Any], limits: CamLimits, outer: bool = False) -> NominalCam:
    """What a cam's exact outline gives, and what of it is accepted; outer: of the outer wall of its groove."""
    match cam.follower:
        case SwingingArm(_, arm):
            lever = abs(arm) * math.cos(math.radians(cam.steepest))
        case SwingingFace():
            lever = min(map(abs, cam.face_contact))
        case SwingingShoe():
            lever = -cam.greatest(partial(_lever_below, cam))[1]
        case _:
            lever = math.cos(math.radians(cam.steepest))
    given = cam.reachable if cam.undercuts and not outer else None
    return NominalCam(given, lever, limits.ripple, limits.undercut)


def _lever_below(cam: DiscCam[Any], theta: Any) -> Floats:
    """Way of the follower's touched point along the normal for 1 of its s, below 0, (n,)."""
    turn = np.exp(1j * np.asarray(theta))
    way = cam.follower.velocity(cam.program(theta), cam.profile(theta) * turn)
    normal = cam.follower.normal(theta, cam.program) * turn
    return np.asarray(-np.abs(np.real(np.conj(normal) * way)))


def cam_outline(
    cam: DiscCam[Any],
    part: str,
    limits: CamLimits,
    bore: float | None = None,
    width: float | None = None,
    free: float | None = None,
) -> CamOutline:
    """What of a part is measured for "contact" in a machine made by `cam_machine`.

    bore: diameter of the part's own hole on the shaft, mm. width: of a flat face, mm, None without an end. free: the part's
    largest hole is the outer wall of a groove that is so much wider than the tip, mm; None: the part is the cam itself.
    """
    follower = cam.follower
    tip: Eye | Flat | Edge
    match follower:
        case SwingingArm():
            tip = Eye(None, follower.arm, 2 * follower.tip_radius)
        case SwingingFace():
            at = follower.facing * complex(follower.ahead, sum(cam.face_contact) / 2)
            tip = Flat(None, at, cmath.phase(-follower.facing), width or math.inf)
        case Shoe():
            tip = Edge(SHOE, Eye(SHOE, 0j, 0.0))
        case SlidingTip():
            tip = Eye(None, follower.start, 2 * follower.tip_radius)
        case _:
            tip = Flat(
                None,
                follower.start,
                cmath.phase(-follower.leaves * follower.along),
                width or math.inf,
            )
    outer = free is not None
    return CamOutline(
        "contact",
        part,
        "shaft",
        "pivot" if swings(cam) else None,
        tip,
        leaves=follower.leaves,
        inside=outer,
        free=cam.air if free is None else free,
        bore=None if bore is None else Eye(part, 0j, bore),
        nominal=nominal_cam(cam, limits, outer),
    )


def _turn(program: Any) -> Floats:
    """Angles among which the lowest place is."""
    return distinct(np.linspace(0, math.tau, 1441), program.breaks)


@dataclass(frozen=True)
class Loaded:
    """A loaded cam over its turn, (n,) each: theta rad; lift rad or mm, and the effort in its sense, N m or N.

    force: between cam and follower, N, below 0 where it would have to pull; torque: that drives the cam, N m. Both are nan
    where the follower rides on the corner of an undercut, inf where friction jams it. kick: greatest impulse that a jump of
    the speed gives the follower, N m s or N s.
    """

    theta: Floats
    lift: Floats
    effort: Floats
    force: Floats
    torque: Floats
    kick: float
    forces: Forces
    where: Where = Where()  # how its places are told

    def spring_needed(self, load: FollowerLoad, reserve: float = 0.0) -> tuple[float, float]:
        """Preload, or else rate, beyond which the effort is above a share of the spring's own all over the turn, the other one as
        loaded; not below 0.

        inf where none keeps contact.
        """
        if self.kick:
            return math.inf, math.inf
        spring = load.preload + load.rate * self.lift
        more = (reserve * spring - self.effort) / (1 - reserve)  # preload that is missing
        missing = load.rate * self.lift + more
        rounding = ROUNDING * magnitude(self.effort)
        short = missing >= -rounding
        least = load.preload + float(np.max(more))
        least = least if least > rounding else 0.0
        if not np.any(short):
            return least, 0.0
        low = self.lift[short]
        return least, max(0.0, float(np.max(missing[short] / low))) if np.all(low > 0) else math.inf

    def keeps_contact(self, remedy: str) -> Finding:
        """Finding LIFT_OFF: whether the least contact force, N, stays above 0; a kick throws the follower off."""
        return keeps_contact(self.theta, self.force, bool(self.kick), self.where, remedy)


def keeps_contact(theta: Floats, force: Floats, kicked: bool, where: Where, remedy: str) -> Finding:
    """Finding LIFT_OFF of one contact; theta: rad, force: N, (n,) each, nan where it is not known."""
    force = np.where(np.isnan(force), math.inf, force)
    if kicked:
        force[len(force) // 2] = -math.inf
    said = f"{remedy[:1].lower()}{remedy[1:]}"
    return lift_off(theta, force, "N", where, "the follower stays on the cam", said)


def lift_off(
    theta: Floats, push: Floats, unit: str, where: Where, kept: str, remedy: str
) -> Finding:
    """Finding LIFT_OFF: what presses a follower on its cam, (n,) in its unit, must stay above 0; at 0 nothing presses.

    kept: what is said where it stays there.
    """
    k = int(np.argmin(push))
    least = float(push[k])
    rounding = ROUNDING * float(np.max(np.abs(push), where=np.isfinite(push), initial=0.0))
    message = kept
    if least < -rounding:
        message = f"the follower leaves the cam; {remedy}"
    elif least <= rounding:
        idle = np.flatnonzero(push <= rounding)
        stretches = np.split(idle, np.flatnonzero(np.diff(idle) > 1) + 1)
        k, last = max(
            ((each[0], each[-1]) for each in stretches),
            key=lambda ends: theta[ends[1]] - theta[ends[0]],
        )
        begin, end = np.degrees(theta[[k, last]])
        there = f"from {begin:.1f} to {end:.1f} {where.unit}" if end > begin else "there"
        message = f"no force presses the follower on the cam {there}; {remedy}"
    place = replace(where, theta=float(theta[k]), digits=1)
    return Finding(
        "LIFT_OFF", least > rounding, least, 0.0, unit, place, message, floor=True, strict=True
    )


def loaded(machine: Machine, cam: DiscCam[Any], load: FollowerLoad, theta: Floats) -> Loaded:
    """Forces at cam angles that reach the lowest place."""
    found = solve(machine, theta).forces()
    leaves = cam.follower.leaves
    lift = leaves * cam.program(theta)
    riding = np.array([cam.riding(angle) for angle in theta])
    force, torque = found.pressing["contact"], *found.drives.values()
    force, torque = (
        np.where(riding, math.nan, values)
        for values in (force, np.where(np.isinf(force), math.inf, torque))
    )
    effort = leaves * found.contacts["contact"]
    kick = kick_of(cam.program, load, machine.speed, swings(cam))
    return Loaded(theta, lift - np.min(lift), effort, force, torque, kick, found)


def kick_of(program: Program, load: FollowerLoad, speed: float, swings: bool) -> float:
    """Greatest impulse that a jump of the speed gives a follower, N m s of an arm, else N s; speed: of the cam, rad/s."""
    jumps = [abs(jump.size) for jump in program.discontinuities(1) if jump.order == 1]
    unit = 1.0 if swings else MM
    return unit * load.inertia * abs(speed) * max(jumps, default=0.0)


def loaded_by(machine: Machine, theta: Floats, lift: Floats, lever: Floats) -> Loaded:
    """Forces of a follower without kick, from what is known of its contact.

    theta: (n,) rad. lift: of the follower there, mm or rad. lever: way along the contact's normal for each unit of the follower's,
    1 or m.
    """
    forces = solve(machine, theta).forces()
    effort = forces.contacts["contact"]
    (drive,) = forces.drives.values()
    return Loaded(theta, lift - np.min(lift), effort, effort / lever, drive, 0.0, forces)
