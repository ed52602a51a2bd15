"""The disc-cam mechanism: published answers from exported files, every kind of follower, damaged files, bad specs."""

from __future__ import annotations

import math
import re
import shutil
import subprocess
import sys
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any

import ezdxf
import numpy as np
import pytest
import shapely
from judged import wrong

from camgen import reading
from camgen import spec as specs
from camgen.errors import CamgenError, DesignError, SpecError
from camgen.files.stl import read_stl
from camgen.findings import Finding
from camgen.geometry.arcs import fit_arcs
from camgen.geometry.distances import point_to_ring
from camgen.geometry.facets import facet_contour
from camgen.geometry.mesh import slice_mesh
from camgen.geometry.rings import Ring, Shape, bore_circle, fit_circle, shape_of
from camgen.judge.cams import outline_and_law
from camgen.judge.contact import RollingContact, contact
from camgen.judge.contact_tips import ArmTip, SlideTip
from camgen.machine.cams.profile import DiscCam
from camgen.machine.cams.sizing import least_base_radius
from camgen.machine.closed_form import slider_travel
from camgen.machine.features import CamOutline
from camgen.machines.disc_cam.mechanism import DiscCamDrive
from camgen.pipeline import build as pipeline
from camgen.report.page import to_html
from camgen.report.report import Report
from camgen.settings import override

SPEC = Path(__file__).resolve().parents[2] / "specs" / "disc-cam.toml"
INCH = 25.4
FILES = frozenset({"dxf", "stl"})
ROLLER = 'motion="oscillating",shape="roller",radius=5,pivot_distance=60,arm=50'
STEEP = "limits.pressure_angle_deg=45"


def built(out: Path, *settings: str, only: frozenset[str] = FILES) -> Any:
    return pipeline.build(SPEC, out, only, ["name='c'", *settings])


def failing(report: Any) -> set[tuple[str, str]]:
    return kinds_of(f for f in report.findings if not f.ok)


def kinds_of(findings: Iterable[Finding]) -> set[tuple[str, str]]:
    """Codes with the kind of file."""
    return {(f.code, str(f.where).split(",")[0].rsplit(".", 1)[-1]) for f in findings}


def mechanism(*settings: str, segments: list[dict[str, Any]] | None = None) -> DiscCamDrive:
    data = reading.read(SPEC)
    for setting in settings:
        data = override(data, setting)
    if segments is not None:
        data["segment"] = segments
    return specs.validate(DiscCamDrive, data)


def rise_and_return(law: str, lift: float) -> list[dict[str, Any]]:
    return [
        {"kind": "rise", "span_deg": 180.0, "lift": lift, "law": law},
        {"kind": "return", "span_deg": 180.0, "to": 0.0, "law": law},
    ]


def written(tmp_path: Path, made: DiscCamDrive) -> Any:
    """Build a mechanism that was made without a file."""
    path = tmp_path / "spec.toml"
    path.write_text(specs.dump(made))
    return pipeline.build(path, tmp_path / "out", FILES)


def from_stl(path: Path, bore: float) -> Shape:
    shape = shape_of(slice_mesh(read_stl(path), 2.0))
    return shape.moved(
        shift=-bore_circle(min(shape.holes, key=lambda h: abs(h.centroid)), bore).centre
    )


# ---- published answers -----------------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def sound(tmp_path_factory: pytest.TempPathFactory) -> Callable[[str], Any]:
    """Report and folder of a build of KINDS, made once and never changed."""
    made: dict[str, Any] = {}

    def build(kind: str) -> Any:
        if kind not in made:
            out = tmp_path_factory.mktemp("sound")
            made[kind] = built(out, *KINDS[kind]), out / "c"
        return made[kind]

    return build


@pytest.fixture(scope="module")
def norton(tmp_path_factory: pytest.TempPathFactory) -> Callable[[str], Any]:
    """Norton's cycloidal double dwell, sized, with a roller of 0.5 in or a flat face: mechanism, report, shape of its STL."""
    made: dict[str, Any] = {}

    def build(shape: str) -> Any:
        if shape not in made:
            data = reading.read(SPEC)
            roller = {"radius": 0.5 * INCH} if shape == "roller" else {}
            data["geometry"] = {"follower": {"motion": "translating", "shape": shape} | roller}
            data["segment"] = [
                {"kind": "dwell", "span_deg": 90.0},
                {"kind": "rise", "span_deg": 90.0, "lift": INCH, "law": "cycloidal"},
                {"kind": "dwell", "span_deg": 90.0},
                {"kind": "return", "span_deg": 90.0, "to": 0.0, "law": "cycloidal"},
            ]
            data["limits"]["least_radius"] = 0.0 if roller else 0.25 * INCH
            data["limits"]["pressure_angle_deg"] = 30.0
            out = tmp_path_factory.mktemp(shape)
            data["geometry"]["base_radius"] = least(specs.validate(DiscCamDrive, data))
            drive = specs.validate(DiscCamDrive, data)
            report = written(out, drive)
            made[shape] = (
                drive,
                report,
                from_stl(out / "out" / "disc-cam" / "disc-cam-cam.stl", 8.0),
            )
        return made[shape]

    return build


def least(made: DiscCamDrive) -> float:
    """The base radius that its limits ask for, mm, before it is rounded up."""
    return least_base_radius(made.cam, made.cam_limits, made._room)[0]


def on(made: DiscCamDrive, shape: Shape) -> RollingContact:
    """The follower on an outline."""
    outline = made.assembly.features[0]
    assert isinstance(outline, CamOutline)
    return outline_and_law(made.model, outline, made.assembly.mounts, [[shape]])[1].contact


