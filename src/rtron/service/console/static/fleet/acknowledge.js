// Alarms that somebody has seen: who, and what there was to say.
import { html } from "../html.js";
import { post } from "../api.js";
import { plural } from "../format.js";
import { At } from "../parts.js";
import { ask, toast } from "../store.js";

const AT_ONCE = 200, LISTED = 12;
const PARTS = ["kind", "topic", "node", "peer"];
// As the service keeps them.
const cleaned = (alarm) => Object.fromEntries(PARTS.map((part) => [part, [...alarm[part]].slice(0, 300).join("").replaceAll("\0", "\ufffd")]));
const keyOf = (alarm) => Object.values(cleaned(alarm)).join("\0");

export function acknowledgementOf(robot, alarm) {
  const key = keyOf(alarm);
  return robot.acknowledged.find((each) => keyOf(each) === key);
}
export const unseen = (robot) => robot.alarms.filter((alarm) => !acknowledgementOf(robot, alarm));

export const Seen = ({ by }) => html`<span class="small">Seen by <b>${by.by}</b>, <${At} ns=${by.at} />: ${by.note}</span>`;

// `found` is [[robot, alarm]].
export function askAcknowledge(found) {
  const one = found.length === 1;
  ask({
    title: one ? `Acknowledge an alarm of ${found[0][0].name}` : `Acknowledge ${plural(found.length, "alarm")}`, icon: "check", confirm: "Acknowledge",
    body: html`<ul class="effects">${found.slice(0, LISTED).map(([robot, alarm]) => html`<li><b>${robot.name}</b> ${alarm.kind}: ${alarm.reason}</li>`)}${found.length > LISTED && html`<li class="soft">and ${plural(found.length - LISTED, "more alarm")}</li>`}</ul>`,
    effects: ["Your name and the note stand beside the alarm until the guard tells of it again.", "It changes nothing at the robot: what the guard refuses stays refused."],
    reason: { label: "Note", least: 3 },
    act: (note) => acknowledge(found, note),
  });
}

async function acknowledge(found, note) {
  const alarms = found.map(([robot, alarm]) => ({ robot: robot.name, ...cleaned(alarm) }));
  let seen = 0, gone = 0, failed = {};
  for (let i = 0; i < alarms.length; i += AT_ONCE) {
    const result = await post("/acknowledgements", { alarms: alarms.slice(i, i + AT_ONCE), note });
    seen += result.acknowledged; gone += result.gone.length; failed = { ...failed, ...result.failed };
  }
  const others = Object.values(failed);
  const text = `${plural(seen, "alarm")} acknowledged${gone ? `, ${gone} had gone already` : ""}.`;
  toast(others.length ? "warning" : "info", [text, ...others.slice(0, LISTED)].join(" "));
}
