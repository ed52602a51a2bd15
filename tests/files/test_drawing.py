"""The drawing sheet: right sizes, scale and labels, one layout in two formats."""

import cmath
import math
import re
import tomllib
from dataclasses import replace

import ezdxf
import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st
from test_solids import TOLERANCE, cam, hub, oval

from camgen.files import drawing, shaft_sheet, symbols, views
from camgen.files.dimensions import (
    Hole,
    edge_rows,
    holes_of,
    hollow_radius,
    lock_of,
    nearest_and_farthest,
    number,
)
from camgen.files.drawing import _Layout, write_drawing
from camgen.files.labels import Label, along, box, callouts
from camgen.files.sheet import LAYERS, Fill, Sheet, Size, Stroke, Text
from camgen.files.title_block import Facts, weighed
from camgen.geometry.arcs import fit_arcs
from camgen.geometry.facets import facet_contour
from camgen.geometry.outlines import (
    Arc,
    Contour,
    Line,
    Region,
    Smooth,
    circle,
    end_point,
    extent,
    kidney,
    polygon,
    start_point,
)
from camgen.machines.sources import read_mechanism
from camgen.parts.part import Layer, Part, Tap, d_bore, hull, keyed_bore
from camgen.parts.wheels.geneva import Geneva, InnerGeneva
from camgen.pipeline.drawings import facts_of
from camgen.starters import METAL, in_metal

META = Facts("uniform-swing", "steel (C45)", 12.345, "ISO 2768-m")


def texts_of(path):
    """All texts in order, those in the blocks of dimensions too."""
    space = ezdxf.readfile(path).modelspace()
    shown = (e.virtual_entities() if e.dxftype() == "DIMENSION" else (e,) for e in space)
    return [e.dxf.text for each in shown for e in each if e.dxftype() == "TEXT"]


def test_a_window_has_its_label_inside_and_a_slot_at_the_edge_none_outside() -> None:
    """A plate of 100 x 60, a window of 60 x 20 about the centre lines, and a slot of 2 x 20 whose label is wider, 2 from the edge."""
    sheet = Sheet(200, 150, "plate")

    def rectangle(low: complex, high: complex) -> Contour:
        corners = (low, complex(high.real, low.imag), high, complex(low.real, high.imag))
        return polygon(corners)

    plate = rectangle(50 + 50j, 150 + 110j)
    window = rectangle(70 + 70j, 130 + 90j)
    slot = rectangle(52 + 70j, 54 + 90j)
    for contour in (plate, window, slot):
        sheet.contour(contour, "VIEW")
    sheet.line(45 + 80j, 155 + 80j, layer="CENTER")
    sheet.line(100 + 45j, 100 + 115j, layer="CENTER")
    labels = [
        Label("F", Hole(100 + 80j, "", 100 + 80j, 0.0), along([window])),
        Label("C1", Hole(53 + 80j, "", 53 + 80j, 0.0), along([slot])),
    ]
    inner, beside = callouts(labels, sheet, (10 + 10j, 190 + 140j))
    assert inner.tip is None and shapely.box(70, 70, 130, 90).contains(box(inner.text))
    assert beside.tip is not None or shapely.box(50, 50, 150, 110).contains(box(beside.text))


def unescaped(text):
    """A string of a PDF as it is read: bytes outside ASCII stand there in octal."""
    plain = re.sub(r"\\(\d{3})", lambda m: bytes([int(m[1], 8)]).decode("cp1252"), text)
    return re.sub(r"\\([()\\])", r"\1", plain)


def disc(radius, shift=0.0):
    return Part(
        "disc",
        "Disc",
        (Layer(Region(circle(shift, radius), (circle(0, radius / 4),)), 0, 4),),
        3,
        (),
        (0j,),
    )


@pytest.mark.parametrize("drawn", [1, 2])
def test_a_recess_in_the_far_face_is_dashed(tmp_path, drawn):
    """A plate of 60 x 30 x 5 seen from z = 5: of two holes of 3.4 one has its recess of 6.2 in the lower face, below 3.15 of
    material, the other in the upper one, where both circles are seen; whichever layer a laser cuts."""
    edge = polygon([-30 - 15j, 30 - 15j, 30 + 15j, -30 + 15j])
    heights = ((0, 1.85, (3.1, 1.7)), (1.85, 3.15, (1.7, 1.7)), (3.15, 5, (1.7, 3.1)))
    layers = tuple(
        Layer(Region(edge, (circle(-15, below), circle(15, above))), z0, z1)
        for z0, z1, (below, above) in heights
    )
    part = Part("plate", "Plate", layers, centres=(0j,), drawn_layer=drawn)
    path, _ = write_drawing(tmp_path, "d", part, TOLERANCE, META)
    circles = ezdxf.readfile(path).modelspace().query("CIRCLE")
    lines = {(e.dxf.layer, round(e.dxf.center.x, 6), round(e.dxf.radius, 6)) for e in circles}
    seen = {each[1:] for each in lines if each[0] != "HIDDEN"}
    dashed = {each[1:] for each in lines if each[0] == "HIDDEN"}
    assert seen == {(-15, 1.7), (15, 1.7), (15, 3.1)}
    assert dashed == {(-15, 3.1)}


@pytest.mark.parametrize("part", [cam(), hub()], ids=lambda p: p.name)
def test_dxf_has_the_part_at_its_own_size(tmp_path, part):
    dxf, pdf = write_drawing(tmp_path, "demo", part, TOLERANCE, META)
    assert (dxf.name, pdf.name) == (
        f"demo-{part.name}-drawing.dxf",
        f"demo-{part.name}-drawing.pdf",
    )
    doc = ezdxf.readfile(dxf)
    assert not doc.audit().errors and doc.header["$INSUNITS"] == 4
    space = doc.modelspace()
    assert {e.dxf.layer for e in space} <= set(LAYERS)
    cut = space.query("*[layer=='CUT']")
    assert len(cut) == 1 + len(part.region.holes)
    x, y = zip(*cut[0].get_points("xy"), strict=True)
    assert (min(x), max(x)) == pytest.approx((-25, 37), abs=0.05)
    texts = texts_of(dxf)
    # oval of mean 28, wave 3 about x = 6: 62 wide; 50 high
    assert {"(62)", "(50)", "outer circle (R37)", part.title, "mm", str(part.count)} <= set(texts)


def test_both_outputs_say_the_same(tmp_path):
    dxf, pdf = write_drawing(tmp_path, "demo", cam(), TOLERANCE, META)
    content = pdf.read_bytes().decode("cp1252")
    lines = [unescaped(t) for t in re.findall(r"Tm \((.*)\) Tj", content)]
    codes = str.maketrans({"Ø": "%%c", "°": "%%d", "±": "%%p", "×": "x"})
    assert [line.translate(codes) for line in lines] == texts_of(dxf)
    assert "/MediaBox [ 0 0 841.8898 595.2756 ]" in content  # A4 [ISO 216]


@pytest.mark.parametrize("part", [cam(), hub(), disc(9), disc(900)], ids=lambda p: p.name)
def test_sizes_are_dimensions_that_measure_what_they_say(tmp_path, part):
    """The points that a CAD program measures by, the numbers that its block shows, and the part's own size."""
    doc = ezdxf.readfile(write_drawing(tmp_path, "d", part, TOLERANCE, META)[0])
    outer = fit_arcs(part.region.outer, TOLERANCE)
    found = {}
    for size in doc.modelspace().query("DIMENSION"):
        assert size.dxf.layer == "DIM" and size.dimtype == 0  # linear
        shown = list(size.virtual_entities())
        kinds = [each.dxftype() for each in shown]
        assert kinds.count("SOLID") == 2 and kinds.count("TEXT") == 1 and "LINE" in kinds
        (text,) = (each.dxf.text for each in shown if each.dxftype() == "TEXT")
        style = size.override()
        own = size.get_measurement() * style.get("dimlfac", 1.0)
        measured = number(own, style.get("dimdec", 3))
        assert text == size.dxf.text.replace("<>", measured)
        assert size.dxf.actual_measurement == pytest.approx(size.get_measurement())
        found.setdefault(round(size.dxf.angle), []).append(size.get_measurement())
    low, high = extent([outer, *(layer.region.outer for layer in part.layers)])
    assert found[0] == pytest.approx([(high - low).real, part.thickness, *found[0][2:]])
    if "hub" not in part.name and part.name != "disc":
        assert found[90][0] == pytest.approx((high - low).imag)
    style = doc.dimstyles.get("camgen")
    (scale,) = {
        round(3.5 / text.dxf.height, 9)
        for size in doc.modelspace().query("DIMENSION")
        if size.override().get("dimlfac", 1.0) == 1.0  # in no detail
        for text in size.virtual_entities()
        if text.dxftype() == "TEXT"
    }
    assert style.dxf.dimtxt == pytest.approx(3.5 / scale) == doc.header["$DIMTXT"]
    assert doc.header["$DIMSCALE"] == 1  # by another one LibreCAD scales the widths of all lines


