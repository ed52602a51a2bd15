"""A balanced crank and a thread on its posts, judged on the written assembly: they hold as made and fail where it is damaged."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from camgen.files.threemf import PartCopy, write_3mf
from camgen.findings import Finding
from camgen.geometry.mesh import Mesh, placing
from camgen.judge.balance import first_moment, judge_balance
from camgen.judge.strands import judge_strands
from camgen.machines.mechanism import Mechanism
from camgen.parts.assembly import bodies_in_motion
from camgen.parts.solids import solid
from camgen.pipeline import build as pipeline

SPECS = Path(__file__).resolve().parents[2] / "specs"


@cache
def machine(name: str, *settings: str) -> Mechanism:
    return pipeline.read_mechanism(
        SPECS / f"{name}.toml", ["accuracy.chord_tolerance=0.01", *settings]
    )


@cache
def solids(name: str, *settings: str) -> Mapping[str, Mesh]:
    found = machine(name, *settings)
    return {part.name: solid(part, found.accuracy.chord_tolerance) for part in found.assembly.parts}


def written(
    path: Path,
    name: str,
    *settings: str,
    changed: Mapping[str, Mesh] | None = None,
    turned: float = 0.0,
) -> Mechanism:
    """Write an assembly in which some solids are others, or the counterweight is turned on its shaft, rad."""
    found, items = machine(name, *settings), []
    start = found.assembly.poses(np.zeros(1))
    for part in found.assembly.parts:
        for k, pose in enumerate(start[part.name]):
            angle = float(pose.angle[0]) + turned * part.name.startswith("counterweight")
            at = placing(angle, complex(pose.place[0]), pose.z, part.thickness, pose.flipped)
            items.append(PartCopy(part.name, f"{part.name}-{k + 1}", at))
    write_3mf(path, {**solids(name, *settings), **(changed or {})}, items, "key")
    return found


def weighed(path: Path, found: Mechanism) -> Finding:
    assert found.assembly.balances[0] is not None
    return judge_balance(path, bodies_in_motion(found.assembly), found.assembly.balances[0])


def test_a_tetrahedron_is_weighed_as_by_hand() -> None:
    """Volume a b c / 6, its centroid the mean of its corners."""
    corners = np.array([[1.0, 2, 0], [4, 2, 0], [1, 4, 0], [1, 2, 5]])
    volume, moment = first_moment(
        Mesh(corners, np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]]))
    )
    assert volume == pytest.approx(5.0)
    assert moment == pytest.approx(5.0 * np.array([7, 10, 5]) / 4)


MACHINES = [
    ("thread-take-up", "counterweight.made='steel'"),
    ("linkage", "counterweight.pins=3"),
    ("linkage", "counterweight.pins=0"),
    ("eccentric-drive", "counterweight.against='frame'"),
]


@pytest.mark.long
@pytest.mark.parametrize("which", MACHINES)
def test_a_balanced_crank_weighs_what_is_asked_and_a_damaged_one_does_not(
    tmp_path: Path, which: tuple[str, str]
) -> None:
    path = tmp_path / "x.3mf"
    found = weighed(path, written(path, *which))
    assert found.ok and found.measured < 0.3 * found.limit, found  # chords of 0.01 mm
    body = solids(*which)["counterweight"]
    thinner = Mesh(body.vertices * [1, 1, 0.97], body.faces)
    assert not weighed(path, written(path, *which, changed={"counterweight": thinner})).ok
    assert not weighed(path, written(path, *which, turned=0.03)).ok
    if which[1].endswith("3"):
        pin = solids(*which)["counterweight-pin"]
        assert not weighed(
            path,
            written(
                path, *which, changed={"counterweight-pin": Mesh(pin.vertices * 0.9, pin.faces)}
            ),
        ).ok
    machine_ = written(path, *which)
    assert machine_.assembly.balances[0] is not None
    light = {
        **machine_.assembly.balances[0].density,
        "counterweight": 0.9 * machine_.assembly.balances[0].density["counterweight"],
    }
    assert not judge_balance(
        path,
        bodies_in_motion(machine_.assembly),
        replace(machine_.assembly.balances[0], density=light),
    ).ok


def test_what_the_crank_bears_is_the_smallest_circle(tmp_path: Path) -> None:
    """With the whole crank's moment as asked, the reaction is no more than what no weight can take off."""
    from camgen.machines.loads.assess import assess

    found = machine("thread-take-up", "counterweight.made='steel'")
    numbers, own = assess(found).study.numbers, machine("thread-take-up").study().numbers
    assert own["crank_counterweight_g_mm"] == pytest.approx(
        abs(found.assembly.balances[0].moment), rel=1e-4
    )  # type: ignore[union-attr]
    assert numbers["counterweight_bearing_after_n"] == pytest.approx(
        own["reaction_o_with_crank_weight_n"], rel=2e-3
    )
    assert (
        numbers["counterweight_bearing_before_n"] > 1.2 * numbers["counterweight_bearing_after_n"]
    )
    assert (
        numbers["counterweight_shaking_after_n"] > numbers["counterweight_shaking_before_n"]
    )  # spares the bearing alone


