"""Sheets for a laser: proved as cut, in DXF and SVG; damage, a beam that is too wide and sheets that are too small are told."""

import csv
import re
from pathlib import Path

import ezdxf
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from judged import judged, wrong
from test_solids import oval

from camgen.errors import DesignError, FileError, SpecError
from camgen.files.cutting import Piece, read_svg, sheet_picture, write_sheet
from camgen.files.dxf import read_dxf
from camgen.geometry.outlines import Region, circle, polygon, rectangle
from camgen.geometry.rings import Ring
from camgen.judge.sheets import Beam, SheetCopy, _round_corner, judge_sheet, widened
from camgen.machines.sources import read_mechanism
from camgen.parts.assembly import printed_parts
from camgen.parts.fits import Compensation, compensated
from camgen.parts.part import Layer, Part, keyed_bore
from camgen.parts.sheets import why_not
from camgen.pipeline.build import build
from camgen.pipeline.expectation import nominal_part
from camgen.pipeline.laser import sheet_parts
from camgen.report.page import to_html
from camgen.report.report import Report

TOLERANCE = 1e-3
KERF = 0.2
DXF = frozenset({"dxf"})
BEAM = Beam(KERF, 2.0, (200.0, 100.0))


def plate(*holes, outer=None):
    return Part(
        "plate",
        "Plate",
        (Layer(Region(outer or oval(), (circle(0, 4), *holes)), 0, 3),),
        bore=8.0,
        min_wall=1.0,
    )


def written(folder, part, kerf=KERF, places=((0.5, 50 + 45j), (-2.0, 140 + 50j)), engraved=()):
    """A sheet with copies of a part, and what is found on it."""
    path = compensated(part, Compensation(hole=-kerf / 2, profile=-kerf / 2)).region
    pieces = [
        Piece(
            f"plate-{k + 1}",
            path.moved(np.exp(1j * angle), at),
            tuple(each.moved(np.exp(1j * angle), at) for each in engraved),
        )
        for k, (angle, at) in enumerate(places)
    ]
    files = [folder / f"s.{ending}" for ending in ("dxf", "svg")]
    for file in files:
        write_sheet(file, pieces, (200.0, 100.0), TOLERANCE)
    laid = [SheetCopy("plate", k + 1, angle, at) for k, (angle, at) in enumerate(places)]
    return files, laid, {"plate": nominal_part(part, TOLERANCE)}, BEAM


def failing(files, laid, meant, beam=BEAM):
    return {finding.code for finding in judge_sheet(*files, laid, meant, beam)[0] if not finding.ok}


def test_parts_come_back_as_cut(tmp_path):
    part = plate(keyed_bore(6, 2, 1).moved(shift=14 + 4j))
    files, laid, meant, beam = written(tmp_path, part)
    findings, judged = judge_sheet(*files, laid, meant, beam)
    assert [finding for finding in findings if not finding.ok] == []
    worst = max(finding.measured for finding in findings if finding.code == "ROUND_TRIP")
    assert worst < 2 * TOLERANCE
    (kerf,) = {round(finding.measured, 3) for finding in findings if finding.code == "KERF"}
    assert kerf == pytest.approx(
        (2**0.5 - 1) * KERF / 2, abs=2e-3
    )  # the keyway's corners, as round as the beam
    (shape,) = judged["plate"].sections[0]
    assert shape.holes[0].area != 0 and len(shape.holes) == 2
    drawn = read_dxf(files[0], engraving=True)
    assert drawn.units == 4 and len(drawn.cut) == 6 and not drawn.faults
    assert {layer.dxf.name: layer.dxf.color for layer in ezdxf.readfile(files[0]).layers}[
        "CUT"
    ] == 1


def test_the_path_is_exact_and_its_arcs_stay_arcs(tmp_path):
    files, *_ = written(tmp_path, plate(outer=circle(0, 20)), places=((0.0, 50 + 50j),))
    radii = sorted(entity.dxf.radius for entity in ezdxf.readfile(files[0]).modelspace())
    assert radii == pytest.approx([4 - KERF / 2, 20 + KERF / 2], abs=1e-12)


