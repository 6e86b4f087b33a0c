// Pan, zoom and drag, by mouse, touch and keys.
const svg = byId("picture"), world = byId("world");
const view = { x: 0, y: 0, k: 1 };
const BOUNDS = [0.05, 4];

function apply() { world.setAttribute("transform", `translate(${view.x},${view.y}) scale(${view.k})`); }

function zoom(factor, x = svg.clientWidth / 2, y = svg.clientHeight / 2) {
  const k = Math.min(Math.max(view.k * factor, BOUNDS[0]), BOUNDS[1]);
  view.x = x - (x - view.x) * k / view.k;
  view.y = y - (y - view.y) * k / view.k;
  view.k = k;
  apply();
}

function extent(boxes) {
  const edge = (sign, axis, size) => boxes.map((b) => b[axis] + sign * b[size] / 2);
  return { left: Math.min(...edge(-1, "x", "w")), right: Math.max(...edge(1, "x", "w")), top: Math.min(...edge(-1, "y", "h")), bottom: Math.max(...edge(1, "y", "h")) };
}

function fit(boxes = picture.boxes, most = 1.4) {
  if (!boxes.length) return;
  const { left, right, top, bottom } = extent(boxes), margin = 24, below = byId("legend").offsetHeight;
  const height = svg.clientHeight - below;
  const k = Math.min((svg.clientWidth - 2 * margin) / (right - left), (height - 2 * margin) / (bottom - top), most);
  view.k = Math.max(k, BOUNDS[0]);
  view.x = svg.clientWidth / 2 - view.k * (left + right) / 2;
  view.y = height / 2 - view.k * (top + bottom) / 2;
  apply();
}

const fitLit = () => fit(picture.boxes.filter((b) => b.element.classList.contains("lit")), 1.1);

const fingers = new Map();
const STILL = 4;
let held = null, moved = 0;

function listen() {
  const lift = (event) => fingers.delete(event.pointerId);
  svg.addEventListener("wheel", wheel, { passive: false });
  svg.addEventListener("pointerdown", touch);
  svg.addEventListener("pointermove", move);
  svg.addEventListener("pointerup", lift);
  svg.addEventListener("pointercancel", lift);
  svg.addEventListener("click", (event) => moved > STILL || press(event.target.closest(".press, .hit")));
  svg.addEventListener("dblclick", (event) => event.target.closest(".press") || fit());
}

function wheel(event) {
  const { left, top } = svg.getBoundingClientRect(), lines = event.deltaMode ? 0.05 : 0.0016;
  event.preventDefault();
  zoom(Math.exp(-event.deltaY * lines), event.clientX - left, event.clientY - top);
}

function touch(event) {
  if (event.button) return;
  fingers.set(event.pointerId, event);
  const id = event.target.closest("[data-box]")?.dataset.box;
  held = fingers.size > 1 || id === undefined ? null : picture.boxes[id];
  moved = 0;
}

function move(event) {
  const before = fingers.get(event.pointerId);
  if (!before) return;
  const dx = event.clientX - before.clientX, dy = event.clientY - before.clientY;
  moved += Math.abs(dx) + Math.abs(dy);
  if (moved > STILL) svg.setPointerCapture(event.pointerId);
  if (fingers.size === 2) pinch(event);
  else if (held && moved > STILL) drag(held, dx / view.k, dy / view.k);
  else if (moved > STILL) pan(dx, dy);
  else return;
  fingers.set(event.pointerId, event);
}

const press = (pressed) => pressed?.act ? pressed.act() : choose(pressed ? pressed.choice : null);

function pan(dx, dy) { view.x += dx; view.y += dy; apply(); }

function pinch(event) {
  const [other] = [...fingers.values()].filter((finger) => finger.pointerId !== event.pointerId);
  const before = fingers.get(event.pointerId);
  const distance = (finger) => Math.hypot(finger.clientX - other.clientX, finger.clientY - other.clientY);
  const { left, top } = svg.getBoundingClientRect();
  zoom(distance(event) / Math.max(distance(before), 1), (event.clientX + other.clientX) / 2 - left, (event.clientY + other.clientY) / 2 - top);
}

function drag(b, dx, dy) {
  b.x += dx;
  b.y += dy;
  moveBox(b);
  picture.edges.filter((e) => e.from === b || e.to === b).forEach(route);
}

// The arrow keys go from a box to the nearest one in that direction.
const STEPS = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };
function step(from, [sx, sy]) {
  const here = from.getBoundingClientRect();
  let best = null, least = Infinity;
  for (const other of svg.querySelectorAll(".press")) {
    const there = other.getBoundingClientRect();
    const dx = there.x + there.width / 2 - here.x - here.width / 2, dy = there.y + there.height / 2 - here.y - here.height / 2;
    const along = dx * sx + dy * sy, across = Math.abs(dx * sy) + Math.abs(dy * sx);
    const cost = along + 2.5 * across;
    if (along > 1 && cost < least) [best, least] = [other, cost];
  }
  best?.focus();
  if (best) reveal(best);
}

function reveal(element) {
  const at = element.getBoundingClientRect(), stage = svg.getBoundingClientRect();
  const dx = Math.max(stage.left + 20 - at.left, 0) || Math.min(stage.right - 20 - at.right, 0);
  const dy = Math.max(stage.top + 20 - at.top, 0) || Math.min(stage.bottom - 20 - at.bottom, 0);
  if (dx || dy) pan(dx, dy);
}

function keys(event) {
  const within = (selector) => event.target.closest?.(selector);
  if (within("input") || event.ctrlKey || event.metaKey || event.altKey) {
    if (event.key === "Escape") event.target.blur();
    return;
  }
  const pressed = within(".press"), arrow = STEPS[event.key];
  const actions = { "+": () => zoom(1.25), "=": () => zoom(1.25), "-": () => zoom(0.8), 0: () => fit(), Escape: () => choose(null), "/": () => byId("search").focus(), f: () => byId("focus").click(), t: () => byId("theme").click() };
  if (pressed && (event.key === "Enter" || event.key === " ")) press(pressed);
  else if (pressed && arrow) step(pressed, arrow);
  else if (arrow && event.target === svg) pan(-60 * arrow[0], -60 * arrow[1]);
  else if (within("button") && (event.key === "Enter" || event.key === " ")) return;
  else if (actions[event.key]) actions[event.key]();
  else return;
  event.preventDefault();
}
