// The page in motion: one angle theta moves the drawing, the cursors of the curves and, where there is one, the viewer.
// Whoever wants to follow it asks with camgen.follow(deg => ...).
const camgen = (() => {
  const data = JSON.parse(document.getElementById("frames").textContent);
  const poses = data.frames && data.poses.map((states, _, all) => Array.isArray(states) ? states : all[states]);  // a number: as of that copy
  const byId = id => document.getElementById(id);
  const followers = [];
  const secondsPerTurn = 8;  // at the usual speed
  const turns = data.turns || 1;  // of the drive, after which all is where it was
  let deg = 0, lap = 0, running = false, before = 0;

  function show(angle) {
    deg = angle;
    followers.forEach(follow => follow(deg));
  }
  function follow(what) {
    followers.push(what);
    what(deg);
  }
  // solid: a viewer shows the machine, the drawing rests; turned: share of all turns at an angle of this one
  // heights: of what is no part and is drawn in three dimensions too; upright: what of it moves in a plane that stands
  const page = { follow, show, courseAt, poseAt, heights: data.heights, upright: data.upright, swells: data.swells, solid: false, turned: angle => (lap + angle / 360) / turns };
  let folded = [];  // what is unfolded to be printed
  addEventListener("beforeprint", () => {
    folded = [...document.querySelectorAll("details:not([open])")];
    folded.forEach(details => { details.open = true; });
  });
  addEventListener("afterprint", () => folded.forEach(details => { details.open = false; }));
  if (!data.frames) return page;
  document.body.classList.add("live");

  // ---- the drawing and its read-out ----

  const play = byId("play"), slider = byId("theta"), speed = byId("speed");
  const copies = document.querySelectorAll("#mechanism use");
  const between = (a, b, share) => a + (b - a) * share;
  follow(() => {
    slider.value = deg;
    const [least, greatest] = data.stroke || [];  // of a drive that goes to and fro
    const drive = data.stroke ? least + (greatest - least) * (1 - Math.cos(deg * Math.PI / 180)) / 2 : deg;
    byId("angle").value = drive.toFixed(1).replace("-", "\u2212");
    const place = page.turned(deg % 360) * data.frames, i = Math.floor(place), share = place - i, j = (i + 1) % data.frames;
    if (data.output.length) {
      const a = data.output[i], b = data.output[j];
      byId("value").value = a === null || b === null ? "\u2013" : between(a, b, share).toFixed(3).replace("-", "\u2212");
    }
    if (!page.solid) draw();
  });
  function present() { return page.turned(deg % 360); }  // share of all turns
  function courseAt(k, turned = present()) {  // a course at a share of all turns: x and y by turns; nothing where there is none
    const place = turned % 1 * data.frames, i = Math.floor(place), share = place - i, j = (i + 1) % data.frames;
    return data.courses[k]?.[i].map((value, n) => between(value, data.courses[k][j][n], j ? share : 0));  // a turn may begin anew
  }
  function draw() {
    Object.keys(data.courses).forEach(k => {
      document.querySelector("#body-" + k + " path").setAttribute("d", "M" + courseAt(k).map(value => value.toFixed(2)).join(" "));
    });
    copies.forEach((copy, k) => {
      const pose = poseAt(k);
      copy.toggleAttribute("display", false);
      if (pose) copy.setAttribute("transform", "translate(" + pose[1] + " " + pose[2] + ")rotate(" + pose[0] + ")" + (data.flipped[k] ? "scale(-1 1)" : ""));
      else copy.setAttribute("display", "none");
    });
  }
  function poseAt(k, turned = present()) {  // of a copy: deg, x and y, null where the machine cannot go
    const place = turned % 1 * data.frames, i = Math.floor(place), share = place - i;
    const states = poses[k], a = states[i % states.length], b = states[(i + 1) % data.frames % states.length];
    if (!a || !b) return null;
    const turn = b[0] - a[0] - 360 * Math.round((b[0] - a[0]) / 360);
    return [a[0] + turn * share, between(a[1], b[1], share), between(a[2], b[2], share)];
  }
  page.draw = draw;
  addEventListener("beforeprint", draw);

  // ---- parts: hidden and coloured, in the drawing too ----

  if (innerWidth < 760) document.querySelector(".legend").open = false;  // the machine is to leave room for what one reads

  const boxes = [...document.querySelectorAll(".legend [data-body]")];
  boxes.forEach(box => {
    const k = box.dataset.body, colour = box.closest("li").querySelector("[type=color]");
    box.hidden = colour.hidden = false;
    colour.value = getComputedStyle(document.documentElement).getPropertyValue("--p" + k).trim();
    box.addEventListener("change", () => {
      document.querySelectorAll("#mechanism .c" + k).forEach(use => { use.style.visibility = box.checked ? "" : "hidden"; });
      document.dispatchEvent(new CustomEvent("parts"));
    });
    colour.addEventListener("input", () => {
      document.documentElement.style.setProperty("--p" + k, colour.value);
      document.dispatchEvent(new CustomEvent("parts"));
    });
  });

  // ---- curves: cursor, values, seeking ----

  const raised = ["", "\u207b", "\u2070", "\u00b9", "\u00b2", "\u00b3", "\u2074", "\u2075", "\u2076", "\u2077", "\u2078", "\u2079"];
  function line(path) {  // what a path draws: pieces of points
    return path.getAttribute("d").replace("Z", "").split("M").slice(1).map(piece => piece.split("L").map(at => at.split(" ").map(Number)));
  }
  function at(points, x) {  // height of a piece at x, NaN beside it; its x never falls
    if (!points.length || x < points[0][0] - 0.02 || x > points[points.length - 1][0] + 0.02) return NaN;
    let low = 0, high = points.length - 1;
    while (high - low > 1) {
      const middle = (low + high) >> 1;
      if (points[middle][0] <= x) low = middle; else high = middle;
    }
    const [x0, y0] = points[low], [x1, y1] = points[high];
    return x1 > x0 ? between(y0, y1, Math.min(1, Math.max(0, (x - x0) / (x1 - x0)))) : y1;
  }
  class Figure {
    constructor(element) {
      this.cursor = element.querySelector(".cursor");
      this.svg = this.cursor.ownerSVGElement;
      [this.left, this.right, this.x0, this.x1, this.low, this.top, this.y0, this.y1] =
        element.querySelector(".drawn").dataset.axes.split(" ").map(Number);
      const keys = element.querySelectorAll(".keys output");
      this.curves = [...element.querySelectorAll(".drawn > g[class^=s]")].map((group, k) => {
        const path = group.querySelector("path"), pieces = path ? line(path) : [];
        if (!path || !path.dataset.upper) return { key: keys[k], lines: [pieces] };
        const upper = Number(path.dataset.upper);
        return { key: keys[k], lines: [[pieces[0].slice(upper).reverse()], [pieces[0].slice(0, upper)]] };
      });
      this.digits = Math.max(0, 3 - Math.floor(Math.log10(Math.abs(this.y1 - this.y0))));
      let held = false;
      const seek = event => {
        const place = new DOMPoint(event.clientX, event.clientY).matrixTransform(this.svg.getScreenCTM().inverse());
        run(false);
        show(Math.min(360, Math.max(0, 360 * (place.x - this.left) / (this.right - this.left))));
      };
      this.svg.addEventListener("pointerdown", event => { held = true; this.svg.setPointerCapture(event.pointerId); seek(event); });
      this.svg.addEventListener("pointermove", event => { if (held) seek(event); });
      ["pointerup", "pointercancel"].forEach(name => this.svg.addEventListener(name, () => { held = false; }));
    }
    show() {
      const x = this.left + deg / 360 * (this.right - this.left);
      this.cursor.setAttribute("transform", "translate(" + x + " 0)");
      this.curves.filter(curve => curve.key).forEach(curve => {
        curve.key.value = curve.lines.map(pieces => {
          const y = pieces.map(piece => at(piece, x)).find(y => !isNaN(y));
          if (y === undefined) return "\u2013";
          const value = this.y0 + (this.low - y) / (this.low - this.top) * (this.y1 - this.y0);
          const known = Number(value.toFixed(Math.min(100, this.digits)));  // what a plot of this height can tell
          if (this.digits <= 6 || !known) return known.toFixed(Math.min(6, this.digits)).replace("-", "\u2212");
          const [head, power] = known.toExponential(2).split("e");
          return head.replace("-", "\u2212") + "\u00b710" + power.replace(/./g, c => raised["+-0123456789".indexOf(c)]);
        }).join(" \u2026 ");
      });
    }
  }
  const made = new Map(), seen = new Set();
  const watch = new IntersectionObserver(entries => entries.forEach(entry => {
    if (!made.has(entry.target)) made.set(entry.target, new Figure(entry.target));
    const figure = made.get(entry.target);
    if (entry.isIntersecting) { seen.add(figure); figure.show(); } else seen.delete(figure);
  }), { rootMargin: "100px" });
  document.querySelectorAll(".plot.turn").forEach(figure => watch.observe(figure));
  follow(() => seen.forEach(figure => figure.show()));

  // ---- time ----

  function step(now) {
    if (!running) return;
    const next = deg + (now - before) / 1000 * 360 / secondsPerTurn * Number(speed.value);
    lap = (lap + Math.floor(next / 360)) % turns;
    show(next % 360);
    before = now;
    requestAnimationFrame(step);
  }
  function run(on) {
    running = on;
    play.textContent = on ? "Pause" : "Play";
    if (on) requestAnimationFrame(now => { before = now; step(now); });
  }
  function fromAddress() {
    const asked = /^#theta=(-?[\d.]+)/.exec(location.hash);
    if (asked) { run(false); show(((Number(asked[1]) % 360) + 360) % 360); }
    return asked;
  }
  play.hidden = slider.hidden = speed.hidden = false;
  play.addEventListener("click", () => run(!running));
  slider.addEventListener("input", () => { run(false); show(Number(slider.value)); });
  addEventListener("hashchange", fromAddress);
  addEventListener("keydown", event => {
    if (event.target.closest("input, select, button, summary, a, canvas") || event.ctrlKey || event.metaKey || event.altKey) return;
    const steps = { ArrowLeft: -1, ArrowRight: 1 }[event.key];
    if (event.key === " ") run(!running);
    else if (steps) { run(false); show((deg + steps * (event.shiftKey ? 10 : 1) + 360) % 360); }
    else return;
    event.preventDefault();
  });
  queueMicrotask(() => { if (!fromAddress()) run(!matchMedia("(prefers-reduced-motion: reduce)").matches); });
  return page;
})();
