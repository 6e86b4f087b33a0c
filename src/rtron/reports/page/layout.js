// From the shown part to boxes and edges with places. Topics with the same neighbours share a box.
const ROW = 21, PAD = 6, FONT = '12px system-ui, "Segoe UI", Roboto, "Helvetica Neue", Arial, sans-serif';
const measure = (() => {
  const context = document.createElement("canvas").getContext("2d");
  return (text, weight = 400) => { context.font = `${weight} ${FONT}`; return context.measureText(text).width; };
})();
const LONGEST = 40, MOST_ROWS = 8, FEWER_ROWS = 5, WIDE = 1.5;
const brief = (name) => name.length <= LONGEST ? name : `${name.slice(0, 20)}…${name.slice(-(LONGEST - 21))}`;
const isGRCN = (c) => DATA.coordination[c].kind === "GRCN";
const pillsOf = (t) => state.overlay ? (guardsOfTopic.get(t) ?? []).filter(isGRCN) : [];
const PILL = 42;

function model() {
  const endpoints = shownEndpoints(), boxes = [], edges = new Map();
  const nodes = new Map(), topics = new Map();
  for (const n of [...shownNodes(endpoints)].sort((a, b) => a - b)) nodes.set(n, box(boxes, nodeBox(n)));
  for (const group of groups(endpoints)) {
    const made = box(boxes, topicBox(group));
    group.forEach((t) => topics.set(t, made));
  }
  for (const i of endpoints) {
    const e = DATA.endpoints[i], ends = [nodes.get(e.node), topics.get(e.topic)];
    join(edges, ...(e.publishes ? ends : ends.reverse()), { endpoint: i });
  }
  if (state.overlay) coordination(boxes, edges, topics);
  return { boxes, edges: [...edges.values()], nodes, topics };
}

function box(boxes, made) { made.id = boxes.length; boxes.push(made); return made; }

function nodeBox(n) {
  return { kind: "node", node: n, label: brief(DATA.nodes[n].name), w: measure(brief(DATA.nodes[n].name), 600) + 30, h: 30 };
}

// A long box shows its first topics and how many more it has, until it is opened.
function topicBox(topics) {
  const folded = topics.length > MOST_ROWS && !topics.some((t) => state.opened.has(t));
  const rows = folded ? topics.slice(0, FEWER_ROWS) : topics;
  const more = topics.length - rows.length;
  const width = (t) => measure(brief(DATA.topics[t].name)) + (pillsOf(t).length ? PILL + 6 : 0);
  return { kind: "topics", topics, rows, more, w: Math.max(...rows.map(width)) + 22, h: (rows.length + (more ? 1 : 0)) * ROW + PAD };
}

function groups(endpoints) {
  const signature = new Map(), alike = new Map();
  for (const i of endpoints) {
    const e = DATA.endpoints[i];
    push(signature, e.topic, `${e.publishes ? ">" : "<"}${e.node}:${e.marks.join("+")}`);
  }
  for (const [t, ends] of signature) {
    const apart = state.overlay && [...(guardsOfTopic.get(t) ?? []), ...(watchersOfTopic.get(t) ?? [])].filter((c) => !isGRCN(c));
    push(alike, `${[...new Set(ends)].sort().join(" ")}|${DATA.topics[t].marks}|${apart}`, t);
  }
  return [...alike.values()].map((group) => group.sort(riskyFirst));
}

function riskyFirst(a, b) {
  const risky = (t) => risksOfTopic.has(t) ? 0 : 1;
  return risky(a) - risky(b) || (DATA.topics[a].name < DATA.topics[b].name ? -1 : 1);
}

function join(edges, from, to, { endpoint, coordination, name }) {
  if (!from || !to) return;
  const key = `${from.id}>${to.id}`;
  if (!edges.has(key)) edges.set(key, { from, to, endpoints: [], coordination: [], names: [], kinds: new Set() });
  const edge = edges.get(key);
  if (endpoint !== undefined) {
    edge.endpoints.push(endpoint);
    DATA.endpoints[endpoint].marks.forEach((kind) => edge.kinds.add(kind));
  }
  if (coordination !== undefined) { edge.coordination.push(coordination); edge.names.push(name); }
}

// The app's one RSRCN, one MSRCN and the fps_monitors: they stand in a lane of their own.
function coordination(boxes, edges, topics) {
  const made = new Map();
  DATA.coordination.forEach((c, i) => {
    const shown = [...c.guards, ...c.watches].some((part) => topics.has(part.topic));
    if (!isGRCN(i) && shown) made.set(i, box(boxes, laneBox(c, i)));
  });
  for (const [i, own] of made) {
    const c = DATA.coordination[i];
    for (const watch of c.watches) join(edges, watched(made, c, watch) ?? topics.get(watch.topic), own, { coordination: i, name: watch.name });
    for (const guard of c.guards) join(edges, own, topics.get(guard.topic), { coordination: i, name: guard.flows.map((f) => f.name).join(", ") });
  }
}

