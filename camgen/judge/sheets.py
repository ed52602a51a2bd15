"""The judge of sheets for a laser: every part is there, where the list says, and is itself when the beam's slot is added back.

path     what the middle of the beam follows
as cut   what the beam leaves of the sheet: the path, less half the slot's width all along. Walls, fits and motion take its
         corners as sharp; how round the beam leaves those inside, and what it is too wide for, is judged by itself
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from camgen.errors import FileError, counted
from camgen.files.cutting import read_svg
from camgen.files.dxf import read_dxf
from camgen.findings import Finding, Where, at_least, at_most, in_file
from camgen.geometry.distances import point_to_ring
from camgen.geometry.rings import Points, Ring, Shape
from camgen.judge.round_trip import MILLIMETRES, NominalPart, PartVerdict, judge_cut, pieces_of
from camgen.numerics import coordinates
from camgen.tolerances import WAY_BACK

if TYPE_CHECKING:
    from camgen.files.formats import Drawing

_TOOLS = {
    "ENGRAVE": (5, 0),
    "CUT": (1, 0),
}  # colour index and line weight, by which the laser takes them: blue, red, hairlines
FACETS = 1e-4  # mm, chord tolerance of arcs where gaps and corners are measured
_FINE = 1e-5  # mm, where motion and fits are
_ROUND = 64  # chords of a quarter of the beam's circle
_CORNER = 0.1  # rad, outlines that turn by less have no corner there
_SVG_STEP = 1e-5  # mm, what the six decimals of an SVG may move an arc


@dataclass(frozen=True)
class SheetCopy:
    """A copy of a part on a sheet: turned by angle, rad, then moved to place, mm."""

    part: str
    copy: int
    angle: float
    place: complex


@dataclass(frozen=True)
class Beam:
    """What a laser cuts with, and of."""

    kerf: float  # mm
    gap: float  # between pieces, mm
    sheet: tuple[float, float]  # width and height, mm


def judge_sheet(
    dxf: Path, svg: Path, copies: Sequence[SheetCopy], parts: Mapping[str, NominalPart], beam: Beam
) -> tuple[list[Finding], dict[str, PartVerdict]]:
    """Findings on one sheet in both formats, and its parts as cut, by name, in their own frames.

    SHEET_FIT: what is missing, how far a piece stands out over the sheet, and the gap between pieces; KERF: how far a part as
    cut is from its outline. ROUND_TRIP and MIN_WALL are those of each part as cut.
    """
    drawing = read_dxf(dxf, engraving=True)
    where = in_file(dxf)
    faults = [fault.message for fault in drawing.faults] + drawing.repainted(_TOOLS)
    faults += (
        []
        if drawing.units == MILLIMETRES
        else [f"$INSUNITS is {drawing.units}, millimetres are {MILLIMETRES}"]
    )
    findings = [
        at_most(
            "DXF_CLOSED",
            len(faults),
            0,
            "contours",
            where,
            "; ".join(faults)
            or f"{counted(len(drawing.cut), 'contour')}, each one closed entity in millimetres",
        )
    ]
    if faults:
        return findings, {}
    pieces = pieces_of(drawing.cut)
    findings += _fit(pieces, beam, len(copies), where)
    findings.append(
        _same_as_svg(drawing, svg, beam.sheet, [f"{copy.part}-{copy.copy}" for copy in copies])
    )
    verdicts: dict[str, PartVerdict] = {}
    for copy in copies:
        if not pieces:
            break
        expected = parts[copy.part]
        turn = cmath.rect(1, copy.angle)
        middle = (
            turn * expected.sections[expected.drawn_section].shapes[0].outer.centroid + copy.place
        )
        piece = min(pieces, key=lambda shape: abs(shape.outer.centroid - middle))
        path = piece.moved(shift=-copy.place).moved(1 / turn)
        place = replace(where, part=f"{copy.part}-{copy.copy}")
        try:
            rings = [
                widened(path.outer, -beam.kerf / 2),
                *(widened(hole, beam.kerf / 2) for hole in path.holes),
            ]
        except ValueError as error:
            findings.append(at_most("KERF", math.nan, 0, "mm", place, str(error)))
            continue
        verdict = judge_cut(rings, expected, place)
        findings += verdict.findings
        findings.append(_kerf(path, expected, beam.kerf, place))
        if verdict.sections:
            verdicts.setdefault(copy.part, verdict)
    return findings, verdicts


def _fit(pieces: Sequence[Shape], beam: Beam, count: int, where: Where) -> list[Finding]:
    """SHEET_FIT of the pieces of a sheet, and COPIES."""
    import shapely

    boxes = np.array([shape.outer.box for shape in pieces]).reshape(-1, 4)
    overhang = float(
        np.max(np.concatenate([-boxes[:, :2], boxes[:, 2:] - np.array(beam.sheet)]), initial=0.0)
    )
    width, height = beam.sheet
    findings = [
        at_most(
            "COPIES",
            abs(len(pieces) - count),
            0,
            "copies",
            where,
            f"{len(pieces)} pieces, {count} in the list",
        ),
        at_most(
            "SHEET_FIT",
            max(overhang, 0.0),
            0,
            "mm",
            where,
            f"how far a path stands out over {width:g} x {height:g} mm",
        ),
    ]
    if len(pieces) > 1:
        areas = [_area(shape.outer) for shape in pieces]
        near = shapely.STRtree(areas).query_nearest(
            areas, exclusive=True, all_matches=False, return_distance=True
        )[1]
        remark = "smallest gap between the paths of two pieces"
        findings.append(
            at_least(
                "SHEET_FIT",
                float(near.min()),
                beam.gap,
                "mm",
                where,
                remark,
            ).within(2 * FACETS)
        )
    return findings


def _same_as_svg(
    drawing: Drawing, svg: Path, sheet: tuple[float, float], names: Sequence[str]
) -> Finding:
    """ROUND_TRIP of the same sheet in SVG: contour by contour as in the DXF, each piece under its name."""
    try:
        size, layers = read_svg(svg)
    except FileError as error:
        return at_most("ROUND_TRIP", math.nan, 0, "mm", in_file(svg), str(error))
    off = 0.0
    count = 0
    for name, drawn_rings in (("ENGRAVE", drawing.engraved), ("CUT", drawing.cut)):
        rings = layers[name].rings if name in layers else []
        count += len(rings)
        if len(rings) != len(drawn_rings) or size != sheet:
            remark = f"{len(rings)} contours on {size[0]:g} x {size[1]:g} mm instead of {len(drawn_rings)}"
            return at_most("ROUND_TRIP", math.nan, 0, "mm", in_file(svg), remark)
        off = max([off, *(_apart(a, b) for a, b in zip(rings, drawn_rings, strict=True))])
    titles = {name: layer.titles for name, layer in layers.items()}
    remark = f"{count} contours, as in the DXF"
    if titles.get("CUT", []) != list(names) or not set(titles.get("ENGRAVE", [])) <= set(names):
        off = math.nan
        remark = "its pieces do not have the names of the list of sheets, in that order"
    return at_most("ROUND_TRIP", off, _SVG_STEP, "mm", in_file(svg), remark)


def _apart(a: Ring, b: Ring) -> float:
    """How far two rings are apart that run alike, mm."""
    if a.points.shape != b.points.shape:
        return math.inf
    shift = np.max(np.abs(a.points - b.points))
    rise = np.max(np.abs(a.bulges - b.bulges) * np.abs(b.ends - b.points)) / 2
    return float(max(shift, rise))


def _area(ring: Ring, tolerance: float = FACETS) -> Any:
    import shapely

    z = ring.facetted(tolerance)
    return shapely.Polygon(coordinates(z))


def widened(ring: Ring, distance: float, sharp: bool = True) -> Ring:
    """A ring moved outwards by a distance, mm (< 0: inwards), facetted, its corners sharp or as a disc leaves them; ValueError
    where it falls apart."""
    import shapely

    style = "mitre" if sharp else "round"
    area = _area(ring, _FINE).buffer(distance, quad_segs=_ROUND, join_style=style, mitre_limit=10)
    parts = [part for part in shapely.get_parts(area) if not part.is_empty]
    if len(parts) != 1:
        raise ValueError(f"{len(parts)} pieces are left of a contour moved by {distance:g} mm")
    z: Points = shapely.get_coordinates(parts[0].exterior)[:-1] @ np.array([1, 1j])
    return Ring.straight(z)


def _kerf(path: Shape, expected: NominalPart, kerf: float, where: Where) -> Finding:
    """KERF: how far the part as cut is from the outline that was meant, where inner corners come out round."""
    import shapely

    shape = expected.sections[expected.drawn_section].shapes[0]
    off = 0.0
    allowed = 0.0
    holes = list(path.holes)
    pairs = [(path.outer, shape.outer, -kerf / 2)]
    for hole in shape.holes:
        if holes:
            nearest, *holes = sorted(holes, key=lambda ring: abs(ring.centroid - hole.centroid))
            pairs.append((nearest, hole, kerf / 2))
    for ring, nominal, way in pairs:
        pieces = shapely.get_parts(_area(ring).buffer(way, quad_segs=_ROUND))
        if len(pieces) != 1:
            return at_most(
                "KERF", math.nan, 0, "mm", where, f"{len(pieces)} pieces are left of a contour"
            )
        edge = shapely.get_coordinates(pieces[0].exterior)[:-1] @ np.array([1, 1j])
        target = nominal.counter_clockwise().facetted(FACETS)
        off = max(off, float(np.max(point_to_ring(along(target), edge))))
        allowed = max(allowed, _round_corner(target if way < 0 else target[::-1], kerf / 2))
    limit = allowed + 2 * expected.chord_tolerance + WAY_BACK * kerf / 2 + FACETS
    remark = "distance of the part as cut from its outline: inner corners come out round, and details narrower than the kerf are lost"
    return at_most("KERF", off, limit, "mm", where, remark)


def along(ring: Points) -> Points:
    """A polygon's vertices and the middles of its edges."""
    return np.concatenate([ring, (ring + np.roll(ring, -1)) / 2])


def _round_corner(ring: Points, radius: float) -> float:
    """How far a beam of this radius stays away from the sharpest corner of a polygon that turns to its right, mm: material lies
    to its left."""
    way = np.roll(ring, -1) - ring
    turn = np.angle(way / np.roll(way, 1))
    sharpest = float(np.max(-turn, initial=0.0))
    return radius * (1 / math.cos(sharpest / 2) - 1) if sharpest > _CORNER else 0.0
