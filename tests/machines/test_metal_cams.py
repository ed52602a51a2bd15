"""What a disc cam of metal has where its spec leaves it open: sizes of a workshop, and a drawing that says what was judged."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from camgen.errors import DesignError
from camgen.files.drawing import _Layout
from camgen.files.sheet import Size, Text
from camgen.geometry.arcs import as_circle
from camgen.machines.metal import of_drum
from camgen.machines.sources import read_mechanism
from camgen.parts.catalogue import CAM_FOLLOWERS
from camgen.parts.materials import MATERIALS
from camgen.pipeline.arrangement import arrangement_of
from camgen.pipeline.bought_shapes import bought_shapes
from camgen.pipeline.drawings import facts_of, shaft_facts
from camgen.pipeline.making import parts_table
from camgen.pipeline.shopping import bought_things, steps_of_assembly
from camgen.pipeline.shown import scene
from camgen.starters import in_metal

STARTER = Path(__file__).resolve().parents[2] / "specs" / "disc-cam.toml"
# The starter without its own hub, on a shaft of 20 with a key, and large enough for both.
KEYED = (
    "parts.hub_diameter=",
    "parts.hub_height=",
    "parts.bore=20",
    "parts.bore_shape=keyway",
    "geometry.base_radius=40",
)


def sizes(*settings: str) -> tuple[float, float, float]:
    """Thickness, diameter and height of the hub, mm."""
    made: Any = read_mechanism(STARTER, [*KEYED, *settings])
    parts = made.making
    return parts.thickness, parts.hub_diameter, parts.hub_height


@pytest.mark.parametrize(
    ("settings", "expected"),
    [
        (("material.name=PLA",), (6, 16, 0)),
        # 0.6 and 1.8 bores of 20, and the key as long as the bore is wide
        (("material.name=16MnCr5",), (12, 36, 8)),
        # the ring of KR40 is 20 wide [IKO]: as long as the bore without a hub
        (("material.name=C45", "geometry.follower.radius=20"), (20, 36, 0)),
        (("material.name=C45", "parts.thickness=15"), (15, 36, 5)),
        (("material.name=C45", "parts.hub_height=0"), (12, 36, 0)),
        (("material.name=C45", "parts.bore_shape=plain"), (12, 36, 0)),
        # no room for a hub of 36 on a base circle of 36
        (("material.name=C45", "geometry.base_radius=18"), (12, 36, 0)),
        (("material.name=plywood",), (6, 16, 0)),
    ],
)
def test_a_metal_cam_has_the_sizes_of_a_workshop(
    settings: tuple[str, ...], expected: tuple[float, float, float]
) -> None:
    assert sizes(*settings) == expected


@pytest.mark.parametrize(
    ("settings", "told"),
    [
        (("parts.bore=60", "geometry.base_radius=32"), "parts.bore reaches"),
        (("geometry.base_radius=15",), "parts.hub_diameter reaches 18 mm"),
    ],
)
def test_a_cam_with_no_room_for_the_hub_of_its_screw_is_told_by_what_has_no_room(
    settings: tuple[str, ...], told: str
) -> None:
    """Not by the height of a hub, which nobody typed and which would not mend it."""
    with pytest.raises(DesignError, match=told):
        _ = read_mechanism(
            STARTER, [*KEYED, "material.name=C45", "parts.set_screw=M5", *settings]
        ).assembly


def test_a_groove_in_metal_is_milled_to_its_roller() -> None:
    """No hub, as a groove's plates have none; a clearance that is given stays."""
    groove = (*KEYED, "geometry.closure=groove", "material.name=C45")
    made: Any = read_mechanism(STARTER, groove)
    assert (made.print.slide_clearance, made.making.hub_height) == (0.05, 0)
    own: Any = read_mechanism(STARTER, [*groove, "print.slide_clearance=0.02"])
    printed: Any = read_mechanism(STARTER, [*groove, "material.name=PLA"])
    assert (own.print.slide_clearance, printed.print.slide_clearance) == (0.02, 0.2)


