// Roll-outs: a change that goes out to many robots in stages.
import { html, useState } from "../html.js";
import { get } from "../api.js";
import { count } from "../format.js";
import { At, Card, Empty, Loaded, useFetched } from "../parts.js";
import { Rollout, useRolloutNews } from "../rollouts/rollout.js";
import { NewRollout } from "../rollouts/start.js";
import { State } from "../rollouts/words.js";
import { to } from "../router.js";

const PAGE = 50;

export function Rollouts({ item }) {
  if (item === "new") return html`<${NewRollout} />`;
  return item ? html`<${Rollout} id=${item} />` : html`<${List} />`;
}

function List() {
  const [before, setBefore] = useState(null), fetched = useFetched(() => get("/rollouts", { before, limit: PAGE }), [before]);
  useRolloutNews(fetched.again);
  return html`<div class="head"><h1>Roll-outs</h1><p>A change goes out to many robots in stages, is watched, and goes back by itself</p><span class="space"></span><a class="button" href=${to("rollouts", "new")}>New roll-out …</a></div>
    <${Loaded} fetched=${fetched}>${({ rollouts, next }) => html`${rollouts.length ? html`<${Card} tight><div class="scroll"><table class="cards"><thead><tr><th>Roll-out</th><th>State</th><th>Robots</th><th>Reason</th><th>Begun</th></tr></thead><tbody>${rollouts.map((rollout) => html`<${Row} key=${rollout.id} rollout=${rollout} />`)}</tbody></table></div><//>` : html`<${Empty}>There are no roll-outs yet.<//>`}
      <div class="line">${before !== null && html`<button onClick=${() => setBefore(null)}>Newest</button>`}${next !== null && html`<button onClick=${() => setBefore(next)}>Older roll-outs</button>`}</div>`}<//>`;
}

const Row = ({ rollout }) => html`<tr><td data-label="Roll-out"><a href=${to("rollouts", String(rollout.id))}>Roll-out ${rollout.id}</a></td>
  <td data-label="State"><span><${State} state=${rollout.state} /> ${rollout.note && html`<span class="soft small">${rollout.note}</span>`}</span></td>
  <td data-label="Robots" class="nowrap">${count(rollout.sent)} of ${count(rollout.total)}${rollout.reverted > 0 && html` <span class="soft small">${count(rollout.reverted)} taken back</span>`}</td>
  <td data-label="Reason">${rollout.reason}</td><td data-label="Begun"><span><${At} ns=${rollout.created} /> <span class="soft small">by ${rollout.by}</span></span></td></tr>`;
