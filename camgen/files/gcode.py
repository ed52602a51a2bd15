"""G-code of a sliced part, read back: the outer walls that a printer lays, layer by layer, as outlines of what is printed.

    wall      an unbroken run of moves in the plane that extrude, marked by the slicer as an outer wall
    outline   what the wall's bead reaches to: the wall's centre line, moved by half the line's width off the material

The marks are those of PrusaSlicer (its `;TYPE:External perimeter`, `;WIDTH:`) and of OrcaSlicer, Bambu Studio and CuraEngine,
which writes no width. A file without such marks is refused: where its outer walls are is anyone's guess.
"""

from __future__ import annotations

import math
import re
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

from camgen.bounds import bounded
from camgen.errors import FileError
from camgen.files.formats import READABLE
from camgen.geometry.rings import Floats, Points, Ring, fit_circle
from camgen.numerics import coordinates

_MARK = re.compile(r"; ?(?:TYPE|FEATURE):\s*(.*)")
_WIDTH = re.compile(r"; ?(?:WIDTH|LINE_WIDTH):\s*([\d.]+)")
_HEIGHT = re.compile(r"; ?(?:HEIGHT|LAYER_HEIGHT):\s*([\d.]+)")
_SETTING = re.compile(r"; (\w+) = (.*)")
_WORD = re.compile(r"([A-Z])\s*([-+]?(?:\d+\.?\d*|\.\d+))")
_PLAIN = re.compile(r"(?:[GXYZEFIJ]-?\d{0,4}\.?\d{1,9}(?: |$))+")  # as slicers write most moves
_OUTER = {"external perimeter", "outer wall", "wall-outer"}
# of outer and inner walls alike: one that is part of an outer loop counts
_OVERHANG = {"overhang perimeter", "overhang wall"}
_LONGEST = 1_000_000  # bytes of a line; thumbnails and settings in comments take thousands
_MOST_POINTS = 1_000_000  # of one wall
# outer walls of a file, and of one layer
_MOST_WALLS = 20_000
_MOST_BESIDE = 1_000
_MOVES = {("G", 0.0), ("G", 1.0), ("G", 2.0), ("G", 3.0)}
_EXPONENT = re.compile(r"[XYZIJ]\s*[-+]?[\d.]+E")  # no slicer writes one: a number that is damaged
# mm, of a line
_NARROWEST = 0.01
_WIDEST = 10.0
_FARTHEST = 1e5  # mm, from the bed's origin
_SEAM = 3.0  # line widths between the ends of a wall that is closed all the same
_SAME_LAYER = 1e-4  # mm of height
_SAME_WIDTH = 1e-4  # mm
_ROUND = 64  # chords of a quarter of a bead's end
_CHORDS = 1e-4  # mm, chord tolerance of arcs
_BORE = 0.03  # mm, by which a hole may differ from a circle and be the bore


@dataclass(frozen=True)
class Wall:
    """One outer wall, closed."""

    z: float  # top of its layer, mm
    ring: Ring  # centre line of the bead
    widths: Floats  # of the bead along each edge, (n,) mm, nan where nothing says it
    height: float = math.inf  # of the bead, mm, inf where nothing says it

    def edge(self, hole: bool, further: float = 0.0) -> Ring | None:
        """The edge of what is laid, counter-clockwise: the bead's outer side, or a hole's inner one, `further` off, mm.

        Round at corners of the centre line, as a bead is. None where nothing is left of a hole.
        """
        import shapely

        side = -1 if hole else 1
        halves = self.widths / 2 + further
        z = self.ring.facetted(_CHORDS)
        within = shapely.Polygon(coordinates(z))
        if np.ptp(halves) < _SAME_WIDTH:
            parts = shapely.get_parts(within.buffer(side * float(halves[0]), quad_segs=_ROUND))
        else:
            bead = shapely.union_all(
                [
                    shapely.LineString(coordinates(run)).buffer(half, quad_segs=_ROUND)
                    for run, half in self._runs(halves)
                ]
            )
            parts = shapely.get_parts(
                shapely.difference(within, bead) if hole else shapely.union(within, bead)
            )
        largest = max(parts, key=lambda part: float(part.area), default=None)
        if largest is None or largest.is_empty:  # nothing has one part, which is empty
            return None
        edge: Points = shapely.get_coordinates(largest.exterior)[:-1] @ np.array([1, 1j])
        return Ring.straight(edge).counter_clockwise()

    def _runs(self, halves: Floats) -> Iterator[tuple[Points, float]]:
        """The pieces of the centre line, (k,) points, along which the bead is as wide, and half of its width."""
        ends = self.ring.ends
        starts = [
            0,
            *(np.flatnonzero(np.abs(np.diff(halves)) >= _SAME_WIDTH) + 1).tolist(),
            len(halves),
        ]
        for a, b in zip(starts, starts[1:], strict=False):
            open_ring = Ring(
                np.append(self.ring.points[a:b], ends[b - 1]), np.append(self.ring.bulges[a:b], 0.0)
            )
            yield open_ring.facetted(_CHORDS), float(halves[a])


