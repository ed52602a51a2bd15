"""The outputs of two states of camgen, compared number by number: the net under a rebuild.

    python tests/net.py COMMIT                     builds every case with that commit and with this checkout, and compares
    python tests/net.py --build FOLDER             builds every case with this checkout into a folder, to compare with later
    python tests/net.py --against FOLDER           builds every case with this checkout and compares it with such a folder
    python tests/net.py FOLDER FOLDER              compares two such folders
      --cases WORD ...    only cases whose name holds one of the words
      --jobs N            so many cases at once (2)

Two kinds of outputs:

    must be equal   what is made, measured and proven: DXF, STL, 3MF, GLB, STEP, tables, spec.toml, report.json, what a command
                    prints as JSON, exit codes. Numbers may differ by rounding (1e-9 of their size).
    may move        what people look at: report.html, PDF and words in a terminal. A difference is shown, and counts for nothing.

Beside them stands the processor time of each case, as a ratio of the two states.
"""

from __future__ import annotations

import argparse
import json
import math
import os
import re
import resource
import struct
import subprocess
import sys
import tempfile
import time
import zipfile
import zlib
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path

TOP = Path(__file__).resolve().parent.parent
SHARE = 1e-9  # of a number, or of a millimetre: rounding of another order of sums
MAY_MOVE = {".html", ".pdf", ".txt"}
UNCOMPARED = {"manifest.json"}  # digests of the other files
FEWEST = 0.5  # s of processor time, below which a ratio says nothing
NUMBER = re.compile(r"[-+]?(?:\d+\.\d*|\.\d+|\d+)(?:[eE][-+]?\d+)?")
STREAM = re.compile(rb"stream\r?\n(.*?)\r?\nendstream", re.DOTALL)

LASER = "laser.thickness=3 laser.kerf=0.15 laser.sheet=[600,400]"
SOLID = "output.step=true output.profile_step_deg=1 output.center_marks=true output.engrave=true"
FILES = "files.step=true files.center_marks=true files.engrave=true"
# Settings of further variants, by spec; each spec of specs/ and specs/gallery/ is built as it is, too.
VARIANTS = {
    "uniform-swing": [
        "geometry.pivot_distance=80 geometry.arm_offset=40 geometry.swing_deg=24 parts.make='cams'",
        "geometry.closure='force' frame.tip='MR63' spring.preload=0.1 spring.rate=0.2",
    ],
    "eccentric-drive": [
        "geometry.eccentricity=2 geometry.rod=60 geometry.eccentric_diameter=11",
        "geometry.offset=0.4 masses.rod_g=1.6 masses.rod_centre=16 masses.rod_inertia_g_mm2=450 masses.slider_g=1.5",
    ],
    "thread-take-up": [
        "geometry.coupler=30 geometry.output_crank=19 geometry.guides=[[60,15],[-80,160]]",
        "geometry.frame_angle_deg=30 print.hole_compensation=0.05",
    ],
    "chain-stitch-looper": ["geometry.mode='published'", "geometry.needle_diameter=0.8"],
    "indexing-cam": [
        "geometry.index_deg=150 geometry.base_radius=60 geometry.law='modified-sine'",
        "geometry.closure='force' load.closing_n_m=2",
        "parts.make='machine'",
    ],
    "disc-cam": [
        "geometry.closure='groove' geometry.base_radius=30 parts.hub_height=0",
        "geometry.follower.motion='oscillating' geometry.follower.pivot_distance=60 geometry.follower.arm=50 "
        "geometry.base_radius=30",
        f"{SOLID} output.cutter_radius=3",
        "parts.make='machine'",
        "geometry.follower.motion='oscillating' geometry.follower.pivot_distance=60 geometry.follower.arm=50 "
        f"geometry.base_radius=30 parts.make='machine' bodies.make='laser' {LASER}",
    ],
    "groove": ["parts.make='machine'"],
    "automaton": ["parts.make='machine'"],
    "linkage": [f"parts.make='laser' {LASER}", FILES, "parts.motor='nema-17' print.bed=[120,120]"],
    "quick-return": ["parts.plates=2"],
}
# Commands beside builds; {out} is the case's own folder, which each runs in.
COMMANDS = {
    "list": ["list"],
    "selftest": ["selftest"],
    **{
        f"schema-{name}": ["schema", name]
        for name in ("disc-cam", "linkage", "thread-take-up", "uniform-swing", "coupon")
    },
    **{
        f"new-{name}": ["new", name, "new.toml"]
        for name in ("disc-cam", "linkage", "indexing-cam", "chain-stitch-looper")
    },
    "check": ["check", "{before}/four-bar-0/four-bar", "--json"],
    "sweep": [
        "sweep",
        "{specs}/disc-cam.toml",
        "--vary",
        "geometry.base_radius=12:32:5",
        "-o",
        "sweep.csv",
    ],
    "sweep-bars": [
        "sweep",
        "{specs}/linkage.toml",
        "--vary",
        "lengths.A-B=48:52:3",
        "-o",
        "sweep.csv",
    ],
    "tolerance": ["tolerance", "{specs}/disc-cam.toml", "--samples", "200", "--json"],
    "design": [
        "design",
        "{specs}/thread-take-up.toml",
        "found.toml",
        "--set",
        "wanted.feed_range=80",
    ],
    "sliced": ["check", "{before}/linkage-0/linkage", "--gcode", "plate.gcode", "--json"],
    "motion": [
        "motion",
        "{before}/disc-cam-0/disc-cam/disc-cam-cam.dxf",
        "--follower",
        "translating,radius=5",
        "-o",
        "rolled",
    ],
    "refused": ["build", "{specs}/linkage.toml", "--set", "lengths.O-A=400"],
    "faults": [
        "build",
        "{specs}/disc-cam.toml",
        "--set",
        "geometry.base_raduis=4",
        "--set",
        "segment.0.lift=-1",
    ],
}


