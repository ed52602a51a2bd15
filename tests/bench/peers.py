"""Against what a user would pick instead: prints the whole table in one run, commands alternated, medians.

    python tests/bench/peers.py [--python PEERS] [--rounds 7] [--results]

PEERS: an interpreter that has the peers, which stay out of camgen's own environment:

    python3 -m venv peers && peers/bin/pip install build123d mechanism ncgears numba pylinkage

(never cadquery beside build123d); shapely and trimesh are camgen's own or its tests'. A peer that is missing is named and its
row has no ratio; one that takes longer than a minute is timed once. --results puts the table into RESULTS.md. A whole run takes
some minutes, most of them for the outline of 10,000 vertices in build123d.
"""

from __future__ import annotations

import argparse
import datetime
import json
import math
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial
from importlib.metadata import version
from itertools import product
from pathlib import Path
from statistics import median
from typing import Any

HERE = Path(__file__).resolve().parent
ROOT = HERE.parent.parent
sys.path[:0] = [str(HERE), str(HERE.parent / "geometry"), str(ROOT)]
PATIENCE = 60.0  # s
BEGIN = "<!-- peers: python tests/bench/peers.py --results -->"
END = "<!-- end of peers -->"


@dataclass(frozen=True)
class Row:
    """A line of the table; `met` is None where there was nothing to compare with."""

    work: str
    peer: str
    goal: str
    ours: str
    theirs: str
    ratio: str
    met: bool | None


class Peers:
    """The peers' interpreter as a server, see peers_jobs.py."""

    def __init__(self, python: str | None) -> None:
        self.python = python or sys.executable
        self.process = subprocess.Popen(
            [self.python, str(HERE / "peers_jobs.py")], stdin=-1, stdout=-1, text=True
        )
        self.versions: set[str] = set()
        self.missing: set[str] = set()

    def ask(self, **request: Any) -> Any:
        """The answer to a request."""
        assert self.process.stdin and self.process.stdout
        self.process.stdin.write(json.dumps(request) + "\n")
        self.process.stdin.flush()
        return json.loads(self.process.stdout.readline())

    def job(self, name: str, **arguments: Any) -> Any:
        """Make a job; its answer to compare, or None where the peer is missing."""
        said = self.ask(job=name, **arguments)
        if "missing" in said:
            self.missing.add(said["missing"])
            return None
        self.versions.add(said["version"])
        return said

    def time(self, runs: int = 1) -> float:
        """Wall time of the last of some runs of the job last made, s."""
        return float(self.ask(time=runs))


def clocked(work: Callable[[], object], clock: Callable[[], float] = time.perf_counter) -> float:
    """Wall time of one call, s; with time.process_time the processor's, where no peer shares a machine's noise."""
    begin = clock()
    work()
    return clock() - begin


def again(work: Callable[[], object]) -> float:
    """Wall time of the second of two calls, s: what the other side's turn has put out of the cache has come back."""
    work()
    return clocked(work)


def alternated(
    rounds: int, ours: Callable[[], float], theirs: Callable[[], float] | None
) -> tuple[float, float]:
    """Medians of both, a round of each in turn after a warm one; nan without a peer.

    A peer whose warm round takes longer than a minute is not asked again.
    """
    ours()
    once = theirs() if theirs else math.nan
    if theirs is None or once > PATIENCE:
        return median(ours() for _ in range(rounds)), once
    found = [(ours(), theirs()) for _ in range(rounds)]
    return median(a for a, _ in found), median(b for _, b in found)


def seconds(value: float) -> str:
    """A time with a fitting unit."""
    if math.isnan(value):
        return "-"
    for unit, size in (("s", 1.0), ("ms", 1e-3)):
        if value >= size:
            return f"{value / size:.3g} {unit}"
    return f"{value / 1e-6:.3g} us"


