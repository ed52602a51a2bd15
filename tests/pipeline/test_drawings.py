"""What drawings say beside shapes: fits as the machines' authors meant them, material, mass, number, date; slopes."""

from __future__ import annotations

import cmath
import math
import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import ezdxf
import numpy as np
import pytest
import shapely
from ezdxf import path
from ezdxf.query import EntityQuery
from reportlab.pdfbase.pdfmetrics import stringWidth

from camgen import starters
from camgen.errors import DesignError, SpecError
from camgen.files.dimensions import edge_rows, round_of
from camgen.files.drawing import write_drawing
from camgen.files.drawn_part import DrawnPart
from camgen.files.title_block import Facts
from camgen.geometry.outlines import Region, circle, extent, polygon
from camgen.machines.loads.assess import assess
from camgen.machines.mechanism import Mechanism
from camgen.machines.sources import read_mechanism
from camgen.parts.assembly import by_heights
from camgen.parts.fixing import is_as_sold
from camgen.parts.keyways import keyed
from camgen.parts.part import Layer, Part, d_bore
from camgen.pipeline.case import Case
from camgen.pipeline.drawings import facts_of
from camgen.pipeline.making import parts_table
from camgen.pipeline.shopping import steps_of_assembly
from camgen.pipeline.summary import draw_part

SPECS = Path(__file__).resolve().parents[2] / "specs"


def facts(spec: str, *settings: str) -> tuple[Mechanism, dict[str, Facts]]:
    mechanism = read_mechanism(SPECS / f"{spec}.toml", settings)
    return mechanism, {part.name: facts_of(mechanism, part) for part in mechanism.assembly.parts}


def fits(found: Facts) -> dict[complex, str]:
    return {complex(round(fit.at.real, 6), round(fit.at.imag, 6)): fit.words for fit in found.fits}


def test_pins_of_a_linkage_are_pressed_in_one_link_and_turn_in_the_other() -> None:
    _, found = facts("linkage")
    assert fits(found["ground"]) == {
        0: "slide on Ø6",
        70: "press on Ø5",
    }  # the plate's screws are no fits
    assert fits(found["crank"]) == {0: "press on Ø6", 20: "press on Ø5"}
    assert fits(found["coupler"]) == {0: "slide on Ø5", 60: "slide on Ø5"}
    assert fits(found["rocker"]) == {0: "slide on Ø5", 50: "press on Ø5"}
    assert not found["shaft"].fits
    _, found = facts("linkage", "material.name=C45")
    cut = [words for words in fits(found["ground"]).values() if "core hole" in words]
    assert cut == ["core hole, M3 through"] * 2  # the plate's screws, in metal


def test_fits_follow_the_clearances_of_the_spec() -> None:
    _, found = facts("thread-take-up", "print.slide_clearance=0.3", "print.press_clearance=0.1")
    told = [(fit.words.split(" on Ø"), fit.diameter) for fit in found["output"].fits]
    assert [(word, round(hole - float(shaft), 6)) for (word, shaft), hole in told] == [
        ("slide", 0.3),
        ("press", 0.1),
    ]


def test_a_motor_s_shaft_and_collar_are_fits_too() -> None:
    _, found = facts("eccentric-drive")
    assert fits(found["disc"]) == {0: "press on Ø2"} and fits(found["ground"])[0] == "press on Ø6"
    assert fits(found["motor-bar"]) == {0: "slide on Ø6"} and fits(found["rod"]) == {
        0: "slide on Ø9",
        48: "slide on Ø3",
    }


def test_material_mass_number_and_date(tmp_path: Path) -> None:
    mechanism, found = facts(
        "thread-take-up", "drawing.number=K-104", "drawing.date=2026-05-31", "material.infill=0.5"
    )
    parts = {part.name: part for part in mechanism.assembly.parts}
    for k, (name, one) in enumerate(found.items(), 1):
        printed = parts[name].process == "printed"
        density = 1.24 * 0.5 if printed else 7.85  # g/cm^3: PLA at half its filling, steel
        assert one.material == ("PLA" if printed else "steel")
        assert one.mass_g == pytest.approx(parts[name].volume / 1000 * density)
        assert (one.number, one.date, one.tolerance) == (
            f"K-104-{k:02d}",
            "2026-05-31",
            "ISO 2768-m" if printed else "ISO 2768-mK",
        )
    path, _ = write_drawing(tmp_path, "x", parts["output"], 1e-3, found["output"])
    texts = [entity.dxf.text for entity in ezdxf.readfile(path).modelspace().query("TEXT")]
    assert {"%%c31.8 slide on %%c31.6", "%%c3.5 press on %%c3.5", "2026-05-31"} <= set(texts)


@pytest.mark.parametrize(
    ("settings", "tolerance"),
    [
        ((), "ISO 2768-m"),
        (("material.name=C45",), "ISO 2768-mK"),
        (("material.name=C45", "drawing.tolerance=ISO 2768-f"), "ISO 2768-f"),
    ],
)
def test_metal_has_the_tolerance_of_a_shop_unless_another_is_asked_for(
    settings: tuple[str, ...], tolerance: str
) -> None:
    mechanism, found = facts("disc-cam", *settings)
    (part,) = mechanism.assembly.parts
    assert found["cam"].tolerance == tolerance
    assert facts_of(mechanism.resolved(), part).tolerance == tolerance, "as a build has it"


