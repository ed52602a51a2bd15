"""The machine round the drum of a cylinder cam: bodies in space against distances of their own, files against damages."""

from __future__ import annotations

import json
import math
import re
import tomllib
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import manifold3d
import numpy as np
import pytest

from camgen.errors import DesignError, SpecError
from camgen.files.threemf import PartCopy, read_3mf, write_3mf
from camgen.findings import Finding
from camgen.geometry.mesh import Mesh
from camgen.geometry.outlines import Arc
from camgen.judge import sweep_in_space as sweep_in_space_module
from camgen.judge.sweep_in_space import sweep_in_space
from camgen.machines.cylinder_cam.mechanism import CylinderCam
from camgen.machines.loads.assess import assess
from camgen.parts.assembly import bodies_in_motion, order_of_assembly
from camgen.parts.part import Part
from camgen.pipeline import build as pipeline
from camgen.pipeline.making import assembly_copies
from camgen.pipeline.shopping import steps_of_assembly
from camgen.pipeline.shown import animation
from camgen.spec import validate

SPEC = Path(__file__).parents[2] / "specs" / "cylinder-cam.toml"
ARM = {"motion": "oscillating", "arm": 40.0}
SMALL = {"radius": 5.0, "length": 4.0}
FOLLOWERS: dict[str, dict[str, Any]] = {
    "slide": {"geometry": {"roller": SMALL}},
    "offset": {"geometry": {"follower": {"offset": 4.0}}},
    "arm": {"geometry": {"follower": ARM}, "limits": {"lash": 0.5, "least_radius": 1.0}},
    "rib": {"geometry": {"track": "rib", "distance": 16.0}},
    "end": {"geometry": {"track": "end"}},
    "end arm": {
        "geometry": {"track": "end", "follower": ARM},
        "limits": {"lash": 0.5, "least_radius": 1.0},
    },
}


def machine(rows: list[dict[str, Any]] | None = None, **tables: dict[str, Any]) -> CylinderCam:
    """The starter's motion, or other segments; tables: keys in place of the starter's."""
    data = tomllib.loads(SPEC.read_text(encoding="utf-8"))
    data["geometry"]["roller"]["length"] = 6.0
    data["accuracy"] = {"chord_tolerance": 0.02}
    tables["parts"] = {"make": "printed", "pieces": 1, **tables.get("parts", {})}
    for name, keys in tables.items():
        data[name] = {**data.get(name, {}), **keys}
    if rows is not None:
        data["segment"] = rows
    return validate(CylinderCam, data)


def swept(made: CylinderCam, path: Path, change: Callable[[str, Mesh], Mesh]) -> list[Finding]:
    """What the sweep says of the machine's solids, each changed by the name of its part."""
    meshes = {name: change(name, mesh) for name, mesh in made._solids.items()}
    write_3mf(path, meshes, assembly_copies(made), "0" * 32)
    return sweep_in_space(path, bodies_in_motion(made.assembly))[0]


def grown(mesh: Mesh, share: float) -> Mesh:
    """A solid about its own z, wider."""
    return Mesh(mesh.vertices * [share, share, 1], mesh.faces)


@pytest.mark.long
@pytest.mark.parametrize("kind", FOLLOWERS)
def test_no_two_bodies_meet_and_a_thicker_one_is_seen(kind: str, tmp_path: Path) -> None:
    made = machine(**FOLLOWERS[kind])
    path = tmp_path / "a.3mf"
    assert [each for each in swept(made, path, lambda _, mesh: mesh) if not each.ok] == []

    def failing(part: str, change: Callable[[Mesh], Mesh]) -> str:
        found = swept(made, path, lambda name, mesh: change(mesh) if name == part else mesh)
        return " ".join(str(each.where) for each in found if not each.ok)

    arm = kind.endswith("arm")
    assert ("arm" if arm else "carriage") in failing("drum", lambda mesh: grown(mesh, 1.2))
    assert "drum-1" in failing("roller-pin", lambda mesh: grown(mesh, 3.0))
    assert "rod" in failing("rod", lambda mesh: grown(mesh, 1.05))
    lower = failing(
        "arm" if arm else "carriage", lambda mesh: Mesh(mesh.vertices * [1, 4, 1], mesh.faces)
    )
    assert "plate" in lower


