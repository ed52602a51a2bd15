"""Every check is seen to fail: each damage trips exactly its finding, or says clearly that the file cannot be read.

A contour out of shape is told by ROUND_TRIP as well as by what follows from it.
"""

from __future__ import annotations

import re
import shutil
import zipfile
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import ezdxf
import numpy as np
import pytest
from judged import wrong
from stl_rows import TRIANGLE, with_own_normals

from camgen.errors import FileError
from camgen.files.dxf import read_dxf
from camgen.findings import Where
from camgen.geometry.rings import Ring, Shape, shape_of
from camgen.judge.cams import judged_angles
from camgen.judge.joints import Nominal
from camgen.judge.measured import Files
from camgen.judge.motion import judge_machine
from camgen.judge.round_trip import NominalPart, Section, _judge_sections, judge_mesh
from camgen.machine.features import CamOutline, Eye
from camgen.machines.mechanism import Mechanism
from camgen.pipeline import build as pipeline
from camgen.pipeline.expectation import nominal_part

# No windows, so that the cam's holes are alike in a mirror and only the profile tells.
OVERRIDES = ("parts.windows=0", "name='cam'", "parts.make='cams'", "parts.bore=8")
SPEC = Path(__file__).resolve().parents[2] / "specs" / "uniform-swing.toml"


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A sound build, never changed."""
    out = tmp_path_factory.mktemp("sound")
    report = pipeline.build(SPEC, out, frozenset({"dxf", "stl", "3mf"}), OVERRIDES)
    assert report.ok
    return out / "cam"


@pytest.fixture
def folder(made: Path, tmp_path: Path) -> Path:
    """A copy of it to be damaged."""
    return Path(shutil.copytree(made, tmp_path / "cam"))


def failing(folder: Path, *kinds: str) -> set[tuple[str, str]]:
    """Codes that fail, with the kind of file."""
    return {(f.code, str(f.where).split(",")[0].rsplit(".", 1)[-1]) for f in wrong(folder, *kinds)}


def test_a_sound_build_passes(folder: Path) -> None:
    assert failing(folder) == set()


# ---- STL -------------------------------------------------------------------------------------------------------------


def edit_stl(folder: Path, edit: Callable[[np.ndarray], np.ndarray], normals: bool = False) -> None:
    """Change an STL's triangles; their normals follow, unless they are what is changed."""
    path = folder / "cam-cam.stl"
    data = path.read_bytes()
    triangles = edit(np.frombuffer(data[84:], TRIANGLE).copy())
    triangles = triangles if normals else with_own_normals(triangles)
    path.write_bytes(data[:80] + np.uint32(len(triangles)).tobytes() + triangles.tobytes())


def moved(change: Callable[[np.ndarray], np.ndarray]) -> Callable[[np.ndarray], np.ndarray]:
    """An edit that maps the corners' plane points (complex) and keeps their heights."""

    def edit(triangles: np.ndarray) -> np.ndarray:
        corners = triangles["corners"].astype(float)
        plane = change(corners[..., 0] + 1j * corners[..., 1])
        triangles["corners"] = np.stack([plane.real, plane.imag, corners[..., 2]], axis=-1)
        return triangles

    return edit


def outer_ring(folder: Path) -> np.ndarray:
    drawing = read_dxf(folder / "cam-cam.dxf")
    return shape_of(drawing.cut).outer.facetted(0.001)


def shrink(z: np.ndarray) -> np.ndarray:
    """Scaled about the shaft so that the far side loses 10 um."""
    return np.where(np.abs(z) > 10.5, z * (1 - 0.010 / 42), z)


def one_vertex(z: np.ndarray) -> np.ndarray:
    """The rim's vertex nearest (28, 10) pushed out by 30 um, top and bottom alike."""
    picked = z.ravel()[np.argmin(np.abs(z - (28 + 10j)))]
    return np.where(z == picked, z * (1 + 0.030 / abs(picked)), z)


def test_stl_shrunk_by_10_um(folder: Path) -> None:
    edit_stl(folder, moved(shrink))
    assert failing(folder, "stl") == {("MOTION_ERROR", "stl"), ("ROUND_TRIP", "stl")}


def test_stl_with_one_moved_vertex(folder: Path) -> None:
    edit_stl(folder, moved(one_vertex))
    assert failing(folder, "stl") == {("MOTION_ERROR", "stl"), ("ROUND_TRIP", "stl")}


