"""The order of elimination finds what a dense solution finds, on random systems, and on random chains closed by it."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest
from chains import CHAINS
from hypothesis import given, settings
from hypothesis import strategies as st

from camgen.machine import GROUND, Body, Drive, Machine, Pin, Place, Pose
from camgen.machine.closing import close
from camgen.machine.constraints import Constraints
from camgen.machine.elimination import order_of, transposed
from camgen.machine.elimination import solved as solved_in_order

EPS = float(np.finfo(float).eps)
Rows = list[dict[int, object]]


def rows_of(matrices: np.ndarray) -> Rows:
    """Systems (n, k, k) as rows: what is the same in all of them as one float, what is 0 in all left out."""
    return [
        {
            k: float(column[0]) if (column == column[0]).all() else column
            for k, column in enumerate(row)
            if column.any()
        }
        for row in np.moveaxis(matrices, 0, -1)
    ]


def solved(rows: Rows, right: np.ndarray) -> np.ndarray:
    return solved_in_order(order_of(rows), rows, right)


def growth(matrices: np.ndarray) -> float:
    """How much larger numbers become by taking out the order's pivots, worked out on whole matrices; 1 at least."""
    left = matrices.copy()
    largest = np.abs(left).max()
    for pivot in order_of(rows_of(matrices)).pivots:
        for other in pivot.others:
            factor = left[:, other, pivot.column] / left[:, pivot.row, pivot.column]
            left[:, other] -= factor[:, None] * left[:, pivot.row]
        largest = max(largest, np.abs(left).max())
    return float(largest / np.abs(matrices).max())


def determinant_sign(rows: Rows, n: int) -> np.ndarray:
    return order_of(rows).determinant_sign(rows, n)


@st.composite
def systems(draw: st.DrawFn) -> np.ndarray:
    """Of 4 systems most numbers 0, some 1 or -1 in all of them; a matching keeps them from being singular."""
    size = draw(st.integers(1, 9))
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    matrices = rng.normal(size=(4, size, size)) * (rng.random((size, size)) < 0.25)
    ones = rng.random((size, size)) < 0.2
    matrices[:, ones] = rng.choice([1.0, -1.0], size=ones.sum())
    matrices[:, np.arange(size), rng.permutation(size)] += rng.choice([3.0, -4.0], size=size)
    return np.asarray(matrices)


@settings(max_examples=100, deadline=None)
@given(systems(), st.sampled_from([(), (2,)]))
def test_solutions_and_signs_are_those_of_a_dense_system(
    matrices: np.ndarray, sides: tuple[int, ...]
) -> None:
    """To rounding: that of the numbers after elimination, size^2 of them, times the condition.   [Wilkinson's growth factor]"""
    n, size = matrices.shape[:2]
    right = np.random.default_rng(3).normal(size=(n, size, *sides))
    rows = rows_of(matrices)
    for system, found in (
        (matrices, solved(rows, right)),
        (np.swapaxes(matrices, 1, 2), solved(transposed(rows), right)),
    ):
        bound = np.linalg.cond(system).max()
        if bound < 1e6:
            dense = np.linalg.solve(system, right.reshape(n, size, -1)).reshape(right.shape)
            rounding = EPS * size**2 * growth(system)
            assert np.abs(found - dense).max() <= rounding * bound * (1 + np.abs(dense).max())
    np.testing.assert_array_equal(determinant_sign(rows, n), np.linalg.slogdet(matrices)[0])


@pytest.mark.parametrize("right", [(9, 3), (9, 3, 2)])
def test_systems_that_have_no_numbers_have_no_solution(right: tuple[int, ...]) -> None:
    """nan or inf in a matrix or on its right, each by itself; the others are solved as if alone."""
    rng = np.random.default_rng(2)
    matrices, wanted = rng.normal(size=(9, 3, 3)), rng.normal(size=right)
    sides = np.einsum("nij,nj...->ni...", matrices, wanted)
    matrices[1, 0, 2], matrices[4, 2, 2] = np.nan, np.inf
    sides[3, 0], sides[4, 1] = np.nan, -np.inf
    found = solved(rows_of(matrices), sides)
    lost = np.isnan(found).reshape(9, -1)
    assert (
        lost.all(axis=1).tolist() == lost.any(axis=1).tolist() == [k in (1, 3, 4) for k in range(9)]
    )
    np.testing.assert_allclose(found[~lost[:, 0]], wanted[~lost[:, 0]], atol=1e-12)
    np.testing.assert_array_equal(solved(rows_of(matrices[5:]), sides[5:]), found[5:])
    matrices[6, 1, 1] = np.inf  # by which an unknown would be 0
    assert np.isnan(solved(rows_of(matrices), sides)[6]).all()


