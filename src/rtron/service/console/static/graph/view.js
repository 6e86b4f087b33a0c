// Pan, zoom and the way by keys, by mouse, touch and keyboard.
import { extent } from "./layout.js";

const LEAST = 0.08, MOST = 3, STILL = 4, READABLE = 0.3;
const STEPS = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };

export class View {
  constructor(svg, world, press) {
    Object.assign(this, { svg, world, press, x: 0, y: 0, k: 1, fingers: new Map(), moved: 0, frame: 0, touched: false });
    const on = (name, act, options) => svg.addEventListener(name, act.bind(this), options);
    on("wheel", this.wheel, { passive: false });
    on("pointerdown", this.down);
    on("pointermove", this.move);
    ["pointerup", "pointercancel"].forEach((name) => on(name, (e) => this.fingers.delete(e.pointerId)));
    on("click", (e) => { if (this.moved <= STILL) press(e.target.closest(".press")?.choice ?? null); });
    on("keydown", this.key);
  }

  // Until somebody moves the picture, all of it stays in view.
  follow(boxes) {
    this.touched = false;
    this.fit(boxes);
    const resized = new ResizeObserver(() => this.touched || this.fit(boxes));
    resized.observe(this.svg);
    return () => resized.disconnect();
  }

  // At most once a frame, however many events come.
  apply() {
    this.frame ||= requestAnimationFrame(() => {
      this.frame = 0;
      this.world.setAttribute("transform", `translate(${this.x},${this.y}) scale(${this.k})`);
      this.spare();
    });
  }

  // What nobody can read is not drawn: words from far away, outlines and rates while it moves.
  spare() {
    this.world.classList.toggle("far", this.k < READABLE);
    this.world.classList.add("moving");
    clearTimeout(this.still);
    this.still = setTimeout(() => this.world.classList.remove("moving"), 180);
  }

  zoom(factor, x = this.svg.clientWidth / 2, y = this.svg.clientHeight / 2) {
    const k = Math.min(Math.max(this.k * factor, LEAST), MOST);
    this.touched = true;
    Object.assign(this, { x: x - (x - this.x) * k / this.k, y: y - (y - this.y) * k / this.k, k });
    this.apply();
  }

  pan(dx, dy) {
    this.touched = true;
    this.x += dx;
    this.y += dy;
    this.apply();
  }

  // `share` is the part of the height, from above, that nothing lies over.
  fit(boxes, most = 1.3, share = 1) {
    if (!boxes.length) return;
    const { left, right, top, bottom } = extent(boxes), margin = 26, { clientWidth } = this.svg, clientHeight = this.svg.clientHeight * share;
    this.k = Math.max(Math.min((clientWidth - 2 * margin) / (right - left), (clientHeight - 2 * margin) / (bottom - top), most), LEAST);
    this.x = clientWidth / 2 - this.k * (left + right) / 2;
    this.y = clientHeight / 2 - this.k * (top + bottom) / 2;
    this.apply();
  }

  wheel(event) {
    const { left, top } = this.svg.getBoundingClientRect();
    event.preventDefault();
    this.zoom(Math.exp(-event.deltaY * (event.deltaMode ? 0.05 : 0.0016)), event.clientX - left, event.clientY - top);
  }

  down(event) {
    if (event.button) return;
    this.fingers.set(event.pointerId, event);
    this.moved = 0;
  }

  move(event) {
    const before = this.fingers.get(event.pointerId);
    if (!before) return;
    const dx = event.clientX - before.clientX, dy = event.clientY - before.clientY;
    this.moved += Math.abs(dx) + Math.abs(dy);
    if (this.moved <= STILL) return;
    this.svg.setPointerCapture(event.pointerId);
    if (this.fingers.size === 2) this.pinch(event, before);
    else this.pan(dx, dy);
    this.fingers.set(event.pointerId, event);
  }

  pinch(event, before) {
    const other = [...this.fingers.values()].find((finger) => finger.pointerId !== event.pointerId), { left, top } = this.svg.getBoundingClientRect();
    const distance = (finger) => Math.hypot(finger.clientX - other.clientX, finger.clientY - other.clientY);
    this.zoom(distance(event) / Math.max(distance(before), 1), (event.clientX + other.clientX) / 2 - left, (event.clientY + other.clientY) / 2 - top);
  }

  key(event) {
    const pressed = event.target.closest(".press"), arrow = STEPS[event.key];
    const act = { "+": () => this.zoom(1.25), "=": () => this.zoom(1.25), "-": () => this.zoom(0.8), 0: () => this.fitAll?.(), Escape: () => this.press(null) }[event.key];
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    if (pressed && (event.key === "Enter" || event.key === " ")) this.press(pressed.choice);
    else if (arrow && event.shiftKey) this.pan(-70 * arrow[0], -70 * arrow[1]);
    else if (arrow) this.step(pressed, arrow);
    else if (act) act();
    else return;
    event.preventDefault();
  }

  // The arrow keys go to the nearest box in that direction; from the picture itself, to the first.
  step(from, [sx, sy]) {
    const all = [...this.svg.querySelectorAll(".press")];
    const best = from ? nearest(from, all, sx, sy) : all[0];
    best?.focus({ preventScroll: true });
    if (best) this.reveal(best);
  }

  reveal(element) {
    const at = element.getBoundingClientRect(), stage = this.svg.getBoundingClientRect();
    const dx = Math.max(stage.left + 20 - at.left, 0) || Math.min(stage.right - 20 - at.right, 0), dy = Math.max(stage.top + 20 - at.top, 0) || Math.min(stage.bottom - 20 - at.bottom, 0);
    if (dx || dy) this.pan(dx, dy);
  }
}

function nearest(from, all, sx, sy) {
  const here = from.getBoundingClientRect();
  let best = null, least = Infinity;
  for (const other of all) {
    const there = other.getBoundingClientRect();
    const dx = there.x + there.width / 2 - here.x - here.width / 2, dy = there.y + there.height / 2 - here.y - here.height / 2;
    const along = dx * sx + dy * sy, cost = along + 2.5 * (Math.abs(dx * sy) + Math.abs(dy * sx));
    if (along > 1 && cost < least) [best, least] = [other, cost];
  }
  return best;
}
