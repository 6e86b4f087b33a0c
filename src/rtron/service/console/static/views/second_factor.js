// One-time codes: shown at the login, enrolled with the password or a new sign-in, removed.
import { html, useEffect, useState } from "../html.js";
import { get, post, remove, useCsrf } from "../api.js";
import { Card, Field, Loaded, Notice, Problem, useFetched } from "../parts.js";

const CODE = { name: "code", minlength: 6, maxlength: 40, autocomplete: "one-time-code" };
const PASSWORD = { name: "password", type: "password", maxlength: 200, autocomplete: "current-password" };

// A form that asks for a code, or the password, and does something with it.
function SecretForm({ input = CODE, label, hint, confirm, danger, act }) {
  const [code, setCode] = useState(""), [state, setState] = useState({});
  const submit = (event) => {
    event.preventDefault();
    setState({ busy: true });
    act(code).then(() => setState({}), (error) => { setState({ error }); setCode(""); });
  };
  return html`<form class="stack narrow-form" onSubmit=${submit} aria-label=${label}>
    <${Field} label=${label}><input ...${input} value=${code} required autofocus onInput=${(e) => setCode(e.target.value)} /><//>
    ${hint && html`<p class="small soft">${hint}</p>`}
    ${state.error && html`<${Problem} error=${state.error} />`}
    <div><button class=${danger ? "danger" : "main"} disabled=${state.busy}>${confirm}</button></div></form>`;
}

// The second half of a login: a code, or the enrolment that a role requires.
export function SecondStep({ me, password, onLogin }) {
  useCsrf(me.csrf);
  if (me.stage === "enrolment") return html`<div class="stack"><p>Your role requires one-time codes as a second factor.</p><${Enrol} password=${password} onDone=${onLogin} /></div>`;
  return html`<${SecretForm} label="Code of your app" hint="Without your phone: a recovery code." confirm="Log in" act=${(code) => post("/login/code", { code }).then(onLogin)} />`;
}

const Picture = ({ rows }) => html`<svg class="qr" viewBox=${`-4 -4 ${rows.length + 8} ${rows.length + 8}`} width="200" height="200" role="img" aria-label="QR code of the key below">
  <rect x="-4" y="-4" width="100%" height="100%" fill="white" /><path fill="black" d=${rows.flatMap((row, y) => [...row].map((bit, x) => (bit === "1" ? `M${x} ${y}h1v1h-1z` : ""))).join("")} /></svg>`;

// A session alone may be stolen: who has it proves again who it is. After a login the password is known.
function Enrol({ password, onDone }) {
  const [given, setGiven] = useState(null), fetched = useFetched(() => (password ? post("/me/second-factor", { password }).then((key) => ({ key })) : get("/me/second-factor")), []);
  if (given) return html`<${EnrolKey} made=${given} onDone=${onDone} />`;
  return html`<${Loaded} fetched=${fetched}>${({ key, proof }) => {
    if (key) return html`<${EnrolKey} made=${key} onDone=${onDone} />`;
    if (proof === "sign-in") return html`<div class="stack"><p>Sign in once more, then enrol the codes within ten minutes.</p><div><a class="button" href="/api/v1/login/oidc">Sign in again</a></div></div>`;
    const ask = (password) => post("/me/second-factor", { password }).then(setGiven);
    if (proof === "none") return html`<div><button class="main" autofocus onClick=${() => ask("")}>Show the key</button></div>`;
    return html`<${SecretForm} input=${PASSWORD} label="Your password" confirm="Show the key" act=${ask} />`;
  }}<//>`;
}

function EnrolKey({ made, onDone }) {
  const [done, setDone] = useState(null);
  if (done) return html`<${RecoveryCodes} codes=${done.recovery_codes} onKept=${() => onDone(done.user)} />`;
  return html`<div class="stack"><p>Scan this with an authenticator app (TOTP), or type the key into it.</p><${Picture} rows=${made.qr} /><code class="secret">${made.key}</code>
    <${SecretForm} label="First code of the app" confirm="Enrol" act=${(code) => post("/me/second-factor/confirmation", { code }).then((answer) => { useCsrf(answer.user.csrf); setDone(answer); })} /></div>`;
}

const RecoveryCodes = ({ codes, onKept }) => html`<div class="stack"><h3>Recovery codes</h3><p>Each replaces the phone once. They are shown this once: keep them in a safe place.</p>
  <code class="secret recovery">${codes.map((code) => html`<div>${code}</div>`)}</code><div><button class="main" onClick=${onKept}>I have kept them</button></div></div>`;

// Of one's own account.
export function SecondFactor() {
  const fetched = useFetched(() => get("/me/second-factor"), []), [enrols, setEnrols] = useState(false);
  useEffect(() => setEnrols(false), [fetched.value]);
  return html`<${Card} title="Second factor"><${Loaded} fetched=${fetched}>${(factor) => {
    if (enrols) return html`<${Enrol} onDone=${fetched.again} />`;
    if (!factor.is_enrolled) return html`<div class="stack"><p>${factor.proof === "password" ? "You log in with the password alone." : "You sign in without a one-time code of this console."}</p><div><button class="main" onClick=${() => setEnrols(true)}>Enrol one-time codes …</button></div></div>`;
    return html`<div class="stack"><${Notice} look="good" icon="check">A login takes a one-time code. ${factor.recovery_codes} recovery codes are left.<//>
      <${SecretForm} label="Code, to remove it" confirm="Remove" danger act=${(code) => remove("/me/second-factor", { code }).then(fetched.again)} /></div>`;
  }}<//><//>`;
}