@pytest.mark.parametrize("offset", [0.0, 7.0])
def test_the_flat_faced_harmonic_cam_comes_back_as_a_circle(tmp_path: Path, offset: float) -> None:
    """Uicker, Pennock, Shigley: 2 in, prime radius 1.5 in: a circle of 2.5 in, 1.0 in off centre; the face reaches 1 in."""
    made = mechanism(
        f"geometry.base_radius={1.5 * INCH}",
        f'geometry.follower={{motion="translating",shape="flat",offset={offset}}}',
        "parts.hub_height=0",
        "limits.continuous=2",
        segments=rise_and_return("simple-harmonic", 2 * INCH),
    )
    report = written(tmp_path, made)
    assert report.ok, failing(report)
    shape = from_stl(tmp_path / "out" / "disc-cam" / "disc-cam-cam.stl", 8.0)
    centre, radius, deviation = fit_circle(shape.outer.points)
    assert radius == pytest.approx(2.5 * INCH, abs=1e-5)
    assert abs(centre) == pytest.approx(1.0 * INCH, abs=1e-5)
    assert deviation < 1e-5  # vertices lie on the exact outline, to the float32 of the file
    places = offset - on(made, shape).touch(np.linspace(0, 7, 3000)).place
    chord = math.sqrt(
        8 * 2.5 * INCH * 0.001
    )  # a corner is touched until the next edge lies on the face
    assert np.max(places) == pytest.approx(INCH, abs=chord) and np.min(places) == pytest.approx(
        -INCH, abs=chord
    )
    assert report.numbers["face_width_needed_mm"] == pytest.approx(2 * INCH, abs=1e-9)
    assert report.numbers["curvature_radius_min_mm"] == pytest.approx(2.5 * INCH, rel=1e-9)


@pytest.mark.long
def test_nortons_roller_cam(norton: Callable[[str], Any]) -> None:
    """Prime radius 1.75094 in, base 1.25094 in, least pitch radius of curvature 1.39411 in; from the STL, too."""
    drive, report, shape = norton("roller")
    assert {code for code, _ in failing(report)} == set()
    numbers = report.numbers
    assert numbers["prime_radius_mm"] / INCH == pytest.approx(1.75094, abs=5e-6)
    assert numbers["base_radius_mm"] / INCH == pytest.approx(1.25094, abs=5e-6)
    assert numbers["pitch_curvature_radius_min_mm"] / INCH == pytest.approx(1.39411, abs=5e-6)
    rim = shape.outer.facetted(1e-4)
    assert np.min(np.abs(rim)) / INCH == pytest.approx(1.25094, abs=0.001 / INCH)
    assert numbers["pressure_angle_stl_deg"] == pytest.approx(
        30, abs=0.4
    )  # of facets, which lean by half their turn
    # the circle through neighbouring points of the file's rim, half a radian of turning long, is nowhere smaller
    theta = np.linspace(0, 2 * math.pi, 1441)
    s = INCH * 1.75094 + on(drive, shape).angle(theta)
    z = s * np.exp(-1j * theta)
    a, b, c = (np.roll(z[:-1], k) for k in (18, 0, -18))
    area = np.abs(np.imag(np.conj(b - a) * (c - a)))
    curvature = np.sort(
        2
        * area
        / np.abs(b - a)
        / np.abs(c - b)
        / np.abs(a - c)
        * np.sign(np.imag(np.conj(b - c) * (b - a)))
    )
    assert INCH * np.max(np.abs(curvature)) == pytest.approx(1 / 1.39411, rel=0.01)
    speeds = [numbers["peak_speed_mm_s"] / INCH, numbers["peak_acceleration_mm_s2"] / INCH]
    assert speeds == pytest.approx([8.000, 100.53], rel=1e-4)  # in/s, in/s^2 at one turn a second


@pytest.mark.long
def test_nortons_flat_faced_cam(norton: Callable[[str], Any]) -> None:
    """Base 1.89263 in for a least radius of curvature of 0.25 in, face width 2.54648 in (8/pi); from the STL, too."""
    drive, report, shape = norton("flat")
    assert {code for code, _ in failing(report)} == set()
    assert report.numbers["base_radius_mm"] / INCH == pytest.approx(1.89263, abs=5e-6)
    assert report.numbers["face_width_needed_mm"] / INCH == pytest.approx(2.54648, abs=5e-6)
    place = on(drive, shape).touch(np.linspace(0, 2 * math.pi, 7201)).place
    assert np.ptp(place) / INCH == pytest.approx(
        8 / math.pi, abs=0.03
    )  # to a facet of its 1 um chords on each side
    assert np.min(np.abs(shape.outer.points)) / INCH == pytest.approx(1.89263, abs=1e-5)


def test_an_off_centre_disc_from_an_stl_is_a_slider_crank(tmp_path: Path) -> None:
    """The harmonic flat-faced cam is a disc; an in-line roller on its STL moves as crank e, rod a + r."""
    made = mechanism(
        "geometry.base_radius=15",
        'geometry.follower={motion="translating",shape="flat"}',
        "parts.hub_height=0",
        segments=rise_and_return("simple-harmonic", 10.0),
    )
    written(tmp_path, made)
    shape = from_stl(tmp_path / "out" / "disc-cam" / "disc-cam-cam.stl", 8.0)
    theta = np.linspace(0, 2 * math.pi, 2000)
    way = 28 - contact(shape.outer, SlideTip(0j, 1j, 3.0, 1)).angle(theta)
    expected = slider_travel(
        theta - math.pi, 5.0, 23.0
    )  # the centre is opposite the slide at theta = 0
    assert np.max(np.abs(way - expected)) < 0.00105
    # on an arm: a four-bar of crank e, coupler a + r, rocker = arm, ground = distance of the pivot
    spoke = 5 * np.exp(1j * (theta - math.pi / 2)) - 60
    bearing = np.arccos((np.abs(spoke) ** 2 + 55**2 - 23**2) / (2 * 55 * np.abs(spoke)))
    wanted = np.unwrap(np.angle(spoke) + bearing)
    arm = complex(-55, -10) / abs(complex(-55, -10)) * 55
    angle = contact(shape.outer, ArmTip(60 + 0j, arm, 3.0, 1)).angle(theta) + np.angle(arm)
    assert np.max(
        np.abs((angle - wanted + math.pi) % math.tau - math.pi)
    ) < 0.00105 / 55 / math.cos(0.5)


