"""What a machine's contacts, teeth, pins and bearings bear at its speed: HERTZ, TOOTH_STRESS, PV, PIN_STRESS, BEARING_LIFE.

Reactions have the friction of the joints in them. Where no limit is published for a plastic, a finding fails
only beyond what every plastic bears, or beyond what the spec itself says; the table ranks all.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from camgen.findings import Finding, NotJudged, Where, at_least, at_most
from camgen.machine import strength
from camgen.machine.features import CamOutline, EngagedPair, GearTeeth
from camgen.machine.flywheel import mean_torque
from camgen.machine.forces import Forces
from camgen.machine.friction import circle
from camgen.machine.model import GROUND, MM, Cam, Pin, Slot
from camgen.machine.run import Run
from camgen.machines.loads.pins import STILL, PinLoad
from camgen.machines.loads.rubbing import coefficient
from camgen.machines.loads.tables import Weight
from camgen.numerics import Floats, magnitude
from camgen.parts import materials
from camgen.parts.assembly import Assembly
from camgen.parts.catalogue import BEARINGS, BRONZE_PV, CAM_FOLLOWERS, Bearing, CamFollower
from camgen.parts.journals import Journal, MaterialLimits, Post
from camgen.parts.wheels.geneva import GenevaLaw
from camgen.study import Figure, Plot, Table
from camgen.tolerances import SAME_POINT

_RATED = tuple(each.name for each in BEARINGS.values() if each.rating)


@dataclass
class LoadCheck:
    """Findings and figures of one kind of load."""

    findings: list[Finding] = field(default_factory=list)
    not_judged: list[NotJudged] = field(default_factory=list)
    figures: list[Figure] = field(default_factory=list)
    tables: list[Table] = field(default_factory=list)
    plots: list[Plot] = field(default_factory=list)
    pins: list[PinLoad] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)
    warnings: list[str] = field(default_factory=list)


@dataclass(frozen=True)
class BallLoad:
    """A rolling bearing at work."""

    joint: str
    bearing: Bearing | CamFollower
    force: Floats  # N, (n,) over theta
    turning: Any  # rad/s, (n,) or one number
    name: str = "ball bearing"


@dataclass(frozen=True)
class _PlainBearing:
    """A plain bearing at work, with the pin that runs in it."""

    journal: Journal
    pin: PinLoad
    slides: strength.Sliding

    @property
    def row(self) -> tuple[object, ...]:
        """In the order of `_PLAIN_HEADS`."""
        return (
            self.pin.name,
            self.journal.diameter,
            self.journal.length,
            self.pin.force,
            float(np.max(self.slides.pressure)),
            float(np.max(self.slides.speed)),
            self.slides.pv,
            self.slides.pv / materials.PV_MOST,
            self.slides.power,
            self.pin.bending,
            self.pin.shear,
        )

    def judge(self, check: LoadCheck, limit: float | None, friction: float) -> None:
        """PV; limit: MPa m/s, that the spec gives."""
        usual = BRONZE_PV if self.journal.bush else materials.PV_MOST
        hole = self.journal.hole
        if self.journal.bush and limit is None:
            limit = BRONZE_PV
        if limit is None and not materials.of(hole).printed:
            why = f"{self.slides.pv:.3g} MPa m/s in {self.journal.joint}; the limit of {hole} depends on the oil and on the shaft"
            check.not_judged.append(NotJudged("PV", why, "limits.pv_mpa_m_s"))
            return
        made, how = "a plastic made for bearings", "dry"
        if self.journal.bush:
            made, how = "a bush of bronze", "with oil or grease"
        heat = float(f"{self.slides.power:.2g}")
        remark = f"{heat:g} W of heat at a friction of {friction:g}"
        remark += (
            f"; the limit is limits.pv_mpa_m_s, and {made} bears {usual:g} {how}"
            if limit
            else f". No limit is published for prints of {hole}: this limit is that of a bearing plastic, dry on steel (iglidur "
            "P210). A lower speed, less mass or a longer pin lowers it. With oil the limit is five times as high, and with a metal bush higher "
            "still: set limits.pv_mpa_m_s"
        )
        size = f"{self.journal.diameter:g} x {self.journal.length:.4g} mm"
        where = Where(f"pin {self.journal.joint}, {size}", joint=self.journal.joint)
        check.findings.append(
            at_most("PV", self.slides.pv, limit or usual, "MPa m/s", where, remark)
        )


_PLAIN_HEADS = (
    "pin",
    "diameter, mm",
    "length, mm",
    "force, N",
    "pressure, MPa",
    "sliding, m/s",
    "p v, MPa m/s",
    f"over {materials.PV_MOST:g}",
    "heat, W",
    "bent, MPa",
    "sheared, MPa",
)


def plain_bearings(
    run: Run,
    forces: Forces,
    journals: Mapping[str, Journal],
    limits: Callable[[str], MaterialLimits],
    load: Weight | None = None,
) -> LoadCheck:
    """PV of the worst plain one, PIN_STRESS of every pin whose bearing is known, BEARING_LIFE of ball bearings, and a table.

    limits: what the spec says of a joint; load: of its friction.
    """
    check = LoadCheck()
    plain: list[_PlainBearing] = []
    for name, journal in journals.items():
        force, turning = _rubbing(run, forces, name, journal)
        pin = PinLoad(name, journal, float(np.max(force)), limits(name), not run.machine.loads)
        if pin.force > STILL:
            check.pins.append(pin)
            check.findings.append(pin.finding())
        if journal.ball is not None:
            ball = BallLoad(name, journal.ball, force, turning)
            bearing_life(check, ball, limits(name).bearing_life)
            continue
        friction = circle(1.0, coefficient(journal, load))
        slides = strength.sliding(force, turning, journal.diameter, journal.length, friction)
        plain.append(_PlainBearing(journal, pin, slides))
    if journals:
        heat = mean_torque(run.theta, _finite(forces.rubs))
        check.figures.append(Figure("friction heat", heat, "W"))
    if not plain:
        return check

    def share(each: _PlainBearing) -> float:
        usual = BRONZE_PV if each.journal.bush else materials.PV_MOST
        return each.slides.pv / (limits(each.journal.joint).pv or usual)

    worst = max(plain, key=share)
    worst.judge(check, limits(worst.journal.joint).pv, coefficient(worst.journal, load))
    plain.sort(key=lambda each: -each.slides.pv)
    title = "Plain bearings and pins, the hardest worked first"
    check.tables.append(Table(title, _PLAIN_HEADS, [each.row for each in plain]))
    check.figures.append(Figure("pv max", plain[0].slides.pv, "MPa m/s"))
    return check


def _rubbing(run: Run, forces: Forces, name: str, journal: Journal) -> tuple[Floats, Floats]:
    """Force in a pin or slot, N, and how fast what is in it turns there, rad/s, (n,) each."""
    joint = run.machine.joint(name)
    assert isinstance(joint, Pin | Slot)
    speed = run.machine.speed
    if isinstance(joint, Pin):
        turning = speed * (_rate(run, joint.a.body) - _rate(run, joint.b.body))
        return _finite(np.abs(forces.reactions[name])), turning
    normal = forces.normals[name]
    force = _finite(np.abs(normal)) * math.hypot(1.0, joint.friction)
    return force, speed * rubbing_in_slot(run, joint, normal, journal.diameter / 2)


def bent_posts(
    forces: Forces,
    posts: Sequence[Post],
    limits: Callable[[str], MaterialLimits],
    inertia_alone: bool,
) -> LoadCheck:
    """PIN_STRESS of pins that a spring or a cam's roller bends, by what bends each most.

    limits: what the spec says of a spring or joint; inertia_alone: whether nothing else loads the machine.
    """
    worst: dict[str, PinLoad] = {}
    for post in posts:
        force = post.pull
        if post.by in forces.pressing:
            force = magnitude(_finite(forces.pressing[post.by]))
        name = f"{post.name}, under {post.by}"
        journal = Journal(
            post.by,
            post.diameter,
            0.0,
            post.lever,
            post.material,
            "",
            part=post.part,
            role=post.role,
        )
        pin = PinLoad(name, journal, force, limits(post.by), inertia_alone and not post.pull)
        if force > STILL and (post.name not in worst or pin.stress > worst[post.name].stress):
            worst[post.name] = pin
    pins = list(worst.values())
    return LoadCheck([pin.finding() for pin in pins], pins=pins)


def contacts(run: Run, forces: Forces, assembly: Assembly, load: Weight | None) -> LoadCheck:
    """HERTZ of every cam that says how it is touched, and BEARING_LIFE of a roller.

    A tip that is no bearing is of the cam's own material.
    """
    check = LoadCheck()
    theta = run.theta
    named = None if load is None or load.cam_follower is None else CAM_FOLLOWERS[load.cam_follower]
    roller = assembly.follower.roller or named
    own = materials.of(assembly.process.material)
    tip = materials.STEEL if roller else own
    for joint in run.machine.joints:
        outline = assembly.outlines.get(joint.name)
        if not isinstance(joint, Cam) or not joint.touches or outline is None:
            continue
        force = _finite(forces.pressing[joint.name])
        limits = assembly.limits_of(joint.name)
        if not np.any(force > STILL):
            if np.any(force < -STILL):
                why = f"nothing presses the follower on its cam at {joint.name}: it leaves it"
                needs = "a spring or weight that keeps the follower on its cam"
                check.not_judged.append(NotJudged("HERTZ", why, needs))
            continue
        angle = run.argument(joint)[0]
        if np.any(joint.touches[0].across(angle) == 0):  # type: ignore[attr-defined]
            why = f"a knife edge touches at {joint.name}: it has no width, and no formula gives its pressure"
            check.not_judged.append(NotJudged("HERTZ", why, "a roller or a flat face"))
            continue
        part = assembly.by_name[outline.part]
        layer = part.drawn
        length = layer.z1 - layer.z0
        if named is not None:
            length = min(length, named.width)
        first = forces.contacts[joint.name] * joint.leaves >= 0
        pressure = np.zeros(len(theta))
        for k, touch in enumerate(joint.touches[:2]):
            touches = first == (k == 0) if len(joint.touches) > 1 else True
            radius = touch.radius(angle)  # type: ignore[attr-defined]
            across = touch.across(angle)  # type: ignore[attr-defined]
            with np.errstate(all="ignore"):
                curvature = np.where(
                    (radius > 0) | (radius < -across), 1 / radius + 1 / across, np.nan
                )
            line, _ = strength.line_contact(
                np.where(touches, force, 0.0), length, curvature, own.elastic, tip.elastic
            )
            pressure = np.fmax(pressure, line)
        worst = int(np.nanargmax(pressure))
        curve = [("line contact", np.degrees(theta), pressure)]
        title = f"Hertz pressure, {joint.name}"
        check.plots.append(Plot(title, assembly.cycle.label, "MPa", curve))
        where = Where(
            f"{joint.name}, {outline.part}",
            part=outline.part,
            joint=joint.name,
            theta=float(theta[worst]),
            digits=1,
        )
        said = (
            f"{force[worst]:.4g} N on a contact line of {length:.4g} mm, {tip.name} on {own.name}",
            "; the pressure is higher at the ends of the line, so round them",
        )
        _hertz(check, assembly, float(pressure[worst]), where, said)
        if roller is None:
            continue
        if roller is named and (misfit := _misfit(named, outline, joint)):
            check.not_judged.append(NotJudged("BEARING_LIFE", *misfit))
        else:  # it turns as far as the cam's profile is long
            profile, _ = joint.touches[0](angle)
            turns = float(np.sum(np.abs(np.diff(profile)))) / (math.pi * roller.outside)
            turning = turns * math.tau * run.machine.speed / float(np.ptp(theta))
            ball = BallLoad(joint.name, roller, force, turning, "roller")
            bearing_life(check, ball, limits.bearing_life)
    return check


def gears(run: Run, forces: Forces, assembly: Assembly) -> LoadCheck:
    """HERTZ of every pair of gears at the pitch point, and TOOTH_STRESS of the weaker wheel's root.

    One tooth bears all, at its tip: that a second pair shares it, and what a root's rounding adds, is left out.
    """
    check = LoadCheck()
    for feature in assembly.features:
        if not isinstance(feature, GearTeeth) or feature.implied is not None:
            continue
        torque = _finite(forces.gears[feature.joint])
        base = feature.b.radius * math.cos(feature.pressure)
        push = np.abs(torque) / MM / base
        k = int(np.argmax(push))
        force = float(push[k])
        if not force > STILL:
            continue
        layers = [assembly.by_name[each.part].drawn for each in (feature.a, feature.b)]
        width = min(layer.z1 - layer.z0 for layer in layers)
        weak = max((feature.a, feature.b), key=lambda each: each.bends)
        theta = float(run.theta[k])
        angle = assembly.cycle.name
        where = Where(part=weak.part, joint=feature.joint, theta=theta, angle=angle, digits=1)
        _tooth(check, assembly, force, force * weak.bends / width, where)
        own = materials.of(assembly.process.material)
        pressure = strength.line_contact(force, width, feature.curvature, own.elastic, own.elastic)
        said = f"{force:.4g} N at the pitch point, on teeth {width:.4g} mm wide, {own.name} on {own.name}"
        _hertz(check, assembly, float(pressure[0]), where, (said, ""))
    return check


def _tooth(check: LoadCheck, assembly: Assembly, force: float, stress: float, where: Where) -> None:
    """TOOTH_STRESS of the wheel at a place, MPa, by a force along the line of action, N."""
    check.figures.append(Figure("tooth stress {of}", stress, "MPa", where.joint))
    own = materials.of(assembly.process.material)
    asked = assembly.limits_of(where.joint).tooth_stress
    limit = asked or own.bears
    by = "limits.tooth_stress_mpa" if asked else f"{own.name} bears {own.bears:g} MPa repeatedly"
    remark = f"{force:.4g} N at the tip of a single tooth; {by}"
    if stress > limit:
        share = limit / stress
        remark += f"; {share:.2g} of the load holds, or fewer and larger teeth, or another material"
    check.findings.append(at_most("TOOTH_STRESS", stress, limit, "MPa", where, remark))


def _hertz(
    check: LoadCheck, assembly: Assembly, pressure: float, where: Where, said: tuple[str, str]
) -> None:
    """HERTZ of a part of the machine's own material at a joint, MPa; said: before and after what the limit is by."""
    own = materials.of(assembly.process.material)
    check.figures.append(Figure("hertz pressure {of}", pressure, "MPa", where.joint))
    limits = assembly.limits_of(where.joint)
    limit = limits.hertz or own.hertz
    if limit is None:
        why = f"{pressure:.4g} MPa at {where.joint}, and no limit is published for {own.name}"
        check.not_judged.append(NotJudged("HERTZ", why, "limits.hertz_mpa"))
        return
    by = "limits.hertz_mpa" if limits.hertz else own.hertz_source
    remark = f"{said[0]}; {by}{said[1]}"
    check.findings.append(at_most("HERTZ", pressure, limit, "MPa", where, remark))


