"""The gallery: what each of its specs is there for."""

from __future__ import annotations

import math
import re
import tomllib
from pathlib import Path

import gallery
import numpy as np
import pytest

from camgen import load, starters
from camgen.machines.loads.assess import assess
from camgen.pipeline.build import build, read_mechanism
from camgen.pipeline.making import parts_table

GALLERY = starters.folder() / "gallery"
STANDING = "dial-table"  # of 29 parts; what of it is judged without files
WALKER = "walker"  # of 54 parts, the same
DRAWN = "heart"  # of 33 parts, drawn; the others are made with all their files: tests/pipeline/test_jobs.py


@pytest.mark.parametrize("name", sorted(path.stem for path in GALLERY.glob("*.toml")))
def test_each_spec_is_an_example_that_says_what_it_is(name: str) -> None:
    assert starters.summary(name).endswith(".") and name in starters.examples()


SPECS = [
    path for part in (".", "gallery") for path in starters.folder().joinpath(part).glob("*.toml")
]


@pytest.mark.parametrize("path", sorted(SPECS), ids=lambda path: path.stem)
def test_no_example_is_amber(path: Path) -> None:
    """Nothing fails, nothing is warned of, and what was asked is judged as far as that needs no file."""
    machine = read_mechanism(path)
    found = assess(machine)
    assert all(each.ok for each in (*machine.limits(), *found.findings))
    assert not found.not_judged and not found.warnings and not machine.remarks().warnings


@pytest.mark.long
def test_a_large_spec_builds(tmp_path: Path) -> None:
    report = build(GALLERY / f"{DRAWN}.toml", tmp_path, frozenset({"dxf"}))
    assert report.ok and report.name == DRAWN
    drawn = gallery.drawn(report)
    assert gallery.alike(drawn, gallery.path("heart-drawn").read_text(encoding="utf-8"))
    assert all("the folder has no" in each.why for each in report.not_judged)


@pytest.mark.long
@pytest.mark.parametrize("name", [STANDING, "indexing-cam"])
def test_standing_indexing_cams_hold_on_shafts_of_steel(name: str) -> None:
    """There and back, and by half turns: all that needs no file; printed, the same shafts break, and the key is named."""
    tables = tomllib.loads(starters.text(name))
    tables["parts"]["make"] = "printed"
    teeth = {"TOOTH_STRESS"} if name == "indexing-cam" else set()  # ten times the table's load
    machine = load(tables)
    found = assess(machine)
    failing = {each.code for each in (*machine.limits(), *found.findings) if not each.ok}
    assert failing == teeth
    heavy = [each for each in found.warnings if each.startswith("The flat of 6 mm in ")]
    assert list(found.warnings) == heavy and len(heavy) == len(teeth), "under ten times the load"
    assert {part.process for part in machine.assembly.parts if part.name.startswith("shaft")} <= {
        "turned of steel",
        "bought",
    }
    bought = {row[1]: (row[0], row[2]) for row in parts_table(machine).rows}
    (shaft,) = (part for part in machine.assembly.parts if part.name == "shaft")
    assert bought["shaft"] == (
        "turned of steel",
        f"Shaft: rod 6 h9 x {shaft.thickness:g}, a flat 0.8 deep all along",
    )
    tables["parts"]["shaft_made"] = "printed"
    broken = [finding for finding in assess(load(tables)).findings if not finding.ok]
    pins = [finding for finding in broken if finding.code == "PIN_STRESS"]
    assert {finding.code for finding in broken} == {"PIN_STRESS"} | teeth
    assert all('parts.shaft_made = "steel"' in finding.message for finding in pins)


@pytest.mark.long
def test_the_walker_has_legs_at_both_sides_a_motor_and_batteries() -> None:
    """Eight feet, each with its sole; one motor, whose shaft reaches its web, turns all of them."""
    machine = load(tomllib.loads(starters.text(WALKER)))
    found = assess(machine)
    assert all(finding.ok for finding in (*machine.limits(), *found.findings))
    assert not found.warnings and not found.not_judged
    assert len(machine.model.outputs) == 8
    parts = machine.assembly.by_name
    assert all(parts[f"leg{k}"].count == 2 for k in range(1, 5))
    assert {"motor-bar", "far-battery-frame"} <= parts.keys()
    assert sum(each.count for each in machine.assembly.bought if each.role == "drive") == 1


@pytest.mark.long
def test_the_walkers_plates_stay_off_the_floor() -> None:
    """At each angle the lowest sole of either side reaches at least 5 mm below the lowest edge of all plates."""
    machine = load(tomllib.loads(starters.text(WALKER)))
    run = machine.solve(np.linspace(0, math.tau, 721), 0)
    sole = 12 / 2
    for side in ("", "far_"):
        feet = [np.imag(run[f"{side}foot{k}"]) - sole for k in range(1, 5)]
        floor = np.min(feet, axis=0)
        for name in ("ground", "second-plate", "far-ground"):
            outer = machine.assembly.by_name[name].region.outer
            edge = min(
                float(np.min(np.imag(piece.at(np.linspace(piece.t0, piece.t1, 50)))))
                for piece in outer.pieces
            )
            assert np.all(floor < edge - 5)


def test_an_example_is_named_once_and_none_needs_another_file() -> None:
    assert {
        "automaton",
        "dial-table",
        "four-bar",
        "groove",
        "valve",
        "quick-return",
        "walking-leg",
    } <= set(starters.examples())
    assert "stitch-head" not in starters.examples()  # it includes other specs


def test_the_valve_floats_where_its_spring_gives_out() -> None:
    """Spring at 4 mm over 0.09 kg against 7.51 h / beta^2 of law 4-5-6-7: about 2,250 rpm."""
    tables = tomllib.loads(starters.text("valve"))

    def least(rpm: float) -> float:
        tables["motor"]["speed_rpm"] = rpm
        return next(f.measured for f in load(tables).limits() if f.code == "LIFT_OFF")

    assert least(2000) > 0 > least(2600)


CHANGES = {
    name: dict(re.findall(r"`([a-z_0-9.A-Z]+) = ([^`]+)`", line))
    for name in starters.examples()
    for line in starters.text(name).splitlines()[:2]
    if line.startswith("# Change first: ")
}


@pytest.mark.long
@pytest.mark.parametrize("name", CHANGES)
def test_what_an_example_says_to_change_first_can_be_changed(name: str) -> None:
    """Each change that stands in its second line is another machine, that holds its limits and has parts."""
    machine = load(tomllib.loads(starters.text(name)))
    changes = {key: tomllib.loads(f"x = {value}")["x"] for key, value in CHANGES[name].items()}
    changed = machine.replace(changes)
    assert changes and changed != machine and changed.assembly.parts
    assert [finding.code for finding in changed.forecast() if not finding.ok] == []
