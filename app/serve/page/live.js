// SPDX-License-Identifier: MIT
// The live page: two documents at each new result, and twice a second what goes on meanwhile.
(() => {
"use strict";

const kShownS = 20, kHeight = 280, kFont = "13px Helvetica, Arial, sans-serif";
const kSilentMs = 5000, kAgainMs = 2000;
const byId = id => document.getElementById(id);
const style = getComputedStyle(document.documentElement);
const colour = name => style.getPropertyValue("--" + name).trim();
const faint = (ink, share) => colour(ink) + Math.round(255 * share).toString(16).padStart(2, "0");
const isNumber = v => typeof v === "number" && isFinite(v);
const words = name => String(name).replaceAll("_", " ");

// The token came with the address; the cookie has it from now on, and the address need not show it.
if (location.search) history.replaceState(null, "", location.pathname + location.hash);

function make(tag, text, more) {
  const out = Object.assign(document.createElement(tag), more);
  if (text !== undefined) out.textContent = text;
  return out;
}

// A number with two digits of its deviation, as everywhere in the project.
function quantity(value, std, unit) {
  if (!isNumber(value)) return "not known";
  let factor = 1, name = unit;
  if (unit === "N" && Math.abs(value) >= 2e3) [factor, name] = [1e-3, "kN"];
  if (unit === "m/s") [factor, name] = [1e3, "mm/s"];
  if (unit === "N/m" && Math.abs(value) >= 1e5) [factor, name] = [1e-6, "MN/m"];
  const v = value * factor, s = std * factor;
  if (!(s > 0)) return Number(v.toPrecision(4)) + " " + name;
  const digits = Math.min(Math.max(1 - Math.floor(Math.log10(s)), 0), 9);
  return v.toFixed(digits) + " ± " + s.toFixed(digits) + " " + name;
}
function duration(s) {
  if (!isNumber(s)) return "";
  const whole = Math.floor(s), h = Math.floor(whole / 3600), m = Math.floor(whole / 60) % 60;
  const two = n => String(n).padStart(2, "0");
  return (h ? h + ":" + two(m) : m) + ":" + two(whole % 60);
}
function bytes(count) {
  const k = count > 0 ? Math.min(Math.floor(Math.log2(count) / 10), 4) : 0;
  return Number((count / 2 ** (10 * k)).toPrecision(3)) + " " + ["B", "KiB", "MiB", "GiB", "TiB"][k];
}
const count = n => String(n).replace(/\B(?=(\d{3})+$)/g, "\u202f");

// ---- plots ----

const plots = new Map();

function axis(label, isY) {
  const lines = {stroke: () => colour("line"), width: 1};
  return {label, labelSize: 20, labelFont: kFont, font: kFont, stroke: () => colour("ink"), grid: lines, ticks: lines,
          size: isY ? (u, values) => 22 + 8 * Math.max(...(values || [""]).map(v => v.length)) : 34,
          values: (u, splits) => splits.map(v => v === null ? "" : String(Number(v.toPrecision(6))))};
}

// One line, and where `band` is set the two edges of its band.
function makePlot(box, title, x, y, ink, band) {
  const read = v => isNumber(v) ? String(Number(v.toPrecision(4))) : "";
  const line = {label: y, class: "named", stroke: () => colour(ink), width: 2, points: {show: false},
                value: (u, v) => read(v)};
  const edge = {label: "", class: "unnamed", stroke: "transparent", points: {show: false}};
  const options = {
    width: box.clientWidth, height: kHeight,
    scales: {x: {time: false}},
    series: [{label: x, value: (u, v) => read(v)}, line, ...(band ? [edge, {...edge}] : [])],
    bands: band ? [{series: [2, 3], fill: () => faint(ink, 0.25)}] : [],
    axes: [axis(x, false), axis(y, true)], legend: {live: true}, cursor: {y: false}};
  const u = new uPlot(options, [[], ...options.series.slice(1).map(() => [])], box);
  box.tabIndex = 0;
  box.setAttribute("role", "group");
  box.setAttribute("aria-label", title + ". Arrow keys read values, 0 shows all.");
  u.root.querySelector(".u-legend").setAttribute("aria-live", "polite");
  box.addEventListener("keydown", event => {
    const step = {ArrowLeft: -1, ArrowRight: 1}[event.key];
    if (event.key === "0" || event.key === "Escape") u.setData(u.data, true);
    if (!step || event.ctrlKey || event.metaKey || event.altKey) return;
    event.preventDefault();
    const width = u.over.clientWidth, at = u.cursor.left >= 0 ? u.cursor.left : width / 2;
    u.setCursor({left: Math.min(Math.max(at + step * (event.shiftKey ? 40 : 8), 0), width - 1), top: 1});
  });
  u.hooks.setSelect = [() => { u.enlarged = true; }];
  u.over.addEventListener("dblclick", () => { u.enlarged = false; });
  new ResizeObserver(() => {
    if (box.clientWidth && box.clientWidth !== u.width) u.setSize({width: box.clientWidth, height: kHeight});
  }).observe(box);
  return u;
}

function draw(id, title, x, y, ink, data) {
  const box = byId(id), empty = data[0].length === 0;
  box.classList.toggle("empty", empty);
  if (empty && !plots.has(id)) return;
  if (!plots.has(id)) plots.set(id, makePlot(box, title, x, y, ink, data.length > 2));
  const u = plots.get(id);
  u.setData(data, !u.enlarged);
  if (u.enlarged) u.redraw();
}

const scaled = (list, factor) => list.map(v => isNumber(v) ? v * factor : null);
const banded = (values, stds, factor) =>
  [scaled(values, factor), values.map((v, i) => (v + 2 * stds[i]) * factor), values.map((v, i) => (v - 2 * stds[i]) * factor)];

function drawCurve(curve) {
  const x = [], at = [];
  curve.velocity_mps.forEach((v, i) => {  // a jump is two rows at one place: a hair apart
    const place = v * 1e3;
    x.push(x.length && place <= x[x.length - 1] ? x[x.length - 1] + 1e-6 : place);
    at.push(i);
  });
  const factor = Math.max(0, ...curve.force_n.map(Math.abs)) >= 2e3 ? 1e-3 : 1;
  draw("plot-curve", "Friction over velocity with its band", "velocity, mm/s",
       "force, " + (factor === 1 ? "N" : "kN"), "blue", [x, ...banded(curve.force_n, curve.std_n, factor)]);
}

function drawHistory(h) {
  draw("plot-level", "Level of friction over time with its band", "time, s", "level, kN", "blue",
       [h.time_s, ...banded(h.coulomb_n, h.coulomb_std_n, 1e-3)]);
  draw("plot-stiffness", "Stiffness over time with its band", "time, s", "stiffness, MN/m", "green",
       [h.time_s, ...banded(h.stiffness_npm, h.stiffness_std_npm, 1e-6)]);
}

function drawDensities(list) {
  const [y, v] = list.length === 2 ? list : [{place: [], density: []}, {place: [], density: []}];
  draw("plot-density-y", "Density of the deflection", "deflection, mm", "density, 1/mm", "blue",
       [scaled(y.place, 1e3), scaled(y.density, 1e-3)]);
  draw("plot-density-v", "Density of the velocity", "velocity, mm/s", "density, s/mm", "green",
       [scaled(v.place, 1e3), scaled(v.density, 1e-3)]);
}

// ---- motion ----

const motion = {t: [], y: [], v: []};

// `anew`: after a connection was made; else what is known already is passed over.
function takeMotion(more, anew) {
  const known = anew || !motion.t.length ? -Infinity : motion.t[motion.t.length - 1];
  const first = more.t.findIndex(t => t > known);
  for (const key of ["t", "y", "v"]) {
    const fresh = first < 0 ? [] : more[key].slice(first);
    motion[key] = anew ? fresh : motion[key].concat(fresh);
  }
  const last = motion.t[motion.t.length - 1];
  const from = motion.t.findIndex(t => t >= last - kShownS);
  if (from > 0) for (const key of ["t", "y", "v"]) motion[key] = motion[key].slice(from);
  draw("plot-deflection", "Deflection of the newest 20 s", "time, s", "deflection, mm", "blue",
       [motion.t, scaled(motion.y, 1e3)]);
  draw("plot-velocity", "Velocity of the newest 20 s", "time, s", "velocity, mm/s", "green",
       [motion.t, scaled(motion.v, 1e3)]);
}

// ---- planes ----

const kUnits = {deflection_m: ["deflection", "mm", 1e3], velocity_mps: ["velocity", "mm/s", 1e3],
                acceleration_mps2: ["acceleration", "m/s²", 1]};
const range = ([low, high], [name, unit, factor]) =>
  `${name} ${Number((low * factor).toPrecision(2))} to ${Number((high * factor).toPrecision(2))} ${unit}`;

// The cells that hold something, and two beyond, of each axis.
function occupied(shades, n) {
  const box = [[n, 0], [n, 0]];
  for (let c = 0; c < shades.length; ++c) {
    if (shades.charCodeAt(c) === 0) continue;
    [Math.floor(c / n), c % n].forEach((at, k) => {
      box[k] = [Math.min(box[k][0], at), Math.max(box[k][1], at)];
    });
  }
  return box.map(([first, last]) => first > last ? [0, n - 1] : [Math.max(first - 2, 0), Math.min(last + 2, n - 1)]);
}

function drawPlane(plane, k) {
  const canvas = byId("plane-" + k), n = plane.cells, ctx = canvas.getContext("2d");
  const x = kUnits[plane.x], y = kUnits[plane.y], shades = atob(plane.shades);
  const [across, up] = occupied(shades, n);
  const place = ([low, high], cell) => low + (high - low) * cell / n;
  const shown = (all, [first, last]) => [place(all, first), place(all, last + 1)];
  const text = plane.shades ? `across: ${range(shown(plane.x_range, across), x)}; up: ${range(shown(plane.y_range, up), y)}` : "not enough motion yet";
  canvas.nextElementSibling.textContent = text;
  canvas.setAttribute("aria-label", `Density of ${y[0]} over ${x[0]}; ${text}`);
  canvas.width = across[1] - across[0] + 1;
  canvas.height = up[1] - up[0] + 1;
  const ink = colour("blue"), image = ctx.createImageData(canvas.width, canvas.height);
  const [r, g, b] = [1, 3, 5].map(i => parseInt(ink.slice(i, i + 2), 16));
  if (shades)
    for (let i = across[0]; i <= across[1]; ++i)
      for (let j = up[0]; j <= up[1]; ++j)
        image.data.set([r, g, b, shades.charCodeAt(i * n + j)], 4 * ((i - across[0]) + (up[1] - j) * canvas.width));
  ctx.putImageData(image, 0, 0);
}

// ---- words and tables ----

const kTrust = {trusted: "trusted", model_incomplete: "the model is incomplete", data_faulty: "the data are faulty",
                not_identified: "nothing is identified"};

function showAnswer(live) {
  const list = [];
  const tile = (name, value, remark) => {
    const box = make("div");
    box.append(make("dt", name), make("dd", value, {className: "value"}), make("dd", remark || ""));
    list.push(box);
  };
  for (const p of live.parameters) {
    tile(words(p.name), quantity(p.value, p.std, p.unit), live.std_is_lower_bound ? "the deviation is a lower bound" : "");
    const value = list[list.length - 1].querySelector(".value");
    Object.assign(value.dataset, {name: p.name, value: p.value, std: p.std, unit: p.unit});
  }
  tile("trust", kTrust[live.trust] || words(live.trust), live.trust_reasons.join(" "));
  byId("answer").replaceChildren(...list);
  byId("answer").dataset.trust = live.trust;
}

function showExplanation(found, age_s) {
  const box = byId("explanation");
  if (!found) return box.replaceChildren(make("p", "No judgement yet: it comes with the first minutes of motion.", {className: "note"}));
  const out = [make("p", {complete: "Nothing: the model explains what is measured.", explained: "What was missing is found:",
                          partly_explained: "Part of what is missing is found:",
                          unexplained: "Something real is left that no candidate explains."}[found.verdict] || words(found.verdict))];
  if (found.steps && found.steps.length) {
    const rows = make("ol");
    for (const s of found.steps)
      rows.append(make("li", `${words(s.effect)}: held-out error ${(100 * s.held_out_nmse_before).toPrecision(3)} % before, ` +
        `${(100 * s.held_out_nmse_after).toPrecision(3)} % after` +
        (s.parameters || []).map(p => `; ${words(p.name)} ${quantity(p.value, p.std, p.unit)}`).join("")));
    out.push(rows);
  }
  const told = [`Its trust: ${kTrust[found.trust] || words(found.trust)}`];
  if (isNumber(found.left_over_floor))
    told.push(`left: ${Number(found.left_over_floor.toPrecision(3))} times what sensors and rounding alone leave`);
  if (isNumber(age_s)) told.push(`of ${Math.round(age_s)} s ago`);
  out.push(make("p", told.join("; ") + ".", {className: "note"}));
  box.replaceChildren(...out);
  box.dataset.verdict = found.verdict;
}

function lane(name, marks, end_s) {
  const out = make("div", undefined, {className: "lane"});
  const svg = document.createElementNS("http://www.w3.org/2000/svg", "svg");
  svg.setAttribute("viewBox", "0 0 1000 10");
  svg.setAttribute("preserveAspectRatio", "none");
  svg.setAttribute("role", "img");
  svg.setAttribute("aria-label", name + " at " + marks.slice(0, 20).map(m => duration(m[0])).join(", "));
  for (const [from, to, kind] of marks) {
    const box = document.createElementNS("http://www.w3.org/2000/svg", "rect");
    const x = 1000 * Math.max(from, 0) / end_s;
    const values = {x, y: 1, height: 8, width: Math.max(1000 * (to - from) / end_s, 3), class: kind};
    for (const [key, value] of Object.entries(values)) box.setAttribute(key, value);
    svg.append(box);
  }
  out.append(make("span", name), svg);
  return out;
}

function showHappened(live, view) {
  const end_s = Math.max(view.duration_s || 0, ...view.events.map(e => e.time_s), 1);
  const lanes = [];
  for (const f of live.faults || []) {
    const spans = f.spoilt_s && f.spoilt_s.length ? f.spoilt_s : [[f.time_s, f.last_s]];
    lanes.push(lane(`${words(f.name)} (${f.channel})`, spans.map(([a, b]) => [a, b, "fault"]), end_s));
  }
  const names = [...new Set(view.events.map(e => e.name))];
  for (const name of names)
    lanes.push(lane(words(name), view.events.filter(e => e.name === name).map(e => [e.time_s, e.time_s, "event"]), end_s));
  if (!lanes.length) return byId("lanes").replaceChildren(make("p", "None.", {className: "note"}));
  const ends = make("div", undefined, {className: "lane"}), line = make("span", undefined, {className: "end"});
  line.append(make("span", "0:00"), make("span", duration(end_s)));
  ends.append(make("span"), line);
  byId("lanes").replaceChildren(...lanes, ends);
}

function showFigures(live) {
  const c = live.counts, f = live.live || {}, late = f.lateness_us || {};
  const ms = us => isNumber(us) ? Number((us / 1e3).toPrecision(3)) + " ms" : "";
  const rows = [["frames", count(c.frames || 0), "frames"], ["of them used", count(c.frames_processed || 0), "frames_processed"],
    ["dropped by the kernel", count(c.frames_dropped || 0), "frames_dropped"],
    ["missing", count(c.frames_missing || 0), "frames_missing"], ["left out", count(c.frames_excluded || 0), "frames_excluded"]];
  if (late.max > 0) rows.push(  // a record has none
    ["lateness, median", ms(late.p50)], ["lateness, 99.9 %", ms(late["p99.9"])], ["lateness, largest", ms(late.max)],
    ["samples late by more than a period", count(f.cycle_slips || 0)],
    ["black box", f.recording ? bytes(f.recorded_bytes) + " written" : "not written"],
    ["records lost", count(f.records_lost || 0)]);
  for (const w of live.watched || [])
    rows.push(["alarm " + words(w.name), (w.active ? "raised" : "quiet") +
      (isNumber(w.value) ? `, ${quantity(w.value, 0, w.unit)}` : "") + (isNumber(w.limit) ? ` against ${quantity(w.limit, 0, w.unit)}` : "")]);
  byId("figures").tBodies[0].replaceChildren(...rows.map(([name, value, key]) => {
    const row = make("tr"), cell = make("td", value, {className: "number"});
    if (key) cell.dataset.count = key;
    row.append(make("th", name, {scope: "row"}), cell);
    return row;
  }));
}

function show(live, view) {
  if (!live.parameters) return;
  byId("whose").textContent = [live.vehicle, live.truck && "truck " + live.truck, live.source].filter(Boolean).join(" · ");
  byId("headline").textContent = live.headline;
  byId("warnings").replaceChildren(...live.warnings.map(w => make("p", w, {className: "warning"})));
  showAnswer(live);
  showExplanation(live.explanation, live.live && live.live.explanation_age_s);
  showFigures(live);
  showHappened(live, view);
  drawCurve(view.curve);
  drawHistory(view.history);
  drawDensities(view.densities);
  view.planes.forEach(drawPlane);
  document.documentElement.dataset.sequence = view.sequence;
}

// ---- the connection ----

let source = null, heard = 0, shown = -1, fetching = false, fresh = true, newest = null;

function badge(state) {
  const at = byId("state");
  at.textContent = words(state);
  at.className = "badge " + state;
}

async function update(sequence) {
  if (fetching || sequence === shown) return;
  fetching = true;
  try {
    const [live, view] = await Promise.all(["live.json", "view.json"].map(async name => {
      const answer = await fetch(name, {cache: "no-store"});
      if (!answer.ok) throw new Error(name + ": " + answer.status);
      return answer.json();
    }));
    newest = [live, view];
    show(live, view);
    shown = sequence;
  } catch (error) {  // tried again with the next event
    console.warn(error);
  } finally {
    fetching = false;
  }
}

function takeNow(now) {
  heard = performance.now();
  badge(now.state);
  byId("link").textContent = "";
  byId("clock").textContent = duration(now.record_s) + " of record" +
    (now.silence_s > 2 ? `, silent for ${duration(now.silence_s)}` : "");
  const c = now.collecting, box = byId("collecting");
  box.hidden = !c;
  if (c) {
    byId("collected").textContent = `collecting: ${Math.floor(c.have_s)} of ${Math.round(c.need_s)} s`;
    byId("progress").value = Math.min(c.have_s / c.need_s, 1);
  }
  byId("raised").replaceChildren(...now.raised.map(name => make("p", "Alarm: " + words(name), {className: "warning"})));
  byId("behind").textContent = now.shown_s > 0 && now.state !== "ended" ?
    `${Math.max(0, now.record_s - now.shown_s).toFixed(0)} s behind the bus: so long the guards take to judge a sample.` : "";
  takeMotion(now.motion, fresh);
  fresh = false;
  update(now.sequence);
}

function connect() {
  if (source) source.close();
  fresh = true;
  shown = -1;
  heard = performance.now();
  source = new EventSource("events");
  source.addEventListener("now", event => takeNow(JSON.parse(event.data)));
}

// What neither ends nor speaks, and what the browser has given up, is begun anew.
setInterval(() => {
  if (performance.now() - heard < kSilentMs && source.readyState !== EventSource.CLOSED) return;
  badge("lost");
  byId("link").textContent = "The connection is lost; it is tried again.";
  connect();
}, kAgainMs);

matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => {
  for (const u of plots.values()) u.redraw(false, true);
  if (newest) newest[1].planes.forEach(drawPlane);
});
connect();
})();