# ---- threads ---------------------------------------------------------------------------------------------------------


def threads(path: Path, found: Mechanism) -> dict[str, Finding]:
    """By code the worst."""
    findings = sorted(
        judge_strands(path, bodies_in_motion(found.assembly), found.assembly.strands),
        key=lambda finding: -finding.measured,
    )
    return {finding.code: finding for finding in findings}


@pytest.mark.long
def test_a_thread_lies_in_its_grooves_and_slips_along_plain_posts(tmp_path: Path) -> None:
    path = tmp_path / "x.3mf"
    found = threads(path, written(path, "thread-take-up"))
    assert (
        found["THREAD_HELD"].measured == pytest.approx(1.0, abs=1e-3) and found["THREAD_CLEAR"].ok
    )
    plain = threads(path, written(path, "thread-take-up", "parts.groove=0"))
    assert not plain["THREAD_HELD"].ok and not plain["THREAD_CLEAR"].ok
    worn = solids("thread-take-up")["thread-post-1"]
    thin = Mesh(worn.vertices * [0.6, 0.6, 1], worn.faces)
    worn_out = threads(path, written(path, "thread-take-up", changed={"thread-post-1": thin}))
    assert worn_out["THREAD_HELD"].measured == pytest.approx(0.6, abs=1e-3)


@pytest.mark.long
def test_a_thread_that_meets_a_head_or_a_guide_is_told(tmp_path: Path) -> None:
    path = tmp_path / "x.3mf"
    high = solids("thread-take-up")["pin-1"]
    top = high.vertices.copy()
    top[top[:, 2] < 0.5, 2] -= (
        5.0  # the head, which lies on top in the machine, 5 mm higher: into the thread's heights
    )
    found = threads(
        path, written(path, "thread-take-up", changed={"pin-1": Mesh(top, high.faces)})
    )["THREAD_CLEAR"]
    assert not found.ok and "pin-1-1" in str(found.where) and "deg" in str(found.where)
    between = machine("thread-take-up", "geometry.guides=[[-80,160],[-35,55]]")
    crossed = threads(
        path, written(path, "thread-take-up", "geometry.guides=[[-80,160],[-35,55]]")
    )["THREAD_CLEAR"]
    theta = np.linspace(0, 2 * np.pi, 20_000)
    eye, (m, n) = between.take_up.path(theta), between.take_up.guides  # type: ignore[attr-defined]
    way = m - eye
    share = np.clip(((n - eye) * way.conj()).real / np.abs(way) ** 2, 0, 1)
    apart = (
        float(np.abs(n - eye - share * way).min()) - 1.0 - 2.0
    )  # less the groove's radius and that of the other's head
    assert crossed.measured == pytest.approx(max(apart, -1.0), abs=5e-3)


def test_the_crank_of_an_included_machine_is_weighed(tmp_path: Path) -> None:
    """By the names, the phase and the place that it has in the whole; without its counterweight it fails."""
    for name, more in (
        ("thread-take-up", "[counterweight]\n"),
        ("linkage", '[[include]]\nspec = "thread-take-up.toml"\nat = [0, 300]\nphase_deg = 30\n'),
    ):
        text = (SPECS / f"{name}.toml").read_text("utf-8")
        (tmp_path / f"{name}.toml").write_text(f"{text}\n{more}", encoding="utf-8")
    whole = pipeline.read_mechanism(tmp_path / "linkage.toml", ["accuracy.chord_tolerance=0.02"])
    (balance,) = whole.assembly.balances
    assert (balance.body, balance.joint) == ("thread_take_up_crank", "thread_take_up_O")
    on, parts = (
        [mount for mount in whole.assembly.mounts if mount.body == balance.body],
        {part.name: part for part in whole.assembly.parts},
    )
    pose = whole.assembly.poses(np.zeros(1))
    items = []
    for name in (mount.part for mount in on):
        (place,) = pose[name]
        at = placing(
            float(place.angle[0]),
            complex(place.place[0]),
            place.z,
            parts[name].thickness,
            place.flipped,
        )
        items.append(PartCopy(name, name, at))
    meshes = {mount.part: solid(parts[mount.part], 0.02) for mount in on}
    for left, holds in (
        (items, True),
        ([item for item in items if "counterweight" not in item.name], False),
    ):
        write_3mf(tmp_path / "a.3mf", {item.name: meshes[item.name] for item in left}, left, "a")
        assert (
            judge_balance(tmp_path / "a.3mf", bodies_in_motion(whole.assembly), balance).ok is holds
        )
