"""The judge's route: it agrees with the maker's on every chain, sees what is wrong, and tells each joint's share."""

from __future__ import annotations

import ast
import math
from dataclasses import replace
from pathlib import Path as File

import numpy as np
import pytest
from chains import CHAINS, closing_four_bars, four_bar, jansen, ram_machine, stephenson_three, take_up, wedge
from hypothesis import given, settings
from hypothesis import strategies as st

from camgen.machine import Cam, Gear, Machine, Pin, Place, Slide, Slot, solve
from camgen.machine import constraints as module
from camgen.machine.closing import close
from camgen.machine.constraints import Constraints

THETA = np.sort(np.random.default_rng(5).uniform(0, math.tau, 60))


def poses(machine: Machine, theta: np.ndarray) -> np.ndarray:
    return np.asarray(solve(machine, theta)._poses)


@pytest.mark.parametrize("name", CHAINS)
def test_both_routes_agree(name: str) -> None:
    machine = CHAINS[name]()
    q, first, second = poses(machine, THETA)
    closed = close(Constraints(machine), THETA)
    both = np.isfinite(q).all(axis=1)
    assert (np.isfinite(closed.q).all(axis=1) == both).all() and both.sum() > 30
    assert np.abs(closed.q - q)[both].max() < 1e-11
    assert np.abs(closed.first - first)[both].max() < 1e-10
    assert np.abs(closed.second - second)[both].max() < 1e-9


def test_a_ring_of_slides_by_both_routes() -> None:
    np.testing.assert_allclose(close(Constraints(wedge()), THETA).q, poses(wedge(), THETA)[0], atol=1e-12)


@settings(max_examples=25, deadline=None)
@given(closing_four_bars(), st.sampled_from([1, -1]))
def test_random_four_bars_by_both_routes(lengths: tuple[float, ...], branch: int) -> None:
    machine = four_bar(*lengths, branch)
    closed = close(Constraints(machine), THETA[::6])
    assert np.abs(closed.q - poses(machine, THETA[::6])[0]).max() < 1e-11


def test_it_shares_nothing_with_the_maker_but_the_model() -> None:
    tree = ast.parse(File(module.__file__).read_text(encoding="utf-8"))
    ours = {node.module for node in ast.walk(tree) if isinstance(node, ast.ImportFrom) and "camgen" in (node.module or "")}
    assert ours == {"camgen.machine.model", "camgen.numerics"}


# Imports inside the kernel go to its earlier rows only.
ROWS = (
    {"model", "strength", "flywheel"}, {"jets", "constraints", "targets", "balancing"}, {"friction"},
    {"closing", "order", "dyads", "forces", "freedom", "features", "closed_form", "four_bars", "landmarks"},
    {"newton"}, {"state"}, {"loops"}, {"reach", "run"}, {"cams", "centrodes", "joining", "print_errors"}, {"__init__"},
)  # fmt: skip


def test_imports_inside_the_package_go_down() -> None:
    row = {name: k for k, names in enumerate(ROWS) for name in names}
    files = sorted(File(module.__file__).parent.glob("*.py"))
    assert {file.stem for file in files} == row.keys() - {"cams"}
    for file in files:
        for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
            if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("camgen.machine"):
                path = (node.module or "").split(".")[2:]
                for name in path[:1] or [alias.name for alias in node.names]:
                    assert row.get(name, len(ROWS)) < row[file.stem], f"{file.stem} imports {name}"


def test_a_guess_saves_the_way_there() -> None:
    machine = jansen()
    guess = poses(machine, THETA)[0] + 0.05
    np.testing.assert_allclose(close(Constraints(machine), THETA, guess).q, guess - 0.05, atol=1e-12)


def test_a_displaced_hole_moves_the_output_by_its_share() -> None:
    """First order against the machine closed anew with a joint displaced, for each kind of joint."""
    for machine, output in ((ram_machine(), "way"), (take_up(), "thread"), (jansen(), "foot")):
        system = Constraints(machine)
        q = close(system, THETA).q
        (shares,) = system.shares([output], q, THETA)
        value = system.output(output, q)[0]
        for joint in machine.joints:
            moved = 0.0
            for h in (1e-7, 1e-7j) if isinstance(joint, Pin) else (1e-7,):
                again = Constraints(replace(machine, joints=tuple(displaced(j, h) if j is joint else j for j in machine.joints)))
                change = np.abs(again.output(output, close(again, THETA, q).q)[0] - value) / 1e-7
                assert (change <= shares[joint.name] * (1 + 1e-4) + 1e-5).all(), joint.name
                moved = moved + change**2
            if not isinstance(joint, Pin) or output != "foot":
                # A pin's two displacements turn with its body: the share is the length of both together.
                np.testing.assert_allclose(np.sqrt(moved), shares[joint.name], rtol=1e-4, atol=1e-5, err_msg=joint.name)


def displaced(joint: object, h: complex) -> object:
    """The joint with a small displacement, mm or rad."""
    if isinstance(joint, Pin):
        return replace(joint, a=Place(joint.a.body, joint.a.at + h))
    if isinstance(joint, Slide | Slot):
        across = 1j * complex(math.cos(joint.angle), math.sin(joint.angle))
        return replace(joint, guide=Place(joint.guide.body, joint.guide.at + h * across))
    if isinstance(joint, Gear):
        return replace(joint, phase=joint.phase + h.real)
    assert isinstance(joint, Cam)
    return replace(joint, rest=joint.rest + h.real)


def test_a_wrong_hole_is_seen_at_the_output() -> None:
    machine = take_up()
    wanted = solve(machine, THETA)["thread"]
    joints = tuple(displaced(j, 0.03 + 0j) if j.name == "B" else j for j in machine.joints)
    system = Constraints(replace(machine, joints=joints))  # type: ignore[arg-type]
    found = system.output("thread", close(system, THETA).q)[0]
    assert np.abs(found - wanted).max() > 0.02


def test_beyond_a_dead_point_there_is_nothing() -> None:
    theta = np.linspace(0, math.tau, 100)
    closed = close(Constraints(stephenson_three(crank=8 + 7j)), theta)
    good = np.isfinite(closed.q).all(axis=1)
    assert good[0] and not good.all() and (np.diff(good.astype(int)) != 0).sum() == 1
    assert (np.isfinite(poses(stephenson_three(crank=8 + 7j), theta)[0]).all(axis=1) == good).all()


def test_conditions_that_do_not_match_are_refused() -> None:
    machine = four_bar(40, 15, 45, 35)
    with pytest.raises(ValueError, match="8 conditions for 3 bodies"):
        close(Constraints(replace(machine, drives=())), THETA)
