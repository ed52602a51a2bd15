"""The mechanism as a moving picture: bodies and poses to SVG, for the report's page and for stills.

Same bodies and poses, same bytes.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from html import escape

import numpy as np

from camgen.geometry.outlines import Floats, Points
from camgen.machine.features import PartPose
from camgen.numerics import from_zero
from camgen.report.colours import part_colour

Ring = tuple[Points, Floats]

# A ring with more vertices than this is drawn with fewer; files keep them all.
DRAWN_VERTICES = 4000


@dataclass(frozen=True)
class Body:
    """A body of the animation, in its own frame, mm: one shape and a pose for each copy.

    rings: closed outlines (points (n,) complex, bulges (n,)), drawn even-odd, so holes are rings too; bulge k is
    tan(sweep / 4) of the arc from point k to the next, positive counter-clockwise, 0 a straight edge.
    strokes: open polylines (n,) complex; circles: (centre, radius). course: an open polyline of its own for each frame,
    (frames, k) complex, such as a thread; swell: of its points over the line's height, (k,) mm. heights: of what is no part, from where to where it reaches, mm, the same of a line.
    upright: whether its plane stands, x along the machine's -y and y along its z, heights against its x: the drawing leaves it out.
    """

    name: str
    poses: Sequence[PartPose]
    rings: Sequence[Ring] = ()
    strokes: Sequence[Points] = ()
    circles: Sequence[tuple[complex, float]] = ()
    course: Points | None = None
    heights: tuple[float, float] | None = None
    upright: bool = False
    swell: Floats | None = None


@dataclass(frozen=True)
class Animation:
    """So many turns: `theta` (n,) rad, evenly spaced from 0, the end point left out; the poses' arrays are (n,) too.

    Each angle is a frame of the page, which interpolates between: 120 (3 deg) are exact to 0.04 % of a radius.
    output: (n,) the follower's value in `output_unit`, shown as `output_name`. A pose that is nan hides its body.
    stroke: between which the drive goes to and fro in a harmonic motion, in `drive_unit`, shown as `drive_name`; None: it turns.
    """

    theta: Floats
    bodies: Sequence[Body]
    output: Floats | None = None
    output_name: str = "output"
    output_unit: str = ""
    turns: int = 1
    stroke: tuple[float, float] | None = None
    drive_name: str = "θ"
    drive_unit: str = "deg"

    @property
    def moves(self) -> bool:
        """Whether anything moves at all: a coupon does not."""
        poses = [pose for body in self.bodies for pose in body.poses]
        changes = any(
            len(np.unique(values)) > 1
            for pose in poses
            for values in (pose.angle, np.real(pose.place), np.imag(pose.place))
        )
        return changes or any(body.course is not None for body in self.bodies)


def decimals(value: float) -> str:
    """As the page's script writes a value."""
    return f"{value:.3f}".replace("-", "−") if math.isfinite(value) else "–"


def _number(value: float) -> str:
    """Shortest text of a coordinate to 0.1 um, never -0 or an exponent."""
    return f"{value:z.4f}".rstrip("0").rstrip(".")


def _xy(z: complex) -> str:
    return f"{_number(z.real)} {_number(z.imag)}"


def _coarse(ring: Ring) -> Ring:
    """The ring with few enough vertices to draw: one for each small step along it, then all edges straight."""
    points = np.asarray(ring[0], complex)
    bulges = np.asarray(ring[1], float)
    if len(points) <= DRAWN_VERTICES:
        return points, bulges
    along = from_zero(np.abs(np.diff(points)))
    step = np.floor(along / along[-1] * (DRAWN_VERTICES / 2))
    points = points[np.concatenate([[True], np.diff(step) > 0])]
    return points, np.zeros(len(points))


def svg_path(ring: Ring) -> str:
    """SVG path of a ring in its own frame (y up under the drawing's mirror image, so bulges keep their sense)."""
    points, bulges = _coarse(ring)
    ends = np.roll(points, -1)
    chords = np.abs(ends - points)
    words = [f"M{_xy(points[0])}"]
    for end, chord, bulge in zip(ends.tolist(), chords.tolist(), bulges.tolist(), strict=True):
        if (
            abs(bulge) * chord < 2e-5
        ):  # an arc this flat is a line to 0.01 um, and its radius would overflow renderers
            words.append(f"L{_xy(end)}")
        else:
            radius = _number(chord * (1 + bulge * bulge) / (4 * abs(bulge)))
            words.append(f"A{radius} {radius} 0 {int(abs(bulge) > 1)} {int(bulge > 0)} {_xy(end)}")
    return "".join(words) + "Z"