def test_stl_mirrored(folder: Path) -> None:
    def mirror(triangles: np.ndarray) -> np.ndarray:
        triangles["corners"][..., 0] *= -1
        triangles["corners"] = triangles["corners"][:, ::-1]  # keep the outside outside
        return triangles

    edit_stl(folder, mirror)
    assert failing(folder, "stl") == {
        ("MOTION_ERROR", "stl"),
        ("ROUND_TRIP", "stl"),
    }  # the engraved arrow points the other way


def test_stl_with_a_shifted_bore(folder: Path) -> None:
    edit_stl(folder, moved(lambda z: np.where(np.abs(z) < 4.2, z + 0.02, z)))
    assert failing(folder, "stl") == {("MOTION_ERROR", "stl")}


def test_stl_with_a_shifted_pin_hole(folder: Path) -> None:
    edit_stl(folder, moved(lambda z: np.where(np.abs(z - 8.5) < 1.6, z + 0.02, z)))
    assert failing(folder, "stl") == {("ROUND_TRIP", "stl")}


def test_stl_of_the_wrong_thickness(folder: Path) -> None:
    def thicker(triangles: np.ndarray) -> np.ndarray:
        triangles["corners"][..., 2] *= 1.01
        return triangles

    edit_stl(folder, thicker)
    assert failing(folder, "stl") == {("VOLUME", "stl"), ("ROUND_TRIP", "stl")}


def test_stl_of_another_volume(folder: Path) -> None:
    """A part that should weigh more than the file's, all its contours alike."""
    mechanism = pipeline.read_mechanism(folder / "spec.toml")
    meant = nominal_part(mechanism.assembly.parts[0], 0.001, mechanism.assembly.features)
    codes = []
    for share in (1.0, 1.01):
        judged = judge_mesh(folder / "cam-cam.stl", replace(meant, volume=share * meant.volume))
        codes.append({finding.code for finding in judged.findings if not finding.ok})
    assert codes == [set(), {"VOLUME"}]


def test_holes_that_are_in_another_piece_are_told() -> None:
    """Two plates, each meant with one hole; both holes are in the first: as many contours, and wrong ones."""

    def ring(centre: complex, radius: float) -> Ring:
        points = centre + radius * np.exp(2j * np.pi * np.arange(64) / 64)
        return Ring(points, np.zeros(64))

    plates, holes = (ring(0, 10), ring(30, 10)), (ring(-4, 2), ring(4, 2), ring(30, 2))
    meant = Section((0.5,), (Shape(plates[0], holes[:1]), Shape(plates[1], holes[2:])))
    part = NominalPart("x", (meant,), 0, 1.0, (0.0, 1.0), 1.0, 0.1, 0.001)
    for found, ok in ((holes[::2], True), (holes[:2], False)):
        judged = _judge_sections([(meant, [*plates, *found])], part, "x.stl", 0.0, [])
        assert [f.ok for f in judged.findings if f.code == "ROUND_TRIP"] == [ok]


def test_stl_with_a_deeper_engraving(folder: Path) -> None:
    def deeper(triangles: np.ndarray) -> np.ndarray:
        heights = triangles["corners"][..., 2]
        heights[np.isclose(heights, np.unique(heights)[1])] -= 0.1
        return triangles

    edit_stl(folder, deeper)
    assert failing(folder, "stl") == {("ROUND_TRIP", "stl")}


def test_stl_lifted_off_its_underside(folder: Path) -> None:
    def lift(triangles: np.ndarray) -> np.ndarray:
        triangles["corners"][..., 2] += 0.01
        return triangles

    edit_stl(folder, lift)
    assert failing(folder, "stl") == {("ROUND_TRIP", "stl")}


def test_stl_whose_arrow_is_turned(folder: Path) -> None:
    """The engraving alone, 0.6 mm deep at most, points another way."""

    def turn(triangles: np.ndarray) -> np.ndarray:
        corners = triangles["corners"]
        floor = np.isclose(corners[..., 2], np.unique(corners[..., 2])[1])
        plane = corners[..., 0] + 1j * corners[..., 1]
        arrow = np.isin(plane, plane[floor])
        middle = np.unique(plane[floor]).mean()
        plane = np.where(arrow, middle - (plane - middle), plane)
        triangles["corners"] = np.stack([plane.real, plane.imag, corners[..., 2]], axis=-1)
        return triangles

    edit_stl(folder, turn)
    assert ("ROUND_TRIP", "stl") in failing(folder, "stl")


