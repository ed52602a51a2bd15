"""Two sides on one shaft: the far one moves as the near one does a phase later, is its mirror image, and is judged from its files."""

from __future__ import annotations

import csv
import math
import shutil
import tomllib
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import ezdxf
import numpy as np
import pytest
import tomli_w
from hypothesis import example, given, settings
from hypothesis import strategies as st
from judged import wrong
from shapely import Point, Polygon

from camgen import starters
from camgen.errors import DesignError, SpecError
from camgen.files.threemf import write_3mf
from camgen.findings import Finding
from camgen.geometry.facets import facet_contour
from camgen.geometry.mesh import Mesh
from camgen.geometry.outlines import Arc, Contour
from camgen.judge.floor import judge_floor
from camgen.machines.linkage.assembling import mirror
from camgen.machines.linkage.mechanism import Linkage
from camgen.parts.assembly import bodies_in_motion, order_of_assembly
from camgen.parts.sides import both_sides
from camgen.parts.solids import solid
from camgen.pipeline.build import build
from camgen.pipeline.making import assembly_copies
from camgen.spec import validate

WALKER = {  # a four-bar between two plates; its plates are no mirror images of themselves
    "mechanism": "linkage",
    "name": "sides",
    "drive": {"link": "crank"},
    "points": {"O": [0, 0], "C": [60, 0], "A": [15, 0], "B": [50, 40]},
    "links": {
        "ground": ["O", "C"],
        "crank": ["O", "A"],
        "rod": ["A", "B"],
        "rocker": ["C", "B"],
    },
    "output": [{"name": "foot", "link": "rocker"}],
    "parts": {"plates": 2, "shaft": "interrupted", "sides": 2, "side_phase_deg": 90},
}


def walker(parts: Mapping[str, Any] | None = None, **more: Any) -> Linkage:
    return validate(Linkage, {**WALKER, **more, "parts": {**WALKER["parts"], **(parts or {})}})


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("sides")
    (out / "sides.toml").write_text(tomli_w.dumps(WALKER), encoding="utf-8")
    report = build(out / "sides.toml", out, frozenset({"dxf", "3mf"}))
    assert report.ok, [finding for finding in report.findings if not finding.ok]
    assert not report.not_judged
    return out / "sides"


@pytest.fixture(scope="module")
def machine() -> Linkage:
    return walker()


@pytest.mark.long
def test_the_far_foot_moves_a_phase_later_as_the_files_show(folder: Path) -> None:
    """motion.csv has a row every quarter degree: 90 deg are 360 rows."""
    with (folder / "motion.csv").open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))[:-1]
    for kind in ("", "_dxf", "_3mf"):
        near, far = (
            np.array([float(row[f"{name}_deg{kind}"]) for row in rows])
            for name in ("foot", "far_foot")
        )
        assert np.ptp(near) > 10
        np.testing.assert_allclose(far, np.roll(near, -360), atol=1e-4)


@pytest.mark.long
@settings(max_examples=3, deadline=None)
@given(phase=st.floats(-math.tau, math.tau), theta=st.floats(0, math.tau))
@example(phase=0.0, theta=1.0)
@example(phase=math.pi / 2, theta=0.0)
def test_each_body_is_the_mirror_image_of_the_near_one(
    machine: Linkage, phase: float, theta: float
) -> None:
    """Of the solids, where they stand: volume, middle and moments of inertia, mirrored in the plane between both sides."""
    degrees = math.degrees(phase)
    other = walker({"side_phase_deg": degrees}, layers=machine.resolved().layers)
    vars(other)["_solids"] = machine._solids  # equal but for the shaft of both sides
    scenes = {"near": other.scene(theta + phase), "far": other.scene(theta)}
    plane = mirror(other.bodies.layout).height
    for body in ("crank", "rod", "rocker"):
        near, far = (
            [mesh for name, mesh in _copies(scenes[side], prefix + body)]
            for side, prefix in (("near", ""), ("far", "far_"))
        )
        assert near and far
        near, far = sum(near[1:], near[0]), sum(far[1:], far[0])
        assert far.volume == pytest.approx(near.volume, rel=1e-4)
        x, y, z = near.center_mass
        assert far.center_mass == pytest.approx([x, y, 2 * plane - z], abs=2e-3)
        signs = np.array([[1, 1, -1], [1, 1, -1], [-1, -1, 1]])
        scale = np.abs(near.moment_inertia).max()
        assert np.abs(far.moment_inertia - near.moment_inertia * signs).max() < 1e-3 * scale


