"""The page: what it says first, its margins by check, its machine in three dimensions, and that nothing else is needed."""

from __future__ import annotations

import base64
import gzip
import hashlib
import json
import math
import re
from dataclasses import replace
from importlib.resources import files

import numpy as np
import pytest
from test_report import EVIL, Page, made_up

from camgen.files.gltf import Shape, Track, glb
from camgen.findings import Finding, NotJudged, Where, as_read, at_least, at_most, worst_of_each
from camgen.geometry.mesh import Mesh
from camgen.machine.features import PartPose
from camgen.report.animation import Animation, Body, player
from camgen.report.page import once, to_html
from camgen.report.report import Report
from camgen.report.tables import margins
from camgen.study import Doing, Figure, Figures, HoleLabel, Mate, Plate, Plot, Scene, Step, Table

CORNERS = [[0, 0, 0], [9, 0, 0], [0, 9, 0], [0, 0, 9]]
FACES = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]]
TETRAHEDRON = Mesh(np.array(CORNERS, float), np.array(FACES))


def solid() -> Report:
    """The report of test_report with the machine as a solid: two copies of one part, a plate, two steps."""
    theta = np.linspace(0, 2 * np.pi, 360, endpoint=False)
    lifted = np.column_stack([np.eye(3), [0, 0, 9.0]])
    moving = Track(
        "cam", theta, np.zeros(360, complex), [("cam-1", 0, np.eye(3, 4)), ("cam-2", 0, lifted)]
    )
    scene = Scene(
        glb("demo", [Shape("cam", TETRAHEDRON, "#0b62a8")], [moving]),
        ["cam-1", "cam-2"],
        [Plate("demo-plate.3mf", [("cam", lifted)], (120.0, 30.4, 9.0), (220.0, 200.0))],
        [
            Step([Doing("first")], ["cam-1"]),
            Step(
                [Doing(EVIL)],
                ["cam-2"],
                1,
                [Mate("glue", EVIL, (1.0, 2.0, 3.00001), 4.0, 5.0, True)],
            ),
            Step([Doing("nut")]),
            Step([Doing("spring")], wire=np.array([[1, 2, 3], [4.5, 5.25, 6.0004]])),
        ],
        holes=[[HoleLabel(EVIL, "Ø4", (1.0, 2.0, 3.0))]],
    )
    return replace(
        made_up(), scene=scene, files=["spec.toml", "demo-assembly.glb", "demo-cam-drawing.pdf"]
    )


@pytest.fixture(scope="module")
def page() -> str:
    return to_html(solid())


def script(page: str, name: str) -> str:
    found = re.search(rf'<script type="[^"]*" id="{name}">(.*?)</script>', page, re.DOTALL)
    assert found
    return found[1]


def test_the_machine_is_in_the_page_and_the_library_that_shows_it(page: str) -> None:
    scene = solid().scene
    assert scene is not None and gzip.decompress(base64.b64decode(script(page, "glb"))) == scene.glb
    library = gzip.decompress(base64.b64decode(script(page, "three")))
    assert (
        library.startswith(b"var THREE=")
        and b"</script" not in library
        and b"http" not in library.replace(b"http://www.w3.org/1999/xhtml", b"")
    )
    lying = json.loads(script(page, "lying"))
    mate = {"how": "glue", "label": EVIL, "place": [1, 2, 3], "diameter": 4, "height": 5}
    mate |= {"comes": True, "within": False}
    assert lying == {
        "plates": [[[0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 9]]],
        "steps": [
            {"copies": [0], "way": -1, "mates": [], "wire": []},
            {"copies": [1], "way": 1, "mates": [mate], "wire": []},
            {"copies": [], "way": -1, "mates": [], "wire": []},
            {
                "copies": [],
                "way": -1,
                "mates": [],
                "wire": [[1.0, 2.0, 3.0], [4.5, 5.25, 6.0]],
            },
        ],
        "parts": [["", [[EVIL, "Ø4", [1, 2, 3], True]]]],
    }


