"""`camgen motion DRIVER --drives DRIVEN`: gears as other programs write them, sound and damaged."""

from __future__ import annotations

import cmath
import csv
import json
import math
import re
import sys
from pathlib import Path

import ezdxf
import numpy as np
import pytest
from click.testing import CliRunner

import camgen
from camgen.cli import cli
from camgen.errors import DesignError, SpecError
from camgen.files.folder import name_of
from camgen.geometry.rings import Ring
from camgen.judge.locking import Lock, locks, ways_back
from camgen.judge.pairs import Jump
from camgen.measuring.drives import Drive, driven_by
from camgen.parts.wheels.ratchet import Pawl, RatchetWheel

sys.path.insert(0, str(Path(__file__).parents[1] / "judge"))
from pair_outlines import Wheel, centre_distance  # noqa: E402

RATIO = ["--ratio", "-12/30"]


def write(path: Path, ring: Ring, bore: float = 0.0) -> Path:
    """A polyline with bulges, and a bore."""
    drawing = ezdxf.new()
    drawing.header["$INSUNITS"] = 4
    space = drawing.modelspace()
    rows = zip(ring.points.tolist(), ring.bulges.tolist(), strict=True)
    space.add_lwpolyline(
        [(z.real, z.imag, 0, 0, bulge) for z, bulge in rows], format="xyseb", close=True
    )
    if bore:
        space.add_circle((0, 0), bore)
    drawing.saveas(path)
    return path


