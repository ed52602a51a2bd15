"""The sheet of a shaft against the shaft's own sizes, as ezdxf reads its drawing, and against its own paper."""

from __future__ import annotations

import math
import re
import tomllib
from pathlib import Path

import ezdxf
import numpy as np
import pytest
import shapely

import camgen
from camgen.files.shaft_sheet import _Page, write_shaft
from camgen.files.sheet import Sheet, Stroke, Text
from camgen.files.title_block import Facts
from camgen.geometry.outlines import Region, circle, end_point, start_point
from camgen.machines.sources import read_mechanism
from camgen.parts.part import Layer, Part, keyed_bore
from camgen.parts.shafts import Seat, rod_with_keyways, shaft_and_bearings
from camgen.parts.turned_shafts import TurnedShaft
from camgen.pipeline.drawings import shaft_facts
from camgen.starters import in_metal

FACTS = Facts(tolerance="ISO 2768-mK", rod_chamfer=1.0, roughness=0.8, run_out=0.03, symmetry=0.04)


def shaft(bore: float, *lengths: float, key: float = 0.0, ringed: bool = False) -> TurnedShaft:
    made = shaft_and_bearings(Seat(bore, lengths, key, ringed=ringed))[0].shaft
    assert made is not None
    return made


def test_a_drum_s_shaft_is_drawn_at_its_own_size(tmp_path: Path) -> None:
    """20 h6 x 125 with grooves of 19 [DIN 471] and a keyway 6 x 36, at least 3 from its grooves, 3.5 deep [DIN 6885]: outline and dimensions by hand."""
    made = shaft(20.0, 44.0, key=6.0, ringed=True)
    dxf, pdf = write_shaft(tmp_path, "drum", made, FACTS)
    assert dxf.name == "drum-shaft-drawing.dxf" and pdf.read_bytes().startswith(b"%PDF")
    document = ezdxf.readfile(dxf)
    assert not document.audit().errors
    space = document.modelspace()
    ends = [each.get_points("xy") for each in space.query('LWPOLYLINE[layer=="VIEW"]')]
    outline = max((np.array(each) for each in ends), key=len)
    outline = outline - [outline[:, 0].min(), 0.0]
    assert np.ptp(outline, axis=0) == pytest.approx((125.0, 20.0))
    floors = outline[np.isclose(abs(outline[:, 1]), 9.5)]
    walls = sorted({round(float(x), 3) for x in floors[:, 0]})
    # rings of 1.2 about 5 to 17 and 81 to 93 with 0.1 to spare, and about 27 to 71 with 0.3
    assert walls == pytest.approx(
        [3.8, 5.1, 17.0, 18.3, 25.65, 26.95, 71.05, 72.35, 79.8, 81.1, 93.0, 94.3]
    )
    sizes = sorted(round(each.dxf.actual_measurement, 2) for each in space.query("DIMENSION"))
    assert sizes == pytest.approx(
        [3.8, 6.0, 14.5, 14.5, 16.5, 20.0, 25.65, 31.0, 36.0, 46.7, 79.8, 125.0]
    )


@pytest.mark.parametrize(
    "made",
    [
        shaft(20.0, 44.0, key=6.0, ringed=True),
        shaft(8.0, 31.5, key=2.0, ringed=True),
        shaft(20.0, 24.0, 24.0, key=6.0),
        shaft(50.0, 120.0, key=14.0, ringed=True),
        shaft(6.0, 5.0),
        shaft(12.0, 12.0, 12.2, key=4.0, ringed=True),
    ],
    ids=["drum", "thin", "two", "thick", "plain", "pair"],
)
def test_what_it_says_stays_on_the_paper(made: TurnedShaft) -> None:
    """All texts within the frame, none on another one."""
    page = _Page(made, FACTS, Part("shaft", "Shaft", ()))
    boxes = []
    for text in page.draw("shaft").primitives:
        if not isinstance(text, Text):
            continue
        back = text.width * {"left": 0.0, "centre": 0.5, "right": 1.0}[text.align]
        corner = text.at - back * text.direction
        far = corner + (text.width + 1j * text.height) * text.direction
        low = complex(min(corner.real, far.real), min(corner.imag, far.imag))
        high = complex(max(corner.real, far.real), max(corner.imag, far.imag))
        assert low.real >= 20 and low.imag >= 10, text.text
        assert high.real <= page.wide - 10 and high.imag <= page.high - 10, text.text
        boxes.append((text.text, low, high))
    for k, (one, low, high) in enumerate(boxes):
        for other, least, most in boxes[:k]:
            wide = min(high.real, most.real) - max(low.real, least.real)
            tall = min(high.imag, most.imag) - max(low.imag, least.imag)
            assert wide < 0.01 or tall < 0.01, (one, other)


