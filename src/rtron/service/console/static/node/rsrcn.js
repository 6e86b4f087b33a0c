// The form of the RSRCN: how fast the robot may go, by what it sees and by what the user wants.
import { html } from "../html.js";
import { figure } from "../format.js";
import { Badge, Card, Notice } from "../parts.js";
import { rateKey } from "../series.js";
import { Setting } from "./fields.js";
import { NAMES, policyField, Rates } from "./grcn.js";

const covers = (policy, mandatory) => policy.split("+").includes(mandatory);
const BY_LIMIT = ["Constrain", "Safe+Constrain"];

export function fieldsOf(node) {
  const [mandatory] = node.mandatory, limited = mandatory && BY_LIMIT.includes(mandatory) ? node.plan.max_vel_limit ?? undefined : undefined;
  const own = (name, label, unit, right, most) => ({ path: [name], label, kind: "number", unit, right, most, plan: node.plan[name], now: node.effective[name] });
  return {
    policy: policyField(node, (policy) => mandatory && !mandatory.split("+").every((part) => covers(policy, part))),
    threshold: own("threshold", "Threshold", "m/frame", "set_threshold"),
    limit: own("max_vel_limit", "Max_vel_limit", "m/s", "set_max_vel_limit", limited),
  };
}

const flowField = (node, topic, flow, name, kind, right) => ({ path: ["flows", flow.name, name], label: `${name} of ${flow.name}`, what: `${NAMES[name] ?? name} of ${flow.name} (${flow.publisher})`, kind, right, publisher: flow.publisher, plan: flow[name], now: node.effective.vflows.find((t) => t.topic === topic.topic)?.flows.find((f) => f.name === flow.name)?.[name] });

export function RsrcnForm({ form, plan, rates }) {
  const { node } = form, fields = fieldsOf(node), [mandatory] = node.mandatory;
  return html`<${Card} title="Policy and limits" tight foot=${form.foot}>
    <div class="body stack">${mandatory && html`<${Notice} icon="lock">${mandatory} is mandatory: it cannot be deselected${BY_LIMIT.includes(mandatory) ? ", and its limit can be lowered only" : ""}.<//>`}
      <div class="grid"><div><h3>Policy · end user</h3><${Setting} field=${fields.policy} form=${form} /></div>
      <div><h3>Max_vel_limit · end user</h3><${Setting} field=${fields.limit} form=${form} /></div>
      <div><h3>Threshold · developer</h3><${Setting} field=${fields.threshold} form=${form} /></div>
      <div><h3>Without frames</h3><p>${figure(node.plan.lowest, 3)} m/s <span class="soft small">by the plan</span></p></div></div></div>
    ${node.plan.vflows.map((topic) => html`<div class="scroll"><table class="cards settings"><thead><tr><th>vflow on <span class="mono">${topic.topic}</span></th><th>Publisher</th><th>Priority</th><th>Block bit</th><th class="number">Messages/s</th></tr></thead>
      <tbody>${topic.flows.map((flow) => html`<tr key=${flow.name}><td data-label="vflow">${flow.name}</td><td data-label="Publisher" class="mono">${flow.publisher}</td>
        <td data-label="Priority"><${Setting} field=${flowField(node, topic, flow, "priority", "whole", "set_priority")} form=${form} /></td>
        <td data-label="Block bit"><${Setting} field=${flowField(node, topic, flow, "block", "bit", "set_block")} form=${form} /></td>
        <td data-label="Messages/s" class="number"><${Rates} of=${flowRate(rates, plan, topic.topic, flow)} /></td></tr>`)}</tbody></table></div>`)}<//>`;
}

// A stream names its flows after its first coordination node: another node's flow is found by its publisher.
export function flowRate(rates, plan, topic, flow) {
  const grcn = plan?.grcn.find((each) => each.topic === topic);
  return rates.get(rateKey(topic, grcn?.flows.find((f) => f.publisher === flow.publisher)?.name ?? flow.name));
}

export function Images({ node, plan, state }) {
  const fps = state?.fps ?? {}, monitor = (iflow) => plan?.fps_monitor.find((m) => m.node === iflow.publisher);
  return html`<${Card} tight title="iflows: what the robot sees by"><div class="scroll"><table class="cards"><thead><tr><th>iflow</th><th>Image node</th><th>Topic</th><th class="number">fps</th></tr></thead><tbody>
    ${node.plan.iflows.map((iflow) => html`<tr key=${iflow.name}><td data-label="iflow">${iflow.name}</td><td data-label="Image node" class="mono">${iflow.publisher}</td><td data-label="Topic" class="mono">${iflow.topic}</td><td data-label="fps" class="number"><${Fps} value=${fps[monitor(iflow)?.id]} /></td></tr>`)}</tbody></table></div><//>`;
}

const Fps = ({ value }) => value === undefined ? html`<span class="soft">–</span>` : value > 0 ? html`<b>${figure(value, 1)}</b>` : html`<${Badge} look="bad" icon="warning">silent<//>`;
