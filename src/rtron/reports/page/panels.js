// What stands beside the picture: findings, risks, filters, search, unresolved, and the details of a choice.
import { shape } from "./graph/draw.js";

function tag(name, attributes = {}, ...children) {
  const element = document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) {
    if (key.startsWith("on")) element.addEventListener(key.slice(2), value);
    else if (value !== false && value !== undefined) element.setAttribute(key, value === true ? "" : value);
  }
  element.append(...children.filter((child) => child !== null && child !== undefined && child !== ""));
  return element;
}
const KIND_CLASS = (kind) => `kind ${kind.toLowerCase().replace(" ", "-")}`;
const chip = (risk) => tag("span", { class: KIND_CLASS(risk.kind) }, risk.kind);
const severity = (risk) => tag("span", { class: `severity ${risk.severity}` }, risk.severity);
const plural = (number, noun) => `${number} ${noun}${number === 1 ? "" : "s"}`;

function item(choice, attributes, ...children) {
  const button = tag("button", { class: "item", ...attributes, onclick: () => { choose(choice); focusOnChoice(); } }, ...children);
  button.choice = choice;
  return button;
}
const nodeLink = ({ name }) => item({ kind: "node", name }, { class: "item link" }, name);
const topicLink = ({ name }) => item({ kind: "topic", name }, { class: "item link" }, name);
const locations = (evidence) => evidence.length ? tag("ul", { class: "places" }, ...evidence.map((at) => tag("li", {}, tag("code", {}, at)))) : null;
const section = (name, ...children) => children.length ? tag("section", {}, tag("h3", {}, name), ...children) : null;
const facts = (rows) => tag("dl", {}, ...rows.filter(([, value]) => value).flatMap(([name, value]) => [tag("dt", {}, name), tag("dd", {}, value)]));

// How many findings have each severity, the worst first.
function severityCounts() {
  const counts = new Map();
  for (const { severity: each } of MODEL.findings) counts.set(each, (counts.get(each) ?? 0) + 1);
  return ["high", "medium", "low"].filter((each) => counts.has(each)).map((each) => tag("span", { class: `severity ${each}` }, `${counts.get(each)} ${each}`));
}

// Where a finding comes from, each place with the line that stands there, as far as it is known.
const sourceLines = ({ evidence, lines }) => evidence.length ? tag("ul", { class: "places" }, ...evidence.map((at, i) => tag("li", {}, tag("code", {}, at), lines[i] ? tag("pre", {}, lines[i]) : null))) : null;

// What is printed instead of the picture: each finding in full.
function fillPrinted() {
  byId("printed").append(...MODEL.findings.map((finding) => tag("article", {},
    tag("h2", {}, severity(finding), " ", finding.summary), tag("p", {}, finding.cause), tag("p", {}, `What to do: ${finding.remedy}`),
    sourceLines(finding), tag("p", { class: "note" }, `${finding.rule}, ${finding.certainty}`))));
}

function fillFindings() {
  byId("finding-count").textContent = MODEL.findings.length;
  const items = MODEL.findings.map((finding) => item({ kind: "finding", name: finding.id }, {}, severity(finding), tag("span", { class: "about" }, finding.summary)));
  byId("findings").append(...items, items.length ? "" : tag("p", { class: "note" }, "No findings in what could be read."));
}

// What can move the robot: each thing with what drives it, who commands it, what else can, and its end.
function fillInventory() {
  byId("inventory-count").textContent = MODEL.inventory.length;
  const rows = ({ rows: all }) => all.map(({ text, tone }) => tag("p", { class: tone }, text));
  const movers = MODEL.inventory.map((mover) => tag("article", { class: "mover" }, tag("h3", {}, mover.thing), ...rows(mover)));
  byId("inventory").append(...movers, movers.length ? "" : tag("p", { class: "note" }, "Nothing in what could be read."));
}

function fillRisks() {
  byId("risk-count").textContent = MODEL.risks.length;
  const kinds = Object.entries(MODEL.kinds).map(([kind, title]) => {
    const risks = MODEL.risks.filter((risk) => risk.kind === kind);
    if (!risks.length) return null;
    return tag("details", { class: "kinds", open: true }, tag("summary", {}, chip(risks[0]), ` ${title} `, tag("b", {}, risks.length)), ...risks.map(riskItem));
  });
  const notRun = MODEL.notRun.map(([rule, why]) => tag("p", { class: "note" }, `${rule} did not run: ${why}`));
  byId("risks").append(...kinds.filter(Boolean), ...notRun, MODEL.risks.length ? "" : tag("p", { class: "note" }, "No risks found in what could be read."));
}

function riskItem(risk) {
  const about = risk.id.includes(":") ? risk.id.slice(risk.id.indexOf(":") + 1) : risk.id;
  return item({ kind: "risk", name: risk.id }, { title: risk.reason }, severity(risk), tag("span", { class: "about" }, about));
}

