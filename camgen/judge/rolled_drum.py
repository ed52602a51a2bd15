"""A roller in a drum over one turn, from the drum's mesh alone: what it is told, and what is free for its follower.

low, high    ends of what is free for the follower, mm along the drum's axis, or rad of its arm; an end cam has the low one
middle       half way between, which is told as the motion; of an end cam the low end, on which a spring holds it
play         high less low: below 0 where the roller is wider than the track
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Annotated, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from camgen.errors import DesignError, Fault, SpecError
from camgen.findings import Finding, Where, at_least, at_most
from camgen.geometry.mesh import Mesh
from camgen.judge.follower_table import Point
from camgen.judge.rolled_solid import SolidRoller, Wall, crossed, limits, walls
from camgen.machine.features import DrumTrack
from camgen.numerics import Floats, low_passed
from camgen.spec import Checked, Coordinate, Length

SAMPLES = 2880  # of the turn
_SMALLER = 4.0  # tolerances, by which a roller is smaller that is held against all but its walls: facets are in it
_LEAST_GAP = 1.5  # of the roller's radius, between the middles of both walls of a groove: less is none for it
_AXES = {
    "x": [1, 2, 0],
    "y": [2, 0, 1],
    "z": [0, 1, 2],
}  # of the file, turned so that the third is the drum's
_CONE = Annotated[float, Field(ge=-45, le=45)]
_DEGREES = Annotated[float, Field(ge=-360, le=360)]


class RollerTable(Checked):
    """A roller and its follower beside a drum; the drum turns counter-clockwise about its axis.

    radius: half way along the roller; cone_deg: half angle of a cone, positive where it grows outwards. inner: distance of the
    roller's inner end from the drum's axis. track: "groove", the roller between two walls; "end", on the wall below it; "rib",
    two rollers astride, `distance` between their axes. axis, centre: the drum's axis in the file, along z through X/Y (along x
    through Y/Z, along y through Z/X). at_deg: where the roller stands, counter-clockwise from the first of these.
    A follower on a slide along the axis: offset, its line beside the radial one, positive counter-clockwise. On an arm: arm, its
    length; pivot, its place beside the radial line and along the axis. height: roughly where the roller's axis is, of several tracks.
    tolerance: by which the mesh's facets may stand off the walls.
    """

    radius: Length
    length: Length
    inner: Length
    cone_deg: _CONE = 0.0
    track: Literal["groove", "rib", "end"] = "groove"
    distance: Length | None = None
    axis: Literal["x", "y", "z"] = "z"
    centre: Point = (0.0, 0.0)
    at_deg: _DEGREES = 0.0
    offset: Coordinate | None = None
    arm: Length | None = None
    pivot: Point | None = None
    height: Coordinate | None = None
    tolerance: Annotated[float, Field(ge=0, le=1)] = 1e-3

    def faults(self) -> Sequence[Fault]:
        """What is wrong between keys that are right one by one."""
        faults = []
        if (self.arm is None) != (self.pivot is None):
            missing = "pivot" if self.pivot is None else "arm"
            faults.append(Fault((missing,), "", "missing: an arm needs arm=A and pivot=Y/Z"))
        if self.arm is not None and self.offset is not None:
            faults.append(
                Fault(
                    ("offset",),
                    f"{self.offset:g}",
                    "no value here: a roller on an arm has no offset",
                )
            )
        if (self.track == "rib") != (self.distance is not None):
            right = "missing" if self.track == "rib" else "no value here"
            value = "" if self.distance is None else f"{self.distance:g}"
            faults.append(
                Fault(
                    ("distance",),
                    value,
                    f"{right}: only a rib has two rollers, and this is the distance of their axes",
                )
            )
        if self.track == "rib" and self.arm is not None:
            faults.append(
                Fault(("arm",), f"{self.arm:g}", "no value here: the rollers of a rib slide")
            )
        if self.solid.radius <= abs(self.solid.slope) * self.length / 2:
            right = "an angle at which the roller does not end in a point"
            faults.append(Fault(("cone_deg",), f"{self.cone_deg:g}", right))
        return faults

    @cached_property
    def solid(self) -> SolidRoller:
        """The roller for the judge."""
        slope = math.tan(math.radians(self.cone_deg))
        return SolidRoller(self.inner, self.inner + self.length, self.radius, slope)

    def beside(self, height: Floats) -> Floats:
        """How far the roller's axis lies beside the radial line, mm, by its height."""
        if self.arm is None or self.pivot is None:
            return np.full(len(height), self.offset or 0.0)
        aside, level = self.pivot
        with np.errstate(invalid="ignore"):
            reach = np.sqrt(self.arm**2 - (height - level) ** 2)
        return np.asarray(aside - math.copysign(1.0, aside) * reach)

    def follower(self, height: Floats) -> Floats:
        """The follower's place by the height of its roller: the same, mm, or the angle of its arm, rad."""
        if self.arm is None or self.pivot is None:
            return height
        return np.asarray(np.arcsin((height - self.pivot[1]) / self.arm))

    @property
    def unit(self) -> tuple[str, float]:
        """What people read the follower's place in, and how many of it one has."""
        return ("mm", 1.0) if self.arm is None else ("deg", math.degrees(1))


