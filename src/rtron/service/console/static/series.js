// What the charts show: about one sample a second of each robot, ten minutes long.
import { get } from "./api.js";

const KEPT = 600, EVERY = 0.9e9;
const WORDS = ["passed", "held", "dropped", "modified"];
const series = new Map(), asked = new Map();

export const rateKey = (topic, flow) => `${topic} ${flow}`;
export function samplesOf(robot) {
  if (!series.has(robot)) series.set(robot, []);
  return series.get(robot);
}
export const newestRates = (robot) => samplesOf(robot).at(-1)?.rates ?? new Map();
export const forget = (robot) => { series.delete(robot); asked.delete(robot); };
export const forgetAll = () => { series.clear(); asked.clear(); };

// A sample: when (ns), what each stream is at, and messages a second of each flow since the one before.
export function record(robot, state) {
  const samples = samplesOf(robot), last = samples.at(-1);
  if (last && state.at < last.at) samples.length = 0;
  if (samples.length && state.at - last.at < EVERY) return;
  const streams = new Map([...state.streams].sort(watchedFirst).map((stream) => [stream.topic, stream]));
  samples.push({ at: state.at, counted: true, streams, fps: state.fps, rates: ratesOf(last, streams, state.at) });
  if (samples.length > KEPT) samples.splice(0, samples.length - KEPT);
}

// Where a topic is both enforced and observed, the enforced stream counts.
const watchedFirst = (a, b) => (a.mode === "enforce") - (b.mode === "enforce");

function ratesOf(before, streams, at) {
  if (!before?.counted) return null;
  const rates = new Map(), seconds = (at - before.at) / 1e9;
  for (const [topic, stream] of streams) for (const [flow, tally] of Object.entries(stream.flows)) {
    const then = before.streams.get(topic)?.flows[flow];
    if (then) rates.set(rateKey(topic, flow), rated(WORDS.map((word) => Math.max(tally[word] - then[word], 0) / seconds)));
  }
  return rates;
}

const rated = ([passed, held, dropped, modified]) => ({ passed, held, dropped, modified, out: passed + modified, refused: held + dropped });

// The minutes before this page was opened, as the service has them.
export function loadPast(robot) {
  if (!asked.has(robot)) asked.set(robot, fetchPast(robot));
  return asked.get(robot);
}

async function fetchPast(robot) {
  const end = Date.now(), query = { since: `${end - KEPT * 1000}000000`, until: `${end + 60000}000000` };
  const { points, width } = await get(`/robots/${encodeURIComponent(robot)}/figures`, query).catch(() => ({ points: [] }));
  const samples = samplesOf(robot), first = samples[0]?.at ?? Infinity;
  const past = points.filter((point) => point.at + width <= first).map((point) => pastSample(point, width / 1e9));
  samples.unshift(...past.slice(-(KEPT - samples.length)));
}

function pastSample({ at, streams, fps }, seconds) {
  const rates = new Map();
  for (const [topic, { flows }] of Object.entries(streams)) for (const [flow, counts] of Object.entries(flows)) {
    rates.set(rateKey(topic, flow), rated(counts.map((n) => n / seconds)));
  }
  return { at, streams: new Map(Object.entries(streams).map(([topic, { speed, limit, latency }]) => [topic, { speed, limit, latency }])), fps, rates };
}

// The columns of a chart: seconds since 1970, then one list a line.
export function columns(robot, lines) {
  const samples = samplesOf(robot);
  return [samples.map((s) => s.at / 1e9), ...lines.map((line) => samples.map((s) => line.value(s) ?? null))];
}