@dataclass(frozen=True)
class Case:
    """One command, and the name of the folder that it runs in."""

    name: str
    words: tuple[str, ...]
    after: bool = False  # needs what builds have made


def cases(top: Path) -> list[Case]:
    """Every spec as it is and in its variants, then the other commands."""
    found = []
    for path in sorted(
        [*(top / "specs").glob("*.toml"), *(top / "specs" / "gallery").glob("*.toml")]
    ):
        for k, settings in enumerate(["", *VARIANTS.get(path.stem, [])]):
            words = [word for setting in settings.split() for word in ("--set", setting)]
            found.append(Case(f"{path.stem}-{k}", ("build", str(path), "-o", ".", *words)))
    for name, words in COMMANDS.items():
        filled = (
            word.replace("{specs}", str(top / "specs")).replace("{before}", "..") for word in words
        )
        found.append(Case(name, tuple(filled), any("{before}" in word for word in words)))
    return found


def run(top: Path, out: Path, case: Case) -> float:
    """Run a case with the checkout at `top` in OUT/<case>/, with what it says in files beside what it makes; s of one core."""
    folder = out / case.name
    folder.mkdir(parents=True)
    if "--gcode" in case.words:
        _slice(Path(case.words[1]), folder)
    environment = {
        **os.environ,
        "PYTHONPATH": str(top),
        "OPENBLAS_NUM_THREADS": "1",
        "COLUMNS": "120",
    }
    flat = top / "tests" / "flat.py"  # an older checkout has none, and no shelves
    command = [
        sys.executable,
        *([str(flat)] if flat.exists() else ["-m", "camgen"]),
        *case.words,
        *(["--jobs", "1"] if case.words[0] == "build" else []),
    ]
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, env=environment)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    suffix = ".json" if "--json" in case.words else ".txt"
    for name, text in ((f"stdout{suffix}", done.stdout), ("stderr.txt", done.stderr)):
        (folder / name).write_text(text.replace(str(top), "").replace(str(out), ""))
    (folder / "exit.code").write_text(f"{done.returncode}\n")
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def _slice(made: Path, folder: Path) -> None:
    """Write plate.gcode into a case's folder, of parts of a folder that a case before it has made."""
    from sliced_parts import laid

    laid((folder / made).resolve(), ("ground", "crank", "coupler", "rocker")).replace(
        folder / "plate.gcode"
    )


