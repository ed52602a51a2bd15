"""What a sheet shows of a track: a drum cut along its axis, its track unrolled, and a section of a groove.

The development lies on the cylinder half way along the roller, as seen from outside the drum: polar angles, counter-clockwise
from X as seen from above, run to the right, heights upwards. Angles by which a drum has turned stand where its roller then is.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from camgen.files import views
from camgen.files.dimensions import number
from camgen.files.labels import Obstacles
from camgen.files.measures import REFERENCE, Measure, dimension
from camgen.files.page import BESIDE_CASE
from camgen.files.sheet import Sheet
from camgen.files.symbols import FRAME, line_profile, roughness
from camgen.files.title_block import Facts, Groove, ratio
from camgen.geometry.drums import Drum
from camgen.geometry.outlines import Floats, Points
from camgen.numerics import coordinates
from camgen.tolerances import SAME_POINT

_POINTS = 721  # of a curve round a drum
_RADII = 13  # from the floor of a track to the outside
_RIM = 361  # points of half a rim
_DEPTHS = 40  # at which something may hide them
_STEP = 0.02  # mm, that a rim lies off what would hide it
_HIGH = 60.0  # of an unrolled drum, at most, mm of paper
_LEFT = 16.0  # room for the numbers of heights beside it
_RIGHT = 12.0
_BELOW = 14.0  # for those of angles
_NAMES = 8.0  # for names of segments above it
_FRAME = 12.0  # for the tolerance of its walls above these
_TITLE = 9.0
_STEPS = (30, 60, 90, 180)  # deg, between two angles
_WIDE = 11.0  # room of one
_ROUND = 0.6  # of the track's height: what is shown of the drum on either side of it
_SMALL = 2.5  # height of text
_APART = 2.9  # of two numbers, one above the other
_HEIGHTS = (1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 200.0)  # mm, from one number to the next
_HATCH = 2.0
_MATERIAL = 7.0  # mm of paper, of the material round a track that its section shows
_SECTION = 30.0  # a track in its section, at most
SECTION_ROOM = 124 + 62j  # width and height of a section with its words, mm of paper
_WORDS = 54.0  # width of the words
_ASIDE = 14.0  # from a track to the dimension of its width
_OFF = 9.0  # from there to its dimensions
_OF_GAP = 0.4  # between a track's floor and its roller, by which the floor may be deeper


# ---- section along the axis ------------------------------------------------------------------------------------------


def axial_section(drum: Drum, blank: views.Section) -> views.Section:
    """A drum cut along its axis: what a cut of its blank meets, y + iz in mm as in the view from the left, less its track;
    and the rims of the track that are seen behind it, at +x."""
    import shapely

    faces = blank.faces
    for side in (-1, 1):
        radii = np.linspace(drum.floor, drum.outside, _RADII)
        walls = [wall.over(np.full(_RADII, side * math.pi / 2), radii).z for wall in drum.walls]
        bottom = np.full(_RADII, -1.0)
        top = np.full(_RADII, drum.length + 1.0)
        gap: list[tuple[Floats, Floats]] = {
            "groove": [(walls[0], walls[-1])],
            "rib": [(bottom, walls[0]), (walls[-1], top)],
            "end": [(walls[0], top)],
        }[drum.track]
        for low, high in gap:
            rim = np.concatenate([radii + 1j * low, (radii + 1j * high)[::-1]])
            faces = faces.difference(shapely.Polygon(coordinates(side * rim.real + 1j * rim.imag)))
    beyond = [*blank.beyond]
    for line in _rims_behind(drum):
        beyond += zip(line[:-1].tolist(), line[1:].tolist(), strict=True)
    return replace(blank, faces=faces, beyond=beyond)


def _rims_behind(drum: Drum) -> Iterator[Points]:
    """Rims of its walls at +x that are seen along x from the plane of its axis, y + iz, mm."""
    beta = np.linspace(-math.pi / 2, math.pi / 2, _RIM)
    for reach in (drum.outside,) if drum.pocket is None else (drum.outside, drum.floor):
        y = reach * np.sin(beta)
        x = reach * np.cos(beta) * (np.arange(_DEPTHS) / _DEPTHS)[:, None]
        radius = np.hypot(x, y)
        around = np.arctan2(y, x)
        walls = [wall.over(around, np.maximum(radius, drum.floor)).z for wall in drum.walls]
        for wall in drum.walls:
            z = wall.over(beta, np.full(_RIM, reach)).z
            low, high = walls[0], walls[-1]
            free = {
                "groove": (z > low - _STEP) & (z < high + _STEP),
                "rib": (z < low + _STEP) | (z > high - _STEP),
                "end": z > low - _STEP,
            }[drum.track]
            core = radius < drum.floor - SAME_POINT
            free[core] = False if drum.pocket is None else (z > drum.pocket + 0 * x)[core]
            runs = _runs(y + 1j * z, np.all(free, axis=0))
            yield from (run for run in runs if abs(run[-1] - run[0]) > 10 * _STEP)


def _runs(points: Points, seen: NDArray[np.bool_]) -> Iterator[Points]:
    """Stretches of a line that are seen."""
    change = np.flatnonzero(np.diff(np.concatenate([[0], seen.astype(int), [0]])))
    for a, b in zip(change[::2], change[1::2], strict=True):
        if b - a > 1:
            yield points[a:b]


# ---- development -----------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Development:
    """A drum's track unrolled; scale: mm of paper for a mm; datums: letters to which the tolerance of its walls refers."""

    drum: Drum
    facts: Facts
    scale: float
    datums: Sequence[str]

    @property
    def around(self) -> float:
        """Once round the drum, mm of paper."""
        return math.tau * self.drum.roller.middle * self.scale

    @property
    def high(self) -> float:
        """Of what is shown of the drum, mm of paper."""
        low, high = shown(self.drum)
        return (high - low) * self.scale

    @property
    def framed(self) -> bool:
        """Whether something is said of its walls."""
        return bool(self.facts.profile or self.facts.roughness)

    @property
    def room(self) -> float:
        """Height that it takes with all that stands round it, mm of paper."""
        return _BELOW + self.high + _NAMES + _FRAME * self.framed + _TITLE

    def angle(self, turned: Floats) -> Floats:
        """Polar angle of the roller after the drum has turned by so much, (n,) deg, not reduced to one turn."""
        phi = -np.radians(turned) * self.facts.sense
        aside = np.arctan2(self.drum.path.beside(phi, 0), self.drum.roller.middle)
        return np.asarray(np.degrees(phi + aside))

    def draw(self, sheet: Sheet, corner: complex) -> None:
        """Draw it, the lower left corner of its room there."""
        foot = corner + complex(_LEFT, _BELOW)
        self._track(sheet, foot)
        self._angles(sheet, foot)
        self._heights(sheet, foot)
        names = self._segments(sheet, foot + 1j * self.high)
        if self.framed:
            self._walls(sheet, foot, names)
        title = f"Track unrolled, seen from outside, on Ø{number(2 * self.drum.roller.middle)}"
        over = corner + 3 + 1j * (self.room - _TITLE + 3)
        sheet.text(over, f"{title} ({ratio(self.scale)})", 3.5)

    def _track(self, sheet: Sheet, foot: complex) -> None:
        """Ends of the drum, walls and the way of the roller's axis, of a rib of the middle between both."""
        for end in shown(self.drum):
            layer = "VIEW" if end in (0.0, self.drum.length) else "DIM"
            sheet.line(*self._on(foot, np.full(2, end)), layer=layer)
        for x in (0.0, self.around):
            sheet.line(foot + x, foot + x + 1j * self.high, layer="DIM")
        for z in self._walls_z:
            sheet.line(*self._on(foot, z), layer="WALL")
        z = self._axis
        for line in _runs(np.array(self._on(foot, z), complex), (z > 0) & (z < self.drum.length)):
            sheet.line(*line.tolist(), layer="CENTER")

    def _on(self, foot: complex, z: Floats) -> list[complex]:
        """Heights over the whole turn on paper."""
        across = np.linspace(0, self.around, len(z))
        up = self.scale * (z - shown(self.drum)[0])
        points: list[complex] = (foot + across + 1j * up).tolist()
        return points

    @cached_property
    def _walls_z(self) -> list[Floats]:
        """Heights of the walls over the turn."""
        beta = np.linspace(0, math.tau, _POINTS)
        radius = np.array(self.drum.roller.middle)
        return [wall.over(beta, radius).z for wall in self.drum.walls]

    @cached_property
    def _axis(self) -> Floats:
        """Height of the roller's axis, or of the middle of both of a rib, over the turn of polar angles."""
        phi = np.linspace(0, math.tau, _POINTS)
        at = phi + np.arctan2(self.drum.path.beside(phi, 0), self.drum.roller.middle)
        return np.interp(
            np.linspace(0, math.tau, _POINTS), at, self.drum.path.height(phi, 0), period=math.tau
        )

    def _angles(self, sheet: Sheet, foot: complex) -> None:
        """Below: by how much the drum has turned when its roller is there, and polar angles."""
        for row, name in ((4.5, "Drum"), (9.0, "At")):
            sheet.text(foot - _LEFT + 1 - 1j * row, name, _SMALL)
        apart = next((each for each in _STEPS if self.around * each / 360 >= _WIDE), _STEPS[-1])
        for degrees in range(0, 361, apart):
            at = foot + self.around * degrees / 360
            sheet.line(at, at - 1.2j, layer="DIM")
            sheet.text(at - 9j, f"{degrees}°", _SMALL, "centre")
        step = np.arange(0.0, 361.0, apart)
        for degrees, angle in zip(step.tolist(), self.angle(step).tolist(), strict=True):
            share = angle / 360 % 1
            if min(share, 1 - share) < 1e-6:  # both ends of the sheet
                share = float((degrees == 0) == (self.facts.sense > 0))
            elif degrees == 360:
                continue
            sheet.text(foot + self.around * share - 4.5j, f"{degrees:g}°", _SMALL, "centre")

    def _heights(self, sheet: Sheet, foot: complex) -> None:
        """To the left the least and the greatest height of the roller's axis, to the right a scale of heights."""
        low, high = float(np.min(self._axis)), float(np.max(self._axis))
        levels = [low, high] if self.scale * (high - low) > _APART else [low]
        for z in levels:
            at, end = self._on(foot, np.full(2, z))
            sheet.line(at - 1.5, end, layer="DIM")
            sheet.text(at - 2 - 0.9j, number(z), _SMALL, "right", room=_LEFT - 3)
        step = next((each for each in _HEIGHTS if self.scale * each >= _APART), _HEIGHTS[-1])
        bottom, top = shown(self.drum)
        for z in step * np.arange(math.ceil(bottom / step), math.floor(top / step) + 1):
            at = self._on(foot, np.full(2, z))[1]
            sheet.line(at, at + 1.2, layer="DIM")
            sheet.text(at + 1.8 - 0.9j, number(float(z)), _SMALL, room=_RIGHT - 3)
        head = foot + self.around + 1j * self.high
        sheet.text(head + 1.8 + 2j, "mm", _SMALL)

    def _segments(self, sheet: Sheet, head: complex) -> Sheet:
        """Names of the motion's segments over the development, and where they end; by themselves."""
        drawn = Sheet(0.0, 0.0, "")
        for kind, start, end in self.facts.segments:
            ends = sorted(self.angle(np.array([start, end])).tolist())
            pieces = [_within(ends, turn) for turn in (0.0, 360.0, -360.0)]
            low, high = max(pieces, key=lambda piece: piece[1] - piece[0])
            for each in {low, high} - {0.0, 360.0}:
                at = head + self.around * each / 360
                drawn.line(at - 1j * self.high, at + 1j * _NAMES, layer="DIM")
            wide = self.around * (high - low) / 360
            text = f"{kind} {number(end - start, 2)}°"
            place = head + self.around * (low + high) / 720 + 3j
            if wide > 2 * _SMALL:  # else there is no room
                drawn.text(place, text, _SMALL, "centre", room=wide - 1)
        sheet.things += drawn.things
        return drawn

    def _walls(self, sheet: Sheet, foot: complex, names: Sheet) -> None:
        """Tolerance and roughness of the walls, with a leader onto the upper one past the names of segments."""
        import shapely

        places = np.linspace(0.1, 0.6, 26) * self.around
        upper = np.array(self._on(foot, self._walls_z[-1]))
        level = foot.imag + self.high + _NAMES + FRAME / 2 + 2
        tips = upper[np.searchsorted(upper.real - foot.real, places)]
        lines = shapely.linestrings([[(z.real, z.imag), (z.real, level)] for z in tips])
        obstacles = Obstacles()
        obstacles.add(names.primitives)
        ways = shapely.buffer(lines, 1.0)
        k = int(np.argmax(obstacles.free(ways) & obstacles.unlined(ways)))
        tip = complex(tips[k])
        start = complex(tip.real, level)
        sheet.line(tip, start, layer="DIM")
        sheet.arrow(tip, -1j)
        wide = 2.0
        if self.facts.roughness:
            wide += roughness(sheet, start + 3, f"Ra {self.facts.roughness:g}") + 3
        sheet.line(start, start + wide, layer="DIM")
        end = start + wide
        if self.facts.profile:
            corner = end - 1j * FRAME / 2
            end = line_profile(sheet, corner, self.facts.profile, self.datums) + 1j * FRAME / 2
        sheet.text(end + 2 - 1.2j, self._said_of_walls, _SMALL)

    @property
    def _said_of_walls(self) -> str:
        """Which walls the tolerance holds for: of two the upper one, from which the width gives the other its place."""
        if len(self._walls_z) == 1:
            return "the whole wall"
        if not self.facts.profile:
            return "both walls, from floor to outside"
        return "upper wall, from floor to outside; lower wall by the width of the track"


