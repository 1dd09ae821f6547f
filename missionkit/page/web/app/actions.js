// Actions: which are offered, what was sent, and how far each has come.
import { computed, signal } from "./html.js";
import { post } from "./server.js";
import { freshness, serverTime } from "./connection.js";
import * as flight from "./flight_state.js";

const { live, mission } = flight;
export const STAGES = ["sent", "taken", "acknowledged", "observed"];
const ALWAYS = ["hold", "return", "land"]; // keep their place, offered or not
const ANSWER_WITHIN = 1000; // ms: later, the vehicle refuses it as too old
const KEPT = 5;

export const hint = signal("");
const own = signal([]); // what this page sent: {id, name, stage, says}

/** What stands in the action bar, in a fixed order: {name, action, event, offered, dangerous}. */
export const offers = computed(() => {
  const offered = live("offered").value ?? [];
  const find = (action) => offered.find((it) => it.action === action);
  const fixed = ALWAYS.map((action) => ({ action, ...find(action), offered: !!find(action) }));
  const more = ["continue", "give_back"].map(find).filter(Boolean);
  const events = offered.filter((it) => it.action === "event");
  const list = [...fixed, ...[...more, ...events].map((it) => ({ ...it, offered: true }))];
  return list.map((it) => ({ ...it, name: nameOf(it), offered: allowed(it) }));
});

function allowed({ action, offered }) {
  return freshness.value === "old" ? action === "hold" : offered;
}

/** The word on a button: "HOLD", or the name of an event. */
export function nameOf({ action, event }) {
  return action === "event" ? event : action.replace("_", " ").toUpperCase();
}

/** The latest actions of anybody, with the stage that the server says, else the page's own. */
export const latestActions = computed(() => {
  const known = live("actions").value ?? [];
  const ids = new Set(known.map((it) => it.id));
  const waiting = own.value.filter((it) => !ids.has(it.id));
  const all = [...known.map((it) => ({ ...it, name: nameOf(it) })), ...waiting];
  const dated = all.map((it) => [firstSeen(it.id), it]);
  return dated.sort(([one], [other]) => one - other).map(([, it]) => it).slice(-KEPT);
});

const order = new Map(); // id -> how many actions this page had seen before it

function firstSeen(id) {
  if (!order.has(id)) order.set(id, order.size);
  return order.get(id);
}

/** Send a confirmed action. */
export async function send({ action, event = null }, { held, at }) {
  const id = identifier();
  const name = nameOf({ action, event });
  note({ id, name, stage: "sending", says: "" });
  hint.value = "";
  const since = Math.round(performance.now() - at);
  const body = { id, action, event, seen: flight.seq, held_ms: held, pressed_ms_ago: since };
  try {
    await post("/api/action", { ...body, at_ms: serverTime() - since }, ANSWER_WITHIN);
    note({ id, name, stage: "sent", says: "" });
  } catch (error) {
    const said = error.status ? error.message : "No answer within 1 s: it may not have arrived.";
    note({ id, name, stage: error.status ? "refused" : "unanswered", says: said });
  }
}

function note(entry) {
  firstSeen(entry.id);
  const others = own.value.filter((it) => it.id !== entry.id);
  own.value = [...others, entry].slice(-KEPT);
}

/** Random, also where the page is not in a secure context. */
function identifier() {
  if (crypto.randomUUID) return crypto.randomUUID();
  const bytes = [...crypto.getRandomValues(new Uint8Array(16))];
  const hex = bytes.map((it) => it.toString(16).padStart(2, "0")).join("");
  return hex.replace(/^(.{8})(.{4}).(.{3}).(.{3})(.{12})$/, "$1-$2-4$3-8$4-$5");
}

/** Whether this page may act: a pilot of a flight, or anybody in a play. */
export const piloting = computed(() => {
  if (mission.value?.source !== "live") return false;
  return !!live("pilot").value?.you && !live("ended").value;
});
