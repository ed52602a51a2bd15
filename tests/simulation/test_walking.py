"""A walker goes as an independent prototype found it; verdicts fail on what they are there to see."""

from __future__ import annotations

import io
import math
import sys
import tomllib
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from conftest import ROOT
from PIL import Image

from camgen.errors import FileError, SpecError
from camgen.machine.print_errors import Sizes
from camgen.machine.run import solve
from camgen.machines.loads.rubbing import with_friction
from camgen.machines.loads.weights import with_masses
from camgen.machines.sources import read_mechanism
from camgen.pipeline.multibody import simulated, standing_of
from camgen.report.page import to_html
from camgen.simulation import picture, walking
from camgen.simulation.gait import Gait, _Run, engine
from camgen.tolerance.printed import loose, misplaced

REFERENCE = tomllib.loads((ROOT / "tests" / "reference" / "walks.toml").read_text(encoding="utf-8"))
FEET = 'walk.feet=["foot1", "foot2", "foot3", "foot4"]'


@pytest.fixture(scope="module")
def machine() -> Any:
    """The prototype's crank pins are printed."""
    spec = ROOT / "specs" / "four-leg-walker.toml"
    printed = "parts.shaft_made=printed"
    return read_mechanism(spec, [FEET, "walk.payload_g=40", printed]).resolved()


@pytest.fixture(scope="module")
def model(machine: Any) -> Any:
    standing = standing_of(machine)
    assert standing is not None
    return replace(simulated(machine, standing), rubs=())  # the prototype's pins do not rub


@pytest.fixture(scope="module")
def run(machine: Any, model: Any) -> Gait:
    """Two turns at the middle friction."""
    return walking.walk(machine, model, 0.6, 2)


@pytest.mark.long
def test_it_goes_as_the_prototype(run: Gait) -> None:
    """Within 2 %, the prototype's own spread over steps and stiffness of contacts."""
    there = REFERENCE["at_0_6"]
    assert run.way_per_turn == pytest.approx(REFERENCE["way_mm"]["0.6"], rel=0.02)
    assert run.slip_per_turn == pytest.approx(there["slip_mm"], rel=0.05)
    tilt = np.degrees([run.tilt.min(), run.tilt.max()])
    np.testing.assert_allclose(tilt, there["tilt_deg"], atol=0.3)
    assert np.ptp(run.place[:, 2]) == pytest.approx(there["height_mm"], abs=0.1)
    assert not (run.void or run.falls or run.stalls)
    assert run.seconds_per_turn == pytest.approx(2.0, rel=0.02)
    assert np.max(np.abs(run.roll)) < 1e-6 and abs(run.turning_per_turn) < 1e-6


def test_pins_rub_by_their_reactions() -> None:
    """Torque that turns a four-bar against its weight, 30 rpm, its frame held: as kinetostatics has it with friction circles."""
    upright = ["load.gravity_deg=-90", "drive.speed_rpm=30"]
    four_bar = read_mechanism(ROOT / "specs" / "linkage.toml", upright).resolved()
    assembly = four_bar.assembly
    weighed = with_masses(assembly.exact, assembly.solids, four_bar.load).machine
    own = four_bar.material.name
    rubbing = with_friction(weighed, assembly.journals, four_bar.load, own)
    turn = np.linspace(0, math.tau, 720, endpoint=False)
    (needed,) = solve(rubbing, turn).forces().drives.values()
    whole = simulated(four_bar)
    motor = replace(whole.motor, stall=None)
    found = []
    for rubs in (whole.rubs, (), whole.rubs[-1:]):
        model = replace(whole, down=(0.0, -1.0, 0.0), motor=motor, rubs=rubs)
        run = _Run(engine(), model.bare, model)
        for k in range(575):  # of 4 ms: 0.3 s to its speed, a turn of 2 s
            run.step(motor.control * min(1.0, (k + 1) / 75))
            found.append(run.data.actuator_force[0])
    torque, smooth, of_loop = np.reshape(found, (3, -1))[:, 75:]
    size = float(np.ptp(needed))
    assert [*whole.rubs][-1].shares and len(whole.rubs) == 4
    assert torque.mean() == pytest.approx(np.mean(needed), abs=2e-3 * size)
    assert torque.min() == pytest.approx(needed.min(), abs=2e-3 * size)
    assert torque.max() == pytest.approx(needed.max(), abs=2e-3 * size)
    assert smooth.mean() == pytest.approx(0.0, abs=2e-3 * size) and np.mean(needed) > 0.05 * size
    *others, _ = [rub.name for rub in whole.rubs]  # the pin of the loop, rubbing alone
    joints = [replace(pin, friction=0.0) if pin.name in others else pin for pin in rubbing.joints]
    (needed,) = solve(replace(rubbing, joints=tuple(joints)), turn).forces().drives.values()
    assert (of_loop - smooth).mean() == pytest.approx(np.mean(needed), rel=0.01)
    assert np.mean(needed) > 1e-3 * size


