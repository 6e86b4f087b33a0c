// Starts the page.
import { definitions, dragBox, draw, highlight, isLit } from "./graph/draw.js";
import { extent, graphLayout } from "./graph/layout.js";
import { isGRCN, related, sameChoice } from "./graph/model.js";
import { Viewport } from "./graph/viewport.js";

const svg = byId("picture"), world = byId("world");
const view = new Viewport(svg, world, press, (box, dx, dy) => dragBox(layout, box, dx, dy));
view.covered = () => Math.max(byId("legend").offsetHeight, sheetHeight());

// How much of the picture the details lie over: on a phone they come from below.
function sheetHeight() {
  const picture = svg.getBoundingClientRect(), sheet = byId("detail").getBoundingClientRect();
  return sheet.width && sheet.left < picture.right - 1 ? Math.max(picture.bottom - sheet.top, 0) : 0;
}
let layout = { boxes: [], edges: [] };

function redraw() {
  const endpoints = shownEndpoints();
  layout = graphLayout(MODEL, { endpoints, nodes: shownNodes(), unfolded: state.unfolded, overlay: state.overlay });
  draw(layout, world, { label: flowLabel, pressableEdges: true, tabindex: 0 });
  view.boxes = layout.boxes;
  byId("empty").hidden = layout.boxes.length > 0;
  highlightChoice();
}

// The flows of a GRCN that an edge carries, one for each topic that its node publishes: they show with a choice.
function flowLabel(e) {
  const published = state.overlay ? e.endpoints.filter((each) => each.publishes) : [];
  const flows = published.flatMap(({ node, topic }) => topic.coordination.filter(isGRCN).flatMap((c) => c.guards[0].flows.filter((flow) => flow.nodes.includes(node))));
  return { text: [...e.names, ...new Set(flows.map((flow) => flow.name))].join(", "), look: "flow", at: (path) => path.middle };
}

const NAMED = { node: (m) => m.nodes, topic: (m) => m.topics, risk: (m) => m.riskById, finding: (m) => m.findingById, coordination: (m) => m.coordinationById };
const choiceParts = () => state.choice && related(MODEL, state.choice);
const highlightChoice = () => highlight(layout, world, choiceParts(), state.choice, document);

function press(choice) {
  if (choice?.kind !== "unfold") return choose(choice);
  state.unfolded.add(choice.name);
  redraw();
}

// Where the picture opens: at the worst finding, if not all of it can be read.
function firstBoxes() {
  const [worst] = MODEL.findings, parts = worst && related(MODEL, { kind: "finding", name: worst.id });
  return parts ? layout.boxes.filter((box) => isLit(box, parts)) : [];
}

// Each choice with a name has an address: what is behind # names it.
const address = ({ kind, name }) => `#${kind}:${encodeURI(name).replaceAll("#", "%23")}`;
function addressed() {
  return Object.keys(NAMED).flatMap((kind) => [...NAMED[kind](MODEL).keys()].map((name) => ({ kind, name }))).find((choice) => address(choice) === location.hash);
}

function openAddress() {
  const choice = addressed();
  if (!choice || sameChoice(choice, state.choice)) return;
  choose(choice);
  focusOnChoice();
}

function choose(choice) {
  state.choice = choice;
  history.replaceState(null, "", choice?.name === undefined ? location.pathname + location.search : address(choice));
  reveal(choice);
  showDetail();
  highlightChoice();
}

function focusOnChoice() {
  const parts = choiceParts();
  view.touched = true;
  view.open(layout.boxes.filter((box) => isLit(box, parts)));
}

// A topic that is chosen by name is shown, even if it is a leaf or in a folded box.
function reveal(choice) {
  if (choice?.kind !== "topic") return;
  const topic = MODEL.topics.get(choice.name), box = layout.boxes.find((each) => each.topics?.includes(topic));
  if (box?.rows.some((row) => row.topic === topic)) return;
  state.unfolded.add(choice.name);
  if (!box) state.leaves = true;
  byId("leaves").setAttribute("aria-pressed", state.leaves);
  redraw();
}

