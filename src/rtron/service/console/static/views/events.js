// The timeline: newest first, older ones as one scrolls, new ones as they happen.
import { html, useEffect, useRef, useState } from "../html.js";
import { get } from "../api.js";
import { day } from "../format.js";
import { Export } from "../export.js";
import { RobotFinder } from "../fleet/robot_finder.js";
import { onEvent, useWatch } from "../live.js";
import { Badge, Field, Problem, Select } from "../parts.js";
import { query } from "../router.js";
import { store, useStore } from "../store.js";
import { EventLine } from "./event_line.js";

const PAGE = 100, MOST = 3000;
const KINDS = ["guard", "owner", "lease", "verdict", "stop", "rule", "alarm", "settled", "override", "settings", "counts", "lost"];
const LEVELS = [["", "all"], ["warning", "warning or worse"], ["error", "error"]];
const SEVERITY = { info: 0, warning: 1, error: 2 };
const FIELDS = ["kind", "level", "node", "topic", "text", "since", "until"];

export function Events({ robot }) {
  useStore("link");
  useWatch([], !robot);
  const [filter, setFilter] = useState(() => Object.fromEntries(FIELDS.map((name) => [name, query().get(name) ?? ""])));
  const [chosen, setChosen] = useState(""), [more, setMore] = useState(false), pages = usePages({ ...filter, robot: robot ?? chosen });
  const set = (name) => (value) => setFilter({ ...filter, [name]: value });
  const Text = (name, label, extra) => html`<${Field} label=${label} look=${`later ${extra ? "time" : ""}`}><input value=${filter[name]} maxlength="300" ...${extra} onChange=${(e) => set(name)(e.target.value)} /><//>`;
  return html`<div class="head"><h1>Events${robot ? ` of ${robot}` : ""}</h1><span class="space"></span><${Export} what="events" query=${queryOf({ ...filter, robot: robot ?? chosen })} /><${Following} pages=${pages} /></div>
    <div class=${`filters ${more ? "" : "folded"}`} role="search">
      ${!robot && html`<${Field} label="Robot"><${RobotFinder} id="events-robot" names=${[...store.robots.keys()]} value=${chosen} empty="all" onChange=${setChosen} /><//>`}
      <${Field} label="Level"><${Select} value=${filter.level} options=${LEVELS} onChange=${set("level")} /><//>
      <${Field} label="Kind"><${Select} value=${filter.kind} options=${[["", "all but counts"], ...KINDS.map((k) => [k, k])]} onChange=${set("kind")} /><//>
      ${Text("node", "Coordination node")}${Text("topic", "Topic")}
      <${Field} label="Words in the reason" grow><input type="search" value=${filter.text} maxlength="300" onChange=${(e) => set("text")(e.target.value)} /><//>
      ${Text("since", "From", { type: "datetime-local" })}${Text("until", "Until", { type: "datetime-local" })}
      <button class="unfold" aria-expanded=${more ? "true" : "false"} onClick=${() => setMore(!more)}>${more ? "Fewer filters" : "More filters"}</button>
    </div>
    ${pages.error && html`<${Problem} error=${pages.error} />`}
    <section class="card events" aria-label="Events, newest first">${withDays(pages.events.filter((e) => filter.kind || e.kind !== "counts")).map((part) => part.event ? html`<${EventLine} key=${part.event.id} event=${part.event} named=${!robot} />` : html`<div class="day" key=${part.day}>${part.day}</div>`)}
      <${End} pages=${pages} /></section>`;
}

function Following({ pages }) {
  if (store.link !== "live") return html`<${Badge} look="bad" icon="off">not live<//>`;
  return html`<button aria-pressed=${pages.paused ? "true" : "false"} onClick=${pages.pause}>${pages.paused ? `Paused, ${pages.waiting} new: go on` : "Pause"}</button>`;
}

// The end of the list asks for the next page when it comes into view; a button does the same.
function End({ pages }) {
  const end = useRef(null);
  useEffect(() => {
    const seen = new IntersectionObserver((entries) => entries.some((e) => e.isIntersecting) && pages.older(), { rootMargin: "300px" });
    seen.observe(end.current);
    return () => seen.disconnect();
  }, [pages.next, pages.busy]);
  const more = pages.next !== null && pages.events.length < MOST;
  return html`<div class="empty" ref=${end}>${pages.busy ? "Loading …" : more ? html`<button onClick=${pages.older}>Older events</button>` : pages.events.length >= MOST ? `The newest ${MOST} are shown: narrow the filter to see older ones.` : pages.events.length ? "That is all." : "No event fits the filter."}</div>`;
}

function usePages(filter) {
  const [state, setState] = useState({ events: [], next: null, busy: true }), [held, setHeld] = useState(null);
  const key = JSON.stringify(filter), turn = useRef(0);
  const load = (before) => {
    const own = before ? turn.current : ++turn.current;
    setState((s) => ({ ...s, busy: true, error: null, ...(before ? {} : { events: [], next: null }) }));
    get("/events", { ...queryOf(filter), limit: PAGE, before }).then(
      (page) => own === turn.current && setState((s) => (before && before !== s.next ? s : { busy: false, next: page.next, events: before ? [...s.events, ...page.events] : page.events })),
      (error) => own === turn.current && setState((s) => ({ ...s, busy: false, next: null, error })));
  };
  useEffect(() => load(), [key]);
  useEffect(() => onEvent((event) => {
    if (!fits(event, filter)) return;
    if (held) setHeld((list) => list && [event, ...list].slice(0, MOST));
    else setState((s) => ({ ...s, events: put(event, s.events) }));
  }), [key, Boolean(held)]);
  const pause = () => {
    if (held) setState((s) => ({ ...s, events: held.reduceRight((events, event) => put(event, events), s.events) }));
    setHeld(held ? null : []);
  };
  return { ...state, paused: Boolean(held), waiting: held?.length ?? 0, pause, older: () => !state.busy && state.next !== null && state.events.length < MOST && load(state.next) };
}

function put(event, events) {
  if (events.length && event.id <= events[0].id && events.some((e) => e.id === event.id)) return events;
  return [event, ...events].slice(0, MOST);
}

const nanoseconds = (local) => local && `${new Date(local).getTime()}000000`;
const queryOf = (filter) => ({ ...filter, counts: Boolean(filter.kind), since: nanoseconds(filter.since), until: nanoseconds(filter.until) });

function fits(event, f) {
  const at = event.at / 1e6, equal = (name) => !f[name] || event[name] === f[name];
  return ["robot", "kind", "node", "topic"].every(equal) && SEVERITY[event.level] >= (SEVERITY[f.level] ?? 0) && event.reason.toLowerCase().includes(f.text.toLowerCase())
    && (!f.since || at >= new Date(f.since).getTime()) && (!f.until || at < new Date(f.until).getTime());
}

function withDays(events) {
  let last = "";
  return events.flatMap((event) => {
    const today = day(event.at), head = today === last ? [] : [{ day: today }];
    last = today;
    return [...head, { event }];
  });
}