@pytest.mark.parametrize(
    "edit",
    [
        pytest.param(lambda t: t[1:], id="missing triangle"),
        pytest.param(lambda t: np.concatenate([t, t[:1]]), id="doubled triangle"),
        pytest.param(lambda t: flipped(t), id="flipped triangle"),
    ],
)
def test_stl_with_a_bad_triangle(folder: Path, edit: Callable[[np.ndarray], np.ndarray]) -> None:
    edit_stl(folder, edit)
    assert failing(folder, "stl") == {("WATERTIGHT", "stl")}


def blind(triangles: np.ndarray) -> np.ndarray:
    triangles["normal"] = 0
    return triangles


def reversed_normals(triangles: np.ndarray) -> np.ndarray:
    triangles["normal"] *= -1
    return triangles


def one_normal(triangles: np.ndarray) -> np.ndarray:
    triangles["normal"][7] = np.nan
    return triangles


@pytest.mark.parametrize("edit, count", [(blind, None), (reversed_normals, None), (one_normal, 1)])
def test_stl_whose_stored_normals_are_not_those_of_its_triangles(
    folder: Path, edit: Callable[[np.ndarray], np.ndarray], count: int | None
) -> None:
    """admesh and some slicers go by them; nothing else is wrong with the file."""
    edit_stl(folder, edit, normals=True)
    (finding,) = wrong(folder, "stl")
    triangles = (len((folder / "cam-cam.stl").read_bytes()) - 84) // 50
    assert (finding.code, str(finding.where), finding.measured) == (
        "WATERTIGHT",
        "cam-cam.stl",
        count or triangles,
    )


def flipped(triangles: np.ndarray) -> np.ndarray:
    triangles["corners"][7] = triangles["corners"][7][::-1].copy()
    return triangles


# ---- DXF -------------------------------------------------------------------------------------------------------------


def edit_dxf(folder: Path, edit: Callable[[ezdxf.document.Drawing], None]) -> None:
    path = folder / "cam-cam.dxf"
    drawing = ezdxf.readfile(path)
    edit(drawing)
    drawing.saveas(path)


def rim(drawing: ezdxf.document.Drawing):  # type: ignore[no-untyped-def]
    return drawing.modelspace().query("LWPOLYLINE").first


def circles(drawing: ezdxf.document.Drawing, radius: float):  # type: ignore[no-untyped-def]
    return [c for c in drawing.modelspace().query("CIRCLE") if abs(c.dxf.radius - radius) < 1e-6]


def push(change: Callable[[np.ndarray], np.ndarray]) -> Callable[[ezdxf.document.Drawing], None]:
    def edit(drawing: ezdxf.document.Drawing) -> None:
        line = rim(drawing)
        rows = np.array(line.get_points("xyb"))
        z = change(rows[:, 0] + 1j * rows[:, 1])
        line.set_points(
            [(p.real, p.imag, b) for p, b in zip(z, rows[:, 2], strict=True)], format="xyb"
        )

    return edit


def open_rim(drawing: ezdxf.document.Drawing) -> None:
    rim(drawing).closed = False


def double_rim(drawing: ezdxf.document.Drawing) -> None:
    drawing.modelspace().add_entity(rim(drawing).copy())


def inches(drawing: ezdxf.document.Drawing) -> None:
    drawing.units = ezdxf.units.IN


def shift_bore(drawing: ezdxf.document.Drawing) -> None:
    circles(drawing, 4)[0].dxf.center = (0.02, 0)


def cross_a_contour(drawing: ezdxf.document.Drawing) -> None:
    """A slit from the rim inwards and back, which no follower feels."""
    line = rim(drawing)
    rows = line.get_points("xyb")
    x, y, _ = rows[5]
    line.set_points([*rows[:5], (x, y, 0), (0.8 * x, 0.8 * y, 0), *rows[5:]], format="xyb")


def letter_the_part(drawing: ezdxf.document.Drawing) -> None:
    drawing.modelspace().add_text("cam")


