// A press that confirms: held long enough, released inside, in time, and still offered.
// Time comes with the events, so that a page that stalls does not lengthen a press.

export const HOLD = 500; // ms
export const DANGEROUS = 1500; // ms
export const EXPIRES = 5000; // ms

/** Begin a press at `at` (ms) that needs `needs` ms. */
export function press(at, needs) {
  return { at, needs };
}

/** How far it is: 0 to 1 while it is held, 1 once a release confirms. */
export function progress(held, now) {
  return Math.min(Math.max((now - held.at) / held.needs, 0), 1);
}

/** Whether the prompt has been open for too long. */
export function expired(held, now) {
  return now - held.at >= EXPIRES;
}

/** What a release means: "confirmed", "short", "outside", "expired". */
export function release(held, now, inside) {
  if (expired(held, now)) return "expired";
  if (!inside) return "outside";
  return now - held.at >= held.needs ? "confirmed" : "short";
}