def judged(machine: Any, model: Any, gaits: list[Gait]) -> dict[str, bool]:
    report = walking.judged(machine, model, gaits, 120.0)
    return {each.code: each.ok for each in report.findings}


@pytest.mark.long
def test_all_holds(machine: Any, model: Any, run: Gait) -> None:
    found = judged(machine, model, [run])
    assert found == dict.fromkeys(["BRANCH", "FALLS", "STALLS", "WALKS", "SLIPS"], True)


@pytest.mark.long
def test_each_verdict_is_seen_to_fail(machine: Any, model: Any, run: Gait) -> None:
    """One run of two is spoilt: it decides."""
    spoilt = {
        "BRANCH": {"error": np.where(run.time > 1, 119.0, run.error)},
        "FALLS": {"clearance": run.clearance - run.clearance.max() - 1},
        "STALLS": {"crank": np.minimum(run.crank, 2.7)},
        "WALKS": {"place": run.place * [0.01, 1, 1]},
        "SLIPS": {"sliding": 5 * run.sliding},
    }
    for code, damage in spoilt.items():
        found = judged(machine, model, [run, replace(run, friction=1.0, **damage)])
        assert not found[code] and found.get("BRANCH") is (code != "BRANCH")
        assert (len(found) == 1) is (code == "BRANCH")


@pytest.mark.long
def test_a_frame_that_leans_falls(run: Gait) -> None:
    turn = math.radians(46)
    over = np.array(
        [[1, 0, 0], [0, math.cos(turn), -math.sin(turn)], [0, math.sin(turn), math.cos(turn)]]
    )
    leaning = replace(run, axes=np.einsum("ij,njk->nik", over, run.axes))
    assert leaning.falls and np.degrees(leaning.roll.min()) == pytest.approx(-46, abs=0.1)


@pytest.mark.long
def test_a_turn_to_the_side_is_no_loss_of_way(run: Gait) -> None:
    """All seen from a world that is turned by 40 deg."""
    turn = math.radians(40)
    world = np.array(
        [[math.cos(turn), -math.sin(turn), 0], [math.sin(turn), math.cos(turn), 0], [0, 0, 1]]
    )
    other = replace(run, place=run.place @ world.T, axes=np.einsum("ij,njk->nik", world, run.axes))
    assert other.way_per_turn == pytest.approx(run.way_per_turn, rel=1e-9)
    np.testing.assert_allclose(other.heading - run.heading, turn)