def test_rolling_on_facets_converges_as_measured() -> None:
    """Displacement error falls as 1/N^2 (8.4, 2.1, 0.52 um at 180, 360, 720 vertices), velocity as 1/N, acceleration does not."""
    segments = [
        {"kind": "rise", "span_deg": 90.0, "lift": 10.0, "law": "cycloidal"},
        {"kind": "dwell", "span_deg": 90.0},
        {"kind": "return", "span_deg": 90.0, "to": 0.0, "law": "cycloidal"},
        {"kind": "dwell", "span_deg": 90.0},
    ]
    made = mechanism("geometry.base_radius=35", "geometry.follower.radius=10", segments=segments)
    theta = np.arange(72_000) * (2 * math.pi / 72_000) + 1e-5
    errors = []
    for count in (180, 360, 720):
        z = made.cam.profile(np.arange(count) * (2 * math.pi / count))[::-1]
        s = on(made, Shape(Ring(z, np.zeros(count)), ())).angle(theta)
        step = theta[1] - theta[0]
        speed, bend = np.diff(s) / step, np.diff(s, 2) / step**2
        errors.append(
            (
                np.max(np.abs(s - made.motion(theta))),
                np.max(np.abs(speed - made.motion(theta[1:] - step / 2, 1))),
                np.max(np.abs(bend - made.motion(theta[1:-1], 2))),
            )
        )
    (s1, v1, a1), (s2, v2, a2), (s3, v3, a3) = errors
    assert [1e3 * s for s in (s1, s2, s3)] == pytest.approx([8.4, 2.1, 0.52], rel=0.15)
    assert s1 / s2 == pytest.approx(4, rel=0.1) and s2 / s3 == pytest.approx(4, rel=0.1)
    assert v1 / v2 == pytest.approx(2, rel=0.15) and v2 / v3 == pytest.approx(2, rel=0.15)
    assert min(a2 / a1, a3 / a2) > 0.9


# ---- every follower --------------------------------------------------------------------------------------------------

KINDS = {
    "offset roller": ['geometry.follower={motion="translating",shape="roller",radius=5,offset=4}'],
    "knife": ['geometry.follower={motion="translating",shape="knife",offset=-3}'],
    "flat": [
        'geometry.follower={motion="translating",shape="flat",offset=3,face_width=40}',
        "limits.least_radius=1",
    ],
    "swinging roller": [f"geometry.follower={{{ROLLER}}}", STEEP],
    "swinging knife": [
        'geometry.follower={motion="oscillating",shape="knife",pivot_distance=60,arm=50}',
        STEEP,
    ],
    "swinging flat": [
        'geometry.follower={motion="oscillating",shape="flat",pivot_distance=80,face_offset=4,face_width=60}',
        "limits.least_radius=0.1",
        STEEP,
    ],
    "pair": ['geometry.closure="conjugate"'],
    "flat pair": [
        'geometry.closure="conjugate"',
        'geometry.follower={motion="translating",shape="flat"}',
        "limits.least_radius=1",
    ],
    "swinging pair": ['geometry.closure="conjugate"', f"geometry.follower={{{ROLLER}}}", STEEP],
    "swinging flat pair": [
        'geometry.closure="conjugate"',
        "limits.least_radius=0.1",
        STEEP,
        'geometry.follower={motion="oscillating",shape="flat",pivot_distance=80}',
    ],
    "groove": ['geometry.closure="groove"', "parts.hub_height=0"],
    "swinging groove": [
        'geometry.closure="groove"',
        "parts.hub_height=0",
        "geometry.follower={motion='oscillating',shape='roller',radius=5,pivot_distance=90,arm=70}",
        STEEP,
    ],
    "keyway": ["parts.shaft='keyway'"],
}


@pytest.mark.long
@pytest.mark.parametrize("kind", KINDS)
def test_every_follower_is_proved_from_its_files(sound: Callable[[str], Any], kind: str) -> None:
    report, folder = sound(kind)
    assert report.ok, failing(report)
    walls = {"pair": 2, "groove": 2}.get(kind.split()[-1], 1)
    motions = [f for f in report.findings if f.code == "MOTION_ERROR"]
    assert len(motions) == 2 * walls
    assert all(0 < f.measured <= f.limit < 0.005 for f in motions)
    pairs = [f for f in report.findings if f.code == "LASH"]
    assert len(pairs) == (2 if walls == 2 else 0)
    if (
        walls == 2
    ):  # a pair has none but its facets', a groove its clearance along the follower's way
        way = 1 / math.cos(math.radians(report.numbers["pressure_angle_deg"]))
        clearance = 0.2 if "groove" in kind else 0.0
        scale = math.degrees(1 / 70) if kind == "swinging groove" else 1.0
        assert all(
            scale * clearance <= f.measured <= scale * clearance * way + 0.005 for f in pairs
        )
    # what judges the files once more begins with the spec beside them
    assert (
        pipeline.read_mechanism(folder / "spec.toml")
        == mechanism("name='c'", *KINDS[kind]).resolved()
    )


