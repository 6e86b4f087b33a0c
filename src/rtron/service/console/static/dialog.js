// Dialogs: what will happen, before and after, and why; nothing moves or stops a robot without one.
import { html, useLayoutEffect, useRef, useState } from "./html.js";
import { Icon } from "./icons.js";
import { Field, Problem } from "./parts.js";
import { ask, store, useStore } from "./store.js";

export function Dialogs() {
  useStore("dialog");
  return store.dialog && html`<${Dialog} key=${store.dialog} dialog=${store.dialog} />`;
}

// A dialog: title, body, diff, effects, reason ({label, least}), confirm, danger, act(reason).
function Dialog({ dialog }) {
  const element = useRef(null), confirm = useRef(null), [reason, setReason] = useState(""), [state, setState] = useState({});
  useLayoutEffect(() => {
    const opener = document.activeElement;
    element.current.showModal();
    if (!dialog.reason?.least && !dialog.focus) confirm.current?.focus();
    return () => opener?.isConnected && opener.focus();
  }, []);
  const submit = (event) => {
    event.preventDefault();
    setState({ busy: true });
    new Promise((resolve) => { resolve(dialog.act(reason.trim())); }).then((keep) => keep || ask(null), (error) => setState({ error }));
  };
  const short = reason.trim().length < (dialog.reason?.least ?? 0);
  return html`<dialog ref=${element} aria-labelledby="dialog-title" onCancel=${(e) => { e.preventDefault(); ask(null); }}>
    <form onSubmit=${submit}>
      <h1 id="dialog-title">${dialog.icon && html`<${Icon} name=${dialog.icon} />`}${dialog.title}</h1>
      ${dialog.body}
      ${dialog.diff && html`<${Diff} diff=${dialog.diff} />`}
      ${dialog.effects?.length > 0 && html`<div class="stack"><h3>What will happen</h3><ul class="effects">${dialog.effects.map((text) => html`<li>${text}</li>`)}</ul></div>`}
      ${dialog.reason && html`<${Field} label=${dialog.reason.label}><input id="dialog-reason" value=${reason} maxlength="200" required=${dialog.reason.least > 0} autocomplete="off" onInput=${(e) => setReason(e.target.value)} /><//>`}
      ${state.error && html`<${Problem} error=${state.error} />`}
      <div class="actions">
        <button type="button" onClick=${() => ask(null)}>${dialog.act ? "Cancel" : "Close"}</button>
        ${dialog.act && html`<button ref=${confirm} class=${dialog.danger ? "danger" : "main"} disabled=${state.busy || short}>${state.busy ? "…" : dialog.confirm}</button>`}
      </div>
    </form>
  </dialog>`;
}

export const Diff = ({ diff, heads = ["What", "Now", "Then"], look = "" }) => html`<div class="scroll"><table class=${`diff ${look}`}><thead><tr>${heads.map((head) => html`<th>${head}</th>`)}</tr></thead><tbody>
  ${diff.map((d) => html`<tr><td>${d.what}</td><td>${d.before}</td><td>${d.after}</td></tr>`)}</tbody></table></div>`;

// A secret is shown this once.
export const showSecret = (title, secret) => ask({ title, icon: "key", body: html`<div class="stack"><p>This is shown once. Keep it in a safe place.</p><code class="secret">${secret}</code></div>` });