@pytest.mark.long
def test_a_film_shows_it_going_on(
    machine: Any, model: Any, run: Gait, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Its ink moves to the right from the first frame to the last, of few frames."""
    monkeypatch.setattr(picture, "_FRAMES", 1)
    image = Image.open(io.BytesIO(picture.film(machine, model, run)))
    frames = []
    for k in (0, image.n_frames - 1):
        image.seek(k)
        pixels = np.asarray(image.convert("RGB"), int)
        coloured = np.ptp(pixels, axis=2) > 60
        frames.append(np.nonzero(coloured)[1].mean())
    assert frames[1] - frames[0] > 0.2 * image.width


@pytest.mark.long
def test_a_printed_copy_walks_a_little_otherwise(machine: Any, model: Any, run: Gait) -> None:
    """Its legs stay closed on its own pins, not on the exact ones; both kinds of runs have figures of their own.

    The second copy that is drawn: the first comes so near a fold that its run is void.
    """
    chance = np.random.default_rng(3)
    sizes = Sizes(0, 0, 0.02, 0)
    _, copy = (loose(misplaced(machine.assembly.exact, sizes, chance), chance) for _ in range(2))
    standing = standing_of(machine)
    assert standing is not None
    made = replace(simulated(machine, standing, copy), rubs=())
    other = replace(walking.walk(machine, made, 0.6, 2, copy), copy=1)
    assert not other.void and walking.walk(machine, made, 0.6, 1).void
    assert 0.1 < abs(other.way_per_turn - run.way_per_turn) < 40
    report = walking.judged(machine, model, [run, other], 120.0)
    assert report.numbers["way_per_turn_least_mm"] == run.way_per_turn
    assert report.numbers["copies_way_per_turn_least_mm"] == other.way_per_turn
    damaged = replace(other, crank=np.minimum(other.crank, 2.7))
    (stalls,) = [
        each
        for each in walking.judged(machine, model, [run, damaged], 120.0).findings
        if each.code == "STALLS"
    ]
    assert not stalls.ok and "copy 1" in str(stalls.where)
    void = replace(other, error=np.full(len(other.time), 119.0))
    alone = walking.judged(machine, model, [run, void], 120.0)
    assert alone.ok and "copies_way_per_turn_least_mm" not in alone.numbers


@pytest.mark.long
def test_copies_that_do_not_close_are_told(machine: Any) -> None:
    """With centres 0.2 mm off the legs come to their folds; with exact ones, and pins without play, none does."""
    rough = machine.replace({"print.place_error": 0.2})
    drawn = walking._copies(rough, walking.Prints(2, 1))
    assert len(drawn.closing) < drawn.drawn and "do not close" in drawn.note
    assert drawn.figures[0].value < 100
    fine = machine.replace({"print.place_error": 0.0, "print.slide_clearance": 0.01})
    assert walking._copies(fine, walking.Prints(2, 1)).drawn == 2


@pytest.mark.long
@pytest.mark.parametrize(("closes", "drawn"), [([False, True], 1), ([False] * 20 + [True], 2)])
def test_pins_of_a_copy_give_way(
    machine: Any, monkeypatch: pytest.MonkeyPatch, closes: list[bool], drawn: int
) -> None:
    """One that closes when its pins lie otherwise is no other copy; one that does not in twenty ways is lost."""
    answers = iter(closes)
    seen: list[Any] = []
    monkeypatch.setattr(walking, "_closes", lambda copy: seen.append(copy) or next(answers))
    found = walking._copies(machine, walking.Prints(1, 1))
    assert found.drawn == drawn and found.closing == seen[-1:]
    bores = [[joint.b for joint in copy.joints if hasattr(joint, "b")] for copy in seen]
    assert bores[0] == bores[1] and seen[0] != seen[1]


@pytest.mark.long
def test_the_page_shows_the_film_by_itself(machine: Any, model: Any, run: Gait) -> None:
    report = walking.judged(machine, model, [run], 120.0)
    assert "data:image/gif" not in to_html(report)
    page = to_html(replace(report, film=b"GIF89a"))
    assert 'src="data:image/gif;base64,R0lGODlh"' in page and "img-src data:" in page


@pytest.mark.long
def test_counts_of_copies_that_are_none_are_refused(machine: Any, tmp_path: Path) -> None:
    with pytest.raises(SpecError, match=r"--copies: 101.*\n.*--seed: -1"):
        walking.simulate(machine, tmp_path, prints=walking.Prints(101, -1))


def test_what_does_not_walk_is_told(tmp_path: Path) -> None:
    with pytest.raises(SpecError, match="walk"):
        walking.simulate(ROOT / "specs" / "linkage.toml", tmp_path)


@pytest.mark.long
def test_without_the_engine_the_extra_is_named(
    machine: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "mujoco", None)
    with pytest.raises(FileError, match=r"pip install .*\[simulate\]"):
        walking.simulate(machine, tmp_path)
    assert not any(tmp_path.iterdir())
