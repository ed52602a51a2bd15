"""Every sheet of every machine against the body that is made, and its words against LibreCAD's font."""

from __future__ import annotations

import math
import re
import tomllib
from dataclasses import dataclass, replace
from functools import reduce
from itertools import pairwise
from pathlib import Path

import ezdxf
import ezdxf.path
import numpy as np
import pytest
import shapely
import shapely.affinity
from ezdxf.layouts import Modelspace

from camgen.files.dimensions import free, holes_of
from camgen.files.drawing import write_drawing
from camgen.files.sheet import LAYERS, Text
from camgen.files.stl import read_stl, write_stl
from camgen.files.title_block import Facts
from camgen.geometry.arcs import as_circle
from camgen.geometry.facets import facet_contour
from camgen.geometry.mesh import Mesh, slice_mesh
from camgen.geometry.outlines import Region, circle, polygon
from camgen.machines.sources import read_mechanism
from camgen.parts.part import Layer, Part
from camgen.parts.solids import solid
from camgen.pipeline import build as pipeline

SPECS = Path(__file__).resolve().parents[2] / "specs"
THE_OTHERS_PARTS = {
    "four-leg-walker",
    "stitch-head",
}  # two legs more, and two machines on one plate
NAMES = sorted({path.stem for path in SPECS.glob("*.toml")} - THE_OTHERS_PARTS)
FACTS = Facts("m", "PLA", 12.3, "ISO 2768-m", "K-104-01", "2026-05-31", (), 10.0)
FACETS = 0.02  # mm, of the solids and of what is read from the sheets
# Widths of LibreCAD's standard.lff in ninths of the height of capitals, each with its letter spacing of 3; the space has 6.75.
CAD_WIDTHS = {
    3.0: "!.:Ii|",
    3.5: ",;",
    4.0: "'l()[]`",
    5.0: "1j{}",
    6.0: "Jcfrt°^",
    6.5: 's"',
    6.75: " ",
    7.0: "02356789abdeghknopquvxyzCEFL-+=/<>~±×",
    7.5: "B",
    8.0: "4DGHKNOPRSTUZ",
    9.0: "mwAMQVXYØ#&*",
    11.0: "W%@",
    14.0: "_",
}
NINTHS = {character: width for width, characters in CAD_WIDTHS.items() for character in characters}


def cad_width(text: str, height: float) -> float:
    plain = text.replace("%%c", "Ø").replace("%%d", "°").replace("%%p", "±")
    return sum(NINTHS[character] for character in plain) / 9 * height


@dataclass(frozen=True)
class Drawn:
    """A part, its sheet read back, and where that is on paper: mm of paper for a mm of the part, corners of the frame."""

    part: Part
    space: Modelspace
    scale: float
    low: complex
    high: complex

    @property
    def texts(self) -> list[ezdxf.entities.Text]:
        """Those of dimensions, which stand in their blocks, too."""
        sizes = [e for size in self.space.query("DIMENSION") for e in size.virtual_entities()]
        return [*self.space.query("TEXT"), *(e for e in sizes if e.dxftype() == "TEXT")]


def drawn(part: Part, folder: Path, tolerance: float = FACETS / 4) -> Drawn:
    # a wheel has no table of radii, as a build says it
    facts = replace(FACTS, profile_step_deg=None) if part.name.startswith("gear-") else FACTS
    path, _ = write_drawing(folder, "x", part, tolerance, facts)
    space = ezdxf.readfile(path).modelspace()
    frames = [
        np.array(e.get_points("xy")) @ [1, 1j]
        for e in space.query("LWPOLYLINE[layer=='TEXT']")
        if len(e) == 4
    ]
    frame = max(frames, key=lambda z: np.ptp(z.real))
    texts = [e.dxf.text for e in space.query("TEXT")]
    wide = {"A4": 297, "A3": 420}[texts[texts.index("Sheet") + 1]] - 30
    low, high = complex(min(frame.real), min(frame.imag)), complex(max(frame.real), max(frame.imag))
    return Drawn(part, space, wide / (high - low).real, low, high)