@pytest.mark.parametrize(
    ("radius", "scale", "sheet"),
    [
        (2.5, "10:1", "A4"),
        (9, "2:1", "A4"),
        (40, "1:1", "A4"),
        (80, "1:1", "A3"),
        (900, "1:10", "A3"),
    ],
)
def test_scale_and_sheet(tmp_path, radius, scale, sheet):
    texts = texts_of(write_drawing(tmp_path, "d", disc(radius), TOLERANCE, META)[0])
    assert texts[texts.index("Scale") + 1] == scale and texts[texts.index("Sheet") + 1] == sheet
    assert f"%%c{number(2 * radius)}" in texts


@settings(max_examples=10)
@given(radius=st.floats(0.5, 2000), share=st.floats(-0.5, 0.5))
def test_nothing_leaves_the_frame(tmp_path_factory, radius, share):
    folder = tmp_path_factory.mktemp("d")
    _, pdf = write_drawing(folder, "d", disc(radius, share * radius), TOLERANCE * radius, META)
    content = pdf.read_bytes().decode("cp1252")
    width, height = (
        float(v) / 72 * 25.4 for v in re.search(r"MediaBox \[ 0 0 (\S+) (\S+) \]", content).groups()
    )
    pairs = re.findall(r"(-?[\d.]+) (-?[\d.]+) (?=[mlc]\b)", content)
    points = [complex(float(x), float(y)) for x, y in pairs if (x, y) != ("0", "0")]
    assert min(z.real for z in points) >= 19.999 and max(z.real for z in points) <= width - 9.99
    assert min(z.imag for z in points) >= 9.999 and max(z.imag for z in points) <= height - 9.99


def test_holes_are_named_and_described():
    contours = [
        circle(0, 4),
        circle(10, 1.5),
        circle(10j, 1.5),
        kidney(0, 18, 4, math.radians(20), math.radians(50)),
        keyed_bore(10, 3, 1.4),
        polygon([0, 4, 4 + 2j, 2j]),
    ]
    named = {label: (hole.place, hole.shape) for label, hole in holes_of(contours)}
    assert named == {
        "A": (0, "Ø8"),
        "B1": (10, "Ø3"),
        "B2": (10j, "Ø3"),
        "C": (0, "slot 8 on R18, 20.0° - 70.0°"),
        "D": (0, "Ø10, keyway 3, 11.4 overall"),
        "E": (2 + 1j, "4 × 2"),
    }


def test_a_straight_slot_is_told_by_its_length_its_width_and_how_it_leans():
    """30 mm from middle to middle, 5 mm wide: 35 mm over all, wherever it points; a box says nothing of a leaning one."""
    for lean, told in ((0, ""), (30, ", at 30°"), (90, ", at 90°"), (210, ", at 30°")):
        way = cmath.rect(1, math.radians(lean))
        ((_, hole),) = holes_of([hull([(4 + 0j, 2.5), (4 + 30 * way, 2.5)])])
        assert (hole.shape, abs(hole.place - (4 + 15 * way)) < 1e-5) == (f"slot 35 × 5{told}", True)
    ((_, tapered),) = holes_of([hull([(0j, 2.5), (30 + 0j, 2.0)])])
    assert "slot" not in tapered.shape


def test_a_slot_across_the_axis_is_told_from_below_to_above():
    ((_, hole),) = holes_of([kidney(0, 18, 4, math.radians(-17.4), math.radians(34.8))])
    assert hole.shape == "slot 8 on R18, -17.4° to 17.4°"


def test_holes_at_points_of_the_spec_have_their_names():
    contours = [circle(0, 4), circle(10, 1.5), circle(10j, 1.5), circle(5, 1)]
    named = {
        label: hole.place
        for label, hole in holes_of(contours, (("pivot", 10 + 0j), ("B", 0j), ("far", 99 + 0j)))
    }
    assert named == {"B": 0, "pivot": 10, "1": 10j, "2": 5}


def test_a_link_is_drawn_with_the_points_of_its_spec(root, tmp_path):
    """Its holes by their names; screws of the plate by numbers, as no point is called."""
    parts = {
        part.name: part for part in read_mechanism(root / "specs" / "linkage.toml").assembly.parts
    }
    labels = {
        name: texts_of(write_drawing(tmp_path, "d", parts[name], TOLERANCE, META)[0])
        for name in ("coupler", "ground")
    }
    assert {"A", "B", "P"} <= set(labels["coupler"]) and {"O", "C", "1", "2"} <= set(
        labels["ground"]
    )
    assert not {"A", "B", "A1", "B1"} & set(labels["ground"])


def test_table_that_is_too_long_says_so(tmp_path):
    holes = tuple(circle(30 * cmath.exp(2j * math.pi * k / 60), 0.5 + k / 100) for k in range(60))
    part = Part("sieve", "Sieve", (Layer(Region(circle(0, 40), holes), 0, 2),))
    texts = texts_of(write_drawing(tmp_path, "d", part, TOLERANCE, META)[0])
    (more,) = [t for t in texts if "more: see d-sieve.dxf" in t]
    listed = sum(1 for t in texts if re.fullmatch(r"%%c[01]\.?\d*|%%c2(\.\d+)?", t))
    assert listed + int(more.split()[0]) == 60


def test_least_and_greatest_radius():
    near, far = nearest_and_farthest(fit_arcs(circle(3 + 4j, 7), TOLERANCE))
    assert (abs(near), abs(far)) == pytest.approx((2, 12))
    near, far = nearest_and_farthest(polygon([-1 - 2j, 5 - 2j, 5 + 3j, -1 + 3j]))
    assert (near, far) == (-1, 5 + 3j)
    near, far = nearest_and_farthest(fit_arcs(oval(28, 3, 0), 1e-5))
    assert (abs(near), abs(far)) == pytest.approx((25, 31), abs=2e-5)


@pytest.mark.parametrize(
    ("value", "text"),
    [(0, "0"), (-1e-9, "0"), (8, "8"), (100, "100"), (-2.5, "-2.5"), (1 / 3, "0.333")],
)
def test_numbers(value, text):
    assert number(value) == text


def test_halves_are_rounded_away_from_zero():
    """15.2 + 8.025 and 15.2 - 8.025: both walls of a groove by the same rule, whatever their binary digits."""
    assert [number(15.2 + side * 8.025, 2) for side in (1, -1)] == ["23.23", "7.18"]
    assert [number(each, 1) for each in (67.45, -67.45, 0.05, 67.44)] == [
        "67.5",
        "-67.5",
        "0.1",
        "67.4",
    ]


def test_edges_that_are_no_curve_are_dimensioned():
    assert edge_rows(polygon([1 - 2j, 5 - 2j, 5 + 3j, 1 + 3j])) == [
        ("1", "-2", "4 × 5, its lower left corner")
    ]
    assert edge_rows(hull([(0j, 3.0), (10 + 0j, 2.0)])) in (
        [("10", "0", "R2"), ("0", "0", "R3")],
        [("0", "0", "R3"), ("10", "0", "R2")],
    )
    wedge = polygon([0j, 4 - 1j, 4 + 1j])
    assert edge_rows(wedge) == [("0", "0", "corner"), ("4", "±1", "corner")]
    assert edge_rows(circle(2j, 3)) == [("0", "2", "Ø6, its edge")]
    assert edge_rows(oval(28, 3, 0)) == [("", "", "a curve by DXF")]


def test_only_a_cam_turns(tmp_path):
    """Radii to a curve and the sense of turning are for cams; a plain part gets its layers' edges."""
    bar = Region(hull([(0j, 3.0), (10 + 0j, 2.0)]), (circle(0, 1),))
    rail = Region(polygon([4 - 1j, 8 - 1j, 8 + 1j, 4 + 1j]), (circle(6, 0.5),))
    part = Part("bar", "Bar", (Layer(bar, 0, 2), Layer(rail, 2, 5)), bore=2.0)
    texts = texts_of(write_drawing(tmp_path, "d", part, TOLERANCE, META)[0])
    assert not any("circle (R" in t or t.startswith("+") for t in texts)
    assert {
        "Edges, z 0 to 2:",
        "R3",
        "R2",
        "Edges, z 2 to 5:",
        "4 x 2, its lower left corner",
        "%%c1",
    } <= set(texts)
    turning = texts_of(write_drawing(tmp_path, "d", replace(cam(), bore=8.0), TOLERANCE, META)[0])
    assert "+" in turning and "outer circle (R37)" in turning


def test_notes_stay_beside_the_title_block(tmp_path):
    words = "A note that is far too long to stand beside the title block " * 3
    part = Part("disc", "Disc", disc(9).layers, notes=(words,))
    texts = texts_of(write_drawing(tmp_path, "d", part, TOLERANCE, META)[0])
    lines = [t for t in texts if len(t) > 1 and t in words]
    assert len(lines) > 2 and " ".join(lines[::-1]) == words.strip()
    assert all(Text(0, line, 2.5).width <= 91 for line in lines)


def test_a_shaft_is_told_by_its_diameter_and_how_deep_its_flats_are(tmp_path):
    """A round bar of 6 mm, filed to 5.2 mm over one flat that faces up."""
    half = math.sqrt(9 - 2.2**2)
    arc = Arc(0j, 3.0, math.pi - math.atan2(2.2, half), math.pi + 2 * math.atan2(2.2, half))
    bar = Contour((arc, Line(half + 2.2j, -half + 2.2j)))
    assert edge_rows(bar) == [("0", "0", "Ø6, round"), ("0", "2.2", "flat, 0.8 deep, at 90°")]
    texts = texts_of(
        write_drawing(
            tmp_path, "d", Part("bar", "Bar", (Layer(Region(bar), 0, 40),)), TOLERANCE, META
        )[0]
    )
    assert {"%%c6", "5.2", "40"} <= set(texts) and "6" not in texts


