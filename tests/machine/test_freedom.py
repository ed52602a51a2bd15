"""Freedoms, rough drawings, ranges and folds: what is loose, locked, driven twice or folds is told with its names."""

from __future__ import annotations

import math
import tomllib
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from chains import (
    CHAINS,
    four_bar,
    linked,
    peaucellier,
    scotch_yoke,
    slider_crank,
    stephenson_three,
)
from hypothesis import given, settings
from hypothesis import strategies as st

import camgen
from camgen.errors import DesignError
from camgen.machine import (
    GROUND,
    Body,
    Cam,
    Drive,
    Machine,
    Pin,
    Place,
    Pose,
    Slide,
    Turning,
    solve,
)
from camgen.machine.freedom import close_drawing, freedoms, refuse_unsound
from camgen.machine.reach import folds, reach, refuse_folds, refuse_partial

GALLERY = Path(__file__).parents[2] / "specs" / "gallery"


@pytest.mark.parametrize("name", CHAINS)
def test_sound_chains_have_one_freedom_and_no_more(name: str) -> None:
    found = refuse_unsound(CHAINS[name]())
    assert (found.count, found.drives, found.moves, found.spare, found.loose) == (1, 1, 0, 0, ())


def test_a_missing_drive_names_all_that_moves() -> None:
    machine = replace(four_bar(40, 15, 45, 35), drives=())
    said = r"1 degree of freedom left over: links crank, coupler and rocker .*3 x 3 - 2 x 4 - 0 = 1.*drive one"
    with pytest.raises(DesignError, match=said):
        refuse_unsound(machine)
    with pytest.raises(DesignError, match="is held by nothing"):
        solve(machine, [0.0])


def test_a_loose_body_is_named_alone() -> None:
    machine = four_bar(40, 15, 45, 35)
    wheel = Body("wheel")
    joints = (*machine.joints, Pin("axle", Place("wheel"), Place("rocker", 10 + 0j)))
    start = {**machine.start, "wheel": Pose(0j, 0.0)}
    loose = close_drawing(
        replace(machine, bodies=(*machine.bodies, wheel), joints=joints, start=start)
    )
    with pytest.raises(
        DesignError, match=r"1 degree of freedom left over: link wheel .*join it to another link"
    ) as error:
        refuse_unsound(loose)
    assert "rocker" not in error.value.where
    unheld = replace(machine, bodies=(*machine.bodies, wheel), start=start)
    with pytest.raises(DesignError, match=r"3 degrees of freedom left over: link wheel"):
        refuse_unsound(unheld)


def test_a_second_drive_is_named() -> None:
    machine = four_bar(40, 15, 45, 35)
    angle = machine.start["rocker"].angle
    twice = replace(
        machine, drives=(*machine.drives, Drive("second", "rocker", Turning(1.0, angle)))
    )
    with pytest.raises(
        DesignError,
        match="2 drives for 1 degree of freedom .*take away one of the drives motor and second",
    ):
        refuse_unsound(twice)
    with pytest.raises(DesignError, match="is held by more conditions than it needs"):
        solve(twice, [0.0])


def test_a_rigid_chain_and_an_over_constrained_loop_are_named() -> None:
    machine = four_bar(40, 15, 45, 35)
    brace = Body("brace")
    a, b = Place("crank", 7 + 0j), Place("rocker", 12 + 3j)
    rocker = machine.start["rocker"]
    far = rocker.place + np.exp(1j * rocker.angle) * b.at - 7
    braced = replace(
        machine,
        bodies=(*machine.bodies, brace),
        start={**machine.start, "brace": Pose(7 + 0j, float(np.angle(far)))},
        joints=(
            *machine.joints,
            Pin("P", Place("brace"), a),
            Pin("Q", Place("brace", complex(abs(far))), b),
        ),
    )
    with pytest.raises(DesignError, match="the chain is rigid"):
        refuse_unsound(braced)


def test_a_rigid_part_is_named_where_another_part_moves() -> None:
    """Gruebler counts one freedom in all: the wing that hangs on one pin has it, and the drive has none."""
    bird = tomllib.loads((GALLERY / "flapping-bird.toml").read_text(encoding="utf-8"))
    bird["links"]["ground"] = ["O", "L", "V"]
    said = "links crank, left_rod, right_rod and right_wing cannot move: joints O, A of left_rod"
    with pytest.raises(DesignError, match=said):
        camgen.load(bird).solve([0.0])


