"""G-code of a built folder's plates: parts are found wherever they lie, and judged as their files are."""

import re
import tomllib
from collections import Counter
from pathlib import Path

import numpy as np
import pytest
import shapely
from sliced_parts import LAYER, WIDTH, laid

import camgen
from camgen.errors import FileError
from camgen.files.gcode import read_gcode
from camgen.files.stl import read_stl
from camgen.findings import Where
from camgen.geometry.mesh import slice_mesh
from camgen.judge.round_trip import pieces_of
from camgen.judge.sliced import PrintModel, bodies, copy_of, shapes_of
from camgen.judge.sliced_copies import judge_sliced_copies
from camgen.pipeline.sliced import check_gcode, left_out

SPEC = Path(__file__).parents[2] / "specs" / "linkage.toml"
GALLERY = Path(__file__).parents[2] / "specs" / "gallery"
MOVING = ("ground", "crank", "coupler", "rocker")


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """The four-bar's folder, solids alone; its shaft is not printed here, and counts as its file has it."""
    out = tmp_path_factory.mktemp("sliced")
    spec = tomllib.loads(SPEC.read_text(encoding="utf-8")) | {"name": "bars"}
    assert camgen.build(spec, out, only="stl").ok
    return out / "bars"


def failing(report):
    return {finding.code for finding in report.findings if not finding.ok}


@pytest.mark.long
def test_parts_are_found_wherever_they_lie(folder):
    report = check_gcode(folder, [laid(folder, MOVING)])
    assert not failing(report) and report.numbers["motion_error_pen_gcode_mm"] < 2e-3
    sizes = next(table for table in report.tables if table.title.startswith("Holes"))
    assert len([row for row in sizes.rows if row[1] == "hole"]) > 7
    for part, _, _, _, meant, first, small, large in sizes.rows:
        assert small == pytest.approx(meant, abs=4e-3) and large == pytest.approx(
            meant, abs=4e-3
        ), part
        assert first == pytest.approx(meant, abs=4e-3)
    assert any("perimeter_generator = arachne" in text and "1.1" in text for text in report.remarks)
    assert any("ground 4.8 for 5" in text for text in report.remarks)  # six layers of 0.8 mm
    assert any(
        "none of these plates" in each.why and "1 of collar" in each.why
        for each in report.not_judged
    )
    assert any("shaft: not on the plate" in each.why for each in report.not_judged)


@pytest.mark.long
def test_a_part_that_lies_turned_over(folder):
    """Its mirror image is laid; it is known where the folder's plates lay it so, and its holes are where they belong."""
    path = laid(folder, ["coupler"], mirrored=["coupler"])
    (body,) = bodies(read_gcode(path))
    solid = read_stl(folder / "bars-coupler.stl")
    assert copy_of(body, [PrintModel("coupler", solid, np.eye(3))]) is None
    copy = copy_of(
        body,
        [
            PrintModel("coupler", solid, np.eye(3)),
            PrintModel("coupler", solid, np.diag([-1.0, 1.0, -1.0])),
        ],
    )
    assert copy.known.over and copy.height(copy.layers[0]) == pytest.approx(4 - LAYER / 2)
    (shape,) = shapes_of(copy, copy.layers[1])
    (wanted,) = pieces_of(slice_mesh(solid, 2.0))
    centres = sorted((hole.centroid for hole in shape.holes), key=lambda z: z.real)
    assert centres == pytest.approx(
        sorted((hole.centroid for hole in wanted.holes), key=lambda z: z.real), abs=2e-3
    )


@pytest.mark.parametrize("start", [5, 95, 185, 300])
def test_a_bar_whose_holes_differ_lies_one_way(folder, start):
    """The rocker's outline is alike after half a turn, its holes are not: 5.2 mm at its pivot, 5.0 at the other end."""
    (body,) = bodies(read_gcode(laid(folder, ["rocker"], start=start)))
    copy = copy_of(body, [PrintModel("rocker", read_stl(folder / "bars-rocker.stl"), np.eye(3))])
    (shape,) = shapes_of(copy, copy.layers[1])
    sizes = {round(hole.centroid.real): 2 * (hole.area / np.pi) ** 0.5 for hole in shape.holes}
    assert sizes == pytest.approx({0: 5.2, 50: 5.0}, abs=5e-3)


