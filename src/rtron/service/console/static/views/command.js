// Who is in command of a robot: who holds each lease and held it before, and what a person may do about it.
import { html, useEffect } from "../html.js";
import { at, get, post } from "../api.js";
import { countdown, seconds } from "../format.js";
import { onEvent } from "../live.js";
import { At, Badge, Card, Empty, Loaded, Notice, useFetched } from "../parts.js";
import { ask, isLive, store, toast, useStore } from "../store.js";
import { EventLine } from "./event_line.js";
import { Requests } from "./requests.js";

const SHOWN = 50;

export function Command({ robot }) {
  useStore("second", "robots", `state ${robot}`);
  const known = store.robots.get(robot), fetched = useFetched(() => get(`${at("robots", robot)}/leases`), [robot, known?.app]);
  return html`<div class="head"><h1>Command</h1><p>Who may move what, one at a time</p></div>
    <${Requests} robot=${known} />
    <${Loaded} fetched=${fetched}>${(leases) => leases.length ? html`${leases.map((lease) => html`<${Lease} key=${lease.name} robot=${known} lease=${lease} />`)}<${Changes} robot=${robot} />` : html`<${Empty}>The plan has no leases: who moves what is on the page Now.<//>`}<//>`;
}

const statusOf = (robot, lease) => robot?.state?.streams.map((stream) => stream.lease_status).find((status) => status?.name === lease.name);
// Both times are of the robot's clock: what has passed since is by the browser's steady one.
const left = (robot, status) => (status.until - robot.state.at) / 1e9 - (performance.now() - robot.heard) / 1000;

function Lease({ robot, lease }) {
  const status = statusOf(robot, lease), live = isLive(robot) && Boolean(status);
  return html`<${Card} title=${lease.name} tools=${html`<${Holder} status=${status} live=${live} />`}>
    <dl class=${live ? "" : "stale"}>
      ${status?.holder && html`<dt>In command</dt><dd><b>${status.holder}</b> <span class="soft">${status.rank}</span></dd><dt>Since</dt><dd><${At} ns=${status.since} /></dd>${live && html`<dt>Still has</dt><dd><span class="number" title=${`${seconds(lease.ttl)} s after each renewal`}>${countdown(left(robot, status))}</span></dd>`}`}
      ${status && html`<dt>Why</dt><dd>${status.reason}</dd>`}
      <dt>Moves</dt><dd>${lease.topics.map((topic) => html`<code>${topic}</code> `)}</dd></dl>
    ${!lease.permitted && html`<${Notice}>${lease.service ? "You may not change who is in command here: it takes the role end user or developer." : html`The plan lets nobody here change who is in command. It would take <code>service: RANK</code> at the lease.`}<//>`}
    <div class="scroll"><table class="cards"><thead><tr><th>May command</th><th>Rank</th><th></th></tr></thead><tbody>
      ${lease.commanders.map((commander) => html`<${Commander} key=${commander.name} robot=${robot} lease=${lease} commander=${commander} status=${live ? status : undefined} />`)}</tbody></table></div><//>`;
}

function Holder({ status, live }) {
  if (!live) return html`<${Badge} look="warn" icon="warning">not known now<//>`;
  return status.holder ? html`<${Badge} look="good" icon="key">held<//>` : html`<${Badge} icon="off">nobody is in command<//>`;
}

function Commander({ robot, lease, commander, status }) {
  const may = lease.permitted && Boolean(status), holds = may && status.holder === commander.name;
  const own = holds && status.given_by === `${store.me.name} (${lease.service})`;
  return html`<tr><td data-label="May command"><span class="mono">${commander.name}</span></td><td data-label="Rank">${commander.rank}</td>
    <td data-label="" class="min"><div class="line nowrap-wide">${own && html`<button onClick=${() => renew(robot, lease, status)}>Renew</button>`}
      ${holds ? html`<button onClick=${() => askEnd(robot, lease, status)}>Take it away …</button>` : html`<button disabled=${!may} onClick=${() => askGive(robot, lease, commander, status)}>Give to ${commander.name} …</button>`}</div></td></tr>`;
}

function Changes({ robot }) {
  const fetched = useFetched(() => get("/events", { robot, kind: "lease", limit: SHOWN }), [robot]);
  useEffect(() => onEvent((event) => { if (event.robot === robot && event.kind === "lease") fetched.again(); }), [robot]);
  return html`<${Loaded} fetched=${fetched}>${({ events }) => html`<section class="card events" aria-label="Who was in command, newest first"><header><h2>Who was in command</h2></header>
    ${events.length ? events.map((event) => html`<${EventLine} key=${event.id} event=${event} />`) : html`<${Empty}>Nobody yet, as far as this service knows.<//>`}</section>`}<//>`;
}

// What is changed is the lease as it is shown here: if it has changed hands meanwhile, the guard refuses.
async function change(robot, lease, status, body) {
  const { reason } = await post(`${at("robots", robot.name, "leases", lease.name)}`, { grant: status.grant, ...body });
  toast("info", reason);
}

const renew = (robot, lease, status) => change(robot, lease, status, { do: "renew" }).catch((error) => toast("error", error.message));

function askGive(robot, lease, commander, status) {
  ask({
    title: `Give ${lease.name} of ${robot.name} to ${commander.name}`, icon: "key", danger: true, confirm: "Give",
    effects: [status.holder && `${status.holder} (${status.rank}) loses it, and the robot stops.`, `${commander.name} moves nothing before it has sent a command that stands still.`, `It ends ${seconds(lease.ttl)} s after the last renewal, by ${commander.name} or by you.`].filter(Boolean),
    reason: { label: "Reason", least: 3 },
    act: (reason) => change(robot, lease, status, { do: "give", to: commander.name, reason }),
  });
}

function askEnd(robot, lease, status) {
  ask({
    title: `Take ${lease.name} of ${robot.name} from ${status.holder}`, icon: "warning", danger: true, confirm: "Take it away",
    effects: ["The robot stops.", "Nobody moves it until a commander asks for the lease, or is given it."],
    reason: { label: "Reason", least: 3 },
    act: (reason) => change(robot, lease, status, { do: "end", reason }),
  });
}
