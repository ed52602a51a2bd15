"""Pins of a linkage that are discs round their link's shaft, motors with a round can, round shafts, rails where they are asked for."""

from __future__ import annotations

import copy
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from camgen.errors import DesignError, SpecError
from camgen.geometry.outlines import Arc
from camgen.machines.linkage.mechanism import Linkage
from camgen.parts.part import Part
from camgen.pipeline import build as pipeline
from camgen.spec import validate

CAN = {"boss_diameter": 6.0, "diameter": 21.0, "length": 25.0}
PUMP: dict[str, Any] = {
    "mechanism": "linkage",
    "name": "pump",
    "points": {"O": [0, 0], "E": [8, 0], "P": [88, 0], "R": [88, 0], "S": [80, 0]},
    "links": {"ground": ["O", "R", "S"], "crank": ["O", "E"], "rod": ["E", "P"], "ram": ["P"]},
    "drive": {"link": "crank"},
    "slide": [{"link": "ram", "along": ["R", "S"]}],
    "output": [{"name": "travel", "link": "ram"}],
    "parts": {"discs": {"E": 30.0}},
}


def pump(**parts: Any) -> Linkage:
    """An eccentric of 8 mm on a shaft of 6, its strap's rod 80 long; parts: further keys of [parts]."""
    spec = copy.deepcopy(PUMP)
    spec["parts"] |= parts
    return validate(Linkage, spec)


def parts_of(machine: Linkage) -> dict[str, Part]:
    return {part.name: part for part in machine.assembly.parts}


def circles(part: Part, layer: int) -> list[tuple[complex, float]]:
    """Centre and diameter of the round contours of a layer."""
    region = part.layers[layer].region
    arcs = [
        contour.pieces[0]
        for contour in (region.outer, *region.holes)
        if len(contour.pieces) == 1 and isinstance(contour.pieces[0], Arc)
    ]
    return [(arc.centre, 2 * arc.radius) for arc in arcs]


def test_a_disc_moves_as_a_pin_does() -> None:
    """x = e cos + sqrt(l^2 - (e sin)^2), from the outermost place inwards."""
    theta = np.linspace(0, math.tau, 40)
    x = 8 * np.cos(theta) + np.sqrt(80**2 - (8 * np.sin(theta)) ** 2)
    np.testing.assert_allclose(pump().motion(theta), 88 - x, atol=1e-12)


def test_disc_strap_and_keeper_have_their_sizes() -> None:
    """The disc is of one piece with its crank, as high as its strap and two plays, its keeper on it."""
    machine = pump()
    parts = parts_of(machine)
    assert circles(parts["crank"], 1) == [(8 + 0j, 30.0)]  # round its D-shaped bore
    assert (parts["crank"].layers[1].z0, parts["crank"].thickness) == (4.0, 4 + 4 + 2 * 0.2)
    assert (0j, 30.2) in circles(parts["rod"], 0)
    z = {mount.part: mount.z for mount in machine.assembly.mounts}
    assert z["keeper-1"] == pytest.approx(z["crank"] + parts["crank"].thickness)
    (eyes,) = (each for each in machine.assembly.features if getattr(each, "joint", "") == "E")
    assert {(eye.part, eye.diameter, eye.shaft) for eye in (eyes.a, eyes.b)} == {  # type: ignore[attr-defined]
        ("crank", 30.0, True),
        ("rod", 30.2, False),
    }


@pytest.mark.long
@pytest.mark.parametrize(
    "more", [{}, {"can": CAN, "shaft_flat": 0.0, "shaft_diameter": 3.0}, {"plates": 2}]
)
def test_it_is_proven_from_its_files(tmp_path: Path, more: dict[str, Any]) -> None:
    """Nothing overlaps over the turn, walls and motion hold."""
    spec = copy.deepcopy(PUMP)
    spec["parts"] |= more
    report = pipeline.build(spec, tmp_path, frozenset({"stl", "3mf"}))
    assert [f for f in report.findings if not f.ok] == []
    assert {"INTERFERENCE", "MIN_WALL", "MOTION_ERROR", "LASH"} <= {f.code for f in report.findings}