def drilled(flat, at, diameter):
    """A flat part whose hole near a place is another one."""
    return flat.union(shapely.Point(50, 0).buffer(2.7)).difference(
        shapely.Point(at, 0).buffer(diameter / 2, quad_segs=64)
    )


@pytest.mark.long
def test_each_is_seen_to_fail(folder):
    """The rocker's hole 0.05 mm too far out in all layers, and in one of them 0.1 mm too tight: a pin feels all of them."""

    def change(name, k, flat):
        return drilled(flat, 50.05, 4.9 if k == 3 else 5.0) if name == "rocker" else flat

    report = check_gcode(folder, [laid(folder, MOVING, change)])
    assert failing(report) == {"MOTION_ERROR", "PIN_GAP"}
    tight = next(finding for finding in report.findings if finding.code == "PIN_GAP")
    assert tight.measured == pytest.approx(0.1, abs=0.01)
    (row,) = (row for row in report.tables[1].rows if row[0] == "rocker" and row[2] > 40)
    assert row[6] == pytest.approx(4.9, abs=3e-3) and row[7] == pytest.approx(5.0, abs=3e-3)


def test_holes_that_are_lost_and_outlines_that_grow(folder):
    """On a plate of parts that do not move nothing but the contours is judged, and that is said."""
    changes = (
        lambda name, k, flat: shapely.Polygon(flat.exterior) if k == 2 else flat,
        lambda name, k, flat: flat.buffer(0.3),
    )
    for change in changes:
        report = check_gcode(folder, [laid(folder, ["collar"], change)])
        assert failing(report) == {"COPIES"}  # such a body is like no part
        assert any(each.code == "MOTION_ERROR" for each in report.not_judged)


@pytest.mark.long
@pytest.mark.parametrize("height", [f";HEIGHT:{LAYER}", ""])
def test_layers_that_are_missing(folder, height):
    """Two layers out of the middle, and the last one cut off: nothing holds them up, or the part is too low."""
    path = laid(folder, ["collar"])
    first, *layers = path.read_text().split("G1 Z")
    layers = [f"G1 Z{layer}" for layer in layers]

    def wrong(kept):
        path.write_text("\n".join([f"{first}{height}", *kept]))
        return [
            (str(finding.where), finding.measured)
            for finding in check_gcode(folder, [path]).findings
            if not finding.ok
        ]

    assert len(layers) == 5 and not wrong(layers)
    ((where, gap),) = wrong(layers[:2] + layers[3:])
    assert "collar, gap" in where and gap == pytest.approx(LAYER)
    ((where, short),) = wrong(layers[:-1])
    assert "collar, height" in where and short == pytest.approx(LAYER)
    if height:  # without it nothing tells a first layer that is high from one that is missing, nor half of all layers
        assert [gap for _, gap in wrong(layers[::2])] == pytest.approx([LAYER])


def test_the_first_layer_is_told_by_itself(folder):
    """It is squeezed out by 0.2 mm: no finding, but a figure; with a solid drawn in against it already one that fails."""
    squeezed = laid(folder, ["collar"], lambda name, k, flat: flat.buffer(0.2 * (k == 0)))
    report = check_gcode(folder, [squeezed])
    assert not failing(report)
    assert report.tables[0].rows[0][4:6] == pytest.approx((0.2, 0.2), abs=5e-3)
    spec = (folder / "spec.toml").read_text(encoding="utf-8")
    (folder / "spec.toml").write_text(
        spec.replace("elephant_foot = 0.0", "elephant_foot = 0.2"), encoding="utf-8"
    )
    try:
        assert failing(check_gcode(folder, [squeezed])) == {"FIRST_LAYER"}
        assert not failing(check_gcode(folder, [laid(folder, ["collar"])]))
    finally:
        (folder / "spec.toml").write_text(spec, encoding="utf-8")


