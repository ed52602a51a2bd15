"""[[include]]: another spec's machine on the same shaft moves, is made and is judged as it is by itself."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from camgen.errors import DesignError, SpecError
from camgen.judge.assembly import sweep
from camgen.machine.features import Mark
from camgen.machine.joining import Module, joined
from camgen.machine.run import solve
from camgen.machines.included import opened
from camgen.machines.sources import read_mechanism
from camgen.parts.assembly import bodies_in_motion
from camgen.pipeline.build import build, check
from camgen.pipeline.case import Case
from camgen.pipeline.making import make_parts, put_together
from camgen.progress import silent
from camgen.reading import read
from camgen.workers import Workers

THETA = np.linspace(0, math.tau, 97)
MODULES = ("eccentric-drive", "thread-take-up", "chain-stitch-looper")


@pytest.fixture
def tables(root: Path) -> dict[str, Any]:
    found = read(root / "specs" / "linkage.toml")
    found["drive"]["speed_rpm"] = 5000
    found["limits"]["pv_mpa_m_s"] = 10.0  # printed pins do not bear that speed dry
    return found


def include(root: Path, tables: dict[str, Any], *modules: dict[str, Any]) -> dict[str, Any]:
    return opened({**tables, "include": list(modules)}, root / "specs")


@pytest.mark.parametrize("name", MODULES)
def test_machine_joined_moves_as_by_itself(root: Path, name: str) -> None:
    """Outputs, poses and forces are those of the machine alone, so much ahead and so far away."""
    host = read_mechanism(root / "specs" / "linkage.toml").model
    alone = read_mechanism(root / "specs" / f"{name}.toml")
    module = Module("other", 12 - 7j, math.radians(50), 9.0)
    whole = joined(host, {module: alone.model})
    run, ahead = solve(whole, THETA), alone.solve(THETA + module.phase)
    for output in alone.model.outputs:
        moved = run[f"other_{output.name}"]
        shift = module.at if np.iscomplexobj(moved) else 0
        assert np.allclose(moved, ahead[output.name] + shift, rtol=0, atol=1e-9)
        rate = run.derivatives(f"other_{output.name}")[1]
        assert np.allclose(rate, ahead.derivatives(output.name)[1], rtol=0, atol=1e-8)
    for body in alone.model.moving:
        assert np.allclose(
            run.pose(f"other_{body.name}").place,
            ahead.pose(body.name).place + module.at,
            rtol=0,
            atol=1e-9,
        )


@pytest.mark.long
def test_take_up_included_keeps_its_figures(root: Path, tables: dict[str, Any]) -> None:
    """Its numbers and limits are those of its own spec, its parts have its names, and it stands above the host."""
    own = read_mechanism(root / "specs" / "thread-take-up.toml").resolved()
    whole = read_mechanism(
        include(root, tables, {"spec": "thread-take-up.toml", "at": [0, 120], "phase_deg": 30})
    )
    numbers = whole.study().numbers
    for name, value in own.study().numbers.items():
        assert numbers[f"thread_take_up_{name}"] == pytest.approx(value, rel=1e-12, nan_ok=True)
    mine = {
        (f.code, f.measured) for f in whole.limits() if str(f.where).startswith("thread_take_up")
    }
    assert mine == {(f.code, f.measured) for f in own.limits()}
    parts = {part.name for part in whole.assembly.parts}
    assert {f"thread-take-up-{part.name}" for part in own.assembly.parts} < parts
    poses = whole.assembly.poses(np.zeros(1))
    low = min(
        pose.z
        for name, copies in poses.items()
        if name.startswith("thread-take-up")
        for pose in copies
        if pose.z
    )
    high = max(
        pose.z + part.thickness
        for part in whole.assembly.parts
        if not part.name.startswith("thread")
        for pose in poses[part.name]
    )
    assert low >= high


@pytest.mark.long
def test_whole_is_built_judged_and_built_again(
    root: Path, tables: dict[str, Any], tmp_path: Path
) -> None:
    """Every joint of host and module is measured, a hole that is off in the module's file is found at its output, and the
    resolved spec needs no other file."""
    data = include(root, tables, {"spec": "thread-take-up.toml", "at": [0, 120], "phase_deg": 30})
    data |= {
        "name": "two",
        "motor": {"torque_n_m": 20},
    }  # the take-up needs more than its host's own
    report = build(data, tmp_path, frozenset({"dxf"}))
    assert report.ok
    folder = tmp_path / "two"
    head = (folder / "motion.csv").read_text(encoding="utf-8").split("\n")[0].split(",")
    assert {"pen_x_mm", "thread_take_up_feed_mm", "thread_take_up_feed_mm_dxf"} <= set(head)
    again = build(folder / "spec.toml", tmp_path / "again", frozenset({"dxf"}))
    assert again.ok
    for path in folder.iterdir():
        assert path.read_bytes() == (tmp_path / "again" / "two" / path.name).read_bytes(), path.name
    file = folder / "two-thread-take-up-coupler.dxf"
    other = folder / "two-coupler.dxf"
    file.write_text(other.read_text(encoding="utf-8"), encoding="utf-8")
    assert not check(folder).ok


@pytest.mark.long
def test_machines_in_one_place_meet(root: Path, tables: dict[str, Any], tmp_path: Path) -> None:
    """The sweep of the whole sees host and module."""
    data = include(root, tables, {"spec": "thread-take-up.toml", "at": [0, 0], "z": 0})
    case = Case(read_mechanism(data).resolved(), tmp_path)
    with Workers() as workers:
        put_together(
            case, frozenset({"3mf"}), make_parts(case, frozenset({"3mf"}), workers, silent), silent
        )
    failed = [
        finding
        for finding in sweep(
            case.file("assembly", "3mf"), bodies_in_motion(case.mechanism.assembly)
        )[0]
        if not finding.ok
    ]
    assert {finding.code for finding in failed} == {"INTERFERENCE"}
    assert any("coupler-1 and thread-take-up-coupler-1" in str(f.where) for f in failed)


def test_a_linkage_is_included_too(root: Path, tables: dict[str, Any]) -> None:
    """With all its defaults filled in, among them an empty list of includes."""
    data = include(root, tables, {"spec": "quick-return.toml", "at": [0, 300]})
    again = read_mechanism(
        read_mechanism(data).resolved().model_dump(by_alias=True, exclude_none=True)
    )
    names = {part.name for part in again.assembly.parts}
    assert {"quick-return-ram", "quick-return-arm", "coupler"} <= names
    bought = [each.name for each in again.assembly.bought]
    assert "coupling or toothed belt 1 : 1, quick_return" in bought and bought.count("drive") == 1


@pytest.mark.parametrize(
    ("change", "key", "said"),
    [
        ({"spec": "/thread-take-up.toml"}, "include.0.spec", "relative"),
        ({"spec": "..\\thread-take-up.toml"}, "include.0.spec", "relative"),
        ({"name": "1a"}, "include.0.name", ""),
        ({"colour": 1}, "include.0.colour", "unknown"),
        ({"spec": {"mechanism": "linkages", "name": "x"}}, "include.0.spec.mechanism", ""),
        (
            {"spec": {"include": [{"spec": "linkage.toml"}]}},
            "include.0.spec",
            "take the [[include]] of linkage.toml out of it",
        ),
        (
            {"spec": "stitch-head.toml"},
            "include.0.spec",
            "of chain-stitch-looper.toml, thread-take-up.toml out of it, and write",
        ),
    ],
)
def test_wrong_include_is_told_by_its_key(
    root: Path, tables: dict[str, Any], change: dict[str, Any], key: str, said: str
) -> None:
    with pytest.raises(SpecError) as told:
        read_mechanism(include(root, tables, {"spec": "thread-take-up.toml", **change}))
    assert [fault.key for fault in told.value.faults] == [key]
    assert said in told.value.faults[0].expected


@pytest.mark.parametrize(
    ("name", "said"), [("cylinder-cam", "plane"), ("linear-cam", "slides"), ("drum", "comb")]
)
def test_a_drum_or_plate_is_on_no_shaft_of_others(
    root: Path, tables: dict[str, Any], name: str, said: str
) -> None:
    with pytest.raises(SpecError) as told:
        _ = read_mechanism(include(root, tables, {"spec": f"{name}.toml"})).assembly
    assert [fault.key for fault in told.value.faults] == ["include.0.spec"]
    assert name in str(told.value) and said in str(told.value)


def test_a_machine_whose_drive_slides_is_on_no_shaft(root: Path, tables: dict[str, Any]) -> None:
    data = include(root, tables, {"spec": "thread-take-up.toml"})
    data["include"][0]["spec"]["drive"] = {"slide": "ram", "range": [0, 20]}
    with pytest.raises(SpecError, match="turned by a shaft") as told:
        read_mechanism(data)
    assert [fault.key for fault in told.value.faults] == ["include.0.spec.drive.slide"]


def test_a_fault_inside_names_the_file(root: Path, tables: dict[str, Any]) -> None:
    data = include(root, tables, {"spec": "thread-take-up.toml"})
    data["include"][0]["spec"]["geometry"]["frame"] = -4
    with pytest.raises(SpecError) as told:
        read_mechanism(data)
    assert [fault.key for fault in told.value.faults] == ["include.0.spec.geometry.frame"]
    assert told.value.faults[0].expected.endswith("(in thread-take-up.toml)")


def test_names_that_meet_those_of_the_host_are_told(root: Path, tables: dict[str, Any]) -> None:
    tables["output"][0]["name"] = "thread_take_up_feed"
    with pytest.raises(SpecError) as told:
        _ = read_mechanism(include(root, tables, {"spec": "thread-take-up.toml"})).assembly
    assert [fault.key for fault in told.value.faults] == [
        "include.0.name"
    ] and "thread_take_up_feed" in str(told.value)


def test_two_of_one_name_and_faults_inside_are_told(root: Path, tables: dict[str, Any]) -> None:
    both = include(
        root,
        tables,
        {"spec": "thread-take-up.toml"},
        {"spec": "thread-take-up.toml", "at": [0, 300]},
    )
    both["include"][0]["spec"]["geometry"]["frame"] = -4
    with pytest.raises(SpecError) as told:
        read_mechanism(both)
    assert [fault.key for fault in told.value.faults] == [
        "include.0.spec.geometry.frame",
        "include.1.name",
    ]
    impossible = include(root, tables, {"spec": "thread-take-up.toml"})
    impossible["include"][0]["spec"]["geometry"]["frame"] = 90
    with pytest.raises(
        DesignError, match=r"^thread_take_up \(thread-take-up\.toml\): gap at joint B is 71 mm"
    ):
        _ = read_mechanism(impossible).assembly


# ---- bodies that ride ------------------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def head() -> Any:
    return read_mechanism(Path(__file__).resolve().parents[2] / "specs" / "stitch-head.toml")


def test_stitch_head_moves_as_the_stitch_asks(root: Path, head: Any) -> None:
    """The spreaders follow their program; the needle bar is off by what a rod of finite length adds to a harmonic motion."""
    stitch = read_mechanism(root / "specs" / "chain-stitch-looper.toml")
    off = {
        str(f.where).split(" ")[1]: f.measured for f in head.limits() if f.code == "PROGRAM_ERROR"
    }
    crank, rod = 35.3333333333 / 2, 175.0
    assert off["lower-spreader"] < 1e-9 and off["upper-spreader"] < 1e-9
    assert off["needle-1"] == pytest.approx(
        rod - math.sqrt(rod**2 - crank**2), rel=1e-6
    )  # at half stroke
    poses = head.assembly.poses(THETA)
    (spreader,) = poses["chain-stitch-looper-lower-spreader"]
    assert np.allclose(spreader.place - spreader.place[0], stitch.motion(THETA), rtol=0, atol=1e-9)
    (needle,) = poses["chain-stitch-looper-needle-2"]
    lift = rod * np.sqrt(1 - (crank / rod * np.sin(THETA)) ** 2) - rod + crank * (1 - np.cos(THETA))
    assert np.allclose((needle.place - needle.place[0]).imag, lift, rtol=0, atol=1e-8)


@pytest.mark.long
def test_stitch_head_keeps_each_module_s_figures(root: Path, head: Any) -> None:
    numbers = head.study().numbers
    for name in ("chain-stitch-looper", "thread-take-up"):
        own = read_mechanism(root / "specs" / f"{name}.toml", ["motor.speed_rpm=3000"]).resolved()
        for key, value in own.study().numbers.items():
            assert numbers[f"{name.replace('-', '_')}_{key}"] == pytest.approx(
                value, rel=1e-9, nan_ok=True
            ), key


def test_joints_bear_what_the_spec_of_their_machine_says(root: Path, head: Any) -> None:
    """The take-up's pins turn in bronze, the head's own in oil; what is said of both stays with each."""
    assembly = head.assembly
    own = read_mechanism(root / "specs" / "thread-take-up.toml").assembly
    of_module = {joint.name for joint in own.machine.joints}
    assert {f"thread_take_up_{name}" for name in of_module} <= assembly.included_limits.keys()
    for name in of_module:
        found = assembly.limits_of(f"thread_take_up_{name}")
        assert found == own.material_limits and found.pv == 6 and "pins" in found.keys
    assert assembly.limits_of("A").pv == 2 and assembly.limits_of("a joint of none").pv == 2


@pytest.mark.long
def test_clearance_is_judged_where_the_riding_bodies_go(root: Path, tmp_path: Path) -> None:
    """A needle bar that is not where the stitch has it comes nearer to the spreader; too far off fails by its own code."""
    shipped = build(root / "specs" / "stitch-head.toml", tmp_path, frozenset({"dxf"}))
    assert shipped.ok
    apart = {
        str(f.where).split(":")[0]: f.measured for f in shipped.findings if f.code == "CLEARANCE"
    }
    assert 0.5 < apart["N2/P2"] < 1.345  # by its own program it keeps 1.345 mm
    short = [
        "lengths.A-B=120",
        "points.B=[3.2, 2.333333]",
        "points.U=[3.2, -5]",
        "points.V=[3.2, 45]",
        "points.P=[3.2, -30]",
    ]
    off = read_mechanism(root / "specs" / "stitch-head.toml", short)
    assert [f.code for f in off.limits() if not f.ok] == ["PROGRAM_ERROR"] * 2


@pytest.mark.parametrize(
    ("ride", "said"), [({"needle-9": "crank"}, "needle-9"), ({"needle-1": "cranks"}, "cranks")]
)
def test_who_cannot_ride_is_told(
    root: Path, tables: dict[str, Any], ride: dict[str, str], said: str
) -> None:
    with pytest.raises(SpecError) as told:
        _ = read_mechanism(
            include(root, tables, {"spec": "chain-stitch-looper.toml", "ride": ride})
        ).assembly
    assert said in str(told.value.faults[0])


# ---- machines that stand on the second plate -------------------------------------------------------------------------


STACKED = {
    "mechanism": "linkage",
    "name": "stacked",
    "drive": {"link": "crank", "speed_rpm": 300},
    "points": {"O": [0, 0], "C": [60, 0], "A": [15, 0], "B": [50, 40]},
    "links": {"ground": ["O", "C"], "crank": ["O", "A"], "rod": ["A", "B"], "rocker": ["C", "B"]},
    "output": [{"name": "out", "link": "rocker"}],
    "limits": {"pv_mpa_m_s": 2},
    "parts": {"plates": 2, "shaft": "interrupted"},
}
MOUNTED = {"spec": "thread-take-up.toml", "mounted": True, "phase_deg": 40}


def flat(part: Any, layer: int) -> float:
    """Where the flat of a shaft or its bore faces, rad: off the longest straight side."""
    region = part.layers[layer].region
    contour = next((hole for hole in region.holes), region.outer)
    ends = [complex(piece.at(0.5)) for piece in contour.pieces if type(piece).__name__ == "Line"]
    (middle,) = ends
    return math.atan2(middle.imag, middle.real)


def test_a_mounted_machine_stands_on_posts_and_turns_by_a_sleeve(root: Path) -> None:
    """Its flats are where both shafts have theirs, 40 deg apart and as the cranks are drawn; posts reach its frame's holes."""
    machine = read_mechanism(include(root, STACKED, MOUNTED))
    parts, poses = (
        {part.name: part for part in machine.assembly.parts},
        machine.assembly.poses(np.zeros(1)),
    )
    sleeve = parts["sleeve-thread-take-up"]
    own = float(poses["sleeve-thread-take-up"][0].angle[0])
    for layer, shaft in enumerate(("shaft-crank_web2", "thread-take-up-shaft")):
        there = float(poses[shaft][0].angle[0]) + flat(parts[shaft], 0)
        assert math.remainder(own + flat(sleeve, layer) - there, math.tau) == pytest.approx(
            0, abs=1e-9
        )
    ends = {name: poses[name][0].z + np.array([0, parts[name].thickness]) for name in poses}
    low, high = ends["sleeve-thread-take-up"]
    assert ends["shaft-crank_web2"][1] == pytest.approx(ends["thread-take-up-shaft"][0])
    assert low < ends["shaft-crank_web2"][1] < high < ends["thread-take-up-collar"][0]
    assert ends["post-thread-take-up"] == pytest.approx(
        [ends["second-plate"][1], ends["thread-take-up-ground"][0]]
    )
    take_up = read_mechanism(root / "specs" / "thread-take-up.toml")
    holes = sorted((complex(pose.place[0]) for pose in poses["post-thread-take-up"]), key=abs)
    frame = next(part for part in take_up.assembly.parts if part.name == "ground").region
    drilled = [hole for hole in frame.holes if abs(hole.pieces[0].radius - 1.25) < 1e-9]
    assert holes == pytest.approx(sorted((hole.pieces[0].centre for hole in drilled), key=abs))
    bought = [each.name for each in machine.assembly.bought]
    assert not [
        name
        for name in bought
        if "belt" in name or name.startswith("screw of the plate, from behind, thread")
    ]


