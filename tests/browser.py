"""The report in a headless Chromium, spoken to over a pipe: python tests/browser.py REPORT.html [WIDTH [OUT.png [dark]]]"""

from __future__ import annotations

import base64
import json
import os
import select
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

MOST_BYTES = 1_300_000  # of a report
FLAGS = (
    "--headless",
    "--no-sandbox",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    "--disable-quic",
    "--no-first-run",
)

# Turns, cuts, explodes and hides the machine of a report, scrolls over it and names a part; says what was seen: how many pixels of
# the canvas are drawn, in all and at its edges, and the values.
PROBE = """(async () => {
  const until = async what => {
    for (let k = 0; k < 600 && !what(); k++) await new Promise(done => setTimeout(done, 20));
    if (!what()) throw Error("waited in vain for " + what);
  };
  const byId = id => document.getElementById(id), canvas = byId("machine"), section = byId("section"), found = {};
  const seen = () => {
    const copy = Object.assign(document.createElement("canvas"), { width: 200, height: 150 }), flat = copy.getContext("2d");
    flat.drawImage(canvas, 0, 0, 200, 150);
    const drawn = (...frame) => flat.getImageData(...frame).data.filter((value, k) => k % 4 == 3 && value > 0).length;
    found.edges = Math.max(found.edges || 0, drawn(0, 0, 200, 1), drawn(0, 149, 200, 1), drawn(0, 0, 1, 150), drawn(199, 0, 1, 150));
    return drawn(0, 0, 200, 150);
  };
  const scrolls = () => canvas.dispatchEvent(new WheelEvent("wheel", { deltaY: 1, cancelable: true }));
  const after = async change => {
    const before = canvas.dataset.drawn;
    change();
    await until(() => canvas.dataset.drawn != before);
    return seen();
  };
  const cut = axis => () => { section.value = axis; section.dispatchEvent(new Event("change")); };
  await until(() => camgen.solid && canvas.dataset.drawn);
  found.start = await after(() => camgen.show(0));
  found.turned = await after(() => camgen.show(77));
  found.wheel = [scrolls()];
  canvas.focus();
  found.wheel.push(scrolls());
  await after(() => canvas.dispatchEvent(new KeyboardEvent("keydown", { key: "Enter" })));
  found.part = byId("part").textContent;
  await after(() => byId("home").click());
  found.angle = byId("theta").value;
  found.cuts = [];  // across each axis; half of a row of needles is little, but not across all
  for (const axis of ["x", "y", "z"]) found.cuts.push(await after(cut(axis)));
  found.cut = Math.max(...found.cuts);
  found.whole = await after(cut(""));
  const explode = byId("explode");
  explode.value = 1;
  found.exploded = await after(() => explode.dispatchEvent(new Event("input")));
  found.hidden = await after(() => document.querySelectorAll(".legend [data-body]").forEach(box => box.click()));
  found.drawing = document.querySelector("#mechanism .c0").style.visibility;
  const key = document.querySelector(".plot.turn output"), small = document.querySelector(".small");
  found.curves = Boolean(key);
  if (key) { key.scrollIntoView(); await until(() => key.value); }  // a coupon has none
  small.scrollIntoView();
  await until(() => small.dataset.seen);
  found.small = small.getContext("2d").getImageData(0, 0, 320, 220).data.filter(value => value > 0).length;
  found.clipped = [];  // parts whose pictures reach the edge
  const cards = [...document.querySelectorAll('.small[data-view^="part-"]')];
  for (const card of cards.slice(0, 12)) {
    card.scrollIntoView();
    await until(() => card.dataset.seen);
    const inked = (...frame) => card.getContext("2d").getImageData(...frame).data.some((value, k) => k % 4 == 3 && value > 0);
    if (inked(0, 0, 320, 1) || inked(0, 219, 320, 1) || inked(0, 0, 1, 220) || inked(319, 0, 1, 220)) found.clipped.push(card.dataset.view);
  }
  const bench = byId("bench");
  if (bench) {  // on to the second step by the button and back by a key: what comes is drawn
    const count = byId("count"), ink = () => {
      const copy = Object.assign(document.createElement("canvas"), { width: 200, height: 150 }), flat = copy.getContext("2d");
      flat.drawImage(bench, 0, 0, 200, 150);
      return flat.getImageData(0, 0, 200, 150).data.filter((value, k) => k % 4 == 3 && value > 0).length;
    };
    bench.closest(".bench").scrollIntoView();  // the first step may be a list, without a picture
    await until(() => count.value);
    found.steps = [count.value];
    byId("next").click();
    found.steps.push(count.value);
    for (const key of ["ArrowLeft", "End", "Home"]) {
      bench.dispatchEvent(new KeyboardEvent("keydown", { key, bubbles: true, cancelable: true }));
      found.steps.push(count.value);
    }
    const seek = byId("seek"), first = seek.value;
    seek.value = seek.max;
    seek.dispatchEvent(new Event("input"));
    found.steps.push(count.value, first);
    byId("back").click();
    found.steps.push(seek.value);
    await until(() => bench.dataset.drawn);
    await new Promise(done => requestAnimationFrame(() => { found.bench = ink(); done(); }));
    found.said = byId("said").textContent;
    document.activeElement.blur();  // the keys of the page turn the steps that are in its middle
    bench.closest(".bench").scrollIntoView({ block: "center" });  // a step without a picture is low
    document.body.dispatchEvent(new KeyboardEvent("keydown", { key: "ArrowLeft", bubbles: true, cancelable: true }));
    found.address = [location.hash, count.value];
    location.hash = "#step=2";
    await until(() => seek.value == 2);
    const names = () => [...document.querySelectorAll("#marks .part")];  // of what comes, clear of all other labels
    for (let k = 1; k == 1 || (k <= seek.max && !names().length); k++) {
      const before = Number(bench.dataset.drawn || 0);
      seek.value = k;
      seek.dispatchEvent(new Event("input"));
      if (names().length) await until(() => Number(bench.dataset.drawn) > before);  // a list has no picture to be drawn
    }
    const boxes = [...document.querySelectorAll("#marks b")].map(label => [label, label.getBoundingClientRect()]);
    const meet = (a, b) => a.left < b.right - 1 && b.left < a.right - 1 && a.top < b.bottom - 1 && b.top < a.bottom - 1;
    found.named = names().map(label => label.textContent);
    found.over = boxes.filter(([label, box]) => label.className === "part" && boxes.some(([other, more]) => other !== label && meet(box, more))).length;
  }
  found.wide = document.documentElement.scrollWidth - document.documentElement.clientWidth;
  return found;
})()"""


