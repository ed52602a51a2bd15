"""Both senses of turning: what a builder sees on the machine, told by other routes than the engine's."""

from __future__ import annotations

import math
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from camgen.errors import SpecError
from camgen.files.dxf import read_dxf
from camgen.geometry.facets import facet_contour
from camgen.machine.closed_form import slider_travel
from camgen.machines import MECHANISMS
from camgen.machines.sources import read_mechanism
from camgen.motion.program import Program, uniform_swing
from camgen.pipeline.build import build
from camgen.pipeline.shown import animation

SPECS = Path(__file__).resolve().parents[2] / "specs"
TURN = np.linspace(0, math.tau, 721)


@cache
def machine(name: str, *settings: str) -> Any:
    return read_mechanism(SPECS / f"{name}.toml", settings)


def built(tmp_path: Path, name: str, *settings: str) -> tuple[Any, Path]:
    return build(SPECS / f"{name}.toml", tmp_path, frozenset({"dxf"}), settings), tmp_path / name


FIGURES = (
    "peak_speed_mm_s",
    "peak_torque_n_m",
    "follower_torque_peak_with_n_m",
    "kinetic_energy_j",
    "shaft_torque_peak_with_n_m",
    "needle_peak_speed_mm_s",
    "mass_g",
    "reaction_a_n",
    "wear_a_n_rad_s",
)
OFFSET = "geometry.follower={motion='translating', shape='roller', radius=5, offset=6}"
MIRRORED = "geometry.follower={motion='translating', shape='roller', radius=5, offset=-6}"


@pytest.mark.long
def test_clockwise_cam_is_the_mirror_image_of_the_mirrored_machine(tmp_path: Path) -> None:
    """Mirrored in Oy a machine turns the other way, its slide on the other side: both files, point by point."""
    settings = ("limits.least_radius=0", "limits.pressure_angle_deg=60")
    _, one = built(tmp_path / "a", "disc-cam", OFFSET, "motor.speed_rpm=-60", *settings)
    _, other = built(tmp_path / "b", "disc-cam", MIRRORED, "motor.speed_rpm=60", *settings)
    _, same = built(tmp_path / "c", "disc-cam", OFFSET, "motor.speed_rpm=60", *settings)
    here, there, apart = (
        max(read_dxf(folder / "disc-cam-cam.dxf").cut, key=lambda ring: abs(ring.area)).facetted(
            1e-3
        )
        for folder in (one, other, same)
    )

    def far(a: np.ndarray, b: np.ndarray) -> float:
        steps = np.linspace(0, 1, 20, endpoint=False)[:, None]
        edges = (b + steps * (np.roll(b, -1) - b)).ravel()
        return float(np.max(np.min(np.abs(a[:, None] - edges), axis=1)))

    assert far(here, -np.conj(there)) < 0.06 < 0.5 < far(here, apart)


def test_follower_rises_as_the_clockwise_cam_turns(tmp_path: Path) -> None:
    """The cam in the file, turned clockwise by hand: where its edge stands under a knife on the line of the slide."""
    knife = "geometry.follower={motion='translating', shape='knife'}"
    report, folder = built(
        tmp_path,
        "disc-cam",
        knife,
        "motor.speed_rpm=-60",
        "limits.pressure_angle_deg=60",
        "limits.least_radius=0",
    )
    assert report.ok
    ring = max(read_dxf(folder / "disc-cam-cam.dxf").cut, key=lambda each: abs(each.area)).facetted(
        1e-4
    )
    angle = np.unwrap(np.angle(np.append(ring, ring[0])))
    order = np.argsort(angle)
    turned = np.radians(
        [0.0, 20, 50, 100, 130, 160, 220, 280, 320]
    )  # clockwise, from the drawn position
    heights = (
        np.interp(
            math.pi / 2 + turned,
            angle[order],
            np.abs(np.append(ring, ring[0]))[order],
            period=math.tau,
        )
        - 25
    )
    assert heights[[0, 7, 8]] == pytest.approx(0, abs=2e-3) and heights[[3, 4, 5]] == pytest.approx(
        12, abs=2e-3
    )
    assert 0 < heights[1] < heights[2] < 12 and heights[6] == pytest.approx(
        6, abs=2e-3
    )  # half way down the cycloid


@pytest.mark.parametrize("name", ["disc-cam", "indexing-cam"])
@pytest.mark.parametrize("order", range(4))
def test_program_runs_in_the_sense_of_turning(name: str, order: int) -> None:
    there, back = (
        machine(name),
        machine(name, f"motor.speed_rpm=-{30 if name == 'indexing-cam' else 60}"),
    )
    theta = TURN + 1e-4  # beside the joints
    wanted = (-1) ** order * there.motion(theta, order)
    assert back.motion(-theta, order) == pytest.approx(
        wanted, abs=1e-9 * max(1, np.max(np.abs(wanted)))
    )
    assert back.model.speed == -there.model.speed < 0 and back.assembly.cycle.sense == -1


