"use strict";
const SVG = "http://www.w3.org/2000/svg";
const data = JSON.parse(document.getElementById("data").textContent);

function element(name, attributes, parent, text) {
  const made = document.createElementNS(SVG, name);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
  if (text !== undefined) made.textContent = text;
  if (parent) parent.append(made);
  return made;
}

const superscript = (power) => String(power).replace(/[-0-9]/g, (c) => (c === "-" ? "\u207b" : "\u2070\u00b9\u00b2\u00b3\u2074\u2075\u2076\u2077\u2078\u2079"[+c]));

/** A number as a person writes it: 3 digits, powers of ten where they are shorter. */
function figure(value) {
  if (value === 0) return "0";
  const power = Math.floor(Math.log10(Math.abs(value)));
  if (power >= -3 && power < 5) return String(+value.toPrecision(3));
  return `${+(value / 10 ** power).toPrecision(2)} \u00d7 10${superscript(power)}`;
}

/** Marks of an axis between two values, with their names: no more than `most`. */
function marks(low, high, linear, most) {
  const found = [];
  if (linear) {
    const rough = (high - low) / most, base = 10 ** Math.floor(Math.log10(rough));
    const step = base * [1, 2, 5, 10].find((s) => s * base >= rough);
    for (let i = Math.ceil(low / step); i * step <= high * 1.0001; i++) found.push([i * step, String(+(i * step).toPrecision(4))]);
    return found;
  }
  const first = Math.ceil(Math.log10(low) - 1e-9), last = Math.floor(Math.log10(high) + 1e-9);
  const step = Math.max(1, Math.ceil((last - first + 1) / most));
  const name = (v, p) => (p > -3 && p < 4 ? String(+v.toPrecision(3)) : `10${superscript(p)}`);
  if (last - first < 2) {
    for (let p = first - 1; p <= last; p++) for (const m of [1, 2, 5]) {
      const v = m * 10 ** p;
      if (v >= low * 0.999 && v <= high * 1.001) found.push([v, p > -4 && p < 5 ? String(+v.toPrecision(3)) : `${m}\u00d710${superscript(p)}`]);
    }
    return found;
  }
  for (let p = Math.ceil(first / step) * step; p <= last; p += step) found.push([10 ** p, name(10 ** p, p)]);
  return found;
}

/** Writes each line's name right of the chart, in the order of their last points, and no closer than can be read. */
function label(svg, chart, frame, toX, toY) {
  const ends = chart.series.map((series) => {
    const last = series.points.reduce((a, b) => (b.x >= a.x ? b : a));
    return { series, x: toX(last.x), y: toY(last.y) };
  }).sort((a, b) => a.y - b.y);
  const gap = Math.min(20, (frame.bottom - frame.top) / ends.length);
  ends.forEach((end, i) => { end.at = Math.max(end.y, i ? ends[i - 1].at + gap : frame.top); });
  for (let i = ends.length - 1, below = frame.bottom; i >= 0; i--) {
    ends[i].at = Math.min(ends[i].at, below);
    below = ends[i].at - gap;
  }
  for (const { series, x, y, at } of ends) {
    const color = `var(${series.color})`;
    element("polyline", { points: `${x + 7},${y} ${frame.right + 2},${at} ${frame.right + 10},${at}`, fill: "none", stroke: color, "stroke-width": 0.8, opacity: 0.6 }, svg);
    element("text", { x: frame.right + 14, y: at + 4, style: `fill:${color};font-weight:${series.ours ? 650 : 400}` }, svg, series.label);
  }
}