def test_what_was_put_together_on_the_bench_comes_as_one_thing() -> None:
    """A plate with its pin is laid down and a frame glued on it; then it comes with both, over a shaft: the shaft and the pair have an
    arrow each, and the plate none when it comes again."""
    names = ("plate", "pin", "frame", "shaft")
    steps = (
        Step([Doing("press")], laid=[("plate", ("plate", "pin"), ())]),
        Step([Doing("glue")], ("plate", "frame")),
        Step([Doing("put on")], ("shaft", "plate", "frame", "pin")),
    )
    scene = solid().scene
    assert scene is not None
    whole = replace(solid(), scene=replace(scene, copies=names, steps=steps))
    _, glued, on = json.loads(script(to_html(whole), "lying"))["steps"]
    assert glued["copies"] == [0, 1, 2] and glued["things"] == [[0, 1], [2]]
    assert sorted(on["copies"]) == [0, 1, 2, 3] and on["things"] == [[3], [0, 1]]


def test_a_page_without_solids_says_what_to_build() -> None:
    said = "this page has no view in three dimensions: build 3mf & report"
    assert "build 3mf &amp; report" in to_html(replace(made_up(), why_flat=said))
    assert 'class="flat"' not in to_html(made_up())


def test_the_bundle_is_what_its_entry_file_makes_and_bears_its_licence() -> None:
    folder = files("camgen.report")
    packed = folder.joinpath("three.bundle.js.gz").read_bytes()
    assert len(packed) < 150_000
    # by esbuild 0.28.2 of three 0.187.0, as three.entry.js says
    wanted = "f172d3c10d2ea4af29fa619670fb73def7632e2f0d7459b1e36f0ca0ec00f46c"
    assert hashlib.sha256(gzip.decompress(packed)).hexdigest() == wanted
    assert "MIT License" in folder.joinpath("three.LICENSE").read_text(encoding="utf-8")
    entry = folder.joinpath("three.entry.js").read_text(encoding="utf-8")
    exported = set(re.findall(r"\b[A-Z]\w+", entry.partition("export")[2]))
    used = set(
        re.findall(r"THREE\.(\w+)", folder.joinpath("viewer.js").read_text(encoding="utf-8"))
    )
    assert used <= exported and exported - used <= {"WebGLRenderer"}


def test_what_the_scripts_ask_for_is_there(page: str) -> None:
    ids = {attributes["id"] for _, attributes in Page(page).elements if "id" in attributes}
    for name in ("page.js", "viewer.js"):
        text = files("camgen.report").joinpath(name).read_text(encoding="utf-8")
        assert (
            set(re.findall(r'byId\("([\w-]+)"\)', text))
            | set(re.findall(r'(?<!\w)text\("(\w+)"\)', text))
            <= ids
        )


def test_the_page_says_with_which_settings_a_slicer_prints() -> None:
    """Layers, nozzle and infill of the estimate stand where the plates are; without them nothing is said."""
    known = {"print layer": 0.2, "print nozzle": 0.4, "print infill": 0.35, "print time": 5.61}
    figures = [Figure(name, value) for name, value in known.items()]
    page = to_html(replace(solid(), numbers=Figures(figures)))
    said = "Settings: layers of 0.2 mm, a nozzle of 0.4 mm, and walls and infill that make 35% of a part plastic. "
    assert f"{said}With these it takes about 5.6 h at 60 mm/s." in page
    solid_parts = [
        replace(each, value=1.0) if "infill" in each.quantity else each for each in figures
    ]
    page = to_html(replace(solid(), numbers=Figures(solid_parts)))
    assert "100% infill, for weight and strength are those of solid parts" in page
    assert "Four walls and 30% infill take less time, and do where little is carried." in page
    parts = [
        {"name": name, "sparse_infill": name in ("cam", "panel")}
        for name in ("cam", "link", "panel")
    ]
    page = to_html(replace(solid(), numbers=Figures(solid_parts), parts=parts))
    assert "do for parts cam and panel, wide and still; print the others solid." in page
    assert "Settings" not in to_html(replace(solid(), numbers=Figures(figures[:3])))