def _copies(scene: Any, body: str) -> list[tuple[str, Any]]:
    """Solids on a body in the world, without the shaft, which only one of the sides has."""
    children = [
        name for name in scene.graph.nodes_geometry if scene.graph.transforms.parents[name] == body
    ]
    found = []
    for name in children:
        matrix, geometry = scene.graph[name]
        if not geometry.startswith(("shaft", "collar", "far-shaft")):
            mesh = scene.geometry[geometry].copy()
            mesh.apply_transform(matrix)
            found.append((name, mesh))
    return found


def test_what_needs_no_image_is_the_same_part_twice(machine: Linkage) -> None:
    parts = machine.assembly.by_name
    for name in ("crank", "rod", "rocker", "crank_web2", "crank-pin"):
        (part,) = (each for each in parts.values() if each.name.removesuffix("-1") == name)
        assert part.count == 2
    assert {name for name in parts if name.startswith("far-")} == {
        "far-ground",
        "far-shaft",
        "far-second-plate",
    }
    mounts = [mount for mount in machine.assembly.mounts if mount.part == "far-ground"]
    assert [mount.flipped for mount in mounts] == [True]
    # one image in the hand is the mirror image of the other
    near, far = parts["second-plate"], parts["far-second-plate"]
    assert dict(far.points) == {name: -z.conjugate() for name, z in near.points}


def test_one_shaft_reaches_both_sides_with_a_flat_for_either(machine: Linkage) -> None:
    """The upper half's flat, at the top of its circle, is turned by the phase."""
    shaft = machine.assembly.by_name["shaft-crank_web2"]
    assert shaft.count == 1
    low, high = shaft.layers
    assert low.z1 == high.z0 == pytest.approx(shaft.thickness / 2)
    for layer, away in ((low, 1j), (high, -1)):
        (line,) = (each for each in layer.region.outer.pieces if not hasattr(each, "radius"))
        middle = (line.a + line.b) / 2
        assert middle == pytest.approx(away * (3 - 0.8))


def test_the_drive_is_there_once(machine: Linkage) -> None:
    driven = walker({"motor": "nema-17"}).assembly
    counts = {each.name: each.count for each in driven.bought}
    assert counts["drive"] == 1 and counts["screw of the motor"] == 4
    assert counts["screw of a post"] == 16
    assert {each.name for each in driven.parts if each.name.endswith("shaft")} == {"far-shaft"}
    assert not any(each.role == "mount" for each in machine.assembly.bought)


def test_each_side_is_put_together_alone_and_then_joined(machine: Linkage) -> None:
    table = order_of_assembly(machine.assembly)
    steps = [row[1] for row in table.rows]
    assert steps.index("second-plate") < steps.index("far-ground") < steps.index("far-second-plate")
    assert steps[-2:] == ["both sides", "table"] and [row[0] for row in table.rows] == [
        *range(1, len(steps) + 1)
    ]
    # a collar comes loose first, and again when it is pushed up
    named = {name for step in table.steps for name in step.copies}
    assert sorted(named) == sorted(
        f"{part.name}-{k}" for part in machine.assembly.parts for k in range(1, part.count + 1)
    )


@pytest.mark.long
def test_a_hole_of_the_far_side_that_is_elsewhere_is_found(folder: Path, tmp_path: Path) -> None:
    """Of the rocker's pin, by 0.1 mm: the far foot goes elsewhere, and that joint fits no more."""
    shutil.copytree(folder, tmp_path / "sides")
    (path,) = (tmp_path / "sides").rglob("sides-far-ground.dxf")
    drawing = ezdxf.readfile(path)
    (hole,) = (
        each
        for each in drawing.modelspace().query("CIRCLE")
        if abs(complex(*each.dxf.center.vec2) + 60) < 1e-6
    )
    hole.dxf.center = (-60.1, 0, 0)
    drawing.saveas(path)
    found = {finding.code: str(finding.where) for finding in wrong(tmp_path / "sides", "dxf")}
    assert "far_foot" in found["MOTION_ERROR"] and found["PIN_GAP"].endswith(", far_C")