def test_machines_with_shafts_alike_in_line_have_one_shaft_and_one_plate(root: Path) -> None:
    """The second plate has the frame's holes but the shaft's and those of its screws; the crank's bore is turned to the flat."""
    shaft = {"shaft_diameter": 11, "shaft_flat": 1}  # as that of the machine that it includes
    data = include(root, {**STACKED, "parts": {**STACKED["parts"], **shaft}}, MOUNTED)
    machine = read_mechanism(data)
    parts, poses = (
        {part.name: part for part in machine.assembly.parts},
        machine.assembly.poses(np.zeros(1)),
    )
    own = {
        part.name: part
        for part in read_mechanism(root / "specs" / "thread-take-up.toml").assembly.parts
    }
    assert not {f"thread-take-up-{name}" for name in ("ground", "shaft", "collar")} & parts.keys()
    assert not [
        each.name
        for each in machine.assembly.bought
        if "belt" in each.name or each.name.startswith("stud")
    ]
    crank, shaft = "thread-take-up-crank", "shaft-crank_web2"
    turned = [float(poses[name][0].angle[0]) + flat(parts[name], 0) for name in (crank, shaft)]
    assert math.remainder(turned[0] - turned[1], math.tau) == pytest.approx(0, abs=1e-9)
    top = poses[shaft][0].z + parts[shaft].thickness
    assert top == pytest.approx(poses[crank][0].z + parts[crank].thickness)
    small = [
        hole
        for hole in own["ground"].region.holes
        if abs(hole.pieces[0].radius) < 2 and hole.pieces[0].radius != 1.25
    ]
    assert len(small) == 4  # dowels and guides
    plate = parts["second-plate"]
    for hole in small:
        assert any(
            abs(each.pieces[0].centre - hole.pieces[0].centre) < 1e-9
            and each.pieces[0].radius == hole.pieces[0].radius
            for each in plate.region.holes
        )
    upper = poses["second-plate"][0].z + plate.thickness
    assert poses["thread-take-up-pivot-C"][0].z == pytest.approx(upper)
    marks = [each.eye for each in machine.assembly.features if isinstance(each, Mark)]
    assert [eye.part for eye in marks] == [
        "second-plate",
        "thread-take-up-coupler",
        "second-plate",
    ]