def test_a_path_without_kerf_is_told(tmp_path):
    files, laid, meant, _ = written(tmp_path, plate(), kerf=0.0)
    assert failing(files, laid, meant) >= {"ROUND_TRIP", "KERF"}


def test_a_notch_narrower_than_the_kerf_is_told(tmp_path):
    def notched(width):
        half = width / 2
        corners = [
            -20 - 20j,
            20 - 20j,
            complex(20, -half),
            complex(15, -half),
            complex(15, half),
            complex(20, half),
        ]
        return plate(outer=polygon([*corners, 20 + 20j, -20 + 20j]))

    assert failing(*written(tmp_path, notched(0.5))[:3]) == set()
    files, laid, meant, beam = written(tmp_path, notched(0.15))
    findings = judge_sheet(files[0], files[1], laid, meant, beam)[0]
    assert {finding.code for finding in findings if not finding.ok} >= {"KERF"}
    assert (
        max(finding.measured for finding in findings if finding.code == "KERF") > 4
    )  # of a notch that is 5 deep


def test_a_contour_that_falls_apart_or_vanishes_is_told():
    """A bar of two discs on a neck of 2 mm, moved in by more than a half of it; a disc moved in by more than its radius."""
    neck = Ring(np.array([-10 - 1j, 10 - 1j, 10 + 1j, -10 + 1j]), np.array([0.0, 2.0, 0.0, 2.0]))
    assert widened(neck, -0.9).area < neck.area
    with pytest.raises(ValueError, match="2 pieces are left of a contour moved by -1.1 mm"):
        widened(neck, -1.1)
    with pytest.raises(ValueError, match="0 pieces are left of a contour moved by -2 mm"):
        widened(Ring(np.array([1.5, -1.5 + 0j]), np.ones(2)), -2.0)


@pytest.mark.parametrize("count", [3, 4, 12])
def test_a_beam_stays_away_from_a_corner_by_what_its_disc_leaves(count):
    """Of a regular polygon that turns to the right; to the left it goes round all of them."""
    corners = 9 * np.exp(-2j * np.pi * np.arange(count) / count)
    away = 0.1 * (1 / np.cos(np.pi / count) - 1)
    assert _round_corner(corners, 0.1) == pytest.approx(away, rel=1e-9)
    assert _round_corner(corners[::-1], 0.1) == 0


@pytest.mark.long
def test_damage_is_told(tmp_path):
    files, laid, meant, _ = written(tmp_path, plate())
    dxf, svg = files
    text = svg.read_text()
    svg.write_text(re.sub(r'cx="(\d+)', lambda found: f'cx="{int(found[1]) + 1}', text, count=1))
    assert failing(files, laid, meant) == {"ROUND_TRIP"}
    svg.write_text(text.replace('mm"', 'in"'))
    assert failing(files, laid, meant) == {"ROUND_TRIP"}
    wider = text.replace('width="200mm"', 'width="300mm"').replace('"0 0 200 100"', '"0 0 300 100"')
    svg.write_text(wider)
    (off,) = (each for each in judge_sheet(*files, laid, meant, BEAM)[0] if not each.ok)
    assert off.code == "ROUND_TRIP" and "contours on 300 x 100 mm instead of" in off.message
    svg.write_text(text.replace("#ff0000", "#00ff00"))
    with pytest.raises(FileError, match="not a sheet in SVG"):
        read_svg(svg)
    svg.write_text(text)
    assert failing(files, [*laid, SheetCopy("plate", 3, 0.0, 0j)], meant) >= {"COPIES"}
    assert failing(files, [laid[0], SheetCopy("plate", 2, -2.0, 140.02 + 50j)], meant) == {
        "ROUND_TRIP",
        "KERF",
    }
    assert failing(files, laid, meant, Beam(KERF, 30.0, (200.0, 100.0))) == {"SHEET_FIT"}
    drawing = ezdxf.readfile(dxf)
    circles = drawing.modelspace().query("CIRCLE")
    circles[0].dxf.radius += 0.01
    drawing.saveas(dxf)
    assert failing(files, laid, meant) == {"ROUND_TRIP", "KERF"}
    drawing.header["$INSUNITS"] = 1
    drawing.saveas(dxf)
    assert failing(files, laid, meant) == {"DXF_CLOSED"}