def test_mating_sizes_of_metal_have_fits_of_their_own(tmp_path: Path) -> None:
    """A rod f7 (10: -0.013/-0.028, ISO 286) turns in a bush and is loose in any H7, and so is glued; a dowel m6 is pressed in. Table,
    notes and steps say so in the same words."""
    metal = starters.METAL["geneva-table"]
    mechanism, found = facts("gallery/geneva-table", *metal)
    glued, turns = "H7 (+0.015/0), keyed and glued on Ø10 f7", "slide on"
    pressed = "H7 (+0.012/0), pressed and glued on Ø5 m6"  # the roller's pin, the disc's dowel
    assert fits(found["crank"]) == {0: glued, 35: pressed, -21.22: pressed}
    on_dowel = "E8 (+0.038/+0.02), glued on Ø5 m6"  # by hand, as a cap
    assert fits(found["lock-crank_to_table"])[21.22] == on_dowel
    screws = dict.fromkeys((90.0, -57.0, 57j), "core hole, M5 through")
    seat = "H7 (+0.018/0), press on Ø16"  # of a bush [mecmove.se]
    assert fits(found["ground"]) == {0: seat, 70: seat, **screws}
    assert fits(found["roller-crank_to_table"]) == {0: f"E9 (+0.05/+0.02), {turns} Ø5 m6"}
    assert fits(found["spacer-1"]) == {0: f"F8 (+0.035/+0.013), {turns} Ø10 f7"}
    parts = {part.name: part for part in mechanism.assembly.parts}
    sizes = {
        "shaft": "%%c<> f7 (-0.013/-0.028)",
        "roller-crank_to_table": "%%c<> h9 (0/-0.036)",
        "pin-1": "%%c<> m6 (+0.012/+0.004)",  # nutbolt.org/Standards/Pin-Dowel.html, table 3
    }
    for name, size in sizes.items():
        path, *_ = write_drawing(tmp_path, "x", parts[name], 1e-3, found[name])
        space = ezdxf.readfile(path).modelspace()
        assert size in {each.dxf.text for each in space.query("DIMENSION")}
    path, *_ = write_drawing(tmp_path, "x", parts["shaft"], 1e-3, found["shaft"])
    space = ezdxf.readfile(path).modelspace()
    # a key 3 wide, t1 1.8 deep [DIN 6885: berger-tools.co.uk, page 2078], tight in the shaft and in what it turns
    sizes_of_shaft = {each.dxf.text for each in space.query("DIMENSION")}
    assert {"<> P9 (-0.006/-0.031)", "<> 0/-0.1"} <= sizes_of_shaft
    texts = {each.dxf.text for each in space.query("TEXT")}
    assert {"0.04", "D"} <= texts, "symmetric to the shaft's axis"
    # the hand crank, 6 thick, is on its lower end; the crank from 0.1 over the plate of 10, which is 15 above that
    assert "Keys at 0 to 6 and 25.1 to 31.1 from the left" in texts
    assert {"2 x 0.5 x 45%%d", "Ra 1.6", "C45+C (1.0503)"} <= texts
    assert {"Elsewhere Ra 3.2", "Tensile strength at least 700 MPa"} <= texts
    others = {"shaft-table", "dowel-lock-crank_to_table"}
    assert {name for name, each in found.items() if each.outer_fit} == {*sizes, *others}
    pins = {"pin-1", "knob-pin", "dowel-lock-crank_to_table"}
    assert {name for name, each in found.items() if each.shank[0]} == pins
    notes = {
        "crank": {"Holes with a fit Ra 1.6", "Bore chamfered 0.5 x 45%%d at both ends"},
        "table": {"Bore chamfered 0.5 x 45%%d at both ends"},
    }
    for name, said in notes.items():
        path, *_ = write_drawing(tmp_path, "x", parts[name], 1e-3, found[name])
        assert said <= {e.dxf.text for e in ezdxf.readfile(path).modelspace().query("TEXT")}
    path, *_ = write_drawing(tmp_path, "x", parts["knob-pin"], 1e-3, found["knob-pin"])
    space = ezdxf.readfile(path).modelspace()
    sizes_of_pin = {each.dxf.text for each in space.query("DIMENSION")}
    assert {"%%c<>", "%%c<> m6 (+0.012/+0.004)", "<>"} == sizes_of_pin, "head, shank, lengths"
    texts = {each.dxf.text for each in space.query("TEXT")}
    assert "Size" not in texts, "no table: the view along it has all"
    assert fits(found["hand-crank"])[40] == "H7 (+0.012/0), pressed and glued on Ø5 m6"
    assert "hole P for a pin pressed and glued in" in parts["crank"].notes
    assert "pressed and glued in" in parts["knob-pin"].notes
    assert "hole O keyed and glued on the shaft" in parts["crank"].notes
    square = "holes O and C square to the lower face within Ø0.02 over the thickness"
    assert square in parts["ground"].notes
    # the roller runs on the pin
    assert square.replace("holes O and C", "hole P") in parts["crank"].notes
    where = {str(row[1]): str(row[3]) for row in by_heights(mechanism.assembly).rows}
    assert where["crank"].startswith("O keyed and glued on shaft, ")
    assert where["pin-1"].startswith("pressed and glued into P of crank")
    assert where["cap-1"].startswith("glued on pin-1, ")
    assert where["collar"].startswith("glued on shaft, ")
    _, plain = facts("gallery/geneva-table")
    assert fits(plain["crank"]) == {0: "press on Ø6", 35: "press on Ø5"}
    assert not any(each.outer_fit or each.shank[0] or each.rod_chamfer for each in plain.values())


@pytest.mark.parametrize(
    ("clearance", "fit"),
    [(0.03, "E9 (+0.05/+0.02)"), (0.06, "D10 (+0.078/+0.03)"), (0.1, "C11 (+0.145/+0.07)")],
)
def test_a_hole_that_runs_has_the_standard_fit_that_its_files_keep(
    tmp_path: Path, clearance: float, fit: str
) -> None:
    """On a pin of 5 m6 (+0.012/+0.004) [ISO 286]: F8 (+0.028/+0.010) might not go on; a play of 0.2 has no fit, and stays as drawn."""
    metal = (*starters.METAL["geneva-table"], f"print.bore_clearance={clearance}")
    mechanism, found = facts("gallery/geneva-table", *metal)
    (roller,) = (
        each
        for each in mechanism.assembly.parts
        if each.process == "printed" and "roller" in each.name
    )
    path, *_ = write_drawing(tmp_path, "x", roller, 1e-3, found[roller.name])
    texts = {each.dxf.text for each in ezdxf.readfile(path).modelspace().query("TEXT")}
    assert f"%%c5 {fit}" in texts and "slide on %%c5 m6" in texts
    assert roller.bore == pytest.approx(5 + clearance)
    low, high = (float(each) for each in reversed(fit[4:-1].replace("(", "").split("/")))
    assert 0.012 < low <= clearance <= high
    wide = facts("gallery/geneva-table", *metal, "print.bore_clearance=0.2")[1]
    assert fits(wide[roller.name]) == {0: "+0.05/0, slide on Ø5 m6"}