def test_of_several_loops_the_first_that_stops_the_crank_is_told() -> None:
    """Each of both has the rod 45 and the crank 90; a crank that is the shortest link of its loop is not told to be too long."""
    bird = tomllib.loads((GALLERY / "flapping-bird.toml").read_text(encoding="utf-8"))
    bird["lengths"]["O-A"] = 90
    with pytest.raises(DesignError) as refused:
        camgen.load(bird).solve([0.0])
    assert str(refused.value).count("Grashof") == 1
    bird["lengths"]["O-A"] = 9
    bird["points"]["W"] = [-7, 46]
    with pytest.raises(
        DesignError, match="draw W and L of left_wing at two places: they are at one$"
    ):
        camgen.load(bird).solve([0.0])


@pytest.mark.parametrize(
    ("lengths", "reach", "remedy"),
    [
        ((70, 20, 25, 25), "reach the 50 mm from C to A and no more", "a longer .*C-B or .*A-B"),
        ((70, 40, 20, 10), "reach the 30 mm from C to A and no more", "a longer .*C-B or .*A-B"),
        (
            (20, -5, 35, 10),
            "come down to the 25 mm .* no less",
            "a longer .*C-B or a shorter .*A-B",
        ),
    ],
)
def test_a_four_bar_that_lies_in_one_line_and_cannot_leave_it_is_told(
    lengths: tuple[float, float, float, float], reach: str, remedy: str
) -> None:
    """One link is as long as the other three together, so that no other position closes."""
    assert 2 * max(map(abs, lengths)) == sum(map(abs, lengths))
    said = f"at theta = 0 C, B and A lie in one line; rocker and coupler {reach}; {remedy}"
    with pytest.raises(DesignError, match=said):
        refuse_unsound(four_bar(*lengths))


def three_cranks() -> Machine:
    """A parallelogram with a third crank: 3 n - 2 j counts none, and it moves."""
    points = {"O": 0j, "C": 40 + 0j, "E": 20 + 0j, "A": 6 + 8j, "B": 46 + 8j, "D": 26 + 8j}
    links = {GROUND: "O C E", "crank": "O A", "bar": "A B D", "second": "C B", "third": "E D"}
    return linked(points, links, "crank")


def test_a_redundant_crank_moves_and_is_told_by_the_rank() -> None:
    found = freedoms(three_cranks())
    assert found.count == 0 and found.spare == 1 and found.moves == 0
    with pytest.raises(DesignError, match="over-constrained.*1 time too often.*slot"):
        refuse_unsound(three_cranks())


def test_a_special_drawing_does_not_hide_the_rank() -> None:
    """Drawn folded in one line a parallelogram's Jacobian is singular there, and nowhere else."""
    folded = four_bar(40, 15, 40, 15)
    assert freedoms(folded).moves == 0 and freedoms(folded).spare == 0
    refuse_unsound(peaucellier())


def test_rough_points_are_closed_on_exact_lengths() -> None:
    exact = four_bar(40, 15, 45, 35)
    rng = np.random.default_rng(7)
    rough = {
        name: Pose(p.place + complex(*rng.normal(0, 2, 2)), p.angle + rng.normal(0, 0.1))
        for name, p in exact.start.items()
    }
    again = close_drawing(replace(exact, start=rough))
    for name, pose in exact.start.items():
        assert again.start[name].place == pytest.approx(pose.place, abs=1e-11)
        assert again.start[name].angle == pytest.approx(pose.angle, abs=1e-12)


def test_contradicting_lengths_are_told_with_their_loop() -> None:
    machine = four_bar(40, 15, 45, 35)
    short = tuple(
        replace(j, a=Place(j.a.body, 5 + 0j), b=Place(j.b.body, 6 + 0j))
        if isinstance(j, Pin) and j.name == "B"
        else j
        for j in machine.joints
    )
    with pytest.raises(
        DesignError, match="contradict each other: joint.*B.* open by .* mm.*change the lengths"
    ) as error:
        close_drawing(replace(machine, joints=short))
    assert error.value.value > 1


