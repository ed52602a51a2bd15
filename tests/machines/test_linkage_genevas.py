"""[[geneva]] in a linkage: what its spec says, where the pin goes, what is made, and what it bears."""

from __future__ import annotations

import copy
import math
import re
from typing import Any

import numpy as np
import pytest

import camgen
from camgen import load
from camgen.errors import DesignError, SpecError
from camgen.machines.loads.assess import assess
from camgen.parts.turning_over import middle
from camgen.parts.wheels.geneva import Geneva, geneva

SPEC: dict[str, Any] = {
    "mechanism": "linkage",
    "name": "table",
    "points": {"O": [0, 0], "C": [60, 0], "P": [-40, 3]},
    "links": {"ground": ["O", "C"], "crank": ["O", "P"], "wheel": ["C"]},
    "drive": {"link": "crank", "speed_rpm": 60},
    "geneva": [
        {"a": "crank", "b": "wheel", "pin": "P", "slots": 4, "pin_radius": 5, "name": "step"}
    ],
    "output": [{"name": "table", "link": "wheel"}],
}


def spec(**changes: Any) -> dict[str, Any]:
    """The tables with other keys of their Geneva drive."""
    tables = copy.deepcopy(SPEC)
    tables["geneva"][0] |= changes
    return tables


@pytest.fixture(scope="module")
def machine() -> camgen.Mechanism:
    return load(SPEC)


def test_the_pin_is_where_it_enters_along_a_slot(machine: camgen.Mechanism) -> None:
    """However it is drawn; by the right angle of crank and slot there."""
    crank = machine.model.body("crank")
    assert abs(crank.points["P"] - crank.points["O"]) == pytest.approx(60 * math.sin(math.pi / 4))


def test_the_wheel_turns_by_a_slot_a_turn_against_the_crank(machine: camgen.Mechanism) -> None:
    table = np.asarray(machine.solve(np.linspace(0, 2 * math.tau, 721))["table"])
    assert table[-1] - table[0] == pytest.approx(-math.pi, abs=1e-9)


def test_the_wheel_of_the_model_is_the_closed_form(machine: camgen.Mechanism) -> None:
    theta = np.linspace(0, math.tau, 721)
    run = machine.solve(theta)
    pin = 60 * math.sin(math.pi / 4) * np.exp(1j * (theta + math.atan2(3, -40)))
    seen = np.angle((60 - pin) / 60)
    drives = np.abs(np.angle(pin)) < math.pi / 4
    moved = np.asarray(run["table"])[drives]
    assert np.ptp(moved - np.unwrap(seen[drives])) < 1e-9
    rests = np.abs(np.angle(pin)) > math.pi / 4
    still = np.asarray(run["table"])[rests]
    assert np.abs(still[:, None] - np.array([still[0], still[-1]])).min(axis=1).max() < 1e-12


def test_a_gap_stands_the_disc_on_its_crank_with_a_dowel_in_both() -> None:
    """Shafts lean by 0.2 in 5 mm, at rims 60 mm from shaft to shaft by 2.4 mm together; from level to level there are 0.2."""
    made = load(spec(gap=2.5)).assembly
    stands = {mount.part: mount for mount in made.mounts}
    parts = made.by_name
    disc, wheel, dowel = "lock-step", "geneva-step", "dowel-lock-step"
    top = stands["crank"].z + parts["crank"].thickness
    assert stands[disc].z == pytest.approx(top)
    assert stands[wheel].z - top == pytest.approx(2.5)
    assert parts[disc].thickness == pytest.approx(2.5 + parts[wheel].thickness)
    assert stands[dowel].z == pytest.approx(stands["crank"].z)
    assert parts[dowel].thickness == pytest.approx(parts["crank"].thickness + parts[disc].thickness)
    place = stands[dowel].at
    for name in ("crank", disc):
        holes = [
            hole for hole in parts[name].region.holes if abs(hole.area) < math.tau * 2.6**2 / 2
        ]
        nearest = min(abs(stands[name].place(middle(hole)) - place) for hole in holes)
        assert nearest < 1e-6, "one axis"
    bores = [hole for hole in parts[disc].region.holes if abs(middle(hole)) < 1e-9]
    assert all(len(hole.pieces) == 1 for hole in bores), "the dowel turns it: no flat"
    assert load(SPEC).assembly.by_name[disc].thickness == parts[wheel].thickness