def test_x_and_y_start_where_one_can_touch_and_holes_have_a_place(tmp_path):
    """A link far from its machine's origin: from its first hole, and where that is in the files; a position of ISO 1101."""
    link = Region(
        hull([(50 + 20j, 4.0), (80 + 20j, 4.0)]), (circle(50 + 20j, 2), circle(80 + 20j, 1.5))
    )
    part = Part("link", "Link", (Layer(link, 0, 3),), points=(("P", 50 + 20j), ("Q", 80 + 20j)))
    dxf, _ = write_drawing(tmp_path, "d", part, TOLERANCE, replace(META, position=0.1))
    texts = texts_of(dxf)
    assert texts[texts.index("Q") + 1 :][:3] != [] and ("30", "0", "%%c3") in list(
        zip(texts, texts[1:], texts[2:], strict=False)
    )
    assert " ".join(t for t in reversed(texts) if "X and Y from" in t or "files" in t) == (
        "X and Y from the centre of hole P, which in the part's files is at 50, 20"
    )
    assert {"%%c0.1", "round holes; X and Y are exact"} <= set(texts) and texts[
        texts.index("%%c0.1") + 1
    ] == "A"  # no name of a joint
    z = [e for e in ezdxf.readfile(dxf).modelspace().query("CIRCLE[layer=='CUT']")]
    assert sorted((e.dxf.center.x, e.dxf.center.y) for e in z) == [
        (50, 20),
        (80, 20),
    ]  # the sheet is where the part's files are
    plain = texts_of(write_drawing(tmp_path, "d", part, TOLERANCE, replace(META, position=0.0))[0])
    assert "round holes; X and Y are exact" not in plain


def test_what_is_measured_of_a_coupon_has_its_name_and_no_label_lies_on_an_edge(root, tmp_path):
    """Letters of a word stand clear of gaps that are narrower than it; pins that stand on the plate are told as holes are."""
    part = read_mechanism(root / "specs" / "coupon.toml").assembly.parts[0]
    space = ezdxf.readfile(write_drawing(tmp_path, "d", part, TOLERANCE, META)[0]).modelspace()
    texts = [e.dxf.text for e in space.query("TEXT")]
    assert (
        texts.count("pin 5") == 2
        and texts[texts.index("pin 5", texts.index("pin 5") + 1) + 3] == "%%c5, z 4 to 12"
    )
    words = " ".join(reversed(texts))
    assert "98 over the far walls of A and B" in words
    (gap,) = [e for e in space.query("TEXT[layer=='DIM']") if e.dxf.text == "gap 8"]
    assert gap.dxf.align_point.y > 6 + 0.5  # the gap is from -6 to 6


# ---- sections --------------------------------------------------------------------------------------------------------


def stepped(*layers: tuple[Contour, tuple[Contour, ...], float, float]) -> Part:
    return Part(
        "p", "P", tuple(Layer(Region(outer, holes), z0, z1) for outer, holes, z0, z1 in layers)
    )


def beyond(part: Part) -> set[tuple[float, float, float, float]]:
    """Edges that are seen behind the cut, as x0, z0, x1, z1 to a hundredth, from left to right or upwards."""
    found = views.section(part, 1e-4)
    assert found is not None
    ends = [sorted(((a.real, a.imag), (b.real, b.imag))) for a, b in found.beyond]
    return {tuple(round(float(value), 2) + 0.0 for value in (*a, *b)) for a, b in ends}


@pytest.mark.parametrize(
    "bore", [keyed_bore(8, 2, 1), d_bore(8, 0.5), circle(0, 4)], ids=["keyway", "flat", "plain"]
)
def test_a_section_goes_through_the_axis_of_the_bore(bore: Contour) -> None:
    """A keyway or a flat moves the middle of the bore's box: cut there a bore of 8 mm showed 7.94."""
    found = views.section(
        stepped((circle(0, 20), (bore,), 0, 6), (circle(0, 10), (bore,), 6, 12)), 1e-4
    )
    assert found is not None and found.y == 0
    faces = sorted(face.bounds[0::2] for face in shapely.get_parts(found.faces))
    assert faces[0][0] == pytest.approx(-20, abs=0.01) and faces[0][1] == pytest.approx(
        -4, abs=0.01
    )
    assert faces[-1][0] == pytest.approx(4, abs=0.01) and faces[-1][1] == pytest.approx(
        20, abs=0.01
    )


def test_behind_a_through_bore_only_its_ends_are_seen() -> None:
    """Of a hub on a disc: the bore's wall is one face from end to end, and hides the step outside; so does the hub's own side."""
    seen = beyond(
        stepped((circle(0, 20), (circle(0, 4),), 0, 6), (circle(0, 10), (circle(0, 4),), 6, 12))
    )
    assert seen == {(-4, 0, 4, 0), (-4, 12, 4, 12)}


def test_behind_a_bore_the_edges_of_its_keyway_are_seen() -> None:
    """A keyway 4 wide and 2 deep to the left of a bore of 8: its side meets the bore at (-sqrt(16 - 4), -2)."""
    turned = keyed_bore(8, 4, 2).moved(1j)
    part = stepped((circle(0, 20), (turned,), 0, 6), (circle(0, 10), (turned,), 6, 12))
    x = round(-math.sqrt(12), 2)
    upright = {line for line in beyond(part) if line[0] == line[2]}
    assert upright == {(x, 0, x, 6), (x, 6, x, 12)}


def test_behind_a_wider_bore_its_floor_is_seen() -> None:
    """A bore of 4 that opens to 8 halfway: its step is an edge over all 8; a narrower one in front hides nothing of it."""
    seen = beyond(
        stepped((circle(0, 20), (circle(0, 2),), 0, 6), (circle(0, 20), (circle(0, 4),), 6, 12))
    )
    assert seen == {
        (-2, 0, 2, 0),
        (-4, 12, 4, 12),
        (-2, 6, 2, 6),
    }  # beside the narrower one it is the cut's own edge


def test_behind_a_blind_pocket_its_wall_is_seen_and_what_stands_before_hides_what_is_behind() -> (
    None
):
    """A plate 40 x 40 with a pocket 10 x 10 whose middle is the axis; in it stands a post 4 wide, 3 high, behind the cut."""
    plate, pocket = (
        polygon([-20 - 20j, 20 - 20j, 20 + 20j, -20 + 20j]),
        polygon([-5 - 5j, 5 - 5j, 5 + 5j, -5 + 5j]),
    )
    post = polygon([-2 - 3j, 2 - 3j, 2 - 1j, -2 - 1j])
    part = stepped((plate, (), 0, 4), (plate, (pocket,), 4, 10), (post, (), 4, 7))
    assert beyond(part) == {(-5, 10, 5, 10), (-2, 4, -2, 7), (2, 4, 2, 7), (-2, 7, 2, 7)}


# ---- what a shop needs -----------------------------------------------------------------------------------------------


def keyed_cam():
    """The cam with a bore of 12 and its keyway of DIN 6885."""
    part = cam()
    layer = part.layers[0]
    region = Region(layer.region.outer, (keyed_bore(12, 4, 1.8),))
    return replace(part, layers=(replace(layer, region=region),), bore=12.0, engraved=())


def keyed_cam_with_hub():
    """The same, 5 mm thick, on a hub of Ø22, 9 mm high."""
    part = keyed_cam()
    (layer,) = part.layers
    layer = replace(layer, z0=0.0, z1=5.0)
    hub_of = Layer(Region(circle(0, 11), layer.region.holes), 5.0, 14.0)
    return replace(part, layers=(layer, hub_of))


def test_a_cam_with_a_hub_is_cut_through_its_keyway(tmp_path):
    """From the left at x = 0: below the axis the bore's wall is at -6, above it the keyway's floor at 6 + 1.8."""
    part = keyed_cam_with_hub()
    layout = _Layout(part, "d", TOLERANCE, SHOP)
    faces = sorted(face.bounds[0::2] for face in shapely.get_parts(layout.drawn.upright.faces))
    assert [faces[0][1], faces[-1][0]] == pytest.approx([-6, 7.8])
    low, high = extent([fit_arcs(part.region.outer, TOLERANCE)])
    assert faces[0][0] >= low.imag - 0.01 and faces[-1][1] <= high.imag + 0.01
    texts = texts_of(write_drawing(tmp_path, "d", part, TOLERANCE, SHOP)[0])
    assert texts.count("S-S") == 1 and texts.count("S") == 2
    assert texts.count("%%c22") == 1 and not [text for text in texts if "%%c22," in text]
    assert not [text for text in texts if "by DXF" in text]
    assert layout.notes[0].startswith("Profile, z 0 to 5: d.dxf")


