"""The track of a drum for the shop: unrolled, as a drawing at full size, and the path of a cutter in the drum's own coordinates.

<name>-<part>-developed.dxf    the walls on the cylinder half way along the roller
<name>-<part>-path.csv         where the axis of a cutter of `files.cutter_radius` runs along each wall: angle of the drum, which turns by
                               a_deg = theta_deg in front of it, height z_mm over the lower end, and y_mm beside the drum's axis

x       along the drum's axis from its lower end, mm
y       round the drum on the cylinder half way along the roller, counter-clockwise from where the follower stands at cam angle 0
CUT     one closed contour: what a groove takes away, what of a rib or below an end cam is left
PITCH   where the roller's axis runs
PATH    where the axis of that cutter runs along each wall, for a machine that wraps drawings and keeps its cutter radial
SCALE   the drum's ends, and cam angles at which the follower stands there
"""

from __future__ import annotations

import csv
import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

import numpy as np

from camgen.errors import FileError
from camgen.files.dxf import CUT_LAYER, add_contour, document, read_contours
from camgen.files.rows import write_rows
from camgen.findings import Finding, at_most, in_file
from camgen.geometry.arcs import fit_arcs
from camgen.geometry.drum_walls import DrumWall
from camgen.geometry.drums import Drum
from camgen.geometry.outlines import Contour, Line, Points, Smooth
from camgen.machine.model import Cam
from camgen.numerics import Floats, distinct, latest
from camgen.parts.part import Part
from camgen.pipeline.case import Case

_PATH = ("wall", "theta_deg", "a_deg", "z_mm", "y_mm")
_SIDES = {-1: "below", 1: "above"}  # of the roller
_ROWS = 1441  # of a wall's path: a quarter degree
_HELD = 360  # points of a wall, against which a path is held
_LAYERS = {CUT_LAYER: (7, 25), "PITCH": (1, 13), "SCALE": (5, 13)}
_CUTTER = {"PATH": (3, 13)}
_ROUNDS = 40  # of the depth at which a wall's point lies on a cylinder
_STEP = 1e-5  # rad, over which the slope's own slope is taken: it places arcs, and makes none
_APART = 1e-6  # rad, between joints that are two
_PITCH = 721  # points of the pitch line
_TICKS = 10  # deg
_LABELS = 30  # deg
_MARKS = 10  # mm
_TEXT = 2.5  # mm
_PLACES = 1441  # of the roller, against which points are held
_NEAR = 3  # steps between these, to either side of the nearest, within which it is sought further


def drums_of(case: Case) -> Iterator[tuple[Part, Drum]]:
    """Parts that are drums in one piece: one in two is printed."""
    whole = case.mechanism.assembly.whole_drums
    for part in case.parts.values():
        if part.drum is not None and part.name in whole:
            yield part, part.drum


def make_developments(case: Case) -> None:
    """Write the development of each drum, and the path of a cutter where one is asked for."""
    tolerance = case.mechanism.accuracy.chord_tolerance
    breaks = _breaks(case)
    for part, drum in drums_of(case):
        _write(case, part.name, _Development(drum, breaks), tolerance)
        if case.mechanism.files.cutter_radius is not None:
            _write_path(
                case.file(f"{part.name}-path", "csv"), drum, case.mechanism.files.cutter_radius
            )


def judge_developments(case: Case) -> Iterator[Finding]:
    """ROUND_TRIP of each: how far points of its contour are off the roller as it goes round, which knows no wall."""
    tolerance = case.mechanism.accuracy.chord_tolerance
    for part, drum in drums_of(case):
        path = case.file(f"{part.name}-developed", "dxf")
        rings, faults = read_contours(path)
        if faults or len(rings) != 1:
            remark = "; ".join(faults) or f"{len(rings)} contours instead of 1"
            yield at_most("ROUND_TRIP", math.nan, 0, "mm", in_file(path), remark)
            continue
        points = rings[0].samples()
        radius = drum.roller.middle
        straight = (points.imag < tolerance) | (points.imag > math.tau * radius - tolerance)
        straight |= (drum.track == "end") & (points.real < tolerance)
        off = np.abs(_clearance(drum, points[~straight]))
        remark = f"{len(off)} points of its walls against the roller at every angle"
        worst = float(np.max(off)) if len(off) else math.nan
        yield at_most("ROUND_TRIP", worst, 2 * tolerance, "mm", in_file(path), remark)
        if case.mechanism.files.cutter_radius is not None:
            yield _judged_path(case, part.name, drum, case.mechanism.files.cutter_radius)


