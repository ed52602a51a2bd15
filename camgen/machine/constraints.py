"""The conditions of all joints and their Jacobian; the judge closes a machine on them (`closing`), all bodies at once.

It knows nothing of loops and dyads. Every moving body has a pose (x, y, angle); every joint says by how much it is open
and how that changes with the poses; measured centres, guide lines and rolled cam laws stand in the same joints. The one
Jacobian of these conditions gives speeds, accelerations, how far a displacement in each joint moves each output, and,
transposed, the forces: those that serve a machine of the maker too (`run`, `forces`, `freedom`).

    q       poses, (n, 3 bodies): x mm, y mm, angle rad of each moving body in the machine's order
    rows    of each joint and drive: Pin x, y; Slide across (mm), turn (rad); Slot across; Gear, Cam, Clutch, Drive one scalar
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np

from camgen.machine.elimination import Elimination, Row, order_of, solved, transposed
from camgen.machine.model import (
    GROUND,
    Along,
    Angle,
    Cam,
    Clutch,
    Drive,
    Function,
    Gear,
    Joint,
    Machine,
    Path,
    Pin,
    Place,
    Slide,
    Slot,
)
from camgen.numerics import Floats, Points


@dataclass
class Conditions:
    """Conditions written down at n poses: values (n,), slopes by column, curvatures: second derivatives with q'' = 0.

    A slope is a float where it is the same at all poses, else (n,).
    """

    values: list[Floats] = field(default_factory=list)
    slopes: list[dict[int, Any]] = field(default_factory=list)
    curvatures: list[Any] = field(default_factory=list)

    def add(self, value: Any, slopes: dict[int, Any], curvature: Any) -> None:
        """Write one down; a slope that is 0 at all poses is none."""
        self.values.append(value)
        self.slopes.append(
            {k: s for k, s in slopes.items() if not (isinstance(s, float) and s == 0.0)}
        )
        self.curvatures.append(curvature)

    def misfits(self, n: int) -> Floats:
        """All values, (n, rows)."""
        return _side_by_side(self.values, n)

    def bends(self, n: int) -> Floats:
        """All curvatures, (n, rows)."""
        return _side_by_side(self.curvatures, n)

    def matrices(self, n: int, width: int) -> Floats:
        """The slopes, (n, rows, width)."""
        slopes = np.zeros((len(self.slopes), width, n))
        for r, row in enumerate(self.slopes):
            for k, slope in row.items():
                slopes[r, k] = slope  # angles lie side by side: what stays empty costs nothing
        return np.moveaxis(slopes, -1, 0)


def _side_by_side(rows: Sequence[Any], n: int) -> Floats:
    """Numbers by row, each (n,) or one for all, as (n, rows)."""
    table = np.empty((n, len(rows)))
    for r, row in enumerate(rows):
        table[:, r] = row
    return table


@dataclass(frozen=True)
class _Point:
    """A place at the poses."""

    position: Any  # complex mm
    swing: Any  # its slope to its body's angle
    column: int  # its body's first, -1 of the ground
    rate: Any  # of its body's angle

    @property
    def speed(self) -> Any:
        """What the turn gives to its speed."""
        return self.swing * self.rate


@dataclass(frozen=True)
class _Poses:
    """Poses of all bodies at n angles, with rates q' where they are wanted; what the places of a body share is made once."""

    q: Floats  # (n, 3 bodies)
    rates: Floats | None = None
    _bodies: dict[int, tuple[Points, Points]] = field(default_factory=dict)

    def body(self, column: int) -> tuple[Points, Points]:
        """Where a body's origin is, mm, and the unit along its x axis, (n,) each; column: its first."""
        if column not in self._bodies:
            x, y, angle = (self.q[:, column + k] for k in range(3))
            self._bodies[column] = x + 1j * y, np.exp(1j * angle)
        return self._bodies[column]


