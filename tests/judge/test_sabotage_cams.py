"""Disc and indexing cams: each finding is seen to fail, alone, on damaged files or on a spec that its files do not keep to."""

from __future__ import annotations

import re
import shutil
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import ezdxf
import numpy as np
import pytest
from judged import mechanism_of, wrong

from camgen.files.dxf import read_dxf
from camgen.findings import Where
from camgen.geometry.rings import shape_of
from camgen.judge.cams import judged_angles
from camgen.judge.joints import Nominal
from camgen.judge.measured import Files
from camgen.judge.motion import judge_machine
from camgen.machine.features import CamOutline, Eye
from camgen.pipeline import build as pipeline

SPECS = Path(__file__).resolve().parents[2] / "specs"
TRIANGLE = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
BUILDS = {
    "roller": ("disc-cam", []),
    "groove": ("disc-cam", ['geometry.closure="groove"', "parts.hub_height=0"]),
    "flat": (
        "disc-cam",
        [
            'geometry.follower={motion="translating",shape="flat",face_width=40}',
            "limits.least_radius=1",
        ],
    ),
    "undercut": (
        "disc-cam",
        [
            "geometry.base_radius=8",
            "parts.hub_height=0",
            "parts.bore=4",
            "limits.least_radius=0",
            'geometry.follower={motion="translating",shape="flat"}',
            "limits.undercut=3",
        ],
    ),
    "undercut pair": (
        "disc-cam",
        [
            "geometry.base_radius=8",
            "parts.hub_height=0",
            "parts.bore=4",
            "limits.undercut=3",
            'geometry.follower={motion="translating",shape="flat"}',
            'geometry.closure="conjugate"',
        ],
    ),
    "pair": ("disc-cam", ['geometry.closure="conjugate"', "parts.hub_height=0"]),
    "indexing": ("indexing-cam", []),
}


@pytest.fixture(scope="module")
def sound(tmp_path_factory: pytest.TempPathFactory) -> Callable[[str], Path]:
    """The folder of a build, made once and never changed."""
    made: dict[str, Path] = {}

    def folder(kind: str) -> Path:
        if kind not in made:
            spec, settings = BUILDS[kind]
            out = tmp_path_factory.mktemp(kind)
            pipeline.build(
                SPECS / f"{spec}.toml", out, frozenset({"dxf", "stl"}), ["name='c'", *settings]
            )
            made[kind] = out / "c"
        return made[kind]

    return folder


Copy = Callable[[str], Path]


@pytest.fixture
def copy(sound: Copy, tmp_path: Path) -> Copy:
    """A copy of a build to be damaged."""
    return lambda kind: Path(shutil.copytree(sound(kind), tmp_path / "c"))


def failing(folder: Path, *kinds: str) -> set[tuple[str, str]]:
    """Codes that fail, with what they fail on: a file's name, or the design."""
    found = wrong(folder, *kinds)
    return {
        (
            f.code,
            str(f.where).split(",")[0].removeprefix("c-")
            if str(f.where).startswith("c-")
            else "design",
        )
        for f in found
    }


@pytest.mark.long
@pytest.mark.parametrize("kind", BUILDS)
def test_sound_builds_pass(sound: Copy, kind: str) -> None:
    """In a pair each cam is judged against what it gives by itself: where one is undercut the other is not."""
    assert {code for code, _ in failing(sound(kind))} == (
        {"CURVATURE"} if "undercut" in kind else set()
    )


# ---- files -----------------------------------------------------------------------------------------------------------


def largest(drawing: ezdxf.document.Drawing):  # type: ignore[no-untyped-def]
    return max(drawing.modelspace().query("LWPOLYLINE"), key=len)


def shrink(drawing: ezdxf.document.Drawing) -> None:
    line = largest(drawing)
    line.set_points(
        [(x * 0.9997, y * 0.9997, b) for x, y, b in line.get_points("xyb")], format="xyb"
    )


def slit(drawing: ezdxf.document.Drawing) -> None:
    """A cut from the rim inwards and back, which no follower feels."""
    line = largest(drawing)
    rows = line.get_points("xyb")
    x, y, _ = rows[5]
    line.set_points([*rows[:5], (x, y, 0), (0.9 * x, 0.9 * y, 0), *rows[5:]], format="xyb")


def unpin(drawing: ezdxf.document.Drawing) -> None:
    drawing.modelspace().delete_entity(
        next(c for c in drawing.modelspace().query("CIRCLE") if abs(c.dxf.center) > 1)
    )


def inches(drawing: ezdxf.document.Drawing) -> None:
    drawing.units = ezdxf.units.IN


def opened(drawing: ezdxf.document.Drawing) -> None:
    largest(drawing).closed = False


