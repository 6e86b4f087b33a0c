// One incident: command and output over each other, where the robot was, what decided, and what would have been.
import { html } from "../html.js";
import { at, get } from "../api.js";
import { count, plural } from "../format.js";
import { saveDocument } from "../export.js";
import { Curves } from "../node/charts.js";
import { At, Card, Loaded, Notice, useFetched } from "../parts.js";
import { to } from "../router.js";
import { PathMap } from "./incident_path.js";
import { Cause } from "./incidents.js";

const shownTime = (seconds) => `${seconds < 0 ? "" : "+"}${seconds.toFixed(2)} s`;

export function Incident({ robot, node: name }) {
  const fetched = useFetched(() => get(at("robots", robot, "incidents", name)), [robot, name]);
  return html`<${Loaded} fetched=${fetched}>${({ report, stored }) => html`<${Page} robot=${robot} report=${report} stored=${stored} />`}<//>`;
}

function Page({ robot, report, stored }) {
  const { gravest } = report;
  return html`<div class="head"><h1>Incident of ${robot}</h1><${Cause} kind=${gravest.kind} /><p><${At} ns=${report.at} /></p><span class="space"></span><button title="All that is on this page, for a program" onClick=${() => saveDocument(`${report.name}.json`, report)}>JSON</button></div>
    <${Notice} look=${gravest.kind === "intervention" ? "warn" : "bad"} icon=${gravest.kind === "intervention" ? "shield" : "error"}><p><b class="mono">${gravest.topic}</b> ${gravest.flow} ${gravest.reason}</p>
      ${report.alternatives.map(({ title, sentences, notes }) => html`<p><b>${title}:</b> ${sentences.join("; ") || notes.join("; ")}</p>`)}<//>
    ${report.topics.map((topic) => html`<${Card} key=${topic.topic} title=${html`Command and output <span class="mono">${topic.topic}</span>`}><${Speeds} topic=${topic} report=${report} /><//>`)}
    <div class="columns"><div class="column"><${Timeline} report=${report} /></div>
    <div class="column"><${Card} title=${report.frame ? `Path, in ${report.frame}` : "Path, by dead reckoning of what went out"}><${PathMap} report=${report} /><//>
      ${report.topics.map((topic) => html`<${Verdicts} key=${topic.topic} topic=${topic} />`)}<${Facts} robot=${robot} report=${report} stored=${stored} /></div></div>`;
}

// The line of what went out stands out; what would have been is dashed.
function Speeds({ topic, report: { begin, step, causes, alternatives } }) {
  const lines = [
    { label: "what went out", values: topic.output, colour: "--c3", dash: [], width: 3 },
    ...topic.flows.map((flow, i) => ({ label: `${flow.flow} ${flow.publisher}`, values: flow.speeds, colour: ["--c1", "--c4", "--c2", "--c6"][i % 4], dash: [] })),
    { label: "limit", values: topic.limits, colour: "--c6", dash: [2, 3] },
    ...alternatives.filter(({ outputs }) => Object.hasOwn(outputs, topic.topic)).map(({ title, outputs }, i) => ({ label: title, values: outputs[topic.topic], colour: i ? "--c2" : "--c5", dash: [6, 4] })),
  ].filter(({ values }) => values.some((value) => value !== null));
  const times = Array.from({ length: Math.max(0, ...lines.map(({ values }) => values.length)) }, (_, i) => begin + i * step);
  if (!lines.length) return html`<p class="soft">Its messages have no velocity.</p>`;
  return html`<${Curves} title="Speed" unit="m/s" lines=${lines} times=${times} marks=${causes.map((cause) => cause.at)} />
    <p class="soft small">Times are in seconds after the first cause; a line from top to bottom is a cause. Each step of ${step.toFixed(3)} s has its fastest speed.</p>`;
}

function Timeline({ report: { causes, omitted_causes, topics, events, omitted_events } }) {
  const rows = [
    ...causes.map((each) => ({ ...each, what: html`<${Cause} kind=${each.kind} />` })),
    ...events.map((each) => ({ ...each, what: each.kind })),
    ...topics.flatMap(({ topic, changes, owners }) => [
      ...changes.map((each) => ({ ...each, topic, what: each.decision, reason: [each.reason, each.policy].filter(Boolean).join(" · ") })),
      ...owners.map((each) => ({ at: each.at, topic, what: each.stopping ? "stop" : "in command", flow: each.owner || "nobody", reason: each.stopping || each.publisher })),
    ]),
  ].sort((a, b) => a.at - b.at);
  const left = omitted_causes + omitted_events + topics.reduce((sum, topic) => sum + topic.left_out, 0);
  return html`<${Card} title="Timeline" tight foot=${left > 0 && html`<span class="soft small">${plural(left, "further entry", "further entries")} in the recording</span>`}><div class="scroll"><table class="cards"><thead><tr><th class="number">Time</th><th>What</th><th>Topic</th><th>Flow</th><th>Why</th></tr></thead><tbody>
    ${rows.map((row) => html`<tr><td data-label="Time" class="number">${shownTime(row.at)}</td><td data-label="What"><span>${row.what}</span></td><td data-label="Topic" class="mono nowrap">${row.topic}</td><td data-label="Flow" class="nowrap">${row.flow ?? ""}</td><td data-label="Why">${row.reason}</td></tr>`)}</tbody></table></div><//>`;
}

const Verdicts = ({ topic: { topic, flows } }) => html`<${Card} title=${html`Verdicts <span class="mono">${topic}</span>`} tight><div class="scroll"><table class="cards"><thead><tr><th>Flow</th><th>Publisher</th>${["passed", "held", "dropped", "changed"].map((word) => html`<th class="number">${word}</th>`)}</tr></thead><tbody>
  ${flows.map(({ flow, publisher, verdicts }) => html`<tr><td data-label="Flow">${flow}</td><td data-label="Publisher" class="mono">${publisher}</td>${["pass", "hold", "drop", "modify"].map((decision) => html`<td data-label=${decision} class="number">${count(verdicts[decision] ?? 0)}</td>`)}</tr>`)}</tbody></table></div><//>`;

const Facts = ({ robot, report, stored }) => html`<${Card} title="The recording"><dl>
  <dt>In command</dt><dd>${report.owner || "nobody"} <span class="mono">${report.publisher}</span></dd>
  <dt>Settings</dt><dd><a href=${to("robots", robot, "settings")}>revision ${report.revision}</a></dd>
  <dt>App</dt><dd>${report.app}, ROS ${report.ros} ${report.distribution}, RTron ${report.rtron}</dd>
  <dt>Reported</dt><dd><${At} ns=${stored} /></dd>
  <dt>File</dt><dd><code>${report.name}</code> <span class="soft">${count(Math.ceil(report.size / 1000))} kB, on the robot, with every message. Foxglove opens it:</span> <code>rtron incident export ${report.name} --format mcap -o incident.mcap</code></dd></dl><//>`;
