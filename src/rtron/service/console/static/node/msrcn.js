// The form of the MSRCN: rules, from the bits of eflows to the bits of aflows.
import { html, useState } from "../html.js";
import { Badge, Bit, Card, Empty, Field, Notice } from "../parts.js";
import { ask } from "../store.js";
import { keyOf, refusal, Setting } from "./fields.js";
import { policyField, Rates } from "./grcn.js";
import { flowRate } from "./rsrcn.js";

export function MsrcnForm({ form, plan, state, rates }) {
  const { node } = form;
  return html`<${Card} title="Rules of the mission" tight tools=${html`<${NewRule} form=${form} />`} foot=${form.foot}>
      <div class="body grid"><div><h3>Policy</h3><${Setting} field=${policyField(node)} form=${form} /></div><p class="soft small">While the bits of its eflows make a rule's condition true, the bits of its aflows are 1: what these say is blocked. A bit that nobody knows counts as the rule says, in doubt as blocking.</p></div>
      <${Rules} form=${form} state=${state} /><//>
    <${Card} title="aflows: the actions" tight><${Actions} form=${form} plan=${plan} rates=${rates} /><//>
    <${Card} title="eflows: the events, and their bits now" tight><${Events} node=${node} state=${state} /><//>`;
}

function Rules({ form, state }) {
  const rules = allRules(form);
  return rules.length ? html`<div class="scroll"><table class="cards settings"><thead><tr><th>Counts</th><th>Rule</th><th>While (eflow bits)</th><th>Blocked (aflow bits 1)</th><th>Now</th></tr></thead>
    <tbody>${rules.map((rule) => html`<${RuleRow} key=${rule.name} rule=${rule} form=${form} state=${state} />`)}</tbody></table></div>` : html`<${Empty}>The plan has no rules. Add one of your own.<//>`;
}

// The plan's rules, then those that people added, then those in draft.
export function allRules(form) {
  const { node, draft } = form, planned = node.plan.rules, known = new Set(planned.map((r) => r.name));
  const added = Object.entries(node.settings.rules).filter(([name]) => !known.has(name)).map(([name, own]) => ({ name, ...own, reason: "", own: true }));
  const drafted = [...draft.values()].filter(({ field, value }) => field.kind === "rule" && value && !node.settings.rules[field.rule]).map(({ field, value }) => ({ name: field.rule, ...value, own: true, drafted: true }));
  return [...planned, ...added, ...drafted];
}

