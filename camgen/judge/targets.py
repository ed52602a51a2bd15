"""Targets judged from files: each output's course by the joints as measured, against what the spec wants of it by value."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from camgen.findings import Finding, Where
from camgen.judge.proof import Proof
from camgen.machine.features import Demand
from camgen.machine.model import Floats, unit_of


def judge_targets(
    wishes: Sequence[Demand], proof: Proof, theta: Floats, where: Where
) -> list[Finding]:
    """A finding for each target of each output. theta: (n,) rad, even, both ends of the turn or range included."""
    findings = []
    for each in wishes:
        if each.targets:
            from camgen.machine.targets import Course

            response = proof.moved(each.output, theta)
            unit, scale = unit_of(proof.machine.output(each.output))
            whole = abs(theta[-1] - theta[0] - math.tau) < 1e-9
            value = scale * response.value
            by = "mm" if proof.machine.drives[0].slide is not None else "deg"
            course = Course(theta, value, scale * response.slope, unit, whole, by)
            place = replace(where, output=each.output)
            closes = bool(np.isfinite(course.value).all())
            findings += [
                target.finding(course, place) for target in each.targets if closes
            ]  # else MOTION_ERROR has told
    return findings
