// What a roll-out and each of its robots is at, in words and colours.
import { html } from "../html.js";
import { Badge } from "../parts.js";

const STATES = { running: ["running", "warn", "clock"], paused: ["paused", "warn", "info"], reverting: ["going back", "bad", "error"], done: ["done", "good", "check"], reverted: ["went back", "bad", "error"], cancelled: ["ended early", "", "info"] };
export const State = ({ state }) => {
  const [word, look, icon] = STATES[state] ?? [state, "", "info"];
  return html`<${Badge} look=${look} icon=${icon}>${word}<//>`;
};

export const PROBLEMS = {
  refused: "the guard, or the service, does not take the change",
  alarm: "a new alarm, also one that is over",
  blocked: "a higher share of its messages is blocked",
  stopped: "stopped, by its guard or by a person",
  restarted: "its guard began anew",
  gone: "its guard is away, or does not answer",
};

// The standings of a robot, the worst first: [key, word, look, icon, whether it is so].
export const STANDINGS = [
  ["problem", "problem", "bad", "error", (r) => r.problems.length > 0 || r.phase === "stuck"],
  ["back", "taken back", "", "info", (r) => r.phase === "reverted"],
  ["sent", "not answered", "warn", "clock", (r) => r.phase === "sending" || (r.phase === "sent" && (r.outcome ?? "pending") === "pending")],
  ["force", "in force", "good", "check", (r) => r.phase === "sent"],
  ["waiting", "waiting", "", "clock", () => true],
].map(([key, word, look, icon, is]) => ({ key, word, look, icon, is }));

export const standingOf = (robot) => STANDINGS.find(({ is }) => is(robot));

export function countStandings(robots) {
  const counts = new Map();
  for (const { key } of robots.map(standingOf)) counts.set(key, (counts.get(key) ?? 0) + 1);
  return STANDINGS.filter(({ key }) => counts.has(key)).map((standing) => ({ ...standing, number: counts.get(standing.key) }));
}
