"""The machine as pixels, drawn by the processor alone: a picture, or one turn as a GIF. Same machine, same bytes.

    triangle   three corners on the screen: x to the right and y downwards, px, z towards the eye, mm
    span       a row of pixels that a triangle covers; of all spans over a pixel the nearest is seen
    ghost      what is not made, such as the follower of a cam alone: what lies behind shines through

The eye is far away, in front of the machine, above and to the right, as in the report; what is up is up in the picture.
"""

from __future__ import annotations

import io
import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import reduce
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from camgen.files.gltf import LYING, Shape, Track, upright
from camgen.numerics import Floats, Points
from camgen.report.animation import Animation
from camgen.report.colours import part_colour

if TYPE_CHECKING:
    from PIL.Image import Image

Ints = np.ndarray[Any, np.dtype[np.integer[Any]]]
Bools = np.ndarray[Any, np.dtype[np.bool_]]
Vector = tuple[float, float, float]
Kind = Literal["part", "ghost", "line"]  # a line has no edges

_EYE = np.array([0.55, 0.9, 1.0]) / np.linalg.norm([0.55, 0.9, 1.0])  # y up, z towards the front
_RIGHT = np.cross([0.0, 1.0, 0.0], _EYE) / np.linalg.norm(np.cross([0.0, 1.0, 0.0], _EYE))
_SUN = np.array([0.0, -0.25, 1.0]) / np.linalg.norm([0.0, -0.25, 1.0])  # in the axes of the screen
_AMBIENT = 0.45  # share of a colour that a face has which the sun does not reach
_GHOST = 0.45  # share of a ghost's colour over what is behind
_FINE = 2  # pixels drawn for each that is shown, each way
_PAPER = np.full((1, 3), 255.0)  # colour of what is behind all
_LINE = 0.55  # brightness of an edge
_CREASE = math.cos(math.radians(30))  # between faces whose common edge is drawn
_STEP = 0.4  # mm, from which on one thing before another one has an edge
_MARGIN = 0.04  # of the picture, round the machine
_BAND = 0.4  # mm, half the width of a line
_PICTURE = (1200, 900)  # px, at most
_FILM = (560, 420)
_FRAMES = 60  # of one turn
_MOST_FRAMES = 180
_SECONDS = 4.0  # that a turn takes
_UPRIGHT = np.array(
    [[0.0, 0.0, -1.0], [-1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]
)  # axes of a plane that stands, as columns
_PALETTE = 10  # of how many frames one is looked at for the colours of all


@dataclass(frozen=True)
class _Solid:
    """Triangles of one thing in the frame of its body: corners (n, 3, 3) mm, unit normals (n, 3), colour (3,) 0 to 255."""

    corners: Floats
    normals: Floats
    colour: Floats
    angle: Floats  # (frames,) rad, of its body
    place: Points  # (frames,) complex mm
    kind: Kind = "part"
    upright: bool = False  # as of `Body`


@dataclass(frozen=True)
class _View:
    """Which part of the screen is shown: its upper left corner, mm, px for each mm, and the size in px.

    screen: (3, 3), its rows the axes of the screen in those of the ground.
    """

    screen: Floats
    left: float
    top: float
    scale: float
    wide: int
    high: int


def picture(
    shapes: Sequence[Shape], tracks: Sequence[Track], animation: Animation, down: Vector = LYING
) -> bytes:
    """The machine at the first angle, as PNG; down: a unit vector, along z or across it."""
    solids = _solids(shapes, tracks, animation)
    view = _view(solids, animation, _PICTURE, _screen(down))
    return _encoded(_image(solids, animation, 0, view), "PNG")


def film(
    shapes: Sequence[Shape], tracks: Sequence[Track], animation: Animation, down: Vector = LYING
) -> bytes:
    """One period of the machine as a GIF that is repeated; of what does not move, a picture; down: see `picture`."""
    from PIL import Image

    solids = _solids(shapes, tracks, animation)
    view = _view(solids, animation, _FILM, _screen(down))
    count = len(animation.theta) if animation.moves else 1
    wanted = min(_FRAMES * animation.turns, _MOST_FRAMES)
    chosen = range(0, count, max(1, count // wanted))
    images = [_image(solids, animation, frame, view) for frame in chosen]
    several = np.concatenate([np.asarray(image) for image in images[::_PALETTE]])
    colours = Image.fromarray(several).quantize(255, Image.Quantize.MEDIANCUT)
    painted = [image.quantize(palette=colours, dither=Image.Dither.NONE) for image in images]
    pause = round(100 * _SECONDS * animation.turns / len(painted)) * 10  # ms
    rest = {"save_all": True, "append_images": painted[1:], "duration": pause, "loop": 0}
    return _encoded(painted[0], "GIF", **rest)


def _encoded(image: Image, kind: str, **options: Any) -> bytes:
    file = io.BytesIO()
    image.save(file, kind, **options)
    return file.getvalue()


# ---- what is drawn ---------------------------------------------------------------------------------------------------


def _solids(shapes: Sequence[Shape], tracks: Sequence[Track], animation: Animation) -> list[_Solid]:
    """All that keeps its shape: copies of parts, and what is no part."""
    solids = []
    for track in tracks:
        for _, number, transform in track.copies:
            shape = shapes[number]
            vertices = shape.mesh.vertices @ transform[:, :3].T + transform[:, 3]
            corners = vertices[shape.mesh.faces]
            solid = _solid(corners, shape.colour, (track.angle, track.place))
            solids.append(replace(solid, upright=track.standing))
    frames = len(animation.theta)
    for k, body in enumerate(animation.bodies):
        if body.heights is None or body.course is not None:
            continue
        low, high = body.heights
        corners = bands(body.strokes, body.circles, low, high)
        for pose in body.poses:
            angle = np.broadcast_to(pose.angle, frames)
            place = np.broadcast_to(np.asarray(pose.place, complex), frames)
            kind: Kind = "ghost" if high > low else "line"
            solid = _solid(corners, part_colour(k), (angle, place), kind)
            solids.append(replace(solid, upright=body.upright))
    return solids


def _solid(
    corners: Floats, colour: str, motion: tuple[Floats, Points], kind: Kind = "part"
) -> _Solid:
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    sizes = np.linalg.norm(normals, axis=1)
    real = sizes > 0
    rgb = np.array([int(colour[k : k + 2], 16) for k in (1, 3, 5)], float)
    return _Solid(corners[real], normals[real] / sizes[real, None], rgb, *motion, kind)


def bands(
    lines: Sequence[Points], discs: Sequence[tuple[complex, float]], low: float, high: float
) -> Floats:
    """Triangles (n, 3, 3), mm, of bands along lines (complex mm) and of discs (centre, radius), from a height to another one.

    Bands beside discs are as wide as an arm; others, and all that are flat, are lines.
    """
    half = max(_BAND, 0.4 * min((radius for _, radius in discs), default=0.0))
    rings = []
    for line in lines:
        line = np.asarray(line, complex)
        way = np.diff(line)
        side = 1j * half * way / np.where(np.abs(way) > 0, np.abs(way), 1.0)
        starts = line[:-1]
        ends = line[1:]
        rings += list(np.stack([starts - side, ends - side, ends + side, starts + side], axis=1))
    turn = np.exp(2j * np.pi * np.arange(48) / 48)
    rings += [centre + radius * turn for centre, radius in discs]
    return np.concatenate([_prism(ring, low, high) for ring in rings] or [np.zeros((0, 3, 3))])


def _prism(ring: Points, low: float, high: float) -> Floats:
    """Triangles of a convex ring, counter-clockwise, extruded; only its upper side where it is flat."""

    def at(points: Points, z: float) -> Floats:
        return np.column_stack([points.real, points.imag, np.full(len(points), z)])

    def fan(z: float) -> Floats:
        corners = at(ring, z)
        first = np.broadcast_to(corners[0], (len(ring) - 2, 3))
        return np.stack([first, corners[1:-1], corners[2:]], axis=1)

    if not high > low:
        return fan(low)
    after = np.roll(ring, -1)
    a = at(ring, low)
    b = at(after, low)
    c = at(after, high)
    d = at(ring, high)
    sides = [np.stack([a, b, c], axis=1), np.stack([a, c, d], axis=1)]
    return np.concatenate([fan(high), fan(low)[:, ::-1], *sides])


def _courses(animation: Animation, frame: int) -> list[_Solid]:
    """Springs and threads, which change their shape."""
    still = (np.zeros(len(animation.theta)), np.zeros(len(animation.theta), complex))
    solids = []
    for k, body in enumerate(animation.bodies):
        if body.course is None or body.heights is None:
            continue
        line = body.course[frame]
        if body.swell is None:
            corners = bands([line], (), *body.heights)
        else:
            corners = _tube(np.column_stack([line.real, line.imag, body.heights[0] + body.swell]))
        solid = _solid(corners, part_colour(k), still, "line")
        solids.append(replace(solid, upright=body.upright))
    return solids


def _tube(line: Floats) -> Floats:
    """Triangles (n, 3, 3), mm, of a wire along a line, (k, 3) mm: a square at each point, square to the line."""
    way = np.gradient(line, axis=0)
    way /= np.linalg.norm(way, axis=1)[:, None]
    axis = np.eye(3)[np.argmin(np.abs(way).max(axis=0))]  # the one that it runs along least
    aside = np.cross(way, axis)
    aside /= np.linalg.norm(aside, axis=1)[:, None]
    across = np.cross(way, aside)
    ring = line[:, None] + _BAND * np.stack([aside, across, -aside, -across], axis=1)
    after = np.roll(ring, -1, axis=1)
    low, high = ring[:-1], after[:-1]
    far_low, far_high = ring[1:], after[1:]
    sides = [
        np.stack([low, high, far_high], axis=2),
        np.stack([low, far_high, far_low], axis=2),
    ]
    return np.concatenate(sides).reshape(-1, 3, 3)


# ---- the screen ------------------------------------------------------------------------------------------------------


def _screen(down: Vector) -> Floats:
    """The axes of the screen, (3, 3), rows: to the right, downwards, towards the eye."""
    x, y, z, w = upright(down)
    upright_axes = np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )
    screen: Floats = np.array([_RIGHT, -np.cross(_EYE, _RIGHT), _EYE]) @ upright_axes
    return screen


def _on_screen(solid: _Solid, frame: int, screen: Floats) -> tuple[Floats, Floats]:
    """Corners (n, 3, 3), mm, and normals (n, 3) in the axes of the screen, at a frame."""
    angle = solid.angle[frame]
    place = solid.place[frame]
    turn = np.array(
        [[math.cos(angle), -math.sin(angle), 0], [math.sin(angle), math.cos(angle), 0], [0, 0, 1]]
    )
    stands = screen @ _UPRIGHT if solid.upright else screen
    axes = (stands @ turn).T
    return solid.corners @ axes + stands @ [place.real, place.imag, 0.0], solid.normals @ axes


def _view(
    solids: Sequence[_Solid], animation: Animation, most: tuple[int, int], screen: Floats
) -> _View:
    """What holds the machine over all frames."""
    lows = []
    highs = []
    frames = range(0, len(animation.theta), 5)
    moved = [(solid, k) for solid in solids for k in frames if _finite(solid, k)]
    moved += [(each, k) for k in frames for each in _courses(animation, k)]
    for solid, frame in moved:
        places = _on_screen(solid, frame, screen)[0].reshape(-1, 3)
        if len(places):
            lows.append(places.min(axis=0))
            highs.append(places.max(axis=0))
    low = np.min(lows, axis=0)
    size = np.maximum(np.max(highs, axis=0) - low, 1e-3)
    scale = min((1 - 2 * _MARGIN) * most[0] / size[0], (1 - 2 * _MARGIN) * most[1] / size[1])
    edge = _MARGIN * max(most) / scale
    wide, high = (math.ceil(scale * (length + 2 * edge)) for length in size[:2])
    return _View(screen, low[0] - edge, low[1] - edge, scale, wide, high)


def _finite(solid: _Solid, frame: int) -> bool:
    return bool(np.isfinite(solid.angle[frame]) and np.isfinite(solid.place[frame]))


def _image(solids: Sequence[_Solid], animation: Animation, frame: int, view: _View) -> Image:
    """The machine at a frame; where it cannot go, a body is not drawn."""
    from PIL import Image

    there = [solid for solid in solids if _finite(solid, frame)]
    made = [solid for solid in there if solid.kind != "ghost"] + _courses(animation, frame)
    paper, depth = _drawn(made, frame, view)
    ghosts = [solid for solid in there if solid.kind == "ghost"]
    if ghosts:
        shine, before = _drawn(ghosts, frame, view)
        seen = before > depth
        paper[seen] += _GHOST * (shine[seen] - paper[seen])
    rows: Floats = reduce(np.add, [paper[k::_FINE] for k in range(_FINE)])
    smooth: Floats = reduce(np.add, [rows[:, k::_FINE] for k in range(_FINE)]) / _FINE**2
    return Image.fromarray((smooth + 0.5).astype(np.uint8))


def _drawn(solids: Sequence[_Solid], frame: int, view: _View) -> tuple[Floats, Floats]:
    """Colours (high, wide, 3) and depth (high, wide), mm, -inf where nothing is, of the fine picture."""
    corners = [np.zeros((0, 3, 3))]
    normals = [np.zeros((0, 3))]
    colours = [np.zeros((0, 3))]
    things = [np.zeros(0, int)]
    for k, solid in enumerate(solids):
        places, facing = _on_screen(solid, frame, view.screen)
        seen = facing[:, 2] > 1e-9
        corners.append(places[seen])
        normals.append(facing[seen])
        light = _AMBIENT + (1 - _AMBIENT) * np.maximum(facing[seen] @ _SUN, 0)
        colours.append(light[:, None] * solid.colour)
        number = -1 if solid.kind == "line" else k
        things.append(np.full(np.count_nonzero(seen), number))
    at = np.concatenate(corners)
    at = (at - [view.left, view.top, 0]) * [_FINE * view.scale, _FINE * view.scale, 1]
    size = (_FINE * view.high, _FINE * view.wide)
    slopes = _slopes(at)
    index, depth = nearest(at, slopes, size)
    # the last where nothing is
    paper = np.take(np.concatenate([*colours, _PAPER]), index, axis=0, mode="wrap")
    faces = (np.concatenate(things), np.concatenate(normals), slopes)
    paper[_edges(index, depth, faces)] *= _LINE
    return paper, depth


def _slopes(corners: Floats) -> Floats:
    """How z changes with x and y over each triangle, (n, 2) mm per px."""
    a = corners[:, 1] - corners[:, 0]
    b = corners[:, 2] - corners[:, 0]
    area = a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]
    area = np.where(np.abs(area) > 1e-12, area, np.inf)
    along = (a[:, 2] * b[:, 1] - b[:, 2] * a[:, 1]) / area
    down = (b[:, 2] * a[:, 0] - a[:, 2] * b[:, 0]) / area
    return np.column_stack([along, down])


def nearest(corners: Floats, slopes: Floats, size: tuple[int, int]) -> tuple[Ints, Floats]:
    """Of each pixel (high, wide) the number of the triangle that is nearest to the eye at its centre, -1 of none, and its z.

    corners: (n, 3, 3), x and y in px, y downwards, z towards the eye; slopes: (n, 2), dz/dx and dz/dy of each.
    """
    high, wide = size
    first = np.clip(np.ceil(corners[:, :, 1].min(axis=1) - 0.5), 0, high).astype(int)
    last = np.clip(np.floor(corners[:, :, 1].max(axis=1) - 0.5), -1, high - 1).astype(int)
    triangle, row = _ranges(first, last)
    y = row + 0.5
    left = np.full(len(row), np.inf)
    right = np.full(len(row), -np.inf)
    for k in range(3):
        a = corners[triangle, k]
        b = corners[triangle, (k + 1) % 3]
        crossed = (a[:, 1] <= y) != (b[:, 1] <= y)
        rise = np.where(crossed, b[:, 1] - a[:, 1], 1.0)
        x = a[:, 0] + (y - a[:, 1]) / rise * (b[:, 0] - a[:, 0])
        left = np.where(crossed, np.minimum(left, x), left)
        right = np.where(crossed, np.maximum(right, x), right)
    begin = np.clip(np.ceil(left - 0.5), 0, wide).astype(int)
    end = np.clip(np.floor(right - 0.5), -1, wide - 1).astype(int)
    span, column = _ranges(begin, end)
    level = corners[:, 0, 2] - np.sum(slopes * corners[:, 0, :2], axis=1)  # where x and y are 0
    level = level[triangle] + slopes[triangle, 1] * y
    triangle = triangle[span]
    row = row[span]
    z = level[span] + slopes[triangle, 0] * (column + 0.5)
    pixel = row * wide + column
    depth = np.full(high * wide, -np.inf)
    np.maximum.at(depth, pixel, z)
    index = np.full(high * wide, -1, np.int32)
    seen = z >= depth[pixel]
    index[pixel[seen]] = triangle[seen]
    return index.reshape(size), depth.reshape(size)


def _ranges(first: Ints, last: Ints) -> tuple[Ints, Ints]:
    """All whole numbers from each first to its last: the number of the range, and the whole number."""
    counts = np.maximum(last - first + 1, 0)
    owner = np.repeat(np.arange(len(counts)), counts)
    before = np.cumsum(counts) - counts
    return owner, first[owner] + np.arange(len(owner)) - before[owner]


def _edges(index: Ints, depth: Floats, faces: tuple[Ints, Floats, Floats]) -> Bools:
    """Which pixels are drawn as an edge: the nearer of two beside each other on different things, over a crease or a step."""
    things, normals, slopes = faces
    drawn = np.zeros(index.shape, bool)
    for axis in (1, 0):
        here = (slice(None, -1), slice(None)) if axis == 0 else (slice(None), slice(None, -1))
        there = (slice(1, None), slice(None)) if axis == 0 else (slice(None), slice(1, None))
        differ = index[here] != index[there]
        rows, columns = np.divmod(np.flatnonzero(differ), differ.shape[1])
        next_rows = rows + (axis == 0)
        next_columns = columns + (axis == 1)
        a = index[rows, columns]
        b = index[next_rows, next_columns]
        rise = depth[next_rows, next_columns] - depth[rows, columns]
        both = (a >= 0) & (b >= 0)
        rise = np.where(both, rise, 0.0)
        slope = 1 - axis
        step = np.minimum(np.abs(rise - slopes[a, slope]), np.abs(rise - slopes[b, slope])) > _STEP
        crease = np.sum(normals[a] * normals[b], axis=1) < _CREASE
        marked = ~both | (things[a] != things[b]) | crease | step
        nearer = depth[rows, columns] >= depth[next_rows, next_columns]
        marked &= things[np.where(nearer, a, b)] >= 0
        drawn[rows[marked & nearer], columns[marked & nearer]] = True
        drawn[next_rows[marked & ~nearer], next_columns[marked & ~nearer]] = True
    return drawn
