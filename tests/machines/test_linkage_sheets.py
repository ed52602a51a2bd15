"""Machines of layers of sheet: every part is as thick as the sheet, bought or turned; what no sheet can be is refused."""

import csv
import tomllib
from pathlib import Path

import pytest

import camgen
from camgen.errors import DesignError, SpecError
from camgen.parts.assembly import cut_of_sheet, printed_parts

SPECS = Path(__file__).parents[2] / "specs"


def laser(name, sheet=3.0, **sizes):
    spec = tomllib.loads((SPECS / f"{name}.toml").read_text(encoding="utf-8"))
    own = {key: value for key, value in spec.get("parts", {}).items() if isinstance(value, dict)}
    return {**spec, "parts": own | {"make": "laser", **sizes}, "laser": {"thickness": sheet}}


TOOLS = (
    "drill 4.2",
    "drill 6.2",
    "fine sandpaper",
    "drill 4",
    "drill 6",
    "caliper",
    "saw",
    "file",
    "scraper",
    "vice",
    "block",
)
SUPPLIES = ("oil", "alcohol", "sheets of paper", "two-part glue")


@pytest.fixture(scope="module")
def report(tmp_path_factory):
    return camgen.build(laser("linkage"), tmp_path_factory.mktemp("sheets"), only="dxf")


@pytest.mark.long
def test_a_four_bar_of_one_sheet(report):
    """Nothing is left to print: its links, ring and caps lie on the sheet, which is judged as cut."""
    assert report.ok, [finding for finding in report.findings if not finding.ok]
    assert report.numbers["sheets"] == 1
    assert {finding.code for finding in report.findings} >= {
        "SHEET_FIT",
        "KERF",
        "MOTION_ERROR",
        "PIN_GAP",
    }
    with open(report.folder / "linkage-parts.csv", encoding="utf-8") as file:
        made = {row["part"]: row["how"] for row in csv.DictReader(file)}
    assert made == {
        **dict.fromkeys(
            ("ground", "crank", "coupler", "rocker", "collar", "cap-1"), "cut of sheet"
        ),
        "shaft": "turned of steel",
        **dict.fromkeys(("pin-1", "drive", "screw of the plate, from behind", "glue"), "bought"),
        "steel rod 6 h9": "stock",
        "board": "your own",
        **dict.fromkeys(SUPPLIES, "bought"),
        **dict.fromkeys(TOOLS, "tool"),
    }
    assert report.numbers["mass_g"] == report.numbers["print_time_h"] == 0


@pytest.mark.long
def test_the_resolved_spec_says_what_the_sheet_decided(report):
    spec = tomllib.loads((report.folder / "spec.toml").read_text(encoding="utf-8"))
    parts = spec["parts"]
    assert (parts["thickness"], parts["base_thickness"], parts["pin"], parts["pin_diameter"]) == (
        3,
        3,
        "dowel",
        4,
    )
    assert camgen.load(spec).making == camgen.load(laser("linkage")).making


@pytest.mark.long
@pytest.mark.parametrize("thickness", [3.0, 5.0])
def test_all_of_a_walker_is_of_the_sheet(thickness):
    """Rings fill the empty levels, one a level, and dowels reach through all."""
    machine = camgen.load(laser("two-leg-walker", sheet=thickness)).resolved()
    parts = {part.name: part for part in machine.assembly.parts}
    assert {part.process for part in parts.values()} == {
        "printed",
        "turned of steel",
        "bought",
    } and not printed_parts(machine.assembly)
    assert {part.thickness for part in parts.values() if part.process == "printed"} == {thickness}
    step = thickness + machine.print.slide_clearance
    levels = {
        round((mount.z - machine.print.slide_clearance) / step, 6)
        for mount in machine.assembly.mounts
        if parts[mount.part].process == "printed"
    }
    assert levels - {-1.0} and all(
        level % 1 in (0, pytest.approx(1 - machine.print.slide_clearance / step, abs=1e-5))
        for level in levels
    )


def test_thin_sheets_take_thin_dowels():
    """Of 2 mm: two sheets, two plays of 0.2 and a cap leave 5.2 to 6.4 mm; dowels of 6 mm are sold up to 2.5 thick (ISO 2338)."""
    machine = camgen.load(laser("linkage", sheet=2.0)).resolved()
    (pin,) = [part for part in machine.assembly.parts if part.name.startswith("pin")]
    assert (
        pin.thickness == 6
        and machine.making.pin_diameter == 2.5
        and not printed_parts(machine.assembly)
    )


def test_a_hand_crank_of_sheet_is_turned_by_a_dowel():
    """Its arm is cut, 15 mm under the plate; a dowel of 4 mm, sold in 18 mm and not in 19, ends flush with its upper face."""
    machine = camgen.load(laser("linkage", hand_crank=30.0)).resolved()
    parts, stands = (
        {each.name: each for each in machine.assembly.parts},
        {mount.part: mount for mount in machine.assembly.mounts},
    )
    assert (
        cut_of_sheet(machine.assembly, parts["hand-crank"])
        and "knob" not in parts
        and not printed_parts(machine.assembly)
    )
    assert parts["knob-pin"].process == "bought" and parts["knob-pin"].thickness == 18
    assert stands["hand-crank"].z == -15 and stands["knob-pin"].z == pytest.approx(-15 + 3 - 18)