_ALONE = """
import json, sys
sys.path.insert(0, sys.argv[1])
import net
top, out, name, words = json.loads(sys.argv[2])
print(net.run(net.Path(top), net.Path(out), net.Case(name, tuple(words))))
"""


def _run_alone(top: str, out: str, case: Case) -> float:
    """A case in a process of its own, so that the processor time of its children is its own."""
    words = json.dumps([top, out, case.name, case.words])
    command = [sys.executable, "-c", _ALONE, str(TOP / "tests"), words]
    environment = {**os.environ, "PYTHONPATH": str(TOP)}
    done = subprocess.run(command, stdout=subprocess.PIPE, text=True, check=True, env=environment)
    return float(done.stdout)


def build(top: Path, out: Path, words: list[str], jobs: int) -> None:
    """Run all cases whose names hold one of the words, or all, with the checkout at `top`; times in OUT/times.json."""
    wanted = [case for case in cases(top) if not words or any(word in case.name for word in words)]
    times = {}
    with ThreadPoolExecutor(jobs) as pool:
        for last in (False, True):
            batch = [case for case in wanted if case.after is last]
            for case, spent in zip(
                batch,
                pool.map(lambda case: _run_alone(str(top), str(out), case), batch),
                strict=True,
            ):
                times[case.name] = spent
                print(f"{case.name:32} {spent:7.2f} s", flush=True)
    (out / "times.json").write_text(json.dumps(times, indent=1))


def texts(path: Path) -> dict[str, str]:
    """What a file says, in parts by name."""
    data = path.read_bytes()
    match path.suffix:
        case ".3mf":
            with zipfile.ZipFile(path) as archive:
                return {
                    name: archive.read(name).decode()
                    for name in archive.namelist()
                    if name.endswith(".model")
                }
        case ".stl":
            return {"": data[84:].hex()}
        case ".glb":
            return dict(_chunks(data))
        case ".pdf":
            return {str(k): _inflated(piece) for k, piece in enumerate(STREAM.findall(data))}
        case _:
            return {"": data.decode("utf-8", errors="replace")}


def _chunks(data: bytes) -> Iterator[tuple[str, str]]:
    """The JSON of a GLB, and its accessors' numbers."""
    place = 12
    found = {}
    while place < len(data):
        size, kind = struct.unpack_from("<I4s", data, place)
        found[kind] = data[place + 8 : place + 8 + size]
        place += 8 + size
    described = json.loads(found[b"JSON"])
    yield "nodes", json.dumps({key: value for key, value in described.items() if key != "asset"})
    for k, view in enumerate(described.get("bufferViews", [])):
        start = view.get("byteOffset", 0)
        yield f"view {k}", found[b"BIN\0"][start : start + view["byteLength"]].hex()


def _inflated(piece: bytes) -> str:
    """A stream of a PDF, unpacked where it is packed."""
    try:
        return zlib.decompress(piece).decode("latin-1")
    except zlib.error:
        return piece.decode("latin-1")


def differences(a: str, b: str) -> tuple[str, float]:
    """The first place where two texts differ beyond rounding, "" for none, and the largest difference of numbers."""
    if a == b:
        return "", 0.0
    if NUMBER.sub("#", a) != NUMBER.sub("#", b):
        one, other = NUMBER.sub("#", a), NUMBER.sub("#", b)
        k = next(
            (k for k, (x, y) in enumerate(zip(one, other, strict=False)) if x != y),
            min(len(one), len(other)),
        )
        return (
            f"...{one[max(k - 60, 0) : k + 60]!r} against ...{other[max(k - 60, 0) : k + 60]!r}",
            math.inf,
        )
    worst = 0.0
    where = ""
    for x, y in zip(NUMBER.finditer(a), NUMBER.finditer(b), strict=True):
        off = abs(float(x[0]) - float(y[0])) / max(1.0, abs(float(x[0])))
        if off > max(worst, SHARE):
            where = f"{a[max(x.start() - 80, 0) : x.end()]!r} against {y[0]}"
        worst = max(worst, off)
    return (where if worst > SHARE else ""), worst


