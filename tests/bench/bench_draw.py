"""From the mouse to the curve: how long the sheet of `camgen explore` takes while a point is dragged.

    PYTHONPATH=tests python tests/bench/bench_draw.py            prints the table; needs Chromium
    PYTHONPATH=tests python tests/bench/bench_draw.py PICTURE    writes the picture of the sheet that the README shows

Milliseconds. answer: camgen alone, where all points go over the turn. mouse to curve: in the page, from when the browser has the place of the
mouse until the new paths are in the document, computed there or asked of camgen; the next frame paints them.
"""

from __future__ import annotations

import statistics
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from browser import Tab, tab

from camgen import starters
from camgen.live.board import Board

POINTS = {"four-bar": "C", "walking-leg": "C", "four-leg-walker": "A"}  # each dragged
MOVES = 150
AT = """(() => {
  const name = [...document.querySelectorAll("#sheet text.name")].find(each => each.textContent === "%s");
  const box = document.getElementById("sheet").getBoundingClientRect();
  return [box.x + Number(name.getAttribute("x")) - 9, box.y + Number(name.getAttribute("y")) + 8];
})()"""


def file_of(name: str) -> Path:
    """The spec of an example."""
    return next(starters.folder().rglob(f"{name}.toml"))


def answer_times(name: str, point: str) -> list[float]:
    """Of camgen alone, for MOVES places of the point."""
    board = Board(file_of(name), Path("out"))
    x, y = board.tables["points"][point]
    times = []
    for k in range(MOVES):
        asked = {"op": "move", "points": {point: [x + 0.02 * k, y]}, "try": True}
        began = time.perf_counter()
        board.draw(asked)
        times.append(1e3 * (time.perf_counter() - began))
    return times


@contextmanager
def sheet(page: Tab, name: str, dark: bool = False) -> Iterator[Tab]:
    """The page of a spec, served by a process of its own."""
    words = [sys.executable, "-m", "camgen", "explore", str(file_of(name))]
    with subprocess.Popen(words, stdout=subprocess.PIPE, text=True) as server:
        assert server.stdout is not None
        address = server.stdout.readline().split()[0]
        try:
            size = {"width": 1180, "height": 700, "deviceScaleFactor": 1, "mobile": False}
            page.ask("Emulation.setDeviceMetricsOverride", **size)
            page.ask("Page.navigate", url=address)
            while not page.run("Boolean(document.querySelector('#sheet text.name'))"):
                time.sleep(0.1)
            time.sleep(2)
            yield page
        finally:
            server.terminate()


def mouse(page: Tab, kind: str, x: float, y: float) -> None:
    """An event of the mouse with its left button held."""
    page.ask(
        "Input.dispatchMouseEvent", type=kind, x=x, y=y, button="left", buttons=1, clickCount=1
    )


def drag_times(page: Tab, name: str, point: str) -> list[float]:
    """From mouse to curve, while the point is dragged by some pixels at sixty places a second."""
    with sheet(page, name):
        x, y = page.run(AT % point)
        mouse(page, "mousePressed", x, y)
        for k in range(MOVES):
            mouse(page, "mouseMoved", x + k % 30, y + k // 30)
            time.sleep(1 / 60)
        found = page.run("lags")
        mouse(page, "mouseReleased", x, y)
    return list(found)


def shares(times: list[float]) -> str:
    """Least, median, and what nine of ten keep."""
    return f"{min(times):.1f} / {statistics.median(times):.1f} / {statistics.quantiles(times, n=10)[8]:.1f}"


def picture(path: Path) -> None:
    """The sheet with the leg, a link of it picked."""
    with tab() as page, sheet(page, "walking-leg"):
        (ex, ey), (px, py) = page.run(AT % "E"), page.run(AT % "P")
        for kind in ("mousePressed", "mouseReleased"):
            mouse(page, kind, (ex + px) / 2, (ey + py) / 2)
        time.sleep(1)
        page.picture(path)


def main() -> None:
    """Print the table."""
    print("| dragged | answer, least / median / 90 % | mouse to curve |\n|---|---|---|")
    with tab() as page:
        for name, point in POINTS.items():
            answers = shares(answer_times(name, point))
            print(f"| {name}, {point} | {answers} | {shares(drag_times(page, name, point))} |")


if __name__ == "__main__":
    picture(Path(sys.argv[1])) if sys.argv[1:] else main()
