// Where everything stands: columns by dagre; topics with the same neighbours share a box.
import { push } from "./model.js";

export const ROW = 21, PAD = 6, PILL = 46;
const FONT = '12px system-ui, "Segoe UI", Roboto, "Helvetica Neue", Arial, sans-serif', LONGEST = 38, MOST_ROWS = 8, FEWER = 5;
const paper = document.createElement("canvas").getContext("2d");
const width = (text, weight = 400) => { paper.font = `${weight} ${FONT}`; return paper.measureText(text).width; };
export const brief = (name) => name.length <= LONGEST ? name : `${name.slice(0, 19)}…${name.slice(-(LONGEST - 20))}`;
export const grcnOf = (topic) => topic.coordination.find((c) => c.kind === "GRCN");

export function pictureOf(model, ends, opened) {
  const boxes = [], edges = new Map(), at = new Map();
  const add = (box) => { box.id = boxes.length; boxes.push(box); return box; };
  for (const node of new Set(ends.map((end) => end.node))) at.set(node, add(nodeBox(node)));
  for (const group of groupsOf(ends)) {
    const box = add(topicBox(group, opened));
    group.forEach((topic) => at.set(topic, box));
  }
  for (const end of ends) join(edges, ...(end.publishes ? [at.get(end.node), at.get(end.topic)] : [at.get(end.topic), at.get(end.node)]), { end });
  lane(model, add, edges, at);
  const picture = { boxes, edges: [...edges.values()], at };
  place(picture);
  return picture;
}

function nodeBox(node) {
  const label = brief(node.name);
  return { kind: "node", node, label, w: width(label, 600) + 30, h: 30 };
}

function topicBox(topics, opened) {
  const folded = topics.length > MOST_ROWS && !topics.some((t) => opened.has(t.name)), rows = folded ? topics.slice(0, FEWER) : topics, more = topics.length - rows.length;
  const wide = (t) => width(brief(t.name)) + (grcnOf(t) ? PILL + 6 : 0);
  return { kind: "topics", topics, rows, more, w: Math.max(...rows.map(wide)) + 22, h: (rows.length + (more ? 1 : 0)) * ROW + PAD };
}

function groupsOf(ends) {
  const signature = new Map(), alike = new Map();
  ends.forEach((end) => push(signature, end.topic, `${end.publishes ? ">" : "<"}${end.node.name}:${end.marks.join("+")}`));
  for (const [topic, said] of signature) {
    const apart = topic.coordination.filter((c) => c.kind !== "GRCN").map((c) => c.id);
    push(alike, JSON.stringify([[...new Set(said)].sort(), [...topic.marks], apart]), topic);
  }
  return [...alike.values()].map((group) => group.sort((a, b) => (b.risks.length > 0) - (a.risks.length > 0) || (a.name < b.name ? -1 : 1)));
}

function join(edges, from, to, { end, coordination, name }) {
  if (!from || !to) return;
  const key = `${from.id}>${to.id}`;
  if (!edges.has(key)) edges.set(key, { from, to, ends: [], coordination: [], names: [], kinds: new Set() });
  const edge = edges.get(key);
  if (end) { edge.ends.push(end); end.marks.forEach((kind) => edge.kinds.add(kind)); }
  if (coordination) { edge.coordination.push(coordination); edge.names.push(name); }
}

// The app's one RSRCN, one MSRCN and the fps_monitors stand in a lane of their own, above.
function lane(model, add, edges, at) {
  for (const c of model.coordination.filter((each) => each.kind !== "GRCN")) {
    const topics = [...c.guards, ...c.watches].filter((part) => at.has(part.topic));
    if (!topics.length) continue;
    const under = c.policy ? `${c.policy} · ${c.mode}` : brief(c.watches[0].publisher);
    const box = add({ kind: "coordination", coordination: c, label: c.kind, under, w: Math.max(width(c.kind, 600), width(under) * 0.92) + 40, h: 42 });
    for (const watch of c.watches) join(edges, at.get(watch.topic), box, { coordination: c, name: watch.name });
    for (const guard of c.guards) join(edges, box, at.get(guard.topic), { coordination: c, name: guard.flows.map((f) => f.name).join(", ") });
  }
}

function place(picture) {
  const inLane = (box) => box.kind === "coordination", boxes = picture.boxes.filter((box) => !inLane(box)), edges = picture.edges.filter((e) => e.ends.length);
  heighten(boxes, edges);
  const graph = layered(boxes, edges, depths(boxes, edges));
  for (const box of boxes) ({ x: box.x, y: box.y } = graph.node(String(box.id)));
  const columns = new Map();
  boxes.forEach((b) => columns.set(Math.round(b.x), Math.max(columns.get(Math.round(b.x)) ?? 0, b.w / 2)));
  for (const edge of picture.edges) edge.way = edge.ends.length ? wayOf(graph, edge, columns) : [];
  widen(boxes, picture.edges);
  placeLane(picture.boxes.filter(inLane), boxes);
  ports(picture);
}

// Screens are wide: a tall picture is pulled apart, so that its edges can be told apart.
function widen(boxes, edges) {
  if (!boxes.length) return;
  const { left, right, top, bottom } = extent(boxes), wider = Math.min(Math.max(1.5 * (bottom - top) / (right - left), 1), 2.2);
  for (const part of [...boxes, ...edges.flatMap((e) => e.way)]) part.x *= wider;
}

