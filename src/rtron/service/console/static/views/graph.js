// The live interaction graph.
import { html, useEffect, useMemo, useRef, useState } from "../html.js";
import { at, get } from "../api.js";
import { definitions, draw, highlight, isLit } from "../graph/draw.js";
import { graphLayout } from "../graph/layout.js";
import { graphModel, related } from "../graph/model.js";
import { Viewport } from "../graph/viewport.js";
import { Detail } from "./graph_detail.js";
import { rateLabel, showRates } from "./graph_rates.js";
import { Badge, Loaded, Problem, Select, useFetched } from "../parts.js";
import { query } from "../router.js";
import { loadScript } from "../scripts.js";
import { samplesOf } from "../series.js";
import { isLive, listen, store, useStore } from "../store.js";

const NARROW = 820;
const KINDS = [["", "any risk or none"], ["risky", "any risk"], ["GR-ST", "GR-ST"], ["GR-MT", "GR-MT"], ["RSR", "RSR"], ["MSR", "MSR"]];

export function Graph({ robot }) {
  const fetched = useFetched(() => fetchAll(robot), [robot]);
  return html`<${Loaded} fetched=${fetched}>${(model) => html`<${Stage} robot=${robot} model=${model} />`}<//>`;
}

// What a client library adds by itself is no part of the console's graph.
async function fetchAll(robot) {
  const [data] = await Promise.all([get(at("robots", robot, "graph")), loadScript("graph/dagre.min.js")]);
  return graphModel({ ...data, topics: data.topics.map((topic) => ({ ...topic, domain: topic.domain || "no risk" })), endpoints: data.endpoints.filter((e) => !e.implicit) });
}

function Stage({ robot, model }) {
  const [filter, setFilter] = useState({ kind: "", domain: "", risky: false, leaves: false, risk: query().get("risk") ?? "" });
  const [choice, setChoice] = useState(null), [unfolded, setUnfolded] = useState(new Set());
  const svg = useRef(null), view = useRef(null);
  const { layout, error } = useMemo(() => tryLayout(model, filter, unfolded), [model, filter, unfolded]);
  const press = (pressed) => pressed?.kind === "unfold" ? setUnfolded(new Set([...unfolded, pressed.name])) : setChoice(pressed);
  useEffect(() => {
    view.current = new Viewport(svg.current, svg.current.querySelector(".world"), (pressed) => view.current.onPress(pressed));
    svg.current.querySelector("defs").replaceChildren(...definitions());
  }, []);
  useEffect(() => { view.current.onPress = press; });
  useEffect(() => {
    draw(layout, view.current.world, { label: rateLabel });
    const stops = [view.current.show(layout.boxes, () => firstBoxes(model, layout)), followRates(robot, layout)];
    return () => stops.forEach((stop) => stop());
  }, [layout]);
  useEffect(() => highlight(layout, view.current.world, choice && related(model, choice), choice), [layout, choice]);
  const show = (pressed) => {
    const lit = related(model, pressed), boxes = layout.boxes.filter((box) => isLit(box, lit));
    setChoice(pressed);
    if (boxes.length) view.current.focusOn(boxes, innerWidth <= NARROW ? 0.55 * svg.current.clientHeight : 0);
  };
  return html`<${Tools} robot=${robot} model=${model} filter=${filter} setFilter=${setFilter} show=${show} />
    ${error && html`<${Problem} error=${error} />`}
    <div class="stage"><svg ref=${svg} class="picture" tabindex="0" role="group" aria-label="Interaction graph: arrow keys go from box to box, with shift they move the picture, plus and minus zoom, 0 shows all"><defs></defs><g class="world"></g></svg>
      ${!layout.boxes.length && html`<p class="empty over">Nothing fits the filter.</p>`}
      <${Legend} /><div class="zoom" role="toolbar" aria-label="Zoom"><button aria-label="Zoom in" onClick=${() => view.current.zoom(1.3)}>+</button><button aria-label="Zoom out" onClick=${() => view.current.zoom(1 / 1.3)}>−</button><button onClick=${() => view.current.fit()}>All</button></div>
      ${choice && html`<${Detail} robot=${robot} model=${model} choice=${choice} show=${show} close=${() => setChoice(null)} />`}</div>`;
}

// Where the picture opens, if not all of it can be read: at the first topic that is guarded.
function firstBoxes(model, layout) {
  const [first] = model.coordination.flatMap((coordination) => coordination.guards);
  return first ? layout.boxes.filter((box) => box.topics?.includes(first.topic)) : [];
}

function tryLayout(model, filter, unfolded) {
  try {
    return { layout: graphLayout(model, { endpoints: model.endpoints.filter((e) => fits(e, filter)), unfolded }) };
  } catch (error) {
    return { error, layout: { boxes: [], edges: [] } };
  }
}

function fits({ topic, risks }, { kind, domain, risky, leaves, risk }) {
  const both = topic.endpoints.some((e) => e.publishes) && topic.endpoints.some((e) => !e.publishes);
  if (!leaves && !both && !topic.risks.length && !topic.coordination.length) return false;
  if (domain && topic.domain !== domain) return false;
  if (risk) return risks.some((r) => r.id === risk);
  if (kind) return risks.some((r) => r.kind === kind);
  return !risky || topic.risks.length > 0;
}

// Rates are written straight into the picture: drawing the view again for each state would be waste.
function followRates(robot, layout) {
  const now = () => {
    const live = isLive(store.robots.get(robot)), sample = live ? samplesOf(robot).at(-1) : undefined;
    showRates(layout, sample?.rates, sample?.streams);
  };
  const stops = [`state ${robot}`, "link", "second"].map((channel) => listen(channel, now));
  now();
  return () => stops.forEach((stop) => stop());
}

function Tools({ robot, model, filter, setFilter, show }) {
  const domains = [["", "all domains"], ...[...new Set([...model.topics.values()].map((t) => t.domain))].sort().map((d) => [d, d])];
  const setKind = (kind) => setFilter({ ...filter, risk: "", risky: kind === "risky", kind: kind === "risky" ? "" : kind });
  return html`<div class="tools" role="search"><${Search} model=${model} show=${show} />
    <${Select} aria-label="Kind of risk" value=${filter.risky ? "risky" : filter.kind} options=${KINDS} onChange=${setKind} />
    <${Select} aria-label="Domain" value=${filter.domain} options=${domains} onChange=${(domain) => setFilter({ ...filter, domain })} />
    <button aria-pressed=${filter.leaves ? "true" : "false"} title="Topics with only publishers or only subscribers" onClick=${() => setFilter({ ...filter, leaves: !filter.leaves })}>Leaf topics</button>
    ${filter.risk && html`<button onClick=${() => setFilter({ ...filter, risk: "" })} title=${filter.risk}>One risk only ✕</button>`}
    <span class="space"></span>${model.source === "plan" && html`<${Badge} icon="info" title="Nobody has uploaded the interaction graph of the app: rtron scan --format graph -o graph.json, then rtron upload-graph graph.json">from the plan only<//>`}<${Rates} robot=${robot} /></div>`;
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
