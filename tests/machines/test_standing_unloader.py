"""The unloader as it is made: its spring by hand and against the torque of a spring on a cord, and what cannot be made."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from camgen.errors import DesignError
from camgen.files.threemf import PartCopy, write_3mf
from camgen.geometry.mesh import Mesh, placing
from camgen.judge.assembly import sweep
from camgen.machine.run import solve
from camgen.machines.indexing_cam.mechanism import IndexingCam
from camgen.parts.assembly import bodies_in_motion, order_of_assembly
from camgen.parts.solids import solid
from camgen.reading import read
from camgen.spec import validate

SPECS = Path(__file__).resolve().parents[2] / "specs"
THETA = np.radians(np.arange(1.0, 360.0, 2.0))


def machine(**tables: Any) -> IndexingCam:
    data = read(SPECS / "indexing-cam.toml")
    data["parts"] |= {"make": "printed", "pin_diameter": 5.0}
    for name, table in tables.items():
        data[name] = {**data[name], **table}
    return validate(IndexingCam, data)


@pytest.fixture(scope="module")
def starter() -> IndexingCam:
    return machine()


@pytest.fixture(scope="module")
def meshes(starter: IndexingCam) -> dict[str, Mesh]:
    return {each.name: solid(each, 0.02) for each in starter.assembly.parts}


def test_the_list_names_the_springs_wire_and_its_forces(starter: IndexingCam) -> None:
    """The source's sizes: pin 30 and guide 120 from the crank's axis, 6 stretched when nearest, 18 deg; here 1 N/mm, pins of 5.

    By hand: nearest 90, so 84 without load and 6 N there; farthest |30 exp(i 18 deg) + 120| = 148.82, so 64.8 N; the eyes are
    5 more apart inside. EN 13906-2: 81500 d^4 / (8 D^3 n) with d 1.25, D 9.375 - 1.25, n 46.4 is 1 N/mm.
    """
    farthest = math.sqrt(30**2 + 120**2 + 2 * 30 * 120 * math.cos(math.radians(18)))
    bought = next(
        each for each in starter.assembly.bought if each.name == "extension spring, unloader_spring"
    )
    assert (
        "wire 1.25, outside diameter 9.38, 46.4 coils, free length 89 inside the eyes: closed coils"
        in bought.size
    )
    closed = 47.37 * 1.25  # a coil more than turns lies side by side
    assert (
        f"closed coils of {closed:.4g}" in bought.size
        and f"a leg of {(89 - closed) / 2:.4g}" in bought.size
    )
    assert "at each end, 1 N/mm" in bought.size
    assert f"6 N at 95 and {farthest - 84:.4g} N at {farthest + 5:.4g}" in bought.size
    assert 81500 * 1.25**4 / (8 * 8.125**3 * 46.37) == pytest.approx(1.0, rel=1e-3)
    rows = order_of_assembly(starter.assembly).rows
    (step,) = (row for row in rows if row[1] == "extension spring")
    assert step[2].startswith(
        "Extension spring unloader_spring, eyes on the pins at points hook and anchor, before their caps"
    )
    assert {"unloader", "gear-unloader_gears-unloader"} <= {row[1] for row in rows}


@pytest.mark.long
@pytest.mark.parametrize("motor", [{}, {"motor": {"speed_rpm": -30.0}}])
def test_a_straight_spring_pulls_as_one_on_a_cord(motor: dict[str, Any]) -> None:
    """Torque at the follower: the machine of bodies with its spring between two pins, against the closed form of the torques."""
    made = machine(**motor)
    chain, borne = made.linkage.chain, made.linkage.additions.loads
    pulls = [each.pull for each in made.linkage.construction.springs]
    effort = solve(replace(chain, loads=(*borne, *pulls)), THETA).forces().contacts["contact"]
    wanted = made.indexing.at(THETA).follower
    assert effort == pytest.approx(wanted, abs=1e-6 * np.abs(wanted).max())
    without = solve(replace(chain, loads=borne), THETA).forces().contacts["contact"]
    turning = (
        THETA < math.radians(120) if made.assembly.cycle.sense > 0 else THETA > math.radians(240)
    )
    assert np.abs(without[turning]).max() > 5 * np.abs(effort[turning]).max()


def test_the_crank_turns_with_the_link_less_twice_the_lead(starter: IndexingCam) -> None:
    """2 (180 - 18) = 324 deg while the table turns by 180; at mid stroke pin and post are nearest, 90 mm."""
    run = starter.solve(np.radians([0.0, 60.0, 120.0]), 0)
    assert np.abs(np.degrees(np.diff(run.pose("unloader").angle))) == pytest.approx([162.0, 162.0])
    far = np.abs(run.point("unloader", "hook")[0] - run.point("ground", "anchor")[0])
    assert far == pytest.approx([148.82, 90.0, 148.82], abs=0.01)


def test_lead_whose_ratio_no_teeth_have_is_told_with_one_that_works() -> None:
    with pytest.raises(DesignError, match=r"unloader.lead_deg = (\S+) gives") as caught:
        _ = machine(unloader={"lead_deg": 17.3}).assembly
    lead = float(caught.value.remedy.partition("lead_deg = ")[2].split()[0])
    assert abs(lead - 17.3) < 2
    assert machine(unloader={"lead_deg": lead}).unloader_crank is not None
    assert abs(machine(unloader={"lead_deg": lead}).unloader_crank.ratio) == pytest.approx(
        2 * (180 - lead) / 180
    )  # type: ignore[union-attr]


@pytest.mark.parametrize(
    ("unloader", "said"),
    [
        ({"stiffness_n_mm": 100.0}, "springs of round wire for the unloader.*stiffness_n_mm"),
        ({"crank": 400.0, "guide": 401.0}, "crank"),
    ],
)
def test_a_spring_that_cannot_be_wound_is_told(unloader: dict[str, Any], said: str) -> None:
    with pytest.raises(DesignError, match=said):
        _ = machine(unloader=unloader).assembly


WHEEL = "gear-unloader_gears-unloader"
MATE = "gear-unloader_gears-driven_link-1"


@pytest.mark.long
@pytest.mark.parametrize(
    ("moved", "pairs"),
    [
        ({}, []),
        # half a tooth; and the crank one level up, where its spring is
        (
            {WHEEL: (math.pi / 35, 0.0), "unloader": (0.0, 4.2)},
            [{MATE, f"{WHEEL}-1"}, {"unloader-1", "unloader_spring 1"}],
        ),
    ],
)
def test_parts_out_of_place_are_found_out(
    tmp_path: Path,
    starter: IndexingCam,
    meshes: dict[str, Mesh],
    moved: dict[str, tuple[float, float]],
    pairs: list[set[str]],
) -> None:
    items, poses = [], starter.assembly.poses(np.zeros(1))
    for each in starter.assembly.parts:
        for k, pose in enumerate(poses[each.name]):
            turned, raised = moved.get(each.name, (0.0, 0.0))
            where = placing(
                float(pose.angle[0]) + turned,
                complex(pose.place[0]),
                pose.z + raised,
                each.thickness,
                pose.flipped,
            )
            items.append(PartCopy(each.name, f"{each.name}-{k + 1}", where))
    write_3mf(tmp_path / "x.3mf", meshes, items, "key")
    failed = [
        set(str(f.where).partition(":")[0].split(" and "))
        for f in sweep(tmp_path / "x.3mf", bodies_in_motion(starter.assembly))[0]
        if not f.ok
    ]
    assert all(pair in failed for pair in pairs) and bool(failed) == bool(pairs)


def test_both_ends_of_a_spring_lie_along_it_and_cover_it(starter: IndexingCam) -> None:
    """At each angle: from pin to post and back; the bars, from beside each pin's head, meet in the middle where it is longest."""
    theta = np.radians([0.0, 60.0, 120.0, 240.0])
    courses, bars = (
        bodies_in_motion(starter.assembly).courses(theta),
        {thing.name: thing.bars[0] for thing in bodies_in_motion(starter.assembly).stand_ins},
    )
    one, two = (courses[f"unloader_spring {k}"] for k in (1, 2))
    assert np.abs(two.place - one.place) == pytest.approx([148.82, 90.0, 148.82, 90.0], abs=0.01)
    assert np.exp(1j * one.angle) == pytest.approx(
        (two.place - one.place) / np.abs(two.place - one.place)
    )
    assert np.exp(1j * two.angle) == pytest.approx(-np.exp(1j * one.angle))
    for begin, end, radius, *_ in bars.values():
        assert (begin.real, end.real, radius) == pytest.approx(
            (2.5 + 1.5 + 0.5 + 9.375 / 2, 148.82 / 2, 9.375 / 2), abs=0.01
        )
    levels = starter.linkage.bodies.layout.given
    assert len(levels) == len({*levels}) and set(starter.linkage.bodies.layout.springs).isdisjoint(
        body.name for body in starter.model.bodies
    )