@pytest.mark.long
def test_a_pair_of_which_too_little_is_seen_is_not_proven(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(sweep_in_space_module, "_MOST", 1)
    failing = [
        each
        for each in swept(machine(**FOLLOWERS["arm"]), tmp_path / "a.3mf", lambda _, mesh: mesh)
        if not each.ok
    ]
    assert failing and all(each.code == "INTERFERENCE" for each in failing)
    assert all(math.isnan(each.measured) for each in failing)


@pytest.mark.long
@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("kind", ["slide", "arm"])
def test_random_machines_keep_apart_what_the_sweep_proves(
    kind: str, seed: int, tmp_path: Path
) -> None:
    """Distances of the solids themselves where the scene has them, at random angles, against the proof."""
    chance = np.random.default_rng(seed)
    spans = chance.dirichlet([4, 1, 4, 1]) * 280 + 20
    lift = float(chance.uniform(6, 14))
    laws = chance.choice(["cycloidal", "modified-sine", "3-4-5"], 2)
    rows = [
        {"kind": "rise", "span_deg": float(spans[0]), "lift": lift, "law": str(laws[0])},
        {"kind": "dwell", "span_deg": float(spans[1])},
        {"kind": "return", "span_deg": float(spans[2]), "to": 0.0, "law": str(laws[1])},
        {"kind": "dwell"},
    ]
    limits = {"pressure_angle_deg": 35.0, "lash": 2.0}
    made = machine(rows, geometry=FOLLOWERS[kind]["geometry"], limits=limits)
    path = tmp_path / "a.3mf"
    found = swept(made, path, lambda _, mesh: mesh)
    assert [each for each in found if not each.ok] == []
    gap = made.assembly.process.gap
    fixed = {"end": 0, "rod": 0, "bearing": 0, "bracket": 0, "pivot": 0, "cap": 0}
    fixed |= {"drum": 1, "shaft": 1, "spacer": 1, "crank": 1, "knob": 1}
    meant = [{"shaft", "bearing"}, {"roller", "drum"}, {"arm", "pivot"}]
    for theta in chance.uniform(0, math.tau, 4):
        scene = made.scene(float(theta))
        bodies = []
        for node in scene.graph.nodes_geometry:
            matrix, name = scene.graph[node]
            solid = scene.geometry[name]
            mesh = manifold3d.Mesh64(np.array(solid.vertices), np.array(solid.faces, np.uint64))
            bodies.append((name, manifold3d.Manifold(mesh).transform(matrix[:3])))
        for k, (a, one) in enumerate(bodies):
            for b, other in bodies[:k]:
                apart = fixed.get(a.split("-")[0], 2) != fixed.get(b.split("-")[0], 2)
                if apart and {a, b} not in meant:
                    assert one.min_gap(other, 1.0) > gap - 1e-3, (a, b, theta)
        # the roller in its track: none of it is in the drum but for facets
        drum = next(solid for name, solid in bodies if name == "drum")
        roller = next(solid for name, solid in bodies if name == "roller")
        common = drum ^ roller
        assert common.volume() < 0.02 * max(common.surface_area(), 1e-9)


@pytest.mark.parametrize("kind", ["offset", "arm"])
def test_the_roller_stands_where_the_motion_has_it(kind: str) -> None:
    """On a slide at s over its place; on an arm at a sin(g) over the axle and a cos(g) beside it."""
    made = machine(**FOLLOWERS[kind])
    track = made.track
    for theta in (0.0, 0.7, 2.5, 4.0):
        scene = made.scene(theta)
        matrix, _ = scene.graph["roller-1"]
        drum, _ = scene.graph["drum-1"]
        s = float(made.motion(np.array([theta]))[0])
        high = drum[2, 3] + track.height
        place = (track.geometry.follower.offset, high + s)
        if kind == "arm":
            angle = track.start + s
            place = (track.pivot - 40 * math.cos(angle), high + 40 * math.sin(angle))
        assert matrix[1:3, 3] == pytest.approx(place, abs=1e-9)
        # its axis is radial: both ends of the solid are on +x
        ends = scene.geometry["roller"].vertices @ matrix[:3, :3].T + matrix[:3, 3]
        assert ends[:, 0].min() == pytest.approx(track.inner, abs=1e-4)
        assert math.atan2(drum[1, 0], drum[0, 0]) % math.tau == pytest.approx(theta)


@pytest.mark.long
@pytest.mark.parametrize("kind", ["slide", "arm"])
def test_the_machine_is_built_listed_and_judged(kind: str, tmp_path: Path) -> None:
    made = machine(**FOLLOWERS[kind])
    spec = tmp_path / "spec.toml"
    spec.write_text(made.toml(), encoding="utf-8")
    out = tmp_path / "out"
    report = pipeline.build(spec, out, frozenset({"stl", "3mf", "report"}))
    assert [each for each in report.findings if not each.ok] == []
    folder = out / made.name
    told = json.loads((folder / "report.json").read_text())
    count = {part["name"]: part["count"] for part in told["parts"]}
    assert (count["end-plate"], count["rod"], count["bearing"], count["drum"]) == (2, 4, 2, 1)
    assert ("carriage" in count, "arm" in count) == (kind == "slide", kind == "arm")
    glb = [
        each for each in report.findings if str(each.where).startswith(f"{made.name}-assembly.glb")
    ]
    assert [each.code for each in glb] == ["ROUND_TRIP"]
    steps = order_of_assembly(made.assembly).steps
    named = [copy for step in steps for copy in step.copies]
    assert {*named} == {
        f"{part.name}-{k + 1}" for part in made.assembly.parts for k in range(part.count)
    }
    # what is built beside the machine comes once, and is taken along by name
    assert len(named) == len({*named})
    beside = ["arm", "bracket", "drum"] if kind.endswith("arm") else ["carriage", "drum"]
    assert [step.joins for step in steps if step.joins] == [
        f"{name} beside the machine" for name in beside
    ]
    assert pipeline.check(folder).ok


@pytest.mark.parametrize("kind", ["slide", "arm"])
def test_what_is_built_beside_the_machine_is_shown_as_it_lies_there(kind: str) -> None:
    """A pin is glued where its bore is, on the axis that is up as its holder lies: places from the solids themselves."""
    made = machine(**FOLLOWERS[kind])
    steps = steps_of_assembly(made).steps
    scene = made.scene(0.0)
    for pin, holder in (
        ("roller-pin", "arm" if kind == "arm" else "carriage"),
        ("pivot", "bracket"),
    ):
        if f"{pin}-1" not in scene.graph.nodes:
            continue
        step = next(each for each in steps if f"{pin}-1" in each.copies)
        laid = next(each for each in steps if f"{holder}-1" in each.copies)
        assert step.apart == laid.apart and step.up == laid.up and step.way == -1
        (mate,) = step.mates
        assert mate.how == "glue"
        matrix, _ = scene.graph[f"{pin}-1"]
        axis = matrix[:3, 2]
        assert abs(abs(axis @ step.up) - 1) < 1e-9
        off = np.array(mate.place) - matrix[:3, 3]
        assert np.linalg.norm(off - (off @ axis) * axis) < 1e-3  # on the pin's axis
        solids = scene.geometry[holder].copy().apply_transform(scene.graph[f"{holder}-1"][0])
        low, high = solids.bounds[:, 0]
        assert (
            low - 1e-6
            <= mate.place[0] - mate.height / 2
            < mate.place[0] + mate.height / 2
            <= high + 1e-6
        )


def test_words_of_a_drum_s_machine_say_which_end_is_up_and_how_high_all_is() -> None:
    """Heights from the solids: of the groove at the bore's flat, of the bracket over its plate, of the crank on its shaft."""
    made = machine(**FOLLOWERS["slide"])
    titles = [step.title for step in steps_of_assembly(made).steps]
    corners = made._solids["drum"].vertices
    radius, angle = np.hypot(*corners[:, :2].T), np.arctan2(corners[:, 1], corners[:, 0])
    floor = (np.abs(radius - made.track.floor) < 0.5) & (np.abs(angle - math.pi / 2) < 0.03)
    low, high = np.min(corners[floor, 2]), np.max(corners[floor, 2])
    (told,) = re.findall(
        r"bore's flat the middle of its groove is ([\d.]+) mm from the lower", " ".join(titles)
    )
    assert float(told) == pytest.approx((low + high) / 2, abs=0.2)
    scene = made.scene(0.0)
    top = {
        name: scene.geometry[name].copy().apply_transform(scene.graph[f"{name}-1"][0]).bounds[1, 2]
        for name in ("crank", "shaft")
    }
    assert top["crank"] == pytest.approx(top["shaft"])
    assert any("crank on the shaft, flush with its upper end" in title for title in titles)
    arm = machine(**FOLLOWERS["arm"])
    scene = arm.scene(0.0)
    under = (
        scene.geometry["bracket"].copy().apply_transform(scene.graph["bracket-1"][0]).bounds[0, 2]
    )
    plate = scene.geometry["end-plate"].bounds[1, 2]
    said = " ".join(step.title for step in steps_of_assembly(arm).steps)
    assert f"its underside {under - plate:.4g} mm over the lower end plate" in said
    end = " ".join(step.title for step in steps_of_assembly(machine(**FOLLOWERS["end"])).steps)
    assert "its wavy end up" in end
    first = steps_of_assembly(made).steps[3].title
    assert first.startswith("Break the supports off the drum, and scrape the track"), first
    most = max(len(sentence.split()) for title in titles for sentence in re.split(r"\. |\n", title))
    assert most <= 45, "no step is one long sentence"


LOADED = {"mass_kg": 0.2, "gravity_deg": -90.0}
END = {"geometry": {"track": "end", "roller": SMALL}}


def test_two_springs_press_as_the_forces_assume() -> None:
    """Lengths from the solids of the scene: from the carriage's upper side to the upper plate's underside."""
    made = machine(**END, load=LOADED, spring={"rate": 0.5, "preload": 4.0})
    (spring,) = made.assembly.springs.values()
    lift = max(made.motion(np.linspace(0, math.tau, 721)))
    line = next(each for each in made.assembly.bought if each.name == "compression spring")
    assert line.count == spring.count == 2 and line.standard == "EN 13906-1"
    for theta in (0.0, 1.0, 2.5):
        scene = made.scene(theta)
        ends = {}
        for name, highest in (("carriage-1", True), ("end-plate-2", False)):
            matrix, key = scene.graph[name]
            z = scene.geometry[key].vertices @ matrix[2, :3] + matrix[2, 3]
            ends[name] = float(z.max() if highest else z.min())
        length = ends["end-plate-2"] - ends["carriage-1"]
        s = float(made.motion(np.array([theta]))[0])
        assert 2 * spring.spring.force(length) == pytest.approx(4.0 + 0.5 * s, abs=1e-3)
    assert spring.shortest > spring.spring.solid  # type: ignore[union-attr]
    assert spring.longest - spring.shortest == pytest.approx(lift)
    codes = {each.code: each for each in pipeline_findings(made)}
    assert codes["SPRING_STRESS"].ok and codes["SURGE"].ok and codes["LIFT_OFF"].ok


def pipeline_findings(made: CylinderCam) -> list[Finding]:
    """Its limits and those of its loads."""
    return [*made.limits(), *assess(made).findings]


def test_springs_pass_by_all_that_moves() -> None:
    """The whole room of each spring, a cylinder of its outside from carriage to plate, in a scene of its own solids."""
    made = machine(**END, load=LOADED, spring={"rate": 3.0, "preload": 10.0})
    (spring,) = made.assembly.springs.values()
    for theta in np.linspace(0, math.tau, 9):
        scene = made.scene(float(theta))
        solids = {}
        for node in scene.graph.nodes_geometry:
            matrix, name = scene.graph[node]
            solid = scene.geometry[name]
            mesh = manifold3d.Mesh64(np.array(solid.vertices), np.array(solid.faces, np.uint64))
            solids[node] = manifold3d.Manifold(mesh).transform(matrix[:3])
        rods = [scene.graph[f"rod-{k}"][0][:2, 3] for k in (1, 2)]
        low = solids["carriage-1"].bounding_box()[5]
        high = solids["end-plate-2"].bounding_box()[2]
        # inside its coils there is the rod, with a tenth of its width over
        assert spring.spring.outside - 2 * spring.spring.wire >= 1.1 * 6.0 - 1e-9
        for x, y in rods:
            room = manifold3d.Manifold.cylinder(high - low, spring.spring.outside / 2, -1, 96)
            room = room.translate((float(x), float(y), float(low)))
            for name in ("drum-1", "shaft-1", "spacer-above-1", "roller-1", "roller-pin-1"):
                assert room.min_gap(solids[name], 2.0) > 0.5, (name, theta)
            assert (room ^ solids["carriage-1"]).volume() == pytest.approx(0, abs=1e-6)
    assert (room ^ solids["rod-2"]).volume() > 1  # the room is where the rod is


def test_a_spring_that_is_left_open_holds_the_roller_and_is_filled_in() -> None:
    fast = {"motor": {"speed_rpm": 300.0, "torque_n_m": 5.0, "model": None}}
    made = machine(**END, load={"mass_kg": 0.5}, **fast)
    filled = made.resolved()
    assert filled.spring is not None and filled.spring.preload > 2.0
    assert next(each for each in made.limits() if each.code == "LIFT_OFF").ok
    half = made.replace({"spring.preload": filled.spring.preload / 2, "spring.rate": 1e-3})
    assert not next(each for each in half.limits() if each.code == "LIFT_OFF").ok
    again = filled.assembly.springs
    assert again == made.assembly.springs and len(again) == 1
    # without a mass nothing is known of forces: the carriage is pressed so that it does not rub
    (plain,) = machine(**END).assembly.springs.values()
    assert 2 * plain.spring.force(plain.longest) == pytest.approx(2.0)
    assert machine(**END).resolved().spring is None
    assert not machine(geometry={"roller": SMALL}).assembly.springs


def test_springs_come_round_the_front_rods_before_the_plate() -> None:
    made = machine(**END)
    steps = order_of_assembly(made.assembly).steps
    coming = [k for k, step in enumerate(steps) if step.wire is not None]
    plate = next(k for k, step in enumerate(steps) if "end-plate-2" in step.copies)
    drum = max(k for k, step in enumerate(steps) if "drum-1" in step.copies)
    assert len(coming) == 2 and drum < coming[0] and coming[1] < plate
    assert "presses both springs" in steps[plate].title
    scene = made.scene(0.0)
    rods = [scene.graph[f"rod-{k}"][0][:2, 3] for k in (1, 2)]
    (spring,) = made.assembly.springs.values()
    for k, rod in zip(coming, rods, strict=True):
        wire = steps[k].wire
        assert wire is not None
        away = np.hypot(*(wire[:, :2] - rod).T)
        assert away == pytest.approx(
            np.full(len(wire), (spring.spring.outside - spring.spring.wire) / 2)
        )
    # the moving picture has them too, as long as the room is at each frame
    film = animation(made)
    (first, _) = (body for body in film.bodies if body.name.startswith("spring"))
    assert first.course is not None and first.swell is not None and first.upright
    heights = np.ptp(first.course.imag, axis=1) + spring.spring.wire
    s = made.motion(film.theta)
    free = spring.spring.free - heights
    assert np.max(np.abs(2 * spring.spring.rate * free - 2.0 - (2.0 / np.ptp(s)) * s)) < 0.05


def test_a_spring_that_no_wire_is_is_refused() -> None:
    with pytest.raises(DesignError, match="compression springs of round wire"):
        _ = machine(**END, load=LOADED, spring={"rate": 500.0, "preload": 9000.0}).assembly
    with pytest.raises(DesignError, match="return springs of round wire") as refused:
        _ = machine(**FOLLOWERS["end arm"], load=INERTIA, spring={"preload": 900.0}).assembly
    assert "spring.preload" in str(refused.value)


INERTIA = {"inertia_kg_m2": 2e-4}


def test_the_spring_of_an_arm_pulls_as_its_forces_assume() -> None:
    """Its length from the axes of both pins in a scene of solids, its lever about the pivot's axis from the same."""
    made = machine(**FOLLOWERS["end arm"], load=INERTIA)
    (spring,) = made.assembly.springs.values()
    (line,) = (each for each in made.assembly.bought if each.role == "spring")
    assert (line.name, line.count) == ("extension spring", 1)
    pressing = made.resolved().spring
    assert pressing is not None and pressing.preload == pytest.approx(2e-3 * 40.0)
    theta = np.linspace(0, math.tau, 13)
    s = made.motion(theta)
    lengths = []
    for angle, swing in zip(theta, s, strict=True):
        scene = made.scene(float(angle))
        pivot, roller, post = (
            complex(*scene.graph[f"{name}-1"][0][1:3, 3])
            for name in ("pivot", "roller-pin", "spring-pin")
        )
        thick = scene.geometry["roller-pin"].extents[0]  # the eyes are outside of both pins
        lengths.append(abs(roller - post) + round(thick, 1))
        pull = (post - roller) / abs(post - roller)
        lever = ((roller - pivot).conjugate() * pull).imag
        assert lever > 0  # about the axis towards the drum: down
        torque = 1e-3 * lever * float(spring.spring.force(lengths[-1]))
        wanted = pressing.preload + pressing.rate * swing
        assert torque == pytest.approx(wanted, rel=0.02)
    assert (min(lengths), max(lengths)) == pytest.approx((spring.shortest, spring.longest))
    assert made.resolved().assembly.springs == made.assembly.springs
    codes = {each.code: each for each in pipeline_findings(made)}
    assert codes["SPRING_STRESS"].ok and codes["SURGE"].ok and codes["LIFT_OFF"].ok
    weak = made.replace({"spring.preload": 1e-6, "spring.rate": 1e-6, "motor.speed_rpm": 600.0})
    assert not next(each for each in weak.limits() if each.code == "LIFT_OFF").ok


def test_the_spring_of_an_arm_has_room_and_comes_before_the_arm() -> None:
    """A bar as thick as its coils between both pins' eyes, in scenes of solids; and the wire in the steps and the film."""
    made = machine(**FOLLOWERS["end arm"])
    (spring,) = made.assembly.springs.values()
    thick = spring.spring.outside
    for theta in np.linspace(0, math.tau, 7):
        scene = made.scene(float(theta))
        solids = {}
        for node in scene.graph.nodes_geometry:
            matrix, name = scene.graph[node]
            solid = scene.geometry[name]
            mesh = manifold3d.Mesh64(np.array(solid.vertices), np.array(solid.faces, np.uint64))
            solids[node] = manifold3d.Manifold(mesh).transform(matrix[:3])
        arm = solids["arm-1"].bounding_box()[3]
        depth = (arm + solids["bracket-1"].bounding_box()[0]) / 2
        ends = [
            np.array([depth, *scene.graph[f"{name}-1"][0][1:3, 3]])
            for name in ("spring-pin", "roller-pin")
        ]
        ball = manifold3d.Manifold.sphere(thick / 2, 48)
        bar = manifold3d.Manifold.batch_hull([ball.translate(tuple(end)) for end in ends])
        for name, solid in solids.items():
            if name in ("spring-pin-1", "roller-pin-1"):
                assert (bar ^ solid).volume() > 50, name  # it is where its pins are
            else:
                assert bar.min_gap(solid, 1.0) > 0.45, (name, theta)
    steps = order_of_assembly(made.assembly).steps
    (coming,) = (k for k, step in enumerate(steps) if step.wire is not None)
    assert "spring-pin-1" in steps[coming - 2].copies and steps[coming + 1].joins.startswith("arm ")
    assert steps[coming + 1].dry and "no glue" in steps[coming + 1].title
    wire = steps[coming].wire
    assert wire is not None
    assert float(np.ptp(wire[:, 0])) == pytest.approx(thick, abs=0.1)
    film = animation(made)
    (body,) = (each for each in film.bodies if each.name == "spring")
    assert body.course is not None and body.upright
    heights = np.ptp(body.course.imag, axis=1)
    swing = made.motion(film.theta)
    tips = 40 * np.sin(made.track.start + swing)
    assert heights - heights[0] == pytest.approx(tips - tips[0], abs=0.1)


def test_a_copy_that_is_missing_is_told(tmp_path: Path) -> None:
    made = machine(**FOLLOWERS["slide"])
    path = tmp_path / "a.3mf"
    copies = assembly_copies(made)
    write_3mf(path, dict(made._solids), copies[:-1], "0" * 32)
    (found,) = sweep_in_space(path, bodies_in_motion(made.assembly))[0]
    assert (found.code, found.ok, found.measured) == ("COPIES", False, 1)
    moved = [replace(copies[0], transform=copies[0].transform + np.eye(3, 4, 3) * 9), *copies[1:]]
    assert isinstance(moved[0], PartCopy)
    write_3mf(path, dict(made._solids), moved, "0" * 32)
    assert len(read_3mf(path).items) == len(copies)
    assert not all(each.ok for each in sweep_in_space(path, bodies_in_motion(made.assembly))[0])


def test_the_knob_of_the_crank_turns_on_its_pin() -> None:
    """It has the play of what moves all round and along; its pin goes through the crank, flush, and its head keeps the knob."""
    made = machine()
    parts = made.assembly.by_name
    stands = {each.part: each for each in made.assembly.mounts}
    knob = parts["knob"]
    pin = parts["knob-pin"]
    crank = parts["crank"]
    play = made.print.slide_clearance
    (hole,) = knob.drawn.region.holes
    assert 2 * abs(hole.pieces[0].at(0.0)) == pytest.approx(5 + play)
    assert stands["knob"].z - (stands["crank"].z + crank.thickness) == pytest.approx(play)
    shank = max(each.z1 - each.z0 for each in pin.layers)
    assert shank == pytest.approx(crank.thickness + knob.thickness + 2 * play)
    assert stands["knob-pin"].z == stands["crank"].z and stands["knob-pin"].flipped


def test_a_motor_has_no_crank() -> None:
    names = [part.name for part in machine(motor={"model": "17HS24"}).assembly.parts]
    assert "crank" not in names and "knob" not in names and "shaft" in names


@pytest.mark.parametrize(
    ("tables", "told"),
    [
        ({"parts": {"bore": 7.0}}, "parts.bore"),
        ({"geometry": {"roller": {**SMALL, "cone_deg": 5.0}}}, "geometry.roller.cone_deg"),
        ({"geometry": {"roller": {"radius": 0.9, "length": 4.0}}}, "geometry.roller.radius"),
        ({"material": {"name": "C45"}}, "parts.make"),
    ],
)
def test_what_no_machine_is_made_of_is_told(tables: dict[str, Any], told: str) -> None:
    with pytest.raises((SpecError, DesignError), match=told.replace(".", r"\.")):
        machine(**tables)


@pytest.mark.parametrize("kind", FOLLOWERS)
def test_loads_and_stands_are_screwed_on_where_there_is_room(kind: str) -> None:
    """By the solids: each hole is open for the core of an M3, and a ring as wide as parts.wall round it is all material."""
    made = machine(**FOLLOWERS[kind])
    wall = made.making.wall
    assert ("carriage" in made._solids) != kind.endswith("arm")
    for name, count in (("end-plate", 2), ("carriage", 4)):
        if name not in made._solids:
            continue
        part = made.assembly.by_name[name]
        cores = [z for z, radius in round_holes(part) if radius == pytest.approx(1.25)]
        assert len(cores) == count
        size = complex(np.ptp(np.real(cores)), np.ptp(np.imag(cores)))
        pitch = f" {size.real:g} x {size.imag:g} apart" if count == 4 else ""
        assert part.title.endswith(f" holes for M3{pitch}")
        mesh = made._solids[name]
        body = manifold3d.Manifold(
            manifold3d.Mesh64(np.array(mesh.vertices), np.array(mesh.faces, np.uint64))
        )
        for at in cores:
            core, ring = (
                manifold3d.Manifold.cylinder(part.thickness, size, circular_segments=64).translate(
                    (at.real, at.imag, 0)
                )
                for size in (1.2, 1.25 + wall - 0.05)
            )
            assert (core ^ body).volume() == pytest.approx(0, abs=1e-6)
            hole = math.pi * 1.25**2 * part.thickness
            assert (ring ^ body).volume() == pytest.approx(ring.volume() - hole, abs=0.05 * hole)


@pytest.mark.parametrize("kind", FOLLOWERS)
def test_what_is_sawn_is_listed_as_long_as_it_is_built(kind: str) -> None:
    """Rods and shaft in halves of a millimetre, what ends in the track in tenths."""
    parts = machine(**FOLLOWERS[kind]).assembly.by_name
    for name, step in (("rod", 0.5), ("shaft", 0.5), ("roller-pin", 0.1)):
        length = parts[name].thickness
        assert length / step == pytest.approx(round(length / step), abs=1e-6), name
        (said,) = re.findall(r"h[89] ([\d.]+)", parts[name].notes[0])
        assert float(said) == pytest.approx(length, abs=1e-9)


def test_where_screws_have_no_room_there_are_none() -> None:
    """Walls of 8 mm leave 1.2 mm beside the middle of the carriage."""
    parts = machine(parts={"wall": 8.0}, geometry={"roller": SMALL}).assembly.by_name
    assert parts["carriage"].title == "Carriage" and len(round_holes(parts["carriage"])) == 1


def round_holes(part: Part) -> list[tuple[complex, float]]:
    """Centres and radii of a part's round holes, mm."""
    arcs = [hole.pieces[0] for hole in part.drawn.region.holes if len(hole.pieces) == 1]
    return [(arc.centre, arc.radius) for arc in arcs if isinstance(arc, Arc)]


def test_a_bracket_is_glued_on_its_rods_where_the_flat_drives_the_drum() -> None:
    made = machine(**FOLLOWERS["arm"])
    (lowered,) = (
        step
        for step in order_of_assembly(made.assembly).steps
        if "glue the bracket on them" in step.title
    )
    rods = {complex(each.at) for each in made.assembly.mounts if each.part == "rod"}
    on_rods = [
        mate.how
        for mate in lowered.mates
        if min(abs(complex(*mate.place[:2]) - at) for at in rods) < 1e-3
    ]
    assert on_rods and {*on_rods} == {"glue"}
    assert {mate.how for mate in lowered.mates} == {"glue", "free"}, "the drum is dry"
