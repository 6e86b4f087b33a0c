// What is the matter with a robot, the worst first: the order of the table, its badges and its filter.
import { html } from "../html.js";
import { plural } from "../format.js";
import { Ago } from "../parts.js";
import { acknowledgementOf, Seen, unseen } from "./acknowledge.js";

// [key, word, look, icon, whether it is so, what to say of it]
const CONDITIONS = [
  ["alarm", "alarm", "bad", "error", (r) => unseen(r).length > 0, (r) => alarmText(unseen(r))],
  ["stopped", "stopped", "bad", "stop", (r) => Boolean(r.stop), ({ stop }) => `emergency stop by ${stop.by}${stop.reason && `: ${stop.reason}`}`],
  ["silent", "silent", "bad", "warning", (r) => Boolean(r.silent), () => "its guard is connected and says nothing"],
  ["refused", "refused", "bad", "error", (r) => r.outcome === "refused", (r) => `its guard refused revision ${r.revision} of the settings`],
  ["away", "not connected", "bad", "off", (r) => !r.connected, (r) => r.seen ? html`last seen <${Ago} ns=${r.seen} /> ago` : "never seen"],
  ["asked", "asked", "warn", "user", (r) => r.requests > 0, (r) => `${plural(r.requests, "request")} of the bridge's clients ${r.requests === 1 ? "waits" : "wait"} for a person`],
  ["seen", "alarm seen", "warn", "check", (r) => r.alarms.length > unseen(r).length, (r) => html`<${Seen} by=${seenFirst(r)} /> · ${alarmText(r.alarms)}`],
  ["overridden", "overridden", "warn", "clock", (r) => r.overridden.length > 0, (r) => r.overridden.join(", ")],
  ["pending", "pending", "warn", "clock", (r) => r.outcome === "pending" && r.connected, (r) => `revision ${r.revision} is on its way`],
  ["dry", "dry run", "warn", "info", (r) => r.dry_run, () => "it lets everything pass"],
].map(([key, word, look, icon, is, say]) => ({ key, word, look, icon, is, say }));
const FINE = { key: "fine", word: "fine", look: "good", icon: "check", say: () => "" };

export const ALL = [...CONDITIONS, FINE];
const RANKS = new Map(ALL.map(({ key }, rank) => [key, rank]));

export function conditionsOf(robot) {
  const found = CONDITIONS.filter(({ is }) => is(robot));
  return found.length ? found : [FINE];
}

export const rankOf = (conditions) => RANKS.get(conditions[0].key);

const seenFirst = (robot) => robot.alarms.map((alarm) => acknowledgementOf(robot, alarm)).find(Boolean);

function alarmText(alarms) {
  const [{ kind, topic, reason }] = alarms, more = alarms.length - 1;
  return html`<b>${kind}</b>${topic && html` <span class="mono">${topic}</span>`} ${reason}${more > 0 && html` <span class="soft">and ${plural(more, "more alarm")}</span>`}`;
}
