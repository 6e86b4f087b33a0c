// One coordination node, in the form of its kind: last violation, settings, charts, events.
import { html, useEffect, useState } from "../html.js";
import { get } from "../api.js";
import { plural } from "../format.js";
import { Chart } from "../node/charts.js";
import { newestNode, review } from "../node/change.js";
import { formOf } from "../node/form.js";
import { GrcnForm } from "../node/grcn.js";
import { MsrcnForm } from "../node/msrcn.js";
import { Override } from "../node/override.js";
import { Images, RsrcnForm } from "../node/rsrcn.js";
import { At, Ago, Badge, Card, Kind, Loaded, Mode, Notice, Outcome, useFetched } from "../parts.js";
import { to } from "../router.js";
import { loadPast, newestRates, rateKey } from "../series.js";
import { isLive, loadPlan, loadSettings, notify, store, useStore } from "../store.js";
import { EventLine } from "./event_line.js";

export function Node({ robot, node: id }) {
  useStore(`settings ${robot}`);
  const settings = store.settings.get(robot), [plan, setPlan] = useState(store.plans.get(robot));
  const fetched = useFetched(() => fetchNode(robot, id), [robot, id, settings?.revision, settings?.outcome]);
  useEffect(() => { loadPlan(robot).then(setPlan, () => {}); loadPast(robot).then(() => notify(`state ${robot}`)); }, [robot]);
  return html`<${Loaded} fetched=${fetched}>${({ base, node }) => html`<${Page} robot=${robot} node=${node} base=${base} plan=${plan} again=${fetched.again} />`}<//>`;
}

// Settings first: if they change between the two, the draft's base is the older one and nothing is overwritten.
async function fetchNode(robot, id) {
  const base = await loadSettings(robot);
  return { base, node: await newestNode(robot, id) };
}

