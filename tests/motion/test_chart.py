"""Timing charts: corners and tasks to programs that join at every corner, and every fault by its key."""

from __future__ import annotations

import math
import tomllib
from typing import Annotated, Any

import numpy as np
import pytest
from hypothesis import Phase, given, settings
from hypothesis import strategies as st

from camgen.errors import SpecError
from camgen.motion.program import Program
from camgen.motion.segments import SegmentTable, WholeTurn, program, program_faults
from camgen.motion.tasks import REST, End, Form, law_for
from camgen.spec import Spec, dump, validate


class Sample(Spec):
    segment: Annotated[tuple[SegmentTable, ...], WholeTurn]

    def faults(self) -> Any:
        return program_faults(self.segment)


def spec(*rows: str) -> Sample:
    """Of rows as inline tables."""
    text = "\n".join(f"[[segment]]\n{row.replace('; ', chr(10))}" for row in rows)
    return validate(Sample, {"mechanism": "sample", "name": "sample", **tomllib.loads(text)})


def made(*rows: str) -> Program:
    return program(spec(*rows).segment)


def faults(*rows: str) -> list[tuple[str, str]]:
    with pytest.raises(SpecError) as error:
        spec(*rows)
    return [(f.key, f"{f.value} | {f.expected}") for f in error.value.faults]


CORNERS = (
    "at_deg = 60; to = 5; law = 'modified-sine'",
    "at_deg = 120; to = 15; law = 'uniform'",
    "at_deg = 170; to = 20; law = 'modified-sine'",
    "at_deg = 200; to = 20",
    "at_deg = 300; to = 0; law = '3-4-5'",
    "at_deg = 360; to = 0",
)


def test_corners_are_spans_and_kinds() -> None:
    chart = spec(*CORNERS)
    assert [row.span_deg for row in chart.segment] == [60, 60, 50, 30, 100, 60]
    kinds = ["rise", "rise", "rise", "dwell", "return", "dwell"]
    assert [row.kind for row in chart.segment] == kinds
    last = (*CORNERS[:-1], "kind = 'dwell'")
    assert [row.span_deg for row in spec(*last).segment] == [60, 60, 50, 30, 100, 60]
    assert dump(validate(Sample, tomllib.loads(dump(chart)))) == dump(chart)


def test_tasks_are_found_from_the_ends() -> None:
    """Beside uniform motion a law runs into its velocity, R-G and G-R; beside a dwell it rests."""
    whole = made(*CORNERS)
    assert whole.discontinuities() == []
    slope = 10 / math.radians(60)
    theta = np.radians(np.linspace(0, 60, 33))
    v1 = slope * math.radians(60) / 5
    law = law_for("modified-sine", REST, End("G", v1))
    np.testing.assert_allclose(
        whole(theta[:-1]), 5 * law(theta / math.radians(60))[:-1], atol=1e-13
    )
    typed = [
        CORNERS[0] + "; task = 'RG'",
        CORNERS[1] + "; task = 'GG'",
        CORNERS[2] + "; task = 'GR'",
    ]
    again = made(*typed, *CORNERS[3:])
    np.testing.assert_allclose(again(theta), whole(theta), atol=1e-14)
    reference = [float(s.law.c_v) for s in whole.segments[:2]]
    assert reference[1] == 1.0


def test_a_reversal_has_one_acceleration() -> None:
    """Two harmonic combinations: the harder one keeps lambda 1/2, the other one's follows."""
    whole = made(
        "kind = 'rise'; span_deg = 90; lift = 10; law = 'harmonic-combination'",
        "kind = 'return'; span_deg = 120; lift = 10; law = 'harmonic-combination'",
        "kind = 'dwell'",
    )
    assert whole.discontinuities() == []
    assert float(whole.segments[0].law(1.0, 2)) == pytest.approx(-5.21456606, abs=1e-8)
    fixed = made(
        "kind = 'rise'; span_deg = 90; lift = 10; law = 'harmonic-combination'; lambda = 0.6",
        "kind = 'return'; span_deg = 120; lift = 10; law = '3-4-5'",
        "kind = 'dwell'",
    )
    assert fixed.discontinuities() == []
    assert float(fixed.segments[0].law(0.25)) == pytest.approx(0.0866041327, abs=1e-10)
    stated = made(
        "kind = 'rise'; span_deg = 90; lift = 10; law = '3-4-5'; end_acceleration = -0.006",
        "kind = 'return'; span_deg = 120; lift = 10; law = 'harmonic-combination'",
        "kind = 'dwell'",
    )
    assert stated.discontinuities() == []
    apex = float(stated(math.radians(90), 2)) * math.radians(1) ** 2
    assert apex == pytest.approx(-0.006, rel=1e-12)