@pytest.mark.long
def test_a_cam_machine_of_sheet():
    """Cams and wheels are plates on a turned shaft."""
    machine = camgen.load(laser("indexing-cam", 4.0)).resolved()
    cut = [part for part in machine.assembly.parts if cut_of_sheet(machine.assembly, part)]
    assert {"cam-contact", "cam-contact_2", "roller-contact", "gear-gears-follower"} <= {
        part.name for part in cut
    }
    assert not printed_parts(machine.assembly)


@pytest.mark.parametrize(
    "name, sizes, said",
    [
        (
            "linkage",
            {"thickness": 4.0},
            "parts.thickness: 4 - expected 3, the same as laser.thickness",
        ),
        ("linkage", {"base_thickness": 5.0}, "parts.base_thickness: 5"),
        ("linkage", {"rocker": {"thickness": 2.0}}, "parts.rocker.thickness: 2"),
        ("linkage", {"pin": "printed"}, 'parts.pin: \'printed\' - expected "dowel" or "shoulder"'),
        ("linkage", {"pins": {"A": "bearing"}}, "parts.pins.A: 'bearing'"),
        (
            "linkage",
            {"motor": "nema-17", "shaft_diameter": 5.0, "base_thickness": 3.0},
            "heads of its screws need pockets",
        ),
        ("quick-return", {}, "slide: 1 with parts.make = 'laser' - expected slots and pins"),
    ],
)
def test_what_no_sheet_can_be(name, sizes, said):
    with pytest.raises(SpecError) as refused:
        camgen.load(laser(name, **sizes))
    assert said in str(refused.value)


@pytest.mark.parametrize(
    "closure, faulty",
    [
        ("force", {"geometry.follower.motion"}),
        ("groove", {"geometry.follower.motion", "geometry.closure"}),
    ],
)
def test_a_disc_cam_is_refused_by_its_own_keys(closure, faulty):
    """It has neither a table [[slide]] nor a [[cam]]; alone it can be cut, and with a follower that swings it is a machine."""
    follower = {"motion": "translating", "shape": "roller", "radius": 5}
    geometry = {"base_radius": 25, "closure": closure, "follower": follower}
    spec = {**laser("disc-cam"), "geometry": geometry, "parts": {"make": "laser"}}
    with pytest.raises(SpecError) as refused:
        camgen.load(spec)
    assert {fault.key for fault in refused.value.faults} == faulty
    alone = {**spec, "parts": {"make": "cams", "hub_height": 0}}
    assert camgen.load(alone).sizes.make == "cams"


def test_a_disc_cam_with_a_swinging_follower_is_a_machine_of_sheet():
    spec = laser("disc-cam")
    swings = {"motion": "oscillating", "shape": "roller", "radius": 5, "pivot_distance": 60}
    spec["geometry"] = {"base_radius": 25, "follower": {**swings, "arm": 50}}
    spec["parts"] = {"make": "laser"}
    machine = camgen.load(spec).resolved()
    assert not printed_parts(machine.assembly)
    cut = [part.name for part in machine.assembly.parts if cut_of_sheet(machine.assembly, part)]
    assert {"ground", "follower", "cam-contact", "roller-contact"} <= set(cut)


def test_where_else_sheet_is_had():
    spec = tomllib.loads((SPECS / "uniform-swing.toml").read_text(encoding="utf-8"))
    spec["parts"]["make"] = "laser"
    with pytest.raises(SpecError, match="parts.make: .*cuts cams as thick as laser.thickness"):
        camgen.load(spec)


def test_without_a_sheet_or_dowels():
    spec = laser("linkage")
    del spec["laser"]
    with pytest.raises(
        SpecError, match="parts.make: 'laser' - expected a table \\[laser\\] as well"
    ):
        camgen.load(spec)
    with pytest.raises(
        DesignError,
        match="the shortest dowel of 8 mm is 14 mm, there is room for .*thin dowels are sold",
    ):
        _ = camgen.load(laser("linkage", pin_diameter=8.0)).assembly


@pytest.mark.parametrize("key, value", [("plates", 2), ("shaft", "interrupted")])
def test_posts_and_webs_are_no_sheets(key: str, value: object) -> None:
    with pytest.raises(camgen.SpecError) as told:
        camgen.load(laser("linkage", **{key: value}))
    assert f"parts.{key}" in [fault.key for fault in told.value.faults]


@pytest.mark.parametrize("sheet", [2.0, 3.0, 4.0, 6.0])
def test_a_cap_of_sheet_is_filled_by_its_pin(sheet: float) -> None:
    """By three quarters at least; where a longer dowel stands out of it, its note says how far, by the heights."""
    machine = camgen.load(laser("linkage", sheet=sheet)).resolved()
    parts = {part.name: part for part in machine.assembly.parts}
    caps, outs = (
        [mount for mount in machine.assembly.mounts if mount.part.startswith("cap")],
        list[float](),
    )
    for cap in caps:
        here = (
            each for each in machine.assembly.mounts if (each.body, each.at) == (cap.body, cap.at)
        )
        pin = next(each for each in here if each.part.startswith("pin"))
        low, high, long = cap.z, cap.z + sheet, parts[pin.part].thickness
        assert min(high, pin.z + long) - max(low, pin.z) >= 0.75 * sheet - 1e-9
        outs.append(round(max(pin.z + long - high, 0.0), 2))
        (note,) = parts[pin.part].notes
        assert (f"stands {outs[-1]:g} mm out of its cap" in note) == (outs[-1] > 0)
    assert caps