# ---- the cutter ------------------------------------------------------------------------------------------------------


def _cutter_axis(wall: DrumWall, theta: Floats, cutter: float) -> tuple[Floats, Floats]:
    """Height and place beside the drum's axis, (n,) mm each, of a cutter that touches a wall half way along the roller, where the
    roller does."""
    psi = wall.contact(-theta, np.full(len(theta), wall.roller.middle))
    beyond = wall.roller.radius - cutter
    z = wall.path.height(-theta, 0) + beyond * np.cos(psi)
    return z, np.asarray(wall.path.beside(-theta, 0) + beyond * np.sin(psi))


def _write_path(path: Path, drum: Drum, cutter: float) -> None:
    """Along each wall."""
    theta = np.linspace(0, math.tau, _ROWS)
    rows: list[list[object]] = []
    for wall in drum.walls:
        z, y = _cutter_axis(wall, theta, cutter)
        rows += [
            [_SIDES[wall.side], f"{a:g}", f"{a:g}", f"{high:z.6f}", f"{aside:z.6f}"]
            for a, high, aside in zip(
                np.degrees(theta).tolist(), z.tolist(), y.tolist(), strict=True
            )
        ]
    write_rows(path, _PATH, rows)


def _judged_path(case: Case, part: str, drum: Drum, cutter: float) -> Finding:
    """ROUND_TRIP of a cutter's path: how far it leaves the roller's walls half way along the roller, by points of these walls and the
    rows alone; what it leaves or takes at floor and outside is told."""
    path = case.file(f"{part}-path", "csv")
    tolerance = case.mechanism.accuracy.chord_tolerance
    try:
        with open(path, encoding="utf-8", newline="") as file:
            head, *rows = csv.reader(file, strict=True)
        if tuple(head) != _PATH:
            raise ValueError(f"its columns must be {', '.join(_PATH)}")
        found = {
            name: np.array([list(map(float, row[1:])) for row in rows if row[0] == name])
            for name in _SIDES.values()
        }
        if any(found[_SIDES[wall.side]].shape != (_ROWS, 4) for wall in drum.walls):
            raise ValueError(f"{_ROWS} rows must be along each wall")
    except (OSError, UnicodeDecodeError, ValueError, csv.Error) as error:
        raise FileError(path, f"cannot be read as a cutter's path: {error}") from None
    ends = (drum.floor, drum.roller.middle, drum.outside)
    off = np.array(
        [
            [_left(wall, radius, found[_SIDES[wall.side]], cutter) for radius in ends]
            for wall in drum.walls
        ]
    )
    worst = np.abs(off).max(axis=(0, 2))
    remark = f"at the floor the cutter is {worst[0]:.2g} mm off the wall, outside {worst[2]:.2g} mm"
    limit = 2 * tolerance
    return at_most("ROUND_TRIP", float(worst[1]), limit, "mm", in_file(path), remark)


