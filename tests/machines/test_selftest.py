"""The self-test: every constant agrees, a damaged one is seen."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from camgen import cli
from camgen.machine import closed_form
from camgen.machines import selftest
from camgen.motion import laws as motion


def run(capsys: pytest.CaptureFixture[str]) -> tuple[int, str]:
    with pytest.raises(SystemExit) as done:
        cli.main(["selftest"])
    assert isinstance(done.value.code, int)
    return done.value.code, capsys.readouterr().out


@pytest.mark.long
def test_all_agree(capsys: pytest.CaptureFixture[str]) -> None:
    code, out = run(capsys)
    count = len(list(selftest.rows()))
    rows = list(selftest.rows())
    plain = [row for row in rows if not (row.refuted or row.undecided)]
    assert (
        code == 0
        and "OFF" not in out
        and f"{len(plain)} constants agree; " in out.splitlines()[-1]
        and count > 150
    )
    assert (
        out.startswith("constant") and "mr-13 |b c|" in out and len(out.splitlines()) == count + 2
    )


@pytest.mark.long
@pytest.mark.parametrize("name", list(motion.LAWS))
def test_a_damaged_law_is_seen(
    name: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    law = motion.LAWS[name]

    def damaged(u: np.ndarray, order: int) -> np.ndarray:
        return law.formula(u, order) * (1 if order == 0 else 1.001)

    monkeypatch.setitem(motion.LAWS, name, replace(law, formula=damaged, smoothness=0))
    code, out = run(capsys)
    assert code == 1 and "are OFF" in out.splitlines()[-1]
    own = (name, "I ") if name == "mr-13" else (name,)  # the paper's rows of its law
    assert all(
        any(each in line for each in own) for line in out.splitlines()[1:-1] if line.endswith("OFF")
    )


def test_a_new_law_is_held_against_what_its_record_claims(monkeypatch: pytest.MonkeyPatch) -> None:
    law = replace(motion.LAWS["3-4-5"], name="own")
    monkeypatch.setitem(motion.LAWS, "own", law)
    assert [row.ok for row in selftest.rows() if row.what.startswith("own ")] == [True] * 3
    monkeypatch.setitem(motion.LAWS, "own", replace(law, c_a=5.77, smoothness=0))
    assert [row.ok for row in selftest.rows() if row.what.startswith("own ")] == [True, False, True]


def test_a_damaged_coefficient_is_seen(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(selftest, "MR_13_SINES", (*motion.MR_13_SINES[:-1], 0.025629))
    code, out = run(capsys)
    assert code == 1 and "2 of" in out.splitlines()[-1]


def test_a_damaged_linkage_is_seen(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(
        selftest,
        "slider_travel",
        lambda theta, e, rod: closed_form.slider_travel(theta, e, rod + 1e-3),
    )
    code, out = run(capsys)
    assert (
        code == 1
        and [line.split(",")[0] for line in out.splitlines()[:-1] if line.endswith("OFF")]
        == ["eccentric"] * 2
    )


def test_every_paper_has_its_rows_and_what_is_refuted_says_why() -> None:
    rows = [row for row in selftest.rows() if row.what[:2] in ("U ", "E ", "S ", "I ", "T ")]
    assert {row.what[0] for row in rows} == set("UESIT") and len(rows) > 80
    for row in rows:
        if row.refuted:  # a value that is refuted and yet agrees is an error of ours
            printed = float(row.published.partition(" to ")[0])
            assert not replace(row, ours=printed).ok and row.verdict.startswith("refuted: ")


def test_what_the_reports_say_of_the_papers_is_in_it() -> None:
    """By hand: 22.6 / 2 pi; 13000 / 60; 1 of 47 mm; the eye's arm of 52 mm, which the printed (3) makes 22."""
    found = {row.what: row for row in selftest.rows()}
    assert found["E strokes a second at the printed 22.6 rad/s"].ours == pytest.approx(
        3.597, abs=1e-3
    )
    assert found["E strokes a second at 13000 rpm"].ours == pytest.approx(216.667, abs=1e-3)
    saved = found["S thread saved against type 406, a little over, %"]
    assert saved.agrees and 2 < saved.ours < 2.2 and saved.ours == pytest.approx(100 / 47, abs=0.02)
    assert found["S Omega, to which a loop stays on a cylinder, rad"].undecided
    assert found["T eq. 3: BD of its x' and y' less 52, mm"].ours == pytest.approx(22 - 52)
    assert found["T eq. 2, y' right of AB: eye off the chain's, mm"].agrees
    assert "G, the unloader" in found["I Y, factor of P = Y G"].undecided


def test_damage_to_a_published_value_is_seen() -> None:
    for row in selftest.rows():
        assert row.ok
        if row.refuted or row.undecided:
            continue
        if " to " in row.published:
            assert (
                not replace(row, published=f"{row.ours + 1} to {row.ours + 2}").ok
                and not replace(row, ours=float("nan")).ok
            )
            continue
        digits = row.published.partition("e")[0]
        last = digits[-1]
        other = digits[:-1] + str((int(last) + 2) % 10) + row.published[len(digits) :]
        assert not replace(row, published=other).ok and not replace(row, ours=float("nan")).ok