def test_a_groove_in_metal_is_joined_as_exactly_as_its_track() -> None:
    """Walls of 12 on a back of half of that; two dowels of 6 for each wall in H7, where they lie no farther off than the track's
    zone is wide; screws M6 from below, 6 + 9 mm at most, into threads of 5 [ISO 2306]; one key through wall and back. A base circle of 26 has room for dowels of (26 - 0.7 x 20) / 2 = 6, one of 23 for 4."""
    groove = (*KEYED, "geometry.closure=groove", "material.name=16MnCr5", "drawing.profile=0.02")
    made: Any = read_mechanism(STARTER, groove)
    sizes = made.making
    assert (sizes.thickness, sizes.back, sizes.pin_diameter, sizes.rim) == (12, 6, 6, 15)
    rows = {row[1]: row[2:4] for row in parts_table(made).rows}
    assert rows["dowel pin"] == ("6 m6 x 18, ISO 8734", 4)
    assert rows["screw of the plates"] == ("M6 x 12, ISO 4762", 6)
    assert rows["parallel key"] == ("6 x 6 x 18, DIN 6885 form A", 1)
    for part in made.assembly.parts:
        facts = facts_of(made, part)
        dowels = [fit for fit in facts.fits if "dowel" in fit.words]
        assert [fit.diameter for fit in dowels] == [6] * (4 if part.name == "back" else 2)
        others = [2 * each[1] for each in map(as_circle, part.region.holes) if each]
        screwed = {"inner": [5.0] * 2, "outer": [5.0] * 4, "back": [6.6] * 6}[part.name]
        assert sorted(size for size in others if size in (5.0, 6.6)) == screwed
        assert {fit.words for fit in dowels} == {"H7 (+0.012/0), dowel m6"}  # ISO 286, 3 to 6
        assert facts.position == facts.profile == 0.02
    coarse: Any = read_mechanism(STARTER, [*groove, "drawing.position=0.01"])
    assert facts_of(coarse, coarse.assembly.parts[0]).position == 0.01
    printed: Any = read_mechanism(STARTER, [*groove, "material.name=PLA"])
    facts = facts_of(printed, printed.assembly.parts[0])
    assert facts.position == 0.2 and not any("dowel" in fit.words for fit in facts.fits)
    assert (printed.making.back, printed.making.pin_diameter, printed.making.rim) == (3, 3, 8)
    own: Any = read_mechanism(STARTER, [*groove, "parts.pin_diameter=8", "parts.rim=22"])
    assert (own.making.pin_diameter, own.making.rim, own.making.back) == (8, 22, 6)
    for base, pin in (("26", 6), ("23", 4)):
        near: Any = read_mechanism(STARTER, [*groove, f"geometry.base_radius={base}"])
        assert near.making.pin_diameter == pin


def test_a_case_is_hardened_where_a_roller_runs_and_ground_there() -> None:
    """The back plate bears no contact: hardened it would warp. A steel that is quenched and tempered is so through and through."""

    def said(material: str) -> dict[str, tuple[str, bool]]:
        groove = (*KEYED, "geometry.closure=groove", f"material.name={material}")
        made = read_mechanism(STARTER, groove).resolved()
        facts = {part.name: facts_of(made, part) for part in made.assembly.parts}
        return {name: (each.heat_treatment, each.ground) for name, each in facts.items()}

    hard = MATERIALS["16MnCr5"].treatment
    assert said("16MnCr5") == {"inner": (hard, True), "outer": (hard, True), "back": ("", False)}
    assert set(said("C45").values()) == {(MATERIALS["C45"].treatment, False)}


@pytest.mark.parametrize(
    ("material", "name"), [("16MnCr5", "16MnCr5 (1.7131)"), ("brass", "brass"), ("PLA", "PLA")]
)
def test_the_title_block_has_the_number_of_a_steel(material: str, name: str) -> None:
    made = read_mechanism(STARTER, [*KEYED, f"material.name={material}"]).resolved()
    assert facts_of(made, made.assembly.parts[0]).material == name


def _words(layout: _Layout) -> str:
    """The notes, in one line."""
    return " ".join(layout.notes)


def _layout(name: str, *settings: str) -> _Layout:
    """The sheet of a part of a groove cam in case hardened steel."""
    groove = (*KEYED, "geometry.closure=groove", "material.name=16MnCr5", *settings)
    made = read_mechanism(STARTER, groove).resolved()
    part = next(each for each in made.assembly.parts if each.name == name)
    return _Layout(part, "d", 0.001, facts_of(made, part))


@pytest.mark.parametrize("bore", ["plain", "keyway"])
def test_a_groove_s_back_plate_is_cut_through_its_bore(bore: str) -> None:
    """Its circles are no curve that a file could miss; its dowels' holes go through, and none is dashed."""
    layout = _layout("back", f"parts.bore_shape={bore}")
    assert layout.drawn.upright is not None and layout.drawn.chamfer == 1.0
    texts = {each.text for each in layout.sheet.primitives if isinstance(each, Text)}
    assert {"Ra 1.6", "S-S", "All holes go through", "Bore chamfered 1 × 45° at both ends"} <= texts
    assert "Outlines: d.dxf" in texts and "exact curve" not in _words(layout)
    assert not [each for each in layout.sheet.primitives if getattr(each, "layer", "") == "HIDDEN"]


def test_a_groove_s_walls_are_ground_after_hardening_and_the_rim_is_a_datum_with_a_tolerance() -> (
    None
):
    inner = _words(_layout("inner"))
    assert "Track and bore ground after hardening; all sizes hold after it" in inner
    assert "within 0.001 of the exact curve" in inner
    assert "Case on the track only (thick chain line); keep bore, keyway and threads soft" in inner
    own = _words(_layout("inner", "drawing.heat_treatment=nitrided"))
    assert "Nitrided" in own and "Case on" not in own
    outer = _layout("outer")
    assert "Smallest hollow radius of the track: R" in _words(outer)
    assert "Case on the track only (thick chain line); keep threads soft" in _words(outer)
    assert f"Rim {outer.drawn.rim_letter} round within 0.025, Ra 1.6" in _words(outer)
    assert "Track and rim ground after hardening" in _words(outer)


