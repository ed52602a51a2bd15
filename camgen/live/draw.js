// The sheet of `camgen explore`: a linkage drawn with mouse, finger or keys. Every operation is done by camgen in the spec's text;
// while a hand drags, the page places the points itself (apexes.js) or camgen does, and nothing is written.
"use strict";

function start() {  // the page before: an empty sheet, or one of the gallery
  document.querySelectorAll("[data-start]").forEach(button => button.addEventListener("click", async () => {
    const answer = await ask("start", { name: button.dataset.start });
    byId("said").hidden = answer.ok;
    if (answer.ok) location.assign("./"); else tell(answer, "");
  }));
}

const TOOLS = [
  ["move", "v", "Move", "Drag a point; onto another one pins them together. Drag the paper to shift it, turn the wheel to zoom."],
  ["link", "l", "Link", "Press where the link begins, drag to where it ends; on a point it is pinned there."],
  ["point", "p", "Point", "Press on a link and drag to the new point's place; on a point of another link it is pinned there."],
  ["ground", "g", "Ground", "Click the points that stand still; click one again to release it."],
  ["slide", "s", "Slide", "Press on a point, or on a link, and drag in the direction in which it slides."],
  ["slot", "t", "Slot", "Press on a point and drag onto the link in whose slot it runs."],
  ["gear", "e", "Gear", "Drag from a link to another one; both turn on the ground. Draw it again to remove the gear. Its ratio is among the keys."],
  ["cam", "c", "Cam", "Press on the link that turns as the cam, drag to the point of the follower that has the roller. Draw it again to remove the cam."],
  ["drive", "d", "Drive", "Click the link that drives; it is pinned to the ground."],
  ["output", "o", "Output", "Click the point whose path you want, or a link whose motion you want; click it again to remove the output."],
  ["delete", "x", "Delete", "Click a point or a link to remove it."],
];