def _hull(body: Body) -> Points:
    """Points whose hull is the body's, to a thousandth of its size: vertices, arcs' insides, circles."""
    groups = [np.zeros(1, complex), *(np.asarray(stroke, complex) for stroke in body.strokes)]
    groups += [] if body.course is None else [np.ravel(body.course)]
    for ring in body.rings:
        points, bulges = _coarse(ring)
        chord = np.roll(points, -1) - points
        sweep = 4 * np.arctan(bulges)
        for share in np.arange(8) / 8:
            curved = np.abs(bulges) > 1e-9
            half = np.where(curved, np.sin(sweep / 2), 1.0)
            along = np.where(curved, np.sin(share * sweep / 2) / half, share)
            groups.append(points + chord * along * np.exp(-1j * (1 - share) * sweep / 2))
    groups += [
        centre + radius * np.exp(2j * np.pi * np.arange(48) / 48) for centre, radius in body.circles
    ]
    points = np.concatenate(groups)
    points = points[np.isfinite(points)]
    outward = np.exp(-2j * np.pi * np.arange(72) / 72)
    return np.asarray(points[np.unique([np.argmax((points * way).real) for way in outward])])


def _pose_rows(pose: PartPose, count: int) -> tuple[Floats, Points]:
    """Angles, rad, and positions, mm, (count,) each, of a pose that may be constant."""
    return np.broadcast_to(pose.angle, count), np.broadcast_to(
        np.asarray(pose.place, complex), count
    )


def _copies(animation: Animation) -> list[tuple[int, PartPose]]:
    """(index of body, pose) of all copies, lowest first; sketches lie on top."""
    copies = [(k, pose) for k, body in enumerate(animation.bodies) for pose in body.poses]
    return sorted(copies, key=lambda copy: (not animation.bodies[copy[0]].rings, copy[1].z))


def frames(animation: Animation) -> dict[str, object]:
    """What the page's script needs: of each copy its [deg, x, y] by frame (a single one where it rests), or the number of an
    earlier copy that moves with it."""
    poses: list[object] = []
    first: dict[str, int] = {}
    for _, pose in _copies(animation):
        angle, position = _pose_rows(pose, len(animation.theta))
        rows = (
            np.round(np.column_stack([np.degrees(angle), position.real, position.imag]), 3) + 0.0
        ).tolist()
        states = [row if all(map(math.isfinite, row)) else None for row in rows]
        still = all(state == states[0] for state in states)
        known = first.setdefault(repr(states), len(poses))
        poses.append(states[:1] if still else states if known == len(poses) else known)
    output = [] if animation.output is None else np.asarray(animation.output, float).tolist()
    return {
        "frames": len(animation.theta),
        **({"turns": animation.turns} if animation.turns > 1 else {}),
        **({"stroke": animation.stroke} if animation.stroke else {}),
        "poses": poses,
        "flipped": [pose.flipped for _, pose in _copies(animation)],
        "heights": {
            str(k): np.round(body.heights, 3).tolist()
            for k, body in enumerate(animation.bodies)
            if body.heights is not None
        },
        "upright": [str(k) for k, body in enumerate(animation.bodies) if body.upright],
        "courses": {
            str(k): _coordinates(body.course)
            for k, body in enumerate(animation.bodies)
            if body.course is not None
        },
        "swells": {
            str(k): np.round(body.swell, 2).tolist()
            for k, body in enumerate(animation.bodies)
            if body.swell is not None
        },
        "output": [float(f"{value:z.6g}") if math.isfinite(value) else None for value in output],
    }


def _coordinates(course: Points) -> list[list[float]]:
    """x and y of each point of a polyline by turns, by frame."""
    flat = np.stack([course.real, course.imag], axis=-1).reshape(len(course), -1)
    return [[float(value) for value in row] for row in np.round(flat, 2) + 0.0]


