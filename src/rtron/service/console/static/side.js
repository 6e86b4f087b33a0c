// The way to every view.
import { html, useEffect, useRef } from "./html.js";
import { Icon } from "./icons.js";
import { RobotFinder } from "./fleet/robot_finder.js";
import { go, here, to } from "./router.js";
import { store, useStore } from "./store.js";

const FEW = 5;
const OF_ROBOT = [["now", "Now", "robot"], ["command", "Command", "key"], ["graph", "Graph", "graph"], ["risks", "Risks", "warning"], ["nodes", "Coordination", "shield"], ["rules", "Mission rules", "rules"], ["events", "Events", "list"], ["incidents", "Incidents", "curve"], ["settings", "Settings", "settings"]];
const has = (...roles) => roles.some((role) => store.me.roles.includes(role));

export function Side({ robot }) {
  useStore("robots", "route");
  const names = [...store.robots.keys()], shown = robot ?? (names.length <= FEW ? names[0] ?? "" : "");
  return html`<nav class="side" aria-label="Views">
    <${Way} parts=${[]} icon="home">Overview<//>
    ${names.length + shown.length > 0 && html`<h3>Robot</h3>
      <${RobotFinder} id="robot" names=${names} value=${shown} hint="Find a robot" onChange=${(name) => go("robots", name, here()[2] ?? "now")} />
      ${shown && OF_ROBOT.map(([part, label, icon]) => html`<${Way} parts=${["robots", shown, part]} icon=${icon}>${label}<//>`)}`}
    <h3>Service</h3>
    <${Way} parts=${["shift"]} icon="clock">Shift<//>
    <${Way} parts=${["rollouts"]} icon="steps">Roll-outs<//>
    <${Way} parts=${["events"]} icon="list">All events<//>
    <${Way} parts=${["incidents"]} icon="curve">All incidents<//>
    ${has("admin", "developer") && html`<${Way} parts=${["audit"]} icon="rules">Audit log<//>`}
    ${has("admin") && html`<${Way} parts=${["users"]} icon="user">Users<//><${Way} parts=${["tokens"]} icon="key">Tokens<//><${Way} parts=${["webhooks"]} icon="bell">Webhooks<//><${Way} parts=${["approvals"]} icon="check">Approvals<//>`}
  </nav>`;
}

function Way({ parts, icon, children }) {
  const now = here(), depth = parts[0] === "robots" ? 3 : 1;
  const current = parts.join("/") === now.slice(0, depth).join("/") || (!parts.length && !now.length);
  const way = useRef(null);
  useEffect(() => { if (current) way.current.scrollIntoView({ block: "nearest", inline: "center" }); }, [current]);
  return html`<a ref=${way} href=${parts.length ? to(...parts) : "#/"} aria-current=${current ? "page" : undefined}><${Icon} name=${icon} />${children}</a>`;
}
