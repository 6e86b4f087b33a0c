// From what the service tells of the graph to what is drawn: nodes, topics, ends, and what guards them.
// Names come as numbers into lists, each list in an order of its own.
export const push = (map, key, value) => map.has(key) ? map.get(key).push(value) : map.set(key, [value]);

export function modelOf(page) {
  const nodes = page.nodes.map((n) => ({ ...n, marks: new Set(n.marks), ends: [], risks: [] }));
  const topics = page.topics.map((t) => ({ ...t, domain: t.domain || "no risk", marks: new Set(t.marks), ends: [], risks: [], coordination: [] }));
  const ends = page.endpoints.filter((e) => !e.implicit).map((e) => ({ ...e, node: nodes[e.node], topic: topics[e.topic], risks: [] }));
  ends.forEach((end) => { end.node.ends.push(end); end.topic.ends.push(end); });
  page.risks.forEach((risk) => touch(risk, nodes, topics));
  const coordination = page.coordination.map((c) => ({ ...c, guards: c.guards.map((g) => ({ ...g, topic: topics[g.topic] })), watches: c.watches.map((w) => ({ ...w, topic: topics[w.topic] })) }));
  coordination.forEach((c) => new Set([...c.guards, ...c.watches].map((part) => part.topic)).forEach((topic) => topic.coordination.push(c)));
  return { source: page.source, ends, coordination, nodes: byName(nodes), topics: byName(topics) };
}

const byName = (items) => new Map(items.map((item) => [item.name, item]));

// A risk touches its topics, and the nodes that speak or listen there and have a part in it.
function touch(risk, nodes, topics) {
  const concerned = new Set([...risk.roles.flatMap(([, numbers]) => numbers), ...risk.successors].map((n) => nodes[n]));
  concerned.forEach((node) => node.risks.push(risk));
  for (const topic of risk.topics.map((n) => topics[n])) {
    topic.risks.push(risk);
    topic.ends.filter((end) => concerned.has(end.node)).forEach((end) => end.risks.push(risk));
  }
}

// The ends that are shown under a filter: {kind, domain, risky, leaves, risk}.
export const shownEnds = (model, filter) => model.ends.filter((end) => fits(end, filter));

function fits({ topic, risks }, { kind, domain, risky, leaves, risk }) {
  const both = topic.ends.some((e) => e.publishes) && topic.ends.some((e) => !e.publishes);
  if (!leaves && !both && !topic.risks.length && !topic.coordination.length) return false;
  if (domain && topic.domain !== domain) return false;
  if (risk) return risks.some((r) => r.id === risk);
  if (kind) return risks.some((r) => r.kind === kind);
  return !risky || topic.risks.length > 0;
}

// A plan's publisher or successor may be a pattern with `*`.
export function means(pattern, name) {
  if (pattern === name || !pattern.includes("*")) return pattern === name;
  const parts = pattern.split("*"), last = parts.pop();
  let at = 0;
  for (const [i, part] of parts.entries()) {
    const found = name.indexOf(part, at);
    if (found < 0 || (i === 0 && found > 0)) return false;
    at = found + part.length;
  }
  return name.length - last.length >= at && name.endsWith(last);
}
