"""The report's files: strict JSON, exact CSV, a page that stands alone, pictures that show what the data say."""

from __future__ import annotations

import cmath
import json
import math
import re
import subprocess
import sys
from html.parser import HTMLParser
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from still import still_svg

from camgen.errors import FileError
from camgen.findings import Finding, Where, at_least, at_most
from camgen.machine.features import PartPose
from camgen.report.animation import Animation, Body, frames, svg_path
from camgen.report.page import to_html, write_html
from camgen.report.report import Report, to_json, write_csv, write_json
from camgen.report.tables import share_used
from camgen.study import Figure, Figures, Plot, Table

EVIL = '<script>alert("&")</script>'
SVG = "{http://www.w3.org/2000/svg}"


def circle_ring(centre: complex, radius: float) -> tuple[np.ndarray, np.ndarray]:
    return np.array([centre - radius, centre + radius]), np.ones(2)


def made_up(name: str = "demo", count: int = 120) -> Report:
    """A round cam of radius 30, eccentric by 12, under a tip of radius 5 on an arm of 62 about (70, 0)."""
    theta = np.arange(count) * 2 * np.pi / count
    centre = 12 * np.exp(1j * theta)
    reach = np.abs(70 - centre)
    swing = np.angle(centre - 70) - np.arccos((62**2 + reach**2 - 35**2) / (2 * 62 * reach))
    bodies = [
        Body(
            "cam",
            [PartPose(np.array(0j), theta), PartPose(np.array(0j), theta, flipped=True, z=6.0)],
            [circle_ring(12, 30)],
        ),
        Body(
            EVIL,
            [PartPose(np.full(count, 70 + 0j), swing)],
            strokes=[np.array([0, 62 + 0j])],
            circles=[(62 + 0j, 5.0)],
        ),
    ]
    deg = np.degrees(theta)
    return Report(
        name=name,
        mechanism="uniform-swing",
        findings=[
            at_most(
                "MOTION_ERROR",
                9e-4,
                1.7e-3,
                "deg",
                Where(file="demo-cam.stl", kind="stl"),
                "follows",
            ),
            at_least("MIN_WALL", 0.5, 0.8, "mm", Where(EVIL), EVIL),
            at_most("LASH", math.nan, 0.01, "deg", Where("pair"), "cannot be told"),
        ],
        numbers=Figures(
            [
                Figure("peak speed", 0.1 + 0.2, "mm/s"),
                Figure("ratio", math.inf),
                Figure("worst", np.float64("nan"), "deg"),
            ]
        ),
        parts=[
            {
                "name": "cam",
                "count": np.int64(2),
                "material_mm3": 12345.5,
                "files": ["demo-cam.dxf", 'a "b".stl'],
            }
        ],
        plots=[
            Plot(
                "Swing <wanted>",
                "cam angle, deg",
                "swing, $deg$",
                [
                    ("wanted & <asked>", deg, np.degrees(swing)),
                    ("recovered", deg, np.degrees(swing)),
                ],
                [("reversal", 60.0)],
            ),
            Plot(
                "Canvas",
                "place, mm",
                "thickness, mm",
                [("thickness", np.linspace(-9, 9, 50), np.arange(50.0))],
            ),
            Plot(
                "Canvas",
                "place, mm",
                "thickness, mm",
                [("thickness", np.linspace(-9, 9, 50), np.ones(50))],
            ),
        ],
        tables=[Table(EVIL, ["event", EVIL], [[EVIL, 12.5]])],
        notes=[EVIL],
        animation=Animation(theta, bodies, np.degrees(swing), "swing", "deg"),
        budget=Table("Error budget", ["stage", "mm"], [["facets", 1e-3]]),
        files=["spec.toml"],
    )


@pytest.fixture(scope="module")
def page() -> str:
    return to_html(made_up())


class Page(HTMLParser):
    """Elements with attributes, and the text by the tag it stands in; every element must be closed in its order."""

    VOID = {"meta", "input", "br", "link", "img"}

    def __init__(self, text: str) -> None:
        super().__init__()
        self.elements: list[tuple[str, dict[str, str | None]]] = []
        self.texts: list[tuple[str, str]] = []
        self.open: list[str] = []
        self.feed(text)
        self.close()
        assert not self.open

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        assert len(dict(attrs)) == len(attrs), f"attribute given twice in {tag}"
        self.elements.append((tag, dict(attrs)))
        if tag not in self.VOID:
            self.open.append(tag)

    def handle_startendtag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.elements.append((tag, dict(attrs)))

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag

    def handle_data(self, data: str) -> None:
        self.texts.append((self.open[-1] if self.open else "", data))

    def text(self) -> str:
        return "".join(text for tag, text in self.texts if tag not in ("script", "style"))


