"""The maker's route: known linkages against closed forms and published figures, derivatives, branches, ends."""

from __future__ import annotations

import math

import numpy as np
import pytest
from chains import (
    CHAINS,
    Wave,
    closing_four_bars,
    double_butterfly,
    excavator,
    four_bar,
    geared_five_bar,
    hoeken,
    jansen,
    klann,
    peaucellier,
    planetary,
    ram_machine,
    scotch_yoke,
    slider_crank,
    stephenson_three,
    watt_two,
    wedge,
    whitworth,
)
from hypothesis import given, settings
from hypothesis import strategies as st

from camgen.machine import (
    GROUND,
    Along,
    Body,
    Drive,
    Machine,
    Output,
    Place,
    Pose,
    Slot,
    Turning,
    solve,
)
from camgen.machine.loops import chain_of
from camgen.machine.newton import Block
from camgen.machine.state import Dyad

THETA = np.random.default_rng(3).uniform(0, math.tau, 400)


def kinds(machine: Machine) -> list[str]:
    return [
        s.kind if isinstance(s, Dyad) else f"newton {s.size}" if isinstance(s, Block) else "direct"
        for s in chain_of(machine).steps
    ]


@pytest.mark.parametrize("branch", [1, -1])
@pytest.mark.parametrize(
    "lengths", [(40.0, 15.0, 45.0, 35.0), (9.0, 30.0, 30.0, 19.0), (9.0, 30.0, 19.0, 30.0)]
)
def test_four_bar_is_where_two_circles_meet(lengths: tuple[float, ...], branch: int) -> None:
    frame, crank, coupler, rocker = lengths
    a = crank * np.exp(1j * THETA)
    d = frame - a
    along = (coupler**2 - rocker**2 + np.abs(d) ** 2) / (2 * np.abs(d))
    joint = a + d / np.abs(d) * (along + 1j * branch * np.sqrt(coupler**2 - along**2))
    run = solve(four_bar(*lengths, branch), THETA)
    np.testing.assert_allclose(run["B"], joint, atol=1e-12)


def test_blocks_are_found() -> None:
    assert kinds(four_bar(40, 15, 45, 35)) == ["direct", "angles"]
    assert kinds(jansen()) == ["direct", "angles", "angles", "angles"]
    assert kinds(klann()) == kinds(watt_two()) == ["direct", "angles", "angles"]
    assert kinds(slider_crank()) == ["direct", "slider"]
    assert kinds(whitworth()) == ["direct", "inverted"]
    assert kinds(scotch_yoke()) == ["direct", "lengths"]
    assert kinds(stephenson_three()) == ["direct", "newton 4"]
    assert kinds(stephenson_three("crank")) == ["direct", "angles", "angles"]
    assert kinds(double_butterfly()) == ["direct", "newton 6"]
    assert kinds(ram_machine()) == ["direct", "direct", "direct", "angles", "slider"]


def test_scotch_yoke_is_an_exact_cosine() -> None:
    rows = solve(scotch_yoke(10.0), THETA).derivatives("way")
    wanted = [10 * np.cos(THETA), -10 * np.sin(THETA), -10 * np.cos(THETA)]
    np.testing.assert_allclose(rows, wanted, atol=1e-13)


def test_eccentric_drive_has_its_exact_figures() -> None:
    theta = np.radians([0, 30, 60, 90, 120, 150, 180])
    run = solve(slider_crank(1.5, 48.0, speed=22.6), theta)
    travel = run["way"][0] - run["way"]
    np.testing.assert_allclose(
        travel[1:6], [0.206821627, 0.767581345, 1.523443225, 2.267581340, 2.804897840], atol=5e-10
    )
    speed = [17.4087788378, 29.8171521010, 33.9, 28.8993702756, 16.4912211622, 0]
    np.testing.assert_allclose(-run.velocity["way"][1:], speed, atol=6e-11)
    assert travel[6] == pytest.approx(3, abs=1e-12)
    assert run.acceleration["way"][0] / run.acceleration["way"][6] == pytest.approx(
        -33 / 31, rel=1e-12
    )


def test_offset_slider_is_the_plain_formula() -> None:
    x = 12 * np.cos(THETA) + np.sqrt(40**2 - (12 * np.sin(THETA) - 7) ** 2)
    np.testing.assert_allclose(solve(slider_crank(12, 40, 7), THETA)["way"], x, atol=1e-12)


def test_whitworth_time_ratio() -> None:
    """Crank-shaper: forward turn over return turn = (180 + alpha) / (180 - alpha), sin(alpha / 2) = crank / frame."""
    machine = whitworth(20.0, 40.0)
    alpha = 2 * math.asin(20 / 40)
    # The arm is tangent to the crank's circle at its extremes: crank at right angles to it.
    ends = np.array([math.pi + alpha / 2, math.tau - alpha / 2]) + np.array([0.0, 0.0])
    np.testing.assert_allclose(solve(machine, ends).derivatives("arm")[1], 0, atol=1e-14)
    back = ends[1] - ends[0]
    assert (math.tau - back) / back == pytest.approx(
        (math.pi + alpha) / (math.pi - alpha), rel=1e-14
    )
    run = solve(machine, THETA)
    np.testing.assert_allclose(run["arm"], np.angle(20 * np.exp(1j * THETA) + 40j), atol=1e-14)


