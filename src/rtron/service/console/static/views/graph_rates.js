// Live rates, written onto the edges of the graph as they come.
import { isGRCN } from "../graph/model.js";
import { rate as rateText } from "../format.js";
import { rateKey } from "../series.js";

const grcnOf = (topic) => topic.coordination.find(isGRCN);

// The label of an edge stands at the end with more room; where nothing is enforced it shows with a choice alone.
export function rateLabel(e) {
  const enforced = e.endpoints.some(({ topic }) => grcnOf(topic)?.mode === "enforce");
  return { text: "", look: enforced ? "rate" : "rate watched", at: (path) => e.in.room > e.out.room ? path.end : path.start };
}

// The flows of an edge: a publisher's own on each topic, or for a successor all that go out.
function flowsOf({ node, publishes, topic }) {
  const grcn = grcnOf(topic);
  if (!grcn) return [];
  const { flows, successorNodes } = grcn.guards[0], of = (flow, out) => ({ topic: topic.name, flow: flow.name, out });
  if (publishes) return flows.filter((flow) => flow.nodes.includes(node)).map((flow) => of(flow, false));
  return successorNodes.includes(node) ? flows.map((flow) => of(flow, true)) : [];
}

// Writes the rates onto the edges, and which flow is in control.
export function showRates(layout, rates, streams) {
  for (const e of layout.edges) {
    e.flows ??= e.endpoints.flatMap(flowsOf);
    if (!e.flows.length) continue;
    const known = e.flows.map(({ topic, flow, out }) => ({ rate: rates?.get(rateKey(topic, flow)), owns: streams?.get(topic)?.owner === flow, out })).filter((f) => f.rate);
    const out = known.reduce((sum, f) => sum + f.rate.out, 0), refused = known.reduce((sum, f) => sum + (f.out ? 0 : f.rate.refused), 0);
    update(e, textOf(out, refused), { owner: known.some((f) => f.owns), refused: refused > 0, active: out > 0 });
  }
}

const textOf = (out, refused) => [out >= 0.05 && `${rateText(out)}/s`, refused >= 0.05 && `${rateText(refused)}/s refused`].filter(Boolean).join(", ");

function update(e, text, looks) {
  const shown = text + JSON.stringify(looks);
  if (e.shown === shown) return;
  e.shown = shown;
  e.label.textContent = text;
  for (const [look, is] of Object.entries(looks)) e.element.classList.toggle(look, is);
}
