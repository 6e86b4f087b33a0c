// What is known of the chosen node, topic or coordination node.
import { html } from "../html.js";
import { rate } from "../format.js";
import { Badge, Kind, Mode } from "../parts.js";
import { to } from "../router.js";
import { newestRates, rateKey } from "../series.js";
import { isLive, store, useStore } from "../store.js";
import { Icon } from "../icons.js";

export function Detail({ robot, model, choice, show, close }) {
  useStore(`state ${robot}`);
  const Part = PARTS[choice.kind];
  return html`<aside class="detail" aria-label="Details" aria-live="polite"><button class="plain close" aria-label="Close" onClick=${close}><${Icon} name="cross" /></button>
    <${Part} robot=${robot} model=${model} name=${choice.name} show=${show} /></aside>`;
}

const Names = ({ title, kind, names, show }) => names.length > 0 && html`<h3>${title}</h3><ul class="names">${[...new Set(names)].map((name) => html`<li><button class="link mono" onClick=${() => show({ kind, name })}>${name}</button></li>`)}</ul>`;
const Risks = ({ robot, risks }) => risks.length > 0 && html`<h3>Risks</h3>${[...new Set(risks)].slice(0, 20).map((risk) => html`<p class="risk"><${Kind} kind=${risk.kind} /> <span class="soft small">${risk.severity}</span> <a href=${`${to("robots", robot, "risks")}?text=${encodeURIComponent(risk.id)}`}>${risk.reason}</a></p>`)}`;

function NodePart({ robot, model, name, show }) {
  const node = model.nodes.get(name), topics = (publishes) => node.endpoints.filter((e) => e.publishes === publishes).map((e) => e.topic.name);
  return html`<h2>${name}</h2><p class="soft">${node.package || "package not known"} · ${node.trust.replace("_", " ")}</p>${node.function && html`<p>${node.function} <span class="soft">${node.domain}</span></p>`}
    <${Names} title="Publishes" kind="topic" names=${topics(true)} show=${show} /><${Names} title="Subscribes" kind="topic" names=${topics(false)} show=${show} /><${Risks} robot=${robot} risks=${node.risks} />`;
}

function TopicPart({ robot, model, name, show }) {
  const topic = model.topics.get(name), nodes = (publishes) => topic.endpoints.filter((e) => e.publishes === publishes).map((e) => e.node.name);
  const live = isLive(store.robots.get(robot)), stream = live && store.robots.get(robot).state.streams.find((s) => s.topic === name);
  return html`<h2>${name}</h2><p class="soft">${topic.types.join(", ")}${topic.domain !== "no risk" ? ` · ${topic.domain}` : ""}</p>
    ${stream && html`<p>${stream.stopping ? html`<${Badge} look="bad" icon="stop">being stopped<//> ${stream.stopping}` : stream.owner ? html`<b>${stream.publisher || stream.owner}</b> controls it` : "Nobody controls it now"}</p><${Flows} robot=${robot} stream=${stream} />`}
    ${topic.coordination.length > 0 && html`<h3>Coordination</h3>${[...new Set(topic.coordination)].map((c) => html`<p><${Kind} kind=${c.kind} /> ${c.kind === "fps_monitor" ? c.id : html`<a href=${to("robots", robot, "nodes", c.id)}>${c.id}</a>`}</p>`)}`}
    <${Names} title="Publishers" kind="node" names=${nodes(true)} show=${show} /><${Names} title="Subscribers" kind="node" names=${nodes(false)} show=${show} /><${Risks} robot=${robot} risks=${topic.risks} />`;
}

function Flows({ robot, stream }) {
  const rates = newestRates(robot);
  return html`<table><tbody>${Object.keys(stream.flows).map((flow) => { const newest = rates.get(rateKey(stream.topic, flow)); return html`<tr><td>${flow}</td><td class="number">${newest ? `${rate(newest.out)}/s` : "–"}</td><td class="number soft">${newest?.refused ? `${rate(newest.refused)} refused` : ""}</td></tr>`; })}</tbody></table>`;
}

function CoordinationPart({ robot, model, name, show }) {
  const c = model.coordinationById.get(name);
  return html`<p><${Kind} kind=${c.kind} /> ${c.mode && html`<${Mode} mode=${c.mode} />`}</p><h2>${c.id}</h2><p class="soft">${c.policy}</p>
    ${c.kind !== "fps_monitor" && html`<p><a class="button" href=${to("robots", robot, "nodes", c.id)}>Policies and settings</a></p>`}
    ${c.guards.map((guard) => html`<h3>Guards <span class="mono">${guard.topic.name}</span></h3><ul class="names">${guard.flows.map((f) => html`<li>${f.name} <span class="mono">${f.publisher}</span></li>`)}</ul>`)}
    <${Names} title="Watches" kind="topic" names=${c.watches.map((w) => w.topic.name)} show=${show} />`;
}

const PARTS = { node: NodePart, topic: TopicPart, coordination: CoordinationPart };