# Of a wide page: how many curves there are unfolded, in how many columns, and what their section lacks to the page's width.
WIDE = """(() => {
  const curves = document.querySelector(".curves"), main = document.querySelector("main");
  if (!curves) return [0, 0, 0];
  const left = [...curves.querySelectorAll(":scope > .grid > .plot")].map(plot => Math.round(plot.getBoundingClientRect().left));
  return [left.length, new Set(left).size, main.clientWidth - 40 - Math.round(curves.getBoundingClientRect().width)];
})()"""


class Tab:
    """A page: commands of the DevTools protocol, and what it has complained of."""

    def __init__(self, read: int, write: int) -> None:
        self.read, self.write, self.rest, self.number = read, write, b"", 0
        self.session: dict[str, str] = {}
        self.errors: list[str] = []
        target = self.ask("Target.createTarget", url="about:blank")["targetId"]
        self.session = {
            "sessionId": self.ask("Target.attachToTarget", targetId=target, flatten=True)[
                "sessionId"
            ]
        }
        for domain in ("Runtime", "Log", "Page"):
            self.ask(f"{domain}.enable")

    def ask(self, method: str, limit: float = 60, **params: Any) -> dict[str, Any]:
        self.number += 1
        message = {"id": self.number, "method": method, "params": params} | self.session
        os.write(self.write, json.dumps(message).encode() + b"\0")
        end = time.monotonic() + limit
        while True:
            while b"\0" not in self.rest:
                if not select.select([self.read], [], [], max(0, end - time.monotonic()))[0]:
                    raise TimeoutError(method)
                self.rest += os.read(self.read, 1 << 20)
            text, _, self.rest = self.rest.partition(b"\0")
            told = json.loads(text)
            if told.get("id") == self.number:
                if "error" in told:
                    raise RuntimeError(f"{method}: {told['error']}")
                return dict(told["result"])
            self.listen(told)

    def listen(self, told: dict[str, Any]) -> None:
        params = told.get("params", {})
        if told.get("method") == "Runtime.exceptionThrown":
            self.errors.append(
                params["exceptionDetails"].get("exception", {}).get("description", "an exception")
            )
        elif told.get("method") == "Runtime.consoleAPICalled" and params["type"] in (
            "error",
            "assert",
        ):
            self.errors.append(str(params["args"]))
        elif told.get("method") == "Log.entryAdded" and params["entry"]["level"] == "error":
            self.errors.append(params["entry"]["text"])

    def show(self, path: Path, width: int, height: int = 800, dark: bool = False) -> None:
        """Open a file in a window of this size."""
        self.ask(
            "Emulation.setDeviceMetricsOverride",
            width=width,
            height=height,
            deviceScaleFactor=1,
            mobile=width < 600,
        )
        scheme = {"name": "prefers-color-scheme", "value": "dark" if dark else "light"}
        self.ask("Emulation.setEmulatedMedia", features=[scheme])
        self.ask("Page.navigate", url=f"{path.resolve().as_uri()}#theta=60")
        end = time.monotonic() + 30
        while not self.run("document.readyState == 'complete' && location.protocol == 'file:'"):
            if time.monotonic() > end:
                raise TimeoutError("the page does not load")

    def run(self, script: str) -> Any:
        """What a script comes to; its promise is waited for."""
        told = self.ask(
            "Runtime.evaluate", expression=script, awaitPromise=True, returnByValue=True
        )
        if "exceptionDetails" in told:
            raise RuntimeError(
                told["exceptionDetails"].get("exception", {}).get("description", "an exception")
            )
        return told["result"].get("value")

    def picture(self, path: Path) -> None:
        path.write_bytes(base64.b64decode(self.ask("Page.captureScreenshot", format="png")["data"]))