@pytest.fixture(scope="module")
def gears(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """pinion.dxf and wheel.dxf, the latter with a bore of more than half its size."""
    folder = tmp_path_factory.mktemp("gears")
    write(folder / "pinion.dxf", Wheel(2, 12).ring(), 4)
    write(folder / "wheel.dxf", Wheel(2, 30).ring(), 20)
    return folder


def call(folder: Path, *options: str) -> tuple[int, str]:
    """Exit code and what is printed, of the pinion that drives the wheel."""
    pinion = str(folder / "pinion.dxf")
    wheel = str(folder / "wheel.dxf")
    words = ["motion", pinion, "--drives", wheel, "-o", str(folder / "out"), *options]
    result = CliRunner().invoke(cli, words)
    assert result.exception is None or isinstance(result.exception, SystemExit)
    return result.exit_code, result.output


def report(folder: Path) -> dict[str, object]:
    """What was written."""
    text = (folder / "out" / "pinion-drives-wheel" / "report.json").read_text(encoding="utf-8")
    content: dict[str, object] = json.loads(text)
    return content


def test_a_pair_of_gears_is_followed_until_it_repeats(gears: Path) -> None:
    code, text = call(gears, "--distance", "42", *RATIO, "--tolerance", "0.001")
    assert code == 0, text
    with open(gears / "out" / "pinion-drives-wheel" / "motion.csv", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert list(rows[0]) == ["theta_deg", "driven_low_deg", "driven_high_deg"]
    assert len(rows) == 5 * 1440 + 1
    assert float(rows[-1]["theta_deg"]) == 1800
    assert float(rows[-1]["driven_low_deg"]) == pytest.approx(
        float(rows[0]["driven_low_deg"]) - 720, abs=1e-9
    )
    numbers = report(gears)["numbers"]
    assert isinstance(numbers, dict)
    backlash = math.degrees(2 * 0.04 * math.cos(math.radians(20)) / Wheel(2, 30).rb)
    assert numbers["play_least_deg"] == pytest.approx(backlash, rel=2e-3)
    assert numbers["play_most_deg"] == pytest.approx(backlash, rel=2e-3)
    assert 1e-5 < numbers["transmission_error_deg"] < 5e-4
    assert (gears / "out" / "pinion-drives-wheel" / "report.html").exists()


def test_an_error_above_the_tolerance_fails_and_names_the_place(gears: Path) -> None:
    code, text = call(gears, "--distance", "42", *RATIO, "--tolerance", "1e-6")
    assert code == 1
    assert "TRANSMISSION_ERROR" in text and "of the driver's outline" in text


@pytest.mark.long
def test_a_flank_that_is_off_by_20_um_is_seen_at_its_tooth(gears: Path) -> None:
    """Tooth 7 of the wheel, its falling flank thinner: only the bound that it makes changes, while it is in mesh."""
    ring = Wheel(2, 30).ring()
    tooth = len(ring.points) // 30
    rows = slice(7 * tooth + 13, 7 * tooth + 22)
    points = ring.points.copy()
    points[rows] *= np.exp(0.02j / np.abs(points[rows]) * -1)
    damaged = write(gears / "damaged.dxf", Ring(points, ring.bulges))
    sound = camgen.drives(gears / "pinion.dxf", gears / "wheel.dxf", 42.0, ratio=-12 / 30)
    off = camgen.drives(gears / "pinion.dxf", damaged, 42.0, ratio=-12 / 30)
    changes = [
        float(np.max(np.abs(getattr(off, side) - getattr(sound, side)))) * Wheel(2, 30).rb
        for side in ("low", "high")
    ]
    assert max(changes) == pytest.approx(0.02, rel=0.15)
    assert min(changes) < 1e-3
    sound_code, sound_text = call(gears, "--distance", "42", *RATIO, "--tolerance", "0.01")
    assert sound_code == 0, sound_text
    words = [str(gears / "pinion.dxf"), "--drives", str(damaged), "--distance", "42", *RATIO]
    for extra, code in (([], 1), (["--spring", "high"], 1), (["--spring", "low"], 0)):
        options = ["motion", *words, "--tolerance", "0.01", "-o", str(gears / "off"), *extra]
        result = CliRunner().invoke(cli, options)
        assert result.exit_code == code, (extra, result.output)
        told = re.search(
            r"driven outline that is least like .* at ([\d.]+) deg: 0.01[5-9]", result.output
        )
        assert told is not None and float(told[1]) == pytest.approx(7 * 12, abs=6)
        assert "12 teeth of the driver are alike" in result.output
        assert not extra or "BACK_FLANK_ERROR" not in result.output


@pytest.mark.long
@pytest.mark.parametrize(
    "options, code, word",
    [
        (["--distance", "60"], 3, "they never touch"),
        (["--distance", "20"], 3, "overlap at every angle"),
        (["--distance", "-42"], 2, "above 0"),
        (["--distance", "nan"], 2, "above 0"),
        ([], 2, "one of both"),
        (["--distance", "42", "--slides", "0"], 2, "one of both"),
        (["--distance", "42", "--ratio", "nan"], 2, "no ratio"),
        (["--distance", "42", "--ratio", "0"], 2, "other than 0"),
        (["--distance", "42", "--ratio", "-1e308"], 2, "at most 10000"),
        (["--distance", "42", "--ratio", "1e-300"], 2, "1 to 10000"),
        (["--distance", "42", "--tolerance", "0.1"], 2, "--ratio"),
        (["--distance", "42", "--follower", "radius=3"], 2, "--roller or --drives"),
        (["--distance", "42", *RATIO, "--centre", "20"], 2, "no place such as 42/0"),
        (["--distance", "42", "--centre", "nan/0"], 2, "two finite numbers"),
        (["--distance", "42", *RATIO, "--driven-centre", "0/42"], 3, "--driven-centre 0.000/0.000"),
    ],
)
def test_what_cannot_be_is_said(gears: Path, options: list[str], code: int, word: str) -> None:
    found, text = call(gears, *options)
    assert found == code, text
    assert word in text


def test_files_that_hold_no_outline_are_refused(gears: Path) -> None:
    empty = gears / "empty.dxf"
    ezdxf.new().saveas(empty)
    pinion = str(gears / "pinion.dxf")
    for wheel in (empty, gears / "none.dxf"):
        words = ["motion", pinion, "--drives", str(wheel), "--distance", "42"]
        result = CliRunner().invoke(cli, words)
        assert result.exit_code == 4, result.output


def test_pairs_whose_names_differ_in_signs_or_late_letters_have_folders_of_their_own(
    tmp_path: Path,
) -> None:
    """Names that stay as they are; and twelve that a plain cut or a plain replacement would make two of."""
    assert [name_of(Path(name)) for name in ("pinion-12.dxf", "Wheel.STL")] == [
        "pinion-12",
        "wheel",
    ]
    long = "a-very-long-name-of-an-outline-that-somebody-has-exported"
    stems = ["a_L+", "a_L-", "a L", "+", "-", "ä", "ö", long, long + "-2", long[:50], "a.b", "a-b"]
    names = [name_of(Path(f"{stem}.dxf")) for stem in stems]
    assert len(set(names)) == len(stems)
    assert all(re.fullmatch("[a-z0-9]+(-[a-z0-9]+)*", name) and len(name) <= 50 for name in names)


def test_a_wheel_drawn_beside_its_origin_turns_about_the_place_that_is_said(gears: Path) -> None:
    """In inches, 42 mm to the right, as an assembly has it: as if it were drawn about its origin."""
    ring = Wheel(2, 30).ring()
    drawing = ezdxf.new()
    drawing.header["$INSUNITS"] = 1
    rows = zip(((ring.points + 42) / 25.4).tolist(), ring.bulges.tolist(), strict=True)
    drawing.modelspace().add_lwpolyline(
        [(z.real, z.imag, 0, 0, bulge) for z, bulge in rows], format="xyseb", close=True
    )
    drawing.saveas(gears / "beside.dxf")
    with pytest.raises(DesignError, match="driven outline would turn about a place .* 42 mm"):
        camgen.drives(gears / "pinion.dxf", gears / "beside.dxf", 42.0, ratio=-12 / 30)
    place = {"driven_centre": (42.0, 0.0)}
    moved = camgen.drives(gears / "pinion.dxf", gears / "beside.dxf", 42.0, **place)  # type: ignore[arg-type]
    known = camgen.drives(gears / "pinion.dxf", gears / "wheel.dxf", 42.0)
    assert np.allclose(moved.low, known.low, rtol=0, atol=1e-9)
    with pytest.raises(SpecError, match="two numbers"):
        camgen.drives(gears / "pinion.dxf", gears / "wheel.dxf", 42.0, centre=3)  # type: ignore[arg-type]


def test_python_gives_the_same_arrays(gears: Path) -> None:
    driven = camgen.drives(gears / "pinion.dxf", gears / "wheel.dxf", 42.0, ratio=-12 / 30)
    assert driven.free.all() and driven.proven[1:].all()
    assert np.mean(driven.play) == pytest.approx(2.666e-3, rel=1e-3)
    assert driven.transmission_error < 1e-5
    with pytest.raises(camgen.SpecError, match="one of both"):
        camgen.drives(gears / "pinion.dxf", gears / "wheel.dxf")
    with pytest.raises(camgen.SpecError, match="a number"):
        camgen.drives(gears / "pinion.dxf", gears / "wheel.dxf", 42.0, ratio="-12/30")  # type: ignore[arg-type]
    with pytest.raises(TypeError, match="unexpected keyword"):
        camgen.drives(gears / "pinion.dxf", gears / "wheel.dxf", 42.0, sping="low")  # type: ignore[call-arg]


LEAST = (
    0.005  # mm along the line of action, that a sound pair stays below and a damaged one exceeds
)


def errors(pinion: Wheel, wheel: Wheel, driven: Ring | None = None) -> tuple[float, float]:
    """Transmission errors of the pushing and the other flank, mm along the line of action."""
    distance, _ = centre_distance(pinion, wheel)
    drive = Drive(distance, ratio=-pinion.z / wheel.z)
    found = driven_by(pinion.ring(), driven or wheel.ring(), drive)
    assert found.free.all() and found.proven[1:].all()
    return found.transmission_error * wheel.rb, found.back_transmission_error * wheel.rb


def tooth_of(wheel: Wheel, number: int) -> tuple[Ring, slice]:
    """The outline and the rows of one tooth: root, flank, tip, flank."""
    ring = wheel.ring()
    rows = len(ring.points) // wheel.z
    return ring, slice(number * rows, (number + 1) * rows)


@pytest.mark.parametrize("off", [0.01, 0.02, -0.01, -0.02])
@pytest.mark.parametrize("side", ["rising", "falling"])
def test_a_flank_of_one_tooth_that_is_off_is_found_on_its_side(off: float, side: str) -> None:
    """The tooth is thicker by `off`, mm, on one flank, thinner below 0; a thinner one is borne in part by its neighbours."""
    pinion, wheel = Wheel(1.5, 20), Wheel(1.5, 40)
    ring, rows = tooth_of(wheel, 7)
    points = ring.points.copy()
    half = (rows.stop - rows.start) // 2
    own = (
        slice(rows.start + 4, rows.start + half)
        if side == "rising"
        else slice(rows.start + half, rows.stop - 4)
    )
    outwards = -off if side == "rising" else off
    points[own] *= np.exp(1j * outwards / np.abs(points[own]))
    pushing, back = errors(pinion, wheel, Ring(points, ring.bulges))
    assert max(pushing, back) == pytest.approx(abs(off), rel=0.2)
    assert min(pushing, back) < LEAST
    # The driver turns counter-clockwise and pushes the driven tooth's flank that looks counter-clockwise.
    assert (pushing > back) == (side == "falling")


@pytest.mark.parametrize(
    "options", [{"layer": 5}, {"spring": np.ones(2)}, {"inside": np.ones(2)}, {"height": "x"}]
)
def test_options_of_a_wrong_type_are_told(gears: Path, options: dict[str, object]) -> None:
    with pytest.raises(SpecError, match=next(iter(options))):
        camgen.drives(gears / "pinion.dxf", gears / "wheel.dxf", 42, **options)  # type: ignore[arg-type]


def test_keys_that_are_no_text_are_told(gears: Path) -> None:
    with pytest.raises(SpecError):
        camgen.motion(gears / "pinion.dxf", {1: 2})


WHEEL = RatchetWheel(12, 20.0, 17.0, math.radians(10))
FAR, ARM, END = 30.0, 20.0, 0.5
PAWL = Drive(FAR, spring="high", start=math.pi - 1)


def edge_of(wheel: RatchetWheel) -> Ring:
    corners = np.array([complex(piece.at(piece.t0)) for piece in wheel.outline().pieces])
    return Ring(corners, np.zeros(len(corners)))


def pawl_locks(edge: Ring) -> tuple[list[Jump], list[Lock]]:
    """Drops of a pawl with a round end, and the lock behind each."""
    end = Ring(np.array([ARM - END, ARM + END], complex), np.ones(2))
    driven = driven_by(edge, end, PAWL)
    drops = driven.motion.jumps("high")
    return drops, list(locks(driven.motion, drops, "high"))


@pytest.mark.long
def test_a_pawl_locks_where_its_end_lies_in_the_root() -> None:
    """By the triangle of both pivots and the middle of the end in the root, between face and back."""
    drops, found = pawl_locks(edge_of(WHEEL))
    assert len(drops) == 12
    seat = Pawl(WHEEL, complex(FAR), END).seat
    opening = math.acos((FAR**2 + abs(seat) ** 2 - ARM**2) / (2 * FAR * abs(seat)))
    pivot = FAR * cmath.rect(1, cmath.phase(seat) - opening)  # as the wheel sees it
    pawl = Pawl(WHEEL, pivot, END)
    contact = pawl.seat - END * pawl.push
    lever = abs((pawl.push.conjugate() * (pivot - contact)).imag)
    for drop, lock in zip(drops, found, strict=True):
        lost = (drop.theta + cmath.phase(pivot)) % WHEEL.pitch
        assert lock.lost == pytest.approx(lost, abs=1e-7)
        assert lock.draw == pytest.approx(math.asin(lever / abs(pivot - contact)), abs=1e-6)
    assert pawl.draw > 0


def test_the_way_back_is_to_the_next_drop_and_from_the_last_to_the_first_of_the_next_turn() -> None:
    drops = [Jump(1.0, 0.2, 0.1), Jump(2.5, 0.2, 0.1), Jump(4.5, 0.2, 0.1)]
    found = [Lock(0.25, 0.0), Lock(0.5, 0.0), Lock(0.125, 0.0)]
    back = [1.5 + 0.25, 2.0 + 0.5, math.tau - 3.5 + 0.125]
    assert ways_back(drops, found) == pytest.approx(back)


@pytest.mark.long
def test_a_tooth_that_throws_the_pawl_out_loses_a_whole_tooth() -> None:
    """Of one tooth the root lies before the tip, so that its face is a ramp down which the pawl slides."""
    edge = edge_of(WHEEL)
    drops, found = pawl_locks(edge)
    sound = max(ways_back(drops, found))
    assert sound == pytest.approx(WHEEL.pitch + found[0].lost, abs=1e-7)
    damaged = edge.points.copy()
    damaged[int(np.argmin(np.abs(damaged - cmath.rect(17, WHEEL.top))))] *= cmath.exp(-0.3j)
    drops, found = pawl_locks(Ring(damaged, edge.bulges))
    assert len(drops) == 11
    assert max(ways_back(drops, found)) == pytest.approx(sound + WHEEL.pitch, abs=1e-6)


@pytest.mark.long
def test_what_holds_is_told(tmp_path: Path) -> None:
    pinion = write(tmp_path / "wheel.dxf", edge_of(WHEEL))
    end = write(tmp_path / "pawl.dxf", Ring(np.array([ARM - END, ARM + END], complex), np.ones(2)))
    options = ["--distance", "30", "--spring", "high", "--start-deg", "122"]
    words = ["motion", str(pinion), "--drives", str(end), "-o", str(tmp_path), *options]
    result = CliRunner().invoke(cli, words)
    assert result.exit_code == 0, result.output
    text = (tmp_path / "wheel-drives-pawl" / "report.json").read_text(encoding="utf-8")
    numbers = json.loads(text)["numbers"]
    assert numbers["lost_angle_deg"] == pytest.approx(32.7776, abs=1e-3)
    assert numbers["draw_angle_deg"] == pytest.approx(25.1913, abs=1e-3)
    assert "up to a friction of 0.470" in result.output


@pytest.mark.long
def test_a_rack_that_ends_within_a_turn_jumps_without_a_spring(gears: Path) -> None:
    """Three trapezoids of the basic rack: the pinion's next tooth finds none of them."""
    slope = math.tan(math.radians(20))
    tooth = [math.pi / 2 + 2.5 * slope - 2.5j, math.pi / 2 - 2 * slope + 2j]
    tooth = [*tooth, *(-z.conjugate() for z in reversed(tooth))]
    pitch = 2 * math.pi
    points = np.array([k * pitch + 0.99 * z.real + 1j * z.imag for k in (1, 0, -1) for z in tooth])
    back = np.array([-11 - 2.5j, -11 - 9j, 11 - 9j, 11 - 2.5j])
    edge = np.append(points, back) - 12j  # the pitch line touches the pinion's reference circle
    write(gears / "rack.dxf", Ring(edge, np.zeros(len(edge))))
    words = ["motion", str(gears / "pinion.dxf"), "--drives", str(gears / "rack.dxf")]
    result = CliRunner().invoke(cli, [*words, "--slides", "0", "-o", str(gears / "out")])
    assert result.exit_code == 0, result.output
    assert "jumps" in result.output and "locks" not in result.output


def test_a_driven_outline_that_nothing_touches_for_a_while_is_followed() -> None:
    """A pin that goes round a crank pushes an arm of like make once a turn; elsewhere no bound of it is known."""
    circle = np.exp(0.5j * math.pi * np.arange(4))
    pin = Ring(31 + 3 * circle, np.full(4, math.tan(math.pi / 8)))
    driven = driven_by(pin, pin, Drive(distance=60.0, start=math.pi))
    assert np.any(np.isnan(driven.low) & np.isnan(driven.high))
