"""The machine as pixels: each pixel shows the nearest triangle, solids are as large as they are, a turn comes back to its start."""

from __future__ import annotations

import io
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from PIL import Image

import camgen
from camgen.files.folder import read_manifest
from camgen.files.gltf import Shape, Track
from camgen.geometry.mesh import Mesh
from camgen.machine.features import PartPose
from camgen.report.animation import Animation, Body
from camgen.report.render import bands, film, nearest, picture

SPECS = Path(__file__).resolve().parent.parent.parent / "specs"
SIZE = (12, 16)
THETA = np.linspace(0, math.tau, 120, endpoint=False)
CORNERS = np.array([[x, y, z] for x in (0, 40) for y in (0, 20) for z in (0, 10)], float)
BOX = Mesh(
    CORNERS,
    np.array([[0, 2, 6], [0, 6, 4], [1, 5, 7], [1, 7, 3], [0, 4, 5], [0, 5, 1]]
             + [[2, 3, 7], [2, 7, 6], [0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5]]),
)  # fmt: skip
EYE = np.array([0.55, -1.0, 0.9]) / np.linalg.norm([0.55, -1.0, 0.9])


def shown(angle: np.ndarray, place: np.ndarray) -> tuple[list[Shape], list[Track], Animation]:
    """A box that moves."""
    track = Track("box", angle, place, [("box-1", 0, np.eye(3, 4))])
    body = Body("box", [PartPose(place, angle)])
    return [Shape("box", BOX, "#4080c0")], [track], Animation(THETA, [body])


def pixels(data: bytes) -> np.ndarray:
    return np.asarray(Image.open(io.BytesIO(data)).convert("RGB"), int)


@settings(max_examples=60, deadline=None)
@given(st.lists(st.lists(st.integers(-40, 240), min_size=9, max_size=9), min_size=1, max_size=5))
def test_each_pixel_shows_the_nearest_triangle(rows: list[list[int]]) -> None:
    # a seventh of a pixel and a bit: no edge goes through a pixel's centre
    corners = np.array(rows, float).reshape(-1, 3, 3) / 7 + [0.0123, 0.0234, 0]
    a, b = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    area = a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]
    corners, a, b, area = (each[np.abs(area) > 1e-3] for each in (corners, a, b, area))
    normal = np.cross(a, b)
    index, depth = nearest(corners, -normal[:, :2] / normal[:, 2:], SIZE)
    for y in range(SIZE[0]):
        for x in range(SIZE[1]):
            w = np.array([x + 0.5, y + 0.5]) - corners[:, 0, :2]
            s = (w[:, 0] * b[:, 1] - w[:, 1] * b[:, 0]) / area
            t = (a[:, 0] * w[:, 1] - a[:, 1] * w[:, 0]) / area
            z = np.where((s > 0) & (t > 0) & (s + t < 1), corners[:, 0, 2] + s * a[:, 2] + t * b[:, 2], -np.inf)  # fmt: skip
            assert depth[y, x] == pytest.approx(z.max(initial=-np.inf), abs=1e-6)
            assert (index[y, x] >= 0) == bool(np.isfinite(z.max(initial=-np.inf)))
            if index[y, x] >= 0:
                assert z[index[y, x]] == pytest.approx(z.max(), abs=1e-6)


def test_bands_are_closed_solids_of_their_size() -> None:
    corners = bands([np.array([0, 30 + 0j])], [(50 + 0j, 5.0)], 2.0, 8.0)
    volume = np.sum(np.cross(corners[:, 0], corners[:, 1]) * corners[:, 2]) / 6
    disc = 48 / 2 * 25 * math.sin(math.tau / 48)
    assert volume == pytest.approx(6 * (30 * 4 + disc))  # the arm is 0.4 of the disc's width
    flat = bands([np.array([0, 3j, 4 + 3j])], (), 5.0, 5.0)
    assert np.all(flat[:, :, 2] == 5)
    area = np.cross(flat[:, 1] - flat[:, 0], flat[:, 2] - flat[:, 0])[:, 2].sum() / 2
    assert area == pytest.approx(0.8 * 7)


@pytest.mark.long
def test_a_box_covers_what_its_faces_do() -> None:
    seen = pixels(picture(*shown(np.zeros(120), np.zeros(120, complex))))
    covered = np.count_nonzero((seen < 250).any(axis=2))
    area = EYE @ [20 * 10, -40 * 10, 40 * 20]  # of the three faces that look at the eye
    right = np.cross([0, 0, 1], EYE)
    wide = np.abs(right / np.linalg.norm(right)) @ [40, 20, 10]
    columns = np.flatnonzero((seen < 250).any(axis=(0, 2)))
    scale = (columns[-1] - columns[0] + 1) / wide
    assert covered == pytest.approx(area * scale**2, rel=0.01)
    assert columns[0] > 10 and seen.shape[1] - columns[-1] > 10
    top, front, side = (seen[(seen == colour).all(axis=2)] for colour in common_colours(seen))
    assert len(top) > len(front) > len(side)


