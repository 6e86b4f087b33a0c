// The emergency stop: one press and one to confirm, for every role, on every page.
import { html, useState } from "./html.js";
import { at, post, remove } from "./api.js";
import { plural } from "./format.js";
import { Icon } from "./icons.js";
import { Notice } from "./parts.js";
import { ask, loadSettings, store, takeSettings, toast } from "./store.js";

export const StopButton = ({ robot }) => html`<button class="stop" id="stop" onClick=${() => askStop(robot)}><${Icon} name="stop" />Emergency stop</button>`;

// The robot in view is asked about; without one, all that are known, each of which can be left out.
function askStop(robot) {
  const names = robot ? [robot] : [...store.robots.keys()], chosen = new Set(names), one = names.length === 1;
  if (!names.length) return toast("warning", "No robot is known yet.");
  ask({
    title: one ? `Stop ${names[0]}` : `Stop ${names.length} robots`, icon: "stop", danger: true, confirm: one ? `Stop ${names[0]} now` : "Stop them now",
    body: html`<${Which} names=${names} chosen=${chosen} />`,
    effects: ["The guard stops what moves and cancels goals in progress.", "Nothing that moves the robot passes until somebody ends the stop, whatever policies say."],
    reason: { label: "Reason (may be left empty)", least: 0 },
    act: (reason) => stopAll([...chosen], reason),
  });
}

function Which({ names, chosen }) {
  const [, draw] = useState(0);
  const toggle = (name) => { if (!chosen.delete(name)) chosen.add(name); draw((n) => n + 1); };
  const away = names.filter((name) => !store.robots.get(name)?.connected);
  return html`<div class="stack">${names.length > 1 && html`<div class="checks">${names.map((name) => html`<label><input type="checkbox" checked=${chosen.has(name)} onChange=${() => toggle(name)} />${name}</label>`)}</div>`}
    ${away.length > 0 && html`<${Notice} look="warn" icon="warning">Not connected: ${away.join(", ")}. A guard that is not connected stops its robot as soon as it is again; use the robot's own stop.<//>`}</div>`;
}

async function stopAll(names, reason) {
  const outcomes = await Promise.allSettled(names.map(async (name) => takeSettings(name, await post(`${at("robots", name)}/stop`, { reason }))));
  const failed = names.filter((_, i) => outcomes[i].status === "rejected");
  if (failed.length) throw new Error(`not stopped: ${failed.join(", ")}: ${outcomes.find((o) => o.reason).reason.message}`);
  toast("warning", `Emergency stop sent to ${plural(names.length, "robot")}.`);
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