def test_programs_backwards_keep_breaks_jumps_and_their_beginning() -> None:
    assert len(machine("disc-cam").program.discontinuities(3)) > 3
    for made in (
        machine("disc-cam").program,
        uniform_swing(0.5, 0.2),
        machine("indexing-cam").program,
    ):
        back: Program = made.backwards()
        theta = TURN + 1e-4
        assert back(-theta) == pytest.approx(made(theta), abs=1e-12)

        def jumps(program: Program, sense: int) -> list[tuple[int, float, float]]:
            # a derivative of odd order keeps the sign of its step when both its sign and its sides change
            found = [
                (j.order, round(sense * j.theta, 6) % 6.283185, sense ** (j.order + 1) * j.size)
                for j in program.discontinuities(3)
            ]
            return sorted(found)

        mirrored = jumps(back, -1)
        assert np.array(mirrored) == pytest.approx(np.array(jumps(made, 1)), rel=1e-6, abs=2e-6)


@pytest.mark.long
@pytest.mark.parametrize(
    "name, speed, settings",
    [
        ("disc-cam", 60, ("geometry.closure='conjugate'",)),
        ("indexing-cam", 30, ()),
        (
            "thread-take-up",
            5000,
            ("load.friction=0",),
        ),  # its ring rubs so much that one way loads the pins more
        ("chain-stitch-looper", 3000, ()),
        ("uniform-swing", 30, ("parts.make='cams'", "parts.bore=8")),
    ],
)
def test_each_machine_holds_both_ways(
    tmp_path: Path, name: str, speed: float, settings: tuple[str, ...]
) -> None:
    there, _ = built(tmp_path / "a", name, f"motor.speed_rpm={speed}", *settings)
    back, _ = built(tmp_path / "b", name, f"motor.speed_rpm={-speed}", *settings)
    assert [f.code for f in back.findings] == [f.code for f in there.findings]
    assert [f.ok for f in back.findings] == [f.ok for f in there.findings]
    for figure in FIGURES:
        if figure in there.numbers:
            assert (
                back.numbers[figure] == pytest.approx(there.numbers[figure], rel=1e-5)
                and back.numbers[figure] > 0
            )
    assert any("clockwise" in note for note in back.notes) is (name != "chain-stitch-looper")


def test_time_runs_backwards_in_a_clockwise_linkage() -> None:
    """Slider-crank in time: place by trigonometry at the crank's true angle, speed by differences of it."""
    back = machine("eccentric-drive", "motor.speed_rpm=-13000")
    w, t, h = back.model.speed, np.linspace(0, 4e-3, 50), 1e-9
    assert back.motion(w * t) == pytest.approx(slider_travel(w * t, 1.5, 48.0, 0.0), abs=1e-12)
    e, rod = 1.5, 48.0

    def place(t: np.ndarray) -> np.ndarray:
        return e * np.cos(w * t) + np.sqrt(rod**2 - (e * np.sin(w * t)) ** 2)

    speeds = -(place(t + h) - place(t - h)) / (2 * h)
    assert w * back.motion(w * t, 1) == pytest.approx(speeds, abs=1e-3 * np.max(np.abs(speeds)))


@pytest.mark.long
def test_thread_is_let_down_where_it_was_pulled_up() -> None:
    there, back = (
        machine("thread-take-up", f"motor.speed_rpm={rpm}").study().numbers for rpm in (5000, -5000)
    )
    assert back["let_down_deg"] == pytest.approx(360 - there["let_down_deg"])
    assert back["let_down_ratio"] == pytest.approx(1 / there["let_down_ratio"])
    assert back["feed_range_mm"] == there["feed_range_mm"]


def test_arrow_torque_and_picture_turn_with_the_shaft() -> None:
    settings = (
        "parts.make='cams'",
        "parts.bore=8",
        "nozzle.inertia_kg_m2=0.001",
        "geometry.reversal_blend_deg=30",
    )
    there, back = (
        machine("uniform-swing", f"motor.speed_rpm={rpm}", *settings) for rpm in (300, -300)
    )

    def head(m: Any) -> complex:
        (arrow,) = m.assembly.parts[0].engraved
        corners = facet_contour(arrow.region.outer, 1e-3)
        seen = (corners - corners.mean()) / corners.mean()  # from its own place, outwards is real
        return complex(seen[np.argmin(np.abs(seen.real))])

    assert (
        head(there).imag > 0 > head(back).imag
    )  # forward is to the left of the spoke, or to the right

    def torque(m: Any) -> np.ndarray:
        return np.asarray(
            next(plot for plot in m.study().plots if plot.title.startswith("Torque")).series[0][2]
        )

    smooth = machine("uniform-swing", "motor.speed_rpm=300", "nozzle.friction=0", *settings)
    slick = machine("uniform-swing", "motor.speed_rpm=-300", "nozzle.friction=0", *settings)
    assert torque(slick) == pytest.approx(
        torque(smooth)
    )  # inertia does not know the sense of turning
    for m in (there, back):  # friction takes power at every angle
        taken = m.model.speed * (torque(m) - torque(smooth))
        assert np.all(taken > -1e-9) and np.mean(taken) > 0.01 * abs(m.model.speed) * np.max(
            np.abs(torque(smooth))
        )
    angles = animation(back).theta
    assert angles[0] == 0 and angles[1] > angles[2] > angles[3]


def test_a_shaft_that_stands_still_is_refused() -> None:
    for name in (name for name in MECHANISMS if name != "coupon"):  # in which nothing turns
        key = {"linkage": "drive.speed_rpm", "linear-cam": "drive.speed"}.get(
            name, "motor.speed_rpm"
        )
        for speed in ("0", "-0.0"):
            with pytest.raises(SpecError, match=key):
                machine(name, f"{key}={speed}")