def _left(wall: DrumWall, radius: float, rows: Floats, cutter: float) -> Floats:
    """How far points of a wall on a cylinder stand off a cutter that runs along rows of its path, (n,) mm; below 0 it cuts them
    off."""
    beta = np.linspace(0, math.tau, _HELD, endpoint=False)
    z = wall.over(beta, np.array(radius)).z
    angle = np.radians(rows[:, 1])

    def off(phi: Floats) -> Floats:
        turned = np.mod(-phi, math.tau)
        high, aside = (np.interp(turned, angle, rows[:, k]) for k in (2, 3))
        apart = np.hypot(radius * np.sin(beta[:, None] - phi) - aside, z[:, None] - high)
        return np.where(np.cos(beta[:, None] - phi) > 0, apart - cutter, math.inf)

    low = beta - math.pi / 2
    width = math.pi
    row = np.arange(_HELD)
    for _ in range(_NEAR):
        phi = low[:, None] + width * np.linspace(0, 1, _PLACES // 8)
        best = np.argmin(off(phi), axis=1)
        step = width / (phi.shape[1] - 1)
        low = phi[row, best] - step
        width = 2 * step
    return np.asarray(off(phi)[row, best])


# ---- the development -------------------------------------------------------------------------------------------------


def _breaks(case: Case) -> Floats:
    """Cam angles at which a derivative of a follower's motion may jump, rad."""
    laws = [joint.law for joint in case.mechanism.model.joints if isinstance(joint, Cam)]
    return distinct(*(np.asarray(getattr(law, "breaks", ()), float) for law in laws))


@dataclass(frozen=True)
class _Development:
    """A drum's track on the cylinder half way along its roller."""

    drum: Drum
    breaks: Floats

    @property
    def radius(self) -> float:
        """Of the cylinder, mm."""
        return self.drum.roller.middle

    @property
    def around(self) -> float:
        """Length of its circle, mm."""
        return math.tau * self.radius

    def wall(self, wall: DrumWall) -> tuple[Smooth, ...]:
        """A wall over the turn, in pieces between the joints of the motion."""
        ends = np.array([*self._joints(wall), math.tau])
        joints = ends[:-1][(np.diff(ends) > _APART) & (ends[:-1] > _APART)].tolist()
        function = self._curve(wall)
        return tuple(
            Smooth(function, low, high) for low, high in pairwise((0.0, *joints, math.tau))
        )

    def _joints(self, wall: DrumWall) -> Floats:
        """Polar angles of the wall's points at the breaks of the motion, rad."""
        phi = -self.breaks
        depth = np.full(len(phi), self.radius)
        for _ in range(_ROUNDS):
            depth = depth + self.radius - wall.points(phi, depth).rho
        return distinct(np.mod(wall.points(phi, depth).beta, math.tau))

    def _curve(self, wall: DrumWall) -> Callable[[Floats, int], Points]:
        radius = np.array(self.radius)
        # point and tangent come one after the other
        points = latest(lambda beta: wall.over(beta, radius))

        def curve(beta: Floats, order: int) -> Points:
            beta = np.asarray(beta, float)
            if order == 0:
                return np.asarray(points(beta).z + 1j * radius * beta)
            if order == 1:
                return np.asarray(points(beta).along + 1j * radius)
            beside = wall.over(np.stack([beta - _STEP, beta + _STEP]), radius).along
            return np.asarray((beside[1] - beside[0]) / (2 * _STEP) + 0j)

        return curve

    @property
    def contour(self) -> Contour:
        """What is taken away, or left, counter-clockwise."""
        walls = [self.wall(each) for each in self.drum.walls]
        # up along the wall that is farther along the axis, and back along the other
        up = walls[-1]
        top = complex(up[-1].at(math.tau))
        if self.drum.track == "end":
            low = 0j
            high = 1j * self.around
            back: tuple[Smooth | Line, ...] = (Line(high, low),)
        else:
            back = tuple(each.reversed() for each in reversed(walls[0]))
            low = complex(walls[0][0].at(0.0))
            high = complex(walls[0][-1].at(math.tau))
        return Contour((*up, Line(top, high), *back, Line(low, complex(up[0].at(0.0)))))

    def path(self, wall: DrumWall, cutter: float) -> Points:
        """Where the axis of a cutter runs along a wall, wrapped, (n,) complex mm."""
        theta = np.linspace(math.tau, 0, _PITCH)
        z, y = _cutter_axis(wall, theta, cutter)
        turned = math.tau - theta + np.arctan2(y, self.radius)
        return np.asarray(z + 1j * self.radius * turned)

    @property
    def pitch(self) -> Points:
        """Where the roller's axis runs, (n,) complex mm."""
        phi = np.linspace(0, math.tau, _PITCH)
        aside = np.arctan2(self.drum.path.beside(phi, 0), self.radius)
        return np.asarray(self.drum.path.height(phi, 0) + 1j * self.radius * (phi + aside))


def _write(case: Case, part: str, development: _Development, tolerance: float) -> None:
    """A drum's drawing; both rollers of a rib have their own line."""
    drum = development.drum
    box = (-12 - 24j, complex(drum.length + 4, development.around + 4))
    cutter = case.mechanism.files.cutter_radius
    layers = _LAYERS if cutter is None else {**_LAYERS, **_CUTTER}
    with document(case.file(f"{part}-developed", "dxf"), layers, box) as space:
        add_contour(space, fit_arcs(development.contour, tolerance), CUT_LAYER)
        for shift in dict.fromkeys((-drum.pitch / 2, drum.pitch / 2)):
            line = [(z.real + shift, z.imag) for z in development.pitch.tolist()]
            space.add_lwpolyline(line, dxfattribs={"layer": "PITCH"})
        if cutter is not None:
            for wall in drum.walls:
                axis = development.path(wall, cutter)
                points = list(zip(axis.real.tolist(), axis.imag.tolist(), strict=True))
                space.add_lwpolyline(points, dxfattribs={"layer": "PATH"})
        scale = {"layer": "SCALE"}
        for x in (0.0, drum.length):
            space.add_line((x, 0), (x, development.around), dxfattribs=scale)
        for degrees in range(0, 361, _TICKS):
            y = development.around * (1 - degrees / 360)
            named = degrees % _LABELS == 0
            space.add_line((-4.0 if named else -2.0, y), (0, y), dxfattribs=scale)
            if named:
                text = space.add_text(f"{degrees}", height=_TEXT, dxfattribs=scale)
                text.set_placement((-11.0, y - _TEXT / 2))
        for x in range(0, math.floor(drum.length) + 1, _MARKS):
            space.add_line((x, -2.0), (x, 0), dxfattribs=scale)
            text = space.add_text(f"{x}", height=_TEXT, dxfattribs=scale)
            text.set_placement((x - 1.0, -2.5 - _TEXT))
        said = (
            f"{case.mechanism.name}, {part}: on the radius {development.radius:.4f}",
            f"once round {development.around:.4f} mm",
            "up: cam angle, deg, of a follower there",
            "across: from the lower end, mm",
        )
        for k, line_of_text in enumerate(said):
            text = space.add_text(line_of_text, height=_TEXT, dxfattribs=scale)
            text.set_placement((0.0, -10.0 - 4.0 * k))


def _clearance(drum: Drum, points: Points) -> Floats:
    """How far points of a development stand off the roller where it comes nearest, (n,) mm; below 0 it cuts them off."""
    radius = drum.roller.middle
    beta = points.imag / radius
    nearest = np.full(len(points), math.inf)
    for shift in dict.fromkeys((-drum.pitch / 2, drum.pitch / 2)):
        low = beta - math.pi / 2
        width = math.pi
        for _ in range(_NEAR):
            phi = low[:, None] + width * np.linspace(0, 1, _PLACES // 8)
            x = radius * np.cos(beta[:, None] - phi)
            aside = radius * np.sin(beta[:, None] - phi) - drum.path.beside(phi.ravel(), 0).reshape(
                phi.shape
            )
            level = (
                points.real[:, None] - shift - drum.path.height(phi.ravel(), 0).reshape(phi.shape)
            )
            off = np.hypot(aside, level) - drum.roller.at(x)
            best = np.argmin(np.where(x > 0, off, math.inf), axis=1)
            found = off[np.arange(len(points)), best]
            step = width / (phi.shape[1] - 1)
            low = phi[np.arange(len(points)), best] - step
            width = 2 * step
        nearest = np.minimum(nearest, found)
    return nearest
