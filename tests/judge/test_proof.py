"""The machine closed on what was measured: where bodies stand, strokes of outputs, and what is asked for again."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from shapes import polygon

from camgen.findings import Where
from camgen.judge import proof as module
from camgen.judge.contact import contact
from camgen.judge.contact_tips import ArmTip
from camgen.judge.joints import Closable, RollingLaw
from camgen.judge.proof import Proof, _NominalMotion, strokes, with_laws
from camgen.judge.targets import judge_targets
from camgen.machine import (
    GROUND,
    Angle,
    Body,
    Cam,
    Drive,
    Gear,
    Machine,
    Output,
    Path,
    Pin,
    Place,
    Pose,
)
from camgen.machine.features import Demand
from camgen.machine.model import Floats, Turning
from camgen.machine.targets import Dwell, Stroke


class Wave:
    """size cos(theta)."""

    def __init__(self, size: float) -> None:
        self.size = size

    def __call__(self, theta: Floats, order: int = 0) -> Floats:
        return self.size * np.cos(np.asarray(theta) + order * math.pi / 2)


def machine(rate: float = 1.0, start: float = 0.0, size: float = 0.4) -> Machine:
    """A crank, a wheel geared to it, and an arm that a cam on the crank swings; a path of the arm's end."""
    return Machine(
        (Body("crank"), Body("wheel"), Body("arm")),
        (
            Pin("O", Place(GROUND), Place("crank")),
            Pin("W", Place(GROUND, -50), Place("wheel")),
            Pin("A", Place(GROUND, 60j), Place("arm")),
            Gear("gear", "crank", "wheel", -0.5),
            Cam("lift", "crank", "arm", Wave(size), phase=0.3, rest=0.1, closure="force"),
        ),
        (Drive("motor", "crank", Turning(rate, start)),),
        {"crank": Pose(0j, start), "wheel": Pose(-50, -0.5 * start), "arm": Pose(60j, 0.1)},
        outputs=(
            *(Output(name, Angle(name), "rad") for name in ("wheel", "arm")),
            Output("end", Path(Place("arm", 20))),
        ),
    )


@pytest.mark.parametrize("rate, start", [(1.0, 0.0), (-1.0, 0.4), (3.0, -2.0), (-2.0, 5.0)])
def test_where_a_body_stands_at_an_angle(rate: float, start: float) -> None:
    """All angles of the turn at which it does, in either sense, by its own law; an arm that swings has none."""
    meant = _NominalMotion(machine(rate, start), 0.0, math.tau)
    angles = np.array([0.5, -1.0, 2.0 + 6 * math.pi])
    for body, share in (("crank", 1.0), ("wheel", -0.5)):
        wanted = [
            (a + math.tau * k - share * start) / (share * rate)
            for a in angles
            for k in range(-20, 20)
        ]
        wanted = sorted(t for t in wanted if 0 <= t <= math.tau)
        assert sorted(meant.when(body, angles)) == pytest.approx(wanted, abs=1e-9)
    assert len(meant.when("arm", angles)) == len(meant.when(GROUND, np.zeros(1))) == 0
    ends = _NominalMotion(machine(rate, start), 0.0, 1.0).when(
        "crank", np.array([start, start + rate])
    )
    assert sorted(ends) == pytest.approx([0.0, 1.0], abs=1e-9)


def proof(measured: Machine, theta: Floats) -> Proof:
    return Proof(machine(), Closable(measured, {}, {}, {}, {}, {}), theta)


def arm(theta: Floats, size: float) -> Floats:
    return 0.1 + size * np.cos(theta - 0.3)


