"""Linear algebra without BLAS: right by other routes, and the same files whatever BLAS kernel numpy picks."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import mpmath
import numpy as np
import pytest

from camgen.numerics import gauss_legendre, least_squares, product, solve

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
        np.testing.assert_allclose(found, np.linalg.solve(matrices, right[:, :, None])[:, :, 0], rtol=1e-9)


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
        np.testing.assert_allclose(found[sound], np.linalg.solve(matrices[sound], right[sound]), rtol=1e-7, atol=1e-9)
        np.testing.assert_array_equal(found[:, :, 1], solve(matrices, right[:, :, 1]))


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
            assert abs(float(root - float(x))) < 2e-16 and float(2 / ((1 - root**2) * slope**2)) == pytest.approx(w, rel=1e-13)


KERNELS = ("Prescott", "Haswell", "SkylakeX")
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
    (specs / "uniform-swing.toml", "stl", cams), (specs / "chain-stitch-looper.toml", "stl", ()),
):
    pipeline.build(spec, out, frozenset([only]), settings)
"""


def test_files_are_the_same_whatever_the_blas_kernel(tmp_path: Path, root: Path) -> None:
    """One test for all: laws, circles and closures once went through BLAS. A kernel that cannot run here falls back."""
    made = []
    for name in KERNELS:
        out = tmp_path / name
        code = [sys.executable, "-c", BUILD, str(root / "specs"), str(out)]
        subprocess.run(code, env=os.environ | {"OPENBLAS_CORETYPE": name}, check=True)
        made.append({path.relative_to(out).as_posix(): path.read_bytes() for path in out.rglob("*") if path.is_file()})
    for other in made[1:]:
        assert sorted(name for name in made[0] if made[0][name] != other.get(name)) == []