def test_what_is_up_is_up_in_the_picture() -> None:
    """A box 40 by 20 by 10 that stands on its smallest side is the highest, on its largest the lowest."""
    up = math.sqrt(1 - EYE[2] ** 2)  # share of a height that is seen from the eye
    for down, high, wide, deep in (((-1.0, 0.0, 0.0), 40, 20, 10), ((0.0, 0.0, -1.0), 10, 40, 20)):
        seen = pixels(picture(*shown(np.zeros(120), np.zeros(120, complex)), down))
        drawn = (seen < 250).any(axis=2)
        rows, columns = (np.flatnonzero(drawn.any(axis=k)) for k in (1, 0))
        height = up * high + EYE[2] * (np.abs(EYE[:2]) / up @ [wide, deep])
        width = np.abs([EYE[1], EYE[0]]) / up @ [wide, deep]
        assert np.ptp(rows) / np.ptp(columns) == pytest.approx(height / width, rel=0.01)


def common_colours(seen: np.ndarray) -> list[np.ndarray]:
    """The three that are seen most, but white."""
    packed, counts = np.unique(seen @ [65536, 256, 1], return_counts=True)
    colours = [np.array([k >> 16, k >> 8 & 255, k & 255]) for k in packed[np.argsort(-counts)]]
    return [colour for colour in colours[:5] if colour.min() < 250][:3]


@pytest.mark.long
def test_a_turn_is_sixty_frames() -> None:
    image = Image.open(io.BytesIO(film(*shown(THETA, np.zeros(120, complex)))))
    assert image.n_frames == 60 and image.info["loop"] == 0  # type: ignore[attr-defined]
    assert 3500 <= 60 * image.info["duration"] <= 4500
    image.seek(15)  # a quarter of a turn: as if it stood there
    quarter = np.asarray(image.convert("RGB"), int)
    start = pixels(film(*shown(np.roll(THETA, -30), np.zeros(120, complex))))
    assert np.mean(np.abs(quarter - start)) < 1.0


@pytest.mark.long
def test_what_does_not_move_is_one_picture_and_what_cannot_go_is_left_out() -> None:
    still = shown(np.zeros(120), np.zeros(120, complex))
    assert Image.open(io.BytesIO(film(*still))).n_frames == 1  # type: ignore[attr-defined]
    lost = np.where(THETA > 3, np.nan, THETA)
    image = Image.open(io.BytesIO(film(*shown(lost, np.zeros(120, complex)))))
    image.seek(image.n_frames - 1)  # type: ignore[attr-defined]
    assert np.asarray(image.convert("RGB")).min() > 250


@pytest.mark.long
def test_behind_a_ghost_things_are_seen() -> None:
    shapes, tracks, animation = shown(np.zeros(120), np.zeros(120, complex))
    rests = [PartPose(np.zeros(120, complex), np.zeros(120))]
    cover = Body("cover", rests, circles=[(20 + 10j, 60.0)], heights=(20.0, 30.0))
    both = replace(animation, bodies=[*animation.bodies, cover])
    alone = pixels(picture(shapes, [], both))
    both = pixels(picture(shapes, tracks, both))
    assert alone.shape == both.shape  # the cover is larger than the box
    through = (alone != both).any(axis=2)
    paper = (alone == 255).all(axis=2)
    assert through.any() and not through[paper].any()
    assert np.all(both[through].mean(axis=0) < alone[through].mean(axis=0))


def test_a_body_in_a_plane_that_stands_is_drawn_where_a_part_of_its_shape_stands() -> None:
    """Its x is -y of the machine, its y is z, and its heights count against x; it turns and moves in that plane."""
    still = np.zeros(120, complex)
    shapes, tracks, animation = shown(np.zeros(120), still)
    turn = np.full(120, math.pi / 2)
    pose = PartPose(np.full(120, 5 + 30j), turn)
    bar = Body("bar", [pose], [], [np.array([0j, 40 + 0j])], [], None, (-70.0, -60.0), True)
    ghost = pixels(picture(shapes, [], replace(animation, bodies=[bar])))
    # turned by a quarter it points along z: 0.8 wide about y = -5, from z = 30 to 70 and x = 60 to 70
    corners = CORNERS / CORNERS.max(axis=0) * [10, 0.8, 40] + [60, -5.4, 30]
    shape = Shape("box", Mesh(corners, BOX.faces), "#808080")
    rests = Track("box", np.zeros(120), still, [("box-1", 0, np.eye(3, 4))])
    part = pixels(picture([shape], [rests], replace(animation, bodies=[])))
    assert ghost.shape == part.shape
    seen = [(image < 250).any(axis=2) for image in (ghost, part)]
    assert seen[1].sum() > 1000
    assert (seen[0] != seen[1]).sum() < 0.02 * seen[1].sum()


@pytest.mark.long
def test_pictures_are_built_listed_and_checked(tmp_path: Path) -> None:
    report = camgen.build(SPECS / "disc-cam.toml", tmp_path, only="picture,animation")
    folder = tmp_path / "disc-cam"
    data = {kind: folder / f"disc-cam-{kind}" for kind in ("picture.png", "animation.gif")}
    assert report.ok and not list(folder.glob("*.dxf"))
    assert data["animation.gif"].stat().st_size < 1_000_000
    manifest = read_manifest(folder)
    assert {path.name for path in data.values()} <= set(manifest["files"])
    assert "pillow" in manifest["packages"]
    path = data["animation.gif"]
    path.write_bytes(path.read_bytes()[:-1] + b"x")
    # what is made anew has the same bytes: REBUILD holds
    failed = [each for each in camgen.check(folder).findings if not each.ok]
    assert [each.code for each in failed] == ["MANIFEST"] and path.name in failed[0].message
