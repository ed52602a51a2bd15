"""G-code of a sliced part, read back: the outer walls that a printer lays, layer by layer, as outlines of what is printed.

    wall      an unbroken run of moves in the plane that extrude, marked by the slicer as an outer wall
    outline   what the wall's bead reaches to: the wall's centre line, moved by half the line's width off the material

The marks are those of PrusaSlicer (its `;TYPE:External perimeter`, `;WIDTH:`) and of OrcaSlicer, Bambu Studio and CuraEngine,
which writes no width. A file without such marks is refused: where its outer walls are is anyone's guess.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from camgen.errors import FileError
from camgen.geometry.rings import Points, Ring, fit_circle

_MARK = re.compile(r"; ?(?:TYPE|FEATURE):\s*(.*)")
_WIDTH = re.compile(r"; ?(?:WIDTH|LINE_WIDTH):\s*([\d.]+)")
_WORD = re.compile(r"([A-Z])\s*([-+]?(?:\d+\.?\d*|\.\d+))")
_OUTER = {"external perimeter", "outer wall", "wall-outer"}
_OVERHANG = {"overhang perimeter", "overhang wall"}  # of outer and inner walls alike: one that is part of an outer loop counts
_MOST_MOVES = 20_000_000
_MOVES = {("G", 0.0), ("G", 1.0), ("G", 2.0), ("G", 3.0)}
_EXPONENT = re.compile(r"[XYZIJ]\s*[-+]?[\d.]+E")  # no slicer writes one: a number that is damaged
_NARROWEST, _WIDEST = 0.01, 10.0  # mm, of a line
_FARTHEST = 1e5  # mm, from the bed's origin
_SEAM = 3.0  # line widths between the ends of a wall that is closed all the same
_SAME_LAYER = 1e-4  # mm of height
_ROUND = 64  # chords of a quarter of a bead's end
_CHORDS = 1e-4  # mm, chord tolerance of arcs
_BORE = 0.03  # mm, by which a hole may differ from a circle and be the bore


@dataclass(frozen=True)
class Wall:
    """The centre line of one outer wall, closed; height of its layer and width of its line, mm (nan where nothing says it)."""

    z: float
    width: float
    ring: Ring


@dataclass
class _State:
    """What the lines so far have set: place, mm; whether moves and extrusion count from the last; what is being laid."""

    x: float = 0.0
    y: float = 0.0
    z: float = 0.0
    e: float = 0.0
    scale: float = 1.0
    relative: bool = False
    relative_e: bool = False
    kind: str = ""
    width: float = math.nan
    points: list[complex] = field(default_factory=list)
    bulges: list[float] = field(default_factory=list)
    kinds: set[str] = field(default_factory=set)


def read_gcode(path: Path) -> list[Wall]:
    """All outer walls, from below; FileError where the file is binary, has no marks, or nothing that is closed."""
    if path.suffix.lower() == ".bgcode":
        raise FileError(path, "is binary G-code: export it as text (PrusaSlicer: Printer Settings, General, no binary G-code)")
    walls: list[Wall] = []
    state, marked = _State(), False
    try:
        with open(path, "rb") as file:
            if file.read(4) == b"GCDE":
                raise FileError(path, "is binary G-code: export it as text (PrusaSlicer: Printer Settings, General)")
            file.seek(0)
            for number, raw in enumerate(file):
                if number > _MOST_MOVES:
                    raise FileError(path, f"has more than {_MOST_MOVES} lines")
                line = raw.decode("latin-1").strip()
                if line.startswith(";"):
                    mark, width = _MARK.match(line), _WIDTH.match(line)
                    if mark:
                        state.kind = mark[1].strip().lower()
                        marked |= state.kind in _OUTER
                    elif width:
                        if not _NARROWEST <= _number(width[1]) <= _WIDEST:
                            said = f"line {number + 1} says that its lines are {width[1]} mm wide"
                            raise FileError(path, f"{said}; {_NARROWEST:g} to {_WIDEST:g} was expected")
                        if state.width != float(width[1]):
                            walls += _ended(state)
                        state.width = float(width[1])
                    continue
                walls += _command(path, state, line.partition(";")[0], number + 1)
    except OSError as error:
        raise FileError(path, f"cannot be read: {error.strerror or error}") from None
    walls += _ended(state)
    if not marked:
        said = "has no marks of outer walls (;TYPE:External perimeter and the like)"
        raise FileError(path, f"{said}: slice with PrusaSlicer, OrcaSlicer, Bambu Studio or CuraEngine, with comments on")
    if not walls:
        raise FileError(path, "has no outer wall that closes")
    return walls


def _number(text: str) -> float:
    """The number that a text is, or nan."""
    try:
        return float(text)
    except ValueError:
        return math.nan


def _command(path: Path, state: _State, text: str, line: int) -> Iterator[Wall]:
    """Do one line; walls that it ends. FileError where a move has something else than letters with numbers."""
    words = dict((letter, float(value)) for letter, value in _WORD.findall(text.upper()))
    if not words:
        return
    code = (next(iter(words)), next(iter(words.values())))
    if code in _MOVES:
        bare = re.sub(r"\(.*?\)", "", text.upper())
        odd = _WORD.sub("", bare).strip() or (found[0] if (found := _EXPONENT.search(bare)) else "")
        far = [letter for letter in ("X", "Y", "Z", "I", "J") if not abs(words.get(letter, 0.0)) <= _FARTHEST]
        if odd or far:
            said = f"has {odd.split()[0]!r}" if odd else f"has {far[0]} beyond {_FARTHEST:g}"
            raise FileError(path, f"line {line} {said}; a letter and a plain number each was expected: is the file damaged?")
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
    laid = 0.0
    if "E" in words:
        value = words["E"] * state.scale
        laid = value if state.relative_e else value - state.e
        state.e += laid
    end = complex(state.x, state.y)
    outer = state.kind in _OUTER or state.kind in _OVERHANG
    if not (laid > 0 and outer and end != start):
        if end != start or "Z" in words or laid < 0:
            yield from _ended(state)
        return
    if not state.points:
        state.points.append(start)
    bulge = 0.0
    if code in (2, 3):
        if "I" not in words and "J" not in words:
            raise FileError(path, "has arcs by radius (R) in a wall; arcs by their centre (I, J) or none were expected")
        centre = start + complex(words.get("I", 0.0), words.get("J", 0.0)) * state.scale
        if abs(start - centre) < _NARROWEST or abs(abs(end - centre) - abs(start - centre)) > _WIDEST / 10:
            raise FileError(path, f"has an arc at X {end.real:g}, Y {end.imag:g} whose centre does not fit its ends")
        turn = float(np.angle((end - centre) / (start - centre))) % math.tau
        bulge = math.tan((turn if code == 3 else turn - math.tau) / 4)
    state.points.append(end)
    state.bulges.append(bulge)
    state.kinds.add(state.kind)


def _ended(state: _State) -> Iterator[Wall]:
    """The wall that the run so far makes, if it is an outer one and closes."""
    points, bulges, kinds = state.points, state.bulges, state.kinds
    state.points, state.bulges, state.kinds = [], [], set()
    if len(points) < (3 if any(bulges) else 4) or not kinds & _OUTER:  # two arcs close a circle
        return
    width = state.width if math.isfinite(state.width) else 0.4
    if abs(points[-1] - points[0]) > _SEAM * width:
        return
    closed = abs(points[-1] - points[0]) < 1e-9
    ring = Ring(np.array(points[:-1] if closed else points), np.array(bulges if closed else [*bulges, 0.0]))
    yield Wall(state.z, state.width, ring)


def printed_outlines(path: Path, height: float | None = None, line_width: float | None = None) -> tuple[list[Ring], str]:
    """Outlines of the layer at a height over the bed, mm (half way up), and a sentence on the reading.

    The frame's origin is put in the middle of the round hole nearest the middle of the part, which is taken for the bore, or
    else left where the printer has it. line_width: mm, where the file does not say it. FileError as `read_gcode`, and where
    no width is known.
    """
    walls = read_gcode(path)
    tops = sorted({round(wall.z, 4) for wall in walls})
    wanted = tops[-1] / 2 if height is None else height
    if not 0 <= wanted <= tops[-1] + 1e-9:
        raise FileError(path, f"has no layer {wanted:g} mm over the bed; its highest one ends at {tops[-1]:g}")
    top = next(z for z in tops if z >= wanted - _SAME_LAYER)
    here = [wall for wall in walls if abs(wall.z - top) <= _SAME_LAYER]
    widths = [wall.width if math.isfinite(wall.width) else line_width for wall in here]
    if any(width is None for width in widths):
        raise FileError(path, "does not say how wide its lines are (CuraEngine does not): give it with --line-width, mm")
    holes = [sum(_inside(wall.ring, other.ring) for other in here if other is not wall) % 2 == 1 for wall in here]
    rings = [_reach(wall.ring, (-1 if hole else 1) * float(width or 0) / 2) for wall, hole, width in
             zip(here, holes, widths, strict=True)]  # fmt: skip
    said = f"layer {tops.index(top) + 1} of {len(tops)}, up to {top:g} mm: {len(here)} outer walls, lines "
    said += f"{min(w for w in widths if w is not None):g} mm wide"
    bore = _bore(*([ring for ring, hole in zip(rings, holes, strict=True) if hole == empty] for empty in (True, False)))
    if bore is None:
        return rings, f"{said}; no round hole, so places are the printer's"
    centre, diameter = bore
    said += f"; the origin is in the middle of the hole of diameter {diameter:.3f} mm at X {centre.real:.3f}, Y {centre.imag:.3f}"
    return [ring.moved(shift=-centre) for ring in rings], said


def _inside(ring: Ring, other: Ring) -> bool:
    return abs(other.area) > abs(ring.area) and other.encloses(complex(ring.points[0]))


def _reach(ring: Ring, distance: float) -> Ring:
    """The edge of a bead whose centre line a ring is: moved outwards by a distance, mm (< 0: inwards), round its corners."""
    import shapely

    z = ring.facetted(_CHORDS)
    parts = shapely.get_parts(shapely.Polygon(np.column_stack([z.real, z.imag])).buffer(distance, quad_segs=_ROUND))
    largest = max(parts, key=lambda part: float(part.area))
    edge: Points = shapely.get_coordinates(largest.exterior)[:-1] @ np.array([1, 1j])
    return Ring(edge, np.zeros(len(edge))).counter_clockwise()


def _bore(holes: Sequence[Ring], outers: Sequence[Ring]) -> tuple[complex, float] | None:
    """Centre and diameter of the round hole nearest the middle of the largest outline."""
    if not outers:
        return None
    outer = max(outers, key=lambda ring: abs(ring.area))
    fits = [fit_circle(hole.points) for hole in holes if _inside(hole, outer)]
    round_ones = [(centre, 2 * radius) for centre, radius, off in fits if off <= _BORE]
    return min(round_ones, key=lambda each: abs(each[0] - outer.centroid), default=None)
