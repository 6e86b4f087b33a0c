// What a view shows, as a file.
import { html } from "./html.js";
import { addressOf, postForFile } from "./api.js";
import { plural } from "./format.js";
import { toast } from "./store.js";

const TITLES = { csv: "For a spreadsheet", json: "For a program: everything as it is" };

// `shown()` returns the names of those robots that a filter leaves in view, null where all are.
export const Export = ({ what, query = {}, shown = () => null }) => html`<span class="line" role="group" aria-label="Export"><span class="soft small">Export</span>${Object.entries(TITLES).map(([format, title]) => html`<button title=${title} onClick=${() => save(what, { ...query, format }, shown())}>${format.toUpperCase()}</button>`)}</span>`;

const save = (what, query, robots) => robots ? saveShown(what, query.format, robots).catch((error) => toast("error", error.message)) : download(addressOf(`/export/${what}`, query), "");

async function saveShown(what, format, robots) {
  const href = URL.createObjectURL(await postForFile(`/export/${what}`, { robots, format }));
  download(href, `rtron-${what}.${format}`);
  setTimeout(() => URL.revokeObjectURL(href), 60000);
  toast("info", `${plural(robots.length, "robot")} exported: those that the filter shows.`);
}

// What this page has already, as a file of JSON.
export function saveDocument(name, document) {
  const href = URL.createObjectURL(new Blob([JSON.stringify(document, null, 1)], { type: "application/json" }));
  download(href, name);
  setTimeout(() => URL.revokeObjectURL(href), 60000);
}

function download(href, name) {
  const link = Object.assign(document.createElement("a"), { href, download: name });
  document.body.append(link);
  link.click();
  link.remove();
}
