// What the page knows, and what of it belongs together.
const DATA = JSON.parse(document.getElementById("data").textContent);
const NO_RISK = "no risk", UNKNOWN = "not known";
const WORSE = { high: 0, medium: 1, low: 2 };

const push = (map, key, value) => map.has(key) ? map.get(key).push(value) : map.set(key, [value]);
const by = (items, key) => { const map = new Map(); items.forEach((item, i) => push(map, key(item), i)); return map; };

const ofNode = by(DATA.endpoints, (e) => e.node);
const ofTopic = by(DATA.endpoints, (e) => e.topic);
const risksOfNode = new Map(), risksOfTopic = new Map(), risksOfEndpoint = new Map();
const nodesOfRisk = (risk) => new Set([...risk.roles.flatMap(([, nodes]) => nodes), ...risk.successors]);

DATA.risks.forEach((risk, i) => {
  const nodes = nodesOfRisk(risk);
  nodes.forEach((n) => push(risksOfNode, n, i));
  risk.topics.forEach((t) => push(risksOfTopic, t, i));
  risk.endpoints = risk.topics.flatMap((t) => ofTopic.get(t) ?? []).filter((e) => nodes.has(DATA.endpoints[e].node));
  risk.endpoints.forEach((e) => push(risksOfEndpoint, e, i));
});

const guardsOfTopic = new Map(), watchersOfTopic = new Map(), watchersOfNode = new Map();
DATA.coordination.forEach((c, i) => {
  c.guards.forEach((guard) => push(guardsOfTopic, guard.topic, i));
  c.watches.forEach((watch) => {
    push(watchersOfTopic, watch.topic, i);
    if (c.kind === "fps_monitor") watch.nodes.forEach((n) => push(watchersOfNode, n, i));
  });
});

const kindsOf = (endpoint) => {
  const kinds = new Set((risksOfEndpoint.get(endpoint) ?? []).map((r) => DATA.risks[r].kind));
  return kinds.size ? [...kinds] : [NO_RISK];
};
const FACETS = {
  package: { title: "Package", of: (e) => [DATA.nodes[e.node].package || UNKNOWN] },
  trust: { title: "Trust", of: (e) => [DATA.nodes[e.node].trust] },
  domain: { title: "Domain of the topic", of: (e) => [DATA.topics[e.topic].domain || NO_RISK] },
  risk: { title: "Risk", of: (e, i) => kindsOf(i) },
  resolution: { title: "Resolution", of: (e) => [e.resolution] },
};
const valuesOf = Object.fromEntries(Object.entries(FACETS).map(([name, facet]) =>
  [name, DATA.endpoints.map((e, i) => facet.of(e, i))]));

function tag(name, attributes = {}, ...children) {
  const element = document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) {
    if (key.startsWith("on")) element.addEventListener(key.slice(2), value);
    else if (value !== false && value !== undefined) element.setAttribute(key, value === true ? "" : value);
  }
  element.append(...children.filter((child) => child !== null && child !== undefined && child !== ""));
  return element;
}
function shape(name, attributes = {}, ...children) {
  const element = document.createElementNS("http://www.w3.org/2000/svg", name);
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
  element.append(...children);
  return element;
}
const byId = (id) => document.getElementById(id);
