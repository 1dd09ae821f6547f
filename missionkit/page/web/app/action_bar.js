// The bar of a flight: the pilot's actions, or for a viewer who has them.
import { html } from "./html.js";
import { hint, latestActions, offers, piloting, send, STAGES } from "./actions.js";
import { freshness, session } from "./connection.js";
import { HoldButton } from "./hold_button.js";
import { live } from "./flight_state.js";
import { post } from "./server.js";

export function ActionBar() {
  if (live("ended").value) return html`<${Ended} />`;
  return html`<section class="bar actions" aria-label="actions">
    ${piloting.value ? html`<${Buttons} />` : html`<${Viewer} />`}
    <${Stages} />
  </section>`;
}

function Ended() {
  const { outcome, reason } = live("ended").value;
  return html`<section class="bar ended" aria-label="outcome">
    <strong class=${`outcome ${outcome}`}>${outcome}</strong><span class="cut">${reason}</span>
  </section>`;
}

function Buttons() {
  const old = freshness.value === "old";
  return html`<div class="buttons">
    ${offers.value.map(
      (it) => html`<${HoldAction} key=${`${it.action} ${it.event ?? ""}`} it=${it} old=${old} />`,
    )}
  </div>`;
}

function HoldAction({ it, old }) {
  const kind = `do-${it.action}`;
  return html`<${HoldButton}
    label=${it.name}
    kind=${kind}
    note=${noteOf(it, old)}
    offered=${it.offered}
    dangerous=${!!it.dangerous}
    onConfirm=${(pressed) => send(it, pressed)}
    onHint=${(sentence) => (hint.value = sentence)}
  />`;
}

function noteOf(it, old) {
  if (!it.offered) return "not now";
  return old ? "may not arrive" : "";
}

function Viewer() {
  const pilot = live("pilot").value;
  const mayAsk = session.value?.role === "pilot";
  const who = pilot?.name ? `${pilot.name} pilots.` : "Nobody pilots.";
  return html`<div class="viewer">
    <span>${who} ${mayAsk ? "" : "You may look on."}</span>
    ${mayAsk &&
    html`<button type="button" class="plain" onClick=${() => ask("ask")}>
      ${pilot?.name ? "Ask for control" : "Take control"}
    </button>`}
  </div>`;
}

/** Ask for, hand over, keep or give up the pilot's place. */
export async function ask(what) {
  try {
    await post("/api/pilot", { do: what });
    hint.value = what === "ask" ? "Asked. The pilot answers, or is silent for 10 s." : "";
  } catch (error) {
    hint.value = error.message;
  }
}

/** How far the latest action is; a refusal and a hint in words. */
function Stages() {
  const last = latestActions.value.at(-1);
  return html`<div class="stages" role="status">
    ${last && html`<${Stage} it=${last} />`}
    ${hint.value && html`<span class="hint">${hint.value}</span>`}
  </div>`;
}

function Stage({ it }) {
  const reached = STAGES.indexOf(it.stage);
  if (reached < 0) {
    return html`<span class=${`stage ${it.stage}`} data-stage=${it.stage}>
      <b class="cut">${it.name}</b> ${it.stage}${it.says ? `: ${it.says}` : ""}
    </span>`;
  }
  return html`<span class="stage" data-stage=${it.stage}>
    <b class="cut">${it.name}</b>
    ${STAGES.map(
      (name, at) => html`<span class=${at <= reached ? "reached" : "ahead"}>
        ${at <= reached ? "✓" : "·"} ${name}${name === "taken" && it.tick ? ` at tick ${it.tick}` : ""}
      </span>`,
    )}
    ${it.says && html`<span class="cut">${it.says}</span>`}
  </span>`;
}
