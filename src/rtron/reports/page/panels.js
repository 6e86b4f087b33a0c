// What stands beside the picture: risks, filters, search, unresolved, and the details of a choice.
const KIND_CLASS = (kind) => `kind ${kind.toLowerCase().replace(" ", "-")}`;
const chip = (risk) => tag("span", { class: KIND_CLASS(risk.kind) }, risk.kind);
const severity = (risk) => tag("span", { class: `severity ${risk.severity}` }, risk.severity);
const plural = (number, noun) => `${number} ${noun}${number === 1 ? "" : "s"}`;

function item(choice, attributes, ...children) {
  const button = tag("button", { class: "item", ...attributes, onclick: () => { choose(choice); fitLit(); } }, ...children);
  button.choice = choice;
  return button;
}
const nodeLink = (n) => item({ kind: "node", at: n }, { class: "item link" }, DATA.nodes[n].name);
const topicLink = (t) => item({ kind: "topic", at: t }, { class: "item link" }, DATA.topics[t].name);
const places = (evidence) => evidence.length ? tag("ul", { class: "places" }, ...evidence.map((at) => tag("li", {}, tag("code", {}, at)))) : null;
const section = (name, ...children) => children.length ? tag("section", {}, tag("h3", {}, name), ...children) : null;
const facts = (rows) => tag("dl", {}, ...rows.filter(([, value]) => value).flatMap(([name, value]) => [tag("dt", {}, name), tag("dd", {}, value)]));

function fillRisks() {
  byId("risk-count").textContent = DATA.risks.length;
  const kinds = Object.entries(DATA.kinds).map(([kind, said]) => {
    const risks = DATA.risks.map((risk, i) => [risk, i]).filter(([risk]) => risk.kind === kind);
    if (!risks.length) return null;
    return tag("details", { class: "kinds", open: true }, tag("summary", {}, chip(risks[0][0]), ` ${said} `, tag("b", {}, risks.length)), ...risks.map(([risk, i]) => riskItem(risk, i)));
  });
  const notRun = DATA.notRun.map(([rule, why]) => tag("p", { class: "note" }, `${rule} did not run: ${why}`));
  byId("risks").append(...kinds.filter(Boolean), ...notRun, DATA.risks.length ? "" : tag("p", { class: "note" }, "No risks found in what could be read."));
}

function riskItem(risk, i) {
  const about = risk.id.includes(":") ? risk.id.slice(risk.id.indexOf(":") + 1) : risk.id;
  return item({ kind: "risk", at: i }, { title: risk.reason }, severity(risk), tag("span", { class: "about" }, about));
}

function fillCoordination() {
  byId("coordination-count").textContent = DATA.coordination.length;
  byId("coordination-list").hidden = byId("overlay").hidden = !DATA.coordination.length;
  byId("coordination").append(...DATA.coordination.map((c, i) => item({ kind: "coordination", at: i }, {},
    tag("span", { class: `mode ${c.mode}` }, c.kind), tag("span", { class: "about" }, c.kind === "GRCN" ? DATA.topics[c.guards[0].topic].name : c.id))));
}

function fillUnresolved() {
  byId("unresolved-count").textContent = DATA.unresolved.length;
  byId("unresolved-list").hidden = !DATA.unresolved.length;
  byId("unresolved").append(...DATA.unresolved.map((u) => tag("div", { class: "unresolved" }, tag("b", {}, u.what), tag("p", {}, u.why), places(u.evidence))));
}

function fillFacets() {
  for (const [name, facet] of Object.entries(FACETS)) {
    const counts = new Map();
    valuesOf[name].flat().forEach((value) => counts.set(value, (counts.get(value) ?? 0) + 1));
    const sorted = [...counts].sort(([a], [b]) => a < b ? -1 : 1);
    byId("facets").append(tag("fieldset", { "data-facet": name }, tag("legend", {}, facet.title), ...sorted.map(([value, count]) => facetRow(name, value, count))));
  }
}