@dataclass
class _State:
    """What the lines so far have set."""

    # place of the nozzle and of the filament, mm
    x: float = 0.0
    y: float = 0.0
    z: float = 0.0
    e: float = 0.0
    scale: float = 1.0  # mm of a unit
    relative: bool = False  # whether moves count from the last
    relative_e: bool = False  # whether extrusion does
    marked: bool = False  # whether an outer wall was marked
    kind: str = ""  # of the line that is being laid, as the slicer names it
    width: float = math.nan  # of that line, mm
    height: float = math.inf  # of that line, mm
    # of the wall so far: its corners, the bulge and width of each edge, kinds of its lines, top and least height, mm
    points: list[complex] = field(default_factory=list)
    bulges: list[float] = field(default_factory=list)
    widths: list[float] = field(default_factory=list)
    kinds: set[str] = field(default_factory=set)
    level: float = 0.0
    thin: float = math.inf


def read_gcode(path: Path) -> list[Wall]:
    """All outer walls, from below; FileError where the file is binary, has no marks, nothing that is closed, or too much."""
    if path.suffix.lower() == ".bgcode":
        raise FileError(
            path,
            "is binary G-code: export it as text (PrusaSlicer: Printer Settings, General, no binary G-code)",
        )
    walls: list[Wall] = []
    state = _State()
    bounds = READABLE["gcode"].size
    try:
        bounded(path, bounds)
        for number, line in _lines(path):
            if len(state.points) > _MOST_POINTS:
                reason = f"has a wall of more than {_MOST_POINTS} moves, before line {number}"
                raise FileError(path, f"{reason}: is the file damaged?")
            if len(walls) > _MOST_WALLS:
                raise FileError(path, f"has more than {_MOST_WALLS:,} outer walls: {bounds.remedy}")
            if line.startswith(";"):
                _comment(path, state, line, number)
            else:
                walls += _command(path, state, line.partition(";")[0], number)
    except OSError as error:
        raise FileError(path, f"cannot be read: {error.strerror or error}") from None
    walls += _ended(state)
    if not state.marked:
        reason = "has no marks of outer walls (;TYPE:External perimeter and the like)"
        raise FileError(
            path,
            f"{reason}: slice with PrusaSlicer, OrcaSlicer, Bambu Studio or CuraEngine, with comments on",
        )
    if not walls:
        raise FileError(path, "has no outer wall that closes")
    level, count = Counter(wall.z for wall in walls).most_common(1)[0]
    if count > _MOST_BESIDE:
        reason = f"has {count:,} outer walls at a height of {level:g} mm"
        raise FileError(path, f"{reason}; at most {_MOST_BESIDE:,} are read: {bounds.remedy}")
    return walls


def _lines(path: Path) -> Iterator[tuple[int, str]]:
    """The lines of a file, by their number from 1; FileError where it is no text."""
    with open(path, "rb") as file:
        if file.read(4) == b"GCDE":
            raise FileError(
                path, "is binary G-code: export it as text (PrusaSlicer: Printer Settings, General)"
            )
        file.seek(0)
        for number, line in enumerate(iter(lambda: file.readline(_LONGEST), b""), 1):
            if b"\0" in line or len(line) == _LONGEST:
                reason = f"line {number} is no text, or has no end; G-code as text was expected"
                raise FileError(path, f"{reason}: is the file damaged?")
            yield number, line.decode("latin-1").strip()


def _comment(path: Path, state: _State, line: str, number: int) -> None:
    """Note what a comment of the slicer marks: a kind of line, a width or a height."""
    if mark := _MARK.match(line):
        state.kind = mark[1].strip().lower()
        state.marked |= state.kind in _OUTER
    elif width := _WIDTH.match(line):
        if not _NARROWEST <= _number(width[1]) <= _WIDEST:
            reason = f"line {number} says that its lines are {width[1]} mm wide"
            raise FileError(path, f"{reason}; {_NARROWEST:g} to {_WIDEST:g} was expected")
        state.width = float(width[1])
    elif height := _HEIGHT.match(line):
        tall = _number(height[1])
        state.height = tall if _NARROWEST <= tall <= _WIDEST else math.inf