def test_a_bore_s_chamfers_are_cut_off_in_its_section():
    """Of 0.5 at 45 deg at either end of a bore of 12, 14 high, on the side without the keyway; above it the floor is higher."""
    part = keyed_cam_with_hub()
    faces = _Layout(part, "d", TOLERANCE, SHOP).drawn.upright.faces
    plain = _Layout(part, "d", TOLERANCE, replace(SHOP, bore_chamfer=0.0)).drawn.upright.faces
    gone = shapely.get_parts(plain.difference(faces))
    assert [each.area for each in gone] == pytest.approx([0.125, 0.125])
    corners = {
        (round(x, 6), round(z, 6)) for each in gone for x, z in shapely.get_coordinates(each)
    }
    assert corners == {(-6, 0), (-6.5, 0), (-6, 0.5), (-6, 14), (-6.5, 14), (-6, 13.5)}


def test_a_bore_s_chamfers_are_dashed_in_the_view_from_the_left():
    """Of a cam with a hub and without a keyway, whose section is along x."""
    cam_with_hub = keyed_cam_with_hub()
    plain = [
        replace(layer, region=Region(layer.region.outer, (circle(0, 6),)))
        for layer in cam_with_hub.layers
    ]

    def dashed(facts):
        sheet = _Layout(replace(cam_with_hub, layers=tuple(plain)), "d", TOLERANCE, facts).sheet
        return [each for each in sheet.primitives if getattr(each, "layer", "") == "HIDDEN"]

    assert len(dashed(SHOP)) == len(dashed(replace(SHOP, bore_chamfer=0.0))) + 6


def test_a_cam_s_overall_sizes_are_references(tmp_path):
    """They follow from the profile: nothing to be held beside its tolerance. A plain disc keeps its diameter."""
    texts = texts_of(write_drawing(tmp_path, "d", keyed_cam_with_hub(), TOLERANCE, SHOP)[0])
    assert {"(62)", "(50)"} <= set(texts) and not {"62", "50"} & set(texts)
    assert "%%c18" in texts_of(write_drawing(tmp_path, "d", disc(9), TOLERANCE, META)[0])


@pytest.mark.parametrize("at", [90, 0, 270, 33, 200])
def test_the_flat_of_a_bore_is_dimensioned_over_its_far_side(at):
    """A bore of 8 whose flat is 0.5 deep: 7.5 over it, whichever way it lies. It is the datum of angles, and no rim is one."""
    turn = cmath.exp(1j * math.radians(at - 90))
    hole = d_bore(8.0, 0.5).moved(turn)
    (layer,) = keyed_cam().layers
    cut = Layer(Region(layer.region.outer, (hole,)), layer.z0, layer.z1)
    layout = _Layout(replace(keyed_cam(), layers=(cut,), bore=8.0), "d", TOLERANCE, SHOP)
    sizes = {
        (round(each.value, 6), each.fit) for each in layout.sheet.things if isinstance(each, Size)
    }
    assert (7.5, " +0.015/0") in sizes
    things = list(layout.sheet.primitives)
    axes = [
        shapely.LineString([(z.real, z.imag) for z in (each.pieces[0].a, each.pieces[-1].b)])
        for each in things
        if isinstance(each, Stroke) and each.layer == "CENTER"
    ]
    words = [each for each in things if isinstance(each, Text)]
    texts = [each.at for each in words if each.text.startswith("Ø8 H7 (")]
    boxes = [each.at for each in words if each.text == layout.drawn.angle_letter]
    right = [z for z in boxes if z.real > layout.table_x and z.imag < layout.free]
    assert right, "the letter's box in the detail"
    for z in right:
        near = shapely.box(z.real - 2, z.imag - 0.5, z.real + 2, z.imag + 3)
        assert not any(near.intersects(axis) for axis in axes)
        assert not [at for at in texts if abs(at.imag - z.imag) < 3 and abs(at.real - z.real) < 15]
    for (
        each
    ) in layout.sheet.things:  # square to its line: what a CAD program measures is what is said
        if isinstance(each, Size):
            away = each.line - each.b
            assert abs(((each.b - each.a) * away.conjugate()).real) < 1e-6 * abs(away)
    titles = [t.text for t in layout.sheet.primitives if isinstance(t, Text) and "Bore A" in t.text]
    assert [", turned" in title for title in titles] == [at % 90 != 0]
    assert layout.drawn.angle_letter == "B"
    said = [row[3] for row in layout.drawn.rows[:2]]
    assert said == ["Ø8 H7", "7.5 +0.015/0 over its flat"], "no smaller text"


def test_a_bore_s_detail_has_the_label_of_its_hole_where_its_datum_has_another():
    """O is no datum's letter [ISO 5459]: the datum is the next one that is free."""
    part = replace(keyed_cam_with_hub(), points=(("O", 0j),))
    layout = _Layout(part, "d", TOLERANCE, SHOP)
    texts = [t.text for t in layout.sheet.primitives if isinstance(t, Text)]
    assert len([text for text in texts if text.startswith("Bore O")]) == 1
    assert layout.drawn.rows[0][0] == "O" and layout.drawn.datum_letter == "A"


def test_a_keyway_s_detail_is_larger_than_the_view():
    layout = _Layout(keyed_cam_with_hub(), "d", TOLERANCE, SHOP)
    texts = [t.text for t in layout.sheet.primitives if isinstance(t, Text)]
    (title,) = [text for text in texts if text.startswith("Bore A")]
    detail = float(re.search(r"\((.*):1\)", title)[1])
    assert detail > layout.scale


SHOP = replace(
    META,
    bore_fit="H7",
    key_fit="P9",
    profile=0.02,
    roughness=0.4,
    bore_roughness=1.6,
    symmetry=0.03,
    run_out=0.05,
    bore_chamfer=0.5,
    roughness_elsewhere=3.2,
    edges="broken 0.2",
    heat_treatment="60 HRC",
    revision="B",
    drawn_by="J. Miller",
    profile_step_deg=10.0,
)


def test_a_keyway_is_enlarged_with_its_fits_and_datums(tmp_path):
    texts = texts_of(write_drawing(tmp_path, "d", keyed_cam(), TOLERANCE, SHOP)[0])
    assert {"%%c12 H7 (+0.018/0)", "4 P9 (-0.012/-0.042)", "13.8 +0.1/0"} <= set(texts)
    # hole in view and table, frames of profile, symmetry and run-out, datum; frame of the profile, datum, revision
    assert (texts.count("A"), texts.count("B")) == (6, 3)
    assert {
        "Ra 0.4",
        "Ra 1.6",
        "0.02",
        "Revision",
        "J. Miller",
        "Edges broken 0.2",
        "60 HRC",
        "0.03",
        "0.05",
        "Bore chamfered 0.5 x 45%%d at both ends",
    } <= set(texts)
    assert {"All faces but for the track and bore Ra 3.2", "corners as DIN 6885"} <= {*texts}
    plain = texts_of(write_drawing(tmp_path, "p", keyed_cam(), TOLERANCE, META)[0])
    assert {"%%c12", "4", "13.8"} <= set(plain)
    words = ("H7", "Ra ", "chamfer")
    assert not [text for text in plain if any(word in text for word in words)]
    assert not {"0.02", "0.03", "0.05"} & set(plain)


def test_the_smallest_hollow_radius_of_a_track_is_known():
    """r = 30 + 8 cos 2t: its curvature is (r - 32) / r^2 at r = 22, where it is hollow, and (r + 32) / r^2 at r = 38, the sharpest
    place of a hole of that shape [curvature in polar coordinates, r' = 0]."""

    def curve(t, order):
        r = 30 + 8 * np.cos(2 * t)
        first = -16 * np.sin(2 * t)
        second = -32 * np.cos(2 * t)
        parts = (r, first + 1j * r, second - r + 2j * first)
        return parts[order] * np.exp(1j * t)

    track = Contour((Smooth(curve, 0.0, 2 * math.pi),))
    for way in (track, track.reversed()):
        assert hollow_radius(way) == pytest.approx(22**2 / 10)
        assert hollow_radius(way, inside=True) == pytest.approx(38**2 / 70)
    assert hollow_radius(circle(0j, 5)) == math.inf
    notes = _Layout(keyed_cam(), "d", TOLERANCE, SHOP).notes
    assert "Track without a hollow" in " ".join(notes) and "none" not in " ".join(notes)


def test_people_date_and_revision_have_fields_to_fill_in_by_hand(tmp_path):
    """Nothing is known of them here; a workshop writes them in, and no date of today makes other bytes of one spec."""
    cells = ["Drawn by", "Checked by", "Date", "Revision"]
    texts = texts_of(write_drawing(tmp_path, "p", keyed_cam(), TOLERANCE, META)[0])
    at = texts.index("Drawn by")
    assert texts[at : at + 9 : 2] == [*cells, "Machine"] or texts[at : at + 4] == cells
    given = replace(META, drawn_by="J. Miller", date="2026-05-31", revision="B")
    texts = texts_of(write_drawing(tmp_path, "g", keyed_cam(), TOLERANCE, given)[0])
    for key, value in (("Drawn by", "J. Miller"), ("Date", "2026-05-31"), ("Revision", "B")):
        assert texts[texts.index(key) + 1] == value


