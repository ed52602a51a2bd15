"""Scans of printed parts: what is read off pictures of an exactly known part, and pictures that hold none."""

from __future__ import annotations

import json
import struct
import sys
import zlib
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from scans import FOLLOWER, Glass, apart, cam, saved

from camgen.cli import main
from camgen.errors import FileError
from camgen.geometry.rings import Floats, Points
from camgen.judge.follower_table import read_follower
from camgen.measuring.motion import recover
from camgen.measuring.outlines import Hints, Outline, read_outline
from camgen.measuring.scan import Scanning, read_scan

COARSE = Glass(dpi=150)


def ring(centre: complex, radius: float) -> Points:
    return np.asarray(centre + radius * np.exp(2j * np.pi * np.arange(720) / 720))


DISC = (ring(5, 20), ring(0, 3))


SCANNING = Scanning()


def moved(path: Path, how: Scanning = SCANNING) -> Floats:
    return moved_by(read_outline(path, Hints(scanning=how)))


def moved_by(outline: Outline) -> Floats:
    assert outline.ring is not None and all(finding.ok for finding in outline.findings)
    return recover(outline.ring, read_follower(FOLLOWER)).s


# ---- one scan --------------------------------------------------------------------------------------------------------


@pytest.mark.long
@pytest.mark.parametrize(
    "glass", [Glass(turn_deg=1), Glass(noise=4, light=0.3, turn_deg=31, ground=70, part=220)]
)
def test_motion_from_one_scan_at_true_scale(tmp_path: Path, glass: Glass) -> None:
    edges, wanted = cam()
    assert apart(moved(saved(tmp_path / "cam.png", edges, glass)), wanted) < 0.012


@pytest.mark.long
def test_a_scanner_that_is_wrong_is_seen_to_be(tmp_path: Path) -> None:
    edges, wanted = cam()
    assert (
        apart(
            moved(saved(tmp_path / "cam.png", edges, Glass(dpi=300, turn_deg=1, across=1.003))),
            wanted,
        )
        > 0.05
    )


@pytest.mark.parametrize("ending", ["png", "jpg", "tiff", "tif"])
def test_outline_and_holes_of_a_disc(tmp_path: Path, ending: str) -> None:
    path = saved(tmp_path / f"disc.{ending}", DISC, Glass(dpi=300))
    outline = read_outline(path)
    assert outline.ring is not None
    off = np.abs(np.abs(outline.ring.points - 5) - 20)
    assert off.max() < 0.02 and outline.ring.area == pytest.approx(np.pi * 400, rel=2e-4)
    assert outline.numbers["bore_mm"] == pytest.approx(6, abs=0.006)
    assert {each.code for each in outline.findings if each.ok} == {
        "CONTOUR",
        "CONTRAST",
        "SELF_CROSSING",
    }


@pytest.mark.long
def test_deep_and_coloured_pictures(tmp_path: Path) -> None:
    grey = np.asarray(Image.open(saved(tmp_path / "disc.png", DISC, COARSE)))
    Image.fromarray(grey.astype(np.uint16) * 257).save(tmp_path / "deep.tiff")
    Image.fromarray(np.stack([grey] * 3, axis=2)).save(tmp_path / "colour.png")
    wanted = read_scan(tmp_path / "disc.png", 150)
    for name in ("deep.tiff", "colour.png"):
        found = read_scan(tmp_path / name, 150)
        assert found.outer == pytest.approx(wanted.outer, abs=1e-9), name


@pytest.mark.long
def test_a_bump_at_the_seam_stays(tmp_path: Path) -> None:
    """0.2 mm high, 1 mm wide."""
    angle = np.linspace(0, 2 * np.pi, 20000, endpoint=False)
    bump = 0.2 * np.exp(-((20 * (angle - 1)) ** 2) / (2 * 0.3**2))
    seam = (np.asarray((20 + bump) * np.exp(1j * angle)), ring(0, 3))
    outline = read_outline(saved(tmp_path / "seam.png", seam, Glass()))
    assert outline.ring is not None
    radius = np.abs(outline.ring.points)
    assert radius.max() - np.median(radius) == pytest.approx(0.2, abs=0.015)