def test_peaucellier_is_straight_to_rounding() -> None:
    run = solve(peaucellier(), THETA)
    foot = run["R"]
    np.testing.assert_allclose(
        foot.real, (50**2 - 20**2) / (2 * 25), atol=5e-12
    )  # inversion: |OP| |OR| = a^2 - b^2
    assert np.ptp(foot.imag) > 20


def test_jansens_foot_walks_its_known_path() -> None:
    foot = solve(jansen(), np.linspace(0, math.tau, 3601))["foot"]
    assert np.ptp(foot.real) == pytest.approx(68, abs=1.0)
    assert np.ptp(foot.imag) == pytest.approx(22.5, abs=0.5)
    low = foot[foot.imag < foot.imag.min() + 1.0]
    assert np.ptp(low.real) > 35  # flat below


def test_klanns_leg_walks() -> None:
    foot = solve(klann(), np.linspace(0, math.tau, 1801))["foot"]
    assert np.isfinite(foot).all() and np.ptp(foot.real) > 2 * np.ptp(
        foot.imag[foot.imag < np.median(foot.imag)]
    )


def test_hoeken_is_symmetric_and_straight() -> None:
    """Exact symmetry about the crank's perpendicular through the ground line; straight over half a turn to 0.4 %."""
    theta = np.linspace(0.01, math.pi, 500)
    machine = hoeken(10.0)
    there, back = (
        solve(machine, sign * theta + (math.tau if sign < 0 else 0))["trace"] for sign in (1, -1)
    )
    centre = 20.0
    side = there - centre, back - centre
    np.testing.assert_allclose(side[0], -np.conj(side[1]), atol=1e-11)
    straight = solve(machine, np.linspace(math.pi / 2, 3 * math.pi / 2, 500))["trace"]
    assert np.ptp(straight.imag) < 0.01 * np.ptp(straight.real)


@pytest.mark.parametrize("ratio", [-1.0, 2.0, 1.0])
def test_geared_five_bar_by_hand(ratio: float) -> None:
    run = solve(geared_five_bar(ratio), THETA)
    a = 20 * np.exp(1j * (THETA + math.pi))
    b = 60 + 20 * np.exp(1j * ratio * THETA)
    length = abs(30 + 70j + 20)
    way = b - a
    p = (a + b) / 2 + 1j * way / np.abs(way) * np.sqrt(length**2 - np.abs(way) ** 2 / 4)
    np.testing.assert_allclose(run["P"], p, atol=1e-12)
    if ratio == -1:
        np.testing.assert_allclose(run["P"].real, 30, atol=1e-12)  # mirror-symmetric


@pytest.mark.parametrize("name", CHAINS)
def test_derivatives_against_differences(name: str) -> None:
    machine = CHAINS[name]()
    theta, h = np.linspace(0.3, 3.9, 40), 1e-3
    rows = [solve(machine, theta + k * h) for k in range(-3, 4)]
    for output in machine.outputs:
        values, first, second = rows[3].derivatives(output.name)
        f = [row.derivatives(output.name)[0] for row in rows]
        slope = (45 * (f[4] - f[2]) - 9 * (f[5] - f[1]) + (f[6] - f[0])) / (60 * h)
        bend = (270 * (f[4] + f[2]) - 27 * (f[5] + f[1]) + 2 * (f[6] + f[0]) - 490 * f[3]) / (
            180 * h * h
        )
        size = max(1.0, float(np.abs(values).max()))
        assert np.isfinite(values).all()
        np.testing.assert_allclose(first, slope, atol=2e-10 * size, rtol=1e-9)
        np.testing.assert_allclose(second, bend, atol=2e-7 * size, rtol=1e-6)


def test_a_dyad_put_through_newton_gives_the_same() -> None:
    for name in ("four-bar", "slider-crank", "Whitworth", "Scotch yoke", "Jansen"):
        machine, again = CHAINS[name](), CHAINS[name]()
        chain = chain_of(again)
        chain.steps = [step.block if isinstance(step, Dyad) else step for step in chain.steps]
        for output in machine.outputs:
            a, b = (solve(m, THETA).derivatives(output.name) for m in (machine, again))
            np.testing.assert_allclose(a, b, atol=1e-10, err_msg=name)


def test_angles_are_continuous_whatever_the_order_of_theta() -> None:
    machine = four_bar(9, 30, 30, 19)  # the rocker turns with the crank
    theta = np.array([9.0, 0.0, -4.0, 30.0, 3.0])
    fine = solve(machine, np.linspace(-4, 30, 5001))["rocker"]
    assert np.abs(np.diff(fine)).max() < 0.03
    np.testing.assert_allclose(
        solve(machine, theta)["rocker"],
        np.interp(theta, np.linspace(-4, 30, 5001), fine),
        atol=1e-4,
    )