def drawing(animation: Animation, frame: int) -> tuple[str, str]:
    """View box and markup of the mechanism at a frame; the page's script moves the `use` elements."""
    copies = _copies(animation)
    count = len(animation.theta)
    reach = []
    for k, pose in copies:
        if animation.bodies[k].upright:
            continue
        angle, position = _pose_rows(pose, count)
        shape = _hull(animation.bodies[k])
        shape = -np.conj(shape) if pose.flipped else shape
        reach.append((position[:, None] + np.exp(1j * angle[:, None]) * shape).ravel())
    cloud = np.concatenate([np.zeros(1, complex), *reach])
    cloud = cloud[np.isfinite(cloud)]
    left = cloud.real.min()
    right = cloud.real.max()
    low = cloud.imag.min()
    high = cloud.imag.max()
    size = max(right - left, high - low, 1e-3)
    left = left - 0.05 * size
    right = right + 0.05 * size
    low = low - 0.13 * size
    high = high + 0.05 * size
    power = 10.0 ** math.floor(math.log10(size / 10))
    step = next(power * factor for factor in (1, 2, 5, 10) if power * factor >= size / 10.000001)
    across, up = (
        np.arange(math.ceil(a / step), b / step) * step for a, b in ((left, right), (low, high))
    )
    grid = "".join(f"M{_xy(complex(x, low))}V{_number(high)}" for x in across)
    grid += "".join(f"M{_xy(complex(left, y))}H{_number(right)}" for y in up)
    scale = max(power * factor for factor in (1, 2, 5, 10, 20) if power * factor <= size / 4)
    thin = _number(size / 500)
    bar = complex(left + 0.04 * size, low + 0.05 * size)
    shapes = "".join(_shape(k, body, size / 60, frame) for k, body in enumerate(animation.bodies))
    dashes = f' stroke-dasharray="{_number(size / 80)} {_number(size / 160)}"'
    uses = "".join(
        f'<use href="#body-{k}" class="c{k}{" upright" if animation.bodies[k].upright else ""}"{dashes if pose.flipped else ""} {_placement(pose, frame, count)}/>'
        for k, pose in copies
    )
    axes = f"M{_number(left)} 0H{_number(right)}M0 {_number(low)}V{_number(high)}"
    text = f'<text x="{_number(bar.real)}" y="{_number(-bar.imag - size / 60)}" font-size="{_number(size / 32)}">'
    return (
        " ".join(map(_number, (left, -high, right - left, high - low))),
        f'<defs>{shapes}</defs><g transform="scale(1 -1)" fill="none" stroke-width="{thin}" stroke-linejoin="round">'
        f'<path class="grid" d="{grid}"/><path class="axes" d="{axes}" stroke-dasharray="{_number(size / 30)} '
        f'{_number(size / 120)} {_number(size / 240)} {_number(size / 120)}"/>'
        f'<path class="scale" stroke-width="{_number(size / 200)}" d="M{_xy(bar)}h{_number(scale)}"/>{uses}</g>'
        f"{text}{scale:g} mm</text>",
    )


def _shape(k: int, body: Body, cross: float, frame: int) -> str:
    """A body as a symbol to be placed: tinted material, strokes, circles, a cross at its datum, a course at a frame."""
    rings = "".join(svg_path(ring) for ring in body.rings)
    lines = "".join(
        "M" + "L".join(_xy(z) for z in np.asarray(stroke).tolist()) for stroke in body.strokes
    )
    mark = f"M-{(c := _number(cross))} 0H{c}M0 -{c}V{c}" if rings else ""
    if body.course is not None:
        line = "M" + "L".join(_xy(z) for z in body.course[frame].tolist())
        return f'<g id="body-{k}"><path fill="none" stroke-width="{_number(cross / 5)}" d="{line}"/></g>'
    rounds = "".join(
        f'<circle cx="{_number(z.real)}" cy="{_number(z.imag)}" r="{_number(radius)}" fill-opacity=".12"/>'
        for z, radius in body.circles
    )
    return (
        f'<g id="body-{k}">'
        + (f'<path fill-rule="evenodd" fill-opacity=".2" d="{rings}"/>' if rings else "")
        + (f'<path fill="none" d="{lines}{mark}"/>' if lines or mark else "")
        + rounds
        + "</g>"
    )


