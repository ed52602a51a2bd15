"""Hard cases of all six mechanisms against mpmath: the quick ones of tests/bench/stability.py, and its own judgement."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

sys.path.insert(0, str(Path(__file__).parent / "bench"))
import stability  # noqa: E402

from camgen.geometry.rings import Ring  # noqa: E402
from camgen.machines import MECHANISMS  # noqa: E402

QUICK = [case for case in stability.CASES if case.quick]


@pytest.mark.long
@pytest.mark.parametrize("case", QUICK, ids=lambda case: f"{case.mechanism}, {case.name}")
def test_kept_or_refused(case: stability.Case, tmp_path: Path) -> None:
    found = stability.judged(case, tmp_path)
    assert found.fine, found
    if case.name.startswith("as shipped"):
        assert found.said == "kept"


def test_all_mechanisms_are_there() -> None:
    shipped = {case.mechanism for case in QUICK if case.name.startswith("as shipped")}
    # a linkage, a coupon and drums have no outline and no output that is a formula of their own; a plate slides
    others = {"linkage", "coupon", "cylinder-cam", "linear-cam", "drum"}
    assert shipped == set(stability.TRUTHS) == set(MECHANISMS) - others


@pytest.mark.parametrize("mechanism", ["eccentric-drive", "thread-take-up", "chain-stitch-looper"])
def test_a_wrong_motion_is_seen(
    mechanism: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    right = stability.TRUTHS[mechanism]
    monkeypatch.setitem(
        stability.TRUTHS,
        mechanism,
        lambda machine: lambda t: right(machine)(t) * (1 + stability.mp.mpf("1e-11")),
    )
    assert not stability.judged(stability.Case(mechanism, "wrong"), tmp_path).fine


def test_a_wrong_profile_is_seen(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    right = stability.disc_cam

    def longer(machine: Any) -> stability.Truth:
        return lambda theta: right(machine)(theta) * (1 + stability.mp.mpf("1e-4"))

    case = next(case for case in QUICK if case.mechanism == "disc-cam")
    monkeypatch.setitem(stability.TRUTHS, "disc-cam", longer)
    found = stability.judged(case, tmp_path)
    assert not found.fine and found.error > 3e-3


@pytest.mark.parametrize("bulges", [[1, 1], [0.3, 0.8], [-0.2, 0.9], [0, 1]])
def test_distances_from_arcs(bulges: list[float]) -> None:
    """Against the ring cut into chords of 1e-7 mm."""
    ring = Ring(np.array([5, -5 + 2j]), np.array(bulges, float))
    start = ring.facetted(1e-7)
    edge = np.roll(start, -1) - start
    rng = np.random.default_rng(3)
    z = rng.normal(size=40) * 8 + 1j * rng.normal(size=40) * 8
    u = np.clip((np.conj(edge) * (z[:, None] - start)).real / np.abs(edge) ** 2, 0, 1)
    assert stability.apart(ring, z) == pytest.approx(
        np.abs(z[:, None] - start - u * edge).min(axis=1), abs=2e-7
    )
    turns = rng.uniform(0, 6.3, 20)
    tops = (start * np.exp(1j * turns)[:, None]).imag.max(axis=1)
    assert [stability.highest(ring, t) for t in turns] == pytest.approx(tops, abs=2e-7)
