"""A linkage from its files: the sound build moves as asked, each damage trips its finding, and a cam tells the same."""

from __future__ import annotations

import cmath
import json
import math
import shutil
from collections.abc import Callable
from pathlib import Path

import ezdxf
import numpy as np
import pytest
from judged import judged, wrong
from stl_rows import TRIANGLE, with_own_normals

from camgen.files.stl import read_stl, write_stl
from camgen.geometry.mesh import slice_mesh
from camgen.geometry.rings import bore_circle, shape_of
from camgen.judge.contact import contact
from camgen.judge.contact_tips import ArmTip
from camgen.parts.solids import solid
from camgen.pipeline import build as pipeline

SPEC = Path(__file__).resolve().parents[2] / "specs" / "eccentric-drive.toml"
Change = Callable[[np.ndarray, np.ndarray], np.ndarray]


@pytest.fixture(scope="module")
def made(built: Callable[..., Path]) -> Path:
    """A sound build, never changed."""
    folder = built("eccentric-drive")
    report = json.loads((folder / "report.json").read_text("utf-8"))
    tables = {table["title"]: {row[0] for row in table["rows"]} for table in report["tables"]}
    for kind in ("dxf", "stl", "3mf"):
        assert tables[f"Joints as measured, {kind.upper()}"] == {"O", "E", "P", "guide"}
        assert report["numbers"][f"stroke_recovered_{kind}_mm"] == pytest.approx(3.0, abs=1e-6)
        assert report["numbers"][f"motion_error_{kind}_mm"] < 1e-6
        # 0.2 mm of play in strap, pin and guide; at 90 deg the rod leans by asin(1/32)
        band = (0.1 + 0.1) / math.cos(math.asin(1 / 32)) + 0.1 * math.tan(math.asin(1 / 32))
        assert report["numbers"][f"clearance_band_{kind}_mm"] == pytest.approx(band, abs=2e-5)
    return folder


@pytest.fixture
def folder(made: Path, tmp_path: Path) -> Path:
    """A copy of it to be damaged."""
    return Path(shutil.copytree(made, tmp_path / "eccentric-drive"))


def failing(folder: Path, *kinds: str) -> set[tuple[str, str]]:
    """Codes that fail, with the kind of file."""
    return {(f.code, str(f.where).split(",")[0].rsplit(".", 1)[-1]) for f in wrong(folder, *kinds)}


@pytest.mark.long
def test_a_sound_build_passes_and_is_the_same_when_checked_again(folder: Path) -> None:
    assert failing(folder) == set()


@pytest.mark.long
def test_one_kind_of_file_alone_is_judged(tmp_path: Path) -> None:
    for kind in ("dxf", "stl", "3mf"):
        report = pipeline.build(SPEC, tmp_path / kind, frozenset({kind}))
        assert report.ok
        assert {"PIN_GAP", "MOTION_ERROR", "STROKE_ERROR"} <= {f.code for f in report.findings}


# ---- STL -------------------------------------------------------------------------------------------------------------


def edit_stl(folder: Path, part: str, change: Change) -> None:
    """Map the corners' plane points (complex), whose heights are given too."""
    path = folder / f"eccentric-drive-{part}.stl"
    data = path.read_bytes()
    triangles = np.frombuffer(data[84:], TRIANGLE).copy()
    corners = triangles["corners"].astype(float)
    plane = change(corners[..., 0] + 1j * corners[..., 1], corners[..., 2])
    triangles["corners"] = np.stack([plane.real, plane.imag, corners[..., 2]], axis=-1)
    path.write_bytes(data[:84] + with_own_normals(triangles).tobytes())


def near(at: complex, radius: float, change: Callable[[np.ndarray], np.ndarray]) -> Change:
    """A change of what lies within a radius of a point alone."""
    return lambda z, _: np.where(np.abs(z - at) < radius, change(z), z)


def rails(z: np.ndarray, height: np.ndarray) -> np.ndarray:
    """Corners of the guide's inner faces."""
    return (height >= 5) & (z.real > 40) & (np.abs(z.imag) < 4.5)


