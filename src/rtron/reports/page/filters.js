// What the page shows of the graph, and what belongs to it.
import { graphModel } from "./graph/model.js";

const MODEL = graphModel(JSON.parse(document.getElementById("data").textContent));
const NO_RISK = "no risk", UNKNOWN = "not known";
const byId = (id) => document.getElementById(id);
const FACETS = {
  package: { title: "Package", of: (e) => [e.node.package || UNKNOWN] },
  trust: { title: "Trust", of: (e) => [e.node.trust] },
  domain: { title: "Domain of the topic", of: (e) => [e.topic.domain || NO_RISK] },
  risk: { title: "Risk", of: (e) => e.risks.length ? [...new Set(e.risks.map((risk) => risk.kind))] : [NO_RISK] },
  resolution: { title: "Resolution", of: (e) => [e.resolution] },
};
for (const e of MODEL.endpoints) e.facets = Object.fromEntries(Object.entries(FACETS).map(([name, facet]) => [name, facet.of(e)]));

const state = {
  hidden: Object.fromEntries(Object.keys(FACETS).map((name) => [name, new Set()])),
  implicit: false, leaves: false, overlay: true, choice: null, unfolded: new Set(),
};

function shownEndpoints() {
  const passes = (e) => (state.implicit || !e.implicit) && Object.keys(FACETS).every((name) => e.facets[name].some((value) => !state.hidden[name].has(value)));
  const passing = MODEL.endpoints.filter(passes);
  return state.leaves ? passing : withoutLeaves(passing);
}

// A topic with only publishers or only subscribers is a leaf, unless a risk touches it, or the page names it.
function withoutLeaves(endpoints) {
  const published = new Set(), subscribed = new Set();
  for (const e of endpoints) (e.publishes ? published : subscribed).add(e.topic);
  return endpoints.filter(({ topic }) => (published.has(topic) && subscribed.has(topic)) || topic.risks.length || topic.isNamed);
}

function leafTopics() {
  const explicit = MODEL.endpoints.filter((e) => !e.implicit), topics = (endpoints) => new Set(endpoints.map((e) => e.topic)).size;
  return topics(explicit) - topics(withoutLeaves(explicit));
}

// Nodes without endpoints are shown unless the endpoints are narrowed down.
function shownNodes() {
  if (["domain", "risk", "resolution"].some((name) => state.hidden[name].size)) return [];
  return [...MODEL.nodes.values()].filter((node) => !state.hidden.package.has(node.package || UNKNOWN) && !state.hidden.trust.has(node.trust));
}