@pytest.fixture(scope="module", params=NAMES)
def sheets(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> list[Drawn]:
    folder = tmp_path_factory.mktemp(request.param)
    return [
        drawn(part, folder)
        for part in pipeline.read_mechanism(SPECS / f"{request.param}.toml", []).assembly.parts
    ]


# ---- views ------------------------------------------------------------------------------------------------------------


def views(
    sheet: Drawn,
) -> tuple[list[shapely.Polygon], list[shapely.Polygon], list[shapely.Polygon]]:
    """Closed contours of the view along z, of that from the left and of that from above; not those of a detail under the tables."""
    details = [e.dxf.insert.x for e in sheet.texts if re.search(r" \([\d.]+:1\)$", e.dxf.text)]
    found: tuple[list[shapely.Polygon], ...] = ([], [], [])
    boxes = [sheet_box(layer.region) for layer in sheet.part.layers]
    right, low = max(box[2] for box in boxes), min(box[1] for box in boxes)
    for entity in sheet.space.query("LWPOLYLINE CIRCLE"):
        if entity.dxf.layer not in ("CUT", "VIEW", "HIDDEN"):
            continue
        # a path's splines leave a large circle by 3e-4 of its radius
        line = (
            entity if entity.dxftype() == "CIRCLE" else ezdxf.path.make_path(entity)
        ).flattening(5e-4)
        ring = shapely.Polygon([(v.x, v.y) for v in line]).buffer(0)
        if ring.bounds[0] > min(details, default=math.inf):
            continue
        if entity.dxf.layer == "HIDDEN" and ring.area > shapely.box(*ring.bounds).area - 1e-9:
            continue  # a bore
        found[
            1 if ring.bounds[0] > right + 1e-6 else 2 if ring.bounds[3] < low - 1e-6 else 0
        ].append(ring)
    return found  # type: ignore[return-value]


def sheet_box(region: Region) -> tuple[float, float, float, float]:
    z = facet_contour(region.outer, FACETS / 4)
    return float(z.real.min()), float(z.imag.min()), float(z.real.max()), float(z.imag.max())


def shadow(mesh: Mesh, along: int, across: tuple[int, int], sign: int = 1) -> shapely.Geometry:
    """What the body covers, seen along an axis."""
    corners = mesh.vertices[mesh.faces][:, :, across] * (1, sign)
    a, b = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    doubled = a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]
    triangles = shapely.polygons(corners[doubled > 1e-9])
    return filled(
        shapely.union_all(shapely.buffer(triangles, 1e-4, quad_segs=1))
    )  # a hair wider, so that none has gaps


def filled(shape: shapely.Geometry) -> shapely.Geometry:
    pieces = [piece for piece in shapely.get_parts(shape) if piece.area > 0]
    return shapely.union_all([shapely.Polygon(piece.exterior) for piece in pieces])


def unlike(one: shapely.Geometry, two: shapely.Geometry) -> float:
    """Mean distance between two outlines, mm."""
    return one.symmetric_difference(two).area / two.length


def moved_to(shape: shapely.Geometry, like: shapely.Geometry) -> shapely.Geometry:
    (x0, y0, *_), (x1, y1, *_) = shape.bounds, like.bounds
    return shapely.transform(shape, lambda points: points + (x1 - x0, y1 - y0))


def body(part: Part, folder: Path, facets: float = FACETS) -> Mesh:
    write_stl(folder / f"{part.name}.stl", solid(part, facets), part.name)
    return read_stl(folder / f"{part.name}.stl")


