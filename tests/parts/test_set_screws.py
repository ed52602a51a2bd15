"""Hubs with a set screw: walls by hand, solids against Green's theorem, the collar in a machine and its sweep, slip told."""

from __future__ import annotations

import math
from pathlib import Path

import pytest

from camgen import starters
from camgen.errors import DesignError, SpecError
from camgen.machines.loads.assess import assess
from camgen.machines.sources import read_mechanism
from camgen.parts.assembly import order_of_assembly
from camgen.parts.catalogue import SCREWS
from camgen.parts.part import Tap
from camgen.parts.set_screws import SetScrewHub
from camgen.parts.solids import solid
from camgen.pipeline.build import build

SPECS = starters.folder()
HUB = (
    "parts.hub_height=8",
    "parts.hub_diameter=21",
    "parts.set_screw=M3",
    "load.mass_kg=0.2",
    "spring.preload=20",
)
MOTOR = (
    "parts.make='printed'",
    "parts.motor=nema-17",
    "parts.shaft_diameter=5.0",
    "parts.shaft_flat=0.5",
    "parts.set_screw=M3",
)


@pytest.mark.parametrize(
    "hub",
    [
        SetScrewHub("M3", 5.0, 0.5, 0.8, 2.0),
        SetScrewHub("M3", 8.0, 0.0, 0.8, 2.0),
        SetScrewHub("M3", 6.35, 1.8, 1.0, 2.0),
        SetScrewHub("M2", 4.0, 0.0, 0.8, 2.0),
    ],
)
def test_the_hub_is_a_sound_solid_with_room_for_its_nut(hub: SetScrewHub) -> None:
    part, screw = hub.collar(), SCREWS[hub.thread]
    mesh = solid(part, 0.005)
    assert mesh.volume == pytest.approx(part.volume, rel=2e-3)
    plain, pocket, cut, top = part.layers
    assert pocket.region.holes[1].area == pytest.approx(
        (screw.flats + 0.2) * (screw.nut + 0.2)
    )  # the nut and 0.1 mm around it
    assert part.thickness - plain.z1 == pytest.approx(
        2 * screw.flats / math.sqrt(3) + 0.2
    )  # it stands on a corner
    assert cut.z1 - cut.z0 == pytest.approx(screw.clearance) and not cut.region.holes
    assert (cut.z0 + cut.z1) / 2 == pytest.approx(
        (plain.z1 + part.thickness) / 2
    )  # the screw meets the nut's middle
    assert cut.region.area < pocket.region.area == pytest.approx(top.region.area)


def test_a_hub_too_small_and_a_screw_too_thick_are_refused() -> None:
    hub = SetScrewHub("M3", 5.0, 0.5, 0.8, 2.0)
    with pytest.raises(DesignError, match="diameter of the hub"):
        hub.layers(hub.least_radius - 0.1)
    thick = SetScrewHub("M5", 5.0, 0.5, 0.8, 2.0)
    with pytest.raises(DesignError, match="hole of the set screw"):
        thick.layers(thick.least_radius)


def test_what_a_set_screw_holds_is_that_of_the_cited_table() -> None:
    """Cup points on steel, lb in and lb: the axial force over that of the screw at its torque is HOLDS, within a quarter."""
    for diameter, torque, axial in (
        (0.112, 5.2, 50),
        (0.190, 36, 200),
        (0.25, 87, 400),
        (0.375, 290, 1000),
        (0.5, 620, 1500),
    ):
        assert axial / (torque / (0.2 * diameter)) == pytest.approx(0.22, rel=0.25)


def test_slip_holds_and_fails_and_a_flat_is_not_judged() -> None:
    def slips(*more: str) -> list[bool]:
        findings = assess(read_mechanism(SPECS / "disc-cam.toml", (*HUB, *more))).findings
        return [each.ok for each in findings if each.code == "HUB_SLIP"]

    assert slips() == [False] and slips("load.mass_kg=0.01", "spring.preload=5") == [True]
    assert slips("parts.shaft=d-flat") == []
    numbers = assess(read_mechanism(SPECS / "disc-cam.toml", HUB)).study.numbers
    face = (
        math.sqrt(3) / 2 * 5.5**2 - 3.4**2
    )  # of an M3 nut, mm^2; PLA bears 20 MPa across its layers
    assert numbers["set_screw_holds_n_m"] == pytest.approx(0.2 * 20 * face * 4e-3)