def shown(drum: Drum) -> tuple[float, float]:
    """From which to which height a drum is shown unrolled: its track and what is next to it."""
    low, high = drum.span
    more = _ROUND * (high - low)
    return max(low - more, 0.0), min(high + more, drum.length)


def _within(ends: Sequence[float], turn: float) -> tuple[float, float]:
    """What of a stretch of angles, moved by so much, lies within 0 and 360 deg."""
    low, high = (min(max(end + turn, 0.0), 360.0) for end in ends)
    return low, high


def development(
    drum: Drum, facts: Facts, datums: Sequence[str], wide: float, scales: Sequence[float]
) -> Development:
    """The largest that is no wider than so many mm of paper; scales: from the largest down."""
    around = math.tau * drum.roller.middle
    low, high = shown(drum)
    room = wide - _LEFT - _RIGHT
    scale = next(
        (s for s in scales if s * around <= room and s * (high - low) <= _HIGH), scales[-1]
    )
    return Development(drum, facts, scale, datums)


# ---- section ---------------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Section:
    """A track cut square to its walls, mm: own material, what lies beside it, and what is dimensioned.

    Where a face is broken off is no edge; `beside` are outlines of rollers and of other parts.
    """

    title: str
    scale: float
    words: Sequence[str]  # below the title
    faces: Sequence[Sequence[complex]]
    edges: Sequence[Sequence[complex]]
    breaks: Sequence[Sequence[complex]]
    beside: Sequence[Sequence[complex]]
    axes: Sequence[tuple[complex, complex]]  # of rollers
    # ends, way to the dimension's line, what it says
    sizes: Sequence[tuple[complex, complex, complex, Measure]]
    # faces that are case hardened, with the unit way off them
    cased: Sequence[tuple[complex, complex, complex]] = ()

    @cached_property
    def _points(self) -> Points:
        return np.array([z for line in (*self.faces, *self.beside) for z in line])

    @property
    def low(self) -> complex:
        """Lower left corner."""
        return complex(np.min(self._points.real), np.min(self._points.imag))

    @property
    def high(self) -> complex:
        """Upper right corner."""
        return complex(np.max(self._points.real), np.max(self._points.imag))

    def draw(self, sheet: Sheet, corner: complex, own: float, tolerance: str) -> None:
        """Draw it in its room, whose lower left corner is there: words to the left, the picture beside them.

        own: scale of the sheet; tolerance: its general one.
        """
        import shapely

        scale = self.scale
        sheet.text(corner + 1j * (SECTION_ROOM.imag - 6), self.title, 3.5, room=_WORDS)
        for k, word in enumerate(self.words):
            place = corner + 1j * (SECTION_ROOM.imag - 12 - 4.5 * k)
            sheet.text(place, word, _SMALL, room=_WORDS)
        picture = complex(_WORDS + (SECTION_ROOM.real - _WORDS) / 2, SECTION_ROOM.imag / 2) - 4 - 8j
        origin = corner + picture - scale * (self.low + self.high) / 2

        def put(points: Sequence[complex], layer: str) -> None:
            sheet.line(*(origin + scale * z for z in points), layer=layer)

        for edge in self.edges:
            put(edge, "VIEW")
        for line in self.breaks:
            put(line, "DIM")
        for outline in self.beside:
            put([*outline, outline[0]], "HIDDEN")
        shapes = [shapely.Polygon([(z.real, z.imag) for z in face]) for face in self.faces]
        for ends in views.hatching(shapely.union_all(shapes), _HATCH / scale):
            put(ends, "HATCH")
        for axis in self.axes:
            put(axis, "CENTER")
        for start, end, away in self.cased:
            put([z + away * BESIDE_CASE / scale for z in (start, end)], "CASE")
        for a, b, away, measure in self.sizes:
            said = replace(measure, factor=own / scale, letters=2.5)
            dimension(sheet, (origin + scale * a, origin + scale * b), away, said, tolerance)