EYE, BORE = (48, 2.0), (0, 1.2)


@pytest.mark.long
@pytest.mark.parametrize(
    ("part", "change", "codes"),
    [
        pytest.param(
            "rod", near(*EYE, lambda z: z + 0.02), {"MOTION_ERROR"}, id="eye 20 um too far"
        ),
        pytest.param(
            "rod",
            lambda z, _: np.where(z.real > 20, z + 0.02, z),
            {"MOTION_ERROR", "ROUND_TRIP"},
            id="rod 20 um too long",
        ),
        pytest.param(
            "rod",
            near(*EYE, lambda z: 48 + (z - 48) * 1.01),
            {"PIN_GAP", "ROUND_TRIP"},
            id="eye 32 um too large",
        ),
        pytest.param(
            "rod",
            near(*EYE, lambda z: 48 + (z - 48) * 0.99),
            {"PIN_GAP", "ROUND_TRIP"},
            id="eye too small",
        ),
        pytest.param(
            "rod",
            lambda z, h: np.where((np.abs(z - 48) < 2) & (h > 1), z + 0.02j, z),
            {"PIN_GAP"},
            id="eye askew",
        ),
        pytest.param(
            "rod",
            near(*EYE, lambda z: 48 + (z - 48) * 2),
            {"PIN_GAP", "MIN_WALL", "VOLUME", "ROUND_TRIP"},
            id="eye without wall",
        ),
        pytest.param(
            "rod",
            lambda z, _: z * 1.001,
            {"PIN_GAP", "MOTION_ERROR", "VOLUME", "ROUND_TRIP"},
            id="rod scaled",
        ),
        pytest.param(
            "disc",
            near(*BORE, lambda z: z + 0.02),
            {"MOTION_ERROR", "STROKE_ERROR"},
            id="20 um less eccentric",
        ),
        pytest.param(
            "disc",
            near(*BORE, lambda z: z + 0.0008),
            {"STROKE_ERROR"},
            id="both ends off within the limit",
        ),
        pytest.param(
            "disc",
            near(*BORE, lambda z: z + 0.02j),
            {"MOTION_ERROR", "ROUND_TRIP"},
            id="eccentric a little late",
        ),
        pytest.param(
            "disc", lambda z, _: -z.conjugate(), {"PIN_GAP", "VOLUME", "ROUND_TRIP"}, id="mirrored"
        ),
        pytest.param(
            "pin-1", near(0, 1.7, lambda z: z * 0.9993), {"PIN_GAP", "ROUND_TRIP"}, id="thin pin"
        ),
        pytest.param(
            "slider",
            near(0, 1.7, lambda z: z + 0.02),
            {"MOTION_ERROR", "ROUND_TRIP"},
            id="pin hole off",
        ),
        pytest.param(
            "slider",
            lambda z, _: np.where(np.abs(z.imag - 4) < 0.1, z - 0.005j, z),
            {"PIN_GAP", "ROUND_TRIP"},
            id="narrow",
        ),
        pytest.param(
            "ground",
            near(0, 3.5, lambda z: z + 0.02),
            {"MOTION_ERROR", "ROUND_TRIP"},
            id="motor's seat off",
        ),
        pytest.param(
            "ground",
            lambda z, h: np.where(rails(z, h) & (z.imag < 0), z - 0.01j, z),
            {"PIN_GAP", "ROUND_TRIP"},
            id="wide guide",
        ),
    ],
)
def test_stl(folder: Path, part: str, change: Change, codes: set[str]) -> None:
    edit_stl(folder, part, change)
    assert failing(folder, "stl") == {(code, "stl") for code in codes}


@pytest.mark.long
def test_stl_with_a_shifted_guide(folder: Path) -> None:
    """Both rails 50 um aside: the pins fit, the slider runs beside the shaft's line."""
    edit_stl(folder, "ground", lambda z, h: np.where(rails(z, h), z + 0.05j, z))
    assert failing(folder, "stl") == {("MOTION_ERROR", "stl"), ("ROUND_TRIP", "stl")}


