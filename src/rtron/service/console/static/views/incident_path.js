// Where the robot was in an incident, where it would have been, and the areas of the plan.
import { html } from "../html.js";

const COLOURS = ["--c5", "--c2"];

export function PathMap({ report: { path, areas, alternatives } }) {
  const ways = alternatives.filter((each) => each.path.length > 1);
  const places = [...path, ...areas.flatMap((area) => area.polygon), ...ways.flatMap((way) => way.path)];
  if (path.length < 2 && !ways.length) return html`<p class="soft">Nothing is known of where the robot was.</p>`;
  const [x, y] = [0, 1].map((axis) => extent(places.map((place) => place[axis])));
  const size = Math.max(x.size, y.size), pad = size * 0.06;
  const points = (list) => list.map((place) => `${place[0]},${-place[1]}`).join(" ");
  const name = `The path of the robot, ${size.toFixed(1)} m across`;
  return html`<svg class="map" role="img" aria-label=${name} viewBox=${`${x.low - pad} ${-y.high - pad} ${x.size + 2 * pad} ${y.size + 2 * pad}`}>
      ${areas.map((area) => html`<polygon points=${points(area.polygon)} class="area" /><text x=${area.polygon[0][0]} y=${-area.polygon[0][1]} font-size=${size * 0.045} fill="var(--soft)">${area.name}</text>`)}
      <polyline points=${points(path)} stroke="var(--c3)" stroke-width="3" />
      ${ways.map((way, i) => html`<polyline points=${points(way.path)} stroke=${`var(${COLOURS[i % COLOURS.length]})`} stroke-width="2" stroke-dasharray="6 4" />`)}
      ${path.length > 0 && html`<circle cx=${path[0][0]} cy=${-path[0][1]} r=${size * 0.012} fill="var(--ink)" />`}</svg>
    <div class="keys"><span><svg viewBox="0 0 16 8" aria-hidden="true"><path d="M0 4H16" stroke="var(--c3)" stroke-width="3" /></svg>where it was, from the dot on</span>${ways.map((way, i) => html`<span><svg viewBox="0 0 16 8" aria-hidden="true"><path d="M0 4H16" stroke=${`var(${COLOURS[i % COLOURS.length]})`} stroke-width="2" stroke-dasharray="6 4" /></svg>${way.title}</span>`)}</div>`;
}

// The least and the most of numbers, at least a decimetre apart.
function extent(values) {
  const low = Math.min(...values), high = Math.max(...values);
  return { low, high, size: Math.max(high - low, 0.1) };
}
