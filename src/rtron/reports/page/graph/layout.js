// From endpoints to boxes and edges with positions, by dagre. Topics with the same neighbours share a box.
import { isGRCN, isMonitor, push } from "./model.js";

export const ROW = 21;
export const PAD = 6;
export const PILL = 46;
const FONT = '12px system-ui, "Segoe UI", Roboto, "Helvetica Neue", Arial, sans-serif', MAX_LENGTH = 40, MAX_ROWS = 8, FOLDED_ROWS = 5, ASPECT = 1.5, MANY_BOXES = 300, LANE_HEIGHT = 76;
const context = document.createElement("canvas").getContext("2d");
const textWidth = (text, weight = 400) => { context.font = `${weight} ${FONT}`; return context.measureText(text).width; };
export const shorten = (name) => name.length <= MAX_LENGTH ? name : `${name.slice(0, 20)}…${name.slice(-(MAX_LENGTH - 21))}`;

// `nodes` are drawn even without endpoints, `unfolded` topics have all rows of their box shown.
export function graphLayout(model, { endpoints, nodes = [], unfolded, overlay = true }) {
  const boxes = [], edges = new Map(), at = new Map();
  const add = (box) => { box.id = boxes.length; boxes.push(box); return box; };
  for (const node of new Set([...nodes, ...endpoints.map((e) => e.node)])) at.set(node, add(nodeBox(node)));
  for (const group of topicGroups(endpoints, overlay)) {
    const box = add(topicBox(group, unfolded, overlay));
    group.forEach((topic) => at.set(topic, box));
  }
  for (const e of endpoints) connect(edges, ...(e.publishes ? [at.get(e.node), at.get(e.topic)] : [at.get(e.topic), at.get(e.node)]), { endpoint: e });
  if (overlay) addLane(model.coordination, add, edges, at);
  const layout = { boxes, edges: [...edges.values()], at };
  placeBoxes(layout);
  return layout;
}

function nodeBox(node) {
  const label = shorten(node.name);
  return { kind: "node", node, label, w: textWidth(label, 600) + 30, h: 30 };
}

// A long box shows its first topics and how many more it has, until it is unfolded.
function topicBox(topics, unfolded, overlay) {
  const folded = topics.length > MAX_ROWS && !topics.some((topic) => unfolded.has(topic.name));
  const rows = (folded ? topics.slice(0, FOLDED_ROWS) : topics).map((topic) => ({ topic, grcn: overlay ? topic.coordination.find(isGRCN) : undefined }));
  const more = topics.length - rows.length, width = ({ topic, grcn }) => textWidth(shorten(topic.name)) + (grcn ? PILL + 6 : 0);
  return { kind: "topics", topics, rows, more, w: Math.max(...rows.map(width)) + 22, h: (rows.length + (more ? 1 : 0)) * ROW + PAD };
}

function topicGroups(endpoints, overlay) {
  const signatures = new Map(), groups = new Map();
  for (const e of endpoints) push(signatures, e.topic, `${e.publishes ? ">" : "<"}${e.node.name}:${e.marks.join("+")}`);
  for (const [topic, parts] of signatures) {
    const apart = overlay ? topic.coordination.filter((c) => !isGRCN(c)).map((c) => c.id) : [];
    push(groups, JSON.stringify([[...new Set(parts)].sort(), topic.marks, apart]), topic);
  }
  return [...groups.values()].map((group) => group.sort((a, b) => (b.risks.length > 0) - (a.risks.length > 0) || (a.name < b.name ? -1 : 1)));
}

function connect(edges, from, to, { endpoint, coordination, name }) {
  if (!from || !to) return;
  const key = `${from.id}>${to.id}`;
  if (!edges.has(key)) edges.set(key, { key, from, to, endpoints: [], coordination: [], names: [], kinds: new Set() });
  const edge = edges.get(key);
  if (endpoint) { edge.endpoints.push(endpoint); endpoint.marks.forEach((kind) => edge.kinds.add(kind)); }
  if (coordination) { edge.coordination.push(coordination); edge.names.push(name); }
}

