"""The judge's route: it agrees with the maker's on every chain, sees what is wrong, and tells each joint's share."""

from __future__ import annotations

import ast
import math
from dataclasses import replace
from pathlib import Path as File

import numpy as np
import pytest
from chains import (
    CHAINS,
    Wave,
    closing_four_bars,
    four_bar,
    jansen,
    ram_machine,
    stephenson_three,
    take_up,
    wedge,
)
from hypothesis import given, settings
from hypothesis import strategies as st

from camgen.machine import (
    GROUND,
    Along,
    Angle,
    Body,
    Cam,
    Drive,
    Function,
    Gear,
    Machine,
    Output,
    Path,
    Pin,
    Place,
    Pose,
    Slide,
    Slot,
    solve,
)
from camgen.machine import constraints as module
from camgen.machine.closing import _follow, close
from camgen.machine.constraints import Constraints, _stretch
from camgen.machine.model import Clutch, Turning, placed

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
    np.testing.assert_allclose(
        close(Constraints(wedge()), THETA).q, poses(wedge(), THETA)[0], atol=1e-12
    )


@pytest.mark.long
@settings(max_examples=25, deadline=None)
@given(closing_four_bars(), st.sampled_from([1, -1]))
def test_random_four_bars_by_both_routes(lengths: tuple[float, ...], branch: int) -> None:
    machine = four_bar(*lengths, branch)
    closed = close(Constraints(machine), THETA[::6])
    assert np.abs(closed.q - poses(machine, THETA[::6])[0]).max() < 1e-11


def test_it_shares_nothing_with_the_maker_but_the_model() -> None:
    tree = ast.parse(File(module.__file__).read_text(encoding="utf-8"))
    ours = {
        node.module
        for node in ast.walk(tree)
        if isinstance(node, ast.ImportFrom) and "camgen" in (node.module or "")
    }
    assert ours == {"camgen.machine.model", "camgen.machine.elimination", "camgen.numerics"}


# Imports inside the kernel go to its earlier rows only.
ROWS = (
    {"model", "strength", "flywheel", "matching", "run_up", "slow_walk"},
    {"elimination"},
    {"jets", "constraints", "targets", "balancing", "programs", "freewheels", "tree"},
    {"friction", "closed_form"},
    {"grashof"},
    {
        "closing",
        "order",
        "dyads",
        "forces",
        "freedom",
        "features",
        "four_bars",
        "landmarks",
    },
    {"newton"},
    {"state"},
    {"loops"},
    {"reach", "run"},
    {"cams", "centrodes", "joining", "print_errors", "stepwise"},
    {"__init__"},
)


def test_imports_inside_the_package_go_down() -> None:
    row = {name: k for k, names in enumerate(ROWS) for name in names}
    files = sorted(File(module.__file__).parent.glob("*.py"))
    assert {file.stem for file in files} == row.keys() - {"cams"}
    for file in files:
        for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
            if isinstance(node, ast.ImportFrom) and (node.module or "").startswith(
                "camgen.machine"
            ):
                path = (node.module or "").split(".")[2:]
                for name in path[:1] or [alias.name for alias in node.names]:
                    assert row.get(name, len(ROWS)) < row[file.stem], f"{file.stem} imports {name}"


class Counted:
    """A law sin(angle) / 2 that remembers at which arrays of angles its values were asked."""

    def __init__(self) -> None:
        self.asked: list[np.ndarray] = []

    def __call__(self, angle: np.ndarray, order: int = 0) -> np.ndarray:
        if order == 0:
            self.asked.append(np.array(angle))
        return np.asarray(np.sin(angle + order * math.pi / 2) / 2)