def test_tolerances_of_links_stand_in_frames(tmp_path: Path) -> None:
    """Squareness of the holes of pins and bushes to the lower face, run-out of rims and faces, each with its datum; no datum has the
    letter of a point of the machine. Overall sizes follow from places and radii:
    holes 35 and 21.4 from O, R5.55 and R5.5 about them, R9.45 about O."""
    mechanism, found = facts("gallery/geneva-table", *starters.METAL["geneva-table"])
    texts = dict[str, list[str]]()
    overall = list[tuple[float, int]]()
    for part in mechanism.assembly.parts:
        path, *_ = write_drawing(tmp_path, "x", part, 1e-3, found[part.name])
        space = ezdxf.readfile(path).modelspace()
        texts[part.name] = [each.dxf.text for each in space.query("TEXT")]
        if part.name == "crank":
            overall = [
                (each.get_measurement(), each.override().get("dimdec"))
                for each in space.query("DIMENSION")
                if each.dxf.text == "(<>)"
            ]
    for name, holes in (("ground", "holes O and C"), ("crank", "hole P")):
        zone = texts[name].index("%%c0.02")
        assert texts[name][zone + 1 : zone + 3] == [found_face(texts[name]), holes]
        assert not any("square" in each for each in texts[name])
    runs = {name: each.count("0.03") for name, each in texts.items() if "0.03" in each}
    assert runs == {
        "table": 3,
        "roller-crank_to_table": 1,
        "geneva-crank_to_table": 3,  # once the slots' zone
        "lock-crank_to_table": 2,  # once the relief's
    }
    assert not any("run out" in each or "runs out" in each for each in texts["table"])
    assert not {"C", "O", "P"} & {*texts["lock-crank_to_table"]}, "points of the machine"
    assert "fitted holes; X and Y are exact" in texts["ground"]
    assert "round holes; X and Y are exact" in texts["crank"]
    assert [size for size, _ in overall] == pytest.approx([35 + 21.22 + 5.55 + 5.5, 2 * 9.45])
    assert {decimals for _, decimals in overall} == {2}


def found_face(texts: list[str]) -> str:
    """The last letter of a datum: that of the lower face."""
    return max(each for each in texts if each in ("D", "E", "F"))


def test_a_lock_clears_its_hollows_at_the_limits_of_all_sheets(tmp_path: Path) -> None:
    """Of the starter in metal: hollows and lock are 0.14 apart, less 0.015 each off their bores, 0.015 of the plate's second bore and 0.015
    of each bush. A part's bore is at most 0.015 too wide [H7], its shaft at least 0.013 thinner than the bush [f7 in H8]; a bore of the plate leans by
    0.02 over 10, and the lock's upper face, at 10 + 0.1 + 6 + 8, is 19.1 over its middle: so far up the shaft gives way by 3.82 times
    half its play. At the other limits the gap is 0.06 wider and half of both plays, 0.022 + 0.028 each."""
    metal = starters.METAL["geneva-table"]
    mechanism, found = facts("gallery/geneva-table", *metal)
    limits = found["lock-crank_to_table"].lock
    assert limits is not None
    off = 0.015 / 2 + 0.013 / 2 + 0.02 * 1.91 - 3.82 * 0.013 / 2
    assert limits.least == pytest.approx(0.14 - 5 * 0.015 - 2 * off, abs=1e-9) and limits.least > 0
    wheel = mechanism.assembly.by_name["geneva-crank_to_table"].region.outer
    rim = math.hypot(70 * math.cos(math.pi / 6), 5)
    hollow = min(
        abs(piece.at(piece.t0, 0) - cmath.rect(70, k * math.pi / 3))
        for piece in wheel.pieces
        for k in range(6)
    )
    corner = (70**2 + hollow**2 - rim**2) / (2 * 70 * hollow)  # cosine about the hollow's centre
    loose = 0.14 + 0.06 + 0.05
    assert limits.turn == pytest.approx(2 * loose / (70 * math.sin(math.acos(corner))), rel=1e-6)
    assert [each for each, said in found.items() if said.lock] == ["lock-crank_to_table"]
    tight, found = facts("gallery/geneva-table", *metal, "geneva.0.clearance=0.05")
    lock = tight.assembly.by_name["lock-crank_to_table"]
    path, *_ = write_drawing(tmp_path, "x", lock, 1e-3, found[lock.name])
    said = " ".join(e.dxf.text for e in ezdxf.readfile(path).modelspace().query("TEXT"))
    assert "Worst limits: binds by 0.08; use a" in said


def test_rods_of_a_drum_s_machine_have_their_fit_at_the_dimension(tmp_path: Path) -> None:
    """A rod h9 of 6 is 0/-0.030 [ISO 286]; it is cut to length, so no sheet says that it comes made."""
    mechanism, found = facts("cylinder-cam", "parts.make=printed", "print.slide_clearance=0.2")
    parts = {part.name: part for part in mechanism.assembly.parts}
    path, *_ = write_drawing(tmp_path, "x", parts["rod"], 1e-3, found["rod"])
    space = ezdxf.readfile(path).modelspace()
    (fit,) = (e.dxf.text for e in space.query("DIMENSION") if e.dxf.text.startswith("%%c"))
    assert re.fullmatch(r"%%c<> h9 \(0/-0\.0(3|36)\)", fit)
    assert found["shaft"].outer_fit == "h9"
    said = [each.dxf.text for each in space.query("TEXT")]
    assert not [each for each in said if each.startswith("Bought")]