@pytest.mark.long
def test_an_ideal_spring_is_not_made_and_that_is_told(starter: IndexingCam) -> None:
    data = read(SPECS / "indexing-cam.toml")
    data["parts"]["make"], data["unloader"] = "printed", {"torque": "law"}
    ideal = validate(IndexingCam, data)
    assert ideal.unloader_crank is None and not any(
        "spring" in each.name for each in ideal.assembly.bought
    )
    assert any("not made" in note for note in ideal.study().notes)
    assert not any("not made" in note for note in starter.study().notes if "unloader is" in note)


def test_a_stiffness_that_is_found_leaves_least() -> None:
    """Two worst places, one of too much pull and one of too little; near that by energy, which at mid stroke is all in motion."""
    data = read(SPECS / "indexing-cam.toml")
    del data["unloader"]["stiffness_n_mm"]
    data["load"]["friction_n_m"] = 0
    found = validate(IndexingCam, data)
    stiffness = found._found()["unloader.stiffness_n_mm"]
    assert isinstance(stiffness, float)
    for share in (0.99, 1.01):
        data["unloader"]["stiffness_n_mm"] = share * stiffness
        assert validate(IndexingCam, data).indexing.residual > found.indexing.residual + 1e-3
    # 120 deg at 30 rpm are 2/3 s, at mid stroke 1.8917 times the mean speed; the spring goes from 64.8 / k long to 6
    speed, farthest = (
        1.8917 * math.pi / (2 / 3),
        math.sqrt(30**2 + 120**2 + 2 * 30 * 120 * math.cos(math.radians(18))) - 84,
    )
    energy = 2 * 0.05 * speed**2 / 2 / (farthest**2 - 6**2) * 1e3
    assert stiffness == pytest.approx(energy, rel=0.03)
    assert found.resolved().indexing.residual == pytest.approx(found.indexing.residual)
