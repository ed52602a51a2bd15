"""[[cycloid]]: how disc and output turn, what cannot be, parts, and the drive from its own files, sound and damaged."""

from __future__ import annotations

import math
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import ezdxf
import numpy as np
import pytest
from judged import move_outline

import camgen
from camgen.errors import DesignError, SpecError
from camgen.findings import Finding
from camgen.machines.sources import read_mechanism
from camgen.numerics import Points
from camgen.pipeline.case import Case
from camgen.pipeline.reading import judge_motion, judge_part

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
        ({"at": "O"}, "cycloid.0.at: 'O' - expected a point of crank beside its shaft: E"),
        ({"output": None, "output_radius": 20}, "cycloid.0.output_radius - nothing here"),
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
            "radius of the pins is 14 mm at cycloid crank to disc, limit 13.8843 mm.*smaller pins, or fewer",
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
    said = "radius of a pin with its air is 8.95 mm .*limit 8.93553.*smaller eccentricity"
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


@pytest.fixture(scope="module")
def sound(tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("reducer")
    report = camgen.build(SPEC, out, ["dxf"])
    assert report.ok, [str(finding) for finding in report.findings if not finding.ok]
    return out / "reducer"


def findings(folder: Path) -> dict[tuple[str, str], Finding]:
    """What the judge says of the motion that the folder's drawings give, by code and joint."""
    case = Case(read_mechanism(folder / "spec.toml"), folder)
    shapes = {name: judge_part(case, name, ["dxf"], dimensioned=False)[1] for name in case.parts}
    result = judge_motion(case.mechanism, "dxf", shapes, np.linspace(0, math.tau, 181))
    assert result is not None
    return {(each.code, each.where.joint): each for each in result[0].findings}


def damaged(
    folder: Path, to: Path, change: Callable[[Points], Points], file: str
) -> dict[tuple[str, str], Finding]:
    shutil.copytree(folder, to / "reducer")
    move_outline(to / "reducer" / file, change)
    return findings(to / "reducer")


def test_the_play_lies_between_the_bounds_of_the_pins_levers(sound: Path) -> None:
    """2 delta over the lever of the pin that pushes: e z at most, and never less than that of a pin a sixth of a turn off."""
    found = findings(sound)
    contact = found["CONTACT", "crank to disc"]
    assert contact.ok and contact.measured == 100.0
    plays = contact.message.split("play ")[1].split(" deg")[0].split(" to ")
    least = math.degrees(2 * AIR / (2 * LOBES))
    assert least * 0.998 < float(plays[0]) < float(plays[1]) < least * 1.15
    assert found["CONTACT", "disc to flange"].ok


def test_a_lobe_that_is_20_um_too_thick_is_told_and_the_disc_named(
    sound: Path, tmp_path: Path
) -> None:
    turn = (1.2 + 1.6j) / 2

    def thicker(points: Points) -> Points:
        level = points / turn
        lobe = np.abs(np.angle(level * np.exp(-1j * math.pi / LOBES))) < math.pi / LOBES / 2
        return points + 0.02 * points / np.abs(points) * lobe

    gap = damaged(sound, tmp_path, thicker, DISC)["PIN_GAP", "crank to disc"]
    assert not gap.ok and 0.004 < gap.measured < 0.0205
    assert "disc" in gap.message


def test_a_pin_whose_hole_is_10_um_off_is_told(sound: Path, tmp_path: Path) -> None:
    shutil.copytree(sound, tmp_path / "reducer")
    path = next((tmp_path / "reducer").rglob(GROUND))
    drawing = ezdxf.readfile(path)
    holes = [each for each in drawing.modelspace().query("CIRCLE") if _on_ring(each)]
    assert len(holes) == 7
    hole = holes[2]
    place = complex(*hole.dxf.center.vec2)
    inwards = place * (1 - 0.01 / abs(place))
    hole.dxf.center = (inwards.real, inwards.imag)
    drawing.saveas(path)
    gap = findings(tmp_path / "reducer")["PIN_GAP", "crank to disc"]
    assert not gap.ok and 0.0025 < gap.measured < 0.0105


def test_a_pin_that_is_missing_is_told(sound: Path, tmp_path: Path) -> None:
    shutil.copytree(sound, tmp_path / "reducer")
    path = next((tmp_path / "reducer").rglob(GROUND))
    drawing = ezdxf.readfile(path)
    holes = [each for each in drawing.modelspace().query("CIRCLE") if _on_ring(each)]
    drawing.modelspace().delete_entity(holes[2])
    drawing.saveas(path)
    found = findings(tmp_path / "reducer")
    assert not all(each.ok for each in found.values())
    assert any("ground" in each.message for each in found.values() if not each.ok)


def _on_ring(circle: Any) -> bool:
    return abs(abs(complex(*circle.dxf.center.vec2)) - ROW["radius"]) < 0.1