def test_json_is_strict_and_has_the_contract_s_shape(tmp_path: Path) -> None:
    write_json(tmp_path / "report.json", made_up())
    text = (tmp_path / "report.json").read_text(encoding="utf-8")

    def refuse(word: str) -> None:
        raise AssertionError(f"{word} is no JSON")

    data = json.loads(text, parse_constant=refuse)
    assert list(data)[:8] == [
        "camgen",
        "name",
        "mechanism",
        "ok",
        "findings",
        "not_judged",
        "numbers",
        "parts",
    ]
    assert data["ok"] is False
    keys = ["code", "ok", "measured", "limit", "unit", "where", "message"]
    assert [list(finding) for finding in data["findings"]] == [keys] * 3
    assert data["findings"][2]["measured"] is None and data["findings"][2]["ok"] is False
    assert data["numbers"] == {"peak_speed_mm_s": 0.3, "ratio": None, "worst_deg": None}
    assert "0.30000000000000004" not in text, (
        "12 digits: the last ones differ from processor to processor"
    )
    assert data["parts"][0] == {
        "name": "cam",
        "count": 2,
        "material_mm3": 12345.5,
        "files": ["demo-cam.dxf", 'a "b".stl'],
    }


def test_json_refuses_what_it_cannot_hold() -> None:
    with pytest.raises(TypeError, match="complex"):
        to_json(Report("a", "b", [], parts=[{"name": 1j}]))


def test_verdict_needs_every_finding() -> None:
    good = at_most("A", 1, 2, "mm", Where(), "")
    assert Report("a", "b", [good]).ok
    assert not Report("a", "b", [good, at_most("A", 3, 2, "mm", Where(), "")]).ok


def test_csv_reads_back(tmp_path: Path) -> None:
    path = tmp_path / "motion.csv"
    values = np.array([-0.0, 1e-9, 359.123456789, math.nan, -1e300])
    write_csv(path, {"theta_deg": values, 'recovered, "x"': np.arange(5)})
    text = path.read_bytes().decode()
    assert text.splitlines()[0] == 'theta_deg,"recovered, ""x"""'
    assert text.splitlines()[1:4] == ["0,0", "1e-09,1", "359.123456789,2"]
    back = np.genfromtxt(path, delimiter=",", skip_header=1)
    np.testing.assert_allclose(back[:, 0], values, rtol=1e-11)
    assert "\r" not in text
    with pytest.raises(ValueError):
        write_csv(path, {"a": np.zeros(3), "b": np.zeros(2)})


def test_a_file_that_cannot_be_written_is_a_file_error(tmp_path: Path) -> None:
    for write in (write_json, write_html):
        with pytest.raises(FileError, match="nowhere"):
            write(tmp_path / "nowhere" / "file", Report("a", "b", []))
    with pytest.raises(FileError):
        write_csv(tmp_path, {"a": np.zeros(1)})


def test_page_needs_no_network(page: str) -> None:
    for tag, attributes in Page(page).elements:
        assert tag not in ("link", "img", "iframe", "object", "image", "base")
        for key, value in attributes.items():
            assert key.startswith("xmlns") or "//" not in (value or ""), (tag, key, value)
            if key in ("href", "xlink:href"):
                assert re.fullmatch(r"#[\w-]+|[\w%.-]+", value or "")
        assert not (tag == "script" and "src" in attributes)
    assert set(re.findall(r"https?://[^\"' ]*", page)) <= {
        "http://www.w3.org/2000/svg",
        "http://www.w3.org/1999/xlink",
    }
    assert "@import" not in page and "url(http" not in page


def test_page_shows_every_finding_failed_first(page: str) -> None:
    text = Page(page).text()
    places = [text.index(code) for code in ("MIN_WALL", "LASH", "MOTION_ERROR")]
    assert places == sorted(places)
    assert "2 of 3 findings fail" in text and "160 %" in text and "53 %" in text
    assert "The one finding holds" not in text
    assert "The one finding holds" in to_html(
        Report("a", "b", [at_most("A", 1, 2, "", Where(), "")])
    )