@pytest.mark.parametrize(
    "kind",
    ["offset roller", "knife", "swinging flat", "flat pair", "swinging flat pair", "swinging pair"],
)
def test_the_nearest_side_by_arithmetic_is_that_of_the_outline(kind: str) -> None:
    for cam in mechanism(*KINDS[kind]).cams:
        rim = facet_contour(cam.outline, 1e-3)
        assert cam.nearest == pytest.approx(
            float(np.min(point_to_ring(np.zeros(1, complex), rim))), abs=1.1e-3
        )


@pytest.mark.long
def test_it_can_be_shown(tmp_path: Path) -> None:
    """The report's page, drawing and 3MF of two walls; acceleration and the coloured profile are among the plots."""
    report = built(tmp_path, *KINDS["groove"], only=frozenset(pipeline.KINDS))
    assert report.ok, failing(report)
    titles = {plot.title for plot in report.plots}
    assert {
        "Displacement",
        "Velocity",
        "Acceleration",
        "Jerk",
        "Pressure angle",
        "Profile, by pressure angle",
    } <= titles
    page = (tmp_path / "c" / "report.html").read_text("utf-8")
    assert "Radius of curvature" in page and "nan" not in page.split("<script")[0].lower().replace(
        "nanmax", ""
    )


@pytest.mark.parametrize(
    ("settings", "size", "standard"),
    [((), "3 m6 x 12", "ISO 2338"), (("parts.pin_diameter=3.3",), "3.3 rod x 12", "")],
)
def test_the_pins_of_a_groove_are_in_the_list_of_parts(
    settings: tuple[str, ...], size: str, standard: str
) -> None:
    """One for each pair of holes, no longer than both plates; of rod where ISO 2338 has none so thick."""
    given = ("parts.hub_height=0", "parts.thickness=8", "parts.back=4", *settings)
    assembly = mechanism('geometry.closure="groove"', *given).assembly
    (pins,) = (each for each in assembly.bought if each.name == "dowel pin")
    back = next(part for part in assembly.parts if part.name == "back")
    holes = back.layers[0].region.holes
    assert (pins.size, pins.standard, pins.count) == (size, standard, len(holes) - 1)


@pytest.mark.long
def test_a_groove_whose_inner_wall_is_undercut(tmp_path: Path) -> None:
    """The outer wall is not: there the roller has the clearance, and the undercut besides."""
    segments = [
        {"kind": "rise", "span_deg": 60.0, "lift": 12.0, "law": "modified-sine"},
        {"kind": "dwell", "span_deg": 1.0},
        {"kind": "return", "span_deg": 60.0, "to": 0.0, "law": "cycloidal"},
        {"kind": "dwell", "span_deg": 239.0},
    ]
    made = mechanism(
        "geometry.base_radius=14",
        "geometry.follower.radius=22",
        'geometry.closure="groove"',
        "parts.hub_height=0",
        "parts.bore=3",
        "parts.pin_diameter=1",
        "limits.pressure_angle_deg=80",
        "limits.undercut=1",
        "limits.lash=1",
        segments=segments,
    )
    report = written(tmp_path, made)
    assert {code for code, _ in failing(report)} <= {"CURVATURE", "MIN_WALL"}
    lost = max(cut.shortfall for cut in made.cam.undercuts)
    assert lost > 0.09 and len([f for f in report.findings if f.code == "MOTION_ERROR"]) == 4
    assert all(f.measured > 0.2 + lost / 2 for f in report.findings if f.code == "LASH")


# ---- every check is seen to fail -------------------------------------------------------------------------------------


@pytest.mark.long
@pytest.mark.parametrize(
    ("settings", "codes"),
    [
        (["limits.pressure_angle_deg=15"], {"PRESSURE_ANGLE"}),
        (["limits.least_radius=30"], {"CURVATURE"}),
        (['geometry.follower={motion="translating",shape="flat",face_width=10}'], {"FACE_WIDTH"}),
        (
            [
                "geometry.base_radius=8",
                "parts.hub_height=0",
                "parts.bore=4",
                "limits.least_radius=0",
                'geometry.follower={motion="translating",shape="flat"}',
            ],
            {"UNDERCUT", "CURVATURE"},
        ),
    ],
)
def test_a_design_beyond_its_limits(tmp_path: Path, settings: list[str], codes: set[str]) -> None:
    """The same codes from the design and, where a shape shows it, from the files."""
    assert {code for code, _ in failing(built(tmp_path, *settings))} == codes


def test_a_law_that_jumps_is_told() -> None:
    segments = [
        {"kind": "rise", "span_deg": 90.0, "lift": 5.0, "law": "simple-harmonic"},
        {"kind": "dwell", "span_deg": 90.0},
        {"kind": "return", "span_deg": 180.0, "to": 0.0, "law": "cycloidal"},
    ]
    (jump,) = [f for f in mechanism(segments=segments).limits() if f.code == "MOTION_JUMP"]
    assert not jump.ok and jump.measured == 2 and "acceleration at 0.000 deg" in jump.message
    (jump,) = [
        f
        for f in mechanism("limits.continuous=1", segments=segments).limits()
        if f.code == "MOTION_JUMP"
    ]
    assert jump.ok and jump.message == "no jump of displacement and velocity"
    free = mechanism("limits.continuous=-1", segments=segments)
    assert not [f for f in free.limits() if f.code == "MOTION_JUMP"], (
        "nothing is asked, so nothing holds"
    )
    assert any("limits.continuous = -1" in note for note in free.study().notes)