def test_a_crank_too_long_for_its_loop_is_told_how_long_it_may_be() -> None:
    """A and C are 1 mm apart, coupler and rocker of 30 and 32 mm at least 2; a crank turns fully below 30 + 32 - 40."""
    points = {"O": 0j, "C": 40 + 0j, "A": 39 + 0j, "B": 39 + 30j}
    links = {GROUND: "O C", "crank": "O A", "coupler": "A B", "rocker": "C B"}
    with pytest.raises(
        DesignError, match=r"contradict.* open by .*crank turns fully if it is shorter than 22 mm$"
    ):
        linked(points, links, "crank", {"A-B": 30.0, "C-B": 32.0})


def test_range_of_a_chain_that_cannot_turn_fully() -> None:
    """A crank too long for its rod: it closes where the rod still reaches the guide; exact dead points."""
    found = reach(slider_crank(30.0, 20.0))
    end = math.asin(20 / 30)
    assert (
        not found.full
        and found.low == pytest.approx(-end, abs=1e-12)
        and found.high == pytest.approx(end, abs=1e-12)
    )
    assert "B" in found.ends[1]
    with pytest.raises(
        DesignError,
        match=r"cannot turn fully: .*from -41.81 to 41.81 deg.*drive.range_deg = ",
    ):
        refuse_partial(slider_crank(30.0, 20.0))
    refuse_partial(slider_crank())


def test_the_range_advised_keeps_the_transmission_angle() -> None:
    """Rod 20, crank 30: sin(theta) = 20 / 30 cos(mu), mu the rod's angle to the square of the guide."""
    end = math.degrees(math.asin(20 / 30 * math.cos(math.radians(30))))
    with pytest.raises(DesignError, match="with a transmission angle of 30 deg") as caught:
        refuse_partial(slider_crank(30.0, 20.0), 30.0)
    low, high = map(
        float, str(caught.value).partition("range_deg = [")[2].partition("]")[0].split(", ")
    )
    assert -end <= low < -end + 0.6 and end - 0.6 < high <= end
    with pytest.raises(DesignError, match="is below 90.1 deg as drawn"):
        refuse_partial(slider_crank(30.0, 20.0), 90.1)


@settings(max_examples=25, deadline=None)
@given(st.floats(20.2, 60.0), st.floats(5.0, 60.0))
def test_the_range_advised_is_one_that_is_judged_to_hold(crank: float, least: float) -> None:
    machine = slider_crank(crank, 20.0)
    with pytest.raises(DesignError, match="cannot turn fully") as caught:
        refuse_partial(machine, least)
    text = str(caught.value).partition("range_deg = [")[2].partition("]")[0]
    low, high = (math.radians(float(each)) for each in text.split(", "))
    (fold,) = folds(machine, low, high)
    assert math.degrees(math.asin(fold.determinant)) >= least
    ends = [math.degrees(math.asin(20 / crank * math.cos(math.radians(x)))) for x in (0, least)]
    assert (
        min(ends[0] - 1, ends[1]) - 0.8 < math.degrees(high) <= ends[1]
    )  # and no less than can be


def test_range_of_a_triple_rocker_by_the_law_of_cosines() -> None:
    frame, crank, coupler, rocker = 40.0, 25.0, 30.0, 32.0
    machine = four_bar(frame, crank, coupler, rocker)
    end = math.acos((frame**2 + crank**2 - (coupler + rocker) ** 2) / (2 * frame * crank))
    found = reach(machine)
    assert (found.low, found.high) == (pytest.approx(-end, abs=1e-7), pytest.approx(end, abs=1e-7))
    with pytest.raises(
        DesignError,
        match=r"crank \(25 mm\), and the longest, \w+ \(40 mm\), are together 3 mm longer .*than 22 mm",
    ):
        refuse_partial(machine)
    refuse_partial(four_bar(frame, 21.99, coupler, rocker))


def test_the_four_bar_at_which_a_larger_machine_opens_is_told_by_its_links() -> None:
    """The triple-rocker above, and a second four-bar on its crank that turns fully."""
    bar = four_bar(40, 25, 30, 32)
    points = {name: bar.start[link].place for name, link in (("O", "crank"), ("A", "coupler"))}
    points |= {"C": 40 + 0j, "W": -70 + 0j}
    points["B"] = points["A"] + 30 * np.exp(1j * bar.start["coupler"].angle)
    points["V"] = -40 + 50j
    links = {GROUND: "O C W", "crank": "O A", "coupler": "A B", "rocker": "C B"}
    links |= {"rod": "A V", "wing": "W V"}
    said = (
        r"by Grashof's rule in the loop of links crank, coupler and rocker the shortest, crank \(25 mm\), and the longest, \w+ "
        r"\(40 mm\), are together 3 mm longer than the other two; crank turns fully if it is shorter than 22 mm$"
    )
    with pytest.raises(DesignError, match=said):
        refuse_partial(linked(points, links, "crank"))