def drum_section(drum: Drum, facts: Facts, scales: Sequence[float]) -> Section:
    """The track of a drum in the plane of its roller's axis along its own, where the roller stands still for a moment.

    There the walls are the roller's own edges. x outwards from the axis, y over the roller's axis.
    """
    phi = np.linspace(0, math.tau, _POINTS)
    rest = phi[[int(np.argmin(np.abs(drum.path.height(phi, 1))))]]
    height = float(drum.path.height(rest, 0)[0])
    aside = float(drum.path.beside(rest, 0)[0])
    floor, middle, outside = (
        math.sqrt(max(radius**2 - aside**2, 0.0))
        for radius in (drum.floor, drum.roller.middle, drum.outside)
    )
    radii = np.array([floor, drum.roller.middle, outside])
    walls = [
        (wall.path.height(rest, 0) + wall.side * wall.roller.at(radii) - height).tolist()
        for wall in drum.walls
    ]
    shifts = [-drum.pitch / 2, drum.pitch / 2] if drum.pitch else [0.0]
    levels = [z for wall in walls for z in wall]
    if drum.track != "groove":  # beside the rollers, too
        levels.append(shifts[-1] + drum.roller.radius)
    if drum.track == "rib":
        levels.append(shifts[0] - drum.roller.radius)
    tall = max(levels) - min(levels)
    size = max(tall, outside - floor)
    scale = next((s for s in scales if s * size <= _SECTION), scales[-1])
    more = _MATERIAL / scale
    low = max(min(levels) - more, -height)
    high = min(max(levels) + more, drum.length - height)
    inside = floor - more
    edge = _edge(drum.track, walls, floor, outside)
    edge = [complex(edge[0].real, low), *edge, complex(edge[-1].real, high)]
    corners = complex(inside, high), complex(inside, low)
    breaks: list[Sequence[complex]] = [corners]
    edges: list[Sequence[complex]] = [edge]  # and ends of the drum
    for k, corner, end in ((-1, corners[0], drum.length - height), (0, corners[1], -height)):
        (edges if abs(corner.imag - end) < SAME_POINT else breaks).append([edge[k], corner])
    rollers = [_roller(drum, facts.roller, shift) for shift in shifts if facts.roller]
    axes = [(complex(inside, z), complex(outside + 2 * more, z)) for z in shifts]
    off = looser(facts.profile, drum.track == "rib")
    where = f" on Ø{number(2 * drum.roller.middle)}" if drum.roller.slope else ""
    sizes = []
    if len(walls) == 2:
        across = complex(middle, walls[0][1]), complex(middle, walls[1][1])
        width = Measure(walls[1][1] - walls[0][1], "", (off + where).strip())
        sizes.append((*across, complex(scale * (outside - middle) + _ASIDE), width))
    top = walls[-1]
    start = complex(floor, top[2])
    up = scale * (high - top[2]) + _OFF
    # of an arm's drum in the plane of its roller, some thousandths off that from the axis
    deep = Measure(outside - floor, *_deeper(drum, facts), digits=2)
    sizes.append((start, complex(outside, top[2]), 1j * up, deep))
    title = f"Section of the track ({ratio(scale)})"
    turned = math.degrees(-float(rest[0]) * facts.sense) % 360
    words = [
        "through the roller's axis,",
        f"drum turned by {number(turned, 1)}°",
    ]
    if facts.roller:
        diameter, length, _ = facts.roller
        words.append(f"roller Ø{number(diameter)} × {number(length)}")
        play = 2 * drum.roller.radius - diameter
        if facts.profile and drum.track == "groove":
            most = play + facts.profile
            words.append(f"its play {number(play)} to {number(most)}")
            if facts.crowned:
                words.append(f"of a crowned ring to {number(most + facts.crowned)}")
    if facts.profile and drum.track == "groove":
        words += _groove_words(drum, facts)
    if drum.roller.slope:
        half = math.degrees(math.atan(drum.roller.slope))
        words.append(f"half angle of its cone {number(half)}°")
    face = [*edge, *corners]
    ends = [
        (complex(floor, levels[0]), complex(outside, levels[2]), -1j * wall.side)
        for wall, levels in zip(drum.walls, walls, strict=True)
    ]
    cased = ends if facts.case_only else []
    return Section(title, scale, words, [face], edges, breaks, rollers, axes, sizes, cased)