# ---- DXF -------------------------------------------------------------------------------------------------------------


def circle_of(drawing: ezdxf.document.Drawing, radius: float):  # type: ignore[no-untyped-def]
    return next(
        c for c in drawing.modelspace().query("CIRCLE") if abs(c.dxf.radius - radius) < 1e-6
    )


def moved(radius: float, to: complex) -> Callable[[ezdxf.document.Drawing], None]:
    def edit(drawing: ezdxf.document.Drawing) -> None:
        circle_of(drawing, radius).dxf.center = (to.real, to.imag)

    return edit


def swollen(radius: float, by: float) -> Callable[[ezdxf.document.Drawing], None]:
    def edit(drawing: ezdxf.document.Drawing) -> None:
        circle_of(drawing, radius).dxf.radius += by

    return edit


def lost(drawing: ezdxf.document.Drawing) -> None:
    drawing.modelspace().delete_entity(circle_of(drawing, 1.6))


@pytest.mark.long
@pytest.mark.parametrize(
    ("part", "edit", "codes"),
    [
        pytest.param("rod", moved(1.6, 48.02), {"MOTION_ERROR"}, id="rod 20 um too long"),
        pytest.param("rod", swollen(1.6, 0.01), {"PIN_GAP", "ROUND_TRIP"}, id="eye too large"),
        pytest.param("rod", lost, {"ROUND_TRIP", "PIN_GAP"}, id="lost eye"),
        pytest.param(
            "disc", moved(1.0, 0.02), {"MOTION_ERROR", "STROKE_ERROR"}, id="less eccentric"
        ),
        pytest.param(
            "disc", moved(1.0, -0.0008), {"STROKE_ERROR"}, id="both ends off within the limit"
        ),
        pytest.param("disc", swollen(4.5, -0.01), {"PIN_GAP", "ROUND_TRIP"}, id="disc too small"),
        pytest.param(
            "clamp", moved(1.2, 0.4 - 2.77j), {"ROUND_TRIP"}, id="a hole that is no joint"
        ),
    ],
)
def test_dxf(
    folder: Path, part: str, edit: Callable[[ezdxf.document.Drawing], None], codes: set[str]
) -> None:
    path = folder / f"eccentric-drive-{part}.dxf"
    drawing = ezdxf.readfile(path)
    edit(drawing)
    drawing.saveas(path)
    assert failing(folder, "dxf") == {(code, "dxf") for code in codes}


# ---- a cross-check that shares no theory -----------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("eccentricity", "diameter", "tip", "pivot", "arm"),
    [(1.5, 9, 0.5, 30, 31), (0.2, 7, 8, 25, 24), (6, 30, 2, 50, 45)],
)
def test_a_roller_on_the_eccentric_moves_as_the_four_bar(
    tmp_path: Path, eccentricity: float, diameter: float, tip: float, pivot: float, arm: float
) -> None:
    """An off-centre disc of radius a is a cam; a roller r on an arm makes it a four-bar whose coupler is a + r.

    The contact solver sees only the facets of the STL, the dyad engine only four lengths.
    """
    tolerance = 1e-4
    sizes = {"eccentricity": eccentricity, "eccentric_diameter": diameter}
    mechanism = pipeline.read_mechanism(
        SPEC, [f"geometry.{key}={value}" for key, value in sizes.items()]
    )
    (part,) = (part for part in mechanism.assembly.parts if part.name == "disc")
    write_stl(tmp_path / "disc.stl", solid(part, tolerance), "disc")
    shape = shape_of(slice_mesh(read_stl(tmp_path / "disc.stl"), 0.9 * part.thickness))
    ring = shape.moved(shift=-bore_circle(shape.holes[0], 2.0).centre).outer

    theta = np.random.default_rng(7).uniform(0, math.tau, 2000)
    bend = math.acos((pivot**2 + arm**2 - (diameter / 2 + tip) ** 2) / (2 * pivot * arm))
    mean = -arm * cmath.exp(1j * bend)  # the tip below the line of the shafts
    rolled = contact(ring, ArmTip(complex(pivot), mean, tip, 1)).angle(theta)

    def four_bar(coupler: float) -> tuple[np.ndarray, np.ndarray]:
        """The arm's angle, and the tip's movement along the normal per turn of the arm."""
        a = eccentricity * np.exp(1j * theta)
        d = pivot - a
        along = (coupler**2 - arm**2 + np.abs(d) ** 2) / (2 * np.abs(d))
        b = a + d / np.abs(d) * (along - 1j * np.sqrt(coupler**2 - along**2))
        return np.angle((b - pivot) / mean), arm * np.abs(np.sin(np.angle((a - b) / (pivot - b))))

    dyads, lever = four_bar(diameter / 2 + tip)
    assert np.all(np.abs(rolled - dyads) * lever <= tolerance + 1e-6)
    assert np.max(np.abs(rolled - four_bar(diameter / 2 + tip + 1e-3)[0]) * lever) > 5e-4


