// One's own account: the password, and the way out.
import { html, useState } from "../html.js";
import { post } from "../api.js";
import { ROLES } from "../format.js";
import { Card, Field, Notice, Problem } from "../parts.js";
import { logout } from "../session.js";
import { store } from "../store.js";
import { SecondFactor } from "./second_factor.js";

export function Account() {
  return html`<div class="head"><h1>${store.me.name}</h1><p>${store.me.roles.map((role) => ROLES[role] ?? role).join(", ")}</p><span class="space"></span><button onClick=${logout}>Log out</button></div><div class="stack"><${Password} /><${SecondFactor} /></div>`;
}

function Password() {
  const [given, setGiven] = useState({ old: "", next: "", again: "" }), [state, setState] = useState({});
  const input = (name, label, complete) => html`<${Field} label=${label}><input type="password" name=${name} value=${given[name]} required minlength=${name === "old" ? undefined : 12} maxlength="200" autocomplete=${complete} onInput=${(e) => setGiven({ ...given, [name]: e.target.value })} /><//>`;
  const submit = (event) => {
    event.preventDefault();
    if (given.next !== given.again) return setState({ error: { message: "the new password is not the same twice" } });
    post("/me/password", { old: given.old, new: given.next }).then(() => { setState({ done: true }); setGiven({ old: "", next: "", again: "" }); }, (error) => setState({ error }));
  };
  return html`<${Card} title="Password"><form class="stack narrow-form" onSubmit=${submit}>${input("old", "Old password", "current-password")}${input("next", "New password, 12 characters at least", "new-password")}${input("again", "New password again", "new-password")}
    ${state.error && html`<${Problem} error=${state.error} />`}${state.done && html`<${Notice} look="good" icon="check">The password is changed. Your other sessions have ended.<//>`}<div><button class="main">Change the password</button></div></form><//>`;
}
