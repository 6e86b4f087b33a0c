// How times, durations and figures read.
const two = (n) => String(n).padStart(2, "0");
export const ms = (ns) => ns / 1e6;
export const date = (ns) => new Date(ms(ns));

export function clock(ns) {
  const d = date(ns);
  return `${two(d.getHours())}:${two(d.getMinutes())}:${two(d.getSeconds())}`;
}
export function day(ns) {
  const d = date(ns);
  return `${d.getFullYear()}-${two(d.getMonth() + 1)}-${two(d.getDate())}`;
}
export const moment = (ns) => day(ns) === day(Date.now() * 1e6) ? clock(ns) : `${day(ns)} ${clock(ns)}`;
export const full = (ns) => `${day(ns)} ${clock(ns)}.${String(date(ns).getMilliseconds()).padStart(3, "0")}`;

const STEPS = [[86400, "d"], [3600, "h"], [60, "min"]];
export function lasting(seconds) {
  const s = Math.max(seconds, 0);
  for (const [size, unit] of STEPS) if (s >= 2 * size || (unit === "min" && s >= 100)) return `${Math.floor(s / size)} ${unit}`;
  return `${Math.floor(s)} s`;
}
export function countdown(seconds) {
  const s = Math.max(Math.ceil(seconds), 0);
  return s >= 3600 ? `${Math.floor(s / 3600)}:${two(Math.floor(s / 60) % 60)}:${two(s % 60)}` : `${Math.floor(s / 60)}:${two(s % 60)}`;
}
export const seconds = (ns) => ns === null || ns === undefined ? "" : String(+(ns / 1e9).toFixed(9));
export const figure = (value, digits = 2) => value === null || value === undefined ? "–" : String(+value.toFixed(digits));
export const rate = (value) => value === undefined ? "–" : value >= 9.95 ? value.toFixed(0) : value.toFixed(1);
export const count = (n) => n.toLocaleString("en");
export const plural = (n, one, many = `${one}s`) => `${count(n)} ${n === 1 ? one : many}`;

// A value of any setting, as people say it.
export function said(value, unit = "") {
  if (value === null || value === undefined || value === "") return "none";
  if (value === true) return "1";
  if (value === false) return "0";
  if (Array.isArray(value)) return value.join(", ") || "none";
  if (unit === "s") return `${seconds(value)} s`;
  return typeof value === "object" ? JSON.stringify(value) : `${value}${unit ? ` ${unit}` : ""}`;
}

export const ROLES = { admin: "admin", developer: "developer", end_user: "end user" };
