"""Whether cams that are closed by force keep their followers: LIFT_OFF from the weights, springs and loads of the machine,
SPRING_RESERVE from what its springs pull with."""

from __future__ import annotations

import math
from collections.abc import Collection, Sequence
from dataclasses import replace

import numpy as np

from camgen.findings import Finding, NotJudged, Where, at_least
from camgen.machine.cams.bounce import Bounce, contact_of
from camgen.machine.cams.machine import Loaded, keeps_contact
from camgen.machine.model import MM, Cam, Load, Machine, Resistance, Spring, TorsionSpring
from camgen.machine.run import solve
from camgen.machines.loads.bearing import LoadCheck
from camgen.machines.loads.pins import STILL
from camgen.machines.loads.tables import Weight
from camgen.numerics import Floats
from camgen.study import Figure

_SLOW = 1e-6  # of the speed, at which inertia does nothing
_NEEDS = "[cam.spring], [[spring]], or [load] with gravity_deg or [[load.on]]: what presses the follower on its cam"


def by_force(machine: Machine) -> list[Cam]:
    """The cams that only a force keeps closed."""
    return [
        joint for joint in machine.joints if isinstance(joint, Cam) and joint.closure == "force"
    ]


def slow(machine: Machine) -> Machine:
    """A machine that turns so slowly that inertia does nothing."""
    return replace(machine, speed=_SLOW * machine.speed)


def unsprung(machine: Machine) -> Machine:
    """A machine without its springs."""
    loads = [load for load in machine.loads if not isinstance(load, Spring | TorsionSpring)]
    return replace(machine, loads=tuple(map(_unsprung, loads)))


def _unsprung(load: Load) -> Load:
    if not isinstance(load, Resistance):
        return load
    return replace(load, force=load.force - load.wound, rate=0.0, wound=0.0)


def spring_reserve(
    theta: Floats, effort: Floats, spring: Floats, least: float, where: Where, slides: bool
) -> list[Finding]:
    """SPRING_RESERVE: share of a spring's push that is left to press a follower on its cam; none where no spring presses, or
    where the follower leaves, which LIFT_OFF says.

    theta: rad; effort: in the sense of the lift, and what the spring gives to it, N or N m, (n,) each.
    """
    pressing = spring > STILL
    if not np.any(pressing):
        return []
    share = np.full(np.shape(spring), math.inf)
    np.divide(effort, spring, out=share, where=pressing & np.isfinite(effort))
    k = int(np.argmin(share))
    if not 0 < share[k] < math.inf:
        return []
    said = "share of the spring's force that is left to press the follower on; friction and the spring's tolerance reduce it"
    if share[k] < least:
        more = float(np.nanmax((least * spring - effort)[pressing])) / (1 - least)
        said += f"; {more:.3g} {'N' if slides else 'N m'} more preload is enough; less mass or a lower speed helps too"
    place = replace(where, theta=float(theta[k]), digits=1)
    return [at_least("SPRING_RESERVE", min(1.0, float(share[k])), least, "", place, said)]


def lift_off(
    machine: Machine,
    cams: Sequence[Cam],
    kicks: Collection[str],
    theta: Floats,
    angle: str,
    restitution: float | None,
) -> LoadCheck:
    """LIFT_OFF of some of its cams, not judged where no spring, weight or load acts on the follower; and how it bounces.

    machine: with its masses and loads, without friction in its pins; kicks: joints whose follower's speed jumps; theta: (n,)
    rad; angle: what theta is called; restitution: None where followers are elastic, and hops not told.
    """
    check = LoadCheck()
    if not cams:
        return check
    run = solve(machine, theta)
    forces = run.forces()
    still = solve(slow(machine), theta).forces()
    for cam in cams:
        effort = cam.leaves * forces.contacts[cam.name]
        force = forces.pressing.get(cam.name, effort)
        if not np.any(np.abs(still.contacts[cam.name]) > STILL):
            why = f"no spring, weight or load acts on the follower of {cam.name} ([cam.spring] gives it a spring)"
            check.not_judged.append(NotJudged("LIFT_OFF", why, _NEEDS))
            continue
        unit = "N" if cam.slide else "N m"
        least = max(0.0, -float(np.nanmin(effort)))
        jumps = cam.name in kicks
        remedy = (
            f"press {cam.follower} on the cam with {least:.4g} {unit} more at all angles: by a spring ([cam.spring], "
            "[[spring]], or its preload), a weight or a load ([load]). A weaker one is enough with less mass or a lower speed"
        )
        if jumps:
            remedy = (
                "its speed jumps, and no spring can hold it there: use a law that ends smoothly"
            )
        where = Where(joint=cam.name, angle=angle)
        finding = keeps_contact(theta, force, jumps, where, remedy)
        contact = None
        if not finding.ok and not jumps and restitution is not None:
            contact = contact_of(cam, run, still)
        if contact is not None and restitution is not None:
            bounce = contact.bounce(machine.speed, restitution)
            finding = with_hops(finding, bounce, bool(cam.slide))
            check.figures += bounce_figures(bounce, bool(cam.slide), cam.name)
        check.findings.append(finding)
    return check


