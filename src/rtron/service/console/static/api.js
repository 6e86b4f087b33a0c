// The HTTP API: JSON in, JSON out, a Refused for every answer that is no success.
const ROOT = "/api/v1";
const clock = { offset: 0 };
let csrf = "";
let ended = () => {};

export const useCsrf = (token) => { csrf = token; };
export const onSessionEnd = (then) => { ended = then; };
// The service's wall clock, ms: what counts down is counted by it, not by this browser's.
export const now = () => Date.now() + clock.offset;

export class Refused extends Error {
  constructor(status, problem) {
    super(problem?.error || `the service answered ${status}`);
    this.status = status;
    this.help = problem?.help ?? "";
  }
}

export const addressOf = (path, query) => ROOT + path + search(query);
export const get = (path, query) => call("GET", path + search(query));
export const post = (path, body) => call("POST", path, body ?? {});
export const postForFile = async (path, body) => (await send("POST", path, body, (answer) => answer.blob())).said;
export const put = (path, body) => call("PUT", path, body);
export const patch = (path, body) => call("PATCH", path, body);
export const remove = (path, body) => call("DELETE", path, body);
export const at = (...parts) => `/${parts.map(encodeURIComponent).join("/")}`;

// All pages of a list, as far as the header `Link` leads.
export async function getAll(path, query) {
  const found = [];
  for (let next = search(query); next !== null;) {
    const { answer, said } = await send("GET", path + next);
    found.push(...said);
    next = /^<(\?[^>]*)>; rel="next"$/.exec(answer.headers.get("link"))?.[1] ?? null;
  }
  return found;
}

const call = async (...request) => (await send(...request)).said;

async function send(method, path, body, read = json) {
  const headers = {};
  if (method !== "GET") headers["X-CSRF-Token"] = csrf;
  if (body !== undefined) headers["Content-Type"] = "application/json";
  const answer = await reach(ROOT + path, { method, headers, body: body && JSON.stringify(body) });
  setClock(answer);
  const said = await (answer.ok ? read : json)(answer);
  if (answer.ok) return { answer, said };
  if (answer.status === 401 && path !== "/login") ended();
  throw new Refused(answer.status, problemOf(said));
}

async function reach(url, options) {
  try {
    return await fetch(url, options);
  } catch {
    throw new Refused(0, { error: "the service cannot be reached", help: "nothing was changed, as far as this page knows" });
  }
}

const json = (answer) => answer.json().catch(() => null);

// A validation error of the framework has `detail`; all else is a Problem.
function problemOf(said) {
  if (Array.isArray(said?.detail)) return { error: said.detail.map((d) => `${(d.loc ?? []).slice(1).join(".")}: ${d.msg}`).join("; ") };
  return said?.detail && !said.error ? { error: String(said.detail) } : said;
}

function search(query = {}) {
  const given = Object.entries(query).filter(([, value]) => value !== "" && value !== null && value !== undefined);
  return given.length ? `?${new URLSearchParams(given)}` : "";
}

function setClock(answer) {
  const date = Date.parse(answer.headers.get("date") ?? "");
  if (date) clock.offset = Math.abs(date - Date.now()) < 2000 ? 0 : date - Date.now();
}
