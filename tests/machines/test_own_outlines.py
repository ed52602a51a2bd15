"""A link whose outline is a person's drawing: made, judged as any part, and refused in words where it is no plate for its joints."""

from __future__ import annotations

import csv
import json
import math
import tomllib
from pathlib import Path
from typing import Any

import ezdxf
import numpy as np
import pytest
import shapely

import camgen
from camgen.errors import CamgenError, DesignError
from camgen.geometry.chains import joined
from camgen.geometry.svg_curves import curves

WING = "M 64 6 L 76 6 L 78 -20 L 70 -30 L 92 -62 L 48 -58 L 46 -36 L 60 -10 Z"
CORNERS = [(64, -6), (76, -6), (78, 20), (70, 30), (92, 62), (48, 58), (46, 36), (60, 10)]
EYE = ((62, 45), 3.0)
DENSITY = 1.24e-3  # g/mm^3, PLA


def svg(body: str, head: str = 'width="80mm" height="80mm" viewBox="30 -70 80 80"') -> str:
    return f'<svg xmlns="http://www.w3.org/2000/svg" {head}>{body}</svg>'


SVG = svg(f'<path d="{WING}"/><circle cx="62" cy="-45" r="3"/>')


def spec(file: str = "wing.svg", **more: Any) -> dict[str, Any]:
    return {
        "mechanism": "linkage",
        "name": "bird",
        "points": {"O": [0, 0], "C": [70, 0], "A": [20, 0], "B": [55, 48]},
        "links": {
            "ground": ["O", "C"],
            "crank": ["O", "A"],
            "coupler": ["A", "B"],
            "rocker": ["C", "B"],
        },
        "drive": {"link": "crank", "speed_rpm": 60},
        "output": [{"name": "swing", "link": "rocker"}],
        "parts": {"rocker": {"outline": file, **more}},
    }


@pytest.fixture
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "wing.svg").write_text(SVG)
    return tmp_path


def write_dxf(path: Path, unit: int = 4, scale: float = 1.0) -> None:
    drawing = ezdxf.new()
    drawing.header["$INSUNITS"] = unit
    space = drawing.modelspace()
    corners = [(x * scale, y * scale) for x, y in CORNERS]
    for a, b in zip(corners, corners[1:] + corners[:1], strict=True):
        space.add_line(a, b)
    (x, y), radius = EYE
    space.add_circle((x * scale, y * scale), radius * scale)
    drawing.saveas(path)


@pytest.mark.long
def test_a_wing_is_built_checked_and_built_again_alike(here: Path) -> None:
    report = camgen.build(spec(), here / "out", only=["dxf", "stl", "3mf"])
    assert report.ok
    assert any(f.code == "INTERFERENCE" for f in report.findings)
    folder = here / "out" / "bird"
    rows = csv.DictReader((folder / "bird-parts.csv").read_text().splitlines())
    (row,) = [row for row in rows if row["part"] == "rocker"]
    eyes = 2.6**2 + 2.5**2 + EYE[1] ** 2  # running and pressed holes, and the drawing's own
    area = shapely.Polygon(CORNERS).area - math.pi * eyes
    assert float(row["mass in PLA, g"]) == pytest.approx(4 * area * DENSITY, rel=1e-2)
    (here / "wing.svg").unlink()
    assert camgen.check(folder).ok
    again = camgen.build(folder / "spec.toml", here / "again", only=["dxf", "stl", "3mf"])
    assert again.ok
    names = json.loads((folder / "manifest.json").read_text())["files"]
    other = json.loads((here / "again" / "bird" / "manifest.json").read_text())["files"]
    assert names == other


@pytest.mark.parametrize("kind", ["svg", "dxf", "inches"])
def test_area_and_mass_are_those_of_the_drawing_less_its_holes(here: Path, kind: str) -> None:
    file = "wing.svg" if kind == "svg" else "wing.dxf"
    write_dxf(here / "wing.dxf", *((1, 1 / 25.4) if kind == "inches" else ()))
    machine = camgen.load(spec(file))
    part = next(part for part in machine.assembly.parts if part.name == "rocker")
    (layer,) = part.layers
    radii = sorted(math.sqrt(hole.area / math.pi) for hole in layer.region.holes)
    wing = shapely.Polygon(CORNERS).area
    area = wing - math.pi * sum(radius**2 for radius in radii)
    assert len(radii) == 3 and max(radii) == pytest.approx(EYE[1])
    assert layer.region.area == pytest.approx(area, rel=1e-9)
    assert part.volume == pytest.approx(4 * area, rel=1e-9)


def test_the_machine_makes_the_hole_that_a_person_drew_for_a_joint(here: Path) -> None:
    (here / "wing.svg").write_text(SVG.replace("</svg>", '<circle cx="70" cy="0" r="1"/></svg>'))
    part = next(p for p in camgen.load(spec()).assembly.parts if p.name == "rocker")
    assert len(part.layers[0].region.holes) == 3


