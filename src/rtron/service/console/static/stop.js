// The emergency stop: one press and one to confirm, for every role, on every page.
import { html } from "./html.js";
import { at, post, remove } from "./api.js";
import { plural } from "./format.js";
import { Icon } from "./icons.js";
import { ask, store, takeSettings, toast } from "./store.js";

export const StopButton = ({ robot }) => html`<button class="stop" id="stop" onClick=${() => askStop(robot)}><${Icon} name="stop" />Emergency stop</button>`;

// The robot in view is asked about first; without one, all that can be stopped.
function askStop(robot) {
  const names = robot ? [robot] : [...store.robots.keys()];
  if (!names.length) return toast("warning", "No robot is known yet.");
  ask({
    title: names.length === 1 ? `Stop ${names[0]}` : `Stop all ${names.length} robots`, icon: "stop", danger: true, confirm: names.length === 1 ? `Stop ${names[0]} now` : "Stop them all now", focus: false,
    body: html`<div class="stack"><p class="hidden">Press Enter to stop.</p>${names.filter((name) => !store.robots.get(name)?.connected).map((name) => html`<div class="notice warn"><${Icon} name="warning" /><div>The guard of ${name} is not connected: it stops as soon as it is again.</div></div>`)}</div>`,
    effects: ["The guard stops what moves and cancels goals in progress.", "Nothing that moves the robot passes until somebody ends the stop, whatever policies say."],
    reason: { label: "Reason (may be left empty)", least: 0 },
    act: (reason) => stopAll(names, reason),
  });
}

async function stopAll(names, reason) {
  const outcomes = await Promise.allSettled(names.map(async (name) => takeSettings(name, await post(`${at("robots", name)}/stop`, { reason }))));
  const failed = names.filter((_, i) => outcomes[i].status === "rejected");
  if (failed.length) throw new Error(`not stopped: ${failed.join(", ")}: ${outcomes.find((o) => o.reason).reason.message}`);
  toast("warning", `Emergency stop sent to ${plural(names.length, "robot")}.`);
}

export function askRelease(robot, stop) {
  ask({
    title: `End the emergency stop of ${robot}`, icon: "warning", confirm: "Let it move again", danger: true,
    body: html`<p>Stopped by ${stop.by}${stop.reason && `: ${stop.reason}`}</p>`,
    effects: ["Commands pass again as the policies say.", "The robot may move at once, if a node commands it."],
    reason: { label: "Reason", least: 3 },
    act: async (reason) => takeSettings(robot, await remove(`${at("robots", robot)}/stop`, { reason })),
  });
}