def sharp(kind: str, lift: float) -> DiscCamDrive:
    """A follower that goes up and down at even speed, with a corner at each end."""
    segments = [
        {"kind": "rise", "span_deg": 120.0, "lift": lift, "law": "uniform"},
        {"kind": "return", "span_deg": 240.0, "to": 0.0, "law": "uniform"},
    ]
    settings = [f"geometry.follower={{{ROLLER}}}"] if kind == "oscillating" else []
    return mechanism(*settings, "geometry.base_radius=30", segments=segments)


@pytest.mark.parametrize(
    "kind, lift, unit", [("translating", 8.0, "mm"), ("oscillating", 12.0, "deg")]
)
def test_a_jump_is_told_in_its_own_unit(kind: str, lift: float, unit: str) -> None:
    """Up by `lift` in 2 pi / 3 rad, down in twice that: the speed steps by lift / (2 pi / 3) * 3 / 2."""
    made = sharp(kind, lift)
    (jump,) = [f for f in made.limits() if f.code == "MOTION_JUMP"]
    step = lift / (2 * math.pi / 3) * 1.5
    assert (jump.measured, jump.limit, jump.unit) == (2, 0, "jumps")
    assert f"velocity at 120.000 deg by {-step:.4g} {unit}/rad;" in jump.message
    jerky = [{**s, "law": "simple-harmonic"} for s in made.model_dump(by_alias=True)["segment"]]
    (jump,) = [f for f in mechanism(segments=jerky).limits() if f.code == "MOTION_JUMP"]
    step = lift * 1.5**2 * 0.5 * 0.75  # pi^2 / 2 * lift * (1 / span^2) of both sides
    found = re.search(r"acceleration at 120.000 deg by ([0-9.]+) mm/rad\^2;", jump.message)
    assert found and float(found[1]) == pytest.approx(step, abs=0.006)


def test_acceleration_is_endless_where_the_speed_jumps() -> None:
    """No finite peak, in numbers as well as in the report's words."""
    numbers = sharp("translating", 8.0).study().numbers
    assert numbers["peak_acceleration_mm_s2"] == math.inf
    speed = 8.0 / (2 * math.pi / 3) * mechanism().motor.speed_rpm * math.tau / 60
    assert numbers["peak_speed_mm_s"] == pytest.approx(speed)
    text = to_html(Report("cam", "disc-cam", (), numbers))
    assert re.search(r"Peak acceleration</dt><dd>∞", text)


def test_an_accepted_undercut_fails_nowhere() -> None:
    """Its radius of curvature is below 0: limits.least_radius can say how far below."""
    settings = [
        "geometry.base_radius=8",
        "parts.hub_height=0",
        "parts.bore=4",
        "limits.undercut=5",
        'geometry.follower={motion="translating",shape="flat"}',
    ]
    refused = {f.code for f in mechanism(*settings, "limits.least_radius=0").limits() if not f.ok}
    assert refused == {"CURVATURE"}
    assert all(f.ok for f in mechanism(*settings, "limits.least_radius=-50").limits())


@pytest.mark.parametrize(("bound", "kept"), [(-2.0, -2.0), (0.0, 0.01), (3.0, 3.0)])
def test_the_base_radius_that_is_found_keeps_to_a_least_radius_of_any_sign(
    bound: float, kept: float
) -> None:
    """It is rounded up, never down. Of 0 a hair is kept, for a profile with a cusp has no tangent there."""
    settings = [
        'geometry={follower={motion="translating",shape="flat"}}',
        "limits.pressure_angle_deg=89",
        f"limits.least_radius={bound}",
        "parts.hub_height=0",
        "parts.bore=4",
    ]
    rounded = mechanism(*settings)
    exact = least(rounded)
    assert exact <= rounded.base_radius <= 1.025 * exact
    assert rounded.base_radius == pytest.approx(round(rounded.base_radius, 1), abs=1e-12)
    assert all(each.ok for each in rounded.limits() if each.code == "CURVATURE") or bound < 0
    made = mechanism(*settings, f"geometry.base_radius={exact}")
    (curvature,) = [f for f in made.limits() if f.code == "CURVATURE"]
    assert curvature.measured == pytest.approx(kept, abs=1e-6)
    assert ("the profile is undercut" in curvature.message) == (bound < 0)
    if bound >= 0:
        assert facet_contour(made.assembly.parts[0].region.outer, 1e-3).size > 100


def shrink_dxf(path: Path) -> None:
    drawing = ezdxf.readfile(path)
    rim = max(drawing.modelspace().query("LWPOLYLINE"), key=len)
    rim.set_points([(x * 0.9996, y * 0.9996, b) for x, y, b in rim.get_points("xyb")], format="xyb")
    drawing.saveas(path)


def shift_bore(path: Path) -> None:
    drawing = ezdxf.readfile(path)
    for circle in drawing.modelspace().query("CIRCLE"):
        if abs(circle.dxf.radius - 4) < 1e-6:
            circle.dxf.center = (0.03, 0.01)
    drawing.saveas(path)


@pytest.mark.long
@pytest.mark.parametrize("kind", ["offset roller", "flat", "swinging flat", "swinging roller"])
@pytest.mark.parametrize("damage", [shrink_dxf, shift_bore])
def test_a_damaged_drawing_moves_wrongly(
    sound: Callable[[str], Any], tmp_path: Path, kind: str, damage: Callable[[Path], None]
) -> None:
    shutil.copytree(sound(kind)[1], tmp_path / "c")
    damage(tmp_path / "c" / "c-cam.dxf")
    found = kinds_of(wrong(tmp_path / "c", "dxf"))
    assert {("MOTION_ERROR", "dxf")} <= found <= {("MOTION_ERROR", "dxf"), ("ROUND_TRIP", "dxf")}


