// Another browser asks to pilot: the pilot hands over or keeps control. It takes neither the focus
// nor the action bar away: HOLD can be pressed, and a press that is under way goes on.
import { html } from "./html.js";
import { ask } from "./action_bar.js";
import { live } from "./flight_state.js";

export function PilotDialog() {
  const pilot = live("pilot").value;
  const asking = pilot?.you ? pilot.asked_by : null;
  return html`<div class="takeover-place" role="alert">
    ${asking &&
    html`<section class="takeover" aria-label="takeover">
      <h2 class="cut">${asking} asks for control</h2>
      <p>After handing over you look on. Unanswered for 10 s, control is handed over.</p>
      <div class="buttons">
        <button type="button" class="plain" onClick=${() => ask("refuse")}>Keep control</button>
        <button type="button" class="plain" onClick=${() => ask("grant")}>Hand over</button>
      </div>
    </section>`}
  </div>`;
}
