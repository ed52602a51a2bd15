"""Measured points round a disc, of which the motion is known in closed form, and tables that are wrong."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from camgen.errors import FileError
from camgen.files.views import polar_table
from camgen.geometry.facets import facet_contour
from camgen.judge.follower_table import read_follower
from camgen.machines.sources import read_mechanism
from camgen.measuring.motion import recover
from camgen.measuring.outlines import Hints, read_outline
from camgen.measuring.points import read_points

# disc, off centre
A = 20.0
E = 5.0
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
        table(
            path,
            "Angle [deg],Radius (mm)",
            zip(np.degrees(np.angle(shuffled)), np.abs(shuffled), strict=True),
        )
    elif kind == "german":
        path.write_text(
            "x;y\n" + "\n".join(f"{p.real:.6f};{p.imag:.6f}".replace(".", ",") for p in z),
            encoding="utf-8",
        )
    elif kind == "columns":
        table(path, "point\tY\tX", [(1, p.imag, p.real) for p in z], "\t")
    else:
        places(path, z={"places": z, "clockwise": z[::-1], "closed": np.append(z, z[0])}[kind])
    outline = read_outline(path)
    assert outline.ring is not None and outline.numbers["points_off_mm"] < 1e-4
    found = recover(outline.ring, read_follower("translating,shape=flat,at=0"))
    assert found.s == pytest.approx(A + E * np.sin(found.theta), abs=1e-5)


def lens(radius: float, half: float, count: int, shift: float) -> np.ndarray:
    """Points of a lens of two arcs whose tips are at -half and half on x, evenly along them, from so far behind a tip on."""
    centre = np.sqrt(radius**2 - half**2)
    turn = 2 * np.arcsin(half / radius)
    way = (np.arange(2 * count) + shift) * turn / count
    upper, angle = way < turn, np.mod(way, turn) - turn / 2
    arc = radius * np.exp(1j * (np.pi / 2 - angle)) - 1j * centre  # from left to right over the top
    return np.asarray(np.where(upper, arc, -arc))


@pytest.mark.long
@settings(max_examples=60, deadline=None)
@given(
    radius=st.floats(20, 60),
    share=st.floats(0.3, 0.97),
    count=st.integers(40, 200),
    shift=st.one_of(st.just(0.0), st.floats(0.01, 0.99)),
)
def test_a_sharp_tip_is_no_part_of_a_spline(
    radius: float, share: float, count: int, shift: float
) -> None:
    """A lens of two arcs: wherever its points lie, the curve lies on the arcs and reaches both tips."""
    half = share * radius
    z = lens(radius, half, count, shift)
    rows = "\n".join(f"{p.real:.9f},{p.imag:.9f}" for p in z)
    ring, off, said = read_points(Path("lens.csv"), f"x,y\n{rows}\n".encode())
    assert "2 sharp corners" in said
    centre = np.sqrt(radius**2 - half**2)
    missed = np.abs(
        np.abs(
            np.where(ring.points.imag >= 0, ring.points + 1j * centre, ring.points - 1j * centre)
        )
        - radius
    )
    step = 2 * np.arcsin(share) / count  # of an arc, rad; a cubic drawn on misses its fourth power
    assert missed.max() < 2 * radius * step**4 + 2e-6
    assert min(np.abs(ring.points - half)) < 2 * radius * step**4 / np.sin(np.arcsin(share)) + 2e-6
    assert off < radius * step  # at most what is left out between two points


@pytest.mark.parametrize("digits", [3, 6])
def test_the_tip_of_a_swing_cam_from_its_points(digits: int) -> None:
    """Its sharp reversal leaves a tip of 26 deg: one spline through it all was off by 0.007 to 0.05 mm there."""
    exact = read_mechanism(
        Path(__file__).parents[2] / "specs" / "uniform-swing.toml", ()
    ).cam.outline  # type: ignore[attr-defined]
    fine = facet_contour(exact.counter_clockwise(), 1e-5)
    tip = fine[np.argmax(np.abs(fine))]
    for step in (0.25, 0.5):
        rows = "\n".join(
            f"{angle:.6f},{radius:.{digits}f}" for angle, radius in polar_table(exact, step)
        )
        ring, _, _ = read_points(Path("p.csv"), f"angle,radius\n{rows}\n".encode())
        near = ring.points[np.abs(ring.points - tip) < 4]
        edges = shapely.LinearRing(np.column_stack([fine.real, fine.imag]))
        off = shapely.distance(edges, shapely.points(near.real, near.imag)).max()
        borne = (
            1e-4 if digits == 6 else 8 * 0.0005
        )  # a cubic drawn on over a span takes eight times what points are rounded by
        assert off < borne and min(abs(near - tip)) < borne / math.sin(math.radians(13))


def test_a_small_rounding_is_no_corner() -> None:
    """A square with edges of 40 mm rounded by 2 mm, a point every 0.2 mm: ten points go round each rounding."""
    edge, bend = np.arange(-18, 18, 0.2), np.radians(np.arange(0, 90, 90 / 16))
    side = np.concatenate([20 + 1j * edge, 18 + 18j + 2 * np.exp(1j * bend)])
    z = np.concatenate([side * 1j**k for k in range(4)])
    _, _, said = read_points(
        Path("p.csv"), ("x,y\n" + "\n".join(f"{p.real:.6f},{p.imag:.6f}" for p in z)).encode()
    )
    assert "sharp" not in said


def test_points_are_one_contour(tmp_path: Path) -> None:
    path = places(tmp_path / "p.csv")
    assert read_outline(path, contour=1).ring is not None
    with pytest.raises(FileError, match="holds 1 closed contour: there is no contour=7"):
        read_outline(path, contour=7)


def test_few_points_say_what_they_miss(tmp_path: Path) -> None:
    """An ellipse by 48 points: what is stated is no less than what the curve is really off."""
    turn = np.linspace(0, 2 * np.pi, 48, endpoint=False)
    outline = read_outline(places(tmp_path / "p.csv", z=30 * np.cos(turn) + 8j * np.sin(turn)))
    assert outline.ring is not None
    x, y = outline.ring.points.real, outline.ring.points.imag
    off = np.abs((x / 30) ** 2 + (y / 8) ** 2 - 1) / (
        2 * np.hypot(x / 900, y / 64)
    )  # to first order
    assert 1e-5 < off.max() <= outline.numbers["points_off_mm"] < 0.2


def test_points_that_scatter_are_told_from_points_that_are_few(tmp_path: Path) -> None:
    turn = np.linspace(0, 2 * np.pi, 720, endpoint=False)
    noise = np.random.default_rng(3).normal(0, 0.01, 720)
    said = read_outline(
        places(tmp_path / "p.csv", z=(30 + 5 * np.cos(turn) + noise) * np.exp(1j * turn))
    ).remark
    assert 0.0085 < float(said.partition("they scatter by ")[2].partition(" mm")[0]) < 0.0115, said
    square = np.array([max(abs(np.cos(t)), abs(np.sin(t))) for t in turn])
    for few in (
        PLACES,
        30 * np.cos(turn[::15]) + 8j * np.sin(turn[::15]),
        20 / square * np.exp(1j * turn),
    ):
        assert "scatter" not in read_outline(places(tmp_path / "p.csv", z=few)).remark


@pytest.mark.parametrize(
    "head, z, words",
    [
        ("1.0,2.0", PLACES, "begins with '1.0,2.0': columns x,y or angle,radius were expected"),
        ("x,y", PLACES[:20], "holds 20 points; at least 24 "),
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
    outline = read_outline(path, Hints(probe=2.0))
    assert outline.ring is not None and outline.ring.area == pytest.approx(np.pi * A**2, rel=1e-6)
    assert "radius of 2 mm is taken off" in outline.remark
    found = recover(outline.ring, read_follower("translating,shape=flat,at=0"))
    assert found.s == pytest.approx(A + E * np.sin(found.theta), abs=1e-5)
    with pytest.raises(FileError, match="not one piece without a probe's radius of 30 mm"):
        read_outline(path, Hints(probe=30.0))