@pytest.mark.long
def test_views_are_the_shadows_of_the_body_that_is_made(
    sheets: list[Drawn], tmp_path: Path
) -> None:
    for sheet in sheets:
        # a drum is its blank in the view along z, and cut along its axis with its track
        name, mesh = sheet.part.name, body(replace(sheet.part, drum=None), tmp_path)
        plan, side, above = views(sheet)
        assert unlike(filled(shapely.union_all(plan)), shadow(mesh, 2, (0, 1))) < FACETS, name
        seen = shadow(mesh, 0, (2, 1), 1)
        if any(each.dxf.text == "S-S" for each in sheet.texts) and not above:
            assert_side_is_cut(side, body(sheet.part, tmp_path), name)
            continue
        drawn_side = shapely.transform(filled(shapely.union_all(side)), lambda points: points)
        assert unlike(moved_to(drawn_side, seen), seen) < FACETS, name
        # heights stand beside each other: the view from the left is not moved up or down, the one from above not sideways
        assert drawn_side.bounds[1::2] == pytest.approx(seen.bounds[1::2], abs=FACETS), name
        if sheet.part.side_profile is not None:
            seen = shadow(mesh, 1, (0, 2), -1)
            drawn_above = filled(shapely.union_all(above))
            assert unlike(moved_to(drawn_above, seen), seen) < FACETS, name
            assert drawn_above.bounds[::2] == pytest.approx(seen.bounds[::2], abs=FACETS), name
        else:
            assert_section_is_that_of_the_body(sheet, mesh, above)


def drum(**geometry: object) -> Part:
    """That of the starter, with other keys in its geometry."""
    data = tomllib.loads((SPECS / "cylinder-cam.toml").read_text(encoding="utf-8"))
    data["geometry"] |= geometry
    data["parts"]["pieces"] = 1
    (part,) = read_mechanism(data).assembly.parts
    return part


@pytest.mark.parametrize("geometry", [{}, {"track": "end"}, {"track": "rib", "distance": 16.0}])
def test_a_drum_is_drawn_as_its_blank_and_says_so(
    geometry: dict[str, object], tmp_path: Path
) -> None:
    """The track lies within the blank, which is no larger than the drum, and a file that has it is named."""
    part = drum(**geometry)
    sheet = drawn(part, tmp_path)
    test_views_are_the_shadows_of_the_body_that_is_made([sheet], tmp_path)
    blank = shadow(body(replace(part, drum=None), tmp_path), 0, (2, 1))
    made = shadow(body(part, tmp_path), 0, (2, 1))
    assert made.difference(blank.buffer(FACETS)).is_empty
    assert made.bounds == pytest.approx(blank.bounds, abs=FACETS)
    texts = {text.dxf.text for text in sheet.texts}
    assert "The blank is drawn; its track: x-drum.stl" in texts
    assert not any(text.startswith("Profile:") for text in texts)


def plane_of(sheet: Drawn) -> float | None:
    """The y at which the arrows of a section stand; None where there is none."""
    titles = [
        e.dxf.text
        for e in sheet.texts
        if e.dxf.text[1:2] == "-" and e.dxf.text[:1] == e.dxf.text[2:]
    ]
    marks = [
        e.dxf.align_point.y
        for e in sheet.texts
        if titles and e.dxf.text == titles[0][0] and e.dxf.layer == "TEXT"
    ]
    return marks[0] - 1.2 / sheet.scale if titles else None


def assert_side_is_cut(side: list[shapely.Polygon], mesh: Mesh, name: str) -> None:
    """The view from the left is a cut through the body at x = 0."""
    turned = Mesh(mesh.vertices[:, (2, 1, 0)] * (1, 1, -1), mesh.faces)
    rings = [ring.points for ring in slice_mesh(turned, 1e-4)]
    wanted = reduce(
        shapely.symmetric_difference,
        [shapely.Polygon(np.column_stack([z.real, z.imag])) for z in rings],
    )
    faces = reduce(shapely.symmetric_difference, side)
    assert unlike(moved_to(faces, wanted), wanted) < 2 * FACETS, name
    assert faces.bounds[1::2] == pytest.approx(wanted.bounds[1::2], abs=FACETS), name