def _notes(part: str, tmp_path: Path, *settings: str) -> str:
    """What the sheet of a part of the Geneva table in metal says, in one line."""
    metal = (*starters.METAL["geneva-table"], *settings)
    mechanism, found = facts("gallery/geneva-table", *metal)
    own = next(each for each in mechanism.assembly.parts if each.name == part)
    path, *_ = write_drawing(tmp_path, "x", own, 1e-3, found[part])
    space = ezdxf.readfile(path).modelspace()
    texts = [each.dxf.text for each in space.query("TEXT")]
    # notes are written from the last line up
    return " ".join([*reversed(texts), *(each.dxf.text for each in space.query("DIMENSION"))])


def test_what_holds_a_part_on_its_shaft_says_how_far_it_turns(tmp_path: Path) -> None:
    """A key h9 (3: 0/-0.025) in keyways P9 (-0.006/-0.031) has 0.019 mm in either, half of both each way at a radius of 5: 0.22 deg.
    A flat 0.8 deep on 10 is 2 x 2.713 wide: bore and shaft may both be 0.02 off, and 0.04 over 2.713 is 0.84 deg."""
    keyed = _notes("geneva-crank_to_table", tmp_path)
    assert "<> P9 (-0.006/-0.031)" in keyed and "<> +0.1/0" in keyed
    assert "Keyway of shaft and bore P9, key h9: turns at most %%p0.2%%d" in keyed
    flat = _notes("geneva-crank_to_table", tmp_path, "parts.shaft_key=false")
    assert "On the flat of its shaft it turns at most %%p0.8%%d" in flat
    assert "<> +0.02/0" in flat
    assert "<> 0/-0.02" in _notes("shaft", tmp_path, "parts.shaft_key=false")


def test_a_tight_key_is_pressed_and_no_step_slides_over_it() -> None:
    """A key h9, 3 wide, is 2.975 to 3; a keyway P9 is 2.969 to 2.994 [ISO 286]: in the middle 0.006 too wide for it."""
    machine, _ = facts("gallery/geneva-table", *starters.METAL["geneva-table"])
    (said,) = (each.title for each in steps_of_assembly(machine).steps if "keyways." in each.title)
    assert "tap the key into the shaft first, then press the part over it" in said
    # what a key turns can be taken off again; on a round shaft the glue alone holds
    assert (
        "medium strength keeps that from sliding along the shaft; a puller takes it off again"
        in said
    )
    for key, without in (
        ("true", ", for glued joints without a key"),
        ("false", ", for all glued joints"),
    ):
        metal = (*starters.METAL["geneva-table"], f"parts.shaft_key={key}")
        rows = parts_table(facts("gallery/geneva-table", *metal)[0]).rows
        things = {str(row[1]): str(row[2]) for row in rows}
        assert things["glue"].endswith(f"of high strength for cylindrical joints of metal{without}")
        assert ("glue of keyed parts" in things) == (key == "true")
    assert "with a key" not in said


def test_a_board_is_open_where_a_hand_crank_and_collars_turn() -> None:
    """The knob is 40 from the shaft, 5 + 1.5 more to its rim; the collar of C is 6 high between gaps of 0.1."""
    machine, _ = facts("gallery/geneva-table", *starters.METAL["geneva-table"])
    (said,) = (
        each.title for each in steps_of_assembly(machine).steps if "open under" in each.title
    )
    # 1 mm all round, and a hand at the knob
    hand = "open under the shaft, right through, with room for your hand below, and at least 95 mm across"
    assert f"{hand}; under C 7.2 mm deep and " in said
    assert "Grease the slots, locking disc and rims of the rollers. " in said
    steps = [each.title for each in steps_of_assembly(machine).steps]
    for name in ("knob", "roller-crank_to_table"):  # before a cap or the hand crank closes it
        (own,) = (each for each in steps if each.startswith("Put the ") and f"{name}" in each)
        assert own.endswith("Grease its bore first.")
    bushes = "Press 2 × bush into O and C of ground, from above, flush with its underside. "
    bushes += "The shaft must turn freely in each bush: pressing narrows them, so open one that is tight. "
    bushes += "Grease each bush inside, and the faces round it on which something runs. "
    (pressed,) = (each for each in steps if bushes in each)
    assert pressed.endswith(" Put the ground plate on shaft and on shaft-table.")
    assert any("once more after it went through a greased bore" in each for each in steps)
    length = "7.5 to 10 longer than the board is thick"  # 1.5 of M5, the plate's thickness
    assert f"M5, for a core hole of 4.2, such as ISO 4762, {length}" in said
    screws = machine.assembly.frame.fixings
    board = min(abs(z) for z, _ in screws) - 95 / 2 - 5.5 / 2
    assert board > 5, "of the board, between its opening and a screw's hole"
    rims = [part.region.outer for part in machine.assembly.parts if part.name == "collar"]
    low, high = extent(rims)
    assert f"under C 7.2 mm deep and {(high - low).real + 2:g} mm across" in said


def test_keys_turn_all_that_is_fixed_on_shafts() -> None:
    """Of the Geneva table in metal: a key for each of hand crank, crank, wheel and table, as long as these are thick, in keyways of the
    shafts that end where these turn in the plate; the collars turn nothing, and a dowel turns the locking disc."""
    machine, _ = facts("gallery/geneva-table", *starters.METAL["geneva-table"])
    bought = {str(row[1]): row[2:4] for row in parts_table(machine).rows if row[0] == "bought"}
    assert bought["parallel key"] == ("3 x 3 x 6, DIN 6885 form A", 4)
    parts = {part.name: part for part in machine.assembly.parts}
    assert not any(map(keyed, parts["collar"].region.holes))
    z = {mount.part: mount.z for mount in machine.assembly.mounts}
    for name, cut in (("shaft", 2), ("shaft-table", 1)):
        spans = [
            (round(z[name] + each.z0, 6), round(z[name] + each.z1, 6))
            for each in parts[name].layers
            if keyed(each.region.outer)
        ]
        assert len(spans) == cut
        assert not any(low < 10 and 0 < high for low, high in spans), "round in the plate"
        upper = max(high for _, high in spans)
        assert upper == pytest.approx(z[name] + parts[name].thickness), "to its end"