def test_a_gap_is_more_than_crank_and_wheel_tip() -> None:
    with pytest.raises(DesignError, match=r"tip by 2.4 mm .* more than the gap of 2 mm"):
        _ = load(spec(gap=2)).assembly
    thick = spec(gap=2) | {"parts": {"base_thickness": 7}}
    assert "dowel-lock-step" in load(thick).assembly.by_name
    cut = spec(gap=3) | {"parts": {"make": "laser"}, "laser": {"thickness": 4}}
    with pytest.raises(DesignError, match="leave geneva.gap out"):
        _ = load(cut).assembly
    with pytest.raises(SpecError, match="dowels hold both wheel and lock"):
        load(spec(gap=2, inner=True))


INNER: dict[str, Any] = SPEC | {
    "points": {"O": [50, 0], "C": [0, 0], "P": [80, 3]},
    "geneva": [SPEC["geneva"][0] | {"inner": True}],
    "parts": {"thickness": 5},
}


def test_an_inner_wheel_turns_with_its_crank_by_the_closed_form() -> None:
    machine = load(INNER)
    theta = np.linspace(0, math.tau, 721)
    angle = theta + math.atan2(3, 30)
    seen = np.angle(50 + 50 * math.sin(math.pi / 4) * np.exp(1j * angle))
    table = np.asarray(machine.solve(theta)["table"])
    drives = np.cos(angle) > math.cos(3 * math.pi / 4)
    first = drives & (angle < math.pi)
    assert np.ptp((table - seen)[first]) < 1e-9
    assert table[-1] - table[0] == pytest.approx(math.pi / 2, abs=1e-9)
    rests = ~drives
    assert np.ptp(table[rests]) < 1e-12
    assert machine.study().numbers["peak_speed_ratio_step"] == pytest.approx(0.41421, abs=5e-6)


def test_a_ring_hangs_round_a_crescent_on_its_crank() -> None:
    """Both on one level over the crank, where its shaft ends; the table lies over the head of the crank's pin."""
    made = load(INNER).assembly
    heights = {mount.part: mount.z for mount in made.mounts}
    thick = {part.name: part.thickness for part in made.parts}
    crank = heights["crank"] + thick["crank"]
    assert heights["lock-step"] == pytest.approx(crank)
    assert heights["shaft"] + thick["shaft"] == pytest.approx(crank)
    assert crank < heights["geneva-step"] == heights["roller-step"]
    ring = heights["geneva-step"] + thick["geneva-step"]
    assert ring == pytest.approx(heights["wheel"])
    pin = max(each.z + thick[each.part] for each in made.mounts if each.body == "crank")
    assert pin < heights["wheel"]


def test_what_presses_in_an_inner_slot_is_the_wheel_s_inertia_over_its_lever() -> None:
    machine = load(INNER)
    found = assess(machine)
    (bent,) = [each for each in found.findings if "under step" in str(each.where)]
    theta = np.linspace(0, math.tau, 1441)
    run = machine.solve(theta)
    _, rate, change = (np.asarray(each) for each in run.derivatives("table"))
    pin = 50 + 50 * math.sin(math.pi / 4) * np.exp(1j * (theta + math.atan2(3, 30)))
    inertia = machine.model.body("wheel").inertia
    force = np.abs(inertia * change * machine.model.speed**2) * 1e3 / np.abs(pin)
    told = re.match(r"([\d.]+) N", bent.message)
    assert told is not None and float(told[1]) == pytest.approx(force[rate != 0].max(), rel=1e-3)


@pytest.mark.long
@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"slots": 10}, "wall of the link crank .* dowel 2"),
        ({"pin_radius": 40}, "smaller pin"),
        ({"slots": 3}, "cannot pass on any level"),
    ],
)
def test_inner_drives_that_cannot_be_are_refused(changes: dict[str, Any], words: str) -> None:
    with pytest.raises(DesignError, match=words):
        assert load(INNER | {"geneva": [INNER["geneva"][0] | changes]}).assembly


