"""What a run answers: the take-up's published figures, rates in time, poses, play, records that travel."""

from __future__ import annotations

import math
import pickle
import tomllib
from dataclasses import replace
from pathlib import Path as File

import numpy as np
import pytest
from chains import CHAINS, geared_five_bar, jansen, scotch_yoke, slider_crank, take_up

from camgen.errors import SpecError
from camgen.machine import Body, Pin, Place, solve
from camgen.machine.closing import close
from camgen.machine.constraints import Constraints

CITED = tomllib.loads(
    (File(__file__).parent.parent / "reference" / "thread-take-up.toml").read_text(encoding="utf-8")
)
TURN = np.linspace(0, math.tau, 3601)


@pytest.mark.parametrize(("interchanged", "reading"), [(False, "printed"), (True, "interchanged")])
def test_eye_of_the_take_up(interchanged: bool, reading: str) -> None:
    run = solve(take_up(interchanged), np.radians(CITED["eye_angle_deg"]))
    assert np.abs(run["D"] - np.array(CITED[f"eye_{reading}"]) @ [1, 1j]).max() < 1e-9


def test_rates_and_transmission_of_the_take_up() -> None:
    run = solve(take_up(), TURN)
    rate = run.derivatives("rocker")[1]
    assert [rate.min(), rate.max()] == pytest.approx([0.523911844, 1.619809264], abs=1e-6)
    assert math.degrees(TURN[rate.argmin()]) == pytest.approx(253.8, abs=0.06)
    coupler = run.angle("coupler")
    assert [coupler[1].min(), coupler[1].max()] == pytest.approx(
        [0.698801607, 1.431021322], abs=1e-6
    )
    assert rate[:-1].mean() == pytest.approx(1, abs=1e-9) and coupler[1][
        :-1
    ].mean() == pytest.approx(1, abs=1e-9)
    corner = np.degrees(np.arccos(np.cos(coupler[0] - run["rocker"])))
    assert [corner.min(), corner.max()] == pytest.approx(
        [44.0034273488996, 103.18348148622], abs=1e-9
    )


def test_thread_of_the_take_up() -> None:
    length = solve(take_up(True), TURN)["thread"]
    assert [length.max(), length.min(), np.ptp(length)] == pytest.approx(
        [274.3539, 192.1888, 82.1651], abs=2e-4
    )


def test_speeds_are_in_time_and_of_either_sign() -> None:
    theta = np.linspace(0.1, 6, 20)
    machine = slider_crank(10, 40, speed=5.0)
    run, back = solve(machine, theta), solve(replace(machine, speed=-5.0), theta)
    rows = run.derivatives("way")
    np.testing.assert_allclose(run.velocity["way"], 5 * rows[1])
    np.testing.assert_allclose(run.acceleration["way"], 25 * rows[2])
    np.testing.assert_allclose(back.velocity["way"], -run.velocity["way"])
    np.testing.assert_allclose(back.acceleration["way"], run.acceleration["way"])
    assert set(run.velocity) == {"way"} and len(run.acceleration) == 1


@pytest.mark.parametrize("name", CHAINS)
def test_poses_carry_points_and_joints_meet(name: str) -> None:
    machine = CHAINS[name]()
    theta = np.linspace(0.1, 3.8, 30)
    run = solve(machine, theta)
    for joint in machine.joints:
        if isinstance(joint, Pin):
            a, b = (run.point(place.body, place.at) for place in (joint.a, joint.b))
            np.testing.assert_allclose(a, b, atol=1e-9)
            pose = run.pose(joint.a.body)
            np.testing.assert_allclose(
                pose.place + np.exp(1j * pose.angle) * joint.a.at, a[0], atol=1e-11
            )


def test_play_of_each_joint_at_the_output() -> None:
    theta = np.linspace(0.1, 6, 15)
    play = solve(scotch_yoke(), theta).play("way")
    np.testing.assert_allclose(
        play.by_joint["slot"], 0.01, atol=1e-14
    )  # the slot's walls carry straight over
    np.testing.assert_allclose(play.by_joint["O"], 0.01, atol=1e-14)
    np.testing.assert_allclose(play.by_joint["guide"], 0, atol=1e-14)  # across the way
    np.testing.assert_allclose(play.total, 0.02, atol=1e-14)
    gear = solve(geared_five_bar(), theta).play("P")
    assert (
        set(gear.by_joint) == {"O", "C", "A", "B", "P", "gear"}
        and (gear.by_joint["gear"] > 0).all()
    )