def test_command_line_states_the_uncertainty(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = saved(tmp_path / "disc.png", DISC, COARSE)
    arguments = [
        "motion",
        str(path),
        "--dpi",
        "150",
        "--follower",
        "translating,radius=6",
        "-o",
        str(tmp_path),
    ]
    with pytest.raises(SystemExit) as done:
        main([*arguments, "--json"])
    numbers = json.loads(capsys.readouterr().out)["numbers"]
    assert not done.value.code
    assert numbers["stroke_mm"] == pytest.approx(10, abs=0.03)
    assert 0.01 < numbers["edge_level_off_mm"] < 0.2
    assert numbers["edge_level_in_motion_mm"] >= numbers["edge_level_off_mm"]


def test_width_by_a_caliper_sets_the_scale(tmp_path: Path) -> None:
    path = saved(tmp_path / "disc.png", DISC, replace(COARSE, across=1.01, down=1.01))
    outline = read_outline(path, Hints(scanning=Scanning(across=40.0)))
    assert outline.ring is not None
    assert outline.ring.area == pytest.approx(np.pi * 400, rel=2e-3)
    assert outline.numbers["scale_percent"] == pytest.approx(1, abs=0.1)


# ---- several scans ---------------------------------------------------------------------------------------------------

SKEW = {"across": 1.003, "shear": np.tan(np.radians(1.0))}


def several(
    folder: Path, *glasses: Glass, edges: tuple[Points, ...] | None = None
) -> tuple[Path, tuple[Path, ...]]:
    first, *rest = [
        saved(folder / f"scan{i}.png", edges or cam()[0], replace(glass, seed=i))
        for i, glass in enumerate(glasses)
    ]
    return first, tuple(rest)


@pytest.mark.long
def test_two_scans_and_a_caliper_undo_the_scanner(tmp_path: Path) -> None:
    """One axis 0.3 % long and 1 deg of skew; the caliper reads the true cam."""
    edges, wanted = cam()
    first, others = several(
        tmp_path, Glass(dpi=450, turn_deg=1, **SKEW), Glass(dpi=450, turn_deg=91.3, **SKEW)
    )
    width = max(float(np.abs(edges[0] - z).max()) for z in edges[0])
    outline = read_outline(first, Hints(scanning=Scanning(others=others)))
    assert outline.ring is not None
    # what turns the plane is left out: the symmetric part of [1.003, 1.003 tan 1 deg; 0, 1] without its scale
    stretch, shear = SKEW["across"], SKEW["across"] * SKEW["shear"]
    root = np.linalg.eigh(np.array([[stretch**2 + shear**2, shear], [shear, 1.0]]))
    true = root[1] @ np.diag(np.sqrt(root[0])) @ root[1].T
    share = 100 / np.trace(true) * 2
    assert outline.numbers["scanner_across_percent"] == pytest.approx(
        (true[0, 0] - true[1, 1]) * share, abs=0.01
    )
    assert outline.numbers["scanner_shear_percent"] == pytest.approx(
        2 * true[0, 1] * share, abs=0.01
    )
    assert "scanner_off_mm" in outline.numbers, "its common scale is still unknown"
    assert apart(moved(first), wanted) > 0.1
    known = read_outline(first, Hints(scanning=Scanning(others=others, across=width)))
    assert apart(moved_by(known), wanted) < 0.012
    assert "scanner_off_mm" not in known.numbers


@pytest.mark.long
def test_scans_that_lie_alike_tell_nothing_of_the_scanner(tmp_path: Path) -> None:
    first, others = several(
        tmp_path, *(Glass(dpi=150, turn_deg=turn, **SKEW) for turn in (0, 3, 180))
    )
    outline = read_outline(first, Hints(scanning=Scanning(others=others)))
    assert "they do not show the scanner's scale" in outline.remark
    assert "scanner_across_percent" not in outline.numbers


@pytest.mark.long
def test_three_scans_drop_dust_and_keep_a_bump(tmp_path: Path) -> None:
    angle = np.linspace(0, 2 * np.pi, 20000, endpoint=False)
    bump = 0.2 * np.exp(-((20 * (angle - 1)) ** 2) / (2 * 0.3**2))
    # an oval, so that its turn is known
    body = (20 + 2 * np.cos(2 * angle)) * np.exp(1j * angle)
    seam = (np.asarray(body + bump * np.exp(1j * angle)), ring(0, 3))
    first, others = several(
        tmp_path, *(Glass(dpi=600, specks=800, turn_deg=turn) for turn in (0, 2, 5)), edges=seam
    )
    errors = []
    for how in (Scanning(), Scanning(others=others)):
        outline = read_outline(first, Hints(scanning=how))
        assert outline.ring is not None
        z = outline.ring.points
        off = np.abs(z) - np.interp(
            np.angle(z) % (2 * np.pi), angle, np.abs(seam[0]), period=2 * np.pi
        )
        errors.append(float(np.abs(off).max()))
        near = np.abs(np.angle(z * np.exp(-1j))) < 0.003
        assert np.median(np.abs(z[near])) - np.abs(body[3183]) == pytest.approx(0.2, abs=0.02)
    assert errors[0] > 0.04 > 0.02 > errors[1]


@pytest.mark.long
def test_another_part_or_its_other_face_is_told(tmp_path: Path) -> None:
    edges = cam()[0]
    first = saved(tmp_path / "a.png", edges, COARSE)
    Image.fromarray(np.asarray(Image.open(first))[:, ::-1]).save(tmp_path / "b.png", dpi=(150, 150))
    with pytest.raises(
        FileError, match=r"b.png: does not show the part of a.png, or its other face"
    ):
        read_outline(first, Hints(scanning=Scanning(others=(tmp_path / "b.png",))))


# ---- pictures that are wrong -----------------------------------------------------------------------------------------


def written(make: Callable[[Path], object], name: str = "bad.png") -> Callable[[Path], Path]:
    def write(folder: Path) -> Path:
        make(folder / name)
        return folder / name

    return write


def picture(
    glass: Glass = COARSE,
    *,
    edges: tuple[Points, ...] = DISC,
    cut: int = 0,
    twice: bool = False,
    mode: str = "L",
    dpi: object = (150, 150),
) -> Callable[[Path], Path]:
    def make(path: Path) -> None:
        saved(path, edges, glass)
        grey = np.asarray(Image.open(path))[:, cut:]
        image = Image.fromarray(np.hstack([grey, grey]) if twice else grey).convert(mode)
        image.save(path, **({"dpi": dpi} if dpi else {}))  # type: ignore[arg-type]

    return written(make)


def huge_tiff(path: Path) -> None:
    """A header that speaks of 60000 x 60000 pixels, 3.6 GB, before a file of a few bytes."""
    entries = [
        (256, 4, 1, 60000),
        (257, 4, 1, 60000),
        (258, 3, 1, 8),
        (259, 3, 1, 1),
        (262, 3, 1, 1),
        (273, 4, 1, 8),
        (277, 3, 1, 1),
        (278, 4, 1, 60000),
        (279, 4, 1, 3_600_000_000),
    ]
    body = b"".join(struct.pack("<HHII", *entry) for entry in entries)
    path.write_bytes(struct.pack("<4sIH", b"II*\0", 8, len(entries)) + body + bytes(1000))


def huge_png(path: Path) -> None:
    """A header that speaks of 100000 x 100000 pixels, before a megabyte of them packed in a kilobyte."""

    def chunk(kind: bytes, data: bytes) -> bytes:
        return (
            struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
        )

    head, data = (
        struct.pack(">IIBBBBB", 100_000, 100_000, 8, 0, 0, 0, 0),
        zlib.compress(bytes(1_000_000)),
    )
    path.write_bytes(
        b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", data) + chunk(b"IEND", b"")
    )


def large_png(path: Path) -> None:
    Image.new("1", (7000, 7000)).save(path)


@pytest.mark.parametrize(
    "make, words",
    [
        (
            picture(replace(COARSE, part=190)),
            "by 3. of 255 grey levels; at least 50 were expected: lay a sheet",
        ),
        (picture(cut=60), "frame cuts off: leave a margin"),
        (picture(twice=True), "shows 2 parts: scan one at a time"),
        (picture(edges=DISC[:1]), "shows no bore, 0 holes, none of them round: take its shaft out"),
        (
            picture(edges=(DISC[0], np.array([-3, 3, 3 + 2j, -3 + 2j]))),
            "shows no bore, 1 hole, none of them round",
        ),
        (picture(mode="1"), "only black and white: scan in grey levels"),
        (picture(dpi=None), "does not say how many dots per inch it has: give them with --dpi"),
        (picture(dpi=(150, 300)), "150 dots per inch across and 300 down"),
        (picture(dpi=(3, 3)), "3 dots per inch; 50 to 9600 are taken"),
        (
            written(lambda path: Image.new("L", (300, 300), 128).save(path, dpi=(150, 150))),
            "shows no part",
        ),
        (
            written(lambda path: Image.new("L", (30, 300), 128).save(path, dpi=(150, 150))),
            "too few for a part",
        ),
        (
            written(lambda path: path.write_bytes(b"\x89PNG\r\n\x1a\n" + bytes(90))),
            "no picture that can be read",
        ),
        (
            written(lambda path: path.write_text("solid", encoding="utf-8")),
            "no picture that can be read",
        ),
        (written(huge_tiff, "bad.tif"), "60000 x 60000 pixels; at most 40 million are read"),
        (written(huge_png), "100000 x 100000 pixels; at most 40 million are read"),
        (written(large_png), "7000 x 7000 pixels; at most 40 million are read"),
    ],
)
def test_wrong_pictures_are_told(tmp_path: Path, make: Callable[[Path], Path], words: str) -> None:
    with pytest.raises(FileError, match=words):
        read_outline(make(tmp_path))


def test_cut_short_and_named_wrongly(tmp_path: Path) -> None:
    path = saved(tmp_path / "disc.png", DISC, COARSE)
    content = path.read_bytes()
    (tmp_path / "disc.jpg").write_bytes(content)
    with pytest.raises(FileError, match="looks like PNG"):
        read_outline(tmp_path / "disc.jpg")
    path.write_bytes(content[: len(content) // 2])
    with pytest.raises(FileError, match="read"):
        read_outline(path)


def test_packages_that_are_not_there(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = saved(tmp_path / "disc.png", DISC, COARSE)
    monkeypatch.setitem(sys.modules, "contourpy", None)
    with pytest.raises(FileError, match=r'pip install ".+\[scan\]"'):
        read_outline(path)
