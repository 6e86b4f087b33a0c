// The settings of a robot, revision by revision: who, why, when, and what the guard said to them.
import { html, useEffect } from "../html.js";
import { at, get } from "../api.js";
import { Diff } from "../dialog.js";
import { differences } from "../node/change.js";
import { At, Card, Empty, Loaded, useFetched } from "../parts.js";
import { loadSettings, store, useStore } from "../store.js";
import { Standing } from "./node.js";

export function History({ robot }) {
  useStore(`settings ${robot}`);
  const newest = store.settings.get(robot);
  useEffect(() => { loadSettings(robot).catch(() => {}); }, [robot]);
  const fetched = useFetched(() => get(`${at("robots", robot)}/settings/history`), [robot, newest?.revision, newest?.outcome]);
  return html`<div class="head"><h1>Settings of ${robot}</h1><p>What differs from the plan, newest revision first. The newest that was applied is in force.</p></div>
    <${Loaded} fetched=${fetched}>${(found) => found.length ? found.map((view, i, all) => html`<${Revision} key=${view.revision} view=${view} before=${all[i + 1]} />`) : html`<${Empty}>Nothing was changed: all is as the plan says.<//>`}<//>`;
}

const NONE = { nodes: {}, overrides: {}, stop: null };
function Revision({ view, before }) {
  const changes = before || view.revision <= 1 ? differences(before?.settings ?? NONE, view.settings) : [];
  return html`<${Card} title=${`Revision ${view.revision}`} tools=${html`<${Standing} view=${view} />`}>
    <p><b>${view.by}</b>${view.reason && `: ${view.reason}`} <span class="soft small"><${At} ns=${view.at} /></span></p>
    ${changes.length > 0 && html`<${Diff} diff=${changes} heads=${["What", "Before", "After"]} />`}<//>`;
}