function Page({ robot, node, base, plan, again }) {
  useStore(`state ${robot}`, "robots", "second");
  const [, draw] = useState(0), [conflict, setConflict] = useState(null), [kept, setKept] = useState(base);
  const form = formOf(robot, node, () => draw((n) => n + 1)), live = store.robots.get(robot), state = live?.state;
  useEffect(() => { if (!form.draft.size) setKept(base); }, [base, form.draft.size]);
  const stream = state?.streams.find((s) => s.nodes.includes(node.id));
  form.foot = html`<${Foot} form=${form} onReview=${() => review({ robot, form, base: kept, done: () => { setConflict(null); again(); }, conflict: (theirs) => { setConflict(theirs); setKept(theirs.newest); again(); } })} />`;
  return html`<${Head} robot=${robot} node=${node} base=${base} />
    ${conflict && html`<${Conflict} conflict=${conflict} close=${() => setConflict(null)} />`}
    ${!conflict && form.draft.size > 0 && kept.revision !== base.revision && html`<${Notice} look="warn" icon="warning">${base.by} has made revision ${base.revision} since you began. Review your change to see what differs.<//>`}
    ${node.override && html`<${Notice} look="warn" icon="clock">Overridden by ${node.override.by}: ${node.override.reason}<//>`}
    <div class="columns"><div class="column"><${Violation} node=${node} robot=${robot} />
      <div class=${isLive(live) ? "" : "old"}><${Form} form=${form} plan=${plan} stream=${stream} state=${isLive(live) ? state : undefined} rates=${isLive(live) ? newestRates(robot) : new Map()} /></div></div>
    <div class="column"><${Override} robot=${robot} node=${node} again=${again} /><${Charts} robot=${robot} node=${node} plan=${plan} live=${isLive(live)} /><${Last} robot=${robot} node=${node} /></div></div>`;
}

export function Form({ form, ...rest }) {
  if (form.node.type === "GRCN") return html`<${GrcnForm} form=${form} ...${rest} />`;
  if (form.node.type === "RSRCN") return html`<${RsrcnForm} form=${form} ...${rest} /><${Images} node=${form.node} ...${rest} />`;
  if (form.node.type === "MSRCN") return html`<${MsrcnForm} form=${form} ...${rest} />`;
  return null;
}

const Head = ({ robot, node, base }) => html`<div class="head"><${Kind} kind=${node.type} /><h1>${node.id}</h1>${node.mode && html`<${Mode} mode=${node.mode} />`}<p>${node.description}</p><span class="space"></span>
  <span class="line"><span class="soft small">revision ${base.revision}</span><${Standing} view=${base} /><a href=${to("robots", robot, "settings")}>history</a></span></div>`;

// Pending counts up until the guard has answered; then it says how long that took.
export function Standing({ view }) {
  if (view.outcome === "pending") return html`<${Outcome} outcome="pending" /><span class="soft small">for <${Ago} ns=${view.at} /></span>`;
  const took = view.answered ? (view.answered - view.at) / 1e6 : null;
  return html`<${Outcome} outcome=${view.outcome} error=${view.error} />${view.outcome === "applied" && view.revision > 0 && took !== null && took >= 0 && took < 1e5 && html`<span class="soft small">in ${took.toFixed(0)} ms</span>`}${view.error && html`<span class="small">${view.error}</span>`}`;
}

const Violation = ({ node, robot }) => html`<${Card} title="Last violation" tools=${node.trigger_time && html`<span class="soft small"><${At} ns=${node.trigger_time} /> · <${Ago} ns=${node.trigger_time} /> ago</span>`}>
  ${node.trigger_time ? html`<dl><dt>Violated rule</dt><dd>${node.violated_rule}</dd><dt>Violation cause</dt><dd>${node.violation_cause}</dd><dt>Violation details</dt><dd>${node.violation_details}</dd></dl>` : html`<p class="soft">None so far.</p>`}
  <${Guarded} node=${node} robot=${robot} /><//>`;

function Guarded({ node, robot }) {
  const risks = node.risk_information?.risks ?? [], number = node.risk_information?.number ?? risks.length;
  return Array.isArray(risks) && risks.length > 0 && html`<p class="line small"><span class="soft">Guards against</span>${risks.slice(0, 3).map((risk) => risk.id && html`<a href=${`${to("robots", robot, "risks")}?text=${encodeURIComponent(risk.id)}`}>${risk.kind} ${(risk.topics ?? []).slice(0, 1).join("")}</a>`)}${number > 3 && html`<span class="soft">of ${plural(number, "risk")}</span>`}</p>`;
}

function Foot({ form, onReview }) {
  const n = form.draft.size;
  return html`<button class="main" disabled=${!n || form.wrong()} onClick=${onReview}>Review and put in force …</button><button disabled=${!n} onClick=${form.clear}>Discard</button><span class="soft small" aria-live="polite">${form.wrong() ? "Some value is not a number." : n ? `${plural(n, "change")} in draft` : "Nothing changed"}</span>`;
}

const Conflict = ({ conflict, close }) => html`<${Notice} look="warn" icon="warning"><p><b>Not put in force: ${conflict.newest.by} changed the settings in the meantime</b> (revision ${conflict.newest.revision}${conflict.newest.reason && `: ${conflict.newest.reason}`}).</p>
  ${conflict.changes.map((c) => html`<p>${c.what}: <s>${c.before}</s> → <b>${c.after}</b></p>`)}
  <p>Your draft is kept below, beside what is in force now. Review it again to put it in force, or discard it. <button class="link" onClick=${close}>Understood</button></p><//>`;

function Charts({ robot, node, plan, live }) {
  const charts = chartsOf(node, plan);
  return charts.length > 0 && html`<${Card} title="The last ten minutes" tools=${live ? html`<${Badge} look="good" icon="link">live<//>` : html`<${Badge} look="bad" icon="off">not live<//>`}><div class=${`charts ${live ? "" : "stale"}`}>${charts.map((chart) => html`<${Chart} key=${chart.title} robot=${robot} ...${chart} />`)}</div><//>`;
}

function chartsOf(node, plan) {
  const topic = node.topics[0], of = (s) => s.streams.get(topic);
  const latency = { title: `Through the guard, ${topic}`, unit: "µs", digits: 0, lines: [{ label: "mean", value: (s) => of(s)?.latency?.[0] }, { label: "worst", value: (s) => of(s)?.latency?.[1] }] };
  if (node.type === "GRCN") return [{ title: "Messages out", unit: "1/s", lines: flowLines(topic, node.plan.flows, (r) => r?.out) }, verdicts(topic), latency];
  if (node.type === "RSRCN") return [speed(topic), fps(node.plan.iflows, plan), verdicts(topic), latency];
  if (node.type === "fps_monitor") return [{ title: "Frame rate", unit: "fps", lines: [{ label: node.id, value: (s) => s.fps[node.id] }] }];
  return topic ? [verdicts(topic), latency] : [];
}

const flowLines = (topic, flows, value) => flows.slice(0, 6).map((flow) => ({ label: `${flow.name} ${flow.publisher}`, value: (s) => value(s.rates?.get(rateKey(topic, flow.name))) }));
const speed = (topic) => ({ title: `Velocity and limit, ${topic}`, unit: "m/s", digits: 2, lines: [{ label: "velocity", value: (s) => s.streams.get(topic)?.speed }, { label: "limit", value: (s) => s.streams.get(topic)?.limit, colour: "--c5" }] });
const fps = (iflows, plan) => ({ title: "Frames", unit: "fps", lines: (plan?.fps_monitor ?? []).filter((m) => iflows.some((i) => i.publisher === m.node)).slice(0, 6).map((m) => ({ label: m.node, value: (s) => s.fps[m.id] })) });

const VERDICTS = [["passed", "--c3"], ["modified", "--c1"], ["held", "--c2"], ["dropped", "--c5"]];
const verdicts = (topic) => ({ title: `Verdicts, ${topic}`, unit: "1/s", lines: VERDICTS.map(([word, colour]) => ({ label: word, colour, value: (s) => sum(s, topic, word) })) });
function sum(sample, topic, word) {
  if (!sample.rates) return null;
  let total = 0;
  for (const [key, rate] of sample.rates) if (key.startsWith(`${topic} `)) total += rate[word];
  return total;
}

function Last({ robot, node }) {
  const fetched = useFetched(() => get("/events", { robot, node: node.id, limit: 8 }), [robot, node.id, node.trigger_time]);
  return html`<${Card} tight title="Last events" tools=${html`<a href=${`${to("robots", robot, "events")}?node=${encodeURIComponent(node.id)}`}>all</a>`}><${Loaded} fetched=${fetched}>${({ events }) => events.length ? html`<div class="events narrow">${events.map((event) => html`<${EventLine} key=${event.id} event=${event} />`)}</div>` : html`<p class="empty">None yet.</p>`}<//><//>`;
}
