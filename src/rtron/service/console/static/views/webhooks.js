// Webhooks: where alerts go.
import { html } from "../html.js";
import { at, get, post, remove } from "../api.js";
import { showSecret } from "../dialog.js";
import { At, Badge, Card, Empty, Field, Level, Loaded, Select, useFetched } from "../parts.js";
import { ask } from "../store.js";

export function Webhooks() {
  const fetched = useFetched(() => get("/webhooks"), []);
  return html`<div class="head"><h1>Webhooks</h1><p>Where alerts go, signed, by POST</p><span class="space"></span><button class="main" onClick=${() => askNew(fetched.again)}>New webhook …</button></div>
    <${Loaded} fetched=${fetched}>${(hooks) => hooks.length ? html`<${Card} tight><div class="scroll"><table class="cards"><thead><tr><th>Address</th><th>From level</th><th>State</th><th>Made</th><th></th></tr></thead><tbody>
      ${hooks.map((hook) => html`<tr key=${hook.id}><td data-label="Address" class="mono">${hook.url}</td><td data-label="From level"><${Level} level=${hook.level} /></td><td data-label="State"><span>${hook.failing ? html`<${Badge} look="bad" icon="error">failing<//> <span class="small">${hook.failing}</span>` : html`<${Badge} look="good" icon="check">well<//>`}</span></td><td data-label="Made"><${At} ns=${hook.created} /></td><td data-label="" class="min"><button onClick=${() => askRemove(hook, fetched.again)}>Remove …</button></td></tr>`)}</tbody></table></div><//>` : html`<${Empty}>There are no webhooks.<//>`}<//>`;
}

function askNew(again) {
  const made = { url: "", level: "warning" };
  ask({ title: "New webhook", icon: "bell", confirm: "Create", focus: true,
    body: html`<div class="stack"><${Field} label="Address"><input name="url" type="url" required pattern="https?://.*" maxlength="1000" placeholder="https://" onInput=${(e) => { made.url = e.target.value; }} /><//><${Field} label="Events of this level or worse"><${Select} value="warning" options=${[["info", "info"], ["warning", "warning"], ["error", "error"], ["heads", "none: signed heads of the audit log"]]} onChange=${(level) => { made.level = level; }} /><//></div>`,
    act: async () => { const hook = await post("/webhooks", made); again(); showSecret("The secret that signs its calls", hook.secret); return true; } });
}

const askRemove = (hook, again) => ask({ title: "Remove the webhook", icon: "warning", danger: true, confirm: "Remove", body: html`<code>${hook.url}</code>`, act: async () => { await remove(at("webhooks", String(hook.id))); again(); } });