def lose_pin_hole(drawing: ezdxf.document.Drawing) -> None:
    drawing.modelspace().delete_entity(circles(drawing, 1.5)[0])


def swell_bore(drawing: ezdxf.document.Drawing) -> None:
    circles(drawing, 4)[0].dxf.radius = 6.5


def of_cut_layer(change: str) -> Callable[[ezdxf.document.Drawing], None]:
    return lambda drawing: getattr(drawing.layers.get("CUT"), change)()


def dashed(drawing: ezdxf.document.Drawing) -> None:
    drawing.layers.get("CUT").dxf.linetype = "CENTER2"


def unplotted(drawing: ezdxf.document.Drawing) -> None:
    drawing.layers.get("CUT").dxf.plot = 0


def painted(**attributes: object) -> Callable[[ezdxf.document.Drawing], None]:
    return lambda drawing: drawing.layers.get("CUT").update_dxf_attribs(attributes)


def rim_with(**attributes: object) -> Callable[[ezdxf.document.Drawing], None]:
    return lambda drawing: rim(drawing).update_dxf_attribs(attributes)


def widen_one_segment(drawing: ezdxf.document.Drawing) -> None:
    rim(drawing)[5] = (*rim(drawing)[5][:2], 0, 0.5, rim(drawing)[5][4])


def drill_on_paper(drawing: ezdxf.document.Drawing) -> None:
    drawing.paperspace().add_circle((3, 3), 2, dxfattribs={"layer": "CUT"})


def drill_in_a_block(drawing: ezdxf.document.Drawing) -> None:
    drawing.blocks.new("drilled").add_circle((3, 3), 2, dxfattribs={"layer": "CUT"})


def mark_a_centre(drawing: ezdxf.document.Drawing) -> None:
    drawing.modelspace().add_line((-1, 0), (1, 0), dxfattribs={"layer": "CENTER"})


@pytest.mark.parametrize(
    ("edit", "codes"),
    [
        pytest.param(of_cut_layer("off"), {"DXF_CLOSED"}, id="layer off"),
        pytest.param(of_cut_layer("freeze"), {"DXF_CLOSED"}, id="layer frozen"),
        pytest.param(of_cut_layer("lock"), {"DXF_CLOSED"}, id="layer locked"),
        pytest.param(unplotted, {"DXF_CLOSED"}, id="layer not plotted"),
        pytest.param(dashed, {"DXF_CLOSED"}, id="layer dashed"),
        pytest.param(painted(color=5), {"DXF_CLOSED"}, id="layer for another tool"),
        pytest.param(painted(true_color=255), {"DXF_CLOSED"}, id="layer in a true colour"),
        pytest.param(rim_with(invisible=1), {"DXF_CLOSED"}, id="invisible contour"),
        pytest.param(rim_with(const_width=2), {"DXF_CLOSED"}, id="contour with a width"),
        pytest.param(
            rim_with(transparency=0x020000FF - 255), {"DXF_CLOSED"}, id="transparent contour"
        ),
        pytest.param(rim_with(thickness=5), {"DXF_CLOSED"}, id="contour drawn upwards"),
        pytest.param(rim_with(linetype="CENTER2"), {"DXF_CLOSED"}, id="dashed contour"),
        pytest.param(widen_one_segment, {"DXF_CLOSED"}, id="segment with a width"),
        pytest.param(drill_on_paper, {"DXF_CLOSED"}, id="hole in paper space"),
        pytest.param(drill_in_a_block, {"DXF_CLOSED"}, id="hole in a block"),
        pytest.param(mark_a_centre, {"DXF_CLOSED"}, id="mark that nobody asked for"),
        pytest.param(push(shrink), {"MOTION_ERROR", "ROUND_TRIP"}, id="10 um shrink"),
        pytest.param(push(one_vertex), {"MOTION_ERROR", "ROUND_TRIP"}, id="moved vertex"),
        pytest.param(shift_bore, {"MOTION_ERROR"}, id="shifted bore"),
        pytest.param(inches, {"DXF_UNITS"}, id="inch header"),
        pytest.param(open_rim, {"DXF_CLOSED"}, id="open contour"),
        pytest.param(double_rim, {"DXF_CLOSED"}, id="double contour"),
        pytest.param(letter_the_part, {"DXF_CLOSED"}, id="lettering among the contours"),
        pytest.param(cross_a_contour, {"MIN_WALL", "ROUND_TRIP"}, id="contour that touches itself"),
        pytest.param(lose_pin_hole, {"ROUND_TRIP"}, id="lost hole"),
        pytest.param(swell_bore, {"ROUND_TRIP", "MIN_WALL"}, id="bore that leaves a thin wall"),
    ],
)
def test_dxf(folder: Path, edit: Callable[[ezdxf.document.Drawing], None], codes: set[str]) -> None:
    edit_dxf(folder, edit)
    assert failing(folder, "dxf") == {(code, "dxf") for code in codes}