function fillCoordination() {
  byId("coordination-count").textContent = MODEL.coordination.length;
  byId("coordination-list").hidden = byId("overlay").hidden = !MODEL.coordination.length;
  byId("coordination").append(...MODEL.coordination.map((c) => item({ kind: "coordination", name: c.id }, {},
    tag("span", { class: `mode ${c.mode}` }, c.kind), tag("span", { class: "about" }, c.kind === "GRCN" ? c.guards[0].topic.name : c.id))));
}

function fillUnresolved() {
  byId("unresolved-count").textContent = MODEL.unresolved.reduce((sum, group) => sum + group.notes.length, 0);
  byId("unresolved-list").hidden = !MODEL.unresolved.length;
  byId("unresolved").append(...MODEL.unresolved.map((group) => tag("details", { class: "kinds" },
    tag("summary", {}, `${group.title} `, tag("b", {}, group.notes.length)), tag("p", { class: "note" }, group.remedy),
    ...group.notes.map((u) => tag("div", { class: "unresolved" }, tag("b", {}, u.what), tag("p", {}, u.why), locations(u.evidence))))));
}

function fillFacets() {
  for (const [name, facet] of Object.entries(FACETS)) {
    const counts = new Map();
    MODEL.endpoints.flatMap((e) => e.facets[name]).forEach((value) => counts.set(value, (counts.get(value) ?? 0) + 1));
    const sorted = [...counts].sort(([a], [b]) => a < b ? -1 : 1);
    byId("facets").append(tag("fieldset", { "data-facet": name }, tag("legend", {}, facet.title), ...sorted.map(([value, count]) => facetRow(name, value, count))));
  }
}

function facetRow(name, value, count) {
  const box = tag("input", { type: "checkbox", value, onchange: () => { state.hidden[name][box.checked ? "delete" : "add"](value); refilter(); } });
  box.checked = true;
  const only = tag("button", { class: "only", title: `Only ${value}`, onclick: () => {
    const boxes = [...only.closest("fieldset").querySelectorAll("input")];
    const alone = boxes.every((other) => other.checked === (other === box));
    state.hidden[name] = new Set(alone ? [] : boxes.filter((other) => other !== box).map((other) => other.value));
    refilter();
  } }, "only");
  return tag("div", { class: "facet" }, tag("label", {}, box, tag("span", {}, value), tag("i", {}, count)), only);
}

function search() {
  const query = byId("search").value.trim().toLowerCase();
  const has = (...texts) => texts.some((text) => text.toLowerCase().includes(query));
  const nodes = [...MODEL.nodes.values()].filter((node) => has(node.name, node.package)).map(nodeLink);
  const topics = [...MODEL.topics.values()].filter((topic) => has(topic.name, ...topic.types)).map(topicLink);
  const found = query ? [...nodes, ...topics] : [];
  const more = found.length > 40 ? [tag("p", { class: "note" }, `and ${found.length - 40} more`)] : [];
  byId("found").replaceChildren(...found.slice(0, 40), ...more, query && !found.length ? tag("p", { class: "note" }, "Nothing has this name.") : "");
}

function showDetail() {
  const panel = byId("detail"), { choice } = state;
  panel.hidden = !choice;
  if (!choice) return;
  const close = tag("button", { class: "close", title: "Close (Esc)", "aria-label": "Close", onclick: () => choose(null) }, "×");
  panel.replaceChildren(close, ...DETAIL[choice.kind](choice).filter(Boolean));
  panel.scrollTop = 0;
}

