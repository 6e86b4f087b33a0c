// One setting of a coordination node: the plan's value, the value in force, and the one in draft.
import { html, useState } from "../html.js";
import { said } from "../format.js";
import { Select } from "../parts.js";

const USER = "the end user", DEVELOPER = "the developer";
const EXECUTOR = { GRCN: () => DEVELOPER, RSRCN: (right) => right === "select_policy" || right === "set_max_vel_limit" ? USER : DEVELOPER, MSRCN: () => USER };

// Why the one who is logged in may not change a setting; nothing if that is allowed.
export const refusal = (node, right) => node.rights.includes(right) ? "" : `only ${EXECUTOR[node.type](right)} may change this`;

export const keyOf = (path) => JSON.stringify(path);
const NUMBERS = { seconds: { least: 0, unit: "s" }, number: { least: 0 }, whole: {} };

// A field: path, label, kind, unit, right, plan, now, and `locked`, a reason why nobody may change it.
export function Setting({ field, form }) {
  const locked = field.locked || refusal(form.node, field.right), changed = form.draft.has(keyOf(field.path));
  const value = form.valueOf(field), Input = INPUTS[field.kind];
  return html`<div class=${`setting ${changed ? "changed" : ""}`} title=${locked || undefined}>
    <div class="row"><${Input} field=${field} value=${value} locked=${locked} set=${(v) => form.set(field, v)} label=${field.label} />${unitOf(field) && html`<span class="unit">${unitOf(field)}</span>`}</div>
    <${Beside} field=${field} form=${form} locked=${locked} value=${value} />
    ${locked && html`<span class="hidden">${locked}</span>`}
  </div>`;
}

const unitOf = (field) => field.unit ?? NUMBERS[field.kind]?.unit ?? "";
export const words = (field, value) => field.kind === "rule" && value?.when ? `while ${value.when}: ${value.block.join(", ")}` : said(value, field.kind === "seconds" ? "s" : field.unit);
export const same = (a, b) => JSON.stringify(a ?? null) === JSON.stringify(b ?? null);

// Beside each value stands the plan's; what differs from it can be taken back.
function Beside({ field, form, locked, value }) {
  const differs = !same(field.now, field.plan), back = !locked && !same(value, field.plan);
  if (field.plan === undefined) return null;
  return html`<div class="plan"><span class=${differs ? "differs" : ""}>plan ${words(field, field.plan)}${differs ? `, in force ${words(field, field.now)}` : ""}</span>${back && html`<button type="button" class="link small" onClick=${() => form.back(field)}>use the plan's</button>`}</div>`;
}

const INPUTS = {
  policy: ({ field, value, locked, set, label }) => html`<${Select} aria-label=${label} disabled=${Boolean(locked)} value=${value ?? ""} options=${field.options} onChange=${set} />`,
  bit: ({ value, locked, set, label }) => html`<label class="check"><input type="checkbox" aria-label=${label} checked=${Boolean(value)} disabled=${Boolean(locked)} onChange=${(e) => set(e.target.checked)} /><span class="mono">${value ? "1" : "0"}</span></label>`,
  text: ({ value, locked, set, label }) => html`<input aria-label=${label} class="mono" value=${value ?? ""} disabled=${Boolean(locked)} maxlength="1000" spellcheck="false" onInput=${(e) => set(e.target.value)} />`,
  seconds: (props) => html`<${Figure} ...${props} shown=${(v) => v / 1e9} kept=${(v) => Math.round(v * 1e9)} />`,
  number: (props) => html`<${Figure} ...${props} shown=${(v) => v} kept=${(v) => v} />`,
  whole: (props) => html`<${Figure} ...${props} shown=${(v) => v} kept=${(v) => v} />`,
};

// What is typed stays as it is typed until the field is left; what is no number within bounds is NaN.
function Figure({ field, value, locked, set, label, shown, kept }) {
  const [typed, setTyped] = useState(null), empty = value === null || value === undefined || Number.isNaN(value);
  const put = (text) => { setTyped(text); set(parsed(field, text, kept)); };
  return html`<input class="figure" inputmode="decimal" autocomplete="off" aria-label=${label} aria-invalid=${Number.isNaN(value) ? "true" : undefined} title=${field.most === undefined ? undefined : `at most ${shown(field.most)}`} disabled=${Boolean(locked)} value=${typed ?? (empty ? "" : String(+shown(value).toFixed(9)))} onInput=${(e) => put(e.target.value)} onBlur=${() => Number.isNaN(value) || setTyped(null)} />`;
}

function parsed(field, text, kept) {
  const number = text.trim() === "" ? NaN : kept(Number(text.trim().replace(",", ".")));
  const { least } = NUMBERS[field.kind], whole = field.kind !== "whole" || Number.isSafeInteger(number);
  return Number.isFinite(number) && whole && number >= (least ?? -Infinity) && number <= (field.most ?? Infinity) ? number : NaN;
}
