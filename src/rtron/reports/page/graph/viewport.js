// Pan, zoom, drag, and the way from box to box, by mouse, touch and keyboard.
import { extent } from "./layout.js";

const MIN_SCALE = 0.05, MAX_SCALE = 4, READABLE_SCALE = 0.3, CLICK_DISTANCE = 4, MARGIN = 24, SETTLED_MS = 180;
const DIRECTIONS = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };

export class Viewport {
  // `press` takes the choice of what is pressed, or null; `drag`, if given, a box and by how much it moves.
  constructor(svg, world, press, drag = null) {
    Object.assign(this, { svg, world, press, drag, x: 0, y: 0, k: 1, boxes: [], pointers: new Map(), held: null, moved: 0, frame: 0, touched: false });
    const on = (name, act, options) => svg.addEventListener(name, act.bind(this), options);
    on("wheel", this.wheel, { passive: false });
    on("pointerdown", this.down);
    on("pointermove", this.move);
    ["pointerup", "pointercancel"].forEach((name) => on(name, (e) => this.pointers.delete(e.pointerId)));
    on("click", (e) => { if (this.moved <= CLICK_DISTANCE) this.press(e.target.closest(".press, .hit")?.choice ?? null); });
    on("dblclick", (e) => { if (!e.target.closest(".press, .hit")) this.fit(); });
    on("keydown", this.key);
  }

  // Until somebody moves the picture, all of it stays in view. With `first`, which returns boxes, those come
  // into view where all would be too small to read.
  show(boxes, first = null) {
    Object.assign(this, { boxes, touched: false });
    const place = () => first ? this.open(first()) : this.fit();
    place();
    const observer = new ResizeObserver(() => this.touched || place());
    observer.observe(this.svg);
    return () => observer.disconnect();
  }

  // At most once a frame, however many events come.
  apply() {
    this.frame ||= requestAnimationFrame(() => {
      this.frame = 0;
      this.world.setAttribute("transform", `translate(${this.x},${this.y}) scale(${this.k})`);
      this.reduceDetail();
    });
  }

  // What nobody can read is not drawn: words from far away, outlines and rates while it moves.
  reduceDetail() {
    this.world.classList.toggle("far", this.k < READABLE_SCALE);
    this.world.classList.add("moving");
    clearTimeout(this.settled);
    this.settled = setTimeout(() => this.world.classList.remove("moving"), SETTLED_MS);
  }

  zoom(factor, x = this.svg.clientWidth / 2, y = this.svg.clientHeight / 2) {
    const k = Math.min(Math.max(this.k * factor, MIN_SCALE), MAX_SCALE);
    Object.assign(this, { touched: true, x: x - (x - this.x) * k / this.k, y: y - (y - this.y) * k / this.k, k });
    this.apply();
  }

  pan(dx, dy) {
    Object.assign(this, { touched: true, x: this.x + dx, y: this.y + dy });
    this.apply();
  }

  // `covered` is how many pixels of the height, from below, something lies over.
  fit(boxes = this.boxes, maxScale = 1.4, covered = this.covered?.() ?? 0) {
    if (!boxes.length) return;
    const { left, right, top, bottom } = extent(boxes), width = this.svg.clientWidth, height = this.svg.clientHeight - covered;
    this.k = Math.max(Math.min((width - 2 * MARGIN) / (right - left), (height - 2 * MARGIN) / (bottom - top), maxScale), MIN_SCALE);
    this.x = width / 2 - this.k * (left + right) / 2;
    this.y = height / 2 - this.k * (top + bottom) / 2;
    this.apply();
  }

  // All of it, or where its words would be too small then, these boxes at full size.
  open(boxes) {
    this.fit();
    if (this.k >= 1 || !this.boxes.length) return;
    const whole = extent(this.boxes), part = extent(boxes.length ? boxes : this.boxes.slice(0, 1));
    this.k = 1;
    this.x = placed(this.svg.clientWidth, part.left, part.right, whole.left, whole.right);
    this.y = placed(this.svg.clientHeight - (this.covered?.() ?? 0), part.top, part.bottom, whole.top, whole.bottom);
    this.apply();
  }

  focusOn(boxes, covered) {
    this.touched = true;
    this.fit(boxes, 1.1, covered);
  }

  wheel(event) {
    const { left, top } = this.svg.getBoundingClientRect();
    event.preventDefault();
    this.zoom(Math.exp(-event.deltaY * (event.deltaMode ? 0.05 : 0.0016)), event.clientX - left, event.clientY - top);
  }

  down(event) {
    if (event.button) return;
    this.pointers.set(event.pointerId, event);
    this.held = this.drag && this.pointers.size === 1 ? event.target.closest(".box")?.box : null;
    this.moved = 0;
  }

  move(event) {
    const before = this.pointers.get(event.pointerId);
    if (!before) return;
    const dx = event.clientX - before.clientX, dy = event.clientY - before.clientY;
    this.moved += Math.abs(dx) + Math.abs(dy);
    if (this.moved <= CLICK_DISTANCE) return;
    this.svg.setPointerCapture(event.pointerId);
    if (this.pointers.size === 2) this.pinch(event, before);
    else if (this.held) { this.touched = true; this.drag(this.held, dx / this.k, dy / this.k); }
    else this.pan(dx, dy);
    this.pointers.set(event.pointerId, event);
  }

  pinch(event, before) {
    const other = [...this.pointers.values()].find((pointer) => pointer.pointerId !== event.pointerId), { left, top } = this.svg.getBoundingClientRect();
    const distance = (pointer) => Math.hypot(pointer.clientX - other.clientX, pointer.clientY - other.clientY);
    this.zoom(distance(event) / Math.max(distance(before), 1), (event.clientX + other.clientX) / 2 - left, (event.clientY + other.clientY) / 2 - top);
  }

  key(event) {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const pressed = event.target.closest(".press"), arrow = DIRECTIONS[event.key];
    const act = { "+": () => this.zoom(1.25), "=": () => this.zoom(1.25), "-": () => this.zoom(0.8), 0: () => this.fit(), Escape: () => this.press(null) }[event.key];
    if (pressed && (event.key === "Enter" || event.key === " ")) this.press(pressed.choice);
    else if (arrow && event.shiftKey) this.pan(-70 * arrow[0], -70 * arrow[1]);
    else if (arrow) this.step(pressed, arrow);
    else if (act) act();
    else return;
    event.preventDefault();
    event.stopPropagation();
  }

  // The arrow keys go to the nearest box in that direction; from the picture itself, to the first.
  step(from, [sx, sy]) {
    const all = [...this.svg.querySelectorAll(".press")], to = from ? nearest(from, all, sx, sy) : all[0];
    to?.focus({ preventScroll: true });
    if (to) this.reveal(to);
  }

  reveal(element) {
    const at = element.getBoundingClientRect(), stage = this.svg.getBoundingClientRect();
    const dx = Math.max(stage.left + 20 - at.left, 0) || Math.min(stage.right - 20 - at.right, 0), dy = Math.max(stage.top + 20 - at.top, 0) || Math.min(stage.bottom - 20 - at.bottom, 0);
    if (dx || dy) this.pan(dx, dy);
  }
}

// By how much to move along one axis so that a part is in the middle, or begins at the edge if it is longer, and
// no more of the stage than a margin stays empty.
function placed(length, from, to, least, most) {
  if (most - least + 2 * MARGIN <= length) return length / 2 - (least + most) / 2;
  const wanted = to - from + 2 * MARGIN <= length ? length / 2 - (from + to) / 2 : MARGIN - from;
  return Math.min(Math.max(wanted, length - MARGIN - most), MARGIN - least);
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
