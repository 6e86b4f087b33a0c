// What clients of a robot's bridge ask persons for: each request word for word, approved or refused once.
import { html } from "../html.js";
import { at, get, post } from "../api.js";
import { countdown, plural } from "../format.js";
import { Badge, Card, Notice, useFetched } from "../parts.js";
import { ask, isLive, toast } from "../store.js";

export function Requests({ robot }) {
  const requests = robot?.state?.requests, may = useMayAnswer(robot, requests);
  if (!requests) return null;
  const live = isLive(robot), more = requests.count - requests.shown.length;
  return html`<${Card} title="Requests" tools=${html`<${Count} count=${requests.count} live=${live} />`}>
    <div class=${`stack ${live ? "" : "stale"}`}>${requests.shown.map((request) => html`<${Request} key=${request.digest} robot=${robot} request=${request} may=${may && live} />`)}
    ${!requests.count && html`<p class="soft">No client of the bridge asks for anything.</p>`}
    ${more > 0 && html`<p class="soft">${plural(more, "more request")}, shown when these are answered.</p>`}
    ${requests.count > 0 && may === false && html`<${Notice}>You may not answer them here: <code>approvers</code> in the bridge's rights says who may.<//>`}</div><//>`;
}

function useMayAnswer(robot, requests) {
  const approvers = JSON.stringify([requests?.roles, requests?.names]);
  return useFetched(async () => robot && requests ? get(`${at("robots", robot.name)}/requests`) : {}, [robot?.name, approvers]).value?.permitted;
}

function Count({ count, live }) {
  if (!live) return html`<${Badge} look="warn" icon="warning">not known now<//>`;
  return count ? html`<${Badge} look="warn" icon="user">${plural(count, "request")} ${count === 1 ? "waits" : "wait"}<//>` : html`<${Badge} icon="check">none waits<//>`;
}

// The times are of the robot's clock: what has passed since is by the browser's steady one.
const left = (robot, request) => (request.until - robot.state.at) / 1e9 - (performance.now() - robot.heard) / 1000;

const Request = ({ robot, request, may }) => html`<section class="request" aria-label=${`Request ${request.number} of ${request.client}`}>
    <div class="line"><b class="mono">${request.client}</b> <span>${request.what}</span> <span class="soft small">request ${request.number}, ends in <span class="number">${countdown(left(robot, request))}</span></span></div>
    <${Content} request=${request} />
    <div class="line"><button disabled=${!may} onClick=${() => askAnswer(robot, request, "approve")}>Approve request ${request.number} …</button><button disabled=${!may} onClick=${() => askAnswer(robot, request, "refuse")}>Refuse request ${request.number} …</button></div></section>`;

const Content = ({ request }) => html`<code class="note-text">${request.content}</code>`;

const ANSWERS = {
  approve: { title: "Approve", effects: (client) => [`${client} may send exactly this once, within a minute.`, "No rule is lifted: the guard judges it all the same."], danger: true },
  refuse: { title: "Refuse", effects: (client) => [`${client} is told that you have refused it.`] },
};

// What is answered is the request as it is shown here: if it is another one meanwhile, the bridge refuses.
function askAnswer(robot, request, what) {
  const { title, effects, danger } = ANSWERS[what];
  ask({
    title: `${title} request ${request.number} of ${request.client} at ${robot.name}`, icon: "user", danger, confirm: title,
    body: html`<div class="stack"><p>${request.what}</p><${Content} request=${request} /></div>`,
    effects: effects(request.client),
    reason: { label: "Reason", least: 3 },
    act: async (reason) => {
      const answer = await post(at("robots", robot.name, "requests", request.digest), { do: what, reason });
      toast("info", answer.reason);
    },
  });
}