def test_many_angles_are_printed_in_a_line() -> None:
    run = solve(scotch_yoke(), np.linspace(0.1, 6, 1000))
    assert (
        repr(run.play("way")) == "Play at 1000 angles: up to total 0.02, O 0.01, guide 0, slot 0.01"
    )
    assert (
        repr(run.forces()).startswith("Forces at 1000 angles; reactions to O ")
        and len(repr(run.forces())) < 200
    )


def test_play_of_a_slider_crank_by_hand() -> None:
    """In line with the rod a pin's play reaches the slider in full, over the rod's cosine elsewhere."""
    theta = np.linspace(0.1, 6, 15)
    play = solve(slider_crank(10, 40), theta).play("way")
    lean = np.arcsin(10 * np.sin(theta) / 40)
    for name in ("A", "B"):
        np.testing.assert_allclose(play.by_joint[name], 0.05 / np.cos(lean), atol=1e-13)
    np.testing.assert_allclose(play.by_joint["guide"], 0.025 * np.abs(np.tan(lean)), atol=1e-13)


def test_orders_that_were_not_asked_for_are_refused() -> None:
    run = solve(slider_crank(), [0.1, 0.2], order=1)
    assert run.velocity["way"].shape == (2,)
    asked = [
        (lambda: run.acceleration["way"], "order=2"),
        (run.forces, "order=2"),
        (lambda: run.columns(3), "order: 3 - expected 0, 1 or 2"),
        (lambda: solve(slider_crank(), 0.0, order=3), "order: 3 - expected 0, 1 or 2"),
    ]
    for ask, told in asked:
        with pytest.raises(SpecError, match=told) as caught:
            ask()
        assert isinstance(caught.value, ValueError)


def test_low_orders_agree_with_high_ones_and_empty_is_empty() -> None:
    theta = np.linspace(0, 6, 50)
    for name, make in CHAINS.items():
        machine = make()
        for output in machine.outputs:
            full = solve(machine, theta).derivatives(output.name)
            for order in (0, 1):
                part = solve(machine, theta, order).derivatives(output.name)
                np.testing.assert_array_equal(part, full[: order + 1], err_msg=name)
            assert solve(machine, []).derivatives(output.name).shape == (3, 0)


def test_records_travel() -> None:
    for make in (jansen, take_up, geared_five_bar):
        machine = make()
        again = pickle.loads(pickle.dumps(machine))
        name = machine.outputs[0].name
        np.testing.assert_array_equal(
            solve(machine, [0.3, 2.0])[name], solve(again, [0.3, 2.0])[name]
        )


@pytest.mark.long
def test_judged_and_made_outputs_agree() -> None:
    theta = np.linspace(0.1, 3.8, 30)
    for name, make in CHAINS.items():
        machine = make()
        system = Constraints(machine)
        q = close(system, theta).q
        for output in machine.outputs:
            value = system.output(output.name, q)[0]
            np.testing.assert_allclose(
                value, solve(machine, theta)[output.name], atol=1e-11, err_msg=name
            )


def test_names_that_are_not_there() -> None:
    machine = slider_crank()
    with pytest.raises(ValueError, match="named twice: rod"):
        replace(machine, bodies=(*machine.bodies, Body("rod")))
    with pytest.raises(ValueError, match="named twice: guide"):
        replace(machine, joints=(*machine.joints, machine.joint("guide")))
    with pytest.raises(ValueError, match="P is on nobody"):
        replace(machine, joints=(*machine.joints, Pin("P", Place("nobody"), Place("rod"))))
    with pytest.raises(ValueError, match="without a start: rod"):
        replace(
            machine, start={name: pose for name, pose in machine.start.items() if name != "rod"}
        )


def test_a_run_lists_its_outputs_and_says_which_names_it_has() -> None:
    run = solve(slider_crank(), TURN[:3])
    names = [output.name for output in run.machine.outputs]
    assert list(run) == names == list(run.velocity) and names[0] in run and "nix" not in run
    assert "nix" not in run.velocity and run.acceleration.get("nix") is None
    asked = [
        run.pose,
        run.angle,
        run.length,
        run.play,
        lambda name: run.point(name, 0j),
        lambda name: run.point("rod", name),
    ]
    for ask in asked:
        with pytest.raises(SpecError, match="'nix' - expected "):
            ask("nix")
    with pytest.raises(SpecError, match="output: 'nix' - expected "):
        run["nix"]