def differing(before: Path, after: Path, names: set[Path]) -> Iterator[tuple[Path, str]]:
    """The files that differ, and how."""
    for name in sorted(names):
        one = before / name
        other = after / name
        if not (one.exists() and other.exists()):
            yield name, f"only {'before' if one.exists() else 'after'}"
            continue
        if one.read_bytes() == other.read_bytes():
            continue
        first = texts(one)
        second = texts(other)
        for inner in sorted(first.keys() | second.keys()):
            said, worst = differences(first.get(inner, ""), second.get(inner, ""))
            if said:
                yield name, f"{inner} {worst:.3g}: {said[:400]}"


def compare(before: Path, after: Path) -> int:
    """Print what differs and how long each case took; returns the number of files that must be equal and are not."""
    cases_of_both = {path.name for path in before.iterdir() if path.is_dir()} & {
        path.name for path in after.iterdir()
    }
    found = {
        path.relative_to(root)
        for root in (before, after)
        for path in root.rglob("*")
        if path.is_file()
    }
    names = {
        name for name in found if name.parts[0] in cases_of_both and name.name not in UNCOMPARED
    }
    shown = {name for name in names if name.suffix in MAY_MOVE}
    print("== may move")
    for name, said in differing(before, after, shown):
        print(f"{name}: {said[:200]}")
    print("== must be equal")
    wrong = list(differing(before, after, names - shown))
    for name, said in wrong:
        print(f"{name}: {said}")
    print("== processor time, after over before")
    old, new = (json.loads((folder / "times.json").read_text()) for folder in (before, after))
    for case in sorted(old.keys() & new.keys()):
        if old[case] > FEWEST:
            print(f"{case:32} {old[case]:7.2f} {new[case]:7.2f} s {new[case] / old[case]:6.2f}")
    first, second = (sum(times[case] for case in old.keys() & new.keys()) for times in (old, new))
    print(f"{'all':32} {first:7.2f} {second:7.2f} s {second / first:6.2f}")
    count = len({name for name, _ in wrong})
    print(f"{len(cases_of_both)} cases, {len(names)} files, {count} that must be equal differ")
    return count


def build_commit(commit: str, out: Path, words: list[str], jobs: int) -> None:
    """Run the cases with another commit, in a checkout of its own."""
    with tempfile.TemporaryDirectory() as scratch:
        old = Path(scratch) / "old"
        subprocess.run(
            ["git", "worktree", "add", "--detach", str(old), commit],
            cwd=TOP,
            check=True,
            capture_output=True,
        )
        try:
            build(old, out, words, jobs)
        finally:
            subprocess.run(["git", "worktree", "remove", "--force", str(old)], cwd=TOP, check=True)


def main() -> int:
    """What the module's first lines say."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("states", nargs="*", help="a commit, or two folders")
    parser.add_argument("--build", type=Path)
    parser.add_argument("--against", type=Path)
    parser.add_argument("--cases", nargs="+", default=[])
    parser.add_argument("--jobs", type=int, default=2)
    asked = parser.parse_args()
    if len(asked.states) == 2:
        return min(compare(*map(Path, asked.states)), 1)
    if asked.build:
        build(TOP, asked.build, asked.cases, asked.jobs)
        return 0
    if not (asked.against or len(asked.states) == 1):
        parser.error("name a commit, two folders, --build or --against")
    with tempfile.TemporaryDirectory() as scratch:
        before = asked.against or Path(scratch) / "before"
        after = Path(scratch) / "after"
        if not asked.against:
            build_commit(asked.states[0], before, asked.cases, asked.jobs)
        build(TOP, after, asked.cases, asked.jobs)
        return min(compare(before, after), 1)


if __name__ == "__main__":
    started = time.monotonic()
    ended = main()
    print(f"{time.monotonic() - started:.0f} s")
    sys.exit(ended)
