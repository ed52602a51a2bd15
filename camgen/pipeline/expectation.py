"""What the files of a part should hold, as plain numbers and points: all that the judge of files knows of the part."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from camgen.files.dxf import center_marks
from camgen.geometry.crossing import crossed_at, spread
from camgen.geometry.drums import Drum
from camgen.geometry.facets import facet_contour
from camgen.geometry.mesh import Mesh, slice_mesh
from camgen.geometry.outlines import Floats, Line, Region
from camgen.geometry.rings import Ring, Shape
from camgen.judge.round_trip import NominalPart, PrintChange, Section
from camgen.machine.features import CamOutline, Feature, eyes_of
from camgen.parts.fits import Compensation, compensated
from camgen.parts.part import Part
from camgen.spec import Files

_HEIGHTS = (0.137, 0.5, 0.871)  # shares of a layer's height at which meshes are cut
_STEP = 0.1  # mm, between the heights at which a crossed body is cut: its walls need not be upright
_LEVEL = 0.75  # slope of a wall below which a facet off by the tolerance shows in a section by more than the limit
_BESIDE = 4.0  # chord tolerances from the ends of a layer


def nominal_part(
    part: Part,
    tolerance: float,
    features: Sequence[Feature] = (),
    fit: Compensation | None = None,
    files: Files | None = None,
) -> NominalPart:
    """What a file of a part should hold, as plain numbers and points for the judge; files: what a drawing is asked to show.

    With a fit the file holds the compensated part: its volume counts. Its sections are judged as they print; those of the
    chamfer, and those through an engraving beside holes that were made larger, as they were sent.
    """
    cams = [each for each in features if isinstance(each, CamOutline)]
    turns = any(
        (cam.bore and cam.part) == part.name or (cam.own and cam.own.part) == part.name
        for cam in cams
    )
    solid = compensated(part, fit) if fit is not None else part
    levels = sorted({z for layer in (*solid.layers, *solid.engraved) for z in (layer.z0, layer.z1)})
    low = levels[0] + (fit.foot_of(part) if fit is not None else 0.0)
    # Half the tolerance, so that arcs in a file that are off by all of it stay within the limit, which is twice of it; a
    # crossed body is what its facets make it, for near the top of a round one the width grows without bound.
    fine = tolerance / 2 if part.side_profile is None else tolerance
    sections, engraved = _sections(part, fine, low)
    cut = _spans(part).index((part.drawn.z0, part.drawn.z1))
    if (
        part.side_profile is not None
    ):  # what a cut shows changes with its height; the drawing has the whole region
        under, over = spread(part.side_profile)
        levels = [max(levels[0], under), min(levels[-1], over)]
        through = _crossings(part, part.side_profile, tolerance, sections)
        sections = [*through, replace(sections[cut], heights=())]
        cut = len(through)
    if part.drum is not None:  # its walls lean as its track does: the roller is rolled on them
        levels = [levels[0], levels[-1]]
        sections = [*_ends(part, part.drum, fine), replace(sections[cut], heights=())]
        cut = len(sections) - 1
    if fit is not None:
        all_sections, pockets = _sections(solid, fine, levels[0])
        sections += [
            replace(section, sent=True) for section in all_sections if section.heights[-1] < low
        ]
        engraved = [replace(section, sent=True) for section in pockets] if fit.hole else engraved
    return NominalPart(
        part.name,
        (*sections, *engraved),
        cut,
        volume=solid.volume,
        levels=tuple(levels),
        facets=part.walls * tolerance,
        min_wall=part.min_wall,
        chord_tolerance=tolerance,
        bore=part.bore if turns else None,  # otherwise its place is judged as that of any hole
        eyes=eyes_of(part.name, features),
        rolls=any(cam.part == part.name for cam in cams),
        levels_complete=part.prismatic,
        print_change=PrintChange(fit.hole, fit.profile, fit.shrinkage) if fit is not None else None,
        marks=center_marks(part.region, part.centres if files and files.center_marks else ()),
        engraved=tuple(facetted(Region(each), fine).outer for each in part.engraving)
        if files and files.engrave
        else (),
        curves=files.curves if files else "bulge",
    )


def _spans(part: Part) -> list[tuple[float, float]]:
    """Lowest and highest place of each of a part's layers, mm; pieces beside each other are one."""
    return list(dict.fromkeys((layer.z0, layer.z1) for layer in part.layers))


