// The layout as SVG, with the paper's colours for risks, and what a choice highlights.
import { isolated } from "./isolate.js";
import { edgePath, PAD, PILL, ROW, shorten } from "./layout.js";
import { sameChoice } from "./model.js";

const SHIELD = "M0,-6 L5,-4 V0.5 C5,4 2.5,6 0,7 C-2.5,6 -5,4 -5,0.5 V-4 Z", MAX_LINES = 12, ANCHORS = { "-1": "end", 0: "middle", 1: "start" };
export function shape(name, attributes = {}, ...children) {
  const element = document.createElementNS("http://www.w3.org/2000/svg", name);
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
  element.append(...children);
  return element;
}
const tooltip = (text) => shape("title", {}, isolated(text));
const textAt = (text, attributes) => shape("text", { "dominant-baseline": "central", ...attributes }, isolated(text));
const frame = (b, radius) => shape("rect", { class: "frame", x: -b.w / 2, y: -b.h / 2, width: b.w, height: b.h, rx: radius });

// Arrow heads and the stripes of MSR events, for the <defs> of the picture.
export function definitions() {
  const heads = ["plain", "gr-st", "gr-mt", "watch"].map((name) => shape("marker", { id: `tip-${name}`, class: `tip ${name}`, viewBox: "0 0 8 8", refX: 7, refY: 4, markerWidth: 8, markerHeight: 8, markerUnits: "userSpaceOnUse", orient: "auto" }, shape("path", { d: "M0,0.5 L8,4 L0,7.5 Z" })));
  const stripes = shape("pattern", { id: "stripes", width: 12, height: 12, patternUnits: "userSpaceOnUse", patternTransform: "rotate(45)" }, shape("rect", { class: "stripe-ground", width: 12, height: 12 }), shape("rect", { class: "stripe", width: 6, height: 12 }));
  return [...heads, stripes];
}

// `label(edge, path)` gives an edge's label as {text, look, at}; with `pressableEdges` edges can be chosen.
export function draw(layout, world, { label, pressableEdges = false, tabindex = -1 }) {
  const edges = shape("g"), boxes = shape("g");
  edges.append(...layout.edges.map((e) => drawEdge(e, label, pressableEdges)));
  boxes.append(...layout.boxes.map(drawBox));
  for (const element of boxes.querySelectorAll(".press")) element.setAttribute("tabindex", tabindex);
  world.replaceChildren(edges, boxes);
}

function pressable(element, choice, label) {
  element.setAttribute("role", "button");
  element.setAttribute("aria-label", isolated(label));
  element.choice = choice;
  return element;
}

function drawBox(b) {
  b.element = shape("g", { class: `box ${b.kind}` }, ...DRAW[b.kind](b));
  b.element.box = b;
  moveBox(b);
  return b.element;
}
const moveBox = (b) => b.element.setAttribute("transform", `translate(${b.x},${b.y})`);

const DRAW = {
  node(b) {
    const { node } = b, about = [node.name, `${node.package || "package not known"} · ${node.trust}`, ...(node.function ? [node.function] : [])];
    const body = shape("g", { class: ["press", "pill", node.trust, ...node.marks].join(" ") }, tooltip(about.join("\n")), frame(b, 15), textAt(b.label, { "text-anchor": "middle", class: "name" }));
    return [pressable(body, { kind: "node", name: node.name }, `node ${node.name}`)];
  },
  topics(b) {
    const top = -b.h / 2 + PAD / 2;
    b.drawn = b.rows.map((row, i) => drawTopic(b, row, top + i * ROW));
    return [frame(b, 4), ...b.drawn, ...(b.more ? [drawMore(b, top + b.rows.length * ROW)] : [])];
  },
  coordination(b) {
    const c = b.coordination, left = -b.w / 2;
    const body = shape("g", { class: `press guard ${c.kind.toLowerCase()} ${c.mode}` }, tooltip(`${c.kind} ${c.id}`), frame(b, 3), shape("path", { class: "shield", d: SHIELD, transform: `translate(${left + 14},-8)` }), textAt(b.label, { x: left + 26, y: -8, class: "name" }), textAt(b.detail, { x: left + 26, y: 9, class: "under" }));
    return [pressable(body, { kind: "coordination", name: c.id }, `${c.kind} ${c.id}`)];
  },
};

const rowGround = (b, y) => shape("rect", { class: "ground", x: -b.w / 2 + 2, y: y + 0.5, width: b.w - 4, height: ROW - 1, rx: 3 });