@pytest.mark.long
def test_what_is_sent_otherwise_than_it_prints(tmp_path):
    """Holes sent larger, outlines smaller, all against shrinkage, a chamfer at the foot: it prints as designed."""
    spec = tomllib.loads(SPEC.read_text(encoding="utf-8")) | {"name": "bars"}
    more = {
        "hole_compensation": 0.1,
        "profile_compensation": 0.06,
        "shrinkage": 0.003,
        "elephant_foot": 0.2,
    }
    camgen.build(spec | {"print": spec["print"] | more}, tmp_path, only="stl")
    report = check_gcode(tmp_path / "bars", [laid(tmp_path / "bars", MOVING)])
    assert not failing(report) and report.numbers["motion_error_pen_gcode_mm"] < 2e-3


def test_on_a_raft_beside_a_part_of_other_layers(folder):
    """All of it 2 mm up, and beside it a body in layers half as high, which are none of its own."""
    path = laid(folder, ["collar"])
    text = re.sub(r"G1 Z([\d.]+)", lambda z: f"G1 Z{float(z[1]) + 2:.3f}", path.read_text())
    square = "G1 X-50 Y0\nG1 Z{}\n;TYPE:External perimeter\nG1 X-41 Y0 E1\nG1 X-41 Y9 E1\nG1 X-50 Y9 E1\nG1 X-50 Y0 E1"
    path.write_text("\n".join([text, *(square.format(0.4 * k) for k in range(1, 16))]))
    report = check_gcode(folder, [path])
    assert report.tables[0].rows[0][0] == "collar" and report.tables[0].rows[0][2] == pytest.approx(
        4.0
    )
    assert [finding.measured for finding in report.findings if not finding.ok] == [
        1
    ]  # the body that is no part


def test_what_lies_there_besides(folder):
    square = "G1 X0 Y0\nG1 Z{}\n;TYPE:External perimeter\nG1 X9 Y0 E1\nG1 X9 Y9 E1\nG1 X0 Y9 E1\nG1 X0 Y0 E1"
    cube = folder.parent / "cube.gcode"
    cube.write_text("\n".join(["M83", f";WIDTH:{WIDTH}", *(square.format(z) for z in (2, 4))]))
    report = check_gcode(folder, [laid(folder, ["collar"]), cube])
    (finding,) = (finding for finding in report.findings if not finding.ok)
    assert finding.code == "COPIES" and finding.measured == 1 and "like no part" in finding.message


def test_a_part_on_a_side_is_not_said_to_be_missing():
    """What it counts as in the motion is told with its true reason: more plates would not help."""
    told = {(each.code, each.needs): each.why for each in left_out(["shaft"], {"shaft", "crank"})}
    assert set(told) == {
        ("ROUND_TRIP", "its STL"),
        ("MOTION_ERROR", "them upright"),
        ("MOTION_ERROR", "all plates"),
    }
    assert (
        told["MOTION_ERROR", "all plates"]
        == "crank: not on the plate and counts as its file has it"
    )
    assert told["MOTION_ERROR", "them upright"].startswith("shaft: on a side")
    assert [each.code for each in left_out(["shaft"], ())] == ["ROUND_TRIP"]


def test_a_plate_is_given_once(folder):
    """The same bytes are refused; the same parts sliced again lie there twice."""
    plate = laid(folder, ["collar"])
    again = plate.rename(plate.with_name("again.gcode"))
    plate.write_bytes(again.read_bytes())
    for twice in ([plate, plate], [plate, again]):
        with pytest.raises(FileError, match="again, byte by byte"):
            check_gcode(folder, twice)
    again.write_text(again.read_text() + "\n; sliced an hour later")
    (finding,) = (
        finding for finding in check_gcode(folder, [plate, again]).findings if not finding.ok
    )
    assert (
        finding.unit == "copies"
        and finding.measured == 1
        and "sliced twice: 1 of collar" in finding.message
    )


