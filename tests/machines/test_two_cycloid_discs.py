"""[[cycloid]] with discs = 2: a second disc opposite the first, in the same pins, from its spec and from its own files."""

from __future__ import annotations

import cmath
import math
import shutil
from pathlib import Path
from typing import Any

import ezdxf
import numpy as np
import pytest
import shapely
from judged import drawn, motion_findings, move_outline

from camgen.errors import SpecError
from camgen.findings import Finding
from camgen.geometry.facets import facet_contour
from camgen.geometry.outlines import Contour
from camgen.machine.features import EngagedPair
from camgen.machine.joining import Module
from camgen.machines.sources import read_mechanism
from camgen.numerics import Points
from camgen.parts.assembly import order_of_assembly, renamed

ROW: dict[str, Any] = {
    "crank": "crank",
    "at": "E",
    "disc": "disc",
    "pins": 7,
    "radius": 32,
    "pin_radius": 4,
    "output": "flange",
    "output_pins": 4,
    "discs": 2,
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


@pytest.fixture(scope="module")
def machine() -> Any:
    return read_mechanism(SPEC)


def polygon(contour: Contour, turn: complex, shift: complex) -> Any:
    points = shift + turn * facet_contour(contour, 1e-4)
    return shapely.Polygon(np.c_[points.real, points.imag])


def disc(x: complex, radius: float) -> Any:
    return shapely.Point(x.real, x.imag).buffer(radius, 512)


def test_both_discs_turn_alike_on_opposite_eccentrics(machine: Any) -> None:
    theta = np.linspace(0, math.tau, 9)
    run = machine.solve(theta)
    assert np.allclose(run["out"] - run["out"][0], -theta / LOBES, rtol=0, atol=1e-12)
    crank = machine.model.body("crank").points
    assert crank["E_2"] - crank["O"] == pytest.approx(crank["O"] - crank["E"])


@pytest.mark.long
def test_both_discs_keep_their_air_from_the_same_pins(machine: Any) -> None:
    """Edges and holes as they are made, over a turn, with each disc's axis opposite and its turning by lobes."""
    layout = machine.bodies.layout
    drives = layout.cycloid_drives
    assert [drive.wish.link for drive in drives] == ["disc", "disc_2"]
    pins = [disc(stud.at, 4) for stud in drives[0].pins]
    output = [(stud.at, stud.radius) for stud in drives[0].output_pins]
    flange = machine.model.start_of("flange")
    for theta in np.linspace(0, math.tau, 25)[:-1]:
        for sign, drive in zip((1, -1), drives, strict=True):
            link = drive.wish.link
            turn = cmath.exp(1j * (machine.model.start_of(link).angle - theta / LOBES))
            centre = sign * (1.2 + 1.6j) * cmath.exp(1j * theta)
            edge, *holes = drive.contours()
            shape = polygon(edge, turn, centre)
            least = min(shape.distance(pin) for pin in pins)
            assert least == pytest.approx(AIR, abs=2e-3)
            with_flange = cmath.exp(1j * (flange.angle - theta / LOBES))
            for at, radius in output:
                pin = disc(flange.place + with_flange * at, radius)
                around = [polygon(hole, turn, centre) for hole in holes]
                (hole,) = [each for each in around if each.contains(pin)]
                assert hole.exterior.distance(pin) == pytest.approx(AIR, abs=2e-3)


def pull(machine: Any) -> float:
    """First moment of the crank and the discs about the shaft as drawn, g mm: over it all that turns with the crank pulls the shaft."""
    moment = 0j
    for name in ("crank", "disc", "disc_2"):
        if name in {body.name for body in machine.model.bodies}:
            body = machine.model.body(name)
            pose = machine.model.start_of(name)
            centre = pose.place + cmath.exp(1j * pose.angle) * complex(body.centre)
            moment += 1e3 * body.mass * centre
    return abs(moment)


def test_together_they_pull_no_shaft_aside(machine: Any) -> None:
    """Less than a twentieth of what one disc and its crank pull is left: the keeper over the upper eccentric is beside the shaft."""
    one = read_mechanism(SPEC | {"cycloid": [ROW | {"discs": 1}]})
    discs = [machine.model.body(name).mass for name in ("disc", "disc_2")]
    assert discs[1] == pytest.approx(discs[0], rel=1e-3)
    assert pull(machine) < pull(one) / 20


def test_the_second_eccentric_holds_down_the_first_disc(machine: Any) -> None:
    made = machine.assembly
    heights = {mount.part: mount.z for mount in made.mounts}
    thick = {part.name: part.thickness for part in made.parts}
    assert heights["disc"] + thick["disc"] < heights["eccentric-disc_2"]
    assert heights["eccentric-disc_2"] < heights["disc_2"] + thick["disc_2"]
    assert heights["disc_2"] + thick["disc_2"] < heights["keeper-1"]
    steps = {row[1]: row[0] for row in order_of_assembly(made).rows}
    assert steps["disc"] < steps["eccentric-disc_2"] < steps["keeper-1"] < steps["flange"]
    assert steps["disc"] < steps["disc_2"] < steps["keeper-1"]
    counts = [mount.part for mount in made.mounts]
    assert counts.count("ring-pin-disc") == 7 and counts.count("output-pin-disc") == 4


def test_a_second_disc_of_another_machine_keeps_its_pair(machine: Any) -> None:
    """Under the names that it has there: what turns the output by the second disc is said by no joint."""
    made = renamed(machine.assembly, Module("guest", phase=0.3))
    (pair,) = [
        each for each in made.features if isinstance(each, EngagedPair) and each.implied is not None
    ]
    bodies = {body.name for body in made.machine.bodies}
    assert {pair.implied.cam, pair.implied.follower, pair.carrier} <= bodies
    assert pair.joint == pair.implied.name and "guest" in pair.joint


def test_a_given_eccentricity_holds_for_both() -> None:
    crank = read_mechanism(SPEC | {"lengths": {"O-E": 1.5}}).model.body("crank").points
    assert abs(crank["E"] - crank["O"]) == pytest.approx(1.5)
    assert crank["E_2"] - crank["O"] == pytest.approx(crank["O"] - crank["E"])


def test_two_drives_on_one_crank_are_told_the_key() -> None:
    row = ROW | {"discs": 1, "at": "F", "disc": "other", "output": None, "output_pins": 6}
    tables = SPEC | {
        "points": SPEC["points"] | {"F": [-1.2, -1.6]},
        "links": SPEC["links"] | {"crank": ["O", "E", "F"], "other": ["F"]},
        "cycloid": [ROW | {"discs": 1}, row],
        "parts": {"discs": {"E": 14, "F": 14}, "shaft_diameter": 6},
    }
    with pytest.raises(SpecError, match=r"cycloid.1.crank.*discs = 2 of one \[\[cycloid\]\]"):
        read_mechanism(tables)


@pytest.mark.parametrize(
    ("tables", "said"),
    [
        ({"points": {"O": [0, 0], "E": [1.2, 1.6], "E_2": [9, 9]}}, "points.E_2 .*another name"),
        ({"links": SPEC["links"] | {"disc_2": ["E"]}}, "links.disc_2 .*another name"),
        ({"cycloid": [ROW | {"discs": 3}]}, "cycloid.0.discs"),
        (
            {"cycloid": [ROW | {"at": "O"}]},
            "cycloid.0.at: 'O' - expected a point of crank that is not on its shaft",
        ),
    ],
)
def test_what_leaves_no_place_for_a_second_disc_is_told(tables: dict[str, Any], said: str) -> None:
    with pytest.raises(SpecError, match=said):
        read_mechanism(SPEC | tables)


@pytest.fixture(scope="module")
def sound(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return drawn(SPEC, tmp_path_factory.mktemp("reducer"))


@pytest.fixture
def folder(sound: Path, tmp_path: Path) -> Path:
    """A copy to be damaged."""
    return Path(shutil.copytree(sound, tmp_path / "reducer"))


def findings(folder: Path) -> dict[tuple[str, str], Finding]:
    return {(each.code, each.where.joint): each for each in motion_findings(folder, 181, "dxf")}


def file_of(folder: Path, part: str) -> Path:
    return next(folder.rglob(f"reducer-{part}.dxf"))


@pytest.mark.long
def test_each_disc_is_followed_from_its_own_file(sound: Path) -> None:
    found = findings(sound)
    assert all(each.ok for each in found.values())
    for joint in ("crank to disc", "crank to disc_2", "disc to flange", "disc_2 to flange"):
        assert found["CONTACT", joint].measured == 100.0
        assert found["PIN_TRACK", joint].measured < 0.002


@pytest.mark.long
def test_a_lobe_of_the_second_disc_that_is_20_um_off_is_told(folder: Path) -> None:
    """And of none but the second."""

    def change(points: Points) -> Points:
        top = np.abs(points).argmax()
        lobe = np.abs(np.angle(points / points[top])) < math.pi / LOBES / 2
        return points + 0.02 * points / np.abs(points) * lobe

    move_outline(file_of(folder, "disc_2"), change)
    found = findings(folder)
    track = found["PIN_TRACK", "crank to disc_2"]
    assert not track.ok and track.measured == pytest.approx(0.02, abs=0.002)
    assert found["PIN_TRACK", "crank to disc"].ok


@pytest.mark.long
def test_a_hole_of_the_second_disc_that_is_off_is_told(folder: Path) -> None:
    path = file_of(folder, "disc_2")
    drawing = ezdxf.readfile(path)
    circles = drawing.modelspace().query("CIRCLE")
    hole = max(circles, key=lambda each: abs(complex(*each.dxf.center.vec2)))
    hole.dxf.center = hole.dxf.center + ezdxf.math.Vec3(0.05, 0, 0)
    drawing.saveas(path)
    found = findings(folder)
    track = found["PIN_TRACK", "disc_2 to flange"]
    assert not track.ok and track.measured == pytest.approx(0.05, abs=0.003)
    assert found["PIN_TRACK", "disc to flange"].ok


@pytest.mark.long
def test_a_second_eccentric_that_is_off_is_told(folder: Path) -> None:
    """Its rim 40 um further out: the disc that turns on it is as far off its pins."""
    path = file_of(folder, "eccentric-disc_2")
    drawing = ezdxf.readfile(path)
    rim = max(drawing.modelspace().query("CIRCLE"), key=lambda each: each.dxf.radius)
    away = complex(*rim.dxf.center.vec2)
    moved = away * (1 + 0.04 / abs(away))
    rim.dxf.center = (moved.real, moved.imag, 0)
    drawing.saveas(path)
    track = findings(folder)["PIN_TRACK", "crank to disc_2"]
    assert not track.ok and track.measured == pytest.approx(0.04, abs=0.003)


@pytest.mark.long
def test_the_first_disc_in_the_second_one_s_place_jams(folder: Path) -> None:
    """It has not turned back by half a lobe."""
    turn = np.exp(1j * math.pi / LOBES)
    move_outline(file_of(folder, "disc_2"), lambda points: points * turn)
    contact = findings(folder)["CONTACT", "crank to disc_2"]
    assert not contact.ok and "disc_2" in contact.message
