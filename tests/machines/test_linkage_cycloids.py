"""[[cycloid]]: how disc and output turn, what cannot be, parts, and the drive from its own files, sound and damaged."""

from __future__ import annotations

import cmath
import json
import math
import shutil
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import ezdxf
import numpy as np
import pytest
from judged import drawn, motion_findings, move_outline
from stl_rows import TRIANGLE, with_own_normals

from camgen.errors import DesignError, SpecError
from camgen.findings import Finding
from camgen.machines.follower_motions import follower_motions
from camgen.machines.loads.assess import assess
from camgen.machines.sources import read_mechanism
from camgen.numerics import Floats, Points
from camgen.parts import materials
from camgen.parts.assembly import order_of_assembly

ROW: dict[str, Any] = {
    "crank": "crank",
    "at": "E",
    "disc": "disc",
    "pins": 7,
    "radius": 32,
    "pin_radius": 4,
    "output": "flange",
    "output_pins": 4,
}
SPEC: dict[str, Any] = {
    "mechanism": "linkage",
    "name": "reducer",
    "points": {"O": [0, 0], "E": [1.2, 1.6]},  # an eccentricity of 2 mm, drawn aslant
    "links": {"ground": ["O"], "crank": ["O", "E"], "disc": ["E"], "flange": ["O"]},
    "cycloid": [ROW],
    "drive": {"link": "crank"},
    "parts": {"discs": {"E": 14}, "shaft_diameter": 6},
    "output": [{"name": "out", "link": "flange"}],
}
LOBES = 6
HOLLOW = 32 - 2 - 4.1 - 0.5  # mm, of the disc: farther out is its edge alone
AIR = 0.1  # mm on either side, half of what slides has
DISC, GROUND = (f"reducer-{name}.dxf" for name in ("disc", "ground"))


def machine(**row: Any) -> Any:
    changed = {key: value for key, value in (ROW | row).items() if value is not None}
    return read_mechanism(SPEC | {"cycloid": [changed]})


def test_disc_and_output_turn_back_by_a_lobe_a_turn() -> None:
    """By the pin that the disc rolls off: pins less lobes, over lobes, against the crank."""
    theta = np.linspace(0, math.tau, 9)
    out = machine().solve(theta)["out"]
    assert np.allclose(out - out[0], -theta / LOBES, rtol=0, atol=1e-12)


@pytest.mark.parametrize(
    ("row", "said"),
    [
        ({"crank": "crnk"}, "cycloid.0.crank: .*did you mean 'crank'"),
        ({"disc": "flange"}, "cycloid.0: crank, flange, flange - expected links that differ"),
        ({"at": "O"}, "cycloid.0.at: 'O' - expected a point of crank that is not on its shaft: E"),
        ({"output": None, "output_radius": 20}, "cycloid.0.output_radius - no value here"),
        ({"crank": "disc", "disc": "crank"}, "cycloid.0.crank: .*expected a link that shares"),
        ({"pins": 3}, "cycloid.0.pins"),
    ],
)
def test_a_drive_that_is_none_is_told_by_its_keys(row: dict[str, Any], said: str) -> None:
    with pytest.raises(SpecError, match=said):
        machine(**row)


def test_an_eccentric_without_a_size_is_told_with_one_that_works() -> None:
    """A shaft of 6, off by 2, and a wall of 0.8 on its thin side."""
    with pytest.raises(SpecError, match="parts.discs.E - missing: .* 12 mm or more"):
        read_mechanism(SPEC | {"parts": {"shaft_diameter": 6}})


@pytest.mark.parametrize(
    ("row", "said"),
    [
        (
            {"pin_radius": 14},
            "radius of the pins is 14 mm at cycloid crank to disc, limit: at most 13.88 mm.*smaller pins, or fewer",
        ),
        ({"radius": 13.9}, "times pins over the pins' circle is 1.007.*below 1.986 mm"),
    ],
)
def test_pins_that_meet_and_an_eccentricity_too_large_are_refused(
    row: dict[str, Any], said: str
) -> None:
    with pytest.raises(DesignError, match=said):
        machine(**row).chain  # noqa: B018


