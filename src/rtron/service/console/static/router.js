// Where we are: the part of the address after #, each piece encoded.
import { notify } from "./store.js";

export const here = () => location.hash.replace(/^#\/?/, "").split("?")[0].split("/").filter(Boolean).map(decode);
export const query = () => new URLSearchParams(location.hash.split("?")[1] ?? "");
export const to = (...parts) => `#/${parts.map(encodeURIComponent).join("/")}`;
export const go = (...parts) => { location.hash = to(...parts); };

function decode(part) {
  try {
    return decodeURIComponent(part);
  } catch {
    return part;
  }
}

addEventListener("hashchange", () => notify("route"));
