// All robots of a fleet in one table, alarms first.
import { html, useEffect, useState } from "../html.js";
import { count, plural } from "../format.js";
import { Badge, Empty, Field, Outcome, Select } from "../parts.js";
import { to } from "../router.js";
import { store } from "../store.js";
import { ALL, conditionsOf } from "./conditions.js";
import { askAcknowledge, unseen } from "./acknowledge.js";
import { appsOf, countOf, filterOfAddress, fitting, groupsOf, keepInAddress, NO_FILTER, rowsOf, searchOf } from "./filter.js";
import { askGroup } from "./group.js";
import { VisibleRows } from "./visible_rows.js";

const HEIGHT = 34, PHONE_HEIGHT = 64, PHONE = matchMedia("(max-width: 600px)");
const COLUMNS = ["State", "Robot", "What is the matter", "App, groups", "Settings", ""];

export function FleetTable({ robots }) {
  const [filter, setFilter] = useState(filterOfAddress);
  const rows = rowsOf(robots), shown = fitting(rows, filter);
  const change = (part) => setFilter({ ...filter, ...part });
  useEffect(() => keepInAddress(filter), [filter]);
  useEffect(() => { store.shown = shown.length < rows.length ? shown.map(({ robot }) => robot.name) : null; });
  useEffect(() => () => { store.shown = null; }, []);
  return html`<${Filters} rows=${rows} shown=${shown} filter=${filter} change=${change} />
    <p class="hidden" role="status">${count(shown.length)} of ${count(rows.length)} robots shown</p>
    ${shown.length ? html`<${Table} shown=${shown} />` : html`<${Empty}>No robot fits the filter. <button class="link" onClick=${() => setFilter(NO_FILTER)}>Show all</button><//>`}`;
}

const isAdmin = () => store.me.roles.includes("admin");
const unseenOf = (robots) => robots.flatMap((robot) => unseen(robot).map((alarm) => [robot, alarm]));

function Filters({ rows, shown, filter, change }) {
  const alarms = unseenOf(shown.map(({ robot }) => robot));
  const counts = countOf(rows), robots = rows.map(({ robot }) => robot), groups = groupsOf(robots), apps = appsOf(robots);
  return html`<div role="search" aria-label="Robots"><div class="chips" role="group" aria-label="State">
      ${[{ key: "", word: "all", look: "" }, ...ALL].map(({ key, word, look, icon }) => (!key || counts.has(key) || filter.state === key) && html`<button class=${`chip-button ${look}`} aria-pressed=${filter.state === key ? "true" : "false"} onClick=${() => change({ state: key })}>${icon && html`<${Badge} look=${look} icon=${icon}>${word}<//>`}${!icon && word} <b>${count(key ? counts.get(key) ?? 0 : rows.length)}</b></button>`)}</div>
    <div class="filters">
      <${Field} label="Search in names, alarms and reasons" grow><input type="search" value=${filter.text} maxlength="200" onInput=${(e) => change({ text: e.target.value })} /><//>
      ${alarms.length > 0 && html`<button onClick=${() => askAcknowledge(alarms)}>Acknowledge ${plural(alarms.length, "alarm")} …</button>`}
      ${groups.length > 1 && html`<${Field} label="Group"><${Select} value=${filter.group} options=${groups} onChange=${(group) => change({ group })} /><//>`}
      ${apps.length > 2 && html`<${Field} label="App"><${Select} value=${filter.app} options=${apps} onChange=${(app) => change({ app })} /><//>`}
      ${isAdmin() && shown.length > 0 && html`<button onClick=${() => askGroup(shown.map(({ robot }) => robot.name))}>Make a group …</button>`}
      <a class="button" href=${`${to("rollouts", "new")}${searchOf(filter)}`}>Roll out a change …</a></div></div>`;
}

function Table({ shown }) {
  const [phone, setPhone] = useState(PHONE.matches);
  useEffect(() => {
    const turned = () => setPhone(PHONE.matches);
    PHONE.addEventListener("change", turned);
    return () => PHONE.removeEventListener("change", turned);
  }, []);
  return html`<section class="card"><table class="fleet" aria-rowcount=${shown.length + 1} aria-label="Robots, alarms first">
    <thead><tr aria-rowindex="1">${COLUMNS.map((title) => html`<th scope="col">${title}</th>`)}</tr></thead>
    <${VisibleRows} items=${shown} keyOf=${({ robot }) => robot.name} height=${phone ? PHONE_HEIGHT : HEIGHT} columns=${COLUMNS.length} draw=${drawRow} /></table></section>`;
}

// A row may be drawn after its robot has changed, and before the table is.
function drawRow({ robot }, row, tab) {
  const conditions = conditionsOf(robot), [worst] = conditions;
  return html`<tr ...${row} class=${worst.look === "bad" ? "attention" : ""}>
    <td class="state nowrap">${conditions.slice(0, 2).map(({ key, look, icon, word }) => html`<${Badge} key=${key} look=${look} icon=${icon}>${word}<//> `)}</td>
    <td class="name"><a href=${to("robots", robot.name, "now")} ...${tab}>${robot.name}</a></td>
    <td class="what">${worst.say(robot)}</td>
    <td class="app soft">${[robot.app ?? "", ...robot.labels].filter(Boolean).join(", ")}</td>
    <td class="settings-of nowrap">${robot.revision > 0 && html`<span class="soft small">r${robot.revision}</span> `}${robot.outcome && robot.revision > 0 && html`<${Outcome} outcome=${robot.outcome} />`}</td>
    <td class="deeds">${worst.key === "alarm" && html`<button class="link small" tabindex=${tab.tabindex} aria-label=${`Acknowledge the alarms of ${robot.name}`} onClick=${() => askAcknowledge(unseenOf([robot]))}>Acknowledge</button>`}</td></tr>`;
}
