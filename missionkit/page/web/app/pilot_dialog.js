// Another browser asks to pilot: the pilot hands over or keeps control.
import { html, useEffect, useRef } from "./html.js";
import { ask } from "./action_bar.js";
import { live } from "./flight_state.js";

export function PilotDialog() {
  const pilot = live("pilot").value;
  const asking = pilot?.you ? pilot.asked_by : null;
  const dialog = useRef(null);
  useEffect(() => {
    if (asking && !dialog.current.open) dialog.current.showModal?.();
    if (!asking && dialog.current.open) dialog.current.close();
  }, [asking]);
  return html`<dialog ref=${dialog} aria-labelledby="asks" onCancel=${(event) => event.preventDefault()}>
    <h2 id="asks" class="cut">${asking ?? "Somebody"} asks for control</h2>
    <p>After handing over you look on. Unanswered for 10 s, control is handed over.</p>
    <div class="buttons">
      <button type="button" class="plain" onClick=${() => ask("refuse")}>Keep control</button>
      <button type="button" class="plain" onClick=${() => ask("grant")}>Hand over</button>
    </div>
  </dialog>`;
}
