// Who controls each robot now, and why; what is wrong; what settings are in force.
import { html, useEffect } from "../html.js";
import { At, Ago, Badge, Card, Empty, Left, Notice, Outcome } from "../parts.js";
import { count, figure, plural, rate } from "../format.js";
import { Export } from "../export.js";
import { acknowledgementOf, askAcknowledge, Seen } from "../fleet/acknowledge.js";
import { rowsOf } from "../fleet/filter.js";
import { FleetTable } from "../fleet/table.js";
import { useWatch } from "../live.js";
import { to } from "../router.js";
import { newestRates, rateKey } from "../series.js";
import { askRelease } from "../stop.js";
import { isLive, loadNodes, loadOwners, loadSettings, ownerSince, store, toast, useStore } from "../store.js";

// A few robots are shown whole, more of them as a table.
const FEW = 5;

export function Overview() {
  useStore("robots");
  const robots = [...store.robots.values()], few = robots.length <= FEW;
  useWatch(few ? [...store.robots.keys()] : []);
  return html`<div class="head"><h1>Overview</h1><p>${plural(robots.length, "robot")}, ${count(robots.filter((r) => r.connected).length)} connected</p><span class="space"></span>${robots.length > 0 && html`<${Export} what="robots" shown=${() => store.shown} />`}</div>
    ${!robots.length && html`<${Empty}>No robot is known yet. Start one: <code>rtron guard --plan rtron.yaml --service URL --token-file FILE</code><//>`}
    ${few ? rowsOf(robots).map(({ robot }) => html`<${Robot} key=${robot.name} robot=${robot} titled />`) : html`<${FleetTable} robots=${robots} />`}`;
}

export function RobotNow({ robot: name }) {
  useStore("robots");
  const robot = store.robots.get(name);
  return html`<div class="head"><h1>${name}</h1><p>${robot?.app ?? ""}</p></div>${robot ? html`<${Robot} robot=${robot} />` : html`<${Empty}>No robot has this name.<//>`}`;
}

function Robot({ robot, titled }) {
  useStore("second", `state ${robot.name}`);
  useEffect(() => { if (robot.app) load(robot.name); }, [robot.name, Boolean(robot.app)]);
  useEffect(() => { if (robot.app) loadNodes(robot.name).catch(() => {}); }, [robot.name, robot.app, robot.revision, robot.outcome]);
  return html`<${Card} tight title=${titled ? html`<a href=${to("robots", robot.name, "now")}>${robot.name}</a>` : "State"} tools=${html`<${Facts} robot=${robot} />`}>
    <${Alerts} robot=${robot} />
    ${robot.state ? html`<${Streams} robot=${robot} />` : html`<${Empty}>${robot.connected ? "Its guard has not told anything yet." : "Nothing is known of what controls it now."}<//>`}
  <//>`;
}

function load(name) {
  Promise.all([loadSettings(name), loadOwners(name)]).catch((error) => error.status !== 404 && toast("warning", error.message));
}

const Facts = ({ robot }) => html`<div class="line">
  ${robot.app && html`<span class="soft small">${robot.app} · ROS ${robot.ros}</span>`}
  ${robot.dry_run && html`<${Badge} look="warn" icon="info" title="It says what it would do, and lets everything pass">dry run<//>`}
  ${robot.dropped > 0 && html`<${Badge} look="warn" icon="warning" title="Events that were lost before they could be stored">${plural(robot.dropped, "event")} lost<//>`}
  <span class="soft small">revision ${robot.revision}</span>${robot.outcome && html`<${Outcome} outcome=${robot.outcome} error=${store.settings.get(robot.name)?.error} />`}
  <${Connection} robot=${robot} />
</div>`;

function Connection({ robot }) {
  if (robot.connected && store.link === "live" && robot.state && !isLive(robot)) return html`<${Badge} look="bad" icon="warning">silent<//>`;
  if (robot.connected) return html`<${Badge} look=${store.link === "live" ? "good" : "warn"} icon="link">${store.link === "live" ? "connected" : "unknown"}<//>`;
  return html`<${Badge} look="bad" icon="off">not connected<//>`;
}

function Alerts({ robot }) {
  const { state, stop } = robot, settings = store.settings.get(robot.name);
  const notices = [
    stop && html`<${Notice} look="bad" icon="stop"><p><b>Emergency stop</b> by ${stop.by}${stop.reason && `: ${stop.reason}`} · <${At} ns=${stop.at} />${state?.stopped ? "" : ". The guard has not said that it stands yet."}</p><p><button onClick=${() => askRelease(robot.name, stop)}>End the emergency stop</button></p><//>`,
    !robot.connected && html`<${Notice} look="bad" icon="off">The guard is not connected${robot.seen ? html`, last seen <${Ago} ns=${robot.seen} /> ago` : ""}. It keeps its last settings and goes on guarding by them; what it does is not seen here.<//>`,
    robot.connected && state && store.link === "live" && !isLive(robot) && html`<${Notice} look="bad" icon="warning">The guard is connected but has been silent for ${figure((performance.now() - robot.heard) / 1000, 0)} s: what is shown is old.<//>`,
    settings?.outcome === "refused" && html`<${Notice} look="bad" icon="error">Revision ${settings.revision} was refused by the guard: ${settings.error}. What was in force before still is.<//>`,
    ...(state?.alarms ?? []).map((alarm) => html`<${AlarmNotice} robot=${robot} alarm=${alarm} />`),
    robot.requests > 0 && html`<${Notice} look="warn" icon="user"><a href=${to("robots", robot.name, "command")}>${plural(robot.requests, "request")}</a> of the bridge's clients ${robot.requests === 1 ? "waits" : "wait"} for a person<//>`,
    ...Object.entries(settings?.settings.overrides ?? {}).filter(([id]) => state?.overridden.includes(id)).map(([id, o]) => html`<${Notice} look="warn" icon="clock"><a href=${to("robots", robot.name, "nodes", id)}>${id}</a> is overridden by ${o.by}: ${o.reason} · <b><${Left} until=${o.until} /></b> left<//>`),
  ].filter(Boolean);
  return notices.length > 0 && html`<div class="alerts">${notices}</div>`;
}