// The app's RSRCN, MSRCN and fps_monitors have a lane of their own, above. The RSRCN watches monitors, where there are any.
function addLane(coordination, add, edges, at) {
  const shown = coordination.filter((c) => !isGRCN(c) && [...c.guards, ...c.watches].some((part) => at.has(part.topic)));
  const made = new Map(shown.map((c) => [c, add(laneBox(c))]));
  const monitor = (c, watch) => c.kind === "RSRCN" ? made.get(watch.topic.coordination.find((o) => isMonitor(o) && o.watches[0].publisher === watch.publisher)) : undefined;
  for (const [c, box] of made) {
    for (const watch of c.watches) connect(edges, monitor(c, watch) ?? at.get(watch.topic), box, { coordination: c, name: watch.name });
    for (const guard of c.guards) connect(edges, box, at.get(guard.topic), { coordination: c, name: guard.flows.map((flow) => flow.name).join(", ") });
  }
}

function laneBox(c) {
  const detail = c.policy ? `${c.policy} · ${c.mode}` : shorten(c.watches[0].publisher);
  return { kind: "coordination", coordination: c, label: c.kind, detail, w: Math.max(textWidth(c.kind, 600), textWidth(detail) * 0.92) + 40, h: 42 };
}

function placeBoxes(layout) {
  const inLane = (box) => box.kind === "coordination", boxes = layout.boxes.filter((box) => !inLane(box)), edges = layout.edges.filter((e) => e.endpoints.length);
  growNodes(boxes, edges);
  const graph = dagreLayout(boxes, edges, depths(boxes, edges)), columns = new Map();
  for (const box of boxes) ({ x: box.x, y: box.y } = graph.node(String(box.id)));
  for (const b of boxes) columns.set(Math.round(b.x), Math.max(columns.get(Math.round(b.x)) ?? 0, b.w / 2));
  for (const edge of layout.edges) edge.bends = edge.endpoints.length ? bendsOf(graph, edge, columns) : [];
  widen(boxes, layout.edges);
  placeLane(layout.boxes.filter(inLane), boxes);
  assignPorts(layout.edges);
}

// A node with many edges is higher, so that they do not meet.
function growNodes(boxes, edges) {
  const degree = new Map();
  edges.forEach((e) => [`${e.from.id}>`, `>${e.to.id}`].forEach((key) => degree.set(key, (degree.get(key) ?? 0) + 1)));
  for (const b of boxes) if (b.kind === "node") b.h = Math.max(b.h, Math.min(12 + Math.max(degree.get(`${b.id}>`) ?? 0, degree.get(`>${b.id}`) ?? 0) * 6, 200));
}

// How many steps each box is from where data comes in: edges that lead back make no new column.
function depths(boxes, edges) {
  const next = new Map(), targets = new Set(edges.map((e) => e.to)), depth = new Map();
  edges.forEach((e) => push(next, e.from, e.to));
  const visit = (from) => {
    const queue = from.filter((b) => !depth.has(b));
    queue.forEach((b) => depth.set(b, b.kind === "node" ? 0 : 1));
    for (const b of queue) for (const to of next.get(b) ?? []) if (!depth.has(to)) { depth.set(to, depth.get(b) + 1); queue.push(to); }
  };
  visit(boxes.filter((b) => !targets.has(b)));
  [...boxes].sort((a, b) => (next.get(b)?.length ?? 0) - (next.get(a)?.length ?? 0)).forEach((b) => visit([b]));
  return depth;
}

function dagreLayout(boxes, edges, depth) {
  const { dagre } = globalThis, graph = new dagre.graphlib.Graph();
  graph.setGraph({ rankdir: "LR", nodesep: 12, edgesep: 7, ranksep: 76, ranker: boxes.length > MANY_BOXES ? "tight-tree" : "network-simplex" });
  for (const b of boxes) graph.setNode(String(b.id), { width: b.w, height: b.h });
  for (const e of edges) {
    e.leadsBack = depth.get(e.from) >= depth.get(e.to);
    const [from, to] = e.leadsBack ? [e.to, e.from] : [e.from, e.to];
    graph.setEdge(String(from.id), String(to.id), {});
  }
  dagre.layout(graph);
  return graph;
}