def cam_machine(root: Path) -> dict[str, Any]:
    cam = read(root / "specs" / "disc-cam.toml")
    return {**cam, "parts": {"make": "machine"}}


def test_a_mounted_cam_machine_stands_on_posts_beside_the_line(root: Path) -> None:
    """Posts under the screw holes of its frame as it is alone, from the second plate up to it; unmounted it has none."""
    cam = cam_machine(root)
    own = read_mechanism(cam).assembly
    assert own.frame is not None
    screws = sorted((z + 90 for z, _ in own.frame.fixings), key=abs)
    table = {"spec": cam, "mounted": True, "at": [90, 0]}
    made = read_mechanism({**STACKED, "include": [table]}).assembly
    poses = made.poses(np.zeros(1))
    posts = poses["post-disc-cam"]
    places = sorted((complex(pose.place[0]) for pose in posts), key=abs)
    assert len(screws) >= 2 and places == pytest.approx(screws)
    plate = made.by_name["second-plate"].thickness + poses["second-plate"][0].z
    for post in posts:
        assert post.z == pytest.approx(plate)
        assert post.z + made.by_name["post-disc-cam"].thickness == pytest.approx(
            poses["disc-cam-ground"][0].z
        )
    alone = read_mechanism({**STACKED, "include": [{**table, "mounted": False}]}).assembly
    assert "post-disc-cam" not in alone.by_name