const heading = (kind, name) => [tag("p", { class: "what" }, kind), tag("h2", {}, name)];
const DETAIL = {
  node({ name }) {
    const node = MODEL.nodes.get(name);
    const side = (publishes) => node.endpoints.filter((e) => e.publishes === publishes).map((e) => endpointCard(e, topicLink(e.topic)));
    return [...heading("node", name),
      facts([["package", node.package], ["executable", node.executable], ["origin", node.origin], ["trust", node.trust.replace("_", " ")], ["function", node.function], ["domain", node.domain]]),
      riskSection(node.risks), section("Publishes", ...side(true)), section("Subscribes", ...side(false)),
      section("Actions", ...sides(MODEL.actions, node)), section("Services", ...sides(MODEL.services, node)), guardSection(node.coordination)];
  },
  topic({ name }) {
    const topic = MODEL.topics.get(name);
    const side = (publishes) => topic.endpoints.filter((e) => e.publishes === publishes).map((e) => endpointCard(e, nodeLink(e.node)));
    return [...heading("topic", name),
      facts([["type", topic.types.join(", ") || UNKNOWN], ["domain", topic.domain], ["sharing", topic.sharing]]),
      riskSection(topic.risks), guardSection(topic.coordination),
      section("Publishers", ...side(true)), section("Subscribers", ...side(false))];
  },
  endpoints({ endpoints }) {
    const [first] = endpoints;
    return [...heading(first.publishes ? "publishes" : "subscribes", first.node.name),
      ...endpoints.map((e) => endpointCard(e, topicLink(e.topic))), section("Node", nodeLink(first.node))];
  },
  risk({ name }) {
    const risk = MODEL.riskById.get(name);
    return [tag("p", { class: "what" }, chip(risk), " ", severity(risk)), tag("h2", {}, MODEL.kinds[risk.kind]), tag("p", { class: "reason" }, risk.reason),
      facts([["domain", risk.domain], ["type", risk.type], ["rule", risk.rule]]),
      section("Topics", ...risk.topics.map(topicLink)),
      ...risk.roles.map(([role, nodes]) => section(`High-risk nodes: ${role}`, ...nodes.map(nodeLink))),
      section("Successors", ...risk.successors.map(nodeLink)),
      section("Evidence", ...[locations(risk.evidence)].filter(Boolean))];
  },
  finding({ name }) {
    const finding = MODEL.findingById.get(name);
    return [tag("p", { class: "what" }, severity(finding), " ", finding.certainty), tag("h2", {}, finding.summary), tag("p", { class: "reason" }, finding.cause),
      section("What to do", tag("p", { class: "reason" }, finding.remedy)),
      section("Source", ...[sourceLines(finding)].filter(Boolean)),
      facts([["rule", finding.rule], ["explained by", `rtron explain ${finding.rule}`]]),
      section("Topics", ...finding.topics.map(topicLink)),
      section("Nodes", ...finding.nodes.map(nodeLink))];
  },
  coordination({ name }) {
    const c = MODEL.coordinationById.get(name);
    return [...heading(c.kind, c.id),
      facts([["policy", c.policy], ["mode", c.mode], ["domain", c.domain], ["sharing", c.sharing], ["unapproved", c.unapproved]]),
      ...(c.terms ?? []).map((text) => tag("p", { class: "note" }, text)),
      section("Rules", ...(c.rules ?? []).map(([rule, text, reason]) => tag("div", { class: "card" }, tag("b", {}, rule), tag("p", {}, text), reason ? tag("p", { class: "note" }, reason) : null))),
      section("Guards", ...c.guards.map(guardCard)),
      section("Watches", ...c.watches.map((watch) => tag("div", { class: "card" }, tag("b", {}, watch.name), " ", topicLink(watch.topic), tag("p", { class: "note" }, `from ${watch.publisher}`), watch.note ? tag("p", { class: "note" }, watch.note) : null)))];
  },
};

function endpointCard(e, link) {
  return tag("div", { class: "card" }, link,
    tag("p", { class: "note" }, e.type, " ", tag("span", { class: "resolution" }, e.resolution), e.implicit ? " implicit" : ""),
    e.declared ? tag("p", { class: "note" }, "remapped from ", tag("code", {}, e.declared)) : null, locations(e.evidence));
}

function guardCard(guard) {
  const terms = (flow) => [flow.block ? "blocked" : "pass", flow.terms].filter(Boolean).join(", ");
  const rows = guard.flows.map((flow) => tag("tr", {}, tag("td", {}, flow.name), tag("td", {}, flow.publisher), tag("td", {}, terms(flow))));
  return tag("div", { class: "card" }, topicLink(guard.topic), tag("table", {}, tag("tbody", {}, ...rows)),
    guard.successors.length ? tag("p", { class: "note" }, `to ${guard.successors.join(", ")}`) : null);
}

const sides = (list, node) => list.filter((side) => side.node === node.number).map((side) => tag("div", { class: "card" }, side.name, tag("p", { class: "note" }, [side.type, side.role].filter(Boolean).join(" · "))));
const riskSection = (risks) => section("Risks", ...risks.map((risk) => item({ kind: "risk", name: risk.id }, { class: "item card" }, chip(risk), " ", severity(risk), tag("span", { class: "note" }, risk.reason))));
const guardSection = (coordination) => section("Coordination nodes", ...coordination.map((c) =>
  item({ kind: "coordination", name: c.id }, {}, tag("span", { class: `mode ${c.mode}` }, c.kind), tag("span", { class: "about" }, [c.policy, c.mode].filter(Boolean).join(" · ") || c.id))));

function fillLegend() {
  const rows = [["pill", "node"], ["pill third_party", "third party"], ["row", "topic"], ["gr-st", "GR-ST"], ["gr-mt", "GR-MT"], ["row event", "MSR event"], ["row action", "MSR action"], ["pill image", "RSR image"], ["pill max_vel", "RSR max_vel"], ...(MODEL.coordination.length ? [["guard enforce", "enforces"], ["guard observe", "observes"]] : [])];
  byId("legend").append(...rows.map(([look, text]) => tag("span", { class: "key" }, swatch(look), text)));
}

function swatch(look) {
  const icon = shape("svg", { width: 26, height: 16, class: "swatch", "aria-hidden": "true" });
  if (look.startsWith("gr-")) icon.append(shape("path", { class: `line ${look}`, d: "M1,8 H20", "marker-end": `url(#tip-${look})` }));
  else icon.append(shape("g", { class: look }, shape("rect", { class: "frame ground", x: 1, y: 2, width: 24, height: 12, rx: look.startsWith("pill") ? 6 : 3 })));
  return icon;
}