def test_parts_with_overhangs_get_supports_and_slim_ones_a_brim() -> None:
    """A post of 6 x 6 mm is tall at 19 mm and not at 18; a bar that lies on its side is not as high as it is thick."""
    columns = ("how", "part", "what", "count", "lies", "on the bed, mm^2", "overhang, mm^2")
    rows: list[tuple[object, ...]] = [
        ("printed", "post", "", 8, "as drawn", 36.0, 0.0),
        ("printed", "short-post", "", 8, "as drawn", 36.0, 0.0),
        ("printed", "bar", "", 1, "on its side towards +x", 36.0, 3.0),
        ("printed", "cover", "", 1, "turned over", 900.0, 12.0),
        ("bought", "pin", "", 1, "", "", ""),
    ]
    heights = {"cam": 9.0, "post": 19.0, "short-post": 18.0, "bar": 60.0, "cover": 5.0}
    parts = [{"name": name, "thickness_mm": height} for name, height in heights.items()]
    table = Table("Parts list", columns, rows, shopping=True)
    page = to_html(replace(solid(), parts=parts, tables=[table]))
    supports = "Supports under parts bar and cover alone."
    assert f"{supports} A brim of 1 mm round part post, tall on a small foot." in page
    table = Table("Parts list", columns, rows[1:2], shopping=True)
    page = to_html(replace(solid(), parts=parts, tables=[table]))
    assert "No supports." in page and "brim" not in page
    assert "upports" not in to_html(solid())


def test_a_plate_says_how_large_it_is(page: str) -> None:
    assert "1 copy; 120 × 30 × 9 mm high" in page


def test_a_report_without_solids_is_as_small_as_ever() -> None:
    plain = to_html(made_up())
    assert len(plain) < 60_000 and 'id="three"' not in plain and "<canvas" not in plain
    nothing = Page(to_html(Report("a", "b", [at_most("A", 1, 2, "", Where(), "")])))
    assert not any(tag in ("svg", "canvas", "button") for tag, _ in nothing.elements)


def test_parts_plates_and_steps_have_their_files_and_their_views(page: str) -> None:
    parsed = Page(page)
    views = [
        attributes["data-view"]
        for tag, attributes in parsed.elements
        if tag == "canvas" and "data-view" in attributes
    ]
    assert views == ["part-0", "plate-0", "step-0", "step-1", "step-3"], (
        "for a bought nut nothing is drawn"
    )
    links = [attributes["href"] for tag, attributes in parsed.elements if tag == "a"]
    assert {"demo-cam.dxf", "demo-cam-drawing.pdf", "demo-plate.3mf", "demo-assembly.glb"} <= set(
        links
    )
    assert links.count("demo-cam-drawing.pdf") == 1 and EVIL not in page
    more = replace(solid(), files=["demo-cam-drawing.pdf", "demo-cam-tracks-drawing.pdf"])
    assert "PDF of its tracks" in to_html(more) and "PDF of its tracks" not in page
    sheets = ["demo-assembly-drawing.pdf", "demo-timing-drawing.pdf", "demo-shaft-drawing.pdf"]
    whole = to_html(replace(solid(), files=sheets))
    assert all(whole.count(f'href="{sheet}"') == 1 for sheet in sheets)
    assert "arrangement drawing" in whole and "arrangement drawing" not in page


@pytest.mark.parametrize(
    ("count", "said"),
    [
        (1, "Print this plate: it holds every part, for a bed of 220 × 200 mm."),
        (3, "Print these 3 plates: they hold every part, for a bed of 220 × 200 mm."),
    ],
)
def test_what_to_print_is_told_over_the_plates(count: int, said: str) -> None:
    report = solid()
    assert report.scene is not None
    plates = [
        Plate(f"demo-plate-{k}.3mf", [], (1.0, 1.0, 1.0), (220.0, 200.0)) for k in range(count)
    ]
    text = " ".join(
        Page(to_html(replace(report, scene=replace(report.scene, plates=plates)))).text().split()
    )
    assert said in text and "Take the file of a single part only to print that part again" in text


