"""The pictures that the README shows. Run `python tests/gallery.py` to make them again; a test compares them."""

from __future__ import annotations

from pathlib import Path

from camgen.pipeline import build as pipeline
from camgen.report.animation import still_svg

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
}  # frame of the moving picture that shows most


def picture(name: str) -> str:
    """The still picture of a spec in specs/, as SVG."""
    mechanism = pipeline.read_mechanism(TOP / "specs" / f"{name}.toml")
    return still_svg(pipeline.animation(mechanism), f"{mechanism.name} ({mechanism.mechanism})", FRAMES[name])


def path(name: str) -> Path:
    """Where the README finds it."""
    return TOP / "out" / "gallery" / f"{name}.svg"


if __name__ == "__main__":
    for name in FRAMES:
        path(name).write_text(picture(name), encoding="utf-8")
