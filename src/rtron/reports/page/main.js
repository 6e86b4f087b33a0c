// Starts the page.
function choose(choice) {
  state.chosen = choice;
  unfold(choice);
  showDetail();
  paintChoice();
}

// A topic that is chosen by name is shown, even if it is a leaf or stands in a folded box.
function unfold(choice) {
  if (choice?.kind !== "topic") return;
  const drawn = picture.boxes.find((b) => b.topics?.includes(choice.at));
  if (drawn?.rows.includes(choice.at)) return;
  state.opened.add(choice.at);
  if (!drawn) state.leaves = true;
  byId("leaves").setAttribute("aria-pressed", state.leaves);
  redraw();
}

function refilter() {
  for (const box of document.querySelectorAll("#facets input")) {
    box.checked = !state.off[box.closest("fieldset").dataset.facet].has(box.value);
  }
  byId("only-risks").setAttribute("aria-pressed", state.off.risk.has(NO_RISK));
  redraw();
  fit();
}

function toggle(id, change) {
  byId(id).addEventListener("click", () => {
    const on = byId(id).getAttribute("aria-pressed") !== "true";
    byId(id).setAttribute("aria-pressed", on);
    change(on);
  });
}

function defineMarks() {
  const tips = ["plain", "gr-st", "gr-mt", "watch"].map((name) => shape("marker", { id: `tip-${name}`, class: `tip ${name}`, viewBox: "0 0 8 8", refX: 7, refY: 4, markerWidth: 8, markerHeight: 8, markerUnits: "userSpaceOnUse", orient: "auto" }, shape("path", { d: "M0,0.5 L8,4 L0,7.5 Z" })));
  const stripes = shape("pattern", { id: "stripes", width: 12, height: 12, patternUnits: "userSpaceOnUse", patternTransform: "rotate(45)" }, shape("rect", { class: "stripe-ground", width: 12, height: 12 }), shape("rect", { class: "stripe", width: 6, height: 12 }));
  svg.querySelector("defs").append(...tips, stripes);
}

function nextTheme() {
  const order = ["", "light", "dark"], root = document.documentElement;
  const next = order[(order.indexOf(root.dataset.theme ?? "") + 1) % order.length];
  root.dataset.theme = next;
  byId("theme").textContent = next ? `Theme: ${next}` : "Theme";
}

function save() {
  const copy = svg.cloneNode(true), { left, right, top, bottom } = extent(picture.boxes), margin = 24;
  copy.setAttribute("viewBox", `${left - margin} ${top - margin} ${right - left + 2 * margin} ${bottom - top + 2 * margin}`);
  copy.querySelector("#world").removeAttribute("transform");
  copy.setAttribute("data-theme", document.documentElement.dataset.theme ?? "");
  copy.prepend(shape("style", {}, document.querySelector("style").textContent));
  const text = new XMLSerializer().serializeToString(copy);
  const address = URL.createObjectURL(new Blob([text], { type: "image/svg+xml" }));
  tag("a", { href: address, download: "interaction-graph.svg" }).click();
  setTimeout(() => URL.revokeObjectURL(address), 1000);
}

function leafTopics() {
  const explicit = DATA.endpoints.map((_, i) => i).filter((i) => !DATA.endpoints[i].implicit);
  const topics = (ends) => new Set(ends.map((i) => DATA.endpoints[i].topic)).size;
  return topics(explicit) - topics(explicit.filter(notLeaf(explicit)));
}

function start() {
  const explicit = DATA.endpoints.filter((e) => !e.implicit);
  byId("title").textContent = DATA.app;
  byId("counts").textContent = [`ROS ${DATA.ros}`, plural(DATA.nodes.length, "node"), plural(DATA.topics.length, "topic"), plural(explicit.length, "endpoint"), plural(DATA.risks.length, "risk")].join(" · ");
  defineMarks();
  fillRisks();
  fillCoordination();
  fillFacets();
  fillUnresolved();
  fillLegend();
  byId("leaves").textContent = `Leaf topics ${leafTopics()}`;
  toggle("only-risks", (on) => { state.off.risk[on ? "add" : "delete"](NO_RISK); refilter(); });
  toggle("leaves", (on) => { state.leaves = on; refilter(); });
  toggle("implicit", (on) => { state.implicit = on; refilter(); });
  toggle("overlay", (on) => { state.overlay = on; refilter(); });
  toggle("focus", (on) => { document.body.classList.toggle("focused", on); fit(); });
  byId("save").addEventListener("click", save);
  byId("theme").addEventListener("click", nextTheme);
  byId("zoom-in").addEventListener("click", () => zoom(1.25));
  byId("zoom-out").addEventListener("click", () => zoom(0.8));
  byId("zoom-fit").addEventListener("click", () => fit());
  byId("search").addEventListener("input", search);
  byId("search").addEventListener("keydown", (event) => event.key === "Enter" && byId("found").querySelector("button")?.click());
  document.addEventListener("keydown", keys);
  listen();
  redraw();
  fit();
}
start();
