// What is wrong with what is shown: data that is late, a lost server, no way in.
import { computed, html } from "./html.js";
import { age, connected, freshness, refused, session } from "./connection.js";
import { piloting } from "./actions.js";
import { live } from "./flight_state.js";

const WAIT = 0.5; // s: a page that has just been opened is not late

const sentence = computed(() => {
  if (refused.value && !session.value) return "";
  if (!connected.value) {
    if (live("tick").value === null && age.value < WAIT) return "";
    const hold = piloting.value && freshness.value === "old" ? " HOLD may not arrive." : "";
    return `No connection to missionkit for ${age.value.toFixed(1)} s.${hold} Trying again.`;
  }
  if (freshness.value === "late") return `The data is ${age.value.toFixed(1)} s old.`;
  if (freshness.value !== "old") return "";
  const only = piloting.value ? " Only HOLD can be sent, and it may not arrive." : "";
  return `The data is ${age.value.toFixed(1)} s old.${only}`;
});

export function Banner() {
  const urgent = freshness.value === "old" || !connected.value;
  return html`<div class="banners" role="alert">
    ${sentence.value && html`<p class=${`banner ${urgent ? "bad" : "warn"}`}>${sentence.value}</p>`}
  </div>`;
}

/** Shown instead of the page when the server lets nobody in. */
export function NoWayIn() {
  return html`<main class="no-way-in">
    <h1>missionkit</h1>
    <p>${refused.value}</p>
    <p>
      Open the address that missionkit printed when it started, with everything behind the
      <code>#</code>. Who only looks on needs the address for viewers.
    </p>
  </main>`;
}
