"""One turn of a four-bar: positions and two derivatives here, against pylinkage's compiled modes; best of several, alternated.

    python tests/bench/bench_linkages.py [PYTHON]

PYTHON: an interpreter that has pylinkage and numba, where they are in an environment of their own. Without one the
comparison is named and left out. The threads used are camgen's own choice (two from 100,000 angles on).
"""

from __future__ import annotations

import importlib.util
import json
import math
import subprocess
import sys
import time
from collections.abc import Callable
from typing import Any

COUNTS, ROUNDS = (360, 3_600, 36_000, 1_000_000), 9
WANTED = {3_600: 2, 36_000: 5, 1_000_000: 10}
FRAME, CRANK, COUPLER, OUTPUT = 9.0, 30.0, 30.0, 19.0


def peer_jobs(count: int) -> tuple[dict[str, Callable[[], Any]], Callable[[], Any]]:
    """Pylinkage's timed calls, and one that gives the first angle and all places of the joint B for comparison."""
    from pylinkage.actuators import Crank
    from pylinkage.components import Ground
    from pylinkage.dyads import RRRDyad
    from pylinkage.simulation import Linkage

    def fresh() -> Any:
        o, c = Ground(0, 0, name="O"), Ground(FRAME, 0, name="C")
        a = Crank(anchor=o, radius=CRANK, angular_velocity=2 * math.pi / count, name="A")
        b = RRRDyad(anchor1=a.output, anchor2=c, distance1=COUPLER, distance2=OUTPUT, name="B")
        linkage = Linkage([o, c, a, b])
        linkage.compile()
        return linkage

    linkage = fresh()
    jobs = {
        "pylinkage step_fast, positions": lambda: linkage.step_fast(count, 1),
        "pylinkage step_fast_with_kinematics": lambda: linkage.step_fast_with_kinematics(count, 1),
    }
    return jobs, lambda: fresh().step_fast(count, 1)


def serve() -> None:
    """Answer on standard input's requests: the peer runs in its own interpreter, its calls timed there."""
    for line in sys.stdin:
        count = int(line)
        jobs, places = peer_jobs(count)
        way = places()[:: max(1, count // 360), 2:]
        for job in jobs.values():
            job()
        print(json.dumps(way.tolist()), flush=True)
        for _ in range(ROUNDS):
            sys.stdin.readline()
            print(json.dumps({name: clocked(job) for name, job in jobs.items()}), flush=True)


def clocked(job: Callable[[], Any]) -> float:
    """Milliseconds of one call, right after another that warms the caches the other side has left cold."""
    job()
    start = time.perf_counter()
    job()
    return (time.perf_counter() - start) * 1e3


def main(interpreter: str | None) -> None:
    """Print the table."""
    import numpy as np

    from camgen.machines.thread_take_up.feed import TakeUp

    if interpreter is None and importlib.util.find_spec("pylinkage") and importlib.util.find_spec("numba"):
        interpreter = sys.executable
    peer = None
    if interpreter is None:
        print("pylinkage or numba is not installed: compared with nothing")
    else:
        peer = subprocess.Popen([interpreter, __file__, "--serve"], stdin=-1, stdout=-1, text=True)
    four_bar = TakeUp(CRANK, COUPLER, OUTPUT, FRAME, 1.0, 0.0, -1, (0j, 0j))

    def joints(theta: Any, order: int) -> tuple[Any, Any]:
        run = four_bar.run(theta, order)
        return run.point("crank", "A"), run.point("coupler", "B")

    for count in COUNTS:
        theta = np.arange(1, count + 1) * (2 * math.pi / count)
        ours = {
            "camgen, positions": lambda theta=theta: joints(theta, 0),
            "camgen, positions and two derivatives": lambda theta=theta: joints(theta, 2),
        }
        for job in ours.values():
            job()
        times: dict[str, list[float]] = {}

        def ask(line: object) -> Any:
            assert peer and peer.stdin and peer.stdout
            peer.stdin.write(f"{line}\n")
            peer.stdin.flush()
            return json.loads(peer.stdout.readline())

        if peer:
            theirs = np.array(ask(count)) @ [1, 1j]
            a, b = joints(theta[:: max(1, count // 360)], 0)
            # Its crank is stepped by adding, which drifts; its coarse answers carry that.
            apart = np.abs(theirs.T - [a[0], b[0]]).max()
            print(f"{count:,} angles; greatest difference {apart:.1e} mm")
        else:
            print(f"{count:,} angles")
        for _ in range(ROUNDS):
            for name, job in ours.items():
                times.setdefault(name, []).append(clocked(job))
            for name, spent in (ask("go") if peer else {}).items():
                times.setdefault(name, []).append(spent)
        base = min(times["camgen, positions and two derivatives"])
        for name, spent in times.items():
            print(f"  {name:51} {min(spent):9.3f} ms   {min(spent) / base:6.2f} of positions and two derivatives")
        if peer:
            theirs_ms = min(times["pylinkage step_fast, positions"])
            reached = theirs_ms / base
            wanted = f", {WANTED[count]:g} wanted" if count in WANTED else ""
            print(f"  {reached:.1f} times as fast as pylinkage's positions{wanted}")
    if peer and peer.stdin:
        peer.stdin.close()
        peer.wait()


if __name__ == "__main__":
    if sys.argv[1:] == ["--serve"]:
        serve()
    else:
        main(sys.argv[1] if sys.argv[1:] else None)
