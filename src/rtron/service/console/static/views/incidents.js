// Incidents that robots have reported, newest first: what caused each, and who was in command.
import { html, useEffect, useState } from "../html.js";
import { get } from "../api.js";
import { At, Badge, Card, Empty, Loaded, useFetched } from "../parts.js";
import { to } from "../router.js";
import { listen } from "../store.js";

const PAGE = 50;
const LOOKS = { alarm: ["bad", "error"], stop: ["bad", "stop"], intervention: ["warn", "shield"] };

export function Cause({ kind }) {
  const [look, icon] = LOOKS[kind] ?? ["", "info"];
  return html`<${Badge} look=${look} icon=${icon}>${kind}<//>`;
}

export function Incidents({ robot }) {
  const [before, setBefore] = useState(null), fetched = useFetched(() => get("/incidents", { robot, before, limit: PAGE }), [robot, before]);
  useEffect(() => listen("incidents", fetched.again), []);
  return html`<div class="head"><h1>Incidents${robot ? ` of ${robot}` : ""}</h1><p>What the guard prevented, stopped or raised an alarm about, with the minute before</p></div>
    <${Loaded} fetched=${fetched}>${({ incidents, next }) => html`${incidents.length ? html`<${Card} tight><div class="scroll"><table class="cards"><thead><tr><th>When</th>${!robot && html`<th>Robot</th>`}<th>Cause</th><th>What</th><th>In command</th><th>Settings</th></tr></thead><tbody>${incidents.map((each) => html`<${Row} key=${each.id} incident=${each} named=${!robot} />`)}</tbody></table></div><//>` : html`<${Empty}>No incident has been reported${robot ? " by this robot" : ""}.<//>`}
      <div class="line">${before !== null && html`<button onClick=${() => setBefore(null)}>Newest</button>`}${next !== null && html`<button onClick=${() => setBefore(next)}>Older incidents</button>`}</div>`}<//>`;
}

const Row = ({ incident: each, named }) => html`<tr>
  <td data-label="When" class="nowrap"><a href=${to("robots", each.robot, "incidents", each.name)}><${At} ns=${each.at} /></a></td>
  ${named && html`<td data-label="Robot"><a href=${to("robots", each.robot, "now")}>${each.robot}</a></td>`}
  <td data-label="Cause"><span><${Cause} kind=${each.kind} />${each.causes > 1 && html` <span class="soft small">and ${each.causes - 1} more</span>`}</span></td>
  <td data-label="What"><span><span class="mono small">${each.topic}</span> ${each.reason}</span></td>
  <td data-label="In command"><span>${each.owner || "nobody"} <span class="mono small soft">${each.publisher}</span></span></td>
  <td data-label="Settings" class="nowrap">r${each.revision}</td></tr>`;