def shifted_bore(drawing: ezdxf.document.Drawing) -> None:
    bore = min(drawing.modelspace().query("CIRCLE"), key=lambda c: abs(c.dxf.center))
    bore.dxf.center = (0.02, 0.01)


@pytest.mark.long
@pytest.mark.parametrize(
    ("kind", "part", "edit", "code"),
    [
        ("roller", "cam", shrink, "MOTION_ERROR"),
        ("roller", "cam", shifted_bore, "MOTION_ERROR"),
        ("groove", "inner", shrink, "MOTION_ERROR"),
        ("groove", "outer", shrink, "MOTION_ERROR"),
        ("flat", "cam", shrink, "MOTION_ERROR"),
        ("pair", "cam-1", shrink, "MOTION_ERROR"),
        ("pair", "cam-2", shrink, "MOTION_ERROR"),
        ("pair", "cam-2", shifted_bore, "MOTION_ERROR"),
        ("indexing", "cam", shrink, "MOTION_ERROR"),
        ("indexing", "return-cam", shrink, "MOTION_ERROR"),
        ("groove", "inner", unpin, "ROUND_TRIP"),
        ("groove", "back", unpin, "ROUND_TRIP"),
        ("groove", "outer", unpin, "ROUND_TRIP"),
        ("groove", "outer", inches, "DXF_UNITS"),
        ("groove", "outer", opened, "DXF_CLOSED"),
        ("indexing", "return-cam", opened, "DXF_CLOSED"),
        ("indexing", "cam", inches, "DXF_UNITS"),
    ],
)
def test_a_drawing(
    copy: Copy, kind: str, part: str, edit: Callable[[ezdxf.document.Drawing], None], code: str
) -> None:
    folder = copy(kind)
    path = folder / f"c-{part}.dxf"
    drawing = ezdxf.readfile(path)
    edit(drawing)
    drawing.saveas(path)
    found = failing(folder, "dxf")
    assert (code, f"{part}.dxf") in found
    # a contour that is off is told by the comparison of contours as well
    assert {(c, where) for c, where in found if c != "ROUND_TRIP"} <= {(code, f"{part}.dxf")}
    assert all(where == f"{part}.dxf" for _, where in found)


@pytest.mark.long
@pytest.mark.parametrize("kind, part", [("groove", "inner"), ("indexing", "cam")])
def test_a_slit(copy: Copy, kind: str, part: str) -> None:
    folder = copy(kind)
    drawing = ezdxf.readfile(folder / f"c-{part}.dxf")
    slit(drawing)
    drawing.saveas(folder / f"c-{part}.dxf")
    assert ("MIN_WALL", f"{part}.dxf") in failing(folder, "dxf")


@pytest.mark.long
@pytest.mark.parametrize(
    "kind, part", [("groove", "outer"), ("flat", "cam"), ("indexing", "return-cam")]
)
@pytest.mark.parametrize("damage, code", [("lose", "WATERTIGHT"), ("thicken", "VOLUME")])
def test_a_solid(copy: Copy, kind: str, part: str, damage: str, code: str) -> None:
    folder = copy(kind)
    path = folder / f"c-{part}.stl"
    data = path.read_bytes()
    triangles = np.frombuffer(data[84:], TRIANGLE).copy()
    if damage == "lose":
        triangles = triangles[1:]
    else:
        triangles["corners"][..., 2] *= 1.01
    path.write_bytes(data[:80] + np.uint32(len(triangles)).tobytes() + triangles.tobytes())
    found = failing(folder, "stl")
    assert (code, f"{part}.stl") in found and all(where == f"{part}.stl" for _, where in found)


# ---- a spec that the files do not keep to ----------------------------------------------------------------------------


@pytest.mark.long
@pytest.mark.parametrize(
    ("kind", "key", "value", "code", "files"),
    [
        (
            "groove",
            "lash",
            0.1,
            "LASH",
            {"inner.dxf with c-outer.dxf", "inner.stl with c-outer.stl"},
        ),
        (
            "indexing",
            "lash_deg",
            0.0005,
            "LASH",
            {"cam.dxf with c-return-cam.dxf", "cam.stl with c-return-cam.stl"},
        ),
        ("roller", "speed_ripple", 0.0005, "SPEED_RIPPLE", {"cam.dxf", "cam.stl"}),
        (
            "indexing",
            "speed_ripple",
            0.00005,
            "SPEED_RIPPLE",
            {"cam.dxf", "cam.stl", "return-cam.dxf", "return-cam.stl"},
        ),
        ("flat", "face_width", 12, "FACE_WIDTH", {"cam.dxf", "cam.stl", "design"}),
    ],
)
def test_limits(copy: Copy, kind: str, key: str, value: object, code: str, files: set[str]) -> None:
    folder = copy(kind)
    limit(folder, key, value)
    assert failing(folder) == {(code, file) for file in files}


