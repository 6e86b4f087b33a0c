// Small parts that many views share.
import { html, useEffect, useRef, useState } from "./html.js";
import { now } from "./api.js";
import { clock, countdown, full, lasting, moment } from "./format.js";
import { Icon } from "./icons.js";
import { useStore } from "./store.js";

export const Badge = ({ look = "", icon, title, children }) => html`<span class=${`badge ${look}`} title=${title}>${icon && html`<${Icon} name=${icon} />`}<span>${children}</span></span>`;
const LEVEL = { info: "info", warning: "warning", error: "error" };
export const Level = ({ level }) => html`<span class=${`level ${level}`}><${Icon} name=${LEVEL[level] ?? "info"} />${level}</span>`;
export const Kind = ({ kind }) => html`<span class=${`chip ${kind.toLowerCase()}`}>${kind}</span>`;
export const Bit = ({ value, title }) => html`<span class=${`bit ${value === true ? "one" : value === false ? "" : "unknown"}`} title=${title ?? ""}>${value === true ? "1" : value === false ? "0" : "?"}<span class="hidden">${value === true || value === false ? "" : " unknown"}</span></span>`;
export const At = ({ ns, short }) => html`<time datetime=${new Date(ns / 1e6).toISOString()} title=${full(ns)}>${short ? clock(ns) : moment(ns)}</time>`;
export const Mode = ({ mode }) => mode === "enforce" ? html`<${Badge} look="good" icon="shield" title="It stands in the way of the messages">enforces<//>` : html`<${Badge} icon="info" title="It only watches">observes<//>`;
const DUE = { pending: ["warn", "clock"], applied: ["good", "check"], refused: ["bad", "error"], replaced: ["", "info"] };
export const Outcome = ({ outcome, error }) => {
  const [look, icon] = DUE[outcome] ?? ["", "info"];
  return html`<${Badge} look=${look} icon=${icon} title=${error || ""}><span class=${outcome === "pending" ? "pulse" : ""}>${outcome}</span><//>`;
};

export function Ago({ ns }) {
  useStore("second");
  return html`<span title=${full(ns)}>${lasting(now() / 1000 - ns / 1e9)}</span>`;
}
export function Left({ until }) {
  useStore("second");
  return html`<span class="number" title=${`until ${full(until)}`}>${countdown(until / 1e9 - now() / 1000)}</span>`;
}

export const Notice = ({ look = "", icon = "info", children }) => html`<div class=${`notice ${look}`} role=${look === "bad" ? "alert" : "status"}><${Icon} name=${icon} /><div>${children}</div></div>`;
export const Empty = ({ children }) => html`<p class="empty">${children}</p>`;
export const Problem = ({ error }) => html`<${Notice} look="bad" icon="error"><p>${String(error.message ?? error)}</p>${error.help && html`<p>${error.help}</p>`}<//>`;
export const Card = ({ title, tools, foot, tight, children }) => html`<section class="card">${title && html`<header><h2>${title}</h2><span class="space"></span>${tools}</header>`}<div class=${`body ${tight ? "tight" : ""}`}>${children}</div>${foot && html`<footer>${foot}</footer>`}</section>`;
export const Field = ({ label, children, grow, look }) => html`<label class=${`field ${grow ? "grow" : ""} ${look ?? ""}`}><span>${label}</span>${children}</label>`;
export const Select = ({ value, options, onChange, ...more }) => html`<select ...${more} value=${value} onChange=${(e) => onChange(e.target.value)}>${options.map(([key, label]) => html`<option value=${key} selected=${key === value}>${label}</option>`)}</select>`;

// Something fetched: undefined until it has come, and an error when it does not.
export function useFetched(fetch, keys) {
  const [found, setFound] = useState({}), [turn, setTurn] = useState(0), newest = useRef(0);
  useEffect(() => {
    const own = ++newest.current;
    const put = (value) => own === newest.current && setFound(value);
    fetch().then((value) => put({ value }), (error) => put({ error }));
    return () => { newest.current++; };
  }, [...keys, turn]);
  return { ...found, again: () => setTurn((n) => n + 1) };
}

export function Loaded({ fetched, children }) {
  if (fetched.error) return html`<${Problem} error=${fetched.error} />`;
  return fetched.value === undefined ? html`<p class="empty" aria-busy="true">Loading …</p>` : children(fetched.value);
}