function AlarmNotice({ robot, alarm }) {
  const by = acknowledgementOf(robot, alarm);
  return html`<${Notice} look=${by ? "warn" : "bad"} icon="error"><p><b>${alarm.kind}</b>${alarm.topic && html` · <code>${alarm.topic}</code>`}</p><p>${alarm.reason}</p>
    ${by ? html`<${Seen} by=${by} />` : html`<p><button onClick=${() => askAcknowledge([[robot, alarm]])}>Acknowledge …</button></p>`}<//>`;
}

function Streams({ robot }) {
  const streams = [...robot.state.streams].sort((a, b) => (a.mode === b.mode ? 0 : a.mode === "enforce" ? -1 : 1));
  const guarded = streams.filter((s) => s.mode === "enforce"), watched = streams.filter((s) => s.mode !== "enforce");
  const live = isLive(robot);
  return html`<div class=${`scroll ${live ? "" : "stale"}`} aria-label=${live ? undefined : "Old values"}><table class="cards">
    <thead><tr><th>Guarded topic</th><th>Who controls it now</th><th>Why</th><th>Since</th><th class="number">Messages/s</th><th class="number">Speed / limit, m/s</th></tr></thead>
    <tbody>${guarded.map((s) => html`<${Stream} key=${s.topic} robot=${robot} stream=${s} live=${live} />`)}</tbody></table></div>
    ${watched.length > 0 && html`<details class="watched"><summary>${plural(watched.length, "more topic")} only observed</summary><div class=${`scroll ${live ? "" : "stale"}`}><table class="cards"><tbody>${watched.map((s) => html`<${Stream} key=${s.topic} robot=${robot} stream=${s} live=${live} />`)}</tbody></table></div></details>`}`;
}

function Stream({ robot, stream, live }) {
  const since = ownerSince(robot.name, stream.topic), strangers = Object.entries(stream.strangers);
  const attention = stream.stopping || strangers.length;
  return html`<tr class=${attention ? "attention" : ""}>
    <td data-label="Topic"><a class="mono" href=${to("robots", robot.name, "nodes", stream.nodes[0] ?? "")}>${stream.topic}</a></td>
    <td data-label="In control"><${Owner} stream=${stream} live=${live} /></td>
    <td data-label="Why"><span><${Why} stream=${stream} since=${since} robot=${robot} />${strangers.length > 0 && html`<span class="small soft">${strangers.map(([who, n]) => html`<span>${who} is not in the plan: ${plural(n, "message")} dropped </span>`)}</span>`}</span></td>
    <td data-label="Since" class="nowrap">${since?.at ? html`<${Ago} ns=${since.at} />` : html`<span class="soft" title="It has not changed since this page was opened">–</span>`}</td>
    <td data-label="Messages/s" class="number">${live ? rate(passed(robot.name, stream)) : "–"}</td>
    <td data-label="Speed/limit" class="number">${stream.speed === null && stream.limit === null ? "" : html`${live ? figure(stream.speed) : "–"} / ${figure(stream.limit)}`}</td></tr>`;
}

function Owner({ stream, live }) {
  const text = !live ? "was " : "";
  if (stream.mode !== "enforce") return html`<span class="soft">observed only</span>`;
  if (stream.stopping) return html`<${Badge} look="bad" icon="stop">being stopped<//>`;
  if (!stream.owner) return html`<span class="soft">${text}nobody</span>`;
  return html`<span>${text}<b>${stream.publisher || stream.owner}</b> <span class="soft">${stream.owner}</span></span>`;
}

function Why({ stream, since, robot }) {
  if (stream.stopping) return stream.stopping;
  if (stream.lease) return stream.lease;
  if (!stream.owner) return html`<span class="soft">${since?.reason && since.reason !== "idle" ? since.reason : stream.mode === "enforce" ? "nobody speaks" : ""}</span>`;
  return since?.reason || reasonOf(robot.name, stream);
}

const REASONS = {
  Preemption: (flow) => `highest priority (${flow.priority}) of those that speak`,
  FIFO_Queue: () => "first in order of arrival",
  Priority_Queue: (flow) => `its turn, by priority ${flow.priority}`,
  Lease: () => "it holds the lease",
  Block: () => "its block bit is 0",
};

// Why the policy in force gives control to a flow.
function reasonOf(robot, stream) {
  const node = (store.nodes.get(robot) ?? []).find((n) => n.id === stream.nodes[0])?.effective;
  const flow = node?.flows?.find((f) => f.name === stream.owner);
  return flow ? html`${REASONS[node.policy]?.(flow)} <span class="soft small">${node.policy}</span>` : "";
}

function passed(robot, stream) {
  const rates = newestRates(robot);
  return Object.keys(stream.flows).reduce((sum, flow) => sum + (rates.get(rateKey(stream.topic, flow))?.out ?? 0), 0);
}
