"""What the kernel of machines costs a turn: positions and two derivatives, against goals and against pylinkage's compiled modes.

    python tests/bench/bench_linkages.py [PYTHON]

PYTHON: an interpreter that has pylinkage and numba, where they are in an environment of their own. Without one the
comparison is named and left out. Times are the best of several, alternated. The six-bar is a four-bar and a dyad on its
joint B. Block by block a million angles are held against bare numpy lines (bare.py), both in processor time.
"""

from __future__ import annotations

import importlib.util
import json
import math
import subprocess
import sys
import time
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

COUNTS, ROUNDS = (360, 3_600, 36_000, 1_000_000), 9
# How many times as fast as pylinkage's positions, by machine and number of angles.
WANTED = {
    ("four-bar", 3_600): 2,
    ("four-bar", 36_000): 5,
    ("four-bar", 1_000_000): 10,
    ("six-bar", 36_000): 3,
}
FRAME = 9.0
CRANK = 30.0
COUPLER = 30.0
OUTPUT = 19.0
# of the six-bar's second dyad: its place beside O, its two links
PIVOT = 60.0
ROD = 55.0
ROCKER = 30.0
# ms for 3,600 angles: chains of tests/machine/chains.py, those behind the first without dyads or with larger blocks.
GOALS = {
    "jansen": 0.5,
    "klann": 0.5,
    "watt_two": 0.5,
    "double_butterfly": 30.0,
    "stephenson_three": 30.0,
}


def peer_jobs(machine: str, count: int) -> tuple[dict[str, Callable[[], Any]], Callable[[], Any]]:
    """Pylinkage's timed calls, and one that gives all places of the joints for comparison."""
    from pylinkage.actuators import Crank
    from pylinkage.components import Ground
    from pylinkage.dyads import RRRDyad
    from pylinkage.simulation import Linkage

    def fresh() -> Any:
        o, c = Ground(0, 0, name="O"), Ground(FRAME, 0, name="C")
        a = Crank(anchor=o, radius=CRANK, angular_velocity=2 * math.pi / count, name="A")
        b = RRRDyad(anchor1=a.output, anchor2=c, distance1=COUPLER, distance2=OUTPUT, name="B")
        parts = [o, c, a, b]
        if machine == "six-bar":
            g = Ground(PIVOT, 0, name="G")
            parts = [
                o,
                c,
                g,
                a,
                b,
                RRRDyad(anchor1=b, anchor2=g, distance1=ROD, distance2=ROCKER, name="E"),
            ]
        linkage = Linkage(parts)
        linkage.compile()
        return linkage

    linkage = fresh()
    jobs = {"pylinkage step_fast, positions": lambda: linkage.step_fast(count, 1)}
    if machine == "four-bar":
        jobs["pylinkage step_fast_with_kinematics"] = lambda: linkage.step_fast_with_kinematics(
            count, 1
        )
    return jobs, lambda: fresh().step_fast(count, 1)[:, 2 if machine == "four-bar" else 3 :]


