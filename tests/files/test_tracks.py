"""A drum's sheet: its track unrolled, its edges from the left, a section of its track; held to the spec's numbers and to its mesh."""

from __future__ import annotations

from dataclasses import replace
from functools import cache, reduce
from pathlib import Path

import numpy as np
import pytest
import shapely

from camgen.files.drawing import _Layout
from camgen.files.labels import box
from camgen.files.page import SCALES
from camgen.files.sheet import Sheet, Size, Stroke, Text
from camgen.files.title_block import Facts
from camgen.files.tracks import Development, development, drum_section
from camgen.geometry.drums import Drum
from camgen.geometry.mesh import Mesh, slice_mesh
from camgen.machines.sources import read_mechanism
from camgen.numerics import coordinates
from camgen.parts.solids import solid
from camgen.pipeline.drawings import facts_of

SPECS = Path(__file__).resolve().parents[2] / "specs"
RIB = ("geometry.track=rib", "geometry.distance=16")
SWING = (
    "geometry.follower.motion=oscillating",
    "geometry.follower.arm=40",
    "segment.0.lift=20",
)
KINDS = [(), RIB, ("geometry.track=end",), SWING, ("geometry.follower.offset=8",)]


@cache
def sheet_of(*settings: str, metal: bool = True) -> tuple[_Layout, Drum, Facts]:
    """The sheet of the starter's drum: a rise of 15 over 120 deg, dwell 60, return 120, dwell 60; the roller 10 x 6 with 0.2 of play."""
    usual = ["print.slide_clearance=0.2", "parts.pieces=1", "geometry.roller.length=6"]
    material = ["material.name=42CrMo4"] if metal else []
    machine = read_mechanism(SPECS / "cylinder-cam.toml", [*usual, *material, *settings]).resolved()
    (part,) = machine.assembly.parts
    assert part.drum is not None
    facts = facts_of(machine, part)
    return _Layout(part, "d", 1e-3, facts), part.drum, facts


def unrolled(drum: Drum, facts: Facts) -> tuple[Development, Sheet]:
    """The development alone."""
    made = development(drum, facts, ["A", "B"], 288.0, SCALES)
    sheet = Sheet(420.0, 297.0, "")
    made.draw(sheet, 0j)
    return made, sheet


def lines(sheet: Sheet, layer: str) -> list[np.ndarray]:
    """Points of strokes of a layer."""
    return [
        np.array([piece.at(piece.t0) for piece in each.pieces])
        for each in sheet.things
        if isinstance(each, Stroke) and each.layer == layer
    ]


def at_angle(sheet: Sheet, drum_angle: str) -> float:
    """Where on paper an angle by which the drum has turned is written: the upper of both rows."""
    places = [t.at for t in sheet.things if isinstance(t, Text) and t.text == drum_angle]
    return max(places, key=lambda z: z.imag).real


@pytest.mark.parametrize("speed", [30, -30])
def test_the_walls_unrolled_stand_at_the_heights_of_the_program(speed: int) -> None:
    """In the dwells both walls are 5.1 off the roller's axis, which lies 4 + 5.1 high, rounded up to fifths, and 15 higher after the
    rise: an end of metal is half as thick as the track, 7, is deep, rounded up. The outside is seen: a drum that turns counter-clockwise brings its points from the left, so its angles grow to the left."""
    _, drum, facts = sheet_of(f"motor.speed_rpm={speed}")
    made, sheet = unrolled(drum, facts)
    assert (at_angle(sheet, "90°") > at_angle(sheet, "180°")) == (speed > 0)
    foot = min(z.imag for z in np.concatenate(lines(sheet, "VIEW")))
    walls = lines(sheet, "WALL")
    for turned, axis in (("150°", 24.2), ("330°", 9.2)):
        x = at_angle(sheet, turned)
        heights = [(np.interp(x, z.real, z.imag) - foot) / made.scale for z in walls]
        assert heights == pytest.approx([axis - 5.1, axis + 5.1], abs=1e-6)
    middle = [(np.interp(at_angle(sheet, "60°"), z.real, z.imag) - foot) for z in walls]
    assert sum(middle) / 2 / made.scale == pytest.approx(9.2 + 7.5, abs=1e-3)


@pytest.mark.parametrize("settings", [(), ("motor.speed_rpm=-30",)])
def test_each_segment_is_named_over_its_own_angles(settings: tuple[str, ...]) -> None:
    """A rise of 120 deg from 0 has its name over 60 deg, and so on."""
    _, drum, facts = sheet_of(*settings)
    _, sheet = unrolled(drum, facts)
    names = [(t.text, t.at.real) for t in sheet.things if isinstance(t, Text) and " " in t.text]
    named = [each for each in names if each[0].split()[0] in ("rise", "dwell", "return")]
    wanted = [("rise 120°", "60°"), ("dwell 60°", "150°"), ("return 120°", "240°")]
    for text, over in wanted:
        assert min(abs(x - at_angle(sheet, over)) for name, x in named if name == text) < 1e-6
    assert len(named) == 4