@pytest.mark.long
def test_a_tight_hole_is_not_mended_by_a_wide_one(folder: Path) -> None:
    """The disc's bore 0.2 mm wider and the collar's seat 0.2 mm narrower: the sum of both plays is as meant."""
    for part, radius, by in (("disc", 1.0, 0.1), ("ground", 3.0, -0.1)):
        path = folder / f"eccentric-drive-{part}.dxf"
        drawing = ezdxf.readfile(path)
        swollen(radius, by)(drawing)
        drawing.saveas(path)
    assert ("PIN_GAP", "dxf") in failing(folder, "dxf")


@pytest.mark.long
def test_a_shaft_hole_that_is_no_joint_stays_in_its_place(
    built: Callable[..., Path], tmp_path: Path
) -> None:
    """The take-up's plate lets the shaft through to the pivot: a millimetre off, and it does not."""
    folder = Path(shutil.copytree(built("thread-take-up"), tmp_path / "thread-take-up"))
    path = folder / "thread-take-up-ground.dxf"
    drawing = ezdxf.readfile(path)
    (hole,) = (
        c
        for c in drawing.modelspace().query("CIRCLE")
        if abs(complex(c.dxf.center.x, c.dxf.center.y)) < 1e-9
    )
    hole.dxf.center = (1, 0)
    drawing.saveas(path)
    assert ("ROUND_TRIP", "dxf") in failing(folder, "dxf")


@pytest.mark.long
def test_a_bed_too_small_is_told(tmp_path: Path) -> None:
    report = pipeline.build(SPEC, tmp_path, frozenset({"stl"}), ["print.bed=[20, 20]"])
    assert {f.code for f in report.findings if not f.ok} == {"BED_FIT"}


@pytest.mark.long
def test_the_feed_is_taken_from_the_guides_in_the_file(
    built: Callable[..., Path], tmp_path: Path
) -> None:
    """A guide's hole 0.1 mm off along the thread changes the feed, and the stroke with it."""
    folder = Path(shutil.copytree(built("thread-take-up"), tmp_path / "thread-take-up"))
    path = folder / "thread-take-up-ground.dxf"
    drawing = ezdxf.readfile(path)
    circles = drawing.modelspace().query("CIRCLE")
    (hole,) = (
        c for c in circles if abs(complex(c.dxf.center.x, c.dxf.center.y) - (40 + 15j)) < 1e-6
    )
    hole.dxf.center = (40.1, 15)
    drawing.saveas(path)
    report = judged(folder, "dxf")
    assert "MOTION_ERROR" in {f.code for f in report.findings if not f.ok}
    # from the mean direction of the thread at M: the stroke moves by less than the hole, and by more than a tenth of it
    lost = next(f for f in report.findings if f.code == "STROKE_ERROR")
    assert 0.01 < lost.measured < 0.1