def _number(text: str) -> float:
    """The number that a text is, or nan."""
    try:
        return float(text)
    except ValueError:
        return math.nan


def _command(path: Path, state: _State, text: str, line: int) -> Iterator[Wall]:
    """Do one line; walls that it ends. FileError where a move has something else than letters with numbers."""
    plain = _PLAIN.fullmatch(text) is not None
    if plain:
        words = {word[0]: float(word[1:]) for word in text.split()}
    else:
        words = {letter: float(value) for letter, value in _WORD.findall(text.upper())}
    if not words:
        return
    code = (next(iter(words)), next(iter(words.values())))
    if code in _MOVES and not plain:
        bare = re.sub(r"\(.*?\)", "", text.upper())
        odd = _WORD.sub("", bare).strip() or (
            exponent[0] if (exponent := _EXPONENT.search(bare)) else ""
        )
        far = [
            letter
            for letter in ("X", "Y", "Z", "I", "J")
            if not abs(words.get(letter, 0.0)) <= _FARTHEST
        ]
        if odd or far:
            fault = f"has {odd.split()[0]!r}" if odd else f"has {far[0]} beyond {_FARTHEST:g}"
            raise FileError(
                path,
                f"line {line} {fault}; a letter and a plain number each was expected: is the file damaged?",
            )
    match code:
        case ("G", 20.0) | ("G", 21.0):
            state.scale = 25.4 if code[1] == 20 else 1.0
        case ("G", 90.0) | ("G", 91.0):
            state.relative = state.relative_e = code[1] == 91
        case ("M", 82.0) | ("M", 83.0):
            state.relative_e = code[1] == 83
        case ("G", 92.0):
            for letter in "xyze":
                if letter.upper() in words:
                    setattr(state, letter, words[letter.upper()] * state.scale)
        case ("G", 0.0) | ("G", 1.0) | ("G", 2.0) | ("G", 3.0):
            yield from _moved(path, state, int(code[1]), words)


def _moved(path: Path, state: _State, code: int, words: dict[str, float]) -> Iterator[Wall]:
    """A move: part of a wall, or the end of one."""
    start = complex(state.x, state.y)
    for letter in "xyz":
        if letter.upper() in words:
            value = words[letter.upper()] * state.scale
            setattr(state, letter, value + (getattr(state, letter) if state.relative else 0.0))
    extrusion = 0.0
    if "E" in words:
        value = words["E"] * state.scale
        extrusion = value if state.relative_e else value - state.e
        state.e += extrusion
    end = complex(state.x, state.y)
    outer = state.kind in _OUTER or state.kind in _OVERHANG
    if not (extrusion > 0 and outer and end != start):
        if end != start or "Z" in words or extrusion < 0:
            yield from _ended(state)
        return
    if not state.points:
        state.points.append(start)
        state.level = state.z
        state.thin = math.inf
    state.thin = min(state.thin, state.height)  # a bridge is as high as the nozzle is wide
    bulge = 0.0
    if code in (2, 3):
        if "I" not in words and "J" not in words:
            raise FileError(
                path,
                "has arcs by radius (R) in a wall; arcs by their centre (I, J) or none were expected",
            )
        centre = start + complex(words.get("I", 0.0), words.get("J", 0.0)) * state.scale
        if (
            abs(start - centre) < _NARROWEST
            or abs(abs(end - centre) - abs(start - centre)) > _WIDEST / 10
        ):
            raise FileError(
                path,
                f"has an arc at X {end.real:g}, Y {end.imag:g} whose centre does not fit its ends",
            )
        turn = float(np.angle((end - centre) / (start - centre))) % math.tau
        bulge = math.tan((turn if code == 3 else turn - math.tau) / 4)
    state.points.append(end)
    state.bulges.append(bulge)
    state.widths.append(state.width)
    state.kinds.add(state.kind)


def _ended(state: _State) -> Iterator[Wall]:
    """The wall that the run so far makes, if it is an outer one and closes."""
    points = state.points
    bulges = state.bulges
    widths = state.widths
    kinds = state.kinds
    state.points = []
    state.bulges = []
    state.widths = []
    state.kinds = set()
    if len(points) < (3 if any(bulges) else 4) or not kinds & _OUTER:  # two arcs close a circle
        return
    gap = abs(points[-1] - points[0])
    if gap > _SEAM * (widths[-1] if math.isfinite(widths[-1]) else 0.4):
        return
    if gap < 1e-9:
        points = points[:-1]
    else:  # the seam is closed straight
        bulges = [*bulges, 0.0]
        widths = [*widths, widths[-1]]
    yield Wall(state.level, Ring(np.array(points), np.array(bulges)), np.array(widths), state.thin)


