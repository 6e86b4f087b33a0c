// The views that are loaded later than the first page.
import { provide } from "./views.js";
import { Account } from "./views/account.js";
import { Approvals } from "./views/approvals.js";
import { Audit } from "./views/audit.js";
import { Command } from "./views/command.js";
import { Events } from "./views/events.js";
import { Graph } from "./views/graph.js";
import { History } from "./views/history.js";
import { Incident } from "./views/incident.js";
import { Incidents } from "./views/incidents.js";
import { Node } from "./views/node.js";
import { Nodes } from "./views/nodes.js";
import { Risks } from "./views/risks.js";
import { Rollouts } from "./views/rollouts.js";
import { Rules } from "./views/rules.js";
import { Shift } from "./views/shift.js";
import { Tokens } from "./views/tokens.js";
import { Users } from "./views/users.js";
import { Webhooks } from "./views/webhooks.js";

provide({ Account, Approvals, Audit, Command, Events, Graph, History, Incident, Incidents, Node, Nodes, Risks, Rollouts, Rules, Shift, Tokens, Users, Webhooks });