def assert_section_is_that_of_the_body(
    sheet: Drawn, mesh: Mesh, faces: list[shapely.Polygon]
) -> None:
    """Cut faces have the area and the places of a cut through the body itself, and only parts with steps have any."""
    y, name = plane_of(sheet), sheet.part.name
    assert (y is not None) == (len(faces) > 0), name
    steps = len({layer.region for layer in sheet.part.layers}) > 1 and any(
        layer.region.holes for layer in sheet.part.layers
    )
    assert y is not None or not steps, name
    if y is None:
        return
    turned = Mesh(mesh.vertices[:, (0, 2, 1)] * (1, 1, -1), mesh.faces)
    rings = [
        shapely.Polygon(np.column_stack([z.real, z.imag]))
        for z in (ring.points for ring in slice_mesh(turned, 1e-4 - y))
    ]
    wanted = reduce(shapely.symmetric_difference, rings)
    drawn_faces = shapely.transform(
        reduce(shapely.symmetric_difference, faces), lambda points: points * (1, -1)
    )
    assert drawn_faces.area == pytest.approx(wanted.area, abs=FACETS * wanted.length), name
    assert unlike(moved_to(drawn_faces, wanted), wanted) < 2 * FACETS, name
    assert drawn_faces.bounds[::2] == pytest.approx(wanted.bounds[::2], abs=FACETS), name


@pytest.mark.long
def test_the_volume_of_a_crossed_body_follows_from_its_views(tmp_path: Path) -> None:
    """Outlines along z and from above that begin at the same x are those of one layer; rounded edges take under 0.5 %."""
    for part in pipeline.read_mechanism(SPECS / "chain-stitch-looper.toml", []).assembly.parts:
        if part.side_profile is None:
            continue
        plan, _, above = views(drawn(part, tmp_path, 5e-4))
        holes = [
            ring
            for ring in plan
            if any(other.contains(ring) and ring.length < 9 for other in plan if other is not ring)
        ]
        pits = [
            ring
            for ring in above
            if any(other.contains(ring) for other in above if other is not ring)
        ]
        total = 0.0
        fronts = [ring for ring in plan if ring not in holes]
        tops = [ring for ring in above if ring not in pits]
        assert len(fronts) == len(tops) == len(part.layers), part.name
        for front in fronts:
            top = min(
                tops,
                key=lambda ring: (
                    abs(ring.bounds[0] - front.bounds[0]) + abs(ring.bounds[2] - front.bounds[2])
                ),
            )
            one = front.difference(
                shapely.union_all([ring for ring in holes if front.contains(ring)])
            )
            two = top.difference(shapely.union_all([ring for ring in pits if top.contains(ring)]))
            x = np.linspace(front.bounds[0], front.bounds[2], 4001)
            x = (x[1:] + x[:-1]) / 2
            lines = shapely.linestrings(
                np.stack([np.repeat(x[:, None], 2, 1), np.tile([-1e3, 1e3], (len(x), 1))], axis=-1)
            )
            chords = [shapely.length(shapely.intersection(shape, lines)) for shape in (one, two)]
            total += float(np.mean(chords[0] * chords[1])) * (front.bounds[2] - front.bounds[0])
        mesh = body(part, tmp_path, 0.001)
        a, b, c = np.moveaxis(mesh.vertices[mesh.faces], 1, 0)
        made = float(np.einsum("ij,ij->", a, np.cross(b, c))) / 6
        assert total == pytest.approx(made, rel=5e-3), part.name