def read_settings(path: Path) -> dict[str, str]:
    """What the slicer says of its settings in comments, `; key = value` (PrusaSlicer, OrcaSlicer, Bambu Studio)."""
    with open(path, "rb") as file:
        lines = (raw.decode("latin-1") for raw in file if raw.startswith(b"; "))
        return {match[1]: match[2].strip() for line in lines if (match := _SETTING.match(line))}


def with_width(walls: Sequence[Wall], path: Path, line_width: float | None) -> list[Wall]:
    """The walls, as wide as is said where the file does not say it; FileError where nothing does."""
    if line_width is None and any(np.isnan(wall.widths).any() for wall in walls):
        raise FileError(
            path,
            "does not say how wide its lines are (CuraEngine does not): give it with --line-width, mm",
        )
    return [
        replace(wall, widths=np.where(np.isnan(wall.widths), line_width or 0.0, wall.widths))
        for wall in walls
    ]


def hole_walls(walls: Sequence[Wall]) -> list[bool]:
    """Which walls of one layer are those of holes: they lie in an odd number of others."""
    import shapely

    flat = [
        shapely.Polygon(coordinates(z)) for z in (wall.ring.facetted(_CHORDS) for wall in walls)
    ]
    areas = shapely.area(flat)
    starts = [shapely.Point(wall.ring.points[0].real, wall.ring.points[0].imag) for wall in walls]
    inner, outer = shapely.STRtree(flat).query(starts, predicate="within")
    inner = inner[areas[outer] > areas[inner]]
    return [count % 2 == 1 for count in np.bincount(inner, minlength=len(walls)).tolist()]


def printed_outlines(
    path: Path, height: float | None = None, line_width: float | None = None
) -> tuple[list[Ring], str]:
    """Outlines of the layer at a height over the bed, mm (half way up), and a sentence on the reading.

    The frame's origin is put in the middle of the round hole nearest the middle of the part, which is taken for the bore, or
    else left where the printer has it. line_width: mm, where the file does not say it. FileError as `read_gcode`, and where
    no width is known.
    """
    walls = read_gcode(path)
    tops = sorted({round(wall.z, 4) for wall in walls})
    level = tops[-1] / 2 if height is None else height
    if not 0 <= level <= tops[-1] + 1e-9:
        raise FileError(
            path, f"has no layer {level:g} mm over the bed; its highest one ends at {tops[-1]:g}"
        )
    top = next(z for z in tops if z >= level - _SAME_LAYER)
    layer = [wall for wall in walls if abs(wall.z - top) <= _SAME_LAYER]
    layer = with_width(layer, path, line_width)
    holes = hole_walls(layer)
    edges = [wall.edge(hole) for wall, hole in zip(layer, holes, strict=True)]
    rings = [edge for edge in edges if edge is not None]
    holes = [hole for hole, edge in zip(holes, edges, strict=True) if edge is not None]
    widths = np.concatenate([wall.widths for wall in layer])
    wide = f"{widths.min():g}" + (f" to {widths.max():g}" if np.ptp(widths) >= _SAME_WIDTH else "")
    remark = f"layer {tops.index(top) + 1} of {len(tops)}, up to {top:g} mm: {len(layer)} outer walls, lines {wide} mm wide"
    bore = _bore(
        *(
            [ring for ring, hole in zip(rings, holes, strict=True) if hole == empty]
            for empty in (True, False)
        )
    )
    if bore is None:
        return rings, f"{remark}; no round hole, so places are the printer's"
    centre, diameter = bore
    remark += f"; the origin is in the middle of the hole of diameter {diameter:.3f} mm at X {centre.real:.3f}, Y {centre.imag:.3f}"
    return [ring.moved(shift=-centre) for ring in rings], remark


def _inside(ring: Ring, other: Ring) -> bool:
    return abs(other.area) > abs(ring.area) and other.encloses(complex(ring.points[0]))


def _bore(holes: Sequence[Ring], outers: Sequence[Ring]) -> tuple[complex, float] | None:
    """Centre and diameter of the round hole nearest the middle of the largest outline."""
    if not outers:
        return None
    outer = max(outers, key=lambda ring: abs(ring.area))
    fits = [fit_circle(hole.points) for hole in holes if _inside(hole, outer)]
    round_ones = [(centre, 2 * radius) for centre, radius, off in fits if off <= _BORE]
    return min(round_ones, key=lambda each: abs(each[0] - outer.centroid), default=None)
