// The login.
import { html, useState } from "../html.js";
import { get, post } from "../api.js";
import { Logo } from "../icons.js";
import { Field, Problem, useFetched } from "../parts.js";
import { store } from "../store.js";
import { SecondStep } from "./second_factor.js";

// Why the provider's sign-in has led back here: a word of the service, never a text of strangers.
const REFUSALS = {
  no_role: ["You have signed in, but have no role here.", "Ask an admin to map one of your groups to a role."],
  name_taken: ["You have signed in, but your name belongs to another user here.", "Ask an admin to remove that user."],
  bad_name: ["You have signed in, but your name there cannot be one here.", "Names are letters, digits and . _ @ -"],
  disabled: ["You have signed in, but are disabled here.", "Ask an admin."],
  refused: ["The provider has not signed you in.", ""],
  expired: ["The sign-in took too long, or was begun in another browser.", "Try again."],
  failed: ["The provider could not be asked, or its answer was wrong.", "The service's log says why."],
  busy: ["Too many sign-ins at this moment.", "Try again soon."],
};
function refusal() {
  const word = new URLSearchParams(location.search).get("sign_in");
  const [message, help] = Object.hasOwn(REFUSALS, word) ? REFUSALS[word] : [];
  return message && { message, help };
}

export function Login({ onLogin }) {
  const [name, setName] = useState(""), [password, setPassword] = useState(""), [state, setState] = useState({ me: store.begun }), methods = useFetched(() => get("/login/methods"), []);
  const submit = (event) => {
    event.preventDefault();
    setState({ busy: true });
    post("/login", { name, password }).then((me) => (me.stage === "complete" ? onLogin(me) : setState({ me })), (error) => setState({ error }));
  };
  if (state.me) return html`<main class="login"><div class="step"><div class="brand"><${Logo} /><span>RTron</span></div><${SecondStep} me=${state.me} password=${password} onLogin=${onLogin} /></div></main>`;
  return html`<main class="login"><form onSubmit=${submit} aria-label="Log in">
    <div class="brand"><${Logo} /><span>RTron</span></div>
    <${Field} label="Name"><input name="name" value=${name} autocomplete="username" autofocus required maxlength="100" onInput=${(e) => setName(e.target.value)} /><//>
    <${Field} label="Password"><input name="password" type="password" value=${password} autocomplete="current-password" required maxlength="200" onInput=${(e) => setPassword(e.target.value)} /><//>
    ${state.error && html`<${Problem} error=${state.error} />`}
    ${!state.error && refusal() && html`<${Problem} error=${refusal()} />`}
    <button class="main" disabled=${state.busy}>Log in</button>
    ${methods.value?.oidc && html`<a class="button" href="/api/v1/login/oidc">Log in with ${methods.value.oidc}</a>`}
  </form></main>`;
}
