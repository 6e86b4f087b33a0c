// The picture: boxes, rows and edges as SVG, with the colours of the risks.
const ICON = "M0,-6 L5,-4 V0.5 C5,4 2.5,6 0,7 C-2.5,6 -5,4 -5,0.5 V-4 Z";
let picture = { boxes: [], edges: [] };

function redraw() {
  picture = model();
  place(picture);
  byId("edges").replaceChildren(...picture.edges.map(drawEdge));
  byId("boxes").replaceChildren(...picture.boxes.map(drawBox));
  picture.edges.forEach(route);
  byId("empty").hidden = picture.boxes.length > 0;
  paintChoice();
}

function drawBox(b) {
  b.element = shape("g", { class: `box ${b.kind}` }, ...DRAW[b.kind](b));
  b.element.dataset.box = b.id;
  moveBox(b);
  return b.element;
}
const moveBox = (b) => b.element.setAttribute("transform", `translate(${b.x},${b.y})`);
const frame = (b, radius, extra = {}) => shape("rect", { class: "frame", x: -b.w / 2, y: -b.h / 2, width: b.w, height: b.h, rx: radius, ...extra });
const words = (text, attributes) => shape("text", { "dominant-baseline": "central", ...attributes }, text);
const title = (text) => shape("title", {}, text);

function pressable(element, choice, label) {
  element.setAttribute("tabindex", "0");
  element.setAttribute("role", "button");
  element.setAttribute("aria-label", label);
  element.choice = choice;
  return element;
}

const DRAW = {
  node(b) {
    const node = DATA.nodes[b.node];
    const body = shape("g", { class: ["press", "pill", node.trust, ...node.marks].join(" ") }, title(`${node.name}\n${node.package || "package not known"} · ${node.trust}`), frame(b, Math.min(b.h / 2, 15)), words(b.label, { "text-anchor": "middle", class: "name" }));
    return [pressable(body, { kind: "node", at: b.node }, `node ${node.name}`)];
  },
  topics(b) {
    const top = -b.h / 2 + PAD / 2;
    b.drawn = b.rows.map((t, i) => drawRow(b, t, top + i * ROW));
    return [frame(b, 4), ...b.drawn, ...(b.more ? [drawMore(b, top + b.rows.length * ROW)] : [])];
  },
  coordination(b) {
    const node = DATA.coordination[b.coordination], dy = b.under ? -8 : 0;
    const body = shape("g", { class: `press guard ${node.mode}` }, title(`${node.kind} ${node.id}`), frame(b, 3),
      shape("path", { class: "icon", d: ICON, transform: `translate(${-b.w / 2 + 14},${dy})` }),
      words(b.label, { x: -b.w / 2 + 26, y: dy, class: "name" }),
      ...(b.under ? [words(b.under, { x: -b.w / 2 + 26, y: 9, class: "under" })] : []));
    return [pressable(body, { kind: "coordination", at: b.coordination }, `${node.kind} ${node.id}`)];
  },
};

function drawRow(b, t, y) {
  const topic = DATA.topics[t], pills = pillsOf(t), left = -b.w / 2 + 11 + (pills.length ? PILL + 6 : 0);
  const row = shape("g", { class: ["press", "row", ...topic.marks].join(" ") }, title([topic.name, ...topic.types].join("\n")),
    shape("rect", { class: "ground", x: -b.w / 2 + 2, y: y + 0.5, width: b.w - 4, height: ROW - 1, rx: 3 }),
    words(brief(topic.name), { x: left, y: y + ROW / 2, class: "name" }));
  pressable(row, { kind: "topic", at: t }, `topic ${topic.name}`);
  return shape("g", { "data-topic": t }, row, ...pills.slice(0, 1).map((c) => drawPill(b, c, y)));
}

function drawMore(b, y) {
  const row = shape("g", { class: "press row more" }, title(b.topics.slice(b.rows.length).map((t) => DATA.topics[t].name).join("\n")),
    shape("rect", { class: "ground", x: -b.w / 2 + 2, y: y + 0.5, width: b.w - 4, height: ROW - 1, rx: 3 }),
    words(`+ ${b.more} more`, { x: -b.w / 2 + 11, y: y + ROW / 2, class: "name" }));
  pressable(row, null, `show ${b.more} more topics`);
  row.act = () => { state.opened.add(b.topics[0]); redraw(); };
  return row;
}

function drawPill(b, c, y) {
  const node = DATA.coordination[c];
  const pill = shape("g", { class: `press guard ${node.mode} small`, transform: `translate(${-b.w / 2 + 6},${y + ROW / 2})` },
    title(`GRCN · ${node.policy} · ${node.mode}`),
    shape("rect", { class: "frame", x: 0, y: -7.5, width: PILL, height: 15, rx: 3 }),
    words("GRCN", { x: PILL / 2, "text-anchor": "middle" }));
  return pressable(pill, { kind: "coordination", at: c }, `GRCN of ${DATA.topics[node.guards[0].topic].name}: ${node.policy}, ${node.mode}`);
}