def test_a_section_has_the_track_s_width_and_depth() -> None:
    """Groove: 10 + 0.2 wide, 6 + 2 x 0.5 deep. Rib: 16 between the axes of both rollers less 10.2. An end cam has no width."""
    wanted = {(): (10.2, 7.0), RIB: (5.8, 7.0), ("geometry.track=end",): (7.0,)}
    for settings, sizes in wanted.items():
        _, drum, facts = sheet_of(*settings)
        section = drum_section(drum, facts, SCALES)
        assert [each.value for *_, each in section.sizes] == pytest.approx(sizes)
        for a, b, away, measure in section.sizes:
            assert abs(((b - a) * (1j * away / abs(away)).conjugate()).real) == pytest.approx(
                measure.value
            )
        (face,) = section.faces
        rollers = [shapely.Polygon([(z.real, z.imag) for z in each]) for each in section.beside]
        own = shapely.Polygon([(z.real, z.imag) for z in face])
        assert len(rollers) == (2 if settings == RIB else 1) and own.is_valid
        play = 0.0 if "end" in str(settings) else 0.1
        assert [own.distance(each) for each in rollers] == pytest.approx([play] * len(rollers))


@pytest.mark.long
@pytest.mark.parametrize("settings", [*KINDS, ("parts.pieces=2",)])
def test_a_drum_is_cut_along_its_axis(settings: tuple[str, ...]) -> None:
    """Faces are those of its mesh cut at x = 0, but for chamfers, which no file has. Rims behind them lie on the mesh at +x."""
    machine = read_mechanism(SPECS / "cylinder-cam.toml", [*settings, "parts.bore=9"]).resolved()
    for part in machine.assembly.parts:
        layout = _Layout(part, "d", 1e-3, facts_of(machine, part))
        mesh = solid(part, 0.002)
        turned = Mesh(mesh.vertices[:, [1, 2, 0]], mesh.faces)
        rings = [shapely.Polygon(coordinates(each.points)) for each in slice_mesh(turned, 0.0)]
        cut = reduce(shapely.symmetric_difference, rings)
        assert layout.drawn.upright is not None
        assert layout.drawn.upright.faces.symmetric_difference(cut).buffer(-0.005).is_empty
        assert part.drum is not None
        place = mesh.vertices[mesh.vertices[:, 0] >= 0]
        outside = np.abs(np.hypot(place[:, 0], place[:, 1]) - part.drum.outside) < 0.02
        rim = place[outside, 1] + 1j * place[outside, 2]
        ends = [
            z for pair in layout.drawn.upright.beyond if pair[0].imag != pair[1].imag for z in pair
        ]
        if part.drum.pocket is None:  # else there is a rim within it, too
            assert all(np.min(np.abs(rim - z)) < 0.6 for z in ends)
            assert bool(ends) == (part.drum.track != "end")  # there both lie behind the cut


@pytest.mark.parametrize("settings", [(), RIB, ("geometry.track=end",)])
def test_a_drum_s_section_is_dimensioned(settings: tuple[str, ...]) -> None:
    """Diameter of the floor, 7 below the outside, by reference: outside and depth have their limits. Nothing else is."""
    layout, drum, _ = sheet_of(*settings)
    sizes = [each for each in layout.sheet.things if isinstance(each, Size)]
    (floor,) = (each for each in sizes if each.sign.startswith("("))
    assert floor.sign == "(Ø" and floor.a.real == floor.b.real
    assert floor.value == pytest.approx(2 * drum.outside - 14)
    (depth,) = (each for each in sizes if each.fit == " +0.2/0")
    assert depth.value == pytest.approx(7.0)


@pytest.mark.long
@pytest.mark.parametrize("metal", [True, False])
@pytest.mark.parametrize("settings", [*KINDS, ("geometry.length=80",), ("geometry.radius=120",)])
def test_no_text_of_a_drum_s_sheet_lies_on_another_or_off_the_paper(
    settings: tuple[str, ...], metal: bool
) -> None:
    layout, _, _ = sheet_of(*settings, metal=metal)
    texts = [each for each in layout.sheet.primitives if isinstance(each, Text)]
    paper = shapely.box(20, 10, 410, 287)
    boxes = np.array([box(each) for each in texts])
    for one, other in shapely.STRtree(boxes).query(boxes, "intersects").T:
        shared = boxes[one].intersection(boxes[other]).area
        alike = one == other or shared < 0.02 * boxes[one].area
        assert alike, (texts[one].text, texts[other].text)
    assert [t.text for t, each in zip(texts, boxes, strict=True) if not paper.contains(each)] == []