def test_a_plate_s_lower_side_is_a_datum_with_a_tolerance() -> None:
    made = read_mechanism(STARTER.with_name("linear-cam.toml"), ["material.name=C45"]).resolved()
    (part,) = made.assembly.parts
    layout = _Layout(part, "d", 0.001, facts_of(made, part))
    assert f"Lower side {layout.drawn.rim_letter} flat within 0.025, Ra 1.6" in _words(layout)


def test_a_milled_groove_of_a_drum_is_as_close_as_that_of_a_plate() -> None:
    drum = STARTER.with_name("cylinder-cam.toml")

    def play(*settings: str) -> float:
        made: Any = read_mechanism(drum, settings)
        return float(made.print.slide_clearance)

    assert play("material.name=42CrMo4") == 0.05
    assert play() == 0.2
    assert play("material.name=42CrMo4", "print.slide_clearance=0.1") == 0.1


@pytest.mark.parametrize("spec", ["disc-cam.toml", "cylinder-cam.toml"])
def test_a_bore_in_metal_that_turns_nothing_or_is_hard_to_cut_is_told(spec: str) -> None:
    def told(*settings: str) -> list[str]:
        notes = read_mechanism(STARTER.with_name(spec), settings).remarks().warnings
        return [note for note in notes if "parts.bore_shape" in note]

    steel = "material.name=C45"
    (plain,) = told(steel, "parts.bore_shape=plain")
    assert "keeps the part from turning" in plain
    (flat,) = told(steel, "parts.bore_shape=d-flat")
    assert "wire erosion" in flat
    keyed = (steel, "parts.bore_shape=keyway", "parts.bore=10")
    assert not told(*keyed)
    assert not told("parts.bore_shape=plain")
    # DIN 471 has a ring for 10, none for 6.5
    held = read_mechanism(STARTER.with_name(spec), keyed)
    rings, _ = (each for each in held.assembly.bought if each.standard == "DIN 471")
    assert (rings.count, rings.size[:6]) == (2, "10 x 1") and not held.remarks().warnings
    # a drum fits between its rings either way round, a hub is on one side
    marked = any("UP stamped" in note for part in held.assembly.parts for note in part.notes)
    assert marked == (spec == "cylinder-cam.toml")
    (shaft,) = (each for each in held.assembly.bought if each.role == "shaft")
    assert "its end for the coupling below" in shaft.how
    assert f"begins {shaft.shaft.bores[0][0]:g} mm from its other end" in shaft.how
    slides = read_mechanism(STARTER.with_name(spec), [*keyed[:2], "parts.bore=6.5"])
    assert "sliding along its shaft" in " ".join(slides.remarks().warnings)


def test_a_cam_of_metal_has_a_shaft_unless_it_sits_on_its_motor_s() -> None:
    """Of a cam of 12 and a hub of 8: 20 in the bore, 10 and a 6004 of 12 on either side, 5 before the first one, a
    groove of 1.3 behind the other one, 30 for the coupling: 100.3."""

    def listed(*settings: str) -> dict[str, str]:
        made = read_mechanism(STARTER, ["material.name=C45", *settings]).assembly
        return {each.name: f"{each.size}: {each.details}" for each in made.bought}

    keyed = ("parts.bore=20", "parts.bore_shape=keyway", "geometry.base_radius=32")
    sizes = ("parts.hub_diameter=36", "parts.hub_height=8", "parts.thickness=12")
    found = listed(*keyed, *sizes)
    assert found["shaft"] == "20 h6 x 105, C45: see its drawing"
    assert found["bearing of the shaft"].startswith("6004, 20 x 42 x 12: sealed")
    screwed = listed(*keyed, *sizes, "parts.set_screw=M5")
    assert "retaining ring" in found and "retaining ring" not in screwed
    assert "shaft" not in listed("parts.bore=5", "motor.model=17HS19-2004S1")
    assert "shaft" not in listed("material.name=PLA")


