// What is live, over one WebSocket; when it ends, the page says so and tries again, slower each time.
import { get } from "./api.js";
import { loadRobots, loadSettings, notify, robotOf, store, takeOwnerEvent, takeSettings, takeState } from "./store.js";

const FIRST = 500, LONGEST = 15000, QUIET = 10000;
const eventListeners = new Set();
let socket = null, wait = FIRST, timer = 0, heard = 0;

export function onEvent(then) {
  eventListeners.add(then);
  return () => eventListeners.delete(then);
}

export function start() {
  stop();
  const scheme = location.protocol === "https:" ? "wss" : "ws";
  const own = socket = new WebSocket(`${scheme}://${location.host}/api/v1/live`);
  own.onopen = () => own === socket && opened();
  own.onmessage = (message) => own === socket && take(JSON.parse(message.data));
  own.onclose = () => own === socket && lost();
}

export function stop() {
  clearTimeout(timer);
  const old = socket;
  socket = null;
  old?.close();
}

async function opened() {
  heard = performance.now();
  try {
    await loadRobots();
    await Promise.all([...store.settings.keys()].map(loadSettings));
  } catch {
    return void socket?.close();
  }
  wait = FIRST;
  setLink("live");
}

async function lost() {
  setLink("lost");
  store.retryAt = performance.now() + wait;
  timer = setTimeout(retry, wait * (0.75 + Math.random() / 2));
  wait = Math.min(wait * 2, LONGEST);
}

// A session that has ended closes the WebSocket too: asking who we are shows the login then.
async function retry() {
  try {
    await get("/me");
    if (store.me) start();
  } catch (error) {
    if (error.status !== 401 && store.me) lost();
  }
}

function setLink(link) {
  if (store.link === link) return;
  store.link = link;
  store.lostAt = link === "lost" ? Date.now() : null;
  notify("link", "robots");
}

const TAKE = {
  state: (m) => takeState(m.robot, m.state),
  settings: (m) => takeSettings(m.robot, m.view),
  event: (m) => takeEvent(m.event),
  connection: (m) => takeConnection(m.robot, m.connected),
};

function take(message) {
  heard = performance.now();
  TAKE[message.type]?.(message);
}

function takeEvent(event) {
  if (event.kind === "owner" || event.kind === "stop") takeOwnerEvent(event);
  eventListeners.forEach((tell) => tell(event));
}

function takeConnection(name, connected) {
  const robot = robotOf(name);
  if (!robot || connected) return void loadRobots().catch(() => {});
  Object.assign(robot, { connected, seen: Date.now() * 1e6 });
  notify("robots");
}

// A connection that is dead without having ended is found by asking.
async function probe() {
  if (store.link !== "live" || performance.now() - heard < QUIET) return;
  const own = socket, late = setTimeout(() => own === socket && own.close(), QUIET / 2);
  await get("/me").then(() => { heard = performance.now(); }, () => own?.close());
  clearTimeout(late);
}
setInterval(probe, QUIET / 2);
addEventListener("offline", () => socket?.close());
addEventListener("online", () => store.link === "lost" && store.me && start());
