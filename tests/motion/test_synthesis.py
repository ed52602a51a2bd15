"""The search for a design: known answers, refusals with what was reached, and the take-up that its source describes."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

from camgen.cli import cli, main
from camgen.errors import DesignError, SpecError
from camgen.motion import synthesis
from camgen.motion.synthesis import Variable, Wish, search
from camgen.pipeline import build as pipeline

SPECS = Path(__file__).resolve().parents[2] / "specs"
SHIPPED = SPECS / "thread-take-up.toml"
ELSEWHERE = (
    "geometry.eye_distance=46",
    "geometry.eye_angle_deg=82",
    "geometry.guides=[[48, 25], [-60, 130]]",
)
DESCRIBED = ("wanted.feed_range=82", "wanted.let_down_ratio=2.13", "wanted.dwell_deg=45")


def made(*overrides: str):
    return pipeline.read_mechanism(SHIPPED, overrides)


def circle(values):
    """Figures of a point: distance from the origin and angle."""
    return {
        "radius": math.hypot(*values),
        "angle": math.degrees(math.atan2(values[1], values[0])),
    }, []


SQUARE = [Variable(3.0, 0.5, 20.0, 1.0), Variable(3.0, 0.5, 20.0, 1.0)]


def test_a_known_answer() -> None:
    found = search(circle, SQUARE, [Wish("radius", 10, 0.01, "mm"), Wish("angle", 30, 0.01, "deg")])
    assert found == pytest.approx([10 * math.cos(math.pi / 6), 5], abs=1e-3)


def test_of_all_that_fulfil_the_nearest_to_the_start() -> None:
    found = search(circle, SQUARE, [Wish("radius", 10, 0.01, "mm")])
    assert found == pytest.approx([math.sqrt(50)] * 2, abs=1e-3)
    assert search(circle, SQUARE, [Wish("radius", 2, 0.01, "mm", at_least=True)]) == pytest.approx(
        [3, 3]
    )


def test_what_cannot_be_is_refused_with_the_nearest_reached() -> None:
    with pytest.raises(DesignError) as refused:
        search(circle, SQUARE, [Wish("radius", 100, 0.1, "mm"), Wish("angle", 45, 10, "deg")])
    assert refused.value.quantity == "radius wanted" and refused.value.value == 100
    assert refused.value.limit == pytest.approx(20 * math.sqrt(2), abs=0.01)
    assert "angle" in str(refused.value)


def test_a_condition_is_kept_or_named() -> None:
    def kept(values):
        return circle(values)[0], [min(0.0, values[0] - values[1] - 1)]

    assert np.subtract(*search(kept, SQUARE, [Wish("radius", 10, 0.01, "mm")])) > 1 - 0.01
    with pytest.raises(DesignError, match="parts would not stay clear"):
        search(lambda v: (circle(v)[0], [-5.0]), SQUARE, [Wish("radius", 10, 0.01, "mm")])


def test_where_nothing_exists_nothing_is_found() -> None:
    with pytest.raises(DesignError, match="nan"):
        search(lambda v: ({"radius": math.nan}, []), SQUARE, [Wish("radius", 10, 0.01, "mm")])


@pytest.mark.long
def test_the_described_take_up_is_found_and_the_command_writes_the_same(tmp_path: Path) -> None:
    asked = (*ELSEWHERE, *DESCRIBED, "consumption=")
    start = made(*asked)
    assert not all(finding.ok for finding in start.limits())
    found = start.designed()
    study = found.study().numbers
    assert study["feed_range_mm"] == pytest.approx(82, rel=0.01)
    assert study["let_down_ratio"] == pytest.approx(2.13, rel=0.01)
    assert study["dwell_within_1_mm_deg"] >= 45 * 0.99
    assert all(finding.ok for finding in found.limits())
    assert {"FEED_RANGE", "LET_DOWN_RATIO", "DWELL_DEG"} <= {
        finding.code for finding in found.limits()
    }
    assert found.geometry.coupler == 19
    file = tmp_path / "found.toml"
    done = CliRunner().invoke(
        cli,
        ["design", str(SHIPPED), str(file), *(word for each in asked for word in ("--set", each))],
    )
    assert done.exit_code == 0, done.output
    assert pipeline.read_mechanism(file) == found
    report = pipeline.build(file, tmp_path, frozenset({"dxf"}))
    assert report.ok and report.numbers["feed_range_mm"] == pytest.approx(
        study["feed_range_mm"], rel=1e-12
    )


@pytest.mark.long
def test_impossible_take_up_names_what_it_reached(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(synthesis, "_STARTS", 1)  # beside the spec's own: more are as much in vain
    with pytest.raises(DesignError, match="feed_range wanted is 2000 mm") as refused:
        made("wanted.feed_range=2000").designed()
    # Each of the two lengths of thread changes by no more than the eye moves; the search lengthens its arm to 83.2 mm at most.
    assert 100 < refused.value.limit < 2 * 2 * (30 + 19 + 83.2)


def test_a_wish_that_is_missed_fails_the_build() -> None:
    wrong = {
        finding.code
        for finding in made("wanted.feed_range=70", "wanted.dwell_deg=60").limits()
        if not finding.ok
    }
    assert wrong == {"FEED_RANGE", "DWELL_DEG"}
    assert all(
        finding.ok for finding in made("wanted.feed_range=82", "wanted.dwell_deg=48").limits()
    )


def test_nothing_wanted_is_a_fault() -> None:
    with pytest.raises(SpecError, match="wanted"):
        made().designed()


def test_design_command_refuses_before_it_searches(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    wish, file = ["--set", "wanted.feed_range=80", "--set", "name=found"], tmp_path / "found.toml"
    file.touch()
    monkeypatch.setattr("camgen.machines.thread_take_up.mechanism.search", None)
    for arguments, code, words in (
        (["design", str(SHIPPED), str(file), *wish], 4, "exists already"),
        (["design", str(SHIPPED)], 2, "wanted"),
        (["design", str(SPECS / "uniform-swing.toml")], 2, "wanted - missing: a table with path"),
        (["design", str(tmp_path / "none.toml")], 4, "cannot be read"),
        (["design"], 2, "Missing argument"),
    ):
        with pytest.raises(SystemExit) as end:
            main(arguments)
        assert end.value.code == code and words in capsys.readouterr().err