def roller_table(track: DrumTrack, tolerance: float, middle: float | None = None) -> RollerTable:
    """What `camgen motion` would be told of a drum's roller; middle: of its motion, mm or rad, where a wrong file may have several
    tracks."""
    radius, length, inner, cone = track.roller
    arm = track.arm or (None, 0.0, 0.0)
    height = middle
    if track.arm is not None and middle is not None:
        height = track.arm[2] + track.arm[0] * math.sin(middle)
    return RollerTable(
        radius=radius,
        length=length,
        inner=inner,
        cone_deg=cone,
        track=track.track,
        distance=track.distance,
        offset=None if track.arm else track.offset,
        arm=arm[0],
        pivot=arm[1:] if track.arm else None,
        tolerance=tolerance,
        height=height,
    )


@dataclass(frozen=True, eq=False)
class Rolled:
    """What is free for the follower over one turn, its end left out, (n,) each: mm, or rad of an arm.

    theta: rad; high: nan throughout on an end cam. speed, acceleration: low-passed derivatives of the motion to theta.
    pressure_angle: rad, at the roller's inner end, where it is largest. cut: whether the roller cuts into anything but its walls,
    such as the floor of a groove. between: by which a bound may be off between samples, mm.
    """

    theta: Floats
    low: Floats
    high: Floats
    speed: Floats
    acceleration: Floats
    pressure_angle: Floats
    cut: NDArray[np.bool_]
    between: float
    track: Literal["groove", "rib", "end"]

    @property
    def motion(self) -> Floats:
        """The middle of what is free; of an end cam its low end."""
        return self.low if self.track == "end" else (self.low + self.high) / 2

    @property
    def play(self) -> Floats:
        """High less low, nan on an end cam."""
        return self.high - self.low


def roll(mesh: Mesh, table: RollerTable, harmonics: int, samples: int = SAMPLES) -> Rolled:
    """Roll the roller round the track of a drum, its mesh as in the file.

    SpecError where the drum has several tracks and the table does not say which; DesignError where it has none.
    """
    axes = _AXES[table.axis]
    centre = np.array([*table.centre, 0.0])
    placed = Mesh(mesh.vertices[:, axes] - centre, mesh.faces)
    below, above = _track(walls(placed, table.inner), table)
    # the drum turns by theta: the roller stands at at_deg - theta on it
    phi = np.linspace(0, math.tau, samples, endpoint=False)
    theta = (math.radians(table.at_deg) - phi) % math.tau
    order = np.argsort(theta)
    heights = [
        np.full(samples, math.nan)
        if wall is None
        else limits(wall, table.solid, phi, table.beside)[order] - shift
        for wall, shift in zip((below, above), _shifts(table), strict=True)
    ]
    low, high = (table.follower(height) for height in heights)
    level = heights[0] if table.track == "end" else (heights[0] + heights[1]) / 2
    motion = table.follower(level)
    speed, acceleration = (low_passed(motion, order, harmonics) for order in (1, 2))
    pressure = _pressure_angle(table, level, motion, speed)
    cut = _cut(placed, (below, above), table, phi[order], level)
    outer = float(np.hypot(placed.vertices[:, 0], placed.vertices[:, 1]).max())
    steep = math.cos(float(np.nanmax(np.abs(pressure), initial=0.0)))
    bend = min(outer, math.hypot(table.inner + table.length, table.solid.largest)) ** 2
    between = bend / (table.radius * max(steep, 1e-3) ** 3) * (math.tau / samples) ** 2 / 8
    return Rolled(theta[order], low, high, speed, acceleration, pressure, cut, between, table.track)


def _cut(
    mesh: Mesh,
    track: tuple[Wall, Wall | None],
    table: RollerTable,
    phi: Floats,
    level: Floats,
) -> NDArray[np.bool_]:
    """Whether a roller, the follower at these heights, cuts into the drum beside the walls of its track, (n,)."""
    rest = np.ones(len(mesh.faces), bool)
    for wall in track:
        if wall is not None:
            rest[wall.rows] = False
    slack = _SMALLER * table.tolerance
    roller = table.solid
    smaller = replace(
        roller,
        inner=roller.inner + slack,
        outer=roller.outer - slack,
        radius=roller.radius - slack,
    )
    corners = mesh.vertices[mesh.faces[rest]]
    order = np.argsort(phi)
    found = np.zeros(len(phi), bool)
    for shift in dict.fromkeys(_shifts(table)):
        height = (level + shift)[order]
        cut = crossed(corners, smaller, phi[order], height, table.beside(level)[order])
        found[order] |= cut
    return found


