"""Cylinder cams from a spec: sizes against the reference's numbers, files against damages."""

from __future__ import annotations

import json
import math
import re
import sys
import tomllib
from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path
from types import MappingProxyType
from typing import Any

import ezdxf
import numpy as np
import pytest

from camgen.errors import DesignError, SpecError
from camgen.files.dxf import read_contours
from camgen.files.formats import Job, write_part
from camgen.files.stl import write_stl
from camgen.findings import Finding
from camgen.geometry.mesh import Mesh
from camgen.geometry.outlines import Region, circle
from camgen.machines.cylinder_cam.bearings import Roller, pressed
from camgen.machines.cylinder_cam.mechanism import CylinderCam
from camgen.machines.sources import read_mechanism
from camgen.parts import materials
from camgen.parts.assembly import order_of_assembly
from camgen.parts.part import Layer, Part
from camgen.parts.solids import solid
from camgen.pipeline import build as pipeline
from camgen.pipeline.case import Case
from camgen.pipeline.development import judge_developments, make_developments
from camgen.pipeline.drums import judge_drum
from camgen.pipeline.shopping import bought_things
from camgen.pipeline.shown import animation
from camgen.spec import validate

sys.path.insert(0, str(Path(__file__).parents[1] / "geometry"))
from drums import REFERENCE  # noqa: E402
from still import still_svg  # noqa: E402

SPEC = Path(__file__).parents[2] / "specs" / "cylinder-cam.toml"
ARM = {"motion": "oscillating", "arm": 40.0}
# the reference's case A: a roller that begins 22 mm from the axis
SIZES = {"radius": 30.0, "roller": {"radius": 5.0, "length": 7.5, "end_clearance": 0.5}}


def published(text: str) -> object:
    """A number to one of its last decimal: the reference looked at fewer angles."""
    return pytest.approx(float(text), abs=1.01 * 10.0 ** -len(text.partition(".")[2]))


def drum(
    lift: float = 15.0, rise: Mapping[str, object] = MappingProxyType({}), **tables: dict[str, Any]
) -> CylinderCam:
    """The starter's motion, with another lift or rise; tables: keys in place of its own."""
    data = tomllib.loads(SPEC.read_text(encoding="utf-8"))
    data["geometry"]["roller"]["length"] = 6.0
    data["accuracy"] = {"chord_tolerance": 0.01}
    data["segment"][0] |= {"lift": lift, **rise}
    data["parts"]["pieces"] = 1
    for name, keys in tables.items():
        data[name] = {**data.get(name, {}), **keys}
    return validate(CylinderCam, data)


def verdicts(
    tmp_path: Path, machine: CylinderCam, change: Callable[[Mesh], Mesh] = lambda mesh: mesh
) -> dict[str, Finding]:
    """What the roller finds in the STL of a drum that is changed, by code."""
    (part,) = machine.assembly.parts
    case = Case(machine, tmp_path)
    write_stl(case.file("drum", "stl"), change(solid(part, 0.01)), "drum")
    return {each.code: each for each in judge_drum(case, ["stl"]).findings}


def failing(found: dict[str, Finding]) -> set[str]:
    """Codes that fail."""
    return {code for code, each in found.items() if not each.ok}


