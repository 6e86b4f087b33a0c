// A new roll-out: which robots, which change, in which stages; then all of it once more, and it begins.
import { html, useState } from "../html.js";
import { at, get, post } from "../api.js";
import { plural } from "../format.js";
import { appsOf, filterOfAddress, fitting, groupsOf, rowsOf } from "../fleet/filter.js";
import { effectsOf } from "../node/effects.js";
import { words } from "../node/fields.js";
import { formOf, patchOf } from "../node/form.js";
import { Card, Empty, Field, Loaded, Notice, Select, useFetched } from "../parts.js";
import { go, to } from "../router.js";
import { ask, store, useStore } from "../store.js";
import { Form } from "../views/node.js";
import { PROBLEMS } from "./words.js";

const NO_RATES = new Map(), MINUTE = 60;
const POLICY = { stages: "1, 10%, 100%", wait: "5", blocked_rise: "10", answer_within: "30", limits: Object.fromEntries(Object.keys(PROBLEMS).map((key) => [key, key === "gone" ? "5%" : "0"])) };

export function NewRollout() {
  useStore("robots");
  const [filter, setFilter] = useState(filterOfAddress), [policy, setPolicy] = useState(POLICY);
  const robots = [...store.robots.values()].filter((robot) => robot.app), names = new Set(fitting(rowsOf(robots), filter).map(({ robot }) => robot.name));
  const chosen = robots.filter((robot) => names.has(robot.name));
  return html`<div class="head"><h1>New roll-out</h1><p>A change goes to one robot, then to more, then to all</p><span class="space"></span><a class="button" href=${to("rollouts")}>All roll-outs</a></div>
    <${Which} robots=${robots} chosen=${chosen} filter=${filter} change=${(part) => setFilter({ ...filter, ...part })} />
    <${How} policy=${policy} change=${(part) => setPolicy({ ...policy, ...part })} />
    ${chosen.length > 0 && html`<${What} key=${chosen[0].name} example=${chosen[0].name} begin=${(form) => review({ form, filter, policy, chosen })} />`}`;
}

function Which({ robots, chosen, filter, change }) {
  const groups = groupsOf(robots), apps = appsOf(robots);
  return html`<${Card} title="Which robots" tools=${html`<span role="status"><b>${plural(chosen.length, "robot")}</b></span>`}><div class="filters" role="search" aria-label="Robots">
    ${groups.length > 1 && html`<${Field} label="Group"><${Select} value=${filter.group} options=${groups} onChange=${(group) => change({ group })} /><//>`}
    ${apps.length > 2 && html`<${Field} label="App"><${Select} value=${filter.app} options=${apps} onChange=${(app) => change({ app })} /><//>`}
    <${Field} label="Words in names, alarms and reasons" grow><input type="search" value=${filter.text} maxlength="200" onInput=${(e) => change({ text: e.target.value })} /><//>
    ${filter.state && html`<button onClick=${() => change({ state: "" })}>In every state, not only: ${filter.state}</button>`}</div>
    ${chosen.length > 0 ? html`<p class="soft small">${chosen.slice(0, 12).map(({ name }) => name).join(", ")}${chosen.length > 12 && ` and ${plural(chosen.length - 12, "more robot")}`}</p>` : html`<${Empty}>No robot is chosen.<//>`}<//>`;
}

function How({ policy, change }) {
  const Text = (name, label) => html`<${Field} label=${label}><input name=${name} value=${policy[name]} maxlength="100" autocomplete="off" onInput=${(e) => change({ [name]: e.target.value })} /><//>`;
  const limit = (key, value) => change({ limits: { ...policy.limits, [key]: value } });
  return html`<${Card} title="Stages, and when it goes back"><div class="stack"><div class="grid">${Text("stages", "Robots with the change after each stage")}${Text("wait", "Minutes to watch before the next stage")}</div>
    <fieldset class="plain"><legend class="small soft">So many robots may show a problem: a number, or a share of those that have the change</legend><div class="grid limits">
      ${Object.entries(PROBLEMS).map(([key, about]) => html`<${Field} key=${key} label=${`${key}: ${about}`}><input name=${`limit-${key}`} value=${policy.limits[key]} maxlength="20" autocomplete="off" onInput=${(e) => limit(key, e.target.value)} /><//>`)}</div></fieldset>
    <div class="grid">${Text("blocked_rise", "“blocked”: the share rises by more percent than")}${Text("answer_within", "“gone”: away, or without an answer, for more seconds than")}</div></div><//>`;
}