def test_what_lies_behind_material_is_dashed(tmp_path: Path) -> None:
    (upper,) = [
        p
        for p in pipeline.read_mechanism(SPECS / "chain-stitch-looper.toml", []).assembly.parts
        if p.name == "upper-spreader"
    ]
    sheet = drawn(upper, tmp_path)
    hidden = sheet.space.query("*[layer=='HIDDEN']")
    assert {entity.dxf.linetype for entity in hidden} == {"HIDDEN2"} and "HIDDEN" in LAYERS
    assert (
        len(hidden) == 3
    )  # the layer below the upper one, and its bore from the left and from above


@pytest.mark.long
def test_bores_are_dashed_in_the_view_from_the_left(sheets: list[Drawn]) -> None:
    """Each hole along z between two dashed lines at its least and greatest y, and of a blind one its end; of a flat plate with several
    holes a note says that they go through."""
    for sheet in sheets:
        right = max(sheet_box(layer.region)[2] for layer in sheet.part.layers)
        boxes = [ezdxf.path.make_path(e) for e in sheet.space.query("LWPOLYLINE[layer=='HIDDEN']")]
        sides = [
            box
            for path in boxes
            if (box := shapely.LineString([v.vec2 for v in path.flattening(1)]).bounds)[0] > right
        ]
        layers = sheet.part.layers
        alike = len({layer.region for layer in layers}) == 1 and sheet.part.side_profile is None
        flat = alike and len(layers[0].region.holes) > 1
        assert flat == any(each.dxf.text == "All holes go through" for each in sheet.texts)
        titled = any(each.dxf.text == "S-S" for each in sheet.texts)
        cut = titled and (len(layers) == 1 or sheet.part.drum is not None)
        if flat or cut:
            assert not sides
            continue
        for layer in layers:
            for hole in layer.region.holes:
                _, low, _, high = sheet_box(Region(hole))
                mine = [box for box in sides if abs(box[1] - low) + abs(box[3] - high) < FACETS]
                assert mine, (sheet.part.name, low, high)
                long = layer.z1 - layer.z0 if sheet.part.side_profile is None else 0.0
                assert max(box[2] - box[0] for box in mine) > long - FACETS, sheet.part.name


# ---- words ------------------------------------------------------------------------------------------------------------


@pytest.mark.long
def test_notes_end_before_the_title_block_in_librecad(sheets: list[Drawn]) -> None:
    for sheet in sheets:
        left = sheet.high.real - 170 / sheet.scale
        notes = [e for e in sheet.texts if e.dxf.insert.x < sheet.low.real + 3.1 / sheet.scale]
        assert notes, sheet.part.name
        for note in notes:
            end = note.dxf.insert.x + cad_width(note.dxf.text, note.dxf.height)
            assert end < left, (sheet.part.name, note.dxf.text)


def text_box(text: ezdxf.entities.Text) -> shapely.Polygon:
    """Where a text stands in LibreCAD's font, with its hooks below the line."""
    wide, h = cad_width(text.dxf.text, text.dxf.height), text.dxf.height
    share = {0: 0.0, 1: 0.5, 2: 1.0}[text.dxf.halign]
    at = text.dxf.insert if text.dxf.halign == 0 else text.dxf.align_point
    box = shapely.box(-share * wide, -0.25 * h, (1 - share) * wide, h)
    return shapely.affinity.translate(
        shapely.affinity.rotate(box, text.dxf.rotation, origin=(0, 0)), at.x, at.y
    )


@pytest.mark.long
def test_no_text_leaves_the_frame_or_runs_into_the_title_block(sheets: list[Drawn]) -> None:
    """What stands in the block stays in its own cell, all else outside it; a number or table never runs into another text."""
    for sheet in sheets:
        low, high = sheet.low, sheet.high
        block = shapely.box(
            high.real - 170 / sheet.scale, low.imag, high.real, low.imag + 36 / sheet.scale
        )
        inner = shapely.box(low.real, low.imag, high.real, high.imag)
        boxes = [(text.dxf.text, text_box(text)) for text in sheet.texts]
        outside = [(name, box) for name, box in boxes if not block.buffer(1e-6).contains(box)]
        assert len(boxes) - len(outside) == 29, sheet.part.name
        # 16 cells, a name and a value each, three of them left to be filled in by hand
        for name, box in outside:
            assert inner.buffer(1e-6).contains(box) and not block.intersects(box), (
                sheet.part.name,
                name,
            )
        for k, (name, box) in enumerate(boxes):
            for other, its in boxes[:k]:
                assert box.intersection(its).area < 0.02 * box.area, (sheet.part.name, name, other)


