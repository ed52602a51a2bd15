"""The judge of tables for machine tools: a cam's profile by its angle, and the path of a cutter round it.

    row      of a profile: cam angle, place on the outline (x, y and again radius, angle), contact normal, curvature, pressure
             angle, in the frame of the part
    centre   of a round tip as a row puts it: the tip's radius along the normal from the row's place
    riding   row without a normal: the follower rests on a corner of the outline

Nothing here knows the curve that was meant: rows are held against the outline in the part's own file, on which the follower is
rolled. Columns that follow from others of their row, such as the radius, are held against those to the last digit written.
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path

import numpy as np

from camgen.files.dxf import read_dxf
from camgen.findings import Finding, Where, at_most, in_file
from camgen.geometry.distances import point_to_ring
from camgen.geometry.rings import Floats, Ints, Points, Ring
from camgen.judge.contact_faces import ArmFace, SlideFace
from camgen.judge.contact_tips import ArmTip, SlideTip
from camgen.judge.contours import contour_error
from camgen.judge.joints import RollingLaw
from camgen.judge.round_trip import MILLIMETRES, PART_LAYERS
from camgen.judge.sheets import FACETS, along, widened
from camgen.numerics import magnitude
from camgen.tolerances import BOUND_SPARE

_DIGIT = 1e-9  # mm or deg, of a cell: it has nine decimals
_FOLLOWS = 1e-6  # deg, of an angle that follows from cells of its row
_STEEP = 0.25  # cosine of a pressure angle, 75 deg, that no cam is meant to reach, so that a wrong one widens no limit
# An arc of length L that leaves a curve by no more than e, as a cubic does, leaves its direction by 6 sqrt(3) e / L and its
# curvature by 36 sqrt(3) e / L^2, both at its ends.
_TURN = 6 * math.sqrt(3)
_BEND = 36 * math.sqrt(3)
_ROUGH = 0.05  # of its largest curvature, by which a polygon's own, that of circles through three corners, may be off
_SPREAD = 0.25  # of what neighbours differ by: a curvature that is largest in between is off their means by a sixth
_BLOCK = 1_000_000  # pairs of a place and an edge that are looked at together


@dataclass(frozen=True)
class Profile:
    """A table as read, (n,) each: theta, rad; places, complex mm, and again by radius, mm, and angle, rad; unit normals and
    curvature, 1/mm, both nan where a row has none; pressure angle, rad."""

    theta: Floats
    place: Points
    radius: Floats
    angle: Floats
    normal: Points
    curvature: Floats
    pressure_angle: Floats


def judge_profile(
    table: Path, profile: Profile, ring: Ring, law: RollingLaw, step_deg: float, tolerance: float
) -> list[Finding]:
    """ROUND_TRIP of each column of a profile's table.

    ring: the outline in the part's own file, material on its left; law: what the follower rolls to on it; step_deg: between
    rows; tolerance: mm, of outlines.
    """
    angles = np.arange(0, 360, step_deg)
    if len(profile.theta) != len(angles):
        remark = f"{len(profile.theta)} rows instead of {len(angles)}, one each {step_deg:g} deg"
        return [
            at_most(
                "ROUND_TRIP",
                math.nan,
                0,
                "mm",
                in_file(table),
                remark,
            )
        ]
    rows = _Rows(in_file(table), profile, _Edges(ring, tolerance), _Follower(law, profile.theta))
    return [
        rows.angles(angles),
        rows.places(),
        rows.polar(),
        *rows.follower(),
        rows.normals(),
        rows.pressure(),
        rows.curvature(),
    ]


# ---- the outline -----------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class _EdgeDistances:
    """Places against a ring, (m,) each: how far apart, mm; the nearest edge; how far a normal leans from that of the best edge
    that passes there, and how far it may, rad."""

    apart: Floats
    nearest: Ints
    lean: Floats
    limit: Floats


@dataclass(frozen=True)
class _Edges:
    """A ring within a tolerance, mm, of a curve, by its edges: what each says of the curve's direction and curvature."""

    ring: Ring
    tolerance: float

    @property
    def count(self) -> int:
        """How many there are."""
        return len(self.ring.points)

    @cached_property
    def length(self) -> Floats:
        """(n,) mm."""
        ring = self.ring
        return np.asarray(
            np.abs(ring.ends - ring.points) / np.sinc(2 * np.arctan(ring.bulges) / np.pi)
        )

    @cached_property
    def kink(self) -> Floats:
        """The turn where each straight edge begins, (n,) rad."""
        way = self.ring.ends - self.ring.points
        return np.angle(way / np.roll(way, 1))

    @cached_property
    def turn_limit(self) -> Floats:
        """How far the curve's direction may be off that of each edge, (n,) rad."""
        if self.ring.bulges.any():
            return _TURN * self.tolerance / self.length
        return np.maximum(np.abs(self.kink), np.abs(np.roll(self.kink, -1)))

    @cached_property
    def curvature(self) -> Floats:
        """(n,) 1/mm, above 0 where it is convex; of a polygon the mean of circles through three corners at either end."""
        if self.ring.bulges.any():
            return 4 * np.arctan(self.ring.bulges) / self.length
        at_start = 2 * self.kink / (self.length + np.roll(self.length, 1))
        return (at_start + np.roll(at_start, -1)) / 2

    @cached_property
    def bend_limit(self) -> Floats:
        """How far the curve's curvature may be off that of each edge, (n,) 1/mm."""
        if self.ring.bulges.any():
            return _BEND * self.tolerance / self.length**2
        return np.full(self.count, _ROUGH * magnitude(self.curvature))

    def distances(self, z: Points) -> tuple[Floats, Points]:
        """Distance of each place from each edge, mm, and the outward normal there, (m, n)."""
        a = self.ring.points
        b = self.ring.ends
        bulge = self.ring.bulges
        way = b - a
        curved = np.where(bulge == 0, 1.0, bulge)
        centre = (a + b) / 2 + 0.5j * way * (1 - curved**2) / (2 * curved)
        spoke = z[:, None] - centre
        radius = np.abs(a - centre)
        middle = (
            -1j * way / np.abs(way) * np.sign(curved)
        )  # from the centre to the middle of the arc
        ends = np.minimum(np.abs(z[:, None] - a), np.abs(z[:, None] - b))
        within = np.abs(np.angle(spoke * np.conj(middle))) <= 2 * np.arctan(np.abs(curved))
        arc = np.where(within, np.abs(np.abs(spoke) - radius), ends)
        fraction = np.clip(np.real((z[:, None] - a) * np.conj(way)) / np.abs(way) ** 2, 0, 1)
        straight = np.abs(z[:, None] - a - fraction * way)
        flat = bulge == 0
        normal = np.where(flat, -1j * way / np.abs(way), np.sign(curved) * spoke / np.abs(spoke))
        return np.where(flat, straight, arc), normal

    def against(self, z: Points, normal: Points) -> _EdgeDistances:
        """Places with their normals, (m,), against the edges."""
        apart = []
        nearest = []
        lean = []
        limit = []
        for k in range(0, len(z), max(_BLOCK // self.count, 1)):
            block = slice(k, k + max(_BLOCK // self.count, 1))
            distance, outward = self.distances(z[block])
            passes = distance <= np.maximum(np.min(distance, axis=1), 2 * self.tolerance)[:, None]
            off = np.where(passes, np.abs(np.angle(normal[block, None] * np.conj(outward))), np.inf)
            best = np.argmin(off / self.turn_limit, axis=1)
            apart.append(np.min(distance, axis=1))
            nearest.append(np.argmin(distance, axis=1))
            lean.append(off[np.arange(len(best)), best])
            limit.append(self.turn_limit[best])
        return _EdgeDistances(*map(np.concatenate, (apart, nearest, lean, limit)))


# ---- the follower ----------------------------------------------------------------------------------------------------


class _Follower:
    """A follower rolled to cam angles on an outline: ground, mm, the shaft at the origin.

    centre: of a round tip, or a point of a face, (n,); facing: a face's normal, (n,), None of a tip; sense: +1 or -1, in
    which s takes it off the outline.
    """

    def __init__(self, law: RollingLaw, theta: Floats) -> None:
        form = law.contact.form
        assert isinstance(form, ArmTip | SlideTip | ArmFace | SlideFace), (
            f"{form} is no follower of a cam"
        )
        self.law = law
        self.form = form
        self.theta = theta
        touch = law.contact.touch(theta)
        self.steepest = np.maximum(np.cos(touch.pressure_angle), _STEEP)
        self.radius = 0.0
        self.facing: Points | None = None
        s = touch.angle
        self.sense = (
            -form.leaves if isinstance(form, ArmTip | SlideTip) and form.inside else form.leaves
        )
        match form:
            case ArmTip():
                self.centre = form.pivot + form.arm * np.exp(1j * s)
                self.radius = form.tip_radius
            case SlideTip():
                self.centre = form.start + form.along * s
                self.radius = form.tip_radius
            case SlideFace():
                self.facing = np.full(len(s), form.leaves * complex(form.along))
                self.centre = form.start + form.along * s
            case ArmFace():
                self.facing = form.facing * np.exp(1j * s)
                self.centre = form.pivot + self.facing * form.ahead

    def ground(self, z: Points) -> Points:
        """Places of the part's frame when the cam has turned."""
        return np.asarray((self.law.turn * z + self.law.shift) * np.exp(1j * self.theta))

    def way(self, z: Points) -> Points:
        """The unit direction in which its point z moves off the cam."""
        if isinstance(self.form, SlideTip | SlideFace):
            return np.full(len(z), self.sense * complex(self.form.along))
        spoke = z - self.form.pivot
        return np.asarray(self.sense * 1j * spoke / np.abs(spoke))


# ---- the rows --------------------------------------------------------------------------------------------------------


class _Rows:
    """Findings on the columns of a table."""

    def __init__(self, where: Where, profile: Profile, edges: _Edges, follower: _Follower) -> None:
        self.rolled = follower
        self.edges = edges
        self.profile = profile
        self.where = where
        self.riding = np.isnan(profile.normal)
        self.off = 2 * edges.tolerance  # mm, of the outline in a file from one that is exact
        self.near = self.off * (1 + BOUND_SPARE) / follower.steepest  # mm, of the follower
        self.place = follower.ground(profile.place)
        self.normal = follower.law.turn * profile.normal * np.exp(1j * profile.theta)
        spoke = follower.centre - self.place if follower.facing is None else follower.facing
        self.spoke = np.where(self.riding, spoke / np.maximum(np.abs(spoke), _DIGIT), self.normal)
        self.distances = edges.against(profile.place, profile.normal)

    def _worst(
        self, columns: str, error: Floats, limit: Floats | float, unit: str, message: str
    ) -> Finding:
        """ROUND_TRIP of the row whose error is the largest share of its limit; nan is larger than any."""
        limits = np.broadcast_to(np.asarray(limit, float), error.shape)
        worst = int(np.argmax(np.where(np.isnan(error), np.inf, error / limits)))
        where = replace(
            self.where,
            thing=columns,
            theta=float(self.profile.theta[worst]),
            angle="row of",
            digits=None,
        )
        return at_most(
            "ROUND_TRIP", float(error[worst]), float(limits[worst]), unit, where, message
        )

    def angles(self, angles: Floats) -> Finding:
        """Of the cam's angles, deg."""
        off = np.abs(np.degrees(self.profile.theta) - angles)
        return self._worst(
            "theta_deg", off, 2 * _DIGIT, "deg", "rows in even steps of files.profile_step_deg"
        )

    def places(self) -> Finding:
        """Of the places, and of corners on which the follower rides."""
        off = self.distances.apart.copy()
        corners = np.abs(self.profile.place[self.riding, None] - self.edges.ring.points)
        off[self.riding] = np.min(corners, axis=1, initial=np.inf)
        remark = f"{len(off)} places against the outline that is cut, those without a normal against its corners"
        return self._worst("x_mm and y_mm", off, self.off, "mm", remark)

    def polar(self) -> Finding:
        """Of the same places by radius and angle."""
        profile = self.profile
        off = np.abs(profile.radius * np.exp(1j * profile.angle) - profile.place)
        limit = _DIGIT * (2 + np.abs(profile.place))
        return self._worst(
            "radius_mm and angle_deg",
            off,
            limit,
            "mm",
            "against the place that x and y give, to the last digit",
        )

    def follower(self) -> list[Finding]:
        """Of what a row says of the follower: where it is at that angle."""
        columns = "theta_deg, x_mm, y_mm and normal_deg"
        remark = "the follower as the row puts it, against the outline that is cut"
        rolled = self.rolled
        spoke = self.rolled.centre - self.place
        if rolled.facing is not None:
            lean = np.where(
                self.riding, 0.0, np.degrees(np.abs(np.angle(self.spoke * np.conj(rolled.facing))))
            )
            least = np.full(len(lean), _FOLLOWS)
            if isinstance(rolled.form, ArmFace):
                least = np.degrees(
                    self.near / np.maximum(np.abs(self.place - rolled.form.pivot), self.off)
                )
            height = np.abs(np.real(spoke * np.conj(rolled.facing)))
            return [
                self._worst(columns, height, self.near, "mm", remark),
                self._worst(
                    "theta_deg and normal_deg",
                    lean,
                    least,
                    "deg",
                    "the row's normal against that of the face",
                ),
            ]
        gap = np.where(
            self.riding,
            np.abs(np.abs(spoke) - rolled.radius),
            np.abs(spoke - rolled.radius * self.spoke),
        )
        return [self._worst(columns, gap, self.near, "mm", remark)]

    def normals(self) -> Finding:
        """Of the normals, against the outline."""
        lean = np.where(self.riding, 0.0, self.distances.lean)
        remark = "the row's normal against the outline that is cut; the limit is what arcs within the tolerance may lean"
        return self._worst(
            "normal_deg", np.degrees(lean), np.degrees(self.distances.limit), "deg", remark
        )

    def pressure(self) -> Finding:
        """Of the pressure angle: that of the row's normal and the way of the follower's point."""
        rolled = self.rolled
        angle = np.degrees(self.profile.pressure_angle)
        point = self.place + rolled.radius * self.spoke
        pressure = np.degrees(np.abs(np.angle(self.spoke * np.conj(rolled.way(point)))))
        corner = np.degrees(np.arctan2(self.near, max(rolled.radius, self.off)))
        remark = "the angle between the row's normal and the follower's direction"
        return self._worst(
            "pressure_angle_deg",
            np.abs(pressure - angle),
            np.where(self.riding, corner, _FOLLOWS),
            "deg",
            remark,
        )

    def curvature(self) -> Finding:
        """Of the curvature: among those that the outline has between the rows before and after; where five rows are on one arc,
        among the turns of their normals along their places."""
        curvature = self.profile.curvature
        low, high, limit = self._bends()
        means = self._turns()
        steps = np.stack([np.roll(means, k) for k in (2, 1, 0, -1)])
        on_one_arc = np.stack(
            [np.roll(self.distances.nearest, k) == self.distances.nearest for k in (-2, -1, 1, 2)]
        ).all(axis=0)
        on_one_arc &= np.isfinite(steps).all(axis=0)
        least = np.min(steps, axis=0)
        most = np.max(steps, axis=0)
        fine = _SPREAD * (most - least) + 1e3 * _DIGIT
        low = np.where(on_one_arc, least, low)
        high = np.where(on_one_arc, most, high)
        limit = np.where(on_one_arc, fine, limit)
        off = np.maximum(np.maximum(low - curvature, curvature - high), 0.0)
        off = np.where(self.riding, np.where(np.isnan(curvature), 0.0, np.inf), off)
        remark = "against the curvature of the outline that is cut, about the row's place"
        return self._worst("curvature_per_mm", off, limit, "1/mm", remark)

    def _turns(self) -> Floats:
        """Mean curvature from each row to the next one, (n,) 1/mm, nan where one of both has no normal."""
        z = self.profile.place
        normal = self.profile.normal
        way = np.roll(z, -1) - z
        turn = np.angle(np.roll(normal, -1) * np.conj(normal))
        side = np.sign(np.imag(np.conj(way) * normal))
        length = np.abs(way) / np.sinc(turn / math.tau)
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.where(length > FACETS, -side * turn / length, np.nan)

    def _bends(self) -> tuple[Floats, Floats, Floats]:
        """Least and greatest curvature of the edges from the row before to the row after, and how far off they may be, 1/mm."""
        edges = self.edges
        nearest = self.distances.nearest
        count = self.edges.count
        before, after = (
            (np.roll(nearest, k) - nearest + count // 2) % count - count // 2 for k in (1, -1)
        )
        first = np.minimum(np.minimum(before, after), 0) - 1
        last = np.maximum(np.maximum(before, after), 0) + 1
        bends = np.empty((3, len(first)))
        for k, (middle, a, b) in enumerate(
            zip(nearest.tolist(), first.tolist(), last.tolist(), strict=True)
        ):
            between = np.arange(middle + a, middle + b + 1) % count
            bends[:, k] = (
                edges.curvature[between].min(),
                edges.curvature[between].max(),
                edges.bend_limit[between].max(),
            )
        return bends[0], bends[1], bends[2]


# ---- the path of a cutter --------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Step:
    """A row of a path: its kind, its ends, mm, and of an arc its centre and radius, mm, and sweep, rad; nan each on a line."""

    kind: str
    start: complex
    end: complex
    centre: complex
    radius: float
    sweep: float

    @property
    def straight(self) -> bool:
        """Whether the cells of an arc are blank."""
        return all(map(math.isnan, (self.centre.real, self.centre.imag, self.radius, self.sweep)))

    @property
    def bulge(self) -> float:
        """The tangent of a quarter of the sweep, 0 on a line."""
        return 0.0 if self.straight else math.tan(self.sweep / 4)

    @property
    def named(self) -> bool:
        """Whether its kind is that of the cells that it fills."""
        whole = math.isfinite(abs(self.centre) + self.radius + self.sweep)
        return (
            self.kind == ("line" if self.straight else "arc ccw" if self.sweep > 0 else "arc cw")
            and whole != self.straight
        )

    @property
    def error(self) -> float:
        """How far the arc that centre and sweep tell ends from its end, or lies off its radius, mm; 0 of a line."""
        if self.straight:
            return 0.0
        spoke = self.start - self.centre
        return max(
            abs(abs(spoke) - self.radius),
            abs(self.centre + spoke * cmath.rect(1, self.sweep) - self.end),
        )


def judge_path(
    path: Path,
    pieces: Sequence[Step],
    outline: Ring,
    radius: float,
    limit: float,
    within: bool = False,
) -> list[Finding]:
    """A cutter's path round an outline, or within one, such as a groove's outer wall: the same in DXF and CSV; CUTTER: how far
    what the cutter leaves is from the outline.

    pieces: the table. What the cutter leaves is the area within the path less all that a disc of this radius, mm, covers about
    its points; or what is without both.
    """
    drawing = read_dxf(path)
    faults = [fault.message for fault in drawing.faults] + drawing.repainted(PART_LAYERS)
    faults += (
        []
        if drawing.units == MILLIMETRES
        else [f"$INSUNITS is {drawing.units}, millimetres are {MILLIMETRES}"]
    )
    faults += [] if len(drawing.cut) == 1 else [f"{len(drawing.cut)} contours instead of 1"]
    closed = at_most(
        "DXF_CLOSED",
        len(faults),
        0,
        "contours",
        in_file(path),
        "; ".join(faults) or "one closed contour",
    )
    if faults:
        return [closed]
    (ring,) = drawing.cut
    table = in_file(path.with_suffix(".csv"))
    findings = [closed, *_same_path(table, pieces, ring)]
    cut = widened(ring, radius if within else -radius, sharp=False)
    target = outline.facetted(FACETS)
    z = along(target)
    off = point_to_ring(z, cut.points)
    worst = int(np.argmax(off))
    remark = (
        f"distance of the outline from the path cut with radius {radius:g} mm, at x {z[worst].real:z.3f}, y {z[worst].imag:z.3f} mm; "
        "a cutter that is too large for a hollow needs a smaller files.cutter_radius"
    )
    spare = float(np.max(point_to_ring(cut.points, target)))
    return [
        *findings,
        at_most("CUTTER", max(float(off[worst]), spare), limit, "mm", in_file(path), remark),
    ]


def _same_path(table: Where, pieces: Sequence[Step], ring: Ring) -> list[Finding]:
    """ROUND_TRIP of a path's table, column by column, and of its contour against the ring in the DXF."""
    faults = [k + 1 for k, piece in enumerate(pieces) if not piece.named]
    remark = "line, arc ccw or arc cw, as the other cells of the row say" + (
        f"; not row {faults[0]}" if faults else ""
    )
    off = math.nan if faults else 0.0
    kinds = at_most("ROUND_TRIP", off, 0, "mm", replace(table, thing="piece"), remark)
    if faults or not pieces:
        return [
            kinds,
            at_most("ROUND_TRIP", math.nan, 0, "mm", table, f"{len(pieces)} lines and arcs"),
        ]
    gaps = [
        abs(step.end - following.start)
        for step, following in zip(pieces, (*pieces[1:], *pieces[:1]), strict=True)
    ]
    size = max(max(abs(piece.start), 0.0 if piece.straight else piece.radius) for piece in pieces)
    digits = 4 * _DIGIT * (1 + size / 50)  # nine decimals of a degree are 1 / 57 of that in rad
    remark = "where each arc ends by its centre, radius and sweep, against its end"
    columns = replace(table, thing="centre_x_mm, centre_y_mm, radius_mm and sweep_deg")
    arcs = at_most(
        "ROUND_TRIP", max(piece.error for piece in pieces), digits, "mm", columns, remark
    )
    ends = at_most(
        "ROUND_TRIP",
        max(gaps),
        digits,
        "mm",
        replace(table, thing="x0_mm, y0_mm, x1_mm and y1_mm"),
        "from the end of each piece to the next",
    )
    table_ring = Ring(
        np.array([piece.start for piece in pieces]), np.array([piece.bulge for piece in pieces])
    )
    off = contour_error(table_ring, ring, FACETS)
    remark = f"{len(pieces)} lines and arcs, as in the DXF"
    return [kinds, arcs, ends, at_most("ROUND_TRIP", off, 2 * FACETS, "mm", table, remark)]