def radially(made: DiscCamDrive) -> Any:
    """The roller taken off along the radius of the pitch curve instead of along its normal."""
    z = made.cam.pitch(np.linspace(0, 2 * math.pi, 7201)[:-1])
    return z * (1 - 5 / np.abs(z))


def offset_the_other_way(made: DiscCamDrive) -> Any:
    """The same law for a stem on the other side."""
    other = mechanism('geometry.follower={motion="translating",shape="roller",radius=5,offset=-4}')
    return other.cam.profile(np.linspace(0, 2 * math.pi, 7201)[:-1])


@pytest.mark.long
@pytest.mark.parametrize("drawn, least", [(radially, 0.1), (offset_the_other_way, 0.1)])
def test_errors_that_open_cam_makers_ship(
    sound: Callable[[str], Any], tmp_path: Path, drawn: Callable[[DiscCamDrive], Any], least: float
) -> None:
    """A rim with such an error is off by tenths of a millimetre, and told."""
    shutil.copytree(sound("offset roller")[1], tmp_path / "c")
    path = tmp_path / "c" / "c-cam.dxf"
    drawing = ezdxf.readfile(path)
    rim = max(drawing.modelspace().query("LWPOLYLINE"), key=len)
    points = drawn(mechanism(*KINDS["offset roller"]))[::-1]
    rim.set_points([(z.real, z.imag, 0) for z in points], format="xyb")
    drawing.saveas(path)
    (found,) = [f for f in wrong(tmp_path / "c", "dxf") if f.code == "MOTION_ERROR"]
    assert found.measured > least


def test_pressure_angle_and_undercut_by_other_routes() -> None:
    """Against finite differences of the curve; with an undercut the loss is the gap to the highest point of the profile."""
    made = mechanism(f"geometry.follower={{{ROLLER}}}")
    cam: DiscCam = made.cam
    theta = np.linspace(0.01, 6.2, 400)
    chord = cam.pitch(theta + 1e-6) - cam.pitch(theta - 1e-6)
    way = cam.follower.velocity(made.motion(theta), 0) * np.exp(-1j * theta)
    angle = np.pi / 2 - np.arccos(
        np.abs(np.real(chord * np.conj(way))) / np.abs(chord) / np.abs(way)
    )
    np.testing.assert_allclose(np.degrees(cam.pressure_angle(theta)), np.degrees(angle), atol=1e-5)


def test_where_the_pressure_angle_is_largest() -> None:
    """A slide through the shaft, simple harmonic: tan of the angle is s'/(base radius + roller + s), largest of a fine grid."""
    made = mechanism(
        "geometry.follower={motion='translating',shape='roller',radius=5}",
        "geometry.base_radius=25",
        "segment=[{kind='rise',span_deg=120,lift=12,law='simple-harmonic'},{kind='dwell',span_deg=90},"
        "{kind='return',span_deg=150,lift=12,law='simple-harmonic'}]",
    )
    (found,) = (each for each in made.limits() if each.code == "PRESSURE_ANGLE")
    turned = np.radians(np.linspace(0, 120, 240001))  # the rise is the steeper one
    lift = 6 * (1 - np.cos(1.5 * turned))
    tangent = 9 * np.sin(1.5 * turned) / (30 + lift)
    best = np.argmax(tangent)
    assert found.measured == pytest.approx(math.degrees(math.atan(tangent[best])), abs=1e-6)
    assert math.degrees(found.where.theta) == pytest.approx(math.degrees(turned[best]), abs=0.01)
    assert str(found.where).startswith("exact profile, cam angle ")


# ---- bad input -------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("settings", "path"),
    [
        (['geometry.follower={motion="translating",shape="roller"}'], "geometry.follower.radius"),
        (
            ['geometry.follower={motion="translating",shape="flat",radius=3}'],
            "geometry.follower.radius",
        ),
        (
            ['geometry.follower={motion="translating",shape="roller",radius=3,arm=40}'],
            "geometry.follower.arm",
        ),
        (
            ['geometry.follower={motion="translating",shape="roller",radius=3,face_width=4}'],
            "geometry.follower.face_width",
        ),
        (
            ['geometry.follower={motion="translating",shape="roller",radius=3,face_offset=4}'],
            "geometry.follower.face_offset",
        ),
        (
            ['geometry.follower={motion="oscillating",shape="roller",radius=3,arm=40}'],
            "geometry.follower.pivot_distance",
        ),
        (
            ['geometry.follower={motion="oscillating",shape="roller",radius=3,pivot_distance=40}'],
            "geometry.follower.arm",
        ),
        ([f"geometry.follower={{{ROLLER},offset=3}}"], "geometry.follower.offset"),
        (
            ['geometry.follower={motion="translating",shape="roller",radius=3,ofset=3}'],
            "geometry.follower.ofset",
        ),
        (
            [
                'geometry.closure="groove"',
                "parts.hub_height=0",
                'geometry.follower={motion="translating",shape="flat"}',
            ],
            "geometry.closure",
        ),
        (['geometry.closure="groove"'], "parts.hub_height"),
        (["parts.hub_diameter=7"], "parts.hub_diameter"),
        (["parts.hub_diameter=8.001"], "parts.hub_diameter"),
        (["parts.thickness=0.001"], "parts.thickness"),
        (["parts.hub_height=1e6"], "parts.hub_height"),
        (["parts.shaft='keyway'", "parts.key_width=9"], "parts.key_width"),
        (["parts.shaft='keyway'", "parts.bore=250", "parts.hub_diameter=400"], "parts.bore"),
        (["parts.shaft='d-flat'", "parts.flat_depth=9"], "parts.flat_depth"),
        (["parts.pin_diameter=9"], "parts.pin_diameter"),
        (["limits.min_wall=0.1"], "limits.min_wall"),
        (["segment=[]"], "segment"),
    ],
)
def test_bad_keys_are_told_by_their_path(settings: list[str], path: str) -> None:
    with pytest.raises(SpecError) as caught:
        mechanism(*settings)
    assert path in {fault.key for fault in caught.value.faults}


