"""Linear systems of one pattern at many angles: the order in which their unknowns are found is worked out once.

    row       numbers by column: a float where it is the same at all angles, else (n,)
    pivot     an unknown that a row holds by 1 or -1 at all angles: it is taken out of the other rows, and found last
    block     rows and unknowns left that must be solved together; each block needs earlier ones alone

Joints hold places: a pin's x is that of one body less that of another. Taken out by such pivots the places leave no more than
the machine's loops; loops that do not touch each other are blocks by themselves. Other rows hold these places by 1 or -1 too, so
levers are added up and no number grows beyond their sum; in a system of any numbers they may.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np

from camgen.machine.matching import matching
from camgen.numerics import Floats, solve

Row = Mapping[int, Any]
# Of each row its columns, and the numbers that are the same at all angles.
Pattern = tuple[tuple[tuple[int, float | None], ...], ...]


@dataclass(frozen=True)
class Pivot:
    """An unknown, the row that gives it, and the rows that it is taken out of."""

    row: int
    column: int
    others: tuple[int, ...]


@dataclass(frozen=True)
class Block:
    """Rows and as many unknowns."""

    rows: tuple[int, ...]
    columns: tuple[int, ...]


@dataclass(frozen=True)
class Elimination:
    """The order in which all unknowns of a pattern are found; sign: what it gives to the determinant's."""

    pivots: tuple[Pivot, ...]
    blocks: tuple[Block, ...]
    sign: float

    def solve(self, rows: Sequence[Row], right: Sequence[Row], n: int) -> list[dict[int, Any]]:
        """Each unknown by the number of the right side, (n,) or one for all; it is left out where a side gives it nothing.

        nan for an unknown of a singular block.
        """
        size = len(rows)
        table = _table(rows, n)
        for row, side in zip(table, _table(right, n), strict=True):
            row |= {size + j: value for j, value in side.items()}
        found: list[dict[int, Any]] = [{} for _ in rows]
        with np.errstate(all="ignore"):
            self._take_out(table)
            for block in self.blocks:
                _solve_block(block, table, found, n)
            for pivot in reversed(self.pivots):
                row = table[pivot.row]
                sums = _less_known(row, {pivot.column}, found)
                found[pivot.column] = {j: total * row[pivot.column] for j, total in sums.items()}
        return found

    def determinant_sign(self, rows: Sequence[Row], n: int) -> Floats:
        """The sign of the determinant, (n,)."""
        table = _table(rows, n)
        sign = np.full(n, self.sign)
        with np.errstate(all="ignore"):
            self._take_out(table)
            for block in self.blocks:
                sign = sign * _sign(block, table, n)
        return sign

    def _take_out(self, table: list[dict[int, Any]]) -> None:
        """Take each pivot's unknown out of the other rows."""
        for pivot in self.pivots:
            given = dict(table[pivot.row])
            scale = given.pop(pivot.column)
            for other in pivot.others:
                row = table[other]
                factor = row.pop(pivot.column, 0.0) * scale
                for column, value in given.items():
                    _enter(row, column, row.get(column, 0.0) - factor * value)


def _table(rows: Sequence[Row], n: int) -> list[dict[int, Any]]:
    """A copy to work on; of a single angle in plain numbers, which take a tenth of the time."""
    if n != 1:
        return [dict(row) for row in rows]
    return [
        {k: value[0] if isinstance(value, np.ndarray) else value for k, value in row.items()}
        for row in rows
    ]


def _enter(row: dict[int, Any], column: int, value: Any) -> None:
    """Write down a number; one that is 0 at all angles is none."""
    if isinstance(value, float) and value == 0.0:
        row.pop(column, None)
    else:
        row[column] = value


def _less_known(
    row: Row, unknown: Iterable[int], found: Sequence[Mapping[int, Any]]
) -> dict[int, Any]:
    """A row's right sides less what known unknowns give to it."""
    size = len(found)
    sums = {column - size: value for column, value in row.items() if column >= size}
    for column, value in row.items():
        if column < size and column not in unknown:
            for j, known in found[column].items():
                sums[j] = sums.get(j, 0.0) - value * known
    return sums


def _matrices(block: Block, table: Sequence[Row], n: int) -> Floats:
    """A block's rows, (n, k, k)."""
    matrices = np.zeros((n, len(block.rows), len(block.columns)))
    for r, row in enumerate(block.rows):
        for c, column in enumerate(block.columns):
            if column in table[row]:
                matrices[:, r, c] = table[row][column]
    return matrices


