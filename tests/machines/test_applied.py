"""[[load.on]] and friction: virtual work against closed forms, tables over theta, what is wrong told at once."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from camgen import starters
from camgen.errors import SpecError
from camgen.machine import Gravity, solve
from camgen.machines.loads.applied import Table
from camgen.machines.loads.assess import assess
from camgen.machines.mechanism import Mechanism
from camgen.machines.sources import read_mechanism
from camgen.motion.tables import load_table
from camgen.reading import read

SPECS = starters.folder()
TURN = np.linspace(0, math.tau, 361)


def made(name: str, *settings: str, **load: Any) -> Mechanism:
    """A starter with a table [load]."""
    data = read(SPECS / f"{name}.toml")
    data["load"] = {**data.get("load", {}), **load}
    return read_mechanism(data, settings)


def torque(mechanism: Mechanism) -> Any:
    return next(iter(solve(mechanism.model, TURN).forces().drives.values()))


def test_a_constant_load_on_a_lift_is_a_resistance() -> None:
    on = made("disc-cam", mass_kg=0.1, on=[{"output": "lift", "value": -10.0}])
    np.testing.assert_allclose(
        torque(on), torque(made("disc-cam", mass_kg=0.1, resistance=10.0)), atol=1e-12
    )
    assert np.max(np.abs(torque(on))) > 0.05
    less, more = (
        made("disc-cam", mass_kg=0.1, **each).limits()
        for each in ({}, {"on": [{"output": "lift", "value": -10.0}]})
    )
    held = [
        next(each.measured for each in limits if each.code == "LIFT_OFF") for limits in (less, more)
    ]
    assert held[0] < 0 < 9.5 < held[1]  # it presses the follower on its cam


def test_work_of_a_thread_and_of_a_brake() -> None:
    """A constant tension gives back what it takes; against the motion it takes T times all the way that goes by."""
    speed = made("thread-take-up").model.speed
    for acts, share in (("fixed", 0.0), ("along", 1.0)):
        machine = made("thread-take-up", on=[{"output": "feed", "value": -0.5, "acts": acts}])
        run, plain = (solve(each.model, TURN) for each in (machine, made("thread-take-up")))
        way = np.sum(np.abs(np.diff(run["feed"]))) * 1e-3
        more = np.mean((run.forces().power_in - plain.forces().power_in)[:-1])
        assert more == pytest.approx(
            share * 0.5 * way * abs(speed) / math.tau, rel=2e-4, abs=1e-9 * abs(speed)
        )


def test_a_jet_turns_with_its_body_and_a_weight_does_not() -> None:
    """On the end of a crank of 20 mm: across it a constant torque; hung on it that of a weight."""
    points = {"body": "crank", "point": "A", "value": 3.0}
    plain = torque(made("linkage"))
    jet = torque(made("linkage", on=[{**points, "direction_deg": 90.0, "acts": "with the body"}]))
    np.testing.assert_allclose(jet - plain, -0.06, atol=1e-12)
    hung = torque(made("linkage", on=[{**points, "direction_deg": -90.0}]))
    np.testing.assert_allclose(hung - plain, 0.06 * np.cos(TURN), atol=1e-12)
    place = torque(made("linkage", on=[{**points, "point": [20.0, 0.0], "direction_deg": -90.0}]))
    np.testing.assert_allclose(place, hung, atol=1e-12)
    held = torque(made("linkage", on=[{"body": "crank", "value": -0.06}]))
    np.testing.assert_allclose(held - plain, 0.06, atol=1e-12)
    brake = torque(made("linkage", on=[{**points, "value": -3.0, "acts": "along"}]))
    np.testing.assert_allclose(brake - plain, 0.06, atol=1e-12)


def test_table_over_theta() -> None:
    table = Table((0.0, 1.0, 2.0), (0.0, 4.0, 4.0))
    np.testing.assert_allclose(
        table(np.array([0.5, 1.5, 2.5, math.tau + 0.5, -0.001])), [2, 4, 0, 2, 0]
    )
    whole = Table((0.0, math.tau), (1.0, 3.0))
    np.testing.assert_allclose(whole(np.array([0.0, math.pi, math.tau])), [1, 2, 3])
    ahead = Table((-1.0, 1.0), (1.0, 1.0))
    np.testing.assert_allclose(ahead(np.array([math.tau - 0.5, 0.5, 3.0])), [1, 1, 0])


def test_a_table_may_be_in_a_file_beside_the_spec(tmp_path: Path) -> None:
    (tmp_path / "press.csv").write_text("deg, N\n0, 0\n90, -8\n180, 0\n", encoding="utf-8")
    spec, text = tmp_path / "mine.toml", starters.text("disc-cam")
    spec.write_text(f'{text}\n[[load.on]]\noutput = "lift"\nfile = "press.csv"\n', encoding="utf-8")
    found = read_mechanism(spec, ()).load
    assert (
        found is not None
        and found.on[0].points == ((0, 0), (90, -8), (180, 0))
        and found.on[0].source == "press.csv"
    )
    spec.write_text(f'{text}\n[[load.on]]\noutput = "lift"\nfile = "pres.csv"\n', encoding="utf-8")
    with pytest.raises(Exception, match="pres.csv"):
        read_mechanism(spec, ())


HEADINGS: list[tuple[str, tuple[float, float], str | None]] = [  # of a row 0.5, 2: what is meant
    ("theta_deg,force_n", (0.5, 2.0), "N"),
    ("theta_rad, force (kN)", (math.degrees(0.5), 2000.0), "N"),
    ("turn;torque [N mm]", (180.0, 0.002), "N m"),
    ("angle load", (0.5, 2.0), None),
    ("deg\tlbf", (0.5, 8.8964432), "N"),
    ("Winkel (\u00b0); Moment (Nm)", (0.5, 2.0), "N m"),
    ("", (0.5, 2.0), None),
    ("theta, force (measured)", (0.5, 2.0), None),
]


@pytest.mark.parametrize(("heading", "row", "unit"), HEADINGS)
def test_units_of_a_heading(
    heading: str, row: tuple[float, float], unit: str | None, tmp_path: Path
) -> None:
    (tmp_path / "a.csv").write_text(f"{heading}\n0;0\n0.5;2\n", encoding="utf-8")
    rows, found = load_table(tmp_path / "a.csv")
    assert rows[1] == pytest.approx(row) and found == unit


@pytest.mark.parametrize(
    "heading", ["theta_deg,force_mm", "theta_n,force_n", "deg, force (bar)", "deg;load [oz]"]
)
def test_a_heading_with_a_wrong_unit_is_told(heading: str, tmp_path: Path) -> None:
    (tmp_path / "a.csv").write_text(f"{heading}\n0;0\n0.5;2\n", encoding="utf-8")
    with pytest.raises(SpecError, match="heading of column"):
        load_table(tmp_path / "a.csv")


def test_a_load_that_jumps_from_turn_to_turn_is_told() -> None:
    whole, part, even = (
        [[0.0, 1.0], [360.0, 3.0]],
        [[90.0, 0.0], [180.0, 5.0]],
        [[0.0, 2.0], [180.0, 1.0], [360.0, 2.0]],
    )
    notes = assess(
        made("disc-cam", on=[{"output": "lift", "points": rows} for rows in (whole, part, even)])
    ).study.notes
    assert notes == [
        "Load load 1 jumps at 0 deg: its table ends with 3 and begins with 1.",
        "Load load 2 jumps at 180 deg from 5 to 0: outside its rows it is 0.",
    ]


WRONG: list[tuple[dict[str, Any], str, str]] = [
    ({"output": "lifts", "value": 1.0}, "load.on.0.output", "lift"),
    ({"body": "folower", "value": 1.0}, "load.on.0.body", "follower"),
    ({"body": "follower", "point": "tap", "value": 1.0, "acts": "along"}, "load.on.0.point", "tip"),
    ({"output": "lift"}, "load.on.0", "one of value, points and file"),
    ({"value": 1.0}, "load.on.0", "either output or body"),
    (
        {"output": "lift", "value": 1.0, "points": [[0.0, 1.0], [1.0, 1.0]]},
        "load.on.0",
        "one of value",
    ),
    (
        {"output": "lift", "points": [[90.0, 1.0], [0.0, 1.0]]},
        "load.on.0",
        "row 1 has 0 deg after 90",
    ),
    (
        {"output": "lift", "points": [[0.0, 1.0], [4.0, 1.0]], "unit": "N m"},
        "load.on.0.unit",
        "N on a way",
    ),
    ({"output": "lift", "points": [[0.0, 1.0], [400.0, 1.0]]}, "load.on.0", "within one turn"),
    (
        {"output": "lift", "value": 1.0, "direction_deg": 3.0},
        "load.on.0.direction_deg",
        "already has a direction",
    ),
    ({"body": "follower", "point": "tip", "value": 1.0}, "load.on.0", "direction_deg"),
    ({"output": "lift", "value": 1.0, "acts": "with the body"}, "load.on.0", "with a point"),
]


@pytest.mark.parametrize(("table", "path", "said"), WRONG)
def test_what_is_wrong_is_told_by_its_key(table: dict[str, Any], path: str, said: str) -> None:
    with pytest.raises(SpecError) as caught:
        made("disc-cam", on=[table])
    (fault,) = caught.value.faults
    assert fault.key == path and (said in fault.expected or said == fault.nearest)


def test_all_loads_that_are_wrong_are_told_at_once() -> None:
    with pytest.raises(SpecError) as caught:
        made(
            "disc-cam",
            on=[
                {"output": "a", "value": 1.0},
                {"name": "x", "body": "b", "value": 1.0},
                {"name": "x", "output": "lift", "value": 1.0},
            ],
        )
    assert [fault.key for fault in caught.value.faults] == [
        "load.on.0.output",
        "load.on.1.body",
        "load.on.2.name",
    ]


# ---- friction --------------------------------------------------------------------------------------------------------


def test_friction_is_in_the_drive_and_may_be_left_out() -> None:
    smooth, rough = (
        assess(made("linkage", friction=mu, gravity_deg=-90.0)).study.numbers for mu in (0.0, 0.3)
    )
    assert smooth["friction_heat_w"] == 0 and rough["friction_heat_w"] > 0
    assert smooth["drive_power_w"] == pytest.approx(0, abs=1e-6 * smooth["drive_torque_n_m"])
    assert rough["drive_power_w"] == pytest.approx(
        rough["friction_heat_w"], rel=1e-3
    )  # all that goes in becomes heat


def test_a_machine_that_locks_is_told() -> None:
    held = {"output": "ram", "value": -20.0, "acts": "along"}
    for mu, locks in ((0.1, False), (3.0, True)):
        findings = assess(made("quick-return", friction=mu, on=[held])).findings
        found = [each for each in findings if each.code == "SELF_LOCKING"]
        assert bool(found) is locks and all(
            not each.ok and 0 < each.measured <= 360 for each in found
        )


@pytest.mark.long
def test_a_machine_that_locks_says_which_friction_it_bears() -> None:
    held = {"output": "ram", "value": -20.0, "acts": "along"}

    def locks(mu: float) -> list[str]:
        findings = assess(made("quick-return", friction=mu, on=[held])).findings
        return [each.message for each in findings if each.code == "SELF_LOCKING"]

    (said,) = locks(3.0)
    assert said.startswith(
        "the machine locks at a friction of 3 (load.friction); it would turn with up to "
    )
    bears = float(said.partition("up to ")[2].partition(" in ")[0])
    assert 0 < bears < 3 and not locks(bears) and locks(bears + 0.02)


def test_what_inertia_does_to_a_pin_is_said_where_it_acts_alone() -> None:
    said = {
        gravity: [
            each.message
            for each in assess(made("linkage", **gravity_deg)).findings
            if each.code == "PIN_STRESS"
        ]
        for gravity, gravity_deg in ((False, {}), (True, {"gravity_deg": -90.0}))
    }
    assert said[True] and not any("Inertia" in each for each in said[True])
    assert said[False] and all("Inertia is the only load" in each for each in said[False])


def test_several_drives_are_one_shaft() -> None:
    """Power of a machine with included ones, each with its own drive, is the heat of all their joints."""
    machine = read_mechanism(SPECS / "stitch-head.toml", ())
    found = assess(machine).study.numbers
    assert found["drive_power_w"] == pytest.approx(found["friction_heat_w"], rel=1e-4)
    assert not any(isinstance(load, Gravity) for load in machine.model.loads)


FOUR_BAR: dict[str, Any] = {
    "mechanism": "linkage",
    "name": "four-bar",
    "points": {"O": [0, 0], "C": [80, -10], "A": [22, 0], "B": [70, 45], "S": [60, -20]},
    "links": {
        "ground": ["O", "C", "S"],
        "crank": ["O", "A"],
        "coupler": ["A", "B"],
        "rocker": ["C", "B"],
    },
    "drive": {"link": "crank", "speed_rpm": 90},
    "output": [{"name": "swing", "link": "rocker"}],
    "load": {
        "gravity_deg": -90,
        "friction": 0.2,
        "on": [{"body": "rocker", "point": "B", "value": 12, "direction_deg": -60}],
    },
    "spring": [{"between": ["B", "S"], "rate": 0.5, "preload": 3}],
    "masses": {"crank": {"mass_g": 20, "centre": [8, 1], "inertia_kg_m2": 2e-6}},
}


@pytest.mark.parametrize(
    "machine",
    [
        lambda: read_mechanism(FOUR_BAR),
        lambda: made("disc-cam", mass_kg=0.1, gravity_deg=-90.0),
        lambda: made("thread-take-up", gravity_deg=-90.0),
    ],
    ids=["linkage", "cam", "take-up"],
)
def test_forces_of_a_run_are_those_of_the_report(machine: Callable[[], Mechanism]) -> None:
    """Each reaction's peak over the angles that the report looks at; the energy of what is loaded and rubs adds up."""
    whole = machine()
    forces, numbers = (
        whole.solve(np.linspace(0, math.tau, 1441)).forces(),
        assess(whole).study.numbers,
    )
    for name, load in forces.reactions.items():
        assert numbers[f"reaction_{name.lower()}_n"] == pytest.approx(np.abs(load).max(), rel=1e-12)
    assert np.abs(forces.loads).max() > 0 < forces.rubs.max()
    np.testing.assert_allclose(
        forces.power,
        forces.power_in + forces.loads - forces.rubs,
        atol=1e-9 * np.abs(forces.power).max(),
    )


def test_the_frame_bears_what_pulls_on_the_machine() -> None:
    """Newton's law of the whole: what holds the moving bodies, their weight, the load and the spring make their inertia."""
    machine = read_mechanism(FOUR_BAR)
    run = machine.solve(TURN)
    forces, loaded = run.forces(), machine._weighed_machine()
    assert (
        loaded.body("crank").mass == 0.02 and loaded.body("rocker").mass > 1e-3
    )  # given; of its solids
    held = sum(
        forces.reactions[pin.name] * (1 if pin.b.body == "ground" else -1)
        for pin in loaded.joints
        if "ground" in (pin.a.body, pin.b.body)
    )
    weight = -9.80665j * sum(body.mass for body in loaded.moving)
    way = complex(60, -20) - run.point("rocker", "B")[0]
    (spring,) = (each for each in loaded.loads if hasattr(each, "rate"))
    pull = 0.5 * (np.abs(way) - spring.free) * way / np.abs(way)
    load = 12 * np.exp(-1j * math.pi / 3)
    np.testing.assert_allclose(held + weight + load + pull, -forces.shaking, atol=1e-9)