function heighten(boxes, edges) {
  const degree = new Map();
  edges.forEach((e) => [`${e.from.id}>`, `>${e.to.id}`].forEach((key) => degree.set(key, (degree.get(key) ?? 0) + 1)));
  for (const b of boxes) if (b.kind === "node") b.h = Math.max(b.h, Math.min(12 + Math.max(degree.get(`${b.id}>`) ?? 0, degree.get(`>${b.id}`) ?? 0) * 6, 200));
}

// How many steps each box is from where data comes in: edges that lead back make no new column.
function depths(boxes, edges) {
  const next = new Map(), entered = new Set(edges.map((e) => e.to)), depth = new Map();
  edges.forEach((e) => push(next, e.from, e.to));
  const reach = (from) => {
    const queue = from.filter((b) => !depth.has(b));
    queue.forEach((b) => depth.set(b, b.kind === "node" ? 0 : 1));
    for (const b of queue) for (const to of next.get(b) ?? []) if (!depth.has(to)) { depth.set(to, depth.get(b) + 1); queue.push(to); }
  };
  reach(boxes.filter((b) => !entered.has(b)));
  [...boxes].sort((a, b) => (next.get(b)?.length ?? 0) - (next.get(a)?.length ?? 0)).forEach((b) => reach([b]));
  return depth;
}

function layered(boxes, edges, depth) {
  const { dagre } = window, graph = new dagre.graphlib.Graph();
  graph.setGraph({ rankdir: "LR", nodesep: 12, edgesep: 7, ranksep: 64, ranker: boxes.length > 300 ? "tight-tree" : "network-simplex" });
  for (const b of boxes) graph.setNode(String(b.id), { width: b.w, height: b.h });
  for (const e of edges) {
    e.back = depth.get(e.from) >= depth.get(e.to);
    const [from, to] = e.back ? [e.to, e.from] : [e.from, e.to];
    graph.setEdge(String(from.id), String(to.id), {});
  }
  dagre.layout(graph);
  return graph;
}

// Where an edge crosses columns between its ends; there it runs level, past the boxes.
function wayOf(graph, e, columns) {
  const [from, to] = e.back ? [e.to, e.from] : [e.from, e.to];
  const level = graph.edge(String(from.id), String(to.id)).points.slice(1, -1).filter((p) => columns.has(Math.round(p.x))).map((p) => ({ x: p.x, y: p.y, half: columns.get(Math.round(p.x)) }));
  return e.back ? level.reverse() : level;
}

function placeLane(boxes, below) {
  if (!boxes.length || !below.length) return;
  const { left, right, top } = extent(below), gap = 18, total = boxes.reduce((sum, b) => sum + b.w + gap, -gap);
  let x = (left + right - total) / 2;
  for (const b of boxes) { Object.assign(b, { x: x + b.w / 2, y: top - 76 }); x += b.w + gap; }
}

export function extent(boxes) {
  const edge = (sign, axis, size) => boxes.map((b) => b[axis] + sign * b[size] / 2);
  return { left: Math.min(...edge(-1, "x", "w")), right: Math.max(...edge(1, "x", "w")), top: Math.min(...edge(-1, "y", "h")), bottom: Math.max(...edge(1, "y", "h")) };
}

// Edges leave and reach a box side by side, in the order of where they go.
function ports(picture) {
  const sides = new Map();
  for (const e of picture.edges) {
    const first = e.way[0] ?? e.to, last = e.way.at(-1) ?? e.from;
    e.out = { side: first.x >= e.from.x ? 1 : -1, toward: first.y };
    e.in = { side: last.x > e.to.x ? 1 : -1, toward: last.y };
    push(sides, `${e.from.id}:${e.out.side}`, [e.out, e.from]);
    push(sides, `${e.to.id}:${e.in.side}`, [e.in, e.to]);
  }
  for (const ends of sides.values()) {
    ends.sort(([a], [b]) => a.toward - b.toward);
    const { h } = ends[0][1], step = Math.min((h - 12) / Math.max(ends.length - 1, 1), 14);
    ends.forEach(([end], i) => Object.assign(end, { dy: (i - (ends.length - 1) / 2) * step, room: ends.length > 1 ? step : ROW }));
  }
}

// The path of an edge, and where its label stands.
export function route(e) {
  const start = { x: e.from.x + e.out.side * e.from.w / 2, y: e.from.y + e.out.dy }, end = { x: e.to.x + e.in.side * (e.to.w / 2 + 2), y: e.to.y + e.in.dy };
  let at = start, heading = e.out.side, d = `M${at.x},${at.y}`;
  const curve = (to, out, into) => {
    const reach = Math.max(Math.abs(to.x - at.x) / 2, 24);
    d += `C${at.x + out * reach},${at.y} ${to.x + into * reach},${to.y} ${to.x},${to.y}`;
    at = to;
  };
  for (const p of e.way) {
    const side = p.x >= at.x ? 1 : -1;
    curve({ x: p.x - side * p.half, y: p.y }, heading, -side);
    at = { x: p.x + side * p.half, y: p.y };
    d += `L${at.x},${at.y}`;
    heading = side;
  }
  curve(end, heading, e.in.side);
  return { d, start: { x: start.x + e.out.side * 9, y: start.y - 6, side: e.out.side }, end: { x: end.x + e.in.side * 11, y: end.y - 6, side: e.in.side } };
}