def test_parts_lie_on_one_level_over_the_crank(machine: camgen.Mechanism) -> None:
    heights = {mount.part: mount.z for mount in machine.assembly.mounts}
    level = {heights[f"{name}-step"] for name in ("geneva", "lock", "roller")}
    assert len(level) == 1 and level.pop() > heights["crank"]


def test_what_presses_in_the_slot_is_the_wheel_s_inertia_over_its_lever(
    machine: camgen.Mechanism,
) -> None:
    """HERTZ of the roller by the greatest torque that the wheel's acceleration asks for, and the pin that bends."""
    found = assess(machine)
    (bent,) = [each for each in found.findings if "under step" in str(each.where)]
    assert bent.code == "PIN_STRESS" and bent.ok
    theta = np.linspace(0, math.tau, 1441)
    wheel = machine.model.body("wheel").inertia
    run = machine.solve(theta)
    _, rate, change = (np.asarray(each) for each in run.derivatives("table"))
    pin = 60 * math.sin(math.pi / 4) * np.exp(1j * (theta + math.atan2(3, -40)))
    force = np.abs(wheel * change * machine.model.speed**2) * 1e3 / np.abs(60 - pin)
    most = force[rate != 0].max()
    told = re.match(r"([\d.]+) N", bent.message)
    assert told is not None and float(told[1]) == pytest.approx(most, rel=1e-3)
    assert found.study.numbers["hertz_pressure_step_mpa"] > 0
    assert machine.study().numbers["peak_speed_ratio_step"] == pytest.approx(2.41421, abs=5e-6)


@pytest.mark.parametrize(
    ("changes", "path", "words"),
    [
        ({"a": "cranck"}, ("geneva", 0, "a"), "crank"),
        ({"b": "crank"}, ("geneva", 0, "b"), "another link"),
        ({"b": "ground"}, ("geneva", 0, "b"), "moves"),
        ({"pin": "O"}, ("geneva", 0, "pin"), "that is not on its shaft: P"),
        ({"pin": "C"}, ("geneva", 0, "pin"), "a point of crank"),
        ({"slots": 2}, ("geneva", 0, "slots"), "3"),
        ({"name": "drive"}, ("geneva", 0, "name"), "drive already has this one"),
        ({"name": "wheel"}, ("links", "wheel"), "Geneva drive"),
    ],
)
def test_faults_say_where_and_what(
    changes: dict[str, Any], path: tuple[str | int, ...], words: str
) -> None:
    with pytest.raises(SpecError) as caught:
        load(spec(**changes))
    (fault,) = [each for each in caught.value.faults if tuple(each.path) == path]
    assert words in f"{fault.expected} {fault.nearest}"


def test_a_length_of_the_crank_is_a_fault() -> None:
    with pytest.raises(SpecError, match=r"lengths.*O-P.*left out"):
        load(SPEC | {"lengths": {"O-P": 30}})


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"pin_radius": 20}, "smaller pin"),
        ({"slots": 8}, "sweep away the end of the disc that locks it"),
        ({"pin_radius": 2.4}, "wall"),
    ],
)
def test_drives_that_cannot_be_are_refused_by_what_to_change(
    changes: dict[str, Any], words: str
) -> None:
    with pytest.raises(DesignError, match=words):
        assert load(spec(**changes)).assembly


def test_a_refusal_names_a_pin_and_a_distance_that_can_be() -> None:
    """Of eight stations: with that pin or that distance there is a drive, with a pin a tenth thicker or axes 1 mm nearer none."""
    with pytest.raises(DesignError) as caught:
        geneva(Geneva, 8, 70.0, 5.0, 3.0, 0.05)
    pin, distance = map(float, re.findall(r"at (?:most|least) ([\d.]+) mm", caught.value.remedy))
    Geneva(8, 70.0, pin, 3.0)
    Geneva(8, distance, 5.0, 3.0)
    for sizes in ((8, 70.0, pin + 0.1, 3.0), (8, distance - 1, 5.0, 3.0)):
        with pytest.raises(DesignError):
            Geneva(*sizes)