function facetRow(name, value, count) {
  const box = tag("input", { type: "checkbox", value, onchange: () => { state.off[name][box.checked ? "delete" : "add"](value); refilter(); } });
  box.checked = true;
  const only = tag("button", { class: "only", title: `Only ${value}`, onclick: () => {
    const boxes = [...only.closest("fieldset").querySelectorAll("input")];
    const alone = boxes.every((other) => other.checked === (other === box));
    state.off[name] = new Set(alone ? [] : boxes.filter((other) => other !== box).map((other) => other.value));
    refilter();
  } }, "only");
  return tag("div", { class: "facet" }, tag("label", {}, box, tag("span", {}, value), tag("i", {}, count)), only);
}

function search() {
  const query = byId("search").value.trim().toLowerCase();
  const has = (...texts) => texts.some((text) => text.toLowerCase().includes(query));
  const nodes = DATA.nodes.map((node, n) => has(node.name, node.package) && nodeLink(n));
  const topics = DATA.topics.map((topic, t) => has(topic.name, ...topic.types) && topicLink(t));
  const found = query ? [...nodes, ...topics].filter(Boolean) : [];
  const more = found.length > 40 ? [tag("p", { class: "note" }, `and ${found.length - 40} more`)] : [];
  byId("found").replaceChildren(...found.slice(0, 40), ...more, query && !found.length ? tag("p", { class: "note" }, "Nothing has this name.") : "");
}

function showDetail() {
  const panel = byId("detail"), choice = state.chosen;
  panel.hidden = !choice;
  if (!choice) return;
  const close = tag("button", { class: "close", title: "Close (Esc)", "aria-label": "Close", onclick: () => choose(null) }, "×");
  panel.replaceChildren(close, ...DETAIL[choice.kind](choice.at).filter(Boolean));
  panel.scrollTop = 0;
}

const heading = (kind, name) => [tag("p", { class: "what" }, kind), tag("h2", {}, name)];
const DETAIL = {
  node(n) {
    const node = DATA.nodes[n], ends = ofNode.get(n) ?? [];
    const side = (publishes) => ends.filter((i) => DATA.endpoints[i].publishes === publishes).map((i) => endpointCard(i, topicLink(DATA.endpoints[i].topic)));
    return [...heading("node", node.name),
      facts([["package", node.package], ["executable", node.executable], ["origin", node.origin], ["trust", node.trust.replace("_", " ")], ["function", node.function], ["domain", node.domain]]),
      riskSection(risksOfNode.get(n)), section("Publishes", ...side(true)), section("Subscribes", ...side(false)),
      section("Actions", ...sides(DATA.actions, n)), section("Services", ...sides(DATA.services, n)), guardSection(watchersOfNode.get(n))];
  },
  topic(t) {
    const topic = DATA.topics[t], ends = ofTopic.get(t) ?? [];
    const side = (publishes) => ends.filter((i) => DATA.endpoints[i].publishes === publishes).map((i) => endpointCard(i, nodeLink(DATA.endpoints[i].node)));
    return [...heading("topic", topic.name),
      facts([["type", topic.types.join(", ") || UNKNOWN], ["domain", topic.domain], ["sharing", topic.sharing]]),
      riskSection(risksOfTopic.get(t)), guardSection([...(guardsOfTopic.get(t) ?? []), ...(watchersOfTopic.get(t) ?? [])]),
      section("Publishers", ...side(true)), section("Subscribers", ...side(false))];
  },
  endpoints(ends) {
    const first = DATA.endpoints[ends[0]];
    return [...heading(first.publishes ? "publishes" : "subscribes", DATA.nodes[first.node].name),
      ...ends.map((i) => endpointCard(i, topicLink(DATA.endpoints[i].topic))), section("Node", nodeLink(first.node))];
  },
  risk(r) {
    const risk = DATA.risks[r];
    return [tag("p", { class: "what" }, chip(risk), " ", severity(risk)), tag("h2", {}, DATA.kinds[risk.kind]), tag("p", { class: "reason" }, risk.reason),
      facts([["domain", risk.domain], ["type", risk.type], ["rule", risk.rule]]),
      section("Topics", ...risk.topics.map(topicLink)),
      ...risk.roles.map(([role, nodes]) => section(`High-risk nodes: ${role}`, ...nodes.map(nodeLink))),
      section("Successors", ...risk.successors.map(nodeLink)),
      section("Evidence", ...[places(risk.evidence)].filter(Boolean))];
  },
  coordination(c) {
    const node = DATA.coordination[c];
    return [...heading(node.kind, node.id),
      facts([["policy", node.policy], ["mode", node.mode], ["domain", node.domain], ["sharing", node.sharing], ["unapproved", node.unapproved]]),
      ...(node.terms ?? []).map((words) => tag("p", { class: "note" }, words)),
      section("Rules", ...(node.rules ?? []).map(([name, words, reason]) => tag("div", { class: "card" }, tag("b", {}, name), tag("p", {}, words), reason ? tag("p", { class: "note" }, reason) : null))),
      section("Guards", ...node.guards.map(guardCard)),
      section("Watches", ...node.watches.map((watch) => tag("div", { class: "card" }, tag("b", {}, watch.name), " ", topicLink(watch.topic), tag("p", { class: "note" }, `from ${watch.publisher}`), watch.note ? tag("p", { class: "note" }, watch.note) : null)))];
  },
};

