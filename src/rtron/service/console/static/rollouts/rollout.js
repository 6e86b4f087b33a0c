// One roll-out as it goes: its stages, what is watched, why it went back, and each robot.
import { html, useEffect } from "../html.js";
import { at, get, post } from "../api.js";
import { count, plural, said } from "../format.js";
import { VisibleRows } from "../fleet/visible_rows.js";
import { At, Badge, Card, Loaded, Notice, Outcome, useFetched } from "../parts.js";
import { to } from "../router.js";
import { ask, listen } from "../store.js";
import { PROBLEMS, standingOf, STANDINGS, State } from "./words.js";
import { nameOf, Stages } from "./stages.js";

const PAGE = 1000, HEIGHT = 34, PHONE_HEIGHT = 64, PHONE = matchMedia("(max-width: 600px)");

export function Rollout({ id }) {
  const fetched = useFetched(() => get(at("rollouts", id)), [id]), rollout = fetched.value;
  const robots = useFetched(() => getRobots(id), [id, rollout && JSON.stringify([rollout.sent, rollout.waiting, rollout.applied, rollout.reverted, rollout.stuck, rollout.problems])]);
  useRolloutNews(fetched.again);
  return html`<${Loaded} fetched=${fetched}>${(found) => html`<${Page} rollout=${found} robots=${robots.value ?? []} again=${fetched.again} />`}<//>`;
}

// Asks again when the service says that a roll-out shows something new, or was away.
export const useRolloutNews = (again) => useEffect(() => listen("rollouts", again), []);

async function getRobots(id) {
  const found = [];
  for (let after = null; ;) {
    const page = await get(at("rollouts", id, "robots"), { after, limit: PAGE });
    found.push(...page.robots);
    if (page.next === null) return found;
    after = page.next;
  }
}

function Page({ rollout, robots, again }) {
  return html`<div class="head"><h1>Roll-out ${rollout.id}</h1><${State} state=${rollout.state} /><p>${rollout.reason} · by ${rollout.by}, <${At} ns=${rollout.created} /></p><span class="space"></span><${Deeds} rollout=${rollout} again=${again} /></div>
    <${Why} rollout=${rollout} />
    <div class="columns"><div class="column"><${Card} title="Stages" tools=${html`<span class="soft small">${count(rollout.applied)} of ${plural(rollout.total, "robot")} in force</span>`}><${Stages} rollout=${rollout} robots=${robots} /><//></div>
    <div class="column"><${Watched} rollout=${rollout} /><${Change} nodes=${rollout.nodes} plan=${rollout.plan} /></div></div>
    <${Robots} robots=${robots} targets=${rollout.targets} />`;
}

