"""The looper's checks are seen to fail: for each finding code a damaged file or a spec that trips exactly that code."""

from __future__ import annotations

import math
import shutil
from collections.abc import Callable
from pathlib import Path

import ezdxf
import numpy as np
import pytest
from judged import mechanism_of, wrong
from stl_rows import TRIANGLE, with_own_normals

from camgen.errors import FileError
from camgen.files.stl import write_stl
from camgen.findings import Finding
from camgen.parts.solids import solid
from camgen.pipeline import build as pipeline

SPEC = Path(__file__).resolve().parents[2] / "specs" / "chain-stitch-looper.toml"
KINDS = frozenset({"dxf", "stl"})
# Clear of its needles by 1.1 mm, so that no damage is found by the way that grazing turns into a strike.
SLIDING = (
    "name='x'",
    "geometry.plate_to_spreader=7",
    "geometry.velocity_ratio=0.9142857",
    "geometry.blade_length=34",
    "geometry.p6_setback=0",
    "limits.clearance=0",
)
SETTINGS = (*SLIDING, "geometry.p6_setback=1.5", "geometry.blade_length=36")


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A sound build, never changed."""
    out = tmp_path_factory.mktemp("sound")
    assert pipeline.build(SPEC, out, KINDS, SETTINGS).ok
    return out / "x"


@pytest.fixture
def folder(made: Path, tmp_path: Path) -> Path:
    return Path(shutil.copytree(made, tmp_path / "x"))


def failing(folder: Path, *kinds: str) -> set[tuple[str, str]]:
    """(code, file or pair) of the findings that fail."""
    return {(f.code, str(f.where).split(":")[0]) for f in wrong(folder, *kinds)}


def told(*settings: str) -> list[Finding]:
    """What is told of a spec with these settings before a file is written."""
    return pipeline.read_mechanism(SPEC, (*SLIDING, *settings)).resolved().limits()


def edit(path: Path, change: Callable[[np.ndarray], np.ndarray]) -> None:
    """Change the corners, (n, 3, 3) mm, of an STL file."""
    data = path.read_bytes()
    triangles = np.frombuffer(data[84:], TRIANGLE).copy()
    triangles["corners"] = change(triangles["corners"].astype(float))
    path.write_bytes(data[:84] + with_own_normals(triangles).tobytes())


def near(c: np.ndarray, axis: int, value: float) -> np.ndarray:
    return np.asarray(np.abs(c[..., axis] - value) < 2e-3)


@pytest.mark.long
def test_a_sound_build_passes(folder: Path) -> None:
    assert failing(folder, "dxf", "stl") == set()


# ---- files -----------------------------------------------------------------------------------------------------------

SPREADERS = ("lower-spreader", "upper-spreader")


@pytest.mark.long
@pytest.mark.parametrize("name, by", [("lower-spreader", -0.05), ("upper-spreader", 0.05)])
def test_a_nose_of_another_length_is_found(name: str, by: float, folder: Path) -> None:
    """Only what is before the seat is stretched: no needle is near it."""

    def longer(c: np.ndarray) -> np.ndarray:
        u = np.abs(c[..., 0])
        c[..., 0] = np.where(u < 2, np.sign(c[..., 0] + 1e-9) * (u - by * (1 - u / 2)), c[..., 0])
        return c

    edit(folder / f"x-{name}.stl", longer)
    assert failing(folder, "stl") == {("ROUND_TRIP", f"x-{name}.stl")}


@pytest.mark.long
@pytest.mark.parametrize("by", [-0.02, 0.02])
def test_a_nose_nearer_to_the_needles_is_found(by: float, folder: Path) -> None:
    """The flat wall of the nose, moved across: no upright section half way up shows it."""
    height = _middle(folder)

    def moved(c: np.ndarray) -> np.ndarray:
        c[near(c, 2, height), 2] += by
        return c

    edit(folder / "x-upper-spreader.stl", moved)
    assert ("ROUND_TRIP", "x-upper-spreader.stl") in failing(folder, "stl")


def _middle(folder: Path) -> float:
    """Height of the nose's flat wall in the part's frame, mm."""
    mechanism = mechanism_of(folder)
    return float(mechanism.bodies.upper.layers[0].z1)  # type: ignore[attr-defined]


@pytest.mark.long
def test_sharp_edges_instead_of_round_ones_are_found(folder: Path) -> None:
    sharp = pipeline.read_mechanism(SPEC, (*SETTINGS, "parts.edge_radius=0.05")).resolved()
    part = next(part for part in sharp.assembly.parts if part.name == "upper-spreader")
    write_stl(
        folder / "x-upper-spreader.stl", solid(part, sharp.accuracy.chord_tolerance), part.name
    )
    assert failing(folder, "stl") == {("ROUND_TRIP", "x-upper-spreader.stl")}


@pytest.mark.long
def test_twins_swapped_are_found(folder: Path) -> None:
    one, two = (folder / f"x-{name}.stl" for name in SPREADERS)
    one.rename(folder / "kept"), two.rename(one), (folder / "kept").rename(two)
    assert {code for code, _ in failing(folder, "stl")} == {"ROUND_TRIP", "CLEARANCE"}


@pytest.mark.long
def test_a_hole_in_the_mesh_is_found(folder: Path) -> None:
    path = folder / "x-upper-spreader.stl"
    data = path.read_bytes()
    path.write_bytes(data[:80] + np.uint32(len(data[84:]) // 50 - 1).tobytes() + data[84:-50])
    codes = {code for code, where in failing(folder, "stl") if where == path.name}
    assert codes == {"WATERTIGHT"}


@pytest.mark.long
def test_a_thicker_shank_is_found_by_its_volume(folder: Path) -> None:
    def thicker(c: np.ndarray) -> np.ndarray:
        c[..., 2] = np.where(c[..., 2] > 5.5, c[..., 2] + 0.3, c[..., 2])
        return c

    edit(folder / "x-upper-spreader.stl", thicker)
    assert ("VOLUME", "x-upper-spreader.stl") in failing(folder, "stl")


@pytest.mark.long
def test_a_thin_wall_round_the_clamp_hole_is_found(folder: Path) -> None:
    mechanism = mechanism_of(folder)
    hole = complex(mechanism.bodies.upper.centres[0])  # type: ignore[attr-defined]

    def wider(c: np.ndarray) -> np.ndarray:
        place = c[..., 0] + 1j * c[..., 1] - hole
        rim = np.abs(np.abs(place) - 1.1) < 2e-3
        c[..., 0] = np.where(rim, hole.real + 1.5 * place.real, c[..., 0])
        c[..., 1] = np.where(rim, hole.imag + 1.5 * place.imag, c[..., 1])
        return c

    edit(folder / "x-upper-spreader.stl", wider)
    assert {
        ("MIN_WALL", "x-upper-spreader.stl"),
        ("ROUND_TRIP", "x-upper-spreader.stl"),
    } <= failing(folder, "stl")


@pytest.mark.long
@pytest.mark.parametrize(("by", "found"), [(1.48, False), (1.52, True)])
def test_a_front_that_reaches_a_needle_strikes(by: float, found: bool, folder: Path) -> None:
    """P6 stands 1.5 mm along the stroke behind the needle's way: moved by less it is a wrong part that still clears."""
    mechanism = mechanism_of(folder)
    l1, nose = mechanism.design.l1, mechanism.design.nose  # type: ignore[attr-defined]
    middle = _middle(folder)

    def forward(c: np.ndarray) -> np.ndarray:
        front = (l1 - 0.01 < c[..., 0]) & (c[..., 0] < nose + 0.01) & (c[..., 2] < middle + 1e-3)
        c[front, 0] -= by
        return c

    edit(folder / "x-upper-spreader.stl", forward)
    assert (("CLEARANCE", "N2/P2") in failing(folder, "stl")) is found


