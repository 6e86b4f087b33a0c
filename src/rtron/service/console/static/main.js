// The frame of the page: who is logged in, where we are, what is live.
import { html, render, useEffect, useRef } from "./html.js";
import { get } from "./api.js";
import { Dialogs } from "./dialog.js";
import { Icon, Logo } from "./icons.js";
import { Badge, Notice } from "./parts.js";
import { here, to } from "./router.js";
import { enter } from "./session.js";
import { useWatch } from "./live.js";
import { Side } from "./side.js";
import { StopButton } from "./stop.js";
import { FIRST_ROBOTS, notify, store, useStore } from "./store.js";
import { lasting } from "./format.js";
import { Login } from "./views/login.js";
import { viewOf } from "./views.js";

function App() {
  useStore("me", "route", "link");
  if (!store.started) return null;
  return store.me ? html`<${Page} />` : html`<${Login} onLogin=${enter} />`;
}

function Page() {
  const [kind, name] = here(), robot = kind === "robots" ? name : undefined;
  const { View, full, props } = viewOf(here());
  useWatch(robot ? [robot] : []);
  const page = useRef(null), begun = useRef(false);
  useEffect(() => {
    (begun.current ? document.getElementById("content") : page.current).focus({ preventScroll: true });
    begun.current = true;
  }, [location.hash.split("?")[0]]);
  return html`<div ref=${page} tabindex="-1" class=${`page ${store.link === "live" ? "" : "lost"}`}>
    <${Bar} robot=${robot} />
    ${store.link !== "live" && html`<${Lost} />`}
    <${Side} robot=${robot} />
    <main class=${`content ${full ? "full" : ""}`} id="content" tabindex="-1"><${View} key=${here().join("/")} ...${props} /></main>
    <${Dialogs} /><${Toasts} />
  </div>`;
}

const Bar = ({ robot }) => html`<header class="bar">
  <${StopButton} robot=${robot} />
  <a class="skip button" href="#content" onClick=${(e) => { e.preventDefault(); document.getElementById("content").focus(); }}>To the content</a>
  <a class="brand" href="#/" aria-label="RTron, overview"><${Logo} /><span class="wide">RTron</span></a>
  <span class="space"></span>
  <span class="wide"><${LinkBadge} /></span>
  <button class="plain" onClick=${nextTheme} title="Light, dark, or as the system" aria-label="Change the theme"><${Icon} name="moon" /></button>
  <a class="button plain" href=${to("account")} title="Account"><${Icon} name="user" /><span class="wide">${store.me.name}</span></a>
</header>`;

function LinkBadge() {
  useStore("link");
  return store.link === "live" ? html`<${Badge} look="good" icon="link">live<//>` : html`<${Badge} look="bad" icon="off">not live<//>`;
}

function Lost() {
  useStore("second");
  if (store.link === "connecting") return html`<div class="banner connecting" role="status"><${Icon} name="clock" />Connecting …</div>`;
  const since = lasting((Date.now() - store.lostAt) / 1000), next = Math.max(Math.ceil((store.retryAt - performance.now()) / 1000), 0);
  return html`<div class="banner" role="alert"><${Icon} name="off" /><span>Connection to the service lost ${since} ago. What you see is old. ${next ? `Trying again in ${next} s.` : "Trying again …"}</span></div>`;
}

function Toasts() {
  useStore("toasts");
  return html`<div class="toasts" aria-live="polite">${store.toasts.map((t) => html`<div key=${t.id}><${Notice} icon=${t.level === "info" ? "check" : t.level}>${t.text}<//></div>`)}</div>`;
}

const NEXT = { undefined: "light", light: "dark", dark: undefined };
function nextTheme() {
  const { dataset } = document.documentElement, next = NEXT[dataset.theme];
  if (next) dataset.theme = next;
  else delete dataset.theme;
  try {
    if (next) localStorage.setItem("theme", next);
    else localStorage.removeItem("theme");
  } catch {
    // Not kept, then.
  }
  notify("theme");
}

matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => notify("theme"));
// Who is not logged in any more has asked for the robots in vain: that answer is not for who logs in next.
const forgetFirstData = () => document.querySelector("link[as=fetch][href*=robots]") && get("/robots", FIRST_ROBOTS).catch(() => {});
// A login of which the second step is open shows that step.
const begin = (me) => { if (me.stage === "complete") return enter(me); store.begun = me; return forgetFirstData(); };

get("/me").then(begin, forgetFirstData).then(() => {
  store.started = true;
  render(html`<${App} />`, document.getElementById("app"));
});
