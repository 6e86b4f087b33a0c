// Who is logged in on this page, from the login to its end.
import { onSessionEnd, post, useCsrf } from "./api.js";
import { start, stop } from "./live.js";
import { forgetDrafts } from "./node/form.js";
import { forgetAll } from "./series.js";
import { ask, loadRobots, notify, store } from "./store.js";

export function enter(me) {
  store.me = me;
  store.link = "connecting";
  useCsrf(me.csrf);
  start();
  loadRobots().catch(() => {});
  notify("me");
}

export async function logout() {
  await post("/logout").catch(() => {});
  leave();
}

function leave() {
  stop();
  ask(null);
  forgetAll();
  forgetDrafts();
  Object.assign(store, { me: null, robots: new Map(), settings: new Map(), nodes: new Map(), plans: new Map(), owners: new Map() });
  notify("me");
}

onSessionEnd(() => store.me && leave());