def test_range_by_newton_ends_at_the_same_dead_point_in_both_ways_of_solving() -> None:
    """Stephenson III from the far side: at its end the four-bar and the link stand so that the determinant is nothing."""
    machine = stephenson_three(crank=8 + 7j)
    found = reach(machine)
    assert not found.full and found.high - found.low < math.tau
    inside = np.array([found.low + 1e-4, found.high - 1e-4])
    beyond = np.array([found.low - 1e-9, found.high + 1e-9])
    assert (
        np.isfinite(solve(machine, inside)["D"]).all()
        and np.isnan(solve(machine, beyond)["D"]).all()
    )
    speed = np.abs(solve(machine, inside).derivatives("D")[1])
    usual = np.abs(solve(machine, [0.0]).derivatives("D")[1])
    assert (speed > 20 * usual).all()  # it stalls there: the output races against the drive


def test_a_parallelogram_has_its_change_points_told() -> None:
    machine = four_bar(40, 15, 40, 15)
    told = [fold for fold in folds(machine, -0.5, 0.5) if fold.change_point]
    assert told and told[0].joints == ("B",) and abs(told[0].theta) < 1e-6
    with pytest.raises(
        DesignError, match=r"change point at .* deg: the links at joint.* B .*transmission angle"
    ):
        refuse_folds(machine)
    refuse_folds(four_bar(40, 15, 45, 35))


def test_a_near_change_point_is_told_too() -> None:
    """A parallelogram 1 um off passes both routes in silence and they disagree; the determinant tells."""
    points = {"O": 0j, "C": 40 + 0j, "A": 15j, "B": 40 + 15j}
    links = {GROUND: "O C", "crank": "O A", "coupler": "A B", "rocker": "C B"}
    machine = linked(points, links, "crank", {"A-B": 40.0, "C-B": 15.000001})
    with pytest.raises(DesignError, match="change point"):
        refuse_folds(machine)
    clear = linked(points, links, "crank", {"A-B": 40.0, "C-B": 17.0})
    refuse_folds(clear, -0.5, 0.5)


def test_a_change_point_in_a_larger_block_is_passed_and_told() -> None:
    """A dyad of the parallelogram put through Newton goes straight on where the closed form turns back."""
    from camgen.machine.loops import chain_of
    from camgen.machine.state import Dyad

    points = {"O": 0j, "C": 40 + 0j, "A": 15j, "B": 40 + 15j}
    machine = linked(
        points, {GROUND: "O C", "crank": "O A", "coupler": "A B", "rocker": "C B"}, "crank"
    )
    chain = chain_of(machine)
    chain.steps = [step.block if isinstance(step, Dyad) else step for step in chain.steps]
    told = folds(machine)
    assert any(fold.passed for fold in told)
    assert {round(math.degrees(fold.theta)) for fold in told if fold.change_point} & {90, 270}


def test_a_cam_and_its_own_follower_alone() -> None:
    bodies = (Body(GROUND), Body("cam"), Body("tappet"))
    cam = Cam("contact", "cam", "tappet", Turning(2.0), "guide")
    joints = (
        Pin("O", Place("cam"), Place(GROUND)),
        Slide("guide", Place(GROUND), Place("tappet")),
        cam,
    )
    machine = Machine(
        bodies, joints, (Drive("motor", "cam"),), {"cam": Pose(0j, 0.0), "tappet": Pose(0j, 0.0)}
    )
    found = refuse_unsound(machine)
    assert (found.pairs, found.half_pairs, found.count) == (2, 1, 1)
    assert freedoms(scotch_yoke()).half_pairs == 1


def test_a_drawing_that_closes_stays_as_it_is() -> None:
    for name, make in CHAINS.items():
        machine = make()
        again = close_drawing(machine)
        for body, pose in machine.start.items():
            assert again.start[body].place == pytest.approx(pose.place, abs=1e-9), name
            assert again.start[body].angle == pytest.approx(pose.angle, abs=1e-10), name