def test_the_drawing_may_have_another_origin(here: Path) -> None:
    moved = svg(f'<g transform="translate(-70, 20)"><path d="{WING}"/></g>')
    (here / "moved.svg").write_text(moved)
    machine = camgen.load(spec("moved.svg", outline_at=[70, 20]))
    part = next(p for p in machine.assembly.parts if p.name == "rocker")
    pose = machine.model.start_of("rocker")
    outer = part.layers[0].region.outer.moved(np.exp(1j * pose.angle), pose.place)
    assert outer.centroid == pytest.approx(complex(*shapely.Polygon(CORNERS).centroid.coords[0]))


def nodding(**cam: Any) -> dict[str, Any]:
    """A cam's follower with an outline, in the coordinates of its points."""
    lift = {"span_deg": 180, "lift_deg": 20}
    back = {"span_deg": 180, "to_deg": 0}
    segments = [{"kind": "rise", **lift}, {"kind": "return", **back}]
    return spec() | {
        "points": {"O": [40, 0], "C": [70, 0], "B": [55, 48]},
        "links": {"ground": ["O", "C"], "shaft": ["O"], "rocker": ["C", "B"]},
        "drive": {"link": "shaft", "speed_rpm": 60},
        "cam": [{"cam": "shaft", "follower": "rocker", "at": "B", "radius": 5, "segment": segments, **cam}],
    }  # fmt: skip


@pytest.mark.parametrize("base", [None, 30, 60])
def test_an_outline_turns_with_the_link_that_a_base_radius_turns(
    here: Path, base: float | None
) -> None:
    machine = camgen.load(nodding() if base is None else nodding(base_radius=base))
    part = next(p for p in machine.assembly.parts if p.name == "rocker")
    outer = part.layers[0].region.outer
    centre = complex(*shapely.Polygon(CORNERS).centroid.coords[0])
    pivot, tip = 70 + 0j, 55 + 48j
    assert outer.centroid == pytest.approx((centre - pivot) / (tip - pivot) * abs(tip - pivot))


@pytest.mark.long
def test_a_note_tells_how_far_a_base_radius_turns_a_link_from_where_it_is_drawn(
    here: Path,
) -> None:
    machine = camgen.load(nodding(base_radius=30))
    turn = math.degrees(machine.model.start_of("rocker").angle - math.atan2(48, -15))
    assert turn > 10
    (said,) = machine.remarks().warnings
    assert said == (
        f"rocker stands {turn:.3g} deg counter-clockwise from where it is drawn: cam.0.base_radius = 30 turns it; it "
        "stands as drawn without base_radius"
    )
    report = camgen.build(nodding(base_radius=30), here / "out", only=["dxf"])
    assert said in report.warnings
    assert not camgen.load(nodding()).remarks().warnings
    # base radius as drawn: from the shaft to the roller's centre, less its radius
    as_drawn = abs(55 + 48j - 40) - 5
    assert not camgen.load(nodding(base_radius=as_drawn)).remarks().warnings


@pytest.mark.parametrize(
    "edge, wall",
    [("L 74 6 L 74 -20", 1.4), ("L 60 6 L 60 -20", -12.6)],
)
def test_a_hole_too_near_or_outside_is_named_with_its_wall(
    here: Path, edge: str, wall: float
) -> None:
    path = "M 56 6 " + edge + " L 92 -62 L 48 -58 L 46 -36 Z"
    (here / "wing.svg").write_text(svg(f'<path d="{path}"/>'))
    limits = {"min_wall": 1.5}
    with pytest.raises(DesignError, match="hole C") as refused:
        assert camgen.load(spec() | {"limits": limits}).assembly.parts
    assert refused.value.value == pytest.approx(wall, abs=0.02)


def test_an_outline_beside_its_holes_says_what_may_be_wrong(here: Path) -> None:
    upside_down = f'<path transform="scale(1 -1)" d="{WING}"/>'
    (here / "wing.svg").write_text(
        svg(upside_down, 'width="80mm" height="80mm" viewBox="30 0 80 80"')
    )
    with pytest.raises(
        DesignError, match=r"lies outside the outline: see parts\.rocker\.outline_at"
    ) as refused:
        assert camgen.load(spec()).assembly.parts
    assert "y points up" in str(refused.value)


@pytest.mark.long
def test_levels_give_way_to_what_the_outline_sweeps(here: Path) -> None:
    band = camgen.load(spec() | {"parts": {}, "layers": {"crank": 1, "rocker": 1}})
    assert band.assembly.parts
    (here / "wing.svg").write_text(svg('<path d="M 80 8 V -62 H 40 L 10 0 L 40 8 z"/>'))
    with pytest.raises(DesignError, match="crank"):
        assert camgen.load(spec() | {"layers": {"crank": 1, "rocker": 1}}).assembly.parts