def _shifts(table: RollerTable) -> tuple[float, float]:
    """Of the rollers on both walls, from the follower."""
    half = (table.distance or 0.0) / 2
    return half, -half


def _track(found: list[Wall], table: RollerTable) -> tuple[Wall, Wall | None]:
    """The wall below a roller and the one above, of all walls from below upwards."""
    sides = (1, -1) if table.track == "rib" else (-1, 1)
    tracks: list[tuple[Wall, Wall | None]] = []
    if table.track == "end":
        tracks = [(wall, None) for wall in found if wall.side < 0]
    else:
        for first, second in zip(found, found[1:], strict=False):
            narrow = second.height - first.height < _LEAST_GAP * table.radius
            if (first.side, second.side) == sides and not (narrow and table.track == "groove"):
                tracks.append((first, second) if sides[0] < 0 else (second, first))
    if not tracks:
        remedy = f"no walls of a track = {table.track} go round beyond inner = {table.inner:g} mm: check axis, centre and inner"
        raise DesignError("tracks", 0, 1, "", "the drum", remedy)
    levels = [
        below.height + table.radius if above is None else (below.height + above.height) / 2
        for below, above in tracks
    ]
    if len(tracks) > 1 and table.height is None:
        places = ", ".join(f"{level:.4g}" for level in levels)
        right = f"missing: the drum has {len(tracks)} tracks, at {places} mm along its axis"
        raise SpecError([Fault(("height",), "", right)], "--roller")
    wanted = levels[0] if table.height is None else table.height
    return tracks[int(np.argmin([abs(level - wanted) for level in levels]))]


def _pressure_angle(table: RollerTable, height: Floats, motion: Floats, speed: Floats) -> Floats:
    """Between the contact normal of the low-passed motion at the roller's inner end and the way of the roller's axis, rad.

    With reach r* + Y' and climb Z' to phi, as of the wall above: psi = -atan2(Z', r* + Y') - asin(Y tan(delta) / V), less the
    angle of the arm; positive where the wall pushes counter-clockwise.
    """
    roller = table.solid
    beside = table.beside(height)
    inner = np.array(roller.inner)
    reach = inner + roller.at(inner) * roller.slope
    if table.arm is None or table.pivot is None:
        way = np.zeros(len(height))
        climb = -speed
        aside = np.zeros(len(height))
    else:
        way = math.copysign(1.0, table.pivot[0]) * motion
        climb = -table.arm * np.cos(motion) * speed
        aside = -table.arm * np.sin(way) * speed
    size = np.hypot(reach + aside, climb)
    return np.asarray(
        -np.arctan2(climb, reach + aside) - np.arcsin(beside * roller.slope / size) - way
    )


# ---- findings --------------------------------------------------------------------------------------------------------


def track_findings(
    rolled: Rolled, table: RollerTable, where: Where, clearance: float = 0.0
) -> list[Finding]:
    """CONTACT, GROOVE_FIT and INTERFERENCE of a roller in a file; clearance: least play that is meant, mm."""
    return [
        _contact(rolled, where),
        *_fit(rolled, table, where, clearance),
        _interference(rolled, where),
    ]


def _contact(rolled: Rolled, where: Where) -> Finding:
    """CONTACT: at how many angles the roller meets its walls."""
    lost = np.isnan(rolled.motion)
    if lost.any():
        where = replace(where, theta=float(rolled.theta[np.flatnonzero(lost)[0]]))
    share = 100 * float(np.mean(~lost))
    message = "of the turn the roller meets the walls of its track"
    if lost.any():
        message += "; no speed or acceleration is given"
    return at_least("CONTACT", share, 100, "percent", where, message)


def _fit(rolled: Rolled, table: RollerTable, where: Where, clearance: float) -> Iterator[Finding]:
    """GROOVE_FIT: whether the roller has room between both walls, but for what facets take."""
    if table.track == "end":
        return
    name, scale = table.unit
    of_way = scale / table.arm if table.arm else 1.0
    play = rolled.play * scale
    least = math.nan
    if np.isfinite(play).any():
        k = int(np.nanargmin(play))
        least = float(play[k])
        where = replace(where, theta=float(rolled.theta[k]))
    facets = 2 * table.tolerance * of_way
    message = (
        f"least play of the roller between both walls; facets may reduce it by {facets:.2g} {name}"
    )
    yield at_least("GROOVE_FIT", least, clearance * of_way - facets, name, where, message)


def _interference(rolled: Rolled, where: Where) -> Finding:
    """INTERFERENCE: whether the roller has room beside its walls."""
    share = 100 * float(np.mean(rolled.cut))
    message = f"the roller cuts into the drum beside its walls over {share:.3g} % of the turn"
    if rolled.cut.any():
        where = replace(where, theta=float(rolled.theta[np.flatnonzero(rolled.cut)[0]]))
        message += ", such as into the floor: check inner, length and at_deg"
    return at_most("INTERFERENCE", math.nan if share else 0.0, 0, "mm", where, message)