@pytest.mark.long
def test_copies_of_parts_that_are_alike_stand_in_for_each_other(tmp_path):
    """The bird's rods: one is the other turned over. Two are both of them, one is one too few, three are one too many."""
    spec = tomllib.loads((GALLERY / "flapping-bird.toml").read_text(encoding="utf-8"))
    assert camgen.build(spec | {"name": "bird"}, tmp_path, only="stl").ok
    others = ["crank", "collar", "spacer-1", "hand-crank", "knob-pin"]
    others += 3 * ["pin-1"] + 2 * ["pin-2"]  # more than half of all parts
    for rods, said in (
        (["left_rod", "left_rod"], None),
        (["right_rod", "left_rod"], None),
        (
            ["right_rod"],
            "few for the parts list: 1 of ground, 1 of knob, 1 of left_rod or right_rod",
        ),
        (["left_rod"] * 3, "as if sliced twice: 1 of left_rod or right_rod"),
    ):
        report = check_gcode(tmp_path / "bird", [laid(tmp_path / "bird", [*rods, *others])])
        (copies,) = (
            finding
            for finding in report.findings
            if finding.code == "COPIES" and "like no part" not in finding.message
        )
        assert said in copies.message if said else "rod" not in copies.message
        told = {row[0] for row in report.tables[0].rows}
        assert ({"left_rod", "right_rod"} <= told) is (len(rods) > 1)


PARTS = Counter({"cam": 1, "pin": 4, "link": 3})
PLATES = {"plate": Counter({"cam": 1, "pin": 2}), "plate-2": Counter({"pin": 2, "link": 3})}


@pytest.mark.parametrize(
    ("laid", "wrong", "said", "unknown"),
    [
        ({"cam": 1, "pin": 4, "link": 3}, 0, "8 copies", None),
        (
            {"cam": 1, "pin": 3, "link": 3},
            1,
            "too few for the parts list: 1 of pin",
            None,
        ),  # one is not printed
        ({"cam": 1, "pin": 5, "link": 3}, 1, "sliced twice: 1 of pin", None),
        (
            {"cam": 1, "pin": 5, "link": 2},
            2,
            "parts list: 1 of link; too many, as if sliced twice: 1 of pin",
            None,
        ),
        (
            {"pin": 4, "link": 3},
            1,
            "parts list: 1 of cam",
            None,
        ),  # forgotten on its own plate, of which two thirds are there
        ({"cam": 1, "pin": 2}, 0, "", "plate-2"),  # one plate alone
        ({"pin": 2, "link": 3}, 0, "", "plate"),
        ({"pin": 1, "link": 3}, 1, "too few for the parts list: 1 of pin", "plate"),
        ({"link": 1}, 0, "", "plate, plate-2"),  # one link is printed anew
    ],
)
def test_copies_against_the_list_of_parts(laid, wrong, said, unknown):
    finding, not_judged = judge_sliced_copies(Counter(laid), PARTS, PLATES, Where(file="x.gcode"))
    assert finding.measured == wrong and finding.ok is (wrong == 0) and said in finding.message
    assert [each.needs for each in not_judged] == ([f"the G-code of {unknown}"] if unknown else [])


def test_walls_over_each_other_that_are_far_too_many(folder, monkeypatch):
    monkeypatch.setattr("camgen.judge.sliced._MOST_MET", 3)
    with pytest.raises(
        FileError,
        match="plate.gcode: has walls that lie over each other more than 3 times: slice fewer parts",
    ):
        check_gcode(folder, [laid(folder, ["rocker"])])


def test_a_folder_without_solids(folder, tmp_path):
    for name in ("spec.toml", "manifest.json"):
        (tmp_path / name).write_bytes((folder / name).read_bytes())
    with pytest.raises(FileError, match="no STL or 3MF"):
        check_gcode(tmp_path, [tmp_path / "p.gcode"])