def test_a_disc_that_would_be_undercut_is_refused_with_the_largest_pin() -> None:
    """Eleven pins on 40 mm and an eccentricity of 3: 8.936 mm by the closed form of the curvature."""
    row = ROW | {"pins": 11, "radius": 40, "pin_radius": 8.85}
    points = {"O": [0, 0], "E": [1.8, 2.4]}
    said = (
        "radius of a pin with its clearance is 8.95 mm .*limit: at most 8.936.*smaller eccentricity"
    )
    with pytest.raises(DesignError, match=said):
        read_mechanism(SPEC | {"points": points, "cycloid": [row]}).chain  # noqa: B018


@pytest.mark.parametrize(
    ("row", "said"),
    [
        ({"output_pin_radius": 9}, "output_pin_radius of at most"),
        ({"output_radius": 24}, "put the output pins on a circle of"),
        ({"output_pins": 12, "output_pin_radius": 2.5}, "use fewer output_pins"),
    ],
)
def test_holes_that_meet_lobes_or_each_other_are_refused(row: dict[str, Any], said: str) -> None:
    with pytest.raises(DesignError, match=said):
        machine(**row).assembly  # noqa: B018


def test_a_pin_is_pressed_by_the_load_over_its_lever() -> None:
    """All normals meet at the pitch point, e pins from the shaft. The pin whose normal passes farthest from the disc's axis holds it."""
    output = {"output": "out", "value": 0.5}
    tables = {
        "drive": {"link": "crank", "speed_rpm": 10},
        "load": {"friction": 0.0, "on": [output]},
    }
    found = {
        each.where.joint: each
        for each in assess(read_mechanism(SPEC | tables)).findings
        if each.code == "HERTZ"
    }
    n, e, radius, pin = 7, 2.0, 32.0, 4.0
    pressed = []
    for x in np.linspace(0, math.tau / n, 1001):
        pins = radius * np.exp(1j * (x + math.tau * np.arange(n) / n))
        normals = pins - e * n
        normals /= np.abs(normals)
        levers = np.imag(np.conj(pins - e) * normals)
        holds = int(np.argmax(levers))
        t = -(x + math.tau * holds / n) / LOBES + np.array([-1e-3, 0, 1e-3])
        along = radius * np.exp(1j * t) - e * n * np.exp(1j * n * t)
        edge = (
            radius * np.exp(1j * t) - e * np.exp(1j * n * t) - (pin + AIR) * along / np.abs(along)
        )
        ends = edge[[0, 2]] - edge[1]
        across = np.imag(np.conj(-ends[0]) * ends[1])
        bend = 2 * across / abs(np.prod(ends) * (edge[2] - edge[0]))
        pressed.append((1 / pin + bend) / levers[holds])
    own = materials.of("PLA").elastic
    give = 2 * own.compliance * math.pi * 4
    assert found["crank to disc"].measured == pytest.approx(
        math.sqrt(500 * max(pressed) / give), rel=2e-3
    )
    # four pins: of two that are 45 deg off the line that pushes best, one holds
    drive = machine().bodies.layout.cycloid_drives[0].output
    lever = drive.circle * math.cos(math.pi / 4)
    bend = 1 / drive.pin - 1 / (drive.pin + e + AIR)
    assert found["disc to flange"].measured == pytest.approx(
        math.sqrt(500 / lever * bend / give), rel=1e-6
    )


@pytest.mark.long
def test_an_offset_moves_the_air_from_the_flanks(tmp_path: Path) -> None:
    """The drive holds with the gaps of its own disc, and a disc cut without the offset is told with what it is off at a lobe's top."""
    offset = SPEC | {"cycloid": [ROW | {"output": None, "output_pins": 6, "offset": 0.05}]}
    links = {key: value for key, value in SPEC["links"].items() if key != "flange"}
    offset |= {"links": links, "output": [{"name": "out", "link": "disc"}]}
    folder = drawn(offset, tmp_path)
    assert findings(folder)["PIN_TRACK", "crank to disc"].measured < 0.002
    text = (folder / "spec.toml").read_text(encoding="utf-8")
    (folder / "spec.toml").write_text(text.replace("offset = 0.05", "offset = 0.0"), "utf-8")
    track = findings(folder)["PIN_TRACK", "crank to disc"]
    assert not track.ok and track.measured == pytest.approx(0.05, abs=0.002)