function laneBox(c, i) {
  const under = c.policy ? `${c.policy} · ${c.mode}` : brief(c.watches[0].publisher);
  return { kind: "coordination", coordination: i, label: c.kind, under, w: Math.max(measure(c.kind, 600), measure(under) * 0.92) + 40, h: 42 };
}

function watched(made, c, watch) {
  if (c.kind !== "RSRCN") return undefined;
  const monitor = (watchersOfTopic.get(watch.topic) ?? []).find((o) => DATA.coordination[o].kind === "fps_monitor" && DATA.coordination[o].watches[0].publisher === watch.publisher);
  return made.get(monitor);
}

function place(picture) {
  const inLane = (b) => b.kind === "coordination";
  const boxes = picture.boxes.filter((b) => !inLane(b)), lane = picture.boxes.filter(inLane);
  const edges = picture.edges.filter((e) => e.endpoints.length);
  heighten(boxes, edges);
  const graph = layered(boxes, edges, depths(boxes, edges));
  for (const b of boxes) ({ x: b.x, y: b.y } = graph.node(String(b.id)));
  const columns = halfWidths(boxes), { left, right, top, bottom } = extent(boxes);
  const wider = Math.min(Math.max(WIDE * (bottom - top) / (right - left), 1), 2);
  for (const e of picture.edges) e.way = e.endpoints.length ? way(graph, e, columns) : [];
  for (const part of [...boxes, ...picture.edges.flatMap((e) => e.way)]) part.x *= wider;
  placeLane(lane, boxes);
  ports(picture);
}

function heighten(boxes, edges) {
  const degree = by(edges.flatMap((e) => [`${e.from.id}>`, `>${e.to.id}`]), (key) => key);
  const count = (key) => degree.get(key)?.length ?? 0;
  for (const b of boxes) {
    if (b.kind === "node") b.h = Math.max(b.h, Math.min(12 + Math.max(count(`${b.id}>`), count(`>${b.id}`)) * 6, 200));
  }
}

// How many steps each box is from where data comes in: edges that lead back make no new column.
function depths(boxes, edges) {
  const next = new Map(), entered = new Set(edges.map((e) => e.to)), depth = new Map();
  edges.forEach((e) => push(next, e.from, e.to));
  const reach = (from) => {
    const queue = from.filter((b) => !depth.has(b));
    queue.forEach((b) => depth.set(b, b.kind === "node" ? 0 : 1));
    for (const b of queue) for (const to of next.get(b) ?? []) {
      if (!depth.has(to)) { depth.set(to, depth.get(b) + 1); queue.push(to); }
    }
  };
  reach(boxes.filter((b) => !entered.has(b)));
  const talkative = [...boxes].sort((a, b) => (next.get(b)?.length ?? 0) - (next.get(a)?.length ?? 0));
  talkative.forEach((b) => reach([b]));
  return depth;
}

function layered(boxes, edges, depth) {
  const graph = new dagre.graphlib.Graph();
  graph.setGraph({ rankdir: "LR", nodesep: 12, edgesep: 7, ranksep: 76, ranker: boxes.length > 500 ? "tight-tree" : "network-simplex" });
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
function way(graph, e, columns) {
  const [from, to] = e.back ? [e.to, e.from] : [e.from, e.to];
  const points = graph.edge(String(from.id), String(to.id)).points.slice(1, -1).filter((p) => columns.has(Math.round(p.x)));
  const level = points.map((p) => ({ x: p.x, y: p.y, half: columns.get(Math.round(p.x)) }));
  return e.back ? level.reverse() : level;
}

function placeLane(lane, boxes) {
  if (!lane.length || !boxes.length) return;
  const { left, right, top } = extent(boxes), gap = 18;
  const width = lane.reduce((sum, b) => sum + b.w + gap, -gap);
  let x = (left + right - width) / 2;
  for (const b of lane) {
    b.x = x + b.w / 2;
    b.y = top - 70;
    x += b.w + gap;
  }
}

function halfWidths(boxes) {
  const columns = new Map();
  for (const b of boxes) columns.set(Math.round(b.x), Math.max(columns.get(Math.round(b.x)) ?? 0, b.w / 2));
  return columns;
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
    ends.forEach(([end], i) => { end.dy = (i - (ends.length - 1) / 2) * step; });
  }
}
