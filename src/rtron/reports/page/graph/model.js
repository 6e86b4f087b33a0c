// The interaction graph as objects that know each other; as JSON they have numbers for names.
// A choice is {kind, name}: `node`, `topic`, `coordination`, `risk`, `finding`, or `endpoints` with the edge's own list.
export const push = (map, key, value) => map.has(key) ? map.get(key).push(value) : map.set(key, [value]);
export const isGRCN = (coordination) => coordination.kind === "GRCN";
export const isMonitor = (coordination) => coordination.kind === "fps_monitor";
const byName = (items, key = "name") => new Map(items.map((item) => [item[key], item]));
const unique = (items) => [...new Set(items)];

export function graphModel(data) {
  const nodes = data.nodes.map((node, number) => ({ ...node, number, endpoints: [], risks: [], coordination: [] }));
  const topics = data.topics.map((topic) => ({ ...topic, endpoints: [], risks: [], coordination: [] }));
  const endpoints = data.endpoints.map((e) => ({ ...e, node: nodes[e.node], topic: topics[e.topic], risks: [] }));
  for (const e of endpoints) { e.node.endpoints.push(e); e.topic.endpoints.push(e); }
  const risks = data.risks.map((risk) => riskModel(risk, nodes, topics));
  const findings = (data.findings ?? []).map((finding) => findingModel(finding, nodes, topics));
  const coordination = data.coordination.map((c) => coordinationModel(c, nodes, topics));
  return { ...data, endpoints, risks, findings, coordination, nodes: byName(nodes), topics: byName(topics), riskById: byName(risks, "id"), findingById: byName(findings, "id"), coordinationById: byName(coordination, "id") };
}

// A risk has its topics, and there the endpoints of the nodes that take part in it.
function riskModel(data, nodes, topics) {
  const roles = data.roles.map(([role, numbers]) => [role, numbers.map((n) => nodes[n])]);
  const risk = { ...data, roles, successors: data.successors.map((n) => nodes[n]), topics: data.topics.map((n) => topics[n]) };
  risk.nodes = unique([...roles.flatMap(([, members]) => members), ...risk.successors]);
  const members = new Set(risk.nodes);
  risk.endpoints = risk.topics.flatMap((topic) => topic.endpoints).filter((e) => members.has(e.node));
  [...risk.nodes, ...unique(risk.topics), ...unique(risk.endpoints)].forEach((part) => part.risks.push(risk));
  return risk;
}

// A finding has its nodes and topics, and the endpoints between them.
function findingModel(data, nodes, topics) {
  const finding = { ...data, nodes: data.nodes.map((n) => nodes[n]), topics: data.topics.map((n) => topics[n]) };
  const members = new Set(finding.nodes);
  finding.endpoints = finding.topics.flatMap((topic) => topic.endpoints).filter((e) => members.has(e.node));
  return finding;
}

function coordinationModel(data, nodes, topics) {
  const flows = (guard) => guard.flows.map((flow) => ({ ...flow, nodes: flow.nodes.map((n) => nodes[n]) }));
  const guards = data.guards.map((guard) => ({ ...guard, topic: topics[guard.topic], flows: flows(guard), successorNodes: guard.successorNodes.map((n) => nodes[n]) }));
  const watches = data.watches.map((watch) => ({ ...watch, topic: topics[watch.topic], nodes: watch.nodes.map((n) => nodes[n]) }));
  const made = { ...data, guards, watches };
  unique([...guards, ...watches].map((part) => part.topic)).forEach((topic) => topic.coordination.push(made));
  if (isMonitor(made)) unique(watches.flatMap((watch) => watch.nodes)).forEach((node) => node.coordination.push(made));
  return made;
}

export const sameChoice = (a, b) => Boolean(a && b) && a.kind === b.kind && a.name === b.name;

// What belongs to a choice, as sets of nodes, topics, endpoints and coordination nodes.
export function related(model, choice) {
  const found = { nodes: new Set(), topics: new Set(), endpoints: new Set(), coordination: new Set() };
  RELATED[choice.kind](model, choice, (name, items) => items.forEach((item) => found[name].add(item)));
  for (const e of found.endpoints) { found.nodes.add(e.node); found.topics.add(e.topic); }
  return found;
}

const RELATED = {
  node(model, { name }, add) {
    const node = model.nodes.get(name);
    add("nodes", [node]);
    add("endpoints", node.endpoints);
    for (const e of node.endpoints) if (!e.implicit) add("endpoints", e.topic.endpoints.filter((other) => other.publishes !== e.publishes));
    add("coordination", node.coordination);
  },
  topic(model, { name }, add) {
    const topic = model.topics.get(name);
    add("topics", [topic]);
    add("endpoints", topic.endpoints);
    add("coordination", topic.coordination);
  },
  endpoints(model, { endpoints }, add) { add("endpoints", endpoints); },
  risk(model, { name }, add) {
    const risk = model.riskById.get(name);
    add("topics", risk.topics);
    add("nodes", risk.nodes);
    add("endpoints", risk.endpoints);
  },
  finding(model, { name }, add) {
    const { nodes, topics, endpoints } = model.findingById.get(name);
    add("nodes", nodes);
    add("topics", topics);
    add("endpoints", endpoints);
  },
  coordination(model, { name }, add) {
    const own = model.coordinationById.get(name);
    add("coordination", [own]);
    add("topics", [...own.guards, ...own.watches].map((part) => part.topic));
    add("endpoints", own.guards.flatMap((guard) => guard.topic.endpoints));
    add("endpoints", own.watches.flatMap((watch) => watch.topic.endpoints.filter((e) => e.publishes)));
    if (own.kind === "RSRCN") add("coordination", own.watches.flatMap((watch) => watch.topic.coordination.filter(isMonitor)));
  },
};