def reserves(
    machine: Machine, cams: Sequence[Cam], theta: Floats, angle: str, least: float
) -> list[Finding]:
    """SPRING_RESERVE of the springs on the followers of some of its cams; machine, theta, angle as above; least: share of
    their force."""
    sprung = solve(machine, theta).forces().contacts
    loose = solve(unsprung(machine), theta).forces().contacts
    found = []
    for cam in cams:
        effort = cam.leaves * sprung[cam.name]
        spring = effort - cam.leaves * loose[cam.name]
        where = Where(joint=cam.name, angle=angle)
        found += spring_reserve(theta, effort, spring, least, where, bool(cam.slide))
    return found


def restitution_of(load: Weight | None) -> float | None:
    """With which a follower springs back from its cam; None of an elastic one, whose hops are not told."""
    load = load or Weight()
    return load.restitution if load.stiffness is None else None


def bounce_of(machine: Machine, found: Loaded, load: Weight | None) -> Bounce | None:
    """What the follower of a machine of one cam does where it leaves it; None where it does not, or that cannot be said.

    machine: with its loads; found: what they do.
    """
    restitution = restitution_of(load)
    if (
        restitution is None
        or found.keeps_contact("").ok
        or found.kick
        or np.any(np.isnan(found.force))
    ):
        return None
    cam = machine.cam("contact")
    still = solve(slow(machine), found.theta).forces()
    contact = contact_of(cam, solve(machine, found.theta), still)
    return None if contact is None else contact.bounce(machine.speed, restitution)


def with_hops(finding: Finding, bounce: Bounce | None, slides: bool) -> Finding:
    """LIFT_OFF with what a person reads of the hops beside it."""
    if bounce is None or not bounce.hops:
        return finding
    hop = bounce.highest
    rpm = bounce.lift_off * 60 / math.tau
    lost = f"It loses contact from {rpm:.4g} rpm"
    if not rpm:
        lost = "As it is now, it loses contact at any speed"
    left = f"it leaves the cam at {math.degrees(hop.leaves) % 360:.1f} deg"
    if not math.isfinite(hop.lands):
        return replace(finding, message=f"{finding.message}. {lost}: {left} and does not come back")
    height = f"{hop.height:.3g} mm" if slides else f"{math.degrees(hop.height):.3g} deg"
    speed = f"{bounce.knock * MM:.3g} m/s" if slides else f"{bounce.knock:.3g} rad/s"
    lands = f"{math.degrees(hop.lands) % 360:.1f} deg"
    flight = (
        f"flies up to {height} off the cam, comes back at {lands} and hits it with up to {speed}"
    )
    return replace(finding, message=f"{finding.message}. {lost}: {left}, {flight}")


def bounce_figures(bounce: Bounce | None, slides: bool, of: str = "") -> list[Figure]:
    """Of a follower that leaves its cam; of: the cam, where there may be others."""
    if bounce is None or not bounce.hops:
        return []
    unit, scale = ("mm", 1.0) if slides else ("deg", math.degrees(1))
    named = " {of}" if of else ""
    figures = [
        Figure(f"lift off speed{named}", bounce.lift_off * 60 / math.tau, "rpm", of),
        Figure(f"hop{named}", scale * bounce.highest.height, unit, of),
        Figure(
            f"knock{named}",
            bounce.knock * (MM if slides else scale),
            "m/s" if slides else "deg/s",
            of,
        ),
    ]
    return [each for each in figures if math.isfinite(each.value)]