class Constraints:
    """The conditions of a machine, ready at any poses."""

    def __init__(self, machine: Machine) -> None:
        self.machine = machine
        self.bodies = [body.name for body in machine.moving]
        self.column = {name: 3 * k for k, name in enumerate(self.bodies)} | {GROUND: -1}
        self.width = 3 * len(self.bodies)
        self.rows: dict[str, slice] = {}
        self._turning_slides = _forest(machine)
        self.conditions: tuple[Joint | Drive, ...] = (*machine.joints, *machine.drives)
        row = 0
        for each in self.conditions:
            count = (
                2
                if isinstance(each, Pin)
                or (isinstance(each, Slide) and each.name in self._turning_slides)
                else 1
            )
            self.rows[each.name] = slice(row, row + count)
            row += count
        self.height = row
        start = [machine.start_of(body) for body in self.bodies]
        self.start = np.array(
            [part for p in start for part in (p.place.real, p.place.imag, p.angle)], float
        )
        levers = [abs(z) for body in machine.bodies for z in body.points.values()]
        self.size = max(1.0, np.abs(self.start).max(initial=0), *levers)
        self.unit = np.tile([self.size, self.size, 1.0], len(self.bodies))

    @cached_property
    def order(self) -> Elimination:
        """In which order displacements of the poses are found from those of the joints."""
        return order_of(self.written(self.start[None], np.zeros(1)).slopes)

    @cached_property
    def _order_back(self) -> Elimination:
        """The same of the transposed."""
        return order_of(transposed(self.written(self.start[None], np.zeros(1)).slopes))

    def moved(self, slopes: Sequence[Row], right: Floats) -> Floats:
        """How the poses move, (n, 3 bodies) or (n, 3 bodies, m), where slopes times that is right, (n, rows) or (n, rows, m)."""
        return solved(self.order, slopes, right)

    # ---- conditions ----

    def angle(self, body: str, q: Floats) -> Any:
        """A body's angle, (n,) rad."""
        return 0.0 if body == GROUND else q[:, self.column[body] + 2]

    def _cam_angle(self, cam: Cam, q: Floats) -> Floats:
        """At which a cam's law is asked, (n,) rad."""
        return np.asarray(self.angle(cam.cam, q) - cam.phase + np.zeros(len(q)))

    def place(self, place: Place, q: Floats) -> _Point:
        """A place at the poses."""
        return self._place(place, _Poses(q))

    def _place(self, place: Place, poses: _Poses) -> _Point:
        """The same, with its rate where rates are given."""
        k = self.column[place.body]
        if k < 0:
            return _Point(np.full(len(poses.q), complex(place.at)), 0j, -1, 0.0)
        origin, along = poses.body(k)
        spoke = place.at * along
        rate = 0.0 if poses.rates is None else poses.rates[:, k + 2]
        return _Point(origin + spoke, 1j * spoke, k, rate)

    def _line(self, slide: Slide | Slot, poses: _Poses) -> tuple[Any, dict[int, Any], Any]:
        """Runner seen from the guide: complex, along + i across; its slopes by column and its second derivative, q'' = 0."""
        q = poses.q
        rates = poses.rates
        guide = self._place(slide.guide, poses)
        runner = self._place(slide.runner, poses)
        axes = np.exp(-1j * (self.angle(slide.guide.body, q) + slide.angle)) * np.ones(len(q))
        offset = runner.position - guide.position
        slopes = _slopes(runner, guide, axes)
        if guide.column >= 0:
            slopes[guide.column + 2] = slopes[guide.column + 2] - 1j * axes * offset
        curvature: Any = 0.0
        if rates is not None:
            w = guide.rate
            speed = runner.speed - guide.speed
            for point, sign in ((runner, 1.0), (guide, -1.0)):
                if point.column >= 0:
                    speed = speed + sign * (
                        rates[:, point.column] + 1j * rates[:, point.column + 1]
                    )
            centripetal = 1j * (runner.speed * runner.rate - guide.speed * guide.rate)
            curvature = axes * (centripetal - 2j * w * speed - w * w * offset)
        return offset * axes, slopes, curvature

    def along(self, name: str, q: Floats) -> tuple[Any, dict[int, Any], Any]:
        """Place along a slide or slot, mm, its slopes and its second derivative with q'' = 0."""
        return self._along(name, _Poses(q))

    def _along(self, name: str, poses: _Poses) -> tuple[Any, dict[int, Any], Any]:
        """The same, its second derivative where rates are given."""
        value, slopes, curvature = self._line(self.machine.slide(name), poses)
        return value.real, {k: slope.real for k, slope in slopes.items()}, np.real(curvature)

    def written(self, q: Floats, theta: Floats, rates: Floats | None = None) -> Conditions:
        """All conditions at the poses; with rates q' their curvatures too."""
        rows = Conditions()
        poses = _Poses(q, rates)
        for each in self.conditions:
            self._write(each, poses, theta, rows)
        return rows

    def evaluate(
        self, q: Floats, theta: Floats, rates: Floats | None = None
    ) -> tuple[Floats, Floats, Floats]:
        """Misfits (n, rows), their slopes (n, rows, columns), and with rates q' their second derivatives where q'' = 0."""
        n = len(q)
        rows = self.written(q, theta, rates)
        return rows.misfits(n), rows.matrices(n, self.width), rows.bends(n)

    def _write(self, each: Joint | Drive, poses: _Poses, theta: Floats, rows: Conditions) -> None:
        """Write down the conditions of one joint or drive."""
        q = poses.q
        if isinstance(each, Pin):
            a = self._place(each.a, poses)
            b = self._place(each.b, poses)
            gap = a.position - b.position
            curvature = 1j * (a.swing * a.rate**2 - b.swing * b.rate**2)
            slopes = _slopes(a, b)
            rows.add(gap.real, {k: np.real(s) for k, s in slopes.items()}, np.real(curvature))
            rows.add(gap.imag, {k: np.imag(s) for k, s in slopes.items()}, np.imag(curvature))
        elif isinstance(each, Slide | Slot):
            line, slopes, curvature = self._line(each, poses)
            rows.add(line.imag, {k: s.imag for k, s in slopes.items()}, np.imag(curvature))
            if isinstance(each, Slide) and each.name in self._turning_slides:
                turn = self.angle(each.runner.body, q) - self.angle(each.guide.body, q) - each.turn
                rows.add(turn, self._turns((each.runner.body, 1.0), (each.guide.body, -1.0)), 0.0)
        elif isinstance(each, Gear):
            parts = ((each.b, 1.0), (each.a, -each.ratio), (each.carrier, each.ratio - 1.0))
            value = np.full(len(q), -each.phase)
            for body, factor in parts:
                value += factor * self.angle(body, q)
            rows.add(value, self._turns(*parts), 0.0)
        elif isinstance(each, Clutch):
            apart = each.apart(theta)
            locked = np.isnan(apart)
            angle = self.angle(each.b, q)
            value = np.where(
                locked, angle - each.law(theta, 0), angle - self.angle(each.a, q) - apart
            )
            rows.add(value, self._turns((each.b, 1.0), (each.a, np.where(locked, 0.0, -1.0))), 0.0)
        else:
            self._write_law(each, poses, theta, rows)

    def _write_law(self, each: Cam | Drive, poses: _Poses, theta: Floats, rows: Conditions) -> None:
        """A cam's or a drive's condition: follower - rest - law."""
        q = poses.q
        rates = poses.rates
        body = each.follower if isinstance(each, Cam) else each.body
        if each.slide is not None:
            value, slopes, curvature = self._along(each.slide, poses)
        else:
            value = self.angle(body, q)
            slopes = self._turns((body, 1.0))
            curvature = 0.0
        if isinstance(each, Drive):
            rows.add(
                value - each.law(theta, 0),
                slopes,
                curvature - (0.0 if rates is None else each.law(theta, 2)),
            )
            return
        if each.over is not None:
            self._write_linear(each, poses, rows, (value, slopes, curvature))
            return
        angle = self._cam_angle(each, q)
        if each.cam != GROUND:
            k = self.column[each.cam] + 2
            slopes = {**slopes, k: slopes.get(k, 0.0) - each.law(angle, 1)}
            if rates is not None:
                curvature = curvature - each.law(angle, 2) * rates[:, k] ** 2
        rows.add(value - each.rest - each.law(angle, 0), slopes, curvature)

    def argument(self, cam: Cam, q: Floats) -> Floats:
        """What the law of a cam is asked at in these poses, (n,): its angle, rad, or its place along its slide, mm, less the phase."""
        carried = self.angle(cam.cam, q) if cam.over is None else self.along(cam.over, q)[0]
        return np.asarray(carried - cam.phase + np.zeros(len(q)))

    def _write_linear(
        self,
        each: Cam,
        poses: _Poses,
        rows: Conditions,
        follower: tuple[Any, dict[int, Any], Any],
    ) -> None:
        """The condition of a cam that slides; follower: its place or angle, slopes and curvature."""
        assert each.over is not None
        value, slopes, curvature = follower
        rates = poses.rates
        place, onward, bend = self._along(each.over, poses)
        place = place - each.phase
        slope = each.law(place, 1)
        slopes = dict(slopes)
        for k, share in onward.items():
            slopes[k] = slopes.get(k, 0.0) - slope * share
        if rates is not None:
            speed = sum(share * rates[:, k] for k, share in onward.items())
            curvature = curvature - slope * bend - each.law(place, 2) * speed**2
        rows.add(value - each.rest - each.law(place, 0), slopes, curvature)

    def _turns(self, *parts: tuple[str, Any]) -> dict[int, Any]:
        """Slopes of a sum of angles."""
        slopes: dict[int, Any] = {}
        for body, factor in parts:
            if body != GROUND:
                k = self.column[body] + 2
                slopes[k] = slopes.get(k, 0.0) + factor
        return slopes

    def turned(self, q: Floats, theta: Floats) -> Floats:
        """The poses, (n, 3 bodies), with each body turned as a drive says, or the law of a cam whose body is turned so.

        Newton's method then asks each of these laws where it is wanted from the first step on, not near there.
        """
        q = q.copy()
        turned = {GROUND}
        for drive in self.machine.drives:
            if drive.slide is None and drive.body not in turned:
                q[:, self.column[drive.body] + 2] = drive.law(theta, 0)
                turned.add(drive.body)
        waiting = [
            each
            for each in self.machine.joints
            if isinstance(each, Cam) and each.slide is None and each.over is None
        ]
        for _ in range(len(waiting)):
            for each in waiting:
                if each.cam in turned and each.follower not in turned:
                    q[:, self.column[each.follower] + 2] = each.rest + each.law(
                        self._cam_angle(each, q), 0
                    )
                    turned.add(each.follower)
        return q

    def drift(self, theta: Floats) -> Floats:
        """How the conditions change with theta at fixed poses, (n, rows): only the drives do."""
        change = np.zeros((len(theta), self.height))
        for drive in self.machine.drives:
            change[:, self.rows[drive.name].start] = -drive.law(theta, 1)
        return change

    def refuse_unequal(self) -> None:
        """Raise ValueError where there are more or fewer conditions than freedoms."""
        if self.height != self.width:
            raise ValueError(
                f"{self.height} conditions for {len(self.bodies)} bodies with 3 degrees of freedom each"
            )

    # ---- outputs ----

    def output(self, name: str, q: Floats) -> tuple[Any, Floats]:
        """An output's value, (n,), complex mm for a path, and its slopes to the poses, (n, 1 or 2, 3 bodies)."""
        return self.measure(self.machine.output(name).of, q)

    def measure(self, of: Angle | Along | Path | Function, q: Floats) -> tuple[Any, Floats]:
        """What an output measures, as `output`."""
        n = len(q)
        gradient = np.zeros((n, 2 if isinstance(of, Path) else 1, self.width))
        if isinstance(of, Path):
            point = self.place(of.of, q)
            self._enter(gradient[:, 0], point, np.ones(n, complex))
            self._enter(gradient[:, 1], point, np.full(n, 1j))
            return point.position, gradient
        if isinstance(of, Angle):
            for k, factor in self._turns((of.body, 1.0), (of.on, -1.0)).items():
                gradient[:, 0, k] = factor
            return self.angle(of.body, q) - self.angle(of.on, q), gradient
        if isinstance(of, Along):
            value, slopes, _ = self.along(of.slide, q)
            for k, slope in slopes.items():
                gradient[:, 0, k] = slope
            return value, gradient
        places = [self.place(place, q) for place in of.of]
        for point, steep in zip(places, self._steep(of, places), strict=True):
            self._enter(gradient[:, 0], point, steep)
        return of.value(*(np.asarray(point.position)[None] for point in places))[0], gradient

    def _steep(self, of: Function, places: Sequence[_Point]) -> list[Points]:
        """How a function grows with each of its places, (n,) each: along x + i along y."""
        still = [
            np.stack([point.position, np.zeros(len(point.position), complex)]) for point in places
        ]
        slopes = []
        for k in range(len(places)):
            slope = np.zeros(still[k].shape[1], complex)
            for part in (1.0, 1j):
                jets = [s.copy() for s in still]
                jets[k][1] = part
                slope += part * of.value(*jets)[1]
            slopes.append(slope)
        return slopes

    def by_place(self, name: str, q: Floats) -> list[tuple[Place, Any, Any]]:
        """Of each place of an output what 1 mm of it along its body's x, and along y, does to the output, (n,), complex for a
        path, with no body moved."""
        of = self.machine.output(name).of
        if not isinstance(of, Path | Function):
            return []
        on = [of.of] if isinstance(of, Path) else list(of.of)
        axes = [np.exp(1j * (self.angle(place.body, q) + np.zeros(len(q)))) for place in on]
        if isinstance(of, Path):
            return [(of.of, axes[0], 1j * axes[0])]
        steep = self._steep(of, [self.place(place, q) for place in on])
        return [
            (place, np.real(s.conj() * t), np.real(s.conj() * 1j * t))
            for place, s, t in zip(on, steep, axes, strict=True)
        ]

    def add_force(self, total: Floats, place: Place, q: Floats, force: Points) -> None:
        """Add to generalised forces, (n, 3 bodies), what a force (complex) on a place does: N and N mm."""
        self._enter(total, self.place(place, q), force)

    def wrench(self, cam: Cam, q: Floats, point: Points, force: Points) -> Floats:
        """What a force on a cam's follower, and its reverse on the cam, do at a place: as `press`, (n, 3 bodies)."""
        total = np.zeros(q.shape)
        for body, sign in ((cam.follower, 1.0), (cam.cam, -1.0)):
            c = self.column[body]
            total[:, c] += sign * force.real
            total[:, c + 1] += sign * force.imag
            total[:, c + 2] += sign * np.imag(np.conj(point - q[:, c] - 1j * q[:, c + 1]) * force)
        return total

    def _enter(self, gradient: Floats, point: _Point, slope: Points) -> None:
        """Add to a gradient, (n, 3 bodies), what Re(conj(steep) d where) is by the poses."""
        if point.column >= 0:
            gradient[:, point.column] += slope.real
            gradient[:, point.column + 1] += slope.imag
            gradient[:, point.column + 2] += np.real(np.conj(slope) * point.swing)

    def shares(self, names: Sequence[str], q: Floats, theta: Floats) -> list[dict[str, Floats]]:
        """Of each output, by joint and drive, (n,): its largest movement per mm (rad for what is an angle) of displacement there.

        One transposed solve for all. Of a Slide the displacement across its guide counts.
        """
        self.refuse_unequal()
        slopes = self.written(q, theta).slopes
        gradients = [self.output(name, q)[1] for name in names]
        right = np.concatenate(gradients, axis=1)
        solution = np.swapaxes(
            solved(self._order_back, transposed(slopes), np.swapaxes(right, 1, 2)), 1, 2
        )
        held = np.asarray(solution.any(axis=0))  # not what belongs to a machine beside it
        shares = []
        first = 0
        for gradient in gradients:
            some = slice(first, first + gradient.shape[1])
            first = some.stop
            rows = solution[:, some]
            moving = np.asarray(held[some].any(axis=0))
            share = {}
            for each in self.conditions:
                own = self.rows[each.name]
                part = rows[:, :, own][:, :, :1] if isinstance(each, Slide) else rows[:, :, own]
                share[each.name] = _stretch(part) if moving[own].any() else np.zeros(len(q))
            shares.append(share)
        return shares


