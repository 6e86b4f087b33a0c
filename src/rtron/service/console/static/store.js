// What all views share, and who is told when it changes.
import { useEffect, useState } from "./html.js";
import { get, getAll } from "./api.js";
import { forget, record } from "./series.js";

export const STALE_AFTER = 4000;
const REFRESH = 1500;
// The page asks for these before the scripts run, in these very words.
export const FIRST_ROBOTS = { states: false, limit: 1000 };
export const store = { me: null, started: false, link: "connecting", lostAt: null, robots: new Map(), settings: new Map(), nodes: new Map(), plans: new Map(), owners: new Map(), shown: null, toasts: [], dialog: null };

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

// All robots in short; those that are watched have a `state`, and when it was `heard` by this browser's steady clock.
export const isLive = (robot) => Boolean(robot?.connected && robot.state && !robot.silent && store.link === "live" && performance.now() - robot.heard < STALE_AFTER);

const live = new Map();
let arriving = null, refresh = 0;

// What comes while all robots are asked for may be newer than the answer.
export async function loadRobots() {
  const changes = arriving = [], found = await getAll("/robots", FIRST_ROBOTS);
  store.robots = new Map(found.map((robot) => [robot.name, { ...robot, silent: store.robots.get(robot.name)?.silent, ...live.get(robot.name) }]));
  changes.forEach(change);
  if (arriving === changes) arriving = null;
  notify("robots");
}

export function takeChanges(robots) {
  arriving?.push(robots);
  change(robots);
  notify("robots");
}

function change(robots) {
  for (const [name, what] of Object.entries(robots)) {
    const robot = store.robots.get(name);
    if (what.connected === false) live.delete(name);
    if (what.acknowledged) notify("acknowledged", `state ${name}`);
    if (!robot || what.connected) refreshSoon();
    if (robot) Object.assign(robot, what, what.connected === false && { state: undefined, seen: Date.now() * 1e6 });
  }
}

// A robot that connects may be new, or run another app: what the service knows of all comes soon, once for many.
function refreshSoon() {
  refresh ||= setTimeout(() => { refresh = 0; loadRobots().catch(() => {}); }, REFRESH);
}

export function takeState(name, state) {
  live.set(name, { state, heard: performance.now() });
  Object.assign(store.robots.get(name) ?? {}, live.get(name));
  noteOwners(name, state);
  record(name, state);
  notify("robots", `state ${name}`);
}

// A state as what differs from the one before.
export function takeStateDelta(name, { state, unchanged }) {
  const before = live.get(name)?.state;
  if (!before) return false;
  const streams = new Map(state.streams.map((stream) => [stream.topic, stream]));
  const kept = Object.fromEntries(unchanged.map((key) => [key, before[key]]));
  takeState(name, { ...state, ...kept, streams: before.streams.map((stream) => streams.get(stream.topic) ?? stream) });
  return true;
}

// What is known of a robot that nobody watches any more gets old.
export function forgetRobot(name) {
  const robot = store.robots.get(name);
  live.delete(name);
  if (robot) delete robot.state;
  for (const known of [store.settings, store.nodes, store.plans]) known.delete(name);
  for (const key of [...store.owners.keys()]) if (key.startsWith(`${name} `)) store.owners.delete(key);
  forget(name);
}

export function takeSettings(name, view) {
  if (isOlder(view, store.settings.get(name))) return;
  store.settings.set(name, view);
  const robot = store.robots.get(name);
  if (robot) Object.assign(robot, { revision: view.revision, outcome: view.outcome, stop: view.settings.stop });
  notify("robots", `settings ${name}`);
}

// The guard may have answered before the request that made the revision has its own answer.
const isOlder = (view, known) => known !== undefined
  && (view.revision < known.revision || (view.revision === known.revision && view.outcome === "pending" && known.outcome !== "pending"));

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
