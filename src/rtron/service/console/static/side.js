// The way to every view.
import { html, useEffect, useRef } from "./html.js";
import { Icon } from "./icons.js";
import { Select } from "./parts.js";
import { go, here, to } from "./router.js";
import { store, useStore } from "./store.js";

const OF_ROBOT = [["now", "Now", "robot"], ["graph", "Graph", "graph"], ["risks", "Risks", "warning"], ["nodes", "Coordination", "shield"], ["rules", "Mission rules", "rules"], ["events", "Events", "list"], ["settings", "Settings", "settings"]];
const has = (...roles) => roles.some((role) => store.me.roles.includes(role));

export function Side({ robot }) {
  useStore("robots", "route");
  const names = [...store.robots.keys()], shown = robot ?? names[0];
  return html`<nav class="side" aria-label="Views">
    <${Way} parts=${[]} icon="home">Overview<//>
    ${shown && html`<h3>Robot</h3>
      <${Select} aria-label="Robot" value=${shown} options=${names.includes(shown) ? names.map((n) => [n, n]) : [shown, ...names].map((n) => [n, n])} onChange=${(name) => go("robots", name, here()[2] ?? "now")} />
      ${OF_ROBOT.map(([part, label, icon]) => html`<${Way} parts=${["robots", shown, part]} icon=${icon}>${label}<//>`)}`}
    <h3>Service</h3>
    <${Way} parts=${["events"]} icon="list">All events<//>
    ${has("admin", "developer") && html`<${Way} parts=${["audit"]} icon="clock">Audit log<//>`}
    ${has("admin") && html`<${Way} parts=${["users"]} icon="user">Users<//><${Way} parts=${["tokens"]} icon="key">Tokens<//><${Way} parts=${["webhooks"]} icon="bell">Webhooks<//>`}
  </nav>`;
}

function Way({ parts, icon, children }) {
  const now = here(), depth = parts[0] === "robots" ? 3 : 1;
  const current = parts.join("/") === now.slice(0, depth).join("/") || (!parts.length && !now.length);
  const way = useRef(null);
  useEffect(() => { if (current) way.current.scrollIntoView({ block: "nearest", inline: "center" }); }, [current]);
  return html`<a ref=${way} href=${parts.length ? to(...parts) : "#/"} aria-current=${current ? "page" : undefined}><${Icon} name=${icon} />${children}</a>`;
}