@pytest.mark.parametrize(
    "matrix",
    [
        pytest.param([[1.0, 2.0], [0.0, 0.0]], id="an empty row"),
        pytest.param([[2.0, 0.0], [3.0, 0.0]], id="an unknown that no row holds"),
        pytest.param([[1.0, 1.0], [1.0, 1.0]], id="a row twice"),
    ],
)
def test_a_singular_system_has_no_solution(matrix: list[list[float]]) -> None:
    rows = rows_of(np.array([matrix, matrix]))
    assert np.isnan(solved(rows, np.ones((2, 2)))).all()
    assert (determinant_sign(rows, 2) == 0).all()


def test_loops_that_do_not_touch_are_blocks_by_themselves() -> None:
    """Three four-bars in a row: two angles each, where a dense system has all nine of a four-bar and all of the others."""
    system = Constraints(CHAINS["Jansen"]())
    order = order_of(system.written(system.start[None], np.zeros(1)).slopes)
    assert [len(block.rows) for block in order.blocks] == [2, 2, 2]


# ---- chains ----------------------------------------------------------------------------------------------------------


@st.composite
def chains(draw: st.DrawFn) -> Machine:
    """A crank and pairs of links, each pair pinned to two bodies that are there; it closes as drawn, far from a dead point."""
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    reach: Callable[[], complex] = lambda: complex(*rng.uniform(-60, 60, 2))  # noqa: E731
    bodies = [Body(GROUND, {"O": 0j}), Body("crank", {"O": 0j, "A": 20 + 0j})]
    start = {"crank": Pose(0j, 0.0)}
    joints = [Pin("O", Place(GROUND, 0j), Place("crank", 0j))]
    for k in range(draw(st.integers(1, 5))):
        holders = rng.choice(len(bodies), 2, replace=False)
        ends = []
        for which in holders:
            body = bodies[which].name
            place = 20 + 0j if body == "crank" else reach()
            pose = start.get(body, Pose(0j, 0.0))
            ends.append((Place(body, place), pose.place + np.exp(1j * pose.angle) * place))
        middle = (ends[0][1] + ends[1][1]) / 2
        knee = middle + (ends[1][1] - ends[0][1] + 60) * 1j * rng.choice([0.8, -1.1])
        for side, (place, at) in enumerate(ends):
            name = f"link{k}{'ab'[side]}"
            length = abs(knee - at)
            bodies.append(Body(name, {"near": 0j, "far": length + 0j}))
            start[name] = Pose(complex(at), math.atan2((knee - at).imag, (knee - at).real))
            joints.append(Pin(f"{name} near", place, Place(name, 0j)))
        far = [
            Place(f"link{k}{side}", abs(knee - at) + 0j)
            for side, (_, at) in zip("ab", ends, strict=True)
        ]
        joints.append(Pin(f"knee{k}", *far))
    return Machine(
        bodies=tuple(bodies),
        joints=tuple(joints),
        drives=(Drive("drive", "crank"),),
        start=start,
    )


def dense(system: Constraints, theta: np.ndarray, guess: np.ndarray) -> np.ndarray:
    """Poses by Newton's method on whole matrices."""
    q = guess.copy()
    for _ in range(12):
        misfit, slopes, _ = system.evaluate(q, theta)
        q -= np.linalg.solve(slopes, misfit[:, :, None])[:, :, 0]
    return np.asarray(q)


@pytest.mark.long
@settings(max_examples=50, deadline=None)
@given(chains())
def test_random_chains_close_as_on_whole_matrices(machine: Machine) -> None:
    system = Constraints(machine)
    theta = np.array([0.0, 0.003, 0.01])
    closed = close(system, theta)
    good = np.isfinite(closed.q).all(axis=1)
    assert good[0]
    wanted = dense(system, theta[good], closed.q[good] + 1e-5)
    slopes = system.evaluate(wanted, theta[good])[1]
    # coordinates of so many mm are rounded, which the inverse of the slopes takes to the poses
    rounding = EPS * max(np.abs(wanted).max(), 100.0)
    spread = np.abs(np.linalg.inv(slopes)).sum(axis=2).max()
    assert np.abs(closed.q[good] - wanted).max() <= rounding * spread
    size = np.linalg.cond(slopes * system.unit).max()
    first = np.linalg.solve(slopes, -system.drift(theta[good])[:, :, None])[:, :, 0]
    assert np.abs(closed.first[good] - first).max() <= 1e-13 * size * np.abs(first).max()
