"""What a linkage has for shafts that pass through a pivot: discs of the ground; pins turned of steel, three screws, a counterweight
under the plate."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from camgen.errors import DesignError, SpecError
from camgen.machine.features import PinEyes
from camgen.machines.linkage.mechanism import Linkage
from camgen.machines.loads.assess import assess
from camgen.spec import validate

# A drag link: both cranks go all the way round pivots 9 mm apart.
DRAG: dict[str, Any] = {
    "mechanism": "linkage",
    "name": "drag",
    "points": {"O": [0, 0], "C": [9, 0], "A": [30, 0], "B": [27, 22], "P": [60, 40]},
    "links": {
        "ground": ["O", "C", "P"],
        "crank": ["O", "A"],
        "coupler": ["A", "B"],
        "output": ["C", "B"],
    },
    "lengths": {"A-B": 19, "C-B": 30},
    "drive": {"link": "crank", "speed_rpm": 300},
    "output": [{"name": "out", "link": "output"}],
}


def drag(**tables: Any) -> Linkage:
    tables["parts"] = {"discs": {"C": 30}, **tables.get("parts", {})}
    return validate(Linkage, {**DRAG, **tables})


def test_a_shaft_passes_a_disc_of_the_ground() -> None:
    made = drag(layers={"output": 1, "crank": 2, "coupler": 3}).assembly
    pivot, dowel = made.by_name["pivot-C"], made.by_name["dowel"]
    assert dowel.count == 2 and dowel.thickness == pytest.approx(5 + pivot.thickness)
    # the strap turns on the first level, the crank lies on both
    floor = {name: made.poses(np.zeros(1))[name][0].z for name in ("pivot-C", "output", "crank")}
    assert floor == pytest.approx({"pivot-C": 5, "output": 5.2, "crank": 5.4 + 4})
    assert floor["pivot-C"] + pivot.thickness == pytest.approx(floor["output"] + 4)
    eyes = {each.joint: each for each in made.features if isinstance(each, PinEyes)}
    wide = {eye.part: eye.diameter for eye in (eyes["C"].a, eyes["C"].b)}
    assert wide == pytest.approx({"pivot-C": 30, "output": 30.2})
    assert eyes["C"].pin is None and eyes["O"].a.part == "pivot-C"
    assert made.journals["C"].length == pytest.approx(4)


@pytest.mark.long
def test_without_it_no_crank_can_turn_about_the_other_ones_shaft() -> None:
    with pytest.raises(DesignError, match="cannot pass on any level"):
        _ = validate(Linkage, DRAG).assembly.parts


def test_a_crank_shorter_than_its_shaft_is_thick_is_told_of_an_eccentric_which_mends_it() -> None:
    tables: dict[str, Any] = {
        "mechanism": "linkage",
        "name": "short-crank",
        "points": {"O": [0, 0], "A": [6, 0], "B": [60, 20], "C": [60, 0]},
        "links": {
            "crank": ["O", "A"],
            "rod": ["A", "B"],
            "rocker": ["C", "B"],
            "ground": ["O", "C"],
        },
        "drive": {"link": "crank"},
        "output": [{"name": "swing", "link": "rocker"}],
    }
    with pytest.raises(DesignError, match=r"parts\.discs\.A, an eccentric in place of the pin"):
        _ = validate(Linkage, tables).assembly.parts
    assert validate(Linkage, {**tables, "parts": {"discs": {"A": 24}}}).assembly.by_name


@pytest.mark.parametrize(
    ("discs", "said"),
    [
        ({"C": 20}, r"MIN_WALL of the eccentric disc"),
        ({"O": 30}, "no shaft goes through it"),
        ({"P": 30}, "no shaft goes through it"),
    ],
)
def test_discs_that_cannot_be(discs: dict[str, float], said: str) -> None:
    with pytest.raises(DesignError, match=said):
        _ = drag(parts={"discs": discs}).assembly.parts


def test_turned_pins_are_of_steel_and_off_the_plates() -> None:
    printed, turned = (drag(parts={"pin": kind}) for kind in ("printed", "turned"))
    shapes = [[part.layers for part in each.assembly.parts] for each in (printed, turned)]
    assert shapes[0] == shapes[1]
    made = {part.name: part.process for part in turned.assembly.parts}
    assert {name for name, how in made.items() if how != "printed"} == {
        "pin-1",
        "dowel",
        "shaft",
    }
    limits = [
        {
            f.limit
            for f in assess(each).findings
            if f.code == "PIN_STRESS" and str(f.where) == "pin A"
        }
        for each in (printed, turned)
    ]
    assert max(limits[0]) < min(limits[1])


def test_a_third_screw_is_farthest_from_the_line_of_the_others() -> None:
    two, three = (drag(parts={"mount_screws": count}).assembly for count in (2, 3))
    assert two.frame is not None and three.frame is not None
    assert three.frame.fixings[:2] == two.frame.fixings
    a, b, c = (z for z, _ in three.frame.fixings)
    centres = [z for z in three.parts[0].centres if z not in (a, b, c)]
    off = [abs(((z - a) / (b - a)).imag) for z in (c, *centres)]
    assert max(off) == off[0]
    assert [each.count for each in three.bought if each.role == "mount"] == [3]


def test_a_counterweight_takes_the_collars_place() -> None:
    plain = drag()
    weighted = drag(counterweight={"made": "steel"}, layers={"counterweight": 0})
    names, more = ({part.name for part in each.assembly.parts} for each in (plain, weighted))
    assert names ^ more == {"collar", "counterweight"}
    (mount,) = (each for each in weighted.assembly.mounts if each.part == "counterweight")
    assert mount.z == pytest.approx(-0.2 - weighted.assembly.by_name["counterweight"].thickness)
    (balance,) = weighted.assembly.balances
    solids = weighted.assembly.solids.body(weighted.model.body("crank"))
    assert 1e3 * solids.mass * solids.centre == pytest.approx(balance.moment, abs=balance.tolerance)
    again = weighted.resolved()
    assert [part.layers for part in again.assembly.parts] == [
        part.layers for part in weighted.assembly.parts
    ]


@pytest.mark.parametrize(
    ("tables", "key"),
    [
        ({"layers": {"crank": 0}}, "layers.crank"),
        ({"parts": {"shaft_length": 7}}, "parts.shaft_length"),
        ({"parts": {"motor": "nema-17"}}, "layers.counterweight"),
    ],
)
def test_what_cannot_lie_under_the_plate(tables: dict[str, Any], key: str) -> None:
    layers = {"counterweight": 0, **tables.pop("layers", {})}
    with pytest.raises(SpecError) as refused:
        drag(counterweight={"thickness": 6}, layers=layers, **tables)
    assert [fault.key for fault in refused.value.faults] == [key]