def test_output_pins_come_last_from_above() -> None:
    """Through the link that holds them into the disc: before, they would stand loose in holes far wider than they are."""
    steps = {row[1]: row[0] for row in order_of_assembly(machine().assembly).rows}
    said = {row[1]: row[3] for row in order_of_assembly(machine().assembly).rows}
    assert said["output-pin-disc"] == "glued into flange, flush with its upper side"
    assert steps["ring-pin-disc"] < steps["disc"] < steps["flange"] < steps["output-pin-disc"]


def test_all_turns_are_swept_and_nothing_of_it_is_a_cam() -> None:
    reducer = machine()
    assert reducer.assembly.cycle.swept == LOBES
    assert [*follower_motions(reducer)] == []


@pytest.fixture(scope="module")
def sound(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return drawn(SPEC, tmp_path_factory.mktemp("reducer"), ["dxf", "stl"])


@pytest.fixture
def folder(sound: Path, tmp_path: Path) -> Path:
    """A copy to be damaged."""
    return Path(shutil.copytree(sound, tmp_path / "reducer"))


def findings(folder: Path, kind: str = "dxf") -> dict[tuple[str, str], Finding]:
    """What the judge says of the motion that the folder's files of a kind give, by code and joint."""
    return {(each.code, each.where.joint): each for each in motion_findings(folder, 181, kind)}


def plays(x: Floats) -> Floats:
    """Free angle of the disc, (n,) rad, where the eccentric is at -x before the first pin: the exact circle of each pin's centre
    about the disc's axis, cut with the disc's outline grown by the pin, an epitrochoid's parallel."""
    n, radius, e = 7, 32.0, 2.0
    near = np.linspace(-0.15, 0.15, 3001)
    free = []
    for angle in x:
        ways = []
        for k in range(n):
            t = -(angle + math.tau * k / n) / LOBES + near
            trace = radius * np.exp(1j * t) - e * np.exp(1j * n * t)
            along = radius * np.exp(1j * t) - e * n * np.exp(1j * n * t)
            grown = trace - AIR * along / np.abs(along)  # the disc is cut by so much more
            pin = trace[1500]
            off = np.abs(grown) - abs(pin)
            for j in np.flatnonzero(off[:-1] * off[1:] < 0):
                share = off[j] / (off[j] - off[j + 1])
                there = grown[j] + share * (grown[j + 1] - grown[j])
                ways.append(float(np.angle(there / pin)))
        least = min((way for way in ways if way > 0), default=math.nan)
        most = max((way for way in ways if way < 0), default=math.nan)
        free.append(least - most)
    return np.array(free)


@pytest.mark.long
def test_the_play_is_that_of_the_curves(sound: Path) -> None:
    """Of a disc and pins as they are drawn, and never less than 2 delta over the greatest lever of a pin, e z."""
    found = findings(sound)
    numbers = json.loads((sound / "report.json").read_text(encoding="utf-8"))["numbers"]
    joint = "crank_to_disc"
    for figure in ("least_play", "greatest_play", "ripple"):
        designed = numbers[f"{figure}_{joint}_deg"]
        # by the levers before it has turned; an arc 1 um off the curve
        assert numbers[f"{figure}_{joint}_dxf_deg"] == pytest.approx(designed, rel=0.02, abs=0.005)
    contact = found["CONTACT", "crank to disc"]
    assert contact.ok and contact.measured == 100.0
    told = contact.message.split("play ")[1].split(" deg")[0].split(" to ")
    meant = np.degrees(plays(np.arange(0, 360 / 7, 0.5) * math.pi / 180))
    assert meant.min() >= math.degrees(2 * AIR / (2 * LOBES))
    # arcs may lie 1 um off the curve on either side, where 0.1 mm of air is
    assert float(told[0]) == pytest.approx(meant.min(), rel=0.01)
    assert float(told[1]) == pytest.approx(meant.max(), rel=0.01)
    assert all(each.ok for each in found.values())


LOBE = (
    (1.2 + 1.6j) / 2 * np.exp(1j * math.pi / LOBES)
)  # towards a lobe in the disc's axes, beside the drawn eccentric


def grown(by: float) -> Callable[[Points], Points]:
    """One lobe farther out by that much, mm, over half of its width."""

    def change(points: Points) -> Points:
        lobe = np.abs(np.angle(points / LOBE)) < math.pi / LOBES / 2
        return points + by * points / np.abs(points) * lobe

    return change


@pytest.mark.long
@pytest.mark.parametrize("by", [-0.02, 0.02])
@pytest.mark.parametrize("kind", ["dxf", "stl"])
def test_a_lobe_that_is_20_um_off_is_told_with_its_number(
    folder: Path, kind: str, by: float
) -> None:
    """Its highest point is off by all of that along the normal, whichever pin holds the disc."""
    if kind == "dxf":
        move_outline(folder / DISC, grown(by))
    else:
        edit_stl(folder / f"reducer-disc.{kind}", grown(by))
    track = findings(folder, kind)["PIN_TRACK", "crank to disc"]
    assert not track.ok and track.measured == pytest.approx(0.02, abs=0.002)
    assert "at lobe 1: " in track.message


@pytest.mark.long
@pytest.mark.parametrize(
    ("holes", "by", "pin"),
    [
        pytest.param([2], -0.01, 3, id="one pin 10 um inwards"),
        pytest.param(range(7), 0.01, None, id="the circle of pins 10 um larger"),
    ],
)
def test_pins_that_are_10_um_off_are_told(
    folder: Path, holes: Sequence[int], by: float, pin: int | None
) -> None:
    """A pin at a lobe's highest point, or in a hollow, is off by all of that along the normal."""
    drawing = ezdxf.readfile(folder / GROUND)
    ring = ring_of(drawing)
    for k in holes:
        place = complex(*ring[k].dxf.center.vec2)
        ring[k].dxf.center = (
            (place * (1 + by / abs(place))).real,
            (place * (1 + by / abs(place))).imag,
        )
    drawing.saveas(folder / GROUND)
    track = findings(folder)["PIN_TRACK", "crank to disc"]
    assert not track.ok and track.measured == pytest.approx(abs(by), abs=0.001)
    assert pin is None or f"pin {pin} at lobe" in track.message


@pytest.mark.long
def test_an_output_pin_that_is_20_um_thin_is_told(folder: Path) -> None:
    """All of them are made from one file; half of that is off on either side."""
    path = folder / "reducer-output-pin-disc.dxf"
    drawing = ezdxf.readfile(path)
    rim = max(drawing.modelspace().query("CIRCLE"), key=lambda each: each.dxf.radius)
    rim.dxf.radius -= 0.01
    drawing.saveas(path)
    track = findings(folder)["PIN_TRACK", "disc to flange"]
    assert not track.ok and track.measured == pytest.approx(0.01, abs=1e-6)
    assert "in its hole" in track.message


@pytest.mark.long
def test_a_pin_that_is_missing_is_told(folder: Path) -> None:
    drawing = ezdxf.readfile(folder / GROUND)
    drawing.modelspace().delete_entity(ring_of(drawing)[2])
    drawing.saveas(folder / GROUND)
    wrong = [each for each in findings(folder).values() if not each.ok]
    assert any("no eye of" in each.message and "in ground" in each.message for each in wrong)


def ring_of(drawing: Any) -> list[Any]:
    """Holes of the ground for pins, counter-clockwise from the one to which the eccentric points as drawn."""
    first = cmath.phase(1.2 + 1.6j)
    holes = [
        each
        for each in drawing.modelspace().query("CIRCLE")
        if abs(abs(complex(*each.dxf.center.vec2)) - ROW["radius"]) < 0.1
    ]
    assert len(holes) == 7
    return sorted(
        holes,
        key=lambda each: (cmath.phase(complex(*each.dxf.center.vec2)) - first + 0.1) % math.tau,
    )


def edit_stl(path: Path, change: Callable[[Points], Points]) -> None:
    """Give the outer edge of a mesh other points, whatever their heights."""
    data = path.read_bytes()
    triangles = np.frombuffer(data[84:], TRIANGLE).copy()
    corners = triangles["corners"].astype(float)
    points = corners[..., 0] + 1j * corners[..., 1]
    points = np.where(np.abs(points) > HOLLOW, change(points), points)
    corners[..., 0] = points.real
    corners[..., 1] = points.imag
    triangles["corners"] = corners
    path.write_bytes(data[:84] + with_own_normals(triangles).tobytes())