# What moves, hides, scales or hands over to another tool what a laser reads, each at some line of a sheet.
HEAD = "<svg "
GROUP = '<g id="CUT" '
PIECE = "<g><title>plate-1</title>\n"
STRANGE = [
    (GROUP, f'{GROUP}transform="scale(1.05)" '),
    (GROUP, f'{GROUP}display="none" '),
    (GROUP, f'{GROUP}style="visibility:hidden" '),
    (GROUP, f'{GROUP}class="x" '),
    ("<circle ", '<circle transform="translate(1)" '),
    ("<path ", '<path pathLength="1" '),
    ("<path ", '<path clip-path="url(#c)" '),
    ("<circle ", '<circle opacity="0" '),
    (PIECE, f"<g mask='url(#m)'>{PIECE[3:]}"),
    (PIECE, f'{PIECE}<use href="#CUT" x="5"/>\n'),
    (PIECE, f"{PIECE}<style>circle {{r: 9px}}</style>\n"),
    (PIECE, f"{PIECE}<!-- -->\n"),
    (PIECE, f'{PIECE}<g transform="rotate(3)">\n'),
    (PIECE, f"{PIECE}&x;\n"),
    (HEAD, '<?xml-stylesheet href="s.css"?>\n<svg '),
    (HEAD, '<!DOCTYPE svg [<!ENTITY x "">]>\n<svg '),
    (HEAD, f'{HEAD}x="3" '),
    (HEAD, f'{HEAD}preserveAspectRatio="none" '),
    ('viewBox="0 0 200 100"', 'viewBox="0 0 100 50"'),
    ('width="200mm"', 'width="200"'),
    ('viewBox="0 0', 'viewBox="1 0'),
    ('stroke="#ff0000"', 'stroke="#f00"'),
    ('fill="none"', 'fill="red"'),
    ('stroke-width="0.025"', 'stroke-width="1"'),
    ('mm" height', 'in" height'),
    (" Z", ""),
    (" Z", " Z M1 1 L2 2 Z"),
    (" L", " l"),
    (" 0 0 0 ", " 0 1 0 "),
    (" 0 0 0 ", " 9 0 0 "),
    ("</svg>\n", "</svg>\n<!-- -->\n"),
    ("</svg>\n", ""),
]


@pytest.fixture(scope="module")
def sheet(tmp_path_factory):
    """A sheet of two copies with straight edges, arcs and circles."""
    return written(
        tmp_path_factory.mktemp("sheet"), plate(keyed_bore(6, 2, 1).moved(shift=14 + 4j))
    )


@pytest.mark.long
@pytest.mark.parametrize("was, now", STRANGE)
def test_a_sheet_that_is_more_than_plain_geometry_is_told(sheet, tmp_path, was, now):
    (dxf, svg), laid, meant, _ = sheet
    text = svg.read_text(encoding="utf-8")
    assert text.count(was) >= 1
    (other := tmp_path / "s.svg").write_text(text.replace(was, now, 1), encoding="utf-8")
    (told,) = [f for f in judge_sheet(dxf, other, laid, meant, BEAM)[0] if not f.ok]
    assert (told.code, str(told.where)) == ("ROUND_TRIP", "s.svg")
    assert re.search(r"line \d+|its end|contours on 100 x 50", told.message)


@pytest.mark.long
@given(st.data())
def test_no_attribute_of_any_element_is_passed_over(sheet, tmp_path_factory, data):
    """Whatever its name: those that SVG has today are not all that a program may know."""
    text = sheet[0][1].read_text(encoding="utf-8")
    place = data.draw(
        st.sampled_from(
            [match.end() for match in re.finditer(r"<(?:svg|g|title|circle|path)\b", text)]
        )
    )
    name = data.draw(st.from_regex(r"[a-zA-Z_][a-zA-Z_:.-]{0,12}", fullmatch=True))
    value = data.draw(st.text("abcxyz0123456789.%() ", max_size=8))
    (other := tmp_path_factory.getbasetemp() / "other.svg").write_text(
        f'{text[:place]} {name}="{value}"{text[place:]}'
    )
    with pytest.raises(FileError, match="not a sheet in SVG as camgen writes it"):
        read_svg(other)