def test_what_fails_is_said_first_and_what_to_change() -> None:
    report = replace(
        made_up(),
        not_judged=[NotJudged("BED_FIT", "no STL was made", "STL")],
        warnings=["mind the gap"],
    )
    text = Page(to_html(report)).text()
    first = text[: text.index("Curves")]
    for said in (
        "mind the gap",
        "2 of 3 findings fail",
        "MIN_WALL",
        "LASH",
        "NOT JUDGED",
        "no STL was made",
    ):
        assert said in first
    assert "MOTION_ERROR" not in first and "follows" not in first


def test_the_badge_is_short_and_what_is_not_judged_stands_below_it() -> None:
    open_ = [NotJudged(f"CODE_{k}", "no STL was made", "STL") for k in range(20)]
    report = replace(made_up(), not_judged=[*open_, open_[0]])  # one code of two places
    badge = re.search(
        r'<p class="verdict bad">(.*?)</p><p class="unjudged">(.*?)</p>', to_html(report)
    )
    assert badge and badge[1] == "2 of 3 findings fail; 21 not judged"
    assert badge[2] == f"NOT JUDGED: {', '.join(each.code for each in open_)} (need STL)"
    assert "unjudged" not in to_html(made_up()).partition("</header>")[0].partition("<header>")[2]


def test_the_badge_of_what_holds_is_not_green_beside_a_warning() -> None:
    held = [each for each in made_up().findings if each.ok]
    badges = [
        re.findall(
            r'<p class="verdict (\w+)">(.*?)</p>',
            to_html(replace(made_up(), findings=held, warnings=said)),
        )
        for said in ((), ("Mind the gap.",), ("Mind the gap.", "Mind the step."))
    ]
    assert badges == [
        [("ok", "The one finding holds")],
        [("open", "The one finding holds; 1 warning")],
        [("open", "The one finding holds; 2 warnings")],
    ]


def test_the_list_of_parts_says_how_many_there_are() -> None:
    (summary,) = re.findall(
        r'<details class="legend" open><summary>(.*?)</summary>', to_html(solid())
    )
    assert (
        summary == "View and 1 part"
    )  # the cam; the follower is drawn as lines, for it is not made


def test_what_is_only_not_judged_is_amber_and_a_page_of_no_checks_is_no_success() -> None:
    def verdict(report: Report) -> list[str | None]:
        seen = [attributes.get("class") or "" for _, attributes in Page(to_html(report)).elements]
        return [each for each in seen if each.split()[:1] == ["verdict"] or each in ("bad", "open")]

    holds, fails = at_most("A", 1, 2, "", Where(), ""), at_most("B", 3, 2, "", Where(), "")
    left = [NotJudged("BED_FIT", "no STL was made", "STL")]
    assert verdict(Report("a", "b", [holds], not_judged=left)) == ["verdict open", "open"]
    assert verdict(Report("a", "b", [fails, holds], not_judged=left))[:3] == [
        "verdict bad",
        "bad",
        "open",
    ]
    assert verdict(Report("a", "b", [])) == ["verdict "] and verdict(Report("a", "b", [holds])) == [
        "verdict ok"
    ]


def test_step_is_a_kind_of_file_and_estimates_have_three_digits() -> None:
    found = [
        at_most("ERR", 0.3, 1.0, "mm", where, "")
        for where in (Where("hole", "demo-cam.step", "step"), Where("first step"))
    ]
    rows = [("cam", 12.3456, 98.7654)]
    table = Table("Parts", ("part", "mass, g", "time, min"), rows, digits=3)
    report = Report(
        "a", "b", found, Figures([Figure("lash {of}", 0.125, "mm", kind="step")]), tables=[table]
    )
    parsed = Page(to_html(report))
    assert [
        attributes["data-of"]
        for tag, attributes in parsed.elements
        if tag == "td" and attributes.get("data-of")
    ] == ["designed", "STEP", "limit"]
    heads = [text for tag, text in parsed.texts if tag == "th"]
    assert heads.count("STEP") == 2 and "STL" not in heads and "Lash step" not in parsed.text()
    assert all(text in parsed.text() for text in ("12.3", "98.8")) and "12.34" not in parsed.text()