function draw(seen) {
  const svg = byId("sheet"), pointers = new Map();
  let tool = "move", picked = null, drag = null, tried = null, values = null, playing = 0, scale = 4, centre = [0, 0], idle = [], cams = [], note = "";

  // ---- places ----

  const size = () => [svg.clientWidth || 800, svg.clientHeight || 500];
  const onScreen = ([x, y]) => { const [w, h] = size(); return [(x - centre[0]) * scale + w / 2, h / 2 - (y - centre[1]) * scale]; };
  const onPaper = event => {
    const box = svg.getBoundingClientRect(), [w, h] = size();
    return [(event.clientX - box.left - w / 2) / scale + centre[0], (h / 2 - event.clientY + box.top) / scale + centre[1]];
  };
  const step = () => 10 ** Math.floor(Math.log10(6 / scale));
  const snapped = (event, place = onPaper(event)) => {
    const to = event.shiftKey ? 0.01 : step();
    return place.map(x => Number((Math.round(x / to) * to).toFixed(3)));
  };
  const ground = () => seen.sheet.links.ground || [];
  const moving = () => Object.entries(seen.sheet.links).filter(([name]) => name !== "ground");
  const now = () => tried || seen;

  function places() {  // of all points, as they are to be shown
    const drawn = { ...seen.sheet.points, ...(drag && drag.places), ...now().start }, turn = Number(byId("turn").value);
    if (!turn || !now().start) return drawn;
    return Object.fromEntries(Object.entries(drawn).map(([name, place]) => {
      const path = now().paths[name], at = turn * (path.length / 2 - 1), k = Math.min(Math.floor(at), path.length / 2 - 2), share = at - k;
      const between = axis => path[2 * k + axis] === null || path[2 * k + 2 + axis] === null ? NaN
        : path[2 * k + axis] * (1 - share) + path[2 * k + 2 + axis] * share;
      return [name, [between(0), between(1)]];
    }));
  }

  function turned(angles) {  // of angles over the turn the one that is shown
    const at = Number(byId("turn").value) * (angles.length - 1), k = Math.min(Math.floor(at), angles.length - 2);
    return angles[k] + (angles[k + 1] - angles[k]) * (at - k);
  }

  const pivotOf = link => (seen.sheet.links[link] || []).find(point => ground().includes(point));
  const linkOf = what => what.link || moving().filter(([, points]) => points.includes(what.point)).map(([name]) => name)[0];

  function hit(event, no = () => false) {  // the point, or else the link, beneath a pointer
    const at = places(), here = onPaper(event), near = (event.pointerType === "touch" ? 22 : 11) / scale;
    const points = Object.keys(at).filter(name => !no(name)).map(name => [distance(at[name], here), name]).sort((a, b) => a[0] - b[0]);
    if (points.length && points[0][0] < near) return { point: points[0][1] };
    const links = moving().map(([name, points]) => [fromLink(here, points.map(point => at[point])), name]).sort((a, b) => a[0] - b[0]);
    return links.length && links[0][0] < near ? { link: links[0][1] } : {};
  }

  function fromLink(here, corners) {  // distance of a place from a link's body
    let best = Infinity, inside = false;
    corners.forEach((a, k) => {
      const b = corners[(k + 1) % corners.length], way = [b[0] - a[0], b[1] - a[1]], long = way[0] ** 2 + way[1] ** 2;
      const share = long ? Math.max(0, Math.min(1, ((here[0] - a[0]) * way[0] + (here[1] - a[1]) * way[1]) / long)) : 0;
      best = Math.min(best, distance(here, [a[0] + share * way[0], a[1] + share * way[1]]));
      if (a[1] > here[1] !== b[1] > here[1] && here[0] < a[0] + way[0] * (here[1] - a[1]) / way[1]) inside = !inside;
    });
    return inside && corners.length > 2 ? 0 : best;
  }

  function fit() {
    const all = Object.values(seen.sheet.points).concat(shownPaths().flatMap(name => pairs(seen.paths[name])),
      cams.flatMap(({ pivot, outline }) => pairs(outline).map(place => place.map((x, k) => x + seen.sheet.points[pivot][k]))));
    const [w, h] = size(), xs = all.map(p => p[0]), ys = all.map(p => p[1]);
    if (!all.length) { scale = 4; centre = [0, 0]; return; }
    const low = [Math.min(...xs), Math.min(...ys)], high = [Math.max(...xs), Math.max(...ys)];
    centre = [0, 1].map(k => (low[k] + high[k]) / 2);
    scale = Math.min(w / (high[0] - low[0] + 30), h / (high[1] - low[1] + 30), 12);
  }

  // ---- the picture ----

  const pairs = (flat = []) => Array.from({ length: flat.length / 2 }, (_, k) => [flat[2 * k], flat[2 * k + 1]]).filter(([x]) => x !== null);
  const shownPaths = () => {
    const of = seen.sheet.output.map(row => row.point).filter(Boolean);
    if (picked && picked.point) of.push(picked.point);
    return [...new Set(of)].filter(name => now().paths[name] && !ground().includes(name));
  };
  const escaped = text => String(text).replace(/[&<>"]/g, c => `&#${c.charCodeAt(0)};`);
  const words = (at, text, kind, more = "") => `<text class="${kind}" x="${at[0].toFixed(1)}" y="${at[1].toFixed(1)}" ${more}>${escaped(text)}</text>`;

  function curve(flat) {  // of x, y, x, y, ...; broken where it does not close
    let text = "", pen = "M";
    for (let k = 0; k < flat.length; k += 2) {
      if (flat[k] === null) { pen = "M"; continue; }
      const [x, y] = onScreen([flat[k], flat[k + 1]]);
      text += pen + x.toFixed(1) + " " + y.toFixed(1);
      pen = "L";
    }
    return text;
  }

  function render() {
    const at = places(), to = name => onScreen(at[name] || [NaN, NaN]), [w, h] = size(), out = [];
    const there = name => at[name] && isFinite(at[name][0]), grid = 10 ** Math.ceil(Math.log10(20 / scale)), chosen = picked || {};
    for (const axis of [0, 1]) {
      const half = (axis ? h : w) / 2 / scale;
      for (let k = Math.ceil((centre[axis] - half) / grid); k * grid < centre[axis] + half; k++) {
        const x = onScreen([k * grid, k * grid])[axis];
        out.push(`<path class="grid${k ? "" : " axis"}" d="${axis ? `M0 ${x}H${w}` : `M${x} 0V${h}`}"/>`);
      }
    }
    for (const name of shownPaths()) out.push(`<path class="path${seen.sheet.output.some(row => row.point === name) ? "" : " other"}" d="${curve(now().paths[name])}"/>`);
    for (const row of [...seen.sheet.slide, ...seen.sheet.slot]) {
      const [a, b] = row.along.map(to);
      if (row.along.every(there)) out.push(`<path class="rail" d="M${a}L${b}"/>`);
    }
    const circle = ([x, y], radius, kind) => out.push(`<circle class="${kind}" cx="${x}" cy="${y}" r="${radius * scale}"/>`);
    for (const { a, b, ratio } of seen.sheet.gear) {  // by their pitch circles; inner teeth are not made
      const p = pivotOf(a), q = pivotOf(b);
      if (!p || !q || !there(p) || !there(q) || !(ratio < 0)) continue;
      const far = distance(at[p], at[q]), first = far * -ratio / (1 - ratio);
      circle(to(p), first, "wheel");
      circle(to(q), far - first, "wheel");
    }
    for (const { pivot, outline, angles } of tried ? [] : cams) {
      const turn = turned(angles), [c, s] = [Math.cos(turn), Math.sin(turn)], [x, y] = at[pivot];
      out.push(`<path class="cam" d="${curve(pairs(outline).flatMap(([u, v]) => [x + c * u - s * v, y + s * u + c * v]))}Z"/>`);
    }
    for (const row of seen.sheet.cam) if (row.radius && (row.shape || "roller") === "roller" && there(row.at)) circle(to(row.at), row.radius, "roller");
    moving().forEach(([name, points], k) => {
      if (!points.length || !points.every(there)) return;
      const kind = `link k${k % 6}${name === seen.sheet.drive ? " drives" : ""}${name === chosen.link ? " picked" : ""}`, shape = points.map(to);
      const slides = points.length === 1 && seen.sheet.slide.find(row => row.link === name);
      if (slides && slides.along.every(there)) {
        const [a, b] = slides.along.map(to), turn = Math.atan2(b[1] - a[1], b[0] - a[0]) * 180 / Math.PI, [x, y] = shape[0];
        out.push(`<rect class="${kind}" x="${x - 16}" y="${y - 10}" width="32" height="20" rx="3" transform="rotate(${turn} ${x} ${y})"/>`);
      } else out.push(`<path class="${kind}" d="M${shape.join("L")}${points.length > 2 ? "Z" : ""}"/>`);
      if (name === chosen.link) for (const [a, b, held] of lengths(points)) {
        const p = to(a), q = to(b), value = held ? held[1] : distance(at[a], at[b]);
        out.push(words([(p[0] + q[0]) / 2, (p[1] + q[1]) / 2 - 6], (held ? "= " : "") + Number(value.toFixed(2)), held ? "size held" : "size",
          `data-between="${a} ${b}"`));
      }
      if (name === seen.sheet.drive) {
        const pivot = points.find(point => ground().includes(point));
        if (pivot) out.push(arrow(to(pivot)));
      }
    });
    const driven = pivotOf(seen.sheet.drive);  // its name stands outside the arrow
    for (const name of Object.keys(at).filter(there)) {
      const [x, y] = to(name), still = ground().includes(name);
      if (still) out.push(`<path class="stand" d="M${x} ${y}l-9 15h18zM${x - 13} ${y + 15}h26"/>`);
      const kind = `pin${name === chosen.point ? " picked" : ""}${seen.sheet.output.some(row => row.point === name) ? " output" : ""}`;
      out.push(`<circle class="${kind}" cx="${x}" cy="${y}" r="5"/>`, words([x + (name === driven ? 19 : 9), y - (name === driven ? 17 : 8)], name, "name"));
    }
    for (const { path, text } of now().faults || []) {  // each where it is
      const on = path[0] === "points" ? [path[1]] : path[0] === "links" ? seen.sheet.links[path[1]] : path[0] === "lengths" ? String(path[1]).split("-") : [];
      const of = (on || []).filter(there).map(to);
      if (of.length) out.push(words([of.reduce((s, p) => s + p[0], 0) / of.length + 9, of.reduce((s, p) => s + p[1], 0) / of.length + 18], text, "wrong"));
    }
    if (!now().start) for (const [key, value] of Object.entries(seen.sheet.lengths)) {  // held lengths that the drawing does not have
      const [a, b] = ends(key), drawn = there(a) && there(b) ? distance(at[a], at[b]) : value;
      if (Math.abs(drawn - value) > 0.01 * value) out.push(words([(to(a)[0] + to(b)[0]) / 2 + 9, (to(a)[1] + to(b)[1]) / 2 + 16],
        `${key} = ${value}, drawn ${drawn.toFixed(1)}`, "wrong"));
    }
    out.push(`<path class="scale" d="M16 ${h - 21}v5h${(grid * scale).toFixed(1)}v-5"/>`, words([22 + grid * scale, h - 14], `${grid} mm`, "size scale"));
    if (drag && drag.from) out.push(`<path class="rubber" d="M${onScreen(drag.from)}L${onScreen(drag.to)}"/>`);
    svg.innerHTML = out.join("");
    const said = note || (tried && tried.reason);
    byId("hint").textContent = said || TOOLS.find(each => each[0] === tool)[3];
    byId("hint").className = said ? "wrong" : "";
  }

  const arrow = ([x, y]) => `<path class="turns" d="M${x + 20} ${y}A20 20 0 1 0 ${x} ${y + 20}m-1 -5l1 5l-5 2"/>`;

  function lengths(points) {  // pairs of a link's points, each with the length that is held
    const held = Object.entries(seen.sheet.lengths);
    return points.flatMap((a, k) => points.slice(k + 1).map(b => [a, b,
      held.find(([key]) => ends(key).includes(a) && ends(key).includes(b))]));
  }

  // ---- operations ----

  async function commit(asked, path = "draw") {
    const before = drag, answer = await ask(path, asked);
    if (drag === before) drag = null;  // else the hand is at its next one
    tried = null;
    note = "";
    if (answer.sheet) take(answer);
    else { tell(answer, ""); note = answer.errors.join("; "); }
    render();
    return answer;
  }

  function take(answer) {
    const news = answer.text !== byId("text").textContent;
    seen = answer;
    if (picked && !(picked.point in seen.sheet.points) && !(picked.link in seen.sheet.links)) picked = null;  // it is gone
    const keys = seen.numbers.map(number => number.key).join();
    if (values && values.keys === keys) values.reset(seen.numbers);
    else values = form(seen.numbers, () => attempt({ op: "set", settings: values.settings() }), rested);
    byId("undo").disabled = !seen.undo;
    byId("redo").disabled = !seen.redo;
    byId("save").disabled = !seen.changed;
    byId("text").textContent = seen.text;
    tell({ ok: seen.ok, wanted: seen.wanted, verdict: seen.verdict || seen.wanted || (seen.faults.length ? "not a machine yet"
      : seen.reason ? "does not move as wanted" : "closes over its whole turn"),
      errors: seen.wanted ? [] : [...seen.faults.map(fault => fault.text), ...(seen.reason ? [seen.reason] : [])] }, "");
    document.querySelector("h1").textContent = seen.file;
    panel();
    if (!byId("stage").hidden && news) report();
    if (news) rest();
    else grey();
  }

  async function rested() {
    const settings = values.settings();
    if (Object.keys(settings).length) await commit({ op: "set", settings });
    else { tried = null; note = ""; take(seen); render(); }  // nothing is changed: a box that was cleared has its value again
  }

  async function rest() {  // what takes a moment; the limits when the hand rests
    const of = seen, slow = await ask("idle", {});
    if (of !== seen) return;
    idle = slow.idle || [];
    cams = slow.cams || [];
    grey();
    render();
    await new Promise(done => setTimeout(done, 400));
    if (of !== seen || drag) return;
    const answer = await ask("limits", {});
    if (of === seen && answer.verdict && byId("stage").hidden) tell(answer, "by the design's own limits");
  }

  function grey() {  // keys without effect
    document.querySelectorAll(".number").forEach(line => {
      const none = idle.includes(line.dataset.key);
      line.classList.toggle("idle", none);
      line.title = none ? "no effect: [lengths] say where it is" : "";
    });
  }

  let flying = false, waiting = null, latest = 0;
  async function attempt(asked, stamp = performance.now()) {  // in the page where circles do it; else one request at a time, always the last
    const mine = asked.op === "move" && seen.chain && motion(seen.chain, moved(asked, seen.sheet));
    if (mine && mine.start) { waiting = null; showTry(mine, stamp); return; }
    if (flying) { waiting = [asked, stamp]; return; }
    flying = true;
    const of = seen, answer = await ask("draw", { ...asked, try: true });
    flying = false;
    if (of === seen && (drag || asked.op === "set") && stamp > latest) showTry(answer, stamp);
    if (waiting) { const next = waiting; waiting = null; attempt(...next); }
  }

  function showTry(answer, stamp) {
    if (answer.paths) tried = answer;
    latest = stamp;
    render();
    lags.push(performance.now() - stamp);
    document.body.dataset.tries = lags.length;
  }

  const follows = event => !byId("hold").checked || event.altKey;
  const moves = event => ({ op: "move", points: drag.places, follow: follows(event) });  // what a drag of a point is

  function onCircle(name, place, event, rest) {  // of a point that one length alone holds: about the other end, so that nothing else moves
    const fixed = ground().includes(name);
    const held = follows(event) ? [] : Object.entries(seen.sheet.lengths)
      .map(([key, length]) => [ends(key), length])
      .filter(([pair]) => pair.includes(name) && (!fixed || pair.every(end => ground().includes(end))));
    if (held.length !== 1) return place;
    const [[a, b], length] = held[0], other = a === name ? b : a, pivot = rest[other] || seen.sheet.points[other];
    const far = distance(place, pivot) || 1;
    return place.map((x, k) => pivot[k] + (x - pivot[k]) * length / far);
  }

  // ---- pointers ----

  svg.addEventListener("pointerdown", event => {
    svg.focus({ preventScroll: true });
    svg.setPointerCapture(event.pointerId);
    pointers.set(event.pointerId, event);
    if (pointers.size === 2) { drag = tried = null; return; }
    const label = event.target.dataset.between, what = hit(event);
    if (label) { lock(...label.split(" ")); return; }
    note = "";
    if (Number(byId("turn").value) || playing) {  // what is drawn is the first position
      byId("turn").value = playing = 0;
      byId("play").textContent = "Play";
      render();
      return;
    }
    picked = what.point || what.link ? what : null;
    panel();
    if (tool === "move" && what.point) {
      const still = Object.fromEntries(ground().map(name => [name, seen.sheet.points[name]]));
      drag = { point: what.point, places: {}, still, whole: { ...seen.start, ...still }, pressed: event };
    } else if (tool === "move" || (tool !== "link" && event.button === 1)) drag = { pan: [...centre], pressed: event };
    else if (["ground", "drive", "output", "delete"].includes(tool)) { if (!click(what)) note = missed(event); }
    else if (tool === "link" && drag && drag.from) finish(event);
    else if (tool === "link" || what.point || (what.link && tool !== "slot")) {
      const from = what.point && tool !== "point" ? places()[what.point] : snapped(event);
      drag = { ...what, from, to: from, pressed: event };
    } else note = missed(event);
    render();
  });

  function missed(event) {  // what to say of a press on nothing that the tool takes
    const at = places(), here = onPaper(event);
    if (!moving().length) return seen.wanted;
    const [far, name] = Object.keys(at).map(point => [distance(at[point], here) * scale, point]).sort((a, b) => a[0] - b[0])[0] || [Infinity];
    const taken = { move: "A point", ground: "A point", slot: "A point" }[tool] || "A point or a link";
    return far > 60 ? `${taken} has to be under the press.` : `${taken} has to be under the press: the nearest point, ${name}, is ${Math.round(far)} px away.`;
  }

  const MOVED = "onpointerrawupdate" in svg ? "pointerrawupdate" : "pointermove";  // at once, or with the next frame
  svg.addEventListener(MOVED, event => {
    const before = pointers.get(event.pointerId);
    if (before && pointers.size === 2) { pinch(event); return; }
    if (before) pointers.set(event.pointerId, event);
    if (!drag) return;
    if (drag.pan) centre = [drag.pan[0] - (event.clientX - drag.pressed.clientX) / scale, drag.pan[1] + (event.clientY - drag.pressed.clientY) / scale];
    else if (drag.point && drag.places) {
      const rest = tried && tried.start && !follows(event) ? { ...tried.start, ...drag.still } : drag.whole;  // held, they go on from where they are
      drag.places = Object.fromEntries(Object.entries({ ...rest, [drag.point]: onCircle(drag.point, snapped(event), event, rest) })
        .map(([name, place]) => [name, place.map(x => Math.round(x * 1e4) / 1e4)]));
      attempt(moves(event), event.timeStamp);
      if (seen.start) return;  // drawn with the answer
    } else drag.to = aim(event);
    render();
  });

  function aim(event) {  // where a rubber line ends: at a point, on the grid, nearly level or upright made so
    const what = hit(event, name => tool !== "link" && name === drag.point), place = snapped(event);
    if (what.point && tool !== "slide") return places()[what.point];
    if (tool === "slide") for (const axis of [0, 1]) if (Math.abs(place[axis] - drag.from[axis]) < 0.08 * distance(place, drag.from)) place[axis] = drag.from[axis];
    return place;
  }

  function pinch(event) {
    const [a, b] = [...pointers.values()], before = Math.hypot(a.clientX - b.clientX, a.clientY - b.clientY);
    pointers.set(event.pointerId, event);
    const [c, d] = [...pointers.values()];
    centre = [centre[0] - (c.clientX + d.clientX - a.clientX - b.clientX) / 2 / scale, centre[1] + (c.clientY + d.clientY - a.clientY - b.clientY) / 2 / scale];
    scale *= Math.hypot(c.clientX - d.clientX, c.clientY - d.clientY) / Math.max(before, 1);
    render();
  }

  svg.addEventListener("pointerup", event => {
    pointers.delete(event.pointerId);
    const far = drag && Math.hypot(event.clientX - drag.pressed.clientX, event.clientY - drag.pressed.clientY) > 5;
    if (!drag || drag.pan) {
      if (drag && !far && tool === "move" && !picked && Object.values(places()).some(at => distance(at, onPaper(event)) * scale < 40)) note = missed(event);
      drag = null;
    }
    else if (far) finish(event);
    else if (tool !== "link") drag = null;  // of a link a second click sets the end
    render();
  });
  svg.addEventListener("pointercancel", event => { pointers.delete(event.pointerId); drag = tried = null; render(); });
  svg.addEventListener("wheel", event => {
    event.preventDefault();
    const here = onPaper(event), share = Math.exp(-event.deltaY / 500), was = scale;
    scale = Math.max(0.05, Math.min(200, scale * share));
    centre = centre.map((x, k) => here[k] - (here[k] - x) * was / scale);
    render();
  }, { passive: false });

  async function finish(event) {  // what a drag has come to
    const on = hit(event, name => name === drag.point && tool !== "link"), mine = drag;
    const end = on.point || mine.to;
    if (tool !== "move") drag = null;  // it is done; the answer may take a moment
    if (tool === "move") {
      waiting = null;
      if (on.point && !sameLink(on.point, mine.point)) { await commit({ op: "join", point: mine.point, to: on.point }); return; }
      const last = await ask("draw", { ...moves(event), try: true });
      if (last.start) tried = last;
      const answer = await commit({ ...moves(event), points: changed(mine, event) });
      const before = mine.whole[mine.point];
      if (answer.start && before && !follows(event) && distance(answer.start[mine.point], before) < 0.2 * distance(mine.places[mine.point], before)) {
        note = `${mine.point} is held by lengths: hold Alt while you drag, and they follow`;
        render();
      }
    } else if (tool === "link") {
      const from = mine.point || mine.from;
      if (mine.link) { const first = await commit({ op: "point", link: mine.link, at: mine.from }); await commit({ op: "link", ends: [newest(first), end] }); }
      else {
        const made = await commit({ op: "link", ends: [from, end] });
        if (on.link && !on.point && made.sheet) await commit({ op: "point", link: on.link, at: newest(made) });
      }
    } else if (tool === "point") {
      const link = linkOf(mine);
      if (link) await commit({ op: "point", link, at: end });
      else { drag = null; note = "press on a link, not on the ground"; }
    } else if (tool === "slide") await commit({ op: "slide", ...(mine.point ? { point: mine.point } : { link: mine.link }), 
      along: [mine.from.map((x, k) => short((x + mine.to[k]) / 2)), mine.to.map(short)] });
    else if (tool === "gear" && linkOf(on)) await commit({ op: "gear", a: linkOf(mine), b: linkOf(on) });
    else if (tool === "cam" && on.point) await commit({ op: "cam", cam: linkOf(mine), point: on.point });
    else if (tool === "slot" && on.link) await commit({ op: "slot", point: mine.point, link: on.link });
    else note = `Nothing was drawn: it does not end on a ${{ cam: "point of a follower" }[tool] || "link"}.`;
    if (drag === mine) drag = null;
    render();
  }

  const short = x => Math.round(x * 100) / 100;
  const newest = answer => answer.sheet ? Object.keys(answer.sheet.points).pop() : "";
  const sameLink = (a, b) => Object.values(seen.sheet.links).some(points => points.includes(a) && points.includes(b));

  function changed(mine, event) {  // places that differ from the drawn ones, where they came to rest
    if (follows(event) || !tried || !tried.start) return { [mine.point]: mine.places[mine.point] };
    const rest = { ...tried.start, ...mine.still }, point = ground().includes(mine.point) ? { [mine.point]: mine.places[mine.point] } : {};
    return Object.fromEntries(Object.entries({ ...rest, ...point }).filter(([name, place]) => distance(place, seen.sheet.points[name]) > 0.006));
  }

  function click(what) {  // whether the tool takes it
    const link = tool === "drive" && linkOf(what), some = what.point || what.link;
    if (tool === "ground" ? !what.point : tool === "drive" ? !link : !some) return false;
    commit(tool === "ground" ? { op: "ground", point: what.point } : tool === "drive" ? { op: "drive", link } : { op: tool, ...what });
    return true;
  }

  function lock(a, b) {  // hold a length, or let it follow
    const held = lengths([a, b])[0][2], at = places();
    commit({ op: "length", between: [a, b], value: held ? null : short(distance(at[a], at[b])) });
  }

  // ---- what is picked ----

  function panel() {  // of the sheet where nothing is
    const box = byId("picked"), key = !picked ? "sheet" : picked.point ? "point" : "link", name = picked ? picked[key] : seen.sheet.name;
    const line = (label, ...inputs) => { const row = document.createElement("label"); row.append(label + " ", ...inputs); return row; };
    const input = (type, value, change) => {
      const made = Object.assign(document.createElement("input"), { type });
      if (type === "checkbox") made.checked = value; else made.value = value;
      made.addEventListener("change", () => change(made));
      return made;
    };
    const legend = Object.assign(document.createElement("legend"), { textContent: key });
    const rows = [line(`name of the ${key}`, input("text", name, async made => {
      const to = made.value.trim(), answer = await commit({ op: "rename", ...picked, to });
      if (answer.sheet && picked) { picked = { [key]: to }; panel(); render(); }
    }))];
    if (key === "link") for (const [a, b, held] of lengths(seen.sheet.links[name] || [])) {
      const value = held ? held[1] : short(distance(places()[a], places()[b]));
      rows.push(line(`${a}-${b}`, input("text", value, made => commit({ op: "length", between: [a, b], value: isFinite(made.value) && made.value.trim() ? Number(made.value) : made.value })),
        input("checkbox", Boolean(held), () => lock(a, b)), "held"));
    }
    const button = (label, op) => {
      const made = Object.assign(document.createElement("button"), { type: "button", textContent: label });
      made.addEventListener("click", () => commit({ op, ...picked }));
      return made;
    };
    const shared = Object.values(seen.sheet.links).filter(points => points.includes(name)).length > 1;
    if (key === "point" && shared) rows.push(button("Unpin", "unpin"));
    if (picked) rows.push(button("Delete", "delete"));
    box.replaceChildren(legend, ...rows);
  }

  // ---- buttons and keys ----

  function choose(name) {
    tool = name;
    drag = null;
    note = "";
    document.querySelectorAll("#tools button").forEach(button => button.setAttribute("aria-pressed", button.dataset.tool === name));
    svg.dataset.tool = name;
    view("sheet");
    render();
  }

  function view(name) {
    for (const id of ["sheet", "stage", "text"]) byId(id).toggleAttribute("hidden", id !== name);
    byId("hint").hidden = name !== "sheet";
    document.querySelectorAll("[data-view]").forEach(button => button.setAttribute("aria-pressed", button.dataset.view === name));
  }

  async function report() {
    const answer = await ask("preview", { quick: false });
    show(frame => { frame.srcdoc = answer.page || noReport(answer); });
    tell(answer, answer.wanted ? "" : "by the limits of the design, before any file is made");
  }

  function noReport(answer) {  // why there is none
    const said = Object.assign(document.createElement("p"), { textContent: ["No report yet: " + answer.verdict, ...answer.errors || []].join("\n") });
    said.style = "margin: 2em; white-space: pre-line; color-scheme: light dark; font: 15px system-ui, sans-serif";
    return said.outerHTML;
  }

  function play(time) {
    if (!playing) return;
    if (playing > 1) byId("turn").value = (Number(byId("turn").value) + (time - playing) / 4000) % 1;
    playing = time;
    render();
    requestAnimationFrame(play);
  }
  function playOrStop() {
    playing = playing || !seen.start ? 0 : 1;
    byId("play").textContent = playing ? "Stop" : "Play";
    requestAnimationFrame(play);
  }

  for (const [name, key, label, about] of TOOLS) {
    const button = Object.assign(document.createElement("button"), { type: "button", textContent: label, title: `${about} (${key.toUpperCase()})` });
    button.dataset.tool = name;
    button.addEventListener("click", () => choose(name));
    byId("tools").append(button);
  }
  document.querySelectorAll("[data-view]").forEach(button => button.addEventListener("click", () => {
    view(button.dataset.view);
    if (button.dataset.view === "stage") report(); else take(seen);
    render();
  }));
  byId("undo").addEventListener("click", () => commit({}, "undo"));
  byId("redo").addEventListener("click", () => commit({}, "redo"));
  byId("save").addEventListener("click", () => commit({}, "save"));
  byId("fit").addEventListener("click", () => { fit(); render(); });
  byId("play").addEventListener("click", playOrStop);
  byId("turn").addEventListener("input", render);
  byId("numbers").addEventListener("submit", event => event.preventDefault());
  byId("build").addEventListener("click", async () => {
    const button = byId("build"), began = performance.now();
    button.disabled = true;
    button.textContent = "Building\u2026";
    const answer = await ask("build", {});
    button.disabled = false;
    button.textContent = "Build files";
    tell(answer, answer.folder ? seconds(performance.now() - began) + ", files in " + answer.folder : "");
    if (answer.folder) { view("stage"); show(frame => { frame.src = "out/report.html"; }); }
  });
  document.addEventListener("keydown", event => {
    if (event.target.closest("input:not([type=range]):not([type=checkbox]), select, textarea")) return;
    const key = event.key.toLowerCase(), named = TOOLS.find(each => each[1] === key);
    if (event.ctrlKey || event.metaKey) {
      const path = { z: event.shiftKey ? "redo" : "undo", y: "redo", s: "save" }[key];
      if (path) { event.preventDefault(); commit({}, path); }
      return;
    }
    const way = { arrowleft: [-1, 0], arrowright: [1, 0], arrowup: [0, 1], arrowdown: [0, -1] }[key];
    if (key === "escape") { if (!drag) choose("move"); drag = tried = picked = null; panel(); render(); }
    else if ((key === "delete" || key === "backspace") && picked) commit({ op: "delete", ...picked });
    else if (key === "f") { fit(); render(); }
    else if (key === " " && event.target === svg) playOrStop();
    else if (way && picked && picked.point && event.target === svg) {
      const place = seen.sheet.points[picked.point].map((x, k) => short(x + way[k] * step()));
      commit({ op: "move", points: { [picked.point]: place }, follow: follows(event) });
    } else if (named) choose(named[0]);
    else return;
    event.preventDefault();
  });
  addEventListener("resize", render);
  take(seen);
  choose(moving().length ? "move" : "link");
  fit();
  render();
}

const lags = [];  // ms, from a place of the pointer that the page was told to the picture that follows it
if (byId("sheet")) draw(JSON.parse(byId("data").textContent));
else if (document.body.classList.contains("start")) start();
