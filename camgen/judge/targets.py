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
    from camgen.machine.targets import Course, target_findings

    def course_of(output: str) -> Course:
        response = proof.moved(output, theta)
        unit, scale = unit_of(proof.machine.output(output))
        whole = abs(theta[-1] - theta[0] - math.tau) < 1e-9
        by = "mm" if proof.machine.drives[0].slide is not None else "deg"
        return Course(theta, scale * response.value, scale * response.slope, unit, whole, by)

    findings: list[Finding] = []
    for each in wishes:
        if each.targets:
            course = course_of(each.output)
            place = replace(where, output=each.output)
            if np.isfinite(course.value).all():  # else MOTION_ERROR has told
                findings += target_findings(each.targets, course, place, course_of)
    return findings