def _two(block: Block, table: Sequence[Row]) -> list[Any]:
    """The four numbers of two rows."""
    return [table[row].get(column, 0.0) for row in block.rows for column in block.columns]


def _sign(block: Block, table: Sequence[Row], n: int) -> Any:
    """The sign of a block's determinant, (n,) or one for all."""
    if len(block.rows) == 1:
        return np.sign(table[block.rows[0]].get(block.columns[0], 0.0))
    if len(block.rows) == 2:
        a, b, c, d = _two(block, table)
        return np.sign(a * d - b * c)
    return np.linalg.slogdet(_matrices(block, table, n))[0]


def _solve_block(block: Block, table: Sequence[Row], found: list[dict[int, Any]], n: int) -> None:
    """Find the unknowns of a block."""
    sums = [_less_known(table[row], block.columns, found) for row in block.rows]
    sides = sorted({j for each in sums for j in each})
    if len(block.rows) == 1:
        scale = _divisor(table[block.rows[0]].get(block.columns[0], 0.0))
        found[block.columns[0]] = {j: total / scale for j, total in sums[0].items()}
        return
    if len(block.rows) == 2:
        _solve_two(block, table, sums, found)
        return
    right = np.zeros((n, len(block.rows), len(sides)))
    for r, each in enumerate(sums):
        for k, j in enumerate(sides):
            if j in each:
                right[:, r, k] = each[j]
    matrices = _matrices(block, table, n)
    solution = solve(matrices, right)
    solution[~np.isfinite(matrices).all(axis=(1, 2))] = math.nan
    for c, column in enumerate(block.columns):
        found[column] = {j: solution[:, c, k] for k, j in enumerate(sides)}


def _solve_two(
    block: Block,
    table: Sequence[Row],
    sums: Sequence[Mapping[int, Any]],
    found: list[dict[int, Any]],
) -> None:
    """Find two unknowns, by determinants."""
    a, b, c, d = _two(block, table)
    area = _divisor(a * d - b * c)
    for column in block.columns:
        found[column] = {}
    for j in {*sums[0], *sums[1]}:
        first = sums[0].get(j, 0.0)
        second = sums[1].get(j, 0.0)
        found[block.columns[0]][j] = (first * d - b * second) / area
        found[block.columns[1]][j] = (a * second - first * c) / area


def _divisor(value: Any) -> Any:
    """What is divided by; nan for 0, and for what is not finite."""
    if isinstance(value, float):
        return value if value and math.isfinite(value) else math.nan
    return np.where(np.isfinite(value) & (value != 0), value, math.nan)


def solved(order: Elimination, rows: Sequence[Row], right: Floats) -> Floats:
    """Solutions of n systems, right (n, k) or (n, k, m), the same bits on every processor; nan for a singular one."""
    n, size = right.shape[:2]
    several = right.reshape(n, size, math.prod(right.shape[2:]))
    held = np.ones(several.shape[1:], bool) if right.ndim == 2 else (several != 0).any(axis=0)
    sides: list[Row] = [
        {j: several[:, r, j] for j in np.flatnonzero(held[r]).tolist()} for r in range(size)
    ]
    found = order.solve(rows, sides, n)
    solution = np.zeros(several.shape)
    for column, by_side in enumerate(found):
        for j, values in by_side.items():
            solution[:, column, j] = values
    solution[~np.isfinite(solution).all(axis=(1, 2))] = math.nan
    return solution.reshape(right.shape)


def transposed(rows: Sequence[Row]) -> list[dict[int, Any]]:
    """Columns as rows, of a square system."""
    columns: list[dict[int, Any]] = [{} for _ in rows]
    for r, row in enumerate(rows):
        for column, value in row.items():
            columns[column][r] = value
    return columns


# ---- the order -------------------------------------------------------------------------------------------------------


def order_of(rows: Sequence[Row]) -> Elimination:
    """The order for rows of this pattern; rows must be as many as columns."""
    return _ordered(
        tuple(
            tuple(
                (column, float(value) if isinstance(value, float) else None)
                for column, value in row.items()
            )
            for row in rows
        )
    )


