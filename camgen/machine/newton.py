"""Larger blocks: several vector loops and relations solved together by Newton's method, with a guard.

    known + sum of z_g + sum of u_j d_j = 0      a loop: z_g turns with the unknown angle of group g, u_j unknown lengths
    sum of shares - law(argument) = 0            a relation of gears and cams within the block

Start: knots one after the other from the drawn position, each predicted from two derivatives of the one before; a step is
halved until Newton's corrections shrink by half each; where no step is left, the chain ends there. Between the knots lie
quintic polynomials; from there all angles converge at once. What is beyond an end, or does not converge, is nan.
Derivatives: with the unknowns' own rates at zero the residual's jets give the right sides of J x' = -F', J x'' = -F''.
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from camgen.machine.jets import Jet, plus, times, unit_turn, vanishes
from camgen.machine.order import Key, Relation
from camgen.numerics import Floats, solve

# Knots a turn. Newton's corrections shrink at least by HALF from a guess that is good enough.
KNOTS = 36
SHRINKS = 0.5
# A step of the drive below which there is none: the chain ends, rad.
LEAST_STEP = 1e-13
# A step at which the determinant's sign may change: a larger one has jumped to another branch, rad.
PASSES = 1e-6
# Corrections below this (by the unknown's size) leave an error of their square, which is rounding.
NEAR = 1e-8
# The same for a knot, whose error is then lost in that of the polynomials between knots.
ROUGH = 1e-5
# Residual of a closed block, by the size of its links.
CLOSED = 1e-13
# Newton may leave its guess by no more, by the unknown's size: further away it is another branch, or the knots are too few.
STRAY = 0.05


@dataclass(frozen=True)
class Vectors:
    """A sum of vectors, complex mm; of a loop it is 0."""

    roots: tuple[tuple[int, str], ...] = ()  # sign and body: origins
    levers: dict[str, complex] = field(default_factory=dict)  # by the group with which each turns
    ways: tuple[tuple[str, str, complex], ...] = ()  # slide, group, unit vector in the group's axes
    still: complex = 0j


@dataclass(frozen=True)
class BlockInputs:
    """What earlier blocks give a block, as jets."""

    loops: tuple[Jet, ...]  # the known part of each
    ways: tuple[tuple[int, int, Jet], ...]  # loop, column of an unknown length, its way
    lengths: dict[str, Jet]  # of slides whose way turns with an unknown angle
    relations: tuple[Jet, ...]
    plain: bool = False  # whether they are numbers, not arrays

    def at(self, k: int) -> BlockInputs:
        """The same at the k-th angle alone, in plain numbers: a hundred times faster there than arrays."""

        def cut(jet: Jet) -> Jet:
            return [
                row[k].item() if isinstance(row, np.ndarray) and row.ndim else row for row in jet
            ]

        return BlockInputs(
            tuple(cut(jet) for jet in self.loops),
            tuple((c, j, cut(jet)) for c, j, jet in self.ways),
            {name: cut(jet) for name, jet in self.lengths.items()},
            tuple(cut(jet) for jet in self.relations),
            True,
        )


@dataclass(frozen=True)
class Trace:
    """A block followed from the drawn position."""

    theta: Floats  # knots, (k,) rad, sorted
    jets: Floats  # x, x', x'' there, (3, k, m)
    signs: Floats  # of the determinant, (k,): they change at a change point
    ends: tuple[
        bool, bool
    ]  # whether what lies before the first, beyond the last knot is out of reach

    def covers(self, low: float, high: float) -> bool:
        """Whether all that can be reached of the range is known."""
        return (self.ends[0] or self.theta[0] <= low) and (self.ends[1] or self.theta[-1] >= high)

    def same_branch(self, theta: Floats, determinant: Floats) -> NDArray[np.bool_]:
        """Whether the determinant has the sign of a knot beside each angle."""
        k = np.clip(
            np.searchsorted(self.theta, theta, side="right") - 1, 0, max(self.theta.size - 2, 0)
        )
        sign = np.sign(determinant)
        same: NDArray[np.bool_] = (sign == self.signs[k]) | (
            sign == self.signs[np.minimum(k + 1, self.signs.size - 1)]
        )
        return same

    def guess(self, theta: Floats) -> Floats:
        """The quintic between the knots, (m, n); nan beyond."""
        if self.theta.size == 1:
            return np.where(theta == self.theta[0], self.jets[0, 0][:, None], np.nan)
        k = np.clip(np.searchsorted(self.theta, theta, side="right") - 1, 0, self.theta.size - 2)
        h = self.theta[k + 1] - self.theta[k]
        t = (theta - self.theta[k]) / h
        t = np.where((t < 0) | (t > 1), np.nan, t)
        s = 1 - t
        t3 = t**3
        s3 = s**3
        rows = (
            (s3 * (1 + 3 * t + 6 * t * t), s3 * t * (1 + 3 * t) * h, s3 * t * t * 0.5 * h * h),
            (t3 * (1 + 3 * s + 6 * s * s), -t3 * s * (1 + 3 * s) * h, t3 * s * s * 0.5 * h * h),
        )
        x = np.zeros((self.jets.shape[2], theta.size))
        for end, weights in enumerate(rows):
            for jet, weight in zip(self.jets, weights, strict=True):
                x += weight * jet[k + end].T
        return x


@dataclass(frozen=True)
class _Turning:
    """What of a loop turns with the unknown angles."""

    vectors: dict[int, Any]  # all that turns with each angle, by its column, complex mm
    ways: list[tuple[str, int, int | None, Any]]  # slide, columns of angle and length, unit vector


@dataclass(eq=False)
class Block:
    """Loops and relations that are solved together."""

    angles: tuple[str, ...]  # unknown ones: groups
    lengths: tuple[str, ...]  # unknown ones: slides
    loops: tuple[Vectors, ...]
    relations: tuple[Relation, ...]
    joints: tuple[str, ...]  # that it is named by
    start: Floats  # of angles, then lengths, as drawn
    trace: Trace | None = None

    def __post_init__(self) -> None:
        self.column: dict[Key, int] = {("angle", name): k for k, name in enumerate(self.angles)}
        self.column |= {
            ("length", name): k for k, name in enumerate(self.lengths, len(self.angles))
        }
        self.size = len(self.column)
        levers = [abs(lever) for loop in self.loops for lever in loop.levers.values()]
        levers += [abs(x) for x in self.start[len(self.angles) :]]
        self.scale = max(1.0, *levers) if levers else 1.0
        self.unit = np.array([1.0] * len(self.angles) + [self.scale] * len(self.lengths))

    # ---- the equations at x, (m, n) ----

    def _plain(self, x: Floats, known: BlockInputs) -> tuple[Any, BlockInputs]:
        """The unknowns one by one; of a single angle in plain numbers."""
        if x.shape[1] != 1:
            return x, known
        return x[:, 0].tolist(), known if known.plain else known.at(0)

    def _turns(self, x: Any) -> list[Any]:
        """exp(i angle) of each unknown angle."""
        angles = x[: len(self.angles)]
        return (
            [cmath.exp(1j * angle) for angle in angles]
            if isinstance(x, list)
            else [unit_turn(angle) for angle in angles]
        )

    def _turning(self, x: Any, known: BlockInputs) -> list[_Turning]:
        """Each loop's vectors that turn with an unknown angle."""
        turns = self._turns(x)
        loops = []
        for loop in self.loops:
            z = {
                self.column["angle", g]: lever * turns[self.column["angle", g]]
                for g, lever in loop.levers.items()
                if ("angle", g) in self.column
            }
            ways = []
            for slide, group, way in loop.ways:
                k = self.column.get(("angle", group))
                j = self.column.get(("length", slide))
                if k is None:
                    continue
                vector = way * turns[k]
                length = x[j] if j is not None else known.lengths[slide][0]
                z[k] = plus(z.get(k, 0), length * vector)
                ways.append((slide, k, j, vector))
            loops.append(_Turning(z, ways))
        return loops

    def _filled(self, n: int, entries: dict[tuple[int, ...], Any], *shape: int) -> Floats:
        """The entries by row (and column) as an array, (n, *shape)."""
        rows = np.zeros((n, *shape))
        for place, value in entries.items():
            rows.T[place[::-1]] = value
        return rows

    def equations(self, x: Floats, known: BlockInputs) -> tuple[Floats, Floats]:
        """Residuals (n, m) and their slopes (n, m, m) at x, (m, n)."""
        n = x.shape[1]
        at, known = self._plain(x, known)
        residual: dict[tuple[int, ...], Any] = {}
        slope: dict[tuple[int, ...], Any] = {}
        for c, turning in enumerate(self._turning(at, known)):
            total = known.loops[c][0]
            columns: dict[int, Any] = {}
            for _, _, length, way in turning.ways:
                if length is not None:
                    columns[length] = plus(columns.get(length, 0), way)
            for k, vector in turning.vectors.items():
                total = total + vector
                columns[k] = 1j * vector
            for loop, j, jet in known.ways:
                if loop == c:
                    total = total + at[j] * jet[0]
                    columns[j] = plus(columns.get(j, 0), jet[0])
            residual[2 * c,] = total.real
            residual[2 * c + 1,] = total.imag
            for k, column in columns.items():
                slope[2 * c, k] = column.real
                slope[2 * c + 1, k] = column.imag
        for row, (relation, jet) in enumerate(
            zip(self.relations, known.relations, strict=True), 2 * len(self.loops)
        ):
            value = jet[0]
            for key, share in relation.shares.items():
                if key in self.column:
                    value = value + share * at[self.column[key]]
                    slope[row, self.column[key]] = slope.get((row, self.column[key]), 0.0) + share
            if relation.argument in self.column:
                k = self.column[relation.argument]
                assert relation.law is not None
                value = value - relation.law(x[k] + relation.shift, 0)
                slope[row, k] = slope.get((row, k), 0.0) - relation.law(x[k] + relation.shift, 1)
            residual[row,] = value
        return self._filled(n, residual, self.size), self._filled(n, slope, self.size, self.size)

    def forcing(self, x: Floats, known: BlockInputs, rates: Floats | None) -> Floats:
        """The residual's next derivative, (n, m), with that of x at zero: the first, or with rates x', (m, n), the second."""
        n = x.shape[1]
        order = 1 if rates is None else 2
        at, known = self._plain(x, known)
        speeds = None if rates is None else rates[:, 0].tolist() if n == 1 else rates
        right: dict[tuple[int, ...], Any] = {}
        for c, turning in enumerate(self._turning(at, known)):
            total = known.loops[c][order]
            for loop, j, jet in known.ways:
                if loop == c:
                    total = plus(total, times(at[j], jet[order]))
                    if speeds is not None:
                        total = plus(total, times(2 * speeds[j], jet[1]))
            total = _turning_forcing(total, turning, known.lengths, speeds)
            if not vanishes(total):
                right[2 * c,] = total.real
                right[2 * c + 1,] = total.imag
        for row, (relation, jet) in enumerate(
            zip(self.relations, known.relations, strict=True), 2 * len(self.loops)
        ):
            value = jet[order]
            if rates is not None and relation.argument in self.column:
                k = self.column[relation.argument]
                assert relation.law is not None
                value = value - relation.law(x[k] + relation.shift, 2) * rates[k] ** 2
            right[row,] = value
        return self._filled(n, right, self.size)

    def determinant(self, x: Floats, known: BlockInputs) -> Floats:
        """Of the slopes with columns of length 1, (n,): 0 at a dead or change point, at most 1."""
        slope = self.equations(x, known)[1]
        with np.errstate(all="ignore"):
            slope = slope / np.linalg.norm(slope, axis=1, keepdims=True)
        sound = np.isfinite(slope).all(axis=(1, 2))
        determinant = np.full(len(slope), np.nan)
        determinant[sound] = np.linalg.det(slope[sound])
        return determinant

    # ---- solving ----

    def rates(self, x: Floats, known: BlockInputs, slope: Floats, order: int) -> list[Floats]:
        """x', x'' as far as the order asks, (m, n) each."""
        rates: list[Floats] = []
        for k in range(order):
            rates.append(solved(slope, -self.forcing(x, known, rates[0] if k else None)).T)
        return rates

    def converge(
        self, x: Floats, known: BlockInputs, near: float = NEAR
    ) -> tuple[Floats, Floats] | None:
        """A single position from a guess, (m, 1), with its slopes; None where the corrections do not shrink.

        near: the last correction by the unknowns' size; with more than NEAR it is a knot, not a solution.
        """
        last = STRAY / SHRINKS
        for _ in range(12):
            residual, slope = self.equations(x, known)
            step = solved(slope, residual).T
            size = float(np.max(np.abs(step) / self.unit[:, None]))
            if not size <= max(SHRINKS * last, 1e-14):
                return None
            x = x - step
            if size <= near and near > NEAR:
                return x, slope
            if size <= NEAR:
                residual, slope = self.equations(x, known)
                return (x, slope) if self._closed(residual, known)[0] else None
            last = size
        return None

    def _closed(self, residual: Floats, known: BlockInputs) -> NDArray[np.bool_]:
        loops = (np.abs(jet[0]) for jet in known.loops)
        size = self.scale + max(
            (float(np.max(sizes, where=np.isfinite(sizes), initial=0.0)) for sizes in loops),
            default=0.0,
        )
        closed: NDArray[np.bool_] = np.abs(residual).max(axis=1) <= 10 * CLOSED * size
        return closed

    def follow(self, known_at: Callable[[Floats], BlockInputs], low: float, high: float) -> Trace:
        """Knots from the drawn position at theta = 0 out to both ends of the range, or as far as the chain closes."""
        known = known_at(np.zeros(1))
        first = self.converge(self.start[:, None], known)
        if first is None:
            return Trace(np.zeros(1), np.full((3, 1, self.size), np.nan), np.zeros(1), (True, True))
        origin = np.stack([first[0], *self.rates(first[0], known, first[1], 2)])[:, :, 0]
        sign = float(np.sign(np.linalg.det(first[1][0])))
        (low_side, below), (high_side, above) = (
            self._side(known_at, end, origin, sign) for end in (low, high)
        )
        knots = [*low_side[::-1], (0.0, origin, sign), *high_side]
        theta, rows, signs = (np.array([knot[k] for knot in knots]) for k in range(3))
        return Trace(theta, np.swapaxes(rows, 0, 1), signs, (below, above))

    def _side(
        self, known_at: Callable[[Floats], BlockInputs], end: float, jets: Floats, sign: float
    ) -> tuple[list[tuple[float, Floats, float]], bool]:
        """Knots (theta, jets, sign) from the drawn position towards one end, and whether the chain ends before it."""
        knots: list[tuple[float, Floats, float]] = []
        if end == 0:
            return knots, False
        count = max(1, math.ceil(abs(end) / math.tau * KNOTS - 1e-9))
        grid = np.asarray(np.arange(1, count + 1) * (end / count), float)
        ahead = known_at(grid)
        theta = 0.0
        share = 1.0  # of the way to the next knot of the grid
        k = 0
        while k < count:
            to = float(theta + share * (grid[k] - theta)) if share < 1 else float(grid[k])
            known = ahead.at(k) if share == 1 else known_at(np.array([to]))
            h = to - theta
            # A whole step need not end on the last digit: where there are knots, all angles converge from them.
            near = ROUGH if share == 1 else NEAR
            solution = self.converge(
                (jets[0] + h * (jets[1] + 0.5 * h * jets[2]))[:, None], known, near
            )
            if solution is not None:
                rows = np.stack([solution[0], *self.rates(solution[0], known, solution[1], 2)])[
                    :, :, 0
                ]
                new_sign = float(np.sign(np.linalg.det(solution[1][0])))
                error = np.abs(rows[0] - h * (rows[1] - 0.5 * h * rows[2]) - jets[0]) / self.unit
            if (
                solution is None
                or not error.max() < STRAY
                or (new_sign != sign and abs(h) > PASSES)
            ):
                if abs(h) < LEAST_STEP:
                    return knots, True
                share /= 2
                continue
            theta = to
            jets = rows
            sign = new_sign
            knots.append((theta, jets, sign))
            if share == 1:
                k += 1
            share = min(1.0, 2 * share)
        return knots, False

    def solve(self, theta: Floats, known: BlockInputs, order: int) -> list[Floats]:
        """x and its derivatives, (m, n) each; nan where the block does not close."""
        assert self.trace is not None
        guess = self.trace.guess(theta)
        open_ = np.asarray(~np.isfinite(guess).all(axis=0), bool)
        x = np.where(open_, self.start[:, None], guess)
        with np.errstate(all="ignore"):
            for _ in range(8):
                residual, slope = self.equations(x, known)
                step = solved(slope, residual).T
                size = np.abs(step) / self.unit[:, None]
                x = x - step
                if not np.any(size[:, ~open_] > NEAR):
                    break
            residual, slope = self.equations(x, known)
            stray = np.abs(x - guess) / self.unit[:, None]
            closed: NDArray[np.bool_] = self._closed(residual, known)
            closed &= stray.max(axis=0) < STRAY
            if any(self.trace.ends):  # near a dead point both branches are near
                closed &= self.trace.same_branch(theta, np.linalg.det(slope))
            rows = [x, *self.rates(x, known, slope, order)]
        for row in rows:
            row[:, open_ | ~closed] = np.nan
        return rows