def test_the_head_and_shoulder_of_a_bought_roller_have_room() -> None:
    """KR16 has a ring of 11 in at most 12.2, KR35 one of 18 in 19.6 [IKO, CF 6 and CF 16]: 0.6 and 0.8 beyond it. Beside a cam of 12 the
    shoulder is 0.1 outside, beside one of 11 0.6; in a drum 0.4 inside, and a washer M6 is 1.6 thick [ISO 7089]."""

    def washers(text: str) -> list[tuple[str, int]]:
        bought = bought_things(read_mechanism(tomllib.loads(text)))
        return [(each.size, each.count) for each in bought if each.standard == "ISO 7089"]

    cam = in_metal("disc-cam")
    assert washers(cam) == [("M6", 1)]
    assert washers(cam.replace("[parts]", "[parts]\nthickness = 11")) == []
    drum = in_metal("cylinder-cam")
    assert washers(drum) == [("M6", 1)]
    made = read_mechanism(tomllib.loads(drum))
    assert made.geometry.roller.end_clearance == pytest.approx(1.0)
    assert not any("The head of" in each for each in made.remarks().warnings)
    given = drum.replace("[geometry.roller]", "[geometry.roller]\nend_clearance = 0.5")
    (rubs,) = (
        each
        for each in read_mechanism(tomllib.loads(given)).remarks().warnings
        if "The head of" in each
    )
    assert "KR16 stands up to 0.6 mm" in rubs and "end_clearance = 1." in rubs
    kept = read_mechanism(tomllib.loads(drum.replace("[geometry]", "[geometry]\nradius = 40", 1)))
    assert kept.geometry.roller.end_clearance == 0.5, "a drum that is given stays as it was"

    def room(track: str, name: str) -> Any:
        data = {"geometry": {"track": track, "roller": {}}, "load": {"cam_follower": name}}
        return of_drum({**data, "material": {"name": "C45"}})["geometry"]["roller"]

    assert room("groove", "KR35") == {"end_clearance": 1.2}
    assert room("end", "KR35") == {}, "an end cam has no floor"


def test_a_cam_is_held_on_its_shaft_before_the_bearings_close_it_in() -> None:
    """The key is tight in its shaft: it goes in first. What holds the bore along the shaft is inboard of the bearings. Some step
    says how long the spring is at its longest, 15 N at a rate of 1 N/mm under its free length, and what holds the shaft."""

    def steps(name: str) -> list[str]:
        made = read_mechanism(tomllib.loads(in_metal(name)))
        return [step.title for step in steps_of_assembly(made).steps]

    def names(titles: list[str]) -> list[str]:
        return [title.partition(",")[0] for title in titles]

    cam = steps("disc-cam")
    drum = steps("cylinder-cam")
    held = ["4 × retaining ring of a bearing", "2 × bearing of the shaft"]
    own = ["Parallel key", "Shaft"], held
    assert names(cam)[1:6] == [*own[0], "Set screw of the hub", *own[1]]
    assert names(drum)[1:6] == [*own[0], "2 × retaining ring", *own[1]]
    assert "tapped into the keyway of the shaft" in cam[1] and "tighten it on the key" in cam[3]
    assert all("the shaft cannot slide" in each[5] for each in (cam, drum))
    assert "UP above" in drum[2] and "UP above" not in cam[2], "a cam with a hub fits one way only"
    # 54 and 57 of the shafts are below their bores of 24 and 46, which begin 27 from the upper end: 105 - 51, 130 - 73
    assert "blocks at least 54 mm high" in cam[2] and "blocks at least 57 mm high" in drum[2]
    # a KR16's stud of 16, less a washer of 1.6 [ISO 7089] and a nut of at most 5.2 [ISO 4032], is 9.2
    assert any("at most 8.5 mm thick there" in each for each in cam)
    # a ring of 11 half way up a cam of 12, the shoulder 0.6 beyond it, a washer of 1.6; a drum of 37 with the ring's inner end at 25
    assert any("which is then 1.7 mm off the cam" in each for each in cam)
    assert any("which is then 1.2 mm off the cam" in each for each in drum)
    (spring,) = [each for each in cam if "spring" in each]
    free = float(re.findall(r"free length ([\d.]+)", spring)[0])
    assert f"pressed together to {free - 15:.4g} while the follower is lowest" in spring
    inside, stem = re.findall(r"inside diameter (\d+).*stem of (\d+) mm", spring)[0]
    assert 0 < int(inside) - int(stem) <= 2


def test_the_sheets_of_the_starters_say_what_a_workshop_asks_back() -> None:
    """The least radius of a cam is that of its base circle; a drum between rings is h11, of 30 to 50 mm 0/-0.16 [ISO 286]; a groove
    of 16.05 +0.05 on a ring of 16, which may be 0.05 thinner where it is crowned [nodeshk.com/ina/art/track-roller-clearance]."""

    def texts(name: str) -> tuple[set[str], str, list[str]]:
        made = read_mechanism(tomllib.loads(in_metal(name)))
        (part,) = made.assembly.parts
        layout = _Layout(part, "d", 0.001, facts_of(made, part))
        things = layout.sheet.primitives
        sizes = [each.fit for each in layout.sheet.things if isinstance(each, Size)]
        rows = [row[3] for row in layout.drawn.rows]
        return {each.text for each in things if isinstance(each, Text)}, " ".join(sizes), rows

    cam, _, rows = texts("disc-cam")
    assert {"base circle (R32)", "outer circle (R44)", "through into the keyway"} <= cam
    assert not any("DXF" in row for row in rows)
    drum, sizes, _ = texts("cylinder-cam")
    assert {"its play 0.05 to 0.1", "of a crowned ring to 0.15"} <= drum
    assert "0/-0.16" in sizes


