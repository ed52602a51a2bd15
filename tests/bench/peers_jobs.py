"""The peers' side of peers.py, run by the interpreter that has them; imports nothing of camgen.

Reads requests, one JSON object a line: {"job", ...arguments} makes a job and answers with what it is (versions, an answer to
compare, or {"missing"}); {"time": n} runs the job last made n times and answers with the wall time of the last, s.
`python peers_jobs.py --cam VERTICES.npy STL` is a whole process that writes one STL.
"""

from __future__ import annotations

import json
import math
import os
import sys
import time
from collections.abc import Callable
from importlib.metadata import version
from typing import Any


def four_bar(
    count: int, frame: float, crank: float, coupler: float, output: float
) -> tuple[Callable[[], Any], Any]:
    """Pylinkage, compiled: positions at `count` steps of one turn."""
    import numba  # noqa: F401  without it nothing is compiled
    from pylinkage.actuators import Crank
    from pylinkage.components import Ground
    from pylinkage.dyads import RRRDyad
    from pylinkage.simulation import Linkage

    def fresh() -> Any:
        o, c = Ground(0, 0, name="O"), Ground(frame, 0, name="C")
        a = Crank(anchor=o, radius=crank, angular_velocity=2 * math.pi / count, name="A")
        b = RRRDyad(anchor1=a.output, anchor2=c, distance1=coupler, distance2=output, name="B")
        linkage = Linkage([o, c, a, b])
        linkage.compile()
        return linkage

    linkage = fresh()
    # step k is the angle (k + 1) 2 pi / count; the last column pairs are A and B
    return lambda: linkage.step_fast(count, 1), fresh().step_fast(count, 1)[
        :: max(1, count // 360), 2:
    ].tolist()


def roller(base: float, radius: float, lift: float) -> tuple[Callable[[], Any], Any]:
    """`mechanism`'s roller follower on a cam of 3,600 points, 360 positions; answers with its points and places."""
    import matplotlib

    matplotlib.use("Agg")
    import numpy as np
    from mechanism import Cam
    from mechanism.cams import RollerFollower

    cam = Cam(
        [("Rise", lift, 120), ("Dwell", 60), ("Fall", lift, 120), ("Dwell", 60)],
        degrees=True,
        h=2 * np.pi / 3600,
    )
    size, motion = cam.thetas.size, cam.cycloidal

    def work() -> Any:
        with np.errstate(invalid="ignore"):
            return RollerFollower(motion, base, cam.thetas_r, size // 360, radius)

    found = work()
    x, y = found.cam_x, found.cam_y
    return work, {
        "x": list(x[0]),
        "y": list(y[0]),
        "turned": [[u[7], v[7]] for u, v in zip(x, y, strict=True)],
        "centres": list(found.roller_centers),
    }


def noncircular(law: str, folder: str) -> tuple[Callable[[], Any], Any]:
    """`ncgears`' wheels of 24 teeth and module 1.5 for a law psi(phi), checked by itself; answers with what it states of them."""
    import ncgears

    def work() -> Any:
        return ncgears.generate_from_transmission(
            law, teeth=24, module=1.5, clearance=0.04, output_directory=folder
        )

    stated = work().metadata
    keys = ("center_distance", "minimum_backlash_deg", "maximum_backlash_deg")
    return work, {key: stated[key] for key in keys}


def build123d_stl(vertices: str, path: str) -> tuple[Callable[[], Any], Any]:
    """The straight outline through the vertices, extruded by 6 mm and written as STL."""
    import build123d
    import numpy as np

    points = [tuple(row) for row in np.load(vertices).tolist()]

    def work() -> None:
        wire = build123d.Wire.make_polygon(points, close=True)
        solid = build123d.extrude(build123d.Face(wire), amount=6.0, dir=(0, 0, 1))
        build123d.export_stl(solid, path, tolerance=1e-3)

    return work, None


JOBS: dict[str, tuple[Callable[..., tuple[Callable[[], Any], Any]], str]] = {
    "four_bar": (four_bar, "pylinkage"),
    "roller": (roller, "mechanism"),
    "build123d_stl": (build123d_stl, "build123d"),
    "noncircular": (noncircular, "ncgears"),
}


def serve() -> None:
    """Answer requests until the input ends."""
    answers = os.fdopen(os.dup(1), "w", buffering=1)
    os.dup2(2, 1)  # whatever a peer prints is no answer
    job: Callable[[], Any] = lambda: None  # noqa: E731
    for line in sys.stdin:
        request = json.loads(line)
        if "time" in request:
            for _ in range(request["time"]):
                begin = time.perf_counter()
                job()
            print(json.dumps(time.perf_counter() - begin), file=answers)
            continue
        make, package = JOBS[request.pop("job")]
        try:
            job, answer = make(**request)
        except ImportError as error:
            print(json.dumps({"missing": f"{package} ({error})"}), file=answers)
        else:
            print(
                json.dumps({"version": f"{package} {version(package)}", "answer": answer}),
                file=answers,
            )


if __name__ == "__main__":
    if sys.argv[1:2] == ["--cam"]:
        build123d_stl(*sys.argv[2:])[0]()
    else:
        serve()