def test_what_is_asked_in_parts_or_again_is_the_same(monkeypatch: pytest.MonkeyPatch) -> None:
    """Values and slopes in closed form, of the machine as meant and as measured; matrices of many angles are made in parts."""
    theta = np.linspace(0, math.tau, 1001)
    for cells in (module._CELLS, 9 * 9 * 40):
        monkeypatch.setattr(module, "_CELLS", cells)
        found = proof(machine(size=0.41), theta)
        for _ in range(2):
            moved = found.moved("arm", theta)
            np.testing.assert_allclose(moved.value, arm(theta, 0.41), atol=1e-12)
            np.testing.assert_allclose(moved.slope, -0.41 * np.sin(theta - 0.3), atol=1e-12)
            value, slope = found.nominal("arm", theta)
            np.testing.assert_allclose(value, arm(theta, 0.4), atol=1e-12)
            np.testing.assert_allclose(slope, -0.4 * np.sin(theta - 0.3), atol=1e-12)
            end, speed = found.outcome("end", theta)
            np.testing.assert_allclose(end, 60j + 20 * np.exp(1j * moved.value), atol=1e-10)
            np.testing.assert_allclose(
                speed, 20j * np.exp(1j * moved.value) * moved.slope, atol=1e-10
            )
        for k in range(5):  # others in between
            again = theta[: 10 + k] + 0.01
            np.testing.assert_allclose(
                found.moved("arm", again).value, arm(again, 0.41), atol=1e-12
            )
            np.testing.assert_allclose(
                found.outcome("arm", again)[1], -0.41 * np.sin(again - 0.3), atol=1e-12
            )
        np.testing.assert_allclose(found.moved("arm", theta).value, arm(theta, 0.41), atol=1e-12)


def test_laws_take_the_place_of_those_of_cams_alone() -> None:
    """What an undercut outline gives is reachable; the machine's own law is wanted."""
    theta = np.linspace(0, math.tau, 100)
    other = Wave(0.2)
    found = Proof(
        machine(),
        Closable(machine(), {}, {}, {}, {}, {}),
        theta,
        (("lift", other), ("gear", other)),
    )
    np.testing.assert_allclose(found.reachable("arm", theta)[0], arm(theta, 0.2), atol=1e-12)
    np.testing.assert_allclose(found.nominal("arm", theta)[0], arm(theta, 0.4), atol=1e-12)
    kept = with_laws(machine(), (("lift", other),))
    assert [joint.name for joint in kept.joints] == [joint.name for joint in machine().joints]
    assert kept.joint("lift").law is other and isinstance(kept.joint("gear"), Gear)  # type: ignore[union-attr]


def test_corners_are_where_the_tip_passes_a_vertex() -> None:
    """A knife edge on an arm as long as its pivot is away, on a square: at a vertex, arm and line of the shafts are alike, so
    that the vertex is seen from the shaft acos(R / 2 L) from that line. The square is mounted 0.3 rad ahead of the cam."""
    far, corner = 60.0, 10 * math.sqrt(2)
    square = polygon(corner * np.exp(1j * (np.arange(4) + 0.5) * math.pi / 2))
    law = RollingLaw(contact(square, ArmTip(far * 1j, -far * 1j * np.exp(0.2j), 0.0, 1)), None)
    found = proof(with_laws(machine(), (("lift", law),)), np.linspace(0, math.tau, 1001)).corners
    seen = math.pi / 2 - math.acos(
        corner / (2 * far)
    )  # to the right of the line upwards, where the arm is
    wanted = [(seen - (k + 0.5) * math.pi / 2 + 0.3) % math.tau for k in range(4)]
    near = np.abs(found - np.array(wanted)[:, None]) < 1e-5
    assert (
        np.all(np.sum(near, axis=1) == 2) and len(found) - np.sum(near) <= 2
    )  # and where the table of touches begins


# ---- strokes and targets ---------------------------------------------------------------------------------------------------


