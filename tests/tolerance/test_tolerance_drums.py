"""Print errors of cylinder cams: each mode against the roller, rolled in a mesh or with a roller that is off by so much."""

from __future__ import annotations

import math
import tomllib
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from camgen.geometry.mesh import Mesh
from camgen.judge.drum_pieces import placed, together
from camgen.judge.rolled_drum import Rolled, RollerTable, roll, roller_table
from camgen.machine.print_errors import Sizes
from camgen.machines.cylinder_cam.mechanism import CylinderCam
from camgen.parts.solids import solid
from camgen.spec import validate
from camgen.tolerance.drums import DrumErrors
from camgen.tolerance.report import PrintRun, tolerance
from camgen.tolerance.spread import copies_of, drawn_again, rolled_outputs, spread_of

SPEC = Path(__file__).parents[2] / "specs" / "cylinder-cam.toml"
OFF = 0.1  # mm, of each error
SIZES = Sizes(0.03, 0.02, 0.04, 0.06)
CASES: dict[str, dict[str, Any]] = {
    "slide": {},
    "arm": {"follower": {"motion": "oscillating", "arm": 40.0}},
    "offset cone": {
        "follower": {"offset": 3.0},
        "roller": {"radius": 5.0, "length": 6.0, "cone_deg": 12.0},
    },
    "rib": {"track": "rib", "distance": 16.0},
    "end": {"track": "end"},
}


def drum(**geometry: Any) -> CylinderCam:
    data = tomllib.loads(SPEC.read_text(encoding="utf-8"))
    data["geometry"]["roller"]["length"] = 6.0
    data["geometry"] |= geometry
    data["accuracy"] = {"chord_tolerance": 0.005}
    data["parts"]["pieces"] = 1
    return validate(CylinderCam, data)


def shifted(mesh: Mesh, x: float, y: float) -> Mesh:
    return Mesh(mesh.vertices + [x, y, 0], mesh.faces)


def made_wrong(
    where: str, kind: str, along: complex, mesh: Mesh, table: RollerTable
) -> Rolled | None:
    """The roller of a drum that is off in one way; None of what is not rolled here."""
    told = table.model_dump()
    y = OFF * along.real
    z = OFF * along.imag
    match where, kind:
        case "drum", "bore":
            return roll(shifted(mesh, y, z), table, 60)
        case "roller", "depth":
            return roll(mesh, RollerTable(**{**told, "inner": table.inner + OFF}), 60)
        case "roller", "tip":
            return roll(mesh, RollerTable(**{**told, "radius": table.radius + OFF}), 60)
        case "guide, roller", "centre" if along == 1:
            beside = (table.offset or 0.0) + OFF
            return roll(mesh, RollerTable(**{**told, "offset": beside}), 60)
        case "pivot, ground", "centre":
            assert table.pivot is not None
            pivot = (table.pivot[0] + y, table.pivot[1] + z)
            return roll(mesh, RollerTable(**{**told, "pivot": pivot}), 60)
        case "arm, roller", "centre" if along == 1:
            assert table.arm is not None
            return roll(mesh, RollerTable(**{**told, "arm": table.arm + OFF}), 60)
    return None


@pytest.mark.long
@pytest.mark.parametrize("case", CASES)
def test_each_error_moves_the_follower_as_the_mesh_says(case: str) -> None:
    """Facets may differ, and what the walls' slope changes along the roller: one that is beside the axis meets them at its ends,
    by OFF times half that change."""
    made = drum(**CASES[case])
    mesh = solid(made.assembly.parts[0], 0.004)
    table = roller_table(made.assembly.tracks[0], 0.004)
    exact = roll(mesh, table, 60)
    modes, found = DrumErrors(made.track, exact.theta, SIZES, False).sensitivity()
    unit = 1 / (table.arm or 1.0)
    rolled = 0
    for k, mode in enumerate(modes):
        wrong = made_wrong(mode.where, mode.kind, mode.along, mesh, table)
        if wrong is None:
            continue
        rolled += 1
        moved = wrong.motion - exact.motion
        near = pytest.approx(OFF * found.modes[k], abs=0.012 * unit)
        assert moved == near, mode
        if found.held:
            gap, _ = found.held["contact"]
            assert wrong.play - exact.play == pytest.approx(OFF * gap[k], abs=0.018 * unit), mode
    assert rolled >= (6 if case == "arm" else 4)
    # and none of these is idle where it counts: the bore moves by the slope of the track
    bore = next(k for k, mode in enumerate(modes) if mode.kind == "bore")
    assert np.abs(found.modes[bore]).max() > 0.2 * unit