/** Draws a chart into its box at the box's own width; one stop for the keyboard, arrows move from point to point. */
function draw(box, chart) {
  const width = Math.max(box.clientWidth, 240), height = Math.round(Math.min(400, Math.max(260, width * 0.55)));
  const labelled = width >= 700;
  box.classList.toggle("labelled", labelled);
  const frame = { left: 62, right: width - (labelled ? 210 : 14), top: 30, bottom: height - 46 };
  const points = chart.series.flatMap((series, s) => series.points.map((point, i) => ({ ...point, series, s, i })));
  const xs = points.map((p) => p.x), positive = points.map((p) => p.y).filter((y) => y > 0);
  const pad = (low, high) => (low === high ? [low / 2, high * 2] : [low / (high / low) ** 0.04, high * (high / low) ** 0.04]);
  const [x0, x1] = pad(Math.min(...xs), Math.max(...xs));
  const zeros = points.some((p) => p.y <= (chart.least || 0));
  let [y0, y1] = chart.linear ? [Math.min(0, ...points.map((p) => p.y)), Math.max(...points.map((p) => p.y)) * 1.05 || 1] : pad(Math.min(...positive), Math.max(...positive));
  if (!chart.linear && (zeros || chart.least)) y0 = Math.max(chart.least || 0, 10 ** Math.floor(Math.log10(Math.min(...positive) / 3)));
  const toX = (x) => frame.left + (frame.right - frame.left) * Math.log(x / x0) / Math.log(x1 / x0);
  const toY = (y) => frame.bottom - (frame.bottom - frame.top) * (chart.linear ? (y - y0) / (y1 - y0) : Math.log(Math.max(y, y0) / y0) / Math.log(y1 / y0));
  box.querySelector("svg")?.remove();
  const svg = element("svg", { viewBox: `0 0 ${width} ${height}`, height, role: "img", "aria-label": `${chart.title}. ${chart.ylabel} against ${chart.xlabel}. The arrow keys read the points.` });
  box.prepend(svg);
  for (const [v, name] of marks(x0, x1, false, Math.floor(width / 75))) {
    element("line", { class: "grid", x1: toX(v), x2: toX(v), y1: frame.top, y2: frame.bottom }, svg);
    element("text", { x: toX(v), y: frame.bottom + 18, "text-anchor": "middle" }, svg, name);
  }
  for (const [v, name] of marks(y0, y1, chart.linear, 7)) {
    element("line", { class: "grid", x1: frame.left, x2: frame.right, y1: toY(v), y2: toY(v) }, svg);
    element("text", { x: frame.left - 8, y: toY(v) + 4, "text-anchor": "end" }, svg, name);
  }
  element("line", { class: "axis", x1: frame.left, x2: frame.right, y1: frame.bottom, y2: frame.bottom }, svg);
  element("text", { x: 0, y: 14 }, svg, chart.ylabel);
  element("text", { x: frame.right, y: height - 8, "text-anchor": "end" }, svg, chart.xlabel);
  chart.series.forEach((series) => {
    const color = `var(${series.color})`, group = element("g", { class: "series" }, svg);
    const line = series.points.map((p) => `${toX(p.x).toFixed(1)},${toY(p.y).toFixed(1)}`).join(" ");
    element("polyline", { points: line, fill: "none", stroke: color, "stroke-width": series.ours ? 2.6 : 1.6, "stroke-dasharray": series.dash, "stroke-linejoin": "round" }, group);
    for (const p of series.points) {
      const none = !chart.linear && p.y <= y0;
      element("circle", { class: "point", cx: toX(p.x).toFixed(1), cy: toY(p.y).toFixed(1), r: series.ours ? 4 : 3.2, fill: none ? "var(--card)" : color, stroke: color, "stroke-width": 1.5 }, group);
    }
  });
  if (labelled) label(svg, chart, frame, toX, toY);
  const ring = element("circle", { r: 8, fill: "none", stroke: "var(--ink)", "stroke-width": 2, visibility: "hidden" }, svg);
  const tip = box.querySelector(".tip");
  const groups = svg.querySelectorAll(".series");
  box.show = (p) => {
    box.chosen = p;
    tip.hidden = !p;
    ring.setAttribute("visibility", p ? "visible" : "hidden");
    groups.forEach((group, s) => group.classList.toggle("dim", Boolean(p) && s !== p.s));
    if (!p) return;
    ring.setAttribute("cx", toX(p.x));
    ring.setAttribute("cy", toY(p.y));
    tip.replaceChildren();
    const head = document.createElement("b");
    head.textContent = p.series.label;
    tip.append(head, document.createElement("br"), p.words || `${chart.xlabel} ${figure(p.x)}: ${figure(p.y)}`);
    const left = Math.min(Math.max(toX(p.x) - tip.offsetWidth / 2, 0), width - tip.offsetWidth);
    const above = toY(p.y) - tip.offsetHeight - 14;
    tip.style.left = `${left}px`;
    tip.style.top = `${above < 0 ? toY(p.y) + 14 : above}px`;
  };
  box.nearest = (event) => {
    const at = svg.getBoundingClientRect(), x = event.clientX - at.left, y = event.clientY - at.top;
    const far = (p) => Math.hypot(toX(p.x) - x, toY(p.y) - y);
    const best = points.reduce((a, b) => (far(b) < far(a) ? b : a));
    return far(best) < 40 ? best : null;
  };
  box.step = (key) => {
    const now = box.chosen || { s: 0, i: -1 };
    const count = chart.series.length, turn = { ArrowUp: count - 1, ArrowDown: 1 }[key] || 0;
    const s = box.chosen ? (now.s + turn) % count : 0, last = chart.series[s].points.length - 1;
    const i = Math.min(Math.max(now.i + ({ ArrowLeft: -1, ArrowRight: 1 }[key] || 0), 0), last);
    box.show(points.find((p) => p.s === s && p.i === i));
  };
}

document.querySelectorAll(".chart").forEach((box) => {
  const chart = data[box.dataset.chart];
  draw(box, chart);
  box.addEventListener("pointermove", (event) => box.show(box.nearest(event)));
  box.addEventListener("pointerdown", (event) => box.show(box.nearest(event)));
  box.addEventListener("pointerleave", () => box.show(null));
  box.addEventListener("blur", () => box.show(null));
  box.addEventListener("keydown", (event) => {
    if (event.key === "Escape") return box.show(null);
    if (!event.key.startsWith("Arrow")) return;
    event.preventDefault();
    box.step(event.key);
  });
  let width = box.clientWidth;
  new ResizeObserver(() => {
    if (box.clientWidth === width) return;
    width = box.clientWidth;
    draw(box, chart);
    box.show(null);
  }).observe(box);
});

const filters = document.querySelector(".filters");
if (filters) {
  const [words, group, verdict] = ["words", "group", "verdict"].map((name) => filters.elements[name]);
  const rows = [...document.querySelectorAll("#book tbody tr")], count = document.getElementById("count");
  const filter = () => {
    const wanted = words.value.toLowerCase().split(/\s+/);
    let shown = 0;
    for (const row of rows) {
      const text = row.textContent.toLowerCase();
      row.hidden = !(wanted.every((word) => text.includes(word)) && (!group.value || row.dataset.group === group.value) && (!verdict.value || row.dataset.verdict === verdict.value));
      shown += !row.hidden;
    }
    count.textContent = `${shown} of ${rows.length} rows`;
  };
  filters.addEventListener("input", filter);
  filters.addEventListener("submit", (event) => event.preventDefault());
  filter();
}