@pytest.mark.long
@settings(max_examples=40)
@given(
    late=st.floats(0, 6.3),
    size=st.floats(1, 50),
    count=st.integers(30, 200),
    second=st.floats(-0.2, 0.2),
)
def test_a_stroke_reaches_between_the_judged_angles(
    late: float, size: float, count: int, second: float
) -> None:
    """Extremes of a wave with a second harmonic wherever they fall: at the ends of the turn as well; by a million samples.

    A second output, sought together with it, has its own elsewhere; a third stands still.
    """
    sizes = {"wave": size, "other": -2 * size, "still": 0.0}

    def both(name: str, theta: Floats) -> tuple[Any, Any]:
        at = theta - late - (0.7 if name == "other" else 0.0)
        return (
            sizes[name] * (np.cos(at) + second * np.sin(2 * theta)),
            sizes[name] * (-np.sin(at) + 2 * second * np.cos(2 * theta)),
        )

    theta = (np.arange(count) + 0.3) * (math.tau / count)
    found = strokes(theta, {name: both(name, theta)[0] for name in sizes}, both)
    for name in sizes:
        fine = both(name, np.linspace(0, math.tau, 200_001))[0]
        assert found[name] == pytest.approx(float(np.ptp(fine)), rel=1e-8, abs=0)


@pytest.mark.parametrize("width, height", [(3, 8), (5, 2)])
def test_a_paths_stroke_is_the_larger_side_of_its_box(width: float, height: float) -> None:
    theta = np.linspace(0, math.tau, 361)
    path = width * np.cos(theta) + 1j * height * np.sin(theta)
    wave = np.cos(theta)
    found = strokes(theta, {"path": path, "wave": wave}, lambda _, t: (np.cos(t), -np.sin(t)))
    assert found == pytest.approx({"path": 2 * max(width, height), "wave": 2.0})


@pytest.mark.parametrize("reach", [math.tau, 2.0])
@pytest.mark.parametrize("high", [30.0, 99.0])
def test_targets_are_measured_in_their_units_where_the_machine_closes(
    reach: float, high: float
) -> None:
    """Degrees of an arm and of a wheel, over a turn or a part of it; an output that does not close has told so."""
    theta = np.linspace(0, reach, 721)
    asked = [
        Demand("arm", targets=(Stroke(value=50.0, tolerance=1.0),)),
        Demand("end"),
        Demand("wheel", targets=(Stroke(value=high, tolerance=1.0),)),
    ]
    first, second = judge_targets(asked, proof(machine(size=0.41), theta), theta, Where(file="x"))
    stroke = 0.82 if reach > 6 else float(np.ptp(arm(np.linspace(0, 2, 9001), 0.41)))
    assert (str(first.where), str(second.where), first.unit) == ("x, arm", "x, wheel", "deg")
    assert first.measured == pytest.approx(abs(math.degrees(stroke) - 50), abs=1e-4)
    assert second.measured == pytest.approx(abs(math.degrees(reach) / 2 - high), abs=1e-6)

    def torn(t: Floats, order: int = 0) -> Floats:
        return np.where(t > 1.5, np.nan, Wave(0.41)(t, order))

    broken = with_laws(machine(), (("lift", torn),))
    assert [
        str(f.where) for f in judge_targets(asked, proof(broken, theta), theta, Where(file="x"))
    ] == []


@pytest.mark.parametrize("more, ok", [(-0.2, True), (0.2, False)])
def test_a_dwell_goes_on_over_the_end_of_a_turn(more: float, ok: bool) -> None:
    """About its highest place, which the arm reaches at 0.3 rad, it stays within a band from 0.1 rad before the turn's end."""
    theta = np.linspace(0, math.tau, 721)
    size = math.degrees(0.41)
    band = 2 * size * (1 - math.cos(0.4))  # either way of `at`
    wish = Dwell(span_deg=math.degrees(0.8) + more, band=band, at=math.degrees(0.1) + size)
    (finding,) = judge_targets(
        [Demand("arm", targets=(wish,))], proof(machine(size=0.41), theta), theta, Where(file="x")
    )
    assert finding.ok is ok
