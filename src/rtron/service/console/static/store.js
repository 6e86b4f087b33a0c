// What all views share, and who is told when it changes.
import { useEffect, useState } from "./html.js";
import { get } from "./api.js";
import { record } from "./series.js";

export const STALE_AFTER = 4000;
export const store = { me: null, started: false, link: "connecting", lostAt: null, robots: new Map(), settings: new Map(), nodes: new Map(), plans: new Map(), owners: new Map(), toasts: [], dialog: null };

const listeners = new Map();
let changed = new Set();

// A view is drawn again, at most once a frame, when one of its channels changes.
export function useStore(...channels) {
  const [, draw] = useState(0);
  useEffect(() => {
    const tell = () => draw((n) => n + 1);
    channels.forEach((channel) => listenersOf(channel).add(tell));
    return () => channels.forEach((channel) => listenersOf(channel).delete(tell));
  }, channels);
  return store;
}

export function notify(...channels) {
  if (!changed.size) setTimeout(flush, 16);
  channels.forEach((channel) => changed.add(channel));
}

export function listen(channel, then) {
  listenersOf(channel).add(then);
  return () => listenersOf(channel).delete(then);
}

function flush() {
  const told = new Set([...changed].flatMap((channel) => [...listenersOf(channel)]));
  changed = new Set();
  told.forEach((tell) => tell());
}

function listenersOf(channel) {
  if (!listeners.has(channel)) listeners.set(channel, new Set());
  return listeners.get(channel);
}

setInterval(() => notify("second"), 1000);

// Robots with a live state; `heard` is this browser's steady clock.
export const robotOf = (name) => store.robots.get(name);
export const isLive = (robot) => Boolean(robot?.connected && robot.state && store.link === "live" && performance.now() - robot.heard < STALE_AFTER);

export async function loadRobots() {
  const found = await get("/robots");
  store.robots = new Map(found.map((robot) => [robot.name, { ...robot, heard: performance.now() }]));
  found.forEach((robot) => robot.state && noteOwners(robot.name, robot.state));
  notify("robots");
}

export function takeState(name, state) {
  const robot = store.robots.get(name);
  if (!robot) return void loadRobots().catch(() => {});
  Object.assign(robot, { state, connected: true, heard: performance.now() });
  noteOwners(name, state);
  record(name, state);
  notify("robots", `state ${name}`);
}

export function takeSettings(name, view) {
  const known = store.settings.get(name);
  if (known && known.revision > view.revision) return;
  store.settings.set(name, view);
  const robot = store.robots.get(name);
  if (robot) Object.assign(robot, { revision: view.revision, outcome: view.outcome, stop: view.settings.stop });
  notify("robots", `settings ${name}`);
}

export async function loadSettings(name) {
  const view = await get(`/robots/${encodeURIComponent(name)}/settings`);
  takeSettings(name, view);
  return view;
}

export async function loadNodes(name) {
  store.nodes.set(name, await get(`/robots/${encodeURIComponent(name)}/nodes`));
  notify("robots", `nodes ${name}`);
}

export async function loadPlan(name) {
  const plan = await get(`/robots/${encodeURIComponent(name)}/plan`);
  store.plans.set(name, plan);
  return plan;
}

// Since when somebody controls a topic: seen here, or told by the newest events.
export const ownerSince = (robot, topic) => store.owners.get(`${robot} ${topic}`);

function noteOwners(name, state) {
  for (const stream of state.streams) {
    const key = `${name} ${stream.topic}`, who = `${stream.owner} ${stream.stopping}`, known = store.owners.get(key);
    if (!known) store.owners.set(key, { who, at: null, reason: "" });
    else if (known.who !== who) store.owners.set(key, { who, at: state.at, reason: "" });
  }
}

// Counts only if it tells of what is so now.
export function takeOwnerEvent(event) {
  const key = `${event.robot} ${event.topic}`, known = store.owners.get(key);
  const who = `${event.flow} ${event.kind === "stop" ? event.reason : ""}`;
  if (known && (known.who !== who || known.at > event.at)) return;
  store.owners.set(key, { who, at: event.at, reason: event.reason });
  notify("robots");
}

export async function loadOwners(name) {
  const pages = await Promise.all(["owner", "stop"].map((kind) => get("/events", { robot: name, kind, limit: 100 })));
  const newest = new Map();
  for (const event of pages.flatMap((page) => page.events)) {
    if (!(newest.get(event.topic)?.at >= event.at)) newest.set(event.topic, event);
  }
  newest.forEach(takeOwnerEvent);
}

let toastId = 0;
export function toast(level, text) {
  const made = { id: ++toastId, level, text };
  store.toasts = [...store.toasts.slice(-3), made];
  setTimeout(() => { store.toasts = store.toasts.filter((other) => other !== made); notify("toasts"); }, 7000);
  notify("toasts");
}

// Opens a dialog; what it is given is in dialog.js.
export function ask(dialog) {
  store.dialog = dialog;
  notify("dialog");
}