def test_moving_joints() -> None:
    """B with its values, given once and used by both sides; one of them leaves a height and comes back to it."""
    whole = made(
        "at_deg = 80; to = 10; law = '3-4-5'; end_velocity = 0.12; end_acceleration = -0.002",
        "at_deg = 130; to = 10; task = 'BB'; law = '3-4-5'; end_velocity = -0.1; end_acceleration = -0.001",
        "at_deg = 240; to = 0; law = '4-5-6-7'",
        "at_deg = 360; to = 0",
    )
    assert whole.discontinuities() == []
    joint = math.radians(80)
    assert float(whole(joint)) == pytest.approx(10, abs=1e-12)
    assert float(whole(joint, 1)) == pytest.approx(0.12 / math.radians(1), rel=1e-12)
    assert float(whole(joint - 1e-12, 1)) == pytest.approx(0.12 / math.radians(1), rel=1e-9)
    assert whole.extremes[1] > 11


def test_laws_are_chosen() -> None:
    """Where none is named; the resolved spec has them by name, with their tasks."""
    rows = ("at_deg = 90; to = 10", "at_deg = 180; to = 0", "at_deg = 360; to = 0")
    chart = spec(*rows)
    names = [row.law.name if row.law else None for row in chart.segment]
    assert names == ["modified-trapezoid", "modified-trapezoid", None]
    assert [row.task for row in chart.segment] == ["RU", "UR", None]
    assert program(chart.segment).segments[0].law.c_a == pytest.approx(4.5173437, abs=1e-7)
    again = validate(Sample, tomllib.loads(dump(chart)))
    assert again == chart and program(again.segment) == program(chart.segment)
    torque = spec(*(f"{row}; law = 'least-torque'" for row in rows[:2]), rows[2])
    assert torque.segment[0].law is not None
    assert torque.segment[0].law.name == "harmonic-combination"
    dwells = spec(
        "at_deg = 90; to = 10; law = 'least-jerk'",
        "at_deg = 180; to = 10",
        "at_deg = 270; to = 0",
        "kind = 'dwell'",
    )
    chosen = [row.law.name for row in dwells.segment if row.law]
    assert chosen == ["cycloidal", "modified-trapezoid"]
    straight = spec(
        "at_deg = 60; to = 2; task = 'RG'",
        "at_deg = 120; to = 8; task = 'GG'",
        "at_deg = 180; to = 10; task = 'GR'",
        "at_deg = 360; to = 0",
    )
    assert straight.segment[1].law is not None and straight.segment[1].law.name == "uniform"
    assert program(straight.segment).discontinuities() == []


@pytest.mark.parametrize("apex", [180, 150, 230])
def test_up_and_down_all_the_time(apex: int) -> None:
    """One law where both ways are alike, else a polynomial takes the accelerations of the harder way."""
    whole = made(f"at_deg = {apex}; to = 10", "at_deg = 360; to = 0")
    assert whole.discontinuities() == []
    names = [s.law.name for s in whole.segments]
    assert (names[0] == names[1]) == (apex == 180)


def test_parameters_beside_a_law_are_its_own() -> None:
    beside = made(
        "kind = 'rise'; span_deg = 90; lift = 10; law = 'modified-sine'; lambda = 0.4; constant_velocity = 0.2",
        "kind = 'dwell'",
        "kind = 'return'; span_deg = 90; to = 0; law = 'inclined-sine'",
    )
    inside = made(
        "kind = 'rise'; span_deg = 90; lift = 10; law = { name = 'modified-sine', lambda = 0.4, constant_velocity = 0.2 }",
        "kind = 'dwell'",
        "kind = 'return'; span_deg = 90; to = 0; law = 'cycloidal'",
    )
    assert beside == inside
    law = law_for("modified-sine", form=Form(0.4, 0.2))
    assert beside.segments[0].law == law


@given(
    st.lists(
        st.tuples(st.floats(20, 80), st.floats(1, 20), st.floats(20, 80), st.booleans()),
        min_size=1,
        max_size=2,
    ),
    st.sampled_from(["least-acceleration", "least-jerk", "least-torque"]),
)
@settings(deadline=None, max_examples=40, phases=[Phase.reuse, Phase.generate])
def test_every_chart_joins(legs: list[tuple[float, float, float, bool]], choice: str) -> None:
    """Up and down by any spans and heights, with a dwell or a reversal on top: no jump of displacement, velocity, acceleration."""
    rows: list[str] = []
    at = 0.0
    for up, height, down, stays in legs:
        level = round(height, 3)
        at += round(up, 3)
        rows.append(f"at_deg = {at!r}; to = {level!r}; law = '{choice}'")
        if stays:
            at += 10
            rows.append(f"at_deg = {at!r}; to = {level!r}")
        at += round(down, 3)
        rows.append(f"at_deg = {at!r}; to = 0; law = '{choice}'")
        at += 5
        rows.append(f"at_deg = {at!r}; to = 0")
    whole = made(*rows[:-1], "kind = 'dwell'")
    assert whole.discontinuities() == []


