"""What a machine's contacts, pins and plain bearings bear at its speed: HERTZ, PV, PIN_STRESS, BEARING_LIFE.

Reactions have the friction of the joints in them. Where no limit is published for a plastic, a finding fails
only beyond what every plastic bears, or beyond what the spec itself says; the table ranks all.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from camgen.findings import Finding, NotJudged, Where, at_least, at_most
from camgen.machine import strength
from camgen.machine.flywheel import mean_torque
from camgen.machine.forces import Forces
from camgen.machine.friction import circle
from camgen.machine.model import GROUND, Cam, Pin, Slot
from camgen.machine.run import Run
from camgen.machines.loads.pins import STILL, Bent
from camgen.machines.loads.rubbing import coefficient
from camgen.machines.loads.tables import Weight
from camgen.numerics import Floats
from camgen.parts import materials
from camgen.parts.assembly import Assembly
from camgen.parts.catalogue import BEARINGS, Bearing
from camgen.parts.journals import Journal, MaterialLimits, Post
from camgen.study import Plot, Table

_RATED = tuple(each.name for each in BEARINGS.values() if each.rating)


@dataclass
class Borne:
    """What was found: for the report."""

    findings: list[Finding] = field(default_factory=list)
    numbers: dict[str, float] = field(default_factory=dict)
    tables: list[Table] = field(default_factory=list)
    plots: list[Plot] = field(default_factory=list)
    left: list[NotJudged] = field(default_factory=list)
    bent: list[Bent] = field(default_factory=list)


@dataclass(frozen=True)
class Rolling:
    """A ball bearing at work."""

    joint: str
    ball: Bearing
    force: Floats  # N, (n,) over theta
    turning: Any  # rad/s, (n,) or one number
    what: str = "ball bearing of "  # the joint


def plain_bearings(
    run: Run,
    forces: Forces,
    journals: Mapping[str, Journal],
    limits: Callable[[str], MaterialLimits],
    load: Weight | None = None,
) -> Borne:
    """PV of the worst plain one, PIN_STRESS of every pin whose bearing is known, BEARING_LIFE of ball bearings, and a table.

    limits: what the spec says of a joint; load: of its friction.
    """
    borne = Borne()
    speed = run.machine.speed
    rows = list[tuple[object, ...]]()
    usual = materials.PV_MOST
    found: list[tuple[float, Journal, strength.Sliding]] = []
    for name, journal in journals.items():
        joint = run.machine.joint(name)
        assert isinstance(joint, Pin | Slot)
        if isinstance(joint, Pin):
            force = _finite(np.abs(forces.reactions[name]))
            turning = speed * (_rate(run, joint.a.body) - _rate(run, joint.b.body))
        else:
            force = _finite(np.abs(forces.normals[name])) * math.hypot(1.0, joint.friction)
            turning = speed * rubbing_in_slot(
                run, joint, forces.normals[name], journal.diameter / 2
            )
        slides = strength.sliding(
            force,
            turning,
            journal.diameter,
            journal.length,
            circle(1.0, coefficient(journal, load)),
        )
        bent = float(np.max(strength.pin_bending(force, journal.lever, journal.diameter)))
        sheared = float(np.max(strength.pin_shear(force, journal.diameter)))
        pin = Bent(
            name,
            journal,
            float(np.max(force)),
            bent,
            sheared,
            limits(name),
            not run.machine.loads,
        )
        if pin.force > STILL:
            borne.bent.append(pin)
            borne.findings.append(pin.finding())
        if journal.ball is not None:
            rolling = Rolling(name, journal.ball, force, turning)
            _life(borne, rolling, limits(name).bearing_life)
            continue
        found.append((slides.pv, journal, slides))
        rows.append(
            (
                name,
                journal.diameter,
                journal.length,
                float(np.max(force)),
                float(np.max(slides.pressure)),
                float(np.max(slides.speed)),
                slides.pv,
                slides.pv / usual,
                slides.power,
                bent,
                sheared,
            )
        )
    borne.numbers |= (
        {"friction_heat_w": mean_torque(run.theta, _finite(forces.rubs))} if journals else {}
    )
    if not found:
        return borne
    pv, worst, slides = max(found, key=lambda each: each[0] / (limits(each[1].joint).pv or usual))
    given = limits(worst.joint).pv
    said = f"{slides.power:.3g} W of heat at a friction of {coefficient(worst, load):g}"
    said += (
        f"; limits.pv_mpa_m_s; a plastic made for bearings bears {usual:g} dry"
        if given
        else f"; no limit is published for prints of {worst.hole}: this one is of a plastic made for bearings, dry on steel (iglidur "
        "P210). Less speed or mass and a longer pin lower it; oil bears five times as much, a bush of metal more: say so by "
        "limits.pv_mpa_m_s"
    )
    size = f"{worst.diameter:g} x {worst.length:.4g} mm"
    where = Where(f"pin {worst.joint}, {size}", joint=worst.joint)
    borne.findings.append(at_most("PV", pv, given or usual, "MPa m/s", where, said))
    heads = (
        "pin",
        "diameter, mm",
        "length, mm",
        "force, N",
        "pressure, MPa",
        "sliding, m/s",
        "p v, MPa m/s",
        f"over {usual:g}",
        "heat, W",
        "bent, MPa",
        "sheared, MPa",
    )
    rows.sort(key=lambda row: -float(str(row[6])))
    borne.tables.append(Table("Plain bearings and pins, the hardest worked first", heads, rows))
    borne.numbers["pv_max_mpa_m_s"] = max(each[0] for each in found)
    return borne


def bent_posts(
    forces: Forces,
    posts: Sequence[Post],
    limits: Callable[[str], MaterialLimits],
    fast: bool = False,
) -> Borne:
    """PIN_STRESS of pins that a spring or a cam's roller bends, by what bends each most; fast: inertia alone loads them."""
    worst: dict[str, Bent] = {}
    for post in posts:
        pressed = forces.pressing.get(post.by)
        if not post.pull and pressed is None:
            continue
        force = post.pull if pressed is None else float(np.max(np.abs(_finite(pressed))))
        bent = float(strength.pin_bending(force, post.lever, post.diameter))
        sheared = float(strength.pin_shear(force, post.diameter))
        name = f"{post.name}, under {post.by}"
        journal = Journal(
            post.by, post.diameter, 0.0, post.lever, post.material, "", part=post.part
        )
        pin = Bent(name, journal, force, bent, sheared, limits(post.by), fast and not post.pull)
        if force > STILL and (post.name not in worst or pin.stress > worst[post.name].stress):
            worst[post.name] = pin
    return Borne([each.finding() for each in worst.values()], bent=list(worst.values()))