def test_the_list_has_the_shims_that_a_step_asks_for() -> None:
    """Rings 46.7 +0.2/0 over their outer walls, each 1.2, on a drum of 44 0/-0.16: 0.3 to 0.66 are left, by hand, and 0.78
    where each ring is thinner by its 0.06 [DIN 471]."""
    rows = parts_table(read_mechanism(tomllib.loads(in_metal("cylinder-cam")))).rows
    shims = {str(row[1]): row[2:4] for row in rows if "shims" in str(row[1])}
    assert shims["set of shims beside the bore"] == (
        "for a shaft of 20, together 0.3 to 0.9 thick, DIN 988",
        1,
    )
    assert shims["set of shims beside a bearing"][1] == 2


def test_the_list_has_who_makes_what_is_not_bought() -> None:
    """A shaft with a keyway is turned, by its drawing; a spring of its own sizes is ordered, as `bought` says."""
    starter = tomllib.loads(in_metal("disc-cam"))
    rows = {row[1]: (row[0], str(row[2])) for row in parts_table(read_mechanism(starter)).rows}
    how, shaft = rows["shaft"]
    assert how == "turned of steel" and shaft == "20 h6 x 105, C45, see its drawing"
    assert rows["return spring, made to order"][0] == "bought"
    tight = read_mechanism(starter, ["drawing.key_fit=P9"]).assembly.bought
    (made,) = (each.shaft for each in tight if each.shaft is not None)
    assert [(each.width, each.fit, each.length) for each in made.keyways] == [(6.0, "P9", 22.0)]


def test_a_shop_and_a_buyer_find_drawing_material_number_and_mass_in_each_row() -> None:
    """A shaft of 20 x 105 by hand: pi/4 x 20^2 x 105 x 7.85 g/cm^3 is 258.9 g; four grooves 1.3 wide down to 19 are 1.25 g, a keyway
    of 22 x 6 with round ends, 3.5 deep under a crown of 0.46, 20.1 mm^2 in section, 3.27 g. The cam is as high and wide as its sheet says;
    numbers run through what the arrangement shows, and what is bought has no drawing."""
    table = parts_table(read_mechanism(tomllib.loads(in_metal("disc-cam"))))
    rows = [dict(zip(table.columns, row, strict=True)) for row in table.rows]
    assert table.columns[-5:] == ("no", "drawing", "material", "mass of one, g", "overall, mm")
    numbers = [row["no"] for row in rows if row["how"] != "your own"]
    assert numbers == list(range(1, len(numbers) + 1))
    named = {row["part"]: row for row in rows}
    assert named["cam"]["drawing"] == "disc-cam-cam-drawing.pdf"
    assert named["shaft"]["drawing"] == "disc-cam-shaft-drawing.pdf"
    assert named["shaft"]["material"] == named["cam"]["material"] == "C45"
    assert named["shaft"]["mass of one, g"] == pytest.approx(258.9 - 1.25 - 3.27, abs=0.1)
    assert named["shaft"]["overall, mm"] == "Ø20 x 105"
    wide, tall, high = map(float, str(named["cam"]["overall, mm"]).split(" x "))
    assert (wide, tall, high) == (76.0, 75.7, 24.0)  # 75.716 in its STL, and (75.7) on its sheet
    volume = float(str(named["cam"]["material, mm^3"]))
    assert named["cam"]["mass of one, g"] == pytest.approx(volume * 7.85e-3)
    assert not [column for column in table.columns if column.startswith("mass in")]
    assert named["bearing of the shaft"]["drawing"] == ""


def test_the_list_has_what_is_yours_beside_a_shaft_and_the_nut_of_the_roller() -> None:
    """Bearings 6004 are 42 x 12 [ISO 15]; their middles are 24 in the bore, 10 free on either side and 12 apart: 56. Of the
    shaft's 105 the coupling has what is behind 5 + 12 + 44 + 12 and a ring's 1.3: 30.7. A KR16 has M6 x 1, which is coarse, a KR22
    M10 x 1.25, which is fine."""
    table = parts_table(read_mechanism(tomllib.loads(in_metal("disc-cam"))))
    own = {row[1]: str(row[2]) for row in table.rows if row[0] == "your own"}
    assert list(own) == ["drive", "clamping coupling", "frame", "follower"]
    assert own["drive"].startswith("SGMAH-01AJC, 60 rpm")
    assert own["clamping coupling"].startswith("for 20 h6 over 30.7 mm without a key")
    assert own["frame"].startswith("two bores 42 H7, coaxial within 0.03, their middles 56 apart;")
    assert "12 wide between shoulders Ø36.5 at the end without the coupling" in own["frame"]
    assert "6 H7 for the stud" in own["follower"]
    nuts = [row[2:4] for row in table.rows if row[1] == "nut of the cam follower"]
    assert nuts == [("M6 x 1, often sold with the cam follower, ISO 4032", 1)]
    fine = CAM_FOLLOWERS["KR22"].bought(1, 1.0, "")
    (nut,) = (each for each in fine if each.name == "nut of the cam follower")
    assert (nut.size.partition(",")[0], nut.standard) == ("M10 x 1.25", "ISO 8673")


