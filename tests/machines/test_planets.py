"""[[planets]]: turns by Willis, what cannot be assembled, parts, and the set from its own files, sound and damaged."""

from __future__ import annotations

import cmath
import math
from collections.abc import Callable
from itertools import combinations
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from judged import drawn, motion_findings, moved_copy

from camgen.errors import DesignError, SpecError
from camgen.findings import Finding
from camgen.geometry.facets import facet_contour
from camgen.machines.sources import read_mechanism
from camgen.numerics import Points

SUN, PLANET, RING = 12, 18, 48
SET = {"sun": "sun", "carrier": "carrier", "at": "P", "count": 3, "teeth": [SUN, PLANET]}
SPEC: dict[str, Any] = {
    "mechanism": "linkage",
    "name": "set",
    "points": {"O": [0, 0], "P": [24, 0]},
    "links": {"ground": ["O"], "sun": ["O"], "carrier": ["O", "P"]},
    "planets": [SET],
    "drive": {"link": "sun"},
    "output": [{"name": "out", "link": "carrier"}],
}
FIXED_CARRIER = SPEC | {
    "links": {"ground": ["O", "P"], "sun": ["O"], "ring": ["O"]},
    "planets": [{**SET, "carrier": None, "ring": "ring", "fixed": "carrier"}],
    "output": [{"name": "out", "link": "ring"}],
}
FIXED_SUN = SPEC | {
    "links": {"ground": ["O"], "ring": ["O"], "carrier": ["O", "P"]},
    "planets": [{**SET, "sun": None, "ring": "ring", "fixed": "sun", "teeth": [24, 15]}],
    "drive": {"link": "carrier"},
    "output": [{"name": "out", "link": "ring"}],
}


def machine(spec: dict[str, Any], **row: Any) -> Any:
    changed = {key: value for key, value in (spec["planets"][0] | row).items() if value is not None}
    return read_mechanism(spec | {"planets": [changed]})


@pytest.mark.parametrize(
    ("spec", "rate"),
    [
        (SPEC, 1 / (1 + RING / SUN)),
        (FIXED_CARRIER, -SUN / RING),
        (FIXED_SUN, 1 + 24 / 54),
    ],
)
def test_members_turn_as_willis_has_it(spec: dict[str, Any], rate: float) -> None:
    """(sun - carrier) / (ring - carrier) = - ring's teeth over the sun's."""
    theta = np.linspace(0, math.tau, 9)
    out = machine(spec).solve(theta)["out"]
    assert np.allclose(out - out[0], rate * theta, rtol=0, atol=1e-12)


@pytest.mark.parametrize(
    ("row", "said"),
    [
        ({"count": 7}, "planets.0.count: 7 - expected 1 or 2 or 3 or 4 .*a sun of 17 teeth"),
        ({"count": 7, "teeth": [400, 17]}, "planets.0.count: 7 .*; or a sun of 396 teeth"),
        ({"ring": "sun"}, 'planets.0.ring: .*fixed = "ring" is the ground'),
        ({"carrier": None}, "planets.0.carrier - missing"),
        ({"carrier": "sun"}, "planets.0: sun, sun - expected links that differ"),
        ({"sun": "snu"}, "planets.0.sun: .*did you mean 'sun'"),
        ({"at": "O"}, "planets.0.at: 'O' - expected a point beside O"),
        ({"at": "Q"}, "planets.0.at: 'Q' - expected a point of carrier"),
    ],
)
def test_a_set_that_is_none_is_told_by_its_keys(row: dict[str, Any], said: str) -> None:
    with pytest.raises(SpecError, match=said):
        machine(SPEC, **row)


def test_names_of_planets_are_theirs() -> None:
    spec = SPEC | {"links": SPEC["links"] | {"planet_2": ["O"]}}
    with pytest.raises(SpecError, match="links.planet_2 - another name"):
        machine(spec)
    spec = SPEC | {"points": SPEC["points"] | {"P_3": [1, 1]}}
    with pytest.raises(SpecError, match="points.P_3 - another name"):
        machine(spec)


def test_planets_that_meet_are_refused_with_how_many_fit() -> None:
    """12, 24 and 60 teeth: four stand 25.46 modules apart, and are 26 wide; three 31.18."""
    with pytest.raises(DesignError, match=r"4 planets .*33.9\d* mm .*planets.count = 3"):
        machine(SPEC, teeth=[12, 24], count=4).assembly  # noqa: B018


def test_a_sun_that_stands_still_and_is_too_small_for_its_dowels_is_refused() -> None:
    with pytest.raises(DesignError, match=r"room for dowels .*4.4 mm .*larger sun"):
        machine(FIXED_SUN, teeth=[12, 18]).assembly  # noqa: B018


