"""Faces between the layers of a print: by hand, on whichever side a part lies."""

import tomllib
from pathlib import Path

import numpy as np
import pytest

import camgen
from camgen.files.parts_list import parts_list
from camgen.files.plates import Side, lying_side
from camgen.parts.solids import solid
from camgen.pipeline.whole_layers import between, too_thin

SPECS = Path(__file__).parents[2] / "specs"
OVER = Side(turn=np.diag([-1.0, 1.0, -1.0]))


def found(layer, sides, **more):
    spec = tomllib.loads((SPECS / "linkage.toml").read_text(encoding="utf-8"))
    table, said = between(
        camgen.load({**spec, "print": {**spec["print"], "layer": layer, **more}}).resolved(), sides
    )
    return {(part, height): (near, off) for part, height, near, off in table.rows}, said


def test_plates_of_4_mm_in_layers_of_03():
    """The first of 0.2 mm, then 12 of 0.3 make 3.8: the top lies 0.2 over it, and 0.1 under the next."""
    rows, said = found(0.3, {})
    assert rows["rocker", 4.0] == pytest.approx((4.1, -0.1))
    assert (
        said[0].startswith("print.layer = 0.3: these faces lie between two layers")
        and "more" in said[0]
    )
    assert ("rocker", 4.0) not in found(0.2, {})[0] and ("rocker", 4.0) in found(
        0.2, {}, first_layer=0.35
    )[0]


def test_a_pin_on_its_head_and_on_its_end():
    """Head 1.5 mm high, 8.4 + 1.5 mm long in all: lying on its head it steps at 1.5, on its end at 8.4."""
    on_its_head, on_its_end = found(0.2, {})[0], found(0.2, {"pin-2": OVER})[0]
    (whole,) = {height for part, height in on_its_head if part == "pin-2"} - {1.5}
    assert on_its_head["pin-2", 1.5] == pytest.approx((1.4, 0.1)) or on_its_head[
        "pin-2", 1.5
    ] == pytest.approx((1.6, -0.1))
    assert {height for part, height in on_its_end if part == "pin-2"} == {
        whole
    }  # 8.4 is on a layer, the end is not
    lying = Side(height=5.1, turn=np.array([[0.0, 0, 1], [0, 1, 0], [-1, 0, 0]]))
    assert {height for part, height in found(0.2, {"pin-2": lying})[0] if part == "pin-2"} == {5.1}


def test_no_layer_tells_nothing_and_layers_count_in_the_time():
    assert found(None, {}) == ({}, ())
    (part,) = [
        part for part in camgen.load(SPECS / "linkage.toml").assembly.parts if part.name == "rocker"
    ]
    coarse, fine = (parts_list([part], 1.24, layer=layer)[0].print_min for layer in (0.2, 0.1))
    flow = part.volume / (0.4 * 0.2 * 60)
    assert fine - coarse == pytest.approx(
        (flow + 20 * 6.0) / 60
    )  # half the flow, and twenty layers more


def test_spreaders_lie_on_their_large_face():
    """49 mm^2 would lie on the bed as drawn; on a side it is the whole flank, and next to nothing hangs over."""
    parts = {
        part.name: part
        for part in camgen.load(SPECS / "chain-stitch-looper.toml").resolved().assembly.parts
    }
    for name in ("lower-spreader", "upper-spreader"):
        side = lying_side(solid(parts[name], 0.005))
        assert side.contact > 173 and side.overhang < 20 and side.name.startswith("on its side")


@pytest.mark.long
def test_a_part_with_a_stretch_thinner_than_a_layer_is_named(tmp_path):
    """The starter's cam has a hub, so that its web alone is thin."""
    cam = camgen.load(SPECS / "disc-cam.toml")
    assert too_thin(cam) == ()
    thin = cam.replace({"parts.thickness": 0.1})
    (said,) = too_thin(thin)
    assert "cam 0.1 mm" in said and "layer of 0.2 mm" in said and "parts.thickness" in said
    assert too_thin(cam.replace({"parts.thickness": 0.2})) == ()
    assert too_thin(cam.replace({"parts.thickness": 0.25, "print.layer": 0.3}))
    assert too_thin(thin.replace({"material.name": "C45"})) == ()  # not printed
    report = camgen.build(thin, tmp_path, only="stl,3mf")
    assert any("thinner than a layer of 0.2 mm: cam 0.1 mm" in note for note in report.warnings)
