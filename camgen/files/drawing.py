"""The dimensioned drawing of a part: laid out once as a sheet, written as DXF and as PDF.

Views in first-angle projection: the part as its layers lie, seen along z; to its right seen from the left, bores dashed;
below it seen along y a part that is crossed with a second outline, or a section of one whose layers differ; one through the
bore of a plate or a drum, or through a keyway, takes the place of the view from the left. Of a plate's through holes none is
dashed: a note says that they go through. Overall sizes, a table of holes with their fits and of the corners and
roundings of every outline, notes and a title block. An outline that is no chain of lines and arcs, a cam's, is in the part's
own file; it gets its least and greatest radius, a table of radii, and its overall sizes in parentheses.
Nothing here knows a mechanism.
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from string import ascii_uppercase

import numpy as np

from camgen.files import bore_detail, views
from camgen.files.bore_detail import BoreDetail, over_flat
from camgen.files.dimensions import (
    STACK,
    Hole,
    SlottedWheel,
    bosses,
    flat_of,
    flatted,
    free,
    hole_of,
    holes_of,
    layer_rows,
    nearest_and_farthest,
    number,
    round_of,
    slotted_wheel,
    standing_of,
    zero_of,
)
from camgen.files.labels import Label, Obstacles, along, callouts, leader, upper_mark
from camgen.files.limits import decimals, in_limits
from camgen.files.measures import REFERENCE, Measure, dimension
from camgen.files.sheet import Sheet, Text, write_dxf_sheet, write_pdf
from camgen.files.symbols import (
    FRAME,
    all_round,
    datum,
    line_profile,
    position,
    roughness,
    run_out,
    width_of,
)
from camgen.files.title_block import WIDTH, Facts, Rider, title_block
from camgen.files.track_tables import ROW as _ROW
from camgen.files.track_tables import grid, own_tables, tables_sheets, track_tables
from camgen.files.tracks import (
    SECTION_ROOM,
    axial_section,
    development,
    drum_section,
    looser,
    plates_section,
)
from camgen.geometry.arcs import as_circle, fit_arcs
from camgen.geometry.drums import Drum
from camgen.geometry.outlines import Contour, Floats, extent, rectangle
from camgen.numerics import coordinates
from camgen.parts.keyways import keyed
from camgen.parts.part import Layer, Part
from camgen.tolerances import SAME_POINT

# Standard scales, mm of paper for a mm of the part. [ISO 5455]
_SCALES = (50.0, 20.0, 10.0, 5.0, 2.0, 1.0, 0.5, 0.2, 0.1, 0.05, 0.02, 0.01, 0.005, 0.002, 0.001)
_SIZES = {"A4": (297.0, 210.0), "A3": (420.0, 297.0)}
# Frame: 20 mm at the filing edge, 10 mm elsewhere. [ISO 5457]
_FILING = 20.0
_MARGIN = 10.0
_SMALLEST = 2.0  # height of text there, mm
_TABLE_WIDTHS = (10.0, 17.0, 17.0, 58.0)
_NOTES = (
    _SIZES["A4"][0] - _FILING - _MARGIN - WIDTH - 6
)  # width of the notes, beside the title block of an A4 sheet
# Room round the plan view for dimensions, and between the views, mm: left and below, right and above.
_LEFT = 31.0
_BELOW = 28.0
_RIGHT = 24.0
_ABOVE = 24.0
_BESIDE = 12.0
_DIMENSION_GAP = 24.0
_ASIDE = 0.6  # rad, of a leader from the lines of overall sizes
# where the sense of turning goes, the best first: dimensions are below and to the left
_ARROWS = np.radians([45, 135, -45, -135, 65, 25, 115, 155, -25, -65, -115, -155, 90, 0, -90, 180])
_FACE_SHOWN = 12.0  # half of what is shown of a flat follower, mm of paper
_LETTERS = 2  # of a hole's name that is a datum's
_RIM = "h7"  # fit of a rim that is a datum
_FACE = 0.7  # of the radius of a drum's lower end: where its datum is in the view from the left
_RUN_OUT = 10.0  # more to the right of a drum's plan view, for the run-out of that end
_HATCH = 2.5  # mm of paper between the lines of a cut face
_THIRD = 8.0  # from the plan view's dimension to the third view, and from that to what is below
_BORE = 21.0  # to the dimension of a round bore there, past the sign of its roughness
_BOSS = 10.0  # between the dimensions of bosses, beside the view from the left
_SURFACE = 10.0  # room above for them
_TITLE = 4.0  # for the title of a drum's section, over its dimensions
_WALL = 7.0  # between dimensions of a drum's walls
_OVER = (
    8.0  # from the upper edge of that room down, of the frame of a track's tolerance over the view
)


def write_drawing(
    folder: Path, prefix: str, part: Part, tolerance: float, facts: Facts
) -> list[Path]:
    """Write `<prefix>-<part>-drawing.dxf` and `.pdf` into folder, and tables that have sheets of their own as `-tracks-drawing`,
    `-tracks-2-drawing` and so on; returns their paths.

    tolerance: mm, of the arcs that stand for the exact outline. An OSError means that a file could not be written.
    """
    stem = f"{prefix}-{part.name}"
    layout = _Layout(part, stem, tolerance, facts)
    paths = [folder / f"{stem}-drawing.dxf", folder / f"{stem}-drawing.pdf"]
    write_dxf_sheet(paths[0], layout.sheet, layout.scale, layout.datum)
    write_pdf(paths[1], layout.sheet)
    for name, sheet in tables_sheets(layout.own_tables, part, facts, stem).items():
        paths += [folder / f"{name}.dxf", folder / f"{name}.pdf"]
        write_dxf_sheet(paths[-2], sheet, 1.0, 0j)
        write_pdf(paths[-1], sheet)
    return paths


def _tip(rider: Rider) -> float:
    """Radius of a follower's roller, mm; 0 of an edge or a face."""
    return rider.radius if math.isfinite(rider.radius) else 0.0


def _wrapped(note: str) -> list[str]:
    """A note in lines that fit beside the title block of an A4 sheet."""
    room = _NOTES
    lines = [""]
    for word in note.split():
        longer = f"{lines[-1]} {word}".strip()
        lines = (
            [*lines[:-1], longer]
            if not lines[-1] or Text(0j, longer, 2.5).room <= room
            else [*lines, word]
        )
    return lines


def _two_lines(row: tuple[str, str, str, str]) -> list[tuple[str, str, str, str]]:
    """A row of the table of holes, on a second line what would make its last column's text small."""
    size, comma, more = row[3].rpartition(", ")
    if not comma or Text(0j, row[3], _SMALLEST).room <= _TABLE_WIDTHS[3] - 2:
        return [row]
    return [(*row[:3], size), ("", "", "", more)]


