// The draft of a change: what differs from what is in force, kept until it is sent or thrown away.
import { keyOf, same } from "./fields.js";

// Drafts outlive the view, so that looking something up elsewhere loses nothing.
const drafts = new Map();
export const forgetDrafts = () => drafts.clear();

// What is set to what is in force already is no change, unless it is for other robots, too.
export function formOf(robot, node, draw, mayDiffer = false) {
  const id = `${robot} ${node.id}`;
  if (!drafts.has(id)) drafts.set(id, new Map());
  const draft = drafts.get(id);
  const put = (field, value, drop) => {
    if (drop) draft.delete(keyOf(field.path));
    else draft.set(keyOf(field.path), { field, value });
    draw();
  };
  return {
    node, draft,
    valueOf: (field) => valueOf(draft, field),
    set: (field, value) => put(field, value, !mayDiffer && same(value, field.now)),
    back: (field) => put(field, null, !mayDiffer && same(field.now, field.plan)),
    clear: () => { draft.clear(); draw(); },
    wrong: () => [...draft.values()].some(({ value }) => Number.isNaN(value)),
  };
}

function valueOf(draft, field) {
  const entry = draft.get(keyOf(field.path));
  if (!entry) return field.now;
  return entry.value === null ? field.plan : entry.value;
}

// What the API takes: the changed values alone, each at its place.
export function patchOf(draft) {
  const patch = {};
  const deepestFirst = [...draft.values()].sort((a, b) => b.field.path.length - a.field.path.length);
  for (const { field, value } of deepestFirst) {
    let part = patch;
    for (const step of field.path.slice(0, -1)) part = own(part, step) ?? put(part, step, {});
    put(part, field.path.at(-1), value);
  }
  return patch;
}

// Names of flows and rules come from strangers: `__proto__` is a name like any other.
const own = (object, key) => Object.hasOwn(object, key) ? object[key] : undefined;
function put(object, key, value) {
  Object.defineProperty(object, key, { value, enumerable: true, configurable: true, writable: true });
  return value;
}