def test_a_track_s_tolerance_stands_once_and_its_radii_are_exact(tmp_path):
    """A tolerance at the nominal radii would be a second one beside that of the profile [ISO 1101, theoretically exact]."""
    facts = replace(SHOP, tracks=[("", [(0.0, 25 + 0j), (10.0, 25j)])])
    texts = texts_of(write_drawing(tmp_path, "d", keyed_cam(), TOLERANCE, facts)[0])
    assert "Theoretically exact track: where the follower touches, from X, ccw" in texts
    assert not [text for text in texts if "%%p" in text and "JS9" not in text]
    assert texts.count("0.02") == 1 and "outer circle (R37)" in texts


def test_the_bore_of_a_metal_cam_is_its_datum_without_a_keyway_too(tmp_path):
    part = keyed_cam()
    (layer,) = part.layers
    plain_bore = Region(layer.region.outer, (circle(0, 4),))
    part = replace(part, layers=(replace(layer, region=plain_bore),), bore=8.0)
    texts = texts_of(write_drawing(tmp_path, "d", part, TOLERANCE, SHOP)[0])
    assert texts.count("%%c8 H7 (+0.015/0)") == 2  # in the table and in the view from the left
    assert (
        "Ra 1.6" in texts and texts.count("A") > 2
    )  # beside its label and the frames that refer to it
    assert "0.03" not in texts  # the symmetry of a keyway
    plain = texts_of(write_drawing(tmp_path, "p", part, TOLERANCE, META)[0])
    assert not [text for text in plain if text.startswith("Bore ")]


def test_the_hole_from_which_others_are_placed_is_marked_as_their_datum(tmp_path):
    """A groove's back plate: its bore A has no detail, and the frame of the dowels' positions refers to it, by a letter of no hole."""
    pins = tuple(circle(cmath.rect(50, math.radians(45 + 90 * k)), 1.5) for k in range(4))
    layer = Layer(Region(circle(0, 60), (circle(0, 5), *pins)), 0, 3)
    part = Part("back", "Back plate", (layer,), bore=10.0)
    layout = _Layout(part, "d", TOLERANCE, replace(SHOP, position=0.05, profile=0.0))
    words = [each for each in layout.sheet.primitives if isinstance(each, Text)]
    hole = [each for each in words if each.text == "A"]
    datum = [each for each in words if each.text == "C"]
    assert len(hole) == 2  # in the table, at the hole
    assert len(datum) == 2  # in the frame of the position, in the datum's box
    axis = layout.page.paper(0j)
    for letters in (hole, datum):
        assert sum(abs(each.at - axis) < layout.scale * 5 + 12 for each in letters) == 1
    free_of_it = _Layout(part, "d", TOLERANCE, replace(SHOP, position=0.0, profile=0.0))
    plain = [each for each in free_of_it.sheet.primitives if isinstance(each, Text)]
    assert [each.text for each in plain].count("A") == 2


def test_a_datum_whose_hole_has_a_word_for_a_name_has_a_letter():
    """A letter in its box [ISO 5459]; the table and the view call the hole by the name in the spec."""
    holes = (circle(0, 3), circle(40, 2))
    layer = Layer(Region(hull([(0j, 6.0), (40 + 0j, 5.0)]), holes), 0, 5)
    part = Part("arm", "Arm", (layer,), points=(("pivot", 0j), ("tip", 40 + 0j)))
    layout = _Layout(part, "d", TOLERANCE, replace(META, position=0.1))
    words = [each.text for each in layout.sheet.primitives if isinstance(each, Text)]
    assert (words.count("pivot"), words.count("A")) == (2, 2)  # table, view; frame, datum
    assert "X and Y from the centre of hole pivot" in words
    cells = [_corners(each) for each in layout.sheet.primitives if isinstance(each, Stroke)]
    rings = [shapely.Polygon(each) for each in cells if len(each) == 4]
    for text in layout.sheet.primitives:
        if isinstance(text, Text) and text.text == "A":
            assert any(ring.area < 70 and ring.contains(box(text)) for ring in rings)


def test_the_rim_of_a_plate_without_a_bore_is_its_datum(tmp_path):
    """A groove's outer wall: track and pins refer to the rim, whose letter is that of no hole and stands under its diameter."""
    track = keyed_cam().layers[0].region.outer
    pins = tuple(circle(cmath.rect(50, math.radians(45 + 90 * k)), 1.5) for k in range(4))
    layer = Layer(Region(circle(0, 60), (track, *pins)), 0, 6)
    part = Part("outer", "Groove cam, outer wall", (layer,))
    layout = _Layout(part, "d", TOLERANCE, replace(SHOP, position=0.1, revision=""))
    assert layout.drawn.rim_letter and layout.drawn.rim_letter == layout.drawn.datum_letter
    assert layout.drawn.rim_letter not in {label[:1] for label, _ in layout.drawn.named}
    words = [each for each in layout.sheet.primitives if isinstance(each, Text)]
    letters = [each.at for each in words if each.text == layout.drawn.rim_letter]
    (size,) = (each.at for each in words if each.text == "Ø120")
    letter = layout.drawn.rim_letter
    assert f"Rim {letter} round within 0.01, Ra 1.6" in {each.text for each in words}
    assert "All faces but for the track and rim Ra 3.2" in {each.text for each in words}
    assert min(abs(at.real - size.real) + max(at.imag - size.imag, 0) for at in letters) < 2
    assert len(letters) == 3  # datum, frame of the profile, frame of the position
    assert "X and Y from the centre of the rim" in {each.text for each in words}
    square = replace(
        layer, region=Region(polygon([-60 - 60j, 60 - 60j, 60 + 60j, -60 + 60j]), (track, *pins))
    )
    assert not _Layout(replace(part, layers=(square,)), "s", TOLERANCE, SHOP).drawn.rim_letter


def _frames(layout, first):
    """What stands to the right of a text, in one line with it and close by: the cells of its frame, from the left."""
    words = [each for each in layout.sheet.primitives if isinstance(each, Text)]
    (start,) = (each.at for each in words if each.text == first)
    line = [each for each in words if abs(each.at.imag - start.imag) < 1e-6]
    right = sorted((each.at.real, each.text) for each in line if each.at.real > start.real)
    return [text for x, text in right if x < start.real + 32 and len(text) == 1]


@pytest.mark.long
@pytest.mark.parametrize("bore", ["plain", "keyway"])
def test_a_dowel_or_a_keyway_holds_the_angle_of_a_groove_s_track(root, bore):
    """An axis alone leaves a track free to turn [ISO 5459]; its dowels refer to the same axis; a track is no hole."""
    settings = ("material.name=C45", "parts.hub_height=0", "geometry.closure=groove")
    machine = read_mechanism(
        root / "specs" / "disc-cam.toml", [*settings, f"parts.bore_shape={bore}"]
    ).resolved()
    for part in machine.assembly.parts:
        layout = _Layout(part, "d", TOLERANCE, facts_of(machine, part))
        names = dict(layout.drawn.named)
        assert all(hole.radius for hole in names.values())
        position = _frames(layout, "Ø0.05")
        if part.name == "back":
            assert position == (["D", "E"] if bore == "keyway" else ["D"])
            assert layout.drawn.angle_hole is None
            continue
        axis, angle = _frames(layout, "0.05")
        assert position[0] == axis != angle
        assert not {angle} & {name[:1] for name in names}
        words = [each for each in layout.sheet.primitives if isinstance(each, Text)]
        letters = [each.at for each in words if each.text == angle]
        if bore == "keyway" and part.name == "inner":
            assert layout.drawn.angle_hole is None and position == [axis, angle]
            continue
        first = next(hole for name, hole in layout.drawn.named if name.endswith("1"))
        edge = layout.scale * first.radius
        assert min(abs(at - layout.page.paper(first.place)) for at in letters) < edge + 10
        # dowels, then screws
        own = "A B1 B2 C1 C2" if part.name == "inner" else "A1 A2 B1 B2 B3 B4"
        assert " ".join(names) == own
        # notes say which file has the track; of one that is a hole the table of holes does too
        tracks = [row[:3] for row in layout.drawn.rows if "profile by DXF" in row[3]]
        noted = [each for each in words if each.text.startswith("Profile") and ".dxf" in each.text]
        assert tracks == ([] if part.name == "inner" else [("", "", "")])
        assert len(noted) == 1