def test_laws_one_after_the_other_are_asked_where_they_are_wanted() -> None:
    """A cam on the follower of another one, listed first: neither is asked at the angles of a guess that is off."""
    first = Counted()
    second = Counted()
    bodies = [Body(name, {"O": 0j}) for name in ("crank", "arm", "flap")]
    machine = Machine(
        bodies=(Body(GROUND, {"O": 0j, "P": 60 + 0j, "Q": 90 + 0j}), *bodies),
        joints=(
            Cam("second", "arm", "flap", second, phase=0.3, rest=0.2),
            Cam("first", "crank", "arm", first, rest=-0.1),
            *(
                Pin(f"at {point}", Place(GROUND, z), Place(body.name, 0j))
                for body, point, z in zip(bodies, "OPQ", (0j, 60 + 0j, 90 + 0j), strict=True)
            ),
        ),
        drives=(Drive("motor", "crank"),),
        start={
            body.name: Pose(z, 0.0) for body, z in zip(bodies, (0j, 60 + 0j, 90 + 0j), strict=True)
        },
    )
    system = Constraints(machine)
    guess = np.full((len(THETA), system.width), 0.01)
    closed = close(system, THETA, guess)
    arm = np.sin(THETA) / 2 - 0.1
    flap = np.sin(arm - 0.3) / 2 + 0.2
    wanted = np.column_stack([THETA, arm, flap])
    np.testing.assert_allclose(closed.q[:, 2::3], wanted, rtol=0, atol=1e-14)
    np.testing.assert_allclose(closed.q[:, 3], 60, rtol=0, atol=1e-12)
    for law, angle in ((first, THETA), (second, arm - 0.3)):
        many = [asked for asked in law.asked if len(asked) == len(THETA)]
        assert many
        for asked in many:
            np.testing.assert_allclose(asked, angle, rtol=0, atol=1e-14)


def test_a_guess_saves_the_way_there() -> None:
    machine = jansen()
    guess = poses(machine, THETA)[0] + 0.05
    np.testing.assert_allclose(
        close(Constraints(machine), THETA, guess).q, guess - 0.05, atol=1e-12
    )


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
                again = Constraints(
                    replace(
                        machine,
                        joints=tuple(displaced(j, h) if j is joint else j for j in machine.joints),
                    )
                )
                change = np.abs(again.output(output, close(again, THETA, q).q)[0] - value) / 1e-7
                assert (change <= shares[joint.name] * (1 + 1e-4) + 1e-5).all(), joint.name
                moved = moved + change**2
            if not isinstance(joint, Pin) or output != "foot":
                # A pin's two displacements turn with its body: the share is the length of both together.
                np.testing.assert_allclose(
                    np.sqrt(moved), shares[joint.name], rtol=1e-4, atol=1e-5, err_msg=joint.name
                )


def test_a_pose_without_a_guess_keeps_no_other_waiting(monkeypatch: pytest.MonkeyPatch) -> None:
    """From poses that are closed one step of Newton is enough, whatever the pose beside them does; it stays open."""
    system = Constraints(jansen())
    guess = poses(jansen(), THETA)[0]
    guess[7] = np.nan
    seen = []
    assert system.order.blocks  # worked out once
    written = Constraints.written

    def counted(self: Constraints, *given: object) -> object:
        seen.append(self)
        return written(self, *given)  # type: ignore[arg-type]

    monkeypatch.setattr(Constraints, "written", counted)
    q = close(system, THETA, guess, order=1).q
    assert len(seen) == 2  # the step, and what is left after it
    assert np.isnan(q).all(axis=1).tolist() == [k == 7 for k in range(len(q))]


@pytest.mark.parametrize("shape", [(1, 1), (1, 2), (2, 1), (2, 2)])
def test_a_stretch_is_the_largest_singular_value(shape: tuple[int, int]) -> None:
    matrices = np.random.default_rng(8).normal(size=(50, *shape))
    matrices[0], matrices[1], matrices[2] = 0.0, 1.0, np.eye(*shape)
    np.testing.assert_allclose(
        _stretch(matrices), np.linalg.svd(matrices, compute_uv=False)[:, 0], rtol=1e-12, atol=1e-15
    )


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


# ---- slopes and bends, by differences ----------------------------------------------------------------------------------


def indexed() -> Machine:
    """A wheel that a clutch turns, a carriage driven along it, and on that a pusher which a cam on the wheel lifts."""
    bodies = (Body("arm"), Body("wheel"), Body("carriage"), Body("pusher"))
    joints = (
        Pin("O", Place(GROUND, 2 + 1j), Place("arm")),
        Pin("W", Place(GROUND, 2 + 1j), Place("wheel", 0.5j)),
        Clutch(
            "clutch",
            "arm",
            "wheel",
            Wave(0.3, 0.2),
            lambda theta: np.where(np.cos(theta) > 0, 0.1, np.nan),
        ),
        Slide("rail", Place("wheel", 3 - 2j), Place("carriage", 1 + 1j), angle=0.4, turn=0.2),
        Slide("stem", Place("carriage", 1j), Place("pusher", 2 + 0j), angle=-0.7, turn=0.1),
        Cam(
            "lift",
            "wheel",
            "pusher",
            Wave(1, 4, 2, 0.3),
            slide="stem",
            phase=0.2,
            rest=5.0,
            closure="force",
        ),
    )
    drives = (
        Drive("motor", "arm", Wave(0.1, 0.6)),
        Drive("ram", "carriage", Wave(30, 9), slide="rail"),
    )
    start = {body.name: Pose(complex(3 * k, 2 - k), 0.3 * k) for k, body in enumerate(bodies)}
    pen = Output("pen", Path(Place("pusher", 4j)))
    outputs = Output("way", Along("rail")), Output("turn", Angle("pusher", "wheel"), "rad"), pen
    return Machine(bodies, joints, drives, start, outputs=outputs)