// Where an edge crosses columns between its ends; there it runs level, past the boxes.
function bendsOf(graph, e, columns) {
  const [from, to] = e.leadsBack ? [e.to, e.from] : [e.from, e.to];
  const bends = graph.edge(String(from.id), String(to.id)).points.slice(1, -1).filter((p) => columns.has(Math.round(p.x))).map((p) => ({ x: p.x, y: p.y, half: columns.get(Math.round(p.x)) }));
  return e.leadsBack ? bends.reverse() : bends;
}

// Screens are wide: a tall picture is pulled apart, so that its edges can be told apart.
function widen(boxes, edges) {
  if (!boxes.length) return;
  const { left, right, top, bottom } = extent(boxes), factor = Math.min(Math.max(ASPECT * (bottom - top) / (right - left), 1), 2);
  for (const part of [...boxes, ...edges.flatMap((e) => e.bends)]) part.x *= factor;
}

function placeLane(lane, below) {
  if (!lane.length || !below.length) return;
  const { left, right, top } = extent(below), gap = 18, total = lane.reduce((sum, b) => sum + b.w + gap, -gap);
  let x = (left + right - total) / 2;
  for (const b of lane) { Object.assign(b, { x: x + b.w / 2, y: top - LANE_HEIGHT }); x += b.w + gap; }
}

export function extent(boxes) {
  const edge = (sign, axis, size) => boxes.map((b) => b[axis] + sign * b[size] / 2);
  return { left: Math.min(...edge(-1, "x", "w")), right: Math.max(...edge(1, "x", "w")), top: Math.min(...edge(-1, "y", "h")), bottom: Math.max(...edge(1, "y", "h")) };
}

// Edges leave and reach a box side by side, in the order of where they go.
function assignPorts(edges) {
  const sides = new Map();
  for (const e of edges) {
    const first = e.bends[0] ?? e.to, last = e.bends.at(-1) ?? e.from;
    e.out = { side: first.x >= e.from.x ? 1 : -1, toward: first.y };
    e.in = { side: last.x > e.to.x ? 1 : -1, toward: last.y };
    push(sides, `${e.from.id}:${e.out.side}`, [e.out, e.from]);
    push(sides, `${e.to.id}:${e.in.side}`, [e.in, e.to]);
  }
  for (const ports of sides.values()) {
    ports.sort(([a], [b]) => a.toward - b.toward);
    const { h } = ports[0][1], step = Math.min((h - 12) / Math.max(ports.length - 1, 1), 14);
    ports.forEach(([port], i) => Object.assign(port, { dy: (i - (ports.length - 1) / 2) * step, room: ports.length > 1 ? step : ROW }));
  }
}

// The path of an edge, and where labels at its ends and in its middle stand.
export function edgePath(e) {
  const start = { x: e.from.x + e.out.side * e.from.w / 2, y: e.from.y + e.out.dy }, end = { x: e.to.x + e.in.side * (e.to.w / 2 + 2), y: e.to.y + e.in.dy };
  let at = start, heading = e.out.side, d = `M${at.x},${at.y}`;
  const curve = (to, out, into) => {
    const reach = Math.max(Math.abs(to.x - at.x) / 2, 24);
    d += `C${at.x + out * reach},${at.y} ${to.x + into * reach},${to.y} ${to.x},${to.y}`;
    at = to;
  };
  for (const p of e.bends) {
    const side = p.x >= at.x ? 1 : -1;
    curve({ x: p.x - side * p.half, y: p.y }, heading, -side);
    at = { x: p.x + side * p.half, y: p.y };
    d += `L${at.x},${at.y}`;
    heading = side;
  }
  curve(end, heading, e.in.side);
  const share = e.endpoints.length ? 0.5 : e.to.kind === "coordination" ? 0.25 : 0.75;
  const middle = e.bends[0] ?? { x: start.x + (end.x - start.x) * share, y: start.y + (end.y - start.y) * share };
  return { d, middle: { x: middle.x, y: middle.y - 7, side: 0 }, start: { x: start.x + e.out.side * 9, y: start.y - 6, side: e.out.side }, end: { x: end.x + e.in.side * 11, y: end.y - 6, side: e.in.side } };
}