@pytest.fixture(scope="module")
def built(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The starter's folder, coarser and without a page."""
    out = tmp_path_factory.mktemp("drum")
    kinds = frozenset({"dxf", "stl", "3mf"})
    report = pipeline.build(SPEC, out, kinds, ["accuracy.chord_tolerance=0.01", "parts.pieces=1"])
    assert [each for each in report.findings if not each.ok] == []
    return out / "cylinder-cam"


def test_the_drum_is_as_small_as_the_pressure_angle_lets_it() -> None:
    """tan(alpha) = max |ds/dtheta| / r at the roller's inner end; a cycloidal rise is steepest at 2 lift / span. The radius is
    the next one of half millimetres, its length and the roller's height as a workshop writes them."""
    track = drum().track
    least = 2 * 15 / math.radians(120) / math.tan(math.radians(30))
    assert track.radius == math.ceil(2 * (least + track.radius - track.inner)) / 2
    assert 29 < track.steepest < 30
    assert [round(size, 1) for size in (track.length, track.height)] == [track.length, track.height]
    narrow = drum(5.0).track
    assert narrow.inner == pytest.approx(4 + 5 + 0.5)  # the roller stays clear of the bore


@pytest.mark.long
def test_the_smallest_drum_is_not_undercut_at_its_floor() -> None:
    """A steep wall reaches the floor's radius at a smaller depth than the roller's end: there it is undercut first."""
    steep = drum(limits={"pressure_angle_deg": 80.0}).track
    assert float(np.min(steep.walls[0])) > 0.1  # beside the roller there is room to spare
    assert steep.regular
    smaller = replace(steep, radius=steep.radius - 0.4)  # two steps of such a size
    with pytest.raises(DesignError, match="undercut"):
        smaller.drum.edge_heights  # noqa: B018


@pytest.mark.parametrize("share", [0.001, 0.03])
def test_a_wall_is_undercut_nowhere_near_a_break_of_its_law(share: float) -> None:
    """A law that gets up to speed in a thousandth of its span bends a wall in a tenth of a degree, between all even angles.

    By differences of points on the walls, 1e-5 deg apart about the end of that part, not by the formula of the search.
    """
    machine = drum(rise={"span_deg": 120, "lambda": share})
    walls = machine.track.drum.walls
    r = np.array([[0.0], [1e-5]]) + machine.track.drum.floor
    phi = -np.linspace(0, math.radians(2 * share * 120), 24001)
    step = phi[1] - phi[0]
    for wall in walls:
        found = wall.points(phi, r)
        turned = np.diff(found.beta[0]) / step
        deeper = np.diff(found.rho, axis=0)[0, :-1] / 1e-5
        leant = np.diff(found.beta, axis=0)[0, :-1] / 1e-5
        widened = np.diff(found.rho[0]) / step
        assert np.min(turned * deeper - leant * widened) > -1e-3
    assert all(0 < part.volume < math.inf for part in machine.assembly.parts)


def test_pressure_angles_and_areas_are_the_references() -> None:
    a = drum(geometry=SIZES)
    assert a.track.inner == 22
    assert a.track.steepest == published(REFERENCE["a"]["pressure_angle_deg"][0])
    nearest = 20 * (1 + math.cos(math.radians(10)))
    assert drum(20.0, geometry={**SIZES, "follower": ARM}).track.pivot == round(nearest, 1)
    swung = drum(20.0, geometry={**SIZES, "follower": {**ARM, "pivot": nearest}})
    assert swung.track.steepest == published(REFERENCE["b"]["pressure_angle_deg"][0])
    beside = swung.track.path.beside(np.linspace(0, 7, 9000), 0)
    assert np.abs(beside).max() == published(REFERENCE["b"]["farthest_beside"])


@pytest.mark.long
def test_a_build_gives_the_motion_of_both_meshes(built: Path) -> None:
    rows = np.genfromtxt(built / "motion.csv", delimiter=",", names=True)
    assert rows.dtype.names == ("theta_deg", "lift_mm", "lift_mm_stl", "lift_mm_3mf")
    assert (len(rows), rows["theta_deg"][-1]) == (1441, 360)
    assert rows["lift_mm"][600] == pytest.approx(15)  # 150 deg, in the dwell
    for kind in ("stl", "3mf"):
        assert np.abs(rows[f"lift_mm_{kind}"] - rows["lift_mm"]).max() < 0.01
    report = json.loads((built / "report.json").read_text())
    assert report["parts"][0]["files"] == ["cylinder-cam-drum.stl", "cylinder-cam-drum.3mf"]
    assert report["not_judged"] == []
    play = report["numbers"]["play_least_stl_mm"]
    assert play == pytest.approx(0.2, abs=0.02)


@pytest.mark.long
def test_the_resolved_spec_makes_the_same_drum(built: Path) -> None:
    resolved = pipeline.read_mechanism(built / "spec.toml")
    assert isinstance(resolved, CylinderCam)
    track = pipeline.read_mechanism(SPEC, ["parts.pieces=1"]).track  # type: ignore[attr-defined]
    assert resolved.geometry.radius == track.radius
    assert resolved.track.height == pytest.approx(track.height, abs=1e-12)
    assert pipeline.check(built).ok


def raised(mesh: Mesh) -> Mesh:
    """One vertex of the lower wall's upper dwell higher by 0.2 mm, twenty times the tolerance."""
    vertices = mesh.vertices.copy()
    normals = np.zeros(len(vertices))
    np.add.at(normals, mesh.faces.ravel(), np.repeat(mesh.across[:, 2], 3))
    rho = np.hypot(vertices[:, 0], vertices[:, 1])
    up = (normals > 0) & (rho < rho.max() - 2) & (vertices[:, 2] < vertices[:, 2].max() - 1)
    row = int(np.flatnonzero(up & (rho > rho[up].min() + 1))[0])
    vertices[row, 2] += 0.2
    return Mesh(vertices, mesh.faces)


def mirrored(mesh: Mesh) -> Mesh:
    """The drum that turns the other way."""
    return Mesh(mesh.vertices * np.array([1.0, -1.0, 1.0]), mesh.faces[:, ::-1])


@pytest.mark.long
def test_damages_are_refused(tmp_path: Path) -> None:
    data = drum(rise={"span_deg": 100.0, "law": "3-4-5"})
    assert failing(verdicts(tmp_path, data)) == set()
    assert "MOTION_ERROR" in failing(verdicts(tmp_path, data, mirrored))
    assert {"MOTION_ERROR", "GROOVE_FIT"} <= failing(verdicts(tmp_path, data, raised))

    def shifted(mesh: Mesh) -> Mesh:
        return Mesh(mesh.vertices + np.array([0.0, 0.0, 0.05]), mesh.faces)

    assert failing(verdicts(tmp_path, data, shifted)) == {"MOTION_ERROR"}

    # what is no drum any more is told by findings too: inches, inside out, two drums in one file, none at all
    def twice(mesh: Mesh) -> Mesh:
        count = len(mesh.vertices)
        return Mesh(
            np.concatenate([mesh.vertices, mesh.vertices + [0, 0, 90]]),
            np.concatenate([mesh.faces, mesh.faces + count]),
        )

    for damage in (
        lambda mesh: Mesh(mesh.vertices * 25.4, mesh.faces),
        lambda mesh: Mesh(mesh.vertices, mesh.faces[:, ::-1]),
        lambda mesh: Mesh(mesh.vertices, mesh.faces[:0]),
    ):
        assert "MOTION_ERROR" in failing(verdicts(tmp_path, data, damage))
    # of two drums the one is rolled that stands where the spec has it; VOLUME tells of the other
    assert failing(verdicts(tmp_path, data, twice)) == set()
    narrow = drum(print={"slide_clearance": 0.1})
    (part,) = narrow.assembly.parts
    assert "GROOVE_FIT" in failing(verdicts(tmp_path, drum(), lambda _: solid(part, 0.01)))


@pytest.mark.long
@pytest.mark.parametrize(
    "geometry",
    [
        {"track": "groove", "follower": ARM},
        {"track": "rib", "distance": 16.0},
        {"track": "end"},
    ],
)
def test_a_development_touches_the_roller_all_the_way(
    tmp_path: Path, geometry: dict[str, Any]
) -> None:
    case = Case(drum(geometry=geometry), tmp_path)
    make_developments(case)
    assert [each.ok for each in judge_developments(case)] == [True]
    other = Case(
        drum(lift=15.1, geometry={**geometry, "radius": case.mechanism.track.radius}), tmp_path
    )  # type: ignore[attr-defined]
    assert [each.ok for each in judge_developments(other)] == [False]


@pytest.mark.long
def test_a_smaller_cutter_leaves_what_the_reference_says(tmp_path: Path) -> None:
    """With a slide beside the axis a cutter of 3 mm in place of 5 takes 5.4 um too much at the roller's inner end."""
    sizes = {**SIZES, "roller": {"radius": 5.0, "length": 8.0, "end_clearance": 0.001}}
    machine = drum(geometry=sizes, print={"slide_clearance": 0.0}, files={"cutter_radius": 3.0})
    case = Case(machine, tmp_path)
    make_developments(case)
    _, path = judge_developments(case)
    found = re.search(r"at the floor the cutter is ([0-9.]+) mm off", path.message)
    # the reference's place is on the roller, which reaches a little less deep where it climbs
    assert path.ok and found and 0.0053 < float(found[1]) < 0.0061
    file = tmp_path / "cylinder-cam-drum-path.csv"
    rows = file.read_text(encoding="utf-8").splitlines()
    wall, theta, a, z, y = rows[300].split(",")
    rows[300] = ",".join([wall, theta, a, f"{float(z) - 0.1:.6f}", y])
    file.write_text("\n".join(rows) + "\n", encoding="utf-8")
    _, path = judge_developments(case)
    assert not path.ok


@pytest.mark.long
def test_a_wrapped_path_keeps_its_cutter_at_both_walls(tmp_path: Path) -> None:
    """Of the drawing alone: a cutter of 3 mm, radial on a cylinder of r, unrolls to at most r asin(3 / r) to either side."""
    machine = drum(files={"cutter_radius": 3.0}, accuracy={"chord_tolerance": 0.002})
    case = Case(machine, tmp_path)
    make_developments(case)
    file = case.file("drum-developed", "dxf")
    space = ezdxf.readfile(file).modelspace()  # type: ignore[attr-defined]
    (contour,), faults = read_contours(file)
    assert not faults
    radius = machine.track.roller.middle
    edge = contour.facetted(1e-3)
    ends = np.roll(edge, -1)
    paths = space.query('LWPOLYLINE[layer=="PATH"]')
    assert len(paths) == 2
    for each in paths:
        path = np.array([complex(x, y) for x, y, *_ in each.get_points()])
        inside = (path.imag > 6) & (path.imag < math.tau * radius - 6)
        assert inside.sum() > 600
        way = ends - edge
        share = ((path[inside, None] - edge) * way.conj()).real / np.abs(way) ** 2
        nearest = edge + np.clip(share, 0, 1) * way
        apart = np.abs(path[inside, None] - nearest).min(axis=1)
        assert apart.min() > 3 - 0.004
        assert apart.max() < radius * math.asin(3 / radius) + 0.004
    plain = Case(drum(), tmp_path)
    make_developments(plain)
    assert not ezdxf.readfile(file).modelspace().query('*[layer=="PATH"]')  # type: ignore[attr-defined]


@pytest.mark.long
@pytest.mark.parametrize(
    ("track", "more"),
    [
        ("end", {}),
        ("rib", {"distance": 16.0}),
        ("groove", {"follower": ARM}),
        ("end", {"follower": ARM}),
        (
            "groove",
            {
                "follower": {"offset": 3.0},
                "roller": {"radius": 4.0, "length": 6.0, "cone_deg": 8.0},
            },
        ),
    ],
)
def test_other_tracks_move_their_follower_too(
    tmp_path: Path, track: str, more: dict[str, Any]
) -> None:
    found = verdicts(tmp_path, drum(geometry={"track": track, **more}, limits={"lash": 0.6}))
    assert failing(found) == set()
    assert ("GROOVE_FIT" in found) == (track != "end")


def test_a_drum_turns_clockwise_too(tmp_path: Path) -> None:
    machine = drum(motor={"speed_rpm": -30.0})
    assert failing(verdicts(tmp_path, machine)) == set()
    assert machine.motion(np.array([math.radians(-60)]))[0] == pytest.approx(7.5)


def test_forces_are_those_of_the_follower() -> None:
    """15 N against a slide of 1 kg that stands: the torque is force times ds/dtheta, and an end cam lifts off without a spring."""
    load = {"resistance": 15.0}
    machine = drum(load=load, motor={"speed_rpm": 1e-3})
    numbers = machine.study().numbers
    assert numbers["peak_torque_n_m"] == pytest.approx(15 * 14.32394e-3, rel=1e-4)
    steepest = math.radians(machine.track.steepest)
    assert numbers["peak_contact_force_n"] == pytest.approx(15 / math.cos(steepest), rel=1e-4)
    fast = drum(geometry={"track": "end"}, load={"mass_kg": 1.0}, motor={"speed_rpm": 300.0})
    (off,) = (each for each in fast.limits() if each.code == "LIFT_OFF")
    assert not off.ok


def test_the_weight_of_the_follower_counts_or_is_said_not_to() -> None:
    """0.5 kg up a drum that stands and hardly turns: m g ds/dtheta, 14.32 mm/rad at the steepest of a cycloid of 15 mm over 120 deg."""
    slow = {"speed_rpm": 1e-3}
    upright = drum(load={"mass_kg": 0.5, "gravity_deg": -90.0}, motor=slow).study()
    weight = 0.5 * 9.80665
    assert upright.numbers["peak_torque_n_m"] == pytest.approx(weight * 14.32394e-3, rel=1e-4)
    assert not any("axis lies level" in note for note in upright.notes)
    level = drum(load={"mass_kg": 0.5}, motor=slow).study()
    assert any("load.gravity_deg = -90 to count the weight" in note for note in level.notes)


# rollers of the reference reach from 22 to 30 mm
LONG = {"radius": 30.0, "roller": {"radius": 5.0, "length": 8.0, "end_clearance": 0.001}}


def test_the_roller_slips_at_its_ends_as_the_reference_says() -> None:
    a = REFERENCE["a"]
    track = drum(geometry=LONG).track
    roller = Roller(track, math.tau)
    steepest = int(np.searchsorted(track.theta, math.radians(60)))
    dwell = int(np.searchsorted(track.theta, math.radians(150)))
    for side in (-1, 1):
        assert roller.slip(side, 30.0)[dwell] == published(a["slip_dwell"])
        found = [roller.slip(side, r)[steepest] for r in (22.0, 30.0)]
        assert found == [published(each) for each in a["slip_steepest"]]
        assert not roller.slip(side, track.roller.middle).any()
    cone = {**LONG["roller"], "cone_deg": float(REFERENCE["c"]["half_angle_deg"])}
    roller = Roller(drum(geometry={**LONG, "roller": cone}).track, math.tau)
    found = [roller.slip(1, r)[steepest] for r in (22.0, 30.0)]
    # the reference takes the pace on the roller's axis
    assert found == [
        pytest.approx(float(each), abs=2e-3) for each in REFERENCE["c"]["slip_steepest"]
    ]
    assert abs(roller.slip(1, 30.0)[dwell]) < 1e-4


def test_a_groove_turns_its_roller_round() -> None:
    a = REFERENCE["a"]
    machine = drum(geometry=LONG, motor={"speed_rpm": 100.0})
    roller = Roller(machine.track, math.radians(600))
    assert roller.inertia == pytest.approx(float(a["roller_inertia"]), rel=1e-3)
    turned = machine.track.theta - math.radians(
        60
    )  # once where it is steepest, and back in the dwell at 0
    spins = roller.reversals(turned)
    (spin, least) = sorted(spins, reverse=True)
    assert spin == published(a["spin"])
    assert least == pytest.approx(math.radians(600) * 26 / 5, rel=1e-4)
    slip, work = [*roller.reversal_figures(spins)][1:]
    assert slip.value == published(a["reversal_slip"])
    assert work.value == pytest.approx(float(a["reversal_work"]), rel=1e-3)
    assert not len(roller.reversals(np.abs(turned)))
    heavy = {"load": {"mass_kg": 2.0, "resistance": 2.0}, "motor": {"speed_rpm": 200.0}}
    study = drum(geometry=LONG, **heavy).study()
    assert study.numbers["roller_reversals"] == 4
    assert any("reverses 4 times per turn" in note for note in study.notes)
    rib = drum(geometry={"track": "rib", "distance": 16.0}, **heavy).study()
    assert "roller_reversals" not in rib.numbers.keys()


def test_shaft_and_guide_bear_what_the_roller_is_pressed_with() -> None:
    a = REFERENCE["a"]
    machine = drum(geometry={**LONG, "follower": {"guide": 40.0}}, load={"resistance": 200.0})
    track = machine.track
    force = pressed(track, np.full(len(track.theta), 200.0))
    size = np.hypot(force.onward, force.upward)
    assert size.max() == published(a["force"])
    assert np.abs(force.torque).max() == published(a["torque"])
    assert np.abs(force.upward - 200).max() < 1e-9 and not force.outward.any()
    numbers = machine.study().numbers
    side = 200 * math.tan(math.radians(float(a["pressure_angle_deg"][1])))
    assert numbers["thrust_shaft_n"] == pytest.approx(200)
    assert numbers["reaction_shaft_without_friction_n"] == pytest.approx(side, rel=1e-4)
    assert numbers["tilting_moment_shaft_n_m"] == pytest.approx(200 * 0.026, rel=1e-4)
    assert numbers["reaction_guide_without_friction_n"] == pytest.approx(side, rel=1e-4)
    assert numbers["tilting_moment_guide_n_m"] == pytest.approx(200 * 0.014, rel=1e-4)
    assert numbers["twisting_moment_guide_n_m"] == pytest.approx(side * 0.014, rel=2e-4)
    give = 2 * (1 - 0.3**2) / 206e3
    radius = float(a["least_relative_radius"])
    hertz = math.sqrt(size.max() / 8 / (math.pi * radius * give))
    assert hertz == published(a["pressure"])


@pytest.mark.parametrize(
    "geometry",
    [
        {"follower": {"offset": 4.0}, "roller": {**LONG["roller"], "cone_deg": 10.886}},
        {"follower": ARM, "roller": {**LONG["roller"], "cone_deg": 10.886}},
        {"follower": {**ARM, "pivot": 37.0, "start_deg": 5.0}},
    ],
    ids=["cone", "cone on an arm", "arm"],
)
def test_what_the_wall_does_to_the_roller_takes_the_shafts_torque(geometry: dict[str, Any]) -> None:
    """Two routes: forces in space about the drum's axis, and the power of the follower."""
    machine = drum(20.0, geometry={**LONG, **geometry})
    track = machine.track
    effort = 50.0 * np.cos(3 * track.theta)
    force = pressed(track, effort)
    np.testing.assert_allclose(
        force.torque, 1e-3 * effort * track.program(track.theta, 1), atol=1e-12
    )
    whole = np.sqrt(force.outward**2 + force.onward**2 + force.upward**2)
    share = float(REFERENCE["c"]["thrust_share"]) if track.slope else 0.0
    np.testing.assert_allclose(force.outward, share * whole, rtol=2e-3, atol=1e-12)


@pytest.mark.parametrize("half_angle", [0.0, 10.886], ids=["cylinder", "cone"])
def test_an_axle_bears_the_moment_of_the_force_in_space(half_angle: float) -> None:
    """By the cross product; about the axle itself it is what drives the follower. A cone's thrust has the arm for its lever."""
    follower = {**ARM, "guide": 45.0}
    roller = {**LONG["roller"], "cone_deg": half_angle}
    machine = drum(20.0, geometry={**LONG, "follower": follower, "roller": roller})
    track = machine.track
    effort = 50.0 * np.cos(3 * track.theta)
    force = pressed(track, effort)
    gamma = track.start + track.program(track.theta, 0)
    lever = [np.full(len(gamma), force.reach - 45.0), -40 * np.cos(gamma), 40 * np.sin(gamma)]
    moment = np.cross(
        np.stack(lever, axis=-1), np.stack([force.outward, force.onward, force.upward], axis=-1)
    )
    np.testing.assert_allclose(moment[:, 0], -effort, atol=1e-9)
    found = {each.quantity: each.value for each in force.figures(45.0) if each.joint == "pivot"}
    tilting = np.linalg.norm(moment[:, 1:], axis=1).max()
    assert found["tilting moment {joint}"] == pytest.approx(1e-3 * tilting, rel=1e-12)


def test_a_solid_without_a_track_in_the_drums_file_is_told(tmp_path: Path) -> None:
    case = Case(drum(), tmp_path)
    path = case.file("drum", "step")
    path.parent.mkdir(exist_ok=True)
    ring = Part("drum", "Ring", (Layer(Region(circle(0j, 20.0), (circle(0j, 4.0),)), 0.0, 20.0),))
    write_part(path, Job("drum", "x-drum", "key", ring.region, (), 0.001, "bulge", None, ring))
    (found,) = judge_drum(case, ["step"]).findings
    assert found.code == "MOTION_ERROR" and not found.ok
    assert "no walls that are splines" in found.message


def test_the_rollers_pressure_is_that_of_a_line_contact() -> None:
    """200 N on a slide that stands: in a dwell the wall is plane, and where it bends most the reference has its radius."""
    machine = drum(
        geometry=SIZES,
        load={"resistance": 200.0},
        motor={"speed_rpm": 1e-3},
        material={"name": "C45"},
        print={"slide_clearance": 0.0},
    )
    pressure = machine._pressure
    assert pressure is not None
    give = materials.of("C45").elastic.compliance + materials.STEEL.elastic.compliance

    def by_hand(force: float, radius: float) -> float:
        return math.sqrt(force / 7.5 / (math.pi * radius * give))

    dwell = int(np.searchsorted(machine.track.theta, math.radians(150)))
    assert pressure[dwell] == pytest.approx(by_hand(200, 5), rel=1e-9)
    tightest = float(REFERENCE["a"]["least_relative_radius"])
    steepest = math.cos(math.radians(float(REFERENCE["a"]["pressure_angle_deg"][0])))
    assert by_hand(200, tightest) < pressure.max() < by_hand(200 / steepest, tightest)
    (found,) = (each for each in machine.limits() if each.code == "HERTZ")
    assert found.measured == pressure.max() and found.ok == (found.measured <= found.limit)
    limited = machine.replace({"limits.hertz_mpa": 0.99 * found.measured})
    assert not next(each for each in limited.limits() if each.code == "HERTZ").ok
    acrylic = machine.replace({"material.name": "acrylic"})
    assert "HERTZ" not in {each.code for each in acrylic.limits()}
    assert [(each.code, each.needs) for each in acrylic.assembly.unjudged] == [
        ("HERTZ", "limits.hertz_mpa")
    ]
    assert not list(machine.assembly.unjudged)


@pytest.mark.parametrize(
    "follower", [{}, {"offset": 3.0}, {**ARM, "start_deg": -12.0}], ids=["slide", "beside", "arm"]
)
def test_the_roller_that_is_shown_moves_as_the_track_leads_it(follower: dict[str, Any]) -> None:
    """Its plane's x is the machine's -y, its y the machine's z; its heights count inwards."""
    machine = drum(20.0, geometry={**SIZES, "follower": follower})
    moving = animation(machine)
    roller = next(body for body in moving.bodies if body.name == "roller")
    (pose,) = roller.poses
    ((middle, radius),) = roller.circles
    shown = pose.place + np.exp(1j * pose.angle) * middle
    led = machine.track.path.place(-moving.theta, 0)
    np.testing.assert_allclose(-np.conj(shown), led, atol=1e-9)
    assert (radius, roller.heights) == (5.0, (-29.5, -22.0))
    still = still_svg(moving, "the drum from above")
    assert still.count('upright"') == 2 and ".upright{display:none}" in still


def test_both_rollers_of_a_rib_are_shown() -> None:
    machine = drum(geometry={"track": "rib", "distance": 16.0})
    roller = next(body for body in animation(machine).bodies if body.name == "roller")
    assert [middle for middle, _ in roller.circles] == [-8j, 8j]


def test_the_list_has_what_turns_and_what_rolls() -> None:
    """A roller of 10 x 4 is a ball bearing; 8 mm is the bore of a 608."""
    short = {"roller": {"radius": 5.0, "length": 4.0}}
    found = {each.name: each for each in drum(geometry=short).assembly.bought}
    assert (found["roller"].size, found["roller"].count) == ("MR105, 5 x 10 x 4", 1)
    assert (found["bearing of the shaft"].size, found["bearing of the shaft"].count) == (
        "608, 8 x 22 x 7",
        2,
    )
    # 5 + 31.5 + 2 (4 + 7) + 12
    assert found["shaft"].size == "8 h6 x 75, C45"
    made = found["shaft"].shaft
    assert made is not None and made.bores == ((16.0, 31.5),)
    rib = {"track": "rib", "distance": 16.0}
    cone = {"roller": {"radius": 5.0, "length": 6.0, "cone_deg": 5.0}}
    found = {
        each.name: each
        for each in drum(geometry={**rib, **cone}, parts={"bore": 9.0}).assembly.bought
    }
    assert (found["roller"].size, found["roller"].count) == (
        "10 x 6, a cone of 5 deg half angle",
        2,
    )
    assert "bearing of the shaft" not in found


@pytest.mark.parametrize(
    ("radius", "said"),
    [
        # MR105 and 623 are 10 across and 4 wide, a 624 is 13 x 5 and bears more than a 695, 13 x 4
        (5.0, "10 x 6, turned (ball bearings of 10 are 4 wide: geometry.roller.length = 4)"),
        (
            6.0,
            "12 x 6, turned (no ball bearing is 12 across, the nearest one 13 x 5: "
            "geometry.roller.radius = 6.5, geometry.roller.length = 5)",
        ),
    ],
)
def test_a_roller_that_is_no_ball_bearing_is_told_with_one_that_is(
    radius: float, said: str
) -> None:
    made = drum(geometry={"roller": {"radius": radius, "length": 6.0}})
    (roller,) = (each for each in made.assembly.bought if each.name == "roller")
    assert roller.size == said


def test_what_is_wrong_is_told_by_its_keys() -> None:
    wrong = {
        "geometry": {"track": "rib", "follower": {"motion": "oscillating", "offset": 2.0}},
        "print": {"shrinkage": 0.003},
        "spring": {"preload": 3.0},
        "files": {"cutter_radius": 6.0, "profile_step_deg": 5.0},
    }
    inwards = {"roller": {"radius": 5.0, "length": 6.0, "cone_deg": -3.0}}
    with pytest.raises(SpecError, match="cannot be put into a groove"):
        drum(geometry=inwards)
    assert drum(geometry={**inwards, "track": "end"})
    with pytest.raises(SpecError) as caught:
        drum(**wrong)
    keys = {".".join(map(str, fault.path)) for fault in caught.value.faults}
    assert keys >= {
        "geometry.distance",
        "geometry.follower.arm",
        "geometry.follower.offset",
        "geometry.follower.motion",
        "print.shrinkage",
        "files.cutter_radius",
        "files.profile_step_deg",
        "spring",
    }
    assert 'spring - no table here: only track "end" has a spring' in str(caught.value)


@pytest.mark.parametrize(
    ("geometry", "value", "remedy"),
    [
        ({"follower": {"height": 1000.0}}, 1020.1, "move the follower down by more than 988.6 mm"),
        ({"follower": {"height": 1.0}}, -4.1, "move the follower up by more than 4.1 mm"),
        ({"track": "end", "length": 2.0}, -8.95, "the track takes 15 mm of the drum's 2"),
    ],
)
def test_a_track_that_leaves_its_drum_is_told_before_the_spec_is_filled_in(
    geometry: dict[str, Any], value: float, remedy: str
) -> None:
    """A roller of radius 5.1 with its play stands up to 15 mm above the height; of an end cam the lower wall alone counts."""
    with pytest.raises(DesignError) as refused:
        drum(geometry=geometry).resolved()
    assert refused.value.value == pytest.approx(value, abs=1e-6)
    assert remedy in str(refused.value)


KR19 = {"radius": 9.5, "length": 11.0}  # its ring


def named(track: str = "groove", **roller: float) -> CylinderCam:
    """A drum whose load names a KR19 as its roller."""
    geometry: dict[str, Any] = {"track": track, "roller": KR19 | roller}
    if track == "rib":
        geometry["distance"] = 30.0
    load = {"cam_follower": "KR19", "mass_kg": 50.0}
    return drum(
        geometry=geometry, load=load, limits={"bearing_life_h": 100.0}, motor={"speed_rpm": 600.0}
    )


def test_the_life_of_a_bought_roller_by_hand() -> None:
    """(C / P)^(10/3) million turns of a ring that rolls along its own way, C = 4.25 kN [INA]."""
    machine = named()
    (life,) = (each for each in machine.limits() if each.code == "BEARING_LIFE")
    theta = np.linspace(0, math.tau, 20001)
    r = machine.track.inner + KR19["length"] / 2
    way = np.sum(np.hypot(r * np.diff(theta), np.diff(machine.motion(theta))))
    mean = float(life.message.split("mean of ")[1].split(" N")[0])
    turns = 600 / 60 * way / (math.tau * KR19["radius"])  # a second
    hours = (4250 / mean) ** (10 / 3) * 1e6 / turns / 3600
    assert life.measured == pytest.approx(hours, rel=2e-3)
    assert "KR19" in life.message
    lives = [each for each in named("rib").limits() if each.code == "BEARING_LIFE"]
    assert {each.where.thing for each in lives} == {
        "bearing of lower roller",
        "bearing of upper roller",
    }


def test_a_bought_roller_is_listed_once_and_fits_its_track() -> None:
    count = {each.name: each.count for each in bought_things(named("rib"))}
    assert count["cam follower"] == 2 and "roller" not in count
    for key, value in {"radius": 19.0, "length": 12.0, "cone_deg": 3.0}.items():
        with pytest.raises(SpecError) as refused:
            named(**{key: value}).resolved()
        assert [fault.path for fault in refused.value.faults] == [("geometry", "roller", key)]
    with pytest.raises(SpecError, match="parts.make"):
        drum(load={"cam_follower": "KR19"}, parts={"make": "printed"}).resolved()


def test_no_drum_is_told_as_such() -> None:
    with pytest.raises(DesignError, match="pressure angle"):
        drum(60.0, geometry={"follower": ARM}, limits={"pressure_angle_deg": 20.0}).track  # noqa: B018
    # a slope of 0.001 asks for a drum of many metres
    with pytest.raises(DesignError, match="looked for, radius 500 mm, limit: at most 0.05 deg"):
        drum(limits={"pressure_angle_deg": 0.05}).track  # noqa: B018
    with pytest.raises(DesignError, match="the bore reaches the track"):
        drum(geometry={"radius": 11.0}).track  # noqa: B018
    with pytest.raises(DesignError, match=r"the track takes 25\.2 mm of the drum's 20"):
        drum(geometry={"length": 20.0}).limits()
    with pytest.raises(DesignError, match="geometry.follower.offset is 40 mm"):
        drum(geometry={"radius": 32.0, "follower": {"offset": 40.0}}).track  # noqa: B018
    with pytest.raises(DesignError, match="thickness of the rib"):
        drum(geometry={"track": "rib", "distance": 5.0}).track  # noqa: B018
    # an arm of 40 on a pivot 10 mm beside the axis: 10 - 40 cos(7.5 deg) at both ends of the swing, 30 in its middle
    with pytest.raises(DesignError, match=r"the arm swings the roller's axis 30 mm beside") as past:
        drum(geometry={"radius": 36.0, "follower": {**ARM, "pivot": 10.0}}).track  # noqa: B018
    nearest = re.search(r"geometry.follower.pivot = ([\d.]+)", str(past.value))
    assert nearest is not None
    drum(geometry={"radius": 36.0, "follower": {**ARM, "pivot": float(nearest[1])}}).track  # noqa: B018
    with pytest.raises(DesignError, match=r"the wall is undercut: .* geometry.roller.radius"):
        drum(rise={"span_deg": 8.0}, geometry={"radius": 14.6}).track  # noqa: B018
    steep = drum(geometry={"radius": 25.0}).limits()
    assert [each.code for each in steep if not each.ok] == ["PRESSURE_ANGLE"]


def test_steps_of_a_drum_machine_give_a_height_to_what_lies_level_alone() -> None:
    """Carriage, pin and roller have their axis across the drum's; the second plate lies over the drum, turned over."""
    machine = read_mechanism(Path(__file__).parents[2] / "specs" / "gallery" / "drum-feeder.toml")
    table = order_of_assembly(machine.assembly)
    rows = [dict(zip(table.columns, row, strict=True)) for row in table.rows]
    across = {row["part"] for row in rows if row["lies"] == "on its side"}
    assert across == {"carriage", "roller-pin", "roller"}
    for row in rows:
        aside = ("on the table", "clean", "with the roller")
        low = row["part"] in across or str(row["where"]).startswith(aside)
        assert (row["underside at z, mm"] == "") == low
    below, *above = (row["underside at z, mm"] for row in rows if row["part"] == "end-plate")
    drum = [row for row in rows if row["part"] == "drum"][-1]
    assert below == 0 and set(above) == {above[0]} and above[0] > drum["underside at z, mm"]  # type: ignore[operator]
    block = next(row for row in rows if row["part"] == "carriage")
    assert block["where"] == "on the table, the bore for the pin upright"
    titles = [step.title for step in table.steps]
    begins = ("Lay the lower end plate", "Lower the upper end plate")
    ends = [title for title in titles if title.startswith(begins)]
    assert [title.startswith(begin) for title, begin in zip(ends, begins, strict=True)] == [
        True,
        True,
    ]
    assert titles[drum["step"] - 1].startswith("Lower the drum and the carriage at once")  # type: ignore[operator,index]
    (rods,) = (title for title in titles if "× rod" in title)
    assert rods.startswith(
        "Glue 4 × rod upright into the lower end plate, flush with its underside. The two farther from"
    )


@pytest.mark.parametrize(
    ("shape", "said"),
    [
        ({"bore_shape": "d-flat"}, "(no glue, the flat drives it)"),
        ({"bore_shape": "plain"}, "(glue in its bore)"),
        (
            {"bore_shape": "keyway", "key_width": 2.0, "key_depth": 1.0},
            "(no glue, the key drives it)",
        ),
    ],
)
def test_steps_of_a_drum_machine_say_where_the_shaft_stands_and_what_is_glued(
    shape: dict[str, object], said: str
) -> None:
    """Depths by the written parts: the lower bearing's underside over that of the shaft, and this over the table."""
    path = Path(__file__).parents[2] / "specs" / "gallery" / "drum-feeder.toml"
    changed = {f"parts.{key}": value for key, value in shape.items()}
    made = read_mechanism(path).replace(changed).assembly  # type: ignore[attr-defined]
    low = {name: min(m.z for m in made.mounts if m.part == name) for name in ("shaft", "bearing")}
    steps = order_of_assembly(made).steps
    titles = [step.title for step in steps]
    glued = [step.title for step in steps if any(mate.how == "glue" for mate in step.mates)]
    assert not [
        title for title in glued if "no glue" in title
    ]  # the picture says what the words say
    assert [title for title in glued if "glue spacer-below" in title.lower()]
    (shaft,) = (title for title in titles if "Stand the shaft upright" in title)
    # sheets of paper of 0.1 mm hold the shaft's lower end over the table
    assert (
        shaft.startswith(f"Lay five sheets of paper, {low['shaft']:g} mm in all, under")
        and low["shaft"] == 0.5
    )
    (drum,) = (title for title in titles if title.startswith("Lower the drum"))
    assert said in drum
    assert "Put spacer-above on the shaft, down on the drum, no glue." in titles
    (under,) = (title for title in titles if "spacer-below on the shaft, 0.1" in title)
    assert under.endswith("(one sheet of paper between, then pull it out).")
