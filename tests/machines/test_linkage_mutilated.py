"""[[mutilated]] in a linkage: what its spec says, how its wheel turns, and what is made."""

from __future__ import annotations

import copy
import math
from typing import Any

import numpy as np
import pytest

from camgen import load
from camgen.errors import DesignError, SpecError

SPEC: dict[str, Any] = {
    "mechanism": "linkage",
    "name": "steps",
    "points": {"O": [0, 0], "C": [30, 40], "P": [10, 3]},
    "links": {"ground": ["O", "C"], "crank": ["O", "P"], "wheel": ["C"]},
    "drive": {"link": "crank", "speed_rpm": 30},
    "mutilated": [{"a": "crank", "b": "wheel", "teeth": [24, 24], "stations": 4, "name": "mesh"}],
    "output": [{"name": "turn", "link": "wheel"}],
}


def spec(rpm: float = 30, **changes: Any) -> dict[str, Any]:
    """The tables with other keys of their pair."""
    tables = copy.deepcopy(SPEC)
    tables["mutilated"][0] |= changes
    tables["drive"]["speed_rpm"] = rpm
    return tables


@pytest.mark.parametrize("rpm", [30, -30])
def test_the_wheel_stands_as_drawn_and_goes_on_by_a_station(rpm: float) -> None:
    machine = load(spec(rpm))
    theta = np.radians(np.array([-60.0, 0, 60, 300, 360, 420, 720, 1440]))
    turn = np.degrees(np.asarray(machine.solve(theta)["turn"]))
    # theta is the crank's angle, whichever way it is driven; the wheel turns against it, and stands within 60 deg of each turn
    asked = -np.array([0, 0, 0, 90, 90, 90, 180, 360])
    assert np.allclose(turn - turn[1], asked, atol=1e-9)


@pytest.mark.parametrize("rpm", [30, -30])
def test_both_wheels_lie_on_one_level_and_keep_apart(rpm: float) -> None:
    import shapely

    from camgen.geometry.facets import facet_contour

    machine = load(spec(rpm))
    mounts = {mount.part: mount for mount in machine.assembly.mounts}
    wheels = [mounts[f"wheel-mesh-{link}"] for link in ("crank", "wheel")]
    assert wheels[0].z == wheels[1].z
    for angle in np.radians([0.0, 100, 150, 180, 210, 225]) * math.copysign(1, rpm):
        run = machine.solve(np.array([angle]))
        shapes = []
        for mount in wheels:
            edge = machine.assembly.by_name[mount.part].drawn.region.outer
            pose = run.pose(mount.body)
            z = facet_contour(edge, 1e-3)
            z = pose.place + np.exp(1j * pose.angle) * (mount.at + np.exp(1j * mount.angle) * z)
            shapes.append(shapely.Polygon(np.c_[z.real, z.imag]))
        assert shapes[0].intersection(shapes[1]).area == 0
        assert 0.02 < shapes[0].distance(shapes[1]) < 0.2


def test_notes_say_in_which_sense_to_turn_it() -> None:
    for rpm, words in {30: "counter-clockwise only", -30: "clockwise only"}.items():
        assert any(words in note for note in load(spec(rpm)).study().notes)


@pytest.mark.parametrize(
    ("changes", "path", "words"),
    [
        ({"a": "cranck"}, ("mutilated", 0, "a"), "crank"),
        ({"b": "crank"}, ("mutilated", 0, "b"), "another link"),
        ({"b": "ground"}, ("mutilated", 0, "b"), "moves"),
        ({"teeth": [3, 24]}, ("mutilated", 0, "teeth", 0), "5"),
        ({"stations": 0}, ("mutilated", 0, "stations"), "1"),
        ({"name": "wheel"}, ("links", "wheel"), "pair of wheels"),
    ],
)
def test_faults_say_where_and_what(
    changes: dict[str, Any], path: tuple[str | int, ...], words: str
) -> None:
    with pytest.raises(SpecError) as caught:
        load(spec(**changes))
    (fault,) = [each for each in caught.value.faults if tuple(each.path) == path]
    assert words in f"{fault.expected} {fault.nearest}"


def test_gears_that_cannot_be_are_refused_with_what_to_change() -> None:
    with pytest.raises(DesignError, match=r"mutilated mesh.*25 teeth"):
        assert load(spec(stations=5)).assembly
