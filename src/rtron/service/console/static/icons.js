// The icons: strokes on a square of 24.
import { html } from "./html.js";

const PATHS = {
  check: "M4 12.5l5.5 5.5L20 7", cross: "M6 6l12 12M18 6L6 18", warning: "M12 3.5 22 20.5H2ZM12 10v5M12 17.8v.2", error: "M8 2.5h8l5.5 5.5v8L16 21.5H8L2.5 16V8ZM12 7v6M12 16.5v.2", info: "M12 2.5a9.5 9.5 0 1 0 0 19 9.5 9.5 0 0 0 0-19M12 11v6M12 7.3v.2",
  stop: "M8 2.5h8l5.5 5.5v8L16 21.5H8L2.5 16V8ZM8.5 12h7", clock: "M12 2.5a9.5 9.5 0 1 0 0 19 9.5 9.5 0 0 0 0-19M12 6.5V12l4 2.5", link: "M9 15l6-6M10.5 6.5l2-2a4.6 4.6 0 0 1 7 7l-2 2M13.5 17.5l-2 2a4.6 4.6 0 0 1-7-7l2-2", off: "M3 3l18 18M10.5 6.5l2-2a4.6 4.6 0 0 1 7 7l-1.5 1.5M13.5 17.5l-2 2a4.6 4.6 0 0 1-7-7l1.5-1.5",
  lock: "M6 10.5h12v10H6ZM8.5 10.5V7.5a3.5 3.5 0 0 1 7 0v3", moon: "M20 14.5A8.5 8.5 0 0 1 9.5 4a8.5 8.5 0 1 0 10.5 10.5", user: "M12 4a4 4 0 1 1 0 8 4 4 0 0 1 0-8M4 21c.6-4 4-6 8-6s7.4 2 8 6", robot: "M5 9h14v10H5ZM12 9V4.5M9 13.5v1.5M15 13.5v1.5",
  curve: "M3 12h4l2.5-7 5 14 2.5-7h4", graph: "M5 12a2 2 0 1 0 0-.1M19 6a2 2 0 1 0 0-.1M19 18a2 2 0 1 0 0-.1M7 11.2l8.3-4.3M7 12.8l8.3 4.3", shield: "M12 3l8 3v6c0 5-3.5 8-8 9-4.5-1-8-4-8-9V6Z", steps: "M3 20.5h5v-5h5.5v-5H19V5.5h2.5", list: "M8 6h13M8 12h13M8 18h13M3.5 6h.1M3.5 12h.1M3.5 18h.1", rules: "M5 4h14v16H5ZM9 9h6M9 13h6M9 17h3", settings: "M4 7h10M18 7h2M4 17h2M10 17h10M16 4.5v5M8 14.5v5", key: "M14 4a6 6 0 1 1-4.5 10L4 19.5V21H3M14.5 9.5h.1", bell: "M6 16V11a6 6 0 0 1 12 0v5l1.5 2h-15ZM10 20.5h4", home: "M4 11l8-7 8 7v9.5H4ZM10 20.5v-6h4v6",
};

export const Icon = ({ name }) => html`<svg class="icon" viewBox="0 0 24 24" aria-hidden="true"><path d=${PATHS[name]} /></svg>`;
export const Logo = () => html`<svg viewBox="0 0 32 32" aria-hidden="true"><path d="M16 2 27 6.5v8.6C27 23 22.4 27.9 16 30 9.6 27.9 5 23 5 15.1V6.5Z" fill="#0b7d69" /><path d="M10.5 16.2l4 4 7.2-8" fill="none" stroke="#fff" stroke-width="2.6" stroke-linecap="round" stroke-linejoin="round" /></svg>`;
