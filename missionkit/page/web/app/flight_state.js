// What the server said last: one signal for each top-level key of a tick, so that a component
// is drawn again only when what it reads has changed.
import { batch, signal } from "./html.js";

const signals = new Map();
const MOST_EVENTS = 2000;

export const mission = signal(null);
export const timeline = signal({ lanes: [], fired: [], problems: [], requirements: {}, end: 0 });
export const track = signal({ at: [], points: [] });
export const lastFired = signal([]); // transitions of the latest message
export let seq = 0; // of the latest message

/** The signal of a top-level key; null until the server has sent it. */
export function live(key) {
  let found = signals.get(key);
  if (!found) {
    found = signal(null);
    signals.set(key, found);
  }
  return found;
}

/** Take in a snapshot or a delta. */
export function receive(message) {
  const { t: kind, fired = [], problems = [], ...values } = message;
  seq = message.seq;
  batch(() => {
    if (kind === "snapshot") {
      latest = { fired: [], problems: [] };
      for (const [key, found] of signals) if (!(key in values)) found.value = null;
    } else {
      addEvents(fired, problems);
    }
    for (const [key, value] of Object.entries(values)) live(key).value = value;
    if (kind === "delta") {
      if ("state" in values || "active" in values) addLane();
      if ("requirements" in values) addVerdicts(values.requirements);
      if (fired.length) lastFired.value = fired;
    }
    addPoint();
  });
}

let latest = { fired: [], problems: [] }; // since the last snapshot

/** Take the server's timeline, which may be a moment older than the latest message. */
export function catchUp(past) {
  const { fired, problems } = latest;
  timeline.value = past;
  addEvents(fired, problems);
  if (live("active").value) addLane();
}

function addEvents(fired, problems) {
  if (!fired.length && !problems.length) return;
  latest.fired = [...latest.fired, ...fired].slice(-MOST_EVENTS);
  latest.problems = [...latest.problems, ...problems].slice(-MOST_EVENTS);
  const now = timeline.value;
  timeline.value = {
    ...now,
    fired: merged(now.fired, fired, (it) => `${it.tick} ${it.id} ${it.source} ${it.to}`),
    problems: merged(now.problems, problems, (it) => `${it.at} ${it.says}`),
  };
}

function merged(known, more, key) {
  const seen = new Set(known.slice(-100).map(key));
  return [...known, ...more.filter((it) => !seen.has(key(it)))].slice(-MOST_EVENTS);
}

/** In a recording the server's timeline is whole; elsewhere the lanes grow with the states. */
function addLane() {
  if (mission.value?.source === "recording") return;
  const now = live("now").value ?? 0;
  const active = live("active").value ?? [];
  const { lanes } = timeline.value;
  const open = new Set(lanes.filter((lane) => lane.to === null).map((lane) => lane.state));
  const closed = lanes.map((lane) =>
    lane.to === null && !active.includes(lane.state) ? { ...lane, to: now } : lane,
  );
  const begun = active.filter((state) => !open.has(state));
  const more = begun.map((state) => ({ state, from: now, to: null }));
  timeline.value = { ...timeline.value, lanes: [...closed, ...more].slice(-MOST_EVENTS) };
}

function addVerdicts(verdicts) {
  if (mission.value?.source === "recording") return;
  const known = timeline.value.requirements;
  const changed = verdicts.filter((it) => known[it.name]?.at(-1)?.verdict !== it.verdict);
  if (!changed.length) return;
  const at = live("now").value ?? 0;
  const more = { ...known };
  for (const { name, verdict } of changed) more[name] = [...(known[name] ?? []), { at, verdict }];
  timeline.value = { ...timeline.value, requirements: more };
}

const POINTS = 4000;
const POINT_EVERY = 0.2; // s

/** The track of a recording is whole; elsewhere it grows, and is thinned when it is long. */
function addPoint() {
  if (mission.value?.source === "recording") return;
  const now = live("now").value;
  const position = live("position").value;
  const { at, points } = track.value;
  if (now === null || !position) return;
  if (at.length && now < at.at(-1)) return void (track.value = { at: [now], points: [position] });
  if (at.length && now - at.at(-1) < POINT_EVERY) return;
  at.push(now);
  points.push(position);
  if (at.length <= POINTS) return;
  const half = (_, index) => index % 2 === 0;
  track.value = { at: at.filter(half), points: points.filter(half) };
}
