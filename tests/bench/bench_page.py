"""How soon a report is seen: its first paint, with the machine drawn flat, and its first frame in three dimensions.

    PYTHONPATH=tests python tests/bench/bench_page.py REPORT.html...

Milliseconds from the begin of navigation, least and median of 9 loads in a browser that has shown the page before; needs
Chromium. The first row is a page of one word, which tells what the browser and the machine take by themselves.
"""

from __future__ import annotations

import statistics
import sys
import tempfile
from pathlib import Path

from browser import Tab, tab

# Set before the page's own scripts: the first frame that the viewer counts on its canvas.
EARLY = """new MutationObserver((told, watch) => {
  if (document.getElementById("machine")?.dataset.drawn) { window.solidAt = performance.now(); watch.disconnect(); }
}).observe(document, { subtree: true, childList: true, attributes: true });"""
SEEN = """new Promise(done => {
  const look = () => {
    const [paint] = performance.getEntriesByName("first-contentful-paint"), flat = document.getElementById("mechanism");
    paint && (window.solidAt || !flat) ? done([paint.startTime, window.solidAt || 0]) : setTimeout(look, 10);
  };
  look();
})"""
EMPTY = "<!DOCTYPE html><title>empty</title><p>a page of one word</p>"


def times(page: Tab, path: Path) -> tuple[float, float]:
    """First paint and first solid frame of the page, ms; the flat drawing is part of the page as it is first painted."""
    page.show(path, 1200)
    paint, solid = page.run(SEEN)
    return paint, solid


def main(paths: list[Path]) -> None:
    """Print the table."""
    print("| report | kB | first paint, ms | three dimensions, ms |\n|---|---|---|---|")
    with tab() as page, tempfile.TemporaryDirectory() as folder:
        empty = Path(folder, "empty.html")
        empty.write_text(EMPTY, encoding="utf-8")
        page.ask("Page.addScriptToEvaluateOnNewDocument", source=EARLY)
        for path in (empty, *paths):
            times(page, path)
            runs = []
            for _ in range(9):
                page.ask("Page.navigate", url="about:blank")
                runs.append(times(page, path))
            paint, solid = (
                f"{min(each):.0f} / {statistics.median(each):.0f}"
                for each in zip(*runs, strict=True)
            )
            name = path.stem if path == empty else path.parent.name
            print(f"| {name} | {path.stat().st_size / 1e3:.0f} | {paint} | {solid} |")


if __name__ == "__main__":
    main([Path(each) for each in sys.argv[1:]])