def test_a_ball_bearing_in_metal_has_the_fits_of_its_makers(tmp_path: Path) -> None:
    """The load turns about its outer ring, and the inner one goes on by hand: g6 on its pin (5: -0.004/-0.012), which is glued in the
    other link, and JS7 (13 mm: +-0.009, half of IT7) in its own; nothing is told
    of the bearing's own bore."""
    linkage = (*starters.METAL["linkage"], "parts.pin=bearing")
    mechanism, found = facts("linkage", *linkage)
    (bearing,) = (each for each in mechanism.assembly.parts if each.name.startswith("bearing"))
    assert not found[bearing.name].fits and not found[bearing.name].outer_fit
    assert {found[name].shank for name in found if name.startswith("pin")} == {(5.0, "g6")}
    assert fits(found["crank"])[20] == "H7 (+0.012/0), glued on Ø5 g6"
    seats = fits(found["coupler"])
    assert seats[0] == seats[60] == "JS7 (±0.009), ball bearing"
    # a sleeve of 7 on a pin of 5; no wider than the inner ring, and so is the head of a pin [ISO 286, IT11 of 7: 0.09]
    rings = {name: each.ring_fit for name, each in found.items() if each.ring_fit}
    assert rings == dict.fromkeys(("sleeve-1", "pin-1", "pin-2"), "h11")
    for part in (each for each in mechanism.assembly.parts if each.name in rings):
        path, *_ = write_drawing(tmp_path, "x", part, 1e-3, found[part.name])
        sizes = {e.dxf.text for e in ezdxf.readfile(path).modelspace().query("DIMENSION")}
        assert "%%c<> h11 (0/-0.09)" in sizes
    # a face some tenths wide; a sleeve takes half of the gap of 0.2
    assert {found[name].edges[:13] for name in ("pin-1", "pin-2", "sleeve-1")} == {"free of burrs"}
    assert (found["sleeve-1"].thinner, found["coupler"].lip) == pytest.approx((0.1, 0.1))
    # the coupler lies on sleeves of two links, 60 mm apart
    links = ("ground", "crank", "rocker", "coupler")
    assert [found[name].thinner for name in links] == pytest.approx([0.0, 0.1, 0.1, 0.0])
    assert fits(found["sleeve-1"])[0] == "H7 (+0.012/0), slides on Ø5 g6"
    # pins that lean in their holes tip the links on them, and so do bearings in their seats: these are the holes of both
    square = {
        part.name: [note for note in part.notes if "square to the lower face" in note]
        for part in mechanism.assembly.parts
    }
    assert {name: said[0].split(" square")[0] for name, said in square.items() if said} == {
        "ground": "holes O and C",
        "crank": "hole A",
        "coupler": "holes A and B",
        "rocker": "holes C and B",
    }
    own = facts("linkage", *linkage, "drawing.seat_fit=H8")[1]
    assert fits(own["coupler"])[0].startswith("H8")
    assert not any(
        "JS7" in fit.words for fit in facts("linkage", "parts.pin=bearing")[1]["coupler"].fits
    )


def test_what_bears_no_load_is_not_heat_treated() -> None:
    """The pressures of contacts and the stresses of pins count on a treatment; a knob, its pin, a collar, a spacer and a table do not, nor do
    links that turn on ball bearings or carry a roller's pin, unless the spec says one for all. The roller is harder than the slots:
    C45 reaches 52 to 58 HRC."""
    metal = starters.METAL["geneva-table"]
    hard = "quenched and tempered, at least 200 HB"
    _, found = facts("gallery/geneva-table", *metal)
    treated = {name for name, each in found.items() if each.heat_treatment == hard}
    assert treated == {"lock-crank_to_table", "geneva-crank_to_table"}
    assert "50+5 HRC" in found["roller-crank_to_table"].heat_treatment
    assert {found[name].roughness for name in treated} == {1.6}
    plain = {name for name, each in found.items() if each.heat_treatment == "no heat treatment"}
    assert {"knob", "collar", "spacer-1", "cap-1", "ground", "table", "hand-crank"} <= plain
    assert {"crank", "knob-pin"} <= plain
    _, found = facts("linkage", *starters.METAL["linkage"])
    assert {name for name, each in found.items() if each.heat_treatment == hard} == {
        "pin-1",
        "pin-2",
    }
    slides = facts("linkage", "material.name=C45")[1]  # whose links turn on their pins
    assert slides["coupler"].heat_treatment == slides["rocker"].heat_treatment == hard
    _, own = facts("gallery/geneva-table", *metal, "drawing.heat_treatment=nitrided")
    assert own["knob"].heat_treatment == "nitrided"


def test_sheets_say_how_their_parts_stand_in_the_arrangement(tmp_path: Path) -> None:
    """The crank's pin is at (-35, 0) of the machine and at (35, 0) on its sheet; B of the coupler at (55, 48) from A at (20, 0), with
    lengths of 60 and 50 from O and C at atan2(48, 36), 53.1 deg. What is round is not told."""
    assert "In the arrangement turned by 180%%d," in _notes("crank", tmp_path)
    assert "In the arrangement turned by 180%%d," in _notes("hand-crank", tmp_path)
    assert "In the arrangement" not in _notes("table", tmp_path)
    _, found = facts("linkage", *starters.METAL["linkage"])
    assert found["coupler"].turned_deg == pytest.approx(math.degrees(math.atan2(48, 36)), abs=0.01)
    assert found["crank"].turned_deg == found["pin-2"].turned_deg == 0.0