def test_faults_of_a_set_screw() -> None:
    for settings, path in (
        (("parts.set_screw=M3", "parts.hub_height=5"), "parts.hub_height"),
        (("parts.set_screw=M3", "parts.hub_height=9", "parts.shaft=keyway"), "parts.set_screw"),
        (("parts.make='printed'", "parts.set_screw=M3"), "parts.set_screw"),
    ):
        with pytest.raises(SpecError) as caught:
            read_mechanism(SPECS / "disc-cam.toml", settings)
        assert path in [fault.key for fault in caught.value.faults]


KEYED = (
    "material.name=C45",
    "geometry.base_radius=32",
    "parts.bore=20",
    "parts.bore_shape=keyway",
    "parts.set_screw=M5",
)


def test_a_set_screw_on_a_key_is_listed_drawn_and_keeps_a_cam_of_metal() -> None:
    """A hub of 36 has 5.2 mm over the keyway of 20 (2.8 deep, DIN 6885): a thread M5 of one diameter, and a screw of 5 within it."""
    bare = "parts.hub_diameter=", "parts.hub_height="
    made = read_mechanism(SPECS / "disc-cam.toml", [*KEYED, *bare])
    (row,) = [each for each in made.assembly.bought if each.name == "set screw of the hub"]
    assert row.size.startswith("M5 x 5, flat point") and "on the key" in row.how
    (cam,) = made.assembly.parts
    # the hub is 12 high on a cam of 12, its thread from 10 + 2.8 to 36 / 2 from the axis
    assert made.making.hub_height == 12
    assert cam.tap == Tap("M5", 18.0, pytest.approx(12.8), 18.0)
    assert not any("sliding along" in each for each in made.remarks().warnings)
    pair = read_mechanism(SPECS / "disc-cam.toml", [*KEYED, *bare, "geometry.closure=conjugate"])
    (row,) = [each for each in pair.assembly.bought if each.name == "set screw of the hub"]
    assert (row.count, row.at) == (2, ())
    loose = read_mechanism(SPECS / "disc-cam.toml", [*KEYED[:-1], *bare])
    assert [each.name for each in loose.assembly.bought if each.standard == "DIN 471"]
    assert loose.making.hub_height == 8 and loose.assembly.parts[0].tap is None
    for settings, path in (
        (("parts.hub_height=7",), "parts.hub_height"),
        (("parts.hub_height=8", "parts.hub_diameter=35"), "parts.hub_diameter"),
        (("parts.hub_height=8", "parts.hub_diameter=36", "material.name=PLA"), "parts.set_screw"),
    ):
        with pytest.raises(SpecError) as caught:
            read_mechanism(SPECS / "disc-cam.toml", [*KEYED, *settings])
        assert [fault.key for fault in caught.value.faults] == [path]


def test_a_collar_stands_in_parts_list_steps_reach_and_sweep() -> None:
    made, without = (
        read_mechanism(SPECS / "disc-cam.toml", settings) for settings in (MOTOR, MOTOR[:-1])
    )
    assert "shaft-collar" in {part.name for part in made.assembly.parts} - {
        part.name for part in without.assembly.parts
    }
    assert {"set screw of the hub", "nut of the set screw"} <= {
        thing.name for thing in made.assembly.bought
    }
    assert any("shaft-collar" in row for row in order_of_assembly(made.assembly).rows)
    assert made.assembly.motor.reach is not None and without.assembly.motor.reach is not None
    assert made.assembly.motor.reach > without.assembly.motor.reach + 5
    (collar,) = (mount for mount in made.assembly.mounts if mount.part == "shaft-collar")
    over = [mount for mount in made.assembly.mounts if mount.part == "follower"]
    assert collar.body == "cam" and over


def test_a_hub_with_a_set_screw_is_proven_from_its_files(tmp_path: Path) -> None:
    made = read_mechanism(SPECS / "disc-cam.toml", (*HUB, "parts.shaft=d-flat"))
    report = build(made, tmp_path, frozenset({"stl"}))
    assert report.ok and {"ROUND_TRIP", "VOLUME", "WATERTIGHT"} <= {
        each.code for each in report.findings
    }
