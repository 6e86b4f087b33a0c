// The picture as SVG, with the paper's colours; rates are written onto it as they come.
import { rate as said } from "../format.js";
import { rateKey } from "../series.js";
import { brief, grcnOf, PAD, PILL, ROW, route } from "./layout.js";
import { means } from "./model.js";

const SHIELD = "M0,-6 L5,-4 V0.5 C5,4 2.5,6 0,7 C-2.5,6 -5,4 -5,0.5 V-4 Z";
export function shape(name, attributes = {}, ...children) {
  const element = document.createElementNS("http://www.w3.org/2000/svg", name);
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
  element.append(...children);
  return element;
}
const title = (text) => shape("title", {}, text);
const words = (text, attributes) => shape("text", { "dominant-baseline": "central", ...attributes }, text);
const frame = (b, radius) => shape("rect", { class: "frame", x: -b.w / 2, y: -b.h / 2, width: b.w, height: b.h, rx: radius });

export function draw(picture, world) {
  const edges = shape("g"), boxes = shape("g");
  edges.append(...picture.edges.map(drawEdge));
  boxes.append(...picture.boxes.map((b) => drawBox(b)));
  world.replaceChildren(edges, boxes);
}

function pressable(element, choice, label) {
  for (const [key, value] of Object.entries({ tabindex: "-1", role: "button", "aria-label": label })) element.setAttribute(key, value);
  element.choice = choice;
  return element;
}

function drawBox(b) {
  b.element = shape("g", { class: `box ${b.kind}`, transform: `translate(${b.x},${b.y})` }, ...DRAW[b.kind](b));
  return b.element;
}

const DRAW = {
  node(b) {
    const { node } = b, body = shape("g", { class: ["press", "pill", node.trust, ...node.marks].join(" ") }, title(`${node.name}\n${node.package || "package not known"} · ${node.trust}${node.function && `\n${node.function}`}`), frame(b, 15), words(b.label, { "text-anchor": "middle", class: "name" }));
    return [pressable(body, { kind: "node", name: node.name }, `node ${node.name}`)];
  },
  topics(b) {
    const top = -b.h / 2 + PAD / 2;
    b.drawn = b.rows.map((topic, i) => drawRow(b, topic, top + i * ROW));
    return [frame(b, 4), ...b.drawn, ...(b.more ? [drawMore(b, top + b.rows.length * ROW)] : [])];
  },
  coordination(b) {
    const c = b.coordination, body = shape("g", { class: `press guard ${c.kind.toLowerCase()} ${c.mode}` }, title(`${c.kind} ${c.id}`), frame(b, 3), shape("path", { class: "shield", d: SHIELD, transform: `translate(${-b.w / 2 + 14},-8)` }), words(b.label, { x: -b.w / 2 + 26, y: -8, class: "name" }), words(b.under, { x: -b.w / 2 + 26, y: 9, class: "under" }));
    return [pressable(body, { kind: "coordination", name: c.id }, `${c.kind} ${c.id}`)];
  },
};

function drawRow(b, topic, y) {
  const grcn = grcnOf(topic), left = -b.w / 2 + 11 + (grcn ? PILL + 6 : 0);
  const row = shape("g", { class: ["press", "row", ...topic.marks].join(" ") }, title([topic.name, ...topic.types].join("\n")), shape("rect", { class: "floor", x: -b.w / 2 + 2, y: y + 0.5, width: b.w - 4, height: ROW - 1, rx: 3 }), words(brief(topic.name), { x: left, y: y + ROW / 2, class: "name" }));
  pressable(row, { kind: "topic", name: topic.name }, `topic ${topic.name}`);
  const group = shape("g", {}, row, ...(grcn ? [drawPill(b, grcn, y)] : []));
  group.topic = topic;
  return group;
}

function drawPill(b, grcn, y) {
  const pill = shape("g", { class: `press guard grcn small ${grcn.mode}`, transform: `translate(${-b.w / 2 + 6},${y + ROW / 2})` }, title(`GRCN ${grcn.id} · ${grcn.policy} · ${grcn.mode}`), shape("rect", { class: "frame", x: 0, y: -7.5, width: PILL, height: 15, rx: 3 }), words("GRCN", { x: PILL / 2, "text-anchor": "middle" }));
  return pressable(pill, { kind: "coordination", name: grcn.id }, `GRCN ${grcn.id}: ${grcn.policy}, ${grcn.mode}`);
}