@pytest.mark.parametrize(
    "made",
    [
        shaft(20.0, 44.0, key=6.0, ringed=True),
        shaft(8.0, 31.5, key=2.0, ringed=True),
        shaft(50.0, 120.0, key=14.0, ringed=True),
        shaft(20.0, 24.0, key=6.0),
    ],
    ids=["drum", "thin", "thick", "disc"],
)
def test_no_leader_runs_through_a_frame(made: TurnedShaft) -> None:
    """Of shafts with grooves, whose leaders are beside those of run-outs: thin lines and what stands in frames."""
    page = _Page(made, FACTS, Part("shaft", "Shaft", ()))
    things = list(page.draw("shaft").primitives)
    frames = [
        shapely.box(*_bounds(each))
        for each in things
        if isinstance(each, Stroke) and each.closed and each.layer == "TEXT"
    ]
    assert len(frames) > 20
    for each in things:
        if isinstance(each, Stroke) and each.layer == "DIM":
            points = [start_point(piece) for piece in each.pieces] + [end_point(each.pieces[-1])]
            leader = shapely.LineString([(z.real, z.imag) for z in points])
            assert not any(leader.crosses(frame) for frame in frames), points


def _bounds(stroke: Stroke) -> tuple[float, float, float, float]:
    corners = [start_point(piece) for piece in stroke.pieces]
    x = [z.real for z in corners]
    y = [z.imag for z in corners]
    return min(x), min(y), max(x), max(y)


def test_the_end_for_the_coupling_runs_true_and_the_seats_have_the_fit_of_their_bearings() -> None:
    """Light loads on an inner ring that turns: h6 up to 18, j6 up to 40, k6 above [engineersedge.com, 15319]; limits by ISO 286.
    Both the bore's seat and the coupling's end, half way along its 30.7 from 94.3, have the run-out to both bearings."""

    def texts(made: TurnedShaft) -> list[str]:
        things = _Page(made, FACTS, Part("shaft", "Shaft", ())).draw("shaft").primitives
        return [each.text for each in things if isinstance(each, Text)]

    drum = shaft(20.0, 44.0, key=6.0, ringed=True)
    said = texts(drum)
    assert "Seats A and B Ø20 j6 (+0.009/-0.004)" in said
    assert "Ø20 h6 but for seats, grooves and keyways" in said
    assert "Seats A and B Ø50 k6 (+0.018/+0.002)" in texts(shaft(50.0, 120.0, key=14.0))
    assert not any("Seats A and B" in each for each in texts(shaft(8.0, 31.5, key=2.0)))
    assert said.count("0.03") == 2
    page = _Page(drum, FACTS, Part("shaft", "Shaft", ()))
    starts = [
        start_point(each.pieces[0])
        for each in page.draw("shaft").primitives
        if isinstance(each, Stroke) and each.layer == "DIM"
    ]
    assert min(abs(each - page.at((94.3 + 125.0) / 2, 10.0)) for each in starts) < 0.01


def test_a_rod_s_keyways_are_slots_seen_from_above(tmp_path: Path) -> None:
    """10 h9 x 40 with keyways 3 wide, 1.8 deep [DIN 6885] over the first 6 and from 26 on: each is open at its end and round
    inside, R1.5, and both are measured from the lower end; the section, at the origin, has them on top; limits of h9 and P9 by ISO 286."""
    keyed, bare = Region(keyed_bore(10.0, 3.0, -1.8)), Region(circle(0j, 5.0))
    spans = ((keyed, 0.0, 6.0), (bare, 6.0, 26.0), (keyed, 26.0, 33.0), (keyed, 33.0, 40.0))
    rod = Part("rod", "Rod", tuple(Layer(*span) for span in spans))
    made = rod_with_keyways(rod, "h9", "P9", [(26.0, 32.0), (0.0, 6.0)])
    assert made is not None and [(each.start, each.end) for each in made.keyways] == [
        (0.0, 6.0),
        (26.0, 40.0),
    ]
    facts = Facts(tolerance="ISO 2768-mK", own_key=0.04, rod_chamfer=0.5)
    dxf, _ = write_shaft(tmp_path, "x", made, facts, rod)
    assert dxf.name == "x-rod-drawing.dxf"
    space = ezdxf.readfile(dxf).modelspace()
    (section,) = (each.get_points("xyb") for each in space.query('LWPOLYLINE[layer=="CUT"]'))
    assert max(y for _, y, _ in section) == pytest.approx(math.sqrt(25 - 1.5**2))
    assert sum(y == pytest.approx(5 - 1.8) for _, y, _ in section) == 2, "its floor"
    views = [each.get_points("xyb") for each in space.query('LWPOLYLINE[layer=="VIEW"]')]
    slots = [each for each in views if any(bulge for *_, bulge in each)]
    left = min(x for each in views for x, *_ in each)
    reach = sorted((min(x for x, *_ in each), max(x for x, *_ in each)) for each in slots)
    ends = [(low - left, high - left) for low, high in reach]
    assert ends == [pytest.approx((0.0, 6.0)), pytest.approx((26.0, 40.0))], (
        "R1.5 within the length"
    )
    sizes = {(round(e.dxf.actual_measurement, 3), e.dxf.text) for e in space.query("DIMENSION")}
    assert sizes == {
        (6.0, "<> +0.2/0"),
        (26.0, "<> 0/-0.2"),
        (40.0, "<>"),
        (10.0, "%%c<> h9 (0/-0.036)"),
        (3.0, "<> P9 (-0.006/-0.031)"),
        (8.2, "<> 0/-0.1"),
    }
    texts = {each.dxf.text for each in space.query("TEXT")}
    assert {"C-C, turned 90%%d", "Keyways' corners as DIN 6885", "0.04", "A"} <= texts
    assert "Keys at 0 to 6 and 26 to 32 from the left" in texts


