"""Outputs of two states of camgen, compared number by number: nothing may move when the house is rebuilt.

    python tests/net.py COMMIT          builds every variant with that commit and with this checkout, and compares
    python tests/net.py FOLDER FOLDER   compares two such folders of builds

Texts are compared with their numbers rounded (1e-9 of their size), solids by their vertices and triangles, pages left out.
"""

from __future__ import annotations

import math
import re
import subprocess
import sys
import tempfile
import zipfile
from pathlib import Path

TOP = Path(__file__).resolve().parent.parent
SHARE = 1e-9  # of a number, or of a millimetre: rounding of another order of sums
VARIANTS = {
    "uniform-swing": ["", "geometry.pivot_distance=80 geometry.arm_offset=40 geometry.swing_deg=24 parts.make='cams'",
                      "geometry.closure='force' frame.tip='MR63' spring.preload=0.1 spring.rate=0.2"],
    "eccentric-drive": ["", "geometry.eccentricity=2 geometry.rod=60 geometry.eccentric_diameter=11", "geometry.offset=0.4 "
                        "masses.rod_g=1.6 masses.rod_centre=16 masses.rod_inertia_g_mm2=450 masses.slider_g=1.5"],
    "thread-take-up": ["", "geometry.coupler=30 geometry.output_crank=19 geometry.guides=[[60,15],[-80,160]]",
                       "geometry.frame_angle_deg=30 print.hole_compensation=0.05"],
    "chain-stitch-looper": ["", "geometry.mode='published'", "geometry.needle_diameter=0.8"],
    "indexing-cam": ["", "geometry.index_deg=150 geometry.base_radius=60 geometry.law='modified-sine'",
                     "geometry.closure='force' load.closing_n_m=2"],
    "disc-cam": ["", "geometry.closure='groove' geometry.base_radius=30 parts.hub_height=0",
                 "geometry.follower.motion='oscillating' geometry.follower.pivot_distance=60 geometry.follower.arm=50 "
                 "geometry.base_radius=30"],
}
NUMBER = re.compile(r"[-+]?(?:\d+\.\d*|\.\d+|\d+)(?:[eE][-+]?\d+)?")


def build(top: Path, out: Path) -> None:
    """Build every variant with the checkout at `top` into OUT/<spec>-<k>/<name>/."""
    for spec, variants in VARIANTS.items():
        for k, settings in enumerate(variants):
            words = [word for setting in settings.split() for word in ("--set", setting)]
            command = [sys.executable, "-m", "camgen", "build", f"specs/{spec}.toml", "-o", str(out / f"{spec}-{k}"), *words]
            done = subprocess.run(command, cwd=top, capture_output=True, text=True, env={"PYTHONPATH": str(top), "PATH": ""})
            (out / f"{spec}-{k}").mkdir(parents=True, exist_ok=True)
            said = done.stderr[-500:] if done.returncode > 1 else ""
            (out / f"{spec}-{k}" / "verdict.txt").write_text(f"exit {done.returncode}\n{said}")


def texts(path: Path) -> dict[str, str]:
    """What a file says, by name."""
    if path.suffix == ".3mf":
        with zipfile.ZipFile(path) as archive:
            return {name: archive.read(name).decode() for name in archive.namelist() if name.endswith(".model")}
    if path.suffix == ".stl":
        return {"": path.read_bytes()[84:].hex()}
    return {"": path.read_text(encoding="utf-8", errors="replace")}


def differences(a: str, b: str) -> tuple[str, float]:
    """The first place where two texts differ beyond rounding, "" for none, and the largest difference of numbers."""
    if a == b:
        return "", 0.0
    if NUMBER.sub("#", a) != NUMBER.sub("#", b):
        one, other = NUMBER.sub("#", a), NUMBER.sub("#", b)
        k = next((k for k, (x, y) in enumerate(zip(one, other, strict=False)) if x != y), min(len(one), len(other)))
        return f"...{one[max(k - 60, 0):k + 60]!r} against ...{other[max(k - 60, 0):k + 60]!r}", math.inf
    worst, where = 0.0, ""
    for x, y in zip(NUMBER.finditer(a), NUMBER.finditer(b), strict=True):
        off = abs(float(x[0]) - float(y[0])) / max(1.0, abs(float(x[0])))
        if off > max(worst, SHARE):
            where = f"{a[max(x.start() - 80, 0):x.end()]!r} against {y[0]}"
        worst = max(worst, off)
    return (where if worst > SHARE else ""), worst


def compare(before: Path, after: Path) -> int:
    """Print every file that differs; returns their number."""
    count = 0
    names = {path.relative_to(root) for root in (before, after) for path in root.rglob("*") if path.is_file()}
    for name in sorted(names):
        if name.suffix in (".html", ".pdf") or name.name == "manifest.json":
            continue
        one, other = before / name, after / name
        if not (one.exists() and other.exists()):
            print(f"{name}: only {'before' if one.exists() else 'after'}")
            count += 1
            continue
        first, second = texts(one), texts(other)
        for inner in sorted(first.keys() | second.keys()):
            said, worst = differences(first.get(inner, ""), second.get(inner, ""))
            if said:
                count += 1
                print(f"{name}: {worst:.3g}: {said[:400]}")
    print(f"{len(names)} files, {count} differences")
    return count


if __name__ == "__main__":
    if len(sys.argv) == 3:
        sys.exit(min(compare(Path(sys.argv[1]), Path(sys.argv[2])), 1))
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    with tempfile.TemporaryDirectory() as scratch:
        old, outs = Path(scratch) / "old", [Path(scratch) / "before", Path(scratch) / "after"]
        subprocess.run(["git", "worktree", "add", "--detach", str(old), sys.argv[1]], cwd=TOP, check=True, capture_output=True)
        try:
            for top, out in zip((old, TOP), outs, strict=True):
                build(top, out)
        finally:
            subprocess.run(["git", "worktree", "remove", "--force", str(old)], cwd=TOP, check=True)
        sys.exit(min(compare(*outs), 1))