function refilter() {
  for (const box of document.querySelectorAll("#facets input")) {
    box.checked = !state.hidden[box.closest("fieldset").dataset.facet].has(box.value);
  }
  byId("only-risks").setAttribute("aria-pressed", state.hidden.risk.has(NO_RISK));
  redraw();
  view.open(firstBoxes());
}

// Keys of the whole page; those of the picture are the viewport's.
function keys(event) {
  const within = (selector) => event.target.closest?.(selector);
  if (within("input") || event.ctrlKey || event.metaKey || event.altKey) {
    if (event.key === "Escape") event.target.blur();
    return;
  }
  const act = { "+": () => view.zoom(1.25), "=": () => view.zoom(1.25), "-": () => view.zoom(0.8), 0: () => view.fit(), Escape: () => choose(null), "/": () => byId("search").focus(), f: () => byId("focus").click(), t: () => byId("theme").click() }[event.key];
  if (!act) return;
  act();
  event.preventDefault();
}

function toggle(id, change) {
  byId(id).addEventListener("click", () => {
    const on = byId(id).getAttribute("aria-pressed") !== "true";
    byId(id).setAttribute("aria-pressed", on);
    change(on);
  });
}

function nextTheme() {
  const order = ["", "light", "dark"], root = document.documentElement;
  const next = order[(order.indexOf(root.dataset.theme ?? "") + 1) % order.length];
  root.dataset.theme = next;
  byId("theme").textContent = next ? `Theme: ${next}` : "Theme";
}

function save() {
  const copy = svg.cloneNode(true), { left, right, top, bottom } = extent(layout.boxes), margin = 24;
  copy.setAttribute("viewBox", `${left - margin} ${top - margin} ${right - left + 2 * margin} ${bottom - top + 2 * margin}`);
  copy.querySelector("#world").removeAttribute("transform");
  copy.setAttribute("data-theme", document.documentElement.dataset.theme ?? "");
  copy.prepend(shape("style", {}, document.querySelector("style").textContent));
  const text = new XMLSerializer().serializeToString(copy);
  const address = URL.createObjectURL(new Blob([text], { type: "image/svg+xml" }));
  tag("a", { href: address, download: "interaction-graph.svg" }).click();
  setTimeout(() => URL.revokeObjectURL(address), 1000);
}

function start() {
  const explicit = MODEL.endpoints.filter((e) => !e.implicit);
  byId("title").textContent = MODEL.app;
  byId("counts").append([`ROS ${MODEL.ros}`, plural(MODEL.nodes.size, "node"), plural(MODEL.topics.size, "topic"), plural(explicit.length, "endpoint"), plural(MODEL.findings.length, "finding")].join(" · "), ...severityCounts());
  svg.querySelector("defs").append(...definitions());
  fillInventory();
  fillFindings();
  fillRisks();
  fillCoordination();
  fillFacets();
  fillUnresolved();
  fillPrinted();
  fillLegend();
  byId("leaves").textContent = `Leaf topics ${leafTopics()}`;
  toggle("only-risks", (on) => { state.hidden.risk[on ? "add" : "delete"](NO_RISK); refilter(); });
  toggle("leaves", (on) => { state.leaves = on; refilter(); });
  toggle("implicit", (on) => { state.implicit = on; refilter(); });
  toggle("overlay", (on) => { state.overlay = on; refilter(); });
  toggle("focus", (on) => { document.body.classList.toggle("focused", on); view.fit(); });
  byId("save").addEventListener("click", save);
  byId("theme").addEventListener("click", nextTheme);
  byId("zoom-in").addEventListener("click", () => view.zoom(1.25));
  byId("zoom-out").addEventListener("click", () => view.zoom(0.8));
  byId("zoom-fit").addEventListener("click", () => view.fit());
  byId("search").addEventListener("input", search);
  byId("search").addEventListener("keydown", (event) => event.key === "Enter" && byId("found").querySelector("button")?.click());
  document.addEventListener("keydown", keys);
  redraw();
  view.show(layout.boxes, firstBoxes);
  addEventListener("hashchange", openAddress);
  openAddress();
}
start();
