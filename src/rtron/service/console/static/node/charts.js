// Live charts over the last minutes, and curves that stay as they are.
import { html, useEffect, useRef } from "../html.js";
import { clock } from "../format.js";
import { useFetched } from "../parts.js";
import { loadScript } from "../scripts.js";
import { listen, useStore } from "../store.js";
import { columns, samplesOf } from "../series.js";

const COLOURS = ["--c1", "--c2", "--c3", "--c4", "--c5", "--c6"];
const DASHES = [[], [6, 4], [2, 3], [9, 3, 2, 3], [12, 4], [4, 2]];
const SHORTEST = 60;
const LIVE = {
  height: 150, x: { range: (u, low, high) => [Math.min(low, high - SHORTEST), high] },
  axis: { space: 70, incrs: [10, 30, 60, 120, 300], values: (u, times) => times.map((seconds) => clock(seconds * 1e9)) },
};
const styleOf = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();

// Lines: {label, value(sample), colour?, dash?}; lines differ by dashes too, not by colour alone.
export function Chart({ robot, title, unit, lines, digits = 1 }) {
  useStore(`state ${robot}`, "theme");
  const drawing = useFetched(() => loadScript("vendor/uplot.min.js"), []);
  const samples = samplesOf(robot), last = samples.at(-1);
  return html`<figure class="stack chart-box"><figcaption class="line"><h3>${title}, ${unit}</h3></figcaption>
    ${samples.length < 2 || !drawing.value ? html`<p class="soft small">Waiting for figures …</p>` : html`<${Plot} view=${LIVE} data=${() => columns(robot, lines)} channel=${`state ${robot}`} lines=${lines} label=${`${title}, ${unit}`} />`}
    <div class="keys">${lines.map((line, i) => html`<span><${Key} at=${i} line=${line} />${line.label} <b>${shown(last && line.value(last), digits)}</b></span>`)}</div></figure>`;
}

// Lines: {label, values, colour, dash, width?} over `times` in seconds; `marks` are times that stand out.
export function Curves({ title, unit, lines, times, marks }) {
  useStore("theme");
  const drawing = useFetched(() => loadScript("vendor/uplot.min.js"), []), label = `${title}, ${unit}`;
  const view = { height: 240, x: {}, axis: { values: (u, at) => at.map((seconds) => `${seconds} s`) }, marks };
  return html`<figure class="stack chart-box">${drawing.value ? html`<${Plot} view=${view} data=${() => [times, ...lines.map(({ values }) => times.map((_, i) => values[i] ?? null))]} channel="theme" lines=${lines} label=${label} />` : html`<p class="soft small" aria-busy="true">Loading …</p>`}
    <div class="keys">${lines.map((line, i) => html`<span><${Key} at=${i} line=${line} />${line.label} <b>${shown(fastest(line.values), 2)}</b></span>`)}</div></figure>`;
}

const fastest = (values) => values.reduce((most, value) => value === null ? most : Math.max(most ?? value, value), null);
const shown = (value, digits) => value === null || value === undefined ? "–" : value.toFixed(digits);
const colourAt = (line, i) => line.colour ?? COLOURS[i % COLOURS.length];
const dashAt = (line, i) => line.dash ?? DASHES[i % DASHES.length];
const Key = ({ at, line }) => html`<svg viewBox="0 0 16 8" aria-hidden="true"><path d="M0 4H16" stroke=${`var(${colourAt(line, at)})`} stroke-width="2" stroke-dasharray=${dashAt(line, at).join(" ")} /></svg>`;

function Plot({ view, data, channel, lines, label }) {
  const element = useRef(null), theme = styleOf("--ground");
  const names = lines.map((line) => line.label).join();
  useEffect(() => {
    const plot = new window.uPlot(options(element.current, lines, view), data(), element.current);
    const draw = () => plot.setData(data());
    const resize = new ResizeObserver(() => plot.setSize({ width: element.current.clientWidth, height: view.height }));
    resize.observe(element.current);
    const end = listen(channel, draw);
    return () => { end(); resize.disconnect(); plot.destroy(); };
  }, [channel, names, theme]);
  return html`<div class="chart" ref=${element} role="img" aria-label=${label}></div>`;
}

function options(element, lines, view) {
  const ink = styleOf("--soft"), rim = styleOf("--rim");
  const axis = { stroke: ink, grid: { stroke: rim, width: 1 }, ticks: { show: false }, font: "11px system-ui, sans-serif" };
  return {
    width: element.clientWidth || 400, height: view.height, padding: [8, 8, 0, 0], legend: { show: false }, cursor: { drag: { x: false, y: false }, y: false },
    scales: { x: { time: view === LIVE, ...view.x }, y: { range: (u, low, high) => [Math.min(low ?? 0, 0), Math.max(high ?? 1, 1e-3) * 1.12] } },
    axes: [{ ...axis, size: 26, ...view.axis }, { ...axis, size: 44 }],
    series: [{}, ...lines.map((line, i) => ({ stroke: styleOf(colourAt(line, i)), width: line.width ?? 1.7, dash: dashAt(line, i), points: { show: false }, spanGaps: false }))],
    hooks: { draw: [(plot) => (view.marks ?? []).forEach((at) => mark(plot, plot.valToPos(at, "x", true), ink))] },
  };
}

// A line from top to bottom.
function mark({ ctx, bbox }, x, colour) {
  ctx.save();
  ctx.strokeStyle = colour;
  ctx.setLineDash([3, 3]);
  ctx.beginPath();
  ctx.moveTo(x, bbox.top);
  ctx.lineTo(x, bbox.top + bbox.height);
  ctx.stroke();
  ctx.restore();
}