def test_a_disc_without_a_wall_says_which_has_one() -> None:
    """30 / 2 - 8 - 6 / 2 = 4; of 23 there is 0.5."""
    with pytest.raises(DesignError, match="parts.discs.E of 23.6 mm or more works") as caught:
        _ = pump(discs={"E": 23.0}).assembly
    assert caught.value.value == pytest.approx(0.5, abs=1e-12) and caught.value.limit == 0.8
    assert pump(discs={"E": 23.7}).assembly.parts


@pytest.mark.parametrize(
    ("discs", "said"),
    [({"P": 30.0}, "no shaft goes through it"), ({"O": 30.0}, "no shaft goes through it")],
)
def test_what_is_no_disc_is_refused(discs: dict[str, float], said: str) -> None:
    with pytest.raises(DesignError, match=said):
        _ = pump(discs=discs).assembly


@pytest.mark.parametrize(
    ("keys", "path"),
    [
        ({"discs": {"Q": 30.0}}, "parts.discs.Q"),
        ({"can": CAN, "motor": "nema-17"}, "parts.can"),
        ({"shaft_flat": 0.0, "shaft": "interrupted"}, "parts.shaft_flat"),
        ({"can": {"diameter": 21.0, "length": 25.0}}, "parts.can.boss_diameter"),
        ({"shaft_key": True, "can": CAN}, "parts.shaft_key"),
        ({"shaft_key": True}, "parts.shaft_made"),
        ({"shaft_key": True, "shaft": "interrupted"}, "parts.shaft"),
        ({"shaft_key": True, "shaft_diameter": 5.0}, "parts.shaft_diameter"),
        ({"shaft_key": True, "discs": {"E": 30.0}}, "parts.shaft_key"),
    ],
)
def test_faults_are_told_by_their_keys(keys: dict[str, Any], path: str) -> None:
    with pytest.raises(SpecError) as caught:
        pump(**keys)
    assert path in [fault.key for fault in caught.value.faults]


def test_a_round_shaft_has_round_holes() -> None:
    machine = pump(shaft_flat=0.0)
    parts = parts_of(machine)
    assert circles(parts["shaft"], 0) == [(0j, 6.0)] and (0j, 6.0) in circles(parts["crank"], 0)
    assert any("round shaft of 6" in line.size for line in machine.assembly.bought)


def test_a_motor_with_a_can_sits_by_its_boss_and_is_held_by_a_bar() -> None:
    machine = pump(can=CAN, shaft_flat=0.0, shaft_diameter=3.0, ram={"stem": "behind"})
    parts, lines = parts_of(machine), {line.name: line for line in machine.assembly.bought}
    assert "shaft" not in parts and (0j, 6.0) in circles(parts["ground"], 0)
    bar = next(mount for mount in machine.assembly.mounts if mount.part == "motor-bar")
    assert bar.z == -25 - 5 and parts["motor-bar"].thickness == 5
    # through 5 less a head of 2 sunk by 0.2, the can, the bar, and a nut of 1.6
    assert (
        lines["screw of the motor"].size == "M2 x 35, with a nut"
        and lines["nut of the motor"].count == 2
    )
    # plate, crank, rod and the keeper of 1.5, a play under each
    assert machine.assembly.motor.reach == pytest.approx(5 + 4.2 + 4.2 + 1.7)


@pytest.mark.parametrize(("stem", "way"), [("ahead", -1), ("behind", 1)])
def test_rails_lie_where_they_are_asked_for(stem: str, way: int) -> None:
    """The line of the slide goes from R towards the shaft, ahead is -x; rails of 24 mm over all."""
    guide = pump(ram={"stem": stem, "rails": 24.0}).bodies.layout.guides["ram"]
    ends = sorted(z.real for rail in guide.rails for z in rail)
    assert all(way * (x - (80 if way > 0 else 72)) > 0 for x in ends)
    assert max(ends) - min(ends) + 5 == pytest.approx(24)