def test_marks_that_were_asked_for_are_as_meant(tmp_path: Path) -> None:
    report = pipeline.build(
        SPEC, tmp_path, frozenset({"dxf"}), (*OVERRIDES, "output.center_marks=true")
    )
    folder = tmp_path / "cam"
    marks = ezdxf.readfile(folder / "cam-cam.dxf").modelspace().query("LINE[layer=='CENTER']")
    assert report.ok and len(marks) == 6  # the shaft and two pins
    spec = (folder / "spec.toml").read_text()
    (folder / "spec.toml").write_text(spec.replace("center_marks = true", "center_marks = false"))
    assert failing(folder, "dxf") == {("DXF_CLOSED", "dxf")}
    (folder / "spec.toml").write_text(spec)
    edit_dxf(folder, lambda drawing: drawing.modelspace().query("LINE").first.translate(0, 0.1, 0))
    assert failing(folder, "dxf") == {("DXF_CLOSED", "dxf")}


def test_what_is_engraved_is_as_meant(tmp_path: Path) -> None:
    """The arrow that tells how a cam turns: there where it is asked for, in its place, and nowhere else."""
    report = pipeline.build(SPEC, tmp_path, frozenset({"dxf"}), (*OVERRIDES, "output.engrave=true"))
    folder, arrow = tmp_path / "cam", "*[layer=='ENGRAVE']"
    assert report.ok and len(ezdxf.readfile(folder / "cam-cam.dxf").modelspace().query(arrow)) == 1
    spec = (folder / "spec.toml").read_text()
    (folder / "spec.toml").write_text(spec.replace("engrave = true", "engrave = false"))
    assert failing(folder, "dxf") == {("DXF_CLOSED", "dxf")}
    (folder / "spec.toml").write_text(spec)
    assert not failing(folder, "dxf")
    edit_dxf(folder, lambda drawing: drawing.modelspace().query(arrow).first.translate(0, 0.1, 0))
    assert failing(folder, "dxf") == {("DXF_CLOSED", "dxf")}


# ---- both, and the pair ----------------------------------------------------------------------------------------------


@pytest.mark.parametrize("kind", ["dxf", "stl", "3mf"])
def test_a_file_cut_short_is_told(folder: Path, kind: str) -> None:
    path = folder / f"cam-cam.{kind}"
    path.write_bytes(path.read_bytes()[:-1000])
    with pytest.raises(FileError) as caught:
        wrong(folder, kind)
    assert path.name in str(caught.value)


@pytest.mark.parametrize("kind", ["dxf", "stl", "3mf"])
def test_a_lost_file_is_told(folder: Path, kind: str) -> None:
    (folder / f"cam-cam.{kind}").unlink()
    with pytest.raises(FileError) as caught:
        pipeline.check(folder)
    assert f"cam-cam.{kind}" in str(caught.value)


def judged(folder: Path, first: float = 3.0, second: float = 3.0, **twin: object) -> set[str]:
    """Failing codes when the drawing is judged with other tips, radii in mm, or with its twin mounted otherwise."""
    mechanism: Mechanism = pipeline.read_mechanism(folder / "spec.toml")
    shape = shape_of(read_dxf(folder / "cam-cam.dxf").cut)
    features = []
    for feature, radius in zip(mechanism.assembly.features, (first, second), strict=True):
        assert (
            isinstance(feature, CamOutline)
            and isinstance(feature.tip, Eye)
            and feature.tip.diameter == 6
        )
        features.append(replace(feature, tip=replace(feature.tip, diameter=2 * radius)))
    one, other = mechanism.assembly.mounts
    mounts = [one, replace(other, **twin)]  # type: ignore[arg-type]
    found = judge_machine(
        Nominal(mechanism.model, features, mounts, mechanism.assembly.demands),
        Files("dxf", Where(file="cam-*.dxf", kind="dxf"), {"cam": [[shape]]}),
        judged_angles(),
        0.001,
    )
    return {f.code for f in found.findings if not f.ok}