def test_what_is_read_is_all_that_there_is(sheet):
    """The numbers of the text, put where the reader's rings have theirs: none is left over."""
    _, layers = read_svg(sheet[0][1])
    text = sheet[0][1].read_text(encoding="utf-8")
    assert len(layers["CUT"].rings) == len(re.findall("<circle|<path", text)) == 6
    edges = sum(len(ring.points) for ring in layers["CUT"].rings)
    assert edges == len(re.findall(" [LA]", text)) + 2 * text.count("<circle")


def test_an_arc_with_two_radii_is_told(sheet, tmp_path):
    text = sheet[0][1].read_text(encoding="utf-8")
    (other := tmp_path / "s.svg").write_text(
        re.sub(r" A([\d.]+) ([\d.]+) ", r" A\1 99 ", text, count=1)
    )
    with pytest.raises(FileError, match="an arc of the radii"):
        read_svg(other)


def test_a_piece_under_another_one_s_name_is_told(sheet, tmp_path):
    (dxf, svg), laid, meant, _ = sheet
    text = svg.read_text(encoding="utf-8")
    (other := tmp_path / "s.svg").write_text(text.replace("plate-1", "plate-3"))
    (told,) = [f for f in judge_sheet(dxf, other, laid, meant, BEAM)[0] if not f.ok]
    assert str(told.where) == "s.svg" and "names of the list" in told.message


def test_a_layer_for_another_tool_is_told(sheet, tmp_path):
    """A laser's program takes the tool by the layer's colour or line weight."""
    (dxf, svg), laid, meant, _ = sheet
    for key, value in (("color", 5), ("lineweight", 50), ("true_color", 255)):
        drawing = ezdxf.readfile(dxf)
        drawing.layers.get("CUT").dxf.set(key, value)
        drawing.saveas(other := tmp_path / "s.dxf")
        assert {f.code for f in judge_sheet(other, svg, laid, meant, BEAM)[0] if not f.ok} == {
            "DXF_CLOSED"
        }


def test_engraving_in_the_colour_of_cuts_is_told(tmp_path):
    """Blue is engraved; a mark in red would be cut out, and one in magenta is left to the program."""
    mark = polygon([10 + 0j, 14 + 0j, 12 + 3j])
    (dxf, svg), laid, meant, _ = written(tmp_path, plate(), engraved=[mark])
    for color, told in ((5, set()), (1, {"DXF_CLOSED"}), (6, {"DXF_CLOSED"})):
        drawing = ezdxf.readfile(dxf)
        drawing.layers.get("ENGRAVE").color = color
        drawing.saveas(other := tmp_path / "o.dxf")
        assert failing((other, svg), laid, meant) == told


def test_pieces_over_the_edge_or_too_near_are_told(tmp_path):
    files, laid, meant, beam = written(tmp_path, plate(), places=((0.0, 20 + 45j), (0.0, 85 + 50j)))
    found = [
        f for f in judge_sheet(files[0], files[1], laid, meant, beam)[0] if f.code == "SHEET_FIT"
    ]
    assert [finding.ok for finding in found] == [False, True]
    files, laid, meant, beam = written(
        tmp_path, plate(), places=((0.0, 50 + 45j), (0.0, 112 + 45j))
    )
    found = [
        f for f in judge_sheet(files[0], files[1], laid, meant, beam)[0] if f.code == "SHEET_FIT"
    ]
    assert [finding.ok for finding in found] == [True, False]