@contextmanager
def tab(*flags: str) -> Iterator[Tab]:
    """A page of a browser of its own; flags: more of them."""
    (theirs_in, ours_out), (ours_in, theirs_out) = os.pipe(), os.pipe()
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as folder:
        words = ["chromium", *FLAGS, *flags, "--remote-debugging-pipe", f"--user-data-dir={folder}"]
        start = f'exec "$@" 3<&{theirs_in} 4>&{theirs_out}'
        quiet: dict[str, Any] = {
            "stdin": subprocess.DEVNULL,
            "stdout": subprocess.DEVNULL,
            "stderr": subprocess.DEVNULL,
        }
        with subprocess.Popen(
            ["bash", "-c", start, "bash", *words], pass_fds=(theirs_in, theirs_out), **quiet
        ) as process:
            os.close(theirs_in)
            os.close(theirs_out)
            try:
                yield Tab(ours_in, ours_out)
            finally:
                process.terminate()
                os.close(ours_in)
                os.close(ours_out)


def chromium(path: Path) -> str:
    """report.html as on a telephone: the machine is drawn, turns, is cut and exploded, its parts are hidden; no complaint."""
    if path.stat().st_size > MOST_BYTES:
        return f"{path.stat().st_size} bytes"
    try:
        with tab() as page:
            page.show(path, 380)
            found = page.run(PROBE)
            page.ask(
                "Emulation.setDeviceMetricsOverride",
                width=1280,
                height=800,
                deviceScaleFactor=1,
                mobile=False,
            )
            curves, columns, lacks = page.run(WIDE)
            wrong = [error.splitlines()[0] for error in page.errors]
    except (RuntimeError, TimeoutError, OSError) as error:
        return str(error).splitlines()[0]
    drawn = {key: found[key] for key in ("start", "turned", "cut", "whole", "exploded")}
    wrong += [f"{key}: {count} pixels drawn" for key, count in drawn.items() if count < 100]
    wrong += [] if found["angle"] == "77" else [f"theta is {found['angle']}"]
    wrong += (
        []
        if all(count != found["whole"] for count in found["cuts"])
        else ["a section cuts nothing"]
    )
    wrong += [] if found["whole"] == found["turned"] else ["the section stays"]
    wrong += (
        [] if found["hidden"] == 0 and found["drawing"] == "hidden" else ["hidden parts are seen"]
    )
    wrong += [] if found["small"] > 100 else ["no small views"]
    wrong += [f"cut off in its picture: {', '.join(found['clipped'])}"] if found["clipped"] else []
    if "steps" in found:
        last = int(found["steps"][0].rpartition(" ")[2])
        steps = [f"Step {k} of {last}" for k in (1, 2, 1, last, 1, last)]
        turned = found["steps"] == [*steps, "1", str(last - 1)]
        wrong += [] if turned and found["said"] else [f"steps on the bench: {found['steps']}"]
        one_back = max(1, last - 2)
        addressed = found["address"] == [f"#step={one_back}", f"Step {one_back} of {last}"]
        wrong += [] if addressed else [f"address of a step: {found['address']}"]
        wrong += [] if found["bench"] > 100 else [f"bench: {found['bench']} pixels drawn"]
        wrong += [] if found["named"] else ["no part that comes is named"]
        wrong += [f"{found['over']} names of parts over other labels"] if found["over"] else []
    wrong += [f"{found['edges']} pixels at the edges"] if found["edges"] else []
    wrong += [] if found["wheel"] == [True, False] else ["the wheel scrolls where it is to zoom"]
    wrong += [] if found["part"] else ["no part is named"]
    full = columns >= min(3, curves) and lacks <= 1
    wrong += [] if full else [f"{curves} curves in {columns} columns, {lacks} pixels left empty"]
    return "; ".join(wrong + ([f"{found['wide']} pixels too wide"] if found["wide"] > 0 else []))