def test_what_is_no_keyed_rod_has_no_sheet_of_a_shaft() -> None:
    """A hub has a hole, a plain rod no keyway, and one that is thicker elsewhere is no rod."""
    keyed, bare = Region(keyed_bore(10.0, 3.0, -1.8)), Region(circle(0j, 5.0))
    thick = Layer(Region(circle(0j, 6.0)), 6.0, 9.0)
    hub = Layer(Region(circle(0j, 9.0), (keyed_bore(10.0, 3.0, 1.4),)), 0.0, 6.0)
    for layers in ((Layer(bare, 0.0, 6.0),), (Layer(keyed, 0.0, 6.0), thick), (hub,)):
        assert rod_with_keyways(Part("x", "X", layers), "h9", "P9", ()) is None


@pytest.mark.parametrize("name", ["disc-cam", "cylinder-cam"])
def test_the_starters_in_metal_have_its_facts(name: str) -> None:
    """C45 is 1.0503; 7.85 g/cm^3 of a rod of 20, less some hundredths for its grooves and its keyway."""
    machine = read_mechanism(tomllib.loads(in_metal(name)))
    (made,) = (each.shaft for each in machine.assembly.bought if each.shaft)
    facts = shaft_facts(machine, made)
    assert facts.heat_treatment == "quenched and tempered, at least 200 HB"
    assert facts.protection == "oiled against rust"
    assert facts.material == "C45 (1.0503)" and facts.rod_chamfer == 1.0
    rod = np.pi * 100 * made.length * 7.85e-3
    assert facts.mass_g is not None and 0.96 * rod < facts.mass_g < 0.99 * rod


def test_the_page_links_to_all_sheets(tmp_path: Path) -> None:
    """Also to that of the shaft, which is no part, and to the cam's table on a sheet of its own."""
    camgen.build(tomllib.loads(in_metal("disc-cam")), tmp_path, only="dxf,report")
    (page,) = tmp_path.rglob("report.html")
    sheets = {path.name for path in tmp_path.rglob("*-drawing.pdf")}
    assert {name.removeprefix("disc-cam-") for name in sheets} == {
        "assembly-drawing.pdf",
        "shaft-drawing.pdf",
        "cam-drawing.pdf",
        "cam-tracks-drawing.pdf",
    }
    linked = set(re.findall(r'href="(?:[^"]*/)?([^"/]+-drawing\.pdf)"', page.read_text("utf-8")))
    assert linked == sheets


def test_no_line_of_a_dimension_runs_through_the_size_of_another() -> None:
    """Lines from the ends of what is farther off are broken there: of a shaft with rings and bearings, whose lengths lie over each other."""
    made = shaft(25.0, 25.0, key=8.0, ringed=True)
    page = _Page(made, FACTS, Part("shaft", "Shaft", ()))
    sheet = Sheet(page.wide, page.high, "")
    page._sizes(sheet)
    drawn = list(sheet.primitives)
    words = [each for each in drawn if isinstance(each, Text) and each.direction == 1]
    ends = [
        (complex(start_point(piece)), complex(end_point(piece)))
        for each in drawn
        if isinstance(each, Stroke)
        for piece in each.pieces
    ]
    upright = [(a, b) for a, b in ends if abs((b - a).real) < 1e-9]
    assert len(words) >= 9 and len(upright) > 2 * len(words), "some are broken"
    for text in words:
        for a, b in upright:
            low, high = sorted((a.imag, b.imag))
            beside = abs(a.real - text.at.real) >= text.width / 2
            assert beside or high <= text.at.imag or low >= text.at.imag + text.height
