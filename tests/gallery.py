"""The pictures that the README and its gallery show. Run `python tests/gallery.py` to make them again; a test compares them."""

from __future__ import annotations

import re
from io import BytesIO
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
from PIL import Image
from still import still_svg

from camgen.pipeline import build as pipeline
from camgen.pipeline.shown import animation as shown
from camgen.pipeline.shown import rendered
from camgen.report.animation import frames

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
    "bird-drum": 20,
    "pencil-cam": 14,
    "plate-gripper": 10,
    "elliptic-wheels": 10,
    "flapping-bird": 8,
    "ratchet": 20,
    "stepping-gears": 26,
    "cycloidal-reducer": 12,
    "planetary-reducer": 8,
}  # frame of the moving picture that shows most
SOLID = ("drum-feeder",)  # what a plan does not show
_MARGIN = 2.0  # mm, round a drawing
_CLOSE = 0.05  # mm, and units of all other numbers of a picture
_WITHIN = 0.2  # mm, that the ends of a cam's arcs leave of its box
_SAME = 0.002  # of a picture's pixels, that lie on edges and may differ from processor to processor
_PATHS = re.compile(r' (?:d|points)="([^"]*)"')
_NUMBER = re.compile(r"-?\d+(?:\.\d+)?")
_CORNERS = re.compile(rf"({_NUMBER.pattern}),({_NUMBER.pattern})")  # of a polyline
_ENDS = re.compile(rf"({_NUMBER.pattern}) ({_NUMBER.pattern})(?=[A-Za-z]|$)")  # of strokes


def picture(name: str) -> str:
    """The still picture of a spec in specs/ or its gallery, as SVG."""
    (spec,) = (TOP / "specs").rglob(f"{name}.toml")
    mechanism = pipeline.read_mechanism(spec)
    return still_svg(shown(mechanism), f"{mechanism.name} ({mechanism.mechanism})", FRAMES[name])


def solid(name: str) -> bytes:
    """A machine in 3-D, as PNG."""
    (spec,) = (TOP / "specs").rglob(f"{name}.toml")
    return rendered(pipeline.read_mechanism(spec), "picture")


def same_pixels(picture: bytes, other: bytes) -> bool:
    """Whether two PNG show the same."""
    images = [
        np.asarray(Image.open(BytesIO(each)).convert("RGB"), int) for each in (picture, other)
    ]
    if images[0].shape != images[1].shape:
        return False
    return bool(np.mean(np.any(abs(images[0] - images[1]) > 8, axis=-1)) < _SAME)


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


def drawn(report: Any) -> str:
    """The line that a pen is to draw, wide, and over it the one that the DXF give, as SVG."""
    (plot,) = (each for each in report.plots if each.title.endswith("over the wanted line"))
    lines = {name: x - 1j * y for name, x, y in plot.series}
    wanted = lines["wanted"]
    left = wanted.real.min() - _MARGIN
    top = wanted.imag.min() - _MARGIN
    width = np.ptp(wanted.real) + 2 * _MARGIN
    height = np.ptp(wanted.imag) + 2 * _MARGIN

    def line(name: str, look: str) -> str:
        corners = " ".join(f"{z.real - left:.2f},{z.imag - top:.2f}" for z in lines[name].tolist())
        return f'<polyline points="{corners}" fill="none" {look}/>'

    box = f'viewBox="0 0 {width:.2f} {height:.2f}" width="{8 * width:.0f}"'
    head = f'<svg xmlns="http://www.w3.org/2000/svg" {box}>'
    said = "<title>the line, wide, and what the pen draws by the DXF files</title>"
    wide = line(
        "wanted",
        'stroke="#d9b48f" stroke-width="1.6" stroke-linejoin="round" stroke-linecap="round"',
    )
    thin = line("from DXF", 'stroke="#0b62a8" stroke-width="0.25"')
    return f"{head}{said}{wide}{thin}</svg>\n"


def alike(picture: str, other: str) -> bool:
    """Whether two pictures show the same: all but their paths is the same, and the paths have the same boxes.

    The last digits of a motion that is searched for, and so the arcs of its cams, differ from processor to processor.
    """
    texts = [_PATHS.sub("", each) for each in (picture, other)]
    words = [_NUMBER.sub("", text) for text in texts]
    numbers = [np.array(_NUMBER.findall(text), float) for text in texts]
    boxes = [np.array([_box(each) for each in _PATHS.findall(text)]) for text in (picture, other)]
    return (
        words[0] == words[1]
        and boxes[0].shape == boxes[1].shape
        and np.allclose(*numbers, rtol=0, atol=_CLOSE)
        and np.allclose(*boxes, rtol=0, atol=_WITHIN)
    )


def _box(path: str) -> list[float]:
    """Least and greatest x and y of where the strokes of a path end."""
    ends = np.array(_CORNERS.findall(path) or _ENDS.findall(path), float)
    return [*ends.min(axis=0), *ends.max(axis=0)]


def path(name: str, kind: str = "svg") -> Path:
    """Where the README finds it."""
    return TOP / "out" / "gallery" / f"{name}.{kind}"


if __name__ == "__main__":
    path("walking-leg-moving").write_text(moving("walking-leg"), encoding="utf-8")
    for name in FRAMES:
        path(name).write_text(picture(name), encoding="utf-8")
    for name in SOLID:
        path(name, "png").write_bytes(solid(name))
    with TemporaryDirectory() as folder:
        made = pipeline.build(TOP / "specs/gallery/heart.toml", Path(folder), frozenset({"dxf"}))
    path("heart-drawn").write_text(drawn(made), encoding="utf-8")