def contacts(run: Run, forces: Forces, assembly: Assembly) -> Borne:
    """HERTZ of every cam that says how it is touched, and BEARING_LIFE of a roller.

    A tip that is no bearing is of the cam's own plastic.
    """
    borne = Borne()
    theta = run.theta
    outlines = assembly.outlines
    parts = assembly.by_name
    roller = assembly.follower.roller
    own = materials.of(assembly.process.plastic)
    tip = materials.STEEL if roller else own
    for joint in run.machine.joints:
        outline = outlines.get(joint.name)
        if not isinstance(joint, Cam) or not joint.touches or outline is None:
            continue
        force = _finite(forces.pressing[joint.name])
        limits = assembly.limits_of(joint.name)
        if not np.any(force > STILL):
            if np.any(force < -STILL):
                why = f"nothing presses the follower on its cam at {joint.name}: it leaves it"
                borne.left.append(
                    NotJudged("HERTZ", why, "a spring or weight that keeps the follower on its cam")
                )
            continue
        if getattr(joint.touches[0].cam.follower, "tip_radius", math.inf) == 0:  # type: ignore[attr-defined]
            why = f"a knife edge touches at {joint.name}: it has no width, and no formula gives its pressure"
            borne.left.append(NotJudged("HERTZ", why, "a roller or a flat face"))
            continue
        layer = parts[outline.part].layers[parts[outline.part].cut]
        length = layer.z1 - layer.z0
        angle = _angle(run, joint.cam) - joint.phase
        effort = forces.contacts[joint.name] * joint.leaves
        pressure = np.zeros(len(theta))
        for k, touch in enumerate(joint.touches[:2]):
            mine = (
                (effort >= 0) == (k == 0) if len(joint.touches) > 1 else np.ones(len(theta), bool)
            )
            radius = touch.radius(angle)  # type: ignore[attr-defined]
            across = getattr(touch.cam.follower, "tip_radius", math.inf)  # type: ignore[attr-defined]
            with np.errstate(all="ignore"):
                curvature = np.where(
                    (radius > 0) | (radius < -across), 1 / radius + 1 / across, np.nan
                )
            pressed, _ = strength.line_contact(
                np.where(mine, force, 0.0), length, curvature, own.elastic, tip.elastic
            )
            pressure = np.fmax(pressure, pressed)
        worst = int(np.nanargmax(pressure))
        limit = limits.hertz or strength.YIELDS * materials.STRONGEST
        said = f"by {force[worst]:.4g} N on a line of {length:.4g} mm, {tip.name} on {own.name}; "
        said += (
            "limits.hertz_mpa"
            if limits.hertz
            else f"no limit is published for prints of {own.name}: beyond this the strongest printed plastic flows (PC, "
            f"{materials.STRONGEST:g} MPa in its plane, 1.79 times that in a line contact)"
        )
        said += "; the ends of the line press harder still: round them"
        where = Where(
            f"{joint.name}, {outline.part}",
            part=outline.part,
            joint=joint.name,
            theta=float(theta[worst]),
            digits=1,
        )
        borne.findings.append(at_most("HERTZ", float(pressure[worst]), limit, "MPa", where, said))
        borne.numbers[f"hertz_pressure_{joint.name.replace(' ', '_')}_mpa"] = float(pressure[worst])
        borne.plots.append(
            Plot(
                f"Hertz pressure, {joint.name}",
                "cam angle, deg",
                "MPa",
                [("line contact", np.degrees(theta), pressure)],
            )
        )
        if roller is not None:  # it turns as far as the cam's profile is long
            place, _ = joint.touches[0](angle)
            turns = float(np.sum(np.abs(np.diff(place)))) / (math.pi * roller.outside)
            rolling = np.full(
                len(force), turns * math.tau * run.machine.speed / float(np.ptp(theta))
            )
            _life(
                borne,
                Rolling(joint.name, roller, force, rolling, "roller of "),
                limits.bearing_life,
            )
    return borne


