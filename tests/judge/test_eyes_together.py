"""Eyes of a part that moved together in its outline: the motion is as asked for, and the file still is not the part."""

from __future__ import annotations

import cmath
import math
import shutil
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import ezdxf
import numpy as np
import pytest
from judged import mechanism_of, wrong

from camgen.files.stl import read_stl, write_stl
from camgen.files.threemf import PartCopy, read_3mf, write_3mf
from camgen.geometry.mesh import Mesh
from camgen.machine.features import eyes_of
from camgen.pipeline import build as pipeline

Eyes = tuple[tuple[complex, float], ...]
Change = Callable[[np.ndarray], np.ndarray]
TURN = cmath.exp(1j * math.radians(0.3))


def in_eyes(points: np.ndarray, eyes: Eyes) -> np.ndarray:
    """Whether points lie in an eye or on its rim."""
    return np.any([np.abs(points - at) < diameter / 2 + 0.02 for at, diameter in eyes], axis=0)


def changed(mesh: Mesh, eyes: Eyes, change: Change) -> Mesh:
    plane = mesh.vertices[:, 0] + 1j * mesh.vertices[:, 1]
    plane = np.where(in_eyes(plane, eyes), change(plane), plane)
    return replace(mesh, vertices=np.column_stack([plane.real, plane.imag, mesh.vertices[:, 2]]))


def damage(path: Path, part: str, eyes: Eyes, change: Change) -> None:
    """Move the rims of a part's eyes in one file."""
    if path.suffix == ".dxf":
        drawing = ezdxf.readfile(path)
        for circle in drawing.modelspace().query("CIRCLE"):
            at = complex(circle.dxf.center.x, circle.dxf.center.y)
            if in_eyes(np.array([at]), eyes).any():
                to = complex(change(np.array([at]))[0])
                circle.dxf.center = (to.real, to.imag)
        drawing.saveas(path)
    elif path.suffix == ".stl":
        write_stl(path, changed(read_stl(path), eyes, change), part)
    else:
        package = read_3mf(path)
        meshes = package.meshes | {part: changed(package.meshes[part], eyes, change)}
        items = [
            PartCopy(item.name, f"{item.name}-{k}", item.transform)
            for k, item in enumerate(package.items)
        ]
        if len(items) == 1:
            items = [replace(items[0], name=part)]
        write_3mf(path, meshes, items, "key")


@pytest.mark.long
@pytest.mark.parametrize(
    ("kind", "spec", "part", "change", "off"),
    [
        *((kind, "linkage", "coupler", lambda z: z + 0.6, 0.6) for kind in ("dxf", "stl", "3mf")),
        ("dxf", "linkage", "ground", lambda z: z - 0.05j, 0.05),
        ("stl", "linkage", "ground", lambda z: z - 0.05j, 0.05),
        ("dxf", "thread-take-up", "coupler", lambda z: (z - 19) * TURN + 19, None),
        ("3mf", "thread-take-up", "coupler", lambda z: (z - 19) * TURN + 19, None),
    ],
)
def test_moved_together(
    built: Callable[..., Path],
    tmp_path: Path,
    kind: str,
    spec: str,
    part: str,
    change: Change,
    off: float | None,
) -> None:
    folder = Path(shutil.copytree(built(spec), tmp_path / spec))
    eyes = eyes_of(part, mechanism_of(folder).assembly.features)
    damage(folder / f"{spec}-{part}.{kind}", part, eyes, change)
    found = [f for f in wrong(folder, kind) if str(f.where) == f"{spec}-{part}.{kind}"]
    assert [f.code for f in found] == ["ROUND_TRIP"] and "moved or turned together" in found[
        0
    ].message
    if off is not None:
        assert found[0].measured == pytest.approx(off, abs=1e-5)


@pytest.mark.long
@pytest.mark.parametrize("settings", [(), ("print.hole_compensation=0.1",)])
def test_moved_together_in_the_assembly_alone(
    root: Path, tmp_path: Path, settings: tuple[str, ...]
) -> None:
    """Where files for the printer are compensated, the assembly's parts are judged by themselves."""
    folder = tmp_path / "linkage"
    assert pipeline.build(
        root / "specs" / "linkage.toml", tmp_path, frozenset({"3mf"}), settings
    ).ok
    eyes = eyes_of("coupler", mechanism_of(folder).assembly.features)
    damage(folder / "linkage-assembly.3mf", "coupler", eyes, lambda z: z + 0.6)
    found = [(f.code, str(f.where)) for f in wrong(folder, "3mf")]
    where = "linkage-assembly.3mf, coupler" if settings else "linkage-assembly.3mf"
    assert ("ROUND_TRIP", where) in found


@pytest.mark.long
def test_a_lone_hole_that_no_output_sees(tmp_path: Path) -> None:
    """The pin of a ram, moved along its way: the arm swings as ever."""
    spec = Path(__file__).resolve().parents[2] / "specs" / "quick-return.toml"
    text = spec.read_text("utf-8")
    own = (
        text[: text.index("[[output]]")]
        + '[[output]]\nname = "arm"\nlink = "arm"\n\n'
        + text[text.index("[limits]") :]
    )
    (tmp_path / "spec.toml").write_text(own, "utf-8")
    assert pipeline.build(tmp_path / "spec.toml", tmp_path / "out", frozenset({"dxf"})).ok
    folder = tmp_path / "out" / "quick-return"
    damage(folder / "quick-return-ram.dxf", "ram", ((0j, 5.0),), lambda z: z + 0.6)
    assert {(f.code, str(f.where)) for f in wrong(folder, "dxf")} == {
        ("ROUND_TRIP", "quick-return-ram.dxf")
    }


@pytest.mark.long
@pytest.mark.parametrize("kind", ["dxf", "stl", "3mf"])
def test_the_bore_of_a_cam_is_the_motions(
    built: Callable[..., Path], tmp_path: Path, kind: str
) -> None:
    """How a bore stands to the outline that a follower runs on: an error of the motion, told once."""
    folder = Path(shutil.copytree(built("disc-cam"), tmp_path / "disc-cam"))
    bore = next(part for part in mechanism_of(folder).assembly.parts if part.name == "cam").bore
    assert bore is not None
    damage(folder / f"disc-cam-cam.{kind}", "cam", ((0j, bore),), lambda z: z + 0.6)
    found = [(f.code, str(f.where)) for f in wrong(folder, kind)]
    assert "MOTION_ERROR" in [code for code, where in found if kind in where]
    assert ("ROUND_TRIP", f"disc-cam-cam.{kind}") not in found
