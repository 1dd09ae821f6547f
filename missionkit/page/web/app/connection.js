// The session and the live socket: opens them, opens them again, and knows how old the data is.
import { batch, computed, signal } from "./html.js";
import { get, openSession } from "./server.js";
import { catchUp, live, mission, receive, track } from "./flight_state.js";

export const LATE = 0.5; // s: data is greyed
export const OLD = 2.0; // s: only HOLD is offered
const DRIFT = 0.001; // s per s that the two clocks may drift apart
const RETRY = [100, 250, 500, 1000, 2000]; // ms

export const session = signal(null); // {role, csrf}
export const refused = signal(""); // why there is no session
export const connected = signal(false);
export const chart = signal(""); // text of the SVG
export const age = signal(0); // s, in steps of a tenth

let token = "";
let socket = null;
let heardAt = null; // s, of this page
let stampedAt = null; // s, the server's clock
let skew = null; // s, least of arrival - stamp: clocks apart, and the quickest way
let lostAt = null;
let attempts = 0;

/** How far the data can be relied on. */
export const freshness = computed(() => {
  if (!connected.value || age.value >= OLD) return age.value >= OLD ? "old" : "late";
  return age.value >= LATE ? "late" : "fresh";
});

/** Time of the server's clock now, in ms, right to the quickest way. */
export function serverTime() {
  return Math.round(Date.now() - 1000 * (skew ?? 0));
}

/** Send to the server, when there is one. */
export function tell(message) {
  if (socket?.readyState === WebSocket.OPEN) socket.send(JSON.stringify(message));
}

/** Take the token off the address bar, and connect. */
export function connect() {
  token = new URLSearchParams(location.hash.slice(1)).get("token") ?? "";
  if (location.hash) history.replaceState(null, "", location.pathname);
  setInterval(measureAge, 50);
  setInterval(() => tell({ t: "alive" }), 1000);
  return again();
}

async function again() {
  try {
    session.value = await openSession(token);
    refused.value = "";
    openSocket();
  } catch (error) {
    if (error.status === 401 || error.status === 403) refused.value = error.message;
    retry();
  }
}

function retry() {
  setTimeout(again, RETRY[Math.min(attempts++, RETRY.length - 1)]);
}

function openSocket() {
  const scheme = location.protocol === "https:" ? "wss" : "ws";
  socket = new WebSocket(`${scheme}://${location.host}/api/live`);
  socket.onmessage = (event) => hear(JSON.parse(event.data));
  socket.onclose = () => {
    loadedAt = -Infinity;
    lostAt ??= performance.now() / 1000;
    connected.value = false;
    measureAge();
    retry();
  };
}

function hear(message) {
  heardAt = performance.now() / 1000;
  lostAt = null;
  if (message.at_ms) {
    stampedAt = message.at_ms / 1000;
    const apart = Date.now() / 1000 - stampedAt;
    skew = skew === null ? apart : Math.min(skew + DRIFT / 20, apart);
  }
  const before = live("now").peek();
  batch(() => {
    receive(message);
    connected.value = true;
    attempts = 0;
  });
  measureAge();
  const again = live("now").peek() < before || message.fired?.length > 1;
  if (mission.value?.source === "play" && again) loadedAt = -Infinity; // more than a delta tells
  if (message.t === "snapshot" || loadedAt === -Infinity) loadSoon();
}

let loadedAt = -Infinity;
let loading = 0;

/** At once the first time; a reader too slow gets snapshots often, and need not load for each. */
function loadSoon() {
  clearTimeout(loading);
  const since = performance.now() - loadedAt;
  loading = setTimeout(load, since > 2000 ? 0 : 2000 - since);
}

/** What does not come with the ticks; read again after each snapshot. */
async function load() {
  loadedAt = performance.now();
  try {
    const [about, past, flown] = await Promise.all([
      get("/api/mission"),
      get("/api/timeline"),
      get("/api/track").catch(() => ({ at: [], points: [] })),
    ]);
    const drawn = await fetch("/api/chart.svg", { cache: "no-store" });
    const picture = drawn.ok ? await drawn.text() : "";
    batch(() => {
      mission.value = about;
      catchUp(past);
      track.value = flown;
      chart.value = picture;
    });
  } catch {
    // the socket closes too, and connecting again loads again
  }
}

/** Only a flight in the air grows old: a recording and a play wait for their reader. */
function measureAge() {
  const now = performance.now() / 1000;
  let old = lostAt === null ? 0 : now - lostAt;
  if (mission.value?.source === "live" && !live("ended").value && heardAt !== null) {
    const late = stampedAt === null ? 0 : Date.now() / 1000 - stampedAt - skew;
    old = Math.max(old, now - heardAt, late);
  }
  const steps = Math.floor(old * 10) / 10;
  if (steps !== age.value) age.value = steps;
}
