"""[[noncircular]] in a linkage: what its spec says, how its wheels turn, and what is made."""

from __future__ import annotations

import copy
import math
from typing import Any

import numpy as np
import pytest

import camgen
from camgen import load
from camgen.errors import DesignError, SpecError

SPEC: dict[str, Any] = {
    "mechanism": "linkage",
    "name": "pair",
    "points": {"O": [0, 0], "C": [30, 40], "P": [10, 3]},
    "links": {"ground": ["O", "C"], "crank": ["O", "P"], "wheel": ["C"]},
    "drive": {"link": "crank", "speed_rpm": 60},
    "noncircular": [{"a": "crank", "b": "wheel", "teeth": 25, "eccentricity": 0.3, "name": "mesh"}],
    "output": [{"name": "turn", "link": "wheel"}],
}
THETA = np.linspace(0, math.tau, 73)


def spec(**changes: Any) -> dict[str, Any]:
    """The tables with other keys of their pair; None leaves one out."""
    tables = copy.deepcopy(SPEC)
    pair = tables["noncircular"][0] | changes
    tables["noncircular"] = [{key: value for key, value in pair.items() if value is not None}]
    return tables


def turned(machine: camgen.Mechanism) -> Any:
    """How far the driven wheel has turned against the driver, rad."""
    turn = np.asarray(machine.solve(THETA)["turn"])
    return turn[0] - turn


def test_ellipses_turn_as_kepler_says() -> None:
    expected = 2 * np.unwrap(np.arctan(1.3 / 0.7 * np.tan(THETA / 2)), period=math.pi)
    assert np.allclose(turned(load(SPEC)), expected, atol=1e-9)


def test_waves_turn_as_written() -> None:
    law = spec(eccentricity=None, turns="1/2", teeth=24, sines_deg=[0, -2], cosines_deg=[1])
    expected = np.degrees(THETA) / 2 - 2 * np.sin(2 * THETA) + np.cos(THETA) - 1
    assert np.allclose(np.degrees(turned(load(law))), expected, atol=1e-9)


@pytest.mark.parametrize("start", [0, 40])
def test_rows_turn_within_their_tolerance(start: float) -> None:
    """Of a law that waves are: what is left is rounding, wherever the rows begin."""
    angles = np.arange(start, start + 361, 15.0)
    law = angles + 5 * np.sin(np.radians(angles)) - 2 * np.cos(2 * np.radians(angles)) + 2
    rows = np.column_stack([angles, law]).tolist()
    machine = load(spec(eccentricity=None, points=rows, tolerance_deg=1e-6))
    expected = np.degrees(THETA) + 5 * np.sin(THETA) - 2 * np.cos(2 * THETA) + 2
    assert np.allclose(np.degrees(turned(machine)), expected, atol=1e-6)


def test_both_wheels_lie_on_one_level_with_their_teeth_in_each_other() -> None:
    import shapely

    from camgen.geometry.facets import facet_contour

    machine = load(SPEC)
    mounts = {mount.part: mount for mount in machine.assembly.mounts}
    wheels = [mounts[f"wheel-mesh-{link}"] for link in ("crank", "wheel")]
    assert wheels[0].z == wheels[1].z
    shapes = []
    for mount in wheels:
        edge = machine.assembly.by_name[mount.part].drawn.region.outer
        pose = machine.model.start_of(mount.body)
        z = facet_contour(edge, 1e-3)
        z = pose.place + np.exp(1j * pose.angle) * (mount.at + np.exp(1j * mount.angle) * z)
        shapes.append(shapely.Polygon(np.c_[z.real, z.imag]))
    assert shapes[0].intersection(shapes[1]).area == 0
    assert 0.01 < shapes[0].distance(shapes[1]) < 0.2  # the backlash is the air of what slides
    hulls = [shape.convex_hull for shape in shapes]
    assert hulls[0].intersection(hulls[1]).area > 10


@pytest.mark.parametrize(
    ("changes", "path", "words"),
    [
        ({"a": "cranck"}, ("noncircular", 0, "a"), "crank"),
        ({"b": "crank"}, ("noncircular", 0, "b"), "another link"),
        ({"b": "ground"}, ("noncircular", 0, "b"), "moves"),
        ({"teeth": 3}, ("noncircular", 0, "teeth"), "5"),
        ({"eccentricity": None}, ("noncircular", 0), "one of eccentricity, waves"),
        ({"sines_deg": [1]}, ("noncircular", 0), "one of eccentricity, waves"),
        ({"turns": 2}, ("noncircular", 0, "turns"), "equal ellipses turn alike"),
        ({"name": "wheel"}, ("links", "wheel"), "pair of wheels"),
        (
            {"eccentricity": None, "points": [[0, 0], [90, 80], [180, 180]]},
            ("noncircular", 0, "points"),
            "at least 8 rows",
        ),
        (
            {
                "eccentricity": None,
                "points": [[30 * k, 30 * k + 5 * (k in (3, 4, 8))] for k in range(13)],
            },
            ("noncircular", 0, "tolerance_deg"),
            "a tolerance of at least",
        ),
    ],
)
def test_faults_say_where_and_what(
    changes: dict[str, Any], path: tuple[str | int, ...], words: str
) -> None:
    with pytest.raises(SpecError) as caught:
        load(spec(**changes))
    (fault,) = [each for each in caught.value.faults if tuple(each.path) == path]
    assert words in f"{fault.expected} {fault.nearest}"


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"eccentricity": 0.7}, r"noncircular mesh: the driver bends .* fewer than 17.1"),
        (
            {"eccentricity": None, "sines_deg": [60]},
            r"noncircular mesh: the driven wheel turns back",
        ),
        ({"eccentricity": None, "sines_deg": [0, -15]}, "noncircular mesh: .* hollow"),
        ({"eccentricity": None, "sines_deg": [1], "turns": 2}, "does not close"),
        ({"eccentricity": None, "sines_deg": [1], "turns": "1/3", "teeth": 50}, None),
    ],
)
def test_pairs_that_cannot_be_are_refused_by_what_is_wrong(
    changes: dict[str, Any], words: str | None
) -> None:
    machine = load(spec(**changes))
    if words is None:
        assert machine.assembly
        return
    with pytest.raises(DesignError, match=words):
        assert machine.assembly


def test_a_wheel_without_room_for_its_shaft_is_refused() -> None:
    tables = spec() | {"points": {"O": [0, 0], "C": [12, 0], "P": [10, 3]}}
    with pytest.raises(DesignError, match="noncircular mesh.*put the shafts further apart"):
        assert load(tables).assembly