@pytest.mark.parametrize(
    ("driven", "out", "over"), [("carrier", "ring", ["cap-carrier"]), ("ring", "carrier", [])]
)
def test_a_sun_stands_on_the_plate_and_its_ring_hangs_past_the_carrier(
    driven: str, out: str, over: list[str]
) -> None:
    """The plate of either that turns lies over the planets; the shaft of the one that drives goes through the sun."""
    spec = FIXED_SUN | {"drive": {"link": driven}, "output": [{"name": "out", "link": out}]}
    assembly = machine(spec).assembly
    mounts = {each.part: each for each in assembly.mounts}
    parts = assembly.by_name
    top = {name: mounts[name].z + parts[name].thickness for name in mounts if name in parts}
    sun = mounts["gear-planet-sun"]
    assert (sun.body, sun.z) == ("ground", parts["ground"].thickness)
    assert mounts["gear-planet-ring"].body == "ring"
    assert top["gear-planet-ring"] == pytest.approx(mounts["ring"].z)
    assert top["gear-planet"] < mounts["carrier"].z < top["carrier"] < mounts["ring"].z
    assert [name for name in parts if name.startswith("cap-")] == over
    assert mounts["shaft"].body == driven and mounts["shaft"].z < 0
    dowels = [each for each in assembly.mounts if each.part == "dowel-gear-planet-sun"]
    assert len(dowels) == 3 and all(each.body == "ground" for each in dowels)


def test_a_length_says_how_far_planets_are_from_the_axis() -> None:
    spec = SPEC | {"points": {"O": [1, 2], "P": [1, 20]}, "lengths": {"P-O": 24.0}}
    points = machine(spec).chain.body("carrier").points
    pins = [points[name] for name in ("P", "P_2", "P_3")]
    assert np.allclose(np.abs(np.array(pins) - points["O"]), 24.0, rtol=0, atol=1e-12)


@pytest.mark.long
@pytest.mark.parametrize(
    ("spec", "row"),
    [
        (SPEC, {}),
        (FIXED_CARRIER, {}),
        (FIXED_SUN, {}),
        (SPEC, {"teeth": [12, 17], "spacing": "nearest"}),
    ],
)
def test_all_teeth_lie_in_gaps_as_drawn_and_as_they_move(
    spec: dict[str, Any], row: dict[str, Any]
) -> None:
    """By polygons of all wheels where the assembly has them: none overlap, and each pair is in mesh."""
    import shapely

    assembly = machine(spec, **row).assembly
    poses = assembly.poses(np.array([0.0, 1.0, 4.0]))
    wheels = [each for each in assembly.parts if each.name.startswith("gear-")]
    for k in range(3):
        shapes = {}
        for part in wheels:
            inside = part.name.endswith("ring")
            region = part.drawn.region
            edge = max(region.holes, key=lambda hole: abs(hole.area)) if inside else region.outer
            points = facet_contour(edge, 1e-3)
            for n, pose in enumerate(poses[part.name]):
                z = pose.place[k] + cmath.exp(1j * pose.angle[k]) * points
                shape = shapely.Polygon(np.column_stack([z.real, z.imag]))
                whole = shapely.Point(0, 0).buffer(80, 64)
                shapes[part.name, n] = whole - shape if inside else shape
        for one, other in combinations(shapes.values(), 2):
            assert one.intersection(other).area < 1e-6
        planets = [shape for (name, _), shape in shapes.items() if name == "gear-planet"]
        for planet in planets:
            others = [shape for (name, _), shape in shapes.items() if name != "gear-planet"]
            assert all(planet.distance(each) < 0.2 for each in others)


def test_planets_are_one_part_and_a_cap_holds_the_carrier() -> None:
    assembly = machine(SPEC).assembly
    counts = {part.name: part.count for part in assembly.parts}
    assert counts["gear-planet"] == 3 and counts["gear-planet-ring"] == counts["cap-sun"] == 1
    tops = {each.part: each.z + assembly.by_name[each.part].thickness for each in assembly.mounts}
    cap = next(each for each in assembly.mounts if each.part == "cap-sun")
    assert cap.z > tops["carrier"] > tops["gear-planet"]
    ring = next(each for each in assembly.mounts if each.part == "gear-planet-ring")
    assert (ring.body, ring.z) == ("ground", assembly.by_name["ground"].thickness)
    assert assembly.cycle.turns == assembly.cycle.swept == 5


def test_the_report_says_ratio_contact_ratios_and_where_uneven_planets_are() -> None:
    study = machine(SPEC, teeth=[12, 17], spacing="nearest").study()
    assert study.numbers["ratio_planet"] == pytest.approx(1 + 46 / 12)
    assert 1.2 < study.numbers["contact_ratio_sun_to_planet_1"] < 1.4
    assert 1.6 < study.numbers["contact_ratio_planet_1_to_ground"] < 1.8
    notes = " ".join(study.notes)
    assert "4.83333 times for one turn of the carrier, the same way" in notes
    assert "at 0.00, 117.93, 242.07 deg" in notes  # multiples of 360 / 58


