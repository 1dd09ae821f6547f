// The last 30 seconds of every guard shown: for the sparklines and the plot of one guard.
import { effect, signal } from "./html.js";
import { live } from "./flight_state.js";

export const SPAN = 30; // s
export const filled = signal(0); // counts what came from the server
const histories = new Map();
let before = null;

/** Samples of a guard, oldest first: {at, value, threshold, holds}, each an array. */
export function historyOf(name) {
  return histories.get(name) ?? empty();
}

/** Take the samples that the server has (a recording after a jump, a page opened late). */
export function fill(name, series) {
  const own = historyOf(name);
  const first = own.at[0] ?? Infinity;
  const older = series.at.findIndex((at) => at >= first);
  const end = older < 0 ? series.at.length : older;
  const joined = empty();
  for (const key of Object.keys(joined)) joined[key] = [...series[key].slice(0, end), ...own[key]];
  histories.set(name, joined);
  filled.value = filled.peek() + 1;
}

function empty() {
  return { at: [], value: [], threshold: [], holds: [] };
}

/** Keep what comes; a jump in time begins again. `jumped` is called after one. */
export function watchGuards(jumped) {
  return effect(() => {
    const guards = live("guards").value ?? [];
    const now = live("now").peek();
    if (now === null) return;
    if (before === null || now < before || now > before + 2) {
      histories.clear();
      jumped();
    }
    before = now;
    for (const guard of guards) add(guard, now);
    for (const [name, it] of histories) if (it.at.at(-1) < now - SPAN) histories.delete(name);
  });
}

function add({ name, value, threshold, holds }, now) {
  let own = histories.get(name);
  if (!own) histories.set(name, (own = empty()));
  if (own.at.at(-1) === now) return;
  own.at.push(now);
  own.value.push(value ?? null);
  own.threshold.push(threshold ?? null);
  own.holds.push(holds ?? null);
  const old = own.at.findIndex((at) => at >= now - SPAN);
  if (old > 100) for (const key of Object.keys(own)) own[key].splice(0, old);
}
