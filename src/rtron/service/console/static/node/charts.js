// Live charts over the last minutes.
import { html, useEffect, useRef } from "../html.js";
import { clock } from "../format.js";
import { listen, useStore } from "../store.js";
import { columns, samplesOf } from "../series.js";

const COLOURS = ["--c1", "--c2", "--c3", "--c4", "--c5", "--c6"];
const DASHES = [[], [6, 4], [2, 3], [9, 3, 2, 3], [12, 4], [4, 2]];
const SHORTEST = 60;
const timeOf = (seconds) => clock(seconds * 1e9);
const styleOf = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();

// Lines: {label, value(sample), colour?, dash?}; lines differ by dashes too, not by colour alone.
export function Chart({ robot, title, unit, lines, digits = 1 }) {
  useStore(`state ${robot}`, "theme");
  const samples = samplesOf(robot), last = samples.at(-1);
  return html`<figure class="stack chart-box"><figcaption class="line"><h3>${title}, ${unit}</h3></figcaption>
    ${samples.length < 2 ? html`<p class="soft small">Waiting for figures …</p>` : html`<${Plot} robot=${robot} lines=${lines} label=${`${title}, ${unit}`} />`}
    <div class="keys">${lines.map((line, i) => html`<span><${Key} at=${i} line=${line} />${line.label} <b>${shown(last && line.value(last), digits)}</b></span>`)}</div></figure>`;
}

const shown = (value, digits) => value === null || value === undefined ? "–" : value.toFixed(digits);
const colourAt = (line, i) => line.colour ?? COLOURS[i % COLOURS.length];
const dashAt = (line, i) => line.dash ?? DASHES[i % DASHES.length];
const Key = ({ at, line }) => html`<svg viewBox="0 0 16 8" aria-hidden="true"><path d="M0 4H16" stroke=${`var(${colourAt(line, at)})`} stroke-width="2" stroke-dasharray=${dashAt(line, at).join(" ")} /></svg>`;

function Plot({ robot, lines, label }) {
  const element = useRef(null), theme = styleOf("--ground");
  const names = lines.map((line) => line.label).join();
  useEffect(() => {
    const plot = new window.uPlot(options(element.current, lines), columns(robot, lines), element.current);
    const draw = () => plot.setData(columns(robot, lines));
    const resize = new ResizeObserver(() => plot.setSize({ width: element.current.clientWidth, height: 150 }));
    resize.observe(element.current);
    const end = listen(`state ${robot}`, draw);
    return () => { end(); resize.disconnect(); plot.destroy(); };
  }, [robot, names, theme]);
  return html`<div class="chart" ref=${element} role="img" aria-label=${label}></div>`;
}

function options(element, lines) {
  const ink = styleOf("--soft"), rim = styleOf("--rim");
  const axis = { stroke: ink, grid: { stroke: rim, width: 1 }, ticks: { show: false }, font: "11px system-ui, sans-serif" };
  return {
    width: element.clientWidth || 400, height: 150, padding: [8, 8, 0, 0], legend: { show: false }, cursor: { drag: { x: false, y: false }, y: false },
    scales: { x: { range: (u, low, high) => [Math.min(low, high - SHORTEST), high] }, y: { range: (u, low, high) => [Math.min(low ?? 0, 0), Math.max(high ?? 1, 1e-3) * 1.12] } },
    axes: [{ ...axis, size: 26, space: 70, incrs: [10, 30, 60, 120, 300], values: (u, times) => times.map(timeOf) }, { ...axis, size: 44 }],
    series: [{}, ...lines.map((line, i) => ({ stroke: styleOf(colourAt(line, i)), width: 1.7, dash: dashAt(line, i), points: { show: false }, spanGaps: false }))],
  };
}