def test_a_mounted_cam_machine_in_line_is_turned_by_the_hosts_shaft(root: Path) -> None:
    """Shafts alike: it has none of its own, its cam's tip and springs stand on the plate, and its follower moves as alone."""
    cam = cam_machine(root)
    machine = read_mechanism({**STACKED, "include": [{"spec": cam, "mounted": True}]})
    made = machine.assembly
    poses = made.poses(np.zeros(1))
    assert not {f"disc-cam-{name}" for name in ("ground", "shaft", "collar")} & made.by_name.keys()
    shaft, wheel = (
        (poses[name][0].z, poses[name][0].z + made.by_name[name].thickness)
        for name in ("shaft-crank_web2", "disc-cam-cam-contact")
    )
    assert shaft[0] < wheel[0] < wheel[1] <= shaft[1] + 1e-9
    assert not [each for each in made.bought if "belt" in each.name]
    alone = read_mechanism(cam)
    (output,) = alone.model.outputs
    run = solve(machine.model, THETA)
    assert np.ptp(run[f"disc_cam_{output.name}"]) == pytest.approx(12)  # the program's lift
    assert run[f"disc_cam_{output.name}"] == pytest.approx(alone.solve(THETA)[output.name])


@pytest.mark.parametrize(
    ("host", "change", "said"),
    [
        ({"parts": {}}, {}, "parts.plates = 2"),
        ({}, {"spec": "eccentric-drive.toml"}, "no frame with holes"),
        ({"parts": {"plates": 2, "mount_diameter": 3.3}}, {}, "parts.mount_diameter"),
    ],
)
def test_what_cannot_be_mounted_is_told(
    root: Path, host: dict[str, Any], change: dict[str, Any], said: str
) -> None:
    with pytest.raises(SpecError) as told:
        _ = read_mechanism(include(root, {**STACKED, **host}, {**MOUNTED, **change})).assembly
    assert [fault.key for fault in told.value.faults] == [
        "include.0.mounted"
    ] and said in told.value.faults[0].expected