def edge_forces(run: Run, forces: Forces, assembly: Assembly) -> dict[str, Floats]:
    """Of Geneva and cycloidal drives the force at a pin, N, (n,), by the joint.

    Of a Geneva drive that of its roller on a wall of the slot, 0 while the disc holds the wheel; of pins along lobes or in holes as
    if one alone held all, where its lever is least.
    """
    found = {}
    pairs = {each.joint: each for each in assembly.features if isinstance(each, EngagedPair)}
    for joint in run.machine.joints:
        pair = pairs.get(joint.name)
        if not isinstance(joint, Cam) or pair is None:
            continue
        torque = np.abs(_finite(forces.contacts[joint.name])) / MM
        if pair.tracks is not None:
            found[joint.name] = torque / pair.tracks.lever
        elif isinstance(joint.law, GenevaLaw):
            geneva = joint.law.geneva
            angle = _angle(run, joint.cam) - joint.phase
            lever = np.abs(geneva.distance + geneva.sense * geneva.crank * np.exp(1j * angle))
            drives = joint.law(angle, 1) != 0
            found[joint.name] = np.where(drives, torque / lever, 0.0)
    return found


def edges(run: Run, forces: Mapping[str, Floats], assembly: Assembly) -> LoadCheck:
    """HERTZ of the rollers of Geneva drives in their slots, and of cycloidal drives' pins; forces: N, of each joint."""
    check = LoadCheck()
    own = materials.of(assembly.process.material)
    for feature in assembly.features:
        if not isinstance(feature, EngagedPair) or feature.joint not in forces:
            continue
        k = int(np.argmax(forces[feature.joint]))
        force = float(forces[feature.joint][k])
        if not force > STILL:
            continue
        layers = [assembly.by_name[edge.part].drawn for edge in feature.edges]
        width = min(layer.z1 - layer.z0 for layer in layers)
        remark = f"{force:.4g} N on a contact line of {width:.4g} mm"
        if feature.tracks is not None:
            curvature = feature.tracks.curvature
            remark += ", as if one pin alone bore the whole load"
        else:
            joint = run.machine.cam(feature.joint)
            assert isinstance(joint.law, GenevaLaw)
            curvature = 1 / joint.law.geneva.pin
        pressure = strength.line_contact(force, width, curvature, own.elastic, own.elastic)
        part = feature.b[0].part
        where = Where(part=part, joint=feature.joint, theta=float(run.theta[k]), digits=1)
        said = f"{remark}, {own.name} on {own.name}"
        _hertz(check, assembly, float(pressure[0]), where, (said, ""))
    return check