def _slopes(a: _Point, b: _Point, factor: Any = 1.0) -> dict[int, Any]:
    """Slopes of factor * (a - b), complex, by column."""
    slopes: dict[int, Any] = {}
    for point, sign in ((a, 1.0), (b, -1.0)):
        if point.column >= 0:
            for column, part in enumerate((1.0, 1j, point.swing), point.column):
                slope = sign * factor * part
                slopes[column] = slopes[column] + slope if column in slopes else slope
    return slopes


def _forest(machine: Machine) -> set[str]:
    """Slides whose turn says something new: one that closes a ring of slides repeats the others."""
    leader = {body.name: body.name for body in machine.bodies} | {GROUND: GROUND}

    def top(body: str) -> str:
        while leader[body] != body:
            body = leader[body]
        return body

    independent = set()
    for joint in machine.joints:
        if isinstance(joint, Slide) and top(joint.guide.body) != top(joint.runner.body):
            leader[top(joint.runner.body)] = top(joint.guide.body)
            independent.add(joint.name)
    return independent


def _stretch(parts: Floats) -> Floats:
    """Largest singular value of (n, 1 or 2, 1 or 2) matrices."""
    if parts.shape[1] == 1 or parts.shape[2] == 1:
        return np.asarray(np.sqrt((parts**2).sum(axis=(1, 2))))
    (a, b), (c, d) = np.moveaxis(parts, 0, -1)
    total = a * a + b * b + c * c + d * d
    area = a * d - b * c
    return np.asarray(np.sqrt((total + np.sqrt(np.maximum(total**2 - 4 * area**2, 0))) / 2))
