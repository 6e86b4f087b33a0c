// What a change will do, in words, for the dialog before it is sent.
import { figure, seconds } from "../format.js";

const POLICIES = {
  Block: "Flows whose block bit is 1 are dropped, all others pass.",
  Preemption: "Of the flows that speak, the one of highest priority controls; the others are dropped.",
  FIFO_Queue: "One action at a time, in the order in which they come; each may take its timeout.",
  Priority_Queue: "A message waits while a higher flow has spoken within its timeout; the highest priority goes first.",
  Lease: "Only who holds the lease controls, after a command that moves nothing; the others are dropped.",
  Safe: "The robot goes at most threshold × frame rate; without frames it goes at the lowest limit.",
  Constrain: "The robot goes at most max_vel_limit.",
  "Safe+Constrain": "The robot goes at most threshold × frame rate, and never above max_vel_limit.",
};

export function effectsOf(node, entries) {
  const told = entries.map(({ field, value }) => effectOf(node, field, value === null ? field.plan : value)).filter(Boolean);
  const mode = node.mode === "enforce" ? [] : ["This coordination node only observes: what it would do is told, and everything passes."];
  return [...new Set(told), ...mode, ...(node.type === "GRCN" ? ["Messages and goals that wait in a queue may be dropped when the policy changes."] : [])];
}

const EFFECTS = {
  policy: (value) => POLICIES[value],
  block: (value, field) => Array.isArray(value) ? `While the rule holds, ${value.join(", ")} ${value.length > 1 ? "are" : "is"} blocked.` : value ? `What ${field.publisher} says is dropped. If it moves the robot now, the robot is stopped.` : `What ${field.publisher} says passes again: the robot may move by it.`,
  priority: (value, field) => `${field.publisher} has priority ${value}: who controls the topic may change at once.`,
  timeout: (value) => value === null || value === undefined ? "" : `Others wait at most ${seconds(value)} s for it.`,
  release_after: (value) => `A flow gives up control after ${seconds(value)} s of silence.`,
  max_age: (value) => `Queued messages older than ${seconds(value)} s are dropped.`,
  max_hold: (value) => `An action holds the topic for ${seconds(value)} s at most.`,
  threshold: (value) => `At 10 frames a second the robot goes at most ${figure(value * 10, 3)} m/s.`,
  max_vel_limit: (value) => value === null || value === undefined ? "" : `The robot goes at most ${value} m/s; a faster command is scaled as a whole.`,
  selected: (value, field) => value ? `The rule ${field.rule} counts again: if it holds now, what it blocks is stopped.` : `The rule ${field.rule} does not count any more: what it blocked may pass.`,
  when: (value) => `The rule holds while ${value}.`,
};

function effectOf(node, field, value) {
  if (field.kind === "rule") return value ? `A rule of your own: while ${value.when}, ${value.block.join(", ")} is blocked.` : `Your rule ${field.rule} is deleted: what it blocked may pass.`;
  return EFFECTS[field.path.at(-1)]?.(value, field);
}
