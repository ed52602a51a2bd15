"""Laws of motion: what each record declares, recomputed in both directions."""

from __future__ import annotations

from dataclasses import replace

import mpmath
import numpy as np
import pytest

from camgen.motion import LAWS, TURN, TURN_PEAK, Law

U = np.linspace(0, 1, 200_001)
ALL = [*LAWS.values(), TURN]

# Displacement of each law, written down again from its definition.
FORMULAS = {
    "uniform": lambda u: u,
    "3-4-5": lambda u: 10 * u**3 - 15 * u**4 + 6 * u**5,
    "turn": lambda u: mpmath.quad(lambda w: 1 - 2 * (10 * w**3 - 15 * w**4 + 6 * w**5), [0, u]),
}
# Derivatives of what the law joins, before and after: a dwell at 0 and at 1; for the turn uniform motion there and back.
JOINED = {"uniform": ((0,), (1,)), "3-4-5": ((0,), (1,)), "turn": ((0, 1), (0, -1))}


def smoothness(law: Law) -> int:
    """Highest order up to which every derivative continues what the law joins."""
    before, after = (side + (0,) * 4 for side in JOINED[law.name])
    order = -1
    while order < 3 and all(
        abs(float(law(u, order + 1)) - side[order + 1]) < 1e-12 for u, side in ((0.0, before), (1.0, after))
    ):
        order += 1
    return order


def peaks_hold(law: Law) -> bool:
    """C_v, C_a, C_j are the largest derivatives on a fine grid: neither more nor less."""
    declared = (law.c_v, law.c_a, law.c_j)
    return all(
        abs(float(np.max(np.abs(law(U, order)))) - peak) <= 1e-8 * max(1.0, peak)
        for order, peak in enumerate(declared, start=1)
    )


@pytest.mark.parametrize("law", ALL, ids=lambda law: law.name)
def test_claims(law: Law) -> None:
    assert law.source
    assert smoothness(law) == law.smoothness
    assert peaks_hold(law)


@pytest.mark.parametrize("law", [law for law in ALL if law.c_a], ids=lambda law: law.name)
@pytest.mark.parametrize("factor", [0.999, 1.001])
@pytest.mark.parametrize("claim", ["c_v", "c_a", "c_j"])
def test_wrong_claims_are_found(law: Law, factor: float, claim: str) -> None:
    assert not peaks_hold(replace(law, **{claim: factor * getattr(law, claim)}))


@pytest.mark.parametrize("law", ALL, ids=lambda law: law.name)
def test_derivatives(law: Law) -> None:
    mpmath.mp.dps = 30
    for u in (0.0312, 0.25, 0.5, 0.777):
        for order in range(4):
            truth = (
                mpmath.diff(FORMULAS[law.name], mpmath.mpf(u), order, h=mpmath.mpf(10) ** -8)
                if order
                else FORMULAS[law.name](u)
            )
            assert float(law(u, order)) == pytest.approx(float(truth), abs=1e-9)


def test_ends_and_peak() -> None:
    for law in LAWS.values():
        assert (float(law(0.0)), float(law(1.0))) == (0.0, 1.0)
    assert (float(TURN(0.0)), float(TURN(1.0))) == (0.0, 0.0)
    assert float(np.max(TURN(U))) == TURN_PEAK == float(TURN(0.5))
    assert np.all(np.diff(LAWS["3-4-5"](U)) > 0)
    np.testing.assert_allclose(TURN(U), TURN(1 - U), atol=1e-15)