def test_page_escapes_all_text(page: str) -> None:
    parsed = Page(page)
    assert sum(tag == "script" for tag, _ in parsed.elements) == 2
    assert EVIL not in page and parsed.text().count(EVIL) >= 7
    hostile = to_html(
        Report(
            EVIL,
            EVIL,
            [],
            numbers=Figures([Figure("{of}", 1.0, of=EVIL)]),
            files=["javascript:alert(1)", '"><b>'],
        )
    )
    assert EVIL not in hostile
    links = [attributes["href"] for tag, attributes in Page(hostile).elements if tag == "a"]
    assert links == ["javascript%3Aalert%281%29", "%22%3E%3Cb%3E"]


def test_page_is_accessible(page: str) -> None:
    parsed = Page(page)
    ids = [attributes["id"] for _, attributes in parsed.elements if "id" in attributes]
    assert len(ids) == len(set(ids))
    for tag, attributes in parsed.elements:
        if tag == "th":
            assert attributes.get("scope") in ("row", "col")
        if tag == "svg" and attributes.get("aria-hidden") != "true":
            assert attributes["role"] == "img" and set(
                (attributes["aria-labelledby"] or "").split()
            ) <= set(ids)
        for reference in re.findall(
            r"url\(#([^)]+)\)", " ".join(v or "" for v in attributes.values())
        ):
            assert reference in ids
        if (attributes.get("href") or attributes.get("xlink:href") or "").startswith("#"):
            assert (attributes.get("href") or attributes["xlink:href"] or "")[1:] in ids


def test_page_frames_follow_the_poses(page: str) -> None:
    report = made_up()
    assert report.animation is not None
    script = re.search(r'<script type="application/json" id="frames">(.*?)</script>', page)
    assert script is not None
    frames = json.loads(script[1])
    arm = report.animation.bodies[1].poses[0]
    assert frames["frames"] == 120 and frames["flipped"] == [False, True, False]
    np.testing.assert_allclose(
        [row[0] for row in frames["poses"][2]], np.degrees(arm.angle), atol=6e-4
    )
    # The tip touches the round cam in every frame, and so do the frames that the page shows.
    theta = 2 * np.pi * np.arange(120) / 120
    tip = np.array(
        [complex(x, y) + 62 * cmath.exp(1j * math.radians(deg)) for deg, x, y in frames["poses"][2]]
    )
    np.testing.assert_allclose(np.abs(tip - 12 * np.exp(1j * theta)), 35, atol=2e-3)


def test_copies_that_move_alike_are_told_once() -> None:
    theta = np.array([0.0, 2.0, 4.0])
    still, turning = np.zeros(3, complex), PartPose(np.zeros(3, complex), theta)
    bodies = [
        Body("a", [turning]),
        Body("b", [PartPose(still, theta, z=3.0), PartPose(still, -theta)]),
    ]
    poses = frames(Animation(theta, bodies))["poses"]
    turned = [[0, 0, 0], [114.592, 0, 0], [229.183, 0, 0]]
    assert poses == [turned, [[-deg, x, y] for deg, x, y in turned], 0]


def test_pose_without_an_answer_hides_the_body() -> None:
    theta = np.array([0.0, 2.0, 4.0])
    body = Body(
        "arm", [PartPose(np.zeros(3, complex), np.array([math.nan, 1.0, 2.0]))], [circle_ring(0, 5)]
    )
    text = to_html(Report("a", "b", [], animation=Animation(theta, [body])))
    assert 'display="none"' in text and '"poses":[[null,[57.296' in text and "nan" not in text


def test_used_share_of_a_limit() -> None:
    assert share_used(at_most("A", 1, 4, "", Where(), "")) == 0.25
    assert share_used(at_most("A", 8, 4, "", Where(), "")) == 2
    assert share_used(at_least("A", 8, 4, "", Where(), "")) == 0.5
    assert share_used(at_least("A", 2, 4, "", Where(), "")) == 2
    for finding in (
        at_most("A", 0, 0, "", Where(), ""),
        at_most("A", -1, 4, "", Where(), ""),
        Finding("A", False, math.nan, 1, "", Where(), ""),
    ):
        assert share_used(finding) is None


def arc_area(d: str) -> float:
    """Area of a path of M, L, A and Z by chords and circular segments, from the text alone."""
    here = start = 0j
    area = 0.0
    for word, body in re.findall(r"([MLAZ])([^MLAZ]*)", d):
        numbers = [float(text) for text in body.split()]
        there = start if word == "Z" else complex(*numbers[-2:])
        if word == "M":
            start = there
        else:
            area += (here.conjugate() * there).imag / 2
        if word == "A":
            radius, large, sweep = numbers[0], numbers[3], numbers[4]
            angle = 2 * math.asin(min(1.0, abs(there - here) / 2 / radius))
            angle = 2 * math.pi - angle if large else angle
            area += (1 if sweep else -1) * radius**2 * (angle - math.sin(angle)) / 2
        here = there
    return area