@pytest.mark.parametrize(
    ("spec", "said"),
    [
        ({"parts": {**WALKER["parts"], "plates": 1, "shaft": "through"}}, "parts.plates = 2"),
        (
            {
                "links": {**WALKER["links"], "far_rod": ["A", "D"]},
                "points": {**WALKER["points"], "D": [40, 9]},
            },
            "the rod of the far side has this one",
        ),
        ({"counterweight": {}}, "[counterweight]"),
    ],
)
def test_what_has_no_two_sides_is_told(spec: dict[str, Any], said: str) -> None:
    with pytest.raises(SpecError) as caught:
        validate(Linkage, {**WALKER, **spec})
    assert any(said in str(fault) for fault in caught.value.faults)


def test_a_shaft_that_ends_before_the_far_side_is_refused() -> None:
    """Of a motor that stands under the plate, and drives a shaft that goes through no web."""
    with pytest.raises(DesignError, match="parts.shaft"):
        _ = walker({"shaft": "through", "motor": "nema-17"}).assembly


def test_both_sides_are_made_of_any_two(machine: Linkage) -> None:
    """A mirror elsewhere only shifts the far side."""
    assert machine._far is not None
    near = machine._made_of(machine.bodies, machine.model)
    other = machine._made_of(*machine._far)
    between = mirror(machine.bodies.layout)
    whole, higher = (
        both_sides(
            near, other, replace(between, height=between.height + up, phase=0.0), machine.model
        )
        for up in (0.0, 7.0)
    )
    rises = [b.z - a.z for a, b in zip(whole.mounts, higher.mounts, strict=True)]
    assert rises == pytest.approx(
        [0.0] * len(near.mounts) + [14.0] * (len(rises) - len(near.mounts))
    )


@pytest.mark.parametrize(
    ("pin", "made", "asked"),
    [
        ("dowel", "turned of steel", {}),
        ("turned", "turned of steel", {}),
        ("printed", "printed", {}),
        ("dowel", "printed", {"shaft_made": "printed"}),
    ],
)
def test_shafts_and_crank_pins_are_of_steel_beside_pins_of_steel(
    pin: str, made: str, asked: Mapping[str, str]
) -> None:
    """A printed rod of 4 mm, as long as both sides are thick, is no shaft; what is asked for is made."""
    sizes = {"pin": pin, "pin_diameter": 4, "shaft_diameter": 4}
    parts = walker({**sizes, **asked}).assembly.parts
    rods = [part for part in parts if part.role in ("shaft", "crank-pin")]
    assert {part.role for part in rods} == {"shaft", "crank-pin"}
    assert {part.process for part in rods} == {made}


def test_two_sides_have_two_plates_and_a_shaft_that_goes_on_unless_the_spec_says_otherwise() -> (
    None
):
    bare = validate(Linkage, {**WALKER, "parts": {"sides": 2, "side_phase_deg": 90}})
    assert bare == walker()
    with pytest.raises(SpecError, match="parts.plates = 2"):
        validate(Linkage, {**WALKER, "parts": {"sides": 2, "plates": 1}})


def test_the_rod_of_both_sides_is_as_long_as_the_shaft_that_is_cut_of_it() -> None:
    """Its length is that of the solid; the flat of each side ends where the other one begins."""
    machine = walker({"shaft_made": "steel"})
    part = next(p for p in machine.assembly.parts if p.title == "Shaft of both sides")
    size, held = part.notes
    lower, upper = part.layers
    assert upper.z1 == part.thickness > 2 * machine.making.base_thickness
    assert size == (
        f"rod 6 h9 x {part.thickness:g}, a flat 0.8 deep on its lower {lower.z1:g}; "
        "on the rest it is turned by 90 deg counter-clockwise, seen from the upper end"
    )
    middles = [  # of the flat of either layer
        sum(complex(flat.at(t)) for t in (flat.t0, flat.t1)) / 2
        for layer in (lower, upper)
        for flat in layer.region.outer.pieces
        if not isinstance(flat, Arc)
    ]
    assert middles[1] / middles[0] == pytest.approx(1j), "from above, as its own frame is seen"
    assert "glued" in held


def test_a_sole_is_round_about_the_foot() -> None:
    """As wide as asked, and concentric with the foot's hole, on which its path is measured."""
    links = {**WALKER["links"], "rocker": ["C", "B", "F"]}
    points = {**WALKER["points"], "F": [50, 90]}
    foot = [{"name": "foot", "point": "F"}]
    machine = walker({"rocker": {"sole_diameter": 14}}, links=links, points=points, output=foot)
    rocker = machine.assembly.by_name["rocker"]
    at = dict(rocker.points)["F"]
    radii = [
        piece.radius for piece in rocker.region.outer.pieces if getattr(piece, "centre", None) == at
    ]
    assert set(radii) == {7.0}
    feet = machine.assembly.feet
    assert feet is not None and feet.parts == {"rocker", "far-rocker"}
    assert machine.assembly.down == feet.down == (0, -1, 0)
    with pytest.raises(SpecError, match="sole_diameter"):
        walker({"crank": {"sole_diameter": 14}})