function drawTopic(b, { topic, grcn }, y) {
  const left = -b.w / 2 + 11 + (grcn ? PILL + 6 : 0);
  const row = shape("g", { class: ["press", "row", ...topic.marks].join(" ") }, tooltip([topic.name, ...topic.types].join("\n")), rowGround(b, y), textAt(shorten(topic.name), { x: left, y: y + ROW / 2, class: "name" }));
  pressable(row, { kind: "topic", name: topic.name }, `topic ${topic.name}`);
  const group = shape("g", { "data-topic": topic.name }, row, ...(grcn ? [drawPill(b, topic, grcn, y)] : []));
  group.topic = topic;
  return group;
}

function drawPill(b, topic, grcn, y) {
  const pill = shape("g", { class: `press guard grcn small ${grcn.mode}`, transform: `translate(${-b.w / 2 + 6},${y + ROW / 2})` }, tooltip(`GRCN ${grcn.id} · ${grcn.policy} · ${grcn.mode}`), shape("rect", { class: "frame", x: 0, y: -7.5, width: PILL, height: 15, rx: 3 }), textAt("GRCN", { x: PILL / 2, "text-anchor": "middle" }));
  return pressable(pill, { kind: "coordination", name: grcn.id }, `GRCN of ${topic.name}: ${grcn.policy}, ${grcn.mode}`);
}

function drawMore(b, y) {
  const row = shape("g", { class: "press row more" }, tooltip(b.topics.slice(b.rows.length).map((topic) => topic.name).join("\n")), rowGround(b, y), textAt(`+ ${b.more} more`, { x: -b.w / 2 + 11, y: y + ROW / 2, class: "name" }));
  return pressable(row, { kind: "unfold", name: b.topics[0].name }, `show ${b.more} more topics`);
}

function drawEdge(e, label, isPressable) {
  const kinds = ["GR-ST", "GR-MT"].filter((kind) => e.kinds.has(kind)).map((kind) => kind.toLowerCase());
  const looks = !e.endpoints.length ? [`watch ${e.coordination[0].kind.toLowerCase()}`] : kinds.length > 1 ? ["gr-st", "gr-mt over"] : [kinds[0] ?? ""];
  e.lines = looks.map((look) => shape("path", { class: `line ${look}`, "marker-end": `url(#tip-${look.split(" ")[0] || "plain"})` }));
  if (isPressable) e.lines.push(hitLine(e));
  const { text, look, at } = label(e);
  e.label = textAt(text, { class: look });
  e.labelAt = at;
  e.element = shape("g", { class: e.endpoints.length ? "edge" : "edge lane" }, ...e.lines, e.label);
  routeEdge(e);
  return e.element;
}

function hitLine(e) {
  const line = shape("path", { class: "hit" }, tooltip(edgeText(e)));
  line.choice = e.endpoints.length ? { kind: "endpoints", name: e.key, endpoints: e.endpoints } : { kind: "coordination", name: e.coordination[0].id };
  return line;
}

function edgeText(e) {
  const texts = e.endpoints.map(({ node, publishes, topic }) => `${node.name} ${publishes ? "publishes" : "subscribes"} ${topic.name}`);
  return [...texts.slice(0, MAX_LINES), ...(texts.length > MAX_LINES ? ["…"] : []), ...e.names].join("\n");
}

function routeEdge(e) {
  const path = edgePath(e), { x, y, side } = e.labelAt(path);
  for (const line of e.lines) line.setAttribute("d", path.d);
  for (const [key, value] of Object.entries({ x, y, "text-anchor": ANCHORS[side] })) e.label.setAttribute(key, value);
}

export function dragBox(layout, box, dx, dy) {
  box.x += dx;
  box.y += dy;
  moveBox(box);
  layout.edges.filter((e) => e.from === box || e.to === box).forEach(routeEdge);
}

// `lit` is what belongs to the choice, or nothing; `root` has the buttons that may be marked as chosen.
export function highlight(layout, world, lit, choice, root = world) {
  world.classList.toggle("choosing", Boolean(lit));
  for (const b of layout.boxes) {
    (b.drawn ?? []).forEach((row) => row.classList.toggle("lit", Boolean(lit?.topics.has(row.topic))));
    b.element.classList.toggle("lit", isLit(b, lit));
  }
  for (const e of layout.edges) {
    const joinsLit = choice?.kind === "coordination" || isLit(e.from, lit) && isLit(e.to, lit);
    const edgeLit = Boolean(lit) && (e.endpoints.some((each) => lit.endpoints.has(each)) || joinsLit && e.coordination.some((c) => lit.coordination.has(c)));
    e.element.classList.toggle("lit", edgeLit);
    if (edgeLit) e.element.parentNode.append(e.element);
  }
  for (const element of root.querySelectorAll(".press, .item")) element.classList.toggle("chosen", sameChoice(element.choice, choice));
}

export const isLit = (b, lit) => Boolean(lit) && (lit.nodes.has(b.node) || lit.coordination.has(b.coordination) || Boolean(b.topics?.some((topic) => lit.topics.has(topic))));
