// What one shift tells the next: notes, and which alarms somebody has seen.
import { html, useEffect, useState } from "../html.js";
import { get, post } from "../api.js";
import { plural } from "../format.js";
import { Export } from "../export.js";
import { At, Card, Empty, Field, Loaded, Problem, useFetched } from "../parts.js";
import { to } from "../router.js";
import { listen } from "../store.js";

export function Shift() {
  const notes = useFetched(() => get("/handovers"), []), seen = useFetched(() => get("/acknowledgements"), []);
  useEffect(() => {
    const stops = [listen("handovers", notes.again), listen("acknowledged", seen.again)];
    return () => stops.forEach((stop) => stop());
  }, []);
  return html`<div class="head"><h1>Shift</h1><p>What the next shift is to know</p><span class="space"></span><${Export} what="handovers" /></div>
    <div class="columns"><div class="column"><${NewNote} done=${notes.again} />
      <${Loaded} fetched=${notes}>${({ handovers }) => handovers.length ? handovers.map((note) => html`<${Note} key=${note.id} note=${note} />`) : html`<${Empty}>No note has been written yet.<//>`}<//></div>
    <div class="column"><${Card} title="Acknowledged alarms" tight tools=${html`<${Export} what="acknowledgements" />`}><${Loaded} fetched=${seen}>${({ acknowledgements }) => acknowledgements.length ? acknowledgements.map((each) => html`<${Acknowledged} seen=${each} />`) : html`<${Empty}>None yet.<//>`}<//><//></div></div>`;
}

function NewNote({ done }) {
  const [text, setText] = useState(""), [state, setState] = useState({});
  const submit = (event) => {
    event.preventDefault();
    setState({ busy: true });
    post("/handovers", { text }).then(() => { setText(""); setState({}); done(); }, (error) => setState({ error }));
  };
  return html`<${Card} title="Hand over"><form class="stack" onSubmit=${submit}>
    <${Field} label="Note for the next shift"><textarea id="handover" rows="4" maxlength="4000" value=${text} onInput=${(e) => setText(e.target.value)}></textarea><//>
    <p class="soft small">Your name, the time, and how many robots are connected, stopped, overridden and have alarms are kept with it. Nobody can change a note.</p>
    ${state.error && html`<${Problem} error=${state.error} />`}
    <div class="line"><button class="main" disabled=${state.busy || text.trim().length < 3}>Write the note</button></div></form><//>`;
}

const Note = ({ note }) => html`<${Card} title=${note.by} tools=${html`<span class="soft small"><${At} ns=${note.at} /></span>`}><p class="note-text">${note.text}</p><p class="soft small">${told(note.situation)}</p><//>`;

function told({ robots, connected, stopped, overridden, alarms, acknowledged }) {
  const parts = [`${connected} of ${plural(robots, "robot")} connected`, stopped && `${stopped} stopped`, overridden && `${overridden} overridden`, alarms && `${plural(alarms, "alarm")}, ${acknowledged} of them acknowledged`];
  return parts.filter(Boolean).join(" · ");
}

const Acknowledged = ({ seen }) => html`<div class="body"><p><a href=${to("robots", seen.robot, "now")}>${seen.robot}</a> <b>${seen.kind}</b> ${seen.topic && html`<span class="mono small">${seen.topic}</span>`} <span class="soft small">${seen.peer}</span></p>
  <p>${seen.note}</p><p class="soft small">${seen.by} · <${At} ns=${seen.at} />${seen.ended && html` · until <${At} ns=${seen.ended} />`}</p></div>`;
