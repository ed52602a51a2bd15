// The pages of `camgen explore` and of `camgen watch`: what is shown is the report's own page in a frame. A new one takes the old
// one's place when it is there, at the same angle of the drive and the same place of the page.
"use strict";
const byId = id => document.getElementById(id);
const stage = byId("stage");
let shown = null;

function show(fill) {
  stage.querySelectorAll(".next").forEach(frame => frame.remove());
  const fresh = document.createElement("iframe");
  fresh.className = "next";
  fresh.title = "report";
  fresh.addEventListener("load", () => {
    if (!fresh.isConnected) return;
    if (shown) carry(shown, fresh);
    fresh.className = "";
    if (shown) shown.remove();
    shown = fresh;
    stage.classList.remove("old");
  });
  fill(fresh);
  stage.append(fresh);
}

function carry(from, to) {
  const was = from.contentDocument, is = to.contentDocument, part = name => [was.getElementById(name), is.getElementById(name)];
  const [old, angle] = part("theta"), [before, play] = part("play");
  if (old && angle) {
    angle.value = old.value;
    angle.dispatchEvent(new Event("input"));
    if (before.textContent === "Pause") play.click();
  }
  const open = [...was.querySelectorAll("details")];
  is.querySelectorAll("details").forEach((details, k) => { if (open[k]) details.open = open[k].open; });
  to.contentWindow.scrollTo(0, from.contentWindow.scrollY);
}

const seconds = ms => (ms < 9500 ? (ms / 1000).toFixed(1) : Math.round(ms / 1000)) + " s";

function tell(answer, took) {
  byId("said").className = answer.wanted ? "wanted" : !answer.ok ? "bad" : answer.open ? "open" : "ok";
  byId("verdict").textContent = answer.verdict;
  byId("took").textContent = took;
  byId("errors").replaceChildren(...answer.errors.map(error => {
    const line = document.createElement("li");
    line.textContent = error;
    return line;
  }));
  unfold(false);
}

function unfold(all) {  // of what does not fit all, or its first lines; over the sheet, which stays where it is
  const said = byId("said"), more = byId("more");
  if (!more) return;
  said.classList.toggle("unfolded", all);
  more.textContent = all ? "Show less" : "Show all";
  more.setAttribute("aria-expanded", all);
  more.hidden = !all && said.scrollHeight <= said.clientHeight;
}
if (byId("more")) byId("more").addEventListener("click", () => unfold(!byId("said").classList.contains("unfolded")));

async function ask(path, asked) {
  try {
    const reply = await fetch(path, { method: "POST", headers: { "Content-Type": "application/json" }, body: JSON.stringify(asked) });
    return await reply.json();
  } catch (error) {
    return { ok: false, verdict: "no answer", errors: ["camgen has ended, or it failed: see its terminal"] };
  }
}

// ---- a line for each value; moved() while one changes, rested() when it has ----

function form(numbers, moved, rested = () => {}) {
  const boxes = new Map(), tables = new Map();
  const plain = value => typeof value === "number" ? String(value) : value === true ? "true" : value === false ? "false" : value;
  const settings = () => Object.fromEntries(numbers.filter(n => boxes.get(n.key).value.trim() !== plain(n.value))
    .map(n => [n.key, boxes.get(n.key).value.trim()]).filter(([, text]) => text !== ""));

  for (const number of numbers) {
    const at = number.key.lastIndexOf("."), point = /^points\.(.+)\.([01])$/.exec(number.key);  // of a linkage: its x, its y
    const table = point ? "points" : at < 0 ? "" : number.key.slice(0, at).replace(/(\.at|\.\d+)+$/, "") || number.key.slice(0, at);
    if (!tables.has(table)) {
      const details = document.createElement("details"), summary = document.createElement("summary");
      details.open = tables.size < 12;
      summary.textContent = table || "spec";
      const lines = document.createElement("div");
      if (point) { summary.append(Object.assign(document.createElement("small"), { textContent: ", mm" })); lines.className = "points"; }
      details.append(summary, lines);
      tables.set(table, details);
    }
    const line = document.createElement("div"), label = document.createElement("label");
    const box = document.createElement(number.choices.length ? "select" : "input"), id = "box-" + boxes.size;
    line.className = "number";
    line.dataset.key = number.key;
    label.htmlFor = box.id = id;
    label.textContent = (point ? point[1] + " " + "xy"[point[2]] : number.key.slice(table ? table.length + 1 : 0)) + " ";
    label.title = number.about;
    if (number.unit && !point) label.append(Object.assign(document.createElement("small"), { textContent: number.unit }));
    line.append(label, box);
    if (number.choices.length) box.append(...number.choices.map(choice => new Option(choice, choice)));
    else {
      const range = Object.assign(document.createElement("input"), { type: "range", min: number.low, max: number.high, step: "any" });
      const digits = Math.max(0, -Math.floor(Math.log10(number.step) + 1e-9));
      box.type = "text";
      box.inputMode = "decimal";
      range.setAttribute("aria-label", number.key);
      range.addEventListener("input", () => {
        const value = Math.round(range.value / number.step) * number.step;
        box.value = String(Number(Math.min(number.high, Math.max(number.low, value)).toFixed(digits)));
        moved();
      });
      range.addEventListener("keydown", event => {  // one step of the value, ten with shift
        const way = { ArrowLeft: -1, ArrowDown: -1, ArrowRight: 1, ArrowUp: 1 }[event.key];
        if (!way) return;
        event.preventDefault();
        range.value = Number(range.value) + way * number.step * (event.shiftKey ? 10 : 1);
        range.dispatchEvent(new Event("input"));
      });
      range.addEventListener("change", () => rested());
      box.range = range;
      line.append(range);
    }
    box.addEventListener("input", () => { follow(box); moved(); });
    box.addEventListener("change", () => rested());
    boxes.set(number.key, box);
    tables.get(table).lastChild.append(line);
  }
  byId("tables").replaceChildren(...tables.values());

  function follow(box) {  // the slider goes where the text is, and further than before if it must
    const value = Number(box.value);
    if (!box.range || box.value.trim() === "" || !isFinite(value)) return;
    box.range.min = Math.min(box.low, value);
    box.range.max = Math.max(box.high, value);
    box.range.value = value;
  }
  function reset(values = numbers) {  // values: other ones of the same keys
    numbers = values;
    for (const number of numbers) {
      const box = boxes.get(number.key);
      [box.low, box.high] = [number.low, number.high];
      box.value = plain(number.value);
      follow(box);
    }
  }
  byId("find").oninput = () => {
    const words = byId("find").value.toLowerCase().split(/\s+/).filter(Boolean);
    for (const details of tables.values()) {
      let some = false;
      details.querySelectorAll(".number").forEach(line => {
        line.hidden = !words.every(word => line.dataset.key.toLowerCase().includes(word));
        some = some || !line.hidden;
      });
      details.hidden = !some;
      if (words.length && some) details.open = true;
    }
  };
  reset();
  return { settings, reset, keys: numbers.map(number => number.key).join() };
}

