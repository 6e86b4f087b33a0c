// Which view an address shows; those of `later.js` are loaded when the first of them is shown.
import { html } from "./html.js";
import { Loaded, useFetched } from "./parts.js";
import { loadScript } from "./scripts.js";
import { Overview, RobotNow } from "./views/overview.js";

const SERVICE = { events: "Events", incidents: "Incidents", shift: "Shift", rollouts: "Rollouts", audit: "Audit", users: "Users", tokens: "Tokens", webhooks: "Webhooks", approvals: "Approvals", account: "Account" };
const ROBOT = { command: "Command", graph: "Graph", risks: "Risks", nodes: "Nodes", rules: "Rules", events: "Events", incidents: "Incidents", settings: "History" };
const ONE = { nodes: "Node", incidents: "Incident" };
const provided = new Map();

export const provide = (views) => Object.entries(views).forEach(([name, View]) => provided.set(name, View));
export const loadLater = () => loadScript("later.js");

export function viewOf([first, name, part = "now", node]) {
  if (!first) return { View: Overview, props: {} };
  if (first !== "robots") return { View: Later, props: { view: SERVICE[first], item: name } };
  const props = { robot: name, node };
  if (part === "now") return { View: RobotNow, props };
  return { View: Later, full: part === "graph", props: { ...props, view: (node && ONE[part]) || ROBOT[part] } };
}

function Later({ view, ...props }) {
  const fetched = useFetched(loadLater, []), View = provided.get(view);
  if (!view) return html`<p class="empty">There is nothing at this address.</p>`;
  return View ? html`<${View} ...${props} />` : html`<${Loaded} fetched=${fetched}>${() => ""}<//>`;
}