def test_the_wrong_tip_radius(folder: Path) -> None:
    assert judged(folder) == set()
    assert judged(folder, first=3.01) == {"MOTION_ERROR"}


def test_a_twin_turned_by_one_degree_jams(folder: Path) -> None:
    assert judged(folder, angle=np.radians(1.0)) == {"INTERFERENCE"}
    assert judged(folder, angle=np.radians(-1.0)) == {"INTERFERENCE"}


def test_a_twin_that_is_not_turned_over(folder: Path) -> None:
    assert judged(folder, flipped=False) == {"INTERFERENCE", "LASH"}


def test_a_smaller_second_tip_rattles(folder: Path) -> None:
    assert judged(folder, second=2.8) == {"LASH"}


def test_a_wrong_spec_beside_the_files_is_told(folder: Path) -> None:
    spec = folder / "spec.toml"
    spec.write_text(spec.read_text().replace("swing_deg = 30.0", "swing_deg = 29.9"))
    assert ("MOTION_ERROR", "dxf") in failing(folder, "dxf")


@pytest.mark.parametrize("name", ["motion.csv", "report.json", "cam-cam-drawing.pdf"])
def test_a_side_file_that_was_changed_is_told(folder: Path, name: str) -> None:
    path = folder / name
    path.write_bytes(path.read_bytes()[:-9])
    assert failing(folder) == {("MANIFEST", "json")}


def test_a_dimensioned_drawing_is_read_too(folder: Path) -> None:
    path = folder / "cam-cam-drawing.dxf"
    data = path.read_bytes()
    path.write_bytes(b"999\nby another\n" + data)
    assert failing(folder) == {("MANIFEST", "json")}
    path.write_bytes(data[:-9])
    with pytest.raises(FileError, match=r"cam-cam-drawing\.dxf.* cut short"):
        failing(folder)


def edit_3mf(folder: Path, name: str, edit: Callable[[str], str]) -> None:
    path = folder / name
    with zipfile.ZipFile(path) as package:
        files = {item: package.read(item) for item in package.namelist()}
    with zipfile.ZipFile(path, "w") as package:
        for item, data in files.items():
            package.writestr(
                item, edit(data.decode()).encode() if item.endswith(".model") else data
            )


@pytest.mark.parametrize(
    "edit, meets",
    [
        pytest.param(
            lambda text: text.replace('unit="millimeter"', 'unit="inch"'), "", id="inches"
        ),
        pytest.param(
            lambda text: re.sub(r'<vertex x="[^"]*"', '<vertex x="1.234"', text, count=1),
            "",
            id="moved vertex",
        ),
        pytest.param(lambda text: re.sub(r"<item [^>]*/>", "", text, count=1), "", id="lost copy"),
        pytest.param(
            lambda text: re.sub(r'transform="[^ ]* ', 'transform="-1.02 ', text, count=1),
            "cam-2 and tip on cam-2: overlap",
            id="stretched copy",
        ),
        pytest.param(
            lambda text: re.sub(r' transform="[^"]*"', "", text),
            "cam-1 and cam-2: overlap",
            id="two copies in one place",
        ),
    ],
)
def test_a_damaged_assembly_is_told(
    folder: Path, edit: Callable[[str], str], meets: str, request: pytest.FixtureRequest
) -> None:
    """meets: bodies that overlap for it, as the sweep sees them."""
    edit_3mf(folder, "cam-assembly.3mf", edit)
    lost = {("COPIES", "3mf")} if "lost copy" in request.node.name else set()
    expected = {("ROUND_TRIP", "3mf")} | lost | ({("INTERFERENCE", meets)} if meets else set())
    assert failing(folder, "3mf") == expected


BEAM = (
    "</mesh>",
    '<b:beamlattice minlength="0.1" radius="2"><b:beams><b:beam v1="0" v2="5"/></b:beams></b:beamlattice></mesh>',
)
SPARE = ("</vertices>", '<vertex x="1e4" y="0" z="0"/></vertices>')


