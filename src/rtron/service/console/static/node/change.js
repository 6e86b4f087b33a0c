// From a draft to settings in force: shown before and after, with what will happen, then sent.
import { html } from "../html.js";
import { at, get, patch } from "../api.js";
import { moment, said } from "../format.js";
import { Notice } from "../parts.js";
import { ask, loadSettings, store, takeSettings, toast } from "../store.js";
import { effectsOf } from "./effects.js";
import { words } from "./fields.js";
import { patchOf } from "./form.js";

// `base` is the settings the draft was made from; `conflict` is told when they are no longer the newest.
export function review({ robot, form, base, done, conflict }) {
  const entries = [...form.draft.values()];
  ask({
    title: `Change ${form.node.id} of ${robot}`, icon: "settings", confirm: "Put in force", danger: entries.some(moves),
    body: entries.some(moves) && html`<${Notice} look="warn" icon="warning">This can make the robot move, or stop it.<//>`,
    diff: entries.map(({ field, value }) => ({ what: field.what ?? field.label, before: words(field, field.now), after: words(field, value === null ? field.plan : value) })),
    effects: effectsOf(form.node, entries),
    reason: { label: "Reason", least: 3 },
    act: (reason) => send({ robot, form, base, done, conflict, reason }),
  });
}

const moves = ({ field }) => !["max_age", "max_hold"].includes(field.path.at(-1));

async function send({ robot, form, base, done, conflict, reason }) {
  const change = { revision: base.revision, nodes: { [form.node.id]: patchOf(form.draft) }, reason };
  try {
    const view = await patch(`${at("robots", robot)}/settings`, change);
    form.draft.clear();
    takeSettings(robot, view);
    toast("info", `Revision ${view.revision} is on its way to the guard.`);
    done(view);
  } catch (error) {
    if (error.status !== 409) throw error;
    conflict(await theirs(robot, base));
  }
}

// What others changed since the settings that the draft was made from.
async function theirs(robot, base) {
  const newest = await loadSettings(robot);
  return { newest, changes: differences(base.settings, newest.settings) };
}

// Two JSON values, as a list of the places where they differ.
export function differences(before, after, path = "") {
  if (isObject(before) && isObject(after)) {
    const keys = [...new Set([...Object.keys(before), ...Object.keys(after)])].filter((key) => path || key !== "revision");
    return keys.flatMap((key) => differences(before[key], after[key], path ? `${path} · ${key}` : key));
  }
  if (JSON.stringify(before ?? null) === JSON.stringify(after ?? null)) return [];
  if (isObject(before) || isObject(after)) return differences(isObject(before) ? before : {}, isObject(after) ? after : {}, path);
  return [{ what: path.replace(/^nodes · /, ""), before: told(path, before), after: told(path, after) }];
}

// What is not set in a coordination node is as the plan says.
function told(path, value) {
  const key = path.split(" · ").at(-1);
  if (value === null || value === undefined) return path.startsWith("nodes") ? "as the plan" : "none";
  return TIMES.has(key) ? moment(value) : said(value, NANOSECONDS.has(key) ? "s" : "");
}
const TIMES = new Set(["until", "at"]);
const NANOSECONDS = new Set(["release_after", "max_age", "max_hold", "timeout"]);
const isObject = (value) => value !== null && typeof value === "object" && !Array.isArray(value);

export const newestNode = (robot, id) => get(at("robots", robot, "nodes", id));