@pytest.mark.long
@pytest.mark.parametrize(
    ("at", "z", "said"),
    [
        ((20, 0), -50, "at least "),
        ((20, 0), 20, "at least "),
        ((0, 0), 90, "or nothing: both shafts are one"),
    ],
)
def test_a_height_at_which_no_frame_can_stand_is_told(
    root: Path, at: tuple[float, float], z: float, said: str
) -> None:
    with pytest.raises(SpecError) as told:
        _ = read_mechanism(include(root, STACKED, {**MOUNTED, "at": list(at), "z": z})).assembly
    (fault,) = told.value.faults
    assert (fault.key, fault.value) == ("include.0.z", f"{z}") and said in fault.expected
    right = float(fault.expected.removeprefix("at least ").partition(",")[0])
    _ = read_mechanism(
        include(root, STACKED, {**MOUNTED, "at": list(at), "z": right + 1e-3 * (at != (0, 0))})
    ).assembly


@pytest.mark.long
def test_a_linkage_on_another_ones_second_plate(root: Path) -> None:
    """Posts pass by the collar that hangs under its frame; where a screw of it meets a pin of the plate, keys move it."""
    starter = read(root / "specs" / "linkage.toml")
    host, other = (
        {**starter, "parts": {"plates": 2}},
        {"spec": "linkage.toml", "name": "up", "mounted": True},
    )
    machine = read_mechanism(include(root, host, {**other, "at": [0, 90]}))
    parts, poses = (
        {part.name: part for part in machine.assembly.parts},
        machine.assembly.poses(np.zeros(1)),
    )
    radius = {
        name: abs(parts[name].region.outer.pieces[0].at(0.0)) for name in ("post-up", "up-collar")
    }
    (collar,) = poses["up-collar"]
    apart = min(abs(complex(post.place[0] - collar.place[0])) for post in poses["post-up"])
    assert apart - sum(radius.values()) >= machine.print.slide_clearance
    with pytest.raises(
        DesignError, match=r"mm between hole C and stand 1, a screw of the frame of up,.*include.at"
    ):
        _ = read_mechanism(include(root, host, other)).assembly


def test_beside_the_line_a_belt_turns_it_and_a_short_shaft_leaves_no_room(root: Path) -> None:
    beside = read_mechanism(include(root, STACKED, {**MOUNTED, "at": [20, 0]}))
    assert any("belt" in each.name for each in beside.assembly.bought) and "sleeve" not in "".join(
        p.name for p in beside.assembly.parts
    )
    data = include(root, STACKED, MOUNTED)
    data["include"][0]["spec"]["parts"] = {
        **data["include"][0]["spec"].get("parts", {}),
        "shaft_length": 6,
    }
    with pytest.raises(DesignError, match="room for a sleeve"):
        _ = read_mechanism(data).assembly
