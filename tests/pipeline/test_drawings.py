"""What drawings say beside shapes: fits as the machines' authors meant them, material, mass, number, date; slopes."""

from __future__ import annotations

from pathlib import Path

import ezdxf
import pytest

from camgen.errors import SpecError
from camgen.files.dimensions import edge_rows
from camgen.files.drawing import write_drawing
from camgen.files.title_block import Facts
from camgen.geometry.outlines import polygon
from camgen.machines.mechanism import Mechanism
from camgen.pipeline.drawings import facts_of
from camgen.pipeline.jobs import read_mechanism

SPECS = Path(__file__).resolve().parents[2] / "specs"


def facts(spec: str, *settings: str) -> tuple[Mechanism, dict[str, Facts]]:
    mechanism = read_mechanism(SPECS / f"{spec}.toml", settings)
    return mechanism, {part.name: facts_of(mechanism, part) for part in mechanism.parts()}


def fits(found: Facts) -> dict[complex, str]:
    return {complex(round(fit.at.real, 6), round(fit.at.imag, 6)): fit.words for fit in found.fits}


def test_pins_of_a_linkage_are_pressed_in_one_link_and_turn_in_the_other() -> None:
    _, found = facts("linkage")
    assert fits(found["ground"]) == {0: "slide on Ø6", 70: "press on Ø5"}  # the plate's screws are no fits
    assert fits(found["crank"]) == {0: "press on Ø6", 20: "press on Ø5"}
    assert fits(found["coupler"]) == {0: "slide on Ø5", 60: "slide on Ø5"}
    assert fits(found["rocker"]) == {0: "slide on Ø5", 50: "press on Ø5"}
    assert not found["shaft"].fits


def test_fits_follow_the_clearances_of_the_spec() -> None:
    _, found = facts("thread-take-up", "print.slide_clearance=0.3", "print.press_clearance=0.1")
    told = [(fit.words.split(" on Ø"), fit.diameter) for fit in found["output-crank"].fits]
    assert [(word, round(hole - float(shaft), 6)) for (word, shaft), hole in told] == [("slide", 0.3), ("press", 0.1)]


def test_a_motor_s_shaft_and_collar_are_fits_too() -> None:
    _, found = facts("eccentric-drive")
    assert fits(found["disc"]) == {0: "press on Ø2"} and fits(found["body"])[0] == "press on Ø6"
    assert fits(found["motor-bar"]) == {0: "slide on Ø6"} and fits(found["rod"]) == {0: "slide on Ø9", 48: "slide on Ø3"}


def test_material_mass_number_and_date(tmp_path: Path) -> None:
    mechanism, found = facts("thread-take-up", "drawing.number=K-104", "drawing.date=2026-05-31", "material.infill=0.5")
    parts = {part.name: part for part in mechanism.parts()}
    for k, (name, one) in enumerate(found.items(), 1):
        printed = parts[name].made == "printed"
        density = 1.24 * 0.5 if printed else 7.85  # g/cm^3: PLA at half its filling, steel
        assert one.material == ("PLA" if printed else "steel")
        assert one.mass_g == pytest.approx(parts[name].volume / 1000 * density)
        assert (one.number, one.date, one.tolerance) == (f"K-104-{k:02d}", "2026-05-31", "ISO 2768-m")
    path, _ = write_drawing(tmp_path, "x", parts["output-crank"], 1e-3, found["output-crank"])
    texts = [entity.dxf.text for entity in ezdxf.readfile(path).modelspace().query("TEXT")]
    assert {"%%c26.8 slide on %%c26.6", "%%c3.5 press on %%c3.5", "2026-05-31"} <= set(texts)


@pytest.mark.parametrize("setting", ["tolerance=DIN 7168", "date=2026-13-01", 'number=" "', "profile_step_deg=1"])
def test_what_a_drawing_cannot_say(setting: str) -> None:
    with pytest.raises(SpecError, match=f"drawing.{setting.partition('=')[0]}"):
        read_mechanism(SPECS / "disc-cam.toml", [f"drawing.{setting}"])


def test_slopes_of_a_crossed_body_are_told() -> None:
    wedge = polygon([0j, 4 - 1j, 4 + 1j])
    assert edge_rows(wedge, True) == [
        ("0", "0", "corner, then at -14.04°"), ("4", "-1", "corner"), ("4", "1", "corner, then at 14.04°"),
    ]  # fmt: skip