@pytest.mark.long
@pytest.mark.parametrize("case", [*CASES, "pieces"])
def test_worst_copies_are_as_the_first_order_says_when_they_are_rolled(case: str) -> None:
    """All errors of a copy at once, in the walls of its mesh, its bore, roller and follower. Largest errors of 0.25 to 0.5 mm differ
    by 0.02 mm at most from one order to the next, and by a tenth of that in a slide's groove."""
    made = drum(**CASES.get(case, {"follower": {"offset": 3.0}}))
    if case == "pieces":
        made = made.replace({"parts.pieces": 2})
    spread = spread_of(made)
    output = spread.outputs[0].name
    worst = np.argsort(-copies_of(spread, 4000, 1).errors[output])[:3]
    errors = drawn_again(spread, 1, [int(k) for k in worst])
    size = made.geometry.follower.arm or 1.0
    first = size * (errors @ spread.found[output].modes)
    rolled = size * rolled_outputs(spread, errors)[output]
    assert rolled.shape == first.shape
    assert np.all(np.abs(first).max(axis=1) > 0.2)
    assert rolled == pytest.approx(first, abs=0.006 if case == "slide" else 0.02)


@pytest.mark.long
def test_a_ring_that_is_off_its_seat_or_its_key_moves_one_wall() -> None:
    """Both pieces put together, the ring higher by OFF, or turned as its flat is off by OFF at its ends."""
    made = drum(follower={"offset": 3.0}).replace({"parts.pieces": 2})
    lower, ring = (solid(part, 0.005) for part in made.assembly.parts)
    upper = placed(ring, made.track.length)
    assert made.pieces is not None
    turn = np.exp(1j * OFF / made.pieces.corner)
    x, y, z = upper.vertices.T
    plan = (x + 1j * y) * turn
    wrong = {
        "seat": Mesh(upper.vertices + [0, 0, OFF], upper.faces),
        "key": Mesh(np.column_stack([plan.real, plan.imag, z]), upper.faces),
    }
    table = roller_table(made.assembly.tracks[0], 0.005)
    exact = roll(together(lower, upper), table, 60)
    sizes = Sizes(0.03, 0.02, 0.04, 0.06)
    modes, found = DrumErrors(
        made.track, exact.theta, sizes, True, made.pieces.corner
    ).sensitivity()
    gap, _ = found.held["contact"]
    own = [(k, mode) for k, mode in enumerate(modes) if mode.where == "ring"]
    assert {mode.kind for _, mode in own} == set(wrong)
    for k, mode in own:
        off = roll(together(lower, wrong[mode.kind]), table, 60)
        assert off.motion - exact.motion == pytest.approx(OFF * found.modes[k], abs=0.012)
        assert off.play - exact.play == pytest.approx(OFF * gap[k], abs=0.018)
        assert np.abs(found.modes[k]).max() > 0.2


def test_a_wall_that_bumps_by_waves_is_the_roller_thicker_there() -> None:
    """All waves of a wall together against one roller that is thicker by as much, at one angle; the other wall stays."""
    made = drum()
    theta = np.linspace(0, math.tau, 50)
    modes, found = DrumErrors(made.track, theta, SIZES, False).sensitivity()
    tip = next(k for k, mode in enumerate(modes) if mode.kind == "tip")
    offsets = [k for k, mode in enumerate(modes) if mode.kind == "offset"]
    gap, air = found.held["contact"]
    assert gap[offsets].sum(axis=0) == pytest.approx(gap[tip])
    assert -gap[tip] == pytest.approx(air)
    assert found.modes[offsets].sum(axis=0) == pytest.approx(found.modes[tip])
    forms = np.array([gap[k] for k, mode in enumerate(modes) if mode.kind == "form"])
    waves = len(SIZES.waves)
    assert (forms**2).sum(axis=0) == pytest.approx(2 * (gap[offsets[0]] ** 2))
    assert len(forms) == 4 * waves


def test_copies_of_a_drum_are_told_with_their_budget_and_yield() -> None:
    whole_drum = ("parts.pieces=1", "geometry.roller.length=6")  # as that of `drum`
    report = tolerance(SPEC, whole_drum, PrintRun(samples=4000))
    budget, errors, yields, *_ = report.tables
    assert {str(row[0]) for row in budget.rows} == {
        "guide, roller", "drum", "wall below", "wall above", "all together"
    }  # fmt: skip
    assert [row[0] for row in yields.rows] == ["LASH", "INTERFERENCE", "all of these"]
    spread = spread_of(drum())
    whole = float(budget.rows[-1][3])  # type: ignore[arg-type]
    sizes = np.array([mode.size for mode in spread.modes])
    deviation = np.sqrt(np.sum((spread.found["lift"].modes * sizes[:, None]) ** 2, axis=0))
    assert whole == pytest.approx(3 * deviation.max(), rel=1e-3)
    # half of all copies err by less than their deviation at the worst angle
    assert 0.5 * whole / 3 < float(errors.rows[0][2]) < 1.5 * whole / 3  # type: ignore[arg-type]


@pytest.mark.long
def test_a_bought_roller_has_no_error_and_a_wider_groove_jams_less() -> None:
    printed = {mode.kind for mode in spread_of(drum()).modes}
    small = drum(roller={"radius": 5.0, "length": 4.0})
    assert printed - {mode.kind for mode in spread_of(small).modes} == {"tip"}
    wide = replace(spread_of(drum()), mechanism=drum().replace({"print.slide_clearance": 0.4}))
    assert (spread_of(drum()).air["contact"], wide.air["contact"]) == pytest.approx((0.1, 0.2))