@given(st.lists(st.floats(-1.5, 1.5), min_size=3, max_size=12), st.floats(5, 500))
@settings(max_examples=60)
def test_path_has_the_area_of_its_ring(bulges: list[float], size: float) -> None:
    count = len(bulges)
    points = size * np.exp(2j * np.pi * np.arange(count) / count)
    ends = np.roll(points, -1)
    # Finely divided: points of each arc by its bulge, without the arc's radius or its flags.
    sweep = 4 * np.arctan(np.array(bulges))
    share = np.linspace(0, 1, 2000, endpoint=False)[:, None]
    with np.errstate(all="ignore"):
        centre = (points + ends) / 2 + 1j * (ends - points) / (2 * np.tan(sweep / 2))
        fine = centre + (points - centre) * np.exp(1j * sweep * share)
    fine = np.where(
        np.abs(np.array(bulges)) < 1e-4, points + (ends - points) * share, fine
    ).T.ravel()
    wanted = np.sum((np.conj(fine) * np.roll(fine, -1)).imag) / 2
    # Rounding to 0.1 um moves a near semicircle, whose radius hardly tells its height, by up to sqrt(2 radius 1e-4).
    chord = np.abs(ends - points)
    slack = float(np.sum(chord * np.sqrt(3e-4 * chord)))
    assert arc_area(svg_path((points, np.array(bulges)))) == pytest.approx(wanted, abs=slack)


def test_path_of_many_vertices_is_drawn_with_fewer() -> None:
    points = 40 * np.exp(2j * np.pi * np.arange(200_000) / 200_000)
    d = svg_path((points, np.zeros(len(points))))
    assert len(d) < 50_000 and arc_area(d) == pytest.approx(math.pi * 1600, rel=1e-5)


def test_gallery_picture_stands_alone_and_holds_the_mechanism() -> None:
    report = made_up()
    assert report.animation is not None
    picture = still_svg(report.animation, report.name, 30)
    root = ElementTree.fromstring(picture)
    left, top, width, height = map(float, root.attrib["viewBox"].split())
    # Cam: reach 42 all round; arm's pivot at 70 with the tip's upper edge above the axis. Margins are 5 and 13 %.
    assert left < -42 and left + width > 70 and top < -42 and top + height > 42
    assert left > -42 - 0.06 * width and top > -42 - 30
    assert len(root.findall(f".//{SVG}use")) == 3


@pytest.mark.long
def test_same_report_same_bytes() -> None:
    code = (
        "import sys; sys.path[:0] = ['tests', 'tests/report']\n"
        "from test_report import *\n"
        "r = made_up()\n"
        "sys.stdout.write(to_html(r) + to_json(r) + still_svg(r.animation, r.name))"
    )
    runs = [
        subprocess.run(
            [sys.executable, "-c", code],
            capture_output=True,
            check=True,
            cwd=Path(__file__).resolve().parents[2],
            env={
                "PYTHONHASHSEED": seed,
                "PYTHONPATH": ".",
                "PATH": "",
                "HOME": str(Path.home()),
                "PYTHONUTF8": "1",
            },
        ).stdout
        for seed in ("1", "2")
    ]
    assert runs[0] == runs[1] and len(runs[0]) > 10_000


def test_what_changes_its_shape_is_drawn_anew_in_each_frame() -> None:
    ways = np.array([[0, 10 + 0j], [0, 10 + 5j], [0, 10 + 20j]])
    thread = Body("thread", [PartPose(0j, 0.0)], course=ways)  # type: ignore[arg-type]
    picture = Animation(np.zeros(3), [thread])
    stills = [still_svg(picture, "x", k) for k in range(3)]
    assert ["M0 0L10 5" in still for still in stills] == [False, True, False]
    assert frames(picture)["courses"] == {
        "0": [[0.0, 0.0, 10.0, 0.0], [0.0, 0.0, 10.0, 5.0], [0.0, 0.0, 10.0, 20.0]]
    }
    box = [float(value) for value in stills[0].partition('viewBox="')[2].partition('"')[0].split()]
    assert box[1] < -20 < 0 < box[1] + box[3]  # the whole turn has room