@pytest.mark.long
@pytest.mark.parametrize("speed", [30, -30])
def test_a_metal_drum_s_drawing_has_its_track_and_the_datum_of_its_angle(root, tmp_path, speed):
    """A cycloidal rise of 15 over 120 deg is half done at 60 deg. The roller of 10 x 6 has 0.2 of play, and 0.5 at either end. The
    drum's point at the follower goes back as it turns. The upper wall lies in a zone of 0.04; the lower one follows by the width. The
    outside only gets smaller and the floor only deeper, by 0.2 of the 0.5, so that nothing comes nearer to the roller's ends."""
    settings = [
        "material.name=16MnCr5",
        "geometry.roller.length=6",
        "drawing.profile=0.04",
        "print.slide_clearance=0.2",
        "files.cutter_radius=4",
        f"motor.speed_rpm={speed}",
    ]
    machine = read_mechanism(root / "specs" / "cylinder-cam.toml", settings).resolved()
    (part,) = machine.assembly.parts
    facts = facts_of(machine, part)
    rows = {turned: (at, high) for turned, at, high in facts.heights}
    assert len(rows) == 180 and rows[0.0][0] == pytest.approx(0.0)
    assert rows[60.0][0] == pytest.approx(300.0 if speed > 0 else 60.0)
    assert rows[60.0][1] - rows[0.0][1] == pytest.approx(7.5)
    assert rows[150.0][1] - rows[0.0][1] == pytest.approx(15.0)
    layout = _Layout(part, "d", TOLERANCE, facts)
    assert _frames(layout, "0.04") == ["A", "B", "C"]
    texts = texts_of(write_drawing(tmp_path, "d", part, TOLERANCE, facts)[0])
    upper = "upper wall, from floor to outside; lower wall by the width of the track"
    assert {upper, "Ra 0.8", "B", "Ra 1.6", "its play 0.2 to 0.24"} <= set(texts)
    sizes = [each for each in layout.sheet.things if isinstance(each, Size)]
    (width,) = (each.value for each in sizes if each.fit == " +0.04/0")
    assert width == pytest.approx(10.2)
    (depth,) = (each.value for each in sizes if each.fit == " +0.2/0")
    assert depth == pytest.approx(6 + 2 * 0.5)
    (outside,) = (each.value for each in sizes if each.fit.startswith(" h9 (0/-0.0"))
    (floor,) = (each.value for each in sizes if each.sign == "(Ø")
    assert (outside, outside - floor) == pytest.approx((2 * part.drum.outside, 2 * depth))
    assert not [each for each in sizes if each.sign == "("]
    assert (
        texts.count("0.03") == 3
    )  # run-outs: their arrows are on both ends, and on the outside where the track is not
    tips = [each.corners[0] for each in layout.sheet.primitives if isinstance(each, Fill)]
    ends = (layout.page.side_x, layout.page.side_x + layout.scale * part.thickness)
    low, high = layout.page.paper(layout.drawn.low), layout.page.paper(layout.drawn.high)
    for end in ends:
        assert [z for z in tips if abs(z.real - end) < 1e-9 and low.imag < z.imag < high.imag]
    (top,) = (z for z in tips if abs(z.imag - high.imag) < 1e-9 and ends[0] < z.real < ends[1])
    cut = shapely.Point(part.drum.outside - 0.1, (top.real - ends[0]) / layout.scale)
    assert layout.drawn.upright.faces.contains(cut)
    assert "Track: d-developed.dxf, the cutter's path: d-path.csv" in " ".join(layout.notes)
    k = texts.index("60%%d")
    at, high = rows[60.0]
    assert texts[k + 1 : k + 3] == [f"{at:.2f}%%d", f"{high:.3f}"]


def test_a_printed_drum_has_no_tolerance_of_its_walls(root):
    machine = read_mechanism(root / "specs" / "cylinder-cam.toml", ["parts.pieces=1"]).resolved()
    (part,) = machine.assembly.parts
    layout = _Layout(part, "d", TOLERANCE, facts_of(machine, part))
    assert "path.csv" not in " ".join(layout.notes)
    words = [each.text for each in layout.sheet.primitives if isinstance(each, Text)]
    assert "10.2" in words
    assert not [text for text in words if text.startswith(("both walls", "Ra ", "±"))]


def test_a_thread_is_drawn_in_its_section_with_its_class_and_height():
    """Its core hole, 4.2 of M5, is cut out of the section, so that the hatching ends there; thin lines 5 apart are its diameter
    [ISO 6410-1: of a nut in section the crests are thick lines, to which the hatching goes, and the roots thin ones]."""
    part = replace(keyed_cam_with_hub(), tap=Tap("M5", 9.0, 8.0, 11.0))
    plain = _Layout(keyed_cam_with_hub(), "d", TOLERANCE, SHOP)
    layout = _Layout(part, "d", TOLERANCE, SHOP)
    gone = plain.drawn.upright.faces.difference(layout.drawn.upright.faces)
    assert gone.bounds[1::2] == pytest.approx((9.0 - 2.1, 9.0 + 2.1))
    scale = layout.scale
    x = [
        ends[0].real
        for each in layout.sheet.primitives
        if isinstance(each, Stroke) and each.layer == "DIM"
        for ends in [[start_point(each.pieces[0]), end_point(each.pieces[0])]]
        if abs(ends[1] - ends[0] - 3j * scale) < 1e-9
    ]
    assert sorted((each - layout.page.side_x) / scale for each in x) == pytest.approx([6.5, 11.5])
    words = {each.text for each in layout.sheet.primitives if isinstance(each, Text)}
    assert {"M5-6H", "through into the keyway", "9"} <= words
    assert "Thread M5: on this sheet alone, no file has it" in " ".join(layout.notes)


def test_what_is_case_hardened_has_a_thick_chain_line_beside_it(tmp_path, root):
    """2 mm of paper outside the material [blickinsbuch.westermann.de/978-3-7100-2824-3/160]; its dashes go on past corners (flag 128 of
    a polyline). A part without a case has none; of a groove both walls have one, which stands in the groove."""
    facts = replace(SHOP, case_only=True, heat_treatment="60+4 HRC, CHD 0.8+0.4")
    layout = _Layout(keyed_cam(), "d", TOLERANCE, facts)
    (line,) = (each for each in layout.sheet.things if getattr(each, "layer", "") == "CASE")
    chain = shapely.Polygon(_corners(line))
    paper = fit_arcs(layout.drawn.outer, 1e-3).moved(layout.scale, layout.datum)
    material = shapely.Polygon([(z.real, z.imag) for z in facet_contour(paper, 1e-3)])
    assert chain.contains(material)
    assert chain.exterior.hausdorff_distance(material.exterior) == pytest.approx(2.0, abs=0.1)
    assert "Case on the track only (thick chain line)" in " ".join(layout.notes)
    path = write_drawing(tmp_path, "d", keyed_cam(), TOLERANCE, facts)[0]
    (chain,) = ezdxf.readfile(path).modelspace().query("LWPOLYLINE[layer=='CASE']")
    assert chain.dxf.flags & 128 and chain.dxf.linetype == "CASE"
    plain = _Layout(keyed_cam(), "d", TOLERANCE, SHOP)
    assert "CASE" not in {getattr(each, "layer", "") for each in plain.sheet.things}
    settings = ["material.name=16MnCr5", "print.slide_clearance=0.2"]
    machine = read_mechanism(root / "specs" / "cylinder-cam.toml", settings).resolved()
    (part,) = machine.assembly.parts
    layout = _Layout(part, "d", TOLERANCE, facts_of(machine, part))
    cased = [each for each in layout.sheet.things if getattr(each, "layer", "") == "CASE"]
    low, high = sorted(start_point(each.pieces[0]).imag for each in cased)
    apart = layout.track_section.scale * 10.2 - 2 * 2.0
    assert high - low == pytest.approx(apart, abs=0.01)


def test_frames_and_the_circle_of_a_whole_outline_are_drawn():
    """The circle at the bend of the track's leader; the run-out's arrow on the face at z = 0, its frame on free paper."""
    layout = _Layout(keyed_cam_with_hub(), "d", TOLERANCE, SHOP)
    strokes = [each for each in layout.sheet.primitives if isinstance(each, Stroke)]
    bends = [
        each.pieces[0].centre
        for each in strokes
        if isinstance(each.pieces[0], Arc) and each.pieces[0].radius == 1.25
    ]
    (bend,) = bends
    starts = [start_point(each.pieces[0]) for each in strokes if each.layer == "DIM"]
    assert min(abs(bend - each) for each in starts) < 1e-9
    tips = [
        end_point(each.pieces[0])
        for each in strokes
        if each.layer == "DIM" and isinstance(each.pieces[0], Line) and len(each.pieces) == 1
    ]
    on_face = [z for z in tips if abs(z.real - layout.page.side_x) < 1e-9]
    low, high = layout.page.paper(layout.drawn.low), layout.page.paper(layout.drawn.high)
    assert [z for z in on_face if low.imag < z.imag < high.imag]


def test_a_keyway_that_is_not_of_the_standard_has_no_deeper_depth(tmp_path):
    part = keyed_cam()
    layer = part.layers[0]
    odd = Region(layer.region.outer, (keyed_bore(12, 4, 2.0),))
    part = replace(part, layers=(replace(layer, region=odd),))
    texts = texts_of(write_drawing(tmp_path, "d", part, TOLERANCE, SHOP)[0])
    assert "14" in texts and not [text for text in texts if text.endswith("+0.1/0")]


@pytest.mark.parametrize("part", [keyed_cam(), keyed_cam_with_hub()], ids=["plate", "hub"])
@pytest.mark.parametrize("facts", [META, SHOP], ids=["plain", "shop"])
def test_no_text_lies_on_another(part, facts):
    """By boxes of what each text takes at most, in the paper's own frame."""
    layout = _Layout(part, "d", TOLERANCE, facts)
    texts = [thing for thing in layout.sheet.primitives if isinstance(thing, Text)]
    boxes = [box(text) for text in texts]
    for k, one in enumerate(boxes):
        for text, other in zip(texts[:k], boxes[:k], strict=True):
            assert one.intersection(other).area < 0.05, (texts[k].text, text.text)