def serve() -> None:
    """Answer on standard input's requests: the peer runs in its own interpreter, its calls timed there."""
    for line in sys.stdin:
        machine, count = json.loads(line)
        jobs, places = peer_jobs(machine, count)
        way = places()[:: max(1, count // 360)]
        for job in jobs.values():
            job()
        print(json.dumps(way.tolist()), flush=True)
        for _ in range(ROUNDS):
            sys.stdin.readline()
            print(json.dumps({name: clocked(job) for name, job in jobs.items()}), flush=True)


def clocked(job: Callable[[], Any], clock: Callable[[], float] = time.perf_counter) -> float:
    """Milliseconds of one call, right after another that warms the caches the other side has left cold."""
    job()
    start = clock()
    job()
    return (clock() - start) * 1e3


def machine_of(machine: str) -> tuple[Any, list[tuple[str, float]]]:
    """Ours, and the places that are asked for."""
    import cmath

    from camgen.machine.model import Body, Drive, Machine, Pin, Place, Pose

    a = CRANK + 0j
    b = _meet(a, COUPLER, FRAME, OUTPUT, -1)
    places = {"crank": (0j, a), "coupler": (a, b), "rocker": (FRAME + 0j, b)}
    pins = [
        Pin("O", Place("ground"), Place("crank")),
        Pin("A", Place("crank", CRANK), Place("coupler")),
        Pin("C", Place("ground", FRAME), Place("rocker")),
        Pin("B", Place("coupler", COUPLER), Place("rocker", OUTPUT)),
    ]
    asked = [("crank", CRANK), ("coupler", COUPLER)]
    if machine == "six-bar":
        e = _meet(b, ROD, PIVOT, ROCKER, 1)
        places |= {"rod": (b, e), "lever": (PIVOT + 0j, e)}
        pins += [
            Pin("B of rod", Place("coupler", COUPLER), Place("rod")),
            Pin("G", Place("ground", PIVOT), Place("lever")),
            Pin("E", Place("rod", ROD), Place("lever", ROCKER)),
        ]
        asked.append(("rod", ROD))
    start: Mapping[str, Pose] = {
        name: Pose(z, cmath.phase(w - z)) for name, (z, w) in places.items()
    }
    return Machine(
        tuple(Body(name) for name in places), tuple(pins), (Drive("drive", "crank"),), start
    ), asked


def joints_of(machine: str) -> Callable[[Any, int], list[Any]]:
    """Ours: the jets of the joints at theta, (n,), up to an order."""
    from camgen.machine.run import solve

    made, asked = machine_of(machine)

    def joints(theta: Any, order: int) -> list[Any]:
        run = solve(made, theta, order)
        return [run.point(body, complex(at)) for body, at in asked]

    return joints


def _meet(a: complex, r: float, c: float, s: float, side: int) -> complex:
    """Where circles about a (radius r) and about c (s) meet: left (side 1) or right (-1) of the way from a to c."""
    way = c - a
    along = (r**2 - s**2 + abs(way) ** 2) / (2 * abs(way))
    return a + way / abs(way) * (along + side * 1j * math.sqrt(r**2 - along**2))


class Peer:
    """The other program in a process of its own."""

    def __init__(self, interpreter: str) -> None:
        command = [interpreter, __file__, "--serve"]
        self.process = subprocess.Popen(command, stdin=-1, stdout=-1, text=True)

    def ask(self, line: object) -> Any:
        """Its answer to a line."""
        assert self.process.stdin
        assert self.process.stdout
        self.process.stdin.write(f"{json.dumps(line)}\n")
        self.process.stdin.flush()
        return json.loads(self.process.stdout.readline())

    def close(self) -> None:
        """End it."""
        assert self.process.stdin
        self.process.stdin.close()
        self.process.wait()


def main(interpreter: str | None) -> None:
    """Print the tables."""
    if interpreter is None and all(map(importlib.util.find_spec, ("pylinkage", "numba"))):
        interpreter = sys.executable
    peer = None
    if interpreter is None:
        print("pylinkage or numba is not installed: compared with nothing")
    else:
        peer = Peer(interpreter)
    for count in COUNTS:
        compare("four-bar", count, peer)
    for count in (3_600, 36_000):
        compare("six-bar", count, peer)
    if peer:
        peer.close()


def compare(machine: str, count: int, peer: Peer | None) -> None:
    """Print the times of one machine at so many angles."""
    import numpy as np

    joints = joints_of(machine)
    theta = np.arange(1, count + 1) * (2 * math.pi / count)
    ours = {
        "camgen, positions": lambda: joints(theta, 0),
        "camgen, positions and two derivatives": lambda: joints(theta, 2),
    }
    for job in ours.values():
        job()
    times: dict[str, list[float]] = {}
    print(f"{machine}, {count:,} angles", end="")
    if peer:
        theirs = np.array(peer.ask([machine, count])) @ [1, 1j]
        here = joints(theta[:: max(1, count // 360)], 0)
        # Its crank is stepped by adding, which drifts; its coarse answers carry that.
        off = np.abs(theirs.T - [each[0] for each in here]).max()
        print(f"; greatest difference {off:.1e} mm", end="")
    print()
    for _ in range(ROUNDS):
        for name, job in ours.items():
            times.setdefault(name, []).append(clocked(job))
        for name, spent in (peer.ask("go") if peer else {}).items():
            times.setdefault(name, []).append(spent)
    base = min(times["camgen, positions and two derivatives"])
    for name, spent in times.items():
        print(
            f"  {name:51} {min(spent):9.3f} ms   {min(spent) / base:6.2f} of positions and two derivatives"
        )
    if peer:
        theirs_ms = min(times["pylinkage step_fast, positions"])
        wanted = f", {WANTED[machine, count]:g} wanted" if (machine, count) in WANTED else ""
        alike = min(times["camgen, positions"])
        print(
            f"  {theirs_ms / base:.1f} times as fast as its positions{wanted}; by positions alone {theirs_ms / alike:.1f}"
        )


def print_blocks() -> None:
    """A million angles of the four-bar block by block, and as bare numpy lines in blocks of the best size."""
    import bare
    import numpy as np

    from camgen.machine.run import BLOCK, solve

    count = COUNTS[-1]
    machine, asked = machine_of("four-bar")
    theta = np.arange(1, count + 1) * (2 * math.pi / count)

    def ours(order: int) -> None:
        for first in range(0, count, BLOCK):
            run = solve(machine, theta[first : first + BLOCK], order)
            for body, at in asked:
                run.point(body, complex(at))

    def least(size: int, order: int) -> Callable[[], None]:
        work = bare.four_bar(FRAME, CRANK, COUPLER, OUTPUT, size, order)

        def lines() -> None:
            for first in range(0, count, size):
                work(theta[first : first + size])

        return lines

    for order, what in ((0, "positions"), (2, "positions and two derivatives")):
        jobs = {
            f"bare lines, {size:,} at a time": least(size, order) for size in (4_000, 8_000, 20_000)
        }
        jobs["camgen block by block"] = lambda order=order: ours(order)  # type: ignore[misc]
        spent: dict[str, list[float]] = {}
        for _ in range(2 * ROUNDS):
            for name, job in jobs.items():
                spent.setdefault(name, []).append(clocked(job, time.process_time))
        print(
            f"four-bar, {count:,} angles, {what}: "
            + ", ".join(f"{name} {min(each):.1f} ms" for name, each in spent.items())
        )


def print_chains() -> None:
    """Chains of the kernel's tests, 3,600 angles with two derivatives, against their goals."""
    import numpy as np

    from camgen.machine.run import solve

    sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "machine"))
    import chains

    theta = np.arange(1, 3_601) * (2 * math.pi / 3_600)
    for name, goal in GOALS.items():
        machine = getattr(chains, name)()

        def job(machine: Any = machine) -> None:
            run = solve(machine, theta, 2)
            for output in machine.outputs:
                run.derivatives(output.name)
            for body in machine.moving:
                run.angle(body.name)

        job()
        spent = min(clocked(job) for _ in range(ROUNDS))
        print(
            f"{name:20} {spent:8.3f} ms for 3,600 angles, goal {goal:g}: {'met' if spent <= goal else 'NOT met'}"
        )


if __name__ == "__main__":
    if sys.argv[1:] == ["--serve"]:
        serve()
    else:
        main(sys.argv[1] if sys.argv[1:] else None)