function drawEdge(e) {
  const kinds = ["GR-ST", "GR-MT"].filter((kind) => e.kinds.has(kind));
  const look = e.endpoints.length ? kinds.join(" ").toLowerCase() : "watch";
  const lines = kinds.length > 1 ? ["gr-st", "gr-mt over"] : [look];
  e.lines = lines.map((name) => shape("path", { class: `line ${name}`, "marker-end": `url(#tip-${name.split(" ")[0] || "plain"})` }));
  e.hit = shape("path", { class: "hit" }, title(edgeTitle(e)));
  e.label = words([...e.names, ...flowsOf(e)].join(", "), { class: "flow", "text-anchor": "middle" });
  e.element = shape("g", { class: e.endpoints.length ? "edge" : "edge lane" }, ...e.lines, e.hit, e.label);
  e.hit.choice = e.endpoints.length ? { kind: "endpoints", at: e.endpoints } : { kind: "coordination", at: e.coordination[0] };
  return e.element;
}

// The flows of a GRCN that an edge is: one for each topic that its node publishes.
function flowsOf(e) {
  const spoken = e.endpoints.map((i) => DATA.endpoints[i]).filter((end) => end.publishes);
  const flows = spoken.flatMap((end) => pillsOf(end.topic).flatMap((c) => DATA.coordination[c].guards[0].flows.filter((flow) => flow.nodes.includes(end.node))));
  return new Set(flows.map((flow) => flow.name));
}

function edgeTitle(e) {
  const ends = e.endpoints.map((i) => DATA.endpoints[i]);
  const said = ends.map((end) => `${DATA.nodes[end.node].name} ${end.publishes ? "publishes" : "subscribes"} ${DATA.topics[end.topic].name}`);
  return [...said.slice(0, 12), ...(said.length > 12 ? ["…"] : []), ...e.names].join("\n");
}

function route(e) {
  const start = { x: e.from.x + e.out.side * e.from.w / 2, y: e.from.y + e.out.dy };
  const end = { x: e.to.x + e.in.side * (e.to.w / 2 + 2), y: e.to.y + e.in.dy };
  let at = start, d = `M${at.x},${at.y}`;
  const curve = (to, out, into) => {
    const reach = Math.max(Math.abs(to.x - at.x) / 2, 24);
    d += `C${at.x + out * reach},${at.y} ${to.x + into * reach},${to.y} ${to.x},${to.y}`;
    at = to;
  };
  let heading = e.out.side;
  for (const p of e.way) {
    const side = p.x >= at.x ? 1 : -1;
    curve({ x: p.x - side * p.half, y: p.y }, heading, -side);
    d += `L${p.x + side * p.half},${p.y}`;
    at = { x: p.x + side * p.half, y: p.y };
    heading = side;
  }
  curve(end, heading, e.in.side);
  for (const line of [...e.lines, e.hit]) line.setAttribute("d", d);
  const near = e.endpoints.length ? 0.5 : e.to.kind === "coordination" ? 0.25 : 0.75;
  const middle = e.way[0] ?? { x: start.x + (end.x - start.x) * near, y: start.y + (end.y - start.y) * near };
  e.label.setAttribute("x", middle.x);
  e.label.setAttribute("y", middle.y - 7);
}

function paintChoice() {
  const lit = state.chosen && lights(state.chosen);
  byId("world").classList.toggle("choosing", Boolean(lit));
  for (const b of picture.boxes) {
    const rows = b.drawn ?? [];
    rows.forEach((row) => row.classList.toggle("lit", Boolean(lit?.topics.has(Number(row.dataset.topic)))));
    const isLit = b.topics?.some((t) => lit?.topics.has(t)) || lit?.nodes.has(b.node) || lit?.coordination.has(b.coordination);
    b.element.classList.toggle("lit", Boolean(isLit));
  }
  for (const e of picture.edges) {
    const isLit = e.endpoints.some((i) => lit?.endpoints.has(i)) || e.coordination.some((c) => lit?.coordination.has(c) && (state.chosen.kind === "coordination" || e.from.element.classList.contains("lit") && e.to.element.classList.contains("lit")));
    e.element.classList.toggle("lit", isLit);
    if (isLit) e.element.parentNode.append(e.element);
  }
  const same = (a, b) => a && b && a.kind === b.kind && String(a.at) === String(b.at);
  document.querySelectorAll(".press, .item").forEach((element) => element.classList.toggle("chosen", same(element.choice, state.chosen)));
}