// The change is made in the form of a coordination node, as the first of the robots has it.
function What({ example, begin }) {
  const fetched = useFetched(() => get(at("robots", example, "nodes")), [example]), [id, setId] = useState(""), [, draw] = useState(0);
  return html`<${Loaded} fetched=${fetched}>${(nodes) => {
    const node = nodes.find((each) => each.id === id) ?? nodes.find(({ rights }) => rights.length) ?? nodes[0];
    if (!node) return html`<${Empty}>The plan of ${example} has no coordination nodes.<//>`;
    const form = formOf(`roll-out ${example}`, node, () => draw((n) => n + 1), true), n = form.draft.size;
    form.foot = html`<button class="main" disabled=${!n || form.wrong()} onClick=${() => begin(form)}>Review and begin …</button><button disabled=${!n} onClick=${form.clear}>Discard</button><span class="soft small" aria-live="polite">${form.wrong() ? "Some value is not a number." : n ? `${plural(n, "setting")} in the change` : "Change at least one setting"}</span>`;
    return html`<${Card} title="The change" tools=${html`<span class="soft small">shown as ${example} has it now</span>`}><${Field} label="Coordination node"><${Select} id="rollout-node" value=${node.id} options=${nodes.map((each) => [each.id, `${each.id} (${each.type})`])} onChange=${setId} /><//><//>
      <${Form} key=${node.id} form=${form} rates=${NO_RATES} />`;
  }}<//>`;
}

function review({ form, filter, policy, chosen }) {
  const entries = [...form.draft.values()], stages = policy.stages.split(",").map((each) => each.trim());
  ask({
    title: `Roll out to ${plural(chosen.length, "robot")}`, icon: "steps", confirm: "Begin", danger: true,
    body: html`<${Notice} look="warn" icon="warning">This can make robots move, or stop them.<//><table class="diff both"><thead><tr><th>What</th><th>Then</th></tr></thead><tbody>${entries.map(({ field, value }) => html`<tr><td>${form.node.id} · ${field.what ?? field.label}</td><td><b>${value === null ? "as the plan" : words(field, value)}</b></td></tr>`)}</tbody></table>`,
    effects: [`It goes out to ${stages.join(", then to ")} of the robots, with ${policy.wait} min to watch before each next stage.`, "When a limit is passed, it goes back by itself on all robots that have it.", ...effectsOf(form.node, entries)],
    reason: { label: "Reason", least: 3 },
    act: async (reason) => {
      const { id } = await post("/rollouts", { robots: selectionOf(filter, chosen), nodes: { [form.node.id]: patchOf(form.draft) }, reason, ...policyOf(policy, stages) });
      form.clear();
      go("rollouts", String(id));
    },
  });
}

// By group and app where that says it all, so that the log says it too.
function selectionOf({ text, state, group, app }, chosen) {
  if (text || state || !(group || app)) return { names: chosen.map(({ name }) => name) };
  return { ...(group && { label: group }), ...(app && { app }) };
}

const amount = (text) => /^\d+$/.test(text.trim()) ? Number(text) : text.trim();
const number = (text) => { const value = Number(text.trim().replace(",", ".")); return text.trim() && Number.isFinite(value) ? value : text; };
const scaled = (text, factor) => typeof number(text) === "number" ? number(text) * factor : text;

const policyOf = (policy, stages) => ({ stages: stages.map(amount), wait: scaled(policy.wait, MINUTE), blocked_rise: scaled(policy.blocked_rise, 0.01), answer_within: scaled(policy.answer_within, 1), limits: Object.fromEntries(Object.entries(policy.limits).map(([key, text]) => [key, amount(text)])) });