// ---- explore: what the values make ----

function explore(numbers) {
  const values = form(numbers, () => moved()), settings = values.settings;

  // One request in flight; what moves meanwhile is asked for again after it. Where the whole answer takes long, a quick one
  // comes while values move, and the whole when they rest; at first the quick one too, for its verdict and picture.
  let busy = false, again = false, whole = Infinity;
  async function answered(quick) {
    const began = performance.now(), answer = await ask("preview", { settings: settings(), quick }), took = performance.now() - began;
    if (!quick) whole = took;
    byId("note").hidden = false;
    if (answer.page) show(frame => { frame.srcdoc = answer.page; });
    else stage.classList.add("old");
    tell(answer, Math.round(took) + " ms" + (quick ? ", curves follow" : ""));
    document.body.dataset.answers = Number(document.body.dataset.answers || 0) + 1;
  }
  async function moved() {
    const changed = settings();
    byId("save").disabled = byId("undo").disabled = !Object.keys(changed).length;
    document.querySelectorAll(".number").forEach(line => line.classList.toggle("changed", line.dataset.key in changed));
    if (busy) { again = true; return; }
    busy = true;
    do {
      again = false;
      const quick = whole > 350;
      await answered(quick);
      if (quick && !again) {
        for (let k = 0; k < 20 && isFinite(whole) && !again; k++) await new Promise(done => setTimeout(done, 20));
        if (!again) await answered(false);
      }
    } while (again);
    busy = false;
  }

  byId("undo").addEventListener("click", () => { values.reset(); moved(); });
  byId("numbers").addEventListener("submit", event => event.preventDefault());
  byId("save").addEventListener("click", async () => {
    const saved = settings(), answer = await ask("save", { settings: saved });
    if (answer.ok) {
      numbers.forEach(n => { if (n.key in saved) n.value = saved[n.key]; });
      await moved();
    }
    tell(answer, "");
  });
  byId("build").addEventListener("click", async () => {
    const button = byId("build"), began = performance.now();
    button.disabled = true;
    button.textContent = "Building\u2026";
    const answer = await ask("build", { settings: settings() });
    button.disabled = false;
    button.textContent = "Build files";
    tell(answer, answer.folder ? seconds(performance.now() - began) + ", files in " + answer.folder : "");
    byId("note").hidden = Boolean(answer.folder);
    if (answer.folder) show(frame => { frame.src = "out/report.html"; });
  });
  moved();
}

// ---- watch: a new report when there is one ----

async function watch() {
  let number = 0;
  for (;;) {
    const state = await ask("state", {});
    if (state.building) tell({ ok: true, verdict: "building\u2026", errors: [] }, "");
    else if (state.number !== number) {
      number = state.number;
      if (state.folder) show(frame => { frame.src = "out/report.html?" + number; });
      else stage.classList.add("old");
      tell(state, state.folder ? "files in " + state.folder : "");
    } else if (state.verdict === "no answer") tell(state, "");
    if (number) document.body.dataset.number = number;
    await new Promise(done => setTimeout(done, 300));
  }
}

if (document.body.classList.contains("watch")) watch();
else if (byId("save") && !byId("sheet")) explore(JSON.parse(byId("data").textContent));