def with_impostor(text: str, name: str = "cam") -> str:
    """The object is made larger and built; a good one of that name lies beside it."""
    start, end = text.index("<object "), text.index("</object>") + len("</object>")
    good = text[start:end].replace('name="cam"', f'name="{name}"')
    good = re.sub(r'id="\d+"', 'id="4711"', re.sub(r'UUID="\w+', 'UUID="0000abcd', good), count=1)
    large = re.sub(
        r'([xy])="([-\d.e]+)"', lambda m: f'{m[1]}="{1.2 * float(m[2]):.9g}"', text[start:end]
    )
    return text[:start] + large + good + text[end:]


@pytest.mark.long
@pytest.mark.parametrize("name", ["cam", "assembly"])
@pytest.mark.parametrize(
    "edit, said",
    [
        pytest.param(with_impostor, "have the name 'cam'", id="two of one name"),
        pytest.param(
            lambda text: with_impostor(text, "kit"),
            "nothing builds object 'kit'",
            id="unbuilt object",
        ),
        pytest.param(
            lambda text: text.replace('type="model"', 'type="support"'),
            "of type support",
            id="support",
        ),
        pytest.param(
            lambda text: text.replace(*SPARE), "1 vertices that no triangle uses", id="spare vertex"
        ),
        pytest.param(
            lambda text: text.replace('unit="millimeter"', 'unit="micron"'),
            "unit is MicroMeter",
            id="micron",
        ),
        pytest.param(
            lambda text: text.replace(*BEAM),
            "elements of extensions: b:beam, b:beamlattice",
            id="beam",
        ),
    ],
)
def test_a_package_that_is_not_plain_is_told(
    folder: Path, name: str, edit: Callable[[str], str], said: str
) -> None:
    edit_3mf(folder, f"cam-{name}.3mf", edit)
    failed = wrong(folder, "3mf")
    assert {str(f.where) for f in failed if f.code == "ROUND_TRIP" and said in f.message} == {
        f"cam-{name}.3mf"
    }


def test_a_part_for_slicers_in_a_package_is_told(folder: Path) -> None:
    """Such a part can say that a volume is cut away, or fill another one."""
    with zipfile.ZipFile(folder / "cam-cam.3mf", "a") as package:
        package.writestr("Metadata/Slic3r_PE_model.config", "<config/>")
    told = [f for f in wrong(folder, "3mf") if f.code == "ROUND_TRIP"]
    assert [str(f.where) for f in told] == ["cam-cam.3mf"] and "Slic3r_PE_model.config" in told[
        0
    ].message


def test_a_unit_that_there_is_not_is_no_millimetre(folder: Path) -> None:
    edit_3mf(folder, "cam-cam.3mf", lambda text: text.replace('unit="millimeter"', 'unit="parsec"'))
    with pytest.raises(FileError, match=r"cam-cam\.3mf.*[Uu]nit"):
        wrong(folder, "3mf")


def nested(text: str) -> str:
    """Ten to the eighth copies: components of components, ten in each."""
    first = re.search(r'<object id="(\d+)"', text)
    assert first is not None
    last, objects = int(first[1]), ""
    for number in range(5000, 5008):
        objects += (
            f'<object id="{number}"><components>'
            + f'<component objectid="{last}"/>' * 10
            + "</components></object>"
        )
        last = number
    return text.replace("</resources>", objects + "</resources>").replace(
        "</build>", f'<item objectid="{last}"/></build>'
    )


def test_copies_are_counted_before_they_are_placed(folder: Path) -> None:
    edit_3mf(folder, "cam-cam.3mf", nested)
    with pytest.raises(FileError, match=r"cam-cam\.3mf: places 11111111. copies.*at most 10000"):
        wrong(folder, "3mf")


@pytest.mark.parametrize("text", ["", "{}", "[]", '{"camgen": "1", "files": 3}', "[" * 100_000])
def test_a_manifest_that_is_none_is_told(folder: Path, text: str) -> None:
    (folder / "manifest.json").write_text(text)
    with pytest.raises(FileError, match=r"manifest\.json"):
        pipeline.check(folder)


def test_files_that_the_manifest_forgot_are_judged_all_the_same(folder: Path) -> None:
    (folder / "manifest.json").write_text('{"camgen": "1", "files": {}}')
    edit_dxf(folder, inches)
    assert failing(folder) == {("DXF_UNITS", "dxf")}
