"""How many printed copies hold each finding: copies are made and judged as the machine itself is.

    rolled   the displaced outlines under the judge's own contact: FACE_WIDTH; less the design's, SPEED_RIPPLE and PRESSURE_ANGLE
    closed   the model with its centres off and its cams' motion as it then is: TRANSMISSION_ANGLE, LIFT_OFF, and all that the
             machine bears at its speed: drive, contacts, bearings, pins

A cam's motion under loads is the wanted one and the sum of its modes, a smooth curve: facets have no acceleration. What a print
cannot change (a motor's shaft, a material) is left out; so is what is judged on the design's own lengths alone.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace

import numpy as np

from camgen.errors import DesignError
from camgen.findings import Finding, Where, at_least, at_most
from camgen.judge.cams import FollowerOnOutline
from camgen.judge.joints import Outline
from camgen.machine.cams.machine import keeps_contact
from camgen.machine.model import Cam, Machine
from camgen.machine.reach import folds
from camgen.machine.run import solve
from camgen.machines.loads.assess import assess
from camgen.machines.loads.lift_off import by_force
from camgen.machines.loads.weights import with_gravity
from camgen.machines.mechanism import Mechanism
from camgen.numerics import Floats
from camgen.tolerance.spread import Bend, Spread, laws_of, shifted_by

_SAME = 1e-6  # share of a value, by which copies differ where the print does nothing
_LITTLE = 1e-3  # of its limit, of what needs no yield


@dataclass(frozen=True)
class CopiesFinding:
    """A finding of copies: what it is of, its limit and how they compare with it; values, (copies,), as designed first."""

    code: str
    what: str
    unit: str
    limit: float
    sign: str
    designed: float
    values: Floats
    holds: Floats


def copies_findings(spread: Spread, errors: Floats) -> list[CopiesFinding]:
    """All findings of copies with these errors, (copies, modes) mm, that differ between them; worst yield first."""
    bends = spread.bends
    limits = spread.mechanism.limits()
    exact = np.zeros(len(spread.modes))
    first = _followers(spread, exact, spread.mechanism.model)
    designed, *copies = (
        _by_place(_of_copy(spread, each, bends, limits, first)) for each in (exact, *errors)
    )
    findings = []
    for (code, what), finding in designed.items():
        made = [copy.get((code, what)) for copy in copies]
        values = np.array([math.nan if each is None else each.measured for each in made])
        holds = np.array([each is not None and each.ok for each in made])
        little = (
            not finding.floor
            and finding.limit > 0
            and np.all(np.abs(values) < _LITTLE * finding.limit)
        )
        if not little and not np.all(
            np.abs(values - finding.measured) <= _SAME * abs(finding.measured)
        ):
            findings.append(
                CopiesFinding(
                    code,
                    what,
                    finding.unit,
                    finding.limit,
                    finding.sign,
                    finding.measured,
                    values,
                    holds,
                )
            )
    return sorted(findings, key=lambda each: float(np.mean(each.holds)))


def _by_place(findings: Iterator[Finding]) -> dict[tuple[str, str], Finding]:
    """By code and place, less the angle there; of several at one place the worst."""
    named: dict[tuple[str, str], Finding] = {}
    for each in findings:
        key = each.code, str(replace(each.where, theta=None))
        margin = (each.measured - each.limit) * (1 if each.floor else -1)
        if key not in named or margin < (named[key].measured - named[key].limit) * (
            1 if each.floor else -1
        ):
            named[key] = each
    return named


def _of_copy(
    spread: Spread,
    errors: Floats,
    bends: Mapping[str, Bend],
    limits: Sequence[Finding],
    first: Mapping[str, FollowerOnOutline],
) -> Iterator[Finding]:
    """All findings of one copy; limits: the design's own; first: by cam its follower on the outline without errors.

    Outlines are rolled as facets, which tilt the normal by more than a print does: so a copy counts with what it differs by from
    the design that is rolled in the same way, and that with its exact curve.
    """
    shifted = shifted_by(spread, errors)
    steepest = min(
        (each.limit for each in limits if each.code == "PRESSURE_ANGLE"), default=math.inf
    )
    for name, followed in _followers(spread, errors, shifted, first).items():
        steep = followed.pressure_angle - first[name].pressure_angle + _steepest(first[name])
        yield from (
            each for each in followed.findings() if each.code != "UNDERCUT"
        )  # it would count all that a print does
        yield at_most("PRESSURE_ANGLE", steep, steepest, "deg", Where(joint=name), "")
    machine = replace(
        shifted,
        joints=tuple(
            replace(joint, law=bends[joint.name].law(joint.law, errors))
            if joint.name in bends and isinstance(joint, Cam)
            else joint
            for joint in shifted.joints
        ),
    )
    mechanism = spread.mechanism
    with suppress(DesignError):  # one that does not close any more holds none of these
        yield from (*assess(mechanism, machine).findings, *_of_model(mechanism, machine, limits))


def _followers(
    spread: Spread,
    errors: Floats,
    shifted: Machine,
    first: Mapping[str, FollowerOnOutline] | None = None,
) -> dict[str, FollowerOnOutline]:
    """Of each cam its follower on the displaced outline; first: what it is held against, where that is not the wanted motion."""
    followers = {}
    for name, (outline, law) in laws_of(spread, errors, shifted).items():
        joint = spread.mechanism.model.cam(name)
        if first is not None:
            outline = replace(
                outline, nominal=replace(outline.nominal, law=first[name].outline.law)
            )
        followers[name] = FollowerOnOutline(
            joint, Outline(outline, law, law), Where(joint=name), 0.0
        )
    return followers


def _steepest(design: FollowerOnOutline) -> float:
    """Largest pressure angle of the exact curve, deg; of one without a formula that of its facets."""
    joint = design.joint
    if not joint.touches or joint.over is not None:
        return design.pressure_angle
    steep = joint.touches[0].cam.pressure_angle_untrimmed(design.theta)  # type: ignore[attr-defined]
    return math.degrees(float(np.nanmax(np.abs(steep))))


def _of_model(
    mechanism: Mechanism, machine: Machine, limits: Sequence[Finding]
) -> Iterator[Finding]:
    """Limits of the design that its model tells as well."""
    asked = {each.code: each for each in limits}
    if "TRANSMISSION_ANGLE" in asked:
        sines = [fold.determinant for fold in folds(machine, *mechanism.assembly.cycle.range)]
        least = math.degrees(math.asin(min(1.0, *map(abs, sines)))) if sines else math.nan
        limit = asked["TRANSMISSION_ANGLE"]
        yield at_least("TRANSMISSION_ANGLE", least, limit.limit, "deg", Where("joints"), "")
    forced = [cam.name for cam in by_force(machine)]
    if len(forced) > 1:  # of several that are judged, each says its name
        forced = [
            name
            for name in forced
            if any(each.code == "LIFT_OFF" and name == each.where.joint for each in limits)
        ]
    if "LIFT_OFF" in asked and forced:
        theta = np.linspace(*mechanism.assembly.cycle.range, 1441)
        pressing = (
            solve(with_gravity(machine, mechanism.load, lambda: mechanism.assembly.solids), theta)
            .forces()
            .pressing
        )
        yield keeps_contact(
            theta, np.fmin.reduce([pressing[name] for name in forced]), False, Where("contact"), ""
        )