@lru_cache(maxsize=64)  # of a machine as meant and as measured from all kinds of its files
def _ordered(pattern: Pattern) -> Elimination:
    """Pivots as long as there are any, each where it fills in least, then the blocks of what is left."""
    table = [dict(row) for row in pattern]
    holders: dict[int, set[int]] = {column: set() for column in range(len(table))}
    for r, row in enumerate(table):
        for column in row:
            holders[column].add(r)
    left = dict.fromkeys(range(len(table)))
    pivots: list[Pivot] = []
    signs = 1.0
    owner: dict[int, int] = {}  # the row that each unknown is found from
    while pivot := _next_pivot(table, holders, left):
        pivots.append(pivot)
        owner[pivot.column] = pivot.row
        signs *= table[pivot.row][pivot.column] or 1.0
        del left[pivot.row]
        _mark_out(pivot, table, holders)
    columns = [column for column in range(len(table)) if column not in owner]
    blocks = _blocks({r: [c for c in table[r] if c not in owner] for r in left}, columns)
    for block in blocks:
        owner |= dict(zip(block.columns, block.rows, strict=True))
    parity = _parity([owner[column] for column in range(len(table))])
    return Elimination(tuple(pivots), blocks, signs * parity)


def _next_pivot(
    table: Sequence[Mapping[int, float | None]],
    holders: Mapping[int, set[int]],
    left: Iterable[int],
) -> Pivot | None:
    """Where a 1 or -1 fills in least; None where no row left holds one."""
    best = min(
        (
            ((len(table[row]) - 1) * (len(holders[column]) - 1), row, column)
            for row in left
            for column, value in table[row].items()
            if value in (1.0, -1.0)
        ),
        default=None,
    )
    if best is None:
        return None
    _, row, column = best
    return Pivot(row, column, tuple(sorted(holders[column] - {row})))


def _mark_out(
    pivot: Pivot, table: Sequence[dict[int, float | None]], holders: Mapping[int, set[int]]
) -> None:
    """What taking an unknown out does to the pattern."""
    given = dict(table[pivot.row])
    scale = given.pop(pivot.column)
    assert scale is not None, "a pivot is the same at all angles"
    for column in table[pivot.row]:
        holders[column].discard(pivot.row)
    for other in pivot.others:
        row = table[other]
        factor = row.pop(pivot.column)
        for column, value in given.items():
            before = row.get(column, 0.0)
            sure = factor is not None and value is not None and before is not None
            new = before - factor * scale * value if sure else None  # type: ignore[operator]
            if new == 0.0:
                row.pop(column, None)
                holders[column].discard(other)
            else:
                row[column] = new
                holders[column].add(other)


def _blocks(held: Mapping[int, Sequence[int]], columns: Sequence[int]) -> tuple[Block, ...]:
    """Rows and the unknowns they hold as blocks, each after those it needs; one block where some cannot be matched."""
    owner = matching(held)
    if len(owner) < len(columns):
        return (Block(tuple(held), tuple(columns)),)
    column_of = {row: column for column, row in owner.items()}
    needs = {row: [owner[column] for column in row_columns] for row, row_columns in held.items()}
    return tuple(
        Block(tuple(rows), tuple(column_of[row] for row in rows)) for rows in _components(needs)
    )


def _components(needs: Mapping[int, Sequence[int]]) -> list[list[int]]:
    """Rows that need each other, those first that need no others.   [Tarjan's strong components]"""
    number: dict[int, int] = {}
    low: dict[int, int] = {}
    stack: list[int] = []
    done: set[int] = set()
    found: list[list[int]] = []

    def visit(row: int) -> None:
        number[row] = low[row] = len(number)
        stack.append(row)
        for other in needs[row]:
            if other not in number:
                visit(other)
            if other not in done:
                low[row] = min(low[row], low[other])
        if low[row] == number[row]:
            first = stack.index(row)
            found.append(sorted(stack[first:]))
            done.update(stack[first:])
            del stack[first:]

    for row in needs:
        if row not in number:
            visit(row)
    return found


def _parity(places: Sequence[int]) -> float:
    """1 of an even permutation, -1 of an odd one."""
    seen: set[int] = set()
    sign = 1.0
    for start in range(len(places)):
        k = places[start]
        while k not in seen:
            seen.add(k)
            sign = -sign if k != start else sign
            k = places[k]
    return sign