function RuleRow({ rule, form, state }) {
  const { node } = form, own = node.settings.rules[rule.name], mandatory = rule.mandatory || node.mandatory.includes(rule.name);
  const now = state?.rules.find((r) => r.name === rule.name);
  const field = (name, kind, right, plan, value) => ({ path: ["rules", rule.name, name], label: `${name} of ${rule.name}`, kind, right, rule: rule.name, plan, now: value, locked: mandatory ? "mandatory: the plan says so" : "" });
  const selected = field("selected", "bit", "select_rules", true, own?.selected ?? true);
  const when = field("when", "text", "set_rules", rule.own ? undefined : rule.when, own?.when ?? rule.when);
  const block = field("block", "list", "set_rules", rule.own ? undefined : rule.block, own?.block ?? rule.block);
  return html`<tr>
    <td data-label="Counts">${rule.drafted ? html`<${Badge} look="warn">new<//>` : html`<${Setting} field=${{ ...selected, plan: undefined }} form=${form} />`}</td>
    <td data-label="Rule"><span><b>${rule.name}</b> ${mandatory && html`<${Badge} icon="lock" title="It cannot be deselected or weakened">mandatory<//>`}${rule.own && html`<${Badge}>own<//>`}${rule.reason && html`<span class="soft small">${rule.reason}</span>`}${rule.require && html`<span class="soft small">until ${rule.require} has spoken</span>`}${rule.action && html`<span class="soft small">only where <code>${rule.action}</code></span>`}
      ${rule.own && html`<${Delete} rule=${rule} form=${form} />`}</span></td>
    <td data-label="While">${rule.drafted ? html`<code>${rule.when}</code>` : html`<${Setting} field=${when} form=${form} />`}</td>
    <td data-label="Blocked">${rule.drafted ? html`<span class="mono">${rule.block.join(" ")}</span>` : html`<${Blocked} field=${block} form=${form} />`}</td>
    <td data-label="Now">${now ? html`<span>${now.blocks ? html`<${Badge} look="bad" icon="stop">blocks<//>` : html`<${Badge} look="good" icon="check">lets pass<//>`}<span class="soft small">${now.reason}</span></span>` : html`<span class="soft">–</span>`}</td></tr>`;
}

function Delete({ rule, form }) {
  const locked = refusal(form.node, "set_rules"), field = ruleField(rule.name), gone = form.draft.get(keyOf(field.path))?.value === null;
  const toggle = () => {
    if (rule.drafted || gone) form.set(field, field.now);
    else form.set({ ...field, now: `${rule.when}: ${rule.block.join(", ")}` }, null);
  };
  return html` <button type="button" class="link small" disabled=${Boolean(locked)} title=${locked || undefined} onClick=${toggle}>${gone ? "keep it" : "delete"}</button>`;
}

const ruleField = (name) => ({ path: ["rules", name], label: `rule ${name}`, kind: "rule", right: "set_rules", rule: name, plan: undefined, now: undefined });
const choices = (node) => node.plan.aflows.flatMap((topic) => [[topic.topic, "all of it"], ...topic.flows.map((flow) => [flow.name, `${flow.publisher} on ${topic.topic}`])]);

// Which aflows a rule blocks: bits to tick, in a dialog, since there may be many.
function Blocked({ field, form }) {
  const locked = field.locked || refusal(form.node, field.right), value = form.valueOf(field), changed = form.draft.has(keyOf(field.path));
  const edit = () => {
    let chosen = value;
    ask({ title: `What ${field.rule} blocks`, confirm: "Into the draft", body: html`<${Bits} node=${form.node} value=${value} onChange=${(names) => { chosen = names; }} />`, act: () => { if (!chosen.length) throw new Error("A rule blocks one aflow at least."); form.set(field, chosen); } });
  };
  return html`<div class=${`setting ${changed ? "changed" : ""}`} title=${locked || undefined}><span class="mono">${value.join(" ")}</span><div class="plan"><button type="button" class="link small" disabled=${Boolean(locked)} onClick=${edit}>choose bits</button>${field.plan && !locked && JSON.stringify(field.plan) !== JSON.stringify(value) && html`<button type="button" class="link small" onClick=${() => form.back(field)}>use the plan's</button>`}</div></div>`;
}

function Bits({ node, value, onChange }) {
  const [chosen, setChosen] = useState(value);
  const toggle = (name) => { const next = chosen.includes(name) ? chosen.filter((n) => n !== name) : [...chosen, name]; setChosen(next); onChange(next); };
  return html`<div class="stack bits">${choices(node).map(([name, about]) => html`<label class="check"><input type="checkbox" checked=${chosen.includes(name)} onChange=${() => toggle(name)} /><span class="mono">${name}</span> <span class="soft small">${about}</span></label>`)}</div>`;
}

function NewRule({ form }) {
  const locked = refusal(form.node, "set_rules");
  const add = () => {
    const made = { name: "", when: "", block: [] };
    ask({ title: "A rule of your own", confirm: "Into the draft", body: html`<${RuleFields} node=${form.node} made=${made} />`, act: () => { check(form, made); form.set(ruleField(made.name.trim()), { when: made.when.trim(), block: made.block }); } });
  };
  return html`<button disabled=${Boolean(locked)} title=${locked || undefined} onClick=${add}>New rule …</button>`;
}

function check(form, { name, when, block }) {
  if (!name.trim() || !when.trim() || !block.length) throw new Error("A rule needs a name, a condition and something to block.");
  if (allRules(form).some((rule) => rule.name === name.trim())) throw new Error("There is a rule of this name.");
}

function RuleFields({ node, made }) {
  const [when, setWhen] = useState("");
  const put = (value) => { made.when = value; setWhen(value); };
  return html`<div class="stack">
    <${Field} label="Name"><input maxlength="100" onInput=${(e) => { made.name = e.target.value; }} /><//>
    <${Field} label="While: eflows with && || ! and parentheses, or true"><input class="mono" value=${when} maxlength="1000" spellcheck="false" onInput=${(e) => put(e.target.value)} /><//>
    <div class="line">${node.plan.eflows.map((flow) => html`<button type="button" class="link small mono" title=${flow.topic} onClick=${() => put(when ? `${when} && ${flow.name}` : flow.name)}>${flow.name}</button>`)}</div>
    <h3>Blocked then</h3><${Bits} node=${node} value=${made.block} onChange=${(names) => { made.block = names; }} /></div>`;
}

function Actions({ form, plan, rates }) {
  const { node } = form, blockField = (topic, flow) => ({ path: ["flows", flow.name, "block"], label: `block bit of ${flow.name}`, what: `block bit of ${flow.name} (${flow.publisher})`, kind: "bit", right: "set_block", publisher: flow.publisher, plan: flow.block, now: node.effective.aflows.find((t) => t.topic === topic.topic)?.flows.find((f) => f.name === flow.name)?.block });
  return html`<div class="scroll"><table class="cards settings"><thead><tr><th>aflow</th><th>Topic</th><th>Publisher</th><th>Block bit</th><th class="number">Messages/s</th></tr></thead><tbody>
    ${node.plan.aflows.flatMap((topic) => topic.flows.map((flow) => html`<tr key=${`${topic.topic} ${flow.name}`}><td data-label="aflow">${flow.name}</td><td data-label="Topic" class="mono">${topic.topic}</td><td data-label="Publisher" class="mono">${flow.publisher}</td><td data-label="Block bit"><${Setting} field=${blockField(topic, flow)} form=${form} /></td><td data-label="Messages/s" class="number"><${Rates} of=${flowRate(rates, plan, topic.topic, flow)} /></td></tr>`))}</tbody></table></div>`;
}

const Events = ({ node, state }) => node.plan.eflows.length ? html`<div class="scroll"><table class="cards"><thead><tr><th>Bit</th><th>eflow</th><th>Topic</th><th>Publisher</th><th>Its bit is 1</th></tr></thead><tbody>
  ${node.plan.eflows.map((flow) => html`<tr key=${flow.name}><td data-label="Bit"><${Bit} value=${state ? state.bits[flow.name] : undefined} title=${state?.bits[flow.name] === null ? "nobody knows it now" : ""} /></td><td data-label="eflow">${flow.name}</td><td data-label="Topic" class="mono">${flow.topic}</td><td data-label="Publisher" class="mono">${flow.publisher}</td><td data-label="Is 1">${condition(flow)}</td></tr>`)}</tbody></table></div>` : html`<${Notice}>The plan has no events.<//>`;

function condition(flow) {
  const where = flow.when ? html` where <code>${flow.when}</code>` : "";
  if (flow.present !== null) return html`for ${flow.present / 1e9} s after a message${where}`;
  if (flow.silent !== null) return html`after ${flow.silent / 1e9} s without a message${where}`;
  return flow.when ? html`while <code>${flow.when}</code>` : "after any message";
}