def _deeper(drum: Drum, facts: Facts) -> tuple[str, str]:
    """Sign and deviations of a track's depth: it may only be deeper, by a share of the gap between its floor and its roller."""
    if not (facts.profile and facts.roller):
        return REFERENCE, ""
    gap = facts.roller[2] - drum.floor
    return "", f"+{math.floor(100 * _OF_GAP * gap + 1e-6) / 100:g}/0"


def _groove_words(drum: Drum, facts: Facts) -> list[str]:
    """How thick a groove leaves the drum's rims, and the cutter that fits both walls of one with straight sides."""
    outside = np.full(_POINTS, drum.outside)
    beta = np.linspace(0, math.tau, _POINTS)
    low, high = (wall.over(beta, outside).z for wall in drum.walls)
    rims = float(np.min(low)), drum.length - float(np.max(high))
    thin = " and ".join(f"{rim:.1f}" for rim in rims)
    words = [f"rims nominally {thin}"]
    if facts.roller and not drum.roller.slope:
        words.append(f"cutter Ø{number(facts.roller[0])}, a pass for each wall")
    return words


def _edge(
    track: str, walls: Sequence[Sequence[float]], floor: float, outside: float
) -> list[complex]:
    """Edge of a section from below upwards, material on its left; walls: heights at floor, middle and outside."""
    lower = [complex(floor, walls[0][0]), complex(outside, walls[0][2])]
    if track == "end":
        return lower[::-1]
    upper = [complex(floor, walls[1][0]), complex(outside, walls[1][2])]
    return [*lower[::-1], *upper] if track == "groove" else [*lower, *upper[::-1]]


