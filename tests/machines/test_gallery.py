"""The gallery: each spec builds as it is, and shows what it is there for."""

from __future__ import annotations

import tomllib
from pathlib import Path

import pytest

from camgen import load, starters
from camgen.pipeline.build import build

ONLY = frozenset({"dxf"})


@pytest.mark.parametrize("path", sorted((starters.folder() / "gallery").glob("*.toml")), ids=lambda path: path.stem)
def test_each_spec_builds(path: Path, tmp_path: Path) -> None:
    report = build(path, tmp_path, ONLY)
    assert report.ok and report.name == path.stem
    assert starters.summary(path.stem).endswith(".") and path.stem in starters.examples()


def test_an_example_is_named_once_and_none_needs_another_file() -> None:
    assert {"automaton", "four-bar", "groove", "valve", "quick-return", "walking-leg"} <= set(starters.examples())
    assert "stitch-head" not in starters.examples()  # it includes other specs


def test_the_valve_floats_where_its_spring_gives_out() -> None:
    """Spring at 4 mm over 0.09 kg against 7.51 h / beta^2 of law 4-5-6-7: about 2,250 rpm."""
    tables = tomllib.loads(starters.text("valve"))

    def least(rpm: float) -> float:
        tables["motor"]["speed_rpm"] = rpm
        return next(f.measured for f in load(tables).limits() if f.code == "LIFT_OFF")

    assert least(2000) > 0 > least(2600)