@pytest.mark.parametrize(
    "settings, width, depth",
    [
        (["parts.bore=12"], 4.0, 1.8),
        (["parts.bore=20"], 6.0, 2.8),
        (["parts.bore=20", "parts.key_width=5"], 5.0, 2.8),
        (["parts.bore=50", "parts.hub_diameter=90"], 14.0, 3.8),
    ],
)
def test_a_keyway_is_that_of_din_6885_for_its_bore(
    settings: list[str], width: float, depth: float
) -> None:
    """Rows of the standard as in tests/reference; what the spec says counts first, and the resolved spec tells both."""
    made = mechanism("parts.bore_shape='keyway'", "parts.hub_diameter=40", *settings)
    parts = made.resolved().model_dump(by_alias=True)["parts"]
    assert (parts["key_width"], parts["key_depth"]) == (width, depth)


def test_a_bore_beyond_the_table_is_told_its_range_and_the_keys() -> None:
    """The rows of tests/reference end at a bore of 230 mm."""
    with pytest.raises(SpecError) as caught:
        mechanism("parts.bore_shape='keyway'", "parts.hub_diameter=600", "parts.bore=250")
    said = "6 to 230 mm", "DIN 6885", "parts.key_width", "parts.key_depth"
    assert all(each in str(caught.value) for each in said)


def test_a_hub_that_leaves_the_cam_is_told_by_how_much() -> None:
    """A base circle of 5 mm under a hub of 16 mm: 3 mm more are needed."""
    error = mechanism("geometry.base_radius=5", "parts.hub_diameter=16", "parts.hub_height=6")
    with pytest.raises(DesignError, match="reaches 8 mm from the axis.* 3 mm larger"):
        _ = error.assembly


@pytest.mark.parametrize(
    ("segments", "path", "word"),
    [
        (
            [
                {"kind": "rise", "span_deg": 100.0, "lift": 5.0, "law": "cubic"},
                {"kind": "return", "span_deg": 200.0, "to": 0.0, "law": "cubic"},
            ],
            "segment",
            "360",
        ),
        (
            [{"kind": "rise", "span_deg": 360.0, "lift": 5.0, "law": "cubic"}],
            "segment.0",
            "ends at 0",
        ),
        ([{"kind": "dwell", "span_deg": 360.0}], "segment", "rise"),
        (
            [
                {"kind": "rise", "span_deg": 180.0, "lift": 5.0, "law": "cycloid"},
                {"kind": "return", "span_deg": 180.0, "to": 0.0, "law": "cubic"},
            ],
            "segment.0.law",
            "cycloidal",
        ),
        (
            [
                {
                    "kind": "rise",
                    "span_deg": 180.0,
                    "lift": 5.0,
                    "law": {
                        "name": "table",
                        "points": [[0.0, 0.0], [1.0, 2.0], [2.0, 1.0], [3.0, 3.0], [4.0, 4.0]],
                    },
                },
                {"kind": "return", "span_deg": 180.0, "to": 0.0, "law": "cubic"},
            ],
            "segment.0.law.points.2",
            "rises",
        ),
    ],
)
def test_bad_segments_are_told_by_their_path(
    segments: list[dict[str, Any]], path: str, word: str
) -> None:
    with pytest.raises(SpecError) as caught:
        mechanism(segments=segments)
    assert any(fault.key == path and word in str(fault) for fault in caught.value.faults), str(
        caught.value
    )


@pytest.mark.parametrize(
    "settings",
    [
        ['geometry.follower={motion="translating",shape="roller",radius=5,offset=31}'],
        ["geometry.base_radius=3"],
        ["parts.hub_diameter=60"],
        ["parts.bore=60", "parts.hub_height=0"],
        ["geometry.base_radius=120", f"geometry.follower={{{ROLLER}}}"],
        [
            "geometry.base_radius=81",
            'geometry.follower={motion="oscillating",shape="flat",pivot_distance=80}',
        ],
        [
            "geometry.closure='groove'",
            "parts.hub_height=0",
            "geometry.base_radius=9",
            "parts.bore=8",
        ],
    ],
)
def test_designs_that_do_not_exist(tmp_path: Path, settings: list[str]) -> None:
    with pytest.raises(DesignError) as caught:
        built(tmp_path, *settings)
    assert caught.value.quantity and caught.value.remedy
    assert not (tmp_path / "c").exists()


def test_a_law_from_a_file(tmp_path: Path) -> None:
    """A table beside the spec; the resolved spec holds its points and needs no other file."""
    u = np.linspace(0, 1, 41)
    rows = [f"{90 * x},{4 * (x - np.sin(2 * np.pi * x) / (2 * np.pi))}" for x in u]
    (tmp_path / "rise.csv").write_text("\n".join(["deg,mm", *rows]))
    text = SPEC.read_text("utf-8").replace(
        'law = "modified-sine" ', 'law = { name = "table", file = "rise.csv" } '
    )
    (tmp_path / "t.toml").write_text(text)
    report = pipeline.build(tmp_path / "t.toml", tmp_path / "out", frozenset({"dxf"}))
    assert not [f for f in report.findings if not f.ok and f.code != "MOTION_JUMP"]
    (tmp_path / "rise.csv").unlink()
    assert pipeline.check(tmp_path / "out" / "disc-cam").numbers == report.numbers
    with pytest.raises(CamgenError, match=r"rise\.csv"):
        pipeline.build(tmp_path / "t.toml", tmp_path / "out", frozenset({"dxf"}))


