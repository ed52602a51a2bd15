"""Letters of holes and texts in parts: where they stand, what their glyphs are, and that files which lack them are found."""

from __future__ import annotations

import shutil
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import shapely
from PIL import Image, ImageDraw, ImageFont

import camgen
from camgen import starters
from camgen.errors import DesignError
from camgen.files.dxf import read_dxf
from camgen.geometry.facets import facet_contour
from camgen.geometry.outlines import Contour, Region, circle, rectangle
from camgen.geometry.rings import Ring
from camgen.judge.round_trip import pieces_of
from camgen.parts.engraving import DEPTH, engraved
from camgen.parts.part import Layer, Part
from camgen.parts.solids import solid

HOLES = {"O": 0j, "A": 40 + 0j, "B8": 20 + 12j}


def plate(thickness: float = 3.0, name: str = "bar") -> Part:
    holes = tuple(circle(z, 2.0) for z in HOLES.values())
    region = Region(rectangle(-12 - 12j, 52 + 24j), holes)
    return Part(name, "Bar", (Layer(region, 0, thickness),), points=tuple(HOLES.items()))


def shape(contour: Contour) -> shapely.Polygon:
    ring = facet_contour(contour, 1e-3)
    return shapely.Polygon(np.column_stack([ring.real, ring.imag]))


def test_each_letter_stands_beside_its_own_hole_clear_of_all_others_and_of_the_edge() -> None:
    part = engraved(plate(), letters=True)
    assert {(layer.z0, layer.z1) for layer in part.engraved} == {(3 - DEPTH, 3)}
    holes = [shape(hole) for hole in part.region.holes]
    glyphs = [shape(layer.region.outer) for layer in part.engraved]
    assert len(glyphs) == 4, "O, A, B, 8"
    near = [min(range(3), key=lambda k: glyph.distance(holes[k])) for glyph in glyphs]
    assert sorted(near) == [0, 1, 2, 2]
    for glyph in glyphs:
        assert min(glyph.distance(hole) for hole in holes) > 0.8 - 0.03
        assert shape(part.region.outer).exterior.distance(glyph) > 0.8 - 0.03
    assert sorted(len(layer.region.holes) for layer in part.engraved) == [1, 1, 2, 2], "islands"
    assert solid(part, 1e-3).volume == pytest.approx(part.volume, rel=1e-5)
    assert part.volume < plate().volume


def test_glyphs_are_those_that_another_renderer_draws() -> None:
    """The share of its box that a text's ink takes, by the rasterizer of Pillow from the same font."""
    import matplotlib

    font = Path(matplotlib.get_data_path()) / "fonts" / "ttf" / "DejaVuSans-Bold.ttf"
    for text in ("A", "B8", "Klann 2: (&) 60"):
        part = engraved(plate(), False, text, "parts.bar.engrave")
        ink = sum(layer.region.area for layer in part.engraved)
        whole = shapely.unary_union([shape(layer.region.outer) for layer in part.engraved])
        drawn = ImageFont.truetype(str(font), 400)
        image = Image.new("L", (400 * len(text), 800))
        ImageDraw.Draw(image).text((100, 100), text, fill=255, font=drawn)
        dark = np.asarray(image.crop(image.getbbox()), float).mean() / 255
        box = whole.envelope.area  # it is read along the line from O to A
        assert ink / box == pytest.approx(dark, rel=0.03), text


def test_a_text_without_room_and_a_thin_part_are_refused_by_the_key() -> None:
    with pytest.raises(DesignError, match=r"shorten parts\.bar\.engrave"):
        engraved(plate(), False, "a text that is much too long for the bar", "parts.bar.engrave")
    with pytest.raises(DesignError, match=r"parts\.bar\.engrave needs a thicker part"):
        engraved(plate(1.0), False, "x", "parts.bar.engrave")
    assert engraved(plate(1.0), letters=True) == plate(1.0)


def test_a_letter_without_room_is_told() -> None:
    hole = circle(0, 2.0)
    ring = Part("ring", "Ring", (Layer(Region(circle(0, 4), (hole,)), 0, 3),), points=(("O", 0j),))
    tried = engraved(ring, letters=True)
    assert not tried.engraved and tried.notes == ("no room to engrave O",)
    assert not tried.lettered
    wide = replace(ring, layers=(Layer(Region(circle(0, 14), (hole,)), 0, 3),))
    assert engraved(wide, letters=True).lettered == {"O"}


def test_an_island_in_a_pocket_is_a_piece_of_its_own() -> None:
    def square(half: float) -> Ring:
        return Ring(half * np.array([-1 - 1j, 1 - 1j, 1 + 1j, -1 + 1j]), np.zeros(4))

    whole, island = pieces_of([square(1), square(9), square(3)])
    assert [len(whole.holes), len(island.holes)] == [1, 0]
    assert (whole.area, island.area) == (pytest.approx(18**2 - 36), pytest.approx(4))


@pytest.fixture(scope="module")
def four_bar(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Path]:
    """The folder of a four-bar with letters and a text, and of the same without."""
    import tomllib

    root = tmp_path_factory.mktemp("engraved")
    tables = tomllib.loads(starters.text("linkage"))
    only = frozenset({"dxf", "stl"})
    plain = camgen.build(tables, root / "plain", only=only)
    tables["files"] = {"hole_letters": True, "engrave": True}
    tables.setdefault("parts", {})["coupler"] = {"engrave": "B 7"}
    made = camgen.build(tables, root / "made", only=only)
    assert plain.ok and made.ok, "the round trip holds with letters"
    return root / "made" / made.name, root / "plain" / plain.name


@pytest.mark.long
def test_letters_are_on_their_layer_and_the_cut_is_as_without(four_bar: tuple[Path, Path]) -> None:
    made, plain = (
        read_dxf(next(folder.rglob("*-coupler.dxf")), engraving=True) for folder in four_bar
    )
    assert len(made.engraved) == 2 + 3 + 2 + 3 + 1, "contours of A, B, P, and of B 7"
    assert not plain.engraved and not made.faults
    for ring, other in zip(made.cut, plain.cut, strict=True):
        np.testing.assert_array_equal(ring.points, other.points)


@pytest.mark.long
@pytest.mark.parametrize("kind, code", [("dxf", "DXF_CLOSED"), ("stl", "ROUND_TRIP")])
def test_a_file_without_its_letters_is_found(
    four_bar: tuple[Path, Path], tmp_path: Path, kind: str, code: str
) -> None:
    made, plain = four_bar
    folder = tmp_path / made.name
    shutil.copytree(made, folder)
    name = f"*-coupler.{kind}"
    shutil.copy(next(plain.rglob(name)), next(folder.rglob(name)))
    failing = {finding.code for finding in camgen.check(folder).findings if not finding.ok}
    assert code in failing