function drawMore(b, y) {
  const row = shape("g", { class: "press row more" }, title(b.topics.slice(b.rows.length).map((t) => t.name).join("\n")), shape("rect", { class: "floor", x: -b.w / 2 + 2, y: y + 0.5, width: b.w - 4, height: ROW - 1, rx: 3 }), words(`+ ${b.more} more`, { x: -b.w / 2 + 11, y: y + ROW / 2, class: "name" }));
  return pressable(row, { kind: "open", name: b.topics[0].name }, `show ${b.more} more topics`);
}

function drawEdge(e) {
  const kinds = ["GR-ST", "GR-MT"].filter((kind) => e.kinds.has(kind)).map((kind) => kind.toLowerCase());
  const looks = !e.ends.length ? [`watch ${e.coordination[0].kind.toLowerCase()}`] : kinds.length > 1 ? ["gr-st", "gr-mt over"] : [kinds[0] ?? ""];
  const { d, start, end } = route(e), { x, y, side } = e.in.room > e.out.room ? end : start;
  e.label = words("", { class: e.ends.some(enforced) ? "rate" : "rate watched", x, y, "text-anchor": side > 0 ? "start" : "end" });
  e.element = shape("g", { class: e.ends.length ? "edge" : "edge lane" }, ...looks.map((look) => shape("path", { class: `line ${look}`, d, "marker-end": `url(#tip-${look.split(" ")[0] || "plain"})` })), e.label);
  e.flows = e.ends.flatMap(flowsOf);
  e.shown = "";
  return e.element;
}

const enforced = (end) => grcnOf(end.topic)?.mode === "enforce";

// The flows that an end is: a publisher's own on that topic, or for a successor all that go out.
function flowsOf(end) {
  const grcn = grcnOf(end.topic), topic = end.topic.name;
  if (!grcn) return [];
  const { flows, successors } = grcn.guards[0];
  if (end.publishes) return flows.filter((f) => means(f.publisher, end.node.name)).map((f) => ({ topic, flow: f.name }));
  return successors.some((name) => means(name, end.node.name)) ? flows.map((f) => ({ topic, flow: f.name, out: true })) : [];
}

// Writes the rates onto the edges, and which flow is in control.
export function tell(picture, rates, streams) {
  for (const e of picture.edges) {
    if (!e.flows.length) continue;
    const found = e.flows.map(({ topic, flow, out }) => ({ rate: rates?.get(rateKey(topic, flow)), owns: streams?.get(topic)?.owner === flow, out })).filter((f) => f.rate);
    const out = found.reduce((sum, f) => sum + f.rate.out, 0), refused = found.reduce((sum, f) => sum + (f.out ? 0 : f.rate.refused), 0);
    show(e, textOf(out, refused), { owner: found.some((f) => f.owns), refused: refused > 0, active: out > 0 });
  }
}

const textOf = (out, refused) => [out >= 0.05 && `${said(out)}/s`, refused >= 0.05 && `${said(refused)}/s refused`].filter(Boolean).join(", ");

function show(e, text, looks) {
  const now = text + JSON.stringify(looks);
  if (e.shown === now) return;
  e.shown = now;
  e.label.textContent = text;
  for (const [look, is] of Object.entries(looks)) e.element.classList.toggle(look, is);
}

// What a choice lights: {nodes, topics, coordination}, or nothing.
export function light(picture, world, lit, choice) {
  world.classList.toggle("choosing", Boolean(lit));
  for (const b of picture.boxes) {
    (b.drawn ?? []).forEach((row) => row.classList.toggle("lit", Boolean(lit?.topics.has(row.topic))));
    b.element.classList.toggle("lit", Boolean(lit && (lit.nodes.has(b.node) || lit.coordination.has(b.coordination) || b.topics?.some((t) => lit.topics.has(t)))));
  }
  for (const e of picture.edges) e.element.classList.toggle("lit", Boolean(lit && (e.ends.some((end) => lit.ends.has(end)) || e.coordination.some((c) => lit.coordination.has(c)))));
  for (const element of world.querySelectorAll(".press")) element.classList.toggle("chosen", Boolean(choice) && element.choice?.kind === choice.kind && element.choice.name === choice.name);
}