def test_the_seat_of_a_ball_bearing_has_its_own_heights(tmp_path: Path) -> None:
    """A lip 10.5 wide and 1.8 high under a seat of 13 in 6 mm: one outline all along, and each hole with its heights; no line across
    the view from the left; the detail has the seat on top."""
    mechanism, found = facts("linkage", *starters.METAL["linkage"])
    coupler = next(each for each in mechanism.assembly.parts if each.name == "coupler")
    path, *_ = write_drawing(tmp_path, "x", coupler, 1e-3, found["coupler"])
    space = ezdxf.readfile(path).modelspace()
    texts = [each.dxf.text for each in space.query("TEXT")]
    assert texts.count("z 1.8 to 6") == texts.count("%%c10.5, z 0 to 1.8") == 2
    assert "Edges, z 0 to 6:" in texts
    assert not [each for each in texts if ": as z" in each]
    seat, lip = (
        next(e.dxf.defpoint.y for e in space.query("DIMENSION") if e.dxf.text.startswith(said))
        for said in ("%%c<> JS7", "%%c<>")
        if said
    )
    assert seat > lip
    assert "z upwards; corners at most R0.1" in texts and "z 0" in texts


def test_what_stays_as_it_is_sold_has_no_sheet(tmp_path: Path) -> None:
    """Bush and dowels are ordered by their rows of the list; the collar is made, and the rod of a one-way clutch has a flat ground on."""
    mechanism, _ = facts("gallery/geneva-table", *starters.METAL["geneva-table"])
    names = ("bush", "pin-1", "dowel-lock-crank_to_table", "collar")
    for name in names:
        draw_part(Case(mechanism, tmp_path), name, tmp_path)
    assert {path.name.partition("-drawing")[0] for path in tmp_path.iterdir()} == {
        "geneva-table-collar"
    }
    round_ = Part("rod", "Rod", (Layer(Region(circle(0j, 3.0)), 0.0, 20.0),), process="bought")
    flat = Layer(Region(d_bore(6.0, 0.8)), 20.0, 30.0)
    assert is_as_sold(round_) and not is_as_sold(replace(round_, layers=(*round_.layers, flat)))


def test_a_shaft_with_a_flat_has_no_shoulder_in_its_view(tmp_path: Path) -> None:
    """A flat 0.8 deep over the end of 10: from the left one outline, 10 high and 9.2 over the flat."""
    metal = (*starters.METAL["geneva-table"], "parts.shaft_key=false")
    mechanism, found = facts("gallery/geneva-table", *metal)
    shaft = next(each for each in mechanism.assembly.parts if each.name == "shaft")
    flat, rest = (Layer(each, *span) for each, span in _flat_and_round(shaft))
    path, *_ = write_drawing(
        tmp_path, "x", replace(shaft, layers=(flat, rest)), 1e-3, found["shaft"]
    )
    views = ezdxf.readfile(path).modelspace().query('LWPOLYLINE[layer=="VIEW"]')
    outlines = [[(x, round(y, 3)) for x, y in each.get_points("xy")] for each in views]
    (corners,) = [each for each in outlines if 4.2 in {y for _, y in each}]
    assert {y for _, y in corners} == {-5.0, 4.2, 5.0}, "one outline, with its step alone"


def _flat_and_round(shaft: Part) -> list[tuple[Region, tuple[float, float]]]:
    return [(shaft.region, (0.0, 6.0)), (Region(circle(0j, 5.0)), (6.0, shaft.thickness))]


@pytest.mark.parametrize("material", ["PLA", "C45", "16MnCr5"])
def test_a_groove_s_walls_of_metal_have_their_threads_in_the_table(
    tmp_path: Path, material: str
) -> None:
    """M3 has a core hole of 2.5 (pitch 0.5); what is case hardened is threaded and reamed before that."""
    settings = ("geometry.closure=groove", "parts.hub_height=0", f"material.name={material}")
    mechanism, found = facts("disc-cam", *settings)
    metal = material != "PLA"
    for part in mechanism.assembly.parts:
        path, *_ = write_drawing(tmp_path, "g", part, 1e-3, found[part.name])
        texts = [each.dxf.text for each in ezdxf.readfile(path).modelspace().query("TEXT")]
        wall = part.name != "back"
        tapped = texts.count("%%c2.5 core hole, M3 through")
        assert tapped == metal * {"inner": 2, "outer": 4, "back": 0}[part.name]
        notes = " ".join(reversed(texts))  # written upwards
        hard = wall and material == "16MnCr5"
        assert ("ream the dowel holes together" in notes) == metal
        assert ("together, before hardening" in notes) == hard
        assert ("Threads M3 cut before hardening" in notes) == hard


@pytest.mark.parametrize(("name", "said"), [("plywood", "plywood"), ("PLA", "as the sheet")])
def test_what_is_cut_of_a_sheet_has_its_material_where_that_is_known(name: str, said: str) -> None:
    _, found = facts("linkage", "parts.make=laser", "laser.thickness=4", f"material.name={name}")
    assert {one.material for one in found.values()} - {"steel", "bought"} == {said}


@pytest.mark.parametrize(
    "setting", ["tolerance=DIN 7168", "date=2026-13-01", 'number=" "', "profile_step_deg=1"]
)
def test_what_a_drawing_cannot_say(setting: str) -> None:
    with pytest.raises(SpecError, match=f"drawing.{setting.partition('=')[0]}"):
        read_mechanism(SPECS / "disc-cam.toml", [f"drawing.{setting}"])


def test_slopes_of_a_crossed_body_are_told() -> None:
    wedge = polygon([0j, 4 - 1j, 4 + 1j])
    assert edge_rows(wedge, True) == [
        ("0", "0", "corner, then at -14.04°"),
        ("4", "-1", "corner"),
        ("4", "1", "corner, then at 14.04°"),
    ]


# ---- labels ----------------------------------------------------------------------------------------------------------

SHIPPED = sorted([*SPECS.glob("*.toml"), *SPECS.glob("gallery/*.toml")])
CODES = {"%%c": "Ø", "%%d": "°", "%%p": "±"}


