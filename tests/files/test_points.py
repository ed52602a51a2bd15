"""Measured points round a disc, of which the motion is known in closed form, and tables that are wrong."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from camgen.errors import FileError
from camgen.files.foreign import read_outline
from camgen.judge.follower_table import read_follower
from camgen.pipeline.outline_motion import recover

A, E = 20.0, 5.0  # disc, off centre
PLACES = E + A * np.exp(1j * np.radians(np.arange(360)))


def table(path: Path, head: str, rows: object, cut: str = ",") -> Path:
    lines = [cut.join(f"{cell:.6f}" for cell in row) for row in rows]  # type: ignore[attr-defined]
    path.write_text("\n".join([head, *lines]) + "\n", encoding="utf-8")
    return path


def places(path: Path, head: str = "x_mm,y_mm", z: object = PLACES) -> Path:
    return table(path, head, [(each.real, each.imag) for each in z])  # type: ignore[attr-defined]


@pytest.mark.parametrize("kind", ["places", "clockwise", "closed", "polar", "german", "columns"])
def test_flat_face_on_measured_points_is_harmonic(tmp_path: Path, kind: str) -> None:
    path, z = tmp_path / "points.csv", PLACES
    if kind == "polar":
        shuffled = np.random.default_rng(1).permutation(z)
        table(path, "Angle [deg],Radius (mm)", zip(np.degrees(np.angle(shuffled)), np.abs(shuffled), strict=True))
    elif kind == "german":
        path.write_text("x;y\n" + "\n".join(f"{p.real:.6f};{p.imag:.6f}".replace(".", ",") for p in z), encoding="utf-8")
    elif kind == "columns":
        table(path, "point\tY\tX", [(1, p.imag, p.real) for p in z], "\t")
    else:
        places(path, z={"places": z, "clockwise": z[::-1], "closed": np.append(z, z[0])}[kind])
    outline = read_outline(path)
    assert outline.ring is not None and outline.numbers["points_off_mm"] < 1e-4
    found = recover(outline.ring, read_follower("translating,shape=flat,at=0"))
    assert found.s == pytest.approx(A + E * np.sin(found.theta), abs=1e-5)


def test_few_points_say_what_they_miss(tmp_path: Path) -> None:
    """An ellipse by 48 points: what is stated is no less than what the curve is really off."""
    turn = np.linspace(0, 2 * np.pi, 48, endpoint=False)
    outline = read_outline(places(tmp_path / "p.csv", z=30 * np.cos(turn) + 8j * np.sin(turn)))
    assert outline.ring is not None
    x, y = outline.ring.points.real, outline.ring.points.imag
    off = np.abs((x / 30) ** 2 + (y / 8) ** 2 - 1) / (2 * np.hypot(x / 900, y / 64))  # to first order
    assert 1e-5 < off.max() <= outline.numbers["points_off_mm"] < 0.2


def test_points_that_scatter_are_told_from_points_that_are_few(tmp_path: Path) -> None:
    turn = np.linspace(0, 2 * np.pi, 720, endpoint=False)
    noise = np.random.default_rng(3).normal(0, 0.01, 720)
    said = read_outline(places(tmp_path / "p.csv", z=(30 + 5 * np.cos(turn) + noise) * np.exp(1j * turn))).remark
    assert 0.0085 < float(said.partition("they scatter by ")[2].partition(" mm")[0]) < 0.0115, said
    square = np.array([max(abs(np.cos(t)), abs(np.sin(t))) for t in turn])
    for few in (PLACES, 30 * np.cos(turn[::15]) + 8j * np.sin(turn[::15]), 20 / square * np.exp(1j * turn)):
        assert "scatter" not in read_outline(places(tmp_path / "p.csv", z=few)).remark


@pytest.mark.parametrize(
    "head, z, words",
    [
        ("1.0,2.0", PLACES, "begins with '1.0,2.0': columns x,y or angle,radius were expected"),
        ("x,y", PLACES[:20], "holds 20 points; 24 at least"),
        ("x,y", PLACES[:250], "a gap of 32.* mm from .*: measure all round"),
        ("x,y", np.full(50, 3 + 3j), "a gap of 0.000 mm throughout"),
        ("angle,radius", -PLACES, "line .*: a radius above 0"),
        ("x,y", np.append(PLACES, complex(np.nan, 1)), "line 362: x and y within"),
        ("x,y", np.append(PLACES, 1e9), "line 362: x and y within"),
    ],
)
def test_wrong_tables_are_told(tmp_path: Path, head: str, z: object, words: str) -> None:
    with pytest.raises(FileError, match=words):
        read_outline(places(tmp_path / "p.csv", head, z))


def test_words_among_numbers_and_no_text(tmp_path: Path) -> None:
    path = places(tmp_path / "p.csv")
    path.write_text(path.read_text(encoding="utf-8") + "end,\n", encoding="utf-8")
    with pytest.raises(FileError, match="line 362: two numbers, x and y, were expected"):
        read_outline(path)
    path.write_bytes(b"\xff\xfe\x00x")
    with pytest.raises(FileError, match="not text in UTF-8"):
        read_outline(path)
    path.write_text("x,y\n" + "1" * 200_000, encoding="utf-8")
    with pytest.raises(FileError, match="no table: field larger"):
        read_outline(path)


def test_points_out_of_order_cross(tmp_path: Path) -> None:
    z = PLACES.copy()
    z[[10, 14]] = z[[14, 10]]
    outline = read_outline(places(tmp_path / "p.csv", z=z))
    assert outline.ring is None and not outline.findings[-1].ok


def test_centres_of_a_probe(tmp_path: Path) -> None:
    """A ball of radius 2 rolled round the disc: its centres lie on a circle of 22; the disc's own motion is recovered."""
    path = places(tmp_path / "p.csv", z=E + (A + 2) * np.exp(1j * np.radians(np.arange(360))))
    outline = read_outline(path, probe=2.0)
    assert outline.ring is not None and outline.ring.area == pytest.approx(np.pi * A**2, rel=1e-6)
    assert "radius of 2 mm is taken off" in outline.remark
    found = recover(outline.ring, read_follower("translating,shape=flat,at=0"))
    assert found.s == pytest.approx(A + E * np.sin(found.theta), abs=1e-5)
    with pytest.raises(FileError, match="a probe of radius 30 mm leaves not one piece"):
        read_outline(path, probe=30.0)