# ---- faults ----------------------------------------------------------------------------------------------------------

RISE = "at_deg = 90; to = 10; law = '3-4-5'"
STAY = "at_deg = 180; to = 10"
BACK = "at_deg = 270; to = 0; law = '3-4-5'"
REMAINS = "at_deg = 360; to = 0"


@pytest.mark.parametrize(
    "rows, path, says",
    [
        (
            (RISE, "kind = 'dwell'; span_deg = 90", BACK, REMAINS),
            "segment.1.span_deg",
            "90 | either at_deg in all segments of a cam, or span_deg in all",
        ),
        (
            (RISE + "; span_deg = 90", STAY, BACK, REMAINS),
            "segment.0.span_deg",
            "either at_deg in all",
        ),
        (
            (RISE, "kind = 'dwell'", BACK, REMAINS),
            "segment.1.at_deg",
            "missing: every segment of a timing chart",
        ),
        ((RISE, STAY, BACK), "segment.2.at_deg", "270 | 360 of the last segment"),
        (
            (RISE, STAY.replace("180", "80"), BACK, REMAINS),
            "segment.1.at_deg",
            "80 | more than 90, where the segment begins",
        ),
        (
            ("at_deg = 90; law = '3-4-5'", STAY, BACK, REMAINS),
            "segment.0.kind",
            'missing: "rise", "dwell" or "return", or where it ends',
        ),
        (
            (RISE + "; task = 'RX'", STAY, BACK, REMAINS),
            "segment.0.task",
            "two of R, G, U, B",
        ),
        (
            (RISE + "; task = 'RU'", STAY, BACK, REMAINS),
            "segment.0.task",
            "R where it joins a dwell",
        ),
        (
            (RISE + "; task = 'RU'", BACK + "; task = 'RR'", REMAINS),
            "segment.1.task",
            "a task that begins with U, as the segment before ends",
        ),
        (
            (RISE + "; task = 'RG'", BACK, REMAINS),
            "segment.0.end_velocity",
            "missing: the velocity of G",
        ),
        (
            (RISE + "; task = 'GR'", BACK, REMAINS),
            "segment.0.task",
            "R where it joins a dwell",
        ),
        (
            (RISE + "; task = 'RU'", BACK, REMAINS),
            "segment.0.end_acceleration",
            "missing: polynomials leave",
        ),
        (
            (RISE + "; task = 'RB'; end_velocity = 1", BACK, REMAINS),
            "segment.0.end_acceleration",
            "missing: B needs it",
        ),
        (
            (RISE + "; end_velocity = 0.1", STAY, BACK, REMAINS),
            "segment.0.end_velocity",
            "0.1 | no value here: R has 0",
        ),
        (
            (
                RISE.replace("3-4-5", "mr-13") + "; task = 'RU'; end_acceleration = -0.01",
                BACK,
                REMAINS,
            ),
            "segment.0.task",
            "RR: 'mr-13' has no other",
        ),
        (
            (RISE.replace("3-4-5", "modified-sine") + "; task = 'RU'", BACK, REMAINS),
            "segment.0.task",
            "one that 'modified-sine' has: RR, RG, GR, GG",
        ),
        (
            (
                RISE + "; lambda = 0.4",
                BACK.replace("'3-4-5'", "{ name = '3-4-5', lambda = 0.3 }; lambda = 0.4"),
                REMAINS,
            ),
            "segment.1.lambda",
            "0.4 | either here or in law, which has 0.3",
        ),
        (
            (RISE + "; constant_velocity = 0.4", STAY, BACK, REMAINS),
            "segment.0.constant_velocity",
            "no value here: '3-4-5' takes lambda",
        ),
        (
            (RISE, STAY + "; lambda = 0.4", BACK, REMAINS),
            "segment.1.lambda",
            "a dwell stays where it is",
        ),
        (
            (
                RISE.replace("3-4-5", "harmonic-combination") + "; end_acceleration = -0.001",
                BACK,
                REMAINS,
            ),
            "segment.0.end_acceleration",
            "one that a lambda between 0 and 1 gives this law",
        ),
    ],
)
def test_one_fault(rows: tuple[str, ...], path: str, says: str) -> None:
    found = faults(*[row for row in rows])
    assert [p for p, _ in found] == [path], found
    assert says in found[0][1], found