def test_either_sense_of_turning() -> None:
    base = jansen()
    back = Machine(
        base.bodies,
        base.joints,
        (Drive("motor", "crank", Turning(-1.0, base.drives[0].law(np.zeros(1))[0])),),
        base.start,
        outputs=base.outputs,
    )
    a, b = solve(base, THETA), solve(back, -THETA)
    np.testing.assert_allclose(a["foot"], b["foot"], atol=1e-12)
    np.testing.assert_allclose(a.velocity["foot"], -b.velocity["foot"], atol=1e-11)


def test_where_a_dyad_does_not_close_it_is_nan() -> None:
    machine = slider_crank(30.0, 20.0)
    run = solve(
        machine, np.array([0.1, math.pi / 2, math.asin(2 / 3) + 1e-9, math.asin(2 / 3) - 1e-9])
    )
    assert (np.isfinite(run["way"]) == [True, False, False, True]).all()
    assert (np.isnan(run.forces().drives["motor"]) == [False, True, True, False]).all()


def test_newton_stops_at_a_dead_point() -> None:
    machine = stephenson_three(crank=8 + 7j)
    theta = np.linspace(0, math.tau, 721)
    run = solve(machine, theta)
    good = np.isfinite(run["D"])
    end = theta[good].max()
    assert 1 < end < 6 and good[theta <= end].all() and not good[theta > end].any()
    # what is there is right: lengths by hand
    d, e = run["D"][good], run.point("last", "E")[0][good]
    np.testing.assert_allclose(np.abs(d - e), abs((50 + 90j) - (138 + 62j)), atol=1e-11)


@pytest.mark.parametrize("near", [-3.4e-17, -1e-300, -1e-12, -1e-9, 1e-17])
def test_newton_follows_a_chain_to_an_angle_beside_the_drawn_one(near: float) -> None:
    """So little turning moves it by its speed as drawn."""
    for machine in (stephenson_three(), double_butterfly()):
        there, here = solve(machine, np.array([near])), solve(machine, np.zeros(1))
        for output in machine.outputs:
            place, speed = here.derivatives(output.name)[:2]
            np.testing.assert_allclose(there[output.name], place + near * speed, rtol=0, atol=1e-11)


def test_driven_cylinder_lifts_an_arm() -> None:
    """A length that is driven in a chain of unknown angles (an excavator's ram): law of cosines."""
    machine, law = excavator(), Wave(50.0, 12.0)
    run = solve(machine, THETA)
    length = law(THETA)
    corner = np.arccos((30**2 + 40**2 - length**2) / (2 * 30 * 40))
    np.testing.assert_allclose(run["arm"], corner - math.pi / 2, atol=1e-12)
    np.testing.assert_allclose(run["ram"], length, atol=1e-12)


def test_planet_carrier() -> None:
    """A planet on a turning arm, geared to a fixed sun: it turns (1 - ratio) times with the arm."""
    machine = planetary()
    run = solve(machine, THETA)
    np.testing.assert_allclose(run["planet"], 2 * THETA, atol=1e-13)
    np.testing.assert_allclose(
        run["Q"], 30 * np.exp(1j * THETA) + 15 * np.exp(2j * THETA), atol=1e-12
    )


def test_wedge_of_three_slides() -> None:
    """Three slides in a ring: 3 n - 2 j says none, but it moves: along / lift = the wedge's slope."""
    machine, slope, push = wedge(), 0.3, Wave(-5.0, 5.0)
    np.testing.assert_allclose(solve(machine, THETA)["up"], slope * (10 - push(THETA)), atol=1e-13)


def test_slot_on_two_moving_bodies_by_newton_and_by_hand() -> None:
    """Elliptic trammel: two sliders on crossed lines, the bar's angle driven: its ends run straight."""
    bodies = (Body(GROUND), Body("bar", {"A": 0j, "B": 50 + 0j}))
    joints = (
        Slot("x", Place(GROUND), Place("bar")),
        Slot("y", Place(GROUND), Place("bar", 50 + 0j), math.pi / 2),
    )
    machine = Machine(
        bodies,
        joints,
        (Drive("motor", "bar", Turning(1.0, 2.0)),),
        {"bar": Pose(-50 * complex(math.cos(2)), 2.0)},
        outputs=(Output("x", Along("x")), Output("y", Along("y"))),
    )
    run = solve(machine, THETA)
    np.testing.assert_allclose(run["x"], -50 * np.cos(THETA + 2), atol=1e-12)
    np.testing.assert_allclose(run["y"], 50 * np.sin(THETA + 2), atol=1e-12)


@settings(max_examples=40, deadline=None)
@given(closing_four_bars(), st.sampled_from([1, -1]))
def test_random_four_bars_keep_their_lengths(lengths: tuple[float, ...], branch: int) -> None:
    frame, crank, coupler, rocker = lengths
    run = solve(four_bar(frame, crank, coupler, rocker, branch), THETA[:60])
    b, a = run["B"], crank * np.exp(1j * THETA[:60])
    np.testing.assert_allclose(np.abs(b - a), coupler, atol=1e-12)
    np.testing.assert_allclose(np.abs(b - frame), rocker, atol=1e-12)
    assert (np.sign(((b - a) * np.conj(frame - a)).imag) == branch).all()