@pytest.fixture(scope="module")
def sound(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return drawn(SPEC, tmp_path_factory.mktemp("set"))


def judged(folder: Path) -> list[Finding]:
    """What the judge says of the folder's drawings."""
    return motion_findings(folder, 9)


def damaged(folder: Path, to: Path, part: str, change: Callable[[Points], Points]) -> list[Finding]:
    """The set with other points of a part's teeth."""
    copy = moved_copy(folder, to, f"set-{part}.dxf", change)
    return [each for each in judged(copy) if not each.ok]


@pytest.mark.long
def test_the_set_closes_on_its_files_with_a_carrier_that_moves(sound: Path) -> None:
    every = judged(sound)
    assert sum(each.code == "GEAR_MESH" for each in every) == 2
    findings = {each.code: each for each in every}
    assert all(each.ok for each in findings.values())
    assert findings["MOTION_ERROR"].measured < 1e-6
    # both meshes' backlash at the pitch circles, 0.2 mm each, and the pins' play, seen from the carrier
    assert 0.3 < findings["LASH"].measured < 0.7


@pytest.mark.long
def test_a_planet_s_flank_that_is_off_shows_in_both_meshes(sound: Path, tmp_path: Path) -> None:
    """By 20 um of tooth 4, whose middle is at 80 deg of the part: against the sun and in the ring."""

    def flank(points: Points) -> Points:
        radius = np.abs(points)
        turned = points * cmath.exp(-1j * math.radians(80))
        off = (np.angle(turned) > 0) & (np.angle(turned) < 0.9 * math.pi / PLANET)
        off &= radius > radius.min() + 0.4 * np.ptp(radius)
        return points * np.where(off, np.exp(0.02j / radius), 1)

    failed = [each for each in damaged(sound, tmp_path, "gear-planet", flank)]
    meshes = [each for each in failed if each.code == "GEAR_MESH"]
    assert meshes and all("is at 80.0 deg of gear-planet" in each.message for each in meshes)


@pytest.mark.long
def test_a_ring_beside_the_axis_is_told(sound: Path, tmp_path: Path) -> None:
    failed = damaged(sound, tmp_path, "gear-planet-ring", lambda points: points + 0.01)
    (mesh,) = [each for each in failed if each.code == "GEAR_MESH"]
    assert mesh.where.joint == "planet_1 to ground"
    assert mesh.measured == pytest.approx(0.02, rel=0.25)


@pytest.mark.long
def test_a_tooth_of_the_sun_that_is_missing_is_named(sound: Path, tmp_path: Path) -> None:
    def broken(points: Points) -> Points:
        radius = np.abs(points)
        off = np.abs(np.angle(points * cmath.exp(-1j * math.radians(60)))) < 0.9 * math.pi / SUN
        return points * np.where(off, radius.min() / radius, 1)

    failed = damaged(sound, tmp_path, "gear-planet-sun", broken)
    (mesh,) = [each for each in failed if each.code == "GEAR_MESH"]
    assert "is at 60.0 deg of gear-planet-sun" in mesh.message


@pytest.fixture(scope="module")
def still_sun(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """One planet: the set is the least that shows a sun on the plate."""
    spec = FIXED_SUN | {"planets": [FIXED_SUN["planets"][0] | {"count": 1}]}
    return drawn(spec, tmp_path_factory.mktemp("still"))


@pytest.mark.long
def test_a_sun_on_the_plate_is_judged_with_its_planets(still_sun: Path, tmp_path: Path) -> None:
    """Sound as it is; beside the axis by 10 um, or with a flank of 20 um, it is named."""
    findings = {each.code: each for each in judged(still_sun)}
    assert all(each.ok for each in findings.values())
    assert findings["MOTION_ERROR"].measured < 1e-6

    def flank(points: Points) -> Points:
        turned = points * cmath.exp(-1j * math.radians(30))
        angle = np.angle(turned)
        off = (angle > 0) & (angle < 0.9 * math.pi / 24) & (np.abs(points) > 14)
        return points * np.where(off, np.exp(0.02j / np.abs(points)), 1)

    for change in (lambda points: points + 0.01, flank):
        copy = tmp_path / change.__name__.strip("<>")
        failed = damaged(still_sun, copy, "gear-planet-sun", change)
        meshes = [each for each in failed if each.code == "GEAR_MESH"]
        assert meshes and meshes[0].where.joint == "ground to planet_1"
    assert "is at 30.0 deg of gear-planet-sun" in meshes[0].message
