// The form of a GRCN: its flows, each with publisher, priority, block bit and timeout.
import { html } from "../html.js";
import { rate } from "../format.js";
import { Badge, Card } from "../parts.js";
import { rateKey } from "../series.js";
import { Setting } from "./fields.js";

export const NAMES = { block: "block bit" };
const TIMED = ["FIFO_Queue", "Priority_Queue"];
const flowField = (node, flow, name, kind, right) => ({ path: ["flows", flow.name, name], label: `${name} of ${flow.name}`, what: `${NAMES[name] ?? name} of ${flow.name} (${flow.publisher})`, kind, right, publisher: flow.publisher, plan: flow[name] ?? null, now: node.effective.flows.find((f) => f.name === flow.name)?.[name] ?? null });
const nodeField = (node, name, label) => ({ path: [name], label, kind: "seconds", right: "set_durations", plan: node.plan[name], now: node.effective[name] });
export const policyField = (node, refused = () => "") => ({ path: ["policy"], label: "Policy", kind: "policy", right: "select_policy", options: node.policies.filter((p) => p === node.effective.policy || !refused(p)).map((p) => [p, p]), plan: node.plan.policy, now: node.effective.policy });

export function GrcnForm({ form, stream, rates }) {
  const { node } = form, policy = form.valueOf(policyField(node));
  return html`<${Card} title="Policy and flows" tight foot=${form.foot}>
    <div class="body grid"><div><h3>Policy</h3><${Setting} field=${policyField(node)} form=${form} /></div>
      <div><h3>Gives up control after</h3><${Setting} field=${nodeField(node, "release_after", "Silence after which a flow gives up control")} form=${form} /></div>
      <div><h3>Drops queued after</h3><${Setting} field=${nodeField(node, "max_age", "Age at which a queued message is dropped")} form=${form} /></div>
      <div><h3>Holds the topic at most</h3><${Setting} field=${nodeField(node, "max_hold", "The longest that an action may hold the topic")} form=${form} /></div></div>
    <div class="scroll"><table class="cards settings"><thead><tr><th>Flow</th><th>Publisher</th><th>Priority</th><th>Block bit</th><th>Timeout</th><th class="number">Messages/s</th></tr></thead>
      <tbody>${node.plan.flows.map((flow) => html`<tr key=${flow.name}>
        <td data-label="Flow"><span>${flow.name} ${stream?.owner === flow.name && html`<${Badge} look="good" icon="check">in control<//>`}</span></td>
        <td data-label="Publisher" class="mono">${flow.publisher}</td>
        <td data-label="Priority"><${Setting} field=${flowField(node, flow, "priority", "whole", "set_priority")} form=${form} /></td>
        <td data-label="Block bit"><${Setting} field=${flowField(node, flow, "block", "bit", "set_block")} form=${form} /></td>
        <td data-label="Timeout">${TIMED.includes(policy) || flow.timeout !== null ? html`<${Setting} field=${flowField(node, flow, "timeout", "seconds", "set_timeout")} form=${form} />` : html`<span class="soft" title="Only the queues have one">–</span>`}</td>
        <td data-label="Messages/s" class="number"><${Rates} of=${rates.get(rateKey(node.plan.topic, flow.name))} /></td></tr>`)}
        <tr><td data-label="Flow">unapproved</td><td data-label="Publisher" class="soft">anybody else</td><td data-label="" class="soft">–</td><td data-label="Block bit"><span class="mono">${node.plan.block_unapproved ? "1" : "0"}</span> <span class="soft small">by the plan</span></td><td data-label="" class="soft">–</td><td data-label="Messages/s" class="number"><${Rates} of=${rates.get(rateKey(node.plan.topic, "unapproved"))} /></td></tr>
      </tbody></table></div><//>`;
}

export const Rates = ({ of }) => of ? html`<span title="went out; dropped or held">${rate(of.out)}${of.refused > 0 && html`<span class="soft small">${rate(of.refused)} refused</span>`}</span>` : html`<span class="soft">–</span>`;
