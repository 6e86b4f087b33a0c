// Changes of rights that wait for a second admin.
import { html } from "../html.js";
import { at, get, post, remove } from "../api.js";
import { At, Card, Empty, Loaded, useFetched } from "../parts.js";
import { ask, store, toast } from "../store.js";

export function Approvals() {
  const fetched = useFetched(() => get("/approvals"), []);
  return html`<div class="head"><h1>Approvals</h1><p>What gives rights, and waits for a second admin</p></div>
    <${Loaded} fetched=${fetched}>${(changes) => changes.length ? html`<${Card} tight><div class="scroll"><table class="cards"><thead><tr><th>Change</th><th>Of</th><th>Then</th><th>Requested</th><th>Over</th><th></th></tr></thead><tbody>
      ${changes.map((change) => html`<${Row} key=${change.id} change=${change} again=${fetched.again} />`)}</tbody></table></div><//>` : html`<${Empty}>Nothing waits.<//>`}<//>`;
}

const isOwn = (change) => [change.by, change.owner].includes(store.me.name);
const Row = ({ change, again }) => html`<tr><td data-label="Change">${change.action}</td><td data-label="Of"><b>${change.target}</b></td><td data-label="Then">${inWords(change.detail)}</td>
  <td data-label="Requested"><span><${At} ns=${change.created} /> <span class="soft small">by ${change.by}</span></span></td><td data-label="Over"><${At} ns=${change.expires} /></td>
  <td data-label="" class="min"><div class="line nowrap-wide"><button class="main" disabled=${isOwn(change)} title=${isOwn(change) ? "you have requested it" : undefined} onClick=${() => askApprove(change, again)}>Approve …</button><button onClick=${() => askReject(change, again)}>Reject …</button></div></td></tr>`;

const inWords = (detail) => Object.entries(detail).map(([key, value]) => `${key}: ${Array.isArray(value) ? value.join(", ") : value}`).join("; ");
const askApprove = (change, again) => ask({ title: `Approve: ${change.action} ${change.target}`, icon: "warning", danger: true, confirm: "Approve", effects: [`${change.by} has requested it: ${inWords(change.detail)}`, "Your name and this are in the audit log."], act: async () => { await post(at("approvals", String(change.id))); again(); } });
const askReject = (change, again) => ask({ title: `Reject: ${change.action} ${change.target}`, icon: "warning", confirm: "Reject", act: async () => { await remove(at("approvals", String(change.id))); again(); } });

// Tell that a change waits, if it is one that does.
export function tellIfWaiting(answer) {
  if (answer?.owner) toast("info", "The change waits for a second admin, under Approvals.");
}