ALL = {**CHAINS, "wedge": wedge, "indexed": indexed}


def anywhere(system: Constraints, n: int = 5) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Poses at which nothing is closed, angles and rates."""
    rng = np.random.default_rng(11)
    q = system.start + rng.normal(size=(n, system.width)) * np.minimum(system.unit, 4)
    return q, rng.uniform(0, 6, n), rng.normal(size=(n, system.width))


@pytest.mark.parametrize("name", ALL)
def test_slopes_and_bends_of_conditions_are_those_of_their_values(name: str) -> None:
    """At poses that are not closed, by central differences: along each pose, along theta, and twice along a straight way."""
    system = Constraints(ALL[name]())
    q, theta, rates = anywhere(system)
    h = 1e-6
    _, slopes, bends = system.evaluate(q, theta, rates)
    size = np.abs(slopes).max() + np.abs(bends).max()
    for k, unit in enumerate(np.eye(system.width)):
        change = (
            system.evaluate(q + h * unit, theta)[0] - system.evaluate(q - h * unit, theta)[0]
        ) / (2 * h)
        np.testing.assert_allclose(slopes[:, :, k], change, atol=1e-8 * size)
    drift = (system.evaluate(q, theta + h)[0] - system.evaluate(q, theta - h)[0]) / (2 * h)
    driven = [system.rows[drive.name].start for drive in system.machine.drives]
    np.testing.assert_allclose(system.drift(theta)[:, driven], drift[:, driven], atol=1e-8 * size)
    h = 1e-3
    ahead, here, back = (system.evaluate(q + rates * t, theta + t)[0] for t in (h, 0.0, -h))
    free = np.isclose(drift, system.drift(theta)).all(axis=0)  # a clutch's own law is no drive's
    np.testing.assert_allclose(
        bends[:, free], ((ahead - 2 * here + back) / h**2)[:, free], atol=1e-5 * size
    )


@pytest.mark.parametrize("name", ALL)
def test_slopes_of_outputs_and_what_their_places_do_are_those_of_their_values(name: str) -> None:
    machine = ALL[name]()
    system = Constraints(machine)
    q, _, _ = anywhere(system)
    h = 1e-6
    for output in machine.outputs:
        value, gradient = system.output(output.name, q)
        for k, unit in enumerate(np.eye(system.width)):
            change = (
                system.output(output.name, q + h * unit)[0]
                - system.output(output.name, q - h * unit)[0]
            ) / (2 * h)
            slope = (
                gradient[:, 0, k] + 1j * gradient[:, 1, k]
                if gradient.shape[1] == 2
                else gradient[:, 0, k]
            )
            np.testing.assert_allclose(slope, change, atol=1e-7 * system.size)
        for place, *ways in system.by_place(output.name, q):
            for way, slope in zip((h, 1j * h), ways, strict=True):
                moved = placed(
                    output.of,
                    lambda each, place=place, way=way: replace(
                        each, at=each.at + way * (each is place)
                    ),
                )
                np.testing.assert_allclose(
                    slope, (system.measure(moved, q)[0] - value) / h, atol=1e-6 * system.size
                )
        places = len(system.by_place(output.name, q))
        assert places == (
            1
            if isinstance(output.of, Path)
            else len(output.of.of)
            if isinstance(output.of, Function)
            else 0
        )


def test_forces_do_the_work_of_their_places() -> None:
    """Generalised forces by the rates of the poses against force by speed, as differences tell it."""
    system = Constraints(ram_machine())
    q, _, rates = anywhere(system)
    rng = np.random.default_rng(3)
    force, h = rng.normal(size=len(q)) + 1j * rng.normal(size=len(q)), 1e-6
    for body in system.bodies:
        place, total = Place(body, 3 - 7j), np.zeros(q.shape)
        system.add_force(total, place, q, force)
        speed = (
            system.place(place, q + h * rates).position
            - system.place(place, q - h * rates).position
        ) / (2 * h)
        np.testing.assert_allclose(
            (total * rates).sum(axis=1), np.real(force.conj() * speed), rtol=1e-6, atol=1e-6
        )
    cam = next(joint for joint in system.machine.joints if isinstance(joint, Cam))
    where = rng.normal(size=len(q)) * 30 + 9j
    work = 0.0
    for body, sign in ((cam.follower, 1), (cam.cam, -1)):
        k = system.column[body]
        at = (where - q[:, k] - 1j * q[:, k + 1]) * np.exp(
            -1j * q[:, k + 2]
        )  # the place in the body's frame
        ahead, back = (
            (z[:, k] + 1j * z[:, k + 1] + at * np.exp(1j * z[:, k + 2]))
            for z in (q + h * rates, q - h * rates)
        )
        work = work + sign * np.real(force.conj() * (ahead - back)) / (2 * h)
    np.testing.assert_allclose(
        (system.wrench(cam, q, where, force) * rates).sum(axis=1), work, rtol=1e-6, atol=1e-5
    )


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


@pytest.mark.parametrize("name", ["four-bar", "slider-crank", "Whitworth", "Klann"])
def test_a_chain_is_followed_closely_on_its_branch(name: str) -> None:
    """Guesses from steps of at most ten degrees are within a hundredth of what closes, with the sign of its determinant."""
    system = Constraints(CHAINS[name]())
    theta = np.linspace(-1, 2, 90)
    guess, signs = _follow(system, theta)
    closed = close(system, theta)
    assert np.abs((guess - closed.q) / system.unit).max() < 0.01
    np.testing.assert_array_equal(signs, np.linalg.slogdet(system.evaluate(closed.q, theta)[1])[0])


@pytest.mark.parametrize("start, rate", [(1.0, 1.0), (-2.5, -2.0)])
def test_a_parallelogram_stays_one_where_its_links_lie_in_line(start: float, rate: float) -> None:
    """There both branches meet, and the determinant changes its sign; the rocker goes on as the crank does."""
    machine = Machine(
        (Body("crank"), Body("coupler"), Body("rocker")),
        (
            Pin("O", Place(GROUND), Place("crank")),
            Pin("A", Place("crank", 20), Place("coupler")),
            Pin("B", Place("coupler", 40), Place("rocker", 20)),
            Pin("C", Place(GROUND, 40), Place("rocker")),
        ),
        (Drive("motor", "crank", Turning(rate, start)),),
        {
            "crank": Pose(0j, start),
            "coupler": Pose(20 * np.exp(1j * start), 0.0),
            "rocker": Pose(40 + 0j, start),
        },
    )
    theta = np.linspace(-3, 3, 83) / abs(rate)
    system = Constraints(machine)
    closed = close(system, theta)
    np.testing.assert_allclose(closed.q[:, 8], start + rate * theta, atol=1e-9)
    np.testing.assert_allclose(closed.q[:, 5], 0.0, atol=1e-9)
    assert not _follow(system, theta)[
        1
    ].any()  # what the sign is to be is not known beyond the first of them
    near = np.linspace(-0.2, 0.2, 9)
    assert np.ptp(_follow(system, near)[1]) == 0 and _follow(system, near)[1].all()


def test_the_size_of_a_machine_is_its_largest_place() -> None:
    """A drawn place, a point of a body or 1 mm: misfits count by it, so that a machine far off or tiny closes as well."""
    for scale, shift in ((1.0, 0.0), (1.0, 500.0), (1e-3, 0.0)):
        lengths = [scale * each for each in (40.0, 15.0, 45.0, 35.0)]
        machine = four_bar(*lengths)
        moved = {name: Pose(pose.place + shift, pose.angle) for name, pose in machine.start.items()}
        points = tuple(replace(body, points={}) for body in machine.bodies)
        system = Constraints(replace(machine, bodies=points, start=moved))
        drawn_ = max(
            abs(part)
            for pose in moved.values()
            for part in (pose.place.real, pose.place.imag, pose.angle)
        )
        assert system.size == pytest.approx(max(1.0, drawn_))
        np.testing.assert_array_equal(system.unit, [system.size, system.size, 1.0] * 3)
        long = Constraints(
            replace(
                machine,
                bodies=(replace(machine.bodies[0], points={"x": 7777j}), *machine.bodies[1:]),
            )
        )
        assert long.size == 7777.0


def test_conditions_that_do_not_match_are_refused() -> None:
    machine = four_bar(40, 15, 45, 35)
    with pytest.raises(ValueError, match="8 conditions for 3 bodies"):
        close(Constraints(replace(machine, drives=())), THETA)