def text_box(entity: Any) -> Any:
    """What a line of text of a drawing takes in Helvetica."""
    said = entity.dxf.text
    for code, sign in CODES.items():
        said = said.replace(code, sign)
    height, way = entity.dxf.height, cmath.rect(1, math.radians(entity.dxf.get("rotation", 0)))
    wide = stringWidth(said, "Helvetica", height / 0.718)
    anchor = entity.dxf.align_point if entity.dxf.halign else entity.dxf.insert
    left = complex(anchor.x, anchor.y) - {0: 0.0, 1: 0.5, 2: 1.0}[entity.dxf.halign] * wide * way
    corners = [left, left + wide * way, left + (wide + 1j * height) * way, left + 1j * height * way]
    return shapely.Polygon([(z.real, z.imag) for z in corners])


def outline_of(entity: Any) -> Any:
    """A line, arc, circle or outline of a drawing as chords."""
    return shapely.LineString([(p.x, p.y) for p in path.make_path(entity).flattening(0.01)])


def collisions(space: Any) -> list[tuple[str, str]]:
    """Texts that lie on each other, and labels of holes that lie on an edge or under an arrowhead; those of sizes too."""
    shown = EntityQuery(space)
    for size in space.query("DIMENSION"):
        shown.extend(list(size.virtual_entities()))
    texts = [(entity, text_box(entity)) for entity in shown.query("TEXT")]
    found = [
        (texts[i][0].dxf.text, texts[j][0].dxf.text)
        for i, j in meetings([box for _, box in texts], [box for _, box in texts])
        if i < j and texts[i][1].intersection(texts[j][1]).area > 1e-9
    ]
    drawn = [
        (entity, box) for entity, box in texts if entity.dxf.layer == "DIM"
    ]  # sizes, and smaller the names of holes
    listed, most = (
        {entity.dxf.text for entity, _ in texts if entity.dxf.layer == "TEXT"},
        max(e.dxf.height for e, _ in drawn),
    )
    labels = [
        (entity, box)
        for entity, box in drawn
        if entity.dxf.text in listed and entity.dxf.height < 0.8 * most
    ]
    edges = [
        outline_of(each)
        for each in shown.query("LINE ARC CIRCLE LWPOLYLINE")
        if each.dxf.layer in ("CUT", "VIEW")
    ]
    heads = [
        shapely.Polygon([(p.x, p.y) for p in each.vertices()]) for each in shown.query("SOLID")
    ]
    boxes = [box for _, box in labels]
    found += [(labels[i][0].dxf.text, "edge") for i, _ in meetings(boxes, edges)]
    return found + [(labels[i][0].dxf.text, "arrow") for i, _ in meetings(boxes, heads)]


def meetings(shapes: list[Any], others: list[Any]) -> list[tuple[int, int]]:
    """Pairs, by their numbers, of a shape and one of the others that meet."""
    found = shapely.STRtree(others).query(np.array(shapes, object), "intersects")
    return [*zip(*found.tolist(), strict=True)]


@pytest.mark.long
@pytest.mark.parametrize("spec", SHIPPED, ids=lambda path: path.stem)
def test_no_label_of_a_shipped_drawing_lies_on_another_or_on_an_edge(
    spec: Path, tmp_path: Path
) -> None:
    machine = read_mechanism(spec, ()).resolved()
    for part in machine.assembly.parts:
        files = write_drawing(
            tmp_path, machine.name, part, machine.accuracy.chord_tolerance, facts_of(machine, part)
        )
        assert collisions(ezdxf.readfile(files[0]).modelspace()) == [], part.name


def test_labels_that_do_collide_are_found(tmp_path: Path) -> None:
    machine = read_mechanism(SPECS / "uniform-swing.toml", ())
    part = next(part for part in machine.assembly.parts if part.name == "cam")
    file = write_drawing(tmp_path, "d", part, 0.001, facts_of(machine, part))[0]
    space = ezdxf.readfile(file).modelspace()
    one, two = (
        next(each for each in space.query("TEXT[layer=='DIM']") if each.dxf.text == name)
        for name in ("B1", "B2")
    )
    two.dxf.align_point = one.dxf.align_point
    assert ("B1", "B2") in collisions(space) or ("B2", "B1") in collisions(space)
    two.dxf.align_point = (
        7 - 1.5,
        -1.25,
    )  # on the edge of a pin's hole, whose middle is 7 mm from the axis
    assert ("B2", "edge") in collisions(space)


CHART = {"at_deg": (90, 150, 250, 360), "to": (24, 24, 0, 0)}


@pytest.mark.long
@pytest.mark.parametrize(("radius", "at"), [(9.5, 90), (9.5, 60), (8.0, 90), (16.0, 120)])
def test_the_sense_of_turning_stands_clear_of_all_else(
    radius: float, at: int, tmp_path: Path
) -> None:
    """A steel cam with the tolerance of its track and the diameters of its radii, where paper is scarce."""
    angles = (at, *CHART["at_deg"][1:])
    rows = zip(angles, CHART["to"], strict=True)
    data: dict[str, Any] = {
        "mechanism": "disc-cam",
        "name": "feeder",
        "geometry": {"follower": {"motion": "translating", "shape": "roller", "radius": radius}},
        "segment": [{"at_deg": angle, "to": to, "law": "modified-sine"} for angle, to in rows],
        "parts": {"bore": 20},
        "material": {"name": "16MnCr5"},
    }
    for row in (1, 3):
        del data["segment"][row]["law"]
    machine = read_mechanism(data, ()).resolved()
    (part,) = machine.assembly.parts
    file = write_drawing(tmp_path, "d", part, 0.001, facts_of(machine, part))[0]
    space = ezdxf.readfile(file).modelspace()
    assert collisions(space) == []
    arc = max(space.query("ARC[layer=='TEXT']"), key=lambda each: each.dxf.radius)
    sign = next(each for each in space.query("TEXT") if each.dxf.text == "+")
    arrow = shapely.union(outline_of(arc), text_box(sign))
    others = [text_box(each) for each in space.query("TEXT") if each is not sign]
    lines = space.query("LINE ARC CIRCLE LWPOLYLINE[layer!='CENTER']")
    others += [outline_of(each) for each in lines if each is not arc]
    assert min(arrow.distance(each) for each in others) > 0.5


