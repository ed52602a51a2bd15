"""The pictures that the README and its gallery show. Run `python tests/gallery.py` to make them again; a test compares them."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import numpy as np

from camgen.pipeline import build as pipeline
from camgen.pipeline.shown import animation as shown
from camgen.report.animation import frames, still_svg

TOP = Path(__file__).resolve().parent.parent
FRAMES = {
    "uniform-swing": 20,
    "eccentric-drive": 15,
    "thread-take-up": 40,
    "chain-stitch-looper": 30,
    "disc-cam": 20,
    "indexing-cam": 20,
    "linkage": 10,
    "walking-leg": 10,
    "quick-return": 12,
    "stitch-head": 20,
    "four-leg-walker": 12,
    "walker": 12,
    "scotch-yoke": 8,
    "elliptic-trammel": 8,
    "heart": 10,
    "geneva-table": 60,
    "pencil-cam": 14,
    "elliptic-wheels": 10,
    "ratchet": 20,
    "cycloidal-reducer": 12,
    "planetary-reducer": 8,
}  # frame of the moving picture that shows most


def picture(name: str) -> str:
    """The still picture of a spec in specs/ or its gallery, as SVG."""
    (spec,) = (TOP / "specs").rglob(f"{name}.toml")
    mechanism = pipeline.read_mechanism(spec)
    return still_svg(shown(mechanism), f"{mechanism.name} ({mechanism.mechanism})", FRAMES[name])


def moving(name: str, seconds: float = 6.0) -> str:
    """The same, moving: each copy by a CSS animation of 40 places, still where a reader asks for less motion."""
    mechanism = pipeline.read_mechanism(TOP / "specs" / f"{name}.toml")
    animation = shown(mechanism)
    rules, numbers = [], iter(range(10**6))
    told: Any = frames(animation)["poses"]
    poses = [told[each] if isinstance(each, int) else each for each in told]

    def placed(found: re.Match[str]) -> str:
        k = next(numbers)
        if len(poses[k]) == 1:
            return found[0]
        deg, x, y = np.array([*poses[k], poses[k][0]], float).T[:, :: len(poses[k]) // 40]
        deg = np.unwrap(deg, period=360)
        steps = (
            f"{100 * i / 40:g}%{{transform:translate({x[i]:.2f}px,{y[i]:.2f}px) rotate({deg[i]:.2f}deg)}}"
            for i in range(41)
        )
        rules.append(
            f"@keyframes k{k}{{{''.join(steps)}}}.k{k}{{animation:k{k} {seconds:g}s linear infinite}}"
        )
        return f'<g class="k{k}" transform="{found[2]}"><use{found[1]}{found[3]}/></g>'

    still = still_svg(animation, f"{mechanism.name}, one turn in {seconds:g} s", FRAMES[name])
    text = re.sub(
        r'<use([^>]*?) transform="(translate\([^"]*?\)rotate\([^"]*?\))(?:scale\(-1 1\))?"()/>',
        placed,
        still,
    )
    quiet = "@media (prefers-reduced-motion:reduce){g{animation:none!important}}"
    return text.replace("</style>", "".join(rules) + quiet + "</style>", 1)


def path(name: str) -> Path:
    """Where the README finds it."""
    return TOP / "out" / "gallery" / f"{name}.svg"


if __name__ == "__main__":
    path("walking-leg-moving").write_text(moving("walking-leg"), encoding="utf-8")
    for name in FRAMES:
        path(name).write_text(picture(name), encoding="utf-8")
