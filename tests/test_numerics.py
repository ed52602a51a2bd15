"""Linear algebra without BLAS: right by other routes, and the same files whatever BLAS kernel numpy picks."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import mpmath
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from camgen.numerics import (
    crests,
    gauss_legendre,
    greatest,
    latest,
    least_squares,
    product,
    roots,
    sign_changes,
    solve,
)

RNG = np.random.default_rng(7)


def test_product_and_solutions_are_numpy_s() -> None:
    a, b = RNG.normal(size=(40, 3)), RNG.normal(size=(3, 5))
    np.testing.assert_allclose(product(a, b), a @ b, atol=1e-14)
    for size in (1, 2, 5, 20):
        matrices, right = RNG.normal(size=(30, size, size)), RNG.normal(size=(30, size))
        matrices[0, 0, 0] = 0.0  # asks for a pivot
        found = solve(matrices, right)
        if size == 1:
            assert np.isnan(found[0]).all()
            matrices, right, found = matrices[1:], right[1:], found[1:]
        np.testing.assert_allclose(
            found, np.linalg.solve(matrices, right[:, :, None])[:, :, 0], rtol=1e-9
        )


@pytest.mark.parametrize("share", [0.1, 0.3, 0.6])
def test_systems_with_zeros_and_several_right_sides_are_numpy_s(share: float) -> None:
    """Zeros of all systems, of some, and on the diagonal, wherever they lie."""
    for size in (4, 9, 24):
        always = RNG.random((size, size)) < share
        at_times = RNG.random((20, size, size)) < 0.7
        matrices = np.where(always & at_times, RNG.normal(size=(20, size, size)), 0.0)
        matrices[:, np.arange(size), RNG.permutation(size)] += 2.0
        right = RNG.normal(size=(20, size, 3))
        sound = np.linalg.cond(matrices) < 1e6
        found = solve(matrices, right)
        np.testing.assert_allclose(
            found[sound], np.linalg.solve(matrices[sound], right[sound]), rtol=1e-7, atol=1e-9
        )
        np.testing.assert_array_equal(found[:, :, 1], solve(matrices, right[:, :, 1]))


@pytest.mark.parametrize("size", [1, 3, 24])
def test_one_system_alone_is_solved_as_among_others(size: int) -> None:
    holds = RNG.random((size, size)) < 0.4
    holds[np.arange(size), RNG.permutation(size)] = True
    matrices = np.where(holds, RNG.normal(size=(5, size, size)), 0.0)
    matrices[:, holds] += 0.5
    right = RNG.normal(size=(5, size, 2))
    sound = np.linalg.cond(matrices) < 1e6
    found = solve(matrices, right)
    np.testing.assert_allclose(
        found[sound], np.linalg.solve(matrices, right)[sound], rtol=1e-7, atol=1e-9
    )
    for k in np.flatnonzero(sound):
        np.testing.assert_allclose(
            solve(matrices[k : k + 1], right[k : k + 1])[0], found[k], rtol=1e-9, atol=1e-11
        )
    matrices[0, 0] = 0.0
    assert np.isnan(solve(matrices[:1], right[:1])).all()


def test_no_system_has_no_solution() -> None:
    assert solve(np.zeros((0, 3, 3)), np.zeros((0, 3))).shape == (0, 3)
    assert solve(np.zeros((0, 3, 3)), np.zeros((0, 3, 2))).shape == (0, 3, 2)


def test_a_singular_system_is_nan_and_spoils_no_other() -> None:
    matrices = np.array([[[1.0, 2.0], [2.0, 4.0]], [[2.0, 0.0], [0.0, 4.0]]])
    found = solve(matrices, np.ones((2, 2)))
    assert np.isnan(found[0]).all()
    np.testing.assert_array_equal(found[1], [0.5, 0.25])


@pytest.mark.parametrize("spread", [1.0, 1e-3, 1e-6])
def test_least_squares_of_a_badly_conditioned_table(spread: float) -> None:
    x = spread * np.linspace(-1, 1, 50)
    table = np.column_stack([1 + x, 1 - x, 2 + x**2])
    wanted = np.array([3.0, -2.0, 0.5])
    found = least_squares(table, product(table, wanted[:, None])[:, 0])
    rest = product(table, (found - wanted)[:, None])
    assert np.max(np.abs(rest)) < 1e-13
    doubled = least_squares(np.column_stack([x, 2 * x]), 3 * x)
    np.testing.assert_allclose(doubled, [3, 0])


@pytest.mark.parametrize("n", [1, 2, 16, 32])
def test_gauss_points_are_the_roots_of_the_polynomial(n: int) -> None:
    nodes, weights = gauss_legendre(n)
    assert np.sum(weights) == pytest.approx(2, rel=1e-14) and np.all(np.diff(nodes) > 0)
    with mpmath.workdps(40):
        for x, w in zip(nodes, weights, strict=True):
            root = mpmath.findroot(lambda t: mpmath.legendre(n, t), mpmath.mpf(float(x)))
            slope = mpmath.diff(lambda t: mpmath.legendre(n, t), root)
            assert abs(float(root - float(x))) < 2e-16 and float(
                2 / ((1 - root**2) * slope**2)
            ) == pytest.approx(w, rel=1e-13)


# Kernels of OpenBLAS, the oldest first. One whose instructions the processor lacks ends the process, one that this OpenBLAS does
# not have is not taken, and some add in the same order: which is of use here is tried.
KERNELS = ("Prescott", "Nehalem", "Sandybridge", "Haswell", "ARMV8", "NEOVERSEN1")
SUMS = """
import hashlib
import numpy as np
a = np.random.default_rng(7).normal(size=(60, 60))
print(hashlib.sha256((a @ a + np.linalg.solve(a, a)).tobytes()).hexdigest())
"""
BUILD = """
import sys
from pathlib import Path
from camgen.pipeline import build as pipeline
specs, out = Path(sys.argv[1]), Path(sys.argv[2])
matched = out.parent / "matched.toml"
matched.write_text((specs / "disc-cam.toml").read_text().replace('law = "modified-sine"', 'law = "matched"'))
cams = ["parts.make='cams'"]
for spec, only, settings in (
    (matched, "dxf", ()), (specs / "eccentric-drive.toml", "dxf", ()), (specs / "thread-take-up.toml", "dxf", ()),
    (specs / "uniform-swing.toml", "stl", cams),
):
    pipeline.build(spec, out, frozenset([only]), settings)