N20 = {"boss_diameter": 4, "diameter": 12, "width": 10, "length": 26}


def test_a_gearbox_with_square_corners_is_held_by_a_sleeve() -> None:
    """Its hole is the gearbox with its fit; its screws pass beside it; the motor's shaft ends in the first web."""
    machine = walker({"can": N20, "shaft_diameter": 3, "shaft_flat": 0.5})
    sleeve = machine.assembly.by_name["motor-bar"]
    opening = max(sleeve.region.holes, key=lambda hole: abs(hole.area))
    press = machine.print.press_clearance
    assert abs(opening.area) == pytest.approx((12 + press) * (10 + press))
    (mount,) = (mount for mount in machine.assembly.mounts if mount.part == "motor-bar")
    assert mount.z == -sleeve.thickness
    layout = machine.bodies.layout
    assert machine.bodies.shaft_reach == pytest.approx(layout.top(layout.level["crank"]))
    # below the sleeve nothing but the motor
    (motor,) = (each for each in machine.assembly.stand_ins if each.name == "motor")
    assert motor.discs[0][2:] == (-26, -sleeve.thickness)


def xy(contour: Contour) -> np.ndarray:
    rim = facet_contour(contour, 0.01)
    return np.column_stack([rim.real, rim.imag])


@pytest.mark.parametrize("middle", [31, 59])
def test_heads_of_screws_pass_beside_the_frame_of_the_batteries(middle: float) -> None:
    """The frame of the toy that walks covers no head of M3, 5.5 wide [ISO 4762], wherever it is put."""
    spec = starters.text("walker").replace("at = [0, 59]", f"at = [0, {middle}]")
    machine = validate(Linkage, tomllib.loads(spec))
    frame = machine.assembly.by_name["far-battery-frame"].region.outer
    whole = Polygon(xy(frame) + [0, middle])
    screws = [each.at for each in machine.assembly.mounts if each.part == "side-spacer"]
    assert len(screws) == 4
    assert all(whole.distance(Point(z.real, z.imag)) > 5.5 / 2 for z in screws)


def test_batteries_lie_in_a_frame_under_the_far_plate() -> None:
    battery = {"length": 40, "width": 20, "at": [20, 30]}
    machine = walker({"battery": battery})
    frame = machine.assembly.by_name["far-battery-frame"]
    far = next(each for each in machine.assembly.mounts if each.part == "far-ground")
    (mount,) = (each for each in machine.assembly.mounts if each.part == frame.name)
    assert mount.at == 20 + 30j
    assert mount.z == pytest.approx(far.z + machine.making.base_thickness)
    plate, rim = (each.region.outer for each in (machine.assembly.by_name["far-ground"], frame))
    area = Polygon(xy(plate) * [-1, 1]).buffer(0.02)  # it lies turned over
    assert area.contains(Polygon(xy(rim) + [20, 30])), "all of it is glued on"
    with pytest.raises(DesignError, match="parts.battery.at"):
        _ = walker({"battery": {**battery, "at": [0, 0]}}).assembly
    with pytest.raises(SpecError, match="parts.battery"):
        walker({"battery": battery, "sides": 1})


def test_what_hangs_lower_than_the_feet_is_found(tmp_path: Path) -> None:
    """By its drawing the crank is the lowest beside the feet; a plate that reaches so far down leaves 1 mm."""
    links = {**WALKER["links"], "rocker": ["C", "B", "F"]}
    points = {**WALKER["points"], "F": [62, -70]}
    foot = [{"name": "foot", "point": "F"}]
    walking = walker({"rocker": {"sole_diameter": 14}}, links=links, points=points, output=foot)
    made = walking.assembly
    assert made.feet is not None
    meshes = {part.name: solid(part, 0.02) for part in made.parts}
    path = tmp_path / "a.3mf"

    def judged() -> Finding:
        write_3mf(path, meshes, assembly_copies(walking), "key")
        assert made.feet is not None
        return judge_floor(path, bodies_in_motion(made), made.feet.down, made.feet.parts)

    run = walking.solve(np.linspace(0, math.tau, 721), 0)
    floor = np.minimum(*(np.imag(run[f"{side}foot"]) - 14 / 2 for side in ("", "far_")))
    theta = np.linspace(0, math.tau, 721)
    hub = walking.bodies.layout.hub("A", "crank")
    lowest = np.minimum(15 * np.sin(theta), 15 * np.sin(theta + math.pi / 2)) - hub
    whole = judged()
    assert whole.ok and whole.message.startswith("crank-")
    assert whole.measured == pytest.approx(float(np.min(lowest - floor)), abs=0.05)
    mesh = meshes["ground"]
    far = float(mesh.vertices[:, 1].min() - floor.max()) - 1
    meshes["ground"] = Mesh(mesh.vertices - np.array([0, far, 0]), mesh.faces)
    damaged = judged()
    assert not damaged.ok and damaged.measured == pytest.approx(1, abs=0.05)
    assert damaged.message.startswith("ground-1")