def _roller(drum: Drum, roller: tuple[float, float, float], shift: float) -> list[complex]:
    """Outline of a roller whose axis lies so high."""
    diameter, length, inner = roller
    taper = drum.roller.slope * length / 2
    near = diameter / 2 - taper
    far = diameter / 2 + taper
    corners = [(0, -near), (length, -far), (length, far), (0, near)]
    return [complex(inner + x, shift + y) for x, y in corners]


def looser(profile: float, rib: bool = False) -> str:
    """Deviations of a track's width, to the side that gives the roller more play: both walls may be off by half the zone, mm."""
    if not profile:
        return ""
    return f"0/-{number(profile)}" if rib else f"+{number(profile)}/0"


def plates_section(groove: Groove, depth: float, facts: Facts, scales: Sequence[float]) -> Section:
    """A groove between two walls on a back plate, as assembled, square to the walls: x from the inner wall outwards, y upwards."""
    size = max(groove.width, depth)
    scale = next((s for s in scales if s * size <= _SECTION), scales[-1])
    more = _MATERIAL / scale
    width = groove.width

    def block(left: float, right: float, low: float, high: float) -> list[complex]:
        return [complex(*z) for z in ((left, low), (right, low), (right, high), (left, high))]

    inner = block(-more, 0.0, 0.0, depth)
    outer = block(width, width + more, 0.0, depth)
    own, other = (inner, outer) if groove.inner else (outer, inner)
    # from its broken end, which is to the left of an inner wall, round
    edge = own if groove.inner else [own[1], own[0], own[3], own[2]]
    end = -more if groove.inner else width + more
    off = looser(facts.profile)
    across = complex(0, depth), complex(width, depth), 1j * _OFF, Measure(width, "", off)
    away = complex(math.copysign(_OFF, end))
    deep = complex(end, 0), complex(end, depth), away, Measure(depth, REFERENCE)
    words = [
        "square to the track; dashed:",
        f"{'outer' if groove.inner else 'inner'} wall and back plate",
        f"roller Ø{number(groove.roller)}",
    ]
    middle = width / 2
    return Section(
        f"Groove as assembled ({ratio(scale)})",
        scale,
        words,
        [own],
        [edge],
        [[edge[0], edge[-1]]],
        [other, block(-more, width + more, -more, 0.0)],
        [(complex(middle, -more / 2), complex(middle, depth + more / 2))],
        [across, deep],
    )