def test_a_cam_that_reaches_the_followers_axle() -> None:
    arm = "geometry.follower={{motion='oscillating', shape='roller', radius=5, pivot_distance={}, arm=40}}"
    made = [mechanism(arm.format(far), "geometry.base_radius=40") for far in (45, 70)]
    reach = [{f.code: f for f in each.limits()}["INTERFERENCE"] for each in made]
    assert [f.ok for f in reach] == [False, True]


# ---- tables of many points -------------------------------------------------------------------------------------------


def table_of(count: int, steps: int = 1) -> list[dict[str, Any]]:
    """A rise of 10 mm in cycloidal steps as a table; a return by the law itself."""
    u = np.linspace(0, 1, count)
    s = 10 * (u - np.sin(math.tau * steps * u) / (math.tau * steps))
    points = [[float(a), float(b)] for a, b in zip(120 * u, s, strict=True)]
    return [
        {
            "kind": "rise",
            "span_deg": 120.0,
            "lift": 10.0,
            "law": {"name": "table", "points": points},
        },
        {"kind": "return", "span_deg": 240.0, "to": 0.0, "law": "cycloidal"},
    ]


@pytest.mark.long
def test_a_table_of_2000_points_costs_about_what_a_law_does(tmp_path: Path) -> None:
    """Processor time and memory of builds in processes of their own; work that grew with the square of the points would take
    hundreds of times as long."""
    code = (
        "import resource, sys, time\nfrom pathlib import Path\nfrom camgen.pipeline import build as pipeline\n"
        "report = pipeline.build(Path(sys.argv[1]) / 'spec.toml', Path(sys.argv[1]), frozenset(['dxf']))\n"
        "peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss\n"  # counts the parent's as well, where it was forked off
        "own = Path('/proc/self/status')\n"
        "peak = int(own.read_text().split('VmHWM:')[1].split()[0]) if own.exists() else peak\n"
        "print(report.ok, time.process_time(), peak)"
    )
    seconds = {}
    for name, segments in (("law", None), ("table", table_of(2000))):
        folder = tmp_path / name
        folder.mkdir()
        spec = mechanism() if segments is None else mechanism(segments=segments)
        (folder / "spec.toml").write_text(specs.dump(spec))
        done = subprocess.run(
            [sys.executable, "-c", code, str(folder)], capture_output=True, text=True, check=True
        )
        ok, seconds[name], kilobytes = done.stdout.split()
        assert ok == "True" and float(kilobytes) < 300_000
    assert float(seconds["table"]) < 4 * float(seconds["law"])


@pytest.mark.long
@pytest.mark.parametrize("count", [5, 61, 400])
def test_outline_of_a_table_is_the_envelope_through_all_its_knots(count: int) -> None:
    """Facets and arcs keep to their tolerance from the profile, which is computed point by point."""
    for steps in (1, 3) if count > 60 else (1,):
        cam = mechanism("geometry.base_radius=30", segments=table_of(count, steps)).cam
        z = cam.profile(np.linspace(0, math.tau, 20_001))
        assert cam.undercuts == () and len(cam.outline.pieces) == 2
        for ring in (
            facet_contour(cam.outline, 1e-3),
            facet_contour(fit_arcs(cam.outline, 1e-3), 1e-6),
        ):
            ends = np.column_stack([ring, np.roll(ring, -1)])
            edges = shapely.linestrings(np.stack([ends.real, ends.imag], -1))
            points = shapely.points(z.real, z.imag)
            off = shapely.distance(points, edges[shapely.STRtree(edges).nearest(points)])
            assert np.max(off) < 1e-3 + 2e-6
        length = np.sum(np.abs(np.diff(cam.profile(np.linspace(0, math.tau, 400_001)))))
        assert cam.outline.length == pytest.approx(length, rel=1e-8)


def test_undercuts_between_the_knots_of_a_table_are_all_found() -> None:
    """A face cannot follow steps: as many places are cut away as where room for it, by the formula, is missing."""
    flat = 'geometry.follower={motion="translating",shape="flat"}'
    cam = mechanism(flat, "geometry.base_radius=30", segments=table_of(400, 5)).cam
    theta = np.linspace(0, math.tau, 200_001)
    room = 30 + cam.program(theta) + cam.program(theta, 2)
    missing = np.flatnonzero(np.diff(np.sign(room)) < 0).size
    assert missing >= 3 and len(cam.undercuts) == missing
    middles = [(cut.begin + cut.end) / 2 for cut in cam.undercuts]
    inside = [np.any(room[(theta > cut.begin) & (theta < cut.end)] < 0) for cut in cam.undercuts]
    assert all(inside) and middles == sorted(middles)


def test_a_base_radius_that_is_too_small_may_be_left_out_as_its_advice_says() -> None:
    """The advice has been tried: with the radius that is found pressure angle and curvature hold."""
    small = mechanism("geometry.base_radius=10", "segment.0.span_deg=60").limits()
    failing = [each for each in small if not each.ok]
    assert {each.code for each in failing} == {"PRESSURE_ANGLE", "CURVATURE"}
    said = "a larger base_radius (where it is left out, camgen takes the smallest that holds)"
    assert all(said in each.message.lower() for each in failing)
    found = mechanism("geometry.base_radius=", "segment.0.span_deg=60").limits()
    assert all(each.ok for each in found)
