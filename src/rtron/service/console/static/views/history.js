// The settings of a robot, revision by revision: who, why, when; any two compared, any of them restored.
import { html, useEffect, useState } from "../html.js";
import { at, get, post } from "../api.js";
import { Diff } from "../dialog.js";
import { Export } from "../export.js";
import { differences } from "../node/change.js";
import { At, Card, Empty, Loaded, Notice, useFetched } from "../parts.js";
import { ask, loadSettings, store, takeSettings, toast, useStore } from "../store.js";
import { Standing } from "./node.js";

const PAGE = 50, NONE = { nodes: {}, overrides: {}, stop: null };

export function History({ robot }) {
  useStore(`settings ${robot}`);
  const newest = store.settings.get(robot), [older, setOlder] = useState([]), [chosen, setChosen] = useState([]);
  useEffect(() => { loadSettings(robot).catch(() => {}); }, [robot]);
  const path = `${at("robots", robot)}/settings/history`, fetched = useFetched(() => get(path, { limit: PAGE }), [robot, newest?.revision, newest?.outcome]);
  const choose = (view) => setChosen(chosen.some((each) => each.revision === view.revision) ? chosen.filter((each) => each.revision !== view.revision) : [...chosen.slice(-1), view]);
  return html`<div class="head"><h1>Settings of ${robot}</h1><p>What differs from the plan, newest revision first. The newest that was applied is in force.</p><span class="space"></span><${Export} what="settings" query=${{ robot }} /></div>
    <${Loaded} fetched=${fetched}>${(first) => {
      const found = [...first, ...older.filter((view) => view.revision < first.at(-1).revision)], last = found.at(-1);
      if (!found.length) return html`<${Empty}>Nothing was changed: all is as the plan says.<//>`;
      return html`<${Comparison} chosen=${chosen} clear=${() => setChosen([])} />
        ${found.map((view, i) => html`<${Revision} key=${view.revision} robot=${robot} view=${view} before=${found[i + 1]} newest=${found[0]} chosen=${chosen.some((each) => each.revision === view.revision)} choose=${choose} />`)}
        ${last.revision > 0 && found.length >= PAGE && html`<p class="empty"><button onClick=${() => get(path, { limit: PAGE, before: last.revision }).then((more) => setOlder([...older, ...more]), (error) => toast("warning", error.message))}>Older revisions</button></p>`}`;
    }}<//>`;
}

function Comparison({ chosen, clear }) {
  if (chosen.length < 2) return chosen.length === 1 && html`<${Notice}>Revision ${chosen[0].revision} is chosen: choose another one to compare it with.<//>`;
  const [from, to] = [...chosen].sort((a, b) => a.revision - b.revision), changes = differences(from.settings, to.settings);
  return html`<${Card} title=${`Revision ${from.revision} and revision ${to.revision}`} tools=${html`<button onClick=${clear}>Close</button>`}>
    ${changes.length ? html`<${Diff} look="both" diff=${changes} heads=${["What", `Revision ${from.revision}`, `Revision ${to.revision}`]} />` : html`<p class="soft">They say the same.</p>`}<//>`;
}

function Revision({ robot, view, before, newest, chosen, choose }) {
  const changes = before || view.revision <= 1 ? differences(before?.settings ?? NONE, view.settings) : [];
  return html`<${Card} title=${`Revision ${view.revision}`} tools=${html`<${Standing} view=${view} />`}>
    <p><b>${view.by}</b>${view.reason && `: ${view.reason}`} <span class="soft small"><${At} ns=${view.at} /></span></p>
    ${changes.length > 0 && html`<${Diff} diff=${changes} heads=${["What", "Before", "After"]} />`}
    <p class="line revision-deeds"><button aria-pressed=${chosen ? "true" : "false"} aria-label=${`Compare revision ${view.revision}`} onClick=${() => choose(view)}>Compare</button>
      ${view.revision !== newest.revision && html`<button aria-label=${`Restore revision ${view.revision}`} onClick=${() => askRestore(robot, view, newest, "")}>Restore …</button>`}</p><//>`;
}

// What the nodes are set to comes back; overrides and the emergency stop stay as they are now.
function askRestore(robot, view, newest, told) {
  const changes = differences({ nodes: newest.settings.nodes }, { nodes: view.settings.nodes });
  ask({
    title: `Restore revision ${view.revision} of ${robot}`, icon: "settings", danger: true, confirm: changes.length ? "Put in force" : "Restore",
    body: html`<div class="stack">${told && html`<${Notice} look="warn" icon="warning">${told}<//>`}${changes.length > 0 ? html`<${Notice} look="warn" icon="warning">This can make the robot move, or stop it.<//>` : html`<p>The settings are as revision ${view.revision} says already.</p>`}</div>`,
    diff: changes, effects: [`The coordination nodes are set as in revision ${view.revision}, by a new revision.`, "Overrides and the emergency stop stay as they are now."],
    reason: { label: "Reason", least: 3 },
    act: (reason) => restore(robot, view, newest, reason),
  });
}

// True keeps the dialog open: it is the one about what is newer.
async function restore(robot, view, newest, reason) {
  try {
    const made = await post(`${at("robots", robot)}/settings/restore`, { revision: newest.revision, restored: view.revision, reason });
    takeSettings(robot, made);
    toast("info", `Revision ${made.revision} is on its way to the guard.`);
  } catch (error) {
    if (error.status !== 409) throw error;
    askRestore(robot, view, await loadSettings(robot), "The settings have changed meanwhile. This is what would differ now.");
    return true;
  }
}
