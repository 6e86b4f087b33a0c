// Which view an address shows.
import { html } from "./html.js";
import { Account } from "./views/account.js";
import { Audit } from "./views/audit.js";
import { Events } from "./views/events.js";
import { Graph } from "./views/graph.js";
import { History } from "./views/history.js";
import { Node } from "./views/node.js";
import { Nodes } from "./views/nodes.js";
import { Overview, RobotNow } from "./views/overview.js";
import { Risks } from "./views/risks.js";
import { Rules } from "./views/rules.js";
import { Tokens } from "./views/tokens.js";
import { Users } from "./views/users.js";
import { Webhooks } from "./views/webhooks.js";

const SERVICE = { events: Events, audit: Audit, users: Users, tokens: Tokens, webhooks: Webhooks, account: Account };
const ROBOT = { now: RobotNow, graph: Graph, risks: Risks, nodes: Nodes, rules: Rules, events: Events, settings: History };

export function viewOf([first, name, part = "now", node]) {
  if (!first) return { View: Overview, props: {} };
  if (first !== "robots") return { View: SERVICE[first] ?? Missing, props: {} };
  const View = part === "nodes" && node ? Node : ROBOT[part] ?? Missing;
  return { View, full: View === Graph, props: { robot: name, node } };
}

const Missing = () => html`<p class="empty">There is nothing at this address.</p>`;