"""


def with_kernel(name: str, code: str, *arguments: str) -> subprocess.CompletedProcess[str]:
    """Run Python code on a BLAS kernel."""
    environment = {key: value for key, value in os.environ.items() if key != "OPENBLAS_CORETYPE"}
    environment |= {"OPENBLAS_CORETYPE": name} if name else {}
    return subprocess.run(
        [sys.executable, "-c", code, *arguments], env=environment, stdout=subprocess.PIPE, text=True
    )


def another_kernel() -> str:
    """A kernel that runs on this processor and whose sums differ in their last digits from those of the processor's own."""
    own = with_kernel("", SUMS)
    own.check_returncode()
    for name in KERNELS:
        done = with_kernel(name, SUMS)
        if done.returncode == 0 and done.stdout != own.stdout:
            return name
    pytest.skip("numpy's BLAS adds in one order only on this machine")


@pytest.mark.long
def test_files_are_the_same_whatever_the_blas_kernel(tmp_path: Path, root: Path) -> None:
    """One test for all: laws, circles and closures once went through BLAS."""
    made = []
    for name in ("", another_kernel()):
        out = tmp_path / (name or "own") / "out"
        out.parent.mkdir()
        with_kernel(name, BUILD, str(root / "specs"), str(out)).check_returncode()
        made.append(
            {
                path.relative_to(out).as_posix(): path.read_bytes()
                for path in out.rglob("*")
                if path.is_file()
            }
        )
    own, other = made
    assert own and sorted(name for name in own | other if own.get(name) != other.get(name)) == []