BEYOND = ((3.0, "too wide"), (1.0, "off the bed"))


def test_one_fault_in_all_files_is_one_row() -> None:
    stroke = [
        at_most("STROKE", size, 0.1, "mm", Where(kind, theta=theta), said)
        for kind, size, theta, said in (("design", 0.5, 1.0, "as drawn"), ("dxf", 0.6, 2.0, "cut"))
    ]
    told = worst_of_each(
        [
            *stroke,
            at_most("STROKE", 0.7, 0.2, "mm", Where("stl"), "off by 0.7"),
            at_least("WALL", 1, 2, "", Where("a"), "thin"),
        ]
    )
    assert [(finding.measured, where) for finding, where in told] == [
        (0.6, "worst of 2: design, cam angle 57.296 deg; dxf, cam angle 114.592 deg"),
        (0.7, "stl"),
        (1, "a"),
    ]
    limits = {"dxf": 0.1, "stl": 0.105, "3mf": 0.103}  # as of a motion error
    alike = [at_most("STROKE", 0.6, each, "mm", Where(kind), "") for kind, each in limits.items()]
    assert [(each.limit, where) for each, where in worst_of_each(alike)] == [
        (0.1, "worst of 3: dxf; stl; 3mf")
    ]
    fit = [at_most("BED_FIT", size, 0, "mm", Where(file="a.stl"), said) for size, said in BEYOND]
    assert [finding.message for finding, _ in worst_of_each(fit)] == ["too wide", "off the bed"]
    pen, foot = (
        at_most("STROKE", 2, 1, "mm", Where(file="a.stl", output=name), "")
        for name in ("pen", "foot")
    )
    assert [finding for finding, _ in worst_of_each([pen, foot])] == [pen, foot]


def test_a_fault_of_the_design_is_told_once_though_the_files_have_it() -> None:
    """A file that has more of it than the design is told by itself."""
    design = at_most("UNDERCUT", 3.2, 0, "mm", Where("exact profile"), "")
    same, more = (
        at_most("UNDERCUT", size, 0.02, "mm", Where(file="cam.stl", output=""), "")
        for size in (3.21, 3.9)
    )
    assert worst_of_each([design, same]) == [(design, "exact profile; the files show it too")]
    assert [finding for finding, _ in worst_of_each([design, more])] == [design, more]
    assert [finding for finding, _ in worst_of_each([same])] == [same]


def test_margins_have_one_row_a_check_and_a_column_a_kind() -> None:
    found = [
        at_most(
            "ERR", size, 1.0, "mm", Where(file=f"demo-{part}.{kind}", kind=kind, theta=0.05), part
        )
        for kind, least in (("dxf", 0.1), ("stl", 0.2))
        for part, size in (("cam", least), ("arm", least + 0.5))
    ]
    parsed = Page(
        margins(
            [
                *found,
                at_least("WALL", 0.5, 0.8, "mm", Where("design"), "thin"),
                at_most("X", math.nan, 1, "", Where(), "?"),
            ]
        )
    )
    rows = [attributes.get("class") for tag, attributes in parsed.elements if tag == "tr"]
    assert rows == [None, "bad", "bad", "ok"]
    text = parsed.text().replace("\xa0", " ")
    assert "Design, assembly" in text and "DXF" in text and "STL" in text and "3MF" not in text
    assert (
        "0.6tightest of 2" in text.replace(" tight", "tight")
        and "0.7" in text
        and "0.1" not in text
    )
    assert text.index("WALL") < text.index("ERR") and "≥ 0.8" in text and "≤ 1" in text
    pressed = margins(
        [Finding("LIFT_OFF", False, 0.0, 0.0, "N", Where("cam"), "", floor=True, strict=True)]
    )
    assert "> 0 N" in Page(pressed).text().replace("\xa0", " ")