def faster(
    work: str,
    peer: str,
    goal: float,
    ours: float,
    theirs: float,
    notes: tuple[str, str] = ("", ""),
    fine: bool = True,
) -> Row:
    """A row on time; `fine`: what the goal asks besides."""
    ratio = theirs / ours
    met = None if math.isnan(ratio) else ratio >= goal and fine
    told = "-" if met is None else f"{ratio:,.3g} times as fast"
    return Row(
        work,
        peer,
        f"{goal:,g} times as fast",
        seconds(ours) + notes[0],
        seconds(theirs) + notes[1],
        told,
        met,
    )


# ---- linkages --------------------------------------------------------------------------------------------------------


def four_bars(peers: Peers, rounds: int) -> Iterator[Row]:
    """Positions, alone or with two derivatives, here, positions there; errors against the circles' crossing in long double."""
    import numpy as np

    from camgen.machine.run import BLOCK, Run, solve
    from camgen.machines.thread_take_up.feed import TakeUp

    frame, crank, coupler, output = 9.0, 30.0, 30.0, 19.0
    four_bar = TakeUp(crank, coupler, output, frame, 1.0, 0.0, -1, (0j, 0j))

    def joints(run: Run) -> tuple[Any, Any]:
        return run.point("crank", "A"), run.point("coupler", "B")

    def block_by_block(theta: Any, order: int) -> None:
        for first in range(0, theta.size, BLOCK):
            joints(solve(four_bar.machine, theta[first : first + BLOCK], order))

    for count, goal in ((3_600, 2.0), (36_000, 5.0), (1_000_000, 10.0)):
        theta = np.arange(1, count + 1) * (2 * math.pi / count)
        every = max(1, count // 360)
        some = theta[::every]
        turn = 8 * np.arctan(np.longdouble(1))
        a = crank * np.exp(1j * np.arange(1, count + 1, every, dtype=np.longdouble) * turn / count)
        d = frame - a
        along = ((coupler - output) * np.longdouble(coupler + output) / np.abs(d) ** 2 + 1) / 2
        b = a + d * (along - 1j * np.sqrt(coupler**2 / np.abs(d) ** 2 - along**2))
        ours = joints(four_bar.run(some, 0))
        error = float(
            max(np.abs(found[0] - exact).max() for found, exact in zip(ours, (a, b), strict=True))
        )
        said = peers.job(
            "four_bar", count=count, frame=frame, crank=crank, coupler=coupler, output=output
        )
        theirs = math.nan
        if said:
            places = np.array(said["answer"]) @ [1, 1j]
            theirs = float(np.abs(places.T - [a, b]).max())
        notes = f", {error:.0e} mm off", f", {theirs:.0e} mm off" if said else ""
        ways: dict[str, Callable[[Any, int], object]] = {
            "": lambda theta, order: joints(four_bar.run(theta, order))
        }
        if count > 100_000:
            ways[" block by block"] = block_by_block
        for (how, way), (order, what) in product(
            ways.items(), ((0, "positions"), (2, "positions and two derivatives"))
        ):
            times = alternated(
                rounds,
                partial(again, partial(way, theta, order)),
                partial(peers.time, 2) if said else None,
            )
            yield faster(
                f"turn of a four-bar, {count:,} angles{how}, {what}",
                "pylinkage (positions)",
                goal,
                *times,
                notes,
                error <= theirs,
            )


# ---- contact ---------------------------------------------------------------------------------------------------------


def rollers(peers: Peers, rounds: int) -> Iterator[Row]:
    """A translating roller on a cam of 3,600 points; errors against brute force over all its edges in long double."""
    import numpy as np

    from camgen.geometry.rings import Ring
    from camgen.judge.contact import contact
    from camgen.judge.contact_tips import SlideTip

    work, goal = (
        "roller follower on a cam of 3,600 points, 360 positions",
        "1,000 times as fast, error a thousandth",
    )
    radius = 4.0
    said = peers.job("roller", base=20.0, radius=radius, lift=1.0)
    if not said:
        yield Row(work, "mechanism", goal, "-", "-", "-", None)
        return
    answer = said["answer"]
    z = np.array(answer["x"]) + 1j * np.array(answer["y"])
    turned = np.array(answer["turned"]) @ [1, 1j]
    theta = np.angle(turned / z[7])
    z = z[np.abs(z - np.roll(z, 1)) > 1e-9]
    ring = Ring(z, np.zeros(len(z))).counter_clockwise()
    table = contact(ring, SlideTip(0j, 1 + 0j, radius, 1))
    wide = ring.points.astype(np.clongdouble)
    exact = np.array([highest(wide * np.exp(1j * np.longdouble(angle)), radius) for angle in theta])
    ours, theirs = (
        float(np.abs(found - exact).max())
        for found in (table.angle(theta), np.array(answer["centres"]))
    )

    def whole() -> None:
        contact(ring, SlideTip(0j, 1 + 0j, radius, 1)).angle(theta)

    built = median(again(whole) for _ in range(rounds))
    a, b = alternated(rounds, partial(again, partial(table.angle, theta)), partial(peers.time, 2))
    yield Row(
        work,
        "mechanism",
        goal,
        f"{seconds(a)} ({seconds(built)} with its table), {ours:.0e} mm off",
        f"{seconds(b)}, {theirs:.0e} mm off",
        f"{b / a:,.3g} ({b / built:,.3g}) times as fast, error {ours / theirs:.0e}",
        b / a >= 1000 and ours <= theirs / 1000,
    )


def highest(z: Any, radius: float) -> float:
    """Centre on the x-axis of a disc that rests on the polygon z from +x: the farthest over all its corners and edges."""
    import numpy as np

    following = np.roll(z, -1)
    edge = (following - z) / np.abs(following - z)
    normal = -1j * edge
    with np.errstate(invalid="ignore", divide="ignore"):
        corners = z.real + np.sqrt(np.longdouble(radius) ** 2 - z.imag**2)
        # the touching point c - radius normal lies on the edge's line and between its ends
        sides = ((np.conj(normal) * z).real + radius) / normal.real
        foot = (np.conj(edge) * (sides - radius * normal - z)).real
        sides[~((foot >= 0) & (foot <= np.abs(following - z)) & (normal.real > 0))] = np.nan
    return float(np.nanmax(np.concatenate([corners, sides])))


def recoveries(rounds: int) -> Iterator[Row]:
    """Angles a second looked up in the table of an outline, and with the making of it."""
    import numpy as np
    from bench_contact import cam

    from camgen.geometry.rings import Ring
    from camgen.judge.contact import contact
    from camgen.judge.contact_tips import ArmTip

    theta = np.random.default_rng(1).uniform(0, 2 * np.pi, 10**6)
    for count in (1_000, 10_000, 100_000):
        setup = (Ring(cam(count), np.zeros(count)), ArmTip(60 + 0j, -60 - 30j, 3.0, 1))
        table = contact(*setup)
        works: list[Callable[[], object]] = [
            partial(table.angle, theta),
            partial(contact, *setup),
        ]
        spent, made = alternated(
            rounds, *(partial(clocked, work, time.process_time) for work in works)
        )
        rate, whole = (len(theta) / each / 1e6 for each in (spent, spent + made))
        yield Row(
            f"contact recovery, a million angles, outline of {count:,} vertices",
            "none does it",
            "5 million angles/s",
            f"{rate:.3g} million/s ({whole:.2g} with its table)",
            "-",
            f"{rate / 5:.2g} goals",
            rate >= 5,
        )


# ---- outlines --------------------------------------------------------------------------------------------------------


def offsets(rounds: int) -> Iterator[Row]:
    """10,000 points of the knife-edge cam's curve set inwards by 3 mm; error: the vertices' distance from it, less 3."""
    import numpy as np
    import shapely
    from test_facets import FIRST, SECOND, blunt_pieces, half_turn

    from camgen.machine.cams.followers import SwingingArm
    from camgen.motion.laws import UNIFORM
    from camgen.motion.program import Program, Segment

    first, second = blunt_pieces()
    swing, arm = math.radians(15), 60 + 30j
    there = Segment("rise", math.pi, 0.0, 2 * swing, UNIFORM)
    program = Program((there, Segment("return", math.pi, 2 * swing, -2 * swing, UNIFORM)))
    follower = SwingingArm(60 + 0j, -arm * np.exp(-1j * swing), 3.0, 1)
    # all but the loop that the concave corner cuts off
    theta = np.concatenate(
        [np.linspace(first.t0, first.t1, 5000), np.linspace(second.t0, second.t1, 5000)]
    )
    turn = np.arange(10_000) * (2 * math.pi / 10_000)
    knife = np.concatenate([half_turn(*FIRST)(turn[:5000], 0), half_turn(*SECOND)(turn[5000:], 0)])
    assert np.abs(follower.pitch(turn, program, 0) - knife).max() < 1e-9
    polygon = shapely.Polygon(np.column_stack([knife.real, knife.imag]))
    ours = partial(again, lambda: follower.envelope(theta, program, 0))
    for segments in (16, 64, 256, 1024):  # to a quarter, until it takes no less time than ours
        a, b = alternated(
            rounds, ours, partial(again, lambda n=segments: polygon.buffer(-3, quad_segs=n))
        )
        if b >= a:
            break
    buffered = shapely.get_coordinates(polygon.buffer(-3, quad_segs=segments)) @ [1, 1j]
    exact, coarse = (
        float(np.abs(nearest(found, FIRST, SECOND) - 3).max())
        for found in (follower.envelope(theta, program, 0), buffered)
    )
    yield Row(
        "tip offset of 10,000 points, error at the vertices",
        f"shapely buffer, {segments} segments",
        "error a thousandth at equal time",
        f"{exact:.1e} mm in {seconds(a)}",
        f"{coarse:.1e} mm in {seconds(b)}",
        f"error {exact / coarse:.0e}, time {a / b:.2g}",
        exact <= coarse / 1000 and a <= 1.1 * b,
    )


def nearest(z: Any, *halves: tuple[float, float]) -> Any:
    """Distance of each z from the reference curve: the least over its halves, from a dense table refined by Newton."""
    import numpy as np
    from test_facets import half_turn

    found = []
    for k, half in enumerate(halves):
        curve, low, high = half_turn(*half), k * math.pi, (k + 1) * math.pi
        grid = np.linspace(low, high, 4001)
        table = curve(grid, 0)
        t = np.concatenate(
            [
                grid[np.argmin(np.abs(block[:, None] - table), axis=1)]
                for block in np.array_split(z, 50)
            ]
        )
        for _ in range(4):
            gap, d1, d2 = curve(t, 0) - z, curve(t, 1), curve(t, 2)
            slope = (np.conj(d1) * d1 + np.conj(gap) * d2).real
            step = (np.conj(gap) * d1).real / np.where(slope > 0, slope, np.abs(d1) ** 2)
            t = np.clip(t - step, low, high)
        found.append(np.abs(curve(t, 0) - z))
    return np.minimum(*found)


def counts() -> Iterator[Row]:
    """Vertices against equal angles, arcs against the theory; pieces as in bench_outline.py."""
    from bench_outline import _alone, uniform
    from test_facets import blunt_pieces, knife_cam

    from camgen.geometry.arcs import _fit_smooth, theoretical_arcs
    from camgen.geometry.facets import facet

    for name, pieces in (("tip of 3 mm", blunt_pieces()), ("knife edge", knife_cam().pieces)):
        for tolerance in (1e-3, 1e-4):
            ours = sum(facet(piece, tolerance).size - 1 for piece in pieces)
            step = min(
                (piece.t1 - piece.t0) / uniform(piece, tolerance) for piece in pieces
            )  # one for the whole turn
            plain = math.ceil(sum(piece.t1 - piece.t0 for piece in pieces) / step)
            yield Row(
                f"vertices at {tolerance:g} mm, {name}",
                "uniform in angle",
                "0.76",
                f"{ours}",
                f"{plain}",
                f"{ours / plain:.3f}",
                round(ours / plain, 2) <= 0.76,
            )
        ours = sum(len(_fit_smooth(piece, 1e-4)) for piece in pieces)
        least = sum(theoretical_arcs(_alone(piece), 1e-4) - 1 for piece in pieces)
        yield Row(
            f"arcs at 1e-4 mm, {name}",
            "theory",
            "1.1",
            f"{ours}",
            f"{least:.1f}",
            f"{ours / least:.3f}",
            ours <= 1.1 * least,
        )
    yield indexing_arcs()


def indexing_arcs() -> Row:
    """Both cams of specs/indexing-cam.toml: each dwell an arc, each curve so many biarcs as the theory asks, whole ones."""
    from bench_outline import _alone

    from camgen.geometry.arcs import fit_arcs, theoretical_arcs
    from camgen.geometry.outlines import Smooth
    from camgen.machines.sources import read_mechanism

    drive: Any = read_mechanism(ROOT / "specs" / "indexing-cam.toml")
    outlines = [cam.outline for cam in drive.cams.values()]
    pieces = [piece for outline in outlines for piece in outline.pieces]
    ours = sum(len(fit_arcs(outline, 1e-4).pieces) for outline in outlines)
    theory = [
        theoretical_arcs(_alone(piece), 1e-4) - 1 if isinstance(piece, Smooth) else 1.0
        for piece in pieces
    ]
    whole = sum(
        2 * math.ceil(each / 2) if isinstance(piece, Smooth) else 1
        for each, piece in zip(theory, pieces, strict=True)
    )
    least = f"{whole} ({sum(theory):.1f} with parts of biarcs, {ours / sum(theory):.3f})"
    return Row(
        "arcs at 1e-4 mm, indexing cam and its return cam",
        "theory, whole biarcs a curve",
        "1.1",
        f"{ours}",
        least,
        f"{ours / whole:.3f}",
        ours <= 1.1 * whole,
    )


# ---- solids and files ------------------------------------------------------------------------------------------------


def whole_processes(peers: Peers, folder: Path, rounds: int) -> Iterator[Row]:
    """The cam of specs/uniform-swing.toml as STL: read back and judged here, extruded and written there."""
    import numpy as np

    from camgen.files.stl import read_stl
    from camgen.geometry.mesh import slice_mesh

    spec, out = ROOT / "specs" / "uniform-swing.toml", folder / "whole"
    ours = [
        sys.executable,
        "-m",
        "camgen",
        "build",
        str(spec),
        "-o",
        str(out),
        "--set",
        "parts.make='cams'",
        "--only",
        "stl",
    ]
    measured(ours)
    rings = slice_mesh(read_stl(out / "uniform-swing" / "uniform-swing-cam.stl"), 1.0)
    z = max(rings, key=lambda ring: ring.area).points
    np.save(folder / "cam.npy", np.column_stack([z.real, z.imag]))
    said = peers.job(
        "build123d_stl", vertices=str(folder / "cam.npy"), path=str(folder / "cam.stl")
    )
    theirs = [
        peers.python,
        str(HERE / "peers_jobs.py"),
        "--cam",
        str(folder / "cam.npy"),
        str(folder / "cam.stl"),
    ]
    memory: dict[str, list[float]] = {"ours": [], "theirs": []}

    def run(who: str, command: list[str]) -> float:
        wall, peak = measured(command)
        memory[who].append(peak)
        return wall

    a, b = alternated(
        rounds, partial(run, "ours", ours), partial(run, "theirs", theirs) if said else None
    )
    work, peer = (
        f"cam at 1e-3 mm ({len(z)} vertices) from spec to STL, whole process",
        "build123d polyline",
    )
    yield faster(work, peer, 5, a, b, (", read back and judged", ""))
    peak, other = median(memory["ours"]), median(memory["theirs"]) if said else math.nan
    yield Row(
        "its memory",
        peer,
        "a fifth",
        f"{peak:.0f} MB",
        f"{other:.0f} MB" if said else "-",
        f"{peak / other:.2f}" if said else "-",
        peak <= other / 5 if said else None,
    )


def measured(command: list[str]) -> tuple[float, float]:
    """Wall time (s) and peak memory (MB) of a process, started by a small one: a child inherits its parent's peak."""
    code = (
        "import os, subprocess, sys, time; t = time.perf_counter(); "
        "p = subprocess.Popen(sys.argv[1:], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL); "
        "_, status, usage = os.wait4(p.pid, 0); print(time.perf_counter() - t, usage.ru_maxrss / 1024, status)"
    )
    child = subprocess.run(
        [sys.executable, "-I", "-S", "-c", code, *command],
        stdout=-1,
        text=True,
        check=True,
        cwd=ROOT,
    )
    wall, peak, status = map(float, child.stdout.split())
    # a finding that fails leaves its files
    assert os.waitstatus_to_exitcode(int(status)) in (0, 1), command
    return wall, peak


def outlines(peers: Peers, folder: Path, rounds: int) -> Iterator[Row]:
    """The knife-edge cam's exact outline to STL here, the straight outline through the same vertices there."""
    import numpy as np
    from test_facets import knife_cam

    from camgen.files.stl import write_stl
    from camgen.geometry.outlines import Region
    from camgen.parts.part import Layer, Part
    from camgen.parts.solids import rings, solid

    part = Part("cam", "Cam", (Layer(Region(knife_cam()), 0.0, 6.0),))
    path = folder / "outline.stl"
    spent: dict[int, float] = {}
    for tolerance, goal in ((1.73e-4, 50.0), (1.727e-6, 1000.0), (9.5e-9, 0.0)):
        z = rings(part.region, tolerance)[0]
        np.save(folder / "outline.npy", np.column_stack([z.real, z.imag]))
        said = (
            peers.job(
                "build123d_stl", vertices=str(folder / "outline.npy"), path=str(folder / "peer.stl")
            )
            if goal
            else None
        )

        def ours(tolerance: float = tolerance) -> None:
            write_stl(path, solid(part, tolerance), "cam")

        a, b = alternated(rounds, partial(again, ours), peers.time if said else None)
        spent[len(z)] = median(clocked(ours, time.process_time) for _ in range(rounds))
        if goal:
            notes = ("", ", run once" if b > PATIENCE else "")
            yield faster(
                f"cam outline of {len(z):,} vertices to STL, warm",
                "build123d polyline",
                goal,
                a,
                b,
                notes,
            )
    (few, less), (many, more) = list(spent.items())[1:]
    yield Row(
        f"solid and STL, from {few:,} to {many:,} contour points",
        "growth of our own processor time",
        "at most 15 times",
        seconds(more),
        seconds(less),
        f"{more / less:.3g}",
        more <= 15 * less,
    )


def slicing(folder: Path, rounds: int) -> Iterator[Row]:
    """A prism of 41,000 triangles, from the file to closed contours."""
    from bench_contact import write_prism

    from camgen.files.stl import read_stl
    from camgen.geometry.mesh import slice_mesh

    path = folder / "prism.stl"
    count = write_prism(path)
    work = f"STL of {count:,} triangles read and sliced"
    try:
        import trimesh
    except ImportError:
        yield Row(work, "trimesh", "5 times as fast", "-", "-", "-", None)
        return

    def theirs() -> object:
        return trimesh.load_mesh(path).section([0, 0, 1], [0, 0, 2.5])

    a, b = alternated(
        rounds, partial(again, lambda: slice_mesh(read_stl(path), 2.5)), partial(again, theirs)
    )
    yield faster(work, "trimesh load and section", 5, a, b)


# ---- wheels that are not round -----------------------------------------------------------------------------------------


def wheels(peers: Peers, folder: Path, rounds: int) -> Iterator[Row]:
    """Both edges of phi - 0.08 sin 2 phi and their proof over the turn, against the peer's and its own check."""
    import numpy as np

    from camgen.geometry.arcs import bulges
    from camgen.geometry.rings import Ring
    from camgen.judge.pairs import Body, OutlinePair, pivots_apart
    from camgen.parts.wheels.noncircular import Centrodes, NoncircularPair, WaveLaw

    stated = peers.job("noncircular", law="phi - 0.08*sin(2*phi)", folder=str(folder / "ncgears"))
    told = stated["answer"] if stated else {}
    distance = told.get("center_distance", 36.0)
    plays: list[Any] = []

    def ours() -> None:
        law = WaveLaw(1.0, (), (0.0, -0.08))
        backlash = 0.24 / math.cos(math.radians(20))
        pair = NoncircularPair(Centrodes(law, distance), 24, backlash)
        bodies = (Body([Ring(*bulges(edge))]) for edge in (pair.driver, pair.driven))
        theta = np.linspace(0, math.tau, 721)
        samples = OutlinePair(*bodies, pivots_apart(distance)).follow(theta, 0.0).samples
        assert samples.proven[1:].all()
        plays[:] = np.degrees([samples.play.min(), samples.play.max()])

    a, b = alternated(rounds, partial(clocked, ours), peers.time if stated else None)
    theirs = [told.get(f"{end}imum_backlash_deg", math.nan) for end in ("min", "max")]
    notes = [f", play {low:.4f} to {high:.4f} deg" for low, high in (plays, theirs)]
    work = "wheels of phi - 0.08 sin 2 phi, 24 teeth, and the proof of both"
    yield faster(work, "ncgears, its own check", 5, a, b, (notes[0], notes[1]))


# ---- the table -------------------------------------------------------------------------------------------------------


def main() -> None:
    """Print the table; with --results put it into RESULTS.md as well."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--python", help="interpreter that has the peers")
    parser.add_argument("--rounds", type=int, default=7)
    parser.add_argument("--results", action="store_true")
    options = parser.parse_args()
    peers = Peers(options.python)
    with tempfile.TemporaryDirectory() as name:
        folder, rounds = Path(name), options.rounds
        groups = (
            four_bars(peers, rounds),
            rollers(peers, rounds),
            recoveries(rounds),
            whole_processes(peers, folder, rounds),
            slicing(folder, rounds),
            offsets(rounds),
            counts(),
            wheels(peers, folder, rounds),
            outlines(peers, folder, rounds),
        )
        lines = [
            "| work | peer | goal | camgen | peer's | ratio | met |",
            "|---|---|---|---|---|---|---|",
        ]
        print(*lines, sep="\n")
        for group in groups:
            for row in group:
                met = {None: "-", True: "yes", False: "**no**"}[row.met]
                cells = (row.work, row.peer, row.goal, row.ours, row.theirs, row.ratio, met)
                lines.append("| " + " | ".join(cells) + " |")
                print(lines[-1], flush=True)
    known = sorted(
        peers.versions
        | {f"{package} {version(package)}" for package in ("numpy", "shapely", "trimesh")}
    )
    lines += [
        "",
        f"{datetime.date.today()}, medians of {rounds}, commands alternated, Python {sys.version.split()[0]}; "
        + ", ".join(known)
        + ".",
    ]
    if peers.missing:
        lines.append("Missing: " + ", ".join(sorted(peers.missing)) + ".")
    print(*lines[len(lines) - (2 if peers.missing else 1) :], sep="\n")
    if options.results:
        page = ROOT / "tests" / "bench" / "RESULTS.md"
        before, rest = page.read_text(encoding="utf-8").split(BEGIN)
        text = "\n".join([before + BEGIN, *lines, END]) + rest.split(END)[1]
        page.write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
