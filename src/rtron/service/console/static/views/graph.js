// The live interaction graph.
import { html, useEffect, useMemo, useRef, useState } from "../html.js";
import { at, get } from "../api.js";
import { draw, light, tell } from "../graph/draw.js";
import { pictureOf } from "../graph/layout.js";
import { modelOf, shownEnds } from "../graph/model.js";
import { View } from "../graph/view.js";
import { Detail } from "../graph/detail.js";
import { Badge, Loaded, Problem, Select, useFetched } from "../parts.js";
import { query } from "../router.js";
import { samplesOf } from "../series.js";
import { isLive, listen, store, useStore } from "../store.js";

const NARROW = 820;
const KINDS = [["", "any risk or none"], ["risky", "any risk"], ["GR-ST", "GR-ST"], ["GR-MT", "GR-MT"], ["RSR", "RSR"], ["MSR", "MSR"]];

export function Graph({ robot }) {
  const fetched = useFetched(() => fetchAll(robot), [robot]);
  return html`<${Loaded} fetched=${fetched}>${(model) => html`<${Stage} robot=${robot} model=${model} />`}<//>`;
}

async function fetchAll(robot) {
  return modelOf(await get(at("robots", robot, "graph")));
}

function Stage({ robot, model }) {
  const [filter, setFilter] = useState({ kind: "", domain: "", risky: false, leaves: false, risk: query().get("risk") ?? "" });
  const [choice, setChoice] = useState(null), [opened, setOpened] = useState(new Set());
  const svg = useRef(null), view = useRef(null);
  const { picture, error } = useMemo(() => tryPicture(model, filter, opened), [model, filter, opened]);
  const press = (pressed) => pressed?.kind === "open" ? setOpened(new Set([...opened, pressed.name])) : setChoice(pressed);
  useEffect(() => { view.current = new View(svg.current, svg.current.querySelector(".world"), (pressed) => view.current.press(pressed)); }, []);
  useEffect(() => { Object.assign(view.current, { press, fitAll: () => view.current.fit(picture.boxes) }); });
  useEffect(() => {
    draw(picture, view.current.world);
    const ends = [view.current.follow(picture.boxes), follow(robot, picture)];
    return () => ends.forEach((end) => end());
  }, [picture]);
  useEffect(() => light(picture, view.current.world, choice && lights(model, choice), choice), [picture, choice]);
  const show = (pressed) => { setChoice(pressed); const boxes = boxesOf(model, picture, pressed); if (boxes.length) { view.current.touched = true; view.current.fit(boxes, 1.1, innerWidth <= NARROW ? 0.45 : 1); } };
  return html`<${Tools} robot=${robot} model=${model} filter=${filter} setFilter=${setFilter} show=${show} />
    ${error && html`<${Problem} error=${error} />`}
    <div class="stage"><svg ref=${svg} class="picture" tabindex="0" role="group" aria-label="Interaction graph: arrow keys go from box to box, with shift they move the picture, plus and minus zoom, 0 shows all">
        <defs>${["plain", "gr-st", "gr-mt", "watch"].map((name) => html`<marker id=${`tip-${name}`} class=${`tip ${name}`} viewBox="0 0 8 8" refX="6.5" refY="4" markerWidth="8" markerHeight="8" markerUnits="userSpaceOnUse" orient="auto"><path d="M0 0 8 4 0 8Z" /></marker>`)}
          <pattern id="stripes" width="8" height="8" patternUnits="userSpaceOnUse" patternTransform="rotate(45)"><rect class="stripe-floor" width="8" height="8" /><rect class="stripe" width="4" height="8" /></pattern></defs>
        <g class="world"></g></svg>
      ${!picture.boxes.length && html`<p class="empty over">Nothing fits the filter.</p>`}
      <${Legend} /><div class="zoom" role="toolbar" aria-label="Zoom"><button aria-label="Zoom in" onClick=${() => view.current.zoom(1.3)}>+</button><button aria-label="Zoom out" onClick=${() => view.current.zoom(1 / 1.3)}>−</button><button onClick=${() => view.current.fit(picture.boxes)}>All</button></div>
      ${choice && html`<${Detail} robot=${robot} model=${model} choice=${choice} show=${show} close=${() => setChoice(null)} />`}</div>`;
}

function tryPicture(model, filter, opened) {
  try {
    return { picture: pictureOf(model, shownEnds(model, filter), opened) };
  } catch (error) {
    return { error, picture: { boxes: [], edges: [], at: new Map() } };
  }
}

// Rates are written straight into the picture: drawing the view again for each state would be waste.
function follow(robot, picture) {
  const now = () => {
    const live = isLive(store.robots.get(robot)), sample = live ? samplesOf(robot).at(-1) : undefined;
    tell(picture, sample?.rates, sample?.streams);
  };
  const ends = [`state ${robot}`, "link", "second"].map((channel) => listen(channel, now));
  now();
  return () => ends.forEach((end) => end());
}