def test_two_checks_of_one_code_have_a_row_each() -> None:
    """A gap and an overlap, and two outputs: what is least tells nothing of the other."""
    text = margins(
        [
            at_least("INTERFERENCE", 0.094, 0.08, "mm", Where("a and b"), "nearest"),
            at_most("INTERFERENCE", 0.001, 0.014, "mm", Where("c and d"), "deepest"),
            at_most("LASH", 0.4, 0.5, "mm", Where(output="pen"), "of the pen"),
            at_most("LASH", 0.1, 0.5, "mm", Where(output="foot"), "of the foot"),
        ]
    )
    rows = [tag for tag, attributes in Page(text).elements if tag == "tr" and attributes]
    assert len(rows) == 4
    assert all(each in text for each in ("nearest", "deepest", "of the pen", "of the foot"))


def test_routine_margins_are_folded_and_counted() -> None:
    near, far = (
        at_most("NEAR", 0.9, 1, "mm", Where(file="a.dxf", kind="dxf"), ""),
        [at_most(f"FAR_{k}", 0.1, 1, "mm", Where(file="a.dxf", kind="dxf"), "") for k in range(3)],
    )
    text = margins([*far, near, near])
    assert (
        text.index("NEAR") < text.index("<details>") < text.index("FAR_0")
        and "3 more findings of 3 kinds hold" in text
    )
    assert "3 findings of 3 kinds hold" in margins(far)


def test_a_share_is_read_in_percent_and_one_is_no_plural() -> None:
    where = Where(file="a.dxf", kind="dxf")
    ripple = at_most("SPEED_RIPPLE", 7.642e-4, 0.01, "share", where, "of the greatest speed")
    changed = at_most("MANIFEST", 1, 0, "files", Where(), "changed: a.dxf")
    text = re.sub("<[^>]+>", "", margins([ripple, changed]))
    assert "0.07642" in text and "≤&nbsp;1 %" in text and "share" not in text
    assert "0.07642 <= 1 %" in str(ripple) and "not 1 <= 0 files" in str(changed)
    assert as_read(1, "files") == (1, "file") and as_read(1, "mm") == (1, "mm")


def test_squares_and_cubes_are_raised_in_units_and_messages() -> None:
    message = "18.0 mm^3 in the file, of 80 g/m^2"
    text = margins([at_most("VOLUME", 1, 2, "mm^3", Where(file="a.3mf", kind="3mf"), message)])
    assert "^" not in text and "18.0 mm³" in text and "80 g/m²" in text


def test_keys_of_the_pictures_name_what_is_in_them(page: str) -> None:
    """One step glues; nothing is screwed, and nothing turns on a pin."""
    (keys,) = re.findall(r'<p class="glues">(.*?)</p>', page)
    assert re.findall(r'class="(\w+)"', keys) == ["new", "glue"]


@pytest.mark.parametrize(
    "error, said", [(4.765e-7, "4.77·10⁻⁷<"), (0.0, "below 1·10⁻⁹<"), (0.00106, "0.00106<")]
)
def test_a_small_error_in_the_headlines_is_no_bare_0(error: float, said: str) -> None:
    follows = at_most("MOTION_ERROR", error, 0.005, "mm", Where(file="a.dxf", kind="dxf"), "")
    key = to_html(replace(made_up(), findings=[follows])).partition('class="key"')[2]
    assert f"<dd>{said}" in key.partition("</dl>")[0].replace(" <small>mm", "<")