@pytest.mark.parametrize("bore", [12, 20])
@pytest.mark.parametrize("closure", ["force", "groove"])
def test_no_frame_lies_on_a_text_or_on_another_frame(root, closure, bore):
    """A long fit stands beside a narrow keyway, where the frame of its symmetry has no room."""
    settings = ("material.name=C45", "parts.bore_shape=keyway", "parts.hub_height=0")
    settings += (f"parts.bore={bore}", f"geometry.closure={closure}")
    machine = read_mechanism(root / "specs" / "disc-cam.toml", settings).resolved()
    part = machine.assembly.parts[0]
    facts = facts_of(machine, part)
    layout = _Layout(part, "d", TOLERANCE, facts)
    things = list(layout.sheet.primitives)
    texts = {each.text: box(each) for each in things if isinstance(each, Text)}
    frames = _frames_on(things)
    assert any(each.contains(texts[number(facts.symmetry)]) for each in frames)
    for cell in frames:
        for text, taken in texts.items():
            assert not cell.exterior.intersects(taken), text
        for other in frames:
            assert other is cell or cell.intersection(other).area < 0.01


@pytest.mark.parametrize(
    "name", [*METAL, "cycloidal-reducer", "drum-feeder", "ratchet", "stepping-gears"]
)
def test_no_text_and_no_frame_of_any_part_s_sheet_lies_on_another(
    root, name, tmp_path, monkeypatch
):
    """As a reader of PDFs sees them, with what hangs below the line of a text, and as wide as a CAD program may set them."""
    sheets = []
    for writer in (drawing, shaft_sheet):
        monkeypatch.setattr(writer, "write_pdf", lambda _, *pages: sheets.extend(pages))
        monkeypatch.setattr(writer, "write_dxf_sheet", lambda *_: None)
    spec = root / "specs" / "gallery" / f"{name}.toml"
    source = tomllib.loads(in_metal(name)) if name in METAL else spec
    machine = read_mechanism(source, ()).resolved()
    for part in machine.assembly.parts:
        write_drawing(tmp_path, "d", part, TOLERANCE, facts_of(machine, part))
    assert len(sheets) >= len(machine.assembly.parts)
    for sheet in sheets:
        assert _overprints(sheet) == _overprints(sheet, box) == [], sheet.title


def test_texts_and_frames_that_do_lie_on_each_other_are_found():
    sheet = Sheet(100.0, 100.0, "x")
    sheet.text(10 + 10j, "Ø13 JS7", 3.5)
    sheet.text(10 + 14j, "z upwards", 2.5)  # whose p hangs down to 13.3, on a text up to 13.5
    assert _overprints(sheet) == [("Ø13 JS7", "z upwards")]
    sheet.things.pop()
    sheet.text(10 + 14.4j, "z upwards", 2.5)
    assert _overprints(sheet) == []
    symbols.symmetry(sheet, 50 + 10j, 0.04, "A")
    assert _overprints(sheet) == []
    sheet.text(51 + 8j, "3 P9", 3.5)
    assert ("3 P9", "frame") in _overprints(sheet)


def _overprints(sheet, taken=None):
    """Pairs of texts, and of frames' edges and texts, and of frames, that meet on a sheet; taken: by a text, as a PDF has it by default."""
    things = list(sheet.primitives)
    texts = [(each.text, (taken or _printed)(each)) for each in things if isinstance(each, Text)]
    frames = [("frame", each) for each in _frames_on(things)]
    pairs = [(one, two) for k, two in enumerate(texts) for one in texts[:k]]
    pairs += [(one, two) for k, two in enumerate(frames) for one in frames[:k]]
    found = [(a, b) for (a, one), (b, two) in pairs if one.intersection(two).area > 0.01]
    return found + [
        (a, b) for a, text in texts for b, cell in frames if cell.exterior.intersects(text)
    ]


def _printed(text):
    """What a text takes in Helvetica, to the foot of a letter that hangs below its line: 0.21 of the type's size, whose capitals are
    0.72 high [Adobe Core14 AFM]."""
    way = text.direction
    left = text.at - {"left": 0.0, "centre": 0.5, "right": 1.0}[text.align] * text.width * way
    hangs = 0.21 / 0.72 * text.height if set("gjpqy,;()/") & set(text.text) else 0.0
    low = left - 1j * hangs * way
    high = left + 1j * text.height * way
    corners = (low, low + text.width * way, high + text.width * way, high)
    return shapely.Polygon([(z.real, z.imag) for z in corners])


def _frames_on(things):
    """Cells of frames of tolerances and of datums, shapely's polygons."""
    strokes = [each for each in things if isinstance(each, Stroke) and each.layer == "TEXT"]
    cells = [shapely.Polygon(c) for each in strokes if len(c := _corners(each)) == 4]
    return [each for each in cells if each.bounds[3] - each.bounds[1] <= symbols.FRAME + 1e-9]


def _corners(stroke):
    """Corners of a closed stroke of lines on paper; none of another."""
    lines = stroke.closed and all(isinstance(piece, Line) for piece in stroke.pieces)
    points = [start_point(piece) for piece in stroke.pieces] if lines else []
    return [(z.real, z.imag) for z in points]


def test_sizes_are_rounded_to_what_the_general_tolerance_means(tmp_path):
    """62.033 is 62 where it may differ by 0.3; a finer class, or none, keeps more digits."""
    off = replace(cam(), layers=tuple(_larger(layer, 1.00054) for layer in cam().layers))
    sizes = {}
    for tolerance in ("ISO 2768-m", "ISO 2768-f", ""):
        facts = replace(META, tolerance=tolerance)
        texts = texts_of(write_drawing(tmp_path, "d", off, TOLERANCE, facts)[0])
        sizes[tolerance] = [text for text in texts if text.startswith("(62")]
    assert sizes["ISO 2768-m"] == ["(62)"]
    assert sizes["ISO 2768-f"] == ["(62.03)"] and sizes[""] == ["(62.033)"]


def _larger(layer, share):
    region = Region(layer.region.outer.moved(share, 0j), layer.region.holes)
    return replace(layer, region=region)


def test_a_drawing_names_its_machine(root):
    machine = read_mechanism(root / "specs" / "disc-cam.toml", ["name=press"]).resolved()
    assert facts_of(machine, machine.assembly.parts[0]).machine == "press (disc-cam)"


def test_radii_by_cam_angle_are_where_the_follower_touches(root, tmp_path):
    """By the profile that the cam itself gives; the same points lie on the outline that is drawn."""
    machine = read_mechanism(root / "specs" / "disc-cam.toml").resolved()
    (part,) = machine.assembly.parts
    facts = facts_of(machine, part)
    ((name, track),) = facts.tracks
    assert name == "" and [angle for angle, _ in track] == [10.0 * k for k in range(36)]
    rim = shapely.LinearRing([(z.real, z.imag) for z in facet_contour(part.region.outer, 1e-4)])
    assert max(rim.distance(shapely.Point(z.real, z.imag)) for _, z in track) < 1e-3
    assert abs(track[0][1]) == pytest.approx(25.0)  # the base radius, in the dwell
    texts = texts_of(write_drawing(tmp_path, "d", part, TOLERANCE, facts)[0])
    assert "Track by cam angle: where the follower touches, from X, ccw" in texts
    angle, place = track[4]
    at = math.degrees(cmath.phase(place)) % 360
    k = texts.index("40%%d")
    assert texts[k : k + 3] == ["40%%d", f"{at:.2f}%%d", f"{abs(place):.3f}"]


def test_a_cam_s_sheet_shows_its_follower_at_cam_angle_0(root, tmp_path):
    """On its base circle: a roller of 5 on a cam of 25, which slides along y; one on an arm of 50, square to it, about a pivot 60 off;
    of a pair the far one is pushed on to its own cam as the near one rises."""
    spec = root / "specs" / "disc-cam.toml"
    arm = [
        f"geometry.follower.{key}" for key in ("motion=oscillating", "arm=50", "pivot_distance=60")
    ]
    machines = [
        read_mechanism(spec, settings).resolved()
        for settings in ([], arm, ["geometry.closure=conjugate", "geometry.base_radius=30"])
    ]
    slides, swings, pair = ([facts_of(m, part) for part in m.assembly.parts] for m in machines)
    ((rider,),) = (each.riders for each in slides)
    assert (rider.centre, rider.way) == (pytest.approx(30j), pytest.approx(1j))
    ((other,),) = (each.riders for each in swings)
    assert abs(other.centre) == pytest.approx(30)
    spoke = next(other.centre - x for x in (60, -60) if abs(abs(other.centre - x) - 50) < 1e-6)
    assert (spoke * other.way.conjugate()).real == pytest.approx(0, abs=1e-9)
    near, far = (each.riders[0] for each in pair)
    assert near.centre == pytest.approx(35j) and near.way == pytest.approx(far.way)
    assert far.centre.imag < -30 and far.centre.real == pytest.approx(0, abs=1e-9)
    (part,) = machines[0].assembly.parts
    path, _ = write_drawing(tmp_path, "d", part, TOLERANCE, slides[0])
    space = ezdxf.readfile(path).modelspace()
    circles = [e for e in space.query("ARC[layer=='HIDDEN']") if abs(e.dxf.radius - 5) < 1e-9]
    assert [complex(*e.dxf.center.vec2) for e in circles] == [pytest.approx(30j)]
    assert {"X", "Y", "s"} <= set(texts_of(path))


