// Users: who may log in, and as what.
import { html, useState } from "../html.js";
import { at, get, patch, post, remove } from "../api.js";
import { ROLES } from "../format.js";
import { At, Badge, Card, Field, Loaded, useFetched } from "../parts.js";
import { ask, store } from "../store.js";
import { tellIfWaiting } from "./approvals.js";

export function Users() {
  const fetched = useFetched(() => get("/users"), []);
  return html`<div class="head"><h1>Users</h1><span class="space"></span><button class="main" onClick=${() => askNew(fetched.again)}>New user …</button></div>
    <${Loaded} fetched=${fetched}>${(users) => html`<${Card} tight><div class="scroll"><table class="cards"><thead><tr><th>Name</th><th>Roles</th><th>State</th><th>Since</th><th></th></tr></thead><tbody>
      ${users.map((user) => html`<${Row} key=${user.name} user=${user} again=${fetched.again} />`)}</tbody></table></div><//>`}<//>`;
}

const Row = ({ user, again }) => html`<tr><td data-label="Name"><b>${user.name}</b></td><td data-label="Roles">${user.roles.map((role) => ROLES[role] ?? role).join(", ")} ${user.is_from_provider && html`<${Badge} icon="key" title="Signs in at the provider, which gives the roles">provider<//>`}</td>
  <td data-label="State"><span>${user.disabled ? html`<${Badge} look="warn" icon="off">disabled<//>` : html`<${Badge} look="good" icon="check">may log in<//>`}</span></td><td data-label="Since"><${At} ns=${user.created} /></td>
  <td data-label="" class="min"><div class="line nowrap-wide"><button onClick=${() => askChange(user, again)}>Change …</button><button onClick=${() => askReset(user)}>Reset code …</button><button onClick=${() => askRemove(user, again)} disabled=${user.name === store.me.name} title=${user.name === store.me.name ? "that is you" : undefined}>Remove …</button></div></td></tr>`;

function Roles({ roles, onChange }) {
  const [chosen, setChosen] = useState(roles);
  const toggle = (role) => { const next = chosen.includes(role) ? chosen.filter((r) => r !== role) : [...chosen, role]; setChosen(next); onChange(next); };
  return html`<fieldset class="plain"><legend class="small soft">Roles</legend><div class="checks">${Object.entries(ROLES).map(([role, label]) => html`<label><input type="checkbox" name=${role} checked=${chosen.includes(role)} onChange=${() => toggle(role)} />${label}</label>`)}</div></fieldset>`;
}

function askNew(again) {
  const made = { name: "", password: "", roles: ["end_user"] };
  ask({ title: "New user", icon: "user", confirm: "Create", focus: true,
    body: html`<div class="stack"><${Field} label="Name"><input name="name" required maxlength="100" autocomplete="off" onInput=${(e) => { made.name = e.target.value; }} /><//><${Field} label="Password, 12 characters at least"><input name="password" type="password" required minlength="12" maxlength="200" autocomplete="new-password" onInput=${(e) => { made.password = e.target.value; }} /><//><${Roles} roles=${made.roles} onChange=${(roles) => { made.roles = roles; }} /></div>`,
    act: async () => { tellIfWaiting(await post("/users", made)); again(); } });
}

function askChange(user, again) {
  const change = { password: "", roles: user.roles, disabled: user.disabled };
  ask({ title: `Change ${user.name}`, icon: "user", confirm: "Change", focus: true,
    body: html`<div class="stack"><${Field} label="New password (empty: stays)"><input type="password" minlength="12" maxlength="200" autocomplete="new-password" onInput=${(e) => { change.password = e.target.value; }} /><//><${Roles} roles=${user.roles} onChange=${(roles) => { change.roles = roles; }} /><${Disabled} change=${change} /></div>`,
    effects: ["All sessions of this user end."],
    act: async () => { tellIfWaiting(await patch(at("users", user.name), changed(user, change))); again(); } });
}

// What differs: who signs in at a provider has the roles from there.
const changed = (user, change) => ({ password: change.password || null, roles: String(change.roles) === String(user.roles) ? null : change.roles, disabled: change.disabled === user.disabled ? null : change.disabled });

function Disabled({ change }) {
  const [disabled, setDisabled] = useState(change.disabled);
  return html`<label class="check"><input type="checkbox" checked=${disabled} onChange=${() => { change.disabled = !disabled; setDisabled(!disabled); }} />may not log in</label>`;
}

const askReset = (user) => ask({ title: `Reset the second factor of ${user.name}`, icon: "warning", danger: true, confirm: "Reset", effects: ["The user logs in without a one-time code; where the role requires one, a new one is enrolled then.", "All sessions of this user end."], act: async () => { tellIfWaiting(await remove(at("users", user.name, "second-factor"))); } });

const askRemove = (user, again) => ask({ title: `Remove ${user.name}`, icon: "warning", danger: true, confirm: "Remove", effects: ["The user's sessions end. What the user did stays in the audit log."], act: async () => { await remove(at("users", user.name)); again(); } });
