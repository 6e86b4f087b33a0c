// The login.
import { html, useState } from "../html.js";
import { post } from "../api.js";
import { Logo } from "../icons.js";
import { Field, Problem } from "../parts.js";

export function Login({ onLogin }) {
  const [name, setName] = useState(""), [password, setPassword] = useState(""), [state, setState] = useState({});
  const submit = (event) => {
    event.preventDefault();
    setState({ busy: true });
    post("/login", { name, password }).then(onLogin, (error) => setState({ error }));
  };
  return html`<main class="login"><form onSubmit=${submit} aria-label="Log in">
    <div class="brand"><${Logo} /><span>RTron</span></div>
    <${Field} label="Name"><input name="name" value=${name} autocomplete="username" autofocus required maxlength="100" onInput=${(e) => setName(e.target.value)} /><//>
    <${Field} label="Password"><input name="password" type="password" value=${password} autocomplete="current-password" required maxlength="200" onInput=${(e) => setPassword(e.target.value)} /><//>
    ${state.error && html`<${Problem} error=${state.error} />`}
    <button class="main" disabled=${state.busy}>Log in</button>
  </form></main>`;
}