def test_what_only_left_out_is_one_line_and_no_rows_of_what_to_change() -> None:
    """A load that is missing is a thing to change; the files that nobody asked for are not."""
    open_ = [NotJudged("BED_FIT", "no STL is there", "STL", absent=True)]
    open_ += [NotJudged("LIFT_OFF", "no load is given", "[load]")]
    page = to_html(replace(made_up(), findings=[], not_judged=open_))
    change = page.partition('class="change"')[2].partition("</table>")[0]
    assert "LIFT_OFF" in change and "BED_FIT" not in change
    assert "BED_FIT (needs STL)" in page


def test_no_curve_is_shown_twice() -> None:
    x = np.linspace(0, 360, 1441)
    lift = Plot("Lift", "cam angle, deg", "mm", [("wanted", x, np.sin(np.radians(x)))])
    again = Plot(
        "Displacement",
        "cam angle, deg",
        "mm",
        [("wanted", x[::2], np.sin(np.radians(x[::2])))],
        [("rise", 0.0)],
    )
    faster = replace(again, title="Velocity", y_label="mm/s")
    other = replace(again, title="Other", series=[("wanted", x, np.cos(np.radians(x)))])
    noise = replace(other, title="Noise", series=[("error", x, 1e-33 * np.sin(x))])
    kept = once([noise, lift, again, faster, other])
    assert [plot.title for plot in kept] == ["Lift", "Velocity", "Other"] and kept[0].marks == [
        ("rise", 0.0)
    ]


def test_what_does_not_move_has_no_controls() -> None:
    """A coupon's bodies rest: neither a button to play nor an angle; what moves has both."""
    still, away = (
        PartPose(np.zeros(1, complex), np.zeros(1)),
        PartPose(np.array([0j, 1 + 0j]), np.zeros(2)),
    )
    ring = [(np.array([0, 1, 1j]), np.zeros(3))]
    pages = [player(Animation(np.zeros(2), [Body("a", [pose], ring)])) for pose in (still, away)]
    assert ['<div class="controls" hidden>' in page for page in pages] == [True, False]


def test_what_is_built_apart_is_told_to_the_view() -> None:
    report = solid()
    assert report.scene is not None
    steps = [
        Step([Doing("near")], ["cam-1"]),
        Step([Doing("far")], ["cam-2"], apart="far", up=(0.0, 0.0, -1.0)),
        Step([Doing("on")], joins="far"),
    ]
    page = to_html(replace(report, scene=replace(report.scene, steps=steps)))
    said = json.loads(script(page, "lying"))["steps"]
    assert [step.get("apart", "") for step in said] == ["", "far", ""]
    assert [step.get("joins", "") for step in said] == ["", "", "far"]
    assert said[1]["up"] == [0.0, 0.0, -1.0]
    views = re.findall(r'data-view="([^"]*)"', page)
    assert [view for view in views if view.startswith("step-")] == ["step-0", "step-1", "step-2"]


def test_what_a_maker_looks_for_first_is_linked_at_the_top() -> None:
    rows = [
        ("printed", "cam", "Cam", 1, 2.0),
        ("bought", "screw", "M3 x 6", 4, ""),
        ("bought", "oil", "a drop", 1, ""),
        ("tool", "saw", "for rods", 1, ""),
        ("tool", "block", "as high", 2, ""),
    ]
    columns = ("how", "part", "what", "count", "material, mm^3")
    report = replace(solid(), tables=[Table("Parts list", columns, rows, shopping=True)])
    page = to_html(report)
    links = re.findall(r'<a href="#to-(\w+)">([^<]*)</a>', page.partition("</nav>")[0])
    assert ("shopping", "What to buy") in links and ("plates", "What to print") in links
    assert all(page.count(f'id="to-{kind}"') == 1 for kind, _ in links)
    bought = page.partition('id="to-shopping"')[2].partition("</section>")[0]
    assert "M3 x 6" in bought and "oil" in bought and "material" not in bought
    assert "cam" not in bought and "saw" not in bought, "tools have a list of their own"
    tools = page.partition("<h2>Tools</h2>")[2].partition("</section>")[0]
    cells = re.findall(r"<t[dh][^>]*>([^<]*)</t[dh]>", tools)
    assert cells == ["part", "what", "count", "saw", "for rods", "", "block", "as high", "2"]
    assert "What to buy" not in to_html(solid()), "where no list is there"