@pytest.mark.parametrize(("closure", "count"), [("force", 1), ("conjugate", 2), ("groove", 1)])
def test_each_cam_of_a_pair_has_its_roller(closure: str, count: int) -> None:
    """Two conjugate cams have a roller each, a groove one between its walls."""
    starter = tomllib.loads(in_metal("disc-cam"))
    starter["geometry"]["closure"] = closure
    starter = {key: table for key, table in starter.items() if key != "spring"}
    starter["parts"] = {"bore": 20, "bore_shape": "keyway"}
    counts = {row[1]: row[3] for row in parts_table(read_mechanism(starter)).rows}
    names = ("cam follower", "nut of the cam follower", "washer of the cam follower")
    assert [counts[name] for name in names] == [count] * 3


def test_the_mass_of_one_is_a_share_of_all_copies() -> None:
    """Two conjugate cams of one shape are two rows; two collars of a Geneva drive one, of two."""
    table = parts_table(read_mechanism(tomllib.loads(in_metal("geneva-table"))))
    rows = [dict(zip(table.columns, row, strict=True)) for row in table.rows]
    collar = next(row for row in rows if row["part"] == "collar")
    assert collar["count"] == 2
    assert collar["mass of one, g"] == pytest.approx(
        float(str(collar["material, mm^3"])) * 7.85e-3 / 2
    )
    stock = [row for row in rows if row["how"] in ("stock", "your own")]
    assert stock and all(row["no"] == row["drawing"] == "" for row in stock)


@pytest.mark.parametrize(
    ("settings", "protection"),
    [
        ((), "oiled against rust"),
        (("material.name=16MnCr5",), "oiled against rust"),
        (("material.name=stainless",), ""),
        (("material.name=brass",), ""),
        (("drawing.protection=black oxide",), "black oxide"),
    ],
)
def test_what_rusts_says_how_it_is_kept_from_that(
    settings: tuple[str, ...], protection: str
) -> None:
    """On the sheet of the cam; a shaft of C45 rusts beside any cam."""
    made = read_mechanism(tomllib.loads(in_metal("disc-cam")), list(settings))
    (shaft,) = (each.shaft for each in made.assembly.bought if each.shaft is not None)
    assert facts_of(made, made.assembly.parts[0]).protection == protection
    assert shaft_facts(made, shaft).protection == (protection or "oiled against rust")


@pytest.mark.parametrize(
    ("settings", "shape"),
    [
        (("parts.bore=20",), ("keyway", 6, 2.8)),  # DIN 6885: 6 x 6, t2 2.8
        (("parts.bore=5",), ("plain",)),  # under 6 mm the norm has no key
        (
            ("parts.bore=20", "geometry.base_radius=22"),
            ("plain",),
        ),  # less than half the bore about it
        (("parts.bore=20", "parts.bore_shape=plain"), ("plain",)),
        (("parts.bore=20", "material.name=PLA"), ("plain",)),
    ],
)
def test_a_bore_in_metal_that_is_left_open_has_a_keyway(
    settings: tuple[str, ...], shape: tuple[str | float, ...]
) -> None:
    bare = (*KEYED[:2], "parts.bore_shape=", "material.name=C45", "geometry.base_radius=40")
    made: Any = read_mechanism(STARTER, [*bare, *settings])
    parts = made.making
    assert (parts.bore_shape, parts.key_width, parts.key_depth)[: len(shape)] == shape
    assert made.resolved().making.bore_shape == shape[0]


def test_a_bore_that_does_not_fit_the_shaft_of_the_motor_is_told() -> None:
    """Shaft of a NEMA 17: 5 mm."""

    def told(*settings: str) -> list[str]:
        notes = read_mechanism(STARTER, settings).remarks().warnings
        return [note for note in notes if "couple" in note]

    (said,) = told("motor.model=42STH48-2004AC")
    assert said == (
        'The shaft of motor.model = "42STH48-2004AC" is 5 mm thick, and parts.bore is 8 mm. '
        "Set parts.bore = 5, or couple the motor to a shaft of 8 mm"
    )
    assert not told("motor.model=42STH48-2004AC", "parts.bore=5")
    assert not told(), "the starter is turned by hand"
    machine = ("motor.model=42STH48-2004AC", "parts.make=printed")
    assert not told(*machine), "a machine says what its shaft is"


def test_what_is_found_stays_as_it_is_written_out() -> None:
    made: Any = read_mechanism(STARTER, [*KEYED, "material.name=16MnCr5"])
    assert made.resolved().making.hub_height == 8