def _across_bore(part: Part, tolerance: float) -> views.Section | None:
    """The section along y through the origin, where a keyway is, from the left: y + iz, of a drum of its blank; None of a part
    that gets no section."""

    def turned(layer: Layer) -> Layer:
        return replace(layer, region=layer.region.moved(-1j))

    layers = tuple(map(turned, part.layers))
    engraved = tuple(map(turned, part.engraved))
    return views.section(replace(part, layers=layers, engraved=engraved), tolerance, 0.0)


def _contours(layers: Sequence[Layer], tolerance: float) -> list[Contour]:
    regions = [layer.region for layer in layers]
    return [
        fit_arcs(contour, tolerance)
        for region in regions
        for contour in (region.outer, *region.holes)
    ]


class _Layout:
    """The sheet of one part; fills `sheet`, and knows `scale` and where the part's `datum` is on the paper."""

    def __init__(self, part: Part, stem: str, tolerance: float, facts: Facts) -> None:
        self.part = part
        self.stem = stem
        self.tolerance = tolerance
        self.facts = facts
        self.outer = fit_arcs(part.region.outer, tolerance)
        self.holes = [fit_arcs(hole, tolerance) for hole in part.region.holes]
        inside = facts.profile_step_deg and not part.points
        self.tracks = [hole for hole in part.region.holes if inside and free(hole)]
        lettered = [hole for hole in part.region.holes if hole not in self.tracks]
        self.named = holes_of(lettered, part.points)
        self.rims = dict(zip(map(hole_of, part.region.holes), self.holes, strict=True))
        self.standing = standing_of(part, [name for name, _ in self.named])
        self.rims |= {
            hole: fit_arcs(part.layers[k].region.outer, tolerance)
            for k, (_, hole) in self.standing.items()
        }
        self.zero, self.zero_is = zero_of(part, self.named)
        self.placed = (
            facts.position > 0 and len([hole for _, hole in self.named if hole.radius]) > 1
        )
        others = [each for k, each in enumerate(part.layers) if k != part.drawn_layer]
        covered = [each for each in others if part.side_profile and each.z1 <= part.drawn.z0]
        holes = set(part.region.holes)
        hidden = [
            c for each in covered for c in (each.region.outer, *each.region.holes) if c not in holes
        ]
        self.hidden = [fit_arcs(contour, tolerance) for contour in hidden] + views.plan_bores(
            part, tolerance
        )
        self.above = _contours([each for each in others if each not in covered], tolerance)
        self.beyond = (
            []
            if part.side_profile is None
            else views.from_above(part, part.side_profile, tolerance)
        )
        self.key = next(filter(None, map(keyed, part.region.holes)), None)
        self.bored = self._bored()
        flat = self.bored is not None and flat_of(self.bored) is not None
        self.detailed = bool(
            self.bored and (self.key or flat)
        )  # a round bore has its size in a view
        drum = part.drum if facts.heights else None
        self.turns = (free(part.region.outer) or drum is not None) and part.bore is not None
        contours = (part.region.outer, *part.region.holes)
        self.slotted = list(filter(None, map(slotted_wheel, contours)))[:1]
        self.chamfer = facts.bore_chamfer if self.turns or self.bored else 0.0
        layered = len({layer.region for layer in part.layers}) > 1
        plated = self.bored and (self.key or not layered)
        across = facts.groove is not None or part.drum or plated
        several = len(part.region.holes) - len(self.tracks) > 1
        self.plate = several and not layered and part.side_profile is None
        upright = _across_bore(part, tolerance) if across else None
        section = None if upright else views.section(part, tolerance)
        self.upright = self._chamfered(upright)
        if self.upright and part.drum:
            self.upright = axial_section(part.drum, self.upright)
        self.section = self._chamfered(section)
        self.riders = facts.riders if self.turns and len(facts.riders) == 1 else ()
        self.bosses = bosses(part)
        self.right = _RIGHT + (_RUN_OUT if drum and facts.run_out else 0.0)
        self.inner = _BORE if self.bored and not self.detailed else 0.0
        self.beside = _BESIDE + self.inner + _BOSS * (len(self.bosses) + (part.drum is not None))
        self.depth = part.thickness if part.side_profile or self.section else 0.0
        self.engraved = _contours(part.engraved, tolerance)
        self.rows = self._rows()
        self.polar = self._radii_of_profile()
        self.track_tables = track_tables(facts, self.polar, part.drum)
        alone = len(self.track_tables) == 1
        self.track_table = self.track_tables[0] if alone else None  # on the sheet itself
        full = self._track_lines() >= self._lines_beside("A3")
        self.track_table = None if full else self.track_table
        self.own_tables = own_tables(facts, self.track_tables, full)
        self.surface = bool((self.polar or facts.levels) and (facts.profile or facts.roughness))
        self.over = _ABOVE + (_SURFACE if self.surface else _TITLE if part.drum else 0.0)
        self.angle_letter = ""
        self.datum_letter = ""
        self.datum_letter = next(
            (
                self._letter_of(label)
                for label, hole in self.named
                if hole.radius and abs(hole.place) < SAME_POINT
            ),
            "",
        )
        self.low, self.high = extent([self.outer, *self.above, *self.hidden])
        tops = [each.centre.imag + _tip(each) - self.high.imag for each in self.riders]
        self.rise = max([0.0, *tops])  # of a follower over the part, mm of the part
        self.disc = self._disc()
        self.rim_letter = self._rim_letter()
        self.datum_letter = self.datum_letter or self.rim_letter
        self.angle_hole = self._angle_hole()
        angled = self.facts.profile and (self.key or self.angle_hole or flat)
        self.angle_letter = self._second if angled else ""
        self.face_letter = self._second if drum and facts.profile else ""
        self.origin = self._origin()
        self.letter = next(
            (c for c in "S Z W V U T R Q".split() if c not in {label for label, _ in self.named}),
            "S-S",
        )
        self.notes = self._notes(tolerance)
        datums = [each for each in (self.datum_letter, self.angle_letter, self.face_letter) if each]
        wide = _SIZES["A3"][0] - _FILING - _MARGIN - sum(_TABLE_WIDTHS)
        self.unrolled = development(drum, facts, datums, wide, _SCALES) if drum else None
        self.track_section = drum_section(drum, facts, _SCALES) if drum else None
        if facts.groove:
            depth = part.drawn.z1 - part.drawn.z0
            self.track_section = plates_section(facts.groove, depth, facts, _SCALES)
        self.size_name, self.scale = self._choose()
        width, height = _SIZES[self.size_name]
        self.sheet = Sheet(width, height, f"{part.title} ({stem})")
        self.table_x = width - _MARGIN - sum(_TABLE_WIDTHS)
        self.datum = self._datum()
        self._frame()
        self._plan()
        self._side()
        self._third()
        self._surface()
        self._run_out()
        self._hole_datums()
        if self.turns:
            self._turning()
        self._upper_side()
        self._labels()
        self._table()
        self._bore_detail()
        self._note_lines()
        self._tracks()
        facts = replace(facts, number=facts.number or f"{stem}-drawing")
        corner = complex(width - _MARGIN, _MARGIN)
        title_block(self.sheet, corner, part, facts, self.scale, self.size_name)

    def _chamfered(self, section: views.Section | None) -> views.Section | None:
        """A section through the bore's axis with the chamfers of its bore, and their edges behind it."""
        if section is None or not self.chamfer or abs(section.y) > SAME_POINT:
            return section
        import shapely

        c = self.chamfer
        high = self.part.thickness
        radius = (self.part.bore or 0.0) / 2
        faces = section.faces
        beyond = list(section.beyond)
        for end, inner in ((0.0, c), (high, high - c)):
            rim = [(-radius - c, end), (radius + c, end), (radius, inner), (-radius, inner)]
            faces = faces.difference(shapely.Polygon(rim))
            beyond.append((complex(-radius, inner), complex(radius, inner)))
            beyond.append((complex(-radius - c, end), complex(-radius, end)))
        return replace(section, faces=faces, beyond=beyond)

    def _bored(self) -> Contour | None:
        """The bore that is dimensioned: one with a keyway, or a round one to which a cam's track refers or the dowels that carry one,
        or with a flat, which holds a cam."""
        holes = self.part.region.holes
        tracked = free(self.part.region.outer) or self.part.drum or self.facts.dowel
        flat = any(flat_of(hole) for hole in holes)
        datum = (self.facts.profile or flat) and self.part.bore and tracked
        circles = [(hole, round_of(hole)) for hole in holes] if datum else []
        round_ones = [hole for hole, disc in circles if disc and abs(disc[0]) < SAME_POINT]
        return next(iter([hole for hole in holes if keyed(hole)] + round_ones), None)

    def _disc(self) -> float | None:
        """Radius of the circle that bounds the view along z, mm; None where that is no circle."""
        circles = [each for contour in (self.outer, *self.above) if (each := as_circle(contour))]
        reach = ((r, at - r * (1 + 1j), at + r * (1 + 1j)) for at, r in circles)
        return next(
            (
                r
                for r, low, high in reach
                if abs(low - self.low) + abs(high - self.high) < SAME_POINT
            ),
            None,
        )

    def _rim_letter(self) -> str:
        """Letter of the datum that a round rim is, or the lower side of a plate with an edge, where no hole about its axis is one and
        something refers to a datum."""
        if self.facts.levels and self.facts.profile:
            return self._second
        track = self.facts.profile and any(map(free, self.part.region.holes))
        centred = self.disc is not None and abs(self.low + self.high) < SAME_POINT
        return self._second if centred and not self.datum_letter and (track or self.placed) else ""

    def _angle_hole(self) -> Hole | None:
        """The dowel's hole that is the datum of a track's angle, of a part without a keyway; of a plate with an edge its first hole."""
        if self.facts.levels:
            return next((hole for _, hole in self.named if self.datum_letter and hole.radius), None)
        contours = (self.part.region.outer, *self.part.region.holes)
        if self.key or not (self.facts.profile and self.datum_letter and any(map(free, contours))):
            return None
        dowel = self.facts.dowel
        holes = (hole for _, hole in self.named if hole.radius and abs(hole.place) > SAME_POINT)
        return next((hole for hole in holes if abs(2 * hole.radius - dowel) < SAME_POINT), None)

    def paper(self, z: complex) -> complex:
        """A point of the part on the paper."""
        return self.datum + self.scale * z

    @property
    def side_x(self) -> float:
        """Where the part's face at z = 0 is in the view from the left, on paper."""
        return self.paper(self.high).real + self.right + _BESIDE / 2

    def _room(self, size: str) -> tuple[float, float]:
        """Width and height that both views and their dimensions may take, mm."""
        width, height = _SIZES[size]
        foot = self._foot + (self.unrolled.room if self.unrolled else 0.0)
        return width - _FILING - _MARGIN - sum(_TABLE_WIDTHS), height - 2 * _MARGIN - foot

    @property
    def _foot(self) -> float:
        """Height of notes, title block and the section of a track beside them, mm."""
        notes = 3.0 + 4.5 * len(self.notes) + (9.0 if self.placed else 0.0)
        return max(self.facts.height, notes, SECTION_ROOM.imag if self.track_section else 0.0)

    def _tracks(self) -> None:
        """The section of a track beside the notes, and a drum's development over both."""
        corner = complex(_FILING, _MARGIN)
        if self.track_section:
            place = corner + 3 + _NOTES + 4
            self.track_section.draw(self.sheet, place, self.scale, self.facts.tolerance)
        if self.unrolled:
            self.unrolled.draw(self.sheet, corner + 1j * self._foot)

    def _choose(self) -> tuple[str, float]:
        """Sheet size and scale: A4 unless A3 spares a reduction or the tables need it."""
        span = self.high - self.low

        def best(size: str) -> float:
            wide, tall = self._room(size)
            wide -= _LEFT + self.right + self.beside
            tall -= _BELOW + self.over + (2 * _THIRD if self.depth else 0.0)
            high = span.imag + self.depth + self.rise
            fits = (
                s
                for s in _SCALES
                if s * (span.real + self.part.thickness) <= wide and s * high <= tall
            )
            return next(fits, _SCALES[-1])

        if self.track_section:
            return "A3", best("A3")
        a4 = best("A4")
        a3 = best("A3")
        long = (1 + len(self.rows) + self._track_lines()) * _ROW > _SIZES["A4"][
            1
        ] - 2 * _MARGIN - self.facts.height - (bore_detail.HEIGHT if self.detailed else 0.0)
        tables = self.track_table or self.detailed
        return ("A3", a3) if (a4 < 1 and a3 > a4) or (long and tables) else ("A4", a4)

    def _datum(self) -> complex:
        """Where the part's origin goes: both views in the middle of their room."""
        wide, tall = self._room(self.size_name)
        span = self.scale * (self.high - self.low)
        spare_x = (
            wide - _LEFT - self.right - self.beside - span.real - self.scale * self.part.thickness
        )
        third = 2 * _THIRD + self.scale * self.depth if self.depth else 0.0
        spare_y = tall - _BELOW - self._room_above - span.imag - third
        foot = _SIZES[self.size_name][1] - 2 * _MARGIN - tall
        corner = complex(
            _FILING + _LEFT + spare_x / 2, _MARGIN + foot + _BELOW + third + spare_y / 2
        )
        return corner - self.scale * self.low

    @property
    def _room_above(self) -> float:
        """Room over the plan view, mm of paper."""
        return self.over + self.scale * self.rise

    def _frame(self) -> None:
        right = self.sheet.width - _MARGIN
        top = self.sheet.height - _MARGIN
        corners = (
            complex(_FILING, _MARGIN),
            complex(right, _MARGIN),
            complex(right, top),
            complex(_FILING, top),
        )
        self.sheet.line(*corners, layer="TEXT", closed=True)

    def _plan(self) -> None:
        sheet = self.sheet
        scale = self.scale

        def put(contour: Contour, layer: str) -> None:
            sheet.contour(contour.moved(scale, self.datum), layer)

        for contour in (self.outer, *self.holes):
            put(contour, "CUT")
        for contour in self.above:
            put(contour, "VIEW")
        for contour in self.hidden:
            put(contour, "HIDDEN")
        for contour in self.engraved:
            put(contour, "TEXT")
        self._centre_lines()
        for rider in self.riders:
            self._rider(rider)
        low = self.paper(self.low)
        high = self.paper(self.high)
        span = self.high - self.low
        # the extension lines start at the box: the points where it touches the outline are not all on one side
        shaft = flatted(self.part.region.outer)
        diameters = [
            2 * each for each in (self.disc, shaft[1] if shaft else None) if each
        ]  # diameters
        other = REFERENCE if free(self.part.region.outer) or self.slotted else ""
        signs = (
            "Ø" if any(abs(size - each) < SAME_POINT for each in diameters) else other
            for size in (span.real, span.imag)
        )
        wide, tall = signs
        rim = self.rim_letter and self.facts.profile and not self.facts.levels
        fit = _RIM if rim else self.facts.outer_fit if wide == "Ø" else ""
        fit = in_limits(fit, span.real) if fit else ""
        self._dimension(
            low, complex(high.real, low.imag), -1j * _DIMENSION_GAP, Measure(span.real, wide, fit)
        )
        if self.rim_letter:
            plate = self.facts.levels
            middle = (2 * self.low.real + self.high.real) / 3 if plate else 0.0
            foot = self.paper(complex(middle, self.low.imag)) - 1j * _DIMENSION_GAP * (not plate)
            datum(self.sheet, foot, -1j, self.rim_letter)
        if self.disc is None:
            aside = -_DIMENSION_GAP + 0j
            self._dimension(low, complex(low.real, high.imag), aside, Measure(span.imag, tall))
        self._radii()
        if self.section:
            y = self.section.y
            ends = complex(self.low.real, y), complex(self.high.real, y)
            self._plane(ends, -1j)
            if abs(y) > SAME_POINT:
                a, b = map(self.paper, ends)
                self.sheet.line(a - 4, b + 4, layer="CENTER")
        if self.upright:
            self._plane((1j * self.low.imag, 1j * self.high.imag), 1)

    def _plane(self, ends: tuple[complex, complex], view: complex) -> None:
        """Where a section is cut, from end to end of the part, mm, and the direction of view on the sheet."""
        along = (ends[1] - ends[0]) / abs(ends[1] - ends[0])
        for place, out in ((ends[0], -along), (ends[1], along)):
            near = self.paper(place) + 4 * out
            if self.turns and (out.real + out.imag) > 0:  # past the name of an axis
                near += (5 + self.scale * self.rise * out.imag) * out
            end = near + 6 * out
            self.sheet.line(near, end, layer="VIEW")
            self.sheet.line(end, end + 5 * view, layer="DIM")
            self.sheet.arrow(end + 5 * view, view)
            aside = 1.2j if view.imag else complex(-2.8, -1.75)
            self.sheet.text(end + aside, self.letter, 3.5, "centre")

    def _hole_datums(self) -> None:
        """Datums that are holes: that of a track's angle, and the one that others are placed from, unless a bore's detail has it."""
        if self.angle_hole is not None:
            self._hole_datum(self.angle_hole, self.angle_letter)
        if self.placed and (self.bored is None or self.origin != self.datum_letter):
            for hole in [hole for _, hole in self.named if hole.place == self.zero][:1]:
                self._hole_datum(hole, self.origin)

    def _origin(self) -> str:
        """Letter of the datum from which holes are placed."""
        name = self.zero_is.partition("hole ")[2]
        return self._letter_of(name) if name and abs(self.zero) > SAME_POINT else self.datum_letter

    def _letter_of(self, name: str) -> str:
        """Letter of the datum that a hole is: its name, or where that is a word the next that is free [ISO 5459]."""
        return name if len(name) <= _LETTERS else self._second

    def _hole_datum(self, hole: Hole, letter: str) -> None:
        """A datum at the edge of its hole, where paper is free."""
        import shapely

        ways = np.exp(0.25j * math.pi * np.arange(8))
        tips = self.paper(hole.place) + self.scale * hole.radius * ways
        ends = tips + 7.5 * ways  # middles of the letter's box
        boxes = shapely.box(ends.real - 3, ends.imag - 3, ends.real + 3, ends.imag + 3)
        obstacles = Obstacles()
        obstacles.add(self.sheet.primitives)
        met = obstacles.crossed(boxes) + 100 * ~obstacles.free(boxes) + ~obstacles.off_axes(boxes)
        k = int(np.argmin(met))
        datum(self.sheet, complex(tips[k]), complex(ways[k]), letter)

    def _upper_side(self) -> None:
        """UP, where whoever makes the part is to mark its upper side."""
        if self.part.to_mark:
            import shapely

            area = views.area(self.part.region, self.tolerance)
            origin = np.array([self.datum.real, self.datum.imag])
            face = shapely.transform(area, lambda points: self.scale * points + origin)
            mark = upper_mark(self.sheet, face, self.datum)
            self.sheet.things += [mark] if mark else []

    def _labels(self) -> None:
        """Names of holes and of what stands on the part, where paper is free, some with leaders."""
        labels = [
            self._named(label, hole) for label, hole in (*self.named, *self.standing.values())
        ]
        foot = self.sheet.height - 2 * _MARGIN - self._room(self.size_name)[1]
        area = (
            complex(_FILING + 1, _MARGIN + foot),
            complex(self.table_x - 1, self.sheet.height - _MARGIN - 1),
        )
        for each in callouts(labels, self.sheet, area):
            self.sheet.things += each.things

    def _named(self, label: str, hole: Hole) -> Label:
        """A label with its hole on paper."""
        rim = along([self.rims[hole].moved(self.scale, self.datum)])
        return Label(
            label,
            replace(hole, middle=self.paper(hole.middle), radius=self.scale * hole.radius),
            rim,
        )

    def _centre_lines(self) -> None:
        """Axes through the zero point across the whole part, crosses on round holes and other centres."""
        sheet = self.sheet
        over = 4.0
        zero = self.zero
        low = self.paper(self.low)
        high = self.paper(self.high)
        axes = (
            self.low.real <= zero.real <= self.high.real
            and self.low.imag <= zero.imag <= self.high.imag
        )
        if axes:
            x = self.paper(zero).real
            y = self.paper(zero).imag
            right = complex(high.real + over, y)
            top = complex(x, high.imag + over + self.scale * self.rise)
            sheet.line(complex(low.real - over, y), right, layer="CENTER")
            sheet.line(complex(x, low.imag - over), top, layer="CENTER")
            for end, way, name in ((right, 1, "X"), (top, 1j, "Y")) if self.turns else ():
                sheet.arrow(end + 3 * way, way)
                sheet.text(end + 1.5 + (1.5 if way == 1j else 1.5j), name, 2.5)
        radii = dict.fromkeys(self.part.centres, 1.0)
        circles = [
            as_circle(contour) for contour in (self.part.region.outer, *self.part.region.holes)
        ]
        radii |= {circle[0]: min(circle[1], 5 / self.scale + 1) for circle in circles if circle}
        for centre, radius in radii.items():
            if axes and abs(centre - zero) < 1e-9:
                continue
            at = self.paper(centre)
            reach = self.scale * radius + 2
            for direction in (1, 1j):
                sheet.line(at - reach * direction, at + reach * direction, layer="CENTER")

    def _rider(self, rider: Rider) -> None:
        """A follower where the cam has not turned, dashed, and beside it the way in which its displacement s grows."""
        sheet = self.sheet
        centre = self.paper(rider.centre)
        radius = self.scale * _tip(rider)
        if math.isinf(rider.radius):
            along = 1j * rider.normal * _FACE_SHOWN
            sheet.line(centre - along, centre + along, layer="HIDDEN")
            radius = _FACE_SHOWN
        elif radius:
            sheet.arc(centre, radius, 0.0, math.tau, "HIDDEN")
            for way in (rider.way, 1j * rider.way):
                sheet.line(centre - (radius + 2) * way, centre + (radius + 2) * way, layer="CENTER")
        side = 1j * rider.way
        tip = centre + (radius + 5) * side + 6 * rider.way
        sheet.line(tip - 10 * rider.way, tip, layer="DIM")
        sheet.arrow(tip, rider.way)
        sheet.text(tip + 2.5 * side - 1.2j, "s", 3.5, "centre")

    def _radii(self) -> None:
        """Least and greatest distance of a curve from the datum, or the diameter of a circle."""
        circle = as_circle(self.outer)
        if circle and (self.disc is None or abs(circle[1] - self.disc) > SAME_POINT):
            centre, radius = circle
            aside = cmath.exp(0.25j * math.pi)
            self._leader(centre + radius * aside, aside, f"Ø{number(2 * radius)}")
        if free(self.part.region.outer) and not self.facts.levels:
            ends = nearest_and_farthest(self.outer)
            ways = [(z / abs(z) if z else 1) for z in ends]
            disc = None if self.facts.profile_step_deg else round_of(self.part.region.outer)
            if disc and abs(disc[0]) + abs(disc[1] - abs(ends[1])) < SAME_POINT:
                said = f"R{number(disc[1])} {looser(self.facts.profile, True)}".rstrip()
                self._leader(ends[1], ways[1], said)
            else:
                for point, way, word in zip(ends, ways, ("smallest", "largest"), strict=True):
                    self._leader(point, way, f"(R{number(abs(point))}) {word}")
        for wheel in self.slotted:
            self._slots(wheel)

    def _slots(self, wheel: SlottedWheel) -> None:
        """Width, depth and spacing of a wheel's slots, its hollows and its rim; of those at the top, where one is upright."""
        sheet = self.sheet
        count = len(wheel.slots)
        off = looser(self.facts.profile)
        slot = max(wheel.slots, key=lambda z: round(z.imag, 6))
        way = slot / abs(slot)
        for middle in wheel.slots:
            along = middle / abs(middle)
            ends = middle - wheel.width * along, along * max(wheel.rim, abs(middle) + wheel.width)
            sheet.line(*map(self.paper, ends), layer="CENTER")
        sheet.arc(self.datum, self.scale * abs(slot), 0.0, math.tau, "CENTER")
        said = f"{count} × {number(wheel.width)} {off}".rstrip()
        if abs(way.real) < SAME_POINT:
            mouth = self.paper(1j * self.high.imag)
            half = self.scale * wheel.width / 2
            measure = Measure(wheel.width, f"{count} × ", off)
            self._dimension(mouth - half, mouth + half, 9j, measure)
            right = self.paper(self.high.real + 0j)
            deep = right + 1j * self.scale * abs(slot)
            self._dimension(right, deep, 9 + 0j, Measure(abs(slot)))
        else:
            side = slot + 0.5j * way * wheel.width
            self._leader(side + way, way, f"{said} wide, ends about R{number(abs(slot))}")
        hollow = max(
            wheel.hollows, key=lambda arc: round((arc.centre * (3 + 2j).conjugate()).real, 6)
        )
        away = hollow.centre / abs(hollow.centre)
        far = number(abs(hollow.centre))
        bottom = complex(hollow.at((hollow.t0 + hollow.t1) / 2, 0))
        said = f"{count} × R{number(hollow.radius)} {off}".rstrip()
        self._leader(bottom, away, f"{said} about R{far}")
        rim = cmath.rect(wheel.rim, cmath.phase(hollow.centre) - math.pi / count)
        rim *= cmath.exp(1j * (wheel.width / 2 + 1) / wheel.rim)
        self._leader(rim, rim / abs(rim), f"Ø{number(2 * wheel.rim)}")
        self._spacing(slot, count)

    def _spacing(self, slot: complex, count: int) -> None:
        """Angle from one of so many even slots to the next one, clockwise."""
        radius = 0.6 * self.scale * abs(slot)
        start = cmath.phase(slot)
        pitch = math.tau / count
        self.sheet.arc(self.datum, radius, start - pitch, pitch, "DIM")
        for angle, sense in ((start, 1), (start - pitch, -1)):
            turn = cmath.exp(1j * angle)
            lean = cmath.exp(-1j * sense * 1.5 / radius)  # an arrow's half on the arc
            self.sheet.arrow(self.datum + radius * turn, sense * 1j * turn * lean)
        said = self.datum + cmath.rect(radius + 3, start - pitch / 2) - 1.2j
        self.sheet.text(said, f"{count} × {number(360 / count)}°", 2.5, "centre")

    def _leader(self, point: complex, direction: complex, text: str) -> None:
        """Arrow from outside onto a point of the outline, with the text along it, aside from the overall sizes."""
        for size in (-1, -1j):
            aside = cmath.phase(direction / size)
            if abs(aside) < _ASIDE:
                direction = size * cmath.rect(1, math.copysign(_ASIDE, aside))

        def clear(way: complex) -> float:
            """Past what a flange shows, mm of paper."""
            beyond = (along(self.above) - point if self.above else np.zeros(1)) * way.conjugate()
            return self.scale * max(0.0, float(np.max(beyond.real)))

        self.sheet.things += leader(self.sheet, self.paper(point), direction, clear, text)

    def _turning(self) -> None:
        """Arc with an arrow outside the part: the positive sense, counter-clockwise, where paper is free, on a diagonal if it can."""
        import shapely

        ring = along([self.outer, *self.above])
        places = []
        strips = []
        for angle in _ARROWS.tolist():
            near: Floats = np.abs(np.angle(ring * cmath.exp(-1j * angle)))
            reach = float(np.max(np.abs(ring)[near < 0.5], initial=float(np.min(np.abs(ring)))))
            radius = self.scale * reach + 5
            half = min(0.4, 9 / radius)
            turned = angle + np.linspace(-half, half + 5 / radius, 9)  # with room for the sign
            arc = self.datum + radius * np.exp(1j * turned)
            places.append((angle, radius, half))
            strips.append(shapely.buffer(shapely.linestrings(coordinates(arc)), 2.0))
        right = complex(self.table_x, self.sheet.height - _MARGIN)
        obstacles = Obstacles((complex(_FILING, _MARGIN), right))
        obstacles.add(self.sheet.primitives)
        taken = ~obstacles.free(strips) | ~obstacles.within(strips)
        k = int(np.argmin(100 * taken + obstacles.crossed(strips) + ~obstacles.off_axes(strips)))
        angle, radius, half = places[k]
        self.sheet.arc(self.datum, radius, angle - half, 2 * half, "TEXT")
        tip = self.datum + cmath.rect(radius, angle + half)
        self.sheet.arrow(tip, 1j * cmath.exp(1j * (angle + half - 1.5 / radius)), "TEXT")
        sign = tip + 2.5j * cmath.exp(1j * (angle + half)) - 1.2j
        self.sheet.text(sign, "+", 3.5, "centre")

    def _side(self) -> None:
        """Edge view, heights growing to the right, with the thickness."""
        left = self.side_x
        origin = complex(left, self.datum.imag)
        if self.upright:
            self._cut(self.upright, origin, 1j)
            ends = self.paper(self.low).imag - 16, self.paper(self.high).imag + self._room_above - 6
            place = complex(left, ends[self.part.drum is not None])
            self.sheet.text(place, f"{self.letter}-{self.letter}", 3.5)
        else:
            self._edges_from_left(origin)
        self._boss_sizes(origin)
        if self.face_letter:
            end = min(self.part.layers, key=lambda layer: layer.z0).region.outer
            low = _FACE * extent([end])[0].imag
            datum(self.sheet, complex(left, self.paper(1j * low).imag), -1, self.face_letter)
        thick = self.scale * self.part.thickness
        if self.low.imag <= self.zero.imag <= self.high.imag:
            y = self.paper(self.zero).imag
            self.sheet.line(complex(left - 4, y), complex(left + thick + 4, y), layer="CENTER")
        bottom = self.paper(self.low).imag
        away = -9j if self.part.drum is None else -3j * _WALL
        self._dimension(
            complex(left, bottom), complex(left + thick, bottom), away, Measure(self.part.thickness)
        )
        if self.part.drum:
            self._walls(origin, self.part.drum)
            return
        heights = sorted({layer.z1 for layer in self.part.layers} - {self.part.thickness})
        heights = heights if len(heights) <= 2 else []  # no room for more; the table has them all
        for i, height in enumerate(heights, 1):
            top = complex(left, self.paper(self.high).imag)
            self._dimension(top, top + self.scale * height, 9j * i, Measure(height))

    def _edges_from_left(self, origin: complex) -> None:
        """The boxes of the layers and, dashed, of the bores in them; origin: of the part in this view, on paper."""
        for layer in self.part.layers:
            low, high = extent([fit_arcs(layer.region.outer, self.tolerance)])
            box = rectangle(complex(layer.z0, low.imag), complex(layer.z1, high.imag))
            self.sheet.contour(box.moved(self.scale, origin), "VIEW")
        for bore in () if self.plate else views.side_bores(self.part, self.tolerance):
            self.sheet.contour(bore.moved(self.scale, origin), "HIDDEN")
        for ends in self._chamfer_edges():
            self.sheet.line(*(origin + self.scale * end for end in ends), layer="HIDDEN")

    def _chamfer_edges(self) -> Iterator[tuple[complex, complex]]:
        """Edges of the bore's chamfers in the view from the left, z + iy, mm."""
        radius = (self.part.bore or 0.0) / 2
        c = self.chamfer
        high = self.part.thickness
        for end, inner in ((0.0, c), (high, high - c)) if c else ():
            for side in (-1, 1):
                yield complex(end, side * (radius + c)), complex(inner, side * radius)
            yield complex(inner, -radius), complex(inner, radius)

    def _walls(self, origin: complex, drum: Drum) -> None:
        """Diameter of a drum's floor in its section, and how far its walls are from its ends there; origin: of the part, on paper."""
        right = origin + self.scale * self.part.thickness
        half = 1j * self.scale * drum.floor
        away = complex(self.inner + _BOSS)
        self._dimension(right - half, right + half, away, Measure(2 * drum.floor, "Ø"))
        for side in (-1, 1):
            rim = origin + 1j * side * self.scale * drum.outside
            beta = np.array([side * math.pi / 2])
            levels = [wall.over(beta, np.array([drum.outside])).z.item() for wall in drum.walls]
            spans = [(0.0, levels[0]), (levels[-1], drum.length)][: len(levels)]
            for k, (low, high) in enumerate(spans, 1):
                ends = rim + self.scale * low, rim + self.scale * high
                self._dimension(*ends, 1j * side * k * _WALL, Measure(high - low, REFERENCE))

    def _boss_sizes(self, origin: complex) -> None:
        """Diameters of the bosses, to the right of the view from the left."""
        right = origin + self.scale * self.part.thickness
        for k, radius in enumerate(self.bosses, 1):
            half = 1j * self.scale * radius
            away = complex(self.inner + _BOSS * k)
            self._dimension(right - half, right + half, away, Measure(2 * radius, "Ø"))
        if self.inner:
            self._bore_size(right)

    def _bore_size(self, right: complex) -> None:
        """Diameter of a round bore with its fit, datum and roughness; right: its end in the view, on paper."""
        facts = self.facts
        size = self.part.bore or 0.0
        half = 0.5j * self.scale * size
        fit = in_limits(facts.bore_fit, size) if facts.bore_fit else ""
        self._dimension(right - half, right + half, complex(self.inner), Measure(size, "Ø", fit))
        foot = right + self.inner - half - (6j if 2 * half.imag < 12 else 0j)
        datum(self.sheet, foot, -1j, self.datum_letter)
        if facts.bore_roughness:
            roughness(self.sheet, right + half + 3, f"Ra {facts.bore_roughness:g}")

    def _cut(self, section: views.Section, origin: complex, turn: complex) -> None:
        """A section on paper: its faces hatched, and the edges behind it; turn: of the view, its z downwards before."""
        way = self.scale * turn
        for contour in views.contours_of(section.faces):
            self.sheet.contour(contour.moved(way, origin, mirror=True), "VIEW")
        hatching = views.hatching(section.faces, _HATCH / self.scale)
        for layer, lines in (("VIEW", section.beyond), ("HATCH", hatching)):
            for ends in lines:
                self.sheet.line(*(origin + way * z.conjugate() for z in ends), layer=layer)

    def _third(self) -> None:
        """The view from above or the section, heights z growing downwards."""
        top = complex(self.datum.real, self.paper(self.low).imag - _BELOW - _THIRD)
        for contour in self.beyond:
            self.sheet.contour(contour.moved(self.scale, top, mirror=True), "VIEW")
        for bore in views.above_bores(self.part, self.tolerance):
            self.sheet.contour(bore.moved(self.scale, top, mirror=True), "HIDDEN")
        if self.section:
            self._cut(self.section, top, 1)
            self.sheet.text(
                top + self.scale * self.low.real + 2.5j, f"{self.letter}-{self.letter}", 3.5
            )

    def _dimension(self, a: complex, b: complex, away: complex, measure: Measure) -> None:
        """A linear dimension of the views, or of a detail."""
        dimension(self.sheet, (a, b), away, measure, self.facts.tolerance)

    def _shape(self, hole: Hole) -> str:
        """What a hole is, with its fit; of a bore on whose shaft nothing else is known that of the spec."""
        fit = self.facts.bore_fit
        off = over_flat(self.facts)
        shape = self.facts.shape(hole)
        bore = hole.radius and self.part.bore and abs(hole.place) < SAME_POINT
        if fit and bore and shape == hole.shape:
            size, _, more = shape.partition(",")
            shape = f"{size} {fit},{more}" if more else f"{size} {in_limits(fit, 2 * hole.radius)}"
        return shape.replace(" over its", f" {off} over its") if off else shape

    def _rows(self) -> list[tuple[str, str, str, str]]:
        """Rows of the table of holes and edges."""
        places = [(label, h, h.place - self.zero) for label, h in self.named]
        digits = decimals(self.facts.position / 2) if self.placed else 3
        rows = [
            row
            for label, h, at in places
            for row in _two_lines(
                (label, number(at.real, digits), number(at.imag, digits), self._shape(h))
            )
        ]
        rows += [("", "", "", hole_of(track).shape) for track in self.tracks]
        names = {k: name for k, (name, _) in self.standing.items()}
        holes = [hole for _, hole in self.named]
        return rows + layer_rows(
            self.part, holes, self.tolerance, self.facts.shape, self.zero, names
        )

    def _radii_of_profile(self) -> list[tuple[float, float]]:
        """Angle, deg, and radius, mm, of a cam's outline or of a groove's wall; nothing of another part."""
        step = self.facts.profile_step_deg
        curves = [
            contour
            for contour in (self.part.region.outer, *self.part.region.holes)
            if free(contour)
        ]
        return views.polar_table(curves[0], step) if curves and step else []

    def _table(self) -> None:
        """Table of holes, at the upper right; rows that do not fit are counted in its last line; then that of a cam's radii."""
        top = self.sheet.height - _MARGIN
        room = self._lines_beside(self.size_name)
        width = sum(_TABLE_WIDTHS)
        table = self.track_table
        rows = self.rows
        room = room - (self._track_lines() if table else 0)
        if len(rows) > room:
            rows = [
                *rows[: room - 1],
                ("...", "", "", f"{len(rows) - room + 1} more: see {self.stem}.dxf"),
            ]
        if rows:
            head = ("Hole, pin" if self.standing else "Hole", "X", "Y", "Size")
            first = min(
                20.0,
                max(
                    _TABLE_WIDTHS[0], *(Text(0j, cell, 2.5).room + 2 for cell, *_ in (head, *rows))
                ),
            )
            widths = (first, *_TABLE_WIDTHS[1:3], sum(_TABLE_WIDTHS[::3]) - first)
            grid(self.sheet, complex(self.table_x, top), [head, *rows], widths, (1, 2))
        self.free = top - (len(rows) + 1 if rows else 0) * _ROW
        if table is None:
            return
        top -= (len(rows) + 2) * _ROW
        self.sheet.text(complex(self.table_x + 1.5, top + 1.3), table.title, room=width - 3)
        beside = table.beside(width)
        lines = [list(table.heads * beside), *table.lines(width)]
        numbers = range(len(table.heads) * beside)
        grid(self.sheet, complex(self.table_x, top), lines, table.widths * beside, numbers)
        self.free = top - len(lines) * _ROW

    def _lines_beside(self, size: str) -> int:
        """Rows that there is room for over the title block and a bore's detail."""
        detail = bore_detail.HEIGHT if self.detailed else 0.0
        return int((_SIZES[size][1] - 2 * _MARGIN - self.facts.height - detail) / _ROW) - 1

    def _track_lines(self) -> int:
        """Rows that a track's table takes, with its title and head."""
        return self.track_table.count(sum(_TABLE_WIDTHS)) + 2 if self.track_table else 0

    def _surface(self) -> None:
        """Tolerance and roughness of a cam's track: over the view, with a leader onto the track."""
        facts = self.facts
        if not self.surface:
            return
        datums = [letter for letter in (self.datum_letter, self.angle_letter) if letter]
        sheet = self.sheet
        middle = (self.low.real + self.high.real) / 2
        start = self.paper(complex(middle, self.high.imag)) + 4 + 1j * (self._room_above - _OVER)
        beside = [self.paper(each.centre).real + self.scale * _tip(each) for each in self.riders]
        start = complex(max([start.real, *(x + 5 for x in beside)]), start.imag)
        track = next(
            each for each in (self.part.region.outer, *self.part.region.holes) if free(each)
        )
        ring = along([fit_arcs(track, self.tolerance)]) * self.scale + self.datum
        upper = ring[ring.imag > self.datum.imag]
        tip = complex(upper[int(np.argmin(np.abs(upper.real - start.real)))])
        sheet.line(tip, start, layer="DIM")
        sheet.arrow(tip, (tip - start) / abs(tip - start))
        wide = 0.0
        if facts.roughness:
            wide = roughness(sheet, start + 3, f"Ra {facts.roughness:g}") + 5
        sheet.line(start, start + wide + 2, layer="DIM")
        if not facts.levels:
            all_round(sheet, start)
        several = len(self.track_tables) > 1
        end = start + wide + 2
        if facts.profile:
            corner = end - 1j * FRAME / 2
            end = line_profile(sheet, corner, facts.profile, datums, several) + 1j * FRAME / 2
        if several:
            sheet.text(end + 2 - 1.2j, "each track", 2.5)

    def _run_out(self) -> None:
        """Run-out of a cam's face at z = 0: to the left of it in the view from the left, where paper is free."""
        facts = self.facts
        if not (facts.run_out and self.turns and self.datum_letter):
            return
        import shapely

        face = min(self.part.layers, key=lambda layer: layer.z0).region
        low, high = extent([fit_arcs(face.outer, self.tolerance)])
        bore = max((abs(z.imag) for z in extent(self.holes)), default=0.0)
        levels = np.linspace(high.imag, low.imag, 32)[1:-1]
        levels = levels[np.abs(levels) > bore]
        wide = width_of([number(facts.run_out), self.datum_letter])
        left = self.side_x
        places = left - 5 - wide + 1j * (self.datum.imag + self.scale * levels - FRAME / 2)
        x = places.real
        y = places.imag
        boxes = shapely.box(x - 1, y - 1, x + wide + 4, y + FRAME + 1)
        obstacles = Obstacles()
        obstacles.add(self.sheet.primitives)
        met = obstacles.crossed(boxes) + 100 * ~obstacles.free(boxes) + ~obstacles.off_axes(boxes)
        corner = complex(places[int(np.argmin(met))])
        end = run_out(self.sheet, corner, facts.run_out, self.datum_letter) + 1j * FRAME / 2
        self.sheet.line(end, complex(left, end.imag), layer="DIM")
        self.sheet.arrow(complex(left, end.imag), 1)

    @property
    def _second(self) -> str:
        """Letter of the next datum that is no hole with a name: a keyway, a dowel's hole, a rim, a face."""
        names = {label[:1] for label, _ in self.named}
        taken = {*names, self.datum_letter, self.angle_letter, "I", "O"}
        return next(letter for letter in ascii_uppercase if letter not in taken)

    def _bore_detail(self) -> None:
        """A bore with a keyway or a flat by itself, under the tables."""
        if self.bored is None or not self.detailed:
            return
        letters = self.datum_letter, self.angle_letter
        low = complex(self.table_x, _MARGIN + self.facts.height)
        high = complex(self.sheet.width - _MARGIN, self.free)
        foot = complex(_FILING, _MARGIN)
        detail = BoreDetail(self.bored, self.facts, letters, self.scale, (low, high), foot)
        detail.draw(self.sheet, _SCALES)

    def _notes(self, tolerance: float) -> list[str]:
        part = self.part
        lines = []
        if self.zero_is and self.rows:
            lines.append(f"X and Y from {self.zero_is}")
        if self.zero:
            lines[-1] += (
                f", which in the part's files is at {number(self.zero.real)}, {number(self.zero.imag)}"
            )
        circle = as_circle(self.outer)
        if circle and abs(circle[0]) > 1e-9:
            x = circle[0].real
            y = circle[0].imag
            lines.append(f"Outline Ø{number(2 * circle[1])} about X {number(x)}, Y {number(y)}")
        if part.side_profile is not None:
            lines.append("Material is what lies within both outlines, along z and from above")
        if len(part.layers) > STACK:
            lines.append(f"{len(part.layers)} layers, see the STL")
        depths = sorted({number(layer.z1 - layer.z0) for layer in part.engraved})
        lines += [f"Engraved {depth} deep" for depth in depths]
        if part.outlined:
            curved = any(map(free, (part.region.outer, *part.region.holes)))
            exact = f"Profile: {self.stem}.dxf, within {tolerance:g} of the exact curve"
            lines.append(exact if curved else f"Outlines: {self.stem}.dxf")
        elif part.stacked:
            low, high = number(part.drawn.z0), number(part.drawn.z1)
            lines.append(f"Drawn thick: the layer z {low} to {high}; all outlines: {self.stem}.stl")
        elif self.facts.heights:
            path = f", the cutter's path: {self.stem}-path.csv" if self.facts.cutter else ""
            lines.append(f"Track: {self.stem}-developed.dxf{path}")
            lines.append(f"Z from the lower end, on the left in {self.letter}-{self.letter}")
        else:
            lines.append(f"The blank is drawn; its track: {self.stem}.stl")
        if self.own_tables:
            what = "Tables of the tracks" if len(self.own_tables) > 1 else "Table of the track"
            lines.append(f"{what}: {self.stem}-tracks-drawing.pdf")
        if self.turns:
            lines.append("+ : positive sense of turning (ccw)")
        if self.riders:
            lines.append("Dashed: the follower at cam angle 0; s: the way in which it rises")
        lines += [*self._shop_notes(), *part.notes]
        return [line for note in lines for line in _wrapped(note[:1].upper() + note[1:])]

    def _shop_notes(self) -> list[str]:
        """Notes on how the part is made."""
        lines = list[str]()
        facts = self.facts
        if self.chamfer:
            lines.append(f"Bore chamfered {number(self.chamfer)} × 45° at both ends")
        if self.plate:
            lines.append("All holes go through")
        fine = self._finer()
        if facts.roughness_elsewhere:
            where = f" but for the {fine}" if fine else ""
            lines.append(f"All faces{where} Ra {facts.roughness_elsewhere:g}")
        if self.rim_letter and facts.profile:
            form = "flat" if facts.levels else "round"
            fine_rim = f", Ra {facts.bore_roughness:g}" if facts.bore_roughness else ""
            lines.append(
                f"{self._rim} {self.rim_letter} {form} within {facts.profile / 2:g}{fine_rim}"
            )
        lines += [f"Edges {facts.edges}"] if facts.edges else []
        lines += [facts.heat_treatment] if facts.heat_treatment else []
        if facts.ground and fine:
            lines.append(f"{fine} ground after hardening; all sizes hold after it")
        if facts.thread:
            before = ", before hardening" if facts.ground else ""
            lines.append(
                f"Fit the walls on the back; drill and ream the dowel holes together{before}"
            )
            lines += [f"Threads {facts.thread} cut before hardening"] if facts.ground else []
        return lines

    @property
    def _rim(self) -> str:
        """What the datum is that is no hole."""
        return "lower side" if self.facts.levels else "rim"

    def _finer(self) -> str:
        """Faces that have a roughness of their own, such as "track and bore"."""
        facts = self.facts
        faces = (
            ("track", facts.roughness and self.track_tables),
            ("bore", facts.bore_roughness and self.bored),
            (self._rim, facts.bore_roughness and self.rim_letter),
        )
        return " and ".join(name for name, own in faces if own)

    def _note_lines(self) -> None:
        """Notes at the lower left, beside the title block, upwards."""
        for i, line in enumerate(reversed(self.notes)):
            self.sheet.text(complex(_FILING + 3, _MARGIN + 3 + 4.5 * i), line, 2.5, room=_NOTES)
        if self.placed:
            corner = complex(_FILING + 3.5, _MARGIN + 4 + 4.5 * len(self.notes))
            keyed_too = self.origin == self.datum_letter and self.key
            letters = (self.origin, self.angle_letter if keyed_too else "")
            datums = [letter for letter in letters if letter]
            end = position(self.sheet, corner, self.facts.position, datums)
            self.sheet.text(end + 2 + 1.8j, "round holes; X and Y are exact", room=58)
