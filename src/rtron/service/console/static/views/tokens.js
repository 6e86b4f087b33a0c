// Tokens: how guards and programs log in.
import { html, useState } from "../html.js";
import { at, get, now, post, remove } from "../api.js";
import { showSecret } from "../dialog.js";
import { At, Badge, Card, Empty, Field, Loaded, useFetched } from "../parts.js";
import { ask } from "../store.js";
import { tellIfWaiting } from "./approvals.js";

const SCOPES = { guard: "guard: speaks for one robot", read: "read", metrics: "metrics", end_user: "end user", developer: "developer", admin: "admin" };

export function Tokens() {
  const fetched = useFetched(() => get("/tokens"), []);
  return html`<div class="head"><h1>Tokens</h1><p>How guards and programs log in</p><span class="space"></span><button class="main" onClick=${() => askNew(fetched.again)}>New token …</button></div>
    <${Loaded} fetched=${fetched}>${(tokens) => tokens.length ? html`<${Card} tight><div class="scroll"><table class="cards"><thead><tr><th>Name</th><th>For</th><th>Robot</th><th>State</th><th>Last used</th><th>Made</th><th></th></tr></thead><tbody>
      ${tokens.map((token) => html`<${Row} key=${token.name} token=${token} again=${fetched.again} />`)}</tbody></table></div><//>` : html`<${Empty}>There are no tokens.<//>`}<//>`;
}

const Row = ({ token, again }) => html`<tr><td data-label="Name"><b>${token.name}</b></td><td data-label="For">${token.scopes.join(", ")}</td><td data-label="Robot">${token.robot ?? ""}</td>
  <td data-label="State"><span><${State} token=${token} /></span></td><td data-label="Last used">${token.used ? html`<${At} ns=${token.used} />` : html`<span class="soft">never</span>`}</td><td data-label="Made"><span><${At} ns=${token.created} /> <span class="soft small">by ${token.by}</span></span></td>
  <td data-label="" class="min">${!token.revoked && html`<button onClick=${() => askRevoke(token, again)}>Revoke …</button>`}</td></tr>`;

function State({ token }) {
  if (token.revoked) return html`<${Badge} look="bad" icon="off">revoked<//>`;
  if (token.expires && token.expires / 1e6 < now()) return html`<${Badge} look="warn" icon="clock">expired<//>`;
  if (!token.expires) return html`<${Badge} look="warn" icon="clock" title="It was made by an older version">without an end<//>`;
  return html`<${Badge} look="good" icon="check">valid until <${At} ns=${token.expires} /><//>`;
}

function askNew(again) {
  const made = { name: "", scopes: [], robot: "", days: 90 };
  ask({ title: "New token", icon: "key", confirm: "Create", focus: true, body: html`<${Fields} made=${made} />`,
    act: async () => {
      const answer = await post("/tokens", { name: made.name, scopes: made.scopes, robot: made.robot || null, days: Number(made.days) });
      again();
      tellIfWaiting(answer.waits);
      showSecret(`The token ${made.name}`, answer.secret);
      return true;
    } });
}

function Fields({ made }) {
  const [scopes, setScopes] = useState([]);
  const toggle = (scope) => { made.scopes = scopes.includes(scope) ? scopes.filter((s) => s !== scope) : [...scopes, scope]; setScopes(made.scopes); };
  return html`<div class="stack"><${Field} label="Name"><input name="name" required maxlength="100" autocomplete="off" onInput=${(e) => { made.name = e.target.value; }} /><//>
    <fieldset class="plain"><legend class="small soft">For</legend><div class="checks">${Object.entries(SCOPES).map(([scope, label]) => html`<label><input type="checkbox" name=${scope} checked=${scopes.includes(scope)} onChange=${() => toggle(scope)} />${label}</label>`)}</div></fieldset>
    ${scopes.includes("guard") && html`<${Field} label="Robot"><input name="robot" required maxlength="100" autocomplete="off" onInput=${(e) => { made.robot = e.target.value; }} /><//>`}
    <${Field} label="Valid for days"><input name="days" type="number" min="1" max="3650" required value=${made.days} onInput=${(e) => { made.days = e.target.value; }} /><//></div>`;
}

const askRevoke = (token, again) => ask({ title: `Revoke ${token.name}`, icon: "warning", danger: true, confirm: "Revoke", effects: [token.robot ? `The guard of ${token.robot} is cut off from the service; it goes on guarding by its last settings.` : "Programs that use it are refused from now on."], act: async () => { await remove(at("tokens", token.name)); again(); } });
