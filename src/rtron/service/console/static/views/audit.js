// Who did what, from where, and what came of it.
import { html, useEffect, useState } from "../html.js";
import { get } from "../api.js";
import { Badge, Field, Problem, At } from "../parts.js";

export function Audit() {
  const [filter, setFilter] = useState({ who: "", action: "", target: "" }), [state, setState] = useState({ entries: [], next: null, busy: true });
  const load = (before) => {
    setState((s) => ({ ...s, busy: true }));
    get("/audit", { ...filter, before, limit: 100 }).then((page) => setState((s) => (before && before !== s.next ? s : { busy: false, next: page.next, entries: before ? [...s.entries, ...page.entries] : page.entries })), (error) => setState((s) => ({ ...s, busy: false, error })));
  };
  useEffect(() => load(), [JSON.stringify(filter)]);
  const input = (name, label) => html`<${Field} label=${label}><input value=${filter[name]} maxlength="300" onChange=${(e) => setFilter({ ...filter, [name]: e.target.value })} /><//>`;
  return html`<div class="head"><h1>Audit log</h1><p>Every change, who made it, and what came of it</p></div>
    <div class="filters" role="search">${input("who", "Who")}${input("action", "Action")}${input("target", "Target")}</div>
    ${state.error && html`<${Problem} error=${state.error} />`}
    <section class="card events" aria-label="Audit log, newest first">${state.entries.map((entry) => html`<${Entry} key=${entry.id} entry=${entry} />`)}
      <div class="empty">${state.busy ? "Loading …" : state.next !== null ? html`<button onClick=${() => load(state.next)}>Older entries</button>` : state.entries.length ? "That is all." : "Nothing yet."}</div></section>`;
}

const Entry = ({ entry }) => html`<div class="event audit"><span class="soft nowrap"><${At} ns=${entry.at} /></span><span><b>${entry.who || "–"}</b> <span class="soft small">${entry.address}</span></span><span>${entry.action}</span>
  <p>${entry.target} <code class="soft">${Object.keys(entry.detail).length ? JSON.stringify(entry.detail) : ""}</code></p>
  <p>${entry.outcome === "ok" || entry.outcome === "" ? html`<${Badge} look="good" icon="check">${entry.outcome || "done"}<//>` : entry.outcome.startsWith("refused") ? html`<span class="level error">${entry.outcome}</span>` : entry.outcome}</p></div>`;
