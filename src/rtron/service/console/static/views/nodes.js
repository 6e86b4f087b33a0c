// The coordination nodes of a robot, by kind.
import { html } from "../html.js";
import { at, get } from "../api.js";
import { Ago, Badge, Card, Empty, Kind, Loaded, Mode, useFetched } from "../parts.js";
import { to } from "../router.js";
import { store, useStore } from "../store.js";

const TITLES = { GRCN: "General: who may speak on a topic", RSRCN: "Robot-specific: how fast it may move", MSRCN: "Mission-specific: what it must not do" };

export function Nodes({ robot }) {
  const revision = useStore("robots") && store.robots.get(robot)?.revision;
  const fetched = useFetched(() => get(at("robots", robot, "nodes")), [robot, revision]);
  return html`<div class="head"><h1>Coordination nodes</h1><p>They stand between the nodes that can harm each other</p></div>
    <${Loaded} fetched=${fetched}>${(nodes) => nodes.length ? Object.keys(TITLES).map((type) => html`<${Group} type=${type} nodes=${nodes.filter((n) => n.type === type)} robot=${robot} />`) : html`<${Empty}>The plan of this robot has none.<//>`}<//>`;
}

function Group({ type, nodes, robot }) {
  const sorted = [...nodes].sort((a, b) => (a.mode === b.mode ? 0 : a.mode === "enforce" ? -1 : 1));
  return nodes.length > 0 && html`<${Card} tight title=${html`<${Kind} kind=${type} /> ${TITLES[type]}`}><div class="scroll"><table class="cards">
    <thead><tr><th>Node</th><th>Topics</th><th>Policy in force</th><th>Mode</th><th>Last violation</th></tr></thead>
    <tbody>${sorted.map((node) => html`<${Row} key=${node.id} node=${node} robot=${robot} />`)}</tbody></table></div><//>`;
}

const Row = ({ node, robot }) => html`<tr>
  <td data-label="Node"><a href=${to("robots", robot, "nodes", node.id)}>${node.id}</a></td>
  <td data-label="Topics" class="mono">${node.topics.join(" ")}</td>
  <td data-label="Policy"><span class="nowrap">${node.effective.policy}${node.effective.policy !== node.plan.policy && html` <span class="soft small">plan: ${node.plan.policy}</span>`} ${node.override && html`<${Badge} look="warn" icon="clock">overridden<//>`}</span></td>
  <td data-label="Mode"><span><${Mode} mode=${node.mode} /></span></td>
  <td data-label="Violation">${node.trigger_time ? html`<span>${node.violation_cause}<span class="soft small"><${Ago} ns=${node.trigger_time} /> ago</span></span>` : html`<span class="soft">none</span>`}</td></tr>`;
