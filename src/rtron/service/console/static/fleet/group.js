// A group of robots, made of those that the filter of the table shows.
import { html, useState } from "../html.js";
import { at, put } from "../api.js";
import { plural } from "../format.js";
import { Field, Notice } from "../parts.js";
import { ask, loadRobots, store, toast } from "../store.js";

export function askGroup(names) {
  const made = { name: "" };
  ask({
    title: `Make a group of ${plural(names.length, "robot")}`, icon: "robot", confirm: "Make the group", focus: true,
    body: html`<${Name} made=${made} number=${names.length} />`,
    effects: ["Users and tokens that are limited to the group may change and stop these robots, and no longer those that leave it."],
    act: async () => {
      const { name, robots } = await put(at("groups", made.name), { robots: names });
      await loadRobots();
      toast("info", `${name} has ${plural(robots, "robot")}.`);
    },
  });
}

function Name({ made, number }) {
  const [name, setName] = useState(""), before = [...store.robots.values()].filter((robot) => robot.labels.includes(name)).length;
  const type = (text) => { made.name = text.trim(); setName(made.name); };
  return html`<div class="stack"><${Field} label="Name"><input name="group" required maxlength="100" autocomplete="off" spellcheck="false" onInput=${(e) => type(e.target.value)} /><//>
    ${before > 0 && html`<${Notice} look="warn" icon="warning">${name} has ${plural(before, "robot")} now. Then it has these ${number}, and no others.<//>`}</div>`;
}