@pytest.mark.long
def test_only_cams_have_a_table_of_radii() -> None:
    """Of a machine with cams and wheels: the wheels' teeth are told in their notes."""
    machine = read_mechanism(SPECS / "gallery" / "dial-table.toml")
    names = [part.name for part in machine.assembly.parts]
    facts = {part.name: facts_of(machine, part) for part in machine.assembly.parts}
    told = {name for name, each in facts.items() if each.profile_step_deg}
    assert (
        told == {name for name in names if name.startswith("cam-")}
        and "gear-gears-follower" in names
    )


def test_a_place_is_written_one_way_and_no_datum_has_the_name_of_a_joint() -> None:
    """P, at 43.358, 28.776 of the coupler, is a hole and the middle of a rounding: both to hundredths, by a position within 0.05."""
    mechanism, found = facts("linkage", *starters.METAL["linkage"])
    (coupler,) = (each for each in mechanism.assembly.parts if each.name == "coupler")
    drawn = DrawnPart(coupler, "c", 1e-3, found["coupler"])
    assert {(x, y) for _, x, y, _ in drawn.rows if x} == {
        ("0", "0"),
        ("60", "0"),
        ("43.36", "28.78"),
    }
    names = {label for label, _ in drawn.named}
    assert drawn.datum_letter and drawn.datum_letter not in names


def test_datums_have_no_letter_that_is_misread_and_parts_the_names_of_their_field() -> None:
    """ISO 5459 advises against I, O and Q: the crank's hole O is datum D, as the bores of all parts, and its table has it as hole O still."""
    mechanism, found = facts("gallery/geneva-table", *starters.METAL["geneva-table"])
    parts = {part.name: part for part in mechanism.assembly.parts}
    crank = DrawnPart(parts["crank"], "x", 1e-3, found["crank"])
    assert (crank.datum_letter, crank.angle_letter, crank.rows[0][0]) == ("D", "E", "O")
    ground = DrawnPart(parts["ground"], "x", 1e-3, found["ground"])
    assert ground.datum_letter == "D" and ground.zero_is == "the centre of hole O"
    titles = {name: part.title for name, part in parts.items()}
    assert titles["crank"] == "Driver crank" and titles["table"] == "Table"
    assert titles["lock-crank_to_table"] == "Locking disc of crank"
    assert titles["shaft-table"] == "Shaft of table"


def test_the_corners_of_a_flat_have_a_radius(tmp_path: Path) -> None:
    said = _notes("geneva-crank_to_table", tmp_path, "parts.shaft_key=false")
    assert "corners of the flat at most R0.2" in said


def test_shafts_of_metal_run_in_bushes_whose_work_is_judged() -> None:
    """Of the Geneva table: two bushes of bronze 10 x 16 x 10 in a plate of 10, each with the play of what slides, at most 1.75 MPa m/s
    [mecmove.se]; without them the shafts of C45 run in C45, of which no limit is known."""
    metal = starters.METAL["geneva-table"]
    mechanism, _ = facts("gallery/geneva-table", *metal)
    bush = mechanism.assembly.by_name["bush"]
    (hole,) = map(round_of, bush.region.holes)
    assert hole is not None and 2 * hole[1] == pytest.approx(10.03)
    assert (bush.count, bush.thickness, bush.process) == (2, 10.0, "bought")
    assert "ISO 4379 C 10 x 16 x 10" in bush.notes[0]
    (judged,) = (each for each in assess(mechanism).findings if each.code == "PV")
    assert judged.ok and judged.limit == 1.75 and "bronze" in judged.message
    bare, _ = facts("gallery/geneva-table", *metal, "parts.pins={}")
    assert "PV" in {each.code for each in assess(bare).not_judged}


def test_a_roller_reaches_down_to_its_crank_where_the_wheel_lies_higher() -> None:
    """By hand: plate of 10, a play of 0.1, crank of 6, a gap of 2, wheel of 6: the roller is 7.9 high, from 16.2 to 24.1."""
    mechanism, _ = facts("gallery/geneva-table", *starters.METAL["geneva-table"])
    name = "roller-crank_to_table"
    roller = mechanism.assembly.by_name[name]
    (mount,) = (each for each in mechanism.assembly.mounts if each.part == name)
    assert roller.thickness == pytest.approx(7.9)
    assert mount.z == pytest.approx(16.2)


@pytest.mark.parametrize(
    ("settings", "said"),
    [
        ("parts.pins.P=bush", "parts.pins.P: no link turns there"),
        ("parts.base_thickness=5", "parts.base_thickness = 6"),
        ("parts.shaft_diameter=11", "a bore in which bushes are sold: 6, 8, 10, 12, 15, 16, 20"),
    ],
)
def test_bushes_that_cannot_be_are_refused(settings: str, said: str) -> None:
    with pytest.raises(DesignError) as caught:
        metal = starters.METAL["geneva-table"]
        facts("gallery/geneva-table", *metal, "geneva.0.gap=2", settings)
    whole = f"{caught.value.sentence} {caught.value.where} {caught.value.remedy}"
    assert said in whole


def test_a_hole_over_a_recess_says_how_far_it_goes_whatever_others_do() -> None:
    """A plate of 5: clearance holes of 3.4 over recesses of 6.2, 1.85 deep, so up to its upper face; core holes of 2.4 under recesses of
    4.3 that begin at 2.8, so from its lower face. Neither ends where the other's recess does."""
    mechanism = read_mechanism(SPECS / "gallery" / "walker.toml")
    part = mechanism.assembly.by_name["ground"]
    drawn = DrawnPart(part, "walker-ground", 1e-3, facts_of(mechanism, part))
    said = [size for *_, size in drawn.rows if size.startswith("Ø") and ", z " in size]
    assert said.count("Ø3.4, z 1.85 to 5") == said.count("Ø6.2, z 0 to 1.85") == 4
    assert said.count("Ø2.4, z 0 to 2.8") == said.count("Ø4.3, z 2.8 to 5") == 2
    assert len(said) == 12
