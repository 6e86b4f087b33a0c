// Letting pass for a while what a node forbids; counting down, and ended at will.
import { html, useState } from "../html.js";
import { at, post, remove } from "../api.js";
import { Badge, Card, Field, Left, Select } from "../parts.js";
import { ask, takeSettings } from "../store.js";

const TIMES = [["30", "30 s"], ["120", "2 min"], ["600", "10 min"], ["1800", "30 min"], ["3600", "1 h"]];

export function Override({ robot, node, again }) {
  const [time, setTime] = useState("120"), locked = node.rights.includes("override") ? "" : "your role may not override";
  if (!["RSRCN", "MSRCN"].includes(node.type)) return null;
  return html`<${Card} title="Override" tools=${node.override && html`<${Badge} look="warn" icon="clock">overridden<//>`}>
    ${node.override ? html`<${Standing} robot=${robot} node=${node} locked=${locked} again=${again} />` : html`<div class="line bottom">
      <${Field} label="For"><${Select} value=${time} options=${TIMES} onChange=${setTime} disabled=${Boolean(locked)} /><//>
      <button disabled=${Boolean(locked)} title=${locked || undefined} onClick=${() => askOverride(robot, node, Number(time), again)}>Override …</button></div>
      <p class="soft small">${locked || "What this node forbids passes for that time. It ends by itself."}</p>`}<//>`;
}

const Standing = ({ robot, node, locked, again }) => html`<div class="stack"><p>What this node forbids passes for another <b><${Left} until=${node.override.until} /></b></p>
  <p class="soft">${node.override.by}: ${node.override.reason}</p>
  <div><button class="main" disabled=${Boolean(locked)} onClick=${() => askEnd(robot, node, again)}>End it now</button></div></div>`;

const path = (robot, node) => `${at("robots", robot, "nodes", node.id)}/override`;

function askOverride(robot, node, duration, again) {
  ask({
    title: `Override ${node.id} of ${robot}`, icon: "warning", danger: true, confirm: `Override for ${TIMES.find(([s]) => Number(s) === duration)[1]}`,
    effects: [node.type === "RSRCN" ? "The robot may go faster than it sees, or than the limit allows." : "What the rules of the mission block passes.", "The other coordination nodes and the emergency stop hold as before.", "It is in the audit log, with your name and reason."],
    reason: { label: "Reason", least: 3 },
    act: async (reason) => { takeSettings(robot, await post(path(robot, node), { duration, reason })); again(); },
  });
}

function askEnd(robot, node, again) {
  ask({
    title: `End the override of ${node.id}`, icon: "shield", confirm: "End it now",
    effects: ["What the node forbids is blocked again at once; if that moves the robot now, it is stopped."],
    reason: { label: "Reason", least: 3 },
    act: async (reason) => { takeSettings(robot, await remove(path(robot, node), { reason })); again(); },
  });
}