def test_sides_stand_as_far_apart_as_asked(machine: Linkage) -> None:
    """Spacers fill the way between both second plates, each over a post; all of the far side, and the shaft, go on by it."""
    wider = walker({"side_gap": 40})
    near, far = machine.assembly, wider.assembly
    spacer = far.by_name["side-spacer"]
    mounts = [each for each in far.mounts if each.part == "side-spacer"]
    posts = [each.at for each in near.mounts if each.part == "post"]
    assert spacer.thickness == 40 and spacer.count == len(mounts) == 4
    assert {each.at for each in mounts} == {*posts}
    upper = max(each.z for each in far.mounts if each.part == "second-plate")
    assert [each.z for each in mounts] == pytest.approx([upper - 40] * 4)
    for name in ("ground", "second-plate"):
        heights = [max(m.z for m in made.mounts if name in m.part) for made in (near, far)]
        assert np.diff(heights) == pytest.approx([40])
    shaft = "shaft-crank_web2"
    assert far.by_name[shaft].thickness == pytest.approx(near.by_name[shaft].thickness + 40)
    dry, last = (row for row in order_of_assembly(far).rows if row[1] == "both sides")
    assert "dry" in dry[2] and "on spacers" in last[2]


def test_sides_with_spacers_come_apart_without_their_screws(machine: Linkage) -> None:
    """M3 [ISO 273: 3.4, ISO 2306: 2.5] goes through plate, post and second plate and cuts its thread in the spacer, 1.5 diameters
    deep at least, from either side; where both would meet the spacers are glued. No screws hold a walker's plate from behind."""
    made = walker({"side_gap": 40}).assembly
    parts = made.by_name
    bores = {name: parts[name].bore for name in ("post", "side-spacer")}
    assert bores == {"post": 3.4, "side-spacer": 2.5}
    (screw,) = (each for each in made.bought if each.name == "screw of a spacer")
    assert screw.count == 8 and not any(each.name == "screw of a post" for each in made.bought)
    post = next(each for each in made.mounts if each.part == "post")
    grip = post.z + parts["post"].thickness + parts["second-plate"].thickness - 1.65 - 0.2
    length = float(screw.size.split(",")[0].removeprefix("M3 x "))
    assert 4.5 <= length - grip < 20
    assert parts["second-plate"].count == 2 and len(parts["second-plate"].layers) == 1
    glued = walker({"side_gap": 8}).assembly
    assert glued.by_name["post"].bore == 2.5 and glued.by_name["side-spacer"].bore == 6.2
    assert {each.name for each in glued.bought} >= {"screw of a post"}
    holes = {
        each: len(machine.assembly.by_name[each].drawn.region.holes)
        for each in ("ground", "far-ground")
    }
    assert all(
        "screws from behind" not in note for note in machine.assembly.by_name["ground"].notes
    ), holes


@pytest.mark.parametrize("parts", [{"sides": 1, "side_gap": 10}, {"side_gap": 0.5}])
def test_a_gap_that_no_spacer_fills_is_refused(parts: dict[str, Any]) -> None:
    with pytest.raises(SpecError, match="side_gap"):
        walker(parts)


def test_letters_of_holes_leave_one_part_for_both_sides() -> None:
    """A link that is the same at all heights is its own mirror image, and stays so with letters on one face."""
    plain = walker().assembly
    lettered = walker(files={"hole_letters": True}).assembly
    assert [(each.name, each.count) for each in lettered.parts] == [
        (each.name, each.count) for each in plain.parts
    ]
    assert any(each.lettered and each.count > 1 for each in lettered.parts)