def test_a_metal_cam_s_drawing_asks_for_what_its_material_was_judged_by() -> None:
    """Without its heat treatment 16MnCr5 does not bear its pressure; a print has none of that."""
    made: Any = read_mechanism(STARTER, [*KEYED, "material.name=16MnCr5", "drawing.roughness=0.4"])
    facts = facts_of(made, made.assembly.parts[0])
    assert facts.heat_treatment == MATERIALS["16MnCr5"].treatment != ""
    assert (facts.profile, facts.roughness, facts.bore_roughness) == (0.05, 0.4, 1.6)
    assert facts.edges == "broken 0.2 to 0.4, ISO 13715"
    assert (facts.symmetry, facts.run_out, facts.bore_chamfer) == (0.04, 0.03, 1.0)
    off = ["drawing.symmetry=0", "drawing.run_out=0.1", "drawing.bore_chamfer=0"]
    other: Any = read_mechanism(STARTER, [*KEYED, "material.name=C45", *off])
    facts = facts_of(other, other.assembly.parts[0])
    assert (facts.symmetry, facts.run_out, facts.bore_chamfer) == (0, 0.1, 0)
    own: Any = read_mechanism(STARTER, [*KEYED, "drawing.heat_treatment=nitrided"])
    facts = facts_of(own, own.assembly.parts[0])
    assert (facts.heat_treatment, facts.profile, facts.edges) == ("nitrided", 0, "")
    assert (facts.symmetry, facts.run_out, facts.bore_chamfer) == (0, 0, 0)


def test_a_cam_that_is_as_wide_as_its_hub_says_so() -> None:
    """A hub of 1.8 bores of 100 mm and two walls of 1 mm on either side make 92; the motion is content with less."""

    def said(*settings: str) -> list[str]:
        bare = ("material.name=C45", "geometry.base_radius=", "limits.min_wall=", *settings)
        notes = read_mechanism(STARTER, [*KEYED[:2], *bare]).study().notes
        return [note for note in notes if "base_radius" in note]

    (note,) = said("parts.bore=100", "parts.hub_diameter=180", "parts.hub_height=20")
    assert note.startswith("geometry.base_radius = 92 comes from the room that the cam needs")
    assert "parts.bore, parts.hub_diameter and limits.min_wall" in note
    assert said("parts.bore=4", "parts.bore_shape=plain", "parts.hub_height=0") == []
    assert said("geometry.base_radius=92") == []


def test_a_hardened_case_has_its_depth() -> None:
    """Under a roller of 40 mm on a flank as flat as a plane, at the pressure that it bears: the shear is greatest at 0.78
    half widths, and lies in the upper half of the case [Norton, Machine Design, line contact: b = 4 p r (1 - nu^2) / E]."""
    steel = MATERIALS["16MnCr5"]
    assert "CHD 0.8+0.4" in steel.treatment and steel.hertz is not None
    elastic = steel.elastic
    half_width = 4 * steel.hertz * 20.0 * (1 - elastic.poisson**2) / elastic.modulus
    assert 0.39 < 0.78 * half_width < 0.4


@pytest.mark.parametrize(
    ("material", "least"), [("PLA", 0.8), ("C45", 1.0), ("42CrMo4", 1.0), ("16MnCr5", 3.2)]
)
def test_walls_of_metal_are_thicker_than_two_lines_of_a_print(material: str, least: float) -> None:
    """1 mm; between two cases of 0.8 mm, as the heat treatment asks for, as much is left that stays tough."""
    bare = (*KEYED[:2], "limits.min_wall=", f"material.name={material}")
    assert read_mechanism(STARTER, bare).resolved().allowed.min_wall == pytest.approx(least)
    own = read_mechanism(STARTER, [*bare, "limits.min_wall=2"])
    assert own.allowed.min_wall == 2
    grooved: Any = read_mechanism(STARTER, [*bare, "geometry.closure=groove"])
    parts = grooved.making
    assert (parts.rim - parts.pin_diameter) / 2 >= least
    walls = [each for each in grooved.forecast() if each.code == "MIN_WALL"]
    assert walls and walls[-1].limit == pytest.approx(least) and walls[-1].ok


@pytest.mark.parametrize("spec", ["cylinder-cam", "indexing-cam", "linkage", "uniform-swing"])
def test_walls_of_all_machines_of_metal_are_alike(spec: str) -> None:
    """Of a steel without a case the same rule as for a disc cam."""
    file = STARTER.with_name(f"{spec}.toml")
    bare = [] if spec == "linkage" else ["limits.min_wall="]  # the linkage's has none
    for material, least in (("PLA", 0.8), ("C45", 1.0)):
        made: Any = read_mechanism(file, [*bare, f"material.name={material}"])
        assert made.allowed.min_wall == pytest.approx(least)


@pytest.mark.parametrize(
    ("spec", "least"),
    [
        ("cylinder-cam", 3.2),
        ("drum", 1.0),
        ("indexing-cam", 3.2),
        ("linear-cam", 3.2),
        ("gallery/geneva-table", 1.0),
        ("linkage", 1.0),
        ("uniform-swing", 1.0),
    ],
)
def test_what_is_no_cam_or_drum_has_no_case(spec: str, least: float) -> None:
    """Four cases of 0.8 mm where a roller runs; nothing of a linkage is hardened, its links bear 1 mm, and rows of pins on a drum
    may lie 2 mm apart."""
    file = STARTER.parent / f"{spec}.toml"
    bare = ["limits.min_wall="] if "\nmin_wall" in file.read_text() else []
    made: Any = read_mechanism(file, [*bare, "material.name=16MnCr5"])
    assert made.allowed.min_wall == pytest.approx(least)
    assert made.assembly.parts