def test_engraving_comes_first_and_is_not_cut(tmp_path):
    piece = Piece(
        "p",
        Region(rectangle(10 + 10j, 60 + 40j), (circle(20 + 20j, 5),)),
        (polygon([30 + 15j, 40 + 15j, 35 + 25j]),),
    )
    for ending in ("dxf", "svg"):
        write_sheet(tmp_path / f"s.{ending}", [piece], (100.0, 50.0), TOLERANCE)
    drawn = read_dxf(tmp_path / "s.dxf", engraving=True)
    size, layers = read_svg(tmp_path / "s.svg")
    assert size == (100.0, 50.0) and (len(drawn.cut), len(drawn.engraved)) == (2, 1)
    assert {name: len(layer.rings) for name, layer in layers.items()} == {"ENGRAVE": 1, "CUT": 2}
    assert read_dxf(tmp_path / "s.dxf").faults  # no drawing of one part
    for ring, other in zip(
        (*drawn.engraved, *drawn.cut), (*layers["ENGRAVE"].rings, *layers["CUT"].rings), strict=True
    ):
        assert ring.area == pytest.approx(other.area, rel=1e-6) and ring.centroid == pytest.approx(
            other.centroid, abs=1e-6
        )


# ---- whole machines -----------------------------------------------------------------------------------------------------


@pytest.mark.long
def test_a_linkage_of_sheet_moves_as_asked(tmp_path, root):
    settings = ("laser.thickness=4", "laser.kerf=0.3")
    report = build(root / "specs" / "linkage.toml", tmp_path / "a", DXF, settings)
    assert report.ok
    (moved,) = [f for f in report.findings if f.code == "MOTION_ERROR" and "sheets" in str(f.where)]
    assert moved.measured < 1e-3
    codes = {f.code for f in report.findings if "sheet" in str(f.where)}
    assert codes >= {"KERF", "SHEET_FIT", "PIN_GAP", "LASH", "MIN_WALL", "ROUND_TRIP"}
    (table,) = [table for table in report.tables if table.title.startswith("Cut of sheets")]
    otherwise = {row[1]: row[4] for row in table.rows if row[0] == "none"}
    assert otherwise["ground"] == "5 mm thick, the sheet is 4" and otherwise["pin-1"].startswith(
        "stepped"
    )
    assert 0 < report.numbers["sheet_density"] < 1 and report.numbers["sheets"] == 1
    assert any("laser.kerf = 0.3 changes only the sheets" in line for line in report.warnings)
    again = build(root / "specs" / "linkage.toml", tmp_path / "b", DXF, settings)
    names = [path.name for path in report.folder.glob("*sheet*")]
    assert len(names) == 3 and all(
        (report.folder / n).read_bytes() == (again.folder / n).read_bytes() for n in names
    )
    assert judged(report.folder, "dxf").ok
    dxf = report.folder / "linkage-sheet-1.dxf"
    drawing = ezdxf.readfile(dxf)
    drawing.modelspace().query("CIRCLE")[0].dxf.center += ezdxf.math.Vec3(0.05, 0, 0)
    drawing.saveas(dxf)
    assert {f.code for f in wrong(report.folder, "dxf")} >= {"MOTION_ERROR", "KERF", "ROUND_TRIP"}
    listed = again.folder / "linkage-sheets.csv"
    rows = list(csv.reader(listed.read_text().splitlines()))
    column = rows[0].index("copy")
    rows[1][column] = str(int(rows[1][column]) + 5)
    listed.write_text("\n".join(map(",".join, rows)))
    assert {str(f.where) for f in wrong(again.folder, "dxf") if f.code == "COPIES"} == {listed.name}
    rows[1][3] = "no number"
    listed.write_text("\n".join(map(",".join, rows)))
    with pytest.raises(FileError, match="not a list of sheets"):
        judged(again.folder, "dxf")