def _sections(part: Part, tolerance: float, low: float) -> tuple[list[Section], list[Section]]:
    """The sections of a part's layers above the height `low`, from the bottom, and those through its engraving."""
    sections = []
    engraved = []
    for z0, z1 in _spans(part):
        regions = [layer.region for layer in part.layers if (layer.z0, layer.z1) == (z0, z1)]
        shapes = tuple(facetted(region, tolerance) for region in regions)
        bottom = max(z0, low)
        pockets = [layer for layer in part.engraved if bottom < layer.z0 < z1]
        top = min((layer.z0 for layer in pockets), default=z1)
        sections.append(
            Section(tuple(bottom + (top - bottom) * fraction for fraction in _HEIGHTS), shapes)
        )
        if pockets and len(shapes) == 1 and part.side_profile is None:
            cut = [facetted(layer.region, tolerance) for layer in pockets]
            face = Shape(shapes[0].outer, (*shapes[0].holes, *(each.outer for each in cut)))
            islands = tuple(Shape(hole, ()) for each in cut for hole in each.holes)
            middle = (top + min(layer.z1 for layer in pockets)) / 2
            engraved.append(Section((middle,), (face, *islands), pocket=True))
    return sections, engraved


def _crossings(
    part: Part, profile: Region, tolerance: float, sections: Sequence[Section]
) -> list[Section]:
    """The sections of a crossed body, whose layers those given are."""
    face = facetted(profile, tolerance)
    cutters = [Mesh(*edge.cutter(tolerance)) for edge in part.edges]
    through = []
    level = _level_facets(profile)
    beside = (
        _BESIDE * tolerance
    )  # a wall that lies level shows in sections just under and over it alone
    for section, (z0, z1) in zip(sections, _spans(part), strict=True):
        between = [
            z
            for z in np.arange(z0 + _STEP, z1 - beside, _STEP).tolist()
            if not np.any((level[:, 0] <= z) & (z <= level[:, 1]))
        ]
        for z in (z0 + beside, *section.heights, z1 - beside, *between):
            cuts = [ring for cutter in cutters for ring in slice_mesh(cutter, z)]
            through += [
                Section((z,), tuple(crossed_at(shape, face, z, cuts))) for shape in section.shapes
            ]
    return through


def _ends(part: Part, drum: Drum, tolerance: float) -> list[Section]:
    """The sections of a drum below and above its track, and of a key or within a pocket."""
    low, high = drum.span
    lower, *others = part.layers
    if drum.pocket is not None:
        heights = [(lower, drum.pocket / 2), (others[-1], (drum.pocket + low) / 2)]
    elif part.key is not None:
        key = part.key
        heights = [(lower, low / 2), (others[-2], (high + drum.length) / 2)]
        heights.append((key, (key.z0 + key.z1) / 2))
    else:
        heights = [(lower, low / 2), (part.layers[-1], (high + drum.length) / 2)]
    return [Section((z,), (facetted(layer.region, tolerance),)) for layer, z in heights]


def _level_facets(profile: Region) -> Floats:
    """Heights (n, 2), mm, between which a curve of the plane (x, z) is too level for its facets to be judged by a section."""
    spans = [np.empty((0, 2))]
    for piece in (piece for contour in (profile.outer, *profile.holes) for piece in contour.pieces):
        if not isinstance(piece, Line):
            points = piece.at(np.linspace(piece.t0, piece.t1, 361))
            way = np.diff(points)
            ends = np.stack([points.imag[:-1], points.imag[1:]], axis=1)
            spans.append(np.sort(ends[np.abs(way.imag) < _LEVEL * np.abs(way.real)], axis=1))
    return np.concatenate(spans)


def facetted(region: Region, tolerance: float) -> Shape:
    """A region with its curves as chords, within the tolerance, mm."""
    rings = [
        facet_contour(contour.counter_clockwise(), tolerance)
        for contour in (region.outer, *region.holes)
    ]
    outer, *holes = (Ring.straight(points) for points in rings)
    return Shape(outer, tuple(holes))
