"""Figures of disc cams: a four-segment cam from spec to checked DXF, sizing, and how many designs are judged in a second.

Run from the checkout: python tests/bench/bench_disc_cam.py
"""

from __future__ import annotations

import math
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np

from camgen.machine.cams.followers import Follower, SlidingFace, SlidingTip, SwingingArm
from camgen.machine.cams.profile import DiscCam
from camgen.machine.cams.sizing import smallest, survey
from camgen.motion.laws import LAWS, UNIFORM
from camgen.motion.program import Program, Segment
from camgen.pipeline import build as pipeline

SPEC = Path(__file__).parent.parent.parent / "specs" / "disc-cam.toml"
NAMES = ("cycloidal", "modified-sine", "3-4-5", "modified-trapezoid", "4-5-6-7", "simple-harmonic")


def median(work: Callable[[], object], rounds: int = 7) -> float:
    """Median time of some rounds, s."""
    times = []
    for _ in range(rounds):
        begin = time.perf_counter()
        work()
        times.append(time.perf_counter() - begin)
    return statistics.median(times)


def designs(count: int) -> list[DiscCam[Follower]]:
    """Cams of four segments, all different in law, lift, spans, base and follower."""
    rng = np.random.default_rng(5)
    found: list[DiscCam[Follower]] = []
    for k in range(count):
        spans = rng.uniform(0.6, 1.6, 4)
        spans *= math.tau / spans.sum()
        lift, base = rng.uniform(3, 15), rng.uniform(20, 45)
        up, down = (LAWS[NAMES[int(rng.integers(len(NAMES)))]] for _ in range(2))
        kind = k % 3
        if kind == 2:
            lift = math.radians(lift)
        program = Program(
            (
                Segment("rise", float(spans[0]), 0.0, lift, up),
                Segment("dwell", float(spans[1]), lift, 0.0, UNIFORM),
                Segment("return", float(spans[2]), lift, -lift, down),
                Segment("dwell", float(spans[3]), 0.0, 0.0, UNIFORM),
            )
        )
        arm = SwingingArm(70 + 0j, -65 - 1j * base, 5.0, 1)
        followers = (SlidingTip(1j * (base + 5), 1j, 5.0), SlidingFace(1j * base, 1j), arm)
        found.append(DiscCam(program, followers[kind]))
    return found


def main() -> None:
    """Print the figures."""
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder)
        pipeline.build(SPEC, out, frozenset({"dxf"}))
        inside = median(lambda: pipeline.build(SPEC, out, frozenset({"dxf"})))
        command = [
            sys.executable,
            "-m",
            "camgen",
            "build",
            str(SPEC),
            "-o",
            str(out),
            "--only",
            "dxf",
        ]
        whole = median(lambda: subprocess.run(command, stdout=subprocess.DEVNULL, check=True))
        print(
            f"four-segment cam, profile, checks and DXF: {whole:.2f} s as a process, {inside:.2f} s once loaded (limit 0.8 s)"
        )
        everything = median(lambda: pipeline.build(SPEC, out, frozenset(pipeline.KINDS)), 3)
        print(f"all files and the report: {everything:.2f} s once loaded")
    quarter = math.pi / 2
    law = LAWS["cycloidal"]
    program = Program(
        (
            Segment("dwell", quarter, 0.0, 0.0, UNIFORM),
            Segment("rise", quarter, 0.0, 1.0, law),
            Segment("dwell", quarter, 1.0, 0.0, UNIFORM),
            Segment("return", quarter, 1.0, -1.0, law),
        )
    )
    sized = median(
        lambda: smallest(
            lambda d: DiscCam(program, SlidingTip(1j * d, 1j, 0.5)), math.pi / 6, 0.0, 0.6, 100.0
        ),
        3,
    )
    print(f"base radius from a pressure angle, to rounding: {sized:.2f} s")
    cams = designs(1000)
    begin = time.perf_counter()
    found = [survey(cam) for cam in cams]
    took = time.perf_counter() - begin
    worst = max(
        abs(each.pressure - cam.greatest(cam.pressure_angle_untrimmed)[1])
        for each, cam in zip(found[::50], cams[::50], strict=True)
    )
    print(
        f"designs judged (profile, curvature, pressure angle): {1000 / took:.0f} a second (goal 1,000); "
        f"pressure angle off by at most {math.degrees(worst):.1e} deg"
    )


if __name__ == "__main__":
    main()
