"""All six machines on the one model: it moves as each mechanism's own formulas and poses say, and closes by the judge's route."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np
import pytest

from camgen.machine.closing import close
from camgen.machine.constraints import Constraints
from camgen.machines.indexing_cam.mechanism import IndexingCam
from camgen.machines.mechanism import Mechanism
from camgen.pipeline import build as pipeline

SPECS = Path(__file__).resolve().parents[2] / "specs"
THETA = np.random.default_rng(5).uniform(0, 2 * np.pi, 200)
# Spec, overrides, the output that is the wanted motion, and which body each part is fixed to.
LINKS = {
    "crank": "crank",
    "coupler": "coupler",
    "output": "output",
    "shaft": "crank",
}
SLIDERS = {name: name for name in ("needle-1", "needle-2", "lower-spreader", "upper-spreader")}
CAM = {"cam": "cam"}
ROWS: list[tuple[str, list[str], str, Mapping[str, str]]] = [
    ("uniform-swing", ["parts.make='cams'", "geometry.tip_radius=0"], "swing", CAM),
    (
        "uniform-swing",
        ["parts.make='cams'", "geometry.closure='force'", "geometry.reversal_blend_deg=40"],
        "swing",
        CAM,
    ),
    ("disc-cam", [], "lift", CAM),
    (
        "disc-cam",
        [
            "geometry.follower.motion='oscillating'",
            "geometry.follower.pivot_distance=60",
            "geometry.follower.arm=50",
            "geometry.base_radius=30",
            "motor.speed_rpm=-60",
        ],
        "swing",
        CAM,
    ),
    ("indexing-cam", [], "swing", CAM),
    ("indexing-cam", ["geometry.closure='force'", "geometry.index_deg=150"], "swing", CAM),
    ("eccentric-drive", [], "travel", {"disc": "disc", "rod": "rod", "slider": "slider"}),
    (
        "eccentric-drive",
        ["geometry.offset=4"],
        "travel",
        {"disc": "disc", "rod": "rod", "slider": "slider"},
    ),
    ("thread-take-up", [], "feed", LINKS),
    ("thread-take-up", ["geometry.branch=1", "geometry.frame_angle_deg=30"], "feed", LINKS),
    ("chain-stitch-looper", [], "spreader", SLIDERS),
    ("chain-stitch-looper", ["timing.lag_deg=1"], "spreader", SLIDERS),
]


@pytest.mark.long
@pytest.mark.parametrize(
    ("spec", "overrides", "output", "bodies"), ROWS, ids=lambda value: str(value)[:30]
)
def test_the_model_moves_as_the_mechanism(
    spec: str, overrides: list[str], output: str, bodies: Mapping[str, str]
) -> None:
    made: Mechanism = pipeline.read_mechanism(SPECS / f"{spec}.toml", overrides)
    run = made.solve(THETA)
    for order in range(3):
        wanted = made.motion(THETA, order)
        np.testing.assert_allclose(
            run.derivatives(output)[order], wanted, atol=1e-9 * max(1.0, np.abs(wanted).max())
        )
    poses = made.assembly.poses(THETA)
    for part, body in bodies.items():
        pose, there = poses[part][0], run.pose(body)
        turned = there.angle - pose.angle
        np.testing.assert_allclose(np.exp(1j * (turned - turned[0])), 1, atol=1e-9)
        place = there.place + (
            pose.place[0] - there.place[0]
        )  # a part sits anywhere on its body's axis
        np.testing.assert_allclose(pose.place, place, atol=1e-9)
    # the judge's route: all joints closed at once
    closed = close(Constraints(made.model), THETA[:40])
    q = np.array(
        [
            [pose.place.real, pose.place.imag, pose.angle]
            for pose in map(run.pose, Constraints(made.model).bodies)
        ]
    )
    np.testing.assert_allclose(
        closed.q, np.moveaxis(q, 2, 0).reshape(len(THETA), -1)[:40], atol=1e-9
    )
    # power put in is what the energy, the loads and friction take
    forces = run.forces()
    np.testing.assert_allclose(
        forces.power,
        forces.power_in + forces.loads - forces.rubs,
        atol=1e-9 * max(1e-9, np.abs(forces.power).max()),
    )


@pytest.mark.parametrize(
    "overrides", [[], ["geometry.closure='force'", "load.closing_n_m=2"], ["motor.speed_rpm=-30"]]
)
def test_the_indexing_cams_forces_are_its_torques(overrides: list[str]) -> None:
    """Link, friction and unloader through gears, by the Jacobian and by sums; the normal by the pressure angle."""
    made = pipeline.read_mechanism(SPECS / "indexing-cam.toml", overrides)
    assert isinstance(made, IndexingCam)
    theta = made.indexing.fine
    forces, torques, closing = (
        made.solve(theta).forces(),
        made.indexing.at(theta),
        made.load.closing_n_m,
    )
    np.testing.assert_allclose(forces.contacts["contact"], torques.follower + closing, atol=1e-12)
    np.testing.assert_allclose(
        forces.drives["drive"], torques.shaft + closing * made.program(theta, 1), atol=1e-12
    )
    cams = list(made.cams.values())
    effort = torques.follower + closing
    steep = np.where(
        (effort >= 0) | (len(cams) == 1),
        cams[0].pressure_angle_untrimmed(theta),
        cams[-1].pressure_angle_untrimmed(theta),
    )
    lever = made.geometry.follower.arm * 1e-3 * np.cos(steep)
    np.testing.assert_allclose(
        np.abs(forces.pressing["contact"]), np.abs(effort) / lever, rtol=1e-9, atol=1e-9
    )
    assert made.study().numbers["peak_contact_force_n"] == pytest.approx(
        np.abs(effort / lever).max()
    )


@pytest.mark.parametrize(
    ("spec", "output", "lash"),
    [("eccentric-drive", "travel", 0.40645), ("thread-take-up", "feed", 4.1743)],
)
def test_play_is_half_of_the_lash_that_the_judge_finds_in_the_files(
    spec: str, output: str, lash: float
) -> None:
    made = pipeline.read_mechanism(SPECS / f"{spec}.toml")
    play = made.solve(np.linspace(0, 2 * np.pi, 3601), 0).play(output)
    assert 2 * play.total.max() == pytest.approx(lash, rel=2e-5)
    np.testing.assert_allclose(play.total, sum(play.by_joint.values()), rtol=1e-12)


QUESTIONS = {"model", "solve", "motion", "assembly", "limits", "forecast", "study", "prepare"}
QUESTIONS |= {"resolved", "remarks", "recovered", "scene", "free_play"}
OTHERS = {
    "replace",
    "settled_tables",
    "limits_of",
    "toml",
    "weighed",
    "no_use",
    "unused_faults",
    "hardened",
    "filled",
}  # what gives another machine, some of its limits, its spec, a model with its masses, keys of no use to it, whether it has a case,
# its tables with what one decides in another


def test_a_mechanism_answers_a_dozen_questions() -> None:
    """These, and `faults` of any spec; all else that is known of a machine is data of its assembly."""
    own = {name for name in vars(Mechanism) if not name.startswith(("_", "model_"))}
    assert own - {"fixed"} - set(Mechanism.model_fields) == QUESTIONS | OTHERS
