(() => {
"use strict";
const { kinds, apps } = JSON.parse(document.querySelector("#data").textContent);
const FIRST = 200;
const find = (selector) => document.querySelector(selector);
const make = (tag, text = "", look = "") => {
  const element = document.createElement(tag);
  element.textContent = text;
  if (look) element.className = look;
  return element;
};

const columns = [
  ["app", (app) => app.app, "app"],
  ["ROS", (app) => app.ros, "number"],
  ["nodes", (app) => app.nodes, "number"],
  ["topics", (app) => app.topics, "number spare"],
  ...kinds.map((kind, index) => [kind, (app) => app.risks?.[index], "number"]),
  ["findings", (app) => app.rules && Object.values(app.rules).reduce((sum, each) => sum + each, 0), "number"],
  ["not known", (app) => app.unresolved, "number spare"],
  ["seconds", (app) => app.seconds.toFixed(1), "number spare"],
  ["category", (app) => app.error ? `not scanned: ${app.error}` : app.categories.join(" / "), "types"],
  ["functions", (app) => Object.keys(app.functions ?? {}).join(", "), "types spare"],
];

// What a link's address asks for, by name.
const tests = {
  ros: (app, value) => app.ros === Number(value),
  risk: (app, value) => (app.risks?.[kinds.indexOf(value)] ?? 0) > 0,
  category: (app, value) => app.categories?.includes(value),
  best: (app, value) => app.categories?.[0] === value,
  function: (app, value) => value in (app.functions ?? {}),
  link: (app, value) => app.links?.includes(value),
  rule: (app, value) => value in (app.rules ?? {}),
  nodes: (app, value) => app.nodes >= Number(value),
  app: (app, value) => app.app === value,
  failed: (app) => Boolean(app.error),
};
const words = { best: "category", link: "interaction", rule: "finding", nodes: "nodes, at least", failed: "not scanned" };

let filters = [];
let order = null;
let shownAll = false;

const readAddress = () => {
  const address = location.hash.slice(1);
  if (!address.includes("=")) return false;
  filters = [...new URLSearchParams(address)].filter(([name]) => name in tests);
  return filters.length > 0;
};

const fits = (app) => {
  const query = find("#query").value.trim().toLowerCase();
  const text = () => [app.app, ...(app.categories ?? []), ...Object.keys(app.functions ?? {})].join(" ").toLowerCase();
  return filters.every(([name, value]) => tests[name](app, value)) && (!query || text().includes(query));
};

const sorted = (list) => {
  if (!order) return list;
  const [, value] = columns[order.column];
  const key = (app) => value(app) ?? -1;
  const compare = (a, b) => typeof key(a) === "string" && Number.isNaN(Number(key(a))) ? key(a).localeCompare(key(b)) : key(a) - key(b);
  return [...list].sort((a, b) => order.sign * compare(a, b));
};

const list = (title, rows, total) => {
  const part = make("div");
  part.append(make("b", title));
  const items = make("ul");
  for (const [what, text, place] of rows) {
    const item = make("li");
    item.append(make("b", `${what}: `), text);
    if (place) item.append(" ", make("code", place));
    items.append(item);
  }
  if (total > rows.length) items.append(make("li", `and ${total - rows.length} more`));
  part.append(items);
  return part;
};

const details = (app) => {
  const row = make("tr", "", "details");
  const cell = make("td");
  cell.colSpan = columns.length;
  if (app.error) {
    cell.append(make("p", app.error));
  } else {
    const sum = (numbers) => numbers.reduce((all, each) => all + each, 0);
    cell.append(list("Risks, the worst first", app.worst, sum(app.risks)));
    cell.append(list("Findings, the worst first", app.findings, sum(Object.values(app.rules))));
    cell.append(make("p", `Functions: ${Object.entries(app.functions).map(([name, nodes]) => `${name} ${nodes}`).join(", ") || "none known"}`));
    cell.append(make("p", `Interactions: ${app.links.map((each) => each.replace(">", " → ")).join(", ") || "none of the graph"}`));
  }
  row.append(cell);
  return row;
};

const line = (app) => {
  const row = make("tr");
  for (const [, value, look] of columns) row.append(make("td", look === "app" ? "" : String(value(app) ?? ""), look));
  const button = make("button");
  for (const part of app.app.split(/(?<=\/)/)) button.append(part, make("wbr"));
  button.type = "button";
  button.setAttribute("aria-expanded", "false");
  button.addEventListener("click", () => {
    const open = button.getAttribute("aria-expanded") === "true";
    button.setAttribute("aria-expanded", String(!open));
    if (open) row.nextElementSibling.remove(); else row.after(details(app));
  });
  row.firstElementChild.append(button);
  return row;
};

const show = () => {
  const fitting = sorted(apps.filter(fits));
  const shown = shownAll ? fitting : fitting.slice(0, FIRST);
  find("#lines tbody").replaceChildren(...shown.map(line));
  find("#shown").textContent = `${fitting.length} of ${apps.length}`;
  const more = find("#more");
  more.hidden = shown.length === fitting.length;
  more.textContent = `Show all ${fitting.length}`;
  find("#filters").replaceChildren(...filters.map(([name, value]) => {
    const button = make("button", `${words[name] ?? name}: ${value} ×`);
    button.type = "button";
    button.addEventListener("click", () => {
      const rest = filters.filter((each) => each[0] !== name);
      filters = rest;
      history.replaceState(null, "", `#${rest.length ? new URLSearchParams(rest) : "apps"}`);
      show();
    });
    return button;
  }));
  if (fitting.length === 1) find("#lines .app button").click();
};

columns.forEach(([title, , look], column) => {
  const head = make("th", "", look === "app" ? "" : look);
  const button = make("button", title);
  button.type = "button";
  button.addEventListener("click", () => {
    const first = look.startsWith("number") ? -1 : 1;
    order = { column, sign: order?.column === column ? -order.sign : first };
    show();
  });
  head.append(button);
  find("#lines thead tr").append(head);
});
find("#query").addEventListener("input", show);
find("#search").addEventListener("submit", (event) => event.preventDefault());
find("#more").addEventListener("click", () => { shownAll = true; show(); });
const follow = () => {
  if (!readAddress()) return;
  shownAll = false;
  show();
  find("#apps").scrollIntoView();
};
addEventListener("hashchange", follow);
document.addEventListener("click", (event) => {
  const link = event.target.closest("a");
  const address = link?.getAttribute("href") ?? link?.getAttribute("xlink:href");
  if (address && address === location.hash) follow();
});
readAddress();
show();
if (filters.length) find("#apps").scrollIntoView();
})();