def test_tables_of_a_metal_cam_have_the_axis_of_its_roller(root, tmp_path):
    """A roller of 5 lies 5 behind each point that it touches; after the rise of 12 its axis is 25 + 5 + 12 from the cam's. Rows for which
    the cam's sheet has no room go on to others, in a fifth of the step: 8 columns of 45 rows."""
    settings = ["material.name=C45", "drawing.profile_step_deg=5", "parts.bore_shape=keyway"]
    machine = read_mechanism(root / "specs" / "disc-cam.toml", settings).resolved()
    (part,) = machine.assembly.parts
    facts = facts_of(machine, part)
    paths = write_drawing(tmp_path, "d", part, TOLERANCE, facts)
    sheet, *tables = (texts_of(path) for path in paths if path.suffix == ".dxf")
    names = ["d-cam-tracks-drawing", "d-cam-tracks-2-drawing"]
    assert [path.stem for path in paths[2::2]] == names
    assert "Cam" not in sheet and "Full table of the track: sheets 2 to 3" in " ".join(sheet)
    own, last = tables
    assert ["A3, 1 of 3" in sheet, "A3, 2 of 3" in own, "A3, 3 of 3" in last] == [True] * 3
    assert "d-cam-tracks-drawing" in own, "its number is the name of its file"
    numbered = write_drawing(tmp_path, "n", part, TOLERANCE, replace(facts, number="K-1"))
    assert "K-1" in texts_of(numbered[2]), "sheets of one drawing have one number"
    k = own.index("130%%d")  # the dwell after the rise is from 100 to 160
    assert own[k + 3 : k + 5] == ["320.00%%d", "42.000"]
    assert own.count("Axis at") == 4 and "359%%d" in last
    (points,) = (each for _, each in facts.tracks)
    assert all(abs(abs(a - b) - 5) < 1e-9 for (_, a), b in zip(points, *facts.centres, strict=True))
    plain = read_mechanism(root / "specs" / "disc-cam.toml").resolved()
    (other,) = plain.assembly.parts
    assert len(write_drawing(tmp_path, "p", other, TOLERANCE, facts_of(plain, other))) == 2


@pytest.mark.parametrize("inner", [False, True])
def test_the_arrow_of_a_geneva_wheel_s_hollows_ends_on_one(inner):
    edge = (InnerGeneva if inner else Geneva)(4, 70.0, 5.0, 3.0).wheel()
    ring = Region(circle(0, 140), (edge,)) if inner else Region(edge, (circle(0, 4),))
    layout = _Layout(Part("w", "W", (Layer(ring, 0.0, 5.0),)), "d", TOLERANCE, META)
    rim = shapely.LinearRing([(z.real, z.imag) for z in facet_contour(edge, 1e-3)])
    tips = [each.corners[0] for each in layout.sheet.things if isinstance(each, Fill)]
    places = [(z - layout.datum) / layout.scale for z in tips]
    hollows = [z for z in places if rim.distance(shapely.Point(z.real, z.imag)) < 0.01]
    assert len(hollows) >= 2  # one on a hollow, one on the rim


@pytest.mark.parametrize(("material", "off"), [("C45", " +0.05/0"), ("PLA", "")])
def test_a_geneva_wheel_and_its_lock_are_dimensioned(root, tmp_path, material, off):
    """Six slots for a roller of 11, axes 70 apart: the pin is on 70 sin 30 deg = 35, slots 0.1 wider than the roller end 0.05 past it, the
    rim is where the roller's side enters, and hollows are about the crank's axis. In metal they open and the lock shrinks by the
    track's tolerance."""
    spec = root / "specs" / "gallery" / "geneva-table.toml"
    machine = read_mechanism(spec, [f"material.name={material}"]).resolved()
    parts = {part.name.partition("-")[0]: part for part in machine.assembly.parts}
    texts = {}
    for name in ("geneva", "lock"):
        facts = facts_of(machine, parts[name])
        texts[name] = texts_of(write_drawing(tmp_path, "d", parts[name], TOLERANCE, facts)[0])
    rim = 2 * math.hypot(70 * math.cos(math.pi / 6), 5.5)
    wheel = texts["geneva"]
    depth = "R34.9 0/-0.3" if off else "R34.9"  # +-0.5 there [ISO 2768-m]; no roller meets the end
    assert {f"%%c{rim:.1f}", depth} <= set(wheel)
    (hollow,) = (t.split()[-1] for t in texts["lock"] if t.startswith("Locks on"))
    about = [f"6 x R{float(hollow):g}{off} about", "R70"]
    pitch = ["6 x", "60%%d"]
    if off:  # exact sizes in boxes of their own
        assert all(wheel[wheel.index(pair[0]) + 1] == pair[1] for pair in (about, pitch))
    else:
        assert {" ".join(about), " ".join(pitch)} <= set(wheel)
    assert any(t.startswith("6 x 11.") and t.endswith(off) for t in wheel)
    lock = float(hollow) - 0.1
    assert f"R{lock:g}{' 0/-0.05' if off else ''}" in texts["lock"]
    assert "The pin is on R 35, its roller 11, axes" in " ".join(texts["lock"])
    assert not [t for t in wheel if ".200" in t or ".000" in t]


def test_a_geneva_drive_of_metal_is_made_from_its_sheets_alone(root, tmp_path):
    """Slots and hollows lie about the bore and its flat, the lock's arc about the bore, its relief about both; points of that lie on the
    outline, and the first and the last of them are the ends of the arc. The crank's pin lies so too."""
    spec = root / "specs" / "gallery" / "geneva-table.toml"
    machine = read_mechanism(spec, ["material.name=16MnCr5", "limits.min_wall=1"]).resolved()
    parts = {part.name.partition("-")[0]: part for part in machine.assembly.parts}
    facts = {name: facts_of(machine, parts[name]) for name in ("geneva", "lock", "crank", "roller")}
    assert facts["geneva"].ground and facts["lock"].heat_treatment and not facts["crank"].ground
    texts = {
        name: texts_of(write_drawing(tmp_path, "d", parts[name], TOLERANCE, each)[0])
        for name, each in facts.items()
    }

    def frames(name, zone):
        said = texts[name]
        return [said[k + 1 : k + 3] for k, each in enumerate(said) if each == zone]

    assert frames("geneva", "0.05") == [["D", "E"]]  # of middle planes
    assert frames("geneva", "%%c0.05") == [["D", "E"]]  # of hollows' axes
    assert frames("lock", "%%c0.05")[0][0] == "D" and frames("lock", "0.05") == [["D", "E"]]
    assert frames("crank", "%%c0.05") == [["D", "E"]]
    bored = 1  # signs at the bore, which is reamed
    assert {name: each.count("Ra 1.6") for name, each in texts.items()} == {
        "geneva": 2 + bored,
        "lock": 1 + bored,
        "crank": bored,
        "roller": 0,
    }
    assert not any("Ra 0.8" in each for each in texts.values())
    assert "Slots at 30, 90, ... deg from X," in texts["geneva"]
    arc, points = lock_of(parts["lock"].region.outer)
    rim = facet_contour(parts["lock"].region.outer, 1e-3)
    edge = shapely.LinearRing([(z.real, z.imag) for z in rim])
    assert max(edge.distance(shapely.Point(z.real, z.imag)) for z in points) < 2e-3
    assert [abs(z) for z in (points[0], points[-1])] == pytest.approx([arc.radius] * 2)
    first = texts["lock"].index(number(points[0].real))
    assert texts["lock"][first + 1] == number(points[0].imag)


def test_a_metal_cam_has_fits_unless_others_are_asked_for(root):
    def bore(*settings):
        machine = read_mechanism(root / "specs" / "disc-cam.toml", settings).resolved()
        facts = facts_of(machine, machine.assembly.parts[0])
        return facts.bore_fit, facts.key_fit

    assert bore() == ("", "")
    assert bore("material.name=C45") == ("H7", "JS9")
    assert bore("material.name=C45", "drawing.bore_fit=G6", "drawing.key_fit=P9") == ("G6", "P9")
    assert bore("drawing.bore_fit=H8") == ("H8", "")


def test_a_mass_is_told_to_three_digits_in_g_or_kg():
    told = {12.34: "12.3 g", 999.4: "999 g", 999.6: "1 kg", 61812.0: "61.8 kg"}
    assert {mass: weighed(mass) for mass in told} == told


def test_the_shank_of_a_pin_that_is_made_has_its_roughness(root):
    """m6 on Ø5 is 8 thousandths: Ra 3.2 all over would take most of it. A bought dowel says nothing of that."""
    machine = read_mechanism(tomllib.loads(in_metal("geneva-table"))).resolved()
    parts = {part.name: part for part in machine.assembly.parts}
    notes = {
        name: _Layout(parts[name], "d", TOLERANCE, facts_of(machine, parts[name])).notes
        for name in ("knob-pin", "pin-1")
    }
    assert {"Shank Ra 0.8", "All faces but for the shank Ra 3.2"} <= set(notes["knob-pin"])
    assert not [each for each in notes["pin-1"] if "Ra" in each]