def _life(borne: Borne, rolling: Rolling, least: float | None) -> None:
    """BEARING_LIFE of a ball bearing; one that goes to and fro wears by the way that it goes. least: h, that is asked for."""
    name = rolling.joint
    ball = rolling.ball
    if not ball.rating:
        if least is not None:
            why = f"{name}: no load rating of the ball bearing {ball.name} is known"
            borne.left.append(
                NotJudged("BEARING_LIFE", why, f"a bearing with a rating: {', '.join(_RATED)}")
            )
        return
    turns = np.abs(rolling.turning) + np.zeros(len(rolling.force))
    load = strength.cubic_mean(np.maximum(rolling.force, 0.0), turns)
    rate = float(np.mean(turns)) / math.tau
    hours = strength.bearing_life(1e3 * ball.rating, load) / rate / 3600 if rate else math.inf
    borne.numbers[f"bearing_life_{re.sub('[^a-z0-9]+', '_', name.lower())}_h"] = min(hours, 1e9)
    if least is not None:
        said = f"{ball.name}, C = {ball.rating:g} kN, under a mean of {load:.4g} N; nine of ten reach it"
        where = Where(f"{rolling.what}{name}")
        borne.findings.append(at_least("BEARING_LIFE", min(hours, 1e9), least, "h", where, said))


def rubbing_in_slot(run: Run, slot: Slot, normal: Floats, radius: float) -> Floats:
    """How fast the rim of a pin, mm, rubs on the wall that presses it, as a turning, by theta: it slides along and turns."""
    slides = run.length(slot.name)[1] / radius
    turns = _rate(run, slot.runner.body) - _rate(run, slot.guide.body)
    return np.asarray(
        slides + np.sign(normal) * turns
    )  # pressed to the left of its way it bears on the wall to the right


def _rate(run: Run, body: str) -> Any:
    return 0.0 if body == GROUND else run.angle(body)[1]


def _angle(run: Run, body: str) -> Any:
    return np.zeros(len(run.theta)) if body == GROUND else run.angle(body)[0]


def _finite(values: Any) -> Floats:
    """Values with 0 where there is none."""
    return np.where(np.isfinite(values), values, 0.0)
