(() => {
"use strict";
const frame = document.querySelector("#picture");
const picture = frame.querySelector("svg");
const all = (selector) => [...document.querySelectorAll(selector)];
const names = (text) => text.split("|");
const ends = (item) => [names(item.dataset.from), names(item.dataset.to)];
const joins = (item, name) => ends(item).some((side) => side.includes(name));
let fixed = "";

const show = (name) => {
  picture.classList.toggle("choosing", Boolean(name));
  const near = new Set([name]);
  for (const item of all(".edge, .label")) {
    item.classList.toggle("near", joins(item, name));
    const [from, to] = ends(item);
    if (from.includes(name)) to.forEach((end) => near.add(end));
    if (to.includes(name)) from.forEach((end) => near.add(end));
  }
  for (const item of all(".function")) {
    item.classList.toggle("near", near.has(item.dataset.name));
    item.classList.toggle("chosen", Boolean(name) && item.dataset.name === name);
    item.setAttribute("aria-pressed", String(Boolean(fixed) && item.dataset.name === fixed));
  }
  for (const row of all("tbody tr")) row.classList.toggle("apart", Boolean(name) && !joins(row, name));
};

const choose = (name) => {
  fixed = fixed === name ? "" : name;
  show(fixed);
};

const fit = document.querySelector("#fit");
fit.addEventListener("click", () => {
  fit.setAttribute("aria-pressed", String(frame.classList.toggle("fit")));
});

for (const item of all(".function")) {
  const name = item.dataset.name;
  item.setAttribute("tabindex", "0");
  item.setAttribute("role", "button");
  item.setAttribute("aria-pressed", "false");
  item.setAttribute("aria-label", [...item.querySelectorAll("text")].map((text) => text.textContent).join(", "));
  item.addEventListener("mouseenter", () => fixed || show(name));
  item.addEventListener("mouseleave", () => show(fixed));
  item.addEventListener("focus", () => fixed || show(name));
  item.addEventListener("blur", () => show(fixed));
  item.addEventListener("click", () => choose(name));
  item.addEventListener("keydown", (event) => {
    if (event.key === "Enter" || event.key === " ") {
      event.preventDefault();
      choose(name);
    }
    if (event.key === "Escape") choose(fixed);
  });
}
})();