@pytest.mark.long
def test_title_block_says_what_a_workshop_asks(sheets: list[Drawn]) -> None:
    for sheet in sheets:
        texts = [text.dxf.text for text in sheet.texts]
        said = {
            key: texts[texts.index(key) + 1]
            for key in ("Material", "Mass", "General tolerance", "Date", "Drawing number")
        }
        assert said == dict(
            zip(said, ("PLA", "12.3 g", "ISO 2768-m", "2026-05-31", "K-104-01"), strict=True)
        )
        # first angle: the cone's frustum left of its view from the small end, two circles about one axis [ISO 5456-2]
        at = next(text.dxf.insert for text in sheet.texts if text.dxf.text == "Projection")
        near = [
            e
            for e in sheet.space.query("ARC CIRCLE[layer=='TEXT']")
            if abs(e.dxf.center.y - at.y) * sheet.scale < 6
        ]
        small, large = sorted(near, key=lambda e: e.dxf.radius)
        assert small.dxf.center == large.dxf.center and large.dxf.radius == pytest.approx(
            2 * small.dxf.radius
        )
        (frustum,) = [
            e
            for e in sheet.space.query("LWPOLYLINE[layer=='TEXT']")
            if len({round(y * sheet.scale, 3) for _, y in e.get_points("xy")}) == 4
        ]
        z = np.array(frustum.get_points("xy")) @ [1, 1j]
        left, right = np.ptp(z.imag[z.real == z.real.min()]), np.ptp(z.imag[z.real == z.real.max()])
        assert (left, right) == pytest.approx((2 * small.dxf.radius, 2 * large.dxf.radius))
        assert z.real.max() < large.dxf.center.x - large.dxf.radius


@pytest.mark.long
def test_a_disc_is_told_by_its_diameter(sheets: list[Drawn]) -> None:
    for sheet in sheets:
        outers = [layer.region.outer for layer in sheet.part.layers]
        if len(sheet.part.layers) == 1 and (disc := as_circle(outers[0])):
            dims = [
                e.dxf.text
                for e in sheet.texts
                if e.dxf.layer == "DIM" and e.dxf.text.startswith("%%c")
            ]
            (across,) = (float(text.removeprefix("%%c")) for text in dims)
            # a quarter of what ISO 2768-m allows from 6 to 30 mm
            assert across == pytest.approx(2 * disc[1], abs=0.05), sheet.part.name


@pytest.mark.long
def test_radii_of_a_cam_are_those_of_its_outline(sheets: list[Drawn]) -> None:
    for sheet in sheets:
        curve = next(
            (c for c in (sheet.part.region.outer, *sheet.part.region.holes) if free(c)), None
        )
        texts = [text.dxf.text for text in sheet.texts]
        toothed = sheet.part.name.startswith("gear-")  # a wheel's teeth are in its notes
        sliding = sheet.part.title == "Plate of a linear cam"
        if curve is None or toothed or sliding:
            assert "Radius" not in texts, sheet.part.name
            continue
        z = facet_contour(curve, 1e-6)
        pairs = [re.fullmatch(r"(\d+)%%d (\d+\.\d{3})", f"{a} {b}") for a, b in pairwise(texts)]
        rows = [(float(pair[1]), float(pair[2])) for pair in pairs if pair]
        assert sorted(angle for angle, _ in rows) == list(range(0, 360, 10)), sheet.part.name
        ring = shapely.LinearRing(np.column_stack([z.real, z.imag]))
        for angle, radius in rows:
            point = radius * np.exp(1j * np.radians(angle))
            assert ring.distance(shapely.Point(point.real, point.imag)) < 6e-4, (
                sheet.part.name,
                angle,
            )


