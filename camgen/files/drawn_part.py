"""What the sheet of a part shows and says, before it has places on paper: contours, sections, names of holes, datums, tables."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

from camgen.files import bore_detail, seat_detail, views
from camgen.files.bore_detail import over_flat
from camgen.files.dimensions import (
    Hole,
    Places,
    bosses,
    flat_of,
    free,
    headed,
    hole_of,
    holes_of,
    hollow_radius,
    layer_rows,
    lock_of,
    number,
    round_of,
    slotted_wheel,
    standing_of,
    zero_of,
)
from camgen.files.limits import decimals, in_limits
from camgen.files.page import MARGIN, SIZES, TABLE_WIDTHS
from camgen.files.seat_detail import seat_of
from camgen.files.sheet import Text
from camgen.files.title_block import BLOCK, CORE, Facts
from camgen.files.track_tables import ROW, own_tables, relief_table, track_tables
from camgen.files.tracks import axial_section
from camgen.geometry.arcs import as_circle, fit_arcs
from camgen.geometry.outlines import Contour, extent
from camgen.parts.catalogue import CORE_HOLES
from camgen.parts.keyways import keyed
from camgen.parts.part import Layer, Part, SquareNote
from camgen.tolerances import SAME_POINT

_SMALLEST = 2.2  # height of text in a table, mm
_OUTSIDE = "h9"  # fit of a drum's outside: what passes it gets no nearer


class DrawnPart:
    """A part as its sheet shows it, mm, and the letters, rows and tables that go with it."""

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
        self.above = list[Contour]()
        self.hidden = views.plan_bores(part, tolerance)
        for layer in others:
            for contour in (layer.region.outer, *layer.region.holes):
                if not views.behind(part, layer, contour, tolerance):
                    self.above.append(fit_arcs(contour, tolerance))
                elif contour not in part.region.holes:
                    self.hidden.append(fit_arcs(contour, tolerance))
        self.beyond = (
            []
            if part.side_profile is None
            else views.from_above(part, part.side_profile, tolerance)
        )
        self.key = next(iter(filter(_about_axis, part.region.holes)), None)
        contours = (part.region.outer, *part.region.holes)
        self.slotted = list(filter(None, map(slotted_wheel, contours)))[:1]
        self.lock = None if facts.profile_step_deg or facts.levels else lock_of(part.region.outer)
        self.bored = self._bored()
        flat = self.bored is not None and flat_of(self.bored) is not None
        # a bore with a keyway or a flat is drawn by itself; a round one has its size in a view
        self.detail = self.bored if self.key or flat else None
        self.detailed = self.detail is not None
        self.seat = seat_of(part, facts)
        self.drum = part.drum if facts.heights else None
        self.outer_fit = facts.outer_fit or (_OUTSIDE if self.drum and facts.profile else "")
        self.turns = (free(part.region.outer) or self.drum is not None) and part.bore is not None
        self.turns = self.turns or bool(self.tracks and facts.tracks)
        bored = self.turns or self.bored or any(map(flat_of, part.region.holes))
        self.chamfer = facts.bore_chamfer if bored else 0.0
        layered = len({layer.region for layer in part.layers}) > 1
        plated = self.bored and (self.key or not layered)
        across = facts.groove is not None or part.drum or plated
        several = len(part.region.holes) - len(self.tracks) > 1
        self.plate = several and not layered and part.side_profile is None
        upright = _across_bore(part, tolerance) if across else None
        section = None if upright else views.section(part, tolerance)
        self.upright = self._tapped(self._chamfered(upright))
        if self.upright and part.drum:
            self.upright = axial_section(part.drum, self.upright)
        self.section = self._chamfered(section)
        self.riders = facts.riders if self.turns and len(facts.riders) == 1 else ()
        self.shank = headed(part)
        self.bosses = [self.shank] if self.shank else bosses(part)
        self.engraved = _contours(part.engraved, tolerance)
        self.rows = self._rows()
        self.polar = self._radii_of_profile()
        self.track_tables = track_tables(facts, self.polar, part.drum)
        alone = len(self.track_tables) == 1
        self.track_table = self.track_tables[0] if alone else None  # on the sheet itself
        full = self.track_lines() >= self.lines_beside("A3")
        self.track_table = None if full else self.track_table
        if self.lock:
            self.track_table = relief_table(self.lock[1], facts)
        self.cased = self._cased()
        self.own_tables = own_tables(facts, self.track_tables, full)
        radii = [hollow_radius(x.region.outer) for x in part.layers if free(x.region.outer)]
        self.hollow = min(
            [*radii, *(hollow_radius(x, inside=True) for x in self.tracks)], default=math.inf
        )
        self.surface = bool((self.polar or facts.levels) and (facts.profile or facts.roughness))
        self.angle_letter = ""
        self.datum_letter = ""
        self.origin = ""
        about_axis = (
            name for name, hole in self.named if hole.radius and abs(hole.place) < SAME_POINT
        )
        self.axis_label = next(about_axis, "")  # of the hole about the axis
        self.datum_letter = self._letter_of(self.axis_label) if self.axis_label else ""
        self.low, self.high = extent([self.outer, *self.above, *self.hidden])
        tops = [each.centre.imag + each.tip - self.high.imag for each in self.riders]
        self.rise = max([0.0, *tops])  # of a follower over the part, mm of the part
        self.disc = self._disc()
        # whether a hole is about the axis of a round part
        self.centred = self.disc is not None and not self.turns and bool(self.datum_letter)
        self.rim_letter = self._rim_letter()
        self.datum_letter = self.datum_letter or self.rim_letter
        self.angle_hole = self._angle_hole()
        angled = self.facts.profile and (self.key or self.angle_hole or flat)
        self.angle_letter = self._second if angled else ""
        self.origin = self._origin()
        squared = (note for note in part.notes if isinstance(note, SquareNote))
        self.square = next(squared, None)
        faced = self.square or (self.drum and facts.profile)
        self.face_letter = self._second if faced else ""
        self.letter = next(
            (c for c in "S Z W V U T R Q".split() if c not in {label for label, _ in self.named}),
            "S-S",
        )

    @property
    def rounded(self) -> bool:
        """Whether the table has the places and radii of the outline, from which its overall sizes follow."""
        texts = [text for *_, text in self.rows]
        edges = next((k for k, text in enumerate(texts) if text.startswith("Edges, z")), len(texts))
        return any(text.startswith("R") for text in texts[edges:])

    @property
    def datums(self) -> list[str]:
        """Letters to which a track refers: a bore, what holds its angle, a drum's end."""
        letters = (self.datum_letter, self.angle_letter, self.face_letter if self.drum else "")
        return [each for each in letters if each]

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

    def _cased(self) -> list[Contour]:
        """Contours beside which a thick chain line shows that they alone are case hardened; of several tracks none."""
        one = self.facts.case_only and len(self.track_tables) == 1 and not self.facts.levels
        if not one or self.drum:
            return []
        return [each for each in (self.part.region.outer, *self.tracks) if free(each)]

    def _tapped(self, section: views.Section | None) -> views.Section | None:
        """A section along y with the core hole of the part's thread."""
        tap = self.part.tap
        if section is None or tap is None:
            return section
        import shapely

        half = CORE_HOLES[tap.thread] / 2
        hole = shapely.box(tap.inner, tap.height - half, tap.outer, tap.height + half)
        return replace(section, faces=section.faces.difference(hole))

    def _bored(self) -> Contour | None:
        """The bore that is dimensioned: one with a keyway, or a round one to which a cam's track refers or the dowels that carry one,
        or with a flat, which holds a cam."""
        holes = self.part.region.holes
        flat = any(flat_of(hole) for hole in holes)
        located = self.facts.profile and (self.slotted or (flat and self.placed))
        tracked = free(self.part.region.outer) or self.part.drum or self.facts.dowel or located
        datum = (self.facts.profile or flat) and self.part.bore and tracked
        circles = [(hole, round_of(hole)) for hole in holes] if datum else []
        round_ones = [hole for hole, disc in circles if disc and abs(disc[0]) < SAME_POINT]
        return next(iter([*filter(_about_axis, holes), *round_ones]), None)

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
        track = self.facts.profile and (self.slotted or any(map(free, self.part.region.holes)))
        centred = self.disc is not None and abs(self.low + self.high) < SAME_POINT
        return self._second if centred and not self.datum_letter and (track or self.placed) else ""

    def _angle_hole(self) -> Hole | None:
        """The dowel's hole that is the datum of a track's angle, of a part without a keyway; of a plate with an edge its first hole, of a
        lock that without the shaft."""
        if self.facts.levels:
            return next((hole for _, hole in self.named if self.datum_letter and hole.radius), None)
        contours = (self.part.region.outer, *self.part.region.holes)
        if self.key or not (self.facts.profile and self.datum_letter and any(map(free, contours))):
            return None
        dowel = self.facts.dowel
        holes = (hole for _, hole in self.named if hole.radius and abs(hole.place) > SAME_POINT)
        if self.lock:
            return next(holes, None)
        return next((hole for hole in holes if abs(2 * hole.radius - dowel) < SAME_POINT), None)

    def _origin(self) -> str:
        """Letter of the datum from which holes are placed."""
        name = self.zero_is.partition("hole ")[2]
        return self._letter_of(name) if name and abs(self.zero) > SAME_POINT else self.datum_letter

    def _letter_of(self, name: str) -> str:
        """Letter of the datum that a hole is: its own where it is the only one of a part alone, or the next that is free; so neither of several
        is taken for the other."""
        own = len(self.named) == 1 and not self.facts.points and name in self.facts.datum_letters
        return name if own else self._second

    def _shape(self, hole: Hole) -> str:
        """What a hole is, with its fit; of a bore on whose shaft nothing else is known that of the spec."""
        fit = self.facts.bore_fit
        shape = self.facts.shape(hole)
        flats = filter(None, map(flat_of, self.part.region.holes))
        over = next((far for _, far in flats if number(far) in shape), 0.0)
        off = over_flat(self.facts, hole.radius, over) if over else ""
        bore = hole.radius and self.part.bore and abs(hole.place) < SAME_POINT
        if fit and bore and shape == hole.shape:
            size, _, more = shape.partition(",")
            shape = f"{size} {fit},{more}" if more else f"{size} {in_limits(fit, 2 * hole.radius)}"
        return shape.replace(" over its", f" {off} over its") if off else shape

    def _height(self, hole: Hole) -> str:
        """From where to where a hole goes, as ", z 3.4 to 6", where it is narrower or wider in other layers; "" of another hole."""
        in_line = [
            (other.radius, layer)
            for layer in self.part.layers
            for other in map(hole_of, layer.region.holes)
            if abs(other.place - hole.place) < SAME_POINT
        ]
        own = [layer for radius, layer in in_line if radius == hole.radius]
        if len(own) == len(in_line):
            return ""
        return (
            f", z {number(min(each.z0 for each in own))} to {number(max(each.z1 for each in own))}"
        )

    def _rows(self) -> list[tuple[str, str, str, str]]:
        """Rows of the table of holes and edges."""
        written = Places(self.zero, decimals(self.facts.position / 2) if self.placed else 3)
        rows = [
            row
            for label, hole in self.named
            for row in _on_lines(
                (label, *written.xy(hole.place), self._shape(hole) + self._height(hole))
            )
        ]
        rows += [("", "", "", hole_of(track).shape) for track in self.tracks]
        names = {k: name for k, (name, _) in self.standing.items()}
        holes = [hole for _, hole in self.named]
        return rows + layer_rows(
            self.part,
            holes,
            self.tolerance,
            self.facts.shape,
            written,
            names,
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

    def lines_beside(self, size: str) -> int:
        """Rows that there is room for over the title block and a bore's detail."""
        return int((SIZES[size][1] - 2 * MARGIN - BLOCK - self.details) / ROW) - 1

    @property
    def details(self) -> float:
        """Height of what is drawn by itself under the tables, mm of paper."""
        seat = seat_detail.HEIGHT if self.seat else 0.0
        return seat + (bore_detail.HEIGHT if self.detailed else 0.0)

    def track_lines(self) -> int:
        """Rows that a track's table takes, with its title and head."""
        return self.track_table.count(sum(TABLE_WIDTHS)) + 2 if self.track_table else 0

    @property
    def _second(self) -> str:
        """Letter of the next datum that is no hole with a name: a keyway, a dowel's hole, a rim, a face."""
        names = {label[:1] for label, _ in self.named}
        taken = {*names, self.datum_letter, self.angle_letter, self.origin}
        return next(each for each in self.facts.datum_letters if each not in taken)

    @property
    def threaded(self) -> bool:
        """Whether holes are cores of threads of a frame's screws, whose places need not be those of fits."""
        cores = any(fit.words.startswith(CORE) for fit in self.facts.fits)
        return cores and not self.facts.thread

    @property
    def rim_runs(self) -> bool:
        """Whether the rim of a round part may run out but little."""
        return bool(
            self.facts.run_out and self.centred and (self.facts.outer_fit or self.part.points)
        )

    @property
    def faces_run(self) -> bool:
        """Whether the faces of a round part or a wheel with slots may run out but little."""
        about = (self.centred and self.part.points) or (self.slotted and self.datum_letter)
        return bool(self.facts.run_out and about)


def _about_axis(contour: Contour) -> bool:
    """Whether a contour is a bore about the origin with a keyway."""
    key = keyed(contour)
    return key is not None and abs(key.centre) < SAME_POINT


def _on_lines(row: tuple[str, str, str, str]) -> list[tuple[str, str, str, str]]:
    """A row of the table of holes, on further lines what would make its last column's text small: a keyway, and what is behind the
    last comma."""
    size, comma, more = row[3].partition(", keyway ")
    if comma:
        more = f"keyway {more}"
    else:
        size, comma, more = row[3].rpartition(", ")
    if not comma or Text(0j, row[3], _SMALLEST).room <= TABLE_WIDTHS[3] - 2:
        return [row]
    return [*_on_lines((*row[:3], size)), ("", "", "", more)]


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