def _placement(pose: PartPose, frame: int, count: int) -> str:
    angle, position = _pose_rows(pose, count)
    if not np.isfinite(angle[frame] + position[frame]):
        return 'display="none"'
    mirror = "scale(-1 1)" if pose.flipped else ""
    return f'transform="translate({_xy(position[frame])})rotate({_number(math.degrees(angle[frame]))}){mirror}"'


def player(animation: Animation, scene: bool = False) -> str:
    """The drawing with its parts, play button, slider and read-out; without script a still picture.

    scene: whether there is a view in three dimensions, which takes the drawing's place.
    """
    box, drawn = drawing(animation, 0)
    items = []
    for k, body in enumerate(animation.bodies):
        over = sum(pose.flipped for pose in body.poses)
        words = body.name + (f" × {len(body.poses)}" if len(body.poses) > 1 else "")
        if over:
            words += f" ({over} turned over)" if len(body.poses) > 1 else ", turned over"
        items.append(
            f'<li class="c{k}"><input type="color" value="{part_colour(k)}" aria-label="colour of {escape(body.name)}" hidden>'
            f'<label><input type="checkbox" checked data-body="{k}" hidden> {escape(words)}</label></li>'
        )
    names = ", ".join(body.name for body in animation.bodies)
    parts = sum(bool(body.rings) for body in animation.bodies)  # paths and a ghost are none
    count = f"{parts} part{'' if parts == 1 else 's'}"
    begin = animation.stroke[0] if animation.stroke else 0.0
    where = "place in the period, degrees" if animation.stroke else "angle of the drive, degrees"
    value = (
        ""
        if animation.output is None
        else (
            f'<span>{escape(animation.output_name.replace("_", " "))} <output id="value">{decimals(animation.output[0])}</output> '
            f"{escape(animation.output_unit)}</span>"
        )
    )
    return (
        '<figure class="player"><div class="view">'
        f'<svg id="mechanism" viewBox="{box}" role="img" aria-labelledby="drawn drawn-what">'
        f'<title id="drawn">{"The mechanism in motion" if animation.moves else "The parts"}</title>'
        '<desc id="drawn-what">Seen along the axes, y up: '
        f"{escape(names)}.</desc>{drawn}</svg>{_CANVAS if scene else ''}</div>"
        f'<div class="controls"{"" if animation.moves else " hidden"}><button type="button" id="play" hidden>Play</button>'
        f"{_SPEED}"
        f'<input id="theta" type="range" min="0" max="360" step="0.5" value="0" aria-label="{where}" hidden>'
        f'<p><span>{escape(animation.drive_name)} <output id="angle">{begin:.1f}</output> {animation.drive_unit}</span>{value}</p></div>'
        f'<details class="legend" open><summary>{"View and " if scene else ""}{count}</summary>{_TOOLS if scene else ""}'
        f"<ul>{''.join(items)}</ul></details></figure>"
    )


_SPEED = (
    '<select id="speed" aria-label="speed" hidden><option value="0.1">× 0.1</option><option value="0.25">× 0.25</option>'
    '<option value="0.5">× 0.5</option><option value="1" selected>× 1</option><option value="2">× 2</option>'
    '<option value="4">× 4</option></select>'
)
_CANVAS = (
    '<canvas id="machine" tabindex="0" role="img" aria-label="The machine in three dimensions: drag or arrow keys turn it, '
    'plus and minus zoom, 0 shows it as at first, Enter names one part after the other, space plays" hidden></canvas>'
    '<div id="holes" aria-hidden="true"></div><p id="part" aria-live="polite" hidden></p>'
)
_TOOLS = (
    '<div class="tools" hidden><button type="button" id="home">Reset view</button>'
    '<button type="button" id="full">Full screen</button><button type="button" id="save">Save picture</button>'
    '<button type="button" id="flat" aria-pressed="false">Drawing</button>'
    '<label>Explode <input id="explode" type="range" min="0" max="1" step="0.01" value="0"></label>'
    '<label>Section <select id="section"><option value="">none</option><option>x</option><option>y</option><option>z</option>'
    '</select></label><input id="cut" type="range" min="0" max="1" step="0.005" value="0.5" aria-label="place of the section" '
    "hidden></div>"
)
