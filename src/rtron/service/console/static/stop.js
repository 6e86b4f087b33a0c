// The emergency stop: one press and one to confirm, for every role, on every page.
import { html, useEffect, useState } from "./html.js";
import { at, post, remove } from "./api.js";
import { count, plural } from "./format.js";
import { Icon } from "./icons.js";
import { Notice } from "./parts.js";
import { ask, loadSettings, store, takeSettings, toast } from "./store.js";

const KEY = "F8", AT_ONCE = 1000, FEW = 20;

export function StopButton({ robot }) {
  useEffect(() => {
    const pressed = (event) => {
      if (event.key !== KEY || event.repeat || document.querySelector("dialog[open]")) return;
      event.preventDefault();
      askStop(robot);
    };
    addEventListener("keydown", pressed);
    return () => removeEventListener("keydown", pressed);
  }, [robot]);
  return html`<button class="stop" id="stop" aria-keyshortcuts=${KEY} title=${`Emergency stop (${KEY})`} onClick=${() => askStop(robot)}><${Icon} name="stop" />Emergency stop</button>`;
}

// The robot in view is asked about; without one, all that are known, of which some can be left out.
function askStop(robot) {
  const names = robot ? [robot] : [...store.robots.keys()], chosen = new Set(names), one = names.length === 1;
  if (!names.length) return toast("warning", "No robot is known yet.");
  const progress = { draw: () => {} };
  ask({
    title: one ? `Stop ${names[0]}` : isChoice(names) ? "Stop robots" : `Stop ${plural(names.length, "robot")}`, icon: "stop", danger: true, confirm: one ? `Stop ${names[0]} now` : "Stop them now",
    body: html`<${Which} names=${names} chosen=${chosen} progress=${progress} />`,
    effects: ["The guard stops what moves and cancels goals in progress.", "Nothing that moves the robot passes until somebody ends the stop, whatever policies say."],
    reason: { label: "Reason (may be left empty)", least: 0 },
    act: (reason) => stopAll([...chosen], reason, progress),
  });
}

const isChoice = (names) => names.length > FEW && Boolean(store.shown);
const listed = (names) => names.length > FEW ? `${names.slice(0, FEW).join(", ")} and ${plural(names.length - FEW, "more robot")}` : names.join(", ");

function Which({ names, chosen, progress }) {
  const [, draw] = useState(0), [done, setDone] = useState(0);
  progress.draw = setDone;
  const toggle = (name) => { if (!chosen.delete(name)) chosen.add(name); draw((n) => n + 1); };
  const choose = (wanted) => { chosen.clear(); wanted.forEach((name) => chosen.add(name)); draw((n) => n + 1); };
  const away = [...chosen].filter((name) => !store.robots.get(name)?.connected);
  return html`<div class="stack">
    ${names.length > 1 && names.length <= FEW && html`<div class="checks">${names.map((name) => html`<label><input type="checkbox" checked=${chosen.has(name)} onChange=${() => toggle(name)} />${name}</label>`)}</div>`}
    ${isChoice(names) && html`<${Scope} names=${names} shown=${store.shown} chosen=${chosen} choose=${choose} />`}
    ${away.length > 0 && html`<${Notice} look="warn" icon="warning">Not connected: ${listed(away)}. A guard that is not connected stops its robot as soon as it is again; use the robot's own stop.<//>`}
    ${done > 0 && html`<p role="status">${count(done)} of ${plural(chosen.size, "robot")} stopped …</p>`}</div>`;
}

const Scope = ({ names, shown, chosen, choose }) => html`<fieldset class="plain stack"><legend class="hidden">Which robots</legend>
  ${[["all", names, `all ${plural(names.length, "robot")}`], ["shown", shown, `the ${plural(shown.length, "robot")} that the filter shows`]].map(([key, wanted, label]) => html`<label class="check"><input type="radio" name="scope" value=${key} checked=${chosen.size === wanted.length} onChange=${() => choose(wanted)} />${label}</label>`)}</fieldset>`;

// As many at a time as the service takes.
async function stopAll(names, reason, progress) {
  const sent = [], waiting = [], failed = [];
  for (let i = 0; i < names.length; i += AT_ONCE) {
    const robots = names.slice(i, i + AT_ONCE);
    const answer = await post("/robots/stop", { robots, reason }).catch((error) => ({ sent: [], waiting: [], failed: Object.fromEntries(robots.map((name) => [name, error.message])) }));
    sent.push(...answer.sent);
    waiting.push(...answer.waiting);
    failed.push(...Object.entries(answer.failed));
    progress.draw(i + robots.length);
  }
  if (sent.length) toast("warning", `Emergency stop sent to ${plural(sent.length, "robot")}.`);
  if (waiting.length) toast("warning", `Not connected, so the stop waits: ${listed(waiting)}. Use the robot's own stop.`);
  if (failed.length) throw new Error(`not stopped: ${listed(failed.map(([name]) => name))}: ${failed[0][1]}`);
}

// What is ended is the stop that is shown here; somebody else's that came meanwhile is shown first.
export const askRelease = (robot) => showRelease(robot, "");

function showRelease(robot, told) {
  const { revision, stop } = store.robots.get(robot);
  if (!stop) return toast("info", `${robot} is not stopped any more.`);
  ask({
    title: `End the emergency stop of ${robot}`, icon: "warning", confirm: "Let it move again", danger: true,
    body: html`<div class="stack">${told && html`<${Notice} look="warn" icon="warning">${told}<//>`}<p>Stopped by ${stop.by}${stop.reason && `: ${stop.reason}`}</p></div>`,
    effects: ["Commands pass again as the policies say.", "The robot may move at once, if a node commands it."],
    reason: { label: "Reason", least: 3 },
    act: (reason) => release(robot, revision, reason),
  });
}

// True keeps the dialog open: it is the one about the newer stop.
async function release(robot, revision, reason) {
  try {
    takeSettings(robot, await remove(`${at("robots", robot)}/stop`, { revision, reason }));
  } catch (error) {
    if (error.status !== 409) throw error;
    const { settings } = await loadSettings(robot);
    showRelease(robot, "The settings have changed meanwhile. This is the stop as it is now.");
    return Boolean(settings.stop);
  }
}