@pytest.mark.long
def test_what_cannot_be_cut_is_refused_before_anything_is_written(tmp_path, root):
    spec = root / "specs" / "linkage.toml"
    with pytest.raises(
        DesignError, match="fits on no sheet of 60 x 60 mm: make laser.sheet larger"
    ):
        build(spec, tmp_path, DXF, ("laser.thickness=4", "laser.sheet=[60.0, 60.0]"))
    with pytest.raises(
        DesignError,
        match=r"laser.kerf = 5 mm is too wide for a hole or a slot of \w+: take a finer beam",
    ):
        build(spec, tmp_path, DXF, ("laser.thickness=4", "laser.kerf=5"))
    with pytest.raises(SpecError, match="laser.kerf"):
        build(spec, tmp_path, DXF, ("laser.kerf=-0.1",))
    assert not any(tmp_path.iterdir())
    thin = build(spec, tmp_path, DXF, ("laser.thickness=7",))
    assert thin.ok and any("no part is flat and as thick" in line for line in thin.warnings)
    assert not list(thin.folder.glob("*sheet*"))


def test_which_parts_a_sheet_can_be(root):
    mechanism = read_mechanism(
        root / "specs" / "thread-take-up.toml", ("laser.thickness=4",)
    ).resolved()
    assert {part.name for part in sheet_parts(mechanism)} == {
        "ground",
        "output",
        "crank",
        "coupler",
        "spacer-1",
        "collar",
    }
    assert {part.name for part in printed_parts(mechanism.assembly)} == {
        p.name for p in mechanism.assembly.parts if p.process == "printed"
    } - {part.name for part in sheet_parts(mechanism)}  # what is cut lies on no print plate
    said = {
        part.name: why_not(part, mechanism.laser.thickness) for part in mechanism.assembly.parts
    }
    assert said["shaft"] == "turned of steel" and said["thread-post-1"].startswith("stepped")
    assert said["pivot-C"] == "4.2 mm thick, the sheet is 4"


def test_the_report_shows_a_sheet_with_names_and_sizes(tmp_path):
    """A disc of 20 at (30, 25) and a bar of 40 x 10 with a hole of 4: boxes, and the way of the beam."""
    disc = Region(circle(30 + 25j, 10))
    bar = Region(rectangle(50 + 20j, 90 + 30j), (circle(60 + 25j, 2),))
    path = tmp_path / "m-sheet-1.svg"
    write_sheet(path, [Piece("disc-1", disc), Piece("bar <&", bar)], (200.0, 100.0), TOLERANCE)
    picture = sheet_picture(path)
    (first, a, *one), (second, b, *other) = picture.parts
    assert (first, second) == ("disc-1", "bar <&")
    assert [a, *one] == pytest.approx([20 + 15j, 20, 20])
    assert [b, *other] == pytest.approx([50 + 20j, 40, 10])
    assert picture.cut == pytest.approx(np.pi * 20 + 100 + np.pi * 4)
    page = to_html(Report("m", "linkage", [], sheets=[picture, picture]))
    section = page[page.index("Sheets, as they are cut") :]
    said = "2 parts within 90 × 35 mm of a sheet of 200 × 100 mm; red is cut, 0.175 m in all"
    assert section.count(said) == 4, "of each sheet once to be read and once to be heard"
    assert "bar &lt;&amp;</text>" in section and 'id="CUT"' not in page
    assert section.count('<circle cx="30" cy="75" r="10"/>') == 2
    assert "as they are cut" not in to_html(Report("m", "linkage", []))


def test_a_sheet_that_says_more_than_camgen_wrote_is_not_shown(tmp_path):
    path = tmp_path / "m-sheet-1.svg"
    write_sheet(path, [Piece("disc-1", Region(circle(30 + 25j, 10)))], (200.0, 100.0), TOLERANCE)
    path.write_text(path.read_text().replace("</svg>", "<script>alert(1)</script></svg>"))
    with pytest.raises(FileError, match="line"):
        sheet_picture(path)


@pytest.mark.long
def test_a_build_shows_what_it_cuts(tmp_path):
    settings = ["parts.hub_height=0", "laser.thickness=6", "parts.thickness=6"]
    spec = Path(__file__).resolve().parents[2] / "specs" / "disc-cam.toml"
    assert build(spec, tmp_path, frozenset({"dxf", "report"}), settings).ok
    page = (tmp_path / "disc-cam" / "report.html").read_text(encoding="utf-8")
    assert "Sheets, as they are cut" in page and "cam-1</text>" in page