@pytest.mark.parametrize("spec", ["disc-cam", "indexing-cam"])
def test_a_whole_machine_of_a_steel_with_a_case_has_the_walls_of_its_links(spec: str) -> None:
    """Walls of 3.2 mm refused its rails and its ground plate."""
    settings = ["parts.make=machine", "limits.min_wall=", "material.name=16MnCr5"]
    made: Any = read_mechanism(STARTER.with_name(f"{spec}.toml"), settings)
    assert made.allowed.min_wall == 1.0
    assert made.assembly.parts


def test_the_ends_of_a_hardened_drum_are_as_thick_as_its_walls() -> None:
    """4 cases of 0.8 mm are 3.2, rounded up 4, where a drum of any material has 3."""
    file = STARTER.with_name("cylinder-cam.toml")
    for material, end in (("C45", 3.0), ("16MnCr5", 4.0)):
        drum: Any = read_mechanism(file, ["limits.min_wall=", f"material.name={material}"])
        assert drum.making.wall == end
        assert end >= drum.allowed.min_wall
    # a track for a roller of 11 with 0.5 at either end is 12 deep
    deep: Any = read_mechanism(file, ["material.name=C45", "geometry.roller.length=11"])
    assert deep.making.wall == 6.0


def test_the_list_of_parts_has_the_key_of_each_keyway() -> None:
    """A bore of 20 in 16MnCr5 is 20 long, its key 6 x 6 [DIN 6885]; a pair has two, a plain bore none."""

    def keys(*settings: str) -> list[tuple[object, ...]]:
        table = parts_table(read_mechanism(STARTER, [*KEYED, "material.name=16MnCr5", *settings]))
        return [tuple(row[:4]) for row in table.rows if row[1] == "parallel key"]

    text = "6 x 6 x 20, DIN 6885 form A"
    assert keys() == [("bought", "parallel key", text, 1)]
    assert keys("geometry.closure=conjugate") == [("bought", "parallel key", text, 2)]
    assert keys("parts.bore_shape=plain") == []


def test_the_pictures_of_a_cam_s_steps_show_its_shaft_rings_and_bearings() -> None:
    """By hand: a shaft from z = -54 to 51; inner rings of 1.2 from -10 up and from 33.9 down, outer ones with the bearings, each of two
    races, from 34 to 46 and from -22 to -10. A picture shows a prism from outside where its corners run counter-clockwise."""
    steps = scene(read_mechanism(tomllib.loads(in_metal("disc-cam"))), []).steps
    shown = {step.title.partition(",")[0]: step.shapes for step in steps}
    shaft = shown["Shaft"]
    assert (min(low for _, low, _ in shaft), max(high for *_, high in shaft)) == (-54.0, 51.0)
    inner = [
        (round(low, 2), round(high, 2)) for _, low, high in shown["4 × retaining ring of a bearing"]
    ]
    assert sorted(inner) == [(-10.0, -8.8), (32.7, 33.9)]
    closed = [(round(low, 2), round(high, 2)) for _, low, high in shown["2 × bearing of the shaft"]]
    outer = [(-23.3, -22.1), (46.0, 47.2)]
    assert sorted(closed) == sorted([*2 * [(34.0, 46.0), (-22.0, -10.0)], *outer])
    assert not shown["Lay the disc cam on the bench."]
    for shapes in shown.values():
        for corners, _, _ in shapes:
            ring = np.array(corners)
            assert np.sum((ring.conj() * np.roll(ring, -1)).imag) > 0


def test_a_pair_of_indexing_cams_has_a_shaft_as_a_disc_cam_has() -> None:
    """12 h6; 5 before a 6001 of 8, 6 free, cams of 12 and, 0.2 apart, 12, 6 free, a 6001, a groove of 1.1 and 18 for the
    coupling: 76.3, rounded up to 80; the middles of the bearings are 24.2 + 2 x 6 + 8 = 44.2 apart."""
    made = read_mechanism(tomllib.loads(in_metal("indexing-cam")))
    things = {each.name: each for each in bought_things(made)}
    assert things["shaft"].size == "12 h6 x 80, C45"
    assert things["bearing of the shaft"].size == "6001, 12 x 28 x 8"
    # one key turns both, of the lengths of DIN 6885 below 24.2
    assert (things["parallel key"].size, things["parallel key"].count) == ("4 x 4 x 22", 1)
    assert things["shaft"].shaft is not None
    assert [each.length for each in things["shaft"].shaft.keyways] == [22.0]
    drawn = bought_shapes(made, bought_things(made))
    ((_, low, high),) = drawn[things["parallel key"]][0]
    assert len(drawn[things["parallel key"]]) == 1 and high - low == pytest.approx(22.0)
    assert (low + high) / 2 == pytest.approx(24.2 / 2)
    assert arrangement_of(made, parts_table(made)).copies
    assert "28 H7, coaxial within 0.03, their middles 44.2 apart" in things["frame"].size
    printed = read_mechanism(tomllib.loads(in_metal("indexing-cam")), ["material.name=PLA"])
    assert "shaft" not in {each.name for each in bought_things(printed)}
