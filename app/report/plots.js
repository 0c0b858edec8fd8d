// SPDX-License-Identifier: MIT
// Makes of each drawing of the page a plot that can be enlarged and read. The numbers stand beside
// the drawing, as Panel::data() writes them; the drawing stays for paper and for whom scripts are off.
(() => {
"use strict";

const kAxisText = 20, kLane = 42, kLaneTop = 29, kFont = "13px Helvetica, Arial, sans-serif";
const style = getComputedStyle(document.documentElement);  // follows a change to dark
const colour = name => style.getPropertyValue("--" + name).trim();
const faint = (ink, opacity) =>
  colour(ink) + Math.round(255 * opacity).toString(16).padStart(2, "0");
const isNumber = v => typeof v === "number";

// A number with the digits that a step of the axis can tell.
function digitsOf(range) {
  return Math.min(Math.max(2 - Math.floor(Math.log10(range)), 0), 9);
}
function read(value, range) {
  return isNumber(value) ? value.toFixed(digitsOf(range)) : "";
}
function power(value) {
  const exponent = Math.log10(value);
  if (Math.abs(exponent) < 3 || Math.abs(exponent - Math.round(exponent)) > 1e-6) return String(Number(value.toPrecision(3)));
  const digits = "⁰¹²³⁴⁵⁶⁷⁸⁹";
  const text = [...String(Math.abs(Math.round(exponent)))].map(d => digits[d]).join("");
  return "10" + (exponent < 0 ? "⁻" : "") + text;
}

// The columns of a mark that is a function of x, or null. A break is a point without a value half
// way between its neighbours; of two points at one place the second lies a hair behind the first.
function columnsOf(mark) {
  if (mark.shape === "boxes") return boxColumns(mark.corners);
  const xs = [], ys = mark.shape === "band" ? [[], []] : [[]];
  const given = mark.shape === "band" ? [mark.high, mark.low] : [mark.y];
  const hair = 1e-9 * (Math.abs(mark.x[mark.x.length - 1] - mark.x[0]) || 1);
  for (let i = 0; i < mark.x.length; ++i) {
    let x = mark.x[i];
    const last = xs.length ? xs[xs.length - 1] : -Infinity;
    if (!isNumber(x)) {
      const next = mark.x[i + 1];
      if (!xs.length || !isNumber(next)) continue;
      x = (last + next) / 2;
    }
    if (x < last) return null;
    if (x <= last) x = last + hair;
    xs.push(x);
    given.forEach((of, k) => ys[k].push(isNumber(mark.x[i]) ? of[i] : null));
  }
  return [xs, ...ys];
}

// Bars beside each other: their middles and heights. Anything else is no function.
function boxColumns(c) {
  const xs = [], ys = [];
  for (let i = 0; i + 3 < c.length; i += 4) {
    if (![c[i], c[i + 1], c[i + 2], c[i + 3]].every(isNumber)) continue;
    const middle = (c[i] + c[i + 2]) / 2;
    if (xs.length && (middle <= xs[xs.length - 1] || c[i + 1] !== c[1])) return null;
    xs.push(middle);
    ys.push(c[i + 3]);
  }
  return [xs, ys];
}

// One table of all marks, with a series for each column; `drawn` are the marks that are drawn here
// and not by uPlot, with the series that shows and hides them.
function arrange(spec) {
  const tables = [], series = [{}], bands = [], drawn = [];
  const add = (name, ink, more) => series.push(
    {label: name || "", class: name ? "named" : "unnamed", ink, points: {show: false}, ...more}) - 1;
  const none = () => null, place = [[spec.x.low], [undefined]];
  for (const mark of spec.marks) {
    const stroke = () => colour(mark.ink);
    const columns = spec.lanes.length ? null : columnsOf(mark);
    tables.push(columns || place);
    if (!columns || mark.shape === "boxes") {
      drawn.push({mark, series: add(mark.name, mark.ink, {stroke, paths: none})});
    } else if (mark.shape === "band") {
      const high = add(mark.name, mark.ink, {stroke: "transparent"});
      bands.push({series: [high, high + 1], fill: () => faint(mark.ink, mark.opacity)});
      add("", mark.ink, {stroke: "transparent"});
    } else if (mark.shape === "dots") {
      const points = {show: true, size: Math.max(mark.width, 2), fill: stroke, width: 0};
      add(mark.name, mark.ink, {stroke, paths: none, points});
    } else {
      add(mark.name, mark.ink,
          {stroke, width: mark.width, dash: mark.dashed ? [6, 4] : undefined});
    }
  }
  if (spec.zone && spec.zone[2]) {
    tables.push(place);
    drawn.push({mark: {shape: "zone"}, series: add(spec.zone[2], "grey", {paths: none})});
  }
  return {data: tables.length ? uPlot.join(tables) : [[]], series, bands, drawn};
}

function eachBox(u, c, visit) {
  const least = devicePixelRatio;
  for (let i = 0; i + 3 < c.length; i += 4) {
    if (![c[i], c[i + 1], c[i + 2], c[i + 3]].every(isNumber)) continue;
    const x = u.valToPos(c[i], "x", true), y = u.valToPos(c[i + 1], "y", true);
    const width = Math.max(u.valToPos(c[i + 2], "x", true) - x, least);
    visit(x, y, width, u.valToPos(c[i + 3], "y", true) - y);
  }
}

function drawMark(u, mark) {
  const ctx = u.ctx;
  ctx.fillStyle = faint(mark.ink, mark.opacity);
  if (mark.shape === "boxes")
    return eachBox(u, mark.corners, (x, y, w, h) => ctx.fillRect(x, y, w, h));
  ctx.strokeStyle = colour(mark.ink);
  ctx.lineWidth = mark.width * devicePixelRatio;
  ctx.setLineDash(mark.dashed ? [6 * devicePixelRatio, 4 * devicePixelRatio] : []);
  ctx.lineCap = mark.shape === "dots" ? "round" : "butt";
  ctx.beginPath();
  let joined = false;
  for (let i = 0; i < mark.x.length; ++i) {
    const good = isNumber(mark.x[i]) && isNumber(mark.y[i]);
    if (good) {
      const x = u.valToPos(mark.x[i], "x", true), y = u.valToPos(mark.y[i], "y", true);
      joined && mark.shape === "line" ? ctx.lineTo(x, y) : ctx.moveTo(x, y);
      if (mark.shape === "dots") ctx.lineTo(x, y);
    }
    joined = good;
  }
  ctx.stroke();
}

function clipped(u, draw) {
  const ctx = u.ctx, {left, top, width, height} = u.bbox;
  ctx.save();
  ctx.beginPath();
  ctx.rect(left, top, width, height);
  ctx.clip();
  draw(ctx);
  ctx.restore();
}

function drawBehind(u, spec, drawn) {
  clipped(u, ctx => {
    // Below the rest.
    if (spec.zone && isNumber(spec.zone[0]) && isNumber(spec.zone[1])) {
      const from = u.valToPos(spec.zone[0], "x", true), to = u.valToPos(spec.zone[1], "x", true);
      ctx.fillStyle = faint("grey", 0.18);
      ctx.fillRect(from, u.bbox.top, to - from, u.bbox.height);
    }
    for (const d of drawn) if (d.mark.shape !== "zone" && u.series[d.series].show) drawMark(u, d.mark);
  });
}

function drawTexts(u, spec) {
  clipped(u, ctx => {
    const dpr = devicePixelRatio, {left, top, width, height} = u.bbox;
    ctx.font = kFont.replace("13px", 13 * dpr + "px");
    ctx.textBaseline = "middle";
    const write = (text, x, y, align) => {
      ctx.textAlign = align;
      ctx.fillStyle = colour("ink");
      ctx.fillText(text, x, y);
    };
    spec.lanes.forEach(([name, note], i) => {
      const y = top + (10 + i * kLane) * dpr;
      write(name, left + 4 * dpr, y, "left");
      write(note, left + width - 4 * dpr, y, "right");
    });
    for (const [at, share, name] of spec.flags) {
      const x = u.valToPos(at, "x", true), y = top + height * (1 - share);
      ctx.fillStyle = colour("orange");
      ctx.fillRect(x, y, 1.5 * dpr, top + height - y);
      const over = x + ctx.measureText(name).width + 8 * dpr > left + width;
      write(name, x + (over ? -5 : 5) * dpr, y + 6 * dpr, over ? "right" : "left");
    }
  });
}

// Powers of ten between two numbers, at most some nine; within two decades twice and five times them.
function logSplits(low, high) {
  const first = Math.floor(Math.log10(low)), last = Math.ceil(Math.log10(high));
  const step = Math.max(1, Math.ceil((last - first) / 9)), out = [];
  for (let k = first; k <= last; k += step)
    for (const digit of last - first <= 3 ? [1, 2, 5] : [1]) {
      const value = Number((digit + "e" + k));
      if (value >= low && value <= high) out.push(value);
    }
  return out;
}

function axisOf(axis, isY, shown) {
  const stroke = () => colour("ink"), lines = {stroke: () => colour("line"), width: 1};
  const out = {show: shown, stroke, grid: lines, ticks: lines, font: kFont, labelFont: kFont,
               label: axis.label, labelSize: kAxisText};
  if (axis.log) Object.assign(out, {splits: (u, k, low, high) => logSplits(low, high),
                                    filter: (u, splits) => splits,
                                    values: (u, splits) => splits.map(power)});
  if (!axis.log) out.values = (u, splits, i, space, step) =>
    splits.map(v => v === null ? "" : String(Number(v.toFixed(Math.min(digitsOf(step || 1), 12)))));
  out.size = isY ? (u, values) => 20 + 8 * Math.max(...(values || [""]).map(v => v.length)) : 34;
  return out;
}

// What is in the legend behind the name of x: where the pointer is.
function placeAt(u, spec, points) {
  const {left, top} = u.cursor;
  if (!(left >= 0)) return "";
  const x = read(u.posToVal(left, "x"), u.scales.x.max - u.scales.x.min);
  return points ? x : x + ", " + spec.y.label + ": " +
    read(u.posToVal(top, "y"), u.scales.y.max - u.scales.y.min);
}

// The nearest point of each series that has a value.
function nearest(u, k, at) {
  const ys = u.data[k];
  for (let d = 0; d < ys.length; ++d) {
    if (isNumber(ys[at - d])) return at - d;
    if (isNumber(ys[at + d])) return at + d;
  }
  return at;
}

function makePlot(panel, spec) {
  const {data, series, bands, drawn} = arrange(spec);
  if (data[0].length === 0) return null;
  const lanes = spec.lanes.length;
  const isFunction = !lanes && spec.marks.some(m => columnsOf(m) !== null);
  const full = {x: [spec.x.low, spec.x.high],
                y: lanes ? [-kLaneTop / kLane, lanes - kLaneTop / kLane] : [spec.y.low, spec.y.high]};
  const identity = (u, low, high) => [low, high];
  const scale = (axis, range, more) =>
    ({time: false, auto: false, distr: axis.log ? 3 : 1, range: identity,
      min: range[0], max: range[1], ...more});
  for (const [k, s] of series.entries()) {
    if (k) s.value = (u, v) => lanes ? "" : read(v, spec.y.log ? v : spec.y.high - spec.y.low);
  }
  series[0] = {label: spec.x.label, value: u => placeAt(u, spec, isFunction)};
  const u = new uPlot({
    width: panel.clientWidth,
    height: spec.height + 66 + (spec.title ? 24 : 0),
    title: spec.title || undefined,
    scales: {x: scale(spec.x, full.x), y: scale(spec.y, full.y, lanes ? {dir: -1, distr: 1} : {})},
    axes: [axisOf(spec.x, false, true), axisOf(spec.y, true, !lanes)],
    padding: [8, 12, 0, lanes ? 8 : 0],
    series, bands,
    legend: {markers: {width: 3, stroke: (u, k) => colour(u.series[k].ink),
                       fill: (u, k) => faint(u.series[k].ink, 0.3)}},
    cursor: {drag: {x: true, y: !lanes, uni: 30}, dataIdx: nearest,
             bind: {dblclick: u => () => { showAll(u, full); }}},
    hooks: {drawAxes: [u => drawBehind(u, spec, drawn)], draw: [u => drawTexts(u, spec)]},
  }, data, panel.querySelector(".live"));
  takeKeys(u, full);
  takeFingers(u, full);
  return u;
}

function setRange(u, x, y) {
  u.batch(() => {
    u.setScale("x", {min: x[0], max: x[1]});
    u.setScale("y", {min: y[0], max: y[1]});
  });
}
function showAll(u, full) { setRange(u, full.x, full.y); }

// The range of an axis enlarged about a place by a factor, where the axis is even.
function enlarged(u, name, position, factor, shift) {
  const length = name === "x" ? u.over.clientWidth : u.over.clientHeight;
  const at = p => u.posToVal(p, name);
  const ends = [position - position / factor, position + (length - position) / factor]
    .map(p => at(p - shift));
  return ends[0] < ends[1] ? ends : [ends[1], ends[0]];
}

function zoomBy(u, factor) {
  const {clientWidth: w, clientHeight: h} = u.over;
  const x = u.cursor.left >= 0 ? u.cursor.left : w / 2;
  const y = u.cursor.top >= 0 ? u.cursor.top : h / 2;
  setRange(u, enlarged(u, "x", x, factor, 0), enlarged(u, "y", y, factor, 0));
}

// Arrows move the place that is read, + and - enlarge about it, 0 and Escape show all.
function takeKeys(u, full) {
  u.root.parentElement.addEventListener("keydown", event => {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const {clientWidth: w, clientHeight: h} = u.over;
    const step = event.shiftKey ? 40 : 8;
    const left = u.cursor.left >= 0 ? u.cursor.left : w / 2;
    const top = u.cursor.top >= 0 ? u.cursor.top : h / 2;
    const move = (dx, dy) => u.setCursor({left: Math.min(Math.max(left + dx, 0), w - 1),
                                          top: Math.min(Math.max(top + dy, 0), h - 1)});
    const actions = {ArrowLeft: () => move(-step, 0), ArrowRight: () => move(step, 0),
                     ArrowUp: () => move(0, -step), ArrowDown: () => move(0, step),
                     "+": () => zoomBy(u, 1.5), "-": () => zoomBy(u, 1 / 1.5),
                     "0": () => showAll(u, full), Escape: () => showAll(u, full)};
    if (!actions[event.key]) return;
    event.preventDefault();
    actions[event.key]();
  });
}

// Two fingers enlarge and move.
function takeFingers(u, full) {
  let last = null;
  const pinch = touches => {
    const box = u.over.getBoundingClientRect(), [a, b] = touches;
    return {x: (a.clientX + b.clientX) / 2 - box.left, y: (a.clientY + b.clientY) / 2 - box.top,
            apart: Math.max(Math.hypot(a.clientX - b.clientX, a.clientY - b.clientY), 1)};
  };
  u.over.addEventListener("touchstart", event => {
    last = event.touches.length === 2 ? pinch(event.touches) : null;
  }, {passive: true});
  u.over.addEventListener("touchmove", event => {
    if (!last || event.touches.length !== 2) return;
    event.preventDefault();
    const now = pinch(event.touches), factor = now.apart / last.apart;
    setRange(u, enlarged(u, "x", now.x, factor, now.x - last.x),
             enlarged(u, "y", now.y, factor, now.y - last.y));
    last = now;
  }, {passive: false});
}

function replace(panel) {
  const drawing = panel.querySelector(".plot");
  const spec = JSON.parse(panel.querySelector("script").textContent);
  for (const mark of spec.marks)  // x may be that of an earlier mark
    if (isNumber(mark.x)) mark.x = spec.marks[mark.x].x;
  const live = document.createElement("div");
  live.className = "live";
  live.tabIndex = 0;
  live.setAttribute("role", "group");
  live.setAttribute("aria-label", drawing.getAttribute("aria-label") +
    ". Arrow keys read values, plus and minus enlarge, 0 shows all.");
  live.setAttribute("aria-describedby", drawing.getAttribute("aria-describedby"));
  panel.append(live);
  panel.classList.add("replaced");  // shown, so that it has a width
  const u = makePlot(panel, spec);
  if (u === null) throw new Error("nothing to draw");
  panel.plot = u;
  u.root.querySelector(".u-legend").setAttribute("aria-live", "polite");
  new ResizeObserver(() => {
    if (panel.clientWidth !== u.width) u.setSize({width: panel.clientWidth, height: u.height});
  }).observe(panel);
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => u.redraw(false, true));
  return u;
}

const plots = [];
for (const panel of document.querySelectorAll(".panel")) {
  try {
    plots.push(replace(panel));
  } catch (error) {  // the drawing stays
    panel.classList.remove("replaced");
    panel.querySelector(".live")?.remove();
    console.error(error);
  }
}
if (plots.some(u => u)) document.documentElement.classList.add("replaced-plots");
})();