@pytest.mark.long
def test_a_drawing_out_of_shape_is_found(folder: Path) -> None:
    path = folder / "x-side-outline.dxf"
    drawing = ezdxf.readfile(path)
    (outline,) = drawing.modelspace().query('LWPOLYLINE[layer=="CUT"]')
    with outline.points("xyseb") as points:
        x, y, *rest = points[0]
        points[0] = (x + 0.05, y, *rest)
    drawing.saveas(path)
    assert failing(folder, "dxf") == {("ROUND_TRIP", "x-side-outline.dxf")}


@pytest.mark.long
def test_an_open_drawing_and_inches_are_found(folder: Path) -> None:
    for name, change in (("side-outline", "open"), ("top-outline", "inches")):
        path = folder / f"x-{name}.dxf"
        drawing = ezdxf.readfile(path)
        if change == "open":
            drawing.modelspace().query('LWPOLYLINE[layer=="CUT"]')[0].closed = False
        else:
            drawing.units = 1
        drawing.saveas(path)
    assert failing(folder, "dxf") == {
        ("DXF_CLOSED", "x-side-outline.dxf"),
        ("DXF_UNITS", "x-top-outline.dxf"),
    }


@pytest.mark.long
def test_a_file_that_breaks_off_is_told(folder: Path) -> None:
    path = folder / "x-needle-1.stl"
    path.write_bytes(path.read_bytes()[:-1000])
    with pytest.raises(FileError, match=path.name):
        wrong(folder, "stl")


