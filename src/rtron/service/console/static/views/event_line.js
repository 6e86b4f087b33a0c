// One event, on one line where there is room.
import { html, useState } from "../html.js";
import { At, Level } from "../parts.js";
import { to } from "../router.js";

const DECISIONS = { pass: "passed", hold: "held", drop: "dropped", modify: "modified" };

export function EventLine({ event, named }) {
  const [open, setOpen] = useState(false), facts = Object.keys(event.values).length > 0;
  return html`<div class=${`event ${event.level}`} data-event=${event.id}>
    <span class="soft"><${At} ns=${event.at} short /></span><${Level} level=${event.level} /><span>${event.kind}</span>
    <span class="where">${named && html`<a href=${to("robots", event.robot, "now")}>${event.robot}</a> `}${event.node ? html`<a href=${to("robots", event.robot, "nodes", event.node)}>${event.node}</a>` : html`<span class="mono small">${event.topic}</span>`}</span>
    <p>${event.decision && html`<b>${DECISIONS[event.decision] ?? event.decision}</b> `}${event.flow && html`${event.flow} `}${event.publisher && html`<span class="mono small">${event.publisher}</span> `}${event.node && event.topic && html`<span class="mono small soft">${event.topic}</span> `}${event.reason || (event.kind === "owner" && event.flow ? "is in control" : "")}${event.policy && html` <span class="soft">· ${event.policy}</span>`}${typeof event.values.incident === "string" && html` <a href=${to("robots", event.robot, "incidents", event.values.incident)}>What happened</a>`}${open && html`<pre class="mono values">${JSON.stringify(event.values, null, 1)}</pre>`}</p>
    <span class="facts nowrap">${event.revision > 0 && html`<span class="soft small" title="Revision of the settings">r${event.revision}</span> `}${facts && html`<button class="link small" aria-expanded=${open ? "true" : "false"} onClick=${() => setOpen(!open)}>${open ? "less" : "more"}</button>`}</span></div>`;
}