@settings(max_examples=60)
@given(
    st.lists(st.floats(-50, 50), min_size=1, max_size=6),
    st.floats(0.1, 3),
    st.sampled_from(["slope", "nan", "none"]),
)
def test_roots_are_found_in_their_brackets_whatever_is_known_of_the_slope(
    places: list[float], width: float, known: str
) -> None:
    """Of sinh(t - place), rising, and falling in every second one: to the last digits of the place."""
    wanted, sign = np.array(places), np.where(np.arange(len(places)) % 2, -1.0, 1.0)

    def f(t: np.ndarray, i: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        slope = (
            sign[i] * np.cosh(t - wanted[i])
            if known == "slope"
            else np.full(t.size, np.nan if known == "nan" else 0.0)
        )
        return sign[i] * np.sinh(t - wanted[i]), slope

    low, high = wanted - width / 3, wanted + width
    found = roots(f, low, high)
    np.testing.assert_allclose(found, wanted, rtol=1e-15, atol=1e-15 * width)
    assert np.all((low <= found) & (found <= high))
    coarse = roots(f, low, high, 1e-3)
    assert np.all(np.abs(coarse - wanted) <= 2e-3 * (high - low))
    at_an_end = roots(f, wanted - width, wanted)  # the root is the end itself
    np.testing.assert_allclose(at_an_end, wanted, rtol=1e-15, atol=1e-15 * width)


def test_sign_changes_are_those_of_a_polynomial_and_none_beside_nan() -> None:
    zeros = np.array([-0.7123, -0.1, 0.3001, 0.9])
    values = np.polynomial.Polynomial.fromroots(zeros)
    grid = np.linspace(-1, 1, 41) + 0.003
    for slope in (None, values.deriv()):
        np.testing.assert_allclose(sign_changes(values, grid, slope), zeros, atol=1e-14)
    holed = sign_changes(lambda t: np.where(t < 0, np.nan, values(t)), grid)
    np.testing.assert_allclose(holed, zeros[2:], atol=1e-14)
    assert sign_changes(np.exp, grid).size == 0


@given(st.lists(st.floats(-5, 5), min_size=1, max_size=5), st.floats(0.2, 0.8))
def test_crests_of_roofs_and_domes(places: list[float], share: float) -> None:
    """A roof's ridge is found to its digits, a dome's top, which is flat, to half of them."""
    wanted = np.array(places)
    low, high = wanted - share, wanted + 1
    np.testing.assert_allclose(crests(lambda t: -np.abs(t - wanted), low, high), wanted, atol=1e-11)
    np.testing.assert_allclose(crests(lambda t: -((t - wanted) ** 2), low, high), wanted, atol=1e-7)


def test_the_latest_result_is_that_of_the_values_asked_for() -> None:
    asked: list[np.ndarray] = []

    def total(values: np.ndarray) -> float:
        asked.append(values.copy())
        return float(values.sum())

    of = latest(total)
    values = np.array([1.0, 2.0, 3.0, 4.0])
    assert of(values) == of(values.copy()) == 10 and len(asked) == 1
    values[0] = 5.0  # the caller's array, not the one that is kept
    assert of(values) == 14 and len(asked) == 2
    of(values.reshape(2, 2))
    assert [each.shape for each in asked] == [(4,), (4,), (2, 2)]


def test_greatest() -> None:
    place, value = greatest(lambda x: np.cos(x - 1.23456789), 0.0, 3.0)
    assert place == pytest.approx(1.23456789, abs=1e-7) and value == pytest.approx(1, abs=1e-14)
    assert greatest(lambda x: -np.abs(x - 2.7182818), 0.0, 3.0)[0] == pytest.approx(
        2.7182818, abs=1e-12
    )
    assert greatest(lambda x: np.where(x == 0.5, 2.0, -x), 0.0, 1.0, also=[0.5])[0] == 0.5


def test_the_greatest_of_values_that_are_all_infinite_is_infinite() -> None:
    assert greatest(lambda x: np.full(np.shape(x), -np.inf), 0.0, 1.0)[1] == -np.inf
