// Of very many rows of one height only those are drawn that can be seen, and some around them.
import { html, useEffect, useLayoutEffect, useRef, useState } from "../html.js";

const AROUND = 12;
const STEPS = { ArrowDown: 1, ArrowUp: -1, PageDown: 10, PageUp: -10, Home: -Infinity, End: Infinity };

// `draw(item, props)` draws a row; `props` go to its <tr>, `tab` to the link by which it is reached.
export function VisibleRows({ items, keyOf, height, columns, draw }) {
  const body = useRef(null), [[first, last], setRange] = useState([0, 60]), [active, setActive] = useState(null), moved = useRef(false);
  useEffect(() => {
    const scroller = document.getElementById("content");
    const look = () => setRange((range) => visible(scroller, body.current, height, range));
    const resized = new ResizeObserver(look);
    resized.observe(scroller);
    scroller.addEventListener("scroll", look, { passive: true });
    return () => { resized.disconnect(); scroller.removeEventListener("scroll", look); };
  }, [height]);
  useLayoutEffect(() => {
    if (moved.current) body.current.querySelector("[data-active]")?.focus();
    moved.current = false;
  });
  const drawn = items.slice(first, last), found = drawn.findIndex((item) => keyOf(item) === active), tabbed = found < 0 ? 0 : found;
  const move = (event) => {
    const step = STEPS[event.key];
    if (step === undefined || event.altKey || event.ctrlKey || event.metaKey) return;
    event.preventDefault();
    const next = Math.max(0, Math.min(items.length - 1, first + tabbed + step));
    setActive(keyOf(items[next]));
    moved.current = true;
    setRange(scrollTo(body.current, height, next));
  };
  return html`<tbody ref=${body} onKeyDown=${move}>
    <${Space} rows=${Math.min(first, items.length)} height=${height} columns=${columns} />
    ${drawn.map((item, i) => draw(item, { key: keyOf(item), "aria-rowindex": first + i + 2, style: { height: `${height}px` } }, i === tabbed ? { tabindex: 0, "data-active": "" } : { tabindex: -1 }))}
    <${Space} rows=${Math.max(items.length - last, 0)} height=${height} columns=${columns} /></tbody>`;
}

const Space = ({ rows, height, columns }) => rows > 0 && html`<tr aria-hidden="true" class="space-row"><td colspan=${columns} style=${{ height: `${rows * height}px`, padding: 0 }}></td></tr>`;

function visible(scroller, body, height, before) {
  const above = scroller.getBoundingClientRect().top - body.getBoundingClientRect().top;
  const first = Math.max(0, Math.floor(above / height) - AROUND), last = first + Math.ceil(scroller.clientHeight / height) + 2 * AROUND;
  return before[0] === first && before[1] === last ? before : [first, last];
}

// The row comes into view before it is drawn, so that it can have the focus.
function scrollTo(body, height, index) {
  const scroller = document.getElementById("content"), inside = scroller.getBoundingClientRect();
  const top = body.getBoundingClientRect().top + index * height;
  if (top < inside.top) scroller.scrollTop -= inside.top - top + height;
  else if (top + height > inside.bottom) scroller.scrollTop += top + height - inside.bottom + height;
  return visible(scroller, body, height, []);
}