function endpointCard(i, link) {
  const e = DATA.endpoints[i];
  return tag("div", { class: "card" }, link,
    tag("p", { class: "note" }, e.type, " ", tag("span", { class: "resolution" }, e.resolution), e.implicit ? " implicit" : ""),
    e.declared ? tag("p", { class: "note" }, "remapped from ", tag("code", {}, e.declared)) : null, places(e.evidence));
}

function guardCard(guard) {
  const terms = (flow) => [flow.block ? "blocked" : "pass", flow.terms].filter(Boolean).join(", ");
  const rows = guard.flows.map((flow) => tag("tr", {}, tag("td", {}, flow.name), tag("td", {}, flow.publisher), tag("td", {}, terms(flow))));
  return tag("div", { class: "card" }, topicLink(guard.topic), tag("table", {}, tag("tbody", {}, ...rows)),
    guard.successors.length ? tag("p", { class: "note" }, `to ${guard.successors.join(", ")}`) : null);
}

const sides = (list, n) => list.filter((side) => side.node === n).map((side) => tag("div", { class: "card" }, side.name, tag("p", { class: "note" }, [side.type, side.role].filter(Boolean).join(" · "))));
const riskSection = (risks = []) => section("Risks", ...risks.map((r) => {
  const risk = DATA.risks[r];
  return item({ kind: "risk", at: r }, { class: "item card" }, chip(risk), " ", severity(risk), tag("span", { class: "note" }, risk.reason));
}));
const guardSection = (guards = []) => section("Coordination nodes", ...[...new Set(guards)].map((c) => {
  const node = DATA.coordination[c];
  return item({ kind: "coordination", at: c }, {}, tag("span", { class: `mode ${node.mode}` }, node.kind), tag("span", { class: "about" }, [node.policy, node.mode].filter(Boolean).join(" · ") || node.id));
}));

function fillLegend() {
  const rows = [["pill", "node"], ["pill third_party", "third party"], ["row", "topic"], ["gr-st", "GR-ST"], ["gr-mt", "GR-MT"], ["row event", "MSR event"], ["row action", "MSR action"], ["pill image", "RSR image"], ["pill max_vel", "RSR max_vel"], ...(DATA.coordination.length ? [["guard enforce", "enforces"], ["guard observe", "observes"]] : [])];
  byId("legend").append(...rows.map(([look, said]) => tag("span", { class: "key" }, swatch(look), said)));
}

function swatch(look) {
  const icon = shape("svg", { width: 26, height: 16, class: "swatch", "aria-hidden": "true" });
  if (look.startsWith("gr-")) icon.append(shape("path", { class: `line ${look}`, d: "M1,8 H20", "marker-end": `url(#tip-${look})` }));
  else icon.append(shape("g", { class: look }, shape("rect", { class: "frame ground", x: 1, y: 2, width: 24, height: 12, rx: look.startsWith("pill") ? 6 : 3 })));
  return icon;
}