@pytest.mark.parametrize(
    "text, words",
    [
        (SVG.replace(" Z", ""), "open line"),
        (svg('<path d="M 0 0 L 90 90 L 90 0 L 0 60 Z"/>'), "meets itself"),
        (SVG.replace('width="80mm" height="80mm"', 'width="80"'), "names no unit"),
        (SVG.replace("80mm", "800in"), "mm across, not 1 to"),
        (SVG.replace('"/><circle', ""), "not a valid SVG"),
        ("<html/>", "begins with <html>"),
        (svg("<text>A</text>"), "no closed contour .*text"),
        (SVG.replace("L 92", "L nine"), "numbers were expected"),
        (svg('<g transform="spin(3)"/>'), "transform that is not read"),
        (SVG.replace("</svg>", '<circle cx="0" cy="0" r="2"/></svg>'), "not within"),
        (svg('<circle r="1e300"/>'), "is the unit wrong"),
        (SVG + " " * 10_000_001, "at most 10 MB"),
    ],
)
def test_a_file_that_is_no_outline_is_refused_in_words(here: Path, text: str, words: str) -> None:
    (here / "wing.svg").write_text(text)
    with pytest.raises(CamgenError, match=words):
        camgen.load(spec())


def test_another_file_takes_the_place_of_what_was_read(here: Path) -> None:
    machine = camgen.load(spec())
    (here / "plain.svg").write_text(svg(f'<path d="{WING}"/>'))
    parts = machine.replace({"parts.rocker.outline": "plain.svg"}).assembly.parts
    part = next(part for part in parts if part.name == "rocker")
    assert len(part.layers[0].region.holes) == 2


def test_other_files_and_keys_beside_an_outline_are_refused(here: Path) -> None:
    write_dxf(here / "wing.dxf", unit=99)
    with pytest.raises(CamgenError, match="unit number 99"):
        camgen.load(spec("wing.dxf"))
    with pytest.raises(CamgenError, match="svg or .dxf"):
        camgen.load(spec("wing.png"))
    with pytest.raises(CamgenError, match="hub_diameter"):
        camgen.load(spec(hub_diameter=12.0))
    line = [[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.5, 0.0, 0.0]]]
    with pytest.raises(CamgenError, match="round an area"):
        camgen.load(spec() | {"parts": {"rocker": {"contours": line}}})
    with pytest.raises(CamgenError, match="cannot be read"):
        camgen.load(spec("eagle.svg"))


# Areas by formulas of plane geometry; y goes up, so that what an SVG turns clockwise is turned counter-clockwise.
@pytest.mark.parametrize(
    "body, area, box",
    [
        ('<circle cx="10" cy="20" r="5"/>', 25 * math.pi, (5, -25, 15, -15)),
        ('<ellipse cx="10" cy="20" rx="5" ry="3"/>', 15 * math.pi, (5, -23, 15, -17)),
        ('<rect x="1" y="2" width="10" height="6" rx="2"/>', 60 - 4 * (4 - math.pi), (1, -8, 11, -2)),
        ('<path d="M0,0 a5 5 0 0 1 10,0 A5 5 0 01 0 0"/>', 25 * math.pi, (0, -5, 10, 5)),
        # three quarters of a disc and the triangle of its chord
        ('<path d="M0,0A5 5 0 1 0 5,5z"/>', 25 * (0.75 * math.pi + 0.5), (-5, -10, 5, 0)),
        ('<path d="M0 0A5 3 90 0 1 6 0A5 3 90 0 1 0 0"/>', 15 * math.pi, (0, -5, 6, 5)),
        # a parabola over its chord: two thirds of 10 x 5
        ('<path d="M0 0Q5 -10 10 0z"/>', 100 / 3, (0, 0, 10, 5)),
        ('<path d="m0 0q5-10 10 0t10 0H0"/>', 200 / 3, None),
        # integral of 12 t (1 - t) d(18 t^2 - 12 t^3)
        ('<path d="M0 0C0-4 6-4 6 0z"/>', 432 / 30, None),
        ('<g transform="translate(3 4) scale(2)"><path d="M0 0h1v-1h-1z"/></g>', 4, (3, -4, 5, -2)),
        ('<g transform="rotate(90 1 1)"><path d="M1 1h2v1h-2z"/></g>', 2, (0, -3, 1, -1)),
        ('<polygon points="0,0 4,0 4,3" transform="skewX(45)"/>', 6, (0, -3, 7, 0)),
    ],
)  # fmt: skip
def test_curves_of_an_svg(body: str, area: float, box: tuple[float, ...] | None) -> None:
    text = svg(body, 'width="100mm" viewBox="0 0 100 100"')
    chains, _ = curves(Path("x.svg"), text.encode(), 1e-4)
    rings, loose = joined(chains)
    assert not loose
    if "t10" in body:  # two lobes, of either sign
        assert rings[0].area == pytest.approx(0, abs=1e-2)
        return
    assert abs(rings[0].area) == pytest.approx(area, rel=1e-4)
    if box:
        assert rings[0].box == pytest.approx(box, abs=2e-4)


def test_the_guide_shows_the_keys_of_an_outline() -> None:
    from camgen import guide

    text = (Path(guide.__file__).parent / "own-linkage.md").read_text()
    block = text.partition("## An outline of your own")[2].partition("```toml\n")[2]
    tables = tomllib.loads(block.partition("```")[0])
    assert tables == {"parts": {"rocker": {"outline": "wing.svg", "outline_at": [0, 0]}}}