def test_lines_of_a_drum_s_sheet_stay_in_the_frame_and_off_the_title_block() -> None:
    for settings in KINDS:
        layout, _, _ = sheet_of(*settings)
        strokes = [each for each in layout.sheet.primitives if isinstance(each, Stroke)]
        block = shapely.box(240, 10, 410, 46).buffer(-0.1)
        for each in strokes:
            if each.layer in ("TEXT", "CENTER"):  # cells of the title block, and its symbol's axes
                continue
            z = [piece.at(piece.t1) for piece in each.pieces]
            assert all(20 <= p.real <= 410 and 10 <= p.imag <= 287 for p in z)
            assert not any(block.contains(shapely.Point(p.real, p.imag)) for p in z)


def test_a_drum_in_two_pieces_names_files_that_are_written() -> None:
    machine = read_mechanism(SPECS / "cylinder-cam.toml", ["parts.pieces=2"]).resolved()
    for part in machine.assembly.parts:
        told = " ".join(_Layout(part, f"x-{part.name}", 1e-3, facts_of(machine, part)).notes)
        assert f"x-{part.name}.stl" in told and "developed" not in told


def test_the_tolerance_of_the_walls_points_at_the_upper_one() -> None:
    layout, drum, facts = sheet_of()
    _, sheet = unrolled(drum, replace(facts, profile=0.04))
    tips = [each.corners[0] for each in sheet.things if hasattr(each, "corners")]
    upper = max(lines(sheet, "WALL"), key=lambda z: float(np.mean(z.imag)))
    (tip,) = tips
    assert abs(np.interp(tip.real, upper.real, upper.imag) - tip.imag) < 0.1
    words = {each.text for each in sheet.things if isinstance(each, Text)}
    assert {"0.04", "A", "B", "Ra 0.8"} <= words
    sizes = [each for each in layout.sheet.things if isinstance(each, Size)]
    assert " +0.05/0" in {each.fit for each in sizes}


@pytest.mark.parametrize(
    ("material", "play", "off", "keyway"), [("C45", 0.05, " +0.05/0", 1.4), ("PLA", 0.2, "", 0.0)]
)
def test_walls_of_a_plate_groove_are_cut_and_show_its_width(
    material: str, play: float, off: str, keyway: float
) -> None:
    """A roller of 10 with its play; the cut runs along y through the dwells: the inner wall is 30 and 45 from the axis, the outer one
    a groove's width farther; both are 6 thick, on the back plate. No edge is dashed. In metal the bore of 10 has a keyway 1.4 deep
    [DIN 6885]."""
    settings = [f"material.name={material}", "parts.bore=10", "parts.bore_shape="]
    machine = read_mechanism(SPECS / "gallery" / "groove.toml", settings).resolved()
    parts = {part.name: part for part in machine.assembly.parts}
    assert facts_of(machine, parts["back"]).groove is None
    width = 10 + play
    layouts = {
        name: _Layout(part, "d", 1e-3, facts_of(machine, part)) for name, part in parts.items()
    }
    inner, outer = (facts_of(machine, parts[name]) for name in ("inner", "outer"))
    ((_, near),) = inner.tracks
    ((_, far),) = outer.tracks
    assert [turned for turned, _ in near] == [turned for turned, _ in far]
    apart = [abs(b - a) for (_, a), (_, b) in zip(near, far, strict=True)]
    assert apart == pytest.approx([width] * len(apart), abs=1e-6)
    radii = [abs(z) for _, z in far]
    assert (min(radii), max(radii)) == pytest.approx((30 + width, 45 + width), abs=1e-6)
    axes = [abs(z - axis) for (_, z), axis in zip(far, *outer.centres, strict=True)]
    assert axes == pytest.approx([5.0] * len(axes))
    rim = layouts["outer"].drawn.disc
    assert rim is not None
    cuts = {
        "inner": [(-45, -5), (5 + keyway, 30)],
        "outer": [(-rim, -45 - width), (30 + width, rim)],
    }
    for name, spans in cuts.items():
        layout = layouts[name]
        assert layout.drawn.upright is not None
        boxes = [each.bounds for each in shapely.get_parts(layout.drawn.upright.faces)]
        found = sorted((x0, x1) for x0, _, x1, _ in boxes)
        chamfer = layout.drawn.chamfer
        for (a, b), (low, high) in zip(found, spans, strict=True):
            assert (a, b) == pytest.approx((low, high), abs=max(0.01, chamfer))
        sizes = [each for each in layout.sheet.things if isinstance(each, Size)]
        fits = {round(each.value, 3): each.fit for each in sizes}
        assert fits[round(width, 3)] == off
        words = [each.text for each in layout.sheet.primitives if isinstance(each, Text)]
        assert {"S-S", "(6)", "roller Ø10", "Cam", "+", "s"} <= set(words)
        frame = shapely.box(*layout_box(layout))
        dashed = [z for z in lines(layout.sheet, "HIDDEN") if layout.page.side_x <= z.real.min()]
        assert not [z for z in dashed if frame.contains(shapely.Point(z[0].real, z[0].imag))]