@pytest.mark.parametrize(
    "word",
    ["A-word-without-any-space-in-it-that-is-longer-than-the-room-for-notes.dxf", "mw " * 30],
)
def test_no_note_is_too_long(word: str, tmp_path: Path) -> None:
    part = Part(
        "disc", "Disc", (Layer(Region(circle(0, 9), (circle(0, 2),)), 0, 4),), notes=(word,)
    )
    sheet = drawn(part, tmp_path)
    notes = [e for e in sheet.texts if e.dxf.insert.x < sheet.low.real + 3.1 / sheet.scale]
    found = [e for e in notes if e.dxf.text and e.dxf.text in word]
    left = sheet.high.real - 170 / sheet.scale
    assert found and all(e.dxf.insert.x + cad_width(e.dxf.text, e.dxf.height) < left for e in found)


@pytest.mark.long
def test_each_label_is_beside_its_own_hole_or_points_at_it(sheets: list[Drawn]) -> None:
    for sheet in sheets:
        each_label_has_its_hole(sheet)


def each_label_has_its_hole(sheet: Drawn) -> None:
    named = holes_of(sheet.part.region.holes, sheet.part.points)
    rims = {}
    for contour in sheet.part.region.holes:
        ((_, hole),) = holes_of([contour])
        z = facet_contour(contour, 1e-3)
        rims[hole] = shapely.LinearRing(np.column_stack([z.real, z.imag]))
    for name, own in named:
        small = [
            e for e in sheet.texts if e.dxf.layer == "DIM" and e.dxf.height * sheet.scale < 3
        ]  # a size is larger
        (label,) = [e for e in small if e.dxf.text == name]
        place = complex(label.dxf.align_point.x, label.dxf.align_point.y) + 1.25j / sheet.scale
        to_middle = {hole: abs(hole.middle - place) for _, hole in named}
        to_rim = {
            hole: rims[hole].distance(shapely.Point(place.real, place.imag)) for _, hole in named
        }
        if all(away[own] <= min(away.values()) for away in (to_middle, to_rim)):
            continue
        ends = [
            (complex(e.dxf.start.x, e.dxf.start.y), complex(e.dxf.end.x, e.dxf.end.y))
            for e in sheet.space.query("LINE[layer=='DIM']")
        ]
        half = (
            Text(0j, name, 2.5).room / 2 + 1.25j
        )  # mm of paper, of the label's box, from whose edge its leader starts
        apart = [(start - place) * sheet.scale for start, _ in ends]
        beside = [abs(z.real) < half.real + 1 and abs(z.imag) < half.imag + 1 for z in apart]
        near = [tip for (_, tip), close in zip(ends, beside, strict=True) if close]
        tips = [
            min(abs(tip - own.middle), rims[own].distance(shapely.Point(tip.real, tip.imag)))
            for tip in near
        ]
        assert tips and min(tips) * sheet.scale < 0.1, (sheet.part.name, name)


@pytest.mark.long
def test_labels_of_crowded_holes(tmp_path: Path) -> None:
    """Small holes so near to each other that beside none there is room for a label of its own."""
    holes = tuple(
        circle(complex(1.2 * x, 1.2 * y), 0.5) for x in range(-3, 4) for y in range(-3, 4)
    )
    part = Part(
        "sieve",
        "Sieve",
        (Layer(Region(polygon([-40 - 40j, 40 - 40j, 40 + 40j, -40 + 40j]), holes), 0, 2),),
    )
    sheet = drawn(part, tmp_path)
    each_label_has_its_hole(sheet)