def _misfit(follower: CamFollower, outline: CamOutline, joint: Cam) -> tuple[str, str] | None:
    """Why a bought cam follower cannot be the roller of a joint, and what would be right; None where it can."""
    if outline.roller is not None:
        why = f"the roller at {joint.name} is a made part, not a {follower.name}"
        return why, "no load.cam_follower, or cams alone"
    radius = float(np.max(joint.touches[0].across(np.zeros(1))))  # type: ignore[attr-defined]
    if abs(radius - follower.outside / 2) > SAME_POINT:
        why = f"{follower.name} has a radius of {follower.outside / 2:g} mm, the tip at {joint.name} {radius:g}"
        return why, f"a tip of {follower.outside / 2:g} mm, or another load.cam_follower"
    return None


def bearing_life(check: LoadCheck, load: BallLoad, least: float | None) -> None:
    """Put into a check BEARING_LIFE of a rolling bearing; one that goes to and fro wears by the way that it goes. least: limit of the spec, h."""
    bearing = load.bearing
    if not bearing.rating:
        if least is not None:
            why = f"{load.joint}: no load rating of the ball bearing {bearing.name} is known"
            needs = f"a bearing with a rating: {', '.join(_RATED)}"
            check.not_judged.append(NotJudged("BEARING_LIFE", why, needs))
        return
    turning = np.abs(load.turning) + np.zeros(len(load.force))
    mean = strength.mean_load(np.maximum(load.force, 0.0), turning, bearing.exponent)
    rate = float(np.mean(turning)) / math.tau
    turns = strength.bearing_life(1e3 * bearing.rating, mean, bearing.exponent)
    hours = min(turns / rate / 3600 if rate else math.inf, 1e9)
    check.figures.append(Figure("bearing life {joint}", hours, "h", joint=load.joint))
    if least is not None:
        remark = f"{bearing.name}, C = {bearing.rating:g} kN, under a mean of {mean:.4g} N; nine of ten reach it"
        where = Where(f"{load.name} of {load.joint}")
        check.findings.append(at_least("BEARING_LIFE", hours, least, "h", where, remark))


def rubbing_in_slot(run: Run, slot: Slot, normal: Floats, radius: float) -> Floats:
    """How fast the rim of a pin rubs on the wall that presses it, as a turning, rad for 1 rad of theta, (n,).

    It slides along and turns. normal: force of the wall, N, (n,); radius: of the pin, mm.
    """
    slides = run.length(slot.name)[1] / radius
    turns = _rate(run, slot.runner.body) - _rate(run, slot.guide.body)
    # pressed to the left of its way it bears on the wall to the right
    return np.asarray(slides + np.sign(normal) * turns)


def _rate(run: Run, body: str) -> Any:
    return 0.0 if body == GROUND else run.angle(body)[1]


def _angle(run: Run, body: str) -> Any:
    return np.zeros(len(run.theta)) if body == GROUND else run.angle(body)[0]


def _finite(values: Any) -> Floats:
    """Values with 0 where there is none."""
    return np.where(np.isfinite(values), values, 0.0)