# ---- specs -----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("settings", "codes"),
    [
        (("geometry.protrusion_deg=74",), {"ALLOWED_RANGE"}),
        (("parts.nose_width=0.79", "parts.edge_radius=0.2"), {"MIN_WALL"}),
        (("parts.side_gap=0",), {"SIDE_GAP"}),
        (("timing.needle_stroke=37.9",), {"FEED"}),
        (("timing.needle='cycloidal'",), {"LOOP"}),
        # what the ratio must keep fails together with the ratio's own range
        (("geometry.velocity_ratio=0.85",), {"VELOCITY_RATIO", "LOOP"}),
        (("geometry.blade_length=32.5",), {"VELOCITY_RATIO", "BLADE_LENGTH"}),
        (
            ("geometry.protrusion=1.5", "limits.loop_angle_deg=0.2"),
            {"VELOCITY_RATIO", "LOOP_ANGLE"},
        ),
    ],
)
def test_each_code_of_a_spec(settings: tuple[str, ...], codes: set[str]) -> None:
    assert {f.code for f in told(*settings) if not f.ok} == codes


def test_every_code_of_the_spec_is_among_them() -> None:
    assert {f.code for f in told()} == {
        "ALLOWED_RANGE",
        "MIN_WALL",
        "SIDE_GAP",
        "LOOP",
        "LOOP_ANGLE",
        "FEED",
        "BLADE_LENGTH",
        "VELOCITY_RATIO",
    }
    assert all(math.isfinite(f.measured) for f in told())


@pytest.mark.long
@pytest.mark.parametrize(
    ("settings", "codes"),
    [
        (
            ("limits.clearance=1", "parts.shank_length=300"),
            {"VELOCITY_RATIO", "CLEARANCE", "BED_FIT"},
        ),
        (
            (
                "geometry.velocity_ratio=0.8",
                "geometry.mode='published'",
                "geometry.blade_length=44",
            ),
            {"CLEARANCE"},
        ),
    ],
)
def test_each_code_of_its_files(settings: tuple[str, ...], codes: set[str], tmp_path: Path) -> None:
    report = pipeline.build(SPEC, tmp_path, frozenset({"stl"}), (*SLIDING, *settings))
    assert {f.code for f in report.findings if not f.ok} == codes