@pytest.mark.long
@pytest.mark.parametrize(
    ("kind", "limits"),
    [
        (
            "roller",
            {
                "pressure_angle_deg": (15, "PRESSURE_ANGLE"),
                "least_radius": (30, "CURVATURE"),
                "continuous": (3, "MOTION_JUMP"),
                "bed": ([50, 50], "BED_FIT"),
            },
        ),
        (
            "indexing",
            {
                "pressure_angle_deg": (15, "PRESSURE_ANGLE"),
                "residual": (0.001, "RESIDUAL_TORQUE"),
                "acceleration_jump": (1, "JOINT_JUMP"),
                "dwell_torque_n_m": (1e3, "FORCE_CLOSURE"),
            },
        ),
    ],
)
def test_limits_of_the_design(copy: Copy, kind: str, limits: dict[str, tuple[object, str]]) -> None:
    folder = copy(kind)
    for key, (value, _) in limits.items():
        limit(folder, key, value)
    assert failing(folder) == {(code, "design") for _, code in limits.values()}


def limit(folder: Path, key: str, value: object) -> None:
    """Another limit in a folder's spec."""
    spec = folder / "spec.toml"
    text, count = re.subn(
        rf"(?ms)^{key} = (\[.*?^\]|[^\n]*)$", f"{key} = {value}", spec.read_text()
    )
    assert count == 1
    spec.write_text(text)


@pytest.mark.long
def test_an_undercut_in_the_file(copy: Copy) -> None:
    """The design's undercut, and what each file loses by it."""
    folder = copy("undercut")
    spec = folder / "spec.toml"
    spec.write_text(spec.read_text().replace("undercut = 3.0", "undercut = 0.01"))
    found = {(code, file) for code, file in failing(folder) if code != "CURVATURE"}
    assert found == {("UNDERCUT", "design"), ("UNDERCUT", "cam.dxf"), ("UNDERCUT", "cam.stl")}


# ---- pairs -----------------------------------------------------------------------------------------------------------


def between(
    folder: Path, parts: tuple[str, str], turned: float = 0.0, radius: float | None = None
) -> set[str]:
    """Failing codes of a follower between two drawings, the second mounted otherwise, or its tip, whose own motion is as before,
    of another radius, mm."""
    mechanism = mechanism_of(folder)
    files = {part: [[shape_of(read_dxf(folder / f"c-{part}.dxf").cut)]] for part in parts}
    first, second = (
        feature for feature in mechanism.assembly.features if isinstance(feature, CamOutline)
    )
    assert (first.part, second.part) == parts and isinstance(second.tip, Eye)
    if radius is not None:
        tip = replace(second.tip, diameter=2 * radius)
        second = replace(second, tip=tip, free=second.free + second.tip.diameter / 2 - radius)
    mounts = [
        replace(mount, angle=turned) if mount.part == parts[1] else mount
        for mount in mechanism.assembly.mounts
    ]
    found = judge_machine(
        Nominal(mechanism.model, (first, second), mounts, mechanism.assembly.demands),
        Files("dxf", Where(file="c-*.dxf", kind="dxf"), files),
        judged_angles(),
        0.001,
    )
    return {finding.code for finding in found.findings if not finding.ok}


@pytest.mark.long
@pytest.mark.parametrize(
    ("kind", "parts"),
    [
        ("groove", ("inner", "outer")),
        ("pair", ("cam-1", "cam-2")),
        ("indexing", ("cam", "return-cam")),
    ],
)
def test_two_parts_that_hold_one_follower(sound: Copy, kind: str, parts: tuple[str, str]) -> None:
    folder = sound(kind)
    assert between(folder, parts) == set()
    for turn in (
        2.0,
        -2.0,
    ):  # the second one's own motion is wrong, from which nothing more is judged
        assert between(folder, parts, turned=np.radians(turn)) == {"MOTION_ERROR"}
    if kind != "groove":
        assert between(folder, parts, radius=4.5) == {"LASH"}
        assert between(folder, parts, radius=10.05 if kind == "indexing" else 5.05) == {
            "INTERFERENCE"
        }


def test_a_cam_that_sweeps_over_the_axle() -> None:
    """An arm as long as the distance of its axle, which swings far out."""
    settings = [
        "geometry.follower={arm=60,pivot_distance=60,roller_radius=5}",
        "geometry.base_radius=20",
        "geometry.gear_ratio=2.4",
        "geometry.closure='force'",
        "parts.bore=8",
        "parts.key_width=2",
    ]
    wrong = [
        f
        for f in pipeline.read_mechanism(SPECS / "indexing-cam.toml", settings).limits()
        if not f.ok
    ]
    (hit,) = [f for f in wrong if f.code == "INTERFERENCE"]
    assert hit.measured < 0 and "60 mm" in hit.message
