"""What each command pays for: time to start, heavy packages that it loads, and seconds by stage of a build.

    python tests/bench/bench_startup.py [SPEC]

Medians of 5 runs, each in a process of its own; stages from one build in this process, imports of the stage included.
"""

from __future__ import annotations

import json
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

SPEC = Path(__file__).parent.parent.parent / "specs" / "uniform-swing.toml"
HEAVY = (
    "numpy",
    "pydantic",
    "scipy",
    "shapely",
    "ezdxf",
    "manifold3d",
    "mapbox_earcut",
    "lib3mf",
    "matplotlib",
    "rich",
)
RUN = """
import json, sys
from camgen.cli import main
sys.stdout = sys.stderr
try:
    main(sys.argv[1:])
except SystemExit:
    pass
print(json.dumps(sorted({name.partition('.')[0] for name in sys.modules})), file=sys.__stdout__)
"""


def started(*arguments: str) -> tuple[float, list[str]]:
    """Seconds of a command, median of 5, and the heavy packages that it loaded."""
    seconds, loaded = [], []
    for _ in range(5):
        begin = time.perf_counter()
        done = subprocess.run(
            [sys.executable, "-c", RUN, *arguments], capture_output=True, text=True, check=True
        )
        seconds.append(time.perf_counter() - begin)
        loaded = json.loads(done.stdout.splitlines()[-1])
    return statistics.median(seconds), [name for name in HEAVY if name in loaded]


def main(spec: Path) -> None:
    """Print both tables."""
    from camgen.pipeline.build import KINDS, build

    with tempfile.TemporaryDirectory() as folder:
        out, cams = ["-o", folder], ["--set", "parts.make='cams'"] if spec == SPEC else []
        commands = [["--help"], ["list"], ["selftest"], ["schema", "uniform-swing"]]
        commands += [["build", str(spec), *cams, *out, "--only", kind] for kind in KINDS]
        commands += [["build", str(spec), *out, "-j", jobs] for jobs in ("1", "2")]
        print("| command | s | loads |\n|---|---|---|")
        for command in commands:
            seconds, loaded = started(*command)
            said = " ".join(
                Path(word).name if word in (str(spec), folder) else word for word in command
            )
            said = said.replace(f" -o {Path(folder).name}", "")
            print(f"| `camgen {said}` | {seconds:.2f} | {' '.join(loaded) or 'nothing heavy'} |")
        marks: list[tuple[str, float]] = []
        build(
            spec,
            Path(folder),
            frozenset(KINDS),
            progress=lambda text, done=None: marks.append((text, time.perf_counter())),
        )
        marks.append(("", time.perf_counter()))
    print(f"\n| stage of `camgen build {spec.name}` | s |\n|---|---|")
    for (text, begin), (_, end) in zip(marks, marks[1:], strict=False):
        print(f"| {text} | {end - begin:.2f} |")


if __name__ == "__main__":
    main(Path(sys.argv[1]).resolve() if len(sys.argv) > 1 else SPEC)