// What belongs to a choice is lit, the rest steps back.
function lights(model, { kind, name }) {
  const lit = { nodes: new Set(), topics: new Set(), ends: new Set(), coordination: new Set() };
  const add = (end) => { lit.ends.add(end); lit.nodes.add(end.node); lit.topics.add(end.topic); };
  if (kind === "node") { model.nodes.get(name).ends.forEach(add); lit.nodes.add(model.nodes.get(name)); }
  if (kind === "topic") { model.topics.get(name).ends.forEach(add); lit.topics.add(model.topics.get(name)); model.topics.get(name).coordination.forEach((c) => lit.coordination.add(c)); }
  if (kind === "coordination") for (const c of model.coordination.filter((each) => each.id === name)) {
    lit.coordination.add(c);
    [...c.guards, ...c.watches].forEach((part) => lit.topics.add(part.topic));
    c.guards.forEach((guard) => guard.topic.ends.forEach(add));
  }
  return lit;
}

function boxesOf(model, picture, choice) {
  if (!choice) return [];
  const lit = lights(model, choice);
  return picture.boxes.filter((b) => lit.nodes.has(b.node) || lit.coordination.has(b.coordination) || b.topics?.some((t) => lit.topics.has(t)));
}

function Tools({ robot, model, filter, setFilter, show }) {
  const domains = [["", "all domains"], ...[...new Set([...model.topics.values()].map((t) => t.domain))].sort().map((d) => [d, d])];
  const setKind = (kind) => setFilter({ ...filter, risk: "", risky: kind === "risky", kind: kind === "risky" ? "" : kind });
  return html`<div class="tools" role="search"><${Search} model=${model} show=${show} />
    <${Select} aria-label="Kind of risk" value=${filter.risky ? "risky" : filter.kind} options=${KINDS} onChange=${setKind} />
    <${Select} aria-label="Domain" value=${filter.domain} options=${domains} onChange=${(domain) => setFilter({ ...filter, domain })} />
    <button aria-pressed=${filter.leaves ? "true" : "false"} title="Topics with only publishers or only subscribers" onClick=${() => setFilter({ ...filter, leaves: !filter.leaves })}>Leaf topics</button>
    ${filter.risk && html`<button onClick=${() => setFilter({ ...filter, risk: "" })} title=${filter.risk}>One risk only ✕</button>`}
    <span class="space"></span>${model.source === "plan" && html`<${Badge} icon="info" title="Nobody has uploaded the interaction graph of the app: rtron scan --format json, then PUT it here">from the plan only<//>`}<${Rates} robot=${robot} /></div>`;
}

function Rates({ robot }) {
  useStore(`state ${robot}`, "link", "second");
  return isLive(store.robots.get(robot)) ? html`<${Badge} look="good" icon="link">live rates<//>` : html`<${Badge} look="bad" icon="off">no live rates<//>`;
}

const MOST_FOUND = 12;
function Search({ model, show }) {
  const [text, setText] = useState(""), wanted = text.trim().toLowerCase();
  const found = wanted ? [...[...model.nodes.keys()].map((name) => ({ kind: "node", name })), ...[...model.topics.keys()].map((name) => ({ kind: "topic", name })), ...model.coordination.map((c) => ({ kind: "coordination", name: c.id }))].filter((c) => c.name.toLowerCase().includes(wanted)) : [];
  const choose = (choice) => { setText(""); show(choice); };
  return html`<div class="search"><input type="search" aria-label="Search nodes and topics" placeholder="Search nodes and topics" value=${text} autocomplete="off" spellcheck="false" onInput=${(e) => setText(e.target.value)} onKeyDown=${(e) => e.key === "Enter" && found[0] && choose(found[0])} />
    ${wanted && html`<div class="found" role="listbox" aria-label="Found">${found.slice(0, MOST_FOUND).map((c) => html`<button role="option" class="plain" onClick=${() => choose(c)}><span class="soft small">${c.kind}</span> ${c.name}</button>`)}${!found.length && html`<p class="soft small">Nothing has this name.</p>`}${found.length > MOST_FOUND && html`<p class="soft small">and ${found.length - MOST_FOUND} more</p>`}</div>`}</div>`;
}

const Legend = () => html`<div class="legend" aria-label="Legend">
  <span><i class="mark line-st"></i>GR-ST</span><span><i class="mark line-mt"></i>GR-MT</span><span><i class="mark image"></i>RSR image</span><span><i class="mark max-vel"></i>RSR max_vel</span><span><i class="mark event"></i>MSR event</span><span><i class="mark action"></i>MSR action</span>
  <span><i class="mark grcn"></i>GRCN</span><span><i class="mark rsrcn"></i>RSRCN</span><span><i class="mark msrcn"></i>MSRCN</span><span><i class="mark third"></i>third party</span></div>`;