def test_cards_and_plates_say_what_they_take_and_what_is_not_printed() -> None:
    """Of two copies in the list half is one card's; what is bought or cut of a rod has no file for a slicer."""
    columns = ("how", "part", "what", "count", "mass in PLA, g", "print time, min")
    printed = ("printed", "cam", "Cam", 2, 24.0, 180.0)
    bought = ("bought", "cam", "Cam", 2, "", "")
    steel = ("turned of steel", "cam", "Cam: rod 3 h9 x 8", 2, "", "")
    rod = ("stock", "steel rod 3 h9", "8 mm", 1, "", "")
    part = {"name": "cam", "count": 2, "files": ["demo-cam.dxf", "demo-cam.stl", "demo-cam.3mf"]}
    pages = [
        to_html(
            replace(
                solid(), parts=[part], tables=[Table("Parts list", columns, rows, shopping=True)]
            )
        )
        for rows in ([printed], [bought], [steel, rod])
    ]
    assert all(page.count("demo-cam.dxf") >= 1 for page in pages)
    assert [page.count("STL</a>") for page in pages] == [1, 0, 0]
    assert "12 g, 1.5 h" in pages[0] and "1 copy; about 12 g, 1.5 h" in pages[0]
    assert pages[2].count("here cut from the rod and filed") == 3, "in the lists and on the card"
    assert pages[2].count("turned of steel") == 3, "one word for one part on a page"
    assert "about 12 g of PLA" in pages[0] and "g of PLA" not in pages[1]
    assert not any("1 copy; about" in page for page in pages[1:])


def test_what_is_cut_from_a_rod_of_the_list_is_said_to_be_cut_and_filed() -> None:
    """A pin with a head, for which no rod is listed, is turned."""
    rows = [
        ("turned of steel", "shaft", "Shaft: rod 3 h9 x 82.2, a flat 0.5 deep all along", 1, ""),
        ("turned of steel", "pin", "Pin 1: head 6 x 2 on a shank 4 x 9", 1, ""),
        ("turned of steel", "axle", "Axle: rod 3 h9 x 20, keyway 1 wide all along", 1, ""),
        ("stock", "steel rod 3 h9", "82.2 mm without saw cuts", 1, ""),
    ]
    columns = ("how", "part", "what", "count", "material, mm^3")
    page = to_html(replace(solid(), tables=[Table("Parts list", columns, rows, shopping=True)]))
    bought = page.partition('id="to-shopping"')[2].partition("</section>")[0]
    ways = r"<th scope=\"row\">([^<]*)</th>.*?(shaft|pin|axle)<"
    made = dict(re.findall(ways, bought, re.DOTALL))
    assert made == {
        "turned of steel: here cut from the rod and filed": "shaft",
        "turned of steel": "pin",
        "turned of steel: here cut from the rod and milled": "axle",
    }


def test_a_step_tells_the_view_what_lies_side_by_side_and_whence_things_come() -> None:
    report = solid()
    assert report.scene is not None
    glue = Mate("glue", "A", (1.0, -0.0, 2.0), 3.0, 4.0)
    first = Step([Doing("press")], laid=[("cam", ["cam-1", "cam-2"], [glue])])
    steps = [first, Step([Doing("on")], ["cam-1"], along=(0.0, 1.0, 0.0))]
    page = to_html(replace(report, scene=replace(report.scene, steps=steps)))
    said = json.loads(script(page, "lying"))["steps"]
    ((name, copies, mates),) = said[0]["laid"]
    assert (name, copies) == ("cam", [0, 1]) and mates[0]["place"] == [1.0, 0.0, 2.0]
    assert said[1]["along"] == [0.0, 1.0, 0.0] and "along" not in said[0]
    views = re.findall(r'data-view="([^"]*)"', page)
    assert [view for view in views if view.startswith("step-")] == ["step-0", "step-1"]
