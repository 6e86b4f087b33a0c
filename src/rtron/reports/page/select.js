// Which part of the graph is shown, and which part a choice lights up.
const state = {
  off: Object.fromEntries(Object.keys(FACETS).map((name) => [name, new Set()])),
  implicit: false, leaves: false, overlay: true, chosen: null, opened: new Set(),
};

function shownEndpoints() {
  const passes = (i) => (state.implicit || !DATA.endpoints[i].implicit)
    && Object.keys(FACETS).every((name) => valuesOf[name][i].some((value) => !state.off[name].has(value)));
  const passing = DATA.endpoints.map((_, i) => i).filter(passes);
  return state.leaves ? passing : passing.filter(notLeaf(passing));
}

function notLeaf(shown) {
  const spoken = new Set(), heard = new Set();
  for (const i of shown) {
    const e = DATA.endpoints[i];
    (e.publishes ? spoken : heard).add(e.topic);
  }
  const kept = (t) => (spoken.has(t) && heard.has(t)) || risksOfTopic.has(t);
  return (i) => kept(DATA.endpoints[i].topic);
}

function shownNodes(endpoints) {
  const nodes = new Set(endpoints.map((i) => DATA.endpoints[i].node));
  const narrowed = ["domain", "risk", "resolution"].some((name) => state.off[name].size);
  if (narrowed) return nodes;
  DATA.nodes.forEach((node, n) => {
    const passes = !state.off.package.has(node.package || UNKNOWN) && !state.off.trust.has(node.trust);
    if (passes) nodes.add(n);
  });
  return nodes;
}

// A choice is {kind, at}: what it lights is sets of nodes, topics, endpoints and coordination nodes.
function lights(choice) {
  const lit = { nodes: new Set(), topics: new Set(), endpoints: new Set(), coordination: new Set() };
  LIGHTS[choice.kind](choice.at, lit);
  for (const i of lit.endpoints) {
    lit.nodes.add(DATA.endpoints[i].node);
    lit.topics.add(DATA.endpoints[i].topic);
  }
  return lit;
}
const add = (set, items) => (items ?? []).forEach((item) => set.add(item));
const LIGHTS = {
  topic(t, lit) {
    lit.topics.add(t);
    add(lit.endpoints, ofTopic.get(t));
    add(lit.coordination, guardsOfTopic.get(t));
    add(lit.coordination, watchersOfTopic.get(t));
  },
  node(n, lit) {
    lit.nodes.add(n);
    for (const i of ofNode.get(n) ?? []) {
      const end = DATA.endpoints[i];
      lit.endpoints.add(i);
      const others = (ofTopic.get(end.topic) ?? []).filter((o) => DATA.endpoints[o].publishes !== end.publishes);
      add(lit.endpoints, end.implicit ? [] : others);
    }
    add(lit.coordination, watchersOfNode.get(n));
  },
  endpoints(ends, lit) { add(lit.endpoints, ends); },
  risk(r, lit) {
    const risk = DATA.risks[r];
    add(lit.topics, risk.topics);
    add(lit.nodes, [...nodesOfRisk(risk)]);
    add(lit.endpoints, risk.endpoints);
  },
  coordination(c, lit) {
    const node = DATA.coordination[c];
    lit.coordination.add(c);
    for (const guard of node.guards) {
      lit.topics.add(guard.topic);
      add(lit.endpoints, ofTopic.get(guard.topic));
    }
    for (const watch of node.watches) {
      lit.topics.add(watch.topic);
      add(lit.coordination, (watchersOfTopic.get(watch.topic) ?? []).filter((o) => DATA.coordination[o].kind === "fps_monitor" && node.kind === "RSRCN"));
      add(lit.endpoints, (ofTopic.get(watch.topic) ?? []).filter((i) => DATA.endpoints[i].publishes));
    }
  },
};