// A state and what led to it: a limit that was passed, or who said what.
function Why({ rollout: { state, note, changed, stuck } }) {
  const tells = { reverting: ["bad", "error", "It goes back"], reverted: ["bad", "error", "It went back"], paused: ["warn", "info", "Paused"], cancelled: ["", "info", "Ended early; the change stays where it is"] }[state];
  return html`${tells && html`<${Notice} look=${tells[0]} icon=${tells[1]}><p><b>${tells[2]}</b> · <${At} ns=${changed} /></p>${note && html`<p>${note}</p>`}<//>`}
    ${state === "done" && note && html`<${Notice} look="warn" icon="off">${note}. They get the change when they come back.<//>`}
    ${stuck > 0 && html`<${Notice} look="bad" icon="warning">The change could not be taken back from ${plural(stuck, "robot")}: look at ${stuck === 1 ? "its" : "their"} settings.<//>`}`;
}

function Deeds({ rollout: { id, state, sent }, again }) {
  const go = (action, more) => async (reason) => { await post(at("rollouts", String(id), action), { reason, ...more }); again(); };
  const reason = { label: "Reason", least: 3 };
  const pause = () => ask({ title: `Pause roll-out ${id}`, icon: "clock", confirm: "Pause", reason, effects: ["No further robot gets the change.", "When a limit is passed, the change still goes back."], act: go("pause") });
  const resume = () => ask({ title: `Go on with roll-out ${id}`, icon: "check", confirm: "Go on", reason, effects: ["Further robots get the change: they may move or stop."], act: go("resume") });
  const back = () => ask({ title: `Take back roll-out ${id}`, icon: "warning", danger: true, confirm: "Take it back", reason, effects: [`What the change has set is as it was before, on ${plural(sent, "robot")}: they may move or stop.`, "What others have set since, overrides and emergency stops stay."], act: go("cancel", { keep: false }) });
  const keep = () => ask({ title: `End roll-out ${id} here`, icon: "info", confirm: "End it", reason, effects: [`${plural(sent, "robot")} ${sent === 1 ? "keeps" : "keep"} the change, no other gets it.`, "Nobody watches it any more: it does not go back by itself."], act: go("cancel", { keep: true }) });
  const isOpen = state === "running" || state === "paused";
  return html`<span class="line">${isOpen && html`<button onClick=${state === "running" ? pause : resume}>${state === "running" ? "Pause …" : "Go on …"}</button>`}
    ${isOpen && html`<button onClick=${keep}>End here …</button>`}${(isOpen || state === "done") && html`<button class="danger" onClick=${back}>Take back …</button>`}</span>`;
}

const Watched = ({ rollout: { problems, policy } }) => html`<${Card} title="What is watched" tight foot=${html`<span class="soft small">More robots with a problem than its limit: the change goes back by itself.</span>`}><div class="scroll"><table class="cards"><thead><tr><th>Problem</th><th class="number">Robots</th><th class="number">At most</th></tr></thead><tbody>
  ${Object.entries(PROBLEMS).map(([key, about]) => html`<tr key=${key} class=${problems[key] ? "attention" : ""}><td data-label="Problem"><span><b>${key}</b> <span class="soft small">${about}</span></span></td><td data-label="Robots" class="number">${problems[key] ? html`<${Badge} look="bad" icon="error">${count(problems[key])}<//>` : "0"}</td><td data-label="At most" class="number">${policy.limits[key]}</td></tr>`)}</tbody></table></div><//>`;

const Change = ({ nodes, plan }) => html`<${Card} title="The change" tight><table class="cards"><thead><tr><th>Coordination node</th><th>Setting</th><th>Then</th></tr></thead><tbody>${plan && html`<tr><td data-label="Node">all</td><td data-label="Setting">plan</td><td data-label="Then"><b>${plan.slice(0, 12)}</b></td></tr>`}
  ${Object.entries(nodes).flatMap(([id, patch]) => settingsOf(patch).map(([name, value]) => html`<tr key=${`${id} ${name}`}><td data-label="Node">${id}</td><td data-label="Setting">${name}</td><td data-label="Then"><b>${value === null ? "as the plan" : said(value, NANOSECONDS.has(name.split(".").at(-1)) && typeof value === "number" ? "s" : "")}</b></td></tr>`))}</tbody></table><//>`;
const NANOSECONDS = new Set(["release_after", "max_age", "max_hold", "timeout"]);

// Each setting of a patch by its name, as `rtron settings set` has it.
function settingsOf(patch, before = null) {
  return Object.entries(patch).flatMap(([key, value]) => {
    const name = before === null && ["flows", "rules"].includes(key) ? "" : `${before ?? ""}${key}`;
    return value !== null && typeof value === "object" && !Array.isArray(value) ? settingsOf(value, name && `${name}.`) : [[name, value]];
  });
}

const RANKS = new Map(STANDINGS.map(({ key }, rank) => [key, rank]));
const worstFirst = (a, b) => RANKS.get(standingOf(a).key) - RANKS.get(standingOf(b).key) || a.position - b.position;

function Robots({ robots, targets }) {
  const draw = (robot, row, tab) => {
    const { key, word, look, icon } = standingOf(robot);
    return html`<tr ...${row} class=${key === "problem" ? "attention" : ""}><td class="state nowrap"><${Badge} look=${look} icon=${icon}>${word}<//>${key === "problem" && robot.phase === "reverted" && html` <${Badge} icon="info">taken back<//>`}</td>
      <td class="name"><a href=${to("robots", robot.robot, "settings")} ...${tab}>${robot.robot}</a></td><td class="what">${[robot.problems.join(", "), robot.note].filter(Boolean).join(": ")}</td><td class="app soft">${stageOf(robot.position, targets)}</td>
      <td class="settings-of nowrap">${robot.revision !== null && html`<span class="soft small">r${robot.revision}</span> `}${robot.outcome && html`<${Outcome} outcome=${robot.outcome} />`}</td></tr>`;
  };
  return robots.length > 0 && html`<section class="card"><table class="fleet" aria-rowcount=${robots.length + 1} aria-label="Robots of the roll-out, problems first"><thead><tr aria-rowindex="1">${["State", "Robot", "What it shows", "Stage", "Settings"].map((title) => html`<th scope="col">${title}</th>`)}</tr></thead>
    <${VisibleRows} items=${[...robots].sort(worstFirst)} keyOf=${(robot) => robot.robot} height=${PHONE.matches ? PHONE_HEIGHT : HEIGHT} columns=${5} draw=${draw} /></table></section>`;
}

const stageOf = (position, targets) => nameOf(targets.findIndex((target) => position < target), targets);
