// The stages of a roll-out, drawn: the robots of each, and what they are at.
import { html } from "../html.js";
import { count, plural } from "../format.js";
import { Badge, Left } from "../parts.js";
import { store, useStore } from "../store.js";
import { countStandings, standingOf } from "./words.js";

const SECOND = 1e9;

export function Stages({ rollout, robots }) {
  useStore("robots");
  return html`<ol class="stages">${rollout.targets.map((target, i) => html`<${Stage} key=${i} index=${i} rollout=${rollout} robots=${robots.slice(rollout.targets[i - 1] ?? 0, target)} />`)}</ol>`;
}

function Stage({ index, rollout, robots }) {
  const isNow = index === rollout.stage && rollout.state !== "done", counts = countStandings(robots), size = rollout.targets[index] - (rollout.targets[index - 1] ?? 0);
  return html`<li aria-current=${isNow ? "step" : undefined}>
    <div class="line"><b>${nameOf(index, rollout.targets)}</b><span class="soft">${plural(size, index ? "more robot" : "robot")}, ${count(rollout.targets[index])} of ${count(rollout.total)} in all</span><span class="space"></span><${Mark} index=${index} rollout=${rollout} /></div>
    <div class="stage-bar" aria-hidden="true">${counts.map(({ key, number }) => html`<span key=${key} class=${key} style=${{ flexGrow: String(number) }}></span>`)}</div>
    <p class="line small">${counts.map(({ key, word, number }) => html`<span key=${key} class="line"><span class=${`square ${key}`}></span>${count(number)} ${word}</span>`)}</p>
    ${isNow && html`<p class="soft small" role="status"><${Next} rollout=${rollout} robots=${robots} index=${index} /></p>`}</li>`;
}

// A first stage of one robot is the canary.
export const nameOf = (index, targets) => index || targets[0] > 1 ? `Stage ${index + 1}` : "Canary";

function Mark({ index, rollout: { stage, state } }) {
  if (state === "done" || index < stage) return html`<${Badge} look="good" icon="check">passed<//>`;
  if (index > stage) return html`<span class="soft small">${state === "running" || state === "paused" ? "to come" : "not reached"}</span>`;
  if (state === "reverting" || state === "reverted") return html`<${Badge} look="bad" icon="error">went back here<//>`;
  return html`<${Badge} look="warn" icon="clock">${state === "running" ? "now" : "stands here"}<//>`;
}

// What the stage waits for before the next one begins.
function Next({ rollout, robots, index }) {
  useStore("second");
  const waiting = robots.filter((robot) => robot.phase === "waiting"), ready = waiting.filter(({ robot }) => store.robots.get(robot)?.connected);
  const unanswered = robots.filter((robot) => standingOf(robot).key === "sent").length, isLast = index === rollout.targets.length - 1;
  if (rollout.state === "paused") return "Paused: no further robot gets the change. It still goes back when a limit is passed.";
  if (rollout.state !== "running" || !robots.length) return "";
  if (ready.length) return `${plural(ready.length, "robot")} ${ready.length === 1 ? "gets" : "get"} the change next.`;
  if (waiting.length && !isLast) return `It waits for ${plural(waiting.length, "robot")} that ${waiting.length === 1 ? "is" : "are"} not connected.`;
  if (unanswered) return `It waits for the answer of ${plural(unanswered, "guard")}.`;
  return html`Watched for <${Left} until=${Math.max(...robots.map((robot) => robot.sent_at ?? 0)) + rollout.policy.wait * SECOND} /> more, then ${isLast ? "it is done" : "the next stage begins"}.`;
}
