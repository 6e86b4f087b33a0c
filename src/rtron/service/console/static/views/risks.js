// The risks that were found in the app, each with what it breaks, why, and where it was read.
import { html, useState } from "../html.js";
import { at, get } from "../api.js";
import { plural } from "../format.js";
import { Badge, Card, Empty, Field, Kind, Loaded, Select, useFetched } from "../parts.js";
import { query, to } from "../router.js";

export const RULES = { "GR-ST": "several nodes publish one topic", "GR-MT": "one node obeys several topics of one type", RSR: "the robot may move faster than it sees", MSR: "an action may be taken under the wrong event" };
const SEVERITY = { high: ["bad", "error"], medium: ["warn", "warning"], low: ["", "info"] };
const ORDER = ["high", "medium", "low"];

export function Risks({ robot }) {
  const fetched = useFetched(() => get(at("robots", robot, "risks")), [robot]);
  const [filter, setFilter] = useState({ text: query().get("text") ?? "", kind: "", severity: "", domain: "" });
  return html`<div class="head"><h1>Risks</h1><p>What can move this robot, and what the functions of its app can do to each other, found before it runs</p></div>
    <${Loaded} fetched=${fetched}>${(found) => html`<${Inventory} found=${found} /><${List} risks=${found.risks} robot=${robot} filter=${filter} setFilter=${setFilter} />`}<//>`;
}

const TONE = { good: ["good", "check", "it stops by itself"], warning: ["warn", "warning", "look at this"], uncertain: ["", "info", "not known"] };
const NOTHING = { uploaded: "Nothing in what could be read.", plan: html`Nobody has uploaded the graph of this app yet: <code>rtron upload-graph graph.json</code>` };

function Inventory({ found: { source, inventory, unguarded } }) {
  if (!inventory.length) return html`<${Card} title="What can move this robot"><${Empty}>${NOTHING[source]}<//><//>`;
  return html`<${Card} title="What can move this robot"><dl>${inventory.map(({ thing, rows }) => html`<dt>${thing}</dt><dd>${rows.map((row) => html`<${Row} ...${row} />`)}</dd>`)}</dl><//>
    <${Card} title="What of it the plan does not guard">${unguarded.length ? html`<dl>${unguarded.map(({ thing, why }) => html`<dt>${thing}</dt><dd>${why}</dd>`)}</dl>` : html`<${Empty}>The plan in force guards every command that a plan can guard.<//>`}<//>`;
}

function Row({ text, tone }) {
  const [look, icon, title] = TONE[tone] ?? [];
  return html`<p>${icon && html`<${Badge} look=${look} icon=${icon} title=${title} /> `}${text}</p>`;
}

function List({ risks, robot, filter, setFilter }) {
  const shown = risks.filter((risk) => fits(risk, filter)).sort((a, b) => ORDER.indexOf(a.severity) - ORDER.indexOf(b.severity));
  const set = (key) => (value) => setFilter({ ...filter, [key]: value });
  const values = (key) => [["", "all"], ...[...new Set(risks.map((r) => r[key]))].sort().map((v) => [v, v])];
  return html`<div class="filters" role="search">
      <${Field} label="Search" grow><input type="search" value=${filter.text} placeholder="node, topic, words" onInput=${(e) => set("text")(e.target.value)} /><//>
      <${Field} label="Kind"><${Select} value=${filter.kind} options=${values("kind")} onChange=${set("kind")} /><//>
      <${Field} label="Severity"><${Select} value=${filter.severity} options=${values("severity")} onChange=${set("severity")} /><//>
      <${Field} label="Domain"><${Select} value=${filter.domain} options=${values("domain")} onChange=${set("domain")} /><//>
    </div>
    <p class="soft small" aria-live="polite">${shown.length} of ${plural(risks.length, "risk")}</p>
    ${shown.length ? shown.map((risk) => html`<${Risk} key=${risk.id} risk=${risk} robot=${robot} />`) : html`<${Empty}>No risk fits the filter.<//>`}`;
}

function fits(risk, { text, kind, severity, domain }) {
  const words = [risk.id, risk.reason, ...risk.topics, ...risk.successors, ...Object.values(risk.role_nodes).flat()].join(" ").toLowerCase();
  return (!kind || risk.kind === kind) && (!severity || risk.severity === severity) && (!domain || risk.domain === domain) && words.includes(text.trim().toLowerCase());
}

function Risk({ risk, robot }) {
  const [look, icon] = SEVERITY[risk.severity] ?? ["", "info"];
  return html`<${Card} title=${html`<${Kind} kind=${risk.kind} /> <span class="mono">${risk.topics.join(" ") || risk.id}</span>`} tools=${html`<${Badge} look=${look} icon=${icon}>${risk.severity}<//><a href=${`${to("robots", robot, "graph")}?risk=${encodeURIComponent(risk.id)}`}>in the graph</a>`}>
    <dl><dt>Violated rule</dt><dd>${RULES[risk.kind] ?? risk.rule} <span class="soft">(${risk.rule})</span></dd>
      <dt>Cause</dt><dd>${risk.reason}</dd>
      <dt>Details</dt><dd>${Object.entries(risk.role_nodes).map(([role, nodes]) => html`<span class="part"><span class="soft">${role.replace("_", " ")} </span><span class="mono">${nodes.join(", ")}</span></span> `)}${risk.successors.length > 0 && html`<span class="soft">→ </span><span class="mono">${risk.successors.join(", ")}</span>`} <span class="soft">· ${risk.message_type || "several types"} · ${risk.domain}</span></dd>
      ${risk.evidence.length > 0 && html`<dt>Evidence</dt><dd><${Places} evidence=${risk.evidence} /></dd>`}</dl>
  <//>`;
}

const place = (e) => e.line ? `${e.file}:${e.line}` : e.file;
const Places = ({ evidence }) => html`${evidence.slice(0, 6).map((e, i) => html`${i > 0 && " · "}<code>${place(e)}</code>`)}${evidence.length > 6 && ` and ${evidence.length - 6} more`}`;
