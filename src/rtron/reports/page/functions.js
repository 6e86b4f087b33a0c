(() => {
"use strict";
const picture = document.querySelector("#picture svg");
const all = (selector) => [...document.querySelectorAll(selector)];
const ends = (item) => [item.dataset.from, item.dataset.to];
let fixed = "";

const show = (name) => {
  picture.classList.toggle("choosing", Boolean(name));
  const near = new Set([name]);
  for (const item of all(".edge, .label")) {
    const joined = ends(item).includes(name);
    item.classList.toggle("near", joined);
    if (joined) ends(item).forEach((end) => near.add(end));
  }
  for (const item of all(".function")) {
    item.classList.toggle("near", near.has(item.dataset.name));
    item.classList.toggle("chosen", Boolean(name) && item.dataset.name === name);
  }
  for (const row of all("tbody tr")) row.classList.toggle("apart", Boolean(name) && !ends(row).includes(name));
};

const choose = (name) => {
  fixed = fixed === name ? "" : name;
  show(fixed);
};

for (const item of all(".function")) {
  const name = item.dataset.name;
  item.setAttribute("tabindex", "0");
  item.setAttribute("role", "button");
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
