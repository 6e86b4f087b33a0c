// What is live, over one WebSocket; when it ends, the page says so and tries again, slower each time.
import { get } from "./api.js";
import { useEffect } from "./html.js";
import { forgetRobot, loadRobots, loadSettings, notify, store, takeChanges, takeOwnerEvent, takeSettings, takeState, takeStateDelta, toast } from "./store.js";

const FIRST = 500, LONGEST = 15000, QUIET = 10000;
const eventListeners = new Set(), interests = new Set();
let socket = null, wait = FIRST, timer = 0, heard = 0, watched = { robots: [], events: false };

export function onEvent(then) {
  eventListeners.add(then);
  return () => eventListeners.delete(then);
}

// A view hears everything of some robots while it is shown, or the events of all.
export function useWatch(robots, events = false) {
  useEffect(() => {
    const own = { robots, events };
    interests.add(own);
    setTimeout(watch);
    return () => { interests.delete(own); setTimeout(watch); };
  }, [robots.join(" "), events]);
}

function watch() {
  const all = [...interests], robots = [...new Set(all.flatMap((each) => each.robots))].sort(), events = all.some((each) => each.events);
  if (robots.join(" ") === watched.robots.join(" ") && events === watched.events) return;
  watched.robots.filter((name) => !robots.includes(name)).forEach(forgetRobot);
  watched = { robots, events };
  if (socket?.readyState === WebSocket.OPEN) socket.send(JSON.stringify(watched));
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
  socket.send(JSON.stringify(watched));
  try {
    await loadRobots();
    await Promise.all([...store.settings.keys()].map(loadSettings));
  } catch {
    return void socket?.close();
  }
  wait = FIRST;
  setLink("live");
  notify("rollouts");
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
  robots: (m) => takeChanges(m.robots),
  state: (m) => takeState(m.robot, m.state),
  state_delta: (m) => takeStateDelta(m.robot, m) || askAgain(),
  settings: (m) => takeSettings(m.robot, m.view),
  event: (m) => takeEvent(m.event),
  handover: () => notify("handovers"),
  incident: () => notify("incidents"),
  rollout: (m) => { notify("rollouts"); if (m.alert) toast("error", m.alert); },
};

function take(message) {
  heard = performance.now();
  TAKE[message.type]?.(message);
}

// A difference from a state that is not known here: the whole state comes to who begins to watch.
function askAgain() {
  socket.send(JSON.stringify({ robots: [], events: watched.events }));
  socket.send(JSON.stringify(watched));
}

function takeEvent(event) {
  if (event.kind === "owner" || event.kind === "stop") takeOwnerEvent(event);
  eventListeners.forEach((tell) => tell(event));
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