def layout_box(layout: _Layout) -> tuple[float, float, float, float]:
    """Of the view from the left on paper."""
    left = layout.page.side_x
    low, high = layout.page.paper(layout.drawn.low).imag, layout.page.paper(layout.drawn.high).imag
    return left - 1, low - 1, left + layout.scale * layout.drawn.part.thickness + 1, high + 1


@pytest.mark.parametrize("material", ["C45", "PLA"])
def test_the_sheet_of_a_linear_cam_has_heights_of_its_edge(material: str) -> None:
    """The roller's axis goes 15 up over 60 by the cycloid, stays 20, and comes back; the edge, 20 high before, is 5 off that line. A
    plate has no radii about its origin."""
    machine = read_mechanism(SPECS / "linear-cam.toml", [f"material.name={material}"]).resolved()
    (part,) = machine.assembly.parts
    facts = facts_of(machine, part)
    x = np.linspace(-10, 150, 320001)
    u = np.clip(np.where(x < 70, x / 60, (140 - x) / 60), 0, 1)
    axis = x + 1j * (25 + 15 * (u - np.sin(2 * np.pi * u) / (2 * np.pi)))
    assert [z.real for z in facts.levels] == list(range(-5, 150, 5))
    for z in facts.levels:
        assert float(np.min(np.abs(axis - z))) == pytest.approx(5.0, abs=2e-5)
    layout = _Layout(part, "d", 1e-3, facts)
    words = [each.text for each in layout.sheet.primitives if isinstance(each, Text)]
    assert [words.count(text) for text in ("35.000", "-5", "145")] == [5, 1, 1]
    assert not [text for text in words if text.startswith("(R")]
    said = {"0.05", "B", "C", "Ra 0.8"}
    assert said & set(words) == (said if material == "C45" else set())


def test_a_metal_drum_s_section_tells_its_rims_and_its_cutter() -> None:
    """The groove is 10.2 wide, square to its walls, which are level where the roller is lowest and highest."""
    _, drum, facts = sheet_of()
    heights = [z for _, _, z in facts.heights]
    rims = min(heights) - 5.1, drum.length - max(heights) - 5.1
    words = drum_section(drum, facts, SCALES).words
    (told,) = (word.removeprefix("rims nominally ") for word in words if word.startswith("rims"))
    assert [*map(float, told.split(" and "))] == pytest.approx(rims, abs=0.05)
    assert "cutter Ø10, a pass for each wall" in words
    _, plain, printed = sheet_of(metal=False)
    assert not [word for word in drum_section(plain, printed, SCALES).words if "cutter" in word]


def test_a_section_tells_the_cone_of_its_roller() -> None:
    """The groove is 10.2 wide half way along a roller that is 10 there, and each wall leans by the half angle."""
    _, drum, facts = sheet_of("geometry.roller.cone_deg=10")
    section = drum_section(drum, facts, SCALES)
    assert "half angle of its cone 10°" in section.words
    (a, b, _, measure), _ = section.sizes
    assert abs(b - a) == pytest.approx(measure.value) and measure.value == pytest.approx(10.2)
    lean = [
        np.degrees(np.angle(q - p))
        for p, q in zip(section.edges[0], section.edges[0][1:], strict=False)
    ]
    assert sorted(abs(each) for each in lean if abs(abs(each) - 90) > 1) == pytest.approx([10, 170])


@pytest.mark.parametrize("settings", KINDS)
def test_heights_of_a_drum_s_walls_have_a_datum_on_its_lower_end(
    settings: tuple[str, ...],
) -> None:
    """Bore and flat leave the drum free to move along its axis [ISO 5459]; its lower end, on the left in the view, holds that."""
    layout, drum, _ = sheet_of(*settings)
    assert layout.drawn.face_letter == "C"
    end = drum.floor if settings == RIB else drum.outside
    triangles = [np.array(each.corners) for each in layout.sheet.things if hasattr(each, "corners")]
    feet = [z[:2] for z in triangles if np.allclose(z[:2].real, layout.page.side_x)]
    (foot,) = [z for z in feet if abs(z[0] - z[1]) == pytest.approx(3.0)]
    assert np.all(np.abs(foot.imag - layout.datum.imag) < layout.scale * end)
    words = [each.text for each in layout.sheet.primitives if isinstance(each, Text)]
    assert words.count("C") == 2  # the datum, and the frame of the walls
    plain, _, _ = sheet_of(*settings, metal=False)
    assert not plain.drawn.face_letter
