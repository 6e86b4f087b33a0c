// The rules of the mission as they stand now; they are changed on the MSRCN's page.
import { html, useEffect } from "../html.js";
import { Badge, Bit, Card, Empty, Loaded, useFetched } from "../parts.js";
import { to } from "../router.js";
import { isLive, loadNodes, loadPlan, store, useStore } from "../store.js";

export function Rules({ robot }) {
  useStore(`state ${robot}`, "robots", `nodes ${robot}`);
  const fetched = useFetched(() => loadPlan(robot), [robot]), live = store.robots.get(robot);
  useEffect(() => { loadNodes(robot).catch(() => {}); }, [robot, live?.revision, live?.outcome]);
  const node = (store.nodes.get(robot) ?? []).find((n) => n.type === "MSRCN");
  return html`<div class="head"><h1>Mission rules</h1><p>What the robot must not do, and when</p><span class="space"></span>${node && html`<a class="button" href=${to("robots", robot, "nodes", node.id)}>Change them on ${node.id}</a>`}</div>
    <${Loaded} fetched=${fetched}>${(plan) => html`<${List} plan=${plan} node=${node} live=${isLive(live)} state=${live?.state} />`}<//>`;
}

// The plan's rules first, then those that people added.
function rulesOf(plan, node) {
  const planned = plan.msrcn?.rules ?? [], own = node?.settings.rules ?? {}, known = new Set(planned.map((r) => r.name));
  const changed = planned.map((rule) => ({ ...rule, when: own[rule.name]?.when ?? rule.when, block: own[rule.name]?.block ?? rule.block, selected: own[rule.name]?.selected ?? true }));
  return [...changed, ...Object.entries(own).filter(([name]) => !known.has(name)).map(([name, rule]) => ({ name, ...rule, selected: rule.selected ?? true, own: true }))];
}

function List({ plan, node, live, state }) {
  const rules = rulesOf(plan, node);
  if (!rules.length) return html`<${Empty}>The plan has no rules of the mission.<//>`;
  return rules.map((rule) => html`<${Rule} key=${rule.name} rule=${rule} plan=${plan} live=${live} now=${state?.rules.find((r) => r.name === rule.name)} bits=${state?.bits ?? {}} />`);
}

function Rule({ rule, plan, live, now, bits }) {
  const flows = (plan.msrcn?.eflows ?? []).filter((flow) => new RegExp(`\\b${flow.name.replace(/\W/g, "\\$&")}\\b`).test(rule.when));
  const actions = new Map(plan.msrcn.aflows.flatMap((t) => t.flows.map((f) => [f.name, `${f.publisher} on ${t.topic}`])));
  return html`<${Card} title=${rule.name} tools=${html`${rule.mandatory && html`<${Badge} icon="lock">mandatory<//>`}${rule.own && html`<${Badge}>own<//>`}${rule.selected ? html`<${Now} now=${now} live=${live} />` : html`<${Badge} icon="off">deselected<//>`}`}>
    <dl>${rule.reason && html`<dt>Why</dt><dd>${rule.reason}</dd>`}
      <dt>While</dt><dd><code>${rule.when}</code></dd>
      <dt>Bits now</dt><dd class=${live ? "" : "stale"}>${flows.length ? flows.map((flow) => html`<div class="line"><${Bit} value=${bits[flow.name]} /> ${flow.name} <span class="soft">${flow.topic} by ${flow.publisher}</span></div>`) : html`<span class="soft">it always holds</span>`}</dd>
      <dt>Blocked</dt><dd>${rule.block.map((name) => html`<div>${name} <span class="soft">${actions.get(name) ?? "everything on it"}</span></div>`)}</dd>
      ${rule.action && html`<dt>Only where</dt><dd><code>${rule.action}</code></dd>`}${rule.require && html`<dt>Until</dt><dd>${rule.require} has spoken</dd>`}
      ${live && now?.reason && html`<dt>Now</dt><dd>${now.reason}</dd>`}</dl><//>`;
}

function Now({ now, live }) {
  if (!live || !now) return html`<${Badge} look="warn" icon="warning">not known now<//>`;
  return now.blocks ? html`<${Badge} look="bad" icon="stop">blocks<//>` : html`<${Badge} look="good" icon="check">lets pass<//>`;
}