# Of a page whose browser has no WebGL: pixels of the bench and of the first picture of a step, and what it says of that.
FLAT = """(async () => {
  const wait = ms => new Promise(done => setTimeout(done, ms)), bench = document.getElementById("bench");
  for (let k = 0; k < 300 && !document.querySelector(".bench:not([hidden])"); k++) await wait(50);
  bench.closest(".bench").scrollIntoView();
  for (let k = 0; k < 300 && !document.getElementById("count").value; k++) await wait(50);
  const turned = new Promise(done => addEventListener("hashchange", done, { once: true }));  // it scrolls to the bench
  location.hash = "#step=" + document.getElementById("seek").max;  // the first ones may be lists, without a picture
  await turned;
  for (let k = 0; k < 300 && !bench.dataset.drawn; k++) await wait(50);
  document.querySelector(".steps details").open = true;
  const small = document.querySelector(".steps .small");
  small.scrollIntoView();
  for (let k = 0; k < 300 && !small.dataset.seen; k++) await wait(50);
  await wait(200);
  const ink = canvas => canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height).data.filter((value, k) => k % 4 == 3 && value > 0).length;
  for (let k = 0; k < 100 && !(ink(bench) && ink(small)); k++) await wait(50);  // it draws slowly
  return [ink(bench), ink(small), document.querySelector(".steps .flat")?.textContent || ""];
})()"""


def without_webgl(path: Path) -> str:
    """report.html in a browser without WebGL: it says so, and its steps have pictures all the same."""
    try:
        with tab("--disable-3d-apis") as page:
            page.show(path, 1000)
            bench, small, said = page.run(FLAT)
            wrong = [error.splitlines()[0] for error in page.errors]
    except (RuntimeError, TimeoutError, OSError) as error:
        return str(error).splitlines()[0]
    wrong += [] if "WebGL 2 switched off" in said else ["it does not say that WebGL is off"]
    wrong += [] if bench > 2000 else [f"bench: {bench} pixels drawn"]
    wrong += [] if small > 500 else [f"a step's picture: {small} pixels drawn"]
    return "; ".join(wrong)


if __name__ == "__main__":
    file, wide = Path(sys.argv[1]), int(sys.argv[2]) if len(sys.argv) > 2 else 380
    if len(sys.argv) > 3:
        with tab() as shown:
            shown.show(file, wide, int(os.environ.get("HEIGHT", "900")), "dark" in sys.argv)
            shown.run("new Promise(done => setTimeout(done, 2500))")
            shown.run(os.environ.get("SCRIPT", "0"))
            shown.run("new Promise(done => setTimeout(done, 500))")
            shown.picture(Path(sys.argv[3]))
            print("; ".join(shown.errors) or "ok")
    else:
        print(chromium(file) or "ok")
