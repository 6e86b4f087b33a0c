// What every view is written with. Names, reasons and messages are always text, never markup, and isolated.
import { html as raw } from "./vendor/preact.js";
import { isolated } from "./graph/isolate.js";
export { render, useState, useEffect, useLayoutEffect, useRef, useMemo, useCallback, Component } from "./vendor/preact.js";

const SAID = ["title", "aria-label", "placeholder"];
const done = new WeakSet();

export const html = (...parts) => shown(raw(...parts));

// Every text goes through here, whichever view it stands in; values of controls stay as they are.
function shown(node) {
  if (typeof node === "string") return isolated(node);
  if (Array.isArray(node)) return node.map(shown);
  if (!node?.props || done.has(node)) return node;
  done.add(node);
  const { props } = node;
  if ("children" in props) props.children = shown(props.children);
  if (typeof node.type === "string") for (const name of SAID) if (typeof props[name] === "string") props[name] = isolated(props[name]);
  return node;
}