def _turning_forcing(total: Any, turning: _Turning, lengths: dict[str, Jet], speeds: Any) -> Any:
    """A loop's forcing and what its turning vectors add; speeds: the unknowns' rates, or None for the first derivative."""
    if speeds is not None:
        for k, vector in turning.vectors.items():
            total = total - speeds[k] * speeds[k] * vector
    for slide, angle, length, way in turning.ways:
        if length is None:
            total = plus(total, times(lengths[slide][1 if speeds is None else 2], way))
        if speeds is not None:
            speed = lengths[slide][1] if length is None else speeds[length]
            total = plus(total, times(speed, 2j * speeds[angle] * way))
    return total


def solved(matrices: Floats, right: Floats) -> Floats:
    """Solutions (n, m) of n systems; nan for a singular one."""
    m = right.shape[1]
    with np.errstate(all="ignore"):
        if m == 1:
            return right / np.where(matrices[:, 0] == 0, np.nan, matrices[:, 0])
        if m == 2:
            a, b = matrices[:, 0].T
            c, d = matrices[:, 1].T
            area = a * d - b * c
            area = np.where(area == 0, np.nan, area)
            return (
                np.stack(
                    [d * right[:, 0] - b * right[:, 1], a * right[:, 1] - c * right[:, 0]], axis=1
                )
                / area[:, None]
            )
        return solve(matrices, right)
