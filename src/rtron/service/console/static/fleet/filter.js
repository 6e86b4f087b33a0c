// Which robots the table shows, in which order; the address keeps the filter.
import { count } from "../format.js";
import { query } from "../router.js";
import { conditionsOf, rankOf } from "./conditions.js";

const NAMES = ["text", "state", "group", "app"];
export const NO_FILTER = Object.fromEntries(NAMES.map((name) => [name, ""]));

export const filterOfAddress = () => Object.fromEntries(NAMES.map((name) => [name, query().get(name) ?? ""]));

export function searchOf(filter) {
  const given = new URLSearchParams(Object.entries(filter).filter(([, value]) => value));
  return given.size ? `?${given}` : "";
}
export const keepInAddress = (filter) => history.replaceState(null, "", `#/${searchOf(filter)}`);

// Rows: each robot with its conditions, the worst first, then by name.
export function rowsOf(robots) {
  return [...robots].map((robot) => ({ robot, conditions: conditionsOf(robot) })).sort(worstFirst);
}

const worstFirst = (a, b) => rankOf(a.conditions) - rankOf(b.conditions) || compare(a.robot.name, b.robot.name);
const { compare } = new Intl.Collator("en", { numeric: true });

export function fitting(rows, { text, state, group, app }) {
  const words = text.toLowerCase().split(/\s+/).filter(Boolean);
  return rows.filter(({ robot, conditions }) => (!app || robot.app === app) && (!group || robot.labels.includes(group)) && (!state || conditions.some(({ key }) => key === state)) && (!words.length || has(robot, words)));
}

function has(robot, words) {
  const texts = [robot.name, robot.app, ...robot.labels, robot.stop?.by, robot.stop?.reason, ...robot.overridden, ...robot.alarms.flatMap((alarm) => Object.values(alarm))];
  const all = texts.filter(Boolean).join("\n").toLowerCase();
  return words.every((word) => all.includes(word));
}

export function countOf(rows) {
  const counts = new Map();
  for (const { key } of rows.flatMap(({ conditions }) => conditions)) counts.set(key, (counts.get(key) ?? 0) + 1);
  return counts;
}

// What there is to choose from: [value, label], and nothing where there is no choice.
export function choicesOf(robots, valuesOf) {
  const sizes = new Map();
  for (const value of robots.flatMap(valuesOf)) sizes.set(value, (sizes.get(value) ?? 0) + 1);
  return [["", "all"], ...[...sizes].sort((a, b) => compare(a[0], b[0])).map(([value, size]) => [value, `${value} (${count(size)})`])];
}
export const groupsOf = (robots) => choicesOf(robots, (robot) => robot.labels);
export const appsOf = (robots) => choicesOf(robots, (robot) => robot.app ? [robot.app] : []);
